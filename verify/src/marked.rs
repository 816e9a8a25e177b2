//! Texts with lines that only some robots need, each of which ends in a mark.

/// Lines that only robots with Stribeck friction need.
pub(crate) const STRIBECK: &str = "with Stribeck friction";
/// Lines that only robots need whose friction grows with the load.
pub(crate) const LOAD: &str = "with load friction";

/// Lines that only modules with fused operations need.
pub(crate) const FUSED: &str = "with fused operations";

/// The text with those marked lines, without their marks, of which the mark is wanted; `sign`: how a comment begins.
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
