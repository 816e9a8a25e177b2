//! The functions of an emitted text: names and arguments, in order. Taken in by the build script as well.

/// A function: its name and the names of its arguments, `&self` left out.
pub type Signature = (String, Vec<String>);

/// Suffix of functions that write their result to a place of the caller.
pub const INTO: &str = "_into";

/// Functions over parameters, which have the same text in every module.
pub const OF_PARAMETERS: [&str; 2] = ["parameter_index", "payload_parameters"];

/// The signatures of the functions after each occurrence of `start`, which ends where the name begins.
pub fn signatures(text: &str, start: &str) -> Vec<Signature> {
    let signature = |rest: &str| {
        let (name, rest) = rest.split_once('(')?;
        let (arguments, _) = rest.split_once(')')?;
        let names = arguments.split(',').filter_map(|argument| argument.split_once(':'));
        Some((name.to_owned(), names.map(|(name, _)| name.trim().to_owned()).collect()))
    };
    text.split(start).skip(1).filter_map(signature).collect()
}

/// The functions of an emitted module for one state that return their results.
pub fn of_module(text: &str) -> Vec<Signature> {
    // Those for many states are indented.
    let mut all = signatures(text, "\npub fn ");
    all.retain(|(name, _)| !name.ends_with(INTO) && !OF_PARAMETERS.contains(&name.as_str()));
    all
}

/// The methods that the traits of the runtime have for a robot: `Nominal` or `WithParameters`.
pub fn of_robot(runtime_text: &str, robot: &str) -> Vec<Signature> {
    let blocks = runtime_text
        .split("\nimpl")
        .filter(|block| block.split('{').next().is_some_and(|head| head.contains(&format!(" for {robot}"))));
    blocks.flat_map(|block| signatures(block, "\n    fn ")).filter(|(name, _)| name != "default").collect()
}

/// As the list that macros take: `name(argument, ..), ..`.
pub fn listed(signatures: &[Signature]) -> String {
    let each = signatures.iter().map(|(name, arguments)| format!("{name}({})", arguments.join(", ")));
    each.collect::<Vec<_>>().join(", ")
}
