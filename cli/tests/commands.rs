//! The program as its users run it: exit codes, what goes to which stream, the forms of output.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A file of the repository.
fn file(path: &str) -> String {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the repository exists");
    root.join(path).to_str().expect("a UTF-8 path").to_string()
}

/// An empty folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

fn armgen(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armgen"))
        .args(arguments)
        .env_remove("COLUMNS")
        .stdin(Stdio::null())
        .output()
        .expect("the program runs")
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("the output is UTF-8")
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("the messages are UTF-8")
}

#[track_caller]
fn check(arguments: &[&str], code: i32) -> Output {
    let output = armgen(arguments);
    assert_eq!(output.status.code(), Some(code), "armgen {arguments:?}\n{}", err(&output));
    output
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_slice(&check(arguments, 0).stdout).expect("the output is JSON")
}

#[test]
fn a_valid_file_gives_a_summary_and_code_0() {
    let output = check(&["check", &file("robots/scara.yaml")], 0);
    let text = out(&output);
    assert!(text.contains("valid, with 1 warning"), "{text}");
    assert!(text.contains("a motion can identify 11 of 14"), "{text}");
    assert!(text.contains("m_l1 + 16*I_l1 + 16*I_m1\n"), "{text}");
    assert!(text.contains("I_l2 + I_m2\n"), "{text}");
    assert!(err(&output).contains("warning[triangle-inequality]"), "warnings go to standard error");
    assert!(!text.contains("warning["));
}

#[test]
fn a_summary_shows_links_and_what_identification_would_miss() {
    let text = out(&check(&["check", &file("tests/data/iiwa14.yaml")], 0));
    assert!(text.contains("m/s²: z0 points up\n"), "{text}");
    assert!(text.contains("  2 j2       6.35     0.0003   0.059   0.042             0.0590008                    0\n"), "{text}");
    assert!(
        text.contains(
            "  2 j2                  0.0305  0.0304  0.011                   0.0693             0.1    0.1    0.22              2800\n"
        ),
        "{text}"
    );
    assert!(text.contains("  2 j2   revolute  [0, 0, 0.2025] rpy [pi/2, 0, pi]   [0, 0, 1]\n"), "{text}");
    assert!(text.contains("\n  tool: [0, 0, 0.045]\n") && !text.contains("q = 0 is outside"), "{text}");
    // From the sum of the lengths along the vertical arm: 0.36 + 0.42 + 0.4 + 0.126.
    assert!(text.lines().any(|line| line.starts_with("  end effector") && line.contains("(0, 0, 1.306)")), "{text}");
    assert!(text.contains("a motion can identify 50 combinations of them"), "{text}");
    assert!(text.contains("`base_regressor` has 36 columns of these 50:\n  the other 14 are 0"), "{text}");
}

#[test]
fn a_base_parameter_is_listed_with_its_combination() {
    let text = out(&check(&["check", &file("tests/robots/base_set.yaml")], 0));
    assert!(text.contains("26 in all"), "{text}");
    assert!(text.contains("-1/2*mcy2 + Ixy2"), "{text}");
}

#[test]
fn a_faulty_file_gives_every_place_and_code_1() {
    let path = file("tests/bad/many-faults.yaml");
    for command in ["check", "show", "generate", "count"] {
        let output = check(&[command, &path], 1);
        assert_eq!(out(&output), "", "nothing but messages");
        assert!(err(&output).contains(&format!("--> {path}:")), "{}", err(&output));
        assert!(err(&output).lines().last().expect("messages").contains("errors"), "{}", err(&output));
    }
    check(&["check", &file("tests/bad/empty-file.yaml")], 1);
    check(&["check", &file("tests/bad/yaml-syntax-bracket.yaml")], 1);
}

#[test]
fn an_unreadable_file_gives_code_2() {
    let folder = folder("unreadable");
    let latin = folder.join("latin1.yaml");
    fs::write(&latin, b"name: a\n# caf\xe9\n").expect("a file");
    let output = check(&["check", latin.to_str().expect("UTF-8")], 2);
    assert!(err(&output).contains("not UTF-8: line 2"), "{}", err(&output));
    let output = check(&["check", folder.join("none.yaml").to_str().expect("UTF-8")], 2);
    assert!(err(&output).contains("cannot read"), "{}", err(&output));
    check(&["check", folder.to_str().expect("UTF-8")], 2);
    // The worst of several decides.
    check(&["check", &file("robots/scara.yaml"), &file("tests/bad/empty-file.yaml")], 1);
}

#[test]
fn show_as_json_keeps_its_schema() {
    let shown = json(&["show", &file("robots/scara.yaml"), "--format", "json"]);
    assert_eq!(shown["robot"], "scara");
    let quantities = shown["quantities"].as_array().expect("a list");
    let names: Vec<&str> = quantities.iter().map(|q| q["name"].as_str().expect("a name")).collect();
    for name in ["direct_kinematics", "link_frame_1", "link_frame_4", "forward_dynamics", "regressor", "potential_energy"] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    assert!(!names.contains(&"equations_of_motion") && !names.contains(&"link_frames"));
    for quantity in quantities {
        let (rows, columns) = (quantity["rows"].as_u64().expect("rows"), quantity["columns"].as_u64().expect("columns"));
        let entries = quantity["entries"].as_array().expect("rows of entries");
        assert_eq!(entries.len() as u64, rows);
        for row in entries {
            let row = row.as_array().expect("a row");
            assert_eq!(row.len() as u64, columns);
            assert!(row.iter().all(Value::is_string));
        }
        assert!(quantity["symbol"].is_string());
        match quantity["form"].as_str() {
            Some("closed") => assert!(quantity.get("steps").is_none()),
            Some("program") => {
                let steps = quantity["steps"].as_array().expect("steps");
                assert!(steps.iter().all(|s| s.as_array().is_some_and(|s| s.len() == 2 && s.iter().all(Value::is_string))));
            }
            other => panic!("form {other:?}"),
        }
    }
    let of = |name: &str| quantities.iter().find(|q| q["name"] == name).expect("shown");
    assert_eq!(of("inertia_matrix")["entries"][0][0], "10*cos(q2) + 10763/500");
    assert_eq!((&of("gravity")["rows"], &of("gravity")["columns"]), (&4.into(), &1.into()));
    assert_eq!((&of("kinetic_energy")["rows"], &of("kinetic_energy")["columns"]), (&1.into(), &1.into()));
    assert_eq!(of("forward_dynamics")["form"], "program");
    assert!(of("forward_dynamics")["steps"].as_array().is_some_and(|steps| steps.len() > 5));
}

/// Two slides: without a turned tensor, a density, an axis beside the centres of mass.
const CART: &str = "name: cart
convention: standard
gravity: [0, 0, -9.81]
joints:
  - {name: x, type: prismatic, a: 0, alpha: pi/2, d: 0.5, theta: 0, link: {mass: 10}}
  - {name: y, type: prismatic, a: 0, alpha: 0, d: 0, theta: 0, link: {mass: 2}}
regressor: base
";

#[test]
fn the_summary_explains_the_columns_that_it_has() {
    let robot = folder("columns").join("robot.yaml");
    let path = robot.to_str().expect("UTF-8");
    fs::write(&robot, CART).expect("a file");
    let text = out(&check(&["check", path], 0));
    assert!(text.contains("com: in the link's own frame\n") && text.contains("radius of gyration: sqrt(I/m)"), "{text}");
    for absent in ["payload", "its axis:", "next axis", "turned", "8000 kg/m³", "take `regressor: base`"] {
        assert!(!text.contains(absent), "{absent} in {text}");
    }
    let text = out(&check(&["check", &file("robots/panda7.yaml")], 0));
    for present in ["its axis:", "next axis:", "turned:", "8000 kg/m³", "take `regressor: base`"] {
        assert!(text.contains(present), "{present} in {text}");
    }
    assert!(!text.contains("lighter than foam"), "{text}");
    // A value in lines of its own stands in one line of its table.
    let row = "  - {name: x, type: prismatic, a: 0, alpha: pi/2, d: 0.5, theta: 0, link: {mass: 10}}\n";
    let block = "  - name: x\n    type: prismatic\n    a: 0\n    alpha: pi/2\n    d: >\n      0.5\n      + 0.25\n    theta: 0\n    link: {mass: 10}\n";
    assert!(CART.contains(row));
    let block = CART.replace(row, block);
    fs::write(&robot, block).expect("a file");
    let text = out(&check(&["check", path], 0));
    assert!(text.contains("1 x    prismatic      0         pi/2  q1 + 0.5 + 0.25            0\n"), "{text}");
}

/// The page calls the same three links of the UR5 doubtful.
#[test]
fn links_lighter_than_foam_are_named() {
    let output = check(&["check", "--strict", &file("robots/ur5.yaml")], 0);
    assert!(out(&output).contains("\n  lighter than foam: 4 joint4, 5 joint5, 6 joint6\n"), "{}", out(&output));
}

#[test]
fn a_warning_beside_an_error_of_the_equations_is_said_once() {
    let robot = folder("once").join("robot.yaml");
    let text = fs::read_to_string(file("robots/panda7.yaml")).expect("a description");
    assert!(text.contains("d: 0.333"), "{text}");
    fs::write(&robot, text.replacen("d: 0.333", "d: 1e308", 1)).expect("a file");
    let said = err(&check(&["check", robot.to_str().expect("UTF-8")], 1));
    assert_eq!(said.matches("warning[implausible-reach]").count(), 1, "{said}");
    assert_eq!(said.matches("error[out-of-range]").count(), 1, "{said}");
    assert!(said.contains(": 1 error and 1 warning"), "{said}");
}

#[test]
fn show_takes_names_of_quantities() {
    let scara = file("robots/scara.yaml");
    let names = |arguments: &[&str]| -> Vec<String> {
        let all = [&["show", &scara, "--format", "json"], arguments].concat();
        let shown = json(&all);
        shown["quantities"].as_array().expect("a list").iter().map(|q| q["name"].as_str().expect("a name").into()).collect()
    };
    assert_eq!(names(&["gravity", "link_frame_2", "gravity"]), ["gravity", "link_frame_2"]);
    assert_eq!(names(&["link_frames"]), ["link_frame_1", "link_frame_2", "link_frame_3", "link_frame_4"]);
    assert_eq!(names(&["equations_of_motion"]), ["inertia_matrix", "coriolis_matrix", "gravity"]);
    assert_eq!(names(&["inertia_matrix_with"]), ["inertia_matrix_with"]);
    for unknown in ["gravitas", "link_frame_0", "link_frame_5", "regressor_with"] {
        let output = check(&["show", &scara, unknown], 2);
        assert!(err(&output).contains(&format!("`{unknown}`")), "{}", err(&output));
        assert!(err(&output).contains("inertia_matrix"), "the names are listed");
    }
}

#[test]
fn the_determinant_comes_with_its_factors() {
    let shown = json(&["show", &file("robots/scara.yaml"), "determinant", "--format", "json"]);
    let determinant = &shown["quantities"][0];
    assert_eq!(determinant["entries"], serde_json::json!([["1/4*sin(q2)"]]));
    assert_eq!(determinant["factors"], serde_json::json!(["1/4*sin(q2)"]));
    assert_eq!(determinant["singular"], serde_json::json!(["q2 = 0 mod pi"]));
    let shown = json(&["show", &file("robots/ur5.yaml"), "determinant", "--format", "json"]);
    let singular = shown["quantities"][0]["singular"].as_array().expect("a list");
    assert_eq!(singular.iter().filter(|s| s.is_null()).count(), 1, "one factor depends on several joints");
    // Seven joints, six rows.
    let output = check(&["show", &file("robots/panda7.yaml"), "determinant", "--format", "json"], 0);
    assert!(err(&output).contains("note: determinant: the task has 6 rows and the arm 7 joints"), "{}", err(&output));
    // Four joints, six rows.
    let output = check(&["show", &file("robots/scara4.yaml"), "determinant", "--format", "json"], 0);
    assert!(err(&output).contains("note: determinant: the task has 6 rows and the arm 4 joints"), "{}", err(&output));
    assert_eq!(serde_json::from_slice::<Value>(&output.stdout).expect("JSON")["quantities"], serde_json::json!([]));
}

#[test]
fn symbolic_forms_use_the_names() {
    let text = out(&check(&["show", &file("robots/scara.yaml"), "inertia_matrix", "--symbolic"], 0));
    assert!(text.contains("m_l3") && text.contains("I_m4"), "{text}");
    let text = out(&check(&["show", &file("robots/scara.yaml"), "inertia_matrix"], 0));
    assert!(!text.contains("m_l3"), "{text}");
}

#[test]
fn count_as_json_keeps_its_schema() {
    let counted = json(&["count", &file("robots/scara.yaml"), "--format", "json"]);
    assert_eq!(counted["robot"], "scara");
    let functions = counted["functions"].as_object().expect("an object");
    for cost in functions.values() {
        let keys: Vec<&String> = cost.as_object().expect("an object").keys().collect();
        assert_eq!(keys, ["add", "div", "exp", "mul", "neg", "sincos"]);
        assert!(cost.as_object().expect("an object").values().all(Value::is_u64));
    }
    let work = |name: &str| functions[name]["mul"].as_u64().expect("a count") + functions[name]["add"].as_u64().expect("a count");
    assert!(work("inertia_matrix") <= 4 && work("coriolis_matrix") <= 5 && work("gravity") == 0);
    assert_eq!(functions["equations_of_motion"]["sincos"], 1);
    assert_eq!(functions["friction"]["exp"], 0);
    let fused = json(&["count", &file("robots/scara.yaml"), "--fma", "--format", "json"]);
    for (name, cost) in fused["functions"].as_object().expect("an object") {
        let fused = cost["fused"].as_u64().expect("a count");
        assert!(fused <= functions[name]["mul"].as_u64().expect("a count") && cost["mul"] == functions[name]["mul"], "{name}");
    }
    assert!(fused["functions"]["inverse_dynamics"]["fused"].as_u64() > Some(0));
    let fading = json(&["count", &file("tests/robots/dry_friction.yaml"), "--functions", "friction", "--format", "json"]);
    assert_eq!(fading["functions"]["friction"]["exp"], 3);
}

#[test]
fn generate_writes_the_same_bytes_everywhere() {
    let printed = check(&["generate", &file("robots/scara.yaml")], 0).stdout;
    let folder = folder("generate");
    let path = folder.join("robot.rs");
    let path = path.to_str().expect("UTF-8");
    let output = check(&["generate", &file("robots/scara.yaml"), "--out", path], 0);
    assert!(output.stdout.is_empty());
    assert_eq!(fs::read(path).expect("the file is written"), printed);
    assert!(String::from_utf8(printed).expect("UTF-8").contains("pub type Real = f64;"));
    let single = out(&check(&["generate", &file("robots/scara.yaml"), "--scalar", "f32"], 0));
    assert!(single.contains("pub type Real = f32;"));
    let fast = out(&check(&["generate", &file("robots/panda7.yaml"), "--trig", "fast"], 0));
    assert!(fast.contains("sin_cos_eight(") && fast.contains("fn sin_cos_beyond("), "{fast}");
    let standard = out(&check(&["generate", &file("robots/scara.yaml"), "--trig", "std"], 0));
    assert!(standard.contains("x.sin_cos()") && !standard.contains("libm::"), "{standard}");
    check(&["generate", &file("robots/scara.yaml"), "--out", folder.to_str().expect("UTF-8")], 2);
}

/// A description in a folder, under a name, and its text.
fn copied(folder: &Path, name: &str) -> (PathBuf, Vec<u8>) {
    let description = folder.join(name);
    fs::copy(file("robots/scara4.yaml"), &description).expect("a copy");
    let text = fs::read(&description).expect("the copy");
    (description, text)
}

#[test]
fn generate_does_not_overwrite_its_description() {
    let folder = folder("overwrite");
    let (description, before) = copied(&folder, "robot.yaml");
    let other_name = folder.join("..").join("overwrite").join("robot.yaml");
    for out in [&description, &other_name] {
        let arguments = ["generate", description.to_str().expect("UTF-8"), "--out", out.to_str().expect("UTF-8")];
        let output = check(&arguments, 2);
        assert!(err(&output).contains("is the description"), "{}", err(&output));
        assert_eq!(fs::read(&description).expect("still there"), before);
    }
    let names: Vec<_> = fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").file_name()).collect();
    assert_eq!(names, ["robot.yaml"], "nothing half written is left");
}

#[test]
fn a_page_does_not_overwrite_its_logs() {
    let folder = folder("page_logs");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    fs::create_dir_all(path("r1")).expect("a folder");
    fs::create_dir_all(path("r2")).expect("a folder");
    let text = "t,w\n0,1\n1,2\n";
    for log in ["r1/a.csv", "r2/a.csv"] {
        fs::write(path(log), text).expect("a file");
    }
    let robot = file("tests/robots/single_joint.yaml");
    let page = |out: &str, logs: [&str; 2], code| {
        check(&["page", &robot, "--out", &path(out), "--log", &path(logs[0]), "--log", &path(logs[1])], code)
    };
    let output = page("r2/../r1/a.csv", ["r1/a.csv", "r2/a.csv"], 2);
    assert!(err(&output).contains("is a log of the page: it would be overwritten"), "{}", err(&output));
    assert_eq!(fs::read_to_string(path("r1/a.csv")).expect("still there"), text);
    // Logs of one name are called by their folders as well.
    page("page.html", ["r1/a.csv", "r2/a.csv"], 0);
    let html = fs::read_to_string(path("page.html")).expect("the page");
    assert!(html.contains("data-log=\"r1/a\"") && html.contains("data-log=\"r2/a\""));
    let output = page("page.html", ["r1/a.csv", "r1/../r1/a.csv"], 1);
    assert!(err(&output).contains("the log is named twice"), "{}", err(&output));
    fs::write(path("r1/a.csv"), "t,w\n").expect("a file");
    let output = page("page.html", ["r1/a.csv", "r2/a.csv"], 1);
    assert!(err(&output).contains("a.csv: the log has no samples"), "{}", err(&output));
}

#[test]
fn no_file_beside_the_module_is_written_over_another() {
    let folder = folder("beside");
    let (description, before) = copied(&folder, "arm.h");
    for (out, complaint) in [("module.h", "is a file of C"), ("arm.rs", "two of the files to write would both be")] {
        let out = folder.join(out);
        let paths = [&description, &out].map(|path| path.to_str().expect("UTF-8"));
        let output = check(&["generate", paths[0], "--out", paths[1], "--c-abi"], 2);
        assert!(err(&output).contains(complaint), "{}", err(&output));
        assert!(!out.exists());
        assert_eq!(fs::read(&description).expect("still there"), before);
    }
}

#[test]
fn a_companion_finds_its_module_whatever_the_file_is_called() {
    let folder = folder("companion");
    for (stem, module) in
        [("arm", "arm"), ("my-robot", "my_robot"), ("2r", "_2r"), ("fn", "_fn"), ("gen", "_gen"), ("arm\u{b2}.v1", "arm__v1")]
    {
        let out = folder.join(format!("{stem}.rs"));
        let description = file("tests/robots/single_joint.yaml");
        check(&["generate", &description, "--out", out.to_str().expect("UTF-8"), "--bounds"], 0);
        let companion = fs::read_to_string(folder.join(format!("{stem}_bounds.rs"))).expect("the companion");
        assert!(companion.contains(&format!("\nuse super::{module}::*;\n")), "{stem}");
    }
}

/// The text is put together in a file that was not there before.
#[test]
fn a_file_with_the_name_of_one_that_is_written_stays() {
    let folder = folder("new");
    let (description, before) = copied(&folder, "foo.new");
    let (other, out) = (folder.join("foo.new1"), folder.join("foo"));
    fs::write(&other, "other").expect("a file");
    let paths = [&description, &out].map(|path| path.to_str().expect("UTF-8"));
    check(&["export", paths[0], "--format", "urdf", "--out", paths[1]], 0);
    assert!(fs::read_to_string(&out).expect("it is written").contains("<robot "));
    assert_eq!(fs::read(&description).expect("still there"), before);
    assert_eq!(fs::read(&other).expect("still there"), b"other");
    let names = || {
        let mut names: Vec<_> = fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").file_name()).collect();
        names.sort();
        names
    };
    assert_eq!(names(), ["foo", "foo.new", "foo.new1"], "nothing half written is left");
}

#[test]
fn one_file_is_not_written_twice_whatever_it_is_called() {
    let folder = folder("twice");
    let urdf = file("import/tests/urdf/everything.urdf");
    let paths = ["a.yaml", "./a.yaml", "../twice/a.yaml", "made/a.yaml", "made/./a.yaml"].map(|path| folder.join(path));
    let paths = paths.each_ref().map(|path| path.to_str().expect("UTF-8"));
    for (out, report) in [(0, 1), (0, 2), (2, 1), (3, 4)] {
        let chain = ["import", &urdf, "--base", "base", "--tip", "tip", "--lock", "finger=0.04"];
        let output = check(&[&chain[..], &["--out", paths[out], "--report", paths[report]]].concat(), 2);
        assert!(err(&output).contains("--out and --report name one file"), "{}", err(&output));
        assert!(!Path::new(paths[out]).exists());
    }
}

/// Of a link to the module the companion would go into the module.
#[cfg(unix)]
#[test]
fn a_companion_is_not_written_through_a_link_to_its_module() {
    let folder = folder("linked");
    let (module, companion) = (folder.join("arm.rs"), folder.join("arm_bounds.rs"));
    fs::write(&module, "").expect("a file");
    std::os::unix::fs::symlink(&module, &companion).expect("a link");
    let description = file("tests/robots/single_joint.yaml");
    let output = check(&["generate", &description, "--out", module.to_str().expect("UTF-8"), "--bounds"], 2);
    assert!(err(&output).contains("two of the files to write would both be"), "{}", err(&output));
    assert_eq!(fs::read(&module).expect("still there"), b"");
}

/// Valid numbers whose product no float holds.
#[test]
fn products_out_of_range_are_told_before_anything_is_printed() {
    let text = fs::read_to_string(file("tests/robots/single_joint.yaml")).expect("a description");
    let folder = folder("out_of_range");
    for (size, scalar) in [("1e200", "f64"), ("1e30", "f32")] {
        let path = folder.join(format!("{scalar}.yaml"));
        let changed = text.replace("a: 0.6", &format!("a: {size}")).replace("mass: 1.2", &format!("mass: {size}"));
        assert!(changed.contains(&format!("mass: {size}")) && changed.contains(&format!("a: {size}")), "{changed}");
        fs::write(&path, changed).expect("a file");
        let path = path.to_str().expect("UTF-8");
        let output = check(&["generate", path, "--scalar", scalar], 1);
        assert!(out(&output).is_empty() && err(&output).contains("error["), "{}", err(&output));
        if scalar == "f64" {
            check(&["check", path], 1);
        }
    }
}

#[test]
fn a_certificate_is_written_and_verified_again() {
    // Friction of this arm does not grow with its load.
    let functions = armgen_codegen::catalogue::functions().filter(|(quantity, _)| quantity.name != "load_friction").count();
    for scalar in ["f64", "f32"] {
        let (folder, yaml) = (folder(&format!("verify_{scalar}")), file("robots/scara.yaml"));
        let (module, certificate) = (folder.join("robot.rs"), folder.join("robot.cert.json"));
        let path = module.to_str().expect("UTF-8");
        let output = check(&["generate", &yaml, "--scalar", scalar, "--out", path, "--verify"], 0);
        assert!(
            err(&output).contains(&format!("{functions} functions and 15 constants equal the equations")),
            "{}",
            err(&output)
        );
        let written: Value = serde_json::from_slice(&fs::read(&certificate).expect("it is written")).expect("JSON");
        assert_eq!((&written["verified"], &written["options"]["scalar"]), (&true.into(), &scalar.into()));
        assert_eq!(written["options"]["trig"], "libm");

        let text = out(&check(&["verify", &yaml, path], 0));
        assert!(text.contains("inertia_matrix") && text.contains("2^-") && text.contains("certificate: "), "{text}");
        assert!(text.contains("\nverified\n"), "{text}");

        // With another module the certificate does not fit; without one the module is judged all the same.
        let right = fs::read_to_string(&module).expect("the module");
        let at = right.find("pub fn gravity(").expect("a function");
        fs::write(&module, format!("{}{}", &right[..at], right[at..].replacen("98.1", "98.2", 1))).expect("a file");
        let output = check(&["verify", &yaml, path], 1);
        assert!(out(&output).contains("FAULT: the certificate is of another module"), "{}", out(&output));
        let line = right[..at].lines().count() + 1;
        assert!(err(&output).contains(&format!("robot.rs:{line}: gravity[2]: ")), "{}", err(&output));
        assert!(err(&output).contains("differs from the equations"), "{}", err(&output));
        assert!(err(&output).contains("] the module says -9.82"), "{}", err(&output));
        // Generating without --verify leaves no doubt about the certificate that is still there.
        let output = check(&["generate", &yaml, "--scalar", scalar, "--out", path], 0);
        assert!(err(&output).contains("robot.cert.json was not written again"), "{}", err(&output));
        fs::write(&certificate, "{").expect("a file");
        let output = check(&["verify", &yaml, path], 1);
        assert!(err(&output).contains("robot.cert.json: the certificate cannot be read: "), "{}", err(&output));
        fs::remove_file(&certificate).expect("it is there");
        check(&["verify", &yaml, path], 0);
        // The text of the module is judged, and this is not all of it.
        let text = fs::read_to_string(&module).expect("the module");
        fs::write(&module, format!("\u{feff}{text}")).expect("a file");
        let output = check(&["verify", &yaml, path], 1);
        assert!(err(&output).contains("begins with a byte order mark"), "{}", err(&output));
    }
}

#[test]
fn verify_tells_what_it_cannot_read() {
    let (yaml, module) = (file("robots/scara.yaml"), folder("verify_unreadable").join("robot.rs"));
    let path = module.to_str().expect("UTF-8");
    let output = check(&["verify", &yaml, &file("robots/none.rs")], 2);
    assert!(err(&output).contains("none.rs"), "{}", err(&output));
    check(&["verify", &file("robots/none.yaml"), &yaml], 2);
    fs::write(&module, "fn main() { loop {} }").expect("a file");
    let output = check(&["verify", &yaml, path], 1);
    assert!(err(&output).contains("robot.rs:1: `main` is not"), "{}", err(&output));
    let output = check(&["verify", &file("tests/bad/many-faults.yaml"), path], 1);
    assert!(err(&output).contains("many-faults.yaml:"), "{}", err(&output));
}

#[test]
fn what_stands_beside_a_module_needs_one() {
    for flag in ["--verify", "--tests", "--bounds", "--runtime", "--c-abi", "--ik"] {
        let output = check(&["generate", &file("robots/scara.yaml"), flag], 2);
        assert!(err(&output).contains(&format!("{flag} writes beside the module")), "{}", err(&output));
        assert_eq!(out(&output), "");
    }
}

#[test]
fn the_test_file_runs_beside_its_module() {
    let folder = folder("test_file");
    fs::create_dir_all(folder.join("src")).expect("a folder");
    let module = folder.join("src/arm.rs");
    let path = module.to_str().expect("UTF-8");
    check(&["generate", &file("robots/scara4.yaml"), "--out", path, "--tests"], 0);
    let manifest = "[package]\nname = \"test-file\"\nversion = \"0.1.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n";
    fs::write(folder.join("Cargo.toml"), manifest).expect("a file");
    fs::write(folder.join("src/lib.rs"), "pub mod arm;\n#[cfg(test)]\nmod arm_test;\n").expect("a file");
    let run = || {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["test", "--offline", "--quiet"]).current_dir(&folder).env("CARGO_TARGET_DIR", folder.join("target"));
        cargo.output().expect("cargo runs")
    };
    let output = run();
    assert!(output.status.success(), "{}{}", out(&output), err(&output));
    let right = fs::read_to_string(&module).expect("the module");
    let at = right.find("pub fn gravity(").expect("a function");
    fs::write(&module, format!("{}{}", &right[..at], right[at..].replacen("98.1", "98.2", 1))).expect("a file");
    let output = run();
    assert!(!output.status.success() && out(&output).contains("gravity at state 0"), "{}{}", out(&output), err(&output));
}

#[test]
fn error_bounds_stand_in_the_documentation_and_in_a_companion() {
    let folder = folder("bounds");
    let module = folder.join("arm.rs");
    let path = module.to_str().expect("UTF-8");
    check(&["generate", &file("robots/scara.yaml"), "--out", path, "--bounds", "--verify"], 0);
    let text = fs::read_to_string(&module).expect("the module");
    // What writes into memory of the caller has the errors of the function that returns the same.
    let functions = text.lines().filter(|line| line.starts_with("pub fn ") && !line.contains("_into(")).count();
    assert_eq!(text.matches("/// Rounding error: ").count(), functions, "{text}");
    assert!(text.contains("// Box of the rounding errors: "), "{text}");
    let companion = fs::read_to_string(folder.join("arm_bounds.rs")).expect("the companion");
    assert!(companion.contains("use super::arm::*;") && companion.contains("pub fn gravity_error_bound("), "{companion}");
    let certificate: Value =
        serde_json::from_slice(&fs::read(folder.join("arm.cert.json")).expect("the certificate")).expect("JSON");
    let gravity = certificate["functions"].as_array().expect("a list").iter().find(|f| f["name"] == "gravity").expect("gravity");
    let bound: f64 = gravity["error_bound"].as_str().expect("a text").parse().expect("a number");
    assert!(bound > 0.0 && bound < 1e-12, "{bound}");
    assert_eq!(certificate["rounding_box"]["q"].as_array().expect("a list").len(), 4);
    check(&["verify", &file("robots/scara.yaml"), path], 0);
}

#[test]
fn inverse_kinematics_is_named_shown_and_written() {
    let scara = file("robots/scara.yaml");
    let text = out(&check(&["check", &scara], 0));
    assert!(text.contains("all revolute axes parallel (joints 1 2 4): at most 2 solutions"), "{text}");
    let text = out(&check(&["show", &scara, "inverse_kinematics"], 0));
    assert!(text.starts_with("inverse_kinematics: all revolute axes parallel (joints 1 2 4), at most 2 solutions\n"), "{text}");
    assert!(text.contains("two links in the plane") && text.contains("singular: elbow stretched"), "{text}");
    let text = out(&check(&["show", &file("robots/panda7.yaml"), "inverse_kinematics"], 0));
    assert!(text.contains("; q7 is given, at most 8 solutions\n  given T = (R p; 0 1) and q7\n"), "{text}");
    check(&["show", &scara, "inverse_kinematics", "--format", "json"], 2);
    // Among everything, and among what is known.
    let all = out(&check(&["show", &scara], 0));
    assert!(all.contains("\ninverse_kinematics: all revolute axes parallel (joints 1 2 4), at most 2 solutions\n"), "{all}");
    let unknown = err(&check(&["show", &scara, "inverse_kinematic"], 2));
    assert!(unknown.contains("did you mean `inverse_kinematics`?"), "{unknown}");
    let module = folder("inverse_kinematics").join("robot.rs");
    check(&["generate", &scara, "--out", module.to_str().expect("UTF-8"), "--ik"], 0);
    let text = fs::read_to_string(module.with_file_name("robot_ik.rs")).expect("inverse kinematics");
    assert!(text.contains("pub fn inverse_kinematics(t: &[[Real; 4]; 4]) -> Solutions {"), "{text}");
}

/// The files that `generate` writes beside a module, of one robot, and then the module of another.
#[test]
fn companions_of_another_description_are_told() {
    let folder = folder("stale");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let (first, second, module) = (file("robots/scara4.yaml"), file("tests/robots/single_joint.yaml"), path("robot.rs"));
    let beside = ["--ik", "--bounds", "--runtime", "--tests", "--c-abi"];
    let output = check(&[&["generate", &first, "--out", &module][..], &beside].concat(), 0);
    assert!(!err(&output).contains("another description"), "{}", err(&output));
    fs::write(path("robot_ik_c.rs"), "my own").expect("a file");
    let companions =
        ["robot_ik.h", "robot_ik.rs", "robot_bounds.rs", "robot_runtime.rs", "robot_test.rs", "robot_c.rs", "robot.h"];
    let output = check(&["generate", &first, "--out", &module], 0);
    assert!(!err(&output).contains("another description"), "{}", err(&output));
    let output = check(&["generate", &second, "--out", &module, "--bounds"], 0);
    for companion in companions {
        let told = err(&output).contains(&format!("{} was not written again and is of another description", path(companion)));
        assert_eq!(told, companion != "robot_bounds.rs", "{companion}: {}", err(&output));
    }
    assert!(!err(&output).contains("robot_ik_c.rs"), "a file of somebody else: {}", err(&output));
    // None of them is a module to verify, or to be written over by one.
    for companion in companions.into_iter().filter(|name| *name != "robot_ik.rs") {
        let output = check(&["verify", &first, &path(companion)], 1);
        let with = if companion == "robot_ik.h" { path("robot_ik.rs") } else { module.clone() };
        let said = err(&output);
        assert!(said.contains(&format!("goes with {with}: verify that one")) && !said.contains("writes module"), "{said}");
    }
    let output = check(&["verify", &second, &path("robot_ik.rs")], 1);
    assert!(err(&output).contains("is of another description: it was made from scara4.yaml (input "), "{}", err(&output));
}

/// An arm whose last joint turns about the axis that `pointing` leaves open, and one whose task is no target.
#[test]
fn an_arm_without_inverse_kinematics_is_told() {
    let folder = folder("without_ik");
    let path = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let text = fs::read_to_string(file("robots/puma560.yaml")).expect("a description");
    for (asked, language, name, code) in [
        (Some("inverse_kinematics: {target: pointing}\n"), "rust", "arm.rs", 1),
        (Some("inverse_kinematics: {target: pointing}\n"), "c", "arm.h", 1),
        (None, "rust", "arm.rs", 0),
        (None, "c", "arm.h", 0),
    ] {
        let (yaml, module) = (path("arm.yaml"), path(name));
        let text = asked.map_or_else(
            || fs::read_to_string(file("tests/robots/counterbalance.yaml")).expect("a description"),
            |asked| format!("{text}\n{asked}"),
        );
        fs::write(&yaml, text).expect("a file");
        let output = check(&["generate", &yaml, "--language", language, "--out", &module, "--ik"], code);
        assert!(err(&output).contains("there is no") && err(&output).contains(": "), "{}", err(&output));
        assert_eq!(err(&output).contains("nothing is written"), code == 1, "{}", err(&output));
        assert_eq!(Path::new(&module).exists(), code == 0);
    }
}

#[test]
fn the_face_for_c_stands_beside_the_module() {
    let folder = folder("c_abi");
    let module = folder.join("robot.rs");
    check(&["generate", &file("robots/scara.yaml"), "--out", module.to_str().expect("UTF-8"), "--c-abi", "--runtime"], 0);
    let runtime = fs::read_to_string(folder.join("robot_runtime.rs")).expect("the implementation");
    assert!(runtime.contains("impl armgen_runtime::"), "{runtime}");
    let header = fs::read_to_string(folder.join("robot.h")).expect("the header");
    assert!(header.contains("void scara_inertia_matrix("), "{header}");
    let wrappers = fs::read_to_string(folder.join("robot_c.rs")).expect("the wrappers");
    assert!(wrappers.contains("pub unsafe extern \"C\" fn scara_inertia_matrix("), "{wrappers}");
}

#[test]
fn the_built_robot_moves_and_leaves_figures_and_logs() {
    let folder = folder("run");
    let output = check(&["run", "--out", folder.to_str().expect("UTF-8")], 0);
    let text = out(&output);
    assert!(text.contains("spectral radius"), "{text}");
    let written = |extension: &str| -> Vec<String> {
        let names = text.lines().map(str::trim).filter(|line| line.ends_with(extension));
        names.map(|name| fs::read_to_string(name).expect("it is written")).collect()
    };
    let (figures, logs) = (written(".svg"), written(".csv"));
    assert!(!figures.is_empty() && figures.len() == logs.len(), "{text}");
    for figure in figures {
        assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
        assert!(!figure.contains("NaN"));
    }
    for log in logs {
        let mut lines = log.lines();
        let columns = lines.next().expect("a header").split(',').count();
        assert!(lines.clone().count() > 100);
        assert!(lines.all(|line| line.split(',').filter(|cell| cell.parse::<f64>().is_ok_and(f64::is_finite)).count() == columns));
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    let file = folder("unwritable").join("file");
    fs::write(&file, "").expect("a file");
    let output = check(&["run", "--out", file.to_str().expect("UTF-8")], 2);
    assert!(err(&output).contains("cannot write"), "{}", err(&output));
}

#[test]
fn no_colour_where_nobody_sees_it() {
    for arguments in
        [vec!["--help"], vec!["check", &file("robots/scara.yaml")], vec!["check", &file("tests/bad/many-faults.yaml")]]
    {
        let output = armgen(&arguments);
        assert!(!out(&output).contains('\u{1b}') && !err(&output).contains('\u{1b}'), "armgen {arguments:?}");
    }
}

#[test]
fn a_closed_pipe_is_no_fault() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_armgen"))
        .args(["show", &file("robots/ur5.yaml")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{}", err(&output));
    assert_eq!(err(&output), "");
}

#[test]
fn completions_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert!(out(&check(&["completions", shell], 0)).contains("symbolic"));
    }
}

#[test]
fn help_has_examples() {
    for command in
        ["", "check", "show", "generate", "import", "convert", "export", "verify", "count", "page", "run", "completions"]
    {
        let arguments: Vec<&str> = [command, "--help"].into_iter().filter(|a| !a.is_empty()).collect();
        let text = out(&check(&arguments, 0));
        assert!(text.contains("Examples:\n"), "armgen {arguments:?}");
        insta::assert_snapshot!(format!("help {command}").trim().replace(' ', "_"), text);
    }
}

/// The first commands of docs/import.md, on an arm of the tests.
#[test]
fn a_urdf_becomes_a_description_that_is_valid_and_verified() {
    let folder = folder("import");
    let path = |name: &str| folder.join(name).to_str().expect("a UTF-8 path").to_string();
    let urdf = file("import/tests/urdf/everything.urdf");
    let (yaml, report, module) = (path("robot.yaml"), path("report.json"), path("robot.rs"));
    let chain = ["import", &urdf, "--base", "base", "--tip", "tip"];
    let output = check(&[&chain[..], &["--lock", "finger=0.04", "--out", &yaml, "--report", &report]].concat(), 0);
    assert!(err(&output).contains("moves by at most"), "{}", err(&output));
    let report: Value = serde_json::from_str(&fs::read_to_string(&report).expect("a report")).expect("the report is JSON");
    assert_eq!(report["joints"].as_array().map(Vec::len), Some(3));
    check(&["check", &yaml], 0);
    check(&["generate", &yaml, "--out", &module, "--verify"], 0);
    // And back to a URDF, which is the same arm.
    let (back, again) = (path("back.urdf"), path("again.yaml"));
    check(&["export", &yaml, "--format", "urdf", "--out", &back], 0);
    check(&["import", &back, "--tip", "tool", "--out", &again], 0);
    check(&["export", &yaml, "--format", "urdf", "--out", &yaml], 2);
    // And in rows of Denavit and Hartenberg.
    check(&["convert", &yaml, "--convention", "modified", "--out", &again], 0);
    check(&["check", &again], 0);
    // Without --tip two fingers and the tip may be meant.
    let refused = check(&["import", &urdf, "--base", "base"], 1);
    assert!(err(&refused).contains("error[several-tips]"), "{}", err(&refused));
    check(&[&chain[..], &["--lock", "finger=0.04", "--convention", "standard", "--out", &again]].concat(), 0);
    check(&["check", &again], 0);
    check(&["import", &urdf, "--lock", "finger"], 2);
    check(&["import", &urdf, "--snap", "1"], 2);
}
