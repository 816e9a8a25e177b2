//! Time-optimal motion on a joint path, with proof.
//!
//! A path q(s) in pieces, s(t) to be found: with x = ds², u = dds and ' = d/ds,
//!
//! ```text
//! dq = q' sqrt(x),  ddq = q' u + q'' x,  x' = 2 u
//! tau = m u + c x + v sqrt(x) + d,   m = B q',  c = B q'' + C(q, q') q',  v = F_v q',  d = g + sign(q') (F_c + F_l |g|) + F_0
//! ```
//!
//! and of cubic and Stribeck friction sign(q') (F_3 |dq|³ + F_s exp(-|dq|/v_s)), whose chords and tangents over x are rows like these.
//!
//! [`time_optimal`] gives a motion that keeps limits of torque, acceleration and speed on all of the path, between nodes, too, and the time
//! that no motion on this path can beat. Among all absolutely continuous x(s) >= 0 with given ends that never go back it is the fastest, up
//! to the gap. (Bobrow, Dubowsky, Gibson, *IJRR* 4(3), 1985; Pham, Pham, *IEEE T-RO* 34, 2018; Consolini et al., *Automatica*, 2019.)
//!
//! Storage is the caller's. The page `docs/timing.md` explains the method.

mod curve;
mod fault;
mod governor;
mod grid;
mod inner;
mod law;
mod limits;
mod majorant;
mod model;
mod outer;
mod path;
mod polynomial;
mod row;
mod segment;
mod solve;
mod timed;
mod trial;

pub use fault::{TimingError, TimingFault};
pub use governor::{Command, Governed, Governor, Phase};
pub use limits::{Limits, ToolLimit};
pub use model::{JointFriction, LinkBound, PathDynamics, PathModel, PathTorques};
pub use path::{JointPath, PathError, PathFault, PathPoint, Piece};
pub use segment::{Limit, Node, Segment};
pub use solve::{time_optimal, Ends, Workspace};
pub use timed::{Margins, Profile, Timing, UpperBound};
