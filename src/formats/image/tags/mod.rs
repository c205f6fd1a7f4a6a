//! What an image's file says beside its pixels: how it is turned, how its resolution is
//! meant, in which colours it is. One rule for every way in.
//!
//! Each format's chunks are walked within the bytes of the file, so nothing is unpacked but
//! colour profiles, and of these no more than [`profile::MOST`]. Orientation is followed
//! ([`Turn`]), resolution is the sett, colours other than sRGB's are taken as sRGB and
//! remarked on. `exif` reads TIFF directories, which EXIF is too; `turn` turns pixels.

mod exif;
mod fields;
mod jpeg;
mod legacy;
mod png;
mod profile;
mod turn;

pub use fields::TABLES;
pub(super) use turn::Turn;

use super::Encoding;
use exif::Directory;

/// What a file says of its pixels.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tags {
    /// How the stored pixels are turned to be seen.
    pub turn: Turn,
    /// Stored pixels per cm across and down.
    pub per_cm: Option<(f32, f32)>,
    /// Width over height of a pixel, where that is all that is known.
    pub aspect: Option<f32>,
    /// Whether colours are stored as four inks.
    pub inks: bool,
    /// One line each.
    pub warnings: Vec<String>,
}

/// Widths over heights of a pixel that are taken for square.
const SQUARE: std::ops::RangeInclusive<f32> = 0.99..=1.01;

impl Tags {
    /// What the bytes of a file say.
    pub fn of(bytes: &[u8], encoding: Encoding) -> Self {
        let mut tags = Self::default();
        match encoding {
            Encoding::Png => png::read(bytes, &mut tags),
            Encoding::Jpeg => jpeg::read(bytes, &mut tags),
            Encoding::Tiff => exif::read_tiff(bytes, &mut tags),
            Encoding::WebP => legacy::webp(bytes, &mut tags),
            Encoding::Gif => legacy::gif(bytes, &mut tags),
            Encoding::Bmp => legacy::bmp(bytes, &mut tags),
            Encoding::Pcx => legacy::pcx(bytes, &mut tags),
        }
        if let Some(aspect) = tags.aspect.filter(|aspect| !SQUARE.contains(aspect)) {
            tags.warn(format!(
                "its pixels are stated to be {aspect:.3} times as wide as high ({}), which gives no \
                 sett and is not followed",
                match encoding {
                    Encoding::Png => "pHYs without a unit",
                    Encoding::Gif => "pixel aspect ratio",
                    Encoding::Jpeg => "JFIF density without a unit",
                    _ => "ResolutionUnit none",
                }
            ));
        }
        tags
    }

    fn warn(&mut self, line: String) {
        super::remark(&mut self.warnings, &line);
    }

    /// Takes over what EXIF says, as far as it is not known yet.
    fn exif(&mut self, block: &[u8]) {
        let Some(directory) = Directory::first(block) else {
            return self.warn("its EXIF block is damaged and is not followed".to_owned());
        };
        self.directory(&directory);
        if let Some(inner) = directory.inner(exif::EXIF)
            && inner
                .number(exif::COLOUR_SPACE)
                .is_some_and(|space| space != 1)
            && !self.warnings.iter().any(|line| line.contains("profile"))
        {
            self.warn(
                "its EXIF ColorSpace is not sRGB and is not applied, colours are taken as sRGB: \
                 convert it to sRGB for true colours"
                    .to_owned(),
            );
        }
    }

    /// Orientation and resolution of a directory.
    fn directory(&mut self, directory: &Directory<'_>) {
        if let Some(stated) = directory.number(exif::ORIENTATION) {
            match Turn::of_tag(stated) {
                Some(turn) => self.turn = turn,
                None => self.warn(format!(
                    "its orientation is stated as {stated}, which means nothing: it is read as it \
                     is stored"
                )),
            }
        }
        let sides = [exif::X_RESOLUTION, exif::Y_RESOLUTION].map(|tag| directory.ratio(tag));
        let [Some(across), Some(down)] = sides else {
            return;
        };
        match directory.number(exif::RESOLUTION_UNIT).unwrap_or(2) {
            2 => self.resolution(across / 2.54, down / 2.54),
            3 => self.resolution(across, down),
            _ => self.aspect = Some(down / across),
        }
    }

    /// Takes over pixels per cm where none are known.
    fn resolution(&mut self, across: f32, down: f32) {
        let sound = across.is_finite() && down.is_finite() && across > 0.0 && down > 0.0;
        if sound && self.per_cm.is_none() {
            self.per_cm = Some((across, down));
        }
    }

    /// Remarks on a colour profile that is not sRGB's; `field` is what its format calls it.
    fn profile(&mut self, profile: &[u8], field: &str) {
        if profile.len() > profile::MOST {
            return self.too_large(field);
        }
        if let Some(space) = profile::foreign(profile) {
            self.warn(format!(
                "its colour profile ({space}, {field}) is not applied, colours are taken as sRGB: \
                 convert it to sRGB for true colours"
            ));
        }
    }

    fn too_large(&mut self, field: &str) {
        self.warn(format!(
            "its colour profile ({field}) is larger than {} and is ignored, colours are taken as \
             sRGB",
            crate::memory::size(profile::MOST as u64)
        ));
    }
}

/// A number of two bytes, the higher first.
fn u16_be(bytes: &[u8], at: usize) -> Option<u16> {
    let two = bytes.get(at..)?.first_chunk()?;
    Some(u16::from_be_bytes(*two))
}

/// A number of two bytes, the lower first.
fn u16_le(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16_be(bytes, at)?.swap_bytes())
}

/// A number of four bytes, the higher first.
fn u32_be(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_be_bytes(*four))
}

/// A number of four bytes, the lower first.
fn u32_le(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32_be(bytes, at)?.swap_bytes())
}
