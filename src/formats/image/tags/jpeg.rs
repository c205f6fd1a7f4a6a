//! JPEG's segments before its pixels: JFIF, EXIF, colour profiles (ICC.1, annex B.4).

use super::{Tags, profile, u16_be};

pub(super) fn read(bytes: &[u8], tags: &mut Tags) {
    let mut at = 2;
    // Parts of the profile, in the order of their numbers.
    let mut parts: Vec<(u8, &[u8])> = Vec::new();
    let mut exif = None;
    while let (Some(&0xff), Some(&marker)) = (bytes.get(at), bytes.get(at + 1)) {
        if marker == 0xff {
            at += 1;
            continue;
        }
        let Some(length) = u16_be(bytes, at + 2).map(usize::from) else {
            break;
        };
        let body = bytes
            .get(at + 4..at + 2 + length.max(2))
            .unwrap_or_default();
        match marker {
            0xe0 if body.starts_with(b"JFIF\0") => density(body, tags),
            0xe1 if body.starts_with(b"Exif\0\0") => exif = exif.or(body.get(6..)),
            0xe2 if body.starts_with(b"ICC_PROFILE\0") => {
                if let (Some(&number), Some(part)) = (body.get(12), body.get(14..)) {
                    parts.push((number, part));
                }
            }
            // Start of frame, all kinds; C4, C8 and CC are other things.
            0xc0..=0xcf if !matches!(marker, 0xc4 | 0xc8 | 0xcc) => {
                tags.inks = body.get(5) == Some(&4);
            }
            // Pixels follow.
            0xda | 0xd9 => break,
            _ => {}
        }
        at += 2 + length.max(2);
    }
    parts.sort_by_key(|part| part.0);
    let length: usize = parts.iter().map(|part| part.1.len()).sum();
    if length > profile::MOST {
        tags.too_large("ICC_PROFILE");
    } else if length > 0 {
        let whole: Vec<u8> = parts.iter().flat_map(|part| part.1).copied().collect();
        tags.profile(&whole, "ICC_PROFILE");
    }
    if let Some(block) = exif {
        tags.exif(block);
    }
}

/// Dots an inch or a cm, or only their ratio.
fn density(body: &[u8], tags: &mut Tags) {
    let (Some(&unit), Some(across), Some(down)) = (body.get(7), u16_be(body, 8), u16_be(body, 10))
    else {
        return;
    };
    let (across, down) = (f32::from(across), f32::from(down));
    match unit {
        1 => tags.resolution(across / 2.54, down / 2.54),
        2 => tags.resolution(across, down),
        _ if across > 0.0 && down > 0.0 => tags.aspect = Some(down / across),
        _ => {}
    }
}
