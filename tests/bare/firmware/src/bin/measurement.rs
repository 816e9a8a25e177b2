//! Calls every function of each module of `armgen-bare-functions` at a few states and prints its cost. Finds all postures of two
//! arms and prints them, and takes steps of the runtime; times a path, leads it, and calls laws with limits. Lines in addition to those of the library:
//!
//! | line | fields |
//! |---|---|
//! | `posture` | robot, number of the pose, branch, joint variables as the bits of f32 |
//! | `bits` | name, number, numbers as the bits of f32 |
#![no_std]
#![no_main]

use armgen_bare_firmware::{Costs, Output, Stopped};
use armgen_bare_functions::{laws, postures, steps, Governor, Node, Segment, MODULES};
use core::fmt::Write;
use core::hint::black_box;
use panic_halt as _;

const STATES: u32 = 11;

#[cortex_m_rt::entry]
fn main() -> ! {
    armgen_bare_firmware::run(|out| {
        modules(out)?;
        inverse_kinematics(out)?;
        steps(out)?;
        laws::each_line(&mut |line| writeln!(out, "{line}"))?;
        laws(out)
    })
}

fn steps(out: &mut Output) -> Result<(), Stopped> {
    let mut watch = steps::Watch::new().ok_or(Stopped)?;
    let mut costs = Costs::new();
    for state in 0..STATES {
        let mut next = watch;
        let mut is_taken = true;
        let fits = costs.call("payload_step", &mut || is_taken &= steps::payload_step(black_box(&mut next), black_box(state)))
            && costs.call("payload_regressors", &mut || _ = black_box(steps::payload_regressors(black_box(state))))
            && costs.call("payload_estimate", &mut || _ = black_box(steps::payload_estimate(black_box(&next))))
            && costs.call("payload_body", &mut || _ = black_box(steps::payload_body(black_box(&mut watch))))
            && costs
                .call("contact_step", &mut || is_taken &= steps::contact_step(black_box(&mut next), black_box(state)).is_some());
        if !(fits && is_taken) {
            return Err(Stopped);
        }
        watch = next;
    }
    costs.print("steps", out)
}

/// Timing first: its storage is half of the memory.
fn laws(out: &mut Output) -> Result<(), Stopped> {
    let mut costs = Costs::new();
    timed(&mut costs)?;
    let mut laws = laws::Laws::new().ok_or(Stopped)?;
    for state in 0..laws::STATES {
        let mut found = true;
        let fits = costs.call("rate_program", &mut || found &= laws::rate_program(black_box(state)).is_some())
            && costs.call("impedance_step", &mut || found &= laws::impedance_step(black_box(&laws), black_box(state)).is_some())
            && costs.call("limited_rate_step", &mut || {
                found &= laws::limited_rate_step(black_box(&laws), black_box(state)).is_some()
            })
            && costs.call("guiding_step", &mut || found &= laws::guiding_step(black_box(&mut laws), black_box(state)).is_some())
            && costs.call("limited_torque_step", &mut || {
                found &= laws::limited_torque_step(black_box(&mut laws), black_box(state)).is_some();
            });
        if !(fits && found) {
            return Err(Stopped);
        }
    }
    costs.print("laws", out)
}

#[inline(never)]
fn timed(costs: &mut Costs) -> Result<(), Stopped> {
    let motion = laws::Motion::new().ok_or(Stopped)?;
    let mut nodes: laws::Nodes = [Node::empty(); 33];
    let mut segments: laws::Segments = [Segment::empty(); laws::SEGMENTS + 1];
    let fits = costs.call("timing", &mut || _ = black_box(laws::timing(&motion, black_box(&mut nodes), &mut segments).is_some()));
    let timing = laws::timing(&motion, &mut nodes, &mut segments).filter(|_| fits).ok_or(Stopped)?;
    let mut storage = [[0.0; 2]; laws::SEGMENTS];
    let mut governor = Governor::new(&timing, &mut storage).ok_or(Stopped)?;
    for sample in 0..laws::SAMPLES {
        let now = governor.clone();
        // Of a copy, that a second call measures the same.
        if !costs.call("governor_step", &mut || _ = black_box(laws::governor_step(&mut now.clone(), black_box(sample)))) {
            return Err(Stopped);
        }
        laws::governor_step(&mut governor, sample);
    }
    Ok(())
}

fn modules(out: &mut Output) -> Result<(), Stopped> {
    for (module, visit) in MODULES {
        let mut costs = Costs::new();
        let mut fits = true;
        for state in 0..STATES {
            visit(state, &mut |name, call| fits &= costs.call(name, call));
        }
        if !fits {
            return Err(Stopped);
        }
        costs.print(module, out)?;
    }
    Ok(())
}

fn inverse_kinematics(out: &mut Output) -> Result<(), Stopped> {
    let mut costs = Costs::new();
    for pose in 0..postures::POSES {
        postures::each_line(pose, &mut |line| writeln!(out, "{line}"))?;
        let (scara, puma560) = (postures::scara_pose(pose), postures::puma560_pose(pose));
        let places = [
            costs.call("scara_inverse_kinematics", &mut || {
                black_box(postures::scara_inverse_kinematics(black_box(&scara)));
            }),
            costs.call("puma560_inverse_kinematics", &mut || {
                black_box(postures::puma560_inverse_kinematics(black_box(&puma560)));
            }),
        ];
        if places != [true; 2] {
            return Err(Stopped);
        }
    }
    costs.print("postures", out)
}
