//! A function of C while it is written: its lines, and the meanings of names, block by block.

use std::collections::{BTreeMap, BTreeSet};

use super::infer::Inferred;
use super::translator::{c_name, Found, Translator};
use super::types::Type;
use super::values::{Iter, Value, View};

/// Meaning of a name.
#[derive(Clone)]
pub(super) enum Bound<'a> {
    /// A variable or a place, and whether it may be changed.
    Value(Value, Type, bool),
    View(View),
    /// An iterator, and the variable that counts the items taken from it.
    Iterator(Iter<'a>, Option<String>),
    /// A closure, and a pointer to its captures.
    Closure(usize, Option<String>),
    Function(String),
}

/// Scope of a function of C.
#[derive(Default)]
pub(super) struct Frame<'a> {
    scopes: Vec<BTreeMap<String, Bound<'a>>>,
    /// The names of variables by the blocks of C.
    pub(super) blocks: Vec<BTreeSet<String>>,
    /// For a closure: the fields of its captures, with their values at its creation.
    pub(super) fields: Vec<(String, String)>,
    captured: BTreeMap<String, Bound<'a>>,
}

/// Translates a function of Rust, line after line.
pub(super) struct Lower<'a, 't> {
    pub(super) tr: &'t mut Translator<'a>,
    pub(super) inferred: &'t Inferred,
    pub(super) text: String,
    pub(super) indent: usize,
    pub(super) frames: Vec<Frame<'a>>,
    pub(super) owner: String,
}

impl<'a> Lower<'a, '_> {
    pub(super) fn open_frame(&mut self) {
        let frame = Frame { scopes: vec![BTreeMap::new()], blocks: vec![BTreeSet::new()], ..Frame::default() };
        self.frames.push(frame);
    }

    pub(super) fn line(&mut self, line: &str) {
        self.text += &"    ".repeat(self.indent);
        self.text += line;
        self.text += "\n";
    }

    /// A block of C.
    pub(super) fn open(&mut self, head: &str) {
        self.line(&format!("{head} {{"));
        self.indent += 1;
        if let Some(frame) = self.frames.last_mut() {
            frame.blocks.push(BTreeSet::new());
        }
    }

    pub(super) fn close(&mut self) {
        self.indent -= 1;
        self.line("}");
        if let Some(frame) = self.frames.last_mut() {
            frame.blocks.pop();
        }
    }

    /// `} else {`, in whose place a block ends and another begins.
    pub(super) fn otherwise(&mut self, head: &str) {
        self.indent -= 1;
        self.line(&format!("}} {head} {{"));
        self.indent += 1;
        if let Some(frame) = self.frames.last_mut() {
            frame.blocks.pop();
            frame.blocks.push(BTreeSet::new());
        }
    }

    /// Opens a block whose names are free again after it.
    pub(super) fn open_names(&mut self) {
        if let Some(frame) = self.frames.last_mut() {
            frame.blocks.push(BTreeSet::new());
        }
    }

    /// A name that is taken from here on.
    pub(super) fn reserve(&mut self, name: &str) {
        if let Some(block) = self.frames.last_mut().and_then(|frame| frame.blocks.last_mut()) {
            block.insert(name.into());
        }
    }

    pub(super) fn close_names(&mut self) {
        if let Some(frame) = self.frames.last_mut() {
            frame.blocks.pop();
        }
    }

    pub(super) fn open_scope(&mut self) {
        if let Some(frame) = self.frames.last_mut() {
            frame.scopes.push(BTreeMap::new());
        }
    }

    pub(super) fn close_scope(&mut self) {
        if let Some(frame) = self.frames.last_mut() {
            frame.scopes.pop();
        }
    }

    /// A name for a variable that no variable has that is seen here.
    pub(super) fn variable(&mut self, wanted: &str) -> String {
        let wanted = c_name(wanted);
        let mut name = wanted.clone();
        let Some(frame) = self.frames.last_mut() else { return name };
        let mut number = 2;
        while frame.blocks.iter().any(|block| block.contains(&name)) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        if let Some(block) = frame.blocks.last_mut() {
            block.insert(name.clone());
        }
        name
    }

    pub(super) fn bind_name(&mut self, name: &str, bound: Bound<'a>) {
        if let Some(scope) = self.frames.last_mut().and_then(|frame| frame.scopes.last_mut()) {
            scope.insert(name.into(), bound);
        }
    }

    pub(super) fn lookup(&mut self, name: &str) -> Found<Option<Bound<'a>>> {
        self.lookup_in(self.frames.len() - 1, name)
    }

    fn lookup_in(&mut self, level: usize, name: &str) -> Found<Option<Bound<'a>>> {
        let frame = &self.frames[level];
        let found = frame.scopes.iter().rev().find_map(|scope| scope.get(name)).or_else(|| frame.captured.get(name)).cloned();
        if found.is_some() || level == 0 {
            return Ok(found);
        }
        let Some(outer) = self.lookup_in(level - 1, name)? else { return Ok(None) };
        let field = c_name(name);
        let inside = format!("captured->{field}");
        let (declaration, value, bound) = match outer {
            Bound::Value(value, ty, mutable) => {
                let of = if matches!(ty.behind(), Type::Slice(_)) { ty.clone() } else { ty.behind().clone() };
                let declaration = self.tr.declarator(&Type::to(of, mutable), &field)?;
                (declaration, value.pointer(), Bound::Value(Value::behind(inside), ty, mutable))
            }
            Bound::Closure(id, Some(pointer)) => {
                let declaration = self.tr.declarator(&Type::Closure(id), &field)?;
                (declaration, pointer, Bound::Closure(id, Some(inside)))
            }
            Bound::Closure(_, None) | Bound::Function(_) => return Ok(Some(outer)),
            Bound::View(_) | Bound::Iterator(..) => return Err(format!("`{name}` cannot be captured")),
        };
        let frame = &mut self.frames[level];
        frame.fields.push((declaration, value));
        frame.captured.insert(name.into(), bound.clone());
        Ok(Some(bound))
    }
}
