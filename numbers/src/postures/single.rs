//! The table of calls in f32.

use armgen_inverse_kinematics::f32 as block;

include!("table.rs");
