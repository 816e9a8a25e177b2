def _sign(xp: Any, x: Any) -> Any:
    # @sign@
    # A number becomes an array: what is computed with it has the type of all else.
    x = x if hasattr(x, "shape") else xp.asarray([x], dtype=getattr(xp, DTYPE))
    return xp.where(x > 0.0, xp.ones_like(x), xp.where(x < 0.0, -xp.ones_like(x), x))
