//! The commands: each takes its arguments and gives the exit code.

pub(crate) mod check;
pub(crate) mod completions;
pub(crate) mod convert;
pub(crate) mod count;
pub(crate) mod excite;
pub(crate) mod export;
pub(crate) mod generate;
pub(crate) mod identify;
pub(crate) mod import;
pub(crate) mod manual;
pub(crate) mod package;
pub(crate) mod page;
#[cfg(feature = "run")]
pub(crate) mod run;
pub(crate) mod schema;
pub(crate) mod show;
pub(crate) mod time;
pub(crate) mod verify;
