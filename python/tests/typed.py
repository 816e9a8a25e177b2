"""Every kind of use, for type checkers: `mypy --strict` finds nothing in it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import armgen

robot: armgen.Robot = armgen.load(Path("robot.yaml"), strict=True, allow=["no-effect"])
other: armgen.Robot = armgen.loads("<robot/>", "arm.urdf", tip="tool0", lock={"finger": 0.04}, snap=0)
arms: armgen.Robot = armgen.loads("<robot/>", tip={"left": "left_hand", "right": "right_hand"})
all_arms: armgen.Robot = armgen.loads("<robot/>", tip=["left_hand", "right_hand"] if robot.notes else None, all=not robot.notes)
q: NDArray[np.float64] = np.zeros(robot.dof)
torque: NDArray[np.float64] = robot.inverse_dynamics(q, q, [0.0] * robot.dof)
many: NDArray[np.float64] = robot.gravity(np.zeros((100, robot.dof)), out=np.empty((100, robot.dof)), threads=0)
energy: float | NDArray[np.float64] = robot.kinetic_energy(q, q)
inertia: NDArray[np.float64] = robot.equations_of_motion(q, q).inertia
by_q: NDArray[np.float64] = robot.inverse_dynamics_derivatives(q, q, q).by_q
with_parameters: NDArray[np.float64] = robot.gravity_with(robot.nominal_parameters, q)
function: armgen.Function = robot.gravity
names: tuple[str, ...] = function.arguments + robot.functions + robot.parameter_names
count: int = function.operations["mul"]
reason: str = robot.absent["gravity"]
finite: NDArray[np.bool_] = np.isfinite(robot.position_limits) & robot.revolute[:, None]
texts: list[str] = [robot.text, robot.check(), robot.show("gravity"), robot.latex("gravity", digits=4), repr(robot)]
files: dict[str, str] = robot.generate("python", functions=["gravity"])
postures: armgen.Postures = robot.inverse_kinematics(np.eye(4), 0.5)
rows: list[NDArray[np.float64]] = [posture for posture in postures.within_limits()]
nearest: NDArray[np.float64] | None = postures.nearest_to([0.0] * robot.dof)
are_all: bool = postures.verdict == "complete" and len(postures) == len(postures.branch_names)
lists: list[armgen.Postures] = robot.inverse_kinematics(position=np.zeros((5, 3)), rotation=np.eye(3), threads=0)
given: str | None = robot.redundancy
invalid: str | None = postures.reason
odds: float = robot.verify()["gravity"]["log2_odds"]
robot.page("robot.html")
robot.prepare("gravity")

try:
    armgen.loads("")
except armgen.DescriptionError as error:
    for found in error.diagnostics:
        place: tuple[str, int, int] = (found.file, found.line, found.column)
