//! The path of a ghost cut out of a sheet: 20 s, twelve lines, three arcs, five via points.

use super::scara::Scara;
use armgen_runtime::{
    clik::{Integration, JointLimits, SecondOrder},
    reference::{JointReference, Pose, State},
    task::{Row, Task},
    trajectory::{OperationalTrajectory, OrientationProfile, Path, Reach, Segment, TimeLaw, Turn},
};
use nalgebra::{convert, matrix, vector, Matrix3, RealField, Vector4};
use std::{f64::consts::PI, time::Duration};

pub const PERIOD: Duration = Duration::from_millis(1);
pub const CUT: Duration = Duration::from_secs(20);
/// The path and two seconds of hold after it.
pub const WITH_HOLD: Duration = Duration::from_secs(22);

pub type Ghost<T> = OperationalTrajectory<T, [Segment<T>; 15], [Turn<T>; 2]>;

pub fn task() -> Task<4> {
    Task::new([Row::X, Row::Y, Row::Z, Row::Rz]).unwrap()
}

/// Orientation at phi = 0.
pub fn reference_frame<T: RealField + Copy>() -> Matrix3<T> {
    let (o, i) = (T::zero(), T::one());
    matrix![o, i, o; i, o, o; o, o, -i]
}

/// phi of a pose, in (-pi, pi].
pub fn phi<T: RealField + Copy>(pose: &Pose<T>) -> T {
    pose.rotation[(1, 1)].atan2(pose.rotation[(0, 1)])
}

pub fn start() -> Vector4<f64> {
    vector![-1.3913099976180494, 2.0650786546949544, 0.4, 0.673768657076905]
}

pub fn law<T: RealField>(duration: f64, acceleration_time: f64) -> TimeLaw<T> {
    let seconds = Duration::from_secs_f64;
    TimeLaw::Trapezoidal { duration: seconds(duration), acceleration_time: seconds(acceleration_time) }
}

pub fn reach() -> Reach<f64> {
    Reach::about_axis([0.0; 3], [0.0, 0.0, 1.0], 0.0, 1.0).unwrap()
}

fn point<T: RealField + Copy>(p: [f64; 3]) -> [T; 3] {
    p.map(convert)
}

pub fn segments<T: RealField + Copy>() -> [Segment<T>; 15] {
    let line = |to: [f64; 3], seconds: f64| Segment::line(point(to), law(seconds, 0.2));
    let arc = |centre: [f64; 3], sweep: f64, to: [f64; 3], seconds: f64| {
        Segment::arc_to(point(centre), point([0.0, 0.0, 1.0]), convert(sweep), point(to), law(seconds, 0.2))
    };
    let early = Duration::from_millis(200);
    [
        line([0.48, -0.18, 0.0], 1.0),
        line([0.48, 0.06, 0.0], 1.5),
        arc([0.60, 0.06, 0.0], -PI, [0.72, 0.06, 0.0], 3.0),
        line([0.72, -0.18, 0.0], 1.5),
        line([0.66, -0.12, 0.0], 1.0),
        line([0.60, -0.18, 0.0], 1.0).anticipating(early),
        line([0.54, -0.12, 0.0], 1.0).anticipating(early),
        line([0.48, -0.18, 0.0], 1.0).anticipating(early),
        line([0.48, -0.18, 0.10], 1.0),
        line([0.555, 0.09, 0.0], 1.5).anticipating(early),
        arc([0.555, 0.06, 0.0], 2.0 * PI, [0.555, 0.09, 0.0], 2.0),
        line([0.555, 0.09, 0.10], 1.0),
        line([0.675, 0.06, 0.0], 1.5).anticipating(early),
        arc([0.645, 0.06, 0.0], 2.0 * PI, [0.675, 0.06, 0.0], 2.0),
        line([0.675, 0.06, 0.10], 1.0),
    ]
}

pub fn ghost<T: RealField + Copy>() -> Ghost<T> {
    let path = Path::plan(point([0.48, -0.18, 0.10]), segments()).unwrap();
    let z = point([0.0, 0.0, 1.0]);
    let turns = [Turn::about(z, convert(PI), law(10.0, 1.0)), Turn::about(z, convert(-PI / 2.0), law(10.0, 1.0))];
    OperationalTrajectory { path, orientation: OrientationProfile::plan(reference_frame(), turns).unwrap() }
}

pub fn nominal() -> Scara<f64> {
    Scara::nominal()
}

pub fn loaded() -> Scara<f64> {
    Scara::loaded()
}

/// The joint reference along the path and the hold, sample by sample: second-order CLIK, consistent with the hold.
pub fn joint_reference() -> Vec<JointReference<f64, 4>> {
    let (robot, trajectory) = (nominal(), ghost::<f64>());
    let clik = second_order(Integration::HoldConsistent);
    let mut state = State::at_rest(start());
    (0..=22_000)
        .map(|k| {
            let step = clik.step(&robot, &state, &trajectory.sample(PERIOD * k)).unwrap();
            state = step.next;
            step.reference
        })
        .collect()
}

pub fn second_order(integration: Integration) -> SecondOrder<f64, 4, 4> {
    let limits = JointLimits::rates([50.0; 4]).unwrap();
    let (k_p, k_d) = ([1000.0, 1000.0, 2000.0, 1.0], [10.0, 10.0, 50.0, 1.0]);
    SecondOrder::new(task(), k_p, k_d, 1e-3, integration, limits, [1e-3; 4]).unwrap()
}

/// 81 postures along the path, every 250 ms.
pub fn postures() -> Vec<Vector4<f64>> {
    joint_reference().iter().take(20_001).step_by(250).map(|r| r.q).collect()
}
