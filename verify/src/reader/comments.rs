//! The comments of a module in a language other than Rust, each with the lines of code around it.
//!
//! In these languages a comment begins at the beginning of a line and ends at the end of one (`plain`); an empty line ends one that is made of single
//! lines.

use armgen_codegen::emit::Language;

use super::plain::Comments;
use super::{c, javascript, matlab, python};

/// A comment as it stands in the text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comment {
    /// Its first line, counted from 1.
    pub line: usize,
    /// Its lines.
    pub text: String,
    /// The line of code in front of it, nothing where there is none.
    pub behind: String,
    /// The line of code that follows, nothing where there is none.
    pub before: String,
}

/// The comments of a text.
pub(super) fn of(text: &str, comments: Comments) -> Vec<Comment> {
    let mut all: Vec<Comment> = Vec::new();
    // How many have the next line of code in front of them.
    let mut followed = 0;
    let mut open = None;
    let mut goes_on = false;
    let mut behind = "";
    for (line, number) in text.split('\n').zip(1..) {
        let is_single = comments.line.is_some_and(|sign| line.starts_with(sign)) && !line.starts_with(matlab::FILE);
        let begins = comments.block.filter(|(begin, _)| open.is_none() && line.starts_with(begin));
        if open.is_some() || begins.is_some() || is_single {
            if !goes_on || begins.is_some() {
                all.push(Comment { line: number, behind: behind.into(), ..Comment::default() });
            }
            if let Some(comment) = all.last_mut() {
                comment.text += line;
                comment.text.push('\n');
            }
            open = match (open, begins) {
                (None, Some((begin, end))) => (!line[begin.len()..].contains(end)).then_some(end),
                (open, _) => open.filter(|end| !line.contains(end)),
            };
            goes_on = open.is_some() || (is_single && begins.is_none());
            continue;
        }
        goes_on = false;
        if !line.is_empty() {
            all[followed..].iter_mut().for_each(|comment| comment.before = line.into());
            followed = all.len();
            behind = line;
        }
    }
    all
}

/// The comments of a module.
pub(super) fn of_module(language: Language, text: &str) -> Vec<Comment> {
    match language {
        // Documentation there: `documentation`.
        Language::Rust => Vec::new(),
        Language::C => of(text, c::COMMENTS),
        Language::JavaScript => of(text, javascript::COMMENTS),
        Language::Python => of(text, python::COMMENTS),
        Language::Matlab => of(text, matlab::COMMENTS),
    }
}

/// The comments in texts that are the same in every module, for a robot of this name.
pub(crate) fn fixed(language: Language, name: &str) -> Vec<Comment> {
    let texts: Vec<String> = match language {
        Language::Rust => Vec::new(),
        Language::C => c::FIXED.iter().map(|text| c::in_the_name_of(name, text)).collect(),
        Language::JavaScript => javascript::FIXED.map(String::from).to_vec(),
        Language::Python => python::FIXED.map(String::from).to_vec(),
        Language::Matlab => matlab::FIXED.map(String::from).to_vec(),
    };
    texts.iter().flat_map(|text| of_module(language, text)).collect()
}
