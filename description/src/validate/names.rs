//! Names: of the robot, of joints, of parameters.

use super::parents::BASE;
use super::FirstSeen;
use crate::description::{RobotDescription, TipDescription};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::excerpt;
use crate::source::{is_hidden, Span, Spanned};

/// Words of Rust, editions 2015 to 2024, that cannot be the name of anything there.
const KEYWORDS: [&str; 53] = [
    "Self", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod", "move",
    "mut", "override", "priv", "pub", "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type",
    "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield", "_",
];
/// Words of expressions.
const WORDS: [&str; 3] = ["pi", "deg", "sqrt"];
/// Functions of printed equations.
const FUNCTIONS: [&str; 6] = ["sin", "cos", "sign", "atan", "atan2", "acos"];
/// Joint variables, rates, accelerations and torques in printed equations, each followed by the joint's number.
const VARIABLES: [&str; 6] = ["q", "dq", "ddq", "dqr", "ddqr", "tau"];

/// Coordinates of the acceleration of free fall in printed equations, where that is an argument.
const FREE_FALL: [&str; 3] = ["g0x", "g0y", "g0z"];

/// Characters of the name of an end effector at most: MATLAB has names of 63.
const LONGEST_TIP: usize = 32;

/// Types of the module, in lower case.
const TAKEN: [&str; 2] = ["real", "equationsofmotion"];

/// What names of functions for many states begin with, in C and CUDA.
const BEGINNINGS: [&str; 3] = ["batch", "kernel", "launch"];

/// Checks every name that the file gives.
pub(super) fn check(description: &RobotDescription, diagnostics: &mut Diagnostics) {
    // The robot's name stands in the emitted text as a text and as the beginning of names: no word is reserved for it.
    if let Some(name) = description.name.as_ref().filter(|name| !KEYWORDS.contains(&name.value.as_str()) || name.value == "_") {
        check_identifier(name, "the robot", diagnostics);
    }
    for parameter in &description.parameters {
        check_name(&parameter.name, "a parameter", diagnostics);
        let name = parameter.name.value.as_str();
        if description.gravity_is_argument && FREE_FALL.contains(&name) {
            let message =
                format!("`{name}` cannot be the name of a parameter: it is a coordinate of gravity in printed equations");
            let help = format!("choose another name, such as `{name}_`");
            diagnostics.push(Diagnostic::new(Code::ReservedName, parameter.name.span, message, "reserved", help));
        }
    }
    check_tips(description.tips.as_ref().map_or(&[][..], |tips| &tips.value), diagnostics);
    let joints = || description.joints.iter().flat_map(|joints| &joints.value);
    let on_base = joints().filter_map(|joint| joint.parent.as_ref()).find(|parent| parent.value == BASE);
    let mut seen = FirstSeen::new();
    for name in joints().filter_map(|joint| joint.name.as_ref()) {
        check_name(name, "a joint", diagnostics);
        if let Some(parent) = on_base.filter(|_| name.value == BASE) {
            let message = "`base` cannot be the name of a joint here: it is the base where `parent` names it";
            let help = format!("choose another name, such as `{BASE}_`");
            let fault = Diagnostic::new(Code::ReservedName, name.span, message, "reserved", help);
            diagnostics.push(fault.also(parent.span, "on the base"));
        }
        if let Some(first) = seen.get(name.value.as_str()) {
            let message = format!("two joints are called `{}`", excerpt(&name.value));
            let help = "give each joint a name of its own: messages and tables call it by that name";
            diagnostics.push(
                Diagnostic::new(Code::DuplicateName, name.span, message, "the second one", help).also(*first, "the first one"),
            );
        } else {
            seen.insert(&name.value, name.span);
        }
    }
}

/// Names of functions, constants and types of an end effector begin with its name: those of two must differ, whatever the style.
fn check_tips(tips: &[TipDescription], diagnostics: &mut Diagnostics) {
    let plain = |name: &str| name.to_lowercase().replace('_', "");
    let mut seen: Vec<(&str, Span)> = Vec::new();
    for name in tips.iter().filter_map(|tip| tip.name.as_ref()) {
        let (own, shown) = (name.value.as_str(), excerpt(&name.value));
        check_identifier(name, "an end effector", diagnostics);
        if !own.starts_with(|c: char| c.is_ascii_alphabetic()) || !own.is_ascii() || own.len() > LONGEST_TIP {
            let message = format!("`{shown}` cannot be the name of an end effector: not every language can begin a name with it");
            let help = format!("use a letter, then letters, digits and `_` of ASCII, at most {LONGEST_TIP}: `left`");
            if is_rust_name(own) {
                diagnostics.push(Diagnostic::new(Code::BadName, name.span, message, "not in every language", help));
            }
            continue;
        }
        let begins = BEGINNINGS.iter().any(|word| own.to_lowercase().starts_with(word));
        if begins || TAKEN.contains(&plain(own).as_str()) {
            let message = format!(
                "`{shown}` cannot be the name of an end effector: names that it makes are those of other parts of the module"
            );
            let help = match begins {
                true => "choose a name that begins with another word, such as `left`".to_owned(),
                false => format!("choose another name, such as `{own}_tip`"),
            };
            diagnostics.push(Diagnostic::new(Code::NameTaken, name.span, message, "taken", help));
        }
        // Types of a robot in the interface of the runtime end so.
        let all = |name: &str| ["", "withparameters", "mounted"].map(|end| plain(name) + end);
        let clash = seen.iter().find(|(other, _)| all(other).iter().any(|one| all(own).contains(one)));
        if let Some((other, first)) = clash {
            let (code, message) = match *other == own {
                true => (Code::DuplicateTip, format!("two end effectors are called `{shown}`")),
                false => {
                    (Code::NameTaken, format!("names of `{shown}` and of `{}` in the module would be the same", excerpt(other)))
                }
            };
            let help = "give each end effector a name of its own; upper case and `_` do not tell names apart";
            diagnostics.push(Diagnostic::new(code, name.span, message, "the second one", help).also(*first, "the first one"));
        }
        seen.push((own, name.span));
    }
}

fn check_name(name: &Spanned<String>, what: &str, diagnostics: &mut Diagnostics) {
    let shown = excerpt(&name.value);
    if let Some(meaning) = reserved(&name.value) {
        let message = format!("`{shown}` cannot be the name of {what}: it is {meaning}");
        let help = match name.value.trim_matches('_').to_lowercase() {
            word if word.is_empty() => "choose a name that begins with a letter".to_owned(),
            word if what == "a parameter" && word.starts_with('q') => {
                format!("leave it out: joint variables are added to `theta` and `d` by themselves; of something else the name could be `{word}_`")
            }
            word => format!("choose another name, such as `{word}_`"),
        };
        diagnostics.push(Diagnostic::new(Code::ReservedName, name.span, message, "reserved", help));
    } else {
        check_identifier(name, what, diagnostics);
    }
}

fn check_identifier(name: &Spanned<String>, what: &str, diagnostics: &mut Diagnostics) {
    let shown = excerpt(&name.value);
    if !is_rust_name(&name.value) {
        let reason = match name.value.chars().find(|c| is_hidden(*c)) {
            Some(hidden) => format!("it has the character U+{:04X}, which cannot be seen", u32::from(hidden)),
            None => "it is not an identifier".to_owned(),
        };
        let message = format!("`{shown}` cannot be the name of {what}: {reason}");
        let help = match suggestion(&name.value) {
            Some(better) => format!("use letters, digits and `_`, a letter first: `{better}`"),
            None => "use letters, digits and `_`, a letter first".into(),
        };
        diagnostics.push(Diagnostic::new(Code::BadName, name.span, message, "not an identifier", help));
    }
}

/// The existing meaning of a reserved name.
fn reserved(name: &str) -> Option<&'static str> {
    if KEYWORDS.contains(&name) {
        return Some(if name == "_" { "a placeholder of Rust" } else { "a keyword of Rust" });
    }
    if WORDS.contains(&name) {
        return Some("a word of expressions");
    }
    if FUNCTIONS.contains(&name) {
        return Some("a function of the equations");
    }
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    // Joints are counted from 1.
    let number = &name[letters.len()..];
    let variable = VARIABLES.contains(&letters) && !number.is_empty() && !number.starts_with('0');
    variable.then_some("a variable of the equations")
}

/// Whether a text can be the name of an item of Rust as it stands.
pub fn is_rust_name(name: &str) -> bool {
    // The raw `r#fn` is an identifier too, but no word of an expression.
    !name.contains(|c| c == '#' || is_hidden(c))
        && !KEYWORDS.contains(&name)
        && syn::parse_str::<syn::Ident>(name).is_ok_and(|ident| ident == name)
}

/// The name of the module of Rust for a file with this stem.
pub fn module_name(stem: &str) -> String {
    // No keyword begins and ends so, whatever the letter between.
    let fits = |c: &char| is_rust_name(&format!("x{c}x"));
    let name: String = stem.chars().map(|c| if fits(&c) { c } else { '_' }).collect();
    // A digit in front, or a keyword.
    let others = [format!("_{name}"), format!("{name}_")];
    [name].into_iter().chain(others).find(|name| is_rust_name(name)).unwrap_or_else(|| "robot".into())
}

/// Whether a joint or a parameter may be called so.
pub fn is_free_name(name: &str) -> bool {
    is_rust_name(name) && reserved(name).is_none()
}

/// The name with everything replaced that an identifier cannot have.
fn suggestion(name: &str) -> Option<String> {
    let fits = |c: char| c == '_' || c.is_ascii_alphanumeric();
    let mut better: String = name.trim_matches(|c| !fits(c)).chars().take(40).map(|c| if fits(c) { c } else { '_' }).collect();
    if better.starts_with(|c: char| c.is_ascii_digit()) {
        better.insert(0, 'r');
    }
    (is_rust_name(&better) && reserved(&better).is_none()).then_some(better)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(name: &str, free: bool) {
        assert_eq!(reserved(name).is_none() && is_rust_name(name), free, "{name}");
    }

    #[test]
    fn modules_are_named_after_their_files() {
        for (stem, name) in [("scara", "scara"), ("my-robot.v2", "my_robot_v2"), ("2r", "_2r"), ("fn", "_fn"), ("", "robot")] {
            assert_eq!(module_name(stem), name);
        }
    }

    #[test]
    fn keywords_words_of_expressions_and_joint_variables_are_reserved() {
        for name in [
            "fn", "self", "Self", "gen", "try", "async", "pi", "deg", "sqrt", "sin", "sign", "q1", "dq12", "ddq3", "dqr1",
            "ddqr70", "tau2", "_",
        ] {
            check(name, false);
        }
        for name in ["q", "q0", "dq", "q1a", "m1", "qr1", "Pi", "tau", "sine", "_x", "union", "raw", "r\u{e4}der", "I1", "mcx1"] {
            check(name, true);
        }
        for name in ["", "1a", "a b", "a-b", "a.b", "r#fn", "a\u{2019}", "j\u{115f}", "j\u{34f}", "a\u{fe0f}"] {
            check(name, false);
        }
    }
}
