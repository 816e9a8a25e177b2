// What is the same in the test file of every robot: everything after the line BEGIN is taken in as it stands.
// BEGIN
/// Arguments of the functions.
#[derive(Clone, Copy, Debug)]
struct Arguments {
    q: [Real; DOF],
    dq: [Real; DOF],
    ddq: [Real; DOF],
    dqr: [Real; DOF],
    ddqr: [Real; DOF],
    tau: [Real; DOF],
    pi: [Real; PARAMETERS],
    g0: [Real; 3], // with gravity as an argument
}

/// All entries in a row.
trait Flat {
    fn flat(&self) -> Vec<Real>;
}

impl Flat for Real {
    fn flat(&self) -> Vec<Real> {
        vec![*self]
    }
}

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flat(&self) -> Vec<Real> {
        self.iter().flat_map(Flat::flat).collect()
    }
}

impl Flat for EquationsOfMotion {
    fn flat(&self) -> Vec<Real> {
        [self.inertia.flat(), self.coriolis.flat(), self.gravity.flat()].concat()
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn flat(&self) -> Vec<Real> {
        [self.0.flat(), self.1.flat()].concat()
    }
}

impl<A: Flat, B: Flat, C: Flat> Flat for (A, B, C) {
    fn flat(&self) -> Vec<Real> {
        [self.0.flat(), self.1.flat(), self.2.flat()].concat()
    }
}

/// Largest of 1 and the sizes of some entries.
fn scale(entries: &[Real]) -> Real {
    entries.iter().fold(1.0, |scale, e| scale.max(e.abs()))
}

/// Largest difference over the scale; not a number if any entry is none.
fn deviation(found: &[Real], expected: &[Real]) -> Real {
    assert_eq!(found.len(), expected.len());
    let scale = scale(expected);
    let differences = found.iter().zip(expected).map(|(a, b)| (a - b).abs() / scale);
    differences.fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

#[track_caller]
fn agree(what: &str, found: &[Real], expected: &[Real], tolerance: Real) {
    let deviation = deviation(found, expected);
    assert!(deviation <= tolerance, "{what}: deviates by {deviation:e}, allowed {tolerance:e}\n{found:?}\n{expected:?}");
}

/// Some thousand roundings; forward dynamics is judged by its residual.
const ROUNDING: Real = 4096.0 * Real::EPSILON;
/// Differences of step cbrt(epsilon) have errors of about its square.
const DIFFERENCES: Real = 1e3 * STEP * STEP;
/// A power of two near the cube root of epsilon.
const STEP: Real = if Real::MANTISSA_DIGITS > 24 { 1.0 / 131_072.0 } else { 1.0 / 128.0 };

/// Acceleration of free fall of the identities. // with gravity as an argument
const FREE_FALL: [Real; 3] = [1.5, -2.25, 9.5]; // with gravity as an argument
 // with gravity as an argument
/// A row of random states: the same on every machine.
fn random_states() -> Vec<Arguments> {
    let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
    let mut uniform = move |size: Real| {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((bits >> 40) as Real / 8_388_608.0 - 1.0) * size
    };
    let state = |_| Arguments {
        q: core::array::from_fn(|_| uniform(3.0)),
        dq: core::array::from_fn(|_| uniform(2.0)),
        ddq: core::array::from_fn(|_| uniform(4.0)),
        dqr: core::array::from_fn(|_| uniform(2.0)),
        ddqr: core::array::from_fn(|_| uniform(4.0)),
        tau: core::array::from_fn(|_| uniform(20.0)),
        pi: NOMINAL_PARAMETERS,
        g0: FREE_FALL, // with gravity as an argument
    };
    (0..50).map(state).collect()
}

fn times(m: &[[Real; DOF]; DOF], v: &[Real; DOF]) -> [Real; DOF] {
    core::array::from_fn(|i| dot(&m[i], v))
}

fn dot<const N: usize>(a: &[Real; N], b: &[Real; N]) -> Real {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// q + t dq.
fn moved(q: &[Real; DOF], dq: &[Real; DOF], t: Real) -> [Real; DOF] {
    core::array::from_fn(|i| q[i] + t * dq[i])
}

#[test]
fn functions_have_the_values_of_the_equations() {
    for (name, state, found, expected) in values() {
        // An inverse loses what the condition of its matrix takes.
        let inverse = name == "operational_inertia" || name.starts_with("forward_dynamics");
        agree(&format!("{name} at state {state}"), &found, &expected, if inverse { 256.0 } else { 1.0 } * ROUNDING);
    }
}

#[test]
fn forward_dynamics_solves_the_equation_of_motion() {
    for s in random_states().into_iter().chain(STATES) {
        let tau = inverse_dynamics(&s.q, &s.dq, &forward_dynamics(&s.q, &s.dq, &s.tau));
        // Each torque is a sum of terms that may be far larger than it.
        let terms = times(&inertia_matrix(&s.q), &forward_dynamics(&s.q, &s.dq, &s.tau));
        agree("tau", &tau, &s.tau, ROUNDING * scale(&terms));
    }
}

#[test]
fn the_inertia_matrix_is_symmetric_and_positive_definite() {
    for s in random_states() {
        let b = inertia_matrix(&s.q);
        // Cholesky: B = L L'.
        let mut l = [[0.0 as Real; DOF]; DOF];
        for i in 0..DOF {
            for j in 0..=i {
                assert_eq!(b[i][j], b[j][i], "B is symmetric to the last bit");
                let rest = b[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<Real>();
                l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
            }
            assert!(l[i][i] > 0.0, "B is positive definite at {:?}", s.q);
        }
    }
}

#[test]
fn inertia_rates_minus_twice_coriolis_are_skew() {
    for s in random_states() {
        let (before, after) = (inertia_matrix(&moved(&s.q, &s.dq, -STEP)), inertia_matrix(&moved(&s.q, &s.dq, STEP)));
        let c = coriolis_matrix(&s.q, &s.dq);
        let skew = |i: usize, j: usize| (after[i][j] - before[i][j]) / (2.0 * STEP) - 2.0 * c[i][j];
        let tolerance = DIFFERENCES * scale(&inertia_matrix(&s.q).flat());
        for i in 0..DOF {
            for j in 0..=i {
                let sum = skew(i, j) + skew(j, i);
                assert!(sum.abs() <= tolerance, "entry [{i}][{j}]: {sum:e}, allowed {tolerance:e}");
            }
        }
    }
}

#[test]
fn torques_are_those_of_the_matrices_and_of_the_regressor() {
    for s in random_states() {
        let (b, c, g) = (inertia_matrix(&s.q), coriolis_matrix(&s.q, &s.dq), gravity(&s.q));
        let together = equations_of_motion(&s.q, &s.dq);
        agree("equations_of_motion", &together.flat(), &[b.flat(), c.flat(), g.flat()].concat(), ROUNDING);
        let (inertial, centrifugal, f) = (times(&b, &s.ddq), times(&c, &s.dq), friction(&s.dq));
        let load = load_friction(&s.q, &s.dq); // with load friction
        let f: [Real; DOF] = core::array::from_fn(|i| f[i] + load[i]); // with load friction
        let sum: [Real; DOF] = core::array::from_fn(|i| inertial[i] + centrifugal[i] + f[i] + g[i]);
        let tau = inverse_dynamics(&s.q, &s.dq, &s.ddq);
        agree("inverse_dynamics", &tau, &sum, ROUNDING);
        let y = regressor(&s.q, &s.dq, &s.dq, &s.ddq);
        let known = known_torque(&s.q, &s.dq, &s.dq, &s.ddq);
        let by_parameters: [Real; DOF] = core::array::from_fn(|i| dot(&y[i], &NOMINAL_PARAMETERS) + known[i]);
        let by_parameters: [Real; DOF] = core::array::from_fn(|i| by_parameters[i] + load[i]); // with load friction
        agree("Y pi + tau_known", &by_parameters, &tau, ROUNDING * scale(&NOMINAL_PARAMETERS).max(scale(&y.flat())));
    }
}

#[test]
fn functions_at_run_time_parameters_are_the_plain_ones_at_the_nominal_parameters() {
    for s in random_states() {
        let pi = &s.pi;
        agree("inertia_matrix_with", &inertia_matrix_with(pi, &s.q).flat(), &inertia_matrix(&s.q).flat(), ROUNDING);
        let (c, with) = (coriolis_matrix(&s.q, &s.dq), coriolis_matrix_with(pi, &s.q, &s.dq));
        agree("coriolis_matrix_with", &with.flat(), &c.flat(), ROUNDING * scale(pi));
        agree("gravity_with", &gravity_with(pi, &s.q), &gravity(&s.q), ROUNDING * scale(pi));
        agree("friction_with", &friction_with(pi, &s.dq), &friction(&s.dq), ROUNDING);
        let (tau, with) = (inverse_dynamics(&s.q, &s.dq, &s.ddq), inverse_dynamics_with(pi, &s.q, &s.dq, &s.ddq));
        agree("inverse_dynamics_with", &with, &tau, ROUNDING * scale(pi));
    }
}

#[test]
fn energies_change_with_the_power_of_the_torques() {
    for s in random_states() {
        let twice = dot(&times(&inertia_matrix(&s.q), &s.dq), &s.dq);
        agree("kinetic_energy", &[2.0 * kinetic_energy(&s.q, &s.dq)], &[twice], ROUNDING);
        let g = gravity(&s.q);
        let size = scale(&[potential_energy(&s.q)]).max(scale(&g));
        for k in 0..DOF {
            let along: [Real; DOF] = core::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
            let (low, high) = (moved(&s.q, &along, -STEP), moved(&s.q, &along, STEP));
            let slope = (potential_energy(&high) - potential_energy(&low)) / (2.0 * STEP);
            assert!((slope - g[k]).abs() <= DIFFERENCES * size, "dU/dq{}: {slope}, g: {}", k + 1, g[k]);
        }
    }
}

#[test]
fn the_jacobian_is_the_slope_of_the_end_effector() {
    for s in random_states() {
        let j = geometric_jacobian(&s.q);
        let (low, high) = (direct_kinematics(&moved(&s.q, &s.dq, -STEP)), direct_kinematics(&moved(&s.q, &s.dq, STEP)));
        for row in 0..3 {
            let velocity = (high[row][3] - low[row][3]) / (2.0 * STEP);
            let expected = dot(&j[row], &s.dq);
            assert!((velocity - expected).abs() <= DIFFERENCES * scale(&j.flat()), "v[{row}]: {velocity}, J dq: {expected}");
        }
        let (low, high) = (geometric_jacobian(&moved(&s.q, &s.dq, -STEP)), geometric_jacobian(&moved(&s.q, &s.dq, STEP)));
        let slope: Vec<Real> = high.flat().iter().zip(low.flat()).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
        agree("geometric_jacobian_dot", &geometric_jacobian_dot(&s.q, &s.dq).flat(), &slope, DIFFERENCES * scale(&j.flat()));
    }
}

#[test]
fn parameters_have_their_places() {
    let places = PARAMETER_NAMES.map(parameter_index);
    assert_eq!(places, core::array::from_fn(Some));
    assert_eq!(parameter_index(""), None);
}
 // with a payload
/// Steiner: 2 kg at (1, 2, 3), about the origin. // with a payload
#[test] // with a payload
fn a_payload_has_its_parameters() { // with a payload
    let inertia = [[10.0, -1.0, -2.0], [-1.0, 20.0, -3.0], [-2.0, -3.0, 30.0]]; // with a payload
    let found = payload_parameters(2.0, &[1.0, 2.0, 3.0], &inertia); // with a payload
    assert_eq!(found, [2.0, 2.0, 4.0, 6.0, 36.0, -5.0, 40.0, -8.0, -15.0, 40.0]); // with a payload
} // with a payload
