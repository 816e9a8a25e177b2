//! Elementary functions of a joint rate: inputs of the ring, which knows their values and nothing else of them.

/// A function of the rate dq_i.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Elementary {
    /// sign(dq_i), with sign(0) = 0.
    Sign,
    /// exp(-|dq_i| / v_i), v_i a velocity of the joint's friction.
    Decay,
    /// tanh(dq_i / v_i).
    Tanh,
}

impl Elementary {
    /// The number that its values are drawn by; no other kind of symbol has it.
    pub fn kind(self) -> u64 {
        match self {
            Elementary::Sign => 4,
            Elementary::Decay => 10,
            Elementary::Tanh => 14,
        }
    }

    /// Its text at joint `k`, counted from 1, and in LaTeX; `velocity`: v_i in the same notation.
    pub(super) fn printed(self, k: usize, velocity: &dyn Fn() -> String) -> [String; 2] {
        match self {
            Elementary::Sign => [format!("sign(dq{k})"), format!("\\operatorname{{sign}} \\dot q_{{{k}}}")],
            Elementary::Decay => {
                let v = velocity();
                [format!("exp(-abs(dq{k})/({v}))"), format!("e^{{-|\\dot q_{{{k}}}|/({v})}}")]
            }
            Elementary::Tanh => {
                let v = velocity();
                [format!("tanh(dq{k}/({v}))"), format!("\\tanh(\\dot q_{{{k}}}/({v}))")]
            }
        }
    }
}
