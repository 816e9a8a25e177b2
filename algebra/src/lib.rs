//! The algebra that equations of motion are derived in, with no robot in it: exact numbers, polynomial expressions as a shared graph with
//! fingerprints, and their rewriting to fewer operations.
//!
//! A crate of its own since nearly all time of a derivation is spent here: it is compiled for speed where what stands on it is not.

pub mod exact;
pub mod optimise;
pub mod ring;
pub mod scramble;
