//! Coordinates of coupled joints: along the chain q = S p + c, and so p = S⁻¹ (q - c) of the chain's solutions q.
//!
//! Solutions are told apart up to whole turns. That holds for p as for q if S and S⁻¹ take whole turns to whole turns: between joints that turn both
//! consist of whole numbers, and no joint slides as a coordinate turns.

use super::chain::BESIDE;
use super::is_prismatic;
use crate::exact::Number;
use crate::manipulator::{GivenBeside, Manipulator};

/// The coordinates of an arm with coupled joints, as many as there are joints between the base and the end effector.
#[derive(Clone, Debug)]
pub struct Coordinates {
    /// The names of these joints.
    pub joints: Vec<String>,
    /// Whether each of them slides.
    pub slides: Vec<bool>,
    /// The names of the coordinates.
    pub names: Vec<String>,
    /// q = S p + c.
    pub variables: Sums,
    /// p = S⁻¹ q - S⁻¹ c.
    pub coordinates: Sums,
}

/// Sums of the form `factors` x + `offset`.
#[derive(Clone, Debug)]
pub struct Sums {
    /// A row for each sum.
    pub factors: Vec<Vec<Number>>,
    /// The constant part of each sum, rad or m.
    pub offset: Vec<Number>,
}

const UNSOLVED: &str = "it is not solved for an arm with coupled joints: use its Jacobian, with damping";

impl Coordinates {
    /// Errors: the reason why the chain's solutions are not those of the arm.
    pub(super) fn of(manipulator: &Manipulator) -> Result<Coordinates, String> {
        let Some(coupling) = &manipulator.coupling else { return Err(UNSOLVED.into()) };
        let (tip, dof) = (manipulator.tip.index(), manipulator.dof());
        let path = manipulator.path_to(tip);
        if manipulator.coordinates_of(tip).len() < dof {
            return Err(BESIDE.into());
        }
        if path.len() != dof {
            return Err(UNSOLVED.into());
        }
        if let Some(GivenBeside::Joint(joint)) = manipulator.inverse_kinematics.given {
            if !path.contains(&joint.index()) {
                return Err("the joint that is given does not move the end effector".into());
            }
        }
        let variables = path.iter().map(|&joint| &coupling.variables[joint]);
        let row = |factors: &[(usize, Number)]| {
            let mut row = vec![Number::zero(); dof];
            factors.iter().for_each(|(a, factor)| row[*a] = factor.clone());
            row
        };
        let factors: Vec<Vec<Number>> = variables.clone().map(|variable| row(&variable.factors)).collect();
        let offset: Vec<Number> = variables.map(|variable| variable.offset.clone()).collect();
        let back = inverse(&factors).ok_or(UNSOLVED)?;
        let moved = back.iter().map(|row| {
            let terms = row.iter().zip(&offset);
            terms.fold(Number::zero(), |sum, (factor, c)| sum.minus(&factor.times(c)))
        });
        let coordinates = Sums { offset: moved.collect(), factors: back };
        // Factors that a description allows can have inverses that no scalar has.
        if coordinates.factors.iter().flatten().chain(&coordinates.offset).any(|number| !number.to_f32().is_finite()) {
            return Err(UNSOLVED.into());
        }
        let slides: Vec<bool> = path.iter().map(|&joint| is_prismatic(manipulator.joints[joint].kind)).collect();
        let of = manipulator.coordinates();
        let sliding: Vec<bool> = of.iter().map(|coordinate| is_prismatic(coordinate.joint.kind)).collect();
        if !keeps_turns(&factors, &slides, &sliding) || !keeps_turns(&coordinates.factors, &sliding, &slides) {
            return Err("it is not solved where a whole turn of a coordinate is no whole turn of each joint that moves with it, or the other way \
                        round: use its Jacobian, with damping"
                .into());
        }
        Ok(Coordinates {
            joints: path.iter().map(|&joint| manipulator.joints[joint].name.clone()).collect(),
            slides,
            names: of.iter().map(|coordinate| coordinate.joint.name.clone()).collect(),
            variables: Sums { factors, offset },
            coordinates,
        })
    }

    /// The joints whose variables a construction finds.
    pub(super) fn in_words(&self) -> String {
        match self.joints.as_slice() {
            [joint] => format!("q1 is the variable of {joint}, from which the coordinate follows"),
            joints => {
                format!("q1 to q{} are the variables of {}, from which the coordinates follow", joints.len(), joints.join(", "))
            }
        }
    }

    /// Each coordinate as a sum over joint variables, for people.
    pub(super) fn sums(&self) -> String {
        let sum = |((name, row), offset): ((&String, &Vec<Number>), &Number)| {
            let mut text = String::new();
            let mut add = |negative: bool, term: String| {
                text += match (negative, text.is_empty()) {
                    (false, true) => "",
                    (true, true) => "-",
                    (false, false) => " + ",
                    (true, false) => " - ",
                };
                text += &term;
            };
            for (i, factor) in row.iter().enumerate().filter(|(_, factor)| !factor.is_zero()) {
                let negative = factor.leads_negative();
                let size = if negative { -factor } else { factor.clone() };
                let size = match size.terms().count() {
                    _ if size.is_one() => String::new(),
                    1 => format!("{size}*"),
                    _ => format!("({size})*"),
                };
                add(negative, format!("{size}q{}", i + 1));
            }
            if !offset.is_zero() {
                let negative = offset.leads_negative();
                add(negative, if negative { -offset } else { offset.clone() }.to_string());
            }
            format!("{name} = {text}")
        };
        self.names.iter().zip(&self.coordinates.factors).zip(&self.coordinates.offset).map(sum).collect::<Vec<_>>().join(", ")
    }
}

/// Whether a whole turn of any variable changes all sums by whole turns, and no length.
fn keeps_turns(factors: &[Vec<Number>], sums: &[bool], of: &[bool]) -> bool {
    let is_whole = |factor: &Number| factor.as_rational().is_some_and(|factor| factor.is_int());
    factors.iter().zip(sums).all(|(row, slides)| {
        let turning = row.iter().zip(of).filter(|(_, sliding)| !**sliding);
        turning.map(|(factor, _)| factor).all(|factor| if *slides { factor.is_zero() } else { is_whole(factor) })
    })
}

/// The inverse of a square matrix; `None` of a singular one.
fn inverse(rows: &[Vec<Number>]) -> Option<Vec<Vec<Number>>> {
    let n = rows.len();
    let unit = |i: usize| (0..n).map(move |j| if i == j { Number::one() } else { Number::zero() });
    let mut rows: Vec<Vec<Number>> =
        rows.iter().enumerate().map(|(i, row)| row.iter().cloned().chain(unit(i)).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).find(|&i| rows[i][k].sign() != std::cmp::Ordering::Equal)?;
        rows.swap(k, pivot);
        let over = rows[k][k].inverse()?;
        let row: Vec<Number> = rows[k].iter().map(|entry| entry.times(&over)).collect();
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[k].clone();
            if i != k && !factor.is_zero() {
                other.iter_mut().zip(&row).for_each(|(entry, by)| *entry = entry.minus(&factor.times(by)));
            }
        }
        rows[k] = row;
    }
    Some(rows.into_iter().map(|row| row[n..].to_vec()).collect())
}
