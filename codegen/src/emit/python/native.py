

def _processor() -> str:
    # What -march=native depends on.
    known = [platform.system(), platform.machine(), platform.processor()]
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            known += sorted({line for line in file if line.startswith(("model name", "flags", "Features", "isa"))})
    except OSError:
        pass
    return "\n".join(known)


def _cache() -> Path:
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
        return (Path(base) if base else Path.home() / "AppData" / "Local") / "armgen"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "armgen"
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "armgen"


def _compiler(wanted: Optional[str]) -> list[str]:
    # The program and its options. What is a program as it stands has none, though there may be blanks in its path.
    for name in [wanted] if wanted else [os.environ.get("CC"), "cc", "gcc", "clang"]:
        for command in ([name], shlex.split(name)) if name else ():
            found = shutil.which(command[0]) if command else None
            if found:
                return [found, *command[1:]]
    raise RuntimeError(
        f"no C compiler{' ' + repr(wanted) if wanted else ''} was found: install one (Debian: gcc) or name it, load(compiler=...); "
        "the module over arrays, without _native, does without"
    )


def load(compiler: Optional[str] = None, flags: Optional[Sequence[str]] = None, folder: Optional[str] = None) -> Native:
    """Compiles the functions, once, and loads them.

    - `compiler`: a C compiler that takes the options of GCC, perhaps with options of its own behind it, "gcc -m64"; otherwise that of the
      variable CC, or cc, gcc or clang. Flags stand behind its options, and win.
    - `flags`: otherwise -O3 -march=native. What reorders sums or takes other numbers, such as -ffast-math, is refused by the source.
    - `folder`: where the library is kept, under a name that is a hash of source, compiler, flags and processor; otherwise armgen in the user's
      cache folder.

    The result has the functions of the module over arrays, with the same names, shapes and bits. Each takes `threads`: how many share the
    states, at most as many as there are processors, 0 for as many; the bits are the same.
    """
    command = _compiler(compiler)
    own = ["-O3", "-march=native"] if flags is None else list(flags)
    own += ["-std=c99", "-fPIC", "-shared", "-ffp-contract=off", "-fno-tree-slp-vectorize"]
    source = Path(__file__).with_suffix(".c")
    text = source.read_bytes()
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False).stdout
    said = "\0".join([*command, version, *own, _processor()]).encode()
    kept = Path(folder) if folder is not None else _cache()
    library = kept / f"{_NAME}-{hashlib.sha256(text + said).hexdigest()[:32]}.{'dll' if sys.platform == 'win32' else 'so'}"
    if not library.exists():
        kept.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, beside = tempfile.mkstemp(suffix=".new", dir=kept)
        os.close(handle)
        try:
            run = subprocess.run([*command, *own, str(source), "-o", beside, "-lm"], capture_output=True, text=True, check=False)
            if run.returncode != 0:
                raise RuntimeError(f"{' '.join([*command, *own])}: {run.stderr}")
            # Complete or not at all.
            os.replace(beside, library)
        finally:
            if os.path.exists(beside):
                os.unlink(beside)
    return Native(ctypes.CDLL(str(library)))


def _entered(name: str, value: Any, length: int) -> Any:
    if issubclass(type(value), np.ndarray):
        if value.dtype != _DTYPE:
            raise TypeError(f"{name} has entries of {value.dtype}, and {np.dtype(_DTYPE)} is wanted")
    elif hasattr(value, "__array_namespace__") or type(value).__module__.partition(".")[0] == "torch":
        raise TypeError(f"{name} is of {type(value).__module__}, and NumPy is wanted")
    else:
        value = np.asarray(value, dtype=_DTYPE)
    if value.ndim == 0 or value.shape[-1] != length:
        raise ValueError(f"{name} has the shape {value.shape}, and the last axis should have {length} entries")
    return value


# Fewer states take less time than to start a thread.
_SHARE = 2048


class _Function:
    # A function of the library: its arguments with their lengths, and the dimensions of its results.

    def __init__(self, function: Any, arguments: Tuple[Tuple[str, int], ...], results: Tuple[Tuple[int, ...], ...]) -> None:
        self._function, self._arguments, self._results = function, arguments, results
        function.argtypes = [ctypes.c_size_t] + [ctypes.c_void_p] * (len(arguments) + len(results))
        function.restype = None

    def __call__(self, *values: Any, threads: int) -> Any:
        if threads < 0:
            raise ValueError(f"threads: 0 or more, not {threads}")
        arrays = [_entered(name, value, length) for (name, length), value in zip(self._arguments, values)]
        shape = arrays[0].shape[:-1]
        if any(array.shape[:-1] != shape for array in arrays):
            shape = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
            arrays = [np.broadcast_to(array, shape + array.shape[-1:]) for array in arrays]
        arrays = [np.ascontiguousarray(array) for array in arrays]
        results = [np.empty(shape + lengths, dtype=_DTYPE) for lengths in self._results]
        states = math.prod(shape)
        # The address of each array, and the bytes of a state in it.
        places = [(array.ctypes.data, array.itemsize * array.shape[-1]) for array in arrays]
        places += [(result.ctypes.data, result.itemsize * math.prod(lengths)) for result, lengths in zip(results, self._results)]

        def work(start: int, stop: int) -> None:
            # ctypes lets other threads run meanwhile.
            self._function(stop - start, *[address + start * size for address, size in places])

        processors = os.cpu_count() or 1
        shares = max(1, min(threads or processors, processors, states // _SHARE))
        bounds = [states * share // shares for share in range(shares + 1)]
        others = [threading.Thread(target=work, args=bounds[share : share + 2]) for share in range(1, shares)]
        for other in others:
            other.start()
        work(bounds[0], bounds[1])
        for other in others:
            other.join()
        return results
