//! Block 8: general arms, one prismatic joint anywhere, two neighbours.

in_both_scalars! {
    #[allow(unreachable_pub, dead_code)]
    mod arm {
        use super::*;
        include!("common/arm.rs");
    }
    use arm::*;

    const SINGLE: bool = UNIT_ROUNDOFF > 1e-10;

    fn general(random: &mut Random, prismatic: &[usize]) -> Arm {
        let rows: Vec<_> = (0..6)
            .map(|_| (random.angle(), random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.angle()))
            .collect();
        Arm::standard(&rows, prismatic)
    }

    fn solve(arm: &Arm, t: &Frame, start: usize, backward: bool) -> ([usize; 6], Arranged) {
        let (order, links) = arranged::<6>(arm, t, start, backward);
        (order, determinant_on_circle(&links, order.map(|i| arm.prismatic[i]), arm.length()))
    }

    #[derive(Debug, Default)]
    struct Tally {
        lost: usize,
        odd: usize,
        doubtful: usize,
        worst: Real,
        noise: Real,
        most: usize,
    }

    fn tally(arm: &Arm, start: usize, backward: bool, poses: usize, random: &mut Random) -> Tally {
        let mut tally = Tally::default();
        for _ in 0..poses {
            let q = arm.posture(random);
            let t = arm.at(&q);
            let (order, result) = solve(arm, &t, start, backward);
            let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
            let mut found = false;
            for branch in result.found.found() {
                let joints = in_order(&order, &branch.joints);
                if !branch.double {
                    tally.worst = tally.worst.max(defect(&arm.forward(&joints), &t));
                }
                found |= apart(&joints, &values) < 1e3 * UNIT_ROUNDOFF.sqrt();
            }
            tally.noise = tally.noise.max(result.noise);
            tally.most = tally.most.max(result.found.count);
            if !result.complete || result.found.found().iter().any(|b| b.double) {
                tally.doubtful += 1;
                continue;
            }
            tally.lost += usize::from(!found);
            tally.odd += usize::from(result.found.count % 2 == 1);
        }
        println!("{tally:?}");
        tally
    }

    /// Rounding of six frames.
    const CLOSE: Real = 4.0 * CLOSED;

    #[test]
    fn general_arms_lose_nothing() {
        let random = &mut Random(1);
        for prismatic in [&[][..], &[], &[], &[0], &[1], &[3], &[4], &[0, 1]] {
            for (start, backward) in [(0, false), (3, true)] {
                // The joints that the loop meets at the places that may slide.
                let arm = general(random, prismatic);
                let (start, backward) = if prismatic.is_empty() { (start, backward) } else { (0, false) };
                let tally = tally(&arm, start, backward, 300, random);
                assert_eq!((tally.lost, tally.odd), (0, 0));
                assert!(tally.doubtful <= if SINGLE { 150 } else { 3 } && tally.worst < CLOSE, "{prismatic:?}");
                assert!(tally.noise < if SINGLE { 1.0 } else { 1e-9 } && tally.most >= 4);
            }
        }
    }

    #[test]
    fn two_slides_in_the_other_pair_leave_nothing_to_find() {
        let random = &mut Random(2);
        let arm = general(random, &[3, 4]);
        let q = arm.posture(random);
        let (_, result) = solve(&arm, &arm.at(&q), 0, false);
        assert!(result.free && !result.complete && result.found.count == 0);
    }

    #[test]
    fn out_of_reach_has_a_miss() {
        let random = &mut Random(3);
        let arm = general(random, &[]);
        let q = arm.posture(random);
        let mut t = arm.at(&q);
        t[0][3] += 12.0 as Real;
        let (_, result) = solve(&arm, &t, 0, false);
        assert!(result.complete && result.found.count == 0);
        // The sum of all links' lengths is below 6 x 0.71.
        assert!(result.found.miss > 1.0 && result.found.miss < 20.0, "{}", result.found.miss);
        for entry in [Real::NAN, Real::INFINITY, -Real::MAX] {
            let mut t = t;
            t[1][2] = entry;
            let (_, result) = solve(&arm, &t, 0, false);
            assert!(result.found.count == 0 && !result.complete);
        }
    }

    /// A Puma with joint 1 suppressed: postures of elbow and wrist share q1, so every root is a multiple one and its kernel not one-dimensional; two
    /// members of each of the two kernels are found.
    #[test]
    fn solutions_that_share_the_suppressed_joint() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let rows = [(0.0, 0.67, 0.0, quarter), (0.0, 0.0, 0.43, 0.0), (0.0, 0.15, 0.02, -quarter), (0.0, 0.43, 0.0, quarter), (0.0, 0.0, 0.0, -quarter), (0.0, 0.0, 0.0, 0.0)];
        let arm = Arm::standard(&rows, &[]);
        let random = &mut Random(5);
        let mut both = 0;
        for _ in 0..100 {
            let t = arm.at(&arm.posture(random));
            let (_, result) = solve(&arm, &t, 4, false);
            // Single precision sees two neighbouring roots in place of each, which share two members each.
            assert!(!result.complete || result.found.count == 8, "{} of {} roots, noise {}", result.found.count, result.roots, result.noise);
            both += usize::from(result.found.count >= 4);
        }
        assert!(both >= if SINGLE { 20 } else { 98 }, "{both}");
    }

    /// Two solutions that meet: found as one and double; 1e-4 to either side, two or none, and neither double.
    #[test]
    fn folds() {
        if SINGLE {
            return;
        }
        let random = &mut Random(4);
        let arm = general(random, &[]);
        let (mut met, mut apart_) = (0, 0);
        while met < 20 {
            // From a posture along its null motion: where the determinant of the Jacobian changes its sign between two postures.
            let (x, y) = (arm.posture(random), arm.posture(random));
            let at = |s: f64| -> Vec<f64> { x.iter().zip(&y).map(|(x, y)| x + s * (y - x)).collect() };
            let (mut low, mut high) = (0.0, 1.0);
            if (volume(&arm, &at(low)) > 0.0) == (volume(&arm, &at(high)) > 0.0) {
                continue;
            }
            for _ in 0..80 {
                let mid = 0.5 * (low + high);
                if (volume(&arm, &at(mid)) > 0.0) == (volume(&arm, &at(low)) > 0.0) { low = mid } else { high = mid }
            }
            let q = at(low);
            let t = arm.at(&q);
            let (order, result) = solve(&arm, &t, 0, false);
            let values: Vec<_> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
            let here = |b: &Branch<6>| apart(&in_order(&order, &b.joints), &values) < 1e-5;
            let doubles = result.found.found().iter().filter(|b| b.double).count();
            assert!(doubles > 0 || result.found.near, "{:?} {result:?}", volume(&arm, &q));
            assert!(result.found.found().iter().all(|b| b.double == here(b)), "{result:?} {values:?}");
            met += 1;
            // Poses beside it: counts differ by two, and nothing is double.
            let mut counts = vec![];
            for s in [-1e-4, 1e-4] {
                let mut t = t;
                t[0][3] += s * arm.length();
                let (_, beside) = solve(&arm, &t, 0, false);
                if beside.complete && beside.found.found().iter().all(|b| !b.double) {
                    counts.push(beside.found.count);
                }
            }
            if let [x, y] = counts[..] {
                assert!(x % 2 == 0 && y % 2 == 0);
                apart_ += usize::from(x.abs_diff(y) == 2);
            }
        }
        assert!(apart_ >= 15, "{apart_} of {met}");
    }

    /// The determinant of the Jacobian, by elimination.
    fn volume(arm: &Arm, q: &[f64]) -> Real {
        let mut axes = vec![];
        let mut t = arm.c[0];
        for (i, q) in q.iter().enumerate() {
            axes.push((column(&t, 2), column(&t, 3)));
            t = compose(&t, &joint_then(false, arm.value(i, *q), &arm.c[i + 1]));
        }
        let mut m: Vec<Vec<Real>> = vec![vec![0.0; 6]; 6];
        for (j, (z, p)) in axes.iter().enumerate() {
            let v = cross(*z, minus(column(&t, 3), *p));
            for k in 0..3 {
                m[k][j] = v[k];
                m[k + 3][j] = z[k];
            }
        }
        let mut volume = 1.0;
        for k in 0..6 {
            let p = (k..6).max_by(|i, j| m[*i][k].abs().total_cmp(&m[*j][k].abs())).unwrap();
            if p != k {
                m.swap(p, k);
                volume = -volume;
            }
            volume *= m[k][k];
            for i in k + 1..6 {
                let f = m[i][k] / m[k][k];
                for j in k..6 {
                    m[i][j] -= f * m[k][j];
                }
            }
        }
        volume
    }
}
