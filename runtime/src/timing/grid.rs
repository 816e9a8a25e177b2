//! Grids: base segments of a path, roots of joint rates, halves.

use super::fault::{TimingError, TimingFault};
use super::limits::ToolLimit;
use super::majorant::{self, Bounds, NINE};
use super::model::PathDynamics;
use super::path::{number, Piece};
use super::polynomial::{self, ORDER};
use super::segment::{Interpolation, Node, Segment, Source, OVER};
use crate::linalg::{lit, to_f64};
use nalgebra::RealField;

/// Base segments for each radian that the joints move, all together.
const DENSITIES: [f64; 2] = [8.0, 4.0];
/// So few base segments has a piece at least: nine nodes, and more than one place for them.
const LEAST: usize = 5;
/// Roots closer to an end than this, in distances of nodes, are at the end: the joint rests there within rounding.
const AT_END: f64 = 1e-10;

/// Base segments of each piece, and whether the end effector is limited.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout<T> {
    density: T,
    /// Of slides: per metre.
    slide: T,
    tool: Option<ToolLimit<T>>,
}

impl<T: RealField + Copy> Layout<T> {
    /// How many base segments the piece has.
    pub(super) fn segments<R: PathDynamics<N, Real = T>, const N: usize>(&self, robot: &R, piece: &Piece<T, N>) -> usize {
        let motion = robot.link_bounds().iter().enumerate().fold(T::zero(), |sum, (joint, link)| {
            let rate = polynomial::largest(&polynomial::derivative(&piece.joint(joint)), piece.length) * piece.length;
            sum + if link.slides { rate * self.slide } else { rate }
        });
        let many = to_f64(motion * self.density).unwrap_or(f64::INFINITY);
        // From a float to an integer `as` saturates; more than any memory is as good as infinitely many.
        (libm_ceil(many).min(1e9) as usize).max(LEAST)
    }
}

/// The next integer, without the standard library.
fn libm_ceil(x: f64) -> f64 {
    let below = if x < 1e15 { x as i64 as f64 } else { x };
    if below < x {
        below + 1.0
    } else {
        below
    }
}

/// Evaluates the arm at the nodes and fills in the base segments; how many there are.
pub(super) fn build<T: RealField + Copy, R: PathDynamics<N, Real = T>, const N: usize>(
    robot: &R,
    pieces: &[Piece<T, N>],
    nodes: &mut [Node<T, N>],
    segments: &mut [Segment<T, N>],
    interpolation: &Interpolation<T>,
    tool: Option<&ToolLimit<T>>,
) -> Result<(Layout<T>, usize), TimingError> {
    let links = robot.link_bounds();
    let reach = links.iter().fold(T::zero(), |sum, link| {
        sum + link.distance + if link.mass > T::zero() { link.first_moment / link.mass } else { T::zero() }
    });
    let slide = if reach > T::zero() { T::one() / reach } else { T::zero() };
    let room = segments.len().saturating_sub(1);
    let at_start = |fault| TimingError { s: pieces.first().map_or(f64::NAN, |p| number(p.start)), piece: 0, fault };
    let mut layout = Layout { density: lit(DENSITIES[0]), slide, tool: tool.copied() };
    let (mut total, mut all_nodes) = (0, 0);
    for (density, share) in DENSITIES.iter().zip([2, 1]) {
        layout.density = lit(*density);
        (total, all_nodes) = (0, 0);
        for piece in pieces {
            let n = layout.segments(robot, piece);
            total += n;
            all_nodes += 2 * n + 1;
        }
        if total * share <= room && all_nodes <= nodes.len() {
            break;
        }
    }
    if total > room || all_nodes > nodes.len() {
        return Err(at_start(TimingFault::TooCoarse { segments: total.saturating_mul(2) }));
    }
    let (mut first, mut count) = (0, 0);
    for (index, piece) in pieces.iter().enumerate() {
        let n = layout.segments(robot, piece);
        let distance = piece.length / lit((2 * n) as f64);
        for (i, node) in nodes.iter_mut().skip(first).take(2 * n + 1).enumerate() {
            let point = piece.at(piece.start + distance * lit(i as f64));
            let torques = robot.path_dynamics(&point.q, &point.slope, &point.curvature);
            let is_finite = [&torques.inertial, &torques.velocity, &torques.gravity].into_iter().all(crate::linalg::is_finite);
            if !is_finite {
                let s = number(piece.start + distance * lit(i as f64));
                return Err(TimingError { s, piece: index, fault: TimingFault::NotFinite });
            }
            let tool = tool.map_or([T::zero(); 2], |_| {
                let rate = robot.tool_rate(&point.q, &point.slope);
                [rate.x * rate.x + rate.y * rate.y + rate.z * rate.z, rate.w * rate.w + rate.a * rate.a + rate.b * rate.b]
            });
            *node = Node::new(torques, tool);
        }
        let bounds = majorant::bounds(links, robot.gravity_length(), tool, piece);
        let source = Source { piece, nodes, distance, bounds: &bounds, with_tool: tool.is_some(), interpolation };
        let roots = roots(robot, piece, distance);
        let boundary = |i: usize| {
            let place: T = lit((2 * i) as f64);
            if i == 0 || i == n {
                return place;
            }
            let near = |root: &&T| (**root - place).abs() < lit(OVER * 0.5);
            roots.iter().flatten().flatten().find(near).copied().unwrap_or(place)
        };
        for i in 0..n {
            let (mut left, right) = (boundary(i), boundary(i + 1));
            let base: T = lit((2 * i) as f64);
            // The window of nine nodes around the middle, inside the piece.
            let window = (2 * i + 1).saturating_sub(NINE / 2).min(2 * n + 1 - NINE);
            loop {
                let inside = |root: &T| *root > left + lit(AT_END) && *root < right - lit(AT_END);
                let cut = roots.iter().flatten().flatten().copied().filter(inside).fold(right, |least, root| least.min(root));
                let Some(segment) = segments.get_mut(count).filter(|_| count < room) else {
                    return Err(at_start(TimingFault::TooCoarse { segments: total.saturating_mul(2) }));
                };
                *segment = Segment::empty();
                segment.piece = index;
                segment.node = first + 2 * i;
                segment.window = first + window;
                segment.ends = [left - base, cut - base];
                segment.stop = piece.stop && i == 0 && left == boundary(0);
                place(segment, piece, distance, base);
                source.fill(segment);
                count += 1;
                if cut >= right {
                    break;
                }
                left = cut;
            }
        }
        first += 2 * n + 1;
    }
    if let Some(end) = segments.get_mut(count) {
        *end = Segment::empty();
    }
    Ok((layout, count))
}

/// Where a segment lies in s, from its ends in distances of nodes.
fn place<T: RealField + Copy, const N: usize>(segment: &mut Segment<T, N>, piece: &Piece<T, N>, distance: T, base: T) {
    let [from, to] = segment.ends;
    segment.start = piece.start + (base + from) * distance;
    segment.length = (to - from) * distance;
}

/// Where rates of joints with friction change sign, in distances of nodes from the start of the piece.
fn roots<T: RealField + Copy, R: PathDynamics<N, Real = T>, const N: usize>(
    robot: &R,
    piece: &Piece<T, N>,
    distance: T,
) -> [[Option<T>; ORDER]; N] {
    let mut roots = [[None; ORDER]; N];
    for (joint, (of, friction)) in roots.iter_mut().zip(robot.joint_friction()).enumerate() {
        let zero = T::zero();
        if friction.is_curved() || friction.coulomb != zero || friction.load != zero {
            *of = polynomial::roots(&polynomial::derivative(&piece.joint(joint)), piece.length)
                .map(|root| root.map(|t| t / distance));
        }
    }
    roots
}

/// Halves the marked segments, from the back; how many segments there are then. There is room for them.
pub(super) fn halve<T: RealField + Copy, R: PathDynamics<N, Real = T>, const N: usize>(
    robot: &R,
    pieces: &[Piece<T, N>],
    layout: &Layout<T>,
    nodes: &[Node<T, N>],
    segments: &mut [Segment<T, N>],
    count: usize,
    interpolation: &Interpolation<T>,
) -> usize {
    let marked = segments.iter().take(count).filter(|segment| segment.split).count();
    let mut to = count + marked;
    if let Some(last) = segments.get(count).copied() {
        if let Some(end) = segments.get_mut(to) {
            *end = last;
        }
    }
    let mut first: usize = pieces.iter().map(|piece| 2 * layout.segments(robot, piece) + 1).sum();
    let mut current: Option<(usize, Bounds2<T, N>, T)> = None;
    let half: T = lit(0.5);
    for from in (0..count).rev() {
        let Some(segment) = segments.get(from).copied() else { continue };
        let Some(piece) = pieces.get(segment.piece) else { continue };
        while current.as_ref().is_none_or(|(index, ..)| *index != segment.piece) {
            let index = current.as_ref().map_or(pieces.len(), |(index, ..)| *index).saturating_sub(1);
            let Some(of) = pieces.get(index) else { break };
            let n = layout.segments(robot, of);
            first -= (2 * n + 1).min(first);
            let bounds = majorant::bounds(robot.link_bounds(), robot.gravity_length(), layout.tool.as_ref(), of);
            current = Some((index, bounds, of.length / lit((2 * n) as f64)));
        }
        let mut put = |segment: Segment<T, N>| {
            to = to.saturating_sub(1);
            if let Some(place) = segments.get_mut(to) {
                *place = segment;
            }
        };
        let Some((_, bounds, distance)) = current.as_ref().filter(|_| segment.split) else {
            put(Segment { split: false, ..segment });
            continue;
        };
        let source = Source { piece, nodes, distance: *distance, bounds, with_tool: layout.tool.is_some(), interpolation };
        let base: T = lit(segment.node.saturating_sub(first) as f64);
        let [left, right] = segment.ends;
        let middle = (left + right) * half;
        let (zero, one) = (T::zero(), T::one());
        for (ends, part) in [([middle, right], [half, one]), ([left, middle], [zero, half])] {
            let stop = segment.stop && part[0] == zero;
            let mut of = Segment { ends, stop, split: false, is_new: true, changed: true, ..segment };
            place(&mut of, piece, *distance, base);
            of.inner.law = segment.inner.law.part(part[0], part[1]);
            source.fill(&mut of);
            put(of);
        }
    }
    count + marked
}

type Bounds2<T, const N: usize> = [Bounds<T, N>; 2];
