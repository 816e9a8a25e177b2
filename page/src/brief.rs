//! Scripts without what only their readers need. The build script shortens the files of `web/`, a page the emitted module.

/// Removes comment lines (a fifth of a file), indentation (an eighth) and empty lines, which only readers of `page/web` need.
/// Comments take half of the module that `armgen generate` writes. No string literal spans several lines, so none contains indentation.
pub(crate) fn brief(file: &str) -> String {
    let mut text = String::with_capacity(file.len());
    let mut within = false;
    for line in file.lines() {
        let words = line.trim();
        let begins = within || words.starts_with("/**");
        let ends = words.ends_with("*/");
        // Code may follow a comment on the same line.
        let comment = within || words.starts_with("//") || (begins && (ends || !words.contains("*/")));
        within = comment && begins && !ends;
        if !comment && !words.is_empty() {
            text.push_str(line.trim_start());
            text.push('\n');
        }
    }
    text
}
