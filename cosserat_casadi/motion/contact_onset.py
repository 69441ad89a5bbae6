"""The beginning of a stretch of a motion: impacts, and which of the touching sections press from then on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_forces import Follower, MovingContact, Touches, with_touches
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_law import least_pushes
from cosserat_casadi.motion.moving_inputs import InputState, Piece
from cosserat_casadi.numerics.consistent_start import (
    ConsistentStart,
    Saddle,
    consistent_start,
    least_change,
    response,
    shortly_after,
)
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

STILL = 1e-9
"""Speed of opening that counts as zero, over the speed of approach, or in lengths per interval."""

STEADY = 1e-6
"""Acceleration of opening that counts as zero, over the largest one of all touching sections."""

FORCELESS = 1e-10
"""Contact force in EI/ℓ² whose acceleration counts as zero: the rounding of the balances of a rod at rest."""

LOW = 1e-6
"""Height, over the length, up to which a bounce is not followed; the contact persists instead."""

BRIEF = 1e-3
"""Time over which accelerations decide what presses, over the interval after an event.

Stiff, strongly damped modes answer to a blow and decay in far less time; accelerations of the instant would be theirs.
"""

LONGER = 2.0
"""Factor by which each change of contact in a moment lengthens the time over which accelerations decide."""

LONGEST = 0.1
"""Longest time over which accelerations decide what presses, over the interval."""


@dataclass(frozen=True)
class Struck:
    """The state after an impact.

    Attributes:
        v: velocities after the impact, shape (n,), 1/s.
        impulses: impulses at the touching sections, in EI/ℓ² s, shape (m,).
        speeds: sum of the rates of each gap before and after the impact, shape (m,), 1/s.
        staying: contacts that stay closed.
    """

    v: FloatArray
    impulses: FloatArray
    speeds: FloatArray
    staying: Touches


@dataclass(frozen=True)
class Onset:
    """The state at which a stretch of the motion begins, and the problems of impact and contact there.

    Attributes:
        model: the model, built for a motion.
        facings: pairs of a rod or body and an obstacle that may touch.
        plain: equations of motion without contact.
        piece: piece of the inputs.
        before: state before the event, without forces of contact.
        interval: time after the event in which gaps are smooth, s.
        changes: number of changes of contact in the moment before; with many, longer times decide.
        saddle: linear system of the equations of motion without contact at the event.
    """

    model: Model
    facings: Sequence[Facing]
    plain: MotionEquations
    piece: Piece
    before: Instant
    interval: float
    changes: int
    saddle: Saddle

    @property
    def inputs(self) -> InputState:
        """Inputs at the event, with their rates and accelerations."""
        return self.piece.at(self.before.time)

    @property
    def driven(self) -> bool:
        """Whether inputs move at the event: a moving base does work in an impact."""
        return bool(np.any(self.inputs.rate))

    @property
    def horizon(self) -> float:
        """Time over which accelerations decide what presses, s."""
        return min(BRIEF * LONGER**self.changes, LONGEST) * self.interval

    def at(self, v: FloatArray) -> Onset:
        """Return the state with other velocities."""
        return replace(self, before=replace(self.before, v=v))

    def start(self, pressing: Touches) -> ConsistentStart:
        """Solve for accelerations and contact forces while some sections press."""
        equations = self.plain
        saddle = self.saddle
        if pressing:
            equations = with_touches(self.plain, self._follower(pressing), self.piece)
            saddle = saddle.with_constraints(*self._gradients(pressing))
        x, v = (_padded(values, pressing) for values in (self.before.x, self.before.v))
        return consistent_start(equations, self.before.time, x, v, self.interval, saddle)

    def held_still(self, touches: Touches) -> Onset:
        """Return the state with the nearest velocities at which the gaps of some contacts have zero rate.

        Steps keep gaps at zero, but their rates only up to the error of the steps; the remaining rates would pass for
        an impact.
        """
        if not touches:
            return self
        return self.at(self.before.v + least_change(self.saddle, *self._gradients(touches), self.rates(touches)))

    def struck(self, touching: Touches, known: int) -> Struck | None:
        """Solve the impact at closed gaps; None if no impulses settle it.

        Args:
            touching: the contacts with closed gaps.
            known: number of contacts, the first ones, that lasted before the impact; they do not rebound.
        """
        if not touching:
            return Struck(self.before.v, np.zeros(0), np.zeros(0), ())
        speeds = self.rates(touching)
        still = STILL * max(float(np.abs(speeds).max()), 1.0 / self.interval)
        gradients, pushes = self._gradients(touching)
        answers = response(self.saddle, pushes.T)
        # Newton's law: γ⁺ ≥ −e γ⁻ where gaps close. Of what has touched before γ⁻ is zero.
        shares = np.array([self.facings[touch.facing].against.restitution for touch in touching])
        shares[:known] = 0.0
        rebound = np.where(speeds < -still, -shares * speeds, 0.0)
        impulses = least_pushes(gradients @ answers, speeds - rebound, still)
        if impulses is None:
            return None
        v = self.before.v + answers @ impulses
        rates = np.where(impulses > 0.0, rebound, self.at(v).rates(touching))
        staying = tuple(touch for touch, rate in zip(touching, rates, strict=True) if rate <= still)
        return Struck(v, impulses, speeds + rates, staying)

    def soon_back(self, leaving: Touches, staying: Touches) -> Touches:
        """Contacts that open, but would close again without having risen above the least bounce."""
        if not leaving:
            return ()
        opening, compliance, tolerance = self._openings((*leaving, *staying))
        own = slice(len(leaving), None)
        forces = least_pushes(compliance[own, own], opening[own], tolerance)
        if forces is None:
            return ()
        accelerations = (opening + compliance[:, own] @ forces)[: len(leaving)]
        rates = self.rates(leaving)
        # A section that leaves with the speed v and falls back with the acceleration a rises by v²/(2a).
        low = (accelerations < 0.0) & (rates**2 < -2.0 * accelerations * LOW)
        return tuple(touch for touch, is_low in zip(leaving, low, strict=True) if is_low)

    def pressing(self, candidates: Touches) -> Touches | None:
        """Select the contacts that press, among candidates whose gaps have zero rate; None if nothing settles it."""
        if not candidates:
            return ()
        opening, compliance, tolerance = self._openings(candidates)
        forces = least_pushes(compliance, opening, tolerance)
        if forces is None:
            return None
        return tuple(touch for touch, force in zip(candidates, forces, strict=True) if force > 0.0)

    def kinetic(self) -> float:
        """Kinetic energy, J."""
        kinetic, *_ = self.model.energies(self.before.x, self.before.v, self.inputs.value, self.inputs.rate)
        return float(kinetic)

    def rates(self, touches: Touches) -> FloatArray:
        """Rates of the gaps of some contacts, shape (m,), 1/s."""
        return self._follower(touches).rates(self.before.x, self.before.v, self.inputs)[0]

    def _openings(self, touches: Touches) -> tuple[FloatArray, FloatArray, float]:
        """Second rates of gaps without forces, their derivative by forces, and the value that counts as zero, 1/s².

        The value that counts as zero follows from the accelerations and forces of the instant, not from the duration of
        the motion.
        """
        _, turning = self._follower(touches).rates(self.before.x, self.before.v, self.inputs)
        gradients, pushes = self._gradients(touches)
        free = self.start(()).instant
        a, answers = shortly_after(self.plain, free, self.horizon, pushes.T)
        opening = gradients @ a + turning
        compliance = gradients @ answers
        largest = float(np.abs(opening).max() + np.abs(turning).max())
        tolerance = STEADY * largest + FORCELESS * float(np.abs(np.diag(compliance)).max())
        return opening, compliance, tolerance

    def _gradients(self, touches: Touches) -> tuple[FloatArray, FloatArray]:
        """Gradients of gaps, and generalised forces of unit contact forces in the equations, shape (m, n) each."""
        follower, x = self._follower(touches), self.before.x
        _, gaps = follower.gaps(x, self.inputs.value)
        gradients = follower.gradients(x, self.inputs.value, gaps)
        return gradients, follower.pushes(gradients)

    def _follower(self, touches: Sequence[MovingContact]) -> Follower:
        return Follower(self.facings, tuple(touches))


def _padded(values: FloatArray, touches: Touches) -> FloatArray:
    """Append zeros for the contact forces to the unknowns or their rates."""
    return np.concatenate([values, np.zeros(len(touches))])
