//! What tests/c/laws.c prints, by the runtime alone.

#[allow(dead_code)]
mod robot {
    include!("robot.rs");
    include!("robot_runtime.rs");
}

use armgen_runtime::control::{ControlError, FrictionCompensation, HandGuiding, Impedance, NullSpace, Torque, TorqueLimits, Walls};
use armgen_runtime::nalgebra::{Matrix4, Vector4, Vector6};
use armgen_runtime::reference::{OperationalReference, Pose, State};
use armgen_runtime::task::Task;

fn print(what: &str, answer: i32, values: &[f64; 4]) {
    print!("{what} {answer}");
    values.iter().for_each(|x| print!(" {:016x}", x.to_bits()));
    println!();
}

fn main() {
    let four = |x: f64| [x; 4];
    let walls = Walls::new(four(-1.0), four(0.5), four(0.25), [40.0, 30.0, 20.0, 10.0], [4.0, 3.0, 2.0, 1.0]).unwrap();
    let friction = FrictionCompensation::new(0.75, 0.125).unwrap();
    let limits = TorqueLimits::new(robot::EFFORT_LIMITS).unwrap();
    let task = Task::from_indices(robot::TASK).unwrap();
    let (guiding, stiffness) = ([4.0, 3.0, 2.0, 1.0], [900.0, 800.0, 700.0, 60.0]);
    let mut plain = HandGuiding::new(guiding).unwrap();
    let mut all = plain.with_walls(walls).with_speed_cap(four(0.25), [8.0, 7.0, 6.0, 5.0]).unwrap();
    all = all.with_hold(four(2.0), [50.0, 40.0, 30.0, 20.0], four(1.0)).unwrap();
    all = all.with_friction_compensation(friction).with_torque_limits(limits);
    let spring = Impedance::<f64, 4, 4>::new(task, stiffness, 0.75).unwrap();
    let rest = NullSpace::new(four(1.0), four(2.0), [0.5, 0.5, 0.25, 0.0]).unwrap();
    let full = Impedance::<f64, 4, 4>::new(task, stiffness, 1.0).unwrap().with_damping([80.0, 70.0, 60.0, 50.0]).unwrap();
    let full = full.with_slowest(2.0).unwrap().with_null_space(rest);
    let full = full.with_friction_compensation(friction).with_torque_limits(limits);
    let frame = Matrix4::new(0.0, -1.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.25, 0.0, 0.0, 1.0, 0.125, 0.0, 0.0, 0.0, 1.0);
    let still = OperationalReference::at_rest(Pose::from_frame(&frame));
    let moving = OperationalReference {
        velocity: Vector6::new(0.5, -0.25, 0.125, 0.0, 0.0, 0.5),
        acceleration: Vector6::new(1.0, 0.5, -0.25, 0.0, 0.0, -1.0),
        ..still
    };
    let of = |torque: Result<Torque<f64, 4>, ControlError>| <[f64; 4]>::from(torque.unwrap().tau);
    let sample = |k: i32| State {
        q: Vector4::from_fn(|i, _| f64::from(3 * k - 2 * i as i32 + 4) / 16.0),
        dq: Vector4::from_fn(|i, _| f64::from(5 - 3 * k + i as i32) / 8.0),
    };
    all = all.with_anchor(sample(0).q);
    let anchor = |law: &HandGuiding<f64, 4>| <[f64; 4]>::from(*law.anchor().unwrap());
    let mut tau = [0.0; 4];
    for k in 0..5 {
        let measured = sample(k);
        print("plain", 0, &of(plain.torque(&robot::Nominal, &measured)));
        print("all", 0, &of(all.torque(&robot::Nominal, &measured)));
        print("anchor", 0, &anchor(&all));
        print("spring", 0, &of(spring.torque(&robot::Nominal, &still, &measured)));
        tau = of(full.torque(&robot::Nominal, &moving, &measured));
        print("full", 0, &tau);
        print("over", 0, &of(all.torque(&robot::Nominal, &measured)));
    }
    print("frame", 3, &tau);
    print("measured", 2, &tau);
    print("gains", 1, &anchor(&all));
    print("ratio", 1, &tau);
}
