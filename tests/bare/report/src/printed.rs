//! Output of the firmware.

use std::collections::BTreeMap;

/// The emulated clock: 64 ns for each instruction, read by a timer of 25 MHz.
const TICKS_PER_INSTRUCTION: f64 = 1.6;

/// Instructions in this many ticks, rounded.
pub(crate) fn instructions(ticks: u64) -> u64 {
    (ticks as f64 / TICKS_PER_INSTRUCTION).round() as u64
}

/// The lines of the firmware, by kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Printed {
    /// Argument of the delay loop and ticks.
    pub(crate) calibration: Vec<[u64; 2]>,
    /// Whole lines, one for each step.
    pub(crate) torques: Vec<String>,
    /// Whole lines, one for each posture.
    pub(crate) postures: Vec<String>,
    /// Whole lines, one for each result of a law.
    pub(crate) laws: Vec<String>,
    /// Ticks of trajectory, inverse kinematics, controller and arm, by step.
    pub(crate) ticks: Vec<[u64; 4]>,
    /// Largest difference of desired and actual joint variables, 1e-9 rad or m.
    pub(crate) error: u64,
    /// Most ticks and most stack of a call, by name.
    pub(crate) functions: BTreeMap<String, [u64; 2]>,
}

impl Printed {
    pub(crate) fn read(text: &str) -> Result<Printed, String> {
        let mut printed = Printed::default();
        let mut ended = false;
        for line in text.lines() {
            let (kind, rest) = line.split_once(' ').unwrap_or((line, ""));
            let wrong = || format!("the firmware printed a line that is not one of its own: {line}");
            let numbers = |rest: &str| rest.split(' ').map(|n| n.parse().map_err(|_| wrong())).collect::<Result<Vec<u64>, _>>();
            match kind {
                "torque" => printed.torques.push(line.into()),
                "posture" => printed.postures.push(line.into()),
                "bits" => printed.laws.push(line.into()),
                "calibration" => printed.calibration.push(numbers(rest)?.try_into().map_err(|_| wrong())?),
                "ticks" => {
                    let [_, ticks @ ..]: [u64; 5] = numbers(rest)?.try_into().map_err(|_| wrong())?;
                    printed.ticks.push(ticks);
                }
                "error" => printed.error = rest.parse().map_err(|_| wrong())?,
                "function" => {
                    let (name, rest) = rest.split_once(' ').ok_or_else(wrong)?;
                    printed.functions.insert(name.into(), numbers(rest)?.try_into().map_err(|_| wrong())?);
                }
                "end" => ended = true,
                _ => return Err(wrong()),
            }
        }
        if !ended {
            return Err("the firmware did not print its last line".into());
        }
        Ok(printed)
    }

    /// The loop of `calibration` runs two instructions once for each unit of its argument: does the timer count them?
    pub(crate) fn calibration_faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if self.calibration.len() < 2 {
            faults.push("the firmware did not calibrate its timer".into());
        }
        for pair in self.calibration.windows(2) {
            let expected = ((pair[1][0] - pair[0][0]) * 2) as f64 * TICKS_PER_INSTRUCTION;
            let ticks = pair[1][1] as f64 - pair[0][1] as f64;
            // Each of the two readings is a whole number of ticks.
            if (ticks - expected).abs() > 2.0 {
                faults.push(format!("the timer does not count instructions: {ticks} ticks where {expected} are due"));
            }
        }
        faults
    }
}

/// The first step whose torques differ, and a difference of length.
pub(crate) fn differences(host: &[String], target: &[String]) -> Vec<String> {
    let mut faults = Vec::new();
    if host.len() != target.len() {
        faults.push(format!("{} lines on this machine, {} on the microcontroller", host.len(), target.len()));
    }
    if let Some((host, target)) = host.iter().zip(target).find(|(host, target)| host != target) {
        faults.push(format!("the bits differ, first here:\n  this machine:    {host}\n  microcontroller: {target}"));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "calibration 0 29\ncalibration 1000 3229\ntorque 0 3e4bc7b4\nticks 0 1 2 3 4\nerror 5\nfunction gravity 45 40\nend\n";

    #[test]
    fn lines_are_read() {
        let printed = Printed::read(TEXT).unwrap();
        assert_eq!(printed.functions["gravity"], [45, 40]);
        assert_eq!(printed.ticks, [[1, 2, 3, 4]]);
        assert!(printed.calibration_faults().is_empty());
    }

    #[test]
    fn a_run_that_broke_off_is_refused() {
        assert!(Printed::read(TEXT.strip_suffix("end\n").unwrap()).is_err());
        assert!(Printed::read(&TEXT.replace("ticks 0 1", "ticks 0")).is_err());
        assert!(Printed::read("HardFault\n").is_err());
    }

    #[test]
    fn a_timer_that_counts_something_else_is_noticed() {
        let printed = Printed::read(&TEXT.replace("3229", "3239")).unwrap();
        assert_eq!(printed.calibration_faults().len(), 1);
    }

    #[test]
    fn one_bit_is_a_difference() {
        let host = ["torque 0 3e4bc7b4".to_string(), "torque 1 3e4bc7b4".to_string()];
        let mut target = host.clone();
        assert!(differences(&host, &target).is_empty());
        target[1] = "torque 1 3e4bc7b5".into();
        assert_eq!(differences(&host, &target).len(), 1);
        assert_eq!(differences(&host, &target[..1]).len(), 1);
    }
}
