"""Cables that may go slack, in motion: each is slack or taut for a while, and what happens in between.

A slack cable has no tension, a taut one has its length: between these the equations are smooth, and the corner that
statics rounds is never passed. A cable whose tension would become negative goes slack. One whose sag comes to zero
snaps taut: an impact without rebound takes from the rod the velocity that would draw the cable out, and the energy
that goes with it. An elastic cable takes nothing: its tension grows from zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import CableOfLength
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.motion.event_restart import ContactEvent, Restart
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.numerics.consistent_start import consistent_start, impact
from cosserat_casadi.numerics.guards import THROUGH, Guards
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

Tautness = tuple[bool, ...]
"""Of each cable that may go slack whether it is taut."""

TOUCHING = 1e-9
"""Sag, relative to the rod's length, from which on a cable counts as taut where a motion starts."""


@dataclass(frozen=True)
class SlackCables:
    """The cables of a model that may go slack.

    Attributes:
        model: the model, built for a motion.
    """

    model: Model

    @cached_property
    def cables(self) -> list[CableOfLength]:
        """These cables."""
        return [cable for cable in self.model.discrete.cables if EFFECTS[cable.tendon.kind].may_go_slack(cable.tendon)]

    @cached_property
    def rows(self) -> list[int]:
        """Rows of their equations, which are the entries of their tensions."""
        return [self.model.discrete.tension(cable).start for cable in self.cables]

    def equations(self, plain: MotionEquations, piece: Piece, phases: Tautness) -> MotionEquations:
        """Equations of motion in which each of these cables is either slack or taut.

        Args:
            plain: those of the model.
            piece: of its inputs.
            phases: which cables are taut.
        """
        if not self.cables:
            return plain

        def residual(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
            rows = plain.residual(t, x, v, a)
            sags = self.sags(x, piece.at(t).value)
            for cable, row, taut, sag in zip(self.cables, self.rows, phases, sags, strict=True):
                rows[row] = -sag if taut else cable.softness * x[row]
            return rows

        def jacobians(
            t: float, x: FloatArray, v: FloatArray, a: FloatArray
        ) -> tuple[FloatArray, FloatArray, FloatArray]:
            stiffness, damping, mass = plain.jacobians(t, x, v, a)
            gradients = self._gradients(x, piece.at(t).value).reshape(len(self.cables), -1, order="F")
            for cable, row, taut, gradient in zip(self.cables, self.rows, phases, gradients, strict=True):
                stiffness[row] = -gradient if taut else 0.0
                if not taut:
                    stiffness[row, row] = cable.softness
            return stiffness, damping, mass

        return replace(plain, residual=residual, jacobians=jacobians)

    def arranged(self, plain: MotionEquations, piece: Piece, phases: Tautness) -> tuple[MotionEquations, Guards | None]:
        """The equations of motion with these cables taut, and the guards that stay at zero or above while they hold."""
        return self.equations(plain, piece, phases), self.guards(piece, phases)

    def guards(self, piece: Piece, phases: Tautness) -> Guards | None:
        """Sags of slack cables and tensions of taut ones, which stay at zero or above; None without such cables."""
        if not self.cables:
            return None

        def values(instant: Instant) -> FloatArray:
            sags = self.sags(instant.x, piece.at(instant.time).value)
            tensions = self._softness * instant.x[self.rows]
            return np.where(phases, tensions, sags)

        return values

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> Tautness:
        """Which cables are taut at a state."""
        if not self.cables:
            return ()
        return tuple(bool(sag <= TOUCHING) for sag in self.sags(x, inputs))

    def restarted(
        self,
        plain: MotionEquations,
        piece: Piece,
        at: Instant,
        phases: Tautness,
        guard: int | None,
        interval: float,
    ) -> Restart[Tautness]:
        """How a motion goes on, or begins.

        Args:
            plain: equations of the model.
            piece: of its inputs.
            at: state before the event.
            phases: which cables are taut before it.
            guard: number of the cable whose guard came to zero; None for a start, or another piece of the inputs.
            interval: time after it in which the equations are smooth, s.
        """
        v = at.v
        lost = 0.0
        events: list[ContactEvent] = []
        was_taut = phases
        if guard is not None:
            snaps = not phases[guard]
            phases = _changed(phases, [guard])
            if snaps:
                v, phases = self._after_impact(plain, piece, at, phases, interval)
                inputs = piece.at(at.time)
                lost = self._kinetic(at.x, at.v, inputs) - self._kinetic(at.x, v, inputs)
                events.append(self._event(guard, "taut", at.time, lost))
                was_taut = _changed(was_taut, [guard])
        while True:
            start = consistent_start(self.equations(plain, piece, phases), at.time, at.x, v, interval)
            slack = [k for k in self._pushing(start.instant.x, phases) if phases[k]]
            if not slack:
                if guard is not None:
                    slackened = [k for k, taut in enumerate(was_taut) if taut and not phases[k]]
                    events += [self._event(k, "slack", at.time, 0.0) for k in slackened]
                return Restart(start, phases, lost, events=tuple(events))
            phases = _changed(phases, slack)

    def _event(self, number: int, kind: str, time: float, lost: float) -> ContactEvent:
        return ContactEvent(kind, time, self.cables[number].tendon.name, "", 0.0, lost)

    def _after_impact(
        self, plain: MotionEquations, piece: Piece, at: Instant, phases: Tautness, interval: float
    ) -> tuple[FloatArray, Tautness]:
        """Velocities after a cable has snapped taut, and which cables are taut then: impulses only pull."""
        while True:
            v, impulses = impact(self.equations(plain, piece, phases), at.time, at.x, at.v, interval)
            pushing = [k for k, row in enumerate(self.rows) if phases[k] and impulses[row] < 0.0]
            if not pushing:
                return v, phases
            phases = _changed(phases, pushing)

    def _pushing(self, x: FloatArray, phases: Tautness) -> list[int]:
        """Taut cables whose tension is negative."""
        tensions = self._softness * x[self.rows]
        return [k for k, taut in enumerate(phases) if taut and tensions[k] < -THROUGH]

    def _kinetic(self, x: FloatArray, v: FloatArray, inputs: Sequence[FloatArray]) -> float:
        value, rate, *_ = inputs
        kinetic, *_ = self.model.energies(x, v, value, rate)
        return float(kinetic)

    @cached_property
    def _softness(self) -> FloatArray:
        return np.array([cable.softness for cable in self.cables])

    @cached_property
    def sags(self) -> RepeatedCall:
        """(x, inputs) ↦ what each cable sags by, relative to the rod's length, shape (m,)."""
        return RepeatedCall(ca.Function("sags", self._symbols, [self._sag_rows]))

    @cached_property
    def _gradients(self) -> RepeatedCall:
        by_unknowns = ca.densify(ca.jacobian(self._sag_rows, self._symbols[0]))
        return RepeatedCall(ca.Function("gradients", self._symbols, [ca.vec(by_unknowns)]))

    @cached_property
    def _symbols(self) -> list[ca.MX]:
        return [ca.MX.sym("x", self.model.size), ca.MX.sym("inputs", self.model.inputs.size)]

    @cached_property
    def _sag_rows(self) -> Matrix:
        """Excess of each cable's wanted length, stretched by its tension, over its length, over the rod's length."""
        x, inputs = self._symbols
        lengths = System(self.model.discrete, Arguments(x, inputs)).actuators.cable_lengths
        return ca.densify(ca.vertcat(*[lengths[cable.tendon.name].sag for cable in self.cables]))


def sags_by_cable(model: Model, x: FloatArray, inputs: FloatArray) -> dict[str, float]:
    """Sags of every cable of given length that does not stretch, over the rod's length; negative if too short.

    Args:
        model: the model.
        x: unknowns, shape (size,).
        inputs: stacked, shape (model.inputs.size,).
    """
    cables = [cable.tendon for cable in model.discrete.cables if getattr(cable.tendon, "axial_stiffness", None) is None]
    if not cables:
        return {}
    lengths = System(model.discrete, Arguments(ca.DM(x), ca.DM(inputs))).actuators.cable_lengths
    return {cable.name: float(ca.evalf(ca.MX(lengths[cable.name].sag))) for cable in cables}


def _changed(phases: Tautness, cables: Sequence[int]) -> Tautness:
    """Tautness of which those of some cables are the other one."""
    return tuple(taut != (k in cables) for k, taut in enumerate(phases))
