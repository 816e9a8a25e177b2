#!/usr/bin/env python3
"""What `armgen generate --fma` gives: every function with fused operations beside itself without, by rustc, gcc and clang, for this machine.

    ./fused.py                                   everything; minutes
    ./fused.py --armgen PROGRAM --rounds 101     with a built armgen, steadier figures
    ./fused.py --csv ../results/fused.csv              the ratios as CSV, too

A figure is how many times as fast the fused function is: the median over the rounds of bench.cpp of the ratio within each round.
"""
import argparse
import os
import pathlib
import shutil
import statistics
import sys

import run

ROBOTS = ["scara4", "panda7", "iiwa14"]
COMPILERS = {"gcc": run.C, "clang": ("CLANG", "clang")}
FORMS = {"plain": (), "fused": ("--fma",)}
# As `target-cpu=native` of rustc: without more fusing than is written, which the header forbids.
C_FLAGS = ["-std=gnu11", "-O3", "-march=native", "-fno-semantic-interposition", "-fPIC", "-shared"]
TOLERANCE = 1e-9


def options():
    names = lambda text: text.split(",")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--venv", type=pathlib.Path, help="Python environment with what requirements.txt lists; one is made if not given")
    parser.add_argument("--armgen", type=pathlib.Path, help="the built program; cargo builds it if not given")
    parser.add_argument("--robots", type=names, default=ROBOTS, help="names in robots/, separated by commas")
    parser.add_argument("--functions", type=names, default=run.FUNCTIONS, help="names of functions, separated by commas")
    parser.add_argument("--rounds", type=run.positive, default=61)
    parser.add_argument("--csv", type=pathlib.Path, help="CSV file for the ratios")
    return parser.parse_args()


def header_library(armgen, robot, functions, form, compiler):
    """The header of an arm as a library: its functions, which are static in a header, are what it exports."""
    folder = run.BUILD / "fused"
    header, source = folder / f"{robot}-{form}.h", folder / f"{robot}-{form}.c"
    run.generate(armgen, robot, functions, header, "--language", "c", *FORMS[form])
    count = f"{robot.upper()}_BASE_PARAMETERS"
    columns = f"\n#ifdef {count}\nint {robot}_base_parameters(void) {{ return {count}; }}\n#endif\n"
    source.write_text(header.read_text().replace("\nstatic inline ", "\n") + columns)
    return run.compiled(folder / f"{robot}-{form}-{compiler}.so", source, COMPILERS[compiler], C_FLAGS, ["-lm"])


def libraries(chosen):
    """The libraries of each arm by compiler and form, each with what its functions begin with."""
    crates = {form: run.emit(chosen.armgen, chosen.robots, chosen.functions, f"emitted-{form}", flags) for form, flags in FORMS.items()}
    rust = {form: run.emitted_library(crate, "native") for form, crate in crates.items()}
    there = [compiler for compiler, names in COMPILERS.items() if shutil.which(os.environ.get(*names))]
    for robot in chosen.robots:
        own = {("rustc", form): library for form, library in rust.items()}
        own |= {(compiler, form): header_library(chosen.armgen, robot, chosen.functions, form, compiler)
                for compiler in there for form in FORMS}
        yield robot, own


def race(bench, robot, own, rounds):
    """How many times as fast each function is when it is fused, by function and compiler."""
    import model

    states = run.BUILD / f"{robot}.states"
    states.write_text(run.states_text(model.read_arm(run.description(robot))))
    peers = [f"{compiler}-{form}={library}:{robot}_" for (compiler, form), library in own.items()]
    ratios = {}
    for case in run.measure(bench, states, rounds, peers[0].split("=")[1], peers):
        errors = {name: peer["error"] for name, peer in case["peers"].items() if "error" in peer}
        wrong = [name for name, error in errors.items() if not error <= TOLERANCE]
        if wrong:
            sys.exit(f"WRONG VALUES: {robot} {case['function']}: {errors}")
        for compiler in dict.fromkeys(compiler for compiler, _ in own):
            plain, fused = (case["peers"][f"{compiler}-{form}"]["ns"] for form in FORMS)
            ratios[case["function"], compiler] = statistics.median(a / b for a, b in zip(plain, fused))
    return ratios


def main():
    chosen = options()
    run.enter_environment(chosen.venv)
    bench = run.compiled(run.BUILD / "bench", run.HERE / "bench.cpp", run.CXX, ["-std=c++17", "-O2"], ["-ldl"])
    ratios = {robot: race(bench, robot, own, chosen.rounds) for robot, own in libraries(chosen)}
    compilers = list(dict.fromkeys(compiler for all in ratios.values() for _, compiler in all))
    lines = [["function", *(f"{compiler}: {' / '.join(chosen.robots)}" for compiler in compilers)]]
    for function in chosen.functions:
        cells = [" / ".join(f"{ratios[robot][function, compiler]:.2f}" for robot in chosen.robots) for compiler in compilers]
        lines.append([f"`{function}`", *cells])
    every = [[ratio for all in ratios.values() for (_, own), ratio in all.items() if own == compiler] for compiler in compilers]
    lines.append(["geometric mean", *(f"{statistics.geometric_mean(ratios):.2f}" for ratios in every)])
    print(run.aligned(lines))
    print(f"{run.processor_and_compilers()}; the median over {chosen.rounds} rounds")
    if chosen.csv:
        cells = [["function", "compiler", *chosen.robots]]
        for function in chosen.functions:
            cells += [[function, c, *(f"{ratios[robot][function, c]:.2f}" for robot in chosen.robots)] for c in compilers]
        chosen.csv.write_text("".join(",".join(line) + "\n" for line in cells))


if __name__ == "__main__":
    main()
