"""Steps in C of motions with friction of exact contact: steps of exported libraries, with functions from Python.

An exported library contains the equations of its model, whose compilation takes seconds. Here the equations are
programs, or functions in machine code; one library serves all models of a size (unknowns, inputs and points of a pair).
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.shared_records import POINTER, Held, raise_what_was_raised
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_forces import Touches
from cosserat_casadi.motion.contact_law import (
    CALL,
    DOUBLE,
    LOOKS,
    MOST_TOUCHES,
    FacingRecord,
    KernelRecord,
    PointsRecord,
    called_in_c,
    function_record,
    give_memory,
    program_record,
    without_compiler,
    words_of_facings,
)
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.facings import points_of
from cosserat_casadi.motion.one_sided import OneSided
from cosserat_casadi.motion.repeated_call import Libraries, RepeatedCall
from cosserat_casadi.motion.step_kernels import MATRICES, StepKernels
from cosserat_casadi.motion.step_words import STAGES, limits_of_steps, words_of_method
from cosserat_casadi.motion.stops_facing import struck_beside_friction
from cosserat_casadi.motion.surface_sliding import functions_of_sliding
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.numerics.motion_equations import Instant

NAME = "rubbing_steps"
"""Name of the library in the cache of compiled code."""

INCLUDED = (
    *("solver.h", "motion.h", "python_kernels.c", "facings.c", "elimination.c", "contact_gaps.c", "contact_ways.c"),
    *("step.c", "contact_steps.c", "contact_friction.c", "square_systems.c", "least_pushes.c", "stage_newton.c"),
    *("motion.c", "struck_rods.h", "struck_rods.c"),
)
"""Files that ``rubbing_steps.c`` includes."""

STATUSES = ("DONE", "NOT_SOLVED", "NOT_FINITE", "SINGULAR", "BAD_STEP", "INCONSISTENT", "NO_ACCELERATION")
"""Statuses of a step in C, in the order of their numbers."""

OUTCOMES = {
    STATUSES.index("DONE"): None,
    STATUSES.index("NOT_FINITE"): StepOutcome.NOT_FINITE,
    STATUSES.index("SINGULAR"): StepOutcome.SINGULAR,
}
"""Outcome for each status number; a step with another status was not solved."""

KNOWN = 4
"""Numbers of a known contact at the start: pair, whether it slides, place, gap; as in ``rubbing_begin``."""

HEAD = 4
"""Numbers at the head of a stretch's row, before the state at its start; as in ``rubbing_steps.c``."""

FARTHEST = 0.02
"""Way of a place of contact along its rod, over the length, in a stretch of a step of SHORT or more.

A rod that rolls out flat loses energy with the cube of this way. The way falls with the square root of shorter steps,
so that the error by the loss falls faster than the steps.
"""

SHORT = 1e-3
"""Size of steps, s, below which the longest way of a place in a stretch is shorter."""

_ONE_AT_A_TIME = threading.RLock()
"""Lock of the motion that takes a step: C has one present model."""


class RubbingModelRecord(ctypes.Structure):
    """A model with its functions, and the stretches of its last step."""

    _fields_ = [
        ("facing_count", ctypes.c_int),
        *((name, POINTER) for name in ("is_shape", "displacements", "facings", "residual", "matrices")),
        *((name, DOUBLE) for name in ("deepest", "farthest")),
        ("gaps", POINTER),
        ("pair_count", ctypes.c_int),
        *((name, POINTER) for name in ("pair_rows", "pair_softness", "pair_closed", "told")),
        ("told_count", ctypes.c_int),
    ]


class Sizes(NamedTuple):
    """Sizes from C.

    They are bytes of memory and workspace; most rows; numbers of a row and its parts; most contacts; numbers of a
    memory that is carried.
    """

    memory: int
    workspace: int
    most_told: int
    row: int
    stretch: int
    touch: int
    touches: int
    carried: int


class RubbingTouch(NamedTuple):
    """A section or a body that touches in a stretch.

    Attributes:
        facing: index of the pair of a rod or body and an obstacle, of a joint and a rigid stop, or of a cable.
        slides: whether the place follows the least gap along the rod; else it is a fixed section, or a body.
        presses: whether a force acts.
        slips: whether the point slips in the stretch; else it sticks.
        is_struck: whether it begins to touch in a blow, at the begin of the stretch.
        place: abscissa X at the begin.
        end_place: abscissa X at the end.
        height: gap that the contact keeps, over the length.
        forces: normal force at both stages, shape (2,), in the force unit of the pair.
        axis: axis whose part along the surface is the first tangent, shape (3,).
        friction: friction at each stage along both tangents, shape (2, 2), in the force unit of the pair.
        impulse: normal impulse of the blow, N s.
    """

    facing: int
    slides: bool
    presses: bool
    slips: bool
    is_struck: bool
    place: float
    end_place: float
    height: float
    forces: FloatArray
    axis: FloatArray
    friction: FloatArray
    impulse: float


class ToldStretch(NamedTuple):
    """A part of a step in which the same sections touch, with one polynomial.

    Attributes:
        size: duration, s.
        taken: energy that a blow at the begin took, J; zero without a blow.
        x: unknowns at the begin, shape (n,).
        v: rates of the unknowns at the begin, after the blow, shape (n,), 1/s.
        unknowns: unknowns of the method at the stages, shape (2, n): accelerations, or algebraic unknowns.
        end: x, v and a at the end, shape (3, n).
        power: power that friction takes from the motion at the stages, shape (2,), W.
        put_in: power of moving inputs against friction at the stages, shape (2,), W.
        touches: sections and bodies that touch.
    """

    size: float
    taken: float
    x: FloatArray
    v: FloatArray
    unknowns: FloatArray
    end: FloatArray
    power: FloatArray
    put_in: FloatArray
    touches: tuple[RubbingTouch, ...]


class RubbingSteps:
    """Steps of the motions of a model.

    Args:
        model: the model, built for a motion, of a scene with friction of exact contact.

    Raises:
        ExportError: there is no compiler, or it fails.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.facings = struck_beside_friction(model)
        # A section of a rod on a rod has two abscissae behind the weights of all points: one more than a section.
        most_points = 1 + max(own.points.count for own in self.facings)
        most_looks = max(LOOKS * (len(own.ends) - 1) + 1 for own in self.facings)
        self._library, self.sizes = _library(model.size, model.inputs.size, _room(most_points), _room(most_looks))
        self._libraries: Libraries | None = None
        self._held = self._record()
        self._told = np.zeros((self.sizes.most_told, self.sizes.row))
        self._held.share("told", self._told)
        self._residual = program_record(model.inverse_dynamics)
        counts_of_bytes = (self.sizes.memory, self.sizes.workspace)
        self._memory, self._workspace = (ctypes.create_string_buffer(count) for count in counts_of_bytes)

    def begin(self, at: Instant, touches: Touches, size: float) -> None:
        """Clear the memory, and begin a motion at an instant, with the contacts that press and the size of steps, s."""
        self._held.record.farthest = FARTHEST * min(1.0, np.sqrt(size / SHORT))
        given = [[touch.facing, touch.slides, touch.place, touch.height] for touch in touches]
        known = np.array(given, dtype=float).reshape(-1, KNOWN)
        accelerations = np.ascontiguousarray(at.a)
        addresses = accelerations.ctypes.data, len(known), known.ctypes.data
        self._library.rubbing_begin(self._memory, *addresses)

    def carried(self) -> FloatArray:
        """The memory after the last step, by which steps go on to the last bit, shape (c,)."""
        numbers = np.zeros(self.sizes.carried)
        self._library.rubbing_carry(self._held.address, self._memory, numbers.ctypes.data, False)
        return numbers

    def go_on(self, carried: FloatArray) -> bool:
        """Continue with the memory of another motion; return False if it belongs to another model."""
        if carried.shape != (self.sizes.carried,):
            return False
        numbers = np.ascontiguousarray(carried)
        self._library.rubbing_carry(self._held.address, self._memory, numbers.ctypes.data, True)
        return True

    def _record(self) -> Held:
        """The record of the model for C, without its functions."""
        model = self.model
        held = Held(RubbingModelRecord(len(self.facings)))
        differential = model.discrete.unknowns.differential
        held.share("is_shape", differential.astype(np.intc))
        held.share("displacements", np.where(differential, displacements(model), 0.0))
        held.record.deepest = float(model.scene.accuracy.tolerance)
        # Rigid pairs have no gap to close: they are among what touches.
        pairs = OneSided(model)
        if pairs.pairs:
            held.record.pair_count = len(pairs.pairs)
            held.share("pair_rows", np.array(pairs.rows, dtype=np.intc))
            held.share("pair_softness", pairs.softness)
            held.share("pair_closed", np.zeros(len(pairs.pairs), dtype=np.intc))
            held.point("gaps", program_record(pairs.gaps_and_gradients))
        return held

    def use(self, kernels: StepKernels) -> None:
        """Make steps call these kernels; functions without machine code become programs if they can."""
        if kernels.libraries != self._libraries:
            self._libraries = kernels.libraries
            self._share_functions(kernels.libraries)
        residual = kernels.residual
        if isinstance(residual, RepeatedCall) and residual.code is not None:
            self._held.point("residual", function_record(residual))
        else:
            self._held.point("residual", self._residual)
        self._held.point("matrices", self._matrices(kernels.jacobians))

    def _share_functions(self, libraries: Libraries) -> None:
        """Write the functions of points, surfaces and sliding into the record of the model."""
        points = {own: own.in_rubbing_steps(libraries) for own in points_of(self.facings)}
        records = [own.record(points[own.points]) for own in self.facings]
        sliding = functions_of_sliding(self.model)
        for number, (held, facing) in enumerate(zip(records, self.facings, strict=True)):
            if facing.against.rubs:
                held.point("rubbing", called_in_c(sliding[number], libraries.residual))
        table = Held((FacingRecord * len(records))(*(held.record for held in records)))
        table.keep(records)
        self._held.point("facings", table)

    def _matrices(self, jacobians: Callable[..., list[FloatArray]]) -> Held:
        size, inputs = self.model.size, self.model.inputs.size
        given, found = np.zeros(3 * (size + inputs)), np.zeros((MATRICES, size * size))
        ends = np.cumsum([size] * 3 + [inputs] * 3)[:-1]

        def evaluate() -> None:
            found[:] = [matrix.ravel(order="F") for matrix in jacobians(*np.split(given, ends))]

        held = Held(KernelRecord())
        give_memory(held, [given], found)
        held.call_back("evaluate", CALL, evaluate)
        return held

    def take(
        self, at: Instant, inputs: Sequence[FloatArray], size: float
    ) -> tuple[StepOutcome | None, list[ToldStretch], tuple[int, int]]:
        """Take a step.

        Args:
            at: instant at which the step begins.
            inputs: inputs, rates and accelerations at the begin, and jerks in the step, shape (k,) each.
            size: duration of the step, s.

        Returns:
            outcome of a failed step, else None; the stretches of the step; numbers of iterations and Jacobians.
        """
        state = np.concatenate([at.x, at.v, at.a])
        given = [np.ascontiguousarray(values, dtype=float) for values in inputs]
        counts = (ctypes.c_int * 2)()
        addresses = [values.ctypes.data for values in given]
        with _ONE_AT_A_TIME:
            status = self._library.rubbing_step(
                self._held.address, *addresses, size, state.ctypes.data, self._memory, self._workspace, counts
            )
            raise_what_was_raised()
        outcome = OUTCOMES.get(status, StepOutcome.NOT_SOLVED)
        told = [] if outcome else [self._stretch(row) for row in self._told[: self._held.record.told_count]]
        return outcome, told, (counts[0], counts[1])

    def _stretch(self, row: FloatArray) -> ToldStretch:
        n, sizes = self.model.size, self.sizes
        size, taken, _, count = row[:HEAD].tolist()
        parts = np.split(row[HEAD : sizes.stretch].copy(), np.cumsum([n, n, STAGES * n, 3 * n, STAGES]))
        x, v, unknowns, end, power, put_in = parts
        of_touches = row[sizes.stretch :].reshape(-1, sizes.touch)[: int(count)]
        touches = tuple(_touch(numbers) for numbers in of_touches.copy())
        return ToldStretch(size, taken, x, v, unknowns.reshape(STAGES, n), end.reshape(3, n), power, put_in, touches)


def _touch(numbers: FloatArray) -> RubbingTouch:
    facing, *flags = numbers[:5].tolist()
    place, end_place, height = numbers[5:8].tolist()
    forces, axis, friction = numbers[8:10], numbers[10:13], numbers[13:17].reshape(2, 2)
    slides, presses, slips, is_struck = map(bool, flags)
    return RubbingTouch(
        int(facing), slides, presses, slips, is_struck, place, end_place, height, forces, axis, friction, numbers[17]
    )


def _room(count: int) -> int:
    """Least power of two that is not below a count: arrays have few sizes, so that few libraries are compiled."""
    return 1 << (count - 1).bit_length()


@lru_cache(maxsize=64)
def _library(unknowns: int, inputs: int, most_points: int, most_looks: int) -> tuple[ctypes.CDLL, Sizes]:
    """The library for models of a size, loaded once in a process; the cache keeps it for other processes."""
    texts = {file: resource("c", file) for file in (f"{NAME}.c", *INCLUDED)}
    texts[f"{NAME}.h"] = render(f"{NAME}.h.in", _words(unknowns, inputs, most_points, most_looks))
    with without_compiler():
        library = ctypes.CDLL(str(compiled_texts(NAME, texts, find_compiler(), INCLUDED)))
    pointers = (POINTER,) * 4
    library.rubbing_begin.argtypes = [POINTER, POINTER, ctypes.c_int, POINTER]
    library.rubbing_carry.argtypes = [POINTER, POINTER, POINTER, ctypes.c_int]
    library.rubbing_step.argtypes = [POINTER, *pointers, DOUBLE, *pointers]
    found = (ctypes.c_longlong * 12)()
    library.rubbing_sizes(found)
    records = (RubbingModelRecord, FacingRecord, PointsRecord, KernelRecord)
    for size, record in zip(found[8:], records, strict=True):
        assert size == ctypes.sizeof(record), record.__name__
    return library, Sizes(*found[:8])


def _words(unknowns: int, inputs: int, most_points: int, most_looks: int) -> dict[str, Any]:
    words = words_of_facings() | {
        "name": "solver",
        "MACRO": "SOLVER",
        "inner": "",
        "unknowns": unknowns,
        "inputs": inputs,
        "input_room": max(inputs, 1),
        "stage_entries": unknowns**2,
        "stage_matrix": unknowns**2,
        "most_motion_entries": MATRICES * unknowns**2,
        "front_room": unknowns,
        "interface_room": 1,
        "steps_in_contact": True,
        "contact_rubs": True,
        "has_stops": False,
        "rods_face_rods": True,
        "what_is_met": "an obstacle or another rod",
        "numbers_moved": 5,
        "most_elements": 1,
        "most_touches": MOST_TOUCHES,
        "most_points": most_points,
        "most_looks": most_looks,
        "pair_words": "as Python numbers them",
        "friction_axes": "axes of the obstacle",
        "motion_status_lines": "  " + ", ".join(f"SOLVER_MOTION_{status}" for status in STATUSES),
        "motion_status_names": "",
    }
    return words | limits_of_steps() | words_of_method()
