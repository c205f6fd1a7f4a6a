//! Units of length as files name them.

/// Millimetres of a unit; `None` where it is no length that is known.
pub(super) fn mm(unit: &str) -> Option<f64> {
    let unit = unit.trim();
    // Only m and M differ in meaning, and nobody measures cloth in megametres.
    Some(match unit.to_lowercase().as_str() {
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => 1.0,
        "m" | "meter" | "meters" | "metre" | "metres" => 1e3,
        "dm" | "decimeter" | "decimetre" => 1e2,
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => 10.0,
        // The micro sign, and a small mu.
        "um" | "\u{b5}m" | "\u{3bc}m" | "micron" | "microns" | "micrometer" | "micrometers"
        | "micrometre" | "micrometres" => 1e-3,
        "nm" | "nanometer" | "nanometers" | "nanometre" | "nanometres" => 1e-6,
        "in" | "inch" | "inches" | "\"" => 25.4,
        "ft" | "foot" | "feet" => 304.8,
        _ => return None,
    })
}

/// Whether it says that nothing is known of the unit.
pub(super) fn is_none(unit: &str) -> bool {
    ["", "?", "??", "???", "none", "unknown"].contains(&unit.trim().to_lowercase().as_str())
}
