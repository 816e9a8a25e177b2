//! The arm with exact constants and parameter values.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::sync::Arc;

use armgen_description::exact::{Number, Polynomial};
use armgen_description::kinds::JointKind;
use armgen_description::manipulator::{self, LinkId, Manipulator};

pub use super::angles::formula;
use super::angles::Angles;
use super::state::State;
use super::vector::{add, dot, product, scale, sub, transpose, Matrix, Vector};
use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;
use crate::values::program::Inputs;

/// The pose of a frame in another.
#[derive(Clone, Debug)]
pub struct Frame<E> {
    /// Its axes as columns.
    pub rotation: Matrix<E>,
    /// Its origin.
    pub origin: Vector<E>,
}

/// A rigid body in a frame.
#[derive(Clone, Debug)]
pub struct Body<E> {
    /// Mass.
    pub mass: E,
    /// Centre of mass.
    pub com: Vector<E>,
    /// Inertia about the centre of mass.
    pub inertia: Matrix<E>,
}

/// A rotor.
#[derive(Clone, Debug)]
pub struct Motor<E> {
    /// The link that carries it; none for the base.
    pub carrier: Option<usize>,
    /// The joints that it spins with, and by how much: its own joint by k_r first.
    pub rates: Vec<(usize, E)>,
    /// Inertia about its axis.
    pub inertia: E,
    /// Mass.
    pub mass: E,
    /// Position in the link frame of its carrier.
    pub position: Vector<E>,
    /// Axis in the link frame of its carrier.
    pub axis: Vector<E>,
    /// Viscous friction at the rotor.
    pub viscous: E,
}

/// A joint and the link it moves.
#[derive(Clone, Debug)]
pub struct Joint<E> {
    /// Whether it is revolute.
    pub revolute: bool,
    /// The link that carries it.
    pub parent: Option<usize>,
    /// Fixed transform before the joint's motion, in the previous link's frame.
    pub before: Frame<E>,
    /// Unit vector of the joint axis in the frame after `before`.
    pub axis: Vector<E>,
    /// Fixed transform after the motion: the link frame in the moved frame.
    pub after: Frame<E>,
    /// The frame for base parameters of the link, relative to its link frame; the generator chooses it.
    pub chosen: Frame<E>,
    /// The link, in its link frame.
    pub link: Body<E>,
    /// Its motor.
    pub motor: Option<Motor<E>>,
    /// Viscous friction at the joint.
    pub viscous: E,
    /// Coulomb friction at the joint.
    pub coulomb: E,
    /// Constant torque, independent of the rate.
    pub offset: E,
    /// Coefficient of the cube of the rate.
    pub cubic: E,
    /// Ratio of load-dependent dry friction to the gravity torque.
    pub load: E,
    /// Stribeck friction at zero rate.
    pub stribeck: E,
    /// v of exp(-|dq| / v), if its friction has that; else 1.
    pub stribeck_velocity: E,
    /// Whether its friction has that.
    pub decays: bool,
    /// Whether Coulomb friction is proportional to tanh(dq / 2 v).
    pub smooth: bool,
    /// Stiffness of the joint's spring.
    pub stiffness: E,
    /// The joint variable where the spring is at rest.
    pub rest: E,
    /// Inertia that acts on this joint only.
    pub armature: E,
}

/// The variable of a joint as a sum over coordinates.
#[derive(Clone, Debug)]
pub struct Variable<E> {
    /// Coordinates with their factors.
    pub factors: Vec<(usize, E)>,
    /// Its angle without the constant as a whole combination of the angles of a state, of a joint that turns; a computed angle has its constant.
    pub turns: Vec<(usize, i64)>,
    /// 1 or -1, the sign of the first factor.
    pub sign: E,
    /// The constant part.
    pub offset: E,
    /// Sine and cosine of what its angle has besides, of a joint that turns; else those of 0.
    pub turn: (E, E),
}

/// Joint variables as sums over coordinates.
#[derive(Clone, Debug)]
pub struct Coupling<E> {
    /// The joints with a coordinate.
    pub coordinates: Vec<usize>,
    /// The variable of each joint.
    pub variables: Vec<Variable<E>>,
}

/// An end effector.
#[derive(Clone, Debug)]
pub struct Tip<E> {
    /// What the names of its functions begin with; empty if it has no name.
    pub prefix: String,
    /// What the names of its payload's parameters begin with, likewise.
    pub of_load: String,
    /// The link that carries it.
    pub link: usize,
    /// Its frame in that link's frame.
    pub tool: Frame<E>,
    /// Load, in its frame.
    pub payload: Option<Body<E>>,
    /// Rows of its task in its Jacobian.
    pub task: Vec<usize>,
}

/// The arm.
#[derive(Clone, Debug)]
pub struct Arm<E> {
    /// Joints from base to tip; parents first.
    pub joints: Vec<Joint<E>>,
    /// Acceleration of gravity in the base frame.
    pub gravity: Vector<E>,
    /// The end effectors: those with names, or the only one.
    pub tips: Vec<Tip<E>>,
    /// The coupling of joints; `None` if the variable of each joint is its coordinate.
    pub coupling: Option<Coupling<E>>,
    /// The angles of its states.
    pub angles: Arc<Angles>,
    /// 0.
    pub zero: E,
    /// 1.
    pub one: E,
}

struct Builder<'a, K: Arithmetic> {
    arithmetic: &'a K,
    parameters: &'a [K::Element],
}

impl<K: Arithmetic> Builder<'_, K> {
    fn number(&self, number: &Number) -> Option<K::Element> {
        self.arithmetic.constant(&formula(number))
    }

    fn polynomial(&self, polynomial: &Polynomial) -> Option<K::Element> {
        let mut sum = self.arithmetic.integer(0);
        for (powers, coefficient) in polynomial.terms() {
            let mut term = self.number(coefficient)?;
            for (parameter, &power) in powers {
                for _ in 0..power {
                    term = term.times(&self.parameters[parameter.0 as usize]);
                }
            }
            sum = sum.plus(&term);
        }
        Some(sum)
    }

    fn vector(&self, vector: &[Polynomial; 3]) -> Option<Vector<K::Element>> {
        Some([self.polynomial(&vector[0])?, self.polynomial(&vector[1])?, self.polynomial(&vector[2])?])
    }

    fn row(&self, [x, y, z]: &[Number; 3]) -> Option<Vector<K::Element>> {
        let coordinate = |number| self.arithmetic.coordinate(&formula(number));
        Some([coordinate(x)?, coordinate(y)?, coordinate(z)?])
    }

    fn frame(&self, placement: &manipulator::Placement) -> Option<Frame<K::Element>> {
        let [x, y, z] = &placement.rotation;
        let rotation = [self.row(x)?, self.row(y)?, self.row(z)?];
        Some(Frame { rotation, origin: self.vector(&placement.translation)? })
    }

    fn body(&self, body: &manipulator::Body) -> Option<Body<K::Element>> {
        let mut six = Vec::new();
        for entry in &body.inertia {
            six.push(self.polynomial(entry)?);
        }
        Some(Body { mass: self.polynomial(&body.mass)?, com: self.vector(&body.com)?, inertia: symmetric(&six) })
    }

    /// The product of frames.
    fn pose(&self, pose: &manipulator::Pose) -> Option<Frame<K::Element>> {
        let (zero, one) = (self.arithmetic.integer(0), self.arithmetic.integer(1));
        pose.elements.iter().try_fold(Frame::identity(&zero, &one), |all, element| Some(all.then(&self.frame(element)?)))
    }

    /// Combines the bodies of a link: their ten parameters add in a common frame.
    fn lumped(&self, parts: &[manipulator::PlacedBody]) -> Option<Body<K::Element>> {
        let zero = self.arithmetic.integer(0);
        let mut all: Option<Body<K::Element>> = None;
        for part in parts {
            let given = self.body(&part.given)?;
            let (frame, axes) = (self.pose(&part.frame)?, self.pose(&part.axes)?.rotation);
            let turn = product(&frame.rotation, &axes);
            let inertia = product(&product(&turn, &given.inertia), &transpose(&turn));
            let body = Body { mass: given.mass, com: frame.point(&given.com), inertia };
            all = Some(match all {
                None => body,
                Some(other) => together(&zero, &other, &body)?,
            });
        }
        all
    }

    fn coupling(&self, coupling: &manipulator::Coupling) -> Option<Coupling<K::Element>> {
        let mut variables = Vec::new();
        let computed = coupling.computed();
        for variable in &coupling.variables {
            let mut factors = Vec::new();
            for (a, factor) in &variable.factors {
                factors.push((*a, self.number(factor)?));
            }
            // Whole numbers that are small.
            let turns = variable.factors.iter().map(|(a, factor)| (*a, factor.to_f64() as i64));
            let (turns, turn) = match (&variable.turn, variable.computed()) {
                (Some(turn), Some((angle, opposite))) => {
                    // The states have them: they are constants of the description.
                    turn.iter().try_for_each(|number| self.arithmetic.coordinate(&formula(number)).map(|_| ()))?;
                    let place = computed.iter().position(|of| *of == angle)?;
                    let turns = vec![(coupling.coordinates.len() + place, if opposite { -1 } else { 1 })];
                    (turns, (self.arithmetic.integer(0), self.arithmetic.integer(1)))
                }
                (Some([sine, cosine]), None) => {
                    let circle = |number| self.arithmetic.coordinate(&formula(number));
                    (turns.collect(), (circle(sine)?, circle(cosine)?))
                }
                (None, _) => (Vec::new(), (self.arithmetic.integer(0), self.arithmetic.integer(1))),
            };
            let is_negative = variable.factors.first().is_some_and(|(_, factor)| factor.sign() == Ordering::Less);
            let sign = self.arithmetic.integer(if is_negative { -1 } else { 1 });
            variables.push(Variable { factors, turns, sign, offset: self.number(&variable.offset)?, turn });
        }
        Some(Coupling { coordinates: coupling.coordinates.clone(), variables })
    }

    fn rates(&self, i: usize, motor: &manipulator::Motor) -> Option<Vec<(usize, K::Element)>> {
        let mut rates = vec![(i, self.polynomial(&motor.ratio)?)];
        for (joint, factor) in &motor.coupling {
            rates.push((*joint, self.number(factor)?));
        }
        Some(rates)
    }

    fn optional(&self, polynomial: Option<&Polynomial>) -> Option<K::Element> {
        match polynomial {
            Some(polynomial) => self.polynomial(polynomial),
            None => Some(self.arithmetic.integer(0)),
        }
    }

    fn joint(&self, i: usize, joint: &manipulator::Joint) -> Option<Joint<K::Element>> {
        let motor = match &joint.motor {
            None => None,
            Some(motor) => Some(Motor {
                carrier: motor.carrier.map(LinkId::index),
                rates: self.rates(i, motor)?,
                inertia: self.optional(motor.inertia.as_ref())?,
                mass: self.polynomial(&motor.mass)?,
                position: self.vector(&motor.position)?,
                axis: self.row(&motor.axis)?,
                viscous: self.optional(motor.viscous.as_ref())?,
            }),
        };
        Some(Joint {
            revolute: joint.kind == JointKind::Revolute,
            parent: joint.parent.map(|link| link.index()),
            before: self.pose(&joint.row.before)?,
            axis: self.row(&joint.row.axis)?,
            after: self.pose(&joint.row.after)?,
            chosen: self.frame(&joint.link_frame)?.inverse(),
            link: self.lumped(&joint.link)?,
            motor,
            viscous: self.optional(joint.viscous.as_ref())?,
            coulomb: self.optional(joint.coulomb.as_ref())?,
            offset: self.optional(joint.offset.as_ref())?,
            cubic: self.optional(joint.cubic.as_ref())?,
            load: match &joint.load {
                Some(load) => self.number(load)?,
                None => self.arithmetic.integer(0),
            },
            stribeck: self.optional(joint.stribeck.as_ref().map(|stribeck| &stribeck.torque))?,
            stribeck_velocity: match &joint.decay_velocity() {
                Some(velocity) => self.number(velocity)?,
                None => self.arithmetic.integer(1),
            },
            decays: joint.decay_velocity().is_some(),
            smooth: joint.smooth.is_some(),
            stiffness: self.optional(joint.spring.as_ref().map(|spring| &spring.stiffness))?,
            rest: self.optional(joint.spring.as_ref().map(|spring| &spring.rest))?,
            armature: self.optional(joint.armature.as_ref())?,
        })
    }
}

/// Combines two bodies in a common frame (Steiner): relative to the common centre of mass, each adds m (d'd 1 - d d') with the offset d of its
/// own. `None` if nonzero masses sum to 0.
fn together<E: Element>(zero: &E, a: &Body<E>, b: &Body<E>) -> Option<Body<E>> {
    let mass = a.mass.plus(&b.mass);
    let moment = add(&scale(&a.mass, &a.com), &scale(&b.mass, &b.com));
    let com = match mass.inverse() {
        Some(inverse) => scale(&inverse, &moment),
        None if moment.iter().all(Element::is_zero) => moment,
        None => return None,
    };
    let mut inertia = [0; 3].map(|_| [0; 3].map(|_| zero.clone()));
    for body in [a, b] {
        let d = sub(&body.com, &com);
        let square = dot(&d, &d);
        for i in 0..3 {
            for j in 0..3 {
                let shift = if i == j { square.minus(&d[i].times(&d[j])) } else { d[i].times(&d[j]).negated() };
                inertia[i][j] = inertia[i][j].plus(&body.inertia[i][j]).plus(&body.mass.times(&shift));
            }
        }
    }
    Some(Body { mass, com, inertia })
}

/// A symmetric matrix from xx xy yy xz yz zz.
pub fn symmetric<E: Element>(six: &[E]) -> Matrix<E> {
    [[0, 1, 3], [1, 2, 4], [3, 4, 5]].map(|row| row.map(|i| six[i].clone()))
}

impl<E: Element> Motor<E> {
    /// The rotor's rate beside its carrier, of the rates of joints; likewise its acceleration.
    pub fn spin(&self, zero: &E, rates: &[E]) -> E {
        self.rates.iter().fold(zero.clone(), |sum, (joint, factor)| sum.plus(&factor.times(&rates[*joint])))
    }

    /// Adds the torques of joints of a torque at the rotor, by virtual work.
    pub fn add_torque(&self, torque: &E, torques: &mut [E]) {
        for (joint, factor) in &self.rates {
            torques[*joint] = torques[*joint].plus(&factor.times(torque));
        }
    }
}

impl<E: Element> Arm<E> {
    /// The arm with `parameters` for the named quantities of the description; `None` for a division by 0.
    pub fn new<K: Arithmetic<Element = E>>(arithmetic: &K, manipulator: &Manipulator, parameters: &[E]) -> Option<Arm<E>> {
        let builder = Builder { arithmetic, parameters };
        let mut joints = Vec::new();
        for (i, joint) in manipulator.joints.iter().enumerate() {
            joints.push(builder.joint(i, joint)?);
        }
        let tip = |name: Option<&str>, link: LinkId, tool: &manipulator::Pose, load: Option<&manipulator::PlacedBody>, task| {
            let payload = match load {
                None => None,
                Some(part) => Some(builder.lumped(std::slice::from_ref(part))?),
            };
            let begin = |name: Option<String>| name.map_or(String::new(), |name| name + "_");
            let (prefix, of_load) = (begin(name.map(str::to_ascii_lowercase)), begin(name.map(str::to_owned)));
            Some(Tip { prefix, of_load, link: link.index(), tool: builder.pose(tool)?, payload, task })
        };
        let mut tips = Vec::new();
        if manipulator.tips.is_empty() {
            let (link, tool, load) = (manipulator.tip, &manipulator.tool, manipulator.payload.as_ref());
            tips.push(tip(None, link, tool, load, manipulator.task_rows())?);
        }
        for named in &manipulator.tips {
            let rows = named.task.iter().map(|row| row.index()).collect();
            tips.push(tip(Some(&named.name), named.joint, &named.tool, named.payload.as_ref(), rows)?);
        }
        let coupling = match &manipulator.coupling {
            Some(coupling) => Some(builder.coupling(coupling)?),
            None => None,
        };
        Some(Arm {
            angles: Arc::new(Angles::of(manipulator)),
            joints,
            gravity: builder.vector(&manipulator.gravity)?,
            tips,
            coupling,
            zero: arithmetic.integer(0),
            one: arithmetic.integer(1),
        })
    }

    /// The nominal values of the named quantities.
    pub fn nominal<K: Arithmetic<Element = E>>(arithmetic: &K, manipulator: &Manipulator) -> Option<Vec<E>> {
        manipulator.parameters.iter().map(|p| arithmetic.constant(&formula(&p.nominal))).collect()
    }

    /// The same arm in another number type.
    pub fn map<F: Element>(&self, f: &impl Fn(&E) -> F) -> Arm<F> {
        let vector = |v: &Vector<E>| -> Vector<F> { [0, 1, 2].map(|i| f(&v[i])) };
        let matrix = |m: &Matrix<E>| -> Matrix<F> { [0, 1, 2].map(|i| vector(&m[i])) };
        let frame = |frame: &Frame<E>| Frame { rotation: matrix(&frame.rotation), origin: vector(&frame.origin) };
        let body = |body: &Body<E>| Body { mass: f(&body.mass), com: vector(&body.com), inertia: matrix(&body.inertia) };
        let joints = self.joints.iter().map(|joint| Joint {
            revolute: joint.revolute,
            parent: joint.parent,
            before: frame(&joint.before),
            axis: vector(&joint.axis),
            after: frame(&joint.after),
            chosen: frame(&joint.chosen),
            link: body(&joint.link),
            motor: joint.motor.as_ref().map(|motor| Motor {
                carrier: motor.carrier,
                rates: motor.rates.iter().map(|(joint, factor)| (*joint, f(factor))).collect(),
                inertia: f(&motor.inertia),
                mass: f(&motor.mass),
                position: vector(&motor.position),
                axis: vector(&motor.axis),
                viscous: f(&motor.viscous),
            }),
            viscous: f(&joint.viscous),
            coulomb: f(&joint.coulomb),
            offset: f(&joint.offset),
            cubic: f(&joint.cubic),
            load: f(&joint.load),
            stribeck: f(&joint.stribeck),
            stribeck_velocity: f(&joint.stribeck_velocity),
            decays: joint.decays,
            smooth: joint.smooth,
            stiffness: f(&joint.stiffness),
            rest: f(&joint.rest),
            armature: f(&joint.armature),
        });
        Arm {
            joints: joints.collect(),
            gravity: vector(&self.gravity),
            tips: self
                .tips
                .iter()
                .map(|tip| Tip {
                    prefix: tip.prefix.clone(),
                    of_load: tip.of_load.clone(),
                    link: tip.link,
                    tool: frame(&tip.tool),
                    payload: tip.payload.as_ref().map(body),
                    task: tip.task.clone(),
                })
                .collect(),
            coupling: self.coupling.as_ref().map(|coupling| Coupling {
                coordinates: coupling.coordinates.clone(),
                variables: coupling
                    .variables
                    .iter()
                    .map(|variable| Variable {
                        factors: variable.factors.iter().map(|(a, factor)| (*a, f(factor))).collect(),
                        turns: variable.turns.clone(),
                        sign: f(&variable.sign),
                        offset: f(&variable.offset),
                        turn: (f(&variable.turn.0), f(&variable.turn.1)),
                    })
                    .collect(),
            }),
            angles: self.angles.clone(),
            zero: f(&self.zero),
            one: f(&self.one),
        }
    }

    /// The same arm under another gravity, where that is an argument: of the three coordinates given.
    #[must_use]
    pub fn under(mut self, gravity: &[E]) -> Arm<E> {
        for (own, given) in self.gravity.iter_mut().zip(gravity) {
            own.clone_from(given);
        }
        self
    }

    /// Number of coordinates.
    pub fn dof(&self) -> usize {
        self.coupling.as_ref().map_or(self.joints.len(), |coupling| coupling.coordinates.len())
    }

    /// The joint of a coordinate.
    pub fn joint_of(&self, coordinate: usize) -> usize {
        self.coupling.as_ref().map_or(coordinate, |coupling| coupling.coordinates[coordinate])
    }

    /// Whether the friction of the joint of each coordinate has an exponential.
    pub fn decays(&self) -> impl Iterator<Item = bool> + '_ {
        (0..self.dof()).map(|a| self.joints[self.joint_of(a)].decays)
    }

    /// The coordinates that move a joint, with their factors.
    pub fn row(&self, joint: usize) -> Vec<(usize, E)> {
        match &self.coupling {
            Some(coupling) => coupling.variables[joint].factors.clone(),
            None => vec![(joint, self.one.clone())],
        }
    }

    /// S x: rates of joints from those of coordinates.
    pub fn of_joints(&self, x: &[E]) -> Vec<E> {
        let Some(coupling) = &self.coupling else { return x.to_vec() };
        let sum = |variable: &Variable<E>| {
            variable.factors.iter().fold(self.zero.clone(), |sum, (a, factor)| sum.plus(&factor.times(&x[*a])))
        };
        coupling.variables.iter().map(sum).collect()
    }

    /// S p + c.
    pub fn joint_variables(&self, p: &[E]) -> Vec<E> {
        let mut q = self.of_joints(p);
        for (q, variable) in q.iter_mut().zip(self.coupling.iter().flat_map(|coupling| &coupling.variables)) {
            *q = q.plus(&variable.offset);
        }
        q
    }

    /// S' x: torques of coordinates from those of joints, by virtual work.
    pub fn of_coordinates(&self, x: Vec<E>) -> Vec<E> {
        let Some(coupling) = &self.coupling else { return x };
        let mut sums = vec![self.zero.clone(); coupling.coordinates.len()];
        for (variable, x) in coupling.variables.iter().zip(&x) {
            for (a, factor) in &variable.factors {
                sums[*a] = sums[*a].plus(&factor.times(x));
            }
        }
        sums
    }

    /// A state with the velocities of this arm's friction, and with tanh(dq / 2 v) where it is smooth: with E = exp(-|dq| / v) that is
    /// sign(dq) (1 - E) / (1 + E).
    pub fn with_friction(&self, mut state: State<E>) -> State<E> {
        for a in 0..self.dof() {
            let joint = &self.joints[self.joint_of(a)];
            state.stribeck_velocities[a].clone_from(&joint.stribeck_velocity);
            if joint.smooth {
                let (one, e) = (&self.one, &state.stribeck[a]);
                let size = one.minus(e).over(&one.plus(e)).unwrap_or_else(|| self.zero.clone());
                state.directions[a] = state.signs[a].times(&size);
                state.smooth[a] = true;
            }
        }
        state
    }

    /// The state with an entry for each joint instead of each coordinate; torques stay those of coordinates.
    pub fn state_of_joints<'s>(&self, state: &'s State<E>) -> Cow<'s, State<E>> {
        let Some(coupling) = &self.coupling else { return Cow::Borrowed(state) };
        let angle = |variable: &Variable<E>| {
            let (s, c) = state.sine_cosine(&variable.turns);
            let (t, d) = &variable.turn;
            (s.times(d).plus(&c.times(t)), c.times(d).minus(&s.times(t)))
        };
        // Of one coordinate; validation refuses dry friction of others.
        let of_one = |variable: &Variable<E>, values: &[E]| match variable.factors.as_slice() {
            [(a, _)] => values[*a].times(&variable.sign),
            _ => self.zero.clone(),
        };
        let own = |joint: usize, values: &[E], otherwise: &E| {
            let place = coupling.coordinates.iter().position(|&of| of == joint);
            place.map_or_else(|| otherwise.clone(), |a| values[a].clone())
        };
        let each = |of: &dyn Fn(usize) -> E| (0..self.joints.len()).map(of).collect::<Vec<E>>();
        Cow::Owned(State {
            angles: coupling.variables.iter().map(angle).collect(),
            computed: Vec::new(),
            q: self.joint_variables(&state.q),
            dq: self.of_joints(&state.dq),
            ddq: self.of_joints(&state.ddq),
            dqr: self.of_joints(&state.dqr),
            ddqr: self.of_joints(&state.ddqr),
            signs: coupling.variables.iter().map(|variable| of_one(variable, &state.signs)).collect(),
            directions: coupling.variables.iter().map(|variable| of_one(variable, &state.directions)).collect(),
            stribeck: each(&|joint| own(joint, &state.stribeck, &self.zero)),
            stribeck_velocities: each(&|joint| own(joint, &state.stribeck_velocities, &self.one)),
            ..state.clone()
        })
    }

    /// ½.
    pub fn half(&self) -> E {
        self.one.plus(&self.one).inverse().expect("2 is not 0")
    }

    /// The zero vector.
    pub fn nothing(&self) -> Vector<E> {
        [0; 3].map(|_| self.zero.clone())
    }
}
