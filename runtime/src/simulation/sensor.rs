//! The sensor: the state as the controller receives it.

use crate::{
    linalg::{lit, to_f64},
    reference::State,
};
use nalgebra::{ComplexField, RealField, SVector};
use std::collections::VecDeque;

/// Normally distributed numbers from a seed: SplitMix64 (Steele, Lea, Flood, 2014) and the transformation of Box and Muller (1958).
///
/// Its sine, cosine and logarithm come from libm, so equal seeds give equal bits everywhere.
#[derive(Clone, Debug)]
pub struct Noise {
    state: u64,
    spare: Option<f64>,
}

impl Noise {
    /// The sequence of this seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed, spare: None }
    }

    /// The next 64 bits.
    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly distributed in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Normally distributed with mean 0 and deviation 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // 1 - u is never zero.
        let radius = ComplexField::sqrt(-2.0 * ComplexField::ln(1.0 - self.uniform()));
        let (sine, cosine) = ComplexField::sin_cos(core::f64::consts::TAU * self.uniform());
        self.spare = Some(radius * sine);
        radius * cosine
    }
}

/// Sensors of joint variables and rates, with a delay and noise.
#[derive(Clone, Debug)]
pub struct Sensor<T, const N: usize> {
    delay: usize,
    position_deviation: T,
    velocity_deviation: T,
    noise: Noise,
    seen: VecDeque<State<T, N>>,
}

impl<T: RealField + Copy, const N: usize> Sensor<T, N> {
    /// Sees the state as it is.
    pub fn ideal() -> Self {
        Self::new(0, T::zero(), T::zero(), 0)
    }

    /// Sees the state of `delay` samples ago (until then the first one), with normal noise of these deviations, rad or m, and per s.
    pub fn new(delay: usize, position_deviation: T, velocity_deviation: T, seed: u64) -> Self {
        Self { delay, position_deviation, velocity_deviation, noise: Noise::new(seed), seen: VecDeque::new() }
    }

    /// Measurement of the true state `state`; to be called once a sample.
    pub fn measure(&mut self, state: &State<T, N>) -> State<T, N> {
        self.seen.push_back(*state);
        if self.seen.len() - 1 > self.delay {
            self.seen.pop_front();
        }
        let mut measured = self.seen[0];
        self.disturb(&mut measured.q, self.position_deviation);
        self.disturb(&mut measured.dq, self.velocity_deviation);
        measured
    }

    fn disturb(&mut self, values: &mut SVector<T, N>, deviation: T) {
        if to_f64(deviation) != Some(0.0) {
            values.iter_mut().for_each(|x| *x += deviation * lit(self.noise.normal()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_noise_is_normal_and_repeats() {
        let mut noise = Noise::new(7);
        let x: Vec<f64> = (0..100_000).map(|_| noise.normal()).collect();
        let mean = x.iter().sum::<f64>() / 1e5;
        let moment = |k: i32| x.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.01 && (moment(2) - 1.0).abs() < 0.02 && moment(3).abs() < 0.05 && (moment(4) - 3.0).abs() < 0.1);
        let mut again = Noise::new(7);
        assert!(x.iter().all(|x| *x == again.normal()));
        assert_ne!(Noise::new(8).normal(), x[0]);
    }

    #[test]
    fn a_delay_shows_the_past() {
        let mut sensor = Sensor::<f64, 1>::new(2, 0.0, 0.0, 0);
        let seen: Vec<f64> = (0..5).map(|k| sensor.measure(&State::at_rest([f64::from(k)].into())).q[0]).collect();
        assert_eq!(seen, [0.0, 0.0, 0.0, 1.0, 2.0]);
    }
}
