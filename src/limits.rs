//! Limits of the numbers that people and files give.
//!
//! Parsers, dialogs, readers and messages take them from here, so that what one door lets
//! in no other refuses; `ui/docs/limits.md` lists [`table`].

use std::ops::RangeInclusive;

/// Ends or picks per cm that can be woven.
pub const SETT_PER_CM: RangeInclusive<f32> = 0.5..=500.0;

/// The same as a pitch in mm.
pub const PITCH_MM: RangeInclusive<f32> = 0.02..=20.0;

/// Pitch in mm of a single thread, where threads lie unequally.
pub const THREAD_PITCH_MM: RangeInclusive<f32> = 0.001..=100.0;

/// Most crossings of a design.
pub const CROSSINGS: u64 = 1 << 29;

/// Most ends, and most picks, of a design: what is known of each thread takes memory as well.
pub const THREADS: u64 = 1 << 20;

/// Most ends or picks that a draft file may declare.
pub const DRAFT_THREADS: u32 = 100_000;

/// Most shafts, and most treadles.
pub const SHAFTS: u32 = 65_535;

/// Most yarns of a design: a crossing names its yarns in 16 bits.
pub const YARNS: usize = 1 << 16;

/// Most crossings of yarns that are exported as curves and tubes.
pub const YARN_CROSSINGS: u64 = 1 << 16;

/// Pixels of a picture, each way.
pub const PICTURE_SIDE: RangeInclusive<u32> = 1..=16_384;

/// Width of cloth that a picture shows, mm.
pub const PICTURE_MM: RangeInclusive<f32> = 0.01..=100_000.0;

/// The middle of a picture, mm from the first crossing, each way.
pub const CENTRE_MM: RangeInclusive<f32> = -1e9..=1e9;

/// Paths a pixel of a still.
pub const STILL_SPP: RangeInclusive<u32> = 1..=1_000_000;

/// Largest file of a design or draft, bytes.
pub const FILE: u64 = 1 << 28;

/// Ends or picks per inch.
pub fn sett_per_inch() -> RangeInclusive<f32> {
    SETT_PER_CM.start() * CM_PER_INCH..=SETT_PER_CM.end() * CM_PER_INCH
}

const CM_PER_INCH: f32 = 2.54;

/// Whether threads of this pitch in mm can be woven, for all that is lost in going from
/// threads per cm and back.
pub fn can_be_woven(pitch_mm: f32) -> bool {
    const ROUNDING: f32 = 1e-5;
    (PITCH_MM.start() * (1.0 - ROUNDING)..=PITCH_MM.end() * (1.0 + ROUNDING)).contains(&pitch_mm)
}

/// "0.5 to 500", for a message.
pub fn in_words(range: &RangeInclusive<f32>) -> String {
    let [least, most] = [range.start(), range.end()].map(|end| (end * 1e4).round() / 1e4);
    format!("{least} to {most}")
}

/// "1 to 500", for a message.
pub fn whole(range: &RangeInclusive<u32>) -> String {
    format!("{} to {}", range.start(), range.end())
}

/// One limit: of what, and how far it goes.
pub type Limit = (&'static str, String);

/// All limits, as `ui/docs/limits.md` lists them.
pub fn table() -> Vec<Limit> {
    vec![
        ("threads per cm", in_words(&SETT_PER_CM)),
        ("pitch of a single thread, mm", in_words(&THREAD_PITCH_MM)),
        ("crossings of a design", CROSSINGS.to_string()),
        ("ends or picks of a design", THREADS.to_string()),
        ("ends or picks of a draft file", DRAFT_THREADS.to_string()),
        ("shafts and treadles", SHAFTS.to_string()),
        ("yarns of a design", YARNS.to_string()),
        ("crossings of exported yarns", YARN_CROSSINGS.to_string()),
        ("pixels of a picture, each way", whole(&PICTURE_SIDE)),
        ("width of a picture, mm", in_words(&PICTURE_MM)),
        (
            "middle of a picture, mm from the first crossing",
            in_words(&CENTRE_MM),
        ),
        ("paths a pixel of a still", whole(&STILL_SPP)),
        (
            "MiB of a file of a design or draft",
            (FILE >> 20).to_string(),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sett_and_its_pitch_are_the_same_limit() {
        for (per_cm, pitch) in [
            (SETT_PER_CM.start(), PITCH_MM.end()),
            (SETT_PER_CM.end(), PITCH_MM.start()),
        ] {
            assert!((10.0 / per_cm / pitch - 1.0).abs() < 1e-6);
            assert!(can_be_woven(10.0 / per_cm) && can_be_woven(*pitch));
            // Through inches and back.
            assert!(can_be_woven(10.0 / (per_cm * CM_PER_INCH / CM_PER_INCH)));
        }
        for pitch in [0.0199, 20.01, 0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(!can_be_woven(pitch), "{pitch}");
        }
        assert_eq!(in_words(&SETT_PER_CM), "0.5 to 500");
        assert_eq!(in_words(&sett_per_inch()), "1.27 to 1270");
    }
}
