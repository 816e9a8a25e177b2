def _sin_cos(xp: Any, angles: tuple[Any, ...]) -> tuple[_Entries, _Entries]:
    x = xp.stack(angles)
    return _Entries(xp.sin(x)), _Entries(xp.cos(x))
