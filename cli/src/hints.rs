//! Replacements of unknown arguments that users know from other programs.

use std::path::Path;

use armgen_codegen::emit::Language;

/// The remedy for arguments that were refused, without the program's name; `None` where nothing better is known than what the refusal says.
pub(crate) fn of(arguments: &[String]) -> Option<String> {
    let command = arguments.iter().find(|argument| !argument.starts_with('-'))?;
    let behind = |option: &str| {
        let same = arguments.iter().find_map(|argument| argument.strip_prefix(option)?.strip_prefix('=').map(str::to_owned));
        same.or_else(|| arguments.iter().position(|argument| argument == option).and_then(|at| arguments.get(at + 1).cloned()))
    };
    let extension = Path::new(command).extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match (command.as_str(), extension.to_lowercase().as_str()) {
        (_, "yaml" | "yml") => {
            return Some(format!("say what to do with the file: `armgen check {command}`, `armgen show {command}`, `armgen page {command}`"))
        }
        (_, "rs" | "h" | "cuh" | "mjs" | "py" | "m") => {
            return Some(format!("say what to do with the file: `armgen verify robot.yaml {command}` compares it with its description"))
        }
        (_, "urdf" | "xml" | "mjcf" | "xacro" | "sdf") => return Some(format!("make a description of the file first: `armgen import {command} --out robot.yaml`")),
        ("plot" | "draw" | "view" | "visualize" | "show3d", _) => {
            return Some("there is no such command: `armgen page robot.yaml` draws the arm, and the command `run` draws the curves of experiments".into())
        }
        ("simulate" | "sim", _) => {
            return Some("there is no such command: experiments are simulated by the command `run` (docs/experiments.md)".into())
        }
        ("lint" | "validate", _) => return Some("there is no such command: `armgen check robot.yaml` looks for faults".into()),
        _ => {}
    }
    if let Some(language) = behind("--language").filter(|name| Language::ALL.iter().all(|language| language.name() != name)) {
        let names: Vec<&str> = Language::ALL.map(Language::name).to_vec();
        let instead = match language.to_lowercase().as_str() {
            "c++" | "cpp" | "cxx" => "; C++ includes the header that `--language c` writes",
            "hip" | "gpu" | "cu" | "cuh" => "; `--language cuda` writes a header for CUDA and HIP",
            "js" | "typescript" | "ts" => "; `--language javascript` writes a module for both",
            "octave" | "m" => "; `--language matlab` writes a package for both",
            "py" | "numpy" | "jax" | "torch" => "; `--language python` takes arrays of NumPy, JAX and others",
            _ => "",
        };
        return Some(format!("there is no language `{language}`; there are {}{instead}", names.join(", ")));
    }
    if command == "show" {
        for format in ["latex", "json", "text"] {
            if arguments.iter().any(|argument| argument.strip_prefix("--") == Some(format)) {
                return Some(format!("write `--format {format}`"));
            }
        }
    }
    arguments.iter().any(|argument| argument == "-o").then(|| "write `--out` for the file to be written".to_owned())
}

#[cfg(test)]
mod tests {
    #[track_caller]
    fn check(arguments: &str, said: &str) {
        let arguments: Vec<String> = arguments.split_whitespace().map(str::to_owned).collect();
        let found = super::of(&arguments).unwrap_or_default();
        assert!(found.contains(said) && said.is_empty() == found.is_empty(), "{arguments:?}: {found}");
    }

    #[test]
    fn words_of_other_programs_have_an_answer() {
        check("px4.yaml", "`armgen check px4.yaml`");
        check("arm.urdf", "`armgen import arm.urdf");
        check("arm.h", "`armgen verify robot.yaml arm.h`");
        check("plot px4.yaml", "`armgen page");
        check("simulate px4.yaml", "`run`");
        check("show px4.yaml --latex", "`--format latex`");
        check("page px4.yaml -o a.html", "`--out`");
        check("generate px4.yaml --language casadi", "there are rust");
        check("generate px4.yaml --language=cpp", "`--language c`");
        check("chek px4.yaml", "");
    }
}
