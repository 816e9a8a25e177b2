// What judges emitted inverse kinematics, compiled with the modules that come after it.

/// The largest difference between the joint variables of two postures, angles modulo whole turns.
fn distance<R: Copy + Into<f64>>(x: &[R], y: &[R], revolute: &[bool]) -> f64 {
    let turn = std::f64::consts::TAU;
    let apart = |((x, y), turns): ((&R, &R), &bool)| {
        let d = ((*x).into() - (*y).into()).abs();
        if *turns { (d % turn).min(turn - d % turn) } else { d }
    };
    x.iter().zip(y).zip(revolute).map(apart).fold(0.0, f64::max)
}

/// The determinant of the Jacobian of six joints, or of that of the position of three, from differences of the pose: it is linear in each sine,
/// cosine and slide, so that those over a right angle to either side, or a metre, are no approximation.
fn determinant(q: &[f64], revolute: &[bool], t: &dyn Fn(&[f64]) -> [[f64; 4]; 4]) -> f64 {
    let here = t(q);
    let column = |i: usize| {
        let at = |step: f64| {
            let mut q = q.to_vec();
            q[i] += step;
            t(&q)
        };
        let step = if revolute[i] { 0.5 * std::f64::consts::PI } else { 1.0 };
        let (x, y) = (at(step), at(-step));
        let d = |i: usize, j: usize| 0.5 * (x[i][j] - y[i][j]);
        // dR R'
        let turn = |i: usize, j: usize| (0..3).map(|k| d(i, k) * here[j][k]).sum::<f64>();
        [d(0, 3), d(1, 3), d(2, 3), turn(2, 1), turn(0, 2), turn(1, 0)]
    };
    let joints = q.len();
    let mut rows: Vec<[f64; 6]> = (0..joints).map(column).collect();
    let mut product = 1.0;
    for k in 0..joints {
        let pivot = (k..joints).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap_or(k);
        if pivot != k {
            rows.swap(k, pivot);
            product = -product;
        }
        product *= rows[k][k];
        if product == 0.0 {
            return 0.0;
        }
        for i in k + 1..joints {
            let factor = rows[i][k] / rows[k][k];
            for j in k..joints {
                rows[i][j] -= factor * rows[k][j];
            }
        }
    }
    product
}

/// A posture at which that is 0, between two random ones at which its signs differ, and the direction in which it changes fastest.
fn fold(random: &mut Random, revolute: &[bool], t: &dyn Fn(&[f64]) -> [[f64; 4]; 4]) -> (Vec<f64>, Vec<f64>) {
    let mut posture = || -> Vec<f64> {
        revolute.iter().map(|turns| if *turns { random.between(-3.14, 3.14) } else { random.between(-0.5, 0.5) }).collect()
    };
    loop {
        let (mut a, mut b) = (posture(), posture());
        let sign = determinant(&a, revolute, t) > 0.0;
        if (determinant(&b, revolute, t) > 0.0) == sign {
            continue;
        }
        for _ in 0..60 {
            let middle: Vec<f64> = a.iter().zip(&b).map(|(x, y)| 0.5 * (x + y)).collect();
            if (determinant(&middle, revolute, t) > 0.0) == sign {
                a = middle;
            } else {
                b = middle;
            }
        }
        let at = |i: usize, step: f64| {
            let mut q = a.clone();
            q[i] += step;
            determinant(&q, revolute, t)
        };
        let gradient: Vec<f64> = (0..a.len()).map(|i| at(i, 1e-4) - at(i, -1e-4)).collect();
        let size = gradient.iter().map(|x| x * x).sum::<f64>().sqrt();
        return (a, gradient.into_iter().map(|x| x / size).collect());
    }
}

/// Thousands of random postures: each among those found at its pose, each found one right, counts even, branches named.
macro_rules! check {
    ($module:ident, $ik:ident, $columns:expr, $solve:expr, $redundancy:expr) => {{
        use $ik::{Real, Verdict, DOF};
        let single = Real::EPSILON > 1e-10;
        let general = $ik::BRANCHES.is_empty();
        let (mut complete, mut lost, mut odd, mut most, mut worst) = (0, 0, 0, 0, 0.0f64);
        let random = &mut Random(7);
        let poses = if general { 300 } else { 3000 };
        for _ in 0..poses {
            let q: [Real; DOF] = std::array::from_fn(|i| {
                let turns = $module::JOINT_IS_REVOLUTE[i];
                (if turns { random.between(-3.14, 3.14) } else { random.between(-0.5, 0.5) }) as Real
            });
            let t = $module::direct_kinematics(&q);
            let found = $solve(&t, $redundancy(&q));
            assert!(found.verdict != Verdict::Invalid && found.verdict != Verdict::Unreachable, "{:?}", found);
            assert!(found.count <= $ik::MAX_SOLUTIONS);
            for solution in found.as_slice() {
                assert!(general || !$ik::BRANCHES[usize::from(solution.branch)].is_empty(), "{:?}", solution);
                if solution.double || solution.free != 0 {
                    continue;
                }
                let reached = $module::direct_kinematics(&solution.q);
                for (x, y) in reached.iter().flat_map(|row| &row[$columns]).zip(t.iter().flat_map(|row| &row[$columns])) {
                    worst = worst.max((f64::from(*x) - f64::from(*y)).abs());
                }
            }
            if found.verdict != Verdict::Complete {
                continue;
            }
            complete += 1;
            most = most.max(found.count);
            odd += found.count % 2;
            let nearest = found.nearest_to(&q).expect("a complete set has a posture");
            lost += usize::from(distance(&nearest.q, &q, &$module::JOINT_IS_REVOLUTE) > if single { 0.1 } else { 1e-5 });
        }
        println!("{}: {complete} of {poses} complete, lost {lost}, odd {odd}, most {most}, T right to {worst:.1e}", stringify!($module));
        // In single precision a posture that is hardly regular may be off by a tenth.
        assert!(lost * 500 <= if single { complete } else { 0 }, "{}: lost", stringify!($module));
        assert!(odd * 500 <= if single { complete } else { 0 }, "{}: odd", stringify!($module));
        assert!(worst < if single { 2e-3 } else { 1e-11 }, "{}: {worst:e}", stringify!($module));
        assert!(complete * 100 >= poses * if single { 60 } else { 97 }, "{}: {complete}", stringify!($module));
        // Where the Jacobian is singular rounding decides about solutions, or some joints can move; 1e-4 beside it nothing does.
        let t = |q: &[f64]| {
            let q: [Real; DOF] = std::array::from_fn(|i| q[i] as Real);
            $module::direct_kinematics(&q).map(|row| row.map(f64::from))
        };
        // Not of an arm that stays in a plane.
        let square = matches!((DOF, $columns.start, single), (6, 0, false) | (3, 3, false));
        if square && determinant(&[0.4; DOF], &$module::JOINT_IS_REVOLUTE, &t) != 0.0 {
            let (mut told, mut beside) = (0, 0);
            for number in 0..200 {
                let (q, gradient) = fold(random, &$module::JOINT_IS_REVOLUTE, &t);
                let verdict = |q: &[f64]| {
                    let q: [Real; DOF] = std::array::from_fn(|i| q[i] as Real);
                    $solve(&$module::direct_kinematics(&q), $redundancy(&q)).verdict
                };
                told += usize::from(matches!(verdict(&q), Verdict::NearDouble | Verdict::Continuum));
                let step = if number % 2 == 0 { 1e-4 } else { -1e-4 };
                let next: Vec<f64> = q.iter().zip(&gradient).map(|(q, g)| q + step * g).collect();
                beside += usize::from(verdict(&next) == Verdict::Complete);
            }
            println!("{}: {told} of 200 folds told, {beside} complete beside", stringify!($module));
            // Of constructions with roots of equations some say otherwise: a third solution is near.
            assert!(told >= 196 && beside >= 196, "{}: folds", stringify!($module));
        }
        let mut t = $module::direct_kinematics(&[0.3; DOF]);
        t[0][3] = Real::NAN;
        assert_eq!($solve(&t, 0.3).verdict, Verdict::Invalid);
        let mut t = $module::direct_kinematics(&[0.3; DOF]);
        (t[0][3], t[1][3]) = (1e3, 1e3);
        let far = $solve(&t, 0.3);
        // A general arm may say that it is not certain; slides have no end.
        if $module::JOINT_IS_REVOLUTE.iter().all(|turns| *turns) && !general {
            assert!(far.verdict == Verdict::Unreachable && far.count == 0, "{:?}", far);
        }
    }};
}

/// The reference poses of a file: every listed posture found, none beside those, the verdict as listed.
macro_rules! reference {
    ($module:ident, $ik:ident, $file:expr, $solve:expr) => {{
        use $ik::{Real, Verdict, DOF};
        let text = std::fs::read_to_string($file).expect("a file of reference poses");
        let numbers = |text: &str| -> Vec<f64> { text.split(' ').map(|word| word.parse().expect("a number")).collect() };
        // (verdicts, kind, pose, postures with sigma, whether two have met)
        let mut poses: Vec<(String, Vec<f64>, Vec<(Vec<f64>, f64)>, bool)> = vec![];
        let mut redundancies: Vec<Real> = vec![];
        for line in text.lines() {
            let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
            match key {
                "pose" => poses.push((rest.to_owned(), vec![], vec![], false)),
                "t" => poses.last_mut().expect("a pose").1 = numbers(rest),
                "redundancy" => redundancies.push(rest.parse().expect("a number")),
                "met" => poses.last_mut().expect("a pose").3 = true,
                "q" => {
                    let (q, sigma) = rest.split_once(" sigma ").expect("a posture with its sigma");
                    poses.last_mut().expect("a pose").2.push((numbers(q), sigma.parse().expect("a number")));
                }
                _ => {}
            }
        }
        assert!(poses.len() > 20);
        for (number, (head, t, postures, met)) in poses.iter().enumerate() {
            let mut pose = [[0.0 as Real; 4]; 4];
            for (i, entry) in t.iter().enumerate() {
                pose[i / 4][i % 4] = *entry;
            }
            let found = $solve(&pose, redundancies.get(number).copied().unwrap_or(0.0));
            let mut words = head.split(' ');
            let kind = words.next().expect("a kind");
            let said = format!("{:?}", found.verdict);
            assert!(words.any(|verdict| verdict == said), "{} {head}: {found:?}", stringify!($module));
            let distance = |x: &[Real; DOF], y: &[f64]| distance(x, y, &$module::JOINT_IS_REVOLUTE);
            for (q, sigma) in postures {
                let least = found.as_slice().iter().map(|s| distance(&s.q, q)).fold(f64::INFINITY, f64::min);
                assert!(least < 1e-9f64.max(1e-11 / sigma), "{} {head}: {q:?} is missing by {least:e}", stringify!($module));
            }
            for solution in found.as_slice() {
                let listed = postures.iter().any(|(q, _)| distance(&solution.q, q) < 1e-6);
                let unlisted = solution.double && *met || solution.free != 0 || kind == "continuum";
                assert!(listed || unlisted, "{} {head}: {solution:?} is one too many", stringify!($module));
            }
            assert_eq!(found.verdict == Verdict::Unreachable, found.miss > 0.0);
        }
        println!("{}: {} reference poses", stringify!($module), poses.len());
    }};
}

/// Fewer joints than the pose has rows: the posture itself at the poses of random postures and of those with joints at right angles, every posture
/// that is found meets all rows, and none is found beside such a pose.
macro_rules! few {
    ($module:ident, $ik:ident) => {{
        use $ik::{Real, Verdict, DOF};
        let single = Real::EPSILON > 1e-10;
        let random = &mut Random(11);
        let poses = if $ik::BRANCHES.is_empty() { 400 } else { 4000 };
        let (mut complete, mut special, mut lost, mut none, mut beside, mut most, mut worst) = (0, 0, 0, 0, 0, 0, 0.0f64);
        for number in 0..poses {
            let right = number % 4 == 3;
            let q: [Real; DOF] = std::array::from_fn(|i| {
                let turns = $module::JOINT_IS_REVOLUTE[i];
                if right && random.between(0.0, 1.0) < 0.5 {
                    let quarters = random.between(-1.5, 2.5).round();
                    return if turns { (0.5 * quarters * std::f64::consts::PI) as Real } else { 0.0 };
                }
                (if turns { random.between(-3.14, 3.14) } else { random.between(-0.5, 0.5) }) as Real
            });
            let t = $module::direct_kinematics(&q);
            let found = $ik::inverse_kinematics(&t);
            if found.verdict == Verdict::Invalid || found.verdict == Verdict::Unreachable {
                none += 1;
                println!("{}: none at {q:?}, {:?} {:e}", stringify!($module), found.verdict, found.miss);
            }
            for solution in found.as_slice() {
                let reached = $module::direct_kinematics(&solution.q);
                for (x, y) in reached.iter().flatten().zip(t.iter().flatten()) {
                    worst = worst.max((f64::from(*x) - f64::from(*y)).abs());
                }
            }
            if found.verdict == Verdict::Complete {
                complete += usize::from(!right);
                special += usize::from(right);
                most = most.max(found.count);
                let nearest = found.nearest_to(&q).expect("a complete set has a posture");
                lost += usize::from(distance(&nearest.q, &q, &$module::JOINT_IS_REVOLUTE) > if single { 0.02 } else { 1e-6 });
            }
            // Moved and turned by a little: Cayley's rotation, v + (w × v + w × (w × v)/2)/(1 + w²/4).
            let mut off = t;
            let by = if single { 1e-2 } else { 1e-4 };
            let w = [0; 3].map(|_| random.between(-1.0, 1.0));
            let size = w.iter().map(|x| x * x).sum::<f64>().sqrt();
            let w = w.map(|x| x * by / size);
            let cross = |v: [f64; 3]| [w[1] * v[2] - w[2] * v[1], w[2] * v[0] - w[0] * v[2], w[0] * v[1] - w[1] * v[0]];
            for j in 0..3 {
                let v = [0, 1, 2].map(|i| f64::from(t[i][j]));
                let (once, twice) = (cross(v), cross(cross(v)));
                for i in 0..3 {
                    off[i][j] = (v[i] + (once[i] + 0.5 * twice[i]) / (1.0 + 0.25 * by * by)) as Real;
                }
                off[j][3] = (f64::from(t[j][3]) + random.between(-by, by)) as Real;
            }
            let found = $ik::inverse_kinematics(&off);
            // Of five joints one pose in some hundreds is within the rounding of single precision by chance.
            assert!(found.count == 0 || single, "{}: {found:?} beside {q:?}", stringify!($module));
            beside += usize::from(found.verdict == Verdict::Unreachable && found.miss > 0.0);
        }
        println!(
            "{}: {complete} of {} complete, {special} of {} with right angles, lost {lost}, none {none}, {beside} unreachable beside, most {most}, T right to {worst:.1e}",
            stringify!($module),
            poses - poses / 4,
            poses / 4
        );
        assert!(lost == 0 && none == 0, "{}: lost {lost}, none {none}", stringify!($module));
        assert!(worst < if single { 1e-4 } else { 1e-11 }, "{}: {worst:e}", stringify!($module));
        assert!(complete * 100 >= (poses - poses / 4) * if single { 95 } else { 99 }, "{}: {complete}", stringify!($module));
        assert!(beside * 100 >= poses * if single { 95 } else { 99 }, "{}: {beside} beside", stringify!($module));
        // Among right angles are postures at which the arm is singular.
        assert!(special * 10 >= poses / 4 * 7, "{}: {special} with right angles", stringify!($module));
        let mut t = $module::direct_kinematics(&[0.3; DOF]);
        t[0][3] = Real::NAN;
        assert_eq!($ik::inverse_kinematics(&t).verdict, Verdict::Invalid);
        let mut t = $module::direct_kinematics(&[0.3; DOF]);
        (t[0][3], t[1][3], t[2][3]) = (1e3, 1e3, -1e3);
        let far = $ik::inverse_kinematics(&t);
        // Slides have no end.
        if $module::JOINT_IS_REVOLUTE.iter().all(|turns| *turns) {
            assert!(far.verdict == Verdict::Unreachable && far.count == 0 && far.miss > 100.0, "{}: {far:?}", stringify!($module));
        }
    }};
}
