//! Every value of a description, with its role and its dimension: one table for names, units and plausibility.

use super::{BodyDescription, PoseDescription, RobotDescription, RotationDescription, Value};
use crate::document::Expression;
use crate::kinds::JointKind;
use crate::source::Spanned;

/// The quantity whose value an expression gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Another parameter.
    Parameter,
    /// Acceleration of gravity.
    Gravity,
    /// A length: a, d, the xyz of a pose.
    Length,
    /// An angle: alpha, theta, an angle of a rotation.
    Angle,
    /// A mass.
    Mass,
    /// A centre of mass.
    CentreOfMass,
    /// An element of an inertia tensor.
    Inertia,
    /// The factor of a joint that another one follows.
    Factor,
    /// The constant that is added to followed variables.
    Offset,
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
    /// The velocity of smooth friction.
    SmoothVelocity,
    /// The stiffness of a spring.
    Stiffness,
    /// Where a spring is at rest.
    SpringRest,
    /// An armature.
    Armature,
    /// The torque of a drive per unit of current.
    Gain,
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
            Role::Factor => "the factor of a followed joint",
            Role::Offset => "the offset of a joint variable",
            Role::Limit => "a limit",
            Role::Ratio => "a gear ratio",
            Role::RotorInertia => "a rotor inertia",
            Role::RotorMass => "a rotor mass",
            Role::RotorPosition => "the position of a rotor",
            Role::Axis => "the direction of an axis",
            Role::Friction => "a friction coefficient",
            Role::LoadFriction => "the load friction of a joint",
            Role::StribeckVelocity => "the velocity of Stribeck friction",
            Role::SmoothVelocity => "the velocity of smooth friction",
            Role::Stiffness => "the stiffness of a spring",
            Role::SpringRest => "the rest of a spring",
            Role::Armature => "an armature",
            Role::Gain => "the gain of a motor",
        }
    }
}

/// The dimension of a value, as far as `units` names a unit for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dimension {
    /// A ratio, a direction, and gravity, which is in m/s² in every file.
    Fixed,
    /// m.
    Length,
    /// rad.
    Angle,
    /// kg.
    Mass,
    /// A moment of inertia of a body, kg m².
    Inertia,
    /// A product of inertia, kg m²: `products` decides its sign.
    ProductOfInertia,
    /// The inertia of a rotor before the gear, and the armature of a joint that turns, kg m².
    RotorInertia,
    /// The rate of a joint that slides, m/s.
    Velocity,
    /// The rate of a joint that turns, rad/s.
    AngularVelocity,
    /// N, and with it what is one per m/s, per (m/s)³ and per m.
    Force,
    /// N m, and with it what is one per rad/s, per (rad/s)³ and per rad.
    Torque,
}

/// Both walks over the values of a description, in the order of its keys: of references, and of references that may change them.
macro_rules! walk {
    ($walk:ident, $values:ident, $one:ident, $three:ident, $body:ident, $pose:ident, $rotation:ident $(, $mutable:tt)?) => {
        fn $one<'d>(to: &mut impl FnMut(Role, Dimension, &'d $($mutable)? Expression), role: Role, dimension: Dimension, value: &'d $($mutable)? Value) {
            if let Some(expression) = value {
                to(role, dimension, expression);
            }
        }

        fn $three<'d, const N: usize>(
            to: &mut impl FnMut(Role, Dimension, &'d $($mutable)? Expression),
            role: Role,
            dimension: Dimension,
            list: &'d $($mutable)? Option<Spanned<[Value; N]>>,
        ) {
            if let Some(list) = list {
                for value in & $($mutable)? list.value {
                    $one(to, role, dimension, value);
                }
            }
        }

        fn $rotation<'d>(to: &mut impl FnMut(Role, Dimension, &'d $($mutable)? Expression), rotation: &'d $($mutable)? RotationDescription) {
            match rotation {
                RotationDescription::Rpy(angles) => {
                    for angle in & $($mutable)? angles.value {
                        $one(to, Role::Angle, Dimension::Angle, angle);
                    }
                }
                RotationDescription::Quat(quaternion) => {
                    for value in & $($mutable)? quaternion.value {
                        $one(to, Role::Axis, Dimension::Fixed, value);
                    }
                }
                RotationDescription::XyAxes(axes) => {
                    for value in & $($mutable)? axes.value {
                        $one(to, Role::Axis, Dimension::Fixed, value);
                    }
                }
                RotationDescription::AxisAngle(axis, angle) => {
                    for value in & $($mutable)? axis.value {
                        $one(to, Role::Axis, Dimension::Fixed, value);
                    }
                    to(Role::Angle, Dimension::Angle, angle);
                }
            }
        }

        fn $pose<'d>(to: &mut impl FnMut(Role, Dimension, &'d $($mutable)? Expression), pose: &'d $($mutable)? Option<PoseDescription>) {
            let Some(pose) = pose else { return };
            for element in & $($mutable)? pose.elements {
                $three(to, Role::Length, Dimension::Length, & $($mutable)? element.xyz);
                if let Some(rotation) = & $($mutable)? element.rotation {
                    $rotation(to, rotation);
                }
            }
        }

        fn $body<'d>(to: &mut impl FnMut(Role, Dimension, &'d $($mutable)? Expression), body: &'d $($mutable)? BodyDescription) {
            $one(to, Role::Mass, Dimension::Mass, & $($mutable)? body.mass);
            $three(to, Role::CentreOfMass, Dimension::Length, & $($mutable)? body.com);
            if let Some(inertia) = & $($mutable)? body.inertia {
                let [xx, xy, yy, xz, yz, zz] = & $($mutable)? inertia.elements;
                let (moment, product) = (Dimension::Inertia, Dimension::ProductOfInertia);
                for (dimension, value) in [(moment, xx), (product, xy), (moment, yy), (product, xz), (product, yz), (moment, zz)] {
                    $one(to, Role::Inertia, dimension, value);
                }
                if let Some(rotation) = & $($mutable)? inertia.rotation {
                    $rotation(to, rotation);
                }
            }
            for attached in & $($mutable)? body.attached {
                $pose(to, & $($mutable)? attached.origin);
                $body(to, & $($mutable)? attached.body);
            }
        }

        fn $walk<'d>(description: &'d $($mutable)? RobotDescription, mut to: impl FnMut(Role, Dimension, &'d $($mutable)? Expression)) {
            use Dimension::{Angle, AngularVelocity, Fixed, Force, Length, Mass, RotorInertia, Torque, Velocity};
            let to = &mut to;
            $three(to, Role::Gravity, Fixed, & $($mutable)? description.gravity);
            $pose(to, & $($mutable)? description.base);
            if let Some(joints) = & $($mutable)? description.joints {
                for joint in & $($mutable)? joints.value {
                    let slides = joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Prismatic);
                    let [position, rate, effort, armature] =
                        if slides { [Length, Velocity, Force, Mass] } else { [Angle, AngularVelocity, Torque, RotorInertia] };
                    $pose(to, & $($mutable)? joint.mount);
                    for leaders in [& $($mutable)? joint.follows, & $($mutable)? joint.adds].into_iter().flatten() {
                        for (_, factor) in & $($mutable)? leaders.leaders {
                            $one(to, Role::Factor, Fixed, factor);
                        }
                    }
                    $one(to, Role::Offset, position, & $($mutable)? joint.offset);
                    $one(to, Role::Length, Length, & $($mutable)? joint.a);
                    $one(to, Role::Angle, Angle, & $($mutable)? joint.alpha);
                    $one(to, Role::Length, Length, & $($mutable)? joint.d);
                    $one(to, Role::Angle, Angle, & $($mutable)? joint.theta);
                    $pose(to, & $($mutable)? joint.origin);
                    $three(to, Role::Axis, Fixed, & $($mutable)? joint.axis);
                    $three(to, Role::Limit, position, & $($mutable)? joint.limits.position);
                    $one(to, Role::Limit, rate, & $($mutable)? joint.limits.velocity);
                    $one(to, Role::Limit, Fixed, & $($mutable)? joint.limits.acceleration);
                    $one(to, Role::Limit, Fixed, & $($mutable)? joint.limits.jerk);
                    $one(to, Role::Limit, effort, & $($mutable)? joint.limits.effort);
                    if let Some(link) = & $($mutable)? joint.link {
                        $body(to, link);
                    }
                    if let Some(motor) = & $($mutable)? joint.motor {
                        $one(to, Role::Ratio, Fixed, & $($mutable)? motor.ratio);
                        if let Some(coupling) = & $($mutable)? motor.coupling {
                            for (_, factor) in & $($mutable)? coupling.leaders {
                                $one(to, Role::Factor, Fixed, factor);
                            }
                        }
                        $one(to, Role::RotorInertia, RotorInertia, & $($mutable)? motor.inertia);
                        $one(to, Role::RotorMass, Mass, & $($mutable)? motor.mass);
                        $three(to, Role::RotorPosition, Length, & $($mutable)? motor.position);
                        $three(to, Role::Axis, Fixed, & $($mutable)? motor.axis);
                        // The rotor turns, whatever the joint does.
                        $one(to, Role::Friction, Torque, & $($mutable)? motor.viscous);
                        $one(to, Role::Gain, Fixed, & $($mutable)? motor.gain);
                    }
                    $one(to, Role::Friction, effort, & $($mutable)? joint.friction.viscous);
                    $one(to, Role::Friction, effort, & $($mutable)? joint.friction.coulomb);
                    $one(to, Role::SmoothVelocity, rate, & $($mutable)? joint.friction.smooth);
                    $one(to, Role::Friction, effort, & $($mutable)? joint.friction.offset);
                    $one(to, Role::Friction, effort, & $($mutable)? joint.friction.cubic);
                    $one(to, Role::LoadFriction, Fixed, & $($mutable)? joint.friction.load);
                    if let Some(stribeck) = & $($mutable)? joint.friction.stribeck {
                        $one(to, Role::Friction, effort, & $($mutable)? stribeck.torque);
                        $one(to, Role::StribeckVelocity, rate, & $($mutable)? stribeck.velocity);
                    }
                    if let Some(spring) = & $($mutable)? joint.spring {
                        $one(to, Role::Stiffness, effort, & $($mutable)? spring.stiffness);
                        $one(to, Role::SpringRest, position, & $($mutable)? spring.rest);
                    }
                    $one(to, Role::Armature, armature, & $($mutable)? joint.armature);
                }
            }
            $pose(to, & $($mutable)? description.tool);
            if let Some(payload) = & $($mutable)? description.payload {
                $body(to, payload);
            }
            if let Some(tips) = & $($mutable)? description.tips {
                for tip in & $($mutable)? tips.value {
                    $pose(to, & $($mutable)? tip.tool);
                    if let Some(payload) = & $($mutable)? tip.payload {
                        $body(to, payload);
                    }
                }
            }
            for closure in & $($mutable)? description.closes {
                $three(to, Role::Length, Length, & $($mutable)? closure.at);
                $three(to, Role::Length, Length, & $($mutable)? closure.there);
            }
        }

        impl RobotDescription {
            /// Hands over every expression outside `parameters`, in the order of the file's keys.
            pub(crate) fn $values<'d>(&'d $($mutable)? self, to: impl FnMut(Role, Dimension, &'d $($mutable)? Expression)) {
                $walk(self, to);
            }
        }
    };
}

walk!(walk, each_value, value_of, values_of_list, values_of_body, values_of_pose, values_of_rotation);
walk!(
    walk_mut,
    each_value_mut,
    value_of_mut,
    values_of_list_mut,
    values_of_body_mut,
    values_of_pose_mut,
    values_of_rotation_mut,
    mut
);
