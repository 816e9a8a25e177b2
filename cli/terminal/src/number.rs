//! Numbers for people.

/// At most so many significant digits, without zeros at the end; with an exponent below 1e-4 and from 1e9 on.
pub fn short(value: f64, digits: usize) -> String {
    let after_first = digits.saturating_sub(1);
    if value == 0.0 {
        return "0".to_owned();
    } else if !value.is_finite() {
        return value.to_string();
    }
    let size = value.abs().log10().floor();
    if !(-4.0..9.0).contains(&size) {
        return format!("{value:.after_first$e}");
    }
    without_zeros(&format!("{value:.*}", (after_first as f64 - size).max(0.0) as usize)).to_owned()
}

/// A decimal without the zeros at its end.
pub fn without_zeros(decimal: &str) -> &str {
    match decimal.contains('.') {
        true => decimal.trim_end_matches('0').trim_end_matches('.'),
        false => decimal,
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_are_short() {
        let four = |x| short(x, 4);
        assert_eq!([0.25, -0.021_234_5, 12_345.0, 1e-9, 0.0].map(four), ["0.25", "-0.02123", "12345", "1.000e-9", "0"]);
        assert_eq!([9.999_96, 2e9, -0.0].map(four), ["10", "2.000e9", "0"]);
        assert_eq!(short(std::f64::consts::PI, 6), "3.14159");
    }
}
