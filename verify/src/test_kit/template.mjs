// What is the same in the test file of every robot: everything after the line BEGIN is taken in as it stands.
// BEGIN
const { DOF, NOMINAL_PARAMETERS } = robot;

/** All entries in a row. */
const flat = (value) => typeof value === "number" ? [value] : (Array.isArray(value) ? value : Object.values(value)).flatMap(flat);

/** Largest of 1 and the sizes of some entries. */
const scale = (value) => flat(value).reduce((largest, entry) => Math.max(largest, Math.abs(entry)), 1);

const agree = (what, found, expected, tolerance) => {
    const [a, b] = [flat(found), flat(expected)];
    assert.equal(a.length, b.length, what);
    const size = scale(b);
    // Not true of what is not a number.
    const close = a.every((entry, i) => Math.abs(entry - b[i]) <= tolerance * size);
    assert.ok(close, `${what}: ${a} for ${b}`);
};

/** Some thousand roundings; forward dynamics is judged by its residual. */
const ROUNDING = 4096 * Number.EPSILON;
/** A power of two near the cube root of epsilon: differences of this step have errors of about its square. */
const STEP = 1 / 131072;
const DIFFERENCES = 1e3 * STEP * STEP;

/** A row of random states: the same on every machine. */
const randomStates = () => {
    let bits = 4711;
    const many = (size) => Array.from({ length: DOF }, () => {
        bits = (bits * 16807) % 2147483647;
        return (bits / 1073741824 - 1) * size;
    });
    return Array.from({ length: 20 }, () => ({ q: many(3), dq: many(2), ddq: many(4), tau: many(20), pi: NOMINAL_PARAMETERS }));
};

const dot = (a, b) => a.reduce((sum, entry, i) => sum + entry * b[i], 0);
const times = (m, v) => m.map((row) => dot(row, v));
const plus = (...vectors) => vectors[0].map((_, i) => vectors.reduce((sum, vector) => sum + vector[i], 0));
const moved = (q, dq, t) => q.map((entry, i) => entry + t * dq[i]);

test("functions have the values of the equations", () => {
    for (const [name, state, found, expected] of values()) {
        // An inverse loses what the condition of its matrix takes.
        const inverse = name === "operationalInertia" || name.startsWith("forwardDynamics");
        agree(`${name} at state ${state}`, found, expected, (inverse ? 256 : 1) * ROUNDING);
    }
});

test("forward dynamics solves the equation of motion", () => {
    for (const s of [...randomStates(), ...STATES]) {
        const ddq = robot.forwardDynamics(s.q, s.dq, s.tau);
        agree("tau", robot.inverseDynamics(s.q, s.dq, ddq), s.tau, ROUNDING * scale(times(robot.inertiaMatrix(s.q), ddq)));
    }
});

test("the inertia matrix is symmetric and positive definite", () => {
    for (const s of randomStates()) {
        const b = robot.inertiaMatrix(s.q);
        // Cholesky: B = L L'.
        const l = b.map(() => new Array(DOF).fill(0));
        for (let i = 0; i < DOF; ++i) {
            for (let j = 0; j <= i; ++j) {
                assert.equal(b[i][j], b[j][i], "B is symmetric to the last bit");
                const rest = b[i][j] - dot(l[i].slice(0, j), l[j].slice(0, j));
                l[i][j] = i === j ? Math.sqrt(rest) : rest / l[j][j];
            }
            assert.ok(l[i][i] > 0, `B is positive definite at ${s.q}`);
        }
    }
});

test("inertia rates minus twice Coriolis are skew", () => {
    for (const s of randomStates()) {
        const [before, after] = [-STEP, STEP].map((t) => robot.inertiaMatrix(moved(s.q, s.dq, t)));
        const c = robot.coriolisMatrix(s.q, s.dq);
        const skew = (i, j) => (after[i][j] - before[i][j]) / (2 * STEP) - 2 * c[i][j];
        const tolerance = DIFFERENCES * scale(robot.inertiaMatrix(s.q));
        for (let i = 0; i < DOF; ++i) {
            for (let j = 0; j <= i; ++j) {
                assert.ok(Math.abs(skew(i, j) + skew(j, i)) <= tolerance, `entry [${i}][${j}]`);
            }
        }
    }
});

test("torques are those of the matrices and of the regressor", () => {
    for (const s of randomStates()) {
        const [b, c, g] = [robot.inertiaMatrix(s.q), robot.coriolisMatrix(s.q, s.dq), robot.gravity(s.q)];
        agree("equationsOfMotion", robot.equationsOfMotion(s.q, s.dq), { b, c, g }, ROUNDING);
        const tau = robot.inverseDynamics(s.q, s.dq, s.ddq);
        robot.loadFriction(s.q, s.dq).forEach((load, i) => { tau[i] -= load; }); // with load friction
        agree("inverseDynamics", tau, plus(times(b, s.ddq), times(c, s.dq), robot.friction(s.dq), g), ROUNDING);
        const y = robot.regressor(s.q, s.dq, s.dq, s.ddq);
        const byParameters = plus(times(y, NOMINAL_PARAMETERS), robot.knownTorque(s.q, s.dq, s.dq, s.ddq));
        agree("Y pi + tau_known", byParameters, tau, ROUNDING * Math.max(scale(NOMINAL_PARAMETERS), scale(y)));
    }
});

test("functions at run-time parameters are the plain ones at the nominal parameters", () => {
    for (const { q, dq, ddq, pi } of randomStates()) {
        agree("inertiaMatrixWith", robot.inertiaMatrixWith(pi, q), robot.inertiaMatrix(q), ROUNDING * scale(pi));
        agree("gravityWith", robot.gravityWith(pi, q), robot.gravity(q), ROUNDING * scale(pi));
        const tau = robot.inverseDynamicsWith(pi, q, dq, ddq);
        agree("inverseDynamicsWith", tau, robot.inverseDynamics(q, dq, ddq), ROUNDING * scale(pi));
    }
});

test("gravity is the slope of the potential energy", () => {
    for (const { q } of randomStates()) {
        const g = robot.gravity(q);
        const size = Math.max(scale(robot.potentialEnergy(q)), scale(g));
        g.forEach((entry, k) => {
            const along = q.map((_, i) => i === k ? 1 : 0);
            const [low, high] = [-STEP, STEP].map((t) => robot.potentialEnergy(moved(q, along, t)));
            assert.ok(Math.abs((high - low) / (2 * STEP) - entry) <= DIFFERENCES * size, `dU/dq${k + 1}`);
        });
    }
});

test("parameters have their places", () => {
    assert.deepEqual(robot.PARAMETER_NAMES.map((name) => robot.PARAMETER_INDEX[name]), [...NOMINAL_PARAMETERS.keys()]);
});
 // with a payload
test("a payload has its parameters", () => { // with a payload
    const inertia = [[10, -1, -2], [-1, 20, -3], [-2, -3, 30]]; // Steiner: 2 kg at (1, 2, 3), about the origin. // with a payload
    assert.deepEqual(robot.payloadParameters(2, [1, 2, 3], inertia), [2, 2, 4, 6, 36, -5, 40, -8, -15, 40]); // with a payload
}); // with a payload
