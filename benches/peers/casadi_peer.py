"""A careful derivation by hand in CasADi's scalar expressions, and the C that CasADi makes of it.

All of it in joint frames, by the recursions that are cheapest for arms of this size: B and g from composite bodies (mass, first moment,
inertia about the frame's origin), C by Christoffel symbols with CasADi's derivatives of B, torques by Newton and Euler, the regressor
body by body, forward dynamics by factors of B, and the derivatives of both by CasADi. `casadi.cse` finds what is computed twice.
"""
import re

import casadi as ca
import numpy as np

SX = ca.SX


def constant(values):
    """Numbers without their zeros, so that nothing is multiplied by one of them."""
    return SX(ca.sparsify(ca.DM(np.array(values, dtype=float))))


Z = constant([0, 0, 1])


def skew(v):
    return ca.blockcat([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def symmetric(m):
    """Takes the upper triangle for both, so that the lower one is never computed."""
    return ca.triu2symm(ca.triu(m))


def placements(arm, q):
    """Rotation and origin of every joint frame in the one before."""
    result = []
    for joint, x in zip(arm.joints, ca.vertsplit(q)):
        turn, origin = constant(joint.placement[:3, :3]), constant(joint.placement[:3, 3])
        if joint.revolute:
            c, s = ca.cos(x), ca.sin(x)
            turn = turn @ ca.blockcat([[c, -s, SX(1, 1)], [s, c, SX(1, 1)], [SX(1, 1), SX(1, 1), 1]])
        else:
            origin = origin + turn[:, 2] * x
        result.append((turn, origin))
    return result


def base_frames(arm, q):
    """Every joint frame, and last the end effector's, in the base frame."""
    turn, origin = constant(np.eye(3)), SX(3, 1)
    frames = []
    tail = arm.joints[-1].tail
    for r, p in [*placements(arm, q), (constant(tail[:3, :3]), constant(tail[:3, 3]))]:
        origin, turn = origin + turn @ p, turn @ r
        frames.append((turn, origin))
    return frames


def direct_kinematics(arm, q):
    turn, origin = base_frames(arm, q)[-1]
    return ca.vertcat(ca.horzcat(turn, origin), ca.horzcat(SX(1, 3), 1))


def geometric_jacobian(arm, q):
    *frames, (_, end) = base_frames(arm, q)
    columns = []
    for joint, (turn, origin) in zip(arm.joints, frames):
        axis = turn[:, 2]
        columns.append(ca.vertcat(ca.cross(axis, end - origin), axis) if joint.revolute else ca.vertcat(axis, SX(3, 1)))
    return ca.horzcat(*columns)


def moved(body, turn, origin):
    """A body's mass, first moment and inertia about the origin, in the frame in which the body's frame is placed so."""
    mass, h, inertia = body
    h, p = turn @ h, skew(origin)
    inertia = symmetric(turn @ inertia @ turn.T - skew(h) @ p - p @ skew(h + mass * origin))
    return mass, h + mass * origin, inertia


def composites(arm, frames):
    """Body i: links i to n as one, in joint frame i."""
    bodies = [(m, constant(h), constant(inertia)) for m, h, inertia in (joint.body() for joint in arm.joints)]
    for i in range(len(bodies) - 1, 0, -1):
        bodies[i - 1] = tuple(a + b for a, b in zip(bodies[i - 1], moved(bodies[i], *frames[i])))
    return bodies


def inertia_matrix(arm, q):
    frames, n = placements(arm, q), len(arm.joints)
    b = SX(n, n)
    for i, (mass, h, inertia) in enumerate(composites(arm, frames)):
        # Momentum of body i at unit rate of joint i alone: what lies before it sees it carried down.
        force, moment = (ca.cross(Z, h), inertia[:, 2]) if arm.joints[i].revolute else (mass * Z, ca.cross(h, Z))
        for j in range(i, -1, -1):
            b[j, i] = b[i, j] = moment[2] if arm.joints[j].revolute else force[2]
            turn, origin = frames[j]
            force = turn @ force
            moment = turn @ moment + ca.cross(origin, force)
    return b


def gravity(arm, q):
    frames = placements(arm, q)
    fall, g = constant(arm.gravity), []
    for joint, (mass, h, _), (turn, _) in zip(arm.joints, composites(arm, frames), frames):
        fall = turn.T @ fall
        g.append(-ca.cross(h, fall)[2] if joint.revolute else -mass * fall[2])
    return ca.vertcat(*g)


def coriolis_matrix(b, q, dq):
    n = q.numel()
    by = {}
    for i in range(n):
        for j in range(i, n):
            by[i, j] = by[j, i] = ca.jacobian(b[i, j], q)
    c = SX(n, n)
    for i in range(n):
        for j in range(n):
            c[i, j] = sum((by[i, j][k] + by[i, k][j] - by[j, k][i]) * dq[k] for k in range(n)) / 2
    return c


def motions(arm, frames, dq, ddq):
    """Angular velocity, angular acceleration, and acceleration of the origin less that of free fall, of every joint frame in its axes."""
    w, dw, a = SX(3, 1), SX(3, 1), -constant(arm.gravity)
    result = []
    for k, (joint, (turn, origin)) in enumerate(zip(arm.joints, frames)):
        a = turn.T @ (a + ca.cross(dw, origin) + ca.cross(w, ca.cross(w, origin)))
        w, dw = turn.T @ w, turn.T @ dw
        if joint.revolute:
            dw = dw + ca.cross(w, Z * dq[k]) + Z * ddq[k]
            w = w + Z * dq[k]
        else:
            a = a + 2 * ca.cross(w, Z * dq[k]) + Z * ddq[k]
        result.append((w, dw, a))
    return result


def inverse_dynamics(arm, q, dq, ddq):
    frames = placements(arm, q)
    force, moment, tau = SX(3, 1), SX(3, 1), []
    steps = list(zip(arm.joints, frames, motions(arm, frames, dq, ddq)))
    for joint, (turn, origin), (w, dw, a) in reversed(steps):
        mass, h, inertia = joint.body()
        h, inertia = constant(h), constant(inertia)
        force = force + mass * a + ca.cross(dw, h) + ca.cross(w, ca.cross(w, h))
        moment = moment + inertia @ dw + ca.cross(w, inertia @ w) + ca.cross(h, a)
        tau.append(moment[2] if joint.revolute else force[2])
        force = turn @ force
        moment = turn @ moment + ca.cross(origin, force)
    return ca.vertcat(*reversed(tau))


def body_columns(w, dw, a):
    """Force and moment of a body in motion, 3 x 10 each: columns of m, m c, Ixx Ixy Iyy Ixz Iyz Izz."""
    times = lambda v: ca.blockcat([[v[0], v[1], 0, v[2], 0, 0], [0, v[0], v[1], 0, v[2], 0], [0, 0, 0, v[0], v[1], v[2]]])
    force = ca.horzcat(a, skew(dw) + skew(w) @ skew(w), SX(3, 6))
    moment = ca.horzcat(SX(3, 1), -skew(a), times(dw) + skew(w) @ times(w))
    return force, moment


def columns(arm, q, dq, ddq, tails):
    """What each joint feels of each body: rows of ten entries, for parameters in frames that these lead to from the joint frames."""
    n = len(arm.joints)
    frames = placements(arm, q)
    blocks = [[SX(1, 10)] * n for _ in range(n)]
    for i, (w, dw, a) in enumerate(motions(arm, frames, dq, ddq)):
        # Go to the frame of the parameters, and come back with forces and moments.
        turn, origin = constant(tails[i][:3, :3]), constant(tails[i][:3, 3])
        a = a + ca.cross(dw, origin) + ca.cross(w, ca.cross(w, origin))
        force, moment = body_columns(turn.T @ w, turn.T @ dw, turn.T @ a)
        for j in range(i, -1, -1):
            force = turn @ force
            moment = turn @ moment + skew(origin) @ force
            blocks[j][i] = moment[2, :] if arm.joints[j].revolute else force[2, :]
            turn, origin = frames[j]
    return blocks


def regressor(arm, q, dq, ddq):
    return ca.blockcat(columns(arm, q, dq, ddq, [joint.tail for joint in arm.joints]))


PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")


def base_regressor(arm, q, dq, ddq, names, turned):
    """Columns of the base parameters of those names: of the links in their joint frames, that of the last link turned about its axis. A link of
    a revolute joint has Izz = Ixx + Iyy there."""
    tails = [np.eye(4) for _ in arm.joints]
    c, s = np.cos(turned), np.sin(turned)
    tails[-1][:2, :2] = [[c, -s], [s, c]]
    blocks = columns(arm, q, dq, ddq, tails)
    found = []
    for name in names:
        kind, link = re.fullmatch(r"([a-zA-Z]+?)(\d+)R?", name).groups()
        of = int(link) - 1
        body = ca.vertcat(*(row[of] for row in blocks))
        column = body[:, PARAMETERS.index(kind)]
        if kind in ("Ixx", "Iyy") and arm.joints[of].revolute:
            column = column + body[:, PARAMETERS.index("Izz")]
        found.append(column)
    return ca.horzcat(*found)


def factors(b):
    """B = L D L' with units on the diagonal of L; L and the inverse of D."""
    n = b.shape[0]
    lower, inverse, d = SX.eye(n), [], []
    for j in range(n):
        scaled = [lower[j, k] * d[k] for k in range(j)]
        d.append(b[j, j] - sum(lower[j, k] * scaled[k] for k in range(j)))
        inverse.append(1 / d[j])
        for i in range(j + 1, n):
            lower[i, j] = (b[i, j] - sum(lower[i, k] * scaled[k] for k in range(j))) * inverse[j]
    return lower, inverse


def solve(lower, inverse, right):
    n, x = len(inverse), ca.vertsplit(right)
    for i in range(n):
        x[i] = x[i] - sum(lower[i, k] * x[k] for k in range(i))
    x = [value * by for value, by in zip(x, inverse)]
    for i in range(n - 1, -1, -1):
        x[i] = x[i] - sum(lower[k, i] * x[k] for k in range(i + 1, n))
    return ca.vertcat(*x)


def forward_dynamics(arm, q, dq, tau):
    bias = inverse_dynamics(arm, q, dq, SX(q.numel(), 1))
    return solve(*factors(inertia_matrix(arm, q)), tau - bias)


def inverse_dynamics_derivatives(arm, q, dq, ddq):
    n = q.numel()
    both = ca.jacobian(inverse_dynamics(arm, q, dq, ddq), ca.vertcat(q, dq))
    return both[:, :n], both[:, n:]


def forward_dynamics_derivatives(arm, q, dq, tau):
    n = q.numel()
    ddq = SX.sym("ddq", n)
    torques = ca.substitute(list(inverse_dynamics_derivatives(arm, q, dq, ddq)), [ddq], [forward_dynamics(arm, q, dq, tau)])
    inverse = symmetric(solve(*factors(inertia_matrix(arm, q)), SX.eye(n)))
    return [-(inverse @ m) for m in torques] + [inverse]


def functions(arm, names, turned):
    """Name, arguments and how to derive the results of every function, as the emitted header has them."""
    n = len(arm.joints)
    q, dq, dqr, ddq, tau = (SX.sym(name, n) for name in ("q", "dq", "dqr", "ddq", "tau"))

    def equations_of_motion():
        b = inertia_matrix(arm, q)
        return [b, coriolis_matrix(b, q, dq), gravity(arm, q)]

    return {
        "direct_kinematics": ([q], lambda: [direct_kinematics(arm, q)]),
        "geometric_jacobian": ([q], lambda: [geometric_jacobian(arm, q)]),
        "inertia_matrix": ([q], lambda: [inertia_matrix(arm, q)]),
        "coriolis_matrix": ([q, dq], lambda: [coriolis_matrix(inertia_matrix(arm, q), q, dq)]),
        "gravity": ([q], lambda: [gravity(arm, q)]),
        "equations_of_motion": ([q, dq], equations_of_motion),
        "inverse_dynamics": ([q, dq, ddq], lambda: [inverse_dynamics(arm, q, dq, ddq)]),
        "forward_dynamics": ([q, dq, tau], lambda: [forward_dynamics(arm, q, dq, tau)]),
        "regressor": ([q, dq, dqr, ddq], lambda: [regressor(arm, q, dq, ddq)]),
        "base_regressor": ([q, dq, ddq], lambda: [base_regressor(arm, q, dq, ddq, names, turned)]),
        "inverse_dynamics_derivatives": ([q, dq, ddq], lambda: inverse_dynamics_derivatives(arm, q, dq, ddq)),
        "forward_dynamics_derivatives": ([q, dq, tau], lambda: forward_dynamics_derivatives(arm, q, dq, tau)),
    }


def wrapper(name, function):
    """The C function of the emitted header's shape around CasADi's own calling convention."""
    inputs = [f"i{k}" for k in range(function.n_in())]
    outputs = [f"o{k}" for k in range(function.n_out())]
    parameters = ", ".join([f"const double *{i}" for i in inputs] + [f"double *restrict {o}" for o in outputs])
    return (f"void casadi_{name}({parameters}) {{\n"
            f"  const casadi_real *arg[{function.sz_arg() + 1}] = {{{', '.join(inputs)}}};\n"
            f"  casadi_real *res[{function.sz_res() + 1}] = {{{', '.join(outputs)}}};\n"
            f"  casadi_real w[{function.sz_w() + 1}];\n"
            f"  casadi_int iw[{function.sz_iw() + 1}];\n"
            f"  f_{name}(arg, res, iw, w, 0);\n}}\n")


def c_text(arm, wanted, names, turned):
    """One C file with the wanted functions of the arm, full matrices by rows; base parameters by their names, in a frame of the last link so turned."""
    generator = ca.CodeGenerator("peer.c", {"with_header": False})
    wrappers = [f"int casadi_base_parameters(void) {{ return {len(names)}; }}"]
    for name, (arguments, results) in functions(arm, names, turned).items():
        if name not in wanted:
            continue
        # CasADi keeps matrices by columns: the transposed ones are those by rows, at no cost.
        by_rows = ca.cse([ca.densify(m.T) for m in results()])
        function = ca.Function(f"f_{name}", arguments, by_rows)
        generator.add(function)
        wrappers.append(wrapper(name, function))
    return "\n".join([generator.dump(), *wrappers])
