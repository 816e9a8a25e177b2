//! Manipulability at postures: pose, w, and the ellipsoids of the translation in a plane.

use armgen_generated::Nominal;
use armgen_runtime::manipulability::{
    condition_number, distance_to_singularity, force_ellipsoid, manipulability, velocity_ellipsoid, Ellipsoid,
};
use armgen_runtime::reference::Pose;
use armgen_runtime::robot::Kinematics;
use armgen_runtime::task::{Row, Task};

use super::file::{task, Joints, Postures};
use super::reader::row_name;
use super::record::Record;

/// The ellipsoids of velocity and force in the plane of two rows; no force ellipsoid at a singular posture.
pub(crate) fn ellipses(plane: [Row; 2], q: &Joints) -> (Ellipsoid<f64, 2>, Option<Ellipsoid<f64, 2>>) {
    let j = Task::new(plane).map(|task| task.jacobian(&Nominal.geometric_jacobian(q)));
    let j = j.expect("the file has been checked: no row stands twice");
    (velocity_ellipsoid(&j), force_ellipsoid(&j))
}

/// Manipulability of the whole task.
pub(crate) fn w(q: &Joints) -> f64 {
    manipulability(&task().jacobian(&Nominal.geometric_jacobian(q)))
}

const NAMES: [&str; 10] =
    ["w", "heading", "velocity_1", "velocity_2", "direction_1", "direction_2", "force_1", "force_2", "condition", "distance"];

/// The numbers of each posture: `NAME.w` and so on.
pub(crate) fn singles(postures: &Postures) -> Vec<String> {
    let of = |name: &String| ["x", "y", "z"].iter().chain(&NAMES).map(|what| format!("{name}.{what}")).collect::<Vec<_>>();
    postures.list.iter().flat_map(|(name, _)| of(name)).collect()
}

/// Direction of a column, deg, in (-90, 90]: an axis has no sign.
pub(crate) fn degrees(ellipsoid: &Ellipsoid<f64, 2>, i: usize) -> f64 {
    let d = ellipsoid.directions[(1, i)].atan2(ellipsoid.directions[(0, i)]).to_degrees().rem_euclid(180.0);
    if d > 90.0 {
        d - 180.0
    } else {
        d
    }
}

/// Judges the postures.
pub(crate) fn run(postures: &Postures) -> Record {
    let mut values = Vec::new();
    for (_, q) in &postures.list {
        let pose = Pose::of(&Nominal, q);
        let (v, f) = ellipses(postures.plane, q);
        let plane = Task::new(postures.plane).map(|task| task.jacobian(&Nominal.geometric_jacobian(q)));
        let plane = plane.expect("the file has been checked: no row stands twice");
        let [a, b] = postures.plane.map(Row::index);
        let force = |i: usize| f.map_or(f64::INFINITY, |f| f.semi_axes[i]);
        values.extend([pose.position.x, pose.position.y, pose.position.z]);
        // The angle of the end effector's y axis in the plane.
        values.extend([w(q), pose.rotation[(b, 1)].atan2(pose.rotation[(a, 1)])]);
        values.extend([v.semi_axes[0], v.semi_axes[1], degrees(&v, 0), degrees(&v, 1), force(0), force(1)]);
        values.extend([condition_number(&plane).unwrap_or(f64::INFINITY), distance_to_singularity(&plane)]);
    }
    Record { singles: singles(postures).into_iter().zip(values).collect(), ..Record::default() }
}

/// The name of the plane, for titles.
pub(crate) fn plane_name(plane: [Row; 2]) -> String {
    plane.map(row_name).concat()
}
