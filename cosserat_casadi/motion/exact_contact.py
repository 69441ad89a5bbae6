"""Exact contact in motion, without friction: rods touch obstacles at sections for a while, and what happens between.

Between events the sections that touch are the same, and the equations are smooth. Where a gap comes to zero there is an
impact without rebound: impulses along the normals take the speed of approach, as little as keeps all that touch apart
(F. Pfeiffer, C. Glocker, *Multibody Dynamics with Unilateral Contacts*, Wiley 1996, chapters 5 and 6). Where a force
comes to zero the section lifts off. Which of several contacts remain is a complementarity problem of velocities, then
of accelerations. See docs/contact.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_sections import facings
from cosserat_casadi.motion.facing import Facing
from cosserat_casadi.motion.meeting_ends import MeetingEnds
from cosserat_casadi.motion.moving_inputs import InputState, Piece
from cosserat_casadi.motion.restart import ContactEvent, Restart
from cosserat_casadi.motion.touching import Follower, Touch, Touches, with_touches
from cosserat_casadi.numerics.complementarity import active_constraints
from cosserat_casadi.numerics.consistent_start import ConsistentStart, consistent_start, impact
from cosserat_casadi.numerics.guards import Guards
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

SAME_PLACE = 0.02
"""Distance of two sections, over the length, that touch one obstacle, up to which they count as one."""

TOUCHING = 1e-9
"""Gap, over the length, up to which a section touches where it is looked at."""

FLATTEST = 1e-3
"""Least second derivative of the gap with X, over the length, at a place that slides: it slides ever faster."""

STILL = 1e-9
"""Speed of opening, over that of approach or in lengths per interval, that counts as none."""

PUSH = 1e-10
"""Force in EI/ℓ², or impulse over the largest, below zero that counts as none."""

BRIEF = 1e-4
"""Time, over the interval in which gaps are smooth, after which a section that leaves is back at once."""

LEEWAY = 1e-6
"""Depth over the length up to which what is on its way out of an obstacle is so by the error of a step."""

FORCE, END, BEND, GAP = range(4)
"""What a guard is of: a force, a place at the end of the rod, the bend of a gap, the gaps of what does not touch."""

TINY = float(np.finfo(np.float64).tiny)
"""Least number to divide by."""


@dataclass(frozen=True)
class ExactContacts:
    """The contacts of a model with obstacles that have no width.

    Attributes:
        model: the model, built for a motion.
    """

    model: Model

    @cached_property
    def facings(self) -> list[Facing]:
        """Rods and bodies, with the obstacles that they may touch."""
        return facings(self.model)

    @cached_property
    def meeting_ends(self) -> MeetingEnds:
        """Which ends of the rods are one point."""
        return MeetingEnds(self.facings)

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> Touches:
        """What touches at a state."""
        return self._touching(x, inputs, ())

    def equations(self, plain: MotionEquations, piece: Piece, phases: Touches) -> MotionEquations:
        """Equations of motion while some sections touch.

        Args:
            plain: those of the model.
            piece: of its inputs.
            phases: what touches.
        """
        if not phases:
            return plain
        return with_touches(plain, Follower(self.facings, phases), piece)

    def arranged(self, plain: MotionEquations, piece: Piece, phases: Touches) -> tuple[MotionEquations, Guards]:
        """The equations, and what has to stay at zero or above while they hold."""
        follower = Follower(self.facings, phases)
        equations = with_touches(plain, follower, piece) if phases else plain
        return equations, self._guards(piece, follower)

    def _guards(self, piece: Piece, follower: Follower) -> Guards:
        """Forces, places within the rod, bends of gaps, and gaps of all else; they are asked for along the motion."""
        phases = follower.touches
        size = self.model.size
        # Where a stretch begins an event may have found what is about to leave a little inside.
        inside: list[float] = []

        def values(instant: Instant) -> FloatArray:
            x = instant.x[:size]
            inputs = piece.at(instant.time).value
            places, gaps = follower.follow(x, inputs)
            forces = instant.x[size:]
            touches = [touch._replace(place=place) for touch, place in zip(phases, places, strict=True)]
            ends = [self._within(touch, x, inputs) for touch in touches]
            bends = [gap.bend - FLATTEST if touch.slides else 1.0 for touch, gap in zip(phases, gaps, strict=True)]
            beside = [end for touch in touches for end in self.meeting_ends.beside(touch, SAME_PLACE)]
            others = []
            for number, facing in enumerate(self.facings):
                own = [touch.place for touch in touches if touch.facing == number]
                left_out = [X for other, X in beside if other == number]
                others.append(min(1.0, facing.lowest(facing.nodes(x, inputs), own, left_out)))
            if not inside:
                inside.extend(min(0.0, max(gap, -LEEWAY)) for gap in others)
            others = [gap - least for gap, least in zip(others, inside, strict=True)]
            return np.concatenate([forces, ends, bends, others])

        return values

    def _within(self, touch: Touch, x: FloatArray, inputs: FloatArray) -> float:
        """How far a place is from the ends of the rod; of an end, how fast the gap rises towards all rods there."""
        if touch.slides:
            return min(touch.place, 1.0 - touch.place)
        if self.facings[touch.facing].of_body:
            return 1.0
        return self.meeting_ends.rise(touch, x, inputs)

    def restarted(
        self,
        plain: MotionEquations,
        piece: Piece,
        at: Instant,
        phases: Touches,
        guard: int | None,
        interval: float,
    ) -> Restart:
        """How a motion goes on, or begins.

        Args:
            plain: equations of the model.
            piece: of its inputs.
            at: state before the event.
            phases: what touches before it.
            guard: number of the guard that came to zero; None for a start, or another piece of the inputs.
            interval: time after it in which the inputs are smooth, s.
        """
        size = self.model.size
        before = Instant(at.time, at.x[:size], at.v[:size], at.a[:size])
        stretch = _Stretch(self, plain, piece, before, interval)
        known = self._known(phases, guard, before, stretch.inputs.value)
        if known.lying is not None:
            return stretch.stopped((), self._lies_down(known.lying, at.time))
        return self._struck(stretch, known)

    def _known(self, phases: Touches, guard: int | None, before: Instant, inputs: FloatArray) -> _Known:
        """What a guard that came to zero makes of contacts that there were.

        Args:
            phases: these contacts.
            guard: number of the guard; None for a start, or another piece of the inputs.
            before: state before the event.
            inputs: at its time.
        """
        places, _ = Follower(self.facings, phases).gaps(before.x, inputs)
        held = [touch._replace(place=place) for touch, place in zip(phases, places, strict=True)]
        kind, number = _guarded(guard, len(phases))
        if kind == FORCE:
            left = held.pop(number)
            return _Known(tuple(held), (left,), (self._event("lift_off", before.time, left),))
        if kind == BEND:
            return _Known(tuple(held), lying=held[number])
        if kind == END:
            end = held[number]
            moved = self.meeting_ends.gone_on(end, before.x, inputs)
            held[number] = moved
            # An end that is left where the gap is flat leaves no section for another.
            facing = self.facings[moved.facing]
            if moved.slides and facing.at(facing.nodes(before.x, inputs), moved.place).bend <= FLATTEST:
                return _Known(tuple(held), lying=moved)
            name = "slide_from_end" if moved.slides else "slide_to_end"
            if moved.facing != end.facing:
                name = "slide_over_joint"
            return _Known(tuple(held), events=(self._event(name, before.time, moved),))
        return _Known(tuple(held))

    def _struck(self, stretch: _Stretch, known: _Known) -> Restart:
        """How a motion goes on after what touches anew has struck."""
        before = stretch.before
        touching = self._touching(before.x, stretch.inputs.value, (*known.held, *known.left))
        new = touching[len(known.held) + len(known.left) :]
        after = stretch.after_impact(touching, len(known.held))
        if after is None:
            return stretch.stopped(known.events, self._undecided(touching, before.time))
        v, impulses, remaining = after
        events = list(known.events)
        lost = 0.0
        for touch, speed in zip(touching, stretch.rates(touching, before.v), strict=True):
            facing = self.facings[touch.facing]
            impulse = impulses[touch] * facing.force_unit
            # Half the impulse times the speed that it takes: of sections that touched before that is none.
            energy = max(0.0, float(-0.5 * impulse * speed * facing.length))
            lost += energy
            if touch in new and impulse > 0.0:
                events.append(self._event("impact", before.time, touch, energy, impulse))
        work = stretch.kinetic(v) - stretch.kinetic(before.v) + lost if stretch.driven else 0.0
        candidates = tuple(touch for touch in remaining if touch not in known.left)
        stalled = None
        pressing = stretch.pressing(candidates, v)
        if pressing is None:
            stalled = self._undecided(candidates, before.time)
            pressing = ()
        start = stretch.start(v, pressing)
        leaving = tuple(touch for touch in touching if touch not in (*remaining, *known.left))
        back = stretch.back_at_once(leaving, start.instant)
        if back:
            slowed = stretch.held_still(v, (*pressing, *back))
            lost += max(0.0, stretch.kinetic(v) - stretch.kinetic(slowed))
            pressing = stretch.pressing((*candidates, *back), slowed) or ()
            start = stretch.start(slowed, pressing)
        return Restart(start, pressing, lost, work, tuple(events), stalled)

    def _touching(self, x: FloatArray, inputs: FloatArray, known: Sequence[Touch]) -> Touches:
        """Known contacts, and all others that touch at a state."""
        found: list[Touch] = []
        for number, facing in enumerate(self.facings):
            nodes = facing.nodes(x, inputs)
            own = [touch.place for touch in known if touch.facing == number]
            found += [
                Touch(number, minimum.place, minimum.inside)
                for minimum in facing.minima(nodes, TOUCHING)
                if all(abs(minimum.place - place) > SAME_PLACE for place in own)
            ]
        return self.meeting_ends.distinct(tuple(known), tuple(found), SAME_PLACE)

    def _event(self, kind: str, time: float, touch: Touch, energy: float = 0.0, impulse: float = 0.0) -> ContactEvent:
        facing = self.facings[touch.facing]
        name = facing.obstacle.name
        return ContactEvent(kind, time, facing.rod, name, touch.place, energy, impulse, facing.of_body)

    def _lies_down(self, touch: Touch, time: float) -> str:
        facing = self.facings[touch.facing]
        return (
            f"At t = {time:.6g} s the rod {facing.rod!r} begins to lie down on {facing.obstacle.name!r} at X = "
            f"{touch.place:.4g}: in motion contact is at points, not along stretches. Give the obstacle a width."
        )

    def _undecided(self, touches: Touches, time: float) -> str:
        names = sorted({self.facings[touch.facing].obstacle.name for touch in touches})
        return f"At t = {time:.6g} s it is not decided which of {len(touches)} contacts with {', '.join(names)} remain."


@dataclass(frozen=True)
class _Known:
    """Contacts that there were before an event.

    Attributes:
        held: those that go on, where they are at the event.
        left: the one that lifts off, if one does.
        events: of them.
        lying: the one whose rod begins to lie down; None where none does.
    """

    held: Touches
    left: Touches = ()
    events: tuple[ContactEvent, ...] = ()
    lying: Touch | None = None


@dataclass(frozen=True)
class _Stretch:
    """The beginning of a stretch of a motion.

    Attributes:
        contacts: of the model.
        plain: equations of the model.
        piece: of its inputs.
        before: state before the event, without forces of contact.
        interval: time after it in which gaps are smooth, s.
    """

    contacts: ExactContacts
    plain: MotionEquations
    piece: Piece
    before: Instant
    interval: float

    @property
    def inputs(self) -> InputState:
        """Inputs at the event, with their rates and accelerations."""
        return self.piece.at(self.before.time)

    @property
    def driven(self) -> bool:
        """Whether inputs move at the event: a base that does takes part in an impact."""
        return bool(np.any(self.inputs.rate))

    def stopped(self, events: tuple[ContactEvent, ...], stalled: str) -> Restart:
        """The end of a motion, with everything as it was, because nothing is decided.

        Args:
            events: changes of contact until then.
            stalled: why.
        """
        return Restart(self.start(self.before.v, ()), (), events=events, stalled=stalled)

    def start(self, v: FloatArray, pressing: Touches) -> ConsistentStart:
        """Accelerations and forces at some velocities while some sections press."""
        equations = self.contacts.equations(self.plain, self.piece, pressing)
        x = _padded(self.before.x, pressing)
        return consistent_start(equations, self.before.time, x, _padded(v, pressing), self.interval)

    def after_impact(self, touching: Touches, held: int) -> tuple[FloatArray, dict[Touch, float], Touches] | None:
        """Velocities after an impact, its impulses, and what still touches; None where nothing settles it.

        Impulses are in EI/ℓ² s.

        Args:
            touching: sections without a gap.
            held: number of the first of them, which have touched all along.
        """
        if not touching:
            return self.before.v, {}, ()
        speeds = self.rates(touching, self.before.v)
        # Steps keep their gaps at zero, and the rates of these to the error of the steps alone.
        speeds[:held] = 0.0
        still = STILL * max(float(np.abs(speeds).max()), 1.0 / self.interval)
        if speeds.min() >= -still:
            return self.before.v, dict.fromkeys(touching, 0.0), self._staying(touching, speeds, still)

        def solve(chosen: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
            v, impulses = self._impact(tuple(touching[k] for k in chosen))
            rates = self.rates(touching, v)
            rates[list(chosen)] = 0.0
            return impulses / max(float(np.abs(impulses).max(initial=0.0)), TINY), rates

        chosen = active_constraints(len(touching), solve, PUSH, still)
        if chosen is None:
            return None
        struck = tuple(touching[k] for k in chosen)
        v, impulses = self._impact(struck)
        rates = self.rates(touching, v)
        rates[list(chosen)] = 0.0
        remaining = self._staying(touching, rates, still)
        of_touch = dict.fromkeys(touching, 0.0)
        of_touch.update(zip(struck, impulses.tolist(), strict=True))
        return v, of_touch, remaining

    @staticmethod
    def _staying(touching: Touches, rates: FloatArray, still: float) -> Touches:
        """Sections that do not leave."""
        return tuple(touch for touch, rate in zip(touching, rates, strict=True) if rate <= still)

    def pressing(self, candidates: Touches, v: FloatArray) -> Touches | None:
        """Which of the sections that touch, and neither approach nor leave, press; None where nothing settles it."""
        if not candidates:
            return ()
        size = self.plain.size
        turning = self._follower(candidates).rates(self.before.x, v, self.inputs)[1]
        by_unknowns = self._gradients(candidates)

        def solve(chosen: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
            pressed = tuple(candidates[k] for k in chosen)
            start = self.start(v, pressed)
            opening = by_unknowns @ start.instant.a[:size] + turning
            opening[list(chosen)] = 0.0
            forces = start.instant.x[size:]
            return forces / max(1.0, float(np.abs(forces).max(initial=0.0))), opening

        scale = float(np.abs(turning).max()) + 1.0 / self.interval**2
        chosen = active_constraints(len(candidates), solve, PUSH, STILL * scale)
        if chosen is None:
            return None
        return tuple(candidates[k] for k in chosen)

    def back_at_once(self, leaving: Touches, start: Instant) -> Touches:
        """Sections that leave so slowly that they are back in next to no time.

        Args:
            leaving: the sections.
            start: velocities and accelerations with which they do.
        """
        if not leaving:
            return ()
        size = self.plain.size
        rates, turning = self._follower(leaving).rates(self.before.x, start.v[:size], self.inputs)
        opening = self._gradients(leaving) @ start.a[:size] + turning
        soon = 2.0 * rates < -opening * BRIEF * self.interval
        return tuple(touch for touch, is_soon in zip(leaving, soon, strict=True) if is_soon)

    def held_still(self, v: FloatArray, touches: Touches) -> FloatArray:
        """Velocities nearest to given ones at which some sections neither approach nor leave."""
        return replace(self, before=replace(self.before, v=v))._impact(touches)[0]

    def kinetic(self, v: FloatArray) -> float:
        """Kinetic energy, J."""
        value, rate, *_ = self.inputs
        kinetic, *_ = self.contacts.model.energies(self.before.x, v, value, rate)
        return float(kinetic)

    def _impact(self, touches: Touches) -> tuple[FloatArray, FloatArray]:
        """Velocities after an impact at all of some sections, and its impulses."""
        if not touches:
            return self.before.v, np.zeros(0)
        size = self.plain.size
        equations = self.contacts.equations(self.plain, self.piece, touches)
        x = _padded(self.before.x, touches)
        blow = impact(equations, self.before.time, x, _padded(self.before.v, touches), self.interval)
        # The impulse stands on the left of the balance, as the force does.
        return blow.v[:size], blow.impulses[size:]

    def rates(self, touches: Touches, v: FloatArray) -> FloatArray:
        """Rates of the gaps of some sections, shape (m,), 1/s."""
        return self._follower(touches).rates(self.before.x, v, self.inputs)[0]

    def _gradients(self, touches: Touches) -> FloatArray:
        return np.array(self._follower(touches).state(self.before.x, self.inputs.value).gradients)

    def _follower(self, touches: Touches) -> Follower:
        return Follower(self.contacts.facings, touches)


def _padded(values: FloatArray, touches: Touches) -> FloatArray:
    """Unknowns, or their rates, with zeros for the forces of contact."""
    return np.concatenate([values, np.zeros(len(touches))])


def _guarded(guard: int | None, count: int) -> tuple[int | None, int]:
    """What a guard is of, and the number of its contact, or of the rod and obstacle."""
    if guard is None:
        return None, 0
    kind = min(guard // count, GAP) if count else GAP
    return kind, guard - kind * count
