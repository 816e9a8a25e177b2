//! The oracle judged: against stored values of another library, a closed form of the book, and the laws of mechanics.

use armgen_tests::oracle::{rank, times, Description, Matrix, Model};
use armgen_tests::precision::{agree, deviation, CHECK_STATE, DIFFERENCES, DUAL, FORWARD_RESIDUAL, REFERENCE};
use armgen_tests::random::{self, State};
use armgen_tests::reference::{description, reference, ROBOTS};
use armgen_tests::technical_project;

#[track_caller]
fn read(text: &str) -> Description {
    Description::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[track_caller]
fn model(text: &str) -> Model {
    read(text).model().unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn flat(m: &Matrix) -> Vec<f64> {
    m.concat()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

#[test]
fn agrees_with_the_reference_values() {
    for robot in ROBOTS {
        let description = read(&description(robot));
        let model = description.model().expect(robot);
        for (i, s) in reference(robot).samples.iter().enumerate() {
            let check =
                |what: &str, ours: &[f64], theirs: &[f64]| agree(&format!("{robot} sample {i} {what}"), ours, theirs, REFERENCE);
            let (q, dq) = (&s.q, &s.dq);
            check("T", &flat(&model.direct_kinematics(q)), &flat(&s.direct_kinematics));
            check("J", &flat(&model.geometric_jacobian(q)), &flat(&s.geometric_jacobian));
            check("B", &flat(&model.inertia_matrix(q)), &flat(&s.inertia_matrix));
            check("C", &flat(&model.coriolis_matrix(q, dq)), &flat(&s.coriolis_matrix));
            check("g", &model.gravity(q), &s.gravity);
            check("tau", &model.inverse_dynamics(q, dq, &s.ddq), &s.tau);
            let regressor = description.regressor(q, dq, dq, &s.ddq).expect("not base").expect(robot);
            check("Y", &flat(&regressor.y), &flat(&s.regressor));
            let ddq = model.forward_dynamics(q, dq, &s.tau).expect("regular");
            let residual = model.forward_residual(q, &ddq, &s.qdd_from_tau, &s.tau);
            assert!(residual <= FORWARD_RESIDUAL, "{robot} sample {i} forward dynamics: {residual:e}");
        }
    }
}

/// The two-link planar arm with rotors, the book, Sect. 7.3.2: distances a, l from the joints, rotor i on link i-1 at joint i.
#[test]
fn agrees_with_the_two_link_planar_arm_of_the_book() {
    let (a1, a2, l1, l2, ml1, ml2, il1, il2) = (0.8, 0.7, 0.35, 0.3, 12.0, 9.0, 1.1, 0.6);
    let (mm2, im1, im2, kr1, kr2) = (2.5, 0.012, 0.007, 90.0, -60.0);
    let g = 9.81;
    // The same arm by standard rows (frames at the links' ends) and by modified ones (frames at the joints, the end as tool).
    let standard = format!(
        "name: planar
convention: standard
gravity: [0, -{g}, 0]
joints:
- {{name: j1, type: revolute, a: {a1}, alpha: 0, d: 0, theta: 0,
   link: {{mass: {ml1}, com: [{l1} - {a1}, 0, 0], inertia: {{zz: {il1}}}}}, motor: {{ratio: {kr1}, inertia: {im1}, mass: 3}}}}
- {{name: j2, type: revolute, a: {a2}, alpha: 0, d: 0, theta: 0,
   link: {{mass: {ml2}, com: [{l2} - {a2}, 0, 0], inertia: {{zz: {il2}}}}}, motor: {{ratio: {kr2}, inertia: {im2}, mass: {mm2}}}}}
"
    );
    let modified = format!(
        "name: planar
convention: modified
gravity: [0, -{g}, 0]
joints:
- {{name: j1, type: revolute, a: 0, alpha: 0, d: 0, theta: 0,
   link: {{mass: {ml1}, com: [{l1}, 0, 0], inertia: {{zz: {il1}}}}}, motor: {{ratio: {kr1}, inertia: {im1}, mass: 3}}}}
- {{name: j2, type: revolute, a: {a1}, alpha: 0, d: 0, theta: 0, link: {{mass: {ml2}, com: [{l2}, 0, 0], inertia: {{zz: {il2}}}}},
   motor: {{ratio: {kr2}, inertia: {im2}, mass: {mm2}, position: [{a1}, 0, 0]}}}}
tool: {{xyz: [{a2}, 0, 0]}}
"
    );
    let (q, dq, ddq) = ([0.4, -1.3], [0.9, 1.7], [-2.0, 3.0]);
    let ((s1, c1), (s2, c2)) = (f64::sin_cos(q[0]), f64::sin_cos(q[1]));
    let (s12, c12) = (q[0] + q[1]).sin_cos();
    // The rotor of the book also turns about its own centre with the link: I_m2 enters b11 once, with k_r2 into b12.
    let b11 = il1 + ml1 * l1 * l1 + kr1 * kr1 * im1 + il2 + ml2 * (a1 * a1 + l2 * l2 + 2.0 * a1 * l2 * c2) + im2 + mm2 * a1 * a1;
    let b12 = il2 + ml2 * (l2 * l2 + a1 * l2 * c2) + kr2 * im2;
    let b22 = il2 + ml2 * l2 * l2 + kr2 * kr2 * im2;
    let h = -ml2 * a1 * l2 * s2;
    let g1 = (ml1 * l1 + mm2 * a1 + ml2 * a1) * g * c1 + ml2 * l2 * g * c12;
    let g2 = ml2 * l2 * g * c12;
    let tau1 = b11 * ddq[0] + b12 * ddq[1] + 2.0 * h * dq[0] * dq[1] + h * dq[1] * dq[1] + g1;
    let tau2 = b12 * ddq[0] + b22 * ddq[1] - h * dq[0] * dq[0] + g2;
    let p = [a1 * c1 + a2 * c12, a1 * s1 + a2 * s12];
    let u = g * (ml1 * l1 * s1 + mm2 * a1 * s1 + ml2 * (a1 * s1 + l2 * s12));
    for text in [standard, modified] {
        let arm = model(&text);
        agree("B", &flat(&arm.inertia_matrix(&q)), &[b11, b12, b12, b22], DUAL);
        agree("C", &flat(&arm.coriolis_matrix(&q, &dq)), &[h * dq[1], h * (dq[0] + dq[1]), -h * dq[0], 0.0], DUAL);
        agree("g", &arm.gravity(&q), &[g1, g2], DUAL);
        agree("tau", &arm.inverse_dynamics(&q, &dq, &ddq), &[tau1, tau2], DUAL);
        let t = [c12, -s12, 0.0, p[0], s12, c12, 0.0, p[1], 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        agree("T", &flat(&arm.direct_kinematics(&q)), &t, DUAL);
        agree("U", &[arm.potential_energy(&q)], &[u], DUAL);
    }
}

/// Rotors of an arm with crossed axes: the axis of a rotor by default and by choice, in both conventions.
#[test]
fn rotors_turn_about_the_axis_that_the_file_says() {
    let arm = |convention: &str, alphas: [&str; 2], axis: &str| {
        model(&format!(
            "{{name: crossed, convention: {convention}, gravity: [0, 0, 0], joints: [
            {{name: j1, type: revolute, a: 0, alpha: {}, d: 0, theta: 0, link: {{mass: 0, inertia: {{xx: 1, yy: 1, zz: 1}}}}}},
            {{name: j2, type: revolute, a: 0, alpha: {}, d: 0, theta: 0, link: {{mass: 0, inertia: {{xx: 1, yy: 1, zz: 1}}}},
              motor: {{ratio: 10, inertia: 0.25{axis}}}}}]}}",
            alphas[0], alphas[1]
        ))
    };
    // B = links + I_m (s, k)(s, k)', s = axis · z0 in link 1: joint axes at right angles for "pi/2", 60 degrees for "pi/3".
    let check = |arm: Model, between: f64, s: f64| {
        let links = [2.0, between.cos(), between.cos(), 1.0];
        let rotor = [s * s, s * 10.0, s * 10.0, 100.0].map(|x| 0.25 * x);
        agree("B", &flat(&arm.inertia_matrix(&[0.4, 0.9])), &sum(&links, &rotor), DUAL);
    };
    let (right, sixty) = (std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_3);
    check(arm("standard", ["pi/2", "0"], ""), right, 0.0);
    check(arm("modified", ["0", "pi/2"], ""), right, 0.0);
    check(arm("standard", ["pi/3", "0"], ""), sixty, 0.5);
    check(arm("modified", ["0", "pi/3"], ""), sixty, 0.5);
    // z of link 1's frame is the joint axis in standard rows, z0 in modified ones; and an axis need not have length 1.
    check(arm("standard", ["pi/3", "0"], ", axis: [0, 0, 1]"), sixty, 0.5);
    check(arm("modified", ["0", "pi/3"], ", axis: [0, 0, -7]"), sixty, -1.0);
    check(arm("modified", ["0", "pi/3"], ", axis: [0, 3, 4]"), sixty, 0.8);
}

/// The default axis of a rotor in modified rows, by its sign: axes 1 and 3 are antiparallel at q2 = 0, rotor 3 couples with -1.
#[test]
fn the_default_axis_is_the_joint_axis() {
    let joint = |i: usize, alpha: &str, rest: &str| {
        let inertia = "{xx: 1, yy: 1, zz: 1}";
        format!(
            "{{name: j{i}, type: revolute, a: 0, alpha: {alpha}, d: 0, theta: 0, link: {{mass: 0, inertia: {inertia}}}{rest}}}"
        )
    };
    let motor = ", motor: {ratio: 10, inertia: 0.25}";
    let joints = [joint(1, "0", ""), joint(2, "pi/2", ""), joint(3, "pi/2", motor)].join(", ");
    let arm = model(&format!("{{name: folded, convention: modified, gravity: [0, 0, 0], joints: [{joints}]}}"));
    let links = [3.0, 0.0, -1.0, 0.0, 2.0, 0.0, -1.0, 0.0, 1.0];
    let rotor = [1.0, 0.0, -10.0, 0.0, 0.0, 0.0, -10.0, 0.0, 100.0].map(|x| 0.25 * x);
    agree("B", &flat(&arm.inertia_matrix(&[0.4, 0.0, 0.9])), &sum(&links, &rotor), DUAL);
}

/// A load at a turned tool of a pendulum, in closed form: it lies at (0.3, 0.1) in the link frame.
#[test]
fn a_load_rides_in_the_end_effector_frame() {
    let arm = model(
        "{name: pendulum, convention: standard, gravity: [0, -9.81, 0],
        joints: [{name: j1, type: revolute, a: 0, alpha: 0, d: 0, theta: 0, link: {mass: 0, inertia: {zz: 1}}}],
        tool: {xyz: [0.3, 0, 0.2], rpy: [0, 0, pi/2]}, payload: {mass: 2, com: [0.1, 0, 0], inertia: {zz: 0.5}}}",
    );
    let q: f64 = 0.7;
    agree("B", &flat(&arm.inertia_matrix(&[q])), &[1.0 + 0.5 + 2.0 * (0.09 + 0.01)], DUAL);
    agree("g", &arm.gravity(&[q]), &[2.0 * 9.81 * (0.3 * q.cos() - 0.1 * q.sin())], DUAL);
}

/// The standard parameters in their order; only the rotors' mass is not among them.
#[test]
fn standard_parameters() {
    let arm = |name: &str| model(random::tricky().iter().find(|(other, _)| *other == name).expect("a tricky arm").1);
    let swing = arm("single_joint").standard_parameters();
    let zz = 0.036 + 1.2 * 0.3 * 0.3;
    agree("pi", &swing, &[1.2, -0.36, 0.0, 0.0, 0.0, 0.0, zz, 0.0, 0.0, zz, 1e-5, 2e-4, 0.01, 0.05], DUAL);

    let mut all = arm("everything");
    // Ten of five links and the load; joint 1: inertia, two frictions; 2: four; 3: inertia; 4: inertia, Coulomb; 5: inertia, rotor's friction.
    assert_eq!(all.standard_parameters().len(), 60 + 3 + 4 + 1 + 2 + 2);
    let State { q, dq, dqr, ddqr, .. } = random::state(5, 1);
    let known = |arm: &Model| arm.standard_regressor(&q, &dq, &dqr, &ddqr).known;
    assert!(known(&all).iter().any(|x| x.abs() > 0.1));
    all.joints.iter_mut().filter_map(|j| j.motor.as_mut()).for_each(|m| m.mass = 0.0);
    assert_eq!(known(&all), [0.0; 5]);
}

/// Laws that every arm obeys; `what` names the arm in a failure.
#[track_caller]
fn check_laws(what: &str, text: &str, state: &State) {
    let arm = model(text);
    let State { q, dq, ddq, dqr, ddqr } = state;
    let check = |law: &str, a: &[f64], b: &[f64]| agree(&format!("{what}: {law}\n{text}"), a, b, DUAL);

    let (b, c, g) = (arm.inertia_matrix(q), arm.coriolis_matrix(q, dq), arm.gravity(q));
    let n = arm.dof();
    let transposed: Matrix = (0..n).map(|i| (0..n).map(|j| b[j][i]).collect()).collect();
    check("B is symmetric", &flat(&b), &flat(&transposed));
    check("T = ½ dq' B dq", &[arm.kinetic_energy(q, dq)], &[0.5 * dot(dq, &times(&b, dq))]);
    check("g = dU/dq", &g, &arm.potential_gradient(q));
    let newton_euler = arm.with_springs(q, arm.newton_euler(q, dq, ddq, arm.gravity));
    check("NE = B ddq + C dq + g", &newton_euler, &sum(&sum(&times(&b, ddq), &times(&c, dq)), &g));
    check("C v by polarisation", &arm.coriolis_times(q, dq, dqr), &times(&c, dqr));
    check("power", &[arm.power(q, dq, ddq)], &[dot(dq, &newton_euler)]);

    // dB/dt - 2C is skew, for any velocity.
    let db = arm.inertia_matrix_derivatives(q);
    let n_matrix: Matrix =
        (0..n).map(|i| (0..n).map(|j| (0..n).map(|k| db[k][i][j] * dq[k]).sum::<f64>() - 2.0 * c[i][j]).collect()).collect();
    let opposite: Matrix = (0..n).map(|i| (0..n).map(|j| -n_matrix[j][i]).collect()).collect();
    check("dB/dt - 2C is skew", &flat(&n_matrix), &flat(&opposite));

    // The Jacobian two ways, its derivative by a central difference (h² and 1e-16 / h).
    let j = arm.geometric_jacobian(q);
    check("J", &flat(&j), &flat(&arm.geometric_jacobian_by_differentiation(q)));
    let h = 1e-5;
    let moved = |s: f64| flat(&arm.geometric_jacobian(&q.iter().zip(dq).map(|(q, v)| q + s * h * v).collect::<Vec<_>>()));
    let difference: Vec<f64> = moved(1.0).iter().zip(moved(-1.0)).map(|(a, b)| (a - b) / (2.0 * h)).collect();
    agree(&format!("{what}: dJ/dt"), &flat(&arm.geometric_jacobian_dot(q, dq)), &difference, 1e-7);
    let last = arm.link_frames(q).pop().expect("a joint");
    let (r, p) = (&arm.tool.0, &arm.tool.1);
    let tool = [
        vec![r[0][0], r[0][1], r[0][2], p[0]],
        vec![r[1][0], r[1][1], r[1][2], p[1]],
        vec![r[2][0], r[2][1], r[2][2], p[2]],
        vec![0.0, 0.0, 0.0, 1.0],
    ];
    let columns: Matrix = (0..4).map(|j| times(&last, &tool.iter().map(|row| row[j]).collect::<Vec<_>>())).collect();
    let product: Vec<f64> = (0..4).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
    check("T = T_n tool", &flat(&arm.direct_kinematics(q)), &product);

    // Y pi is the four-argument inverse dynamics.
    let tau_4 = arm.inverse_dynamics_4(q, dq, dqr, ddqr);
    let viscous: Vec<f64> = arm.viscous().iter().zip(dqr).map(|(f, v)| f * v).collect();
    let coulomb = sum(&arm.friction(dq), &arm.viscous().iter().zip(dq).map(|(f, v)| -f * v).collect::<Vec<_>>());
    // With cubic friction the four-argument form has the term F_3 dq² dqr.
    let cubic = arm.joints.iter().zip(dq).zip(dqr).map(|((joint, v), r)| joint.cubic.unwrap_or(0.0) * v * v * (r - v));
    let friction = sum(&sum(&viscous, &coulomb), &cubic.collect::<Vec<f64>>());
    let right = sum(&sum(&times(&b, ddqr), &times(&c, dqr)), &sum(&friction, &g));
    check("four arguments", &tau_4, &right);
    check("Y pi + known", &arm.standard_regressor(q, dq, dqr, ddqr).torque(), &tau_4);
    if let Some(regressor) = read(text).regressor(q, dq, dqr, ddqr) {
        check("Y pi + known, as the file wants", &regressor.expect(what).torque(), &tau_4);
    }

    let tau = arm.inverse_dynamics(q, dq, ddq);
    let back = arm.forward_dynamics(q, dq, &tau).unwrap_or_else(|| panic!("{what}: singular B\n{text}"));
    let residual = arm.forward_residual(q, &back, ddq, &tau);
    assert!(residual <= FORWARD_RESIDUAL, "{what}: forward dynamics {residual:e}");
    assert!((0..20).all(|k| arm.kinetic_energy(q, &random::state(n, 1000 + k).dq) > 0.0), "{what}: B is not positive\n{text}");
}

#[test]
#[ignore = "wide"]
fn random_arms_obey_the_laws() {
    for seed in 0..120 {
        let text = random::arm(seed);
        check_laws(&format!("seed {seed}"), &text, &random::state(model(&text).dof(), seed));
    }
}

#[test]
fn tricky_arms_obey_the_laws() {
    for (name, text) in random::tricky() {
        for seed in 0..5 {
            check_laws(name, text, &random::state(model(text).dof(), seed));
        }
    }
}

/// dtau/dq and dtau/d(dq) against central differences, on arms that have between them every force that depends on q or dq.
#[test]
fn derivatives_of_the_inverse_dynamics() {
    let file = |name: &str| std::fs::read_to_string(format!("{}/robots/{name}.yaml", env!("CARGO_MANIFEST_DIR"))).expect(name);
    let mut arms: Vec<(String, String)> = random::tricky().map(|(name, text)| (name.to_owned(), text.to_owned())).to_vec();
    arms.extend(["dry_friction", "load_friction"].map(|name| (name.to_owned(), file(name))));
    arms.extend((0..12).map(|seed| (format!("seed {seed}"), random::arm(seed))));
    arms.extend((0..12).map(|seed| (format!("posed seed {seed}"), random::posed_arm(seed))));
    let mut there = std::collections::BTreeSet::new();
    for (i, (name, text)) in arms.iter().enumerate() {
        let arm = model(text);
        for joint in &arm.joints {
            let has = [
                ("slide", joint.prismatic),
                ("rotor", joint.motor.is_some()),
                ("viscous", joint.viscous.is_some()),
                ("cubic", joint.cubic.is_some()),
                ("Stribeck", joint.stribeck.is_some()),
                ("load", joint.load != 0.0),
                ("spring", joint.stiffness.is_some()),
            ];
            there.extend(has.iter().filter(|(_, has)| *has).map(|(what, _)| *what));
        }
        let State { q, dq, ddq, .. } = random::state(arm.dof(), i as u64);
        let (by_q, by_dq) = arm.inverse_dynamics_derivatives(&q, &dq, &ddq);
        let h = 1e-5;
        for k in 0..arm.dof() {
            let at =
                |v: &[f64], s: f64| v.iter().enumerate().map(|(i, x)| if i == k { x + s * h } else { *x }).collect::<Vec<_>>();
            let difference = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * h)).collect::<Vec<_>>();
            let column = |m: &Matrix| m.iter().map(|row| row[k]).collect::<Vec<_>>();
            let tau = |q: &[f64], dq: &[f64]| arm.inverse_dynamics(q, dq, &ddq);
            let (to_q, to_dq) = ([at(&q, 1.0), at(&q, -1.0)], [at(&dq, 1.0), at(&dq, -1.0)]);
            agree(&format!("{name}: dtau/dq"), &column(&by_q), &difference(tau(&to_q[0], &dq), tau(&to_q[1], &dq)), DIFFERENCES);
            agree(
                &format!("{name}: dtau/d(dq)"),
                &column(&by_dq),
                &difference(tau(&q, &to_dq[0]), tau(&q, &to_dq[1])),
                DIFFERENCES,
            );
        }
    }
    assert_eq!(there.len(), 7, "{there:?}");
}

#[test]
fn agrees_with_the_check_state_of_the_technical_project() {
    let scara = read(technical_project::ROBOT);
    let state = technical_project::check_state();
    let (q, dq, ddq, dqr) = (&state.q[..], &state.dq[..], &state.ddq[..], &state.dqr[..]);
    let arm = scara.model().expect("valid");
    let check = |what: &str, ours: &[f64], given: &[f64]| agree(what, ours, given, CHECK_STATE);
    check("tau", &arm.inverse_dynamics(q, dq, ddq), &state.tau);
    check("four arguments", &arm.inverse_dynamics_4(q, dq, dqr, ddq), &state.y_pi);
    let regressor = scara.regressor(q, dq, dqr, ddq).expect("names").expect("parameters");
    check("Y pi", &regressor.torque(), &state.y_pi);
    check("nothing but pi", &regressor.known, &[0.0; 4]);
    let c = arm.coriolis_matrix(q, dq);
    check("C dq", &times(&c, dq), &state.c_dq);
    check("C dqr", &times(&c, dqr), &state.c_dqr);
    let t = arm.direct_kinematics(q);
    check("x_e", &[t[0][3], t[1][3], t[2][3], t[1][1].atan2(t[0][1])], &state.x_e);
    let drift = times(&arm.geometric_jacobian_dot(q, dq), dq);
    check("dJ/dt dq", &[drift[0], drift[1], drift[2], drift[5]], &state.j_dot_dq);
    let loaded = scara.model_with(&[("m_l3", 15.0)]).expect("a parameter");
    check("forward dynamics", &loaded.forward_dynamics(q, dq, &[0.0; 4]).expect("regular"), &state.ddq_loaded);
}

/// Ranks that are known: 11 of the 14 of the SCARA, 8 of its links' 40.
#[test]
fn ranks_of_stacked_regressors() {
    let scara = read(technical_project::ROBOT);
    let stacked = |f: &dyn Fn(&State) -> Matrix| -> usize {
        rank(&(0..30).flat_map(|seed| f(&random::state(4, seed))).collect::<Matrix>())
    };
    let named = |s: &State| scara.regressor(&s.q, &s.dq, &s.dqr, &s.ddqr).expect("names").expect("parameters").y;
    assert_eq!(stacked(&named), 11);
    let bare = model(&description("scara4"));
    assert_eq!(stacked(&|s: &State| bare.standard_regressor(&s.q, &s.dq, &s.dqr, &s.ddqr).y), 8);
}

/// A planted error is seen: each of these changes of a description moves the torque.
#[test]
fn planted_errors_are_seen() {
    let (name, text) = random::tricky()[0];
    let arm = model(text);
    let State { q, dq, ddq, .. } = random::state(arm.dof(), 1);
    let tau = arm.inverse_dynamics(&q, &dq, &ddq);
    let plant = |change: &dyn Fn(&mut Model)| {
        let mut changed = arm.clone();
        change(&mut changed);
        deviation(&changed.inverse_dynamics(&q, &dq, &ddq), &tau)
    };
    assert_eq!(plant(&|_| ()), 0.0);
    let changes: [(&str, &dyn Fn(&mut Model)); 8] = [
        ("convention", &|m| m.modified = !m.modified),
        ("gravity", &|m| m.gravity[2] += 1e-9),
        ("tool", &|m| m.tool.1[0] += 1e-9),
        ("payload", &|m| m.payload.iter_mut().for_each(|p| p[0] += 1e-9)),
        ("row", &|m| m.joints[1].row[1] += 1e-9),
        ("link", &|m| m.joints[2].link[6] += 1e-9),
        ("rotor axis", &|m| m.joints.iter_mut().filter_map(|j| j.motor.as_mut()).for_each(|m| m.axis[2] += 1e-6)),
        ("rotor inertia", &|m| m.joints.iter_mut().filter_map(|j| j.motor.as_mut()).for_each(|m| m.inertia = None)),
    ];
    for (what, change) in changes {
        let found = plant(change);
        assert!(found > DUAL, "{name}: a changed {what} moves tau by {found:e} only");
    }
}
