//! Rotations in the five writings of MJCF: `quat`, `axisangle`, `xyaxes`, `zaxis`, `euler`.

use armgen_codegen::document::multiple_of_pi;
use armgen_codegen::source::Span;

use super::classes::Element;
use super::{opposite, Mjcf};
use crate::number::Decimal;
use crate::pose::{factor, AxisAngle, Turn};
use crate::values::Values;
use crate::written::Written;
use crate::Code;

const WRITINGS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

impl<'a, 'i> Mjcf<'a, 'i> {
    /// The rotation of an element as a sequence of rotations; empty without a rotation.
    pub(super) fn turns(&self, element: Element<'a, 'i>, what: &str, values: &mut Values<'_>) -> Vec<Turn> {
        let mut given = WRITINGS.into_iter().filter_map(|name| Some((name, self.classes.attribute(element, name)?)));
        let Some((name, (text, span))) = given.next() else { return Vec::new() };
        if let Some((second, (_, span))) = given.next() {
            let message = format!("{what} has two rotations, `{name}` and `{second}`");
            values.report(Code::MjcfFeature, span, message, "the second one", "take one of them out");
            return Vec::new();
        }
        let what = format!("`{name}` of {what}");
        let found = match name {
            "quat" => values.list::<4>(text, span, name, &what).and_then(|quat| values.quaternion(&quat, span, &what)),
            "axisangle" => values.list::<4>(text, span, name, &what).and_then(|[x, y, z, angle]| {
                let (axis, axis_offset) = values.direction(&[x, y, z], span, &what)?;
                let angle = self.angle(&angle, values);
                Some(about(axis, axis_offset, angle))
            }),
            "xyaxes" => values.list::<6>(text, span, name, &what).and_then(|[a, b, c, d, e, f]| {
                let (x, y) = ([a, b, c], [d, e, f]);
                if x.iter().all(Decimal::is_zero) || y.iter().all(Decimal::is_zero) {
                    return values
                        .direction(&[Decimal::zero(), Decimal::zero(), Decimal::zero()], span, &what)
                        .map(|_| Turn::none());
                }
                Some(values.snap.axes(&x, &y, span))
            }),
            "zaxis" => values.list::<3>(text, span, name, &what).and_then(|z| {
                let (z, offset) = values.direction(&z, span, &what)?;
                Some(z_axis(z, offset, span))
            }),
            _ => return values.list::<3>(text, span, name, &what).map_or_else(Vec::new, |angles| self.euler(&angles, values)),
        };
        found.into_iter().collect()
    }

    fn angle(&self, angle: &Decimal, values: &mut Values<'_>) -> Written {
        match self.compiler.degrees {
            true => values.snap.degrees(angle),
            false => values.snap.angle(angle),
        }
    }

    /// Rotations about axes in the order of `eulerseq`, in turned axes (lower case) or fixed ones; those that robot.yaml has as one are joined.
    fn euler(&self, angles: &[Decimal; 3], values: &mut Values<'_>) -> Vec<Turn> {
        let mut order: Vec<(usize, Written)> = Vec::new();
        for (letter, angle) in self.compiler.sequence.into_iter().zip(angles) {
            let axis = usize::from(letter.to_ascii_lowercase() - b'x');
            let turn = (axis, self.angle(angle, values));
            if letter.is_ascii_lowercase() {
                order.push(turn);
            } else {
                order.insert(0, turn);
            }
        }
        // Rz Ry Rx is one rotation of robot.yaml.
        let mut turns: Vec<(usize, [Written; 3])> = Vec::new();
        for (axis, angle) in order.into_iter().filter(|(_, angle)| !(angle.is_zero() && angle.offset == 0.0)) {
            match turns.last_mut() {
                Some((last, rpy)) if axis < *last => {
                    rpy[axis] = angle;
                    *last = axis;
                }
                _ => {
                    let mut rpy = crate::pose::nothing();
                    rpy[axis] = angle;
                    turns.push((axis, rpy));
                }
            }
        }
        turns.into_iter().map(|(_, rpy)| Turn::Rpy(rpy)).collect()
    }
}

/// A rotation about an axis; about x, y or z as an angle about that.
fn about(axis: [Written; 3], axis_offset: f64, angle: Written) -> Turn {
    let given: Vec<usize> = (0..3).filter(|&k| !axis[k].is_zero()).collect();
    let [only] = given[..] else { return Turn::AxisAngle(AxisAngle { axis, axis_offset, angle }) };
    let mut rpy = crate::pose::nothing();
    let offset = angle.offset + 2.0 * axis_offset;
    rpy[only] = match axis[only].value < 0.0 {
        true => Written {
            text: opposite(&angle.text),
            value: -angle.value,
            twelfths: angle.twelfths.map(|n| -n),
            offset,
            span: angle.span,
        },
        false => Written { offset, ..angle },
    };
    Turn::Rpy(rpy)
}

/// The smallest rotation that takes z to a direction: about z × v, by the quaternion (|v| + v_z, -v_y, v_x, 0).
pub(super) fn z_axis(v: [Written; 3], offset: f64, span: Span) -> Turn {
    let given: Vec<usize> = (0..3).filter(|&k| !v[k].is_zero()).collect();
    let right = |twelfths: i64| Written {
        text: multiple_of_pi(twelfths),
        value: twelfths as f64 * std::f64::consts::PI / 12.0,
        offset: offset * 2.0,
        twelfths: Some(twelfths),
        span,
    };
    if let [only] = given[..] {
        let sign = if v[only].value < 0.0 { -1 } else { 1 };
        let [x, y, z] = crate::pose::nothing();
        return Turn::Rpy(match (only, sign) {
            (0, sign) => [x, right(6 * sign), z],
            (1, sign) => [right(-6 * sign), y, z],
            (_, -1) => [right(12), y, z],
            _ => [Written { offset: offset * 2.0, ..x }, y, z],
        });
    }
    let length = v.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
    let squares: Vec<String> = given.iter().map(|&k| format!("{0}*{0}", factor(&v[k].text))).collect();
    let w = Written {
        text: format!("sqrt({}) + {}", squares.join(" + "), factor(&v[2].text)),
        value: length + v[2].value,
        offset: 0.0,
        twelfths: None,
        span,
    };
    let [x, y, _] = v;
    let minus_y = Written { text: opposite(&y.text), value: -y.value, ..y };
    let [_, _, none] = crate::pose::nothing();
    Turn::Quat([w, minus_y, x, none], 2.0 * offset)
}
