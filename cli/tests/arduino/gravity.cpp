// The sketch of a package; then the bits of gravity at a thousand states, as one number.
#include "arduino.h"
#include "gravity.ino"

int main()
{
    setup();
    loop();
    // States of a linear congruential generator, within half a turn.
    uint32_t seed = 1, sum = 0;
    for (int k = 0; k < 1000; ++k) {
        ur5_real q[UR5_DOF], g[UR5_DOF];
        for (int i = 0; i < UR5_DOF; ++i) {
            seed = seed * 1664525u + 1013904223u;
            q[i] = (ur5_real)((int32_t)seed) * (ur5_real)1.4e-9;
        }
        ur5_gravity(q, g);
        for (int i = 0; i < UR5_DOF; ++i) {
            uint32_t bits;
            memcpy(&bits, &g[i], sizeof bits);
            sum = sum * 31u + bits;
        }
    }
    printf("%08lx\n", (unsigned long)sum);
    return 0;
}
