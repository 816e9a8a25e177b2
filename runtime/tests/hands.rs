//! Impedance and hand guiding under pushes: stiffness, energy, rest, and the verdict of the sampled loop, on arms whose model has
//! masses that are 10 % off and whose torques come one sample late.

use crate::common;

use armgen_runtime::{
    control::{Admittance, FrictionCompensation, HandGuiding, Impedance, NullSpace, Walls},
    reference::{OperationalReference, Pose, State},
    robot::{Dynamics, Kinematics},
    simulation::{Integrator, Noise, Plant},
    stability::{analyse, Delay, Linearise, LineariseAtRest, MotionAnalysis, StablePeriod},
    task::{Row, Task},
};
use common::{
    arms::{hobby, panda, ur5, Chain},
    close_percent, ghost,
    scara::Scara,
};
use nalgebra::{vector, SVector, Vector3, Vector4, Vector6};
use std::collections::VecDeque;

const PERIOD: f64 = 1e-3;

const UR5: [f64; 6] = [0.4, -1.2, 1.5, -0.6, 1.3, 0.5];
const PANDA: [f64; 7] = [0.2, -0.4, 0.3, -2.0, 0.1, 1.7, 0.7];
const HOBBY: [f64; 5] = [0.3, 1.0, -1.2, 0.6, 0.2];

/// An arm and a model of it, with the torques of `delay` samples ago.
struct Loop<'a, P, R, const N: usize> {
    plant: Plant<'a, P, f64, N>,
    model: &'a R,
    period: f64,
    late: VecDeque<State<f64, N>>,
    /// The work of the pushes, J, and the sum of its magnitudes.
    work: f64,
    gross: f64,
}

impl<'a, P: Dynamics<N, Real = f64>, R: Dynamics<N, Real = f64>, const N: usize> Loop<'a, P, R, N> {
    fn new(plant: &'a P, model: &'a R, start: State<f64, N>, period: f64) -> Self {
        let plant = Plant::new(plant, start, Integrator::RungeKutta4 { substeps: 2 });
        Self { plant, model, period, late: vec![start].into(), work: 0.0, gross: 0.0 }
    }

    fn state(&self) -> State<f64, N> {
        *self.plant.state()
    }

    /// One sample under the law, with the joint torques `push` of a hand.
    fn step(&mut self, mut law: impl FnMut(&R, &State<f64, N>) -> SVector<f64, N>, push: &SVector<f64, N>) {
        self.late.push_back(self.state());
        let seen = self.late.pop_front().unwrap();
        let before = self.state().q;
        self.plant.advance(&(law(self.model, &seen) + push), self.period).unwrap();
        let done = push.dot(&(self.state().q - before));
        self.work += done;
        self.gross += done.abs();
    }

    /// T + U - U^: the energy that the arm has, with gravity compensated by the model.
    fn energy(&self) -> f64 {
        let State { q, dq } = self.state();
        let arm = self.plant.robot();
        arm.kinetic_energy(&q, &dq) + arm.potential_energy(&q) - self.model.potential_energy(&q)
    }
}

fn impedance<R: Dynamics<N, Real = f64>, const N: usize, const M: usize>(
    law: &Impedance<f64, N, M>,
    goal: &OperationalReference<f64>,
) -> impl FnMut(&R, &State<f64, N>) -> SVector<f64, N> {
    let (law, goal) = (*law, *goal);
    move |model, seen| law.torque(model, &goal, seen).unwrap().tau
}

/// A force of `size` in each row of the task, one row after the other, both ways: k f from the two displacements.
fn stiffness<P: Dynamics<N, Real = f64>, R: Dynamics<N, Real = f64>, const N: usize, const M: usize>(
    what: &str,
    (plant, model): (&P, &R),
    law: &Impedance<f64, N, M>,
    (task, set): (Task<M>, [f64; M]),
    q: [f64; N],
) {
    let q = SVector::from(q);
    let goal = OperationalReference::at_rest(Pose::of(model, &q));
    for i in 0..M {
        let angular = task.rows()[i].is_angular();
        let force = set[i] * if angular { 0.04 } else { 0.02 };
        let displaced = |sign: f64| {
            let mut arm = Loop::new(plant, model, State::at_rest(q), PERIOD);
            let mut before = q;
            for k in 0..2500 {
                if k == 2250 {
                    before = arm.state().q;
                }
                let mut wrench = SVector::<f64, M>::zeros();
                wrench[i] = sign * force;
                let push = task.jacobian(&plant.geometric_jacobian(&arm.state().q)).tr_mul(&wrench);
                arm.step(impedance(law, &goal), &push);
            }
            // Dry friction at rest changes its sign at every step of the simulation: the way counts, not the rate.
            let rate = (arm.state().q - before) / (250.0 * PERIOD);
            assert!(rate.amax() < 1e-2, "{what}, {}: {rate}", task.rows()[i]);
            task.error(&goal.pose, &Pose::of(plant, &arm.state().q))[i]
        };
        let found = 2.0 * force / (displaced(-1.0) - displaced(1.0));
        close_percent(&format!("{what}, stiffness along {}", task.rows()[i]), found, set[i], 5.0);
    }
}

fn six(linear: f64, angular: f64) -> [f64; 6] {
    [linear, linear, linear, angular, angular, angular]
}

/// Masses off by 10 % up or down, link by link.
fn off(seed: u64) -> impl FnMut(usize) -> f64 {
    let mut noise = Noise::new(seed);
    move |_| if noise.uniform() < 0.5 { 0.1 } else { -0.1 }
}

fn heavier_scara() -> Scara<f64> {
    let mut scara = ghost::nominal();
    for i in 0..6 {
        scara.parameters[i] *= if i % 2 == 0 { 1.1 } else { 0.9 };
    }
    scara
}

fn panda_law(k_n: f64) -> Impedance<f64, 7, 6> {
    let null_space = NullSpace::new([k_n; 7], [8.0; 7], PANDA).unwrap();
    Impedance::new(Task::full(), six(1500.0, 100.0), 0.8).unwrap().with_null_space(null_space)
}

const HOBBY_TASK: [Row; 5] = [Row::X, Row::Y, Row::Z, Row::Ry, Row::Rz];
const HOBBY_K: [f64; 5] = [400.0, 400.0, 400.0, 8.0, 8.0];

#[test]
fn the_stiffness_is_as_set() {
    let k = [4000.0, 4000.0, 4000.0, 300.0];
    let law = Impedance::new(ghost::task(), k, 0.7).unwrap();
    stiffness("SCARA", (&heavier_scara(), &ghost::nominal()), &law, (ghost::task(), k), ghost::start().into());
    let k = six(2000.0, 150.0);
    let law = Impedance::new(Task::full(), k, 0.7).unwrap();
    stiffness("UR5", (&ur5().off(off(1)), &ur5()), &law, (Task::full(), k), UR5);
    stiffness("Panda", (&panda().off(off(2)), &panda()), &panda_law(20.0), (Task::full(), six(1500.0, 100.0)), PANDA);
    let task = Task::new(HOBBY_TASK).unwrap();
    let friction = FrictionCompensation::new(0.85, 0.02).unwrap();
    let law = Impedance::new(task, HOBBY_K, 0.8).unwrap().with_friction_compensation(friction);
    stiffness("hobby arm", (&hobby().off(off(3)), &hobby()), &law, (task, HOBBY_K), HOBBY);
}

/// A hand pushes at random, then lets go: the most energy beyond its work, of the work moved, and the largest mean rate of the last half second.
struct Pushed {
    excess: f64,
    rate: f64,
}

impl Pushed {
    fn passive(self, what: &str) -> Self {
        assert!(self.excess < 0.005, "{what}: {} of the work moved", self.excess);
        self
    }

    fn comes_to_rest(self, what: &str) {
        assert!(self.rate < 1e-3, "{what}: not at rest, {}", self.rate);
    }
}

fn pushes<P: Dynamics<N, Real = f64>, R: Dynamics<N, Real = f64>, const N: usize>(
    what: &str,
    (plant, model): (&P, &R),
    (start, size, seed): (SVector<f64, N>, f64, u64),
    mut law: impl FnMut(&R, &State<f64, N>) -> SVector<f64, N>,
    stored: impl Fn(&State<f64, N>) -> f64,
    mut watch: impl FnMut(&State<f64, N>),
) -> Pushed {
    let mut arm = Loop::new(plant, model, State::at_rest(start), PERIOD);
    let mut noise = Noise::new(seed);
    let first = arm.energy() + stored(&arm.state());
    let (mut force, mut worst) = (Vector3::zeros(), 0.0f64);
    let mut before = start;
    for k in 0..8000 {
        if k == 7500 {
            before = arm.state().q;
        }
        if k % 150 == 0 {
            force = if k < 4500 { Vector3::from_fn(|_, _| size * noise.normal()) } else { Vector3::zeros() };
        }
        let push = plant.geometric_jacobian(&arm.state().q).fixed_rows::<3>(0).tr_mul(&force);
        arm.step(&mut law, &push);
        watch(&arm.state());
        worst = worst.max(arm.energy() + stored(&arm.state()) - first - arm.work);
    }
    let rate = (arm.state().q - before).amax() / (500.0 * PERIOD);
    println!("{what}: {worst:e} J more than the work, of {} J moved; {rate:e} at rest", arm.gross);
    assert!(arm.gross > 0.0, "{what}: nothing moved");
    Pushed { excess: worst / arm.gross, rate }
}

fn pushed_impedance<P: Dynamics<N, Real = f64>, R: Dynamics<N, Real = f64>, const N: usize, const M: usize>(
    what: &str,
    (plant, model): (&P, &R),
    law: &Impedance<f64, N, M>,
    (task, k): (Task<M>, [f64; M]),
    (start, size): ([f64; N], f64),
) -> Pushed {
    let goal = OperationalReference::at_rest(Pose::of(model, &start.into()));
    let spring = |state: &State<f64, N>| {
        let e = task.error(&goal.pose, &Pose::of(plant, &state.q));
        0.5 * SVector::from(k).component_mul(&e).dot(&e)
    };
    pushes(what, (plant, model), (start.into(), size, 7), impedance(law, &goal), spring, |_| ())
}

#[test]
fn impedance_is_passive_and_comes_to_rest() {
    let k = [1500.0, 1500.0, 1500.0, 100.0];
    let law = Impedance::new(ghost::task(), k, 0.5).unwrap();
    pushed_impedance("SCARA", (&heavier_scara(), &ghost::nominal()), &law, (ghost::task(), k), (ghost::start().into(), 100.0))
        .passive("SCARA")
        .comes_to_rest("SCARA");
    let k = six(800.0, 60.0);
    let law = Impedance::new(Task::full(), k, 0.5).unwrap();
    pushed_impedance("UR5", (&ur5().off(off(4)), &ur5()), &law, (Task::full(), k), (UR5, 40.0))
        .passive("UR5")
        .comes_to_rest("UR5");
    // The spring of the null space is no gradient: without it the arm is passive, with it gravity that is off does not move the elbow.
    let arms = (&panda().off(off(5)), &panda());
    let k = six(1500.0, 100.0);
    pushed_impedance("Panda", arms, &panda_law(0.0), (Task::full(), k), (PANDA, 40.0)).passive("Panda");
    pushed_impedance("Panda", arms, &panda_law(20.0), (Task::full(), k), (PANDA, 40.0)).comes_to_rest("Panda");
    let task = Task::new([Row::X, Row::Y, Row::Z]).unwrap();
    let friction = FrictionCompensation::new(0.85, 0.02).unwrap();
    let null_space = NullSpace::new([0.0; 5], [8.0; 5], HOBBY).unwrap();
    let law = Impedance::new(task, [150.0; 3], 0.5).unwrap().with_friction_compensation(friction).with_null_space(null_space);
    pushed_impedance("hobby arm", (&hobby().off(off(6)), &hobby()), &law, (task, [150.0; 3]), (HOBBY, 3.0))
        .passive("hobby arm")
        .comes_to_rest("hobby arm");
}

fn guided<P: Dynamics<N, Real = f64>, R: Dynamics<N, Real = f64>, const N: usize>(
    what: &str,
    (plant, model): (&P, &R),
    law: HandGuiding<f64, N>,
    (walls, k_h): (Walls<f64, N>, [f64; N]),
    ([start, lower, upper], size): ([[f64; N]; 3], f64),
) {
    let law = std::cell::RefCell::new(law.with_walls(walls).with_anchor(start.into()));
    let stored = |state: &State<f64, N>| {
        let stretched = law.borrow().anchor().map_or(SVector::zeros(), |a| a - state.q);
        walls.energy(&state.q) + 0.5 * SVector::from(k_h).component_mul(&stretched).dot(&stretched)
    };
    let (mut travelled, mut reached) = (0.0f64, f64::NEG_INFINITY);
    let watch = |state: &State<f64, N>| {
        travelled = travelled.max((state.q - SVector::from(start)).amax());
        for i in 0..N {
            reached = reached.max((state.q[i] - upper[i]).max(lower[i] - state.q[i]));
        }
    };
    let torque = |model: &R, seen: &State<f64, N>| law.borrow_mut().torque(model, seen).unwrap().tau;
    pushes(what, (plant, model), (start.into(), size, 11), torque, stored, watch).passive(what).comes_to_rest(what);
    println!("{what}: moved by {travelled}, at most {reached} beyond a limit");
    assert!(travelled > 0.1 && reached < 0.0, "{what}: moved by {travelled}, {reached} beyond a limit");
}

fn around<const N: usize>(q: [f64; N], by: f64) -> [[f64; N]; 3] {
    [q, q.map(|q| q - by), q.map(|q| q + by)]
}

#[test]
fn a_guided_arm_is_passive_stays_within_its_walls_and_rests_where_it_is_let_go() {
    let limits = around(ghost::start().into(), 0.5);
    let walls = Walls::new(limits[1], limits[2], [0.1; 4], [4000.0; 4], [60.0, 30.0, 100.0, 10.0]).unwrap();
    let hold = ([15.0; 4], [3000.0, 2000.0, 5000.0, 1500.0], [100.0, 50.0, 100.0, 2.0]);
    let law = HandGuiding::new([20.0, 10.0, 60.0, 5.0]).unwrap().with_hold(hold.0, hold.1, hold.2).unwrap();
    guided("SCARA", (&heavier_scara(), &ghost::nominal()), law, (walls, hold.1), (limits, 60.0));
    let limits = around(UR5, 0.6);
    let walls = Walls::new(
        limits[1],
        limits[2],
        [0.15; 6],
        [1500.0, 1500.0, 1500.0, 500.0, 500.0, 200.0],
        [10.0, 10.0, 10.0, 5.0, 5.0, 1.0],
    );
    let hold = ([8.0, 8.0, 4.0, 1.0, 0.5, 0.3], [800.0, 800.0, 500.0, 200.0, 150.0, 40.0], [24.0, 24.0, 10.0, 2.0, 2.0, 0.4]);
    let law = HandGuiding::new([10.0, 10.0, 6.0, 2.0, 2.0, 0.5]).unwrap().with_hold(hold.0, hold.1, hold.2).unwrap();
    let law = law.with_speed_cap([1.0; 6], [10.0, 10.0, 6.0, 2.0, 2.0, 0.5]).unwrap();
    guided("UR5", (&ur5().off(off(8)), &ur5()), law, (walls.unwrap(), hold.1), (limits, 30.0));
    let limits = around(PANDA, 0.6);
    let walls = Walls::new(
        limits[1],
        limits[2],
        [0.15; 7],
        [800.0, 800.0, 800.0, 800.0, 300.0, 300.0, 200.0],
        [8.0, 8.0, 8.0, 8.0, 2.0, 2.0, 1.0],
    );
    let hold = (
        [4.0, 6.0, 4.0, 4.0, 0.6, 0.6, 0.2],
        [500.0, 500.0, 400.0, 400.0, 30.0, 30.0, 10.0],
        [15.0, 15.0, 10.0, 8.0, 0.5, 0.5, 0.2],
    );
    let law = HandGuiding::new([8.0, 8.0, 6.0, 6.0, 0.6, 0.6, 0.3]).unwrap().with_hold(hold.0, hold.1, hold.2).unwrap();
    guided("Panda", (&panda().off(off(9)), &panda()), law, (walls.unwrap(), hold.1), (limits, 25.0));
    // Half of its own friction alone would not bear gravity that is off.
    let limits = around(HOBBY, 0.8);
    let walls = Walls::new(limits[1], limits[2], [0.2; 5], [20.0; 5], [0.2; 5]).unwrap();
    let friction = FrictionCompensation::new(0.5, 0.05).unwrap();
    let hold = ([0.08; 5], [4.0; 5], [0.1; 5]);
    let law = HandGuiding::new([0.05; 5]).unwrap().with_friction_compensation(friction);
    let law = law.with_hold(hold.0, hold.1, hold.2).unwrap();
    guided("hobby arm", (&hobby().off(off(10)), &hobby()), law, (walls, hold.1), (limits, 1.0));
}

/// The verdict of a loop with one sample of delay against the loop itself, moved by 1e-4 and let go.
#[derive(Default, Debug)]
struct Verdicts {
    right: u32,
    wrong: Vec<String>,
}

impl Verdicts {
    /// The loop of `law` at a period within a factor of 2 of the longest stable one, or of 8.
    #[allow(clippy::too_many_arguments)]
    fn judge<P, C, const N: usize>(
        &mut self,
        what: &str,
        (plant, model): (&P, &P),
        law: &C,
        q: SVector<f64, N>,
        noise: &mut Noise,
        torque: impl Fn(&P, &State<f64, N>) -> SVector<f64, N>,
    ) where
        P: Dynamics<N, Real = f64>,
        C: LineariseAtRest<P, P, N>,
    {
        let report = analyse(plant, model, law, &[q], PERIOD, Delay::samples(1)).unwrap();
        let StablePeriod::UpTo(longest) = report.period else { panic!("{what}: {report:?}") };
        let (near, octaves) = (noise.uniform(), 2.0 * noise.uniform() - 1.0);
        let period = longest * 2f64.powf(if near < 0.5 { octaves } else { 3.0 * octaves });
        let radius = analyse(plant, model, law, &[q], period, Delay::samples(1)).unwrap().spectral_radius;
        let rest: SVector<f64, N> = law.settle(plant, model, &q).unwrap().q;
        let free = law.settle(plant, model, &q).unwrap().feedback.free;
        let moved = SVector::from_fn(|i, _| if free[i] { 0.0 } else { 1e-4 * noise.normal() });
        let dq = SVector::from_fn(|_, _| 1e-3 * noise.normal());
        let mut arm = Loop::new(plant, model, State { q: rest + moved, dq }, period);
        let size = |state: &State<f64, N>| {
            let off = SVector::<f64, N>::from_fn(|i, _| if free[i] { 0.0 } else { state.q[i] - rest[i] });
            off.amax() + state.dq.amax() * longest
        };
        let first = size(&arm.state());
        let mut samples = 0;
        let stable = loop {
            arm.step(&torque, &SVector::zeros());
            samples += 1;
            let now = size(&arm.state());
            if now.is_nan() || now >= first * 100.0 {
                break false;
            }
            if now < first * 1e-2 {
                break true;
            }
            if samples == 20_000 {
                break now < first;
            }
        };
        if stable == (radius < 1.0) {
            self.right += 1;
        } else {
            self.wrong.push(format!("{what}: radius {radius}, period {} of the longest, {samples} samples", period / longest));
        }
    }

    fn arms(rounds: u64, seed: u64) -> Self {
        let mut verdicts = Self::default();
        let mut noise = Noise::new(seed);
        for round in 0..rounds {
            let mut factor = || 4f64.powf(2.0 * noise.uniform() - 1.0);
            let k = six(1000.0 * factor(), 80.0 * factor());
            let ratio = 0.5 * factor();
            let by = 0.3 * (factor() - 1.0);
            let (arm, law) = (ur5(), Impedance::new(Task::full(), k, ratio).unwrap());
            let q = SVector::from(UR5).map(|q| q + by);
            let goal = OperationalReference::at_rest(Pose::of(&arm, &q));
            verdicts.judge("UR5", (&arm, &arm), &law, q, &mut noise, impedance_of(&law, &goal));
            let arm = panda();
            let law = Impedance::new(Task::full(), k, ratio).unwrap();
            let law = law.with_null_space(NullSpace::new([20.0; 7], [8.0; 7], PANDA).unwrap());
            let goal = OperationalReference::at_rest(Pose::of(&arm, &PANDA.into()));
            verdicts.judge("Panda", (&arm, &arm), &law, PANDA.into(), &mut noise, impedance_of(&law, &goal));
            let mut factor = || 4f64.powf(2.0 * noise.uniform() - 1.0);
            let (arm, law) =
                (ghost::nominal(), Impedance::new(ghost::task(), [3000.0 * factor(), 3000.0, 3000.0, 200.0 * factor()], ratio));
            let (law, q) = (law.unwrap(), ghost::start());
            let goal = OperationalReference::at_rest(Pose::of(&arm, &q));
            verdicts.judge("SCARA", (&arm, &arm), &law, q, &mut noise, impedance_of(&law, &goal));
            let mut factor = || 4f64.powf(2.0 * noise.uniform() - 1.0);
            let arm = hobby().without_friction();
            let law = HandGuiding::new([0.1 * factor(), 0.1 * factor(), 0.1, 0.05, 0.05 * factor()]).unwrap();
            // Every other arm within its walls.
            let walls = around(HOBBY, if round % 2 == 0 { 0.5 } else { 0.15 });
            let law = law.with_walls(Walls::new(walls[1], walls[2], [0.14; 5], [3.0; 5], [0.1; 5]).unwrap());
            let guiding = |model: &Chain<5>, seen: &State<f64, 5>| law.clone().torque(model, seen).unwrap().tau;
            verdicts.judge("hobby arm", (&arm, &arm), &law, HOBBY.into(), &mut noise, guiding);
        }
        println!("{} right, wrong: {:#?}", verdicts.right, verdicts.wrong);
        verdicts
    }
}

fn impedance_of<R: Dynamics<N, Real = f64>, const N: usize, const M: usize>(
    law: &Impedance<f64, N, M>,
    goal: &OperationalReference<f64>,
) -> impl Fn(&R, &State<f64, N>) -> SVector<f64, N> {
    let (law, goal) = (*law, *goal);
    move |model, seen| law.torque(model, &goal, seen).unwrap().tau
}

#[test]
fn the_verdict_is_that_of_the_loop() {
    let verdicts = Verdicts::arms(5, 1);
    assert!(verdicts.wrong.len() <= 1, "{verdicts:?}");
}

#[test]
#[ignore = "wide"]
fn the_verdict_is_that_of_a_hundred_loops() {
    let verdicts = Verdicts::arms(25, 2);
    assert!(verdicts.wrong.len() <= 5, "{verdicts:?}");
}

/// D is 2 z times the root of Lambda K: by the definition, D Lambda^-1 D = 4 z^2 K.
#[test]
fn the_damping_has_its_ratio_in_every_direction() {
    let (arm, q, z) = (ur5(), SVector::from(UR5), 0.6);
    let k = six(700.0, 50.0);
    let law = Impedance::new(Task::full(), k, z).unwrap();
    let feedback = law.linearise(&arm, &q).unwrap();
    let j = arm.geometric_jacobian(&q);
    let inverse = j.try_inverse().unwrap();
    let d = -(inverse.transpose() * feedback.velocity * inverse);
    let mobility = j * arm.inertia_matrix(&q).try_inverse().unwrap() * j.transpose();
    let expected = nalgebra::Matrix6::from_diagonal(&Vector6::from(k)) * (4.0 * z * z);
    assert!((d * mobility * d - expected).amax() < 1e-6 * expected.amax(), "{}", d * mobility * d);
}

/// A stretched arm keeps the damping of its other directions, and has no torque along the one that it has lost.
#[test]
fn a_singular_posture_is_one_like_any_other() {
    let (arm, mut q) = (ur5(), SVector::from(UR5));
    let law = Impedance::new(Task::full(), six(1000.0, 80.0), 0.7).unwrap();
    let moving = |q: SVector<f64, 6>| {
        let goal = OperationalReference::at_rest(Pose::of(&arm, &q));
        law.torque(&arm, &goal, &State { q, dq: vector![0.1, -0.2, 0.3, 0.1, 0.2, -0.3] }).unwrap()
    };
    q[2] = 1e-7;
    let near = moving(q);
    q[2] = 0.0;
    let at = moving(q);
    assert!(at.damped && (at.tau - near.tau).amax() < 1e-3, "{} {}", at.tau, near.tau);
    // A reference that moves outwards is followed as far as the arm can.
    let law = law.with_slowest(5.0).unwrap();
    let mut goal = OperationalReference::at_rest(Pose::of(&arm, &q));
    goal.velocity = Vector6::repeat(0.1);
    let torque = law.torque(&arm, &goal, &State::at_rest(q)).unwrap();
    assert!(torque.damped && torque.tau.amax() < 200.0, "{}", torque.tau);
}

/// Along a line at 0.3 m/s, with the right model and no delay, the error stays that of the sampling.
#[test]
fn a_moving_reference_is_followed() {
    let (arm, q) = (panda(), SVector::from(PANDA));
    let law = panda_law(10.0);
    let start = Pose::of(&arm, &q);
    let mut plant = Plant::new(&arm, State::at_rest(q), Integrator::RungeKutta4 { substeps: 2 });
    let mut worst = 0.0f64;
    for k in 0..2000 {
        let w = 1.5;
        let (s, c) = (w * f64::from(k) * PERIOD).sin_cos();
        let mut goal = OperationalReference::at_rest(start);
        let along = Vector3::new(0.1, 0.15, -0.1);
        goal.pose.position += along * (1.0 - c);
        goal.velocity.fixed_rows_mut::<3>(0).copy_from(&(along * (w * s)));
        goal.acceleration.fixed_rows_mut::<3>(0).copy_from(&(along * (w * w * c)));
        let measured = *plant.state();
        worst = worst.max((goal.pose.position - Pose::of(&arm, &measured.q).position).norm());
        plant.advance(&law.torque(&arm, &goal, &measured).unwrap().tau, PERIOD).unwrap();
    }
    println!("off the line by {worst:e} m");
    assert!(worst < 2e-3, "{worst}");
}

#[test]
fn a_guided_motion_is_judged() {
    use armgen_runtime::reference::JointReference;
    let arm = hobby().without_friction();
    let joints: Vec<JointReference<f64, 5>> = (0..600)
        .map(|k| {
            let (s, c) = (2.0 * f64::from(k) * 2e-3).sin_cos();
            let by = vector![0.3, -0.2, 0.2, 0.3, 0.4];
            JointReference { q: SVector::from(HOBBY) + by * (1.0 - c), dq: by * (2.0 * s), ddq: by * (4.0 * c) }
        })
        .collect();
    let start = State::at_rest(joints[0].q);
    for (damping, grows) in [(0.1, false), (8.0, true)] {
        let law = HandGuiding::new([damping; 5]).unwrap();
        let analysis = MotionAnalysis { plant: &arm, joints: &joints, start, period: 2e-3, delay: Delay::samples(1) };
        let report = analysis.of(&arm, &law, &vec![(); joints.len()]).unwrap();
        println!("{damping}: {report:?}");
        assert_eq!((report.growth.unbounded, report.lost), (grows, None), "{damping}: {report:?}");
    }
}

#[test]
fn an_admittance_gives_way_as_set() {
    let task = Task::new([Row::Z, Row::Rx]).unwrap();
    let mut law = Admittance::new(task, [5.0, 0.2], [200.0, 4.0], [1000.0, 20.0], PERIOD).unwrap();
    let arm = ur5();
    let goal = OperationalReference::at_rest(Pose::of(&arm, &UR5.into()));
    let force = vector![15.0, -2.0];
    let energy = |law: &mut Admittance<f64, 2>, force: SVector<f64, 2>| {
        let before = *law.displacement();
        let moved = law.step(&goal, &force).unwrap();
        let rate = SVector::<f64, 2>::new(moved.velocity[2], moved.velocity[3]);
        let x = *law.displacement();
        let stored = 0.5 * (5.0 * rate[0] * rate[0] + 0.2 * rate[1] * rate[1] + 1000.0 * x[0] * x[0] + 20.0 * x[1] * x[1]);
        (stored, force.dot(&(x - before)), moved)
    };
    let (mut work, mut moved) = (0.0, goal);
    for _ in 0..3000 {
        let (stored, done, next) = energy(&mut law, force);
        work += done;
        moved = next;
        assert!(stored <= work + 1e-12, "{stored} {work}");
    }
    assert!((law.displacement() - vector![0.015, -0.1]).amax() < 1e-9, "{}", law.displacement());
    let e = Task::new([Row::Z, Row::Rx]).unwrap().error(&moved.pose, &goal.pose);
    assert!((e - law.displacement()).amax() < 1e-9 && moved.velocity.amax() < 1e-6, "{e}");
    for _ in 0..5000 {
        energy(&mut law, SVector::zeros());
    }
    assert!(law.displacement().amax() < 1e-9);
    assert!(law.step(&goal, &vector![f64::NAN, 0.0]).is_err());
}

#[test]
fn a_hold_slips_at_its_force() {
    let arm = ghost::nominal();
    let q = ghost::start();
    let mut law = HandGuiding::new([1.0; 4]).unwrap().with_hold([2.0; 4], [100.0; 4], [10.0; 4]).unwrap();
    let own = arm.gravity(&q);
    assert_eq!(law.torque(&arm, &State::at_rest(q)).unwrap().tau, own);
    let by = vector![0.01, 0.05, 0.0, -0.03];
    let tau = law.torque(&arm, &State::at_rest(q + by)).unwrap().tau - own;
    assert!((tau - vector![-1.0, -2.0, 0.0, 2.0]).amax() < 1e-12, "{tau}");
    assert!((law.anchor().unwrap() - q - vector![0.0, 0.03, 0.0, -0.01]).amax() < 1e-12);
    // Its damper is cut with its spring: D dq and d_h dq, cut to f_h.
    let dq = vector![0.1, 1.0, -0.1, 0.0];
    let tau = law.with_anchor(q).torque(&arm, &State { q, dq }).unwrap().tau - own;
    assert!((tau - vector![-1.1, -3.0, 1.1, 0.0]).amax() < 1e-12, "{tau}");
    let lost = State { q, dq: Vector4::repeat(f64::NAN) };
    let before = law;
    assert!(law.torque(&arm, &lost).is_err() && law == before);
}

/// Beyond its rate, and only there, a cap brakes a joint by its damper.
#[test]
fn a_cap_brakes_beyond_its_rate() {
    let arm = ur5();
    let mut free = HandGuiding::new([0.5; 6]).unwrap();
    let mut capped = free.with_speed_cap([1.0; 6], [20.0; 6]).unwrap();
    let state = State { q: SVector::from(UR5), dq: vector![1.2, -1.5, 0.9, -1.0, 3.0, 0.0] };
    let by = capped.torque(&arm, &state).unwrap().tau - free.torque(&arm, &state).unwrap().tau;
    assert!((by - vector![-4.0, 10.0, 0.0, 0.0, -40.0, 0.0]).amax() < 1e-12, "{by}");
}
