//! Numbers for display.

/// A number rounded to seven digits, without trailing zeros.
pub fn number(x: f64) -> String {
    digits(x, 7)
}

/// A number rounded to `count` digits, without trailing zeros.
pub fn digits(x: f64, count: i32) -> String {
    if !x.is_finite() {
        return if x.is_nan() { "none".into() } else { x.to_string() };
    }
    let exponent = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    if (-3..7).contains(&exponent) {
        let text = format!("{x:.*}", (count - 1 - exponent).max(0) as usize);
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        let text = format!("{x:.*e}", count as usize - 1);
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
        format!("{digits}e{power}")
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_keep_seven_digits() {
        for (x, text) in [
            (0.0, "0"),
            (7.19, "7.19"),
            (0.000_244_4, "2.444e-4"),
            (0.999_996, "0.999996"),
            (-1.0904e-3, "-0.0010904"),
            (1234567.0, "1234567"),
            (12345678.0, "1.234568e7"),
            (f64::NAN, "none"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(x), text);
        }
    }
}
