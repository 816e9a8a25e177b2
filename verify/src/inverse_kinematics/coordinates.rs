//! Coordinates of coupled joints: that the text turns the chain's solutions q into p = S⁻¹ (q - c), and that whole turns of p are whole turns of q.

use std::cmp::Ordering;

use armgen_description::exact::Number;
use armgen_description::kinds::JointKind;
use armgen_description::manipulator::Manipulator;

use super::is_nearest;
use super::text::Text;
use crate::textbook::equations::arm::formula;
use crate::values::check::Check;
use crate::values::formula::Formula;

/// Checks the constants of coordinates; returns their exact values.
///
/// - `claimed`: the generator's S⁻¹ and -S⁻¹ c, which are multiplied by S here.
pub(super) fn check(
    module: &Text,
    manipulator: &Manipulator,
    claimed: &Option<(Vec<Vec<Number>>, Vec<Number>)>,
) -> Result<Vec<Formula>, String> {
    let (Some(of), Some((factors, offset)), Some(coupling)) = (&module.coordinates, claimed, &manipulator.coupling) else {
        if module.coordinates.is_some() || manipulator.coupling.is_some() {
            return Err("COORDINATES: an arm has them if its joints are coupled".into());
        }
        return Ok(Vec::new());
    };
    let n = module.dof;
    let path = manipulator.path_to(manipulator.tip.index());
    let slides = |joint: usize| manipulator.joints[joint].kind == JointKind::Prismatic;
    if !path.iter().map(|&joint| slides(joint)).eq(of.slides.iter().copied()) {
        return Err("JOINT_SLIDES: a joint is of the other kind".into());
    }
    let row = |&joint: &usize| {
        let variable = &coupling.variables[joint];
        let factor = |a| variable.factors.iter().find(|(of, _)| *of == a).map_or_else(Number::zero, |(_, factor)| factor.clone());
        ((0..n).map(factor).collect::<Vec<_>>(), variable.offset.clone())
    };
    let (variables, constants): (Vec<Vec<Number>>, Vec<Number>) = path.iter().map(row).unzip();
    let is_square = |rows: &[Vec<Number>]| rows.len() == n && rows.iter().all(|row| row.len() == n);
    if !is_square(&variables) || !is_square(factors) || offset.len() != n {
        return Err("COORDINATES: there are not as many joints to the end effector as coordinates".into());
    }
    let dot = |row: &[Number], column: &mut dyn Iterator<Item = &Number>| {
        row.iter().zip(column).fold(Number::zero(), |sum, (x, y)| sum.plus(&x.times(y)))
    };
    for (a, row) in factors.iter().enumerate() {
        let unit = (0..n).all(|b| {
            let entry = dot(row, &mut variables.iter().map(|of| &of[b]));
            let wanted = if a == b { Number::one() } else { Number::zero() };
            entry.minus(&wanted).sign() == Ordering::Equal
        });
        let still = dot(row, &mut constants.iter()).plus(&offset[a]).sign() == Ordering::Equal;
        if !(unit && still) {
            return Err(format!("COORDINATES: row {} is not that of the inverse of the coupling", a + 1));
        }
    }
    let turning: Vec<bool> = manipulator.coordinates().iter().map(|of| of.joint.kind == JointKind::Revolute).collect();
    let joints: Vec<bool> = of.slides.iter().map(|slides| !slides).collect();
    let keeps_turns = keeps_turns(&variables, &joints, &turning) && keeps_turns(factors, &turning, &joints);
    if !keeps_turns && Check::WholeTurns.is_made() {
        return Err("COORDINATES: whole turns of joints and of coordinates are not the same".into());
    }
    let exact = |factors: &[Vec<Number>], offset: &[Number]| -> Vec<Formula> {
        factors.iter().flatten().chain(offset).map(formula).collect()
    };
    let values = exact(factors, offset);
    let back = if of.back.is_empty() { Vec::new() } else { exact(&variables, &constants) };
    for (text, exact) in of.numbers.iter().zip(&values).chain(of.back.iter().zip(&back)) {
        if !is_nearest(module, text, exact) && Check::Coordinates.is_made() {
            return Err(format!("COORDINATES: {text} is not the float nearest to {exact}"));
        }
    }
    Ok(values.into_iter().chain(back).collect())
}

/// Whether a whole turn of any variable changes all sums by whole turns, and no length; `sums`, `of`: which of them turn.
fn keeps_turns(factors: &[Vec<Number>], sums: &[bool], of: &[bool]) -> bool {
    let is_kept = |factor: &Number, turns: bool| {
        let whole = factor.as_rational().is_some_and(|factor| factor.is_int());
        if turns {
            whole
        } else {
            factor.sign() == Ordering::Equal
        }
    };
    factors.iter().zip(sums).all(|(row, turns)| row.iter().zip(of).all(|(factor, of)| !of || is_kept(factor, *turns)))
}
