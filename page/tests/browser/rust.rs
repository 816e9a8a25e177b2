//! The Rust module (`--trig fast`), compiled and run at the states of the page: all numbers agree bit by bit.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use armgen_codegen::program::Trig;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;

/// The functions whose entries the page shows, with their arguments.
const FUNCTIONS: &[(&str, &str)] = &[
    ("direct_kinematics", "q"),
    ("geometric_jacobian", "q"),
    ("inertia_matrix", "q"),
    ("coriolis_matrix", "q, dq"),
    ("gravity", "q"),
    ("friction", "dq"),
    ("inverse_dynamics", "q, dq, ddq"),
    ("kinetic_energy", "q, dq"),
    ("potential_energy", "q"),
    ("link_frames", "q"),
];

/// A posture with its rates and accelerations.
pub(crate) type State = [Vec<f64>; 3];

/// The results of all functions in a state, entry by entry.
pub(crate) type Results = Vec<(String, Vec<f64>)>;

/// A substitute for the crate that the module names; it serves only angles outside the ranges of the sliders.
const LIBM: &str = "pub fn sincos(x: f64) -> (f64, f64) { x.sin_cos() }\n";

const FLAT: &str = "
trait Flat { fn put(&self, out: &mut Vec<u64>); }
impl Flat for f64 { fn put(&self, out: &mut Vec<u64>) { out.push(self.to_bits()) } }
impl<T: Flat, const N: usize> Flat for [T; N] { fn put(&self, out: &mut Vec<u64>) { self.iter().for_each(|x| x.put(out)) } }
fn show(robot: usize, name: &str, value: impl Flat) {
    let mut out = Vec::new();
    value.put(&mut out);
    println!(\"{robot} {name} {}\", out.iter().map(|x| x.to_string()).collect::<Vec<_>>().join(\" \"));
}
";

/// The results of each robot in each of its states.
pub(crate) fn results(folder: &Path, robots: &[(Source, Vec<State>)]) -> Vec<Vec<Results>> {
    let mut main = String::from("#![allow(warnings)]\nmod libm;\n");
    let mut body = String::new();
    for (k, (source, states)) in robots.iter().enumerate() {
        let names: Vec<&str> = FUNCTIONS.iter().map(|(name, _)| *name).collect();
        let functions = Selection::named(names).expect("names of functions");
        let options = Options { trig: Trig::Fast, functions, ..Options::default() };
        let (generated, _) = armgen_codegen::generate(source, &options);
        let module = generated.expect("a valid robot").module.replace("libm::", "crate::libm::");
        let _ = writeln!(main, "mod r{k};");
        for state in states {
            let array = |values: &[f64]| {
                let bits: Vec<String> = values.iter().map(|x| format!("f64::from_bits({})", x.to_bits())).collect();
                format!("[{}]", bits.join(", "))
            };
            let [q, dq, ddq] = state.each_ref().map(|values| array(values));
            let _ = writeln!(body, "    let (q, dq, ddq) = (&{q}, &{dq}, &{ddq});\n    println!(\"{k} state\");");
            for (name, arguments) in FUNCTIONS.iter().filter(|(name, _)| module.contains(&format!("pub fn {name}("))) {
                let _ = writeln!(body, "    show({k}, \"{name}\", r{k}::{name}({arguments}));");
            }
        }
        std::fs::write(folder.join(format!("r{k}.rs")), module).expect("the module is written");
    }
    let _ = write!(main, "{FLAT}fn main() {{\n{body}}}\n");
    std::fs::write(folder.join("libm.rs"), LIBM).expect("written");
    std::fs::write(folder.join("main.rs"), main).expect("written");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let program = folder.join("main");
    let compiled = Command::new(rustc).args(["--edition", "2021", "-o"]).arg(&program).arg(folder.join("main.rs")).output();
    let compiled = compiled.expect("rustc runs");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let output = Command::new(program).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut all: Vec<Vec<Results>> = robots.iter().map(|_| Vec::new()).collect();
    for line in String::from_utf8(output.stdout).expect("text").lines() {
        let mut words = line.split(' ');
        let robot: usize = words.next().expect("a robot").parse().expect("its number");
        let name = words.next().expect("a function");
        if name == "state" {
            all[robot].push(Vec::new());
        } else {
            let bits = words.map(|word| f64::from_bits(word.parse().expect("bits"))).collect();
            all[robot].last_mut().expect("a state").push((name.to_owned(), bits));
        }
    }
    all
}
