//! Runs the examples of the page about languages, and tests the package, the test files and the declarations next to a module.

use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;
use armgen_codegen::schedule::Options;
use armgen_codegen::Generated;
use armgen_verify::read::reader::ModuleText;

use super::tools::{numpy, succeed, there, write, write_package};
use crate::common;

/// The first block of this kind after a heading of the page about languages.
fn block(heading: &str, kind: &str) -> String {
    let page = include_str!("../../../docs/languages.md");
    let section = page.split(&format!("\n## {heading}\n")).nth(1).expect("a section");
    let block = section.split(&format!("```{kind}\n")).nth(1).expect("a block");
    block.split("```").next().expect("its end").into()
}

/// A folder with the module of the SCARA in a language.
pub(super) fn folder_of(name: &str) -> (PathBuf, Generated) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    (folder, super::generated(&common::source("scara"), Scalar::F64, Trig::Fast))
}

#[track_caller]
fn prints(command: &mut Command, expected: &str) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && out == expected, "{command:?}: {}\n{out}{err}", output.status);
}

/// The callers on the page print the output shown below them.
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
            check_compiler_with_options(&folder, python);
            check_threads(&folder, python);
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

/// CC or an argument can name a compiler with options; a path with a blank stays a single path.
fn check_compiler_with_options(folder: &Path, python: &str) {
    let compiler = folder.join("my cc");
    write(compiler.clone(), "#!/bin/sh\necho \"$@\" >> given\nexec cc \"$@\"\n");
    succeed(Command::new("chmod").arg("+x").arg(&compiler));
    write(
        folder.join("compilers.py"),
        "import os, pathlib
import scara_native

def given(compiler, expected):
    path = pathlib.Path('given')
    path.unlink(missing_ok=True)
    scara_native.load(compiler, flags=['-O0'], folder='kept')
    asked, compiled = path.read_text().splitlines()
    assert asked == expected[0] and compiled.startswith(expected[1]), path.read_text()

own = os.path.abspath('my cc')
given(own, ('--version', '-O0 '))
given(f\"'{own}' -g0 -DX='a b'\", ('-g0 -DX=a b --version', '-g0 -DX=a b -O0 '))
os.environ['CC'] = f\"'{own}' -g0\"
given(None, ('-g0 --version', '-g0 -O0 '))
",
    );
    succeed(Command::new(python).current_dir(folder).arg("compilers.py"));
}

/// Threads that share the states give the bits of a single thread, in every state.
fn check_threads(folder: &Path, python: &str) {
    write(
        folder.join("threads.py"),
        "import os
import numpy as np
import scara_native

os.cpu_count = lambda: 3
fast = scara_native.load(folder='kept', flags=['-O0'])
q, dq = np.random.default_rng(1).uniform(-3, 3, (2, 10, 1001, 4))
for threads in (0, 2, 3, 9):
    assert (fast.gravity(q, threads=threads) == fast.gravity(q)).all()
    for many, one in zip(fast.equations_of_motion(q, dq, threads=threads), fast.equations_of_motion(q, dq)):
        assert many.tobytes() == one.tobytes()
assert fast.gravity(np.zeros((0, 4)), threads=2).shape == (0, 4)
try:
    fast.gravity(q, threads=-1)
except ValueError as error:
    assert str(error) == 'threads: 0 or more, not -1'
else:
    raise AssertionError('refused')
",
    );
    succeed(Command::new(python).current_dir(folder).arg("threads.py"));
}

/// Messages for callers of a package: about a row in place of a column, about other types of numbers, and from `help`.
pub(crate) fn check_package() {
    let (folder, generated) = folder_of("languages_package");
    if !there("octave-cli", "octave") {
        return;
    }
    write_package(&folder.join("+scara"), &generated);
    // A single file with another name, as in a block of Simulink.
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
    % No states, as the columns of no solutions are.
    none = zeros(4, 0);
    assert(isequal(size(scara.gravity(none)), [4, 0]) && isequal(size(scara.linkFrames(none)), [4, 4, 4, 0]));
    assert(isequal(size(scara.inverseDynamics(none, [1; 2; 3; 4], zeros(4, 1))), [4, 0]));
    assert(isequal(size(scara.coriolisMatrix([1; 2; 3; 4], none)), [4, 4, 0]));
    assert(isequal(size(scara.kineticEnergyWith(model.nominalParameters, none, [1; 2; 3; 4])), [1, 0]));
    told(@() scara.coriolisMatrix(none, zeros(4, 2)), 'armgen:size', 'dq is 4 x 2 where 4 x 1 is wanted');
    frames = scara.linkFrames(q);
    jacobians = scara.linkJacobians(q);
    q2 = q(:, 2) + [0; 0; 0; 1]; % link 3 knows nothing of joint 4
    moved = scara.linkFrames(q2);
    assert(isequal(frames(:, :, 3, 2), moved(:, :, 3)) && ~isequal(frames(:, :, 4, 2), moved(:, :, 4)));
    assert(~any(any(jacobians(:, 2:4, 1, 2))) && any(jacobians(:, 1, 1, 2)));
    assert(~isempty(strfind(evalc('help scara.linkFrames'), 'm(i, j, link, k), indices from 1: link 1 is the one that joint 1 moves')));
    assert(isequal(block(q, q, q), scara.inverseDynamics(q, q, q)));
    % More states than a block has, the last block of one.
    many = linspace(-3, 3, 4 * 8193);
    many = reshape(many, 4, 8193);
    rates = [1; 2; 3; 4];
    [inertia, coriolis, gravity] = scara.equationsOfMotion(many, rates);
    frames = scara.linkFrames(many);
    energy = scara.kineticEnergy(many, rates);
    torques = scara.inverseDynamics(many(:, 1), rates, many);
    for k = [1, 4096, 4097, 8192, 8193]
        [b, c, g] = scara.equationsOfMotion(many(:, k), rates);
        assert(isequal(inertia(:, :, k), b) && isequal(coriolis(:, :, k), c) && isequal(gravity(:, k), g));
        assert(isequal(frames(:, :, :, k), scara.linkFrames(many(:, k))));
        assert(isequal(energy(k), scara.kineticEnergy(many(:, k), rates)));
        assert(isequal(torques(:, k), scara.inverseDynamics(many(:, 1), rates, many(:, k))));
    end
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

/// The test file of a language passes with the module, and fails with a module of another gravity.
pub(crate) fn check_tests(name: &str, scalar: Scalar, language: Language) {
    let python = if language == Language::Python { numpy() } else { Some("") };
    let there = match language {
        Language::C => there("gcc", "gcc"),
        Language::JavaScript => there("node", "nodejs"),
        Language::Python => python.is_some(),
        Language::Matlab => there("octave-cli", "octave"),
        Language::Rust | Language::Cuda => false,
    };
    if !there {
        return;
    }
    let (folder, _) = folder_of(&format!("languages_tests_{name}_{scalar:?}_{language:?}"));
    let source = common::source(name);
    let generated = super::generated(&source, scalar, Trig::Fast);
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
            Language::Rust | Language::Cuda => unreachable!("it has a test of its own"),
        };
        let output = command.current_dir(&folder).output().expect("it runs");
        let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_eq!(output.status.success(), !spoilt, "{name} {scalar:?} {language:?}, spoilt: {spoilt}\n{said}");
    };
    assert!(text.contains("98.1") || text.contains("9.81"), "something to spoil");
    run(false);
    run(true);
}

/// The JavaScript declarations pass the TypeScript compiler with a correct caller, and not with incorrect callers.
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

/// Flags that let a compiler reorder sums; GCC makes them detectable, Clang does not.
const PARTS_OF_FAST_MATH: [&[&str]; 4] = [
    &["-ffast-math", "-fno-finite-math-only"],
    &["-funsafe-math-optimizations"],
    &["-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"],
    &["-freciprocal-math"],
];

/// Flags that assume away NaN and infinity, or ignore signs of zeros, with the compilers that make them detectable.
const OTHER_NUMBERS: [(&str, &[&str]); 2] =
    [("-ffinite-math-only", &["gcc", "clang", "arm-none-eabi-gcc"]), ("-fno-signed-zeros", &["gcc", "arm-none-eabi-gcc"])];

/// The header itself refuses flags that reorder sums or change number semantics, or they change nothing if the compiler hides them. Other flags are
/// accepted, and without `math.h` no header is needed.
pub(crate) fn check_fast_math() {
    let (folder, generated) = folder_of("languages_fast_math");
    write(folder.join("scara.h"), generated.in_language(Language::C));
    write(folder.join("twice.c"), "#include \"scara.h\"\n#include \"scara.h\"\n");
    let fused = Options { trig: Trig::Fast, fuse: true, ..Options::default() };
    write(folder.join("fused.c"), "#include \"fused.h\"\n");
    write(folder.join("fused.h"), common::generate_with(&common::source("scara"), &fused).in_language(Language::C));
    let caller = [
        "#include <stdio.h>\n#include \"scara.h\"\nint main(void)\n{",
        "double q[SCARA_DOF] = {0.1, 0.2, 0.3, 0.4}, tau[SCARA_DOF];",
        "for (int k = 0; k < 1000; k++) {",
        "for (int i = 0; i < SCARA_DOF; i++) q[i] = q[i] * 1.25 + 0.375;",
        "if (k % 32 == 0) for (int i = 0; i < SCARA_DOF; i++) q[i] = 0.1 * i;",
        "scara_inverse_dynamics(q, q, q, tau);",
        "for (int i = 0; i < SCARA_DOF; i++) printf(\"%a \", tau[i]);",
        "}\nreturn 0;\n}\n",
    ];
    write(folder.join("caller.c"), caller.join("\n"));
    for compiler in ["gcc", "clang", "arm-none-eabi-gcc"] {
        // Its C library is not installed everywhere.
        let bare = compiler.starts_with("arm");
        if !there(compiler, if bare { "gcc-arm-none-eabi" } else { compiler }) {
            continue;
        }
        let compile_file = |file: &str, flags: &[&str]| {
            let mut command = Command::new(compiler);
            command.current_dir(&folder).args(["-O2", "-Wall", "-Werror", "-c", "-o", "twice.o", file]).args(flags);
            command.args(bare.then_some("-DSCARA_NO_MATH_H"));
            command
        };
        let compile = |flags: &[&str]| compile_file("twice.c", flags);
        let check_refused = |flags: &[&str]| {
            let output = compile(flags).output().expect("it is there");
            let told = String::from_utf8_lossy(&output.stderr).contains("compile without");
            assert!(!output.status.success() && told, "{compiler} {flags:?}");
        };
        let run = |flags: &[&str]| {
            let mut command = Command::new(compiler);
            succeed(
                command.current_dir(&folder).args(["-O2", "-ffp-contract=off", "-o", "caller", "caller.c", "-lm"]).args(flags),
            );
            Command::new(folder.join("caller")).output().expect("it was compiled").stdout
        };
        check_refused(&["-ffast-math"]);
        check_refused(&["-Ofast"]);
        for (flag, _) in OTHER_NUMBERS.iter().filter(|(_, told_by)| told_by.contains(&compiler)) {
            check_refused(&[flag]);
        }
        for flags in [&[][..], &["-O3"], &["-Os", "-std=c99"]] {
            succeed(&mut compile(flags));
        }
        let plain = (compiler == "clang").then(|| run(&[]));
        for flags in PARTS_OF_FAST_MATH {
            match &plain {
                None => check_refused(flags),
                Some(plain) => assert_eq!(run(flags), *plain, "{compiler} {flags:?}"),
            }
        }
        for file in ["twice.c", "fused.c"] {
            succeed(&mut compile_file(file, &["-DSCARA_NO_MATH_H", "-nostdinc", "-ffreestanding"]));
        }
        succeed(&mut compile_file("fused.c", &[]));
    }
}
