//! The table of calls in f64.

use armgen_inverse_kinematics::f64 as block;

include!("table.rs");
