//! Blocks 1 to 5: each alone, at random, degenerate and nearly degenerate arguments, against the equation that it solves.

in_both_scalars! {
    /// A handful of roundings.
    const FEW: Real = 32.0 * UNIT_ROUNDOFF;

    fn real(random: &mut Random, low: f64, high: f64) -> Real {
        random.between(low, high) as Real
    }

    fn point(angle: f64) -> [Real; 2] {
        [angle.cos() as Real, angle.sin() as Real]
    }

    /// 10^-k.
    fn tenth(k: i32) -> Real {
        10f64.powi(-k) as Real
    }

    fn on_circle([c, s]: [Real; 2]) {
        assert!((c * c + s * s - 1.0).abs() <= FEW, "({c}, {s}) is not on the circle");
    }

    #[test]
    fn angles_of_points() {
        let random = &mut Random(9);
        let mut angles: Vec<f64> = (0..4000).map(|_| random.angle()).collect();
        angles.extend([0.0, 1e-9, -1e-9, std::f64::consts::PI, 3.0, -3.0]);
        // On either side of where the coordinates are exchanged.
        for eighths in [1.0, 3.0, 5.0, 7.0] {
            angles.extend([-1e-7, 0.0, 1e-7].map(|off| eighths * std::f64::consts::FRAC_PI_4 + off));
        }
        for t in angles {
            let [c, s] = point(t);
            // A point that rounding has taken off the circle has the angle all the same.
            for over in [1.0, 1.0 + 8.0 * UNIT_ROUNDOFF, 1.0 - 8.0 * UNIT_ROUNDOFF, 1.0 + sqrt(UNIT_ROUNDOFF)] {
                let [c, s] = [c * over, s * over];
                let (found, wanted) = (angle([c, s]) as f64, (s as f64).atan2(c as f64));
                let off = (found - wanted).abs();
                let allowed = UNIT_ROUNDOFF as f64 * (4.0 * wanted.abs() + if wanted.abs() > 1.0 { 6.5 } else { 0.0 });
                assert!(off.min((off - 2.0 * std::f64::consts::PI).abs()) <= allowed, "{t} {over}: {found} {wanted} {off:e}");
                assert!(-HALF_TURN < found as Real && found as Real <= HALF_TURN);
            }
        }
        for (point, wanted) in [([1.0, 0.0], 0.0), ([0.0, 1.0], 0.5), ([0.0, -1.0], -0.5), ([-1.0, 0.0], 1.0), ([-1.0, -0.0], 1.0)] {
            assert_eq!(angle(point), wanted * HALF_TURN);
        }
        assert_eq!(angle([-1.0, -0.01 * UNIT_ROUNDOFF]), HALF_TURN, "-pi is pi");
        for off in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY] {
            assert!(angle([off, 0.0]).is_nan() && angle([0.5, off]).is_nan() && angle([off, off]).is_nan());
        }
    }

    #[test]
    fn line_and_circle_meets_its_equation() {
        let random = &mut Random(1);
        for _ in 0..2000 {
            let (a, b, d) = (real(random, -1.0, 1.0), real(random, -1.0, 1.0), real(random, -1.5, 1.5));
            let r = length(a, b);
            let found = line_and_circle(a, b, d, FEW, 0.0);
            if (r - d.abs()).abs() < 1e-3 {
                continue;
            }
            assert_eq!(found.count, if r > d.abs() { 2 } else { 0 }, "{a} {b} {d}");
            assert!((found.miss - (d.abs() - r).max(0.0)).abs() <= FEW);
            for &[c, s] in &found.points[..found.count] {
                on_circle([c, s]);
                assert!((a * c + b * s - d).abs() <= FEW, "{a} {b} {d}");
            }
            if found.count == 2 {
                // The first is anticlockwise from (a, b) d: a right turn leads back to the direction.
                let [c, s] = found.points[0];
                assert!(a * s - b * c > 0.0);
            }
        }
    }

    #[test]
    fn line_and_circle_keeps_its_digits_near_contact() {
        for k in 0..=16 {
            let d = 1.0 - tenth(k);
            let found = line_and_circle(1.0, 0.0, d, 4.0 * UNIT_ROUNDOFF, 0.0);
            // 1 - d is exact.
            let s = ((1.0 - d) * (1.0 + d)).sqrt();
            if 1.0 - d > 4.0 * UNIT_ROUNDOFF {
                assert_eq!((found.count, found.double), (2, false), "10^-{k}");
                assert!((found.points[0][1] - s).abs() <= 4.0 * UNIT_ROUNDOFF * s, "10^-{k}");
                assert_eq!(found.points[1][1], -found.points[0][1]);
            } else {
                assert_eq!((found.count, found.double, found.points[0]), (1, true, [1.0, 0.0]), "10^-{k}");
            }
            let beyond = line_and_circle(1.0, 0.0, -1.0 - tenth(k), 4.0 * UNIT_ROUNDOFF, 0.0);
            if tenth(k) > 8.0 * UNIT_ROUNDOFF {
                assert_eq!(beyond.count, 0);
                assert!((beyond.miss - tenth(k)).abs() <= 2.0 * UNIT_ROUNDOFF);
            } else {
                assert_eq!((beyond.count, beyond.double, beyond.points[0]), (1, true, [-1.0, 0.0]));
            }
        }
    }

    #[test]
    fn line_and_circle_without_a_line() {
        let found = line_and_circle(0.0, 0.0, 0.0, FEW, 0.0);
        assert_eq!((found.count, found.free, found.double), (1, true, false));
        let found = line_and_circle(0.0, FEW / 2.0, -FEW / 2.0, FEW, 0.0);
        assert_eq!((found.count, found.free), (1, true));
        let found = line_and_circle(0.0, 0.0, 0.25, FEW, 0.0);
        assert_eq!((found.count, found.free, found.miss), (0, false, 0.25));
        for (a, b, d) in [(Real::NAN, 0.0, 0.0), (1.0, Real::NAN, 0.0), (1.0, 0.0, Real::NAN), (0.0, 0.0, Real::INFINITY)] {
            assert_eq!(line_and_circle(a, b, d, FEW, 0.0).count, 0);
        }
    }

    #[test]
    fn turn_takes_one_vector_to_the_other() {
        let random = &mut Random(2);
        for _ in 0..500 {
            let (angle, [c, s]) = { let t = random.angle(); (t, point(t)) };
            let x = [real(random, -1.0, 1.0), real(random, -1.0, 1.0)];
            let y = [c * x[0] - s * x[1], s * x[0] + c * x[1]];
            let found = turn(x, y, FEW);
            assert!((found.value[0] - c).abs() + (found.value[1] - s).abs() <= FEW / length(x[0], x[1]), "{angle}");
            assert_eq!((found.free, found.miss), (false, 0.0));
            let longer = turn(x, [1.5 * y[0], 1.5 * y[1]], FEW);
            assert!((longer.miss - 0.5 * length(x[0], x[1])).abs() <= FEW);
        }
        assert!(turn([0.0, 0.0], [0.0, FEW], FEW).free);
        let miss = turn([0.0, 0.0], [0.0, 0.5], FEW);
        assert_eq!((miss.free, miss.miss), (false, 0.5));
        assert!(!turn([Real::NAN, 0.0], [1.0, 0.0], FEW).free);
    }

    fn unit(random: &mut Random) -> Vector {
        let (z, t) = (random.between(-1.0, 1.0), random.angle());
        let r = (1.0 - z * z).sqrt();
        [(r * t.cos()) as Real, (r * t.sin()) as Real, z as Real]
    }

    fn turned(k: Vector, [c, s]: [Real; 2], v: Vector) -> Vector {
        let (along, across) = (dot(k, v), cross(k, v));
        std::array::from_fn(|i| along * k[i] + c * (v[i] - along * k[i]) + s * across[i])
    }

    #[test]
    fn two_turns_meet_their_equation() {
        let random = &mut Random(3);
        let mut regular = 0;
        for _ in 0..1000 {
            let (k1, k2, p2) = (unit(random), unit(random), unit(random));
            if dot(cross(k1, k2), cross(k1, k2)) < 0.01 {
                continue;
            }
            let (t1, t2) = (point(random.angle()), point(random.angle()));
            let p = turned(k1, [t1[0], -t1[1]], turned(k2, t2, p2));
            let noise = 4.0 * FEW;
            let found = two_turns(k1, p, k2, p2, noise);
            assert!(found.count == 2 || found.double, "{found:?}");
            let near = |x: [Real; 2], y: [Real; 2]| (x[0] - y[0]).abs() + (x[1] - y[1]).abs() < 16.0 * noise.sqrt();
            assert!((0..found.count).any(|i| near(found.first[i], t1) && near(found.second[i], t2)), "{found:?} {t1:?} {t2:?}");
            for i in 0..found.count {
                let (x, y) = (turned(k1, found.first[i], p), turned(k2, found.second[i], p2));
                assert!(minus(x, y).iter().all(|e| e.abs() <= 16.0 * noise), "{x:?} {y:?}");
            }
            regular += 1;
            let far = two_turns(k1, p.map(|x| 1.25 * x), k2, p2, noise);
            assert!(far.count == 0 && (far.miss - 0.25).abs() <= noise);
        }
        assert!(regular > 900);
    }

    #[test]
    fn two_turns_with_a_point_on_an_axis() {
        let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        // p on axis 1: reached by t2 = 90 degrees about x, whatever t1 is.
        let found = two_turns(z, z, x, [0.0, 1.0, 0.0], FEW);
        assert!(found.first_free && !found.second_free && found.count > 0);
        assert!((found.second[0][1] - 1.0).abs() <= FEW);
        // p2 on axis 2.
        let found = two_turns(z, [0.0, 1.0, 0.0], x, x, FEW);
        assert!(!found.first_free && found.second_free && found.count > 0);
        assert!((found.first[0][1] + 1.0).abs() <= FEW);
        // A cone about z, which contains x only if opened to a plane.
        let tilted = [0.6, 0.0, 0.8];
        assert_eq!(two_turns(z, tilted, x, x, FEW).count, 0);
        assert!(two_turns(z, tilted, x, x, FEW).miss > 0.1);
    }

    #[test]
    fn two_links_reach_their_point() {
        let random = &mut Random(4);
        for _ in 0..2000 {
            let (l1, l2) = (real(random, 0.2, 1.0), real(random, 0.2, 1.0));
            let [x, y] = point(random.angle());
            let distance = real(random, 0.0, 2.2);
            let p = [distance * x, distance * y];
            let found = two_links(l1, l2, p, FEW, 0.0);
            let (outer, inner) = (l1 + l2 - distance, distance - (l1 - l2).abs());
            if outer.abs() < 1e-3 || inner.abs() < 1e-3 {
                continue;
            }
            assert_eq!(found.count, if outer > 0.0 && inner > 0.0 { 2 } else { 0 });
            assert!((found.miss - (-outer).max(-inner).max(0.0)).abs() <= FEW);
            for i in 0..found.count {
                let ([c, s], [ce, se]) = (found.shoulder[i], found.elbow[i]);
                let (u, v) = (l1 + l2 * ce, l2 * se);
                assert!((c * u - s * v - p[0]).abs() + (s * u + c * v - p[1]).abs() <= 32.0 * FEW, "{l1} {l2} {p:?}");
                assert_eq!(se > 0.0, i == 0);
            }
        }
    }

    #[test]
    fn two_links_keep_their_digits_near_the_stretched_and_the_folded_arm() {
        for k in 0..=16 {
            for (l1, l2, edge) in [(0.5, 0.25, 0.75), (0.75, 0.25, 0.5)] {
                let inside = if edge == 0.75 { edge - 0.25 * tenth(k) } else { edge + 0.25 * tenth(k) };
                let found = two_links(l1, l2, [0.0, inside], 2.0 * UNIT_ROUNDOFF, 0.0);
                let gap = (inside - edge).abs();
                if gap > 2.0 * UNIT_ROUNDOFF {
                    // The product of four exact differences.
                    let product = (l1 + l2 - inside) * (l1 + l2 + inside) * (inside - (l1 - l2)) * (inside + (l1 - l2));
                    let s = product.sqrt() / (2.0 * l1 * l2);
                    assert_eq!((found.count, found.double), (2, false), "10^-{k}");
                    assert!((found.elbow[0][1] - s).abs() <= 8.0 * UNIT_ROUNDOFF * s, "10^-{k}: {} {s}", found.elbow[0][1]);
                } else {
                    assert_eq!((found.count, found.double, found.elbow[0][1]), (1, true, 0.0), "10^-{k}");
                }
            }
        }
    }

    /// A point that may be off by more than rounding says that two solutions may have met; both are given, and each meets what was asked.
    #[test]
    fn doubt_joins_no_solutions() {
        let doubt: Real = 0.01;
        for inside in [0.75 - 0.5 * doubt, 0.25 + 0.5 * doubt] {
            let found = two_links(0.5, 0.25, [0.0, inside], FEW, doubt);
            assert_eq!((found.count, found.double), (2, true), "{found:?}");
            for ([c, s], [ce, se]) in found.shoulder.iter().zip(&found.elbow) {
                let (u, v) = (0.5 + 0.25 * ce, 0.25 * se);
                assert!((c * u - s * v).abs() + (s * u + c * v - inside).abs() <= 32.0 * FEW, "{found:?}");
            }
            // Where doubt has taken the point out of reach, the posture nearest to it.
            let beyond = if inside > 0.5 { inside + doubt } else { inside - doubt };
            let found = two_links(0.5, 0.25, [0.0, beyond], FEW, doubt);
            assert_eq!((found.count, found.double, found.elbow[0][1]), (1, true, 0.0), "{found:?}");
        }
        let found = line_and_circle(1.0, 0.0, 1.0 - 0.5 * doubt, FEW, doubt);
        assert_eq!((found.count, found.double), (2, true), "{found:?}");
        assert!(found.points.iter().all(|[c, _]| (c - (1.0 - 0.5 * doubt)).abs() <= FEW), "{found:?}");
        let beyond = line_and_circle(1.0, 0.0, 1.0 + 0.5 * doubt, FEW, doubt);
        assert_eq!((beyond.count, beyond.double, beyond.points[0]), (1, true, [1.0, 0.0]), "{beyond:?}");
        // A point on the axis: any angle may meet a height that may be 0.
        let any = line_and_circle(0.0, 0.0, 0.5 * doubt, FEW, doubt);
        assert_eq!((any.count, any.double, any.free), (1, true, false), "{any:?}");
        assert!(any.error > 3.0, "{any:?}");
        assert_eq!(line_and_circle(0.0, 0.0, 1.5 * doubt, FEW, doubt).count, 0);
    }

    /// Near p = 0 what is computed of (x, y) has few digits of its own; its direction has length 1 all the same.
    #[test]
    fn two_links_nearly_folded_onto_the_shoulder() {
        let random = &mut Random(7);
        for k in 0..=14 {
            for _ in 0..100 {
                let (l, distance) = (real(random, 0.5, 1.0), tenth(k) * real(random, 0.1, 0.9));
                let [x, y] = point(random.angle());
                let found = two_links(l, l, [distance * x, distance * y], 4.0 * UNIT_ROUNDOFF, 0.0);
                if distance > 8.0 * UNIT_ROUNDOFF {
                    assert_eq!(found.count, 2, "10^-{k}");
                    found.shoulder.into_iter().for_each(on_circle);
                }
            }
        }
    }

    #[test]
    fn two_links_without_a_length() {
        let found = two_links(0.5, 0.5, [0.0, 0.0], FEW, 0.0);
        assert_eq!((found.count, found.shoulder_free, found.elbow[0][0]), (1, true, -1.0));
        let found = two_links(0.5, 0.0, [0.0, 0.5], FEW, 0.0);
        assert!(found.count == 1 && found.elbow_free && !found.shoulder_free);
        assert!((found.shoulder[0][1] - 1.0).abs() <= FEW);
        assert_eq!(two_links(0.5, 0.0, [0.0, 0.75], FEW, 0.0).miss, 0.25);
        assert_eq!(two_links(0.5, 0.25, [0.0, 0.0], FEW, 0.0).miss, 0.25);
        assert_eq!(two_links(0.5, 0.25, [Real::NAN, 0.0], FEW, 0.0).count, 0);
    }

    fn about_x([c, s]: [Real; 2]) -> Frame {
        [[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0]]
    }

    fn about_z(t: [Real; 2], f: &Frame) -> Frame {
        joint_then(false, t, f)
    }

    fn rotation(t: &[[Real; 2]; 3], alpha: [Real; 2], beta: [Real; 2]) -> Frame {
        let last = compose(&about_x(beta), &about_z(t[2], &IDENTITY));
        about_z(t[0], &compose(&about_x(alpha), &about_z(t[1], &last)))
    }

    fn defect(f: &Frame, g: &Frame) -> Real {
        let mut worst: Real = 0.0;
        for (f, g) in f.iter().flatten().zip(g.iter().flatten()) {
            worst = worst.max((f - g).abs());
        }
        worst
    }

    #[test]
    fn three_turns_give_back_their_rotation() {
        let random = &mut Random(5);
        for i in 0..2000 {
            let quarter = [0.0, if i % 4 < 2 { 1.0 } else { -1.0 }];
            let (alpha, beta) = match i % 3 {
                0 => (quarter, [0.0, 1.0]),
                1 => (quarter, point(random.between(0.3, 2.8))),
                _ => (point(random.between(0.3, 2.8)), point(random.between(-2.8, -0.3))),
            };
            let t = [point(random.angle()), point(random.angle()), point(random.angle())];
            let r = rotation(&t, alpha, beta);
            let found = three_turns(&r, alpha, beta, FEW, 0.0);
            assert_eq!(found.count, if found.double { 1 } else { 2 });
            assert!(!found.double || t[1][1].abs() < 8.0 * FEW.sqrt(), "{alpha:?} {beta:?} {t:?}");
            let near = |x: &[[Real; 2]; 3]| x.iter().flatten().zip(t.iter().flatten()).all(|(x, t)| (x - t).abs() < 16.0 * FEW.sqrt());
            assert!(found.turns.iter().any(near), "{found:?} {t:?}");
            for t in &found.turns[..found.count] {
                assert!(defect(&rotation(t, alpha, beta), &r) <= FEW, "{t:?}");
            }
            assert!(found.turns[0][1][1] >= 0.0 && found.turns[0][1][0] == found.turns[1][1][0] && found.turns[0][1][1] == -found.turns[1][1][1]);
        }
    }

    /// t2 = 10^-k and pi - 10^-k: t2 keeps its digits, and R is met although t1 and t3 lose theirs.
    #[test]
    fn three_turns_near_parallel_axes() {
        let random = &mut Random(6);
        // alpha = beta: parallel at t2 = pi; alpha = -beta: at t2 = 0; both for right angles.
        let pairs = [([0.0, 1.0], [0.0, -1.0]), ([0.0, 1.0], [0.0, 1.0]), (point(0.7), point(0.7)), (point(0.7), point(-0.7))];
        for (alpha, beta) in pairs {
            for k in 0..=16 {
                for half_turn in [false, true] {
                    let angle = 10f64.powi(-k);
                    let t2 = point(if half_turn { std::f64::consts::PI - angle } else { angle });
                    let t2 = [t2[0], angle.sin() as Real];
                    let t = [point(random.angle()), t2, point(random.angle())];
                    let r = rotation(&t, alpha, beta);
                    let noise = 4.0 * FEW;
                    let found = three_turns(&r, alpha, beta, noise, 0.0);
                    assert!(found.count > 0);
                    assert_eq!(found.count == 2, !(found.double || found.free));
                    let parallel = dot(cross(column(&r, 2), [0.0, 0.0, 1.0]), cross(column(&r, 2), [0.0, 0.0, 1.0])).sqrt() <= noise;
                    if found.count == 2 {
                        // Near contact that is not parallel, half of t2's digits go with the cosine; else none.
                        let loss = if r[0][2].hypot(r[1][2]) > 2.0 * t2[1].abs() { 1.0 / t2[1] } else { 8.0 };
                        assert!((found.turns[0][1][1] - t2[1]).abs() <= FEW * loss.max(8.0), "10^-{k}: {:?} {t2:?}", found.turns[0][1]);
                    }
                    if tenth(k) * tenth(k) > 8.0 * noise {
                        assert!(found.count == 2, "10^-{k}");
                    }
                    assert_eq!(found.free, parallel, "10^-{k} {half_turn}");
                    for turns in &found.turns[..found.count] {
                        assert!(defect(&rotation(turns, alpha, beta), &r) <= 2.0 * noise, "10^-{k} {half_turn} {alpha:?} {beta:?}: {found:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn three_turns_that_cannot_reach() {
        let (alpha, beta) = (point(0.5), point(0.25));
        // The axes stand at 0.25 to 0.75 rad to each other.
        let r = |angle: f64| about_z(point(1.0), &about_x(point(angle)));
        assert_eq!(three_turns(&r(0.5), alpha, beta, FEW, 0.0).count, 2);
        for (angle, limit) in [(0.125f64, 0.25f64), (1.0, 0.75)] {
            let found = three_turns(&r(angle), alpha, beta, FEW, 0.0);
            assert_eq!(found.count, 0);
            assert!((found.miss - (angle.cos() - limit.cos()).abs() as Real).abs() <= FEW);
        }
        for edge in [0.25f64, 0.75] {
            let found = three_turns(&r(edge), alpha, beta, FEW, 0.0);
            assert_eq!((found.count, found.double, found.free), (1, true, false));
            assert!(defect(&rotation(&found.turns[0], alpha, beta), &r(edge)) <= FEW);
        }
        assert_eq!(three_turns(&[[Real::NAN; 4]; 3], alpha, beta, FEW, 0.0).count, 0);
    }
}
