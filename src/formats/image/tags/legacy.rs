//! WebP's chunks, GIF's and BMP's headers and PCX's.

use super::{Tags, u16_le, u32_be, u32_le};

/// Chunks of the container (RIFF): profile, EXIF, animation.
pub(super) fn webp(bytes: &[u8], tags: &mut Tags) {
    let mut at = 12;
    while let (Some(kind), Some(length)) = (bytes.get(at..at + 4), u32_le(bytes, at + 4)) {
        let from = at + 8;
        let Some(body) = bytes.get(from..from.saturating_add(length as usize)) else {
            break;
        };
        match kind {
            b"ICCP" => tags.profile(body, "ICCP"),
            // Some programs begin it as in a JPEG.
            b"EXIF" => tags.exif(body.strip_prefix(b"Exif\0\0").unwrap_or(body)),
            b"ANIM" => {
                tags.warn("only the first picture of the animation (ANIM) is read".to_owned());
            }
            _ => {}
        }
        at = from + length as usize + length as usize % 2;
    }
}

/// The extension that holds a colour profile, as it begins.
const GIF_PROFILE: &[u8] = b"\x21\xff\x0bICCRGBG1012";

/// Shape of pixels and colour profile.
pub(super) fn gif(bytes: &[u8], tags: &mut Tags) {
    if let Some(&stated) = bytes.get(12).filter(|&&stated| stated > 0) {
        tags.aspect = Some((f32::from(stated) + 15.0) / 64.0);
    }
    let Some(found) = (bytes.windows(GIF_PROFILE.len())).position(|part| part == GIF_PROFILE)
    else {
        return;
    };
    // Blocks of up to 255 bytes, each behind its length.
    let mut profile = Vec::new();
    let mut at = found + GIF_PROFILE.len();
    while let Some(&length) = bytes.get(at).filter(|&&length| length > 0) {
        let Some(block) = bytes.get(at + 1..at + 1 + usize::from(length)) else {
            break;
        };
        profile.extend_from_slice(block);
        if profile.len() > super::profile::MOST {
            break;
        }
        at += 1 + usize::from(length);
    }
    tags.profile(&profile, "ICCRGBG1012");
}

/// The colour space of headers of version 4 and 5 (BITMAPV5HEADER, bV5CSType).
pub(super) fn bmp(bytes: &[u8], tags: &mut Tags) {
    const HEADER: usize = 14;
    let header = u32_le(bytes, HEADER).unwrap_or(0);
    let Some(space) = (header >= 108)
        .then(|| u32_be(bytes, HEADER + 56))
        .flatten()
    else {
        return;
    };
    match &space.swap_bytes().to_be_bytes() {
        b"sRGB" | b"Win " => {}
        b"MBED" => {
            let field = |at: usize| u32_le(bytes, HEADER + at).map(|value| value as usize);
            let found = field(112).zip(field(116)).and_then(|(from, length)| {
                let from = from.checked_add(HEADER)?;
                bytes.get(from..from.checked_add(length)?)
            });
            match found {
                Some(profile) => tags.profile(profile, "CSType MBED"),
                None => tags.warn("its colour profile (CSType MBED) is damaged".to_owned()),
            }
        }
        [0, 0, 0, 0] => {
            // Its own primaries, unless they are left out.
            let primaries = bytes.get(HEADER + 60..HEADER + 96).unwrap_or_default();
            if primaries.iter().any(|&byte| byte > 0) {
                tags.warn(
                    "its primaries (CSType calibrated) are not applied, colours are taken as sRGB: \
                     convert it to sRGB for true colours"
                        .to_owned(),
                );
            }
        }
        _ => tags.warn(
            "its colour space (CSType) is not applied, colours are taken as sRGB: convert it to \
             sRGB for true colours"
                .to_owned(),
        ),
    }
}

/// Dots an inch, in which programs write what they like: sizes of images and of screens.
pub(super) fn pcx(bytes: &[u8], tags: &mut Tags) {
    let [Some(across), Some(down)] = [u16_le(bytes, 12), u16_le(bytes, 14)] else {
        return;
    };
    let word = |at: usize| u16_le(bytes, at).unwrap_or(0);
    let size = |first: usize, last: usize| word(last).wrapping_sub(word(first)).wrapping_add(1);
    let (width, height) = (size(4, 8), size(6, 10));
    let nothing = [0, 72, 75, 96, 300];
    let screens = [(320, 200), (640, 350), (640, 480), (800, 600), (1024, 768)];
    let meant = !(nothing.contains(&across) && nothing.contains(&down))
        && (across, down) != (width, height)
        && !screens.contains(&(across, down));
    if meant {
        tags.warn(format!(
            "its resolution (HDpi {across}, VDpi {down}) is not followed, since many programs write \
             something else there: give --sett"
        ));
    }
}
