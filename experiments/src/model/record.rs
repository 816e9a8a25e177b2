//! The results of a run.

use std::fmt::Write;

use armgen_runtime::manipulability::Ellipsoid;
use armgen_runtime::nalgebra::Vector3;
use armgen_runtime::simulation::Log;

use super::{Channel, Quantity};

/// Channels over time, numbers of the whole run, and further results.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The channels over time, in the order of the log's columns; the first is the time.
    channels: Vec<Channel>,
    /// A row per sample.
    log: Log,
    /// The numbers of the whole run.
    pub numbers: Vec<(Channel, f64)>,
    /// The arm in the postures of the experiment, for figures.
    pub shapes: Shapes,
    /// Peak rate and effort per joint, if a controller drove the arm.
    pub peaks: Vec<Peak>,
    /// The reason of an early end, if any.
    pub ended: Option<Ended>,
    /// The speed of the simulation, if any.
    pub speed: Speed,
}

/// An early end of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ended {
    /// The reason, in words.
    pub why: String,
    /// The quantity that reports the time of this end, if any: an expectation about it expects the end.
    pub told_by: Option<Quantity>,
}

impl Ended {
    /// An end that no quantity reports.
    pub fn untold(why: String) -> Ended {
        Ended { why, told_by: None }
    }
}

/// The peak absolute rate and effort of a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// rad/s or m/s
    pub rate: f64,
    /// N m or N
    pub effort: f64,
}

/// Simulated time and processing time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speed {
    /// s
    pub simulated: f64,
    /// s
    pub took: f64,
}

/// The arm in several postures.
#[derive(Clone, Debug, Default)]
pub struct Shapes {
    /// In the named postures.
    pub postures: Vec<Shape>,
    /// In the postures of the grid.
    pub grid: Vec<Shape>,
}

/// The arm in a posture, with the ellipsoids of its translation in a plane.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Origins of the base and of the link frames, and the tip.
    pub points: Vec<Vector3<f64>>,
    /// Velocity ellipsoid.
    pub velocity: Ellipsoid<f64, 2>,
    /// Force ellipsoid; `None` in a singular posture.
    pub force: Option<Ellipsoid<f64, 2>>,
}

/// Interval between rows in files, s; expectations use every sample.
const CSV_STEP: f64 = 0.01;

/// Runs shorter than this, s, are written with every sample, because they are brief by design or ended early.
const SHORT: f64 = 1.0;

impl Record {
    /// An empty record with these channels; the first is the time.
    pub fn new(channels: Vec<Channel>) -> Record {
        let log = Log::new(channels.iter().map(|channel| channel.name.clone()));
        Record { channels, log, ..Record::default() }
    }

    /// A record without samples, with the reason.
    pub fn without_samples(reason: String) -> Record {
        Record { ended: Some(Ended::untold(reason)), ..Record::default() }
    }

    /// Appends a sample; calls `value` for every channel in order.
    pub fn sample(&mut self, mut value: impl FnMut(Quantity) -> f64) {
        let row = self.channels.iter().map(|channel| value(channel.quantity));
        self.log.push(row);
    }

    /// The channels over time.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The samples: a column per channel.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// The values of a channel over time; empty if it was not recorded.
    pub fn values(&self, quantity: Quantity) -> Vec<f64> {
        let Some(column) = self.channels.iter().position(|channel| channel.quantity == quantity) else { return Vec::new() };
        self.log.rows().map(|row| row[column]).collect()
    }

    /// Times, s, and values of a channel.
    pub fn series(&self, quantity: Quantity) -> Vec<(f64, f64)> {
        self.values(Quantity::Time).into_iter().zip(self.values(quantity)).collect()
    }

    /// The time of the last sample, s; 0 without samples.
    pub fn end(&self) -> f64 {
        self.log.rows().last().map_or(0.0, |row| row[0])
    }

    /// The record as comma-separated values: a row every 10 ms and the last row, or every row of a run shorter than 1 s. Without a log,
    /// it contains the numbers of the whole run.
    pub fn csv(&self) -> String {
        let mut text = String::new();
        let written = if self.log.is_empty() {
            write!(text, "quantity,value").and_then(|()| {
                self.numbers.iter().try_for_each(|(channel, value)| write!(text, "\n{},{value}", channel.name))?;
                writeln!(text)
            })
        } else {
            let mut rows = self.log.rows();
            let (first, second) = (rows.next().map_or(0.0, |row| row[0]), rows.next().map_or(CSV_STEP, |row| row[0]));
            let stride = if self.end() - first < SHORT { 1 } else { ((CSV_STEP / (second - first)).round() as usize).max(1) };
            let mut thin = Log::new(self.log.names().iter().cloned());
            let last = self.log.len().saturating_sub(1);
            let kept = self.log.rows().enumerate().filter(|(i, _)| i % stride == 0 || *i == last);
            kept.for_each(|(_, row)| thin.push(row.iter().copied()));
            thin.write_csv(&mut text)
        };
        debug_assert!(written.is_ok(), "a text takes everything");
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Unit;

    #[test]
    fn the_file_holds_the_last_sample_and_all_of_a_short_run() {
        let channel = |quantity, name: &str| Channel { quantity, name: name.into(), unit: Unit::None };
        let rows = |count: u32| {
            let mut record = Record::new(vec![channel(Quantity::Time, "t"), channel(Quantity::Speed, "x")]);
            for k in 0..count {
                record.sample(|quantity| f64::from(k) * if quantity == Quantity::Time { 1e-3 } else { 1.0 });
            }
            record.csv().lines().skip(1).map(|line| line.rsplit(',').next().unwrap_or_default().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(rows(4).len(), 4);
        assert_eq!(rows(1).len(), 1);
        let long = rows(1506);
        assert_eq!((long.len(), long[1].parse(), long[151].parse()), (152, Ok(10.0), Ok(1505.0)));
    }
}
