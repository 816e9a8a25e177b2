//! Named quantities: which stay symbols, which are numbers, which stand for an expression.
//!
//! - A name whose value uses other names *abbreviates* that expression: it is substituted wherever it occurs, unless `regressor`
//!   lists it; then it is independent and starts from that value.
//! - A name that enters anywhere by division, root or angle is a *number* everywhere: its symbol would not be a polynomial.
//! - All other names are *symbols* ([`ParameterId`]) of the equations.

use std::collections::{BTreeMap, BTreeSet};

use super::number::{self, Nominals};
use super::places::{Occurrence, Role};
use crate::description::{JointDescription, RegressorDescription, RobotDescription};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::{excerpt, Expression, ExpressionKind, Operator};
use crate::exact::Number;
use crate::kinds::{JointKind, ParameterId, Scalar};
use crate::manipulator::Parameter;
use crate::source::Span;
use crate::suggest::did_you_mean;

/// The named quantities of a description, in its order.
pub(super) struct Parameters<'d> {
    pub(super) entries: Vec<Entry<'d>>,
    by_name: BTreeMap<&'d str, usize>,
    /// Names used above their definition; each such use is reported.
    forward: BTreeSet<&'d str>,
    /// How many unknown names were reported.
    unknown: usize,
    /// Every name of the description, wherever it is defined.
    later: BTreeSet<&'d str>,
}

/// After so many unknown names no more is guessed about what was meant: each guess compares the name with all that are defined.
const GUESSES: usize = 50;

/// A named quantity.
pub(super) struct Entry<'d> {
    pub(super) name: &'d str,
    pub(super) span: Span,
    pub(super) value: Option<&'d Expression>,
    /// Its value; `None` after a reported fault.
    pub(super) nominal: Option<Number>,
    /// Its symbol, if it is a symbol of the equations.
    pub(super) symbol: Option<ParameterId>,
    /// Where and how it enters so that it must be a number.
    pub(super) number: Option<(Span, Reason)>,
    /// Whether it stands for the expression under it.
    pub(super) abbreviation: bool,
    /// Its occurrences in expressions.
    pub(super) uses: Vec<Occurrence>,
}

/// The context of a name, which helps to guess the meaning of an undefined name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Within<'d> {
    /// The value of the parameter of this name.
    Parameter(&'d str),
    /// The offset of a joint variable: `theta` of a revolute joint, `d` of a prismatic one.
    Offset(JointKind),
    Other,
}

impl Within<'_> {
    /// The key to whose value a joint variable is added, if `name` is what tables of Denavit and Hartenberg call it.
    fn adds_variable(self, name: &str) -> Option<&'static str> {
        let Within::Offset(kind) = self else { return None };
        let letters = name.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_');
        let (key, own): (_, &[&str]) = match kind {
            JointKind::Revolute => ("theta", &["theta", "th", "\u{3b8}", "\u{3d1}"]),
            JointKind::Prismatic => ("d", &["d"]),
        };
        let is_one = letters == "q" || own.contains(&letters.to_lowercase().as_str());
        is_one.then_some(key)
    }
}

/// The offsets of joint variables, by their places.
fn offsets(description: &RobotDescription) -> BTreeMap<Span, Within<'static>> {
    let joints = description.joints.iter().flat_map(|joints| &joints.value);
    let offset = |joint: &JointDescription| {
        let kind = joint.kind.as_ref()?.value;
        let value = if kind == JointKind::Revolute { &joint.theta } else { &joint.d };
        Some((value.as_ref()?.span, Within::Offset(kind)))
    };
    joints.filter_map(offset).collect()
}

/// Why a name cannot be a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reason {
    Division,
    Root,
    Angle,
    Axis,
    Coupling,
}

impl Reason {
    /// How the name enters.
    pub(super) fn text(self) -> &'static str {
        match self {
            Reason::Division => "by division",
            Reason::Root => "through a root",
            Reason::Angle => "through an angle",
            Reason::Axis => "through the direction of an axis",
            Reason::Coupling => "through the coupling of a joint",
        }
    }
}

impl Nominals for Parameters<'_> {
    fn nominal(&self, name: &str) -> Option<Number> {
        self.get(name).and_then(|entry| entry.nominal.clone())
    }
}

impl<'d> Parameters<'d> {
    /// Finds out what each name is, and reports names that are not defined.
    pub(super) fn resolve(description: &'d RobotDescription, scalar: Scalar, diagnostics: &mut Diagnostics) -> Parameters<'d> {
        let listed: BTreeSet<&str> = match &description.regressor {
            Some(regressor) => match &regressor.value {
                RegressorDescription::Names(names) => names.iter().map(|n| n.value.as_str()).collect(),
                _ => BTreeSet::new(),
            },
            None => BTreeSet::new(),
        };
        let mut parameters = Parameters {
            entries: Vec::new(),
            by_name: BTreeMap::new(),
            forward: BTreeSet::new(),
            unknown: 0,
            later: description.parameters.iter().map(|p| p.name.value.as_str()).collect(),
        };
        for parameter in &description.parameters {
            let name = parameter.name.value.as_str();
            if let Some(value) = &parameter.value {
                parameters.note_uses(value, Role::Parameter, Within::Parameter(name), diagnostics);
            }
            let abbreviation = parameter.value.as_ref().is_some_and(|v| !v.named().is_empty()) && !listed.contains(name);
            let nominal = parameter.value.as_ref().and_then(|v| number::number(v, &parameters, scalar, diagnostics));
            let entry = Entry {
                name,
                span: parameter.name.span,
                value: parameter.value.as_ref(),
                nominal,
                symbol: None,
                number: None,
                abbreviation,
                uses: Vec::new(),
            };
            parameters.by_name.insert(name, parameters.entries.len());
            parameters.entries.push(entry);
        }
        let offsets = offsets(description);
        description.each_value(|role, _, expression| {
            let within = offsets.get(&expression.span).copied().unwrap_or(Within::Other);
            parameters.note_uses(expression, role, within, diagnostics);
            match role {
                Role::Angle => parameters.force(expression, expression.span, Reason::Angle),
                Role::Axis => parameters.force(expression, expression.span, Reason::Axis),
                Role::Factor | Role::Offset => parameters.force(expression, expression.span, Reason::Coupling),
                _ => {}
            }
            // A limit is a number anyway, and so is a gain.
            if !matches!(role, Role::Limit | Role::Gain) {
                parameters.force_within(expression);
            }
        });
        for i in 0..parameters.entries.len() {
            if let Some(value) = parameters.entries[i].value.filter(|_| parameters.entries[i].abbreviation) {
                parameters.force_within(value);
            }
        }
        let symbols = parameters.entries.iter_mut().filter(|e| !e.abbreviation && e.number.is_none());
        for (id, entry) in (0..).zip(symbols) {
            entry.symbol = Some(ParameterId(id));
        }
        parameters
    }

    /// The named quantity called `name`.
    pub(super) fn get(&self, name: &str) -> Option<&Entry<'d>> {
        self.position(name).map(|i| &self.entries[i])
    }

    /// Where it stands among the entries.
    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The quantities that are symbols, in the order of their ids.
    pub(super) fn symbols(&self) -> Vec<Parameter> {
        let symbols = self.entries.iter().filter(|e| e.symbol.is_some());
        symbols.filter_map(|e| Some(Parameter { name: e.name.into(), nominal: e.nominal.clone()? })).collect()
    }

    /// All names.
    pub(super) fn names(&self) -> Vec<&'d str> {
        self.entries.iter().map(|e| e.name).collect()
    }

    /// Where the names that stay symbols stand, and where they are used.
    pub(super) fn places_of_symbols(&self) -> Vec<(Span, Vec<Occurrence>)> {
        self.entries.iter().filter(|e| e.symbol.is_some()).map(|e| (e.span, e.uses.clone())).collect()
    }

    /// Warns of names that no expression uses.
    pub(super) fn warn_of_unused(&self, diagnostics: &mut Diagnostics) {
        for entry in self.entries.iter().filter(|e| e.uses.is_empty() && !self.forward.contains(e.name)) {
            let message = format!("nothing uses the parameter `{}`", excerpt(entry.name));
            let help = "use it in an expression, or remove it (and from `regressor`, where its column would be 0)";
            diagnostics.push(Diagnostic::new(Code::UnusedParameter, entry.span, message, "not used", help));
        }
    }

    /// Notes where names stand; reports those that nothing above defines.
    fn note_uses(&mut self, expression: &Expression, role: Role, within: Within<'_>, diagnostics: &mut Diagnostics) {
        for (name, span) in expression.named() {
            match self.by_name.get(name) {
                Some(&i) => self.entries[i].uses.push(Occurrence { span, role }),
                None => {
                    self.forward.extend(self.later.get(name));
                    self.unknown += 1;
                    diagnostics.push(self.unknown(name, span, within));
                }
            }
        }
    }

    fn unknown(&self, name: &str, span: Span, within: Within<'_>) -> Diagnostic {
        let shown = excerpt(name);
        if matches!(name.to_ascii_lowercase().as_str(), "inf" | "infinity" | "nan") {
            let help = "every quantity of an arm is finite; leave the key out where it is optional and unknown";
            return Diagnostic::new(Code::NotFinite, span, format!("`{shown}` is not a finite number"), "not finite", help);
        }
        let guess = || {
            let mut words = self.names();
            words.push("pi");
            did_you_mean(name, &words)
        };
        let help = if within == Within::Parameter(name) {
            "a value may use the names above it, and not its own: write a number".to_owned()
        } else if let Some(meant) = self.spelt_otherwise(name).filter(|_| within.adds_variable(name).is_some()) {
            format!("did you mean `{meant}`? Otherwise define `{shown}` under `parameters`")
        } else if let Some(key) = within.adds_variable(name) {
            format!("the joint variable is added to `{key}` by itself: write what else stands there, its offset, or 0")
        } else if self.later.contains(name) {
            format!("`{shown}` is defined further down: a value may use the names above it; move it up")
        } else if self.unknown > GUESSES {
            format!("define `{shown}` under `parameters`, or correct it")
        } else if let Some(meant) = guess() {
            format!("did you mean `{meant}`? Otherwise define `{shown}` under `parameters`")
        } else if self.entries.is_empty() {
            format!("define it: `parameters: {{{shown}: ...}}`; without definitions an expression knows only `pi`")
        } else {
            let known: Vec<String> = self.names().iter().take(8).map(|n| format!("`{}`", excerpt(n))).collect();
            let more = if self.entries.len() > 8 { ", ..." } else { "" };
            format!("define it under `parameters`, which has {}{more}", known.join(", "))
        };
        Diagnostic::new(Code::UnknownName, span, format!("the name `{shown}` is not defined"), "unknown name", help)
    }

    /// The defined name that differs in capitals and `_` alone.
    fn spelt_otherwise(&self, name: &str) -> Option<&'d str> {
        let letters = |name: &str| name.replace('_', "").to_lowercase();
        self.entries.iter().map(|entry| entry.name).find(|known| letters(known) == letters(name))
    }

    /// Makes numbers of the names in divisors and under roots.
    fn force_within(&mut self, expression: &Expression) {
        let mut found: Vec<(&Expression, Reason)> = Vec::new();
        collect_nonpolynomial(expression, &mut found);
        for (part, reason) in found {
            self.force(part, part.span, reason);
        }
    }

    /// Makes numbers of all names in `expression`, and of the names that they stand for.
    fn force(&mut self, expression: &Expression, at: Span, reason: Reason) {
        let mut pending = vec![expression.names()];
        while let Some(names) = pending.pop() {
            for name in names {
                let Some(&i) = self.by_name.get(name) else { continue };
                let entry = &mut self.entries[i];
                if entry.number.is_none() {
                    entry.number = Some((at, reason));
                    pending.extend(entry.value.filter(|_| entry.abbreviation).map(Expression::names));
                }
            }
        }
    }
}

/// Divisors and arguments of roots.
fn collect_nonpolynomial<'e>(expression: &'e Expression, found: &mut Vec<(&'e Expression, Reason)>) {
    match &expression.kind {
        ExpressionKind::Decimal(_) | ExpressionKind::Pi | ExpressionKind::Name(_) => {}
        ExpressionKind::Negate(a) | ExpressionKind::Degrees(a) | ExpressionKind::InUnit(a, _) => collect_nonpolynomial(a, found),
        ExpressionKind::Root(a) => {
            found.push((a, Reason::Root));
            collect_nonpolynomial(a, found);
        }
        ExpressionKind::Binary(operator, a, b) => {
            collect_nonpolynomial(a, found);
            if *operator == Operator::Divide {
                found.push((b, Reason::Division));
            }
            collect_nonpolynomial(b, found);
        }
    }
}
