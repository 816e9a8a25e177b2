
/*
 * The arctangent, within 1 unit in the last place, by the method and with the coefficients of fdlibm (Sun Microsystems 1993): |x| is brought
 * to [0, 7/16] by the tangents of 0, atan 1/2, pi/4, atan 3/2 and pi/2, whose angles are in two parts.
 */
static inline double robot_libm_atan(double x)
{
    ROBOT_UNFUSED
    static const double angle[4] = {4.63647609000806093515e-01, 7.85398163397448278999e-01, 9.82793723247329054082e-01, 1.57079632679489655800e+00};
    static const double rest[4] = {2.26987774529616870924e-17, 3.06161699786838301793e-17, 1.39033110312309984516e-17, 6.12323399573676603587e-17};
    static const double a[11] = {
        3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01, -1.11111104054623557880e-01,
        9.09088713343650656196e-02, -7.69187620504482999495e-02, 6.66107313738753120669e-02, -5.83357013379057348645e-02,
        4.97687799461593236017e-02, -3.65315727442169155270e-02, 1.62858201153657823623e-02};
    const double size = x < 0 ? -x : x;
    double t, z, w, odd, even;
    int part;
    if (x != x) {
        return x;
    }
    if (size >= 73786976294838206464.0) { /* 2^66 */
        return x < 0 ? -angle[3] : angle[3];
    }
    if (size < 7.450580596923828125e-9) { /* 2^-27 */
        return x;
    }
    if (size < 0.4375) {
        part = -1;
        t = x;
    } else if (size < 0.6875) {
        part = 0;
        t = (2 * size - 1) / (2 + size);
    } else if (size < 1.1875) {
        part = 1;
        t = (size - 1) / (size + 1);
    } else if (size < 2.4375) {
        part = 2;
        t = (size - 1.5) / (1 + 1.5 * size);
    } else {
        part = 3;
        t = -1 / size;
    }
    z = t * t;
    w = z * z;
    odd = z * (a[0] + w * (a[2] + w * (a[4] + w * (a[6] + w * (a[8] + w * a[10])))));
    even = w * (a[1] + w * (a[3] + w * (a[5] + w * (a[7] + w * a[9]))));
    if (part < 0) {
        return t - t * (odd + even);
    }
    z = angle[part] - (t * (odd + even) - rest[part] - t);
    return x < 0 ? -z : z;
}

/* The angle of the point (x, y), in [-pi, pi]. Signs of zeros count. */
static inline double robot_libm_atan2(double y, double x)
{
    ROBOT_UNFUSED
    static const double pi = 3.1415926535897931160e+00, rest = 1.2246467991473531772e-16;
    const uint32_t infinite = 0x7ff00000u, far_apart = 64u << 20;
    const uint32_t left = (uint32_t)(robot_bits(x) >> 63), below = (uint32_t)(robot_bits(y) >> 63);
    const uint32_t width = (uint32_t)(robot_bits(x) >> 32) & 0x7fffffffu, height = (uint32_t)(robot_bits(y) >> 32) & 0x7fffffffu;
    double z;
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
