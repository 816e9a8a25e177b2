def _sin_cos(xp: Any, angles: tuple[Any, ...]) -> tuple[Any, Any]:
    # Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > @limit@ are the library's.
    # @sines@
    x = xp.stack(angles)
    n = xp.round(x * @two_over_pi@) + 0.0
    first = x - n * @first@
    step = n * @second@
    r = first - step
    e = n * @third@ - ((first - r) - step)
    z = r * r
    zz = z * z
    p = @sine@
    s = r - (e + (z * r) * (@sixth@ - z * p))
    q = @cosine@
    half = 0.5 * z
    top = 1.0 - half
    c = top + (((1.0 - top) - half) + (zz * q + r * e))
    h = xp.round(n * 0.5) + 0.0
    odd = n - 2.0 * h
    two = h - 2.0 * (xp.round(h * 0.5) + 0.0)
    flip = xp.where(odd != 0.0, odd, 1.0 - (two + two) * two)
    sine = xp.where(odd != 0.0, c, s) * flip
    cosine = xp.where(odd != 0.0, -s, c) * flip
    inside = x * x <= @square@
    if xp.__name__ == "numpy" and xp.all(inside):
        return sine, cosine
    return xp.where(inside, sine, xp.sin(x)), xp.where(inside, cosine, xp.cos(x))
