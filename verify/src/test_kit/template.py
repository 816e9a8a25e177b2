# What is the same in the test file of every robot: everything after the line BEGIN is taken in as it stands.
# BEGIN
import numpy as np

STATES = [{name: np.asarray(value, dtype=robot.DTYPE) for name, value in state.items()} for state in STATES]
DOF, NOMINAL = robot.DOF, np.asarray(robot.NOMINAL_PARAMETERS, dtype=robot.DTYPE)
EPSILON = float(np.finfo(robot.DTYPE).eps)
# Some thousand roundings; forward dynamics is judged by its residual.
ROUNDING = 4096 * EPSILON
# A power of two near the cube root of epsilon: differences of this step have errors of about its square.
STEP = 1 / 131072 if EPSILON < 1e-12 else 1 / 128
DIFFERENCES = 1e3 * STEP * STEP


def scale(value):
    """Largest of 1 and the sizes of some entries."""
    return max(1.0, float(np.max(np.abs(value), initial=0.0)))


def flat(value):
    """All entries in a row."""
    return np.concatenate([np.ravel(part) for part in value]) if isinstance(value, tuple) else np.ravel(value)


def agree(what, found, expected, tolerance):
    found, expected = flat(found), flat(expected)
    assert found.shape == expected.shape, what
    # Not true of what is not a number.
    assert np.all(np.abs(found - expected) <= tolerance * scale(expected)), f"{what}: {found} for {expected}"


def random_states():
    """A row of random states, the same on every machine: 20 states at a time."""
    bits = 4711

    def many(size):
        nonlocal bits
        rows = []
        for _ in range(20 * DOF):
            bits = bits * 16807 % 2147483647
            rows.append((bits / 1073741824 - 1) * size)
        return np.asarray(rows, dtype=robot.DTYPE).reshape(20, DOF)

    return many(3), many(2), many(4), many(20)


def times(m, v):
    return np.sum(m * v[..., None, :], axis=-1)


def test_functions_have_the_values_of_the_equations():
    for name, state, found, expected in values():
        # An inverse loses what the condition of its matrix takes.
        lost = 256 if name == "operational_inertia" or name.startswith("forward_dynamics") else 1
        agree(f"{name} at state {state}", found, np.asarray(expected, dtype=robot.DTYPE), lost * ROUNDING)


def test_forward_dynamics_solves_the_equation_of_motion():
    q, dq, _, tau = random_states()
    ddq = robot.forward_dynamics(q, dq, tau)
    terms = times(robot.inertia_matrix(q), ddq)
    agree("tau", robot.inverse_dynamics(q, dq, ddq), tau, ROUNDING * scale(terms))


def test_the_inertia_matrix_is_symmetric_and_positive_definite():
    b = robot.inertia_matrix(random_states()[0])
    assert np.array_equal(b, np.swapaxes(b, -1, -2)), "B is symmetric to the last bit"
    assert np.all(np.linalg.eigvalsh(b) > 0), "B is positive definite"


def test_inertia_rates_minus_twice_coriolis_are_skew():
    q, dq, _, _ = random_states()
    step = np.asarray(STEP, dtype=robot.DTYPE)
    rates = (robot.inertia_matrix(q + step * dq) - robot.inertia_matrix(q - step * dq)) / (2 * step)
    skew = rates - 2 * robot.coriolis_matrix(q, dq)
    assert np.max(np.abs(skew + np.swapaxes(skew, -1, -2))) <= DIFFERENCES * scale(robot.inertia_matrix(q))


def test_torques_are_those_of_the_matrices_and_of_the_regressor():
    q, dq, ddq, _ = random_states()
    b, c, g = robot.inertia_matrix(q), robot.coriolis_matrix(q, dq), robot.gravity(q)
    agree("equations_of_motion", robot.equations_of_motion(q, dq), (b, c, g), ROUNDING)
    tau = robot.inverse_dynamics(q, dq, ddq)
    tau = tau - robot.load_friction(q, dq) # with load friction
    agree("inverse_dynamics", tau, times(b, ddq) + times(c, dq) + robot.friction(dq) + g, ROUNDING)
    y = robot.regressor(q, dq, dq, ddq)
    by_parameters = np.sum(y * NOMINAL, axis=-1) + robot.known_torque(q, dq, dq, ddq)
    agree("Y pi + tau_known", by_parameters, tau, ROUNDING * max(scale(NOMINAL), scale(y)))


def test_functions_at_run_time_parameters_are_the_plain_ones_at_the_nominal_parameters():
    q, dq, ddq, _ = random_states()
    size = ROUNDING * scale(NOMINAL)
    agree("inertia_matrix_with", robot.inertia_matrix_with(NOMINAL, q), robot.inertia_matrix(q), size)
    agree("gravity_with", robot.gravity_with(NOMINAL, q), robot.gravity(q), size)
    agree("inverse_dynamics_with", robot.inverse_dynamics_with(NOMINAL, q, dq, ddq), robot.inverse_dynamics(q, dq, ddq), size)


def test_gravity_is_the_slope_of_the_potential_energy():
    q = random_states()[0]
    g = robot.gravity(q)
    size = max(scale(robot.potential_energy(q)), scale(g))
    for k in range(DOF):
        step = np.asarray([STEP if i == k else 0 for i in range(DOF)], dtype=robot.DTYPE)
        slope = (robot.potential_energy(q + step) - robot.potential_energy(q - step)) / (2 * STEP)
        assert np.max(np.abs(slope - g[..., k])) <= DIFFERENCES * size, f"dU/dq{k + 1}"


def test_parameters_have_their_places():
    assert [robot.PARAMETER_INDEX[name] for name in robot.PARAMETER_NAMES] == list(range(robot.PARAMETERS))


def test_a_payload_has_its_parameters(): # with a payload
    """Steiner: 2 kg at (1, 2, 3), about the origin.""" # with a payload
    inertia = [[10, -1, -2], [-1, 20, -3], [-2, -3, 30]] # with a payload
    assert robot.payload_parameters(2, [1, 2, 3], inertia) == (2, 2, 4, 6, 36, -5, 40, -8, -15, 40) # with a payload
 # with a payload
 # with a payload
if __name__ == "__main__":
    for name, run in list(globals().items()):
        if name.startswith("test_"):
            run()
            print(f"{name}: ok")
