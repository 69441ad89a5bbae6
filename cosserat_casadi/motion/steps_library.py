"""The loop of :mod:`~cosserat_casadi.numerics.time_steps` in C, compiled once for all models, and its record."""

from __future__ import annotations

import ctypes
import hashlib
from functools import cache, lru_cache
from typing import Any

import numpy as np

from cosserat_casadi.compiling.c_tables import initialiser, method_words, pairs
from cosserat_casadi.compiling.compiler import compiled_from, compiled_texts, find_compiler, flags_of_machine
from cosserat_casadi.compiling.scalar_program import cases_in_c
from cosserat_casadi.compiling.shared_records import POINTER
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics import stage_newton, step_control, step_matrices, step_run, time_steps
from cosserat_casadi.numerics.collocation import STAGES, radau
from cosserat_casadi.numerics.step import HeldTimes

NAME = "controlled_steps"
"""Name of the library in the cache."""

CALL = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double)


class StepsRecord(ctypes.Structure):
    """The record of ``controlled_steps.c``."""

    _fields_ = [
        *((name, ctypes.c_int) for name in ("unknowns", "touch_count", "inputs", "moving")),
        *((name, ctypes.c_int) for name in ("kink_count", "most_steps", "most_tries")),
        *((name, POINTER) for name in ("differential", "weights", "kinks", "x", "v", "a")),
        *((name, POINTER) for name in ("input_values", "input_rates", "input_accelerations", "residual")),
        *((name, POINTER) for name in ("kernel", "kernel_arguments", "kernel_results")),
        *((name, POINTER) for name in ("kernel_integers", "kernel_scratch")),
        *((name, POINTER) for name in ("at_stages", "at_stages_arguments", "at_stages_results")),
        *((name, POINTER) for name in ("at_stages_integers", "at_stages_scratch")),
        *((name, POINTER) for name in ("derivatives", "derivatives_arguments", "derivatives_results")),
        *((name, POINTER) for name in ("derivatives_integers", "derivatives_scratch", "cubics", "program", "slots")),
        *((name, ctypes.c_int) for name in ("program_lines", "program_arguments")),
        *((name, POINTER) for name in ("push", "contacts")),
        *((name, CALL) for name in ("residual_at", "residual_of_stages", "inputs_at", "jacobians_at")),
        *((name, POINTER) for name in ("stage_times", "stage_x", "stage_v", "stage_a", "stage_results")),
        *((name, POINTER) for name in ("stage_input_values", "stage_input_rates", "stage_input_accelerations")),
        *((name, POINTER) for name in ("matrices", "linearised_at", "kept_at", "now", "before", "room")),
        *((name, POINTER) for name in ("facts", "ends", "stages", "tried_at")),
        *(
            (name, ctypes.c_double)
            for name in ("cubics_begin", "stop", "newton", "lasting", "drifting", "longest_allowed", "shortest", "time")
        ),
        *((name, ctypes.c_double) for name in ("linearised_time", "kept_time", "before_size", "longest", "wanted")),
        *((name, ctypes.c_double) for name in ("size", "last_size", "last_error", "factorised")),
        *((name, ctypes.c_int) for name in ("refused", "linearised", "kept", "fresh", "singular_steps", "reason")),
        *((name, ctypes.c_int) for name in ("steps", "tries", "rejected", "iterations", "jacobians")),
        *((name, ctypes.c_int) for name in ("factorisations", "interrupted")),
        *((name, POINTER) for name in ("inverses", "pair_rows", "pair_columns", "pair_pivots")),
        *((name, POINTER) for name in ("stage_inputs", "iterate", "stage_residuals", "stage_corrections")),
        *((name, POINTER) for name in ("stage_changes", "transformed", "solutions", "vectors")),
        *((name, POINTER * step_control.MOST_ITERATIONS) for name in ("taken", "duals")),
    ]


def positions_at(held: HeldTimes) -> FloatArray:
    """The positions of :meth:`HeldTimes.positions`, by C where this process has the loop and it takes such steps."""
    steps = held.steps
    if steps.method.name != radau(STAGES).name or not steps_are_loaded():
        return held.positions()
    count, unknowns = len(held.times), len(steps.differential)
    positions = np.empty((count, unknowns))
    known = (steps.facts, steps.begins, steps.ends, steps.unknowns, steps.differential, positions)
    arrays = [np.ascontiguousarray(array) for array in (held.times, held.numbers, *known)]
    steps_library().steps_positions(count, unknowns, *(array.ctypes.data for array in arrays))
    return positions


@lru_cache(maxsize=1)
def steps_library() -> ctypes.CDLL:
    """The compiled loop.

    Raises:
        ExportError: there is no compiler, or it fails.
    """
    flags = flags_of_machine()
    path = compiled_texts(NAME, _texts(), find_compiler(), {"stage_newton.c"}, flags=flags, origin=_origin())
    library = ctypes.CDLL(str(path))
    assert library.steps_record() == ctypes.sizeof(StepsRecord), "the record differs from that of the C"
    library.steps_taken.argtypes = [ctypes.POINTER(StepsRecord)]
    library.steps_positions.argtypes = [ctypes.c_int, ctypes.c_int, *[POINTER] * 8]
    library.steps_positions.restype = None
    return library


def steps_are_at_hand() -> bool:
    """Whether the compiled loop is available, in this process or in the cache.

    Raises:
        ExportError: there is no compiler.
    """
    if steps_are_loaded():
        return True
    return compiled_from(NAME, _origin(), find_compiler(), flags_of_machine()) is not None


def steps_are_loaded() -> bool:
    """Whether this process has loaded the loop."""
    return bool(steps_library.cache_info().currsize)


@cache
def _origin() -> str:
    """Key of the C sources in the cache."""
    return hashlib.sha256("\0".join(_texts().values()).encode()).hexdigest()


def stem_of_steps() -> str:
    """Name of the record of time spent without the compiled loop."""
    return f"{NAME}-{_origin()[:20]}"


@cache
def _texts() -> dict[str, str]:
    """The C sources by file name."""
    return {
        f"{NAME}.c": resource("c", f"{NAME}.c"),
        "stage_newton.c": resource("c", "stage_newton.c"),
        "fours.h": resource("c", "fours.h"),
        f"{NAME}.h": render(f"{NAME}.h.in", _words()),
    }


def _words() -> dict[str, Any]:
    """Constants in the C, with the values of the Python modules that it implements."""
    method = radau(STAGES)
    whole, pair = complex(method.eigenvalues[0]), complex(method.eigenvalues[1])
    arrays = {
        "start_values": method.values_at(0.0),
        "start_integrals": method.values_at(0.0) @ method.matrix,
        "end_values": method.values_at(1.0),
        "end_integrals": method.weights,
        "end_double_integrals": method.position_weights,
        "pair_rate": pairs([1.0 / pair])[0],
        "pair_share": pairs([1.0 / pair**2])[0],
        "to_real": method.to_eigenvectors[0].real,
        "to_pair": pairs(method.to_eigenvectors[1]),
        "from_real": method.from_eigenvectors[:, 0].real,
        "from_pair": pairs(method.from_eigenvectors[:, 1]),
    }
    return {
        "operations": cases_in_c(),
        "iterations": step_control.MOST_ITERATIONS,
        "few_iterations": step_run.FEW_ITERATIONS,
        "singular_steps": time_steps.SINGULAR_STEPS,
        "stage_rounding": repr(stage_newton.ROUNDING),
        "singular": step_matrices.SINGULAR,
        "least_contraction": stage_newton.LEAST_CONTRACTION,
        "diverging": stage_newton.DIVERGING,
        "safety": step_control.SAFETY,
        "growth": step_control.GROWTH,
        "shrinkage": step_control.SHRINKAGE,
        "first_shrinkage": step_control.FIRST_SHRINKAGE,
        "failed_shrinkage": time_steps.FAILED_SHRINKAGE,
        "singular_shrinkage": time_steps.SINGULAR_SHRINKAGE,
        "worth_growing": step_control.WORTH_GROWING,
        "worth_shrinking": step_control.WORTH_SHRINKING,
        "smallest_error": step_control.SMALLEST_ERROR,
        "remembered_error": step_control.REMEMBERED_ERROR,
        "most_lasting": step_run.MOST_LASTING,
        "real_rate": repr(1.0 / whole.real),
        **method_words(method, "double"),
        **{name: initialiser(values, "double") for name, values in arrays.items()},
    }
