//! The programs of `examples/`, run: each checks its own output.
#![expect(clippy::duplicate_mod, reason = "each program holds its robot, as a user's own does")]

#[path = "../examples/follow.rs"]
mod follow;
#[path = "../examples/hold.rs"]
mod hold;
#[path = "../examples/period.rs"]
mod period;
#[path = "../examples/reach.rs"]
mod reach;

#[test]
fn a_posture_is_held() {
    hold::main().expect("it runs");
}

#[test]
fn a_trajectory_is_followed() {
    follow::main().expect("it runs");
}

#[test]
fn a_pose_is_reached() {
    reach::main().expect("it runs");
}

#[test]
fn gains_and_period_are_judged() {
    period::main().expect("it runs");
}
