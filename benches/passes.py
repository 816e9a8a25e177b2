#!/usr/bin/env python3
"""Counts the operations that each pass saves, and writes results/passes.csv; docs/passes.md repeats its first and its last line.

    cargo build --release -p armgen && benches/passes.py
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROBOTS = ["panda7", "puma560", "ur5"]
COLUMNS = {"inverse_dynamics": "τ", "inertia_matrix": "B", "coriolis_matrix": "C", "gravity": "g", "base_regressor": "Y"}


def count(robot, without):
    command = [ROOT / "target/release/armgen", "count", f"robots/{robot}.yaml", "--format", "json"]
    if without:
        command += ["--without", ",".join(without)]
    text = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    functions = json.loads(text)["functions"]
    return [functions[name]["mul"] + functions[name]["add"] for name in COLUMNS]


def main():
    table = ROOT / "benches/results/passes.csv"
    passes = [line.split(",")[0] for line in table.read_text().splitlines()[2:-1]]
    titles = [f"{robot} {title}" for robot in ROBOTS for title in COLUMNS.values()]
    lines = [",".join(["passes", *titles])]
    for name, without in [("all", []), *((name, [name]) for name in passes), ("none", passes)]:
        print(f"\rcounting: {name:20}", end="", file=sys.stderr)
        lines.append(",".join([name, *(str(number) for robot in ROBOTS for number in count(robot, without))]))
    print("\rcounted" + " " * 30, file=sys.stderr)
    table.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
