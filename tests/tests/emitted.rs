//! The emitted modules judged: against stored values of another library, and every function of every robot against the oracle.

use std::collections::BTreeSet;

use armgen_tests::emitted::{emitted, Emitted, ALL};
use armgen_tests::functions::{absent, expected, Arguments, Functions};
use armgen_tests::judge::{judge, Tolerance};
use armgen_tests::oracle::{times, Description};
use armgen_tests::precision::{agree, DIFFERENCES, FORWARD_RESIDUAL, ORACLE, REFERENCE, SINGLE, SINGLE_RESIDUAL};
use armgen_tests::random;
use armgen_tests::reference::{reference, ROBOTS};
use armgen_tests::signatures::{INTO, OF_PARAMETERS};

fn tolerance(robot: &Emitted) -> Tolerance {
    match robot.narrow {
        false => Tolerance { values: ORACLE, residual: FORWARD_RESIDUAL },
        true => Tolerance { values: SINGLE, residual: SINGLE_RESIDUAL },
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn agree_with_the_reference_values() {
    for name in ROBOTS {
        let robot = emitted(name);
        let model = Description::read(&robot.description()).and_then(|d| d.model()).expect(name);
        for (i, s) in reference(name).samples.iter().enumerate() {
            let a = Arguments {
                q: s.q.clone(),
                dq: s.dq.clone(),
                ddq: s.ddq.clone(),
                dqr: s.dq.clone(),
                ddqr: s.ddq.clone(),
                tau: s.tau.clone(),
                pi: robot.nominal(),
                ..Arguments::default()
            };
            let check = |function: &str, expected: Vec<f64>| {
                agree(&format!("{name} sample {i} {function}"), &robot.call(function, &a), &expected, REFERENCE)
            };
            check("direct_kinematics", s.direct_kinematics.concat());
            check("geometric_jacobian", s.geometric_jacobian.concat());
            check("inertia_matrix", s.inertia_matrix.concat());
            check("coriolis_matrix", s.coriolis_matrix.concat());
            check("gravity", s.gravity.clone());
            check("inverse_dynamics", s.tau.clone());
            check("regressor", s.regressor.concat());
            let b = s.inertia_matrix.concat();
            check("equations_of_motion", [b, s.coriolis_matrix.concat(), s.gravity.clone()].concat());
            for function in ["forward_dynamics", "forward_dynamics_with"] {
                let residual = model.forward_residual(&s.q, &robot.call(function, &a), &s.qdd_from_tau, &s.tau);
                assert!(residual <= FORWARD_RESIDUAL, "{name} sample {i} {function}: {residual:e}");
            }
        }
    }
}

#[test]
#[ignore = "wide"]
fn agree_with_the_oracle() {
    for robot in ALL {
        for seed in 0..6 {
            judge(robot.module, robot, &robot.description(), seed, tolerance(robot));
        }
    }
}

#[test]
fn agree_with_the_oracle_through_the_traits() {
    for robot in ALL {
        judge(
            &format!("{} through the traits", robot.module),
            &robot.through_traits(),
            &robot.description(),
            1,
            tolerance(robot),
        );
    }
}

/// Whoever adds a function to the module has to name it in the judge's list, and whoever adds a robot sees it judged.
#[test]
fn nothing_is_left_out() {
    for robot in ALL {
        let file = syn::parse_file(robot.text).expect("the emitted text is Rust");
        let functions: Vec<String> = file
            .items
            .iter()
            .filter_map(|item| match item {
                syn::Item::Fn(f) if matches!(f.vis, syn::Visibility::Public(_)) => Some(f.sig.ident.to_string()),
                _ => None,
            })
            // What writes into memory of the caller is called by the function that returns the same.
            .filter(|name| !name.ends_with(INTO) && !OF_PARAMETERS.contains(&name.as_str()))
            .collect();
        assert_eq!(functions, expected(&absent(robot.text), &robot.description()), "{}", robot.module);
        assert_eq!(robot.narrow, robot.module.ends_with("_f32"));
    }
    let modules: BTreeSet<&str> = ALL.iter().map(|robot| robot.module).collect();
    for (name, _) in random::tricky() {
        assert!(modules.contains(name), "{name}");
    }
    for name in ["scara", "scara4", "puma560", "ur5", "panda7", "scara_f32", "puma560_f32"] {
        assert!(modules.contains(name), "{name}");
    }
}

/// The laws of mechanics, on the emitted functions' own values.
#[test]
fn obey_the_laws() {
    for robot in ALL.iter().filter(|robot| !robot.narrow) {
        let model = Description::read(&robot.description()).and_then(|d| d.model()).expect(robot.module);
        let n = robot.dof();
        for seed in 100..110 {
            let s = random::state(n, seed);
            let a = Arguments { q: s.q.clone(), dq: s.dq.clone(), ddq: s.ddq.clone(), ..Arguments::default() };
            let call = |function: &str| robot.call(function, &a);
            let check = |law: &str, found: &[f64], expected: &[f64]| {
                agree(&format!("{} seed {seed}: {law}", robot.module), found, expected, ORACLE);
            };
            let (b, c, g) = (call("inertia_matrix"), call("coriolis_matrix"), call("gravity"));
            let at = |m: &[f64], i: usize, j: usize| m[i * n + j];
            let transposed: Vec<f64> = (0..n * n).map(|k| at(&b, k % n, k / n)).collect();
            assert_eq!(b, transposed, "{}: B is symmetric to the bit", robot.module);

            let db = model.inertia_matrix_derivatives(&s.q);
            let skew = |i: usize, j: usize| (0..n).map(|k| db[k][i][j] * s.dq[k]).sum::<f64>() - 2.0 * at(&c, i, j);
            let (n_matrix, opposite): (Vec<f64>, Vec<f64>) =
                (0..n * n).map(|k| (skew(k / n, k % n), -skew(k % n, k / n))).unzip();
            check("dB/dt - 2C is skew", &n_matrix, &opposite);

            let rows = |m: &[f64]| m.chunks(n).map(<[f64]>::to_vec).collect::<Vec<_>>();
            let (b_ddq, c_dq, mut f) = (times(&rows(&b), &s.ddq), times(&rows(&c), &s.dq), call("friction"));
            if robot.has("load_friction") {
                f = f.iter().zip(call("load_friction")).map(|(f, load)| f + load).collect();
            }
            let sum: Vec<f64> = (0..n).map(|i| b_ddq[i] + c_dq[i] + f[i] + g[i]).collect();
            check("tau = B ddq + C dq + F + g", &call("inverse_dynamics"), &sum);
            check("T = ½ dq' B dq", &call("kinetic_energy"), &[0.5 * dot(&s.dq, &times(&rows(&b), &s.dq))]);
            let delivered: Vec<f64> = call("inverse_dynamics").iter().zip(&f).map(|(tau, f)| tau - f).collect();
            check("power", &[dot(&s.dq, &delivered)], &[model.power(&s.q, &s.dq, &s.ddq)]);
            check("g = dU/dq", &g, &model.potential_gradient(&s.q));

            // Central differences: right to about the square of the step, and the rounding of tau over the step.
            let step = 1e-5;
            let found = call("inverse_dynamics_derivatives");
            for j in 0..n {
                let moved = |by: f64, rate: bool| {
                    let mut moved = a.clone();
                    (if rate { &mut moved.dq } else { &mut moved.q })[j] += by;
                    robot.call("inverse_dynamics", &moved)
                };
                for (rate, derivative) in [(false, &found[..n * n]), (true, &found[n * n..])] {
                    if rate && a.dq[j].abs() < 2.0 * step {
                        continue;
                    }
                    let (plus, minus) = (moved(step, rate), moved(-step, rate));
                    let difference: Vec<f64> = plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * step)).collect();
                    let column: Vec<f64> = (0..n).map(|i| at(derivative, i, j)).collect();
                    agree(&format!("{} seed {seed}: derivatives by joint {j}", robot.module), &column, &difference, DIFFERENCES);
                }
            }

            let tau = call("inverse_dynamics");
            let back = robot.call("forward_dynamics", &Arguments { tau: tau.clone(), ..a.clone() });
            let residual = model.forward_residual(&s.q, &back, &s.ddq, &tau);
            assert!(residual <= FORWARD_RESIDUAL, "{} seed {seed}: forward after inverse dynamics: {residual:e}", robot.module);
        }
    }
}

/// Base parameters omit a constant of the potential energy: differences of the energy agree with the arm, its value does not.
#[test]
fn energies_of_base_parameters_change_as_those_of_the_arm() {
    let robot = emitted("base_set");
    let energies = |seed: u64| {
        let a = Arguments { q: random::state(robot.dof(), seed).q, pi: robot.nominal(), ..Arguments::default() };
        [robot.call("potential_energy_with", &a)[0], robot.call("potential_energy", &a)[0]]
    };
    let [with, plain] = energies(0);
    for seed in 1..20 {
        let [other_with, other_plain] = energies(seed);
        agree("a change of U", &[other_with - with], &[other_plain - plain], ORACLE);
    }
    assert!((with - plain).abs() > 1.0, "U_with {with} and U {plain} J are the same");
}

/// A robot with a small error in one entry of one function.
struct Planted<'a> {
    robot: &'a Emitted,
    function: &'a str,
}

impl Functions for Planted<'_> {
    fn dof(&self) -> usize {
        self.robot.dof()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.robot.parameter_names()
    }

    fn nominal(&self) -> Vec<f64> {
        self.robot.nominal()
    }

    fn nominal_base(&self) -> Vec<f64> {
        self.robot.nominal_base()
    }

    fn has(&self, function: &str) -> bool {
        self.robot.has(function)
    }

    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64> {
        let mut value = self.robot.call(function, arguments);
        if function == self.function {
            let scale = value.iter().fold(1.0f64, |m, x| m.max(x.abs()));
            // A column of the base regressor whose parameter is 0 has no effect that the judge could see.
            let base = self.nominal_base();
            let middle = match function {
                "base_regressor" => base.iter().position(|&x| x.abs() > 0.1).expect("a parameter that counts"),
                _ => value.len() / 2,
            };
            value[middle] += 1e-10 * scale;
        }
        value
    }
}

#[test]
#[ignore = "wide"]
fn planted_errors_are_seen() {
    for robot in ["scara", "scara4", "base_set"].map(emitted) {
        let text = robot.description();
        for function in expected(&absent(robot.text), &text) {
            let planted = Planted { robot, function: &function };
            let judged = std::panic::catch_unwind(|| judge("planted", &planted, &text, 3, tolerance(robot)));
            assert!(judged.is_err(), "{}: an error in {function} is not seen", robot.module);
        }
    }
}
