//! Experiments: their kinds, settings and channels.

use std::time::Duration;

use armgen_runtime::clik::Integration;
use armgen_runtime::task::Row;

use super::{Channel, ControlLaw, Expectation, JointQuantity, Motion, PostureQuantity, Quantity, Robot};

/// A valid experiment.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Name of its file, without the extension.
    pub name: String,
    /// A title of one line.
    pub title: String,
    /// Experiments of a group also share a figure; blanks separate several groups.
    pub group: Option<String>,
    /// The kind of experiment with its settings.
    pub body: Body,
    /// The expected results.
    pub expect: Vec<Expectation>,
}

/// The kinds of experiments.
#[derive(Clone, Debug)]
pub enum Body {
    /// Manipulability in several postures.
    Postures(Postures),
    /// A planned path alone.
    Path(Sampling),
    /// Closed-loop inverse kinematics along a path.
    Clik(ClikRun),
    /// A branch of the inverse kinematics, followed along a path.
    Branch(BranchRun),
    /// A controller along a path.
    Control(ControlRun),
}

/// A posture with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    /// Its name.
    pub name: String,
    /// Joint variables, rad or m.
    pub q: Vec<f64>,
}

/// Postures to evaluate.
#[derive(Clone, Debug)]
pub struct Postures {
    /// The postures, in order.
    pub list: Vec<Posture>,
    /// The two linear rows that span the plane of the ellipsoids.
    pub plane: [Row; 2],
    /// Additional postures for a figure: all combinations of values of the first two joints.
    pub grid: Option<[Vec<f64>; 2]>,
}

/// A path with its sampling.
#[derive(Clone, Debug)]
pub struct Sampling {
    /// The path.
    pub motion: Motion,
    /// The sampling period.
    pub period: Duration,
    /// The end of the run.
    pub duration: Duration,
}

/// The start of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// These joint variables.
    Joints(Vec<f64>),
    /// A posture at the beginning of the path, by inverse kinematics; the search starts at these joint variables if given.
    Path(Option<Vec<f64>>),
}

/// A run of inverse kinematics.
#[derive(Clone, Debug)]
pub struct ClikRun {
    /// The path.
    pub sampling: Sampling,
    /// The start.
    pub start: Start,
    /// The followed rows.
    pub rows: Vec<Row>,
    /// The algorithm.
    pub algorithm: Algorithm,
    /// A gain per row.
    pub gains: Vec<f64>,
}

/// A branch of inverse kinematics along a path.
#[derive(Clone, Debug)]
pub struct BranchRun {
    /// The path.
    pub sampling: Sampling,
    /// The posture at the start of the branch.
    pub start: Start,
}

/// The algorithms of inverse kinematics by their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlgorithmKind {
    /// J^-1 (v_d + K e).
    Inverse,
    /// J' K e.
    Transpose,
    /// J^+ (v_d + K e) + (I - J^+ J) dq_0.
    PseudoInverse,
    /// J' (J J' + lambda^2 I)^-1 (v_d + K e).
    DampedLeastSquares,
    /// ddq = J^-1 (a_d + K_D de + K_P e - dJ dq).
    SecondOrder,
}

impl AlgorithmKind {
    /// All of them.
    pub const ALL: [AlgorithmKind; 5] = [
        AlgorithmKind::Inverse,
        AlgorithmKind::Transpose,
        AlgorithmKind::PseudoInverse,
        AlgorithmKind::DampedLeastSquares,
        AlgorithmKind::SecondOrder,
    ];

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            AlgorithmKind::Inverse => "inverse",
            AlgorithmKind::Transpose => "transpose",
            AlgorithmKind::PseudoInverse => "pseudo_inverse",
            AlgorithmKind::DampedLeastSquares => "damped_least_squares",
            AlgorithmKind::SecondOrder => "second_order",
        }
    }

    /// Its keys besides the gains.
    pub const fn keys(self) -> &'static [&'static str] {
        match self {
            AlgorithmKind::Inverse | AlgorithmKind::Transpose => &[],
            AlgorithmKind::PseudoInverse => &["k_0", "objective"],
            AlgorithmKind::DampedLeastSquares => &["damping", "threshold"],
            AlgorithmKind::SecondOrder => &["k_d", "integration"],
        }
    }
}

/// An algorithm of inverse kinematics.
#[derive(Clone, Debug, PartialEq)]
pub enum Algorithm {
    /// The inverse.
    Inverse,
    /// The transpose.
    Transpose,
    /// The pseudo-inverse.
    PseudoInverse {
        /// Gain k_0 of the null-space motion dq_0.
        k_0: f64,
        /// The rows whose manipulability the null-space motion maximises.
        objective: Option<Vec<Row>>,
    },
    /// Damped least squares.
    DampedLeastSquares {
        /// lambda_0, the maximum damping.
        damping: f64,
        /// w_0, the manipulability below which damping begins.
        threshold: f64,
    },
    /// Second order; the gains are K_P.
    SecondOrder {
        /// K_D, a gain per row.
        k_d: Vec<f64>,
        /// The integration of rates and positions.
        integration: Integration,
    },
}

/// Gains of second-order inverse kinematics, a gain per row of the task.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceGains {
    /// K_P, 1/s².
    pub proportional: Vec<f64>,
    /// K_D, 1/s.
    pub derivative: Vec<f64>,
}

/// A run of a controller.
#[derive(Clone, Debug)]
pub struct ControlRun {
    /// The path.
    pub sampling: Sampling,
    /// The start.
    pub start: Start,
    /// Parameters of the plant.
    pub plant: Vec<f64>,
    /// Gains of the second-order inverse kinematics that computes the joint reference.
    pub reference: ReferenceGains,
    /// The controller.
    pub law: ControlLaw,
    /// Samples between measurement and torque.
    pub delay: usize,
    /// Noise of the measurement.
    pub noise: Noise,
    /// Runge-Kutta steps per sample.
    pub substeps: u32,
    /// Whether arm and controller run in continuous time.
    pub continuous: bool,
}

/// Noise of a measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of joint variables, rad or m.
    pub position: f64,
    /// Standard deviation of rates, rad/s or m/s.
    pub rate: f64,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl Body {
    /// The recorded channels over time.
    pub fn channels(&self, robot: &Robot) -> Vec<Channel> {
        let mut quantities = vec![Quantity::Time];
        let joints = |of: JointQuantity| (0..robot.dof()).map(move |i| Quantity::Joint(of, i));
        let tip = || (0..3).map(Quantity::Tip);
        match self {
            Body::Postures(_) => return Vec::new(),
            Body::Path(_) => {
                quantities.extend(tip());
                quantities.extend([
                    Quantity::Angle,
                    Quantity::Speed,
                    Quantity::Acceleration,
                    Quantity::TurnRate,
                    Quantity::TurnAcceleration,
                    Quantity::Distance,
                    Quantity::VelocityStep,
                ]);
            }
            Body::Clik(run) => {
                quantities.extend(joints(JointQuantity::Position));
                quantities.extend(run.rows.iter().copied().map(Quantity::TaskError));
                quantities.extend([Quantity::Manipulability, Quantity::FollowedManipulability]);
                quantities.extend((run.algorithm == Algorithm::Transpose).then_some(Quantity::LoopGain));
            }
            Body::Branch(_) => {
                quantities.extend(joints(JointQuantity::Position));
                quantities.push(Quantity::Manipulability);
            }
            Body::Control(run) => {
                quantities.extend(joints(JointQuantity::Position).chain(joints(JointQuantity::Error)));
                quantities.extend(robot.task.iter().copied().map(Quantity::TaskError));
                quantities.extend(tip().chain(joints(JointQuantity::Effort)));
                quantities.extend(run.law.kind.watched(robot));
            }
        }
        quantities.into_iter().map(|quantity| Channel::new(quantity, robot)).collect()
    }

    /// The numbers of the whole run.
    pub fn numbers(&self, robot: &Robot) -> Vec<Channel> {
        let quantities = match self {
            Body::Postures(postures) => {
                let of = |(i, posture): (usize, &Posture)| {
                    PostureQuantity::ALL.map(|quantity| Channel::of_posture(quantity, i, &posture.name))
                };
                return postures.list.iter().enumerate().flat_map(of).collect();
            }
            Body::Path(sampling) => {
                let vias = sampling.motion.vias().into_iter().map(Quantity::Via);
                [Quantity::Stops, Quantity::EndsAt].into_iter().chain(vias).collect()
            }
            Body::Clik(run) if matches!(run.algorithm, Algorithm::SecondOrder { .. }) => Vec::new(),
            Body::Clik(_) => vec![Quantity::RateLimitedAt],
            Body::Branch(_) => vec![Quantity::PosturesAtStart, Quantity::BranchEndsAt],
            Body::Control(_) => {
                vec![
                    Quantity::SpectralRadius,
                    Quantity::StablePeriod,
                    Quantity::DelayedSpectralRadius,
                    Quantity::RestRadius,
                    Quantity::RestPeriod,
                    Quantity::MotionGrowth,
                    Quantity::MotionRate,
                    Quantity::MotionLostAt,
                    Quantity::LostAt,
                ]
            }
        };
        quantities.into_iter().map(|quantity| Channel::new(quantity, robot)).collect()
    }

    /// The end of the run, s.
    pub fn end(&self) -> f64 {
        self.sampling().map_or(0.0, |sampling| sampling.duration.as_secs_f64())
    }

    /// The path, if any.
    pub fn sampling(&self) -> Option<&Sampling> {
        match self {
            Body::Postures(_) => None,
            Body::Path(sampling) => Some(sampling),
            Body::Clik(run) => Some(&run.sampling),
            Body::Branch(run) => Some(&run.sampling),
            Body::Control(run) => Some(&run.sampling),
        }
    }
}
