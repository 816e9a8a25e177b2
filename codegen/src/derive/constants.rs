//! The exact constants of a description, and the field in which expressions of its arm have their fingerprints.

use super::passes;
use crate::exact::Number;
use crate::manipulator::{Joint, Manipulator};
use crate::ring::field::Field;

/// A field with the roots of a valid arm's constants, and with the sine and cosine of the angle that may turn its last link.
pub fn field_of(manipulator: &Manipulator) -> Field {
    let plain = find_field(manipulator).expect("validation refuses an arm without a field");
    // In coordinates the last link may turn with several of them, or with none.
    let turn = if manipulator.coupling.is_some() { None } else { passes::angle_of_last_link(&plain, manipulator) };
    turn.and_then(|turn| Field::with_turn(&constants(manipulator), turn)).unwrap_or(plain)
}

/// A field in which the constants of an arm have their roots: all of them, wherever the equations may meet them. `None` if their
/// different roots are too many for any field that is tried, which validation reports.
pub fn find_field(manipulator: &Manipulator) -> Option<Field> {
    Field::with_roots_of(&constants(manipulator))
}

/// All exact constants of a description.
fn constants(manipulator: &Manipulator) -> Vec<Number> {
    let mut numbers = Vec::new();
    let loads: Vec<_> = manipulator.loads().into_iter().map(|load| load.body).collect();
    for joint in &manipulator.joints {
        let tools = manipulator.ends().into_iter().map(|(_, tool)| &tool.frame);
        for placement in [&joint.placement, &joint.link_frame].into_iter().chain(tools) {
            numbers.extend(placement.rotation.iter().flatten().cloned());
            numbers.extend(placement.translation.iter().flat_map(|p| p.terms().map(|(_, c)| c.clone())));
        }
        for part in joint.link.iter().chain(loads.iter().copied()) {
            let body = &part.body;
            let all = std::iter::once(&body.mass).chain(&body.com).chain(&body.inertia);
            numbers.extend(all.flat_map(|p| p.terms().map(|(_, c)| c.clone())));
        }
        if let Some(motor) = &joint.motor {
            numbers.extend(motor.axis.iter().cloned());
            numbers.extend(motor.coupling.iter().map(|(_, factor)| factor.clone()));
            let all = motor.position.iter().chain([&motor.ratio, &motor.mass]).chain(&motor.inertia).chain(&motor.viscous);
            numbers.extend(all.flat_map(|p| p.terms().map(|(_, c)| c.clone())));
        }
        numbers.extend(
            joint
                .viscous
                .iter()
                .chain(&joint.coulomb)
                .chain(&joint.armature)
                .chain(&joint.offset)
                .chain(&joint.cubic)
                .chain(joint.stribeck.iter().map(|stribeck| &stribeck.torque))
                .chain(joint.spring.iter().flat_map(|spring| [&spring.stiffness, &spring.rest]))
                .flat_map(|p| p.terms().map(|(_, c)| c.clone())),
        );
    }
    numbers.extend(manipulator.joints.iter().filter_map(Joint::decay_velocity));
    numbers.extend(manipulator.joints.iter().filter_map(|joint| joint.load.clone()));
    for variable in manipulator.coupling.iter().flat_map(|coupling| &coupling.variables) {
        numbers.extend(
            variable
                .factors
                .iter()
                .map(|(_, factor)| factor)
                .chain([&variable.offset])
                .chain(variable.turn.iter().flatten())
                .cloned(),
        );
    }
    numbers.extend(manipulator.parameters.iter().map(|p| p.nominal.clone()));
    numbers.extend(manipulator.gravity.iter().flat_map(|p| p.terms().map(|(_, c)| c.clone())));
    numbers
}
