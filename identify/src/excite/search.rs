//! The search for a motion: many starts, changes of the best, limited-memory quasi-Newton steps, limits by an augmented Lagrangian on samples.
//!
//! Minimised is -log det M per column, M the mean over time of A'A with rows of A divided by E. Its derivative by A is -2 A M^-1, from
//! where tapes go back to q, dq, ddq. Limits are |x - middle| <= half; their multipliers belong to samples.

use nalgebra::DMatrix;

use super::model::{Limits, Model};
use super::motion::Motion;
use super::tape::{Lanes, Room, LANES};
use crate::prepare::Friction;

/// A bound of an entry of a frame's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// The function of frames.
    pub(super) function: usize,
    /// The place in its results.
    pub(super) entry: usize,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// What is searched.
pub(super) struct Search<'a> {
    pub(super) model: &'a Model,
    pub(super) limits: &'a Limits,
    pub(super) bounds: &'a [Bound],
    /// The posture before the lead-in.
    pub(super) start: &'a [f64],
    /// E, by joint.
    pub(super) scale: &'a [f64],
    pub(super) w: f64,
    pub(super) harmonics: usize,
    /// The part of each limit that is used.
    pub(super) share: f64,
}

/// Numbers that are the same everywhere (Steele, Lea and Flood, OOPSLA 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Between -1 and 1.
    pub(super) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}

/// The values of a joint's coordinates at even times: q, dq, ddq per coordinate.
struct Grid {
    count: usize,
    at: [Vec<f64>; 3],
}

/// Multipliers and the weight of violations.
#[derive(Clone)]
struct Prices {
    weight: f64,
    of: Vec<f64>,
}

/// Room for an evaluation.
struct Work {
    grid: Grid,
    /// Columns, row by row.
    a: Vec<f64>,
    rows: Vec<Room>,
    rest: Vec<Room>,
    torque: Room,
    frames: Vec<Room>,
    /// Violations of the last evaluation, as [`Prices::of`].
    violations: Vec<f64>,
}

/// An orthonormal basis of the vectors that are orthogonal to one.
fn orthogonal_to(vector: &[f64]) -> Vec<Vec<f64>> {
    let n = vector.len();
    let unit = |k: usize| (0..n).map(|i| if i == k { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    let mut all: Vec<Vec<f64>> = Vec::with_capacity(n);
    for mut x in std::iter::once(vector.to_vec()).chain((1..n).map(unit)) {
        for _ in 0..2 {
            for known in &all {
                let along: f64 = known.iter().zip(&x).map(|(a, b)| a * b).sum();
                x.iter_mut().zip(known).for_each(|(x, known)| *x -= along * known);
            }
        }
        let size = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        all.push(x.iter().map(|x| x / size).collect());
    }
    all.remove(0);
    all
}

/// q, dq, ddq of eight states.
struct States {
    x: [Vec<Lanes>; 3],
}

const ZERO: Lanes = [0.0; LANES];

impl Search<'_> {
    /// Coordinates of a joint.
    fn coordinates(&self) -> usize {
        2 * self.harmonics - 1
    }

    fn middle(&self, joint: usize) -> [f64; 2] {
        match self.limits.position[joint] {
            [low, high] if low.is_finite() && high.is_finite() => [(low + high) / 2.0, (high - low) / 2.0],
            _ => [0.0, 1.0],
        }
    }

    fn bases(&self) -> [Vec<Vec<f64>>; 2] {
        let harmonics: Vec<f64> = (1..=self.harmonics).map(|k| k as f64).collect();
        [orthogonal_to(&vec![1.0; self.harmonics]), orthogonal_to(&harmonics)]
    }

    /// The motion of coordinates.
    pub(super) fn motion(&self, x: &[f64]) -> Motion {
        let (n, count, [of_a, of_b]) = (self.model.joints, self.coordinates(), self.bases());
        let mut motion = Motion { w: self.w, ..Motion::default() };
        for joint in 0..n {
            let ([middle, half], velocity) = (self.middle(joint), self.limits.velocity[joint]);
            let x = &x[joint * count..(joint + 1) * count];
            let sum = |basis: &[Vec<f64>], x: &[f64]| -> Vec<f64> {
                (0..self.harmonics).map(|k| velocity * basis.iter().zip(x).map(|(b, x)| b[k] * x).sum::<f64>()).collect()
            };
            motion.q0.push(middle + half * x[0]);
            motion.a.push(sum(&of_a, &x[1..self.harmonics]));
            motion.b.push(sum(&of_b, &x[self.harmonics..]));
        }
        motion
    }

    fn grid(&self, count: usize) -> Grid {
        let (columns, [of_a, of_b]) = (self.coordinates(), self.bases());
        let mut at: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; count * columns]);
        for s in 0..count {
            let t = std::f64::consts::TAU / self.w * s as f64 / count as f64;
            at[0][s * columns] = 1.0;
            for k in 0..self.harmonics {
                let w = (k + 1) as f64 * self.w;
                let (sine, cosine) = (w * t).sin_cos();
                let of = [[sine / w, cosine, -w * sine], [-cosine / w, sine, w * cosine]];
                for (place, (basis, of)) in [(1, (&of_a, of[0])), (self.harmonics, (&of_b, of[1]))] {
                    for (i, vector) in basis.iter().enumerate() {
                        (0..3).for_each(|d| at[d][s * columns + place + i] += of[d] * vector[k]);
                    }
                }
            }
        }
        Grid { count, at }
    }

    fn work(&self, count: usize) -> Work {
        let (model, groups) = (self.model, count / LANES);
        let has_load = model.columns.iter().any(|(_, term)| *term == Friction::Load);
        Work {
            grid: self.grid(count),
            a: vec![0.0; count * model.joints * model.unknowns()],
            rows: vec![model.regressor.room(); groups],
            rest: if has_load { vec![model.regressor.room(); groups] } else { Vec::new() },
            torque: model.torque.room(),
            frames: model.frames.iter().map(|(tape, _)| tape.room()).collect(),
            violations: vec![f64::NEG_INFINITY; count * self.prices_of_a_sample() + LEAD * self.bounds.len()],
        }
    }

    fn prices_of_a_sample(&self) -> usize {
        4 * self.model.joints + self.bounds.len()
    }

    fn states(&self, x: &[f64], grid: &Grid, group: usize) -> States {
        let (n, columns) = (self.model.joints, self.coordinates());
        let mut states = States { x: std::array::from_fn(|_| vec![ZERO; n]) };
        for joint in 0..n {
            let ([middle, half], velocity) = (self.middle(joint), self.limits.velocity[joint]);
            let x = &x[joint * columns..(joint + 1) * columns];
            for d in 0..3 {
                for lane in 0..LANES {
                    let row = &grid.at[d][(group * LANES + lane) * columns..][..columns];
                    let moved: f64 = row[1..].iter().zip(&x[1..]).map(|(row, x)| row * x).sum();
                    let still = if d == 0 { middle + half * x[0] } else { 0.0 };
                    states.x[d][joint][lane] = still + velocity * moved;
                }
            }
        }
        states
    }

    /// The value, its derivatives by x, and -log det M per column. Infinite where M is singular.
    fn evaluate(&self, x: &[f64], prices: &Prices, work: &mut Work, gradient: &mut [f64]) -> [f64; 2] {
        let (model, n, p) = (self.model, self.model.joints, self.model.unknowns());
        let groups = work.grid.count / LANES;
        let states: Vec<States> = (0..groups).map(|group| self.states(x, &work.grid, group)).collect();
        let zero = vec![ZERO; n];
        for (group, of) in states.iter().enumerate() {
            let [q, dq, ddq] = &of.x;
            model.regressor.forwards(&[q, dq, dq, ddq], &mut work.rows[group]);
            let results = &work.rows[group].results;
            for joint in 0..n {
                for lane in 0..LANES {
                    let row = &mut work.a[((group * LANES + lane) * n + joint) * p..][..p];
                    for (to, from) in row.iter_mut().zip(&results[joint * model.base..(joint + 1) * model.base]) {
                        *to = from[lane] / self.scale[joint];
                    }
                }
            }
            if let Some(rest) = work.rest.get_mut(group) {
                model.regressor.forwards(&[q, &zero, &zero, &zero], rest);
            }
            for (column, &(joint, term)) in model.columns.iter().enumerate() {
                for lane in 0..LANES {
                    let size = work.rest.get(group).map_or(0.0, |rest| gravity(model, rest, joint, lane).abs());
                    let value = self.friction(joint, term, dq[joint][lane], size)[0];
                    work.a[((group * LANES + lane) * n + joint) * p + model.base + column] = value / self.scale[joint];
                }
            }
        }
        let Some((objective, inverse)) = self.log_det(&work.a) else { return [f64::INFINITY; 2] };
        gradient.fill(0.0);
        let mut value = objective;
        let factor = -2.0 / (work.grid.count * p) as f64;
        let per_sample = self.prices_of_a_sample();
        let mut weights = vec![ZERO; n * model.base];
        let mut torque_weights = vec![ZERO; n];
        let mut product = vec![0.0; p];
        for (group, of) in states.iter().enumerate() {
            let [q, dq, ddq] = &of.x;
            let mut slopes: [Vec<Lanes>; 3] = std::array::from_fn(|_| vec![ZERO; n]);
            let mut rest_weights = vec![ZERO; if work.rest.is_empty() { 0 } else { n * model.base }];
            for lane in 0..LANES {
                for joint in 0..n {
                    let row = &work.a[((group * LANES + lane) * n + joint) * p..][..p];
                    product.fill(0.0);
                    let first = row.iter().position(|x| *x != 0.0).unwrap_or(p);
                    for (i, a) in row.iter().enumerate().skip(first).filter(|(_, a)| **a != 0.0) {
                        let of = &inverse[i * p + first..(i + 1) * p];
                        product[first..].iter_mut().zip(of).for_each(|(product, of)| *product += a * of);
                    }
                    let by = factor / self.scale[joint];
                    for i in 0..model.base {
                        weights[joint * model.base + i][lane] = by * product[i];
                    }
                    for (column, &(of, term)) in model.columns.iter().enumerate().filter(|(_, (of, _))| *of == joint) {
                        let weight = by * product[model.base + column];
                        let rate = dq[of][lane];
                        if term == Friction::Load {
                            let g = gravity(model, &work.rest[group], joint, lane);
                            let [_, slope] = self.friction(joint, term, rate, g.abs());
                            slopes[1][joint][lane] += weight * slope;
                            let by_g = weight * self.friction(joint, term, rate, 1.0)[0] * g.signum();
                            for i in 0..model.base {
                                rest_weights[joint * model.base + i][lane] += by_g * model.pi[i];
                            }
                        } else {
                            slopes[1][joint][lane] += weight * self.friction(joint, term, rate, 0.0)[1];
                        }
                    }
                }
            }
            let room = &mut work.rows[group];
            model.regressor.backwards(&[q, dq, dq, ddq], &weights, room);
            for joint in 0..n {
                for lane in 0..LANES {
                    slopes[0][joint][lane] += room.gradients[0][joint][lane];
                    slopes[1][joint][lane] += room.gradients[1][joint][lane] + room.gradients[2][joint][lane];
                    slopes[2][joint][lane] += room.gradients[3][joint][lane];
                }
            }
            if let Some(rest) = work.rest.get_mut(group) {
                model.regressor.backwards(&[q, &zero, &zero, &zero], &rest_weights, rest);
                for joint in 0..n {
                    (0..LANES).for_each(|lane| slopes[0][joint][lane] += rest.gradients[0][joint][lane]);
                }
            }
            // Limits.
            model.torque.forwards(&[q, dq, ddq], &mut work.torque);
            for lane in 0..LANES {
                let place = (group * LANES + lane) * per_sample;
                let mut limit = |k: usize, x: f64, [low, high]: [f64; 2]| -> f64 {
                    if !(low.is_finite() && high.is_finite()) {
                        return 0.0;
                    }
                    let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0 * self.share);
                    let violation = (x - middle).abs() / half - 1.0;
                    work.violations[place + k] = violation;
                    let price = prices.of[place + k];
                    let raised = (price + prices.weight * violation).max(0.0);
                    value += (raised * raised - price * price) / (2.0 * prices.weight);
                    raised * (x - middle).signum() / half
                };
                for joint in 0..n {
                    let symmetric = |x: f64| [-x, x];
                    slopes[0][joint][lane] += limit(4 * joint, q[joint][lane], self.limits.position[joint]);
                    slopes[1][joint][lane] += limit(4 * joint + 1, dq[joint][lane], symmetric(self.limits.velocity[joint]));
                    slopes[2][joint][lane] += limit(4 * joint + 2, ddq[joint][lane], symmetric(self.limits.acceleration[joint]));
                    let tau = work.torque.results[joint][lane];
                    torque_weights[joint][lane] = limit(4 * joint + 3, tau, symmetric(self.limits.effort[joint]));
                }
            }
            if torque_weights.iter().flatten().any(|weight| *weight != 0.0) {
                model.torque.backwards(&[q, dq, ddq], &torque_weights, &mut work.torque);
                for d in 0..3 {
                    for joint in 0..n {
                        (0..LANES).for_each(|lane| slopes[d][joint][lane] += work.torque.gradients[d][joint][lane]);
                    }
                }
            }
            let place = |lane: usize, k: usize| (group * LANES + lane) * per_sample + 4 * n + k;
            let by_box = self.boxes(q, &place, prices, &mut work.frames, &mut work.violations, &mut value);
            for joint in 0..n {
                (0..LANES).for_each(|lane| slopes[0][joint][lane] += by_box[joint][lane]);
            }
            let columns = self.coordinates();
            for joint in 0..n {
                let ([_, half], velocity) = (self.middle(joint), self.limits.velocity[joint]);
                let to = &mut gradient[joint * columns..(joint + 1) * columns];
                for lane in 0..LANES {
                    to[0] += half * slopes[0][joint][lane];
                    for d in 0..3 {
                        let row = &work.grid.at[d][(group * LANES + lane) * columns..][..columns];
                        let slope = velocity * slopes[d][joint][lane];
                        to[1..].iter_mut().zip(&row[1..]).for_each(|(to, row)| *to += slope * row);
                    }
                }
            }
        }
        // The way to the motion keeps the box, too.
        for group in 0..if self.bounds.is_empty() { 0 } else { LEAD / LANES } {
            let u: Lanes = std::array::from_fn(|lane| (group * LANES + lane + 1) as f64 / LEAD as f64);
            let share = u.map(|u| u * u * u * (10.0 - u * (15.0 - 6.0 * u)));
            let of = |joint: usize, lane: usize| {
                let (from, to) = (self.start[joint], states[0].x[0][joint][0]);
                from + share[lane] * (to - from)
            };
            let q: Vec<Lanes> = (0..n).map(|joint| std::array::from_fn(|lane| of(joint, lane))).collect();
            let first = work.grid.count * per_sample;
            let place = |lane: usize, k: usize| first + (group * LANES + lane) * self.bounds.len() + k;
            let slopes = self.boxes(&q, &place, prices, &mut work.frames, &mut work.violations, &mut value);
            let columns = self.coordinates();
            for joint in 0..n {
                let slope: f64 = (0..LANES).map(|lane| share[lane] * slopes[joint][lane]).sum();
                let ([_, half], velocity) = (self.middle(joint), self.limits.velocity[joint]);
                let to = &mut gradient[joint * columns..(joint + 1) * columns];
                to[0] += half * slope;
                let row = &work.grid.at[0][1..columns];
                to[1..].iter_mut().zip(row).for_each(|(to, row)| *to += velocity * slope * row);
            }
        }
        [value, objective]
    }

    /// The prices of the box at eight postures, and their derivatives by q; `place(lane, bound)` is the place of a price.
    fn boxes(
        &self,
        q: &[Lanes],
        place: &dyn Fn(usize, usize) -> usize,
        prices: &Prices,
        rooms: &mut [Room],
        violations: &mut [f64],
        value: &mut f64,
    ) -> Vec<Lanes> {
        let mut slopes = vec![ZERO; q.len()];
        for (function, ((tape, _), room)) in self.model.frames.iter().zip(rooms).enumerate() {
            let of_function = |(_, bound): &(usize, &Bound)| bound.function == function;
            if !self.bounds.iter().enumerate().any(|bound| of_function(&bound)) {
                continue;
            }
            tape.forwards(&[q], room);
            let mut weights = vec![ZERO; room.results.len()];
            for (k, bound) in self.bounds.iter().enumerate().filter(of_function) {
                let (middle, half) = ((bound.low + bound.high) / 2.0, (bound.high - bound.low) / 2.0 * self.share);
                for lane in 0..LANES {
                    let x = room.results[bound.entry][lane];
                    let violation = (x - middle).abs() / half - 1.0;
                    violations[place(lane, k)] = violation;
                    let price = prices.of[place(lane, k)];
                    let raised = (price + prices.weight * violation).max(0.0);
                    *value += (raised * raised - price * price) / (2.0 * prices.weight);
                    weights[bound.entry][lane] += raised * (x - middle).signum() / half;
                }
            }
            tape.backwards(&[q], &weights, room);
            for (slope, gradient) in slopes.iter_mut().zip(&room.gradients[0]) {
                (0..LANES).for_each(|lane| slope[lane] += gradient[lane]);
            }
        }
        slopes
    }

    /// A column of friction and its derivative by the rate.
    fn friction(&self, joint: usize, term: Friction, dq: f64, size: f64) -> [f64; 2] {
        let smooth = self.model.smooth[joint];
        let velocity = self.model.friction[joint].velocity;
        let sign = (dq / smooth).tanh();
        let slope = (1.0 - sign * sign) / smooth;
        match term {
            Friction::Viscous => [dq, 1.0],
            Friction::Coulomb => [sign, slope],
            Friction::Offset => [1.0, 0.0],
            Friction::Load => [sign * size, slope * size],
            Friction::Cubic => [dq * dq * dq, 3.0 * dq * dq],
            Friction::Stribeck => {
                let fading = (-dq.abs() / velocity).exp();
                [sign * fading, slope * fading - sign * dq.signum() * fading / velocity]
            }
        }
    }

    /// -log det M per column, and M^-1 row by row.
    fn log_det(&self, a: &[f64]) -> Option<(f64, Vec<f64>)> {
        let p = self.model.unknowns();
        let mut m = vec![0.0; p * p];
        let rows = a.len() / p;
        for row in a.chunks_exact(p) {
            let first = row.iter().position(|x| *x != 0.0).unwrap_or(p);
            for (i, x) in row.iter().enumerate().skip(first).filter(|(_, x)| **x != 0.0) {
                m[i * p + i..(i + 1) * p].iter_mut().zip(&row[i..]).for_each(|(m, y)| *m += x * y);
            }
        }
        let by = self.model.joints as f64 / rows as f64;
        let scale: Vec<f64> = (0..p).map(|i| (by * m[i * p + i]).sqrt()).collect();
        if !scale.iter().all(|x| x.is_finite() && *x > 0.0) {
            return None;
        }
        let entry = |i: usize, j: usize| by * m[i.min(j) * p + i.max(j)] / (scale[i] * scale[j]);
        let factor = DMatrix::from_fn(p, p, entry).cholesky()?;
        let l = factor.l_dirty();
        let log_det: f64 = (0..p).map(|i| 2.0 * (l[(i, i)] * scale[i]).ln()).sum();
        let inverse = factor.inverse();
        let inverse = (0..p * p).map(|k| inverse[(k / p, k % p)] / (scale[k / p] * scale[k % p])).collect();
        log_det.is_finite().then_some((-log_det / p as f64, inverse))
    }

    /// A random start that keeps the limits of positions, rates and accelerations.
    fn start(&self, random: &mut Random, grid: &Grid) -> Vec<f64> {
        let columns = self.coordinates();
        let mut x = vec![0.0; self.model.joints * columns];
        for joint in 0..self.model.joints {
            let x = &mut x[joint * columns..(joint + 1) * columns];
            x[1..].iter_mut().for_each(|x| *x = random.signed());
            let ([_, half], velocity) = (self.middle(joint), self.limits.velocity[joint]);
            let largest = |d: usize| -> f64 {
                let of = |s: usize| -> f64 {
                    let row = &grid.at[d][s * columns..][..columns];
                    velocity * row[1..].iter().zip(&x[1..]).map(|(row, x)| row * x).sum::<f64>().abs()
                };
                (0..grid.count).map(of).fold(0.0, f64::max)
            };
            let [_, range] = match self.limits.position[joint] {
                [low, high] if low.is_finite() && high.is_finite() => [0.0, half],
                _ => [0.0, f64::INFINITY],
            };
            let used = (largest(0) / range).max(largest(1) / velocity).max(largest(2) / self.limits.acceleration[joint]);
            let by = (0.4 + 0.55 * random.unit()) / used;
            let room = if range.is_finite() { 1.0 - by * largest(0) / range } else { 1.0 };
            x[1..].iter_mut().for_each(|x| *x *= by);
            x[0] = room.max(0.0) * random.signed();
        }
        x
    }

    /// Rounds of an augmented Lagrangian from x; the result's value of the objective, and its largest violation.
    fn improve(&self, x: &mut [f64], work: &mut Work, rounds: &[(f64, usize)]) -> [f64; 2] {
        let mut prices = Prices { weight: rounds[0].0, of: vec![0.0; work.violations.len()] };
        let mut objective = f64::INFINITY;
        for &(weight, steps) in rounds {
            prices.weight = weight;
            objective = descend(x, steps, &mut |x, gradient| self.evaluate(x, &prices, work, gradient));
            for (price, violation) in prices.of.iter_mut().zip(&work.violations) {
                *price = (*price + weight * violation).max(0.0);
            }
        }
        [objective, work.violations.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Polishes coordinates on a fine grid.
    pub(super) fn polish(&self, x: &mut [f64]) -> [f64; 2] {
        self.improve(x, &mut self.work(FINE), &POLISH)
    }

    /// The coordinates of the best motion of some starts; `done` is called after each part of the work, of [`PARTS`].
    pub(super) fn best(&self, seed: u64, done: &(dyn Fn() + Sync)) -> Option<Vec<f64>> {
        use armgen_codegen::parallel::parallel_map;
        let seeds: Vec<u64> =
            (0..STARTS as u64).map(|k| seed.wrapping_mul(0x2545_f491_4f6c_dd1d).wrapping_add(k << 32)).collect();
        let improved = |x: &[f64], count: usize, rounds: &[(f64, usize)]| {
            let mut x = x.to_vec();
            let found = self.improve(&mut x, &mut self.work(count), rounds);
            done();
            (found, x)
        };
        let mut all = parallel_map(&seeds, |seed| {
            let x = self.start(&mut Random(*seed), &self.grid(COARSE));
            improved(&x, COARSE, &FIRST)
        });
        sort(&mut all);
        all.truncate(SECOND_STARTS);
        all = parallel_map(&all, |(_, x)| improved(x, COARSE, &SECOND));
        sort(&mut all);
        // Joints of the best motion begin anew: it is nearer to the next better one than any random start.
        let columns = self.coordinates();
        for round in 0..ROUNDS_OF_CHANGES {
            let best = all[0].1.clone();
            let tries: Vec<u64> =
                (0..CHANGES as u64).map(|k| seeds[0].wrapping_sub((round * CHANGES as u64 + k + 1) << 32)).collect();
            all.truncate(1);
            all.extend(parallel_map(&tries, |seed| {
                let mut random = Random(*seed);
                let (fresh, mut x) = (self.start(&mut random, &self.grid(COARSE)), best.clone());
                for _ in 0..CHANGED_JOINTS {
                    let from = columns * (random.unit() * self.model.joints as f64) as usize;
                    x[from..from + columns].copy_from_slice(&fresh[from..from + columns]);
                }
                improved(&x, COARSE, &SECOND)
            }));
            sort(&mut all);
        }
        all.truncate(1);
        all = parallel_map(&all, |(_, x)| improved(x, COARSE, &THIRD));
        all.into_iter().next().filter(|([objective, _], _)| objective.is_finite()).map(|(_, x)| x)
    }
}

/// By the objective, violations counted against it; equal ones keep their order.
fn sort(all: &mut [([f64; 2], Vec<f64>)]) {
    let cost = |[objective, violation]: [f64; 2]| objective + 3.0 * violation.max(0.0);
    all.sort_by(|(a, _), (b, _)| cost(*a).total_cmp(&cost(*b)));
}

/// Postures of the lead-in.
const LEAD: usize = 16;
/// Samples of the first searches and of the last.
const COARSE: usize = 64;
const FINE: usize = 200;
/// Starts, and how many go on.
const STARTS: usize = 24;
const SECOND_STARTS: usize = 4;
/// Changes of the best motion in a round, and the joints that one changes.
const ROUNDS_OF_CHANGES: u64 = 8;
const CHANGES: usize = 6;
const CHANGED_JOINTS: usize = 2;
/// Calls of `done` in a search.
pub(super) const PARTS: usize = STARTS + SECOND_STARTS + ROUNDS_OF_CHANGES as usize * CHANGES + 1;
/// Weights of violations, and steps.
const FIRST: [(f64, usize); 2] = [(3.0, 30), (5.0, 20)];
const SECOND: [(f64, usize); 3] = [(5.0, 50), (8.0, 30), (12.0, 30)];
const THIRD: [(f64, usize); 4] = [(8.0, 80), (12.0, 60), (20.0, 60), (30.0, 60)];
const POLISH: [(f64, usize); 5] = [(20.0, 50), (30.0, 40), (50.0, 40), (100.0, 40), (200.0, 40)];

fn gravity(model: &Model, rest: &Room, joint: usize, lane: usize) -> f64 {
    let row = &rest.results[joint * model.base..(joint + 1) * model.base];
    row.iter().zip(&model.pi).map(|(y, pi)| y[lane] * pi).sum()
}

/// Pairs of steps that are remembered.
const MEMORY: usize = 12;

/// Quasi-Newton steps with limited memory (Nocedal, Math. Comput. 35, 1980). The last evaluation is at the result. The second number of it.
fn descend(x: &mut [f64], steps: usize, f: &mut dyn FnMut(&[f64], &mut [f64]) -> [f64; 2]) -> f64 {
    let n = x.len();
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut gradient = vec![0.0; n];
    let [mut value, mut objective] = f(x, &mut gradient);
    let mut pairs: Vec<(Vec<f64>, Vec<f64>, f64)> = Vec::new();
    let (mut trial, mut next) = (vec![0.0; n], vec![0.0; n]);
    let mut is_current = true;
    for _ in 0..steps {
        let mut direction: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut along = Vec::with_capacity(pairs.len());
        for (s, y, rho) in pairs.iter().rev() {
            let a = rho * dot(s, &direction);
            direction.iter_mut().zip(y).for_each(|(d, y)| *d -= a * y);
            along.push(a);
        }
        match pairs.last() {
            Some((_, y, rho)) => {
                let by = 1.0 / (rho * dot(y, y));
                direction.iter_mut().for_each(|d| *d *= by);
            }
            None => {
                let by = 0.1 / dot(&gradient, &gradient).sqrt().max(1e-12);
                direction.iter_mut().for_each(|d| *d *= by);
            }
        }
        for ((s, y, rho), a) in pairs.iter().zip(along.iter().rev()) {
            let b = rho * dot(y, &direction);
            direction.iter_mut().zip(s).for_each(|(d, s)| *d += (a - b) * s);
        }
        let slope = dot(&gradient, &direction);
        if slope >= 0.0 || !slope.is_finite() {
            if pairs.is_empty() {
                break;
            }
            pairs.clear();
            continue;
        }
        let mut step = 1.0;
        let mut found = None;
        for _ in 0..20 {
            (0..n).for_each(|i| trial[i] = x[i] + step * direction[i]);
            let [at, of] = f(&trial, &mut next);
            is_current = false;
            if at <= value + 1e-4 * step * slope {
                found = Some((at, of));
                break;
            }
            // The minimum of the parabola through what is known.
            let parabola = -slope * step * step / (2.0 * (at - value - slope * step));
            step = if parabola.is_finite() { parabola.clamp(0.1 * step, 0.5 * step) } else { 0.3 * step };
        }
        let Some((at, of)) = found else {
            if pairs.is_empty() {
                break;
            }
            pairs.clear();
            continue;
        };
        is_current = true;
        let s: Vec<f64> = (0..n).map(|i| trial[i] - x[i]).collect();
        let y: Vec<f64> = (0..n).map(|i| next[i] - gradient[i]).collect();
        let curvature = dot(&s, &y);
        if curvature > 1e-10 * dot(&s, &s).sqrt() * dot(&y, &y).sqrt() {
            if pairs.len() == MEMORY {
                pairs.remove(0);
            }
            pairs.push((s, y, 1.0 / curvature));
        }
        x.copy_from_slice(&trial);
        std::mem::swap(&mut gradient, &mut next);
        let gain = value - at;
        (value, objective) = (at, of);
        if gain < 1e-9 {
            break;
        }
    }
    if !is_current {
        [_, objective] = f(x, &mut gradient);
    }
    objective
}
