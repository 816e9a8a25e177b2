/** Sine and cosine of the angle that was asked for last. */
const wave = new Float64Array(2);

/**
 * Puts sine and cosine of an angle, rad, into `wave`, each within 1 unit in the last place; those of |x| > 65536 are the ones of `Math`.
 *
 * n is the integer nearest to 2x/pi: adding 3/2 2^52 rounds.
 * x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have 37 bits. Their products
 * with n are exact, and so is x less the first; e holds the third product less what r rounds away. p and q are minimax on
 * |r| <= pi/4 (Remez). h is n/2 rounded to the nearest integer, halves to the even one: n - 2h and h modulo 2 say which of the two is the sine,
 * and the signs.
 */
function sinCos(x) {
    if (!(x >= -65536.0 && x <= 65536.0)) {
        wave[0] = Math.sin(x);
        wave[1] = Math.cos(x);
        return;
    }
    const n = (x * 0.6366197723675814 + 6755399441055744.0) - 6755399441055744.0;
    const first = x - n * 1.5707963267923333;
    const step = n * 2.5633441515839558e-12;
    const r = first - step;
    const e = n * 1.0562999066987428e-23 - ((first - r) - step);
    const z = r * r;
    const zz = z * z;
    const half = 0.5 * z;
    const top = 1.0 - half;
    const p = (0.1666666666666663 + z * -0.008333333333322035) + zz * ((0.00019841269829660063 + z * -2.7557313668040543e-6) + zz * (2.5050756282937577e-8 + z * -1.5896732662311403e-10));
    const s = r - (e * top + (z * r) * p);
    const q = (0.0416666666666666 + z * -0.0013888888888873453) + zz * ((2.4801587287964484e-5 + z * -2.7557313594775254e-7) + zz * (2.087558805713208e-9 + z * -1.1351822784169523e-11));
    const c = top + ((((1.0 - top) - half) + r * e) + zz * q);
    const h = (n * 0.5 + 6755399441055744.0) - 6755399441055744.0;
    const odd = n - 2.0 * h;
    const two = h - 2.0 * ((h * 0.5 + 6755399441055744.0) - 6755399441055744.0);
    wave[0] = odd !== 0.0 ? (odd > 0.0 ? c : -c) : (two !== 0.0 ? -s : s);
    wave[1] = odd !== 0.0 ? (odd > 0.0 ? -s : s) : (two !== 0.0 ? -c : c);
}
