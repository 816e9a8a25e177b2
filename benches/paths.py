#!/usr/bin/env python3
"""Random paths timed by armgen, by toppra and by copp: ./paths.py ARMGEN [PATHS]

Splines through five random points for the Panda and the UR5, with limits of speed and torque. Of each: the duration above the lower bound
of `armgen time`, and by how much speeds and torques exceed their limits at 40 000 places, by the emitted Python module. `armgen time`
proves that its own exceed none. The time of armgen is that of the program, with reading and derivation (`cargo bench --bench timing`
has that of the solution); that of toppra is `compute_trajectory`, that of copp `topp2_ra.solve`, both without the arm's coefficients. Needs
NumPy, toppra 0.6.10 and copp-py 0.2.3 (PyPI).
"""

import importlib.util
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import copp_py as copp
import numpy as np
import toppra
from toppra.constraint import DiscretizationType, JointTorqueConstraint, JointVelocityConstraint

ROBOTS = pathlib.Path(__file__).parent.parent / "robots"
ARMS = {
    "panda7": ([2.175] * 4 + [2.61] * 3, [87] * 4 + [12] * 3, [2.5, 1.7, 2.5, 1.5, 2.5, 1.8, 2.5]),
    "ur5": ([3.15] * 3 + [3.2] * 3, [150] * 3 + [28] * 3, [3] * 6),
}
PLACES = 40_000


def emitted(armgen, robot, folder):
    """The emitted Python module."""
    file = folder / f"{robot}.py"
    subprocess.run([armgen, "generate", ROBOTS / f"{robot}.yaml", "--language", "python", "--out", file], check=True, stdout=subprocess.DEVNULL)
    spec = importlib.util.spec_from_file_location(robot, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def excess(module, states, velocity, effort):
    """By how much speeds and torques exceed their limits, as shares of these."""
    q, dq, ddq = states
    torque = module.inverse_dynamics(q, dq, ddq)
    return [max(0, (np.abs(x) / limit).max() - 1) for x, limit in ((dq, velocity), (torque, effort))]


def by_armgen(armgen, robot, spline, velocity, effort, folder):
    """Duration, lower bound and seconds."""
    knots, coefficients = spline.x, spline.c[::-1].transpose(1, 2, 0)
    text = json.dumps({
        "robot": robot, "pieces": {"knots": knots.tolist(), "coefficients": coefficients.tolist()},
        "limits": {"velocity": velocity.tolist(), "effort": effort.tolist()}, "ends": {"hold": False},
    })
    path, result = folder / "path.yaml", folder / "timing.json"
    path.write_text(text)
    begin = time.perf_counter()
    subprocess.run([armgen, "time", ROBOTS / f"{robot}.yaml", path, "--json", result], check=True, stdout=subprocess.DEVNULL)
    seconds = time.perf_counter() - begin
    timing = json.loads(result.read_text())
    return timing["duration"], timing["lower_bound"], seconds


def by_toppra(module, path, velocity, effort, intervals, scheme):
    """Duration, seconds and excess; None where it fails."""
    dynamics = lambda q, dq, ddq: module.inverse_dynamics(q[None], dq[None], ddq[None])[0]
    torque = JointTorqueConstraint(dynamics, np.stack([-effort, effort], axis=1), np.zeros(len(effort)), discretization_scheme=scheme)
    limits = [JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)), torque]
    grid = np.linspace(*path.path_interval, intervals + 1)
    known = torque.compute_constraint_params(path, grid)
    torque.compute_constraint_params = lambda *_: known
    begin = time.perf_counter()
    solver = toppra.algorithm.TOPPRA(limits, path, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    trajectory = solver.compute_trajectory(0, 0)
    seconds = time.perf_counter() - begin
    if trajectory is None:
        return None
    times = np.linspace(0, trajectory.duration, PLACES)
    states = [trajectory(times, order) for order in range(3)]
    return trajectory.duration, seconds, excess(module, states, velocity, effort)


def by_copp(module, path, velocity, effort, stations):
    """Duration, seconds and excess; ds^2 is linear between stations."""
    s = np.linspace(*path.path_interval, stations)
    robot = copp.Robot(len(effort), inverse_dynamics=lambda *state: module.inverse_dynamics(*(x[None] for x in state))[0])
    robot.append_s(s)
    robot.set_q(*(path(s, order) for order in range(3)), 0)
    robot.add_velocity_limits(velocity, -velocity, start_idx_s=0)
    robot.add_torque_limits(effort, -effort, start_idx_s=0)
    problem = copp.solver.topp2_ra.Problem(robot.constraints, idx_s_interval=(0, stations - 1), a_boundary=(0.0, 0.0))
    begin = time.perf_counter()
    squares = copp.solver.topp2_ra.solve(problem)
    seconds = time.perf_counter() - begin
    duration, times = copp.interpolation.s_to_t_topp2(s, squares)
    at = np.linspace(*path.path_interval, PLACES + 2)[1:-1]
    square = np.interp(at, s, squares)[:, None]
    slope = (np.diff(squares) / np.diff(s) / 2)[np.searchsorted(s, at, side="right") - 1][:, None]
    q, first, second = (path(at, order) for order in range(3))
    return duration, seconds, excess(module, (q, first * np.sqrt(square), first * slope + second * square), velocity, effort)


def main():
    armgen = pathlib.Path(sys.argv[1]).resolve()
    paths = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    toppra.setup_logging("ERROR")
    folder = pathlib.Path(tempfile.mkdtemp())
    schemes = {"collocation": DiscretizationType.Collocation, "interpolation": DiscretizationType.Interpolation}
    print("| arm | program | failed | above the bound, median | most | speed beyond its limit, most | torque, median | most | ms, median |")
    print("|---|---|---:|---:|---:|---:|---:|---:|---:|")
    for robot, given in ARMS.items():
        velocity, effort, span = map(np.array, given)
        module = emitted(armgen, robot, folder)
        rows = {"armgen time, whole program": []}
        for seed in range(paths):
            points = np.random.default_rng(seed).uniform(-span, span, (5, len(span)))
            s = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
            path = toppra.SplineInterpolator(s, points, bc_type="natural")
            duration, bound, seconds = by_armgen(armgen, robot, path.cspl, velocity.astype(float), effort.astype(float), folder)
            rows["armgen time, whole program"].append((duration / bound - 1, seconds, [0, 0]))
            for intervals in (100, 1000):
                for name, scheme in schemes.items():
                    found = by_toppra(module, path, velocity, effort, intervals, scheme)
                    row = found and (found[0] / bound - 1, *found[1:])
                    rows.setdefault(f"toppra, {intervals} intervals, {name}", []).append(row)
                found = by_copp(module, path, velocity, effort, intervals)
                rows.setdefault(f"copp, {intervals} stations", []).append((found[0] / bound - 1, *found[1:]))
        for name, all_runs in rows.items():
            runs = [run for run in all_runs if run]
            above, seconds = [run[0] for run in runs], [run[1] for run in runs]
            speed, torque = [run[2][0] for run in runs], [run[2][1] for run in runs]
            middle = statistics.median
            print(f"| {robot} | {name} | {len(all_runs) - len(runs)} | {100 * middle(above):.3f} % | {100 * max(above):.3f} % | "
                  f"{100 * max(speed):.2f} % | {100 * middle(torque):.2f} % | {100 * max(torque):.2f} % | {1e3 * middle(seconds):.2f} |")


if __name__ == "__main__":
    main()
