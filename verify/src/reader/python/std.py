def _sin_cos(xp: Any, angles: tuple[Any, ...]) -> tuple[Any, Any]:
    x = xp.stack(angles)
    return xp.sin(x), xp.cos(x)
