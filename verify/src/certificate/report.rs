//! The findings of the checker.

use std::fmt;

use crate::floats::bounds::Bound;
use crate::values::check::Check;
use crate::values::formula::Formula;
use crate::values::ranges::Domain;

/// Reasons why a correct function is unusable in floats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// A value can exceed the scalar's range within the joint limits, or at a state of the box.
    Leaves(String),
    /// Rounding causes larger errors than the equations justify.
    Loses(String),
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Unfit::Leaves(why) | Unfit::Loses(why)) = self;
        f.write_str(why)
    }
}

/// Larger odds of a miss do not verify a function: 2^40 attempts of an adversary at 2^-168 leave 2^-128.
pub const MOST_LOG2_ODDS: f64 = -168.0;

/// The verdict on a function or a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It equals the equations.
    Equal,
    /// It differs: the first differing entry, and the difference.
    Different {
        /// Its place: `[0][1]`, `.inertia[0][1]`.
        entry: String,
        /// The found and the expected value.
        why: String,
    },
    /// It is unreadable, missing, or unknown.
    Refused(String),
}

/// A literal with its exact value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exact {
    /// Its digits.
    pub literal: String,
    /// The exact value.
    pub value: Formula,
}

/// The findings about a function.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionReport {
    /// Its name.
    pub name: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Number of random points in prime fields.
    pub points: usize,
    /// Number of random rational points.
    pub exact_points: usize,
    /// log2 of the odds that a wrong function passes at all points of the prime fields.
    pub log2_odds: f64,
    /// Its literals in the order of the text.
    pub literals: Vec<Exact>,
    /// Bound on the distance of its entries from the exact ones over the box, if it equals the equations.
    pub bound: Option<Bound>,
    /// The reason why it is unusable in floats although it equals the equations, if any ([`mod@crate::judge::rounding`]).
    pub unfit: Option<Unfit>,
}

/// The findings about a constant.
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
    /// Whether it holds at all points, or the reason why it was not checked.
    pub holds: Result<bool, String>,
    /// Number of points in prime fields.
    pub points: usize,
}

/// All findings.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Name of the robot.
    pub robot: String,
    /// `f64` or `f32`.
    pub scalar: String,
    /// `libm`, `std` or `fast`; empty without sines.
    pub trig: String,
    /// SHA-256 of the description's text, hexadecimal.
    pub input: String,
    /// SHA-256 of the module's text, hexadecimal.
    pub output: String,
    /// Faults of the whole. An unreadable text has no reports of functions; a certificate that does not match leaves them in place.
    pub faults: Vec<String>,
    /// Constants.
    pub constants: Vec<ConstantReport>,
    /// Functions in the order of the text, missing ones last.
    pub functions: Vec<FunctionReport>,
    /// Functions that the head of the module does not ask for, and that the arm has.
    pub left_out: Vec<String>,
    /// Identities.
    pub identities: Vec<IdentityReport>,
    /// The box of the error bounds.
    pub domain: Domain,
}

impl Report {
    /// An empty report on texts with these hashes.
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
            left_out: Vec::new(),
            identities: Vec::new(),
            domain: Domain::default(),
        }
    }

    /// Whether everything equals the equations.
    pub fn passed(&self) -> bool {
        !self.functions.is_empty() && self.first_fault().is_none()
    }

    /// The only faulty function, if its only fault is that a value exceeds the scalar's range: the limits cause this, not the function.
    pub fn beyond_the_scalar(&self) -> Option<&str> {
        let leaves = |f: &&FunctionReport| matches!(f.unfit, Some(Unfit::Leaves(_)));
        let first = self.functions.iter().find(leaves)?;
        let mut others = self.clone();
        others.functions.iter_mut().filter(|f| leaves(&&**f)).for_each(|f| f.unfit = None);
        others.passed().then_some(first.name.as_str())
    }

    /// The first fault: a function or constant with its entry, the whole module, or an identity.
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
    /// Whether chance could explain that it was found equal.
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

/// A readable table.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The scalar is known if the text is readable.
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
        if !self.left_out.is_empty() {
            writeln!(f, "not asked for, and not in the module: {}", self.left_out.join(", "))?;
        }
        write!(f, "{}", if self.passed() { "verified" } else { "NOT verified" })
    }
}
