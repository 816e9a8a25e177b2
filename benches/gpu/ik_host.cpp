#include HEADER
#include IK_HEADER
#include "ik.h"

void host_poses(size_t begin, size_t end, size_t leading, const Real *q, Real *poses)
{
    for (size_t i = begin; i < end; ++i) {
        Real posture[DOF], t[4][4];
        for (int k = 0; k < DOF; ++k) {
            posture[k] = q[k * leading + i];
        }
        OF(_direct_kinematics)(posture, t);
        for (int k = 0; k < 16; ++k) {
            poses[k * leading + i] = t[k / 4][k % 4];
        }
#if REDUNDANT
        poses[16 * leading + i] = OF(_inverse_kinematics_redundancy)(posture);
#endif
    }
}

void host_ik(size_t begin, size_t end, size_t leading, const Real *poses, Real *rows)
{
    for (size_t i = begin; i < end; ++i) {
        Real t[4][4];
        OF(_solutions) found;
        for (int k = 0; k < 16; ++k) {
            t[k / 4][k % 4] = poses[k * leading + i];
        }
#if REDUNDANT
        OF(_inverse_kinematics)(t, poses[16 * leading + i], &found);
#else
        OF(_inverse_kinematics)(t, &found);
#endif
        Real *row = rows + (i - begin) * WRITTEN;
        *row++ = (Real)found.verdict;
        *row++ = (Real)found.count;
        *row++ = found.miss;
        for (int s = 0; s < MOST; ++s) {
            for (int k = 0; k < DOF; ++k) {
                *row++ = found.all[s].q[k];
            }
        }
    }
}
