"""In an environment with NumPy alone and an empty PATH: load, compute, and what is not there is said."""

import os
import subprocess
import sys

import numpy as np

import armgen

path = os.path.abspath(sys.argv[1])
robot = armgen.load(path)
q = np.full(robot.dof, 0.3)
torque = robot.inverse_dynamics(q, q, q)
expected = robot.inertia_matrix(q) @ q + robot.coriolis_matrix(q, q) @ q + robot.friction(q) + robot.gravity(q)
assert np.abs(torque - expected).max() < 1e-12, (torque, expected)
assert "valid" in robot.check()
try:
    robot.sympy("gravity")
except ImportError as error:
    assert "pip install armgen[sympy]" in str(error)
else:
    raise AssertionError("sympy is here")
try:
    armgen.load("arm.urdf.xacro")
except ImportError as error:
    assert "pip install armgen[xacro]" in str(error)
else:
    raise AssertionError("xacrodoc is here")


def program(*arguments):
    # Not in the folder of the sources, where `-m` would find the package without its native half.
    command = [sys.executable, "-m", "armgen", *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=os.path.dirname(path))


done = program("show", path, "gravity")
assert done.returncode == 0 and done.stdout == robot.show("gravity"), done
done = program("chek")
assert done.returncode == 2 and "check" in done.stderr, done
