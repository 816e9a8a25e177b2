//! Instructions per call under valgrind: `cargo bench --bench instructions`. The same on every run of one build, whatever else the machine does.

// What gungraun makes of the functions has no documentation.
#![allow(missing_docs)]

use armgen_benches::{cases, functions, Case, State};
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

functions!(counted);
main!(library_benchmark_groups = emitted);
