//! The comments of a module in a language other than Rust, each with the lines of code around it.
//!
//! In these languages a comment begins at the beginning of a line and ends at the end of one (`plain`); an empty line ends one that is made of single
//! lines.

use std::sync::Arc;

use armgen_codegen::emit::Language;

use super::lexer::Fault;
use super::plain::Comments;
use super::{c, javascript, matlab, python};

/// Comments of a module; that of 32 joints has a hundredth of it.
const MOST_COMMENTS: usize = 1 << 16;

/// A comment as it stands in the text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comment {
    /// Its first line, counted from 1.
    pub line: usize,
    /// Its lines.
    pub text: String,
    /// The line of code in front of it, nothing where there is none.
    pub behind: Arc<str>,
    /// The line of code that follows, nothing where there is none.
    pub before: Arc<str>,
}

/// The comments of a text.
pub(super) fn of(text: &str, comments: Comments) -> Result<Vec<Comment>, Fault> {
    let mut all: Vec<Comment> = Vec::new();
    // How many have the next line of code in front of them.
    let mut followed = 0;
    let mut open = None;
    let mut goes_on = false;
    let mut behind = "";
    // The same, as comments have it.
    let mut shared: Option<Arc<str>> = None;
    for (line, number) in text.split('\n').zip(1..) {
        let is_single = comments.line.is_some_and(|sign| line.starts_with(sign)) && !line.starts_with(matlab::FILE);
        let begins = comments.block.filter(|(begin, _)| open.is_none() && line.starts_with(begin));
        if open.is_some() || begins.is_some() || is_single {
            if !goes_on || begins.is_some() {
                if all.len() == MOST_COMMENTS {
                    return Err(Fault { line: number, reason: format!("more than {MOST_COMMENTS} comments") });
                }
                let behind = shared.get_or_insert_with(|| behind.into()).clone();
                all.push(Comment { line: number, behind, ..Comment::default() });
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
            shared = None;
            if followed < all.len() {
                let line: &Arc<str> = shared.insert(line.into());
                all[followed..].iter_mut().for_each(|comment| comment.before = line.clone());
                followed = all.len();
            }
            behind = line;
        }
    }
    Ok(all)
}

/// The comments of a module.
pub(super) fn of_module(language: Language, text: &str) -> Result<Vec<Comment>, Fault> {
    match language {
        // Documentation there: `documentation`.
        Language::Rust => Ok(Vec::new()),
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
    texts.iter().flat_map(|text| of_module(language, text).unwrap_or_default()).collect()
}
