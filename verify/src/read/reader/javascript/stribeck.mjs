/**
 * exp(-|rate| / velocity), what is left of Stribeck friction at a rate, within 2 units of roundoff; 0 where it is below 1e-17, not a number for
 * what is not a number. x = |rate| / velocity = n ln 2 + r with n the integer nearest to x / ln 2, after Cody and Waite (1980): the first part of
 * ln 2 has 16 bits, so that its product with n is exact, and so is x less that. 2^-n is a product of powers of two; exp(-r) its series up to
 * r^13 / 13!, which leaves out less than 2^-57.
 */
function stribeck(rate, velocity) {
    const x = (rate < 0 ? -rate : rate) / velocity;
    if (x > 40) {
        return 0;
    }
    let n = 0, power = 1, rest = x + 0.3465728759765625;
    for (const [count, factor] of [[32, 2.3283064365386963e-10], [16, 1.52587890625e-5], [8, 0.00390625], [4, 0.0625], [2, 0.25], [1, 0.5]]) {
        if (rest >= count * 0.693145751953125) {
            rest -= count * 0.693145751953125;
            n += count;
            power *= factor;
        }
    }
    const r = (x - n * 0.693145751953125) - n * 1.4286068203094173e-6;
    let series = 0;
    for (const coefficient of [
        1.6059043836821613e-10, 2.08767569878681e-9, 2.505210838544172e-8, 2.755731922398589e-7, 2.7557319223985893e-6, 2.48015873015873e-5,
        0.0001984126984126984, 0.001388888888888889, 0.008333333333333333, 0.041666666666666664, 0.16666666666666666, 0.5,
    ]) {
        series = coefficient - r * series;
    }
    return power * (1 - (r - r * r * series));
}
