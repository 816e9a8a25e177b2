"""All postures at a pose: they have the pose, they have the bits of the emitted C, and arrays of poses are what single poses are."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

import armgen
from conftest import ROBOTS, ROOT

POSITION = """name: reach
convention: standard
gravity: [0, 0, -9.81]
task: [x, y, z]
joints:
  - {name: base, type: revolute, a: 0, alpha: pi/2, d: 0.4, theta: 0, link: {mass: 1, com: [0, 0, 0]}}
  - {name: shoulder, type: revolute, a: 0.5, alpha: 0, d: 0, theta: 0, link: {mass: 1, com: [0, 0, 0]}, limits: {position: [-1, 1]}}
  - {name: elbow, type: revolute, a: 0.4, alpha: 0, d: 0, theta: 0, link: {mass: 1, com: [0, 0, 0]}}
"""


def solvable():
    for path in ROBOTS:
        robot = armgen.load(path)
        try:
            robot.inverse_kinematics(np.eye(4))
        except ValueError as error:
            if robot.redundancy is None:
                assert "there is no `inverse_kinematics` of this arm: " in str(error)
                continue
        yield robot


def test_each_end_effector_has_postures():
    robot = armgen.load(ROOT / "tests/data/trees/two_hands.yaml")
    q = np.array([0.3, -0.2, 0.5, 0.7, -0.4, 0.1, 0.9])
    for hand, own in [("left_hand", [0, 1, 2, 3]), ("right_hand", [0, 4, 5, 6])]:
        if hand == "right_hand":
            robot = armgen.loads(robot.text.replace("task: [x, y]", "task: [x, y, z]"))
        assert getattr(robot, f"{hand}_coordinates") == tuple(own)
        frame, find = getattr(robot, f"{hand}_direct_kinematics"), getattr(robot, f"{hand}_inverse_kinematics")
        given = getattr(robot, f"{hand}_inverse_kinematics_redundancy")(q[own])
        found = find(frame(q), given)
        assert found.verdict == "complete" and found.nearest_to(q[own]) == pytest.approx(q[own], abs=1e-9)
        for posture in found:
            whole = np.array(q)
            whole[own] = posture
            assert frame(whole)[:3, 3] == pytest.approx(frame(q)[:3, 3], abs=1e-12)
        with pytest.raises(ValueError, match=f"`{hand}_inverse_kinematics`"):
            robot.inverse_kinematics(frame(q))
        assert robot.show(f"{hand}_inverse_kinematics").startswith(f"{hand}_inverse_kinematics: position of three joints")


def configuration(random, robot):
    return np.where(robot.revolute, random.uniform(-3.1, 3.1, robot.dof), random.uniform(-0.5, 0.5, robot.dof))


def given(robot, q):
    return () if robot.redundancy is None else (robot.inverse_kinematics_redundancy(q),)


def apart(robot, one, other):
    difference = np.abs(one - other)
    turned = np.abs(difference - 2 * np.pi * np.round(difference / (2 * np.pi)))
    return np.where(robot.revolute, turned, difference).max(axis=-1)


def test_every_posture_has_the_pose(random):
    counted = {}
    for robot in solvable():
        # A position says nothing of the rotation.
        columns = slice(3 if robot.task == ("x", "y", "z") else 0, 4)
        for _ in range(30):
            q = configuration(random, robot)
            pose = robot.direct_kinematics(q)
            found = robot.inverse_kinematics(pose, *given(robot, q))
            assert found.verdict in ("complete", "near_double", "continuum"), robot
            for posture in found:
                assert np.abs(robot.direct_kinematics(posture) - pose)[:, columns].max() < 1e-9, robot
            if found.verdict == "complete":
                counted[robot.name] = counted.get(robot.name, 0) + 1
                assert apart(robot, found.q, q).min() < 1e-5, robot
                assert apart(robot, found.nearest_to(q), q) < 1e-5
    assert len(counted) >= 5 and min(counted.values()) > 20, counted


def test_what_is_known_of_postures(random):
    puma = armgen.load(ROOT / "robots/puma560.yaml")
    q = np.array([0.5, 0.7, -2.2, 0.9, 1.1, -0.4])
    pose = puma.direct_kinematics(q)
    found = puma.inverse_kinematics(pose)
    assert (len(found), found.verdict, found.miss) == (8, "complete", 0.0)
    assert repr(found) == "<armgen.Postures of puma560: 8 postures, complete>"
    assert found.q.shape == (8, 6) and found.free.shape == (8, 6) and not found.free.any() and not found.double.any()
    assert found.branch.tolist() == sorted(set(found.branch.tolist())) and len(set(found.branch_names)) == 8
    assert all(found.branch_names) and np.array_equal(found[-1], found.q[-1]) and len(list(found)) == 8
    with pytest.raises(IndexError):
        found[8]
    far = pose.copy()
    far[0, 3] += 5
    nowhere = puma.inverse_kinematics(far)
    assert (len(nowhere), nowhere.verdict, nowhere.nearest_to(q)) == (0, "unreachable", None) and nowhere.miss > 1
    assert nowhere.q.shape == (0, 6) and nowhere.branch_names == () and len(nowhere.within_limits()) == 0
    assert nowhere.reason is None
    rounded = np.vstack([np.round(pose[:3], 4), pose[3]])
    for wrong, reason in [
        (np.full((4, 4), np.nan), "not finite"),
        (np.diag([1.0, 1, -1, 1]), "reflection"),
        (np.diag([2.0, 2, 2, 1]), r"R R' differs from 1 by 3.0e0"),
        (rounded, "1e-6 is the limit"),
    ]:
        found = puma.inverse_kinematics(wrong)
        assert found.verdict == "invalid" and reason in found.reason and found.reason in repr(found)
        assert found.within_limits().reason == found.reason
    u, _, v = np.linalg.svd(rounded[:3, :3])
    assert len(puma.inverse_kinematics(position=rounded[:3, 3], rotation=u @ v)) == 8
    # A wrist that is straight: the fourth and the sixth joint turn about one line.
    q[4] = 0
    straight = puma.inverse_kinematics(puma.direct_kinematics(q))
    assert straight.verdict == "continuum" and straight.free.any(axis=0)[[3, 5]].any()


def test_limits_and_the_nearest():
    robot = armgen.loads(POSITION)
    q = np.array([0.3, 0.6, -0.8])
    found = robot.inverse_kinematics(position=robot.direct_kinematics(q)[:3, 3])
    assert len(found) == 4 and apart(robot, found.nearest_to(q + [2 * np.pi, 0, -4 * np.pi]), q) < 1e-9
    within = found.within_limits()
    assert 0 < len(within) < 4 and within.verdict == found.verdict
    low, high = robot.position_limits.T
    assert ((low <= within.q) & (within.q <= high)).all()
    inside = [posture for posture in found if -1 <= posture[1] <= 1]
    assert np.abs(within.q - inside).max() == 0
    for wrong, error in [(q[:2], ValueError), ([q, q], ValueError), ([0, np.nan, 0], ValueError), (None, TypeError)]:
        with pytest.raises(error, match="^q: "):
            found.nearest_to(wrong)


def test_a_redundancy_is_given(panda, random):
    q = random.uniform(-2.5, 2.5, (200, 7))
    poses = panda.direct_kinematics(q)
    assert panda.redundancy == panda.joint_names[-1]
    angles = panda.inverse_kinematics_redundancy(q)
    assert angles.tolist() == q[:, 6].tolist() and panda.inverse_kinematics_redundancy(q[0]) == q[0, 6]
    for pose, own, found in zip(poses, q, panda.inverse_kinematics(poses, angles, threads=2), strict=True):
        assert apart(panda, found.q, own).min() < 1e-5 or found.verdict != "complete"
    angles = np.linspace(-2, 2, 5)
    for found, angle in zip(panda.inverse_kinematics(poses[0], angles), angles, strict=True):
        assert (np.abs(found.q[:, 6] - angle) < 1e-12).all()
    with pytest.raises(ValueError, match="redundancy is missing.*give the value of joint"):
        panda.inverse_kinematics(poses[0])
    ur5 = armgen.load(ROOT / "robots/ur5.yaml")
    assert ur5.redundancy is None
    with pytest.raises(ValueError, match="has no joint more"):
        ur5.inverse_kinematics(poses[0], 0.5)
    with pytest.raises(ValueError, match="has no redundancy"):
        ur5.inverse_kinematics_redundancy(q[0, :6])


def same(one, other):
    assert (one.verdict, one.miss) == (other.verdict, other.miss)
    for name in ("q", "branch", "double", "free"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()


def test_arrays_of_poses(random):
    robot = armgen.load(ROOT / "robots/ur5.yaml")
    poses = robot.direct_kinematics(random.uniform(-3, 3, (150, 6)))
    alone = [robot.inverse_kinematics(pose) for pose in poses]
    for threads in (1, 0, 3):
        for one, other in zip(alone, robot.inverse_kinematics(poses, threads=threads), strict=True):
            same(one, other)
    nested = robot.inverse_kinematics(poses.reshape(2, 75, 4, 4))
    assert [len(row) for row in nested] == [75, 75]
    same(nested[1][74], alone[149])
    for one, other in zip(alone, robot.inverse_kinematics(position=poses[:, :3, 3], rotation=poses[:, :3, :3]), strict=True):
        same(one, other)
    turned = robot.inverse_kinematics(position=poses[0, :3, 3], rotation=poses[:3, :3, :3])
    same(turned[0], alone[0])
    assert robot.inverse_kinematics(poses[:0]) == [] and robot.inverse_kinematics(np.zeros((2, 0, 4, 4))) == [[], []]
    same(robot.inverse_kinematics(poses[0].tolist()), alone[0])
    same(robot.inverse_kinematics(np.asfortranarray(poses[0])), alone[0])


def test_wrong_poses(panda):
    robot = armgen.load(ROOT / "robots/ur5.yaml")
    pose, p, turn = np.eye(4), np.zeros(3), np.eye(3)
    for call, said in [
        (lambda: robot.inverse_kinematics(pose[:3]), r"pose: the last axes are \(3, 4\), not \(4, 4\)"),
        (lambda: robot.inverse_kinematics(p), "pose: the last axis has 3 entries, not 4"),
        (lambda: robot.inverse_kinematics(pose[0]), r"pose: the last axes are \(4,\), not \(4, 4\)"),
        (lambda: robot.inverse_kinematics(1.0), "pose: a number"),
        (lambda: robot.inverse_kinematics(position=p, rotation=p), r"rotation: the last axes are \(3,\)"),
        (lambda: robot.inverse_kinematics(position=[p] * 2, rotation=[turn] * 3), "do not go together"),
        (lambda: robot.inverse_kinematics(pose, threads=-1), "threads"),
    ]:
        with pytest.raises(ValueError, match=said):
            call()
    for call, said in [
        (lambda: robot.inverse_kinematics(), "a pose is missing"),
        (lambda: robot.inverse_kinematics(position=p), "rotation is missing: 3 x 3"),
        (lambda: robot.inverse_kinematics(rotation=turn), "position is missing"),
        (lambda: robot.inverse_kinematics(pose, position=p), "not both"),
        (lambda: robot.inverse_kinematics(pose + 0j), "pose: real numbers"),
        (lambda: robot.inverse_kinematics(pose.astype(str)), "pose: real numbers"),
        (lambda: panda.inverse_kinematics(pose, "elbow"), "redundancy: real numbers"),
    ]:
        with pytest.raises(TypeError, match=said):
            call()
    with pytest.raises(ValueError, match="there is no `inverse_kinematics` of this arm: "):
        # Eight joints are two more than a pose asks for.
        armgen.loads(armgen.load(ROOT / "robots/panda7.yaml").text.replace("joints:", EIGHTH, 1)).inverse_kinematics(pose)


EIGHTH = """joints:
  - {name: rail, type: prismatic, a: 0, alpha: 0, d: 0, theta: 0, link: {mass: 1, com: [0, 0, 0]}}"""


@pytest.mark.parametrize("name", ["puma560", "ur5", "scara4", "panda7"])
def test_bits_are_those_of_the_emitted_c(name, random, tmp_path):
    compiler = shutil.which("cc") or pytest.skip("there is no `cc` here")
    robot = armgen.load(ROOT / f"robots/{name}.yaml")
    for file, text in robot.generate("c", name="arm", ik=True).items():
        (tmp_path / file).write_text(text)
    (tmp_path / "arm.c").write_text(f'#include "arm_ik.h"\n{CALLER.replace("ROBOT", robot.name)}'.replace("REDUNDANCY", ", redundancy" * bool(robot.redundancy)))
    subprocess.run([compiler, "-O1", "-shared", "-fPIC", "arm.c", "-o", "arm.so", "-lm"], cwd=tmp_path, check=True)
    solve = ctypes.CDLL(str(tmp_path / "arm.so")).solve
    solve.argtypes = [ctypes.c_void_p, ctypes.c_double, *[ctypes.c_void_p] * 7]
    postures = 0
    for number in range(300):
        q = configuration(random, robot)
        if number % 3 == 0:
            q = np.where(robot.revolute, np.round(q), 0) * np.pi / 2
        pose = robot.direct_kinematics(q)
        if number % 7 == 0:
            pose[0, 3] += 0.3
        own = given(robot, q)
        found = robot.inverse_kinematics(pose, *own)
        numbers, branches, doubles, frees = np.zeros((16, robot.dof)), *np.zeros((3, 16), np.int64)
        place, facts, within = np.full(robot.dof, 0.5), np.zeros(4, np.int64), np.zeros((16, robot.dof))
        arrays = [numbers, branches, doubles, frees, place, facts, within]
        count = solve(pose.ctypes.data, *(own or (0.0,)), *(array.ctypes.data for array in arrays))
        assert count == len(found), (q, pose)
        assert numbers[:count].tobytes() == found.q.tobytes()
        assert branches[:count].tolist() == found.branch.tolist() and doubles[:count].tolist() == found.double.tolist()
        assert [[free >> joint & 1 for joint in range(robot.dof)] for free in frees[:count]] == found.free.tolist()
        verdict, nearest, inside, miss = facts
        assert VERDICTS[verdict] == found.verdict and np.float64(found.miss).view(np.int64) == miss
        expected = found.nearest_to(place)
        assert expected is None if nearest < 0 else expected.tobytes() == numbers[nearest].tobytes()
        assert within[:inside].tobytes() == found.within_limits().q.tobytes()
        postures += count
    assert postures > 300


VERDICTS = ["complete", "unreachable", "near_double", "continuum", "invalid"]

CALLER = """
#include <string.h>

int solve(const void *pose, double redundancy, void *q, int64_t *branch, int64_t *is_double, int64_t *is_free, const double *place, int64_t *facts, void *kept)
{
    double t[4][4];
    ROBOT_solutions found, within;
    memcpy(t, pose, sizeof t);
    (void)redundancy;
    ROBOT_inverse_kinematics((const double (*)[4])t REDUNDANCY, &found);
    for (uint32_t i = 0; i < found.count; ++i) {
        memcpy((char *)q + i * sizeof found.all[i].q, found.all[i].q, sizeof found.all[i].q);
        branch[i] = found.all[i].branch;
        is_double[i] = found.all[i].is_double;
        is_free[i] = found.all[i].free;
    }
    ROBOT_within_limits(&found, &within);
    for (uint32_t i = 0; i < within.count; ++i)
        memcpy((char *)kept + i * sizeof within.all[i].q, within.all[i].q, sizeof within.all[i].q);
    facts[0] = found.verdict;
    facts[1] = ROBOT_nearest_to(&found, place);
    facts[2] = within.count;
    memcpy(&facts[3], &found.miss, sizeof found.miss);
    return (int)found.count;
}
"""
