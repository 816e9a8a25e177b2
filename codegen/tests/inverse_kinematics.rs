//! Emitted inverse kinematics, compiled in a project of its own and judged there: every robot that has a class, and reference poses.

#[path = "inverse_kinematics/arms.rs"]
mod arms;
#[path = "inverse_kinematics/in_c.rs"]
mod in_c;

use std::path::Path;
use std::process::Command;

use armgen_codegen::inverse_kinematics::InverseKinematics;
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Scalar};
use arms::{description, generated, made_up, robots, workspace, P, R};

fn classified(name: &str, text: &str) -> Result<InverseKinematics, String> {
    let (valid, diagnostics) = validate::read(&Source::new(name, text));
    let (manipulator, _) = valid.unwrap_or_else(|| panic!("{name}: {diagnostics:?}"));
    armgen_codegen::inverse_kinematics::of(&manipulator)
}

#[test]
fn classes_of_robots() {
    let class = |name: &str| {
        let (_, text) = robots().into_iter().find(|(robot, _)| robot == name).expect("a robot");
        classified(name, &text).map(|found| (found.class, found.most))
    };
    let of = |class: &str, most: usize| Ok((class.to_owned(), most));
    assert_eq!(class("puma560"), of("spherical triple (axes 4 5 6 through one point), axes 2 and 3 are parallel", 8));
    assert_eq!(class("ur5"), of("three parallel axes (joints 2 3 4), axes 5 and 6 intersect or are parallel", 8));
    assert_eq!(class("scara4"), of("all revolute axes parallel (joints 1 2 4)", 2));
    assert_eq!(class("scara"), of("all revolute axes parallel (joints 1 2 4)", 2));
    assert_eq!(class("panda7"), of("spherical triple (axes 1 2 3 through one point), axes 6 and 5 intersect; q7 is given", 8));
    assert!(class("base_set").is_err() && class("single_joint").is_err());
    for (name, class, most, text) in made_up() {
        let found = classified(name, &text).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        assert!(found.class.starts_with(class) && found.most == most, "{name}: {} {}", found.class, found.most);
        // The steps name every joint of the arm, and no other but a virtual one.
        let (shown, joints) = (found.text(), text.matches("type: ").count());
        println!("{shown}");
        assert!((1..=joints).all(|joint| shown.contains(&joint.to_string())), "{shown}");
        assert!(!shown.contains(&format!("q{}", joints + 2)), "{shown}");
    }
}

/// Slides that stay parallel move the end effector along one line: no posture stands alone.
#[test]
fn parallel_slides_have_no_construction() {
    let rows = |alpha| {
        [
            (P, "0.1", alpha, "0.2", "0.3"),
            (P, "0.1", "pi/2", "0.1", "0"),
            (R, "0.3", "1.1", "0.2", "0"),
            (R, "0.1", "pi/2", "0.1", "0.3"),
            (R, "0.05", "-pi/2", "0.35", "0"),
            (R, "0.02", "0", "0.1", "0"),
        ]
    };
    let class = |alpha| classified("slides", &description("slides", "", &rows(alpha)));
    assert!(class("0.01").expect("a class").class.starts_with("two prismatic joints (joints 1 2)"));
    let refused = class("0").expect_err("no class");
    assert!(refused.contains("6 joints, 2 of them prismatic, of this geometry"), "{refused}");
}

/// 1e-9 is not 0: an arm with a wrist whose axes miss by that much is a general one.
#[test]
fn nearly_zero_is_not_zero() {
    let puma = |a4: &str| {
        let rows = [
            (R, "0", "pi/2", "0.67183", "0"),
            (R, "0.4318", "0", "0", "0"),
            (R, "0.0203", "-pi/2", "0.15005", "0"),
            (R, a4, "pi/2", "0.4318", "0"),
            (R, "0", "-pi/2", "0", "0"),
            (R, "0", "0", "0", "0"),
        ];
        classified("puma", &description("puma", "", &rows)).expect("a class").class
    };
    assert!(puma("0").starts_with("spherical triple"));
    assert!(puma("1e-9").starts_with("general"), "{}", puma("1e-9"));
    // Other ways to write 0: one that reduction sees, and one that it does not.
    assert!(puma("sqrt(2)*sqrt(3) - sqrt(6)").starts_with("spherical triple"));
    let nested = puma("sqrt(3 - 2*sqrt(2)) + 1 - sqrt(2)");
    assert!(nested.starts_with("spherical triple"), "{nested}");
}

/// Compiles what is emitted and runs the judge: it asks every module for the postures of thousands of poses.
#[test]
fn emitted_modules_find_every_posture() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("inverse_kinematics");
    let write = |path: &str, text: &str| {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder can be made");
        std::fs::write(&path, text).expect("a file can be written");
    };
    write("Cargo.lock", &std::fs::read_to_string(workspace().join("Cargo.lock")).expect("the lock file"));
    write(
        "Cargo.toml",
        "[package]\nname = \"judge\"\nversion = \"1.0.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n\n\
         [profile.dev]\nopt-level = 1\ndebug = false\nincremental = false\n",
    );
    let mut main = include_str!("inverse_kinematics/judge.rs").to_owned();
    let mut checks = String::new();
    let mut all = robots();
    all.extend(made_up().into_iter().map(|(name, _, _, text)| (name.to_owned(), text)));
    for (name, text) in all {
        let narrow = ["puma560", "scara4", "parallel", "general"].contains(&name.as_str());
        for (scalar, suffix) in [(Scalar::F64, ""), (Scalar::F32, "_f32")].into_iter().take(1 + usize::from(narrow)) {
            let generated = generated(&name, &text, scalar);
            let ik = generated.inverse_kinematics();
            if !ik.contains("pub fn inverse_kinematics") {
                assert!(ik.contains("// There is no `inverse_kinematics`: "), "{name}");
                continue;
            }
            let module = format!("{name}{suffix}");
            write(&format!("src/{module}.rs"), &generated.module);
            write(&format!("src/{module}_ik.rs"), &ik);
            main += &format!("#[allow(dead_code)]\nmod {module};\nmod {module}_ik;\n");
            let columns = if ik.contains("the position alone is read") { "3.." } else { "0.." };
            let solve = if ik.contains("redundancy: Real") {
                format!("|t: &_, q| {module}_ik::inverse_kinematics(t, q)")
            } else {
                format!("|t: &_, _| {module}_ik::inverse_kinematics(t)")
            };
            checks += &format!("    check!({module}, {module}_ik, {columns}, {solve});\n");
            let file = workspace().join(format!("inverse-kinematics/tests/data/{name}.txt"));
            if suffix.is_empty() && file.exists() {
                checks += &format!("    reference!({module}, {module}_ik, {:?}, {solve});\n", file.display().to_string());
            }
        }
    }
    main += &format!("\nfn main() {{\n{checks}}}\n");
    write("src/main.rs", &main);
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["run", "--quiet", "--offline"]).current_dir(&folder).env("CARGO_TARGET_DIR", folder.join("target"));
    let output = command.env("RUSTFLAGS", "-D warnings").output().expect("cargo starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    println!("{}", text(&output.stdout));
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
    assert_eq!(text(&output.stdout).matches("reference poses").count(), 5, "{}", text(&output.stdout));
}
