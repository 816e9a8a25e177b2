//! Generates every robot of the tables, with the sines of libm and with the fast ones, and the list of the functions that all of them have.

use std::path::PathBuf;

use armgen_codegen::build_script::{Robot, Scalar, Trig};
use signatures::of_module;

#[allow(missing_docs, unreachable_pub, dead_code)]
#[path = "../tests/src/signatures.rs"]
mod signatures;

fn main() {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("a build script has it"));
    let mut common: Option<Vec<signatures::Signature>> = None;
    for robot in ["scara4", "puma560", "ur5", "panda7"] {
        for (trig, suffix) in [(Trig::Libm, "libm"), (Trig::Fast, "fast")] {
            let module = format!("{robot}_{suffix}");
            Robot::new(format!("../robots/{robot}.yaml")).trig(trig).file_stem(&module).inverse_kinematics().generate();
            let text = std::fs::read_to_string(out.join(format!("{module}.rs"))).expect("it was just written");
            let functions = of_module(&text);
            common = Some(match common {
                None => functions,
                Some(before) => before.into_iter().filter(|function| functions.contains(function)).collect(),
            });
        }
    }
    for lanes in [8, 16] {
        let panda = Robot::new("../robots/panda7.yaml").scalar(Scalar::F32).trig(Trig::Fast).batch(lanes);
        panda.functions(["inverse_dynamics"]).file_stem(format!("panda7_lanes_{lanes}")).generate();
    }
    // The forms with parameters at run time cost the same as the others, except for their arguments.
    let functions = common.unwrap_or_default().into_iter().filter(|(name, _)| !name.ends_with("_with"));
    let given = |argument: &String| {
        match argument.as_str() {
            "dqr" => "dq",
            "ddqr" | "tau" => "ddq",
            own => own,
        }
        .to_owned()
    };
    let listed: String = functions
        .map(|(name, arguments)| {
            let arguments: Vec<String> = arguments.iter().map(given).collect();
            format!("            {name}({});\n", arguments.join(", "))
        })
        .collect();
    let text = format!(
        "/// Hands the measured functions and their arguments to a macro.\n#[macro_export]\nmacro_rules! functions {{\n    \
         ($callback:ident $($head:tt)*) => {{\n        $callback! {{\n            $($head)*\n{listed}        }}\n    }};\n}}\n"
    );
    std::fs::write(out.join("functions.rs"), text).expect("OUT_DIR can be written");
}
