//! Inverse dynamics of the Panda in f32 for many states on all processors, beside a copy of the same bytes: `cargo bench --bench lanes [THREADS]`.
//!
//! A line of CSV for each: million states a second, the sum over threads of states by least time of a round. Threads begin each round together.

use std::hint::black_box;
use std::sync::Barrier;
use std::time::Instant;

/// The emitted modules.
#[allow(missing_docs, unreachable_pub, dead_code, clippy::all)]
mod emitted {
    pub mod lanes_8 {
        include!(concat!(env!("OUT_DIR"), "/panda7_lanes_8.rs"));
    }
    pub mod lanes_16 {
        include!(concat!(env!("OUT_DIR"), "/panda7_lanes_16.rs"));
    }
}

const DOF: usize = emitted::lanes_8::DOF;

/// Arguments and results of one thread.
struct Arrays {
    q: Vec<[f32; DOF]>,
    dq: Vec<[f32; DOF]>,
    ddq: Vec<[f32; DOF]>,
    tau: Vec<[f32; DOF]>,
}

impl Arrays {
    fn of(states: usize, seed: usize) -> Arrays {
        let vectors = |step: usize| -> Vec<[f32; DOF]> {
            (0..states).map(|k| std::array::from_fn(|i| ((k * step + i * 101 + seed) % 601) as f32 / 100.0 - 3.0)).collect()
        };
        Arrays { q: vectors(37), dq: vectors(31), ddq: vectors(17), tau: vec![[0.0; DOF]; states] }
    }
}

/// A way to spend a round.
type Round = fn(&mut Arrays);

/// State by state.
fn one(a: &mut Arrays) {
    for (k, tau) in a.tau.iter_mut().enumerate() {
        *tau = emitted::lanes_8::inverse_dynamics(&a.q[k], &a.dq[k], &a.ddq[k]);
    }
}

fn batch_8(a: &mut Arrays) {
    emitted::lanes_8::batch::inverse_dynamics(&a.q, &a.dq, &a.ddq, &mut a.tau);
}

fn batch_16(a: &mut Arrays) {
    emitted::lanes_16::batch::inverse_dynamics(&a.q, &a.dq, &a.ddq, &mut a.tau);
}

/// Two arrays are read and two written: as many bytes as three arguments and a result.
fn copy(a: &mut Arrays) {
    a.tau.copy_from_slice(&a.q);
    a.ddq.copy_from_slice(&a.dq);
}

/// Million states a second of so many threads.
fn rate(threads: usize, states: usize, rounds: usize, round: Round) -> f64 {
    let barrier = Barrier::new(threads);
    let work = |seed: usize| {
        let mut arrays = Arrays::of(states, seed);
        let time = || {
            barrier.wait();
            let begin = Instant::now();
            round(black_box(&mut arrays));
            begin.elapsed().as_nanos() as f64
        };
        states as f64 * 1e3 / std::iter::repeat_with(time).take(rounds).fold(f64::INFINITY, f64::min)
    };
    std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|seed| scope.spawn(move || work(seed))).collect();
        running.into_iter().map(|thread| thread.join().expect("a thread that ends")).sum()
    })
}

fn main() {
    let given = std::env::args().skip(1).find_map(|argument| argument.parse().ok());
    let threads = given.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    println!("threads,states of a thread,one state,batch 8,batch 16,copy");
    for (threads, states, rounds) in [(1, 4096, 3000), (threads, 4096, 3000), (threads, 1 << 20, 20)] {
        let rates = [one, batch_8, batch_16, copy].map(|round: Round| format!("{:.1}", rate(threads, states, rounds, round)));
        println!("{threads},{states},{}", rates.join(","));
    }
}
