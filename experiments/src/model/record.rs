//! What a run leaves behind.

use std::fmt::Write;

use armgen_runtime::manipulability::Ellipsoid;
use armgen_runtime::nalgebra::Vector3;
use armgen_runtime::simulation::Log;

use super::{Channel, Quantity};

/// Channels over time, numbers of the whole run, and what has to be said.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The channels over time, in the order of the columns of the log; the first one is the time.
    channels: Vec<Channel>,
    /// A row a sample.
    log: Log,
    /// The numbers of the whole run.
    pub numbers: Vec<(Channel, f64)>,
    /// The arm at the postures of the experiment, for figures.
    pub shapes: Shapes,
    /// How fast and how hard each joint worked, where a controller drove it.
    pub peaks: Vec<Peak>,
    /// How the run ended early, if it did.
    pub ended: Option<Ended>,
    /// How fast it was simulated, where something was.
    pub speed: Speed,
}

/// How a run ended early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ended {
    /// Why, in words.
    pub why: String,
    /// The number of the run that tells when what ended it came about, where one does: who expects something of it expects the end.
    pub told_by: Option<Quantity>,
}

impl Ended {
    /// An end of which no number of the run tells.
    pub fn untold(why: String) -> Ended {
        Ended { why, told_by: None }
    }
}

/// The largest sizes of a joint's rate and of its torque or force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// rad/s or m/s
    pub rate: f64,
    /// N m or N
    pub effort: f64,
}

/// Simulated time and what it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speed {
    /// s
    pub simulated: f64,
    /// s
    pub took: f64,
}

/// The arm at postures.
#[derive(Clone, Debug, Default)]
pub struct Shapes {
    /// At the postures that have a name.
    pub postures: Vec<Shape>,
    /// At those of the grid.
    pub grid: Vec<Shape>,
}

/// The arm at a posture, with the ellipsoids of its translation in a plane.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Origins of the base and of the link frames, and the tip.
    pub points: Vec<Vector3<f64>>,
    /// Velocity ellipsoid.
    pub velocity: Ellipsoid<f64, 2>,
    /// Force ellipsoid; none at a singular posture.
    pub force: Option<Ellipsoid<f64, 2>>,
}

/// One row in the files for so many seconds; expectations see every sample.
const CSV_STEP: f64 = 0.01;

/// Shorter runs, s, are written with every sample: there is something to see in them, or they were lost.
const SHORT: f64 = 1.0;

impl Record {
    /// An empty record of these channels; the first one is the time.
    pub fn new(channels: Vec<Channel>) -> Record {
        let log = Log::new(channels.iter().map(|channel| channel.name.clone()));
        Record { channels, log, ..Record::default() }
    }

    /// A record without samples: why there is none.
    pub fn without_samples(reason: String) -> Record {
        Record { ended: Some(Ended::untold(reason)), ..Record::default() }
    }

    /// Appends a sample: `value` is asked for every channel in turn.
    pub fn sample(&mut self, mut value: impl FnMut(Quantity) -> f64) {
        let row = self.channels.iter().map(|channel| value(channel.quantity));
        self.log.push(row);
    }

    /// The channels over time.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The samples: one column a channel.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// The values of a channel over time; none where it was not recorded.
    pub fn values(&self, quantity: Quantity) -> Vec<f64> {
        let Some(column) = self.channels.iter().position(|channel| channel.quantity == quantity) else { return Vec::new() };
        self.log.rows().map(|row| row[column]).collect()
    }

    /// Times, s, and values of a channel.
    pub fn series(&self, quantity: Quantity) -> Vec<(f64, f64)> {
        self.values(Quantity::Time).into_iter().zip(self.values(quantity)).collect()
    }

    /// The time of the last sample, s; 0 without any.
    pub fn end(&self) -> f64 {
        self.log.rows().last().map_or(0.0, |row| row[0])
    }

    /// The record as comma-separated values: a row every 10 ms and the last, every row of a run shorter than a second, or the numbers of
    /// the whole run if there is no log.
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
