//! Units behind numbers, where values have none: what the number would be in SI units.

/// How angles in degrees are written.
pub(super) const DEGREES: &str = "write an angle in degrees as `deg(90)`";

/// What becomes of a number in a unit.
#[derive(Clone, Copy)]
enum To {
    /// It is multiplied by a power of ten.
    Power(i32),
    /// `deg(x)`.
    Degrees,
    /// It is multiplied by a factor that is written out.
    Times(&'static str),
}

/// Units without blanks, `*`, `·` and `^`, squares as 2, and the SI units that they become.
const UNITS: &[(&str, To, &str)] = &[
    ("m", To::Power(0), "m"),
    ("mm", To::Power(-3), "m"),
    ("cm", To::Power(-2), "m"),
    ("um", To::Power(-6), "m"),
    ("µm", To::Power(-6), "m"),
    ("in", To::Times("0.0254"), "m"),
    ("inch", To::Times("0.0254"), "m"),
    ("kg", To::Power(0), "kg"),
    ("g", To::Power(-3), "kg"),
    ("t", To::Power(3), "kg"),
    ("lb", To::Times("0.45359237"), "kg"),
    ("lbs", To::Times("0.45359237"), "kg"),
    ("s", To::Power(0), "s"),
    ("sec", To::Power(0), "s"),
    ("ms", To::Power(-3), "s"),
    ("us", To::Power(-6), "s"),
    ("µs", To::Power(-6), "s"),
    ("rad", To::Power(0), "rad"),
    ("deg", To::Degrees, "rad"),
    ("degs", To::Degrees, "rad"),
    ("degree", To::Degrees, "rad"),
    ("degrees", To::Degrees, "rad"),
    ("°", To::Degrees, "rad"),
    ("N", To::Power(0), "N"),
    ("kN", To::Power(3), "N"),
    ("Nm", To::Power(0), "N m"),
    ("kNm", To::Power(3), "N m"),
    ("Ncm", To::Power(-2), "N m"),
    ("mNm", To::Power(-3), "N m"),
    ("Nms", To::Power(0), "N m s"),
    ("Nms/rad", To::Power(0), "N m s"),
    ("Ns/m", To::Power(0), "N s/m"),
    ("kgm2", To::Power(0), "kg m²"),
    ("kgcm2", To::Power(-4), "kg m²"),
    ("kgmm2", To::Power(-6), "kg m²"),
    ("gcm2", To::Power(-7), "kg m²"),
    ("gmm2", To::Power(-9), "kg m²"),
    ("m/s", To::Power(0), "m/s"),
    ("mm/s", To::Power(-3), "m/s"),
    ("m/s2", To::Power(0), "m/s²"),
    ("rad/s", To::Power(0), "rad/s"),
    ("deg/s", To::Degrees, "rad/s"),
    ("°/s", To::Degrees, "rad/s"),
    ("rpm", To::Times("2*pi/60"), "rad/s"),
    ("Hz", To::Power(0), "1/s"),
    ("kHz", To::Power(3), "1/s"),
];

/// What to write instead of `before` and a unit, if `rest` is one.
pub(super) fn without(before: &str, rest: &str) -> Option<String> {
    let unit: String = rest.chars().filter(|c| !c.is_whitespace() && !"*·^".contains(*c)).take(16).collect();
    let unit = unit.replace('²', "2").replace('º', "°");
    let (_, to, si) = UNITS.iter().find(|(name, ..)| *name == unit)?;
    let before = before.trim_end();
    let number = &before[before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len()..];
    // Of a number with a power of ten, and of none at all, only the unit is named.
    let left = &before[..before.len() - number.len()];
    let power = left.ends_with(char::is_alphanumeric) || left.ends_with(['+', '-']) && left.contains(['e', 'E']);
    let plain = !number.is_empty() && number.matches('.').count() <= 1 && !power;
    let sign = if before.trim_start() == format!("-{number}") { "-" } else { "" };
    Some(match (to, plain) {
        (To::Power(0), true) => format!("remove the unit: write `{sign}{number}`; all values are in SI units, here in {si}"),
        (To::Power(0), false) => format!("remove the unit: all values are in SI units, here in {si}"),
        (To::Power(power), true) => {
            format!("write `{sign}{}`: all values are in SI units, here in {si}", shifted(number, *power))
        }
        (To::Power(power), false) => {
            format!("write the number times 1e{power}, without the unit: all values are in SI units, here in {si}")
        }
        (To::Degrees, true) => format!("write `{sign}deg({number})`: angles are in rad, and `deg` turns degrees into them"),
        (To::Degrees, false) => DEGREES.to_owned(),
        (To::Times(factor), true) => format!("write `{sign}{number}*{factor}`: all values are in SI units, here in {si}"),
        (To::Times(factor), false) => format!("multiply by `{factor}` instead: all values are in SI units, here in {si}"),
    })
}

/// A decimal times a power of ten, its point moved.
fn shifted(number: &str, power: i32) -> String {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    if number.len() > 24 {
        return format!("{number}*1e{power}");
    }
    let digits = format!("{}{whole}{fraction}{}", "0".repeat(12), "0".repeat(12));
    let point = (12 + whole.len()).saturating_add_signed(power as isize);
    let (whole, fraction) = digits.split_at(point.min(digits.len()));
    let (whole, fraction) = (whole.trim_start_matches('0'), fraction.trim_end_matches('0'));
    let whole = if whole.is_empty() { "0" } else { whole };
    if fraction.is_empty() {
        whole.to_owned()
    } else {
        format!("{whole}.{fraction}")
    }
}

#[cfg(test)]
mod tests {
    use super::{shifted, without};

    #[test]
    fn the_point_moves() {
        assert_eq!(shifted("360", -3), "0.36");
        assert_eq!(shifted("1", -3), "0.001");
        assert_eq!(shifted("0.6", -4), "0.00006");
        assert_eq!(shifted("2.5", 3), "2500");
        assert_eq!(shifted(".5", -9), "0.0000000005");
    }

    #[test]
    fn units_are_known_with_blanks_and_signs() {
        let said = |before: &str, rest: &str| without(before, rest).unwrap_or_default();
        assert!(said("-170", "°").contains("`-deg(170)`"));
        assert!(said("1 + 2 ", "kg cm²").contains("`0.0002`"));
        assert!(said("1e-3 ", "mm").contains("times 1e-3"));
        assert!(said("3", "rpm").contains("`3*2*pi/60`"));
        assert_eq!(without("3 ", "l1"), None);
    }
}
