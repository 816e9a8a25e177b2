//! Laws of the runtime for C. They are wrapped, not translated: the runtime's tests, its bits and its proof that no step can panic hold for C.

use super::header::{macros_of, opening};
use super::{prefix, CFace};
use crate::emit::plain::of_robot;
use crate::emit::{head, rust, Origin};
use crate::program::Module;

/// The laws of a robot of the runtime with one end effector; `header`: the file with the declarations of its module.
pub fn print(module: &Module, origin: &Origin, header: &str) -> Option<CFace> {
    if !rust::has_dynamics(module) || !module.tips.is_empty() || module.task.is_empty() {
        return None;
    }
    let name = prefix(module);
    let upper = macros_of(&name);
    let declarations = of_robot(include_str!("laws.h"), &name, &upper);
    let wrappers = include_str!("laws.rs.txt").replace("fn robot_", &format!("fn {name}_"));
    Some(CFace {
        header: opening(head::lines(origin, &[]), &[], &format!("{upper}_LAWS"))
            + &format!("#include \"{header}\"\n\n{declarations}"),
        wrappers: rust::head(origin, &[]) + &wrappers,
    })
}
