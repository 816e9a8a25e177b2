//! Whether a file of `armgen time --json` proves what it claims: a motion that keeps its limits on all of the path, and a time that no motion
//! can beat.
//!
//! Nothing of the timing is shared. The torques along the path come from the checker's own Newton-Euler equations in Taylor models
//! (`taylor.rs`) about the middle of each segment, and the law and the barriers from the digits of the file. For x = ds² and u = dds
//!
//! ```text
//! tau = m u + c x + v sqrt(x) + d,    m = B q',  c = B q'' + C(q, q') q',  v = F_v q',  d = g + sign(q') (F_c + F_l |g|) + F_0
//! ```
//!
//! and sign(q') (F_3 |dq|³ + F_s exp(-|dq|/v_s)) of cubic and Stribeck friction (`curve.rs`).
//!
//! - **The motion.** Each limit is an inequality of polynomials on a segment, proved by Bernstein coefficients on halves (`bernstein.rs`).
//! - **The bound.** A barrier X has m > 0 and m U + c X + v sqrt(X) + d >= limit on a segment. No motion crosses it upwards, so x <= X at
//!   its left end implies x <= X on the segment. With m < 0 the same holds from the right end, and a bound of speed holds everywhere.
//!   The bound that a barrier needs at its end follows from the ends of the path, from another barrier, or from two rows at the node that
//!   exclude all larger x. The durations of all barriers add up.

mod bernstein;
mod curve;
mod taylor;

use serde_json::Value;

use armgen_description::kinds::Feature;
use armgen_description::manipulator::{Joint, Manipulator};

use crate::element::Element;
use crate::equations::arm::Arm;
use crate::equations::lagrange::spring_torques;
use crate::equations::newton_euler::{ArmMotion, Motion};
use crate::equations::pose::Pose;
use crate::equations::state::State;
use crate::float::Arguments;
use bernstein::{at_most_zero, Square};
use curve::Curve;
use taylor::{Constants, Range, Taylor};

/// The content of a file that is proved.
#[derive(Clone, Copy, Debug)]
pub struct Proved {
    /// Number of segments.
    pub segments: usize,
    /// The duration of the motion, rounded up, s.
    pub duration: f64,
    /// No motion takes less, rounded down, s.
    pub lower_bound: f64,
}

/// Whether a text is a timing.
pub fn is_one(text: &str) -> bool {
    text.trim_start().starts_with('{') && text.contains("\"lower_bound\"") && text.contains("\"grid\"")
}

/// The limits of a file.
struct Limits {
    velocity: Vec<Option<f64>>,
    acceleration: Vec<Option<f64>>,
    effort: Vec<[Option<f64>; 2]>,
}

/// x = ds² on a segment: its ends, and by how much the middle Bernstein coefficient exceeds their mean.
#[derive(Clone, Copy)]
struct Law {
    x: [f64; 2],
    k: f64,
}

/// A barrier of the file.
struct Barrier {
    law: Law,
    direction: i64,
    row: (usize, Kind),
}

/// A kind of limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    TorqueHigh,
    TorqueLow,
    AccelerationHigh,
    AccelerationLow,
    Speed,
}

const KINDS: [(Kind, &str); 5] = [
    (Kind::TorqueHigh, "torque high"),
    (Kind::TorqueLow, "torque low"),
    (Kind::AccelerationHigh, "acceleration high"),
    (Kind::AccelerationLow, "acceleration low"),
    (Kind::Speed, "speed"),
];

/// Knots and ends of segments differ by less.
const ROUNDING: f64 = 1e-12;

struct File {
    joints: Vec<String>,
    knots: Vec<f64>,
    /// `[piece][joint][power]`.
    coefficients: Vec<Vec<Vec<f64>>>,
    speed: [f64; 2],
    limits: Limits,
    s: Vec<f64>,
    t: Vec<f64>,
    laws: Vec<Law>,
    /// Of each segment: the best one, if there is one, and others that bound x at its ends.
    barriers: Vec<Vec<Barrier>>,
    duration: f64,
    lower_bound: f64,
}

fn at<'a>(value: &'a Value, path: &str) -> Result<&'a Value, String> {
    path.split('.').try_fold(value, |value, key| value.get(key)).ok_or_else(|| format!("`{path}` is missing"))
}

fn number(value: &Value, what: &str) -> Result<f64, String> {
    value.as_f64().filter(|x| x.is_finite()).ok_or_else(|| format!("`{what}` has something other than a number"))
}

fn list<'a>(value: &'a Value, what: &str) -> Result<&'a [Value], String> {
    value.as_array().map(Vec::as_slice).ok_or_else(|| format!("`{what}` is not a list"))
}

fn numbers(value: &Value, what: &str) -> Result<Vec<f64>, String> {
    list(value, what)?.iter().map(|x| number(x, what)).collect()
}

/// Numbers, or null for no limit.
fn optional(value: &Value, what: &str) -> Result<Vec<Option<f64>>, String> {
    list(value, what)?.iter().map(|x| if x.is_null() { Ok(None) } else { number(x, what).map(Some) }).collect()
}

impl File {
    fn read(text: &str) -> Result<File, String> {
        let json: Value = serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
        let joints: Vec<String> = list(at(&json, "joints")?, "joints")?
            .iter()
            .map(|name| name.as_str().map(str::to_owned).ok_or_else(|| "`joints` has something other than a name".to_owned()))
            .collect::<Result<_, _>>()?;
        let n = joints.len();
        let knots = numbers(at(&json, "path.knots")?, "path.knots")?;
        let mut coefficients = Vec::new();
        for piece in list(at(&json, "path.coefficients")?, "path.coefficients")? {
            let piece = list(piece, "path.coefficients")?;
            coefficients.push(piece.iter().map(|of| numbers(of, "path.coefficients")).collect::<Result<Vec<_>, _>>()?);
        }
        let of_joints = |key: &str| -> Result<Vec<Option<f64>>, String> { optional(at(&json, key)?, key) };
        let effort = list(at(&json, "limits.effort")?, "limits.effort")?;
        let effort = effort.iter().map(|both| optional(both, "limits.effort")).collect::<Result<Vec<_>, _>>()?;
        let limits = Limits {
            velocity: of_joints("limits.velocity")?,
            acceleration: of_joints("limits.acceleration")?,
            effort: effort.iter().filter_map(|both| both.as_slice().try_into().ok()).collect(),
        };
        let speed = numbers(at(&json, "ends.speed")?, "ends.speed")?;
        let [s, t, x, k] = ["grid.s", "grid.t", "grid.x", "grid.k"].map(|key| at(&json, key).and_then(|of| numbers(of, key)));
        let (s, t, x, k) = (s?, t?, x?, k?);
        let fits = n > 0
            && knots.len() == coefficients.len() + 1
            && coefficients.iter().all(|piece| piece.len() == n && piece.iter().all(|of| (1..=6).contains(&of.len())))
            && [limits.velocity.len(), limits.acceleration.len(), limits.effort.len()] == [n; 3]
            && speed.len() == 2
            && s.len() > 1
            && [t.len(), x.len(), k.len() + 1] == [s.len(); 3];
        if !fits {
            return Err("the lengths of its lists do not fit".to_owned());
        }
        let ends = [(s[0], knots[0]), (s[s.len() - 1], knots[knots.len() - 1])];
        let off = |(a, b): (f64, f64)| (a - b).abs() > ROUNDING * (1.0 + b.abs());
        if knots.windows(2).chain(s.windows(2)).any(|pair| pair[0] >= pair[1]) || ends.into_iter().any(off) {
            return Err("`grid.s` does not run from the first knot to the last".to_owned());
        }
        let laws: Vec<Law> = k.iter().enumerate().map(|(i, k)| Law { x: [x[i], x[i + 1]], k: *k }).collect();
        let bound = |key: &str| list(at(&json, &format!("bound.{key}"))?, key).map(<[Value]>::to_vec);
        let (direction, x0, x2, k, row) = (bound("direction")?, bound("x0")?, bound("x2")?, bound("k")?, bound("row")?);
        if [direction.len(), x0.len(), x2.len(), k.len(), row.len()] != [laws.len(); 5] {
            return Err("`bound` has other segments than `grid`".to_owned());
        }
        let barrier = |direction: &Value, [x0, x2, k]: [&Value; 3], row: &Value| -> Result<Barrier, String> {
            let text = row.as_str().unwrap_or_default();
            let named = |(joint, name): (usize, &String)| {
                let kind = text.strip_prefix(name.as_str())?.strip_prefix(' ')?;
                KINDS.iter().find(|(_, of)| *of == kind).map(|(kind, _)| (joint, *kind))
            };
            let row = joints.iter().enumerate().find_map(named).ok_or_else(|| format!("there is no limit `{text}`"))?;
            let law = Law { x: [number(x0, "bound.x0")?, number(x2, "bound.x2")?], k: number(k, "bound.k")? };
            let direction = direction.as_i64().ok_or("`bound.direction` has something other than 1, 0 and -1")?;
            Ok(Barrier { law, direction, row })
        };
        let mut barriers: Vec<Vec<Barrier>> = Vec::new();
        for i in 0..laws.len() {
            let best = (!direction[i].is_null()).then(|| barrier(&direction[i], [&x0[i], &x2[i], &k[i]], &row[i]));
            barriers.push(best.transpose()?.into_iter().collect());
        }
        for also in list(at(&json, "bound.also")?, "bound.also")? {
            let [x0, x2, k] = ["x0", "x2", "k"].map(|key| at(also, key));
            let of = barrier(at(also, "direction")?, [x0?, x2?, k?], at(also, "row")?)?;
            let segment = at(also, "segment")?.as_u64().and_then(|i| barriers.get_mut(usize::try_from(i).ok()?));
            segment.ok_or("`bound.also` has a segment that is not there")?.push(of);
        }
        let duration = number(at(&json, "duration")?, "duration")?;
        let lower_bound = number(at(&json, "lower_bound")?, "lower_bound")?;
        Ok(File { joints, knots, coefficients, speed: [speed[0], speed[1]], limits, s, t, laws, barriers, duration, lower_bound })
    }
}

impl Law {
    /// x over t from -1 to 1.
    fn taylor(&self) -> Taylor {
        let [a, b] = self.x.map(Range::of);
        let (half, k) = (Range::of(0.5), Range::of(self.k));
        let mut x = Taylor::constant(a.plus(b).times(half).plus(k.times(half)));
        x.terms[1] = b.minus(a).times(half);
        x.terms[2] = k.times(half).negated();
        x
    }

    /// Whether no Bernstein coefficient is negative, so that x is not.
    fn is_square(&self) -> bool {
        self.x.iter().all(|x| *x >= 0.0) && 0.5 * (self.x[0] + self.x[1]) + self.k >= 0.0
    }

    /// u = x'/2 over t, on a segment of length h.
    fn acceleration(&self, h: Range) -> Option<Taylor> {
        let [a, b] = self.x.map(Range::of);
        let slope = Range::of(1.0).over(h)?;
        let mut u = Taylor::constant(b.minus(a).times(Range::of(0.5)).times(slope));
        u.terms[1] = Range::of(self.k).negated().times(slope);
        Some(u)
    }

    fn square(&self) -> Square {
        let [a, b] = self.x.map(Range::of);
        let middle = a.plus(b).times(Range::of(0.5)).plus(Range::of(self.k));
        Square([a, middle, b])
    }

    /// How long the segment takes, s: 2 h/(v_0 + v_2) A(z), z = -2 k/(v_0 + v_2)².
    fn duration(&self, h: Range) -> Option<Range> {
        let two = Range::of(2.0);
        let v = Range::of(self.x[0]).root()?.plus(Range::of(self.x[1]).root()?);
        if v.high == 0.0 {
            return Range::PI.times(h).over(Range::of(self.k).times(two).root()?);
        }
        let z = Range::of(-self.k).times(two).over(v.times(v))?;
        // A(z) = atanh(sqrt z)/sqrt z grows with z, and so does each step towards its series.
        let [low, high] = [z.low, z.high].map(|z| inverse_tangent(Range::of(z)));
        let factor = Range { low: low?.low, high: high?.high };
        two.times(h).over(v).map(|t| t.times(factor))
    }
}

/// A(z) = 1 + z/3 + z²/5 + ..., by A(z) = 2 A(w)/(1 + sqrt(1 - z)), w = z/(1 + sqrt(1 - z))².
fn inverse_tangent(mut z: Range) -> Option<Range> {
    let (one, two, mut factor) = (Range::of(1.0), Range::of(2.0), Range::of(1.0));
    for _ in 0..12 {
        if z.size() <= 0.01 {
            break;
        }
        let d = one.plus(one.minus(z).root()?);
        z = z.over(d.times(d))?;
        factor = factor.times(two).over(d)?;
    }
    if z.size() > 0.01 {
        return None;
    }
    // What follows the tenth term is below 1e-20.
    let mut sum = Range { low: -1e-20, high: 1e-20 };
    for n in (0..10).rev() {
        sum = sum.times(z).plus(one.over(Range::of(f64::from(2 * n + 1)))?);
    }
    Some(factor.times(sum))
}

/// A limit on a segment: m u + c x + v sqrt(x) + d <= 0, and a curve over dq² besides.
struct Row {
    m: Taylor,
    c: Taylor,
    v: Taylor,
    d: Taylor,
    curve: Option<Curve>,
}

/// The functions of a segment.
struct Functions {
    q: Vec<Taylor>,
    rate: Vec<Taylor>,
    curvature: Vec<Taylor>,
    /// m, c, g.
    torques: [Vec<Taylor>; 3],
    h: Range,
}

struct Checker {
    file: File,
    arm: Arm<Taylor>,
    ranges: Vec<Option<[f64; 2]>>,
}

/// Pairs of rows that exclude larger and larger x, at most.
const LONGEST_CHAIN: usize = 64;

/// A sum of two rows without u, from below: c x + v sqrt(x) + d, and curves over x.
#[derive(Clone)]
struct Sum {
    terms: [Range; 3],
    curves: Vec<Curve>,
    /// Another one that has to be above 0, too.
    other: Option<Box<Sum>>,
}

impl Sum {
    fn value(&self, x: f64) -> f64 {
        let [c, v, d] = self.terms;
        let sum = c.times(Range::of(x)).plus(v.times(Range::of(x).root().unwrap_or(Range::ALL))).plus(d);
        self.curves.iter().fold(sum, |sum, curve| sum.plus(curve.value(x))).low
    }

    /// An x up to which the sum is above 0 behind `from`, as [`Sum::straight`] finds it, with curves replaced by lines below.
    fn reach(&self, from: f64, top: f64) -> Option<f64> {
        let top = match &self.other {
            Some(other) => top.min(other.reach(from, top)?),
            None => top,
        };
        if self.curves.is_empty() {
            return self.straight(from, top).map(|end| if self.other.is_some() { end.min(top) } else { end });
        }
        // Longer parts have lines farther off.
        let ends = [3.0, 0.5, 0.1, 0.02, 4e-3, 8e-4, 1e-4].into_iter().filter_map(|width| {
            let to = (from * (1.0 + width)).min(top);
            let mut of = Sum { curves: Vec::new(), other: None, ..self.clone() };
            for curve in &self.curves {
                let [slope, height] = curve.negated().line(from, to, from).filter(|_| from < to)?;
                let [c, _, d] = &mut of.terms;
                (*c, *d) = (c.minus(slope), d.minus(height));
            }
            of.straight(from, to).map(|end| end.min(to))
        });
        ends.reduce(f64::max)
    }

    /// An x up to which the sum is above 0 behind `from`, infinity where it is so for good; `None` where that is not known.
    fn straight(&self, from: f64, top: f64) -> Option<f64> {
        let [c, v, d] = self.terms.map(|x| x.low);
        if !(self.value(from) >= 0.0 && [c, v, d].iter().all(|x| x.is_finite())) {
            return None;
        }
        // In z = sqrt(x), with a place for the rounding of all that follows.
        let z = from.sqrt();
        let rises = |z: f64| c > 0.0 && 2.0 * c * z >= -v * (1.0 + 1e-12);
        if c >= 0.0 && v >= 0.0 {
            return (c + v > 0.0 || self.value(from) > 0.0).then_some(f64::INFINITY);
        }
        if rises(z) {
            return Some(f64::INFINITY);
        }
        if c > 0.0 {
            // It falls until z = -v/2c, and rises behind.
            let [c, v, d] = self.terms;
            let least = v.times(v).over(c.times(Range::of(4.0))).map_or(f64::NEG_INFINITY, |by| d.minus(by).low);
            if least > 0.0 {
                return Some(f64::INFINITY);
            }
        }
        // Concave, or falling to where it vanishes: above 0 between two places where it is.
        let root = (v * v - 4.0 * c * d).max(0.0).sqrt();
        let zero = match (v >= 0.0, c) {
            (true, _) => (v + root) / (-2.0 * c),
            (false, 0.0) => -d / v,
            (false, _) => 2.0 * d / (root - v),
        };
        let end = [1e-12, 1e-9, 1e-6].into_iter().map(|by| (zero * zero * (1.0 - by)).min(top));
        end.into_iter().find(|&end| end > from && self.value(end) > 0.0)
    }
}

/// Proved bounds of x at the nodes.
struct Nodes(Vec<f64>);

impl Checker {
    fn new(manipulator: &Manipulator, file: File) -> Result<Checker, String> {
        let names: Vec<&String> = manipulator.joints.iter().map(|joint| &joint.name).collect();
        let coupled = |joint: &Joint| joint.has(Feature::CoupledMotor);
        if manipulator.coupling.is_some() || manipulator.joints.iter().any(coupled) {
            return Err("coupled joints and motors are not treated".to_owned());
        }
        if names != file.joints.iter().collect::<Vec<_>>() {
            return Err("its joints are not those of the description".to_owned());
        }
        let parameters = Arm::nominal(&Constants, manipulator).ok_or("a parameter has no value")?;
        let arm = Arm::new(&Constants, manipulator, &parameters).ok_or("the arm has no numbers")?;
        if let Some(i) = manipulator.joints.iter().position(|joint| joint.smooth.is_some()) {
            return Err(format!("joint `{}` has smooth friction, which is not treated", file.joints[i]));
        }
        let range = |joint: &armgen_description::manipulator::Joint| {
            joint.limits.position.as_ref().map(|range| range.clone().map(|x| x.to_f64()))
        };
        let ranges = manipulator.joints.iter().map(range).collect();
        Ok(Checker { file, arm, ranges })
    }

    /// The functions of segment `i`, and its piece.
    fn functions(&self, i: usize) -> Result<Functions, String> {
        let (from, to) = (self.file.s[i], self.file.s[i + 1]);
        let half = Range::of(0.5);
        let h = Range::of(to).minus(Range::of(from));
        let slack = ROUNDING * (1.0 + from.abs());
        let piece = self.file.knots.windows(2).position(|knots| knots[0] <= from + slack && to <= knots[1] + slack);
        let piece = piece.ok_or_else(|| format!("the segment from s = {from} to {to} crosses a knot"))?;
        // s - knot over t from -1 to 1.
        let middle = Range::of(from).plus(Range::of(to)).times(half).minus(Range::of(self.file.knots[piece]));
        let mut s = Taylor::constant(middle);
        s.terms[1] = h.times(half);
        let polynomial = |powers: &[f64], order: usize| {
            let mut sum = Taylor::constant(Range::ZERO);
            for (k, c) in powers.iter().enumerate().rev().filter(|(k, _)| *k >= order) {
                let factor = (k - order + 1..=k).fold(Range::of(1.0), |product, k| product.times(Range::of(k as f64)));
                sum = sum.times(&s).plus(&Taylor::constant(Range::of(*c).times(factor)));
            }
            sum
        };
        let joints = &self.file.coefficients[piece];
        let [q, rate, curvature] = [0, 1, 2].map(|order| joints.iter().map(|of| polynomial(of, order)).collect::<Vec<_>>());
        let (zero, one) = (&self.arm.zero, &self.arm.one);
        let angles =
            q.iter()
                .zip(&self.arm.joints)
                .map(|(q, joint)| if joint.revolute { q.sine_cosine() } else { Some((zero.clone(), one.clone())) });
        let angles = angles.collect::<Option<Vec<_>>>().ok_or_else(|| format!("the angles at s = {from} are too large"))?;
        let none = || vec![zero.clone(); q.len()];
        let arguments = Arguments {
            pi: Vec::new(),
            q: q.clone(),
            dq: none(),
            ddq: none(),
            dqr: none(),
            ddqr: none(),
            tau: none(),
            g0: Vec::new(),
        };
        let state = State::of(arguments, angles, none(), [zero.clone(), one.clone()]);
        let pose = Pose::new(&self.arm, &state);
        let torques = |rates: &[Taylor], accelerations: &[Taylor], gravity| {
            let motion = Motion { rates: rates.to_vec(), accelerations: accelerations.to_vec(), gravity };
            ArmMotion::new(&self.arm, &pose, motion).torques()
        };
        let inertial = torques(&none(), &rate, self.arm.nothing());
        let velocity = torques(&rate, &curvature, self.arm.nothing());
        let gravity = torques(&none(), &none(), self.arm.gravity.clone());
        let gravity = gravity.iter().zip(spring_torques(&self.arm, &q)).map(|(a, b)| a.plus(&b)).collect();
        Ok(Functions { q, rate, curvature, torques: [inertial, velocity, gravity], h })
    }

    /// A limit on a segment; `None` without a limit.
    fn row(&self, of: &Functions, joint: usize, kind: Kind) -> Option<Row> {
        let limits = &self.file.limits;
        let (zero, bound) = (Taylor::constant(Range::ZERO), |x: f64| Taylor::constant(Range::of(x)));
        let upper = |m: &Taylor, c: &Taylor, v: Taylor, d: Taylor, limit: f64| Row {
            m: m.clone(),
            c: c.clone(),
            v,
            d: d.minus(&bound(limit)),
            curve: None,
        };
        let lower = |m: &Taylor, c: &Taylor, v: Taylor, d: Taylor, limit: f64| Row {
            m: m.negated(),
            c: c.negated(),
            v: v.negated(),
            d: bound(limit).minus(&d),
            curve: None,
        };
        let (rate, curvature) = (&of.rate[joint], &of.curvature[joint]);
        Some(match kind {
            Kind::Speed => {
                let limit = Range::of(limits.velocity[joint]?);
                let d = Taylor::constant(limit.times(limit).negated());
                Row { m: zero.clone(), c: rate.times(rate), v: zero, d, curve: None }
            }
            Kind::AccelerationHigh => upper(rate, curvature, zero.clone(), zero, limits.acceleration[joint]?),
            Kind::AccelerationLow => lower(rate, curvature, zero.clone(), zero, -limits.acceleration[joint]?),
            Kind::TorqueHigh | Kind::TorqueLow => {
                let [low, high] = limits.effort[joint];
                let [m, c, g] = [0, 1, 2].map(|part| &of.torques[part][joint]);
                let arm = &self.arm.joints[joint];
                let motor = arm.motor.as_ref().map(|motor| motor.rates[0].1.times(&motor.rates[0].1).times(&motor.viscous));
                let viscous = motor.map_or_else(|| arm.viscous.clone(), |motor| motor.plus(&arm.viscous));
                let dry = arm.coulomb.plus(&arm.load.times(&g.magnitude()));
                let mut d = g.plus(&dry.directed(rate)).plus(&arm.offset);
                let v = viscous.times(rate);
                let [cubic, stribeck, velocity] = [&arm.cubic, &arm.stribeck, &arm.stribeck_velocity].map(|of| of.terms[0]);
                let mut curve = None;
                if [cubic, stribeck] != [Range::ZERO; 2] {
                    match rate.direction() {
                        Some(sign) => curve = Some(Curve { cubic, stribeck, velocity }.times(sign)),
                        // Nothing is proved of a joint that turns round within a segment.
                        None => d.rest = Range::ALL,
                    }
                }
                if kind == Kind::TorqueHigh {
                    Row { curve, ..upper(m, c, v, d, high?) }
                } else {
                    Row { curve: curve.map(|curve| curve.negated()), ..lower(m, c, v, d, low?) }
                }
            }
        })
    }

    /// A place for messages: the fraction `t` of segment `i`, -1 to 1.
    fn place(&self, i: usize, t: f64) -> f64 {
        let (a, b) = (self.file.s[i], self.file.s[i + 1]);
        a + (b - a) * 0.5 * (1.0 + t)
    }

    /// The motion keeps all limits on segment `i`.
    fn motion(&self, i: usize, of: &Functions) -> Result<(), String> {
        let law = &self.file.laws[i];
        let segment = |what: String, t: f64| format!("not proved: at s = {} {what}", self.place(i, t));
        if !law.is_square() {
            return Err(segment("ds² may be negative".to_owned(), 0.0));
        }
        let (x, u) = (law.taylor(), law.acceleration(of.h).ok_or_else(|| segment("the segment has no length".to_owned(), 0.0))?);
        for (joint, name) in self.file.joints.iter().enumerate() {
            for (kind, text) in KINDS {
                let Some(row) = self.row(of, joint, kind) else { continue };
                let smooth = row.m.times(&u).plus(&row.c.times(&x)).plus(&row.d);
                let curved = row.curve.map(|curve| (curve, of.rate[joint].times(&of.rate[joint]).times(&x)));
                at_most_zero(&smooth, Some((&row.v, &x)), curved.as_ref(), &law.square())
                    .map_err(|t| segment(format!("the motion may exceed the limit `{name} {text}`"), t))?;
            }
            if let Some([low, high]) = self.ranges[joint] {
                let q = &of.q[joint];
                let [above, below] = [q.minus(&Taylor::constant(Range::of(high))), Taylor::constant(Range::of(low)).minus(q)];
                for side in [above, below] {
                    // A path that ends at a limit keeps it to rounding.
                    let side = side.minus(&Taylor::constant(Range::of((high - low) * 1e-9)));
                    at_most_zero(&side, None, None, &law.square())
                        .map_err(|t| segment(format!("joint `{name}` may leave its range"), t))?;
                }
            }
        }
        Ok(())
    }

    /// The row of the barrier of segment `i` lets no motion through.
    fn barrier(&self, i: usize, of: &Functions, barrier: &Barrier) -> Result<(), String> {
        let (joint, kind) = barrier.row;
        let name = format!(
            "barrier by `{} {}`",
            self.file.joints[joint],
            KINDS.iter().find(|(of, _)| *of == kind).map_or("", |of| of.1)
        );
        let fault = |what: &str, t: f64| format!("not proved: at s = {} the {name} {what}", self.place(i, t));
        let law = &barrier.law;
        if !law.is_square() {
            return Err(fault("may be negative", 0.0));
        }
        let row = self.row(of, joint, kind).ok_or_else(|| fault("has no limit", 0.0))?;
        let m = match (barrier.direction, kind) {
            (0, Kind::Speed) => None,
            (1, _) => Some(row.m.negated()),
            (-1, _) => Some(row.m.clone()),
            _ => return Err(fault("has no direction", 0.0)),
        };
        if let Some(m) = m {
            // Above zero, not at it.
            let m = m.plus(&Taylor::constant(Range::of(f64::MIN_POSITIVE)));
            at_most_zero(&m, None, None, &law.square()).map_err(|t| fault("has an inertial term that may vanish", t))?;
        }
        let (x, u) = (law.taylor(), law.acceleration(of.h).ok_or_else(|| fault("has no length", 0.0))?);
        let smooth = row.m.times(&u).plus(&row.c.times(&x)).plus(&row.d).negated();
        let curved = row.curve.map(|curve| (curve.negated(), of.rate[joint].times(&of.rate[joint]).times(&x)));
        at_most_zero(&smooth, Some((&row.v.negated(), &x)), curved.as_ref(), &law.square())
            .map_err(|t| fault("may let a motion through", t))
    }

    /// Pairs of rows at the end (`t` = 1) or the start (-1) of a segment: where their sum is above 0, no u keeps both. And the x that no speed
    /// exceeds there.
    fn pairs(&self, of: &Functions, t: f64) -> (Vec<Sum>, f64) {
        let at = |function: &Taylor| function.at(t);
        let (mut top, mut rows, mut flat) = (f64::INFINITY, Vec::new(), Vec::new());
        for joint in 0..self.file.joints.len() {
            for (kind, _) in KINDS {
                let Some(Row { m, c, v, d, curve }) = self.row(of, joint, kind) else { continue };
                let (m, c, v, mut d) = (at(&m), at(&c), at(&v), at(&d));
                let curve = curve.map(|curve| {
                    let (curve, rest) = curve.over_square(at(&of.rate[joint]));
                    d = d.plus(rest);
                    curve
                });
                if kind == Kind::Speed && c.low > 0.0 {
                    top = top.min(d.negated().over(c).map_or(f64::INFINITY, |x| x.high));
                } else if m.low > 0.0 || m.high < 0.0 {
                    // c x + v sqrt(x) + d <= -m u, by |m|.
                    let size = if m.low > 0.0 { m } else { m.negated() };
                    let by = |x: Range| x.over(size).unwrap_or(Range::ALL);
                    let curve = curve.map(|curve| curve.times(by(Range::of(1.0))));
                    rows.push((m.low > 0.0, [by(c), by(v), by(d)], curve));
                } else {
                    flat.push((m.size(), [c, v, d], curve));
                }
            }
        }
        let lower = |sign: bool| rows.iter().filter(move |row| row.0 == sign).map(|row| (&row.1, row.2));
        let mut sums = Vec::new();
        for (a, of_a) in lower(true) {
            for (b, of_b) in lower(false) {
                let terms = [0, 1, 2].map(|k| Range::of(a[k].plus(b[k]).low));
                sums.push(Sum { terms, curves: of_a.into_iter().chain(of_b).collect(), other: None });
                // A joint that turns round: |m| is at most `size`, and u lies between the two rows.
                for (size, row, curve) in &flat {
                    let size = Range::of(*size);
                    let by = |other: &[Range; 3], k: usize| row[k].plus(other[k].times(size)).low;
                    let sum = |terms: [f64; 3], of: Option<Curve>, other: Option<Box<Sum>>| {
                        let curves = curve.iter().copied().chain(of.map(|of| of.times(size))).collect();
                        Sum { terms: terms.map(Range::of), curves, other }
                    };
                    sums.push(if of_a.is_none() && of_b.is_none() {
                        sum([0, 1, 2].map(|k| by(a, k).min(by(b, k))), None, None)
                    } else {
                        let other = Box::new(sum([0, 1, 2].map(|k| by(b, k)), of_b, None));
                        sum([0, 1, 2].map(|k| by(a, k)), of_a, Some(other))
                    });
                }
            }
        }
        (sums, top)
    }

    /// Whether the rows on both sides of node `i` exclude every x above `most`: from there on, one pair of rows after the other.
    fn excludes(&self, functions: &[Functions], i: usize, most: f64) -> bool {
        let sides = [(i.checked_sub(1).and_then(|i| functions.get(i)), 1.0), (functions.get(i), -1.0)];
        let (mut pairs, mut top) = (Vec::new(), f64::INFINITY);
        for (of, t) in sides.into_iter().filter_map(|(of, t)| Some((of?, t))) {
            let (own, highest) = self.pairs(of, t);
            pairs.extend(own);
            top = top.min(highest);
        }
        let mut x = most;
        for _ in 0..LONGEST_CHAIN {
            if x >= top {
                return true;
            }
            let next = pairs.iter().filter_map(|pair| pair.reach(x, top)).fold(x, f64::max);
            if next <= x {
                return false;
            }
            x = next;
        }
        x >= top
    }

    /// The bound of the file.
    fn bound(&self, functions: &[Functions]) -> Result<Range, String> {
        let file = &self.file;
        let count = file.laws.len();
        let mut nodes = Nodes(vec![f64::INFINITY; count + 1]);
        nodes.0[0] = Range::of(file.speed[0]).times(Range::of(file.speed[0])).high;
        nodes.0[count] = Range::of(file.speed[1]).times(Range::of(file.speed[1])).high;
        let mut open: Vec<(usize, usize)> = Vec::new();
        for (i, of) in file.barriers.iter().enumerate() {
            open.extend((0..of.len()).map(|which| (i, which)));
        }
        // Each barrier bounds x at its ends, which another may need.
        loop {
            let before = open.len();
            for backwards in [false, true] {
                if backwards {
                    open.reverse();
                }
                open.retain(|(i, which)| {
                    let Barrier { law: Law { x: [x0, x2], .. }, direction, .. } = file.barriers[*i][*which];
                    let holds = match direction {
                        1 => nodes.holds(self, functions, *i, x0),
                        -1 => nodes.holds(self, functions, i + 1, x2),
                        _ => true,
                    };
                    if holds {
                        nodes.0[*i] = nodes.0[*i].min(x0);
                        nodes.0[i + 1] = nodes.0[i + 1].min(x2);
                    }
                    !holds
                });
            }
            open.sort_unstable();
            if open.is_empty() || open.len() == before {
                break;
            }
        }
        let mut sum = Range::ZERO;
        for (i, of) in file.barriers.iter().enumerate() {
            let proved = of.iter().enumerate().filter(|(which, _)| open.binary_search(&(i, *which)).is_err());
            let times = proved.filter_map(|(_, barrier)| barrier.law.duration(functions[i].h));
            sum = sum.plus(times.max_by(|a, b| a.low.total_cmp(&b.low)).unwrap_or(Range::ZERO));
        }
        if sum.low * (1.0 + 1e-9) < file.lower_bound {
            let at = open.first().map_or(String::new(), |(i, _)| {
                format!("; the barrier at s = {} needs a bound at its end that nothing proves", file.s[*i])
            });
            return Err(format!("not proved: no motion takes less than {} s; proved are {} s{at}", file.lower_bound, sum.low));
        }
        Ok(sum)
    }
}

impl Nodes {
    /// Whether x is at most `most` at node `i`.
    fn holds(&mut self, checker: &Checker, functions: &[Functions], i: usize, most: f64) -> bool {
        if self.0[i] <= most {
            return true;
        }
        let holds = checker.excludes(functions, i, most);
        if holds {
            self.0[i] = most;
        }
        holds
    }
}

/// Proves a timing of an arm.
///
/// # Errors
/// The claim that is not proved, with its place, or why the file cannot be read.
pub fn check(manipulator: &Manipulator, text: &str) -> Result<Proved, String> {
    let checker = Checker::new(manipulator, File::read(text)?)?;
    let file = &checker.file;
    path_is_smooth(file)?;
    for (end, x) in [file.laws.first().map(|law| law.x[0]), file.laws.last().map(|law| law.x[1])].into_iter().enumerate() {
        let speed = file.speed[end];
        if x.is_none_or(|x| (x.max(0.0).sqrt() - speed).abs() > 1e-9 * (1.0 + speed)) {
            return Err(format!("not proved: the motion has another speed than {speed} at an end"));
        }
    }
    let found = crate::check::parallel_map(&(0..file.laws.len()).collect::<Vec<_>>(), |i| {
        let functions = checker.functions(*i)?;
        checker.motion(*i, &functions)?;
        for barrier in &file.barriers[*i] {
            checker.barrier(*i, &functions, barrier)?;
        }
        let duration = file.laws[*i].duration(functions.h);
        let duration = duration.ok_or_else(|| format!("not proved: the motion does not leave s = {}", file.s[*i]))?;
        if (file.t[*i + 1] - file.t[*i] - duration.low).abs() > 1e-9 * (1.0 + duration.low) {
            return Err(format!("`grid.t` is not the time of the motion at s = {}", file.s[*i]));
        }
        Ok((functions, duration))
    });
    let (mut functions, mut sum) = (Vec::new(), Range::ZERO);
    for found in found {
        let (of, duration) = found?;
        functions.push(of);
        sum = sum.plus(duration);
    }
    if !(sum.high <= file.duration && file.duration - sum.high < 1e-8 * (1.0 + sum.high)) {
        return Err(format!("not proved: the motion takes {} s, not {} s", sum.high, file.duration));
    }
    let bound = checker.bound(&functions)?;
    Ok(Proved { segments: functions.len(), duration: file.duration, lower_bound: bound.low.min(file.lower_bound) })
}

/// q and q' are continuous at the knots.
fn path_is_smooth(file: &File) -> Result<(), String> {
    for (piece, pair) in file.coefficients.windows(2).enumerate() {
        let t = file.knots[piece + 1] - file.knots[piece];
        for (joint, (before, after)) in pair[0].iter().zip(&pair[1]).enumerate() {
            let value = before.iter().rev().fold(0.0, |sum, c| sum * t + c);
            let rate = before.iter().enumerate().skip(1).rev().fold(0.0, |sum, (k, c)| sum * t + k as f64 * c);
            let off = |a: f64, b: f64| (a - b).abs() > 1e-9 * (1.0 + a.abs());
            if off(value, after[0]) || off(rate, after.get(1).copied().unwrap_or(0.0)) {
                let name = &file.joints[joint];
                return Err(format!("not proved: joint `{name}` jumps at s = {}", file.knots[piece + 1]));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Range, Sum};

    /// From a place on, a sum is above 0 up to its reach, and not above 0 right behind that.
    #[test]
    fn a_sum_reaches_to_its_next_zero() {
        let mut state = 1u64;
        let mut random = |most: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 40) % 17) as f64 / 16.0 * most
        };
        let (top, mut ends, mut forever) = (50.0, 0, 0);
        for _ in 0..5000 {
            let [c, v, d] = [0, 1, 2].map(|_| random(8.0) - 4.0);
            let terms = [c, v, d].map(Range::of);
            let (sum, from) = (Sum { terms, curves: Vec::new(), other: None }, random(4.0));
            let value = |x: f64| c * x + v * x.sqrt() + d;
            let Some(end) = sum.reach(from, top) else {
                assert!(value(from) < 1e-3, "{c} {v} {d} from {from}");
                continue;
            };
            assert!(
                (1..200).all(|k| value(from + (end.min(top) - from) * f64::from(k) / 200.0) > 0.0),
                "{c} {v} {d} from {from}: {end}"
            );
            if end < top {
                // It touches 0 where two zeros meet.
                assert!(value(end * (1.0 + 1e-5)) < 1e-6, "{c} {v} {d} from {from}: {end}");
                ends += 1;
            } else {
                forever += 1;
            }
        }
        assert!(ends > 500 && forever > 500, "{ends} {forever}");
    }
}
