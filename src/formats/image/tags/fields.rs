//! The fields of image formats that change what is read, and what is done with each.
//!
//! Names are those of the formats' specifications. What only says that things are as they
//! are taken anyway (PNG's sRGB) and what places a page on paper is in no table.

use crate::formats::field_table::{Field, Handling, Table};

const fn honoured(name: &'static str, example: &'static str) -> Field {
    Field::new(name, Handling::Honoured, example)
}

const fn warned(name: &'static str, example: &'static str) -> Field {
    Field::new(name, Handling::Warned, example)
}

/// One table a format.
pub const TABLES: [Table; 7] = [
    Table {
        format: "png",
        fields: &[
            honoured("PLTE", "red green"),
            honoured("tRNS", "black"),
            honoured("alpha", "0"),
            honoured("pHYs", "2000 3000 metre"),
            warned("pHYs without a unit", "2 1"),
            honoured("eXIf", "orientation 6"),
            warned("iCCP", "Display P3"),
            warned("cICP", "9 16 0 1"),
            warned("gAMA", "1"),
            warned("cHRM", "0.3127 0.329 0.708 0.292 0.17 0.797 0.131 0.046"),
            warned("acTL", "2"),
        ],
    },
    Table {
        format: "jpeg",
        fields: &[
            honoured("JFIF density", "50 per cm"),
            warned("JFIF density without a unit", "2 1"),
            honoured("Orientation", "6"),
            honoured("XResolution", "50 60 cm"),
            warned("ColorSpace", "65535"),
            warned("ICC_PROFILE", "Adobe RGB"),
        ],
    },
    Table {
        format: "webp",
        fields: &[
            honoured("Orientation", "6"),
            warned("ICCP", "Adobe RGB"),
            warned("ANIM", "2"),
        ],
    },
    Table {
        format: "tiff",
        fields: &[
            honoured("Orientation", "6"),
            honoured("XResolution", "50"),
            honoured("YResolution", "60"),
            honoured("ResolutionUnit", "cm"),
            warned("ResolutionUnit none", "2 1"),
            honoured("PhotometricInterpretation", "0"),
            honoured("ColorMap", "red green"),
            honoured("FillOrder", "2"),
            honoured("ExtraSamples", "2"),
            Field::new("sample format", Handling::Refused, "3"),
            warned("ICCProfile", "Adobe RGB"),
            warned("TransferFunction", "linear"),
            warned("WhitePoint", "0.3457 0.3585"),
            warned(
                "PrimaryChromaticities",
                "0.708 0.292 0.17 0.797 0.131 0.046",
            ),
            warned("InkSet", "2"),
            warned("page", "2"),
        ],
    },
    Table {
        format: "gif",
        fields: &[
            honoured("global color table", "red green"),
            honoured("local color table", "red green"),
            honoured("transparent color index", "1"),
            honoured("image left position", "1"),
            warned("pixel aspect ratio", "113"),
            warned("ICCRGBG1012", "Adobe RGB"),
            warned("animation", "2"),
        ],
    },
    Table {
        format: "pcx",
        fields: &[
            honoured("header palette", "red green"),
            honoured("256 colour palette", "red green"),
            warned("HDpi", "150"),
        ],
    },
    Table {
        format: "bmp",
        fields: &[
            honoured("Height below 0", "-2"),
            honoured("XPelsPerMeter", "2000"),
            honoured("YPelsPerMeter", "3000"),
            honoured("color table", "red green"),
            honoured("AlphaMask", "0xff000000"),
            warned("CSType", "LINK"),
        ],
    },
];
