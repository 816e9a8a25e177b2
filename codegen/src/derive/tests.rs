//! Identities between the equations, exact in the prime field, for arms with everything in them.

use super::arm::Arm;
use super::constants::field_of;
use super::friction::friction;
use super::motion::Motion;
use super::newton_euler::{inverse_dynamics, newton_euler};
use super::parameters::{ParameterVector, View};
use super::plan::Plan;
use super::quantities::base_regressor::BASE_REGRESSOR;
use super::quantities::coriolis::CORIOLIS_MATRIX;
use super::quantities::first_moment::CENTER_OF_MASS;
use super::quantities::gravity::GRAVITY;
use super::quantities::inertia::INERTIA_MATRIX;
use super::quantities::inverse_dynamics::INVERSE_DYNAMICS;
use super::quantities::kinematics::DIRECT_KINEMATICS;
use super::quantities::operational_inertia::OPERATIONAL_INERTIA;
use super::quantities::regressor::{KNOWN_TORQUE, REGRESSOR};
use super::quantities::{
    coriolis, derivatives, first_moment, forward_dynamics, gravity, inertia, kinematics, kinetic_energy, momentum,
    operational_inertia,
};
use super::quantity::DerivationInput;
use super::*;
use crate::catalogue;
use crate::manipulator::Manipulator;
use crate::ring::{ExprId, Pool, Symbol};
use crate::source::Source;

/// Two tilted arms that hold everything a description can: both joint types, both conventions, tool, payload, rotors with mass and tilted axes,
/// friction, general angles.
const STANDARD: &str = "
name: everything
convention: standard
gravity: [1, -2, -9.81]
parameters: {m1: 3, l: 0.3, Im: 0.01}
joints:
  - {name: a, type: revolute, a: 0.2, alpha: pi/2, d: 0.1, theta: 0.7,
     link: {mass: m1, com: [0.1, 0.2, -0.1], inertia: {xx: 0.2, yy: 0.3, zz: 0.35, xy: 0.01, xz: -0.02, yz: 0.03}},
     motor: {ratio: 20, inertia: Im, viscous: 0.001}, friction: {viscous: 0.1, coulomb: 2}}
  - {name: b, type: prismatic, a: l, alpha: pi/3, d: 0.2, theta: pi/4,
     link: {mass: 2, com: [0.1, 0.02, 0.3], inertia: {xx: 0.2, yy: 0.3, zz: 0.35, xy: 0.01}},
     motor: {ratio: 50, inertia: 0.02, mass: 0.5, position: [0.1, 0.2, 0.3], axis: [1, 2, 2]}}
  - {name: c, type: revolute, a: -0.1, alpha: 0.3, d: 0.4, theta: 0,
     link: {mass: 1, com: [0.3, 0.1, 0.1], inertia: {xx: 0.1, yy: 0.1, zz: 0.1, yz: 0.02}},
     motor: {ratio: 100, inertia: 0.0002, mass: 0.1, position: [0.3, 0, 0], axis: [1, 1, 0]}}
  - {name: d, type: revolute, a: 0.1, alpha: 0, d: 0, theta: 0,
     link: {mass: 1, com: [0.2, 0.1, 0], inertia: {xx: 0.1, yy: 0.1, zz: 0.1, xz: 0.01}},
     motor: {ratio: -30, inertia: 0.0003, axis: [0, 1, 1]}, friction: {coulomb: 0.5}}
tool: {xyz: [0, 0.1, 0.2], rpy: [0.1, pi/6, -pi/4]}
payload: {mass: 0.7, com: [0.05, 0, 0.1], inertia: {xx: 0.01, yy: 0.02, zz: 0.02, xy: 0.001}}
";

/// The arm with more keys of the joints c and d.
fn branching(text: &str, (c, d): (&str, &str)) -> String {
    let joint = |name: &str| format!("{{name: {name}, ");
    text.replace(&joint("c"), &(joint("c") + c + ", ")).replace(&joint("d"), &(joint("d") + d + ", "))
}

fn arms() -> Vec<Manipulator> {
    let modified = STANDARD.replace("standard", "modified");
    let sideways = STANDARD.replace("prismatic", "revolute").replace("{name: c, type: revolute", "{name: c, type: prismatic");
    let tree = branching(STANDARD, ("parent: a, mount: {xyz: [0.1, 0, 0.2], rpy: [0.2, 0, pi/3]}", "parent: b"));
    [STANDARD.to_string(), modified, sideways, tree]
        .into_iter()
        .map(|text| {
            let source = Source::new("everything.yaml", text);
            let (read, diagnostics) = crate::validate::read(&source);
            read.unwrap_or_else(|| panic!("{diagnostics:?}")).0
        })
        .collect()
}

/// Runs a check on every arm, described by numbers and with all names as symbols.
fn check(check: impl Fn(&mut Pool, &Arm, &Manipulator)) {
    for manipulator in arms() {
        for view in [View::Nominal, View::Symbolic] {
            let mut pool = Pool::new(field_of(&manipulator));
            let arm = Arm::new(&mut pool, &manipulator, view);
            check(&mut pool, &arm, &manipulator);
        }
    }
}

#[track_caller]
fn assert_equal(pool: &Pool, a: &[ExprId], b: &[ExprId]) {
    assert_eq!(a.len(), b.len());
    for (k, (&a, &b)) in a.iter().zip(b).enumerate() {
        assert!(pool.equal(a, b), "entry {k} differs");
    }
}

fn times(pool: &mut Pool, m: &[Vec<ExprId>], v: &[ExprId]) -> Vec<ExprId> {
    m.iter().map(|row| pool.dot(row, v)).collect()
}

/// B the plain way: Σ_i J_i' M_i J_i over links and rotors, J_i by differentiation of frames (the book, eq. 7.32).
fn textbook_inertia(pool: &mut Pool, arm: &Arm) -> Vec<Vec<ExprId>> {
    let n = arm.dof();
    let frames = kinematics::frames(pool, arm);
    let mut b = vec![vec![ExprId::ZERO; n]; n];
    for i in 0..n {
        let (rotation, origin) = frames.joints[i];
        let body = arm.joints[i].body;
        // T = ½ Σ tr(dX P dX'), X = [R | p] the upper part of the frame, P the body's second, first and zeroth moments.
        let columns: Vec<Vec<ExprId>> = (0..n)
            .map(|k| {
                let flat: Vec<ExprId> = rotation.concat().into_iter().chain(origin).collect();
                pool.partial_derivative(&flat, k as u16)
            })
            .collect();
        let s = arm::symmetric(&body.second);
        let moment = |a: usize, c: usize| match (a, c) {
            (3, 3) => body.mass,
            (3, c) => body.first[c],
            (a, 3) => body.first[a],
            (a, c) => s[a][c],
        };
        let entry = |column: &[ExprId], row: usize, a: usize| if a < 3 { column[row * 3 + a] } else { column[9 + row] };
        for j in 0..n {
            for k in 0..n {
                for row in 0..3 {
                    for a in 0..4 {
                        for c in 0..4 {
                            let left = pool.mul(entry(&columns[j], row, a), moment(a, c));
                            let term = pool.mul(left, entry(&columns[k], row, c));
                            b[j][k] = pool.add(b[j][k], term);
                        }
                    }
                }
            }
        }
        // The rotor beyond what turns with the parent link: I_m k (u_j e_i + e_i u_j) + I_m k² e_i e_i, u_j = z_m · z_j over the parent's joints.
        if let Some(rotor) = arm.joints[i].rotor {
            let coupling = pool.mul(rotor.inertia, rotor.ratio);
            let own = pool.mul(coupling, rotor.ratio);
            b[i][i] = pool.add(b[i][i], own);
            let mut outer = arm.joints[i].parent;
            let axis = outer.map(|p| pool.transform(&frames.joints[p].0, &rotor.axis));
            while let Some(j) = outer {
                if arm.joints[j].is_revolute() {
                    let z = [0, 1, 2].map(|row| frames.joints[j].0[row][2]);
                    let along = pool.dot3(&axis.unwrap(), &z);
                    let term = pool.mul(coupling, along);
                    b[i][j] = pool.add(b[i][j], term);
                    b[j][i] = pool.add(b[j][i], term);
                }
                outer = arm.joints[j].parent;
            }
        }
    }
    b
}

#[test]
fn inertia_is_the_textbook_sum() {
    check(|pool, arm, _| {
        let (b, textbook) = (inertia::inertia_matrix(pool, arm, &mut Plan::default()), textbook_inertia(pool, arm));
        assert_equal(pool, &b.concat(), &textbook.concat());
    });
}

#[test]
fn grouping_changes_nothing() {
    check(|pool, arm, _| {
        for rest in [arm::GroupingConvention::NoSecondMomentAlongAxis, arm::GroupingConvention::NoInertiaAboutY] {
            let mut grouped = arm.clone();
            grouped.group_towards_base(pool, rest);
            let motion = Motion::plain(pool, arm);
            let (a, b) = (newton_euler(pool, arm, &motion, true), newton_euler(pool, &grouped, &motion, true));
            assert_equal(pool, &a, &b);
            let (a, b) = (
                inertia::inertia_matrix(pool, arm, &mut Plan::default()),
                inertia::inertia_matrix(pool, &grouped, &mut Plan::default()),
            );
            assert_equal(pool, &a.concat(), &b.concat());
            let (a, b) =
                (gravity::gravity(pool, arm, &mut Plan::default()), gravity::gravity(pool, &grouped, &mut Plan::default()));
            assert_equal(pool, &a, &b);
            let (a, b) = (kinetic_energy::kinetic_energy(pool, arm), kinetic_energy::kinetic_energy(pool, &grouped));
            assert_equal(pool, &[a], &[b]);
        }
    });
}

/// C by its definition from the derivatives of B (the book, eq. 7.45).
fn christoffel(pool: &mut Pool, arm: &Arm, b: &[Vec<ExprId>]) -> Vec<Vec<ExprId>> {
    let n = arm.dof();
    let rates = arm.symbols(pool, Symbol::Rate);
    let flat: Vec<ExprId> = b.concat();
    // gradient[k][i][j] = ∂b_ij/∂q_k
    let gradient: Vec<Vec<ExprId>> = (0..n).map(|k| pool.partial_derivative(&flat, k as u16)).collect();
    let derivative = |i: usize, j: usize, k: usize| gradient[k][i * n + j];
    let half = pool.fraction(1, 2);
    let mut c = vec![vec![ExprId::ZERO; n]; n];
    for i in 0..n {
        for j in 0..n {
            for k in 0..n {
                let plus = pool.add(derivative(i, j, k), derivative(i, k, j));
                let twice = pool.sub(plus, derivative(j, k, i));
                let symbol = pool.mul(half, twice);
                let term = pool.mul(symbol, rates[k]);
                c[i][j] = pool.add(c[i][j], term);
            }
        }
    }
    c
}

#[test]
fn coriolis_is_christoffels() {
    check(|pool, arm, _| {
        let b = inertia::inertia_matrix(pool, arm, &mut Plan::default());
        let textbook = christoffel(pool, arm, &b);
        let c = coriolis::coriolis_matrix(pool, arm, &mut Plan::default());
        assert_equal(pool, &c.concat(), &textbook.concat());
    });
}

/// Arms whose constants are all reduced, so that every pass has its forks: revolute joints alone with three parallel axes in a row, the same
/// where these are not neighbours in the list, and two with a sliding joint inside and at the end of such a row.
fn reduced_arms() -> Vec<Manipulator> {
    let reduced = STANDARD.replace("theta: 0.7", "theta: pi/6").replace("rpy: [0.1,", "rpy: [pi/2,");
    let revolute = reduced.replace("prismatic", "revolute").replace("convention: standard", "convention: modified");
    let parallel = revolute.replace("alpha: pi/3", "alpha: 0").replace("alpha: 0.3", "alpha: 0");
    let sliding = reduced
        .replace("convention: standard", "convention: modified")
        .replace("alpha: pi/3", "alpha: 0")
        .replace("alpha: 0.3", "alpha: 0");
    let tilted = reduced.replace("alpha: 0.3", "alpha: pi/3");
    let apart = parallel.replace("{name: b, ", "{name: b, parent: base, mount: {xyz: [0, 0.2, 0.1]}, ");
    let apart = branching(&apart, ("parent: a", "parent: c"));
    [parallel, apart, sliding, tilted]
        .into_iter()
        .map(|text| crate::validate::read(&Source::new("reduced.yaml", text)).0.expect("valid").0)
        .collect()
}

#[test]
fn every_way_of_a_plan_leads_to_the_same_expressions() {
    for manipulator in arms().into_iter().take(1).chain(reduced_arms()) {
        let model = crate::Model::new(manipulator);
        let of_parameters = [&REGRESSOR, &KNOWN_TORQUE, &BASE_REGRESSOR];
        let there = |quantity: &&catalogue::Quantity| (quantity.missing)(&model, false).is_none();
        for quantity in catalogue::quantities().filter(|quantity| !of_parameters.contains(quantity)).filter(there) {
            let mut pool = Pool::new(model.field.clone());
            let arm = Arm::new(&mut pool, &model.manipulator, View::Nominal);
            let input = DerivationInput { model: &model, view: View::Nominal };
            let plain = (quantity.recursion.entries)(&mut pool, &arm, &mut Plan::default(), &input);
            for seed in 0..8 {
                let found = quantity.by_plan(&model, View::Nominal, Plan::scattered(seed), 0);
                for (k, (&a, &b)) in plain.iter().zip(&found.entries).enumerate() {
                    assert_eq!(
                        pool.fingerprint(a),
                        found.pool.fingerprint(b),
                        "{} {k} of {} by plan {seed}",
                        quantity.name,
                        model.manipulator.name
                    );
                }
            }
        }
    }
}

#[test]
fn every_way_leads_to_the_same_regressor() {
    for manipulator in reduced_arms() {
        for choice in [RegressorChoice::Standard, RegressorChoice::Base] {
            let model = crate::Model::new(Manipulator { regressor: choice, ..manipulator.clone() });
            for quantity in [&REGRESSOR, &KNOWN_TORQUE] {
                let fingerprints = |plan| {
                    let found = quantity.by_plan(&model, View::Nominal, plan, 0);
                    found.entries.iter().map(|&e| found.pool.fingerprint(e)).collect::<Vec<_>>()
                };
                let plain = fingerprints(Plan::default());
                for seed in 0..8 {
                    assert_eq!(fingerprints(Plan::scattered(seed)), plain, "{} by plan {seed}", quantity.name);
                }
            }
        }
    }
}

#[test]
fn a_searched_and_optimised_program_computes_the_same_without_any_pass() {
    for manipulator in arms().into_iter().take(1).chain(reduced_arms()) {
        let model = crate::Model::new(manipulator);
        let fingerprints = |without| {
            let quantities = [&INERTIA_MATRIX, &CORIOLIS_MATRIX, &GRAVITY, &INVERSE_DYNAMICS];
            quantities.map(|quantity| {
                let found = quantity.by_search(&model, View::Nominal, without, 20_000);
                found.entries.iter().map(|&e| found.pool.fingerprint(e)).collect::<Vec<_>>()
            })
        };
        let none = fingerprints(crate::pass::Passes::all());
        for pass in crate::pass::Pass::ALL {
            assert_eq!(fingerprints([pass].into_iter().collect()), none, "without {}", pass.name());
        }
    }
}

#[test]
fn inertia_rate_less_twice_coriolis_is_skew() {
    check(|pool, arm, _| {
        let b = inertia::inertia_matrix(pool, arm, &mut Plan::default());
        let rate = pool.time_derivative(&b.concat());
        let c = coriolis::coriolis_matrix(pool, arm, &mut Plan::default());
        let n = arm.dof();
        for i in 0..n {
            for j in 0..n {
                let sum = pool.add(c[i][j], c[j][i]);
                assert!(pool.equal(rate[i * n + j], sum), "entry {i} {j}");
            }
        }
    });
}

#[test]
fn newton_euler_is_lagrange() {
    check(|pool, arm, _| {
        let motion = Motion::with_reference(pool, arm);
        let tau = newton_euler(pool, arm, &motion, true);
        let b = inertia::inertia_matrix(pool, arm, &mut Plan::default());
        let c = coriolis::coriolis_matrix(pool, arm, &mut Plan::default());
        let g = gravity::gravity(pool, arm, &mut Plan::default());
        let inertial = times(pool, &b, &motion.accelerations);
        let centrifugal = times(pool, &c, &motion.reference);
        let sum: Vec<ExprId> = (0..arm.dof()).map(|i| pool.sum([inertial[i], centrifugal[i], g[i]])).collect();
        assert_equal(pool, &tau, &sum);
    });
}

#[test]
fn gravity_is_the_gradient_of_the_potential() {
    check(|pool, arm, _| {
        let potential = first_moment::potential_energy(pool, arm);
        let gradient: Vec<ExprId> = (0..arm.dof() as u16).map(|i| pool.partial_derivative(&[potential], i)[0]).collect();
        let g = gravity::gravity(pool, arm, &mut Plan::default());
        assert_equal(pool, &g, &gradient);
    });
}

#[test]
fn kinetic_energy_is_half_the_quadratic_form() {
    check(|pool, arm, _| {
        let energy = kinetic_energy::kinetic_energy(pool, arm);
        let b = inertia::inertia_matrix(pool, arm, &mut Plan::default());
        let rates = arm.symbols(pool, Symbol::Rate);
        let momentum = times(pool, &b, &rates);
        let (twice, two) = (pool.dot(&rates, &momentum), pool.integer(2));
        let doubled = pool.mul(two, energy);
        assert_equal(pool, &[doubled], &[twice]);
    });
}

#[test]
fn jacobian_is_the_derivative_of_the_frame() {
    check(|pool, arm, _| {
        let frame = kinematics::direct_kinematics(pool, arm);
        let jacobian = kinematics::geometric_jacobian(pool, arm);
        let dot = kinematics::geometric_jacobian_dot(pool, arm);
        let rate = pool.time_derivative(&jacobian.concat());
        assert_equal(pool, &dot.concat(), &rate);
        for k in 0..arm.dof() {
            let derivative = pool.partial_derivative(&frame.concat(), k as u16);
            for row in 0..3 {
                assert!(pool.equal(derivative[4 * row + 3], jacobian[row][k]));
            }
            // dR/dq = [z] R
            let z = [jacobian[3][k], jacobian[4][k], jacobian[5][k]];
            for column in 0..3 {
                let axis = [frame[0][column], frame[1][column], frame[2][column]];
                let turned = pool.cross(&z, &axis);
                for row in 0..3 {
                    assert!(pool.equal(derivative[4 * row + column], turned[row]));
                }
            }
        }
    });
}

#[test]
fn forward_dynamics_inverts_inverse_dynamics() {
    check(|pool, arm, _| {
        let acceleration = forward_dynamics::forward_dynamics(pool, arm, &mut Plan::default());
        let motion = Motion { accelerations: acceleration, ..Motion::plain(pool, arm) };
        let tau = inverse_dynamics(pool, arm, &motion);
        let expected = arm.symbols(pool, Symbol::Torque);
        assert_equal(pool, &tau, &expected);
    });
}

#[test]
fn torque_is_the_regressor_times_the_parameters() {
    for manipulator in arms() {
        let field = field_of(&manipulator);
        for vector in
            [ParameterVector::standard(&manipulator), base::base_parameters(&manipulator, &field).expect("short combinations")]
        {
            let mut pool = Pool::new(field.clone());
            let arm = Arm::new(&mut pool, &manipulator, View::Vector(&vector));
            let y = regressor::regressor(&mut pool, &arm, &vector);
            let motion = Motion::with_reference(&mut pool, &arm);
            let tau = inverse_dynamics(&mut pool, &arm, &motion);
            let symbols: Vec<ExprId> = (0..vector.len() as u16).map(|k| pool.symbol(Symbol::Parameter(k))).collect();
            let known_arm = Arm::new(&mut pool, &manipulator, View::VectorZero(&vector));
            let known = inverse_dynamics(&mut pool, &known_arm, &motion);
            let product = times(&mut pool, &y, &symbols);
            let sum: Vec<ExprId> = (0..arm.dof()).map(|i| pool.add(product[i], known[i])).collect();
            assert_equal(&pool, &tau, &sum);

            // With the nominal values it is the torque of the description.
            let nominal: Vec<ExprId> = vector.entries.iter().map(|e| pool.constant(&e.nominal)).collect();
            let product = times(&mut pool, &y, &nominal);
            let described_arm = Arm::new(&mut pool, &manipulator, View::Nominal);
            let described = inverse_dynamics(&mut pool, &described_arm, &motion);
            let sum: Vec<ExprId> = (0..arm.dof()).map(|i| pool.add(product[i], known[i])).collect();
            assert_equal(&pool, &described, &sum);
        }
    }
}

/// A branch that turns with a multiple of the joint before it, between frames at general angles.
const GENERAL_COUPLED: &str = "
name: coupled
convention: urdf
gravity: [0, 0, -9.81]
joints:
  - {name: a, type: revolute, origin: {xyz: [0.25, 0, 0.25], rpy: [0, 0.3490658, -0.7853982]}, axis: [1, 0, 0], link: {mass: 4}}
  - name: b
    type: revolute
    origin: {xyz: [0.15, -0.05, 0.05], rpy: [0, 1.0471976, 0.5235988]}
    axis: [0, 0, 1]
    follows: {a: -2}
    link: {mass: 7, com: [0.03, -0.03, 0.1], inertia: {xx: 0.31, xy: 0.01, yy: 0.32, xz: 0.02, yz: 0.003, zz: 0.4}}
  - name: c
    type: prismatic
    origin: {xyz: [-0.15, 0.1, 0.35], rpy: [-1.2217305, -1.2217305, 0]}
    axis: [1, 0, 0]
    link: {mass: 6, com: [0.06, -0.06, 0.1], inertia: {xx: 0.31, xy: 0.01, yy: 0.32, xz: 0.02, yz: 0.003, zz: 0.4}}
  - name: d
    type: revolute
    parent: b
    origin: {xyz: [0.1, 0.15, 0.3], rpy: [0, -1.2217305, 1.0471976]}
    axis: [1, 0, 0]
    link: {mass: 8, com: [0.06, -0.08, 0.1], inertia: {xx: 0.31, xy: 0.01, yy: 0.32, xz: 0.02, yz: 0.003, zz: 0.4}}
  - {name: e, type: revolute, parent: d, origin: {xyz: [0, 0.1, 0.2], rpy: [0.5, 0, 0]}, axis: [0, 0, 1], follows: {a: 3}, link: {mass: 2}}
";

/// Columns that depend by the relation between two angles are no combination where states ignore it; and one coordinate shows the columns of
/// several links, in as many states as that takes.
#[test]
fn base_parameters_of_coupled_general_angles_are_as_many_as_the_rank() {
    let (arm, _) = crate::validate::read(&Source::new("robot.yaml", GENERAL_COUPLED)).0.expect("valid");
    let field = field_of(&arm);
    let (pool, y) = base::regressor_of(&arm, &field, &ParameterVector::standard(&arm));
    let rank = base::rank(&pool, &y);
    let vector = base::base_parameters(&arm, &field).expect("short combinations");
    assert_eq!(vector.len(), rank);
    // Without a product none is formed, and the rank stays what it is.
    let few = base::dependence_within(0, &pool, &y);
    assert_eq!(few.independent.len(), rank);
    assert!(!few.too_long.is_empty());
    assert_eq!(few.independent.len() + few.dependent.len() + few.too_long.len(), y[0].len());
}

#[test]
fn base_parameters_are_independent_and_as_many_as_the_rank() {
    for manipulator in arms() {
        let field = field_of(&manipulator);
        let vector = base::base_parameters(&manipulator, &field).expect("short combinations");
        let (pool, y) = base::regressor_of(&manipulator, &field, &vector);
        assert_eq!(base::rank(&pool, &y), vector.len());
        let (pool, y) = base::regressor_of(&manipulator, &field, &ParameterVector::standard(&manipulator));
        assert_eq!(base::rank(&pool, &y), vector.len());
    }
}

#[test]
fn friction_opposes_and_sits_in_inverse_dynamics() {
    check(|pool, arm, _| {
        let motion = Motion::plain(pool, arm);
        let (with, without) = (inverse_dynamics(pool, arm, &motion), newton_euler(pool, arm, &motion, true));
        let friction = friction(pool, arm, &motion.rates);
        let sum: Vec<ExprId> = (0..arm.dof()).map(|i| pool.add(without[i], friction[i])).collect();
        assert_equal(pool, &with, &sum);
        let at_joint = arm.joints[0].viscous;
        let value = pool.as_constant(at_joint).unwrap();
        // 20² · 0.001 + 0.1
        assert_eq!(value, crate::exact::Number::from(crate::exact::Rational::from_parts(1.into(), 2u8.into())));
    });
}

#[test]
fn closed_forms_are_the_same_expressions() {
    for manipulator in arms() {
        let model = crate::Model::new(manipulator);
        for quantity in [&DIRECT_KINEMATICS, &INERTIA_MATRIX, &GRAVITY] {
            let recursion = quantity.by_recursion(&model, View::Nominal);
            for closed in recursion.by_closed_form() {
                for (&a, &b) in closed.entries.iter().zip(&recursion.entries) {
                    assert_eq!(closed.pool.fingerprint(a), recursion.pool.fingerprint(b));
                }
            }
        }
    }
}

/// The determinant, its factors and its singular configurations, as text.
#[track_caller]
fn check_determinant(text: &str, form: &str, factors: &[(&str, Option<&str>)]) {
    let source = Source::new("arm.yaml", text);
    let (read, diagnostics) = crate::validate::read(&source);
    let model =
        crate::Model::new(read.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, crate::diagnostic::Colour::Never))).0);
    let found = determinant::determinant(&model, View::Nominal).expect("square");
    let printer = crate::ring::print::Printer {
        notation: crate::ring::print::Notation::Text,
        parameters: &[],
        velocities: &[],
        computed: None,
        digits: None,
    };
    assert_eq!(printer.form(found.form.as_ref().expect("short")), form);
    let texts: Vec<(String, Option<String>)> =
        found.factors.iter().map(|f| (printer.form(&f.form), f.zeros.words().map(String::from))).collect();
    let texts: Vec<(&str, Option<&str>)> = texts.iter().map(|(f, s)| (f.as_str(), s.as_deref())).collect();
    assert_eq!(texts, factors);
    // The product of the factors is the determinant.
    let mut pool = Pool::new(model.field.clone());
    let mut product = ExprId::ONE;
    for factor in &found.factors {
        let expr = pool.from_normal_form(&factor.form, crate::ring::normal_form::Arrangement::ByHarmonic);
        product = pool.mul(product, expr);
    }
    assert_eq!(pool.fingerprint(product), found.pool.fingerprint(found.value));
}

fn arm_text(rows: &[&str], task: &str) -> String {
    let mut text = String::from("name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n");
    for (i, row) in rows.iter().enumerate() {
        text += &format!("  - {{name: j{i}, {row}, link: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n");
    }
    text + task
}

#[test]
fn determinants_are_factored_and_their_zeros_named() {
    let scara = include_str!("../../../robots/scara.yaml");
    check_determinant(scara, "1/4*sin(q2)", &[("1/4*sin(q2)", Some("q2 = 0 mod pi"))]);
    // A polar arm: det J = q2.
    let polar = arm_text(
        &["type: revolute, a: 0, alpha: pi/2, d: 0, theta: pi/2", "type: prismatic, a: 0, alpha: 0, d: 0, theta: 0"],
        "task: [x, y]\n",
    );
    check_determinant(&polar, "-q2", &[("-q2", Some("q2 = 0"))]);
    // The anthropomorphic arm (the book, eq. 3.38): det J_P = -a2 a3 s3 (a2 c2 + a3 c23).
    let anthropomorphic = arm_text(
        &[
            "type: revolute, a: 0, alpha: pi/2, d: 0, theta: 0",
            "type: revolute, a: 2, alpha: 0, d: 0, theta: 0",
            "type: revolute, a: 3, alpha: 0, d: 0, theta: 0",
        ],
        "task: [x, y, z]\n",
    );
    check_determinant(
        &anthropomorphic,
        "-9*sin(q2 + 2*q3) + 6*sin(q2 - q3) - 6*sin(q2 + q3) + 9*sin(q2)",
        &[("sin(q3)", Some("q3 = 0 mod pi")), ("-18*cos(q2 + q3) - 12*cos(q2)", None)],
    );
}

#[test]
fn zeros_of_one_angle_are_named() {
    // A planar arm whose second link sits at an offset angle: det J = a1 a2 sin(q2 + pi/4).
    let offset = arm_text(
        &["type: revolute, a: 1, alpha: 0, d: 0, theta: 0", "type: revolute, a: 1, alpha: 0, d: 0, theta: pi/4"],
        "task: [x, y]\n",
    );
    check_determinant(
        &offset,
        "1/2*sqrt(2)*cos(q2) + 1/2*sqrt(2)*sin(q2)",
        &[("1/2*sqrt(2)*cos(q2) + 1/2*sqrt(2)*sin(q2)", Some("q2 = atan(-1) mod pi"))],
    );
}

#[test]
fn six_axis_arms_have_their_textbook_factors() {
    let model = |text: &str| {
        let source = Source::new("arm.yaml", text);
        crate::Model::new(crate::validate::read(&source).0.expect("valid").0)
    };
    // Wrist, elbow and shoulder of the Puma. The elbow is stretched where the wrist centre lies on x2: a3 sin q3 + d4 cos q3 = 0.
    let puma = model(include_str!("../../../robots/puma560.yaml"));
    let found = determinant::determinant(&puma, View::Nominal).expect("square");
    let singular: Vec<Option<&str>> = found.factors.iter().map(|f| f.zeros.words()).collect();
    assert_eq!(singular, [Some("q3 = atan(-4318/203) mod pi"), Some("q5 = 0 mod pi"), None]);
    let panda = model(include_str!("../../../robots/panda7.yaml"));
    assert!(determinant::determinant(&panda, View::Nominal).is_none());
}

#[test]
fn momentum_and_coriolis_transposed_are_those_of_the_matrices() {
    check(|pool, arm, _| {
        let rates = arm.symbols(pool, Symbol::Rate);
        let b = inertia::inertia_matrix(pool, arm, &mut Plan::default());
        let expected = times(pool, &b, &rates);
        let found = momentum::momentum(pool, arm);
        assert_equal(pool, &found, &expected);

        let found = momentum::coriolis_transpose_times(pool, arm);
        let c = coriolis::coriolis_matrix(pool, arm, &mut Plan::default());
        let transposed: Vec<Vec<ExprId>> = (0..arm.dof()).map(|j| c.iter().map(|row| row[j]).collect()).collect();
        let expected = times(pool, &transposed, &rates);
        assert_equal(pool, &found, &expected);
        // dB/dt dq - C dq, and the gradient of the kinetic energy.
        let b_rate = pool.time_derivative(&b.concat());
        let b_rate: Vec<Vec<ExprId>> = b_rate.chunks(arm.dof()).map(<[ExprId]>::to_vec).collect();
        let (changing, centrifugal) = (times(pool, &b_rate, &rates), times(pool, &c, &rates));
        let difference: Vec<ExprId> = changing.iter().zip(&centrifugal).map(|(&a, &b)| pool.sub(a, b)).collect();
        assert_equal(pool, &found, &difference);
        let energy = kinetic_energy::kinetic_energy(pool, arm);
        let gradient: Vec<ExprId> = (0..arm.dof() as u16).map(|i| pool.partial_derivative(&[energy], i)[0]).collect();
        assert_equal(pool, &found, &gradient);
    });
}

#[test]
fn torque_is_the_base_regressor_times_the_base_parameters() {
    for manipulator in arms().into_iter().chain(reduced_arms()) {
        let model = crate::Model::new(manipulator);
        let vector = model.base_parameters().expect("short combinations");
        let mut pool = Pool::new(model.field.clone());
        let mut arm = Arm::new(&mut pool, &model.manipulator, View::Vector(vector));
        base::place_frames_for_base_parameters(&mut pool, &mut arm);
        let y = base::base_regressor(&mut pool, &arm, vector, &mut Plan::default());
        assert_eq!(base::rank(&pool, &y), vector.len());
        let values: Vec<ExprId> = vector.entries.iter().map(|entry| pool.constant(&entry.nominal)).collect();
        let product = times(&mut pool, &y, &values);
        let described = Arm::new(&mut pool, &model.manipulator, View::Nominal);
        let motion = Motion::plain(&mut pool, &described);
        let tau = inverse_dynamics(&mut pool, &described, &motion);
        assert_equal(&pool, &product, &tau);
    }
}

#[test]
fn derivatives_of_inverse_dynamics_are_derivatives() {
    check(|pool, arm, _| {
        let motion = Motion::plain(pool, arm);
        let tau = inverse_dynamics(pool, arm, &motion);
        let (by_q, by_dq) = derivatives::inverse_dynamics_derivatives(pool, arm, &mut Plan::default(), &motion);
        for j in 0..arm.dof() {
            let column = |m: &[Vec<ExprId>]| m.iter().map(|row| row[j]).collect::<Vec<_>>();
            let expected = pool.partial_derivative(&tau, j as u16);
            assert_equal(pool, &column(&by_q), &expected);
            let expected = pool.differentiate(&tau, &mut |_, symbol| match symbol {
                Symbol::Rate(i) if usize::from(i) == j => ExprId::ONE,
                _ => ExprId::ZERO,
            });
            assert_equal(pool, &column(&by_dq), &expected);
        }
    });
}

#[test]
fn derivatives_of_forward_dynamics_are_derivatives() {
    check(|pool, arm, _| {
        let acceleration = forward_dynamics::forward_dynamics(pool, arm, &mut Plan::default());
        let (by_q, by_dq, by_tau) = derivatives::forward_dynamics_derivatives(pool, arm, &mut Plan::default());
        for j in 0..arm.dof() {
            let column = |m: &[Vec<ExprId>]| m.iter().map(|row| row[j]).collect::<Vec<_>>();
            let expected = pool.partial_derivative(&acceleration, j as u16);
            assert_equal(pool, &column(&by_q), &expected);
            for (matrix, wanted) in [(&by_dq, Symbol::Rate(j as u16)), (&by_tau, Symbol::Torque(j as u16))] {
                let expected = pool.differentiate(&acceleration, &mut |_, symbol| {
                    if symbol == wanted {
                        ExprId::ONE
                    } else {
                        ExprId::ZERO
                    }
                });
                assert_equal(pool, &column(matrix), &expected);
            }
        }
    });
}

#[test]
fn operational_inertia_is_the_inverse_of_the_mobility_of_the_task() {
    let mut defined = 0;
    for manipulator in arms().into_iter().chain(reduced_arms()) {
        for task in [vec![0], vec![0, 2], vec![0, 1, 2]] {
            let mut pool = Pool::new(field_of(&manipulator));
            let arm = Arm::new(&mut pool, &manipulator, View::Nominal);
            let field = pool.field().clone();
            if !operational_inertia::is_defined(&field, &arm, pool.clone(), &task) {
                continue;
            }
            defined += 1;
            let found = operational_inertia::operational_inertia(&mut pool, &arm, &mut Plan::default(), &task);
            // B_A J B^-1 J' = 1, B^-1 by columns from forward dynamics without forces but one.
            let jacobian = kinematics::geometric_jacobian(&mut pool, &arm);
            let b = inertia::inertia_matrix(&mut pool, &arm, &mut Plan::default());
            let factors = factors::LdlFactors::new(&mut pool, &b);
            for (s, &row) in task.iter().enumerate() {
                let accelerations = factors.solve(&mut pool, &jacobian[row]);
                let back = times(&mut pool, &b, &accelerations);
                assert_equal(&pool, &back, &jacobian[row]);
                let moved: Vec<ExprId> = task.iter().map(|&r| pool.dot(&jacobian[r], &accelerations)).collect();
                let felt = times(&mut pool, &found, &moved);
                let unit: Vec<ExprId> = (0..task.len()).map(|r| if r == s { ExprId::ONE } else { ExprId::ZERO }).collect();
                assert_equal(&pool, &felt, &unit);
            }
        }
    }
    assert!(defined >= 12, "{defined} cases");
}

#[test]
fn a_task_that_the_arm_cannot_do_has_no_operational_inertia() {
    let missing = |task: &str| {
        let rows = ["type: revolute, a: 1, alpha: 0, d: 0, theta: 0"; 3];
        let source = Source::new("arm.yaml", arm_text(&rows, task));
        let model = crate::Model::new(crate::validate::read(&source).0.expect("valid").0);
        (OPERATIONAL_INERTIA.missing)(&model, false)
    };
    assert_eq!(missing("task: [x, y, rz]\n"), None);
    assert_eq!(missing("task: [x, rz]\n"), None);
    assert!(missing("task: [x, y, z]\n").is_some_and(|why| why.contains("3 joints cannot move the 3 rows")));
    assert!(missing("").is_some());
}

#[test]
fn what_has_no_mass_has_no_center_of_mass_and_base_parameters_give_none() {
    let missing = |mass: u8, regressor: &str| {
        let link = format!("link: {{mass: {mass}, inertia: {{xx: 1, yy: 1, zz: 1}}}}");
        let text = format!(
            "name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\nregressor: {regressor}\njoints:\n  - {{name: a, type: revolute, a: 1, alpha: 0, d: 0, theta: 0, {link}}}\n"
        );
        let source = Source::new("arm.yaml", text);
        let model = crate::Model::new(crate::validate::read(&source).0.expect("valid").0);
        [false, true].map(|with| (CENTER_OF_MASS.missing)(&model, with))
    };
    assert_eq!(missing(2, "standard"), [None, None]);
    let [plain, with] = missing(0, "standard");
    // The parameters of the arm may give it a mass all the same.
    assert!(plain.is_some_and(|why| why.contains("no mass")) && with.is_none());
    let [plain, with] = missing(2, "base");
    assert!(plain.is_none() && with.is_some_and(|why| why.contains("base parameters")));
}
