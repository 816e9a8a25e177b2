//! The options of an excitation, from a file in YAML.

use armgen_codegen::diagnostic::{Code as Shared, Diagnostics};
use armgen_codegen::document::reader::{first_key, optional, Key, Reader};
use armgen_codegen::document::yaml::{self, Kind, Node};
use armgen_codegen::source::{Source, Span};

use super::{Code, TOOL};

/// Choices of an excitation.
#[derive(Clone, Debug)]
pub struct Options {
    /// s of the motion, without its lead-in.
    pub duration: f64,
    /// Harmonics.
    pub harmonics: usize,
    /// Samples a second.
    pub rate: f64,
    /// Where the lead-in starts, by joint; others at 0, or at the end of their range that is nearest to it.
    pub start: Vec<(String, f64)>,
    /// Ranges of x, y and z of the origins of frames, m.
    pub box_: [Option<[f64; 2]>; 3],
    /// The frames that the box is about.
    pub frames: Vec<String>,
    /// Chooses the starts of the search.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            duration: 10.0,
            harmonics: 5,
            rate: 100.0,
            start: Vec::new(),
            box_: [None; 3],
            frames: vec![TOOL.to_owned()],
            seed: 1,
        }
    }
}

const KEYS: [Key; 4] = [optional("start"), optional("box"), optional("frames"), optional("seed")];
const AXES: [Key; 3] = [optional("x"), optional("y"), optional("z")];

/// Reads options; faults go to the diagnostics.
pub fn read(source: &Source) -> (Options, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let mut options = Options::default();
    let root = yaml::read(source, &mut diagnostics);
    let mut reader = Reader::new(&mut diagnostics);
    if let Some(root) = reader.root(source, root.as_ref(), "an options file", "write for instance `box: {z: [0.1, 1.5]}`") {
        if let Some(fields) = reader.mapping(root, "the options", Span::new(0, 0), &KEYS) {
            if let Some((key, node)) = fields.get("start") {
                if let Kind::Mapping(entries) = &node.kind {
                    for (name, value) in entries {
                        if let Some(number) = number(&mut reader, value, name.span, &name.value) {
                            options.start.push((name.value.clone(), number));
                        }
                    }
                } else {
                    reader.wrong_kind(
                        node,
                        key,
                        "start",
                        "a mapping",
                        "write for instance `start: {shoulder: 0.5, elbow: pi/2}`",
                    );
                }
            }
            if let Some((_, node)) = fields.get("box") {
                if let Some(axes) = reader.mapping(node, "`box`", first_key(node), &AXES) {
                    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
                        options.box_[k] = axes.get(name).and_then(|(key, node)| range(&mut reader, node, key, name));
                    }
                }
            }
            if let Some((key, node)) = fields.get("frames") {
                let help = "write the names in brackets, for instance `frames: [elbow, tool]`";
                let items = reader.list(node, key, "frames", "a list", help).unwrap_or_default();
                let names = items.iter().filter_map(|item| reader.text(item, key, "a frame", "a name", help));
                options.frames = names.map(|name| name.value).collect();
            }
            if let Some((key, node)) = fields.get("seed") {
                match number(&mut reader, node, key, "seed") {
                    Some(seed) if seed >= 0.0 && seed.fract() == 0.0 && seed < 1e15 => options.seed = seed as u64,
                    Some(_) => reader.report(
                        Code::OutOfRange,
                        node.span,
                        "`seed` is no whole number from 0 on",
                        "",
                        "write for instance `seed: 2`",
                    ),
                    None => {}
                }
            }
        }
    }
    diagnostics.sort();
    (options, diagnostics)
}

fn range(reader: &mut Reader<'_>, node: &Node, key: Span, name: &str) -> Option<[f64; 2]> {
    let help = "write two numbers in metres, for instance `z: [0.1, 1.5]`";
    let items = reader.list(node, key, name, "a list of two numbers", help)?;
    let both: Vec<f64> = items.iter().filter_map(|item| number(reader, item, key, name)).collect();
    match both[..] {
        [low, high] if low < high => Some([low, high]),
        _ => {
            reader.report(Code::OutOfRange, node.span, format!("`{name}` is no range"), "not a lower and a higher number", help);
            None
        }
    }
}

fn number(reader: &mut Reader<'_>, node: &Node, key: Span, name: &str) -> Option<f64> {
    let expression = reader.expression(node, key, name, "write a number")?;
    match expression.to_f64() {
        Ok(number) if number.is_finite() => Some(number),
        Ok(_) => {
            reader.report(Shared::NotFinite, node.span, format!("`{name}` is not finite"), "not finite", "write a number");
            None
        }
        Err(place) => {
            reader.report(Shared::UnknownName, place, "names have no values here", "unknown name", "write a number");
            None
        }
    }
}
