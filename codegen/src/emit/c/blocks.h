
/*
 * Functions for many states, as many at a time as there are lanes: each has the bits of the function for one state. A block lies side by side,
 * entry after entry, and what is missing to a whole block is filled up with its last state. Results may not lie where arguments do, as they may for
 * one state: those of a block are written before the arguments of the next are read.
 */
#define ROBOT_LANES @

ROBOT_INLINE void robot_load(size_t rows, size_t count, const robot_real *from, robot_real *to)
{
    size_t row, lane;
    if (count == ROBOT_LANES) {
        for (lane = 0; lane < ROBOT_LANES; ++lane) {
            for (row = 0; row < rows; ++row) {
                to[row * ROBOT_LANES + lane] = from[lane * rows + row];
            }
        }
    } else {
        for (lane = 0; lane < ROBOT_LANES; ++lane) {
            for (row = 0; row < rows; ++row) {
                to[row * ROBOT_LANES + lane] = from[(lane < count ? lane : count - 1) * rows + row];
            }
        }
    }
}

ROBOT_INLINE void robot_store(size_t rows, size_t count, const robot_real *from, robot_real *to)
{
    size_t row, lane;
    if (count == ROBOT_LANES) {
        for (lane = 0; lane < ROBOT_LANES; ++lane) {
            for (row = 0; row < rows; ++row) {
                to[lane * rows + row] = from[row * ROBOT_LANES + lane];
            }
        }
    } else {
        for (lane = 0; lane < count; ++lane) {
            for (row = 0; row < rows; ++row) {
                to[lane * rows + row] = from[row * ROBOT_LANES + lane];
            }
        }
    }
}
