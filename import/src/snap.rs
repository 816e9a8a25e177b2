//! Digits that mean something: `1.5708` is pi/2.
//!
//! An angle within a tolerance of a multiple of pi/12 is that multiple, an axis within it of a vector of -1, 0, 1 is that vector; lengths and
//! products of inertia that are nothing but rounding are 0. Every replacement is recorded with the original text.

use std::f64::consts::PI;

use armgen_codegen::document::multiple_of_pi;
use armgen_codegen::source::Span;

use crate::number::Decimal;
use crate::pose::Turn;
use crate::written::Written;

/// Lengths up to this, m, are rounding, as `armgen check` takes them for it: less than an atom.
const SHORTEST: f64 = 1e-9;
/// Products of inertia up to this part of the largest moment, and components of unit quaternions up to this, are rounding.
const DUST: f64 = 1e-14;
/// Angles as near to a multiple as this, rad, are mentioned where they are taken as written.
const NEAR: f64 = 2e-3;

/// The replacements.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapped {
    pub(crate) span: Span,
    pub(crate) written: String,
    pub(crate) taken: String,
    /// How far apart they are: rad, or m, or kg m²; rounded up.
    pub(crate) offset: f64,
}

/// Snaps within a tolerance and remembers.
#[derive(Debug)]
pub(crate) struct Snap {
    /// rad; 0: every digit is taken.
    pub(crate) tolerance: f64,
    pub(crate) snapped: Vec<Snapped>,
    /// Angles that are taken as written although they are nearly a multiple of pi/12.
    pub(crate) near: Vec<(Span, String)>,
}

impl Snap {
    pub(crate) fn new(tolerance: f64) -> Snap {
        Snap { tolerance, snapped: Vec::new(), near: Vec::new() }
    }

    fn take(&mut self, from: &Decimal, text: String, value: f64, offset: f64) -> Written {
        // The float of the difference is wrong by a few units in the last place of the operands.
        let offset = offset * (1.0 + 1e-9) + 4e-16 * from.value.abs().max(f64::MIN_POSITIVE);
        self.snapped.push(Snapped { span: from.span, written: from.text.clone(), taken: text.clone(), offset });
        Written { text, value, offset, twelfths: None, span: from.span }
    }

    /// An angle in radians.
    pub(crate) fn angle(&mut self, angle: &Decimal) -> Written {
        if angle.is_zero() {
            return Written::as_is(angle);
        }
        self.radians(angle, angle.value, Written::as_is(angle))
    }

    /// An angle in degrees.
    pub(crate) fn degrees(&mut self, angle: &Decimal) -> Written {
        if angle.is_zero() {
            return Written::as_is(angle);
        }
        let written =
            Written { text: format!("deg({})", angle.text), value: angle.value.to_radians(), ..Written::as_is(angle).inexact() };
        // A multiple of 15 degrees is one of pi/12: nothing is taken for something else.
        let multiple = (angle.value / 15.0).round();
        if multiple * 15.0 == angle.value && multiple.abs() < 1e6 && angle.is_integer() {
            return Written { twelfths: Some(multiple as i64), ..written };
        }
        self.radians(angle, written.value, written)
    }

    /// An angle of so many radians, written as it is if it means nothing else.
    fn radians(&mut self, angle: &Decimal, value: f64, as_is: Written) -> Written {
        let step = PI / 12.0;
        let count = (value / step).round();
        let off = (value - count * step).abs();
        if count.abs() > 1e6 {
            return as_is;
        }
        if self.tolerance > 0.0 && off <= self.tolerance {
            let count = count as i64;
            // The float of an angle in degrees is rounded once more.
            let off = off + 4e-16 * value.abs();
            return Written { twelfths: Some(count), ..self.take(angle, multiple_of_pi(count), count as f64 * step, off) };
        }
        if count != 0.0 && off <= NEAR {
            self.near.push((angle.span, angle.text.clone()));
        }
        as_is
    }

    /// A quaternion w, x, y, z other than 0: a turn about a coordinate axis by a multiple of pi/12, one of the 24 turns of the cube, or as
    /// written.
    pub(crate) fn quaternion(&mut self, quat: &[Decimal; 4], span: Span) -> Turn {
        let as_is = Turn::Quat(quat.each_ref().map(Written::as_is), 0.0);
        let length = quat.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
        if quat[1..].iter().all(Decimal::is_zero) {
            return Turn::none();
        }
        if self.tolerance == 0.0 || !length.is_finite() || length == 0.0 {
            return as_is;
        }
        let q = [0, 1, 2, 3].map(|k| quat[k].value / length);
        // All components that are not 0 have the same digits: what is meant is what is written.
        let sizes: Vec<&str> = quat.iter().filter(|x| !x.is_zero()).map(|x| x.text.trim_start_matches('-')).collect();
        let equal = sizes.windows(2).all(|two| two[0] == two[1]);
        let turning: Vec<usize> = (1..4).filter(|&k| q[k].abs() > DUST).collect();
        let (angles, twelfths, off) = if let [only] = turning[..] {
            let angle = 2.0 * q[only].atan2(q[0]);
            let count = (angle / (PI / 12.0)).round();
            let mut twelfths = [0; 3];
            twelfths[only - 1] = count as i64;
            ("angle", twelfths, (angle - count * PI / 12.0).abs() + 4.0 * DUST)
        } else {
            let near = q.map(|x| if x.abs() < 0.35 { 0.0 } else { x.signum() });
            let size = near.iter().map(|x| x * x).sum::<f64>().sqrt();
            if ![1.0, 2f64.sqrt(), 2.0].contains(&size) {
                return as_is;
            }
            let apart = (0..4).map(|k| (q[k] - near[k] / size).powi(2)).sum::<f64>().sqrt();
            // Half the angle is twice the arc sine of half the chord.
            ("turn", cube_turn(near), 4.0 * (apart / 2.0).min(1.0).asin())
        };
        if off > self.tolerance {
            if angles == "angle" && off <= NEAR {
                self.near.push((span, quat.each_ref().map(|x| x.text.clone()).join(" ")));
            }
            return as_is;
        }
        let off = if equal { 0.0 } else { off * (1.0 + 1e-9) + 4e-15 };
        let mut rpy = twelfths.map(|n| Written {
            text: multiple_of_pi(n),
            value: n as f64 * PI / 12.0,
            offset: 0.0,
            twelfths: Some(n),
            span,
        });
        rpy[0].offset = off;
        if !equal {
            let written = quat.each_ref().map(|x| x.text.clone()).join(" ");
            let taken = format!("rpy {}", rpy.each_ref().map(|x| x.text.clone()).join(" "));
            self.snapped.push(Snapped { span, written, taken, offset: off });
        }
        Turn::Rpy(rpy)
    }

    /// The directions of x and y: both taken for vectors of -1, 0, 1 that are perpendicular, or both as written.
    pub(crate) fn axes(&mut self, x: &[Decimal; 3], y: &[Decimal; 3], span: Span) -> Turn {
        let before = self.snapped.len();
        let ((first, one), (second, other)) = (self.direction(x, span), self.direction(y, span));
        let product: f64 = (0..3).map(|k| first[k].value * second[k].value).sum();
        let plain = |v: &[Written; 3]| v.iter().all(|x| matches!(x.text.as_str(), "0" | "1" | "-1"));
        let [a, b, c] = first;
        let [d, e, f] = second;
        if plain(&[a.clone(), b.clone(), c.clone()]) && plain(&[d.clone(), e.clone(), f.clone()]) && product == 0.0 {
            return Turn::XyAxes([a, b, c, d, e, f], 2.0 * (one + other));
        }
        self.snapped.truncate(before);
        let [a, b, c] = x.each_ref().map(Written::as_is);
        let [d, e, f] = y.each_ref().map(Written::as_is);
        Turn::XyAxes([a, b, c, d, e, f], 0.0)
    }

    /// A length.
    pub(crate) fn length(&mut self, length: &Decimal) -> Written {
        if self.tolerance > 0.0 && !length.is_zero() && length.value.abs() <= SHORTEST {
            return self.take(length, "0".into(), 0.0, length.value.abs());
        }
        Written::as_is(length)
    }

    /// A product of inertia, compared with the largest moment of its tensor.
    pub(crate) fn product(&mut self, product: &Decimal, largest: f64) -> Written {
        if self.tolerance > 0.0 && !product.is_zero() && product.value.abs() <= DUST * largest {
            return self.take(product, "0".into(), 0.0, product.value.abs());
        }
        Written::as_is(product)
    }

    /// A direction other than 0, and the angle of its turn.
    pub(crate) fn direction(&mut self, axis: &[Decimal; 3], span: Span) -> ([Written; 3], f64) {
        let as_is = axis.each_ref().map(Written::as_is);
        let length = axis.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
        if self.tolerance == 0.0 || !length.is_finite() || length == 0.0 {
            return (as_is, 0.0);
        }
        let unit = [0, 1, 2].map(|k| axis[k].value / length);
        // A component below sin(pi/8) is nearer to 0 than to that of any vector of -1, 0, 1 that has it.
        let near = unit.map(|x| if x.abs() < 0.38 { 0.0 } else { x.signum() });
        let size = near.iter().map(|x| x * x).sum::<f64>().sqrt();
        let target = near.map(|x| x / size);
        let [a, b] = [unit, target];
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let off = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
        let texts = near.map(|x| {
            if x == 0.0 {
                "0"
            } else if x > 0.0 {
                "1"
            } else {
                "-1"
            }
        });
        let exactly = (0..3).all(|k| (axis[k].value == 0.0) == (near[k] == 0.0)) && {
            let sizes: Vec<&str> = axis.iter().filter(|x| !x.is_zero()).map(|x| x.text.trim_start_matches('-')).collect();
            sizes.windows(2).all(|two| two[0] == two[1])
        };
        if off > self.tolerance {
            return (as_is, 0.0);
        }
        let taken = texts.map(|text| Written {
            text: text.into(),
            value: text.parse().unwrap_or(0.0),
            offset: 0.0,
            twelfths: None,
            span,
        });
        if exactly {
            return (taken, 0.0);
        }
        let offset = off * (1.0 + 1e-9) + 1e-15;
        let written = axis.each_ref().map(|x| x.text.clone()).join(" ");
        self.snapped.push(Snapped { span, written, taken: texts.join(" "), offset });
        (taken, offset)
    }
}

/// Roll, pitch and yaw, in twelfths of pi, of a quaternion of -1, 0 and 1 that is a turn of the cube.
fn cube_turn([w, x, y, z]: [f64; 4]) -> [i64; 3] {
    let square = w * w + x * x + y * y + z * z;
    let entry = |value: f64| (value / square).round() as i64;
    let right = |sine: i64, cosine: i64| match (sine, cosine) {
        (0, -1) => 12,
        (sine, _) => 6 * sine,
    };
    let down = entry(2.0 * (x * z - w * y));
    if down == 0 {
        let roll = right(entry(2.0 * (y * z + w * x)), entry(w * w - x * x - y * y + z * z));
        return [roll, 0, right(entry(2.0 * (x * y + w * z)), entry(w * w + x * x - y * y - z * z))];
    }
    // Only the sum or difference of roll and yaw counts.
    let yaw = right(-entry(2.0 * (x * y - w * z)), entry(w * w - x * x + y * y - z * z));
    [0, -6 * down, yaw]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::decimal;
    use armgen_codegen::diagnostic::Diagnostics;

    fn read(word: &str) -> Decimal {
        decimal(word, Span::default(), "x", &mut Diagnostics::new()).expect("a number")
    }

    #[track_caller]
    fn angle(word: &str, tolerance: f64, taken: &str, near: usize) {
        let mut snap = Snap::new(tolerance);
        let written = snap.angle(&read(word));
        assert_eq!((written.text.as_str(), snap.near.len()), (taken, near), "{word}");
        assert_eq!(snap.snapped.len(), usize::from(written.text != word), "{word}");
    }

    #[test]
    fn four_decimals_of_every_multiple_are_the_multiple() {
        for n in (-24..=24_i64).filter(|n| *n != 0) {
            angle(&format!("{:.4}", n as f64 * PI / 12.0), 2e-5, &multiple_of_pi(n), 0);
        }
        angle("0", 2e-5, "0", 0);
        angle("1.5708", 0.0, "1.5708", 1);
        angle("1.571", 2e-5, "1.571", 1);
        angle("1e-6", 2e-5, "0", 0);
        angle("1e-4", 2e-5, "1e-4", 0);
        angle("0.7", 2e-5, "0.7", 0);
    }

    #[test]
    fn lengths_below_that_of_an_atom_are_nothing() {
        for (word, tolerance, taken) in [("-4.65661e-10", 2e-5, "0"), ("4.65661e-10", 0.0, "4.65661e-10"), ("2e-9", 2e-5, "2e-9")]
        {
            let mut snap = Snap::new(tolerance);
            let written = snap.length(&read(word));
            assert_eq!((written.text.as_str(), snap.snapped.len()), (taken, usize::from(taken == "0")), "{word}");
            assert!(snap.snapped.iter().all(|s| s.offset >= 4.65661e-10), "what is left out counts");
        }
    }

    #[track_caller]
    fn direction(words: [&str; 3], taken: [&str; 3], recorded: usize) {
        let mut snap = Snap::new(2e-5);
        let (written, offset) = snap.direction(&words.map(read), Span::default());
        assert_eq!(written.map(|w| w.text), taken, "{words:?}");
        assert_eq!((snap.snapped.len(), usize::from(offset > 0.0)), (recorded, recorded), "{words:?}");
    }

    #[test]
    fn directions() {
        direction(["0", "0", "-1"], ["0", "0", "-1"], 0);
        direction(["0", "0", "2"], ["0", "0", "1"], 0);
        direction(["0.7071", "0.7071", "0"], ["1", "1", "0"], 0);
        direction(["0.70711", "-0.7071", "1e-9"], ["1", "-1", "0"], 1);
        direction(["0.577", "0.577", "-0.577"], ["1", "1", "-1"], 0);
        direction(["0.6", "0.8", "0"], ["0.6", "0.8", "0"], 0);
        direction(["1e-5", "0", "1"], ["0", "0", "1"], 1);
        direction(["1e-4", "0", "1"], ["1e-4", "0", "1"], 0);
    }
}
