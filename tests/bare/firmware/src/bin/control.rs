//! The control step of the SCARA and nothing else, as a product would hold it: what it takes of the flash is what a control step takes.
//! No arm is simulated, nothing is printed or measured.
#![no_std]
#![no_main]

use armgen_bare_control::{Cell, SVector, State};
use core::hint::black_box;
use panic_halt as _;

#[cortex_m_rt::entry]
fn main() -> ! {
    if let Ok(mut cell) = Cell::new() {
        for step in 0.. {
            // What the encoders say, and what the drives are told.
            let [q, dq] = black_box([[0.0; 4]; 2]);
            cell.measured(State { q: SVector::from(q), dq: SVector::from(dq) });
            let Ok((_, tau)) = cell.control(step) else { break };
            black_box(tau);
        }
    }
    loop {
        cortex_m::asm::wfi();
    }
}
