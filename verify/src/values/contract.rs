//! The promised arguments and result of an emitted function. [`reference`](crate::textbook::reference) lists the functions.

use crate::values::program::Argument;

/// Length of a dimension of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// The n coordinates: joints, where none is coupled.
    Dof,
    /// All joints.
    Joints,
    /// The p parameters.
    Parameters,
    /// The b base parameters.
    BaseParameters,
    /// The m rows of the task.
    Task,
    /// This number.
    Of(usize),
}

impl Argument {
    /// Its number of entries.
    pub fn length(self) -> Length {
        match self {
            Argument::Pi => Length::Parameters,
            Argument::Gravity => Length::Of(3),
            _ => Length::Dof,
        }
    }
}

/// The sizes of an arm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Coordinates.
    pub n: usize,
    /// Joints, if they are more than coordinates because some are coupled.
    pub joints: Option<usize>,
    /// Parameters.
    pub p: usize,
    /// Base parameters.
    pub b: usize,
    /// Rows of the task; of a module with named end effectors, of the one that is [chosen](Sizes::of_function).
    pub m: usize,
    /// Whether the acceleration of free fall is an argument.
    pub gravity: bool,
    /// Names of the end effectors and the rows of their tasks; empty if the end effector has no name.
    pub tips: Vec<(String, usize)>,
}

impl Sizes {
    /// The sizes for a function: `m` is of its end effector.
    #[must_use]
    pub fn of_function(&self, function: &str) -> Sizes {
        let tip = tip_of(function).and_then(|tip| self.tips.iter().find(|(name, _)| name.eq_ignore_ascii_case(tip)));
        Sizes { m: tip.map_or(self.m, |(_, rows)| *rows), ..self.clone() }
    }
}

/// The name of the end effector before a function's own name.
pub fn tip_of(function: &str) -> Option<&str> {
    let (promise, with) = Promise::of(function)?;
    let own = if with { format!("{}_with", promise.name) } else { promise.name.to_owned() };
    function.strip_suffix(own.as_str())?.strip_suffix('_')
}

/// A text with the constants of joints and of the rows of the task as a module has them: without coupled joints `DOF` for both, and the rows of the
/// end effector of a function.
pub(crate) fn of_module(function: &str, is_coupled: bool, text: &str) -> String {
    let text = if is_coupled { text.to_owned() } else { text.replace("JOINTS", "DOF") };
    match tip_of(function) {
        Some(tip) => text.replace("TASK_ROWS", &format!("{}_TASK_ROWS", tip.to_ascii_uppercase())),
        None => text,
    }
}

impl Length {
    /// The same in a module of these sizes: without coupled joints there are as many joints as coordinates, and one constant.
    pub(crate) fn in_module(self, sizes: &Sizes) -> Length {
        if self == Length::Joints && sizes.joints.is_none() {
            Length::Dof
        } else {
            self
        }
    }

    pub(crate) fn of(self, sizes: &Sizes) -> usize {
        match self {
            Length::Dof => sizes.n,
            Length::Joints => sizes.joints.unwrap_or(sizes.n),
            Length::Parameters => sizes.p,
            Length::BaseParameters => sizes.b,
            Length::Task => sizes.m,
            Length::Of(value) => value,
        }
    }

    pub(crate) fn rust(self) -> String {
        match self {
            Length::Dof => "DOF".into(),
            Length::Joints => "JOINTS".into(),
            Length::Parameters => "PARAMETERS".into(),
            Length::BaseParameters => "BASE_PARAMETERS".into(),
            Length::Task => "TASK_ROWS".into(),
            Length::Of(value) => value.to_string(),
        }
    }
}

/// Dimensions of an array, outermost first; empty for a number.
pub type Array = &'static [Length];

/// The result of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Returned {
    /// An array or a number.
    One(Array),
    /// Several results in a tuple.
    List(&'static [Array]),
    /// Several results in fields of a type with this name.
    Fields(&'static str, &'static [(&'static str, Array)]),
}

/// A function that a module has or may have.
#[derive(Clone, Copy, Debug)]
pub struct Promise {
    /// Its name.
    pub name: &'static str,
    /// Its arguments; `g0` of modules alone that have the acceleration of free fall as an argument.
    pub arguments: &'static [&'static str],
    /// Its result.
    pub returned: Returned,
    /// Whether every module has it.
    pub required: bool,
    /// Whether a form `_with` run-time parameters exists.
    pub parameters: bool,
    /// Whether it is of an end effector: where these have names, each has it, with its name before this.
    pub of_tip: bool,
}

/// The Rust array with these entries, or its type.
fn of_entries(lengths: Array, entry: &str) -> String {
    lengths.iter().rev().fold(entry.to_string(), |of, length| format!("[{of};{}]", length.rust()))
}

impl Returned {
    /// The Rust type, without blanks.
    pub fn rust(self) -> String {
        let array = |lengths: Array| of_entries(lengths, "Real");
        match self {
            Returned::One(lengths) => array(lengths),
            Returned::List(all) => format!("({})", all.iter().map(|lengths| array(lengths)).collect::<Vec<_>>().join(",")),
            Returned::Fields(name, _) => name.into(),
        }
    }

    /// Each array with the Rust expression that selects it from the result.
    fn arrays(self) -> Vec<(String, Array)> {
        match self {
            Returned::One(lengths) => vec![(String::new(), lengths)],
            Returned::List(all) => all.iter().enumerate().map(|(i, lengths)| (format!(".{i}"), *lengths)).collect(),
            Returned::Fields(_, all) => all.iter().map(|(name, lengths)| (format!(".{name}"), *lengths)).collect(),
        }
    }

    /// Each array with its name in languages with named results.
    pub fn named(self) -> Vec<(String, Array)> {
        match self {
            Returned::One(lengths) => vec![("result".into(), lengths)],
            Returned::List(all) => {
                ["by_q", "by_dq", "by_tau"].iter().zip(all).map(|(name, array)| ((*name).into(), *array)).collect()
            }
            Returned::Fields(_, all) => all.iter().map(|(name, array)| ((*name).into(), *array)).collect(),
        }
    }

    /// The prefixes of the places of each array's entries.
    pub fn accesses(self) -> Vec<String> {
        self.arrays().into_iter().map(|(access, _)| access).collect()
    }

    /// The array of an entry, by name, and the indices in it.
    pub fn part_of(self, place: &str) -> (String, &str) {
        let (access, indices) = place.split_at(place.find('[').unwrap_or(place.len()));
        let part = self.arrays().iter().position(|(own, _)| own == access).unwrap_or(0);
        let name = self.named().swap_remove(part).0;
        (name, indices)
    }

    /// Places of the entries, in order.
    pub fn places(self, sizes: &Sizes) -> Vec<String> {
        fn within(place: &str, lengths: &[Length], sizes: &Sizes) -> Vec<String> {
            let Some((outer, inner)) = lengths.split_first() else { return vec![place.into()] };
            (0..outer.of(sizes)).flat_map(|i| within(&format!("{place}[{i}]"), inner, sizes)).collect()
        }
        self.arrays().iter().flat_map(|(place, lengths)| within(place, lengths, sizes)).collect()
    }

    /// The Rust value with these entries.
    pub fn value(self, entries: &[String], sizes: &Sizes) -> String {
        fn array(lengths: &[Length], entries: &mut std::slice::Iter<'_, String>, sizes: &Sizes) -> String {
            let Some((outer, inner)) = lengths.split_first() else { return entries.next().cloned().unwrap_or_default() };
            let rows: Vec<String> = (0..outer.of(sizes)).map(|_| array(inner, entries, sizes)).collect();
            format!("[{}]", rows.join(", "))
        }
        let mut entries = entries.iter();
        self.value_of(self.arrays().iter().map(|(_, lengths)| array(lengths, &mut entries, sizes)).collect())
    }

    /// The Rust value with these arrays.
    fn value_of(self, arrays: Vec<String>) -> String {
        match self {
            Returned::One(_) => arrays.concat(),
            Returned::List(_) => format!("({})", arrays.join(", ")),
            Returned::Fields(name, fields) => {
                let fields: Vec<String> =
                    fields.iter().zip(arrays).map(|((field, _), array)| format!("{field}: {array}")).collect();
                format!("{name} {{ {} }}", fields.join(", "))
            }
        }
    }
}

impl Promise {
    /// The arguments of the function of a module, in order; `gravity`: whether the acceleration of free fall is an argument there.
    pub fn arguments_of(&self, with_parameters: bool, gravity: bool) -> Vec<Argument> {
        let own = self.arguments.iter().copied().filter_map(Argument::named);
        let own = own.filter(|argument| *argument != Argument::Gravity || gravity);
        with_parameters.then_some(Argument::Pi).into_iter().chain(own).collect()
    }

    /// Names and Rust types, without blanks, of the output arguments of the function that writes the result into memory of the caller; a number
    /// is returned instead.
    pub(crate) fn written(&self) -> Option<Vec<(String, String)>> {
        let named = self.returned.named();
        let is_array = named.iter().all(|(_, lengths)| !lengths.is_empty());
        is_array.then(|| named.into_iter().map(|(name, lengths)| (name, of_entries(lengths, "Real"))).collect())
    }

    /// Whether the function that writes its result is public: for a matrix with a column per parameter.
    pub(crate) fn has_form_into(&self) -> bool {
        matches!(self.returned, Returned::One([_, Length::Parameters | Length::BaseParameters]))
    }

    /// The Rust body of a function that calls the writing function, without the final `result`.
    pub(crate) fn calls_written(&self, arguments: &[Argument], written: &str) -> String {
        let zeros = self.returned.arrays().into_iter().map(|(_, lengths)| of_entries(lengths, "0.0"));
        let value = self.returned.value_of(zeros.collect());
        let arguments = arguments.iter().map(|argument| argument.name().to_string());
        let results = self.returned.accesses().into_iter().map(|access| format!("&mut result{access}"));
        let all: Vec<String> = arguments.chain(results).collect();
        format!("let mut result = {value}; {written}({});", all.join(", "))
    }

    /// Arguments with their Rust types, without blanks.
    pub(crate) fn typed(arguments: &[Argument]) -> Vec<String> {
        arguments.iter().map(|argument| format!("{}:&[Real;{}]", argument.name(), argument.length().rust())).collect()
    }
}
