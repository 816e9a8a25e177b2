/* @sign@ */
static inline robot_real robot_sign(robot_real x)
{
    return x > 0 ? 1 : (x < 0 ? -1 : x);
}
