//! Any arm, without a compilation of its own: its functions are executed as programs, with the bits of the compiled ones.
//!
//! Runs are generic over the numbers of joints, of task rows, and of parameters. [`any_arm`] chooses among the numbers that are compiled here.
//! Parameters are the exception: an arm has places for more of them than it has, which stay zero.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use armgen_codegen::catalogue::{self, Argument};
use armgen_codegen::derive::Model;
use armgen_codegen::exact::Number;
use armgen_codegen::inverse_kinematics as exact;
use armgen_codegen::program::Module;
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_evaluate::{inverse_kinematics, program, Program, Workspace};
use armgen_experiments::model::{Joint, Parameter, Robot};
use armgen_experiments::run::{Arm, Instance, Solver};
use armgen_runtime::nalgebra::{Matrix4, SMatrix, SVector};
use armgen_runtime::robot::{
    array, Dynamics, EquationsOfMotion, InverseKinematics, JointRanges, Kinematics, Posture, Postures, Regressor, Verdict,
};

/// The functions that runs call; those of dynamics also with parameters.
const FUNCTIONS: [&str; 16] = [
    "direct_kinematics",
    "link_frames",
    "geometric_jacobian",
    "geometric_jacobian_dot",
    "inertia_matrix",
    "coriolis_matrix",
    "gravity",
    "friction",
    "load_friction",
    "equations_of_motion",
    "inverse_dynamics",
    "forward_dynamics",
    "kinetic_energy",
    "potential_energy",
    "regressor",
    "known_torque",
];

/// Postures of a pose that an answer has room for: twice as many as six joints have.
const MOST: usize = 32;

/// The robot of a model.
///
/// # Errors
/// The reason why it cannot run, with a remedy.
pub fn any_arm(model: &Model) -> Result<Box<dyn Arm>, String> {
    if !model.manipulator.tips.is_empty() {
        return Err("experiments move one end effector: write `tip` in place of `tips`".into());
    }
    let mut names = Vec::new();
    for (quantity, with) in catalogue::functions_of(&model.manipulator.tips) {
        if FUNCTIONS.contains(&quantity.function_name(false).as_str()) {
            match quantity.absence(model, with) {
                None => names.push(quantity.function_name(with)),
                // An arm without such friction does as well.
                Some(_) if quantity.function_name(false) == "load_friction" => {}
                Some(reason) => {
                    return Err(format!("experiments need `{}`, which this arm lacks: {reason}", quantity.function_name(with)));
                }
            }
        }
    }
    let functions = Selection::named(names).expect("names of the catalogue");
    let module = schedule::module(model, &Options { functions, ..Options::default() });
    // Joints, task rows, places for parameters. Each takes ten seconds to compile.
    macro_rules! chosen {
        ($(($joints:literal, $rows:literal, $places:literal))*) => {
            match (module.joints.len(), module.task.len()) {
                $(($joints, $rows) => instance::<$joints, $rows, $places>(model, &module),)*
                (joints @ 1..=8, rows) => Err(format!(
                    "experiments on an arm of {joints} joints are compiled for a `task` of {} rows, not of {rows}",
                    if joints < 6 { format!("{joints} or 6") } else { "6".into() },
                )),
                (joints, _) => Err(format!("experiments are compiled for 1 to 8 joints, not for {joints}")),
            }
        };
    }
    chosen! {
        (1, 1, 20) (1, 6, 20) (2, 2, 40) (2, 6, 40) (3, 3, 60) (3, 6, 60) (4, 4, 80) (4, 6, 80)
        (5, 5, 100) (5, 6, 100) (6, 6, 120) (7, 6, 140) (8, 6, 160)
    }
}

fn instance<const N: usize, const M: usize, const P: usize>(model: &Model, module: &Module) -> Result<Box<dyn Arm>, String> {
    let count = module.parameters.len();
    if count > P {
        return Err(format!(
            "experiments on {N} joints are compiled for at most {P} parameters, and the regressor has {count}: choose `regressor: base`, or names"
        ));
    }
    let end = |end: &Option<Number>, without: f64| end.as_ref().map_or(without, Number::to_f64);
    let joints = module.joints.iter().map(|joint| Joint {
        name: joint.name.clone(),
        revolute: joint.is_revolute,
        position: [end(&joint.position[0], f64::NEG_INFINITY), end(&joint.position[1], f64::INFINITY)],
        velocity: end(&joint.velocity, f64::INFINITY),
        effort: end(&joint.effort, f64::INFINITY),
    });
    let robot = Robot {
        name: module.name.clone(),
        joints: joints.collect(),
        parameters: module
            .parameters
            .iter()
            .map(|parameter| Parameter { name: parameter.name.clone(), nominal: parameter.nominal.to_f64() })
            .collect(),
        task: Vec::new(),
    };
    let found = exact::of(&model.manipulator).ok().filter(|found| found.redundancy.is_none() && found.most <= MOST);
    let solver = found.map(|found| {
        let signs = found.choices.iter().filter(|choice| choice.ways.len() == 2).fold(0, |signs, choice| signs | 1 << choice.bit);
        let of = inverse_kinematics(&model.manipulator, &found);
        (armgen_evaluate::Solver::new(of).expect("the parts of a construction fit each other"), signs)
    });
    let callable = |with: bool| -> BTreeMap<String, Callable> {
        let functions = module.functions.iter().filter(|of| of.arguments.contains(&Argument::Pi) == with);
        functions.map(|of| (of.quantity.function_name(false), Callable::new(program(module, of), of.arguments.clone()))).collect()
    };
    let turns = std::array::from_fn(|i| module.joints[i].is_revolute);
    let limits = std::array::from_fn(|i| robot.joints[i].position);
    let has_solver = solver.is_some();
    let nominal = Executed {
        facts: Arc::new(Facts {
            nominal: callable(false),
            with_parameters: callable(true),
            gravity: module.gravity.each_ref().map(Number::to_f64),
            count,
            solver,
            turns,
            limits,
        }),
        parameters: std::array::from_fn(|i| robot.parameters.get(i).map_or(0.0, |parameter| parameter.nominal)),
        is_nominal: true,
    };
    let task = std::array::from_fn(|row| module.task[row]);
    let with = |nominal: &Executed<N, P>, parameters| Executed { facts: nominal.facts.clone(), parameters, is_nominal: false };
    let instance: Instance<_, _, N, M, P> = Instance::new(robot, task, nominal, with);
    Ok(Box::new(instance.solved_by(has_solver.then(Solver::new))))
}

/// An arm with `N` joints and places for `P` parameters.
#[derive(Clone, Debug)]
struct Executed<const N: usize, const P: usize> {
    facts: Arc<Facts<N>>,
    parameters: [f64; P],
    /// Whether the parameters are those of the description, whose functions have fewer operations.
    is_nominal: bool,
}

/// What an arm has with all parameters.
#[derive(Debug)]
struct Facts<const N: usize> {
    /// Functions of the description's parameters, and of others, by the names of the former.
    nominal: BTreeMap<String, Callable>,
    with_parameters: BTreeMap<String, Callable>,
    gravity: [f64; 3],
    /// The number of parameters.
    count: usize,
    /// Inverse kinematics, and the bits of a branch that are signs.
    solver: Option<(armgen_evaluate::Solver<f64>, u16)>,
    turns: [bool; N],
    limits: [[f64; 2]; N],
}

/// A function.
struct Callable {
    program: Program<f64>,
    takes: Vec<Argument>,
    /// The rooms of calls that are over, for the next ones: runs are parallel.
    idle: Mutex<Vec<Room>>,
}

/// The numbers of a call.
struct Room {
    workspace: Workspace<f64>,
    result: Vec<f64>,
}

impl fmt::Debug for Callable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Callable").field("takes", &self.takes).finish_non_exhaustive()
    }
}

impl Callable {
    fn new(program: Program<f64>, takes: Vec<Argument>) -> Callable {
        Callable { program, takes, idle: Mutex::default() }
    }

    fn call<R>(&self, arguments: &[&[f64]], then: impl FnOnce(&[f64]) -> R) -> R {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let left = idle().pop();
        let mut room =
            left.unwrap_or_else(|| Room { workspace: self.program.workspace(), result: vec![0.0; self.program.outputs()] });
        self.program.run(arguments, &mut room.result, &mut room.workspace).expect("arguments of one state");
        let result = then(&room.result);
        idle().push(room);
        result
    }
}

/// Vectors of one state by their names; those that a function does not take are empty.
#[derive(Clone, Copy, Default)]
struct State<'a> {
    q: &'a [f64],
    dq: &'a [f64],
    ddq: &'a [f64],
    dqr: &'a [f64],
    ddqr: &'a [f64],
    tau: &'a [f64],
}

impl<const N: usize, const P: usize> Executed<N, P> {
    fn call<R>(&self, name: &str, state: State<'_>, then: impl FnOnce(&[f64]) -> R) -> R {
        let facts = &*self.facts;
        let with = if self.is_nominal { None } else { facts.with_parameters.get(name) };
        let function = with.or_else(|| facts.nominal.get(name)).expect("an arm with dynamics has all functions of runs");
        let arguments: Vec<&[f64]> = function
            .takes
            .iter()
            .map(|argument| match argument {
                Argument::Pi => &self.parameters[..facts.count],
                Argument::Gravity => &facts.gravity,
                Argument::Q => state.q,
                Argument::Dq => state.dq,
                Argument::Ddq => state.ddq,
                Argument::Dqr => state.dqr,
                Argument::Ddqr => state.ddqr,
                Argument::Tau => state.tau,
            })
            .collect();
        function.call(&arguments, then)
    }

    fn vector(&self, name: &str, state: State<'_>) -> SVector<f64, N> {
        self.call(name, state, SVector::from_column_slice)
    }

    fn matrix<const R: usize, const C: usize>(&self, name: &str, state: State<'_>) -> SMatrix<f64, R, C> {
        self.call(name, state, SMatrix::from_row_slice)
    }
}

impl<const N: usize, const P: usize> Kinematics<N> for Executed<N, P> {
    type Real = f64;

    fn direct_kinematics(&self, q: &SVector<f64, N>) -> Matrix4<f64> {
        self.matrix("direct_kinematics", State { q: array(q), ..State::default() })
    }

    fn link_frames(&self, q: &SVector<f64, N>) -> [Matrix4<f64>; N] {
        let frames = |all: &[f64]| std::array::from_fn(|i| Matrix4::from_row_slice(&all[16 * i..16 * (i + 1)]));
        self.call("link_frames", State { q: array(q), ..State::default() }, frames)
    }

    fn geometric_jacobian(&self, q: &SVector<f64, N>) -> SMatrix<f64, 6, N> {
        self.matrix("geometric_jacobian", State { q: array(q), ..State::default() })
    }

    fn geometric_jacobian_dot(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> SMatrix<f64, 6, N> {
        self.matrix("geometric_jacobian_dot", State { q: array(q), dq: array(dq), ..State::default() })
    }
}

impl<const N: usize, const P: usize> Dynamics<N> for Executed<N, P> {
    fn inertia_matrix(&self, q: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        self.matrix("inertia_matrix", State { q: array(q), ..State::default() })
    }

    fn coriolis_matrix(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        self.matrix("coriolis_matrix", State { q: array(q), dq: array(dq), ..State::default() })
    }

    fn gravity(&self, q: &SVector<f64, N>) -> SVector<f64, N> {
        self.vector("gravity", State { q: array(q), ..State::default() })
    }

    fn friction(&self, dq: &SVector<f64, N>) -> SVector<f64, N> {
        self.vector("friction", State { dq: array(dq), ..State::default() })
    }

    fn load_friction(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> SVector<f64, N> {
        if !self.facts.nominal.contains_key("load_friction") {
            return SVector::zeros();
        }
        self.vector("load_friction", State { q: array(q), dq: array(dq), ..State::default() })
    }

    fn equations_of_motion(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> EquationsOfMotion<f64, N> {
        self.call("equations_of_motion", State { q: array(q), dq: array(dq), ..State::default() }, |all| {
            let (inertia, rest) = all.split_at(N * N);
            let (coriolis, gravity) = rest.split_at(N * N);
            EquationsOfMotion {
                inertia: SMatrix::from_row_slice(inertia),
                coriolis: SMatrix::from_row_slice(coriolis),
                gravity: SVector::from_column_slice(gravity),
            }
        })
    }

    fn inverse_dynamics(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>, ddq: &SVector<f64, N>) -> SVector<f64, N> {
        self.vector("inverse_dynamics", State { q: array(q), dq: array(dq), ddq: array(ddq), ..State::default() })
    }

    fn forward_dynamics(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>, tau: &SVector<f64, N>) -> SVector<f64, N> {
        self.vector("forward_dynamics", State { q: array(q), dq: array(dq), tau: array(tau), ..State::default() })
    }

    fn kinetic_energy(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> f64 {
        self.call("kinetic_energy", State { q: array(q), dq: array(dq), ..State::default() }, |energy| energy[0])
    }

    fn potential_energy(&self, q: &SVector<f64, N>) -> f64 {
        self.call("potential_energy", State { q: array(q), ..State::default() }, |energy| energy[0])
    }
}

impl<const N: usize, const P: usize> Regressor<N, P> for Executed<N, P> {
    fn regressor(
        &self,
        q: &SVector<f64, N>,
        dq: &SVector<f64, N>,
        dqr: &SVector<f64, N>,
        ddqr: &SVector<f64, N>,
    ) -> SMatrix<f64, N, P> {
        let (state, count) =
            (State { q: array(q), dq: array(dq), dqr: array(dqr), ddqr: array(ddqr), ..State::default() }, self.facts.count);
        self.call("regressor", state, |rows| SMatrix::from_fn(|i, j| if j < count { rows[i * count + j] } else { 0.0 }))
    }

    fn known_torque(
        &self,
        q: &SVector<f64, N>,
        dq: &SVector<f64, N>,
        dqr: &SVector<f64, N>,
        ddqr: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        let state = State { q: array(q), dq: array(dq), dqr: array(dqr), ddqr: array(ddqr), ..State::default() };
        self.vector("known_torque", state)
    }

    fn parameters(&self) -> SVector<f64, P> {
        self.parameters.into()
    }
}

impl<const N: usize, const P: usize> JointRanges<N> for Executed<N, P> {
    fn turns(&self) -> [bool; N] {
        self.facts.turns
    }

    fn position_limits(&self) -> [[f64; 2]; N] {
        self.facts.limits
    }
}

impl<const N: usize, const P: usize> InverseKinematics<N, MOST> for Executed<N, P> {
    fn inverse_kinematics(&self, pose: &Matrix4<f64>) -> Postures<f64, N, MOST> {
        let (solver, _) = self.facts.solver.as_ref().expect("runs ask robots with inverse kinematics alone");
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| pose[(i, j)]));
        let found = solver.solve(&rows, None).expect("a pose alone");
        let none = Posture { q: SVector::zeros(), branch: 0, double: false, free: 0 };
        let mut all = [none; MOST];
        for (k, posture) in all.iter_mut().take(found.len()).enumerate() {
            let q = SVector::from_column_slice(&found.q[N * k..N * (k + 1)]);
            *posture = Posture { q, branch: found.branch[k], double: found.double[k], free: found.free[k] };
        }
        Postures {
            verdict: match found.verdict {
                armgen_evaluate::Verdict::Complete => Verdict::Complete,
                armgen_evaluate::Verdict::Unreachable => Verdict::Unreachable,
                armgen_evaluate::Verdict::NearDouble => Verdict::NearDouble,
                armgen_evaluate::Verdict::Continuum => Verdict::Continuum,
                armgen_evaluate::Verdict::Invalid => Verdict::Invalid,
            },
            miss: found.miss,
            count: found.len(),
            all,
        }
    }

    fn branch_signs(&self) -> u16 {
        self.facts.solver.as_ref().map_or(0, |(_, signs)| *signs)
    }
}
