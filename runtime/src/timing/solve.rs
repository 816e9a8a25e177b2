//! The solution: bounds from above, a motion from below, halves of the segments between which most is left.

use super::fault::{TimingError, TimingFault};
use super::grid;
use super::law::Law;
use super::limits::Limits;
use super::model::{JointFriction, PathDynamics};
use super::outer::{self, NodeBound, Side};
use super::path::{number, JointPath, Piece};
use super::polynomial;
use super::segment::{limit, Assumed, Barrier, Interpolation, Node, Segment};
use super::timed::Timing;
use super::trial::{Formed, Trial};
use crate::linalg::lit;
use nalgebra::RealField;

/// What is asked at the ends of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends<T> {
    /// ds at the start and at the end, 1/s; at least 0.
    pub speed: [T; 2],
    /// Whether the arm must be able to hold itself at rest at the end, and where it stops.
    pub hold: bool,
}

impl<T: RealField> Ends<T> {
    /// At rest at both ends, held at the end.
    pub fn at_rest() -> Self {
        Self { speed: [T::zero(), T::zero()], hold: true }
    }
}

/// The caller's storage.
#[derive(Debug)]
pub struct Workspace<'a, T, const N: usize> {
    /// At least 2 n + 1 for each piece of n base segments, n = 8 times the way of all joints in rad, or 4 times where memory is short.
    pub nodes: &'a mut [Node<T, N>],
    /// One more than the segments of the result.
    pub segments: &'a mut [Segment<T, N>],
}

/// Rounds of refinement at most; each halves at least one segment.
const ROUNDS: usize = 40;
/// The share of the bound with which a law of a segment is taken at once.
const GOOD: f64 = 0.998;

struct Solver<'a, T, const N: usize> {
    limits: &'a Limits<T, N>,
    friction: &'a [JointFriction<T>; N],
    ends: &'a Ends<T>,
    /// Whether friction is no line over x.
    curved: bool,
}

/// What one pass of the inner solution assumes of x.
#[derive(Clone, Copy)]
enum Assume<T> {
    /// Between 0 and the bound.
    Bound,
    /// Above this share of the last law.
    Share(T),
}

/// The segment that begins at node `i`, or the last one and `true` at the end of the path.
fn beside<T, const N: usize>(segments: &[Segment<T, N>], i: usize) -> Option<(&Segment<T, N>, bool)> {
    let (_, segments) = segments.split_last()?;
    segments.get(i).map(|segment| (segment, false)).or(segments.last().map(|segment| (segment, true)))
}

/// Where the inner solution fails.
struct Stuck {
    segment: usize,
}

/// The fastest motion on a path within limits, with a proof that no motion is faster by more than the gap.
///
/// x = ds² is the pointwise largest profile, so friction is no obstacle: of two profiles that keep the limits, the larger one at
/// each place keeps them, too. Every limit holds on all of every segment. Refinement stops at gap <= `goal`, or when `work` is full.
///
/// # Errors
/// Where the path cannot be timed: with the place, the joint and the limit.
pub fn time_optimal<'w, T: RealField + Copy, R: PathDynamics<N, Real = T>, S: AsRef<[Piece<T, N>]>, const N: usize>(
    robot: &R,
    path: &'w JointPath<T, N, S>,
    limits: &Limits<T, N>,
    ends: Ends<T>,
    goal: T,
    work: Workspace<'w, T, N>,
) -> Result<Timing<'w, T, N>, TimingError> {
    let zero = T::zero();
    let pieces = path.pieces();
    let friction = robot.joint_friction();
    let at = |s: T, piece: usize, fault| TimingError { s: number(s), piece, fault };
    if !ends.speed.iter().all(|v| *v >= zero && v.is_finite()) {
        return Err(at(pieces.first().map_or(zero, |p| p.start), 0, TimingFault::SpeedNegative));
    }
    for joint in 0..N {
        let [low, high] = limits.effort[joint];
        if limits.velocity[joint].is_finite() || low.is_finite() || high.is_finite() {
            continue;
        }
        for (index, piece) in pieces.iter().enumerate() {
            if polynomial::largest(&polynomial::derivative(&piece.joint(joint)), piece.length) > zero {
                return Err(at(piece.start, index, TimingFault::MissingLimit { joint }));
            }
        }
    }
    let interpolation = Interpolation::new();
    let Workspace { nodes, segments } = work;
    let (layout, mut count) = grid::build(robot, pieces, nodes, segments, &interpolation, limits.tool.as_ref())?;
    let curved = friction.iter().any(JointFriction::is_curved);
    let solver = Solver { limits, friction, ends: &ends, curved };
    solver.check_rests(segments, count)?;
    let mut solved = false;
    let mut best = Totals { duration: zero, lower: zero };
    for round in 0..ROUNDS {
        let Some(active) = segments.get_mut(..count + 1) else { break };
        solver.bounds(active)?;
        let result = solver.inner(active, round > 0 && solved);
        let room = segments.len().saturating_sub(count + 1);
        let active = &mut segments[..count + 1];
        match result {
            Ok(()) => {
                solved = true;
                best = solver.totals(active);
                if best.duration <= best.lower * (T::one() + goal) || !solver.mark(active, &best, goal, room) {
                    break;
                }
            }
            Err(stuck) => {
                solved = false;
                solver.mark_stuck(active, &stuck, room)?;
            }
        }
        if round + 1 == ROUNDS {
            for segment in active.iter_mut() {
                segment.split = false;
            }
            break;
        }
        count = grid::halve(robot, pieces, &layout, nodes, segments, count, &interpolation);
        solved = solved && best.duration.is_finite();
    }
    if !solved || !best.duration.is_finite() {
        return Err(at(pieces.first().map_or(zero, |p| p.start), 0, TimingFault::TooCoarse { segments: count * 2 }));
    }
    Ok(Timing::new(pieces, segments, count, limits, friction, best.duration, best.lower))
}

#[derive(Clone, Copy)]
struct Totals<T> {
    duration: T,
    lower: T,
}

impl<T: RealField + Copy, const N: usize> Solver<'_, T, N> {
    /// Whether the arm can be held at rest where it stops, and at the end.
    fn check_rests(&self, segments: &[Segment<T, N>], count: usize) -> Result<(), TimingError> {
        let segments = segments.get(..count).filter(|_| self.ends.hold).unwrap_or(&[]);
        let stops = segments.windows(2).filter_map(|pair| match pair {
            [before, after] if after.stop => Some(before),
            _ => None,
        });
        for of in stops.chain(segments.last().filter(|_| self.ends.speed[1] == T::zero())) {
            if let Some((joint, torque, limit)) = of.unheld(true, self.limits, self.friction) {
                let fault = TimingFault::EndNotHeld { joint, torque: number(torque), limit: number(limit) };
                return Err(TimingError { s: number(of.end()), piece: of.piece, fault });
            }
        }
        Ok(())
    }

    /// Bounds from above, at nodes and on segments.
    fn bounds(&self, segments: &mut [Segment<T, N>]) -> Result<(), TimingError> {
        let count = segments.len() - 1;
        let at = |segment: &Segment<T, N>, end: bool, fault| TimingError {
            s: number(if end { segment.end() } else { segment.start }),
            piece: segment.piece,
            fault,
        };
        let mut side = Side::empty();
        for i in 0..segments.len() {
            let (left, right) = (i.checked_sub(1).and_then(|i| segments.get(i)), segments.get(i).filter(|_| i < count));
            if ![left, right].into_iter().flatten().any(|segment| segment.is_new) {
                continue;
            }
            match outer::node_bound(left, right, self.limits, self.friction, &mut side) {
                NodeBound::AtMost(x) => {
                    let x = if segments[i].stop { T::zero() } else { x };
                    segments[i].changed |= x != segments[i].bound.node;
                    segments[i].bound.node = x;
                }
                NodeBound::Nothing(index) => {
                    let (limit, joint) = limit(index, N);
                    let Some((segment, end)) = beside(segments, i) else { continue };
                    return Err(at(segment, end, TimingFault::InfeasiblePoint { joint, limit }));
                }
            }
        }
        // Rounded upwards, of the smallest speeds, too.
        let least = |v: T| if v > T::zero() { lit(1e-30) } else { T::zero() };
        let [start, end] = self.ends.speed.map(|v| v * v * (T::one() + T::default_epsilon() * lit(4.0)) + least(v));
        for (given, i) in [(start, 0), (end, count)] {
            let Some((segment, is_end)) = beside(segments, i) else { continue };
            let node = segments.get(i).map_or(given, |of| of.bound.node);
            if given > node * lit(1.0 + 1e-9) {
                let (limit, joint) = self.binding_at_node(segment, if is_end { 2 } else { 0 }, given);
                let (speed, needed) = (number(node.max(T::zero()).sqrt()), number(given.sqrt()));
                return Err(at(segment, is_end, TimingFault::InfeasibleSpeed { joint, limit, speed, needed, proved: true }));
            }
        }
        let mut x = segments.first().map_or(start, |first| first.bound.node.min(start));
        for i in 0..count {
            let Some([segment, next, ..]) = segments.get_mut(i..) else { break };
            let next = next.bound.node;
            if segment.is_new {
                segment.bound.barriers[2] = outer::speed(segment, self.limits, self.friction);
            }
            if segment.is_new || x != segment.bound.forward {
                segment.changed = true;
                segment.bound.forward = x;
                segment.bound.barriers[0] = outer::least::<_, N, false>(segment, self.limits, self.friction, x);
            }
            let barrier = segment.bound.barriers[0];
            let reached = barrier.map_or(next, |b| b.law.x2);
            if let Some(barrier) = barrier.filter(|b| b.law.x2 < T::zero()) {
                let (limit, joint) = limit(barrier.row, N);
                let fault =
                    TimingFault::InfeasibleSpeed { joint, limit, speed: number(x.sqrt()), needed: f64::NAN, proved: true };
                return Err(TimingError {
                    s: number(segment.start + segment.length * zero_of(&barrier.law)),
                    piece: segment.piece,
                    fault,
                });
            }
            x = next.min(reached);
        }
        if let Some(last) = segments.last_mut() {
            last.changed |= x != last.bound.forward;
            last.bound.forward = x;
        }
        if let Some((segment, _)) = beside(segments, count).filter(|_| end > x * lit(1.0 + 1e-9)) {
            let (limit, joint) =
                segment.bound.barriers[0].map_or_else(|| self.binding_at_node(segment, 2, end), |b| limit(b.row, N));
            let (speed, needed) = (number(x.sqrt()), number(end.sqrt()));
            return Err(at(segment, true, TimingFault::InfeasibleSpeed { joint, limit, speed, needed, proved: true }));
        }
        let mut before = x;
        if let Some(last) = segments.last_mut() {
            x = last.bound.node.min(end);
            before = last.bound.backward;
            last.changed |= x != before;
            last.bound.backward = x;
        }
        for segment in segments.iter_mut().take(count).rev() {
            if segment.is_new || x != before {
                segment.changed = true;
                let barrier = outer::least::<_, N, true>(segment, self.limits, self.friction, x);
                segment.bound.barriers[1] = barrier.map(|b| Barrier { law: reversed(&b.law), ..b });
            }
            let barrier = segment.bound.barriers[1].map(|b| Barrier { law: reversed(&b.law), ..b });
            let reached = barrier.map_or(segment.bound.node, |b| b.law.x2);
            if let Some(barrier) = barrier.filter(|b| b.law.x2 < T::zero()) {
                let (limit, joint) = limit(barrier.row, N);
                let fault =
                    TimingFault::InfeasibleSpeed { joint, limit, speed: number(x.sqrt()), needed: f64::NAN, proved: true };
                return Err(TimingError {
                    s: number(segment.end() - segment.length * zero_of(&barrier.law)),
                    piece: segment.piece,
                    fault,
                });
            }
            x = segment.bound.node.min(reached);
            before = segment.bound.backward;
            segment.changed |= x != before;
            segment.bound.backward = x;
            segment.is_new = false;
        }
        if let Some(segment) = segments.first().filter(|_| start > x * lit(1.0 + 1e-9)) {
            let (limit, joint) =
                segment.bound.barriers[1].map_or_else(|| self.binding_at_node(segment, 0, start), |b| limit(b.row, N));
            let (speed, needed) = (number(x.sqrt()), number(start.sqrt()));
            return Err(at(segment, false, TimingFault::InfeasibleSpeed { joint, limit, speed, needed, proved: true }));
        }
        Ok(())
    }

    /// The row that is worst at an end of a segment without acceleration.
    fn binding_at_node(&self, segment: &Segment<T, N>, end: usize, x: T) -> (super::segment::Limit, usize) {
        let mut worst = (T::zero(), 0);
        for index in 0..Segment::<T, N>::ROWS {
            let Some(row) = segment.row(index, self.limits, self.friction, false) else { continue };
            let share = (row.c[end] * x + row.curved(end, x) + row.d[end]) / row.bound;
            if share > worst.0 {
                worst = (share, index);
            }
        }
        limit(worst.1, N)
    }

    /// A motion that keeps all rows. `known`: the laws of the segments are those of a coarser grid.
    fn inner(&self, segments: &mut [Segment<T, N>], known: bool) -> Result<(), Stuck> {
        if !self.curved {
            self.pass(segments, Assume::Bound, known)?;
        } else if !(known && self.pass(segments, Assume::Share(lit(0.97)), true).is_ok()) {
            self.pass(segments, Assume::Bound, false)?;
            // A pass that fails leaves the law of the one before it.
            let _ = self.pass(segments, Assume::Share(lit(0.9)), false);
        }
        for segment in segments {
            segment.changed = false;
        }
        Ok(())
    }

    /// What the rows of a segment may assume.
    fn assumed(&self, segment: &Segment<T, N>, next: T, assume: Assume<T>) -> Assumed<T> {
        let here = segment.bound.x();
        let half: T = lit(0.5);
        let mut most = here.max(next);
        let mut u = (next - here).abs() * half / segment.length;
        let mut middle = (here + next) * half;
        for barrier in segment.bound.barriers.iter().flatten() {
            most = most.max((here + next) * half + barrier.law.k);
        }
        for barrier in segment.bound.barriers.iter().take(2).flatten() {
            u = barrier.law.acceleration().iter().fold(u, |most, u| most.max(u.abs()));
        }
        most *= lit(1.02);
        let mut least = T::zero();
        if let Assume::Share(share) = assume {
            let law = &segment.inner.law;
            let lowest = law.x0.min(law.middle()).min(law.x2).max(T::zero());
            least = (lowest * share).min(here).min(next);
            middle = law.x(half);
        }
        Assumed { x: [least, most], touch: middle.max(most * lit(1e-9)).max(lit(1e-30)), u: u * lit(3.0) }
    }

    /// Intervals backwards, the law forwards. With `local` a segment keeps what it has as long as nothing that it depends on has changed.
    fn pass(&self, segments: &mut [Segment<T, N>], assume: Assume<T>, local: bool) -> Result<(), Stuck> {
        let count = segments.len() - 1;
        let zero = T::zero();
        let [start, end] = self.ends.speed.map(|v| v * v);
        let mut next = [end, end];
        let mut before = next;
        let mut failed = None;
        // The rows that bind are likely those of the neighbour.
        let mut first = [None; 2];
        let mut formed = Formed::new();
        for i in (0..count).rev() {
            let near = segments.get(i.saturating_sub(1)..(i + 3).min(count + 1)).unwrap_or(&[]);
            let keeps = local && next == before && !near.iter().any(|of| of.changed);
            if let Some(segment) = segments.get_mut(i) {
                segment.fresh = !keeps;
                before = segment.inner.interval;
                if keeps {
                    segment.inner.trial = before;
                    segment.time = segment.inner.law.k;
                    next = before;
                    continue;
                }
            }
            let bound = |i: usize| segments.get(i).map(|segment| segment.bound.x());
            let (Some(here), Some(after)) = (bound(i), bound(i + 1)) else { continue };
            let before = i.checked_sub(1).and_then(bound).unwrap_or(here);
            let beyond = bound(i + 2).unwrap_or(after);
            let segment = &segments[i];
            let assumed = self.assumed(segment, after, assume);
            let mut ks = [Some(zero); 5];
            for (k, barrier) in ks.iter_mut().zip(order(&segment.bound.barriers)) {
                *k = barrier.map(|law| law.k);
            }
            ks[3] = Some((here + after - before - beyond) / lit(8.0));
            let mut best: Option<([T; 2], T)> = None;
            let mut trial = Trial::new(segment, self.limits, self.friction, assumed, here, first, &mut formed);
            for k in ks.into_iter().flatten() {
                if let Some(interval) = trial.backwards(k, &assumed, next, assumed.x[0], here) {
                    if best.is_none_or(|(of, _)| interval[1] > of[1]) {
                        best = Some((interval, k));
                    }
                    if interval[1] >= here * lit(GOOD) {
                        break;
                    }
                }
            }
            first = trial.first;
            let Some((interval, k)) = best else {
                failed = Some(i);
                break;
            };
            next = interval;
            let segment = &mut segments[i];
            // A pass that fails leaves the law and the interval of the one before it.
            segment.inner.trial = interval;
            segment.time = k;
        }
        let tolerance = T::one() + lit::<T>(1e-9);
        if failed.is_none() && (start > next[1] * tolerance || start * tolerance < next[0]) {
            failed = Some(0);
        }
        if let Some(segment) = failed {
            return Err(Stuck { segment });
        }
        let mut x = start.min(next[1]);
        for i in 0..count {
            let Some([segment, after, ..]) = segments.get_mut(i..) else { break };
            let next = if i + 1 < count { after.inner.trial } else { [end, end] };
            let after = after.bound.x();
            if !segment.fresh && x == segment.inner.law.x0 {
                x = segment.inner.law.x2;
                continue;
            }
            let assumed = if segment.fresh { self.assumed(segment, after, assume) } else { segment.inner.assumed };
            let k = segment.time;
            let mut trial = Trial::new(segment, self.limits, self.friction, assumed, x, first, &mut formed);
            let to = trial.nearest(k, &assumed, next, next[1], |_| true);
            first = trial.first;
            // By construction there is one, within rounding.
            let to = to.unwrap_or_else(|| trial.highest(k, &assumed, next)).min(next[1]).max(next[0]);
            segment.inner.interval = segment.inner.trial;
            segment.inner.assumed = assumed;
            segment.inner.law = Law { length: segment.length, x0: x, k, x2: to };
            x = to;
        }
        Ok(())
    }

    /// Duration of the motion and its lower bound.
    fn totals(&self, segments: &mut [Segment<T, N>]) -> Totals<T> {
        let mut totals = Totals { duration: T::zero(), lower: T::zero() };
        for segment in segments.iter_mut() {
            segment.time = totals.duration;
            if segment.length > T::zero() {
                totals.duration += segment.inner.law.duration();
                totals.lower += lower(segment);
            }
        }
        // Sums round.
        totals.lower *= T::one() - T::default_epsilon() * lit(4.0 * segments.len() as f64);
        totals
    }

    /// Marks what leaves most of the gap; whether anything is marked.
    fn mark(&self, segments: &mut [Segment<T, N>], totals: &Totals<T>, goal: T, room: usize) -> bool {
        let count = segments.len() - 1;
        let mut threshold = goal * totals.duration / lit(2.0 * count as f64);
        if room == 0 || !threshold.is_finite() && room < count {
            return false;
        }
        if !threshold.is_finite() {
            threshold = T::zero();
        }
        let gap = |segment: &Segment<T, N>| segment.inner.law.duration() - lower(segment);
        for _ in 0..64 {
            let marked = segments.iter().take(count).filter(|s| gap(s) > threshold).count();
            // Half of the room is left for later rounds: their halves are where the gap stays, as at rest.
            if 2 * marked <= room + 1 {
                break;
            }
            threshold *= lit(2.0);
        }
        let mut marked = 0;
        for segment in segments.iter_mut().take(count) {
            segment.split = gap(segment) > threshold && marked < room;
            marked += usize::from(segment.split);
        }
        marked > 0
    }

    /// Marks the neighbours of the segment where no motion was found.
    fn mark_stuck(&self, segments: &mut [Segment<T, N>], stuck: &Stuck, room: usize) -> Result<(), TimingError> {
        let count = segments.len() - 1;
        let (Some(at), Some(first), Some((last, _))) = (segments.get(stuck.segment), segments.first(), beside(segments, count))
        else {
            return Ok(());
        };
        let error = |fault| TimingError { s: number(at.start), piece: at.piece, fault };
        let range = stuck.segment.saturating_sub(2)..(stuck.segment + 4).min(count);
        if at.length < (last.end() - first.start) * lit(1e-7) {
            let (limit, joint) = at
                .bound
                .barriers
                .iter()
                .flatten()
                .next()
                .map_or_else(|| self.binding_at_node(at, 0, at.bound.x()), |barrier| limit(barrier.row, N));
            let speed = number(at.bound.x().sqrt());
            return Err(error(TimingFault::InfeasibleSpeed { joint, limit, speed, needed: f64::NAN, proved: false }));
        }
        if range.len() > room {
            return Err(error(TimingFault::TooCoarse { segments: count * 2 }));
        }
        for (i, segment) in segments.iter_mut().enumerate() {
            segment.split = range.contains(&i);
        }
        Ok(())
    }
}

/// The least time in which a motion passes a segment.
fn lower<T: RealField + Copy, const N: usize>(segment: &Segment<T, N>) -> T {
    let of = |barrier: &Barrier<T>| {
        let time = barrier.law.duration();
        if time.is_finite() {
            time
        } else {
            T::zero()
        }
    };
    segment.bound.barriers.iter().flatten().map(of).fold(T::zero(), |most, time| most.max(time))
}

/// Barriers' laws, the least in the middle first.
fn order<T: RealField + Copy>(barriers: &[Option<Barrier<T>>; 3]) -> [Option<Law<T>>; 3] {
    let mut laws = barriers.map(|barrier| barrier.map(|b| b.law));
    let middle = |law: &Option<Law<T>>| law.map_or(lit(1e30), |law| law.x(lit(0.5)));
    for i in [0, 1, 0] {
        if middle(&laws[i]) > middle(&laws[i + 1]) {
            laws.swap(i, i + 1);
        }
    }
    laws
}

/// The fraction of a segment at which a law that ends below zero gets there, from below.
fn zero_of<T: RealField + Copy>(law: &Law<T>) -> T {
    let (mut left, mut right) = (T::zero(), T::one());
    for _ in 0..60 {
        let middle = (left + right) * lit(0.5);
        if law.x(middle) > T::zero() {
            left = middle;
        } else {
            right = middle;
        }
    }
    left
}

/// The law seen from the other end.
fn reversed<T: RealField + Copy>(law: &Law<T>) -> Law<T> {
    Law { x0: law.x2, x2: law.x0, ..*law }
}
