_Result = TypeVar("_Result")
_BLOCK = 4096


def _namespace(value: Any) -> Any:
    # The library of an array; lists and numbers become arrays of NumPy, and so do arrays of a NumPy that does not name itself.
    if hasattr(value, "__array_namespace__"):
        return value.__array_namespace__()
    # torch.compile follows these imports, but no call of `__import__`.
    if type(value).__module__.partition(".")[0] == "torch":
        import torch

        return torch
    import numpy

    return numpy


def _broadcast(shapes: list[tuple[int, ...]]) -> tuple[int, ...]:
    # Lengths are compared and no more, so that a compiler can leave them open.
    result: list[int] = []
    for axis in range(-max(len(shape) for shape in shapes), 0):
        wanted = 1
        for shape in shapes:
            length = shape[axis] if -axis <= len(shape) else 1
            if length == 1:
                continue
            if wanted != 1 and wanted != length:
                raise ValueError(f"leading axes {shapes} do not go together")
            wanted = length
        result.append(wanted)
    return tuple(result)


class _Entries(list[Any]):
    # What stands along the first axis of an array, each with an index for every axis, as the array API wants it.

    def __init__(self, array: Any) -> None:
        super().__init__(array[i, ...] for i in range(array.shape[0]))
        self.array = array


class _ByJoint(list[Any]):
    # The entries of an argument, given one by one.

    def __init__(self, entries: Any) -> None:
        super().__init__(entries)
        self.array = None


def by_joint(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function with an array of all states for each entry, as compilers for GPUs like it.

    - An argument is a sequence of arrays, or an array with the entries along its first axis.
    - A result is a tuple of arrays; a matrix is a tuple of rows.
    """

    def of_joints(*arguments: Any) -> Any:
        return function(*[_ByJoint(_Entries(value) if hasattr(value, "shape") else value) for value in arguments])

    return of_joints


def _another_type(xp: Any, name: str, array: Any) -> TypeError:
    remedy = f"make it with dtype={xp.__name__}.{DTYPE}"
    if DTYPE == "float64" and xp.__name__.startswith("jax") and xp.zeros(1).dtype != xp.float64:
        remedy += " after jax.config.update(\"jax_enable_x64\", True)"
    return TypeError(f"{name} has entries of {array.dtype}, and {DTYPE} is wanted: {remedy}")


def _entered(xp: Any, name: str, value: Any) -> Any:
    own = _namespace(value)
    if own is not xp:
        raise TypeError(f"{name} is of {own.__name__}, the arguments before it are of {xp.__name__}: take one library for all")
    wanted = getattr(xp, DTYPE)
    array = value if hasattr(value, "dtype") and hasattr(value, "shape") else xp.asarray(value, dtype=wanted)
    if array.dtype != wanted:
        raise _another_type(xp, name, array)
    return array


def _enter(*arguments: tuple[str, Any, int]) -> tuple[Any, tuple[int, ...], list[Any]]:
    # The library, the leading axes of the result, and the entries of each argument.
    given = [[*value] if isinstance(value, _ByJoint) else [value] for _, value, _ in arguments]
    xp = _namespace(given[0][0] if given[0] else None)
    shapes: list[tuple[int, ...]] = []
    entries: list[Any] = []
    for (name, value, length), parts in zip(arguments, given):
        arrays = [_entered(xp, name, part) for part in parts]
        if isinstance(value, _ByJoint):
            if len(arrays) != length:
                raise ValueError(f"{name} has {len(arrays)} entries, and {length} are wanted")
            shape = _broadcast([tuple(array.shape) for array in arrays]) if arrays else ()
            shapes.append(shape)
            entries.append(_ByJoint([xp.broadcast_to(array, shape if shape else (1,)) for array in arrays]))
            continue
        array = arrays[0]
        shape = tuple(array.shape)
        if not shape or shape[-1] != length:
            raise ValueError(f"{name} has the shape {shape}, and the last axis should have {length} entries")
        shapes.append(shape[:-1])
        # With one axis at least behind the entries: some libraries give numbers without axes another type.
        entries.append(_Entries(xp.moveaxis(array, -1, 0) if shape[:-1] else xp.reshape(array, (length, 1))))
    return xp, _broadcast(shapes), entries


def _rows(lengths: tuple[int, ...], entries: list[Any]) -> Any:
    # Entries as a tuple of rows.
    if not lengths:
        return entries[0]
    size = len(entries) // lengths[0] if entries else 0
    return tuple(_rows(lengths[1:], entries[i * size : (i + 1) * size]) for i in range(lengths[0]))


def _leave(xp: Any, like: Any, shape: tuple[int, ...], lengths: tuple[int, ...], entries: tuple[Any, ...]) -> Any:
    # Entries, numbers among them, as one array with the leading axes in front.
    own = shape if shape else (1,)
    arrays = [entry if hasattr(entry, "shape") else xp.full_like(like[0], entry) for entry in entries]
    arrays = [xp.broadcast_to(array, own) for array in arrays]
    if isinstance(like, _ByJoint):
        return _rows(lengths, [xp.reshape(array, shape) for array in arrays])
    if not arrays:
        return xp.reshape(like.array[:0, ...], shape + lengths)
    if xp.__name__ == "jax.numpy":
        import jax

        # XLA would fuse the stack with all before it, and compute that for each entry again.
        arrays = jax.lax.optimization_barrier(arrays)
    result = xp.reshape(xp.stack(arrays), lengths + shape)
    return xp.moveaxis(result, tuple(range(len(lengths))), tuple(range(-len(lengths), 0))) if lengths and shape else result


def _compiled(xp: Any) -> bool:
    # Whether a compiler makes kernels of operations.
    compiling = getattr(getattr(xp, "compiler", None), "is_compiling", None)
    return bool(xp.__name__.startswith("jax") or (compiling is not None and compiling()))


def _of_each(xp: Any, function: Callable[[Any, Any], tuple[Any, Any]], angles: tuple[Any, ...]) -> tuple[Any, Any]:
    # Two values of each angle. One operation for all angles is cheaper, but a compiler would keep its result in memory.
    if not _compiled(xp):
        first, second = function(xp, xp.stack(angles))
        return _Entries(first), _Entries(second)
    pairs = [function(xp, angle) for angle in angles]
    return [pair[0] for pair in pairs], [pair[1] for pair in pairs]


def _at_once(xp: Any, array: Any) -> bool:
    # Whether this processor does an operation when it is called: others record it, or hand it to another device.
    if xp.__name__ != "torch":
        return bool(xp.__name__ == "numpy")
    recorded = _compiled(xp) or xp.jit.is_tracing()
    return bool(not recorded and type(array) is xp.Tensor and array.device.type == "cpu")


def _many(xp: Any, shape: tuple[int, ...], arguments: tuple[Any, ...]) -> bool:
    # Whether there are more states than an operation should pass over. For derivatives torch wants them whole.
    if _compiled(xp) or any(argument.array is None for argument in arguments):
        return False
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
