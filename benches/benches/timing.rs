//! Times of `armgen_runtime::timing`: `cargo bench --bench timing`.
//!
//! Three kinds of path: five points anywhere, and three within half a radian, both in all solves to a gap of 0.1 %; and so many points
//! that one solve has about 1000 segments, whose time is given for 1000. Of 15 paths of a kind the median counts. The runtime's tests
//! wrote the arms by hand, so their torques at nodes are kept from a first run and take no time; how many nodes there are is a column.
//! Then a sample of the governor at 1 kHz. Of 15 runs with the same samples count the least mean, and the longest of all samples, each by
//! its least time.

#[allow(dead_code, missing_docs, unreachable_pub)]
#[path = "../../runtime/tests/common/chain.rs"]
mod chain;

use std::cell::RefCell;
use std::time::{Duration, Instant};

use armgen_runtime::timing::{
    time_optimal, Command, Ends, Governor, JointFriction, JointPath, Limits, LinkBound, Node, PathDynamics, PathTorques, Phase,
    Piece, Segment, Timing, Workspace,
};
use chain::{Chain, PANDA_LIMITS, SCARA_LIMITS, UR5_LIMITS};
use nalgebra::{SVector, Vector6};

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
            Piece::new(start - length, length, coefficients)
        })
        .collect()
}

/// An arm whose torques along a path are known: they are asked for in the same order each time.
struct Known<'a, const N: usize> {
    chain: &'a Chain<N>,
    torques: RefCell<(Vec<PathTorques<f64, N>>, usize)>,
}

impl<const N: usize> PathDynamics<N> for Known<'_, N> {
    type Real = f64;

    fn path_dynamics(&self, q: &SVector<f64, N>, slope: &SVector<f64, N>, curvature: &SVector<f64, N>) -> PathTorques<f64, N> {
        let (known, next) = &mut *self.torques.borrow_mut();
        *next += 1;
        if known.len() < *next {
            known.push(self.chain.path_dynamics(q, slope, curvature));
        }
        known[*next - 1]
    }

    fn tool_rate(&self, q: &SVector<f64, N>, slope: &SVector<f64, N>) -> Vector6<f64> {
        self.chain.tool_rate(q, slope)
    }

    fn joint_friction(&self) -> &[JointFriction<f64>; N] {
        self.chain.joint_friction()
    }

    fn link_bounds(&self) -> &[LinkBound<f64>; N] {
        self.chain.link_bounds()
    }

    fn gravity_length(&self) -> f64 {
        self.chain.gravity_length()
    }
}

/// Points whose path has about `segments` base segments: 8 for each radian of all joints.
fn long<const N: usize>(segments: f64, point: &mut impl FnMut() -> SVector<f64, N>) -> Vec<SVector<f64, N>> {
    let mut points = vec![point(), point()];
    let way = |piece: &Piece<f64, N>| {
        let slopes = (0..=200).map(|i| piece.at(piece.start + piece.length * f64::from(i) / 200.0).slope.abs());
        slopes.reduce(|a, b| a.sup(&b)).map_or(0.0, |most| most.sum() * piece.length)
    };
    while 8.0 * curve(&points).iter().map(way).sum::<f64>() < segments {
        points.push(point());
    }
    points
}

/// How many paths of a kind are timed: the median counts.
const PATHS: usize = 15;

/// Five points anywhere, three within half a radian, or as many as one solve of about 1000 segments takes.
enum Kind {
    Anywhere,
    Everyday,
    Long,
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
    let limits = Limits::velocity(velocity).and_then(|of| of.with_effort(effort.map(|x| -x), effort)).expect("limits");
    let ends = Ends { hold: false, ..Ends::at_rest() };
    let mut next = random(5);
    let mut point = || SVector::<f64, N>::from_fn(|j, _| range[j] * (2.0 * next() - 1.0));
    let mut line = format!("| {name}");
    let first: Vec<_> = (0..5).map(|_| point()).collect();
    for (kind, room, goal) in [(Kind::Anywhere, 1001, 1e-3), (Kind::Everyday, 1001, 1e-3), (Kind::Long, 2600, 10.0)] {
        let (mut nodes, mut segments) = (vec![Node::empty(); 2600], vec![Segment::empty(); room]);
        let mut solves: Vec<(f64, usize, usize)> = Vec::new();
        for _ in 0..PATHS {
            let points: Vec<_> = match kind {
                Kind::Anywhere => (0..5).map(|_| point()).collect(),
                Kind::Everyday => {
                    let middle = point();
                    (0..3).map(|_| point()).map(|way| middle + way * (0.25 / way.amax())).collect()
                }
                Kind::Long => long(960.0, &mut point),
            };
            let path = JointPath::new(curve(&points)).expect("a path");
            let known = Known { chain, torques: RefCell::default() };
            let (mut least, mut count) = (f64::INFINITY, 0);
            for _ in 0..10 {
                known.torques.borrow_mut().1 = 0;
                let work = Workspace { nodes: &mut nodes, segments: &mut segments };
                let begin = Instant::now();
                let timing = time_optimal(&known, &path, &limits, ends, goal, work).expect("a timing");
                least = least.min(begin.elapsed().as_secs_f64());
                count = timing.segments();
            }
            let share = if matches!(kind, Kind::Long) { 1000.0 / count as f64 } else { 1.0 };
            solves.push((least * share, count, known.torques.borrow().0.len()));
        }
        solves.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (time, count, nodes) = solves[PATHS / 2];
        line += &format!(" | {nodes} | {count} | {:.2}", 1e3 * time);
    }
    let path = JointPath::new(curve(&first)).expect("a path");
    let (mut nodes, mut segments) = (vec![Node::empty(); 2064], vec![Segment::empty(); 1001]);
    let work = Workspace { nodes: &mut nodes, segments: &mut segments };
    let timing = time_optimal(chain, &path, &limits, ends, 1e-3, work).expect("a timing");
    for lead in [Lead::Full, Lead::Half, Lead::Anyhow] {
        let (mean, longest) = governed(&timing, lead);
        line += &format!(" | {:.2} | {:.2}", 1e6 * mean, 1e6 * longest);
    }
    println!("{line} |");
}

fn main() {
    let solves = ["anywhere", "everyday", "one solve of 1000"].map(|kind| format!("nodes | segments | {kind}, ms"));
    println!("| arm | {} | full speed, us | longest | half speed | longest | random commands | longest |", solves.join(" | "));
    println!("|---|{}", "---:|".repeat(15));
    let panda = [2.5, 1.7, 2.5, 1.5, 2.5, 1.8, 2.5];
    measure("SCARA, friction", &chain::scara(), SCARA_LIMITS, [2.0, 2.0, 0.3, 3.0]);
    measure("UR5", &chain::ur5().without_friction(), UR5_LIMITS, [3.0; 6]);
    measure("UR5, friction", &chain::ur5(), UR5_LIMITS, [3.0; 6]);
    measure("Panda", &chain::panda().without_friction(), PANDA_LIMITS, panda);
    measure("Panda, friction", &chain::panda(), PANDA_LIMITS, panda);
    measure("Panda, all friction", &chain::panda().with_curved_friction(PANDA_LIMITS, 0.2, 0.1), PANDA_LIMITS, panda);
}
