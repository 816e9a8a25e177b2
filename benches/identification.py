#!/usr/bin/env python3
"""Identifies ten simulated arms of random shape: ./identification.py ARMGEN [FOLDER]

Each arm moves twice: `armgen excite --simulate` plans a motion, and gives its log with noise of 0 and of 2 %. `armgen identify` starts from
masses that are off by up to 30 % and no friction. The written file is judged by its torques on another motion, beside those of the arm:
the root of the mean square of their difference over that of the torques, by joint, where the joint moves faster than 0.02 rad/s.
Needs Python's standard library. The same build prints the same table.
"""

import csv
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

ARMS = 10


def arm(seed):
    """Rows, bodies and friction of an arm with three to seven joints."""
    draw = random.Random(seed)
    n = 3 + seed % 5
    joints = []
    for i in range(n):
        slides = i == n - 1 and seed % 4 == 3
        size = 0.75**i
        mass = draw.uniform(4, 9) * size
        alpha = draw.choice(["0", "pi/2", "-pi/2", "pi/2", f"{draw.uniform(0.4, 1.2):.4f}"])
        # Parallel axes have a distance.
        a = draw.choice([0 if alpha != "0" else 0.3, draw.uniform(0.1, 0.4) * size])
        d = draw.choice([0, draw.uniform(0.1, 0.3) * size])
        box = [draw.uniform(0.05, 0.2) * math.sqrt(size) for _ in range(3)]
        inertia = [mass * (box[1] ** 2 + box[2] ** 2) / 3, mass * (box[0] ** 2 + box[2] ** 2) / 3, mass * (box[0] ** 2 + box[1] ** 2) / 3]
        com = [round(draw.uniform(-0.5, 0.5) * (a + 0.1), 4), round(draw.uniform(-0.03, 0.03), 4), round(draw.uniform(-0.5, 0.5) * (d + 0.1), 4)]
        joints.append({
            "slides": slides, "a": a, "alpha": alpha, "d": d, "mass": mass, "com": com, "inertia": inertia,
            "ratio": draw.choice([50, 80, 100]), "rotor": 4e-5 * size,
            "friction": {"viscous": draw.uniform(2, 6) * size, "coulomb": draw.uniform(2, 5) * size, "offset": draw.uniform(-0.5, 0.5) * size,
                         "load": draw.choice([0, draw.uniform(0.03, 0.08)]), "cubic": draw.choice([0, draw.uniform(-0.3, 0.3) * size])},
        })
    return joints


def text(joints, seed, is_guess):
    """The description of an arm, or the guess that identification begins with."""
    draw = random.Random(1000 + seed)
    lines = ["name: arm", f"convention: {['standard', 'modified'][seed % 2]}", "gravity: [0, 0, -9.81]", "joints:"]
    for i, of in enumerate(joints):
        by = draw.uniform(0.7, 1.3) if is_guess else 1
        kind, turn = ("prismatic", "theta: 0") if of["slides"] else ("revolute", "theta: 0")
        range_ = [-0.3, 0.3] if of["slides"] else [-2.5, 2.5]
        speed = 0.5 if of["slides"] else 2
        numbers = ", ".join(f"{axis}: {value * by:.5g}" for axis, value in zip(["xx", "yy", "zz"], of["inertia"]))
        lines.append(
            f"  - {{name: j{i + 1}, type: {kind}, a: {of['a']:.4f}, alpha: {of['alpha']}, d: {of['d']:.4f}, {turn},\n"
            f"     limits: {{position: {range_}, velocity: {speed}, acceleration: {4 * speed}, effort: 1000}},\n"
            f"     link: {{mass: {of['mass'] * by:.4f}, com: {of['com']}, inertia: {{{numbers}}}}},\n"
            f"     motor: {{ratio: {of['ratio']}, inertia: {of['rotor'] * by:.4g}}}")
        if not is_guess:
            terms = ", ".join(f"{key}: {value:.4f}" for key, value in of["friction"].items() if value)
            lines[-1] += f", friction: {{{terms}}}"
        lines[-1] += "}"
    return "\n".join(lines) + "\n"


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1) or (done.returncode == 1 and "error" in done.stderr):
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return done


def differences(arm, other):
    """How far the torques of two simulated logs of one motion are apart, by joint, where the joint moves."""
    with open(arm) as a, open(other) as b:
        (names, *truth), (_, *found) = csv.reader(a), csv.reader(b)
    joints = [(i, names.index(name.replace("tau_", "dq_"))) for i, name in enumerate(names) if name.startswith("tau_")]
    apart = []
    for tau, dq in joints:
        rows = [(float(t[tau]), float(f[tau])) for t, f in zip(truth, found) if abs(float(t[dq])) > 0.02]
        apart.append(math.sqrt(sum((t - f) ** 2 for t, f in rows) / sum(t * t for t, _ in rows)))
    return apart


def main():
    armgen, folder = sys.argv[1], pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp())
    print("| arm | joints | noise | largest | mean | friction held | width of Fc | gap |\n|---|---:|---:|---:|---:|---:|---:|---:|")
    every, held, widths = {0: [], 2: []}, [0, 0], []
    for seed in range(ARMS):
        at = folder / f"arm{seed}"
        at.mkdir(parents=True, exist_ok=True)
        joints = arm(seed)
        (at / "arm.yaml").write_text(text(joints, seed, False))
        (at / "guess.yaml").write_text(text(joints, seed, True))
        (at / "second.yaml").write_text("seed: 7\n")
        simulate = ["--duration", "20", "--simulate", at / "arm.yaml", "--noise"]

        def on_another_motion(of, out):
            run(armgen, "excite", at / "guess.yaml", "--out", at / f"{out}.csv", "--options", at / "second.yaml", "--duration", "20",
                "--simulate", of, "--noise", "0")
            return at / f"{out}.log.csv"

        torques = on_another_motion(at / "arm.yaml", "other")
        for noise in every:
            run(armgen, "excite", at / "guess.yaml", "--out", at / f"run{noise}.csv", *simulate, str(noise))
            written, report = at / f"identified{noise}.yaml", at / f"report{noise}"
            run(armgen, "identify", at / "guess.yaml", at / f"run{noise}.log.csv", "--out", written, "--report", report, "--accept-unexcited")
            moving = differences(torques, on_another_motion(written, f"identified{noise}-other"))
            every[noise] += moving
            found = json.loads((report / "report.json").read_text())
            own = [0, 0]
            for of in found["friction"]:
                truth = joints[int(of["joint"][1:]) - 1]["friction"].get(of["key"], 0)
                if of.get("sigma") and noise:
                    own[1] += 1
                    own[0] += of["low"] <= truth <= of["high"]
                    if of["key"] == "coulomb":
                        widths.append((of["high"] - of["low"]) / truth)
            held = [held[0] + own[0], held[1] + own[1]]
            gap = json.loads((report / "certificate.json").read_text())["optimality"].get("gap", "not proved")
            shown = f"{own[0]} of {own[1]}" if noise else ""
            print(f"| {seed} | {len(joints)} | {noise} % | {100 * max(moving):.4f} % | {100 * statistics.mean(moving):.4f} % | {shown} | | {gap} |", flush=True)
    for noise, moving in every.items():
        print(f"| all | {len(moving)} | {noise} % | {100 * max(moving):.4f} % | {100 * statistics.mean(moving):.4f} % "
              f"| {f'{held[0]} of {held[1]}' if noise else ''} | {f'{100 * statistics.median(widths):.1f} %' if noise else ''} | |")


if __name__ == "__main__":
    main()
