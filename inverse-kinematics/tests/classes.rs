//! The constructions of whole arms, with made-up arms of each class: the loop is closed, the original posture is found, counts are even.

in_both_scalars! {
    #[allow(unreachable_pub, dead_code)]
    mod arm {
        use super::*;
        include!("common/arm.rs");
    }
    use arm::*;

    const SINGLE: bool = UNIT_ROUNDOFF > 1e-10;

    /// J1 L1 ... Jn Ln.
    fn around<const N: usize>(links: &[Frame; N], prismatic: &[bool; N], joints: &[[Real; 2]; N]) -> Frame {
        let mut chain = IDENTITY;
        for i in 0..N {
            chain = compose(&chain, &joint_then(prismatic[i], joints[i], &links[i]));
        }
        chain
    }

    /// A loop of given links but for the one at `open`, which closes it for the joints given.
    fn closed<const N: usize>(mut links: [Frame; N], prismatic: &[bool; N], open: usize, joints: &[[Real; 2]; N]) -> [Frame; N] {
        // The loop read from behind the open link.
        let mut chain = IDENTITY;
        for k in 1..=N {
            let i = (open + k) % N;
            let link = if i == open { IDENTITY } else { links[i] };
            chain = compose(&chain, &joint_then(prismatic[i], joints[i], &link));
        }
        links[open] = inverse(&chain);
        links
    }

    fn values<const N: usize>(prismatic: &[bool; N], random: &mut Random) -> [[Real; 2]; N] {
        prismatic.map(|p| if p { [random.between(-0.5, 0.5) as Real, 0.0] } else { let t = random.angle(); [t.cos() as Real, t.sin() as Real] })
    }

    fn any(random: &mut Random) -> Frame {
        row(random.angle(), random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.angle())
    }

    fn link(d: f64, a: f64, alpha: f64) -> Frame {
        row(0.0, d, a, alpha)
    }

    struct Tally {
        lost: usize,
        odd: usize,
        doubtful: usize,
        most: usize,
        worst: Real,
    }

    /// Postures of made-up loops, `solve` giving all solutions of each.
    fn tally<const N: usize, const M: usize>(
        seed: u64,
        prismatic: [bool; N],
        make: impl Fn(&mut Random) -> ([Frame; N], usize),
        solve: impl Fn(&[Frame; N]) -> Branches<N, M>,
    ) -> Tally {
        let random = &mut Random(seed);
        let mut tally = Tally { lost: 0, odd: 0, doubtful: 0, most: 0, worst: 0.0 };
        for _ in 0..1000 {
            let (links, open) = make(random);
            let joints = values(&prismatic, random);
            let links = closed(links, &prismatic, open, &joints);
            let found = solve(&links);
            tally.most = tally.most.max(found.count);
            for branch in found.found() {
                assert!(branch.free == 0 || SINGLE, "{branch:?}");
                if !branch.double {
                    tally.worst = tally.worst.max(defect(&around(&links, &prismatic, &branch.joints), &IDENTITY));
                }
            }
            if found.near || found.found().iter().any(|b| b.double || b.free != 0) {
                tally.doubtful += 1;
                continue;
            }
            let near = 1e4 * UNIT_ROUNDOFF.sqrt();
            tally.lost += usize::from(!found.found().iter().any(|b| apart(&b.joints, &joints) < near));
            tally.odd += found.count % 2;
        }
        println!("lost {} odd {} doubtful {} most {} worst {:e}", tally.lost, tally.odd, tally.doubtful, tally.most, tally.worst);
        tally
    }

    #[track_caller]
    fn sound(tally: &Tally, most: usize, worst: Real) {
        assert_eq!((tally.lost, tally.odd, tally.most), (0, 0, most), "lost, odd, most");
        assert!(tally.doubtful <= if SINGLE { 150 } else { 1 }, "{} doubtful", tally.doubtful);
        assert!(tally.worst < if SINGLE { worst * 5e8 } else { worst }, "worst {:e}", tally.worst);
    }

    fn wrist(random: &mut Random) -> [Frame; 2] {
        if random.below(2) == 0 {
            [link(random.between(-0.3, 0.3), 0.0, random.between(0.5, 2.5)), link(0.0, 0.0, random.between(-2.5, -0.5))]
        } else {
            let quarter = std::f64::consts::FRAC_PI_2;
            [link(0.0, 0.0, quarter), link(0.0, 0.0, -quarter)]
        }
    }

    fn flat(random: &mut Random) -> Frame {
        let half = if random.below(2) == 0 { 0.0 } else { std::f64::consts::PI };
        link(random.between(-0.3, 0.3), if random.below(2) == 0 { 1.0 } else { -1.0 } * random.between(0.2, 0.6), half)
    }

    #[test]
    fn spherical_wrist_with_an_elbow() {
        let make = |r: &mut Random| ([any(r), flat(r), any(r), wrist(r)[0], wrist(r)[1], IDENTITY], 5);
        let make = |r: &mut Random| { let (mut l, open) = make(r); let w = wrist(r); (l[3], l[4]) = (w[0], w[1]); (l, open) };
        let tally = tally(1, [false; 6], make, |l| spherical_triple(l, [false; 3], regional_elbow));
        sound(&tally, 8, 1e-13);
    }

    #[test]
    fn spherical_wrist_with_a_general_arm() {
        let make = |r: &mut Random| { let w = wrist(r); ([any(r), any(r), any(r), w[0], w[1], IDENTITY], 5) };
        sound(&tally(2, [false; 6], make, |l| spherical_triple(l, [false; 3], regional_general)), 8, 1e-9);
    }

    /// The pose among the first three joints, so that the regional problem has no constants.
    #[test]
    fn spherical_triple_in_the_middle() {
        for open in [0, 1, 2] {
            let make = |r: &mut Random| { let w = wrist(r); ([any(r), any(r), any(r), w[0], w[1], any(r)], open) };
            sound(&tally(3 + open as u64, [false; 6], make, |l| spherical_triple(l, [false; 3], regional_general)), 8, 1e-8);
        }
    }

    #[test]
    fn spherical_wrist_on_a_sliding_arm() {
        let make = |r: &mut Random| { let w = wrist(r); ([any(r), any(r), any(r), w[0], w[1], IDENTITY], 5) };
        let kinds = |i: usize| { let mut p = [false; 6]; p[i] = true; p };
        sound(&tally(6, kinds(0), make, |l| spherical_triple(l, [true, false, false], regional_slide)), 8, 1e-9);
        sound(&tally(7, kinds(1), make, |l| spherical_triple(l, [false, true, false], regional_mid_slide)), 8, 1e-9);
    }

    #[test]
    fn three_parallel_axes_like_a_ur() {
        let make = |r: &mut Random| {
            let cross = link(r.between(-0.3, 0.3), 0.0, r.between(0.5, 2.5));
            ([any(r), flat(r), flat(r), any(r), cross, IDENTITY], 5)
        };
        sound(&tally(8, [false; 6], make, three_parallel), 8, 1e-12);
    }

    #[test]
    fn three_parallel_axes_in_general() {
        for open in [0, 3, 4, 5] {
            let make = |r: &mut Random| ([any(r), flat(r), flat(r), any(r), any(r), any(r)], open);
            let tally = tally(9 + open as u64, [false; 6], make, three_parallel);
            sound(&tally, 8, 1e-8);
        }
    }

    #[test]
    fn three_parallel_axes_with_two_more_parallel() {
        // Axes b and c parallel; axes a and c.
        let make = |r: &mut Random| ([any(r), flat(r), flat(r), any(r), flat(r), IDENTITY], 5);
        sound(&tally(20, [false; 6], make, three_parallel), 8, 1e-12);
        let make = |r: &mut Random| ([any(r), flat(r), flat(r), any(r), IDENTITY, flat(r)], 4);
        sound(&tally(21, [false; 6], make, three_parallel), 8, 1e-12);
    }

    #[test]
    fn all_axes_parallel() {
        let (p, r) = (true, false);
        let upright = |r: &mut Random| {
            let turned = row(r.angle(), r.between(-0.3, 0.3), r.between(0.2, 0.5), 0.0);
            if r.below(2) == 0 { turned } else { compose(&turned, &row(0.0, 0.0, 0.0, std::f64::consts::PI)) }
        };
        // SCARA: R R P R as the loop P R R R read from joint 3, and R P R R.
        let make = |x: &mut Random| ([upright(x), flat(x), upright(x), IDENTITY], 3);
        sound(&tally(22, [p, r, r, r], make, |l| parallel_turns(l, [p, r, r], regional_slide_elbow)), 2, 1e-13);
        let make = |x: &mut Random| ([upright(x), upright(x), upright(x), IDENTITY], 3);
        sound(&tally(23, [r, p, r, r], make, |l| parallel_turns(l, [r, p, r], regional_mid_slide_elbow)), 2, 1e-13);
        // A gantry with a turn, in three dimensions.
        let make = |x: &mut Random| {
            let tilt = row(x.angle(), 0.1, 0.2, x.between(0.5, 1.2));
            let tilt2 = row(x.angle(), 0.1, 0.2, x.between(0.5, 1.2));
            let back = inverse(&compose(&tilt, &tilt2));
            ([tilt, tilt2, back, IDENTITY], 3)
        };
        let tally = tally(24, [p, p, p, r], make, |l| parallel_turns(l, [p, p, p], regional_slides));
        assert_eq!((tally.lost, tally.most), (0, 1));
        assert!(tally.worst < if SINGLE { 1e-3 } else { 1e-12 });
    }

    #[test]
    fn a_tilted_pose_is_out_of_reach_of_parallel_axes() {
        let random = &mut Random(30);
        for k in 0..=16 {
            let tilt = 10f64.powi(-k) as Real;
            let prismatic = [true, false, false, false];
            let joints = values(&prismatic, random);
            let mut links = closed([flat(random), flat(random), link(0.1, 0.2, 0.0), IDENTITY], &prismatic, 3, &joints);
            let (c, s) = small_turn(tilt.min(0.5));
            links[3] = compose(&[[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0]], &links[3]);
            let found = parallel_turns(&links, [true, false, false], regional_slide_elbow);
            if tilt > 4.0 * ROUNDING {
                assert!(found.count == 0 && found.miss > 0.5 * tilt, "{k}: {found:?}");
            } else if tilt < 0.1 * ROUNDING {
                assert!(found.count > 0, "{k}: {found:?}");
            }
        }
    }

    /// Links whose turn between the revolute joints `turning` is about x, whatever prismatic joints stand between.
    fn about_x(turning: &[usize], random: &mut Random) -> [Frame; 6] {
        let mut links: [Frame; 6] = std::array::from_fn(|_| any(random));
        for pair in turning.windows(2) {
            let mut chain = IDENTITY;
            for link in &links[pair[0]..pair[1] - 1] {
                chain = compose(&chain, link);
            }
            let turn = link(random.between(-0.3, 0.3), random.between(-0.3, 0.3), random.between(0.4, 2.7));
            links[pair[1] - 1] = compose(&inverse(&chain), &turn);
        }
        links
    }

    #[test]
    fn two_prismatic_joints_anywhere() {
        let places = [[1, 3], [2, 4], [1, 4], [1, 5], [2, 5], [3, 5], [1, 2], [3, 4], [4, 5]];
        for (seed, slides) in places.into_iter().enumerate() {
            let prismatic: [bool; 6] = std::array::from_fn(|i| slides.contains(&i));
            let turning: Vec<usize> = (1..6).filter(|i| !prismatic[*i]).collect();
            for open in [0, 5] {
                let first = turning[0] > 1 && open == 0;
                let make = |r: &mut Random| (about_x(&turning, r), if first || turning[0] == 1 { open } else { 5 });
                let tally = tally(50 + seed as u64, prismatic, make, |l| two_slides(l, slides, 0.5));
                assert_eq!((tally.lost, tally.odd), (0, 0));
                assert!(tally.most >= 4 && tally.most <= 8);
                // Slides that go far leave as many times the rounding of their lengths.
                assert!(tally.worst < if SINGLE { 1e-3 } else { 1e-11 });
                assert!(tally.doubtful <= if SINGLE { 250 } else { 5 });
            }
        }
    }

    #[test]
    fn three_prismatic_joints_anywhere() {
        for (seed, turning) in [[0, 1, 2], [0, 2, 4], [3, 4, 5], [1, 2, 5], [0, 3, 5]].into_iter().enumerate() {
            let prismatic: [bool; 6] = std::array::from_fn(|i| !turning.contains(&i));
            let make = |r: &mut Random| (about_x(&turning, r), 5);
            let tally = tally(31 + seed as u64, prismatic, make, |l| three_prismatic(l, turning));
            assert_eq!((tally.lost, tally.odd, tally.most), (0, 0, 2));
            // Directions of slides may be near a plane.
            assert!(tally.worst < if SINGLE { 0.05 } else { 1e-10 });
        }
    }
}
