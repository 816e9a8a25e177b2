//! Building blocks that give **all** real solutions of a serial arm's inverse kinematics.
//!
//! `no_std`, no allocation, no panic, no `unsafe`; the scalar functions are those of `libm`, and nothing is fused, so a call gives the same
//! bits on every machine.
//! Each block is one file of plain Rust over an alias `Real`. This crate compiles every block for both scalars ([`f64`](mod@f64) and [`f32`](mod@f32)) and
//! tests it there; a generator takes the same files as text ([`texts`]) into a module of its own.

#![no_std]

pub mod texts;

macro_rules! blocks {
    ($scalar:literal) => {
        include!(concat!("blocks/scalar_", $scalar, ".rs"));
        include!("blocks/frame.rs");
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
        include!("blocks/determinant.rs");
        include!("blocks/arrangement.rs");
        include!("blocks/general.rs");
    };
}

/// The blocks in double precision.
#[allow(clippy::approx_constant, clippy::excessive_precision, clippy::neg_cmp_op_on_partial_ord)]
pub mod f64 {
    blocks!("f64");
}

/// The blocks in single precision.
#[allow(clippy::approx_constant, clippy::excessive_precision, clippy::neg_cmp_op_on_partial_ord)]
pub mod f32 {
    blocks!("f32");
}
