"""The beginning of a stretch of a motion: impacts, and which of the sections that touch press from then on."""

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
"""Speed of opening, over the speed of approach or in lengths per interval, that counts as none."""

STEADY = 1e-6
"""Acceleration of opening, over the largest of all sections that touch, that counts as none."""

FORCELESS = 1e-10
"""Force of contact in EI/ℓ² whose acceleration counts as none: rounding of what the balances of a rod at rest sum."""

LOW = 1e-6
"""Height over the length up to which a bounce is not followed: the section stays."""

BRIEF = 1e-3
"""Share of the interval after an event over which accelerations decide what presses.

Stiff modes that are damped hard answer to a blow, and forget it, in far less: at the very beginning they would decide.
"""

LONGER = 2.0
"""Factor on the time over which accelerations decide what presses, with each change of contact in a moment."""

LONGEST = 0.1
"""Longest time over which accelerations decide what presses, over the interval."""


@dataclass(frozen=True)
class Struck:
    """The state after an impact.

    Attributes:
        v: velocities after it, shape (n,), 1/s.
        impulses: of the sections that touch, in EI/ℓ² s, shape (m,).
        speeds: rates of their gaps before it and after it, summed, shape (m,), 1/s.
        staying: contacts that stay closed.
    """

    v: FloatArray
    impulses: FloatArray
    speeds: FloatArray
    staying: Touches


@dataclass(frozen=True)
class Onset:
    """The state at which a stretch begins.

    Attributes:
        model: the model, built for a motion.
        facings: its rods and obstacles that may touch.
        plain: its equations without contact.
        piece: of its inputs.
        before: state before the event, without forces of contact.
        interval: time after it in which gaps are smooth, s.
        changes: of contact in the moment before: where there are many, longer times decide.
        saddle: the linear system of the equations without contact there.
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
        """Whether inputs move at the event: a base that does takes part in an impact."""
        return bool(np.any(self.inputs.rate))

    @property
    def horizon(self) -> float:
        """Time over which accelerations decide what presses, s."""
        return min(BRIEF * LONGER**self.changes, LONGEST) * self.interval

    def at(self, v: FloatArray) -> Onset:
        """This state with other velocities."""
        return replace(self, before=replace(self.before, v=v))

    def start(self, pressing: Touches) -> ConsistentStart:
        """Accelerations and forces while some sections press."""
        equations = self.plain
        saddle = self.saddle
        if pressing:
            equations = with_touches(self.plain, self._follower(pressing), self.piece)
            saddle = saddle.with_constraints(*self._gradients(pressing))
        x, v = (_padded(values, pressing) for values in (self.before.x, self.before.v))
        return consistent_start(equations, self.before.time, x, v, self.interval, saddle)

    def held_still(self, touches: Touches) -> Onset:
        """This state with velocities at which some sections neither approach nor leave.

        Steps keep gaps at zero, and their rates as far as the steps are exact: the rates that remain would pass for an
            impact.
        """
        if not touches:
            return self
        return self.at(self.before.v + least_change(self.saddle, *self._gradients(touches), self.rates(touches)))

    def struck(self, touching: Touches, known: int) -> Struck | None:
        """The state after an impact at sections without a gap; None where no impulses settle it.

        Args:
            touching: these sections.
            known: how many sections, the first ones, touched before: what presses them on in the blow does not rebound.
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
        """Sections that leave, and would be back without having risen above the least bounce."""
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
        """Which of the sections that touch, and neither approach nor leave, press; None where nothing settles it."""
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
        """Rates of the gaps of some sections, shape (m,), 1/s."""
        return self._follower(touches).rates(self.before.x, self.before.v, self.inputs)[0]

    def _openings(self, touches: Touches) -> tuple[FloatArray, FloatArray, float]:
        """Second derivatives of gaps without forces, by forces, and the one that counts as none, 1/s².

        What counts as none is judged by the accelerations and forces of this instant: how long the motion goes on says
        nothing of these.
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
        """Gradients of gaps, and what unit forces of their contacts do to the equations, shape (m, n) each."""
        follower, x = self._follower(touches), self.before.x
        _, gaps = follower.gaps(x, self.inputs.value)
        gradients = follower.gradients(x, self.inputs.value, gaps)
        return gradients, follower.pushes(gradients)

    def _follower(self, touches: Sequence[MovingContact]) -> Follower:
        return Follower(self.facings, tuple(touches))


def _padded(values: FloatArray, touches: Touches) -> FloatArray:
    """Unknowns, or their rates, with zeros for the forces of contact."""
    return np.concatenate([values, np.zeros(len(touches))])
