//! Joints that follow others: the arm has all that moves with its joints, and the file's factors and offsets digit by digit.

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::source::Source;
use armgen_import::{import, Imported, Options};

use crate::common::valid;

const BODY: &str = "<inertial><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>";

/// A joint of this name from a link to a link of its name.
fn joint(name: &str, kind: &str, parent: &str, inside: &str) -> String {
    format!(
        "<link name='{name}_link'>{BODY}</link><joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{name}_link'/>\
         <axis xyz='0 1 0'/><limit lower='-1' upper='1' velocity='1' effort='1'/>{inside}</joint>\n"
    )
}

fn robot(joints: &[String]) -> Source {
    Source::new("robot.urdf", format!("<robot name='r'><link name='base'/>{}</robot>", joints.concat()))
}

#[track_caller]
fn imported(source: &Source, options: &Options) -> Imported {
    let (imported, diagnostics) = import(source, options);
    imported.unwrap_or_else(|| panic!("{}", diagnostics.render(source, Colour::Never)))
}

fn tip(link: &str) -> Options {
    Options { tip: Some(link.into()), ..Options::default() }
}

/// The second finger stands before its leader in the file, and hangs beside the chain to either finger.
fn gripper() -> Source {
    robot(&[
        joint("wrist", "continuous", "base", ""),
        joint("right", "prismatic", "wrist_link", "<mimic joint='left' multiplier='-1.50' offset='0.010'/>"),
        joint("left", "prismatic", "wrist_link", ""),
        joint("pad", "fixed", "left_link", ""),
    ])
}

#[test]
fn what_moves_with_the_chain_belongs_to_the_arm() {
    let Imported { yaml, report } = imported(&gripper(), &tip("pad_link"));
    insta::with_settings!({prepend_module_to_snapshot => false, omit_expression => true}, {
        insta::assert_snapshot!("gripper.yaml", yaml);
    });
    let arm = valid(&yaml);
    assert_eq!((arm.joints.len(), arm.dof(), arm.tip.0), (3, 2, 1));
    let json: serde_json::Value = serde_json::from_str(&report.to_json()).expect("JSON");
    assert_eq!(json["joints"][2]["follows"], serde_json::json!({ "joint": "left", "multiplier": "-1.50", "offset": "0.010" }));
    for (options, rows) in [(tip("right_link"), 3), (tip("wrist_link"), 1), (Options { all: true, ..Options::default() }, 3)] {
        let arm = valid(&imported(&gripper(), &options).yaml);
        assert_eq!((arm.joints.len(), arm.dof()), (rows, rows.min(2)));
    }
}

/// A leader is taken in with the joints above it, and its followers with theirs: also those on the base.
#[test]
fn leaders_and_followers_come_with_the_joints_above_them() {
    let source = robot(&[
        joint("far", "revolute", "other_link", "<mimic joint='middle' multiplier='2'/>"),
        joint("other", "revolute", "base", ""),
        joint("chain", "revolute", "base", "<mimic joint='leader' multiplier='-1'/>"),
        joint("on", "fixed", "base", ""),
        joint("above", "revolute", "on_link", ""),
        joint("leader", "revolute", "above_link", ""),
        joint("middle", "revolute", "base", "<mimic joint='chain' offset='-0.5'/>"),
        joint("still", "revolute", "chain_link", ""),
    ]);
    let Imported { yaml, report } = imported(&source, &tip("chain_link"));
    let arm = valid(&yaml);
    let names: Vec<&str> = arm.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["chain", "above", "leader", "middle", "other", "far"]);
    assert_eq!(arm.dof(), 3);
    let line = "joints that follow others: `chain` = -1 `leader`, `middle` = `chain` + (-0.5), `far` = 2 `middle`";
    assert!(report.lines().iter().any(|found| found == line), "{:?}", report.lines());
    let line =
        "joints beside the chain that move with it: `above`, `leader`, `middle`, `other`, `far`; `--lock JOINT=VALUE` holds one";
    assert!(report.lines().iter().any(|found| found == line), "{:?}", report.lines());
}

/// A fixed leader, a locked one, and the multiplier 0 hold a joint, and those that follow it.
#[test]
fn what_cannot_move_stands_where_the_file_puts_it() {
    let line = |leader: &str, factor: &str| {
        robot(&[
            joint("first", "revolute", "base", ""),
            joint("post", "fixed", "base", ""),
            joint("second", "revolute", "first_link", &format!("<mimic joint='{leader}' multiplier='{factor}' offset='0.25'/>")),
            joint("third", "revolute", "second_link", "<mimic joint='second' multiplier='2' offset='0.1'/>"),
            joint("last", "revolute", "third_link", ""),
        ])
    };
    for (leader, factor, lock, second, rows) in [
        ("post", "3", None, "0.25", 2),
        ("first", "0", None, "0.25", 2),
        ("first", "3", Some(("first", "0.5")), "3*0.5 + 0.25", 1),
        ("first", "3", Some(("second", "0.25")), "0.25", 2),
    ] {
        let lock = lock.map(|(joint, value)| (joint.into(), value.into())).into_iter().collect();
        let imported = imported(&line(leader, factor), &Options { lock, ..tip("last_link") });
        assert_eq!(valid(&imported.yaml).dof(), rows, "{leader} {factor}");
        assert!(!imported.yaml.contains("follows:"), "{}", imported.yaml);
        let words = imported.report.lines().join("\n");
        let third = if second.contains('*') { format!("2*({second}) + 0.1") } else { format!("2*{second} + 0.1") };
        assert!(words.contains(&format!("`second` at {second}, `third` at {third}")), "{words}");
    }
}

/// The interval of the coordinate is what all limits have in common.
#[test]
fn a_follower_whose_limits_allow_its_leader_no_motion_loses_them() {
    let limited = |multiplier: &str, limits: &str| {
        let mimic = format!("<mimic joint='left' multiplier='{multiplier}'/>");
        let right = joint("right", "prismatic", "base", &mimic).replace("lower='-1' upper='1'", limits);
        robot(&[joint("left", "prismatic", "base", "").replace("lower='-1'", "lower='0'"), right])
    };
    let all = Options { all: true, ..Options::default() };
    for (multiplier, limits, expected, warnings) in [
        ("1", "lower='0' upper='1'", [0.0, 1.0], 0),
        ("-1", "lower='-1' upper='0'", [0.0, 1.0], 0),
        ("-1", "lower='0' upper='1'", [0.0, 1.0], 1),
        ("2", "lower='-1' upper='1'", [0.0, 0.5], 2),
        ("-0.1", "lower='-0.05' upper='-0.02'", [0.2, 0.5], 1),
    ] {
        let source = limited(multiplier, limits);
        let (imported, diagnostics) = import(&source, &all);
        let arm = valid(&imported.expect("an arm").yaml);
        let limits = arm.coordinates()[0].limits.position.as_ref().expect("limits").each_ref().map(|end| end.to_f64());
        assert_eq!(limits, expected, "{multiplier}");
        // With the factor 2 the velocity is limited, too.
        assert_eq!(
            diagnostics.iter().filter(|warning| warning.code.name() == "follower-limits").count(),
            warnings,
            "{multiplier}"
        );
    }
}

/// Of nine branches, one whose last joint follows another one has no end effector, and still all of its joints.
#[test]
fn where_branches_are_too_many_followers_have_no_end_effector() {
    let hand = |mimic: &str| {
        let mut joints = vec![joint("wrist", "revolute", "base", "")];
        joints.extend((0..8).map(|k| joint(&format!("finger{k}"), "revolute", "wrist_link", "")));
        joints.push(joint("near", "revolute", "wrist_link", ""));
        joints.push(joint("far", "revolute", "near_link", mimic));
        robot(&joints)
    };
    let all = Options { all: true, ..Options::default() };
    let imported = imported(&hand("<mimic joint='near'/>"), &all);
    let arm = valid(&imported.yaml);
    assert_eq!((arm.joints.len(), arm.dof(), arm.tips.len()), (11, 10, 8));
    let line = "without an end effector, since the last joint follows another one: `far_link` (3 joints)";
    assert!(imported.report.lines().iter().any(|found| found == line), "{:?}", imported.report.lines());
}

/// Of nine branches that move by themselves, the shortest one has no end effector, and still all of its joints; more than 32 are no robot.
#[test]
fn where_branches_are_too_many_the_last_have_no_end_effector() {
    let hand = |fingers: usize| {
        let mut joints = vec![joint("wrist", "revolute", "base", ""), joint("thumb", "revolute", "wrist_link", "")];
        for k in 1..fingers {
            joints.push(joint(&format!("near{k}"), "revolute", "wrist_link", ""));
            joints.push(joint(&format!("far{k}"), "revolute", &format!("near{k}_link"), ""));
        }
        robot(&joints)
    };
    let all = Options { all: true, ..Options::default() };
    let imported = imported(&hand(9), &all);
    let arm = valid(&imported.yaml);
    assert_eq!((arm.joints.len(), arm.tips.len()), (18, 8));
    let line = "without an end effector, since a robot has at most 8, which `--tip` chooses: `thumb_link` (2 joints)";
    assert!(imported.report.lines().iter().any(|found| found == line), "{:?}", imported.report.lines());
    let (none, diagnostics) = import(&hand(33), &all);
    assert!(none.is_none() && diagnostics.iter().any(|fault| fault.code.name() == "several-tips"));
}

/// Where all fingers of a hand follow, the hand has the end effector: its tool's frame, or its link.
#[test]
fn hands_whose_fingers_follow_have_the_end_effector() {
    let mut joints = vec![joint("head", "revolute", "base", "")];
    for side in ["left", "right"] {
        let follows = format!("<mimic joint='{side}_near'/>");
        joints.push(joint(&format!("{side}_wrist"), "revolute", "base", ""));
        joints.push(joint(&format!("{side}_near"), "revolute", &format!("{side}_wrist_link"), ""));
        joints.push(joint(&format!("{side}_far"), "revolute", &format!("{side}_near_link"), &follows));
        joints.extend((0..4).map(|k| joint(&format!("{side}_{k}"), "revolute", &format!("{side}_wrist_link"), &follows)));
    }
    joints.push(joint("right_tool", "fixed", "right_wrist_link", ""));
    let imported = imported(&robot(&joints), &Options { all: true, ..Options::default() });
    let arm = valid(&imported.yaml);
    assert_eq!((arm.joints.len(), arm.dof()), (15, 5));
    let tips: Vec<&str> = arm.tips.iter().map(|tip| tip.name.as_str()).collect();
    assert_eq!(tips, ["head_link", "left_wrist_link", "right_tool_link"]);
}

/// A joint that moves nothing with mass is known before the description is read; an arm without any mass has kinematics, and no such joint.
#[test]
fn joints_that_move_no_mass_are_named() {
    let light = |name: &str, parent: &str| {
        let given = joint(name, "revolute", parent, "");
        given.replacen(
            BODY,
            "<inertial><mass value='0'/><inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial>",
            1,
        )
    };
    let heavy = joint("heavy", "revolute", "base", "");
    let idle = |joints: &[String], tip_link: &str| {
        imported(&robot(joints), &Options { massless: true, ..tip(tip_link) }).report.idle().to_vec()
    };
    assert_eq!(idle(&[heavy.clone(), light("eye", "heavy_link")], "eye_link"), ["eye"]);
    assert!(idle(&[light("first", "base"), joint("last", "revolute", "first_link", "")], "last_link").is_empty());
    assert!(idle(&[light("first", "base"), light("last", "first_link")], "last_link").is_empty());
    // Its follower has mass.
    let led = joint("led", "revolute", "heavy_link", "<mimic joint='eye'/>");
    assert!(idle(&[heavy, light("eye", "heavy_link"), led], "eye_link").is_empty());
}

/// A lock that no posture of the file has is named with both values, also where the leader rests beside the chain.
#[test]
fn locks_against_their_couplings_are_named() {
    let warnings = |locks: &[(&str, &str)], link: &str| {
        let lock = locks.iter().map(|(joint, value)| ((*joint).into(), (*value).into())).collect();
        let (imported, diagnostics) = import(&gripper(), &Options { lock, ..tip(link) });
        assert!(imported.is_some());
        let named = diagnostics.iter().filter(|warning| warning.code.name() == "changes-motion");
        named.map(|warning| warning.message.clone()).collect::<Vec<_>>()
    };
    let against = |right: &str, by_file: &str| {
        vec![format!("the joint `right` is locked at {right}, but its leader `left` puts it at {by_file}")]
    };
    // right = -1.5 left + 0.01
    assert_eq!(warnings(&[("right", "0.04")], "right_link"), against("0.04", "0.01"));
    assert_eq!(warnings(&[("right", "0.04"), ("left", "0.02")], "wrist_link"), against("0.04", "-0.02"));
    for locks in [&[("right", "-0.02"), ("left", "0.02")][..], &[("right", "0.01")], &[("left", "0.02")]] {
        assert!(warnings(locks, "wrist_link").is_empty(), "{locks:?}");
    }
    let frozen = "the joint `right` follows `left`, and is locked: 1 kg no longer move as in the file";
    assert_eq!(warnings(&[("right", "0")], "left_link"), [frozen]);
}

/// Names that a language cannot take are replaced with a note, and equal names are refused.
#[test]
fn names_of_end_effectors_are_kept_or_noted() {
    let with = |tips: &[(Option<&str>, &str)]| {
        let tips = tips.iter().map(|(name, link)| (name.map(Into::into), (*link).into())).collect();
        import(&gripper(), &Options { tips, ..Options::default() })
    };
    let (imported, _) = with(&[(Some("9"), "left_link"), (Some("right"), "right_link")]);
    let Imported { yaml, report } = imported.expect("an arm");
    let notes: Vec<&String> = report.lines().iter().filter(|line| line.contains("is called")).collect();
    assert_eq!(notes, ["the end effector `9` is called `tip`, which every language takes"]);
    assert_eq!(valid(&yaml).tips.len(), 2);
    for tips in [[(Some("x"), "left_link"), (Some("x"), "right_link")], [(None, "left_link"), (None, "left_link")]] {
        let (imported, diagnostics) = with(&tips);
        assert!(imported.is_none() && diagnostics.iter().any(|fault| fault.code.name() == "duplicate-name"));
    }
}

/// The options that leave fingers out name leaders alone: a follower in them would be locked against its coupling.
#[test]
fn fingers_that_follow_are_left_out_by_their_leader() {
    let source = robot(&[
        joint("wrist", "continuous", "base", ""),
        joint("tool", "fixed", "wrist_link", ""),
        joint("finger", "prismatic", "wrist_link", ""),
        joint("other_finger", "prismatic", "wrist_link", "<mimic joint='finger' multiplier='-1'/>"),
        joint("camera", "revolute", "wrist_link", ""),
    ]);
    let (none, diagnostics) = import(&source, &Options::default());
    let help = diagnostics.iter().map(|fault| fault.help.as_str()).collect::<String>();
    assert!(none.is_none() && help.contains("or where you say: `--lock finger=0`;"), "{help}");
}
