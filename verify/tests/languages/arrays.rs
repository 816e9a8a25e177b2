//! Emitted Python under other array libraries: torch, jax, and libraries with the array API.

use std::path::Path;
use std::process::Command;

use armgen_codegen::emit::Language;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::program::Trig;

use super::page::folder_of;
use super::tools::{numpy, python_that, python_with, succeed, write};
use crate::common;

/// Tensors of torch: the bits of NumPy with and without blocks; also under recording, mapping and compilation.
pub(crate) fn check_torch() {
    let Some(python) = python_with("torch") else { return };
    let (folder, generated) = folder_of("languages_torch");
    write(folder.join("scara.py"), generated.in_language(Language::Python));
    write(
        folder.join("main.py"),
        "import inspect
import warnings

import numpy as np
import torch

import scara

warnings.simplefilter('ignore')
rng = np.random.default_rng(1)
for count in (1, 5000):
    for name in (name for name in scara.__all__ if name[0].islower() and name != 'by_joint'):
        function = getattr(scara, name)
        of = lambda argument: scara.PARAMETERS if argument == 'pi' else scara.DOF
        states = [rng.uniform(-9, 9, (count, of(argument))) for argument in inspect.signature(function).parameters]
        states[-1][:1] *= 7e2
        one, other = function(*states), function(*map(torch.from_numpy, states))
        one, other = [result if isinstance(result, tuple) else (result,) for result in (one, other)]
        assert all(np.array_equal(a, b.numpy()) for a, b in zip(one, other)), name
many, rates = (torch.from_numpy(rng.uniform(-3, 3, (5000, 4))) for _ in range(2))
few = many[:8]
near = lambda a, b: bool((a - b).abs().max() < 1e-11)
momentum = scara.momentum(many, rates)
tracked = rates.clone().requires_grad_()
scara.kinetic_energy(many, tracked).sum().backward()
assert near(tracked.grad, momentum)
# Angles beyond the range of the sines, by a program that was recorded within it; and one that is as long for more states than a block has.
traced = [torch.jit.trace(scara.inertia_matrix, (states,)) for states in (many, few)]
assert all(near(program(few * 1e10), scara.inertia_matrix(few * 1e10)) for program in traced)
assert len({len(list(program.graph.nodes())) for program in traced}) == 1
try:
    from torch.func import grad, vmap
except ImportError:
    from functorch import grad, vmap
assert near(vmap(grad(scara.kinetic_energy, argnums=1))(few, rates[:8]), momentum[:8])
assert near(vmap(scara.inertia_matrix)(few), scara.inertia_matrix(few))
",
    );
    succeed(Command::new(python).current_dir(&folder).arg("main.py"));
}

/// The modules of two arms, for the tests of compilers.
fn arms_in(folder: &Path) {
    for (name, scalar) in [("scara", Scalar::F64), ("panda7", Scalar::F32)] {
        let text = super::generated(&common::source(name), scalar, Trig::Fast).in_language(Language::Python);
        write(folder.join(format!("{name}.py")), text);
    }
}

/// Compilers record both forms of a function whole. Results differ from those without a compiler by fused or reordered operations alone, at most
/// `close` times the largest entry; angles beyond the range of the module's sines are included.
const COMPILED: &str = "import importlib
import sys

import numpy as np


def flat(result):
    return [entry for part in result for entry in flat(part)] if isinstance(result, tuple) else [result]


def check(put, compiled, closeness):
    for arm, close in closeness.items():
        module = importlib.import_module(arm)
        rng = np.random.default_rng(1)
        given = [rng.uniform(-3, 3, (64, module.DOF)).astype(module.DTYPE) for _ in range(3)]
        given[0][:1] *= 7e4
        for name, count in (('inverse_dynamics', 3), ('inertia_matrix', 1)):
            function, states = getattr(module, name), given[:count]
            expected = np.asarray(function(*map(put, states)))
            found = np.asarray(compiled(function)(*map(put, states)))
            by_joint = compiled(module.by_joint(function))(*(put(np.ascontiguousarray(array.T)) for array in states))
            by_joint = np.stack([np.asarray(entry) for entry in flat(by_joint)], -1).reshape(expected.shape)
            for result in (found, by_joint):
                assert result.dtype == expected.dtype and result.shape == expected.shape, (arm, name)
                error = np.abs(result - expected).max() / np.abs(expected).max()
                print(arm, name, error, np.count_nonzero(result != expected))
                assert error <= close, (arm, name, error)


";

/// `torch.compile` records a function without a break in the graph, once for all batches; the operations keep their bits.
pub(crate) fn check_torch_compile() {
    let Some(python) = python_that("import torch; torch.compile", "with torch 2 here") else { return };
    let (folder, _) = folder_of("languages_torch_compile");
    arms_in(&folder);
    // torch 2.15 warns of calls of its own.
    let own = "import torch, warnings
warnings.filterwarnings('ignore', category=FutureWarning, module='torch')

graphs = []


def as_recorded(graph, _):
    graphs.append(graph)
    return graph.forward


def compiled(function):
    torch._dynamo.reset()
    return torch.compile(function, fullgraph=True, dynamic=True, backend=as_recorded)


check(torch.from_numpy, compiled, {'scara': 0.0, 'panda7': 0.0})
assert len(graphs) == 8
import scara
from torch.func import jvp, vjp

q, dq = torch.from_numpy(np.random.default_rng(1).uniform(-3, 3, (2, 8, 4)))
derivatives = scara.inverse_dynamics_derivatives(q, dq, dq)
inertia = compiled(scara.inertia_matrix)
inertia(torch.cat([q] * 1000))
graphs.clear()
inertia(q)
assert not graphs
tau = compiled(lambda q: scara.inverse_dynamics(q, dq, dq))
_, forward = jvp(lambda q: scara.inverse_dynamics(q, dq, dq), (q,), (dq,))
assert (forward - (derivatives[0] @ dq[..., None])[..., 0]).abs().max() < 1e-11
_, back = vjp(lambda q: scara.inverse_dynamics(q, dq, dq), q)
assert (back(dq)[0] - (derivatives[0].transpose(-1, -2) @ dq[..., None])[..., 0]).abs().max() < 1e-11
tracked = q.clone().requires_grad_()
tau(tracked).backward(dq)
assert (tracked.grad - back(dq)[0]).abs().max() < 1e-11
";
    write(folder.join("main.py"), format!("{COMPILED}{own}"));
    succeed(Command::new(python).current_dir(&folder).arg("main.py"));
}

/// `jax.jit` compiles functions, and differentiates them; without two passes it keeps the bits of NumPy.
pub(crate) fn check_jax_jit() {
    let Some(python) = python_with("jax") else { return };
    let (folder, _) = folder_of("languages_jax_jit");
    arms_in(&folder);
    let own = "import jax

jax.config.update('jax_enable_x64', True)
check(jax.numpy.asarray, jax.jit, {'scara': 1e-15, 'panda7': 2e-6})
import scara

q, dq = np.random.default_rng(1).uniform(-3, 3, (2, 8, 4))
same = jax.jit(scara.inverse_dynamics, compiler_options={'xla_disable_hlo_passes': 'fusion,algsimp'})
assert np.array_equal(same(q, dq, dq), scara.inverse_dynamics(q, dq, dq))
derivatives = scara.inverse_dynamics_derivatives(q, dq, dq)
stacked = lambda *arguments: jax.numpy.stack(scara.by_joint(scara.inverse_dynamics)(*(x.T for x in arguments)), -1)
q, dq = map(jax.numpy.asarray, (q, dq))
for function in (scara.inverse_dynamics, stacked):
    tau = jax.jit(lambda q: function(q, dq, dq))
    _, forward = jax.jvp(tau, (q,), (dq,))
    assert np.abs(forward - (derivatives[0] @ dq[..., None])[..., 0]).max() < 1e-11
    _, back = jax.vjp(tau, q)
    assert np.abs(back(dq)[0] - (np.swapaxes(derivatives[0], -1, -2) @ dq[..., None])[..., 0]).max() < 1e-11
";
    write(folder.join("main.py"), format!("{COMPILED}{own}"));
    succeed(Command::new(python).current_dir(&folder).arg("main.py"));
}

/// Functions by joint: the bits of NumPy for every function, single states and broadcast arguments included; wrong arguments are told.
pub(crate) fn check_by_joint() {
    let Some(python) = numpy() else { return };
    let (folder, generated) = folder_of("languages_by_joint");
    write(folder.join("scara.py"), generated.in_language(Language::Python));
    let other = super::generated(&common::source("dry_friction"), Scalar::F32, Trig::Std);
    write(folder.join("friction.py"), other.in_language(Language::Python));
    write(
        folder.join("main.py"),
        "import inspect
import warnings

import numpy as np

import friction
import scara

warnings.simplefilter('ignore')
rng = np.random.default_rng(1)


def same(found, expected, lengths):
    if lengths:
        assert isinstance(found, tuple) and len(found) == lengths[0]
        for i, row in enumerate(found):
            same(row, expected[..., i] if len(lengths) == 1 else np.moveaxis(expected, -len(lengths), 0)[i], lengths[1:])
    else:
        assert found.shape == expected.shape and found.dtype == expected.dtype and np.array_equal(found, expected, equal_nan=True)


for module in (scara, friction):
    for shape in ((), (3,), (2, 3), (5000,)):
        for name in (name for name in module.__all__ if name[0].islower() and name != 'by_joint'):
            function = getattr(module, name)
            of = lambda argument: module.PARAMETERS if argument == 'pi' else module.DOF
            # Every other argument is that of a single state, for all.
            arguments = inspect.signature(function).parameters
            states = [rng.uniform(-9, 9, (shape if i % 2 == 0 else ()) + (of(a),)).astype(module.DTYPE) for i, a in enumerate(arguments)]
            expected = function(*states)
            for found in (
                module.by_joint(function)(*(np.moveaxis(state, -1, 0) for state in states)),
                module.by_joint(function)(*([np.asarray(state[..., i]) for i in range(state.shape[-1])] for state in states)),
            ):
                for one, other in zip(found, expected) if hasattr(expected, '_fields') else [(found, expected)]:
                    same(one, other, other.shape[len(shape) :])


def said(call):
    try:
        call()
    except (TypeError, ValueError) as error:
        return type(error).__name__ + ': ' + str(error)
    raise AssertionError('nothing was said')


gravity = scara.by_joint(scara.gravity)
assert said(lambda: gravity(np.zeros((3, 9)))) == 'ValueError: q has 3 entries, and 4 are wanted'
assert said(lambda: gravity(np.zeros((4, 9), np.float32))).startswith('TypeError: q has entries of float32')
assert said(lambda: gravity([np.zeros(2), np.zeros(3), np.zeros(2), np.zeros(2)])).endswith('do not go together')
",
    );
    succeed(Command::new(python).current_dir(&folder).arg("main.py"));
}

/// Arrays of a library with only the array API, whose indices must be complete or have an ellipsis; the bits equal NumPy's. The test makes up such a
/// library; the library for this purpose runs if installed.
pub(crate) fn check_array_api() {
    let Some(python) = numpy() else { return };
    let (folder, generated) = folder_of("languages_array_api");
    write(folder.join("scara.py"), generated.in_language(Language::Python));
    let other = super::generated(&common::source("dry_friction"), Scalar::F32, Trig::Std);
    write(folder.join("friction.py"), other.in_language(Language::Python));
    write(
        folder.join("main.py"),
        "import inspect
import types
import warnings

import numpy as np

import friction
import scara

warnings.simplefilter('ignore')
bare = lambda value: value.array if isinstance(value, Strict) else [bare(v) for v in value] if isinstance(value, (list, tuple)) else value
library = types.ModuleType('strict')


class Strict:
    def __init__(self, array):
        self.array = np.asarray(array)
        self.dtype, self.shape = self.array.dtype, self.array.shape

    def __array_namespace__(self):
        return library

    def __getitem__(self, key):
        key = key if isinstance(key, tuple) else (key,)
        assert Ellipsis in key or len(key) == self.array.ndim, f'{key} of {self.array.ndim} axes'
        return Strict(self.array[key])


for name in 'add radd sub rsub mul rmul truediv rtruediv lt le gt ge neg'.split():
    name = f'__{name}__'
    setattr(Strict, name, lambda own, *other, name=name: Strict(getattr(own.array, name)(*map(bare, other))))
for name in 'abs asarray broadcast_to cos full_like moveaxis ones_like reshape round sin stack where zeros_like'.split():
    setattr(library, name, lambda *values, name=name, **named: Strict(getattr(np, name)(*map(bare, values), **named)))
library.float64, library.float32 = np.float64, np.float32

libraries = [library]
try:
    import array_api_strict
    libraries.append(array_api_strict)
except ImportError:
    pass
rng = np.random.default_rng(1)
for module in (scara, friction):
    for shape in ((), (3,), (2, 3)):
        for name in (name for name in module.__all__ if name[0].islower() and name != 'by_joint'):
            function = getattr(module, name)
            of = lambda argument: module.PARAMETERS if argument == 'pi' else module.DOF
            states = [rng.uniform(-9, 9, shape + (of(a),)).astype(module.DTYPE) for a in inspect.signature(function).parameters]
            states[-1] = states[-1] * np.asarray(7e4, module.DTYPE)
            expected = function(*states)
            for xp in libraries:
                found = function(*map(xp.asarray, states))
                pairs = zip(expected, found) if isinstance(expected, tuple) else [(expected, found)]
                for a, b in pairs:
                    assert isinstance(b, type(xp.asarray(1.0))), name
                    assert np.array_equal(a, getattr(b, 'array', None) if xp is library else b._array, equal_nan=True), name
",
    );
    succeed(Command::new(python).current_dir(&folder).arg("main.py"));
}

/// The message about entries of another type leads to an accepted type, for torch and jax, with and without 64 bits.
pub(crate) fn check_other_types() {
    let (folder, generated) = folder_of("languages_types");
    write(folder.join("scara.py"), generated.in_language(Language::Python));
    write(
        folder.join("narrow.py"),
        super::generated(&common::source("scara"), Scalar::F32, Trig::Fast).in_language(Language::Python),
    );
    let said = "def said(call):
    try:
        call()
    except TypeError as error:
        return str(error)
    raise AssertionError('nothing was said')


";
    let torch = "import narrow, scara, torch
q = torch.zeros(4)
assert said(lambda: scara.gravity(q)).endswith('float64 is wanted: make it with dtype=torch.float64')
assert scara.gravity(q.to(dtype=torch.float64)).dtype == torch.float64 and narrow.gravity(q).dtype == torch.float32
";
    let jax = "import jax, narrow, scara
whole = jax.numpy.arange(4)
narrow_only = 'float32 is wanted: make it with dtype=jax.numpy.float32'
assert said(lambda: narrow.gravity(whole)).endswith(narrow_only)
remedy = 'make it with dtype=jax.numpy.float64 after jax.config.update(\"jax_enable_x64\", True)'
for q in (whole, jax.numpy.zeros(4)):
    assert said(lambda: scara.gravity(q)).endswith(remedy)
jax.config.update('jax_enable_x64', True)
assert said(lambda: scara.gravity(whole)).endswith('float64 is wanted: make it with dtype=jax.numpy.float64')
assert said(lambda: narrow.gravity(jax.numpy.zeros(4))).endswith(narrow_only)
assert scara.gravity(jax.numpy.zeros(4, dtype=jax.numpy.float64)).dtype == jax.numpy.float64
";
    for (library, calls) in [("torch", torch), ("jax", jax)] {
        if let Some(python) = python_with(library) {
            write(folder.join("main.py"), format!("{said}{calls}"));
            succeed(Command::new(python).current_dir(&folder).arg("main.py"));
        }
    }
}
