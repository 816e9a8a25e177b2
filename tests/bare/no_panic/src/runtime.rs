//! Every step of the runtime, with arguments that the optimiser knows nothing of.
//!
//! Methods are written `Type::method(..)`: a test of `armgen-bare-calls` reads this file and holds it against the public functions of the
//! runtime, so that none is forgotten.

use armgen_runtime::{
    clik::{
        Algorithm, Clik, DampedLeastSquares, Integration, JacobianInverse, JacobianTranspose, JointLimits, JointRangeDistance,
        Limited, LimitedSample, Manipulability, NoObjective, Objective, PseudoInverse, SecondOrder,
    },
    contact::{parameter_spread, MomentumObserver, Reaction, Threshold},
    control::{
        self, Adaptive, Admittance, BoundaryLayer, Controller, FrictionCompensation, HandGuiding, Impedance, Interval,
        InverseDynamics, NullSpace, OperationalSpace, PdGravity, Robust, TorqueLimits, Walls,
    },
    inverse_kinematics::{follow as follow_posture, follow_redundant},
    linalg::{self, Cholesky, Damping, DampingBelow, RightInverse},
    manipulability,
    nalgebra::{convert, Matrix3, RealField, SMatrix, SVector, Unit},
    orientation,
    payload::{payload_regressor, PayloadEstimator, PayloadSettings},
    reference::{JointReference, OperationalReference, Pose, State},
    robot::{
        array, matrix, CoriolisTransposeTimes, Dynamics, InverseKinematics, JointRanges, Kinematics, Momentum, Postures,
        RedundantInverseKinematics, Regressor,
    },
    task::{Row, Task},
    trajectory::{
        JointSegment, JointTrajectory, OperationalTrajectory, OrientationProfile, Path, Profile, Reach, Segment, TimeLaw, Turn,
    },
};
use core::{hint::black_box, time::Duration};

/// Numbers, vectors and times out of nowhere.
pub(crate) fn number<T: RealField + Copy>() -> T {
    convert(black_box(0.3_f64))
}

pub(crate) fn numbers<T: RealField + Copy, const N: usize>() -> [T; N] {
    core::array::from_fn(|_| number())
}

pub(crate) fn vector<T: RealField + Copy, const N: usize>() -> SVector<T, N> {
    SVector::from(numbers::<T, N>())
}

fn time() -> Duration {
    black_box(Duration::from_millis(7))
}

pub(crate) fn keep<V>(value: V) {
    black_box(value);
}

/// All postures of a robot, and a branch of them along a path.
#[inline(never)]
pub(crate) fn every_posture<R, const N: usize, const K: usize>(robot: &R)
where
    R: InverseKinematics<N, K>,
{
    let pose = Pose { position: vector::<R::Real, 3>(), rotation: matrix(&black_box([numbers::<R::Real, 3>(); 3])) };
    let postures = InverseKinematics::inverse_kinematics(robot, &Pose::frame(&pose));
    keep(Postures::as_slice(&postures).len());
    keep(InverseKinematics::branch_signs(robot));
    every_range(robot);
    keep(follow_posture(robot, |_| black_box(pose), &vector(), black_box(9), |s, q| keep((s, *q))));
}

/// The same of a robot with a joint more than a pose asks for.
#[inline(never)]
pub(crate) fn every_redundant_posture<R, const N: usize, const K: usize>(robot: &R)
where
    R: RedundantInverseKinematics<N, K>,
{
    let pose = Pose { position: vector::<R::Real, 3>(), rotation: matrix(&black_box([numbers::<R::Real, 3>(); 3])) };
    let redundancy = RedundantInverseKinematics::redundancy(robot, &vector());
    let postures = RedundantInverseKinematics::inverse_kinematics(robot, &Pose::frame(&pose), redundancy);
    keep(Postures::as_slice(&postures).len());
    keep(RedundantInverseKinematics::branch_signs(robot));
    every_range(robot);
    keep(follow_redundant(robot, |_| black_box((pose, redundancy)), &vector(), black_box(9), |s, q| keep((s, *q))));
}

fn every_range<R: JointRanges<N>, const N: usize>(robot: &R) {
    keep((JointRanges::turns(robot), JointRanges::position_limits(robot)));
    keep(JointRanges::unwrapped(robot, &vector(), &vector()));
}

/// Estimates a payload.
#[inline(never)]
pub(crate) fn every_estimate<R, const N: usize>(robot: &R)
where
    R: Dynamics<N> + Momentum<N> + CoriolisTransposeTimes<N>,
{
    let state = State { q: vector(), dq: vector() };
    let settings = PayloadSettings::<R::Real, N> {
        gravity: vector(),
        period: number(),
        filter: number(),
        forgetting: number(),
        spread: vector(),
        least_rate: number(),
        body: numbers(),
        deviation: numbers(),
        is_slow: black_box(false),
    };
    keep(payload_regressor(robot, &state, &vector()));
    if let Ok(mut estimator) = PayloadEstimator::new(settings) {
        keep(PayloadEstimator::step(&mut estimator, robot, &state, &vector()));
        keep(PayloadEstimator::estimate(&estimator));
        keep(PayloadEstimator::physical(&mut estimator));
    }
}

/// Observes contacts and answers them.
#[inline(never)]
pub(crate) fn every_observation<R, const N: usize>(robot: &R)
where
    R: Dynamics<N> + Momentum<N> + CoriolisTransposeTimes<N>,
{
    let state = State { q: vector(), dq: vector() };
    let threshold = Threshold::<R::Real, N> { spread: vector(), resolution: vector(), coulomb: vector(), load: vector() };
    let y = SMatrix::<R::Real, N, 6>::from_fn(|_, _| number());
    let parameters = parameter_spread(&y, &SMatrix::<R::Real, 6, 6>::from_fn(|_, _| number()));
    keep(Threshold::at(&threshold, &state, &vector(), &parameters));
    if let Ok(mut observer) = MomentumObserver::new(numbers(), number(), threshold, black_box(3)) {
        keep(MomentumObserver::step(&mut observer, robot, &state, &vector(), &parameters));
        keep(*MomentumObserver::residual(&observer));
    }
    if let (Ok(float), Ok(stop)) = (HandGuiding::new(numbers()), PdGravity::new(numbers(), numbers())) {
        for mut reaction in black_box([Reaction::Float(float), Reaction::Stop(stop)]) {
            keep(Reaction::torque(&mut reaction, robot, &vector(), &state));
        }
    }
}

/// Calls every public function that runs on a microcontroller, for one robot and task.
#[inline(never)]
pub(crate) fn every_step<R, const N: usize, const M: usize, const P: usize>(robot: &R, rows: [Row; M])
where
    R: Regressor<N, P>,
{
    let Ok(task) = Task::new(black_box(rows)) else { return };
    let state = State { q: vector(), dq: vector() };
    let joint = JointReference { q: vector(), dq: vector(), ddq: vector() };
    let pose = Pose { position: vector::<R::Real, 3>(), rotation: matrix(&black_box([numbers::<R::Real, 3>(); 3])) };
    let operational = OperationalReference { pose, velocity: vector::<R::Real, 6>(), acceleration: vector::<R::Real, 6>() };
    keep((
        array(&state.q),
        JointReference::at_rest(state.q),
        JointReference::held(&joint, number()),
        JointReference::is_finite(&joint),
    ));
    keep((State::at_rest(state.q), State::is_finite(&state), Pose::from_frame(&Kinematics::direct_kinematics(robot, &state.q))));
    keep((OperationalReference::at_rest(Pose::of(robot, &state.q)), OperationalReference::is_finite(&operational)));
    let j = Task::jacobian(&task, &Kinematics::geometric_jacobian(robot, &state.q));
    keep((Task::select(&task, &operational.velocity), Task::error(&task, &pose, &Pose::of(robot, &state.q)), Task::full()));
    keep(Task::<M>::from_indices(core::array::from_fn(black_box)));
    keep(Task::rows(&task).map(|row| (Row::index(row), Row::is_angular(row))));

    model(robot, &state, &joint);
    algebra(&j);
    keep(manipulability::manipulability_gradient(robot, &task, &state.q));
    turns::<R::Real>();
    trajectories::<R::Real, N>();
    inverse_kinematics(robot, task, &j, &state, &operational);
    controllers::<R, N, M, P>(robot, task, &state, &joint, &operational);
}

fn model<R, const N: usize, const P: usize>(robot: &R, state: &State<R::Real, N>, joint: &JointReference<R::Real, N>)
where
    R: Regressor<N, P>,
{
    let (q, dq, dqr, ddqr) = (&state.q, &state.dq, &joint.dq, &joint.ddq);
    keep((Kinematics::link_frames(robot, q), Kinematics::geometric_jacobian_dot(robot, q, dq)));
    keep((Dynamics::inertia_matrix(robot, q), Dynamics::coriolis_matrix(robot, q, dq), Dynamics::gravity(robot, q)));
    keep((Dynamics::friction(robot, dq), Dynamics::load_friction(robot, q, dq), Dynamics::equations_of_motion(robot, q, dq)));
    keep((Dynamics::inverse_dynamics(robot, q, dq, ddqr), Dynamics::forward_dynamics(robot, q, dq, ddqr)));
    keep((Dynamics::kinetic_energy(robot, q, dq), Dynamics::potential_energy(robot, q)));
    keep((
        Regressor::regressor(robot, q, dq, dqr, ddqr),
        Regressor::known_torque(robot, q, dq, dqr, ddqr),
        Regressor::parameters(robot),
    ));
}

fn algebra<T: RealField + Copy, const M: usize, const N: usize>(j: &SMatrix<T, M, N>) {
    if let Some(inverse) = RightInverse::new(j) {
        keep((RightInverse::solve(&inverse, &vector()), RightInverse::matrix(&inverse)));
        keep((RightInverse::null_space(&inverse, &vector()), RightInverse::volume(&inverse)));
    }
    if let Ok(damping) = Damping::below(number()).at_most(number()) {
        keep((Damping::threshold(&damping), Damping::solve(&damping, j, &vector())));
    }
    if let Some(factors) = Cholesky::new(&SMatrix::<T, N, N>::from_fn(|_, _| number())) {
        keep((Cholesky::forward(&factors, &vector()), Cholesky::backward(&factors, &vector())));
        keep((Cholesky::solve(&factors, &vector()), *Cholesky::factor(&factors)));
    }
    let [h, rows] = [(); 2].map(|()| SMatrix::<T, N, N>::from_fn(|_, _| number()));
    keep(linalg::quadratic_program(&h, &vector(), &[rows, rows], &[vector(), vector()]));
    keep(linalg::quadratic_program(&h, &vector(), &[*j], &[vector()]));
    keep(linalg::left_singular(j));
    keep(linalg::diagonal_lyapunov::<T, N>(&vector(), &vector(), &vector(), &vector()));
    keep((linalg::is_finite(j), linalg::saturate::<T, N>(&vector(), &vector())));
    keep((manipulability::manipulability(j), manipulability::velocity_ellipsoid(j), manipulability::force_ellipsoid(j)));
    keep((manipulability::condition_number(j), manipulability::distance_to_singularity(j)));
}

fn turns<T: RealField + Copy>() {
    let e: Matrix3<T> = matrix(&[numbers::<T, 3>(); 3]);
    keep((
        orientation::rotation_vector(&e),
        orientation::turn_about(&e, black_box(1)),
        orientation::swing(&e, black_box(1)),
        orientation::sine_error(&e, &e.transpose()),
    ));
    let (a, b) = (orientation::quaternion(&e), orientation::quaternion(&e.transpose()));
    keep(orientation::quaternion_error(&a, &b));
    if let Some(axis) = Unit::try_new(vector::<T, 3>(), T::zero()) {
        keep(orientation::rotation(&axis, number()));
    }
}

fn trajectories<T: RealField + Copy, const N: usize>() {
    let laws = black_box([
        TimeLaw::Trapezoidal { duration: time(), acceleration_time: time() },
        TimeLaw::TrapezoidalByAcceleration { duration: time(), acceleration: number() },
        TimeLaw::TrapezoidalByVelocity { duration: time(), velocity: number() },
        TimeLaw::TrapezoidalByLimits { velocity: number(), acceleration: number() },
        TimeLaw::Cubic { duration: time() },
        TimeLaw::Quintic { duration: time() },
    ]);
    keep(Profile::<T>::rest(time()));
    for law in laws {
        if let Ok(profile) = TimeLaw::resolve(&law, number::<T>()) {
            keep((Profile::at(&profile, time()), Profile::duration(&profile)));
        }
        operational_space::<T>(law);
        let segments = [
            JointSegment::<T, N>::to(numbers(), law),
            JointSegment::within_limits(numbers(), numbers(), numbers()),
            JointSegment::pause(time()),
        ];
        let segments = segments.map(|segment| JointSegment::anticipating(segment, time()));
        if let Ok(trajectory) = JointTrajectory::plan(numbers(), black_box(segments)) {
            keep((JointTrajectory::sample(&trajectory, time()), JointTrajectory::duration(&trajectory)));
            for segment in JointTrajectory::segments(&trajectory) {
                keep((JointSegment::start(segment), JointSegment::end(segment)));
            }
        }
    }
}

fn operational_space<T: RealField + Copy>(law: TimeLaw<T>) {
    let segments = [
        Segment::line(numbers(), law),
        Segment::arc(numbers(), numbers(), number(), law),
        Segment::arc_to(numbers(), numbers(), number(), numbers(), law),
        Segment::arc_through(numbers(), numbers(), law),
        Segment::pause(time()),
    ];
    let segments = segments.map(|segment| Segment::anticipating(segment, time()));
    let e: Matrix3<T> = matrix(&[numbers::<T, 3>(); 3]);
    let turns = [Turn::about(numbers(), number(), law), Turn::toward(e, law), Turn::pause(time())];
    let (Ok(path), Ok(orientation)) = (Path::plan(numbers(), black_box(segments)), OrientationProfile::plan(e, black_box(turns)))
    else {
        return;
    };
    keep((Path::sample(&path, time()), Path::duration(&path), Path::segment_at(&path, time())));
    for segment in Path::segments(&path) {
        keep((
            Segment::start(segment),
            Segment::end(segment),
            Segment::from(segment),
            Segment::to(segment),
            Segment::length(segment),
        ));
    }
    keep((OrientationProfile::sample(&orientation, time()), OrientationProfile::duration(&orientation)));
    for turn in OrientationProfile::turns(&orientation) {
        keep((Turn::start(turn), Turn::end(turn)));
    }
    let trajectory = OperationalTrajectory { path, orientation };
    keep((OperationalTrajectory::sample(&trajectory, time()), OperationalTrajectory::duration(&trajectory)));
    let about_point = Reach::about_point(numbers(), number(), number());
    keep(OperationalTrajectory::check_reach(&trajectory, &about_point, time()));
    if let Some(reach) = Reach::about_axis(numbers(), numbers(), number(), number()) {
        keep((Reach::distance(&reach, &vector::<T, 3>()), Reach::contains(&reach, &vector::<T, 3>())));
        keep((
            OperationalTrajectory::check_reach(&trajectory, &reach, time()),
            Path::check_reach(&trajectory.path, &reach, time()),
        ));
    }
}

fn inverse_kinematics<R, const N: usize, const M: usize, const P: usize>(
    robot: &R,
    task: Task<M>,
    j: &SMatrix<R::Real, M, N>,
    state: &State<R::Real, N>,
    reference: &OperationalReference<R::Real>,
) where
    R: Regressor<N, P>,
{
    let Ok(limits) = JointLimits::rates(numbers()) else { return };
    let Ok(limits) = JointLimits::with_range(limits, numbers(), numbers()) else { return };
    let Ok(damping) = DampingBelow::at_most(Damping::below(number()), number()) else { return };
    follow(robot, task, limits, JacobianInverse::new(numbers()), state, reference);
    follow(robot, task, limits, JacobianTranspose::new(numbers()), state, reference);
    follow(robot, task, limits, DampedLeastSquares::new(numbers(), damping), state, reference);
    follow(robot, task, limits, PseudoInverse::new(numbers(), number(), NoObjective), state, reference);
    keep((
        JointLimits::rate(&limits),
        JointLimits::slow_down(&limits, &state.dq),
        JointLimits::stop(&limits, &state.q, &vector()),
    ));
    let Ok(limits) = JointLimits::with_acceleration(limits, numbers()) else { return };
    keep((
        JointLimits::rate_bounds(&limits, state, number()),
        JointLimits::acceleration_bounds(&limits, state, number(), number()),
    ));
    let limited = Limited::new(task, numbers(), number(), limits).and_then(|law| Limited::with_weights(law, numbers()));
    if let Ok(limited) = limited {
        for law in [limited, Limited::with_direction(Limited::with_damping(limited, damping))] {
            keep(Limited::step(&law, robot, state, reference));
            let sample = Limited::sample(&law, robot, state, reference);
            if let Ok(sample) = sample.and_then(|sample| LimitedSample::then(sample, j, &vector())) {
                keep(LimitedSample::step(&sample));
            }
        }
    }
    let objective = Manipulability { task };
    keep(Objective::gradient(&objective, robot, &state.q));
    follow(
        robot,
        task,
        limits,
        PseudoInverse::new(numbers(), number(), objective).map(|algorithm| PseudoInverse::with_damping(algorithm, damping)),
        state,
        reference,
    );
    if let Ok(objective) = JointRangeDistance::new(numbers(), numbers()) {
        follow(robot, task, limits, PseudoInverse::new(numbers(), number(), objective), state, reference);
    }
    if let Ok(transpose) = JacobianTranspose::new(numbers()) {
        keep(JacobianTranspose::loop_gain(&transpose, j, number()));
    }
    for integration in black_box([Integration::ExplicitEuler, Integration::HoldConsistent]) {
        let second = SecondOrder::new(task, numbers(), numbers(), number(), integration, limits, numbers());
        let Ok(second) = second.and_then(|second| SecondOrder::with_null_space_damping(second, number())) else { return };
        keep(SecondOrder::step(&second, robot, state, reference));
        keep(SecondOrder::step(&SecondOrder::with_damping(second, damping), robot, state, reference));
    }
}

fn follow<R, A, E, const N: usize, const M: usize, const P: usize>(
    robot: &R,
    task: Task<M>,
    limits: JointLimits<R::Real, N>,
    algorithm: Result<A, E>,
    state: &State<R::Real, N>,
    reference: &OperationalReference<R::Real>,
) where
    R: Regressor<N, P>,
    A: Algorithm<R, N, M>,
{
    let Ok(algorithm) = algorithm else { return };
    let j = Task::jacobian(&task, &Kinematics::geometric_jacobian(robot, &state.q));
    keep(Algorithm::rates(&algorithm, robot, &state.q, &vector(), &vector(), &j));
    keep(Algorithm::gain(&algorithm));
    let Ok(clik) = Clik::new(task, algorithm, number(), limits, numbers()) else { return };
    keep((Clik::step(&clik, robot, &state.q, reference), Clik::task(&clik)));
    keep(Clik::approach(&clik, robot, &state.q, &reference.pose, black_box(3)));
}

fn controllers<R, const N: usize, const M: usize, const P: usize>(
    robot: &R,
    task: Task<M>,
    state: &State<R::Real, N>,
    joint: &JointReference<R::Real, N>,
    reference: &OperationalReference<R::Real>,
) where
    R: Regressor<N, P>,
{
    let Ok(limits) = TorqueLimits::new(numbers()) else { return };
    keep(TorqueLimits::apply(&limits, &vector()));
    if let Ok(pd) = PdGravity::new(numbers(), numbers()) {
        keep(PdGravity::torque(&pd, robot, joint, state));
        keep(PdGravity::torque(&PdGravity::with_torque_limits(pd, limits), robot, joint, state));
        keep(Controller::torque(&mut black_box(pd), robot, joint, state));
    }
    if let Ok(inverse) = InverseDynamics::new(numbers(), numbers()) {
        keep(InverseDynamics::torque(&inverse, robot, joint, state));
        keep(InverseDynamics::torque(&InverseDynamics::with_torque_limits(inverse, limits), robot, joint, state));
    }
    let layer = BoundaryLayer { rho: number(), epsilon: number() };
    if let Ok(robust) = Robust::new(numbers(), numbers(), numbers(), numbers(), layer) {
        keep((Robust::z(&robust, joint, state), Robust::torque(&robust, robot, joint, state)));
        keep(Robust::torque(&Robust::with_torque_limits(robust, limits), robot, joint, state));
    }
    let adaptive = Adaptive::<R::Real, N, P>::new(numbers(), numbers(), numbers(), Regressor::parameters(robot).into(), number());
    if let (Ok(mut adaptive), Ok(interval)) = (adaptive, Interval::new(numbers(), numbers())) {
        keep((Adaptive::torque(&mut adaptive, robot, joint, state), *Adaptive::estimate(&adaptive)));
        keep(Adaptive::law(&adaptive, robot, joint, state, &vector()));
        keep(Controller::torque(&mut adaptive, robot, joint, state));
        let bounded = Adaptive::with_frozen(Adaptive::with_projection(adaptive, interval), black_box([true; P]));
        keep(Adaptive::torque(&mut Adaptive::with_torque_limits(bounded, limits), robot, joint, state));
    }
    hands::<R, N, M, P>(robot, task, state, reference, limits);
    let Ok(joints) = JointLimits::rates(numbers()).and_then(|joints| JointLimits::with_range(joints, numbers(), numbers()))
    else {
        return;
    };
    let Ok(joints) = JointLimits::with_acceleration(joints, numbers()) else { return };
    let operational = OperationalSpace::new(task, numbers(), numbers(), numbers(), number());
    let operational = operational.and_then(|operational| OperationalSpace::with_integral_limit(operational, numbers()));
    if let (Ok(mut operational), Ok(damping)) = (operational, Damping::below(number()).at_most(number())) {
        keep((OperationalSpace::torque(&mut operational, robot, reference, state), *OperationalSpace::integral(&operational)));
        keep(Controller::torque(&mut operational, robot, reference, state));
        let mut damped = OperationalSpace::with_torque_limits(OperationalSpace::with_damping(operational, damping), limits);
        keep(OperationalSpace::torque(&mut damped, robot, reference, state));
        if let Ok(null_space) = NullSpace::new(numbers(), numbers(), numbers()) {
            let mut redundant = OperationalSpace::with_null_space(damped, null_space);
            keep(OperationalSpace::torque(&mut redundant, robot, reference, state));
            if let Ok(mut within) = control::Limited::new(redundant, limits, joints, number(), number()) {
                keep((control::Limited::torque(&mut within, robot, reference, state), *control::Limited::integral(&within)));
                keep(Controller::torque(&mut within, robot, reference, state));
            }
        }
    }
}

fn hands<R, const N: usize, const M: usize, const P: usize>(
    robot: &R,
    task: Task<M>,
    state: &State<R::Real, N>,
    reference: &OperationalReference<R::Real>,
    limits: TorqueLimits<R::Real, N>,
) where
    R: Regressor<N, P>,
{
    let Ok(friction) = FrictionCompensation::new(number(), number()) else { return };
    let impedance = Impedance::new(task, numbers(), number()).and_then(|law| Impedance::with_slowest(law, number()));
    if let (Ok(impedance), Ok(null_space)) = (impedance, NullSpace::new(numbers(), numbers(), numbers())) {
        keep(Impedance::torque(&impedance, robot, reference, state));
        keep(Controller::torque(&mut black_box(impedance), robot, reference, state));
        let full = Impedance::with_friction_compensation(Impedance::with_null_space(impedance, null_space), friction);
        let Ok(full) = Impedance::with_damping(Impedance::with_torque_limits(full, limits), numbers()) else { return };
        keep(Impedance::torque(&full, robot, reference, state));
    }
    let walls = Walls::new(numbers(), numbers(), numbers(), numbers(), numbers());
    if let (Ok(guiding), Ok(walls)) = (HandGuiding::new(numbers()), walls) {
        keep(HandGuiding::torque(&mut black_box(guiding), robot, state));
        keep(Walls::energy(&walls, &state.q));
        let full = HandGuiding::with_friction_compensation(HandGuiding::with_walls(guiding, walls), friction);
        let full = HandGuiding::with_speed_cap(HandGuiding::with_torque_limits(full, limits), numbers(), numbers());
        let Ok(full) = full.and_then(|law| HandGuiding::with_hold(law, numbers(), numbers(), numbers())) else { return };
        let mut full = HandGuiding::with_anchor(full, vector());
        keep((HandGuiding::torque(&mut full, robot, state), HandGuiding::anchor(&full).copied()));
        keep(Controller::torque(&mut full, robot, &(), state));
    }
    if let Ok(mut admittance) = Admittance::new(task, numbers(), numbers(), numbers(), number()) {
        keep((Admittance::step(&mut admittance, reference, &vector()), *Admittance::displacement(&admittance)));
    }
}
