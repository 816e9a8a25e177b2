//! The program armgen.
fn main() {}
