//! Directories of TIFF 6.0 and BigTIFF, which EXIF blocks are too.

use super::{Tags, u16_be, u16_le, u32_be, u32_le};

pub(super) const ORIENTATION: u16 = 274;
pub(super) const X_RESOLUTION: u16 = 282;
pub(super) const Y_RESOLUTION: u16 = 283;
pub(super) const RESOLUTION_UNIT: u16 = 296;
/// Where the EXIF directory lies.
pub(super) const EXIF: u16 = 0x8769;
pub(super) const COLOUR_SPACE: u16 = 0xa001;
const PROFILE: u16 = 34_675;
const INK_SET: u16 = 332;
/// Colours that are not described by a profile, as the specification calls them.
const COLOURS: [(u16, &str); 3] = [
    (301, "TransferFunction"),
    (318, "WhitePoint"),
    (319, "PrimaryChromaticities"),
];

/// The most entries of a directory that are looked at.
const MOST_ENTRIES: u64 = 4096;

/// A list of fields within a block of bytes.
pub(super) struct Directory<'b> {
    bytes: &'b [u8],
    big_endian: bool,
    wide: bool,
    at: usize,
    entries: u64,
}

impl<'b> Directory<'b> {
    /// The first directory of a block.
    pub fn first(bytes: &'b [u8]) -> Option<Self> {
        let (big_endian, wide) = match bytes.get(..4)? {
            b"II*\0" => (false, false),
            b"MM\0*" => (true, false),
            b"II+\0" => (false, true),
            b"MM\0+" => (true, true),
            _ => return None,
        };
        let block = Self {
            bytes,
            big_endian,
            wide,
            at: 0,
            entries: 0,
        };
        let at = if wide {
            block.long(8)?
        } else {
            block.int(4)?.into()
        };
        block.directory(at)
    }

    fn directory(&self, at: u64) -> Option<Self> {
        let at = usize::try_from(at).ok()?;
        let (entries, from) = match self.wide {
            true => (self.long(at)?, at.checked_add(8)?),
            false => (self.short(at)?.into(), at.checked_add(2)?),
        };
        Some(Self {
            at: from,
            entries: entries.min(MOST_ENTRIES),
            ..*self
        })
    }

    /// The directory that a field points to.
    pub fn inner(&self, tag: u16) -> Option<Self> {
        self.directory(self.number(tag)?)
    }

    fn short(&self, at: usize) -> Option<u16> {
        match self.big_endian {
            true => u16_be(self.bytes, at),
            false => u16_le(self.bytes, at),
        }
    }

    fn int(&self, at: usize) -> Option<u32> {
        match self.big_endian {
            true => u32_be(self.bytes, at),
            false => u32_le(self.bytes, at),
        }
    }

    fn long(&self, at: usize) -> Option<u64> {
        let four = [at, at.checked_add(4)?].map(|at| self.int(at).map(u64::from));
        let four = [four[0]?, four[1]?];
        Some(match self.big_endian {
            true => four[0] << 32 | four[1],
            false => four[1] << 32 | four[0],
        })
    }

    /// Type, bytes and place of a field's values.
    fn field(&self, tag: u16) -> Option<(u16, usize, usize)> {
        let (step, count_size) = if self.wide { (20, 8) } else { (12, 4) };
        for entry in 0..self.entries {
            let at = self.at + step * entry as usize;
            if self.short(at)? != tag {
                continue;
            }
            let kind = self.short(at + 2)?;
            let each = match kind {
                1 | 2 | 6 | 7 => 1,
                3 | 8 => 2,
                4 | 9 | 11 | 13 => 4,
                _ => 8,
            };
            let count = match self.wide {
                true => self.long(at + 4)?,
                false => self.int(at + 4)?.into(),
            };
            let length = usize::try_from(count.checked_mul(each)?).ok()?;
            let place = at + 4 + count_size;
            let place = match (length <= count_size, self.wide) {
                (true, _) => place,
                (false, true) => usize::try_from(self.long(place)?).ok()?,
                (false, false) => self.int(place)? as usize,
            };
            return Some((kind, length, place));
        }
        None
    }

    /// The first value of a field of whole numbers.
    pub fn number(&self, tag: u16) -> Option<u64> {
        let (kind, _, at) = self.field(tag)?;
        match kind {
            1 | 7 => self.bytes.get(at).map(|&byte| byte.into()),
            3 => self.short(at).map(Into::into),
            4 | 13 => self.int(at).map(Into::into),
            16 | 18 => self.long(at),
            _ => None,
        }
    }

    /// The first value of a field of fractions.
    pub fn ratio(&self, tag: u16) -> Option<f32> {
        let (kind, _, at) = self.field(tag)?;
        let [above, below] = [self.int(at)?, self.int(at.checked_add(4)?)?];
        (kind == 5 && below > 0).then(|| above as f32 / below as f32)
    }

    /// The bytes of a field.
    pub fn bytes(&self, tag: u16) -> Option<&'b [u8]> {
        let (_, length, at) = self.field(tag)?;
        self.bytes.get(at..at.checked_add(length)?)
    }
}

/// What the first directory of a TIFF file says.
pub(super) fn read_tiff(bytes: &[u8], tags: &mut Tags) {
    // A damaged one is told by the reader of its pixels.
    let Some(directory) = Directory::first(bytes) else {
        return;
    };
    tags.directory(&directory);
    tags.inks = directory.number(262) == Some(5);
    let inks = directory.number(INK_SET).unwrap_or(1);
    if tags.inks && inks != 1 {
        tags.warn(format!(
            "its inks are not the four of a press (InkSet {inks}), but are taken for these"
        ));
    }
    if let Some(profile) = directory.bytes(PROFILE) {
        return tags.profile(profile, "ICCProfile");
    }
    for (tag, name) in COLOURS {
        if directory.field(tag).is_some() {
            tags.warn(format!(
                "its colours ({name}) are not followed but taken as sRGB: convert it to sRGB for \
                 true colours"
            ));
        }
    }
}
