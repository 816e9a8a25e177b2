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
mod bound;
mod curve;
mod file;
mod law;
mod rows;
mod taylor;

use armgen_description::manipulator::Manipulator;

use crate::values::element::Element;
use bernstein::at_most_zero;
use file::{Barrier, File};
use rows::{Checker, Functions};
use taylor::{Range, Taylor};

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

impl Checker {
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
        for (joint, kind, name) in self.file.rows() {
            let Some(row) = self.row(of, joint, kind) else { continue };
            let smooth = row.m.times(&u).plus(&row.c.times(&x)).plus(&row.d);
            let curved = row.curve.map(|curve| (curve, of.rate[joint].times(&of.rate[joint]).times(&x)));
            at_most_zero(&smooth, Some((&row.v, &x)), curved.as_ref(), &law.square())
                .map_err(|t| segment(format!("the motion may exceed the limit `{name}`"), t))?;
        }
        for (joint, name) in self.file.joints.iter().enumerate() {
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
        let mut rows = self.file.rows();
        let name =
            rows.find(|row| (row.0, row.1) == barrier.row).map_or_else(String::new, |row| format!("barrier by `{}`", row.2));
        let fault = |what: &str, t: f64| format!("not proved: at s = {} the {name} {what}", self.place(i, t));
        let law = &barrier.law;
        if !law.is_square() {
            return Err(fault("may be negative", 0.0));
        }
        let row = self.row(of, joint, kind).ok_or_else(|| fault("has no limit", 0.0))?;
        let m = match (barrier.direction, kind) {
            (0, kind) if kind.is_speed() => None,
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
    for i in (0..file.s.len()).filter(|i| file.rests(*i)) {
        if file.laws.get(i).is_none_or(|law| law.x[0] != 0.0) {
            return Err(format!("not proved: the motion does not rest at s = {}, where the path stops", file.s[i]));
        }
    }
    let found = crate::values::check::parallel_map(&(0..file.laws.len()).collect::<Vec<_>>(), |i| {
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

/// q and q' are continuous at the knots; q alone where the motion rests.
fn path_is_smooth(file: &File) -> Result<(), String> {
    for (piece, pair) in file.coefficients.windows(2).enumerate() {
        let t = file.knots[piece + 1] - file.knots[piece];
        for (joint, (before, after)) in pair[0].iter().zip(&pair[1]).enumerate() {
            let value = before.iter().rev().fold(0.0, |sum, c| sum * t + c);
            let rate = before.iter().enumerate().skip(1).rev().fold(0.0, |sum, (k, c)| sum * t + k as f64 * c);
            let off = |a: f64, b: f64| (a - b).abs() > 1e-9 * (1.0 + a.abs());
            let rests = file.stops.contains(&file.knots[piece + 1]);
            if off(value, after[0]) || !rests && off(rate, after.get(1).copied().unwrap_or(0.0)) {
                let name = &file.joints[joint];
                return Err(format!("not proved: joint `{name}` jumps at s = {}", file.knots[piece + 1]));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{json, Value};

    /// The fault of a timing of a slide of 1 kg with this range; "" where it is proved.
    fn fault(range: &str, timing: &Value) -> String {
        let text = format!(
            "name: slide\nconvention: standard\ngravity: [0, 0, 0]\njoints:\n  - {{name: slide, type: prismatic, a: 0, alpha: 0, d: 0, \
             theta: 0, limits: {{position: {range}}}, link: {{mass: 1, com: [0, 0, 0], inertia: {{}}}}}}\n"
        );
        let source = armgen_description::source::Source::new("slide", &text);
        let (manipulator, _) = armgen_codegen::validate::read(&source).0.expect("a valid arm");
        check(&manipulator, &timing.to_string()).err().unwrap_or_default()
    }

    /// At the even speed ds = 0.9 over two pieces of 1/2; x <= 1.001 by the limit of speed.
    fn even() -> Value {
        json!({"joints": ["slide"], "path": {"knots": [0, 0.5, 1], "coefficients": [[[0, 1]], [[0.5, 1]]]},
            "ends": {"speed": [0.9, 0.9]}, "limits": {"velocity": [1], "acceleration": [0.01], "effort": [[null, null]]},
            "duration": 1.111_111_112, "lower_bound": 0.9995,
            "grid": {"s": [0, 0.5, 1], "t": [0, 0.555_555_555_6, 1.111_111_111_2], "x": [0.81, 0.81, 0.81], "k": [0, 0]},
            "bound": {"direction": [0, 0], "x0": [1.001, 1.001], "x2": [1.001, 1.001], "k": [0, 0],
                "row": ["slide speed", "slide speed"], "also": []}})
    }

    #[test]
    fn claims_without_a_proof_are_refused() {
        let refused = |range: &str, why: &str, pairs: &[(&str, Value)]| {
            let mut timing = even();
            for (pointer, value) in pairs {
                *timing.pointer_mut(pointer).expect("a value") = value.clone();
            }
            let found = fault(range, &timing);
            assert!(found.contains(why) && found.is_empty() == why.is_empty(), "{why}: {found}");
        };
        refused("[-5, 5]", "", &[]);
        refused("[-5, 0.7]", "may leave its range", &[]);
        refused("[-5, 5]", "jumps at s = 0.5", &[("/path/coefficients/1/0/0", json!(0.6))]);
        refused("[-5, 5]", "another speed", &[("/ends/speed/0", json!(0.8))]);
        // A second barrier of a segment adds nothing.
        let again = json!([{"segment": 1, "direction": 0, "x0": 1.001, "x2": 1.001, "k": 0, "row": "slide speed"}]);
        refused("[-5, 5]", "proved are 0.9995", &[("/bound/also", again), ("/lower_bound", json!(1.4))]);
        // Barriers by u <= 0.01 and u >= -0.01 from a speed at their end that the motion need not have.
        for (direction, row, [x0, x2], at) in [
            (1, "slide acceleration high", [0.0001, 0.0102], "the barrier at s = 0.5 needs a bound at its end"),
            (-1, "slide acceleration low", [0.0102, 0.0001], "the barrier at s = 0.5 needs a bound at its end"),
        ] {
            let of = [("direction", json!(direction)), ("row", json!(row)), ("x0", json!(x0)), ("x2", json!(x2))];
            let mut pairs: Vec<(String, Value)> = of.into_iter().map(|(key, of)| (format!("/bound/{key}/1"), of)).collect();
            pairs.push(("/lower_bound".to_owned(), json!(5)));
            refused("[-5, 5]", at, &pairs.iter().map(|(key, of)| (key.as_str(), of.clone())).collect::<Vec<_>>());
        }
        // q' = 2 s - 1 vanishes in the middle of the second segment: no barrier by u alone, though 2 x + q' u is above the limit on all of it.
        let path = json!([[[0, -1, 1]], [[-0.25, 0, 1]]]);
        let turning = [
            ("/path/coefficients", path),
            ("/limits/acceleration/0", json!(1.7)),
            ("/grid/s/1", json!(0.3)),
            ("/grid/t/1", json!(0.333_333_333_4)),
            ("/path/knots/1", json!(0.3)),
            ("/path/coefficients/1/0", json!([-0.21, -0.4, 1])),
            ("/bound/direction/0", json!(null)),
            ("/bound/direction/1", json!(1)),
            ("/bound/row/1", json!("slide acceleration high")),
        ];
        refused("[-5, 5]", "has an inertial term that may vanish", &turning);
    }
}
