/** Sine and cosine of the angle that was asked for last. */
const wave = new Float64Array(2);

/**
 * Puts sine and cosine of an angle, rad, into `wave`, each within 1 unit in the last place; those of |x| > @limit@ are the ones of `Math`.
 *
 * @sines@
 */
function sinCos(x) {
    if (!(x >= -@limit@.0 && x <= @limit@.0)) {
        wave[0] = Math.sin(x);
        wave[1] = Math.cos(x);
        return;
    }
    const n = (x * @two_over_pi@ + @round@) - @round@;
    const first = x - n * @first@;
    const step = n * @second@;
    const r = first - step;
    const e = n * @third@ - ((first - r) - step);
    const z = r * r;
    const zz = z * z;
    const half = 0.5 * z;
    const top = 1.0 - half;
    const p = @sine@;
    const s = r - (e * top + (z * r) * p);
    const q = @cosine@;
    const c = top + ((((1.0 - top) - half) + r * e) + zz * q);
    const h = (n * 0.5 + @round@) - @round@;
    const odd = n - 2.0 * h;
    const two = h - 2.0 * ((h * 0.5 + @round@) - @round@);
    wave[0] = odd !== 0.0 ? (odd > 0.0 ? c : -c) : (two !== 0.0 ? -s : s);
    wave[1] = odd !== 0.0 ? (odd > 0.0 ? -s : s) : (two !== 0.0 ? -c : c);
}
