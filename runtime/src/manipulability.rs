//! Manipulability: how well an arm can move, and push, at a posture.
//!
//! Joint rates of unit norm give end-effector velocities in the ellipsoid v' (J J')^-1 v = 1. Joint torques of unit norm balance forces in
//! gamma' (J J') gamma = 1 (the book, Sect. 3.9, eqs. 3.123 and 3.127). With J J' = U diag(sigma^2) U' both have the axes U. The semi-axes
//! are sigma_i for velocities and 1 / sigma_i for forces: where an arm moves fast it pushes weakly. Their common measure is
//!
//! ```text
//! w(q) = sqrt(det(J J')) = prod sigma_i,      dw/dq_i = w tr(J^+ dJ/dq_i)
//! ```
//!
//! The functions take a Jacobian of task rows. Ellipsoids make sense for rows of one unit: take the translational rows, or the
//! angular ones. w of a square Jacobian is |det J|. w describes the given rows only, not a larger task. An arm that maximises the
//! w of a relaxed task may reach a singularity of the full task.

use crate::{
    linalg::{left_singular, lit, LeftSingular, RightInverse},
    robot::Kinematics,
    task::Task,
};
use nalgebra::{RealField, SMatrix, SVector};

/// An ellipsoid about the origin of a space of `K` task rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid<T, const K: usize> {
    /// Semi-axes, in the order of the singular values of J, largest first: velocity semi-axes fall, force semi-axes rise.
    pub semi_axes: SVector<T, K>,
    /// Unit vectors along the axes in the columns, in the order of `semi_axes`, in the frame of the rows; their signs are free.
    pub directions: SMatrix<T, K, K>,
}

/// Manipulability w = sqrt(det(J J')); zero where J has lost a row, and where it has more rows than columns.
pub fn manipulability<T: RealField + Copy, const M: usize, const N: usize>(j: &SMatrix<T, M, N>) -> T {
    RightInverse::new(j).map_or_else(T::zero, |inverse| inverse.volume())
}

/// Gradient dw/dq of the manipulability of the task's rows at `q`; per rad or m.
///
/// dJ/dq_i is the derivative of J along the i-th unit vector of joint rates, which the robot gives exactly.
/// `None` at a singular posture, where w = 0 has no gradient.
pub fn manipulability_gradient<R: Kinematics<N>, const N: usize, const K: usize>(
    robot: &R,
    task: &Task<K>,
    q: &SVector<R::Real, N>,
) -> Option<SVector<R::Real, N>> {
    let inverse = RightInverse::new(&task.jacobian(&robot.geometric_jacobian(q)))?;
    let (w, pseudo_inverse) = (inverse.volume(), inverse.matrix());
    let mut gradient = SVector::zeros();
    for i in 0..N {
        let mut along = SVector::zeros();
        along[i] = nalgebra::one();
        let dj = task.jacobian(&robot.geometric_jacobian_dot(q, &along));
        // tr(J^+ dJ), element by element: J^+ is N x K, dJ is K x N.
        gradient[i] = w * pseudo_inverse.transpose().dot(&dj);
    }
    Some(gradient)
}

/// Velocity ellipsoid v' (J J')^-1 v = 1: semi-axes sigma_i.
pub fn velocity_ellipsoid<T: RealField + Copy, const K: usize, const N: usize>(j: &SMatrix<T, K, N>) -> Ellipsoid<T, K> {
    let LeftSingular { sigma, u } = left_singular(j);
    Ellipsoid { semi_axes: sigma, directions: u }
}

/// Force ellipsoid gamma' (J J') gamma = 1: semi-axes 1 / sigma_i.
///
/// `None` at a singular posture, where the structure bears any force along the lost direction: where the smallest sigma is at most 64
/// roundings of the largest.
pub fn force_ellipsoid<T: RealField + Copy, const K: usize, const N: usize>(j: &SMatrix<T, K, N>) -> Option<Ellipsoid<T, K>> {
    let LeftSingular { sigma, u } = left_singular(j);
    let semi_axes = sigma.map(|s| T::one() / s);
    let regular = keeps_rank(&sigma) && semi_axes.iter().all(|x| x.is_finite());
    regular.then_some(Ellipsoid { semi_axes, directions: u })
}

/// Condition number sigma_1 / sigma_K, at least 1; `None` at a singular posture: where sigma_K is at most 64 roundings of sigma_1.
pub fn condition_number<T: RealField + Copy, const K: usize, const N: usize>(j: &SMatrix<T, K, N>) -> Option<T> {
    const { assert!(K > 0, "a Jacobian has rows") };
    let sigma = left_singular(j).sigma;
    let condition = sigma[0] / sigma[K - 1];
    (keeps_rank(&sigma) && condition.is_finite()).then_some(condition)
}

/// Whether the smallest singular value is more than rounding of the largest: below that it has no digit right.
fn keeps_rank<T: RealField + Copy, const K: usize>(sigma: &SVector<T, K>) -> bool {
    let (largest, smallest) = (sigma.iter().next(), sigma.iter().last());
    largest.zip(smallest).is_some_and(|(largest, smallest)| *smallest > *largest * T::default_epsilon() * lit(64.0))
}

/// Distance to singularity: the smallest singular value, the norm of the smallest change of J that makes it lose a row.
pub fn distance_to_singularity<T: RealField + Copy, const K: usize, const N: usize>(j: &SMatrix<T, K, N>) -> T {
    const { assert!(K > 0, "a Jacobian has rows") };
    left_singular(j).sigma[K - 1]
}
