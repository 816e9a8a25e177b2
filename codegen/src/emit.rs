//! From programs to text, a folder for each language. Absent from here on: mathematics.

pub mod c;
pub mod javascript;
pub mod matlab;
pub mod python;
pub mod rust;

mod documentation;
mod language;
mod origin;
mod plain;
mod private;

pub use documentation::{Described, DescribedParameters};
pub use language::Language;
pub use origin::{Notes, Origin};
pub use plain::camel;
