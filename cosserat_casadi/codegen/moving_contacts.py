"""The law of exact contact along simulated motions in C, compiled once for all models."""

from __future__ import annotations

import ctypes
import hashlib
from functools import cache, lru_cache
from typing import Any

from cosserat_casadi.codegen.controlled_steps import steps_library
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.scalar_program import scalar_program
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.motion import contact_law
from cosserat_casadi.motion.contact_gap import AT_END, FAR, LOOKS, MOST_VALLEYS
from cosserat_casadi.motion.contact_law import CompiledLaw
from cosserat_casadi.scene.accuracy import MOST_NODES

NAME = "moving_contacts"
"""Of the library in the cache."""

INCLUDED = frozenset({"contact_gaps.c", "least_pushes.c"})
"""Files that exported steps have too."""

MOST_PLACINGS = 20
"""Newton iterations for the place where a gap is least."""

BEYOND = 0.05
"""How far beyond the ends of a rod and of its elements polynomials are followed, over the length."""

OFF = 10.0
"""Gap of a section, over the largest fall of the gap up to the next one, from which on the rod is off the obstacle."""

NO_COMPILER = "a motion in exact contact is computed by C code, and {why}"
REMEDY = "{remedy}; or give each obstacle a width, m: contact is smooth then"


@lru_cache(maxsize=1)
def compiled_law() -> CompiledLaw:
    """The compiled library, and what makes programs of its surfaces.

    Raises:
        ExportError: there is no compiler, or it fails.
    """
    try:
        path = compiled_texts(NAME, _texts(), find_compiler(), included=INCLUDED, origin=_origin())
        run = steps_library().program_run
    except ExportError as error:
        (problem,) = error.problems
        why, remedy = problem.problem, problem.remedy
        raise ExportError(Problem(problem.where, NO_COMPILER.format(why=why), REMEDY.format(remedy=remedy))) from None
    address = ctypes.cast(run, ctypes.c_void_p).value
    assert address is not None, "a function has an address"
    return CompiledLaw(ctypes.CDLL(str(path)), address, scalar_program)


@cache
def _origin() -> str:
    """Key of the sources."""
    return hashlib.sha256("\0".join(_texts().values()).encode()).hexdigest()


@cache
def _texts() -> dict[str, str]:
    """The sources by file name."""
    files = (f"{NAME}.c", *sorted(INCLUDED))
    return {file: resource("c", file) for file in files} | {f"{NAME}.h": render(f"{NAME}.h.in", _words())}


def _words() -> dict[str, Any]:
    return {
        "kernel_arguments": contact_law.KERNEL_ARGUMENTS,
        "looks": LOOKS,
        "most_nodes": MOST_NODES + 1,
        "most_valleys": MOST_VALLEYS,
        "base_unknowns": POSE_SIZE,
        "most_placings": MOST_PLACINGS,
        "far": FAR,
        "beyond": BEYOND,
        "off": OFF,
        "at_end": AT_END,
    }
