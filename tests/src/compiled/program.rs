//! Emitted modules, asked over standard input. Not a module of the crate that this file lies in: `compiled.rs` adds the arms and writes
//! it into a project of its own.
#![deny(warnings)]

#[macro_use]
mod answers;

use std::io::{BufRead, Write};

use answers::Flat;

/// The arguments of a question.
struct Arguments {
    pi: Vec<f64>,
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    dqr: Vec<f64>,
    ddqr: Vec<f64>,
    tau: Vec<f64>,
}

fn main() {
    let mut answers = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("text");
        let mut words = line.split(' ');
        let arm: usize = words.next().and_then(|word| word.parse().ok()).expect("an arm");
        let function = words.next().expect("a function");
        let mut list = || -> Vec<f64> {
            let len = words.next().map_or(0, |word| word.parse().expect("a length"));
            let mut number = || f64::from_bits(u64::from_str_radix(words.next().expect("a number"), 16).expect("bits"));
            (0..len).map(|_| number()).collect()
        };
        let given = Arguments { pi: list(), q: list(), dq: list(), ddq: list(), dqr: list(), ddqr: list(), tau: list() };
        let bits: Vec<String> = ARMS[arm](function, &given).iter().map(|x| format!("{:016x}", x.to_bits())).collect();
        writeln!(answers, "{}", bits.join(" ")).and_then(|()| answers.flush()).expect("the asker reads");
    }
}

