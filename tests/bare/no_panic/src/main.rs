//! A program that links only if nothing in it can panic. It calls every function of every robot's module and of its inverse kinematics, and
//! the functions for many states of three robots. It also calls every step of the runtime and every block of inverse kinematics.
//!
//! Its panic handler calls a function that nobody defines. Where the optimiser proves every panic unreachable, the handler is
//! dropped and the program links; one surviving panic keeps it, and the linker reports
//! `undefined reference to a_panic_path_survives`. The program has neither `std` nor an allocator, so linking proves that nothing
//! needs them. With the feature `deliberate-index` it must not link. The script `tests/bare/no-panic` builds it both ways.
//!
//! This is a property of an optimised build (`--release`, a single codegen unit). The `unsafe` here is limited to two attributes.
//! `main` keeps its name, which nothing else defines, for the C library to start. The declaration of the missing function
//! promises that calling it is sound: no call ever happens, because a program with such a call does not link.
#![no_std]
#![no_main]

mod inverse_kinematics;
mod runtime;
mod timing;

/// All postures of a pose that the optimiser knows nothing of, and what can be asked of them.
macro_rules! postures {
    ($module:ident $(, $redundancy:ident)?) => {{
        use core::hint::black_box;
        $(black_box($module::$redundancy(&black_box([0.5; $module::DOF])));)?
        let found = black_box($module::inverse_kinematics(&black_box([[0.5; 4]; 4]) $(, $module::$redundancy(&black_box([0.5; $module::DOF])))?));
        black_box((found.within_limits(), found.nearest_to(&black_box([0.5; $module::DOF])), found.as_slice().len()));
    }};
}

include!(concat!(env!("OUT_DIR"), "/robots.rs"));

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        safe fn a_panic_path_survives() -> !;
    }
    a_panic_path_survives()
}

/// Started by the C library.
#[unsafe(no_mangle)]
pub extern "C" fn main() -> i32 {
    every_emitted_function();
    inverse_kinematics::every_block();
    use armgen_runtime::task::Row::{Rx, Ry, Rz, X, Y, Z};
    runtime::every_step::<_, 4, 4, { scara_f64::PARAMETERS }>(&scara_f64::Nominal, [X, Y, Z, Rz]);
    runtime::every_step::<_, 4, 3, { scara_f32::PARAMETERS }>(&scara_f32::Nominal, [Y, Z, Rz]);
    runtime::every_step::<_, 7, 6, { panda7_f64::PARAMETERS }>(&panda7_f64::Nominal, [X, Y, Z, Rx, Ry, Rz]);
    let parameters = scara_f64::WithParameters { parameters: core::hint::black_box(scara_f64::NOMINAL_PARAMETERS) };
    runtime::every_step::<_, 4, 4, { scara_f64::PARAMETERS }>(&parameters, [X, Y, Z, Rz]);
    runtime::every_observation(&scara_f32::Nominal);
    runtime::every_observation(&panda7_f64::Nominal);
    runtime::every_estimate(&scara_f32::Nominal);
    runtime::every_estimate(&panda7_f64::Nominal);
    timing::every_timing(&scara_f64::Nominal);
    timing::every_timing(&scara_f32::Nominal);
    timing::every_timing(&panda7_f64::Nominal);
    #[cfg(feature = "deliberate-index")]
    core::hint::black_box([1, 2, 3][core::hint::black_box(2)]);
    0
}
