"""Cables that may go slack and stops of joints in motion: open or closed between events, and the events themselves.

A slack cable, or a stop that its joint has not reached, is open and has no push. A taut cable, or a stop at its joint,
is closed and has no gap. Between events the equations are smooth, without the corner that statics rounds. A pair whose
push comes to zero opens. A gap that comes to zero closes: an impact takes the closing velocity and its energy. A cable
does not rebound; a stop returns its coefficient of restitution, unless the bounce is as low as bounces of exact contact
that are not followed. An elastic pair loses no energy: its push grows from zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import is_zero
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import CableOfLength, JointStop
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.motion.contact_onset import LOW
from cosserat_casadi.motion.event_restart import ContactEvent, Restart
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.numerics.consistent_start import impact
from cosserat_casadi.numerics.guards import THROUGH, Guards
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

Closed = tuple[bool, ...]
"""Whether each cable that may go slack is taut, followed by whether each stop holds its joint."""

TOUCHING = 1e-9
"""Gap, over the rod's length or in rad, up to which a pair counts as closed at the start of a motion."""


APART = 1e30
"""Gap of a pair that is never closed."""


@dataclass(frozen=True)
class Pair:
    """A cable or a stop: its push, an unknown, is never negative, and zero while its gap is open.

    Attributes:
        name: name of the cable or the joint.
        row: row of its equation, which equals the entry of its push in the unknowns.
        softness: gap that a unit of its push closes.
        rigid: whether it takes velocities when it closes; an elastic pair yields.
        side: side of the stop, as in the scene; empty for a cable.
        unit: unit of its push, N or N m.
        restitution: coefficient of restitution of an impact.
        coordinate: entry of the joint's coordinate in the unknowns; −1 for a cable.
        sign: sign of the gap's rate for a positive rate of the coordinate.
    """

    name: str
    row: int
    softness: float
    rigid: bool
    side: str = ""
    unit: float = 0.0
    restitution: float = 0.0
    coordinate: int = -1
    sign: int = 0


@dataclass(frozen=True)
class Settled:
    """Continuation of a motion after it is decided which pairs are closed.

    Attributes:
        onward: restart of the motion with these pairs.
        closed: whether each pair is closed.
        v: velocities after the impact of the closing pair, shape (n,), 1/s.
        lost: energy lost in that impact, J.
        events: changes of pairs.
    """

    onward: Restart
    closed: Closed
    v: FloatArray
    lost: float
    events: tuple[ContactEvent, ...]


@dataclass(frozen=True)
class OneSided:
    """The cables of a model that may go slack, and the stops of its joints.

    Attributes:
        model: the model, built for a motion.
    """

    model: Model

    @cached_property
    def cables(self) -> list[CableOfLength]:
        """The cables that may go slack."""
        return [cable for cable in self.model.discrete.cables if cable.may_go_slack]

    @cached_property
    def pairs(self) -> list[Pair]:
        """Pairs of the cables that may go slack, followed by pairs of the stops."""
        return [
            *(self._of_cable(cable) for cable in self.cables),
            *(self._of_stop(stop) for stop in self.model.discrete.stops),
        ]

    def _of_cable(self, cable: CableOfLength) -> Pair:
        tendon = cable.tendon
        rigid = all(is_zero(compliance) for compliance in EFFECTS[tendon.kind].compliance(tendon))
        return Pair(tendon.name, self.model.discrete.tension(cable).start, cable.softness, rigid)

    def _of_stop(self, stop: JointStop) -> Pair:
        discrete = self.model.discrete
        record = discrete.joint_record(stop.placed)
        return Pair(
            name=record.name or stop.placed.where,
            row=discrete.stop(stop).start,
            softness=1.0,
            rigid=stop.stiffness is None,
            side=stop.key,
            unit=stop.placed.constraint.unit / stop.placed.coordinate_scale,
            restitution=float(record.restitution),
            coordinate=discrete.coordinate(stop.placed).start,
            sign=stop.side,
        )

    @cached_property
    def rows(self) -> list[int]:
        """Rows of the equations of the pairs, which equal the entries of their pushes."""
        return [pair.row for pair in self.pairs]

    def equations(self, plain: MotionEquations, piece: Piece, phases: Closed) -> MotionEquations:
        """Make equations of motion in which each pair is either closed or open.

        Args:
            plain: equations of the model.
            piece: piece of the inputs.
            phases: whether each pair is closed.
        """
        if not self.pairs:
            return plain

        def residual(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
            rows = plain.residual(t, x, v, a)
            gaps = self.gaps(x, piece.at(t).value)
            rows[self.rows] = np.where(phases, -gaps, self.softness * x[self.rows])
            return rows

        def jacobians(
            t: float, x: FloatArray, v: FloatArray, a: FloatArray
        ) -> tuple[FloatArray, FloatArray, FloatArray]:
            stiffness, damping, mass = plain.jacobians(t, x, v, a)
            gradients = self._gradients(x, piece.at(t).value).reshape(len(self.pairs), -1, order="F")
            for pair, closed, gradient in zip(self.pairs, phases, gradients, strict=True):
                stiffness[pair.row] = -gradient if closed else 0.0
                if not closed:
                    stiffness[pair.row, pair.row] = pair.softness
            return stiffness, damping, mass

        return replace(plain, residual=residual, jacobians=jacobians)

    def guards(self, piece: Piece, phases: Closed) -> Guards | None:
        """Make guards, gaps of open pairs and pushes of closed ones, which are not negative; None without pairs."""
        if not self.pairs:
            return None

        def values(instant: Instant) -> FloatArray:
            # Forces of contact come after the unknowns of the model.
            gaps = self.gaps(instant.x[: self.model.size], piece.at(instant.time).value)
            return np.where(phases, self.softness * instant.x[self.rows], gaps)

        return values

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> Closed:
        """Determine which pairs are closed at a state."""
        return tuple(bool(gap <= TOUCHING) for gap in self.gaps(x, inputs)) if self.pairs else ()

    def settled(
        self,
        plain: MotionEquations,
        piece: Piece,
        at: Instant,
        phases: Closed,
        guard: int | None,
        interval: float,
        begin: Callable[[Closed, FloatArray], Restart],
        *,
        told: bool,
    ) -> Settled:
        """Decide which pairs are closed after an event, or at the start of a motion, and continue the motion with them.

        Args:
            plain: equations of the model.
            piece: of its inputs.
            at: state before the event, in the unknowns of the model.
            phases: which pairs are closed before it.
            guard: number of the pair whose guard came to zero; None if no guard did.
            interval: time after the event in which the equations are smooth, s.
            begin: function of closed pairs and velocities ↦ restart of the motion.
            told: whether pairs that open are events.
        """
        v = at.v
        impulse = 0.0
        before = phases
        closes = guard is not None and not phases[guard]
        if guard is not None:
            phases = _changed(phases, [guard])
        if guard is not None and closes:
            v, phases, impulse = self._after_impact(plain, piece, at, phases, guard, interval)
        tried = {phases}
        while True:
            onward = begin(phases, v)
            instant = onward.start.instant
            opens = self._pulling(instant.x, phases)
            back = [] if opens else self._soon_back(instant, phases, piece)
            others = _changed(phases, opens or back)
            # What rounding decides stays as it is.
            if others in tried:
                break
            tried.add(others)
            phases = others
            if back:
                v, _ = impact(self.equations(plain, piece, phases), at.time, at.x, v, interval)
        events: list[ContactEvent] = []
        lost = 0.0
        if guard is not None and closes:
            inputs = piece.at(at.time)
            lost = self._kinetic(at.x, at.v, inputs) - self._kinetic(at.x, v, inputs)
            events.append(self.event(guard, at.time, closes=True, lost=lost, impulse=impulse))
        left = [k for k, closed in enumerate(before) if closed and not phases[k]]
        events += [self.event(k, at.time, closes=False) for k in left if told]
        return Settled(onward, phases, v, lost, tuple(events))

    def event(self, number: int, time: float, *, closes: bool, lost: float = 0.0, impulse: float = 0.0) -> ContactEvent:
        """Event of a pair that closes or opens, with the energy lost, J, and the dimensionless impulse."""
        pair = self.pairs[number]
        words = ("stop_hit", "stop_left") if pair.side else ("taut", "slack")
        kind = words[0] if closes else words[1]
        return ContactEvent(kind, time, pair.name, pair.side, 0.0, float(lost), float(pair.unit * impulse))

    def _after_impact(
        self, plain: MotionEquations, piece: Piece, at: Instant, phases: Closed, guard: int, interval: float
    ) -> tuple[FloatArray, Closed, float]:
        """Velocities after a pair has closed, the pairs that are closed then, and its impulse; impulses only push."""
        # What the smallest push that counts does in that time is rounding.
        rounding = THROUGH * interval
        while True:
            v, impulses = impact(self.equations(plain, piece, phases), at.time, at.x, at.v, interval)
            pushes = self.softness * impulses[self.rows]
            # The pair that closes is the one that is run into.
            held = [k for k, pair in enumerate(self.pairs) if phases[k] and pair.rigid and k != guard]
            pulling = [k for k in held if pushes[k] < -rounding]
            if not pulling:
                break
            phases = _changed(phases, pulling)
        pair = self.pairs[guard]
        impulse = float(impulses[pair.row]) if pair.rigid else 0.0
        if not (phases[guard] and pair.restitution):
            return v, phases, impulse
        # Newton's law: what the impact without rebound takes from the velocities is taken once more, in part.
        rebounding = v + pair.restitution * (v - at.v)
        if pair.sign * rebounding[pair.coordinate] * interval <= THROUGH:
            return v, phases, impulse
        return rebounding, _changed(phases, [guard]), (1.0 + pair.restitution) * impulse

    def _soon_back(self, instant: Instant, phases: Closed, piece: Piece) -> list[int]:
        """Stops that joints leave and would meet again without having risen above the least bounce."""
        back = []
        gaps = self.gaps(instant.x[: self.model.size], piece.at(instant.time).value) if self.pairs else ()
        for k, (pair, gap) in enumerate(zip(self.pairs, gaps, strict=True)):
            speed = pair.sign * instant.v[pair.coordinate]
            acceleration = pair.sign * instant.a[pair.coordinate]
            rises = pair.rigid and pair.side and not phases[k] and gap <= TOUCHING and speed > 0.0
            # What leaves with the speed v and comes back with the acceleration a is v²/(2a) off its stop at most.
            if rises and speed**2 < -2.0 * acceleration * LOW:
                back.append(k)
        return back

    def _pulling(self, x: FloatArray, phases: Closed) -> list[int]:
        """Closed pairs that pull."""
        pushes = self.softness * x[self.rows]
        return [k for k, closed in enumerate(phases) if closed and pushes[k] < -THROUGH]

    def _kinetic(self, x: FloatArray, v: FloatArray, inputs: Sequence[FloatArray]) -> float:
        value, rate, *_ = inputs
        kinetic, *_ = self.model.energies(x, v, value, rate)
        return float(kinetic)

    def opening(self, x: FloatArray, v: FloatArray, inputs: FloatArray) -> FloatArray:
        """Rates of the gaps while inputs rest, shape (m,), 1/s."""
        return np.asarray(self._gradients(x, inputs).reshape(len(self.pairs), -1, order="F") @ v)

    @cached_property
    def softness(self) -> FloatArray:
        """Gaps that units of the pushes close, shape (m,)."""
        return np.array([pair.softness for pair in self.pairs])

    @cached_property
    def gaps(self) -> RepeatedCall:
        """(x, inputs) ↦ sag of each cable over the rod's length, and distance of each joint from its stop, (m,)."""
        return RepeatedCall(ca.Function("gaps", self._symbols, [self._gap_rows]))

    @cached_property
    def _gradients(self) -> RepeatedCall:
        by_unknowns = ca.densify(ca.jacobian(self._gap_rows, self._symbols[0]))
        return RepeatedCall(ca.Function("gradients", self._symbols, [ca.vec(by_unknowns)]))

    @cached_property
    def gaps_and_gradients(self) -> ca.Function:
        """(x, inputs) ↦ :attr:`gaps`, then their derivatives by the n unknowns, column after column, (m + m n)×1.

        The gap of a rigid pair is :data:`APART`: steps with friction treat rigid pairs as contacts.
        """
        x, _ = self._symbols
        split = ca.vertsplit(self._gap_rows)
        rows = [ca.MX(APART) if pair.rigid else row for pair, row in zip(self.pairs, split, strict=True)]
        gaps = ca.densify(ca.vertcat(*rows))
        return ca.Function("gaps", self._symbols, [ca.vertcat(gaps, ca.vec(ca.densify(ca.jacobian(gaps, x))))])

    @cached_property
    def _symbols(self) -> list[ca.MX]:
        return [ca.MX.sym("x", self.model.size), ca.MX.sym("inputs", self.model.inputs.size)]

    @cached_property
    def _gap_rows(self) -> Matrix:
        """Sag of each cable over the length of its rod, then distance of each joint from its stop, m×1."""
        x, inputs = self._symbols
        system = System(self.model.discrete, Arguments(x, inputs))
        sags = [system.actuators.cable_lengths[cable.tendon.name].sag for cable in self.cables]
        ways = [system.way_to_stop(stop) for stop in self.model.discrete.stops]
        return ca.densify(ca.vertcat(*sags, *ways))


def sags_by_cable(model: Model, x: FloatArray, inputs: FloatArray, p: FloatArray | None = None) -> dict[str, float]:
    """Sag of each inextensible cable of given length, over the rod's length; negative if the cable is too short.

    Args:
        model: the model.
        x: unknowns, shape (size,).
        inputs: stacked inputs, shape (model.inputs.size,).
        p: stacked parameters; None for a model without parameters.
    """
    cables = [cable.tendon for cable in model.discrete.cables if getattr(cable.tendon, "axial_stiffness", None) is None]
    if not cables:
        return {}
    lengths = System(model.discrete, Arguments(ca.DM(x), ca.DM(inputs))).actuators.cable_lengths
    given = [] if p is None else [model.parameters.symbol]
    sags = ca.Function("sags", given, [lengths[cable.name].sag for cable in cables])
    values = sags.call([p] if given else [])
    return {cable.name: float(value) for cable, value in zip(cables, values, strict=True)}


def _changed(phases: Closed, numbers: Sequence[int]) -> Closed:
    """Toggle some pairs between open and closed."""
    return tuple(closed != (k in numbers) for k, closed in enumerate(phases))
