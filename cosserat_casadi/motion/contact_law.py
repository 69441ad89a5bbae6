"""The law of exact contact along a motion, which C computes for models of all sizes; here are its records in memory."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import lru_cache
from importlib import import_module
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.repeated_call import Program, RepeatedCall

KERNEL_ARGUMENTS = 3
"""Arguments of a function that the law asks for, at most."""

LANES = 4
"""Lanes of a slot of a program."""

PROVIDER = "cosserat_casadi.codegen.moving_contacts"
"""The module that compiles the law; it stands above motions, and is loaded where one of them touches something."""

POINTER = ctypes.c_void_p
CALL = ctypes.CFUNCTYPE(ctypes.c_int)


class CompiledLaw(NamedTuple):
    """The law in C.

    Attributes:
        library: has its functions.
        run: address of the function that runs programs of scalars.
        program: program of a function of scalars; None where it has an instruction that no program has.
    """

    library: ctypes.CDLL
    run: int
    program: Callable[[ca.Function], Program | None]


class KernelRecord(ctypes.Structure):
    """A function; as in ``moving_contacts.c``, like the records below."""

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
    """Points of a rod or a body."""

    _fields_ = [
        ("count", ctypes.c_int),
        ("is_known", ctypes.c_int),
        ("positions", POINTER),
        ("gradient", POINTER),
    ]


class FacingRecord(ctypes.Structure):
    """A rod or a body, and an obstacle."""

    _fields_ = [
        ("points", POINTER),
        *((name, ctypes.c_int) for name in ("is_body", "elements", "nodes")),
        *((name, ctypes.c_int) for name in ("watches_base", "watches_tip", "laid_count")),
        *((name, POINTER) for name in ("ends", "to_coefficients", "looks", "laid")),
        *((name, ctypes.c_double) for name in ("length", "radius_at_base", "radius_at_tip")),
        *((name, POINTER) for name in ("surface", "distance", "coefficients", "gaps_along")),
    ]


class TouchRecord(ctypes.Structure):
    """A contact."""

    _fields_ = [
        ("facing", POINTER),
        ("slides", ctypes.c_int),
        ("element", ctypes.c_int),
        ("place", ctypes.c_double),
        ("height", ctypes.c_double),
    ]


class StepContactsRecord(ctypes.Structure):
    """The contacts of steps."""

    _fields_ = [
        ("touches", POINTER),
        *((name, ctypes.c_int) for name in ("count", "unknowns", "base_begin")),
        *((name, POINTER) for name in ("base", "x")),
    ]


class ValleyRecord(ctypes.Structure):
    """A section whose gap is the least about it."""

    _fields_ = [(name, ctypes.c_double) for name in ("place", "value", "slope", "bend")]


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
    "looked_gaps": (None, (POINTER, POINTER, POINTER)),
    "gap_valleys": (ctypes.c_int, (POINTER, POINTER, DOUBLE, POINTER)),
    "lowest_gap": (
        None,
        (POINTER, POINTER, ctypes.c_int, POINTER, ctypes.c_int, POINTER, ctypes.c_int, POINTER),
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

_RAISED: list[BaseException] = []
"""Exceptions of functions of Python that C has called."""


@lru_cache(maxsize=1)
def compiled_law() -> CompiledLaw:
    """The law, compiled once in a process; the cache keeps it for others.

    Raises:
        ExportError: there is no compiler, or it fails.
    """
    law: CompiledLaw = import_module(PROVIDER).compiled_law()
    for name, (result, arguments) in ARGUMENTS.items():
        function = getattr(law.library, name)
        function.restype, function.argtypes = result, arguments
    records = (KernelRecord, PointsRecord, FacingRecord, TouchRecord, StepContactsRecord)
    for number, record in enumerate(records):
        assert law.library.contact_records(number) == ctypes.sizeof(record), record.__name__
    return law


def called(name: str, *arguments: Any) -> Any:
    """The result of a function of the law."""
    result = getattr(compiled_law().library, name)(*arguments)
    raise_what_was_raised()
    return result


def raise_what_was_raised() -> None:
    """Raise what Python raised where C called it."""
    if _RAISED:
        raise _RAISED.pop()


def address_of(name: str) -> int:
    """Where a function of the law is in memory."""
    address = ctypes.cast(getattr(compiled_law().library, name), ctypes.c_void_p).value
    assert address is not None, "a function has an address"
    return address


def least_pushes(compliance: FloatArray, rates: FloatArray, tolerance: float) -> FloatArray | None:
    """Forces f of constraints that open at rates q + W f: f ≥ 0, q + W f ≥ 0, one of both zero, shape (m,).

    Args:
        compliance: W, symmetric and positive semidefinite but for units of the forces, shape (m, m).
        rates: q, shape (m,).
        tolerance: rate below zero that counts as none.

    Returns:
        the forces; None where rounding keeps them from settling. Constraints that no forces stop close all the same.
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
    """Numbers that a gap takes in memory, with weights of as many nodes as an element may have."""
    return int(compiled_law().library.contact_records(5)) // ctypes.sizeof(DOUBLE)


class Held:
    """A record that C reads, and the arrays and functions that it points at.

    Args:
        record: the record.

    Attributes:
        record: the record.
        address: of it.
    """

    def __init__(self, record: Any) -> None:
        self.record = record
        self.address = ctypes.addressof(record)
        self._kept: list[Any] = []

    def share(self, name: str, array: np.ndarray[Any, Any]) -> None:
        """Have a member of the record point at an array."""
        self._kept.append(array)
        setattr(self.record, name, array.ctypes.data)

    def point(self, name: str, held: Held) -> None:
        """Have a member of the record point at another record."""
        self._kept.append(held)
        setattr(self.record, name, held.address)

    def keep(self, held: Any) -> None:
        """Keep what the record has the address of."""
        self._kept.append(held)


def function_record(call: RepeatedCall) -> Held:
    """A function of a model as the law calls it: in machine code, or by CasADi's virtual machine."""
    held = Held(KernelRecord())
    record = held.record
    _give_memory(held, call.arguments, call.results[0])
    if call.code is not None:
        record.code = call.code.address
        for name, array in (("code_arguments", call.code.arguments), ("code_results", call.code.results)):
            held.share(name, array)
        held.share("integers", call.code.integers)
        held.share("scratch", call.code.scratch)
    _have_evaluated(held, call)
    held.keep(call)
    return held


def surface_record(function: ca.Function) -> Held:
    """A small function of a point as the law calls it: as a program, or by CasADi's virtual machine."""
    law = compiled_law()
    program = law.program(function)
    if program is None:
        return function_record(RepeatedCall(function))
    held = Held(KernelRecord())
    record = held.record
    lines, slots, _ = program
    _give_memory(held, [np.zeros(function.nnz_in())], np.zeros(function.nnz_out()))
    held.share("program", np.ascontiguousarray(lines))
    held.share("slots", np.repeat(slots, LANES))
    record.lines, record.size, record.run = len(lines), function.nnz_out(), law.run
    return held


def _give_memory(held: Held, arguments: Sequence[FloatArray], result: FloatArray) -> None:
    record = held.record
    for number, array in enumerate(arguments):
        held.keep(array)
        record.arguments[number] = array.ctypes.data
        record.counts[number] = len(array)
    held.share("result", result)


def _have_evaluated(held: Held, call: RepeatedCall) -> None:
    def evaluate() -> int:
        try:
            call.evaluate()
        except BaseException as raised:
            _RAISED.append(raised)
            return 1
        return 0

    wrapped = CALL(evaluate)
    held.keep(wrapped)
    held.record.evaluate = wrapped
