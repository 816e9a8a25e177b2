//! The numbers in which programs and equations are executed.
//!
//! | arithmetic | elements | what an equality there says |
//! |---|---|---|
//! | [`prime`] | integers modulo a random prime of 62 bits | equal but for odds of about (degree)/p |
//! | [`tower`] | fractions, with the square roots that the robot needs adjoined | equal at that point, beyond doubt |
//! | [`dual`] | pairs value + derivative over either | derivatives along a direction |
//! | [`wide`] | floats of 256 bits | nothing: they measure rounding errors, and prove none |
//! | [`twofold`] | pairs of floats in lanes, 106 bits | nothing: the same, for millions of states |
//! | [`degree`] | degree and height of the polynomial that a value is | how unlikely a false equality is |
//!
//! Angles are random points of the circle: (s, c) = (2t, 1 - t²)/(1 + t²). Pi, and sine and cosine of angles that have no roots, take
//! random values too, each (sine, cosine) on the circle: what holds for all such values holds for the true ones.

pub mod degree;
pub mod dual;
pub mod prime;
pub mod roots;
pub mod tower;
pub mod twofold;
pub mod wide;

use std::fmt::Debug;

use sha2::{Digest, Sha256};

use crate::formula::Formula;

/// An exact number with the operations of a field.
pub trait Element: Clone + PartialEq + Debug {
    /// a + b.
    fn plus(&self, other: &Self) -> Self;
    /// a - b.
    fn minus(&self, other: &Self) -> Self;
    /// a b.
    fn times(&self, other: &Self) -> Self;
    /// -a.
    fn negated(&self) -> Self;
    /// 1/a, if there is one.
    fn inverse(&self) -> Option<Self>;
    /// Whether this is 0.
    fn is_zero(&self) -> bool;
    /// How many bits it is written with, where that can grow.
    fn bits(&self) -> usize {
        0
    }
    /// The quotient, if there is one.
    fn over(&self, other: &Self) -> Option<Self> {
        Some(self.times(&other.inverse()?))
    }
}

/// Where elements come from.
pub trait Arithmetic {
    /// Its numbers.
    type Element: Element;
    /// An integer.
    fn integer(&self, value: i64) -> Self::Element;
    /// The value of an exact constant; `None` where it divides by 0.
    fn constant(&self, formula: &Formula) -> Option<Self::Element>;
    /// A random element, not 0.
    fn draw(&mut self) -> Self::Element;
    /// A random point of the circle: sine and cosine.
    fn draw_angle(&mut self) -> (Self::Element, Self::Element) {
        loop {
            let (t, one) = (self.draw(), self.integer(1));
            let square = t.times(&t);
            if let Some(scale) = one.plus(&square).inverse() {
                return (t.plus(&t).times(&scale), one.minus(&square).times(&scale));
            }
        }
    }
}

/// A reproducible stream of bits.
#[derive(Clone, Debug)]
pub struct Stream(Generator);

#[derive(Clone, Debug)]
enum Generator {
    /// splitmix64 (Steele, Lea and Flood 2014): its state.
    Counting(u64),
    /// SHA-256 of a key and the number of a block; what is left of the last block.
    Hashing { key: [u8; 32], blocks: u64, left: Vec<u64> },
}

impl Stream {
    /// The stream of a number, fast: for states at which something is measured.
    pub fn new(seed: u64) -> Stream {
        Stream(Generator::Counting(seed))
    }

    /// The stream of a hash, which nobody can steer: for points at which something is proved.
    pub fn of(key: [u8; 32]) -> Stream {
        Stream(Generator::Hashing { key, blocks: 0, left: Vec::new() })
    }

    /// A stream of its own that follows from this one.
    pub fn branch(&mut self) -> Stream {
        match &self.0 {
            Generator::Counting(_) => Stream::new(self.bits()),
            Generator::Hashing { .. } => {
                let mut key = [0; 32];
                key.chunks_mut(8).for_each(|part| part.copy_from_slice(&self.bits().to_le_bytes()));
                Stream::of(key)
            }
        }
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        match &mut self.0 {
            Generator::Counting(state) => {
                *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
                let x = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                x ^ (x >> 31)
            }
            Generator::Hashing { key, blocks, left } => {
                if left.is_empty() {
                    let block: [u8; 32] = Sha256::new().chain_update(*key).chain_update(blocks.to_le_bytes()).finalize().into();
                    *blocks += 1;
                    left.extend(block.chunks(8).map(|part| part.iter().fold(0, |bits, &byte| bits << 8 | u64::from(byte))));
                }
                left.pop().unwrap_or(0)
            }
        }
    }

    /// A number below `bound`.
    pub fn below(&mut self, bound: u64) -> u64 {
        ((u128::from(self.bits()) * u128::from(bound)) >> 64) as u64
    }
}

impl Element for f64 {
    fn plus(&self, other: &f64) -> f64 {
        self + other
    }
    fn minus(&self, other: &f64) -> f64 {
        self - other
    }
    fn times(&self, other: &f64) -> f64 {
        self * other
    }
    fn negated(&self) -> f64 {
        -self
    }
    fn inverse(&self) -> Option<f64> {
        Some(1.0 / self)
    }
    fn is_zero(&self) -> bool {
        *self == 0.0
    }
    fn over(&self, other: &f64) -> Option<f64> {
        Some(self / other)
    }
}

impl Element for f32 {
    fn plus(&self, other: &f32) -> f32 {
        self + other
    }
    fn minus(&self, other: &f32) -> f32 {
        self - other
    }
    fn times(&self, other: &f32) -> f32 {
        self * other
    }
    fn negated(&self) -> f32 {
        -self
    }
    fn inverse(&self) -> Option<f32> {
        Some(1.0 / self)
    }
    fn is_zero(&self) -> bool {
        *self == 0.0
    }
    fn over(&self, other: &f32) -> Option<f32> {
        Some(self / other)
    }
}
