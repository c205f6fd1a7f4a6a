//! Stability: what the designer decided follows the colours when their number changes.

use crate::design::{Region, Srgb, delta_e_00, lab};

/// For every new colour, the old region whose weave it takes over, if any.
///
/// Old and new are paired one to one, the most alike (ΔE₀₀) first, locked regions before
/// all others. What is left over is proposed anew.
pub fn follow(colours: &[Srgb], before: &[Region]) -> Vec<Option<usize>> {
    let old: Vec<_> = (before.iter())
        .map(|region| region.colour.map(|colour| lab(colour.to_linear())))
        .collect();
    let mut pairs = Vec::new();
    for (new, colour) in colours.iter().enumerate() {
        let here = lab(colour.to_linear());
        for (at, there) in old.iter().enumerate() {
            if let Some(there) = there {
                pairs.push((delta_e_00(here, *there), !before[at].locked, new, at));
            }
        }
    }
    // Locked regions lose their weave only where there are too few colours for them.
    pairs.sort_by(|a, b| {
        (a.1.cmp(&b.1))
            .then(a.0.total_cmp(&b.0))
            .then((a.2, a.3).cmp(&(b.2, b.3)))
    });
    let mut found = vec![None; colours.len()];
    let mut taken = vec![false; before.len()];
    for (_, _, new, at) in pairs {
        if found[new].is_none() && !taken[at] {
            (found[new], taken[at]) = (Some(at), true);
        }
    }
    found
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::Fill;

    fn region(colour: Srgb, locked: bool) -> Region {
        Region {
            colour: Some(colour),
            locked,
            ..Region::new("r", Fill::by_notation("plain").unwrap())
        }
    }

    const RED: Srgb = Srgb(200, 20, 20);
    const BLUE: Srgb = Srgb(20, 30, 200);
    const GREY: Srgb = Srgb(120, 120, 120);

    #[test]
    fn the_nearest_colours_keep_their_weaves() {
        let before = [region(RED, false), region(BLUE, false)];
        let new = [GREY, Srgb(30, 40, 190), Srgb(180, 30, 30)];
        assert_eq!(follow(&new, &before), [None, Some(1), Some(0)]);
        // Fewer colours: each takes the nearest.
        assert_eq!(follow(&[Srgb(150, 20, 20)], &before), [Some(0)]);
        assert_eq!(follow(&new, &[]), [None, None, None]);
    }

    #[test]
    fn a_locked_region_goes_first() {
        let before = [region(Srgb(190, 25, 25), false), region(GREY, true)];
        assert_eq!(follow(&[RED], &before), [Some(1)]);
        let colourless = [Region::new("r", Fill::by_notation("plain").unwrap())];
        assert_eq!(follow(&[RED], &colourless), [None]);
    }
}
