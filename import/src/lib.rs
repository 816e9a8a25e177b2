//! A serial chain of a URDF or of a MuJoCo model as a `robot.yaml`: exact wherever it can be, and where not, that is said and bounded;
//! and a `robot.yaml` as a URDF.
//!
//! ```text
//! xml.rs     text -> XML tree with places, bounded
//! xacro.rs   macros that were not written out, and what is left of them
//! number.rs  digits as they stand
//! written.rs a number of robot.yaml beside what the file says
//! snap.rs    1.5708 is pi/2
//! pose.rs body.rs   frames and mass distributions, as robot.yaml writes them
//! values.rs  attributes as numbers, with what must hold for them
//! tree.rs    links and joints
//! format.rs  what the formats have in common
//! urdf.rs    URDF
//! mjcf.rs    MJCF
//! include.rs the files that a MuJoCo model includes, read by the caller
//! unread.rs  what a file says and nothing reads
//! chain.rs   from base to tip: rows, poses, bodies; locked branches lumped; every fault with its place
//! bound.rs   how far snapping can move the flange and the torques
//! yaml.rs    the text of robot.yaml
//! report.rs  what became of everything, as JSON and in words
//! convert.rs from a description to one in rows of another convention
//! export.rs  from a description to a URDF
//! build_script.rs  the face for a build.rs, which alone touches files
//! ```
//!
//! Poses stay lists and bodies stay apart (`attached`): robot.yaml multiplies and adds them exactly, so that no product of rotations is ever
//! written as digits. Formats: URDF as in <https://wiki.ros.org/urdf/XML>, MJCF as in
//! <https://mujoco.readthedocs.io/en/stable/XMLreference.html>.

mod body;
mod bound;
pub mod build_script;
mod chain;
mod code;
mod convert;
mod export;
mod format;
mod include;
mod mjcf;
mod number;
mod options;
mod pose;
mod report;
mod snap;
mod tree;
mod unread;
mod urdf;
mod values;
mod written;
mod xacro;
mod xml;
mod yaml;

use armgen_codegen::description::Convention;
use armgen_codegen::diagnostic::{Diagnostic, Diagnostics, Severity};
use armgen_codegen::source::Source;

pub use code::Code;
pub use convert::{convert, Converted};
pub use export::{export, Exported};
pub use include::{included, Reader};
pub use options::Options;
pub use report::Report;

/// The result of an import.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The text of robot.yaml.
    pub yaml: String,
    /// The parts that were taken, changed and left out.
    pub report: Report,
}

/// The arm of a URDF or a MuJoCo model; [`included`] writes the files out that a model includes. All faults of the file with their places; there is an arm if and only if none of them is an error.
pub fn import(source: &Source, options: &Options) -> (Option<Imported>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let imported = read(source, options, &mut diagnostics);
    diagnostics.sort();
    // Where xacro was not written out, nothing else is worth a word.
    let xacro = diagnostics.iter().find(|fault| fault.code == Code::Xacro).cloned();
    if let Some(first) = xacro {
        diagnostics = Diagnostics::new();
        diagnostics.push(first);
    }
    (imported.filter(|_| !diagnostics.has_errors()), diagnostics)
}

fn read(source: &Source, options: &Options, diagnostics: &mut Diagnostics) -> Option<Imported> {
    let text = xml::without_harmless_slips(source.text());
    let document = xml::parse(&text, source, diagnostics)?;
    let root = document.root_element();
    if xacro::refuse(source, root, diagnostics) {
        return None;
    }
    match root.tag_name().name() {
        "robot" => {
            let (tree, urdf) = urdf::read(root, diagnostics)?;
            taken(source, &tree, &urdf, options, diagnostics)
        }
        "mujoco" => {
            let (tree, mjcf) = mjcf::read(root, diagnostics)?;
            taken(source, &tree, &mjcf, options, diagnostics)
        }
        "sdf" => {
            let message = "this is an SDF, a format that is not read";
            let help = "import the URDF that the model was made from, or write one out: `sdf2urdf` of pysdf, or `sdf2mjcf` of gz-mujoco for a MuJoCo model";
            diagnostics.push(Diagnostic::new(Code::Sdf, xml::place(root), message, "the model of a simulator", help));
            None
        }
        "mujocoinclude" => {
            let message = "this is a part of a MuJoCo model";
            let help = "import the model that includes it";
            diagnostics.push(Diagnostic::new(Code::MjcfFeature, xml::place(root), message, "to be included", help));
            None
        }
        other => {
            let message = format!("the file holds `{}`, not a robot", xml::shown(other));
            let help = "a URDF begins with `<robot name=\"...\">`, a MuJoCo model with `<mujoco>`";
            diagnostics.push(Diagnostic::new(Code::XmlSyntax, xml::place(root), message, "neither `robot` nor `mujoco`", help));
            None
        }
    }
}

/// The arm of a file that was read.
fn taken(
    source: &Source,
    tree: &tree::Tree,
    format: &dyn format::Format,
    options: &Options,
    diagnostics: &mut Diagnostics,
) -> Option<Imported> {
    let arm = chain::arm(source, tree, format, options, diagnostics)?;
    if diagnostics.has_errors() {
        return None;
    }
    let bound = bound::of(&arm);
    let report = report::of(source, format, &arm, bound);
    let yaml = yaml::text(source, &arm, &report);
    if options.convention == Convention::Urdf {
        return Some(Imported { yaml, report });
    }
    let converted = in_rows(&yaml, options.convention, diagnostics)?;
    Some(Imported { yaml: converted.yaml, report: report.and(converted.lines) })
}

/// A description in rows of Denavit and Hartenberg, under the same head; faults are reported.
fn in_rows(yaml: &str, to: Convention, diagnostics: &mut Diagnostics) -> Option<Converted> {
    let head: String = yaml.split_inclusive('\n').take_while(|line| line.starts_with('#')).collect();
    let (converted, faults) = convert(&Source::new("robot.yaml", &yaml[head.len()..]), to);
    if converted.is_none() {
        let faults: Vec<&str> =
            faults.iter().filter(|fault| fault.code.severity() == Severity::Error).map(|fault| fault.message.as_str()).collect();
        let message = format!("this arm has no rows of Denavit and Hartenberg: {}", faults.join("; "));
        let help = "import it with `--convention urdf`, and see what `armgen check` says of that";
        diagnostics.push(Diagnostic::new(Code::NoRows, xml::beginning(), message, "", help));
    }
    let mut converted = converted?;
    // They are import's own, and what they say stands in the report.
    converted.lines.retain(|line| line != convert::COMMENTS);
    Some(Converted { yaml: head + &converted.yaml, ..converted })
}
