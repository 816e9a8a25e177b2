//! Comparison of results with expectations.

use crate::model::{digits, number, Expectation, Record, Take, Target, Unit};

/// A row of the table of results.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The quantity and its evaluation: `max |e_z| in [5, 20] s`.
    pub what: String,
    /// The name of the quantity.
    pub name: String,
    /// Explanation in words; empty if the row concerns no quantity.
    pub meaning: &'static str,
    /// The measured value, formatted.
    pub found: String,
    /// Its unit.
    pub unit: Unit,
    /// The expected value or bound, formatted.
    pub expected: String,
    /// Whether the expectation is met.
    pub met: bool,
}

impl Line {
    /// A row for an unmet condition that is not a number.
    pub fn unmet(what: &str, found: String, expected: &str) -> Line {
        Line {
            what: what.into(),
            name: String::new(),
            meaning: "",
            found,
            unit: Unit::None,
            expected: expected.into(),
            met: false,
        }
    }
}

/// Compares an expectation with the record of a run.
pub fn judge(expectation: &Expectation, record: &Record) -> Line {
    let Expectation { channel, take, target } = expectation;
    let found = find(expectation, record);
    // As many digits as the tolerance resolves.
    let count = match *target {
        Target::Near { value, tolerance, .. } if value != 0.0 => {
            (2.0 - (tolerance / value.abs()).log10().floor()).clamp(4.0, 15.0) as i32
        }
        // As many digits as distinguish it from its bound.
        Target::AtLeast(bound) | Target::AtMost(bound) => {
            (4..15).find(|count| digits(found, *count) != digits(bound, *count)).unwrap_or(15)
        }
        Target::Near { .. } => 7,
    };
    let (met, expected) = match *target {
        Target::Near { value, tolerance, percent } => {
            let width = percent.map_or_else(|| number(tolerance), |p| format!("{p} %"));
            ((found - value).abs() <= tolerance, format!("{} ± {width}", digits(value, 15)))
        }
        Target::AtMost(bound) => (found <= bound, format!("≤ {}", number(bound))),
        Target::AtLeast(bound) => (found >= bound, format!("≥ {}", number(bound))),
    };
    let name = &channel.name;
    let what = match *take {
        Take::Number => name.clone(),
        Take::At(t) => format!("{name} at {t} s"),
        Take::Peak(a, b) => format!("max |{name}| in [{a}, {b}] s"),
        Take::Highest(a, b) => format!("max {name} in [{a}, {b}] s"),
        Take::Lowest(a, b) => format!("min {name} in [{a}, {b}] s"),
        Take::Decay(a, b) => format!("decay of {name} in [{a}, {b}] s"),
    };
    let unit = if matches!(take, Take::Decay(..)) { Unit::PerSecond } else { channel.unit };
    let (name, meaning) = (name.clone(), channel.quantity.meaning());
    Line { what, name, meaning, found: digits(found, count), unit, expected, met }
}

/// The value for an expectation; NaN if the record has no such value, which meets no expectation.
fn find(Expectation { channel, take, .. }: &Expectation, record: &Record) -> f64 {
    // Half a microsecond: times are multiples of the period, which may have no exact representation.
    const SLACK: f64 = 5e-7;
    let log = record.log();
    let column = record.channels().iter().position(|known| known.quantity == channel.quantity);
    let at = |t: f64| {
        let row = log.rows().find(|row| row[0] >= t - SLACK);
        row.zip(column).map_or(f64::NAN, |(row, column)| row[column])
    };
    // A run that ended early has no value for an interval that it did not finish.
    let whole = |from: f64, to: f64, found: &dyn Fn(&dyn Fn(&[f64]) -> bool) -> Option<f64>| {
        let within = |row: &[f64]| row[0] >= from - SLACK && row[0] <= to + SLACK;
        let reaches = log.rows().last().is_some_and(|row| row[0] >= to - SLACK);
        found(&within).filter(|_| reaches).unwrap_or(f64::NAN)
    };
    let name = &channel.name;
    match *take {
        Take::Number => {
            let number = record.numbers.iter().find(|(known, _)| known.quantity == channel.quantity);
            number.map_or(f64::NAN, |(_, value)| *value)
        }
        Take::At(t) => at(t),
        Take::Peak(a, b) => whole(a, b, &|within| log.peak(name, within)),
        Take::Highest(a, b) => whole(a, b, &|within| log.highest(name, within)),
        Take::Lowest(a, b) => whole(a, b, &|within| log.lowest(name, within)),
        // An exponential has no zero and no change of sign. Such data have no rate, not an infinite rate.
        Take::Decay(a, b) => Some((at(a) / at(b)).ln() / (b - a)).filter(|rate| rate.is_finite()).unwrap_or(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Channel, Quantity};

    /// The result for a run of four samples, 0 to 3 s, with these values.
    fn judged(values: [f64; 4], take: Take, target: Target) -> Line {
        let channel = |quantity, name: &str, unit| Channel { quantity, name: name.into(), unit };
        let speed = channel(Quantity::Speed, "speed", Unit::MetrePerSecond);
        let mut record = Record::new(vec![channel(Quantity::Time, "t", Unit::Second), speed.clone()]);
        for (k, value) in values.into_iter().enumerate() {
            record.sample(|quantity| if quantity == Quantity::Time { k as f64 } else { value });
        }
        judge(&Expectation { channel: speed, take, target }, &record)
    }

    #[test]
    fn each_way_to_take_a_number() {
        let values = [1.0, -4.0, 2.0, 0.5];
        for (take, found, what) in [
            (Take::At(1.0), "-4", "speed at 1 s"),
            (Take::Peak(0.0, 3.0), "4", "max |speed| in [0, 3] s"),
            (Take::Highest(1.0, 3.0), "2", "max speed in [1, 3] s"),
            (Take::Lowest(2.0, 3.0), "0.5", "min speed in [2, 3] s"),
            (Take::Decay(2.0, 3.0), "1.386294", "decay of speed in [2, 3] s"),
        ] {
            let line = judged(values, take, Target::Near { value: 0.0, tolerance: 9.0, percent: None });
            assert_eq!((line.found.as_str(), line.what.as_str(), line.met), (found, what, true));
            assert_eq!(line.unit, if matches!(take, Take::Decay(..)) { Unit::PerSecond } else { Unit::MetrePerSecond });
        }
    }

    #[test]
    fn a_run_that_ended_early_or_a_nan_meets_nothing() {
        let [most, least] = [Target::AtMost(f64::INFINITY), Target::AtLeast(f64::NEG_INFINITY)];
        for target in [most, least] {
            for take in [Take::At(4.0), Take::Peak(0.0, 4.0), Take::Highest(2.0, 4.0), Take::Lowest(3.0, 4.0), Take::Number] {
                assert!(!judged([1.0; 4], take, target).met, "{take:?} beyond the end");
            }
            for take in [Take::Peak(0.0, 3.0), Take::Highest(0.0, 3.0), Take::Lowest(0.0, 3.0), Take::At(2.0)] {
                assert!(!judged([1.0, 2.0, f64::NAN, 1.0], take, target).met, "{take:?} of a NaN");
            }
            for ends in [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0, -1.0]] {
                let found = judged([ends[0], 0.0, 0.0, ends[1]], Take::Decay(0.0, 3.0), target);
                assert!(!found.met, "decay from {} to {} is {}", ends[0], ends[1], found.found);
            }
            assert!(judged([1.0, 2.0, f64::NAN, 1.0], Take::Peak(0.0, 1.0), target).met);
        }
    }
}
