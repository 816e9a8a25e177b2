//! Limits at all times, proved: Ehlich and Zeller's bound for joints, intervals over pieces of time for torques and frames.
//!
//! On a piece, q and its derivatives lie within their values in its middle and the bound of the next derivative. A torque is
//! within its value in the middle, plus half of the piece times the range of its derivative. Pieces are halved until the limit is proved.

use super::enclosure::{Interval, Moving, Stretch};
use super::model::{Limits, Model};
use super::motion::{Course, Motion};
use super::search::Bound;

/// A limit of a proof.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// The position of a joint.
    Position(usize),
    /// Its rate.
    Velocity(usize),
    /// Its acceleration.
    Acceleration(usize),
    /// Its torque or force.
    Effort(usize),
    /// The bound of this place among those of frames.
    Box(usize),
}

/// What is proved of a limit: |x - middle| is at most (1 - margin) times half of the range.
#[derive(Clone, Debug, PartialEq)]
pub struct Margin {
    /// The limit.
    pub kind: Kind,
    /// The proved part of the limit that is left.
    pub margin: f64,
}

/// A limit that is not proved.
#[derive(Clone, Debug, PartialEq)]
pub struct Unproved {
    /// The limit.
    pub kind: Kind,
    /// s, from the beginning of the motion.
    pub time: f64,
    /// By what part the limit is exceeded there; at most 0: pieces would have to be shorter.
    pub excess: f64,
}

/// A proof.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proof {
    /// Of each finite limit.
    pub margins: Vec<Margin>,
    /// Pieces of time.
    pub pieces: usize,
}

/// Samples for the bounds of joints.
pub(super) const SAMPLES: usize = 2000;
/// Pieces at first, and the shortest, as parts of the duration.
const PIECES: usize = 256;
const SHORTEST: f64 = 1.0 / 65_536.0;

/// Positions, rates and accelerations of a trigonometric motion.
pub(super) fn joints(motion: &Motion, limits: &Limits) -> Result<Vec<Margin>, Unproved> {
    let mut margins = Vec::new();
    for joint in 0..motion.dof() {
        let symmetric = |x: f64| [-x, x];
        let ranges = [limits.position[joint], symmetric(limits.velocity[joint]), symmetric(limits.acceleration[joint])];
        for (derivative, [low, high]) in ranges.into_iter().enumerate().filter(|(_, [low, high])| (high - low).is_finite()) {
            let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
            let margin = 1.0 - motion.largest(joint, derivative, middle, SAMPLES) / half * (1.0 + 1e-15);
            let kind = [Kind::Position(joint), Kind::Velocity(joint), Kind::Acceleration(joint)][derivative].clone();
            if margin < 0.0 {
                return Err(Unproved { kind, time: 0.0, excess: -margin });
            }
            margins.push(Margin { kind, margin });
        }
    }
    Ok(margins)
}

/// Torques and frames of a course.
pub(super) fn pieces(model: &Model, limits: &Limits, bounds: &[Bound], course: &dyn Course) -> Result<Proof, Unproved> {
    let n = model.joints;
    let fourth: Vec<f64> = (0..n).map(|joint| course.fourth(joint)).collect();
    let of_pieces = Pieces { model, limits, bounds, course, fourth };
    let mut proof = Proof::default();
    let efforts = (0..n).filter(|&joint| limits.effort[joint].is_finite()).map(Kind::Effort);
    proof.margins = efforts.chain((0..bounds.len()).map(Kind::Box)).map(|kind| Margin { kind, margin: f64::INFINITY }).collect();
    let duration = course.duration();
    for k in 0..PIECES {
        of_pieces.prove(duration * k as f64 / PIECES as f64, duration * (k + 1) as f64 / PIECES as f64, &mut proof)?;
    }
    Ok(proof)
}

struct Pieces<'a> {
    model: &'a Model,
    limits: &'a Limits,
    bounds: &'a [Bound],
    course: &'a dyn Course,
    fourth: Vec<f64>,
}

impl Pieces<'_> {
    /// Proves the piece, or its halves.
    fn prove(&self, start: f64, end: f64, proof: &mut Proof) -> Result<(), Unproved> {
        let middle = (start + end) / 2.0;
        let margins = self.margins(start, end);
        if let Some(worst) = (0..margins.len())
            .filter(|&k| margins[k].is_nan() || margins[k] < 0.0)
            .max_by(|&a, &b| margins[b].total_cmp(&margins[a]))
        {
            let at = self.margins(middle, middle);
            let is_short = end - start <= SHORTEST * self.course.duration();
            if let Some(k) = (0..at.len()).find(|&k| at[k] < -1e-9) {
                return Err(Unproved { kind: proof.margins[k].kind.clone(), time: middle, excess: -at[k] });
            } else if is_short {
                return Err(Unproved { kind: proof.margins[worst].kind.clone(), time: middle, excess: -at[worst] });
            }
            self.prove(start, middle, proof)?;
            return self.prove(middle, end, proof);
        }
        proof.pieces += 1;
        proof.margins.iter_mut().zip(margins).for_each(|(of, margin)| of.margin = of.margin.min(margin));
        Ok(())
    }

    /// What is left of each limit on a piece, at least.
    fn margins(&self, start: f64, end: f64) -> Vec<f64> {
        let n = self.model.joints;
        let middle = (start + end) / 2.0;
        // A little more than half, so that rounding of the ends leaves no time out.
        let half = (end - start) / 2.0 * (1.0 + 1e-9) + 1e-15 * end;
        let mut over: [Vec<Moving>; 3] = std::array::from_fn(|_| Vec::with_capacity(n));
        let mut at: [Vec<Moving>; 3] = std::array::from_fn(|_| Vec::with_capacity(n));
        for joint in 0..n {
            let x = self.course.at(joint, middle);
            // Rounding of sums of sines.
            let near = |x: f64| 1e-13 * (1.0 + x.abs());
            let mut bound = self.fourth[joint];
            let mut ranges = [Interval::point(0.0); 4];
            for d in (0..4).rev() {
                ranges[d] = Interval::around(x[d], half * bound + near(x[d]));
                bound = ranges[d].size();
            }
            for d in 0..3 {
                over[d].push(Moving { value: ranges[d], slope: ranges[d + 1] });
                at[d].push(Moving { value: Interval::around(x[d], near(x[d])), slope: Interval::point(0.0) });
            }
        }
        let of = |program: &armgen_evaluate::Program<f64>, still: bool| -> Vec<Interval> {
            let zero = vec![Moving { value: Interval::point(0.0), slope: Interval::point(0.0) }; n];
            let run = |x: &[Vec<Moving>; 3]| {
                let arguments = if still { [&x[0][..], &zero, &zero] } else { [&x[0][..], &x[1], &x[2]] };
                program.over(&mut Stretch { arguments }).expect("a program of codegen")
            };
            let (over, at) = (run(&over), run(&at));
            let step = Interval(-half, half);
            over.iter().zip(at).map(|(over, at)| over.value.and(at.value + over.slope * step)).collect()
        };
        let mut margins = Vec::new();
        if self.limits.effort.iter().any(|effort| effort.is_finite()) {
            let bare = of(&self.model.bare, false);
            let has_load = self.model.friction.iter().any(|friction| friction.terms[3] != 0.0);
            let gravity = if has_load { of(&self.model.bare, true) } else { vec![Interval::point(0.0); n] };
            for joint in (0..n).filter(|&joint| self.limits.effort[joint].is_finite()) {
                let dq = over[1][joint].value;
                let (terms, velocity) = (self.model.friction[joint].terms, self.model.friction[joint].velocity);
                let [viscous, coulomb, offset, load, cubic, stribeck] = terms;
                let fading = (-((1.0 / velocity) * dq.abs())).exp();
                let dry = Interval::point(coulomb) + stribeck * fading + load * gravity[joint].abs();
                let friction = viscous * dq + dq.sign() * dry + Interval::point(offset) + cubic * (dq * dq * dq);
                margins.push(1.0 - (bare[joint] + friction).size() / self.limits.effort[joint] * (1.0 + 1e-15));
            }
        }
        for (function, (_, program)) in self.model.frames.iter().enumerate() {
            if self.bounds.iter().any(|bound| bound.function == function) {
                let entries = of(program, false);
                for bound in self.bounds.iter().filter(|bound| bound.function == function) {
                    let (middle, half) = ((bound.low + bound.high) / 2.0, (bound.high - bound.low) / 2.0);
                    margins.push(1.0 - (entries[bound.entry] - Interval::point(middle)).size() / half * (1.0 + 1e-15));
                }
            }
        }
        margins
    }
}
