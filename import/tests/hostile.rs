//! Texts that are made to be difficult: refused with a place, in bounded time, or imported.

use armgen_codegen::source::Source;
use armgen_import::{import, Code, Options};

const BODY: &str = r#"<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"#;

#[track_caller]
fn check(text: impl Into<String>, code: Option<Code>) {
    let source = Source::new("robot.urdf", text);
    let (imported, diagnostics) = import(&source, &Options::default());
    for label in diagnostics.iter().flat_map(|diagnostic| &diagnostic.labels) {
        assert!(source.text().get(label.span.range()).is_some(), "{label:?} begins or ends within a character");
    }
    let codes: Vec<&str> = diagnostics.iter().map(|d| d.code.name()).collect();
    assert_eq!(imported.is_some(), code.is_none(), "{codes:?}");
    if let Some(code) = code {
        assert!(diagnostics.iter().any(|d| d.code == code), "{codes:?}");
    }
}

fn arm(inside: &str) -> String {
    format!(
        r#"<robot name="r"><link name="base"/><link name="one">{BODY}</link><joint name="j" type="revolute">{inside}<parent link="base"/><child link="one"/></joint></robot>"#
    )
}

#[test]
fn spellings_of_the_text() {
    check(arm(""), None);
    check(format!("\u{feff}{}", arm("")), None);
    check(arm("").replace("><", ">\r\n<"), None);
    check(format!("<?xml version='1.0'?>\n<!-- <robot> -->\n{}", arm("<![CDATA[ <a> ]]>")), None);
    check(arm("<origin xyz='0 0 &#48;.5'/>"), None);
    check(arm("").replace("robot name", "robot title"), None);
}

/// Every text that is cut off, or lacks a stretch, has a place for what is wrong with it, or is an arm.
#[test]
fn what_is_left_of_a_file() {
    for text in [include_str!("urdf/everything.urdf"), include_str!("mjcf/everything.xml")] {
        for at in (0..text.len()).step_by(3) {
            for length in [1, 7, 40, text.len()] {
                let rest = text.get(at + length..).unwrap_or_default();
                let source = Source::new("robot", format!("{}{rest}", &text[..at]));
                let (imported, diagnostics) = import(&source, &Options { tip: Some("tip".into()), ..Options::default() });
                assert_eq!(imported.is_some(), !diagnostics.has_errors());
                for label in diagnostics.iter().flat_map(|diagnostic| &diagnostic.labels) {
                    assert!(source.text().get(label.span.range()).is_some(), "{label:?}");
                }
            }
        }
    }
}

/// Found by fuzzing.
#[test]
fn places_hold_whole_characters() {
    check(arm("<limit velocity='1'/\u{fffd}"), Some(Code::XmlSyntax));
    check(arm("<\u{fffd}:\u{e9} xmlns:\u{fffd}='x'/>"), None);
}

#[test]
fn what_is_no_arm() {
    for text in [
        "",
        " ",
        "robot",
        "\u{0}",
        "<robot",
        "<robot>",
        "<robot></robot>x<robot/>",
        "<robot name='a' name='b'/>",
        "<?xml?>",
        "<!-- ",
        "<a:b/>",
        "<mujocoo/>",
        "&amp;",
    ] {
        check(text, Some(Code::XmlSyntax));
    }
    check("<robot/>", Some(Code::MissingElement));
}

#[test]
fn too_much_of_anything_is_an_error() {
    check("<a>".repeat(100_000), Some(Code::TooLarge));
    check(format!("<robot>{}</robot>", "<a/>".repeat(100_001)), Some(Code::TooLarge));
    let attributes: String = (0..300_000).map(|k| format!(" a{k}=''")).collect();
    check(format!("<robot{attributes}/>"), Some(Code::TooLarge));
    check(format!("<robot name='{}'/>", "x".repeat(17 << 20)), Some(Code::TooLarge));
    check(format!("<robot name='{}'/>", "x".repeat(8 << 20)), Some(Code::MissingElement));
    check(arm(&format!("<origin xyz='0 0 {}'/>", "1".repeat(100_000))), Some(Code::OutOfRange));
    check(arm("<origin xyz='0 0 1e999999999'/>"), Some(Code::OutOfRange));
    check(arm(&format!("<origin xyz='{}'/>", "1 ".repeat(1_000_000))), Some(Code::WrongLength));
}

#[test]
fn a_long_line_of_joints_is_walked_without_recursion() {
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    for k in 1..=30_000 {
        let (kind, before) = (if k == 1 { "revolute" } else { "fixed" }, k - 1);
        text += &format!(
            "<link name='l{k}'/><joint name='j{k}' type='{kind}'><parent link='l{before}'/><child link='l{k}'/></joint>"
        );
    }
    // Too many elements: a shorter one is walked, and is an arm without masses.
    check(format!("{text}</robot>"), Some(Code::TooLarge));
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    for k in 1..=15_000 {
        let (kind, before) = (if k == 1 { "revolute" } else { "fixed" }, k - 1);
        text += &format!(
            "<link name='l{k}'/><joint name='j{k}' type='{kind}'><parent link='l{before}'/><child link='l{k}'/></joint>"
        );
    }
    check(format!("{text}</robot>"), Some(Code::MissingInertial));
}

#[test]
fn many_bodies_within_frames_are_read_in_bounded_time() {
    let around = |inside: &str, depth: usize| {
        format!(
            "<mujoco><worldbody>{}{inside}{}</worldbody></mujoco>",
            "<frame pos='0 0 1' euler='1 2 3'>".repeat(depth),
            "</frame>".repeat(depth)
        )
    };
    let inertial = "<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/>";
    let arm = format!("<body>{inertial}<joint/>{}</body>", "<body/>".repeat(90_000));
    check(around(&arm, 10), None);
    check(around(&arm, 200), Some(Code::TooLarge));
    check(around(&format!("<body>{inertial}{}</body>", "<joint/>".repeat(90_000)), 1), Some(Code::TooManyJoints));
    let classes: String = (0..5000).map(|k| format!("<default class='c{k}'/>")).collect();
    check(
        format!("<mujoco><default>{classes}</default><worldbody><body>{inertial}<joint class='c1'/></body></worldbody></mujoco>"),
        None,
    );
    let loop_of_classes = "<default class='a'><default class='b'><default class='a'><joint/></default></default></default>";
    check(format!("<mujoco>{loop_of_classes}<worldbody><body>{inertial}<joint class='b'/></body></worldbody></mujoco>"), None);
}
