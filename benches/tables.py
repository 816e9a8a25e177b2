#!/usr/bin/env python3
"""Writes results/functions.csv from the output of the benches in target/.

  cargo bench --bench instructions -- --save-summary=json
  cargo bench --bench time
  ./tables.py

Operations are those of `armgen count`; instructions are callgrind's of one call; times are criterion's medians.
"""
import json
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROBOTS = ["scara4", "puma560", "ur5", "panda7"]


def operations(robot):
    """Function -> its entry of `armgen count`."""
    command = ["cargo", "run", "--release", "--quiet", "-p", "armgen", "--", "count", f"robots/{robot}.yaml", "--format", "json"]
    text = subprocess.run(command, cwd=HERE.parent, check=True, stdout=subprocess.PIPE, text=True).stdout
    return json.loads(text)["functions"]


def instructions():
    """(robot, trig, function) -> instructions of one call."""
    found = {}
    for path in HERE.glob("target/gungraun/**/summary.json"):
        summary = json.loads(path.read_text())
        metrics = summary["profiles"][0]["summaries"]["parts"][0]["metrics_summary"]["Callgrind"]["Ir"]["metrics"]
        new = next(iter(metrics.values()))
        new = new[0] if isinstance(new, list) else new
        robot, trig = summary["id"].split("_")
        found[robot, trig, summary["function_name"]] = next(iter(new.values()))
    return found


def times():
    """(robot, trig, function) -> median time of one call, ns."""
    found = {}
    for path in HERE.glob("target/criterion/*/new/estimates.json"):
        robot, trig, function = path.parts[-3].split("_", 2)
        found[robot, trig, function] = json.loads(path.read_text())["median"]["point_estimate"]
    return found


def main():
    counted, timed = instructions(), times()
    lines = [["robot", "function", "multiplications", "additions", "pairs", "instructions libm", "instructions fast", "ns libm", "ns fast"]]
    number = lambda values, key, form: form.format(values[key]) if key in values else ""
    for robot in ROBOTS:
        count = operations(robot)
        rows = []
        for function in dict.fromkeys(f for r, _, f in [*counted, *timed] if r == robot):
            # Inverse kinematics has loops: no number of operations.
            entry = count.get(function, {})
            rows.append([robot, function, *(str(entry.get(k, "")) for k in ("mul", "add", "sincos")),
                         *(number(counted, (robot, t, function), "{}") for t in ("libm", "fast")),
                         *(number(timed, (robot, t, function), "{:.1f}") for t in ("libm", "fast"))])
        lines += sorted(rows, key=lambda row: [*count, "inverse_kinematics"].index(row[1]))
    (HERE / "results" / "functions.csv").write_text("".join(",".join(line) + "\n" for line in lines))


if __name__ == "__main__":
    main()
