//! Where painting lands: the design's repeat, and the symmetries that are painted with.

use super::cells::Cells;
use crate::design::{Design, Lattice};

/// Repeats to either side of the design that a pointer reaches; points further out are held
/// there, so that no gesture is endless.
const REACH: i64 = 4;

/// A crossing (end, pick) of the endless cloth.
pub type Point = (i64, i64);

/// Crossings side by side on one pick of the endless cloth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// The pick.
    pub pick: i64,
    /// The first end.
    pub from: i64,
    /// The first end that is not in it any more.
    pub to: i64,
}

/// The most copies of a stroke that steps may make: a gesture stays a moment's work.
pub const MOST_COPIES: u64 = 1 << 14;

/// What is painted along with every crossing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Symmetry {
    /// Left and right: twice the end that stays where it is, odd between two ends (7 =
    /// between ends 3 and 4).
    pub mirror_ends: Option<i64>,
    /// Top and bottom: twice the pick that stays where it is.
    pub mirror_picks: Option<i64>,
    /// Every so many ends and picks again, within the design; 0 = not in this direction.
    pub every: (u32, u32),
}

/// The design as a surface to paint on: its size, its repeat, and the symmetries.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// Ends of the design.
    pub ends: u32,
    /// Picks of the design.
    pub picks: u32,
    /// How it repeats.
    pub lattice: Lattice,
    /// What is painted along.
    pub symmetry: Symmetry,
}

impl Surface {
    /// The surface of a design, without symmetry.
    pub fn of(design: &Design) -> Self {
        Self {
            ends: design.ends(),
            picks: design.picks(),
            lattice: design.lattice(),
            symmetry: Symmetry::default(),
        }
    }

    /// How often steps of so many ends and picks (0 = none) paint everything; beyond
    /// [`MOST_COPIES`] they are too small for the design.
    pub fn copies(&self, (ends, picks): (u32, u32)) -> u64 {
        let count = |every: u32, whole: u32| match every {
            0 => 1,
            every => u64::from((whole / every).max(1)),
        };
        count(ends, self.ends) * count(picks, self.picks)
    }

    /// The same surface with these symmetries.
    pub fn with_symmetry(self, symmetry: Symmetry) -> Self {
        Self { symmetry, ..self }
    }

    /// The crossing of the design at a point of the cloth; `None` where there is no cloth.
    pub fn wrap(&self, (end, pick): Point) -> Option<(u32, u32)> {
        self.lattice.wrap(end, pick, self.ends, self.picks)
    }

    /// A point within reach of the design.
    pub fn held(&self, (end, pick): Point) -> Point {
        let hold = |place: i64, period: u32| {
            let reach = REACH * i64::from(period);
            place.clamp(-reach, reach + i64::from(period))
        };
        (hold(end, self.ends), hold(pick, self.picks))
    }

    /// The crossings that spans cover, wrapped by the repeat, with their symmetric images.
    pub fn cells(&self, spans: impl IntoIterator<Item = Span>) -> Cells {
        let mut cells = Cells::none(self.ends, self.picks);
        for span in spans {
            for image in self.mirrored(span) {
                for (ends, picks) in self.steps() {
                    self.add(
                        &mut cells,
                        Span {
                            pick: image.pick + picks,
                            from: image.from + ends,
                            to: image.to + ends,
                        },
                    );
                }
            }
        }
        cells
    }

    /// A set of crossings with its symmetric images.
    pub fn symmetric(&self, cells: &Cells) -> Cells {
        if self.symmetry == Symmetry::default() {
            return cells.clone();
        }
        self.cells(
            cells
                .words()
                .flat_map(|(word, pick, bits)| runs(word, pick, bits)),
        )
    }

    /// A span and its mirror images.
    fn mirrored(&self, span: Span) -> impl Iterator<Item = Span> {
        let Symmetry {
            mirror_ends,
            mirror_picks,
            ..
        } = self.symmetry;
        let beside = mirror_ends.map(|twice| Span {
            pick: span.pick,
            from: twice - span.to + 1,
            to: twice - span.from + 1,
        });
        let both = [Some(span), beside].into_iter().flatten();
        both.flat_map(move |span| {
            let above = mirror_picks.map(|twice| Span {
                pick: twice - span.pick,
                ..span
            });
            [Some(span), above].into_iter().flatten()
        })
    }

    /// The steps by which everything is painted again; (0, 0) is one of them.
    fn steps(&self) -> impl Iterator<Item = Point> + use<> {
        let count = |every: u32, whole: u32| match every {
            0 => 1,
            every => i64::from((whole / every).max(1)),
        };
        let (ends, picks) = self.symmetry.every;
        let (across, along) = (count(ends, self.ends), count(picks, self.picks));
        let (ends, picks) = (i64::from(ends), i64::from(picks));
        (0..along).flat_map(move |row| (0..across).map(move |column| (ends * column, picks * row)))
    }

    /// Adds one span, in runs that lie side by side in the design too.
    fn add(&self, cells: &mut Cells, span: Span) {
        let (mut end, pick) = self.held((span.from, span.pick));
        let (to, _) = self.held((span.to, span.pick));
        if pick != span.pick {
            return;
        }
        while end < to {
            let Some((first, row)) = self.wrap((end, pick)) else {
                // A panel's cloth begins at its own edge or nowhere further on.
                end = if end < 0 { 0 } else { to };
                continue;
            };
            let width = i64::from(self.ends - first).min(to - end) as u32;
            add_run(cells, row, first, width);
            end += i64::from(width);
        }
    }
}

/// Adds `width` crossings of a pick from `first` on.
fn add_run(cells: &mut Cells, pick: u32, first: u32, width: u32) {
    let mut end = first;
    while end < first + width {
        let place = end % 64;
        let count = (64 - place).min(first + width - end);
        cells.insert_word(end / 64, pick, u64::MAX >> (64 - count) << place);
        end += count;
    }
}

/// The runs of ones in a word.
fn runs(word: u32, pick: u32, mut bits: u64) -> impl Iterator<Item = Span> {
    std::iter::from_fn(move || {
        if bits == 0 {
            return None;
        }
        let first = bits.trailing_zeros();
        let width = (!(bits >> first)).trailing_zeros().min(64 - first);
        bits &= !(u64::MAX >> (64 - width) << first);
        let from = i64::from(64 * word + first);
        Some(Span {
            pick: i64::from(pick),
            from,
            to: from + i64::from(width),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Repeat;

    fn surface(ends: u32, picks: u32) -> Surface {
        Surface {
            ends,
            picks,
            lattice: Lattice::default(),
            symmetry: Symmetry::default(),
        }
    }

    fn found(surface: Surface, span: Span) -> Vec<(u32, u32)> {
        let mut found: Vec<_> = surface.cells([span]).iter().collect();
        found.sort_unstable();
        found
    }

    /// What spans should cover, crossing by crossing.
    fn expected(surface: Surface, span: Span) -> Vec<(u32, u32)> {
        let mut found: Vec<_> = (span.from..span.to)
            .filter_map(|end| surface.wrap((end, span.pick)))
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    #[test]
    fn spans_wrap_as_their_crossings_do() {
        let lattices = [
            Lattice::default(),
            Lattice {
                across: Repeat::Dropped(3),
                along: Repeat::Straight,
            },
            Lattice {
                across: Repeat::Straight,
                along: Repeat::Dropped(29),
            },
            Lattice {
                across: Repeat::None,
                along: Repeat::Straight,
            },
            Lattice {
                across: Repeat::Straight,
                along: Repeat::None,
            },
        ];
        for lattice in lattices {
            let surface = Surface {
                lattice,
                ..surface(70, 9)
            };
            for span in [(0, 5, 130), (-3, -80, 20), (11, 60, 75), (20, -40, 0)] {
                let span = Span {
                    pick: span.0,
                    from: span.1,
                    to: span.2,
                };
                assert_eq!(
                    found(surface, span),
                    expected(surface, span),
                    "{lattice:?} {span:?}"
                );
            }
        }
        // A dropped repeat lands elsewhere than a straight one.
        let span = Span {
            pick: 0,
            from: 70,
            to: 72,
        };
        let dropped = Surface {
            lattice: lattices[1],
            ..surface(70, 9)
        };
        assert_ne!(found(dropped, span), found(surface(70, 9), span));
    }

    #[test]
    fn mirrors_and_steps_paint_along() {
        let symmetry = Symmetry {
            mirror_ends: Some(7),
            mirror_picks: None,
            every: (0, 4),
        };
        let painted = surface(8, 8).with_symmetry(symmetry);
        let span = Span {
            pick: 1,
            from: 2,
            to: 3,
        };
        assert_eq!(found(painted, span), [(2, 1), (2, 5), (5, 1), (5, 5)]);
        let cells = painted.symmetric(&Cells::of(8, 8, [(2, 1)]));
        assert_eq!(cells.count(), 4);
        let both = Symmetry {
            mirror_ends: Some(7),
            mirror_picks: Some(7),
            every: (0, 0),
        };
        let span = Span {
            pick: 0,
            from: 0,
            to: 2,
        };
        assert_eq!(found(surface(8, 8).with_symmetry(both), span).len(), 8);
    }

    #[test]
    fn steps_are_counted_before_they_are_painted() {
        let span = Span {
            pick: 0,
            from: 0,
            to: 1,
        };
        for every in [(0, 0), (3, 0), (0, 2), (3, 2), (9, 9)] {
            let symmetry = Symmetry {
                every,
                ..Symmetry::default()
            };
            let stepped = surface(8, 8).with_symmetry(symmetry);
            let painted = found(stepped, span).len() as u64;
            assert_eq!(stepped.copies(every), painted, "{every:?}");
        }
        assert!(surface(16_000, 20_000).copies((1, 1)) > MOST_COPIES);
    }

    #[test]
    fn points_far_away_are_no_endless_work() {
        let span = Span {
            pick: 0,
            from: -1_000_000_000_000,
            to: 1_000_000_000_000,
        };
        assert_eq!(surface(8, 8).cells([span]).count(), 8);
        let far = Span {
            pick: i64::MAX,
            from: 0,
            to: 1,
        };
        assert!(surface(8, 8).cells([far]).is_empty());
    }
}
