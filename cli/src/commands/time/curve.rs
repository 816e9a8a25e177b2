//! Curves: from points to pieces.

use armgen_runtime::timing::Piece;
use nalgebra::SVector;

use super::arc::{Arc, STRAIGHT};
use super::file::{Curve, Form, Passing};

/// Where a piece comes from; points and pieces count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// A piece of the file.
    Piece(usize),
    /// Between this point and the next.
    Between(usize),
    /// The corner at this point.
    Corner(usize),
}

/// Pieces, each with its origin.
pub(super) type Pieces<const N: usize> = Vec<(Piece<f64, N>, Origin)>;

/// The derivative of a line or an arc from point i to the next by its share, at its start (0) or its end (1).
fn way(points: [&[f64]; 2], arc: Option<&Arc>, share: f64) -> Vec<f64> {
    let [from, to] = points;
    let mut way: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
    if let Some(arc) = arc {
        way.iter_mut().zip(&arc.at(share)[1]).for_each(|(to, slope)| *to = *slope);
    }
    way
}

fn norm(of: &[f64]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The pieces of a path. Joints beyond those of the file rest.
pub(super) fn pieces<const N: usize>(form: &Form) -> Pieces<N> {
    match form {
        Form::Points { points, passing, arcs, curve, blend, .. } => {
            let points: Vec<SVector<f64, N>> = points.iter().map(|q| point(q)).collect();
            match curve {
                Curve::Spline => between_stops(&points, passing, spline),
                Curve::Through => between_stops(&points, passing, through),
                Curve::Lines => rounded(&points, passing, arcs, *blend),
            }
        }
        Form::Pieces { knots, coefficients, .. } => {
            let mut pieces = Vec::new();
            for (i, (of, knots)) in coefficients.iter().zip(knots.windows(2)).enumerate() {
                let mut piece = Piece::new(knots[0], knots[1] - knots[0], [SVector::zeros(); 6]);
                for (joint, powers) in of.iter().enumerate() {
                    for (to, power) in piece.coefficients.iter_mut().zip(powers) {
                        to[joint] = *power;
                    }
                }
                pieces.push((piece, Origin::Piece(i)));
            }
            pieces
        }
    }
}

/// The curve of the points between each stop and the next, one after the other.
fn between_stops<const N: usize>(
    points: &[SVector<f64, N>],
    passing: &[Passing],
    curve: impl Fn(&[SVector<f64, N>]) -> Pieces<N>,
) -> Pieces<N> {
    let mut pieces: Pieces<N> = Vec::new();
    let mut first = 0;
    for last in (1..points.len()).filter(|i| passing[*i].stop || i + 1 == points.len()) {
        let start = pieces.last().map_or(0.0, |(piece, _)| piece.end());
        for (i, (piece, _)) in curve(&points[first..=last]).into_iter().enumerate() {
            let piece = Piece { start: start + piece.start, stop: i == 0 && first > 0, ..piece };
            pieces.push((piece, Origin::Between(first + i)));
        }
        first = last;
    }
    pieces
}

/// The same pieces, each with the share of the limits of speed of the nearer point; halfway between two of them pieces are cut.
pub(super) fn with_speeds<const N: usize>(pieces: Pieces<N>, form: &Form) -> Pieces<N> {
    let Form::Points { passing, .. } = form else { return pieces };
    let mut found: Pieces<N> = Vec::new();
    for run in pieces.chunk_by(|a, b| a.1 == b.1) {
        let [before, after] = match run[0].1 {
            Origin::Between(i) => [passing[i].speed, passing[i + 1].speed],
            Origin::Corner(i) => [passing[i].speed; 2],
            Origin::Piece(_) => [1.0; 2],
        };
        let [from, to] = [run[0].0.start, run[run.len() - 1].0.end()];
        let (middle, near) = (0.5 * (from + to), 1e-9 * (to - from));
        for (piece, origin) in run {
            if before == after || piece.end() <= middle + near {
                found.push((Piece { speed: before, ..*piece }, *origin));
            } else if piece.start >= middle - near {
                found.push((Piece { speed: after, ..*piece }, *origin));
            } else {
                // Back and forth: a piece run backwards may be cut at its end.
                let rest = Piece { length: piece.end() - middle, ..piece.reversed(0.0) }.reversed(middle);
                found.push((Piece { length: middle - piece.start, speed: before, ..*piece }, *origin));
                found.push((Piece { speed: after, ..rest }, *origin));
            }
        }
    }
    found
}

/// The corners that lines and arcs through points have, and their angles, rad.
pub(super) fn corners(points: &[Vec<f64>], arcs: &[Option<Arc>]) -> Vec<(usize, f64)> {
    let unit = |i: usize, share: f64| -> Vec<f64> {
        let way = way([&points[i], &points[i + 1]], arcs[i].as_ref(), share);
        let length = norm(&way);
        way.into_iter().map(|x| x / length).collect()
    };
    let mut found = Vec::new();
    for i in 0..points.len().saturating_sub(2) {
        let chord = way([&unit(i, 1.0), &unit(i + 1, 0.0)], None, 0.0);
        // The chord of an angle on the unit circle.
        let angle = 2.0 * (0.5 * norm(&chord)).min(1.0).asin();
        if angle > STRAIGHT {
            found.push((i + 1, angle));
        }
    }
    found
}

fn point<const N: usize>(q: &[f64]) -> SVector<f64, N> {
    SVector::from_fn(|joint, _| q.get(joint).copied().unwrap_or(0.0))
}

/// Lines from point to point, as long in s as in joint space.
fn lines<const N: usize>(points: &[SVector<f64, N>]) -> Pieces<N> {
    let mut start = 0.0;
    let mut pieces = Vec::new();
    for (i, pair) in points.windows(2).enumerate() {
        let piece = Piece::line(start, (pair[1] - pair[0]).norm(), pair[0].into(), pair[1].into());
        start = piece.end();
        pieces.push((piece, Origin::Between(i)));
    }
    pieces
}

/// The cubic spline through the points with natural ends, knots by chord length.
fn spline<const N: usize>(points: &[SVector<f64, N>]) -> Pieces<N> {
    let mut pieces = lines(points);
    let h: Vec<f64> = pieces.iter().map(|(piece, _)| piece.length).collect();
    for joint in 0..N {
        let q: Vec<f64> = points.iter().map(|point| point[joint]).collect();
        let second = natural(&h, &q);
        for (i, (piece, _)) in pieces.iter_mut().enumerate() {
            piece.coefficients[1][joint] = (q[i + 1] - q[i]) / h[i] - (2.0 * second[i] + second[i + 1]) * h[i] / 6.0;
            piece.coefficients[2][joint] = second[i] / 2.0;
            piece.coefficients[3][joint] = (second[i + 1] - second[i]) / (6.0 * h[i]);
        }
    }
    pieces
}

/// The second derivatives at the knots of the natural cubic spline, from the lengths of its pieces and its values.
///
/// They solve a tridiagonal system, diagonally dominant: elimination downwards, substitution upwards.
pub(super) fn natural(h: &[f64], q: &[f64]) -> Vec<f64> {
    let n = h.len();
    let chord = |i: usize| (q[i + 1] - q[i]) / h[i];
    let mut second = vec![0.0; n + 1];
    let mut upper = vec![0.0; n + 1];
    for i in 1..n {
        let pivot = 2.0 * (h[i - 1] + h[i]) - h[i - 1] * upper[i - 1];
        upper[i] = h[i] / pivot;
        second[i] = (6.0 * (chord(i) - chord(i - 1)) - h[i - 1] * second[i - 1]) / pivot;
    }
    for i in (1..n).rev() {
        second[i] -= upper[i] * second[i + 1];
    }
    second
}

/// Quintics with q'' = 0 at the points, each joint monotone between them, knots by chord length.
///
/// On a piece q' has the Bernstein coefficients (a, a, 5 m - 2 (a + b), b, b) with the slopes a, b at its ends and m of its chord. Slopes of
/// the sign of m and of at most 1.25 |m| keep all of them on one side of zero.
fn through<const N: usize>(points: &[SVector<f64, N>]) -> Pieces<N> {
    let mut pieces = lines(points);
    let n = pieces.len();
    let h: Vec<f64> = pieces.iter().map(|(piece, _)| piece.length).collect();
    for joint in 0..N {
        let chord = |i: usize| (points[i + 1][joint] - points[i][joint]) / h[i];
        let slope = |i: usize| {
            if i == 0 || i == n {
                return chord(i.min(n - 1));
            }
            let (before, after) = (chord(i - 1), chord(i));
            if before * after <= 0.0 {
                return 0.0;
            }
            // The harmonic mean of the chords, weighted so that the shorter piece counts more.
            let mean = (h[i - 1] + h[i]) / (h[i] / before + h[i - 1] / after);
            mean.signum() * mean.abs().min(1.25 * before.abs().min(after.abs()))
        };
        for (i, (piece, _)) in pieces.iter_mut().enumerate() {
            let (a, b, m) = (slope(i), slope(i + 1), chord(i));
            let (middle, h) = (5.0 * m - 2.0 * (a + b), h[i]);
            piece.coefficients[1][joint] = a;
            piece.coefficients[3][joint] = 2.0 * (middle - a) / (h * h);
            piece.coefficients[4][joint] = (2.0 * a - 3.0 * middle + b) / (h * h * h);
            piece.coefficients[5][joint] = (6.0 * middle - 3.0 * (a + b)) / (5.0 * h * h * h * h);
        }
    }
    pieces
}

/// Lines and arcs; corners of two lines are rounded by quintics that have q' and q'' = 0 in common with both.
///
/// An arc is a piece from its start to its end of the length of the arc: whoever follows it replaces the position ([`Arc::at`]).
/// A corner at p between unit directions a and b begins d before p and ends d after it, and is 2 d long in s. Its control points lie at
/// -1, -0.6, -0.2 times d a and 0.2, 0.6, 1 times d b from p, so it passes p at the distance 3/16 d |b - a|.
fn rounded<const N: usize>(
    points: &[SVector<f64, N>],
    passing: &[Passing],
    arcs: &[Option<Arc>],
    blend: Option<f64>,
) -> Pieces<N> {
    let n = points.len() - 1;
    let ways = points.windows(2).zip(arcs).map(|(pair, arc)| way([pair[0].as_slice(), pair[1].as_slice()], arc.as_ref(), 0.0));
    let length: Vec<f64> = ways.map(|way| norm(&way)).collect();
    let direction: Vec<SVector<f64, N>> =
        points.windows(2).zip(&length).map(|(pair, length)| (pair[1] - pair[0]) / *length).collect();
    // How much of the lines the corner at each point takes.
    let cut: Vec<f64> = (0..=n)
        .map(|i| {
            let is_cut = i > 0 && i < n && !passing[i].stop && arcs[i - 1].is_none() && arcs[i].is_none();
            let Some(blend) = blend.filter(|_| is_cut) else { return 0.0 };
            let turn = (direction[i] - direction[i - 1]).norm();
            if turn <= STRAIGHT {
                return 0.0;
            }
            (blend * 16.0 / (3.0 * turn)).min(0.5 * length[i - 1].min(length[i]))
        })
        .collect();
    let mut pieces: Pieces<N> = Vec::new();
    let mut start = 0.0;
    for i in 0..n {
        let (from, to) = (points[i] + direction[i] * cut[i], points[i + 1] - direction[i] * cut[i + 1]);
        let rest = length[i] - cut[i] - cut[i + 1];
        if rest > 1e-9 * length[i] {
            let piece = Piece { stop: passing[i].stop, ..Piece::line(start, rest, from.into(), to.into()) };
            start = piece.end();
            pieces.push((piece, Origin::Between(i)));
        }
        let d = cut[i + 1];
        if d > 0.0 {
            let (a, b, p) = (direction[i], direction[i + 1], points[i + 1]);
            let control = [p - a * d, p - a * (0.6 * d), p - a * (0.2 * d), p + b * (0.2 * d), p + b * (0.6 * d), p + b * d];
            let piece = Piece::new(start, 2.0 * d, powers(&control, 2.0 * d));
            start = piece.end();
            pieces.push((piece, Origin::Corner(i + 1)));
        }
    }
    pieces
}

/// Powers of s from the control points of a quintic: c_k = C(5, k) Δ^k P_0 / length^k.
fn powers<const N: usize>(control: &[SVector<f64, N>; 6], length: f64) -> [SVector<f64, N>; 6] {
    let mut differences = *control;
    let mut powers = [control[0]; 6];
    let mut scale = 1.0;
    for k in 0..6 {
        powers[k] = differences[0] * (scale * [1.0, 5.0, 10.0, 10.0, 5.0, 1.0][k]);
        for i in 0..5 - k {
            differences[i] = differences[i + 1] - differences[i];
        }
        scale /= length;
    }
    powers
}
