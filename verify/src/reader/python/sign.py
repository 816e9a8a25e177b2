def _sign(xp: Any, x: Any) -> Any:
    # Sign of a rate: 0 at rest, not a number for what is not a number.
    return xp.where(x > 0.0, xp.ones_like(x), xp.where(x < 0.0, -xp.ones_like(x), x))
