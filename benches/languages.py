#!/usr/bin/env python3
"""Times the functions of a Panda in every language in one run and writes the table of docs/languages.md.

    cargo build --release -p armgen && python3 benches/languages.py target/release/armgen

Needs Python with NumPy; what else is not there (rustc, gcc, clang, node, octave-cli) is left out with a line that says so.
"""

import pathlib
import platform
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "languages.md"
FUNCTIONS = {"gravity": 1, "inertia_matrix": 1, "inverse_dynamics": 3}
BEGIN, END = "<!-- numbers: benches/languages.py -->\n", "<!-- end of numbers -->\n"
STATES = 1000
ROUNDS = 300

RUST = """
include!("robot.rs");
use std::time::Instant;
#[inline(never)] fn run_gravity(x: &[[f64; 7]; 3]) -> [f64; 7] { gravity(&x[0]) }
#[inline(never)] fn run_inertia_matrix(x: &[[f64; 7]; 3]) -> [[f64; 7]; 7] { inertia_matrix(&x[0]) }
#[inline(never)] fn run_inverse_dynamics(x: &[[f64; 7]; 3]) -> [f64; 7] { inverse_dynamics(&x[0], &x[1], &x[2]) }
fn least<T>(states: &[[[f64; 7]; 3]], run: fn(&[[f64; 7]; 3]) -> T) -> f64 {
    (0..@ROUNDS@).map(|_| {
        let start = Instant::now();
        states.iter().for_each(|x| { std::hint::black_box(run(std::hint::black_box(x))); });
        start.elapsed().as_nanos() as f64 / states.len() as f64
    }).fold(f64::INFINITY, f64::min)
}
fn main() {
    let bytes = std::fs::read("states").unwrap();
    let numbers: Vec<f64> = bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let states: Vec<[[f64; 7]; 3]> =
        numbers.chunks(21).map(|x| [x[..7].try_into().unwrap(), x[7..14].try_into().unwrap(), x[14..].try_into().unwrap()]).collect();
    println!("{} {} {}", least(&states, run_gravity), least(&states, run_inertia_matrix), least(&states, run_inverse_dynamics));
}
"""

C = """
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <time.h>
#include "robot.h"
double x[@STATES@][3][7], r[7], m[7][7];
__attribute__((noinline)) static void run_gravity(int k) { panda7_gravity(x[k][0], r); }
__attribute__((noinline)) static void run_inertia_matrix(int k) { panda7_inertia_matrix(x[k][0], m); }
__attribute__((noinline)) static void run_inverse_dynamics(int k) { panda7_inverse_dynamics(x[k][0], x[k][1], x[k][2], r); }
static double least(void (*run)(int))
{
    double best = 1e30;
    for (int round = 0; round < @ROUNDS@; ++round) {
        struct timespec a, b;
        clock_gettime(CLOCK_MONOTONIC, &a);
        for (int k = 0; k < @STATES@; ++k) {
            run(k);
            __asm__ volatile("" ::: "memory");
        }
        clock_gettime(CLOCK_MONOTONIC, &b);
        double t = ((double)(b.tv_sec - a.tv_sec) * 1e9 + (double)(b.tv_nsec - a.tv_nsec)) / @STATES@;
        best = t < best ? t : best;
    }
    return best;
}
int main(void)
{
    FILE *file = fopen("states", "rb");
    if (!file || fread(x, sizeof x, 1, file) != 1) return 1;
    printf("%g %g %g\\n", least(run_gravity), least(run_inertia_matrix), least(run_inverse_dynamics));
    return 0;
}
"""

NODE = """
import fs from "node:fs";
const start = performance.now();
const robot = await import("./robot.mjs");
const bytes = fs.readFileSync("states");
const all = new Float64Array(bytes.buffer, bytes.byteOffset, bytes.length / 8);
const states = Array.from({ length: @STATES@ }, (_, k) => [0, 7, 14].map((from) => Array.from(all.subarray(21 * k + from, 21 * k + from + 7))));
const zeros = new Array(7).fill(0);
for (const run of Object.values(robot)) {
    if (typeof run === "function") {
        const names = /\\(([^)]*)\\)/.exec(String(run))[1].split(", ");
        run(...names.map((name) => name === "pi" ? robot.NOMINAL_PARAMETERS : zeros));
    }
}
const first = performance.now() - start;
let sink = 0;
const least = (run) => {
    let best = Infinity;
    for (let round = 0; round < @ROUNDS@; ++round) {
        const start = performance.now();
        for (const x of states) sink += run(x).length;
        best = Math.min(best, (performance.now() - start) * 1e6 / states.length);
    }
    return best;
};
console.log(least((x) => robot.gravity(x[0])), least((x) => robot.inertiaMatrix(x[0])), least((x) => robot.inverseDynamics(...x)), first);
"""

OCTAVE = """
function main()
    all = rand(21, 100000);
    for times = [1, 200]
        x = all;
        if times > 1
            x = all(:, 1);
        end
        q = x(1:7, :); dq = x(8:14, :); ddq = x(15:21, :);
        rounds = 10;
        calls = {@() robot.gravity(q), @() robot.inertiaMatrix(q), @() robot.inverseDynamics(q, dq, ddq)};
        for call = calls
            best = Inf;
            for k = 1:rounds
                start = cputime();
                for i = 1:times
                    call{1}();
                end
                best = min(best, (cputime() - start) / times);
            end
            printf('%g ', best / size(x, 2) * 1e9);
        end
    end
end
"""


def filled(text):
    return text.replace("@STATES@", str(STATES)).replace("@ROUNDS@", str(ROUNDS))


def least(run, rounds=10):
    best = float("inf")
    for _ in range(rounds):
        # Processor time: a round is longer than what a busy machine gives in one piece.
        start = time.process_time()
        run()
        best = min(best, time.process_time() - start)
    return best * 1e9


def main():
    armgen = pathlib.Path(sys.argv[1]).resolve()
    folder = pathlib.Path(tempfile.mkdtemp())
    rows = []

    def there(program):
        found = shutil.which(program) is not None
        if not found:
            print(f"left out: no {program} here")
        return found

    def run(*command):
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}:\n{done.stderr}")
        return done.stdout.split()

    def row(name, numbers):
        rows.append((name, [float(number) for number in numbers[:3]]))
        print(name, *(f"{float(number):.0f}" for number in numbers), flush=True)

    def generate(language, out, *more):
        run(armgen, "generate", ROOT / "robots" / "panda7.yaml", "--language", language, "--trig", "fast", "--out", out, *more)

    rng = np.random.default_rng(1)
    rng.uniform(-3, 3, (STATES, 21)).tofile(folder / "states")
    generate("rust", "robot.rs")
    generate("c", "robot.h")
    generate("javascript", "robot.mjs")
    generate("python", "robot.py", "--native")
    generate("matlab", "+robot")

    if there("rustc"):
        (folder / "libm.rs").write_text("pub fn sincos(x: f64) -> (f64, f64) { x.sin_cos() }\n")
        (folder / "main.rs").write_text(filled(RUST))
        run("rustc", "--edition=2021", "-O", "-Awarnings", "--crate-type=rlib", "libm.rs")
        for flags in [[], ["-Ctarget-cpu=native"]]:
            run("rustc", "--edition=2021", "-Copt-level=3", *flags, "-Awarnings", "--extern", "libm=liblibm.rlib", "-o", "rust_main", "main.rs")
            row(f"Rust, `--trig fast`, one state{', for this processor' if flags else ''}", run("./rust_main"))
    (folder / "main.c").write_text(filled(C))
    for compiler, flags in [("gcc", ["-O2"]), ("gcc", ["-O3", "-march=native"]), ("clang", ["-O2"]), ("clang", ["-O3", "-march=native"])]:
        if there(compiler):
            compiled = time.perf_counter()
            run(compiler, *flags, "main.c", "-lm", "-o", "c_main")
            compiled = time.perf_counter() - compiled
            row(f"C, {compiler} {' '.join(flags)}, one state", run("./c_main") + [compiled])
    if there("node"):
        (folder / "main.mjs").write_text(filled(NODE))
        numbers = run("node", "main.mjs")
        row("JavaScript, Node, one state", numbers)
        first = float(numbers[3])
    sys.path.insert(0, str(folder))
    import robot

    many = [rng.uniform(-3, 3, (100_000, 7)) for _ in range(3)]
    one = [states[0] for states in many]

    def python(module, name):
        row(f"{name}, 100 000 states", [least(lambda f=f, n=n: getattr(module, f)(*many[:n])) / 1e5 for f, n in FUNCTIONS.items()])
        row(f"{name}, one state", [least(lambda f=f, n=n: [getattr(module, f)(*one[:n]) for _ in range(100)]) / 100 for f, n in FUNCTIONS.items()])

    python(robot, f"Python, NumPy {np.__version__}")
    if there("cc"):
        import robot_native

        start = time.perf_counter()
        fast = robot_native.load(folder=str(folder / "kept"))
        compiled = time.perf_counter() - start
        python(fast, "Python, `--native`")
    if there("octave-cli"):
        (folder / "main.m").write_text(OCTAVE)
        numbers = run("octave-cli", "--no-init-file", "--eval", "main")
        row("Octave, 100 000 states", numbers[:3])
        row("Octave, one state", numbers[3:])

    lines = ["| | gravity | B | inverse dynamics |", "|---|---:|---:|---:|"]
    lines += [f"| {name} | " + " | ".join(f"{number:,.0f}".replace(",", " ") for number in numbers) + " |" for name, numbers in rows]
    load = pathlib.Path("/proc/loadavg")
    busy = f" at a load of {load.read_text().split()[0]}" if load.exists() else ""
    lines += ["", f"{platform.machine()}, {processor()}, {busy.strip() or 'load unknown'}, nanoseconds a state, the least of several rounds, in Python and Octave of processor time."]
    if there("cc"):
        lines += [f"`load()` of all functions took {compiled:.0f} s, once."]
    if there("node"):
        lines += [f"Import and the first call of all functions took {first:.0f} ms in Node."]
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    PAGE.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n\n" + END + rest.split(END)[1], encoding="utf-8")
    shutil.rmtree(folder)


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "an unknown processor"


if __name__ == "__main__":
    main()
