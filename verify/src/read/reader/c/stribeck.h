/*
 * exp(-|rate| / velocity), what is left of Stribeck friction at a rate, within 2 units of roundoff; 0 where it is below 1e-17, not a number for
 * what is not a number. x = |rate| / velocity = n ln 2 + r with n the integer nearest to x / ln 2, after Cody and Waite (1980): the first part of
 * ln 2 has 16 bits, so that its product with n is exact, and so is x less that. 2^-n is a product of powers of two; exp(-r) its series up to
 * r^13 / 13!, which leaves out less than 2^-57.
 */
static inline robot_real robot_stribeck(robot_real rate, robot_real velocity)
{
    ROBOT_UNFUSED
    static const robot_real ln_2[2] = {(robot_real)0.693145751953125, (robot_real)1.4286068203094173e-6};
    static const robot_real powers[6][2] = {
        {(robot_real)32.0, (robot_real)2.3283064365386963e-10}, {(robot_real)16.0, (robot_real)1.52587890625e-5},
        {(robot_real)8.0, (robot_real)0.00390625}, {(robot_real)4.0, (robot_real)0.0625},
        {(robot_real)2.0, (robot_real)0.25}, {(robot_real)1.0, (robot_real)0.5}};
    static const robot_real coefficients[12] = {
        (robot_real)1.6059043836821613e-10, (robot_real)2.08767569878681e-9, (robot_real)2.505210838544172e-8,
        (robot_real)2.755731922398589e-7, (robot_real)2.7557319223985893e-6, (robot_real)2.48015873015873e-5,
        (robot_real)0.0001984126984126984, (robot_real)0.001388888888888889, (robot_real)0.008333333333333333,
        (robot_real)0.041666666666666664, (robot_real)0.16666666666666666, (robot_real)0.5};
    const robot_real x = (rate < 0 ? -rate : rate) / velocity;
    robot_real n = 0, power = 1, rest = x + (robot_real)0.3465728759765625, r, series = 0;
    int i;
    if (x > 40) {
        return 0;
    }
    for (i = 0; i < 6; ++i) {
        if (rest >= powers[i][0] * ln_2[0]) {
            rest -= powers[i][0] * ln_2[0];
            n += powers[i][0];
            power *= powers[i][1];
        }
    }
    r = (x - n * ln_2[0]) - n * ln_2[1];
    for (i = 0; i < 12; ++i) {
        series = coefficients[i] - r * series;
    }
    return power * (1 - (r - r * r * series));
}
