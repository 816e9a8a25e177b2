//! The simulated plant: integration, energies, sensors, speed.

use crate::common;

use armgen_runtime::{
    control::OperationalSpace,
    reference::State,
    simulation::{run, Divergence, Integrator, Plant, RunError, RunOptions, Sensor},
};
use common::{
    below, ghost,
    mass::{EVALUATIONS, FREE},
    scara::Scara,
};
use nalgebra::{vector, Vector4};
use std::time::Duration;

fn tuned() -> OperationalSpace<f64, 4, 4> {
    OperationalSpace::new(ghost::task(), [1e4; 4], [200.0; 4], [1e5; 4], 1e-3).unwrap()
}

fn states(integrator: Integrator<f64>) -> Vec<State<f64, 4>> {
    let (model, plant, trajectory, mut controller) = (ghost::nominal(), ghost::loaded(), ghost::ghost::<f64>(), tuned());
    let mut options = RunOptions::new(ghost::PERIOD, ghost::WITH_HOLD);
    options.integrator = integrator;
    let mut states = Vec::new();
    run(
        &plant,
        State::at_rest(ghost::start()),
        options,
        |t, measured| controller.torque(&model, &trajectory.sample(t), measured).map(|torque| torque.tau),
        |sample| states.push(sample.state),
    )
    .unwrap();
    states
}

fn apart(a: &[State<f64, 4>], b: &[State<f64, 4>]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a.q - b.q).amax().max((a.dq - b.dq).amax())).fold(0.0, f64::max)
}

#[test]
fn one_and_ten_substeps_agree() {
    let one = states(Integrator::RungeKutta4 { substeps: 1 });
    below("1 against 10 substeps", apart(&one, &states(Integrator::RungeKutta4 { substeps: 10 })), 1e-9);
    let adaptive = states(Integrator::DormandPrince { tolerance: 1e-12, most_steps: 100 });
    below("1 substep against adaptive steps", apart(&one, &adaptive), 1e-9);
    assert_eq!(one, states(Integrator::RungeKutta4 { substeps: 1 }), "equal runs give equal bits");
}

#[test]
fn energy_is_kept_in_free_fall() {
    let arm = Scara::<f64>::loaded().frictionless();
    for integrator in [Integrator::RungeKutta4 { substeps: 1 }, Integrator::DormandPrince { tolerance: 1e-13, most_steps: 1000 }]
    {
        let start = State { q: vector![0.3, 1.1, 0.2, 0.4], dq: vector![2.0, -3.0, 0.5, 4.0] };
        let mut plant = Plant::new(&arm, start, integrator).with_audit();
        let mut worst = 0.0f64;
        for _ in 0..2000 {
            plant.advance(&Vector4::zeros(), 1e-3).unwrap();
            worst = worst.max(plant.energy().unwrap().residual.abs());
        }
        below("energy drift in 2 s, J", worst, 1e-9);
        assert!(plant.energy().unwrap().kinetic > 100.0, "it does fall: {:?}", plant.energy());
    }
}

#[test]
fn energy_adds_up_with_torques_and_friction() {
    let arm = Scara::<f64>::loaded();
    let start = State { q: vector![0.3, 1.1, 0.2, 0.4], dq: vector![2.0, -3.0, 0.5, 4.0] };
    let mut plant = Plant::new(&arm, start, Integrator::RungeKutta4 { substeps: 2 }).with_audit();
    for k in 0..2000 {
        let t = f64::from(k) * 1e-3;
        plant.advance(&vector![5.0 * t.sin(), -3.0, -100.0 * t.cos(), 1.0], 1e-3).unwrap();
    }
    let energy = plant.energy().unwrap();
    println!("{energy:?}");
    assert!(energy.dissipated > 1.0 && energy.supplied.abs() > 1.0);
    below("residual, J", energy.residual.abs(), 1e-8);
}

/// A slide that falls: F_l |g| brakes it, a force that does not change.
#[test]
fn energy_adds_up_with_friction_that_grows_with_the_load() {
    let arm = Scara::<f64> { load: 0.25, ..Scara::loaded().frictionless() };
    let start = State { q: vector![0.3, 1.1, 0.2, 0.4], dq: vector![0.0, 0.0, 0.5, 0.0] };
    let mut plant = Plant::new(&arm, start, Integrator::RungeKutta4 { substeps: 1 }).with_audit();
    for _ in 0..500 {
        plant.advance(&Vector4::zeros(), 1e-3).unwrap();
    }
    let (energy, way) = (plant.energy().unwrap(), plant.state().q[2] - 0.2);
    below("work of friction, J", (energy.dissipated - 0.25 * 15.0 * 9.81 * way).abs(), 1e-9);
    assert!(way > 0.3, "it falls: {way}");
    below("residual, J", energy.residual.abs(), 1e-9);
}

fn with_sensor(sensor: Sensor<f64, 4>) -> Result<f64, RunError<armgen_runtime::control::ControlError>> {
    let (model, plant, trajectory) = (ghost::nominal(), ghost::loaded(), ghost::ghost::<f64>());
    let gains = ([5000.0, 5000.0, 10000.0, 5000.0], [50.0, 50.0, 100.0, 50.0]);
    let mut controller = OperationalSpace::new(ghost::task(), gains.0, gains.1, [0.0; 4], 1e-3).unwrap();
    let mut options = RunOptions::new(ghost::PERIOD, Duration::from_secs(3));
    options.sensor = sensor;
    let mut z = Vec::new();
    run(
        &plant,
        State::at_rest(ghost::start()),
        options,
        |t, measured| controller.torque(&model, &trajectory.sample(t), measured).map(|torque| torque.tau),
        |sample| z.push(sample.state.q[2]),
    )?;
    let mean = z[2000..].iter().sum::<f64>() / z[2000..].len() as f64;
    Ok((z[2000..].iter().map(|z| (z - mean).powi(2)).sum::<f64>() / z[2000..].len() as f64).sqrt())
}

#[test]
fn noise_and_delay_reach_the_arm() {
    let still = with_sensor(Sensor::ideal()).unwrap();
    let noisy = with_sensor(Sensor::new(0, 1e-5, 1e-3, 42)).unwrap();
    let delayed = with_sensor(Sensor::new(1, 0.0, 0.0, 0)).unwrap();
    println!("deviation of d3: {still:e}, with noise {noisy:e}, with a delay {delayed:e}");
    assert!(noisy > 10.0 * still);
    // A measurement of 1 ms ago takes damping: the arm swings more, and as much each time.
    assert!(delayed > 1.01 * still, "{delayed:e} {still:e}");
    assert_eq!(delayed, with_sensor(Sensor::new(1, 0.0, 0.0, 0)).unwrap());
    assert_eq!(noisy, with_sensor(Sensor::new(0, 1e-5, 1e-3, 42)).unwrap());
    assert_ne!(noisy, with_sensor(Sensor::new(0, 1e-5, 1e-3, 43)).unwrap());
}

#[test]
fn a_run_that_ends_early_says_when() {
    let plant = ghost::loaded();
    let options = || RunOptions::new(ghost::PERIOD, Duration::from_secs(1));
    let start = State::at_rest(ghost::start());
    let mut logged = 0;
    let broken = run(
        &plant,
        start,
        options(),
        |t, _| if t < Duration::from_millis(5) { Ok(Vector4::zeros()) } else { Err("brake") },
        |_| logged += 1,
    );
    assert_eq!(broken, Err(RunError::Controller { time: Duration::from_millis(5), error: "brake" }));
    assert_eq!(logged, 5);
    let lost = run(&plant, start, options(), |_, _| Ok::<_, ()>(Vector4::repeat(f64::NAN)), |_| {});
    assert_eq!(lost, Err(RunError::Diverged { time: Duration::from_millis(1), divergence: Divergence::Rate(0) }));
    // A torque that is finite, and a rate that no arm has.
    let torn = run(
        &plant,
        start,
        options(),
        |_, _| Ok::<_, armgen_runtime::control::ControlError>(Vector4::new(0.0, 0.0, 0.0, 1e12)),
        |_| {},
    );
    // The wrist's torque tears at the elbow most: the Coriolis terms do.
    assert_eq!(torn.unwrap_err().to_string(), "diverged at 0.001 s: joint 1 (from 0) passed 1e6 rad/s or m/s");
    let mut none = options();
    none.integrator = Integrator::RungeKutta4 { substeps: 0 };
    assert!(matches!(run(&plant, start, none, |_, _| Ok::<_, ()>(Vector4::zeros()), |_| {}), Err(RunError::Integrator { .. })));
}

/// The work of a simulated period is that of its Runge-Kutta steps, four evaluations of the arm each; an audit costs none.
#[test]
fn a_period_asks_four_times_for_the_acceleration() {
    for (substeps, audit) in [(1, false), (1, true), (10, false)] {
        EVALUATIONS.set(0);
        let plant = Plant::new(&FREE, State::at_rest(vector![0.3]), Integrator::RungeKutta4 { substeps });
        let mut plant = if audit { plant.with_audit() } else { plant };
        for _ in 0..100 {
            plant.advance(&vector![1.0], 1e-3).unwrap();
        }
        assert_eq!(EVALUATIONS.get(), 400 * substeps);
    }
}
