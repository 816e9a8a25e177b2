//! Direct kinematics and geometric Jacobians, of the end effector and of every link.
//!
//! ```text
//! R_0i = R_0p R_i,   p_0i = p_0p + R_0p origin_i                                     (the book, Sect. 2.8)
//! J_Pi = z_i × (p_e - p_i), J_Oi = z_i (revolute);   J_Pi = z_i, J_Oi = 0 (prismatic)   (the book, eq. 3.30)
//! dz_i/dt = omega_i × z_i,   d(p_e - p_i)/dt = v_e - v_i
//! ```

use crate::derive::arm::Arm;
use crate::derive::passes::RewriteScope;
use crate::derive::plan::Start;
use crate::derive::quantity::{Argument, Documentation, Element, Length, Of, Quantity, Recursion, ResultPart, Typeset};
use crate::ring::matrix::{Matrix, Vector, IDENTITY, ZERO};
use crate::ring::{ExprId, Pool, Symbol};

/// In the order of the emitted module.
pub(super) static DECLARED: [&Quantity; 5] =
    [&DIRECT_KINEMATICS, &LINK_FRAMES, &GEOMETRIC_JACOBIAN, &GEOMETRIC_JACOBIAN_DOT, &LINK_JACOBIANS];

/// Where searches for their plans start: with origins as the rows have them, and at either foot of the common normals, so that costs do not depend
/// on the convention of the rows.
static STARTS: [Start; 3] = [Start::PLAIN, Start { origin: 1, ..Start::PLAIN }, Start { origin: 2, ..Start::PLAIN }];

/// T_e(q).
pub static DIRECT_KINEMATICS: Quantity = Quantity {
    name: "direct_kinematics",
    symbol: Typeset::plain("T_e(q)"),
    arguments: &[Argument::Q],
    result: &[ResultPart::whole(Typeset::plain("T_e(q)"), Typeset::plain("t"), &[Length::Fixed(4), Length::Fixed(4)], "1, m")],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "End-effector frame in the base frame, T_e(q).",
        "T_e = A_1(q_1) ... A_n(q_n) T_tool                                (Siciliano et al., Sect. 2.8)",
        "the 4 x 4 homogeneous transformation `t[row][column]`: the columns of the rotation are the axes of the end-effector frame in the base \
         frame, the last column is its origin in m.",
    ),
    recursion: Recursion { starts: &STARTS, of: Of::EndEffector, ..Recursion::new(RewriteScope::Frames, |pool, arm, _, _| direct_kinematics(pool, arm).concat()) },
    missing: Quantity::NEVER_MISSING,
    gathers: &[],
    interface: Some("Kinematics"),
};

/// T_i(q) of every link.
pub static LINK_FRAMES: Quantity = Quantity {
    name: "link_frames",
    symbol: Typeset::plain("T_i(q)"),
    arguments: &[Argument::Q],
    result: &[ResultPart {
        element: Some(Element { name: "link_frame", letter: "T" }),
        ..ResultPart::whole(Typeset::plain("T_i(q)"), Typeset::plain("t"), &[Length::Joints, Length::Fixed(4), Length::Fixed(4)], "1, m")
    }],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Frame of every link in the base frame, T_i(q).",
        "T_i = A_1(q_1) ... A_i(q_i)                                       (Siciliano et al., Sect. 2.8)",
        "a 4 x 4 homogeneous transformation for each link, `t[link][row][column]`, the frames as the description's convention defines them; \
         translations in m.",
    ),
    recursion: Recursion { starts: &STARTS, ..Recursion::new(RewriteScope::Frames, |pool, arm, _, _| link_frames(pool, arm).concat().concat()) },
    missing: Quantity::NEVER_MISSING,
    gathers: &[],
    interface: Some("Kinematics"),
};

/// J(q).
pub static GEOMETRIC_JACOBIAN: Quantity = Quantity {
    name: "geometric_jacobian",
    symbol: Typeset::plain("J(q)"),
    arguments: &[Argument::Q],
    result: &[ResultPart::whole(
        Typeset::plain("J(q)"),
        Typeset::plain("j"),
        &[Length::Fixed(6), Length::Dof],
        "m or 1 above, 1 below",
    )],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Geometric Jacobian J(q) of the end effector, in the base frame.",
        "(v_e, omega_e) = J(q) dq                                          (Siciliano et al., Sect. 3.1)",
        "`j[row][joint]`, 6 rows: three linear (velocity of the end-effector frame's origin, m/s), then three angular (rad/s).",
    ),
    recursion: Recursion {
        starts: &STARTS,
        of: Of::EndEffector,
        ..Recursion::new(RewriteScope::Frames, |pool, arm, _, _| geometric_jacobian(pool, arm).concat())
    },
    missing: Quantity::NEVER_MISSING,
    gathers: &[],
    interface: Some("Kinematics"),
};

/// dJ/dt(q, dq).
pub static GEOMETRIC_JACOBIAN_DOT: Quantity = Quantity {
    name: "geometric_jacobian_dot",
    symbol: Typeset::new("dJ/dt(q, dq)", "\\dot J(q, \\dot q)"),
    arguments: &[Argument::Q, Argument::Dq],
    result: &[ResultPart::whole(
        Typeset::new("dJ/dt(q, dq)", "\\dot J(q, \\dot q)"),
        Typeset::new("dj", "\\dot j"),
        &[Length::Fixed(6), Length::Dof],
        "as J, per s",
    )],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Time derivative of the geometric Jacobian along dq.",
        "d/dt (v_e, omega_e) = J ddq + (dJ/dt) dq",
        "`j[row][joint]`, 6 rows: three linear, then three angular, in the base frame.",
    ),
    recursion: Recursion {
        starts: &STARTS,
        of: Of::EndEffector,
        ..Recursion::new(RewriteScope::Frames, |pool, arm, _, _| geometric_jacobian_dot(pool, arm).concat())
    },
    missing: Quantity::NEVER_MISSING,
    gathers: &[],
    interface: Some("Kinematics"),
};

/// J_i(q) of every link.
pub static LINK_JACOBIANS: Quantity = Quantity {
    name: "link_jacobians",
    symbol: Typeset::plain("J_i(q)"),
    arguments: &[Argument::Q],
    result: &[ResultPart {
        element: Some(Element { name: "link_jacobian", letter: "J" }),
        ..ResultPart::whole(
            Typeset::plain("J_i(q)"),
            Typeset::plain("j"),
            &[Length::Joints, Length::Fixed(6), Length::Dof],
            "m or 1 above, 1 below",
        )
    }],
    structure: None,
    has_parameters: false,
    documentation: Documentation::new(
        "Geometric Jacobian J_i(q) of the origin of every link frame, in the base frame.",
        "(v_i, omega_i) = J_i(q) dq                                        (Siciliano et al., Sect. 3.1)",
        "`j[link][row][joint]`, 6 rows each: three linear (velocity of the origin of the frame that {link_frames} gives, m/s), then three \
         angular (rad/s). Joints beyond a link have columns of zeros.",
    ),
    recursion: Recursion { starts: &STARTS, ..Recursion::new(RewriteScope::Frames, |pool, arm, _, _| link_jacobians(pool, arm).concat().concat()) },
    missing: Quantity::NEVER_MISSING,
    gathers: &[],
    interface: Some("LinkJacobians"),
};

/// Frames in the base frame.
#[derive(Clone, Debug)]
pub struct Frames {
    /// Joint frames: rotation and origin.
    pub joints: Vec<(Matrix, Vector)>,
}

/// Joint frames of all links.
pub fn frames(pool: &mut Pool, arm: &Arm) -> Frames {
    let mut joints: Vec<(Matrix, Vector)> = Vec::with_capacity(arm.dof());
    for joint in &arm.joints {
        let (outer, base) = joint.parent.map_or((IDENTITY, ZERO), |p| joints[p]);
        let rotation = joint.rotation(pool);
        let shift = pool.transform(&outer, &joint.origin);
        let frame = (pool.product(&outer, &rotation), pool.add_vectors(&base, &shift));
        joints.push(frame);
    }
    Frames { joints }
}

/// A frame fixed in joint frame i, in the base frame.
fn fixed_in(pool: &mut Pool, frame: &(Matrix, Vector), rotation: &Matrix, origin: &Vector) -> (Matrix, Vector) {
    let shift = pool.transform(&frame.0, origin);
    (pool.product(&frame.0, rotation), pool.add_vectors(&frame.1, &shift))
}

fn homogeneous((rotation, origin): &(Matrix, Vector)) -> Vec<Vec<ExprId>> {
    let mut rows: Vec<Vec<ExprId>> = (0..3).map(|i| [rotation[i].to_vec(), vec![origin[i]]].concat()).collect();
    rows.push(vec![ExprId::ZERO, ExprId::ZERO, ExprId::ZERO, ExprId::ONE]);
    rows
}

/// T_e(q).
pub fn direct_kinematics(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let frames = frames(pool, arm);
    homogeneous(&fixed_in(pool, &frames.joints[arm.tool.link], &arm.tool.rotation, &arm.tool.origin))
}

/// T_i(q) of every link frame.
pub fn link_frames(pool: &mut Pool, arm: &Arm) -> Vec<Vec<Vec<ExprId>>> {
    let frames = frames(pool, arm);
    (0..arm.dof())
        .map(|i| {
            let joint = &arm.joints[i];
            homogeneous(&fixed_in(pool, &frames.joints[i], &joint.link_rotation, &joint.link_origin))
        })
        .collect()
}

fn z(frame: &(Matrix, Vector)) -> Vector {
    [0, 1, 2].map(|row| frame.0[row][2])
}

/// J(q): six rows, linear then angular.
pub fn geometric_jacobian(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let frames = frames(pool, arm);
    jacobian_of_point(pool, arm, &frames, arm.tool.link, &arm.tool.origin)
}

/// The geometric Jacobian of a point fixed in joint frame `link`: six rows, linear then angular.
fn jacobian_of_point(pool: &mut Pool, arm: &Arm, frames: &Frames, link: usize, point: &Vector) -> Vec<Vec<ExprId>> {
    let shift = pool.transform(&frames.joints[link].0, point);
    let end = pool.add_vectors(&frames.joints[link].1, &shift);
    let mut jacobian = vec![vec![ExprId::ZERO; arm.dof()]; 6];
    for i in arm.path_to(link) {
        let axis = z(&frames.joints[i]);
        if arm.joints[i].is_revolute() {
            let arm_to_end = pool.sub_vectors(&end, &frames.joints[i].1);
            let linear = pool.cross(&axis, &arm_to_end);
            set_column(&mut jacobian, i, &linear, &axis);
        } else {
            set_column(&mut jacobian, i, &axis, &ZERO);
        }
    }
    jacobian
}

/// J_i(q) of the origin of every link frame: six rows each, linear then angular.
pub fn link_jacobians(pool: &mut Pool, arm: &Arm) -> Vec<Vec<Vec<ExprId>>> {
    let frames = frames(pool, arm);
    let links = arm.joints.iter().enumerate();
    links.map(|(i, joint)| jacobian_of_point(pool, arm, &frames, i, &joint.link_origin)).collect()
}

fn set_column(jacobian: &mut [Vec<ExprId>], column: usize, linear: &Vector, angular: &Vector) {
    for row in 0..3 {
        jacobian[row][column] = linear[row];
        jacobian[row + 3][column] = angular[row];
    }
}

/// dJ/dt(q, dq): six rows, linear then angular.
pub fn geometric_jacobian_dot(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let frames = frames(pool, arm);
    let rates = arm.symbols(pool, Symbol::Rate);
    let path = arm.path_to(arm.tool.link);
    let shift = pool.transform(&frames.joints[arm.tool.link].0, &arm.tool.origin);
    let end = pool.add_vectors(&frames.joints[arm.tool.link].1, &shift);
    // Angular velocity of each link on the path and rate of each axis, from the base; linear velocity of the end effector relative to each joint's
    // origin, from the tip down.
    let (mut omega, mut axis_rates) = (vec![ZERO; arm.dof()], vec![ZERO; arm.dof()]);
    let mut before = ZERO;
    for &i in &path {
        // The axis is fixed to the link before it, too, whose motion does not include the joint's own rate.
        axis_rates[i] = pool.cross(&before, &z(&frames.joints[i]));
        let spin = if arm.joints[i].is_revolute() { pool.scale(rates[i], &z(&frames.joints[i])) } else { ZERO };
        omega[i] = pool.add_vectors(&before, &spin);
        before = omega[i];
    }
    let mut jacobian = vec![vec![ExprId::ZERO; arm.dof()]; 6];
    let mut outer: Option<usize> = None;
    let mut velocity = ZERO;
    for &i in path.iter().rev() {
        // v_e - v_i grows by what link i carries: omega_i × (to the next origin), and the next joint's slide.
        let next = outer.map_or(end, |k| frames.joints[k].1);
        let reach = pool.sub_vectors(&next, &frames.joints[i].1);
        let carried = pool.cross(&omega[i], &reach);
        velocity = pool.add_vectors(&velocity, &carried);
        if let Some(k) = outer.filter(|&k| !arm.joints[k].is_revolute()) {
            let slide = pool.scale(rates[k], &z(&frames.joints[k]));
            velocity = pool.add_vectors(&velocity, &slide);
        }
        let axis = z(&frames.joints[i]);
        let axis_rate = axis_rates[i];
        if arm.joints[i].is_revolute() {
            let to_end = pool.sub_vectors(&end, &frames.joints[i].1);
            let (turning, moving) = (pool.cross(&axis_rate, &to_end), pool.cross(&axis, &velocity));
            let linear = pool.add_vectors(&turning, &moving);
            set_column(&mut jacobian, i, &linear, &axis_rate);
        } else {
            set_column(&mut jacobian, i, &axis_rate, &ZERO);
        }
        outer = Some(i);
    }
    jacobian
}
