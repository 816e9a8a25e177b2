//! Time of one call, all solutions of a pose, for the arms of `tests/data`: `cargo run --release --example time -p armgen-inverse-kinematics`.
//!
//! An arm's name as an argument times it alone, a number after it in so many rounds.
//! Each arm: its random reference poses over and over, the median and the least of 31 rounds, both scalars. The arm's constants are arguments
//! here; where a generator prints them as constants of a module a call is not slower.

#[path = "../tests/common/mod.rs"]
#[macro_use]
mod common;

use std::hint::black_box;
use std::time::Instant;

/// How many rounds: the second argument, 31 if there is none.
fn rounds() -> usize {
    std::env::args().nth(2).and_then(|n| n.parse().ok()).unwrap_or(31)
}

/// Median and least time of a call in us.
fn measure<T>(poses: &[T], mut call: impl FnMut(&T) -> usize) -> (f64, f64) {
    let mut times = vec![];
    for _ in 0..rounds() {
        let start = Instant::now();
        let mut calls = 0;
        while calls < 200 {
            for pose in poses {
                black_box(call(black_box(pose)));
                calls += 1;
            }
        }
        times.push(start.elapsed().as_secs_f64() * 1e6 / calls as f64);
    }
    times.sort_by(f64::total_cmp);
    (times[times.len() / 2], times[0])
}

in_both_scalars! {
    #[allow(unreachable_pub, dead_code)]
    mod arm {
        use super::*;
        include!("../tests/common/arm.rs");
        include!("../tests/common/solver.rs");
        include!("../tests/common/files.rs");
    }
    use arm::*;
    use crate::measure;

    const ARM: bool = UNIT_ROUNDOFF < 1e-10;

    /// The angles of all solutions: what a caller wants of them.
    fn angles<const J: usize, const N: usize>(found: &Branches<J, N>, way: &Arrangement<J>) -> usize {
        for branch in found.found() {
            let joints = way.of_arm(branch).joints;
            std::hint::black_box(joints.map(angle));
        }
        found.count
    }

    pub(crate) fn all() {
        for name in ["scara4", "planar3r", "puma560", "stanford", "panda7", "ur5", "jaco2", "general6r"] {
            if std::env::args().nth(1).is_some_and(|wanted| wanted != name) {
                continue;
            }
            let reference = read(name);
            let first = &reference.poses[0];
            let arm = completed(&reference, first);
            let plan = plan(&arm);
            let poses: Vec<Frame> = reference.poses.iter().filter(|p| p.kind == "random").map(|p| p.t).collect();
            let (median, least) = match &plan {
                Plan::ParallelTurns { way, regional } => measure(&poses, |t| {
                    let [p1, p2, p3, _] = way.prismatic;
                    let block = regional.block;
                    angles(&parallel_turns(&way.links_at(t), [p1, p2, p3], block), way)
                }),
                Plan::SphericalTriple { way, regional } => measure(&poses, |t| {
                    let [p1, p2, p3, ..] = way.prismatic;
                    let block = regional.block;
                    angles(&spherical_triple(&way.links_at(t), [p1, p2, p3], block), way)
                }),
                Plan::ThreeParallel { way, .. } => measure(&poses, |t| angles(&three_parallel(&way.links_at(t)), way)),
                Plan::General { ways } => {
                    let length = arm.length();
                    let whole = measure(&poses, |t| general_arm(ways, t, length).count);
                    let one = measure(&poses, |t| determinant_on_circle(&ways[0].links_at(t), ways[0].prismatic, length).found.count);
                    println!("{:>10} {} first arrangement alone {:.2}", "", if ARM { "f64" } else { "f32" }, one.0);
                    whole
                }
            };
            let text = format!("{plan:?}");
            let class = text.split(' ').next().unwrap_or_default();
            println!("{name:>10} {} {class:<16} {median:>7.3} us (least {least:.3})", if ARM { "f64" } else { "f32" });
        }
    }
}

fn main() {
    double::all();
    single::all();
}
