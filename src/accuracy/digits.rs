//! Numbers as tables and plots say them.

/// Three digits that mean something.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return "unknown".to_owned();
    }
    if !(value.abs() > 0.0) {
        return "0".to_owned();
    }
    // As it is once it is rounded: 0.9999 is told as 1.00.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    let digits = 2 - rounded.abs().log10().floor() as i32;
    match digits {
        ..=0 => format!("{value:.0}"),
        1..=6 => format!("{value:.*}", digits as usize),
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_said_whatever_the_size() {
        assert_eq!(number(1234.5), "1234");
        assert_eq!(number(1.2345), "1.23");
        assert_eq!(
            (number(0.9999), number(99.96)),
            ("1.00".to_owned(), "100".to_owned())
        );
        assert_eq!(number(0.012_345), "0.0123");
        assert_eq!(number(1.2e-9), "1.20e-9");
        assert_eq!(number(-0.5), "-0.500");
        assert_eq!(number(0.0), "0");
        assert_eq!(number(f64::NAN), "unknown");
    }
}
