#!/usr/bin/env python3
"""Counts what each pass is worth, and writes the tables of docs/passes.md and of the pages in this folder.

    cargo build --release && docs/passes/tables.py
"""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
ROBOTS = ["panda7", "puma560", "ur5", "scara4"]
COLUMNS = {
    "inverse_dynamics": "inverse dynamics",
    "inertia_matrix": "B",
    "coriolis_matrix": "C",
    "gravity": "g",
    "equations_of_motion": "B, C, g",
    "base_regressor": "Y",
}
SHORT = {"inverse dynamics": "τ"}


def count(robot, without):
    command = [ROOT / "target/release/armgen", "count", f"robots/{robot}.yaml", "--format", "json"]
    if without:
        command += ["--without", ",".join(without)]
    text = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    functions = json.loads(text)["functions"]
    return [functions[name]["mul"] + functions[name]["add"] for name in COLUMNS]


def page(name, counts, everything):
    """The section `Effect` of a pass."""
    lines = [f"| robot | | {' | '.join(COLUMNS.values())} |", f"|---|---|{'---:|' * len(COLUMNS)}"]
    changed = [robot for robot in ROBOTS if counts[robot] != everything[robot]]
    for robot in changed:
        row = lambda title, of: f"| {title} | {' | '.join(map(str, of[robot]))} |"
        lines += [row(f"{robot} | with all", everything), row(f"| without `{name}`", counts)]
    same = [robot for robot in ROBOTS if robot not in changed]
    text = "\n".join(lines) + "\n" if changed else ""
    if same:
        text += ("\n" if text else "") + f"It changes none of these counts for {', '.join(same)}.\n"
    path = ROOT / f"docs/passes/{name}.md"
    old = path.read_text()
    new = re.sub(r"(with all passes and without this one\.\n\n).*?(\n```sh)", lambda m: m[1] + text + m[2], old, flags=re.S)
    path.write_text(new)


def main():
    index = (ROOT / "docs/passes.md").read_text()
    passes = re.findall(r"^- \[`([a-z-]+)`\]", index, flags=re.M)
    everything = {robot: count(robot, []) for robot in ROBOTS}
    shown = [(robot, k) for robot in ROBOTS[:3] for k, name in enumerate(COLUMNS) if name != "equations_of_motion"]
    titles = [SHORT.get(title, title) for title in COLUMNS.values()]
    row = lambda title, of: f"| {title} | {' | '.join(str(of[robot][k]) for robot, k in shown)} |"
    lines = [f"| | {' | '.join(f'{robot} {titles[k]}' for robot, k in shown)} |", f"|---|{'---:|' * len(shown)}"]
    lines.append(row("all passes", everything))
    for name in passes:
        print(f"\rcounting without {name:20}", end="", file=sys.stderr)
        counts = {robot: count(robot, [name]) for robot in ROBOTS}
        lines.append(row(f"without `{name}`", counts))
        page(name, counts, everything)
    lines.append(row("without any", {robot: count(robot, passes) for robot in ROBOTS}))
    print("\rcounted" + " " * 30, file=sys.stderr)
    table = "\n".join(lines)
    new = re.sub(r"\| \| panda7 τ.*?\n\n", lambda _: table + "\n\n", index, flags=re.S)
    (ROOT / "docs/passes.md").write_text(new)


if __name__ == "__main__":
    main()
