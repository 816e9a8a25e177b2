//! Arms, and their values in floats.

use std::path::{Path, PathBuf};

use armgen_codegen::diagnostic::Colour;
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Manipulator, Placement};
use armgen_codegen::source::Source;
use armgen_codegen::validate;

/// Every writing of a rotation, attached bodies with and without names, names that collide, characters that XML escapes.
const POSES: &str = "\
name: poses
convention: urdf
gravity: [0, 0, -9.81]
parameters: {m: 3/4, l: sqrt(2)/10}
base: [{xyz: [0, 0, l]}, {quat: [0.3, -0.1, 0.2, 1]}]
joints:
  - name: base
    type: revolute
    origin: [{axis: [1, 2, 2], angle: 0.3}, {xyz: [1e-3, 0, 0], rpy: [pi/2, 0, -5*pi/12]}, {rpy: [0, deg(30), 0]}]
    axis: [1, -1, 0]
    limits: {position: [-pi, 2.5], effort: 12}
    link:
      mass: m
      com: [0.1, l, 0]
      inertia: {xx: 0.1, yy: 0.2, zz: 0.15, xy: 0.01, quat: [1, 2, 3, 4]}
      attached:
        - {name: \"tool\", mass: 1, com: [0, 0, 1/3]}
        - {origin: [{xyz: [0, 0, 1]}, {rpy: [0, 0, 1]}, {xyz: [1, 0, 0]}], mass: 2, inertia: {xx: 1, yy: 1, zz: 1, axis: [0, 0, 1], angle: 1}}
        - {name: \"<a & b>\", origin: {xyaxes: [0, 1, 0, 0, 0, 1]}, mass: 0.5}
    friction: {viscous: 1/8, coulomb: 1/2, smooth: 0.05}
  - name: slide
    type: prismatic
    axis: [0.6, 0, 0.8]
    friction: {coulomb: 2, offset: -1/4, cubic: 1e-3, load: 1/40, stribeck: {torque: 0.5, velocity: 0.1}}
    spring: {stiffness: 40, rest: -0.1}
    link: {mass: 0, attached: [{mass: 2, inertia: {xx: 1, yy: 1, zz: 1}}]}
tool: [{xyz: [0, 0, 0.1]}, {rpy: [0, 1, 0]}]
";

/// Names and texts of the descriptions of the project, and of one more.
pub(crate) fn arms() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files: Vec<PathBuf> = ["robots", "tests/robots"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(root.join(folder)).expect("the folder"))
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "yaml"))
        .collect();
    files.sort();
    let text = |path: &PathBuf| (path.display().to_string(), std::fs::read_to_string(path).expect("a readable file"));
    files.iter().map(text).chain([("poses".to_owned(), POSES.to_owned())]).collect()
}

/// The arm of a description.
#[track_caller]
pub(crate) fn valid(yaml: &str) -> Manipulator {
    let source = Source::new("robot.yaml", yaml);
    let (arm, diagnostics) = validate::read(&source);
    arm.unwrap_or_else(|| panic!("{}\n{yaml}", diagnostics.render(&source, Colour::Never))).0
}

type Matrix = [[f64; 4]; 4];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn matrix(arm: &Manipulator, frame: &Placement) -> Matrix {
    let length = |k: usize| frame.translation[k].evaluate(&|id| arm.parameters[id.0 as usize].nominal.clone()).to_f64();
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match (i, j) {
            (3, j) => f64::from(j == 3),
            (i, 3) => length(i),
            (i, j) => frame.rotation[i][j].to_f64(),
        })
    })
}

/// The end effector's frame, of each rotor its first moment and axis, of each joint its friction, armature and spring, and of each link
/// mass, first and second moments in the base frame, where q is 0.3, -0.7, 1.1, ...
pub(crate) fn state(arm: &Manipulator) -> [Vec<f64>; 2] {
    let mut frame: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    let (mut values, mut rotors) = (Vec::new(), Vec::new());
    let number = |x: &armgen_codegen::exact::Polynomial| x.evaluate(&|id| arm.parameters[id.0 as usize].nominal.clone()).to_f64();
    for (k, joint) in arm.joints.iter().enumerate() {
        if let Some(motor) = &joint.motor {
            let p = motor.position.each_ref().map(number);
            let u = motor.axis.each_ref().map(|x| x.to_f64());
            let turned = |v: &[f64; 3], i: usize| (0..3).map(|k| frame[i][k] * v[k]).sum::<f64>();
            let mass = number(&motor.mass);
            rotors.extend((0..3).map(|i| mass * (frame[i][3] + turned(&p, i))));
            rotors.extend((0..3).map(|i| turned(&u, i)));
        }
        let passive = [&joint.viscous, &joint.coulomb, &joint.offset, &joint.cubic, &joint.armature];
        rotors.extend(passive.map(|value| value.as_ref().map_or(0.0, number)));
        rotors.extend(joint.load.iter().map(|load| load.to_f64()));
        rotors.extend(joint.smooth.iter().map(|smooth| smooth.to_f64()));
        rotors.extend(joint.stribeck.iter().flat_map(|stribeck| [number(&stribeck.torque), stribeck.velocity.to_f64()]));
        rotors.extend(joint.spring.iter().flat_map(|spring| [number(&spring.stiffness), number(&spring.rest)]));
        let q = [0.3, -0.7, 1.1, 0.4][k % 4];
        let u = joint.row.axis.each_ref().map(|x| x.to_f64());
        let (s, c) = if joint.kind == JointKind::Revolute { f64::sin_cos(q) } else { (0.0, 1.0) };
        let motion: Matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j| match (i, j) {
                (3, j) => f64::from(j == 3),
                (i, 3) => {
                    if joint.kind == JointKind::Prismatic {
                        q * u[i]
                    } else {
                        0.0
                    }
                }
                (i, j) => {
                    let spin = if i == j {
                        c
                    } else if (i + 1) % 3 == j {
                        -s * u[3 - i - j]
                    } else {
                        s * u[3 - i - j]
                    };
                    (1.0 - c) * u[i] * u[j] + spin
                }
            })
        });
        for part in [matrix(arm, &joint.row.before.frame), motion, matrix(arm, &joint.row.after.frame)] {
            frame = product(&frame, &part);
        }
        let mut sums = [0.0; 10];
        for part in &joint.link {
            let (m, com) = (number(&part.body.mass), part.body.com.each_ref().map(number));
            let [xx, xy, yy, xz, yz, zz] = part.body.inertia.each_ref().map(number);
            let tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            let p: [f64; 3] = std::array::from_fn(|i| frame[i][3] + (0..3).map(|k| frame[i][k] * com[k]).sum::<f64>());
            let turned = |i: usize, j: usize| -> f64 {
                (0..3).flat_map(|a| (0..3).map(move |b| (a, b))).map(|(a, b)| frame[i][a] * tensor[a][b] * frame[j][b]).sum()
            };
            let square: f64 = p.iter().map(|x| x * x).sum();
            sums[0] += m;
            (0..3).for_each(|i| sums[1 + i] += m * p[i]);
            for (at, (i, j)) in [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)].into_iter().enumerate() {
                sums[4 + at] += turned(i, j) + m * (if i == j { square } else { 0.0 } - p[i] * p[j]);
            }
        }
        values.extend(sums);
    }
    frame = product(&frame, &matrix(arm, &arm.tool.frame));
    values.extend(frame.iter().flatten());
    [values, rotors]
}

/// Demands that two arms are the same in floats.
#[track_caller]
pub(crate) fn assert_same(name: &str, before: &Manipulator, after: &Manipulator) {
    assert_near(name, &state(before)[0], &state(after)[0]);
}

/// Demands that the rotors, the friction and the springs of two arms are the same in floats.
#[allow(dead_code, reason = "a URDF has none")]
#[track_caller]
pub(crate) fn assert_same_joints(name: &str, before: &Manipulator, after: &Manipulator) {
    assert_near(name, &state(before)[1], &state(after)[1]);
}

#[track_caller]
fn assert_near(name: &str, before: &[f64], after: &[f64]) {
    assert_eq!(before.len(), after.len(), "{name}");
    let size = before.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
    for (k, (a, b)) in before.iter().zip(after).enumerate() {
        assert!((a - b).abs() <= 4e-15 * size, "{name}, value {k}: {a} and {b}");
    }
}
