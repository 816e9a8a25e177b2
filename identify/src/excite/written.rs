//! The files of an excitation: samples, coefficients, proof.

use std::fmt::Write;

use serde_json::{json, Value};

use super::motion::Course;
use super::proof::{Kind, Margin};
use super::Excitation;

/// The margin as a number of a JSON document.
fn margin(of: &Excitation, margin: &Margin) -> Value {
    let joint = |joint: &usize, limit: &str| json!({"joint": of.joints[*joint], "limit": limit, "margin": margin.margin});
    match &margin.kind {
        Kind::Position(at) => joint(at, "position"),
        Kind::Velocity(at) => joint(at, "velocity"),
        Kind::Acceleration(at) => joint(at, "acceleration"),
        Kind::Effort(at) => joint(at, "effort"),
        Kind::Box(at) => json!({"frame": of.bounds[*at].0, "limit": of.bounds[*at].1, "margin": margin.margin}),
    }
}

impl Excitation {
    /// The first line of a file of samples.
    pub(super) fn names(&self, prefixes: [&str; 3]) -> String {
        let columns = prefixes.iter().flat_map(|prefix| self.joints.iter().map(move |joint| format!(",{prefix}_{joint}")));
        format!("t{}\n", columns.collect::<String>())
    }

    /// Stamps of lead-in and motion, with q and its derivatives by joint; `rate` samples a second.
    pub(super) fn samples(&self, rate: f64) -> Vec<(f64, Vec<[f64; 4]>)> {
        let (lead, whole) = (self.lead_in.duration, self.lead_in.duration + self.motion.duration());
        let samples = (whole * rate * (1.0 + 1e-12)).floor() as usize;
        let at = |joint: usize, t: f64| if t < lead { self.lead_in.at(joint, t) } else { self.motion.at(joint, t - lead) };
        let sample = |k: usize| {
            let t = k as f64 / rate;
            (t, (0..self.joints.len()).map(|joint| at(joint, t)).collect())
        };
        (0..=samples).map(sample).collect()
    }

    /// `motion.csv`: t, then q, dq and ddq of each joint, lead-in and motion, `rate` samples a second.
    pub fn csv(&self, rate: f64) -> String {
        let mut text = self.names(["q", "dq", "ddq"]);
        for (t, x) in self.samples(rate) {
            let _ = write!(text, "{t:.6}");
            for d in 0..3 {
                // A zero without a sign.
                x.iter().for_each(|x| _ = write!(text, ",{:.9}", x[d] + 0.0));
            }
            text.push('\n');
        }
        text
    }

    /// `motion.yaml`: the coefficients, with all digits.
    pub fn yaml(&self) -> String {
        let mut text = format!(
            "robot: {}\nduration: {:?}          # s\nw: {:?}          # 2 pi / duration, rad/s\n",
            serde_json::Value::from(self.robot.as_str()),
            self.motion.duration(),
            self.motion.w
        );
        let list = |x: &[f64]| x.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
        let name = |joint: usize| serde_json::Value::from(self.joints[joint].as_str());
        let each = |of: &dyn Fn(usize) -> String| -> String {
            (0..self.joints.len()).map(|joint| format!("  {}: {}\n", name(joint), of(joint))).collect()
        };
        text += "# q = q0 + sum over k of a[k]/(k w) sin(k w t) - b[k]/(k w) cos(k w t), k from 1; rad or m\n";
        text += &format!("q0:\n{}", each(&|joint| format!("{:?}", self.motion.q0[joint])));
        text += &format!("a:\n{}", each(&|joint| format!("[{}]", list(&self.motion.a[joint]))));
        text += &format!("b:\n{}", each(&|joint| format!("[{}]", list(&self.motion.b[joint]))));
        text += "# before: from rest, q = from + (q(0) - from) (10 u^3 - 15 u^4 + 6 u^5), u = t / duration\n";
        text += &format!("lead_in:\n  duration: {:?}\n  from: {{", self.lead_in.duration);
        let from: Vec<String> = (0..self.joints.len()).map(|j| format!("{}: {:?}", name(j), self.lead_in.from[j])).collect();
        text += &format!("{}}}\n", from.join(", "));
        text + &format!("log_det_per_parameter: {:?}\ncondition: {:?}\n", self.log_det_per_parameter, self.condition)
    }

    /// `motion.cert.json`: the proved margin of each limit, as a part of it.
    pub fn certificate(&self) -> String {
        let part = |pieces: usize, margins: &[Margin]| -> Value {
            json!({"pieces": pieces, "margins": margins.iter().map(|of| margin(self, of)).collect::<Vec<_>>()})
        };
        let certificate = json!({
            "robot": self.robot,
            "duration": self.motion.duration(),
            "samples": super::proof::SAMPLES,
            "motion": part(self.proof.pieces, &self.proof.margins),
            "lead_in": part(self.of_lead_in.pieces, &self.of_lead_in.margins),
        });
        serde_json::to_string_pretty(&certificate).expect("strings and numbers always have a JSON form") + "\n"
    }
}
