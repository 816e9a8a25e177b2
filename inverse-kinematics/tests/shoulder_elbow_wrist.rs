//! Seven joints at a swivel angle: every posture found, with its pose and its angle; the elbow turns by as much as the angle does.

in_both_scalars! {
    #[allow(unreachable_pub, dead_code)]
    mod arm {
        use super::*;
        include!("common/arm.rs");
    }
    use arm::*;

    const SINGLE: bool = UNIT_ROUNDOFF > 1e-10;

    /// Twists of the seven joints, offsets at the elbow, and the arm on a base that is turned and moved.
    fn made(twists: [f64; 7], offset: f64) -> (Arm, Arrangement<7>) {
        let lengths = [0.36, 0.0, 0.42, 0.05, 0.4, 0.0, 0.126];
        let beside = [0.0, 0.0, offset, -0.7 * offset, 0.0, 0.0, 0.03];
        let rows: Vec<_> = (0..7).map(|i| (0.0, if offset == 0.0 && i == 3 { 0.0 } else { lengths[i] }, beside[i], twists[i])).collect();
        let mut arm = Arm::standard(&rows, &[]);
        arm.c[0] = row(0.3, 0.1, -0.2, 0.7);
        let way = Arrangement {
            order: [0, 1, 2, 3, 4, 5, 6],
            prismatic: [false; 7],
            links: std::array::from_fn(|i| arm.c[i + 1]),
            open: 6,
            before: arm.c[7],
            after: arm.c[0],
            backward: false,
            offsets: [[1.0, 0.0]; 7],
        };
        (arm, way)
    }

    fn arms() -> [(Arm, Arrangement<7>); 3] {
        let q = std::f64::consts::FRAC_PI_2;
        [made([-q, q, q, -q, -q, q, 0.0], 0.0), made([-q, q, q, -q, -q, q, q], 0.08), made([0.9, -1.1, 1.2, -0.8, 1.4, -0.7, 0.5], 0.05)]
    }

    fn angles(arm: &Arm, random: &mut Random) -> [Real; 7] {
        let q = arm.posture(random);
        std::array::from_fn(|i| q[i] as Real)
    }

    fn points_of(q: &[Real; 7]) -> [[Real; 2]; 7] {
        q.map(|q| [q.cos(), q.sin()])
    }

    #[test]
    fn every_posture_has_its_pose_and_its_angle() {
        let random = &mut Random(1);
        for (arm, way) in arms() {
            let (mut complete, mut lost, mut worst, mut worst_angle): (usize, usize, Real, Real) = (0, 0, 0.0, 0.0);
            let mut counts = [0usize; 9];
            for _ in 0..2000 {
                let q = angles(&arm, random);
                let t = arm.forward(&points_of(&q));
                let swivel = swivel_angle(&way, &q);
                let found = shoulder_elbow_wrist(&way, &t, swivel);
                if found.near || found.found().iter().any(|b| b.double || b.free != 0) {
                    continue;
                }
                complete += 1;
                counts[found.count] += 1;
                for branch in found.found() {
                    worst = worst.max(defect(&arm.forward(&branch.joints), &t));
                    let other = swivel_angle(&way, &branch.joints.map(|[c, s]| s.atan2(c)));
                    // A height of the elbow of 1e-3 costs three digits of its direction.
                    worst_angle = worst_angle.max((0.5 * (other - swivel)).sin().abs());
                }
                lost += usize::from(!found.found().iter().any(|b| apart(&b.joints, &points_of(&q)) < if SINGLE { 5e-2 } else { 1e-7 }));
            }
            println!("{complete} complete, {lost} lost, counts {counts:?}, T to {worst:e}, angle to {worst_angle:e}");
            assert!(complete > if SINGLE { 1500 } else { 1990 });
            assert!(lost == 0 || SINGLE && lost * 1000 <= complete);
            assert!(worst < if SINGLE { 1e-5 } else { 1e-14 } && worst_angle < if SINGLE { 2e-2 } else { 1e-10 });
            assert!(counts.iter().skip(1).step_by(2).all(|odd| *odd == 0) && counts[8] > 0);
        }
    }

    /// The elbow goes round the line from shoulder to wrist by what is added to the angle, and all else stays.
    #[test]
    fn the_elbow_turns_by_the_angle() {
        let random = &mut Random(2);
        for (arm, way) in arms() {
            for _ in 0..200 {
                let q = angles(&arm, random);
                let t = arm.forward(&points_of(&q));
                let (swivel, more) = (swivel_angle(&way, &q), random.angle() as Real);
                let places = |joints: &[[Real; 2]; 7]| {
                    let mut at = arm.c[0];
                    let mut origins = vec![];
                    for (i, value) in joints.iter().enumerate() {
                        at = compose(&at, &joint_then(false, *value, &arm.c[i + 1]));
                        origins.push(column(&at, 3));
                    }
                    // S, E, W.
                    [origins[0], origins[2], origins[4]]
                };
                let [s, e, w] = places(&points_of(&q));
                let along = minus(w, s);
                let size = dot(along, along).sqrt();
                let k = along.map(|x| x / size);
                let v = minus(e, s);
                let (c, sine) = (more.cos(), more.sin());
                let (kv, kxv) = (dot(k, v), cross(k, v));
                // Rodrigues' formula.
                let turned: Vector = std::array::from_fn(|i| s[i] + c * v[i] + sine * kxv[i] + (1.0 - c) * kv * k[i]);
                let found = shoulder_elbow_wrist(&way, &t, swivel + more);
                for branch in found.found() {
                    let [s2, e2, w2] = places(&branch.joints);
                    let tolerance = if SINGLE { 5e-3 } else { 1e-11 };
                    if branch.double || branch.free != 0 {
                        continue;
                    }
                    assert!(minus(s2, s).iter().chain(&minus(w2, w)).all(|x| x.abs() < tolerance));
                    // One elbow or, where they differ, the other.
                    let same = (dot(minus(e2, s), k) - kv).abs() < tolerance;
                    assert!(!same || minus(e2, turned).iter().all(|x| x.abs() < tolerance), "{e2:?} {turned:?}");
                }
                assert!(found.near || found.count == 0 || found.found().iter().any(|b| (dot(minus(places(&b.joints)[1], s), k) - kv).abs() < 5e-3));
            }
        }
    }

    #[test]
    fn degenerate_poses_are_said() {
        let [(arm, way), ..] = arms();
        // Stretched, with shoulder, elbow and wrist on the axes of joints 3 and 5: these can move, against each other.
        let q = points_of(&[0.3, 0.4, -0.5, 0.0, 0.7, 0.8, 0.2]);
        let t = arm.forward(&q);
        let found = shoulder_elbow_wrist(&way, &t, 0.3);
        assert!(found.count > 0);
        for branch in found.found() {
            assert_eq!(branch.free, 0b0010100);
            let [.., q3, _, q5, _, _] = branch.joints;
            let turned = |[c, s]: [Real; 2], by: Real| [c * by.cos() - s * by.sin(), s * by.cos() + c * by.sin()];
            let mut moved = branch.joints;
            (moved[2], moved[4]) = (turned(q3, 0.7), turned(q5, -0.7));
            assert!(defect(&arm.forward(&moved), &t) < if SINGLE { 1e-3 } else { 1e-7 });
            assert!(defect(&arm.forward(&branch.joints), &t) < if SINGLE { 1e-3 } else { 1e-7 });
        }
        // Beyond.
        let mut far = t;
        far[0][3] += 3.0;
        let found = shoulder_elbow_wrist(&way, &far, 0.3);
        assert!(found.count == 0 && found.miss > 0.5 && found.miss < 6.0, "{}", found.miss);
    }

    /// The wrist straight below the shoulder, the pole of the swivel angle's reference, and beside it by ever less, until squares of that vanish.
    #[test]
    fn postures_beside_the_pole_have_their_pose() {
        let [_, turned, _] = arms();
        let [_, (mut upright, mut upright_way), _] = arms();
        (upright.c[0], upright_way.after) = (IDENTITY, IDENTITY);
        for (arm, way) in [turned, (upright, upright_way)] {
            let t0 = arm.forward(&points_of(&[0.3, 0.9, -0.5, 1.0, 0.7, 0.8, 0.2]));
            let goal = inverse(&way.links_at(&t0)[6]);
            let to_wrist = minus(column(&goal, 3), [0.0, 0.0, arm.c[1][2][3]]);
            let (now, below) = (rotate(&arm.c[0], to_wrist), -dot(to_wrist, to_wrist).sqrt());
            for decade in 3..200 {
                let off = (10.0 as Real).powi(-decade);
                for beside in [[0.3 * off, -0.8 * off], [0.0, off], [off, 0.0]] {
                    let mut t = t0;
                    for (row, (x, to)) in t.iter_mut().zip(now.iter().zip([beside[0], beside[1], below])) {
                        row[3] += to - x;
                    }
                    let found = shoulder_elbow_wrist(&way, &t, 0.3);
                    assert!(found.count > 0 && (found.near || off > ROUNDING), "{off}");
                    for branch in found.found() {
                        let missed = defect(&arm.forward(&branch.joints), &t);
                        assert!(missed < if SINGLE { 1e-5 } else { 1e-13 }, "{missed} beside the pole by {off}");
                    }
                }
            }
        }
    }
}
