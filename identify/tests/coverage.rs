//! Intervals hold the truth as often as they promise, also where noise is coloured.

use armgen_identify::fit::{covariance, solve, Equations, Row};
use nalgebra::DVector;

use crate::arms::{arm, motion, Random, ELBOW};

/// Shares of the true values within 3 sigma: of the sandwich, and of the plain s² (A'A)^-1.
fn shares(logs: usize, memory: f64) -> (f64, f64) {
    let arm = arm(ELBOW);
    let motion = motion(ELBOW, 7, 60.0, 50.0);
    let (n, base) = (arm.dof(), arm.base.len());
    let rows: Vec<Row> =
        (0..motion.tau.len()).map(|k| Row { joint: k % n, log: 0, time: motion.t[k / n], counts: true }).collect();
    let a = arm.regressor(&motion.q, &motion.dq, &motion.ddq);
    let mut equations = Equations::dense(base, a, vec![0.0; rows.len()], rows);
    let active: Vec<usize> = (0..base).collect();
    let ones = vec![1.0; equations.b.len()];
    let mut gram = equations.gram(&ones);
    let mut random = Random(17);
    let (mut held, mut plain, mut all) = (0, 0, 0);
    for _ in 0..logs {
        let mut noise = vec![0.0; n];
        for k in 0..equations.b.len() {
            noise[k % n] = memory * noise[k % n] + (1.0 - memory * memory).sqrt() * random.normal();
            equations.b[k] = noise[k % n];
        }
        // The truth is 0: only the right-hand side changes.
        gram.g = DVector::zeros(base);
        for k in 0..equations.b.len() {
            for (i, a) in equations.row(k).iter().enumerate() {
                gram.g[i] += a * equations.b[k];
            }
        }
        let found = solve(&gram, &DVector::zeros(base));
        let residuals = equations.residuals(&active, &found.x);
        let of = covariance(&equations, &active, &residuals, &ones, &found.inverse, n);
        let variance = residuals.iter().map(|r| r * r).sum::<f64>() / (residuals.len() - base) as f64;
        for k in 0..base {
            all += 1;
            held += usize::from(found.x[k].abs() < of.reach * of.matrix[(k, k)].sqrt());
            plain += usize::from(found.x[k].abs() < 3.0 * (variance * found.inverse[(k, k)]).sqrt());
        }
    }
    (f64::from(held as u32) / f64::from(all), f64::from(plain as u32) / f64::from(all))
}

#[test]
#[ignore = "wide"]
fn intervals_hold_for_white_and_for_coloured_noise() {
    intervals_hold(300);
}

#[test]
#[ignore = "full: minutes, a thousand logs of each noise"]
fn intervals_hold_for_a_thousand_logs() {
    intervals_hold(1000);
}

fn intervals_hold(logs: usize) {
    let promised = 0.985..0.9995;
    let (white, plain) = shares(logs, 0.0);
    println!("white noise: {white:.4}, by the plain formula {plain:.4}");
    assert!(promised.contains(&white), "{white}");
    // exp(-0.02 s / 0.05 s)
    let (coloured, plain) = shares(logs, 0.67);
    println!("coloured noise: {coloured:.4}, by the plain formula {plain:.4}");
    assert!(promised.contains(&coloured), "{coloured}");
    assert!(!promised.contains(&plain), "the plain formula holds for coloured noise: {plain}");
}
