//! Pencil, line and rectangle: from pointer positions to crossings.
//!
//! All are pure: they give spans of the endless cloth, which a [`Surface`]
//! wraps by the repeat. Corners are held within its reach first.

use super::symmetry::{Point, Span, Surface};

/// The crossings of a straight line, both ends of it included (Bresenham 1965, in whole
/// numbers).
pub fn line(surface: &Surface, from: Point, to: Point) -> Vec<Span> {
    let (from, to) = (surface.held(from), surface.held(to));
    let (width, height) = ((to.0 - from.0).abs(), -(to.1 - from.1).abs());
    let step = ((to.0 - from.0).signum(), (to.1 - from.1).signum());
    let (mut at, mut error) = (from, width + height);
    let mut spans: Vec<Span> = Vec::new();
    loop {
        // Crossings side by side become one span.
        match spans.last_mut() {
            Some(last) if last.pick == at.1 => {
                last.from = last.from.min(at.0);
                last.to = last.to.max(at.0 + 1);
            }
            _ => spans.push(one(at)),
        }
        if at == to {
            return spans;
        }
        let twice = 2 * error;
        if twice >= height {
            error += height;
            at.0 += step.0;
        }
        if twice <= width {
            error += width;
            at.1 += step.1;
        }
    }
}

fn one((end, pick): Point) -> Span {
    Span {
        pick,
        from: end,
        to: end + 1,
    }
}

/// A pencil's path through the pointer's positions: nothing is left out where the pointer
/// was fast.
pub fn stroke(surface: &Surface, points: &[Point]) -> Vec<Span> {
    match points {
        [] => Vec::new(),
        [only] => line(surface, *only, *only),
        _ => points
            .windows(2)
            .flat_map(|pair| line(surface, pair[0], pair[1]))
            .collect(),
    }
}

/// The lowest left and the highest right corner of two.
fn corners(surface: &Surface, from: Point, to: Point) -> (Point, Point) {
    let (from, to) = (surface.held(from), surface.held(to));
    (
        (from.0.min(to.0), from.1.min(to.1)),
        (from.0.max(to.0), from.1.max(to.1)),
    )
}

/// A rectangle between two corners, both included; filled, or its outline.
pub fn rectangle(surface: &Surface, from: Point, to: Point, filled: bool) -> Vec<Span> {
    let (low, high) = corners(surface, from, to);
    let row = |pick| Span {
        pick,
        from: low.0,
        to: high.0 + 1,
    };
    if filled {
        return (low.1..=high.1).map(row).collect();
    }
    let sides = (low.1 + 1..high.1).flat_map(|pick| [one((low.0, pick)), one((high.0, pick))]);
    let mut spans = vec![row(low.1), row(high.1)];
    spans.extend(sides);
    spans
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Lattice, Repeat, WeavePattern};
    use crate::edit::Symmetry;

    fn surface() -> Surface {
        let none = Lattice {
            across: Repeat::None,
            along: Repeat::None,
        };
        let symmetry = Symmetry::default();
        Surface {
            ends: 9,
            picks: 5,
            lattice: none,
            symmetry,
        }
    }

    fn art(spans: Vec<Span>) -> String {
        surface().cells(spans).bits().to_string()
    }

    fn same(art: &str) -> String {
        WeavePattern::parse(art).unwrap().to_string()
    }

    #[test]
    fn a_line_has_one_crossing_a_step_and_both_ends() {
        let drawn = art(line(&surface(), (0, 0), (8, 4)));
        // Either crossing of a tie is right; this is the one nearer the start.
        let expected = same(
            ".......##
             .....##..
             ...##....
             .##......
             #........",
        );
        assert_eq!(drawn.matches('#').count(), 9);
        assert_eq!(drawn, expected);
        assert_eq!(
            art(line(&surface(), (3, 2), (3, 2))).matches('#').count(),
            1
        );
        let steep: Vec<Span> = line(&surface(), (2, 4), (1, 0));
        assert_eq!(steep.len(), 5);
        let far = line(&surface(), (i64::MIN, 0), (i64::MAX, i64::MAX));
        assert!(far.len() < 100);
    }

    #[test]
    fn rectangles_and_ellipses_are_what_they_look_like() {
        let expected = ".#####...\n.#...#...\n.#####...\n.........\n";
        let drawn = art(rectangle(&surface(), (5, 4), (1, 2), false));
        assert_eq!(drawn, same(&format!("{expected}.........")));
        assert_eq!(
            art(rectangle(&surface(), (1, 1), (3, 2), true))
                .matches('#')
                .count(),
            6
        );
    }

    #[test]
    fn a_fast_pencil_leaves_nothing_out() {
        let spans = stroke(&surface(), &[(0, 0), (4, 0), (4, 4)]);
        assert_eq!(surface().cells(spans).count(), 9);
        assert!(stroke(&surface(), &[]).is_empty());
    }
}
