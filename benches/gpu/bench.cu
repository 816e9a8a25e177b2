/* States a second of the functions of an arm beside a copy of the same bytes, and their bits beside those of the host. */
#include HEADER
#include "common.cuh"
#include "bench.h"

static const size_t COMPARED = 1 << 20;
static std::vector<Real> host[3], device;
static Real *from[3], *to[3], *all_from, *all_to;
static FILE *speed, *latency;

template <int ARGUMENTS, int A, int B, int C, typename Launch, typename Host>
static void measure(const char *name, Launch launch, Host of_host)
{
    constexpr int IN = ARGUMENTS * DOF, OUT = A + B + C;
    const size_t states = IN + OUT <= 80 ? 1 << 22 : 1 << 20;
    const double copy = time_of(10, [&](cudaStream_t stream) {
        copy_kernel<Real, IN, OUT><<<(unsigned)((states + 127) / 128), 128, 0, stream>>>(states, all_from, all_to);
    });
    for (int by_state = 0; by_state < 2; ++by_state) {
        const size_t leading = by_state ? 0 : states;
        for (int r = 1; r < 3; ++r) {
            to[r] = to[r - 1] + (r == 1 ? A : B) * states;
        }
        const double ms = time_of(10, [&](cudaStream_t stream) { launch(states, leading, stream); });
        /* Bits of a million states. */
        const size_t apart = by_state ? 0 : COMPARED;
        for (int r = 1; r < 3; ++r) {
            to[r] = to[r - 1] + (r == 1 ? A : B) * COMPARED;
        }
        launch(COMPARED, apart, (cudaStream_t)0);
        CHECK(cudaMemcpy(device.data(), all_to, OUT * COMPARED * sizeof(Real), cudaMemcpyDeviceToHost));
        const Compared found = on_all_cores(COMPARED, [&](size_t begin, size_t end, Compared &into) {
            const Real *arguments[3] = {host[0].data(), host[1].data(), host[2].data()};
            std::vector<Real> rows((end - begin) * OUT);
            of_host(Range{begin, end, apart}, arguments, rows.data());
            for (size_t i = begin; i < end; ++i) {
                const int sizes[3] = {A, B, C};
                const Real *row = &rows[(i - begin) * OUT], *array = device.data();
                for (int r = 0; r < 3; ++r) {
                    for (int k = 0; k < sizes[r]; ++k) {
                        compare(entry(array, apart, i, k, sizes[r]), *row++, into);
                    }
                    array += sizes[r] * COMPARED;
                }
            }
        });
        fprintf(speed, "%s,%s,%s,%s,%zu,%.4f,%.3f,%.3f,%.3f,%.0f,%ld,%ld,%.3g,%.3g\n", ARM, ARITHMETIC, name, by_state ? "state" : "joint",
                states, ms, states / ms * 1e-6, states / copy * 1e-6, copy / ms, (IN + OUT) * sizeof(Real) * states / ms * 1e-6,
                found.numbers, found.differing, found.worst, found.largest);
        printf("%s %s %s by %s: %.3f G states/s, %.3f of a copy; %ld of %ld numbers have other bits than the host's, by at most %.3g\n", ARM,
               ARITHMETIC, name, by_state ? "state" : "joint", states / ms * 1e-6, copy / ms, found.differing, found.numbers, found.worst);
        fflush(stdout);
        fflush(speed);
    }
    for (size_t few : {16, 256, 1024, 1 << 20}) {
        const auto one = [&](cudaStream_t stream) { launch(few, few, stream); };
        const bool many = few > 100000;
        const double loop = time_of(many ? 10 : 1000, one), graph = many ? loop : time_in_graph(one), waited = many ? loop : time_waited(one);
        fprintf(latency, "armgen,%s,%s,%s,%zu,64,%.3f,%.3f,%.3f\n", ARM, ARITHMETIC, name, few, loop * 1e3, graph * 1e3, waited * 1e3);
        fflush(latency);
    }
}

int main(int count, char **arguments)
{
    const size_t most = 1 << 22;
    if (count != 3) {
        return 2;
    }
    speed = fopen(arguments[1], "w");
    latency = fopen(arguments[2], "w");
    size_t largest = 80 * most;
    const size_t outputs[] = {(size_t)DOF * BASE, (size_t)3 * SQUARE};
    for (size_t entries : outputs) {
        largest = largest > (entries << 20) ? largest : entries << 20;
    }
    CHECK(cudaMalloc(&all_from, 3 * DOF * most * sizeof(Real)));
    CHECK(cudaMalloc(&all_to, largest * sizeof(Real)));
    device.resize(outputs[0] > outputs[1] ? outputs[0] * COMPARED : outputs[1] * COMPARED);
    CHECK(cudaMemset(all_to, 0, largest * sizeof(Real)));
    for (int a = 0; a < 3; ++a) {
        host[a].resize(DOF * most);
        fill(host[a], a == 0 ? 3.0 : a == 1 ? 2.0 : 5.0, a + 1);
        from[a] = all_from + a * DOF * most;
        CHECK(cudaMemcpy(from[a], host[a].data(), DOF * most * sizeof(Real), cudaMemcpyHostToDevice));
    }
    to[0] = all_to;
#define LAUNCH_1 from[0]
#define LAUNCH_2 from[0], from[1]
#define LAUNCH_3 from[0], from[1], from[2]
#define MEASURE(name, arguments, results, first, second, third) \
    measure<arguments, first, second, third>( \
        #name, [](size_t states, size_t leading, cudaStream_t stream) { \
            CHECK(OF(_launch_##name)(states, leading, LAUNCH_##arguments, results, stream)); }, host_##name);
#define RESULTS(...) __VA_ARGS__
    MEASURE(inverse_dynamics, 3, to[0], DOF, 0, 0)
    MEASURE(inertia_matrix, 1, to[0], SQUARE, 0, 0)
    MEASURE(coriolis_matrix, 2, to[0], SQUARE, 0, 0)
    MEASURE(forward_dynamics, 3, to[0], DOF, 0, 0)
    MEASURE(inverse_dynamics_derivatives, 3, RESULTS(to[0], to[1]), SQUARE, SQUARE, 0)
    MEASURE(forward_dynamics_derivatives, 3, RESULTS(to[0], to[1], to[2]), SQUARE, SQUARE, SQUARE)
    MEASURE(base_regressor, 3, to[0], DOF * BASE, 0, 0)
    /* The size of a block. */
    const auto block = [&](int threads, double ms) { printf("%s %s inverse_dynamics, %d threads: %.3f G states/s\n", ARM, ARITHMETIC, threads, most / ms * 1e-6); };
    block(32, time_of(10, [&](cudaStream_t s) { OF(_launch_inverse_dynamics)<32>(most, most, LAUNCH_3, to[0], s); }));
    block(128, time_of(10, [&](cudaStream_t s) { OF(_launch_inverse_dynamics)<128>(most, most, LAUNCH_3, to[0], s); }));
    block(256, time_of(10, [&](cudaStream_t s) { OF(_launch_inverse_dynamics)<256>(most, most, LAUNCH_3, to[0], s); }));
    return 0;
}
