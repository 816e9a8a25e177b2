use super::*;
use crate::diagnostic::{Code, Colour};

const ARM: &str = "name: arm
convention: standard
gravity: [0, 0, -9.81]
joints:
  - name: shoulder
    type: revolute
    a: 0.5
    alpha: pi/2
    d: 0
    theta: 0
    link: {mass: 2}
";

/// Reads a text and expects these codes, in the order of the text.
#[track_caller]
fn check(text: &str, codes: &[Code]) -> Option<RobotDescription> {
    let source = Source::new("robot.yaml", text);
    let (description, mut diagnostics) = RobotDescription::parse(&source);
    diagnostics.sort();
    let found: Vec<_> = diagnostics.iter().map(|d| d.code).collect();
    assert_eq!(found, codes, "{}", diagnostics.render(&source, Colour::Never));
    description
}

#[test]
fn a_small_arm_is_read_in_every_writing_of_yaml() {
    let arm = check(ARM, &[]).expect("a mapping");
    assert_eq!(arm.joints.expect("joints").value.len(), 1);
    check(&ARM.replace('\n', "\r\n"), &[]);
    check(&format!("\u{feff}{ARM}"), &[]);
    check(&format!("---\n{ARM}...\n"), &[]);
    check(&format!("# \u{4e2d}\u{6587} \u{1f916}\n{ARM}"), &[]);
    check(&ARM.replace("pi/2", "'pi/2'").replace("0.5", "\"0.5\""), &[]);
    check(&ARM.replace("a: 0.5", "a: >\n      0.5\n      + 1"), &[]);
    check(&ARM.replace("{mass: 2}", "&l {mass: 2}").replace("name: arm", "name: arm\npayload: {}"), &[]);
    let json = r#"{"name": "arm", "convention": "standard", "gravity": [0, 0, -9.81], "joints": [{"name": "j", "type": "revolute",
        "a": 1e-3, "alpha": "pi/2", "d": 0, "theta": 0, "link": {"mass": 2, "inertia": {"xx": 1}}}]}"#;
    check(json, &[]);
}

#[test]
fn an_alias_is_the_value_that_it_refers_to() {
    let text = ARM.replace("a: 0.5", "a: &half 0.5").replace("d: 0", "d: *half");
    let joints = check(&text, &[]).and_then(|d| d.joints).expect("joints");
    let joint = &joints.value[0];
    assert_eq!(joint.a, joint.d);
}

#[test]
fn texts_that_hold_no_description() {
    for text in ["", "\u{feff}", "\n\n", "# comment\n", "---\n", "~\n", "null"] {
        check(text, &[Code::EmptyFile]);
    }
    for text in ["robot", "[1, 2]", "- a\n- b\n", "5", "\"name: arm\""] {
        check(text, &[Code::WrongKind]);
    }
    for text in ["\u{0}", "a\tb: [", "{", "a: b: c", "\tname: x", "a: 'x", "- a\nb: c", "@", "`", "%"] {
        let source = Source::new("robot.yaml", text);
        let (_, diagnostics) = RobotDescription::parse(&source);
        assert!(diagnostics.has_errors(), "{text:?}");
    }
}

#[test]
fn every_unknown_and_missing_key_is_reported() {
    check("{}", &[Code::MissingKey]);
    check(&ARM.replace("mass", "mas").replace("gravity", "gravitation"), &[Code::MissingKey, Code::UnknownKey, Code::UnknownKey]);
    check(&format!("{ARM}{ARM}"), &[Code::DuplicateKey; 4]);
    check(&ARM.replace("    d: 0\n    theta: 0\n", ""), &[Code::MissingKey]);
}

#[test]
fn a_key_meant_for_another_is_read_as_that_one() {
    let joints = check(&ARM.replace("alpha", "alhpa"), &[Code::UnknownKey]).and_then(|d| d.joints).expect("joints");
    assert!(joints.value[0].alpha.is_some());
}

#[test]
fn too_much_of_anything_is_an_error() {
    check(&format!("{ARM}# {}\n", "x".repeat(300_000)), &[Code::TooLarge]);
    check(&format!("a: {}{}", "[".repeat(200_000), "]".repeat(10)), &[Code::TooLarge]);
    check(&format!("a: {}", "{x: ".repeat(30_000)), &[Code::TooLarge]);
    check(&"- ".repeat(50_000), &[Code::TooLarge]);
    let mut laughs = String::from("a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n");
    for i in 1..20 {
        laughs += &format!("a{i}: &a{i} [{}]\n", vec![format!("*a{}", i - 1); 10].join(", "));
    }
    check(&laughs, &[Code::TooLarge]);
    // Aliases of one long text: counted by its bytes.
    let long = |aliases: usize| format!("a: &a {}\nb: [{}]\n", "x".repeat(100_000), vec!["*a"; aliases].join(", "));
    check(&long(10), &[Code::UnknownKey, Code::MissingKey, Code::UnknownKey]);
    check(&long(11), &[Code::TooLarge]);
}
