"""States a second of the emitted Python module on a GPU, under torch and jax, beside a copy of the same bytes.

    armgen generate robots/panda7.yaml --language python --scalar f32 --out modules/panda_f32.py      # likewise ur5, scara, and f64
    python3 benches/gpu/python.py --modules modules --out results torch panda f32 inverse_dynamics eager compiled by_joint

Appends lines to `results/python.csv`, a line for each variant and batch. Several runs may go on at once: they compile beside one another and take turns
to measure. Without a GPU it runs on the processor, which tests this script; `--batches` makes it short.

| variant | torch | jax |
|---|---|---|
| `eager` | each operation is a kernel | not measured |
| `compiled` | `torch.compile(f, fullgraph=True, dynamic=True)` | `jax.jit(f)` |
| `by_joint` | the same of `robot.by_joint(f)`: arrays by joint | the same of `robot.by_joint(f)` |
| `by_joint_stacked` | the same, with results stacked along the first axis | the same |
| `unfused` | `by_joint` without fused multiplications and additions, which has NumPy's bits | |
| `wide` | `by_joint` with `max_fusion_size` 1024 | |
| `static` | `by_joint` with `dynamic=False` | |
| `graphs` | `compiled` with `mode="reduce-overhead"`: for small batches | |
| `short_sines` | | `by_joint` without the library's sines beyond the range of the module's |
| `option:NAME=VALUE` | | `by_joint` with an option of XLA |

The column `copy` has the states a second of a copy that reads and writes as many bytes. `differ` counts the entries, of 100 000 states, whose bits are not
those of NumPy, and `largest` has their largest difference, over the largest entry of the result.
"""

import argparse
import contextlib
import csv
import fcntl
import glob
import gzip
import importlib
import inspect
import json
import os
import re
import sys
import tempfile
import time

import numpy as np

COMPARED = 100_000
COLUMNS = (
    "library version device robot scalar function variant batch states_a_second microseconds copy ratio compile_seconds kernels differ compared largest"
).split()


def parsed():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--modules", default="modules")
    parser.add_argument("--out", default=".")
    parser.add_argument("--batches", default="4194304,1048576,1024,256,16")
    parser.add_argument("--jax-batches", default="4194304", help="each is compiled by itself")
    for name in "library robot scalar function".split():
        parser.add_argument(name)
    parser.add_argument("variants", nargs="+")
    return parser.parse_args()


@contextlib.contextmanager
def alone(out):
    """Only one process measures."""
    with open(os.path.join(out, ".lock"), "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def states(module, function, batch):
    """States in the box of the documentation, the first of them the same for every batch."""
    rng = np.random.default_rng(1)
    lengths = [module.PARAMETERS if a == "pi" else module.DOF for a in inspect.signature(function).parameters]
    few = [rng.uniform(-3, 3, (COMPARED, length)).astype(module.DTYPE) for length in lengths]
    return [np.resize(array, (batch, array.shape[1])) for array in few]


def flat(result):
    """The entries of a nested result."""
    return [entry for part in result for entry in flat(part)] if isinstance(result, (tuple, list)) else [result]


def compared(found, expected, by_joint):
    """How many entries have other bits, of how many, and the largest difference, scaled."""
    count = min(COMPARED, found[0].shape[-1] if by_joint else found[0].shape[0])
    expected = expected[:count]
    if by_joint:
        found = np.stack([np.asarray(entry)[..., :count] for entry in found]) if len(found) > 1 else np.asarray(found[0])[..., :count]
        found = np.moveaxis(found.reshape(-1, count), 0, -1).reshape(expected.shape)
    else:
        found = np.asarray(found[0])[:count]
    bits = np.dtype(expected.dtype).str.replace("f", "u")
    differ = int(np.count_nonzero(found.view(bits) != np.ascontiguousarray(expected).view(bits)))
    return differ, expected.size, float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


class Torch:
    def __init__(self, _):
        import torch

        self.torch, self.gpu = torch, torch.cuda.is_available()
        self.version, self.batches = torch.__version__, "batches"
        self.device = torch.cuda.get_device_name() if self.gpu else "processor"
        import torch._inductor.config
        import torch._inductor.metrics

        self.metrics = torch._inductor.metrics

    def put(self, array):
        return self.torch.from_numpy(array).to("cuda" if self.gpu else "cpu")

    def back(self, result):
        return [entry.cpu().numpy() for entry in flat(result)]

    def wait(self, _):
        if self.gpu:
            self.torch.cuda.synchronize()

    def variant(self, module, function, variant):
        torch = self.torch
        options = {"fullgraph": True, "dynamic": variant != "static"}
        if variant == "eager":
            return function
        if variant == "compiled":
            return torch.compile(function, **options)
        if variant == "graphs":
            return torch.compile(function, fullgraph=True, dynamic=False, mode="reduce-overhead")
        joints = module.by_joint(function)
        if variant == "by_joint_stacked":
            return torch.compile(lambda *arguments: torch.stack(flat(joints(*arguments))), **options)
        if variant == "unfused":
            options["options"] = {"emulate_precision_casts": True, "eager_numerics.division_rounding": True}
        if variant == "wide":
            options["options"] = {"max_fusion_size": 1024}
        if variant in ("by_joint", "static", "unfused", "wide"):
            return torch.compile(joints, **options)
        raise ValueError(variant)

    def compile(self, function, arguments, name, out):
        self.metrics.reset()
        begin = time.perf_counter()
        try:
            from torch._inductor.utils import run_and_get_code

            _, code = run_and_get_code(function, *arguments)
            with open(os.path.join(out, f"{name}.triton.py"), "w", encoding="utf-8") as file:
                file.write("\n# ---\n".join(code))
        except Exception as error:  # No code is shown, or nothing was compiled.
            print(name, repr(error)[:300], flush=True)
            function(*arguments)
        self.wait(None)
        return function, time.perf_counter() - begin, self.metrics.generated_kernel_count

    def times(self, function, arguments, rounds):
        if not self.gpu:
            return wall(self, function, arguments, rounds)
        begin, end = (self.torch.cuda.Event(enable_timing=True) for _ in range(2))
        begin.record()
        for _ in range(rounds):
            function(*arguments)
        end.record()
        self.torch.cuda.synchronize()
        return begin.elapsed_time(end) * 1e-3 / rounds

    def copy(self, entries, dtype):
        source = self.torch.zeros(entries, dtype=getattr(self.torch, dtype), device="cuda" if self.gpu else "cpu")
        target = self.torch.empty_like(source)
        return (lambda: target.copy_(source)), ()

    def kernels(self, function, arguments, name, out):
        """Kernels of a call, with their times."""
        from torch.profiler import ProfilerActivity, profile

        with profile(activities=[ProfilerActivity.CUDA]) as seen:
            function(*arguments)
            self.wait(None)
        return [(event.key, event.count, event.device_time_total) for event in seen.key_averages()]


class Jax:
    def __init__(self, scalar):
        import jax

        jax.config.update("jax_enable_x64", scalar == "f64")
        # A call after `compile` finds the program there.
        jax.config.update("jax_compilation_cache_dir", tempfile.mkdtemp())
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
        self.jax, self.version, self.batches = jax, jax.__version__, "jax_batches"
        self.device = jax.devices()[0].device_kind
        self.gpu = jax.default_backend() != "cpu"

    def put(self, array):
        return self.jax.numpy.asarray(array)

    def back(self, result):
        return [np.asarray(entry) for entry in flat(result)]

    def wait(self, result):
        self.jax.block_until_ready(result)

    def variant(self, module, function, variant):
        jax = self.jax
        options = None
        if variant == "compiled":
            return jax.jit(function)
        joints = module.by_joint(function)
        if variant == "short_sines":
            module._all = lambda xp, inside: True
        if variant == "by_joint_stacked":
            return jax.jit(lambda *arguments: jax.numpy.stack(flat(joints(*arguments))))
        if variant.startswith("option:"):
            options = dict([variant.removeprefix("option:").split("=")])
        if variant in ("by_joint", "short_sines") or options:
            return jax.jit(joints, compiler_options=options)
        raise ValueError(variant)

    def compile(self, function, arguments, name, out):
        begin = time.perf_counter()
        compiled = function.lower(*arguments).compile()
        seconds = time.perf_counter() - begin
        text = compiled.as_text()
        with open(os.path.join(out, f"{name}.hlo"), "w", encoding="utf-8") as file:
            file.write(text)
        entry = text[text.index("ENTRY") :]
        words = "fusion copy transpose concatenate custom-call".split()
        counts = {word: len(re.findall(rf" {word}\(", entry)) for word in words}
        print(name, {word: count for word, count in counts.items() if count}, flush=True)
        return function, seconds, sum(counts.values())

    def times(self, function, arguments, rounds):
        return wall(self, function, arguments, rounds)

    def copy(self, entries, dtype):
        source = self.jax.numpy.zeros(entries, dtype=dtype)
        return self.jax.jit(lambda x: x * 1.5), (source,)

    def kernels(self, function, arguments, name, out):
        folder = os.path.join(out, f".trace_{name}")
        with self.jax.profiler.trace(folder):
            self.wait(function(*arguments))
        found = {}
        for path in glob.glob(folder + "/**/*.trace.json.gz", recursive=True):
            with gzip.open(path) as file:
                events = json.load(file)["traceEvents"]
            threads = {(e["pid"], e.get("tid")): e["args"]["name"] for e in events if e.get("name") == "thread_name"}
            for event in events:
                if "dur" in event and "Stream" in threads.get((event["pid"], event.get("tid")), ""):
                    count, time_ = found.get(event["name"], (0, 0))
                    found[event["name"]] = count + 1, time_ + event["dur"]
        return [(name, *values) for name, values in found.items()]


def wall(library, function, arguments, rounds):
    begin = time.perf_counter()
    for _ in range(rounds):
        result = function(*arguments)
    library.wait(result)
    return (time.perf_counter() - begin) / rounds


def least(library, function, arguments, seconds=0.15):
    """Seconds of a call: the least mean of four series."""
    for _ in range(3):
        library.wait(function(*arguments))
    once = library.times(function, arguments, 2)
    rounds = max(2, min(500, int(seconds / 4 / max(once, 1e-7))))
    return min(library.times(function, arguments, rounds) for _ in range(4))


def main():
    given = parsed()
    sys.path.insert(0, given.modules)
    os.makedirs(given.out, exist_ok=True)
    library = {"torch": Torch, "jax": Jax}[given.library](given.scalar)
    module = importlib.import_module(f"{given.robot}_{given.scalar}")
    function = getattr(module, given.function)
    few = states(module, function, COMPARED)
    expected = function(*few)
    entries = sum(array.shape[1] for array in few) + expected[0].size
    table = os.path.join(given.out, "python.csv")
    for variant in given.variants:
        batches = [int(batch) for batch in getattr(given, library.batches).split(",")]
        if variant == "graphs":
            batches = [batch for batch in batches if batch <= 1024]
        by_joint = variant not in ("eager", "compiled", "graphs")
        built, wanted = None, None
        for batch in batches:
            name = re.sub(r"\W+", "_", f"{given.library}_{given.robot}_{given.scalar}_{given.function}_{variant}_{batch}")
            try:
                arrays = states(module, function, batch)
                arguments = [library.put(np.ascontiguousarray(array.T) if by_joint else array) for array in arrays]
                if built is None or given.library == "jax" or variant in ("static", "graphs"):
                    built = library.variant(module, function, variant)
                    if variant == "eager":
                        seconds, kernels = 0.0, 0
                    else:
                        built, seconds, kernels = library.compile(built, arguments, name, given.out)
                differ, of, largest = compared(library.back(built(*arguments)), expected, by_joint)
                with alone(given.out):
                    call = least(library, built, arguments)
                    copy, source = library.copy(batch * entries // 2, module.DTYPE)
                    copied = least(library, copy, source)
                    if wanted is None and library.gpu:
                        wanted = library.kernels(built, arguments, name, given.out)
                        with open(os.path.join(given.out, f"{name}.kernels"), "w", encoding="utf-8") as file:
                            file.writelines(f"{micro:10.1f} us {count:5} {kernel[:150]}\n" for kernel, count, micro in wanted)
                    row = [given.library, library.version, library.device, given.robot, given.scalar, given.function, variant, batch]
                    row += [f"{batch / call:.4g}", f"{call * 1e6:.4g}", f"{batch / copied:.4g}", f"{copied / call:.3f}", f"{seconds:.1f}"]
                    row += [kernels, differ, of, f"{largest:.2g}"]
                    new = not os.path.exists(table)
                    with open(table, "a", newline="", encoding="utf-8") as file:
                        writer = csv.writer(file, lineterminator="\n")
                        if new:
                            writer.writerow(COLUMNS)
                        writer.writerow(row)
                print(*row, flush=True)
                del arguments, copy, source
            except Exception as error:  # The other variants go on.
                print("failed:", name, type(error).__name__, str(error)[-1500:], flush=True)


if __name__ == "__main__":
    main()
