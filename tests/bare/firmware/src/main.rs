//! Runs the controlled SCARA on a Cortex-M4F and prints, over semihosting, the torques of each step and what they cost.
//!
//! Time is read from the system timer. Under an emulator whose clock advances by the same time for each instruction, differences of
//! it count instructions; the lines `calibration` let the reader of the output check that they do. Stack is measured by painting it.
//!
//! | line | fields |
//! |---|---|
//! | `calibration` | argument of a delay loop, ticks |
//! | `torque` | step, torques and estimated mass as the bits of f32 |
//! | `ticks` | step, ticks of trajectory, inverse kinematics, controller, arm |
//! | `posture` | robot, number of the pose, branch, joint variables as the bits of f32 |
//! | `error` | largest difference of desired and actual joint variables, units of 1e-9 rad or m |
//! | `function` | name, largest ticks, largest stack in bytes, of a call from here |
#![no_std]
#![no_main]

use armgen_bare_control::{postures, robot, Cell, Fault, JointReference, Line, SVector, STEPS};
use core::fmt::{self, Write};
use core::hint::black_box;
use cortex_m::peripheral::{syst::SystClkSource, SYST};
use cortex_m_semihosting::{
    debug::{self, EXIT_FAILURE, EXIT_SUCCESS},
    hio::{self, HostStream},
};
use cortex_m_stack::{current_stack_free, repaint_stack, stack_painted};
use panic_halt as _;

/// Every so many steps the emitted functions are measured at the state of the arm.
const BETWEEN_MEASUREMENTS: u32 = 100;
/// More than the module has functions.
const MOST_FUNCTIONS: usize = 64;
const WRAP: u32 = 0x00ff_ffff;

#[cortex_m_rt::entry]
fn main() -> ! {
    let end = match run() {
        Ok(()) => EXIT_SUCCESS,
        Err(_) => EXIT_FAILURE,
    };
    debug::exit(end);
    loop {
        cortex_m::asm::wfi();
    }
}

/// What ended the run early; the exit code tells the host.
#[derive(Debug)]
struct Stopped;

impl From<Fault> for Stopped {
    fn from(_: Fault) -> Self {
        Stopped
    }
}

impl From<fmt::Error> for Stopped {
    fn from(_: fmt::Error) -> Self {
        Stopped
    }
}

impl From<()> for Stopped {
    fn from((): ()) -> Self {
        Stopped
    }
}

fn run() -> Result<(), Stopped> {
    let mut timer = cortex_m::Peripherals::take().ok_or(Stopped)?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(WRAP);
    timer.clear_current();
    timer.enable_counter();
    let mut out = Output { stream: hio::hstdout()?, line: [0; 128], length: 0 };
    for delay in [0, 1000, 2000, 20_000] {
        writeln!(out, "calibration {delay} {}", ticks_of_delay(delay))?;
    }

    let mut cell = Cell::new()?;
    let mut costs = Costs { entries: [("", 0, 0); MOST_FUNCTIONS], length: 0 };
    let mut error: f32 = 0.0;
    for step in 0..=STEPS {
        let (sample, trajectory) = timed(|| cell.sample(step));
        let (reference, clik) = timed(|| cell.reference(&sample));
        let reference = reference?;
        let (tau, controller) = timed(|| cell.torque(&reference));
        let tau = tau?;
        writeln!(out, "{}", Line { step, tau: &tau, mass: cell.estimated_mass() })?;
        error = error.max((reference.q - cell.actual().q).amax());
        if step % BETWEEN_MEASUREMENTS == 0 {
            costs.measure(&cell, &reference, &tau, step)?;
        }
        let ((), arm) = timed(|| cell.advance(&tau));
        writeln!(out, "ticks {step} {trajectory} {clik} {controller} {arm}")?;
    }
    writeln!(out, "error {}", (error * 1e9) as u32)?;
    for pose in 0..postures::POSES {
        postures::each_line(pose, &mut |line| writeln!(out, "{line}"))?;
        costs.measure_postures(pose)?;
    }
    for (name, ticks, stack) in &costs.entries[..costs.length] {
        writeln!(out, "function {name} {ticks} {stack}")?;
    }
    writeln!(out, "end")?;
    Ok(())
}

/// The result of `f` and the ticks that it took.
#[inline(always)]
fn timed<R>(f: impl FnOnce() -> R) -> (R, u32) {
    let before = SYST::get_current();
    let result = black_box(f());
    (result, before.wrapping_sub(SYST::get_current()) & WRAP)
}

/// Ticks of a loop of two instructions that runs once more than `delay`, and of calling it.
#[inline(never)]
fn ticks_of_delay(delay: u32) -> u32 {
    timed(|| cortex_m::asm::delay(black_box(delay))).1
}

/// Names of measured functions, with the most ticks and the most stack that a call of each took.
struct Costs {
    entries: [(&'static str, u32, u32); MOST_FUNCTIONS],
    length: usize,
}

impl Costs {
    /// Measures every emitted function, and the three parts of a control step, at the present state.
    fn measure(
        &mut self,
        cell: &Cell,
        reference: &JointReference<f32, 4>,
        tau: &SVector<f32, 4>,
        step: u32,
    ) -> Result<(), Stopped> {
        let arguments = cell.arguments(reference, tau);
        let mut full = false;
        self.call("(nothing)", &mut || {});
        robot::each_function(&arguments, &mut |name, call| full |= !self.call(name, call));
        let mut copy = *cell;
        full |= !self.call("control_step", &mut || {
            let _ = black_box(copy.control(black_box(step)));
        });
        if full {
            Err(Stopped)
        } else {
            Ok(())
        }
    }

    /// Measures inverse kinematics at the poses of this number.
    fn measure_postures(&mut self, pose: u32) -> Result<(), Stopped> {
        let (scara, puma560) = (postures::scara_pose(pose), postures::puma560_pose(pose));
        let places = [
            self.call("scara_inverse_kinematics", &mut || {
                black_box(postures::scara_inverse_kinematics(black_box(&scara)));
            }),
            self.call("puma560_inverse_kinematics", &mut || {
                black_box(postures::puma560_inverse_kinematics(black_box(&puma560)));
            }),
        ];
        if places == [true; 2] {
            Ok(())
        } else {
            Err(Stopped)
        }
    }

    /// Whether there was a place for the function.
    #[inline(never)]
    fn call(&mut self, name: &'static str, call: &mut dyn FnMut()) -> bool {
        let ((), ticks) = timed(&mut *call);
        let stack = stack_of(call);
        let known = self.entries[..self.length].iter().position(|(known, ..)| *known == name);
        let place = known.unwrap_or(self.length);
        let Some(entry) = self.entries.get_mut(place) else { return false };
        self.length = self.length.max(place + 1);
        *entry = (name, entry.1.max(ticks), entry.2.max(stack));
        true
    }
}

/// Bytes of stack that a call takes, seen from here.
#[inline(never)]
fn stack_of(call: &mut dyn FnMut()) -> u32 {
    repaint_stack();
    let free = current_stack_free();
    call();
    free.saturating_sub(stack_painted())
}

/// Lines for the host, one request of semihosting each.
struct Output {
    stream: HostStream,
    line: [u8; 128],
    length: usize,
}

impl Write for Output {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            *self.line.get_mut(self.length).ok_or(fmt::Error)? = byte;
            self.length += 1;
            if byte == b'\n' {
                self.stream.write_all(&self.line[..self.length]).map_err(|()| fmt::Error)?;
                self.length = 0;
            }
        }
        Ok(())
    }
}
