#!/usr/bin/env python3
"""The motion of `armgen excite` beside the best of 20 searches by SciPy's L-BFGS-B.

    ./excitation.py ARMGEN ROBOT.yaml [STARTS]

Both motions are judged by this script: log det of M per column, M the mean of A' E^-2 A over 1000 times, A the base regressor
of the emitted Python module with columns dq, sign(dq) and 1 for each joint. Every joint needs all limits. The searches of SciPy have
limits as penalties at samples and leave friction out of the efforts: both favour them. Needs NumPy and SciPy.
"""

import importlib.util
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.optimize import minimize

HARMONICS, DURATION, SAMPLES, STEP = 5, 10.0, 80, 1e-5
W = 2 * np.pi / DURATION


def basis(t):
    """q, dq, ddq of the coordinates q0, a, b of a joint, at times t: 3 x times x (1 + 2 H)."""
    k = np.arange(1, HARMONICS + 1) * W
    s, c = np.sin(np.outer(t, k)), np.cos(np.outer(t, k))
    one, zero = np.ones((len(t), 1)), np.zeros((len(t), 1))
    return np.stack([np.hstack([one, s / k, -c / k]), np.hstack([zero, c, s]), np.hstack([zero, -s * k, c * k])])


def free():
    """The coordinates with dq = ddq = 0 at t = 0: (1 + 2 H) x (2 H - 1)."""
    conditions = np.zeros((2, 1 + 2 * HARMONICS))
    conditions[0, 1 : 1 + HARMONICS] = 1
    conditions[1, 1 + HARMONICS :] = np.arange(1, HARMONICS + 1)
    return np.linalg.svd(conditions)[2][2:].T


def columns(regressor, q, dq, ddq, smooth):
    """A: states x joints x columns."""
    y = regressor(q, dq, dq, ddq)
    sign = np.tanh(dq / smooth) if smooth is not None else np.sign(dq)
    n = q.shape[1]
    friction = np.zeros(y.shape[:2] + (3 * n,))
    for j in range(n):
        friction[:, j, 3 * j : 3 * j + 3] = np.stack([dq[:, j], sign[:, j], np.ones(len(q))], axis=1)
    return np.concatenate([y, friction], axis=2)


def log_det(a, effort):
    a = (a / effort[None, :, None]).reshape(-1, a.shape[2])
    sign, value = np.linalg.slogdet(a.T @ a * (len(effort) / len(a)))
    return value / a.shape[1] if sign > 0 else -np.inf


def main():
    armgen, robot = sys.argv[1:3]
    starts = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    text = pathlib.Path(robot).read_text()
    folder = pathlib.Path(tempfile.mkdtemp())
    bare = re.sub(r",?\s*friction: \{[^}]*\}", "", text)
    bare = re.sub(r"regressor: \w+", "", bare) + "\nregressor: base\n"
    (folder / "bare.yaml").write_text(bare)
    run = lambda *arguments: subprocess.run([armgen, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)
    run("generate", folder / "bare.yaml", "--language", "python", "--out", folder / "bare.py")
    begin = time.time()
    run("excite", robot, "--out", folder / "motion.csv")
    print(f"armgen excite: {time.time() - begin:.1f} s")
    spec = importlib.util.spec_from_file_location("bare", folder / "bare.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    limits = re.findall(r"limits: \{position: \[(.*?), (.*?)\], velocity: (.*?), acceleration: (.*?), effort: (.*?)\}", text)
    low, high, velocity, acceleration, effort = np.array(limits, float).T
    n = len(low)
    # Coordinates of each joint in units of its limits.
    middle, half = (low + high) / 2, (high - low) / 2
    grid, null = basis(np.arange(SAMPLES) * DURATION / SAMPLES), free()
    unit = np.ones((n, 1 + 2 * HARMONICS))
    unit[:, 0], unit[:, 1:] = half, velocity[:, None]
    smooth = 0.01 * velocity

    def states(x, at):
        c = (x.reshape(n, -1) @ null.T) * unit
        c[:, 0] += middle
        return np.einsum("dtc,jc->dtj", at, c)

    def cost(x, weight):
        q, dq, ddq = states(x, grid)
        a = columns(module.regressor, q, dq, ddq, smooth) / effort[None, :, None]
        p = a.shape[2]
        flat = a.reshape(-1, p)
        m = flat.T @ flat / SAMPLES
        scale = 1 / np.sqrt(np.diag(m))
        sign, value = np.linalg.slogdet(m * np.outer(scale, scale))
        if sign <= 0:
            return 1e6, np.zeros_like(x)
        value = -(value - 2 * np.log(scale).sum()) / p
        weights = -2 / (SAMPLES * p) * (flat @ np.linalg.inv(m)).reshape(a.shape) / effort[None, :, None]
        tau = module.inverse_dynamics(q, dq, ddq)
        penalty_tau = np.maximum(np.abs(tau) / effort - 1, 0) * np.sign(tau) / effort
        # Central differences in one call: kind of variable x joint x side x time.
        moved = [np.empty((3, n, 2, SAMPLES, n)) for _ in range(3)]
        for d, z in enumerate((q, dq, ddq)):
            moved[d][:] = z
            for j in range(n):
                moved[d][d, j, :, :, j] += np.array([STEP, -STEP])[:, None]
        moved = [z.reshape(-1, n) for z in moved]
        of_sides = lambda y: np.subtract(*np.moveaxis(y.reshape((3, n, 2, SAMPLES) + y.shape[1:]), 2, 0)) / (2 * STEP)
        slopes = np.einsum("tip,dktip->dtk", weights, of_sides(columns(module.regressor, *moved, smooth)), optimize=True)
        if penalty_tau.any():
            slopes += weight * np.einsum("ti,dkti->dtk", penalty_tau, of_sides(module.inverse_dynamics(*moved)))
        value += weight / 2 * (np.maximum(np.abs(tau) / effort - 1, 0) ** 2).sum()
        for d, (mid, size) in enumerate([(middle, half), (0 * half, velocity), (0 * half, acceleration)]):
            z = ((q, dq, ddq)[d] - mid) / size
            over = np.maximum(np.abs(z) - 1, 0)
            value += weight / 2 * (over**2).sum()
            slopes[d] += weight * over * np.sign(z) / size
        gradient = np.einsum("dtj,dtc->jc", slopes, grid) * unit
        return value, (gradient @ null).ravel()

    fine = basis(np.arange(1000) * DURATION / 1000)

    def judged(x):
        """log det per column of a motion with the amplitudes of all joints reduced until the limits hold at 1000 times."""
        c = (x.reshape(n, -1) @ null.T) * unit
        for _ in range(400):
            q, dq, ddq = np.einsum("dtc,jc->dtj", fine, c) + np.stack([middle, 0 * middle, 0 * middle])[:, None]
            used = np.max([np.abs((q - middle) / half).max(0), np.abs(dq / velocity).max(0), np.abs(ddq / acceleration).max(0)], axis=0)
            over = np.abs(module.inverse_dynamics(q, dq, ddq) / effort).max()
            if used.max() <= 1 and over <= 1:
                break
            c /= np.maximum(used, 1)[:, None]
            if used.max() <= 1:
                c *= 0.998
        return log_det(columns(module.regressor, q, dq, ddq, None), effort)

    ours = (folder / "motion.yaml").read_text()
    numbers = lambda key: np.array([[float(x) for x in re.findall(r"[-+.\de]+", line.split(":")[1])]
                                    for line in re.search(rf"^{key}:\n((?:  .*\n)+)", ours, re.M)[1].splitlines()])
    c = np.hstack([numbers("q0"), numbers("a"), numbers("b")])
    own = log_det(columns(module.regressor, *np.einsum("dtc,jc->dtj", fine, c), None), effort)
    print(f"armgen excite: log det per column {own:.4f}")
    best, random = -np.inf, np.random.default_rng(1)
    for k in range(starts):
        begin = time.time()
        x = random.normal(size=(n, null.shape[1])) * 0.25
        x[:, 0] *= 0.3
        x = x.ravel()
        for weight in (0.3, 3, 30):
            x = minimize(cost, x, (weight,), jac=True, method="L-BFGS-B", options={"maxiter": 200, "maxfun": 260}).x
        value = judged(x)
        best = max(best, value)
        print(f"L-BFGS {k + 1:2}: {value:.4f}  {time.time() - begin:.0f} s  best {best:.4f}", flush=True)
    print(f"best of {starts} less armgen: {best - own:+.4f}")
    sys.exit(int(best - own > 0.05))


main()
