//! `controller` and its companions: `reference`, `load`, `sensor`, `simulation`.

use std::collections::BTreeMap;

use armgen_codegen::diagnostic::Code as Shared;
use armgen_codegen::document::reader::{required, Fields};
use armgen_codegen::source::Span;

use super::values::{optionals, Allowed, Numbers, Reader};
use super::Code;
use crate::model::{Adaptation, ControlLaw, ControlLawKind, ControlRun, EstimateBounds, Noise, Per, ReferenceGains, Sampling};

/// Maximum number of integration steps in a run; a million take some seconds.
const MAX_STEPS: u128 = 20_000_000;

impl Reader<'_> {
    pub(super) fn control(&mut self, fields: &Fields<'_>, sampling: Option<Sampling>) -> Option<ControlRun> {
        let start = self.start(fields);
        let nominal = self.robot.nominal();
        let plant = self.parameters(fields, "load", nominal.clone()).unwrap_or(nominal);
        let reference = self.reference(fields, sampling.as_ref());
        let (delay, noise) = self.sensor(fields);
        let (substeps, continuous) = self.simulation(fields);
        if let Some(Sampling { period, duration, .. }) = &sampling {
            if duration.as_nanos() / period.as_nanos() * u128::from(substeps) > MAX_STEPS {
                let help = "at most twenty million steps in all: fewer `substeps`, a longer `sampling`, a shorter `duration`";
                let message = "the run has too many integration steps";
                self.report(Shared::OutOfRange, fields.place("simulation"), message, "too many", help);
                return None;
            }
        }
        let law = self.law(fields)?;
        if continuous && !law.kind.is_continuous() {
            let help = "remove `continuous`, or choose `law: adaptive`";
            let message = "only the adaptive law runs in continuous time";
            self.report(Code::OutOfPlace, fields.place("simulation"), message, "here", help);
        }
        Some(ControlRun {
            sampling: sampling?,
            start: start?,
            plant,
            reference: reference?,
            law,
            delay,
            noise,
            substeps,
            continuous,
        })
    }

    /// K_P and K_D of the inverse kinematics that computes the joint reference. The defaults are w² and 2 w with w = 1/(20 T): an error
    /// decays without overshoot within a hundred samples, slowly enough that sampling has no effect.
    fn reference(&mut self, fields: &Fields<'_>, sampling: Option<&Sampling>) -> Option<ReferenceGains> {
        let Some((at, node)) = fields.get("reference") else {
            let w = 1.0 / (20.0 * sampling?.period.as_secs_f64());
            let rows = self.robot.task.len();
            return Some(ReferenceGains { proportional: vec![w * w; rows], derivative: vec![2.0 * w; rows] });
        };
        let keys = [required("k_p", "k_p: [1000, 1000, ...]"), required("k_d", "k_d: [50, 50, ...]")];
        let keys = self.mapping(node, "`reference`", at, &keys)?;
        let rows = self.robot.task.len();
        let proportional = self.rows_of_numbers(&keys, "k_p", rows);
        let derivative = self.rows_of_numbers(&keys, "k_d", rows);
        Some(ReferenceGains { proportional: proportional?, derivative: derivative? })
    }

    fn sensor(&mut self, fields: &Fields<'_>) -> (usize, Noise) {
        let keys = optionals(&["delay", "position_deviation", "rate_deviation", "seed"]);
        let Some(keys) = fields.get("sensor").and_then(|(at, node)| self.mapping(node, "`sensor`", at, &keys)) else {
            return (0, Noise::default());
        };
        let delay = self.count(&keys, "delay", 0, 10).unwrap_or(0) as usize;
        let mut deviation = |name: &str| self.number(&keys, name, Allowed::NotNegative).unwrap_or(0.0);
        let (position, rate) = (deviation("position_deviation"), deviation("rate_deviation"));
        (delay, Noise { position, rate, seed: self.count(&keys, "seed", 0, u32::MAX).unwrap_or(0) })
    }

    /// Runge-Kutta steps per sample, and whether time is continuous.
    fn simulation(&mut self, fields: &Fields<'_>) -> (u32, bool) {
        let keys = optionals(&["substeps", "continuous"]);
        let Some(keys) = fields.get("simulation").and_then(|(at, node)| self.mapping(node, "`simulation`", at, &keys)) else {
            return (1, false);
        };
        (self.count(&keys, "substeps", 1, 1000).unwrap_or(1), self.switch(&keys, "continuous").unwrap_or(false))
    }

    fn law(&mut self, fields: &Fields<'_>) -> Option<ControlLaw> {
        let (at, node) = fields.get("controller")?;
        let keys_of = |kind: ControlLawKind| kind.gains().iter().map(|gain| gain.key).chain(kind.optional().iter().copied());
        let mut all: Vec<&'static str> = Vec::new();
        for key in ControlLawKind::ALL.into_iter().flat_map(keys_of) {
            if !all.contains(&key) {
                all.push(key);
            }
        }
        let mut known = vec![required("law", "law: inverse_dynamics")];
        known.extend(optionals(&all));
        let keys = self.mapping(node, "`controller`", at, &known)?;
        let kind = self.choice(&keys, "law", &ControlLawKind::ALL.map(|kind| (kind.name(), kind)))?.value;
        let what = format!("the law `{}`", kind.name());
        let others: Vec<&str> = all.into_iter().filter(|name| !keys_of(kind).any(|own| own == *name)).collect();
        self.out_of_place(&keys, &others, &format!("{what} does not use it"));
        let missing: Vec<String> =
            kind.gains().iter().filter(|gain| !keys.has(gain.key)).map(|gain| format!("`{}`", gain.key)).collect();
        if !missing.is_empty() {
            let needs: Vec<&str> = kind.gains().iter().map(|gain| gain.key).collect();
            let message = format!("{what} lacks {}", missing.join(", "));
            self.report(
                Shared::MissingKey,
                keys.at(),
                message,
                "required here",
                format!("keys of this law: {}", needs.join(", ")),
            );
        }
        let mut gains = BTreeMap::new();
        for gain in kind.gains() {
            let allowed = if gain.may_be_zero { Allowed::NotNegative } else { Allowed::Positive };
            let (len, each) = match gain.per {
                Per::Joint => (self.robot.dof(), "one per joint"),
                Per::Row => (self.robot.task.len(), "one per row of the task"),
                Per::Parameter => (self.robot.parameters.len(), "one per parameter of the regressor"),
                Per::Law => (1, ""),
            };
            let numbers = match gain.per {
                Per::Law => self.number(&keys, gain.key, allowed).map(|x| vec![x]),
                _ => self.numbers(&keys, gain.key, Numbers { len, each, allowed }),
            };
            if let Some(numbers) = numbers {
                gains.insert(gain.key, numbers);
            }
        }
        let per_joint = Numbers { len: self.robot.dof(), each: "one per joint", allowed: Allowed::Positive };
        let torque_limits = self.numbers(&keys, "torque_limits", per_joint);
        let adaptation = self.adaptation(&keys);
        (gains.len() == kind.gains().len()).then_some(ControlLaw { kind, gains, torque_limits, adaptation })
    }

    fn adaptation(&mut self, keys: &Fields<'_>) -> Adaptation {
        let nominal = self.robot.nominal();
        let estimate = self.parameters(keys, "estimate", nominal.clone()).unwrap_or(nominal);
        // Without a bound, nearly the whole range of f64.
        let widest = f64::MAX / 4.0;
        let all = |x: f64| vec![x; self.robot.parameters.len()];
        let (lowest, highest) = (all(-widest), all(widest));
        let given = [self.parameters(keys, "lowest", lowest.clone()), self.parameters(keys, "highest", highest.clone())];
        let bounds = match given {
            [None, None] => None,
            [low, high] => Some(EstimateBounds { lowest: low.unwrap_or(lowest), highest: high.unwrap_or(highest) }),
        };
        if let Some(EstimateBounds { lowest: low, highest: high }) = &bounds {
            let robot = self.robot;
            for (i, parameter) in robot.parameters.iter().enumerate().filter(|(i, _)| low[*i] > high[*i]) {
                let message = format!("no estimate of `{}` lies between {} and {}", parameter.name, low[i], high[i]);
                let place: Span = keys.place("lowest");
                self.report(Code::EmptyInterval, place, message, "above `highest`", "write the smaller one under `lowest`");
            }
        }
        Adaptation { estimate, bounds, is_on: self.switch(keys, "adaptation").unwrap_or(true) }
    }
}
