"""Arrays of every kind: taken without a loss, or refused with a reason."""

import concurrent.futures
import gc
import resource

import numpy as np
import pytest


@pytest.fixture(scope="session")
def q():
    return np.random.default_rng(2).uniform(-3, 3, (4, 7))


def same(one, other):
    assert one.shape == other.shape and one.tobytes() == other.tobytes()


def test_kinds_of_numbers(panda, q):
    whole = np.array([1, 0, 1, -2, 0, 1, 3])
    expected = panda.gravity(whole.astype(float))
    for kind in ["i1", "i2", "i4", "i8", "f2", "f4", "f8", ">f8", ">i4", "<f4", "g"]:
        same(panda.gravity(whole.astype(kind)), expected)
    same(panda.gravity(whole.tolist()), expected)
    same(panda.gravity(tuple(whole)), expected)
    same(panda.gravity(np.abs(whole).astype("u1")), panda.gravity(np.abs(whole)))
    same(panda.gravity(whole != 0), panda.gravity((whole != 0) * 1.0))
    for wrong in [q[0] + 0j, q[0].astype(str), q[0].astype(object), "0123456", None, [None] * 7, q[0].astype("M8[s]"), {}]:
        with pytest.raises(TypeError, match="^q: real numbers, not "):
            panda.gravity(wrong)
    with pytest.raises(TypeError, match="masked"):
        panda.gravity(np.ma.array(q[0], mask=[1, 0, 0, 0, 0, 0, 0]))


def test_places_of_numbers(panda, q):
    expected = panda.gravity(q)
    same(panda.gravity(np.asfortranarray(q)), expected)
    same(panda.gravity(np.repeat(q, 2, axis=1)[:, ::2]), expected)
    same(panda.gravity(q[::-1, ::-1])[::-1], panda.gravity(q[:, ::-1]))
    same(panda.gravity(q[0, ::-1]), panda.gravity(q[0, ::-1].copy()))
    apart = np.frombuffer(b"x" + q.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(q.shape)
    same(panda.gravity(apart), expected)
    same(panda.gravity(apart[0]), expected[0])
    fixed = q.copy()
    fixed.flags.writeable = False
    same(panda.gravity(fixed), expected)


def test_states_broadcast(panda, q):
    for count in (3, 80):
        dq = np.linspace(-1, 1, count * 7).reshape(count, 1, 7)
        found = panda.inverse_dynamics(q, dq, q[0])
        assert found.shape == (count, 4, 7)
        same(found[2, 1], panda.inverse_dynamics(q[1], dq[2, 0], q[0]))
    assert panda.inertia_matrix(q).shape == (4, 7, 7)
    assert panda.link_frames(q).shape == (4, 7, 4, 4)
    assert panda.kinetic_energy(q, q).shape == (4,)
    assert type(panda.kinetic_energy(q[0], q[0])) is float
    assert panda.equations_of_motion(q, q).inertia.shape == (4, 7, 7)
    for shape in [(0, 7), (3, 0, 7)]:
        assert panda.gravity(np.zeros(shape)).shape == shape
    with pytest.raises(ValueError, match=r"q \(4,\), dq \(3,\)"):
        panda.coriolis_matrix(q, q[:3])
    with pytest.raises((ValueError, MemoryError)):
        panda.coriolis_matrix(np.broadcast_to(0.0, (2**31, 1, 7)), np.broadcast_to(0.0, (2**31, 7)))


def test_lengths(panda, q):
    for wrong, said in [(q[:, :6], "the last axis has 6 entries, not 7"), (q.T, "leading axes: transpose it"), (0.5, "a number"), (q[0, :0], "has 0 entries")]:
        with pytest.raises(ValueError, match=said):
            panda.gravity(wrong)
    with pytest.raises(ValueError):
        panda.gravity([[0.0] * 7, [0.0] * 6])
    for call, said in [
        (lambda: panda.gravity(), "q is missing"),
        (lambda: panda.gravity(q, q), "takes 1 arguments, not 2"),
        (lambda: panda.gravity(q, q=q), "q is given twice"),
        (lambda: panda.gravity(q, dq=q), "has no argument dq"),
        (lambda: panda.gravity(q, threads="2"), "str"),
    ]:
        with pytest.raises(TypeError, match=said):
            call()
    with pytest.raises(ValueError, match="threads"):
        panda.gravity(q, threads=-1)
    same(panda.gravity(q=q), panda.gravity(q))
    same(panda.gravity(q, threads=10**9), panda.gravity(q))


def test_numbers_that_are_none(panda):
    q = np.array([np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 0.0])
    assert np.isnan(panda.gravity(q)).any()
    assert panda.gravity(np.tile(q, (300, 1))).shape == (300, 7)


def test_results_are_fresh_or_where_they_are_asked_for(panda, q):
    for found in (panda.gravity(q[0]), panda.inertia_matrix(q[0]), panda.gravity(q), panda.link_frames(q[0])):
        assert found.flags.owndata and found.flags.c_contiguous and found.flags.writeable and found.dtype == np.float64
    out = np.empty((4, 7))
    assert panda.gravity(q, out=out) is out
    same(out, panda.gravity(q))
    one = np.empty(7)
    assert panda.gravity(q[0], out=one) is one
    same(one, out[0])
    number = np.empty(())
    assert panda.kinetic_energy(q[0], q[0], out=number) is number and number == panda.kinetic_energy(q[0], q[0])
    parts = (np.empty((4, 7, 7)), np.empty((4, 7, 7)))
    found = panda.inverse_dynamics_derivatives(q, q, q, out=parts)
    assert found.by_q is parts[0] and found.by_dq is parts[1]
    same(parts[1], panda.inverse_dynamics_derivatives(q, q, q).by_dq)
    fixed = np.empty((4, 7))
    fixed.flags.writeable = False
    for wrong in [np.empty((4, 6)), np.empty((7, 4)).T, np.empty((1, 4, 7)), q, q[::-1], fixed]:
        with pytest.raises(ValueError):
            panda.gravity(q, out=wrong)
    for wrong in [np.empty((4, 7), "f4"), np.empty((4, 7), ">f8"), [0.0] * 7, 3]:
        with pytest.raises(TypeError):
            panda.gravity(q, out=wrong)
    with pytest.raises(ValueError, match="overlaps"):
        panda.inverse_dynamics_derivatives(q, q, q, out=(parts[0], parts[0]))
    with pytest.raises(TypeError, match="tuple of 2"):
        panda.inverse_dynamics_derivatives(q, q, q, out=parts[0])


def test_threads_share_a_robot(scara, random):
    import armgen

    robot = armgen.loads(scara.text)
    q = random.uniform(-3, 3, (8, 500, 4))
    expected = scara.inverse_dynamics(q, q, q)
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        for _ in range(5):
            found = list(pool.map(lambda states: robot.inverse_dynamics(states, states, states), q))
            same(np.array(found), expected)
            alone = pool.map(lambda states: [robot.gravity(state) for state in states], q)
            same(np.array(list(alone)), scara.gravity(q))


def test_memory_is_given_back(panda, q):
    def grown(call, times):
        for _ in range(1000):
            call()
        gc.collect()
        before = resident()
        for _ in range(times):
            call()
        gc.collect()
        return resident() - before

    def resident():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize()

    def refused():
        with pytest.raises(ValueError):
            panda.gravity(q[0, :6])

    assert grown(lambda: panda.gravity(q[0]), 100_000) < 1 << 20
    assert grown(lambda: panda.inverse_dynamics_derivatives(q[0], q[0], q[0]), 20_000) < 1 << 20
    assert grown(lambda: panda.coriolis_matrix(q, q[0]), 20_000) < 1 << 20
    assert grown(refused, 5_000) < 1 << 20


def test_many_states(scara):
    q = np.zeros((10**7, 4), dtype=np.float32)
    found = scara.kinetic_energy(q, q[0], threads=0)
    assert found.shape == (10**7,) and not found.any()
