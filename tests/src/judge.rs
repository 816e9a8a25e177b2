//! Every function of a robot against the oracle, at one state.
//!
//! The plain functions are compared with the oracle's model of the description. The `_with` forms are compared with the oracle's model at the
//! same parameters, and with linear identities that need no model, because base parameters are the generator's own choice:
//!
//! ```text
//! tau(pi; dq, dqr, ddqr) = Y pi + tau_known          tau_0 = tau(pi; 0, 0, 0)
//! g = tau_0                                          B e_j = tau(pi; 0, 0, e_j) - tau_0
//! F_c = tau(pi; dq, 0, 0) - tau_0                    (C + F_v) e_j = tau(pi; dq, e_j, 0) - tau(pi; dq, 0, 0)
//! T = ½ dq' B dq                                     U(b) - U(a) = ∫ g dq from a to b
//! ```

use armgen_codegen::catalogue::{self, Sizes};

use crate::functions::{Arguments, Functions};
use crate::oracle::{rank, solve, times, Description, Matrix, Model, RegressorChoice};
use crate::precision::{agree, AT_COMPUTED_ACCELERATIONS, NEAR_NOMINAL, WELL_CONDITIONED};
use crate::random::{self, Random, State};

/// How close the judged functions have to come.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Bound for every function except forward dynamics, by `precision::deviation`.
    pub values: f64,
    /// Bound for the residual of forward dynamics.
    pub residual: f64,
}

/// A case: the robot, the description that judges it, and the state.
struct Case<'a> {
    what: String,
    robot: &'a dyn Functions,
    description: &'a Description,
    model: Model,
    tolerance: Tolerance,
    seed: u64,
}

/// Judges every function of `robot` at random states and parameters; `what` names it in a failure, `text` is its description.
#[track_caller]
pub fn judge(what: &str, robot: &dyn Functions, text: &str, seed: u64, tolerance: Tolerance) {
    let description = Description::read(text).unwrap_or_else(|error| panic!("{what}: {error}\n{text}"));
    let model = description.model().unwrap_or_else(|error| panic!("{what}: {error}\n{text}"));
    let what = format!("{what}, seed {seed}");
    assert_eq!(robot.dof(), model.dof(), "{what}");
    let case = Case { what, robot, description: &description, model, tolerance, seed };
    let mut state = random::state(robot.dof(), seed);
    case.judge_at(&state);
    // At rest the sign of a rate is 0; Coulomb friction must not push a joint at rest.
    for (i, rate) in state.dq.iter_mut().enumerate() {
        if (i as u64 + seed).is_multiple_of(2) {
            *rate = 0.0;
        }
    }
    case.judge_friction(&state);
    case.judge_parameters();
}

fn arguments(state: &State, pi: &[f64]) -> Arguments {
    let State { q, dq, ddq, dqr, ddqr } = state.clone();
    Arguments { pi: pi.to_vec(), q, dq, ddq, dqr, ddqr, ..Arguments::default() }
}

fn unit(n: usize, k: usize, length: f64) -> Vec<f64> {
    (0..n).map(|i| if i == k { length } else { 0.0 }).collect()
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn transposed(m: &Matrix) -> Matrix {
    (0..m.first().map_or(0, Vec::len)).map(|j| m.iter().map(|row| row[j]).collect()).collect()
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    transposed(&transposed(b).iter().map(|column| times(a, column)).collect())
}

fn largest(m: &Matrix) -> f64 {
    m.iter().flatten().fold(0.0, |largest, x| x.abs().max(largest))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn column(m: &[f64], n: usize, j: usize) -> Vec<f64> {
    (0..n).map(|i| m[i * n + j]).collect()
}

impl Case<'_> {
    #[track_caller]
    fn check(&self, what: &str, found: &[f64], expected: &[f64]) {
        agree(&format!("{}: {what}", self.what), found, expected, self.tolerance.values);
    }

    fn judge_at(&self, state: &State) {
        let (robot, model) = (self.robot, &self.model);
        let a = arguments(state, &robot.nominal());
        let State { q, dq, ddq, dqr, ddqr } = state;
        self.expect_values(false, model, &a);
        self.expect_forward_dynamics("forward_dynamics", model, a.clone());
        self.judge_beyond(&a);

        // The regressor of the file's choice, column by column where the oracle knows the columns; and the torque Y pi + known.
        let y = robot.call("regressor", &a);
        let known = robot.call("known_torque", &a);
        match self.description.regressor(q, dq, dqr, ddqr) {
            Some(expected) => {
                let expected = expected.unwrap_or_else(|error| panic!("{}: {error}", self.what));
                self.check("nominal parameters", &robot.nominal(), &expected.parameters);
                self.check("regressor", &y, &expected.y.concat());
                self.check("known_torque", &known, &expected.known);
            }
            None => self.judge_base_columns(),
        }
        let tau = self.torque(&a, &robot.nominal());
        self.check("Y pi + tau_known", &tau, &model.inverse_dynamics_4(q, dq, dqr, ddqr));
        let with_own = Arguments { dqr: dq.clone(), ddqr: ddq.clone(), ..a.clone() };
        let tau = self.torque(&with_own, &robot.nominal());
        let whole = robot.call("inverse_dynamics", &a);
        self.check("Y(q, dq, dq, ddq) pi + tau_known", &tau, &self.without_load_friction("load_friction", &a, &whole));
    }

    /// The functions that no formula gives: base regressor, operational inertia, derivatives of forward dynamics.
    fn judge_beyond(&self, a: &Arguments) {
        let (robot, model, n) = (self.robot, &self.model, self.robot.dof());
        if !robot.has("base_regressor") {
            return;
        }
        let b = model.inertia_matrix(&a.q);

        let base = robot.nominal_base();
        let y: Matrix = robot.call("base_regressor", a).chunks(base.len()).map(<[f64]>::to_vec).collect();
        self.check("Y_b pi_b", &times(&y, &base), &model.inverse_dynamics_4(&a.q, &a.dq, &a.dq, &a.ddq));
        assert!(base.iter().all(|&x| x != 0.0), "{}: a base parameter without effect", self.what);
        let all = matches!(self.description.regressor_choice(), RegressorChoice::Base);
        let count = robot.nominal().len();
        let (mut base_rows, mut own_rows, mut joined_rows): (Matrix, Matrix, Matrix) = Default::default();
        for k in 0..(10 * n as u64 + 20) {
            let state = arguments(&random::state(n, 78_000 + k), &[]);
            let rows: Matrix = robot.call("base_regressor", &state).chunks(base.len()).map(<[f64]>::to_vec).collect();
            if all {
                let own = Arguments { dqr: state.dq.clone(), ddqr: state.ddq.clone(), ..state.clone() };
                let own = robot.call("regressor", &own);
                own_rows.extend(own.chunks(count).map(<[f64]>::to_vec));
                joined_rows.extend(own.chunks(count).zip(&rows).map(|(own, base)| [own, base].concat()));
            }
            base_rows.extend(rows);
        }
        assert_eq!(rank(&base_rows), base.len(), "{}: base_regressor has full column rank", self.what);
        if all {
            // Its columns are combinations of the columns of the regressor of all base parameters.
            assert_eq!(rank(&joined_rows), rank(&own_rows), "{}: base_regressor by regressor", self.what);
        }

        let (by_q, by_dq) = model.inverse_dynamics_derivatives(&a.q, &a.dq, &a.ddq);
        // B times the derivatives of forward dynamics, at the accelerations that the torques cause.
        let a = Arguments { tau: model.inverse_dynamics(&a.q, &a.dq, &a.ddq), ..a.clone() };
        let found = robot.call("forward_dynamics_derivatives", &a);
        let squares: Vec<Matrix> = found.chunks(n * n).map(|m| m.chunks(n).map(<[f64]>::to_vec).collect()).collect();
        let identity: Matrix = (0..n).map(|i| unit(n, i, 1.0)).collect();
        let negative = |m: &Matrix| m.iter().map(|row| row.iter().map(|x| -x).collect()).collect::<Matrix>();
        for (what, found, expected) in [
            ("B d(ddq)/dq", &squares[0], negative(&by_q)),
            ("B d(ddq)/d(dq)", &squares[1], negative(&by_dq)),
            ("B B^-1", &squares[2], identity),
        ] {
            // Rounded to the scale of B times what it is multiplied by; the accelerations lose what a large condition number takes.
            let condition = largest(&b) * largest(&squares[2]);
            let scale = (largest(&b) * largest(found)).max(1.0) * (condition / WELL_CONDITIONED).max(1.0);
            let residual = |m: &Matrix| m.concat().iter().map(|x| x / scale).collect::<Vec<f64>>();
            let product = product(&b, found);
            let tolerance = AT_COMPUTED_ACCELERATIONS * self.tolerance.residual;
            agree(&format!("{}: {what}", self.what), &residual(&product), &residual(&expected), tolerance);
        }

        if robot.has("operational_inertia") {
            let task: Vec<usize> = self.description.task_rows();
            let jacobian = model.geometric_jacobian(&a.q);
            let rows: Matrix = task.iter().map(|&row| jacobian[row].clone()).collect();
            let columns: Matrix = rows.iter().map(|row| solve(&b, row).expect("B is positive definite")).collect();
            let mobility = product(&rows, &transposed(&columns));
            let inertia: Matrix = robot.call("operational_inertia", &a).chunks(task.len()).map(<[f64]>::to_vec).collect();
            let scale = (largest(&inertia) * largest(&mobility)).max(1.0);
            let back: Vec<f64> = product(&inertia, &mobility).concat().iter().map(|x| x / scale).collect();
            let expected: Vec<f64> = (0..task.len()).flat_map(|i| unit(task.len(), i, 1.0 / scale)).collect();
            agree(&format!("{}: operational_inertia", self.what), &back, &expected, self.tolerance.residual);
        }
    }

    /// All functions, plain or `_with`, for which a model has a formula, each part of a result to its own scale.
    fn expect_values(&self, with_parameters: bool, model: &Model, a: &Arguments) {
        let n = self.robot.dof();
        let sizes = Sizes { dof: n, joints: n, parameters: a.pi.len(), base_parameters: 0, task: 0 };
        for (quantity, _) in catalogue::functions().filter(|(_, with)| *with == with_parameters) {
            let function = quantity.function_name(with_parameters);
            let Some(expected) = model.value(&function, a).filter(|_| self.robot.has(&function)) else { continue };
            let found = self.robot.call(&function, a);
            assert_eq!(found.len(), expected.len(), "{}: {function}", self.what);
            let mut start = 0;
            for part in quantity.result {
                let entries = start..start + part.len(&sizes);
                start = entries.end;
                self.check(&format!("{function}: {}", part.name), &found[entries.clone()], &expected[entries]);
            }
        }
    }

    /// The accelerations come back from the torques that they need.
    fn expect_forward_dynamics(&self, function: &str, model: &Model, mut a: Arguments) {
        a.tau = model.inverse_dynamics(&a.q, &a.dq, &a.ddq);
        let residual = model.forward_residual(&a.q, &self.robot.call(function, &a), &a.ddq, &a.tau);
        assert!(residual <= self.tolerance.residual, "{}: {function}: residual {residual:e}", self.what);
    }

    fn judge_friction(&self, state: &State) {
        let a = arguments(state, &self.robot.nominal());
        self.check("friction with joints at rest", &self.robot.call("friction", &a), &self.model.friction(&a.dq));
        self.check("friction_with", &self.robot.call("friction_with", &a), &self.model.friction(&a.dq));
        let tau = self.robot.call("inverse_dynamics", &a);
        self.check("tau with joints at rest", &tau, &self.model.inverse_dynamics(&a.q, &a.dq, &a.ddq));
        let tau = self.torque(&a, &a.pi);
        self.check("Y pi with joints at rest", &tau, &self.model.inverse_dynamics_4(&a.q, &a.dq, &a.dqr, &a.ddqr));
    }

    /// Torques without friction that grows with the load, which is no part of the regressor.
    fn without_load_friction(&self, function: &str, a: &Arguments, tau: &[f64]) -> Vec<f64> {
        match self.robot.has(function) {
            true => minus(tau, &self.robot.call(function, a)),
            false => tau.to_vec(),
        }
    }

    /// Y pi + tau_known of the robot itself.
    fn torque(&self, a: &Arguments, pi: &[f64]) -> Vec<f64> {
        let y = self.robot.call("regressor", a);
        let rows: Matrix =
            if pi.is_empty() { vec![vec![]; a.q.len()] } else { y.chunks(pi.len()).map(<[f64]>::to_vec).collect() };
        times(&rows, pi).iter().zip(self.robot.call("known_torque", a)).map(|(y, known)| y + known).collect()
    }

    /// Base parameters are independent, span the same space as the standard regressor, and are as many as its rank, with friction separated.
    fn judge_base_columns(&self) {
        let n = self.robot.dof();
        let (mut base, mut standard): (Matrix, Matrix) = Default::default();
        let units = |count: usize| (0..count).map(move |k| (0..count).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>());
        let count = self.robot.parameter_names().len();
        let standards = self.model.standard_parameters().len();
        // Rows of friction, and below them the remaining rows; `friction[column][joint]`.
        let apart = |y: Matrix, friction: Vec<Vec<f64>>| -> Matrix {
            let friction: Matrix = (0..n).map(|i| friction.iter().map(|column| column[i]).collect()).collect();
            let rest = y.iter().zip(&friction).map(|(y, f)| y.iter().zip(f).map(|(y, f)| y - f).collect()).collect::<Matrix>();
            [friction, rest].concat()
        };
        for k in 0..(10 * n as u64 + 20) {
            let state = random::state(n, 77_000 + k);
            let y = self.robot.call("regressor", &arguments(&state, &[]));
            let of_unit = |pi: Vec<f64>| self.robot.call("friction_with", &arguments(&state, &pi));
            base.extend(apart(y.chunks(count).map(<[f64]>::to_vec).collect(), units(count).map(of_unit).collect()));
            let of_unit = |pi: Vec<f64>| self.model.with_standard_parameters(&pi).friction(&state.dq);
            let y = self.model.standard_regressor(&state.q, &state.dq, &state.dqr, &state.ddqr).y;
            standard.extend(apart(y, units(standards).map(of_unit).collect()));
        }
        let both: Matrix = base.iter().zip(&standard).map(|(b, s)| [b.as_slice(), s].concat()).collect();
        let (rank_of_base, rank_of_standard, rank_of_both) = (rank(&base), rank(&standard), rank(&both));
        let found = (rank_of_base, rank_of_standard, rank_of_both);
        assert_eq!(found, (count, count, count), "{}: ranks of base, standard, both", self.what);
    }

    /// The `_with` forms at random parameters.
    fn judge_parameters(&self) {
        let mut random = Random::new(self.seed ^ 0x0070_6900);
        let nominal = self.robot.nominal();
        // Random parameters of nominal size, some with the opposite sign: the equations are linear in all parameters.
        let pi: Vec<f64> = nominal
            .iter()
            .map(|x| match x {
                0.0 => random.real(-0.1, 0.1),
                x => x * random.real(0.5, 1.5) * if random.chance(20) { -1.0 } else { 1.0 },
            })
            .collect();
        let a = arguments(&random::state(self.robot.dof(), self.seed + 500), &pi);
        if let Some(model) = self.model_at(&pi) {
            self.expect_values(true, &model, &a);
        }
        self.judge_identities(&a);

        // B has to stay positive definite for its factors, so all parameters grow by similar factors.
        let pi: Vec<f64> = nominal.iter().map(|x| x * 1.3 * random.real(1.0, 1.0 + NEAR_NOMINAL)).collect();
        let near = Arguments { pi: pi.clone(), ..a };
        match self.model_at(&pi) {
            Some(model) => self.expect_forward_dynamics("forward_dynamics_with", &model, near),
            None => {
                let near = Arguments { tau: self.robot.call("inverse_dynamics_with", &near), ..near };
                let found = self.robot.call("forward_dynamics_with", &near);
                let b = self.robot.call("inertia_matrix_with", &near);
                let rows: Matrix = b.chunks(self.robot.dof()).map(<[f64]>::to_vec).collect();
                let scale = near.tau.iter().fold(1.0f64, |m, x| m.max(x.abs()));
                let residual: Vec<f64> = times(&rows, &minus(&found, &near.ddq)).iter().map(|x| x / scale).collect();
                agree(
                    &format!("{}: forward_dynamics_with", self.what),
                    &residual,
                    &vec![0.0; residual.len()],
                    self.tolerance.residual,
                );
            }
        }
    }

    /// The oracle's model at other parameters; `None` for base parameters.
    fn model_at(&self, pi: &[f64]) -> Option<Model> {
        match self.description.regressor_choice() {
            RegressorChoice::Base => None,
            RegressorChoice::Standard => Some(self.model.with_standard_parameters(pi)),
            RegressorChoice::Names(names) => {
                let values: Vec<(&str, f64)> = names.iter().map(String::as_str).zip(pi.iter().copied()).collect();
                Some(self.description.model_with(&values).unwrap_or_else(|error| panic!("{}: {error}", self.what)))
            }
        }
    }

    /// The `_with` forms against the regressor, by linearity.
    fn judge_identities(&self, a: &Arguments) {
        let n = self.robot.dof();
        let call = |function: &str| self.robot.call(function, a);
        let rest = vec![0.0; n];
        let tau = |dq: &[f64], dqr: &[f64], ddqr: &[f64]| {
            let a = Arguments { dq: dq.to_vec(), dqr: dqr.to_vec(), ddqr: ddqr.to_vec(), ..a.clone() };
            self.torque(&a, &a.pi)
        };
        let (b, c) = (call("inertia_matrix_with"), call("coriolis_matrix_with"));
        let still = tau(&rest, &rest, &rest);
        let friction = |dq: Vec<f64>| self.robot.call("friction_with", &Arguments { dq, ..a.clone() });
        let offset = friction(rest.clone());
        self.check("g_with by Y", &call("gravity_with"), &minus(&still, &offset));
        let coulomb = minus(&tau(&a.dq, &rest, &rest), &still);
        let (mut viscous, mut cubic) = (vec![0.0; n], vec![0.0; n]);
        for j in 0..n {
            // Rounded to the scale of tau, whatever is subtracted.
            let with_gravity: Vec<f64> = column(&b, n, j).iter().zip(&still).map(|(b, g)| b + g).collect();
            self.check("B_with by Y", &tau(&rest, &rest, &unit(n, j, 1.0)), &with_gravity);
            // At x, 2 x and 3 x Stribeck friction has faded, so F is F_v x + F_3 x³ plus a constant.
            let x = 16.0;
            let [one, two, three] = [1.0, 2.0, 3.0].map(|times| friction(unit(n, j, times * x))[j]);
            let second = (three - two) - (two - one);
            (viscous[j], cubic[j]) = ((two - one - second * 7.0 / 12.0) / x, second / (12.0 * x * x * x));
            let sum: Vec<f64> = (0..n)
                .map(|i| {
                    c[i * n + j] + if i == j { viscous[j] + cubic[j] * a.dq[j] * a.dq[j] } else { 0.0 } + coulomb[i] + still[i]
                })
                .collect();
            self.check("C_with by Y", &tau(&a.dq, &unit(n, j, 1.0), &rest), &sum);
        }
        let both: Vec<f64> =
            (0..n).map(|i| (viscous[i] + cubic[i] * a.dq[i] * a.dq[i]) * a.dq[i] + coulomb[i] + offset[i]).collect();
        self.check("friction_with by Y", &call("friction_with"), &both);
        let whole = call("inverse_dynamics_with");
        self.check("tau_with by Y", &self.without_load_friction("load_friction_with", a, &whole), &tau(&a.dq, &a.dq, &a.ddq));
        let rows: Matrix = b.chunks(n).map(<[f64]>::to_vec).collect();
        self.check("T_with", &call("kinetic_energy_with"), &[0.5 * dot(&a.dq, &times(&rows, &a.dq))]);
        let parts = [b, c, call("gravity_with")].concat();
        self.check("equations_of_motion_with", &call("equations_of_motion_with"), &parts);

        // Gauss-Legendre with five points along a short straight line: exact to rounding.
        let step: Vec<f64> = a.dq.iter().map(|v| 0.02 * v).collect();
        let at = |s: f64| Arguments { q: a.q.iter().zip(&step).map(|(q, d)| q + s * d).collect(), ..a.clone() };
        let (inner, outer) =
            ((5.0 - 2.0 * (10.0f64 / 7.0).sqrt()).sqrt() / 3.0, (5.0 + 2.0 * (10.0f64 / 7.0).sqrt()).sqrt() / 3.0);
        let (near, far) = ((322.0 + 13.0 * 70.0f64.sqrt()) / 900.0, (322.0 - 13.0 * 70.0f64.sqrt()) / 900.0);
        let points = [(0.0, 128.0 / 225.0), (inner, near), (-inner, near), (outer, far), (-outer, far)];
        let work: f64 = points
            .iter()
            .map(|(x, weight)| 0.5 * weight * dot(&self.robot.call("gravity_with", &at(0.5 + 0.5 * x)), &step))
            .sum();
        let u = |s: f64| self.robot.call("potential_energy_with", &at(s))[0];
        self.check("U_with by g", &[u(1.0)], &[u(0.0) + work]);
    }
}
