//! From logs of an arm to the numbers of its description, with intervals and proofs.
//!
//! ```text
//! tau = Y_b(q, dq, ddq) pi_b + F(q, dq)
//! ```
//!
//! Text and streams go in, values and text come out; nothing here touches a file or a terminal.

pub mod arm;
pub mod baseline;
pub mod body;
pub mod certificate;
pub mod consistent;
pub mod estimate;
pub mod exact;
pub mod excite;
pub mod finding;
pub mod fit;
pub mod identify;
pub mod judge;
pub mod log;
pub mod options;
pub mod page;
pub mod prepare;
pub mod report;
pub mod signal;
pub mod suspect;
pub mod written;
