//! A robot: its data and its functions, with the runs compiled for them.

use armgen_runtime::nalgebra::SVector;
use armgen_runtime::robot::Regressor;
use armgen_runtime::task::{Row, Task};

use super::{path, Arm, Demonstration, Run, Solver, Unprepared};
use crate::model::{Body, Experiment, Robot};

/// A robot with `N` joints, `M` task rows and `P` parameters: `R` has the nominal parameters, `W` others.
#[derive(Clone, Debug)]
pub struct Instance<R, W, const N: usize, const M: usize, const P: usize> {
    pub(super) robot: Robot,
    pub(super) nominal: R,
    pub(super) with_parameters: fn(&R, [f64; P]) -> W,
    pub(super) task: Task<M>,
    pub(super) solver: Option<Solver<R, N>>,
}

/// The functions that runs need, which every emitted module in f64 implements.
pub trait Functions<const N: usize, const P: usize>: Regressor<N, P, Real = f64> + Sync {}

impl<R: Regressor<N, P, Real = f64> + Sync, const N: usize, const P: usize> Functions<N, P> for R {}

/// Numbers of a file as an array. The reader has checked their count; a missing number would be NaN, which every constructor refuses.
pub(super) fn sized<const K: usize>(values: &[f64]) -> [f64; K] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(f64::NAN))
}

/// Parameters of a file, as [`sized`]. A robot that is executed has places beyond its parameters, where `rest` has no effect.
pub(super) fn padded<const K: usize>(values: &[f64], rest: f64) -> [f64; K] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(rest))
}

impl<R, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    /// The robot `nominal` with its data `robot` and the indices `task` of its task rows.
    ///
    /// # Panics
    /// If `task` is empty, repeats a row or contains an index above 5; no emitted robot has such a task.
    pub fn new(robot: Robot, task: [usize; M], nominal: R, with_parameters: fn(&R, [f64; P]) -> W) -> Self {
        let task = Task::from_indices(task).expect("the description has been checked: no row stands twice");
        let robot = Robot { task: task.rows().to_vec(), ..robot };
        Instance { robot, nominal, with_parameters, task, solver: None }
    }

    /// The same with inverse kinematics, if the robot has it.
    #[must_use]
    pub fn solved_by(self, solver: Option<Solver<R, N>>) -> Self {
        Instance { solver, ..self }
    }

    /// Joint variables of a file.
    pub(super) fn joints(values: &[f64]) -> SVector<f64, N> {
        sized(values).into()
    }
}

/// The task for checked rows.
pub(super) fn task_of<const K: usize>(rows: &[Row]) -> Option<Task<K>> {
    Task::new(<[Row; K]>::try_from(rows).ok()?).ok()
}

impl<R, W, const N: usize, const M: usize, const P: usize> Arm for Instance<R, W, N, M, P>
where
    R: Functions<N, P>,
    W: Functions<N, P>,
{
    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn implausible_settings(&self, experiment: &Experiment) -> Vec<String> {
        Instance::implausible_settings(self, experiment)
    }

    fn prepare<'a>(&'a self, experiment: &'a Experiment) -> Result<Box<dyn Run + 'a>, String> {
        let body = &experiment.body;
        Ok(match body {
            Body::Postures(postures) => Box::new(Unprepared(move || self.judge_postures(postures, body.numbers(&self.robot)))),
            Body::Path(sampling) => Box::new(Unprepared(move || path::run(sampling, body, &self.robot))),
            Body::Clik(run) => Box::new(Unprepared(move || self.follow(run, body))),
            Body::Branch(run) => self.prepare_branch(run, body)?,
            Body::Control(run) => self.prepare_control(run, experiment)?,
        })
    }

    fn demonstrate(&self) -> Result<Demonstration, String> {
        self.run_demonstration()
    }
}

/// The robot of an emitted module, from the path of the module and the implementation of the runtime's traits next to it.
#[macro_export]
macro_rules! instance {
    ($($module:ident)::+) => {{
        use $($module)::+ as emitted;
        let joint = |i: usize| $crate::model::Joint {
            name: emitted::JOINT_NAMES[i].into(),
            revolute: emitted::JOINT_IS_REVOLUTE[i],
            position: emitted::POSITION_LIMITS[i],
            velocity: emitted::VELOCITY_LIMITS[i],
            effort: emitted::EFFORT_LIMITS[i],
        };
        let parameter =
            |(name, nominal): (&&str, f64)| $crate::model::Parameter { name: (*name).into(), nominal };
        let robot = $crate::model::Robot {
            name: emitted::NAME.into(),
            joints: (0..emitted::DOF).map(joint).collect(),
            parameters: emitted::PARAMETER_NAMES.iter().zip(emitted::NOMINAL_PARAMETERS).map(parameter).collect(),
            task: Vec::new(),
        };
        $crate::run::Instance::<_, _, { emitted::DOF }, { emitted::TASK_ROWS }, { emitted::PARAMETERS }>::new(
            robot,
            emitted::TASK,
            emitted::Nominal,
            |_, parameters| {
                // The nominal gravity, where a robot has one of its own.
                #[allow(clippy::needless_update)]
                let robot = emitted::WithParameters { parameters, ..Default::default() };
                robot
            },
        )
        .solved_by({
            // Exactly one of the two traits has the method for this robot.
            #[allow(unused_imports)]
            use $crate::run::{Solves, SolvesNot};
            (&$crate::run::Probe::of(&emitted::Nominal)).solver()
        })
    }};
}
