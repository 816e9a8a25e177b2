//! Shared by the tests: a SCARA written by hand from its closed forms, and the path that cuts a ghost out of a sheet.
#![allow(dead_code, unreachable_pub)]

pub mod arms;
pub mod chain;
pub mod ghost;
pub mod gimbal;
pub mod mass;
pub mod paths;
pub mod scara;
pub mod single;

/// `value` within `tolerance` of `expected`.
#[track_caller]
pub fn close(what: &str, value: f64, expected: f64, tolerance: f64) {
    println!("{what}: {value:.10e} (expected {expected:e} +- {tolerance:e})");
    assert!((value - expected).abs() <= tolerance, "{what}: {value:e}, expected {expected:e} +- {tolerance:e}");
}

/// `value` within `percent` of `expected`.
#[track_caller]
pub fn close_percent(what: &str, value: f64, expected: f64, percent: f64) {
    close(what, value, expected, expected.abs() * percent / 100.0);
}

/// `value` not above `bound`.
#[track_caller]
pub fn below(what: &str, value: f64, bound: f64) {
    println!("{what}: {value:.10e} (at most {bound:e})");
    assert!(value <= bound, "{what}: {value:e}, at most {bound:e}");
}
