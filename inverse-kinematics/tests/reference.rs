//! The reference poses of tests/data: every solution found, none spurious, the verdicts as listed.

#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod double {
    use crate::common::Random;
    use armgen_inverse_kinematics::f64::*;

    #[allow(unreachable_pub, dead_code)]
    mod arm {
        use super::*;
        include!("common/arm.rs");
        include!("common/solver.rs");
        include!("common/files.rs");
    }
    use arm::*;

    fn verdict(found: &Branches<6, 16>) -> &'static str {
        if found.continuum || found.found().iter().any(|b| b.free != 0) {
            "Continuum"
        } else if found.near || found.found().iter().any(|b| b.double) {
            "NearDouble"
        } else if found.count > 0 {
            "Complete"
        } else {
            "Unreachable"
        }
    }

    fn difference(x: f64, y: f64) -> f64 {
        let d = (x - y).rem_euclid(std::f64::consts::TAU);
        d.min(std::f64::consts::TAU - d)
    }

    /// Checks every pose; `general` by block 8 whatever the arm's class is. Returns how many verdicts differ.
    fn check(name: &str, general: bool) {
        let reference = read(name);
        let mut fixed = None;
        let (mut missing, mut spurious, mut verdicts) = (vec![], vec![], vec![]);
        let (mut worst_t, mut worst_q) = (0.0f64, 0.0f64);
        for (number, pose) in reference.poses.iter().enumerate() {
            let arm = completed(&reference, pose);
            let n = arm.joints();
            // Constants of a locked joint differ from pose to pose.
            if fixed.is_none() || reference.given.is_some() {
                let plan = if general { Plan::General { ways: Box::new(general_ways(&arm, 40)) } } else { plan(&arm) };
                if number == 0 {
                    let text = format!("{plan:?}");
                    println!("{name}: {}", &text[..text.len().min(200)]);
                }
                fixed = Some(plan);
            }
            let found = solve(fixed.as_ref().unwrap(), &arm, &pose.t);
            assert!(found.count <= reference.most.max(found.found().iter().filter(|b| b.free != 0).count()) || general);
            let angles = |b: &Branch<6>| -> Vec<f64> {
                (0..n).map(|i| if arm.prismatic[i] { b.joints[i][0] } else { b.joints[i][1].atan2(b.joints[i][0]) }).collect()
            };
            let distance = |b: &Branch<6>, q: &[f64]| -> f64 {
                let q = q.iter().enumerate().filter(|(i, _)| Some(*i) != reference.given).map(|(_, q)| *q);
                angles(b)
                    .iter()
                    .zip(q)
                    .zip(&arm.prismatic)
                    .map(|((x, y), p)| if *p { (x - y).abs() } else { difference(*x, y) })
                    .fold(0.0, f64::max)
            };
            // Where a joint can move determinants may vanish, or have roots that lead nowhere: block 8 must not be sure of itself.
            if general && pose.kind == "continuum" {
                assert!(matches!(verdict(&found), "Continuum" | "NearDouble"), "{name} {number}: {}", verdict(&found));
                continue;
            }
            // Every listed solution is found.
            for (q, sigma) in &pose.solutions {
                let best = found.found().iter().map(|b| distance(b, q)).fold(f64::INFINITY, f64::min);
                if !(best < 1e-9f64.max(1e-11 / sigma)) {
                    missing.push((number, pose.kind.clone(), best, *sigma));
                } else {
                    worst_q = worst_q.max(best * sigma);
                }
            }
            // Every found one reaches; what is neither listed nor where two have met is one too many.
            for b in found.found() {
                let error = defect(&arm.forward(&b.joints[..n]), &pose.t);
                let error = if reference.planar { error.min(1.0) } else { error };
                if !b.double {
                    worst_t = worst_t.max(error);
                }
                let listed = pose.solutions.iter().any(|(q, _)| distance(b, q) < 1e-6);
                // Beside `met` other pairs may have met at the same pose.
                let met = b.double && pose.met.is_some();
                // At a pose with a continuum solutions that are hardly regular are not listed.
                let unlisted = met || b.free != 0 || pose.kind == "continuum";
                if !(error < 1e-9) || !(listed || unlisted) {
                    spurious.push((number, pose.kind.clone(), error, b.double));
                }
            }
            let said = verdict(&found);
            if let Some(q) = &pose.met {
                // Of four pairs that meet at once block 8 may list some only.
                assert!(
                    general || found.near || found.found().iter().any(|b| b.double && distance(b, q) < 1e-5),
                    "{name} {number}"
                );
            }
            if !pose.verdicts.iter().any(|v| v == said) {
                verdicts.push((number, pose.kind.clone(), pose.verdicts.clone(), said, found.count, pose.solutions.len()));
            }
            if said == "Unreachable" {
                assert!(found.miss > 0.0 && found.miss < 1e3, "{} {}", found.miss, pose.kind);
            }
        }
        println!("{name}: q right to {worst_q:.1e}/sigma, T to {worst_t:.1e}");
        assert!(
            missing.is_empty() && spurious.is_empty() && verdicts.is_empty(),
            "{name}: missing {missing:?}\nspurious {spurious:?}\nverdicts {verdicts:?}"
        );
    }

    #[test]
    fn scara() {
        check("scara4", false);
    }

    #[test]
    fn planar() {
        check("planar3r", false);
    }

    #[test]
    fn puma() {
        check("puma560", false);
    }

    #[test]
    fn stanford() {
        check("stanford", false);
    }

    #[test]
    fn ur5() {
        check("ur5", false);
    }

    #[test]
    fn panda() {
        check("panda7", false);
    }

    #[test]
    fn jaco() {
        check("jaco2", false);
    }

    #[test]
    fn general() {
        check("general6r", false);
    }

    /// Angles at random, or one of the kinds that make an arm special.
    fn alpha(random: &mut Random) -> f64 {
        let quarter = std::f64::consts::FRAC_PI_2;
        [quarter, -quarter, random.between(0.5, 2.5), random.between(-2.5, -0.5)][random.below(4)]
    }

    /// A row (theta, d, a, alpha) with these last two.
    fn made_up(random: &mut Random, a: f64, alpha: f64) -> (f64, f64, f64, f64) {
        (random.angle(), random.between(-0.4, 0.4), a, alpha)
    }

    /// A made-up arm of a class, with turned joints, base and tool.
    fn of_class(class: &str, random: &mut Random) -> Arm {
        let half = std::f64::consts::PI * random.below(2) as f64;
        let (mut rows, mut prismatic) = (vec![], vec![]);
        for _ in 0..6 {
            let (a, alpha) = (random_length(random), alpha(random));
            rows.push(made_up(random, a, alpha));
        }
        match class {
            "wrist, elbow" | "wrist, crossing" | "wrist, general" | "wrist on a slide" | "wrist on a middle slide" => {
                (rows[3].2, rows[4].2, rows[4].1) = (0.0, 0.0, 0.0);
                match class {
                    "wrist, elbow" => rows[1].3 = half,
                    "wrist, crossing" => rows[0].2 = 0.0,
                    "wrist on a slide" => prismatic = vec![0],
                    "wrist on a middle slide" => prismatic = vec![1],
                    _ => {}
                }
            }
            "shoulder" => {
                (rows[0].2, rows[1].2, rows[1].1) = (0.0, 0.0, 0.0);
                rows[3].3 = half;
            }
            "middle" => (rows[1].2, rows[2].2, rows[2].1) = (0.0, 0.0, 0.0),
            "parallel 2 3 4, like a UR" => (rows[1].3, rows[2].3, rows[4].2) = (half, 0.0, 0.0),
            "parallel 2 3 4" => (rows[1].3, rows[2].3) = (half, 0.0),
            "parallel 1 2 3" => (rows[0].3, rows[1].3) = (half, 0.0),
            "scara" => {
                rows.truncate(4);
                prismatic = vec![2];
                (rows[0].3, rows[1].3, rows[2].3, rows[3].3) = (0.0, half, 0.0, half);
                (rows[2].2, rows[2].0) = (0.0, 0.0);
            }
            _ => {}
        }
        let mut arm = Arm::standard(&rows, &prismatic);
        let row_of = |r: (f64, f64, f64, f64)| row(r.0, r.1, r.2, r.3);
        arm.c[0] = row_of(made_up(random, 0.2, 0.7));
        let tool = row_of(made_up(random, 0.1, -1.1));
        let last = arm.joints();
        arm.c[last] = compose(&arm.c[last], &tool);
        arm
    }

    fn random_length(random: &mut Random) -> f64 {
        random.between(0.1, 0.5) * [1.0, -1.0][random.below(2)]
    }

    /// 25 made-up arms of each class, 20 postures each: the original found, even counts; other constructions of the same arm agree.
    #[test]
    fn made_up_arms_of_each_class() {
        let classes = [
            ("wrist, elbow", "elbow", 8),
            ("wrist, crossing", "crossing", 8),
            ("wrist, general", "general", 8),
            ("wrist on a slide", "slide", 8),
            ("wrist on a middle slide", "slide between", 8),
            ("shoulder", "elbow", 8),
            ("middle", "general", 8),
            ("parallel 2 3 4, like a UR", "ThreeParallel", 8),
            ("parallel 2 3 4", "ThreeParallel", 8),
            ("parallel 1 2 3", "ThreeParallel", 8),
            ("scara", "slide between parallel axes", 2),
            ("general", "General", 16),
        ];
        for (number, (class, name, most)) in classes.into_iter().enumerate() {
            let random = &mut Random(1000 + number as u64);
            let (mut lost, mut odd, mut doubtful, mut largest, mut compared) = (0, 0, 0, 0, 0);
            for n in 0..25 {
                let arm = of_class(class, random);
                let plan = plan(&arm);
                assert!(format!("{plan:?}").contains(name), "{class}: {plan:?}");
                let other = (class.starts_with("parallel") && n % 5 == 0)
                    .then(|| Plan::General { ways: Box::new(general_ways(&arm, 20)) });
                for _ in 0..20 {
                    let q = arm.posture(random);
                    let t = arm.at(&q);
                    let mut values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
                    values.resize(6, [1.0, 0.0]);
                    let found = solve(&plan, &arm, &t);
                    largest = largest.max(found.count);
                    for b in found.found() {
                        assert!(defect(&arm.forward(&b.joints[..arm.joints()]), &t) < 1e-13, "{class}");
                    }
                    if verdict(&found) != "Complete" {
                        doubtful += 1;
                        continue;
                    }
                    let holds =
                        |found: &Branches<6, 16>, q: &[[Real; 2]]| found.found().iter().any(|b| apart(&b.joints, q) < 1e-6);
                    lost += usize::from(!holds(&found, &values));
                    odd += found.count % 2;
                    if let Some(other) = &other {
                        let same = solve(other, &arm, &t);
                        if verdict(&same) == "Complete" {
                            compared += 1;
                            assert_eq!(same.count, found.count, "{class}");
                            assert!(found.found().iter().all(|b| holds(&same, &b.joints)), "{class}");
                        }
                    }
                }
            }
            println!("{class}: lost {lost} odd {odd} doubtful {doubtful} most {largest} compared {compared}");
            assert_eq!((lost, odd), (0, 0), "{class}: lost, odd");
            assert!(doubtful <= 2 && largest <= most && largest >= most.min(6), "{class}: {doubtful} {largest}");
            assert!(!class.starts_with("parallel") || compared > 40, "{class}: {compared}");
        }
    }

    /// The arm held by its end effector.
    fn held_by_its_end(arm: &Arm) -> Arm {
        let flip: Frame = [[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]];
        let last = arm.joints();
        let mut c: Vec<Frame> = arm.c.iter().rev().map(reversed).collect();
        (c[0], c[last]) = (compose(&flip, &c[0]), compose(&c[last], &flip));
        Arm { c, prismatic: arm.prismatic.iter().rev().copied().collect() }
    }

    /// Three parallel axes, the sixth axis 10^-k beside their direction: postures keep their digits, from both ends of the arm.
    #[test]
    fn three_parallel_axes_next_to_the_singular_wrist() {
        let ur5 = read("ur5").arm;
        for arm in [held_by_its_end(&ur5), ur5] {
            let plan = plan(&arm);
            assert!(matches!(plan, Plan::ThreeParallel { related: true, .. }), "{plan:?}");
            let wrist = if arm.c[1][0][3] == 0.0 && arm.c[2][0][3] == 0.0 { 1 } else { 4 };
            let random = &mut Random(21);
            let mut complete = 0;
            for i in 0..1000 {
                let beside = 10f64.powf(random.between(-6.0, -1.0));
                let mut q = arm.posture(random);
                q[wrist] = if i % 2 == 0 { beside } else { std::f64::consts::PI - beside };
                let t = arm.at(&q);
                let found = solve(&plan, &arm, &t);
                complete += usize::from(verdict(&found) == "Complete");
                for branch in found.found().iter().filter(|branch| !branch.double) {
                    let missed = defect(&arm.forward(&branch.joints), &t);
                    assert!(missed < 1e-14, "{missed:e} at {beside:e}: {branch:?}");
                }
            }
            assert!(complete > 950, "{complete}");
        }
    }

    /// Wrist, elbow and shoulder singular together, and beside that: what is listed reaches the pose.
    #[test]
    fn no_posture_misses_its_pose_where_singularities_meet() {
        for name in ["ur5", "puma560"] {
            let arm = read(name).arm;
            let (plan, random) = (plan(&arm), &mut Random(22));
            let (mut postures, mut worst, mut worst_alone, mut none) = (0, 0.0f64, 0.0f64, 0);
            for _ in 0..4000 {
                let mut q = arm.posture(random);
                for q in &mut q {
                    let quarters = (random.between(-2.0, 2.5)).floor() * std::f64::consts::FRAC_PI_2;
                    if random.between(0.0, 1.0) < 0.8 {
                        *q =
                            quarters + [0.0, 10f64.powf(random.between(-9.0, -3.0))][usize::from(random.between(0.0, 1.0) < 0.3)];
                    }
                }
                let t = arm.at(&q);
                let found = solve(&plan, &arm, &t);
                postures += found.count;
                none += usize::from(found.count == 0);
                let missed = found.found().iter().map(|branch| defect(&arm.forward(&branch.joints), &t)).fold(0.0, f64::max);
                // One that is alone may be as near as closing the loop comes.
                if found.count == 1 && found.near {
                    worst_alone = worst_alone.max(missed);
                } else {
                    worst = worst.max(missed);
                }
            }
            println!("{name}: {postures} postures, worst {worst:e}, {none} poses without one, worst alone {worst_alone:e}");
            assert!(postures > 4000 && worst < 4e-13 && worst_alone < 1e-7, "{name}: {postures} {worst:e} {worst_alone:e}");
            assert_eq!(none, 0, "{name}: every pose is that of a posture");
        }
    }

    /// An arm with three parallel axes by block 8 all the same.
    #[test]
    fn ur5_as_a_general_arm() {
        check("ur5", true);
    }

    /// Arms that are nearly special are general ones: a wrist whose axes miss each other by 10^-k, axes that are parallel to 10^-k.
    #[test]
    fn nearly_special_arms() {
        let random = &mut Random(7);
        for name in ["puma560", "ur5"] {
            for k in 1..=6 {
                let mut arm = read(name).arm;
                let length = arm.length();
                for f in &mut arm.c[1..] {
                    let mut off = || 10f64.powi(-k) * random.between(-1.0, 1.0);
                    *f = compose(&compose(&row(off(), length * off(), length * off(), off()), f), &row(off(), 0.0, 0.0, 0.0));
                }
                let ways = general_ways(&arm, 40);
                let (mut lost, mut odd, mut near) = (0, 0, 0);
                for _ in 0..300 {
                    let q = arm.posture(random);
                    let t = arm.at(&q);
                    let found = general_arm(&ways, &t, length);
                    let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
                    if verdict(&found) != "Complete" {
                        near += 1;
                        continue;
                    }
                    lost += usize::from(!found.found().iter().any(|b| apart(&b.joints, &values) < 1e-6));
                    odd += found.count % 2;
                }
                assert_eq!((lost, odd), (0, 0), "{name} 10^-{k}");
                // Wrist flips that share an angle to 10^-k are near a double root; at 10^-6 that shows.
                assert!(near <= [0, 3, 15, 15, 15, 30, 40][k as usize], "{name} 10^-{k}: {near}");
                println!("{name} 10^-{k}: lost {lost} odd {odd} near {near} {:?}", ways.map(|w| w.order));
            }
        }
    }
}
