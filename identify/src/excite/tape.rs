//! A function of states with its derivatives: forwards with all values kept, then backwards through the operations.
//!
//! Eight states go together. Signs of rates are smooth here, since a search needs slopes: tanh(dq / v) with a small v.

use armgen_evaluate::{Angle, Function, Input, Operand, Operator};

/// States that are taken together.
pub(super) const LANES: usize = 8;

/// A number for each of the states.
pub(super) type Lanes = [f64; LANES];

/// A function as places and operations on them: constants first, then inputs, then results.
#[derive(Clone, Debug)]
pub(super) struct Tape {
    lengths: Vec<usize>,
    constants: Vec<f64>,
    inputs: Vec<Input<f64>>,
    angles: Vec<Angle<f64>>,
    operations: Vec<(Operator, u32, u32)>,
    outputs: Vec<(u32, f64)>,
    /// v of each joint.
    smooth: Vec<f64>,
}

/// What a tape writes while it runs.
#[derive(Clone, Debug)]
pub(super) struct Room {
    values: Vec<Lanes>,
    slopes: Vec<Lanes>,
    sines: Vec<[Lanes; 2]>,
    /// The results of the last states.
    pub(super) results: Vec<Lanes>,
    /// The derivatives of the last states by each argument.
    pub(super) gradients: Vec<Vec<Lanes>>,
}

impl Tape {
    /// The tape of a function; `smooth` are the rates below which signs are smooth.
    pub(super) fn new(function: &Function<f64>, smooth: &[f64]) -> Tape {
        let mut constants: Vec<f64> = Vec::new();
        let operands =
            function.operations.iter().flat_map(|of| [of.left, of.right]).chain(function.outputs.iter().map(|of| of.operand));
        for operand in operands {
            if let Operand::Constant(value) = operand {
                if !constants.iter().any(|known| known.to_bits() == value.to_bits()) {
                    constants.push(value);
                }
            }
        }
        let first = constants.len();
        let place = |operand: Operand<f64>| match operand {
            Operand::Value(value) => (first + value) as u32,
            Operand::Constant(value) => {
                constants.iter().position(|known| known.to_bits() == value.to_bits()).expect("all were collected") as u32
            }
        };
        Tape {
            lengths: function.arguments.iter().map(|argument| argument.length).collect(),
            inputs: function.inputs.clone(),
            angles: function.angles.clone(),
            operations: function.operations.iter().map(|of| (of.operator, place(of.left), place(of.right))).collect(),
            outputs: function.outputs.iter().map(|of| (place(of.operand), if of.negated { -1.0 } else { 1.0 })).collect(),
            smooth: smooth.to_vec(),
            constants,
        }
    }

    /// Room for a run.
    pub(super) fn room(&self) -> Room {
        let zero = [0.0; LANES];
        let places = self.constants.len() + self.inputs.len() + self.operations.len();
        let mut values = vec![zero; places];
        values.iter_mut().zip(&self.constants).for_each(|(value, constant)| *value = [*constant; LANES]);
        Room {
            values,
            slopes: vec![zero; places],
            sines: vec![[zero; 2]; self.angles.len()],
            results: vec![zero; self.outputs.len()],
            gradients: self.lengths.iter().map(|length| vec![zero; *length]).collect(),
        }
    }

    /// The results of eight states; `arguments[argument][entry]`.
    pub(super) fn forwards(&self, arguments: &[&[Lanes]], room: &mut Room) {
        for (angle, [sine, cosine]) in self.angles.iter().zip(&mut room.sines) {
            for lane in 0..LANES {
                let turned = |sum: f64, (&(entry, minus), factor): (&(usize, bool), f64)| {
                    let x = factor * arguments[angle.argument][entry][lane];
                    sum + if minus { -x } else { x }
                };
                (sine[lane], cosine[lane]) =
                    angle.terms.iter().zip(factors(angle)).fold(angle.turn.unwrap_or(0.0), turned).sin_cos();
            }
        }
        let first = self.constants.len();
        for (input, value) in self.inputs.iter().zip(&mut room.values[first..]) {
            *value = match *input {
                Input::Entry { argument, entry } => arguments[argument][entry],
                Input::Sign { argument, entry } => arguments[argument][entry].map(|x| (x / self.smooth[entry]).tanh()),
                Input::Fading { argument, entry, velocity } => arguments[argument][entry].map(|x| (-x.abs() / velocity).exp()),
                Input::Sine(angle) => room.sines[angle][0],
                Input::Cosine(angle) => room.sines[angle][1],
            };
        }
        let start = first + self.inputs.len();
        for (k, &(operator, left, right)) in self.operations.iter().enumerate() {
            let (before, after) = room.values.split_at_mut(start + k);
            let (a, b, c) = (&before[left as usize], &before[right as usize], &mut after[0]);
            match operator {
                Operator::Add => (0..LANES).for_each(|i| c[i] = a[i] + b[i]),
                Operator::Subtract => (0..LANES).for_each(|i| c[i] = a[i] - b[i]),
                Operator::Multiply => (0..LANES).for_each(|i| c[i] = a[i] * b[i]),
                Operator::Divide => (0..LANES).for_each(|i| c[i] = a[i] / b[i]),
                Operator::Sign => (0..LANES).for_each(|i| c[i] = sign(a[i])),
                Operator::OppositeSign => (0..LANES).for_each(|i| c[i] = -sign(a[i])),
            }
        }
        for (result, &(place, factor)) in room.results.iter_mut().zip(&self.outputs) {
            *result = room.values[place as usize].map(|x| factor * x);
        }
    }

    /// The derivatives of sum_k weights[k] result_k by all arguments, at the states of the last [`Tape::forwards`].
    pub(super) fn backwards(&self, arguments: &[&[Lanes]], weights: &[Lanes], room: &mut Room) {
        room.slopes.iter_mut().for_each(|slope| *slope = [0.0; LANES]);
        for (weight, &(place, factor)) in weights.iter().zip(&self.outputs) {
            let slope = &mut room.slopes[place as usize];
            (0..LANES).for_each(|i| slope[i] += factor * weight[i]);
        }
        let start = self.constants.len() + self.inputs.len();
        for (k, &(operator, left, right)) in self.operations.iter().enumerate().rev() {
            let (left, right) = (left as usize, right as usize);
            let slope = room.slopes[start + k];
            let mut add = |place: usize, of: &dyn Fn(usize) -> f64| {
                let to = &mut room.slopes[place];
                (0..LANES).for_each(|i| to[i] += of(i));
            };
            match operator {
                Operator::Add => {
                    add(left, &|i| slope[i]);
                    add(right, &|i| slope[i]);
                }
                Operator::Subtract => {
                    add(left, &|i| slope[i]);
                    add(right, &|i| -slope[i]);
                }
                Operator::Multiply => {
                    let (a, b) = (room.values[left], room.values[right]);
                    add(left, &|i| slope[i] * b[i]);
                    add(right, &|i| slope[i] * a[i]);
                }
                Operator::Divide => {
                    let (c, b) = (room.values[start + k], room.values[right]);
                    add(left, &|i| slope[i] / b[i]);
                    add(right, &|i| -slope[i] * c[i] / b[i]);
                }
                // Constant between its jumps.
                Operator::Sign | Operator::OppositeSign => {}
            }
        }
        room.gradients.iter_mut().flatten().for_each(|gradient| *gradient = [0.0; LANES]);
        for (k, input) in self.inputs.iter().enumerate() {
            let (slope, value) = (room.slopes[self.constants.len() + k], room.values[self.constants.len() + k]);
            let (argument, entry, by): (usize, usize, Lanes) = match *input {
                Input::Entry { argument, entry } => (argument, entry, slope),
                Input::Sign { argument, entry } => {
                    (argument, entry, std::array::from_fn(|i| slope[i] * (1.0 - value[i] * value[i]) / self.smooth[entry]))
                }
                Input::Fading { argument, entry, velocity } => {
                    let x = arguments[argument][entry];
                    (argument, entry, std::array::from_fn(|i| -slope[i] * sign(x[i]) * value[i] / velocity))
                }
                Input::Sine(angle) | Input::Cosine(angle) => {
                    let [sine, cosine] = &room.sines[angle];
                    let is_sine = matches!(input, Input::Sine(_));
                    let by: Lanes = std::array::from_fn(|i| slope[i] * if is_sine { cosine[i] } else { -sine[i] });
                    let angle = &self.angles[angle];
                    for (&(entry, minus), factor) in angle.terms.iter().zip(factors(angle)) {
                        let to = &mut room.gradients[angle.argument][entry];
                        let slope = if minus { -factor } else { factor };
                        (0..LANES).for_each(|i| to[i] += slope * by[i]);
                    }
                    continue;
                }
            };
            let to = &mut room.gradients[argument][entry];
            (0..LANES).for_each(|i| to[i] += by[i]);
        }
    }
}

/// The sign of a number; 0 of either zero.
pub(super) fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// The factors of the terms of an angle.
fn factors(angle: &Angle<f64>) -> impl Iterator<Item = f64> + '_ {
    (0..angle.terms.len()).map(|i| angle.factors.get(i).copied().flatten().unwrap_or(1.0))
}

#[cfg(test)]
mod tests {
    use super::{Tape, LANES};
    use armgen_codegen::source::Source;
    use armgen_codegen::{schedule, validate, Model};

    /// Derivatives of all entries of torques with every kind of friction, and of a frame, are differences.
    #[test]
    fn derivatives_are_those_of_differences() {
        let text = "name: two\nconvention: standard\ngravity: [1, -9, 2]\njoints:
  - {name: a, type: revolute, a: 0.4, alpha: pi/3, d: 0.1, theta: 0.2, friction: {viscous: 1, coulomb: 2, load: 0.1, cubic: 0.3},
     link: {mass: 3, com: [-0.2, 0.1, 0], inertia: {xx: 0.02, yy: 0.04, zz: 0.05, xy: 0.003}}, motor: {ratio: 50, inertia: 1e-4}}
  - {name: b, type: prismatic, a: 0.3, alpha: 0.4, d: 0, theta: 1, friction: {coulomb: 1, stribeck: {torque: 2, velocity: 0.3}},
     link: {mass: 1, com: [-0.1, 0.01, 0], inertia: {xx: 0.01, yy: 0.01, zz: 0.01}}}\n";
        let (manipulator, _) = validate::read(&Source::new("two", text)).0.expect("a valid arm");
        let functions = schedule::Selection::named(["inverse_dynamics", "direct_kinematics"]).expect("names");
        let module = schedule::module(&Model::new(manipulator), &schedule::Options { functions, ..Default::default() });
        for of in &module.functions {
            let function = armgen_evaluate::function::<f64>(&module, of);
            let tape = Tape::new(&function, &[0.2, 0.2]);
            let mut room = tape.room();
            let state = |argument: usize, entry: usize, lane: usize| ((argument * 5 + entry * 3 + lane) as f64 * 0.7).sin();
            let mut x: Vec<Vec<[f64; LANES]>> = (0..function.arguments.len())
                .map(|argument| (0..2).map(|entry| std::array::from_fn(|lane| state(argument, entry, lane))).collect())
                .collect();
            let weights: Vec<[f64; LANES]> =
                (0..room.results.len()).map(|k| std::array::from_fn(|lane| state(7, k, lane))).collect();
            let mut sum = |x: &[Vec<[f64; LANES]>]| -> [f64; LANES] {
                let arguments: Vec<&[[f64; LANES]]> = x.iter().map(Vec::as_slice).collect();
                tape.forwards(&arguments, &mut room);
                std::array::from_fn(|lane| room.results.iter().zip(&weights).map(|(y, w)| y[lane] * w[lane]).sum())
            };
            let h = 1e-5;
            let mut slopes = Vec::new();
            for argument in 0..x.len() {
                for entry in 0..2 {
                    let old = x[argument][entry];
                    x[argument][entry] = old.map(|x| x + h);
                    let after = sum(&x);
                    x[argument][entry] = old.map(|x| x - h);
                    let before = sum(&x);
                    x[argument][entry] = old;
                    slopes.push((argument, entry, std::array::from_fn::<f64, LANES, _>(|i| (after[i] - before[i]) / (2.0 * h))));
                }
            }
            sum(&x);
            let arguments: Vec<&[[f64; LANES]]> = x.iter().map(Vec::as_slice).collect();
            tape.backwards(&arguments, &weights, &mut room);
            for (argument, entry, expected) in slopes {
                let found = room.gradients[argument][entry];
                for lane in 0..LANES {
                    let (a, b) = (found[lane], expected[lane]);
                    assert!((a - b).abs() < 1e-6 * (1.0 + b.abs()), "{}: {argument} {entry} {lane}: {a} {b}", function.name);
                }
            }
        }
    }
}
