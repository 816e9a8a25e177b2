//! Typical mistakes in the description of an arm, each made once in an arm without a fault: does the diagnostic name the reason?
//!
//! A slip replaces a text of the file by another. All words of its last column must occur in the first diagnostic, help included.
//! A slip that cannot be detected has no words; it is listed so that it is counted.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use armgen_codegen::validate;

const ARM: &str = include_str!("slips/arm.yaml");

/// Name of the slip, the text, its replacement, and the words of the diagnostic.
type Slip = (&'static str, &'static str, &'static str, &'static [&'static str]);

const SLIPS: [Slip; 68] = [
    // Dashes, columns, brackets.
    ("a dash forgotten", "  - name: shoulder", "    name: shoulder", &["dash", ":24:5"]),
    ("the first dash forgotten", "  - name: base", "    name: base", &["a dash is missing", ":11:5"]),
    ("a dash and its blanks forgotten", "  - name: shoulder", "  name: shoulder", &["a dash is missing", ":24:3"]),
    ("a dash without a space", "  - name: elbow", "  -name: elbow", &["a dash must be followed by a space", ":37:"]),
    (
        "a key one column right",
        "    alpha: 0\n    d: 0\n    theta: pi/2",
        "     alpha: 0\n    d: 0\n    theta: pi/2",
        &["5 columns", "4", ":27:"],
    ),
    (
        "a key one column left",
        "    alpha: 0\n    d: 0\n    theta: pi/2",
        "   alpha: 0\n    d: 0\n    theta: pi/2",
        &["3 columns", "4", ":27:"],
    ),
    ("a first key one column left", "      mass: 8.2", "     mass: 8.2", &["5 columns", "6", ":32:"]),
    ("a key after a block one column right", "    motor: {ratio: 80", "     motor: {ratio: 80", &["5 columns", "4", ":48:"]),
    ("a key after a block one column left", "    motor: {ratio: 80", "   motor: {ratio: 80", &["3 columns", "4", ":48:"]),
    ("the first key of all one column right", "name: elbow_arm", " name: elbow_arm", &["1 column", "0", ":2:"]),
    ("a joint one column right", "  - name: elbow", "   - name: elbow", &["3 columns", "2", ":37:"]),
    (
        "a key at the left edge",
        "    alpha: 0\n    d: 0\n    theta: pi/2",
        "alpha: 0\n    d: 0\n    theta: pi/2",
        &["0 columns", "4", ":27:"],
    ),
    ("a colon forgotten", "    alpha: pi/2", "    alpha pi/2", &["colon", ":14:"]),
    ("no space after a colon", "    alpha: pi/2", "    alpha:pi/2", &["space", ":14:"]),
    (
        "no space before a list",
        "{position: [-pi, pi]",
        "{position:[-pi, pi]",
        &["a colon must be followed by a space", "`position: [...`"],
    ),
    ("a colon twice", "yy: 0.21", "yy::0.21", &["`yy: 0.21`"]),
    ("no space before a quote", "yy: 0.21", "yy:'0.21'", &["`yy: '0.21'`"]),
    (
        "no space in a lone line",
        "parameters:\n  l1: 0.425\n  payload_mass: 3",
        "parameters:\n  l1:0.425\n  payload_mass:3",
        &["a colon must be followed by a space", "`l1: 0.425`", ":7:5"],
    ),
    (
        "no space in a lone line of a joint",
        "friction: {viscous: 0.4, coulomb: 1.5}",
        "friction:\n      viscous:0.4",
        &["a colon must be followed by a space", "`viscous: 0.4`"],
    ),
    ("a mark of order within", "mass: 8.2", "mass: \u{feff}8.2", &["byte order mark", "remove it"]),
    ("a wide blank before a comment", "mass: 8.2", "mass: 8.2\u{2003}# kg", &["a space of another width", "type a space"]),
    ("a comment of C left open", "d: 0.32", "d: 0.32/* m", &["a comment?"]),
    ("a bracket left open", "com: [-0.21, 0, 0.1]", "com: [-0.21, 0, 0.1", &["bracket", ":33:"]),
    ("a brace left open", "xy: 0.001}", "xy: 0.001", &["bracket", ":21:"]),
    ("a tab", "    alpha: pi/2", "\talpha: pi/2", &["tab", ":14:"]),
    // Units and signs in numbers.
    ("degrees as a word", "alpha: pi/2", "alpha: 90 deg", &["deg(90)"]),
    ("degrees stuck on", "alpha: pi/2", "alpha: 90deg", &["deg(90)"]),
    ("a degree sign", "alpha: pi/2", "alpha: 45°", &["deg(45)"]),
    ("degrees in limits", "[-pi, pi]", "[-170°, 170 degrees]", &["deg(170)"]),
    ("a length with mm", "a: 0.36", "a: 360 mm", &["0.36"]),
    ("a mass with kg", "mass: 8.2", "mass: 8.2 kg", &["`8.2`", "kg"]),
    ("a mass with g", "mass: 3.1", "mass: 3100 g", &["3.1"]),
    ("an inertia with its unit", "inertia: 6e-5", "inertia: 0.6 kgcm²", &["0.00006"]),
    ("a rotor speed with its unit", "velocity: 3,", "velocity: 180 deg/s,", &["deg(180)"]),
    ("a torque with its unit", "effort: 60", "effort: 60 Nm", &["`60`"]),
    ("an inertia without its square", "yy: 0.21", "yy: 0.21 kg m", &["torque", "inertia", "`0.21`"]),
    ("a unit that is none", "d: 0.32", "d: 5kg/m", &["leave the unit out"]),
    ("an infinite friction", "friction: {viscous: 0.4, coulomb: 1.5}", "friction: inf", &["`friction: {viscous: 0.2}`"]),
    ("a decimal comma", "a: 0.36", "a: 0,36", &["a decimal has a point", "0.36"]),
    ("a time with ms", "d: 0.32", "d: 1 ms", &["0.001"]),
    ("a minus sign of typography", "[-0.15, 0, 0.02]", "[−0.15, 0, 0.02]", &["minus"]),
    ("angles in degrees", "alpha: pi/2", "alpha: 90", &["deg(90)"]),
    ("an angle as a decimal", "alpha: pi/2", "alpha: 1.57", &["pi/2"]),
    // Words of other formats.
    (
        "URDF's dynamics",
        "friction: {viscous: 0.4, coulomb: 1.5}",
        "dynamics: {damping: 0.4, friction: 1.5}",
        &["URDF", "`friction: {viscous: ..., coulomb: ...}`"],
    ),
    ("URDF's damping", "friction: {viscous: 0.4,", "friction: {damping: 0.4,", &["`viscous`"]),
    ("URDF's ixx", "{xx: 0.008, yy: 0.05, zz: 0.048}", "{ixx: 0.008, iyy: 0.05, izz: 0.048}", &["`xx`"]),
    (
        "URDF's origin in a row of Denavit and Hartenberg",
        "    a: 0.36\n",
        "    a: 0.36\n    origin: {xyz: [0, 0, 0]}\n",
        &["convention: urdf"],
    ),
    ("URDF's limits", "position: [-2, 2]", "lower: -2, upper: 2", &["position: [lowest, highest]"]),
    (
        "the toolbox's Jm and G",
        "    motor: {ratio: 80, inertia: 6e-5}",
        "    Jm: 6e-5\n    G: 80",
        &["`motor: {ratio: ..., inertia: ...}`"],
    ),
    ("the toolbox's Tc", "coulomb: 1.5", "Tc: 1.5", &["`coulomb`"]),
    ("the toolbox's qlim", "limits: {position: [-2, 2],", "qlim: [-2, 2]\n    limits: {", &["`limits: {position: ...}`"]),
    (
        "a tensor of nine elements",
        "{xx: 0.008, yy: 0.05, zz: 0.048}",
        "[[0.008, 0, 0], [0, 0.05, 0], [0, 0, 0.048]]",
        &["xx: 0.008, yy: 0.05, zz: 0.048"],
    ),
    (
        "a tensor of nine elements, unsymmetric",
        "{xx: 0.008, yy: 0.05, zz: 0.048}",
        "[[0.008, 0.001, 0], [0.002, 0.05, 0], [0, 0, 0.048]]",
        &["xy", "yx", "0.001", "0.002"],
    ),
    ("a tensor of six elements", "{xx: 0.008, yy: 0.05, zz: 0.048}", "[0.008, 0.05, 0.048, 0.001, 0, 0]", &["xx", "which order"]),
    (
        "a pose whose numbers are long",
        "payload: {mass",
        "tool: [0, 0, sqrt(2)/10 + sqrt(3)/10 + 0.00000000000000001]\npayload: {mass",
        &["`tool: {xyz: [0, 0, 0.1], rpy: [0, pi/2, 0]}`"],
    ),
    (
        "a tensor whose numbers are long",
        "{xx: 0.008, yy: 0.05, zz: 0.048}",
        "[0.008, 0.05, 0.04800000000000000000000000000000000000000001]",
        &["`inertia: {xx: ..., yy: ..., zz: ...}`"],
    ),
    ("a fixed joint", "name: elbow\n    type: revolute", "name: elbow\n    type: fixed", &["Leave a fixed joint out"]),
    // Values in other units, or in other places.
    ("a length in mm", "a: 0.36", "a: 360", &["mm", "0.36"]),
    ("masses in g", "mass: 8.2", "mass: 8200", &["in g", "8.2"]),
    ("an inertia in kg cm²", "{xx: 0.03, yy: 0.21, zz: 0.2}", "{xx: 300, yy: 2100, zz: 2000}", &["kg cm²", "0.21"]),
    ("a centre of mass in mm", "com: [-0.21, 0, 0.1]", "com: [-210, 0, 100]", &["mm"]),
    ("a link ten times as heavy", "mass: 8.2", "mass: 82", &["8.2"]),
    ("a rotor reflected already", "motor: {ratio: 80, inertia: 6e-5}", "motor: {ratio: 80, inertia: 0.384}", &["reflected"]),
    ("a ratio inverted", "ratio: 80", "ratio: 0.0125", &["80"]),
    ("a velocity in degrees", "velocity: 3,", "velocity: 172,", &["deg(172)"]),
    ("a point slipped in two elements of a tensor", "yy: 0.21, zz: 0.2}", "yy: 2.1, zz: 2}", &["too large"]),
    ("limits the wrong way round", "[-2.6, 2.6]", "[2.6, -2.6]", &["2.6"]),
    ("gravity along the wrong axis", "[0, 0, -9.81]", "[0, -9.81, 0]", &[]),
];

#[test]
fn the_arm_itself_has_no_fault() {
    let source = Source::new("arm.yaml", ARM);
    let (arm, diagnostics) = validate::read(&source);
    assert!(arm.is_some() && diagnostics.iter().count() == 0, "{}", diagnostics.render(&source, Colour::Never));
}

#[test]
fn slips_are_named_with_their_reason() {
    let mut silent = Vec::new();
    let mut unnamed = String::new();
    for (title, text, slipped, expected) in SLIPS {
        assert_eq!(ARM.matches(text).count(), 1, "{title}: the text stands there once");
        let source = Source::new("arm.yaml", ARM.replace(text, slipped));
        let (_, diagnostics) = validate::read(&source);
        let said = diagnostics.render(&source, Colour::Never);
        let first = said.split("\n\n").next().unwrap_or_default();
        if first.is_empty() {
            silent.push(title);
        }
        if !expected.iter().all(|word| first.contains(word)) {
            unnamed += &format!("== {title}: {expected:?}\n{first}\n");
        }
    }
    println!("{} slips, silent: {silent:?}", SLIPS.len());
    assert!(unnamed.is_empty(), "{unnamed}");
    assert_eq!(silent, ["gravity along the wrong axis"]);
}
