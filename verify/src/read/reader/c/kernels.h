/*
 * On a GPU, where the compiler is one for CUDA or HIP: each function for many states, a thread for each state in turn, with the bits of the
 * function for one state. Arrays lie in the memory of the device. With `leading` 0 they lie state after state, each by rows, as those of a
 * batch; otherwise entry after entry, that of row-major number k of state i at [k * leading + i], with `leading` at least the number of
 * states: neighbouring threads then read neighbouring numbers, and memory is as fast as it can be. A result may not lie where an argument or
 * another result does. A call returns when the work is in the stream, with the error of the launch; `threads` are those of a block.
 */
#if defined(__CUDACC__) || defined(__HIPCC__)
#include <stddef.h>
#if defined(__CUDACC__)
typedef cudaStream_t robot_stream;
typedef cudaError_t robot_status;
#define ROBOT_LAST_ERROR() cudaGetLastError()
#else
typedef hipStream_t robot_stream;
typedef hipError_t robot_status;
#define ROBOT_LAST_ERROR() hipGetLastError()
#endif
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
#define ROBOT_UNROLLED _Pragma("unroll")
#else
#define ROBOT_UNROLLED
#endif
#define ROBOT_FIRST_STATE ((size_t)blockIdx.x * blockDim.x + threadIdx.x)
#define ROBOT_ALL_THREADS ((size_t)gridDim.x * blockDim.x)

/* So many blocks that each thread has a state, up to a million; then threads take several. */
static inline unsigned int robot_blocks(size_t states, int threads)
{
    const size_t blocks = (states + (size_t)threads - 1) / (size_t)threads;
    return blocks < 1048576 ? (unsigned int)blocks : 1048576u;
}

ROBOT_INLINE void robot_take(int entries, size_t state, size_t leading, const robot_real *__restrict__ from, robot_real *to)
{
    const size_t first = leading == 0 ? state * (size_t)entries : state, step = leading == 0 ? 1 : leading;
    int i;
    ROBOT_UNROLLED
    for (i = 0; i < entries; ++i) {
        to[i] = from[first + (size_t)i * step];
    }
}

ROBOT_INLINE void robot_give(int entries, size_t state, size_t leading, const robot_real *from, robot_real *__restrict__ to)
{
    const size_t first = leading == 0 ? state * (size_t)entries : state, step = leading == 0 ? 1 : leading;
    int i;
    ROBOT_UNROLLED
    for (i = 0; i < entries; ++i) {
        to[first + (size_t)i * step] = from[i];
    }
}
