//! Time per call: `cargo bench --bench time [FILTER]`, FILTER as in `panda7/fast/gravity`.
//!
//! Each call takes the next of 64 states, so that no branch of a sine is foreseen. Times move with the machine and its neighbours: compare ratios
//! within one run only.

use std::hint::black_box;
use std::time::Duration;

use armgen_benches::{cases, solvers, State};
use criterion::Criterion;

#[path = "../../codegen/tests/sines/emitted.rs"]
mod emitted;

/// The sines and cosines of one, four and eight angles alone, by `--trig fast`, `libm` and the standard library.
fn sines(criterion: &mut Criterion, states: &[[f64; 8]]) {
    let mut bench = |name: &str, call: &dyn Fn(&[f64; 8])| {
        criterion.bench_function(&format!("sines/{name}"), |bencher| {
            let mut next = 0;
            bencher.iter(|| {
                call(black_box(&states[next]));
                next = (next + 1) % states.len();
            });
        });
    };
    bench("fast/1", &|x| drop(black_box(emitted::f64::one(x[0]))));
    bench("fast/4", &|x| drop(black_box(emitted::f64::four(4, [x[0], x[1], x[2], x[3]]))));
    bench("fast/8", &|x| drop(black_box(emitted::f64::eight(8, *x))));
    for count in [1, 4, 8] {
        bench(&format!("libm/{count}"), &|x| x[..count].iter().for_each(|&x| drop(black_box(libm::sincos(x)))));
        bench(&format!("std/{count}"), &|x| x[..count].iter().for_each(|&x| drop(black_box(x.sin_cos()))));
    }
}

fn main() {
    let states: Vec<State> = (0..64).map(State::number).collect();
    let mut criterion = Criterion::default()
        .without_plots()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    let angles: Vec<[f64; 8]> = states.iter().map(|s| std::array::from_fn(|i| if i < 7 { s.q[i] } else { s.dq[0] })).collect();
    sines(&mut criterion, &angles);
    for case in cases() {
        criterion.bench_function(&format!("{}/{}/{}", case.robot, case.trig, case.function), |bencher| {
            let mut next = 0;
            bencher.iter(|| {
                (case.call)(&states[next]);
                next = (next + 1) % states.len();
            });
        });
    }
    for solver in solvers() {
        let poses: Vec<[[f64; 4]; 4]> = states.iter().map(solver.pose).collect();
        criterion.bench_function(&format!("{}/libm/inverse_kinematics", solver.robot), |bencher| {
            let mut next = 0;
            bencher.iter(|| {
                (solver.call)(&poses[next]);
                next = (next + 1) % poses.len();
            });
        });
    }
    criterion.final_summary();
}
