"""A model as C that answers rows of inputs with rows of results: what a sweep computes with."""

from __future__ import annotations

import ctypes
import threading
from dataclasses import dataclass
from functools import cache

import numpy as np

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.compiled import compiled_texts, find_compiler
from cosserat_casadi.codegen.kernels import kernel_sources, kernels
from cosserat_casadi.codegen.library import VERBATIM, library_sources, render
from cosserat_casadi.codegen.names import Names, model_names
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.scene import Actuator, Scene

NAME = "sweep"
"""What every symbol of these libraries begins with."""

JUDGED = ("outcome", "iterations", "residual")
"""First columns of every row of results; the outcome as its number."""

POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
"""Columns of a pose: position (m), quaternion."""

_LOCK = threading.Lock()


@dataclass(frozen=True)
class RowLibrary:
    """C sources as text, so that any machine can compile them, once.

    Attributes:
        files: content by file name, as pairs.
        inputs: numbers in a row of inputs.
        parameters: numbers in a row of parameters.
        results: numbers in a row of results.
    """

    files: tuple[tuple[str, str], ...]
    inputs: int
    parameters: int
    results: int

    def solve(self, inputs: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Rows of results, shape (count, results), for rows of inputs and of parameters.

        Other threads run meanwhile. What a row gives depends on that row alone.

        Args:
            inputs: shape (count, inputs).
            parameters: shape (count, parameters); needed where there are any.

        Raises:
            ExportError: there is no C compiler, or it fails.
            MemoryError: there is none for the workspace.
        """
        given = np.ascontiguousarray(inputs, dtype=np.float64)
        if given.ndim != 2 or given.shape[1] != self.inputs:
            raise ValueError(f"inputs must have shape (count, {self.inputs}), got {given.shape}")
        arguments = [pointer(given)]
        if self.parameters:
            wanted = (len(given), self.parameters)
            p = np.ascontiguousarray(np.empty((0, 0)) if parameters is None else parameters, dtype=np.float64)
            if p.shape != wanted:
                raise ValueError(f"parameters must have shape {wanted}, got {p.shape}")
            arguments.append(pointer(p))
        results = np.empty((len(given), self.results))
        if _loaded(self.files)[f"{NAME}_rows"](len(given), *arguments, pointer(results)):
            raise MemoryError("there is no memory for the solver's workspace")
        return results


def row_library(model: Model) -> RowLibrary:
    """Sources of the solver of a model with a function for rows.

    Raises:
        ExportError: two things of the scene would have one name in C.
    """
    names = model_names(NAME, model)
    parts = assembled(model, names)
    generated = kernel_sources(kernels(model, names, parts), names)
    columns = row_results(model.scene)
    files = {
        **library_sources(model, names, parts, generated, None),
        **generated,
        f"{NAME}_rows.c": _rows_source(model, names, len(columns)),
    }
    wanted = [
        (name, text) for name, text in files.items() if name.endswith((".c", ".h")) and not name.endswith("_demo.c")
    ]
    return RowLibrary(tuple(wanted), model.inputs.size, model.parameters.size, len(columns))


def row_results(scene: Scene) -> tuple[str, ...]:
    """Names of the columns of a row of results: how it ended, poses of tips and bodies, what actuators exert."""
    posed = [*[rod.name for rod in scene.rods], *[body.name for body in scene.bodies]]
    states = [f"{actuator.name}.{word}" for actuator in scene.actuators for word in _state(actuator)]
    return (*JUDGED, *[f"{name}.{axis}" for name in posed for axis in POSE], *states)


def _state(actuator: Actuator) -> tuple[str, str]:
    """Names of the effort of an actuator and of what it works on."""
    member = EFFECTS[actuator.kind]
    return member.effort, member.conjugate


def _rows_source(model: Model, names: Names, results: int) -> str:
    tips = [names.function("tip", rod) for rod in names.rods]
    bodies = [names.function("body", body) for body in names.bodies]
    passed = ", parameters" if model.parameters.size else ""
    lines = list[str]()
    column = len(JUDGED)
    for function in (*tips, *bodies):
        lines.append(f"    {function}(x, given{passed}, row + {column}, row + {column + 3});")
        column += len(POSE)
    for actuator in names.actuators:
        function = names.function("actuator", actuator)
        lines.append(f"    {function}(x, given{passed}, row + {column}, row + {column + 1}, 0);")
        column += 2
    words = {"name": names.name, "MACRO": names.macro, "results": str(results), "calls": "\n".join(lines)}
    words |= {"passed": passed, "parameters": "", "parameter_rows": "", "own_parameters": ""}
    if passed:
        real = f"{names.name}_real"
        words["parameters"] = f", const {real} *all_parameters"
        words["parameter_rows"] = ", all_parameters (PARAMETERS x count)"
        own = f"all_parameters + (size_t)i * {names.macro}_PARAMETERS"
        words["own_parameters"] = f"    const {real} *parameters = {own};\n"
    return render("rows.c.in", words)


def _loaded(files: tuple[tuple[str, str], ...]) -> ctypes.CDLL:
    # Threads wait for the one that compiles, instead of compiling too.
    with _LOCK:
        return _library(files)


@cache
def _library(files: tuple[tuple[str, str], ...]) -> ctypes.CDLL:
    return ctypes.CDLL(str(compiled_texts(NAME, dict(files), find_compiler(), VERBATIM)))
