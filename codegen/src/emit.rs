//! From programs to text. Absent from here on: mathematics.

pub mod c;
pub mod rust;

mod batch;
mod documentation;
mod literal;
mod runtime;
mod sincos;
