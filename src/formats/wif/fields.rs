//! What WIF says of sizes, colours and threads, and what the reader does with it.

use super::read::File;
use super::text::{bare, boolean};
use crate::formats::field_table::Handling::{Honoured, Warned};
use crate::formats::field_table::{Field, Table};
use crate::formats::sheet::Warnings;
use crate::formats::sheet::text::shorten;

/// Sections in brackets, with a key where one key is meant; an example of a whole section is
/// a line of it.
pub const FIELDS: Table = Table {
    format: "wif",
    fields: &[
        Field::new("[WEAVING] Rising Shed", Honoured, "false"),
        Field::new("[WEAVING] Shafts", Honoured, "6"),
        Field::new("[WEAVING] Treadles", Honoured, "6"),
        Field::new("[WEAVING] Loom Type", Honoured, "Lift Plan"),
        Field::new("[WEAVING] Profile", Warned, "true"),
        Field::new("[WARP] Threads", Honoured, "6"),
        Field::new("[WEFT] Threads", Honoured, "6"),
        Field::new("[WARP] Color", Honoured, "2"),
        Field::new("[WEFT] Color", Honoured, "1"),
        Field::new("[WARP] Units", Honoured, "Inches"),
        Field::new("[WEFT] Units", Honoured, "Inches"),
        Field::new("[WARP] Spacing", Honoured, "0.2"),
        Field::new("[WEFT] Spacing", Honoured, "0.2"),
        Field::new("[WARP] Thickness", Honoured, "0.03"),
        Field::new("[WEFT] Thickness", Honoured, "0.03"),
        Field::new("[WARP] Spacing Zoom", Warned, "2"),
        Field::new("[WEFT] Spacing Zoom", Warned, "2"),
        Field::new("[WARP] Thickness Zoom", Warned, "2"),
        Field::new("[WEFT] Thickness Zoom", Warned, "2"),
        Field::new("[WARP] Colors", Warned, "2"),
        Field::new("[WEFT] Colors", Warned, "2"),
        Field::new("[WARP] Palette", Warned, "2"),
        Field::new("[WEFT] Palette", Warned, "2"),
        Field::new("[WARP] ColorMix", Warned, "2"),
        Field::new("[WEFT] ColorMix", Warned, "2"),
        Field::new("[COLOR PALETTE] Range", Honoured, "0,999"),
        Field::new("[COLOR PALETTE] Form", Warned, "HSV"),
        Field::new("[COLOR TABLE]", Honoured, "1=5,6,7"),
        Field::new("[THREADING]", Honoured, "2=1"),
        Field::new("[TIEUP]", Honoured, "1=3"),
        Field::new("[TREADLING]", Honoured, "1=2"),
        Field::new("[LIFTPLAN]", Honoured, "1=2"),
        Field::new("[WARP COLORS]", Honoured, "2=2"),
        Field::new("[WEFT COLORS]", Honoured, "2=1"),
        Field::new("[WARP SPACING]", Honoured, "2=0.3"),
        Field::new("[WEFT SPACING]", Honoured, "2=0.3"),
        Field::new("[WARP THICKNESS]", Honoured, "2=0.02"),
        Field::new("[WEFT THICKNESS]", Honoured, "2=0.02"),
        Field::new("[WARP SPACING ZOOM]", Warned, "2=2"),
        Field::new("[WEFT SPACING ZOOM]", Warned, "2=2"),
        Field::new("[WARP THICKNESS ZOOM]", Warned, "2=2"),
        Field::new("[WEFT THICKNESS ZOOM]", Warned, "2=2"),
        Field::new("[TRANSLATIONS]", Warned, "1=Kette"),
    ],
};

/// Keys that are told and not followed: section, key and why.
const KEYS: [(&str, &[&str], &str); 3] = [
    ("WARP", &OF_THREADS, NOT_FOLLOWED),
    ("WEFT", &OF_THREADS, NOT_FOLLOWED),
    (
        "COLOR PALETTE",
        &["Form"],
        "is not known: colours are read as RGB",
    ),
];

/// Of [WARP] and [WEFT]: how large a program draws, and what WIF 1.1 took out again.
const OF_THREADS: [&str; 5] = [
    "Spacing Zoom",
    "Thickness Zoom",
    "Colors",
    "Palette",
    "ColorMix",
];

const NOT_FOLLOWED: &str = "is not followed: it is for drawing only, or obsolete";

/// Sections that are told and not followed.
const SECTIONS: [&str; 5] = [
    "WARP SPACING ZOOM",
    "WEFT SPACING ZOOM",
    "WARP THICKNESS ZOOM",
    "WEFT THICKNESS ZOOM",
    "TRANSLATIONS",
];

/// Names what the file says of sizes and colours and is not followed.
pub(super) fn name_unfollowed(file: &File<'_>, warnings: &mut Warnings) {
    for (section, keys, why) in KEYS {
        for key in keys {
            let Some((line, value)) = file.value(section, key) else {
                continue;
            };
            let value = bare(&value);
            if !value.is_empty() && !value.eq_ignore_ascii_case("rgb") {
                warnings.at(line, format!("[{section}] {key}={} {why}", shorten(value)));
            }
        }
    }
    if let Some((line, value)) = file.value("WEAVING", "Profile")
        && boolean(&value) != Some(false)
    {
        let what = "its blocks are read as single threads";
        warnings.at(
            line,
            format!("[WEAVING] Profile={}: {what}", shorten(&value)),
        );
    }
    for section in SECTIONS {
        if let Some(line) = file.line_of(section) {
            warnings.at(line, format!("[{section}] is kept, but not followed"));
        }
    }
}
