//! Building blocks that give **all** real solutions of a serial arm's inverse kinematics.
//!
//! `no_std`, no allocation, no panic, no `unsafe`; the scalar functions are those of `libm`, but for the arctangent of solutions, and
//! nothing is fused, so a call gives the same bits on every machine. Each block is one file of plain Rust over an alias `Real`. This
//! crate compiles every block for both scalars ([`f64`](mod@f64) and [`f32`](mod@f32)) and tests it there; a generator takes the same
//! files as text ([`texts`]) into a module of its own.
//!
//! # The loop
//!
//! An arm and a pose close a loop, T = C0 J1 C1 ... Jn Cn, or J1 L1 J2 L2 ... Jn Ln = 1 with Li = Ci and Ln = Cn T⁻¹ C0: the pose is in one link.
//! It can be read from any joint on and backwards ([`Arrangement`](f64::Arrangement)), so each construction is written for one order of its joints.
//! Between two revolute joints a link is brought to the form Tz(d) Tx(a) Rx(alpha); turns and slides that are left over belong to the joints.
//!
//! # What a generator provides
//!
//! For each class of arms an arrangement, whose joints come in the order of the table, and the call; everything else is computed from the
//! links. Exact tests on the description choose the class; a block trusts what its documentation asks for.
//!
//! | class | order of joints | call | at most |
//! |---|---|---|---|
//! | spherical triple | three others, then the triple; normal form of the links between revolute neighbours, d of L5 in L4 or 0 | `spherical_triple(links, kinds of 1 to 3, case of block 6)` | 8 |
//! | three parallel axes | a, the three, b, c; normal form of the two links between the three | `three_parallel(links)` | 8 |
//! | all revolute axes parallel | three joints, then a revolute one | `parallel_turns(links, kinds, case of block 6)` | 2 |
//! | three prismatic joints | any; rotations between the revolute ones about x | `three_prismatic(links, revolute places)` | 2 |
//! | two prismatic joints | first joint revolute, the pose in the link before or behind it up to the next revolute joint; rotations between the other three about x | `two_slides(links, prismatic places, length)` | 8 |
//! | general, at most one prismatic joint | joints 3 and 6 revolute; two arrangements in which the determinant neither vanishes nor has double roots at all poses | `general_arm(arrangements, t, length)` | 16 |
//! | position of three joints alone | - | the case of block 6 | 4 |
//!
//! Cases of block 6, with A = L1, B = L2, and w, p the point in the last and in the first frame; those of a loop read backwards are the
//! mirrored ones:
//!
//! | joints | test | case | at most |
//! |---|---|---|---|
//! | R R R | axes 2, 3 parallel | `regional_elbow` | 4 |
//! | | axes 1, 2 intersect | `regional_crossing` | 4 |
//! | | neither, nor axes 1, 2 parallel | `regional_general`, then `polish` | 4 |
//! | P R R | axes 2, 3 parallel, 1 not normal to them | `regional_slide_elbow` | 2 |
//! | | 1 normal to axis 2 | `regional_slide_across` | 4 |
//! | | neither | `regional_slide`, then `polish` | 4 |
//! | R P R | axes 1, 3 parallel, 2 not normal to them | `regional_mid_slide_elbow` | 2 |
//! | | 2 normal to axis 1 | `regional_mid_slide_across` | 4 |
//! | | neither | `regional_mid_slide`, then `polish` | 4 |
//! | P P R | directions not parallel | `regional_plane_then_turn` | 2 |
//! | P R P | directions not always parallel | `regional_slide_turn_slide` | 2 |
//! | P P P | directions span space | `regional_slides` | 1 |
//!
//! One joint too many: [`Given`](f64::Given) takes the first or the last joint, whose value is given, off the pose (off a position: moves the
//! point or the position), is the link between two others, and puts the joint back into solutions. Where the first three and the last three turn about axes through one point each,
//! [`shoulder_elbow_wrist`](f64::shoulder_elbow_wrist) takes the swivel angle of the elbow instead: at most 8.
//!
//! Fewer joints than a pose has rows: the construction is that of the arm with virtual joints beyond the last one, and
//! [`without_virtual_joints`](f64::without_virtual_joints) takes of its solutions, not polished, those that meet all rows.
//!
//! If the pose is in L1 or L2, only `regional_general`, `regional_slide` and `regional_mid_slide` hold for all poses.
//! [`polish`](f64::polish) takes the digits back that block R with D = 2 loses, on the six equations of a loop or the three of a position; `three_parallel` wants it where neither axes b and c nor a and c
//! intersect or are parallel.
//! [`Arrangement::of_arm`](f64::Arrangement::of_arm) puts a solution into the arm's order and takes the turned axes off.
//!
//! [`conclude`](f64::conclude) makes joint variables with a verdict of a construction's solutions in the arm's order, `by_angle` for the general
//! arm and two slides; joints beyond those of the arm are virtual and dropped. Where the pose is none ([`is_pose`](f64::is_pose)),
//! [`Postures::none`](f64::Postures::none) says so.
//! Where joints are coupled, [`in_coordinates`](f64::in_coordinates) turns postures in joint variables into postures in coordinates.
//! The text `solutions` is that for the arm of an emitted module, which says `DOF`, `MAX_SOLUTIONS`, `PRISMATIC` and `POSITION_LIMITS` before it.
//!
//! # What is near
//!
//! Every tolerance is a few units of rounding times a size that the block computes ([`ROUNDING`](f64::ROUNDING)); errors of angles are handed on
//! (`doubt`, `error`), so that a place where two solutions meet is said to be one wherever it lies in the chain.
//! `double`: two solutions meet, as far as rounding lets one tell. `free`: a joint can move while everything stays met. `near`: solutions may
//! be missing. `miss`: by how much the way that came nearest failed.

#![no_std]

pub mod texts;

macro_rules! blocks {
    ($scalar:literal) => {
        include!(concat!("blocks/scalar_", $scalar, ".rs"));
        include!("blocks/frame.rs");
        include!("blocks/angles.rs");
        include!("blocks/line_and_circle.rs");
        include!("blocks/turn.rs");
        include!("blocks/two_turns.rs");
        include!("blocks/two_links.rs");
        include!("blocks/three_turns.rs");
        include!("blocks/circle_roots.rs");
        include!("blocks/branches.rs");
        include!("blocks/regional.rs");
        include!("blocks/regional_one_prismatic.rs");
        include!("blocks/regional_prismatic.rs");
        include!("blocks/parallel_axes.rs");
        include!("blocks/spherical_triple.rs");
        include!("blocks/parallel_turns.rs");
        include!("blocks/three_prismatic.rs");
        include!("blocks/closure.rs");
        include!("blocks/samples.rs");
        include!("blocks/spread.rs");
        include!("blocks/eliminants.rs");
        include!("blocks/determinant.rs");
        include!("blocks/two_slides.rs");
        include!("blocks/arrangement.rs");
        include!("blocks/general.rs");
        include!("blocks/given.rs");
        include!("blocks/shoulder_elbow_wrist.rs");
        include!("blocks/virtual_joints.rs");
        include!("blocks/postures.rs");
        include!("blocks/coordinates.rs");
    };
}

/// The blocks in double precision.
#[allow(clippy::approx_constant, clippy::eq_op, clippy::excessive_precision, clippy::neg_cmp_op_on_partial_ord)]
pub mod f64 {
    blocks!("f64");
}

/// The blocks in single precision.
#[allow(clippy::approx_constant, clippy::eq_op, clippy::excessive_precision, clippy::neg_cmp_op_on_partial_ord)]
pub mod f32 {
    blocks!("f32");
}
