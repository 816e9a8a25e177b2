//! From shared expressions to numbered steps, and from the derivations of each quantity to the cheapest.

mod selection;

use std::collections::BTreeMap;

use armgen_algebra::optimise::optimise;

use crate::catalogue::{self, Absent, Length, Quantity};
use crate::derive::derivation::Derivation;
use crate::derive::parameters::{nominal, ParameterKind, View};
use crate::exact::Number;
use crate::kinds::{JointKind, Scalar};
use crate::manipulator;
use crate::parallel::parallel_map;

pub use crate::pass::{Pass, Passes};
use crate::program::{Cost, Coupling, EndEffector, Function, Joint, Module, MotorRates, Operand, Operation, Output, Step, Trig};
use crate::ring::count::DIVISION_COST;
use crate::ring::{Elementary, ExprId, Node, Pool, Symbol};
use crate::Model;
pub use selection::{Selection, UnknownFunctions};

/// Choices of generation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// The scalar type of `Real`.
    pub scalar: Scalar,
    /// Where sines and cosines come from.
    pub trig: Trig,
    /// Passes that are not used.
    pub without: Passes,
    /// How many states the functions for many states take at a time; none: there are no such functions.
    pub batch: Option<usize>,
    /// Functions that are emitted.
    pub functions: Selection,
    /// Whether a multiplication is fused with the addition that alone takes its product, where the language has such an operation: Rust and C.
    pub fuse: bool,
}

/// A closed form with this many times the operations of the recursion is given up.
const CLOSED_FORM_FACTOR: usize = 2;

/// How many nodes the search for the cheapest derivation of a quantity may form.
const EFFORT: usize = 500_000;

/// The module of an arm.
pub fn module(model: &Model, options: &Options) -> Module {
    let (mut wanted, mut absent) = (Vec::new(), Vec::new());
    for (quantity, with_parameters) in catalogue::functions_of(&model.manipulator.tips) {
        if !options.functions.contains(quantity, with_parameters) {
            continue;
        }
        match quantity.absence(model, with_parameters) {
            Some(_) if !quantity.documentation.said_missing && options.functions.is_all() => {}
            Some(reason) => absent.push(Absent { function: quantity.function_name(with_parameters), reason }),
            None if model.manipulator.coupling.is_some() => wanted.push((quantity.of_coupled_joints(), with_parameters)),
            None => wanted.push((quantity, with_parameters)),
        }
    }
    absent.extend(options.functions.unknown_to(&model.manipulator.tips));
    let functions = parallel_map(&wanted, |&(quantity, with_parameters)| function(model, quantity, with_parameters, options));
    let base = wanted.iter().any(|(quantity, _)| quantity.has_length(Length::BaseParameters));
    let manipulator = &model.manipulator;
    Module {
        name: manipulator.name.clone(),
        joints: manipulator.coordinates().into_iter().map(joint).collect(),
        coupling: manipulator.coupling.as_ref().map(|coupling| coupled(manipulator, coupling)),
        motors: motors(manipulator),
        gravity: manipulator.gravity.each_ref().map(|g| nominal(manipulator, g)),
        gravity_is_argument: manipulator.gravity_is_argument,
        features: manipulator.features(),
        task: manipulator.task_rows(),
        tips: manipulator.tips.iter().map(|tip| end_effector(manipulator, tip)).collect(),
        parameters: model.parameters.entries.clone(),
        base_parameters: matches!(model.parameters.kind, ParameterKind::Base(_)),
        base_set: if base { model.base_parameters().map_or_else(Vec::new, |vector| vector.entries.clone()) } else { Vec::new() },
        functions,
        absent,
        scalar: options.scalar,
        trig: options.trig,
        turn: model.field.turn().map(|turn| turn.angle.clone()),
        batch: options.batch.filter(|&lanes| lanes > 0),
        asked_for: options.functions.names().map(|names| names.map(String::from).collect()),
        without: Pass::ALL.into_iter().filter(|pass| options.without.contains(*pass)).map(Pass::name).collect(),
    }
}

fn end_effector(manipulator: &manipulator::Manipulator, tip: &manipulator::Tip) -> EndEffector {
    EndEffector {
        name: tip.name.clone(),
        task: tip.task.iter().map(|row| row.index()).collect(),
        coordinates: manipulator.coordinates_of(tip.joint.index()),
    }
}

fn joint(manipulator::Coordinate { joint, limits, .. }: manipulator::Coordinate<'_>) -> Joint {
    Joint {
        name: joint.name.clone(),
        is_revolute: joint.kind == JointKind::Revolute,
        position: limits.position.clone().map_or([None, None], |limits| limits.map(Some)),
        velocity: limits.velocity.clone(),
        effort: limits.effort.clone(),
        acceleration: limits.acceleration.clone(),
        jerk: limits.jerk.clone(),
    }
}

fn coupled(manipulator: &manipulator::Manipulator, coupling: &manipulator::Coupling) -> Coupling {
    let row = |variable: &manipulator::JointVariable| {
        let mut row = vec![Number::zero(); coupling.coordinates.len()];
        variable.factors.iter().for_each(|(a, factor)| row[*a].clone_from(factor));
        row
    };
    Coupling {
        names: manipulator.joints.iter().map(|joint| joint.name.clone()).collect(),
        factors: coupling.variables.iter().map(row).collect(),
        offsets: coupling.variables.iter().map(|variable| variable.offset.clone()).collect(),
    }
}

fn motors(manipulator: &manipulator::Manipulator) -> Option<MotorRates> {
    let (joints, rates): (Vec<_>, Vec<_>) =
        manipulator.motor_rates().into_iter().map(|(joint, rates)| (joint.name.clone(), rates)).unzip();
    (!joints.is_empty()).then_some(MotorRates { joints, rates })
}

/// The cheapest program of a quantity; the first of equals, so that the choice is the same everywhere.
fn function(model: &Model, quantity: &'static Quantity, with_parameters: bool, options: &Options) -> Function {
    let view = if with_parameters { View::Vector(&model.parameters) } else { View::Nominal };
    let without = options.without;
    let recursion = quantity.by_search(model, view, without, EFFORT);
    let closed = if without.contains(Pass::ClosedForm) { Vec::new() } else { recursion.by_closed_form() };
    // A closed form that is far longer than the recursion does not become shorter than it.
    let operations = |of: &Derivation| of.pool.operations(&of.pool.with_gravity(&of.entries).0, DIVISION_COST);
    let most = CLOSED_FORM_FACTOR * operations(&recursion);
    let optimised =
        |derivation: Derivation| match optimise(&derivation.pool, &derivation.entries, &derivation.parallel, &without.rewrites())
        {
            Some((pool, entries)) => Derivation { pool, entries, ..derivation },
            None => derivation,
        };
    closed
        .into_iter()
        .filter(|closed| operations(closed) <= most)
        .chain([recursion])
        .map(optimised)
        // Most variables that cancel are gone by now. Without those that are left there is more to optimise.
        .map(|derivation| match derivation.without_cancelled_variables() {
            Some(rest) => optimised(rest),
            None => derivation,
        })
        .map(|derivation| lower(model, quantity, with_parameters, &derivation))
        .min_by_key(|function| Cost::of(function).weight())
        .map(|function| Function { fuse: options.fuse, ..function })
        .expect("there is at least the recursion")
}

fn lower(model: &Model, quantity: &'static Quantity, with_parameters: bool, derivation: &Derivation) -> Function {
    let base_parameters = if quantity.has_length(Length::BaseParameters) { model.base_count() } else { 0 };
    let order = quantity.entries_by_columns(&model.sizes_with(base_parameters)).concat();
    let (steps, outputs) = steps(&derivation.pool, &derivation.entries, &order);
    let arguments = quantity.arguments_of(with_parameters, model.manipulator.gravity_is_argument).collect();
    let method = derivation.method;
    let mut function = Function {
        quantity,
        with_parameters,
        arguments,
        steps,
        outputs,
        method,
        stribeck: BTreeMap::new(),
        computed: BTreeMap::new(),
        fuse: false,
    };
    let coordinates = model.manipulator.coordinates();
    let velocity = |symbol| match symbol {
        Symbol::OfRate(Elementary::Decay, i) => Some((i, coordinates[usize::from(i)].joint.decay_velocity()?)),
        _ => None,
    };
    function.stribeck = function.symbols().into_iter().filter_map(velocity).collect();
    let computed = |symbol| match symbol {
        Symbol::Sine(i) | Symbol::Cosine(i) => Some((i, derivation.pool.field().computed()?.get(i)?.clone())),
        _ => None,
    };
    function.computed = function.symbols().into_iter().filter_map(computed).collect();
    function
}

/// The steps that the expressions need, each after its operands; expressions ask for them in that order.
fn steps(pool: &Pool, exprs: &[ExprId], order: &[usize]) -> (Vec<Step>, Vec<Output>) {
    let mut steps: Vec<Step> = Vec::new();
    // By the index of the node.
    let mut done: Vec<Option<Operand>> = vec![None; pool.len()];
    for expr in order.iter().map(|&i| exprs[i]) {
        let mut stack = vec![(expr.unsigned(), false)];
        while let Some((expr, ready)) = stack.pop() {
            if done[expr.index()].is_some() {
                continue;
            }
            let (operation, a, b) = match pool.node(expr) {
                // |g| = sign(g) g, both the one value that is computed for g.
                Node::Symbol(symbol @ (Symbol::GravitySize(i) | Symbol::GravitySign(i))) => {
                    let torque = pool.gravity(i).expect("sizes and signs are of a torque of the pool");
                    if !ready {
                        stack.extend([(expr, true), (torque.unsigned(), false)]);
                        continue;
                    }
                    let own = operand(pool, &done, torque);
                    let is_size = matches!(symbol, Symbol::GravitySize(_));
                    let operation = if torque.is_negated() && !is_size { Operation::OppositeSign } else { Operation::Sign };
                    steps.push(Step { operation, left: own.clone(), right: own.clone() });
                    if is_size {
                        let sign = Operand::Step(steps.len() as u32 - 1);
                        steps.push(Step { operation: Operation::Multiply, left: sign, right: own });
                    }
                    done[expr.index()] = Some(Operand::Step(steps.len() as u32 - 1));
                    continue;
                }
                // tanh(x) = sign(x) (1 - E) / (1 + E), E = exp(-2 |x|): no element of the ring, but few steps.
                Node::Symbol(Symbol::OfRate(Elementary::Tanh, i)) => {
                    let input = |function| Operand::Input(Symbol::OfRate(function, i));
                    let one = || Operand::Constant(Number::one());
                    let mut step = |operation, left, right| {
                        steps.push(Step { operation, left, right });
                        Operand::Step(steps.len() as u32 - 1)
                    };
                    let rest = step(Operation::Subtract, one(), input(Elementary::Decay));
                    let sum = step(Operation::Add, one(), input(Elementary::Decay));
                    let size = step(Operation::Divide, rest, sum);
                    done[expr.index()] = Some(step(Operation::Multiply, input(Elementary::Sign), size));
                    continue;
                }
                Node::Constant(_) | Node::Symbol(_) => continue,
                Node::Add(a, b) => (if b.is_negated() { Operation::Subtract } else { Operation::Add }, a, b),
                Node::Mul(a, b) => (Operation::Multiply, a, b),
                Node::Reciprocal(a) => (Operation::Divide, ExprId::ONE, a),
            };
            if ready {
                let (left, right) = (operand(pool, &done, a), operand(pool, &done, b));
                let value = match folded(operation, &left, &right) {
                    Some(value) => Operand::Constant(value),
                    None => {
                        steps.push(Step { operation, left, right });
                        Operand::Step(steps.len() as u32 - 1)
                    }
                };
                done[expr.index()] = Some(value);
            } else {
                stack.extend([(expr, true), (b.unsigned(), false), (a.unsigned(), false)]);
            }
        }
    }
    let outputs = exprs
        .iter()
        .map(|&expr| match operand(pool, &done, expr) {
            // A constant has its own sign.
            Operand::Constant(value) => {
                let value = if expr.is_negated() { -&value } else { value };
                Output { operand: Operand::Constant(value), negated: false }
            }
            operand => Output { operand, negated: expr.is_negated() },
        })
        .collect();
    (steps, outputs)
}

/// The constant that an operation on constants comes to. A pool leaves such an operation where it does not know enough of a root to see that
/// results cancel; nothing cancels any more here.
fn folded(operation: Operation, left: &Operand, right: &Operand) -> Option<Number> {
    let (Operand::Constant(left), Operand::Constant(right)) = (left, right) else { return None };
    match operation {
        Operation::Add => Some(left.plus(right)),
        Operation::Subtract => Some(left.minus(right)),
        Operation::Multiply => Some(left.times(right)),
        Operation::Divide => Some(left.times(&right.inverse()?)),
        Operation::Sign | Operation::OppositeSign => None,
    }
}

/// An operand without its sign: signs sit in the operation or in the output.
fn operand(pool: &Pool, done: &[Option<Operand>], expr: ExprId) -> Operand {
    let known = || done[expr.index()].clone().expect("each step stands after its operands");
    match pool.node(expr) {
        Node::Constant(_) => Operand::Constant(pool.as_constant(expr.unsigned()).unwrap_or_else(Number::zero)),
        Node::Symbol(Symbol::GravitySize(_) | Symbol::GravitySign(_) | Symbol::OfRate(Elementary::Tanh, _)) => known(),
        Node::Symbol(symbol) => Operand::Input(symbol),
        Node::Add(..) | Node::Mul(..) | Node::Reciprocal(_) => known(),
    }
}
