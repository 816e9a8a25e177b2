"""Types of the package. Written by tests/stub.py."""

import os
from typing import Any, Final, Iterable, Iterator, Literal, Mapping, NamedTuple, NoReturn, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import disjoint_base

__version__: Final[str]

class Label(NamedTuple):
    text: str
    line: int
    column: int
    end_line: int
    end_column: int

class Diagnostic(NamedTuple):
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
    diagnostics: tuple[Diagnostic, ...]
    source: str
    def __init__(self, text: str, diagnostics: tuple[Diagnostic, ...] = (), source: str = "") -> None: ...
    def __reduce__(self) -> Any: ...

class DescriptionWarning(UserWarning): ...

class InternalError(RuntimeError):
    def __init__(self, said: str) -> None: ...

class VerificationError(RuntimeError): ...

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
) -> Robot: ...
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
) -> Robot: ...

@disjoint_base
class Function:
    @property
    def __name__(self) -> str: ...
    @property
    def arguments(self) -> tuple[str, ...]: ...
    @property
    def shape(self) -> Any: ...
    @property
    def unit(self) -> Any: ...
    @property
    def operations(self) -> dict[str, int]: ...
    @property
    def derivation(self) -> str: ...
    def __call__(self, *given: ArrayLike, **named: Any) -> Any: ...
    def __reduce__(self) -> Any: ...
    def __copy__(self) -> Function: ...
    def __deepcopy__(self, _memo: Any, /) -> Function: ...

@final
class Postures:
    @property
    def q(self) -> NDArray[np.float64]: ...
    @property
    def verdict(self) -> Literal["complete", "unreachable", "near_double", "continuum", "invalid"]: ...
    @property
    def reason(self) -> str | None: ...
    @property
    def miss(self) -> float: ...
    @property
    def branch(self) -> NDArray[np.int64]: ...
    @property
    def branch_names(self) -> tuple[str, ...]: ...
    @property
    def double(self) -> NDArray[np.bool_]: ...
    @property
    def free(self) -> NDArray[np.bool_]: ...
    def within_limits(self) -> Postures: ...
    def nearest_to(self, q: ArrayLike) -> NDArray[np.float64] | None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: Any, /) -> NDArray[np.float64]: ...
    def __iter__(self) -> Iterator[NDArray[np.float64]]: ...

class EquationsOfMotion(NamedTuple):
    inertia: NDArray[np.float64]
    coriolis: NDArray[np.float64]
    gravity: NDArray[np.float64]

class InverseDynamicsDerivatives(NamedTuple):
    by_q: NDArray[np.float64]
    by_dq: NDArray[np.float64]

class ForwardDynamicsDerivatives(NamedTuple):
    by_q: NDArray[np.float64]
    by_dq: NDArray[np.float64]
    by_tau: NDArray[np.float64]

class _ArrayOfQ(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfQDq(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfPiQ(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, q: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfPiQDq(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, q: ArrayLike, dq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfDq(Function):
    def __call__(  # type: ignore[override]
        self, dq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfPiDq(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, dq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _EquationsOfMotionOfQDq(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, *, out: EquationsOfMotion | tuple[NDArray[np.float64], ...] | None = None, threads: int = 1
    ) -> EquationsOfMotion: ...

class _EquationsOfMotionOfPiQDq(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, q: ArrayLike, dq: ArrayLike, *, out: EquationsOfMotion | tuple[NDArray[np.float64], ...] | None = None, threads: int = 1
    ) -> EquationsOfMotion: ...

class _ArrayOfQDqDdq(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfPiQDqDdq(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfQDqTau(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, tau: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfPiQDqTau(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, q: ArrayLike, dq: ArrayLike, tau: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _ArrayOfQDqDqrDdqr(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, dqr: ArrayLike, ddqr: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> NDArray[np.float64]: ...

class _NumberOfQDq(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> float | NDArray[np.float64]: ...

class _NumberOfPiQDq(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, q: ArrayLike, dq: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> float | NDArray[np.float64]: ...

class _NumberOfQ(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> float | NDArray[np.float64]: ...

class _NumberOfPiQ(Function):
    def __call__(  # type: ignore[override]
        self, pi: ArrayLike, q: ArrayLike, *, out: NDArray[np.float64] | None = None, threads: int = 1
    ) -> float | NDArray[np.float64]: ...

class _InverseDynamicsDerivativesOfQDqDdq(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, *, out: InverseDynamicsDerivatives | tuple[NDArray[np.float64], ...] | None = None, threads: int = 1
    ) -> InverseDynamicsDerivatives: ...

class _ForwardDynamicsDerivativesOfQDqTau(Function):
    def __call__(  # type: ignore[override]
        self, q: ArrayLike, dq: ArrayLike, tau: ArrayLike, *, out: ForwardDynamicsDerivatives | tuple[NDArray[np.float64], ...] | None = None, threads: int = 1
    ) -> ForwardDynamicsDerivatives: ...

class Robot:
    name: Final[str]
    dof: Final[int]
    joint_names: Final[tuple[str, ...]]
    revolute: Final[NDArray[np.bool_]]
    position_limits: Final[NDArray[np.float64]]
    velocity_limits: Final[NDArray[np.float64]]
    effort_limits: Final[NDArray[np.float64]]
    acceleration_limits: Final[NDArray[np.float64]]
    jerk_limits: Final[NDArray[np.float64]]
    task: Final[tuple[str, ...]]
    gravity_vector: Final[NDArray[np.float64]]
    warnings: Final[tuple[Diagnostic, ...]]
    notes: Final[tuple[str, ...]]
    functions: Final[tuple[str, ...]]
    def __init__(self) -> None: ...
    @property
    def text(self) -> str: ...
    @property
    def report(self) -> dict[str, Any] | None: ...
    @property
    def absent(self) -> dict[str, str]: ...
    @property
    def parameter_names(self) -> tuple[str, ...]: ...
    @property
    def nominal_parameters(self) -> NDArray[np.float64]: ...
    def payload_parameters(
        self, mass: float, com: ArrayLike, inertia: ArrayLike | None = None
    ) -> NDArray[np.float64]: ...
    @property
    def base_parameter_names(self) -> tuple[str, ...]: ...
    @property
    def nominal_base_parameters(self) -> NDArray[np.float64]: ...
    def inverse_kinematics(
        self,
        pose: ArrayLike | None = None,
        redundancy: ArrayLike | None = None,
        *,
        position: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        threads: int = 1,
    ) -> Any: ...
    @property
    def redundancy(self) -> str | None: ...
    def inverse_kinematics_redundancy(self, q: ArrayLike) -> float | NDArray[np.float64]: ...
    def prepare(self, *names: str) -> None: ...
    def check(self, *, full: bool = False) -> str: ...
    def show(self, quantity: str, *, symbolic: bool = False, form: str | None = None, digits: int | None = None) -> str: ...
    def latex(
        self, quantity: str, *, symbolic: bool = False, form: str | None = "shortest", digits: int | None = None
    ) -> str: ...
    def sympy(self, quantity: str, *, symbolic: bool = False) -> Any: ...
    def page(self, path: str | os.PathLike[str] | None = None) -> str | None: ...
    def _repr_html_(self) -> str: ...
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
    ) -> dict[str, str]: ...
    def verify(self, text: str | None = None, language: str = "rust") -> dict[str, dict[str, Any]]: ...
    def __setattr__(self, name: str, value: Any) -> NoReturn: ...
    def __delattr__(self, name: str) -> NoReturn: ...
    def __reduce__(self) -> Any: ...
    def __copy__(self) -> Robot: ...
    def __deepcopy__(self, memo: Any) -> Robot: ...
    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...
    direct_kinematics: Final[_ArrayOfQ]
    link_frames: Final[_ArrayOfQ]
    geometric_jacobian: Final[_ArrayOfQ]
    geometric_jacobian_dot: Final[_ArrayOfQDq]
    link_jacobians: Final[_ArrayOfQ]
    joint_variables: Final[_ArrayOfQ]
    inertia_matrix: Final[_ArrayOfQ]
    inertia_matrix_with: Final[_ArrayOfPiQ]
    coriolis_matrix: Final[_ArrayOfQDq]
    coriolis_matrix_with: Final[_ArrayOfPiQDq]
    gravity: Final[_ArrayOfQ]
    gravity_with: Final[_ArrayOfPiQ]
    friction: Final[_ArrayOfDq]
    friction_with: Final[_ArrayOfPiDq]
    load_friction: Final[_ArrayOfQDq]
    load_friction_with: Final[_ArrayOfPiQDq]
    equations_of_motion: Final[_EquationsOfMotionOfQDq]
    equations_of_motion_with: Final[_EquationsOfMotionOfPiQDq]
    inverse_dynamics: Final[_ArrayOfQDqDdq]
    inverse_dynamics_with: Final[_ArrayOfPiQDqDdq]
    forward_dynamics: Final[_ArrayOfQDqTau]
    forward_dynamics_with: Final[_ArrayOfPiQDqTau]
    regressor: Final[_ArrayOfQDqDqrDdqr]
    known_torque: Final[_ArrayOfQDqDqrDdqr]
    kinetic_energy: Final[_NumberOfQDq]
    kinetic_energy_with: Final[_NumberOfPiQDq]
    potential_energy: Final[_NumberOfQ]
    potential_energy_with: Final[_NumberOfPiQ]
    center_of_mass: Final[_ArrayOfQ]
    center_of_mass_with: Final[_ArrayOfPiQ]
    momentum: Final[_ArrayOfQDq]
    coriolis_transpose_times: Final[_ArrayOfQDq]
    base_regressor: Final[_ArrayOfQDqDdq]
    operational_inertia: Final[_ArrayOfQ]
    inverse_dynamics_derivatives: Final[_InverseDynamicsDerivativesOfQDqDdq]
    forward_dynamics_derivatives: Final[_ForwardDynamicsDerivativesOfQDqTau]
