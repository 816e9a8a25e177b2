//! The seed of the random points: a hash of the statement to prove, so that nobody can adapt the statement to the points.
//!
//! An adversary can make many wrong modules and see which passes. So the hash only covers relevant data. For the description, these are its numbers
//! and their structure. For the module, they are the computations of its functions, step by step back from the entries, with literals and exact
//! values. It does not cover names, comments, blanks, documentation, the order of items and statements, steps without influence, the order of
//! summands and factors, or claims without a literal. A change of these does not give another attempt.
//!
//! The remaining option, another equally wrong sum, costs reading and running per attempt. 2^40 attempts at odds of 2^-168 each leave 2^-128
//! ([`crate::certificate::report::MOST_LOG2_ODDS`]).

use armgen_description::exact::{Number, Polynomial};
use armgen_description::manipulator::{Body, Coupling, Joint, Manipulator, PlacedBody, Placement, Pose, RegressorChoice};
use sha2::{Digest, Sha256};

use crate::read::claims::{Claims, Resolved};
use crate::read::reader::Module;
use crate::textbook::equations::arm::formula;
use crate::values::enclosure::Float;
use crate::values::formula::{definitions, Formula};
use crate::values::program::{Angle, Program, Step};
use crate::values::stream::Stream;

/// A SHA-256 hash.
type Hash = [u8; 32];

/// A hash of parts with length prefixes, so that different lists of parts never coincide.
struct Parts(Sha256);

impl Parts {
    /// An empty hash for a kind of parts; different kinds never share a hash.
    fn of(kind: &str) -> Parts {
        let mut parts = Parts(Sha256::new());
        parts.add(kind.as_bytes());
        parts
    }

    fn add(&mut self, part: &[u8]) {
        self.0.update((part.len() as u64).to_le_bytes());
        self.0.update(part);
    }

    fn integer(&mut self, value: u64) {
        self.add(&value.to_le_bytes());
    }

    fn finish(self) -> Hash {
        self.0.finalize().into()
    }
}

/// The stream of random bits for a module, from the description, the module and the claims for its literals; each `run` has separate points.
pub fn stream(manipulator: &Manipulator, module: &Module, claims: &Claims, run: u64) -> Stream {
    let mut parts = Parts::of("module");
    parts.integer(run);
    parts.add(&of_description(manipulator));
    parts.integer(u64::from(module.real == Float::F32));
    let mut functions: Vec<(&str, &Program)> = module.programs().collect();
    functions.sort_by_key(|(name, _)| *name);
    for (name, program) in functions {
        parts.add(name.as_bytes());
        parts.add(&of_program(program, &claims.resolve(name, &program.literals, module.real)));
    }
    for constant in ["NOMINAL_PARAMETERS", "NOMINAL_BASE_PARAMETERS"] {
        parts.add(&of_formulas(claims.of(constant)));
    }
    Stream::of(parts.finish())
}

fn of_formulas(formulas: &[Formula]) -> Hash {
    let mut parts = Parts::of("formulas");
    formulas.iter().for_each(|formula| parts.add(definitions::spelled(formula).as_bytes()));
    parts.finish()
}

/// The computation of a function: its entries, each as the tree of its steps.
fn of_program(program: &Program, resolved: &Resolved) -> Hash {
    let literal = |index: usize| {
        let others = resolved.others.get(&index).map_or(&[][..], Vec::as_slice);
        of_formulas(&[std::slice::from_ref(&resolved.values[index]), others].concat())
    };
    let literals: Vec<Hash> = (0..program.literals.len()).map(literal).collect();
    let mut steps: Vec<Hash> = Vec::with_capacity(program.steps.len());
    for step in &program.steps {
        let one = |kind: &str, a: &usize| {
            let mut parts = Parts::of(kind);
            parts.add(&steps[*a]);
            parts.finish()
        };
        let two = |kind: &str, first: &Hash, second: &Hash| {
            let mut parts = Parts::of(kind);
            parts.add(first);
            parts.add(second);
            parts.finish()
        };
        // The order of summands and factors does not change any bit.
        let either = |kind: &str, a: &usize, b: &usize| {
            let (a, b) = (&steps[*a], &steps[*b]);
            two(kind, a.min(b), a.max(b))
        };
        let angle = |kind: &str, angle: &Angle| {
            let mut parts = Parts::of(kind);
            for &(joint, factor) in &angle.terms {
                parts.integer(joint as u64);
                parts.add(&factor.to_le_bytes());
            }
            for (i, literal) in angle.factors.iter().enumerate().filter_map(|(i, literal)| Some((i, (*literal)?))) {
                parts.integer(i as u64);
                parts.add(&literals[literal]);
            }
            if let Some((turn, minus)) = angle.turn {
                parts.add(&literals[program.turns[turn]]);
                parts.integer(u64::from(minus));
            }
            parts.finish()
        };
        let hash = match step {
            Step::Input(argument, index) => {
                let mut parts = Parts::of("input");
                parts.integer(*argument as u64);
                parts.integer(*index as u64);
                parts.finish()
            }
            Step::Literal(index) => literals[*index],
            Step::Sine(sum) => angle("sine", sum),
            Step::Cosine(sum) => angle("cosine", sum),
            Step::Sign(joint) => {
                let mut parts = Parts::of("sign");
                parts.integer(*joint as u64);
                parts.finish()
            }
            Step::Stribeck(joint, velocity) => {
                let mut parts = Parts::of("stribeck");
                parts.integer(*joint as u64);
                parts.add(&literals[*velocity]);
                parts.finish()
            }
            Step::SignOf(a) => one("sign of", a),
            Step::Negate(a) => one("negate", a),
            Step::Add(a, b) => either("add", a, b),
            Step::Subtract(a, b) => two("subtract", &steps[*a], &steps[*b]),
            Step::Multiply(a, b) => either("multiply", a, b),
            Step::Product(a, b) => either("product", a, b),
            Step::Divide(a, b) => two("divide", &steps[*a], &steps[*b]),
        };
        steps.push(hash);
    }
    let mut parts = Parts::of("program");
    program.outputs.iter().for_each(|output| parts.add(&steps[output.step]));
    parts.finish()
}

/// The numbers of a description and their structure.
fn of_description(manipulator: &Manipulator) -> Hash {
    let mut arm = Description(Parts::of("description"));
    let Manipulator {
        name: _,
        parameters,
        gravity,
        gravity_is_argument,
        joints,
        tip,
        tool,
        payload,
        task,
        regressor,
        inverse_kinematics: _,
        tips,
        coupling,
    } = manipulator;
    parameters.iter().for_each(|parameter| arm.number(&parameter.nominal));
    arm.polynomials(gravity);
    if *gravity_is_argument {
        arm.word("argument");
    }
    for joint in joints {
        arm.word(&format!("{:?} {:?}", joint.kind, joint.parent));
        arm.row(joint);
        let limits = &joint.limits;
        let sizes = [&limits.velocity, &limits.effort, &limits.acceleration, &limits.jerk];
        let limits = limits.position.iter().flatten().chain(sizes.into_iter().flatten());
        limits.for_each(|limit| arm.number(limit));
        for (k, part) in joint.link.iter().enumerate() {
            if k > 0 {
                arm.word("attached");
            }
            arm.part(part);
        }
        if let Some(motor) = &joint.motor {
            arm.word("motor");
            arm.polynomials([&motor.ratio, &motor.mass]);
            arm.polynomials(&motor.position);
            motor.axis.iter().for_each(|entry| arm.number(entry));
            arm.optional(&motor.inertia);
            arm.optional(&motor.viscous);
            // The seeds of other motors stay what they are.
            if motor.carrier != joint.parent || !motor.coupling.is_empty() {
                arm.word(&format!("carrier {:?}", motor.carrier));
                for (other, factor) in &motor.coupling {
                    arm.word(&format!("coupling {other}"));
                    arm.number(factor);
                }
            }
        }
        arm.optional(&joint.viscous);
        arm.optional(&joint.coulomb);
        if joint.armature.is_some() {
            arm.word("armature");
            arm.optional(&joint.armature);
        }
        for (word, value) in [("offset", &joint.offset), ("cubic", &joint.cubic)] {
            if value.is_some() {
                arm.word(word);
                arm.optional(value);
            }
        }
        if let Some(load) = &joint.load {
            arm.word("load");
            arm.number(load);
        }
        if let Some(smooth) = &joint.smooth {
            arm.word("smooth");
            arm.number(smooth);
        }
        if let Some(stribeck) = &joint.stribeck {
            arm.word("stribeck");
            arm.polynomials([&stribeck.torque]);
            arm.number(&stribeck.velocity);
        }
        if let Some(spring) = &joint.spring {
            arm.word("spring");
            arm.polynomials([&spring.stiffness, &spring.rest]);
        }
    }
    arm.word(&format!("{tip:?} {task:?}"));
    match tool.frame.is_multiplied_out() {
        true => arm.placement(&tool.frame),
        false => arm.pose(tool),
    }
    if let Some(payload) = payload {
        arm.word("payload");
        arm.part(payload);
    }
    for tip in tips {
        arm.word(&format!("{} {:?} {:?}", tip.name, tip.joint, tip.task));
        arm.pose(&tip.tool);
        if let Some(payload) = &tip.payload {
            arm.word("payload");
            arm.part(payload);
        }
    }
    if let Some(Coupling { coordinates, limits: _, variables, sums: _ }) = coupling {
        // Limits of coordinates and sums of variables follow from those of joints.
        arm.word(&format!("coupled {coordinates:?}"));
        for variable in variables {
            arm.word("variable");
            for (a, factor) in &variable.factors {
                arm.word(&a.to_string());
                arm.number(factor);
            }
            arm.number(&variable.offset);
        }
    }
    match regressor {
        RegressorChoice::Standard => arm.word("standard"),
        RegressorChoice::Base => arm.word("base"),
        RegressorChoice::Names(names) => arm.word(&format!("{names:?}")),
    }
    arm.0.finish()
}

struct Description(Parts);

impl Description {
    fn word(&mut self, word: &str) {
        self.0.add(word.as_bytes());
    }

    fn number(&mut self, number: &Number) {
        self.word(&formula(number).to_string());
    }

    fn polynomials<'a>(&mut self, polynomials: impl IntoIterator<Item = &'a Polynomial>) {
        for polynomial in polynomials {
            self.word("polynomial");
            for (powers, coefficient) in polynomial.terms() {
                self.word(&format!("{powers:?}"));
                self.number(coefficient);
            }
        }
    }

    fn optional(&mut self, polynomial: &Option<Polynomial>) {
        self.polynomials(polynomial);
        self.word("next");
    }

    fn placement(&mut self, placement: &Placement) {
        placement.rotation.iter().flatten().for_each(|entry| self.number(entry));
        self.polynomials(&placement.translation);
    }

    fn pose(&mut self, pose: &Pose) {
        self.word("pose");
        pose.elements.iter().for_each(|element| self.placement(element));
    }

    /// A row with its own joint frames is identified by these, any other row by its elements.
    fn row(&mut self, joint: &Joint) {
        if joint.link_frame == joint.row.after.frame && joint.placement.is_multiplied_out() {
            self.placement(&joint.placement);
        } else {
            self.pose(&joint.row.before);
            joint.row.axis.iter().for_each(|entry| self.number(entry));
        }
        self.placement(&joint.link_frame);
    }

    /// A body, with its difference from a body in the frame that carries it.
    fn part(&mut self, part: &PlacedBody) {
        for pose in [&part.frame, &part.axes] {
            if !pose.elements.is_empty() {
                self.pose(pose);
            }
        }
        self.body(&part.given);
    }

    fn body(&mut self, body: &Body) {
        self.polynomials([&body.mass]);
        self.polynomials(&body.com);
        self.polynomials(&body.inertia);
    }
}
