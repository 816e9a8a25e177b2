//! Quantities and their operations, for people and as JSON.

use serde_json::Value;

use super::{check, err, file, json, out};

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
