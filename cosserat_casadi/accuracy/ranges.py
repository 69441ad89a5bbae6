"""The ranges for which a discretisation is chosen: from the caller, from the scene, or by a documented scale.

The default range of an input about the scene's value turns a rod by about a radian from end to end, by the linear
response of the unloaded scene. So a force F at the tip of a clamped rod is taken up to 2 EI/ℓ². The range is equal in
every direction, by the softest one: a flat strip under an edgewise force that would bend it by a radian would be
twisted extremely. In closed loops 2 EI/ℓ² of the softest rod is taken: a loop is so much stiffer than its rods that a
load that turns these by a radian may have no equilibrium. Contact is ignored: a rod on an obstacle bends less than
assumed here.

Tensions and pressures begin at zero. Lengths change by a tenth at most, gravity keeps its size, and bases move by a
tenth of the longest rod. A base turns in every direction if nothing else holds the rods, else by a fifth of a radian
about each axis. Parameters keep their values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise, nodes_for
from cosserat_casadi.model.input_bounds import limits_of, narrowed, physical_range
from cosserat_casadi.model.inputs import Input
from cosserat_casadi.model.load_cases import CaseLayout, case_layout, fault_of_ends, no_column
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.rod.strain import DiscreteRod

TURN = 1.0
"""Turn of a rod from end to end by the scale of an input, rad."""

STRETCH = 0.1
"""Largest relative change of a length; displacement of a base over the longest rod."""

TILT = 0.1
"""Change of each entry of the unit quaternion of a base that may only tilt: half an angle in rad."""

GRAVITY = 9.81
"""Acceleration for a scene with zero gravity, m/s²."""

RESPONSE_MODES = 4
"""Modes of every strain on which the response of the unloaded scene is computed."""

Given = Mapping[str, npt.ArrayLike]
"""Pairs of lower and upper end by column, such as ``push.force.x``, or by the name of an input or a parameter."""


MIDDLES = (np.arange(100) + 0.5) / 100
"""Abscissae of sections at which turns are summed up."""

STEP = 1e-3
"""Relative change of an input for its response."""


class Origin(Enum):
    """Where the range of an entry comes from, in words."""

    ASKED = "asked for"
    RANGES = "[ranges]"
    CHOSEN_FOR = "accuracy.chosen_for"
    BOUNDS = "[[bounds]]"
    PHYSICS = "all that it can be"
    TURN = "turns a rod by about a radian"
    LENGTH = "a tenth of the length"
    GRAVITY = "gravity in any direction"
    BASE = "a tenth of the longest rod"
    TILT = "tilts by a fifth of a radian"
    DIRECTION = "any direction"
    VALUE = "the scene's value"


Entries = dict[int, tuple[float, float, Origin]]
"""Ends and origin by the index of an entry."""


@dataclass(frozen=True)
class CaseRanges:
    """Ranges of the inputs and the parameters of a scene, entry by entry.

    Attributes:
        layout: inputs and parameters.
        lower: least values, shape (size of a case,).
        upper: largest values, shape (size of a case,), equal to the least value for an entry that keeps its value.
        origins: where each range comes from.
    """

    layout: CaseLayout
    lower: FloatArray
    upper: FloatArray
    origins: tuple[Origin, ...]

    @property
    def moving(self) -> npt.NDArray[np.intp]:
        """Indices of the entries with different ends."""
        return np.flatnonzero(self.lower < self.upper)

    def where_still(self, others: CaseRanges) -> CaseRanges:
        """These ranges, with the others' range for entries that keep their value."""
        still = self.lower == self.upper
        lower = np.where(still, others.lower, self.lower)
        upper = np.where(still, others.upper, self.upper)
        pairs = zip(still.tolist(), self.origins, others.origins, strict=True)
        origins = tuple(other if is_still else own for is_still, own, other in pairs)
        return replace(self, lower=lower, upper=upper, origins=origins)

    @property
    def described(self) -> tuple[str, ...]:
        """``column=low:high`` of every entry that does not keep the scene's value."""
        return tuple(line for line, _ in self.with_origins())

    def with_origins(self) -> Iterator[tuple[str, Origin]]:
        """``column=low:high`` of every entry that does not keep the scene's value, with the origin of its range."""
        changed = (self.lower < self.upper) | (self.lower != self.layout.default)
        for column, k in self.layout.columns.items():
            if changed[k]:
                yield f"{column}={self.lower[k]:.6g}:{self.upper[k]:.6g}", self.origins[k]


def input_ranges(scene: scenes.Scene, given: Given | None = None) -> CaseRanges:
    """The range of every free input and every parameter, and its origin.

    It is the given range, else from the scene's table of ranges, else the range its modes were chosen for, else its
    bounds, else the scale of the input. If modes were chosen for ranges, entries without such a range keep their value.

    Args:
        scene: a validated scene.
        given: given pairs of lower and upper end.

    Raises:
        SceneError: with every fault: a range of an unknown input, ends that are equal, reversed or not finite, or a
            wrong number of pairs.
    """
    layout = case_layout(scene)
    asked = _entries(layout, given or {}, Origin.ASKED, "--range")
    in_table = _entries(layout, scene.ranges, Origin.RANGES, "ranges")
    chosen = _entries(layout, scene.accuracy.chosen_ranges, Origin.CHOSEN_FOR, "accuracy.chosen_for")
    known = {**(chosen or _bounded(scene, layout)), **in_table, **asked}
    if not chosen:
        without = [k for k in range(layout.inputs.size) if k not in known]
        known |= _scales(scene, layout, without)
    lower = layout.default.copy()
    upper = layout.default.copy()
    origins = [Origin.VALUE] * len(lower)
    for k, (low, high, origin) in known.items():
        lower[k] = low
        upper[k] = high
        origins[k] = origin
    return CaseRanges(layout, lower, upper, tuple(origins))


def ranges_of_cases(layout: CaseLayout, rows: FloatArray) -> CaseRanges:
    """The ranges spanned by load cases, shape (count, size of a case)."""
    return CaseRanges(layout, rows.min(axis=0), rows.max(axis=0), (Origin.ASKED,) * rows.shape[1])


def _entries(layout: CaseLayout, given: Given, origin: Origin, where: str) -> Entries:
    """Ranges by the index of the entry.

    Args:
        layout: inputs and parameters.
        given: pairs by column or by name.
        origin: origin of these ranges.
        where: their source, for error messages.

    Raises:
        SceneError: with every fault.
    """
    problems: list[Problem] = []
    entries: Entries = {}
    spans = layout.spans
    for name, value in given.items():
        if name in layout.columns:
            span = slice(layout.columns[name], layout.columns[name] + 1)
        elif name in spans:
            span = spans[name]
        else:
            problems.append(no_column(where, name, layout.columns))
            continue
        pairs = np.atleast_2d(np.asarray(value, dtype=float))
        size = span.stop - span.start
        if pairs.shape not in ((1, 2), (size, 2)):
            counted = "1 pair" if size == 1 else f"1 pair or {size}"
            problems.append(Problem(where, f"{name} must have {counted} of ends, got shape {pairs.shape}"))
            continue
        # Modes may have been chosen for a single value of an entry; the reader of scenes has checked all else.
        if origin is not Origin.CHOSEN_FOR:
            faults = [fault_of_ends(where, name, low, high) for low, high in pairs.tolist()]
            problems.extend(fault for fault in faults if fault is not None)
        for k, (low, high) in enumerate(np.broadcast_to(pairs, (size, 2)).tolist()):
            entries[span.start + k] = (low, high, origin)
    refuse(problems)
    return entries


def _bounded(scene: scenes.Scene, layout: CaseLayout) -> Entries:
    """Ranges of entries that physics or the scene bounds on both sides."""
    lower, upper = narrowed(layout.inputs, scene.bounds)
    least, most = physical_range(layout.inputs)
    both = np.flatnonzero(np.isfinite(lower) & np.isfinite(upper) & (lower < upper))
    found: Entries = {}
    for k in both.tolist():
        is_narrowed = lower[k] > least[k] or upper[k] < most[k]
        origin = Origin.BOUNDS if is_narrowed else Origin.PHYSICS
        found[k] = (float(lower[k]), float(upper[k]), origin)
    return found


def _scales(scene: scenes.Scene, layout: CaseLayout, entries: Sequence[int]) -> Entries:
    """Ranges of entries by their effect on the unloaded scene, within one-sided bounds of the scene."""
    if not entries:
        return {}
    bare = without_contacts(scene.baked())
    model = build(bare, discretise(bare, RESPONSE_MODES, nodes_for(RESPONSE_MODES)))
    lower, upper = narrowed(layout.inputs, limits_of(scene))
    found: Entries = {}
    for entry, span in layout.inputs:
        turn = max(_turns(model, span))
        for k in range(span.start, span.stop):
            if k not in entries:
                continue
            low, high, origin = _scale(model, entry, turn, k - span.start)
            low = max(low, float(lower[k]))
            high = min(high, float(upper[k]))
            if low < high:
                found[k] = (low, high, origin)
    return found


def _scale(model: Model, entry: Input, turn: float, component: int) -> tuple[float, float, Origin]:
    """Default ends of the range of an entry, and their origin.

    Args:
        model: model of the scene with modes for its response.
        entry: the input.
        turn: largest turn of a rod by an entry of the input, rad per unit.
        component: index of the entry.
    """
    value = float(entry.default.ravel(order="F")[component])
    if entry.field == "base.position":
        move = STRETCH * max(rod.length for rod in model.discrete.rods.values())
        return value - move, value + move, Origin.BASE
    if entry.field == "base.quaternion":
        if model.discrete.unknowns.count(BlockKind.MULTIPLIER):
            return value - TILT, value + TILT, Origin.TILT
        return -1.0, 1.0, Origin.DIRECTION
    reach = TURN / turn if turn > 0.0 else _bending_size(model, entry)
    if entry.field == "length":
        stretch = STRETCH * value
        if turn == 0.0 or stretch <= reach:
            return value - stretch, value + stretch, Origin.LENGTH
    if entry.unit == "m/s²":
        size = float(np.linalg.norm(entry.default)) or GRAVITY
        if size <= reach:
            return -size, size, Origin.GRAVITY
    if entry.declared.lower == 0.0:
        return 0.0, value + reach, Origin.TURN
    return value - reach, value + reach, Origin.TURN


def _turns(model: Model, span: slice) -> Iterator[float]:
    """Largest turn of a rod by each entry of an input, rad per unit of the entry."""
    inputs = model.pack()
    at_values = _response(model, inputs)
    for k in range(span.start, span.stop):
        moved = inputs.copy()
        # The response is affine in the inputs.
        step = max(abs(inputs[k]), 1.0) * STEP
        moved[k] += step
        change = (_response(model, moved) - at_values) / step
        rods = model.discrete.rods.items()
        of_rods = [_turn(rod, change[model.discrete.unknowns.strain(name)]) for name, rod in rods]
        yield max(of_rods)


def _response(model: Model, inputs: FloatArray) -> FloatArray:
    """Linear response of the unloaded scene to inputs, shape (model.size,)."""
    return np.asarray(model.path_tangent(inputs).full()[:, 0])


def _turn(rod: DiscreteRod, strains: FloatArray) -> float:
    """ℓ ∫ |K| dX for strain coordinates, rad: the turn from end to end of a rod that bends in one direction."""
    curvatures = np.zeros((len(MIDDLES), 3))
    for component, columns in rod.columns.items():
        if component < 3:
            curvatures[:, component] = rod.strain_of(component, MIDDLES) @ strains[columns]
    return float(rod.length * np.linalg.norm(curvatures, axis=1).mean())


def _bending_size(model: Model, entry: Input) -> float:
    """Load that bends the softest rod by a radian at its tip, in the unit of an input without a response.

    Loads in closed loops have no response in the unloaded scene, since joints close along the load path.
    """
    softest = min(model.discrete.rods.values(), key=lambda rod: rod.energy_unit / rod.length)
    force = 2 * softest.energy_unit / softest.length
    sizes = {"N": force, "N m": force * softest.length, "N/m": force / softest.length}
    return sizes.get(entry.unit, 1.0)
