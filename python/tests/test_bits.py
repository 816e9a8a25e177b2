"""Numbers have the bits of the module that `generate("python")` gives, under NumPy: every robot, every function."""

import types

import numpy as np
import pytest

import armgen
from conftest import ROBOTS


def module(robot):
    (text,) = robot.generate("python", name="emitted").values()
    emitted = types.ModuleType("emitted")
    # Its types of several results look for the module.
    import sys

    sys.modules["emitted"] = emitted
    exec(compile(text, "emitted.py", "exec"), emitted.__dict__)
    return emitted


def given(random, robot, function, states):
    """Vectors of a usual size with zeros of both signs and large numbers among them: sums of angles stay below 65536 rad, beyond which
    sines are those of NumPy in one of the two, and of libm in the other."""
    arguments = []
    for name in function.arguments:
        length = len(robot.parameter_names) if name == "pi" else robot.dof
        vectors = random.uniform(-4, 4, (*states, length))
        special = random.choice([0.0, -0.0, 1e4, -1e-310], vectors.shape)
        arguments.append(np.where(random.random(vectors.shape) < 0.03, special, vectors))
    return arguments


def bits(result):
    return np.ascontiguousarray(result, dtype=np.float64).tobytes()


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_every_function_has_the_bits_of_the_emitted_module(path, random):
    robot = armgen.load(path)
    robot.prepare()
    emitted = module(robot)
    assert all(hasattr(emitted, name) for name in robot.functions)
    compared = 0
    for name in robot.functions:
        function = getattr(robot, name)
        for states in [(), (7,), (200,)]:
            arguments = given(random, robot, function, states)
            with np.errstate(all="ignore"):
                expected = getattr(emitted, name)(*arguments)
            found = function(*arguments)
            if isinstance(found, tuple):
                assert type(found).__name__ == type(expected).__name__ and found._fields == expected._fields
            else:
                found, expected = (found,), (expected,)
            for own, other in zip(found, expected, strict=True):
                assert np.shape(own) == np.shape(other), (name, states)
                assert bits(own) == bits(other), (name, states)
                compared += np.size(own)
    assert compared > 1000


def test_bits_depend_neither_on_threads_nor_on_states(panda, random):
    q, dq, ddq = random.uniform(-3, 3, (3, 1000, 7))
    together = panda.inverse_dynamics(q, dq, ddq)
    assert bits(together) == bits(panda.inverse_dynamics(q, dq, ddq, threads=0))
    assert bits(together) == bits(panda.inverse_dynamics(q, dq, ddq, threads=3))
    assert bits(together) == bits([panda.inverse_dynamics(*state) for state in zip(q, dq, ddq)])
    both = panda.forward_dynamics_derivatives(q, dq, together)
    for own, other in zip(both, panda.forward_dynamics_derivatives(q, dq, together, threads=2)):
        assert bits(own) == bits(other)
