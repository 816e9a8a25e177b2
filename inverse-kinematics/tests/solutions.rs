//! What the emitted module makes of a construction's solutions: verdicts, order, limits, the nearest posture.

mod arm {
    #![allow(
        dead_code,
        unreachable_pub,
        clippy::approx_constant,
        clippy::excessive_precision,
        clippy::eq_op,
        clippy::neg_cmp_op_on_partial_ord
    )]
    use crate::common::Random;

    const DOF: usize = 2;
    const LENGTH: Real = 2.0;
    const MAX_SOLUTIONS: usize = 4;
    const PRISMATIC: [bool; DOF] = [false, true];
    const POSITION_LIMITS: [[Real; 2]; DOF] = [[3.0, 9.0], [-1.0, Real::INFINITY]];

    // As in an emitted module: the methods of a type stand where the type does.
    include!("../src/blocks/scalar_f64.rs");
    include!("../src/blocks/frame.rs");
    include!("../src/blocks/angles.rs");
    include!("../src/blocks/line_and_circle.rs");
    include!("../src/blocks/branches.rs");
    include!("../src/blocks/postures.rs");
    include!("../src/blocks/solutions.rs");

    fn concluded(found: &Branches<3, 4>, by_angle: bool) -> Solutions {
        conclude(found, PRISMATIC, by_angle)
    }

    fn branch(angle: Real, slide: Real, signs: u16) -> Branch<3> {
        Branch { joints: [[angle.cos(), angle.sin()], [slide, 0.0], [1.0, 0.0]], signs, double: false, error: 0.0, free: 0 }
    }

    fn with(branches: &[Branch<3>]) -> Branches<3, 4> {
        let mut found = Branches::new();
        branches.iter().for_each(|b| found.add(*b));
        found
    }

    #[test]
    fn verdicts_and_their_order() {
        let regular = branch(1.0, 0.5, 0);
        let (double, free) = (Branch { double: true, ..regular }, Branch { free: 2, ..regular });
        let verdict = |found: &Branches<3, 4>| concluded(found, false).verdict;
        assert_eq!(verdict(&with(&[])), Verdict::Unreachable);
        assert_eq!(verdict(&with(&[regular])), Verdict::Complete);
        assert_eq!(verdict(&with(&[regular, double])), Verdict::NearDouble);
        assert_eq!(verdict(&with(&[double, free])), Verdict::Continuum);
        assert_eq!(concluded(&with(&[double, free]), false).all[1].free, 2);
        assert_eq!(verdict(&Branches { near: true, ..with(&[]) }), Verdict::NearDouble);
        assert_eq!(verdict(&Branches { continuum: true, ..with(&[]) }), Verdict::Continuum);
        // A joint beyond those of the arm is virtual; that it can move is a continuum of nothing that is shown.
        assert_eq!(concluded(&with(&[Branch { free: 4, ..regular }]), false).all[0].free, 0);
        let none = concluded(&Branches { miss: 0.25, ..with(&[]) }, false);
        assert_eq!((none.miss, none.count), (0.25, 0));
        assert_eq!(concluded(&Branches { miss: 0.25, ..with(&[regular]) }, false).miss, 0.0);
        // Not a number is no solution, and nothing is certain then.
        let infinite = Branch { joints: [[0.0, Real::INFINITY], [0.5, 0.0], [1.0, 0.0]], ..regular };
        for off in [branch(Real::NAN, 0.0, 0), infinite, branch(1.0, Real::NEG_INFINITY, 0)] {
            let lost = concluded(&with(&[off, regular]), false);
            assert_eq!((lost.count, lost.verdict, lost.all[1].q), (1, Verdict::NearDouble, [0.0; 2]));
        }
    }

    #[test]
    fn order_and_zeros() {
        let found = with(&[branch(2.0, 0.0, 3), branch(-1.0, 0.5, 1), branch(-1.0, 0.25, 2)]);
        let by_branch = concluded(&found, false);
        assert_eq!(by_branch.as_slice().iter().map(|s| s.branch).collect::<Vec<_>>(), [1, 2, 3]);
        let by_angle = concluded(&found, true);
        assert_eq!(by_angle.as_slice().iter().map(|s| s.branch).collect::<Vec<_>>(), [2, 1, 3]);
        assert_eq!(by_angle.all[3].q, [0.0; 2]);
        // The half turn is pi, whichever way its sine is rounded.
        let half = Branch { joints: [[-1.0, -0.0], [0.0, 0.0], [1.0, 0.0]], ..branch(0.0, 0.0, 0) };
        assert_eq!(concluded(&with(&[half]), false).all[0].q[0], std::f64::consts::PI);
    }

    #[test]
    fn limits_by_whole_turns() {
        let turn = std::f64::consts::TAU;
        let found =
            concluded(&with(&[branch(3.05, 0.0, 0), branch(-1.0, 0.0, 1), branch(3.05, -2.0, 2), branch(0.0, 0.0, 3)]), false);
        let within = found.within_limits();
        assert_eq!(within.verdict, found.verdict);
        let q: Vec<_> = within.as_slice().iter().map(|s| (s.branch, s.q[0])).collect();
        // 3.05 is inside; -1 and 0 are moved by one turn; the slide of branch 2 is outside.
        assert_eq!(q.len(), 3);
        for ((branch, q), (wanted, angle)) in q.into_iter().zip([(0, 3.05), (1, turn - 1.0), (3, turn)]) {
            assert_eq!(branch, wanted);
            assert!((q - angle).abs() < 1e-15 * 8.0, "{q} {angle}");
        }
        assert_eq!(whole_turns_between(-0.5, 0.5), 0.0);
        assert_eq!(whole_turns_between(0.25, 0.75), 0.0);
        assert_eq!(whole_turns_between(1.5, 3.0), 2.0);
        assert_eq!(whole_turns_between(-3.0, -1.5), -2.0);
        assert_eq!(whole_turns_between(Real::NEG_INFINITY, Real::INFINITY), 0.0);
    }

    /// Rounding puts a posture at a limit beside it: it is kept, and put back; one that is further away is not.
    #[test]
    fn limits_are_met_to_rounding() {
        let mut random = Random(17);
        for _ in 0..10_000 {
            let dust = 10f64.powf(random.between(-17.0, -8.0)) * if random.between(-1.0, 1.0) < 0.0 { -1.0 } else { 1.0 };
            let limit = random.below(3);
            let at = |dust: f64| {
                let (angle, slide) = [(3.0 + dust, 0.5), (9.0 - dust, 0.5), (5.0, -1.0 + LENGTH * dust)][limit];
                concluded(&with(&[branch(angle, slide, 0)]), false).within_limits()
            };
            let q = at(dust).as_slice().first().expect("dropped").q;
            assert!((3.0..=9.0).contains(&q[0]) && -1.0 <= q[1], "{q:?}");
            // Beyond what rounding does.
            assert_eq!(at(-1.5e-8).count, 0, "{limit}");
        }
    }

    /// A pose with few digits is a rotation to these: `miss` tells it, and a limit is met to what such a pose moves nearly singular postures by.
    #[test]
    fn limits_are_met_to_the_digits_of_the_pose() {
        let beyond = concluded(&with(&[branch(3.0 - 1e-6, 0.5, 0)]), false);
        assert_eq!(beyond.of_rotation(&IDENTITY), beyond);
        assert_eq!(beyond.within_limits().count, 0);
        let mut off = IDENTITY;
        off[0][0] += 1e-9;
        let found = beyond.of_rotation(&off);
        assert!((found.miss - 2e-9).abs() < 1e-15, "{}", found.miss);
        let within = found.within_limits();
        assert_eq!((within.count, within.all[0].q[0], within.miss), (1, 3.0, found.miss));
        let far = concluded(&with(&[branch(3.0 - 1e-5, 0.5, 0)]), false).of_rotation(&off);
        assert_eq!(far.within_limits().count, 0);
        let none = Solutions { miss: 0.25, ..Solutions::none(Verdict::Unreachable) };
        assert_eq!(none.of_rotation(&off).miss, 0.25);
    }

    #[test]
    fn nearest_modulo_turns() {
        let found = concluded(&with(&[branch(3.0, 0.0, 0), branch(-1.0, 0.0, 1)]), false);
        let branch_at = |q: [Real; 2]| found.nearest_to(&q).map(|s| s.branch);
        assert_eq!(branch_at([-3.0, 0.0]), Some(0));
        assert_eq!(branch_at([-0.5 + 4.0 * std::f64::consts::PI, 0.0]), Some(1));
        assert_eq!(branch_at([1.0, 9.0]), Some(0), "the slide decides, the first of equals");
        assert_eq!(Solutions::none(Verdict::Unreachable).nearest_to(&[0.0; 2]), None);
        assert_eq!(branch_at([Real::NAN, 0.0]), Some(0), "only finite differences count");
    }

    #[test]
    fn poses() {
        let rows = |f: Frame| [f[0], f[1], f[2], [5.0; 4]];
        assert!(is_pose(&rows(IDENTITY)), "the last row is finite, and that is all that is asked of it");
        for place in 0..16 {
            for entry in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY] {
                let mut t = rows(IDENTITY);
                t[place / 4][place % 4] = entry;
                assert!(!is_pose(&t) && !all_finite(&t), "{place} {entry}");
            }
        }
        let mut t = IDENTITY;
        t[2][2] = -1.0;
        assert!(!is_pose(&rows(t)), "left-handed");
        for (row, column, entry) in [
            (0, 0, 1.0 + 2e-6),
            (0, 1, 2e-6),
            (1, 1, 1.0 - 2e-6),
            (2, 0, 2e-6),
            (2, 1, -2e-6),
            (2, 2, 1.0 + 2e-6),
            (2, 2, -1.0),
            (1, 3, Real::INFINITY),
            (2, 2, Real::NAN),
        ] {
            let mut t = IDENTITY;
            t[row][column] = entry;
            assert!(!is_pose(&rows(t)), "{row} {column} {entry}");
        }
        t = IDENTITY;
        t[0][0] = 1.0 + 0.4e-6;
        assert!(is_pose(&rows(t)));
    }
}
