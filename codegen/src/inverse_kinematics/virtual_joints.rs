//! A pose for an arm with fewer than six joints: virtual joints beyond the last one make it an arm of a class, and have to come out 0.
//!
//! Virtual joints are found by trial, simple ones first: three turns and three slides, a wrist through a point that the pose
//! fixes, a turn across the last axis. The completed arm must be regular at a general posture of the arm itself, with the virtual
//! joints at 0. Then its solutions there are isolated and simple, and a construction lists all of them. The test is a Jacobian of
//! full rank at a random posture of a prime field.

use super::chain::{Chain, Virtual};
use super::classes;
use super::{always_moves, InverseKinematics, Target};
use crate::exact::Number;

/// (cos, sin) of an angle that no arm has: from a triple of Pythagoras.
fn angle(c: i64, s: i64, r: i64) -> [Number; 2] {
    [c, s].map(|x| Number::from(x).checked_div(&Number::from(r)).unwrap_or_else(Number::zero))
}

fn none() -> [Number; 2] {
    [Number::one(), Number::zero()]
}

fn right() -> [Number; 2] {
    [Number::zero(), Number::one()]
}

/// A turn about an axis that crosses the one before it at right angles, so far from the foot of the common normal: two of them reach any rotation.
fn across(d: Number) -> Virtual {
    Virtual { prismatic: false, turn: angle(4, 3, 5), d: Some(d), a: Number::zero(), alpha: right() }
}

/// A turn at a distance from the axis before it.
fn beside(a: &Number, alpha: [Number; 2]) -> Virtual {
    Virtual { prismatic: false, turn: angle(4, 3, 5), d: Some(Number::zero()), a: a.clone(), alpha }
}

/// A slide along or across the axis before it.
fn slide(turn: [Number; 2], alpha: [Number; 2]) -> Virtual {
    Virtual { prismatic: true, turn, d: None, a: Number::zero(), alpha }
}

/// Ways to make an arm one of a class, by preference.
fn ways(chain: &Chain, length: &Number) -> Vec<Vec<Virtual>> {
    let own = chain.joints.len();
    let slides = chain.joints.iter().filter(|joint| joint.prismatic).count();
    let turns = own - slides;
    let mut ways: Vec<Vec<Virtual>> = Vec::new();
    // All axes parallel: four joints, the last one a turn.
    let flat = beside(length, none());
    match (turns, own) {
        (3, 3) => ways.push(vec![slide(none(), none())]),
        (2, 3) => ways.extend([vec![slide(none(), none())], vec![flat.clone()]]),
        (2, 2) => ways.push(vec![flat.clone(), slide(none(), none())]),
        _ => {}
    }
    // Three turns, three slides.
    if turns <= 3 && slides <= 3 {
        let more = vec![across(Number::zero()); 3 - turns];
        let all = [slide(none(), none()), slide(none(), right()), slide(right(), right())];
        for first in 0..=slides {
            let mut way = more.clone();
            way.extend(all[first..first + 3 - slides].iter().cloned());
            ways.push(way);
        }
    }
    // A wrist of three turns: about the last axis and two across it, or all after the third joint.
    let (o, skew) = (Number::zero, angle(3, 4, 5));
    let wrist = |d: &Number| [across(d.clone()), across(Number::zero())];
    match own {
        5 => {
            for first in [across(o()), across(length.clone()), beside(length, none()), beside(length, skew.clone())] {
                ways.push(vec![first]);
            }
            ways.push(vec![slide(angle(4, 3, 5), skew)]);
        }
        4 => {
            ways.extend([o(), length.clone()].map(|d| wrist(&d).to_vec()));
            ways.push([vec![beside(length, skew.clone())], vec![across(o())]].concat());
            ways.push(vec![beside(length, skew.clone()), beside(length, skew)]);
        }
        _ => {
            let triple = [vec![beside(length, skew.clone())], wrist(&o()).to_vec()].concat();
            let between = [beside(length, skew.clone()), beside(length, none()), slide(none(), none()), slide(right(), skew)];
            let mut starts: Vec<Vec<Virtual>> = vec![vec![]];
            for _ in own..3 {
                starts = starts
                    .iter()
                    .flat_map(|start| between.iter().map(|one| [start.clone(), vec![one.clone()]].concat()))
                    .collect();
            }
            ways.extend(starts.into_iter().map(|start| [start, triple.clone()].concat()));
        }
    }
    ways
}

/// An arm of fewer than six joints, or why there is no construction for it: of the ways to complete it the first whose solutions have closed forms,
/// else the first of any class.
pub(super) fn classify(chain: &Chain, length: &Number) -> Result<InverseKinematics, String> {
    let own = chain.joints.len();
    if let Ok(found) = classes::classify(chain, Target::Pose, length) {
        return Ok(found);
    }
    let completed = |way: &Vec<Virtual>| {
        let mut completed = chain.clone();
        way.iter().for_each(|one| completed.virtual_at_the_end(one));
        completed
    };
    let regular = |completed: &Chain| !always_moves(completed);
    let all: Vec<Chain> = ways(chain, length).iter().map(completed).filter(regular).collect();
    let closed = all.iter().find_map(|completed| classes::closed_form(completed, Target::Pose, length).ok());
    let found =
        closed.map_or_else(|| all.iter().find_map(|completed| classes::classify(completed, Target::Pose, length).ok()), Some);
    let mut found = found.ok_or_else(|| format!("there is no construction for a pose and {own} joints of this geometry"))?;
    // Joints after the last that stay at 0, at any place.
    let mut still = chain.clone();
    (own..6).for_each(|_| still.virtual_at_the_end(&Virtual { d: None, ..across(Number::zero()) }));
    found.own = Some(still.arranged(0, false));
    let more = found.loops()[0].order.len() - own;
    let joints = if own == 1 { "1 joint".to_owned() } else { format!("{own} joints") };
    let more = if more == 1 { "a virtual joint that has".to_owned() } else { format!("{more} virtual joints that have") };
    found.class = format!("{joints} and {more} to come out 0, {}", found.class);
    Ok(found)
}
