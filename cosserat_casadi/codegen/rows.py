"""A model as C that answers rows of inputs with rows of results: what a sweep computes with."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.compiled import compiled_texts, find_compiler
from cosserat_casadi.codegen.kernels import kernel_sources, kernels
from cosserat_casadi.codegen.lanes import lane_source
from cosserat_casadi.codegen.library import VERBATIM, library_sources, render, resource
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

EQUATIONS = ("residual", "jacobian", "rate", "tangent", "resolution_index")
"""Words in the names of the kernels that solve a row."""

LANE_FILES = ("lanes.h", "lanes.c", "lanes_arithmetic.h", "linear_lanes.c")
"""Files of the folder ``c`` for rows in lanes."""

TRY_LANES = """#if LANES
  if (count > 1 && processor_has_lanes()) return solve_rows_in_lanes(count, inputs, results);
#endif
"""
"""How the function for rows chooses."""

INCLUDED = frozenset({*VERBATIM, *LANE_FILES, f"{NAME}.c"})
"""Sources that another one includes."""

_LOCK = threading.Lock()


@dataclass(frozen=True)
class RowLibrary:
    """C sources as text, so that any machine can compile them, once.

    Attributes:
        files: content by file name, as pairs.
        inputs: numbers in a row of inputs.
        results: numbers in a row of results.
    """

    files: tuple[tuple[str, str], ...]
    inputs: int
    results: int

    def solve(self, inputs: FloatArray) -> FloatArray:
        """Rows of results, shape (count, results), for rows of inputs, shape (count, inputs).

        Other threads run meanwhile. What a row gives depends on that row alone.

        Raises:
            ExportError: there is no C compiler, or it fails.
            MemoryError: there is none for the workspace.
        """
        given = np.ascontiguousarray(inputs, dtype=np.float64)
        if given.ndim != 2 or given.shape[1] != self.inputs:
            raise ValueError(f"inputs must have shape (count, {self.inputs}), got {given.shape}")
        results = np.empty((len(given), self.results))
        if _loaded(self.files)[f"{NAME}_rows"](len(given), pointer(given), pointer(results)):
            raise MemoryError("there is no memory for the solver's workspace")
        return results


def row_library(model: Model) -> RowLibrary:
    """Sources of the solver of a model with a function for rows, in lanes where its equations have that form.

    Raises:
        ExportError: two things of the scene would have one name in C.
    """
    names = model_names(NAME, model)
    parts = assembled(model, names)
    functions = kernels(model, names, parts)
    generated = kernel_sources(functions, names)
    columns = row_results(model.scene)
    # An assembly is eliminated rod after rod, which has no form for lanes.
    lanes = None if parts is not None else _lanes(functions, names)
    files = {
        **library_sources(model, names, parts, generated, None),
        **generated,
        **_rows_source(model, names, len(columns), lanes),
    }
    wanted = [
        (name, text) for name, text in files.items() if name.endswith((".c", ".h")) and not name.endswith("_demo.c")
    ]
    return RowLibrary(tuple(wanted), model.inputs.size, len(columns))


def row_results(scene: Scene) -> tuple[str, ...]:
    """Names of the columns of a row of results: how it ended, poses of tips and bodies, what actuators exert."""
    posed = [*[rod.name for rod in scene.rods], *[body.name for body in scene.bodies]]
    states = [f"{actuator.name}.{word}" for actuator in scene.actuators for word in _state(actuator)]
    return (*JUDGED, *[f"{name}.{axis}" for name in posed for axis in POSE], *states)


def _state(actuator: Actuator) -> tuple[str, str]:
    """Names of the effort of an actuator and of what it works on."""
    member = EFFECTS[actuator.kind]
    return member.effort, member.conjugate


def _shown(names: Names) -> list[tuple[str, str]]:
    """Functions whose results are in a row, in its order: the word in their names, and whose they are."""
    tips = [("tip", rod) for rod in names.rods]
    bodies = [("body", body) for body in names.bodies]
    return [*tips, *bodies, *(("actuator", actuator) for actuator in names.actuators)]


def _rows_source(model: Model, names: Names, results: int, lanes: str | None) -> dict[str, str]:
    """The sources of the function for rows by file name.

    Args:
        model: what is solved.
        names: of the library.
        results: numbers in a row of results.
        lanes: source of the kernels in lanes; None where rows are solved one after the other.
    """
    shown = _shown(names)
    calls = list[str]()
    calls_in_lanes = list[str]()
    column = len(JUDGED)
    for word, owner in shown:
        second, end, rest = (1, 2, ", 0") if word == "actuator" else (3, len(POSE), "")
        function = names.function(word, owner)
        calls.append(f"  {function}(x, given, row + {column}, row + {column + second}{rest});")
        places = {"kernel": names.kernel(word, owner), "first": column, "second": column + second, "rest": rest}
        calls_in_lanes.append(render("results_in_lanes.c.in", places))
        column += end
    words = {"name": names.name, "results": str(results), "judged": str(len(JUDGED)), "calls": "\n".join(calls)}
    if lanes is None:
        return {f"{NAME}_rows.c": render("rows.c.in", {**words, "in_lanes": "", "try_lanes": ""})}
    kernels_called = [*map(names.kernel, EQUATIONS), *(names.kernel(word, owner) for word, owner in shown)]
    words_of_lanes = {
        "prototypes": "".join(f"KERNEL_IN_LANES({kernel});\n" for kernel in kernels_called),
        "calls_in_lanes": "".join(calls_in_lanes),
    }
    in_lanes = render("rows_in_lanes.c.in", {**words, **words_of_lanes})
    return {
        f"{NAME}_rows.c": render("rows.c.in", {**words, "in_lanes": in_lanes, "try_lanes": TRY_LANES}),
        f"{NAME}_lanes.c": lanes,
        **{file: resource("c", file) for file in LANE_FILES},
    }


def _lanes(functions: Sequence[ca.Function], names: Names) -> str | None:
    """Source of the kernels that rows need, for several at once; None where some kernel has no such form."""
    wanted = {*map(names.kernel, EQUATIONS), *(names.kernel(word, owner) for word, owner in _shown(names))}
    return lane_source([function for function in functions if function.name() in wanted], names)


def _loaded(files: tuple[tuple[str, str], ...]) -> ctypes.CDLL:
    # Threads wait for the one that compiles, instead of compiling too.
    with _LOCK:
        return _library(files)


@cache
def _library(files: tuple[tuple[str, str], ...]) -> ctypes.CDLL:
    return ctypes.CDLL(str(compiled_texts(NAME, dict(files), find_compiler(), INCLUDED)))
