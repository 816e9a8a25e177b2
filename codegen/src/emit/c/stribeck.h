/*
 * @stribeck@
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
