//! Paths of the end effector: a joint spline near a curve of poses, on the branch of given joint values.
//!
//! A pose is a position and the rotation vector from the orientation at `start`, both in the base frame. With p' the derivative of the
//! pose along the path, joint values and q' = J^+ p' at nodes make a cubic Hermite spline; nodes are doubled until it is near the curve.
//! With more joints than rows J^+ gives the least |q'|, so the joints move the least (Siciliano et al., Sect. 3.5.1).

use std::cell::RefCell;

use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::{Model, Trig};
use armgen_evaluate::{program, Program, Workspace};
use armgen_runtime::timing::Piece;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SVector, Vector3, Vector6};

use super::arc::Arc;
use super::curve::{Origin, Pieces};
use super::file::Tip;

/// Places between two nodes at which the spline is compared with the curve.
const PLACES: usize = 8;
/// Between these places it may be farther away: the share of the tolerance that they may take.
const SHARE: f64 = 0.5;
/// Nodes of a piece at most.
const MOST: usize = 1024;
/// Halvings of a step that loses its branch.
const DEEPEST: u32 = 40;
/// A posture is singular where the least singular value of J is below this part of the largest.
const SINGULAR: f64 = 1e-4;
/// Joints that jump by more than this from a straight guess, rad or m, may have changed the branch.
const JUMP: f64 = 0.1;

/// How far the spline is from the curve at most, where it was compared: m and rad.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Distance {
    pub(super) metres: f64,
    pub(super) radians: f64,
}

/// Why there is no spline: where, on which piece of the curve, and the reason.
pub(super) struct Fault {
    pub(super) s: f64,
    pub(super) piece: usize,
    pub(super) kind: FaultKind,
}

pub(super) enum FaultKind {
    /// No joint values near those before it reach the pose: the distance that is left.
    Unreachable { off: Distance },
    /// J has no inverse: its least singular value, and how much it had to be.
    Singular { least: f64, needed: f64 },
    /// The spline stays this far away.
    Tolerance { off: Distance },
    /// The task has so many rows, more than joints.
    TooManyRows { rows: usize },
}

/// The kinematics of an arm.
struct Kinematics {
    dof: usize,
    /// Rows of the geometric Jacobian that are followed.
    rows: Vec<usize>,
    pose: Program<f64>,
    jacobian: Program<f64>,
    workspaces: RefCell<[Workspace<f64>; 2]>,
}

/// A place of the curve: position, orientation, and their derivatives.
struct Wanted {
    p: Vector3<f64>,
    r: Matrix3<f64>,
    rates: Vector6<f64>,
}

impl Kinematics {
    fn new(manipulator: &Manipulator) -> Kinematics {
        let functions = Selection::named(["direct_kinematics", "geometric_jacobian"]).expect("functions of the catalogue");
        let module =
            schedule::module(&Model::new(manipulator.clone()), &Options { trig: Trig::Fast, functions, ..Options::default() });
        let named = |name: &str| {
            let of = module.functions.iter().find(|of| of.name() == name).expect("a function of every arm with one end effector");
            program(&module, of)
        };
        let [pose, jacobian]: [Program<f64>; 2] = ["direct_kinematics", "geometric_jacobian"].map(named);
        let workspaces = RefCell::new([pose.workspace(), jacobian.workspace()]);
        Kinematics { dof: manipulator.dof(), rows: manipulator.task_rows(), pose, jacobian, workspaces }
    }

    /// Position and orientation.
    fn pose(&self, q: &DVector<f64>) -> (Vector3<f64>, Matrix3<f64>) {
        let mut t = vec![0.0; self.pose.outputs()];
        self.pose.run(&[q.as_slice()], &mut t, &mut self.workspaces.borrow_mut()[0]).expect("the lengths of this arm");
        (Vector3::from_fn(|i, _| t[4 * i + 3]), Matrix3::from_fn(|i, j| t[4 * i + j]))
    }

    /// The rows of J that are followed.
    fn jacobian(&self, q: &DVector<f64>) -> DMatrix<f64> {
        let mut j = vec![0.0; self.jacobian.outputs()];
        self.jacobian.run(&[q.as_slice()], &mut j, &mut self.workspaces.borrow_mut()[1]).expect("the lengths of this arm");
        DMatrix::from_fn(self.rows.len(), self.dof, |row, joint| j[self.rows[row] * self.dof + joint])
    }

    fn of_rows(&self, all: &Vector6<f64>) -> DVector<f64> {
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(|row| all[*row]))
    }

    /// From the pose at q to the wanted one, all rows.
    fn error(&self, q: &DVector<f64>, wanted: &Wanted) -> Vector6<f64> {
        let (p, r) = self.pose(q);
        let turn = Rotation3::from_matrix_unchecked(wanted.r * r.transpose()).scaled_axis();
        let e = wanted.p - p;
        Vector6::new(e.x, e.y, e.z, turn.x, turn.y, turn.z)
    }

    /// The error in the rows that are followed.
    fn off(&self, q: &DVector<f64>, wanted: &Wanted) -> Distance {
        let e = self.error(q, wanted);
        let norm = |range: std::ops::Range<usize>| {
            self.rows.iter().filter(|row| range.contains(row)).map(|row| e[*row] * e[*row]).sum::<f64>().sqrt()
        };
        Distance { metres: norm(0..3), radians: norm(3..6) }
    }

    /// Joint values at a pose, from near ones by Newton's method; `None` where it does not get there.
    fn solve(&self, near: &DVector<f64>, wanted: &Wanted) -> Option<DVector<f64>> {
        let mut q = near.clone();
        for _ in 0..30 {
            let e = self.of_rows(&self.error(&q, wanted));
            let j = self.jacobian(&q);
            let mut step = if j.is_square() { j.lu().solve(&e)? } else { least(&j, &e)? };
            if !step.iter().all(|x| x.is_finite()) {
                return None;
            }
            let size = step.amax();
            if size > 0.5 {
                step *= 0.5 / size;
            }
            q += &step;
            if size < 1e-12 * (1.0 + q.amax()) {
                return Some(q);
            }
        }
        (self.of_rows(&self.error(&q, wanted)).amax() < 1e-10).then_some(q)
    }

    /// q' at a place, or the least singular value of J there and the one that it needs.
    fn slope(&self, q: &DVector<f64>, wanted: &Wanted) -> Result<DVector<f64>, (f64, f64)> {
        let j = self.jacobian(q);
        if !j.iter().all(|x| x.is_finite()) {
            return Err((f64::NAN, f64::NAN));
        }
        let svd = j.svd(true, true);
        let (least, needed) = (svd.singular_values.min(), SINGULAR * svd.singular_values.max());
        if least <= needed {
            return Err((least, needed));
        }
        svd.solve(&self.of_rows(&wanted.rates), 0.0).map_err(|_| (least, needed))
    }
}

/// The least x with J x = e, J of full row rank: x = J' (J J')^-1 e.
fn least(j: &DMatrix<f64>, e: &DVector<f64>) -> Option<DVector<f64>> {
    Some(j.tr_mul(&(j * j.transpose()).cholesky()?.solve(e)))
}

/// The place s of a piece of the curve; `base` is the orientation that rotation vectors count from.
fn wanted(piece: &Piece<f64, 6>, arc: Option<&Arc>, s: f64, base: &Matrix3<f64>) -> Wanted {
    let at = piece.at(s);
    let [mut p, turn] = [0, 3].map(|k| Vector3::new(at.q[k], at.q[k + 1], at.q[k + 2]));
    let [mut dp, d_turn] = [0, 3].map(|k| Vector3::new(at.slope[k], at.slope[k + 1], at.slope[k + 2]));
    if let Some(arc) = arc {
        let [position, slope] = arc.at((s - piece.start) / piece.length);
        (p, dp) = (position, slope / piece.length);
    }
    // The angular velocity of exp(turn): the left Jacobian times the derivative of turn.
    let (angle, cross) = (turn.norm(), turn.cross_matrix());
    let (first, second) = if angle < 1e-4 {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    } else {
        ((1.0 - angle.cos()) / (angle * angle), (angle - angle.sin()) / (angle * angle * angle))
    };
    let w = d_turn + cross * d_turn * first + cross * cross * d_turn * second;
    let r = Rotation3::from_scaled_axis(turn).into_inner() * base;
    Wanted { p, r, rates: Vector6::new(dp.x, dp.y, dp.z, w.x, w.y, w.z) }
}

/// The way along a piece of the curve.
struct Way<'a> {
    arm: &'a Kinematics,
    curve: &'a Piece<f64, 6>,
    arc: Option<&'a Arc>,
    piece: usize,
    base: Matrix3<f64>,
}

impl Way<'_> {
    fn wanted(&self, s: f64) -> Wanted {
        wanted(self.curve, self.arc, s, &self.base)
    }

    fn fault(&self, s: f64, kind: FaultKind) -> Fault {
        Fault { s, piece: self.piece, kind }
    }

    fn slope(&self, s: f64, q: &DVector<f64>) -> Result<DVector<f64>, Fault> {
        let slope = self.arm.slope(q, &self.wanted(s));
        slope.map_err(|(least, needed)| self.fault(s, FaultKind::Singular { least, needed }))
    }

    /// How far the joints get from q at `from` in a step h. Where J is square the pose corrects it; the null space keeps every error.
    /// So it is the method of Runge and Kutta there, whose error changes q'' by h³ only.
    fn step(&self, from: f64, q: &DVector<f64>, h: f64) -> Result<DVector<f64>, Fault> {
        let first = self.slope(from, q)?;
        if self.arm.rows.len() == self.arm.dof {
            return Ok(first * h);
        }
        let middle = from + 0.5 * h;
        let second = self.slope(middle, &(q + &first * (0.5 * h)))?;
        let third = self.slope(middle, &(q + &second * (0.5 * h)))?;
        let last = self.slope(from + h, &(q + &third * h))?;
        Ok((first + (second + third) * 2.0 + last) * (h / 6.0))
    }

    /// Joint values at `to` on the branch of q at `from`: steps that lose the branch are halved.
    fn follow(&self, from: f64, q: &DVector<f64>, to: f64, depth: u32) -> Result<DVector<f64>, Fault> {
        let there = self.wanted(to);
        let guess = q + self.step(from, q, to - from)?;
        let near = |found: &DVector<f64>| (found - &guess).amax() < JUMP;
        if let Some(found) = self.arm.solve(&guess, &there).filter(near) {
            return Ok(found);
        }
        if depth == DEEPEST {
            return Err(self.fault(from, self.unreachable(from)));
        }
        let middle = 0.5 * (from + to);
        let q = self.follow(from, q, middle, depth + 1)?;
        self.follow(middle, &q, to, depth + 1)
    }

    /// A posture that is singular because the curve leaves the reach of the arm: from q no joint values are found at `to`.
    fn judged(&self, fault: Fault, q: &DVector<f64>, to: f64) -> Fault {
        let is_singular = matches!(fault.kind, FaultKind::Singular { .. });
        if !is_singular || self.arm.solve(q, &self.wanted(to)).is_some() {
            return fault;
        }
        Fault { kind: self.unreachable(fault.s), ..fault }
    }

    /// What is left of the curve from s on.
    fn unreachable(&self, s: f64) -> FaultKind {
        let [here, end] = [s, self.curve.end()].map(|s| self.wanted(s));
        let turn = Rotation3::from_matrix_unchecked(end.r * here.r.transpose()).angle();
        FaultKind::Unreachable { off: Distance { metres: (end.p - here.p).norm(), radians: turn } }
    }

    /// The spline through `count` + 1 nodes, how far it is away, and where.
    fn spline<const N: usize>(
        &self,
        start: &DVector<f64>,
        count: usize,
    ) -> Result<(Vec<Piece<f64, N>>, Distance, f64, DVector<f64>), Fault> {
        let node = |i: usize| self.curve.start + self.curve.length * i as f64 / count as f64;
        let (mut q, mut slope) = (start.clone(), self.slope(node(0), start)?);
        let (mut pieces, mut worst, mut at) = (Vec::new(), Distance::default(), self.curve.start);
        for i in 0..count {
            let (from, to) = (node(i), if i + 1 == count { self.curve.end() } else { node(i + 1) });
            let next = self.follow(from, &q, to, 0).map_err(|fault| self.judged(fault, &q, to))?;
            let next_slope = self.slope(to, &next)?;
            let h = to - from;
            let mut piece = Piece::new(from, h, [SVector::zeros(); 6]);
            for joint in 0..self.arm.dof {
                let (a, b, va, vb) = (q[joint], next[joint], slope[joint], next_slope[joint]);
                let powers = [a, va, (3.0 * (b - a) / h - 2.0 * va - vb) / h, (va + vb - 2.0 * (b - a) / h) / (h * h)];
                for (to, power) in piece.coefficients.iter_mut().zip(powers) {
                    to[joint] = power;
                }
            }
            for place in 1..PLACES {
                let s = from + h * place as f64 / PLACES as f64;
                let here = piece.at(s).q;
                let here = DVector::from_fn(self.arm.dof, |joint, _| here[joint]);
                let off = self.arm.off(&here, &self.wanted(s));
                if off.metres.max(off.radians) > worst.metres.max(worst.radians) {
                    at = s;
                }
                worst.metres = worst.metres.max(off.metres);
                worst.radians = worst.radians.max(off.radians);
            }
            pieces.push(piece);
            (q, slope) = (next, next_slope);
        }
        Ok((pieces, worst, at, q))
    }
}

/// The joint spline along the curve of an arm with one end effector, each piece with the origin of the curve's piece.
pub(super) fn spline<const N: usize>(
    manipulator: &Manipulator,
    tip: &Tip,
    curve: &Pieces<6>,
    arcs: &[Option<Arc>],
) -> Result<(Pieces<N>, Distance), Fault> {
    let arm = Kinematics::new(manipulator);
    let begin = curve.first().map_or(0.0, |(piece, _)| piece.start);
    if arm.rows.len() > arm.dof {
        return Err(Fault { s: begin, piece: 0, kind: FaultKind::TooManyRows { rows: arm.rows.len() } });
    }
    let near = DVector::from_row_slice(&tip.start);
    let (_, base) = arm.pose(&near);
    let mut q = near.clone();
    if let Some((first, _)) = curve.first() {
        let there = wanted(first, None, begin, &base);
        let off = arm.off(&near, &there);
        let found = arm.solve(&near, &there);
        q = found.ok_or(Fault { s: begin, piece: 0, kind: FaultKind::Unreachable { off } })?;
    }
    let (mut pieces, mut worst): (Pieces<N>, Distance) = (Vec::new(), Distance::default());
    for (index, (of, origin)) in curve.iter().enumerate() {
        let arc = match origin {
            Origin::Between(i) => arcs.get(*i).and_then(Option::as_ref),
            _ => None,
        };
        let way = Way { arm: &arm, curve: of, arc, piece: index, base };
        let mut count = 2;
        let (found, off, end) = loop {
            let (found, off, at, end) = way.spline(&q, count)?;
            if off.metres.max(off.radians) <= SHARE * tip.tolerance {
                break (found, off, end);
            }
            if count >= MOST {
                return Err(way.fault(at, FaultKind::Tolerance { off }));
            }
            count *= 2;
        };
        worst.metres = worst.metres.max(off.metres);
        worst.radians = worst.radians.max(off.radians);
        let origin: Origin = *origin;
        let pieces_of = found.into_iter().enumerate();
        pieces.extend(pieces_of.map(|(i, piece)| (Piece { stop: i == 0 && of.stop, ..piece }, origin)));
        q = end;
    }
    Ok((pieces, worst))
}
