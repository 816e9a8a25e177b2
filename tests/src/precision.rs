//! Every tolerance of the tests, one line each with its reason.
//!
//! `agreement` compares matrices and vectors: the largest difference over max(1, largest reference entry).

/// Emitted functions and the oracle against the stored reference values: some hundred roundings of 1.1e-16, and head-room.
pub const REFERENCE: f64 = 1e-12;
/// Forward dynamics, as the residual B (ddq - ddq_ref) over max(1, |tau|): free of the condition number of B.
pub const FORWARD_RESIDUAL: f64 = 1e-12;
/// Functions with and without a pass: each is rounded a few hundred times on its own way.
pub const WITHOUT_A_PASS: f64 = 1e-13;
/// Emitted functions against the oracle on random arms up to eight joints, scaled alike.
pub const ORACLE: f64 = 1e-12;
/// Emitted functions in f32 against the oracle in f64. A state rounds by 6e-8, and so does every step. An energy loses most, as a
/// sum of terms larger than itself: 5.7e-5 was found at parameters that no body has. All others are below 5e-6.
pub const SINGLE: f64 = 8e-5;
/// Forward dynamics in f32, the residual (1.1e-6 found).
pub const SINGLE_RESIDUAL: f64 = 5e-6;
/// The derivatives of forward dynamics are taken at computed accelerations. Up to this condition number of B their residuals may
/// be this many times the residuals of forward dynamics (8 found); beyond it, proportionally more.
pub const AT_COMPUTED_ACCELERATIONS: f64 = 10.0;
/// A condition number that costs nothing yet.
pub const WELL_CONDITIONED: f64 = 100.0;
/// Central differences of torques at a step of 1e-5: third derivatives times 1e-10, and some roundings of 1e-16 times tau over the step.
pub const DIFFERENCES: f64 = 1e-6;
/// Parameters at which B is sure to be positive: the nominal ones times a common factor and up to so much apart.
pub const NEAR_NOMINAL: f64 = 1e-4;
/// The check state of the technical project: its numbers are given to 16 digits.
pub const CHECK_STATE: f64 = 1e-12;
/// Two formulations inside the oracle, where one differentiates by dual numbers: exact to rounding.
pub const DUAL: f64 = 1e-12;
/// Pivots below this part of the largest count as zero in a numerical rank: far above rounding, far below excited directions.
pub const RANK: f64 = 1e-8;

/// Largest |a - b| over max(1, largest |b|); infinite where the shapes differ or a value is not finite.
pub fn deviation<'a>(a: impl IntoIterator<Item = &'a f64>, b: impl IntoIterator<Item = &'a f64>) -> f64 {
    let (mut a, mut b) = (a.into_iter(), b.into_iter());
    let (mut difference, mut scale) = (0.0f64, 1.0f64);
    loop {
        match (a.next(), b.next()) {
            (None, None) => return difference / scale,
            (Some(a), Some(b)) if (a - b).is_finite() => {
                difference = difference.max((a - b).abs());
                scale = scale.max(b.abs());
            }
            _ => return f64::INFINITY,
        }
    }
}

/// Asserts that the [`deviation`] of `a` from the reference `b` is at most `tolerance`; `what` names it in the message.
#[track_caller]
pub fn agree<'a>(what: &str, a: impl IntoIterator<Item = &'a f64>, b: impl IntoIterator<Item = &'a f64>, tolerance: f64) -> f64 {
    let found = deviation(a, b);
    assert!(found <= tolerance, "{what}: deviates by {found:e}, allowed {tolerance:e}");
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviation_is_scaled_and_strict() {
        assert_eq!(deviation(&[1.0, 10.0], &[1.5, 10.0]), 0.05);
        assert_eq!(deviation(&[0.0, 0.1], &[0.0, 0.2]), 0.1);
        assert_eq!(deviation(&[1.0], &[1.0, 2.0]), f64::INFINITY);
        assert_eq!(deviation(&[f64::NAN], &[1.0]), f64::INFINITY);
        assert_eq!(deviation(&[1.0], &[f64::INFINITY]), f64::INFINITY);
    }
}
