//! Whether a function takes its arguments to the powers that its equations take them to, entry by entry, so that what is found in a box
//! holds outside.
//!
//! A polynomial that is added and taken away again is nothing over the reals, and loses all digits where it is large. With f an entry of a function
//! as it is written and f* the same of the equations, as a plain program computes them ([`growth`](mod@crate::arithmetic::growth)):
//!
//! ```text
//! degree of f in q[k], tau[k]                                         at most that of f*
//! degree of f in dq[k], dqr[k], ddq[k], ddqr[k]                       at most that of any entry, and where the function does not take q that of f*
//! degree of f in all entries of an argument, and in all arguments     at most that of f*
//! the same in a column of a base parameter                            at most that of any entry, and of any torque
//! degree of f in pi[k]                                                at most that of any entry of the function, and 1
//! degree of f in sin q[k], cos q[k]                                   at most twice that of f*, and a square
//! an angle is q_i ± ... ± q_j of revolute joints with parallel axes, none between them left out, as the axes point
//! a function has an angle with q_k and others, or q_k as a length, only if an entry of it depends on q_k
//! ```
//!
//! A sine of one joint variable has its digits however large that is; a sum of two has lost those of the smaller one. So sums are those of
//! frames, and in a function that does not depend on a variable there is no sum with it. Emitted functions have parameters, rates,
//! accelerations and angles in common that cancel in single entries, and sines that a plain program multiplies out: those limits are wider.
//!
//! Where a function divides, what no quotient takes part in is held to the largest degrees of torques, Jacobian and mass, and the whole to
//! those in all entries of each argument but the joint variables.

use std::collections::BTreeMap;

use armgen_description::manipulator::Manipulator;

use crate::arithmetic::growth::{Beyond, Growth, Growths};
use crate::arithmetic::Arithmetic;
use crate::base::{self, OwnParameters};
use crate::check::Check;
use crate::divisors::{needed, undivided_operands, Matrix};
use crate::element::Element;
use crate::equations::arm::Arm;
use crate::equations::parameters::Vector;
use crate::equations::pose::Pose;
use crate::equations::state::State;
use crate::float::Arguments;
use crate::formula::Formula;
use crate::program::{Angle, Argument, Program, Step};
use crate::reference::{BaseParameters, Reference, Wanted, BASE_REGRESSOR};

/// Joints, one a bit.
type Joints = u64;

/// Powers and angles of the equations of an arm.
pub struct Powers {
    growths: Growths,
    /// By function, entry by entry.
    own: BTreeMap<String, Vec<Growth>>,
    /// The largest of all torques, with the torques that are given; and of what else is inverted or multiplied by an inverse.
    torques: Growth,
    mobility: Growth,
    /// For each revolute joint the run of parallel axes that it is in, its place there, and which way it points.
    axes: Option<Vec<Option<(usize, usize, bool)>>>,
    /// By function: joint variables, of those in sums and lengths, that the equations depend on.
    depends: BTreeMap<String, Joints>,
    /// Axes that are neither parallel nor perpendicular to the next one.
    oblique: usize,
}

/// The arguments, each of which is a letter, of the equations.
fn letters(growths: &Growths, joints: usize, vector: &Vector) -> State<Growth> {
    let of = |argument: Argument| (0..joints).map(|k| growths.of(argument, k)).collect();
    let pi = match vector {
        Vector::Names(ids) => ids.len(),
        Vector::Standard(all) => all.len(),
        // Drawn.
        Vector::Base(..) => 0,
    };
    let arguments = Arguments::each(|argument| match argument {
        Argument::Pi => (0..pi).map(|k| growths.of(Argument::Pi, k)).collect(),
        of_joints => of(of_joints),
    });
    let circle = |k: usize| (growths.circle([(k, 1)]), growths.circle([(k, 1)]));
    let (zero, one) = (growths.integer(0), growths.integer(1));
    let stribeck = vec![one.clone(); joints];
    State { stribeck, ..State::of(arguments, (0..joints).map(circle).collect(), vec![one.clone(); joints], [zero, one]) }
}

impl Powers {
    /// Those of an arm, for functions with such joint variables in sums and lengths ([`joints_asked`]); what they depend on is found in a
    /// field, if there is one.
    pub fn new<K: Arithmetic + Clone>(
        manipulator: &Manipulator,
        vector: &Vector,
        base: Option<&OwnParameters>,
        parameters: usize,
        asked: Joints,
        field: Option<&K>,
    ) -> Result<Powers, String> {
        let divided = || "a constant of the description divides by zero".to_string();
        let joints = manipulator.joints.len();
        let mut growths = Growths::new(joints, parameters);
        let state = letters(&growths, joints, vector);
        let wanted = Wanted { base: BaseParameters::Kept, pivots: false };
        let named = base.map(|base| base.named.as_slice());
        let mut own = base::values_in_numbers(&mut growths, manipulator, vector, named, state, wanted)?;
        // Which of a kind a column of base parameters is made of is the generator's choice, and may be a pair that cancels.
        let torques = own.get("inverse_dynamics").cloned().unwrap_or_default();
        let with_torques = |columns: &[Growth]| columns.iter().chain(&torques).fold(growths.integer(0), Growth::most);
        if let (Vector::Base(..), Some(columns)) = (vector, own.get_mut("regressor")) {
            let most = with_torques(columns);
            columns.fill(most);
        }
        if let Some(columns) = own.get_mut(BASE_REGRESSOR) {
            let most = with_torques(columns);
            columns.fill(most);
        }
        let largest = |names: &[&str]| {
            let entries = names.iter().filter_map(|name| own.get(*name)).flatten();
            entries.fold(growths.integer(0), Growth::most)
        };
        let tau = (0..joints).map(|k| growths.of(Argument::Tau, k)).fold(growths.integer(0), |most, tau| most.most(&tau));
        let torques = largest(&["inverse_dynamics", "inverse_dynamics_with", "inverse_dynamics_derivatives"]).most(&tau);
        let mobility = largest(&["inertia_matrix", "geometric_jacobian"]);
        let (axes, oblique) = match field {
            Some(field) => {
                let mut field = field.clone();
                let names = Arm::nominal(&field, manipulator).ok_or_else(divided)?;
                let arm = Arm::new(&field, manipulator, &names).ok_or_else(divided)?;
                let pose = Pose::new(&arm, &State::draw(&mut field, arm.dof()));
                (Some(parallel(&arm, &pose)), oblique(&pose))
            }
            None => (None, 0),
        };
        let depends = match field {
            Some(field) if asked != 0 => depends(&mut field.clone(), manipulator, vector, asked)?,
            _ => BTreeMap::new(),
        };
        Ok(Powers { growths, own, torques, mobility, axes, depends, oblique })
    }

    /// The number of axes that are neither parallel nor perpendicular to the next one.
    pub fn oblique(&self) -> usize {
        self.oblique
    }

    /// A power or an angle that the equations of a function do not have; `values` are the exact ones of its literals.
    pub fn fault(&self, program: &Program, values: &[Formula]) -> Option<String> {
        self.growth_fault(program, values)
            .filter(|_| Check::Growth.is_made())
            .or_else(|| self.angle_fault(program).filter(|_| Check::Frames.is_made()))
            .or_else(|| self.dependence_fault(program).filter(|_| Check::Dependence.is_made()))
    }

    fn growth_fault(&self, program: &Program, values: &[Formula]) -> Option<String> {
        let literals: Vec<Growth> =
            program.exact_literals(values).iter().map(|value| self.growths.constant(value)).collect::<Option<_>>()?;
        let run = |program: &Program| {
            let zero = |entry: Option<Growth>| entry.unwrap_or(self.growths.integer(0));
            program.run(&self.growths, &literals).into_iter().map(zero).collect::<Vec<_>>()
        };
        let own = self.own.get(&program.name)?;
        let found = run(program);
        let say = |place: &str, Beyond { of, found, own }: Beyond| {
            let place = if place.is_empty() { String::new() } else { format!("in {place} ") };
            format!("{place}it takes {of} to the power {found} where its equations have {own}")
        };
        let most = |entries: &[Growth]| entries.iter().fold(self.growths.integer(0), Growth::most);
        let operands = undivided_operands(program);
        if operands.is_empty() {
            let all = most(own);
            return found.iter().zip(own).zip(&program.outputs).find_map(|((found, own), output)| {
                // Without frames that pass rates on, none cancels.
                let of_motion = if program.arguments.contains(&Argument::Q) { &all } else { own };
                let beyond = found.entry_beyond(own, of_motion, &all, &self.growths).or_else(|| found.total_beyond(own));
                Some(say(&output.place, beyond.or_else(|| found.sum_beyond(own))?))
            });
        }
        // A quotient of polynomials in the joint variables has no degree that the text shows; what it is made of are parts of torques.
        let parts = match needed(&program.name) {
            [Matrix::Mass | Matrix::MassWith, ..] => most(own),
            [_, Matrix::Mobility, ..] => self.mobility.clone(),
            _ => self.torques.clone(),
        };
        let of_parts = most(&run(&program.part(&operands))).entry_beyond(&parts, &parts, &parts, &self.growths);
        let of_whole = most(&found).total_beyond(&most(own)).filter(|beyond| beyond.of != "`q`");
        of_parts.or(of_whole).map(|beyond| say("", beyond))
    }

    /// An angle that no frame is turned by.
    fn angle_fault(&self, program: &Program) -> Option<String> {
        let axes = self.axes.as_ref()?;
        let is_of_frames = |angle: &Angle| {
            let places: Option<Vec<(usize, usize, bool)>> =
                angle.terms.iter().map(|&(joint, _)| axes.get(joint).copied().flatten()).collect();
            places.is_some_and(|places| {
                let signs = angle.terms.iter().zip(&places).map(|(&(_, factor), &(.., points))| (factor > 0) == points);
                let signs: Vec<bool> = signs.collect();
                places.windows(2).all(|pair| pair[0].0 == pair[1].0 && pair[0].1 + 1 == pair[1].1)
                    && signs.windows(2).all(|pair| pair[0] == pair[1])
            })
        };
        let angle = angles(program).find(|angle| !is_of_frames(angle))?;
        let terms: Vec<String> = angle.terms.iter().map(|(joint, _)| format!("`q[{joint}]`")).collect();
        Some(format!("it has an angle of {}, by which no frame is turned against another", terms.join(", ")))
    }

    /// A joint variable, in a sum or as a length, that no entry depends on.
    fn dependence_fault(&self, program: &Program) -> Option<String> {
        let foreign = joints_asked(std::iter::once(program)) & !self.depends.get(&program.name)?;
        let joint = foreign.trailing_zeros();
        (foreign != 0).then(|| {
            let taken = lengths(program) >> joint & 1 == 1;
            let how = if taken { format!("takes `q[{joint}]`") } else { format!("has an angle with `q[{joint}]` and others") };
            format!("it {how}, which its equations do not depend on")
        })
    }
}

/// The steps that entries need.
fn needed_steps(program: &Program) -> impl Iterator<Item = &Step> {
    let entries: Vec<usize> = program.outputs.iter().map(|output| output.step).collect();
    program.steps.iter().zip(program.needed(&entries)).filter_map(|(step, needed)| needed.then_some(step))
}

/// The angles that entries need.
fn angles(program: &Program) -> impl Iterator<Item = &Angle> {
    needed_steps(program).filter_map(|step| match step {
        Step::Sine(angle) | Step::Cosine(angle) => Some(angle),
        _ => None,
    })
}

/// The joints of an angle with several.
fn joints_of(angle: &Angle) -> Joints {
    if angle.terms.len() < 2 {
        return 0;
    }
    angle.terms.iter().filter(|(joint, _)| *joint < 64).fold(0, |all, (joint, _)| all | 1 << joint)
}

/// All joint variables in angles of several, and those that are taken as lengths.
pub fn joints_asked<'a>(programs: impl Iterator<Item = &'a Program>) -> Joints {
    programs.fold(0, |all, program| angles(program).fold(all | lengths(program), |all, angle| all | joints_of(angle)))
}

/// The joint variables that entries take as they are, not in an angle.
fn lengths(program: &Program) -> Joints {
    needed_steps(program).fold(0, |all, step| match step {
        Step::Input(Argument::Q, joint) if *joint < 64 => all | 1 << joint,
        _ => all,
    })
}

/// Axes that are neither parallel nor perpendicular to the next one: those that are so at a random state are so at all, since an axis is fixed in the
/// frame of the joint before it.
fn oblique<E: Element>(pose: &Pose<E>) -> usize {
    let is_oblique = |pair: &[[E; 3]]| {
        let [a, b] = [&pair[0], &pair[1]];
        let product = |i: usize, j: usize| a[i].times(&b[j]);
        let dot = product(0, 0).plus(&product(1, 1)).plus(&product(2, 2));
        let crosses = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| product(i, j).minus(&product(j, i)));
        !dot.is_zero() && !crosses.iter().all(E::is_zero)
    };
    pose.axes.windows(2).filter(|pair| is_oblique(pair)).count()
}

/// Runs of parallel axes: those that are parallel at a random state are at all.
fn parallel<E: Element>(arm: &Arm<E>, pose: &Pose<E>) -> Vec<Option<(usize, usize, bool)>> {
    let mut places = Vec::new();
    let mut last: Option<(usize, (usize, usize, bool))> = None;
    for (k, joint) in arm.joints.iter().enumerate() {
        if !joint.revolute {
            places.push(None);
            continue;
        }
        let same = |other: usize, flip: bool| {
            let turn = |x: &E| if flip { x.negated() } else { x.clone() };
            pose.axes[k].iter().zip(&pose.axes[other]).all(|(a, b)| *a == turn(b))
        };
        let place = match last {
            Some((other, (run, place, points))) if same(other, false) => (run, place + 1, points),
            Some((other, (run, place, points))) if same(other, true) => (run, place + 1, !points),
            Some((_, (run, ..))) => (run + 1, 0, true),
            None => (0, 0, true),
        };
        last = Some((k, place));
        places.push(Some(place));
    }
    places
}

/// Which of some joint variables functions depend on: those that change them at a random state.
fn depends<K: Arithmetic + Clone>(
    field: &mut K,
    manipulator: &Manipulator,
    vector: &Vector,
    joints: Joints,
) -> Result<BTreeMap<String, Joints>, String> {
    let wanted = Wanted { base: BaseParameters::Kept, pivots: false };
    let state = State::draw(field, manipulator.joints.len());
    let other = State::draw(field, manipulator.joints.len());
    let at = |state: State<K::Element>| Reference::at(&mut field.clone(), manipulator, vector, state, wanted);
    let here = at(state.clone())?.values;
    let mut depends: BTreeMap<String, Joints> = here.keys().map(|name| (name.clone(), 0)).collect();
    for k in (0..other.q.len().min(64)).filter(|k| joints >> k & 1 == 1) {
        let mut state = state.clone();
        (state.angles[k], state.q[k]) = (other.angles[k].clone(), other.q[k].clone());
        let there = at(state)?.values;
        for (name, joints) in &mut depends {
            *joints |= Joints::from(there.get(name) != Some(&here[name])) << k;
        }
    }
    Ok(depends)
}
