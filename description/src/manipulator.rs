//! A valid arm: a tree of links and joints with exact numbers in SI units, whatever convention the file used.
//!
//! Absent from here on: spans, Denavit-Hartenberg conventions, expressions of the file, impossible values.
//! Nothing that takes a [`Manipulator`] can fail.
//!
//! Joint i owns a *joint frame*, fixed in the link that it moves, with the joint axis as its z axis:
//!
//! ```text
//! joint frame i = joint frame of the parent * placement_i * motion_i(q_i),   motion = Rz(q) (revolute) or Tz(q) (prismatic)
//! link frame i  = joint frame i * link_frame_i                               (the frame that the user sees)
//! ```
//!
//! A file gives rows A_i, the link frame in the parent's: `A_i = before_i * motion(axis_i, q_i) * after_i` ([`Row`]); `axis` is the z
//! axis in Denavit-Hartenberg rows. A standard Denavit-Hartenberg row Rz(theta + q) Tz(d) Tx(a) Rx(alpha) gives `placement = (parent's
//! link_frame) Rz(theta) Tz(d)` and `link_frame = Tx(a) Rx(alpha)`; a modified one gives `placement = Rx(alpha) Tx(a) Rz(theta) Tz(d)` and
//! `link_frame = 1`. In rows of the convention urdf joint frames are laid where Denavit and Hartenberg lay theirs (`validate/frames.rs`).

use crate::exact::{Number, Polynomial};
use crate::kinds::{Feature, JointKind, ParameterId, TaskRow};
use armgen_algebra::ring::field::computed::ComputedAngle;
use armgen_algebra::ring::AngleSum;
use std::collections::BTreeMap;

/// Index into [`Manipulator::joints`]; link i is the one that joint i moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LinkId(pub u32);

impl LinkId {
    /// As an index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Tip {
    /// The beginning of the names of its functions, with the underscore: of `left` it is `left_`.
    pub fn prefix(&self) -> String {
        self.name.to_ascii_lowercase() + "_"
    }

    /// The name of one of its constants: `LEFT_TASK` of `TASK`.
    pub fn constant(&self, name: &str) -> String {
        format!("{}_{name}", self.name.to_ascii_uppercase())
    }
}

/// The choices of the description under `inverse_kinematics`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Postures {
    /// The target; without it, what `task` says.
    pub target: Option<crate::kinds::Target>,
    /// The value that the caller also gives for an arm with one degree of redundancy.
    pub given: Option<GivenBeside>,
}

/// The value that the caller gives with the pose for an arm with one degree of redundancy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivenBeside {
    /// The value of a joint.
    Joint(LinkId),
    /// The swivel angle of the elbow about the line from shoulder to wrist.
    Swivel,
}

/// An end effector with a name, of an arm that has several.
#[derive(Clone, Debug)]
pub struct Tip {
    /// Its name: an identifier.
    pub name: String,
    /// The link that carries it.
    pub joint: LinkId,
    /// Its frame in that link's frame.
    pub tool: Pose,
    /// Rigid load, in its frame.
    pub payload: Option<PlacedBody>,
    /// Rows of its operational space, in the order of the file.
    pub task: Vec<TaskRow>,
    /// The choices of the description under its `inverse_kinematics`.
    pub inverse_kinematics: Postures,
}

/// A rigid load of an end effector.
#[derive(Clone, Copy, Debug)]
pub struct Load<'a> {
    /// The end effector's name; `None` where it has no name.
    pub of: Option<&'a str>,
    /// The place of the end effector among all of them.
    pub end: usize,
    /// The index of the link that carries the end effector.
    pub link: usize,
    /// The end effector's frame in that link's frame.
    pub tool: &'a Pose,
    /// The load, in that frame.
    pub body: &'a PlacedBody,
}

/// A valid robot arm.
#[derive(Clone, Debug)]
pub struct Manipulator {
    /// Name of the robot and of the emitted module: a Rust identifier.
    pub name: String,
    /// Named quantities that stay symbols, in the order of the file (names that enter by division, root or angle are already numbers).
    pub parameters: Vec<Parameter>,
    /// Acceleration of gravity in the base frame, m/s².
    pub gravity: [Polynomial; 3],
    /// Whether that is an argument of functions, and `gravity` its nominal value.
    pub gravity_is_argument: bool,
    /// Joints in the order of the file; a parent always precedes its children.
    pub joints: Vec<Joint>,
    /// The link that carries the end effector.
    pub tip: LinkId,
    /// End-effector frame in the tip's link frame.
    pub tool: Pose,
    /// Rigid load, in the end-effector frame, of an arm whose end effector has no name.
    pub payload: Option<PlacedBody>,
    /// Rows of the operational space, in the order of the file.
    pub task: Vec<TaskRow>,
    /// The choice of the regressor's columns.
    pub regressor: RegressorChoice,
    /// The choices of the description under `inverse_kinematics`.
    pub inverse_kinematics: Postures,
    /// The end effectors with names, in the order of the file; none where there is one end effector without a name.
    /// `tip`, `tool`, `task` and `inverse_kinematics` are then those of the first one, or of the one that [`Manipulator::at`] chose.
    pub tips: Vec<Tip>,
    /// The coupling of joints; `None` where each joint has a coordinate of its own, which is its variable.
    pub coupling: Option<Coupling>,
}

/// Joint variables as sums over coordinates: q = S p + c.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// The joints with a coordinate, by their indices, in the order of the file.
    pub coordinates: Vec<usize>,
    /// The limits of each coordinate: those of its joint and of joints that follow it alone.
    pub limits: Vec<Limits>,
    /// The variable of each joint.
    pub variables: Vec<JointVariable>,
    /// Sums of the variables of joints about parallel axes, each joint carried by the next one's link or the other way round, of which the angle
    /// of a joint is a computed one. Functions may take the sine of such a sum.
    pub sums: Vec<JointSum>,
}

/// A sum of the variables of joints that turn.
#[derive(Clone, Debug)]
pub struct JointSum {
    /// The joints; not turned.
    pub joints: AngleSum,
    /// The sum over coordinates.
    pub variable: JointVariable,
}

/// Most sums of [`Coupling::sums`].
const MOST_SUMS: usize = 64;
/// Most terms of the sine of the constant part of such a sum, which double with each constant of general size.
const MOST_TERMS: usize = 8;
/// Most turns of leaders, their factors without signs, of which sines and cosines are taken apart: they are polynomials of this degree. Of more, and
/// of factors that are no whole numbers, they are those of a computed angle.
const MOST_TURNS: i64 = 16;

/// The variable of a joint as a sum over coordinates.
#[derive(Clone, Debug)]
pub struct JointVariable {
    /// Coordinates with their factors, ascending; no factor is 0.
    pub factors: Vec<(usize, Number)>,
    /// The constant part.
    pub offset: Number,
    /// Sine and cosine of the constant part, of a joint that turns.
    pub turn: Option<[Number; 2]>,
    /// Of a joint that turns: whether its factors are whole, few in all, and of coordinates that turn, so that its sine and cosine are polynomials in
    /// theirs. Of others they are those of an angle that a function computes.
    pub is_whole: bool,
}

impl JointVariable {
    /// Of a joint that turns, or of a sum of such joints; `turns`: whether a coordinate does.
    pub(crate) fn of_angle(
        factors: BTreeMap<usize, Number>,
        offset: Number,
        turn: [Number; 2],
        turns: impl Fn(usize) -> bool,
    ) -> JointVariable {
        let whole = |(a, factor): (&usize, &Number)| {
            factor.as_rational().filter(|factor| factor.is_int())?;
            let size = factor.to_f64().abs();
            (turns(*a) && size <= MOST_TURNS as f64).then_some(size as i64)
        };
        let sizes: Option<Vec<i64>> = factors.iter().map(whole).collect();
        let is_whole = sizes.is_some_and(|sizes| sizes.iter().sum::<i64>() <= MOST_TURNS);
        JointVariable { factors: factors.into_iter().collect(), offset, turn: Some(turn), is_whole }
    }

    /// Of a joint whose angle a function computes: its variable, or the opposite where its first factor is negative, and whether it is the opposite.
    pub fn computed(&self) -> Option<(ComputedAngle, bool)> {
        let [sine, cosine] = self.turn.as_ref().filter(|_| !self.is_whole)?;
        let opposite = self.factors.first().is_some_and(|(_, factor)| factor.is_negative());
        let signed = |number: &Number| if opposite { -number } else { number.clone() };
        let mut factors: Vec<(u16, Number)> = self.factors.iter().map(|(a, factor)| (*a as u16, signed(factor))).collect();
        factors.sort_by_key(|(_, factor)| factor.is_negative());
        let angle = ComputedAngle { factors, offset: signed(&self.offset), turn: [signed(sine), cosine.clone()] };
        Some((angle, opposite))
    }
}

impl Coupling {
    /// Whether the variable of a joint is a coordinate of its own and nothing else.
    pub fn is_plain(&self, joint: usize) -> bool {
        let JointVariable { factors, offset, .. } = &self.variables[joint];
        let own = matches!(factors.as_slice(), [(a, factor)] if self.coordinates[*a] == joint && factor.is_one());
        own && offset.is_zero()
    }

    /// That of some joints alone, whose variables follow no other ones; `None` where each of them has a coordinate of its own.
    fn of_joints(&self, joints: &[usize]) -> Option<Coupling> {
        let place = |joint: usize| joints.iter().position(|&of| of == joint);
        let kept: Vec<usize> = (0..self.coordinates.len()).filter(|&a| place(self.coordinates[a]).is_some()).collect();
        let variable = |&joint: &usize| {
            let variable = self.variables[joint].clone();
            let factors = variable
                .factors
                .into_iter()
                .map(|(a, factor)| (kept.iter().position(|&of| of == a).expect("the coordinate of one of the joints"), factor));
            JointVariable { factors: factors.collect(), ..variable }
        };
        (!joints.iter().all(|&joint| self.is_plain(joint))).then(|| Coupling {
            coordinates: kept.iter().filter_map(|&a| place(self.coordinates[a])).collect(),
            limits: kept.iter().map(|&a| self.limits[a].clone()).collect(),
            variables: joints.iter().map(variable).collect(),
            sums: Vec::new(),
        })
    }

    /// The angles of joints that functions compute, each once.
    pub fn computed(&self) -> Vec<ComputedAngle> {
        distinct(self.variables.iter())
    }

    /// The same, and behind them those of sums of joints.
    pub fn all_computed(&self) -> Vec<ComputedAngle> {
        distinct(self.variables.iter().chain(self.sums.iter().map(|sum| &sum.variable)))
    }

    /// Looks for the sums of joint variables about parallel axes.
    pub(crate) fn find_sums(&mut self, joints: &[Joint]) {
        for last in 0..joints.len() {
            let (mut joint, mut minus) = (last, false);
            let mut sum = self.sum_of_none();
            while let Some(next) = self.plus(sum, (joint, minus), joints) {
                sum = next;
                let terms: Vec<(u16, bool)> = sum.joints.terms().collect();
                let is_computed = |(joint, _): &(u16, bool)| !self.variables[usize::from(*joint)].is_whole;
                if terms.len() > 1 && terms.iter().any(is_computed) {
                    self.sums.push(sum.clone());
                }
                let Some((before, opposite)) = parallel_before(joint, joints).filter(|_| self.sums.len() < MOST_SUMS) else {
                    break;
                };
                (joint, minus) = (before, minus != opposite);
            }
        }
    }

    fn sum_of_none(&self) -> JointSum {
        let turn = Some([Number::zero(), Number::one()]);
        let variable = JointVariable { factors: Vec::new(), offset: Number::zero(), turn, is_whole: true };
        JointSum { joints: AngleSum { plus: 0, minus: 0, turned: false }, variable }
    }

    /// A sum with a joint more; `None` of a joint that slides, or where the constant part gets long.
    fn plus(&self, mut sum: JointSum, (joint, minus): (usize, bool), joints: &[Joint]) -> Option<JointSum> {
        let signed = |number: &Number| if minus { -number } else { number.clone() };
        let own = &self.variables[joint];
        let ([s, c], [t, d]) = (sum.variable.turn?, own.turn.as_ref()?);
        let t = signed(t);
        let turn = [s.times(d).plus(&c.times(&t)), c.times(d).minus(&s.times(&t))];
        if turn.iter().any(|number| number.terms().count() > MOST_TERMS) {
            return None;
        }
        let mut factors: BTreeMap<usize, Number> = sum.variable.factors.into_iter().collect();
        for (a, factor) in &own.factors {
            let all = factors.entry(*a).or_insert_with(Number::zero);
            *all = all.plus(&signed(factor));
        }
        factors.retain(|_, factor| !factor.is_zero());
        let offset = sum.variable.offset.plus(&signed(&own.offset));
        *(if minus { &mut sum.joints.minus } else { &mut sum.joints.plus }) |= 1 << joint;
        let turns = |a: usize| joints[self.coordinates[a]].kind == JointKind::Revolute;
        Some(JointSum { variable: JointVariable::of_angle(factors, offset, turn, turns), ..sum })
    }
}

/// The angles that functions compute for variables, each once.
fn distinct<'a>(variables: impl Iterator<Item = &'a JointVariable>) -> Vec<ComputedAngle> {
    let mut all: Vec<ComputedAngle> = Vec::new();
    for (angle, _) in variables.filter_map(JointVariable::computed) {
        if !all.contains(&angle) {
            all.push(angle);
        }
    }
    all
}

/// The joint whose link carries a joint, where both turn about parallel axes, and whether these point opposite ways.
fn parallel_before(joint: usize, joints: &[Joint]) -> Option<(usize, bool)> {
    let parent = joints[joint].parent?.index();
    let both_turn = [joint, parent].iter().all(|&i| joints[i].kind == JointKind::Revolute);
    let [[.., x], [.., y], [.., z]] = &joints[joint].placement.rotation;
    (both_turn && x.is_zero() && y.is_zero()).then(|| (parent, z.is_negative()))
}

/// A coordinate of an arm.
#[derive(Clone, Copy, Debug)]
pub struct Coordinate<'a> {
    /// The index of its joint.
    pub index: usize,
    /// Its joint, whose name it has.
    pub joint: &'a Joint,
    /// Its limits.
    pub limits: &'a Limits,
}

/// A named quantity of the file.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name: an identifier, not reserved.
    pub name: String,
    /// Its value in the file.
    pub nominal: Number,
}

/// A joint and the link that it moves.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its name in the file.
    pub name: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// The link that carries this joint; `None` for the base.
    pub parent: Option<LinkId>,
    /// The place of the link, as the file gives it.
    pub row: Row,
    /// The joint frame at q = 0 in the parent's *joint frame* (the base frame if there is no parent).
    pub placement: Placement,
    /// The link's frame, as the user sees it, in the joint frame.
    pub link_frame: Placement,
    /// Limits as written, if any.
    pub limits: Limits,
    /// The bodies that make up the link, in the *link frame*: its own, then those that are fixed to it.
    pub link: Vec<PlacedBody>,
    /// The rotor that drives this joint.
    pub motor: Option<Motor>,
    /// Friction at the joint; `None` where the file does not give it.
    pub viscous: Option<Polynomial>,
    /// Coulomb friction at the joint, N m or N; the torque is coulomb · sign(dq).
    pub coulomb: Option<Polynomial>,
    /// v, rad/s or m/s, above 0: the torque of Coulomb friction is coulomb · tanh(dq / v). There is no Stribeck and load friction beside it.
    pub smooth: Option<Number>,
    /// Half the difference of Coulomb friction forwards and backwards, N m or N: the torque is offset at every rate.
    pub offset: Option<Polynomial>,
    /// Cubic friction, N m s³ or N s³/m³: the torque is cubic · dq³.
    pub cubic: Option<Polynomial>,
    /// Friction that grows with the joint's load, without unit, at least 0: the torque is load · |g| · sign(dq), g the joint's entry of g(q).
    pub load: Option<Number>,
    /// Friction that fades as the joint begins to move.
    pub stribeck: Option<Stribeck>,
    /// A spring between the joint and the link that carries it.
    pub spring: Option<Spring>,
    /// Inertia that the joint alone feels, kg m² or kg: the torque is armature · ddq. `None` where the file does not give it.
    pub armature: Option<Polynomial>,
}

impl Joint {
    /// Whether it has a feature.
    pub fn has(&self, feature: Feature) -> bool {
        match feature {
            Feature::Spring => self.spring.is_some(),
            Feature::OffsetOrCubic => self.offset.is_some() || self.cubic.is_some(),
            Feature::SmoothFriction => self.smooth.is_some(),
            Feature::Stribeck => self.stribeck.is_some(),
            Feature::LoadFriction => self.load.as_ref().is_some_and(|load| !load.is_zero()),
            Feature::CoupledMotor => self.motor.as_ref().is_some_and(|motor| !motor.coupling.is_empty()),
        }
    }

    /// Its rotor, where that rides on the link that carries the joint and spins with the joint alone.
    pub fn plain_motor(&self) -> Option<&Motor> {
        self.motor.as_ref().filter(|motor| motor.carrier == self.parent && motor.coupling.is_empty())
    }

    /// v of exp(-|dq| / v), which its friction contains: tanh(dq / w) = sign(dq) (1 - E) / (1 + E) with E = exp(-2 |dq| / w).
    pub fn decay_velocity(&self) -> Option<Number> {
        let half = || Some(self.smooth.as_ref()?.times(&Number::from(2).inverse()?));
        self.stribeck.as_ref().map(|stribeck| stribeck.velocity.clone()).or_else(half)
    }

    /// The velocity of its friction as the description has it; 1 where it has no velocity.
    pub fn friction_velocity(&self) -> Number {
        self.smooth.clone().or_else(|| self.decay_velocity()).unwrap_or_else(Number::one)
    }
}

/// Stribeck friction at a joint: the torque is torque · sign(dq) · exp(-|dq| / velocity), beyond Coulomb friction.
#[derive(Clone, Debug)]
pub struct Stribeck {
    /// N m or N.
    pub torque: Polynomial,
    /// rad/s or m/s; above 0.
    pub velocity: Number,
}

/// A spring at a joint: the torque on the left of the equation of motion is stiffness · (q - rest), part of g(q).
#[derive(Clone, Debug)]
pub struct Spring {
    /// N m/rad or N/m; at least 0.
    pub stiffness: Polynomial,
    /// The joint variable at which it pulls neither way, rad or m.
    pub rest: Polynomial,
}

/// A row of the file: link frame i in the parent's link frame (the base frame) is `before * motion * after`, where motion is the rotation by q about
/// `axis`, or the translation by q along it.
#[derive(Clone, Debug)]
pub struct Row {
    /// The pose before the motion.
    pub before: Pose,
    /// Unit vector of the joint axis, in the frame after `before`, through its origin.
    pub axis: [Number; 3],
    /// The pose after the motion.
    pub after: Pose,
}

/// A frame in another, as a product of simple ones.
#[derive(Clone, Debug)]
pub struct Pose {
    /// Translations, and rotations about one axis each, every one in the frame of the one before it.
    pub elements: Vec<Placement>,
    /// Their product.
    pub frame: Placement,
}

/// A body as the file gives it, and the same in the frame of what carries it.
#[derive(Clone, Debug)]
pub struct PlacedBody {
    /// Its own frame F, in the frame of what carries it.
    pub frame: Pose,
    /// The axes of the inertia tensor, in F.
    pub axes: Pose,
    /// Mass, centre of mass in F, and inertia about the centre of mass in `axes`.
    pub given: Body,
    /// Mass, centre of mass and inertia in the frame of what carries it.
    pub body: Body,
}

/// Limits of a joint; rad or m, rad/s or m/s, rad/s² or m/s², rad/s³ or m/s³, N m or N.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// Lowest and highest q.
    pub position: Option<[Number; 2]>,
    /// Highest |dq|.
    pub velocity: Option<Number>,
    /// Highest |ddq| of planned motions.
    pub acceleration: Option<Number>,
    /// Highest |dddq| of planned motions.
    pub jerk: Option<Number>,
    /// Highest |tau|.
    pub effort: Option<Number>,
}

/// A rigid body in a frame F.
#[derive(Clone, Debug)]
pub struct Body {
    /// Mass, kg.
    pub mass: Polynomial,
    /// Centre of mass in F, m.
    pub com: [Polynomial; 3],
    /// Inertia tensor about the centre of mass, axes of F, kg m²: xx, xy, yy, xz, yz, zz (xy is the element Ixy = -∫xy dm).
    pub inertia: [Polynomial; 6],
}

/// A rotor: rides on a link and spins about its own axis with `ratio` times the joint rate, and with the rates that are coupled to it.
#[derive(Clone, Debug)]
pub struct Motor {
    /// k_r: rotor speed over joint speed; rad/rad or rad/m; not zero.
    pub ratio: Polynomial,
    /// The link that it rides on; `None` for the base.
    pub carrier: Option<LinkId>,
    /// Further joints that it spins with, by their indices, ascending, with factors, none 0 and none of its own joint; rad/rad or rad/m.
    pub coupling: Vec<(usize, Number)>,
    /// Inertia about the spin axis, kg m²; `None` where the file does not give it.
    pub inertia: Option<Polynomial>,
    /// Mass, kg.
    pub mass: Polynomial,
    /// Its place in the *link frame* of its carrier (the base frame if that is the base), m.
    pub position: [Polynomial; 3],
    /// Unit vector of the spin axis in that frame.
    pub axis: [Number; 3],
    /// Viscous friction at the rotor, N m s; acts at the joint as ratio² times this, with `coupling` at several. `None` where the file does not give it.
    pub viscous: Option<Polynomial>,
    /// Torque or force at the joint per unit of measured current, N m/A or N/A; above 0. It turns logs of currents into torques, and enters no equation.
    pub gain: Option<Number>,
}

/// A fixed frame in another: x_outer = rotation · x_inner + translation.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Rotation matrix, `[row][column]`.
    pub rotation: [[Number; 3]; 3],
    /// Translation, m.
    pub translation: [Polynomial; 3],
}

/// The choice of the regressor's columns.
#[derive(Clone, Debug, PartialEq)]
pub enum RegressorChoice {
    /// Ten per link, then motors and friction, then the payload.
    Standard,
    /// The minimal parameter set of `Standard`.
    Base,
    /// Chosen names; tau is linear in all of them together.
    Names(Vec<ParameterId>),
}

impl Manipulator {
    /// Whether nothing that moves has mass or inertia, whatever the parameters: there are no equations of motion.
    pub fn is_massless(&self) -> bool {
        let bodies = self.joints.iter().flat_map(|joint| &joint.link).chain(self.loads().into_iter().map(|load| load.body));
        let motors = self.joints.iter().filter_map(|joint| joint.motor.as_ref());
        let of_bodies = bodies.flat_map(|body| body.given.inertia.iter().chain([&body.given.mass]));
        let of_motors = motors.flat_map(|motor| motor.inertia.iter().chain([&motor.mass]));
        let of_joints = self.joints.iter().filter_map(|joint| joint.armature.as_ref());
        of_bodies.chain(of_motors).chain(of_joints).all(Polynomial::is_zero)
    }

    /// The same arm with one of its named end effectors as the one that its equations are of.
    #[must_use]
    pub fn at(&self, tip: usize) -> Manipulator {
        let chosen = self.tips[tip].clone();
        Manipulator {
            tip: chosen.joint,
            tool: chosen.tool,
            task: chosen.task,
            inverse_kinematics: chosen.inverse_kinematics,
            ..self.clone()
        }
    }

    /// The part that moves a named end effector, as an arm with this end effector alone: the joints from the base to it, and those whose
    /// coordinates they follow. Its coordinates have the order of this arm's. It has neither motors nor a payload: its kinematics are meant.
    #[must_use]
    pub fn arm_to(&self, tip: usize) -> Manipulator {
        let arm = self.at(tip);
        let mut kept = vec![false; self.joints.len()];
        let mut left = vec![arm.tip.index()];
        while let Some(joint) = left.pop() {
            if std::mem::replace(&mut kept[joint], true) {
                continue;
            }
            left.extend(self.joints[joint].parent.map(LinkId::index));
            if let Some(coupling) = &self.coupling {
                left.extend(coupling.variables[joint].factors.iter().map(|(coordinate, _)| coupling.coordinates[*coordinate]));
            }
        }
        let joints: Vec<usize> = (0..self.joints.len()).filter(|&joint| kept[joint]).collect();
        let place = |joint: usize| joints.iter().position(|&of| of == joint);
        let link = |of: LinkId| place(of.index()).map(|place| LinkId(place as u32));
        let joint = |&index: &usize| {
            let joint = self.joints[index].clone();
            Joint { parent: joint.parent.and_then(link), motor: None, ..joint }
        };
        let given = arm.inverse_kinematics.given.and_then(|given| match given {
            GivenBeside::Joint(joint) => link(joint).map(GivenBeside::Joint),
            GivenBeside::Swivel => Some(given),
        });
        Manipulator {
            name: format!("{}_{}", self.name, self.tips[tip].name),
            joints: joints.iter().map(joint).collect(),
            tip: link(arm.tip).expect("the end effector's own link"),
            inverse_kinematics: Postures { given, ..arm.inverse_kinematics },
            tips: Vec::new(),
            coupling: self.coupling.as_ref().and_then(|coupling| coupling.of_joints(&joints)),
            ..arm
        }
    }

    /// The joints from the base to the end effector as an arm of their own, in which each has a coordinate that is its variable, and no motor.
    #[must_use]
    pub fn chain(&self) -> Manipulator {
        let path = self.path_to(self.tip.index());
        let place = |joint: usize| path.iter().position(|&of| of == joint).map(|place| LinkId(place as u32));
        let joint = |&index: &usize| {
            let joint = self.joints[index].clone();
            Joint { parent: joint.parent.and_then(|parent| place(parent.index())), motor: None, ..joint }
        };
        let given = self.inverse_kinematics.given.and_then(|given| match given {
            GivenBeside::Joint(joint) => place(joint.index()).map(GivenBeside::Joint),
            GivenBeside::Swivel => Some(given),
        });
        Manipulator {
            joints: path.iter().map(joint).collect(),
            tip: LinkId(path.len() as u32 - 1),
            inverse_kinematics: Postures { given, ..self.inverse_kinematics },
            coupling: None,
            ..self.clone()
        }
    }

    /// The same arm with its first named end effector as the only one, without a name: for what knows one end effector. The payloads of the
    /// others are bodies of their links.
    #[must_use]
    pub fn with_one_end_effector(&self) -> Manipulator {
        let mut arm = self.clone();
        let tips = std::mem::take(&mut arm.tips);
        for (number, tip) in tips.into_iter().enumerate() {
            let Some(load) = tip.payload else { continue };
            if number == 0 {
                arm.payload = Some(load);
                continue;
            }
            let elements = tip.tool.elements.into_iter().chain(load.frame.elements);
            let body = PlacedBody::new(Pose::new(elements.collect()), load.axes, load.given);
            arm.joints[tip.joint.index()].link.push(body);
        }
        arm
    }

    /// The loads of all end effectors.
    pub fn loads(&self) -> Vec<Load<'_>> {
        let own = self.payload.iter().map(|body| Load { of: None, end: 0, link: self.tip.index(), tool: &self.tool, body });
        let named = self.tips.iter().enumerate().filter_map(|(end, tip)| {
            let body = tip.payload.as_ref()?;
            Some(Load { of: Some(&tip.name), end, link: tip.joint.index(), tool: &tip.tool, body })
        });
        own.chain(named).collect()
    }

    /// The frames of all end effectors, each in the frame of the link that carries it, which is given by its index.
    pub fn ends(&self) -> Vec<(usize, &Pose)> {
        if self.tips.is_empty() {
            return vec![(self.tip.index(), &self.tool)];
        }
        self.tips.iter().map(|tip| (tip.joint.index(), &tip.tool)).collect()
    }

    /// The joints that move a link, by their indices, from the base on.
    pub fn path_to(&self, link: usize) -> Vec<usize> {
        let parent = |&i: &usize| self.joints[i].parent.map(LinkId::index);
        let mut path: Vec<usize> = std::iter::successors(Some(link), parent).collect();
        path.reverse();
        path
    }

    /// What its joints have, for the documentation of functions.
    pub fn features(&self) -> Vec<Feature> {
        let all = Feature::ALL.into_iter();
        all.filter(|feature| self.joints.iter().any(|joint| joint.has(*feature))).collect()
    }

    /// The velocities of the joints' friction; 1 where it has no velocity.
    pub fn friction_velocities(&self) -> Vec<Number> {
        self.joints.iter().map(Joint::friction_velocity).collect()
    }

    /// Whether friction of joints grows with their load.
    pub fn has_load_friction(&self) -> bool {
        self.joints.iter().any(|joint| joint.has(Feature::LoadFriction))
    }

    /// The joint that carries each one, by its index.
    pub fn parents(&self) -> impl Iterator<Item = Option<usize>> + '_ {
        self.joints.iter().map(|joint| joint.parent.map(LinkId::index))
    }

    /// Whether the joints are no single chain, each on the link of the joint before it.
    pub fn branches(&self) -> bool {
        self.parents().enumerate().any(|(i, parent)| parent != i.checked_sub(1))
    }

    /// Number of coordinates: of joints, but for those that follow others.
    pub fn dof(&self) -> usize {
        self.coupling.as_ref().map_or(self.joints.len(), |coupling| coupling.coordinates.len())
    }

    /// The coordinates, in the order of the joints.
    pub fn coordinates(&self) -> Vec<Coordinate<'_>> {
        let of = |(index, limits)| Coordinate { index, joint: &self.joints[index], limits };
        match &self.coupling {
            Some(coupling) => coupling.coordinates.iter().copied().zip(&coupling.limits).map(of).collect(),
            None => self.joints.iter().map(|joint| &joint.limits).enumerate().map(of).collect(),
        }
    }

    /// The first joint whose variable is no coordinate of its own alone.
    pub fn coupled_joint(&self) -> Option<&Joint> {
        let coupling = self.coupling.as_ref()?;
        (0..self.joints.len()).find(|&i| !coupling.is_plain(i)).map(|i| &self.joints[i])
    }

    /// The joints with motors, and for each motor its speed over the rate of each coordinate; empty where each motor turns with one joint
    /// that is a coordinate.
    pub fn motor_rates(&self) -> Vec<(&Joint, Vec<Number>)> {
        let coupled = self.coupling.is_some() || self.features().contains(&Feature::CoupledMotor);
        let nominal = |id: ParameterId| self.parameters[id.0 as usize].nominal.clone();
        let rates = |i: usize, motor: &Motor| {
            let mut rates = vec![Number::zero(); self.dof()];
            let mut add = |joint: usize, factor: &Number| match &self.coupling {
                None => rates[joint] = rates[joint].plus(factor),
                Some(coupling) => {
                    for (a, k) in &coupling.variables[joint].factors {
                        rates[*a] = rates[*a].plus(&factor.times(k));
                    }
                }
            };
            add(i, &motor.ratio.evaluate(&nominal));
            motor.coupling.iter().for_each(|(joint, factor)| add(*joint, factor));
            rates
        };
        let all = self.joints.iter().enumerate().filter(|_| coupled);
        all.filter_map(|(i, joint)| Some((joint, rates(i, joint.motor.as_ref()?)))).collect()
    }

    /// The coordinates that move a link, by their indices, ascending.
    pub fn coordinates_of(&self, link: usize) -> Vec<usize> {
        let path = self.path_to(link);
        let Some(coupling) = &self.coupling else { return path };
        let moving = |a: &usize| path.iter().any(|&i| coupling.variables[i].factors.iter().any(|(of, _)| of == a));
        (0..coupling.coordinates.len()).filter(moving).collect()
    }

    /// Rows of the geometric Jacobian that make up the task.
    pub fn task_rows(&self) -> Vec<usize> {
        self.task.iter().map(|row| row.index()).collect()
    }
}

impl Placement {
    /// No rotation, no translation.
    pub fn identity() -> Placement {
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { Number::one() } else { Number::zero() }));
        Placement { rotation, translation: std::array::from_fn(|_| Polynomial::zero()) }
    }

    /// The frame `inner`, given in this one, in the frame that this one is given in.
    #[must_use]
    pub fn then(&self, inner: &Placement) -> Placement {
        let rotation = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                (0..3).fold(Number::zero(), |sum, k| sum.plus(&self.rotation[i][k].times(&inner.rotation[k][j])))
            })
        });
        Placement { rotation, translation: self.point(&inner.translation) }
    }

    /// The frame that this one is given in, in this one.
    #[must_use]
    pub fn inverse(&self) -> Placement {
        let rotation: [[Number; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| self.rotation[j][i].clone()));
        let back = Placement { rotation: rotation.clone(), ..Placement::identity() };
        Placement { rotation, translation: back.point(&self.translation).map(|x| -&x) }
    }

    /// Whether all its numbers are multiplied out.
    pub fn is_multiplied_out(&self) -> bool {
        let lengths = self.translation.iter().flat_map(|x| x.terms().map(|(_, c)| c));
        !self.rotation.iter().flatten().chain(lengths).any(Number::is_shared)
    }

    /// A point of this frame in the outer one.
    pub fn point(&self, point: &[Polynomial; 3]) -> [Polynomial; 3] {
        std::array::from_fn(|i| {
            (0..3)
                .fold(self.translation[i].clone(), |sum, k| &sum + &(&Polynomial::from(self.rotation[i][k].clone()) * &point[k]))
        })
    }

    /// A direction of this frame in the outer one.
    pub fn direction(&self, direction: &[Number; 3]) -> [Number; 3] {
        std::array::from_fn(|i| (0..3).fold(Number::zero(), |sum, k| sum.plus(&self.rotation[i][k].times(&direction[k]))))
    }
}

impl Row {
    /// The row behind a pose.
    #[must_use]
    pub(crate) fn behind(self, start: Pose) -> Row {
        if start.elements.is_empty() {
            return self;
        }
        let elements = start.elements.into_iter().chain(self.before.elements);
        Row { before: Pose::new(elements.collect()), ..self }
    }
}

impl Pose {
    /// The product of these frames.
    pub fn new(elements: Vec<Placement>) -> Pose {
        let frame = elements.iter().skip(1).fold(elements.first().cloned(), |product, element| product.map(|p| p.then(element)));
        Pose { frame: frame.unwrap_or_else(Placement::identity), elements }
    }

    /// No rotation, no translation.
    pub fn identity() -> Pose {
        Pose::new(Vec::new())
    }
}

impl PlacedBody {
    /// The body `given` in its own frame, with the axes of its tensor in that frame.
    pub fn new(frame: Pose, axes: Pose, given: Body) -> PlacedBody {
        let body = if frame.elements.is_empty() && axes.elements.is_empty() {
            given.clone()
        } else {
            let turn = frame.frame.then(&axes.frame).rotation.map(|row| row.map(Polynomial::from));
            let tensor = |i: usize, j: usize| &given.inertia[[[0, 1, 3], [1, 2, 4], [3, 4, 5]][i][j]];
            let half: [[Polynomial; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|j| (0..3).fold(Polynomial::zero(), |sum, k| &sum + &(&turn[i][k] * tensor(k, j))))
            });
            let full = |i: usize, j: usize| (0..3).fold(Polynomial::zero(), |sum, k| &sum + &(&half[i][k] * &turn[j][k]));
            Body {
                mass: given.mass.clone(),
                com: frame.frame.point(&given.com),
                inertia: [full(0, 0), full(0, 1), full(1, 1), full(0, 2), full(1, 2), full(2, 2)],
            }
        };
        PlacedBody { frame, axes, given, body }
    }
}
