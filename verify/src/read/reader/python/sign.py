def _sign(xp: Any, x: Any) -> Any:
    # Sign of a rate: 0 at rest, not a number for what is not a number.
    if not hasattr(x, "shape"):
        # A number becomes an array: what is computed with it has the type of all else. Without axes torch takes it to any device.
        x = xp.asarray(x if xp.__name__ == "torch" else [x], dtype=getattr(xp, DTYPE))
    return xp.where(x > 0.0, xp.ones_like(x), xp.where(x < 0.0, -xp.ones_like(x), x))
