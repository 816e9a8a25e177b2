//! Compares the output of the firmware with this machine's bits and with the budgets, and writes the page about it.
//!
//! ```text
//! armgen-bare-report BUDGETS.toml CONTROL.elf FIRMWARE.elf PRINTED.txt M4F.elf M4F.txt M7.elf M7.txt [--write PAGE.md TABLE.csv]
//! ```
//!
//! The first program only controls an arm. The firmware also simulates the arm and measures. The other two measure the functions
//! of emitted modules, compiled for each processor.
//!
//! Exit code 0 if every bit agrees and every budget holds, 1 if not, 2 if a file cannot be read.

mod budgets;
mod image;
mod page;
mod printed;

use armgen_bare_control::{Cell, Fault, Line, PERIOD, STEPS};
use armgen_bare_functions::{laws, postures};
use budgets::{Budgets, Measured};
use image::Image;
use printed::Printed;
use std::{fs, process::ExitCode};

fn main() -> ExitCode {
    match run() {
        Ok(faults) if faults.is_empty() => ExitCode::SUCCESS,
        Ok(faults) => {
            for fault in faults {
                eprintln!("bare metal: {fault}");
            }
            ExitCode::FAILURE
        }
        Err(message) => {
            eprintln!("bare metal: {message}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<Vec<String>, String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (files, page) =
        match arguments.as_slice() {
            [files @ .., "--write", page, table] if files.len() == 8 => (files, Some((page, table))),
            files if files.len() == 8 => (files, None),
            _ => return Err(
                "usage: armgen-bare-report BUDGETS.toml CONTROL.elf FIRMWARE.elf PRINTED.txt M4F.elf M4F.txt M7.elf M7.txt [--write PAGE.md TABLE.csv]"
                    .into(),
            ),
        };
    let read = |path: &str| fs::read(path).map_err(|e| format!("cannot read {path}: {e}"));
    let text = |path: &str| String::from_utf8(read(path)?).map_err(|e| format!("{path}: {e}"));
    let budgets: Budgets = toml::from_str(&text(files[0])?).map_err(|e| format!("{}: {e}", files[0]))?;
    let control = Image::read(&read(files[1])?).map_err(|e| format!("{}: {e}", files[1]))?;
    let mut faults = Vec::new();
    let mut program = |elf: &str, lines: &str| {
        let image = Image::read(&read(elf)?).map_err(|e| format!("{elf}: {e}"))?;
        let printed = Printed::read(&text(lines)?)?;
        faults.extend(printed.calibration_faults());
        Ok::<_, String>((image, printed))
    };
    let (image, printed) = program(files[2], files[3])?;
    let ((m4f_image, m4f), (m7_image, m7)) = (program(files[4], files[5])?, program(files[6], files[7])?);
    let measured = Measured::of(&control, &image, &printed, budgets::functions(&m4f_image, &m4f)?)?;
    let on_m7 = budgets::functions(&m7_image, &m7)?;
    let host = host().map_err(|fault| format!("the run ended early on this machine: {fault:?}"))?;
    faults.extend(printed::differences(&host, &printed.torques));
    let (postures, laws) = (host_postures(), host_laws()?);
    for target in [&m4f, &m7] {
        faults.extend(printed::differences(&postures, &target.postures));
        faults.extend(printed::differences(&laws, &target.laws));
    }
    faults.extend(budgets.exceeded(&measured));
    let page_text = page::page(&measured, &on_m7, &budgets, &printed, postures.len());
    print!("{}", page::summary(&measured, &printed));
    if let Some((page, table)) = page.filter(|_| faults.is_empty()) {
        fs::write(page, page_text).map_err(|e| format!("cannot write {page}: {e}"))?;
        fs::write(table, page::table(&measured, &on_m7, &budgets)).map_err(|e| format!("cannot write {table}: {e}"))?;
    }
    Ok(faults)
}

/// Those of all postures, computed on this machine.
fn host_postures() -> Vec<String> {
    let mut lines = Vec::new();
    for pose in 0..postures::POSES {
        let added = postures::each_line(pose, &mut |line| {
            lines.push(line.to_string());
            Ok(())
        });
        debug_assert!(added.is_ok(), "a list takes everything");
    }
    lines
}

/// Those of all laws, computed on this machine.
fn host_laws() -> Result<Vec<String>, String> {
    let mut lines = Vec::new();
    laws::each_line(&mut |line| {
        lines.push(line.to_string());
        Ok(())
    })
    .map_err(|_| "a law has no result on this machine".to_string())?;
    Ok(lines)
}

/// The torques of each step, computed on this machine.
fn host() -> Result<Vec<String>, Fault> {
    let mut cell = Cell::new()?;
    (0..=STEPS)
        .map(|step| {
            let (_, tau) = cell.control(PERIOD * step)?;
            let line = Line { step, tau: &tau, mass: cell.estimated_mass() }.to_string();
            cell.advance(&tau);
            Ok(line)
        })
        .collect()
}
