def _all(xp: Any, truths: Any) -> bool:
    # Whether all are true, where it can be asked: of what is recorded or mapped over there are no values.
    try:
        return bool(_at_once(xp, truths) and xp.all(truths))
    except RuntimeError:
        return False


def _waves(xp: Any, x: Any) -> tuple[Any, Any]:
    # Sines and cosines of angles, rad, each within 1 unit in the last place; those of |x| > 65536 are the library's.
    # n is the integer nearest to 2x/pi: + 0.0 makes it no -0.
    # x = n pi/2 + r - e, after Cody and Waite (1980): pi/2 is a sum of three numbers, of which the first two have 37 bits. Their products
    # with n are exact, and so is x less the first; e holds the third product less what r rounds away. p and q are minimax on
    # |r| <= pi/4 (Remez). b is at first -n modulo 4, from -2 to 2, then minus the sine of n pi/2, of which a is the cosine: the theorems of addition
    # are exact, as a product with 1 and a sum with 0 are, and s is 0 for x = 0 alone.
    n = xp.round(x * 0.6366197723675814) + 0.0
    first = x - n * 1.5707963267923333
    step = n * 2.5633441515839558e-12
    r = first - step
    e = n * 1.0562999066987428e-23 - ((first - r) - step)
    z = r * r
    zz = z * z
    half = 0.5 * z
    top = 1.0 - half
    p = (0.1666666666666663 + z * -0.008333333333322035) + zz * ((0.00019841269829660063 + z * -2.7557313668040543e-6) + zz * (2.5050756282937577e-8 + z * -1.5896732662311403e-10))
    s = r - (e * top + (z * r) * p)
    q = (0.0416666666666666 + z * -0.0013888888888873453) + zz * ((2.4801587287964484e-5 + z * -2.7557313594775254e-7) + zz * (2.087558805713208e-9 + z * -1.1351822784169523e-11))
    c = top + ((((1.0 - top) - half) + r * e) + zz * q)
    b = 4.0 * (xp.round(n * 0.25) + 0.0) - n
    a = 1.0 - xp.abs(b)
    b = b * (1.0 + a)
    sine = s * a - c * b
    cosine = c * a + s * b
    inside = x * x <= 4294967296.0
    if _all(xp, inside):
        return sine, cosine
    return xp.where(inside, sine, xp.sin(x)), xp.where(inside, cosine, xp.cos(x))


def _sin_cos(xp: Any, angles: tuple[Any, ...]) -> tuple[Any, Any]:
    return _of_each(xp, _waves, angles)
