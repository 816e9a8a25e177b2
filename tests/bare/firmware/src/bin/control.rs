//! The control step of the SCARA and nothing else, as a product would hold it: what it takes of the flash is what a control step takes.
//! No arm is simulated, nothing is printed or measured.
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
            // What the encoders say, and what the drives are told.
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
