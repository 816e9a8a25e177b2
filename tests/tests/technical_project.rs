//! The SCARA of the technical project: what `show` prints against every closed form of the report.

use std::collections::BTreeMap;

use armgen_tests::oracle::Description;
use armgen_tests::precision::{agree, ORACLE};
use armgen_tests::random;
use armgen_tests::shown::state_names;
use armgen_tests::technical_project::{self, compare, Formulas, Reading, PARAMETERS};
use armgen_tests::trigonometry::{product, Exact, ExactMatrix, Names};
use armgen_tests::{formula, oracle};
use serde_json::{json, Value};

/// What `show ROBOT --format json` prints of robots/scara.yaml, with `--symbolic` for the second reading.
///
/// THE ONE PLACE where the generator comes in: everything below takes what this returns.
fn shown(reading: Reading) -> Value {
    use armgen_codegen::{show, source::Source, validate, Model};
    let source = Source::new("scara.yaml", include_str!("../../robots/scara.yaml"));
    let model = Model::new(validate::read(&source).0.expect("robots/scara.yaml is valid").0);
    let reading = match reading {
        Reading::Nominal => show::Reading::Nominal,
        Reading::Symbolic => show::Reading::Symbolic,
    };
    let sheet =
        show::Sheet::in_style(&model, &show::Item::all(&[]), reading, show::Style { form: show::Form::Closed, digits: None });
    serde_json::from_str(&sheet.json()).expect("what is printed is JSON")
}

#[test]
fn closed_forms_with_numbers() {
    compare(&shown(Reading::Nominal), Reading::Nominal).unwrap_or_else(|faults| panic!("{}", faults.join("\n")));
}

#[test]
fn closed_forms_with_names() {
    compare(&shown(Reading::Symbolic), Reading::Symbolic).unwrap_or_else(|faults| panic!("{}", faults.join("\n")));
}

/// Output as the generator would print it: the transcribed forms, some of them in another writing; forward dynamics as steps.
fn hand_made(reading: Reading) -> Value {
    let forms = match reading {
        Reading::Nominal => technical_project::nominal(),
        Reading::Symbolic => technical_project::symbolic(),
    };
    let closed = |name: &str, entries: &Formulas| json!({"name": name, "symbol": name, "rows": entries.len(), "columns": entries[0].len(), "entries": entries, "form": "closed"});
    let mut quantities: Vec<Value> =
        forms.iter().filter(|(name, _)| **name != "determinant").map(|(name, entries)| closed(name, entries)).collect();
    quantities.push(json!({"name": "determinant", "symbol": "det J", "rows": 1, "columns": 1, "entries": [["1/4*sin(q2)"]],
        "form": "closed", "factors": ["1/4", "sin(q2)"], "singular": [null, "q2 = k*pi"]}));

    let times = |name: &str, v: &str| -> Vec<String> {
        let term = |row: &Vec<String>| (0..4).map(|j| format!("({})*{v}{}", row[j], j + 1)).collect::<Vec<_>>().join(" + ");
        forms[name].iter().map(term).collect()
    };
    let (b_ddq, b_dq, c_dq) = (times("inertia_matrix", "ddq"), times("inertia_matrix", "dq"), times("coriolis_matrix", "dq"));
    let bias = |i: usize| format!("{} + {} + {}", c_dq[i], forms["gravity"][i][0], forms["friction"][i][0]);
    let tau: Formulas = (0..4).map(|i| vec![format!("{} + {}", b_ddq[i], bias(i))]).collect();
    quantities.push(closed("inverse_dynamics", &tau));
    let twice: Vec<String> = (0..4).map(|i| format!("dq{}*({})", i + 1, b_dq[i])).collect();
    quantities.push(closed("kinetic_energy", &vec![vec![format!("({})/2", twice.join(" + "))]]));
    let u = if reading == Reading::Nominal { "4905/100 - 98.1*q3 + 392.4" } else { "981/100*(m_l1 + m_l2 + m_l3/2 - m_l3*q3)" };
    quantities.push(closed("potential_energy", &vec![vec![u.to_owned()]]));

    // Elimination, written out as steps: row i minus l times row k.
    let mut steps: Vec<(String, String)> = Vec::new();
    for i in 0..4 {
        for j in 0..4 {
            steps.push((format!("b{i}{j}"), forms["inertia_matrix"][i][j].clone()));
        }
        steps.push((format!("b{i}4"), format!("tau{} - ({})", i + 1, bias(i))));
    }
    let mut name = |what: String, text: String| {
        let step = format!("{what}_{}", steps.len());
        steps.push((step.clone(), text));
        step
    };
    let mut rows: Vec<Vec<String>> = (0..4).map(|i| (0..5).map(|j| format!("b{i}{j}")).collect()).collect();
    for k in 0..4 {
        for i in k + 1..4 {
            let l = name("l".to_owned(), format!("{}/{}", rows[i][k], rows[k][k]));
            for j in k..5 {
                rows[i][j] = name("r".to_owned(), format!("{} - {l}*{}", rows[i][j], rows[k][j]));
            }
        }
    }
    let mut x: Vec<String> = vec![String::new(); 4];
    for k in (0..4).rev() {
        let known: String = (k + 1..4).map(|j| format!(" - {}*{}", rows[k][j], x[j])).collect();
        x[k] = name("x".to_owned(), format!("({}{known})/{}", rows[k][4], rows[k][k]));
    }
    let entries: Formulas = x.into_iter().map(|x| vec![x]).collect();
    quantities.push(json!({"name": "forward_dynamics", "symbol": "ddq", "rows": 4, "columns": 1, "entries": entries,
        "form": "program", "steps": steps}));
    json!({"robot": "scara", "quantities": quantities})
}

/// Every entry of every quantity counts: a small change of any one is found, and so is whatever is missing.
#[test]
#[ignore = "wide"]
fn planted_errors_are_seen() {
    for reading in [Reading::Nominal, Reading::Symbolic] {
        let sound = hand_made(reading);
        let count = sound["quantities"].as_array().map_or(0, Vec::len);
        assert_eq!(count, 17);
        for quantity in 0..count {
            let name = sound["quantities"][quantity]["name"].as_str().expect("a name");
            let (rows, columns) = match &sound["quantities"][quantity]["entries"] {
                Value::Array(rows) => (rows.len(), rows[0].as_array().map_or(0, Vec::len)),
                _ => panic!("{name} has no entries"),
            };
            // All entries of the small ones; some, zeros among them, of the others.
            for k in (0..rows * columns).step_by((rows * columns / 5).max(1)) {
                let mut changed = sound.clone();
                let entry = &mut changed["quantities"][quantity]["entries"][k / columns][k % columns];
                // The potential energy may differ by a constant.
                let error = if name == "potential_energy" { "q2*1e-15" } else { "1e-9" };
                *entry = Value::String(format!("{} + {error}", entry.as_str().expect("text")));
                let faults = compare(&changed, reading).expect_err(name);
                assert!(faults.iter().any(|fault| fault.contains(name) || name == "forward_dynamics"), "{name}: {faults:?}");
            }
            let mut missing = sound.clone();
            missing["quantities"].as_array_mut().expect("a list").remove(quantity);
            assert!(compare(&missing, reading).is_err(), "{name} may be missing");
        }
    }
    let nominal = hand_made(Reading::Nominal);
    let determinant = nominal["quantities"].as_array().unwrap().iter().position(|q| q["name"] == "determinant").unwrap();
    for (key, wrong) in [
        ("factors", json!(["sin(q2)", "sin(q2)"])),
        ("factors", json!(["cos(q2)"])),
        ("singular", json!(["q2 = k*pi/2"])),
        ("singular", json!([null])),
        ("singular", Value::Null),
        ("form", json!("program")),
        ("rows", json!(2)),
    ] {
        let mut changed = nominal.clone();
        changed["quantities"][determinant][key] = wrong;
        assert!(compare(&changed, Reading::Nominal).is_err(), "a wrong `{key}` passes");
    }
    let mut other = nominal;
    other["robot"] = json!("scara4");
    assert!(compare(&other, Reading::Nominal).is_err());
}

fn exact(formulas: &Formulas) -> ExactMatrix {
    technical_project::read(formulas, &Names::new())
}

fn one(text: &str) -> Exact {
    Exact::read(text).expect(text)
}

fn add(terms: impl IntoIterator<Item = Exact>) -> Exact {
    terms.into_iter().fold(Exact::integer(0), |sum, x| &sum + &x)
}

/// Derivative along the motion: sum over k of d/dq_k times dq_k.
fn rate(x: &Exact) -> Exact {
    add((1..=4).map(|k| &x.derivative(&format!("q{k}")) * &one(&format!("dq{k}"))))
}

/// The transcription is sound in itself, exactly: derivatives, Christoffel symbols, skewness, linearity, nominal and loaded values.
#[test]
fn the_transcription_obeys_the_laws() {
    let forms = technical_project::symbolic();
    let (t, j) = (exact(&forms["direct_kinematics"]), exact(&forms["geometric_jacobian"]));
    let j_dot = exact(&forms["geometric_jacobian_dot"]);
    let phi = one("q1+q2-q4");
    for k in 0..4 {
        let name = format!("q{}", k + 1);
        for i in 0..3 {
            assert!(t[i][3].derivative(&name) == j[i][k], "J[{i}][{k}]");
        }
        assert!(phi.derivative(&name) == j[5][k], "J[5][{k}]");
        for i in 0..6 {
            assert!(rate(&j[i][k]) == j_dot[i][k], "dJ/dt[{i}][{k}]");
        }
    }
    // The rotation satisfies R R' = 1, and the determinant belongs to the task rows.
    for i in 0..3 {
        for k in 0..3 {
            assert!(add((0..3).map(|c| &t[i][c] * &t[k][c])) == Exact::integer(i64::from(i == k)));
        }
    }
    let task = [0, 1, 2, 5].map(|row| j[row].clone());
    assert!(determinant(&task) == one("sin(q2)/4"));

    let (b, c) = (exact(&forms["inertia_matrix"]), exact(&forms["coriolis_matrix"]));
    for i in 0..4 {
        for j in 0..4 {
            assert!(b[i][j] == b[j][i], "B[{i}][{j}]");
            let d = |x: &Exact, k: usize| x.derivative(&format!("q{}", k + 1));
            let symbol = |k: usize| &one("1/2") * &(&(&d(&b[i][j], k) + &d(&b[i][k], j)) - &d(&b[j][k], i));
            assert!(add((0..4).map(|k| &symbol(k) * &one(&format!("dq{}", k + 1)))) == c[i][j], "C[{i}][{j}]");
            let skew = |i: usize, j: usize| &rate(&b[i][j]) - &(&Exact::integer(2) * &c[i][j]);
            assert!((&skew(i, j) + &skew(j, i)).is_zero(), "dB/dt - 2C at [{i}][{j}]");
        }
        let potential = one(technical_project::POTENTIAL_ENERGY).derivative(&format!("q{}", i + 1));
        assert!(potential == exact(&forms["gravity"])[i][0], "g[{i}]");
    }

    // Y pi = B ddqr + C dqr + F dqr + g.
    let column = |prefix: &str| -> ExactMatrix { (1..=4).map(|i| vec![one(&format!("{prefix}{i}"))]).collect() };
    let pi: ExactMatrix = PARAMETERS.iter().map(|(name, _)| vec![one(name)]).collect();
    let y_pi = product(&exact(&forms["regressor"]), &pi);
    let to_reference: Names = (1..=4).map(|i| (format!("dq{i}"), one(&format!("dqr{i}")))).collect();
    let friction = technical_project::read(&forms["friction"], &to_reference);
    let (inertial, coriolis) = (product(&b, &column("ddqr")), product(&c, &column("dqr")));
    for i in 0..4 {
        let right = add([&inertial[i][0], &coriolis[i][0], &friction[i][0], &exact(&forms["gravity"])[i][0]].map(Exact::clone));
        assert!(y_pi[i][0] == right, "Y pi [{i}]");
    }

    // The formulas with names give the numbers of the report, without and with the load.
    let mut loaded = technical_project::nominal_names();
    loaded.insert("m_l3".to_owned(), Exact::integer(15));
    for (numbers, names) in
        [(technical_project::nominal(), technical_project::nominal_names()), (technical_project::loaded(), loaded)]
    {
        for (name, formulas) in numbers {
            assert!(exact(&formulas) == technical_project::read(&forms[name], &names), "{name}");
        }
    }
}

/// Laplace along the first row.
fn determinant(m: &[Vec<Exact>]) -> Exact {
    if m.is_empty() {
        return Exact::integer(1);
    }
    add((0..m.len()).map(|j| {
        let minor: ExactMatrix =
            m[1..].iter().map(|row| row.iter().enumerate().filter(|(k, _)| *k != j).map(|(_, x)| x.clone()).collect()).collect();
        let product = &m[0][j] * &determinant(&minor);
        if j % 2 == 0 {
            product
        } else {
            -&product
        }
    }))
}

/// The transcription against the oracle's model of the data sheet, at random states.
#[test]
fn the_transcription_agrees_with_the_oracle() {
    let scara = Description::read(technical_project::ROBOT).expect("well-formed");
    let model = scara.model().expect("valid");
    let forms = technical_project::nominal();
    for seed in 0..10 {
        let s = random::state(4, seed);
        let names = state_names(&[("q", &s.q), ("dq", &s.dq), ("dqr", &s.dqr), ("ddqr", &s.ddqr)]);
        let value = |name: &str| -> Vec<f64> { forms[name].iter().flatten().map(|text| number(text, &names)).collect() };
        let check = |name: &str, expected: &[f64]| agree(name, &value(name), expected, ORACLE);
        check("direct_kinematics", &model.direct_kinematics(&s.q).concat());
        for (i, frame) in model.link_frames(&s.q).iter().enumerate() {
            check(&format!("link_frame_{}", i + 1), &frame.concat());
        }
        check("geometric_jacobian", &model.geometric_jacobian(&s.q).concat());
        check("geometric_jacobian_dot", &model.geometric_jacobian_dot(&s.q, &s.dq).concat());
        check("inertia_matrix", &model.inertia_matrix(&s.q).concat());
        check("coriolis_matrix", &model.coriolis_matrix(&s.q, &s.dq).concat());
        check("gravity", &model.gravity(&s.q));
        check("friction", &model.friction(&s.dq));
        let regressor: oracle::Regressor = scara.regressor(&s.q, &s.dq, &s.dqr, &s.ddqr).expect("names").expect("parameters");
        check("regressor", &regressor.y.concat());
    }
}

fn number(text: &str, names: &BTreeMap<String, f64>) -> f64 {
    formula::parse(text).and_then(|f| formula::evaluate(&f, names)).unwrap_or_else(|error| panic!("{error}"))
}
