//! Commands that people type with their files: hints about other commands, standard input, and files that a model includes.

use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

use super::{check, err, folder, out};

const URDF: &str = "<robot name='arm'><link name='base'/><link name='one'><inertial><mass value='1'/>\
    <inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
    <joint name='j' type='revolute'><parent link='base'/><child link='one'/><axis xyz='0 1 0'/>\
    <limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";

/// Each of the two kinds of files names the other's command, and a file alone gets the one to type.
#[test]
fn a_file_for_another_command_is_told_which() {
    let folder = folder("which");
    let (urdf, yaml) = (folder.join("arm.urdf"), folder.join("arm.yaml"));
    fs::write(&urdf, URDF).expect("a file");
    let (urdf, yaml) = (urdf.to_str().expect("UTF-8"), yaml.to_str().expect("UTF-8"));
    check(&["import", urdf, "--out", yaml], 0);
    for command in ["check", "show", "count", "generate"] {
        let output = check(&[command, urdf], 1);
        assert!(err(&output).contains(&format!("`armgen import {urdf} --out robot.yaml`")), "{command}: {}", err(&output));
    }
    let output = check(&["import", yaml], 1);
    assert!(err(&output).contains(&format!("`armgen check {yaml}`")), "{}", err(&output));
    for (file, command) in [
        (yaml, format!("`armgen check {yaml}`")),
        (urdf, format!("`armgen import {urdf} --out robot.yaml`")),
        ("arm.rs", "`armgen verify robot.yaml arm.rs`".to_owned()),
    ] {
        let output = check(&[file], 2);
        assert!(err(&output).contains(&command), "{file}: {}", err(&output));
    }
    // What is neither a command nor a file is told as before.
    assert!(err(&check(&["chek"], 2)).contains("check"));
}

#[test]
fn a_urdf_is_read_from_standard_input() {
    let run = |input: &[u8]| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_armgen"))
            .args(["import", "-"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        child.stdin.take().expect("a pipe").write_all(input).expect("the program reads");
        child.wait_with_output().expect("the program ends")
    };
    let output = run(URDF.as_bytes());
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert!(out(&output).contains("name: arm\n"), "{}", out(&output));
    assert_eq!(run(b"<robot name='\xff'/>").status.code(), Some(2));
    let including = run(b"<mujoco><include file='a.xml'/></mujoco>");
    assert_eq!(including.status.code(), Some(1));
    assert!(err(&including).contains("standard input is in no folder"), "{}", err(&including));
}

/// Included files are read from the folder of the model, and nowhere else.
#[test]
fn a_model_includes_files_of_its_folder_alone() {
    let folder = folder("include");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("a file");
    fs::create_dir_all(folder.join("model/parts")).expect("a folder");
    write("model/arm.xml", "<mujoco><worldbody><include file='parts/body.xml'/></worldbody></mujoco>");
    write("model/parts/body.xml", "<x><body><joint/><geom size='0.1'/></body></x>");
    write("model/out.xml", "<mujoco><worldbody><include file='../body.xml'/></worldbody></mujoco>");
    write("model/link.xml", "<mujoco><worldbody><include file='linked.xml'/></worldbody></mujoco>");
    write("body.xml", "<x/>");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let output = check(&["import", &path("model/arm.xml")], 0);
    assert!(out(&output).contains("mass: 4/3*pi"), "{}", out(&output));
    assert!(err(&check(&["import", &path("model/out.xml")], 1)).contains("outside of the model's folder"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.join("body.xml"), folder.join("model/linked.xml")).expect("a link");
        assert!(err(&check(&["import", &path("model/link.xml")], 1)).contains("outside of the model's folder"));
    }
}

/// An arm of six joints whose angles have three decimals: the tolerance that restores its class is named, and rows where frames give none.
#[test]
fn rounded_angles_are_told_what_restores_closed_forms() {
    let folder = folder("rounded");
    let arm = |poses: [(&str, &str, &str); 6]| {
        let joints: String = (1..=6)
            .zip(poses)
            .map(|(k, (xyz, rpy, axis))| {
                format!(
                    "<link name='l{k}'/><joint name='j{k}' type='continuous'><parent link='l{}'/><child link='l{k}'/>\
                     <origin xyz='{xyz}' rpy='{rpy}'/><axis xyz='{axis}'/></joint>",
                    k - 1
                )
            })
            .collect();
        format!("<robot name='arm'><link name='l0'/>{joints}</robot>")
    };
    let nearly_meeting = arm([
        ("0 0 0.4", "0 0 0", "0 0 1"),
        ("0.025 0 0", "0 0 0", "0 1 0"),
        ("0 0 0.455", "0 0 0", "0 1 0"),
        ("0.21 0 0.035", "3.141 0 0", "1 0 0"),
        ("0.21 0 0", "0 0 3.141", "0 1 0"),
        ("-0.08 0 0", "0 0 3.141", "1 0 0"),
    ]);
    let no_rows = arm([
        ("0 0 0.135", "0 0 0", "0 0 1"),
        ("0 0.0345 0", "0 -1.571 -1.571", "0 0 1"),
        ("0.411 0 0", "0 0 1.571", "0 0 1"),
        ("0 -0.368 0", "1.571 0 0", "0 0 1"),
        ("0 0 0", "-1.571 0 0", "0 0 1"),
        ("0 -0.121 0", "1.571 0 0", "0 0 1"),
    ]);
    for (name, text) in [("meeting.urdf", nearly_meeting), ("rows.urdf", no_rows)] {
        let (urdf, yaml) = (folder.join(name), folder.join(format!("{name}.yaml")));
        fs::write(&urdf, text).expect("a file");
        let output = check(&["import", urdf.to_str().expect("UTF-8"), "--out", yaml.to_str().expect("UTF-8")], 0);
        let said = err(&output);
        assert!(said.contains("`--snap 1e-3` gives inverse kinematics a closed form, spherical triple"), "{name}: {said}");
        assert!(!said.contains("no inverse kinematics"), "{name}: {said}");
        let checked = out(&check(&["check", yaml.to_str().expect("UTF-8")], 0));
        assert!(!checked.contains("none: two of its axes"), "{name}: {checked}");
        // An end effector with a name has what one without has.
        let named = folder.join(format!("named.{name}.yaml"));
        let (urdf, named) = (urdf.to_str().expect("UTF-8"), named.to_str().expect("UTF-8"));
        check(&["import", urdf, "--tip", "hand=l6", "--out", named], 0);
        let (words, told) =
            (|text: &str| text.split_whitespace().collect::<Vec<_>>().join(" "), out(&check(&["check", named], 0)));
        let line = |text: &str| {
            words(text).split("inverse kinematics ").nth(1).expect("a line").split(" named").next().map(str::to_owned)
        };
        assert_eq!(line(&told), line(&checked).map(|found| format!("hand, {found}")), "{name}: {told}");
    }
}
