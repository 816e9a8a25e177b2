/** Sine and cosine of the angle that was asked for last. */
const wave = new Float64Array(2);

/** Puts sine and cosine of an angle, rad, into `wave`. */
function sinCos(x) {
    wave[0] = Math.sin(x);
    wave[1] = Math.cos(x);
}
