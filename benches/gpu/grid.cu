/* The fused functions of a Panda in single precision beside those of GRiD, whose generated header is grid.cuh. */
#include "grid.cuh"
#include HEADER
#include "common.cuh"

typedef float Real;
static FILE *latency;
static grid::robotModel<Real> *model;
static unsigned char *workspace;

template <typename Launch>
static void measure(const char *name, size_t states, int threads, Launch launch)
{
    launch((cudaStream_t)0);
    if (cudaDeviceSynchronize() != cudaSuccess || cudaGetLastError() != cudaSuccess) {
        printf("%s does not run with %d threads\n", name, threads);
        exit(1);
    }
    const bool many = states > 100000;
    const double loop = time_of(many ? 3 : 500, launch), graph = many ? loop : time_in_graph(launch), waited = many ? loop : time_waited(launch);
    fprintf(latency, "GRiD,Panda,f32,%s,%zu,%d,%.3f,%.3f,%.3f\n", name, states, threads, loop * 1e3, graph * 1e3, waited * 1e3);
    printf("GRiD %s, %zu states, %d threads: %.2f us in a loop, %.2f us in a graph, %.2f us waited; %.2f M states/s\n", name, states, threads,
           loop * 1e3, graph * 1e3, waited * 1e3, states / fmin(loop, graph) * 1e-3);
    fflush(stdout);
    fflush(latency);
}

int main(int count, char **arguments)
{
    const size_t most = 1 << 20;
    if (count != 2) {
        return 2;
    }
    latency = fopen(arguments[1], "w");
    std::vector<Real> q(7 * most), dq(7 * most), third(7 * most), state(21 * most);
    fill(q, 3.0, 1);
    fill(dq, 2.0, 2);
    fill(third, 5.0, 3);
    for (size_t i = 0; i < most; ++i) {
        for (int k = 0; k < 7; ++k) {
            state[21 * i + k] = q[7 * i + k];
            state[21 * i + 7 + k] = dq[7 * i + k];
            state[21 * i + 14 + k] = third[7 * i + k];
        }
    }
    Real *states, *thirds, *result;
    CHECK(cudaMalloc(&states, state.size() * sizeof(Real)));
    CHECK(cudaMalloc(&thirds, third.size() * sizeof(Real)));
    CHECK(cudaMalloc(&result, 147 * most * sizeof(Real)));
    CHECK(cudaMalloc(&workspace, (size_t)1 << 30));
    CHECK(cudaMemcpy(states, state.data(), state.size() * sizeof(Real), cudaMemcpyHostToDevice));
    CHECK(cudaMemcpy(thirds, third.data(), third.size() * sizeof(Real), cudaMemcpyHostToDevice));
    model = grid::init_robotModel<Real>();
    const Real gravity = -9.81f;
    const auto inverse = [&](size_t n, int threads, cudaStream_t stream) {
        grid::inverse_dynamics_kernel<Real><<<(unsigned)n, threads, grid::INVERSE_DYNAMICS_DYNAMIC_SHARED_MEM_BYTES<Real>(), stream>>>(
            result, states, 21, thirds, (Real *)nullptr, model, gravity, (int)n);
    };
    const auto forward = [&](size_t n, int threads, cudaStream_t stream) {
        grid::forward_dynamics_kernel<Real><<<(unsigned)n, threads, grid::FORWARD_DYNAMICS_DYNAMIC_SHARED_MEM_BYTES<Real>(), stream>>>(
            result, workspace, states, 21, (Real *)nullptr, model, gravity, (int)n);
    };
    const auto inverse_gradient = [&](size_t n, int threads, cudaStream_t stream) {
        grid::inverse_dynamics_gradient_kernel<Real>
            <<<(unsigned)n, threads, grid::INVERSE_DYNAMICS_GRADIENT_DYNAMIC_SHARED_MEM_BYTES<Real>(), stream>>>(
                result, workspace, states, 21, thirds, (Real *)nullptr, model, gravity, (int)n);
    };
    /* Values: rows of a state at [7 i + k] and [98 i + 7 column + row], by q and then by dq. */
    std::vector<Real> found(98 * 2048);
    Compared torques, accelerations, gradients;
    inverse(2048, 64, 0);
    CHECK(cudaDeviceSynchronize());
    CHECK(cudaMemcpy(found.data(), result, 7 * 2048 * sizeof(Real), cudaMemcpyDeviceToHost));
    for (int i = 0; i < 2048; ++i) {
        Real own[7];
        panda7_inverse_dynamics(&q[7 * i], &dq[7 * i], &third[7 * i], own);
        for (int k = 0; k < 7; ++k) {
            compare(found[7 * i + k], own[k], torques);
        }
    }
    forward(2048, 64, 0);
    CHECK(cudaDeviceSynchronize());
    CHECK(cudaMemcpy(found.data(), result, 7 * 2048 * sizeof(Real), cudaMemcpyDeviceToHost));
    for (int i = 0; i < 2048; ++i) {
        Real own[7];
        panda7_forward_dynamics(&q[7 * i], &dq[7 * i], &third[7 * i], own);
        for (int k = 0; k < 7; ++k) {
            compare(found[7 * i + k], own[k], accelerations);
        }
    }
    printf("GRiD and armgen: torques differ by at most %.3g of %.3g N m, accelerations by %.3g of %.3g rad/s^2\n", torques.worst,
           torques.largest, accelerations.worst, accelerations.largest);
    fflush(stdout);
    inverse_gradient(2048, 64, 0);
    CHECK(cudaDeviceSynchronize());
    CHECK(cudaMemcpy(found.data(), result, 98 * 2048 * sizeof(Real), cudaMemcpyDeviceToHost));
    for (int i = 0; i < 2048; ++i) {
        Real by_q[7][7], by_dq[7][7];
        panda7_inverse_dynamics_derivatives(&q[7 * i], &dq[7 * i], &third[7 * i], by_q, by_dq);
        for (int k = 0; k < 49; ++k) {
            compare(found[98 * i + k], by_q[k % 7][k / 7], gradients);
            compare(found[98 * i + 49 + k], by_dq[k % 7][k / 7], gradients);
        }
    }
    printf("GRiD and armgen: derivatives of torques differ by at most %.3g of %.3g\n", gradients.worst, gradients.largest);
    fflush(stdout);
    const size_t batches[] = {16, 256, 1024, most};
    for (size_t n : batches) {
        const int blocks[] = {32, 64, 128, 352};
        for (int threads : blocks) {
            measure("inverse_dynamics", n, threads, [&](cudaStream_t stream) { inverse(n, threads, stream); });
            measure("forward_dynamics", n, threads, [&](cudaStream_t stream) { forward(n, threads, stream); });
            measure("inverse_dynamics_derivatives", n, threads, [&](cudaStream_t stream) { inverse_gradient(n, threads, stream); });
        }
    }
    return 0;
}
