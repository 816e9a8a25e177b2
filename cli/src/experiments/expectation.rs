//! What is expected of a run: a quantity, how one number is taken of it, and what that number should be.

use armgen_codegen::document::did_you_mean;
use armgen_codegen::document::yaml::Node;
use armgen_codegen::source::{Span, Spanned};
use armgen_generated::{JOINT_IS_REVOLUTE, JOINT_NAMES};
use armgen_runtime::simulation::Log;

use super::reader::{Allowed, Fields, Reader};

/// One line of the table.
#[derive(Clone, Debug)]
pub(crate) struct Expectation {
    /// A column of the log, or a single number that the run gives.
    pub(crate) quantity: Spanned<String>,
    take: Take,
    target: Target,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Take {
    /// A single number.
    Single,
    /// The value at a time, s.
    At(f64),
    /// The largest absolute value in an interval.
    Peak(f64, f64),
    /// The largest value in an interval.
    Highest(f64, f64),
    /// The smallest value in an interval.
    Lowest(f64, f64),
    /// The rate at which it decays from the beginning to the end of an interval, 1/s.
    Decay(f64, f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Target {
    Near { value: f64, tolerance: f64, percent: Option<f64> },
    AtMost(f64),
    AtLeast(f64),
}

/// What came out, beside what was expected.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) what: String,
    pub(crate) found: String,
    pub(crate) unit: &'static str,
    pub(crate) expected: String,
    pub(crate) met: bool,
}

const TAKES: [&str; 5] = ["at", "peak", "highest", "lowest", "decay"];
const TARGETS: [&str; 5] = ["value", "tolerance", "percent", "at_most", "at_least"];

impl Reader {
    /// The list under `expect`.
    pub(crate) fn expectations(&mut self, fields: &Fields<'_>) -> Vec<Expectation> {
        let Some((at, node)) = fields.get("expect") else { return Vec::new() };
        let help = "write one `- {quantity: ..., ...}` per line";
        let Some(items) = self.items(node, at, "expect", help) else { return Vec::new() };
        if items.is_empty() {
            self.faults.add("empty-list", at, "nothing is expected", "a check that cannot fail", help);
        }
        let items = items.to_vec();
        items.iter().filter_map(|item| self.expectation(item, at)).collect()
    }

    fn expectation(&mut self, node: &Node, at: Span) -> Option<Expectation> {
        let at = if node.span.start < node.span.end { node.span } else { at };
        let optional: Vec<&'static str> = TAKES.iter().chain(&TARGETS).copied().collect();
        let fields = self.mapping(node, "an expectation", at, &["quantity"], &optional)?;
        let quantity = self.word(&fields, "quantity")?;
        let given: Vec<&str> = TAKES.iter().copied().filter(|name| fields.get(name).is_some()).collect();
        let take = match given[..] {
            [] => Take::Single,
            ["at"] => Take::At(self.number(&fields, "at", Allowed::NotNegative)?),
            [name] => {
                let [from, to] = self.array(&fields, name, "begin and end of the interval in s", Allowed::NotNegative)?;
                if from > to {
                    let message = format!("the interval of `{name}` ends before it begins");
                    self.faults.add("empty-interval", fields.place(name), message, "this one", "write the earlier time first");
                    return None;
                }
                match name {
                    "peak" => Take::Peak(from, to),
                    "highest" => Take::Highest(from, to),
                    "lowest" => Take::Lowest(from, to),
                    _ => Take::Decay(from, to),
                }
            }
            _ => {
                let help = format!("write one of {}", TAKES.join(", "));
                self.faults.add("ambiguous", at, "one number is expected, and more than one is named", given.join(" and "), help);
                return None;
            }
        };
        let help = "write `value` with `tolerance` or `percent`, or `at_most`, or `at_least`";
        let get = |reader: &mut Self, name, allowed| reader.number(&fields, name, allowed);
        let value = get(self, "value", Allowed::Any);
        let tolerance = get(self, "tolerance", Allowed::Positive);
        let percent = get(self, "percent", Allowed::Positive);
        let (most, least) = (get(self, "at_most", Allowed::Any), get(self, "at_least", Allowed::Any));
        let target = match (value, tolerance, percent, most, least) {
            (Some(value), Some(tolerance), None, None, None) => Target::Near { value, tolerance, percent: None },
            (Some(value), None, Some(p), None, None) => {
                Target::Near { value, tolerance: value.abs() * p / 100.0, percent: Some(p) }
            }
            (None, None, None, Some(bound), None) => Target::AtMost(bound),
            (None, None, None, None, Some(bound)) => Target::AtLeast(bound),
            _ => {
                if TARGETS.iter().all(|name| fields.get(name).is_none()) || self.faults.is_empty() {
                    self.faults.add("no-target", at, "it is not clear what is expected", "here", help);
                }
                return None;
            }
        };
        Some(Expectation { quantity, take, target })
    }

    /// Checks that the quantities exist: `columns` of the log, `singles` beside it, and that times lie within the run.
    pub(crate) fn check_quantities(&mut self, list: &[Expectation], columns: &[String], singles: &[String], end: f64) {
        for expectation in list {
            let name = &expectation.quantity;
            let single = expectation.take == Take::Single;
            let (known, other) = if single { (singles, columns) } else { (columns, singles) };
            if !known.contains(&name.value) {
                let names: Vec<&str> = known.iter().map(String::as_str).collect();
                let meant = did_you_mean(&name.value, &names).map_or_else(String::new, |m| format!("did you mean `{m}`? "));
                let help = match (other.contains(&name.value), single) {
                    (true, true) => {
                        format!("`{}` changes with time: add `at`, `peak`, `highest`, `lowest` or `decay`", name.value)
                    }
                    (true, false) => format!("`{}` is a single number: remove the time", name.value),
                    _ => format!("{meant}there are: {}", names.join(", ")),
                };
                let message = format!("the run gives no such quantity `{}`", name.value);
                self.faults.add("unknown-quantity", name.span, message, "unknown quantity", help);
            }
            let (Take::At(to) | Take::Peak(_, to) | Take::Highest(_, to) | Take::Lowest(_, to) | Take::Decay(_, to)) =
                expectation.take
            else {
                continue;
            };
            if to > end + 1e-9 {
                let message = format!("the run ends at {end} s, before {to} s");
                self.faults.add(
                    "after-the-end",
                    name.span,
                    message,
                    "expected after the end",
                    "lengthen `duration`, or look earlier",
                );
            }
        }
    }
}

impl Expectation {
    /// What the run gave, in the light of what was expected.
    pub(crate) fn judge(&self, log: &Log, singles: &[(String, f64)]) -> Line {
        let found = self.find(log, singles);
        // As many digits as the tolerance can tell apart.
        let count = match self.target {
            Target::Near { value, tolerance, .. } if value != 0.0 => {
                (2.0 - (tolerance / value.abs()).log10().floor()).clamp(4.0, 15.0) as i32
            }
            // As many as tell it from its bound.
            Target::AtLeast(bound) | Target::AtMost(bound) => {
                (4..15).find(|count| digits(found, *count) != digits(bound, *count)).unwrap_or(15)
            }
            Target::Near { .. } => 7,
        };
        let (met, expected) = match self.target {
            Target::Near { value, tolerance, percent } => {
                let width = percent.map_or_else(|| number(tolerance), |p| format!("{p} %"));
                ((found - value).abs() <= tolerance, format!("{} ± {width}", digits(value, 15)))
            }
            Target::AtMost(bound) => (found <= bound, format!("≤ {}", number(bound))),
            Target::AtLeast(bound) => (found >= bound, format!("≥ {}", number(bound))),
        };
        let name = &self.quantity.value;
        let span = |word: &str, from: f64, to: f64| format!("{word}{name} in [{from}, {to}] s");
        let what = match self.take {
            Take::Single => name.clone(),
            Take::At(t) => format!("{name} at {t} s"),
            Take::Peak(a, b) => format!("max |{name}| in [{a}, {b}] s"),
            Take::Highest(a, b) => span("max ", a, b),
            Take::Lowest(a, b) => span("min ", a, b),
            Take::Decay(a, b) => format!("decay of {name} in [{a}, {b}] s"),
        };
        let unit = if matches!(self.take, Take::Decay(..)) { "1/s" } else { unit(name) };
        Line { what, found: digits(found, count), unit, expected, met }
    }

    fn find(&self, log: &Log, singles: &[(String, f64)]) -> f64 {
        let name = &self.quantity.value;
        if self.take == Take::Single {
            return singles.iter().find(|(known, _)| known == name).map_or(f64::NAN, |(_, value)| *value);
        }
        let Some(column) = log.names().iter().position(|known| known == name) else { return f64::NAN };
        // Half a microsecond: times are multiples of the period, not always representable.
        const SLACK: f64 = 5e-7;
        let at = |t: f64| log.rows().find(|row| row[0] >= t - SLACK).map_or(f64::NAN, |row| row[column]);
        let fold = |from: f64, to: f64, pick: fn(f64, f64) -> f64, of: fn(f64) -> f64| {
            let within = |row: &&[f64]| row[0] >= from - SLACK && row[0] <= to + SLACK;
            let reaches = log.rows().last().is_some_and(|row| row[0] >= to - SLACK);
            let values = log.rows().filter(within).map(|row| of(row[column]));
            // A run that ended early, or a NaN, meets nothing.
            values
                .map(|x| if reaches { x } else { f64::NAN })
                .reduce(|a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { pick(a, b) })
                .unwrap_or(f64::NAN)
        };
        match self.take {
            Take::Single => f64::NAN,
            Take::At(t) => at(t),
            Take::Peak(a, b) => fold(a, b, f64::max, f64::abs),
            Take::Highest(a, b) => fold(a, b, f64::max, |x| x),
            Take::Lowest(a, b) => fold(a, b, f64::min, |x| x),
            Take::Decay(a, b) => (at(a) / at(b)).ln() / (b - a),
        }
    }
}

/// Unit of a quantity by its name; none where it is a pure number, or depends on the rows of the task or on the parameter.
fn unit(name: &str) -> &'static str {
    let last = name.rsplit('.').next().unwrap_or(name);
    let joint = |of: &str, units: [&'static str; 2]| {
        let found = JOINT_NAMES.iter().position(|joint| *joint == of).map(|i| JOINT_IS_REVOLUTE[i]);
        found.map_or("", |revolute| units[usize::from(!revolute)])
    };
    match (last.split_once('_'), last) {
        (_, "stable_period" | "lost_at" | "rate_limited_at" | "ends_at") => "s",
        (_, "x" | "y" | "z" | "distance" | "stops") => "m",
        (_, "angle" | "heading") => "rad",
        (_, "direction_1" | "direction_2") => "deg",
        (_, "speed" | "velocity_step") => "m/s",
        (_, "acceleration") => "m/s²",
        (_, "turn_rate") => "rad/s",
        (_, "turn_acceleration") => "rad/s²",
        (Some(("via", _)), _) => "m",
        (Some(("q" | "eq", of)), _) => joint(of, ["rad", "m"]),
        (Some(("tau", of)), _) => joint(of, ["N m", "N"]),
        (Some(("e", row)), _) => {
            if row.starts_with('r') {
                "rad"
            } else {
                "m"
            }
        }
        _ => "",
    }
}

/// A number with seven digits, as short as they allow.
pub(crate) fn number(x: f64) -> String {
    digits(x, 7)
}

/// A number with so many digits, as short as they allow.
fn digits(x: f64, count: i32) -> String {
    if !x.is_finite() {
        return if x.is_nan() { "none".into() } else { x.to_string() };
    }
    let exponent = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 };
    if (-3..7).contains(&exponent) {
        let text = format!("{x:.*}", (count - 1 - exponent).max(0) as usize);
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        let text = format!("{x:.*e}", count as usize - 1);
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits };
        format!("{digits}e{power}")
    }
}

#[cfg(test)]
mod tests {
    use super::{number, unit};

    #[test]
    fn units_follow_names() {
        for (name, expected) in [
            ("e_rz", "rad"),
            ("e_z", "m"),
            ("stable_period", "s"),
            ("q1.direction_2", "deg"),
            ("q1.z", "m"),
            ("z_norm", ""),
            ("radius", ""),
            ("via_12", "m"),
            ("estimate_m", ""),
        ] {
            assert_eq!(unit(name), expected, "{name}");
        }
    }

    #[test]
    fn numbers_keep_seven_digits() {
        for (x, text) in [
            (0.0, "0"),
            (7.19, "7.19"),
            (0.000_244_4, "2.444e-4"),
            (0.999_996, "0.999996"),
            (-1.0904e-3, "-0.0010904"),
            (1234567.0, "1234567"),
            (12345678.0, "1.234568e7"),
            (f64::NAN, "none"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(x), text);
        }
    }
}
