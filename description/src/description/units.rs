//! `units` and `products`: plain numbers in the units of a data sheet, and products of inertia with the sign of a CAD program, brought to SI units and to
//! elements of the tensor, exactly.
//!
//! | key of `units` | values in it | where it is not named |
//! |---|---|---|
//! | `length` | `a`, `d`, `xyz`, `com`, `position` of a motor, `position` and `rest` of a joint that slides | m |
//! | `angle` | `alpha`, `theta`, `rpy`, `angle`, `position` and `rest` of a joint that turns | rad |
//! | `mass` | `mass`, `armature` of a joint that slides | kg |
//! | `inertia` | the elements of `inertia` of a body | kg m² |
//! | `rotor_inertia` | `inertia` of a motor, `armature` of a joint that turns | kg m² |
//! | `velocity`, `angular_velocity` | both keys `velocity`, of a joint that slides and of one that turns | `length`, `angle` per second |
//! | `force`, `torque` | `effort`, and `viscous`, `coulomb`, `offset`, `cubic`, `torque`, `stiffness`: per m and s, and per rad and s | N, N m |
//!
//! A whole expression is in the unit, the values of its names included. Angles and their rates are in radians if they contain `pi` or `deg(...)`.

use std::collections::BTreeMap;

use super::values::Dimension;
use super::{Products, RobotDescription};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::document::{Expression, ExpressionKind, Operator, Unit};
use crate::exact::Rational;

/// A key of `units`: its dimensions, their SI unit, and units as examples.
pub(super) struct UnitKey {
    pub(super) name: &'static str,
    dimensions: &'static [Dimension],
    pub(super) si: &'static str,
    pub(super) examples: &'static str,
}

const fn key(name: &'static str, dimensions: &'static [Dimension], si: &'static str, examples: &'static str) -> UnitKey {
    UnitKey { name, dimensions, si, examples }
}

const INERTIAS: &str = "kg m^2, kg cm^2, kg mm^2, g cm^2, g mm^2, lb in^2";

/// The keys of `units`.
pub(super) const KEYS: [UnitKey; 9] = [
    key("length", &[Dimension::Length], "m", "m, cm, mm, in, ft"),
    key("angle", &[Dimension::Angle], "rad", "rad, deg"),
    key("mass", &[Dimension::Mass], "kg", "kg, g, t, lb"),
    key("inertia", &[Dimension::Inertia, Dimension::ProductOfInertia], "kg m²", INERTIAS),
    key("rotor_inertia", &[Dimension::RotorInertia], "kg m²", INERTIAS),
    key("velocity", &[Dimension::Velocity], "m/s", "m/s, cm/s, mm/s"),
    key("angular_velocity", &[Dimension::AngularVelocity], "rad/s", "rad/s, deg/s, rpm"),
    key("force", &[Dimension::Force], "N", "N, mN, kN, kgf, lbf"),
    key("torque", &[Dimension::Torque], "N m", "N m, N mm, N cm, mN m, kgf cm, lbf in"),
];

/// The units of dimensions, those that are not SI units.
pub(super) fn of(description: &RobotDescription) -> BTreeMap<Dimension, Unit> {
    let mut units: BTreeMap<Dimension, Unit> = BTreeMap::new();
    for named in &description.units {
        let key = KEYS.iter().find(|key| key.name == named.key);
        units.extend(key.into_iter().flat_map(|key| key.dimensions).map(|dimension| (*dimension, named.unit.clone())));
    }
    for (rate, of) in [(Dimension::Velocity, Dimension::Length), (Dimension::AngularVelocity, Dimension::Angle)] {
        if let (false, Some(unit)) = (units.contains_key(&rate), units.get(&of).cloned()) {
            units.insert(rate, unit);
        }
    }
    if description.products.as_ref().is_some_and(|products| products.value == Products::Integral) {
        let one = Unit { factor: Rational::from(1), degrees: false };
        let unit = units.remove(&Dimension::ProductOfInertia).unwrap_or(one);
        units.insert(Dimension::ProductOfInertia, unit.negated());
    }
    units.retain(|_, unit| !unit.is_si());
    units
}

/// Puts every value of the description in its unit.
pub(super) fn apply(description: &mut RobotDescription, diagnostics: &mut Diagnostics) {
    let units = of(description);
    if units.is_empty() {
        return;
    }
    let mut names: BTreeMap<String, Angle> = BTreeMap::new();
    for parameter in &description.parameters {
        let angle = parameter.value.as_ref().map_or(Angle::Number, |value| angle(value, &names));
        names.insert(parameter.name.value.clone(), angle);
    }
    description.each_value_mut(|_, dimension, expression| {
        let Some(unit) = units.get(&dimension) else { return };
        if matches!(dimension, Dimension::Angle | Dimension::AngularVelocity) {
            match angle(expression, &names) {
                Angle::Zero | Angle::Number => {}
                Angle::Radians => return,
                Angle::Mixed => {
                    let message = "a number in the unit of the file is added to an angle in radians";
                    let help = "`pi` and `deg(...)` are in radians in every file, other numbers of an angle are as `units` says: write one of the two";
                    diagnostics.push(Diagnostic::new(Code::MixedUnits, expression.span, message, "two units", help));
                    return;
                }
            }
        }
        let place = expression.span;
        let bare = std::mem::replace(expression, Expression { kind: ExpressionKind::Pi, span: place });
        *expression = bare.in_unit(unit.clone());
    });
}

/// The kinds of angles that an expression can be.
#[derive(Clone, Copy, PartialEq)]
enum Angle {
    Zero,
    Number,
    Radians,
    Mixed,
}

fn angle(expression: &Expression, names: &BTreeMap<String, Angle>) -> Angle {
    match &expression.kind {
        ExpressionKind::Decimal(value) if value.is_zero() => Angle::Zero,
        ExpressionKind::Decimal(_) => Angle::Number,
        ExpressionKind::Pi | ExpressionKind::Degrees(_) => Angle::Radians,
        ExpressionKind::Name(name) => names.get(name.as_str()).copied().unwrap_or(Angle::Number),
        ExpressionKind::Negate(a) | ExpressionKind::Root(a) | ExpressionKind::InUnit(a, _) => angle(a, names),
        ExpressionKind::Binary(operator, a, b) => match (angle(a, names), angle(b, names)) {
            (Angle::Mixed, _) | (_, Angle::Mixed) => Angle::Mixed,
            (Angle::Zero, other) | (other, Angle::Zero) if matches!(operator, Operator::Add | Operator::Subtract) => other,
            (a, b) if a == b => a,
            (Angle::Radians, _) | (_, Angle::Radians) if matches!(operator, Operator::Add | Operator::Subtract) => Angle::Mixed,
            (Angle::Radians, _) | (_, Angle::Radians) => Angle::Radians,
            _ => Angle::Number,
        },
    }
}
