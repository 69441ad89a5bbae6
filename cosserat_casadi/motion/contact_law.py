"""The law of exact contact along a motion: records in memory for the C code, which serves models of all sizes."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.listing import LANES
from cosserat_casadi.compiling.matrix_program import matrix_program
from cosserat_casadi.compiling.shared_records import POINTER, Held, address_of, raise_what_was_raised
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.repeated_call import RepeatedCall, repeated
from cosserat_casadi.motion.steps_library import steps_library
from cosserat_casadi.scene.accuracy import MOST_NODES

NAME = "moving_contacts"
"""Name of the library in the cache."""

INCLUDED = (
    *("facings.c", "contact_gaps.c", "struck_rods.h", "struck_rods.c"),
    *("square_systems.c", "least_pushes.c", "python_kernels.c"),
)
"""Files that other libraries include too."""

MOST_TOUCHES = 64
"""Most simultaneous contacts in steps with friction and in exported steps; with more, a step is not solved."""

LOOKS = 100
"""Sections of an element at which gaps are evaluated first, in exported steps too.

With 64, a section next to a pressing end struck 4e-4 of the length away from its true place; with 100 and more, 1e-5.
"""

FAR = 0.02
"""Change of a place, over the length, above which Newton's method may have jumped to another minimum of the gap."""

AT_END = 1e-12
"""Distance from an end, over the length, up to which a place counts as that end."""

NEXT_TO_NOTHING = 1e-30
"""Distance, m, up to which two points coincide: the direction from one to the other is unknown."""

MOST_PLACINGS = 20
"""Most Newton iterations for the place where a gap is least."""

BEYOND = 0.05
"""Distance beyond the ends of a rod and of its elements up to which polynomials are evaluated, over the length."""

OFF = 10.0
"""Gap, over its largest fall up to the next section, above which the rod is taken to be off the obstacle."""

NO_COMPILER = "a motion in exact contact is computed by C code, and {why}"
REMEDY = "{remedy}; or give each obstacle a width, m: contact is smooth then"

KERNEL_ARGUMENTS = 6
"""Most arguments of a function that the law calls."""

CALL = ctypes.CFUNCTYPE(ctypes.c_int)


class KernelRecord(ctypes.Structure):
    """A function, as in ``python_kernels.c``."""

    _fields_ = [
        ("counts", ctypes.c_int * KERNEL_ARGUMENTS),
        ("arguments", POINTER * KERNEL_ARGUMENTS),
        *((name, POINTER) for name in ("result", "code", "code_arguments", "code_results", "integers", "scratch")),
        *((name, POINTER) for name in ("program", "slots")),
        *((name, ctypes.c_int) for name in ("lines", "size")),
        ("run", POINTER),
        ("evaluate", CALL),
    ]


class PointsRecord(ctypes.Structure):
    """Points of a rod or a body, as in ``facings.c``."""

    _fields_ = [
        *((name, ctypes.c_int) for name in ("count", "unknowns", "inputs", "is_known")),
        *((name, POINTER) for name in ("positions", "velocities", "gradient", "hessian", "shares")),
    ]


class FacingRecord(ctypes.Structure):
    """A rod or a body, and an obstacle or another rod, as in ``facings.c``."""

    _fields_ = [
        ("points", POINTER),
        *((name, ctypes.c_int) for name in ("is_body", "elements", "nodes")),
        *((name, ctypes.c_int) for name in ("watches_base", "watches_tip", "laid_count")),
        *((name, POINTER) for name in ("ends", "to_coefficients", "looks", "laid")),
        *((name, ctypes.c_double) for name in ("length", "force_unit", "radius_at_base", "radius_at_tip")),
        *((name, ctypes.c_double) for name in ("restitution", "stride")),
        ("coefficients", ctypes.c_double * 3),
        *((name, POINTER) for name in ("surface", "distance", "rubbing", "fitted", "gaps_along")),
        *((name, POINTER) for name in ("other", "seen_from", "looked_at", "balls")),
    ]


class TouchRecord(ctypes.Structure):
    """A contact, as in ``moving_contacts.c``."""

    _fields_ = [
        ("facing", POINTER),
        ("slides", ctypes.c_int),
        ("element", ctypes.c_int),
        ("place", ctypes.c_double),
        ("height", ctypes.c_double),
    ]


class StepContactsRecord(ctypes.Structure):
    """The contacts of steps, as in ``moving_contacts.c``."""

    _fields_ = [
        ("touches", POINTER),
        *((name, ctypes.c_int) for name in ("count", "unknowns", "base_begin")),
        *((name, POINTER) for name in ("base", "x")),
    ]


GAP_NUMBERS = 20
"""Numbers of a gap before its weights: place, value, slope, bend, normal, curvature, tangent, two counts in one."""

GAP_COUNTS = 19
"""Entry with the two counts: index of the first node of the element, and number of its nodes."""

DOUBLE = ctypes.c_double
ARGUMENTS: dict[str, tuple[Any, Sequence[Any]]] = {
    "gap_at": (None, (POINTER, POINTER, DOUBLE, ctypes.c_int, POINTER)),
    "gap_place": (DOUBLE, (POINTER, POINTER, DOUBLE, ctypes.c_int)),
    "known_positions": (None, (POINTER, POINTER, POINTER)),
    "laid_gaps": (None, (POINTER, POINTER, POINTER)),
    "gap_valleys": (ctypes.c_int, (POINTER, POINTER, DOUBLE, POINTER, POINTER)),
    "lowest_gap": (
        None,
        (POINTER, POINTER, ctypes.c_int, POINTER, POINTER, ctypes.c_int, POINTER, ctypes.c_int, POINTER, POINTER),
    ),
    "touched_gaps": (None, (POINTER, ctypes.c_int, POINTER, POINTER, POINTER)),
    "push_touches": (
        None,
        (POINTER, ctypes.c_int, ctypes.c_int, POINTER, POINTER, POINTER, POINTER, POINTER),
    ),
    "settle_pushes": (
        ctypes.c_int,
        (POINTER, POINTER, ctypes.c_int, DOUBLE, POINTER, POINTER, POINTER),
    ),
}
"""Functions of the contact law in C: type of the result, and types of the arguments."""


@lru_cache(maxsize=1)
def compiled_law() -> ctypes.CDLL:
    """The law, compiled once in a process; the cache keeps it for others.

    Raises:
        ExportError: there is no compiler, or it fails.
    """
    texts = {file: resource("c", file) for file in (f"{NAME}.c", *INCLUDED)}
    texts[f"{NAME}.h"] = render(f"{NAME}.h.in", _words())
    with without_compiler():
        law = ctypes.CDLL(str(compiled_texts(NAME, texts, find_compiler(), INCLUDED)))
        # Surfaces are programs, which the steps run.
        steps_library()
    for name, (result, arguments) in ARGUMENTS.items():
        function = getattr(law, name)
        function.restype, function.argtypes = result, arguments
    records = (KernelRecord, PointsRecord, FacingRecord, TouchRecord, StepContactsRecord)
    for number, record in enumerate(records):
        assert law.contact_records(number) == ctypes.sizeof(record), record.__name__
    return law


@contextmanager
def without_compiler() -> Iterator[None]:
    """Explain the error of a missing or failing compiler: a motion in exact contact needs one."""
    try:
        yield
    except ExportError as error:
        (problem,) = error.problems
        why, remedy = problem.problem, problem.remedy
        raise ExportError(Problem(problem.where, NO_COMPILER.format(why=why), REMEDY.format(remedy=remedy))) from None


def words_of_facings() -> dict[str, Any]:
    """Limits of ``facings.c``, by their names in templates."""
    return {
        "kernel_arguments": KERNEL_ARGUMENTS,
        "looks": LOOKS,
        "most_nodes": MOST_NODES + 1,
        "at_end": AT_END,
        "next_to_nothing": NEXT_TO_NOTHING,
    }


def _words() -> dict[str, Any]:
    return words_of_facings() | {
        "base_unknowns": POSE_SIZE,
        "most_placings": MOST_PLACINGS,
        "far": FAR,
        "beyond": BEYOND,
        "off": OFF,
    }


def called(name: str, *arguments: Any) -> Any:
    """Call a function of the contact law in C."""
    result = getattr(compiled_law(), name)(*arguments)
    raise_what_was_raised()
    return result


def least_pushes(compliance: FloatArray, rates: FloatArray, tolerance: float) -> FloatArray | None:
    """Solve the linear complementarity problem f ≥ 0, q + W f ≥ 0, fᵀ (q + W f) = 0 for the forces f, shape (m,).

    Args:
        compliance: W, symmetric and positive semidefinite up to the units of the forces, shape (m, m).
        rates: opening rates q without forces, shape (m,).
        tolerance: rate below zero that counts as zero.

    Returns:
        the forces; None if rounding keeps them from settling. Constraints that no forces can stop close all the same.
    """
    count = len(rates)
    forces = np.zeros(count)
    if not count:
        return forces
    # C reads matrices column after column.
    given = [np.asfortranarray(values, dtype=float) for values in (compliance, rates)]
    room, integers = np.zeros(2 * count * (count + 1)), np.zeros(3 * count, dtype=np.intc)
    at, of_rates = (values.ctypes.data for values in given)
    results = [values.ctypes.data for values in (forces, room, integers)]
    return forces if called("settle_pushes", at, of_rates, count, tolerance, *results) else None


@lru_cache(maxsize=1)
def gap_size() -> int:
    """Numbers that a gap takes in memory: for a section, then for the nearest section of another rod, if there is one.

    Both parts reserve weights for the largest number of nodes of an element.
    """
    return int(compiled_law().contact_records(5)) // ctypes.sizeof(DOUBLE)


def function_record(call: RepeatedCall) -> Held:
    """Make the record with which C calls a function of a model: in machine code, or by CasADi's virtual machine."""
    held = Held(KernelRecord())
    record = held.record
    give_memory(held, call.arguments, call.results[0])
    if call.code is not None:
        record.code = call.code.address
        for name, array in (("code_arguments", call.code.arguments), ("code_results", call.code.results)):
            held.share(name, array)
        held.share("integers", call.code.integers)
        held.share("scratch", call.code.scratch)
    held.call_back("evaluate", CALL, call.evaluate)
    held.keep(call)
    return held


def program_record(function: ca.Function) -> Held:
    """Make the record with which C calls a function with one result: as a program, or by CasADi's virtual machine."""
    program = matrix_program(function)
    if program is None:
        return function_record(RepeatedCall(function))
    held = Held(KernelRecord())
    record = held.record
    give_memory(held, [np.zeros(function.nnz_in())], np.zeros(function.nnz_out()))
    held.share("program", program.in_c)
    held.share("slots", np.repeat(program.slots, LANES))
    record.lines, record.size = len(program.lines), function.nnz_out()
    record.run = address_of(steps_library().program_run)
    return held


def called_in_c(function: ca.Function, library: str | None) -> Held:
    """Make the record with which C calls a function: from a shared object, or without one as a program."""
    return function_record(repeated(function, library)) if library is not None else program_record(function)


def give_memory(held: Held, arguments: Sequence[FloatArray], result: FloatArray) -> None:
    """Make the record of a function point to its arguments and its result."""
    record = held.record
    for number, array in enumerate(arguments):
        held.keep(array)
        record.arguments[number] = array.ctypes.data
        record.counts[number] = len(array)
    held.share("result", result)
