/**
 * @stribeck@
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
