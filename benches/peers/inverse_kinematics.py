"""All postures of a pose by EAIK (pip install eaik), and by the blocks of this project in the same run: microseconds a call, medians.

Run from anywhere, with cargo in the path. EAIK's calls go through Python, which is part of their time; its arms have the constants of
`inverse-kinematics/tests/data`, and so have ours.
"""

import pathlib
import statistics
import subprocess
import time

import numpy
from eaik.IK_DH import DhRobot

H = numpy.pi / 2
ARMS = {
    "ur5": ([H, 0, 0, H, -H, 0], [0, -0.425, -0.39225, 0, 0, 0], [0.089159, 0, 0, 0.10915, 0.09465, 0.0823]),
    "puma560": ([H, 0, -H, H, -H, 0], [0, 0.4318, 0.0203, 0, 0, 0], [0, 0, 0.15005, 0.4318, 0, 0]),
}


def peer(arm):
    """Median time of a call over 64 random poses, and the mean number of postures."""
    robot = DhRobot(*(numpy.array(column, dtype=float) for column in arm))
    random = numpy.random.default_rng(1)
    poses = [robot.fwdKin(random.uniform(-numpy.pi, numpy.pi, 6)) for _ in range(64)]
    rounds = []
    for _ in range(101):
        began = time.perf_counter()
        for pose in poses:
            robot.IK(pose)
        rounds.append((time.perf_counter() - began) / len(poses) * 1e6)
    return statistics.median(rounds), statistics.mean(robot.IK(pose).num_solutions() for pose in poses)


for name, arm in ARMS.items():
    microseconds, postures = peer(arm)
    print(f"{name:>10} EAIK {microseconds:.2f} us, {postures:.1f} postures in the mean")
    command = ["cargo", "run", "--release", "--quiet", "--example", "time", "-p", "armgen-inverse-kinematics", "--", name]
    print(subprocess.run(command, cwd=pathlib.Path(__file__).parents[2], check=True, capture_output=True, text=True).stdout, end="")
