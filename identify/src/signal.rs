//! Signals: pieces without gaps, a common grid, zero-phase filters, derivatives.

use std::f64::consts::PI;

/// The median; 0 of nothing.
pub fn median(values: &[f64]) -> f64 {
    let (mut values, n) = (values.to_vec(), values.len());
    if n == 0 {
        return 0.0;
    }
    let (below, &mut middle, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    match below.iter().copied().max_by(f64::total_cmp).filter(|_| n % 2 == 0) {
        Some(before) => 0.5 * (before + middle),
        None => middle,
    }
}

/// A robust standard deviation: 1.4826 times the median of absolute deviations from 0.
pub fn spread(values: &[f64]) -> f64 {
    1.4826 * median(&values.iter().map(|x| x.abs()).collect::<Vec<_>>())
}

/// The root of the mean square; 0 of nothing.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Gaps of up to this many periods are interpolated.
pub const LONGEST_GAP: f64 = 3.0;

/// The median period of stamps.
pub fn period(t: &[f64]) -> f64 {
    median(&t.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>())
}

/// Ranges of samples without a gap of more than [`LONGEST_GAP`] periods.
pub fn pieces(t: &[f64], period: f64) -> Vec<std::ops::Range<usize>> {
    let mut pieces = Vec::new();
    let mut start = 0;
    for k in 1..=t.len() {
        if k == t.len() || t[k] - t[k - 1] > LONGEST_GAP * period * (1.0 + 1e-9) {
            pieces.push(start..k);
            start = k;
        }
    }
    pieces
}

/// Values at other times by the cubic through the four stamps around each; at the stamps, the values themselves.
pub fn interpolate(t: &[f64], x: &[f64], at: &[f64]) -> Vec<f64> {
    let n = t.len();
    let mut k = 0;
    at.iter()
        .map(|&time| {
            while k + 1 < n && t[k + 1] <= time {
                k += 1;
            }
            if t[k] == time || n < 4 {
                return x[k];
            }
            let first = k.saturating_sub(1).min(n - 4);
            (first..first + 4)
                .map(|i| {
                    let weight: f64 = (first..first + 4).filter(|&j| j != i).map(|j| (time - t[j]) / (t[i] - t[j])).product();
                    weight * x[i]
                })
                .sum()
        })
        .collect()
}

/// A signal at the lag at which it is nearest to another one: within a tenth of a second.
pub fn nearest(t: &[f64], x: &[f64], other: &[f64]) -> Vec<f64> {
    let n = t.len();
    if n < 8 {
        return x.to_vec();
    }
    let (first, last) = (t[0], t[n - 1]);
    let later = |lag: f64| interpolate(t, x, &t.iter().map(|t| (t - lag).clamp(first, last)).collect::<Vec<_>>());
    let mut lag = 0.0f64;
    for _ in 0..6 {
        let at = later(lag);
        let (mut product, mut square) = (0.0, 0.0);
        for k in 1..n - 1 {
            let slope = (at[k + 1] - at[k - 1]) / (t[k + 1] - t[k - 1]);
            product += slope * (at[k] - other[k]);
            square += slope * slope;
        }
        lag = (lag + product / f64::max(square, 1e-300)).clamp(-0.1, 0.1);
    }
    later(lag)
}

/// Samples that a value between them is interpolated from.
const TAPS: isize = 8;

/// Values of an even grid later than some of its samples by a part of them, by the polynomial of degree 7 through eight samples. Beyond its ends
/// the signal is constant.
pub fn shifted(x: &[f64], at: impl IntoIterator<Item = usize>, by: f64) -> Vec<f64> {
    let first = by.floor() - (TAPS / 2 - 1) as f64;
    let f = by - first;
    let others = |i: isize| (0..TAPS).filter(move |&j| j != i);
    let weight = |i: isize| others(i).map(|j| (f - j as f64) / (i - j) as f64).product();
    let weights: Vec<f64> = (0..TAPS).map(weight).collect();
    let (first, last) = (first as isize, x.len().saturating_sub(1));
    let value = |k: usize| -> f64 {
        match k.checked_add_signed(first).and_then(|start| x.get(start..start + weights.len())) {
            Some(near) => weights.iter().zip(near).map(|(weight, x)| weight * x).sum(),
            None => {
                let near = |i: usize| x[k.saturating_add_signed(first + i as isize).min(last)];
                weights.iter().enumerate().map(|(i, weight)| weight * near(i)).sum()
            }
        }
    };
    at.into_iter().map(value).collect()
}

/// The standard deviation of white noise beside a signal, from sixth differences: those of the signal itself are far smaller.
pub fn noise(x: &[f64]) -> f64 {
    let mut differences = x.to_vec();
    for _ in 0..6 {
        differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    // The sum of squares of binomial coefficients.
    spread(&differences) / 924f64.sqrt()
}

/// Slopes of an even signal: central differences of the fourth order, of the second near the ends.
pub fn slopes(x: &[f64], period: f64) -> Vec<f64> {
    let mut slopes = derivative(x, period);
    for k in 2..x.len().saturating_sub(2) {
        slopes[k] = (8.0 * (x[k + 1] - x[k - 1]) - (x[k + 2] - x[k - 2])) / (12.0 * period);
    }
    slopes
}

/// What [`slopes`] makes of white noise, times the period.
pub const NOISE_OF_SLOPES: f64 = 0.950_146;

/// Central differences, one-sided at the ends.
pub fn derivative(x: &[f64], period: f64) -> Vec<f64> {
    let n = x.len();
    (0..n)
        .map(|k| {
            let (a, b) = (k.saturating_sub(1), (k + 1).min(n - 1));
            if a == b {
                0.0
            } else {
                (x[b] - x[a]) / ((b - a) as f64 * period)
            }
        })
        .collect()
}

/// Sections of a low pass.
const SECTIONS: usize = 3;

/// A Butterworth low pass of order 5, run both ways: its magnitude twice, and no phase.
#[derive(Clone, Debug)]
pub struct LowPass {
    /// b0, b1, b2, a1, a2 of each section.
    sections: [[f64; 5]; SECTIONS],
    /// Samples that ends are continued by.
    margin: usize,
}

impl LowPass {
    /// With a cutoff and a rate, Hz; the cutoff is at most 0.45 of the rate.
    pub fn new(cutoff: f64, rate: f64) -> LowPass {
        let cutoff = cutoff.min(0.45 * rate);
        // The bilinear transform of the poles, with the cutoff where it belongs (Oppenheim and Schafer).
        let k = (PI * cutoff / rate).tan();
        let pair = |pair: f64| {
            let damping = 2.0 * (PI * pair / 5.0).cos();
            let norm = 1.0 / (1.0 + damping * k + k * k);
            let gain = k * k * norm;
            [gain, 2.0 * gain, gain, 2.0 * (k * k - 1.0) * norm, (1.0 - damping * k + k * k) * norm]
        };
        let single = [k / (1.0 + k), k / (1.0 + k), 0.0, (k - 1.0) / (k + 1.0), 0.0];
        let sections = [single, pair(1.0), pair(2.0)];
        LowPass { sections, margin: (2.0 * rate / cutoff).ceil() as usize }
    }

    /// The filtered signal; ends are continued by their point reflection.
    pub fn both_ways(&self, x: &[f64]) -> Vec<f64> {
        let alone: Vec<[f64; 1]> = x.iter().map(|x| [*x]).collect();
        self.side_by_side(&alone).into_flattened()
    }

    /// Filtered signals, side by side: a sample waits for the one before it, but not for its neighbours.
    pub fn side_by_side<const L: usize>(&self, x: &[[f64; L]]) -> Vec<[f64; L]> {
        let n = x.len();
        if n < 2 {
            return x.to_vec();
        }
        let margin = self.margin.min(n - 1);
        let reflected = |end: [f64; L], k: usize| {
            let mut at = x[k];
            for i in 0..L {
                at[i] = 2.0 * end[i] - at[i];
            }
            at
        };
        let before = (1..=margin).rev().map(|k| reflected(x[0], k));
        let after = (1..=margin).map(|k| reflected(x[n - 1], n - 1 - k));
        let mut all: Vec<[f64; L]> = Vec::with_capacity(n + 2 * margin);
        all.extend(before.chain(x.iter().copied()).chain(after));
        self.run(all[0], all.iter_mut());
        self.run(all[all.len() - 1], all.iter_mut().rev());
        all.truncate(margin + n);
        all.drain(..margin);
        all
    }

    fn run<'x, const L: usize>(&self, mut first: [f64; L], all: impl Iterator<Item = &'x mut [f64; L]>) {
        let mut states = [[[0.0; L]; 2]; SECTIONS];
        // At rest at the first value: each section passes a constant as it is.
        for (&[b0, b1, b2, a1, a2], states) in self.sections.iter().zip(&mut states) {
            let [s1, s2] = states;
            for i in 0..L {
                s2[i] = (b2 - a2) * first[i];
                s1[i] = (b1 - a1) * first[i] + s2[i];
                first[i] = b0 * first[i] + s1[i];
            }
        }
        for value in all {
            for (&[b0, b1, b2, a1, a2], states) in self.sections.iter().zip(&mut states) {
                let [s1, s2] = states;
                for i in 0..L {
                    let x = value[i];
                    let y = b0 * x + s1[i];
                    s1[i] = b1 * x - a1 * y + s2[i];
                    s2[i] = b2 * x - a2 * y;
                    value[i] = y;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_low_pass_has_the_magnitude_of_butterworth_twice_and_no_phase() {
        let (rate, cutoff) = (200.0, 8.0);
        let filter = LowPass::new(cutoff, rate);
        for frequency in [1.0, 4.0, 8.0, 12.0, 20.0] {
            let wave = |k: usize| (2.0 * PI * frequency * k as f64 / rate).sin();
            let x: Vec<f64> = (0..4000).map(wave).collect();
            let y = filter.both_ways(&x);
            let warped = |f: f64| (PI * f / rate).tan();
            let gain = 1.0 / (1.0 + (warped(frequency) / warped(cutoff)).powi(10));
            let error = (1000..3000).map(|k| (y[k] - gain * wave(k)).abs()).fold(0.0, f64::max);
            assert!(error < 1e-9, "{frequency} Hz: {error}");
        }
        // Side by side, each with its own bits.
        let signals = [0, 1, 2].map(|at| (0..50).map(|k| f64::from((k * (at + 3)) % 11)).collect::<Vec<_>>());
        let together: Vec<[f64; 3]> = (0..50).map(|k| std::array::from_fn(|at| signals[at][k])).collect();
        for (at, signal) in signals.iter().enumerate() {
            let of: Vec<f64> = filter.side_by_side(&together).iter().map(|x| x[at]).collect();
            assert_eq!(of, filter.both_ways(signal));
        }
        let constant = filter.both_ways(&[3.0; 100]);
        assert!(constant.iter().all(|y| (y - 3.0).abs() < 1e-12));
    }

    #[test]
    fn cubics_pass_interpolation_and_gaps_cut() {
        let t = [0.0, 0.01, 0.021, 0.029, 0.04, 0.05, 0.2, 0.21];
        let cubic = |t: f64| 1.0 - 2.0 * t + 30.0 * t * t - 400.0 * t * t * t;
        let x: Vec<f64> = t.iter().map(|&t| cubic(t)).collect();
        for (at, found) in [0.005, 0.025, 0.045].into_iter().zip(interpolate(&t, &x, &[0.005, 0.025, 0.045])) {
            assert!((found - cubic(at)).abs() < 1e-12);
        }
        assert_eq!(pieces(&t, period(&t)), [0..6, 6..8]);
        let even: Vec<f64> = (0..20).map(|k| cubic(f64::from(k))).collect();
        for by in [-2.0, -0.7, 0.0, 0.3, 1.5] {
            for (k, found) in (6..12).zip(shifted(&even, 6..12, by)) {
                assert!((found - cubic(f64::from(k) + by)).abs() < 1e-9 * cubic(19.0).abs(), "{by}");
            }
        }
        assert_eq!(shifted(&even, [0, 19], 0.0), [even[0], even[19]]);
        assert_eq!(median(&[3.0, 1.0, 2.0, 10.0]), 2.5);
    }

    #[test]
    fn a_lag_is_taken_out() {
        let t: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k)).collect();
        let wave = |t: f64| (2.0 * t).sin() + 0.3 * (5.0 * t).cos();
        for lag in [-0.03, 0.0, 0.0123, 0.08] {
            let x: Vec<f64> = t.iter().map(|t| wave(*t)).collect();
            let other: Vec<f64> = t.iter().map(|t| wave(t - lag)).collect();
            let found = nearest(&t, &x, &other);
            assert!((50..350).all(|k| (found[k] - other[k]).abs() < 1e-4), "{lag}");
        }
    }
}
