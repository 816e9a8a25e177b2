/* Hand guiding and impedance of robots/scara.yaml from C: prints the bits of torques and anchors, and the answers to faults. */
#include "robot_laws.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static void print(const char *what, int answer, const double *values) {
    int i;
    printf("%s %d", what, answer);
    for (i = 0; i < SCARA_DOF; i++) {
        unsigned long long bits;
        memcpy(&bits, &values[i], sizeof bits);
        printf(" %016llx", bits);
    }
    printf("\n");
}

/* The state of a sample, exact in every scalar. */
static void sample(int k, double q[SCARA_DOF], double dq[SCARA_DOF]) {
    int i;
    for (i = 0; i < SCARA_DOF; i++) {
        q[i] = (double)(3 * k - 2 * i + 4) / 16;
        dq[i] = (double)(5 - 3 * k + i) / 8;
    }
}

int main(void) {
    const scara_walls walls = {{-1, -1, -1, -1}, {0.5, 0.5, 0.5, 0.5}, {0.25, 0.25, 0.25, 0.25}, {40, 30, 20, 10}, {4, 3, 2, 1}};
    const scara_speed_cap cap = {{0.25, 0.25, 0.25, 0.25}, {8, 7, 6, 5}};
    const scara_hold hold = {{2, 2, 2, 2}, {50, 40, 30, 20}, {1, 1, 1, 1}};
    const scara_friction_compensation friction = {0.75, 0.125};
    const scara_null_space rest = {{1, 1, 1, 1}, {2, 2, 2, 2}, {0.5, 0.5, 0.25, 0}};
    const double limits[SCARA_DOF] = SCARA_EFFORT_LIMITS, damping[SCARA_TASK_ROWS] = {80, 70, 60, 50};
    const double frame[4][4] = {{0, -1, 0, 0.5}, {1, 0, 0, 0.25}, {0, 0, 1, 0.125}, {0, 0, 0, 1}};
    const double velocity[6] = {0.5, -0.25, 0.125, 0, 0, 0.5}, acceleration[6] = {1, 0.5, -0.25, 0, 0, -1};
    scara_hand_guiding_gains plain = {{4, 3, 2, 1}, NULL, NULL, NULL, NULL, NULL};
    const scara_hand_guiding_gains all = {{4, 3, 2, 1}, &walls, &cap, &hold, &friction, limits};
    scara_impedance_gains spring = {{900, 800, 700, 60}, 0.75, NULL, 0, NULL, NULL, NULL};
    const scara_impedance_gains full = {{900, 800, 700, 60}, 0, damping, 2, &rest, &friction, limits};
    double q[SCARA_DOF], dq[SCARA_DOF], tau[SCARA_DOF] = {0, 0, 0, 0}, anchor[SCARA_DOF];
    double broken[4][4];
    int k;

    sample(0, anchor, dq);
    for (k = 0; k < 5; k++) {
        sample(k, q, dq);
        print("plain", scara_hand_guiding(&plain, NULL, q, dq, tau), tau);
        print("all", scara_hand_guiding(&all, anchor, q, dq, tau), tau);
        print("anchor", 0, anchor);
        print("spring", scara_impedance(&spring, frame, NULL, NULL, q, dq, tau), tau);
        print("full", scara_impedance(&full, frame, velocity, acceleration, q, dq, tau), tau);
        /* The torque may lie where the rate does. */
        print("over", scara_hand_guiding(&all, anchor, q, dq, dq), dq);
    }
    memcpy(broken, frame, sizeof broken);
    broken[0][0] = (double)NAN;
    print("frame", scara_impedance(&spring, (const double(*)[4])broken, NULL, NULL, q, dq, tau), tau);
    q[1] = (double)NAN;
    print("measured", scara_hand_guiding(&all, anchor, q, dq, tau), tau);
    plain.damping[2] = -1;
    spring.ratio = 0;
    print("gains", scara_hand_guiding(&plain, anchor, q, dq, tau), anchor);
    print("ratio", scara_impedance(&spring, frame, NULL, NULL, q, dq, tau), tau);
    return 0;
}
