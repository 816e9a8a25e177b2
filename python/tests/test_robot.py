"""From texts to robots: facts, faults, names, copies and texts."""

import copy
import pickle
import re
import subprocess
import warnings

import numpy as np
import pytest

import armgen
from armgen import _native
from conftest import ROBOTS, ROOT

ARM = """<robot name="arm">
  <link name="base"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" velocity="3" effort="4"/></joint>
  <link name="upper"><inertial><mass value="2"/><origin xyz="0.5 0 0"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="upper"/><child link="hand"/><axis xyz="1 0 0"/><origin rpy="1.5708 0 0"/>
    <limit lower="0" upper="1" velocity="1" effort="1"/></joint>
  <link name="hand"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""


def test_facts_of_a_description(panda):
    assert (panda.name, panda.dof, panda.report) == ("panda7", 7, None)
    assert repr(panda) == "<armgen.Robot panda7: 7 joints, 16.8 kg>"
    assert panda.revolute.all() and panda.task[0] == "x" and len(panda.joint_names) == 7
    assert panda.position_limits.shape == (7, 2) and panda.velocity_limits.shape == panda.effort_limits.shape == (7,)
    assert panda.gravity_vector.tolist() == [0, 0, -9.81]
    assert len(panda.parameter_names) == len(panda.nominal_parameters)
    assert len(panda.base_parameter_names) == len(panda.nominal_base_parameters) == panda.base_regressor.shape[1]
    assert set(panda.functions) <= set(dir(panda)) and not set(panda.functions) & set(panda.absent)
    q = np.linspace(-1, 1, 7)
    torque = panda.regressor(q, q, q, q) @ panda.nominal_parameters
    assert np.abs(torque - panda.inverse_dynamics(q, q, q)).max() < 1e-12


def test_a_payload_is_a_body_of_the_description(panda):
    com, inertia = [0.04, 0.01, -0.02], np.array([[0.03, 0.001, -0.002], [0.001, 0.04, 0.003], [-0.002, 0.003, 0.02]])
    names = dict(zip(("xx", "xy", "yy", "xz", "yz", "zz"), inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]].tolist()))
    empty = armgen.loads(panda.text + "payload: {}\n")
    full = armgen.loads(panda.text + f"payload: {{mass: 2.5, com: {com}, inertia: {names}}}\n".replace("'", ""))
    pi = empty.nominal_parameters.copy()
    pi[empty.parameter_names.index("mp"):][:10] = empty.payload_parameters(2.5, com, inertia)
    q = np.linspace(-1, 1, 7)
    assert np.abs(empty.inverse_dynamics_with(pi, q, q, q) - full.inverse_dynamics(q, q, q)).max() < 1e-11
    # The same bits as the emitted function.
    scope = {}
    exec(next(iter(empty.generate("python", functions=["gravity_with"]).values())), scope)
    emitted = scope["payload_parameters"](2.5, com, inertia.tolist())
    assert empty.payload_parameters(2.5, com, inertia).tolist() == list(emitted)
    point = empty.payload_parameters(2, [0, 0, 0.1])
    assert point.tolist() == [2, 0, 0, 0.2, 2 * 0.1 * 0.1, 0, 2 * (0.1 * 0.1), 0, 0, 0]
    with pytest.raises(ValueError, match="no payload: `payload: {}`"):
        panda.payload_parameters(1, [0, 0, 0])
    with pytest.raises(ValueError, match="3 x 3 numbers, not 3"):
        empty.payload_parameters(1, [0, 0, 0], [1, 1, 1])


def test_facts_of_a_urdf():
    robot = armgen.loads(ARM, "arm.urdf")
    assert robot.joint_names == ("shoulder", "slide") and robot.revolute.tolist() == [True, False]
    assert robot.position_limits.tolist() == [[-1, 2], [0, 1]] and robot.effort_limits.tolist() == [4, 1]
    assert robot.report["format"] == "urdf" and len(robot.report["snapped"]) == 1
    assert robot.text.splitlines()[-1] and armgen.loads(robot.text).functions == robot.functions
    q, dq, ddq = np.array([[0.3, 0.5], [1.1, -0.7], [0.2, 0.4]])
    # (I1 + m1/4 + I2 + m2 d^2) q1'' + 2 m2 d d' q1' , m2 (d'' - d q1'^2)
    inertia = 0.1 + 2 / 4 + 0.1 + 0.5**2
    expected = [inertia * ddq[0] + 2 * 0.5 * dq[1] * dq[0], ddq[1] - 0.5 * dq[0] ** 2]
    assert np.abs(robot.inverse_dynamics(q, dq, ddq) - expected).max() < 1e-12
    locked = armgen.loads(ARM, "arm.urdf", lock={"slide": 0.25}, snap=0, massless=True)
    assert locked.dof == 1 and not locked.report["snapped"]
    assert armgen.loads(ARM, "arm.urdf", tip="upper").dof == 1


def test_files(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(ARM)
    assert armgen.load(file, name="mine").name == armgen.load(str(file), name="mine").name == "mine"
    with pytest.raises(FileNotFoundError):
        armgen.load(tmp_path / "none.yaml")
    with pytest.raises(IsADirectoryError):
        armgen.load(tmp_path)
    file.write_bytes(b"name: a\nb: \xff\n")
    with pytest.raises(armgen.DescriptionError) as caught:
        armgen.load(file)
    assert caught.value.diagnostics[0].code == "not-utf-8" and caught.value.diagnostics[0].line == 2
    part, model = tmp_path / "part.xml", tmp_path / "arm.xml"
    part.write_text('<mujocoinclude><body name="a"><joint name="j" axis="0 0 1"/><inertial pos="0.1 0 0" mass="1" diaginertia="1 1 1"/></body></mujocoinclude>')
    model.write_text('<mujoco><worldbody><include file="part.xml"/></worldbody></mujoco>')
    robot = armgen.load(model)
    assert robot.joint_names == ("j",)
    part.unlink()
    assert pickle.loads(pickle.dumps(robot)) == robot


@pytest.mark.parametrize("option", [{"base": "a"}, {"tip": "a"}, {"tip": ["a", "b"]}, {"all": True}, {"lock": {"a": 1}}, {"snap": 0}, {"massless": True}])
def test_options_of_import_need_something_to_import(scara, option):
    with pytest.raises(TypeError, match="is an option of the import"):
        armgen.loads(scara.text, **option)


def test_wrong_options():
    for option, error in [
        ({"lock": "slide=0"}, TypeError),
        ({"tip": []}, TypeError),
        ({"tip": 3}, TypeError),
        ({"tip": [3]}, TypeError),
        ({"tip": "hand", "all": True}, TypeError),
        ({"base": 3}, TypeError),
        ({"lock": {"slide": None}}, TypeError),
        ({"lock": {"slide": True}}, TypeError),
        ({"snap": 1}, ValueError),
        ({"snap": float("nan")}, ValueError),
        ({"allow": "no-effect"}, TypeError),
        ({"allow": ["nothing"]}, ValueError),
        ({"tip": "nowhere"}, armgen.DescriptionError),
    ]:
        with pytest.raises(error):
            armgen.loads(ARM, "arm.urdf", **option)
    for wrong in [b"name: a", None, 3]:
        with pytest.raises(TypeError):
            armgen.loads(wrong)


def test_messages_name_arguments():
    for message, own in [
        ("`--tip tool0`", '`tip="tool0"`'),
        ("`--tip a --lock b=0` leaves", '`tip="a", lock={"b": 0}` leaves'),
        ("`--lock finger=VALUE`", '`lock={"finger": VALUE}`'),
        ("`--lock b=pi/4` and `--lock c=-1.5e-3`", '`lock={"b": "pi/4"}` and `lock={"c": -1.5e-3}`'),
        ("`--lock` names `x`", "`lock` names `x`"),
        ("`--snap TOL`, `--massless`, `--base root`", '`snap=TOL`, `massless=True`, `base="root"`'),
        ("<!-- tip -->", "<!-- tip -->"),
    ]:
        assert armgen._in_python(message) == own
    with pytest.raises(armgen.DescriptionError, match='`tip="gripper_frame_link"`') as caught:
        armgen.load(ROOT / "robots/so101.urdf")
    assert '`lock={"gripper": 0}`' in str(caught.value) and "--" not in caught.value.diagnostics[0].help


def test_several_end_effectors():
    file = ROOT / "tests/data/trees/two_arms.urdf"
    names = [("left_hand", "right_hand"), ("left", "right")]
    for robot, (left, right) in [
        (armgen.load(file, all=True), names[0]),
        (armgen.load(file, tip=names[0]), names[0]),
        (armgen.load(file, tip=dict(zip(names[1], names[0]))), names[1]),
    ]:
        assert {f"{left}_direct_kinematics", f"{right}_geometric_jacobian"} <= set(robot.functions)
        assert pickle.loads(pickle.dumps(robot)) == robot and robot.redundancy is None
    assert armgen.load(file, tip=["left_hand"]).dof == armgen.load(file, tip="left_hand").dof < robot.dof


def test_doubts_are_warnings():
    text = ARM.replace('lower="-1" upper="2"', 'lower="-110" upper="110"')
    with pytest.warns(armgen.DescriptionWarning, match=r"of robot\.text: .*degrees") as caught:
        robot = armgen.loads(text, "arm.urdf")
    assert [warning.filename for warning in caught] == [__file__] * len({found.code for found in robot.warnings})
    # What a summary says of an import, and all warnings with their places.
    said = robot.check()
    assert "1 number taken" in said and all(f"warning[{found.code}]" in said for found in robot.warnings)
    assert any("1 number taken" in note for note in robot.notes)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pickle.loads(pickle.dumps(robot)).warnings == robot.warnings
        kinds = [found.code for found in robot.warnings]
        assert armgen.loads(text, "arm.urdf", allow=kinds).warnings == () and armgen.loads(ARM, "arm.urdf").warnings == ()


def test_every_faulty_file_is_an_exception_with_places():
    files = sorted(ROOT.glob("tests/bad/*.yaml"))
    refused = 0
    for path in files:
        text = path.read_text(encoding="utf-8")
        try:
            robot = armgen.loads(text, path.name)
        except armgen.DescriptionError as error:
            refused += 1
            assert any(found.severity == "error" for found in error.diagnostics), path
            for found in error.diagnostics:
                assert found.file == path.name and 1 <= found.line <= text.count("\n") + 2
                assert (found.line, found.column) == (found.labels[0].line, found.labels[0].column)
                assert found.help and f"[{found.code}]" in str(error)
            copied = pickle.loads(pickle.dumps(error))
            assert copied.diagnostics == error.diagnostics and str(copied) == str(error)
            continue
        assert all(found.severity == "warning" for found in robot.warnings), path
        if robot.warnings:
            with pytest.raises(armgen.DescriptionError):
                armgen.loads(text, path.name, strict=True)
            assert armgen.loads(text, allow=[found.code for found in robot.warnings], strict=True).warnings == ()
    assert refused > 50


def test_the_exception_shows_the_place(scara):
    text = re.sub(r"mass: .*", "mass: -2", scara.text, count=1)
    with pytest.raises(armgen.DescriptionError) as caught:
        armgen.loads(text, "arm.yaml")
    found = next(found for found in caught.value.diagnostics if found.code == "negative-mass")
    assert text.splitlines()[found.line - 1][found.column - 1 : found.end_column - 1] == "-2"
    assert f"arm.yaml:{found.line}:{found.column}" in str(caught.value) and "^^" in str(caught.value)


def test_names_of_others_are_answered(panda):
    for other, own in [
        ("mass_matrix", "inertia_matrix"),
        ("crba", "inertia_matrix"),
        ("rnea", "inverse_dynamics"),
        ("aba", "forward_dynamics"),
        ("jacob0", "geometric_jacobian"),
        ("fkine", "direct_kinematics"),
        ("computeCoriolisMatrix", "coriolis_matrix"),
        ("mj_fullM", "inertia_matrix"),
        ("CalcMassMatrix", "inertia_matrix"),
        ("gravload", "gravity"),
        ("gravty", "gravity"),
        ("joint_name", "joint_names"),
    ]:
        with pytest.raises(AttributeError, match=f"here it is `{own}`"):
            getattr(panda, other)
    for name, reason in panda.absent.items():
        with pytest.raises(AttributeError, match=re.escape(reason)):
            getattr(panda, name)
        with pytest.raises(ValueError, match=re.escape(reason)):
            panda.prepare(name)
    assert panda.absent
    with pytest.raises(ValueError, match="do you mean `gravity`"):
        panda.prepare("gravty")


def test_robots_do_not_change_and_copies_are_equal(scara):
    for change in [lambda: setattr(scara, "dof", 3), lambda: delattr(scara, "dof")]:
        with pytest.raises(AttributeError):
            change()
    with pytest.raises(ValueError):
        scara.position_limits[0, 0] = 1
    with pytest.raises(TypeError):
        armgen.Robot()
    assert copy.copy(scara) is scara and copy.deepcopy(scara) is scara
    for robot in (scara, armgen.loads(ARM, "arm.urdf", lock={"slide": "1/4"})):
        copied = pickle.loads(pickle.dumps(robot))
        assert copied == robot and hash(copied) == hash(robot) and copied is not robot
        q = np.full(robot.dof, 0.3)
        assert pickle.loads(pickle.dumps(robot.gravity))(q).tobytes() == robot.gravity(q).tobytes()
    assert armgen.loads(ARM, "arm.urdf") != armgen.loads(ARM, "arm.urdf", snap=0)
    result = scara.inverse_dynamics_derivatives(*np.zeros((3, 4)))
    assert np.array_equal(pickle.loads(pickle.dumps(result)).by_q, result.by_q)


def test_functions_speak_of_themselves(scara):
    f = scara.inverse_dynamics_with
    assert (f.__name__, f.arguments, f.shape, f.unit) == ("inverse_dynamics_with", ("pi", "q", "dq", "ddq"), (4,), "N m or N")
    assert repr(f) == "<armgen.Function inverse_dynamics_with(pi, q, dq, ddq) of scara4>"
    assert scara.inverse_dynamics_derivatives.shape.by_q == (4, 4)
    assert scara.kinetic_energy.shape == () and scara.link_frames.shape == (4, 4, 4)
    assert scara.inertia_matrix.operations["sincos"] == 1 and scara.inertia_matrix.derivation
    for name in scara.functions:
        assert getattr(scara, name).__doc__.startswith(f"{name}(") and "{" not in getattr(scara, name).__doc__


def test_panics_are_exceptions(scara):
    with pytest.raises(armgen.InternalError, match="asked for.*report"):
        _native.panic()
    assert scara.gravity(np.zeros(4)).shape == (4,)


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_texts_are_those_of_the_program(path, tmp_path):
    robot = armgen.load(path)

    def program(*arguments):
        done = subprocess.run(["armgen", *arguments], capture_output=True, text=True, check=True)
        return done.stdout

    said = robot.check()
    assert said.startswith(program("check", str(path))) and said.count("warning[") == len(robot.warnings)
    assert robot.show("gravity") == program("show", str(path), "gravity")
    assert robot.latex("gravity", form=None) == program("show", str(path), "gravity", "--format", "latex")


def test_texts(scara, tmp_path):
    assert "inertia_matrix: B(q), 4 x 4" in scara.show("inertia_matrix")
    assert "\\cos" in scara.latex("inertia_matrix")
    assert "m_l1" in armgen.load(ROOT / "robots/scara.yaml").show("inertia_matrix", symbolic=True)
    assert scara.show("gravity", digits=3) and "solution" in scara.show("inverse_kinematics")
    for call, said in [
        (lambda: scara.show("gravty"), "did you mean `gravity`"),
        (lambda: scara.show("gravity", form="long"), "form"),
        (lambda: scara.show("gravity", digits=0), "digits"),
        (lambda: scara.generate("cpp"), '"c" is C\\+\\+, too'),
        (lambda: scara.generate("python", fma=True), "--fma"),
        (lambda: scara.generate("python", functions=["gravty"]), "do you mean `gravity`"),
    ]:
        with pytest.raises(ValueError, match=said):
            call()
    page = scara.page()
    assert page.startswith("<!DOCTYPE html>") or page.lower().startswith("<!doctype html>")
    assert scara.page(tmp_path / "arm.html") is None and (tmp_path / "arm.html").read_text(encoding="utf-8") == page
    html = scara._repr_html_()
    assert html.startswith('<iframe sandbox="allow-scripts"') and html.count("<") == html.count(">") == 2
    import html as escapes

    assert escapes.unescape(html.split('srcdoc="')[1].split('" style')[0]) == page


def test_generated_files_are_those_of_the_program(tmp_path):
    path = ROOT / "robots/scara4.yaml"
    robot = armgen.load(path)
    for language, out, options, words in [
        ("rust", "arm.rs", {"ik": True, "runtime": True}, ["--ik", "--runtime"]),
        ("c", "arm.h", {"functions": ["gravity"], "scalar": "f32"}, ["--functions", "gravity", "--scalar", "f32"]),
        ("python", "arm.py", {"native": True}, ["--native"]),
        ("matlab", "+arm", {}, []),
    ]:
        folder = tmp_path / language
        folder.mkdir()
        subprocess.run(
            ["armgen", "generate", path, "--language", language, "--out", folder / out, *words], check=True, capture_output=True
        )
        folder = folder / out if language == "matlab" else folder
        written = {file.name: file.read_text(encoding="utf-8") for file in folder.iterdir()}
        assert robot.generate(language, name="arm", **options) == written


def test_sympy(scara, panda):
    sympy = pytest.importorskip("sympy")
    scara = armgen.load(ROOT / "robots/scara.yaml")
    inertia = scara.sympy("inertia_matrix")
    q2 = sympy.Symbol("q2")
    assert inertia[0, 0] == 10 * sympy.cos(q2) + sympy.Rational(10763, 500)
    assert {symbol.name for symbol in scara.sympy("inertia_matrix", symbolic=True).free_symbols} >= {"q2", "m_l1"}
    frames = scara.sympy("link_frames")
    assert len(frames) == 4 and frames[0].shape == (4, 4)
    q = np.linspace(-1, 1, 7)
    for name in ("gravity", "inertia_matrix"):
        computed = sympy.lambdify([f"q{k + 1}" for k in range(7)], panda.sympy(name), cse=True)
        found = np.array(computed(*q)).reshape(getattr(panda, name).shape)
        assert np.abs(found - getattr(panda, name)(q)).max() < 1e-12


def test_stub():
    import stub

    path = ROOT / "python/armgen/__init__.pyi"
    assert path.read_text(encoding="utf-8") == stub.text(), "run python/tests/stub.py"


def test_gravity_may_be_an_argument() -> None:
    text = (ROOT / "robots/scara4.yaml").read_text()
    fixed = armgen.loads(text, name="fixed.yaml")
    line = next(line for line in text.splitlines() if line.startswith("gravity:"))
    mounted = armgen.loads(text.replace(line, "gravity: {argument: " + line.split(":", 1)[1] + "}"), name="mounted.yaml")
    q, g0 = np.array([0.3, -0.5, 0.1, 0.7]), fixed.gravity_vector
    assert mounted.gravity.arguments[0] == "g0" and "g0" not in fixed.gravity.arguments
    np.testing.assert_allclose(mounted.gravity(g0, q), fixed.gravity(q), rtol=0, atol=1e-12)
    np.testing.assert_allclose(mounted.gravity(2 * g0, q), 2 * fixed.gravity(q), rtol=0, atol=1e-12)
    assert mounted.inertia_matrix(q).tobytes() == fixed.inertia_matrix(q).tobytes()
