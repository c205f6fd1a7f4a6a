//! What an image is and how it is read: the choices, and presets by maker.

use std::fmt;

use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

/// What the pixels of an image stand for.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum ImageAs {
    /// The weave: one pixel a crossing, black or white.
    Weave,
    /// A jacquard's artwork: one flat colour a region.
    Artwork,
    /// The warp yarn of every crossing.
    Warp,
    /// The weft yarn of every crossing.
    Weft,
    /// A photograph or painting, which has to be made into artwork first.
    Picture,
}

/// Which thread a black pixel puts on the face.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Black {
    /// Black = warp up, as nearly all looms and programs have it.
    #[default]
    Warp,
    /// Black = weft up.
    Weft,
}

/// The corner of an image in which end 1 and pick 1 meet.
///
/// The image always shows the face with its own handedness: a Z twill in the image is a Z
/// twill in the cloth. Pick 1 is woven first and lies at the bottom, so an image that
/// starts at a top corner is turned by 180°. The side on which it counts ends changes
/// numbers only. Both are remembered, and the image is written back as it was.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Corner {
    /// The bottom row is pick 1, the left column end 1.
    #[default]
    BottomLeft,
    /// The bottom row is pick 1, the right column end 1.
    BottomRight,
    /// The top row is pick 1, the left column end 1.
    TopLeft,
    /// The top row is pick 1, the right column end 1.
    TopRight,
}

impl Corner {
    /// Whether the image is upside down against the cloth.
    pub fn turned(self) -> bool {
        matches!(self, Self::TopLeft | Self::TopRight)
    }

    /// Whether ends are counted from the image's right.
    pub fn from_right(self) -> bool {
        matches!(self, Self::BottomRight | Self::TopRight)
    }

    /// The corner of a side and a row.
    pub fn of(from_right: bool, from_top: bool) -> Self {
        match (from_right, from_top) {
            (false, false) => Self::BottomLeft,
            (true, false) => Self::BottomRight,
            (false, true) => Self::TopLeft,
            (true, true) => Self::TopRight,
        }
    }
}

/// What tells one region or yarn of an image from another.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Key {
    /// The displayed colour. Numbers follow lightness, from dark to light: programs sort
    /// palettes as they like, so a palette index means nothing from one saving to the next.
    #[default]
    Rgb,
    /// The palette index, where the program that wrote the image keeps it.
    Index,
}

/// How an image is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ImageReading {
    /// What it is; `None` = as its colours suggest.
    pub what: Option<ImageAs>,
    /// Which thread black puts on the face.
    pub black: Black,
    /// Where it starts to count.
    pub corner: Corner,
    /// Left and right exchanged: Z becomes S.
    pub mirror: bool,
    /// What tells colours apart.
    pub key: Key,
}

/// The habits of a maker's images.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, EnumMessage, EnumString, IntoStaticStr, VariantArray,
)]
#[strum(serialize_all = "lowercase")]
pub enum Convention {
    /// Digital Weaving Norway's TC2, and bitmaps made for it in Photoshop: 1 bit, black =
    /// warp raised, read from the bottom row up, end 1 at the left; saved as TIFF (or BMP).
    Tc2,
    /// Pointcarré. Its formats are not published; its exported images are read as weavers
    /// describe them: black = warp up from the bottom left, other colours by their RGB.
    Pointcarre,
    /// ArahWeave and ArahPaint: black = warp up from the bottom left; the palette is sorted
    /// anew at every loading, so colours count and indices do not.
    ArahWeave,
}

impl Convention {
    /// Every preset.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// How this maker's images are read.
    pub fn reading(self) -> ImageReading {
        match self {
            Self::Tc2 => ImageReading {
                what: Some(ImageAs::Weave),
                ..ImageReading::default()
            },
            Self::Pointcarre | Self::ArahWeave => ImageReading::default(),
        }
    }
}

impl fmt::Display for Black {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Warp => "black = warp up",
            Self::Weft => "black = weft up",
        })
    }
}

impl fmt::Display for Corner {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::BottomLeft => "bottom row = pick 1",
            Self::BottomRight => "bottom row = pick 1, right column = end 1",
            Self::TopLeft => "turned by 180°: top row = pick 1, left column = end 1",
            Self::TopRight => "turned by 180°: top row = pick 1, right column = end 1",
        })
    }
}
