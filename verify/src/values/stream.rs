//! Reproducible random bits.

use sha2::{Digest, Sha256};

/// A reproducible stream of bits.
#[derive(Clone, Debug)]
pub struct Stream(Generator);

#[derive(Clone, Debug)]
enum Generator {
    /// State of splitmix64 (Steele, Lea and Flood 2014).
    Counting(u64),
    /// SHA-256 of a key and a block number; the unused words of the last block.
    Hashing { key: [u8; 32], blocks: u64, left: Vec<u64> },
}

impl Stream {
    /// A fast stream from a number, for states of measurements.
    pub fn new(seed: u64) -> Stream {
        Stream(Generator::Counting(seed))
    }

    /// A stream from a hash, which nobody can steer, for points of proofs.
    pub fn of(key: [u8; 32]) -> Stream {
        Stream(Generator::Hashing { key, blocks: 0, left: Vec::new() })
    }

    /// A separate stream derived from this one.
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
