def _all(xp: Any, truths: Any) -> bool:
    # Whether all are true, where it can be asked: of what is recorded or mapped over there are no values.
    try:
        return bool(_at_once(xp, truths) and xp.all(truths))
    except RuntimeError:
        return False


def _waves(xp: Any, x: Any) -> tuple[Any, Any]:
    # Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > @limit@ are the library's.
    # @sines_of_arrays@
    n = xp.round(x * @two_over_pi@) + 0.0
    first = x - n * @first@
    step = n * @second@
    r = first - step
    e = n * @third@ - ((first - r) - step)
    z = r * r
    zz = z * z
    half = 0.5 * z
    top = 1.0 - half
    p = @sine@
    s = r - (e * top + (z * r) * p)
    q = @cosine@
    c = top + ((((1.0 - top) - half) + r * e) + zz * q)
    b = 4.0 * (xp.round(n * 0.25) + 0.0) - n
    a = 1.0 - xp.abs(b)
    b = b * (1.0 + a)
    sine = s * a - c * b
    cosine = c * a + s * b
    inside = x * x <= @square@
    if _all(xp, inside):
        return sine, cosine
    return xp.where(inside, sine, xp.sin(x)), xp.where(inside, cosine, xp.cos(x))


def _sin_cos(xp: Any, angles: tuple[Any, ...]) -> tuple[Any, Any]:
    return _of_each(xp, _waves, angles)
