def _sign(xp: Any, x: Any) -> Any:
    # @sign@
    return xp.where(x > 0.0, xp.ones_like(x), xp.where(x < 0.0, -xp.ones_like(x), x))
