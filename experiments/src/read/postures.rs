//! `postures`, `plane`, `grid`.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::{Code as Shared, Diagnostic};
use armgen_codegen::document::excerpt;
use armgen_codegen::document::reader::{required, Fields};
use armgen_codegen::source::{Span, Spanned};
use armgen_runtime::task::Row;

use super::values::{Allowed, Numbers, Reader};
use crate::model::{Posture, Postures};

/// Maximum number of postures in a grid.
const MAX_POSTURES: usize = 10_000;

const HELP: &str = "write one `- {name: ..., q: [...]}` per posture";

impl Reader<'_> {
    pub(super) fn postures(&mut self, fields: &Fields<'_>) -> Option<Postures> {
        let (at, node) = fields.get("postures")?;
        let items = self.items(node, at, "postures", HELP)?;
        let keys = [required("name", "name: stretched"), required("q", "q: [0, pi/2, ...]")];
        let (mut list, mut seen) = (Vec::new(), BTreeMap::new());
        for item in items {
            let fields = self.mapping(item, "a posture", item.span, &keys)?;
            let name = self.word(&fields, "name")?;
            self.name(&name, &mut seen);
            list.push(Posture { name: name.value, q: self.joints(&fields, "q")? });
        }
        if list.is_empty() {
            self.report(Shared::EmptyList, at, "`postures` names no posture", "empty", HELP);
        }
        let plane = match self.rows(fields, "plane") {
            None => [Row::X, Row::Y],
            Some(rows) => match <[Row; 2]>::try_from(rows) {
                Ok(plane) if plane.iter().all(|row| !row.is_angular()) => plane,
                _ => {
                    let (message, help) = ("`plane` takes two linear rows", "for instance `plane: [x, y]`");
                    self.report(Shared::WrongLength, fields.place("plane"), message, "here", help);
                    return None;
                }
            },
        };
        let grid = fields.get("grid").and_then(|(at, _)| self.grid(fields, at));
        Some(Postures { list, plane, grid })
    }

    /// Checks a name, which prefixes quantities and log columns: `NAME.w,0.25`. It must differ from those `seen` before.
    fn name(&mut self, name: &Spanned<String>, seen: &mut BTreeMap<String, Span>) {
        let shown = excerpt(&name.value);
        let fits = |first: bool| move |c: char| c == '_' || c.is_alphabetic() || !first && c.is_numeric();
        if !(name.value.starts_with(fits(true)) && name.value.chars().all(fits(false))) {
            let message = format!("`{shown}` cannot be the name of a posture: it is not an identifier");
            let help = "use letters, digits and `_`, a letter first: `elbow_up`";
            self.report(Shared::BadName, name.span, message, "not an identifier", help);
        } else if let Some(first) = seen.insert(name.value.clone(), name.span) {
            let message = format!("two postures are called `{shown}`");
            let help = "give each posture a name of its own: expectations and the log call it by that name";
            let diagnostic = Diagnostic::new(Shared::DuplicateName, name.span, message, "the second one", help);
            self.document.push(diagnostic.also(first, "the first one"));
        }
    }

    fn grid(&mut self, fields: &Fields<'_>, at: Span) -> Option<[Vec<f64>; 2]> {
        let (_, node) = fields.get("grid")?;
        let keys = [required("first", "first: [0, pi/2]"), required("second", "second: [0.1, 0.2]")];
        let fields = self.mapping(node, "`grid`", at, &keys)?;
        let mut values = |name: &'static str| {
            let (at, node) = fields.get(name)?;
            let len = self.items(node, at, name, "write the values in brackets")?.len();
            self.list(node, at, name, Numbers { len, each: "values of a joint", allowed: Allowed::Any })
        };
        let (first, second) = (values("first")?, values("second")?);
        let postures = first.len() * second.len();
        if postures > MAX_POSTURES {
            let help = format!("at most {MAX_POSTURES} combinations of both");
            self.report(Shared::OutOfRange, at, "the grid has too many postures", format!("{postures} combinations"), help);
            return None;
        }
        Some([first, second])
    }
}
