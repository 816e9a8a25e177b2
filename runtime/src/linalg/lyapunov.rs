//! The Lyapunov equation of n decoupled second-order error systems, in closed form.
//!
//! The error of inverse-dynamics control obeys dxi/dt = H xi with xi = (e, de), H = [[0, I], [-K_P, -K_D]].
//! With diagonal K_P, K_D and P the equation H' Q + Q H = -P falls apart into one 2 x 2 problem a joint:
//!
//! ```text
//! block 11:  -2 k_P q12               = -p1     =>  q12 = p1 / (2 k_P)
//! block 22:   2 q12 - 2 k_D q22       = -p2     =>  q22 = (p2 + 2 q12) / (2 k_D)
//! block 12:   q11 - k_P q22 - k_D q12 = 0       =>  q11 = k_P q22 + k_D q12
//! ```

use super::lit;
use nalgebra::{RealField, SVector};

/// The diagonals of the three blocks of Q = [[Q11, Q12], [Q12, Q22]].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LyapunovBlocks<T, const N: usize> {
    /// Diagonal of Q11, position by position.
    pub q11: SVector<T, N>,
    /// Diagonal of Q12 = Q21, position by velocity.
    pub q12: SVector<T, N>,
    /// Diagonal of Q22, velocity by velocity.
    pub q22: SVector<T, N>,
}

/// Q of H' Q + Q H = -P for diagonal gains (the book, Sect. 8.5.3, eq. 8.76).
///
/// - `k_p`, `k_d`: diagonals of K_P, 1/s^2, and K_D, 1/s; positive.
/// - `p1`, `p2`: diagonals of the position and the velocity block of P; positive, so that Q is positive definite.
///
/// Errors: none; the caller has validated the gains.
pub fn diagonal_lyapunov<T: RealField + Copy, const N: usize>(
    k_p: &SVector<T, N>,
    k_d: &SVector<T, N>,
    p1: &SVector<T, N>,
    p2: &SVector<T, N>,
) -> LyapunovBlocks<T, N> {
    let two = lit::<T>(2.0);
    let q12 = p1.zip_map(k_p, |p, k| p / (two * k));
    let q22 = SVector::from_fn(|i, _| (p2[i] + two * q12[i]) / (two * k_d[i]));
    let q11 = SVector::from_fn(|i, _| k_p[i] * q22[i] + k_d[i] * q12[i]);
    LyapunovBlocks { q11, q12, q22 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    #[test]
    fn the_blocks_solve_the_equation() {
        let (kp, kd) = (Vector2::new(1000.0, 3.0), Vector2::new(10.0, 0.5));
        let (p1, p2) = (Vector2::new(1.0, 5.4e7), Vector2::new(1.0, 1e3));
        let q = diagonal_lyapunov(&kp, &kd, &p1, &p2);
        for i in 0..2 {
            let h = Matrix2::new(0.0, 1.0, -kp[i], -kd[i]);
            let m = Matrix2::new(q.q11[i], q.q12[i], q.q12[i], q.q22[i]);
            let residual: Matrix2<f64> = h.transpose() * m + m * h + Matrix2::new(p1[i], 0.0, 0.0, p2[i]);
            assert!(residual.norm() <= 1e-12 * m.norm() * kp[i].max(1.0), "{residual}");
            assert!(m.cholesky().is_some());
        }
    }
}
