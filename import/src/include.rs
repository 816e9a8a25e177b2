//! `include` of a MuJoCo model: the content of the root of another file takes the place of the element.
//!
//! Nothing here touches a file: the caller passes what reads one, by its path relative to the folder of the model. The paths never lead out
//! of that folder. Line breaks of what is included become blanks, so that the lines of the model keep their numbers: a fault in an included
//! file has the place of its `include`.

use std::collections::BTreeSet;

use armgen_codegen::diagnostic::{Diagnostic, Diagnostics};
use armgen_codegen::source::{Source, Span};

use crate::xml::{self, attribute, place, shown};
use crate::Code;

/// Files within each other.
const MAX_DEPTH: usize = 16;
/// Files of a model.
const MAX_FILES: usize = 256;
/// Bytes of all of them.
const MAX_BYTES: usize = 16 << 20;

/// Reads a file by its path relative to the model, or gives the reason of the failure.
pub type Reader<'r> = dyn Fn(&str) -> Result<String, String> + 'r;

/// The model with all that it includes, under its name; a text that is no such model stays as it is. Only `include` can be faulty.
///
/// # Errors
/// The first `include` that cannot be followed, with its place.
pub fn included(source: &Source, read: &Reader<'_>) -> Result<Source, Box<Diagnostic>> {
    let mut files = Files { read, taken: BTreeSet::new(), bytes: 0 };
    match files.written_out(source.text(), source, 0) {
        Ok(Some(text)) => Ok(Source::new(source.name(), text)),
        Ok(None) => Ok(source.clone()),
        Err(fault) => Err(Box::new(fault)),
    }
}

struct Files<'r> {
    read: &'r Reader<'r>,
    taken: BTreeSet<String>,
    bytes: usize,
}

fn refusal(span: Span, message: String, help: &str) -> Diagnostic {
    Diagnostic::new(Code::MjcfFeature, span, message, "", help)
}

impl Files<'_> {
    /// A text with all that it includes; `None` where it includes nothing.
    fn written_out(&mut self, text: &str, source: &Source, depth: usize) -> Result<Option<String>, Diagnostic> {
        let readable = xml::without_harmless_slips(text);
        let mut faults = Diagnostics::new();
        let Some(document) = xml::parse(&readable, source, &mut faults) else {
            // Of the model itself the import tells.
            return match faults.iter().next() {
                Some(fault) if depth > 0 => Err(fault.clone()),
                _ => Ok(None),
            };
        };
        let root = document.root_element();
        if depth == 0 && root.tag_name().name() != "mujoco" {
            return Ok(None);
        }
        let (mut whole, mut end) = (String::new(), 0);
        for node in root.descendants().filter(|node| node.has_tag_name("include") && node.parent_element().is_some()) {
            let Some((path, span)) = attribute(node, "file") else {
                let message = "an `include` names no file".to_owned();
                return Err(refusal(place(node), message, "write `file=\"arm.xml\"` in it"));
            };
            let inner = self.inside(path, span, depth)?;
            whole += &readable[end..node.range().start];
            whole.extend(inner.chars().map(|c| if matches!(c, '\n' | '\r') { ' ' } else { c }));
            end = node.range().end;
        }
        Ok((end > 0).then(|| whole + &readable[end..]))
    }

    /// The content of the root element of a file.
    fn inside(&mut self, written: &str, span: Span, depth: usize) -> Result<String, Diagnostic> {
        let file = shown(written);
        let Some(path) = within_folder(written) else {
            let help = "put the file beside the model, or save the compiled model as XML (`mj_saveLastXML`) and import that";
            return Err(refusal(span, format!("`{file}` is outside of the model's folder"), help));
        };
        if !self.taken.insert(path.clone()) {
            let help = "a file is included once: take the second `include` of it out";
            return Err(refusal(span, format!("`{file}` is included a second time"), help));
        }
        if depth == MAX_DEPTH || self.taken.len() > MAX_FILES {
            let message = format!("more than {MAX_DEPTH} files include each other, or more than {MAX_FILES} in all");
            let help = "save the compiled model as XML (`mj_saveLastXML`) and import that";
            return Err(Diagnostic::new(Code::TooLarge, span, message, "", help));
        }
        let text = (self.read)(&path).map_err(|reason| {
            let help = "put the file where the model looks for it: paths are relative to the folder of the model";
            refusal(span, format!("cannot read `{file}`: {reason}"), help)
        })?;
        self.bytes += text.len();
        if self.bytes > MAX_BYTES {
            let help = "an arm's model has far less: take out what is not about its bodies";
            return Err(Diagnostic::new(
                Code::TooLarge,
                span,
                format!("the files of the model have more than {MAX_BYTES} bytes"),
                "",
                help,
            ));
        }
        let source = Source::new(path.as_str(), text);
        // The place of a fault in there is told in words.
        let of_file = |fault: Diagnostic| {
            let line = source.place(fault.span().start).line;
            let message = format!("{} (`{file}`, line {line})", fault.message);
            Diagnostic { message, ..Diagnostic::new(fault.code, span, "", "in this file", fault.help) }
        };
        let text = match self.written_out(source.text(), &source, depth + 1).map_err(of_file)? {
            Some(text) => text,
            None => xml::without_harmless_slips(source.text()).into_owned(),
        };
        let whole = Source::new(path.as_str(), text);
        let mut faults = Diagnostics::new();
        let Some(document) = xml::parse(whole.text(), &whole, &mut faults) else {
            return Err(refusal(span, format!("`{file}` is no part of a model"), "see what it includes"));
        };
        let root = document.root_element();
        let range = root.first_child().zip(root.last_child()).map(|(first, last)| first.range().start..last.range().end);
        Ok(range.and_then(|range| whole.text().get(range)).unwrap_or_default().to_owned())
    }
}

/// A relative path in plain steps; `None` if it leads out of the folder.
fn within_folder(path: &str) -> Option<String> {
    let path = path.trim().replace('\\', "/");
    if path.is_empty() || path.starts_with('/') || path.contains(':') || path.contains('\0') {
        return None;
    }
    let mut steps: Vec<&str> = Vec::new();
    for step in path.split('/') {
        match step {
            "" | "." => {}
            ".." => _ = steps.pop()?,
            step => steps.push(step),
        }
    }
    (!steps.is_empty()).then(|| steps.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_the_folder() {
        for (path, expected) in [
            ("a.xml", Some("a.xml")),
            ("./parts//a.xml", Some("parts/a.xml")),
            ("parts/../a.xml", Some("a.xml")),
            ("parts\\a.xml", Some("parts/a.xml")),
            ("..", None),
            ("../a.xml", None),
            ("parts/../../a.xml", None),
            ("/etc/passwd", None),
            ("C:\\a.xml", None),
            ("", None),
            (".", None),
        ] {
            assert_eq!(within_folder(path).as_deref(), expected, "{path}");
        }
    }
}
