
/* What Rust's library has of numbers. Of two that are equal the first one counts, zeros of both signs included; what is not a number never. */
static inline robot_real robot_abs(robot_real x)
{
    return ROBOT_FABS(x);
}

static inline robot_real robot_max(robot_real x, robot_real y)
{
    return y > x || x != x ? y : x;
}

static inline robot_real robot_min(robot_real x, robot_real y)
{
    return y < x || x != x ? y : x;
}

static inline robot_real robot_clamp(robot_real x, robot_real low, robot_real high)
{
    return x < low ? low : x > high ? high : x;
}

static inline bool robot_is_finite(robot_real x)
{
    return x - x == 0;
}

/* A number as its bits, and back. */
static inline robot_word robot_bits(robot_real x)
{
    robot_word bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline robot_real robot_from_bits(robot_word bits)
{
    robot_real x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Roots and integers are exact or correctly rounded in every C library. */
static inline robot_real robot_libm_sqrt(robot_real x)
{
    return ROBOT_SQRT(x);
}

static inline robot_real robot_libm_floor(robot_real x)
{
    return ROBOT_FLOOR(x);
}
