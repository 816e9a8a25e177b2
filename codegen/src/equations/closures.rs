//! Loops of links that `closes` says to close: two links share a point in every posture.
//!
//! Both points in the base frame, as expressions in the coordinates, have equal fingerprints, or the loop is open.

use super::Closure;
use crate::derive::arm::Arm;
use crate::derive::parameters::View;
use crate::derive::quantities::kinematics::link_frames;
use crate::diagnostic::{Code, Diagnostic};
use crate::manipulator::Manipulator;
use crate::ring::field::Field;
use crate::ring::matrix::Vector;
use crate::ring::{ExprId, Node, Pool, Symbol};

/// A posture, rad or m, at which it is told how far apart the points are, besides 0.
const POSTURE: f64 = 0.5;

/// The loops that are open.
pub(super) fn open_loops(manipulator: &Manipulator, field: &Field, closures: &[Closure]) -> Vec<Diagnostic> {
    if closures.is_empty() {
        return Vec::new();
    }
    let mut pool = Pool::new(field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Nominal);
    let frames = link_frames(&mut pool, &arm);
    let mut differences = Vec::new();
    for closure in closures {
        let [one, other] = closure.ends.each_ref().map(|(link, point)| {
            let point = point.each_ref().map(|x| View::Nominal.polynomial(&mut pool, manipulator, x));
            link.map_or(point, |link| in_base(&mut pool, &frames[link.index()], &point))
        });
        differences.extend(pool.sub_vectors(&one, &other));
    }
    let (pool, differences) = arm.in_coordinates(pool, differences);
    let open = closures.iter().zip(differences.chunks(3)).filter(|(_, all)| all.iter().any(|&x| x != ExprId::ZERO));
    open.map(|(closure, difference)| open_loop(closure, [0.0, POSTURE].map(|q| at(&pool, difference, q)))).collect()
}

/// A point of a frame in the base frame.
fn in_base(pool: &mut Pool, frame: &[Vec<ExprId>], point: &Vector) -> Vector {
    [0, 1, 2].map(|row| {
        let turned = pool.dot(&frame[row][..3], point);
        pool.add(turned, frame[row][3])
    })
}

/// The values of expressions in coordinates where each coordinate is `q`.
fn at(pool: &Pool, exprs: &[ExprId], q: f64) -> Vec<f64> {
    let angle = |index: u16| match pool.field().computed().and_then(|all| all.get(index)) {
        Some(angle) => angle.offset.to_f64() + angle.factors.iter().map(|(_, factor)| factor.to_f64() * q).sum::<f64>(),
        None => q,
    };
    let symbol = |symbol: Symbol| {
        let angle =
            || symbol.angle().into_iter().flat_map(|of| of.terms()).map(|(i, minus)| if minus { -angle(i) } else { angle(i) });
        match symbol {
            Symbol::Sine(_) | Symbol::SineOf(_) => angle().sum::<f64>().sin(),
            Symbol::Cosine(_) | Symbol::CosineOf(_) => angle().sum::<f64>().cos(),
            _ => q,
        }
    };
    let mut values: Vec<f64> = Vec::with_capacity(pool.len());
    let of = |values: &[f64], expr: ExprId| if expr.is_negated() { -values[expr.index()] } else { values[expr.index()] };
    for index in 0..pool.len() {
        let expr = pool.expr(index);
        let value = match pool.node(expr) {
            Node::Constant(_) => pool.as_constant(expr).map_or(0.0, |number| number.to_f64()),
            Node::Symbol(own) => symbol(own),
            Node::Add(a, b) => of(&values, a) + of(&values, b),
            Node::Mul(a, b) => of(&values, a) * of(&values, b),
            Node::Reciprocal(a) => 1.0 / of(&values, a),
        };
        values.push(value);
    }
    exprs.iter().map(|&expr| of(&values, expr)).collect()
}

/// Two links do not share a point; the second one is so far away at both postures.
fn open_loop(closure: &Closure, [at_zero, further]: [Vec<f64>; 2]) -> Diagnostic {
    let vector = |difference: &[f64]| {
        // Without the last digits, and with one zero.
        let rounded = difference.iter().map(|x| format!("{}", (x * 1e6).round() / 1e6 + 0.0));
        format!("({})", rounded.collect::<Vec<_>>().join(", "))
    };
    let message = format!(
        "the loop {} does not close: from the second point to the first it is {} m where all coordinates are 0, and {} m where all are {POSTURE}",
        closure.name,
        vector(&at_zero),
        vector(&further)
    );
    let help =
        "compare the signs of factors under `follows` and `adds` with a drawing, then both points with the frames of their links";
    let fault = Diagnostic::new(Code::OpenLoop, closure.spans[0], message, "this link has the first point", help);
    fault.also(closure.spans[1], "this one the second point")
}
