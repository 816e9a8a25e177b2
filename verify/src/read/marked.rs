//! Texts with optional lines for some robots; each of these lines ends with a mark.

/// Lines for robots with Stribeck friction.
pub(crate) const STRIBECK: &str = "with Stribeck friction";
/// Lines for robots with load-dependent friction.
pub(crate) const LOAD: &str = "with load friction";

/// Lines for modules with the parameters of a payload.
pub(crate) const PAYLOAD: &str = "with a payload";

/// Lines for modules that have the acceleration of free fall as an argument.
pub(crate) const GRAVITY: &str = "with gravity as an argument";

/// Lines for modules with fused operations.
pub(crate) const FUSED: &str = "with fused operations";

/// The text with only the wanted marked lines, without their marks; `sign` begins a comment.
pub(crate) fn marked(text: &str, sign: &str, wanted: &[(&str, bool)]) -> String {
    let kept = |line: &str| {
        let is_marked = |(mark, wanted): &(&str, bool)| {
            let of_mark = line.trim_end().trim_end_matches(" */").strip_suffix(mark)?.strip_suffix(&format!(" {sign} "))?;
            Some((of_mark.to_owned() + "\n", *wanted))
        };
        match wanted.iter().find_map(is_marked) {
            None => line.to_owned(),
            Some((line, true)) => line,
            Some((_, false)) => String::new(),
        }
    };
    text.split_inclusive('\n').map(kept).collect()
}
