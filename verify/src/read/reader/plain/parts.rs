//! The parts of long functions.

use std::collections::BTreeMap;

use super::body::Body;
use super::lines::Lines;
use crate::read::reader::lexer::Fault;

/// The parts of long functions, in languages that pass values to a part as a list and return a list. Their lines are read at their calls.
#[derive(Default)]
pub(in crate::read::reader) struct Parts<'a>(BTreeMap<&'a str, Part<'a>>);

/// A part of a long function: its arguments, and the place of its lines.
struct Part<'a> {
    arguments: Vec<&'a str>,
    body: usize,
    used: bool,
}

impl<'a> Parts<'a> {
    /// Adds a part whose head is at `line`.
    pub(in crate::read::reader) fn add(
        &mut self,
        name: &'a str,
        arguments: Vec<&'a str>,
        body: usize,
        line: usize,
    ) -> Result<(), Fault> {
        match self.0.insert(name, Part { arguments, body, used: false }) {
            Some(_) => Err(Fault { line, reason: format!("`{name}` stands twice") }),
            None => Ok(()),
        }
    }

    /// A part without a call.
    pub(in crate::read::reader) fn unused(&self) -> Option<&'a str> {
        self.0.iter().find_map(|(name, part)| (!part.used).then_some(*name))
    }

    /// The function's arguments that a part takes, as in its call.
    pub(in crate::read::reader) fn passed(&mut self, name: &str, lines: &Lines<'a>) -> Result<String, Fault> {
        let part = self.0.get_mut(name).ok_or_else(|| lines.fault(format!("there is no part `{name}`")))?;
        part.used = true;
        Ok(part.arguments.iter().map(|argument| format!("{argument}, ")).collect())
    }

    /// Reads the lines of a called part as if they were here. The arguments are the passed names, the line of the call, the reader for the names of
    /// results, and the name of the list of results.
    pub(in crate::read::reader) fn take_in(
        &self,
        name: &str,
        lines: &mut Lines<'a>,
        body: &mut Body<'a, '_>,
        (names, line): (Vec<&'a str>, usize),
        results: impl FnOnce(&mut Lines<'a>) -> Result<Vec<&'a str>, Fault>,
        given: &str,
    ) -> Result<(), Fault> {
        let part = self.0.get(name).ok_or_else(|| lines.fault(format!("there is no part `{name}`")))?;
        let all = body.program.arguments.clone();
        if let Some(wrong) = part.arguments.iter().find(|a| !all.iter().any(|own| own.name() == **a)) {
            return Err(Fault { line, reason: format!("`{wrong}` is not an argument of the function") });
        }
        let taken = names.into_iter().map(|name| body.value(name, line)).collect::<Result<Vec<usize>, Fault>>()?;
        let back = std::mem::replace(&mut lines.at, part.body);
        let scope = body.enter();
        // It only knows those arguments of the function that it takes.
        body.program.arguments.retain(|own| part.arguments.contains(&own.name()));
        for (i, value) in taken.into_iter().enumerate() {
            if !body.element(lines, &body.syntax.value("taken", i), value)? {
                return Err(lines.fault(format!("value {i} that the part takes has no name")));
            }
        }
        body.definitions(lines)?;
        let line = lines.number();
        let values = results(lines)?.into_iter().map(|name| body.value(name, line)).collect::<Result<Vec<usize>, Fault>>()?;
        body.leave(scope);
        body.program.arguments = all;
        lines.at = back;
        for (i, value) in values.into_iter().enumerate() {
            if !body.element(lines, &body.syntax.value(given, i), value)? {
                return Err(lines.fault(format!("value {i} that the part gives has no name")));
            }
        }
        Ok(())
    }
}
