//! Where the parts of an arm stand in its file: what diagnostics about its equations point at.

use crate::description::{BodyDescription, PoseDescription, RegressorDescription, RobotDescription, RotationDescription, Value};
use crate::document::Expression;
use crate::source::{Span, Spanned};

/// Places of an arm's parts, in the order of the [`Manipulator`](crate::manipulator::Manipulator).
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// The robot's name.
    pub name: Span,
    /// The value of `gravity`.
    pub gravity: Span,
    /// Per joint.
    pub joints: Vec<JointPlaces>,
    /// The key `task`, where the file has one.
    pub task: Option<Span>,
    /// Its rows.
    pub task_rows: Vec<Span>,
    /// The key `regressor`, where the file has one.
    pub regressor: Option<Span>,
    /// The names that it lists, in its order.
    pub regressor_names: Vec<Span>,
    /// Definitions of the names that are symbols, by [`ParameterId`](crate::kinds::ParameterId).
    pub parameters: Vec<Span>,
    /// Where these names stand in expressions, abbreviations included, by [`ParameterId`](crate::kinds::ParameterId).
    pub uses: Vec<Vec<Occurrence>>,
}

/// Places of a joint's parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointPlaces {
    /// Its name.
    pub name: Span,
    /// The key `link`.
    pub link: Span,
    /// The link's mass.
    pub mass: Span,
    /// The key `motor`.
    pub motor: Option<Span>,
}

/// A place where a name enters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occurrence {
    /// The name.
    pub span: Span,
    /// What it is part of.
    pub role: Role,
}

/// What an expression gives the value of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Another parameter.
    Parameter,
    /// Acceleration of gravity.
    Gravity,
    /// A length: a, d, the xyz of a pose.
    Length,
    /// An angle: alpha, theta, those of a rotation.
    Angle,
    /// A mass.
    Mass,
    /// A centre of mass.
    CentreOfMass,
    /// An element of an inertia tensor.
    Inertia,
    /// A limit.
    Limit,
    /// A gear ratio.
    Ratio,
    /// The inertia of a rotor.
    RotorInertia,
    /// The mass of a rotor.
    RotorMass,
    /// The position of a rotor.
    RotorPosition,
    /// The direction of an axis, and what else a rotation is written with.
    Axis,
    /// A friction coefficient.
    Friction,
    /// How friction grows with the load of a joint.
    LoadFriction,
    /// The velocity at which Stribeck friction fades.
    StribeckVelocity,
    /// The stiffness of a spring.
    Stiffness,
    /// Where a spring is at rest.
    SpringRest,
    /// An armature.
    Armature,
}

impl Role {
    /// With its article, for a message: the name enters as ...
    pub fn text(self) -> &'static str {
        match self {
            Role::Parameter => "a part of another parameter",
            Role::Gravity => "the acceleration of gravity",
            Role::Length => "a length",
            Role::Angle => "an angle",
            Role::Mass => "a mass",
            Role::CentreOfMass => "a centre of mass",
            Role::Inertia => "an inertia",
            Role::Limit => "a limit",
            Role::Ratio => "a gear ratio",
            Role::RotorInertia => "a rotor inertia",
            Role::RotorMass => "a rotor mass",
            Role::RotorPosition => "the position of a rotor",
            Role::Axis => "the direction of an axis",
            Role::Friction => "a friction coefficient",
            Role::LoadFriction => "the load friction of a joint",
            Role::StribeckVelocity => "the velocity of Stribeck friction",
            Role::Stiffness => "the stiffness of a spring",
            Role::SpringRest => "the rest of a spring",
            Role::Armature => "an armature",
        }
    }
}

/// Every expression outside `parameters`, in the order of the file's keys.
pub(super) fn expressions(description: &RobotDescription) -> Vec<(Role, &Expression)> {
    let mut all = Gathered::default();
    all.vector(Role::Gravity, description.gravity.as_ref());
    all.pose(description.base.as_ref());
    for joint in description.joints.iter().flat_map(|joints| &joints.value) {
        all.value(Role::Length, &joint.a);
        all.value(Role::Angle, &joint.alpha);
        all.value(Role::Length, &joint.d);
        all.value(Role::Angle, &joint.theta);
        all.pose(joint.origin.as_ref());
        all.vector(Role::Axis, joint.axis.as_ref());
        all.vector(Role::Limit, joint.limits.position.as_ref());
        all.value(Role::Limit, &joint.limits.velocity);
        all.value(Role::Limit, &joint.limits.effort);
        all.body(joint.link.as_ref());
        if let Some(motor) = &joint.motor {
            all.value(Role::Ratio, &motor.ratio);
            all.value(Role::RotorInertia, &motor.inertia);
            all.value(Role::RotorMass, &motor.mass);
            all.vector(Role::RotorPosition, motor.position.as_ref());
            all.vector(Role::Axis, motor.axis.as_ref());
            all.value(Role::Friction, &motor.viscous);
        }
        all.value(Role::Friction, &joint.friction.viscous);
        all.value(Role::Friction, &joint.friction.coulomb);
        all.value(Role::Friction, &joint.friction.offset);
        all.value(Role::Friction, &joint.friction.cubic);
        all.value(Role::LoadFriction, &joint.friction.load);
        if let Some(stribeck) = &joint.friction.stribeck {
            all.value(Role::Friction, &stribeck.torque);
            all.value(Role::StribeckVelocity, &stribeck.velocity);
        }
        if let Some(spring) = &joint.spring {
            all.value(Role::Stiffness, &spring.stiffness);
            all.value(Role::SpringRest, &spring.rest);
        }
        all.value(Role::Armature, &joint.armature);
    }
    all.pose(description.tool.as_ref());
    all.body(description.payload.as_ref());
    all.list
}

#[derive(Default)]
struct Gathered<'d> {
    list: Vec<(Role, &'d Expression)>,
}

impl<'d> Gathered<'d> {
    fn value(&mut self, role: Role, value: &'d Value) {
        self.list.extend(value.iter().map(|v| (role, v)));
    }

    fn vector<const N: usize>(&mut self, role: Role, vector: Option<&'d Spanned<[Value; N]>>) {
        for value in vector.iter().flat_map(|v| &v.value) {
            self.value(role, value);
        }
    }

    fn body(&mut self, body: Option<&'d BodyDescription>) {
        let Some(body) = body else { return };
        self.value(Role::Mass, &body.mass);
        self.vector(Role::CentreOfMass, body.com.as_ref());
        for element in body.inertia.iter().flat_map(|i| &i.elements) {
            self.value(Role::Inertia, element);
        }
        self.rotation(body.inertia.as_ref().and_then(|i| i.rotation.as_ref()));
        for attached in &body.attached {
            self.pose(attached.origin.as_ref());
            self.body(Some(&attached.body));
        }
    }

    fn pose(&mut self, pose: Option<&'d PoseDescription>) {
        for element in pose.iter().flat_map(|pose| &pose.elements) {
            self.vector(Role::Length, element.xyz.as_ref());
            self.rotation(element.rotation.as_ref());
        }
    }

    fn rotation(&mut self, rotation: Option<&'d RotationDescription>) {
        match rotation {
            None => {}
            Some(RotationDescription::Rpy(angles)) => self.vector(Role::Angle, Some(angles)),
            Some(RotationDescription::Quat(quaternion)) => self.vector(Role::Axis, Some(quaternion)),
            Some(RotationDescription::XyAxes(axes)) => self.vector(Role::Axis, Some(axes)),
            Some(RotationDescription::AxisAngle(axis, angle)) => {
                self.vector(Role::Axis, Some(axis));
                self.list.push((Role::Angle, angle));
            }
        }
    }
}

/// The places of a valid description, whose names that stay symbols stand and are used at `symbols`.
pub(super) fn gather(description: &RobotDescription, symbols: Vec<(Span, Vec<Occurrence>)>) -> Places {
    let joints = description.joints.iter().flat_map(|joints| &joints.value);
    let (parameters, uses) = symbols.into_iter().unzip();
    Places {
        name: description.name.as_ref().map_or_else(Span::default, |n| n.span),
        gravity: description.gravity.as_ref().map_or_else(Span::default, |g| g.span),
        joints: joints
            .map(|joint| {
                let link = joint.link.as_ref();
                JointPlaces {
                    name: joint.name.as_ref().map_or(joint.span, |n| n.span),
                    link: link.map_or(joint.span, |l| l.key),
                    mass: link.and_then(|l| l.mass.as_ref()).map_or(joint.span, |m| m.span),
                    motor: joint.motor.as_ref().map(|m| m.key),
                }
            })
            .collect(),
        task: description.task.as_ref().map(|t| t.span),
        task_rows: description.task.iter().flat_map(|t| &t.value).map(|row| row.span).collect(),
        regressor: description.regressor.as_ref().map(|r| r.span),
        regressor_names: match description.regressor.as_ref().map(|r| &r.value) {
            Some(RegressorDescription::Names(names)) => names.iter().map(|n| n.span).collect(),
            _ => Vec::new(),
        },
        parameters,
        uses,
    }
}
