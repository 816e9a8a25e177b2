//! `armgen generate --language` as its users run it: written files, verified files, and refusals with a remedy.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// A description of the repository.
fn scara() -> String {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the repository exists");
    root.join("robots/scara.yaml").to_str().expect("a UTF-8 path").to_string()
}

/// A new folder for one test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

/// Runs the program; returns its standard error.
#[track_caller]
pub(crate) fn check(folder: &PathBuf, arguments: &[&str], code: i32) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_armgen")).current_dir(folder).args(arguments).output().expect("it runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "armgen {arguments:?}\n{said}");
    said
}

#[test]
#[ignore = "wide"]
fn every_language_is_written_and_verified() {
    let folder = folder("languages");
    for (language, out, beside) in [
        ("c", "scara.h", vec![]),
        ("cuda", "scara.cuh", vec![]),
        ("javascript", "scara.mjs", vec!["scara.d.mts"]),
        ("python", "scara.py", vec![]),
        ("matlab", "+scara", vec!["+scara/Contents.m", "+scara/model.m", "+scara/inverseDynamicsWith.m"]),
    ] {
        check(&folder, &["generate", &scara(), "--language", language, "--out", out, "--verify"], 0);
        check(&folder, &["verify", &scara(), out], 0);
        assert!(beside.iter().all(|file| folder.join(file).is_file()), "{language}");
        let certificate = folder.join(format!("{out}.cert.json"));
        assert!(certificate.is_file(), "{}", certificate.display());
        fs::remove_file(certificate).expect("a certificate");
    }
}

#[test]
#[ignore = "wide"]
fn a_library_stands_beside_python_and_batches_in_c() {
    let folder = folder("native_and_batch");
    check(&folder, &["generate", &scara(), "--language", "python", "--out", "arm.py", "--native", "--functions", "gravity"], 0);
    assert!(["arm.py", "arm_native.py", "arm_native.c"].iter().all(|file| folder.join(file).is_file()));
    check(&folder, &["generate", &scara(), "--language", "c", "--out", "scara.h", "--batch", "8"], 0);
    let text = fs::read_to_string(folder.join("scara.h")).expect("the header");
    assert!(
        text.contains("static inline void scara_batch_gravity(\n    size_t states,") && text.contains("#define SCARA_LANES 8")
    );
}

#[test]
fn what_is_spoilt_in_a_package_is_found_in_its_file() {
    let folder = folder("spoilt_package");
    check(&folder, &["generate", &scara(), "--language", "matlab", "--out", "+scara"], 0);
    let gravity = folder.join("+scara/gravity.m");
    let text = fs::read_to_string(&gravity).expect("the file");
    let spoilt = text.replacen("result(:, 3) = -98.1", "result(:, 3) = -98.2", 1);
    assert_ne!(text, spoilt);
    fs::write(&gravity, spoilt).expect("the file");
    let said = check(&folder, &["verify", &scara(), "+scara"], 1);
    assert!(said.contains("+scara/gravity.m:1: gravity"), "{said}");
    fs::write(&gravity, text.replacen("    n = size(q, 2);\n", "    n = size(q, 2);\n    q = 2 * q;\n", 1)).expect("the file");
    let said = check(&folder, &["verify", &scara(), "+scara"], 1);
    assert!(said.contains("+scara/gravity.m:") && said.contains("`q = 2 * q;` where an emitted module has"), "{said}");
    fs::write(&gravity, text.replacen("%#codegen\n", "%{\n%#codegen\n%}\n", 1)).expect("the file");
    let said = check(&folder, &["verify", &scara(), "+scara"], 1);
    assert!(said.contains("a comment that begins or ends one of many lines"), "{said}");
    fs::write(&gravity, &text).expect("the file");
    check(&folder, &["verify", &scara(), "+scara"], 0);
    // It would be called instead of the function.
    fs::write(folder.join("+scara/gravity.p"), "").expect("a file");
    let said = check(&folder, &["verify", &scara(), "+scara"], 1);
    assert!(said.contains("could hide a function"), "{said}");
    let said = check(&folder, &["generate", &scara(), "--language", "matlab", "--out", "+scara"], 0);
    assert!(said.contains("gravity.p is not of this module"), "{said}");
}

#[test]
fn what_a_language_lacks_is_refused_with_a_way_out() {
    let folder = folder("refused_languages");
    for (arguments, words) in [
        (vec!["--language", "matlab"], "with `--out +robot`"),
        (vec!["--language", "matlab", "--out", "robot.m"], "`robot.m` is no package of MATLAB"),
        (vec!["--language", "matlab", "--out", "+1robot"], "`+1robot` is no package of MATLAB"),
        (vec!["--language", "matlab", "--scalar", "f32", "--out", "+robot"], "leave `--scalar f32` out"),
        (vec!["--language", "c", "--out", "robot.m"], "robot.m is a file of MATLAB, and the module is in C"),
        (vec!["--language", "python", "--out", "robot.mjs"], "write `--language javascript` or `--out robot.py`"),
        (vec!["--language", "c", "--trig", "libm"], "take `--trig fast` or `--trig std`"),
        (
            vec!["--language", "javascript", "--fma"],
            "--fma does not go with `--language javascript`: a fused operation is written in Rust and C",
        ),
        (vec!["--language", "cuda", "--tests", "--out", "robot.cuh"], "`--language c` writes the same functions with one"),
        (vec!["--language", "cuda", "--batch", "8"], "CUDA has kernels"),
        (vec!["--language", "cuda", "--out", "robot.h"], "write `--language c` or `--out robot.cuh`"),
        (vec!["--language", "python", "--fma"], "--fma does not go with `--language python`"),
        (vec!["--language", "matlab", "--fma", "--out", "+robot"], "--fma does not go with `--language matlab`"),
        (vec!["--language", "javascript", "--batch", "8"], "--batch does not go with `--language javascript`"),
        (vec!["--language", "c", "--native", "--out", "robot.h"], "--native goes with `--language python`"),
        (vec!["--language", "python", "--native"], "say where that goes, with `--out robot.py`"),
        (
            vec!["--language", "javascript", "--ik"],
            "--ik does not go with `--language javascript`: inverse kinematics is written in Rust and in C",
        ),
        (
            vec!["--language", "matlab", "--out", "+end"],
            "`end` is a word of MATLAB or Octave, and no package can be called by it: write `--out +end_`",
        ),
        (vec!["--language", "matlab", "--out", "+_robot"], "a letter first"),
        (vec!["--language", "matlab", "--out", "+endfunction"], "write `--out +endfunction_`"),
        (
            vec!["--language", "python", "--out", "class.py"],
            "`class` is a word of Python, and no module can be imported by it: write `--out class_.py`",
        ),
        (
            vec!["--language", "python", "--out", "numpy.py"],
            "would be imported in place of the library `numpy`: write `--out robot.py`",
        ),
        (
            vec!["--language", "python", "--out", "robot.pyi"],
            "could not be imported, since `import` looks for .py: write `--out robot.py`",
        ),
        (
            vec!["--language", "javascript", "--out", "robot.cjs"],
            "Node takes a module with `export` from .mjs, or .js: write `--out robot.mjs`",
        ),
        (
            vec!["--language", "c", "--out", "math.h"],
            "would be found in place of <math.h> of the C library: write `--out robot.h`",
        ),
        (vec!["--language", "python", "--ik"], "--ik does not go with `--language python`"),
        (vec!["--language", "matlab", "--ik"], "--ik does not go with `--language matlab`"),
    ] {
        let description = scara();
        let mut all = vec!["generate", description.as_str()];
        all.extend(&arguments);
        let said = check(&folder, &all, 2);
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
    assert_eq!(fs::read_dir(&folder).expect("the folder").count(), 0, "nothing is written where something fails");
}

/// A module of some functions is verified; its head names the options, which the command that makes it again repeats.
#[test]
fn a_module_of_some_functions_is_verified() {
    let folder = folder("some");
    let chosen = ["--scalar", "f32", "--functions", "gravity,inertia_matrix_with"];
    for (language, out) in [("rust", "a.rs"), ("c", "a.h"), ("python", "a.py")] {
        let description = scara();
        let all = [&["generate", &description, "--language", language, "--out", out, "--verify"][..], &chosen].concat();
        check(&folder, &all, 0);
        let text = fs::read_to_string(folder.join(out)).expect("the module");
        assert!(text.contains("Options: --scalar f32 --functions gravity,inertia_matrix_with\n"), "{out}");
        check(&folder, &["verify", &scara(), out], 0);
        let edited = text.replacen("gravity,", "gravity,momentum,", 1).replacen("0.25", "0.125", 1);
        fs::write(folder.join(out), edited).expect("written");
        let said = check(&folder, &["verify", &scara(), out], 1);
        let option = if language == "rust" { String::new() } else { format!(" --language {language}") };
        let again = format!("{option} --scalar f32 --functions gravity,momentum,inertia_matrix_with --out {out} --verify");
        assert!(said.contains(&again), "{said}");
    }
}

/// Words of another language are names like others.
#[test]
fn a_word_of_one_language_is_a_name_in_another() {
    let folder = folder("words");
    for (language, out) in [("matlab", "+fn"), ("python", "fn.py"), ("javascript", "class.mjs"), ("c", "end.hpp")] {
        check(&folder, &["generate", &scara(), "--language", language, "--out", out, "--functions", "gravity"], 0);
        assert!(folder.join(out).exists(), "{out}");
    }
}

/// Runs the commands and the programs of a page about `NAME.urdf`, in C and in Python: both print so many lines, the same ones.
#[track_caller]
fn run_tutorial(name: &str, page: &str, urdf: &str, lines: usize) -> PathBuf {
    let folder = folder(name);
    fs::write(folder.join(format!("{name}.urdf")), urdf).expect("the file");
    let blocks = |kind: &str| -> Vec<&str> {
        page.split(&format!("```{kind}\n")).skip(1).map(|rest| rest.split("```").next().expect("its end")).collect()
    };
    let commands: Vec<&str> = blocks("sh").into_iter().flat_map(str::lines).collect();
    let own: Vec<Vec<&str>> =
        commands.iter().filter_map(|line| Some(line.strip_prefix("armgen ")?.split(' ').collect())).collect();
    assert_eq!(own.len(), 4, "{commands:?}");
    own.iter().for_each(|arguments| _ = check(&folder, arguments, 0));
    let description = fs::read_to_string(folder.join(format!("{name}.yaml"))).expect("the description");
    assert!(description.contains(blocks("yaml")[0]), "{description}");
    let said = |command: &mut Command| {
        let output = command.current_dir(&folder).output().ok()?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(String::from_utf8_lossy(&output.stdout).into_owned())
    };
    fs::write(folder.join("caller.c"), blocks("c")[0]).expect("the file");
    fs::write(folder.join("caller.py"), blocks("python")[0]).expect("the file");
    let compiled = said(Command::new("cc").args(["-O2", "-Wall", "-Wextra", "-Werror", "caller.c", "-lm", "-o", "caller"]));
    let Some(in_c) = compiled.and_then(|_| said(&mut Command::new(folder.join("caller")))) else {
        println!("no compiler of C: apt install gcc");
        return folder;
    };
    assert_eq!(in_c.lines().count(), lines, "{in_c}");
    let has_numpy = Command::new("python3").args(["-c", "import numpy"]).output().is_ok_and(|output| output.status.success());
    match has_numpy {
        true => assert_eq!(said(Command::new("python3").arg("caller.py")), Some(in_c)),
        false => println!("no NumPy: apt install python3-numpy"),
    }
    folder
}

#[test]
#[ignore = "wide"]
fn a_gripper_goes_from_a_urdf_to_torques() {
    let (page, urdf) = (include_str!("../../docs/gripper.md"), include_str!("../../tests/data/trees/gripper.urdf"));
    let folder = run_tutorial("gripper", page, urdf, 4);
    check(&folder, &["page", "gripper.yaml", "--out", "gripper.html"], 0);
    // The coupling comes back: under other names of tips the description is the same.
    check(&folder, &["export", "gripper.yaml", "--format", "urdf", "--out", "back.urdf"], 0);
    check(&folder, &["import", "back.urdf", "--tip", "tcp", "--tip", "left", "--out", "back.yaml"], 0);
    let back = fs::read_to_string(folder.join("back.yaml")).expect("the description");
    assert!(back.contains("    follows: {left_finger: 1}\n"), "{back}");
}

/// The description with the lines of the page for inverse kinematics has it of both hands: verified, named, and as the program of the page prints it.
fn postures_of_hands(folder: &PathBuf, page: &str) {
    let description = fs::read_to_string(folder.join("two_arms.yaml")).expect("the description");
    let lines = page.rsplit_once("```yaml\n").and_then(|(_, rest)| rest.split("```").next()).expect("the lines");
    let of_hand = |text: String, joint: &str| text.replace(joint, &format!("{joint}{lines}"));
    let text = ["    joint: left_3\n", "    joint: right_3\n"].into_iter().fold(description, of_hand);
    fs::write(folder.join("hands.yaml"), text).expect("the file");
    let said = check(folder, &["generate", "hands.yaml", "--language", "c", "--out", "two_arms.h", "--ik", "--verify"], 0);
    assert_eq!(said.matches("rational poses proved").count(), 2, "{said}");
    for hand in ["left_hand", "right_hand"] {
        check(folder, &["verify", "hands.yaml", &format!("two_arms_{hand}_ik.h")], 0);
        check(folder, &["show", "hands.yaml", &format!("{hand}_inverse_kinematics")], 0);
    }
    let program = page.rsplit_once("```c\n").and_then(|(_, rest)| rest.split("```").next()).expect("the program");
    fs::write(folder.join("postures.c"), program).expect("the file");
    let mut compiler = Command::new("cc");
    compiler.args(["-O2", "-Wall", "-Wextra", "-Werror", "postures.c", "-lm", "-o", "postures"]).current_dir(folder);
    let Ok(compiled) = compiler.output() else { return };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let ran = Command::new(folder.join("postures")).output().expect("it runs");
    let printed = String::from_utf8_lossy(&ran.stdout);
    let places: Vec<&str> = printed.lines().filter_map(|line| line.split("hand at").nth(1)).collect();
    assert!(ran.status.success() && places.len() > 1 && places.iter().all(|place| *place == places[0]), "{printed}");
}

#[test]
#[ignore = "wide"]
fn two_arms_go_from_a_urdf_to_torques() {
    let (page, urdf) = (include_str!("../../docs/two-arms.md"), include_str!("../../tests/data/trees/two_arms.urdf"));
    let folder = run_tutorial("two_arms", page, urdf, 5);
    postures_of_hands(&folder, page);
    check(&folder, &["export", "two_arms.yaml", "--format", "urdf", "--out", "back.urdf"], 0);
    check(&folder, &["import", "back.urdf", "--tip", "left=left_hand", "--tip", "right=right_hand", "--out", "back.yaml"], 0);
    check(&folder, &["show", "back.yaml", "left_direct_kinematics", "right_operational_inertia"], 0);
    check(&folder, &["count", "back.yaml"], 0);
    check(&folder, &["check", "back.yaml"], 0);
    check(&folder, &["page", "back.yaml", "--out", "back.html"], 0);
    let said = check(&folder, &["generate", "back.yaml", "--out", "one.rs", "--functions", "direct_kinematics"], 1);
    assert!(said.contains("left_direct_kinematics, right_direct_kinematics"), "{said}");
}
