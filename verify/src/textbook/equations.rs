//! The equations of an arm in textbook form, for a single state, in any exact number type.
//!
//! | quantity | how | file |
//! |---|---|---|
//! | angles that functions compute | units of coordinates | [`angles`] |
//! | frames, J | products of placements; z × (p_e - p_j) | [`pose`] |
//! | B | Σ m J_P'J_P + J_O' R I R' J_O over links, load, rotors and their masses (the book, eq. 7.32) | [`lagrange`] |
//! | C | Christoffel symbols from ∂B/∂q by dual numbers (eq. 7.45) | [`lagrange`] |
//! | g, T, U | g = ∂U/∂q by dual numbers (eqs. 7.31, 7.36, 7.39) | [`lagrange`] |
//! | τ, Y | forces and moments of each body, link by link, in the base frame (Newton and Euler; Sect. 7.5) | [`newton_euler`] |
//! | q̈ | solution of B q̈ = τ - C q̇ - F - g | [`lagrange`] |
//!
//! The generator shares only the reading of the description into a
//! [`Manipulator`](armgen_description::manipulator::Manipulator): its numbers arrive as text.

pub mod angles;
pub mod arm;
pub mod lagrange;
pub mod newton_euler;
pub mod parameters;
pub mod pose;
pub mod state;
pub mod vector;
