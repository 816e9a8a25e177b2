#!/usr/bin/env python3
"""Counts the operations that each pass saves, and writes the first table of docs/passes.md.

    cargo build --release -p armgen && benches/passes.py
"""

import json
import re
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
    index = (ROOT / "docs/passes.md").read_text()
    passes = re.findall(r"^\| without `([a-z-]+)` \| \d+ \| \d+ \| \d+ \| \d+ \| \d+ \|", index, flags=re.M)
    everything = {robot: count(robot, []) for robot in ROBOTS}
    shown = [(robot, k) for robot in ROBOTS for k in range(len(COLUMNS))]
    titles = list(COLUMNS.values())
    row = lambda title, of: f"| {title} | {' | '.join(str(of[robot][k]) for robot, k in shown)} |"
    lines = [f"| | {' | '.join(f'{robot} {titles[k]}' for robot, k in shown)} |", f"|---|{'---:|' * len(shown)}"]
    lines.append(row("all passes", everything))
    for name in passes:
        print(f"\rcounting without {name:20}", end="", file=sys.stderr)
        counts = {robot: count(robot, [name]) for robot in ROBOTS}
        lines.append(row(f"without `{name}`", counts))
    lines.append(row("without any", {robot: count(robot, passes) for robot in ROBOTS}))
    print("\rcounted" + " " * 30, file=sys.stderr)
    table = "\n".join(lines)
    new = re.sub(r"\| \| panda7 τ.*?\n\n", lambda _: table + "\n\n", index, flags=re.S)
    (ROOT / "docs/passes.md").write_text(new)


if __name__ == "__main__":
    main()
