//! Planned motions: limits at random times, proofs that refuse what leaves the limits between samples, determinism, joins.

use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::{self, Options as Chosen, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};
use armgen_identify::arm::Arm;
use armgen_identify::excite::options::{self, Options};
use armgen_identify::excite::{excite, prove, Code, Course, Excitation, Fault, Kind, LeadIn, Limits, Motion, TOOL};
use armgen_identify::log::read;

use crate::arms::{arm, format, Random, ELBOW};

/// The elbow with all limits.
fn limited() -> String {
    let limits = ", position: [-2.5, 2.5], velocity: 2, acceleration: 8}";
    ELBOW.replace("{effort: 400}", &format!("{{effort: 400{limits}")).replace("{effort: 200}", &format!("{{effort: 120{limits}"))
}

fn manipulator(text: &str) -> Manipulator {
    validate::read(&Source::new("arm", text)).0.expect("a valid arm").0
}

fn planned(text: &str, options: &Options) -> Result<Excitation, Vec<Fault>> {
    let of = manipulator(text);
    excite(&of, &Arm::new(&of, false).expect("it has mass"), options, &|| {})
}

/// The largest share of each limit at times of a course: position, rate, acceleration, effort; and heights of the tool.
fn at_times(of: &Manipulator, limits: &Limits, course: &dyn Course, times: &[f64]) -> ([f64; 4], [f64; 2]) {
    let n = of.dof();
    let module = schedule::module(
        &Model::new(of.clone()),
        &Chosen { functions: Selection::named(["inverse_dynamics", "direct_kinematics"]).expect("names"), ..Chosen::default() },
    );
    let programs = armgen_evaluate::programs::<f64>(&module);
    let named = |name: &str| programs.iter().find(|program| program.name() == name).expect("it was asked for");
    let mut x: [Vec<f64>; 3] = Default::default();
    for t in times {
        for joint in 0..n {
            let at = course.at(joint, *t);
            (0..3).for_each(|d| x[d].push(at[d]));
        }
    }
    let (mut tau, mut frames) = (vec![0.0; x[0].len()], vec![0.0; 16 * times.len()]);
    let (torque, frame) = (named("inverse_dynamics"), named("direct_kinematics"));
    torque.run(&[&x[0], &x[1], &x[2]], &mut tau, &mut torque.workspace()).expect("states");
    frame.run(&[&x[0]], &mut frames, &mut frame.workspace()).expect("states");
    let mut shares = [0.0f64; 4];
    for k in 0..x[0].len() {
        let j = k % n;
        let [low, high] = limits.position[j];
        let of = [
            (x[0][k] - (low + high) / 2.0) / ((high - low) / 2.0),
            x[1][k] / limits.velocity[j],
            x[2][k] / limits.acceleration[j],
            tau[k] / limits.effort[j],
        ];
        (0..4).for_each(|i| shares[i] = shares[i].max(of[i].abs()));
    }
    let heights = frames.chunks_exact(16).map(|t| t[11]);
    (shares, heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| [a.min(z), b.max(z)]))
}

fn random_times(duration: f64, count: usize) -> Vec<f64> {
    let mut random = Random(11);
    (0..count).map(|_| random.within(0.0, duration)).collect()
}

/// At a hundred thousand random times no limit is exceeded, and the limits are used.
#[test]
#[ignore = "wide"]
fn limits_hold_at_random_times_of_motion_and_lead_in() {
    let text = limited();
    let of = manipulator(&text);
    let options = Options { box_: [None, None, Some([0.0, 0.9])], start: vec![("shoulder".into(), 0.4)], ..Options::default() };
    let found = planned(&text, &options).expect("a motion");
    let (shares, heights) = at_times(&of, &found.limits, &found.motion, &random_times(10.0, 100_000));
    assert!(shares.iter().all(|share| *share <= 1.0), "{shares:?}");
    assert!(heights[0] >= 0.0 && heights[1] <= 0.9, "{heights:?}");
    assert!(shares[1] > 0.99, "a motion that uses little of the limits: {shares:?}");
    let (shares, heights) = at_times(&of, &found.limits, &found.lead_in, &random_times(found.lead_in.duration, 20_000));
    assert!(shares.iter().all(|share| *share <= 1.0), "{shares:?}");
    assert!(heights[0] >= 0.0 && heights[1] <= 0.9, "{heights:?}");
    // Margins are proved: what is left at samples is never less.
    for margin in &found.proof.margins {
        assert!((0.0..1.0).contains(&margin.margin), "{margin:?}");
    }
    assert_eq!(found.proof.margins.len(), 4 * 3 + 1);
    assert!(found.unknowns > 10 && (1.0..1e6).contains(&found.condition), "{} {}", found.unknowns, found.condition);
    assert!(found.log_det_per_parameter.is_finite());
}

/// Motion and lead-in join with q, dq and ddq; the motion repeats itself.
#[test]
fn the_lead_in_joins_twice_continuously() {
    let found = planned(&limited(), &Options::default()).expect("a motion");
    let (lead, motion) = (&found.lead_in, &found.motion);
    for joint in 0..3 {
        let (rest, end, start) = (lead.at(joint, 0.0), lead.at(joint, lead.duration), motion.at(joint, 0.0));
        let again = motion.at(joint, motion.duration());
        for d in 0..3 {
            assert!((end[d] - start[d]).abs() < 1e-12, "joint {joint}, derivative {d}: {} and {}", end[d], start[d]);
            assert!((again[d] - start[d]).abs() < 1e-11, "joint {joint}, derivative {d}");
            assert_eq!(rest[d], if d == 0 { lead.from[joint] } else { 0.0 });
        }
        // Derivatives of both are those of q.
        let h = 1e-5;
        let courses: [(&dyn Course, f64); 2] = [(lead, 0.4 * lead.duration), (motion, 3.3)];
        for (course, t) in courses {
            let [before, at, after] = [t - h, t, t + h].map(|t| course.at(joint, t));
            for d in 0..3 {
                let slope = (after[d] - before[d]) / (2.0 * h);
                assert!((slope - at[d + 1]).abs() < 1e-6 * (1.0 + slope.abs()), "{slope} {:?}", at);
            }
        }
    }
}

#[test]
#[ignore = "wide"]
fn the_same_options_give_the_same_files_and_another_seed_others() {
    let text = limited();
    let options = Options { harmonics: 3, ..Options::default() };
    let [a, b] = [0, 1].map(|_| planned(&text, &options).expect("a motion"));
    assert_eq!((a.csv(50.0), a.yaml(), a.certificate()), (b.csv(50.0), b.yaml(), b.certificate()));
    let other = planned(&text, &Options { seed: 2, ..options }).expect("a motion");
    assert_ne!(a.yaml(), other.yaml());
    // The samples begin at rest and end where the motion began.
    let rows: Vec<String> = a.csv(100.0).lines().map(str::to_owned).collect();
    assert_eq!(rows[0], "t,q_base,q_shoulder,q_elbow,dq_base,dq_shoulder,dq_elbow,ddq_base,ddq_shoulder,ddq_elbow");
    assert_eq!(rows.len() - 2, ((10.0 + a.lead_in.duration) * 100.0).round() as usize);
}

/// A motion that exceeds a limit between samples alone, by little, is refuted at its limit.
#[test]
fn an_overshoot_between_samples_is_refuted() {
    let text = limited();
    let of = manipulator(&text);
    let arm = Arm::new(&of, false).expect("it has mass");
    let found = planned(&text, &Options { harmonics: 3, ..Options::default() }).expect("a motion");
    let proved = |limits: &Limits, motion: &Motion| prove(&of, &arm, limits, motion);
    assert!(proved(&found.limits, &found.motion).is_ok());
    let times = random_times(10.0, 50_000);
    let (shares, _) = at_times(&of, &found.limits, &found.motion, &times);
    for (k, share) in shares.into_iter().enumerate() {
        // Limits so low that the motion exceeds the worst by a thousandth.
        let by = share / 1.001;
        let mut limits = found.limits.clone();
        match k {
            0 => limits.position.iter_mut().for_each(|both| *both = both.map(|x| x * by)),
            1 => limits.velocity.iter_mut().for_each(|x| *x *= by),
            2 => limits.acceleration.iter_mut().for_each(|x| *x *= by),
            _ => limits.effort.iter_mut().for_each(|x| *x *= by),
        }
        let refuted = proved(&limits, &found.motion).expect_err("the limit is exceeded");
        let is_kind = match refuted.kind {
            Kind::Position(_) => k == 0,
            Kind::Velocity(_) => k == 1,
            Kind::Acceleration(_) => k == 2,
            Kind::Effort(_) => k == 3,
            Kind::Box(_) => false,
        };
        assert!(is_kind && refuted.excess > 0.0 && refuted.excess < 2e-3, "{k}: {refuted:?}");
    }
    // cos(H w t) is 1 between four samples of its period that are all ±1/sqrt 2.
    let single = Motion { w: 1.0, q0: vec![0.0], a: vec![vec![0.0, 1.0]], b: vec![vec![0.0, 0.0]] };
    let samples = 8;
    let sampled = (0..samples).map(|k| single.at(0, (k as f64 + 0.5) * single.duration() / samples as f64)[1].abs());
    assert!(sampled.fold(0.0, f64::max) < 0.71);
    assert!(single.largest(0, 1, 0.0, samples) >= 1.0);
}

fn codes(of: Result<Excitation, Vec<Fault>>) -> Vec<Code> {
    of.expect_err("there is no motion").iter().map(|fault| fault.code).collect()
}

#[test]
fn faults_have_reasons_and_remedies() {
    assert_eq!(codes(planned(ELBOW, &Options::default())), [Code::MissingLimit; 3]);
    let text = limited();
    let start = vec![("shoulder".to_owned(), 3.0), ("wrist".to_owned(), 0.0)];
    let found = planned(&text, &Options { start, ..Options::default() });
    assert_eq!(codes(found), [Code::InfeasibleStart, Code::UnknownJoint]);
    let frames = vec!["elbow".to_owned(), "hand".to_owned(), TOOL.to_owned()];
    assert_eq!(codes(planned(&text, &Options { frames, ..Options::default() })), [Code::UnknownFrame]);
    // The arm cannot hold itself.
    let weak = text.replace("effort: 400", "effort: 5");
    let faults = planned(&weak, &Options::default()).expect_err("too weak");
    assert_eq!(faults[0].code, Code::InfeasibleStart);
    assert!(faults[0].text.contains("the limit of effort of joint `shoulder`"), "{}", faults[0]);
    // A start that is above the box.
    let options = Options { box_: [None, None, Some([-0.3, 0.2])], start: vec![("shoulder".into(), 1.5)], ..Options::default() };
    assert_eq!(codes(planned(&text, &options)), [Code::InfeasibleStart]);
}

#[test]
fn options_name_their_faults() {
    let text = "start: {elbow: deg(90)}\nbox: {z: [1.5, 0.1], x: [0, 1]}\nframes: [elbow]\nseed: -1\nboxx: 1\n";
    let (read, diagnostics) = options::read(&Source::new("excite.yaml", text));
    assert_eq!(read.start, [("elbow".to_owned(), std::f64::consts::FRAC_PI_2)]);
    assert_eq!((read.box_[0], read.frames), (Some([0.0, 1.0]), vec!["elbow".to_owned()]));
    let found: Vec<String> = diagnostics.iter().map(|of| of.code.name().to_owned()).collect();
    assert_eq!(found, ["out-of-range", "out-of-range", "unknown-key"]);
}

/// Without noise a simulated log has the torques of the arm; noise has the size and the memory that are asked for.
#[test]
fn a_simulated_log_is_that_of_the_arm() {
    let text = limited();
    let (of, arm) = (manipulator(&text), arm(&text));
    let wave = |by: f64| (0..3).map(|joint| vec![by, -0.5 * by + 0.1 * f64::from(joint)]).collect::<Vec<_>>();
    let motion = Motion { w: 0.6, q0: vec![0.1, -0.4, 0.7], a: wave(0.8), b: wave(-0.3) };
    let names = arm.joints.iter().map(|joint| joint.name.clone()).collect();
    let lead_in = LeadIn { duration: 1.0, from: vec![0.0; 3], to: (0..3).map(|joint| motion.at(joint, 0.0)[0]).collect() };
    let plan = Excitation { joints: names, slides: vec![false; 3], motion, lead_in, ..Excitation::default() };
    let signals = |noise: f64, seed: u64| {
        let text = plan.simulated(&of, 100.0, noise, seed).expect("the same joints");
        let (log, findings) = read("log.csv", text.as_bytes(), &format(&arm));
        assert!(!findings.has_errors(), "{}", findings.render());
        log
    };
    let exact = signals(0.0, 1);
    // With friction taken out, torques are those of the regressor, which shares nothing with inverse dynamics.
    let samples = exact.t.len();
    assert_eq!(samples, 1 + (100.0 * (1.0 + plan.motion.duration()) + 1e-9) as usize);
    let state = |of: &[Vec<f64>]| (0..samples).flat_map(|k| of.iter().map(move |of| of[k])).collect::<Vec<f64>>();
    let (q, dq) = (state(&exact.q), state(exact.dq.as_ref().expect("rates")));
    let ddq: Vec<f64> = (0..samples)
        .flat_map(|k| {
            let t = k as f64 / 100.0;
            let plan = &plan;
            (0..3).map(move |j| if t < 1.0 { plan.lead_in.at(j, t)[2] } else { plan.motion.at(j, t - 1.0)[2] })
        })
        .collect();
    let pi = &arm.combination * arm.nominal();
    let rigid = arm.torque(&q, &dq, &ddq, pi.as_slice());
    let gravity = arm.gravity(&q, pi.as_slice());
    for (k, tau) in state(&exact.effort).into_iter().enumerate() {
        let of: [f64; 6] = arm.joints[k % 3].friction.map(Option::unwrap_or_default);
        let sign = if dq[k] == 0.0 { 0.0 } else { dq[k].signum() };
        let friction = of[0] * dq[k] + sign * (of[1] + of[3] * gravity[k].abs()) + of[2];
        let expected = rigid[k] + friction;
        assert!((tau - expected).abs() < 1e-4, "{k}: {tau} and not {expected}");
    }
    let noisy = signals(2.0, 1);
    for j in 0..3 {
        let noise: Vec<f64> = noisy.effort[j].iter().zip(&exact.effort[j]).map(|(a, b)| a - b).collect();
        let size = (noise.iter().map(|x| x * x).sum::<f64>() / exact.effort[j].iter().map(|x| x * x).sum::<f64>()).sqrt();
        let next: f64 = noise.windows(2).map(|x| x[0] * x[1]).sum();
        let memory = next / noise.iter().map(|x| x * x).sum::<f64>();
        assert!((size - 0.02).abs() < 0.004 && (memory - 2.0 / 3.0).abs() < 0.1, "joint {j}: {size}, {memory}");
        assert!(noisy.q[j].iter().all(|q| ((q / 2e-5).round() - q / 2e-5).abs() < 1e-2));
    }
    assert_ne!(noisy.effort, signals(2.0, 2).effort);
    let others = manipulator(&text.replace("name: elbow, type", "name: wrist, type"));
    assert_eq!(plan.simulated(&others, 100.0, 2.0, 1).expect_err("another joint").code, Code::UnknownJoint);
}
