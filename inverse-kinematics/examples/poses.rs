//! What is found at random poses of the arms of `tests/data`: `cargo run --release --example poses -p armgen-inverse-kinematics`.
//!
//! The first argument is how many poses (1 000 000), the second an arm's name. Each arm: originals that are lost, odd counts and spurious
//! postures (residual above 1e-9) among the complete, poses said to be near a double solution, poses at which the general arm takes its
//! second arrangement (of every tenth), the largest residual of a posture (entries of T, lengths over that of the longest link), median and
//! 99th percentile of the time of a call (the smaller of two). Then postures at which the Jacobian is singular, found by bisection: how
//! many of their poses are said to be near or a continuum; and how many are complete where the posture is 1e-4 away along the gradient of
//! the Jacobian's determinant.

#[path = "../tests/common/mod.rs"]
#[macro_use]
mod common;

use std::time::Instant;

use armgen_inverse_kinematics::f64::*;
use common::Random;

#[allow(unreachable_pub, dead_code)]
mod arm {
    use super::*;
    include!("../tests/common/arm.rs");
    include!("../tests/common/solver.rs");
    include!("../tests/common/files.rs");
}
use arm::*;

#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    Complete,
    Unreachable,
    Near,
    Continuum,
}

/// As an emitted module concludes.
fn verdict(found: &Branches<6, 16>, joints: usize) -> Verdict {
    let free = |branch: &Branch<6>| branch.free & ((1 << joints) - 1) != 0;
    if found.continuum || found.found().iter().any(free) {
        Verdict::Continuum
    } else if found.near || found.found().iter().any(|branch| branch.double) {
        Verdict::Near
    } else if found.count > 0 {
        Verdict::Complete
    } else {
        Verdict::Unreachable
    }
}

/// The determinant of the geometric Jacobian of six joints.
fn determinant(arm: &Arm, q: &[f64]) -> f64 {
    let mut axes = vec![];
    let mut t = arm.c[0];
    for (i, q) in q.iter().enumerate() {
        axes.push((column(&t, 2), column(&t, 3), arm.prismatic[i]));
        t = compose(&t, &joint_then(arm.prismatic[i], arm.value(i, *q), &arm.c[i + 1]));
    }
    let p = column(&t, 3);
    let mut rows: Vec<[f64; 6]> = axes
        .iter()
        .map(|(z, o, slides)| {
            let v = if *slides { *z } else { cross(*z, minus(p, *o)) };
            let w = if *slides { [0.0; 3] } else { *z };
            [v[0], v[1], v[2], w[0], w[1], w[2]]
        })
        .collect();
    let mut product = 1.0;
    for k in 0..6 {
        let pivot = (k..6).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap_or(k);
        if pivot != k {
            rows.swap(k, pivot);
            product = -product;
        }
        product *= rows[k][k];
        if product == 0.0 {
            return 0.0;
        }
        for i in k + 1..6 {
            let factor = rows[i][k] / rows[k][k];
            for j in k..6 {
                rows[i][j] -= factor * rows[k][j];
            }
        }
    }
    product
}

/// The gradient of the determinant by the joint variables, from differences.
fn gradient(arm: &Arm, q: &[f64]) -> Vec<f64> {
    let at = |i: usize, step: f64| {
        let mut q = q.to_vec();
        q[i] += step;
        determinant(arm, &q)
    };
    (0..q.len()).map(|i| (at(i, 1e-5) - at(i, -1e-5)) / 2e-5).collect()
}

/// `q` with `step` rad or m along the gradient.
fn along(q: &[f64], gradient: &[f64], step: f64) -> Vec<f64> {
    let over = step / gradient.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.iter().zip(gradient).map(|(q, g)| q + over * g).collect()
}

/// A posture between two random ones at which the determinant changes its sign, and the gradient there.
fn fold(arm: &Arm, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    loop {
        let (mut a, mut b) = (arm.posture(random), arm.posture(random));
        let sign = determinant(arm, &a) > 0.0;
        if (determinant(arm, &b) > 0.0) == sign {
            continue;
        }
        for _ in 0..60 {
            let middle: Vec<f64> = a.iter().zip(&b).map(|(x, y)| 0.5 * (x + y)).collect();
            if (determinant(arm, &middle) > 0.0) == sign {
                a = middle;
            } else {
                b = middle;
            }
        }
        let gradient = gradient(arm, &a);
        return (a, gradient);
    }
}

/// What random poses of an arm have shown.
#[derive(Default)]
struct Tally {
    poses: usize,
    complete: usize,
    lost: usize,
    odd: usize,
    spurious: usize,
    near: usize,
    /// Of every tenth pose.
    second: usize,
    most: usize,
    residual: f64,
    /// Postures with a residual above 1e-13.
    coarse: usize,
    postures: usize,
    times: Vec<u32>,
}

impl Tally {
    fn take(&mut self, arm: &Arm, plan: &Plan, joints: usize, q: &[f64]) {
        let t = arm.at(q);
        let timed = || {
            let start = Instant::now();
            let found = std::hint::black_box(solve(plan, arm, std::hint::black_box(&t)));
            (found, start.elapsed().as_nanos() as u32)
        };
        // The smaller of two: whoever else works on the machine seldom interrupts both.
        let ((found, first), (_, second)) = (timed(), timed());
        self.times.push(first.min(second));
        self.poses += 1;
        if let Plan::General { ways } = plan {
            let first = || determinant_on_circle(&ways[0].links_at(&t), ways[0].prismatic, arm.length()).complete;
            self.second += usize::from(self.poses.is_multiple_of(10) && !first());
        }
        self.most = self.most.max(found.count);
        if verdict(&found, joints) != Verdict::Complete {
            self.near += 1;
            return;
        }
        self.complete += 1;
        self.odd += found.count % 2;
        let values: Vec<[f64; 2]> = q.iter().enumerate().map(|(i, q)| arm.value(i, *q)).collect();
        // A residual of 1e-15 moves q by no more than about that over the determinant.
        let moved = if joints == 6 { 1e-15 / determinant(arm, q).abs() } else { 0.0 };
        let same = |branch: &Branch<6>| apart(&branch.joints[..arm.joints()], &values) <= moved.max(1e-5);
        self.lost += usize::from(!found.found().iter().any(same));
        for branch in found.found() {
            // As a caller has them: by the angles.
            let q: Vec<f64> =
                branch.joints.iter().zip(&arm.prismatic).map(|([c, s], p)| if *p { *c } else { s.atan2(*c) }).collect();
            let reached = arm.at(&q);
            let mut residual: f64 = 0.0;
            for (x, y) in reached.iter().zip(&t) {
                for k in 0..4 {
                    residual = residual.max((x[k] - y[k]).abs() / if k == 3 { arm.length() } else { 1.0 });
                }
            }
            self.postures += 1;
            self.spurious += usize::from(residual.is_nan() || residual > 1e-9);
            self.coarse += usize::from(residual.is_nan() || residual > 1e-13);
            self.residual = self.residual.max(residual);
        }
    }

    fn print(&mut self, name: &str) {
        self.times.sort_unstable();
        let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
        let time = |rank: usize| self.times.get(rank).map_or(0.0, |t| f64::from(*t) * 1e-3);
        println!(
            "{name:>10}: {} poses, {} complete, {} lost, {} odd, {} spurious, not complete {:.4} %, second runs {:.3} %",
            self.poses,
            self.complete,
            self.lost,
            self.odd,
            self.spurious,
            share(self.near, self.poses),
            share(self.second, self.poses.div_ceil(10)),
        );
        println!(
            "{:>10}  at most {} of {} postures; residual at most {:.1e}, above 1e-13 for {}; {:.2} us, 99 %: {:.2} us",
            "",
            self.most,
            self.postures,
            self.residual,
            self.coarse,
            time(self.poses / 2),
            time(self.poses * 99 / 100),
        );
    }
}

fn main() {
    let argument = |i: usize| std::env::args().nth(i);
    let poses: usize = argument(1).and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    for name in ["scara4", "planar3r", "puma560", "stanford", "panda7", "ur5", "jaco2", "general6r"] {
        if argument(2).is_some_and(|wanted| wanted != name) {
            continue;
        }
        let reference = read(name);
        let arm = completed(&reference, &reference.poses[0]);
        // The slide that completes a planar arm is none of the arm's joints.
        let joints = arm.joints() - usize::from(reference.planar);
        let plan = plan(&arm);
        let random = &mut Random(20);
        let mut tally = Tally::default();
        for _ in 0..poses {
            let mut q = arm.posture(random);
            q.iter_mut().skip(joints).for_each(|virtual_joint| *virtual_joint = 0.0);
            tally.take(&arm, &plan, joints, &q);
        }
        tally.print(name);
        if arm.joints() == 6 {
            let folds = poses.div_ceil(100).min(10_000);
            let (mut told, mut beside) = (0, 0);
            for _ in 0..folds {
                let (q, gradient) = fold(&arm, random);
                let of = |q: &[f64]| verdict(&solve(&plan, &arm, &arm.at(q)), 6);
                told += usize::from(matches!(of(&q), Verdict::Near | Verdict::Continuum));
                let step = if random.below(2) == 0 { 1e-4 } else { -1e-4 };
                beside += usize::from(of(&along(&q, &gradient, step)) == Verdict::Complete);
            }
            println!("{:>10}  {folds} folds: {told} told, {beside} complete 1e-4 beside them", "");
        }
    }
}
