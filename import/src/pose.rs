//! Where a frame is in another: a translation and a rotation, as robot.yaml writes them.

use armgen_codegen::source::Span;

use crate::written::Written;

/// A translation and a rotation.
#[derive(Clone, Debug)]
pub(crate) struct Pose {
    pub(crate) xyz: [Written; 3],
    pub(crate) turn: Turn,
}

/// A rotation.
#[derive(Clone, Debug)]
pub(crate) enum Turn {
    /// About fixed x, y, z.
    Rpy([Written; 3]),
    /// About an axis by an angle.
    AxisAngle(AxisAngle),
    /// A quaternion w, x, y, z, and by how much snapping turned it, rad.
    Quat([Written; 4], f64),
    /// The directions of x and y, and by how much snapping turned them, rad.
    XyAxes([Written; 6], f64),
}

/// A rotation about an axis.
#[derive(Clone, Debug)]
pub(crate) struct AxisAngle {
    pub(crate) axis: [Written; 3],
    /// By how much snapping turned the axis, rad.
    pub(crate) axis_offset: f64,
    pub(crate) angle: Written,
}

impl Turn {
    /// None.
    pub(crate) fn none() -> Turn {
        Turn::Rpy(nothing())
    }

    /// By how much snapping turned it at most, rad.
    pub(crate) fn turned(&self) -> f64 {
        match self {
            Turn::Rpy(rpy) => rpy.iter().map(|angle| angle.offset).sum(),
            Turn::AxisAngle(turn) => 2.0 * turn.axis_offset + turn.angle.offset,
            Turn::Quat(_, offset) | Turn::XyAxes(_, offset) => *offset,
        }
    }

    /// Whether robot.yaml need not write it.
    pub(crate) fn is_none(&self) -> bool {
        matches!(self, Turn::Rpy(rpy) if rpy.iter().all(Written::is_zero))
    }

    /// The numbers that it is written with.
    pub(crate) fn numbers(&self) -> Vec<&Written> {
        match self {
            Turn::Rpy(rpy) => rpy.iter().collect(),
            Turn::AxisAngle(turn) => turn.axis.iter().chain([&turn.angle]).collect(),
            Turn::Quat(quat, _) => quat.iter().collect(),
            Turn::XyAxes(axes, _) => axes.iter().collect(),
        }
    }

    /// The rotation matrix, `[row][column]`, in floats.
    pub(crate) fn matrix(&self) -> [[f64; 3]; 3] {
        match self {
            Turn::Rpy(rpy) => {
                let [(sr, cr), (sp, cp), (sy, cy)] = rpy.each_ref().map(|angle| angle.value.sin_cos());
                [
                    [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                    [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                    [-sp, cp * sr, cp * cr],
                ]
            }
            Turn::AxisAngle(AxisAngle { axis, angle, .. }) => {
                let u = unit(axis.each_ref().map(|x| x.value));
                let (s, c) = angle.value.sin_cos();
                spun(c, s, 1.0 - c, u)
            }
            Turn::Quat(quat, _) => {
                let [w, x, y, z] = quat.each_ref().map(|x| x.value);
                let square = w * w + x * x + y * y + z * z;
                let v = [x, y, z];
                spun((w * w - x * x - y * y - z * z) / square, 2.0 * w / square, 2.0 / square, v)
            }
            Turn::XyAxes(axes, _) => {
                let [a, b, c, d, e, f] = axes.each_ref().map(|x| x.value);
                let x = unit([a, b, c]);
                let along: f64 = x[0] * d + x[1] * e + x[2] * f;
                let y = unit([d - along * x[0], e - along * x[1], f - along * x[2]]);
                let z = [0, 1, 2].map(|i| x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3]);
                std::array::from_fn(|i| [x[i], y[i], z[i]])
            }
        }
    }
}

/// a 1 + b \[v\] + c v v'.
fn spun(a: f64, b: f64, c: f64, v: [f64; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let dyad = c * v[i] * v[j];
            match (j + 3 - i) % 3 {
                0 => dyad + a,
                1 => dyad - b * v[3 - i - j],
                _ => dyad + b * v[3 - i - j],
            }
        })
    })
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

/// An expression as a factor: in brackets unless it is one number or call.
pub(crate) fn factor(text: &str) -> String {
    let call =
        ["deg(", "sqrt("].iter().any(|name| text.starts_with(name)) && text.ends_with(')') && text.matches(')').count() == 1;
    let plain = text.bytes().all(|b| b.is_ascii_digit() || b == b'.') || matches!(text, "pi");
    if call || plain {
        text.to_owned()
    } else {
        format!("({text})")
    }
}

/// Three zeros.
pub(crate) fn nothing() -> [Written; 3] {
    std::array::from_fn(|_| Written::zero())
}

impl Pose {
    /// A translation.
    pub(crate) fn translation(xyz: [Written; 3]) -> Pose {
        Pose { xyz, turn: Turn::none() }
    }

    /// A rotation.
    pub(crate) fn rotation(turn: Turn) -> Pose {
        Pose { xyz: nothing(), turn }
    }

    /// The pose of the child of a joint at a value, an expression.
    pub(crate) fn of_joint(prismatic: bool, axis: [Written; 3], axis_offset: f64, text: &str, value: f64, span: Span) -> Pose {
        if !prismatic {
            let angle = Written { text: text.to_owned(), value, offset: 0.0, twelfths: None, span };
            return Pose::rotation(Turn::AxisAngle(AxisAngle { axis, axis_offset, angle }));
        }
        let length = axis.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
        let given = axis.iter().filter(|x| !x.is_zero()).count();
        let squares: Vec<String> = axis.iter().filter(|x| !x.is_zero()).map(|x| format!("{0}*{0}", factor(&x.text))).collect();
        Pose::translation(axis.map(|x| {
            let text = match (given, x.value) {
                (_, 0.0) => "0".to_owned(),
                (1, v) if v > 0.0 => text.to_owned(),
                (1, _) => format!("-{}", factor(text)),
                _ => format!("{}*{}/sqrt({})", factor(text), factor(&x.text), squares.join(" + ")),
            };
            let along = if x.is_zero() { 0.0 } else { value * x.value / length };
            Written { text, value: along, offset: axis_offset * value.abs(), twelfths: None, span }
        }))
    }

    /// By how much snapping turned it at most, rad.
    pub(crate) fn turned(&self) -> f64 {
        self.turn.turned()
    }

    /// Whether it is the identity in the file, too.
    pub(crate) fn is_nothing(&self) -> bool {
        self.is_identity() && self.turned() == 0.0 && self.xyz.iter().all(|x| x.offset == 0.0)
    }

    /// Whether it is the identity in robot.yaml.
    pub(crate) fn is_identity(&self) -> bool {
        self.turn.is_none() && self.xyz.iter().all(Written::is_zero)
    }
}
