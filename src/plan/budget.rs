//! What a picture may take, or how wrong it may be.

use std::fmt;
use std::str::FromStr;

/// What a picture may take, or how wrong it may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// Seconds of the whole work.
    Seconds(f64),
    /// Relative error, noise and what is left out together.
    Error(f64),
    /// Mean colour difference that an eye at 30 cm sees, ΔE₀₀.
    DeltaE(f64),
}

/// How a colour difference may be written before its number.
const DELTA: [&str; 4] = ["ΔE", "dE", "de", "DE"];

impl FromStr for Budget {
    type Err = String;

    /// `2s`, `2.5 s`, `500ms`, `3min`, `1%`, `ΔE 1` or `dE1`.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong =
            || "expected seconds, an error or a colour difference, as 2s, 1% or dE1".to_owned();
        let text = text.trim();
        if let Some(number) = DELTA.iter().find_map(|delta| text.strip_prefix(delta)) {
            let value: f64 = number.trim().parse().map_err(|_| wrong())?;
            return match value > 0.0 && value <= 100.0 {
                true => Ok(Self::DeltaE(value)),
                false => Err("expected a colour difference above 0 and at most 100".to_owned()),
            };
        }
        let units = [("%", 0.01), ("ms", 1e-3), ("min", 60.0), ("s", 1.0)];
        let (unit, scale, number) = units
            .into_iter()
            .find_map(|(unit, scale)| Some((unit, scale, text.strip_suffix(unit)?)))
            .ok_or_else(wrong)?;
        let number: f64 = number.trim().parse().map_err(|_| wrong())?;
        let value = number * scale;
        match unit {
            "%" if value > 0.0 && value <= 1.0 => Ok(Self::Error(value)),
            "%" => Err("expected an error above 0 and at most 100 %".to_owned()),
            _ if value > 0.0 && value.is_finite() => Ok(Self::Seconds(value)),
            _ => Err("expected seconds above 0".to_owned()),
        }
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Seconds(seconds) => write!(to, "{seconds} s"),
            Self::Error(error) => write!(to, "{} %", 100.0 * error),
            Self::DeltaE(delta_e) => write!(to, "ΔE {delta_e}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_time_error_or_a_colour_difference() {
        for (text, budget) in [
            ("2s", Budget::Seconds(2.0)),
            (" 2.5 s", Budget::Seconds(2.5)),
            ("500ms", Budget::Seconds(0.5)),
            ("3min", Budget::Seconds(180.0)),
            ("1%", Budget::Error(0.01)),
            ("ΔE 1", Budget::DeltaE(1.0)),
            ("dE0.5", Budget::DeltaE(0.5)),
        ] {
            assert_eq!(text.parse(), Ok(budget), "{text}");
            assert_eq!(budget.to_string().parse(), Ok(budget), "{budget}");
        }
        for wrong in [
            "", "2", "s", "%", "0s", "-1s", "nans", "infs", "0%", "101%", "2h", "ΔE", "dE0",
            "dE-1", "dENaN", "dE 101",
        ] {
            assert!(wrong.parse::<Budget>().is_err(), "{wrong}");
        }
    }
}
