//! Tries the three ways to use a robot in another project: a copied file, the crate `armgen-generated`, and a build script. Also
//! checks when a build script runs. The snippets of docs/rust.md are compiled as printed.

use std::path::Path;

use armgen_codegen::kinds::Scalar;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_tests::emitted::emitted;
use armgen_tests::oracle::Description;
use armgen_tests::precision::{agree, CHECK_STATE, ORACLE, SINGLE};
use armgen_tests::project::{modified, workspace, Project};
use armgen_tests::{reference, technical_project};

/// Folders of the projects. They share a target folder, so cargo builds one at a time.
fn stranger(name: &str) -> Project {
    Project::new(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("strangers"), name)
}

fn manifest(name: &str, edition: &str, rest: &str) -> String {
    format!("[package]\nname = \"{name}\"\nversion = \"1.0.0\"\nedition = \"{edition}\"\n\n{rest}\n[workspace]\n")
}

/// A dependency on a package of this workspace.
fn path_of(folder: &str) -> String {
    format!("path = {:?}", workspace().join(folder).display().to_string())
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap_or_else(|_| panic!("not a number in {text:?}"))).collect()
}

fn generate(text: &str, scalar: Scalar) -> String {
    let (generated, _) = armgen_codegen::generate(&Source::new("robot.yaml", text), &Options { scalar, ..Options::default() });
    generated.expect("a valid description").module
}

/// Copied into an empty crate with libm alone: as `mod robot;`, inside `include!`, f64 and f32 side by side, with warnings denied.
#[test]
#[ignore = "wide"]
fn a_copied_file_compiles_alone() {
    let state = technical_project::check_state();
    for edition in ["2021", "2024"] {
        let project = stranger(&format!("copied{edition}"));
        project.write("Cargo.toml", &manifest(&format!("copied{edition}"), edition, "[dependencies]\nlibm = \"0.2\"\n"));
        project.write("src/robot.rs", emitted("scara").text);
        project.write("src/narrow/robot.rs", emitted("scara_f32").text);
        project.write("src/wide.rs", emitted("puma560").text);
        project.write(
            "src/lib.rs",
            "#![no_std]
#![deny(warnings)]
#![forbid(unsafe_code)]
mod robot;
mod narrow {
    pub mod robot;
}
/// Another arm, inside `include!`.
pub mod wide {
    include!(\"wide.rs\");
}
/// The torques of both scalars.
pub fn torques(q: [f64; 4], dq: [f64; 4], ddq: [f64; 4]) -> ([f64; 4], [f32; 4]) {
    let single = |v: [f64; 4]| v.map(|x| x as f32);
    (robot::inverse_dynamics(&q, &dq, &ddq), narrow::robot::inverse_dynamics(&single(q), &single(dq), &single(ddq)))
}
",
        );
        let State { q, dq, ddq } = State { q: state.q, dq: state.dq, ddq: state.ddq };
        project.write(
            "src/main.rs",
            &format!(
                "#![deny(warnings)]
fn main() {{
    let (wide, narrow) = copied{edition}::torques({q:?}, {dq:?}, {ddq:?});
    for x in wide.into_iter().chain(narrow.map(f64::from)) {{
        println!(\"{{x:?}}\");
    }}
}}
"
            ),
        );
        let found = numbers(&project.succeed(&["run", "--quiet"]));
        agree("f64", &found[..4], &state.tau, CHECK_STATE);
        agree("f32", &found[4..], &state.tau, SINGLE);
        // libm and nothing else.
        assert_eq!(project.read("Cargo.lock").matches("[[package]]").count(), 2, "{}", project.read("Cargo.lock"));
    }
}

/// A state as it is printed into a program.
struct State {
    q: [f64; 4],
    dq: [f64; 4],
    ddq: [f64; 4],
}

/// A project that depends on `armgen-generated`, with any robot in robot.yaml, without and with the runtime's traits.
#[test]
#[ignore = "wide"]
fn the_generated_crate_is_a_dependency() {
    let project = stranger("depends");
    let dependencies = format!(
        "[features]\nruntime = [\"armgen-generated/runtime\", \"dep:armgen-runtime\"]\n\n[dependencies]\n\
         armgen-generated = {{ {} }}\narmgen-runtime = {{ {}, optional = true }}\n",
        path_of("generated"),
        path_of("runtime")
    );
    project.write("Cargo.toml", &manifest("depends", "2021", &dependencies));
    project.write(
        "src/lib.rs",
        "#![no_std]
#![deny(warnings)]
use armgen_generated::{DOF, Real};

/// The torque that holds the arm where every joint variable is q.
pub fn hold(q: Real) -> [Real; DOF] {
    armgen_generated::gravity(&[q; DOF])
}

/// The same through the traits.
#[cfg(feature = \"runtime\")]
pub fn hold_by_traits(q: Real) -> [Real; DOF] {
    use armgen_runtime::{nalgebra::SVector, robot::Dynamics};
    armgen_generated::Nominal.gravity(&SVector::from([q; DOF])).into()
}
",
    );
    project.write(
        "src/main.rs",
        "fn main() {
    let mut all = depends::hold(0.3).to_vec();
    #[cfg(feature = \"runtime\")]
    all.extend(depends::hold_by_traits(0.3));
    all.iter().for_each(|x| println!(\"{x:?}\"));
}
",
    );
    let text = std::fs::read_to_string(workspace().join("robot.yaml")).expect("robot.yaml");
    let model = Description::read(&text).and_then(|d| d.model()).expect("valid");
    let expected = model.gravity(&vec![0.3; model.dof()]);
    agree("g", &numbers(&project.succeed(&["run", "--quiet"])), &expected, ORACLE);
    let twice = [expected.clone(), expected].concat();
    agree("g, g by the traits", &numbers(&project.succeed(&["run", "--quiet", "--features", "runtime"])), &twice, ORACLE);
}

/// A project with a robot.yaml and a build script of its own, in two scalars.
#[test]
#[ignore = "wide"]
fn a_build_script_generates_its_own_robot() {
    let project = stranger("generates");
    let dependencies = format!(
        "[dependencies]\narmgen-runtime = {{ {} }}\nlibm = \"0.2\"\n\n[build-dependencies]\narmgen-codegen = {{ {} }}\n",
        path_of("runtime"),
        path_of("codegen")
    );
    project.write("Cargo.toml", &manifest("generates", "2021", &dependencies));
    project.write("arm.yaml", &reference::description("scara"));
    project.write(
        "build.rs",
        "use armgen_codegen::build_script::{Robot, Scalar};

fn main() {
    Robot::new(\"arm.yaml\").generate();
    Robot::new(\"arm.yaml\").scalar(Scalar::F32).file_stem(\"arm_f32\").generate();
}
",
    );
    project.write(
        "src/main.rs",
        "#![deny(warnings)]
mod arm {
    include!(concat!(env!(\"OUT_DIR\"), \"/arm.rs\"));
    include!(concat!(env!(\"OUT_DIR\"), \"/arm_runtime.rs\"));
}
mod narrow {
    include!(concat!(env!(\"OUT_DIR\"), \"/arm_f32.rs\"));
}

use armgen_runtime::{nalgebra::SVector, robot::Dynamics};

fn main() {
    let q = [0.3, 1.1, 0.2, 0.4];
    let loaded = arm::WithParameters { parameters: arm::NOMINAL_PARAMETERS.map(|x| 2.0 * x) };
    let g = loaded.gravity(&SVector::from(q));
    g.iter().for_each(|x| println!(\"{x:?}\"));
    narrow::gravity(&q.map(|x| x as f32)).iter().for_each(|x| println!(\"{x:?}\"));
}
",
    );
    let found = numbers(&project.succeed(&["run", "--quiet"]));
    agree("g", &found, &[0.0, 0.0, -2.0 * 98.1, 0.0, 0.0, 0.0, -98.1, 0.0], SINGLE);
    assert_eq!(project.succeed(&["tree", "--edges", "normal", "--prefix", "none"]).matches("armgen-codegen").count(), 0);
}

/// The crate `generated` with its robot.yaml in a workspace of its own: when its build script runs, and the error of a wrong file.
#[test]
#[ignore = "wide"]
fn the_robot_follows_its_file_and_nothing_else() {
    let project = stranger("workspace");
    let own = std::fs::read_to_string(workspace().join("Cargo.toml")).expect("the manifest");
    let manifest: String = own
        .lines()
        .take_while(|line| !line.starts_with("[profile"))
        .map(|line| match line {
            _ if line.starts_with("members") => "members = [\"generated\"]\n".to_owned(),
            _ if line.starts_with("default-members") => String::new(),
            _ if line.starts_with("armgen-algebra") => format!("armgen-algebra = {{ {} }}\n", path_of("algebra")),
            _ if line.starts_with("armgen-codegen") => format!("armgen-codegen = {{ {} }}\n", path_of("codegen")),
            _ if line.starts_with("armgen-runtime") => format!("armgen-runtime = {{ {} }}\n", path_of("runtime")),
            _ => format!("{line}\n"),
        })
        .collect();
    project.write("Cargo.toml", &manifest);
    for file in ["Cargo.toml", "build.rs", "src/lib.rs"] {
        project
            .write(&format!("generated/{file}"), &std::fs::read_to_string(workspace().join("generated").join(file)).expect(file));
    }
    let scara = reference::description("scara");
    project.write("robot.yaml", &scara);
    // As a checkout without links has it.
    project.write("generated/robot.yaml", "../robot.yaml");
    project.write("notes.md", "Nothing.\n");
    let build = || project.built(&["--package", "armgen-generated"]).join("robot.rs");
    let text = |path: &Path| std::fs::read_to_string(path).expect("the emitted module");

    let path = build();
    assert!(text(&path) == generate(&scara, Scalar::F64), "the emitted module is not that of robot.yaml");
    let first = modified(&path);

    // Other files do not count, not even sources of the crate.
    project.write("notes.md", "Something.\n");
    project.write("generated/notes.md", "Something.\n");
    project.write("generated/src/lib.rs", &(project.read("generated/src/lib.rs") + "\n// Something.\n"));
    assert_eq!(modified(&build()), first, "the generator ran without reason");

    // The description counts.
    let edited = scara.replace("m_l3: 10 ", "m_l3: 15 ");
    assert_ne!(edited, scara);
    project.write("robot.yaml", &edited);
    let path = build();
    assert!(modified(&path) > first, "the generator did not run");
    assert!(text(&path) == generate(&edited, Scalar::F64), "the emitted module is not that of the edited robot.yaml");

    // A wrong description fails the build and gives the place: line and column of the value, and the line itself.
    let wrong = scara.replace("    a: 0.5 ", "    a: half ");
    let line = wrong.lines().position(|line| line.contains("half")).expect("the fault") + 1;
    project.write("robot.yaml", &wrong);
    let message = project.fail(&["build", "--package", "armgen-generated"]);
    for part in [format!("robot.yaml:{line}:8"), "half".to_owned(), "help".to_owned()] {
        assert!(message.contains(&part), "`{part}` is missing in\n{message}");
    }

    // Any arm will do.
    let other = reference::description("panda7");
    project.write("robot.yaml", &other);
    let path = project.built(&["--package", "armgen-generated", "--features", "runtime"]).join("robot.rs");
    assert!(text(&path).contains("pub const DOF: usize = 7;"));
}

/// The snippets of a section of docs/rust.md, which begins with a word in bold: names of files and their texts.
fn snippets(section: &str) -> Vec<(String, String)> {
    let page = std::fs::read_to_string(workspace().join("docs/rust.md")).expect("docs/rust.md");
    let rest = page.split(&format!("**{section}")).nth(1).unwrap_or_else(|| panic!("docs/rust.md has no **{section}"));
    let rest = rest.split("\n**").next().and_then(|text| text.split("\n## ").next()).expect("text");
    let blocks = rest.split("```").skip(1).step_by(2);
    let files: Vec<_> = blocks
        .map(|block| {
            let text = block.split_once('\n').expect("a language").1;
            let name = text.lines().next().expect("a line").trim_start_matches(['#', '/', ' ']);
            (name.to_owned(), text.replace("../armgen", &workspace().display().to_string()))
        })
        .collect();
    assert!(files.iter().any(|(name, _)| name == "src/main.rs"), "{section}: {files:?}");
    files
}

/// The output of the program in a section of docs/rust.md, with files added.
fn follow_the_page(section: &str, name: &str, more: &[(&str, &str)]) -> Vec<f64> {
    let project = stranger(name);
    for (file, text) in snippets(section) {
        let text = if file == "Cargo.toml" { manifest(name, "2021", &text) } else { text };
        project.write(&file, &text);
    }
    more.iter().for_each(|(file, text)| project.write(file, text));
    let printed = project.succeed(&["run", "--quiet"]);
    numbers(&printed.replace(['[', ']', ','], " "))
}

#[test]
#[ignore = "wide"]
fn the_snippets_of_the_readme_do_what_they_say() {
    let gravity = |text: &str| {
        let model = Description::read(text).and_then(|d| d.model()).expect("valid");
        model.gravity(&vec![0.3; model.dof()])
    };
    let puma = reference::description("puma560");
    let copied = follow_the_page("Copy the file", "page_copy", &[("src/robot.rs", emitted("puma560").text)]);
    agree("copied", &copied, &gravity(&puma), ORACLE);
    let own = follow_the_page("Generate in your own build", "page_build", &[("robot.yaml", &puma)]);
    agree("own build", &own, &gravity(&puma), ORACLE);
    let robot = std::fs::read_to_string(workspace().join("robot.yaml")).expect("robot.yaml");
    let depends = follow_the_page("Depend on `generated`", "page_depend", &[]);
    agree("depends", &depends, &gravity(&robot), ORACLE);
    // e = 0.1 (1 + 10 t) exp(-10 t), 4e-9 after two seconds.
    let controlled = follow_the_page("Control it", "page_control", &[]);
    agree("controlled", &controlled, &vec![0.4; depends.len()], 1e-6);
}
