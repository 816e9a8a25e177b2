//! The emitted functions of four robots as cases to measure: `benches/time.rs` by the clock, `benches/instructions.rs` by the instruction.

use std::hint::black_box;

/// Positions, rates and accelerations or torques; a robot takes as many of each as it has joints.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Joint variables, rad or m.
    pub q: [f64; 7],
    /// Their rates.
    pub dq: [f64; 7],
    /// Their accelerations, or the torques of forward dynamics.
    pub ddq: [f64; 7],
}

impl State {
    /// State number `i` of a sequence that fills the cube of angles within pi evenly: multiples of irrational numbers, each less its whole part.
    pub fn number(i: usize) -> State {
        let part = |j: usize, root: f64| ((i + 1) as f64 * (root + j as f64).sqrt()).fract() * 2.0 - 1.0;
        State {
            q: std::array::from_fn(|j| std::f64::consts::PI * part(j, 2.3)),
            dq: std::array::from_fn(|j| 2.0 * part(j, 11.7)),
            ddq: std::array::from_fn(|j| 5.0 * part(j, 23.1)),
        }
    }
}

/// One function of one robot.
#[derive(Clone, Copy)]
pub struct Case {
    /// The robot's file in `robots/`, without its ending.
    pub robot: &'static str,
    /// Where the sines come from, as `armgen generate --trig` names it.
    pub trig: &'static str,
    /// The emitted function.
    pub function: &'static str,
    /// Calls it and drops the result.
    pub call: fn(&State),
}

include!(concat!(env!("OUT_DIR"), "/functions.rs"));

macro_rules! cases {
    ($module:ident $robot:literal $trig:literal $($function:ident($($argument:ident),*);)*) => {
        [$(Case {
            robot: $robot,
            trig: $trig,
            function: stringify!($function),
            call: |state| {
                black_box($module::$function($(black_box(part(&state.$argument))),*));
            },
        }),*]
    };
}

macro_rules! robots {
    ($($module:ident $robot:literal $trig:literal;)*) => {
        $(#[allow(dead_code, missing_docs, unreachable_pub)]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs"));
        })*

        /// Every function of every robot, with the sines of `libm` and with the fast ones.
        pub fn cases() -> Vec<Case> {
            let mut all = Vec::new();
            $(all.extend(functions!(cases $module $robot $trig));)*
            all
        }
    };
}

robots! {
    scara4_libm "scara4" "libm";
    scara4_fast "scara4" "fast";
    puma560_libm "puma560" "libm";
    puma560_fast "puma560" "fast";
    ur5_libm "ur5" "libm";
    ur5_fast "ur5" "fast";
    panda7_libm "panda7" "libm";
    panda7_fast "panda7" "fast";
}

/// All postures at a pose of one robot.
#[derive(Clone, Copy)]
pub struct Solver {
    /// The robot's file in `robots/`, without its ending.
    pub robot: &'static str,
    /// The pose at a state.
    pub pose: fn(&State) -> [[f64; 4]; 4],
    /// Finds all postures at it and drops them.
    pub call: fn(&[[f64; 4]; 4]),
}

macro_rules! solvers {
    ($($module:ident $robots:ident $robot:literal;)*) => {
        $(#[allow(dead_code, missing_docs, unreachable_pub)]
        mod $module {
            include!(concat!(env!("OUT_DIR"), "/", stringify!($module), ".rs"));
        })*

        /// The inverse kinematics of every robot here that has a construction.
        pub fn solvers() -> Vec<Solver> {
            vec![$(Solver {
                robot: $robot,
                pose: |state| $robots::direct_kinematics(part(&state.q)),
                call: |pose| {
                    black_box($module::inverse_kinematics(black_box(pose)));
                },
            }),*]
        }
    };
}

solvers! {
    scara4_libm_ik scara4_libm "scara4";
    puma560_libm_ik puma560_libm "puma560";
    ur5_libm_ik ur5_libm "ur5";
}

fn part<const N: usize>(all: &[f64; 7]) -> &[f64; N] {
    all.first_chunk().expect("no robot here has more than seven joints")
}
