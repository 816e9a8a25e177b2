//! Paths of random points and of one line, and their timing.

use super::chain::{self, Chain};
use armgen_runtime::timing::{
    time_optimal, Ends, JointFriction, JointPath, Limits, Node, PathDynamics, Piece, Segment, Timing, TimingError, Workspace,
};
use nalgebra::{DMatrix, DVector, SVector};

/// Random numbers in [0, 1) (Knuth's linear congruences).
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The natural cubic spline through points, knots by chord length.
fn spline<const N: usize>(points: &[SVector<f64, N>]) -> Vec<Piece<f64, N>> {
    let n = points.len() - 1;
    let h: Vec<f64> = points.windows(2).map(|p| (p[1] - p[0]).norm()).collect();
    let mut system = DMatrix::zeros(n + 1, n + 1);
    system[(0, 0)] = 1.0;
    system[(n, n)] = 1.0;
    for i in 1..n {
        (system[(i, i - 1)], system[(i, i)], system[(i, i + 1)]) = (h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i]);
    }
    let lu = system.lu();
    let mut second = vec![SVector::<f64, N>::zeros(); n + 1];
    for joint in 0..N {
        let right = DVector::from_fn(n + 1, |i, _| match i {
            0 => 0.0,
            i if i == n => 0.0,
            i => 6.0 * ((points[i + 1] - points[i])[joint] / h[i] - (points[i] - points[i - 1])[joint] / h[i - 1]),
        });
        let solution = lu.solve(&right).expect("a spline");
        (0..=n).for_each(|i| second[i][joint] = solution[i]);
    }
    let mut start = 0.0;
    (0..n)
        .map(|i| {
            let mut coefficients = [SVector::zeros(); 6];
            coefficients[0] = points[i];
            coefficients[1] = (points[i + 1] - points[i]) / h[i] - (second[i] * 2.0 + second[i + 1]) * (h[i] / 6.0);
            coefficients[2] = second[i] / 2.0;
            coefficients[3] = (second[i + 1] - second[i]) / (6.0 * h[i]);
            let piece = Piece::new(start, h[i], coefficients);
            start += h[i];
            piece
        })
        .collect()
}

/// Three to seven points, anywhere within `range` of zero.
pub fn random_path<const N: usize>(next: &mut impl FnMut() -> f64, range: [f64; N]) -> JointPath<f64, N, Vec<Piece<f64, N>>> {
    let count = 3 + (next() * 5.0) as usize;
    let points: Vec<SVector<f64, N>> = (0..count).map(|_| SVector::from_fn(|j, _| range[j] * (2.0 * next() - 1.0))).collect();
    JointPath::new(spline(&points)).expect("a path")
}

pub fn with_timing<R: PathDynamics<N, Real = f64>, const N: usize, A>(
    robot: &R,
    path: &JointPath<f64, N, Vec<Piece<f64, N>>>,
    limits: &Limits<f64, N>,
    ends: Ends<f64>,
    goal: f64,
    segments: usize,
    judge: impl FnOnce(Result<Timing<'_, f64, N>, TimingError>) -> A,
) -> A {
    let (mut nodes, mut segments) = (vec![Node::empty(); 2 * segments + 64], vec![Segment::empty(); segments + 1]);
    let work = Workspace { nodes: &mut nodes, segments: &mut segments };
    judge(time_optimal(robot, path, limits, ends, goal, work))
}

pub const FREE: f64 = f64::INFINITY;

/// An arm of one joint, and the path from 0 to `length` in one piece.
pub fn one_joint(slides: bool, friction: [f64; 2], gravity: [f64; 3], mass: f64) -> Chain<1> {
    let friction = JointFriction { viscous: friction[0], coulomb: friction[1], ..JointFriction::default() };
    let a = if slides { 0.0 } else { 1.0 };
    let row = chain::Row {
        slides,
        a,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        mass,
        com: [0.0; 3],
        inertia: [0.0; 6],
        rotor: [0.0; 2],
        friction,
    };
    Chain::new([row], gravity)
}

pub fn line<const N: usize>(length: f64, from: [f64; N], to: [f64; N]) -> JointPath<f64, N, Vec<Piece<f64, N>>> {
    JointPath::new(vec![Piece::line(0.0, length, from, to)]).expect("a line")
}
