"""The table "In MuJoCo's terms" of docs/python.md, where MuJoCo is installed (`pip install mujoco`)."""

import numpy as np
import pytest

import armgen

mujoco = pytest.importorskip("mujoco")

MODEL = """<mujoco model="arm">
  <compiler angle="radian"/>
  <option gravity="0.4 -0.3 -9.81"><flag energy="enable"/></option>
  <worldbody>
    <body name="shoulder" pos="0.1 0.2 0.4">
      <joint name="turn" axis="0 0 1" armature="0.2" damping="0.3"/>
      <inertial pos="0.05 -0.02 0.1" mass="3" fullinertia="0.04 0.05 0.06 0.001 -0.002 0.003"/>
      <body name="upper" pos="0 0.1 0.2" quat="0.8 0.6 0 0">
        <joint name="lift" axis="0.6 0 0.8" stiffness="5" springref="0.3"/>
        <inertial pos="0.2 0.01 0" mass="2.5" quat="0.6 0 0.8 0" diaginertia="0.01 0.02 0.025"/>
        <body name="ram" pos="0.5 0 0.05">
          <joint name="slide" type="slide" axis="1 0 0" armature="1.5" damping="2"/>
          <inertial pos="0 0.1 0" mass="1.5" diaginertia="0.01 0.015 0.02"/>
          <body name="hand" pos="0.1 0 0" quat="0 0 0.6 0.8">
            <joint name="roll" axis="0 1 0"/>
            <inertial pos="0.03 0 0.02" mass="0.7" diaginertia="0.002 0.003 0.004"/>
            <site name="tool" pos="0.1 0.02 -0.03" quat="0.8 0 0.6 0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>"""


def test_a_model_has_the_numbers_of_mujoco(random):
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    robot = armgen.loads(MODEL, "arm.xml", tip="tool", snap=0)
    site = model.site("tool").id
    hand = model.body("hand").id
    assert robot.joint_names == tuple(model.joint(joint).name for joint in range(model.njnt))

    def check(found, expected):
        assert np.abs(found - expected).max() <= 1e-12 * max(np.abs(expected).max(), 1)

    for q, dq, ddq in random.uniform(-2, 2, (100, 3, 4)):
        torque = robot.inverse_dynamics(q, dq, ddq)
        data.qpos, data.qvel, data.qfrc_applied = q, dq, torque
        mujoco.mj_forward(model, data)
        check(robot.forward_dynamics(q, dq, torque), data.qacc)
        inertia = np.zeros((4, 4))
        mujoco.mj_fullM(model, data, inertia)
        check(robot.inertia_matrix(q), inertia)
        motion = robot.coriolis_matrix(q, dq) @ dq + robot.friction(dq) + robot.gravity(q)
        check(motion, data.qfrc_bias - data.qfrc_passive)
        check(robot.potential_energy(q) - robot.potential_energy(0 * q), data.energy[0] - rest(model))
        check(robot.kinetic_energy(q, dq), data.energy[1])
        check(robot.center_of_mass(q), data.subtree_com[1])
        pose = robot.direct_kinematics(q)
        check(pose[:3, 3], data.site_xpos[site])
        check(pose[:3, :3], data.site_xmat[site].reshape(3, 3))
        check(robot.link_frames(q)[-1, :3, 3], data.xpos[hand])
        check(robot.link_frames(q)[-1, :3, :3], data.xmat[hand].reshape(3, 3))
        linear, angular = np.zeros((2, 3, 4))
        mujoco.mj_jacSite(model, data, linear, angular, site)
        check(robot.geometric_jacobian(q), np.vstack([linear, angular]))
        mujoco.mj_jacDot(model, data, linear, angular, data.site_xpos[site], hand)
        check(robot.geometric_jacobian_dot(q, dq), np.vstack([linear, angular]))
        data.qacc = ddq
        mujoco.mj_inverse(model, data)
        check(torque, data.qfrc_inverse)


def rest(model):
    """The potential energy at q = 0, where MuJoCo has another origin than armgen."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data.energy[0]
