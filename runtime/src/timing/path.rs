//! Joint paths: pieces, each a polynomial of s.

use super::polynomial::{self, Polynomial, ORDER};
use crate::linalg::lit;
use core::marker::PhantomData;
use nalgebra::{RealField, SVector};

/// A piece of a joint path: q(s) = sum_k coefficients\[k\] (s - start)^k for start <= s <= start + length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<T, const N: usize> {
    /// Where it begins.
    pub start: T,
    /// How long it is in s; above zero.
    pub length: T,
    /// Powers of s - start, lowest first; rad or m.
    pub coefficients: [SVector<T, N>; 6],
    /// At most this share of each limit of speed holds on it; above 0, and 1 for all of it.
    pub speed: T,
    /// Whether the motion rests where it begins: the direction may change there.
    pub stop: bool,
}

impl<T: RealField + Copy, const N: usize> Piece<T, N> {
    /// A polynomial in s - start, at the full speed and without a stop.
    pub fn new(start: T, length: T, coefficients: [SVector<T, N>; 6]) -> Self {
        Self { start, length, coefficients, speed: T::one(), stop: false }
    }

    /// A line from `from` to `to`.
    pub fn line(start: T, length: T, from: [T; N], to: [T; N]) -> Self {
        let (from, to) = (SVector::from(from), SVector::from(to));
        let mut coefficients = [SVector::zeros(); ORDER];
        coefficients[0] = from;
        coefficients[1] = (to - from) / length;
        Self::new(start, length, coefficients)
    }

    /// Where it ends.
    pub fn end(&self) -> T {
        self.start + self.length
    }

    /// The same piece run backwards, beginning at `start`.
    ///
    /// A path is run backwards by its pieces in the other order; the time of its way back is that of another motion, since friction turns.
    /// A stop is not kept: on the way back it is where the piece ends.
    #[must_use]
    pub fn reversed(&self, start: T) -> Self {
        let mut coefficients = [SVector::zeros(); ORDER];
        for joint in 0..N {
            let mut sign = T::one();
            for (to, from) in coefficients.iter_mut().zip(polynomial::shifted(&self.joint(joint), self.length)) {
                to[joint] = sign * from;
                sign = -sign;
            }
        }
        Self { start, coefficients, stop: false, ..*self }
    }

    /// q, q' and q'' at `s`; s itself may be a little outside.
    pub fn at(&self, s: T) -> PathPoint<T, N> {
        let t = s - self.start;
        let mut point = PathPoint { q: SVector::zeros(), slope: SVector::zeros(), curvature: SVector::zeros() };
        for (k, c) in self.coefficients.iter().enumerate().rev() {
            point.q = point.q * t + c;
            if k >= 1 {
                point.slope = point.slope * t + c * lit::<T>(k as f64);
            }
            if k >= 2 {
                point.curvature = point.curvature * t + c * lit::<T>((k * (k - 1)) as f64);
            }
        }
        point
    }

    /// Where a joint can be farthest, (s, q): at the ends and at the roots of its rate.
    pub fn extremes(&self, joint: usize) -> [Option<(T, T)>; 8] {
        let Some(polynomial) = (joint < N).then(|| self.joint(joint)) else { return [None; 8] };
        let mut places = [None; 8];
        let roots = polynomial::roots(&polynomial::derivative(&polynomial), self.length);
        let all = [T::zero(), self.length].into_iter().chain(roots.into_iter().flatten());
        for (to, t) in places.iter_mut().zip(all) {
            *to = Some((self.start + t, polynomial::value(&polynomial, t)));
        }
        places
    }

    /// The polynomial of a joint in s - start.
    pub(super) fn joint(&self, joint: usize) -> Polynomial<T> {
        self.coefficients.map(|c| c[joint])
    }

    fn is_finite(&self) -> bool {
        self.start.is_finite() && self.length.is_finite() && self.coefficients.iter().all(crate::linalg::is_finite)
    }
}

/// A point of a path and its derivatives by s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint<T, const N: usize> {
    /// q, rad or m.
    pub q: SVector<T, N>,
    /// q' = dq/ds.
    pub slope: SVector<T, N>,
    /// q'' = d2q/ds2.
    pub curvature: SVector<T, N>,
}

/// A path of pieces, one after the other: continuous, with a continuous direction but where it stops, never at rest elsewhere.
///
/// Storage is the caller's: `S` is an array, a slice or a `Vec` of pieces.
#[derive(Clone, Copy, Debug)]
pub struct JointPath<T, const N: usize, S> {
    pieces: S,
    of: PhantomData<T>,
}

/// Why pieces are no path, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError {
    /// The value of s.
    pub s: f64,
    /// The piece, counted from 0; at a knot the one that begins there.
    pub piece: usize,
    /// The fault.
    pub fault: PathFault,
}

/// A fault of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathFault {
    /// There is no piece.
    Empty,
    /// A number is infinite, NaN, or so large or small that its square is none.
    NotFinite,
    /// The share of the limits of speed is not above 0, or above 1.
    Speed,
    /// A piece has no length, or no joint moves on it; within rounding, too.
    ZeroLength,
    /// A piece does not begin where the one before it ends, in s.
    Gap,
    /// q is not continuous.
    Jump {
        /// The joint, counted from 0.
        joint: usize,
        /// By how much, rad or m.
        by: f64,
    },
    /// The direction of q' is not continuous.
    Corner {
        /// Between the directions, rad.
        angle: f64,
    },
    /// The direction is continuous, but not the length of q': s counts differently on both sides.
    Scale,
    /// All joints come to rest, and the path turns back or goes on: a cusp.
    TurningBack,
}

messages! { PathError,
    PathError { s, piece, fault } => "at s = {}, piece {}: {}", s, piece + 1, fault;
}

messages! { PathFault,
    PathFault::Empty => "the path has no piece";
    PathFault::NotFinite => "a number is infinite, NaN, or far too large or small";
    PathFault::Speed => "the share of the limits of speed is not above 0, or above 1";
    PathFault::ZeroLength => "nothing moves here: leave the piece out; a pause belongs between two timings";
    PathFault::Gap => "the piece does not begin where the one before it ends";
    PathFault::Jump { joint, by } => "joint {} jumps by {}", joint + 1, by;
    PathFault::Corner { angle } => "the path has a corner of {} rad: blend it, or stop there", angle;
    PathFault::Scale => "q' changes its length at a knot: scale s of one piece so that q' is continuous";
    PathFault::TurningBack => "all joints are at rest at this point of the path: stop there";
}

/// How far two values of q at a knot may be apart, of the range of the joint.
const JUMP: f64 = 1e-9;
/// How far two directions at a knot may be apart, rad.
const CORNER: f64 = 1e-6;

impl<T: RealField + Copy, const N: usize, S: AsRef<[Piece<T, N>]>> JointPath<T, N, S> {
    /// A path of these pieces.
    ///
    /// # Errors
    /// The first fault from the start.
    pub fn new(pieces: S) -> Result<Self, PathError> {
        let all = pieces.as_ref();
        let fault = |s: T, piece: usize, fault: PathFault| PathError { s: number(s), piece, fault };
        if all.is_empty() {
            return Err(fault(T::zero(), 0, PathFault::Empty));
        }
        if let Some(i) = all.iter().position(|piece| !piece.is_finite()) {
            return Err(PathError { s: f64::NAN, piece: i, fault: PathFault::NotFinite });
        }
        let mut range = [T::zero(); N];
        for piece in all {
            for (joint, widest) in range.iter_mut().enumerate() {
                *widest = widest.max(polynomial::largest(&piece.joint(joint), piece.length));
            }
        }
        for (i, piece) in all.iter().enumerate() {
            let moves = (0..N).map(|joint| polynomial::largest(&polynomial::derivative(&piece.joint(joint)), piece.length));
            let moves = moves.fold(T::zero(), |sum, rate| sum + rate);
            let (way, widest) = (moves * piece.length, range.iter().fold(T::zero(), |most, of| most.max(*of)));
            let (eps, tolerance) = (T::default_epsilon(), lit::<T>(JUMP) * piece.start.abs());
            // Within rounding of s or of q, too.
            if !(piece.length > tolerance.max(piece.start.abs() * eps * lit(64.0))) || !(way > widest * eps * lit(4.0)) {
                return Err(fault(piece.start, i, PathFault::ZeroLength));
            }
            // Squares of rates and of their reciprocals are numbers.
            if ![piece.length, moves, way].iter().all(|size| (eps * eps..=T::one() / (eps * eps)).contains(size)) {
                return Err(PathError { s: f64::NAN, piece: i, fault: PathFault::NotFinite });
            }
            // Its square, too, is a number.
            if !(piece.speed > eps && piece.speed <= T::one()) {
                return Err(fault(piece.start, i, PathFault::Speed));
            }
            if let Some(s) = rest(piece, moves, i == 0 || piece.stop, all.get(i + 1).is_none_or(|next| next.stop)) {
                return Err(fault(s, i, PathFault::TurningBack));
            }
        }
        for (i, pair) in all.windows(2).enumerate() {
            let [before, after] = pair else { continue };
            let tolerance = lit::<T>(JUMP) * (before.length + after.length + before.start.abs());
            if (before.end() - after.start).abs() > tolerance {
                return Err(fault(after.start, i + 1, PathFault::Gap));
            }
            let (left, right) = (before.at(before.end()), after.at(after.start));
            for joint in 0..N {
                let by = (right.q[joint] - left.q[joint]).abs();
                if by > lit::<T>(JUMP) * range[joint].max(lit(1e-3)) {
                    return Err(fault(after.start, i + 1, PathFault::Jump { joint, by: number(by) }));
                }
            }
            if after.stop {
                continue;
            }
            let (a, b) = (left.slope / left.slope.norm(), right.slope / right.slope.norm());
            let apart = (b - a).norm();
            if !(apart <= lit(CORNER)) {
                // The chord of an angle on the unit circle.
                let angle = lit::<T>(2.0) * (apart * lit(0.5)).min(T::one()).asin();
                return Err(fault(after.start, i + 1, PathFault::Corner { angle: number(angle) }));
            }
            // A path whose speed along s jumps is a path whose x jumps.
            let (before_norm, after_norm) = (left.slope.norm(), right.slope.norm());
            if (before_norm - after_norm).abs() > lit::<T>(CORNER) * before_norm.max(after_norm) {
                return Err(fault(after.start, i + 1, PathFault::Scale));
            }
        }
        Ok(Self { pieces, of: PhantomData })
    }

    /// The pieces, in order.
    pub fn pieces(&self) -> &[Piece<T, N>] {
        self.pieces.as_ref()
    }
}

/// Where all joints rest inside a piece: at a common root of all rates. They may rest at its start if it is the `first` or stops there,
/// and at its end if it is the `last` or the next one stops there.
fn rest<T: RealField + Copy, const N: usize>(piece: &Piece<T, N>, moves: T, first: bool, last: bool) -> Option<T> {
    let small = moves * lit(1e-9);
    let mut candidates = [T::zero(); ORDER + 2];
    let mut count = 0;
    for joint in 0..N {
        let rate = polynomial::derivative(&piece.joint(joint));
        if polynomial::largest(&rate, piece.length) <= small {
            continue;
        }
        // Roots of one joint that moves are enough: all have to rest at once. A double root is a root of the derivative.
        for roots in [polynomial::roots(&rate, piece.length), polynomial::roots(&polynomial::derivative(&rate), piece.length)] {
            for root in roots.iter().flatten() {
                if let Some(place) = candidates.get_mut(count) {
                    *place = *root;
                    count += 1;
                }
            }
        }
        break;
    }
    let edges = [(T::zero(), first), (piece.length, last)];
    let inside = candidates.iter().take(count).copied();
    let mut all = inside.chain(edges.iter().filter(|(_, free)| !free).map(|(t, _)| *t));
    let tolerance = piece.length * lit(1e-9);
    all.find(|t| {
        let at_free_end = (first && *t <= tolerance) || (last && piece.length - *t <= tolerance);
        !at_free_end && piece.at(piece.start + *t).slope.amax() <= small
    })
    .map(|t| piece.start + t)
}

/// A number for a message.
pub(super) fn number<T: RealField>(x: T) -> f64 {
    crate::linalg::to_f64(x).unwrap_or(f64::NAN)
}
