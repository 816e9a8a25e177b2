//! Names of parameters in what says where something is.

use armgen_codegen::description::{JointDescription, PoseDescription, PoseElement, RotationDescription, Value};

/// In numbers.
pub(super) fn of_values<'d>(values: impl IntoIterator<Item = &'d Value>) -> Vec<&'d str> {
    values.into_iter().flatten().flat_map(|expression| expression.names()).collect()
}

/// In the poses of a list.
pub(super) fn of_pose(pose: Option<&PoseDescription>) -> Vec<&str> {
    pose.map_or(&[][..], |pose| &pose.elements).iter().flat_map(of_element).collect()
}

fn of_element(element: &PoseElement) -> Vec<&str> {
    let mut names = of_values(element.xyz.iter().flat_map(|xyz| &xyz.value));
    names.extend(match &element.rotation {
        None => Vec::new(),
        Some(RotationDescription::Rpy(rpy)) => of_values(&rpy.value),
        Some(RotationDescription::Quat(quat)) => of_values(&quat.value),
        Some(RotationDescription::AxisAngle(axis, angle)) => [of_values(&axis.value), angle.names()].concat(),
        Some(RotationDescription::XyAxes(axes)) => of_values(&axes.value),
    });
    names
}

/// In the row of a joint.
pub(super) fn of_row(joint: &JointDescription) -> Vec<&str> {
    let mut names = of_values([&joint.a, &joint.alpha, &joint.d, &joint.theta]);
    names.extend([&joint.mount, &joint.origin].into_iter().flat_map(|pose| of_pose(pose.as_ref())));
    names.extend(of_values(joint.axis.iter().flat_map(|axis| &axis.value)));
    names
}
