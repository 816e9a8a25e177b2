#!/usr/bin/env python3
"""Times the emitted functions beside Pinocchio's and CasADi's, and compares their values; README.md says how.

    ./run.py                                    everything: environment, libraries, bench; minutes at the first time
    ./run.py --venv DIR --armgen PROGRAM        with a Python environment and a built armgen that are there already
    ./run.py --robots ur5,panda7 --rounds 101   fewer arms, steadier figures
    ./run.py --functions regressor,gravity      these alone
    ./run.py --cpu native                       compiled for this machine alone, not also for any of its kind
    ./run.py --out summary.md --csv table.csv   the summary as Markdown and the tables as CSV, too
"""
import argparse
import hashlib
import json
import math
import os
import pathlib
import platform
import random
import re
import shutil
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
PROJECT = HERE.parent.parent
BUILD = HERE / "build"
ROBOTS = ["scara4", "puma560", "ur5", "panda7", "iiwa14"]
FUNCTIONS = ["direct_kinematics", "geometric_jacobian", "inertia_matrix", "coriolis_matrix", "gravity", "equations_of_motion",
             "inverse_dynamics", "forward_dynamics", "regressor", "base_regressor", "inverse_dynamics_derivatives", "forward_dynamics_derivatives"]
STATES = 64
SEED = 20
TOLERANCE = 1e-9
# Below this a call costs about as much as its being called and timed.
SHORTEST_NS = 10
PROCESSES = 5
OURS = "armgen"

# What Pinocchio's own cmake files define for whoever uses the library. No -march: with wider vectors Eigen's classes would be laid out
# otherwise than in the library, which is compiled for any x86-64.
PINOCCHIO_FLAGS = ["-O3", "-DNDEBUG", "-w", "-DPINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION", "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
                   "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
# The wrappers are then the only callers of CasADi's functions, which the compiler merges into them.
CASADI_FLAGS = ["-O3", "-DCASADI_SYMBOL_EXPORT=static", "-Wno-unused-function"]

# What is compiled for: flags of the C compilers, and of rustc.
CPUS = {"native": (["-march=native"], "-Ctarget-cpu=native"), "baseline": ([], "")}

CARGO_TOML = """[package]
name = "emitted"
version = "0.0.0"
edition = "2021"

[lib]
crate-type = ["cdylib"]

[dependencies]
libm = "0.2"

[profile.release]
codegen-units = 1
lto = true
panic = "abort"

[workspace]
"""
MODULE = """#[allow(dead_code)]
mod {name} {{
    include!("{name}.rs");
    include!("{name}_c.rs");
}}
"""


def say(text):
    print(text, file=sys.stderr, flush=True)


def run(command, **options):
    return subprocess.run([str(word) for word in command], check=True, **options)


def positive(text):
    """A number of rounds."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not at least 1")
    return number


def options():
    names = lambda text: text.split(",")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--venv", type=pathlib.Path, help="Python environment with what requirements.txt lists; one is made if not given")
    parser.add_argument("--armgen", type=pathlib.Path, help="the built program; cargo builds it if not given")
    parser.add_argument("--eigen", type=pathlib.Path, help="folder with Eigen/Core, if the environment has not got it")
    parser.add_argument("--robots", type=names, default=ROBOTS, help="names in robots/, separated by commas")
    parser.add_argument("--functions", type=names, default=FUNCTIONS, help="names of functions, separated by commas")
    parser.add_argument("--cpu", type=names, default=list(CPUS), help="what is compiled for: native, baseline (any processor of the kind), or both")
    parser.add_argument("--rounds", type=positive, default=41)
    parser.add_argument("--out", type=pathlib.Path, help="Markdown file for the summary")
    parser.add_argument("--csv", type=pathlib.Path, help="CSV file for all tables")
    chosen = parser.parse_args()
    for option, known in (("cpu", CPUS), ("functions", FUNCTIONS)):
        unknown = [name for name in getattr(chosen, option) if name not in known]
        if unknown:
            parser.error(f"--{option} {unknown[0]}: known are {', '.join(known)}")
    return chosen


def enter_environment(venv):
    """Goes on in the environment that has the peers' packages, made with pip if none is named."""
    chosen = (venv or BUILD / "venv").absolute()
    if pathlib.Path(sys.prefix).resolve() == chosen.resolve():
        return
    python = chosen / "bin" / "python"
    if not python.exists():
        if venv:
            sys.exit(f"{venv} is not a Python environment: it has no bin/python")
        say("Python environment: pip installs the peers")
        run([sys.executable, "-m", "venv", chosen])
    if not venv:
        made(python, (HERE / "requirements.txt").read_text(),
             lambda: run([python, "-m", "pip", "install", "-q", "-r", HERE / "requirements.txt"]))
    os.execv(python, [str(python), *sys.argv])


def made(target, inputs, make):
    """Makes the target unless it was made from the same inputs; a file beside it keeps their fingerprint."""
    stamp, fingerprint = target.with_name(target.name + ".made"), hashlib.sha256(inputs.encode()).hexdigest()
    if not (target.exists() and stamp.exists() and stamp.read_text() == fingerprint):
        target.parent.mkdir(parents=True, exist_ok=True)
        make()
        stamp.write_text(fingerprint)
    return target


def compiled(target, source, compiler, flags, libraries=()):
    command = [os.environ.get(*compiler), *flags, source, "-o", target, *libraries]

    def make():
        say(f"compiling {target.name}")
        run(command)

    return made(target, " ".join(map(str, command)) + source.read_text(), make)


C, CXX = ("CC", "gcc"), ("CXX", "g++")


def pinocchio_prefix():
    """The folder of the wheel with include/ and lib/."""
    import pinocchio

    for folder in pathlib.Path(pinocchio.__file__).parents:
        if (folder / "include" / "pinocchio").is_dir():
            return folder
    sys.exit("Pinocchio's headers are not beside its Python package: the package `pin` of PyPI has them")


def pinocchio_library(eigen):
    prefix = pinocchio_prefix()
    eigen = eigen or prefix / "include" / "eigen3"
    if not (eigen / "Eigen" / "Core").exists():
        sys.exit(f"no Eigen/Core in {eigen}: install the package `cmeel-eigen` in the environment, or name a folder with --eigen")
    flags = ["-std=c++17", "-fPIC", "-shared", *PINOCCHIO_FLAGS, f"-I{eigen}", f"-I{prefix / 'include'}"]
    libraries = [f"-L{prefix / 'lib'}", f"-Wl,-rpath,{prefix / 'lib'}", "-lpinocchio_default", "-lboost_serialization"]
    return compiled(BUILD / "pinocchio.so", HERE / "pinocchio_peer.cpp", CXX, flags, libraries)


def description(robot):
    """The file of an arm: the project's, or one that is here for its joints alone."""
    return next((path for path in (folder / f"{robot}.yaml" for folder in (PROJECT / "robots", HERE)) if path.exists()), HERE / f"{robot}.yaml")


def base_parameters(module):
    """The names of the base parameters of an emitted module, and by how much the x axis of the last link is turned."""
    listed = re.search(r"BASE_PARAMETER_NAMES: \[&str; BASE_PARAMETERS\] = \[(.*?)\];", module, re.DOTALL).group(1)
    turned = re.search(r"The x axis of the last link stands (\S+) rad after the joint variable", module)
    return re.findall(r'"(\w+)"', listed), float(turned.group(1)) if turned else 0.0


def casadi_source(arm, module, functions):
    import casadi
    import casadi_peer

    source = BUILD / "casadi" / f"{arm.name}.c"
    derivation = pathlib.Path(casadi_peer.__file__).read_text()
    base = base_parameters(module) if "base_regressor" in functions else ([], 0.0)

    def derive():
        say(f"deriving {source.name} with CasADi")
        source.write_text(casadi_peer.c_text(arm, functions, *base))

    return made(source, casadi.__version__ + derivation + repr((arm, functions, base)), derive)


def casadi_libraries(source, cpu):
    """The same C by every compiler that is there."""
    libraries = {}
    for name, compiler in (("casadi", C), ("casadi-clang", ("CLANG", "clang"))):
        if shutil.which(os.environ.get(*compiler)):
            target = source.with_name(f"{source.stem}-{name}-{cpu}.so")
            libraries[name] = compiled(target, source, compiler, ["-fPIC", "-shared", *CASADI_FLAGS, *CPUS[cpu][0]], ["-lm"])
    return libraries


def generate(armgen, robot, functions, out, *options):
    """Writes a module of an arm."""
    program = [armgen.absolute()] if armgen else ["cargo", "run", "--release", "--quiet", "--"]
    out.parent.mkdir(parents=True, exist_ok=True)
    run([*program, "generate", description(robot), "--trig", "fast", "--functions", ",".join(functions), "--out", out, *options],
        cwd=PROJECT, stdout=subprocess.DEVNULL)


def emit(armgen, robots, functions, name="emitted", options=()):
    """The emitted modules of all arms and their faces for C, as the source of one library; its folder."""
    crate = BUILD / name
    for robot in robots:
        generate(armgen, robot, functions, crate / "src" / f"{robot}.rs", "--c-abi", *options)
    (crate / "Cargo.toml").write_text(CARGO_TOML)
    (crate / "src" / "lib.rs").write_text("".join(MODULE.format(name=robot) for robot in robots))
    return crate


def emitted_library(crate, cpu):
    say(f"compiling the emitted modules, {cpu}")
    target = crate / f"target-{cpu}"
    run(["cargo", "build", "--release", "--quiet"], cwd=crate, env=dict(os.environ, RUSTFLAGS=CPUS[cpu][1], CARGO_TARGET_DIR=str(target)))
    return next((target / "release").glob("libemitted.*[os]"))


def states_text(arm):
    """The stored states: joint variables, rates, accelerations; the same in every run."""
    source = random.Random(SEED)
    lines = [str(len(arm.joints))]
    for _ in range(STATES):
        lines.append(" ".join(repr(source.uniform(-1, 1) * (math.pi if joint.revolute else 0.3)) for joint in arm.joints))
        lines += [" ".join(repr(source.uniform(-limit, limit)) for _ in arm.joints) for limit in (2, 4)]
    return "\n".join([*lines, ""])


def measure(bench, states, rounds, reference, peers):
    """
    What the bench measured: for each function, every peer's nanoseconds by rounds and its largest error. The rounds are those of several
    processes: where memory lies in one of them can cost one function more than half of its time.
    """
    found, processes = {}, min(PROCESSES, rounds)
    for process in range(processes):
        # The sum of the shares is the number of rounds.
        share = str((rounds + process) // processes)
        for line in run([bench, states, share, "reference=" + reference, *peers], stdout=subprocess.PIPE, text=True).stdout.splitlines():
            measured = json.loads(line)
            case = found.setdefault(measured["function"], {"function": measured["function"], "peers": {}})
            for name, peer in measured["peers"].items():
                before = case["peers"].setdefault(name, {"ns": []})
                before["ns"] += peer["ns"]
                if "error" in peer:
                    before["error"] = max(before.get("error", 0.0), peer["error"])
    return list(found.values())


def race(bench, arm, libraries, rounds):
    """The cases of an arm."""
    import model

    states, chain = BUILD / f"{arm.name}.states", BUILD / f"{arm.name}.chain"
    states.write_text(states_text(arm))
    chain.write_text(model.chain_text(arm))
    pinocchio = f"{libraries['pinocchio']}:%s:{chain}"
    casadi = [f"{name}={library}:casadi_" for name, library in libraries.items() if name.startswith("casadi")]
    peers = [f"{OURS}={libraries[OURS]}:{arm.name}_", *casadi, "pinocchio=" + pinocchio % "call_"]
    return [dict(case, robot=arm.name) for case in measure(bench, states, rounds, pinocchio % "reference_", peers)]


def judge(case):
    """Adds the medians, the fastest peer, our ratio to it, and the largest error."""
    peers = case["peers"]
    case["ns"] = {name: statistics.median(peer["ns"]) for name, peer in peers.items()}
    case["fastest"] = fastest = min((name for name in peers if name != OURS), key=case["ns"].get)
    case["ratio"] = statistics.median(ours / theirs for ours, theirs in zip(peers[OURS]["ns"], peers[fastest]["ns"]))
    case["error"] = max(peer["error"] for peer in peers.values() if "error" in peer)
    case["counts"] = case["ns"][fastest] >= SHORTEST_NS
    return case


def rows(cases, names):
    yield ["function", *(f"{name}, ns" for name in names), f"{OURS} / fastest", "largest error"]
    for case in cases:
        times = [f"{case['ns'][name]:.1f}" if name in case["ns"] else "" for name in names]
        mark = "" if case["counts"] else " *"
        yield [case["function"], *times, f"{case['ratio']:.2f}{mark}", f"{case['error']:.0e}"]


def table(cases):
    names = list(dict.fromkeys(name for case in cases for name in case["peers"]))
    return list(rows(cases, names))


def aligned(lines):
    """The lines in columns, the first one to the left, the figures to the right."""
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    pad = lambda line: [line[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(line[1:], widths[1:]))]
    return "\n".join("  ".join(pad(line)) for line in lines)


def summary(cases):
    counted = [case for case in cases if case["counts"]]
    if not counted:
        return f"no case whose fastest peer needs {SHORTEST_NS} ns or more"
    mean = statistics.geometric_mean(case["ratio"] for case in counted)
    worst = max(counted, key=lambda case: case["ratio"])
    return (f"{OURS} / fastest peer: geometric mean {mean:.3f} ({1 / mean:.2f} times as fast), "
            f"worst {worst['ratio']:.2f} ({worst['robot']} {worst['function']}, {worst['fastest']}), {len(counted)} of {len(cases)} cases")


def version(command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]


def processor_and_compilers():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        processor = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        processor = platform.machine()
    compilers = [command for command in (os.environ.get(*C), os.environ.get("CLANG", "clang")) if shutil.which(command)]
    return ", ".join([processor, *(version([command, "--version"]) for command in (*compilers, "rustc"))])


def machine():
    import casadi
    import pinocchio

    return f"{processor_and_compilers()}, Pinocchio {pinocchio.__version__}, CasADi {casadi.__version__}"


def markdown(cases, rounds):
    measured = f"Median nanoseconds of a call over {rounds} rounds in {min(PROCESSES, rounds)} processes"
    text = [f"{machine()}.", f"{measured}; the ratio is the median of those of each round.", ""]
    for cpu in dict.fromkeys(case["cpu"] for case in cases):
        own = [case for case in cases if case["cpu"] == cpu]
        text.append(f"- Compiled for {'this machine' if cpu == 'native' else 'any x86-64'}: {summary(own)}")
    return "\n".join([*text, ""])


def comma_separated(cases):
    """All cases as CSV, by processor and arm."""
    names = list(dict.fromkeys(name for case in cases for name in case["peers"]))
    lines = [["cpu", "robot", "function", *(f"{name} ns" for name in names), f"{OURS} / fastest", "largest error"]]
    for case in cases:
        times = [f"{case['ns'][name]:.1f}" if name in case["ns"] else "" for name in names]
        lines.append([case["cpu"], case["robot"], case["function"], *times, f"{case['ratio']:.2f}", f"{case['error']:.0e}"])
    return "".join(",".join(line) + "\n" for line in lines)


def into(path, text):
    """Writes the tables to a file, in place of those between its marks if it has them."""
    before = path.read_text() if path.exists() else ""
    marks = [f"<!-- run.py writes {word} here -->" for word in ("from", "to")]
    if all(mark in before for mark in marks):
        text = before.split(marks[0])[0] + f"{marks[0]}\n\n{text}\n{marks[1]}" + before.split(marks[1])[1]
    path.write_text(text)


def main():
    chosen = options()
    enter_environment(chosen.venv)
    import model

    try:
        arms = {robot: model.read_arm(description(robot)) for robot in chosen.robots}
    except (model.Unsuitable, OSError) as reason:
        sys.exit(f"only arms of links alone can be compared: {reason}")
    pinocchio, crate = pinocchio_library(chosen.eigen), emit(chosen.armgen, chosen.robots, chosen.functions)
    bench = compiled(BUILD / "bench", HERE / "bench.cpp", CXX, ["-std=c++17", "-O2"], ["-ldl"])
    cases = []
    for cpu in chosen.cpu:
        ours = emitted_library(crate, cpu)
        for robot, arm in arms.items():
            source = casadi_source(arm, (crate / "src" / f"{robot}.rs").read_text(), chosen.functions)
            libraries = {"pinocchio": pinocchio, OURS: ours, **casadi_libraries(source, cpu)}
            measured = [judge(dict(case, cpu=cpu)) for case in race(bench, arm, libraries, chosen.rounds)]
            print(f"{robot}, {cpu}\n{aligned(table(measured))}\n", flush=True)
            cases += measured
    wrong = [case for case in cases if not case["error"] <= TOLERANCE]
    if chosen.out:
        into(chosen.out, markdown(cases, chosen.rounds))
    if chosen.csv:
        chosen.csv.write_text(comma_separated(cases))
    for case in wrong:
        errors = ", ".join(f"{name} {peer['error']:.1e}" for name, peer in case["peers"].items() if "error" in peer)
        print(f"WRONG VALUES: {case['robot']} {case['function']}: {errors}, at most {TOLERANCE:.0e} allowed")
    for cpu in chosen.cpu:
        print(f"{cpu}: {summary([case for case in cases if case['cpu'] == cpu])}")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
