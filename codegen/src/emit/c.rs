//! The C interface of a module: a header, and `extern "C"` wrappers in Rust next to the module's functions.
//!
//! A C caller sees `ROBOT_function`, arrays by rows as in the module, constant where they are arguments, and the result as the
//! last argument; a single number is returned. The header with the functions themselves (`standalone`) has the same declarations.

mod batch;
mod bindings;
mod from_rust;
mod header;
mod inverse_kinematics;
mod kernels;
mod laws;
mod solver;
mod standalone;
mod syntax;

use self::header::macro_of;
#[doc(hidden)]
pub use self::header::{base_parameters_comment, function_comment, parameters_comment};
pub use self::inverse_kinematics::print_inverse_kinematics;
pub use self::laws::print as print_laws;
pub use self::solver::{print as print_solver, print_test as print_solver_test};
use super::{Language, Notes, Origin};
use crate::catalogue::Quantity;
use crate::program::Module;

/// The two texts of the C interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CFace {
    /// The header: `robot.h` for a module in `robot.rs`.
    pub header: String,
    /// The wrappers: `robot_c.rs`, to be included next to the functions of the module.
    pub wrappers: String,
}

/// The C interface of a module.
pub fn print(module: &Module, origin: &Origin) -> CFace {
    CFace { header: header::header(module, origin), wrappers: bindings::wrappers(module, origin) }
}

/// The module in C alone: a header of functions that needs at most `math.h`; in CUDA with kernels, too.
pub fn standalone(module: &Module, language: Language, origin: &Origin, notes: &Notes) -> String {
    standalone::print(module, language, origin, notes)
}

/// The functions for many states as the source of a library, each exported as `armgen_` and its name.
pub fn library(module: &Module, origin: &Origin, lanes: usize) -> String {
    standalone::library(module, origin, lanes)
}

/// Whether a function returns its result, a single number, instead of writing it where its last arguments point.
fn returns_a_number(quantity: &Quantity) -> bool {
    matches!(quantity.result, [part] if part.lengths.is_empty())
}

/// The robot's name as the beginning of C's names: letters that C may not have are spelled out.
fn prefix(module: &Module) -> String {
    spelled(&module.name)
}

/// A name with its letters that C may not have spelled out.
#[doc(hidden)]
pub fn spelled(name: &str) -> String {
    let spelled = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c.to_string() } else { format!("u{:04x}", u32::from(c)) };
    name.chars().map(spelled).collect()
}
