//! Equations by name, as `armgen show` finds them.

use armgen_codegen::inverse_kinematics::Solved;
use armgen_codegen::show::{Form, Item};
use armgen_codegen::suggest::function_meant;
use armgen_codegen::Model;

/// Arms of so many joints have closed forms that a person reads.
const FEW_JOINTS: usize = 4;

/// The form of an arm's equations unless another is asked for.
pub fn usual_form(model: &Model) -> Form {
    if model.manipulator.dof() <= FEW_JOINTS {
        Form::Closed
    } else {
        Form::Shortest
    }
}

/// Not a quantity but a procedure: its class and its steps.
pub const INVERSE_KINEMATICS: &str = "inverse_kinematics";

/// The class of an arm's inverse kinematics and its steps, of each end effector.
pub fn steps_of_inverse_kinematics(model: &Model) -> String {
    Solved::all(&model.manipulator).iter().map(Solved::text).collect::<Vec<_>>().join("\n")
}

/// The same by a name: of all end effectors, or `left_inverse_kinematics` of one. `None` of another name.
pub fn steps_of(model: &Model, name: &str) -> Option<String> {
    let tips = &model.manipulator.tips;
    let tip = tips.iter().position(|tip| name == tip.prefix() + INVERSE_KINEMATICS);
    let all = || (name == INVERSE_KINEMATICS).then(|| steps_of_inverse_kinematics(model));
    tip.map(|tip| Solved::at(&model.manipulator, tip).text()).or_else(all)
}

/// The items of names, all if there are none.
///
/// # Errors
/// A name that no quantity has, with the nearest.
pub fn items(model: &Model, quantities: &[String]) -> Result<Vec<Item>, String> {
    let tips = &model.manipulator.tips;
    if quantities.is_empty() {
        return Ok(Item::all(tips));
    }
    let dof = model.manipulator.joints.len();
    let mut items = Vec::new();
    for name in quantities {
        let named = Item::named(name, dof, tips);
        if named.is_empty() {
            let of_tips = tips.iter().map(|tip| tip.prefix() + INVERSE_KINEMATICS);
            let names: Vec<String> =
                Item::names(tips).into_iter().chain([INVERSE_KINEMATICS.to_owned()]).chain(of_tips).collect();
            let meant = function_meant(&name.replace('-', "_"), &names.iter().map(String::as_str).collect::<Vec<_>>())
                .map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
            let known: Vec<String> = names.chunks(4).map(|names| names.join(", ")).collect();
            let lists: Vec<String> = Item::lists().iter().map(|of| format!("{of}_1 to {of}_{dof}")).collect();
            return Err(format!(
                "there is no quantity `{name}`\n  {meant}known are\n  {},\n  {}",
                known.join(",\n  "),
                lists.join(", ")
            ));
        }
        items.extend(named);
    }
    Ok(items)
}
