//! Block R against products of known roots: all of them found, no other, clusters, double roots, nothing at all.

// The same text is compiled for both scalars.
#![allow(clippy::unnecessary_cast)]

in_both_scalars! {
    use std::f64::consts::{PI, TAU};

    /// A product of sin((t - r)/2) over known roots r and of 1 + e - cos(t - p), which has none: a trigonometric polynomial.
    #[derive(Debug, Clone)]
    struct Product {
        roots: Vec<f64>,
        positive: Vec<(f64, f64)>,
    }

    impl Product {
        fn at(&self, t: f64) -> f64 {
            let roots: f64 = self.roots.iter().map(|r| ((t - r) / 2.0).sin()).product();
            let positive: f64 = self.positive.iter().map(|(p, e)| e + 2.0 * ((t - p) / 2.0).sin().powi(2)).product();
            roots * positive
        }

        /// Coefficients by sampling, and a bound of their rounding.
        fn coefficients<const N: usize>(&self) -> ([Real; N], [Real; N], Real) {
            let samples = 3 * N;
            let angle = |j: usize| TAU * j as f64 / samples as f64;
            let largest = (0..samples).fold(0.0f64, |m, j| m.max(self.at(angle(j)).abs()));
            let mut a = [0.0; N];
            let mut b = [0.0; N];
            for k in 0..N {
                let weight = if k == 0 { 1.0 } else { 2.0 } / (samples as f64 * largest);
                a[k] = (0..samples).map(|j| self.at(angle(j)) * angle(j * k).cos()).sum::<f64>().mul_add(weight, 0.0) as Real;
                b[k] = (0..samples).map(|j| self.at(angle(j)) * angle(j * k).sin()).sum::<f64>().mul_add(weight, 0.0) as Real;
            }
            (a, b, largest as Real)
        }

        fn find<const N: usize>(&self) -> CircleRoots<20> {
            let (a, b, largest) = self.coefficients::<N>();
            circle_roots(&a, &b, 8.0 * UNIT_ROUNDOFF, 0.0, |points| {
                // In double precision for both scalars: right relative to its own size.
                points.map(|[c, s]| (self.at((s as f64).atan2(c as f64)) / largest as f64) as Real)
            })
        }
    }

    fn distance(x: f64, y: f64) -> f64 {
        let d = (x - y).rem_euclid(TAU);
        d.min(TAU - d)
    }

    fn angle(root: &CircleRoot) -> f64 {
        (root.s as f64).atan2(root.c as f64)
    }

    /// Every known root is found as near as `tolerance`, and nothing else; in order.
    #[track_caller]
    fn check(product: &Product, found: &CircleRoots<20>, tolerance: f64) {
        let roots = &found.all[..found.count];
        for known in &product.roots {
            assert!(roots.iter().any(|r| distance(angle(r), *known) < tolerance), "{known} of {product:?} is not in {found:?}");
        }
        for root in roots {
            assert!((root.c * root.c + root.s * root.s - 1.0).abs() < 64.0 * UNIT_ROUNDOFF);
            assert!(product.roots.iter().any(|k| distance(angle(root), *k) < tolerance), "{root:?} is no root of {product:?}");
        }
        assert_eq!(roots.len(), product.roots.len(), "{product:?}: {found:?}");
        let turns: Vec<f64> = roots.iter().map(|r| angle(r).rem_euclid(TAU)).collect();
        let falls = turns.windows(2).filter(|w| w[0] > w[1]).count();
        assert!(falls <= 1, "{turns:?} are not in order");
    }

    fn of_degree<const N: usize>(seed: u64) {
        let random = &mut Random(seed);
        // Many roots in single precision leave places where the polynomial is all noise.
        let mut doubtful = 0;
        for i in 0..1500 {
            let degree = N - 1;
            let pairs = i % (degree + 1);
            let mut roots: Vec<f64> = vec![];
            while roots.len() < 2 * pairs {
                let root = random.angle();
                if roots.iter().all(|r| distance(*r, root) > 0.1) {
                    roots.push(root);
                }
            }
            let positive = (pairs..degree).map(|_| (random.angle(), random.between(0.01, 1.0))).collect();
            let product = Product { roots, positive };
            let found = product.find::<N>();
            assert!(!found.free);
            if found.near && Real::EPSILON > 1e-10 {
                doubtful += 1;
                continue;
            }
            assert!(!found.near, "{product:?}: {found:?}");
            check(&product, &found, 1e7 * UNIT_ROUNDOFF as f64 + 1e-10);
        }
        assert!(doubtful < 150, "{doubtful}");
    }

    #[test]
    fn every_root_of_degree_2() {
        of_degree::<3>(1);
    }

    #[test]
    fn every_root_of_degree_4() {
        of_degree::<5>(2);
    }

    #[test]
    fn every_root_of_degree_8() {
        of_degree::<9>(3);
    }

    /// Two roots 10^-k apart, with 8 others: both where they are more than 64 sqrt(u) apart, one marked double below a twentieth of that.
    #[test]
    fn pairs_of_roots_close_together() {
        let random = &mut Random(4);
        let resolution = 64.0 * (UNIT_ROUNDOFF as f64).sqrt();
        for k in 0..=16 {
            for _ in 0..20 {
                let apart = 10f64.powi(-k);
                let at = random.angle();
                let mut roots = vec![at, at + apart];
                while roots.len() < 10 {
                    let root = random.angle();
                    if roots.iter().all(|r| distance(*r, root) > 0.2) {
                        roots.push(root);
                    }
                }
                let positive = (0..3).map(|_| (random.angle(), 0.5)).collect();
                let product = Product { roots, positive };
                let found = product.find::<9>();
                if apart > resolution {
                    assert!(!found.near, "10^-{k} {product:?}: {found:?}");
                    check(&product, &found, 1e-2 * apart.min(0.1));
                } else if apart < 0.05 * resolution {
                    assert!(found.near, "10^-{k} {product:?}: {found:?}");
                    let once = Product { roots: product.roots[1..].to_vec(), positive: vec![] };
                    check(&once, &found, 8.0 * resolution);
                    assert_eq!(found.all[..found.count].iter().filter(|r| r.double).count(), 1);
                } else {
                    let (count, near) = (found.count, found.near);
                    assert!(count == product.roots.len() || near, "10^-{k} {product:?}: {found:?}");
                }
            }
        }
    }

    /// What halving leaves beside two roots that it has told apart is no minimum of its own.
    #[test]
    fn nothing_is_shallow_beside_a_pair() {
        let random = &mut Random(33);
        let mut told_apart = 0;
        for _ in 0..300 {
            let start = random.angle();
            let apart = SHALLOW as f64 * random.between(0.5, 4.0);
            let product = Product { roots: vec![start, start + apart], positive: (0..7).map(|_| (random.angle(), 0.1)).collect() };
            let found = product.find::<9>();
            if found.all[..found.count].iter().all(|root| !root.double) {
                assert_eq!((found.count, found.shallow_count), (2, 0), "{product:?}: {found:?}");
                told_apart += 1;
            }
        }
        assert!(told_apart > 200, "{told_apart} pairs were told apart");
    }

    /// n^8 f(q(t)) has degree 8 in t, and crowded roots lie about the whole circle of t.
    #[test]
    fn crowded_roots_are_taken_apart() {
        let random = &mut Random(34);
        let points: [[Real; 2]; 24] = std::array::from_fn(|j| {
            let (s, c) = (j as f64 * TAU / 24.0).sin_cos();
            [c as Real, s as Real]
        });
        for _ in 0..100 {
            let centre = random.angle();
            let product = Product { roots: (0..16).map(|_| centre + random.between(-0.8, 0.8)).collect(), positive: vec![] };
            let at = |spread: &Spread| {
                points.map(|point| {
                    let ([c, s], factor) = spread.at(point);
                    product.at((s as f64).atan2(c as f64)) * factor as f64
                })
            };
            let before = at(&Spread::none());
            let spread = Spread::of_roots(&before.map(|x| (x / 1e-3) as Real));
            let [c, s] = spread.centre;
            assert!(distance((s as f64).atan2(c as f64), centre) < 0.6, "{spread:?} about {centre}");
            let after = at(&spread);
            let weak = |values: &[f64; 24]| {
                let largest = values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                values.iter().filter(|x| x.abs() < 1e-8 * largest).count()
            };
            assert!(weak(&before) >= 5 && weak(&after) <= 2, "{} of 24, {} of 24", weak(&before), weak(&after));
            let largest = after.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            for k in 9..=12 {
                let (x, y) = after.iter().enumerate().fold((0.0, 0.0), |(x, y), (j, value)| {
                    let angle = (j * k) as f64 * TAU / 24.0;
                    (x + value * angle.cos(), y + value * angle.sin())
                });
                assert!(x.hypot(y) < 1000.0 * UNIT_ROUNDOFF as f64 * largest, "order {k}: {:e}", x.hypot(y) / largest);
            }
        }
    }

    /// A minimum 10^-k above 0: not a root, unless rounding cannot tell; never one that is not said to be near.
    #[test]
    fn near_contacts() {
        let random = &mut Random(5);
        for k in 0..=16 {
            let e = 10f64.powi(-k);
            for _ in 0..20 {
                let at = random.angle();
                let product = Product { roots: vec![at + 1.0, at + 2.0], positive: vec![(at, e), (at - 1.0, 0.7)] };
                let found = product.find::<4>();
                if e > 1e3 * UNIT_ROUNDOFF as f64 {
                    assert!(!found.near, "10^-{k}: {found:?}");
                    check(&product, &found, 1e-3);
                } else if e < UNIT_ROUNDOFF as f64 {
                    assert!(found.near && found.count == 3, "10^-{k}: {found:?}");
                } else {
                    assert!(found.near || found.count == 2, "10^-{k}: {found:?}");
                }
            }
        }
    }

    /// Clusters of 4 roots within 10^-k: all four, or `near`; never two silently.
    #[test]
    fn clusters() {
        let random = &mut Random(6);
        let mut all = 0;
        for k in 0..=8 {
            for _ in 0..40 {
                let width = 10f64.powi(-k);
                let at = random.angle();
                let offsets = [0.0, 0.25, 0.6, 1.0].map(|x| at + x * width + 0.05 * width * random.between(-1.0, 1.0));
                let mut roots = offsets.to_vec();
                roots.extend([at + 2.0, at + 3.0]);
                let product = Product { roots, positive: (0..5).map(|i| (i as f64, 0.3)).collect() };
                let found = product.find::<9>();
                if !found.near {
                    check(&product, &found, 0.05 * width);
                    all += 1;
                }
            }
        }
        assert!(all > if Real::EPSILON < 1e-10 { 160 } else { 60 }, "{all} clusters were taken apart");
    }

    #[test]
    fn nothing_at_all() {
        let mut asked = 0;
        for scale in [0.0, 1e-3 * UNIT_ROUNDOFF] {
            let found = circle_roots::<9, 20>(&[scale; 9], &[scale; 9], UNIT_ROUNDOFF, 0.0, |_| { asked += 9; [0.0; 9] });
            assert_eq!((found.count, found.free, found.near), (0, true, false));
        }
        assert_eq!(asked, 0);
        // A constant that is no noise.
        let mut a = [0.0; 9];
        a[0] = 1.0;
        let found = circle_roots::<9, 20>(&a, &[0.0; 9], UNIT_ROUNDOFF, 0.0, |_| [1.0; 9]);
        assert_eq!((found.count, found.free, found.near), (0, false, false));
        a[3] = Real::NAN;
        let found = circle_roots::<9, 20>(&a, &[0.0; 9], UNIT_ROUNDOFF, 0.0, |_| [Real::NAN; 9]);
        assert!(found.count == 0 && found.near);
    }

    /// Roots at the ends of the arcs, where neighbours must neither both leave them out nor both take them.
    #[test]
    fn roots_between_two_arcs() {
        for i in 0..32 {
            for nudge in -20..=20 {
                let at = i as f64 * PI / 16.0 + nudge as f64 * 0.2 * UNIT_ROUNDOFF as f64;
                let product = Product { roots: vec![at, at + 2.0], positive: (0..7).map(|i| (0.4 + i as f64, 0.5)).collect() };
                let found = product.find::<9>();
                assert!(!found.near);
                check(&product, &found, 1e6 * UNIT_ROUNDOFF as f64);
            }
        }
    }

    /// A function that contradicts its coefficients, and noise in place of coefficients: the work ends, and it says `near`.
    #[test]
    fn work_is_bounded() {
        let random = &mut Random(7);
        let mut vanishing = 0;
        for _ in 0..50 {
            let a: [Real; 9] = std::array::from_fn(|_| random.between(-1.0, 1.0) as Real);
            let b: [Real; 9] = std::array::from_fn(|_| random.between(-1.0, 1.0) as Real);
            let mut asked = 0;
            let found = circle_roots::<9, 20>(&a, &b, 0.5, 0.0, |_| { asked += 9; std::array::from_fn(|_| random.between(-1.0, 1.0) as Real) });
            assert!(asked == 9 * found.anew && found.anew <= 240, "{asked}");
            assert!(found.near);
            // Of no size, wherever it is asked for: that adds no root to those of the coefficients, and takes none away unsaid.
            let noise = 3e-2;
            let found = circle_roots::<9, 20>(&a, &b, noise, 0.0, |_| [0.0; 9]);
            assert!(found.anew <= 240 && (found.near || found.count.is_multiple_of(2)), "{found:?}");
            for root in found.all[..found.count].iter().filter(|root| !root.double) {
                let at = angle(root);
                let value: f64 = (0..9).map(|k| a[k] as f64 * (k as f64 * at).cos() + if k == 0 { 0.0 } else { b[k] as f64 * (k as f64 * at).sin() }).sum();
                assert!(value.abs() < 4.0 * noise as f64, "{value:e}: {root:?}");
            }
            vanishing += usize::from(found.anew > 0);
        }
        assert!(vanishing > 10, "{vanishing} of 50 were asked for");
    }
}
