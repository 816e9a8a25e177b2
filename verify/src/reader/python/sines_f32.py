def _sin_cos(xp: Any, angles: tuple[Any, ...]) -> tuple[Any, Any]:
    # Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > 128 are the library's.
    # n is the integer nearest to 2x/pi: + 0.0 makes it no -0.
    # x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have 17 bits. Their products
    # with n are exact, and so is x less the first; e holds the third product less what r rounds away. The polynomials are minimax on
    # |r| <= pi/4 (Remez). h is n/2 rounded to the nearest even integer of the two where n is odd: n - 2h and h modulo 2 say which of the two is
    # the sine, and the signs.
    x = xp.stack(angles)
    n = xp.round(x * 0.63661977) + 0.0
    first = x - n * 1.5707855
    step = n * 1.0804273e-5
    r = first - step
    e = n * 6.0771005e-11 - ((first - r) - step)
    z = r * r
    zz = z * z
    p = 0.008332204 + z * -0.00019520518
    s = r - (e + (z * r) * (0.16666655 - z * p))
    q = (0.041666646 + z * -0.0013887332) + zz * 2.443618e-5
    half = 0.5 * z
    top = 1.0 - half
    c = top + (((1.0 - top) - half) + (zz * q + r * e))
    h = xp.round(n * 0.5) + 0.0
    odd = n - 2.0 * h
    two = h - 2.0 * (xp.round(h * 0.5) + 0.0)
    flip = xp.where(odd != 0.0, odd, 1.0 - (two + two) * two)
    sine = xp.where(odd != 0.0, c, s) * flip
    cosine = xp.where(odd != 0.0, -s, c) * flip
    inside = x * x <= 16384.0
    if xp.__name__ == "numpy" and xp.all(inside):
        return sine, cosine
    return xp.where(inside, sine, xp.sin(x)), xp.where(inside, cosine, xp.cos(x))
