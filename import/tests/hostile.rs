//! Texts that are made to be difficult: refused with a place, in bounded time, or imported.

use armgen_codegen::diagnostic::Colour;
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
#[ignore = "wide"]
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

/// The parser keeps all namespaces of the elements around one at each.
#[test]
fn declarations_of_namespaces_are_counted_over_the_whole_file() {
    let nested = |count: usize, end: &str| {
        let open: String = (0..count).map(|k| format!("<visual a='=' xmlns:n{k}{end}'u{k}'>")).collect();
        arm(&(open + &"</visual>".repeat(count)))
    };
    for end in ["=", " =\n"] {
        check(nested(100, end), None);
        check(nested(101, end), Some(Code::TooLarge));
    }
    let declared: String = (0..101).map(|k| format!("xmlns:n{k}='u' ")).collect();
    check(format!("<robot {declared}/>"), Some(Code::TooLarge));
}

/// A suggestion compares a name with all others.
#[test]
fn of_many_unknown_names_the_first_few_get_a_suggestion() {
    let joints = |element: &dyn Fn(usize) -> String| -> usize {
        let text: String = (0..1000)
            .map(|k| {
                let parent = if k == 0 { "base".to_owned() } else { format!("link{}", k - 1) };
                format!("<link name='link{k}'/><joint name='joint{k}' type='revolute'><child link='link{k}'/>{}<parent link='{parent}'/></joint>", element(k))
            })
            .collect();
        let source = Source::new("robot.urdf", format!("<robot name='r'><link name='base'/>{text}</robot>"));
        let options = Options { tip: Some("link0".into()), ..Options::default() };
        let (imported, diagnostics) = import(&source, &options);
        assert!(imported.is_none() && diagnostics.errors() > 990, "{}", diagnostics.errors());
        assert!(diagnostics.iter().all(|diagnostic| !diagnostic.help.is_empty()));
        diagnostics.iter().filter(|diagnostic| diagnostic.help.contains("did you mean")).count()
    };
    assert_eq!(joints(&|k| format!("<parent link='linc{k}'/>")), 8);
    assert_eq!(joints(&|k| format!("<mimic joint='joinnt{k}'/>")), 8);
}

/// The numbers of examined unread names and of suggestions for classes are bounded.
#[test]
fn many_names_of_attributes_and_classes_are_read_in_bounded_time() {
    let joint = |attributes: String| format!("<joint name='j' type='continuous'><axis {attributes}/></joint>");
    let spelt: String = (0..100).map(|k| joint((0..900).map(|i| format!("a{k}x{i}='1' ")).collect())).collect();
    let source = Source::new("robot.urdf", arm(&spelt));
    let (_, diagnostics) = import(&source, &Options::default());
    assert!(diagnostics.warnings() <= 1001, "{}", diagnostics.warnings());
    let classes: String = (0..20_000).map(|k| format!("<default class='class{k}'/>")).collect();
    let bodies: String = (0..20_000).map(|k| format!("<geom class='clas{k}'/>")).collect();
    let model = format!("<mujoco><default>{classes}</default><worldbody>{bodies}</worldbody></mujoco>");
    let (imported, diagnostics) = import(&Source::new("m.xml", model), &Options::default());
    assert!(imported.is_none() && diagnostics.errors() >= 20_000, "{}", diagnostics.errors());
    assert_eq!(diagnostics.iter().filter(|diagnostic| diagnostic.help.contains("did you mean")).count(), 8);
}

/// Each joint follows the previous one with the factor 2: within the bounds of a description, and in bounded time.
#[test]
fn a_long_line_of_followers_is_refused_in_bounded_time() {
    let line = |count: usize, last: &str, text: &str| {
        let fingers: String = (0..count)
            .map(|k| {
                let leader = if k + 1 == count { last.to_owned() } else { format!("f{}", k + 1) };
                format!(
                    "<link name='f{k}'/><joint name='f{k}' type='continuous'><parent link='one'/><child link='f{k}'/>\
                     <mimic joint='{leader}' {text}/></joint>"
                )
            })
            .collect();
        arm("").replace("</robot>", &format!("{fingers}</robot>"))
    };
    let import = |text: String, lock: Option<&str>| {
        let lock = lock.map(|joint| (joint.to_owned(), "0.1".to_owned())).into_iter().collect();
        let options = Options { tip: Some("one".into()), lock, massless: true, ..Options::default() };
        let (imported, diagnostics) = import(&Source::new("robot.urdf", text), &options);
        assert_eq!(imported.is_some(), !diagnostics.has_errors());
        diagnostics.iter().map(|diagnostic| diagnostic.code.name()).filter(|code| *code != "no-mass").collect::<Vec<_>>()
    };
    let by_two = "multiplier='2' offset='0.1'";
    assert_eq!(import(line(20, "none", by_two).replace(&format!("<mimic joint='none' {by_two}/>"), ""), None).len(), 0);
    assert_eq!(import(line(10_000, "f0", by_two), None), ["mimic"]);
    assert_eq!(import(line(10_000, "none", by_two), None), ["unknown-joint"]);
    assert_eq!(import(line(10_000, "f9000", by_two), Some("f9999")), ["too-large"]);
    // What follows the joint of the arm belongs to it.
    assert_eq!(import(line(10_000, "j", by_two), None), ["too-many-joints"]);
    assert_eq!(import(line(31, "j", "multiplier='-1'"), None).len(), 0);
    // The last one turns 2^31 times as far.
    assert_eq!(import(line(31, "j", by_two), None).len(), 0);
}

/// A joint that 10 000 others follow, and 10 000 joints on each other, each of which follows the one below it.
#[test]
fn many_followers_are_taken_in_in_bounded_time() {
    let followers = |parent: &dyn Fn(usize) -> String, leader: &dyn Fn(usize) -> String| {
        let all: String = (0..10_000)
            .map(|k| {
                format!(
                    "<link name='f{k}'/><joint name='f{k}' type='continuous'><parent link='{}'/><child link='f{k}'/><mimic joint='{}'/></joint>",
                    parent(k),
                    leader(k)
                )
            })
            .collect();
        let source = Source::new("robot.urdf", arm("").replace("</robot>", &format!("{all}</robot>")));
        let (imported, diagnostics) = import(&source, &Options { tip: Some("one".into()), ..Options::default() });
        assert!(imported.is_none());
        diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect::<Vec<_>>()
    };
    let below = |k: usize| if k == 0 { "one".to_owned() } else { format!("f{}", k - 1) };
    let next = |k: usize| if k + 1 == 10_000 { "j".to_owned() } else { format!("f{}", k + 1) };
    assert_eq!(followers(&|_| "one".into(), &|_| "j".into()), ["too-many-joints"]);
    assert_eq!(followers(&|_| "base".into(), &|_| "j".into()), ["too-many-joints"]);
    assert_eq!(followers(&below, &next), ["too-many-joints"]);
    assert_eq!(followers(&below, &|_| "f9999".into()), ["mimic"]);
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
    check(format!("{text}</robot>"), None);
}

#[test]
#[ignore = "wide"]
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
    // A class that gives nothing is looked through for each attribute of each joint.
    let joints = "<joint/>".repeat(30_000);
    let bodies = format!("<body>{inertial}<joint/>{}</body>", "<body><joint/></body>".repeat(30_000));
    check(format!("<mujoco><default>{joints}</default><worldbody>{bodies}</worldbody></mujoco>"), Some(Code::SeveralTips));
    let loop_of_classes = "<default class='a'><default class='b'><default class='a'><joint/></default></default></default>";
    check(format!("<mujoco>{loop_of_classes}<worldbody><body>{inertial}<joint class='b'/></body></worldbody></mujoco>"), None);
}

/// Kind and text of each diagnostic of a file.
fn said(text: &str) -> Vec<(&'static str, String)> {
    let (_, diagnostics) = import(&Source::new("robot.xml", text), &Options::default());
    diagnostics.iter().map(|d| (d.code.name(), format!("{}; {}", d.message, d.help))).collect()
}

/// Each entity, in a value and between tags: what ends it, or what stands for it.
#[test]
fn entities_are_told_what_they_lack() {
    for (written, expected) in [
        ("&gt ", "end it with `;`: `&gt;`"),
        ("&#48 ", "end it with `;`: `&#48;`"),
        ("&foo;", "there is no entity `&foo;`"),
        ("a & b", "write `&amp;`"),
        ("& ", "write `&amp;`"),
    ] {
        for text in [format!("<robot name=\"{written}\"/>"), format!("<robot name=\"r\">{written}</robot>")] {
            let said = said(&text);
            assert!(said.len() == 1 && said[0].1.contains(expected), "{text}: {said:?}");
        }
    }
}

/// A missing element is reported, and its consequences are not.
#[test]
fn classes_of_a_file_that_is_not_there_are_not_called_unknown() {
    let body = r#"<body name="link" childclass="arm"><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/><joint name="one" class="big"/></body>"#;
    let codes =
        |inside: &str| -> Vec<&str> { said(&format!("<mujoco>{inside}</mujoco>")).iter().map(|(code, _)| *code).collect() };
    assert_eq!(codes(&format!(r#"<include file="d.xml"/><worldbody>{body}</worldbody>"#)), ["mjcf-feature"]);
    assert_eq!(codes(r#"<actuator><motor class="big" joint="one"/></actuator>"#), ["missing-element"]);
    let unknown = said(&format!("<mujoco><worldbody>{body}</worldbody></mujoco>"));
    assert!(
        unknown.iter().all(|(code, said)| *code == "unknown-class" && said.contains("add the one of this class")),
        "{unknown:?}"
    );
    assert_eq!(unknown.len(), 2);
}

#[test]
fn names_within_what_stands_for_others_are_not_read() {
    let composite = r#"<composite type="cable" count="3 1 1"><joint kind="main" solreffix="1 1"/></composite>"#;
    let said = said(&format!("<mujoco><worldbody>{composite}</worldbody></mujoco>"));
    assert!(said.iter().any(|(code, _)| *code == "mjcf-feature"), "{said:?}");
    assert!(!said.iter().any(|(code, _)| code.starts_with("misspelt") || code.starts_with("unread")), "{said:?}");
}

/// What parsers of ROS and MuJoCo read all the same: places stay, and so does the arm.
#[test]
fn harmless_slips_of_xml_are_read() {
    let model = arm("<axis xyz='0 1 0'/>");
    let yaml = |text: &str| {
        let (imported, diagnostics) = import(&Source::new("robot.urdf", text), &Options::default());
        let yaml = imported.map(|imported| imported.yaml);
        yaml.unwrap_or_else(|| panic!("{text}: {}", diagnostics.render(&Source::new("robot.urdf", text), Colour::Never)))
    };
    let expected = yaml(&model);
    let declaration = "<?xml version=\"1.0\" encoding=\"utf-8\"?>";
    for before in
        ["", " ", "<!-- é -->", "<!-- a -- b -->", "<!---->", "<!----->", "<!-- a --->", "<!--- <link name=\"x\"/> - -- --- -->"]
    {
        assert_eq!(yaml(&format!("{before}{model}")), expected, "{before}");
        assert_eq!(yaml(&format!("{before}{declaration}{model}")), expected, "{before}");
        assert_eq!(yaml(&model.replace("<joint", &format!("{before}<joint"))), expected, "{before}");
    }
    check(format!("{declaration}{declaration}{model}"), Some(Code::XmlSyntax));
    check(format!("<!-- {model}"), Some(Code::XmlSyntax));
    check("<!--", Some(Code::XmlSyntax));
    check("<!-->", Some(Code::XmlSyntax));
    check("<!--->", Some(Code::XmlSyntax));
    check("<!-- -->", Some(Code::XmlSyntax));
}

/// Definitions that nothing uses mean nothing; a use of any, wherever the arm is made of it, is told once.
#[test]
fn what_is_left_of_xacro_is_left_out() {
    let model = arm("<axis xyz='0 1 0'/>").replacen("<robot", "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'", 1);
    let with = |element: &str| model.replace("</robot>", &format!("{element}</robot>"));
    for unused in [
        "<xacro:property name='width' value='.2'/>",
        "<xacro:arg name='prefix' default=''/>",
        "<xacro:macro name='m' params='l'><link name='${l}'/></xacro:macro>",
        "<link name='seen'><visual><xacro:shape size='${width}'/></visual></link><joint name='f' type='fixed'><parent link='one'/><child link='seen'/></joint>",
        "<gazebo><plugin><robotNamespace>${name}</robotNamespace></plugin></gazebo>",
        // Nothing of the arm depends on where a sensor of the base is.
        "<link name='imu'/><joint name='m' type='fixed'><parent link='base'/><child link='imu'/><origin xyz='$(optenv PLACE 0 0 1)'/></joint>",
    ] {
        let source = Source::new("robot.urdf", with(unused));
        let (imported, diagnostics) = import(&source, &Options::default());
        let report = imported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never))).report;
        assert!(diagnostics.is_empty());
        let noted = report.lines().iter().any(|line| line.contains("that nothing uses"));
        assert_eq!(noted, unused.starts_with("<xacro"), "{unused}: {:?}", report.lines());
    }
    for used in ["<xacro:arm/>", "<xacro:if value='1'/>", "<xacro:include filename='a.xacro'/>", "<link name='${prefix}two'/>"] {
        let said = said(&with(&used.repeat(20)));
        assert!(said.len() == 1 && said[0].0 == "xacro" && said[0].1.contains("pip install xacro"), "{used}: {said:?}");
    }
    let said = said(&model.replace("0 1 0", "${x} $(arg y) ${z + 1}"));
    assert!(said.len() == 1 && said[0].0 == "xacro", "{said:?}");
}

/// Sizes of many digits, and shapes whose numbers are far apart: an arm, or a fault.
#[test]
fn shapes_of_difficult_sizes_are_read_in_bounded_time() {
    let model = |geoms: &str| format!("<mujoco><worldbody><body><joint/>{geoms}</body></worldbody></mujoco>");
    let digits = format!("0.{}", "123456789".repeat(20));
    for kind in ["box", "ellipsoid", "capsule", "cylinder", "sphere"] {
        for sizes in [format!("{digits} {digits} {digits}"), "1e-3 1e3 1e-3".to_owned(), "7 1e-9 3".to_owned()] {
            check(model(&format!("<geom type='{kind}' size='{sizes}'/>")), None);
            let ends = format!("{digits} 0 1e-3 -{digits} 3 7");
            check(model(&format!("<geom type='{kind}' size='{sizes}' fromto='{ends}' density='{digits}'/>")), None);
        }
        check(model(&format!("<geom type='{kind}' size='1e-200 1e-200 1e-200'/>")), Some(Code::OutOfRange));
        check(model(&format!("<geom type='{kind}' size='1e300 1e300 1e300' mass='1'/>")), Some(Code::OutOfRange));
    }
    check(model(&"<geom size='0.1'/>".repeat(1001)), Some(Code::TooLarge));
}
