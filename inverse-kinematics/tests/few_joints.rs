//! Arms with fewer joints than a pose has rows, by the blocks alone: folds, joints that can move while the end effector stays, poses beside.

in_both_scalars! {
    #[allow(unreachable_pub, dead_code)]
    mod arm {
        use super::*;
        include!("common/arm.rs");
    }
    use arm::*;

    #[allow(unreachable_pub, dead_code)]
    mod solver {
        use super::*;
        include!("common/solver.rs");
    }
    use solver::arrangement;

    /// Rounding of a pose moves a solution where two meet by as much.
    const ROOT: Real = 64.0 * if UNIT_ROUNDOFF < 1e-10 { 1e-8 } else { 2.5e-4 };

    /// An arm whose joints behind the first `own` are virtual, and its own loop, with joints at 0 behind them.
    struct Few {
        completed: Arm,
        own: Arrangement<6>,
    }

    fn few(rows: &[(f64, f64, f64, f64)], slides: &[usize], own: usize) -> Few {
        let completed = Arm::standard(rows, slides);
        let mut still = completed.clone();
        still.c.truncate(own + 1);
        still.prismatic.truncate(own);
        while still.joints() < 6 {
            still.c.push(IDENTITY);
            still.prismatic.push(false);
        }
        Few { own: arrangement(&still, 0, false, false), completed }
    }

    /// The pose of a posture whose virtual joints are at 0.
    fn pose(arm: &Few, q: &[f64]) -> Frame {
        let mut all = q.to_vec();
        all.resize(arm.completed.joints(), 0.0);
        arm.completed.at(&all)
    }

    fn is_there<const J: usize, const N: usize>(arm: &Few, found: &Branches<J, N>, q: &[f64], within: Real) -> bool {
        let wanted: Vec<[Real; 2]> = q.iter().enumerate().map(|(i, q)| arm.completed.value(i, *q)).collect();
        found.found().iter().any(|branch| apart(&branch.joints, &wanted) <= within)
    }

    /// Three parallel axes, with links of these lengths.
    fn planar(l1: f64, l2: f64) -> Few {
        few(&[(0.0, 0.0, l1, 0.0), (0.0, 0.0, l2, 0.0), (0.0, 0.0, 0.2, 0.0), (0.0, 0.0, 0.0, 0.0)], &[3], 3)
    }

    /// By the class of parallel axes, with a slide along the last one.
    fn in_plane(arm: &Few, t: &Frame) -> Branches<3, 4> {
        let way = arrangement::<4>(&arm.completed, 3, true, true);
        let mut found = parallel_turns(&way.links_at(t), [true, false, false], regional_slide_elbow);
        for branch in &mut found.all {
            *branch = way.of_arm(branch);
        }
        without_virtual_joints::<4, 3, 4>(&arm.own, &found, t, arm.completed.length(), ROUNDING)
    }

    #[test]
    fn three_parallel_axes_have_two_postures() {
        let (arm, random) = (planar(0.5, 0.4), &mut Random(1));
        for _ in 0..50 {
            let elbow = random.between(0.2, 2.9);
            let q = [random.angle(), elbow, random.angle()];
            let found = in_plane(&arm, &pose(&arm, &q));
            assert!(found.count == 2 && !found.near && !found.continuum, "{found:?}");
            assert!(found.found().iter().all(|branch| !branch.double && branch.free == 0), "{found:?}");
            assert!(is_there(&arm, &found, &q, ROOT), "{q:?} {found:?}");
        }
    }

    /// Stretched and folded: two postures meet, and are listed once.
    #[test]
    fn folds_of_three_parallel_axes_are_told() {
        let arm = planar(0.5, 0.4);
        for elbow in [0.0, std::f64::consts::PI] {
            let q = [0.3, elbow, 0.4];
            let t = pose(&arm, &q);
            let found = in_plane(&arm, &t);
            assert_eq!((found.count, found.all[0].double, found.all[0].free), (1, true, 0), "{found:?}");
            assert!(is_there(&arm, &found, &q, ROOT), "{found:?}");
            // Out of the plane, and beyond its edge.
            let by = if UNIT_ROUNDOFF < 1e-10 { 1e-3 } else { 0.05 };
            let mut lifted = t;
            lifted[2][3] += by;
            let lifted = in_plane(&arm, &lifted);
            assert!(lifted.count == 0 && !lifted.near && (lifted.miss - by).abs() < 0.1 * by, "{lifted:?}");
        }
    }

    /// Links of one length folded: axes 1 and 3 are one, and turn against one another. The first of them is given at 0.
    #[test]
    fn joints_of_one_axis_are_free() {
        let arm = planar(0.4, 0.4);
        let found = in_plane(&arm, &pose(&arm, &[0.3, std::f64::consts::PI, 0.4]));
        assert_eq!((found.count, found.all[0].free), (1, 0b101), "{found:?}");
        assert!(!found.all[0].double && is_there(&arm, &found, &[0.0, std::f64::consts::PI, 0.7], ROOT), "{found:?}");
    }

    /// Two axes that intersect, beyond them a slide: at its length 0, with the tool on axis 1, nothing moves; a slide of some hundred lengths is
    /// a posture as any other.
    fn boom() -> Few {
        let quarter = std::f64::consts::FRAC_PI_2;
        few(&[(0.0, 0.3, 0.0, quarter), (0.0, 0.0, 0.0, quarter), (0.0, 0.0, 0.0, 0.0)], &[2], 3)
    }

    /// What a construction would have found: the postures themselves, `off` from where they are.
    fn beside(arm: &Few, q: &[f64; 3], off: Real) -> Branches<6, 8> {
        let mut found = Branches::new();
        let mut joints = [[1.0, 0.0]; 6];
        for (i, value) in joints.iter_mut().enumerate().take(3) {
            let q = q[i] + f64::from(off as f32) * if i == 2 { 1.0 } else { -0.5 };
            *value = arm.completed.value(i, q);
        }
        found.add(Branch { joints, signs: 3, double: false, error: 0.0, free: 0 });
        found
    }

    #[test]
    fn candidates_are_brought_to_their_postures() {
        let (arm, random) = (boom(), &mut Random(2));
        for number in 0..50 {
            let q = [random.angle(), random.between(0.3, 2.8), random.between(0.2, 0.5) * if number % 5 == 0 { 300.0 } else { 1.0 }];
            let (t, length) = (pose(&arm, &q), arm.completed.length());
            let found: Branches<3, 8> = without_virtual_joints(&arm.own, &beside(&arm, &q, 1e-3), &t, length, ROUNDING);
            assert!(found.count == 1 && found.all[0].signs == 3 && !found.all[0].double && !found.near, "{q:?}: {found:?}");
            assert!(is_there(&arm, &found, &q, ROOT * q[2].max(1.0) as Real), "{q:?}: {found:?}");
        }
    }

    /// With the slide along axis 1 the arm turns about that axis at no rate that moves the point, but the end effector turns: nothing is free.
    #[test]
    fn what_turns_the_end_effector_is_not_free() {
        let arm = boom();
        let q = [0.4, 0.0, 0.3];
        let found: Branches<3, 8> = without_virtual_joints(&arm.own, &beside(&arm, &q, 1e-3), &pose(&arm, &q), arm.completed.length(), ROUNDING);
        assert!(found.count == 1 && found.all[0].free == 0 && !found.all[0].double && !found.near, "{found:?}");
    }

    /// Nothing found, and the construction says that it may have missed something: four postures are searched from, and the result is doubtful.
    #[test]
    fn what_a_construction_has_missed_is_searched_for() {
        let (arm, q) = (planar(0.5, 0.4), [0.2, 1.1, -0.4]);
        let none: Branches<6, 8> = Branches { near: true, ..Branches::new() };
        let found: Branches<3, 8> = without_virtual_joints(&arm.own, &none, &pose(&arm, &q), arm.completed.length(), ROUNDING);
        assert!(found.near && found.count > 0, "{found:?}");
        let reach = found.found().iter().all(|branch| defect(&arm.completed.forward(&[&branch.joints[..], &[[0.0; 2]]].concat()), &pose(&arm, &q)) < 1e-4);
        assert!(reach, "{found:?}");
        let sure: Branches<6, 8> = Branches { miss: 0.3, ..Branches::new() };
        let found: Branches<3, 8> = without_virtual_joints(&arm.own, &sure, &pose(&arm, &q), arm.completed.length(), ROUNDING);
        assert!(!found.near && found.count == 0 && found.miss == 0.3, "{found:?}");
    }
}
