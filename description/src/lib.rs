//! From the text of a robot's description to an arm as data: the part that generator and checker share.
//!
//! | stage | from | to | can fail |
//! |---|---|---|---|
//! | parse | [`source::Source`] | [`description::RobotDescription`] | yes |
//! | validate | `RobotDescription` | [`manipulator::Manipulator`] | yes |
//!
//! No equation occurs here. The faults that only equations show come later: [`validate::structure`] keeps its diagnostics open for them.

#[doc(hidden)]
pub mod description;
pub mod diagnostic;
#[doc(hidden)]
pub mod document;
#[doc(hidden)]
pub mod kinds;
#[doc(hidden)]
pub mod language;
#[doc(hidden)]
pub mod manipulator;
#[doc(hidden)]
pub mod origin;
#[doc(hidden)]
pub mod parallel;
pub mod source;
#[doc(hidden)]
pub mod suggest;
#[doc(hidden)]
pub mod validate;

#[doc(hidden)]
pub use armgen_algebra::exact;
