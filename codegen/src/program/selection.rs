//! Which functions of a module are wanted.

use crate::document::did_you_mean;
use crate::equations::Quantity;

/// A choice of functions: all of them unless some are named.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Selection(Option<u64>);

fn bit(quantity: Quantity, with_parameters: bool) -> u64 {
    1 << (2 * quantity as u32 + u32::from(with_parameters))
}

impl Selection {
    /// All functions.
    pub const ALL: Selection = Selection(None);

    /// The functions of the names.
    ///
    /// Errors: names that no emitted function has, each with what comes close.
    pub fn named<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> Result<Selection, String> {
        let mut set = 0;
        let mut unknown = Vec::new();
        for name in names {
            let name = name.as_ref();
            match Selection::of(name) {
                Some(bit) => set |= bit,
                None => unknown.push(complaint(name)),
            }
        }
        match unknown.as_slice() {
            [] => Ok(Selection(Some(set))),
            _ => Err(unknown.join("\n")),
        }
    }

    fn of(name: &str) -> Option<u64> {
        let (plain, with) = name.strip_suffix("_with").map_or((name, false), |plain| (plain, true));
        let quantity = Quantity::ALL.into_iter().find(|q| q.name() == plain && (!with || q.has_parameters()))?;
        Some(bit(quantity, with))
    }

    /// Whether a function is wanted.
    pub fn contains(self, quantity: Quantity, with_parameters: bool) -> bool {
        self.0.is_none_or(|set| set & bit(quantity, with_parameters) != 0)
    }

    /// Whether all functions are wanted, because none is named.
    pub fn is_all(self) -> bool {
        self.0.is_none()
    }
}

/// Names of all functions that can be emitted, in the order of the module.
fn names() -> Vec<String> {
    let each = Quantity::ALL.into_iter().flat_map(|quantity| {
        let with = quantity.has_parameters().then(|| format!("{}_with", quantity.name()));
        std::iter::once(quantity.name().to_string()).chain(with)
    });
    each.collect()
}

fn complaint(name: &str) -> String {
    let names = names();
    let words: Vec<&str> = names.iter().map(String::as_str).collect();
    // Not every function has a form with the parameters at run time.
    let plain = name.strip_suffix("_with").and_then(|plain| words.iter().copied().find(|&word| word == plain));
    match plain.or_else(|| did_you_mean(name, &words)) {
        Some(near) => format!("there is no function `{name}`: do you mean `{near}`?"),
        None => format!("there is no function `{name}`; there are {}", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_choose_and_unknown_ones_are_answered() {
        let chosen = Selection::named(["gravity", "inertia_matrix_with"]).unwrap();
        assert!(chosen.contains(Quantity::Gravity, false) && chosen.contains(Quantity::InertiaMatrix, true));
        assert!(!chosen.contains(Quantity::Gravity, true) && !chosen.contains(Quantity::InertiaMatrix, false));
        assert!(Selection::ALL.contains(Quantity::ForwardDynamicsDerivatives, false));
        assert_eq!(
            Selection::named(["gravty", "regressor_with"]).unwrap_err(),
            "there is no function `gravty`: do you mean `gravity`?\nthere is no function `regressor_with`: do you mean `regressor`?"
        );
        assert!(Selection::named(["xyzzy"])
            .unwrap_err()
            .starts_with("there is no function `xyzzy`; there are direct_kinematics, "));
        for name in names() {
            assert!(Selection::named([name]).is_ok());
        }
    }
}
