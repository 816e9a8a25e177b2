/* The SCARA of robots/scara.yaml from C: values of its report at one state, and closed forms. Exits with the number of faults. */
#include "robot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int faults;

static void near_by(const char *what, double value, double expected) {
    const double tolerance = sizeof(scara_real) == sizeof(float) ? 2e-6 : 1e-14;
    if (!(fabs(value - expected) <= tolerance * (1 + fabs(expected)))) {
        printf("%s: %.17g, expected %.17g\n", what, value, expected);
        faults += 1;
    }
}

static void all(const char *what, const scara_real value[SCARA_DOF], const double expected[SCARA_DOF]) {
    int i;
    for (i = 0; i < SCARA_DOF; i++) {
        near_by(what, value[i], expected[i]);
    }
}

int main(void) {
    const scara_real q[SCARA_DOF] = {(scara_real)0.3, (scara_real)1.1, (scara_real)0.2, (scara_real)0.4};
    const scara_real dq[SCARA_DOF] = {(scara_real)0.5, (scara_real)-0.7, (scara_real)0.3, (scara_real)1};
    const scara_real ddq[SCARA_DOF] = {(scara_real)1, (scara_real)2, (scara_real)-1, (scara_real)0.5};
    const scara_real dqr[SCARA_DOF] = {(scara_real)0.4, (scara_real)-0.6, (scara_real)0.25, (scara_real)0.9};
    const scara_real zero[SCARA_DOF] = {0, 0, 0, 0};
    const char *joints[SCARA_DOF] = SCARA_JOINT_NAMES;
    const char *names[SCARA_PARAMETERS] = SCARA_PARAMETER_NAMES;
    const scara_real limits[SCARA_DOF][2] = SCARA_POSITION_LIMITS;
    const scara_real rates[SCARA_DOF] = SCARA_VELOCITY_LIMITS;
    const scara_real efforts[SCARA_DOF] = SCARA_EFFORT_LIMITS;
    scara_real pi[SCARA_PARAMETERS] = SCARA_NOMINAL_PARAMETERS;
    const double cosine = cos(1.1), h = 5 * sin(1.1);
    const double b[SCARA_DOF][SCARA_DOF] = {{10 * cosine + 10763.0 / 500, 5 * cosine + 4383.0 / 500, -0.25, -1.02},
                                            {5 * cosine + 4383.0 / 500, 4383.0 / 500, -0.25, -1.02},
                                            {-0.25, -0.25, 22.5, 0},
                                            {-1.02, -1.02, 0, 1.4}};
    const double c[SCARA_DOF][SCARA_DOF] = {{h * 0.7, -h * (0.5 - 0.7), 0, 0}, {h * 0.5, 0, 0, 0}, {0}, {0}};
    const double g[SCARA_DOF] = {0, 0, -98.1, 0};
    const double tau[SCARA_DOF] = {48.80571515657605, 29.41995480720468, -113.85, -0.36};
    const double y_pi[SCARA_DOF] = {48.58290831656069, 29.197157967189323, -115.1, -0.56};
    const double fall[SCARA_DOF] = {0.05371154081148763, -0.24057622390045058, 5.076483048335555, -1.5647156976791017};
    scara_real matrix[SCARA_DOF][SCARA_DOF], coriolis[SCARA_DOF][SCARA_DOF], vector[SCARA_DOF];
    scara_real frame[4][4], frames[SCARA_DOF][4][4], jacobian[6][SCARA_DOF], y[SCARA_DOF][SCARA_PARAMETERS];
    scara_real acceleration[SCARA_DOF];
    double energy = 0;
    int i, k;

    if (strcmp(joints[2], "quill") != 0 || strcmp(names[2], "m_l3") != 0) {
        printf("names: %s, %s\n", joints[2], names[2]);
        faults += 1;
    }
    for (i = 0; i < SCARA_DOF; i++) {
        if (!(limits[i][0] < limits[i][1] && rates[i] > 0 && efforts[i] > 0)) {
            printf("limits of joint %d\n", i);
            faults += 1;
        }
    }

    scara_inertia_matrix(q, matrix);
    for (i = 0; i < SCARA_DOF; i++) {
        all("inertia_matrix", matrix[i], b[i]);
    }
    scara_equations_of_motion(q, dq, matrix, coriolis, vector);
    for (i = 0; i < SCARA_DOF; i++) {
        all("equations_of_motion: inertia", matrix[i], b[i]);
        all("equations_of_motion: coriolis", coriolis[i], c[i]);
        for (k = 0; k < SCARA_DOF; k++) {
            energy += 0.5 * dq[i] * b[i][k] * dq[k];
        }
    }
    all("equations_of_motion: gravity", vector, g);
    near_by("kinetic_energy", scara_kinetic_energy(q, dq), energy);
    /* Links 1 and 2 at a height of 1 m, the third at 0.3 m. */
    near_by("potential_energy", scara_potential_energy(q), 40 * 9.81 + 98.1 * 0.3);
    scara_inverse_dynamics(q, dq, ddq, vector);
    all("inverse_dynamics", vector, tau);

    scara_regressor(q, dq, dqr, ddq, y);
    for (i = 0; i < SCARA_DOF; i++) {
        double sum = 0;
        for (k = 0; k < SCARA_PARAMETERS; k++) {
            sum += (double)y[i][k] * (double)pi[k];
        }
        near_by("regressor times parameters", sum, y_pi[i]);
    }
    pi[2] = 15;
    scara_forward_dynamics_with(pi, q, dq, zero, vector);
    all("forward_dynamics_with a load", vector, fall);
    scara_potential_energy_with(pi, q);

    scara_direct_kinematics(q, frame);
    near_by("x_e", frame[0][3], 0.5626518160129234);
    near_by("y_e", frame[1][3], 0.6404849683248999);
    near_by("z_e", frame[2][3], 0.3);
    near_by("last row", frame[3][0] + frame[3][1] + frame[3][2], 0);
    near_by("last row", frame[3][3], 1);
    scara_link_frames(q, frames);
    for (i = 0; i < 16; i++) {
        near_by("the last link's frame is the end effector's", frames[SCARA_DOF - 1][i / 4][i % 4], frame[i / 4][i % 4]);
    }
    scara_geometric_jacobian(q, jacobian);
    near_by("geometric_jacobian, row x, joint 2", jacobian[0][1], -0.5 * sin(1.4));
    near_by("geometric_jacobian, row z, joint 3", jacobian[2][2], -1);
    near_by("geometric_jacobian, row rz, joint 4", jacobian[5][3], -1);

    /* A result may overwrite an argument. */
    memcpy(vector, dq, sizeof vector);
    scara_inverse_dynamics(q, vector, ddq, vector);
    all("inverse_dynamics over its argument", vector, tau);
    scara_forward_dynamics_with(pi, q, dq, ddq, acceleration);
    memcpy(vector, ddq, sizeof vector);
    scara_forward_dynamics_with(pi, q, dq, vector, vector);
    for (i = 0; i < SCARA_DOF; i++) {
        near_by("forward_dynamics_with over its argument", vector[i], acceleration[i]);
    }
    return faults;
}
