//! From programs to text. Absent from here on: mathematics.

pub mod c;
pub mod rust;

mod batch;
mod body;
mod documentation;
mod literal;
mod runtime;
mod sincos;
