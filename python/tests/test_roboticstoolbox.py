"""The table "In Robotics Toolbox's terms" of docs/python.md, where it is installed (`pip install roboticstoolbox-python`)."""

import numpy as np
import pytest

import armgen
from conftest import ROOT

rtb = pytest.importorskip("roboticstoolbox")


def test_a_puma_has_the_numbers_of_the_toolbox(random):
    # Both have the parameters of Corke and Armstrong-Helouvry; the description has none of the motors.
    other = rtb.models.DH.Puma560().nofriction(coulomb=True, viscous=True)
    for link in other.links:
        link.Jm = 0
    robot = armgen.load(ROOT / "robots/puma560.yaml")
    assert not robot.friction(np.ones(6)).any()

    def check(found, expected):
        assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()

    for q, dq, ddq in random.uniform(-3, 3, (30, 3, 6)):
        torque = robot.inverse_dynamics(q, dq, ddq)
        check(torque, other.rne(q, dq, ddq))
        check(robot.inertia_matrix(q), other.inertia(q))
        check(robot.coriolis_matrix(q, dq), other.coriolis(q, dq))
        check(robot.gravity(q), other.gravload(q))
        check(robot.forward_dynamics(q, dq, torque), other.accel(q, dq, torque))
        check(robot.geometric_jacobian(q), other.jacob0(q))
        check(robot.geometric_jacobian_dot(q, dq), other.jacob0_dot(q, dq))
        check(robot.direct_kinematics(q), other.fkine(q).A)
        check(robot.link_frames(q), np.array([frame.A for frame in other.fkine_all(q)])[1:])
