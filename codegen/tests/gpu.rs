//! Headers for CUDA and HIP: compilers take them without a warning, and fuse nothing where they are told not to. No GPU is needed.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use armgen_codegen::emit::Language;
use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::{generate, Generated, Scalar, Trig};

use crate::inverse_kinematics::installed;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The program `nvcc`, or that of the environment's `NVCC`, as the packages of PyPI have it in a folder of their own.
fn nvcc() -> Option<String> {
    let program = std::env::var("NVCC").unwrap_or_else(|_| "nvcc".to_owned());
    installed::there(&program, "nvidia-cuda-toolkit, or nvidia-cuda-nvcc of PyPI and NVCC=.../bin/nvcc").then_some(program)
}

/// A clang with the headers of HIP, and its options.
fn hip() -> Option<(&'static str, Vec<&'static str>)> {
    let clang = ["clang", "clang-14"].into_iter().find(|program| installed::runs(program, &["--version"]));
    if clang.is_none() || !Path::new("/usr/include/hip/hip_runtime.h").exists() {
        installed::left_out("no clang with the headers of HIP here (Debian: clang, libamdhip64-dev)");
        return None;
    }
    let options = ["-x", "hip", "-std=c++14", "-fsyntax-only", "--offload-arch=gfx90a", "-nogpulib", "--rocm-path=/usr"];
    let warnings = ["-D__HIP_PLATFORM_AMD__", "-Wall", "-Wextra", "-Werror"];
    Some((clang?, options.into_iter().chain(warnings).collect()))
}

fn robot(path: &Path, scalar: Scalar, fuse: bool) -> Generated {
    let source = Source::new("robot.yaml", std::fs::read_to_string(path).expect("a robot"));
    generate(&source, &Options { scalar, trig: Trig::Fast, fuse, ..Options::default() }).0.expect("a valid robot")
}

/// Writes the headers of a robot and a program that launches the functions with these names, all if there are none; its path.
fn written(folder: &str, generated: &Generated, scalar: Scalar, ik: bool, functions: &[&str]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a file can be written");
    let (name, text) = (generated.name(), generated.in_language(Language::Cuda));
    write("robot.cuh", &text);
    let real = if scalar == Scalar::F64 { "double" } else { "float" };
    let mut caller = "#include \"robot.cuh\"\n#include \"robot.cuh\"\n".to_owned();
    if ik {
        let ik = generated.inverse_kinematics_in_c().expect("no fault of the translation");
        write("robot_ik.h", &ik);
        caller += "#include \"robot_ik.h\"\n";
        if ik.contains("_inverse_kinematics(\n") {
            let redundancy = if ik.contains(" redundancy,\n") { "t[16], " } else { "" };
            let _ = writeln!(
                caller,
                "__global__ void postures(const {real} *t, {real} *q)\n{{\n    {real} pose[4][4];\n    {name}_solutions found;\n    \
                 for (int i = 0; i < 16; ++i) {{\n        pose[i / 4][i % 4] = t[i];\n    }}\n    \
                 {name}_inverse_kinematics(pose, {redundancy}&found);\n    q[0] = found.all[0].q[0];\n}}"
            );
        }
    }
    let _ = writeln!(caller, "int run(size_t states, {real} *a)\n{{\n    int errors = 0;");
    let launch = format!("{name}_status {name}_launch_");
    let mut launched = 0;
    for declared in text.split(&launch).skip(1) {
        let (function, rest) = declared.split_once("(\n").expect("arguments");
        let arrays = rest.split(")\n").next().expect("the end of the arguments").matches('*').count();
        if functions.is_empty() || functions.contains(&function) {
            let arrays: Vec<String> = (0..arrays).map(|i| format!("a + {i} * 1000 * states")).collect();
            let _ = writeln!(caller, "    errors += {name}_launch_{function}(states, states, {}, 0) != 0;", arrays.join(", "));
            launched += 1;
        }
    }
    assert!(launched > 0 && launched >= functions.len());
    caller += "    return errors;\n}\n";
    write("caller.cu", &caller);
    folder.join("caller.cu")
}

/// The output of a command that succeeds without a word.
#[track_caller]
fn silent(command: &mut Command) {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && said.trim().is_empty(), "{command:?}: {}\n{said}", output.status);
}

const STRICT: [&str; 6] = ["-std=c++14", "-arch=sm_80", "-Werror", "all-warnings", "-Xcompiler", "-Wall"];
const UNFUSED: [&str; 2] = ["-fmad=false", "-DARMGEN_FMAD=0"];

/// The program in the device's assembly.
#[track_caller]
fn assembly(nvcc: &str, caller: &Path, options: &[&str]) -> String {
    let to = caller.with_extension("ptx");
    silent(Command::new(nvcc).args(STRICT).args(options).arg("-ptx").arg(caller).arg("-o").arg(&to));
    std::fs::read_to_string(&to).expect("the assembly")
}

/// Some 10 s of a processor.
#[test]
#[ignore = "wide"]
fn nvcc_takes_the_header_and_fuses_what_it_should() {
    let Some(nvcc) = nvcc() else { return };
    let path = workspace().join("robots/scara.yaml");
    let caller = written("gpu_nvcc", &robot(&path, Scalar::F32, false), Scalar::F32, true, &["inverse_dynamics"]);
    silent(Command::new(&nvcc).args(STRICT).args(UNFUSED).arg("-c").arg(&caller).arg("-o").arg(caller.with_extension("o")));
    // The caller of the documentation.
    let page = std::fs::read_to_string(workspace().join("docs/gpu.md")).expect("the page");
    let shown = page.split("```cpp\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a caller");
    let of_page = caller.with_file_name("shown.cu");
    std::fs::write(&of_page, shown).expect("a file can be written");
    std::fs::write(caller.with_file_name("scara.cuh"), robot(&path, Scalar::F64, false).in_language(Language::Cuda))
        .expect("written");
    silent(Command::new(&nvcc).args(STRICT).args(UNFUSED).arg("-c").arg(&of_page).arg("-o").arg(of_page.with_extension("o")));
    let output = Command::new(&nvcc).args(STRICT).arg("-E").arg(&caller).output().expect("it runs");
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("add -fmad=false -DARMGEN_FMAD=0"));
    // Sines of large angles are those of the library, which fuses.
    let caller = written("gpu_ptx", &robot(&path, Scalar::F64, false), Scalar::F64, false, &["inverse_dynamics"]);
    let alone = [UNFUSED[0], UNFUSED[1], "-DSCARA_NO_MATH_H"];
    assert!(!assembly(&nvcc, &caller, &alone).contains("fma.rn"));
    assert!(assembly(&nvcc, &caller, &["-DARMGEN_FMAD=1", "-DSCARA_NO_MATH_H"]).contains("fma.rn"));
    let caller = written("gpu_fma", &robot(&path, Scalar::F64, true), Scalar::F64, false, &["inverse_dynamics"]);
    assert!(assembly(&nvcc, &caller, &UNFUSED).contains("fma.rn"));
}

#[test]
#[ignore = "wide"]
fn the_front_end_of_hip_takes_the_header() {
    let Some((clang, options)) = hip() else { return };
    for (scalar, name) in [(Scalar::F64, "scara"), (Scalar::F32, "ur5")] {
        let path = workspace().join(format!("robots/{name}.yaml"));
        let caller = written(&format!("gpu_hip_{name}"), &robot(&path, scalar, false), scalar, true, &[]);
        silent(Command::new(clang).args(&options).arg(caller));
    }
}

/// Every robot, in both scalars, with and without inverse kinematics, all functions.
///
/// `cargo test --release -p armgen-codegen --test all -- --ignored --nocapture compilers_for_gpus_take_all_robots`.
#[test]
#[ignore = "full: takes minutes"]
fn compilers_for_gpus_take_all_robots() {
    let (nvcc, hip) = (nvcc(), hip());
    let robots = std::fs::read_dir(workspace().join("robots")).expect("the robots").map(|file| file.expect("a file").path());
    let descriptions = robots.filter(|path| path.extension().is_some_and(|kind| kind == "yaml"));
    for path in descriptions.chain([workspace().join("robot.yaml")]) {
        let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
        for (scalar, bits) in [(Scalar::F64, 64), (Scalar::F32, 32)] {
            let generated = robot(&path, scalar, false);
            for ik in [false, true] {
                let caller = written(&format!("gpu_all_{stem}_{bits}_{ik}"), &generated, scalar, ik, &[]);
                if let Some(nvcc) = &nvcc {
                    // Without the last stage, which is of the device's assembler and takes minutes.
                    silent(
                        Command::new(nvcc)
                            .args(STRICT)
                            .args(UNFUSED)
                            .arg("-ptx")
                            .arg(&caller)
                            .arg("-o")
                            .arg(caller.with_extension("ptx")),
                    );
                    silent(
                        Command::new(nvcc)
                            .args(STRICT)
                            .args(UNFUSED)
                            .arg("-cuda")
                            .arg(&caller)
                            .arg("-o")
                            .arg(caller.with_extension("ii")),
                    );
                }
                if let Some((clang, options)) = &hip {
                    silent(Command::new(clang).args(options).arg(&caller));
                }
                println!(
                    "{stem}, {bits} bits, inverse kinematics {ik}: {} bytes",
                    std::fs::metadata(&caller).map_or(0, |file| file.len())
                );
            }
        }
    }
}
