//! From programs to text, a folder for each language. Absent from here on: mathematics.

pub mod c;
pub mod rust;

mod documentation;
mod origin;

pub use origin::{Notes, Origin};
