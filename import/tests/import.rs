//! Elements that are easily misread, in one arm of our own making. The result is a valid description.

use armgen_codegen::description::Convention;
use armgen_codegen::diagnostic::Colour;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_import::{import, Imported, Options};

const EVERYTHING: &str = include_str!("urdf/everything.urdf");

fn options() -> Options {
    Options {
        base: Some("base".into()),
        tip: Some("tip".into()),
        lock: vec![("finger".into(), "0.04".into())],
        ..Options::default()
    }
}

#[track_caller]
fn imported(text: &str, options: &Options) -> Imported {
    let source = Source::new("folder/everything.urdf", text);
    let (imported, diagnostics) = import(&source, options);
    imported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never)))
}

#[track_caller]
fn valid(yaml: &str) -> Manipulator {
    let source = Source::new("robot.yaml", yaml);
    let (arm, diagnostics) = validate::read(&source);
    arm.unwrap_or_else(|| panic!("{}\n{yaml}", diagnostics.render(&source, Colour::Never))).0
}

#[test]
fn everything_becomes_a_description_that_a_person_can_read() {
    let Imported { yaml, report } = imported(EVERYTHING, &options());
    insta::with_settings!({prepend_module_to_snapshot => false, omit_expression => true}, {
        insta::assert_snapshot!("everything.yaml", yaml);
        insta::assert_snapshot!("everything.json", report.to_json());
    });
    let arm = valid(&yaml);
    assert_eq!(arm.dof(), 3);
    // Link 1 is the upper arm and the bracket, link 3 the stick and two fingers.
    assert_eq!(arm.joints.iter().map(|joint| joint.link.len()).collect::<Vec<_>>(), [2, 1, 3]);
}

/// Positions of the parts of this file were compared with MuJoCo's own, as were its inertia matrix and bias forces.
#[test]
fn a_mujoco_model_becomes_one_too() {
    let model = include_str!("mjcf/everything.xml");
    let options = Options { tip: Some("tcp".into()), lock: vec![("finger".into(), "0.04".into())], ..Options::default() };
    let source = Source::new("everything.xml", model);
    let (imported, diagnostics) = import(&source, &options);
    let Imported { yaml, report } = imported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never)));
    insta::with_settings!({prepend_module_to_snapshot => false, omit_expression => true}, {
        insta::assert_snapshot!("everything-mjcf.yaml", yaml);
        insta::assert_snapshot!("everything-mjcf.json", report.to_json());
    });
    let arm = valid(&yaml);
    // Two joints of one body: the first link has nothing.
    assert_eq!(arm.joints.iter().map(|joint| joint.link.len()).collect::<Vec<_>>(), [1, 2, 1, 2]);
}

/// One pose in all writings that MJCF has.
#[test]
fn one_rotation_in_every_writing() {
    let model = |attributes: &str, compiler: &str| {
        format!(
            "<mujoco>{compiler}<worldbody><body name='b' {attributes}><inertial mass='1' pos='0.1 0.2 0.3' diaginertia='1 1 1'/><joint/></body></worldbody></mujoco>"
        )
    };
    let radian = "<compiler angle='radian'/>";
    let fixed = "<compiler eulerseq='XYZ'/>";
    let rotation = |attributes: &str, compiler: &str| {
        let yaml = imported(&model(attributes, compiler), &Options { snap: 0.0, ..Options::default() }).yaml;
        valid(&yaml).joints[0].row.before.frame.rotation.clone()
    };
    // Turns by 90 degrees about x, then about the new y: x -> z', y -> ...
    let expected = rotation("euler='90 90 0'", "");
    assert_ne!(expected, rotation("euler='90 90 0'", fixed));
    for (attributes, compiler) in [
        ("euler='0 90 90'", "<compiler eulerseq='ZYX'/>"),
        ("euler='90 0 90'", fixed),
        ("quat='0.5 0.5 0.5 0.5'", ""),
        ("quat='-2 -2 -2 -2'", ""),
        ("axisangle='1 1 1 120'", ""),
        ("xyaxes='0 1 0 0 0 1'", ""),
        ("xyaxes='0 1 0 0 3 1'", radian),
    ] {
        assert_eq!(expected, rotation(attributes, compiler), "{attributes} {compiler}");
    }
    let up = |attributes: &str| rotation(attributes, "").map(|row| row[2].clone());
    for (axis, quat) in [("1 0 0", "1 0 1 0"), ("0 -2 0", "1 1 0 0"), ("0 0 -1", "0 1 0 0"), ("0 0 3", "1 0 0 0")] {
        assert_eq!(rotation(&format!("zaxis='{axis}'"), ""), rotation(&format!("quat='{quat}'"), ""), "{axis}");
    }
    assert_eq!(up("zaxis='3 0 4'").map(|x| x.to_string()), ["3/5", "0", "4/5"]);
}

#[test]
fn every_digit_is_kept_where_nothing_is_snapped() {
    let every = imported(EVERYTHING, &Options { snap: 0.0, ..options() });
    for digits in ["-1.5708", "1.57079632679", "1e-19", "0.7071, 0.7071, 1e-7"] {
        assert!(every.yaml.contains(digits), "{digits} is missing:\n{}", every.yaml);
    }
    valid(&every.yaml);
    assert!(every.report.to_json().contains("\"torque\": 0.0"));
}

/// A number of the report's bound.
fn bound(imported: &Imported, name: &str) -> f64 {
    let json = imported.report.to_json();
    let (_, rest) = json.split_once(&format!("\"{name}\": ")).expect("a bound");
    rest.split([',', '\n']).next().and_then(|number| number.trim().parse().ok()).expect("a number")
}

#[test]
fn what_is_snapped_to_nothing_counts_in_the_bound() {
    let text = EVERYTHING.replace("<origin xyz=\"0 0 0.5\"/>", "<origin xyz=\"0 0 0.5\" rpy=\"1e-6 0 0\"/>");
    let orientation = |text: &str| bound(&imported(text, &options()), "orientation");
    assert!(orientation(&text) > orientation(EVERYTHING) + 0.99e-6);
}

/// A whole arm that is turned about the vertical feels the same gravity; one that is tilted does not.
#[test]
fn what_turns_the_arm_about_gravity_moves_no_torque() {
    let bounds = |rpy: &str| {
        let text = format!(
            "<robot name='a'><link name='b'/><link name='l'><inertial><origin xyz='0.1 0 0'/><mass value='1'/>\
             <inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
             <joint name='j' type='revolute'><parent link='b'/><child link='l'/><origin rpy='{rpy}' xyz='0 0 1'/><axis xyz='0 1 0'/>\
             <limit lower='-1' upper='1' velocity='1' effort='1'/></joint></robot>"
        );
        let imported = imported(&text, &Options::default());
        ["orientation", "torque"].map(|name| bound(&imported, name))
    };
    let [orientation, torque] = bounds("0 0 0.7854");
    assert!(orientation > 1e-6 && torque == 0.0, "{orientation} {torque}");
    let [orientation, torque] = bounds("0.7854 0 0");
    assert!(orientation > 1e-6 && torque > 1e-6, "{orientation} {torque}");
}

/// Limits of 1e6 and more are dropped, smaller ones are kept, and the report counts the dropped ones.
#[test]
fn limits_beyond_any_arm_are_none() {
    let with = |limit: &str| EVERYTHING.replace("lower=\"-2.8973\" upper=\"2.8973\"", limit);
    let of = |limit: &str| imported(&with(limit), &options());
    let beyond = "\"position limits beyond any arm\": 1";
    for limit in ["lower=\"-1e16\" upper=\"1e16\"", "lower=\"-1e6\" upper=\"1\"", "lower=\"-1\" upper=\"1.7976931348623157e308\""]
    {
        let Imported { yaml, report } = of(limit);
        assert!(yaml.contains("limits: {velocity: 2.175, effort: 87}"), "{limit}\n{yaml}");
        assert!(report.to_json().contains(beyond), "{limit}\n{}", report.to_json());
    }
    let kept = of("lower=\"-999999\" upper=\"999999\"");
    assert!(kept.yaml.contains("position: [-999999, 999999]") && !kept.report.to_json().contains(beyond));
}

#[test]
fn a_joint_of_the_chain_can_be_locked() {
    let mut options = options();
    options.lock.push(("slide".into(), "0.3/2".into()));
    options.lock.push(("2nd".into(), "pi/4".into()));
    let yaml = imported(EVERYTHING, &options).yaml;
    assert_eq!(valid(&yaml).dof(), 1);
    assert!(yaml.contains("angle: pi/4"), "{yaml}");
}

/// A joint of the chain that follows a locked joint gets its value from it.
#[test]
fn what_follows_a_locked_joint_stands_still() {
    let text = "<robot name='a'><link name='b'/><link name='l'><inertial><origin xyz='1e-14 0 0'/><mass value='1'/>\
                <inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='1e-17' ixz='0' iyz='0'/></inertial></link><link name='m'/><link name='n'/><link name='o'/>\
                <joint name='three' type='prismatic'><parent link='n'/><child link='o'/><axis xyz='0 1 0'/>\
                <limit lower='-1' upper='1' velocity='1' effort='1'/><mimic joint='two' multiplier='3'/></joint>\
                <joint name='turn' type='revolute'><parent link='b'/><child link='l'/><axis xyz='0 1 0'/>\
                <limit lower='-1' upper='1' velocity='1' effort='1'/></joint>\
                <joint name='one' type='prismatic'><parent link='l'/><child link='m'/><axis xyz='0 1 0'/>\
                <limit lower='-1' upper='1' velocity='1' effort='1'/></joint>\
                <joint name='two' type='prismatic'><parent link='m'/><child link='n'/><axis xyz='0 1 0'/>\
                <limit lower='-1' upper='1' velocity='1' effort='1'/><mimic joint='one' multiplier='-2' offset='0.01'/></joint></robot>";
    let options = Options { lock: vec![("one".into(), "0.04".into())], ..Options::default() };
    let imported = imported(text, &options);
    assert_eq!(valid(&imported.yaml).dof(), 1);
    let locked = "joints that stand still: `one` at 0.04, `two` at (-2)*0.04 + 0.01, `three` at 3*((-2)*0.04 + 0.01)";
    assert!(imported.report.lines().iter().any(|line| line == locked), "{:?}", imported.report.lines());
    // What was taken for 0 in a body stands beside it.
    assert!(imported.yaml.contains("com: [0, 0, 0]  # 1e-14 in line 1\n"), "{}", imported.yaml);
    assert!(imported.yaml.contains("inertia: {xx: 0.1, yy: 0.1, zz: 0.1}  # 1e-17 in line 1\n"), "{}", imported.yaml);
}

/// Fingers outside the chain: each joint with its leader, multiplier and offset, on the link that the joint `turn` of the chain moves.
fn with_fingers(fingers: &[(&str, &str)]) -> String {
    let body = "<inertial><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let finger = |(name, mimic): &(&str, &str)| {
        format!(
            "<link name='{name}_link'>{body}</link><joint name='{name}' type='prismatic'><parent link='l'/><child link='{name}_link'/>\
             <axis xyz='0 1 0'/><limit lower='-1' upper='1' velocity='1' effort='1'/>{mimic}</joint>"
        )
    };
    format!(
        "<robot name='a'><link name='b'/><link name='l'>{body}</link><joint name='turn' type='continuous'><parent link='b'/><child link='l'/>\
         <axis xyz='0 0 1'/></joint>{}</robot>",
        fingers.iter().map(finger).collect::<String>()
    )
}

/// A leader that follows another joint itself: one = 0, two = one + 0.1, three = 2 two, whatever their order in the file.
#[test]
fn what_follows_a_follower_stands_where_that_one_does() {
    let two = "<mimic joint='one' offset='0.1'/>";
    let three = "<mimic joint='two' multiplier='2'/>";
    let mut fingers = [("one", ""), ("two", two), ("three", three)];
    for lock in [None, Some(("one", "0.3", 0.4)), Some(("two", "-0.2", -0.2))] {
        for _ in 0..2 {
            fingers.reverse();
            let locks = lock.iter().map(|(joint, at, _)| (joint.to_string(), at.to_string())).collect();
            let options = Options { tip: Some("l".into()), lock: locks, ..Options::default() };
            let arm = valid(&imported(&with_fingers(&fingers), &options).yaml);
            let mut places: Vec<f64> = arm.joints[0]
                .link
                .iter()
                .map(|part| part.frame.frame.translation[1].as_number().map_or(f64::NAN, |y| y.to_f64()))
                .collect();
            places.sort_by(f64::total_cmp);
            let second = lock.map_or(0.1, |(.., second)| second);
            let first = if lock.is_some_and(|(joint, ..)| joint == "one") { 0.3 } else { 0.0 };
            // The body of the link itself is at 0.
            let mut expected = [0.0, first, second, 2.0 * second];
            expected.sort_by(f64::total_cmp);
            assert!(
                places.len() == 4 && places.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15),
                "{places:?} {expected:?}"
            );
        }
    }
}

/// The last of several elements of one kind in a class holds, and a class precedes the enclosing class.
#[test]
fn the_last_default_of_the_innermost_class_holds() {
    let axis = |class: &str| {
        let model = format!(
            "<mujoco><default><joint axis='1 0 0' damping='1'/><joint axis='0 1 0'/>\
             <default class='inner'><joint axis='0 0 1'/><joint armature='2'/></default></default>\
             <worldbody><body><inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/><joint {class}/></body></worldbody></mujoco>"
        );
        let yaml = imported(&model, &Options::default()).yaml;
        assert!(yaml.contains("viscous: 1"), "{yaml}");
        assert_eq!(yaml.contains("armature: 2"), !class.is_empty(), "{yaml}");
        ["axis: [0, 1, 0]", "axis: [0, 0, 1]"].map(|axis| yaml.contains(axis))
    };
    assert_eq!([axis(""), axis("class='inner'")], [[true, false], [false, true]]);
}

#[test]
fn an_arm_costs_the_same_whatever_frames_its_links_have() {
    // The second file draws the first link's frame elsewhere: turned by right angles, and slid along the axis. The end effector is the same.
    let robot = |o1: &str, a1: &str, o2: &str, a2: &str, com: &str| {
        let body = |com: &str| {
            format!("<inertial><origin xyz='{com}'/><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>")
        };
        format!(
            "<robot name='r'><link name='b'/><link name='l1'>{}</link><link name='l2'>{}</link>\
             <joint name='j1' type='continuous'><origin {o1}/><axis xyz='{a1}'/><parent link='b'/><child link='l1'/></joint>\
             <joint name='j2' type='continuous'><origin {o2}/><axis xyz='{a2}'/><parent link='l1'/><child link='l2'/></joint></robot>",
            body("0 0 0"),
            body(com)
        )
    };
    let plain = robot("xyz='0 0 0.5'", "0 0 1", "xyz='0.3 0 0' rpy='-1.5708 0 0'", "0 0 1", "0.2 0 0");
    let turned = robot("xyz='0 0 0.7' rpy='0 1.5708 0'", "-1 0 0", "xyz='0.2 0 0.3' rpy='-1.5708 -1.5708 0'", "0 0 1", "0.2 0 0");
    let counts = [plain, turned].map(|urdf| {
        let yaml = imported(&urdf, &Options::default()).yaml;
        let model = armgen_codegen::Model::new(valid(&yaml));
        let module = armgen_codegen::schedule::module(&model, &armgen_codegen::schedule::Options::default());
        ["inverse_dynamics", "inertia_matrix", "coriolis_matrix", "gravity", "forward_dynamics"].map(|name| {
            let function = module.functions.iter().find(|f| f.name() == name).unwrap_or_else(|| panic!("{name}"));
            (name, function.steps.len())
        })
    });
    assert_eq!(counts[0], counts[1]);
}

/// What `convert` says beside its file, import says too.
#[test]
fn rows_are_announced_on_the_way_as_well() {
    let standard = imported(EVERYTHING, &Options { convention: Convention::Standard, ..options() });
    for lines in [standard.report.lines(), standard.report.short_lines()] {
        assert!(lines.iter().any(|line| line.starts_with("link frames are others")), "{lines:?}");
    }
    let urdf = imported(EVERYTHING, &options());
    assert!(!urdf.report.lines().iter().any(|line| line.starts_with("link frames are others")), "{:?}", urdf.report.lines());
}

/// URDF 1.1 and later: x, y, z, w of a quaternion in an origin, of joints and of bodies; further limits are named, not kept.
#[test]
fn newer_versions_of_urdf_are_read() {
    let with = |version: &str, origin: &str, limit: &str| {
        let text = format!(
            "<robot name='a' version='{version}'><link name='b'/><link name='l'><visual><geometry><capsule radius='1' length='1'/></geometry></visual>\
             <inertial><origin {origin}/><mass value='1'/><inertia ixx='0.1' iyy='0.2' izz='0.15' ixy='0' ixz='0' iyz='0'/></inertial></link>\
             <joint name='j' type='revolute'><parent link='b'/><child link='l'/><origin xyz='0 0 1' {origin}/><axis xyz='0 1 0'/>\
             <limit lower='-1' upper='1' velocity='1' effort='1' {limit}/></joint></robot>"
        );
        let Imported { yaml, report } = imported(&text, &Options::default());
        let lines: Vec<String> = yaml.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect();
        (lines, report.lines().to_vec())
    };
    let turned = with("1.0", "rpy='0 0 1.5708'", "").0;
    for version in ["1.1", "1.2", "1.7"] {
        let (lines, report) = with(version, "quat_xyzw='0 0 0.70710678 0.70710678'", "");
        let plain = |lines: &[String]| {
            lines.iter().map(|line| line.split("  #").next().unwrap_or_default().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(plain(&lines), plain(&turned), "{version}");
        assert_eq!(
            report.iter().filter(|line| line.contains("of URDF 1.7, of which 1.2 is read")).count(),
            usize::from(version == "1.7")
        );
    }
    // A description has one limit for both accelerations: the smaller.
    let limits_of = |limit: &str| {
        let (lines, report) = with("1.2", "", limit);
        let limits = lines.iter().find_map(|line| line.trim().strip_prefix("limits: ").map(str::to_owned)).expect("limits");
        (limits, report.into_iter().find(|line| line.starts_with("`acceleration` is")))
    };
    let limits = |further: &str| format!("{{position: [-1, 1], velocity: 1, {further}effort: 1}}");
    let smaller = "`acceleration` is the smaller of acceleration and deceleration: 5 and 4 of `j`";
    let given = limits_of("acceleration='5' deceleration='4' jerk='100'");
    assert_eq!(given, (limits("acceleration: 4, jerk: 100, "), Some(smaller.to_owned())));
    assert_eq!(limits_of("acceleration='5' deceleration='5'"), (limits("acceleration: 5, "), None));
    assert_eq!(limits_of("deceleration='3'"), (limits("acceleration: 3, "), None));
    // A quaternion that is no such angle keeps its digits, w first.
    let (lines, _) = with("1.1", "quat_xyzw='1 2 3 4'", "");
    assert_eq!(lines.iter().filter(|line| line.contains("quat: [4, 1, 2, 3]")).count(), 2, "{lines:?}");
}

/// A file without any mass becomes kinematics alone, with one warning, whatever its efforts are.
#[test]
fn a_file_without_masses_is_kinematics_alone() {
    let text = "<robot name='a'><link name='b'/><link name='l'/><link name='m'/>\
                <joint name='j' type='revolute'><parent link='b'/><child link='l'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='1' effort='0'/></joint>\
                <joint name='k' type='revolute'><parent link='l'/><child link='m'/><origin xyz='1 0 0'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' velocity='1' effort='0'/></joint></robot>";
    let (imported, diagnostics) = import(&Source::new("a.urdf", text), &Options::default());
    assert_eq!(diagnostics.iter().map(|fault| fault.code.name()).collect::<Vec<_>>(), ["no-mass"]);
    let Imported { yaml, report } = imported.expect("kinematics");
    assert!(valid(&yaml).is_massless());
    assert!(report.lines().iter().any(|line| line.contains("2 effort limits of 0")), "{:?}", report.lines());
}

/// Velocities beyond which a description is warned of are left out: no bound is computed from them.
#[test]
fn velocities_that_no_joint_reaches_are_left_out() {
    let yaml = |kind: &str, velocity: &str| {
        let text = EVERYTHING.replacen("velocity=\"2.175\"", &format!("velocity=\"{velocity}\""), 1);
        assert_ne!(text, EVERYTHING, "{kind}");
        imported(&text, &options()).yaml
    };
    for (velocity, kept) in [("59.5", true), ("60.1", false), ("1e2", false), ("50000", false)] {
        let yaml = yaml("revolute", velocity);
        assert_eq!(yaml.contains(&format!("velocity: {velocity}")), kept, "{velocity}\n{yaml}");
        // The rule is that of the descriptions.
        let warned = |yaml: &str| {
            let source = Source::new("robot.yaml", yaml);
            validate::read(&source).1.iter().any(|warning| warning.code.name() == "implausible-velocity")
        };
        assert!(!warned(&yaml), "{velocity}");
        if !kept {
            let with = yaml.replacen(
                "limits: {position: [-2.8973, 2.8973], ",
                &format!("limits: {{position: [-2.8973, 2.8973], velocity: {velocity}, "),
                1,
            );
            assert!(with != yaml && warned(&with), "{velocity}\n{yaml}");
        }
    }
}

/// An arm of one joint with a finger and another frame, as a URDF and as a MuJoCo model.
fn with_a_finger(frame: &str) -> [String; 2] {
    let inertial = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let limit = "<axis xyz='0 1 0'/><limit lower='-1' upper='1' velocity='1' effort='1'/>";
    let urdf = format!(
        "<robot name='a'><link name='b'/><link name='l'>{inertial}</link><link name='moving_jaw'>{inertial}</link><link name='{frame}'/>\
         <joint name='j' type='revolute'><parent link='b'/><child link='l'/>{limit}</joint>\
         <joint name='gripper' type='revolute'><parent link='l'/><child link='moving_jaw'/>{limit}</joint>\
         <joint name='f' type='fixed'><parent link='l'/><child link='{frame}'/></joint></robot>"
    );
    let inertial = "<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/>";
    let mjcf = format!(
        "<mujoco><worldbody><body name='l'>{inertial}<joint name='j'/><site name='{frame}'/>\
         <body name='moving_jaw'>{inertial}<joint name='gripper'/></body></body></worldbody></mujoco>"
    );
    [urdf, mjcf]
}

/// Covers and cameras on earlier links of a series of joints leave no choice; a tool's frame there, a branch, or a finger at the end do.
#[test]
fn leaves_on_earlier_links_of_a_series_are_parts_of_them() {
    let inertial = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let arm = |leaf: &str, last: &str, last_parent: &str| {
        format!(
            "<robot name='r'><link name='b'/><link name='l'>{inertial}</link><link name='m'>{inertial}</link>\
             <link name='{last}'>{inertial}</link><link name='{leaf}'>{inertial}</link>\
             <joint name='j1' type='continuous'><parent link='b'/><child link='l'/></joint>\
             <joint name='j2' type='continuous'><parent link='l'/><child link='m'/><axis xyz='0 1 0'/></joint>\
             <joint name='j3' type='continuous'><parent link='{last_parent}'/><child link='{last}'/></joint>\
             <joint name='f' type='fixed'><parent link='l'/><child link='{leaf}'/></joint></robot>"
        )
    };
    let cases = [
        ("cover", "hand", "m", true),
        ("camera_link", "hand", "m", true),
        ("tool0", "hand", "m", false),
        ("cover", "gripper_finger", "m", false),
        ("cover", "hand", "l", false),
    ];
    for (leaf, last, last_parent, accepted) in cases {
        let text = arm(leaf, last, last_parent);
        let source = Source::new("arm", text.as_str());
        let (imported, diagnostics) = import(&source, &Options::default());
        assert_eq!(imported.is_some(), accepted, "{leaf}, {last}: {}", diagnostics.render(&source, Colour::Never));
        let Some(imported) = imported else {
            assert_eq!(diagnostics.iter().next().expect("a fault").code.name(), "several-tips");
            continue;
        };
        assert_eq!(valid(&imported.yaml).dof(), 3, "{}", imported.yaml);
        let note =
            format!("Links fixed to an earlier link are parts of it; `--tip` ends the arm at one of them: `{leaf}` (1 joint)");
        let told = imported.yaml.split_whitespace().filter(|word| *word != "#").collect::<Vec<_>>().join(" ");
        assert!(told.contains(&note), "{told}");
        let chosen = Options { tip: Some(last.to_owned()), ..Options::default() };
        let body = |yaml: &str| yaml.split_once("\njoints:").expect("joints").1.to_owned();
        let same = import(&source, &chosen).0.expect("a chosen tip").yaml;
        assert_eq!(body(&same), body(&imported.yaml));
    }
}

/// A hand with several fingers ends the arm, as `--tip` at it does; where a branch may be meant otherwise, the user chooses.
#[test]
fn an_arm_ends_before_the_fingers_of_its_hand() {
    let inertial = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let link = |name: &str| format!("<link name='{name}'>{inertial}</link>");
    let joint = |name: &str, kind: &str, parent: &str, child: &str, more: &str| {
        let axis = if name.len().is_multiple_of(2) { "0 1 0" } else { "1 0 0" };
        let ends = format!("<parent link='{parent}'/><child link='{child}'/>");
        format!("<joint name='{name}' type='{kind}'>{ends}<axis xyz='{axis}'/><origin xyz='0 0 1'/>{more}</joint>")
    };
    // Names of joints and links of both fingers, what is fixed to the hand, what carries the hand, and the tip.
    let cases = [
        (["finger1", "finger2"], "", "wrist", Some("hand")),
        (["gripper_left", "gripper_right"], "", "wrist", Some("hand")),
        (["jaw_a", "jaw_b"], "tool0", "wrist", Some("tool0")),
        (["finger1", "camera_pan"], "", "wrist", None),
        (["left_arm", "right_arm"], "", "wrist", None),
        (["finger1", "finger2"], "", "gripper_turn", None),
        (["finger1", "finger2"], "", "", None),
    ];
    for (fingers, fixed, wrist, tip) in cases {
        let mut text = link("b") + &link("hand");
        let kind = if wrist.is_empty() { "fixed" } else { "continuous" };
        text += &joint(if wrist.is_empty() { "mount" } else { wrist }, kind, "b", "hand", "");
        for (k, finger) in fingers.iter().enumerate() {
            let (knuckle, end) = (format!("{finger}_link"), format!("{finger}_end"));
            text += &(link(&knuckle) + &link(&end));
            let mimic = if k == 0 { String::new() } else { format!("<mimic joint='{}'/>", fingers[0]) };
            text += &joint(finger, "continuous", "hand", &knuckle, &mimic);
            text += &joint(&format!("{finger}_outer"), "continuous", &knuckle, &end, &format!("<mimic joint='{}'/>", fingers[0]));
        }
        if !fixed.is_empty() {
            text += &(format!("<link name='{fixed}'/>") + &joint("fix", "fixed", "hand", fixed, ""));
        }
        let text = format!("<robot name='r'>{text}</robot>");
        let source = Source::new("arm", text.as_str());
        let (imported, diagnostics) = import(&source, &Options::default());
        let said = diagnostics.render(&source, Colour::Never);
        let Some(tip) = tip else {
            assert!(imported.is_none() && said.contains("error[several-tips]"), "{fingers:?} {wrist}: {said}");
            continue;
        };
        let imported = imported.unwrap_or_else(|| panic!("{fingers:?}: {said}"));
        let warning = format!("the arm ends at `hand` (1 joint), before its fingers: `{}` rests at 0", fingers[0]);
        assert!(said.contains(&warning) && said.contains("fingers-at-rest"), "{said}");
        let (chosen, _) = import(&source, &Options { tip: Some(tip.to_owned()), ..Options::default() });
        assert_eq!(chosen.expect("a chosen tip").yaml, imported.yaml);
        assert_eq!(valid(&imported.yaml).dof(), 1);
    }
}

/// One rule for both formats: the suggestion, copied, gives the arm without its finger; and so does that of the warning where there is no choice.
#[test]
fn the_suggested_tip_leaves_fingers_out() {
    let suggested = |help: &str| {
        let words: Vec<&str> = help.split(['`', ' ']).collect();
        let at = words.iter().position(|word| *word == "--tip").unwrap_or_else(|| panic!("no tip in {help}"));
        words[at + 1].to_owned()
    };
    for frame in
        ["tool0", "tcp", "hand_tcp", "flange", "ee_link", "eef", "gripper_frame_link", "gripperframe", "endEffector", "marker"]
    {
        for text in with_a_finger(frame) {
            let source = Source::new("arm", text.as_str());
            let (found, diagnostics) = import(&source, &Options::default());
            let fault = diagnostics.iter().next().unwrap_or_else(|| panic!("{frame}: nothing is said of {text}"));
            // A site that is no frame of a tool is no choice of a tip.
            let code = if frame == "marker" && text.starts_with("<mujoco") { "finger-as-tip" } else { "several-tips" };
            assert_eq!((fault.code.name(), found.is_some()), (code, code == "finger-as-tip"), "{frame}: {}", fault.message);
            assert!(fault.help.contains("--lock gripper=0"), "{}", fault.help);
            let tip = suggested(&fault.help);
            assert_eq!(tip == frame, code == "several-tips", "{frame}: {}", fault.help);
            let options = Options { tip: Some(tip), lock: vec![("gripper".into(), "0".into())], ..Options::default() };
            let (imported, diagnostics) = import(&source, &options);
            let yaml = imported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, Colour::Never))).yaml;
            assert_eq!(valid(&yaml).dof(), 1, "{yaml}");
        }
    }
}
