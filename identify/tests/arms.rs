//! Arms with known numbers, and logs of their motions.

use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};
use armgen_identify::arm::Arm;
use armgen_identify::log::Format;

/// An elbow of three joints, made up; `FRICTION` stands for the friction of each joint.
pub(crate) const ELBOW: &str = "
name: elbow
convention: standard
gravity: [0, 0, -9.81]
joints:
  - {name: base, type: revolute, a: 0, alpha: pi/2, d: 0.3, theta: 0, limits: {effort: 400},
     link: {mass: 5, com: [0.01, -0.05, 0.02], inertia: {xx: 0.05, yy: 0.04, zz: 0.03, xy: 0.002, xz: -0.001, yz: 0.003}},
     motor: {ratio: 100, inertia: 4e-5, gain: 12}, friction: {viscous: 4, coulomb: 3, offset: 0.4}}
  - {name: shoulder, type: revolute, a: 0.4, alpha: 0, d: 0, theta: 0, limits: {effort: 400},
     link: {mass: 7, com: [-0.18, 0.01, 0.03], inertia: {xx: 0.02, yy: 0.12, zz: 0.11, xy: 0.001, xz: 0.004, yz: -0.002}},
     motor: {ratio: 100, inertia: 5e-5, gain: 12}, friction: {viscous: 6, coulomb: 5, offset: -0.6, load: 0.05}}
  - {name: elbow, type: revolute, a: 0.35, alpha: 0, d: 0, theta: 0, limits: {effort: 200},
     link: {mass: 3, com: [-0.15, 0.005, 0.01], inertia: {xx: 0.006, yy: 0.05, zz: 0.048, xy: 0.0005, xz: -0.0007, yz: 0.0004}},
     motor: {ratio: 80, inertia: 2e-5, gain: 9}, friction: {viscous: 3, coulomb: 2, offset: 0.2, load: 0.04}}
tool: {xyz: [0, 0, 0.05]}
regressor: base
";

/// An arm with a prismatic joint along gravity.
pub(crate) const SCARA: &str = "
name: scara
convention: modified
gravity: [0, 0, -9.81]
joints:
  - {name: j1, type: revolute, a: 0, alpha: 0, d: 0.4, theta: 0,
     link: {mass: 8, com: [0.2, 0.01, 0.02], inertia: {xx: 0.05, yy: 0.09, zz: 0.1}},
     motor: {ratio: 80, inertia: 1e-4}, friction: {viscous: 2, coulomb: 3}}
  - {name: j2, type: revolute, a: 0.4, alpha: 0, d: 0, theta: 0,
     link: {mass: 6, com: [0.15, -0.02, 0.03], inertia: {xx: 0.03, yy: 0.06, zz: 0.07}},
     motor: {ratio: 80, inertia: 1e-4}, friction: {viscous: 2, coulomb: 2}}
  - {name: j3, type: prismatic, a: 0.35, alpha: pi, d: 0.1, theta: 0,
     link: {mass: 2.5, com: [0.01, 0.002, -0.02], inertia: {xx: 0.02, yy: 0.02, zz: 0.003}},
     motor: {ratio: 300, inertia: 2e-5}, friction: {viscous: 30, coulomb: 10}}
regressor: base
";

/// A small random source, the same everywhere.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * self.unit().ln()).sqrt() * (std::f64::consts::TAU * self.unit()).cos()
    }
}

/// The arm of a description.
pub(crate) fn arm(text: &str) -> Arm {
    let (valid, diagnostics) = validate::read(&Source::new("arm", text));
    let (manipulator, _) = valid.unwrap_or_else(|| panic!("{:?}", diagnostics.iter().collect::<Vec<_>>()));
    Arm::new(&manipulator, false).expect("it has mass")
}

/// How logs of an arm are read.
pub(crate) fn format(arm: &Arm) -> Format {
    Format { joints: arm.joints.iter().map(|joint| (joint.name.clone(), joint.slides)).collect(), ..Format::default() }
}

/// A motion: positions, rates, accelerations, torques, state by state.
pub(crate) struct Motion {
    pub(crate) t: Vec<f64>,
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    pub(crate) ddq: Vec<f64>,
    pub(crate) tau: Vec<f64>,
}

/// A motion of random harmonics, with the torques of the function `inverse_dynamics`, which knows nothing of regressors.
pub(crate) fn motion(text: &str, seed: u64, seconds: f64, rate: f64) -> Motion {
    motion_from(text, seed, seconds, rate, 0.0)
}

/// The same with the torque of each joint that is late by a delay, s.
pub(crate) fn late_motion(text: &str, seed: u64, seconds: f64, rate: f64, delays: &[f64]) -> Motion {
    let mut all = motion(text, seed, seconds, rate);
    let n = delays.len();
    for (j, delay) in delays.iter().enumerate() {
        let before = motion_from(text, seed, seconds, rate, -delay);
        (j..all.tau.len()).step_by(n).for_each(|k| all.tau[k] = before.tau[k]);
    }
    all
}

/// The same with a joint that is locked at a position.
pub(crate) fn locked_motion(text: &str, seed: u64, seconds: f64, rate: f64, joint: usize, at: f64) -> Motion {
    motion_of(text, seed, seconds, rate, 0.0, Some((joint, at)))
}

/// The same with states and torques that are later than their stamps, s.
fn motion_from(text: &str, seed: u64, seconds: f64, rate: f64, later: f64) -> Motion {
    motion_of(text, seed, seconds, rate, later, None)
}

fn motion_of(text: &str, seed: u64, seconds: f64, rate: f64, later: f64, locked: Option<(usize, f64)>) -> Motion {
    let (manipulator, _) = validate::read(&Source::new("arm", text)).0.expect("a valid arm");
    let n = manipulator.dof();
    let functions = Selection::named(["inverse_dynamics"]).expect("it has this name");
    let module = schedule::module(&Model::new(manipulator), &Options { functions, ..Options::default() });
    let program = armgen_evaluate::programs::<f64>(&module).remove(0);
    let mut random = Random(seed);
    let harmonics = 5;
    let waves: Vec<[f64; 3]> = (0..n * harmonics)
        .map(|k| {
            let amplitude = random.within(0.1, 0.45) / ((k % harmonics) as f64 + 1.0).sqrt();
            [amplitude, random.within(0.8, 1.2) * 0.6 * (1.0 + (k % harmonics) as f64), random.within(0.0, std::f64::consts::TAU)]
        })
        .collect();
    let samples = (seconds * rate) as usize;
    let mut all = Motion { t: vec![], q: vec![], dq: vec![], ddq: vec![], tau: vec![0.0; samples * n] };
    for k in 0..samples {
        let t = k as f64 / rate;
        all.t.push(t);
        let t = t + later;
        for j in 0..n {
            let (mut q, mut dq, mut ddq) = (0.2 * j as f64, 0.0, 0.0);
            for [a, w, phase] in &waves[j * harmonics..(j + 1) * harmonics] {
                let (sine, cosine) = (w * t + phase).sin_cos();
                q += a * sine;
                dq += a * w * cosine;
                ddq -= a * w * w * sine;
            }
            if let Some((_, at)) = locked.filter(|(joint, _)| *joint == j) {
                (q, dq, ddq) = (at, 0.0, 0.0);
            }
            all.q.push(q);
            all.dq.push(dq);
            all.ddq.push(ddq);
        }
    }
    program.run(&[&all.q, &all.dq, &all.ddq], &mut all.tau, &mut program.workspace()).expect("states");
    all
}

/// The text of a log, with numbers of so many decimals.
pub(crate) fn csv(arm: &Arm, motion: &Motion, decimals: usize) -> String {
    let n = arm.dof();
    let mut text = String::from("t");
    for prefix in ["q", "dq", "tau"] {
        arm.joints.iter().for_each(|joint| text += &format!(",{prefix}_{}", joint.name));
    }
    text.push('\n');
    for (k, t) in motion.t.iter().enumerate() {
        text += &format!("{t:.5}");
        for signal in [&motion.q, &motion.dq, &motion.tau] {
            signal[k * n..(k + 1) * n].iter().for_each(|x| text += &format!(",{x:.decimals$}"));
        }
        text.push('\n');
    }
    text
}

/// The root of the mean square.
pub(crate) fn rms<'x>(of: impl Iterator<Item = &'x f64>) -> f64 {
    let all: Vec<f64> = of.map(|x| x * x).collect();
    (all.iter().sum::<f64>() / all.len() as f64).sqrt()
}
