//! Designs embedded in the program.

use crate::design::Design;
use crate::formats::ron::{self, RonError};

/// Name and document of each.
const DESIGNS: [(&str, &str); 11] = [
    ("default", include_str!("../presets/designs/default.ron")),
    (
        "herringbone",
        include_str!("../presets/designs/herringbone.ron"),
    ),
    ("twills-9", include_str!("../presets/designs/twills-9.ron")),
    (
        "wavy-twill",
        include_str!("../presets/designs/wavy-twill.ron"),
    ),
    ("damask", include_str!("../presets/designs/damask.ron")),
    (
        "twill-satin",
        include_str!("../presets/designs/twill-satin.ron"),
    ),
    ("denim", include_str!("../presets/designs/denim.ron")),
    ("tweed", include_str!("../presets/designs/tweed.ron")),
    (
        "linen-plain",
        include_str!("../presets/designs/linen-plain.ron"),
    ),
    (
        "silk-satin",
        include_str!("../presets/designs/silk-satin.ron"),
    ),
    ("oxford", include_str!("../presets/designs/oxford.ron")),
];

/// Names of the embedded designs, the one to open with first.
pub fn names() -> impl Iterator<Item = &'static str> {
    DESIGNS.iter().map(|&(name, _)| name)
}

/// The embedded design of a name; `None` if there is none.
///
/// # Errors
/// [`RonError`], which a test rules out for every name.
pub fn design(name: &str) -> Option<Result<Design, RonError>> {
    let (name, text) = DESIGNS.iter().find(|(known, _)| *known == name)?;
    Some(ron::read(text.as_bytes(), name))
}
