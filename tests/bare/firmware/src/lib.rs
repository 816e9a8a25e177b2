//! Shared by the programs: measure calls by the system timer and by painting the stack, and print over semihosting.
//!
//! An emulator's clock advances by the same time for each instruction, so differences of the timer count instructions. The lines
//! `calibration` let the reader of the output check this.
//!
//! | line | fields |
//! |---|---|
//! | `calibration` | argument of a delay loop, ticks |
//! | `function` | `MODULE::NAME`, largest ticks, largest stack in bytes, of a call from here |
//! | `end` | none; the last line |
#![no_std]

use core::fmt::{self, Write};
use core::hint::black_box;
use cortex_m::peripheral::{syst::SystClkSource, SYST};
use cortex_m_semihosting::{
    debug::{self, EXIT_FAILURE, EXIT_SUCCESS},
    hio::{self, HostStream},
};
use cortex_m_stack::{current_stack_free, repaint_stack, stack_painted};

/// More than a module has functions.
const MOST_FUNCTIONS: usize = 64;
const WRAP: u32 = 0x00ff_ffff;

/// Reason of an early end of the run; the exit code reports it to the host.
#[derive(Debug)]
pub struct Stopped;

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

/// Starts the timer, calibrates it, and ends the program with what `body` ends with.
pub fn run(body: impl FnOnce(&mut Output) -> Result<(), Stopped>) -> ! {
    let end = match calibrated(body) {
        Ok(()) => EXIT_SUCCESS,
        Err(Stopped) => EXIT_FAILURE,
    };
    debug::exit(end);
    loop {
        cortex_m::asm::wfi();
    }
}

fn calibrated(body: impl FnOnce(&mut Output) -> Result<(), Stopped>) -> Result<(), Stopped> {
    let mut timer = cortex_m::Peripherals::take().ok_or(Stopped)?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(WRAP);
    timer.clear_current();
    timer.enable_counter();
    let mut out = Output { stream: hio::hstdout()?, line: [0; 128], length: 0 };
    for delay in [0, 1000, 2000, 20_000] {
        writeln!(out, "calibration {delay} {}", ticks_of_delay(delay))?;
    }
    body(&mut out)?;
    writeln!(out, "end")?;
    Ok(())
}

/// The result of `f` and the ticks that it took.
#[inline(always)]
pub fn timed<R>(f: impl FnOnce() -> R) -> (R, u32) {
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
#[derive(Debug)]
pub struct Costs {
    entries: [(&'static str, u32, u32); MOST_FUNCTIONS],
    length: usize,
}

impl Costs {
    /// That of a call of nothing.
    pub fn new() -> Self {
        let mut costs = Costs { entries: [("", 0, 0); MOST_FUNCTIONS], length: 0 };
        costs.call("(nothing)", &mut || {});
        costs
    }

    /// Prints a line for each function, with its name after the name of its module.
    ///
    /// # Errors
    /// Where the host does not take it.
    pub fn print(&self, module: &str, out: &mut Output) -> Result<(), Stopped> {
        for (name, ticks, stack) in &self.entries[..self.length] {
            writeln!(out, "function {module}::{name} {ticks} {stack}")?;
        }
        Ok(())
    }

    /// Measures a call; whether there was a place for the function.
    #[inline(never)]
    pub fn call(&mut self, name: &'static str, call: &mut dyn FnMut()) -> bool {
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

impl Default for Costs {
    fn default() -> Self {
        Self::new()
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
pub struct Output {
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
