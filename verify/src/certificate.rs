//! The certificate of a generated module, `robot.cert.json`: the verified facts and the exact values of all literals. With it, anybody
//! can verify the module again without the generator.

pub mod report;

use std::collections::BTreeMap;

use serde_derive::{Deserialize, Serialize};
use serde_json::Value;

use crate::certificate::report::{Exact, Report, Verdict};
use crate::floats::bounds::two_digits;
use crate::read::claims::Claims;
use crate::read::reader::Module;
use crate::values::check::Check;
use crate::values::enclosure::bits_before_the_point;
use crate::values::formula::definitions::{self, Definitions};

/// A certificate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// Version of this format.
    pub certificate: u32,
    /// Program and version that made it.
    pub made_by: String,
    /// Name of the robot.
    pub robot: String,
    /// Generation options that are readable from the module.
    pub options: BTreeMap<String, String>,
    /// The box of the error bounds: lowest and highest value of each argument's entries, as decimals that are exactly these floats.
    pub rounding_box: BTreeMap<String, Vec<(String, String)>>,
    /// The description.
    pub input: Text,
    /// The module.
    pub output: Text,
    /// Whether all checks have passed.
    pub verified: bool,
    /// Faults of the whole module.
    pub faults: Vec<String>,
    /// Formulas used by exact values of literals, each using only earlier ones: its number, as in `k0`, and the formula.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub definitions: Vec<(usize, String)>,
    /// Functions.
    pub functions: Vec<FunctionEntry>,
    /// Constants.
    pub constants: Vec<ConstantEntry>,
    /// Identities.
    pub identities: Vec<IdentityEntry>,
}

/// A text, identified by its hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Text {
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

/// A function.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FunctionEntry {
    /// Its name.
    pub name: String,
    /// `equal`, or the fault and its place.
    pub verdict: String,
    /// Number of random points in prime fields.
    pub points: usize,
    /// Number of random rational points.
    pub exact_points: usize,
    /// Upper bound on the odds that a wrong function passes: `2^-200`.
    pub odds_of_a_miss: String,
    /// Upper bound on the distance of computed from exact entries over the box, by rounding.
    pub error_bound: String,
    /// The bound holds if no divisor is smaller than this; absent if the function has no division.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub smallest_divisor: Option<String>,
    /// For accelerations: they are exact for torques with an error of at most the first number plus the second times the largest acceleration.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub torque_error: Option<(String, String)>,
    /// Literals in the order of the text, each with its exact value.
    pub literals: Vec<(String, String)>,
}

/// A constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConstantEntry {
    /// Its name.
    pub name: String,
    /// `equal`, or the fault and its place.
    pub verdict: String,
    /// Its numbers, each with its exact value.
    pub literals: Vec<(String, String)>,
}

/// An identity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentityEntry {
    /// The identity as a formula.
    pub identity: String,
    /// `holds`, `does not hold`, or the reason why it was not checked.
    pub verdict: String,
    /// Number of random points in prime fields.
    pub points: usize,
}

/// The format version of written certificates.
const FORMAT: u32 = 1;

/// The maximum length of a certificate, in bytes; that of a chain of 32 joints takes an eighth.
pub const LONGEST: usize = 32 << 20;

/// Maximum number of listed differences.
const MOST_NAMED: usize = 8;

fn literals(exact: &[Exact]) -> Vec<(String, String)> {
    exact.iter().map(|e| (e.literal.clone(), e.value.to_string())).collect()
}

/// Lists the places where two values differ; objects in lists are identified by name.
fn compare(given: &Value, found: &Value, place: String, into: &mut Vec<String>) {
    match (given, found) {
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => {
            for (key, given) in a {
                compare(given, &b[key], format!("{place}{}{key}", if place.is_empty() { "" } else { "." }), into);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, (given, found)) in a.iter().zip(b).enumerate() {
                let name = found.get("name").or_else(|| found.get("identity")).and_then(Value::as_str);
                compare(given, found, name.map_or_else(|| format!("{place}[{i}]"), |name| format!("{place}[{name}]")), into);
            }
        }
        (given, found) if given != found => {
            let short = |value: &Value| {
                let text = value.to_string();
                match text.char_indices().nth(60) {
                    None => text,
                    Some((end, _)) => format!("{}...", &text[..end]),
                }
            };
            into.push(format!("the certificate says {place}: {}, the checker finds {}", short(given), short(found)));
        }
        _ => {}
    }
}

impl Certificate {
    /// The certificate of a report.
    pub fn of(report: &Report) -> Certificate {
        let functions = report.functions.iter().map(|f| FunctionEntry {
            name: f.name.clone(),
            verdict: f.verdict.to_string(),
            points: f.points,
            exact_points: f.exact_points,
            odds_of_a_miss: if f.verdict == Verdict::Equal { format!("2^{:.0}", f.log2_odds.ceil()) } else { String::new() },
            error_bound: f.bound.as_ref().map_or(String::new(), |bound| two_digits(bound.largest())),
            torque_error: f
                .bound
                .as_ref()
                .and_then(|bound| bound.residual)
                .map(|r| (two_digits(r.constant), two_digits(r.factor))),
            smallest_divisor: f.bound.as_ref().and_then(|bound| bound.smallest_divisor.map(two_digits)),
            literals: literals(&f.literals),
        });
        let constants = report.constants.iter().map(|c| ConstantEntry {
            name: c.name.clone(),
            verdict: c.verdict.to_string(),
            literals: literals(&c.literals),
        });
        let identities = report.identities.iter().map(|i| IdentityEntry {
            identity: i.name.clone(),
            verdict: match &i.holds {
                Ok(true) => "holds".into(),
                Ok(false) => "does not hold".into(),
                Err(why) => format!("not checked: {why}"),
            },
            points: i.points,
        });
        let literals = report.functions.iter().flat_map(|f| &f.literals).chain(report.constants.iter().flat_map(|c| &c.literals));
        let values = literals.map(|exact| &exact.value);
        Certificate {
            certificate: FORMAT,
            made_by: format!("armgen {}", env!("CARGO_PKG_VERSION")),
            robot: report.robot.clone(),
            options: [("scalar", &report.scalar), ("trig", &report.trig)]
                .into_iter()
                .filter(|(_, value)| !value.is_empty())
                .map(|(name, value)| (name.to_string(), value.clone()))
                .collect(),
            rounding_box: [
                ("q", &report.domain.q),
                ("dq", &report.domain.dq),
                ("ddq", &report.domain.ddq),
                ("dqr", &report.domain.dqr),
                ("ddqr", &report.domain.ddqr),
                ("tau", &report.domain.tau),
                ("pi", &report.domain.pi),
            ]
            .into_iter()
            .map(|(name, entries)| {
                (name.to_string(), entries.iter().map(|(low, high)| (low.to_string(), high.to_string())).collect())
            })
            .collect(),
            input: Text { sha256: report.input.clone() },
            output: Text { sha256: report.output.clone() },
            verified: report.passed(),
            faults: report.faults.clone(),
            definitions: definitions::of(values).iter().map(|d| (d.index(), d.formula().to_string())).collect(),
            functions: functions.collect(),
            constants: constants.collect(),
            identities: identities.collect(),
        }
    }

    /// The certificate as text.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a certificate has text keys only");
        text.push('\n');
        text
    }

    /// Reads a certificate. The text must equal the output of [`to_json`](Certificate::to_json), which excludes duplicate and extra keys.
    pub fn from_json(text: &str) -> Result<Certificate, String> {
        if text.len() > LONGEST && Check::Length.is_made() {
            return Err(format!("the certificate is longer than {} MiB", LONGEST >> 20));
        }
        let certificate: Certificate = serde_json::from_str(text).map_err(|e| format!("the certificate cannot be read: {e}"))?;
        if certificate.certificate != FORMAT && Check::Format.is_made() {
            return Err(format!("the certificate has format {}, this program reads {FORMAT}", certificate.certificate));
        }
        let written = if Check::Form.is_made() { certificate.to_json() } else { text.to_string() };
        match text.lines().zip(written.lines()).position(|(found, wanted)| found != wanted) {
            None if written == text => Ok(certificate),
            at => {
                let line = at.unwrap_or(text.lines().count().min(written.lines().count())) + 1;
                Err(format!(
                    "line {line} of the certificate is not as armgen writes it: `armgen generate --verify` writes it again"
                ))
            }
        }
    }

    /// The claimed exact values of a module's literals. An error lists faults that need no computation: other texts, functions or
    /// literals, or values that do not round to their literals.
    pub fn claims_for(&self, module: &Module, input: &str, output: &str) -> Result<Claims, Vec<String>> {
        let mut faults = Vec::new();
        if self.input.sha256 != input && Check::Input.is_made() {
            faults.push("the certificate is of another description: its hash of the input differs".into());
        }
        if self.output.sha256 != output && Check::Output.is_made() {
            faults.push("the certificate is of another module: its hash of the output differs".into());
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let listed = self.functions.iter().map(|entry| (&entry.name, entry.literals.iter().map(|(literal, _)| literal)));
        let there = module.programs().map(|(name, program)| (name, program.literals.iter().map(|literal| &literal.text)));
        let mut fits = self.functions.len() == module.programs().count();
        for ((claimed, of_claims), (name, literals)) in listed.zip(there) {
            fits &= *claimed == name && of_claims.eq(literals);
        }
        if !fits && Check::Lists.is_made() {
            return Err(vec!["the certificate lists other functions or literals than the module has".into()]);
        }
        let claims = self.claims().map_err(|fault| vec![format!("the certificate: {fault}")])?;
        match claims.misfit(module).filter(|_| Check::Fits.is_made()) {
            Some(fault) => Err(vec![format!("the certificate: {fault}")]),
            None => Ok(claims),
        }
    }

    /// The differences from `found`, a new certificate for the same texts, each with its place.
    pub fn differences(&self, found: &Certificate) -> Vec<String> {
        let value = |certificate: &Certificate| serde_json::to_value(certificate).unwrap_or_default();
        let mut all = Vec::new();
        if !Check::Differences.is_made() {
            return all;
        }
        compare(&value(self), &value(found), String::new(), &mut all);
        let more = all.len().saturating_sub(MOST_NAMED);
        all.truncate(MOST_NAMED);
        if more > 0 {
            all.push(format!("the certificate differs in {more} more places"));
        }
        all
    }

    /// The claimed exact values of literals.
    pub fn claims(&self) -> Result<Claims, String> {
        let of = |name: &str, literals: &[(String, String)]| {
            (name.to_string(), literals.iter().map(|(_, value)| value.clone()).collect::<Vec<String>>())
        };
        let functions = self.functions.iter().map(|f| of(&f.name, &f.literals));
        let lists: Vec<(String, Vec<String>)> =
            functions.chain(self.constants.iter().map(|c| of(&c.name, &c.literals))).collect();
        let mut definitions = Definitions::default();
        for (index, text) in &self.definitions {
            definitions.define(*index, text, bits_before_the_point)?;
        }
        Claims::with_definitions(lists.iter().map(|(name, texts)| (name.as_str(), texts.as_slice())), &definitions)
    }
}
