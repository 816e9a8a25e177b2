//! Ranges and ticks of an axis: round numbers, a power of ten in the label where the numbers would be long.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// An axis over the values that are drawn: of a logarithmic one these are powers of ten.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    /// Ticks are printed divided by 10 to this power.
    power: i32,
    logarithmic: bool,
}

/// So many ticks are aimed at.
const TICKS: f64 = 6.0;

impl Axis {
    /// From `low` to `high`, widened a little where `margin` asks for it.
    pub(super) fn linear(low: f64, high: f64, margin: f64) -> Axis {
        let (low, high) = proper(low, high);
        let extra = (high - low) * margin;
        let (low, high) = (low - extra, high + extra);
        let step = round_step((high - low) / TICKS);
        let ticks = (0..)
            .map(|k| (low / step).ceil() * step + f64::from(k) * step)
            .take_while(|tick| *tick <= high + step * 1e-9)
            .collect::<Vec<f64>>();
        let largest = low.abs().max(high.abs());
        let exponent = largest.log10().floor() as i32;
        let power = if (-2..4).contains(&exponent) { 0 } else { exponent.div_euclid(3) * 3 };
        Axis { low, high, ticks, power, logarithmic: false }
    }

    /// Over decades from 10^low to 10^high.
    pub(super) fn decades(low: f64, high: f64) -> Axis {
        let (low, high) = (low.floor(), high.ceil().max(low.floor() + 1.0));
        let step = ((high - low) / 8.0).ceil().max(1.0);
        let ticks = (0..).map(|k| low + f64::from(k) * step).take_while(|tick| *tick <= high).collect();
        Axis { low, high, ticks, power: 0, logarithmic: true }
    }

    /// The same ticks over a wider range.
    pub(super) fn widened(low: f64, high: f64) -> Axis {
        Axis::linear(low, high, 0.0)
    }

    pub(super) fn bounds(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// What the numbers of the ticks are to be multiplied with, for the label; nothing if with 1.
    pub(super) fn factor(&self) -> Option<String> {
        (self.power != 0).then(|| format!("1e{}", self.power))
    }
}

/// A range that is not empty.
fn proper(low: f64, high: f64) -> (f64, f64) {
    if !(low.is_finite() && high.is_finite()) || low > high {
        return (0.0, 1.0);
    }
    let size = low.abs().max(high.abs());
    if size == 0.0 {
        (-1.0, 1.0)
    } else if high - low < 1e-9 * size {
        (low - 0.5 * size, high + 0.5 * size)
    } else {
        (low, high)
    }
}

/// 1, 2 or 5 times a power of ten, at least `least`.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let part = (value - self.low) / (self.high - self.low);
        limit.0 + (f64::from(limit.1 - limit.0) * part).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format(value: &f64) -> String {
        format!("{value}")
    }

    fn format_ext(&self, value: &f64) -> String {
        if self.logarithmic {
            return format!("1e{value:.0}");
        }
        let step = self.ticks.get(1).map_or(1.0, |second| second - self.ticks[0]) / 10f64.powi(self.power);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let text = format!("{:.decimals$}", value / 10f64.powi(self.power));
        if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
            "0".into()
        } else {
            text
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(axis: &Axis, expected: &[&str], factor: Option<&str>) {
        let ticks: Vec<String> = axis.ticks.iter().map(|tick| axis.format_ext(tick)).collect();
        assert_eq!(ticks, expected);
        assert_eq!(axis.factor().as_deref(), factor);
    }

    #[test]
    fn ticks_are_round() {
        check(
            &Axis::linear(0.0, 2.5, 0.0),
            &["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"].map(|t| if t == "0.0" { "0" } else { t }),
            None,
        );
        check(&Axis::linear(-1.2e-6, 2.1e-6, 0.0), &["-1", "0", "1", "2"], Some("1e-6"));
        check(&Axis::linear(0.0, 0.0, 0.0), &["-1.0", "-0.5", "0", "0.5", "1.0"], None);
        check(&Axis::decades(-6.3, -2.1), &["1e-7", "1e-6", "1e-5", "1e-4", "1e-3", "1e-2"], None);
        check(&Axis::linear(f64::NAN, 1.0, 0.0), &["0", "0.2", "0.4", "0.6", "0.8", "1.0"], None);
    }
}
