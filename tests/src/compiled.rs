//! Emitted modules compiled by cargo in a crate of their own, outside of this workspace, and asked over a pipe.
//!
//! A question is a line, `ARM FUNCTION` and the arguments in order as the hexadecimal bits of f64; so is the answer. Nothing is rounded.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex};

use crate::functions::{Arguments, Functions};
use crate::project::Project;
use crate::signatures::{listed, of_module};

/// The arm `index` of a running program.
pub struct Compiled {
    program: Arc<Mutex<Program>>,
    index: usize,
    dof: usize,
    parameter_names: Vec<String>,
    nominal: Vec<f64>,
    nominal_base: Vec<f64>,
    functions: Vec<String>,
}

struct Program {
    child: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Drop for Program {
    fn drop(&mut self) {
        // It reads until its input ends; nothing is left to ask.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Program {
    fn ask(&mut self, question: &str) -> String {
        writeln!(self.questions, "{question}").and_then(|()| self.questions.flush()).expect("the program reads");
        let mut answer = String::new();
        self.answers.read_line(&mut answer).expect("the program answers");
        assert!(!answer.is_empty(), "the program ended at {question}");
        answer
    }
}

/// What reads questions: `mod arm0; mod arm1; ..` and the table of `answer` come after it.
const MAIN: &str = include_str!("compiled/program.rs");
const ANSWERS: &str = include_str!("answers.rs");

impl Compiled {
    /// Compiles modules in f64 into one program in `root`, with warnings denied, and starts it.
    ///
    /// # Panics
    /// Where cargo or the program fails.
    #[track_caller]
    pub fn all(root: &Path, modules: &[String]) -> Vec<Compiled> {
        let project = Project::new(root, "arms");
        project.write(
            "Cargo.toml",
            "[package]\nname = \"arms\"\nversion = \"1.0.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n\n\
             [profile.dev]\ndebug = false\nincremental = false\n",
        );
        let (mut main, mut table) = (MAIN.to_owned(), String::new());
        for (i, module) in modules.iter().enumerate() {
            project.write(&format!("src/arm{i}.rs"), module);
            writeln!(main, "#[allow(dead_code)]\nmod arm{i};\nflat!(arm{i});").expect("text");
            writeln!(table, "    answers!(arm{i}; {}),", listed(&of_module(module))).expect("text");
        }
        writeln!(main, "\nconst ARMS: &[fn(&str, &Arguments) -> Vec<f64>] = &[\n{table}];").expect("text");
        project.write("src/main.rs", &main);
        project.write("src/answers.rs", ANSWERS);
        project.succeed(&["build", "--quiet"]);
        let mut child = Command::new(root.join("target/debug/arms"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let (questions, answers) = (child.stdin.take().expect("piped"), child.stdout.take().expect("piped"));
        let program = Arc::new(Mutex::new(Program { child, questions, answers: BufReader::new(answers) }));
        (0..modules.len())
            .map(|index| {
                let asked = |question: &str| program.lock().expect("no question failed").ask(&format!("{index} {question}"));
                let dof = numbers(&asked("dof"))[0] as usize;
                let parameter_names = names(&modules[index]);
                let nominal = numbers(&asked("nominal"));
                assert_eq!(parameter_names.len(), nominal.len());
                Compiled {
                    program: Arc::clone(&program),
                    index,
                    dof,
                    parameter_names,
                    nominal,
                    nominal_base: numbers(&asked("nominal_base")),
                    functions: of_module(&modules[index]).into_iter().map(|(name, _)| name).collect(),
                }
            })
            .collect()
    }
}

/// `PARAMETER_NAMES` of a module, read from its text.
fn names(module: &str) -> Vec<String> {
    let (_, rest) = module.split_once("pub const PARAMETER_NAMES").expect("every module names its parameters");
    let (_, rest) = rest.split_once('=').expect("a constant has a value");
    let (list, _) = rest.split_once(';').expect("an item ends");
    list.split('"').skip(1).step_by(2).map(ToOwned::to_owned).collect()
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().map(|bits| f64::from_bits(u64::from_str_radix(bits, 16).expect("bits"))).collect()
}

impl Functions for Compiled {
    fn dof(&self) -> usize {
        self.dof
    }

    fn parameter_names(&self) -> Vec<String> {
        self.parameter_names.clone()
    }

    fn nominal(&self) -> Vec<f64> {
        self.nominal.clone()
    }

    fn nominal_base(&self) -> Vec<f64> {
        self.nominal_base.clone()
    }

    fn has(&self, function: &str) -> bool {
        self.functions.iter().any(|name| name == function)
    }

    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64> {
        let Arguments { pi, q, dq, ddq, dqr, ddqr, tau, g0 } = arguments;
        assert!(g0.is_empty(), "the arms compiled here have a fixed gravity");
        let mut question = format!("{} {function}", self.index);
        // Each list with its length: a judge only passes the arguments that a function needs.
        for list in [pi, q, dq, ddq, dqr, ddqr, tau] {
            write!(question, " {}", list.len()).expect("text");
            for x in list {
                write!(question, " {:016x}", x.to_bits()).expect("text");
            }
        }
        numbers(&self.program.lock().expect("no question failed").ask(&question))
    }
}
