//! All postures of the SCARA and of the Puma 560, each at poses of its own: the same bits on every machine.

use crate::scara_fast;
use core::fmt;

#[allow(missing_docs)]
pub mod scara_ik {
    //! All postures of the SCARA.
    include!(concat!(env!("OUT_DIR"), "/scara_ik.rs"));
}

#[allow(clippy::excessive_precision, unreachable_pub)]
mod puma560 {
    include!(concat!(env!("OUT_DIR"), "/puma560.rs"));
}

#[allow(missing_docs)]
pub mod puma560_ik {
    //! All postures of the Puma 560.
    include!(concat!(env!("OUT_DIR"), "/puma560_ik.rs"));
}

/// Poses of each arm.
pub const POSES: u32 = 16;

/// Joint variables of a requested pose: between -2.5 and 2.5, no two joints alike.
fn joints<const N: usize>(pose: u32) -> [f32; N] {
    core::array::from_fn(|i| ((pose * 7 + i as u32 * 5 + 3) % 11) as f32 * 0.5 - 2.5)
}

/// A pose of the SCARA.
pub fn scara_pose(pose: u32) -> [[f32; 4]; 4] {
    scara_fast::direct_kinematics(&joints(pose))
}

/// A pose of the Puma.
pub fn puma560_pose(pose: u32) -> [[f32; 4]; 4] {
    puma560::direct_kinematics(&joints(pose))
}

/// All postures of the SCARA at a pose.
#[inline(never)]
pub fn scara_inverse_kinematics(t: &[[f32; 4]; 4]) -> scara_ik::Solutions {
    scara_ik::inverse_kinematics(t)
}

/// All postures of the Puma at a pose.
#[inline(never)]
pub fn puma560_inverse_kinematics(t: &[[f32; 4]; 4]) -> puma560_ik::Solutions {
    puma560_ik::inverse_kinematics(t)
}

/// A posture as it is printed on both machines: the bits.
#[derive(Clone, Copy, Debug)]
pub struct PostureLine<'a> {
    /// Its robot.
    pub robot: &'static str,
    /// The number of the pose.
    pub pose: u32,
    /// Its branch.
    pub branch: u16,
    /// Its joint variables.
    pub q: &'a [f32],
}

impl fmt::Display for PostureLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "posture {} {} {}", self.robot, self.pose, self.branch)?;
        self.q.iter().try_for_each(|q| write!(f, " {:08x}", q.to_bits()))
    }
}

/// Hands the lines of all postures at the poses of a number to `visit`, as long as it succeeds.
///
/// # Errors
/// That of `visit`.
pub fn each_line(pose: u32, visit: &mut dyn FnMut(&PostureLine<'_>) -> fmt::Result) -> fmt::Result {
    for solution in scara_inverse_kinematics(&scara_pose(pose)).as_slice() {
        visit(&PostureLine { robot: "scara", pose, branch: solution.branch, q: &solution.q })?;
    }
    for solution in puma560_inverse_kinematics(&puma560_pose(pose)).as_slice() {
        visit(&PostureLine { robot: "puma560", pose, branch: solution.branch, q: &solution.q })?;
    }
    Ok(())
}
