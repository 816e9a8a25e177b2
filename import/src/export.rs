//! A description as a URDF.
//!
//! Root link `base`; for each joint its link, `JOINT_link`, which turns about or slides along an axis through its origin; last link `tool`, or the links of named
//! end effectors.
//! A list of poses is a line of fixed joints. Rows of Denavit and Hartenberg become
//!
//! ```text
//! standard: Rz(theta) Tz(d) | motion | Tx(a) Rx(alpha) and the body: a further link, JOINT_body
//! modified: Rx(alpha) Tx(a), Rz(theta) Tz(d) | motion | body
//! ```
//!
//! Limits of acceleration and jerk need URDF 1.2; without them the file names no version, which means 1.0.
//!
//! `damping` is what the joint feels, ratio² · `viscous` of the motor included.
//!
//! Decimals are written digit by digit, multiples of pi/12 as the nearest float, which import takes for what it means, and everything else with
//! 17 digits, which is said.

mod text;

use std::collections::BTreeSet;

use armgen_codegen::description::{
    AttachedDescription, BodyDescription, Convention, FrictionDescription, JointDescription, MotorDescription, PoseDescription,
    PosturesDescription, RegressorDescription, RobotDescription, RotationDescription, Value,
};
use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::document::Expression;
use armgen_codegen::exact::{Number, Rational};
use armgen_codegen::kinds::{JointKind, Target};
use armgen_codegen::source::{Source, Spanned};
use armgen_codegen::validate::{self, NominalValues};

use crate::number::{decimal, ending};

/// A URDF, and the parts of the description that it cannot hold.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The text of the URDF.
    pub urdf: String,
    /// Rounded and omitted values, a line for each.
    pub lines: Vec<String>,
}

/// A robot of a URDF.
pub(crate) struct Urdf {
    pub(crate) name: String,
    pub(crate) parts: Vec<Part>,
}

/// A joint and the link that it carries.
pub(crate) struct Part {
    pub(crate) joint: String,
    pub(crate) parent: String,
    pub(crate) link: String,
    pub(crate) origin: Pose,
    pub(crate) motion: Option<Motion>,
    pub(crate) body: Option<Body>,
}

/// Texts of a translation and of angles about x, y, z.
#[derive(Clone, PartialEq)]
pub(crate) struct Pose {
    pub(crate) xyz: [String; 3],
    pub(crate) rpy: [String; 3],
}

/// How a joint moves.
pub(crate) struct Motion {
    pub(crate) kind: &'static str,
    pub(crate) axis: [String; 3],
    pub(crate) position: Option<[String; 2]>,
    pub(crate) velocity: Option<String>,
    pub(crate) effort: Option<String>,
    pub(crate) acceleration: Option<String>,
    pub(crate) jerk: Option<String>,
    pub(crate) viscous: Option<String>,
    pub(crate) coulomb: Option<String>,
    /// Leader, factor and offset.
    pub(crate) mimic: Option<[String; 3]>,
}

/// A mass distribution.
pub(crate) struct Body {
    pub(crate) origin: Pose,
    pub(crate) mass: String,
    /// xx, xy, yy, xz, yz, zz.
    pub(crate) inertia: [String; 6],
}

fn zeros<const N: usize>() -> [String; N] {
    std::array::from_fn(|_| "0".to_owned())
}

impl Pose {
    pub(crate) fn identity() -> Pose {
        Pose { xyz: zeros(), rpy: zeros() }
    }

    pub(crate) fn is_identity(&self) -> bool {
        *self == Pose::identity()
    }
}

impl Body {
    fn is_nothing(&self) -> bool {
        self.mass == "0" && self.inertia.iter().all(|x| x == "0")
    }
}

/// The URDF of a description. All faults of the description; there is a URDF if and only if none of them is an error.
pub fn export(source: &Source) -> (Option<Exported>, Diagnostics) {
    let (valid, diagnostics) = validate::read(source);
    let description = RobotDescription::parse(source).0.filter(|_| valid.is_some());
    let exported = description.map(|description| {
        let values = NominalValues::new(&description);
        let writer = Writer { source, values, rounded: 0, names: BTreeSet::new(), parts: Vec::new(), lines: Vec::new() };
        let parents = valid.iter().flat_map(|(arm, _)| arm.parents()).collect::<Vec<_>>();
        let ends: Vec<usize> = valid.iter().flat_map(|(arm, _)| arm.ends().into_iter().map(|(link, _)| link)).collect();
        writer.write(&description, &parents, &ends)
    });
    (exported, diagnostics)
}

struct Writer<'d> {
    source: &'d Source,
    values: NominalValues<'d>,
    /// Numbers that are rounded.
    rounded: usize,
    /// Links.
    names: BTreeSet<String>,
    parts: Vec<Part>,
    lines: Vec<String>,
}

impl Writer<'_> {
    /// `parents`: the joint that carries each one; `ends`: the joints whose links carry end effectors.
    fn write(mut self, description: &RobotDescription, parents: &[Option<usize>], ends: &[usize]) -> Exported {
        let joints: &[JointDescription] = description.joints.as_ref().map_or(&[], |joints| &joints.value);
        let convention = description.convention.as_ref().map_or(Convention::Urdf, |convention| convention.value);
        let tips = description.tips.as_ref().map_or(&[][..], |tips| &tips.value);
        let word = |name: &Option<Spanned<String>>| name.as_ref().map_or_else(String::new, |name| name.value.clone());
        self.names.insert("base".to_owned());
        let name = |joint: &JointDescription| joint.name.as_ref().map_or_else(String::new, |name| name.value.clone());
        self.names.extend(joints.iter().map(|joint| format!("{}_link", name(joint))));
        let tools: Vec<(String, Option<&PoseDescription>)> = match tips {
            [] => vec![(self.free_name("tool"), description.tool.as_ref())],
            tips => tips.iter().map(|tip| (self.free_name(&word(&tip.name)), tip.tool.as_ref())).collect(),
        };
        let base = self.poses(description.base.as_ref());
        // The name of each link, and the poses between its origin and the rows on it.
        let mut links: Vec<(String, Vec<Pose>)> = Vec::new();
        for (k, joint) in joints.iter().enumerate() {
            let (mut link, mut before) =
                parents[k].map_or_else(|| ("base".to_owned(), base.clone()), |parent| links[parent].clone());
            before.extend(self.poses(joint.mount.as_ref()));
            let twist = [self.about_x(joint)];
            let turn = self.about_z(joint);
            match convention {
                Convention::Urdf => before.extend(self.poses(joint.origin.as_ref())),
                Convention::Standard => before.push(turn),
                Convention::Modified => before.extend(twist.iter().cloned().chain([turn])),
            }
            let after: Vec<Pose> = if convention == Convention::Standard { twist.into() } else { Vec::new() };
            let name = name(joint);
            let origin = self.all_but_last(&mut link, before, if k == 0 { "base" } else { &name });
            let moving = format!("{name}_link");
            let motion = self.motion(joint, convention);
            self.parts.push(Part {
                joint: name.clone(),
                parent: link,
                link: moving.clone(),
                origin,
                motion: Some(motion),
                body: None,
            });
            let after: Vec<Pose> = after.into_iter().filter(|pose| !pose.is_identity()).collect();
            if let Some(body) = &joint.link {
                self.bodies(&name, &moving, &after, body);
            }
            links.push((moving, after));
        }
        for ((name, tool), &end) in tools.iter().zip(ends) {
            let (link, mut before) = links[end].clone();
            before.extend(self.poses(*tool));
            self.fixed(name, &link, before, None);
        }
        self.say_what_is_left_out(description, joints);
        let urdf =
            Urdf { name: description.name.as_ref().map_or_else(String::new, |name| name.value.clone()), parts: self.parts };
        Exported { urdf: text::print(&urdf), lines: self.lines }
    }

    /// The body of a link and those that are attached to it, in a frame on the joint axis.
    fn bodies(&mut self, joint: &str, link: &str, frame: &[Pose], description: &BodyDescription) {
        let body = self.body(description);
        // A link without mass of its own is one without `inertial`, where others give it mass.
        if description.attached.is_empty() || !body.is_nothing() {
            if frame.is_empty() {
                self.parts.last_mut().expect("its joint").body = Some(body);
            } else {
                let name = self.free_name(&format!("{joint}_body"));
                self.fixed(&name, link, frame.to_vec(), Some(body));
            }
        }
        for (k, other) in description.attached.iter().enumerate() {
            self.attached(joint, k, link, frame, other);
        }
    }

    fn attached(&mut self, joint: &str, k: usize, link: &str, frame: &[Pose], other: &AttachedDescription) {
        let given = other.name.as_ref().map(|name| name.value.clone());
        let name = self.free_name(&given.unwrap_or_else(|| format!("{joint}_attached_{}", k + 1)));
        let poses: Vec<Pose> = frame.iter().cloned().chain(self.poses(other.origin.as_ref())).collect();
        let body = self.body(&other.body);
        self.fixed(&name, link, poses, Some(body));
    }

    /// A link that is fixed to another one; poses but the last get links of their own.
    fn fixed(&mut self, name: &str, link: &str, poses: Vec<Pose>, body: Option<Body>) {
        let mut parent = link.to_owned();
        let origin = self.all_but_last(&mut parent, poses, name);
        self.parts.push(Part { joint: format!("{name}_joint"), parent, link: name.to_owned(), origin, motion: None, body });
    }

    /// Links without mass for all poses but the last one, which is given back.
    fn all_but_last(&mut self, link: &mut String, poses: Vec<Pose>, name: &str) -> Pose {
        let mut poses: Vec<Pose> = poses.into_iter().filter(|pose| !pose.is_identity()).collect();
        let last = poses.pop().unwrap_or_else(Pose::identity);
        for (k, origin) in poses.into_iter().enumerate() {
            let next = self.free_name(&format!("{name}_{}", k + 1));
            let joint = if (name, k) == ("base", 0) { "base_joint".to_owned() } else { format!("{next}_joint") };
            let parent = std::mem::replace(link, next.clone());
            self.parts.push(Part { joint, parent, link: next, origin, motion: None, body: None });
        }
        last
    }

    /// A name that no link has yet.
    fn free_name(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut count = 2;
        while !self.names.insert(name.clone()) {
            name = format!("{wanted}_{count}");
            count += 1;
        }
        name
    }

    /// Tx(a) Rx(alpha).
    fn about_x(&mut self, joint: &JointDescription) -> Pose {
        let [a, alpha] = [self.value(&joint.a), self.angle(&joint.alpha)];
        Pose { xyz: [a, "0".into(), "0".into()], rpy: [alpha, "0".into(), "0".into()] }
    }

    /// Rz(theta) Tz(d).
    fn about_z(&mut self, joint: &JointDescription) -> Pose {
        let [d, theta] = [self.value(&joint.d), self.angle(&joint.theta)];
        Pose { xyz: ["0".into(), "0".into(), d], rpy: ["0".into(), "0".into(), theta] }
    }

    fn motion(&mut self, joint: &JointDescription, convention: Convention) -> Motion {
        let prismatic = joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Prismatic);
        let axis = match &joint.axis {
            Some(axis) if convention == Convention::Urdf => axis.value.each_ref().map(|x| self.value(x)),
            _ => ["0", "0", "1"].map(str::to_owned),
        };
        let mut optional = |value: &Value| value.as_ref().map(|expression| self.decimal(expression));
        let (velocity, effort) = (optional(&joint.limits.velocity), optional(&joint.limits.effort));
        let (acceleration, jerk) = (optional(&joint.limits.acceleration), optional(&joint.limits.jerk));
        let coulomb = optional(&joint.friction.coulomb);
        let viscous = match self.rotor_friction(joint) {
            None => joint.friction.viscous.as_ref().map(|expression| self.decimal(expression)),
            Some(rotor) => Some(self.written(&(&self.number(&joint.friction.viscous) + &rotor))),
        };
        let position = joint.limits.position.as_ref().map(|limits| limits.value.each_ref().map(|x| self.value(x)));
        let kind = match (prismatic, &position) {
            (true, _) => "prismatic",
            (false, Some(_)) => "revolute",
            (false, None) => "continuous",
        };
        let mimic = joint.follows.as_ref().and_then(|follows| match follows.leaders.as_slice() {
            [(leader, factor)] => {
                let offset = joint.offset.as_ref().map_or_else(|| "0".to_owned(), |offset| self.decimal(offset));
                Some([leader.value.clone(), self.value(factor), offset])
            }
            _ => None,
        });
        Motion { kind, axis, position, velocity, effort, acceleration, jerk, viscous, coulomb, mimic }
    }

    /// Viscous friction of a joint's motor as the joint feels it: ratio² times that at the rotor.
    fn rotor_friction(&self, joint: &JointDescription) -> Option<Number> {
        let motor = joint.motor.as_ref().filter(|motor| motor.coupling.is_none())?;
        let ratio = self.number(&motor.ratio);
        let friction = &(&ratio * &ratio) * &self.number(&motor.viscous);
        (!friction.is_zero()).then_some(friction)
    }

    fn body(&mut self, body: &BodyDescription) -> Body {
        let mass = self.value(&body.mass);
        let com = body.com.as_ref().map_or_else(zeros, |com| com.value.each_ref().map(|x| self.value(x)));
        let elements = body.inertia.as_ref().map(|inertia| inertia.elements.each_ref().map(|x| self.value(x)));
        let rotation = body.inertia.as_ref().and_then(|inertia| inertia.rotation.as_ref());
        let rpy = rotation.map_or_else(zeros, |rotation| self.rotation(rotation));
        Body { origin: Pose { xyz: com, rpy }, mass, inertia: elements.unwrap_or_else(zeros) }
    }

    fn poses(&mut self, pose: Option<&PoseDescription>) -> Vec<Pose> {
        let elements = pose.map_or(&[][..], |pose| &pose.elements);
        let mut poses = Vec::new();
        for element in elements {
            let xyz = element.xyz.as_ref().map_or_else(zeros, |xyz| xyz.value.each_ref().map(|x| self.value(x)));
            let rpy = element.rotation.as_ref().map_or_else(zeros, |rotation| self.rotation(rotation));
            poses.push(Pose { xyz, rpy });
        }
        poses
    }

    /// Angles about x, y, z.
    fn rotation(&mut self, rotation: &RotationDescription) -> [String; 3] {
        if let RotationDescription::Rpy(angles) = rotation {
            return angles.value.each_ref().map(|angle| self.angle(angle));
        }
        self.rounded += 3;
        let float = |value: &Value| value.as_ref().and_then(|e| self.values.of(e)).map_or(0.0, |number| number.to_f64());
        let written = |value: &Value| crate::written::Written { value: float(value), ..crate::written::Written::zero() };
        let turn = match rotation {
            RotationDescription::Rpy(angles) => crate::pose::Turn::Rpy(angles.value.each_ref().map(written)),
            RotationDescription::Quat(quat) => crate::pose::Turn::Quat(quat.value.each_ref().map(written), 0.0),
            RotationDescription::XyAxes(axes) => crate::pose::Turn::XyAxes(axes.value.each_ref().map(written), 0.0),
            RotationDescription::AxisAngle(axis, angle) => crate::pose::Turn::AxisAngle(crate::pose::AxisAngle {
                axis: axis.value.each_ref().map(written),
                axis_offset: 0.0,
                angle: written(&Some(angle.clone())),
            }),
        };
        let m = turn.matrix();
        let level = m[0][0].hypot(m[1][0]);
        let pitch = (-m[2][0]).atan2(level);
        // Where x points up or down only the sum or difference of roll and yaw counts.
        let (roll, yaw) = match level > 1e-9 {
            true => (m[2][1].atan2(m[2][2]), m[1][0].atan2(m[0][0])),
            false => (0.0, (-m[0][1]).atan2(m[1][1])),
        };
        [roll, pitch, yaw].map(|angle| if angle.abs() < 1e-15 { "0".to_owned() } else { format!("{angle:?}") })
    }

    /// A number, 0 where none is given.
    fn value(&mut self, value: &Value) -> String {
        value.as_ref().map_or_else(|| "0".to_owned(), |expression| self.decimal(expression))
    }

    fn angle(&mut self, value: &Value) -> String {
        let Some(expression) = value else { return "0".to_owned() };
        let twelfths = self.values.of(expression).and_then(|number| number.checked_div(&Number::pi()));
        let twelfths = twelfths.and_then(|number| Some(number.as_rational()? * Rational::from(12)));
        match twelfths.filter(|twelfths| twelfths.is_int() && !twelfths.is_zero()) {
            // Import takes it for what it means.
            Some(_) => format!("{:?}", self.float(expression)),
            None => self.decimal(expression),
        }
    }

    fn float(&self, expression: &Expression) -> f64 {
        self.values.of(expression).map_or(0.0, |number| number.to_f64())
    }

    /// Its digits; otherwise the digits of its value if they end, or the nearest float.
    fn decimal(&mut self, expression: &Expression) -> String {
        let word = self.source.slice(expression.span);
        let digits = decimal(word, expression.span, "a number", &mut Diagnostics::new());
        if let Some(digits) = digits.filter(|_| expression.is_decimal()) {
            return digits.text;
        }
        self.written(&self.values.of(expression).unwrap_or_else(Number::zero))
    }

    /// The value of a number, 0 where none is given.
    fn number(&self, value: &Value) -> Number {
        value.as_ref().and_then(|expression| self.values.of(expression)).unwrap_or_else(Number::zero)
    }

    /// The digits of a value if they end; otherwise the nearest float.
    fn written(&mut self, value: &Number) -> String {
        if let Some(text) = value.as_rational().and_then(ending) {
            return text;
        }
        self.rounded += 1;
        format!("{:?}", value.to_f64())
    }

    fn say_what_is_left_out(&mut self, description: &RobotDescription, joints: &[JointDescription]) {
        let mut lines = Vec::new();
        let mut joints_with = |what: &str, has: &dyn Fn(&JointDescription) -> bool| {
            let with = joints.iter().filter(|joint| has(joint));
            let names: Vec<String> = with.filter_map(|joint| Some(format!("`{}`", joint.name.as_ref()?.value))).collect();
            if !names.is_empty() {
                lines.push(format!("{what}: {}", names.join(", ")));
            }
        };
        // Zeros are kept.
        let is_some = |value: &Value| !self.number(value).is_zero();
        let of_motor = |joint: &JointDescription, value: fn(&MotorDescription) -> &Value| {
            joint.motor.as_ref().is_some_and(|motor| is_some(value(motor)))
        };
        joints_with("a URDF has no rotors; left out at", &|joint| {
            of_motor(joint, |motor| &motor.inertia) || of_motor(joint, |motor| &motor.mass)
        });
        joints_with("the viscous friction of rotors, times ratio², is part of `damping` at", &|joint| {
            self.rotor_friction(joint).is_some()
        });
        joints_with(
            "a URDF has no motors that turn with several joints; the friction of their rotors is left out at",
            &|joint| joint.motor.as_ref().is_some_and(|motor| motor.coupling.is_some()),
        );
        let masses = joints.iter().filter_map(|joint| Some(self.number(&joint.motor.as_ref()?.mass)));
        let mass = masses.fold(Number::zero(), |sum, mass| &sum + &mass);
        let mass = mass.as_rational().and_then(ending).unwrap_or_else(|| mass.to_f64().to_string());
        joints_with(&format!("the masses of rotors, {mass} kg in all, are not in the masses of the URDF"), &|joint| {
            of_motor(joint, |motor| &motor.mass)
        });
        joints_with("a URDF has no armature; left out at", &|joint| is_some(&joint.armature));
        joints_with("a URDF has no springs; left out at", &|joint| {
            joint.spring.as_ref().is_some_and(|spring| is_some(&spring.stiffness))
        });
        let beyond = |(key, _): &(&str, &Value)| !["viscous", "coulomb"].contains(key);
        let none = FrictionDescription::default();
        let keys = none.numbers().into_iter().filter(beyond).map(|(key, _)| format!("`{key}`"));
        let keys = keys.collect::<Vec<String>>().join(", ");
        joints_with(&format!("a URDF's friction has no {keys} and `stribeck`; left out at"), &|joint| {
            let stribeck = joint.friction.stribeck.as_ref().is_some_and(|stribeck| is_some(&stribeck.torque));
            stribeck || joint.friction.numbers().into_iter().filter(beyond).any(|(_, value)| is_some(value))
        });
        joints_with(
            "the file follows URDF 1.2, which programs before 2026 refuse, for limits of acceleration and jerk at",
            &|joint| joint.limits.acceleration.is_some() || joint.limits.jerk.is_some(),
        );
        joints_with("a URDF has no gains of motors; left out at", &|joint| {
            joint.motor.as_ref().is_some_and(|motor| motor.gain.is_some())
        });
        joints_with("a URDF demands `effort` and `velocity`; 0 stands for one that is not given at", &|joint| {
            let prismatic = joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Prismatic);
            let limits = &joint.limits;
            let numbers = [&limits.velocity, &limits.effort, &limits.acceleration, &limits.jerk];
            let any = limits.position.is_some() || numbers.into_iter().any(Option::is_some);
            (any || prismatic) && (joint.limits.velocity.is_none() || joint.limits.effort.is_none())
        });
        // Every key, so that none is left out unsaid; the first ones are written.
        let RobotDescription {
            name: _,
            convention: _,
            gravity,
            gravity_is_argument,
            units: _,
            products: _,
            parameters,
            joints: _,
            base: _,
            tip: _,
            tool: _,
            payload,
            task,
            regressor,
            inverse_kinematics: PosturesDescription { target, given },
            tips,
            closes,
            allow,
        } = description;
        let several =
            |joint: &JointDescription| joint.adds.is_some() || joint.follows.as_ref().is_some_and(|of| of.leaders.len() > 1);
        let coupled = joints.iter().any(several);
        let asked = |target: &Option<Spanned<Target>>, given: &Option<Spanned<String>>| target.is_some() || given.is_some();
        let tips = || tips.iter().flat_map(|tips| &tips.value);
        let gravity = gravity.as_ref().map(|gravity| gravity.value.each_ref().map(|x| self.value(x)));
        if let Some(gravity) = gravity.filter(|gravity| *gravity != ["0", "0", "-9.81"].map(str::to_owned)) {
            lines.push(format!("a URDF has no gravity; who reads it takes 0 0 -9.81, not {}", gravity.join(" ")));
        }
        for (what, given) in [
            ("the payload", payload.is_some() || tips().any(|tip| tip.payload.is_some())),
            ("gravity as an argument, whose nominal value is taken", *gravity_is_argument),
            (
                "the coupling of joints with several others, and `adds`, which a URDF cannot hold: these joints move freely; \
                 `joint_variables` of a generated module has their values",
                coupled,
            ),
            ("`task`", task.is_some() || tips().any(|tip| tip.task.is_some())),
            ("`regressor`", regressor.as_ref().is_some_and(|r| !matches!(r.value, RegressorDescription::Standard))),
            (
                "`inverse_kinematics`",
                asked(target, given) || tips().any(|tip| asked(&tip.inverse_kinematics.target, &tip.inverse_kinematics.given)),
            ),
            ("`closes`, for a URDF has no loops: these stay closed where a program keeps every coupling", !closes.is_empty()),
            ("`allow`", !allow.is_empty()),
            ("the names under `parameters`, whose values are written", !parameters.is_empty()),
        ] {
            if given {
                lines.push(format!("left out: {what}"));
            }
        }
        if self.rounded > 0 {
            lines.push(format!("{} numbers are rounded to the nearest float: no decimals end with their value", self.rounded));
        }
        self.lines = lines;
    }
}
