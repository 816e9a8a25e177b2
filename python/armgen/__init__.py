"""A robot arm's exact equations of motion, from its description, URDF or MuJoCo model, as functions over arrays of NumPy.

    robot = armgen.load("robot.yaml")
    robot.inverse_dynamics(q, dq, ddq)

`robot.functions` has the names of all functions; the documentation of each is its `__doc__`.
"""

from __future__ import annotations

import os
import re as _re
import warnings as _warnings
from collections import namedtuple as _namedtuple
from typing import Any, Iterable, Mapping, NamedTuple

import numpy as _numpy

from . import _native

__version__ = _native.VERSION

# The longest file that is read, in bytes.
_LONGEST = 32 << 20

# Beside angles nearer than so much (rad) a multiple of pi/12 is meant.
_SNAP = 2e-5


class Label(NamedTuple):
    """A place in a text and what is there. Lines and columns count from 1, columns in characters."""

    text: str
    line: int
    column: int
    end_line: int
    end_column: int


class Diagnostic(NamedTuple):
    """A fault or a doubt of a text: its code, `"error"` or `"warning"`, what is wrong, what to do, and where it is."""

    code: str
    severity: str
    message: str
    help: str
    line: int
    column: int
    end_line: int
    end_column: int
    labels: tuple[Label, ...]
    file: str


class DescriptionError(ValueError):
    """A text that is no arm. `diagnostics` has all that is wrong with it, `source` the text that their places are of."""

    def __init__(self, text: str, diagnostics: tuple[Diagnostic, ...] = (), source: str = "") -> None:
        super().__init__(text)
        self.diagnostics = diagnostics
        self.source = source

    def __str__(self) -> str:
        return "\n" + str(self.args[0])

    def __reduce__(self) -> Any:
        return DescriptionError, (self.args[0], self.diagnostics, self.source)


class DescriptionWarning(UserWarning):
    """A doubt about a description, such as limits in degrees. `warnings` of the robot has all of them."""


class InternalError(RuntimeError):
    """A fault of armgen itself, not of its input."""

    def __init__(self, said: str) -> None:
        super().__init__(said)

    def __str__(self) -> str:
        return (
            f"a fault of armgen {__version__}, not of its input: {self.args[0]}; "
            "please report it with the description and the call"
        )


class VerificationError(RuntimeError):
    """What the checker has looked at is not the equations: the first wrong entry, and how it is wrong."""


def _structures_of_catalogue() -> dict[str, Any]:
    structures = {}
    for name, _, _, parts, _ in _native.catalogue_of_functions():
        plain = name.removesuffix("_with")
        if len(parts) > 1 and plain not in structures:
            words = plain.split("_")
            made = _namedtuple("".join(map(str.capitalize, words)), parts, module=__name__)  # type: ignore[misc]
            made.__doc__ = f"Results of `{plain}`."
            structures[plain] = made
    return structures


# The types of several results, as the emitted module in Python has them.
_structures = _structures_of_catalogue()
globals().update({_made.__name__: _made for _made in _structures.values()})

Function = _native.Function
Postures = _native.Postures


def load(
    path: str | os.PathLike[str],
    *,
    base: str | None = None,
    tip: str | Iterable[str] | Mapping[str, str] | None = None,
    all: bool = False,
    lock: Mapping[str, str | int | float] | None = None,
    name: str | None = None,
    snap: float | None = None,
    massless: bool = False,
    inertia_as_written: bool = False,
    strict: bool = False,
    allow: Iterable[str] = (),
    arguments: Mapping[str, str] | None = None,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
) -> Robot:
    """The arm of a file: a description (robot.yaml), a URDF, a MuJoCo model, or a file of xacro.

    base, tip, all, lock, name, snap, massless, inertia_as_written: options of the import of a URDF or a MuJoCo model, as `armgen import`
    has them. tip: the link of the end effector; of several end effectors their links, or a mapping of their names to links. lock: a
    mapping of joints to positions, such as `{"gripper": 0}`. strict: warnings are faults. allow: kinds of warnings that are not given.
    arguments, packages: of xacro, the values of its arguments and the folders of its packages.

    Issues a DescriptionWarning for each kind of doubt. Raises DescriptionError with all that is wrong with the file, OSError if it
    cannot be read.
    """
    path = os.fspath(path)
    if path.endswith(".xacro"):
        text = _written_out(path, arguments, packages)
    else:
        if arguments is not None or packages is not None:
            raise TypeError("arguments and packages are options of a file of xacro")
        with open(path, "rb") as file:
            data = file.read(_LONGEST + 1)
        text = _decoded(path, data)
    asked = _asked(base, tip, all, lock, name, snap, massless, inertia_as_written, strict, allow)
    return _warned(_read(path, text, os.path.dirname(path), asked))


def loads(
    text: str,
    name: str = "robot.yaml",
    *,
    base: str | None = None,
    tip: str | Iterable[str] | Mapping[str, str] | None = None,
    all: bool = False,
    lock: Mapping[str, str | int | float] | None = None,
    snap: float | None = None,
    massless: bool = False,
    inertia_as_written: bool = False,
    strict: bool = False,
    allow: Iterable[str] = (),
) -> Robot:
    """The arm of a text, which diagnostics call `name`; else as `load`."""
    if not isinstance(text, str):
        raise TypeError(f"a text, not {type(text).__name__}")
    return _warned(_read(name, text, None, _asked(base, tip, all, lock, None, snap, massless, inertia_as_written, strict, allow)))


def _warned(robot: Robot) -> Robot:
    """Issues the warnings of an arm that `load` or `loads` returns: one for each kind, at the line of the caller."""
    kinds: dict[str, list[Diagnostic]] = {}
    for found in robot.warnings:
        kinds.setdefault(found.code, []).append(found)
    for code, all_of_kind in kinds.items():
        first, more = all_of_kind[0], len(all_of_kind) - 1
        # An import writes no file: its description is a text.
        is_made = robot.report is not None and first.file != robot._state[0]
        place = f"line {first.line} of robot.text" if is_made else f"{first.file}:{first.line}:{first.column}"
        rest = f" ({more} more like this in robot.warnings)" if more else ""
        _warnings.warn(f"{place}: {code}: {first.message}; {first.help}{rest}", DescriptionWarning, stacklevel=3)
    return robot


def _decoded(name: str, data: bytes) -> str:
    fault = None
    if len(data) > _LONGEST:
        fault, message, help = "too-long", f"the file is longer than {_LONGEST >> 20} MiB", "no description is; load another file"
        line = 1
    else:
        try:
            return data.decode("utf-8")
        except UnicodeDecodeError as error:
            fault, help = "not-utf-8", "save it as UTF-8"
            line = data[: error.start].count(b"\n") + 1
            message = f"line {line} holds a byte that belongs to no character of UTF-8"
    label = Label("", line, 1, line, 1)
    found = Diagnostic(fault, "error", message, help, line, 1, line, 1, (label,), name)
    text = f"error[{fault}]: {message}\n  --> {name}:{line}:1\n   = help: {help}"
    raise DescriptionError(text, (found,), "")


def _written_out(path: str, arguments: Mapping[str, str] | None, packages: Mapping[str, Any] | None) -> str:
    try:
        from xacrodoc import XacroDoc, packages as known
    except ImportError:
        raise ImportError("a file of xacro needs xacrodoc: pip install armgen[xacro]") from None
    open(path, "rb").close()
    if packages:
        known.update_package_cache({name: os.fspath(folder) for name, folder in packages.items()})
    return XacroDoc.from_file(path, subargs=dict(arguments or {}), resolve_packages=False).to_urdf_string()


# The options of an import, and the values that leave them to it.
_IMPORT = {"base": None, "tip": None, "tips": [], "all": False, "lock": [], "name": None, "snap": _SNAP, "massless": False, "inertia_as_written": False}


def _asked(
    base: str | None,
    tip: str | Iterable[str] | Mapping[str, str] | None,
    all: bool,
    lock: Mapping[str, str | int | float] | None,
    name: str | None,
    snap: float | None,
    massless: bool,
    inertia_as_written: bool,
    strict: bool,
    allow: Iterable[str],
) -> dict[str, Any]:
    if isinstance(allow, str):
        raise TypeError("allow: kinds of warnings, not a single text")
    for option, value in (("base", base), ("name", name)):
        if value is not None and not isinstance(value, str):
            raise TypeError(f"{option}: a text, not {type(value).__name__}")
    only, tips = _tips(tip)
    if all and (only or tips):
        raise TypeError("all takes every end effector: give it without tip")
    if lock is not None and not isinstance(lock, Mapping):
        raise TypeError(f'lock: a mapping of joints to positions, such as {{"gripper": 0}}, not {type(lock).__name__}')
    snap = _SNAP if snap is None else float(snap)
    if not 0 <= snap <= 1e-2:
        raise ValueError(f"snap: from 0 to 0.01 rad, not {snap}")
    locked = []
    for joint, value in (lock or {}).items():
        if isinstance(value, bool) or not isinstance(value, (str, int, float)):
            raise TypeError(f"lock: {joint} is at a text, an int or a float, not {type(value).__name__}")
        locked.append((joint, value if isinstance(value, str) else repr(value)))
    return {
        "base": base,
        "tip": only,
        "tips": tips,
        "all": bool(all),
        "lock": locked,
        "name": name,
        "snap": snap,
        "massless": bool(massless),
        "inertia_as_written": bool(inertia_as_written),
        "strict": bool(strict),
        "allow": list(allow),
    }


def _tips(tip: Any) -> tuple[str | None, list[tuple[str | None, str]]]:
    """The link of the only end effector, or the links of several with their names."""
    if tip is None or isinstance(tip, str):
        return tip, []
    try:
        pairs = list(tip.items()) if isinstance(tip, Mapping) else [(None, link) for link in tip]
    except TypeError:
        pairs = [(None, None)]
    if not pairs or not all(isinstance(link, str) and isinstance(name, str | None) for name, link in pairs):
        raise TypeError('tip: a link, a list of links, or a mapping of names to links, such as {"left": "left_hand"}')
    return (pairs[0][1], []) if len(pairs) == 1 and pairs[0][0] is None else (None, pairs)


def _in_python(text: str) -> str:
    """A message with the options of the command as arguments: `tip="tool0"` instead of `--tip tool0`."""

    def option(found: Any) -> str:
        name, first, second = found.groups()
        name = name.replace("-", "_")
        if name in ("all", "massless", "inertia_as_written"):
            return f"{name}=True"
        if first is None or name == "snap":
            return name if first is None else f"{name}={first}"
        if name != "lock":
            return f'{name}="{first}"'
        if second is None:
            return f'lock["{first}"]'
        is_plain = second == "VALUE" or _re.fullmatch(r"[-+.\de]+", second)
        return f'lock={{"{first}": {second if is_plain else _quoted(second)}}}'

    def span(found: Any) -> str:
        options = found[1].replace(" --", ", --")
        return "`" + _re.sub(r"--(base|tip|all|lock|snap|massless|inertia-as-written)\b(?: ([^\s=,]+)(?:=([^\s,]+))?)?", option, options) + "`"

    return _re.sub(r"`(--[^`]+)`", span, text)


def _quoted(text: str) -> str:
    return f'"{text}"'


def _diagnostics_in_python(found: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    return tuple(one._replace(message=_in_python(one.message), help=_in_python(one.help)) for one in found)


def _read(name: str, text: str, folder: str | None, asked: dict[str, Any]) -> Robot:
    if not text.removeprefix("\ufeff").lstrip().startswith("<"):
        given = [option for option, value in _IMPORT.items() if asked[option] != value]
        if given:
            raise TypeError(f"{given[0].replace('tips', 'tip')} is an option of the import of a URDF or a MuJoCo model; {name} is a description")
    stem = os.path.basename(name)
    for ending in (".xacro", ".urdf", ".xml", ".mjcf"):
        stem = stem.removesuffix(ending)
    made = stem if stem.endswith(".yaml") else stem + ".yaml"
    try:
        arm, source, warnings, shown, report, notes = _native.read(name, text, folder, made, asked)
    except DescriptionError as error:
        raise DescriptionError(_in_python(error.args[0]), _diagnostics_in_python(error.diagnostics), error.source) from None
    robot = object.__new__(Robot)
    state = (name, source, tuple(sorted((key, _frozen(value)) for key, value in asked.items())))
    robot._begin(arm, state, report, _in_python(shown))
    robot.__dict__["warnings"] = _diagnostics_in_python(warnings)
    robot.__dict__["notes"] = tuple(map(_in_python, notes))
    return robot


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _restored(name: str, text: str, asked: tuple[tuple[str, Any], ...]) -> Robot:
    return _read(name, text, None, {key: list(value) if isinstance(value, tuple) else value for key, value in asked})


def _function_of(state: tuple[str, str, Any], name: str) -> Any:
    return getattr(_restored(*state), name)


def _postures_of(arm: Any, tip: str) -> Any:
    """`inverse_kinematics` of a named end effector."""

    def inverse_kinematics(pose: Any = None, redundancy: Any = None, *, position: Any = None, rotation: Any = None, threads: int = 1) -> Any:
        return arm.inverse_kinematics(pose, redundancy, position, rotation, threads, tip)

    inverse_kinematics.__doc__ = f"All postures at a pose of `{tip}`; see `Robot.inverse_kinematics`."
    return inverse_kinematics


class Robot:
    """A valid arm. Its functions are attributes: `robot.gravity(q)`; `robot.functions` has their names.

    It does not change, may be shared by threads, and pickles as its text and options. Made by `load` and `loads`.
    """

    def __init__(self) -> None:
        raise TypeError("a robot is made by armgen.load or armgen.loads")

    def _begin(self, arm: Any, state: Any, report: str | None, shown: str) -> None:
        own = self.__dict__
        facts = arm.facts
        own["_arm"], own["_state"], own["_report"], own["_shown"], own["_mass"] = arm, state, report, shown, facts.pop("mass")
        limits = [f"{kind}_limits" for kind in ("position", "velocity", "effort", "acceleration", "jerk")]
        for key in ("revolute", *limits, "gravity_vector"):
            facts[key] = _constant(facts[key])
        own.update(facts)
        functions = {function.__name__: function for function in arm.functions(state)}
        own.update(functions)
        own["functions"] = tuple(functions)
        for tip, prefix, coordinates in arm.tips:
            own[prefix + "coordinates"] = tuple(coordinates)
            own[prefix + "inverse_kinematics"] = _postures_of(arm, tip)
            own[prefix + "inverse_kinematics_redundancy"] = lambda q, tip=tip: arm.inverse_kinematics_redundancy(q, tip)

    @property
    def text(self) -> str:
        """The text of the description; of an import that of the description that it made."""
        return self._arm.text

    @property
    def report(self) -> dict[str, Any] | None:
        """What an import has taken, changed and left out; None for a description."""
        if self._report is None:
            return None
        import json

        return json.loads(self._report)

    @property
    def absent(self) -> dict[str, str]:
        """The functions that this arm does not have, and why."""
        return dict(self._arm.absent)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """The parameters of functions whose names end in `_with`, and the columns of regressors."""
        return tuple(self._arm.parameters[0])

    @property
    def nominal_parameters(self) -> Any:
        """Their values in the description."""
        return _constant(self._arm.parameters[1])

    def payload_parameters(self, mass: Any, com: Any, inertia: Any = None) -> Any:
        """The ten parameters of a body in the hand, for the entries whose names end in `p`:

        m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz, about the origin of the end-effector frame, which includes the tool.

        mass: kg. com: its centre of mass in that frame, m. inertia: 3 x 3 tensor about the centre of mass along the axes of that frame,
        kg m²; Ixy is -∫xy dm; 0 if left out, as of a point. By Steiner its part is inertia + m (com' com 1 - com com').

        Raises ValueError if the description has no payload: `payload: {}` adds one of 0 kg.
        """
        import numpy as np

        if not any(name.endswith("Izzp") for name in self.parameter_names):
            raise ValueError("this arm has no payload: `payload: {}` in the description adds one of 0 kg, with its ten parameters")
        m, (x, y, z) = float(mass), np.asarray(com, float)
        i = np.zeros((3, 3)) if inertia is None else np.asarray(inertia, float)
        if i.shape != (3, 3):
            raise ValueError(f"inertia: 3 x 3 numbers, not {' x '.join(map(str, i.shape))}")
        xx, xy, yy = i[0, 0] + m * (y * y + z * z), i[0, 1] - m * (x * y), i[1, 1] + m * (x * x + z * z)
        xz, yz, zz = i[0, 2] - m * (x * z), i[1, 2] - m * (y * z), i[2, 2] + m * (x * x + y * y)
        return np.array([m, m * x, m * y, m * z, xx, xy, yy, xz, yz, zz])

    @property
    def base_parameter_names(self) -> tuple[str, ...]:
        """The base parameters."""
        return tuple(self._arm.base_parameters[0])

    @property
    def nominal_base_parameters(self) -> Any:
        """Their values in the description."""
        return _constant(self._arm.base_parameters[1])

    def inverse_kinematics(
        self,
        pose: Any = None,
        redundancy: Any = None,
        *,
        position: Any = None,
        rotation: Any = None,
        threads: int = 1,
    ) -> Any:
        """All postures at a pose: `Postures`, whose `q` has the joint variables as rows. Of arrays of poses, a list.

        pose: T = (R p; 0 1) of the end effector in the base frame, 4 x 4, m. position, rotation: p and R, instead of it; p alone where
        the arm's target is a position. redundancy: what `redundancy` names. Leading axes are poses, and broadcast. threads: how many
        share the poses; 0 is as many as there are processors.

        A robot whose end effectors have names has a function of each, with the same arguments: of `left` `left_inverse_kinematics` and
        `left_inverse_kinematics_redundancy`. Entry k of its postures belongs to entry `left_coordinates[k]` of q.

        Raises ValueError if the arm has no inverse kinematics, and says why.
        """
        return self._arm.inverse_kinematics(pose, redundancy, position, rotation, threads, None)

    @property
    def redundancy(self) -> str | None:
        """What `inverse_kinematics` is given beside a pose, where the arm has one joint more than the target asks for: the name of a joint
        (its value, rad or m) or `"swivel"` (the angle of the elbow about the line from shoulder to wrist, rad). Else None.
        """
        return self._arm.redundancy(None)

    def inverse_kinematics_redundancy(self, q: Any) -> Any:
        """The redundancy with which `inverse_kinematics` finds the posture q again: a float; of an array of postures, an array."""
        return self._arm.inverse_kinematics_redundancy(q, None)

    def prepare(self, *names: str) -> None:
        """Derives functions now, on all processors, instead of at their first calls; all that the arm has if none is named."""
        self._arm.prepare(list(names))

    def check(self, *, full: bool = False) -> str:
        """The summary of `armgen check`, then what an import has changed, then all warnings. full: with limits, drives and more."""
        import textwrap

        text = self._arm.check(list(dict(self._state[2])["allow"]), full)
        if self.notes:
            notes = (textwrap.fill(note, 98, initial_indent="  - ", subsequent_indent="    ") for note in self.notes)
            text += f"\nThe import of {self._state[0]} made this description, `text`:\n" + "".join(f"{note}\n" for note in notes)
        return text + "\n" * bool(self._shown) + self._shown

    def show(self, quantity: str, *, symbolic: bool = False, form: str | None = None, digits: int | None = None) -> str:
        """A quantity as `armgen show` prints it.

        symbolic: with the names under `parameters` of the description instead of their values. form: `"shortest"`, `"closed"` or `"steps"`; closed for arms of up
        to four joints, else shortest, if not given. digits: constants as decimals of so many digits instead of exactly.
        """
        return self._arm.shown(quantity, symbolic, form, digits, "text")

    def latex(self, quantity: str, *, symbolic: bool = False, form: str | None = "shortest", digits: int | None = None) -> str:
        """The same for a document with amsmath."""
        return self._arm.shown(quantity, symbolic, form, digits, "latex")

    def sympy(self, quantity: str, *, symbolic: bool = False) -> Any:
        """A quantity as a `sympy.Matrix` of exact entries in the symbols q1, dq1, ... Of a list of matrices, a list.

        symbolic: with the names under `parameters` of the description instead of their values. Symbols have no assumptions, so
        `subs("q1", 0)` finds them.

        Needs sympy (`pip install armgen[sympy]`).
        """
        try:
            import sympy
        except ImportError:
            raise ImportError("this needs sympy: pip install armgen[sympy]") from None
        import json

        shown = json.loads(self._arm.shown(quantity, symbolic, None, None, "json"))["quantities"]
        matrices = [_matrix(sympy, one) for one in shown]
        return matrices[0] if len(matrices) == 1 else matrices

    def page(self, path: str | os.PathLike[str] | None = None) -> str | None:
        """The page of the arm, one HTML file: its text, or None if it is written to a path."""
        page = self._arm.page()
        if path is None:
            return page
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(page)
        return None

    def _repr_html_(self) -> str:
        import html

        page = html.escape(self._arm.page(), quote=True)
        return (
            f'<iframe sandbox="allow-scripts" title="{html.escape(self.name)}" srcdoc="{page}" '
            'style="box-sizing: border-box; width: 100%; height: 640px; border: 1px solid #ccc"></iframe>'
        )

    def generate(
        self,
        language: str,
        *,
        name: str | None = None,
        scalar: str = "f64",
        trig: str | None = None,
        functions: Iterable[str] | None = None,
        without: Iterable[str] = (),
        batch: int | None = None,
        fma: bool = False,
        verify: bool = False,
        tests: bool = False,
        bounds: bool = False,
        runtime: bool = False,
        c_abi: bool = False,
        native: bool = False,
        ik: bool = False,
    ) -> dict[str, str]:
        """The module in a language, and what is asked for beside it: a text for each name of a file.

        name: that of the module's file without its ending; the robot's if not given. All others are the options of `armgen generate`.
        """
        if language not in _LANGUAGES:
            known = ", ".join(map(_quoted, _LANGUAGES))
            raise ValueError(f'language: one of {known}, not "{language}"; the header of "c" is C++, too')
        for option, names in (("functions", functions), ("without", without)):
            if isinstance(names, str):
                raise TypeError(f"{option}: several texts, not a single one")
        endings = {"rust": ".rs", "c": ".h", "javascript": ".mjs", "python": ".py"}
        stem = self.name if name is None else name
        out = f"+{stem}" if language == "matlab" else stem + endings.get(language, "")
        options = ["--language", language, "--scalar", scalar, f"--out={out}"]
        options += ["--trig", trig] if trig is not None else []
        options += [f"--functions={','.join(functions)}"] if functions is not None else []
        options += [f"--without={','.join(without)}"] if without else []
        options += [f"--batch={batch}"] if batch is not None else []
        flags = {
            "--fma": fma,
            "--verify": verify,
            "--tests": tests,
            "--bounds": bounds,
            "--runtime": runtime,
            "--c-abi": c_abi,
            "--native": native,
            "--ik": ik,
        }
        return self._arm.generate(options + [flag for flag, wanted in flags.items() if wanted])

    def verify(self, text: str | None = None, language: str = "rust") -> dict[str, dict[str, Any]]:
        """Verifies the functions as they are executed here; of a text, the emitted module in a language, as `armgen verify` does.

        The checker derives the equations in another way and compares in exact arithmetic, at random points. For each function it returns
        the numbers of `points` in prime fields and of `rational` points, and `log2_odds`, those that a wrong function passes.

        Raises VerificationError with the first wrong entry. Takes seconds, of long arms minutes.
        """
        if text is None:
            self.prepare()
        fault, functions = self._arm.verified(text, language)
        if fault is not None:
            is_other = text is not None and language == "rust" and "pub fn " not in text
            raise VerificationError(fault + '; the text was read as Rust: name its language, as in verify(text, "python")' * is_other)
        return {name: {"points": points, "rational": rational, "log2_odds": odds} for name, points, rational, odds in functions}

    def __getattr__(self, name: str) -> Any:
        own = self.__dict__.get("name")
        if own is None or name.startswith("__"):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        absent = self.absent
        if name in absent:
            reason = f": {absent[name]}"
        else:
            words = [*absent, *(word for word in dir(self) if not word.startswith("_"))]
            meant = _native.meant(name, words)
            reason = f"; here it is `{meant}`" if meant else "; `functions` has the names of its functions"
        raise AttributeError(f"{own} has no `{name}`{reason}", name=name, obj=self)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("a robot does not change")

    def __delattr__(self, name: str) -> None:
        raise AttributeError("a robot does not change")

    def __reduce__(self) -> Any:
        return _restored, self._state

    def __copy__(self) -> Robot:
        return self

    def __deepcopy__(self, memo: Any) -> Robot:
        return self

    def __eq__(self, other: object) -> bool:
        return self._state == other._state if isinstance(other, Robot) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._state)

    def __repr__(self) -> str:
        joints = f"{self.dof} joint" + ("s" if self.dof > 1 else "")
        return f"<armgen.Robot {self.name}: {joints}, {self._mass:.1f} kg>"


def _constant(values: Any) -> Any:
    """An array that cannot be written."""
    array = _numpy.array(values)
    array.flags.writeable = False
    return array


# What `generate` writes.
_LANGUAGES = ("rust", "c", "cuda", "javascript", "python", "matlab")

# Behind the name of a parameter that is a word of Python.
_OF_PYTHON = "__word"


def _matrix(sympy: Any, shown: dict[str, Any]) -> Any:
    """A quantity of `armgen show --format json`; its steps are substituted."""
    import ast
    import keyword
    import operator
    import re

    known: dict[str, Any] = {}
    binary = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow}
    functions = {"sin": sympy.sin, "cos": sympy.cos, "sqrt": sympy.sqrt, "exp": sympy.exp, "abs": sympy.Abs, "sign": sympy.sign}

    def value(node: Any) -> Any:
        match node:
            case ast.Expression(body):
                return value(body)
            case ast.Constant(int() as number):
                return sympy.Integer(number)
            case ast.Name("pi"):
                return sympy.pi
            case ast.Name(name):
                name = name.removesuffix(_OF_PYTHON)
                return known[name] if name in known else sympy.Symbol(name)
            case ast.UnaryOp(ast.USub(), operand):
                return -value(operand)
            case ast.BinOp(left, kind, right):
                return binary[type(kind)](value(left), value(right))
            case ast.Call(ast.Name(name), [argument]):
                return functions[name](value(argument))
        raise InternalError(f"a formula that is not read: {ast.dump(node)}")

    def free(name: Any) -> str:
        return name[0] + _OF_PYTHON if keyword.iskeyword(name[0]) else name[0]

    def parsed(formula: str) -> Any:
        return value(ast.parse(re.sub(r"[A-Za-z_]\w*", free, formula).replace("^", "**"), mode="eval"))

    for name, formula in shown.get("steps", []):
        known[name] = parsed(formula)
    return sympy.Matrix([[parsed(entry) for entry in row] for row in shown["entries"]])
