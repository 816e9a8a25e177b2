#!/usr/bin/env python3
"""Times the functions of a Panda in every language in one run and writes the table of docs/languages.md.

    cargo build --release -p armgen && python3 benches/languages.py target/release/armgen

Needs Python with NumPy; what else is not there (rustc, gcc, clang, node, octave-cli, torch, jax) is left out with a line that says so.
Further arguments are other Pythons, for libraries that this one lacks: `... target/release/armgen ~/jax/bin/python`.
"""

import os
import pathlib
import platform
import shutil
import subprocess
import sys
import tempfile
import time

try:
    import numpy as np
except ImportError:
    # The system's Python may have it where another stands first in the path.
    if sys.executable == "/usr/bin/python3" or not os.path.exists("/usr/bin/python3"):
        sys.exit("no NumPy here (Debian: python3-numpy)")
    os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "languages.md"
FUNCTIONS = {"gravity": 1, "inertia_matrix": 1, "inverse_dynamics": 3}
BEGIN, END = "<!-- numbers: benches/languages.py -->\n", "<!-- end of numbers -->\n"
STATES = 1000
ROUNDS = 300
REPEATED = 5
RUST_PLAIN = "Rust, `--trig fast`, one state"
RUST_NATIVE = "Rust, `--trig fast`, one state, for this processor"
# XLA takes minutes for what this pass makes of long functions.
WITHOUT_FUSION = {"xla_disable_hlo_passes": "fusion"}

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

CALLER = """
#include "robot.h"
void call(const double *q, double *tau) { panda7_gravity(q, tau); }
"""

ARRAYS = """
import sys, time
import numpy as np
library, module, options = sys.argv[1], __import__(sys.argv[2]), eval(sys.argv[3])
rng = np.random.default_rng(1)
many = [rng.uniform(-3, 3, (100_000, 7)) for _ in range(3)]
def least(run):
    best = float("inf")
    for _ in range(10):
        start = time.process_time()
        run()
        best = min(best, time.process_time() - start)
    return best * 1e9 / 100_000
if library == "torch":
    import torch
    torch.set_num_threads(1)
    many = [torch.from_numpy(states) for states in many]
    numbers = [least(lambda f=f, n=n: getattr(module, f)(*many[:n])) for f, n in @FUNCTIONS@.items()]
else:
    import jax
    jax.config.update("jax_enable_x64", True)
    many = [jax.numpy.asarray(states) for states in many]
    compiled = {f: jax.jit(getattr(module, f), compiler_options=options) for f in @FUNCTIONS@}
    numbers = [least(lambda f=f, n=n: jax.block_until_ready(compiled[f](*many[:n]))) for f, n in @FUNCTIONS@.items()]
print(sys.modules[library].__version__, *numbers)
"""

JIT = """
import inspect, sys, time
import jax
import numpy as np
import robot
jax.config.update("jax_enable_x64", True)
zeros = jax.numpy.zeros((1000, 7))
taken = {}
for name in sys.argv[2:] or [name for name in robot.__all__ if inspect.isfunction(getattr(robot, name)) and name != "by_joint"]:
    function = getattr(robot, name)
    names = inspect.signature(function).parameters
    arguments = [jax.numpy.asarray(robot.NOMINAL_PARAMETERS) if name == "pi" else zeros for name in names]
    start = time.process_time()
    jax.jit(function, compiler_options=eval(sys.argv[1])).lower(*arguments).compile()
    taken[name] = time.process_time() - start
longest = max(taken, key=taken.get)
print(longest, taken[longest], sum(taken.values()))
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


def least(run, rounds=10):
    best = float("inf")
    for _ in range(rounds):
        # Processor time: a round is longer than what a busy machine gives in one piece.
        start = time.process_time()
        run()
        best = min(best, time.process_time() - start)
    return best * 1e9


def children(run):
    """Processor time of the programs that it runs, in s."""
    before = os.times()
    run()
    after = os.times()
    return after.children_user - before.children_user + after.children_system - before.children_system


def there(program):
    found = shutil.which(program) is not None
    if not found:
        print(f"left out: no {program} here")
    return found


class Bench:
    """A folder with the modules, rows of the table and sentences below it."""

    def __init__(self, armgen, pythons):
        self.armgen, self.pythons = pathlib.Path(armgen).resolve(), [sys.executable, *pythons]
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.rows, self.said = [], []

    def run(self, *command):
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}:\n{done.stderr}")
        return done.stdout.split()

    def generate(self, language, out, *more):
        self.run(self.armgen, "generate", ROOT / "robots" / "panda7.yaml", "--language", language, "--out", out, *more)

    def write(self, name, text):
        for word, value in [("@STATES@", STATES), ("@ROUNDS@", ROUNDS), ("@FUNCTIONS@", FUNCTIONS)]:
            text = text.replace(word, str(value))
        (self.folder / name).write_text(text, encoding="utf-8")

    def row(self, name, numbers):
        self.rows.append((name, [float(number) for number in numbers]))
        print(name, *(f"{float(number):.0f}" for number in numbers), flush=True)

    def say(self, sentence):
        self.said.append(sentence)
        print(sentence, flush=True)

    def least_of(self, commands):
        """The numbers that commands print, the least of several rounds; by turns, so that all see the machine busy and quiet."""
        rounds = [[[float(number) for number in self.run(*command)] for command in commands] for _ in range(REPEATED)]
        return [[min(numbers) for numbers in zip(*of_one)] for of_one in zip(*rounds)]

    def python_with(self, library):
        for python in self.pythons:
            if subprocess.run([python, "-c", f"import numpy, {library}"], capture_output=True, check=False).returncode == 0:
                return python
        print(f"left out: no Python with {library} here")
        return None


def rust_and_c(bench):
    programs = {}
    if there("rustc"):
        bench.write("libm.rs", "pub fn sincos(x: f64) -> (f64, f64) { x.sin_cos() }\n")
        bench.write("main.rs", RUST)
        bench.run("rustc", "--edition=2021", "-O", "-Awarnings", "--crate-type=rlib", "libm.rs")
        for name, flags in [(RUST_PLAIN, []), (RUST_NATIVE, ["-Ctarget-cpu=native"])]:
            out = f"main_{len(programs)}"
            extern = ["-Awarnings", "--extern", "libm=liblibm.rlib"]
            bench.run("rustc", "--edition=2021", "-Copt-level=3", *flags, *extern, "-o", out, "main.rs")
            programs[name] = [f"./{out}"]
    bench.write("main.c", C)
    for compiler in filter(there, ["gcc", "clang"]):
        for flags in [["-O2"], ["-O3", "-march=native"]]:
            out = f"main_{len(programs)}"
            bench.run(compiler, *flags, "main.c", "-lm", "-o", out)
            programs[f"C, {compiler} {' '.join(flags)}, one state"] = [f"./{out}"]
    torques = {}
    for name, numbers in zip(programs, bench.least_of(programs.values())):
        bench.row(name, numbers)
        torques[name] = numbers[2]
    for flags, rust, native in [("-O2", RUST_PLAIN, ""), ("-O3 -march=native", RUST_NATIVE, " for this processor")]:
        c = f"C, gcc {flags}, one state"
        if c in torques and rust in torques:
            ratio = torques[c] / torques[rust]
            bench.say(f"Inverse dynamics in C, gcc {flags}, take {ratio:.2f} times as long as in Rust{native}.")
    if there("gcc"):
        bench.write("caller.c", CALLER)
        compiling = lambda: bench.run("gcc", "-O2", "-c", "caller.c", "-o", "caller.o")
        taken = min(children(compiling) for _ in range(REPEATED))
        bench.say(f"A C file that calls one function of the header with all of them is compiled in {taken:.2f} s by gcc -O2.")


def node(bench):
    if there("node"):
        bench.write("main.mjs", NODE)
        [numbers] = bench.least_of([["node", "main.mjs"]])
        bench.row("JavaScript, Node, one state", numbers[:3])
        bench.say(f"Import and the first call of all functions take {numbers[3]:.0f} ms in Node.")


def python(bench):
    rng = np.random.default_rng(1)
    many = [rng.uniform(-3, 3, (100_000, 7)) for _ in range(3)]
    one = [states[0] for states in many]

    def rows(module, name):
        calls = [(getattr(module, function), count) for function, count in FUNCTIONS.items()]
        bench.row(f"{name}, 100 000 states", [least(lambda f=f, n=n: f(*many[:n])) / 1e5 for f, n in calls])
        bench.row(f"{name}, one state", [least(lambda f=f, n=n: [f(*one[:n]) for _ in range(100)]) / 100 for f, n in calls])

    sys.path.insert(0, str(bench.folder))
    rows(__import__("robot"), f"Python, NumPy {np.__version__}")
    if there("cc"):
        loaded = []
        kept = str(bench.folder / "kept")
        of_all = children(lambda: loaded.append(__import__("robot_native").load(folder=kept)))
        rows(loaded[0], "Python, `--native`")
        bench.generate("python", "three.py", "--native", "--functions", ",".join(FUNCTIONS))
        of_three = children(lambda: __import__("three_native").load(folder=kept))
        bench.say(f"`load()` compiles all functions in {of_all:.0f} s, the three of the table in {of_three:.1f} s, once.")


def libraries(bench):
    bench.write("arrays.py", ARRAYS)
    bench.write("jit.py", JIT)
    if torch := bench.python_with("torch"):
        version, *numbers = bench.run(torch, "arrays.py", "torch", "robot", "None")
        bench.row(f"Python, torch {version}, one thread, 100 000 states", numbers)
    if jax := bench.python_with("jax"):
        bench.generate("python", "robot_std.py", "--trig", "std")
        choices = [("robot", None, ""), ("robot", WITHOUT_FUSION, " without `fusion`"), ("robot_std", None, ", `--trig std`")]
        for module, options, name in choices:
            version, *numbers = bench.run(jax, "arrays.py", "jax", module, str(options))
            bench.row(f"Python, jax {version}, `jit`{name}, 100 000 states", numbers)
        of_torques = float(bench.run(jax, "jit.py", "None", "inverse_dynamics")[1])
        longest, taken, together = bench.run(jax, "jit.py", str(WITHOUT_FUSION))
        bench.say(
            f"`jax.jit` takes {of_torques:.1f} s for `inverse_dynamics`; without `fusion` {float(taken):.1f} s for the longest, "
            f"`{longest}`, and {float(together):.0f} s for all functions."
        )


def octave(bench):
    if there("octave-cli"):
        bench.write("main.m", OCTAVE)
        numbers = bench.run("octave-cli", "--no-init-file", "--eval", "main")
        bench.row("Octave, 100 000 states", numbers[:3])
        bench.row("Octave, one state", numbers[3:])


def write_page(bench):
    grouped = lambda number: f"{number:,.0f}".replace(",", " ")
    lines = ["| | gravity | B | inverse dynamics |", "|---|---:|---:|---:|"]
    lines += [f"| {name} | {' | '.join(map(grouped, numbers))} |" for name, numbers in bench.rows]
    load = pathlib.Path("/proc/loadavg")
    busy = f"at a load of {load.read_text().split()[0]}" if load.exists() else "load unknown"
    times = "nanoseconds a state, the least of several rounds, in Python and Octave of processor time, as are times of compilation."
    lines += ["", f"{platform.machine()}, {processor()}, {busy}, {times}", *bench.said]
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    PAGE.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n\n" + END + rest.split(END)[1], encoding="utf-8")


def main():
    bench = Bench(sys.argv[1], sys.argv[2:])
    np.random.default_rng(1).uniform(-3, 3, (STATES, 21)).tofile(bench.folder / "states")
    bench.generate("rust", "robot.rs", "--trig", "fast")
    bench.generate("c", "robot.h")
    bench.generate("javascript", "robot.mjs")
    bench.generate("python", "robot.py", "--native")
    bench.generate("matlab", "+robot")
    for part in [rust_and_c, node, python, libraries, octave, write_page]:
        part(bench)
    shutil.rmtree(bench.folder)


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "an unknown processor"


if __name__ == "__main__":
    main()
