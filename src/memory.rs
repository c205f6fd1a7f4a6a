//! The memory that may be asked for: one budget, asked before a file's or a person's numbers
//! decide how much is taken.
//!
//! The budget is a quarter of the machine's memory (of its group's limit, where it runs in
//! one), at most 8 GiB; `PICKGLASS_MEMORY` says another, as in `512M` or `6G`. Whatever is
//! larger than [`ASKED_FROM`] and depends on numbers from outside goes through [`ask`]
//! before it is allocated, so that there is one rule and one sentence.

use std::sync::OnceLock;

/// The variable that says another budget: bytes, or a number with K, M or G (of 1024).
pub const VARIABLE: &str = "PICKGLASS_MEMORY";

/// What is smaller is not asked for.
pub const ASKED_FROM: u64 = 64 << 20;

/// Most of the budget, unless the variable says more.
const MOST: u64 = 8 << 30;

/// The budget where the machine does not say what it has.
const UNKNOWN: u64 = 2 << 30;

/// More memory than the budget has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what}: {} of memory would be needed, and {} may be used; make it smaller, or set \
     {VARIABLE} to more",
    size(*.needed),
    size(*.budget)
)]
pub struct TooMuch {
    /// What the memory is for: the file, the picture.
    pub what: String,
    /// Bytes it would take.
    pub needed: u64,
    /// Bytes that may be taken.
    pub budget: u64,
}

/// Asks for `needed` bytes for `what` before they are allocated.
///
/// # Errors
/// [`TooMuch`] where they are at least [`ASKED_FROM`] and more than the [`budget`].
pub fn ask(needed: u64, what: impl FnOnce() -> String) -> Result<(), TooMuch> {
    ask_of(budget(), needed, what)
}

/// As [`ask`], of a budget that is given.
///
/// # Errors
/// As [`ask`].
pub fn ask_of(budget: u64, needed: u64, what: impl FnOnce() -> String) -> Result<(), TooMuch> {
    if needed < ASKED_FROM || needed <= budget {
        return Ok(());
    }
    Err(TooMuch {
        what: what(),
        needed,
        budget,
    })
}

/// Bytes that one allocation, or what belongs together, may take.
pub fn budget() -> u64 {
    static BUDGET: OnceLock<u64> = OnceLock::new();
    *BUDGET.get_or_init(|| {
        let said = std::env::var(VARIABLE).ok();
        said.as_deref().and_then(parse).unwrap_or_else(of_machine)
    })
}

/// Why the variable is not believed: it is set and is no size.
pub fn complaint() -> Option<String> {
    let said = std::env::var(VARIABLE).ok()?;
    (!said.trim().is_empty() && parse(&said).is_none()).then(|| {
        format!(
            "{VARIABLE} is {said:?}, which is no size: taking {}; give bytes, or a number with \
             K, M or G",
            size(budget())
        )
    })
}

fn of_machine() -> u64 {
    let Ok(mut system) = sysinfo::System::new() else {
        return UNKNOWN;
    };
    system.refresh_memory();
    let group = system.cgroup_limits().map(|limits| limits.total_memory);
    let total = group
        .filter(|&limit| limit > 0)
        .map_or(system.total_memory(), |limit| {
            limit.min(system.total_memory())
        });
    match total {
        0 => UNKNOWN,
        total => (total / 4).min(MOST),
    }
}

/// Bytes of `512M`, `6 GiB`, `1000000`.
fn parse(text: &str) -> Option<u64> {
    let text = text.trim().to_ascii_uppercase();
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.');
    let (number, unit) = text.split_at(digits.unwrap_or(text.len()));
    let unit = match unit.trim() {
        "" | "B" => 1.0,
        "K" | "KB" | "KIB" => 1024.0,
        "M" | "MB" | "MIB" => 1_048_576.0,
        "G" | "GB" | "GIB" => 1_073_741_824.0,
        _ => return None,
    };
    let bytes = number.parse::<f64>().ok()? * unit;
    (1.0..1e18).contains(&bytes).then_some(bytes as u64)
}

/// Bytes as people say them.
pub fn size(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["KB", "MB", "GB", "TB"];
    if bytes < 1000 {
        return format!("{bytes} bytes");
    }
    let mut value = bytes as f64 / 1e3;
    let mut unit = 0;
    while value >= 999.5 && unit + 1 < UNITS.len() {
        value /= 1e3;
        unit += 1;
    }
    let digits = usize::from(value < 9.95);
    format!("{value:.digits$} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_said() {
        assert_eq!(parse("512M"), Some(512 << 20));
        assert_eq!(parse(" 1.5 GiB "), Some(3 << 29));
        assert_eq!(parse("1000"), Some(1000));
        for wrong in ["", "many", "-1", "0", "12X", "1e9", "nan", "1.2.3"] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
        assert_eq!(size(999), "999 bytes");
        assert_eq!(size(4_200_000), "4.2 MB");
        assert_eq!(size(18_000_000_000), "18 GB");
    }

    #[test]
    fn what_is_within_the_budget_or_small_is_granted() {
        let what = || "x.png".to_owned();
        assert_eq!(ask_of(1 << 30, 1 << 30, what), Ok(()));
        assert_eq!(ask_of(1, ASKED_FROM - 1, what), Ok(()));
        let refused = ask_of(1 << 30, (1 << 30) + 1, what).expect_err("too much");
        let text = refused.to_string();
        assert!(
            text.starts_with("x.png: 1.1 GB of memory would be needed"),
            "{text}"
        );
        assert!(budget() >= 1);
    }
}
