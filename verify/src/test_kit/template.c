/* What is the same in the test file of every robot: everything after the line BEGIN is taken in, in the robot's name. */
/* BEGIN */
/* Some thousand roundings; forward dynamics is judged by its residual. */
#define ROUNDING (4096 * (double)EPSILON)
/* A power of two near the cube root of epsilon: differences of this step have errors of about its square. */
#define STEP (EPSILON < 1e-12 ? 1.0 / 131072 : 1.0 / 128)
#define DIFFERENCES (1e3 * STEP * STEP)
#define ENTRIES(array) ((int)(sizeof(array) / sizeof(robot_real)))
#define FLAT(array) ((const robot_real *)(array))

typedef robot_real vector[ROBOT_DOF];
typedef robot_real matrix[ROBOT_DOF][ROBOT_DOF];

static int failures = 0;

static void judge(int holds, const char *what)
{
    if (!holds) {
        printf("failed: %s\n", what);
        ++failures;
    }
}

/* Largest of 1 and the sizes of some entries. */
static double scale(int entries, const robot_real *values)
{
    double largest = 1;
    int i;
    for (i = 0; i < entries; ++i) {
        const double size = values[i] < 0 ? -(double)values[i] : (double)values[i];
        largest = size > largest ? size : largest;
    }
    return largest;
}

/* That values differ by no more than so much of the largest; what is not a number does not agree. */
static void agree(const char *what, int entries, const robot_real *found, const robot_real *expected, double tolerance)
{
    const double allowed = tolerance * scale(entries, expected);
    int i, holds = 1;
    for (i = 0; i < entries; ++i) {
        const double difference = (double)found[i] - (double)expected[i];
        holds = holds && difference <= allowed && -difference <= allowed;
    }
    judge(holds, what);
}

/* A row of random numbers: the same on every machine. */
static void draw(double size, vector v)
{
    static double bits = 4711;
    int i;
    for (i = 0; i < ROBOT_DOF; ++i) {
        const double product = bits * 16807;
        bits = product - 2147483647.0 * (double)(long)(product / 2147483647.0);
        v[i] = (robot_real)((bits / 1073741824.0 - 1) * size);
    }
}

static void multiply(matrix m, const vector v, vector result)
{
    int i, j;
    for (i = 0; i < ROBOT_DOF; ++i) {
        double sum = 0;
        for (j = 0; j < ROBOT_DOF; ++j) {
            sum += (double)m[i][j] * (double)v[j];
        }
        result[i] = (robot_real)sum;
    }
}

static void moved(const vector q, const vector dq, double t, vector result)
{
    int i;
    for (i = 0; i < ROBOT_DOF; ++i) {
        result[i] = (robot_real)((double)q[i] + t * (double)dq[i]);
    }
}

static void at(const vector q, const vector dq, const vector ddq, const vector torque)
{
    static const robot_real nominal[ROBOT_PARAMETERS] = ROBOT_NOMINAL_PARAMETERS;
    static robot_real y[ROBOT_DOF][ROBOT_PARAMETERS];
    matrix b, c, before, after, inertia, coriolis, l;
    vector g, f, tau, solved, a, sum, place, known, gravity;
    vector load; /* with load friction */
    double size;
    int i, j, k;

    robot_inertia_matrix(q, b);
    robot_coriolis_matrix(q, dq, c);
    robot_gravity(q, g);
    robot_friction(dq, f);
    robot_load_friction(q, dq, load); /* with load friction */
    for (i = 0; i < ROBOT_DOF; ++i) { /* with load friction */
        f[i] = f[i] + load[i]; /* with load friction */
    } /* with load friction */

    robot_forward_dynamics(q, dq, torque, a);
    robot_inverse_dynamics(q, dq, a, solved);
    multiply(b, a, sum);
    agree("forward dynamics solves the equation of motion", ROBOT_DOF, solved, torque, ROUNDING * scale(ROBOT_DOF, sum));

    /* Cholesky, without roots: B = L D L', whose D is positive. */
    for (i = 0; i < ROBOT_DOF; ++i) {
        for (j = 0; j <= i; ++j) {
            double rest = (double)b[i][j];
            judge(!(b[i][j] < b[j][i]) && !(b[i][j] > b[j][i]), "B is symmetric to the last bit");
            for (k = 0; k < j; ++k) {
                rest -= (double)l[i][k] * (double)l[j][k] * (double)l[k][k];
            }
            l[i][j] = (robot_real)(i == j ? rest : rest / (double)l[j][j]);
        }
        judge(l[i][i] > 0, "B is positive definite");
    }

    moved(q, dq, -STEP, place);
    robot_inertia_matrix(place, before);
    moved(q, dq, STEP, place);
    robot_inertia_matrix(place, after);
    size = DIFFERENCES * scale(ENTRIES(b), FLAT(b));
    for (i = 0; i < ROBOT_DOF; ++i) {
        for (j = 0; j <= i; ++j) {
            const double rate = (double)(after[i][j] - before[i][j]) / (2 * STEP);
            const double skew = 2 * rate - 2 * (double)c[i][j] - 2 * (double)c[j][i];
            judge(skew <= size && -skew <= size, "dB/dt - 2C is skew-symmetric");
        }
    }

    robot_equations_of_motion(q, dq, inertia, coriolis, gravity);
    agree("equations_of_motion: B", ENTRIES(b), FLAT(inertia), FLAT(b), ROUNDING);
    agree("equations_of_motion: C", ENTRIES(c), FLAT(coriolis), FLAT(c), ROUNDING);
    agree("equations_of_motion: g", ROBOT_DOF, gravity, g, ROUNDING);
    robot_inverse_dynamics(q, dq, ddq, tau);
    multiply(b, ddq, sum);
    multiply(c, dq, place);
    for (i = 0; i < ROBOT_DOF; ++i) {
        sum[i] = sum[i] + place[i] + f[i] + g[i];
    }
    agree("torques are those of the matrices", ROBOT_DOF, tau, sum, ROUNDING);
    robot_regressor(q, dq, dq, ddq, y);
    robot_known_torque(q, dq, dq, ddq, known);
    for (i = 0; i < ROBOT_DOF; ++i) {
        double total = (double)known[i];
        total += (double)load[i]; /* with load friction */
        for (j = 0; j < ROBOT_PARAMETERS; ++j) {
            total += (double)y[i][j] * (double)nominal[j];
        }
        sum[i] = (robot_real)total;
    }
    size = scale(ENTRIES(y), FLAT(y));
    size = size > scale(ROBOT_PARAMETERS, nominal) ? size : scale(ROBOT_PARAMETERS, nominal);
    agree("torques are those of the regressor", ROBOT_DOF, sum, tau, ROUNDING * size);

    size = ROUNDING * scale(ROBOT_PARAMETERS, nominal);
    robot_inertia_matrix_with(nominal, q, inertia);
    agree("inertia_matrix_with", ENTRIES(b), FLAT(inertia), FLAT(b), size);
    robot_gravity_with(nominal, q, gravity);
    agree("gravity_with", ROBOT_DOF, gravity, g, size);
    robot_inverse_dynamics_with(nominal, q, dq, ddq, sum);
    agree("inverse_dynamics_with", ROBOT_DOF, sum, tau, size);

    a[0] = robot_potential_energy(q);
    size = DIFFERENCES * (scale(1, a) > scale(ROBOT_DOF, g) ? scale(1, a) : scale(ROBOT_DOF, g));
    for (k = 0; k < ROBOT_DOF; ++k) {
        double low, high, difference;
        for (i = 0; i < ROBOT_DOF; ++i) {
            sum[i] = i == k ? 1 : 0;
        }
        moved(q, sum, -STEP, place);
        low = (double)robot_potential_energy(place);
        moved(q, sum, STEP, place);
        high = (double)robot_potential_energy(place);
        difference = (high - low) / (2 * STEP) - (double)g[k];
        judge(difference <= size && -difference <= size, "gravity is the slope of the potential energy");
    }
}

static void payload(void) /* with a payload */
{ /* with a payload */
    static const robot_real com[3] = {1, 2, 3}, inertia[3][3] = {{10, -1, -2}, {-1, 20, -3}, {-2, -3, 30}}; /* with a payload */
    static const robot_real expected[10] = {2, 2, 4, 6, 36, -5, 40, -8, -15, 40}; /* with a payload */
    robot_real found[10]; /* with a payload */
    robot_payload_parameters(2, com, inertia, found); /* with a payload */
    agree("payload_parameters, by Steiner", 10, found, expected, 0); /* with a payload */
} /* with a payload */
 /* with a payload */
int main(void)
{
    int k;
    values();
    payload(); /* with a payload */
    for (k = 0; k < 20; ++k) {
        vector q, dq, ddq, tau;
        draw(3, q);
        draw(2, dq);
        draw(4, ddq);
        draw(20, tau);
        at(q, dq, ddq, tau);
    }
    if (failures == 0) {
        printf("all tests passed\n");
    }
    return failures != 0;
}
