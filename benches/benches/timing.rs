//! Times of `armgen_runtime::timing`: `cargo bench --bench timing`.
//!
//! A random path of five points: coefficients and all solves to a gap of 0.1 %, and a sample of the governor at 1 kHz. The runtime's tests
//! wrote the arms by hand. Of 15 runs with the same samples count the least mean, and the longest of all samples, each by its least time.

#[allow(dead_code, missing_docs, unreachable_pub)]
#[path = "../../runtime/tests/common/chain.rs"]
mod chain;

use std::time::{Duration, Instant};

use armgen_runtime::timing::{
    time_optimal, Command, Ends, Governor, JointPath, Limits, Node, Phase, Piece, Segment, Timing, Workspace,
};
use chain::{Chain, PANDA_LIMITS, SCARA_LIMITS, UR5_LIMITS};
use nalgebra::SVector;

/// Random numbers in [0, 1).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Cubics through points, with the slopes of neighbouring chords.
fn curve<const N: usize>(points: &[SVector<f64, N>]) -> Vec<Piece<f64, N>> {
    let chord = |i: usize| (points[i + 1] - points[i]).norm();
    let slope = |i: usize| match i {
        0 => (points[1] - points[0]) / chord(0),
        i if i + 1 == points.len() => (points[i] - points[i - 1]) / chord(i - 1),
        i => (points[i + 1] - points[i - 1]) / (chord(i) + chord(i - 1)),
    };
    let mut start = 0.0;
    (0..points.len() - 1)
        .map(|i| {
            let (length, way) = (chord(i), points[i + 1] - points[i]);
            let (a, b) = (slope(i) * length, slope(i + 1) * length);
            let mut coefficients = [SVector::zeros(); 6];
            coefficients[0] = points[i];
            coefficients[1] = a / length;
            coefficients[2] = (way * 3.0 - a * 2.0 - b) / length.powi(2);
            coefficients[3] = (a + b - way * 2.0) / length.powi(3);
            start += length;
            Piece { start: start - length, length, coefficients }
        })
        .collect()
}

/// How the arm is led.
#[derive(Clone, Copy)]
enum Lead {
    Full,
    Half,
    Anyhow,
}

/// The mean and the longest time of a sample, s.
fn governed<const N: usize>(timing: &Timing<'_, f64, N>, lead: Lead) -> (f64, f64) {
    let mut storage = vec![[0.0; 2]; timing.segments()];
    let (mut mean, mut least) = (f64::INFINITY, Vec::<f64>::new());
    for _ in 0..15 {
        let mut governor = Governor::new(timing, &mut storage).expect("an interval for each segment");
        let (mut next, mut command) = (random(3), Command::Override(1.0));
        let begin = Instant::now();
        for sample in 0..100_000 {
            command = match lead {
                Lead::Full => Command::Override(1.0),
                Lead::Half => Command::Override(0.5),
                Lead::Anyhow if sample % 50 != 0 => command,
                Lead::Anyhow if next() < 0.4 => Command::Stop,
                Lead::Anyhow => Command::Override(next()),
            };
            let one = Instant::now();
            let at = governor.advance(Duration::from_millis(1), command);
            let time = one.elapsed().as_secs_f64();
            // A long one is often the machine's: in another run it is not.
            match least.get_mut(sample) {
                Some(least) => *least = time.min(*least),
                None => least.push(time),
            }
            if at.phase == Phase::Ended {
                break;
            }
        }
        mean = mean.min(begin.elapsed().as_secs_f64() / least.len() as f64);
    }
    (mean, least.into_iter().fold(0.0, f64::max))
}

fn measure<const N: usize>(name: &str, chain: &Chain<N>, (velocity, effort): ([f64; N], [f64; N]), range: [f64; N]) {
    let mut next = random(5);
    let points: Vec<SVector<f64, N>> = (0..5).map(|_| SVector::from_fn(|j, _| range[j] * (2.0 * next() - 1.0))).collect();
    let path = JointPath::new(curve(&points)).expect("a path");
    let limits = Limits::velocity(velocity).and_then(|of| of.with_effort(effort.map(|x| -x), effort)).expect("limits");
    let (mut nodes, mut segments) = (vec![Node::empty(); 2064], vec![Segment::empty(); 1001]);
    let ends = Ends { hold: false, ..Ends::at_rest() };
    let mut solved = f64::INFINITY;
    for _ in 0..20 {
        let work = Workspace { nodes: &mut nodes, segments: &mut segments };
        let begin = Instant::now();
        time_optimal(chain, &path, &limits, ends, 1e-3, work).expect("a timing");
        solved = solved.min(begin.elapsed().as_secs_f64());
    }
    let work = Workspace { nodes: &mut nodes, segments: &mut segments };
    let timing = time_optimal(chain, &path, &limits, ends, 1e-3, work).expect("a timing");
    let mut line = format!("| {name} | {} | {:.2}", timing.segments(), 1e3 * solved);
    for lead in [Lead::Full, Lead::Half, Lead::Anyhow] {
        let (mean, longest) = governed(&timing, lead);
        line += &format!(" | {:.2} | {:.2}", 1e6 * mean, 1e6 * longest);
    }
    println!("{line} |");
}

fn main() {
    println!("| arm | segments | all solves, ms | full speed, us | longest | half speed | longest | random commands | longest |");
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    let panda = [2.5, 1.7, 2.5, 1.5, 2.5, 1.8, 2.5];
    measure("SCARA, friction", &chain::scara(), SCARA_LIMITS, [2.0, 2.0, 0.3, 3.0]);
    measure("UR5", &chain::ur5().without_friction(), UR5_LIMITS, [3.0; 6]);
    measure("UR5, friction", &chain::ur5(), UR5_LIMITS, [3.0; 6]);
    measure("Panda", &chain::panda().without_friction(), PANDA_LIMITS, panda);
    measure("Panda, friction", &chain::panda(), PANDA_LIMITS, panda);
    measure("Panda, all friction", &chain::panda().with_curved_friction(PANDA_LIMITS, 0.2, 0.1), PANDA_LIMITS, panda);
}
