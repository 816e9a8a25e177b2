//! The certificate beside a generated module, `robot.cert.json`: what was verified, and the exact values of all literals, so that anybody can
//! verify again without the generator.

use std::collections::BTreeMap;

use serde_derive::{Deserialize, Serialize};

use crate::bounds::two_digits;
use crate::claims::Claims;
use crate::formula::definitions::{self, Definitions};
use crate::report::{Exact, Report, Verdict};

/// A certificate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Version of this format.
    pub certificate: u32,
    /// Program and version that made it.
    pub made_by: String,
    /// Name of the robot.
    pub robot: String,
    /// Options of the generation that can be read from the text.
    pub options: BTreeMap<String, String>,
    /// The box that error bounds are stated over: lowest and highest value of each argument's entries, as decimals that are these floats.
    pub rounding_box: BTreeMap<String, Vec<(String, String)>>,
    /// The description.
    pub input: Text,
    /// The module.
    pub output: Text,
    /// Whether all that follows is as it should be.
    pub verified: bool,
    /// What is wrong with the whole.
    pub faults: Vec<String>,
    /// Formulas that the exact values of literals refer to, each only to those before it: number, as in `k0`, and formula.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub definitions: Vec<(usize, String)>,
    /// Functions.
    pub functions: Vec<FunctionEntry>,
    /// Constants.
    pub constants: Vec<ConstantEntry>,
    /// Identities.
    pub identities: Vec<IdentityEntry>,
}

/// A text by its hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

/// A function.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FunctionEntry {
    /// Its name.
    pub name: String,
    /// `equal`, or what is wrong and where.
    pub verdict: String,
    /// Random points in prime fields.
    pub points: usize,
    /// Random rational points.
    pub exact_points: usize,
    /// Upper bound of the odds that a wrong function passes: `2^-200`.
    pub odds_of_a_miss: String,
    /// How far rounding can take any entry from the exact one, anywhere in the box.
    pub error_bound: String,
    /// The bound holds where no divisor is smaller than this, if the function divides.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub smallest_divisor: Option<String>,
    /// Of accelerations: they are those at torques off by at most the first number plus the second times the largest of them.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub torque_error: Option<(String, String)>,
    /// Literals in the order of the text, each with its exact value.
    pub literals: Vec<(String, String)>,
}

/// A constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstantEntry {
    /// Its name.
    pub name: String,
    /// `equal`, or what is wrong and where.
    pub verdict: String,
    /// Its numbers, each with its exact value.
    pub literals: Vec<(String, String)>,
}

/// An identity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IdentityEntry {
    /// The identity as a formula.
    pub identity: String,
    /// `holds`, `does not hold`, or why it was not checked.
    pub verdict: String,
    /// Random points in prime fields.
    pub points: usize,
}

/// The version that is written.
const FORMAT: u32 = 1;

fn literals(exact: &[Exact]) -> Vec<(String, String)> {
    exact.iter().map(|e| (e.literal.clone(), e.value.to_string())).collect()
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

    /// Reads a certificate.
    pub fn from_json(text: &str) -> Result<Certificate, String> {
        let certificate: Certificate = serde_json::from_str(text).map_err(|e| format!("the certificate cannot be read: {e}"))?;
        if certificate.certificate != FORMAT {
            return Err(format!("the certificate has format {}, this program reads {FORMAT}", certificate.certificate));
        }
        Ok(certificate)
    }

    /// The exact values that it claims for literals.
    pub fn claims(&self) -> Result<Claims, String> {
        let of = |name: &str, literals: &[(String, String)]| {
            (name.to_string(), literals.iter().map(|(_, value)| value.clone()).collect::<Vec<String>>())
        };
        let functions = self.functions.iter().map(|f| of(&f.name, &f.literals));
        let lists: Vec<(String, Vec<String>)> =
            functions.chain(self.constants.iter().map(|c| of(&c.name, &c.literals))).collect();
        let mut definitions = Definitions::default();
        for (index, text) in &self.definitions {
            definitions.define(*index, text)?;
        }
        Claims::with_definitions(lists.iter().map(|(name, texts)| (name.as_str(), texts.as_slice())), &definitions)
    }
}
