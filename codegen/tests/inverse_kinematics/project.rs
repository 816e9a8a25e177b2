//! A project with emitted modules and the judge, compiled and run.

use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::{Generated, Scalar};

use super::arms::{generated, workspace};

/// The project in a folder of its own.
pub(crate) struct Project {
    folder: PathBuf,
    main: String,
    checks: String,
}

impl Project {
    pub(crate) fn new(name: &str) -> Project {
        let project = Project {
            folder: Path::new(env!("CARGO_TARGET_TMPDIR")).join(name),
            main: format!(
                "#![allow(unused_macros, dead_code)]\n{}",
                concat!(include_str!("judge.rs"), "\n", include_str!("random.rs"))
            ),
            checks: String::new(),
        };
        project.write("Cargo.lock", &std::fs::read_to_string(workspace().join("Cargo.lock")).expect("the lock file"));
        project.write(
            "Cargo.toml",
            "[package]\nname = \"judge\"\nversion = \"1.0.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n\n\
             [profile.dev]\nopt-level = 1\ndebug = false\nincremental = false\n",
        );
        project
    }

    fn write(&self, path: &str, text: &str) {
        let path = self.folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder can be made");
        std::fs::write(&path, text).expect("a file can be written");
    }

    /// A module of an arm with its inverse kinematics, which the judge has to accept.
    pub(crate) fn add(&mut self, name: &str, text: &str, scalar: Scalar) {
        let arm = generated(name, text, scalar);
        let ik = arm.inverse_kinematics();
        if !ik.contains("pub fn inverse_kinematics") {
            assert!(ik.contains("// There is no `inverse_kinematics`: "), "{name}");
            return;
        }
        let module = format!("{name}{}", if scalar == Scalar::F32 { "_f32" } else { "" });
        let (check, solve) = self.modules(&module, &arm, (&ik, ""));
        self.checks += &format!("    {check};\n");
        let file = workspace().join(format!("inverse-kinematics/tests/data/{name}.txt"));
        if scalar == Scalar::F64 && file.exists() {
            self.checks += &format!("    reference!({module}, {module}_ik, {:?}, {solve});\n", file.display().to_string());
        }
    }

    /// The same with an error in the text of the inverse kinematics, which the judge has to see.
    pub(crate) fn add_spoilt(&mut self, module: &str, text: &str, [right, wrong]: [&str; 2]) {
        let arm = generated(module, text, Scalar::F64);
        let ik = arm.inverse_kinematics();
        assert_eq!(ik.matches(right).count(), 1, "{module}: {right}");
        let (check, _) = self.modules(module, &arm, (&ik.replacen(right, wrong, 1), "#[allow(warnings)]\n"));
        self.checks += &format!(
            "    let seen = std::panic::catch_unwind(|| {check});\n    \
             assert!(seen.is_err(), \"{{}}\", {:?});\n    println!(\"seen: {module}\");\n",
            format!("{module}: {wrong} for {right}")
        );
    }

    /// Both modules, the second with what warnings it may have; how they are judged, and called.
    fn modules(&mut self, module: &str, arm: &Generated, (ik, allowed): (&str, &str)) -> (String, String) {
        self.write(&format!("src/{module}.rs"), &arm.module);
        self.write(&format!("src/{module}_ik.rs"), ik);
        self.main += &format!("#[allow(dead_code)]\nmod {module};\n{allowed}mod {module}_ik;\n");
        let columns = match () {
            () if ik.contains("the position alone is asked for") => "3..",
            () if ik.contains("of which position and z axis are to be reached") => "2..",
            () => "0..",
        };
        let (solve, redundancy) = if ik.contains("redundancy: Real") {
            let solve = format!("|t: &_, r| {module}_ik::inverse_kinematics(t, r)");
            (solve, format!("{module}_ik::inverse_kinematics_redundancy"))
        } else {
            (format!("|t: &_, _| {module}_ik::inverse_kinematics(t)"), "|_: &_| 0.0".to_owned())
        };
        let check = match ik.contains("const ARM: ") {
            true => format!("few!({module}, {module}_ik)"),
            false => format!("check!({module}, {module}_ik, {columns}, {solve}, {redundancy})"),
        };
        (check, solve)
    }

    /// The report of the judge on all modules.
    pub(crate) fn run(self) -> String {
        self.write("src/main.rs", &format!("{}\nfn main() {{\n{}}}\n", self.main, self.checks));
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut command = Command::new(cargo);
        command.args(["run", "--quiet", "--offline"]).current_dir(&self.folder);
        let output = command.env("CARGO_TARGET_DIR", self.folder.join("target")).env("RUSTFLAGS", "-D warnings").output();
        let output = output.expect("cargo starts");
        let [said, errors] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
        println!("{said}");
        assert!(output.status.success(), "{said}{errors}");
        said
    }
}
