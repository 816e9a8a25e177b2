//! Paths without a motion, and numbers of any size.

use crate::common::chain::{self, Chain};
use crate::common::paths::{line, one_joint, random, with_timing, FREE};
use armgen_runtime::timing::{Ends, JointPath, Limits, PathError, PathFault, Piece, TimingFault};
use nalgebra::SVector;

#[test]
fn every_fault_has_its_place() {
    let pieces = |all: &[[f64; 3]]| {
        let mut start = 0.0;
        let pieces = all.iter().map(|[from, to, other]| {
            let piece = Piece::line(start, 1.0, [*from, 0.0], [*to, *other]);
            start += 1.0;
            piece
        });
        JointPath::new(pieces.collect::<Vec<_>>()).map(|_| ())
    };
    let fault = |s: f64, piece: usize, fault: PathFault| Err(PathError { s, piece, fault });
    assert_eq!(JointPath::<f64, 2, Vec<Piece<f64, 2>>>::new(vec![]).unwrap_err().fault, PathFault::Empty);
    assert_eq!(pieces(&[[0.0, f64::NAN, 0.0]]).unwrap_err().fault, PathFault::NotFinite);
    assert_eq!(pieces(&[[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]), fault(1.0, 1, PathFault::ZeroLength));
    assert!(
        matches!(pieces(&[[0.0, 1.0, 0.0], [1.1, 2.0, 0.0]]).unwrap_err().fault, PathFault::Jump { joint: 0, by } if (by - 0.1).abs() < 1e-12)
    );
    assert!(
        matches!(pieces(&[[0.0, 1.0, 0.0], [1.0, 1.0, 1.0]]).unwrap_err().fault, PathFault::Corner { angle } if (angle - std::f64::consts::FRAC_PI_2).abs() < 1e-5)
    );
    assert_eq!(pieces(&[[0.0, 1.0, 0.0], [1.0, 3.0, 0.0]]), fault(1.0, 1, PathFault::Scale));
    // q = (s - 1/2)²: the joint stops half-way and turns back.
    let mut cusp = Piece::line(0.0, 1.0, [0.25, 0.0], [0.25, 0.0]);
    (cusp.coefficients[1][0], cusp.coefficients[2][0]) = (-1.0, 1.0);
    let error = JointPath::new(vec![cusp]).map(|_| ()).unwrap_err();
    assert!(error.fault == PathFault::TurningBack && (error.s - 0.5).abs() < 1e-9, "{error}");

    let pendulum = one_joint(false, [0.0; 2], [9.81, 0.0, 0.0], 1.0);
    let timed = |from: f64, to: f64, torque: f64, ends: Ends<f64>| {
        let limits = Limits::velocity([20.0]).unwrap().with_effort([-torque], [torque]).unwrap();
        with_timing(&pendulum, &line(1.0, [from], [to]), &limits, ends, 1e-3, 400, |timing| timing.map(|t| t.seconds()))
    };
    let error = timed(0.0, 2.0, 8.0, Ends::at_rest()).unwrap_err();
    assert!(
        matches!(error.fault, TimingFault::EndNotHeld { joint: 0, torque, limit } if (torque - 9.81 * 2f64.sin()).abs() < 1e-12 && limit == 8.0)
    );
    assert_eq!(error.s, 1.0);
    // The work of 6 N m is that of gravity at 6 q = 9.81 (1 - cos q), q = 1.438 of 3: there the arm is at rest again.
    for (from, to, torque, [low, high]) in [(0.0, 3.0, 6.0, [0.46, 0.50]), (1.2, 2.9, 8.0, [0.0, 0.02])] {
        let error = timed(from, to, torque, Ends { hold: false, ..Ends::at_rest() }).unwrap_err();
        assert!(matches!(error.fault, TimingFault::InfeasibleSpeed { joint: 0, .. }), "{error}");
        assert!(low <= error.s && error.s <= high, "{error}");
    }
    // From there the arm falls back at once, with friction and without.
    for friction in [[0.0; 2], [0.5, 0.1]] {
        let (arm, limits) = (one_joint(false, friction, [9.81, 0.0, 0.0], 1.0), Limits::velocity([20.0]).unwrap());
        let limits = limits.with_effort([-8.0], [8.0]).unwrap();
        let ends = Ends { hold: false, ..Ends::at_rest() };
        let error =
            with_timing(&arm, &line(1.0, [1.2], [2.9]), &limits, ends, 1e-3, 400, |timing| timing.map(|_| ())).unwrap_err();
        assert!(matches!(error.fault, TimingFault::InfeasibleSpeed { proved: true, .. }) && error.s == 0.0, "{error}");
    }
    let fast = timed(0.0, 1.0, 15.0, Ends { speed: [21.0, 0.0], hold: false }).unwrap_err();
    assert!(matches!(fast.fault, TimingFault::InfeasibleSpeed { proved: true, .. }), "{fast}");
    let limits = Limits::velocity([FREE]).unwrap();
    let error =
        with_timing(&pendulum, &line(1.0, [0.0], [1.0]), &limits, Ends::at_rest(), 1e-3, 400, |timing| timing.map(|_| ()))
            .unwrap_err();
    assert_eq!(error.fault, TimingFault::MissingLimit { joint: 0 });
    let limits = Limits::velocity([1.0]).unwrap();
    let error = with_timing(&pendulum, &line(1.0, [0.0], [9.0]), &limits, Ends::at_rest(), 1e-3, 8, |timing| timing.map(|_| ()))
        .unwrap_err();
    assert!(matches!(error.fault, TimingFault::TooCoarse { segments } if segments > 8), "{error}");
    assert!(Limits::velocity([0.0]).is_err() && Limits::velocity([1.0]).unwrap().with_effort([0.0], [1.0]).is_err());
}

/// Coefficients, lengths and limits of any size, signs at random: an error or a motion within its limits.
fn strange<const N: usize>(chain: &Chain<N>, count: u64) -> usize {
    let sizes = [0.0, 5e-324, 1e-310, 1e-160, 1e-30, 1e-9, 1e-3, 0.5, 1.0, 1.0, 1.0, 2.0, 30.0, 1e6, 1e12, 1e40, 1e160, f64::MAX];
    let mut timed = 0;
    for seed in 0..count {
        let mut next = random(7000 + seed);
        // Most numbers are of a usual size.
        let mut any = |strange: f64| {
            let usual = next() > strange;
            let size = if usual { 0.1 + next() } else { sizes[(next() * sizes.len() as f64) as usize] };
            size * if next() < 0.5 { -1.0 } else { 1.0 }
        };
        let share = [0.01, 0.05, 0.3][seed as usize % 3];
        let (mut start, mut pieces) = (any(share), Vec::new());
        for _ in 0..1 + seed % 3 {
            let length = any(share).abs();
            let mut coefficients = [SVector::zeros(); 6].map(|of: SVector<f64, N>| of.map(|_| any(share)));
            if let Some(last) = pieces.last().map(|last: &Piece<f64, N>| last.at(last.end())).filter(|_| any(0.0) > 0.0) {
                (coefficients[0], coefficients[1]) = (last.q, last.slope);
            }
            pieces.push(Piece::new(start, length, coefficients));
            start += length;
        }
        let (velocity, effort) = ([(); N].map(|()| any(share).abs() * 3.0), [(); N].map(|()| any(share).abs() * 100.0));
        let Ok(path) = JointPath::new(pieces) else { continue };
        let Ok(limits) = Limits::velocity(velocity).and_then(|of| of.with_effort(effort.map(|x| -x), effort)) else { continue };
        let speed = if seed % 5 == 0 { [any(0.5).abs(), any(0.5).abs()] } else { [0.0; 2] };
        with_timing(chain, &path, &limits, Ends { speed, hold: false }, 1e-2, 300, |timing| {
            let Ok(timing) = timing else { return };
            timed += 1;
            assert!(timing.seconds() > 0.0 && timing.lower_bound() <= timing.seconds(), "{seed}: {}", timing.seconds());
            for i in 0..timing.segments() {
                for t in [0.01, 0.3, 0.7, 0.99] {
                    let at = timing.reference(&timing.at(i, t).expect("a segment"));
                    let tau = chain.torque_with_friction(&at.q, &at.dq, &at.ddq);
                    for j in 0..N {
                        let share = (at.dq[j].abs() / velocity[j]).max(tau[j].abs() / effort[j]);
                        assert!(share <= 1.0 + 1e-9, "{seed}, joint {j}, segment {i} at {t}: {share}");
                    }
                }
            }
        });
    }
    timed
}

#[test]
fn strange_numbers_are_an_error_or_a_motion() {
    let slide = one_joint(true, [1.0, 0.5], [0.0; 3], 2.0);
    let timed = [strange(&slide, 3000), strange(&chain::scara(), 1000)];
    println!("{timed:?} are timed");
    assert!(timed.iter().all(|timed| *timed > 20), "{timed:?}");
}
