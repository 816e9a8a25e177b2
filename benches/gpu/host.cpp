/* The functions on the host, compiled by the host's compiler alone from the same header. */
#include HEADER
#include "bench.h"

template <int DIMENSION>
using Rows = Real (*)[DIMENSION];

static void take(Range range, const Real *const *from, size_t state, int arguments, Real to[3][DOF])
{
    for (int a = 0; a < arguments; ++a) {
        for (int k = 0; k < DOF; ++k) {
            to[a][k] = entry(from[a], range.leading, state, k, DOF);
        }
    }
}

#define EACH(arguments, entries, call) \
    for (size_t i = range.begin; i < range.end; ++i) { \
        Real x[3][DOF]; \
        Real *row = rows + (i - range.begin) * (entries); \
        take(range, from, i, arguments, x); \
        call; \
    }

void host_inverse_dynamics(Range range, const Real *const *from, Real *rows)
{
    EACH(3, DOF, OF(_inverse_dynamics)(x[0], x[1], x[2], row))
}

void host_inertia_matrix(Range range, const Real *const *from, Real *rows)
{
    EACH(1, SQUARE, OF(_inertia_matrix)(x[0], (Rows<DOF>)row))
}

void host_coriolis_matrix(Range range, const Real *const *from, Real *rows)
{
    EACH(2, SQUARE, OF(_coriolis_matrix)(x[0], x[1], (Rows<DOF>)row))
}

void host_forward_dynamics(Range range, const Real *const *from, Real *rows)
{
    EACH(3, DOF, OF(_forward_dynamics)(x[0], x[1], x[2], row))
}

void host_inverse_dynamics_derivatives(Range range, const Real *const *from, Real *rows)
{
    EACH(3, 2 * SQUARE, OF(_inverse_dynamics_derivatives)(x[0], x[1], x[2], (Rows<DOF>)row, (Rows<DOF>)(row + SQUARE)))
}

void host_forward_dynamics_derivatives(Range range, const Real *const *from, Real *rows)
{
    EACH(3, 3 * SQUARE,
         OF(_forward_dynamics_derivatives)(x[0], x[1], x[2], (Rows<DOF>)row, (Rows<DOF>)(row + SQUARE), (Rows<DOF>)(row + 2 * SQUARE)))
}

void host_base_regressor(Range range, const Real *const *from, Real *rows)
{
    EACH(3, DOF * BASE, OF(_base_regressor)(x[0], x[1], x[2], (Rows<BASE>)row))
}
