
/* Sine and cosine for |x| <= pi/4, by the polynomials of fdlibm (Sun Microsystems 1993; in single precision by Ian Lance Taylor). */
static inline void robot_libm_wave(double x, float *sine, float *cosine)
{
    ROBOT_UNFUSED
    const double z = x * x, w = z * z, v = z * x;
    const double s = -0.000198393348360966317347 + z * 0.0000027183114939898219064;
    const double c = -0.00138867637746099294692 + z * 0.0000243904487962774090654;
    *sine = (float)((x + v * (-0.166666666416265235595 + z * 0.0083333293858894631756)) + v * w * s);
    *cosine = (float)(((1.0 + z * -0.499999997251031003120) + w * 0.0416666233237390631894) + (w * z) * c);
}

/* Sine and cosine of an angle, within 1 unit in the last place, as fdlibm has them. */
static inline void robot_libm_sin_cos(float x, float *sine, float *cosine)
{
    ROBOT_UNFUSED
    const double half_pi = 1.5707963267948966;
    const double to_integer = 1.5 / 2.2204460492503131e-16;
    const uint32_t size = robot_bits(x) & 0x7fffffffu;
    double rest[2], n;
    float s, c;
    int32_t turns;
    if (!robot_is_finite(x)) {
        *sine = *cosine = x - x;
        return;
    }
    if (size < 0x39800000u) {
        *sine = x;
        *cosine = 1;
        return;
    }
    if (size <= 0x40e231d5u) {
        /* Up to 9 pi/4, with signs that keep those of zeros. */
        turns = size <= 0x3f490fdau ? 0 : size <= 0x4016cbe3u ? 1 : size <= 0x407b53d1u ? 2 : size <= 0x40afeddfu ? 3 : 4;
        turns = x < 0 ? -turns : turns;
        rest[0] = (double)x - (double)turns * half_pi;
    } else if (size < 0x4dc90fdbu) {
        n = (double)x * 6.36619772367581382433e-01 + to_integer;
        n = n - to_integer;
        rest[0] = (double)x - n * 1.57079631090164184570e+00 - n * 1.58932547735281966916e-08;
        turns = (int32_t)n;
    } else {
        const int exponent = (int)(size >> 23) - 150;
        const double part = (double)robot_from_bits(size - ((uint32_t)exponent << 23));
        turns = robot_libm_large_angle(&part, 1, exponent, 3, rest);
        if (x < 0) {
            rest[0] = -rest[0];
            turns = -turns;
        }
    }
    turns &= 3;
    robot_libm_wave(rest[0], &s, &c);
    *sine = turns == 0 ? s : turns == 1 ? c : turns == 2 ? -s : -c;
    *cosine = turns == 0 ? c : turns == 1 ? -s : turns == 2 ? -c : s;
}
