//! Gravity: down along z of the root link, written in the axes of the base link.

use armgen_codegen::exact::{Angle, Number, Rational};

use super::{AxisAngle, Builder, Pose, Turn};

/// 9.81 m/s².
const G: &str = "9.81";
/// An exact expression that is longer is rounded.
const LONGEST: usize = 120;

type Matrix = [[Number; 3]; 3];

impl Builder<'_, '_, '_> {
    /// The three components, whether they are rounded, and by how much snapping turned them; faults are reported.
    pub(super) fn gravity(&mut self, base: usize) -> Option<([String; 3], bool, f64)> {
        let mut way = Vec::new();
        let mut at = base;
        while let Some(above) = self.tree.links[at].above {
            way.push(above);
            at = self.tree.joints[above].parent;
            if way.len() > self.tree.joints.len() {
                break;
            }
        }
        way.reverse();
        // The third row of the rotation from the root to the base link: z of the root in the axes of the base.
        let mut exact = Some([Number::zero(), Number::zero(), Number::one()]);
        let mut float = [0.0, 0.0, 1.0];
        let mut offset = 0.0;
        for joint in way {
            let origin = self.values.origin(self.tree.joints[joint].node, "the origin of a joint");
            let locked = self.standing(joint, true);
            for pose in origin.into_iter().chain(locked) {
                let turn = floats(&pose);
                offset += pose.turned();
                float = [0, 1, 2].map(|j| (0..3).map(|k| float[k] * turn[k][j]).sum());
                exact = exact.zip(exactly(&pose)).map(|(row, turn)| {
                    [0, 1, 2].map(|j| (0..3).fold(Number::zero(), |sum, k| sum.plus(&row[k].times(&turn[k][j]))))
                });
            }
        }
        let texts = exact.as_ref().and_then(|row| {
            let texts: Vec<String> = row.iter().map(component).collect::<Option<_>>()?;
            <[String; 3]>::try_from(texts).ok()
        });
        Some(match texts {
            Some(texts) => (texts, false, offset),
            None => (float.map(|x| format!("{:?}", -9.81 * x)), true, offset),
        })
    }
}

/// -9.81 x as an expression, if that is short.
fn component(x: &Number) -> Option<String> {
    if x.is_zero() {
        return Some("0".into());
    }
    if x.is_one() {
        return Some(format!("-{G}"));
    }
    if (-x).is_one() {
        return Some(G.into());
    }
    let text = x.to_string();
    (x.is_reduced() && text.len() <= LONGEST).then(|| format!("-{G}*({text})"))
}

/// The rotation of a pose whose angles are multiples of pi/12.
fn exactly(pose: &Pose) -> Option<Matrix> {
    let Turn::Rpy(rpy) = &pose.turn else { return None };
    let mut product: Option<Matrix> = None;
    for (axis, angle) in rpy.iter().enumerate().rev() {
        let twelfth = Number::from(Rational::from(angle.twelfths?) / Rational::from(12));
        let angle = Angle::new(&Number::pi() * &twelfth);
        let (s, c) = (angle.sin(), angle.cos());
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { Number::one() } else { Number::zero() }));
        (turn[i][i], turn[j][j], turn[i][j], turn[j][i]) = (c.clone(), c, -&s, s);
        product = Some(match product {
            None => turn,
            Some(before) => std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..3).fold(Number::zero(), |sum, k| sum.plus(&before[i][k].times(&turn[k][j]))))
            }),
        });
    }
    product
}

fn floats(pose: &Pose) -> [[f64; 3]; 3] {
    match &pose.turn {
        Turn::Rpy(rpy) => {
            let [(sr, cr), (sp, cp), (sy, cy)] = rpy.each_ref().map(|angle| angle.value.sin_cos());
            [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ]
        }
        Turn::AxisAngle(AxisAngle { axis, value, .. }) => {
            let length = axis.iter().map(|x| x.value * x.value).sum::<f64>().sqrt();
            let u = [0, 1, 2].map(|k| axis[k].value / length);
            let (s, c) = value.sin_cos();
            std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let dyad = (1.0 - c) * u[i] * u[j];
                    match (j + 3 - i) % 3 {
                        0 => dyad + c,
                        1 => dyad - s * u[3 - i - j],
                        _ => dyad + s * u[3 - i - j],
                    }
                })
            })
        }
    }
}
