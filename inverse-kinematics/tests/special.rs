//! Postures at which constructions break: joints at multiples of right angles with dust beside, stretched elbows, arms that are nearly of a class.
//! A posture that is regular is found at its own pose, and a pose that was made from a posture is not out of reach.

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

    /// The root of the sum of squares of the inverse Jacobian, with lengths in units of the sum of the arm's: above 1 over the smallest singular value.
    fn inverse_size(arm: &Arm, q: &[f64]) -> f64 {
        let size: Real = arm.c.iter().map(extent).sum();
        let (mut t, mut axes) = (arm.c[0], vec![]);
        for (i, q) in q.iter().enumerate() {
            axes.push((column(&t, 2), column(&t, 3)));
            t = compose(&t, &joint_then(arm.prismatic[i], arm.value(i, *q), &arm.c[i + 1]));
        }
        let mut rows = vec![[0.0f64; 12]; 6];
        for (j, (z, o)) in axes.into_iter().enumerate() {
            let v = if arm.prismatic[j] { z } else { cross(z, minus(column(&t, 3), o)).map(|x| x / size) };
            let w = if arm.prismatic[j] { [0.0; 3] } else { z };
            for k in 0..3 {
                (rows[k][j], rows[k + 3][j]) = (v[k] as f64, w[k] as f64);
            }
        }
        for k in 0..6 {
            rows[k][6 + k] = 1.0;
        }
        for k in 0..6 {
            let pivot = (k..6).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap();
            rows.swap(k, pivot);
            let row = rows[k].map(|x| x / rows[k][k]);
            for (i, other) in rows.iter_mut().enumerate() {
                let factor = other[k];
                for (x, y) in other.iter_mut().zip(row) {
                    *x = if i == k { y } else { *x - factor * y };
                }
            }
        }
        rows.iter().flat_map(|row| &row[6..]).map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Of regular postures: those that are not among the solutions of their pose, and those whose pose is not said to be complete. Of all: those
    /// whose pose is called out of reach, and the number of those that are regular.
    #[derive(Debug, Default, PartialEq)]
    struct Tally {
        lost: usize,
        doubtful: usize,
        unreachable: usize,
        regular: usize,
    }

    fn tally(arm: &Arm, postures: impl Iterator<Item = Vec<f64>>, solve: impl Fn(&Frame) -> Branches<6, 16>) -> Tally {
        let mut tally = Tally::default();
        let most = if SINGLE { 8.0 } else { 5e2 };
        for q in postures {
            let t = arm.at(&q);
            let found = solve(&t);
            let doubtful = found.near || found.continuum || found.found().iter().any(|b| b.double || b.free != 0);
            tally.unreachable += usize::from(found.count == 0 && !doubtful);
            if inverse_size(arm, &q) < most {
                let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
                let near = found.found().iter().any(|b| apart(&b.joints, &values) < if SINGLE { 2e-2 } else { 1e-6 });
                tally.regular += 1;
                tally.lost += usize::from(!near);
                tally.doubtful += usize::from(doubtful);
            }
        }
        tally
    }

    fn planned(arm: &Arm) -> impl Fn(&Frame) -> Branches<6, 16> + '_ {
        let plan = plan(arm);
        move |t| solve(&plan, arm, t)
    }

    /// Shoulder of two axes that meet, elbow, spherical wrist, of random lengths.
    fn with_meeting_shoulder(random: &mut Random) -> Arm {
        let d = [random.between(0.2, 0.5), random.between(0.2, 0.5), random.between(0.1, 0.2)];
        let rows = [(0.0, 0.0, 0.0, RIGHT), (0.0, d[0], 0.0, RIGHT), (0.0, 0.0, 0.0, -RIGHT), (0.0, d[1], 0.0, -RIGHT), (0.0, 0.0, 0.0, RIGHT), (0.0, d[2], 0.0, 0.0)];
        Arm::standard(&rows, &[])
    }

    #[test]
    fn a_stretched_elbow_is_in_reach() {
        let random = &mut Random(1);
        for _ in 0..10 {
            let arm = with_meeting_shoulder(random);
            let solve = planned(&arm);
            let stretched = (0..200).map(|i| {
                let mut q = special(&arm, 0.2, random);
                q[2] = if i % 2 == 0 { 0.0 } else { 2.0 * RIGHT } + dust(random);
                q
            });
            let stretched: Vec<_> = stretched.collect();
            let tally = tally(&arm, stretched.into_iter(), solve);
            assert_eq!((tally.unreachable, tally.lost), (0, 0), "{tally:?}");
        }
    }

    /// A wrist of 60 degrees, as the Jaco's: at special postures several solutions share the last joints' values.
    fn with_tilted_wrist(random: &mut Random) -> Arm {
        let x = |random: &mut Random, x: f64| x * random.between(0.8, 1.2);
        let rows = [
            (0.0, x(random, 0.2755), 0.0, RIGHT),
            (0.0, 0.0, x(random, 0.41), 2.0 * RIGHT),
            (0.0, x(random, -0.0098), 0.0, RIGHT),
            (0.0, x(random, -0.2501), 0.0, RIGHT / 1.5),
            (0.0, x(random, -0.0856), 0.0, RIGHT / 1.5),
            (0.0, x(random, -0.2028), 0.0, 2.0 * RIGHT),
        ];
        Arm::standard(&rows, &[])
    }

    fn roots_that_several_solutions_share(arms: usize, poses: usize) {
        if SINGLE {
            // No posture of such an arm is regular to single precision.
            return;
        }
        let random = &mut Random(2);
        for _ in 0..arms {
            let arm = with_tilted_wrist(random);
            let solve = planned(&arm);
            let postures: Vec<_> = (0..poses)
                .map(|i| {
                    let mut q = special(&arm, 0.8, random);
                    if i % 2 == 0 {
                        let [a, b] = [[0.0, 2.0 * RIGHT], [2.0 * RIGHT, 0.0]][random.below(2)];
                        for (joint, angle) in [(1, a), (2, b), (4, 2.0 * RIGHT)] {
                            q[joint] = angle + dust(random);
                        }
                    }
                    q
                })
                .collect();
            let tally = tally(&arm, postures.into_iter(), solve);
            assert!(tally.regular > poses / 8, "{tally:?}");
            assert_eq!(tally.lost, 0, "{tally:?}");
        }
    }

    #[test]
    fn solutions_that_share_a_root_are_found() {
        roots_that_several_solutions_share(2, 100);
    }

    #[test]
    #[ignore = "wide: minutes"]
    fn solutions_that_share_a_root_are_found_at_many_poses() {
        roots_that_several_solutions_share(20, 1000);
    }

    /// A Puma whose constants a calibration has moved by 1e-4.
    fn calibrated(random: &mut Random) -> Arm {
        let rows = [(0.67, 0.0, RIGHT), (0.0, 0.4318, 0.0), (0.15005, 0.0203, -RIGHT), (0.4318, 0.0, RIGHT), (0.0, 0.0, -RIGHT), (0.05625, 0.0, 0.0)];
        let mut off = |x: f64| x + random.between(-1e-4, 1e-4);
        let rows = rows.map(|(d, a, alpha)| (off(0.0), off(d), off(a), off(alpha)));
        Arm::standard(&rows, &[])
    }

    #[test]
    fn arms_that_are_nearly_of_a_class_lose_nothing() {
        if SINGLE {
            // 1e-4 is next to rounding: the solutions that nearly share a root are one.
            return;
        }
        let random = &mut Random(3);
        for _ in 0..2 {
            let arm = calibrated(random);
            let solve = planned(&arm);
            for odds in [0.0, 0.5] {
                let postures: Vec<_> = (0..100).map(|_| special(&arm, odds, random)).collect();
                let tally = tally(&arm, postures.into_iter(), &solve);
                assert_eq!((tally.lost, tally.unreachable), (0, 0), "{tally:?}");
            }
        }
    }

    /// P R P R R R with right angles: the slides are parallel where joint 2 is at 0, whatever they have to reach.
    #[test]
    fn slides_that_become_parallel() {
        if SINGLE {
            // No posture of this arm is regular to single precision.
            return;
        }
        let rows = [(0.0, 0.0, 0.0, RIGHT), (0.0, 0.1, 0.3, RIGHT), (0.5 * RIGHT, 0.0, 0.1, RIGHT), (0.0, 0.2, 0.1, -RIGHT), (0.0, 0.1, 0.05, RIGHT), (0.0, 0.2, 0.0, 0.0)];
        let arm = Arm::standard(&rows, &[0, 2]);
        let way = arrangement::<6>(&arm, 1, false, true);
        let solve = |t: &Frame| {
            let found = two_slides(&way.links_at(t), way.open, [1, 5], arm.length());
            let mut all = Branches { miss: found.miss, near: found.near, continuum: found.continuum, ..Branches::new() };
            found.found().iter().for_each(|b| all.add(way.of_arm(b)));
            all
        };
        let random = &mut Random(4);
        let any: Vec<_> = (0..1000).map(|_| special(&arm, 0.0, random)).collect();
        let random_ones = tally(&arm, any.into_iter(), solve);
        assert_eq!((random_ones.lost, random_ones.unreachable), (0, 0), "{random_ones:?}");
        assert!(random_ones.doubtful <= random_ones.regular / 50, "{random_ones:?}");
        let right: Vec<_> = (0..300).map(|_| special(&arm, 0.5, random)).collect();
        let right = tally(&arm, right.into_iter(), solve);
        assert!(right.regular > 50 && right.lost == 0, "{right:?}");
    }
}
