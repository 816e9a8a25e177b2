/* Sign of a rate: 0 at rest, not a number for what is not a number. */
static inline robot_real robot_sign(robot_real x)
{
    return x > 0 ? 1 : (x < 0 ? -1 : x);
}
