"""C library of a model that maps rows of inputs to rows of results, for sweeps."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.kernels import kernels
from cosserat_casadi.codegen.lanes import in_lanes, lanes_files
from cosserat_casadi.codegen.library import FolderContents, library_sources
from cosserat_casadi.codegen.names import model_names
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.stability import stability_sources
from cosserat_casadi.compiling.cache import kept_texts
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.texts import files_in_c, render
from cosserat_casadi.equilibrium.contact.gaps import body_pairs, pairs, rod_pairs
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.scene import Scene

NAME = "sweep"
"""Prefix of every symbol of the libraries that solve rows."""

JUDGED = ("outcome", "iterations", "residual")
"""First columns of every row of results; the outcome as its number."""

ERRORS = ("error_estimate", "within_tolerance")
"""Optional columns after poses, efforts and contacts: the estimated error, 1 if unknown; and whether it is within the
tolerance, NaN where that is undecided."""

STABILITY = ("smallest_eigenvalue", "stable")
"""Optional last columns of a row of results: eigenvalue in units of EI/ℓ; 1 if stable, else 0."""

ENERGY = "energy"
"""Column of the energy of concentric tubes, J."""

TUBE_STABILITY = ("falling_directions", "determinant", "stable")
"""Optional last columns of a row of concentric tubes."""

CONTACT = ("contacts", "from", "to", "force.x", "force.y", "force.z")
"""Columns of a rod and an obstacle: number of contacts, least and largest abscissa, resultant force (N)."""

BODY_CONTACT = ("contacts", "force.x", "force.y", "force.z")
"""Columns of a body and an obstacle: 1 if they touch, else 0, and the force (N)."""

RODS_CONTACT = ("contacts", "at", "at_other", "force.x", "force.y", "force.z")
"""Columns of two rods: number of contacts, the abscissae of the first one on both rods, the resultant on the first."""

POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
"""Columns of a pose: position (m), quaternion."""

_LOCK = threading.Lock()


@dataclass(frozen=True)
class RowLibrary:
    """C sources as text, so that any machine can compile them, once.

    Attributes:
        files: content by file name, as pairs.
        inputs: number of entries in a row of inputs.
        parameters: number of entries in a row of parameters.
        results: number of entries in a row of results.
        in_lanes: whether rows are solved side by side.
    """

    files: tuple[tuple[str, str], ...]
    inputs: int
    parameters: int
    results: int
    in_lanes: bool = False

    def solve(self, rows: FloatArray) -> FloatArray:
        """Solve rows of inputs with appended parameters; return rows of results, shape (count, results).

        Other threads run meanwhile. A row depends on its inputs alone; in exact contact also on the rows before it.

        Args:
            rows: inputs with appended parameters, shape (count, inputs + parameters).

        Raises:
            ExportError: there is no C compiler, or it fails.
            MemoryError: there is none for the workspace.
        """
        width = self.inputs + self.parameters
        if rows.ndim != 2 or rows.shape[1] != width:
            raise ValueError(f"inputs and parameters must have shape (count, {width}), got {rows.shape}")
        spans = [slice(self.inputs), slice(self.inputs, width)] if self.parameters else [slice(width)]
        tables = [np.ascontiguousarray(rows[:, span], dtype=np.float64) for span in spans]
        results = np.empty((len(rows), self.results))
        if self.compiled()[f"{NAME}_rows"](len(rows), *map(pointer, tables), pointer(results)):
            raise MemoryError("there is no memory for the solver's workspace")
        return results

    def compiled(self) -> ctypes.CDLL:
        """Return the library, which is compiled once.

        Raises:
            ExportError: there is no C compiler, or it fails.
        """
        return loaded(NAME, self.files)


def row_library(
    model: Model,
    *,
    estimate_errors: bool = False,
    stability: bool = False,
    lanes: bool = False,
) -> RowLibrary:
    """Write the sources of the solver of a model with a function for rows.

    Args:
        model: the solved model.
        estimate_errors: whether rows have :data:`ERRORS`.
        stability: whether rows end with :data:`STABILITY`, which has a meaning for loads with a potential.
        lanes: whether to solve rows side by side if the equations have a form for that, which takes about twice as
            long to compile. The results do not change.

    Raises:
        ExportError: two parts of the scene would have one name in C.
    """
    columns = row_results(model.scene, estimate_errors=estimate_errors, stability=stability)
    made_from = (row_library.__name__, model, estimate_errors, stability, lanes)
    texts = kept_texts(NAME, made_from, lambda: _row_texts(model, columns, stability=stability, lanes=lanes))
    sizes = (model.inputs.size, model.parameters.size, len(columns))
    return RowLibrary(tuple(texts.items()), *sizes, in_lanes=lanes_files(NAME)[0] in texts)


def _row_texts(model: Model, columns: tuple[str, ...], *, stability: bool, lanes: bool) -> dict[str, str]:
    """Write the sources and headers of the solver of a model with a function for rows."""
    names = model_names(NAME, model, estimate_errors=ERRORS[0] in columns)
    parts = assembled(model, names)
    generated = kernel_sources(kernels(model, names, parts), names)
    side_by_side = in_lanes(model, names) if lanes else None
    files = {
        **library_sources(model, names, FolderContents(generated, parts, rows=side_by_side)),
        **(stability_sources(model, names) if stability else {}),
        **generated,
        f"{NAME}_rows.c": _rows_source(model, columns, lanes=side_by_side is not None),
    }
    return dict(to_compile(files))


def to_compile(files: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """Select the sources and headers of a library, without its demo programs."""
    wanted = [name for name in files if name.endswith((".c", ".h")) and not name.endswith("_demo.c")]
    return tuple((name, files[name]) for name in wanted)


def row_results(scene: Scene, *, estimate_errors: bool = False, stability: bool = False) -> tuple[str, ...]:
    """Names of the columns of a row of results: outcome, poses of tips and bodies, efforts, exact contacts.

    Args:
        scene: the solved scene.
        estimate_errors: whether :data:`ERRORS` follow.
        stability: whether the columns end with :data:`STABILITY`, or :data:`TUBE_STABILITY`.
    """
    tips = [*[rod.name for rod in scene.rods], *[tube.name for tube in scene.tubes]]
    posed = [*tips, *[body.name for body in scene.bodies]]
    states = []
    for actuator in scene.actuators:
        member = EFFECTS[actuator.kind]
        states += [f"{actuator.name}.{member.effort}", f"{actuator.name}.{member.conjugate}"]
    if scene.tubes:
        states.append(ENERGY)
    poses = [f"{name}.{axis}" for name in posed for axis in POSE]
    # Smooth contact is a load, of which rows do not tell.
    contacts = [f"{rod}.{obstacle.name}.{word}" for rod, obstacle in pairs(scene) for word in CONTACT]
    contacts += [f"{rod}.{other}.{word}" for rod, other in rod_pairs(scene) for word in RODS_CONTACT]
    contacts += [f"{body.name}.{obstacle.name}.{word}" for body, obstacle in body_pairs(scene) for word in BODY_CONTACT]
    errors = ERRORS if estimate_errors else ()
    verdict = TUBE_STABILITY if scene.tubes else STABILITY
    return (*JUDGED, *poses, *states, *contacts, *errors, *(verdict if stability else ()))


def _rows_source(model: Model, columns: tuple[str, ...], *, lanes: bool) -> str:
    """Write the source of the function for rows."""
    words = {
        "name": NAME,
        "MACRO": NAME.upper(),
        "results": len(columns),
        "passed": ", parameters" if model.parameters.size else "",
        "with_parameters": model.parameters.size > 0,
        "batch_workspace": f"{NAME}_batch_workspace" if lanes else f"{NAME}_workspace",
        **judged_words(columns),
    }
    return render("rows.c.in", words)


def judged_words(columns: tuple[str, ...]) -> dict[str, Any]:
    """Words for the optional columns of errors and of stability."""
    tells_errors, tells_stability = ERRORS[0] in columns, STABILITY[0] in columns
    return {
        "estimates_errors": tells_errors,
        "estimate": columns.index(ERRORS[0]) if tells_errors else 0,
        "stability": tells_stability,
        "verdict": columns.index(STABILITY[0]) if tells_stability else 0,
    }


def loaded(name: str, files: tuple[tuple[str, str], ...]) -> ctypes.CDLL:
    """Compile and load a library, once in this process.

    Args:
        name: prefix of the name of the shared object.
        files: sources and headers by name.

    Raises:
        ExportError: there is no C compiler, or it fails.
    """
    # Threads wait for the one that compiles, instead of compiling too.
    with _LOCK:
        return _library(name, files)


@cache
def _library(name: str, files: tuple[tuple[str, str], ...]) -> ctypes.CDLL:
    return ctypes.CDLL(str(compiled_texts(name, dict(files), find_compiler(), files_in_c())))
