/* All postures of the SCARA of robots/scara.yaml from C: two at a pose, each with that pose. Exits with the number of faults. */
#include "robot.h"
#include "robot_ik.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int faults;

static void must(int holds, const char *what) {
    if (!holds) {
        printf("%s\n", what);
        faults += 1;
    }
}

int main(void) {
    const double tolerance = sizeof(scara_real) == sizeof(float) ? 2e-5 : 1e-13;
    const scara_real q[SCARA_DOF] = {(scara_real)0.3, (scara_real)1.1, (scara_real)0.2, (scara_real)0.4};
    const char *branches[] = SCARA_BRANCHES;
    scara_real t[4][4], reached[4][4], turned[SCARA_DOF];
    scara_solutions solutions, within;
    double difference = 0;
    int32_t nearest;
    uint32_t k;
    int i, j;

    scara_direct_kinematics(q, t);
    scara_inverse_kinematics((const scara_real(*)[4])t, &solutions);
    must(solutions.verdict == SCARA_COMPLETE, "complete");
    must(solutions.count == 2 && solutions.miss == 0, "two postures");
    for (k = 0; k < solutions.count && k < SCARA_MAX_SOLUTIONS; k++) {
        scara_direct_kinematics(solutions.all[k].q, reached);
        for (i = 0; i < 4; i++) {
            for (j = 0; j < 4; j++) {
                difference = fmax(difference, fabs((double)(reached[i][j] - t[i][j])));
            }
        }
        must(solutions.all[k].branch == k && strlen(branches[k]) > 0, "branches in order, with names");
        must(!solutions.all[k].is_double && solutions.all[k].free == 0, "neither double nor free");
    }
    must(difference <= tolerance, "each posture has the pose");
    /* q2 = 1.1 in one of them and -1.1 in the other. */
    must(fabs((double)(solutions.all[0].q[1] + solutions.all[1].q[1])) <= tolerance, "elbows opposite");

    /* A whole turn more is the same posture. */
    memcpy(turned, q, sizeof turned);
    turned[0] += (scara_real)6.283185307179586;
    nearest = scara_nearest_to(&solutions, turned);
    must(nearest >= 0 && fabs((double)(solutions.all[nearest].q[1] - q[1])) <= tolerance, "the nearest is the one that was left");

    scara_within_limits(&solutions, &within);
    must(within.count <= solutions.count && within.verdict == solutions.verdict, "within limits no more");
    solutions.count = 1000;
    must(scara_nearest_to(&solutions, q) >= 0, "a count that is too large counts as all");

    t[0][3] = 1000;
    scara_inverse_kinematics((const scara_real(*)[4])t, &solutions);
    must(solutions.verdict == SCARA_UNREACHABLE && solutions.count == 0, "unreachable");
    must(solutions.miss > 900 && solutions.miss < 1001, "missed by that length");
    must(scara_nearest_to(&solutions, q) == -1, "none is nearest");
    t[0][3] = (scara_real)NAN;
    scara_inverse_kinematics((const scara_real(*)[4])t, &solutions);
    must(solutions.verdict == SCARA_INVALID, "invalid");
    return faults;
}
