//! The time that no motion beats: which barriers have a bound at their end, and the sum of their durations.

use super::curve::Curve;
use super::file::Barrier;
use super::law::Law;
use super::rows::{Checker, Functions, Row};
use super::taylor::{Range, Taylor};

/// Pairs of rows that exclude larger and larger x, at most.
const LONGEST_CHAIN: usize = 64;

/// A sum of two rows without u, from below: c x + v sqrt(x) + d, and curves over x.
#[derive(Clone, Debug)]
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
    /// Pairs of rows at the end (`t` = 1) or the start (-1) of a segment: where their sum is above 0, no u keeps both. And the x that no speed
    /// exceeds there.
    fn pairs(&self, of: &Functions, t: f64) -> (Vec<Sum>, f64) {
        let at = |function: &Taylor| function.at(t);
        let (mut top, mut rows, mut flat) = (f64::INFINITY, Vec::new(), Vec::new());
        for (joint, kind, _) in self.file.rows() {
            let Some(Row { m, c, v, d, curve }) = self.row(of, joint, kind) else { continue };
            let (m, c, v, mut d) = (at(&m), at(&c), at(&v), at(&d));
            let curve = curve.map(|curve| {
                let (curve, rest) = curve.over_square(at(&of.rate[joint]));
                d = d.plus(rest);
                curve
            });
            if kind.is_speed() && c.low > 0.0 {
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
    pub(super) fn bound(&self, functions: &[Functions]) -> Result<Range, String> {
        let file = &self.file;
        let count = file.laws.len();
        let mut nodes = Nodes(vec![f64::INFINITY; count + 1]);
        nodes.0[0] = Range::of(file.speed[0]).times(Range::of(file.speed[0])).high;
        nodes.0[count] = Range::of(file.speed[1]).times(Range::of(file.speed[1])).high;
        nodes.0.iter_mut().enumerate().filter(|(i, _)| file.rests(*i)).for_each(|(_, x)| *x = 0.0);
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

#[cfg(test)]
mod tests {
    use super::super::file::Kind;
    use super::*;

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

    /// With curves a sum is above 0 on all of its reach, and reaches on wherever it has something to spare.
    #[test]
    fn a_sum_with_curves_is_above_zero_on_its_reach() {
        let mut state = 1u64;
        let mut random = |most: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 40) % 17) as f64 / 16.0 * most
        };
        let (top, mut ends) = (50.0, 0);
        for _ in 0..3000 {
            let [c, v, d, cubic, stribeck] = [0, 1, 2, 3, 4].map(|_| random(8.0) - 4.0);
            let (velocity, from) = (0.05 + random(1.0), 0.01 + random(4.0));
            let curves = vec![Curve { cubic: Range::of(cubic), stribeck: Range::of(stribeck), velocity: Range::of(velocity) }];
            let sum = Sum { terms: [c, v, d].map(Range::of), curves, other: None };
            let value = |x: f64| c * x + v * x.sqrt() + d + cubic * x.powf(1.5) + stribeck * (-x.sqrt() / velocity).exp();
            let Some(end) = sum.reach(from, top) else {
                assert!(value(from) < 0.1, "{sum:?} from {from}");
                continue;
            };
            let places = (1..=200).map(|k| from + (end.min(top) - from) * f64::from(k) / 200.0);
            places.for_each(|x| assert!(value(x) > -1e-12, "{sum:?} from {from} to {end}: at {x}"));
            ends += usize::from(end < top);
        }
        assert!(ends > 500, "{ends}");
    }

    const FRICTION: &str = "friction: {viscous: 1.5, coulomb: 1, cubic: 0.4, stribeck: {torque: 2, velocity: 0.3}}";

    /// Slides along and across, each of these joints with its name and what it has, under gravity along the first axis.
    fn slides(gravity: &str, joints: &[(&str, &str)], coefficients: &str, limits: &str, s: &str) -> Checker {
        let mut text = format!("name: slides\nconvention: standard\ngravity: [0, 0, {gravity}]\njoints:\n");
        for (name, has) in joints {
            text += &format!("  - {{name: {name}, type: prismatic, a: 0, alpha: pi/2, d: 0, theta: 0, {has}}}\n");
        }
        let source = armgen_description::source::Source::new("slides", &text);
        let (manipulator, _) = armgen_codegen::validate::read(&source).0.expect("a valid arm");
        let names: Vec<&str> = joints.iter().map(|joint| joint.0).collect();
        // x and the barriers do not matter here.
        let file = format!(
            r#"{{"joints": {names:?}, "path": {{"knots": [0, 1], "coefficients": [[{coefficients}]]}}, "ends": {{"speed": [0, 0]}},
            "limits": {{{limits}}}, "duration": 1, "lower_bound": 1,
            "grid": {{"s": {s}, "t": {s}, "x": {s}, "k": [0, 0, 0]}}, "bound": {{"direction": [null, null, null],
            "x0": [0, 0, 0], "x2": [0, 0, 0], "k": [0, 0, 0], "row": ["", "", ""], "also": []}}}}"#
        );
        Checker::new(&manipulator, super::super::file::File::read(&file).expect("a file")).expect("slides")
    }

    const LIMITS: &str = r#""velocity": [5], "acceleration": [3], "effort": [[-12, 10]]"#;

    /// A slide of 2 kg with this friction.
    fn slide(friction: &str, coefficients: &str, s: &str) -> Checker {
        let has = format!("{friction}, link: {{mass: 2, com: [0, 0, 0], inertia: {{}}}}");
        slides("0", &[("slide", &has)], coefficients, LIMITS, s)
    }

    /// Each row is its limit by the closed form of the torque: a motor, a spring, all terms of friction, both directions, both signs of g.
    #[test]
    fn rows_are_the_limits_of_the_arm() {
        let friction = FRICTION.replace("coulomb: 1", "coulomb: 1, load: 0.1, offset: 0.3");
        let has = format!(
            "{friction}, motor: {{ratio: 10, inertia: 0.01, viscous: 0.002}}, spring: {{stiffness: 100, rest: 0.5}}, \
             link: {{mass: 2, com: [0, 0, 0], inertia: {{}}}}"
        );
        for (direction, coefficients) in [(1.0f64, "[0, 1]"), (-1.0, "[1, -1]")] {
            let checker = slides("-9.81", &[("slide", &has)], coefficients, LIMITS, "[0, 0.25, 0.75, 1]");
            for (i, from) in [(0, 0.0), (2, 0.75)] {
                let of = checker.functions(i).expect("functions");
                for t in [-1.0, 0.3, 1.0] {
                    let s = from + 0.125 * (1.0 + t);
                    let q = if direction > 0.0 { s } else { 1.0 - s };
                    let (x, u, g): (f64, f64, f64) = (0.7, -1.3, 19.62 + 100.0 * (q - 0.5));
                    let (dq, ddq) = (direction * x.sqrt(), direction * u);
                    let dry = 1.0 + 0.1 * g.abs() + 2.0 * (-dq.abs() / 0.3).exp();
                    let torque = 3.0 * ddq + 1.7 * dq + g + 0.3 + 0.4 * dq.powi(3) + direction * dry;
                    for (kind, expected) in [
                        (Kind::TorqueHigh, torque - 10.0),
                        (Kind::TorqueLow, -12.0 - torque),
                        (Kind::AccelerationHigh, ddq - 3.0),
                        (Kind::AccelerationLow, -3.0 - ddq),
                        (Kind::Speed, dq * dq - 25.0),
                    ] {
                        let row = checker.row(&of, 0, kind).expect("a limit");
                        let (x, root) = (Range::of(x), Range::of(x).root().expect("a root"));
                        let mut sum = row.m.at(t).times(Range::of(u)).plus(row.c.at(t).times(x));
                        sum = sum.plus(row.v.at(t).times(root)).plus(row.d.at(t));
                        if let Some(curve) = row.curve {
                            let (over, rest) = curve.over_square(of.rate[0].at(t));
                            sum = sum.plus(over.value(x.low)).plus(rest);
                        }
                        let off = (sum.low - expected).abs().max((sum.high - expected).abs());
                        assert!(off < 1e-9, "{kind:?} {direction} at {s}: {sum:?}, not {expected}");
                    }
                }
            }
        }
    }

    /// Where a joint turns round within a segment, its dry friction has both signs, whichever has more of the segment.
    #[test]
    fn dry_friction_has_both_signs_where_a_joint_turns_round() {
        let checker = slide("friction: {coulomb: 1}", "[0, -1, 1]", "[0, 0.4, 0.9, 1]");
        let row = checker.row(&checker.functions(1).expect("functions"), 0, Kind::TorqueHigh).expect("a limit");
        let d = row.d.at(0.9);
        assert!(d.low <= -11.0 && d.high >= -9.0, "{d:?}");
    }

    /// The second slide has an inertial term m within ±1, of either sign: 4 x - F(v) + m u <= 4 excludes x only where all u that the first
    /// slide has, -3 <= u <= (10 - F(v))/2 and 3, exceed that.
    #[test]
    fn a_row_without_a_sign_excludes_with_every_acceleration() {
        let has = format!("{FRICTION}, link: {{mass: 1, com: [0, 0, 0], inertia: {{}}}}");
        let limits = r#""velocity": [5, null], "acceleration": [3, null], "effort": [[-12, 10], [null, 4]]"#;
        let checker = slides("0", &[("along", &has), ("across", &has)], "[0, 1], [0, -1, 2]", limits, "[0, 0.1, 0.2, 1]");
        let mut functions: Vec<Functions> = (0..3).map(|i| checker.functions(i).expect("functions")).collect();
        functions[0].torques[0][1] = Taylor { rest: Range::both(1.0), ..Taylor::constant(Range::ZERO) };
        let friction = |v: f64| 1.5 * v + 1.0 + 0.4 * v.powi(3) + 2.0 * (-v / 0.3).exp();
        let (mut low, mut high) = (0.5, 2.5);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *if 4.0 * middle * middle - friction(middle) > 7.0 { &mut high } else { &mut low } = middle;
        }
        assert!(checker.excludes(&functions, 0, high * high * 1.001), "{high}");
        assert!(!checker.excludes(&functions, 0, high * high * 0.999), "{high}");
    }

    /// 2 u + F(v) <= 10 and u >= -3 exclude all v with F(v) > 16.
    #[test]
    fn two_rows_with_curves_exclude_what_no_acceleration_keeps() {
        let checker = slide(FRICTION, "[0, 1]", "[0, 0.25, 0.75, 1]");
        let functions: Vec<Functions> = (0..3).map(|i| checker.functions(i).expect("functions")).collect();
        let friction = |v: f64| 1.5 * v + 1.0 + 0.4 * v.powi(3) + 2.0 * (-v / 0.3).exp();
        let (mut low, mut high) = (0.0, 5.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *if friction(middle) > 16.0 { &mut high } else { &mut low } = middle;
        }
        for node in 0..4 {
            assert!(checker.excludes(&functions, node, high * high * 1.001), "{node}");
            assert!(!checker.excludes(&functions, node, high * high * 0.999), "{node}");
        }
    }

    /// q = s² - s turns round at 0.5: of the torque there nothing is known.
    #[test]
    fn nothing_is_proved_of_a_joint_that_turns_round_within_a_segment() {
        let checker = slide(FRICTION, "[0, -1, 1]", "[0, 0.25, 0.75, 1]");
        for (i, known) in [true, false, true].into_iter().enumerate() {
            let of = checker.functions(i).expect("functions");
            for kind in [Kind::TorqueHigh, Kind::TorqueLow] {
                let row = checker.row(&of, 0, kind).expect("a limit");
                assert_eq!((row.curve.is_some(), row.d.rest != Range::ALL), (known, known), "{i}");
            }
        }
    }
}
