//! Gravity: read in the axes of the root link, written in the axes of the base link.

use armgen_codegen::exact::{Angle, Number, Rational};

use super::Builder;
use crate::number::Decimal;
use crate::pose::{Pose, Turn};

/// An exact expression that is longer is rounded.
const LONGEST: usize = 120;

type Matrix = [[Number; 3]; 3];

/// Gravity in the axes of the base link.
pub(super) struct Gravity {
    /// Its components.
    pub(super) texts: [String; 3],
    /// Whether these are rounded.
    pub(super) rounded: bool,
    /// Its size, m/s².
    pub(super) size: f64,
    /// By how much snapping turned it, rad.
    pub(super) offset: f64,
}

impl Builder<'_> {
    /// The gravity of the file in the axes of the base link; faults are reported.
    pub(super) fn gravity(&mut self, base: usize) -> Gravity {
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
        let given = self.format.gravity(&mut self.values);
        // Row k: axis k of the root in the axes of the base.
        let mut exact = Some(identity());
        let mut float: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
        let mut offset = 0.0;
        for joint in way {
            let origin = self.format.origin(joint, &mut self.values);
            let locked = self.standing(joint, true);
            for pose in origin.into_iter().chain(locked) {
                let turn = pose.turn.matrix();
                offset += pose.turned();
                float = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| float[i][k] * turn[k][j]).sum()));
                exact = exact.zip(exactly(&pose)).map(|(before, turn)| product(&before, &turn));
            }
        }
        let size = given.iter().map(|g| g.value * g.value).sum::<f64>().sqrt();
        let texts: Option<Vec<String>> = exact.and_then(|rows| (0..3).map(|j| component(&given, &rows, j)).collect());
        let (texts, rounded) = match texts.and_then(|texts| <[String; 3]>::try_from(texts).ok()) {
            Some(texts) => (texts, false),
            None => {
                let rounded = |j: usize| format!("{:?}", (0..3).map(|k| given[k].value * float[k][j]).sum::<f64>());
                ([0, 1, 2].map(rounded), size > 0.0)
            }
        };
        Gravity { texts, rounded, size, offset }
    }
}

/// Component j of gravity as an expression, if that is short.
fn component(given: &[Decimal; 3], rows: &Matrix, j: usize) -> Option<String> {
    let mut parts = Vec::new();
    for (g, row) in given.iter().zip(rows).filter(|(g, row)| !g.is_zero() && !row[j].is_zero()) {
        let x = &row[j];
        let opposite = || g.text.strip_prefix('-').map_or_else(|| format!("-{}", g.text), str::to_owned);
        parts.push(match x {
            x if x.is_one() => g.text.clone(),
            x if (-x).is_one() => opposite(),
            x => format!("{}*({x})", x.is_reduced().then_some(&g.text)?),
        });
    }
    let text = if parts.is_empty() { "0".to_owned() } else { parts.join(" + ") };
    (text.len() <= LONGEST).then_some(text)
}

fn identity() -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { Number::one() } else { Number::zero() }))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).fold(Number::zero(), |sum, k| sum.plus(&a[i][k].times(&b[k][j])))))
}

/// The rotation of a pose whose angles are multiples of pi/12.
fn exactly(pose: &Pose) -> Option<Matrix> {
    let Turn::Rpy(rpy) = &pose.turn else { return None };
    let mut all = identity();
    for (axis, angle) in rpy.iter().enumerate().rev() {
        let twelfth = Number::from(Rational::from(angle.twelfths?) / Rational::from(12));
        let angle = Angle::new(&Number::pi() * &twelfth);
        let (s, c) = (angle.sin(), angle.cos());
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn = identity();
        (turn[i][i], turn[j][j], turn[i][j], turn[j][i]) = (c.clone(), c, -&s, s);
        all = product(&all, &turn);
    }
    Some(all)
}
