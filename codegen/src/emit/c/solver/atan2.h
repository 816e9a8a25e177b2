
/*
 * The arctangent, within 1 unit in the last place, by the method and with the coefficients of fdlibm @method@
 */
static inline @real@ robot_libm_atan(@real@ x)
{
    ROBOT_UNFUSED
    static const @real@ angle[4] = {@angles@};
    static const @real@ rest[4] = {@rests@};
    static const @real@ a[@count@] = {@coefficients@};
    const @real@ size = x < 0 ? -x : x;
    @real@ t, z, w, odd, even;
    int part;
    if (x != x) {
        return x;
    }
    if (size >= @large@) { /* @large_power@ */
        return x < 0 ? -angle[3] : angle[3];
    }
    if (size < @small@) { /* @small_power@ */
        return x;
    }
    if (size < 0.4375@f@) {
        part = -1;
        t = x;
    } else if (size < 0.6875@f@) {
        part = 0;
        t = (2 * size - 1) / (2 + size);
    } else if (size < 1.1875@f@) {
        part = 1;
        t = (size - 1) / (size + 1);
    } else if (size < 2.4375@f@) {
        part = 2;
        t = (size - 1.5@f@) / (1 + 1.5@f@ * size);
    } else {
        part = 3;
        t = -1 / size;
    }
    z = t * t;
    w = z * z;
    odd = z * (a[0] + w * (a[2] + w * @odd@));
    even = w * (a[1] + w * @even@);
    if (part < 0) {
        return t - t * (odd + even);
    }
    z = angle[part] - (@turned@ - t);
    return x < 0 ? -z : z;
}

/* The angle of the point (x, y), in [-pi, pi]. Signs of zeros count. */
static inline @real@ robot_libm_atan2(@real@ y, @real@ x)
{
    ROBOT_UNFUSED
    static const @real@ pi = @pi@, rest = @pi_rest@;
    const uint32_t infinite = @infinite@, far_apart = @far_apart@;
    const uint32_t left = @left@, below = @below@;
    const uint32_t width = @high_x@ & 0x7fffffffu, height = @high_y@ & 0x7fffffffu;
    @real@ z;
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
