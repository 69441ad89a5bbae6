"""Contacts during a stretch of a motion between two events: their unknown forces in the equations of motion.

A contact is a body, or the stretch of a rod about the section where its gap to an obstacle is least. That least gap is
a function of the unknowns; while the contact lasts it is zero, and a force along its gradient, unknown, keeps it so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from cosserat_casadi.compiling.shared_records import Held
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_gap import FLATTEST, Facing, SectionGap
from cosserat_casadi.motion.contact_law import FAR, StepContactsRecord, TouchRecord, called, function_record, gap_size
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.moving_points import MovingPoints
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.numerics.motion_equations import MotionEquations, Residual


class MovingContact(NamedTuple):
    """A contact of a rod or a body with an obstacle or a rod, during a stretch of a motion.

    Attributes:
        facing: index, in the list of pairs that may touch, of the pair of this rod and this obstacle.
        place: abscissa X of the section that touches, where the contact was last looked at.
        slides: whether the contact follows the section whose gap is least; else it stays at one section, or is of a
            body.
        height: gap, over the length, that the contact keeps, below the largest gap that counts as touching.
        element: number of the element in which the contact slides; None for the element of its place.
    """

    facing: int
    place: float
    slides: bool
    height: float = 0.0
    element: int | None = None


Touches = tuple[MovingContact, ...]
"""The contacts of a stretch of a motion, with the places where it begins."""


class Followed(NamedTuple):
    """Places of contacts after they were followed to a state.

    Attributes:
        places: abscissae, one for each contact.
        gaps: gaps of the contacts there, over the length of their rods.
        gone: whether a contact has jumped, see :meth:`Follower.gone`, one for each contact.
    """

    places: list[float]
    gaps: list[SectionGap]
    gone: list[bool]


class Follower:
    """Tracker of the places of contacts along a motion; it searches for each one next to its last place.

    Args:
        facings: rods and obstacles that may touch.
        touches: the contacts.

    Attributes:
        facings: pair of each contact; empty in a pickled copy, which holds the places alone.
        touches: the contacts.
        places: last abscissa of each contact.
        elements: number of the element in which each slides; its polynomials are evaluated a little beyond its ends.
    """

    def __init__(self, facings: Sequence[Facing], touches: Touches) -> None:
        self.facings = [facings[touch.facing] for touch in touches]
        self.touches = touches
        self.places = [touch.place for touch in touches]
        self.elements = [
            facing.element(touch.place) if touch.element is None else touch.element
            for facing, touch in zip(self.facings, touches, strict=True)
        ]

    def __getstate__(self) -> dict[str, Any]:
        # Their functions are those of one process; a motion that goes on has its own.
        return {name: value for name, value in vars(self).items() if name != "_in_law"} | {"facings": []}

    @cached_property
    def _in_law(self) -> Held:
        """The contacts as records of the contact law in C."""
        records = (TouchRecord * len(self.touches))()
        held = Held(records)
        for record, facing, touch, element in zip(records, self.facings, self.touches, self.elements, strict=True):
            record.facing, record.slides = facing.in_law.address, touch.slides
            record.element, record.height = element, touch.height
            held.keep(facing.in_law)
        return held

    def at_places(self) -> int:
        """Return the address of the records of the contacts, in which C finds the places to search next to."""
        for record, place in zip(self._in_law.record, self.places, strict=True):
            record.place = place
        return self._in_law.address

    def follow(self, x: FloatArray, inputs: FloatArray) -> Followed:
        """Follow the contacts to a state of the motion; the next search starts from the places there.

        A contact that has jumped is still searched for where it was.
        """
        places, gaps = self.gaps(x, inputs)
        gone = self.gone(x, inputs, places)
        kept = zip(places, self.places, gone, strict=True)
        self.places = [old if is_gone else new for new, old, is_gone in kept]
        # Steps in C go on from there.
        self.at_places()
        return Followed(places, gaps, gone)

    def gone(self, x: FloatArray, inputs: FloatArray, places: Sequence[float]) -> list[bool]:
        """Tell which contacts have jumped: their place is far from the last one, where the gap is convex no longer.

        A contact that slides fast may move as far between two states, but the gap stays convex all the way.

        Args:
            x: unknowns, shape (n,).
            inputs: stacked inputs, shape (m,).
            places: abscissae of the contacts at the state.
        """
        found = []
        for facing, element, old, new in zip(self.facings, self.elements, self.places, places, strict=True):
            is_far = abs(new - old) > FAR
            found.append(is_far and facing.at(facing.nodes(x, inputs), old, element).bend <= FLATTEST)
        return found

    def gaps(self, x: FloatArray, inputs: FloatArray) -> tuple[list[float], list[SectionGap]]:
        """Places and gaps of the contacts."""
        if not self.touches:
            return [], []
        memory = np.empty((len(self.touches), gap_size()))
        at = [np.ascontiguousarray(values, dtype=float) for values in (x, inputs)]
        addresses = [values.ctypes.data for values in (*at, memory)]
        called("touched_gaps", self.at_places(), len(self.touches), *addresses)
        gaps = [facing.gap(own) for facing, own in zip(self.facings, memory, strict=True)]
        return memory[:, 0].tolist(), gaps

    def gradients(self, x: FloatArray, inputs: FloatArray, gaps: Sequence[SectionGap]) -> FloatArray:
        """Gradients of the gaps of the contacts with respect to the unknowns, shape (m, n)."""
        own = [facing.gradient(x, inputs, gap) for facing, gap in zip(self.facings, gaps, strict=True)]
        return np.array(own).reshape(len(gaps), len(x))

    def pushes(self, gradients: FloatArray) -> FloatArray:
        """Generalised forces of unit contact forces in the balances, shape (m, n), from the gradients of the gaps."""
        if all(facing.points.shares is None for facing in self.facings):
            return gradients
        return np.array([facing.points.in_balances(own) for facing, own in zip(self.facings, gradients, strict=True)])

    def open_by(self, gaps: Sequence[SectionGap]) -> list[float]:
        """Gaps minus the heights that the contacts keep, over the length, one for each contact."""
        return [gap.value - touch.height for gap, touch in zip(gaps, self.touches, strict=True)]

    def pushed(self, gaps: Sequence[SectionGap], forces: FloatArray) -> dict[MovingPoints, FloatArray]:
        """Forces of all contacts on the points of each rod or body, stacked point by point.

        Args:
            gaps: gaps of the contacts.
            forces: forces of the contacts, shape (m,).
        """
        pushed: dict[MovingPoints, FloatArray] = {}
        for facing, gap, force in zip(self.facings, gaps, forces, strict=True):
            pushed[facing.points] = pushed.get(facing.points, 0.0) + force * facing.weights(gap)
        return pushed

    def rows(self, rows: FloatArray, x: FloatArray, inputs: FloatArray, forces: FloatArray) -> FloatArray:
        """Equations of motion with the contact forces, followed by the excess of each gap, shape (n + m,).

        Args:
            rows: equations of motion without contact, shape (n,).
            x: unknowns, shape (n,).
            inputs: stacked inputs, shape (k,).
            forces: forces of the contacts, shape (m,).
        """
        count, size = len(self.touches), len(rows)
        both = np.append(rows, np.zeros(count))
        at = [np.ascontiguousarray(values, dtype=float) for values in (x, inputs, forces)]
        addresses = [values.ctypes.data for values in (*at, both, both[size:])]
        called("push_touches", self.at_places(), count, size, *addresses)
        return both

    def curvature(
        self, x: FloatArray, inputs: FloatArray, gaps: Sequence[SectionGap], forces: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Derivative of the contact terms of the equations by the unknowns, (n, n), and gradients of the gaps, (m, n).

        The derivative is the sum of forces times second derivatives of gaps, in units of the equations.

        Args:
            x: unknowns, shape (n,).
            inputs: stacked inputs, shape (k,).
            gaps: gaps of the contacts.
            forces: forces of the contacts, shape (m,).
        """
        total = np.zeros((len(x), len(x)))
        gradients = np.zeros((len(gaps), len(x)))
        moved = {points: points.jacobian(x, inputs) for points in {facing.points for facing in self.facings}}
        for points, weights in self.pushed(gaps, forces).items():
            total += points.in_balances(points.hessian(x, inputs, weights))
        for number, (facing, touch, gap, force) in enumerate(
            zip(self.facings, self.touches, gaps, forces, strict=True)
        ):
            by_nodes = moved[facing.points]
            gradients[number] = facing.weights(gap) @ by_nodes.reshape(-1, len(x))
            turning = facing.turning(by_nodes, gap, slides=touch.slides)
            total += force * facing.points.in_balances(turning)
        return total, gradients

    def rates(self, x: FloatArray, v: FloatArray, inputs: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
        """Rates of the gaps, 1/s, and their second rates at zero accelerations of the unknowns, 1/s², shape (m,) each.

        Args:
            x: unknowns, shape (n,).
            v: rates of the unknowns, shape (n,), 1/s.
            inputs: the stacked inputs, their rates and their accelerations, shape (k,) each.
        """
        _, gaps = self.gaps(x, inputs[0])
        both = [
            facing.rates(x, v, inputs, gap, slides=touch.slides)
            for facing, touch, gap in zip(self.facings, self.touches, gaps, strict=True)
        ]
        first, second = np.array(both).reshape(-1, 2).T
        return first, second


class BaseOfSteps(NamedTuple):
    """The free base of a rod, which has other unknowns in the steps than in the model.

    Attributes:
        call: unknowns of the steps ↦ unknowns of the base in the model.
        begin: index of the first unknown of the base in the model.
    """

    call: RepeatedCall
    begin: int


@dataclass(frozen=True)
class PushedResidual:
    """Residual of the equations of motion with contact forces, followed by the gaps: (t, x, v, a) ↦ shape (n + m,).

    Attributes:
        rows: residual of the equations of the model.
        size: number of its unknowns n.
        follower: the contacts.
        piece: piece of the inputs.
        base: base whose unknowns in x are not those of the model; None if there is no such base.
    """

    rows: Residual
    size: int
    follower: Follower
    piece: Piece
    base: BaseOfSteps | None = None

    def __call__(self, t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Evaluate the residual and the gaps."""
        own = slice(0, self.size)
        at = x[own]
        if self.base is not None:
            at = at.copy()
            of_base = self.base.call(at)
            at[self.base.begin : self.base.begin + len(of_base)] = of_base
        rows = self.rows(t, x[own], v[own], a[own])
        return self.follower.rows(rows, at, self.piece.at(t).value, x[self.size :])

    def in_law(self) -> Held:
        """The contacts as the record that steps in C read."""
        record = StepContactsRecord(self.follower.at_places(), len(self.follower.touches), self.size)
        held = Held(record)
        held.keep(self.follower)
        if self.base is not None:
            record.base_begin = self.base.begin
            held.point("base", function_record(self.base.call))
            held.share("x", np.zeros(self.size))
        return held


def with_touches(plain: MotionEquations, follower: Follower, piece: Piece) -> MotionEquations:
    """Equations of motion with the forces of contacts as further unknowns, and their gaps as further rows.

    The unit of a force is EI/ℓ² of its rod; for a body, of the stiffest and the longest rod that holds it. In any
    assembly, a gap depends on the strains and the base of its rod alone, or on the pose of its body. The force enters
    the balances of these unknowns, which are scaled by one energy, with the gradient of the gap.

    Args:
        plain: equations of the model.
        follower: the contacts.
        piece: piece of the inputs.
    """
    size = plain.size
    count = len(follower.touches)

    def jacobians(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        stiffness, damping, mass = (_bordered(part, count) for part in plain.jacobians(t, x[:size], v[:size], a[:size]))
        inputs = piece.at(t).value
        _, gaps = follower.gaps(x[:size], inputs)
        curvature, gradients = follower.curvature(x[:size], inputs, gaps, x[size:])
        stiffness[:size, :size] -= curvature
        stiffness[:size, size:] = -follower.pushes(gradients).T
        stiffness[size:, :size] = gradients
        return stiffness, damping, mass

    def rates_of_last(t: float, x: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        return follower.rates(x[:size], v[:size], piece.at(t))

    differential = np.concatenate([plain.differential, np.zeros(count, dtype=bool)])
    return replace(
        plain,
        differential=differential,
        residual=PushedResidual(plain.residual, size, follower, piece),
        jacobians=jacobians,
        rates_of_last=rates_of_last,
    )


def _bordered(matrix: FloatArray, count: int) -> FloatArray:
    """Return a square matrix with ``count`` rows and columns of zeros appended."""
    return np.pad(matrix, (0, count))
