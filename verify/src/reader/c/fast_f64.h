/* Sines and cosines of the angles that are beyond 65536 rad, infinite or not a number. */
static inline void robot_sin_cos_beyond(int count, const robot_real *angle, robot_real *sine, robot_real *cosine)
{
    int i;
    for (i = 0; i < count; ++i) {
        if (!(angle[i] >= -65536.0 && angle[i] <= 65536.0)) {
            sine[i] = ROBOT_SIN(angle[i]);
            cosine[i] = ROBOT_COS(angle[i]);
        }
    }
}

/*
 * Sine and cosine of an angle, |x| <= 65536 rad, each within 1 unit in the last place, in plain arithmetic and choices: a loop over angles
 * becomes vector instructions, and the bits are the same everywhere.
 *
 * n is the integer nearest to 2x/pi: adding 3/2 2^52 rounds. x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three
 * numbers, of which the first two have 37 bits. Their products with n are exact, and so is x less the first; e holds the third product less
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
        const robot_real n = (x * 0.6366197723675814 + 6755399441055744.0) - 6755399441055744.0;
        const robot_real first = x - n * 1.5707963267923333;
        const robot_real step = n * 2.5633441515839558e-12;
        const robot_real r = first - step;
        const robot_real e = n * 1.0562999066987428e-23 - ((first - r) - step);
        const robot_real z = r * r;
        const robot_real zz = z * z;
        const robot_real p = (0.008333333333322035 + z * -0.00019841269829660063)
            + zz * ((2.7557313668040543e-6 + z * -2.5050756282937577e-8) + zz * 1.5896732662311403e-10);
        const robot_real s = r - (e + (z * r) * (0.1666666666666663 - z * p));
        const robot_real q = (0.0416666666666666 + z * -0.0013888888888873453)
            + zz * ((2.4801587287964484e-5 + z * -2.7557313594775254e-7) + zz * (2.087558805713208e-9 + z * -1.1351822784169523e-11));
        const robot_real half = 0.5 * z;
        const robot_real top = 1.0 - half;
        const robot_real c = top + (((1.0 - top) - half) + (zz * q + r * e));
        const robot_real h = (n * 0.5 + 6755399441055744.0) - 6755399441055744.0;
        const robot_real odd = n - 2.0 * h;
        const robot_real two = h - 2.0 * ((h * 0.5 + 6755399441055744.0) - 6755399441055744.0);
        sine[i] = odd != 0.0 ? (odd > 0.0 ? c : -c) : (two != 0.0 ? -s : s);
        cosine[i] = odd != 0.0 ? (odd > 0.0 ? -s : s) : (two != 0.0 ? -c : c);
    }
    for (i = 0; i < count; ++i) {
        beyond |= !(angle[i] >= -65536.0 && angle[i] <= 65536.0);
    }
    if (beyond) {
        robot_sin_cos_beyond(count, angle, sine, cosine);
    }
}
