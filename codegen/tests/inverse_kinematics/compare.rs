// What compares inverse kinematics in C with that in Rust, compiled with the modules that come after it.

/// Joint variables: random ones, at right angles, zeros, next to folds.
fn variable(kind: usize, random: &mut Random) -> f64 {
    match kind % 8 {
        0..=3 => random.between(-3.14, 3.14),
        4 => random.below(5) as f64 * core::f64::consts::FRAC_PI_2 - core::f64::consts::PI,
        5 => random.below(2) as f64 * random.between(-3.0, 3.0),
        6 => random.between(-1e-7, 1e-7) + random.below(3) as f64,
        _ => random.between(-1.0, 1.0),
    }
}

macro_rules! compare {
    ($module:ident, $ik:ident, $all:ident, $within:ident, $nearest:ident, $poses:expr, $solve:expr) => {{
        use $ik::{Real, Solutions, DOF, MAX_SOLUTIONS};

        #[repr(C)]
        #[derive(Clone, Copy)]
        struct Posture {
            q: [Real; DOF],
            branch: u32,
            is_double: u32,
            free: u32,
        }

        #[repr(C)]
        #[derive(Clone, Copy)]
        struct Found {
            verdict: u32,
            count: u32,
            miss: Real,
            all: [Posture; MAX_SOLUTIONS],
        }

        extern "C" {
            fn $all(t: *const [[Real; 4]; 4], r: Real, found: *mut Found);
            fn $within(from: *const Found, within: *mut Found);
            fn $nearest(from: *const Found, q: *const Real) -> i32;
        }

        let same = |rust: &Solutions, c: &Found| {
            rust.verdict as u32 == c.verdict
                && rust.count as u32 == c.count
                && rust.miss.to_bits() == c.miss.to_bits()
                && rust.all.iter().zip(&c.all).all(|(x, y)| {
                    u32::from(x.branch) == y.branch
                        && u32::from(x.double) == y.is_double
                        && x.free == y.free
                        && x.q.iter().zip(&y.q).all(|(x, y)| x.to_bits() == y.to_bits())
                })
        };
        let nothing = Posture { q: [0.0; DOF], branch: 0, is_double: 0, free: 0 };
        let nothing = Found { verdict: 0, count: 0, miss: 0.0, all: [nothing; MAX_SOLUTIONS] };
        let random = &mut Random(7);
        let mut verdicts = [0; 5];
        let poses = if $ik::BRANCHES.is_empty() { $poses / 10 } else { $poses };
        for pose in 0..poses {
            let q: [Real; DOF] = core::array::from_fn(|_| variable(pose, random) as Real);
            let mut t = $module::direct_kinematics(&q);
            match pose % 16 {
                7 => t[0][3] += 3.0,
                11 => t[2][3] += 1e-9,
                15 => {
                    let (at, which) = (random.below(12) as usize, random.below(5) as usize);
                    t[at / 4][at % 4] = [Real::NAN, Real::INFINITY, -0.0, 1e30, 0.5][which];
                }
                _ => {}
            }
            // What is given beside the pose: any angle, however large.
            let r = match pose % 5 {
                0 => random.between(-3.1, 3.1),
                1 => random.between(-1e3, 1e3),
                2 => random.between(-1e9, 1e9),
                3 => random.between(-1.0, 1.0) * 10f64.powi(random.below(300) as i32),
                _ => f64::from(q[DOF - 1]),
            } as Real;
            let rust = ($solve)(&t, r);
            let (mut c, mut within) = (nothing, nothing);
            // SAFETY: all pointers lead to what C declares.
            let nearest = unsafe {
                $all(&t, r, &mut c);
                $within(&c, &mut within);
                $nearest(&c, q.as_ptr())
            };
            let place = rust.nearest_to(&q).map_or(-1, |near| rust.all.iter().position(|one| core::ptr::eq(one, near)).map_or(-1, |at| at as i32));
            assert!(same(&rust, &c), "{}: pose {pose}: {rust:?} at {t:?}, {r}", stringify!($module));
            assert!(same(&rust.within_limits(), &within) && place == nearest, "{}: pose {pose}", stringify!($module));
            verdicts[rust.verdict as usize] += 1;
        }
        println!("{}: the same bits at {poses} poses; verdicts {verdicts:?}", stringify!($module));
    }};
}

