/* Sines and cosines of the angles that are beyond 128 rad, infinite or not a number. */
static inline void robot_sin_cos_beyond(int count, const robot_real *angle, robot_real *sine, robot_real *cosine)
{
    int i;
    for (i = 0; i < count; ++i) {
        if (!(angle[i] >= -128.0f && angle[i] <= 128.0f)) {
            sine[i] = ROBOT_SIN(angle[i]);
            cosine[i] = ROBOT_COS(angle[i]);
        }
    }
}

/*
 * Sine and cosine of an angle, |x| <= 128 rad, each within 1 unit in the last place, in plain arithmetic and choices: a loop over angles
 * becomes vector instructions, and the bits are the same everywhere.
 *
 * n is the integer nearest to 2x/pi: adding 3/2 2^23 rounds. x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three
 * numbers, of which the first two have 17 bits. Their products with n are exact, and so is x less the first; e holds the third product less
 * what r rounds away. The polynomials are minimax on |r| <= pi/4 (Remez). h is n/2 rounded to the nearest even integer of the two where n is odd:
 * n - 2h and h modulo 2 say which of the two is the sine, and the signs.
 */
ROBOT_INLINE void robot_sin_cos(int count, const robot_real *angle, robot_real *sine, robot_real *cosine)
{
    ROBOT_UNFUSED
    int i;
    int beyond = 0;
    for (i = 0; i < count; ++i) {
        const robot_real x = angle[i];
        const robot_real n = (x * 0.63661977f + 12582912.0f) - 12582912.0f;
        const robot_real first = x - n * 1.5707855f;
        const robot_real step = n * 1.0804273e-5f;
        const robot_real r = first - step;
        const robot_real e = n * 6.0771005e-11f - ((first - r) - step);
        const robot_real z = r * r;
        const robot_real zz = z * z;
        const robot_real p = 0.008332204f + z * -0.00019520518f;
        const robot_real s = r - (e + (z * r) * (0.16666655f - z * p));
        const robot_real q = (0.041666646f + z * -0.0013887332f) + zz * 2.443618e-5f;
        const robot_real half = 0.5f * z;
        const robot_real top = 1.0f - half;
        const robot_real c = top + (((1.0f - top) - half) + (zz * q + r * e));
        const robot_real h = (n * 0.5f + 12582912.0f) - 12582912.0f;
        const robot_real odd = n - 2.0f * h;
        const robot_real two = h - 2.0f * ((h * 0.5f + 12582912.0f) - 12582912.0f);
        sine[i] = odd != 0.0f ? (odd > 0.0f ? c : -c) : (two != 0.0f ? -s : s);
        cosine[i] = odd != 0.0f ? (odd > 0.0f ? -s : s) : (two != 0.0f ? -c : c);
    }
    for (i = 0; i < count; ++i) {
        beyond |= !(angle[i] >= -128.0f && angle[i] <= 128.0f);
    }
    if (beyond) {
        robot_sin_cos_beyond(count, angle, sine, cosine);
    }
}
