//! The control step of the SCARA alone, as in a product: the size of this program in flash is the cost of a control step. It
//! simulates no arm, prints nothing and measures nothing.
#![no_std]
#![no_main]

use armgen_bare_control::{Cell, SVector, State, PERIOD};
use core::hint::black_box;
use core::time::Duration;
use panic_halt as _;

#[cortex_m_rt::entry]
fn main() -> ! {
    if let Ok(mut cell) = Cell::new() {
        let mut t = Duration::ZERO;
        loop {
            // Readings of the encoders, and commands to the drives.
            let [q, dq] = black_box([[0.0; 4]; 2]);
            cell.measured(State { q: SVector::from(q), dq: SVector::from(dq) });
            let Ok((_, tau)) = cell.control(t) else { break };
            black_box(tau);
            t = t.saturating_add(PERIOD);
        }
    }
    loop {
        cortex_m::asm::wfi();
    }
}
