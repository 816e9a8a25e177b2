//! From programs to text, a folder for each language. Absent from here on: mathematics.

pub mod c;
pub mod javascript;
pub mod matlab;
pub mod python;
pub mod rust;

mod documentation;
mod head;
mod parameters;
mod plain;
mod private;

pub use armgen_description::language::Language;
pub use armgen_description::origin::Origin;
pub use documentation::{Described, DescribedParameters};
pub use head::Notes;
pub use plain::camel;
