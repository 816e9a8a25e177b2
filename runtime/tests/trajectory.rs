//! The ghost as planned: its path against a table, closed forms of its extremes, and requests that cannot be met.

use crate::common;

use armgen_runtime::{
    orientation::rotation,
    robot::Kinematics,
    trajectory::{OrientationProfile, Path, PlanFault, Reach, Segment, TimeLaw, Turn},
};
use common::{close, ghost};
use nalgebra::vector;
use std::{f64::consts::PI, time::Duration};

fn ms(k: u64) -> Duration {
    Duration::from_millis(k)
}

/// x, y, z, phi, their velocities and accelerations; phi in (-pi, pi].
fn row(trajectory: &ghost::Ghost<f64>, k: u64) -> [f64; 12] {
    let s = trajectory.sample(ms(k));
    let (p, v, a) = (s.pose.position, s.velocity, s.acceleration);
    assert!(v[3] == 0.0 && v[4] == 0.0 && a[3] == 0.0 && a[4] == 0.0);
    [p.x, p.y, p.z, ghost::phi(&s.pose), v[0], v[1], v[2], v[5], a[0], a[1], a[2], a[5]]
}

#[test]
fn the_reference_table() {
    let text = include_str!("data/ghost_reference_100ms.csv");
    let trajectory = ghost::ghost::<f64>();
    assert_eq!(trajectory.duration(), ghost::CUT);
    let mut rows = 0;
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let expected: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let k = (expected[0] * 1000.0).round() as u64;
        let found = row(&trajectory, k);
        for (i, (found, expected)) in found.iter().zip(&expected[1..]).enumerate() {
            let mut d = found - expected;
            if i == 3 {
                d = (d + PI).rem_euclid(2.0 * PI) - PI;
            }
            // The table has twelve digits, of values below 10.
            assert!(d.abs() < 6e-12, "column {i} at {k} ms: {found} {expected}");
        }
        rows += 1;
    }
    assert_eq!(rows, 201);
}

#[test]
fn reach_speed_and_acceleration() {
    let trajectory = ghost::ghost::<f64>();
    let (mut reach, mut speed, mut acceleration, mut step) = ((f64::MAX, 0.0f64), 0.0f64, 0.0f64, 0.0f64);
    let mut earlier = trajectory.sample(ms(0));
    for k in 0..=20_000 {
        let s = trajectory.sample(ms(k));
        let r = s.pose.position.xy().norm();
        reach = (reach.0.min(r), reach.1.max(r));
        speed = speed.max(s.velocity.fixed_rows::<3>(0).norm());
        acceleration = acceleration.max(s.acceleration.fixed_rows::<3>(0).norm());
        step = step.max((s.velocity - earlier.velocity).fixed_rows::<3>(0).amax());
        earlier = s;
    }
    // The nearest point of the line x = 0.48 is at y = 0; the farthest point of the whole path is the corner (0.72, -0.18).
    close("least reach", reach.0, 0.48, 1e-6);
    close("greatest reach", reach.1, 0.72f64.hypot(0.18), 1e-12);
    // Lines of a length L cruise at L / (T - t_c); the fastest is segment 10, by (0.075, 0.27, -0.1) in 1.5 s.
    let d10 = vector![0.075, 0.27, -0.1];
    close("peak speed", speed, d10.norm() / 1.3, 1e-12);
    // They accelerate by L / (t_c (T - t_c)); segment 10 does while segment 9, up by 0.1 in 1 s, brakes.
    let together = d10 / (0.2 * 1.3) - vector![0.0, 0.0, 0.1] / (0.2 * 0.8);
    close("peak acceleration", acceleration, together.norm(), 1e-12);
    close("velocity step per sample", step, together.amax() * 1e-3, 1e-12);
    assert_eq!(trajectory.check_reach(&ghost::reach(), ms(1)), Ok(()));
    // The determinant of the Jacobian is sin(theta2) / 4; from the law of cosines cos(theta2) = 2 r^2 - 1 with links of 0.5 m.
    let det = |r: f64| (1.0 - (2.0 * r * r - 1.0).powi(2)).sqrt() / 4.0;
    let all: Vec<f64> = (0..=20_000).map(|k| det(trajectory.sample(ms(k)).pose.position.xy().norm())).collect();
    close("least det J", all.iter().copied().fold(1.0, f64::min), det(0.48), 1e-5);
    close("greatest det J", all.iter().copied().fold(0.0, f64::max), 0.25, 1e-6);
}

#[test]
fn stops_and_via_points() {
    let trajectory = ghost::ghost::<f64>();
    let segments = trajectory.path.segments();
    let mut missed = Vec::new();
    for (i, segment) in segments.iter().enumerate() {
        let via = segments.get(i + 1).is_some_and(|next| next.start() < segment.end());
        if via {
            let blend = (segments[i + 1].start().as_millis() as u64)..=(segment.end().as_millis() as u64);
            let nearest = blend.map(|k| (trajectory.sample(ms(k)).pose.position - segment.to()).norm()).fold(f64::MAX, f64::min);
            missed.push((i + 1, nearest));
        } else {
            let s = trajectory.sample(segment.end());
            assert!((s.pose.position - segment.to()).norm() < 1e-12, "stop after segment {}", i + 1);
            assert!(s.velocity.fixed_rows::<3>(0).norm() == 0.0);
        }
    }
    assert_eq!(missed.iter().map(|(i, _)| *i).collect::<Vec<_>>(), [5, 6, 7, 9, 12]);
    // At the time u into the blend of duration t_c, the first segment has (t_c - u)^2 / (2 t_c (T - t_c)) of its way left. The
    // next segment has gone u^2 / (2 t_c (T - t_c)) of its own.
    for (i, nearest) in missed {
        let part = |segment: &Segment<f64>, u: f64| {
            let (way, seconds) = (segment.to() - segment.from(), (segment.end() - segment.start()).as_secs_f64());
            way * (u * u / (2.0 * 0.2 * (seconds - 0.2)))
        };
        let off = |k: u32| {
            let u = f64::from(k) * 1e-3;
            (part(&segments[i], u) - part(&segments[i - 1], 0.2 - u)).norm()
        };
        close(&format!("via point {i} missed by"), nearest, (0..=200).map(off).fold(f64::MAX, f64::min), 1e-12);
    }
}

/// Numbers of the technical project, as the table (data/README.md).
#[test]
fn spot_values() {
    let trajectory = ghost::ghost::<f64>();
    for (k, expected) in [
        (4000, [0.6, 0.18, 0.0, 1.221730476]),
        (7900, [0.66, -0.12375, 0.0, 2.583087293]),
        (11300, [0.481442308, -0.174807692, 0.094951923, 3.001966313]),
        (13700, [0.555, 0.03, 0.0, 2.583087293]),
        (15600, [0.557307692, 0.089423077, 0.094951923, 2.251474735]),
        (20000, [0.675, 0.06, 0.1, PI / 2.0]),
    ] {
        let found = row(&trajectory, k);
        for i in 0..4 {
            close(&format!("{k} ms, {i}"), found[i], expected[i], 6e-10);
        }
    }
    // Hold: nothing moves.
    let end = row(&trajectory, 20_000);
    assert!(end[4..].iter().all(|x| *x == 0.0));
    assert_eq!(row(&trajectory, 21_234), end);
}

#[test]
fn the_acceleration_at_a_corner_is_that_of_the_phase_that_begins() {
    let trajectory = ghost::ghost::<f64>();
    let az = |k| row(&trajectory, k)[10];
    // Segment 1, down by 0.1 m in 1 s with t_c = 0.2 s: |a| = 0.1 / (0.8 * 0.2).
    for (k, expected) in [(0, -0.625), (199, -0.625), (200, 0.0), (799, 0.0), (800, 0.625), (999, 0.625), (1000, 0.0)] {
        close(&format!("a_z at {k} ms"), az(k), expected, 1e-15);
    }
}

#[test]
fn starts_at_the_stated_joints() {
    let scara = ghost::nominal();
    let pose = armgen_runtime::reference::Pose::of(&scara, &ghost::start());
    let first = ghost::ghost().sample(ms(0)).pose;
    assert!(ghost::task().error(&first, &pose).norm() < 1e-15);
    assert!(scara.geometric_jacobian(&ghost::start()).iter().all(|x| x.is_finite()));
}

#[test]
fn single_precision_follows() {
    let (single, double) = (ghost::ghost::<f32>(), ghost::ghost::<f64>());
    for k in (0..=20_000).step_by(7) {
        let (a, b) = (single.sample(ms(k)), double.sample(ms(k)));
        assert!((a.pose.position.cast::<f64>() - b.pose.position).norm() < 3e-7, "{k}");
        assert!((a.acceleration.cast::<f64>() - b.acceleration).norm() < 3e-6, "{k}");
    }
}

#[test]
fn arcs_in_space_through_three_points() {
    let law = TimeLaw::Quintic { duration: ms(1000) };
    // A quarter of a circle of radius 2 about (1, 0, 0) in the plane x = 1, from (1, 2, 0) over 45 degrees to (1, 0, 2).
    let r = 2f64.sqrt();
    let path = Path::plan([1.0, 2.0, 0.0], [Segment::arc_through([1.0, r, r], [1.0, 0.0, 2.0], law)]).unwrap();
    close("length", path.segments()[0].length(), PI, 1e-14);
    for k in 0..=100 {
        let s = path.sample(ms(10 * k));
        assert!(
            ((s.position - nalgebra::Vector3::x()).norm() - 2.0).abs() < 1e-14
                && s.position.y >= -1e-14
                && s.position.z >= -1e-14
        );
    }
    // The long way round, by a via point on the other side.
    let path = Path::plan([1.0, 2.0, 0.0], [Segment::arc_through([1.0, 0.0, -2.0], [1.0, 0.0, 2.0], law)]).unwrap();
    close("length", path.segments()[0].length(), 3.0 * PI, 1e-13);
    // Velocity and acceleration are derivatives.
    for k in [100, 333, 700] {
        let (a, b, c) = (path.sample(ms(k) - ms(1) / 100), path.sample(ms(k)), path.sample(ms(k) + ms(1) / 100));
        assert!(((c.position - a.position) / 2e-5 - b.velocity).norm() < 1e-5);
        assert!(((c.velocity - a.velocity) / 2e-5 - b.acceleration).norm() < 1e-4);
    }
}

/// In single precision s rounds to 1 some time before the end: the arm still brakes there.
#[test]
fn an_arc_moves_to_its_end() {
    fn quarter<T: nalgebra::RealField + Copy>() -> Path<T, [Segment<T>; 1]> {
        let number = |x: f64| nalgebra::convert::<f64, T>(x);
        let law = TimeLaw::Quintic { duration: ms(10_000) };
        let (centre, axis) = ([0.0; 3].map(number), [0.0, 0.0, 1.0].map(number));
        Path::plan([1.0, 0.0, 0.0].map(number), [Segment::arc(centre, axis, number(1.5), law)]).unwrap()
    }
    let (single, double) = (quarter::<f32>(), quarter::<f64>());
    let last = |k: u64| ms(10_000 - k);
    assert_eq!(single.sample(last(1)).position, single.segments()[0].to());
    for k in 1..100 {
        let (found, exact) = (single.sample(last(k)), double.sample(last(k)));
        let close = |found: nalgebra::Vector3<f32>, exact: nalgebra::Vector3<f64>| {
            (found.cast::<f64>() - exact).norm() < 1e-5 * exact.norm()
        };
        assert!(close(found.velocity, exact.velocity), "{k} ms before the end: {} {}", found.velocity, exact.velocity);
        assert!(close(found.acceleration, exact.acceleration), "{k} ms before the end");
    }
}

#[test]
fn an_axis_of_any_length_has_a_direction() {
    let law = TimeLaw::Quintic { duration: ms(1000) };
    for length in [1e-40, 1e-23, 3e19, 3e38f32] {
        let path = Path::plan([1.0f32, 0.0, 0.0], [Segment::arc([0.0; 3], [0.0, 0.0, length], 1.0, law)]).unwrap();
        assert!((path.segments()[0].to() - vector![1f32.cos(), 1f32.sin(), 0.0]).norm() < 1e-6, "{length}");
        let turn = OrientationProfile::plan(nalgebra::Matrix3::identity(), [Turn::about([0.0, length, 0.0], 1.0, law)]).unwrap();
        let turned = turn.sample(ms(2000)).rotation;
        assert!((turned - rotation(&nalgebra::Vector3::y_axis(), 1.0)).norm() < 1e-6, "{length}");
        let reach = Reach::about_axis([0.0f32; 3], [length, 0.0, 0.0], 0.0, 1.0).unwrap();
        assert_eq!(reach.distance(&vector![5.0, 3.0, 4.0]), 5.0);
    }
    for nowhere in [[0.0f32; 3], [f32::NAN, 1.0, 0.0], [0.0, f32::INFINITY, 0.0]] {
        assert!(Reach::about_axis([0.0; 3], nowhere, 0.0, 1.0).is_none());
    }
}

#[track_caller]
fn refuse(number: usize, replacement: Segment<f64>, fault: PlanFault) {
    let mut segments = ghost::segments::<f64>();
    segments[number - 1] = replacement;
    let error = Path::plan([0.48, -0.18, 0.10], segments).unwrap_err();
    assert_eq!((error.segment, error.fault), (number, fault));
}

#[test]
fn what_cannot_be_names_its_segment() {
    let z = [0.0, 0.0, 1.0];
    let law = ghost::law(3.0, 0.2);
    let to = [0.72, 0.06, 0.0];
    refuse(2, Segment::line([0.48, 0.06, 0.0], ghost::law(1.5, 0.8)), PlanFault::CruiseTimeNegative);
    refuse(3, Segment::arc_to([0.61, 0.06, 0.0], z, -PI, to, law), PlanFault::ArcEndMismatch);
    refuse(3, Segment::arc_to([0.60, 0.06, 0.0], z, -3.0, to, law), PlanFault::ArcEndMismatch);
    refuse(3, Segment::arc_to([0.60, 0.06, 0.1], z, -PI, to, law), PlanFault::ArcOffPlane);
    refuse(3, Segment::arc([0.48, 0.06, 0.0], z, -PI, law), PlanFault::ArcRadiusZero);
    refuse(3, Segment::arc([0.60, 0.06, 0.0], [0.0; 3], -PI, law), PlanFault::AxisZero);
    refuse(3, Segment::arc([0.60, 0.06, 0.0], z, f64::NAN, law), PlanFault::NotFinite);
    refuse(3, Segment::arc_through([0.60, 0.06, 0.0], to, law), PlanFault::ArcPointsCollinear);
    refuse(1, Segment::line([0.48, -0.18, 0.0], law).anticipating(ms(1)), PlanFault::NothingToAnticipate);
    refuse(7, Segment::line([0.54, -0.12, 0.0], law).anticipating(ms(801)), PlanFault::AnticipationTooLong);
    refuse(7, Segment::line([0.54, f64::INFINITY, 0.0], law), PlanFault::NotFinite);
}

#[test]
fn a_point_out_of_reach_names_its_segment() {
    let mut segments = ghost::segments::<f64>();
    segments[9] = Segment::line([0.955, 0.39, 0.0], ghost::law(1.5, 0.2)).anticipating(ms(200));
    segments[10] = Segment::pause(ms(10));
    let path = Path::plan([0.48, -0.18, 0.10], segments).unwrap();
    let error = path.check_reach(&ghost::reach(), ms(1)).unwrap_err();
    assert_eq!((error.segment, error.fault), (10, PlanFault::OutOfReach));
    let sphere = Reach::about_point([0.0; 3], 0.49, 1.0);
    assert_eq!(path.check_reach(&sphere, ms(1)).unwrap_err().segment, 2);
}
