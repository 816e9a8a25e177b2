
/*
 * The arctangent, within 1 unit in the last place, by the method and with the coefficients of fdlibm (Sun Microsystems 1993; in single
 * precision by Ian Lance Taylor): |x| is brought to [0, 7/16] by the tangents of 0, atan 1/2, pi/4, atan 3/2 and pi/2, whose angles are in
 * two parts.
 */
static inline float robot_libm_atan(float x)
{
    ROBOT_UNFUSED
    static const float angle[4] = {4.6364760399e-01f, 7.8539812565e-01f, 9.8279368877e-01f, 1.5707962513e+00f};
    static const float rest[4] = {5.0121582440e-09f, 3.7748947079e-08f, 3.4473217170e-08f, 7.5497894159e-08f};
    static const float a[5] = {3.3333328366e-01f, -1.9999158382e-01f, 1.4253635705e-01f, -1.0648017377e-01f, 6.1687607318e-02f};
    const float size = x < 0 ? -x : x;
    float t, z, w, odd, even;
    int part;
    if (x != x) {
        return x;
    }
    if (size >= 67108864.0f) { /* 2^26 */
        return x < 0 ? -angle[3] : angle[3];
    }
    if (size < 0.000244140625f) { /* 2^-12 */
        return x;
    }
    if (size < 0.4375f) {
        part = -1;
        t = x;
    } else if (size < 0.6875f) {
        part = 0;
        t = (2 * size - 1) / (2 + size);
    } else if (size < 1.1875f) {
        part = 1;
        t = (size - 1) / (size + 1);
    } else if (size < 2.4375f) {
        part = 2;
        t = (size - 1.5f) / (1 + 1.5f * size);
    } else {
        part = 3;
        t = -1 / size;
    }
    z = t * t;
    w = z * z;
    odd = z * (a[0] + w * (a[2] + w * a[4]));
    even = w * (a[1] + w * a[3]);
    if (part < 0) {
        return t - t * (odd + even);
    }
    z = angle[part] - ((t * (odd + even) - rest[part]) - t);
    return x < 0 ? -z : z;
}

/* The angle of the point (x, y), in [-pi, pi]. Signs of zeros count. */
static inline float robot_libm_atan2(float y, float x)
{
    ROBOT_UNFUSED
    static const float pi = 3.1415927410e+00f, rest = -8.7422776573e-08f;
    const uint32_t infinite = 0x7f800000u, far_apart = 26u << 23;
    const uint32_t left = robot_bits(x) >> 31, below = robot_bits(y) >> 31;
    const uint32_t width = robot_bits(x) & 0x7fffffffu, height = robot_bits(y) & 0x7fffffffu;
    float z;
    if (x != x || y != y) {
        return x + y;
    }
    if (x == 1) {
        return robot_libm_atan(y);
    }
    if (y == 0) {
        return left == 0 ? y : below == 0 ? pi : -pi;
    }
    if (x == 0) {
        return below == 0 ? pi / 2 : -pi / 2;
    }
    if (width == infinite) {
        z = height == infinite ? (left == 0 ? pi / 4 : 3 * pi / 4) : (left == 0 ? 0 : pi);
        return below == 0 ? z : -z;
    }
    if (width + far_apart < height || height == infinite) {
        return below == 0 ? pi / 2 : -pi / 2;
    }
    z = y / x;
    z = left != 0 && height + far_apart < width ? 0 : robot_libm_atan(z < 0 ? -z : z);
    if (left == 0) {
        return below == 0 ? z : -z;
    }
    return below == 0 ? pi - (z - rest) : (z - rest) - pi;
}
