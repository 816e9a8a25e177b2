//! `armgen schema`: the JSON Schema of robot.yaml, for editors.

use armgen_codegen::description::schema;

use crate::terminal;

pub(crate) fn run() -> u8 {
    terminal::print(&schema::text())
}
