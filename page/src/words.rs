//! A description of a function in a sentence.

use armgen_codegen::catalogue;

/// The title of a function in its documentation; for a matrix from a list, the list's title.
pub(crate) fn about(function: &str) -> Option<&'static str> {
    if let Some((quantity, _)) = catalogue::named(function) {
        return Some(quantity.documentation.title);
    }
    let list = function.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
    catalogue::quantities().find_map(|quantity| {
        let named = |part: &&catalogue::ResultPart| part.element.as_ref().map_or(part.name, |element| element.name) == list;
        let part = quantity.result.iter().find(named)?;
        Some(if part.meaning[0].is_empty() { quantity.documentation.title } else { part.meaning[0] })
    })
}

#[cfg(test)]
mod tests {
    use super::about;

    #[test]
    fn functions_and_matrices_of_lists_have_titles() {
        assert!(about("known_torque").is_some_and(|text| text.contains("not among the parameters")));
        assert!(about("link_frame_3").is_some_and(|text| text.contains("every link")));
        assert_eq!(about("nothing"), None);
    }
}
