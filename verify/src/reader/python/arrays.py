_Result = TypeVar("_Result")
_BLOCK = 4096


def _namespace(value: Any) -> Any:
    # The library of an array; lists and numbers become arrays of NumPy, and so do arrays of a NumPy that does not name itself.
    if hasattr(value, "__array_namespace__"):
        return value.__array_namespace__()
    return __import__("torch" if type(value).__module__.partition(".")[0] == "torch" else "numpy")


def _broadcast(shapes: list[tuple[int, ...]]) -> tuple[int, ...]:
    rank = max(len(shape) for shape in shapes)
    columns = zip(*((1,) * (rank - len(shape)) + shape for shape in shapes))
    lengths: list[int] = []
    for column in columns:
        wanted = set(column) - {1}
        if len(wanted) > 1:
            raise ValueError(f"leading axes {shapes} do not go together")
        lengths.append(wanted.pop() if wanted else 1)
    return tuple(lengths)


class _Entries(list[Any]):
    # What stands along the first axis of an array, each with an index for every axis, as the array API wants it.

    def __init__(self, array: Any) -> None:
        super().__init__(array[i, ...] for i in range(array.shape[0]))
        self.array = array


def _another_type(xp: Any, name: str, array: Any) -> TypeError:
    remedy = f"make it with dtype={xp.__name__}.{DTYPE}"
    if DTYPE == "float64" and xp.__name__.startswith("jax") and xp.zeros(1).dtype != xp.float64:
        remedy += " after jax.config.update(\"jax_enable_x64\", True)"
    return TypeError(f"{name} has entries of {array.dtype}, and {DTYPE} is wanted: {remedy}")


def _enter(*arguments: tuple[str, Any, int]) -> tuple[Any, tuple[int, ...], list[_Entries]]:
    # The library, the leading axes of the result, and the entries of each argument.
    xp = _namespace(arguments[0][1])
    shapes: list[tuple[int, ...]] = []
    entries: list[_Entries] = []
    for name, value, length in arguments:
        own = _namespace(value)
        if own is not xp:
            raise TypeError(f"{name} is of {own.__name__}, the arguments before it are of {xp.__name__}: take one library for all")
        wanted = getattr(xp, DTYPE)
        array = value if hasattr(value, "dtype") and hasattr(value, "shape") else xp.asarray(value, dtype=wanted)
        if array.dtype != wanted:
            raise _another_type(xp, name, array)
        shape = tuple(array.shape)
        if not shape or shape[-1] != length:
            raise ValueError(f"{name} has the shape {shape}, and the last axis should have {length} entries")
        shapes.append(shape[:-1])
        # With one axis at least behind the entries: some libraries give numbers without axes another type.
        entries.append(_Entries(xp.moveaxis(array, -1, 0) if shape[:-1] else xp.reshape(array, (length, 1))))
    return xp, _broadcast(shapes), entries


def _leave(xp: Any, like: _Entries, shape: tuple[int, ...], lengths: tuple[int, ...], entries: tuple[Any, ...]) -> Any:
    # Entries, numbers among them, as one array with the leading axes in front.
    own = shape if shape else (1,)
    if not entries:
        return xp.reshape(like.array[:0, ...], shape + lengths)
    arrays = [entry if hasattr(entry, "shape") else xp.full_like(like[0], entry) for entry in entries]
    stacked = xp.stack([xp.broadcast_to(array, own) for array in arrays])
    result = xp.reshape(stacked, lengths + shape)
    return xp.moveaxis(result, tuple(range(len(lengths))), tuple(range(-len(lengths), 0))) if lengths and shape else result


def _at_once(xp: Any, array: Any) -> bool:
    # Whether this processor does an operation when it is called: others record it, or hand it to another device.
    if xp.__name__ != "torch":
        return bool(xp.__name__ == "numpy")
    compiling = getattr(getattr(xp, "compiler", None), "is_compiling", None)
    recorded = xp.jit.is_tracing() or (compiling is not None and compiling())
    return bool(not recorded and type(array) is xp.Tensor and array.device.type == "cpu")


def _many(xp: Any, shape: tuple[int, ...], arguments: tuple[_Entries, ...]) -> bool:
    # Whether there are more states than an operation should pass over. For derivatives torch wants them whole.
    count = 1
    for length in shape:
        count *= length
    recorded = any(getattr(argument.array, "requires_grad", False) for argument in arguments)
    return count > _BLOCK and not recorded and all(_at_once(xp, argument.array) for argument in arguments)


def _in_blocks(xp: Any, shape: tuple[int, ...], function: Callable[..., _Result], arguments: tuple[_Entries, ...]) -> _Result:
    # The function for so many states at a time that what an operation leaves is in the processor's cache for the next.
    def flat(argument: _Entries) -> Any:
        state = xp.moveaxis(argument.array, 0, -1)
        return xp.reshape(xp.broadcast_to(state, shape + state.shape[-1:]), (-1, state.shape[-1]))

    def joined(parts: tuple[Any, ...]) -> Any:
        # The name of the array API, and that of a NumPy before it.
        concat = getattr(xp, "concat", None) or xp.concatenate
        whole = concat([xp.moveaxis(part, 0, -1) for part in parts], -1)
        return xp.reshape(xp.moveaxis(whole, -1, 0), shape + whole.shape[:-1])

    states = [flat(argument) for argument in arguments]
    blocks: list[Any] = [
        function(*(state[start : start + _BLOCK] for state in states)) for start in range(0, len(states[0]), _BLOCK)
    ]
    several = isinstance(blocks[0], tuple)
    result: _Result = type(blocks[0])(*map(joined, zip(*blocks))) if several else joined(tuple(blocks))
    return result
