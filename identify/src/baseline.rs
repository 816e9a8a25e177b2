//! What a written file keeps of its identification, so that the file alone judges a later log: of each joint the delay and the spread of the
//! residual.
//!
//! ```text
//! # identified joint base: delay 4.02 ms, residual 0.2118 N m
//! # identified joint elbow: locked
//! ```
//!
//! Found from the judged log itself, a delay would hide a late clock, and a spread the contacts that widen it.

use armgen_codegen::document::excerpt;
use armgen_codegen::source::Source;

use crate::arm::Arm;
use crate::finding::{Code, Finding};

/// How each line begins.
const START: &str = "# identified joint ";

/// What stands for the numbers of a joint that was locked.
const LOCKED: &str = "locked";

/// Of each joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Baseline {
    /// Torque behind position, s.
    pub delays: Vec<f64>,
    /// Robust standard deviation of the residual, N m or N; infinite for a joint that was locked.
    pub spreads: Vec<f64>,
}

fn unit(arm: &Arm, joint: usize) -> &'static str {
    if arm.joints[joint].slides {
        "N"
    } else {
        "N m"
    }
}

/// A positive number with four significant digits.
fn four_digits(x: f64) -> String {
    let decimals = (3.0 - x.abs().max(1e-300).log10().floor()).clamp(0.0, 15.0) as usize;
    format!("{x:.decimals$}")
}

impl Baseline {
    /// A text with these lines at its end, in place of those that it has.
    pub fn written(&self, arm: &Arm, text: &str) -> String {
        let end = if text.contains("\r\n") { "\r\n" } else { "\n" };
        let mut new: String = text.split_inclusive('\n').filter(|line| !line.starts_with(START)).collect();
        if !new.is_empty() && !new.ends_with('\n') {
            new += end;
        }
        for (j, joint) in arm.joints.iter().enumerate() {
            // No zero has a sign.
            if self.spreads[j].is_infinite() {
                new += &format!("{START}{}: {LOCKED}{end}", joint.name);
                continue;
            }
            let (delay, spread) = ((1e5 * self.delays[j]).round() / 100.0 + 0.0, four_digits(self.spreads[j]));
            new += &format!("{START}{}: delay {delay:.2} ms, residual {spread} {}{end}", joint.name, unit(arm, j));
        }
        new
    }

    /// Those of a description; none where it has no such line.
    ///
    /// # Errors
    ///
    /// A line is faulty or missing.
    pub fn read(source: &Source, arm: &Arm) -> Result<Option<Baseline>, Finding> {
        let mut found = Baseline { delays: Vec::new(), spreads: Vec::new() };
        let mut last = 0;
        let fault = |line: usize, at: usize, text: String| {
            let help = "write the line as `armgen identify --out` does, or remove all such lines: then the judged log gives delays and spreads";
            Finding::new(Code::BadBaseline, source.name(), text, help).at(line, at)
        };
        for (place, line) in source.text().lines().enumerate().filter(|(_, line)| line.starts_with(START)) {
            last = place + 1;
            let joint = found.delays.len();
            let Some(name) = arm.joints.get(joint).map(|joint| joint.name.as_str()) else {
                return Err(fault(last, 1, "the arm has no further joint".to_owned()));
            };
            let Some(rest) = line[START.len()..].strip_prefix(&format!("{name}: ")) else {
                return Err(fault(last, START.len() + 1, format!("joint `{}` is expected here", excerpt(name))));
            };
            if rest == LOCKED {
                found.delays.push(0.0);
                found.spreads.push(f64::INFINITY);
                continue;
            }
            let of_residual = format!(" {}", unit(arm, joint));
            let units = [" ms", of_residual.as_str()];
            let mut numbers = [0.0; 2];
            let mut at = line.len() - rest.len();
            let mut parts = rest.split(", ");
            for (k, key) in ["delay ", "residual "].into_iter().enumerate() {
                let part = parts.next().unwrap_or("");
                let number = part.strip_prefix(key).and_then(|part| part.strip_suffix(units[k])).and_then(|x| x.parse().ok());
                let is_good = |x: &f64| x.is_finite() && if k == 0 { x.abs() <= 1e3 } else { *x > 0.0 };
                numbers[k] = number.filter(is_good).ok_or_else(|| {
                    let range = ["at most 1000 in size", "above 0"][k];
                    fault(last, at + 1, format!("`{}` is not `{key}NUMBER{}`, with a number {range}", excerpt(part), units[k]))
                })?;
                at += part.len() + 2;
            }
            if let Some(more) = parts.next() {
                return Err(fault(last, at + 1, format!("`{}` is not expected here", excerpt(more))));
            }
            found.delays.push(1e-3 * numbers[0]);
            found.spreads.push(numbers[1]);
        }
        match arm.joints.get(found.delays.len()) {
            _ if last == 0 => Ok(None),
            Some(joint) => Err(fault(last, 0, format!("no line of joint `{}` follows", excerpt(&joint.name)))),
            None => Ok(Some(found)),
        }
    }
}
