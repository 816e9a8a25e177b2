//! Time-optimal motion on a joint path, with arguments that the optimiser knows nothing of.

use super::runtime::{keep, number, numbers, vector};
use armgen_runtime::{
    nalgebra::RealField,
    robot::Dynamics,
    timing::{
        time_optimal, Command, Ends, Governor, JointFriction, JointPath, Limit, Limits, LinkBound, Node, PathDynamics, PathModel,
        Piece, Segment, Timing, ToolLimit, Workspace,
    },
};
use core::{hint::black_box, time::Duration};

/// Times a path of two pieces and asks for everything that is known of the motion.
#[inline(never)]
pub(crate) fn every_timing<R: Dynamics<N>, const N: usize>(robot: &R) {
    let friction = JointFriction {
        viscous: number(),
        coulomb: number(),
        offset: number(),
        load: number(),
        cubic: number(),
        stribeck: number(),
        stribeck_velocity: number(),
    };
    let link = LinkBound {
        parent: black_box(None),
        slides: black_box(false),
        distance: number(),
        mass: number(),
        first_moment: number(),
        inertia: number(),
        coupling: number(),
        reflected: number(),
    };
    let model = PathModel { robot, friction: [friction; N], links: [link; N], gravity: number() };
    let point = PathDynamics::path_dynamics(&model, &vector(), &vector(), &vector());
    keep((
        point,
        PathDynamics::tool_rate(&model, &vector(), &vector()),
        *PathDynamics::joint_friction(&model),
        *PathDynamics::link_bounds(&model),
        PathDynamics::gravity_length(&model),
    ));
    let piece = black_box(Piece::<R::Real, N>::line(number(), number(), numbers(), numbers()));
    keep((
        Piece::end(&piece),
        Piece::at(&piece, number()),
        Piece::extremes(&piece, black_box(1)),
        Piece::reversed(&piece, number()),
    ));
    let piece = black_box(Piece { speed: number(), ..Piece::new(piece.start, piece.length, piece.coefficients) });
    let Ok(path) = JointPath::new([piece; 2]) else { return };
    keep(JointPath::pieces(&path).len());
    let Ok(limits) = Limits::velocity(numbers()) else { return };
    let Ok(limits) = Limits::with_acceleration(limits, numbers()) else { return };
    let Ok(limits) = Limits::with_effort(limits, numbers(), numbers()) else { return };
    let tool = ToolLimit { speed: number(), turn_rate: number(), joint: black_box(3), distance: number() };
    let Ok(limits) = Limits::with_tool(limits, tool) else { return };
    let (mut nodes, mut segments) = ([Node::empty(); 42], [Segment::empty(); 24]);
    let work = Workspace { nodes: black_box(&mut nodes[..]), segments: black_box(&mut segments[..]) };
    let ends = Ends { speed: numbers(), ..black_box(Ends::at_rest()) };
    match time_optimal(&model, &path, &limits, ends, number(), work) {
        Ok(timing) => results(&timing),
        Err(error) => keep((error.s, error.piece)),
    }
}

fn results<T: RealField + Copy, const N: usize>(timing: &Timing<'_, T, N>) {
    keep((
        Timing::duration(timing),
        Timing::seconds(timing),
        Timing::lower_bound(timing),
        Timing::gap(timing),
        Timing::segments(timing),
    ));
    keep(Timing::at(timing, black_box(3), number()));
    keep((
        Timing::profile(timing, black_box(3)),
        Timing::upper_bound(timing, black_box(3)),
        Timing::barriers(timing, black_box(3)),
    ));
    let at = Timing::progress(timing, black_box(Duration::from_millis(7)));
    keep((Timing::reference(timing, &at), Timing::sample(timing, black_box(Duration::from_millis(7)))));
    keep((Timing::enclosure(timing, black_box(3), number()), Timing::margins(timing)));
    keep(Timing::binding(timing, black_box(3)).map(|(limit, joint, share)| (Limit::name(limit).len(), joint, share)));
    let mut storage = [[number(); 2]; 24];
    let mut other = [[number(); 2]; 24];
    let from_rest = Governor::from_rest(timing, black_box(&mut other[..]), number());
    for governor in [Governor::new(timing, black_box(&mut storage[..])), from_rest] {
        let Some(mut governor) = governor else { continue };
        keep((Governor::sample(&governor), Governor::reachable(&governor, black_box(3))));
        for command in black_box([Command::Override(number()), Command::Stop]) {
            keep(Governor::advance(&mut governor, black_box(Duration::from_millis(7)), command));
        }
    }
}
