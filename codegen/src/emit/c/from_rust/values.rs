//! Texts of C for values, with the facts needed to combine them.

use super::types::Type;

/// How tightly the outermost operator of a text binds, as far as brackets are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Binding {
    Choice,
    Or,
    And,
    Comparison,
    Bits,
    Sum,
    Product,
    Unary,
    Primary,
}

/// Meaning of a text as a C expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A value that has no place.
    Value,
    /// A place.
    Place,
    /// A pointer to the place.
    Pointer,
}

/// A value. That of a reference is the place that it leads to.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) text: String,
    pub(super) binding: Binding,
    pub(super) kind: Kind,
}

impl Value {
    pub(super) fn new(text: impl Into<String>, binding: Binding) -> Self {
        Value { text: text.into(), binding, kind: Kind::Value }
    }

    pub(super) fn primary(text: impl Into<String>) -> Self {
        Value::new(text, Binding::Primary)
    }

    pub(super) fn place(text: impl Into<String>) -> Self {
        Value { text: text.into(), binding: Binding::Primary, kind: Kind::Place }
    }

    pub(super) fn behind(pointer: impl Into<String>) -> Self {
        Value { text: pointer.into(), binding: Binding::Primary, kind: Kind::Pointer }
    }

    /// The text of the value, in brackets where its operator binds less tightly than this.
    pub(super) fn within(&self, least: Binding) -> String {
        match self.kind {
            Kind::Pointer if least > Binding::Unary => format!("(*{})", self.text),
            Kind::Pointer => format!("*{}", self.text),
            _ if self.binding < least => format!("({})", self.text),
            _ => self.text.clone(),
        }
    }

    pub(super) fn text(&self) -> String {
        self.within(Binding::Choice)
    }

    /// A member of a place.
    pub(super) fn member(&self, name: &str) -> Value {
        let dot = if self.kind == Kind::Pointer { "->" } else { "." };
        Value::place(format!("{}{dot}{name}", self.text))
    }

    /// An element of a place that is an array.
    pub(super) fn element(&self, index: &str) -> Value {
        Value::place(format!("{}[{index}]", self.member("at").text))
    }

    /// The address of a place.
    pub(super) fn pointer(&self) -> String {
        match self.kind {
            Kind::Pointer => self.text.clone(),
            _ => format!("&{}", self.text),
        }
    }
}

/// How many elements there are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Count {
    Known(usize),
    Text(String),
}

impl Count {
    pub(super) fn text(&self) -> String {
        match self {
            Count::Known(count) => count.to_string(),
            Count::Text(text) => text.clone(),
        }
    }
}

/// Neighbours in an array.
#[derive(Clone, Debug)]
pub(super) struct View {
    pub(super) pointer: String,
    pub(super) offset: Option<String>,
    pub(super) count: Count,
    pub(super) of: Type,
    /// Length of each inner array, where the elements are elements of nested arrays.
    pub(super) within: Option<usize>,
}

impl View {
    pub(super) fn element(&self, index: &str) -> Value {
        let index = sum(self.offset.as_deref(), index);
        Value::place(match self.within {
            None => format!("{}[{index}]", self.pointer),
            Some(size) if is_word(&index) => format!("{}[{index} / {size}].at[{index} % {size}]", self.pointer),
            Some(size) => format!("{}[({index}) / {size}].at[({index}) % {size}]", self.pointer),
        })
    }

    pub(super) fn start(&self) -> String {
        match &self.offset {
            Some(offset) => format!("{} + {offset}", self.pointer),
            None => self.pointer.clone(),
        }
    }
}

/// Sum of two indices; the first is optional.
pub(super) fn sum(offset: Option<&str>, index: &str) -> String {
    match (offset, index) {
        (None | Some("0"), index) => index.to_owned(),
        (Some(offset), "0") => offset.to_owned(),
        (Some(offset), index) => match (offset.parse::<usize>(), index.parse::<usize>()) {
            (Ok(x), Ok(y)) => (x + y).to_string(),
            _ => format!("{index} + {offset}"),
        },
    }
}

/// Value that a pattern is matched with.
#[derive(Clone, Debug)]
pub(super) enum Item {
    Value(Value, Type),
    View(View),
    Tuple(Vec<Item>),
    /// An item that exists under a condition.
    Option(String, Box<Item>),
}

/// Source of a loop: every kind except filters and flattened iterators gives its element at an index.
#[derive(Clone)]
pub(super) enum Iter<'a> {
    /// Elements, as references or as values.
    View(View, bool),
    /// From a value up to another, which is in it or not.
    Range(String, String, bool, Type),
    Zip(Box<Iter<'a>>, Box<Iter<'a>>),
    Enumerate(Box<Iter<'a>>),
    Skip(Box<Iter<'a>>, String),
    Take(Box<Iter<'a>>, String),
    Rev(Box<Iter<'a>>),
    Map(Box<Iter<'a>>, &'a syn::ExprClosure),
    Filter(Box<Iter<'a>>, &'a syn::ExprClosure),
    Flatten(Box<Iter<'a>>),
    /// Parts of this length.
    Chunks(View, usize),
}

pub(super) fn is_word(text: &str) -> bool {
    text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
