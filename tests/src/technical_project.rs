//! The SCARA of the technical project: every closed form of its report, as corrected, and the comparison with what `show` prints.
//!
//! The formulas are transcribed by hand, every zero included; q3 is d3. Nothing here is computed by the generator.
//! Source: the technical project's data sheet and closed forms, symbols of the book.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::oracle::times;
use crate::precision::{deviation, CHECK_STATE};
use crate::shown::{state_names, Quantity, Shown};
use crate::trigonometry::{product, Exact, ExactMatrix, Names};

/// The parameters in the order of the report, with their nominal values.
pub const PARAMETERS: [(&str, &str); 14] = [
    ("m_l1", "20"),
    ("m_l2", "20"),
    ("m_l3", "10"),
    ("I_l1", "4"),
    ("I_l2", "4"),
    ("I_l4", "1"),
    ("I_m1", "0.01"),
    ("I_m2", "0.01"),
    ("I_m3", "0.005"),
    ("I_m4", "0.001"),
    ("F_m1", "5e-5"),
    ("F_m2", "5e-5"),
    ("F_m3", "0.01"),
    ("F_m4", "0.005"),
];

/// The data sheet as a description, for the oracle.
pub const ROBOT: &str = "\
name: scara
convention: standard
gravity: [0, 0, -9.81]
parameters: {m_l1: 20, m_l2: 20, m_l3: 10, I_l1: 4, I_l2: 4, I_l4: 1,
  I_m1: 0.01, I_m2: 0.01, I_m3: 0.005, I_m4: 0.001, F_m1: 5e-5, F_m2: 5e-5, F_m3: 0.01, F_m4: 0.005}
joints:
  - {name: joint1, type: revolute, a: 0.5, alpha: 0, d: 1, theta: 0,
     link: {mass: m_l1, com: [-0.25, 0, 0], inertia: {zz: I_l1}}, motor: {ratio: 1, inertia: I_m1, viscous: F_m1}}
  - {name: joint2, type: revolute, a: 0.5, alpha: pi, d: 0, theta: 0,
     link: {mass: m_l2, com: [-0.25, 0, 0], inertia: {zz: I_l2}}, motor: {ratio: 1, inertia: I_m2, viscous: F_m2}}
  - {name: joint3, type: prismatic, a: 0, alpha: 0, d: 0.5, theta: 0,
     link: {mass: m_l3}, motor: {ratio: 50, inertia: I_m3, viscous: F_m3}}
  - {name: joint4, type: revolute, a: 0, alpha: 0, d: 0, theta: -pi/2,
     link: {mass: 0, inertia: {zz: I_l4}}, motor: {ratio: 20, inertia: I_m4, viscous: F_m4}}
task: [x, y, z, rz]
regressor: [m_l1, m_l2, m_l3, I_l1, I_l2, I_l4, I_m1, I_m2, I_m3, I_m4, F_m1, F_m2, F_m3, F_m4]
";

/// Formulas by rows.
pub type Formulas = Vec<Vec<String>>;

fn matrix<const R: usize, const C: usize>(rows: [[&str; C]; R]) -> Formulas {
    rows.iter().map(|row| row.iter().map(|x| (*x).to_owned()).collect()).collect()
}

/// What holds whatever the parameters are: kinematics, regressor.
fn common() -> BTreeMap<&'static str, Formulas> {
    let phi = "q1+q2-q4";
    // R(phi = 0) = [[0,1,0],[1,0,0],[0,0,-1]], turned about z0 by phi; position x_e.
    let direct_kinematics: Formulas = [
        [&format!("-sin({phi})"), &format!("cos({phi})"), "0", "cos(q1+q2)/2 + cos(q1)/2"],
        [&format!("cos({phi})"), &format!("sin({phi})"), "0", "sin(q1+q2)/2 + sin(q1)/2"],
        ["0", "0", "-1", "1/2 - q3"],
        ["0", "0", "0", "1"],
    ]
    .iter()
    .map(|row| row.iter().map(|x| (*x).to_owned()).collect())
    .collect();
    let geometric_jacobian = matrix([
        ["-sin(q1+q2)/2 - sin(q1)/2", "-sin(q1+q2)/2", "0", "0"],
        ["cos(q1+q2)/2 + cos(q1)/2", "cos(q1+q2)/2", "0", "0"],
        ["0", "0", "-1", "0"],
        ["0", "0", "0", "0"],
        ["0", "0", "0", "0"],
        ["1", "1", "0", "-1"],
    ]);
    let geometric_jacobian_dot = matrix([
        ["-(dq1+dq2)*cos(q1+q2)/2 - dq1*cos(q1)/2", "-(dq1+dq2)*cos(q1+q2)/2", "0", "0"],
        ["-(dq1+dq2)*sin(q1+q2)/2 - dq1*sin(q1)/2", "-(dq1+dq2)*sin(q1+q2)/2", "0", "0"],
        ["0", "0", "0", "0"],
        ["0", "0", "0", "0"],
        ["0", "0", "0", "0"],
        ["0", "0", "0", "0"],
    ]);
    // Rows 1 to 4 of the data sheet's table, multiplied out.
    let link_frame_1 = matrix([
        ["cos(q1)", "-sin(q1)", "0", "cos(q1)/2"],
        ["sin(q1)", "cos(q1)", "0", "sin(q1)/2"],
        ["0", "0", "1", "1"],
        ["0", "0", "0", "1"],
    ]);
    let link_frame_2 = matrix([
        ["cos(q1+q2)", "sin(q1+q2)", "0", "cos(q1+q2)/2 + cos(q1)/2"],
        ["sin(q1+q2)", "-cos(q1+q2)", "0", "sin(q1+q2)/2 + sin(q1)/2"],
        ["0", "0", "-1", "1"],
        ["0", "0", "0", "1"],
    ]);
    let mut link_frame_3 = link_frame_2.clone();
    link_frame_3[2][3] = "1/2 - q3".to_owned();
    BTreeMap::from([
        ("link_frame_1", link_frame_1),
        ("link_frame_2", link_frame_2),
        ("link_frame_3", link_frame_3),
        ("link_frame_4", direct_kinematics.clone()),
        ("direct_kinematics", direct_kinematics),
        ("geometric_jacobian", geometric_jacobian),
        ("geometric_jacobian_dot", geometric_jacobian_dot),
        ("determinant", matrix([["sin(q2)/4"]])),
        ("regressor", regressor()),
    ])
}

/// Y(q, dq, dqr, ddqr), 4 x 14; entries not listed are zero.
fn regressor() -> Formulas {
    let (a, k1, k2) = ("(ddqr1+ddqr2)", "(dq2*dqr1 + (dq1+dq2)*dqr2)", "(dq1*dqr1)");
    let rows: [&[(&str, String)]; 4] = [
        &[
            ("m_l1", "ddqr1/16".to_owned()),
            ("m_l2", format!("(5*ddqr1 + ddqr2 + cos(q2)*(4*ddqr1+2*ddqr2) - 2*sin(q2)*{k1})/16")),
            ("m_l3", format!("(2*ddqr1 + ddqr2 + cos(q2)*(2*ddqr1+ddqr2) - sin(q2)*{k1})/4")),
            ("I_l1", "ddqr1".to_owned()),
            ("I_l2", a.to_owned()),
            ("I_l4", format!("{a} - ddqr4")),
            ("I_m1", "ddqr1".to_owned()),
            ("I_m2", a.to_owned()),
            ("I_m3", format!("{a} - 50*ddqr3")),
            ("I_m4", format!("{a} - 20*ddqr4")),
            ("F_m1", "dqr1".to_owned()),
        ],
        &[
            ("m_l2", format!("({a} + 2*cos(q2)*ddqr1 + 2*sin(q2)*{k2})/16")),
            ("m_l3", format!("({a} + cos(q2)*ddqr1 + sin(q2)*{k2})/4")),
            ("I_l2", a.to_owned()),
            ("I_l4", format!("{a} - ddqr4")),
            ("I_m2", a.to_owned()),
            ("I_m3", format!("{a} - 50*ddqr3")),
            ("I_m4", format!("{a} - 20*ddqr4")),
            ("F_m2", "dqr2".to_owned()),
        ],
        &[("m_l3", "ddqr3 - 9.81".to_owned()), ("I_m3", format!("-50*({a} - 50*ddqr3)")), ("F_m3", "2500*dqr3".to_owned())],
        &[("I_l4", format!("-({a} - ddqr4)")), ("I_m4", format!("-20*({a} - 20*ddqr4)")), ("F_m4", "400*dqr4".to_owned())],
    ];
    let mut y = vec![vec!["0".to_owned(); PARAMETERS.len()]; 4];
    for (row, entries) in rows.iter().enumerate() {
        for (name, formula) in *entries {
            let column = PARAMETERS.iter().position(|(parameter, _)| parameter == name).expect("a parameter");
            y[row][column].clone_from(formula);
        }
    }
    y
}

/// Closed forms with the nominal numbers, by the names of the emitted functions.
pub fn nominal() -> BTreeMap<&'static str, Formulas> {
    let mut all = common();
    all.extend(with_numbers("10*cos(q2) + 10763/500", "5*cos(q2) + 4383/500", "4383/500", "45/2", "5*sin(q2)", "-98.1"));
    all
}

/// Closed forms of B, C, g with the load of 5 kg: m_l3 = 15.
pub fn loaded() -> BTreeMap<&'static str, Formulas> {
    with_numbers("12.5*cos(q2) + 12013/500", "6.25*cos(q2) + 1252/125", "1252/125", "55/2", "6.25*sin(q2)", "-147.15")
}

/// B, C, g and friction, where only these numbers differ; the report gives h of C as 5 s (6.25 s).
fn with_numbers(b11: &str, b12: &str, b22: &str, b33: &str, h: &str, g3: &str) -> BTreeMap<&'static str, Formulas> {
    let (c11, c12, c21) = (format!("-({h})*dq2"), format!("-({h})*(dq1+dq2)"), format!("({h})*dq1"));
    BTreeMap::from([
        (
            "inertia_matrix",
            matrix([
                [b11, b12, "-1/4", "-51/50"],
                [b12, b22, "-1/4", "-51/50"],
                ["-1/4", "-1/4", b33, "0"],
                ["-51/50", "-51/50", "0", "7/5"],
            ]),
        ),
        ("coriolis_matrix", matrix([[&c11, &c12, "0", "0"], [&c21, "0", "0", "0"], ["0", "0", "0", "0"], ["0", "0", "0", "0"]])),
        ("gravity", matrix([["0"], ["0"], [g3], ["0"]])),
        ("friction", matrix([["5e-5*dq1"], ["5e-5*dq2"], ["25*dq3"], ["2*dq4"]])),
    ])
}

/// Closed forms with the parameters' names.
pub fn symbolic() -> BTreeMap<&'static str, Formulas> {
    let b11 = "I_l1+I_l2+I_l4 + I_m1+I_m2+I_m3+I_m4 + m_l1/16 + 5*m_l2/16 + m_l3/2 + (m_l2/4 + m_l3/2)*cos(q2)";
    let b12 = "I_l2+I_l4 + I_m2+I_m3+I_m4 + m_l2/16 + m_l3/4 + (m_l2/8 + m_l3/4)*cos(q2)";
    let b22 = "I_l2+I_l4 + I_m2+I_m3+I_m4 + m_l2/16 + m_l3/4";
    let (b13, b14) = ("-50*I_m3", "-I_l4 - 20*I_m4");
    let (b33, b44) = ("m_l3 + 2500*I_m3", "I_l4 + 400*I_m4");
    // The factor of cos(q2) in b12 is h over sin(q2).
    let h = "(m_l2/8 + m_l3/4)*sin(q2)";
    let (c11, c12, c21) = (format!("-{h}*dq2"), format!("-{h}*(dq1+dq2)"), format!("{h}*dq1"));
    let mut all = common();
    all.extend([
        ("inertia_matrix", matrix([[b11, b12, b13, b14], [b12, b22, b13, b14], [b13, b13, b33, "0"], [b14, b14, "0", b44]])),
        ("coriolis_matrix", matrix([[&c11, &c12, "0", "0"], [&c21, "0", "0", "0"], ["0", "0", "0", "0"], ["0", "0", "0", "0"]])),
        ("gravity", matrix([["0"], ["0"], ["-9.81*m_l3"], ["0"]])),
        ("friction", matrix([["F_m1*dq1"], ["F_m2*dq2"], ["2500*F_m3*dq3"], ["400*F_m4*dq4"]])),
    ]);
    all
}

/// J̇ q̇ of the task rows x, y, z, rz.
pub fn jacobian_dot_times_rates() -> Formulas {
    matrix([["-(dq1^2*cos(q1) + (dq1+dq2)^2*cos(q1+q2))/2"], ["-(dq1^2*sin(q1) + (dq1+dq2)^2*sin(q1+q2))/2"], ["0"], ["0"]])
}

/// Potential energy up to a constant.
pub const POTENTIAL_ENERGY: &str = "m_l3*9.81*(1/2 - q3)";

/// The parameters as exact numbers.
pub fn nominal_names() -> Names {
    PARAMETERS.iter().map(|(name, text)| ((*name).to_owned(), Exact::read(text).expect("a decimal"))).collect()
}

/// Formulas read with some names replaced.
///
/// Panics on a fault: the formulas are ours.
pub fn read(formulas: &Formulas, names: &Names) -> ExactMatrix {
    let entry = |text: &String| Exact::read_with(text, names).unwrap_or_else(|error| panic!("{error}"));
    formulas.iter().map(|row| row.iter().map(entry).collect()).collect()
}

fn column(prefix: &str) -> ExactMatrix {
    (1..=4).map(|i| vec![Exact::read(&format!("{prefix}{i}")).expect("a name")]).collect()
}

fn sum(matrices: &[ExactMatrix]) -> ExactMatrix {
    let mut total = matrices[0].clone();
    for matrix in &matrices[1..] {
        for (row, other) in total.iter_mut().zip(matrix) {
            for (x, y) in row.iter_mut().zip(other) {
                *x = &*x + y;
            }
        }
    }
    total
}

/// What follows from B, C, g and friction: inverse dynamics and kinetic energy.
fn composed(forms: &BTreeMap<&'static str, Formulas>) -> [(&'static str, ExactMatrix); 2] {
    let part = |name: &str| read(&forms[name], &Names::new());
    let (b, dq) = (part("inertia_matrix"), column("dq"));
    let inverse_dynamics =
        sum(&[product(&b, &column("ddq")), product(&part("coriolis_matrix"), &dq), part("gravity"), part("friction")]);
    let transposed = vec![dq.iter().map(|row| row[0].clone()).collect()];
    let half = vec![vec![Exact::read("1/2").expect("a number")]];
    [("inverse_dynamics", inverse_dynamics), ("kinetic_energy", product(&half, &product(&transposed, &product(&b, &dq))))]
}

/// Which of the two readings of the SCARA is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// Numbers.
    Nominal,
    /// Names of parameters.
    Symbolic,
}

/// Compares what `show` prints of the SCARA with every closed form, exactly; then at the check state, to 1e-12.
///
/// Errors: everything that is missing or differs.
pub fn compare(json: &Value, reading: Reading) -> Result<(), Vec<String>> {
    let shown = Shown::read(json).map_err(|error| vec![error])?;
    let mut faults = Vec::new();
    if shown.robot != "scara" {
        faults.push(format!("the robot is `{}`, not `scara`", shown.robot));
    }
    let forms = match reading {
        Reading::Nominal => nominal(),
        Reading::Symbolic => symbolic(),
    };
    let mut compare = |result: Result<Vec<String>, String>| match result {
        Ok(more) => faults.extend(more),
        Err(fault) => faults.push(fault),
    };
    for (name, formulas) in &forms {
        compare(differences(&shown, name, &read(formulas, &Names::new())));
    }
    for (name, expected) in composed(&forms) {
        compare(differences(&shown, name, &expected));
    }
    compare(drift(&shown));
    compare(potential(&shown, reading));
    compare(singularity(&shown));
    if reading == Reading::Symbolic {
        for (name, formulas) in loaded() {
            let names = Names::from([("m_l3".to_owned(), Exact::integer(15))]);
            if name != "friction" {
                compare(load(&shown, name, &read(&formulas, &Names::new()), names));
            }
        }
    }
    compare(at_check_state(&shown, reading));
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

fn entries_differ(name: &str, found: &ExactMatrix, expected: &ExactMatrix) -> Vec<String> {
    let mut faults = Vec::new();
    let shape = |m: &ExactMatrix| (m.len(), m.first().map_or(0, Vec::len));
    if shape(found) != shape(expected) {
        return vec![format!("{name}: the shape is {:?}, not {:?}", shape(found), shape(expected))];
    }
    for (i, (row, expected)) in found.iter().zip(expected).enumerate() {
        for (j, (x, y)) in row.iter().zip(expected).enumerate() {
            if x != y {
                faults.push(format!("{name}[{}][{}] = {x}, not {y}", i + 1, j + 1));
            }
        }
    }
    faults
}

fn differences(shown: &Shown, name: &str, expected: &ExactMatrix) -> Result<Vec<String>, String> {
    Ok(entries_differ(name, &shown.get(name)?.exact(&Names::new())?, expected))
}

fn load(shown: &Shown, name: &str, expected: &ExactMatrix, load: Names) -> Result<Vec<String>, String> {
    let mut names = nominal_names();
    names.extend(load);
    Ok(entries_differ(&format!("{name} with load"), &shown.get(name)?.exact(&names)?, expected))
}

/// J̇ q̇ of the task rows from the J̇ shown.
fn drift(shown: &Shown) -> Result<Vec<String>, String> {
    let j_dot = shown.get("geometric_jacobian_dot")?.exact(&Names::new())?;
    if j_dot.len() != 6 || j_dot.iter().any(|row| row.len() != 4) {
        return Err("geometric_jacobian_dot is not 6 x 4".to_owned());
    }
    let task = [0, 1, 2, 5].map(|row| j_dot[row].clone()).to_vec();
    let expected = read(&jacobian_dot_times_rates(), &Names::new());
    Ok(entries_differ("geometric_jacobian_dot * dq", &product(&task, &column("dq")), &expected))
}

/// The potential energy up to a constant: its zero is arbitrary.
fn potential(shown: &Shown, reading: Reading) -> Result<Vec<String>, String> {
    let names = if reading == Reading::Nominal { nominal_names() } else { Names::new() };
    let expected = Exact::read_with(POTENTIAL_ENERGY, &names)?;
    let found = shown.get("potential_energy")?.exact(&Names::new())?;
    let [row] = &found[..] else { return Err("potential_energy is not 1 x 1".to_owned()) };
    let [found] = &row[..] else { return Err("potential_energy is not 1 x 1".to_owned()) };
    let left: Vec<String> = (found - &expected).names().into_iter().filter(|name| name.starts_with('q')).collect();
    Ok(if left.is_empty() { vec![] } else { vec![format!("potential_energy = {found}, not {expected} and a constant")] })
}

/// The product of the factors is the determinant up to a constant; it vanishes only at multiples of pi of q2.
fn singularity(shown: &Shown) -> Result<Vec<String>, String> {
    let determinant = shown.get("determinant")?;
    let mut faults = Vec::new();
    let factors = determinant.factors.as_ref().ok_or("determinant has no factors")?;
    let mut rest = Exact::read("sin(q2)")?;
    for factor in factors {
        rest = rest.over(&Exact::read(factor)?)?;
    }
    if (1..=4).any(|i| !rest.derivative(&format!("q{i}")).is_zero()) {
        faults.push(format!("the factors {factors:?} do not multiply to sin(q2)"));
    }
    let plain = |text: &String| text.replace('π', "pi").replace([' ', '*'], "");
    let singular = determinant.singular.as_ref().ok_or("determinant has no singular configurations")?;
    if singular.iter().flatten().map(plain).collect::<Vec<_>>() != ["q2=0modpi"] {
        faults.push(format!("singular at {singular:?}, not where q2 = 0 mod pi"));
    }
    Ok(faults)
}

/// A state and what holds there, from the report.
#[derive(Clone, Debug)]
pub struct CheckState {
    /// Joint variables.
    pub q: [f64; 4],
    /// Joint rates.
    pub dq: [f64; 4],
    /// Joint accelerations, and reference accelerations.
    pub ddq: [f64; 4],
    /// Reference rates.
    pub dqr: [f64; 4],
    /// Inverse dynamics of (q, dq, ddq).
    pub tau: [f64; 4],
    /// Y(q, dq, dqr, ddq) pi.
    pub y_pi: [f64; 4],
    /// C dq.
    pub c_dq: [f64; 4],
    /// C dqr.
    pub c_dqr: [f64; 4],
    /// x, y, z, phi.
    pub x_e: [f64; 4],
    /// J̇ q̇, task rows.
    pub j_dot_dq: [f64; 4],
    /// Forward dynamics at (q, dq) for tau = 0, with the load.
    pub ddq_loaded: [f64; 4],
}

/// The check state of the report.
pub fn check_state() -> CheckState {
    CheckState {
        q: [0.3, 1.1, 0.2, 0.4],
        dq: [0.5, -0.7, 0.3, 1.0],
        ddq: [1.0, 2.0, -1.0, 0.5],
        dqr: [0.4, -0.6, 0.25, 0.9],
        tau: [48.80571515657605, 29.41995480720468, -113.85, -0.36],
        y_pi: [48.58290831656069, 29.197157967189323, -115.1, -0.56],
        c_dq: [0.9357677280645073, 1.1140092000767943, 0.0, 0.0],
        c_dqr: [0.7129658880491484, 0.8912073600614354, 0.0, 0.0],
        x_e: [0.5626518160129234, 0.6404849683248999, 0.3, 1.0],
        j_dot_dq: [-0.12281640399870557, -0.056649020432436636, 0.0, 0.0],
        ddq_loaded: [0.05371154081148763, -0.24057622390045058, 5.076483048335555, -1.5647156976791017],
    }
}

fn at_check_state(shown: &Shown, reading: Reading) -> Result<Vec<String>, String> {
    let state = check_state();
    let mut names = state_names(&[
        ("q", &state.q),
        ("dq", &state.dq),
        ("ddq", &state.ddq),
        ("dqr", &state.dqr),
        ("ddqr", &state.ddq),
        ("tau", &[0.0; 4]),
    ]);
    let pi: Vec<f64> = PARAMETERS.iter().map(|(_, text)| text.parse().expect("a decimal")).collect();
    names.extend(PARAMETERS.iter().zip(&pi).map(|((name, _), x)| ((*name).to_owned(), *x)));
    let value = |name: &str, names: &BTreeMap<String, f64>| shown.get(name).and_then(|quantity: &Quantity| quantity.value(names));
    let vector = |m: Vec<Vec<f64>>| m.concat();
    let task = |m: Vec<f64>| if m.len() == 6 { vec![m[0], m[1], m[2], m[5]] } else { m };

    let mut faults = Vec::new();
    let mut check = |what: &str, found: &[f64], given: &[f64]| {
        let deviation = deviation(found, given);
        if deviation > CHECK_STATE {
            faults.push(format!("{what} at the check state: {found:?}, not {given:?}"));
        }
    };
    check("tau", &vector(value("inverse_dynamics", &names)?), &state.tau);
    check("Y pi", &times(&value("regressor", &names)?, &pi), &state.y_pi);
    let c = value("coriolis_matrix", &names)?;
    check("C dq", &times(&c, &state.dq), &state.c_dq);
    check("C dqr", &times(&c, &state.dqr), &state.c_dqr);
    let t = value("direct_kinematics", &names)?;
    if t.len() == 4 && t.iter().all(|row| row.len() == 4) {
        check("x_e", &[t[0][3], t[1][3], t[2][3], t[1][1].atan2(t[0][1])], &state.x_e);
    }
    check("J̇q̇", &task(times(&value("geometric_jacobian_dot", &names)?, &state.dq)), &state.j_dot_dq);
    if reading == Reading::Symbolic {
        names.insert("m_l3".to_owned(), 15.0);
        check("forward dynamics with load", &vector(value("forward_dynamics", &names)?), &state.ddq_loaded);
    } else {
        // Without load the oracle's model of the data sheet gives the expected value.
        let model = crate::oracle::Description::read(ROBOT)?.model()?;
        let expected = model.forward_dynamics(&state.q, &state.dq, &[0.0; 4]).ok_or("singular")?;
        check("forward dynamics", &vector(value("forward_dynamics", &names)?), &expected);
    }
    Ok(faults)
}
