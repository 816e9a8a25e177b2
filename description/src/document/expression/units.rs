//! Units: a file may name units for its values; a unit after a number is a fault, and the help converts it.

use crate::exact::Rational;

/// How angles in degrees are written.
pub(super) const DEGREES: &str = "write an angle in degrees as `deg(90)`";

/// The conversion of a number in a unit.
#[derive(Clone, Copy)]
enum To {
    /// It is multiplied by a power of ten.
    Power(i32),
    /// `deg(x)`.
    Degrees,
    /// It is multiplied by a factor that is written out.
    Times(&'static str),
}

/// A unit: so many of the SI unit, exactly; of an angle, so many degrees where it is not in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// A decimal.
    pub factor: Rational,
    /// Whether the factor counts degrees.
    pub degrees: bool,
}

impl Unit {
    /// The unit that a text names, and the SI unit of its dimension.
    pub fn named(text: &str) -> Option<(Unit, &'static str)> {
        let name = squeezed(text);
        let (_, to, si) = UNITS.iter().find(|(unit, ..)| *unit == name)?;
        let (factor, degrees) = match to {
            To::Power(power) => (power_of_ten(*power), false),
            To::Degrees => (Rational::from(1), true),
            // A turn per minute is 6 degrees per second.
            To::Times("2*pi/60") => (Rational::from(6), true),
            To::Times(factor) => (decimal(factor)?, false),
        };
        Some((Unit { factor, degrees }, si))
    }

    /// Whether it is the SI unit.
    pub fn is_si(&self) -> bool {
        !self.degrees && self.factor == Rational::from(1)
    }

    /// The same with the other sign.
    #[must_use]
    pub fn negated(self) -> Unit {
        Unit { factor: -self.factor, degrees: self.degrees }
    }

    /// In floating point.
    pub fn to_f64(&self) -> f64 {
        let factor = self.factor.to_f64().value();
        if self.degrees {
            factor.to_radians()
        } else {
            factor
        }
    }
}

fn power_of_ten(power: i32) -> Rational {
    let scale = Rational::from(10u8).pow(power.unsigned_abs() as isize);
    if power < 0 {
        Rational::from(1) / scale
    } else {
        scale
    }
}

/// The value of digits with a point.
fn decimal(text: &str) -> Option<Rational> {
    let (digits, power) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let value: Rational = format!("{whole}{fraction}").parse().ok()?;
    Some(value * power_of_ten(power.parse::<i32>().ok()? - i32::try_from(fraction.len()).ok()?))
}

/// Digits of a decimal that is written out.
const MAX_WRITTEN: usize = 30;

/// A number as a decimal with all its digits, if it has few enough.
pub fn decimal_text(value: &Rational) -> Option<String> {
    let ten = Rational::from(10u8);
    let mut scaled = value.clone();
    for digits in 0..=MAX_WRITTEN {
        if scaled.is_int() {
            let text = scaled.numerator().to_string();
            let (sign, whole) = text.strip_prefix('-').map_or(("", text.as_str()), |rest| ("-", rest));
            if whole.len() > MAX_WRITTEN {
                return None;
            }
            let padded = format!("{whole:0>width$}", width = digits + 1);
            let (before, after) = padded.split_at(padded.len() - digits);
            return Some(if after.is_empty() { format!("{sign}{before}") } else { format!("{sign}{before}.{after}") });
        }
        scaled *= &ten;
    }
    None
}

/// Units as [`squeezed`] has them, and the SI units that they become.
const UNITS: &[(&str, To, &str)] = &[
    ("m", To::Power(0), "m"),
    ("mm", To::Power(-3), "m"),
    ("cm", To::Power(-2), "m"),
    ("um", To::Power(-6), "m"),
    ("µm", To::Power(-6), "m"),
    ("in", To::Times("0.0254"), "m"),
    ("inch", To::Times("0.0254"), "m"),
    ("ft", To::Times("0.3048"), "m"),
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
    ("mN", To::Power(-3), "N"),
    ("kgf", To::Times("9.80665"), "N"),
    ("lbf", To::Times("4.4482216152605"), "N"),
    ("Nm", To::Power(0), "N m"),
    ("kNm", To::Power(3), "N m"),
    ("Ncm", To::Power(-2), "N m"),
    ("mNm", To::Power(-3), "N m"),
    ("Nmm", To::Power(-3), "N m"),
    ("kgm", To::Times("9.80665"), "N m"),
    ("kgfm", To::Times("9.80665"), "N m"),
    ("kgcm", To::Times("0.0980665"), "N m"),
    ("kgfcm", To::Times("0.0980665"), "N m"),
    ("gcm", To::Times("9.80665e-5"), "N m"),
    ("gfcm", To::Times("9.80665e-5"), "N m"),
    ("ozin", To::Times("0.00706155181422604375"), "N m"),
    ("ozfin", To::Times("0.00706155181422604375"), "N m"),
    ("lbin", To::Times("0.1129848290276167"), "N m"),
    ("lbfin", To::Times("0.1129848290276167"), "N m"),
    ("inlb", To::Times("0.1129848290276167"), "N m"),
    ("lbft", To::Times("1.3558179483314004"), "N m"),
    ("lbfft", To::Times("1.3558179483314004"), "N m"),
    ("ftlb", To::Times("1.3558179483314004"), "N m"),
    ("N/m", To::Power(0), "N/m"),
    ("N/mm", To::Power(3), "N/m"),
    ("Nm/rad", To::Power(0), "N m/rad"),
    ("Nms", To::Power(0), "N m s"),
    ("Nms/rad", To::Power(0), "N m s"),
    ("Ns/m", To::Power(0), "N s/m"),
    ("kgm2", To::Power(0), "kg m²"),
    ("kgcm2", To::Power(-4), "kg m²"),
    ("kgmm2", To::Power(-6), "kg m²"),
    ("gm2", To::Power(-3), "kg m²"),
    ("lbin2", To::Times("0.0002926396534292"), "kg m²"),
    ("lbft2", To::Times("0.0421401100938048"), "kg m²"),
    ("gcm2", To::Power(-7), "kg m²"),
    ("gmm2", To::Power(-9), "kg m²"),
    ("m/s", To::Power(0), "m/s"),
    ("mm/s", To::Power(-3), "m/s"),
    ("cm/s", To::Power(-2), "m/s"),
    ("m/s2", To::Power(0), "m/s²"),
    ("rad/s", To::Power(0), "rad/s"),
    ("deg/s", To::Degrees, "rad/s"),
    ("°/s", To::Degrees, "rad/s"),
    ("degs/s", To::Degrees, "rad/s"),
    ("rpm", To::Times("2*pi/60"), "rad/s"),
    ("Hz", To::Power(0), "1/s"),
    ("kHz", To::Power(3), "1/s"),
];

/// Units that may be a torque with kg or g for kgf or gf, or an inertia without its square. Each has the factor to N m, the power of ten
/// to kg m², and the unit of the inertia.
const TORQUES_OR_INERTIAS: [(&str, &str, i32, &str); 3] =
    [("kgm", "9.80665", 0, "kg m²"), ("kgcm", "0.0980665", -4, "kg cm²"), ("gcm", "9.80665e-5", -7, "g cm²")];

/// The replacement of `before` and a unit, if `rest` is a unit. After more than a number, the operand of the unit is unknown and not
/// guessed.
pub(super) fn without(before: &str, rest: &str) -> Option<String> {
    let unit = squeezed(rest);
    let (_, to, si) = UNITS.iter().find(|(name, ..)| *name == unit)?;
    let before = before.trim();
    let (sign, number) = match before.strip_prefix('-') {
        Some(rest) => ("-", rest.trim_start()),
        None => ("", before.strip_prefix('+').unwrap_or(before).trim_start()),
    };
    let is_decimal = number.chars().all(|c| c.is_ascii_digit() || c == '.') && number.matches('.').count() <= 1;
    let plain = is_decimal && number.contains(|c: char| c.is_ascii_digit());
    // `kg-cm` is how data sheets of servos have it; without the dash a square may be forgotten.
    let either = TORQUES_OR_INERTIAS.iter().find(|(name, ..)| *name == unit && !rest.contains('-'));
    if let Some((_, factor, power, inertia)) = either {
        return Some(match plain {
            true => format!(
                "a torque, in N m, is `{sign}{number}*{factor}`; an inertia in {inertia} is `{sign}{}` in kg m²",
                shifted(number, *power)
            ),
            false => format!(
                "leave the unit out; a torque is in N m: multiply what has this unit by {factor}; an inertia in {inertia} is in kg m²: by 1e{power}"
            ),
        });
    }
    Some(match (to, plain) {
        (To::Power(0), true) => format!("remove the unit: write `{sign}{number}`; all values are in SI units, here in {si}"),
        (To::Power(0), false) => format!("remove the unit: all values are in SI units, here in {si}"),
        (To::Power(power), true) => {
            format!("write `{sign}{}`: all values are in SI units, here in {si}", shifted(number, *power))
        }
        (To::Power(power), false) => {
            format!("multiply what has this unit by 1e{power} and leave the unit out: all values are in SI units, here in {si}")
        }
        (To::Degrees, true) => format!("write `{sign}deg({number})`: angles are in rad, and `deg` turns degrees into them"),
        (To::Degrees, false) if number.is_empty() => DEGREES.to_owned(),
        (To::Degrees, false) => {
            "write `deg(...)` around what is in degrees, and leave the unit out: angles are in rad, and `deg` turns degrees into them"
                .to_owned()
        }
        (To::Times(factor), true) => format!("write `{sign}{number}*{factor}`: all values are in SI units, here in {si}"),
        (To::Times(factor), false) => {
            format!("multiply what has this unit by {factor} and leave the unit out: all values are in SI units, here in {si}")
        }
    })
}

/// The help for a quotient of the units above, such as `kg/m`, that is not itself in the table.
pub(super) fn compound(rest: &str) -> Option<String> {
    let mut parts = rest.trim().split('/').map(squeezed);
    let is_unit = |part: &String| UNITS.iter().any(|(name, ..)| name == part);
    (rest.contains('/') && parts.all(|part| is_unit(&part)))
        .then(|| "leave the unit out: all values are in SI units (m, kg, s, rad, N), without saying so".to_owned())
}

/// A unit without blanks, `*`, `·`, `^`, and without `-` and `.` between letters; squares as 2.
fn squeezed(unit: &str) -> String {
    let mut squeezed = String::new();
    let mut characters = unit.trim().chars().take(24).peekable();
    while let Some(c) = characters.next() {
        let joins = matches!(c, '-' | '.')
            && squeezed.ends_with(char::is_alphabetic)
            && characters.peek().is_some_and(|next| next.is_alphabetic());
        match c {
            '²' => squeezed.push('2'),
            'º' => squeezed.push('°'),
            '*' | '·' | '^' => {}
            c if joins || c.is_whitespace() => {}
            c => squeezed.push(c),
        }
    }
    squeezed
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
        assert!(said("2 ", "kg cm²").contains("`0.0002`"));
        assert!(said("1e-3 ", "mm").contains("by 1e-3 "));
        assert!(said("3", "rpm").contains("`3*2*pi/60`"));
        assert!(said("", "°").contains("`deg(90)`"));
        assert_eq!(without("3 ", "l1"), None);
        assert_eq!(without("2 ", "m - s"), None);
    }

    #[test]
    fn torques_of_servos_are_newton_metres() {
        // Standard gravity, and the pound and the inch by definition: 0.45359237 kg, 0.0254 m.
        let gravity = 9.80665;
        let pound = 0.45359237 * gravity;
        let check = |units: &[&str], factor: f64| {
            for unit in units {
                let said = without("15 ", unit).unwrap_or_else(|| panic!("{unit} is not known"));
                let number = said.split('`').nth(1).and_then(|text| text.strip_prefix("15*")).map(str::parse::<f64>);
                let given = number.and_then(Result::ok).unwrap_or_else(|| panic!("{said}"));
                assert!((given / factor - 1.0).abs() < 5e-7, "{unit}: {given} instead of {factor}");
            }
        };
        check(&["kg-cm", "kgcm", "kgf cm", "kgf.cm", "kg*cm", "kg cm"], gravity / 100.0);
        check(&["kgf m", "kg-m"], gravity);
        check(&["g-cm", "gf cm"], gravity / 1e5);
        // The square of an inertia may be forgotten, but of no weight.
        let said = |unit: &str| without("15 ", unit).unwrap_or_default();
        for (unit, inertia) in [("kg m", "`15`"), ("kg cm", "`0.0015`"), ("kg*cm", "`0.0015`"), ("g cm", "`0.0000015`")] {
            assert!(said(unit).contains(inertia) && said(unit).contains("a torque"), "{unit}: {}", said(unit));
            assert!(without("2*l ", unit).is_some_and(|said| said.contains("an inertia")), "{unit}");
        }
        for unit in ["kgf m", "kgf cm", "kg-cm", "kg-m", "g-cm"] {
            assert!(!said(unit).contains("inertia"), "{unit}: {}", said(unit));
        }
        check(&["oz-in", "ozf in"], pound / 16.0 * 0.0254);
        check(&["lb-in", "in-lb", "lbf in"], pound * 0.0254);
        check(&["ft-lb", "lbf ft"], pound * 0.3048);
        check(&["lbf"], pound);
        check(&["kgf"], gravity);
        assert!(without("3e-5 ", "kg.m2").is_some_and(|said| said.contains("kg m²")));
    }

    #[test]
    fn of_an_expression_no_part_is_taken_for_the_whole() {
        for before in ["pi/2 ", "1/2 ", "2*45 ", "-90/2 ", "m1/2 ", "1 + 2 ", "(1 + 2) ", "1e-3 ", "--3 ", "l2 ", "1.2.3 "] {
            for unit in ["m", "mm", "deg", "in"] {
                let said = without(before, unit).unwrap_or_default();
                let mut to_copy = said.split('`').skip(1).step_by(2);
                let none = to_copy.all(|text| !text.contains(|c: char| c.is_ascii_digit()));
                assert!(!said.is_empty() && none, "{before}{unit}: {said}");
            }
        }
    }
}
