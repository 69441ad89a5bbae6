"""The law of exact contact along a motion, which C computes for models of all sizes; here are its records in memory."""

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
from cosserat_casadi.compiling.scalar_program import scalar_program
from cosserat_casadi.compiling.shared_records import POINTER, Held, address_of, raise_what_was_raised
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.calls import chooses
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
"""Sections that may touch at once in steps with friction and in exported ones; of more, a step is not solved."""

LOOKS = 100
"""Sections of an element at which gaps are looked at first, in exported steps too.

With 64 a section beside an end that presses struck 4e-4 of the length from where it does, with 100 and more 1e-5.
"""

FAR = 0.02
"""Change of a place, over the length, from which on Newton's method is not believed to have stayed at one minimum."""

AT_END = 1e-12
"""Distance from an end, over the length, at which a place is that end."""

NEXT_TO_NOTHING = 1e-30
"""Distance, m, of two points that are one: the direction from one to the other is unknown."""

MOST_PLACINGS = 20
"""Newton iterations for the place where a gap is least."""

BEYOND = 0.05
"""How far beyond the ends of a rod and of its elements polynomials are followed, over the length."""

OFF = 10.0
"""Gap of a section, over the largest fall of the gap up to the next one, from which on the rod is off the obstacle."""

NO_COMPILER = "a motion in exact contact is computed by C code, and {why}"
REMEDY = "{remedy}; or give each obstacle a width, m: contact is smooth then"

KERNEL_ARGUMENTS = 6
"""Arguments of a function that the law asks for, at most."""

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
"""Numbers of a gap before the weights: place, value, slope, bend, normal, curvature, tangent, and two counts in one."""

GAP_COUNTS = 19
"""The entry that the two counts are in: the first node of the element, and their number."""

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
"""Functions of the law: result, and arguments."""


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
    """Tell where there is no compiler, or it fails, that a motion in exact contact needs one."""
    try:
        yield
    except ExportError as error:
        (problem,) = error.problems
        why, remedy = problem.problem, problem.remedy
        raise ExportError(Problem(problem.where, NO_COMPILER.format(why=why), REMEDY.format(remedy=remedy))) from None


def words_of_facings() -> dict[str, Any]:
    """Limits of ``facings.c`` by their names in templates."""
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
    """The result of a function of the law."""
    result = getattr(compiled_law(), name)(*arguments)
    raise_what_was_raised()
    return result


def least_pushes(compliance: FloatArray, rates: FloatArray, tolerance: float) -> FloatArray | None:
    """Forces f of constraints that open at rates q + W f: f ≥ 0, q + W f ≥ 0, one of both zero, shape (m,).

    Args:
        compliance: W, symmetric and positive semidefinite but for units of the forces, shape (m, m).
        rates: q, shape (m,).
        tolerance: rate below zero that counts as none.

    Returns:
        the forces; None where rounding keeps them from settling. Constraints that no forces stop close anyway.
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
    """Numbers that a gap takes in memory: of a section, then of the nearest section of another rod, if there is one.

    Both have weights of as many nodes as an element may have.
    """
    return int(compiled_law().contact_records(5)) // ctypes.sizeof(DOUBLE)


def function_record(call: RepeatedCall) -> Held:
    """A function of a model as the law calls it: in machine code, or by CasADi's virtual machine."""
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
    """A function with one result as C calls it: as a program, or by CasADi's virtual machine."""
    program = scalar_program(function)
    if program is None:
        return function_record(RepeatedCall(function))
    held = Held(KernelRecord())
    record = held.record
    lines, slots, _ = program
    give_memory(held, [np.zeros(function.nnz_in())], np.zeros(function.nnz_out()))
    held.share("program", np.ascontiguousarray(lines))
    held.share("slots", np.repeat(slots, LANES))
    record.lines, record.size = len(lines), function.nnz_out()
    record.run = address_of(steps_library().program_run)
    return held


def called_in_c(function: ca.Function, library: str | None) -> Held:
    """A function from a shared object as C calls it; without a shared object as a program."""
    if library is not None:
        return function_record(repeated(function, library))
    return program_record(function if chooses(function) else function.expand())


def give_memory(held: Held, arguments: Sequence[FloatArray], result: FloatArray) -> None:
    """Have the record of a function point at its arguments and its result."""
    record = held.record
    for number, array in enumerate(arguments):
        held.keep(array)
        record.arguments[number] = array.ctypes.data
        record.counts[number] = len(array)
    held.share("result", result)
