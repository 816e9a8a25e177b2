//! Orientation profiles: turns about axes fixed in the base frame, one after another.
//!
//! Turn k starts at R_k: R(t) = Rot(r_k, theta_k s(t)) R_k. So omega = theta_k ds r_k and its derivative theta_k dds r_k (the
//! book, Sect. 4.3.3, with the axis in the base frame).

use super::{
    chain::{last_started, next_slot, span, Slot},
    law::{Profile, TimeLaw},
    PlanError, PlanFault,
};
use crate::{
    linalg::{direction, is_finite, lit},
    orientation::{rotation, rotation_vector},
};
use core::{marker::PhantomData, time::Duration};
use nalgebra::{Matrix3, RealField, Unit, Vector3};

/// One turn of an orientation profile; it starts where the one before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<T> {
    goal: Goal<T>,
    law: TimeLaw<T>,
    slot: Slot,
    profile: Profile<T>,
    from: Matrix3<T>,
    /// Unit vector.
    axis: Vector3<T>,
    angle: T,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Goal<T> {
    About { axis: Vector3<T>, angle: T },
    Toward(Matrix3<T>),
    Pause,
}

/// Orientation, angular velocity and acceleration in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientationSample<T> {
    /// Rotation matrix R.
    pub rotation: Matrix3<T>,
    /// Angular velocity omega, rad/s.
    pub velocity: Vector3<T>,
    /// Angular acceleration, rad/s^2.
    pub acceleration: Vector3<T>,
}

impl<T: RealField + Copy> Turn<T> {
    fn new(goal: Goal<T>, law: TimeLaw<T>) -> Self {
        Self {
            goal,
            law,
            slot: Slot::default(),
            profile: Profile::rest(Duration::ZERO),
            from: Matrix3::identity(),
            axis: Vector3::z(),
            angle: T::zero(),
        }
    }

    /// A turn by `angle`, rad, of any size, about `axis`, of any length, in the base frame.
    pub fn about(axis: [T; 3], angle: T, law: TimeLaw<T>) -> Self {
        Self::new(Goal::About { axis: axis.into(), angle }, law)
    }

    /// The shortest turn to this rotation matrix.
    pub fn toward(rotation: Matrix3<T>, law: TimeLaw<T>) -> Self {
        Self::new(Goal::Toward(rotation), law)
    }

    /// An orientation held for a while.
    pub fn pause(duration: Duration) -> Self {
        Self::new(Goal::Pause, TimeLaw::Cubic { duration })
    }

    /// When it starts, in a planned profile.
    pub fn start(&self) -> Duration {
        self.slot.start
    }

    /// When it ends, in a planned profile.
    pub fn end(&self) -> Duration {
        self.slot.end
    }

    fn plan(&mut self, from: Matrix3<T>, earlier: Option<Slot>) -> Result<Matrix3<T>, PlanFault> {
        let (axis, angle) = match self.goal {
            Goal::About { axis, angle } if is_finite(&axis) && angle.is_finite() => {
                (direction(&axis).ok_or(PlanFault::AxisZero)?, angle)
            }
            Goal::About { .. } => return Err(PlanFault::NotFinite),
            Goal::Toward(to) => {
                check_rotation(&to)?;
                let turn = rotation_vector(&(to * from.transpose()));
                match Unit::try_new_and_get(turn, T::zero()) {
                    Some((axis, angle)) => (axis, angle),
                    None => (Vector3::z_axis(), T::zero()),
                }
            }
            Goal::Pause => (Vector3::z_axis(), T::zero()),
        };
        self.profile = match (self.goal, self.law) {
            (Goal::Pause, TimeLaw::Cubic { duration }) => Profile::rest(duration),
            _ => self.law.resolve(angle)?,
        };
        self.slot = next_slot(earlier, None, Duration::ZERO, self.profile.duration())?;
        (self.from, self.axis, self.angle) = (from, axis.into_inner(), angle);
        Ok(match self.goal {
            Goal::Toward(to) => to,
            _ => rotation(&axis, angle) * from,
        })
    }
}

/// Whether R' R = I and det R = 1, to a millionth.
fn check_rotation<T: RealField + Copy>(r: &Matrix3<T>) -> Result<(), PlanFault> {
    let close = lit::<T>(1e-6).max(T::default_epsilon() * lit(64.0));
    let orthogonal = (r.tr_mul(r) - Matrix3::identity()).norm() <= close;
    let right_handed = r.column(0).cross(&r.column(1)).dot(&r.column(2)) > T::zero();
    if orthogonal && right_handed {
        Ok(())
    } else {
        Err(PlanFault::NotARotation)
    }
}

/// A planned orientation profile; `S` reads as a slice of turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientationProfile<T, S> {
    start: Matrix3<T>,
    turns: S,
    scalar: PhantomData<T>,
}

impl<T: RealField + Copy, S: AsRef<[Turn<T>]> + AsMut<[Turn<T>]>> OrientationProfile<T, S> {
    /// Plans the turns one after another from the rotation matrix `start`.
    ///
    /// # Errors
    /// With the number of the first turn that cannot be; 0 where `start` is not a rotation matrix.
    pub fn plan(start: Matrix3<T>, mut turns: S) -> Result<Self, PlanError> {
        check_rotation(&start).map_err(|fault| PlanError { segment: 0, fault })?;
        let (mut from, mut earlier) = (start, None);
        for (i, turn) in turns.as_mut().iter_mut().enumerate() {
            from = turn.plan(from, earlier).map_err(|fault| fault.at(i))?;
            earlier = Some(turn.slot);
        }
        Ok(Self { start, turns, scalar: PhantomData })
    }
}

impl<T: RealField + Copy, S: AsRef<[Turn<T>]>> OrientationProfile<T, S> {
    /// The turns, planned.
    pub fn turns(&self) -> &[Turn<T>] {
        self.turns.as_ref()
    }

    /// When the last turn ends.
    pub fn duration(&self) -> Duration {
        self.turns().last().map_or(Duration::ZERO, |turn| turn.slot.end)
    }

    /// Orientation, angular velocity and acceleration at `t`; at rest at the end afterwards.
    pub fn sample(&self, t: Duration) -> OrientationSample<T> {
        let Some(turn) = self.turns().get(last_started(self.turns(), |turn| turn.slot, t)) else {
            return OrientationSample { rotation: self.start, velocity: Vector3::zeros(), acceleration: Vector3::zeros() };
        };
        let p = turn.profile.at(span(turn.slot.start, t).unwrap_or_default());
        let axis = turn.axis;
        OrientationSample {
            rotation: rotation(&Unit::new_unchecked(axis), turn.angle * p.s) * turn.from,
            velocity: axis * (turn.angle * p.ds),
            acceleration: axis * (turn.angle * p.dds),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: TimeLaw<f64> = TimeLaw::Quintic { duration: Duration::from_secs(1) };

    #[test]
    fn turns_follow_one_another() {
        let to = rotation(&Unit::new_normalize(Vector3::new(1.0, 1.0, 0.0)), 0.8);
        let start = rotation(&Vector3::x_axis(), 0.3);
        let turns = [Turn::about([0.0, 0.0, 2.0], 7.0, LAW), Turn::pause(Duration::from_secs(1)), Turn::toward(to, LAW)];
        let profile = OrientationProfile::plan(start, turns).unwrap();
        assert_eq!(profile.duration(), Duration::from_secs(3));
        let second = rotation(&Vector3::z_axis(), 7.0) * start;
        assert!((profile.sample(Duration::from_secs(1)).rotation - second).norm() < 1e-15);
        assert!((profile.sample(Duration::from_millis(1999)).rotation - second).norm() < 1e-14);
        assert!((profile.sample(Duration::from_secs(3)).rotation - to).norm() < 1e-14);
        let h = 1e-5;
        for ms in [100, 555, 2300, 2800] {
            let t = Duration::from_millis(ms);
            let dt = Duration::from_micros(10);
            let (a, b, c) = (profile.sample(t - dt), profile.sample(t), profile.sample(t + dt));
            let omega = rotation_vector(&(c.rotation * a.rotation.transpose())) / (2.0 * h);
            assert!((omega - b.velocity).norm() < 1e-7);
            assert!(((c.velocity - a.velocity) / (2.0 * h) - b.acceleration).norm() < 1e-6);
        }
    }

    #[test]
    fn what_is_not_a_rotation_is_refused() {
        let fault = |turn| OrientationProfile::plan(Matrix3::identity(), [Turn::pause(Duration::ZERO), turn]).unwrap_err();
        assert_eq!(fault(Turn::toward(Matrix3::identity() * 1.1, LAW)), PlanFault::NotARotation.at(1));
        assert_eq!(fault(Turn::toward(-Matrix3::<f64>::identity(), LAW)), PlanFault::NotARotation.at(1));
        assert_eq!(fault(Turn::toward(Matrix3::from_element(f64::NAN), LAW)), PlanFault::NotARotation.at(1));
        assert_eq!(fault(Turn::about([0.0; 3], 1.0, LAW)), PlanFault::AxisZero.at(1));
        assert_eq!(fault(Turn::about([0.0, 1.0, 0.0], f64::INFINITY, LAW)), PlanFault::NotFinite.at(1));
    }
}
