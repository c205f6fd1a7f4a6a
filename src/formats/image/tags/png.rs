//! PNG's chunks beside its pixels (PNG 3rd edition, §11.3).

use super::{Tags, profile, u32_be};

/// Gamma of sRGB, and how far another may be from it.
const GAMMA: (u32, u32) = (45_455, 1_500);
/// White and primaries of sRGB in x and y, times 100 000.
const CHROMATICITIES: [u32; 8] = [
    31_270, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000,
];
/// A difference that is rounding.
const ROUNDING: u32 = 500;

/// The chunks that say which colours are meant.
#[derive(Default)]
struct Colours<'b> {
    cicp: Option<&'b [u8]>,
    iccp: Option<&'b [u8]>,
    srgb: bool,
    gamma: Option<u32>,
    chromaticities: Option<&'b [u8]>,
}

pub(super) fn read(bytes: &[u8], tags: &mut Tags) {
    let mut at = 8;
    let mut colours = Colours::default();
    while let (Some(length), Some(kind)) = (u32_be(bytes, at), bytes.get(at + 4..at + 8)) {
        let from = at + 8;
        let Some(body) = bytes.get(from..from.saturating_add(length as usize)) else {
            break;
        };
        match kind {
            b"eXIf" => tags.exif(body),
            b"iCCP" => colours.iccp = Some(body),
            b"cICP" => colours.cicp = Some(body),
            b"sRGB" => colours.srgb = true,
            b"gAMA" => colours.gamma = u32_be(body, 0),
            b"cHRM" => colours.chromaticities = Some(body),
            b"pHYs" => resolution(body, tags),
            b"acTL" if u32_be(body, 0).is_some_and(|frames| frames > 1) => {
                tags.warn("only the first picture of the animation (acTL) is read".to_owned());
            }
            _ => {}
        }
        at = from + length as usize + 4;
    }
    colours.remark(tags);
}

/// Pixels a metre, or only their ratio.
fn resolution(body: &[u8], tags: &mut Tags) {
    let (Some(across), Some(down), Some(&unit)) = (u32_be(body, 0), u32_be(body, 4), body.get(8))
    else {
        return;
    };
    match unit {
        1 => tags.resolution(across as f32 / 100.0, down as f32 / 100.0),
        _ if across > 0 && down > 0 => tags.aspect = Some(down as f32 / across as f32),
        _ => {}
    }
}

impl Colours<'_> {
    /// The first of them in the specification's order of precedence counts.
    fn remark(&self, tags: &mut Tags) {
        let remedy = "colours are taken as sRGB: convert it to sRGB for true colours";
        if let Some(space) = self.cicp {
            // Rec. 709 primaries, sRGB's curve, no matrix, full range.
            if space != [1, 13, 0, 1] {
                tags.warn(format!(
                    "its colour space (cICP {space:?}) is not applied, {remedy}"
                ));
            }
            return;
        }
        if let Some(body) = self.iccp {
            let name = body.iter().position(|&byte| byte == 0);
            let packed = name.and_then(|end| body.get(end + 2..)).unwrap_or_default();
            match profile::unpacked(packed) {
                Some(profile) if profile.is_empty() => {
                    tags.warn(format!(
                        "its colour profile (iCCP) is damaged and ignored, {remedy}"
                    ));
                }
                Some(profile) => tags.profile(&profile, "iCCP"),
                None => tags.too_large("iCCP"),
            }
            return;
        }
        if self.srgb {
            return;
        }
        if let Some(gamma) = self.gamma
            && gamma.abs_diff(GAMMA.0) > GAMMA.1
        {
            let gamma = f64::from(gamma) / 1e5;
            tags.warn(format!("its gamma (gAMA {gamma}) is not applied, {remedy}"));
        }
        if let Some(body) = self.chromaticities {
            let said = |at: usize| u32_be(body, 4 * at);
            let usual = CHROMATICITIES.iter().enumerate();
            let same = |(at, usual): (usize, &u32)| {
                said(at).is_some_and(|said| said.abs_diff(*usual) <= ROUNDING)
            };
            if !usual.into_iter().all(same) {
                tags.warn(format!("its primaries (cHRM) are not applied, {remedy}"));
            }
        }
    }
}
