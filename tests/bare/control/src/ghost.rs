//! The path of a ghost cut out of a sheet: 20 s, twelve lines, three arcs, five via points.

use armgen_runtime::{
    nalgebra::Matrix3,
    trajectory::{OperationalTrajectory, OrientationProfile, Path, PlanError, Segment, TimeLaw, Turn},
};
use core::{f32::consts::PI, time::Duration};

pub(crate) type Ghost = OperationalTrajectory<f32, [Segment<f32>; 15], [Turn<f32>; 2]>;

const fn law(milliseconds: u64, acceleration_milliseconds: u64) -> TimeLaw<f32> {
    TimeLaw::Trapezoidal {
        duration: Duration::from_millis(milliseconds),
        acceleration_time: Duration::from_millis(acceleration_milliseconds),
    }
}

/// There once, not wherever it is called.
#[inline(never)]
fn line(to: [f32; 3], milliseconds: u64) -> Segment<f32> {
    Segment::line(to, law(milliseconds, 200))
}

/// Through a via point: it starts while the segment before it slows down.
#[inline(never)]
fn via(to: [f32; 3], milliseconds: u64) -> Segment<f32> {
    line(to, milliseconds).anticipating(Duration::from_millis(200))
}

#[inline(never)]
fn arc(centre: [f32; 3], sweep: f32, to: [f32; 3], milliseconds: u64) -> Segment<f32> {
    Segment::arc_to(centre, [0.0, 0.0, 1.0], sweep, to, law(milliseconds, 200))
}

pub(crate) fn ghost() -> Result<Ghost, PlanError> {
    let segments = [
        line([0.48, -0.18, 0.0], 1000),
        line([0.48, 0.06, 0.0], 1500),
        arc([0.60, 0.06, 0.0], -PI, [0.72, 0.06, 0.0], 3000),
        line([0.72, -0.18, 0.0], 1500),
        line([0.66, -0.12, 0.0], 1000),
        via([0.60, -0.18, 0.0], 1000),
        via([0.54, -0.12, 0.0], 1000),
        via([0.48, -0.18, 0.0], 1000),
        line([0.48, -0.18, 0.10], 1000),
        via([0.555, 0.09, 0.0], 1500),
        arc([0.555, 0.06, 0.0], 2.0 * PI, [0.555, 0.09, 0.0], 2000),
        line([0.555, 0.09, 0.10], 1000),
        via([0.675, 0.06, 0.0], 1500),
        arc([0.645, 0.06, 0.0], 2.0 * PI, [0.675, 0.06, 0.0], 2000),
        line([0.675, 0.06, 0.10], 1000),
    ];
    let z = [0.0, 0.0, 1.0];
    let turns = [Turn::about(z, PI, law(10_000, 1000)), Turn::about(z, -PI / 2.0, law(10_000, 1000))];
    let first = Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);
    Ok(Ghost { path: Path::plan([0.48, -0.18, 0.10], segments)?, orientation: OrientationProfile::plan(first, turns)? })
}
