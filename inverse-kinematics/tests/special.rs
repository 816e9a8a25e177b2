//! Postures at which constructions break: joints at multiples of right angles with dust beside. A pose that was made from a posture is in reach.

in_both_scalars! {
    #[allow(unreachable_pub, dead_code)]
    mod arm {
        use super::*;
        include!("common/arm.rs");
        include!("common/solver.rs");
    }
    use arm::*;

    const SINGLE: bool = UNIT_ROUNDOFF > 1e-10;
    const RIGHT: f64 = std::f64::consts::FRAC_PI_2;

    /// A small number of any size above rounding, or 0.
    fn dust(random: &mut Random) -> f64 {
        let size = if SINGLE { random.between(-8.0, -1.5) } else { random.between(-16.0, -4.0) };
        [0.0, 10f64.powf(size), -10f64.powf(size)][random.below(3)]
    }

    /// Each joint at a right angle, slides at tenths, with odds of `odds`; dust beside.
    fn special(arm: &Arm, odds: f64, random: &mut Random) -> Vec<f64> {
        let mut q = arm.posture(random);
        for (q, slides) in q.iter_mut().zip(&arm.prismatic) {
            if random.between(0.0, 1.0) < odds {
                let unit = if *slides { 0.1 } else { RIGHT };
                *q = unit * (random.below(4) as f64 - 1.0) + dust(random);
            }
        }
        q
    }

    /// Shoulder of two axes that meet, elbow, spherical wrist, of random lengths.
    fn with_meeting_shoulder(random: &mut Random) -> Arm {
        let d = [random.between(0.2, 0.5), random.between(0.2, 0.5), random.between(0.1, 0.2)];
        let rows = [(0.0, 0.0, 0.0, RIGHT), (0.0, d[0], 0.0, RIGHT), (0.0, 0.0, 0.0, -RIGHT), (0.0, d[1], 0.0, -RIGHT), (0.0, 0.0, 0.0, RIGHT), (0.0, d[2], 0.0, 0.0)];
        Arm::standard(&rows, &[])
    }

    /// The stretched elbow puts the wrist on axis 2, so that the root of rounding by which the elbow is unknown decides about joint 2.
    #[test]
    fn a_stretched_elbow_is_in_reach() {
        let random = &mut Random(1);
        for _ in 0..10 {
            let arm = with_meeting_shoulder(random);
            let plan = plan(&arm);
            for i in 0..200 {
                let mut q = special(&arm, 0.2, random);
                q[2] = if i % 2 == 0 { 0.0 } else { 2.0 * RIGHT } + dust(random);
                let found = solve(&plan, &arm, &arm.at(&q));
                assert!(found.count > 0 || found.near || found.continuum, "{q:?}");
            }
        }
    }

    /// A stretched elbow and a stretched wrist, each bent by the root of rounding: the wrist's first joint seems free, and only some of its values
    /// have the pose.
    #[test]
    fn an_elbow_and_a_wrist_that_are_nearly_stretched_meet_the_pose() {
        let random = &mut Random(7);
        let mut worst: Real = 0.0;
        for _ in 0..10 {
            let arm = with_meeting_shoulder(random);
            let plan = plan(&arm);
            for _ in 0..200 {
                let mut q = special(&arm, 0.5, random);
                for j in [2, 4] {
                    let size = sqrt(UNIT_ROUNDOFF) as f64 * 10f64.powf(random.between(0.0, 2.0));
                    q[j] = size * if random.below(2) == 0 { 1.0 } else { -1.0 };
                }
                let t = arm.at(&q);
                let found = solve(&plan, &arm, &t);
                for branch in found.found() {
                    worst = worst.max(defect(&arm.forward(&branch.joints), &t));
                }
            }
        }
        assert!(worst <= sqrt(UNIT_ROUNDOFF), "{worst:e}");
    }

    /// Three parallel axes, 5 and 6 apart and at right angles, of random lengths.
    fn with_parallel_axes(random: &mut Random) -> Arm {
        let l: [f64; 6] = std::array::from_fn(|_| random.between(0.1, 0.5));
        let rows = [
            (random.between(-3.0, 3.0), 0.0, 0.0, RIGHT),
            (RIGHT, 0.1, l[0], 0.0),
            (0.0, 0.1, l[1], 0.0),
            (0.0, 0.0, l[2], RIGHT),
            (0.0, 0.0, -l[3], -RIGHT),
            (0.0, -l[4], -l[5], RIGHT),
        ];
        Arm::standard(&rows, &[])
    }

    /// A last axis that is nearly parallel to the three turns by an angle that is hardly known, and the elbow may seem out of reach. Two ways that
    /// lead to one posture are one, and double.
    #[test]
    fn an_elbow_is_in_reach_where_the_last_axis_is_nearly_parallel() {
        let random = &mut Random(11);
        let (mut lost, mut twice) = (0, 0);
        for _ in 0..20 {
            let arm = with_parallel_axes(random);
            let plan = plan(&arm);
            for i in 0..200 {
                let mut q = special(&arm, 0.7, random);
                q[2] = dust(random);
                q[4] = if i % 2 == 0 { 0.0 } else { 2.0 * RIGHT } + dust(random);
                let size = if i % 4 < 2 || SINGLE { 0.0 } else { 10f64.powf(random.between(-12.0, -9.0)) };
                let t = arm.at(&q).map(|row| row.map(|x| x + (size * random.between(-1.0, 1.0)) as Real));
                let found = solve(&plan, &arm, &t);
                lost += usize::from(size == 0.0 && found.count == 0 && !found.near && !found.continuum);
                for (k, branch) in found.found().iter().enumerate() {
                    let same = |other: &&Branch<6>| apart(&other.joints, &branch.joints) < 1e-9 as Real && !other.double && other.free == 0;
                    twice += usize::from(!branch.double && branch.free == 0 && found.found()[..k].iter().any(|other| same(&other)));
                }
            }
        }
        assert!(lost == 0 && twice == 0, "{lost} are called out of reach, {twice} are listed twice");
    }

    /// Slides at joints 1 and 3 at right angles to the axis between them, of random lengths.
    fn with_two_slides(random: &mut Random) -> Arm {
        let l: [f64; 7] = std::array::from_fn(|_| random.between(0.05, 0.3));
        let rows = [(0.0, 0.0, 0.0, RIGHT), (0.0, l[0], l[1], RIGHT), (0.8, 0.0, l[2], RIGHT), (0.0, l[3], l[4], -RIGHT), (0.0, l[5], 0.05, RIGHT), (0.0, l[6], 0.0, 0.0)];
        Arm::standard(&rows, &[0, 2])
    }

    /// All solutions on the circle of joint 2, in the arm's order.
    fn solve_two_slides(arm: &Arm, t: &Frame) -> (Branches<6, 8>, Vec<[[Real; 2]; 6]>) {
        let (order, links) = arranged::<6>(arm, t, 1, false);
        let place = |joint| order.iter().position(|i| *i == joint).expect("a joint");
        let mut slides: Vec<usize> = arm.prismatic.iter().enumerate().filter(|(_, slides)| **slides).map(|(i, _)| place(i)).collect();
        slides.sort_unstable();
        let found = two_slides(&links, [slides[0], slides[1]], arm.length());
        let listed = found.found().iter().map(|branch| in_order(&order, &branch.joints)).collect();
        (found, listed)
    }

    /// Where the slides are parallel there is no root without a posture: random poses are certain. Where joints 4 and 6 turn about one axis, the
    /// postures are found from loops beside.
    #[test]
    fn two_slides_lose_no_posture() {
        let random = &mut Random(2);
        let (mut doubtful, mut regular) = (0, 0);
        for _ in 0..10 {
            let arm = with_two_slides(random);
            for i in 0..60 {
                let mut q = if i % 2 == 0 { arm.posture(random) } else { special(&arm, 0.5, random) };
                if i % 4 == 3 {
                    q[4] = 2.0 * RIGHT;
                }
                let t = arm.at(&q);
                let (found, listed) = solve_two_slides(&arm, &t);
                let sure = !found.near && !found.continuum && found.found().iter().all(|branch| !branch.double);
                assert!(found.count > 0 || !sure, "{q:?}: unreachable");
                if i % 2 == 0 {
                    regular += 1;
                    doubtful += usize::from(!sure);
                    let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
                    let near = if SINGLE { 5e-2 } else { 1e-5 };
                    assert!(!sure || listed.iter().any(|other| apart(other, &values) < near), "{q:?}: lost");
                }
            }
        }
        assert!(doubtful * if SINGLE { 3 } else { 100 } <= regular, "{doubtful} of {regular} random poses are doubtful");
    }

    /// Where slides are parallel but for rounding they would go as far as rounding lets them: no such posture is listed, since it misses the pose.
    #[test]
    fn slides_that_are_nearly_parallel_reach_what_they_reach() {
        let random = &mut Random(6);
        let mut worst: Real = 0.0;
        for _ in 0..10 {
            let l: [f64; 4] = std::array::from_fn(|_| random.between(0.1, 0.6));
            let turns: [f64; 3] = std::array::from_fn(|_| random.between(-1.5, 1.5));
            let rows = [
                (turns[0], 0.0, 0.0, 2.0 * RIGHT),
                (turns[1], 0.0, 0.0, -RIGHT),
                (turns[2], -l[0], 0.0, RIGHT),
                (0.0, l[1], -l[2], RIGHT),
                (0.0, 0.0, -7e-4, 2.0 * RIGHT),
                (0.0, l[3], 0.0, 0.0),
            ];
            let arm = Arm::standard(&rows, &[0, 4]);
            for _ in 0..100 {
                let slide = random.between(-0.5, 0.5);
                let parallel = [slide, 0.0, -RIGHT - turns[2], -RIGHT, -slide, 0.0];
                let q: Vec<f64> = parallel.iter().map(|q| q + dust(random)).collect();
                let t = arm.at(&q);
                for joints in solve_two_slides(&arm, &t).1 {
                    worst = worst.max(defect(&arm.forward(&joints), &t));
                }
            }
        }
        assert!(worst <= if SINGLE { 3e-3 } else { 1e-9 }, "{worst:e}");
    }

    /// At multiples of right angles slides are in one plane, turns meet and axes are parallel: the pose is in reach, and each posture has it.
    #[test]
    fn three_slides_reach_what_they_reach() {
        let random = &mut Random(8);
        let (mut unreachable, mut worst) = (0, 0.0 as Real);
        for turning in [[1, 2, 3], [3, 4, 5], [1, 2, 4], [1, 3, 4], [0, 2, 4], [2, 3, 5]] {
            let slides: Vec<usize> = (0..6).filter(|i| !turning.contains(i)).collect();
            for _ in 0..4 {
                let rows: [(f64, f64, f64, f64); 6] = std::array::from_fn(|i| {
                    let slope = if slides.contains(&i) { [0.0, RIGHT / 3.0][random.below(2)] } else { RIGHT };
                    let length = [0.0, random.between(-0.5, 0.5)];
                    (0.0, if slides.contains(&i) { 0.0 } else { length[random.below(2)] }, length[random.below(2)], slope)
                });
                let arm = Arm::standard(&rows, &slides);
                let (_, links) = arranged::<6>(&arm, &arm.at(&arm.posture(random)), 0, false);
                // Slides in one plane at all poses.
                if three_prismatic(&links, turning).found().iter().any(|branch| branch.free != 0) {
                    continue;
                }
                for _ in 0..100 {
                    let q = special(&arm, 0.8, random);
                    let t = arm.at(&q);
                    let (_, links) = arranged::<6>(&arm, &t, 0, false);
                    let mut found = three_prismatic(&links, turning);
                    let prismatic = std::array::from_fn(|i| slides.contains(&i));
                    close_where_solutions_meet(&mut found, &Loop { links: &links, prismatic, target: [0.0; 3], length: arm.length() });
                    unreachable += usize::from(found.count == 0 && !found.near && !found.continuum);
                    for branch in found.found() {
                        worst = worst.max(defect(&arm.forward(&branch.joints), &t));
                    }
                }
            }
        }
        assert_eq!(unreachable, 0);
        // Where solutions meet the nearest may miss by the root of rounding.
        assert!(worst <= if SINGLE { 3e-3 } else { 1e-7 }, "{worst:e}");
    }

    /// Entries of a pose that are off by 1e-9 make no rotation. Joint 5 at pi brings the axes of joints 4 and 6 together, where two postures share a
    /// root that such a pose would hide.
    #[test]
    fn two_slides_take_poses_that_are_nearly_rotations() {
        if SINGLE {
            return;
        }
        let random = &mut Random(9);
        let mut lost = 0;
        for _ in 0..10 {
            let arm = with_two_slides(random);
            for _ in 0..100 {
                let mut q = arm.posture(random);
                q[4] = 2.0 * RIGHT + dust(random);
                let size = 10f64.powf(random.between(-12.0, -9.0));
                let t = arm.at(&q).map(|row| row.map(|x| x + (size * random.between(-1.0, 1.0)) as Real));
                let (_, listed) = solve_two_slides(&arm, &t);
                let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
                lost += usize::from(!listed.iter().any(|other| apart(other, &values) < 1e-4));
            }
        }
        assert!(lost == 0, "{lost} of 1000 postures are lost");
    }

    /// The rows of a Jaco, with a wrist of 60 degrees.
    const JACO: [(f64, f64, f64, f64); 6] = [
        (0.0, 0.2755, 0.0, RIGHT),
        (0.0, 0.0, 0.41, 2.0 * RIGHT),
        (0.0, -0.0098, 0.0, RIGHT),
        (0.0, -0.2502, 0.0, RIGHT / 1.5),
        (0.0, -0.0858, 0.0, RIGHT / 1.5),
        (0.0, -0.2116, 0.0, 2.0 * RIGHT),
    ];

    /// The small offset of joint 3 brings the postures in pairs, whose roots are 1e-3 to 5e-2 rad apart: single precision takes two for one. Both
    /// come of that one, and the verdict is `Complete`.
    #[test]
    fn a_root_that_stands_for_two_gives_both() {
        let arm = Arm::standard(&JACO, &[]);
        let ways = general_ways(&arm, 8);
        let random = &mut Random(4);
        let mut doubtful = 0;
        for _ in 0..300 {
            let q = arm.posture(random);
            let found = general_arm(&ways, &arm.at(&q), arm.length());
            let sure = !found.near && !found.continuum && found.found().iter().all(|branch| !branch.double);
            doubtful += usize::from(!sure);
            assert!(!sure || found.count.is_multiple_of(2), "{q:?}");
            let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
            let near = if SINGLE { 5e-2 } else { 1e-5 };
            assert!(!sure || found.found().iter().any(|other| apart(&other.joints, &values) < near), "{q:?}: lost");
        }
        assert!(doubtful <= if SINGLE { 30 } else { 1 }, "{doubtful} of 300");
    }

    /// A pose that is off from a rotation has other solutions in each arrangement. Beside the posture of 0, 0, 0, 0.7 rad, 0 both look for some.
    #[test]
    fn a_general_arm_lists_each_posture_once() {
        let arm = Arm::standard(&JACO, &[]);
        let ways = general_ways(&arm, 8);
        let random = &mut Random(5);
        let mut twice = 0;
        for _ in 0..100 {
            let q = [arm.posture(random)[0], 0.0, 0.0, 0.0, random.between(-1.5, 1.5), 0.0];
            let size = if SINGLE { 6e-8 } else { 10f64.powf(random.between(-9.0, -7.0)) };
            let t = arm.at(&q).map(|row| row.map(|x| x + (size * random.between(-1.0, 1.0)) as Real));
            let found = general_arm(&ways, &t, arm.length());
            let single: Vec<_> = found.found().iter().filter(|branch| !branch.double).collect();
            let same = if SINGLE { 2e-2 } else { 1e-6 };
            twice += (0..single.len()).filter(|&i| single[..i].iter().any(|other| apart(&other.joints, &single[i].joints) < same)).count();
        }
        assert_eq!(twice, 0);
    }

    /// Where joints 2, 3 and 5 of a Jaco are at 0 or pi several regular postures nearly share a root of the
    /// determinant, in both arrangements: rounding hides them.
    #[test]
    fn postures_that_share_a_root_are_not_lost() {
        if SINGLE {
            return;
        }
        let arm = Arm::standard(&JACO, &[]);
        let ways = general_ways(&arm, 8);
        let random = &mut Random(3);
        let mut lost = 0;
        for i in 0..200 {
            let mut q = arm.posture(random);
            for (joint, place) in [(1, i % 2), (2, 1 - i % 2), (4, 1)] {
                q[joint] = 2.0 * RIGHT * place as f64 + 10f64.powf(random.between(-13.0, -5.0));
            }
            let found = general_arm(&ways, &arm.at(&q), arm.length());
            let sure = !found.near && !found.continuum && found.found().iter().all(|branch| !branch.double);
            assert!(found.count > 0 || !sure, "{q:?}: unreachable");
            let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
            lost += usize::from(sure && !found.found().iter().any(|other| apart(&other.joints, &values) < 1e-4));
        }
        assert_eq!(lost, 0);
    }
}
