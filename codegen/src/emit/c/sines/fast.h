/* Vectors of angles where the processor has them, single angles elsewhere. */
#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(__HIPCC__) && (defined(__SSE2__) || defined(__aarch64__) || defined(__wasm_simd128__))
@lanes@
typedef robot_real robot_vector __attribute__((vector_size(ROBOT_VECTOR_LANES * sizeof(robot_real))));
typedef @mask@ robot_mask __attribute__((vector_size(ROBOT_VECTOR_LANES * sizeof(robot_real))));
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

/* Sines and cosines of the angles that are beyond @limit@ rad, infinite or not a number. */
static inline void robot_sin_cos_beyond(int count, const robot_real *angle, robot_real *sine, robot_real *cosine)
{
    int i;
    for (i = 0; i < count; ++i) {
        if (!(angle[i] >= -@limit@.0@f@ && angle[i] <= @limit@.0@f@)) {
            sine[i] = ROBOT_SIN(angle[i]);
            cosine[i] = ROBOT_COS(angle[i]);
        }
    }
}

/*
 * Sine and cosine of an angle, |x| <= @limit@ rad, each within 1 unit in the last place, in plain arithmetic and choices, as many angles at
 * a time as a vector has: the bits are the same everywhere. Arrays are filled up to whole vectors.
 *
 * @sines@
 */
ROBOT_INLINE void robot_sin_cos(int count, const robot_real *angle, robot_real *sine, robot_real *cosine)
{
    ROBOT_UNFUSED
    int i;
    int beyond = 0;
    for (i = 0; i < count; i += ROBOT_VECTOR_LANES) {
        const robot_vector x = ROBOT_VECTOR_AT(angle + i);
        const robot_vector n = (x * @two_over_pi@ + @round@) - @round@;
        const robot_vector first = x - n * @first@;
        const robot_vector step = n * @second@;
        const robot_vector r = first - step;
        const robot_vector e = n * @third@ - ((first - r) - step);
        const robot_vector z = r * r;
        const robot_vector zz = z * z;
        const robot_vector half = 0.5@f@ * z;
        const robot_vector top = 1.0@f@ - half;
        const robot_vector p = @sine@;
        const robot_vector s = r - (e * top + (z * r) * p);
        const robot_vector q = @cosine@;
        const robot_vector c = top + ((((1.0@f@ - top) - half) + r * e) + zz * q);
        const robot_vector h = (n * 0.5@f@ + @round@) - @round@;
        const robot_vector odd = n - 2.0@f@ * h;
        const robot_vector two = h - 2.0@f@ * ((h * 0.5@f@ + @round@) - @round@);
        const robot_vector flip = ROBOT_CHOOSE(odd != 0.0@f@, odd, 1.0@f@ - (two + two) * two);
        const robot_vector sines = ROBOT_CHOOSE(odd != 0.0@f@, c, s) * flip;
        const robot_vector cosines = ROBOT_CHOOSE(odd != 0.0@f@, -s, c) * flip;
        ROBOT_PUT(sine + i, sines);
        ROBOT_PUT(cosine + i, cosines);
    }
    for (i = 0; i < count; ++i) {
        beyond |= !(angle[i] * angle[i] <= @square@);
    }
    if (beyond) {
        robot_sin_cos_beyond(count, angle, sine, cosine);
    }
}
