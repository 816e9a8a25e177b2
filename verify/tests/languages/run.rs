//! Modules run beside the one in Rust, over the same states from a file; results are compared in bits.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::emit::{camel, Language};
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::Generated;
use armgen_verify::contract::{Array, Length, Promise, Sizes};
use armgen_verify::program::Argument;
use armgen_verify::reader::{Constant, Module, ModuleText};
use armgen_verify::stream::Stream;

use crate::common;

/// How many compilers and flags are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    Short,
    Full,
}

const DRIVER: &str = include_str!("driver.rs");
/// Of the crate the module calls one function, for angles that the states do not have.
const LIBM: &str = "pub fn sincos(x: f64) -> (f64, f64) { x.sin_cos() }\npub fn sincosf(x: f32) -> (f32, f32) { x.sin_cos() }\n";

/// A function, its arguments with the place where each begins in a state, and its results with their number of entries.
struct Called {
    name: String,
    arguments: Vec<(Argument, usize)>,
    results: Vec<(String, Array, usize)>,
}

/// What a driver needs to know of a module.
struct Robot {
    name: String,
    scalar: Scalar,
    dof: usize,
    parameters: usize,
    sizes: Sizes,
    functions: Vec<Called>,
}

impl Robot {
    fn of(module: &Module, scalar: Scalar) -> Robot {
        let integer = |name: &str| match module.constants.get(name) {
            Some(Constant::Integer(value)) => *value as usize,
            _ => 0,
        };
        let Constant::Text(name) = &module.constants["NAME"] else { panic!("a robot has a name") };
        let (dof, parameters) = (integer("DOF"), integer("PARAMETERS"));
        let sizes = Sizes { n: dof, p: parameters, b: integer("BASE_PARAMETERS"), m: integer("TASK_ROWS") };
        let called = |(name, program): (&str, &armgen_verify::program::Program)| {
            let promise = Promise::of(name).expect("a known function").0;
            let start = |argument: Argument| match argument {
                Argument::Pi => 0,
                Argument::Q => parameters,
                Argument::Dq => parameters + dof,
                Argument::Ddq => parameters + 2 * dof,
                Argument::Dqr => parameters + 3 * dof,
                Argument::Ddqr => parameters + 4 * dof,
                Argument::Tau => parameters + 5 * dof,
            };
            let places = promise.returned.places(&sizes);
            let entries = |part: &str| places.iter().filter(|place| promise.returned.part_of(place).0 == part).count();
            Called {
                name: name.into(),
                arguments: program.arguments.iter().map(|&a| (a, start(a))).collect(),
                results: promise
                    .returned
                    .named()
                    .into_iter()
                    .map(|(part, array)| (part.clone(), array, entries(&part)))
                    .collect(),
            }
        };
        Robot { name: name.clone(), scalar, dof, parameters, sizes, functions: module.programs().map(called).collect() }
    }

    /// States: positions of all sizes, exact multiples of pi/2, zeros of both signs among them.
    fn states(&self, count: usize) -> Vec<u8> {
        let mut stream = Stream::new(20_240);
        let range = if self.scalar == Scalar::F64 { 6500.0 } else { 30.0 };
        let mut bytes = Vec::new();
        for state in 0..count {
            for i in 0..self.parameters + 6 * self.dof {
                let unit = (stream.bits() >> 11) as f64 / (1u64 << 53) as f64;
                let signed = 2.0 * unit - 1.0;
                let position = (self.parameters..self.parameters + self.dof).contains(&i);
                let value = match (state % 8, position) {
                    (0, true) => [0.0, -0.0][usize::from(unit < 0.5)],
                    (1, true) => (signed * 8.0).round() * std::f64::consts::FRAC_PI_2,
                    (2, true) => signed * range,
                    (3, false) if i >= self.parameters && unit < 0.5 => 0.0 * signed,
                    (_, true) => 4.0 * signed,
                    _ if i < self.parameters => 0.1 + 3.0 * unit,
                    _ => 3.0 * signed,
                };
                match self.scalar {
                    Scalar::F64 => bytes.extend(value.to_le_bytes()),
                    Scalar::F32 => bytes.extend((value as f32).to_le_bytes()),
                }
            }
        }
        bytes
    }

    fn dimension(&self, length: Length) -> usize {
        match length {
            Length::Dof => self.sizes.n,
            Length::Parameters => self.sizes.p,
            Length::BaseParameters => self.sizes.b,
            Length::Task => self.sizes.m,
            Length::Of(value) => value,
        }
    }

    fn width(&self) -> usize {
        if self.scalar == Scalar::F64 {
            8
        } else {
            4
        }
    }
}

/// Runs a command; what went wrong if it failed or warned.
#[track_caller]
fn succeed(command: &mut Command) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && !err.contains("warning"), "{command:?}: {}\n{out}{err}", output.status);
}

/// Whether a program is there; a line says which package brings it if not.
pub(crate) fn there(program: &str, package: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: no `{program}` here (Debian: {package})");
    }
    found
}

fn write(path: PathBuf, text: impl AsRef<[u8]>) {
    std::fs::write(&path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// Runs the module in all languages over so many states, and compares.
#[track_caller]
pub(crate) fn check(name: &str, scalar: Scalar, states: usize, effort: Effort) {
    let source = common::source(name);
    let generated = crate::generated(&source, scalar, Trig::Fast);
    let module = Module::read(&generated.module).expect("the module in Rust");
    let robot = Robot::of(&module, scalar);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("languages_{effort:?}_{name}_{scalar:?}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    write(folder.join("states"), robot.states(states));
    rust(&folder, &robot, &generated);
    for language in crate::others().filter(|language| language.scalars().contains(&scalar)) {
        let runs = match language {
            Language::Rust => continue,
            Language::C => {
                let batched =
                    common::generate_with(&source, &Options { scalar, trig: Trig::Fast, batch: Some(8), ..Options::default() });
                let mut runs = c(&folder, &robot, &generated, effort);
                runs.extend(batch(&folder, &robot, &batched, effort));
                runs
            }
            Language::JavaScript => javascript(&folder, &robot, &generated),
            Language::Python => python(&folder, &robot, &generated),
            Language::Matlab => octave(&folder, &robot, &generated),
        };
        for run in runs {
            let results: usize = robot.functions.iter().map(|function| compare(&folder, &robot, function, &run)).sum();
            println!("{name} {scalar:?}: {run}: {results} numbers of {} functions have the bits of Rust", robot.functions.len());
            let _ = std::fs::remove_dir_all(folder.join(&run));
        }
    }
    let _ = std::fs::remove_dir_all(&folder);
}

/// Compares the results of a function; how many there are.
#[track_caller]
fn compare(folder: &Path, robot: &Robot, function: &Called, run: &str) -> usize {
    let read = |run: &str| std::fs::read(folder.join(run).join(&function.name)).expect("the results");
    let (rust, other) = (read("rust"), read(run));
    let width = robot.width();
    assert_eq!(rust.len(), other.len(), "{}: {} by {run}", robot.name, function.name);
    let number = |bytes: &[u8]| match bytes.try_into() {
        Ok(eight) => f64::from_le_bytes(eight),
        Err(_) => f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes"))),
    };
    let entries: usize = function.results.iter().map(|(.., entries)| entries).sum();
    for (k, (a, b)) in rust.chunks(width).zip(other.chunks(width)).enumerate() {
        let same = a == b || number(a).is_nan() && number(b).is_nan();
        let (name, own) = (&robot.name, &function.name);
        assert!(
            same,
            "{name}: {own} by {run}: entry {} of state {} is {:e}, in Rust {:e}",
            k % entries,
            k / entries,
            number(b),
            number(a)
        );
    }
    rust.len() / width
}

/// The module in Rust, compiled by itself.
fn rust(folder: &Path, robot: &Robot, generated: &Generated) {
    let mut main = format!("#![allow(unused)]\ninclude!(\"robot.rs\");\n{DRIVER}\n");
    if generated.module.contains("struct EquationsOfMotion") {
        main += "impl Flat for EquationsOfMotion {\n    fn flat(&self, into: &mut Vec<u8>) {\n        self.inertia.flat(into);\n        \
                 self.coriolis.flat(into);\n        self.gravity.flat(into);\n    }\n}\n\n";
    }
    main += "fn main() {\n    let states = States::read();\n";
    for function in &robot.functions {
        let argument = |(argument, start): &(Argument, usize)| {
            let length = if *argument == Argument::Pi { robot.parameters } else { robot.dof };
            format!("state[{start}..{}].try_into().expect(\"an argument\")", start + length)
        };
        let arguments: Vec<String> = function.arguments.iter().map(argument).collect();
        let name = &function.name;
        let _ = writeln!(main, "    let mut results = Vec::new();");
        let _ = writeln!(main, "    states.all().for_each(|state| {name}({}).flat(&mut results));", arguments.join(", "));
        let _ = writeln!(main, "    write({name:?}, &results);");
    }
    main += "}\n";
    write(folder.join("main.rs"), main);
    write(folder.join("robot.rs"), &generated.module);
    write(folder.join("libm.rs"), LIBM);
    std::fs::create_dir_all(folder.join("rust")).expect("a folder");
    let rustc = || {
        let mut command = Command::new("rustc");
        command.current_dir(folder).args(["--edition=2021", "-Copt-level=1", "-Awarnings"]);
        command
    };
    succeed(rustc().args(["--crate-type=rlib", "libm.rs"]));
    succeed(rustc().args(["--extern", "libm=liblibm.rlib", "-o", "rust_main", "main.rs"]));
    succeed(Command::new(folder.join("rust_main")).current_dir(folder).args(["states", "rust"]));
}

/// The header, by all compilers.
fn c(folder: &Path, robot: &Robot, generated: &Generated, effort: Effort) -> Vec<String> {
    let name: String = robot.name.clone();
    let mut main = String::from("#include <stdio.h>\n#include <stdlib.h>\n#include \"robot.h\"\n\n");
    let _ = writeln!(main, "typedef {name}_real real;\n\nstatic FILE *in_folder(const char *folder, const char *name)\n{{");
    main +=
        "    char path[4096];\n    snprintf(path, sizeof path, \"%s/%s\", folder, name);\n    return fopen(path, \"wb\");\n}\n\n";
    main += "int main(int count, char **arguments)\n{\n    FILE *states = fopen(arguments[1], \"rb\"), *results;\n    long size;\n    real *all, *x, *end;\n";
    main += "    static real r[1 << 20];\n    if (count != 3 || !states) return 1;\n";
    main += "    fseek(states, 0, SEEK_END);\n    size = ftell(states);\n    rewind(states);\n    all = (real *)malloc((size_t)size);\n";
    main +=
        "    if (fread(all, 1, (size_t)size, states) != (size_t)size) return 1;\n    end = all + (size_t)size / sizeof(real);\n";
    let length = robot.parameters + 6 * robot.dof;
    for function in &robot.functions {
        let mut arguments: Vec<String> = function.arguments.iter().map(|(_, start)| format!("x + {start}")).collect();
        let mut at = 0;
        let number = function.results.len() == 1 && function.results[0].1.is_empty();
        for (_, array, entries) in function.results.iter().filter(|_| !number) {
            let inner: String = array.iter().skip(1).map(|length| format!("[{}]", robot.dimension(*length))).collect();
            let pointer = if inner.is_empty() { "real *".into() } else { format!("real (*){inner}") };
            arguments.push(format!("({pointer})(r + {at})"));
            at += entries;
        }
        let call = format!("{name}_{}({})", function.name, arguments.join(", "));
        let call = if number { format!("r[0] = {call}") } else { call };
        let _ = writeln!(main, "    results = in_folder(arguments[2], \"{}\");", function.name);
        let _ = writeln!(main, "    for (x = all; x < end; x += {length}) {{\n        {call};");
        let _ = writeln!(main, "        fwrite(r, sizeof(real), {}, results);\n    }}\n    fclose(results);", at.max(1));
    }
    main += "    return 0;\n}\n";
    write(folder.join("robot.h"), generated.in_language(Language::C));
    write(folder.join("main.c"), main);
    let strict = ["-Wall", "-Wextra", "-pedantic", "-Wconversion", "-Wshadow", "-Werror", "main.c", "-lm"];
    let mut runs = Vec::new();
    let short: &[(&str, &[&str])] = &[
        ("gcc", &["-std=c99", "-O3", "-march=native"]),
        ("clang", &["-std=gnu99", "-O2", "-march=native"]),
        ("g++", &["-x", "c++", "-std=c++11", "-O2"]),
    ];
    let full: &[(&str, &[&str])] = &[
        ("gcc", &["-std=c99", "-O2"]),
        ("gcc", &["-std=gnu11", "-O2", "-march=native"]),
        ("gcc", &["-std=c99", "-O3"]),
        ("gcc", &["-std=gnu11", "-O3", "-march=native"]),
        ("clang", &["-std=c99", "-O2"]),
        ("clang", &["-std=c99", "-O3", "-march=native"]),
        ("g++", &["-x", "c++", "-std=c++11", "-O3", "-march=native"]),
        ("clang++", &["-x", "c++", "-std=c++11", "-O3", "-march=native"]),
    ];
    for (compiler, flags) in if effort == Effort::Full { full } else { short } {
        let package = match *compiler {
            "clang++" => "clang",
            other => other,
        };
        if !there(compiler, package) {
            continue;
        }
        let run = format!("{compiler} {}", flags.join(" "));
        succeed(Command::new(compiler).current_dir(folder).args(*flags).args(strict).args(["-o", "c_main"]));
        std::fs::create_dir_all(folder.join(&run)).expect("a folder");
        succeed(Command::new(folder.join("c_main")).current_dir(folder).args(["states", &run]));
        runs.push(run);
    }
    runs
}

/// The functions of the header for many states at a time.
fn batch(folder: &Path, robot: &Robot, generated: &Generated, effort: Effort) -> Vec<String> {
    let name: String = robot.name.clone();
    let length = robot.parameters + 6 * robot.dof;
    let mut main = String::from("#include <stdio.h>\n#include <stdlib.h>\n#include \"batch.h\"\n\n");
    let _ = writeln!(main, "typedef {name}_real real;\n\nstatic real *all;\nstatic size_t states;\n\n");
    main += "static real *some(size_t from, size_t count)\n{\n    real *part = (real *)malloc((states * count + 1) * sizeof(real));\n    size_t k, i;\n";
    main += "    for (k = 0; k < states; ++k) {\n        for (i = 0; i < count; ++i) {\n";
    let _ = writeln!(
        main,
        "            part[k * count + i] = all[k * {length} + from + i];\n        }}\n    }}\n    return part;\n}}\n"
    );
    main += "int main(int count, char **arguments)\n{\n    FILE *file = fopen(arguments[1], \"rb\");\n    long size;\n    char path[4096];\n";
    main += "    size_t k;\n    if (count != 3 || !file) return 1;\n    fseek(file, 0, SEEK_END);\n    size = ftell(file);\n    rewind(file);\n";
    main += "    all = (real *)malloc((size_t)size);\n    if (fread(all, 1, (size_t)size, file) != (size_t)size) return 1;\n    fclose(file);\n";
    let _ = writeln!(main, "    states = (size_t)size / sizeof(real) / {length};");
    for function in &robot.functions {
        let mut arguments = vec!["states".to_string()];
        main += "    {\n";
        for (argument, start) in &function.arguments {
            let length = if *argument == Argument::Pi { robot.parameters } else { robot.dof };
            let _ = writeln!(main, "        real *in_{} = some({start}, {length});", argument.name());
            arguments.push(format!("in_{}", argument.name()));
        }
        for (part, _, entries) in &function.results {
            let _ = writeln!(main, "        real *out_{part} = (real *)malloc((states * {entries} + 1) * sizeof(real));");
            arguments.push(format!("out_{part}"));
        }
        let _ = writeln!(main, "        {name}_batch_{}({});", function.name, arguments.join(", "));
        let _ = writeln!(main, "        snprintf(path, sizeof path, \"%s/{}\", arguments[2]);", function.name);
        main += "        file = fopen(path, \"wb\");\n        for (k = 0; k < states; ++k) {\n";
        for (part, _, entries) in &function.results {
            let _ = writeln!(main, "            fwrite(out_{part} + k * {entries}, sizeof(real), {entries}, file);");
        }
        main += "        }\n        fclose(file);\n";
        arguments.iter().skip(1).for_each(|argument| main += &format!("        free({argument});\n"));
        main += "    }\n";
    }
    main += "    return 0;\n}\n";
    write(folder.join("batch.h"), generated.in_language(Language::C));
    write(folder.join("batch.c"), main);
    let strict = ["-Wall", "-Wextra", "-pedantic", "-Wconversion", "-Wshadow", "-Werror", "batch.c", "-lm"];
    let short: &[(&str, &[&str])] =
        &[("gcc", &["-std=c99", "-O3", "-march=native"]), ("clang++", &["-x", "c++", "-std=c++11", "-O2"])];
    let full: &[(&str, &[&str])] = &[
        ("gcc", &["-std=c99", "-O2"]),
        ("gcc", &["-std=gnu11", "-O3", "-march=native"]),
        ("clang", &["-std=c99", "-O3", "-march=native"]),
    ];
    let mut runs = Vec::new();
    for (compiler, flags) in if effort == Effort::Full { full } else { short } {
        if !there(compiler, compiler.trim_end_matches("++")) {
            continue;
        }
        let run = format!("batch {compiler} {}", flags.join(" "));
        succeed(Command::new(compiler).current_dir(folder).args(*flags).args(strict).args(["-o", "batch_main"]));
        std::fs::create_dir_all(folder.join(&run)).expect("a folder");
        succeed(Command::new(folder.join("batch_main")).current_dir(folder).args(["states", &run]));
        runs.push(run);
    }
    runs
}

/// The module in JavaScript, by Node.
fn javascript(folder: &Path, robot: &Robot, generated: &Generated) -> Vec<String> {
    if !there("node", "nodejs") {
        return Vec::new();
    }
    let mut main = String::from(
        "import fs from \"node:fs\";\nimport * as robot from \"./robot.mjs\";\n\nconst bytes = new Uint8Array(fs.readFileSync(process.argv[2]));\n\
         const all = new Float64Array(bytes.buffer);\nconst flat = (r) => typeof r === \"number\" ? [r] : \
         Array.isArray(r) ? r.flat(Infinity) : Object.values(r).flat(Infinity);\n\
         const write = (name, results) => fs.writeFileSync(`${process.argv[3]}/${name}`, new Uint8Array(Float64Array.from(results).buffer));\nlet results;\n",
    );
    let length = robot.parameters + 6 * robot.dof;
    for function in &robot.functions {
        let of_argument = |(argument, start): &(Argument, usize)| {
            let length = if *argument == Argument::Pi { robot.parameters } else { robot.dof };
            format!("all.subarray(x + {start}, x + {})", start + length)
        };
        let arguments: Vec<String> = function.arguments.iter().map(of_argument).collect();
        let camel = camel(&function.name);
        let _ = writeln!(main, "results = [];\nfor (let x = 0; x < all.length; x += {length}) {{");
        let _ = writeln!(main, "    for (const entry of flat(robot.{camel}({}))) results.push(entry);\n}}", arguments.join(", "));
        let _ = writeln!(main, "write(\"{}\", results);", function.name);
    }
    write(folder.join("robot.mjs"), generated.in_language(Language::JavaScript));
    write(folder.join("main.mjs"), main);
    std::fs::create_dir_all(folder.join("node")).expect("a folder");
    succeed(Command::new("node").current_dir(folder).args(["main.mjs", "states", "node"]));
    vec!["node".into()]
}

/// A Python that has NumPy.
fn numpy() -> Option<&'static str> {
    let has =
        |python: &&str| Command::new(python).args(["-c", "import numpy"]).output().is_ok_and(|output| output.status.success());
    let found = ["python3", "/usr/bin/python3"].into_iter().find(has);
    if found.is_none() {
        println!("skipped: no Python with NumPy here (Debian: python3-numpy)");
    }
    found
}

/// The module in Python, by NumPy, all states at once.
fn python(folder: &Path, robot: &Robot, generated: &Generated) -> Vec<String> {
    let Some(python) = numpy() else { return Vec::new() };
    let length = robot.parameters + 6 * robot.dof;
    let mut main = format!(
        "import sys\nimport warnings\nimport numpy as np\nimport robot\n\nwarnings.simplefilter(\"ignore\")\n\
         all = np.fromfile(sys.argv[1], dtype=robot.DTYPE).reshape(-1, {length})\n\n\n\
         def write(name, result):\n    parts = result if isinstance(result, tuple) else (result,)\n    \
         assert all.dtype == parts[0].dtype\n    \
         np.concatenate([np.reshape(part, (len(all), -1)) for part in parts], axis=1).tofile(sys.argv[2] + \"/\" + name)\n\n\n"
    );
    for function in &robot.functions {
        let of_argument = |(argument, start): &(Argument, usize)| {
            let length = if *argument == Argument::Pi { robot.parameters } else { robot.dof };
            format!("all[:, {start}:{}]", start + length)
        };
        let arguments: Vec<String> = function.arguments.iter().map(of_argument).collect();
        let _ = writeln!(main, "write(\"{0}\", robot.{0}({1}))", function.name, arguments.join(", "));
    }
    write(folder.join("robot.py"), generated.in_language(Language::Python));
    write(folder.join("main.py"), main);
    std::fs::create_dir_all(folder.join("numpy")).expect("a folder");
    succeed(Command::new(python).current_dir(folder).args(["main.py", "states", "numpy"]));
    let mut runs = vec!["numpy".into()];
    if there("cc", "gcc") {
        let native = generated.native();
        write(folder.join("robot_native.c"), native.c);
        write(folder.join("robot_native.py"), native.python);
        let main = std::fs::read_to_string(folder.join("main.py")).expect("it was just written");
        let main = main.replace("robot.DTYPE", "robot_native._DTYPE").replace("import robot\n", "import robot_native\n");
        let loaded = "warnings.simplefilter(\"ignore\")\nrobot = robot_native.load(folder=\"kept\")\nassert robot_native.load(folder=\"kept\")\n";
        write(folder.join("native.py"), main.replace("warnings.simplefilter(\"ignore\")\n", loaded));
        std::fs::create_dir_all(folder.join("native")).expect("a folder");
        succeed(Command::new(python).current_dir(folder).args(["native.py", "states", "native"]));
        assert_eq!(std::fs::read_dir(folder.join("kept")).expect("a folder").count(), 1, "compiled once, complete or not at all");
        runs.push("native".into());
    }
    runs
}

/// Writes the files of the package.
fn write_package(folder: &Path, generated: &Generated) {
    std::fs::create_dir_all(folder).expect("a folder");
    generated.package().into_iter().for_each(|file| write(folder.join(file.name), file.text));
}

/// The package in MATLAB, by Octave, all states at once.
fn octave(folder: &Path, robot: &Robot, generated: &Generated) -> Vec<String> {
    if !there("octave-cli", "octave") {
        return Vec::new();
    }
    let length = robot.parameters + 6 * robot.dof;
    let mut main = format!(
        "function main()\n    file = fopen('states', 'r');\n    x = fread(file, [{length}, Inf], 'double');\n    fclose(file);\n"
    );
    let mut run = String::new();
    for function in &robot.functions {
        let of_argument = |(argument, start): &(Argument, usize)| {
            let length = if *argument == Argument::Pi { robot.parameters } else { robot.dof };
            format!("x({}:{}, :)", start + 1, start + length)
        };
        let arguments: Vec<String> = function.arguments.iter().map(of_argument).collect();
        let results: Vec<String> = (1..=function.results.len()).map(|k| format!("r{k}")).collect();
        let call = format!("robot.{}({})", camel(&function.name), arguments.join(", "));
        let _ = writeln!(main, "    [{}] = {call};", results.join(", "));
        // By rows, as elsewhere.
        let by_rows = |(result, (_, array, entries)): (&String, &(String, Array, usize))| match array.len() {
            0 | 1 => format!("reshape({result}, {entries}, [])"),
            2 => format!("reshape(permute({result}, [2, 1, 3]), {entries}, [])"),
            _ => format!("reshape(permute({result}, [2, 1, 3, 4]), {entries}, [])"),
        };
        let all: Vec<String> = results.iter().zip(&function.results).map(by_rows).collect();
        let all = if function.results.iter().all(|(.., entries)| *entries == 0) { "[]".into() } else { all.join("; ") };
        let _ = writeln!(main, "    put('{}', [{all}]);", function.name);
    }
    run += "end\n\nfunction put(name, results)\n    file = fopen(['octave/', name], 'w');\n    fwrite(file, results, 'double');\n    fclose(file);\nend\n";
    write_package(&folder.join("+robot"), generated);
    write(folder.join("main.m"), main + &run);
    std::fs::create_dir_all(folder.join("octave")).expect("a folder");
    succeed(Command::new("octave-cli").current_dir(folder).args(["--no-init-file", "--eval", "main"]));
    vec!["octave".into()]
}

/// The block of a kind of the page of languages, the first behind a heading.
fn block(heading: &str, kind: &str) -> String {
    let page = include_str!("../../../docs/languages.md");
    let section = page.split(&format!("\n## {heading}\n")).nth(1).expect("a section");
    let block = section.split(&format!("```{kind}\n")).nth(1).expect("a block");
    block.split("```").next().expect("its end").into()
}

/// A folder with the module of the SCARA in a language.
fn folder_of(name: &str) -> (PathBuf, Generated) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    (folder, crate::generated(&common::source("scara"), Scalar::F64, Trig::Fast))
}

#[track_caller]
fn prints(command: &mut Command, expected: &str) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && out == expected, "{command:?}: {}\n{out}{err}", output.status);
}

/// The callers of the page print what stands below them.
pub(crate) fn check_page() {
    let (folder, generated) = folder_of("languages_page");
    if there("gcc", "gcc") {
        write(folder.join("scara.h"), generated.in_language(Language::C));
        write(folder.join("caller.c"), block("C", "c"));
        succeed(Command::new("gcc").current_dir(&folder).args(["-O2", "caller.c", "-lm", "-o", "caller"]));
        prints(&mut Command::new(folder.join("caller")), &block("C", "text"));
    }
    if there("node", "nodejs") {
        write(folder.join("scara.mjs"), generated.in_language(Language::JavaScript));
        write(folder.join("caller.mjs"), block("JavaScript", "js"));
        prints(Command::new("node").current_dir(&folder).arg("caller.mjs"), &block("JavaScript", "text"));
    }
    if let Some(python) = numpy() {
        write(folder.join("scara.py"), generated.in_language(Language::Python));
        write(folder.join("caller.py"), block("Python", "python"));
        prints(Command::new(python).current_dir(&folder).arg("caller.py"), &block("Python", "text"));
        if there("cc", "gcc") {
            let native = generated.native();
            write(folder.join("scara_native.c"), native.c);
            write(folder.join("scara_native.py"), native.python);
            write(folder.join("compiled.py"), block("Python, compiled", "python"));
            let mut command = Command::new(python);
            command.current_dir(&folder).env("XDG_CACHE_HOME", folder.join("cache")).arg("compiled.py");
            prints(&mut command, &block("Python, compiled", "text"));
        }
    }
    if there("octave-cli", "octave") {
        write_package(&folder.join("+scara"), &generated);
        write(folder.join("caller.m"), block("MATLAB and Octave", "matlab"));
        prints(
            Command::new("octave-cli").current_dir(&folder).args(["--no-init-file", "caller.m"]),
            &block("MATLAB and Octave", "text"),
        );
    }
}

/// What the callers of a package are told: of a row where a column is wanted, of other numbers, by `help`.
pub(crate) fn check_package() {
    let (folder, generated) = folder_of("languages_package");
    if !there("octave-cli", "octave") {
        return;
    }
    write_package(&folder.join("+scara"), &generated);
    // One file alone, with another name, as in a block of Simulink.
    let gravity = generated.package().into_iter().find(|file| file.name == "inverseDynamics.m").expect("a function");
    write(folder.join("block.m"), gravity.text.replace("= inverseDynamics(", "= block("));
    write(
        folder.join("main.m"),
        "function main()
    told(@() scara.gravity([0.1, 0.2, 0.3, 0.4]), 'armgen:size', 'q is 1 x 4 where 4 x 1 is wanted');
    told(@() scara.coriolisMatrix(zeros(4, 3), zeros(4, 2)), 'armgen:size', 'dq is 4 x 2 where 4 x 1 is wanted');
    told(@() scara.gravity(single([0.1; 0.2; 0.3; 0.4])), 'armgen:type', 'double precision');
    told(@() scara.gravity(1i * [0.1; 0.2; 0.3; 0.4]), 'armgen:type', 'real numbers');
    q = reshape(linspace(-3, 3, 20), 4, 5);
    all = scara.inertiaMatrix(q);
    assert(isequal(size(all), [4, 4, 5]));
    for k = 1:5
        assert(isequal(all(:, :, k), scara.inertiaMatrix(q(:, k))));
    end
    assert(isequal(size(scara.linkFrames(q)), [4, 4, 4, 5]));
    [inertia, coriolis, gravity] = scara.equationsOfMotion(q, [1; 2; 3; 4]);
    assert(isequal(inertia, all) && isequal(size(coriolis), [4, 4, 5]) && isequal(gravity, scara.gravity(q)));
    assert(isequal(size(scara.potentialEnergy(q)), [1, 5]));
    model = scara.model();
    assert(model.dof == 4 && strcmp(model.name, 'scara') && numel(model.jointNames) == 4);
    assert(isequal(scara.gravityWith(model.nominalParameters, q), scara.gravity(q)) || ...
        max(max(abs(scara.gravityWith(model.nominalParameters, q) - scara.gravity(q)))) < 1e-9);
    assert(isequal(size(scara.gravity(zeros(4, 0))), [4, 0]));
    assert(isequal(block(q, q, q), scara.inverseDynamics(q, q, q)));
    assert(~isempty(strfind(evalc('help scara.inertiaMatrix'), 'inertiaMatrix(q)')));
end

function told(call, identifier, words)
    try
        call();
    catch fault
        assert(strcmp(fault.identifier, identifier) && ~isempty(strfind(fault.message, words)), fault.message);
        return;
    end
    error('nothing was said: %s', words);
end
",
    );
    succeed(Command::new("octave-cli").current_dir(&folder).args(["--no-init-file", "--eval", "main"]));
}

/// The test file of a language passes beside the module, and fails beside one whose gravity is another.
pub(crate) fn check_tests(name: &str, scalar: Scalar, language: Language) {
    let python = if language == Language::Python { numpy() } else { Some("") };
    let there = match language {
        Language::C => there("gcc", "gcc"),
        Language::JavaScript => there("node", "nodejs"),
        Language::Python => python.is_some(),
        Language::Matlab => there("octave-cli", "octave"),
        Language::Rust => false,
    };
    if !there {
        return;
    }
    let (folder, _) = folder_of(&format!("languages_tests_{name}_{scalar:?}_{language:?}"));
    let source = common::source(name);
    let generated = crate::generated(&source, scalar, Trig::Fast);
    let text = generated.in_language(language);
    let called = match language {
        Language::C => "robot.h",
        Language::JavaScript => "robot.mjs",
        _ => "robot",
    };
    let tests = armgen_verify::test_kit_in(&source, ModuleText { language, text: &text }, called).expect("a test file");
    let run = |spoilt: bool| {
        // The torque that holds a part of the arm.
        let change = |text: &str| if spoilt { text.replace("98.1", "98.3").replace("9.81", "9.83") } else { text.to_string() };
        let mut command = match language {
            Language::C => {
                write(folder.join("robot.h"), change(&text));
                write(folder.join("robot_test.c"), &tests);
                let strict = ["-std=c99", "-O1", "-Wall", "-Wextra", "-pedantic", "-Wconversion", "-Wshadow", "-Werror"];
                let mut gcc = Command::new("gcc");
                succeed(gcc.current_dir(&folder).args(strict).args(["robot_test.c", "-lm", "-o", "robot_test"]));
                Command::new(folder.join("robot_test"))
            }
            Language::JavaScript => {
                write(folder.join("robot.mjs"), change(&text));
                write(folder.join("robot.test.mjs"), &tests);
                let mut node = Command::new("node");
                node.args(["--test", "robot.test.mjs"]);
                node
            }
            Language::Python => {
                write(folder.join("robot.py"), change(&text));
                write(folder.join("test_robot.py"), &tests);
                let mut command = Command::new(python.unwrap_or_default());
                command.args(["-B", "test_robot.py"]);
                command
            }
            Language::Matlab => {
                std::fs::create_dir_all(folder.join("+robot")).expect("a folder");
                generated.package().into_iter().for_each(|file| write(folder.join("+robot").join(file.name), change(&file.text)));
                write(folder.join("robotTest.m"), &tests);
                let mut octave = Command::new("octave-cli");
                octave.args(["--no-init-file", "--eval", "robotTest"]);
                octave
            }
            Language::Rust => unreachable!("it has a test of its own"),
        };
        let output = command.current_dir(&folder).output().expect("it runs");
        let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_eq!(output.status.success(), !spoilt, "{name} {scalar:?} {language:?}, spoilt: {spoilt}\n{said}");
    };
    assert!(text.contains("98.1") || text.contains("9.81"), "something to spoil");
    run(false);
    run(true);
}

/// The declarations of JavaScript by the compiler of TypeScript: a caller that is right, and ones that are not.
pub(crate) fn check_declarations() {
    let (folder, generated) = folder_of("languages_tsc");
    if !there("tsc", "node-typescript") {
        return;
    }
    write(folder.join("scara.mjs"), generated.in_language(Language::JavaScript));
    write(folder.join("scara.d.mts"), generated.declarations());
    let compile = |caller: &str| {
        let text = format!(
            "import * as scara from \"./scara.mjs\";\nconst b = scara.inertiaMatrix([1, 2, 3, 4]);\n{caller}\nexport {{}};\n"
        );
        write(folder.join("caller.mts"), text);
        let options = [
            "--strict",
            "--noEmit",
            "--module",
            "nodenext",
            "--moduleResolution",
            "nodenext",
            "--target",
            "es2022",
            "caller.mts",
        ];
        let output = Command::new("tsc").current_dir(&folder).args(options).output().expect("it runs");
        (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let right = "const tau: number = scara.inverseDynamics(new Float64Array(4), [0, 0, 0, 0], [0, 0, 0, 0])[3];\n\
                 const name: string = scara.JOINT_NAMES[0];\nconsole.log(b[3][3] + tau, scara.equationsOfMotion([1, 2, 3, 4], [0, 0, 0, 0]).inertia[0][0], name);";
    let (passed, said) = compile(right);
    assert!(passed, "{said}");
    for wrong in [
        "b[9];",
        "b[0][4];",
        "scara.gravity(\"q\" as string & number[]).foo;",
        "scara.nothing();",
        "scara.gravity(1);",
        "scara.DOF = 5;",
    ] {
        let (passed, _) = compile(wrong);
        assert!(!passed, "{wrong} is taken");
    }
}

/// What reorders sums is refused by the header itself, and without `math.h` it needs no header.
pub(crate) fn check_fast_math() {
    let (folder, generated) = folder_of("languages_fast_math");
    write(folder.join("scara.h"), generated.in_language(Language::C));
    write(folder.join("twice.c"), "#include \"scara.h\"\n#include \"scara.h\"\n");
    for compiler in ["gcc", "clang"] {
        if !there(compiler, compiler) {
            continue;
        }
        let compile = |flags: &[&str]| {
            let mut command = Command::new(compiler);
            command.current_dir(&folder).args(["-O2", "-Wall", "-Werror", "-c", "-o", "twice.o", "twice.c"]).args(flags);
            command
        };
        let output = compile(&["-ffast-math"]).output().expect("it is there");
        let told = String::from_utf8_lossy(&output.stderr).contains("compile without");
        assert!(!output.status.success() && told, "{compiler} -ffast-math");
        succeed(&mut compile(&[]));
        succeed(&mut compile(&["-DSCARA_NO_MATH_H", "-nostdinc", "-ffreestanding"]));
    }
}
