//! Weaves made of weaves: joined, shifted, rearranged, dropped, shaded, interleaved.
//!
//! These are the steps by which textbooks construct the weaves that no ratio describes
//! (Watson, *Textile Design and Colour*; Oelsner, *A Handbook of Weaves*). Weaves of
//! different repeats meet on the least common multiple of both; sizes are checked before
//! memory is asked for.

use crate::design::document::lcm;
use crate::design::lattice::{Lattice, Repeat};
use crate::design::pattern::{SizeError, WeavePattern, check_size};

/// Weaves that do not go together.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CombineError {
    /// The common repeat is empty or too large.
    #[error("the common repeat of the weaves: {0}")]
    Size(#[from] SizeError),
    /// A shading that would have to take marks away.
    #[error(
        "no shading leads from one weave to the other: the first has marks that the second \
         lacks wherever it is laid; begin with the weave that has more weft on the face"
    )]
    NotShaded,
    /// A shading of fewer than two steps.
    #[error("a shading of {0} steps: give at least 2")]
    Steps(u32),
    /// More steps than crossings that differ.
    #[error("a shading of {steps} steps, but only {most} differ: give at most {most}")]
    TooManySteps {
        /// Steps asked for.
        steps: u32,
        /// The most there can be.
        most: u64,
    },
    /// A rearrangement that names a thread the weave does not have.
    #[error("the order names thread {thread}, but the weave repeats after {threads}")]
    Thread {
        /// The thread, counted from 1.
        thread: u32,
        /// Threads of the weave.
        threads: u32,
    },
}

/// The size on which both weaves repeat.
fn common(a: &WeavePattern, b: &WeavePattern) -> Result<(u32, u32), SizeError> {
    let ends = lcm(u64::from(a.ends()), u64::from(b.ends()));
    let picks = lcm(u64::from(a.picks()), u64::from(b.picks()));
    check_size(ends, picks)?;
    // `check_size` leaves nothing that does not fit.
    Ok((ends as u32, picks as u32))
}

fn joined(
    a: &WeavePattern,
    b: &WeavePattern,
    join: impl Fn(bool, bool) -> bool,
) -> Result<WeavePattern, CombineError> {
    let (ends, picks) = common(a, b)?;
    Ok(WeavePattern::from_fn(ends, picks, |end, pick| {
        let (end, pick) = (i64::from(end), i64::from(pick));
        join(a.get_wrapped(end, pick), b.get_wrapped(end, pick))
    }))
}

/// Warp up where it is up in either weave, over their common repeat.
///
/// # Errors
/// [`CombineError::Size`] if that repeat is too large.
pub fn either(a: &WeavePattern, b: &WeavePattern) -> Result<WeavePattern, CombineError> {
    joined(a, b, |a, b| a | b)
}

/// Warp up where it is up in both weaves, over their common repeat.
///
/// # Errors
/// [`CombineError::Size`] if that repeat is too large.
pub fn both(a: &WeavePattern, b: &WeavePattern) -> Result<WeavePattern, CombineError> {
    joined(a, b, |a, b| a & b)
}

/// The weave laid `ends` to the right and `picks` upwards, round its repeat.
pub fn shifted(weave: &WeavePattern, ends: i32, picks: i32) -> WeavePattern {
    weave.repeated(weave.ends(), weave.picks(), (ends, picks))
}

/// The weave `across` times side by side and `along` times one above the other.
///
/// # Errors
/// [`CombineError::Size`] for no repeat at all or too many.
pub fn repeated(
    weave: &WeavePattern,
    across: u32,
    along: u32,
) -> Result<WeavePattern, CombineError> {
    let ends = u64::from(weave.ends()) * u64::from(across);
    let picks = u64::from(weave.picks()) * u64::from(along);
    check_size(ends, picks)?;
    Ok(weave.repeated(ends as u32, picks as u32, (0, 0)))
}

/// One straight repeat of the weave dropped: each repeat to the right stands `picks` higher
/// than the last, and after as many as it takes the cloth begins again.
///
/// # Errors
/// [`CombineError::Size`] if that repeat is too large.
pub fn drop_repeat(weave: &WeavePattern, picks: u32) -> Result<WeavePattern, CombineError> {
    let height = weave.picks();
    let drop = picks % height;
    let repeats = match drop {
        0 => 1,
        drop => lcm(u64::from(height), u64::from(drop)) / u64::from(drop),
    };
    let ends = u64::from(weave.ends()).saturating_mul(repeats);
    check_size(ends, u64::from(height))?;
    let lattice = Lattice {
        across: Repeat::Dropped(drop),
        along: Repeat::Straight,
    };
    Ok(WeavePattern::from_fn(ends as u32, height, |end, pick| {
        lattice
            .wrap(i64::from(end), i64::from(pick), weave.ends(), height)
            .is_some_and(|(end, pick)| weave.get(end, pick))
    }))
}

/// The threads of a weave in another order: end i of the result is end `ends[i]` of the
/// weave, and picks likewise (both counted from 1; an empty order keeps all as they are).
///
/// This is how a threading and a lifting order make broken, pointed, corkscrew and satin
/// weaves of a twill.
///
/// # Errors
/// [`CombineError`] for a thread that is not there or a size that cannot be.
pub fn rearranged(
    weave: &WeavePattern,
    ends: &[u32],
    picks: &[u32],
) -> Result<WeavePattern, CombineError> {
    let order = |given: &[u32], threads: u32| -> Result<Vec<u32>, CombineError> {
        if given.is_empty() {
            return Ok((0..threads).collect());
        }
        let inside = |&thread: &u32| match thread {
            1.. if thread <= threads => Ok(thread - 1),
            _ => Err(CombineError::Thread { thread, threads }),
        };
        given.iter().map(inside).collect()
    };
    let ends = order(ends, weave.ends())?;
    let picks = order(picks, weave.picks())?;
    check_size(ends.len() as u64, picks.len() as u64)?;
    Ok(WeavePattern::from_fn(
        ends.len() as u32,
        picks.len() as u32,
        |end, pick| weave.get(ends[end as usize], picks[pick as usize]),
    ))
}

/// A check of a weave and its reverse, cut cleanly: the neighbour across each border is the
/// weave with warp and weft exchanged, seen in a mirror that stands on the border, so that
/// marks meet blanks there and no float crosses. Figure and ground of a damask.
///
/// # Errors
/// [`CombineError::Size`] if twice the weave is too large.
pub fn counterchange(weave: &WeavePattern) -> Result<WeavePattern, CombineError> {
    let (ends, picks) = (weave.ends(), weave.picks());
    check_size(2 * u64::from(ends), 2 * u64::from(picks))?;
    Ok(WeavePattern::from_fn(2 * ends, 2 * picks, |end, pick| {
        let fold = |thread: u32, threads: u32| match thread < threads {
            true => (thread, false),
            false => (2 * threads - 1 - thread, true),
        };
        let ((end, right), (pick, above)) = (fold(end, ends), fold(pick, picks));
        weave.get(end, pick) ^ right ^ above
    }))
}

/// Two cloths one above the other, woven end and end, pick and pick: the first end and pick
/// belong to the face cloth. Face ends rise over every back pick, back ends stay under
/// every face pick; nothing stitches the cloths. One layer shows it as a map only.
///
/// # Errors
/// [`CombineError::Size`] if the repeat is too large.
pub fn double_cloth(
    face: &WeavePattern,
    back: &WeavePattern,
) -> Result<WeavePattern, CombineError> {
    let (ends, picks) = common(face, back)?;
    check_size(2 * u64::from(ends), 2 * u64::from(picks))?;
    Ok(WeavePattern::from_fn(2 * ends, 2 * picks, |end, pick| {
        let (e, p) = (i64::from(end / 2), i64::from(pick / 2));
        match (end % 2, pick % 2) {
            (0, 0) => face.get_wrapped(e, p),
            (0, _) => true,
            (_, 0) => false,
            _ => back.get_wrapped(e, p),
        }
    }))
}

/// `steps` weaves that lead from one to another by adding marks, both included: shading, as
/// from a weft satin through to its warp satin.
///
/// The second weave is laid where it covers the first (the smallest shift that does); marks
/// grow upwards from those of the first, all threads by one mark before any by two. Each
/// step covers the one before, so no float on the face is longer than the last weave's
/// and none on the back longer than the first's.
///
/// # Errors
/// [`CombineError`] if no shift makes the second cover the first, or the steps are fewer
/// than 2 or more than there are marks to add.
pub fn shadow_series(
    from: &WeavePattern,
    to: &WeavePattern,
    steps: u32,
) -> Result<Vec<WeavePattern>, CombineError> {
    if steps < 2 {
        return Err(CombineError::Steps(steps));
    }
    let (ends, picks) = common(from, to)?;
    let from = from.repeated(ends, picks, (0, 0));
    let to = covering(&from, to).ok_or(CombineError::NotShaded)?;
    let order = growth(&from, &to);
    if u64::from(steps) - 1 > order.len().max(1) as u64 {
        return Err(CombineError::TooManySteps {
            steps,
            most: order.len() as u64 + 1,
        });
    }
    let mut series = Vec::with_capacity(steps as usize);
    let mut weave = from;
    let mut added = 0;
    for step in 0..steps {
        let wanted = (order.len() as u64 * u64::from(step) / u64::from(steps - 1)) as usize;
        for &(_, _, end, pick) in &order[added..wanted] {
            weave.set(end, pick, true);
        }
        added = wanted;
        series.push(weave.clone());
    }
    Ok(series)
}

/// `to`, shifted by as little as makes it cover every mark of `from`, over `from`'s size.
fn covering(from: &WeavePattern, to: &WeavePattern) -> Option<WeavePattern> {
    for up in 0..to.picks() {
        for right in 0..to.ends() {
            let (across, along) = (right as i32, up as i32);
            let laid = to.repeated(from.ends(), from.picks(), (across, along));
            let covers = (0..from.picks()).all(|pick| {
                let pairs = from.pick_words(pick).zip(laid.pick_words(pick));
                pairs.into_iter().all(|(from, to)| from & !to == 0)
            });
            if covers {
                return Some(laid);
            }
        }
    }
    None
}

/// The crossings to mark between two weaves, in order: (picks above the mark it grows from,
/// place in its round, end, pick).
fn growth(from: &WeavePattern, to: &WeavePattern) -> Vec<(u32, u32, u32, u32)> {
    let (ends, picks) = (from.ends(), from.picks());
    let mut order = Vec::new();
    for pick in 0..picks {
        for end in 0..ends {
            if !to.get(end, pick) || from.get(end, pick) {
                continue;
            }
            let below = |by: &u32| from.get(end, (pick + picks - by) % picks);
            let height = (1..picks).find(below).unwrap_or(picks);
            // Within a round the picks come in bit-reversed order, which spreads them.
            order.push((height, pick.reverse_bits(), end, pick));
        }
    }
    order.sort_unstable();
    order
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::super::weave;
    use super::*;
    use crate::design::floats::longest_float;

    fn art(text: &str) -> WeavePattern {
        WeavePattern::parse(text).unwrap()
    }

    #[test]
    fn either_and_both_meet_on_the_common_repeat() {
        let (twos, threes) = (art("#.\n.#"), art("#..\n..#\n.#."));
        let union = either(&twos, &threes).unwrap();
        assert_eq!((union.ends(), union.picks()), (6, 6));
        let section = both(&twos, &threes).unwrap();
        let marks = twos.count_warp_up() * 9 + threes.count_warp_up() * 4;
        assert_eq!(union.count_warp_up() + section.count_warp_up(), marks);
        assert_ne!(union, section);
        let long = WeavePattern::new(65_521, 1);
        let other = WeavePattern::new(65_519, 1);
        assert!(matches!(either(&long, &other), Err(CombineError::Size(_))));
    }

    #[test]
    fn a_half_drop_repeats_after_two() {
        let mark = art(".\n#");
        assert_eq!(drop_repeat(&mark, 1).unwrap(), art(".#\n#."));
        let twill = art("..#\n.#.\n#..");
        // Every end a pick higher than the last: three repeats of three ends.
        let dropped = drop_repeat(&twill, 1).unwrap();
        assert_eq!((dropped.ends(), dropped.picks()), (9, 3));
        assert_eq!(drop_repeat(&twill, 3).unwrap(), twill);
        assert_eq!(repeated(&mark, 2, 1).unwrap(), art("..\n##"));
        assert!(repeated(&mark, 0, 1).is_err());
        assert!(repeated(&twill, u32::MAX, u32::MAX).is_err());
    }

    #[test]
    fn a_shading_of_satins_grows_a_mark_a_step() {
        let weft = weave("1/7 satin move 3").unwrap();
        let warp = weave("7/1 satin move 3").unwrap();
        let series = shadow_series(&weft, &warp, 7).unwrap();
        for (step, weave) in series.iter().enumerate() {
            assert_eq!(weave.count_warp_up(), 8 * (step as u64 + 1));
            let floats = longest_float(weave);
            assert_eq!(floats.warp_face as usize, step + 1, "{weave}");
        }
        assert_eq!(series[0], weft);
        assert_eq!(series[3], weave("4/4 satin move 3").unwrap());
        assert_eq!(series[6].count_warp_up(), warp.count_warp_up());
    }

    #[test]
    fn shadings_that_cannot_be_are_refused() {
        let weft = weave("1/7 satin move 3").unwrap();
        let warp = weave("7/1 satin move 3").unwrap();
        assert_eq!(shadow_series(&warp, &weft, 4), Err(CombineError::NotShaded));
        assert_eq!(shadow_series(&weft, &warp, 1), Err(CombineError::Steps(1)));
        let most = shadow_series(&weft, &warp, 50).unwrap_err().to_string();
        assert!(most.contains("at most 49"), "{most}");
        assert_eq!(shadow_series(&weft, &warp, 49).unwrap().len(), 49);
        // From a weave to itself there is nothing to add, but there are two ends.
        assert_eq!(
            shadow_series(&weft, &weft, 2).unwrap(),
            [weft.clone(), weft]
        );
    }

    #[test]
    fn rearranged_threads_are_counted_from_one() {
        let twill = weave("1/3 twill").unwrap();
        let broken = rearranged(&twill, &[], &[1, 2, 4, 3]).unwrap();
        assert_eq!(broken, art("..#.\n...#\n.#..\n#..."));
        let error = rearranged(&twill, &[0], &[]).unwrap_err().to_string();
        assert!(error.contains("thread 0"), "{error}");
        assert!(rearranged(&twill, &[5], &[]).is_err());
    }
}
