//! What the checker found.

use std::fmt;

use crate::bounds::Bound;
use crate::check::Check;
use crate::formula::Formula;
use crate::ranges::Domain;

/// Why a function is useless in floats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// A value can leave the scalar: within the limits of the joints, or at one state of the box.
    Leaves(String),
    /// Rounding makes errors that the equations do not ask for.
    Loses(String),
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Unfit::Leaves(why) | Unfit::Loses(why)) = self;
        f.write_str(why)
    }
}

/// What is not known by odds of a miss of at most 2^-168 is not verified: 2^40 tries of somebody who looks for a miss leave 2^-128.
pub const MOST_LOG2_ODDS: f64 = -168.0;

/// What is said of a function or a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It equals the equations.
    Equal,
    /// It does not: the first entry that differs, and how.
    Different {
        /// Where: `[0][1]`, `.inertia[0][1]`.
        entry: String,
        /// What stands there and what should.
        why: String,
    },
    /// It is not what the checker can read, or is missing, or is not known.
    Refused(String),
}

/// A literal and the exact value that it stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exact {
    /// Its digits.
    pub literal: String,
    /// The exact value.
    pub value: Formula,
}

/// What is said of a function.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionReport {
    /// Its name.
    pub name: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Random points in prime fields at which it was run.
    pub points: usize,
    /// Random rational points at which it was run.
    pub exact_points: usize,
    /// log2 of the odds that a function which differs from the equations passes at all points of the prime fields.
    pub log2_odds: f64,
    /// Its literals in the order of the text.
    pub literals: Vec<Exact>,
    /// How far rounding can take its entries from the exact ones over the box, where it equals the equations.
    pub bound: Option<Bound>,
    /// Why it is useless in floats although it equals the equations, if it is ([`mod@crate::rounding`]).
    pub unfit: Option<Unfit>,
}

/// What is said of a constant.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantReport {
    /// Its name.
    pub name: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Exact values of its numbers, in order.
    pub literals: Vec<Exact>,
}

/// An identity among the functions of the module.
#[derive(Clone, Debug, PartialEq)]
pub struct IdentityReport {
    /// The identity as a formula.
    pub name: String,
    /// Whether it holds at all points, or why that was not tried.
    pub holds: Result<bool, String>,
    /// Points in prime fields.
    pub points: usize,
}

/// All that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Name of the robot.
    pub robot: String,
    /// `f64` or `f32`.
    pub scalar: String,
    /// `libm`, `std` or `fast`; empty where no sines are asked for.
    pub trig: String,
    /// Hash of the description's text (SHA-256, hexadecimal).
    pub input: String,
    /// Hash of the module's text.
    pub output: String,
    /// What is wrong with the whole. No functions are reported where a text cannot be read; they are where a certificate does not fit.
    pub faults: Vec<String>,
    /// Constants.
    pub constants: Vec<ConstantReport>,
    /// Functions in the order of the text, missing ones last.
    pub functions: Vec<FunctionReport>,
    /// Identities.
    pub identities: Vec<IdentityReport>,
    /// The box that error bounds are stated over.
    pub domain: Domain,
}

impl Report {
    /// A report on texts with these hashes, with nothing in it.
    pub fn of(input: String, output: String) -> Report {
        Report {
            robot: String::new(),
            scalar: String::new(),
            trig: String::new(),
            input,
            output,
            faults: Vec::new(),
            constants: Vec::new(),
            functions: Vec::new(),
            identities: Vec::new(),
            domain: Domain::default(),
        }
    }

    /// Whether everything equals the equations.
    pub fn passed(&self) -> bool {
        !self.functions.is_empty() && self.first_fault().is_none()
    }

    /// The function of which alone is wrong that a value of it can leave the scalar: not its fault, but that of the limits.
    pub fn beyond_the_scalar(&self) -> Option<&str> {
        let leaves = |f: &&FunctionReport| matches!(f.unfit, Some(Unfit::Leaves(_)));
        let first = self.functions.iter().find(leaves)?;
        let mut others = self.clone();
        others.functions.iter_mut().filter(|f| leaves(&&**f)).for_each(|f| f.unfit = None);
        others.passed().then_some(first.name.as_str())
    }

    /// The first thing that is wrong: a function or a constant with the entry, the whole, or an identity.
    pub fn first_fault(&self) -> Option<String> {
        let named = |name: &str, verdict: &Verdict| match verdict {
            Verdict::Equal => None,
            Verdict::Different { entry, why } => Some(format!("{name}{entry}: {why}")),
            Verdict::Refused(why) => Some(format!("{name}: {why}")),
        };
        let identity = |i: &IdentityReport| match &i.holds {
            _ if !Check::Identities.is_made() => None,
            Ok(true) => None,
            Ok(false) => Some(format!("{} does not hold", i.name)),
            Err(why) => Some(format!("{}: not checked, {why}", i.name)),
        };
        let constants = self.constants.iter().filter_map(|c| named(&c.name, &c.verdict));
        let uncertain = |f: &FunctionReport| {
            f.is_uncertain().then(|| format!("{}: the odds of a miss are 2^{:.0}", f.name, f.log2_odds.ceil()))
        };
        let unfit = |f: &FunctionReport| f.unfit.as_ref().map(|why| format!("{}: {why}", f.name));
        let of_function = |f: &FunctionReport| named(&f.name, &f.verdict).or_else(|| uncertain(f)).or_else(|| unfit(f));
        let functions = self.functions.iter().filter_map(of_function);
        let identities = self.identities.iter().filter_map(identity);
        functions.chain(constants).chain(self.faults.iter().cloned()).chain(identities).next()
    }
}

impl FunctionReport {
    /// Whether it could be found equal by chance.
    pub fn is_uncertain(&self) -> bool {
        self.verdict == Verdict::Equal && self.log2_odds > MOST_LOG2_ODDS && Check::Odds.is_made()
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Equal => f.write_str("equal"),
            Verdict::Different { entry, why } if entry.is_empty() => write!(f, "DIFFERENT: {why}"),
            Verdict::Different { entry, why } => write!(f, "DIFFERENT in entry {entry}: {why}"),
            Verdict::Refused(why) => write!(f, "REFUSED: {why}"),
        }
    }
}

/// A table for people.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The scalar is known of a text that could be read.
        let scalar = if self.scalar.is_empty() { String::new() } else { format!(", {}", self.scalar) };
        writeln!(f, "robot {}{scalar}", self.robot)?;
        for fault in &self.faults {
            writeln!(f, "FAULT: {fault}")?;
        }
        let width = self.functions.iter().map(|r| r.name.len()).chain([24]).max().unwrap_or(24);
        if !self.functions.is_empty() {
            writeln!(f, "{:width$}  verdict  points: modular  rational  odds of a miss  rounding error", "function")?;
        }
        let underflow = if self.scalar == "f32" { 1e-36 } else { 1e-300 };
        for report in &self.functions {
            write!(f, "{:width$}  {}", report.name, report.verdict)?;
            if report.verdict == Verdict::Equal {
                let odds = format!("2^{:.0}", report.log2_odds.ceil());
                let error = report.bound.as_ref().map_or_else(String::new, |bound| match bound.largest() {
                    // Products of tiny numbers alone: the value is 0.
                    largest if largest > 0.0 && largest < underflow => "none".into(),
                    _ => bound.short(),
                });
                write!(f, "    {:15}  {:8}  {odds:<14}  {error}", report.points, report.exact_points)?;
            }
            writeln!(f)?;
            if let Some(why) = &report.unfit {
                writeln!(f, "{:width$}  UNFIT for {}: {why}", "", self.scalar)?;
            }
        }
        for report in self.constants.iter().filter(|c| c.verdict != Verdict::Equal) {
            writeln!(f, "{:width$}  {}", report.name, report.verdict)?;
        }
        let without: Vec<&str> = self
            .functions
            .iter()
            .filter(|f| f.verdict == Verdict::Equal && f.exact_points == 0)
            .map(|f| f.name.as_str())
            .collect();
        if !without.is_empty() {
            writeln!(f, "at no rational point, prime fields alone: {}", without.join(", "))?;
        }
        if self.functions.iter().any(|f| f.bound.is_some()) {
            let of = "how far rounding can take an entry within the limits, in the entry's own unit (m, rad, N m, ...)";
            writeln!(f, "rounding error: {of}; none where it is exact")?;
        }
        let equal = self.constants.iter().filter(|c| c.verdict == Verdict::Equal).count();
        writeln!(f, "{equal} constants equal the description")?;
        for report in &self.identities {
            match &report.holds {
                Ok(true) => writeln!(f, "holds at {} points: {}", report.points, report.name)?,
                Ok(false) => writeln!(f, "DOES NOT HOLD: {}", report.name)?,
                Err(why) => writeln!(f, "NOT CHECKED: {}: {why}", report.name)?,
            }
        }
        write!(f, "{}", if self.passed() { "verified" } else { "NOT verified" })
    }
}
