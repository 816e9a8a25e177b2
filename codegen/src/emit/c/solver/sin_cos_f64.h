
/* Sine and cosine of x + y for |x| <= pi/4 and the rest y of x, by the polynomials of fdlibm (Sun Microsystems 1993). */
static inline void robot_libm_wave(double x, double y, bool with_rest, double *sine, double *cosine)
{
    ROBOT_UNFUSED
    const double z = x * x, w = z * z, v = z * x, half = 0.5 * z, one = 1.0 - half;
    const double s = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06)
                   + z * w * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10);
    const double c = z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * 2.48015872894767294178e-05))
                   + w * w * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11));
    const double s1 = -1.66666666666666324348e-01;
    *sine = with_rest ? x - ((z * (0.5 * y - v * s) - y) - v * s1) : x + v * (s1 + z * s);
    *cosine = one + (((1.0 - one) - half) + (z * c - x * y));
}

/* The number of right angles in x, of which the last two binary digits count, and what is left of x in two parts. */
static inline int32_t robot_libm_right_angles(double x, double *rest)
{
    ROBOT_UNFUSED
    /* pi/2 in parts of 33 bits, each with what is left. */
    static const double part[3] = {1.57079632673412561417e+00, 6.07710050630396597660e-11, 2.02226624871116645580e-21};
    static const double left[3] = {6.07710050650619224932e-11, 2.02226624879595063154e-21, 8.47842766036889956997e-32};
    const double to_integer = 1.5 / 2.2204460492503131e-16;
    const uint32_t high = (uint32_t)(robot_bits(x) >> 32) & 0x7fffffffu;
    double parts[3], n, r, w, t;
    int32_t size, turns;
    int i;
    if (high <= 0x401c463bu) {
        bool cancels;
        n = high <= 0x4002d97cu ? 1 : high <= 0x400f6a7au ? 2 : high <= 0x4015fdbcu ? 3 : 4;
        cancels = high <= 0x400f6a7au ? (high & 0xfffffu) == 0x921fbu : high == (n < 4 ? 0x4012d97cu : 0x401921fbu);
        if (!cancels) {
            n = x < 0 ? -n : n;
            r = x - n * part[0];
            w = n * left[0];
            rest[0] = r - w;
            rest[1] = (r - rest[0]) - w;
            return (int32_t)n;
        }
    }
    if (high < 0x413921fbu) {
        n = x * 6.36619772367581382433e-01 + to_integer;
        n = n - to_integer;
        r = x - n * part[0];
        w = n * left[0];
        rest[0] = r - w;
        size = (int32_t)(high >> 20);
        for (i = 1; i < 3 && size - (int32_t)((robot_bits(rest[0]) >> 52) & 0x7ff) > (i == 1 ? 16 : 49); ++i) {
            t = r;
            w = n * part[i];
            r = t - w;
            w = n * left[i] - ((t - r) - w);
            rest[0] = r - w;
        }
        rest[1] = (r - rest[0]) - w;
        return (int32_t)n;
    }
    /* |x| as three parts of 24 bits. */
    r = robot_from_bits((robot_bits(x) & UINT64_C(0x000fffffffffffff)) | UINT64_C(0x4160000000000000));
    for (i = 0; i < 2; ++i) {
        parts[i] = (double)(int32_t)r;
        r = (r - parts[i]) * 16777216.0;
    }
    parts[2] = r;
    for (i = 3; i > 1 && parts[i - 1] == 0; --i) {
    }
    turns = robot_libm_large_angle(parts, i, (int)(high >> 20) - 1046, 4, rest);
    if (x < 0) {
        rest[0] = -rest[0];
        rest[1] = -rest[1];
        turns = -turns;
    }
    return turns;
}

/* Sine and cosine of an angle, within 1 unit in the last place, as fdlibm has them. */
static inline void robot_libm_sin_cos(double x, double *sine, double *cosine)
{
    const uint32_t high = (uint32_t)(robot_bits(x) >> 32) & 0x7fffffffu;
    double s, c, rest[2];
    int32_t turns;
    if (!robot_is_finite(x)) {
        *sine = *cosine = x - x;
        return;
    }
    if (high <= 0x3fe921fbu) {
        if (high < 0x3e46a09eu) {
            *sine = x;
            *cosine = 1;
        } else {
            robot_libm_wave(x, 0, false, sine, cosine);
        }
        return;
    }
    turns = robot_libm_right_angles(x, rest) & 3;
    robot_libm_wave(rest[0], rest[1], true, &s, &c);
    *sine = turns == 0 ? s : turns == 1 ? c : turns == 2 ? -s : -c;
    *cosine = turns == 0 ? c : turns == 1 ? -s : turns == 2 ? -c : s;
}
