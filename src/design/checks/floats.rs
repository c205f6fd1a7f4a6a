//! Floats as the cloth repeats: in threads and mm, those across the seam apart.
//!
//! The straight repeat runs round; a dropped one meets its neighbour higher up; a panel
//! ends. A dropped repeat is laid out to the straight repeat it comes to, where that is
//! of a size to look through, and counts as straight where it is not.

use crate::design::document::Design;
use crate::design::floats::{FloatKind, FloatLengths, FloatReport, floats};
use crate::design::lattice::Repeat;
use crate::design::pattern::WeavePattern;
use crate::design::weaves::drop_repeat;

/// The largest straight repeat that a dropped one is laid out to, in crossings.
const LARGEST_LAID_OUT: u64 = 1 << 24;

/// A float's length.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FloatLength {
    /// Threads that it passes over or under.
    pub threads: u32,
    /// The same in mm: threads × mean pitch.
    pub mm: f32,
}

/// One length for each kind of float.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FloatLengthsMm {
    /// Ends on the face.
    pub warp_face: FloatLength,
    /// Ends on the back.
    pub warp_back: FloatLength,
    /// Picks on the face.
    pub weft_face: FloatLength,
    /// Picks on the back.
    pub weft_back: FloatLength,
}

impl FloatLengthsMm {
    fn new(lengths: FloatLengths, end_pitch_mm: f32, pick_pitch_mm: f32) -> Self {
        let over = |threads: u32, pitch_mm: f32| FloatLength {
            threads,
            mm: threads as f32 * pitch_mm,
        };
        Self {
            warp_face: over(lengths.warp_face, pick_pitch_mm),
            warp_back: over(lengths.warp_back, pick_pitch_mm),
            weft_face: over(lengths.weft_face, end_pitch_mm),
            weft_back: over(lengths.weft_back, end_pitch_mm),
        }
    }

    /// Each with its kind.
    pub fn kinds(&self) -> [(FloatKind, FloatLength); 4] {
        [
            (FloatKind::WarpFace, self.warp_face),
            (FloatKind::WarpBack, self.warp_back),
            (FloatKind::WeftFace, self.weft_face),
            (FloatKind::WeftBack, self.weft_back),
        ]
    }
}

/// A float that arises where repeats meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeamLength {
    /// Direction and face.
    pub kind: FloatKind,
    /// The end or pick, from 0.
    pub thread: u32,
    /// How long it is.
    pub length: FloatLength,
}

/// What [`lattice_floats`] finds.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeFloats {
    /// The longest as the cloth repeats.
    pub longest: FloatLengthsMm,
    /// The longest within one repeat.
    pub inside: FloatLengthsMm,
    /// Those across the seam that are longer than any of their kind within.
    pub seams: Vec<SeamLength>,
    /// Ends that lie on one face throughout.
    pub unbound_ends: Vec<u32>,
    /// Picks that lie on one face throughout.
    pub unbound_picks: Vec<u32>,
}

/// The longest floats of a design as its lattice repeats it. `weave` is its drawdown.
pub fn lattice_floats(design: &Design, weave: &WeavePattern) -> LatticeFloats {
    let lattice = design.lattice();
    let straight = floats(weave);
    let mut found = match laid_out(weave, lattice.across, lattice.along) {
        Some(whole) => dropped(&straight, &whole, weave),
        None => straight,
    };
    // Where the cloth ends there is no seam.
    if lattice.across == Repeat::None {
        found.longest.weft_face = found.longest_inside.weft_face;
        found.longest.weft_back = found.longest_inside.weft_back;
        found.seam.retain(|seam| is_warp(seam.kind));
    }
    if lattice.along == Repeat::None {
        found.longest.warp_face = found.longest_inside.warp_face;
        found.longest.warp_back = found.longest_inside.warp_back;
        found.seam.retain(|seam| !is_warp(seam.kind));
    }
    let end_pitch = design.sett().ends.mean_pitch_mm();
    let pick_pitch = design.sett().picks.mean_pitch_mm();
    let seams = found.seam.iter().map(|seam| {
        let pitch = if is_warp(seam.kind) {
            pick_pitch
        } else {
            end_pitch
        };
        let (threads, mm) = (seam.length, seam.length as f32 * pitch);
        SeamLength {
            kind: seam.kind,
            thread: seam.thread,
            length: FloatLength { threads, mm },
        }
    });
    LatticeFloats {
        seams: seams.collect(),
        longest: FloatLengthsMm::new(found.longest, end_pitch, pick_pitch),
        inside: FloatLengthsMm::new(found.longest_inside, end_pitch, pick_pitch),
        unbound_ends: found.unbound_ends,
        unbound_picks: found.unbound_picks,
    }
}

fn is_warp(kind: FloatKind) -> bool {
    matches!(kind, FloatKind::WarpFace | FloatKind::WarpBack)
}

/// The straight repeat of a dropped one, if it is dropped and that is not too large.
fn laid_out(weave: &WeavePattern, across: Repeat, along: Repeat) -> Option<WeavePattern> {
    let small = |threads: u32, drop: u32, other: u32| {
        let crossings = u64::from(threads) * u64::from(other);
        // A drop by one needs as many repeats as there are threads to drop over.
        drop != 0 && crossings.saturating_mul(u64::from(other)) <= LARGEST_LAID_OUT
    };
    match (across, along) {
        (Repeat::Dropped(by), _) if small(weave.ends(), by, weave.picks()) => {
            drop_repeat(weave, by).ok()
        }
        (_, Repeat::Dropped(by)) if small(weave.picks(), by, weave.ends()) => {
            let whole = drop_repeat(&weave.transposed(), by).ok()?;
            Some(whole.transposed())
        }
        _ => None,
    }
}

/// The report of a dropped repeat: lengths of the laid-out whole, threads of the weave.
fn dropped(own: &FloatReport, whole: &WeavePattern, weave: &WeavePattern) -> FloatReport {
    let all = floats(whole);
    let first = |threads: &[u32], period: u32| {
        let mut own: Vec<u32> = threads.iter().map(|thread| thread % period).collect();
        own.sort_unstable();
        own.dedup();
        own
    };
    let inside = own.longest_inside;
    let pairs = [
        (FloatKind::WarpFace, all.longest.warp_face, inside.warp_face),
        (FloatKind::WarpBack, all.longest.warp_back, inside.warp_back),
        (FloatKind::WeftFace, all.longest.weft_face, inside.weft_face),
        (FloatKind::WeftBack, all.longest.weft_back, inside.weft_back),
    ];
    let seam = pairs.into_iter().filter(|(_, longest, own)| longest > own);
    FloatReport {
        longest: all.longest,
        longest_inside: inside,
        seam: seam
            .map(|(kind, length, _)| crate::design::SeamFloat {
                kind,
                thread: thread_with(whole, kind, length)
                    % if is_warp(kind) {
                        weave.ends()
                    } else {
                        weave.picks()
                    },
                length,
            })
            .collect(),
        unbound_ends: first(&all.unbound_ends, weave.ends()),
        unbound_picks: first(&all.unbound_picks, weave.picks()),
    }
}

/// The first thread with a float of a kind and length.
fn thread_with(weave: &WeavePattern, kind: FloatKind, length: u32) -> u32 {
    let turned;
    let (along, bit) = match kind {
        FloatKind::WarpFace | FloatKind::WarpBack => {
            turned = weave.transposed();
            (&turned, kind == FloatKind::WarpFace)
        }
        FloatKind::WeftFace => (weave, false),
        FloatKind::WeftBack => (weave, true),
    };
    let (places, threads) = (along.ends(), along.picks());
    let longest = |thread: u32| {
        let (mut longest, mut run) = (0, 0);
        for place in 0..2 * places {
            run = if along.get(place % places, thread) == bit {
                run + 1
            } else {
                0
            };
            longest = longest.max(run);
        }
        longest.min(places)
    };
    (0..threads)
        .find(|&thread| longest(thread) >= length)
        .unwrap_or(0)
}
