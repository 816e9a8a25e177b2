#!/usr/bin/env python3
"""Writes results/functions.csv and the table of README.md from the output of the benches in target/.

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
SHOWN = "panda7"
START, END = "<!-- tables.py writes from here -->", "<!-- to here -->"


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


def table(rows):
    """A Markdown table; numbers stand right."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    line = lambda row: "| " + " | ".join(c.rjust(w) if i else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths))) + " |"
    rule = "|" + "|".join("-" * (w + 1) + (":" if i else "-") for i, w in enumerate(widths)) + "|"
    return "\n".join([line(rows[0]), rule, *map(line, rows[1:])])


def main():
    counted, timed = instructions(), times()
    lines = [["robot", "function", "multiplications", "additions", "pairs", "instructions libm", "instructions fast", "ns libm", "ns fast"]]
    number = lambda values, key, form: form.format(values[key]) if key in values else "-"
    for robot in ROBOTS:
        count = operations(robot)
        rows = [["function", "mul", "add", "pairs", "instr. libm", "fast", "ns libm", "fast"]]
        for function in dict.fromkeys(f for r, _, f in [*counted, *timed] if r == robot):
            # Inverse kinematics has loops: no number of operations.
            entry = count.get(function, {})
            rows.append([f"`{function}`", *(str(entry.get(k, "-")) for k in ("mul", "add", "sincos")),
                         *(number(counted, (robot, t, function), "{}") for t in ("libm", "fast")),
                         *(number(timed, (robot, t, function), "{:.1f}") for t in ("libm", "fast"))])
        rows[1:] = sorted(rows[1:], key=lambda row: [*count, "inverse_kinematics"].index(row[0].strip("`")))
        lines += [[robot, row[0].strip("`"), *("" if cell == "-" else cell for cell in row[1:])] for row in rows[1:]]
        if robot == SHOWN:
            text = f"### {robot}\n\n{table(rows)}"
    (HERE / "results" / "functions.csv").write_text("".join(",".join(line) + "\n" for line in lines))
    readme = HERE / "README.md"
    before, after = readme.read_text().split(START)[0], readme.read_text().split(END)[1]
    readme.write_text(f"{before}{START}\n\n{text}\n\n{END}{after}")


if __name__ == "__main__":
    main()
