//! Instructions per call under valgrind: `cargo bench --bench instructions`. The same on every run of one build, whatever else the machine does.

// What gungraun makes of the functions has no documentation.
#![allow(missing_docs)]

use armgen_benches::{cases, functions, solvers, Case, Solver, State};
use gungraun::{library_benchmark, library_benchmark_group, main};

fn case(robot: &str, trig: &str, function: &str) -> (Case, State) {
    let found = cases().into_iter().find(|case| (case.robot, case.trig, case.function) == (robot, trig, function));
    (found.expect("every robot has every function"), State::number(7))
}

macro_rules! counted {
    ($($function:ident($($argument:ident),*);)*) => {
        $(#[library_benchmark]
        #[bench::scara4_libm(case("scara4", "libm", stringify!($function)))]
        #[bench::scara4_fast(case("scara4", "fast", stringify!($function)))]
        #[bench::puma560_libm(case("puma560", "libm", stringify!($function)))]
        #[bench::puma560_fast(case("puma560", "fast", stringify!($function)))]
        #[bench::ur5_libm(case("ur5", "libm", stringify!($function)))]
        #[bench::ur5_fast(case("ur5", "fast", stringify!($function)))]
        #[bench::panda7_libm(case("panda7", "libm", stringify!($function)))]
        #[bench::panda7_fast(case("panda7", "fast", stringify!($function)))]
        fn $function((case, state): (Case, State)) {
            (case.call)(&state);
        })*

        library_benchmark_group!(name = emitted; benchmarks = $($function),*);
    };
}

fn solver(robot: &str) -> (Solver, [[f64; 4]; 4]) {
    let found = solvers().into_iter().find(|solver| solver.robot == robot).expect("a robot with a construction");
    (found, (found.pose)(&State::number(7)))
}

#[library_benchmark]
#[bench::scara4_libm(solver("scara4"))]
#[bench::puma560_libm(solver("puma560"))]
#[bench::ur5_libm(solver("ur5"))]
fn inverse_kinematics((solver, pose): (Solver, [[f64; 4]; 4])) {
    (solver.call)(&pose);
}

library_benchmark_group!(name = solved; benchmarks = inverse_kinematics);

functions!(counted);
main!(library_benchmark_groups = emitted, solved);
