/* Sines and cosines of angles, from the C library. */
static inline void robot_sin_cos(int count, const robot_real *angle, robot_real *sine, robot_real *cosine)
{
    int i;
    for (i = 0; i < count; ++i) {
        sine[i] = ROBOT_SIN(angle[i]);
        cosine[i] = ROBOT_COS(angle[i]);
    }
}
