//! Which functions of a module are wanted.

use std::collections::BTreeSet;
use std::fmt;

use crate::catalogue::{self, Absent, Quantity};
use crate::manipulator::Tip;
use crate::suggest::function_meant;

/// A choice of functions: all of them unless some are named.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection(Option<BTreeSet<String>>);

/// Names that no emitted function has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownFunctions {
    /// The names, in the order in which they were given.
    pub names: Vec<String>,
}

impl fmt::Display for UnknownFunctions {
    /// A line for each name, with similar names.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, name) in self.names.iter().enumerate() {
            write!(f, "{}{}", if i > 0 { "\n" } else { "" }, complaint(name))?;
        }
        Ok(())
    }
}

impl std::error::Error for UnknownFunctions {}

impl Selection {
    /// All functions.
    pub const ALL: Selection = Selection(None);

    /// The functions of the names.
    ///
    /// # Errors
    /// Names that no emitted function has, whatever the names of end effectors.
    pub fn named<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> Result<Selection, UnknownFunctions> {
        let names = names.into_iter().map(|name| name.as_ref().to_owned());
        let (known, unknown): (Vec<String>, Vec<String>) =
            names.partition(|name| catalogue::named(name).is_some() || catalogue::can_be_of_a_tip(name));
        if unknown.is_empty() {
            Ok(Selection(Some(known.into_iter().collect())))
        } else {
            Err(UnknownFunctions { names: unknown })
        }
    }

    /// Whether a function is wanted.
    pub fn contains(&self, quantity: &Quantity, with_parameters: bool) -> bool {
        self.0.as_ref().is_none_or(|names| names.contains(&quantity.function_name(with_parameters)))
    }

    /// The names of the functions, if some are named.
    pub fn names(&self) -> Option<impl Iterator<Item = &str>> {
        Some(self.0.as_ref()?.iter().map(String::as_str))
    }

    /// Names that no function of a robot with these named end effectors has, with the reason.
    pub fn unknown_to(&self, tips: &[Tip]) -> Vec<Absent> {
        let known: Vec<String> = catalogue::functions_of(tips).map(|(quantity, with)| quantity.function_name(with)).collect();
        let unknown = self.0.iter().flatten().filter(|name| !known.contains(name));
        let reason = |name: &str| match (tips, catalogue::named(name)) {
            ([], _) => "the end effector has no name in the description".to_owned(),
            (_, Some((quantity, _))) => {
                let names: Vec<String> = tips.iter().map(|tip| tip.prefix() + quantity.name).collect();
                format!("each end effector has its own, {}", names.join(", "))
            }
            (_, None) if known.contains(&name.to_ascii_lowercase()) => format!("it is called {}", name.to_ascii_lowercase()),
            (_, None) => {
                let names: Vec<&str> = tips.iter().map(|tip| tip.name.as_str()).collect();
                format!("the end effectors are {}", names.join(", "))
            }
        };
        unknown.map(|name| Absent { function: name.clone(), reason: reason(name) }).collect()
    }

    /// Whether all functions are wanted, because none is named.
    pub fn is_all(&self) -> bool {
        self.0.is_none()
    }
}

fn complaint(name: &str) -> String {
    let names: Vec<String> = catalogue::functions().map(|(quantity, with)| quantity.function_name(with)).collect();
    let words: Vec<&str> = names.iter().map(String::as_str).collect();
    // Not every function has a form with the parameters at run time.
    let plain = name.strip_suffix("_with").and_then(|plain| words.iter().copied().find(|&word| word == plain));
    match plain.or_else(|| function_meant(name, &words)) {
        Some(near) => format!("there is no function `{name}`: do you mean `{near}`?"),
        None => format!("there is no function `{name}`; there are {}", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::quantities::derivatives::FORWARD_DYNAMICS_DERIVATIVES;
    use crate::catalogue::quantities::gravity::GRAVITY;
    use crate::catalogue::quantities::inertia::INERTIA_MATRIX;

    #[test]
    fn names_choose_and_unknown_ones_are_answered() {
        let chosen = Selection::named(["gravity", "inertia_matrix_with"]).unwrap();
        assert!(chosen.contains(&GRAVITY, false) && chosen.contains(&INERTIA_MATRIX, true));
        assert!(!chosen.contains(&GRAVITY, true) && !chosen.contains(&INERTIA_MATRIX, false));
        assert!(Selection::ALL.contains(&FORWARD_DYNAMICS_DERIVATIVES, false));
        let complaint = |names: &[&str]| Selection::named(names).unwrap_err().to_string();
        assert_eq!(
            complaint(&["gravty", "regressor_with"]),
            "there is no function `gravty`: do you mean `gravity`?\nthere is no function `regressor_with`: do you mean `regressor`?"
        );
        assert!(complaint(&["xyzzy"]).starts_with("there is no function `xyzzy`; there are direct_kinematics, "));
        for (quantity, with) in catalogue::functions() {
            let chosen = Selection::named([quantity.function_name(with)]).unwrap();
            assert!(catalogue::functions().all(|other| chosen.contains(other.0, other.1) == (other == (quantity, with))));
        }
    }
}
