//! The quantities of an arm: what each is, what it takes and returns, and its derivations.
//!
//! A quantity may have several derivations, each in a pool of its own: a recursion over the links and, where it stays short, the closed
//! form. All give the same expressions, which their fingerprints prove; which one is emitted is a matter of cost alone.

use crate::derive::arm::Arm;
use crate::derive::newton_euler::Motion;
use crate::derive::parameters::View;
use crate::derive::passes::Use;
use crate::derive::plan::{Pass, Passes, Plan};
use crate::derive::{self};
use crate::exact::Number;
use crate::manipulator::Manipulator;
use crate::ring::field::Field;
use crate::ring::normal_form::{Arrangement, NormalForm};
use crate::ring::{ExprId, Pool, Symbol};
use crate::Model;

/// A function of the emitted module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// T_e(q).
    DirectKinematics,
    /// T_i(q).
    LinkFrames,
    /// J(q).
    GeometricJacobian,
    /// dJ/dt(q, dq).
    GeometricJacobianDot,
    /// B(q).
    InertiaMatrix,
    /// C(q, dq).
    CoriolisMatrix,
    /// g(q).
    Gravity,
    /// F(dq).
    Friction,
    /// B, C and g together.
    EquationsOfMotion,
    /// tau(q, dq, ddq).
    InverseDynamics,
    /// ddq(q, dq, tau).
    ForwardDynamics,
    /// Y(q, dq, dqr, ddqr).
    Regressor,
    /// tau_known(q, dq, dqr, ddqr).
    KnownTorque,
    /// T(q, dq).
    KineticEnergy,
    /// U(q).
    PotentialEnergy,
    /// B dq.
    Momentum,
    /// C' dq.
    CoriolisTransposeTimes,
    /// Y_b(q, dq, ddq).
    BaseRegressor,
    /// (J B^-1 J')^-1.
    OperationalInertia,
    /// ∂tau/∂q and ∂tau/∂dq.
    InverseDynamicsDerivatives,
    /// ∂ddq/∂q, ∂ddq/∂dq and B^-1.
    ForwardDynamicsDerivatives,
}

/// An argument of an emitted function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Argument {
    /// The parameter vector.
    Pi,
    /// Joint variables.
    Q,
    /// Joint rates.
    Dq,
    /// Joint accelerations.
    Ddq,
    /// Reference rates.
    Dqr,
    /// Reference accelerations.
    Ddqr,
    /// Joint torques.
    Tau,
}

/// Shape of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A number.
    Scalar,
    /// n entries.
    Vector,
    /// 4 x 4.
    Frame,
    /// n times 4 x 4.
    Frames,
    /// 6 x n.
    Jacobian,
    /// n x n.
    Square,
    /// n x p.
    Regressor,
    /// n x b, of the base parameters.
    BaseRegressor,
    /// m x m, of the rows of the task.
    Task,
    /// B, C and g: n x n, n x n, n.
    EquationsOfMotion,
    /// So many n x n.
    Squares(u8),
}

/// What the shapes of an arm's quantities depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Number of joints.
    pub dof: usize,
    /// Number of parameters.
    pub parameters: usize,
    /// Number of base parameters.
    pub base_parameters: usize,
    /// Number of rows of the task.
    pub task: usize,
}

impl Shape {
    /// Rows and columns of one matrix, or of each of several.
    pub fn rows_columns(self, sizes: &Sizes) -> (usize, usize) {
        let n = sizes.dof;
        match self {
            Shape::Scalar => (1, 1),
            Shape::Vector => (n, 1),
            Shape::Frame | Shape::Frames => (4, 4),
            Shape::Jacobian => (6, n),
            Shape::Square | Shape::EquationsOfMotion | Shape::Squares(_) => (n, n),
            Shape::Regressor => (n, sizes.parameters),
            Shape::BaseRegressor => (n, sizes.base_parameters),
            Shape::Task => (sizes.task, sizes.task),
        }
    }
}

/// One derivation of a quantity: its entries, row by row, in a pool.
#[derive(Clone)]
pub struct Derivation {
    /// The expressions.
    pub pool: Pool,
    /// Entries, row by row.
    pub entries: Vec<ExprId>,
    /// How it was derived, in a few words.
    pub method: &'static str,
    /// For each joint the one before it whose axis is parallel to its own, and whether it points the other way.
    pub parallel: Vec<Option<(u16, bool)>>,
}

/// A division counts like so many additions.
pub const DIVISION: usize = 4;

/// And a pair of sine and cosine.
pub const PAIR: usize = 16;

/// A closed form is tried up to so many terms an entry, on the way and at the end.
pub const CLOSED_FORM_TERMS: usize = 300;

impl Quantity {
    /// All, in the order of the emitted module.
    pub const ALL: [Quantity; 21] = [
        Quantity::DirectKinematics,
        Quantity::LinkFrames,
        Quantity::GeometricJacobian,
        Quantity::GeometricJacobianDot,
        Quantity::InertiaMatrix,
        Quantity::CoriolisMatrix,
        Quantity::Gravity,
        Quantity::Friction,
        Quantity::EquationsOfMotion,
        Quantity::InverseDynamics,
        Quantity::ForwardDynamics,
        Quantity::Regressor,
        Quantity::KnownTorque,
        Quantity::KineticEnergy,
        Quantity::PotentialEnergy,
        Quantity::Momentum,
        Quantity::CoriolisTransposeTimes,
        Quantity::BaseRegressor,
        Quantity::OperationalInertia,
        Quantity::InverseDynamicsDerivatives,
        Quantity::ForwardDynamicsDerivatives,
    ];

    /// The emitted function's name.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::DirectKinematics => "direct_kinematics",
            Quantity::LinkFrames => "link_frames",
            Quantity::GeometricJacobian => "geometric_jacobian",
            Quantity::GeometricJacobianDot => "geometric_jacobian_dot",
            Quantity::InertiaMatrix => "inertia_matrix",
            Quantity::CoriolisMatrix => "coriolis_matrix",
            Quantity::Gravity => "gravity",
            Quantity::Friction => "friction",
            Quantity::EquationsOfMotion => "equations_of_motion",
            Quantity::InverseDynamics => "inverse_dynamics",
            Quantity::ForwardDynamics => "forward_dynamics",
            Quantity::Regressor => "regressor",
            Quantity::KnownTorque => "known_torque",
            Quantity::KineticEnergy => "kinetic_energy",
            Quantity::PotentialEnergy => "potential_energy",
            Quantity::Momentum => "momentum",
            Quantity::CoriolisTransposeTimes => "coriolis_transpose_times",
            Quantity::BaseRegressor => "base_regressor",
            Quantity::OperationalInertia => "operational_inertia",
            Quantity::InverseDynamicsDerivatives => "inverse_dynamics_derivatives",
            Quantity::ForwardDynamicsDerivatives => "forward_dynamics_derivatives",
        }
    }

    /// Symbol in plain text and in LaTeX.
    pub fn symbol(self) -> (&'static str, &'static str) {
        match self {
            Quantity::DirectKinematics => ("T_e(q)", "T_e(q)"),
            Quantity::LinkFrames => ("T_i(q)", "T_i(q)"),
            Quantity::GeometricJacobian => ("J(q)", "J(q)"),
            Quantity::GeometricJacobianDot => ("dJ/dt(q, dq)", "\\dot J(q, \\dot q)"),
            Quantity::InertiaMatrix => ("B(q)", "B(q)"),
            Quantity::CoriolisMatrix => ("C(q, dq)", "C(q, \\dot q)"),
            Quantity::Gravity => ("g(q)", "g(q)"),
            Quantity::Friction => ("F(dq)", "F(\\dot q)"),
            Quantity::EquationsOfMotion => ("B, C, g", "B, C, g"),
            Quantity::InverseDynamics => ("tau(q, dq, ddq)", "\\tau(q, \\dot q, \\ddot q)"),
            Quantity::ForwardDynamics => ("ddq(q, dq, tau)", "\\ddot q(q, \\dot q, \\tau)"),
            Quantity::Regressor => ("Y(q, dq, dqr, ddqr)", "Y(q, \\dot q, \\dot q_r, \\ddot q_r)"),
            Quantity::KnownTorque => ("tau_known(q, dq, dqr, ddqr)", "\\tau_0(q, \\dot q, \\dot q_r, \\ddot q_r)"),
            Quantity::KineticEnergy => ("T(q, dq)", "\\mathcal T(q, \\dot q)"),
            Quantity::PotentialEnergy => ("U(q)", "\\mathcal U(q)"),
            Quantity::Momentum => ("B dq", "B(q) \\dot q"),
            Quantity::CoriolisTransposeTimes => ("C' dq", "C^T(q, \\dot q) \\dot q"),
            Quantity::BaseRegressor => ("Y_b(q, dq, ddq)", "Y_b(q, \\dot q, \\ddot q)"),
            Quantity::OperationalInertia => ("(J B^-1 J')^-1", "(J B^{-1} J^T)^{-1}"),
            Quantity::InverseDynamicsDerivatives => {
                ("dtau/dq, dtau/d(dq)", "\\partial\\tau/\\partial q, \\partial\\tau/\\partial\\dot q")
            }
            Quantity::ForwardDynamicsDerivatives => {
                ("d(ddq)/dq, d(ddq)/d(dq), B^-1", "\\partial\\ddot q/\\partial q, \\partial\\ddot q/\\partial\\dot q, B^{-1}")
            }
        }
    }

    /// Arguments of the plain function, in order.
    pub fn arguments(self) -> &'static [Argument] {
        use Argument::{Ddq, Ddqr, Dq, Dqr, Tau, Q};
        match self {
            Quantity::DirectKinematics
            | Quantity::LinkFrames
            | Quantity::GeometricJacobian
            | Quantity::InertiaMatrix
            | Quantity::Gravity
            | Quantity::PotentialEnergy
            | Quantity::OperationalInertia => &[Q],
            Quantity::GeometricJacobianDot
            | Quantity::CoriolisMatrix
            | Quantity::EquationsOfMotion
            | Quantity::KineticEnergy
            | Quantity::Momentum
            | Quantity::CoriolisTransposeTimes => &[Q, Dq],
            Quantity::Friction => &[Dq],
            Quantity::InverseDynamics | Quantity::BaseRegressor | Quantity::InverseDynamicsDerivatives => &[Q, Dq, Ddq],
            Quantity::ForwardDynamics | Quantity::ForwardDynamicsDerivatives => &[Q, Dq, Tau],
            Quantity::Regressor | Quantity::KnownTorque => &[Q, Dq, Dqr, Ddqr],
        }
    }

    /// Whether there is a form that takes the parameters at run time.
    pub fn has_parameters(self) -> bool {
        use Quantity::*;
        matches!(
            self,
            InertiaMatrix
                | CoriolisMatrix
                | Gravity
                | Friction
                | EquationsOfMotion
                | InverseDynamics
                | ForwardDynamics
                | KineticEnergy
                | PotentialEnergy
        )
    }

    /// Why an arm does not have the quantity, if it does not.
    pub fn missing(self, model: &Model) -> Option<String> {
        if self != Quantity::OperationalInertia {
            return None;
        }
        let task = model.manipulator.task_rows();
        let mut pool = Pool::new(model.field.clone());
        let arm = Arm::new(&mut pool, &model.manipulator, View::Nominal);
        let defined = derive::operational_inertia::is_defined(&model.field, &arm, &mut pool, &task);
        (!defined).then(|| {
            let (rows, joints) = (task.len(), model.manipulator.dof());
            format!("J B^-1 J' is singular for every q: the arm's {joints} joints cannot move the {rows} rows of the task independently")
        })
    }

    /// Shape of the result.
    pub fn shape(self) -> Shape {
        match self {
            Quantity::DirectKinematics => Shape::Frame,
            Quantity::LinkFrames => Shape::Frames,
            Quantity::GeometricJacobian | Quantity::GeometricJacobianDot => Shape::Jacobian,
            Quantity::InertiaMatrix | Quantity::CoriolisMatrix => Shape::Square,
            Quantity::Gravity
            | Quantity::Friction
            | Quantity::InverseDynamics
            | Quantity::ForwardDynamics
            | Quantity::KnownTorque
            | Quantity::Momentum
            | Quantity::CoriolisTransposeTimes => Shape::Vector,
            Quantity::EquationsOfMotion => Shape::EquationsOfMotion,
            Quantity::Regressor => Shape::Regressor,
            Quantity::KineticEnergy | Quantity::PotentialEnergy => Shape::Scalar,
            Quantity::BaseRegressor => Shape::BaseRegressor,
            Quantity::OperationalInertia => Shape::Task,
            Quantity::InverseDynamicsDerivatives => Shape::Squares(2),
            Quantity::ForwardDynamicsDerivatives => Shape::Squares(3),
        }
    }

    /// The entries by recursion over the links, in a pool of their own.
    pub fn by_recursion(self, model: &Model, view: View<'_>) -> Derivation {
        self.by_plan(model, view, Plan::default(), 0)
    }

    /// The entries by recursion over the links, in the ways that cost least, as far as `effort` (counted in nodes) goes.
    pub fn by_search(self, model: &Model, view: View<'_>, without: Passes, effort: usize) -> Derivation {
        self.by_plan(model, view, Plan::new(without), effort)
    }

    pub(crate) fn by_plan(self, model: &Model, view: View<'_>, plan: Plan, effort: usize) -> Derivation {
        let parameters = &model.parameters;
        // The regressor of named parameters is the derivative by them, and its known rest what is left without them.
        let view = match self {
            Quantity::Regressor => View::Vector(parameters),
            Quantity::KnownTorque => View::Known(parameters),
            Quantity::BaseRegressor => View::Vector(model.base_parameters()),
            _ => view,
        };
        let used = self.used(view);
        let mut pool = Pool::new(model.field.clone());
        let mut arm = Arm::new(&mut pool, &model.manipulator, view);
        if self == Quantity::BaseRegressor {
            derive::base::settle(&mut pool, &mut arm);
        }
        let derive = |pool: &mut Pool, plan: &mut Plan| {
            let mut arm = arm.clone();
            derive::passes::rewrite(pool, &mut arm, plan, used);
            self.entries(pool, &arm, model, plan)
        };
        let mut plan = plan;
        if self == Quantity::OperationalInertia {
            // The Jacobian wants the lengths of the description.
            plan.keep_off(Pass::UnitOfLength);
        }
        derive::passes::suit(&pool, &arm, &mut plan);
        if effort > 0 {
            let (sketch, mut nodes) = (pool.sketch(), 0);
            plan = plan.search_from(self.starts(), effort, &mut |plan| {
                let mut pool = sketch.clone();
                pool.reserve(nodes);
                let entries = derive(&mut pool, plan);
                nodes = pool.len();
                let pairs = pool.angles(&entries).len();
                (pool.operations(&entries, DIVISION) + PAIR * pairs, pool.len())
            });
        }
        let entries = derive(&mut pool, &mut plan);
        let grouped = used == Use::Dynamics && plan.has(Pass::Grouping);
        let parallel = arm.parallel_axes();
        Derivation {
            pool,
            entries,
            parallel,
            method: if grouped { "recursion over grouped bodies" } else { "recursion over the links" },
        }
    }

    /// Where searches for its plan start.
    fn starts(self) -> &'static [usize] {
        match self {
            // At their links, by twists; and two links further in, where axes meet.
            Quantity::Regressor | Quantity::BaseRegressor => &[0, 5],
            _ => &[0],
        }
    }

    /// What the derivation may do to the arm.
    fn used(self, view: View<'_>) -> Use {
        use Quantity::*;
        match self {
            DirectKinematics | LinkFrames | GeometricJacobian | GeometricJacobianDot | Regressor | BaseRegressor => Use::Frames,
            InertiaMatrix
            | CoriolisMatrix
            | Gravity
            | EquationsOfMotion
            | InverseDynamics
            | ForwardDynamics
            | KineticEnergy
            | Momentum
            | CoriolisTransposeTimes
            | OperationalInertia
            | InverseDynamicsDerivatives
            | ForwardDynamicsDerivatives
                if matches!(view, View::Nominal) =>
            {
                Use::Dynamics
            }
            _ => Use::Plain,
        }
    }

    /// The entries for an arm in a pool, row by row.
    pub fn entries(self, pool: &mut Pool, arm: &Arm, model: &Model, plan: &mut Plan) -> Vec<ExprId> {
        match self {
            Quantity::DirectKinematics => derive::kinematics::direct_kinematics(pool, arm).concat(),
            Quantity::LinkFrames => derive::kinematics::link_frames(pool, arm).concat().concat(),
            Quantity::GeometricJacobian => derive::kinematics::geometric_jacobian(pool, arm).concat(),
            Quantity::GeometricJacobianDot => derive::kinematics::geometric_jacobian_dot(pool, arm).concat(),
            Quantity::InertiaMatrix => derive::inertia::inertia_matrix(pool, arm, plan).concat(),
            Quantity::CoriolisMatrix => derive::coriolis::coriolis_matrix(pool, arm, plan).concat(),
            Quantity::Gravity => derive::gravity::gravity(pool, arm, plan),
            Quantity::Friction => {
                let rates = arm.symbols(pool, Symbol::Rate);
                derive::newton_euler::friction(pool, arm, &rates)
            }
            Quantity::EquationsOfMotion => {
                let (b, c) = derive::coriolis::inertia_and_coriolis(pool, arm, plan);
                let g = derive::gravity::gravity(pool, arm, plan);
                [b.concat(), c.concat(), g].concat()
            }
            Quantity::InverseDynamics => {
                let motion = Motion::plain(pool, arm);
                derive::newton_euler::inverse_dynamics(pool, arm, &motion)
            }
            Quantity::ForwardDynamics => derive::forward_dynamics::forward_dynamics(pool, arm, plan),
            Quantity::Regressor => derive::regressor::regressor_by_plan(pool, arm, &model.parameters, plan).concat(),
            Quantity::KnownTorque => {
                let motion = Motion::with_reference(pool, arm);
                derive::newton_euler::inverse_dynamics(pool, arm, &motion)
            }
            Quantity::KineticEnergy => vec![derive::energy::kinetic_energy(pool, arm)],
            Quantity::PotentialEnergy => vec![derive::gravity::potential_energy(pool, arm)],
            Quantity::Momentum => derive::momentum::momentum(pool, arm),
            Quantity::CoriolisTransposeTimes => derive::momentum::coriolis_transpose_times(pool, arm),
            Quantity::BaseRegressor => derive::base::base_regressor(pool, arm, model.base_parameters(), plan).concat(),
            Quantity::OperationalInertia => {
                derive::operational_inertia::operational_inertia(pool, arm, plan, &model.manipulator.task_rows()).concat()
            }
            Quantity::InverseDynamicsDerivatives => {
                let motion = Motion::plain(pool, arm);
                let (by_q, by_dq) = derive::derivatives::inverse_dynamics_derivatives(pool, arm, plan, &motion);
                [by_q, by_dq].concat().concat()
            }
            Quantity::ForwardDynamicsDerivatives => {
                let (by_q, by_dq, inverse) = derive::derivatives::forward_dynamics_derivatives(pool, arm, plan);
                [by_q, by_dq, inverse].concat().concat()
            }
        }
    }
}

impl Derivation {
    /// The closed form of every entry, if none is too long.
    pub fn closed_forms(&self) -> Option<Vec<NormalForm>> {
        self.pool.all_normal_forms(&self.entries, CLOSED_FORM_TERMS)
    }

    /// The derivations from the closed form, if there is one: one for each order in which its products can be formed, and the same in
    /// the rates of links with parallel axes about these.
    pub fn by_closed_form(&self) -> Vec<Derivation> {
        let Some(forms) = self.closed_forms() else { return Vec::new() };
        let derivation = |forms: &[NormalForm], arrangement, meaning: &mut dyn FnMut(&mut Pool, Symbol) -> ExprId| {
            let mut pool = Pool::new(self.pool.field().clone());
            let entries = forms.iter().map(|form| pool.from_normal_form_in(form, arrangement, meaning)).collect();
            Derivation { pool, entries, method: "closed form", parallel: self.parallel.clone() }
        };
        let mut all: Vec<Derivation> = Arrangement::ALL
            .iter()
            .map(|&arrangement| derivation(&forms, arrangement, &mut |pool, symbol| pool.symbol(symbol)))
            .collect();
        if let Some(forms) = self.forms_in_absolute_rates() {
            all.extend(
                Arrangement::ALL
                    .iter()
                    .map(|&arrangement| derivation(&forms, arrangement, &mut |pool, symbol| self.absolute(pool, symbol))),
            );
        }
        all
    }

    /// The closed forms in which the rate and the acceleration of a joint stand for those of its link about the axis that it shares with
    /// links before it: dq_i -> ±(w_i - w_p). Squares of sums of rates then stay squares.
    fn forms_in_absolute_rates(&self) -> Option<Vec<NormalForm>> {
        if self.parallel.iter().all(Option::is_none) {
            return None;
        }
        let mut pool = Pool::new(self.pool.field().clone());
        let entries = self.pool.rewritten(&self.entries, &mut pool, &mut |pool, symbol| {
            let own = pool.symbol(symbol);
            let Some((rate, (before, opposite))) = moving(symbol).zip(self.before(symbol)) else {
                return own;
            };
            let before = pool.symbol(rate(before));
            pool.sub(own, before).signed(opposite)
        });
        (entries != self.entries || pool.len() != self.pool.len()).then(|| pool.all_normal_forms(&entries, CLOSED_FORM_TERMS))?
    }

    /// The joint before that of a symbol whose axis is parallel.
    fn before(&self, symbol: Symbol) -> Option<(u16, bool)> {
        self.parallel.get(usize::from(symbol.index())).copied().flatten()
    }

    /// What such a rate is: w_i = w_p ± dq_i.
    fn absolute(&self, pool: &mut Pool, symbol: Symbol) -> ExprId {
        let own = pool.symbol(symbol);
        let Some((rate, (before, opposite))) = moving(symbol).zip(self.before(symbol)) else { return own };
        let before = self.absolute(pool, rate(before));
        pool.add(before, own.signed(opposite))
    }
}

/// The kind of a rate or an acceleration.
fn moving(symbol: Symbol) -> Option<fn(u16) -> Symbol> {
    match symbol {
        Symbol::Rate(_) => Some(Symbol::Rate),
        Symbol::Acceleration(_) => Some(Symbol::Acceleration),
        Symbol::ReferenceRate(_) => Some(Symbol::ReferenceRate),
        Symbol::ReferenceAcceleration(_) => Some(Symbol::ReferenceAcceleration),
        _ => None,
    }
}

/// A field in which the constants of a valid arm have their roots, and the angle by which its last link may be turned its sine and cosine.
pub fn field_of(manipulator: &Manipulator) -> Field {
    let plain = find_field(manipulator).expect("validation refuses an arm without a field");
    let turn = derive::passes::of_last_link(&plain, manipulator);
    turn.and_then(|turn| Field::with_turn(&constants(manipulator), turn)).unwrap_or(plain)
}

/// A field in which the constants of an arm have their roots: all of them, wherever the equations may meet them. `None` if their
/// different roots are too many for any field that is tried, which validation reports.
pub fn find_field(manipulator: &Manipulator) -> Option<Field> {
    Field::with_roots_of(&constants(manipulator))
}

/// All exact constants of a description.
fn constants(manipulator: &Manipulator) -> Vec<Number> {
    let mut numbers = Vec::new();
    for joint in &manipulator.joints {
        for placement in [&joint.placement, &joint.link_frame, &manipulator.tool] {
            numbers.extend(placement.rotation.iter().flatten().cloned());
            numbers.extend(placement.translation.iter().flat_map(|p| p.terms().map(|(_, c)| c.clone())));
        }
        let bodies = [Some(&joint.link), manipulator.payload.as_ref()];
        for body in bodies.into_iter().flatten() {
            let all = std::iter::once(&body.mass).chain(&body.com).chain(&body.inertia);
            numbers.extend(all.flat_map(|p| p.terms().map(|(_, c)| c.clone())));
        }
        if let Some(motor) = &joint.motor {
            numbers.extend(motor.axis.iter().cloned());
            let all = motor.position.iter().chain([&motor.ratio, &motor.mass]).chain(&motor.inertia).chain(&motor.viscous);
            numbers.extend(all.flat_map(|p| p.terms().map(|(_, c)| c.clone())));
        }
        numbers.extend(joint.viscous.iter().chain(&joint.coulomb).flat_map(|p| p.terms().map(|(_, c)| c.clone())));
    }
    numbers.extend(manipulator.parameters.iter().map(|p| p.nominal.clone()));
    numbers.extend(manipulator.gravity.iter().flat_map(|p| p.terms().map(|(_, c)| c.clone())));
    numbers
}
