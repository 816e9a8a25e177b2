/* All postures of the Panda of robots/panda7.yaml from C, joint 7 given: they have the value that was given. Exits with the number of faults. */
#include "redundant_ik.h"
#include "robot.h"

#include <math.h>
#include <stdio.h>

/* The scalar of both robots. */
typedef scara_real real;

static int faults;

static void must(int holds, const char *what) {
    if (!holds) {
        printf("%s\n", what);
        faults += 1;
    }
}

int main(void) {
    /* Before the base, the hand down. */
    const real t[4][4] = {
        {1, 0, 0, (real)0.5}, {0, -1, 0, (real)0.1}, {0, 0, -1, (real)0.4}, {0, 0, 0, 1}};
    const char *branches[] = PANDA7_BRANCHES;
    panda7_solutions solutions, none;
    uint32_t k;

    panda7_inverse_kinematics(t, (real)0.75, &solutions);
    must(solutions.verdict == PANDA7_COMPLETE && solutions.count >= 2, "postures");
    for (k = 0; k < solutions.count && k < PANDA7_MAX_SOLUTIONS; k++) {
        must(fabs((double)panda7_inverse_kinematics_redundancy(solutions.all[k].q) - 0.75) < 1e-6, "the value that was given");
        must(branches[solutions.all[k].branch][0] != 0, "branches with names");
        must(panda7_nearest_to(&solutions, solutions.all[k].q) == (int32_t)k, "each is the nearest to itself");
    }
    panda7_inverse_kinematics(t, (real)NAN, &none);
    must(none.verdict == PANDA7_INVALID && none.count == 0, "no value");
    return faults;
}
