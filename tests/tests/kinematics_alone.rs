//! An arm without any mass or inertia: its module has frames, Jacobians and their rates, and the matching trait.

use armgen_codegen::source::Source;
use armgen_codegen::{generate, Options};
use armgen_runtime::nalgebra::{SMatrix, Vector3};
use armgen_runtime::robot::{Kinematics, LinkJacobians};

#[allow(unreachable_pub, clippy::all, clippy::pedantic)]
mod robot {
    include!(concat!(env!("OUT_DIR"), "/kinematics_alone.rs"));
    include!(concat!(env!("OUT_DIR"), "/kinematics_alone_runtime.rs"));
}

const STATE: [f64; 3] = [0.7, -1.1, 0.25];
const RATES: [f64; 3] = [0.3, 1.2, -0.4];

#[test]
fn the_jacobian_is_the_rate_of_the_frames() {
    let (q, dq) = (Vector3::from(STATE), Vector3::from(RATES));
    let arm = robot::Nominal;
    let h = 1e-6;
    let differences = (arm.direct_kinematics(&(q + dq * h)) - arm.direct_kinematics(&(q - dq * h))) / (2.0 * h);
    let frame = arm.direct_kinematics(&q);
    let twist = arm.geometric_jacobian(&q) * dq;
    let linear = differences.fixed_view::<3, 1>(0, 3) - twist.fixed_view::<3, 1>(0, 0);
    let omega = Vector3::new(twist[3], twist[4], twist[5]);
    let angular = differences.fixed_view::<3, 3>(0, 0) - omega.cross_matrix() * frame.fixed_view::<3, 3>(0, 0);
    assert!(linear.amax() < 1e-9 && angular.amax() < 1e-9, "{linear}{angular}");
    let rate: SMatrix<f64, 6, 3> = (arm.geometric_jacobian(&(q + dq * h)) - arm.geometric_jacobian(&(q - dq * h))) / (2.0 * h);
    assert!((rate - arm.geometric_jacobian_dot(&q, &dq)).amax() < 1e-9);
    assert_eq!(arm.link_jacobians(&q)[2].fixed_rows::<3>(3), arm.geometric_jacobian(&q).fixed_rows::<3>(3));
}

#[test]
fn what_is_not_there_is_named() {
    let text = include_str!("../data/kinematics_alone.yaml");
    let generated = generate(&Source::new("kinematics_alone.yaml", text), &Options::default()).0.expect("a valid arm");
    let functions: Vec<&str> =
        generated.module.lines().filter_map(|line| line.strip_prefix("pub fn ")?.split('(').next()).collect();
    assert_eq!(functions, ["direct_kinematics", "link_frames", "geometric_jacobian", "geometric_jacobian_dot", "link_jacobians"]);
    assert!(generated.absent.iter().any(|absent| absent.function == "inertia_matrix"));
    assert!(generated.runtime.contains("// `Dynamics` is not implemented: the module has no inertia_matrix,"));
}
