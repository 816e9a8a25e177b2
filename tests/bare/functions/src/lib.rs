//! Emitted modules in f32, each with `--trig fast` and with `--trig libm`, and calls of all their functions at a few states; inverse kinematics; steps of the runtime.
#![no_std]

pub use armgen_runtime::timing::{Governor, Node, Segment};

pub mod laws;
pub mod postures;
pub mod steps;

/// A pointer to a function that hands every function of a module to its argument.
pub type Visit = fn(u32, &mut dyn FnMut(&'static str, &mut dyn FnMut()));

/// Names of the modules, and how to visit their functions at a state of this number.
pub const MODULES: [(&str, Visit); 4] = [
    ("scara_fast", scara_fast::at_state),
    ("scara_libm", scara_libm::at_state),
    ("panda7_fast", panda7_fast::at_state),
    ("panda7_libm", panda7_libm::at_state),
];

/// Numbers in [-3, 3] that differ from state to state, quantity to quantity and joint to joint.
fn numbers<const N: usize>(state: u32, quantity: u32) -> [f32; N] {
    core::array::from_fn(|i| ((i as u32 * 7 + state * 5 + quantity * 3) % 11) as f32 * 0.6 - 3.0)
}

macro_rules! robot {
    ($name:ident) => {
        #[allow(clippy::excessive_precision)]
        pub mod $name {
            //! The emitted module, its robot of the runtime, and a call of each of its functions.
            include!(concat!(env!("OUT_DIR"), "/", stringify!($name), ".rs"));
            include!(concat!(env!("OUT_DIR"), "/", stringify!($name), "_runtime.rs"));
            include!(concat!(env!("OUT_DIR"), "/", stringify!($name), "_calls.rs"));

            /// Hands a call of each function at a state to `visit`, with the name of the function.
            pub fn at_state(state: u32, visit: &mut dyn FnMut(&'static str, &mut dyn FnMut())) {
                let of = |quantity| crate::numbers(state, quantity);
                let arguments =
                    Arguments { q: of(0), dq: of(1), ddq: of(2), dqr: of(3), ddqr: of(4), tau: of(5), pi: NOMINAL_PARAMETERS };
                // What writes into memory of the caller is called by the function that returns the same, and costs what that one costs.
                each_function(&arguments, &mut |name, call| {
                    if !name.ends_with("_into") {
                        visit(name, call);
                    }
                });
            }
        }
    };
}

robot!(scara_fast);
robot!(scara_libm);
robot!(panda7_fast);
robot!(panda7_libm);
