/*
 * What both sides of the measurement share: the functions, and the order of their arguments and results.
 *
 * ROBOT: the prefix of the robot's functions; REAL: its scalar; DOF, BASE: numbers of joints and of base parameters.
 */
#include <cstddef>

#define JOINED_(a, b) a##b
#define JOINED(a, b) JOINED_(a, b)
#define OF(name) JOINED(ROBOT, name)

typedef REAL Real;
constexpr int SQUARE = DOF * DOF;

/* FUNCTION(name, arguments, entries of each result): the arguments are the first of q, dq and ddq or tau. */
#define FUNCTIONS \
    FUNCTION(inverse_dynamics, 3, DOF, 0, 0) \
    FUNCTION(inertia_matrix, 1, SQUARE, 0, 0) \
    FUNCTION(coriolis_matrix, 2, SQUARE, 0, 0) \
    FUNCTION(forward_dynamics, 3, DOF, 0, 0) \
    FUNCTION(inverse_dynamics_derivatives, 3, SQUARE, SQUARE, 0) \
    FUNCTION(forward_dynamics_derivatives, 3, SQUARE, SQUARE, SQUARE) \
    FUNCTION(base_regressor, 3, DOF * BASE, 0, 0)

/* A range of states on the host. Entry k of state i of an array with m entries is at [i * m + k] if leading is 0, else at [k * leading + i]. */
struct Range {
    size_t begin, end, leading;
};

template <typename T>
inline T &entry(T *array, size_t leading, size_t state, int k, int entries)
{
    return leading == 0 ? array[state * entries + k] : array[k * leading + state];
}

/* The host's function on these states, into a row of all results for each state. */
#define FUNCTION(name, arguments, first, second, third) void host_##name(Range range, const Real *const *from, Real *rows);
FUNCTIONS
#undef FUNCTION
