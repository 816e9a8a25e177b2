"""The table "In Pinocchio's terms" of docs/python.md, where Pinocchio is installed (`pip install pin`)."""

import subprocess

import numpy as np
import pytest

import armgen
from conftest import ROOT

pin = pytest.importorskip("pinocchio")


def test_a_urdf_has_the_numbers_of_pinocchio(tmp_path, random):
    path = tmp_path / "ur5.urdf"
    subprocess.run(["armgen", "export", ROOT / "robots/ur5.yaml", "--format", "urdf", "--out", path], check=True, capture_output=True)
    model = pin.buildModelFromUrdf(str(path))
    data, tool = model.createData(), model.getFrameId("tool")
    robot = armgen.load(path, tip="tool", snap=0)

    def check(found, expected):
        assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()

    for q, dq, ddq in random.uniform(-3, 3, (100, 3, 6)):
        # A joint without limits has its cosine and its sine there.
        p = np.stack([np.cos(q), np.sin(q)], axis=1).ravel()
        friction = robot.friction(dq) if "friction" in robot.functions else 0.0
        torque = robot.inverse_dynamics(q, dq, ddq)
        check(torque - friction, pin.rnea(model, data, p, dq, ddq))
        upper = np.triu(pin.crba(model, data, p))
        check(robot.inertia_matrix(q), upper + np.triu(upper, 1).T)
        check(robot.coriolis_matrix(q, dq), pin.computeCoriolisMatrix(model, data, p, dq))
        check(robot.gravity(q), pin.computeGeneralizedGravity(model, data, p))
        check(robot.geometric_jacobian(q), pin.computeFrameJacobian(model, data, p, tool, pin.LOCAL_WORLD_ALIGNED))
        check(robot.forward_dynamics(q, dq, torque), pin.aba(model, data, p, dq, torque - friction))
        pin.framesForwardKinematics(model, data, p)
        check(robot.direct_kinematics(q), data.oMf[tool].homogeneous)
