//! Programs that run a module in its language: every function over all states of a file, with a result file each.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;
use std::process::Command;

use armgen_codegen::emit::{camel, Language};
use armgen_codegen::Generated;
use armgen_verify::values::contract::Array;
use armgen_verify::values::program::Argument;

use super::run::{Effort, Robot};
use super::tools::{numpy, succeed, there, write, write_package};

const DRIVER: &str = include_str!("driver.rs");
/// A substitute for the module's only external function, which serves angles outside the tested states.
const LIBM: &str = "pub fn sincos(x: f64) -> (f64, f64) { x.sin_cos() }\npub fn sincosf(x: f32) -> (f32, f32) { x.sin_cos() }\n";

/// The Rust module, compiled separately.
pub(crate) fn rust(folder: &Path, robot: &Robot, generated: &Generated) {
    let mut main = format!("#![allow(unused)]\ninclude!(\"robot.rs\");\n{DRIVER}\n");
    if generated.module.contains("struct EquationsOfMotion") {
        main += "impl Flat for EquationsOfMotion {\n    fn flat(&self, into: &mut Vec<u8>) {\n        self.inertia.flat(into);\n        \
                 self.coriolis.flat(into);\n        self.gravity.flat(into);\n    }\n}\n\n";
    }
    main += "fn main() {\n    let states = States::read();\n";
    for function in &robot.functions {
        let argument = |(_, place): &(Argument, Range<usize>)| {
            format!("state[{}..{}].try_into().expect(\"an argument\")", place.start, place.end)
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

/// The header, with all compilers.
pub(crate) fn c(folder: &Path, robot: &Robot, generated: &Generated, effort: Effort) -> Vec<String> {
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
    let length = robot.numbers_of_state();
    for function in &robot.functions {
        let mut arguments: Vec<String> = function.arguments.iter().map(|(_, place)| format!("x + {}", place.start)).collect();
        let mut at = 0;
        let number = function.results.len() == 1 && function.results[0].1.is_empty();
        for (_, array, entries) in function.results.iter().filter(|_| !number) {
            let inner: String =
                array.iter().skip(1).map(|length| format!("[{}]", robot.dimension(&function.name, *length))).collect();
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

/// The functions of the header for arrays of states.
pub(crate) fn batch(folder: &Path, robot: &Robot, generated: &Generated, effort: Effort) -> Vec<String> {
    let name: String = robot.name.clone();
    let length = robot.numbers_of_state();
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
        for (argument, place) in &function.arguments {
            let _ = writeln!(main, "        real *in_{} = some({}, {});", argument.name(), place.start, place.len());
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

/// The JavaScript module, in Node.
pub(crate) fn javascript(folder: &Path, robot: &Robot, generated: &Generated) -> Vec<String> {
    if !there("node", "nodejs") {
        return Vec::new();
    }
    let mut main = String::from(
        "import fs from \"node:fs\";\nimport * as robot from \"./robot.mjs\";\n\nconst bytes = new Uint8Array(fs.readFileSync(process.argv[2]));\n\
         const all = new Float64Array(bytes.buffer);\nconst flat = (r) => typeof r === \"number\" ? [r] : \
         Array.isArray(r) ? r.flat(Infinity) : Object.values(r).flat(Infinity);\n\
         const write = (name, results) => fs.writeFileSync(`${process.argv[3]}/${name}`, new Uint8Array(Float64Array.from(results).buffer));\nlet results;\n",
    );
    let length = robot.numbers_of_state();
    for function in &robot.functions {
        let of_argument = |(_, place): &(Argument, Range<usize>)| format!("all.subarray(x + {}, x + {})", place.start, place.end);
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

/// The Python module, in NumPy, for all states at once.
pub(crate) fn python(folder: &Path, robot: &Robot, generated: &Generated) -> Vec<String> {
    let Some(python) = numpy() else { return Vec::new() };
    let length = robot.numbers_of_state();
    let mut main = format!(
        "import sys\nimport warnings\nimport numpy as np\nimport robot\n\nwarnings.simplefilter(\"ignore\")\n\
         all = np.fromfile(sys.argv[1], dtype=robot.DTYPE).reshape(-1, {length})\n\n\n\
         def write(name, result):\n    parts = result if isinstance(result, tuple) else (result,)\n    \
         assert all.dtype == parts[0].dtype\n    \
         np.concatenate([np.reshape(part, (len(all), -1)) for part in parts], axis=1).tofile(sys.argv[2] + \"/\" + name)\n\n\n"
    );
    for function in &robot.functions {
        let of_argument = |(_, place): &(Argument, Range<usize>)| format!("all[:, {}:{}]", place.start, place.end);
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

/// The MATLAB package, in Octave, for all states at once.
pub(crate) fn octave(folder: &Path, robot: &Robot, generated: &Generated) -> Vec<String> {
    if !there("octave-cli", "octave") {
        return Vec::new();
    }
    let length = robot.numbers_of_state();
    let mut main = format!(
        "function main()\n    file = fopen('states', 'r');\n    x = fread(file, [{length}, Inf], 'double');\n    fclose(file);\n"
    );
    let mut run = String::new();
    for function in &robot.functions {
        let of_argument = |(_, place): &(Argument, Range<usize>)| format!("x({}:{}, :)", place.start + 1, place.end);
        let arguments: Vec<String> = function.arguments.iter().map(of_argument).collect();
        let results: Vec<String> = (1..=function.results.len()).map(|k| format!("r{k}")).collect();
        let call = format!("robot.{}({})", camel(&function.name), arguments.join(", "));
        let _ = writeln!(main, "    [{}] = {call};", results.join(", "));
        // Row by row, as in other languages.
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
