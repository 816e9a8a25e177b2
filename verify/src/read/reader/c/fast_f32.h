/* Vectors of angles where the processor has them, single angles elsewhere. */
#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(__HIPCC__) && (defined(__SSE2__) || defined(__aarch64__) || defined(__wasm_simd128__))
#if defined(__AVX2__)
#define ROBOT_VECTOR_LANES 8
#define ROBOT_VECTOR_AT(from) {(from)[0], (from)[1], (from)[2], (from)[3], (from)[4], (from)[5], (from)[6], (from)[7]}
#else
#define ROBOT_VECTOR_LANES 4
#define ROBOT_VECTOR_AT(from) {(from)[0], (from)[1], (from)[2], (from)[3]}
#endif
typedef robot_real robot_vector __attribute__((vector_size(ROBOT_VECTOR_LANES * sizeof(robot_real))));
typedef int robot_mask __attribute__((vector_size(ROBOT_VECTOR_LANES * sizeof(robot_real))));
#define ROBOT_CHOOSE(test, then, otherwise) \
    ((robot_vector)(((robot_mask)(test) & (robot_mask)(then)) | (~(robot_mask)(test) & (robot_mask)(otherwise))))
#define ROBOT_PUT(to, vector) __builtin_memcpy(to, &vector, sizeof vector)
#else
#define ROBOT_VECTOR_LANES 1
#define ROBOT_VECTOR_AT(from) *(from)
typedef robot_real robot_vector;
#define ROBOT_CHOOSE(test, then, otherwise) ((test) ? (then) : (otherwise))
#define ROBOT_PUT(to, vector) *(to) = vector
#endif

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
 * Sine and cosine of an angle, |x| <= 128 rad, each within 1 unit in the last place, in plain arithmetic and choices, as many angles at
 * a time as a vector has: the bits are the same everywhere. Arrays are filled up to whole vectors.
 *
 * n is the integer nearest to 2x/pi: adding 3/2 2^23 rounds.
 * x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have 17 bits. Their products
 * with n are exact, and so is x less the first; e holds the third product less what r rounds away. p and q are minimax on
 * |r| <= pi/4 (Remez). h is n/2 rounded to the nearest integer, halves to the even one: n - 2h and h modulo 2 say which of the two is the sine,
 * and the signs.
 */
ROBOT_INLINE void robot_sin_cos(int count, const robot_real *angle, robot_real *sine, robot_real *cosine)
{
    ROBOT_UNFUSED
    int i;
    int beyond = 0;
    for (i = 0; i < count; i += ROBOT_VECTOR_LANES) {
        const robot_vector x = ROBOT_VECTOR_AT(angle + i);
        const robot_vector n = (x * 0.63661977f + 12582912.0f) - 12582912.0f;
        const robot_vector first = x - n * 1.5707855f;
        const robot_vector step = n * 1.0804273e-5f;
        const robot_vector r = first - step;
        const robot_vector e = n * 6.0771005e-11f - ((first - r) - step);
        const robot_vector z = r * r;
        const robot_vector zz = z * z;
        const robot_vector half = 0.5f * z;
        const robot_vector top = 1.0f - half;
        const robot_vector p = 0.16666655f - z * (0.008332204f + z * -0.00019520518f);
        const robot_vector s = r - (e * top + (z * r) * p);
        const robot_vector q = (0.041666646f + z * -0.0013887332f) + zz * 2.443618e-5f;
        const robot_vector c = top + ((((1.0f - top) - half) + r * e) + zz * q);
        const robot_vector h = (n * 0.5f + 12582912.0f) - 12582912.0f;
        const robot_vector odd = n - 2.0f * h;
        const robot_vector two = h - 2.0f * ((h * 0.5f + 12582912.0f) - 12582912.0f);
        const robot_vector flip = ROBOT_CHOOSE(odd != 0.0f, odd, 1.0f - (two + two) * two);
        const robot_vector sines = ROBOT_CHOOSE(odd != 0.0f, c, s) * flip;
        const robot_vector cosines = ROBOT_CHOOSE(odd != 0.0f, -s, c) * flip;
        ROBOT_PUT(sine + i, sines);
        ROBOT_PUT(cosine + i, cosines);
    }
    for (i = 0; i < count; ++i) {
        beyond |= !(angle[i] * angle[i] <= 16384.0f);
    }
    if (beyond) {
        robot_sin_cos_beyond(count, angle, sine, cosine);
    }
}
