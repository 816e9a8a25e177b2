def _waves(xp: Any, x: Any) -> tuple[Any, Any]:
    return xp.sin(x), xp.cos(x)


def _sin_cos(xp: Any, angles: tuple[Any, ...]) -> tuple[Any, Any]:
    return _of_each(xp, _waves, angles)
