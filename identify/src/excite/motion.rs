//! The motions of an excitation: a trigonometric one that repeats itself, and a quintic that leads to it from rest.
//!
//! ```text
//! q_j(t) = q0_j + sum_k a_jk/(k w) sin(k w t) - b_jk/(k w) cos(k w t),    k = 1...H
//! sum_k a_jk = 0,   sum_k k b_jk = 0:  dq(0) = ddq(0) = 0
//! ```

/// A trigonometric motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// 2 pi / duration, rad/s.
    pub w: f64,
    /// Middle positions, by joint; rad or m.
    pub q0: Vec<f64>,
    /// Amplitudes of the rates, by joint and harmonic; rad/s or m/s.
    pub a: Vec<Vec<f64>>,
    /// The same.
    pub b: Vec<Vec<f64>>,
}

/// From rest to rest: s = 10 u³ - 15 u⁴ + 6 u⁵ of the way, u = t/duration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeadIn {
    /// s.
    pub duration: f64,
    /// Where it starts, by joint.
    pub from: Vec<f64>,
    /// Where it ends.
    pub to: Vec<f64>,
}

/// A motion with derivatives: what a proof needs of it.
pub trait Course: Sync {
    /// s.
    fn duration(&self) -> f64;

    /// q and its first three derivatives of a joint.
    fn at(&self, joint: usize, t: f64) -> [f64; 4];

    /// A bound of the fourth derivative of a joint.
    fn fourth(&self, joint: usize) -> f64;
}

/// The highest rate of a quintic from rest to rest, times duration over way.
pub(super) const QUINTIC_RATE: f64 = 15.0 / 8.0;
/// The highest acceleration of it, times duration² over way: 10/sqrt(3), rounded up.
pub(super) const QUINTIC_ACCELERATION: f64 = 5.773_502_691_896_26;

impl Course for Motion {
    fn duration(&self) -> f64 {
        std::f64::consts::TAU / self.w
    }

    fn at(&self, joint: usize, t: f64) -> [f64; 4] {
        let mut x = [self.q0[joint], 0.0, 0.0, 0.0];
        for (k, (a, b)) in self.a[joint].iter().zip(&self.b[joint]).enumerate() {
            let w = (k + 1) as f64 * self.w;
            let (sine, cosine) = (w * t).sin_cos();
            x[0] += (a * sine - b * cosine) / w;
            x[1] += a * cosine + b * sine;
            x[2] += w * (b * cosine - a * sine);
            x[3] -= w * w * (a * cosine + b * sine);
        }
        x
    }

    fn fourth(&self, joint: usize) -> f64 {
        let of = |(k, (a, b)): (usize, (&f64, &f64))| a.hypot(*b) * ((k + 1) as f64 * self.w).powi(3);
        self.a[joint].iter().zip(&self.b[joint]).enumerate().map(of).sum()
    }
}

impl Course for LeadIn {
    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, joint: usize, t: f64) -> [f64; 4] {
        let (way, u) = (self.to[joint] - self.from[joint], (t / self.duration).clamp(0.0, 1.0));
        let v = 1.0 - u;
        [
            self.from[joint] + way * (u * u * u * (10.0 - u * (15.0 - 6.0 * u))),
            way / self.duration * (30.0 * u * u * v * v),
            way / self.duration.powi(2) * (60.0 * u * v * (1.0 - 2.0 * u)),
            way / self.duration.powi(3) * (60.0 - 360.0 * u * v),
        ]
    }

    fn fourth(&self, joint: usize) -> f64 {
        360.0 * (self.to[joint] - self.from[joint]).abs() / self.duration.powi(4)
    }
}

impl Motion {
    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.q0.len()
    }

    /// Number of harmonics.
    pub fn harmonics(&self) -> usize {
        self.a.first().map_or(0, Vec::len)
    }

    /// The largest |x - middle| over all times of a derivative of a joint, from `samples` even points.
    ///
    /// A trigonometric polynomial of degree H exceeds its samples at M > 2H even points at most by the factor 1/cos(pi H/M) (Ehlich and
    /// Zeller, Math. Z. 86, 1964).
    pub fn largest(&self, joint: usize, derivative: usize, middle: f64, samples: usize) -> f64 {
        let period = self.duration();
        let size = |k: usize| (self.at(joint, period * k as f64 / samples as f64)[derivative] - middle).abs();
        let largest = (0..samples).map(size).fold(0.0, f64::max);
        // Rounding of the samples: sums of few terms that are not much larger than their sum.
        let terms = self.a[joint].iter().chain(&self.b[joint]).map(|x| x.abs()).sum::<f64>();
        let size =
            terms * (self.harmonics() as f64 * self.w).powi(derivative as i32 - 1).max(1.0) + self.q0[joint].abs() + middle.abs();
        largest / (std::f64::consts::PI * self.harmonics() as f64 / samples as f64).cos() + 1e-13 * size
    }
}

/// A lead-in of the shortest duration, a multiple of `step`, that keeps rates and accelerations.
pub(super) fn lead_in(from: &[f64], to: &[f64], velocity: &[f64], acceleration: &[f64], step: f64) -> LeadIn {
    let shortest = |j: usize| {
        let way = (to[j] - from[j]).abs();
        (QUINTIC_RATE * way / velocity[j]).max((QUINTIC_ACCELERATION * way / acceleration[j]).sqrt())
    };
    let duration = (0..from.len()).map(shortest).fold(0.0, f64::max);
    let steps = (duration * (1.0 + 1e-9) / step).ceil().max(1.0);
    LeadIn { duration: steps * step, from: from.to_vec(), to: to.to_vec() }
}
