/* Poses a second of inverse kinematics beside a copy of the same bytes, and its bits beside those of the host. */
#include IK_HEADER
#include "common.cuh"
#include "ik.h"

__global__ void __launch_bounds__(64) postures(size_t states, const Real *__restrict__ poses, Real *__restrict__ rows)
{
    const size_t i = (size_t)blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= states) {
        return;
    }
    Real t[4][4];
    OF(_solutions) found;
    for (int k = 0; k < 16; ++k) {
        t[k / 4][k % 4] = poses[k * states + i];
    }
#if REDUNDANT
    OF(_inverse_kinematics)(t, poses[16 * states + i], &found);
#else
    OF(_inverse_kinematics)(t, &found);
#endif
    rows[i] = (Real)found.verdict;
    rows[states + i] = (Real)found.count;
    rows[2 * states + i] = found.miss;
    for (int s = 0; s < MOST; ++s) {
        for (int k = 0; k < DOF; ++k) {
            rows[(3 + s * DOF + k) * states + i] = found.all[s].q[k];
        }
    }
}

int main(int count, char **arguments)
{
    constexpr int IN = 16 + REDUNDANT;
    const size_t states = 1 << 20;
    if (count != 2) {
        return 2;
    }
    FILE *speed = fopen(arguments[1], "w");
    std::vector<Real> q(DOF * states), poses(IN * states), rows(WRITTEN * states);
    fill(q, 3.0, 7);
    on_all_cores(states, [&](size_t begin, size_t end, Compared &) { host_poses(begin, end, states, q.data(), poses.data()); });
    Real *from, *to;
    CHECK(cudaMalloc(&from, poses.size() * sizeof(Real)));
    CHECK(cudaMalloc(&to, rows.size() * sizeof(Real)));
    CHECK(cudaMemcpy(from, poses.data(), poses.size() * sizeof(Real), cudaMemcpyHostToDevice));
    const double copy = time_of(10, [&](cudaStream_t stream) {
        copy_kernel<Real, IN, WRITTEN><<<(unsigned)((states + 127) / 128), 128, 0, stream>>>(states, from, to);
    });
    const double ms = time_of(5, [&](cudaStream_t stream) { postures<<<(unsigned)((states + 63) / 64), 64, 0, stream>>>(states, from, to); });
    CHECK(cudaMemcpy(rows.data(), to, rows.size() * sizeof(Real), cudaMemcpyDeviceToHost));
    const Compared found = on_all_cores(states, [&](size_t begin, size_t end, Compared &into) {
        std::vector<Real> own((end - begin) * WRITTEN);
        host_ik(begin, end, states, poses.data(), own.data());
        for (size_t i = begin; i < end; ++i) {
            for (int k = 0; k < WRITTEN; ++k) {
                compare(rows[k * states + i], own[(i - begin) * WRITTEN + k], into);
            }
        }
    });
    fprintf(speed, "%s,%s,inverse_kinematics,joint,%zu,%.4f,%.3f,%.3f,%.3f,%.0f,%ld,%ld,%.3g,%.3g\n", ARM, ARITHMETIC, states, ms,
            states / ms * 1e-6, states / copy * 1e-6, copy / ms, (IN + WRITTEN) * sizeof(Real) * states / ms * 1e-6, found.numbers,
            found.differing, found.worst, found.largest);
    printf("%s %s inverse_kinematics: %.4f G poses/s, %.3f of a copy; %ld of %ld numbers have other bits than the host's, by at most %.3g\n",
           ARM, ARITHMETIC, states / ms * 1e-6, copy / ms, found.differing, found.numbers, found.worst);
    return 0;
}
