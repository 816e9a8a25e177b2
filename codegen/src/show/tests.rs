//! What is shown of small arms, in each notation.

use super::*;
use crate::manipulator;
use crate::source::Source;

const PENDULUM: &str = "
name: pendulum
convention: standard
gravity: [0, -9.81, 0]
parameters: {m: 2, l: 1/2}
joints:
  - name: pivot
    type: revolute
    a: l
    alpha: 0
    d: 0
    theta: 0
    link: {mass: m, inertia: {zz: 0.01}}
regressor: [m]
";

fn sheet(text: &str, names: &[&str], reading: Reading) -> Sheet {
    let (valid, diagnostics) = manipulator::read(&Source::new("test.yaml", text));
    assert!(!diagnostics.has_errors(), "{:?}", diagnostics.iter().map(|d| &d.message).collect::<Vec<_>>());
    let model = Model::new(valid.expect("valid").0);
    let items: Vec<Item> = names.iter().flat_map(|name| Item::named(name, model.manipulator.dof())).collect();
    assert!(names.is_empty() || !items.is_empty());
    Sheet::new(&model, if names.is_empty() { Item::all() } else { items }.as_slice(), reading)
}

#[track_caller]
fn check(names: &[&str], reading: Reading, expected: &str) {
    assert_eq!(sheet(PENDULUM, names, reading).text().trim_end(), expected.trim());
}

#[test]
fn numbers_or_names() {
    check(&["inertia_matrix"], Reading::Nominal, "inertia_matrix: B(q)\n  b = 51/100");
    check(&["inertia_matrix"], Reading::Symbolic, "inertia_matrix: B(q)\n  b = 1/100 + m*l^2");
    check(&["gravity"], Reading::Symbolic, "gravity: g(q)\n  g = 981/100*cos(q1)*m*l");
    check(&["regressor"], Reading::Nominal, "regressor: Y(q, dq, dqr, ddqr)\n  y[1, m] = 981/200*cos(q1) + 1/4*ddqr1");
    check(&["regressor"], Reading::Symbolic, "regressor: Y(q, dq, dqr, ddqr)\n  y[1, m] = 981/100*cos(q1)*l + l^2*ddqr1");
    check(&["known_torque"], Reading::Symbolic, "known_torque: tau_known(q, dq, dqr, ddqr)\n  tau_known = 1/100*ddqr1");
    check(&["gravity_with"], Reading::Nominal, "gravity_with: g(q)\n  g = 981/200*cos(q1)*m");
}
