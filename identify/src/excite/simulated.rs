//! The log that a simulated arm gives of a motion: its drives follow the samples exactly, its sensors do not.

use std::fmt::Write;

use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::Model;

use super::search::Random;
use super::{fault, slides, Code, Excitation, Fault};

/// How long noise of torques is correlated, s.
const MEMORY: f64 = 0.02;
/// Steps of encoders, rad or m, for each per cent of noise.
const STEP: f64 = 1e-5;
/// Standard deviation of rates, rad/s or m/s, for each per cent of noise.
const RATE: f64 = 1e-3;

/// A normal number, by sums alone: the same on every machine.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

impl Excitation {
    /// The log of another arm with the same joints on this motion: t, then q, dq, tau of each joint, `rate` samples a second.
    ///
    /// `noise`: standard deviation of the torques' noise in per cent of the torque of the joint, as a root of mean squares. Positions
    /// and rates are as coarse as sensors with such torques often are.
    ///
    /// # Errors
    /// The other arm has no mass, or other joints.
    pub fn simulated(&self, of: &Manipulator, rate: f64, noise: f64, seed: u64) -> Result<String, Fault> {
        let n = self.joints.len();
        let joints: Vec<(&str, bool)> =
            of.joints.iter().enumerate().map(|(k, joint)| (joint.name.as_str(), slides(of, k))).collect();
        let own: Vec<(&str, bool)> = self.joints.iter().map(String::as_str).zip(self.slides.iter().copied()).collect();
        if joints != own {
            let names = |joints: &[(&str, bool)]| joints.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
            let text = format!("the simulated arm has the joints {}, and the motion those of {}", names(&joints), names(&own));
            return Err(fault(Code::UnknownJoint, text, "simulate a description with the same joints of the same types"));
        }
        if of.is_massless() {
            let text = "nothing of the simulated arm has mass".to_owned();
            return Err(fault(Code::NoMotion, text, "give its links masses"));
        }
        let functions = Selection::named(["inverse_dynamics"]).expect("a function of every arm with mass");
        let module = schedule::module(&Model::new(of.clone()), &Options { functions, ..Options::default() });
        let program = armgen_evaluate::programs::<f64>(&module).remove(0);
        let samples = self.samples(rate);
        let states =
            |derivative: usize| -> Vec<f64> { samples.iter().flat_map(|(_, x)| x.iter().map(move |x| x[derivative])).collect() };
        let (mut q, mut dq, ddq) = (states(0), states(1), states(2));
        let mut tau = vec![0.0; q.len()];
        program.run(&[&q, &dq, &ddq], &mut tau, &mut program.workspace()).expect("states of this arm");
        let mut random = Random(seed);
        if noise > 0.0 {
            let memory = MEMORY / (MEMORY + 1.0 / rate);
            for joint in 0..n {
                let squares: f64 = tau.iter().skip(joint).step_by(n).map(|tau| tau * tau).sum();
                let size = 0.01 * noise * (squares / samples.len() as f64).sqrt();
                let mut last = normal(&mut random);
                for tau in tau.iter_mut().skip(joint).step_by(n) {
                    *tau += size * last;
                    last = memory * last + (1.0 - memory * memory).sqrt() * normal(&mut random);
                }
            }
            q.iter_mut().for_each(|q| *q = (*q / (STEP * noise)).round() * (STEP * noise));
            dq.iter_mut().for_each(|dq| *dq += RATE * noise * normal(&mut random));
        }
        let mut text = self.names(["q", "dq", "tau"]);
        for (k, (t, _)) in samples.iter().enumerate() {
            let _ = write!(text, "{t:.6}");
            for signal in [&q, &dq, &tau] {
                signal[k * n..(k + 1) * n].iter().for_each(|x| _ = write!(text, ",{:.7}", x + 0.0));
            }
            text.push('\n');
        }
        Ok(text)
    }
}
