//! Parallel axes in one orientation.
//!
//! Joints with parallel axes turn what they carry by the sum of their angles. Instead of turning everything joint by joint, the links
//! between them are described in axes that all share: those of the link before the first of them (angle 0), or those of one of their links.
//! Then only the bodies of these links and the offsets between the axes turn, which are constants. Loads from beyond turn once,
//! by the sum. Its sine and cosine are inputs, or formed by the addition theorem.

use super::super::arm::{Arm, Joint};
use super::super::plan::{Place, Plan};
use crate::pass::Pass;
use crate::ring::matrix::IDENTITY;
use crate::ring::{AngleSum, ExprId, Pool, Symbol};

/// An angle: sine, cosine, rate.
#[derive(Clone, Copy)]
struct Angle {
    sine: ExprId,
    cosine: ExprId,
    rate: ExprId,
    /// The joint variables that it is the sum of, if it is nothing but that.
    sum: Option<AngleSum>,
}

impl Angle {
    const ZERO: Angle = Angle { sine: ExprId::ZERO, cosine: ExprId::ONE, rate: ExprId::ZERO, sum: None };

    fn plus(self, pool: &mut Pool, other: Angle) -> Angle {
        let rate = pool.add(self.rate, other.rate);
        if let (Some(a), Some(b)) = (self.sum, other.sum) {
            let sum = a.plus(b);
            return Angle {
                sine: pool.symbol(Symbol::SineOf(sum)),
                cosine: pool.symbol(Symbol::CosineOf(sum)),
                rate,
                sum: Some(sum),
            };
        }
        Angle {
            sine: pool.dot(&[self.sine, self.cosine], &[other.cosine, other.sine]),
            cosine: pool.dot(&[self.cosine, -self.sine], &[other.cosine, other.sine]),
            rate,
            sum: None,
        }
    }

    fn negated(self) -> Angle {
        Angle { sine: -self.sine, rate: -self.rate, sum: None, ..self }
    }

    /// The angle of a joint; as an input of its own if `sums`.
    fn of(pool: &mut Pool, joint: &Joint, i: usize, sums: bool) -> Angle {
        let sum = sums.then(|| AngleSum::of(i as u16)).and_then(|own| {
            let turned = AngleSum { turned: true, ..own };
            let is_turned = pool.field().turn().is_some() && joint.sine == pool.symbol(Symbol::SineOf(turned));
            if is_turned {
                Some(turned)
            } else {
                (joint.sine == pool.symbol(Symbol::Sine(i as u16))).then_some(own)
            }
        });
        Angle { sine: joint.sine, cosine: joint.cosine, rate: joint.frame_rate, sum }
    }
}

/// Chooses axes for each run of joints with parallel axes.
pub(super) fn parallel_axes(pool: &mut Pool, arm: &mut Arm, plan: &mut Plan) {
    let children = |arm: &Arm, i: usize| -> Vec<usize> { (0..arm.dof()).filter(|&c| arm.joints[c].parent == Some(i)).collect() };
    // In a tree the joints of a run need not be consecutive, and a joint in two runs would be described in new axes twice.
    let mut taken = vec![false; arm.dof()];
    for first in 0..arm.dof() {
        if taken[first] {
            continue;
        }
        let mut run = vec![first];
        while let [only] = children(arm, *run.last().expect("not empty"))[..] {
            if arm.joints[only].fixed != IDENTITY {
                break;
            }
            run.push(only);
        }
        run.iter().for_each(|&i| taken[i] = true);
        let length = run.len();
        if length > 1 {
            // Way 0: each link in its own axes; 1: all in those of the link before; 1 + k: in those of link k of the run.
            let way = plan.way(Pass::ParallelAxes, Place::Joint(first), length + 2);
            if way > 0 {
                let sums = plan.has(Pass::AngleSums) && plan.way(Pass::AngleSums, Place::Joint(first), 2) == 0;
                orient(pool, arm, &run, way - 1, sums);
            }
        }
    }
}

/// Describes all links of the run but the last in axes at angle `reference` (0: of the link before, k: of the k-th link).
///
/// With `sums`, sines and cosines of sums of their angles are inputs. Otherwise the addition theorem forms them.
fn orient(pool: &mut Pool, arm: &mut Arm, run: &[usize], reference: usize, sums: bool) {
    let steps: Vec<Angle> = run.iter().map(|&i| Angle::of(pool, &arm.joints[i], i, sums)).collect();
    // The angle from link a of the run to link b, 0 being the link before it.
    let between = |pool: &mut Pool, a: usize, b: usize| -> Angle {
        let (low, high) = (a.min(b), a.max(b));
        let sum = steps[low..high].iter().fold(None, |sum: Option<Angle>, &step| {
            Some(match sum {
                None => step,
                Some(sum) => sum.plus(pool, step),
            })
        });
        let sum = sum.unwrap_or(Angle::ZERO);
        if a <= b {
            sum
        } else {
            sum.negated()
        }
    };
    let last = run.len();
    for (k, &i) in run.iter().enumerate() {
        // Axes of link k + 1 of the run and of the one before it.
        let axes = |k: usize| if k == 0 || k == last { k } else { reference };
        let turn = between(pool, axes(k), axes(k + 1));
        let own = between(pool, axes(k + 1), k + 1);
        let joint = &mut arm.joints[i];
        (joint.sine, joint.cosine, joint.frame_rate) = (turn.sine, turn.cosine, turn.rate);
        if k + 1 == last {
            continue;
        }
        let link = Joint { sine: own.sine, cosine: own.cosine, ..*joint };
        joint.link_rate = own.rate;
        joint.body = link.body_about_axis(pool, &link.body);
        joint.link_origin = link.about_axis(pool, &link.link_origin);
        let about_z = link.about_axis_matrix();
        joint.link_rotation = pool.product(&about_z, &link.link_rotation);
        joint.own_axes = pool.product(&about_z, &link.own_axes);
        for tool in arm.tools_of(i) {
            tool.origin = link.about_axis(pool, &tool.origin);
            tool.rotation = pool.product(&about_z, &tool.rotation);
        }
        for rotor in arm.rotors_on(i) {
            rotor.axis = link.about_axis(pool, &rotor.axis);
        }
        let next = run[k + 1];
        arm.joints[next].origin = link.about_axis(pool, &arm.joints[next].origin);
        if let Some(rotor) = &mut arm.joints[next].rotor {
            rotor.axis = link.about_axis(pool, &rotor.axis);
        }
    }
}
