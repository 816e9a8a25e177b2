/* Random arrays, times by events, and the comparison of bits. */
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cmath>
#include <ctime>
#include <thread>
#include <vector>

static void check(cudaError_t error, const char *at)
{
    if (error != cudaSuccess) {
        printf("%s: %s\n", at, cudaGetErrorString(error));
        exit(1);
    }
}
#define CHECK(call) check(call, #call)

/* Uniform in (-size, size), by splitmix64. */
template <typename T>
static void fill(std::vector<T> &array, double size, uint64_t seed)
{
    for (size_t i = 0; i < array.size(); ++i) {
        uint64_t z = (seed << 40) + (i + 1) * 0x9E3779B97F4A7C15ull;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
        array[i] = (T)(((double)((z ^ (z >> 31)) >> 11) / 4503599627370496.0 - 1.0) * size);
    }
}

/* Milliseconds of a launch: the least of three rounds of so many launches. */
template <typename Launch>
static double time_of(int launches, Launch launch)
{
    cudaEvent_t begin, end;
    CHECK(cudaEventCreate(&begin));
    CHECK(cudaEventCreate(&end));
    double least = 1e30;
    launch((cudaStream_t)0);
    CHECK(cudaDeviceSynchronize());
    for (int round = 0; round < 3; ++round) {
        CHECK(cudaEventRecord(begin));
        for (int i = 0; i < launches; ++i) {
            launch((cudaStream_t)0);
        }
        CHECK(cudaEventRecord(end));
        CHECK(cudaEventSynchronize(end));
        float ms;
        CHECK(cudaEventElapsedTime(&ms, begin, end));
        least = fmin(least, (double)ms / launches);
    }
    CHECK(cudaGetLastError());
    return least;
}

/* The same for launches in a graph of a hundred. */
template <typename Launch>
static double time_in_graph(Launch launch)
{
    cudaStream_t stream;
    cudaGraph_t graph;
    cudaGraphExec_t made;
    CHECK(cudaStreamCreate(&stream));
    CHECK(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal));
    for (int i = 0; i < 100; ++i) {
        launch(stream);
    }
    CHECK(cudaStreamEndCapture(stream, &graph));
    CHECK(cudaGraphInstantiate(&made, graph, 0));
    CHECK(cudaGraphLaunch(made, stream));
    CHECK(cudaStreamSynchronize(stream));
    cudaEvent_t begin, end;
    CHECK(cudaEventCreate(&begin));
    CHECK(cudaEventCreate(&end));
    double least = 1e30;
    for (int round = 0; round < 5; ++round) {
        CHECK(cudaEventRecord(begin, stream));
        CHECK(cudaGraphLaunch(made, stream));
        CHECK(cudaEventRecord(end, stream));
        CHECK(cudaEventSynchronize(end));
        float ms;
        CHECK(cudaEventElapsedTime(&ms, begin, end));
        least = fmin(least, (double)ms / 100);
    }
    return least;
}

/* Milliseconds until the host sees the end of one launch: the median of two hundred. */
template <typename Launch>
static double time_waited(Launch launch)
{
    std::vector<double> all;
    for (int i = 0; i < 200; ++i) {
        timespec a, b;
        clock_gettime(CLOCK_MONOTONIC, &a);
        launch((cudaStream_t)0);
        CHECK(cudaStreamSynchronize(0));
        clock_gettime(CLOCK_MONOTONIC, &b);
        all.push_back((b.tv_sec - a.tv_sec) * 1e3 + (b.tv_nsec - a.tv_nsec) * 1e-6);
    }
    std::sort(all.begin(), all.end());
    return all[all.size() / 2];
}

struct Compared {
    long numbers = 0, differing = 0;
    double worst = 0, largest = 0;
};

/* Two numbers: whether their bits are the same, not-a-number like not-a-number. */
template <typename T>
static void compare(T a, T b, Compared &into)
{
    ++into.numbers;
    into.largest = fmax(into.largest, fabs((double)b));
    if (memcmp(&a, &b, sizeof a) != 0 && !(a != a && b != b)) {
        ++into.differing;
        into.worst = fmax(into.worst, fabs((double)a - (double)b));
    }
}

/* A range of states by each processor. */
template <typename Work>
static Compared on_all_cores(size_t states, Work work)
{
    const size_t cores = std::thread::hardware_concurrency() > 0 ? std::thread::hardware_concurrency() : 1;
    std::vector<std::thread> threads;
    std::vector<Compared> found(cores);
    for (size_t core = 0; core < cores; ++core) {
        threads.emplace_back([&, core] {
            for (size_t begin = core * 1024; begin < states; begin += cores * 1024) {
                work(begin, begin + 1024 < states ? begin + 1024 : states, found[core]);
            }
        });
    }
    Compared all;
    for (size_t core = 0; core < cores; ++core) {
        threads[core].join();
        all.numbers += found[core].numbers;
        all.differing += found[core].differing;
        all.worst = fmax(all.worst, found[core].worst);
        all.largest = fmax(all.largest, found[core].largest);
    }
    return all;
}

/* A copy of as many numbers as a function reads and writes, entry after entry. */
template <typename T, int IN, int OUT>
__global__ void copy_kernel(size_t states, const T *__restrict__ from, T *__restrict__ to)
{
    size_t i = (size_t)blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= states) {
        return;
    }
    T x[IN], rest = 0;
#pragma unroll
    for (int k = 0; k < IN; ++k) {
        x[k] = from[k * states + i];
    }
#pragma unroll
    for (int k = OUT; k < IN; ++k) {
        rest += x[k];
    }
#pragma unroll
    for (int k = 0; k < OUT; ++k) {
        to[k * states + i] = k == 0 ? x[0] + rest : x[k % IN];
    }
}
