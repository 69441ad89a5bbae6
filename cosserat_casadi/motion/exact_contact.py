"""Exact contact in motion, without friction: rods touch obstacles at sections for a while, and what happens between.

Between events the sections that touch are the same, and the equations are smooth. Where a gap comes to zero there is an
impact without rebound: impulses along the normals take the speed of approach, as little as keeps all that touch apart
(F. Pfeiffer, C. Glocker, *Multibody Dynamics with Unilateral Contacts*, Wiley 1996, chapters 5 and 6). Where a force
comes to zero the section lifts off. Which of several contacts remain is a complementarity problem of velocities, then
of accelerations. A rod that touches with a bend touches at the section where its gap is least, which slides along it;
where the bend comes to zero it lies down, and is kept out at sections of its own. See docs/contact.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_onset import Onset, Struck
from cosserat_casadi.motion.contact_sections import facings
from cosserat_casadi.motion.facing import FLATTEST, Facing, Gap
from cosserat_casadi.motion.meeting_ends import SMOOTH, MeetingEnds
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.restart import ContactEvent, Restart
from cosserat_casadi.motion.touching import Follower, Touch, Touches, with_touches
from cosserat_casadi.numerics.guards import Guards
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

SAME_PLACE = 0.02
"""Distance of two sections, over the length, that touch one obstacle, up to which they count as one."""

TOUCHING = 1e-9
"""Gap, over the length, up to which a section touches where it is looked at."""

CLOSE = 1e-7
"""The same of a section of a rod that lies: it is held at that height."""

LEEWAY = 1e-8
"""How much lower a section without a force may come than it was at the last event, over the length.

It has left, or has come to rest, to rounding: without that it would be back in no time.
"""

MOST_IN_A_MOMENT = 8
"""Changes of contact in a moment from which on rods that touch at sliding sections lie down."""

MOMENT = 0.1
"""Such a moment, over the interval after an event."""

NO_PULL = 1e-6
"""Force, in its unit, that one counts as which may pull: a guard that is zero would be an event at once."""

FORCE, END, BEND, GAP, CLEAR = range(5)
"""What a guard is of: a force, a place at the end of the rod, the bend of a gap, the gaps of what does not touch, and a
rod that has got up."""


@dataclass(frozen=True)
class Arrangement:
    """What touches during a stretch of a motion.

    Attributes:
        touches: the contacts.
        laid: numbers of the pairs of a rod and an obstacle in which the rod lies; never of pairs with a body.
        follower: of the contacts.
        floors: least gaps that what does not touch may have, an array for each pair: one for each section of a rod that
            lies, else one.
        forces_from: time before which forces may pull: after a blow what is stiff has to come to rest, s.
        moment: beginning of the moment in which changes are counted, s.
        changes: changes in it.
    """

    touches: Touches = ()
    laid: frozenset[int] = frozenset()
    follower: Follower = field(default_factory=lambda: Follower((), ()))
    floors: tuple[FloatArray, ...] = ()
    forces_from: float = -np.inf
    moment: float = -np.inf
    changes: int = 0


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

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> Arrangement:
        """What touches at a state."""
        found, laid = self._touching(x, inputs, (), frozenset())
        # What is deeper inside is no contact: its constraint is told to be open.
        touches = tuple(touch if abs(touch.height) <= CLOSE else touch._replace(height=0.0) for touch in found)
        return Arrangement(touches, laid, Follower(self.facings, touches))

    def arranged(self, plain: MotionEquations, piece: Piece, phases: Arrangement) -> tuple[MotionEquations, Guards]:
        """The equations, and what has to stay at zero or above while they hold."""
        guards = self._guards(piece, phases)
        if not phases.touches:
            return plain, guards
        return with_touches(plain, phases.follower, piece), guards

    def _guards(self, piece: Piece, arrangement: Arrangement) -> Guards:
        """Forces, places within the rod, bends of gaps, and gaps of all else; they are asked for along the motion."""
        touches = arrangement.touches
        follower = arrangement.follower
        size = self.model.size

        def values(instant: Instant) -> FloatArray:
            x = instant.x[:size]
            inputs = piece.at(instant.time).value
            places, gaps, gone = follower.follow(x, inputs)
            forces = instant.x[size:]
            if instant.time <= arrangement.forces_from:
                forces = np.maximum(forces, NO_PULL)
            ends = np.ones(len(touches))
            bends = np.ones(len(touches))
            placed = [touch._replace(place=place) for touch, place in zip(touches, places, strict=True)]
            for k, (touch, gap) in enumerate(zip(placed, gaps, strict=True)):
                if touch.facing not in arrangement.laid:
                    ends[k] = self._within(touch, x, inputs)
                if touch.slides:
                    bends[k] = -1.0 if gone[k] else gap.bend - FLATTEST
            others = np.ones(len(self.facings))
            clear = np.ones(len(self.facings))
            for number, facing in enumerate(self.facings):
                nodes = facing.nodes(x, inputs)
                floor = arrangement.floors[number]
                if number not in arrangement.laid:
                    others[number] = min(1.0, self._lowest(number, nodes, placed) - float(floor[0]))
                    continue
                own = [touch.place for touch in placed if touch.facing == number]
                untouched = ~np.isin(facing.laid_at, own)
                others[number] = np.min((facing.laid_gaps(nodes) - floor)[untouched], initial=1.0)
                if not own:
                    clear[number] = CLOSE - facing.deepest(nodes).gap
            return np.concatenate([forces, ends, bends, others, clear])

        return values

    def _within(self, touch: Touch, x: FloatArray, inputs: FloatArray) -> float:
        """How far a place is from the ends of the rod; of an end, how fast the gap rises towards all rods there."""
        if touch.slides:
            return min(touch.place, 1.0 - touch.place)
        if self.facings[touch.facing].of_body:
            return 1.0
        return self.meeting_ends.rise(touch, x, inputs)

    def _lowest(self, number: int, nodes: FloatArray, touches: Sequence[Touch]) -> float:
        """The least gap, over the length, of a rod that does not lie or of a body, but for what touches.

        Args:
            number: of the rod or body and obstacle.
            nodes: positions, shape (M, 3), m.
            touches: the contacts, at their places.
        """
        own = [touch.place for touch in touches if touch.facing == number]
        beside = [end for touch in touches for end in self.meeting_ends.beside(touch, SAME_PLACE)]
        left_out = [X for other, X in beside if other == number]
        return self.facings[number].lowest(nodes, own, left_out)

    def restarted(
        self,
        plain: MotionEquations,
        piece: Piece,
        at: Instant,
        phases: Arrangement,
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
        moment, changes = phases.moment, phases.changes + 1
        if at.time - moment > MOMENT * interval:
            moment, changes = at.time, 0
        onset = Onset(self.model, self.facings, plain, piece, before, interval, changes)
        known = self._known(phases, guard, before, onset.inputs.value)
        if changes > MOST_IN_A_MOMENT:
            known = self._all_lie(known, before, onset.inputs.value)
        restart = self._struck(onset, known)
        counted = replace(restart.phases, moment=moment, changes=changes)
        return replace(restart, phases=counted)

    def _known(self, phases: Arrangement, guard: int | None, before: Instant, inputs: FloatArray) -> _Known:
        """What a guard that came to zero makes of contacts that there were.

        Args:
            phases: these contacts.
            guard: number of the guard; None for a start, or another piece of the inputs.
            before: state before the event.
            inputs: at its time.
        """
        places, _ = phases.follower.gaps(before.x, inputs)
        held = [touch._replace(place=place) for touch, place in zip(phases.touches, places, strict=True)]
        kind, number = _guarded(guard, len(held), len(self.facings))
        if kind == FORCE:
            left = held.pop(number)
            return _Known(tuple(held), phases.laid, (left,), (self._event("lift_off", before.time, left),))
        known = _Known(tuple(held), phases.laid)
        if kind == BEND:
            if phases.follower.gone(before.x, inputs, places)[number]:
                # Where it was last: beyond the event it is elsewhere.
                held[number] = held[number]._replace(place=phases.follower.places[number])
            return self._lying(replace(known, held=tuple(held)), held[number], before, inputs)
        if kind == END:
            end = held[number]
            moved = self.meeting_ends.gone_on(end, before.x, inputs)
            if moved.facing in phases.laid:
                # Where the next rod lies, this one lies down too.
                return self._lying(known, end, before, inputs)
            held[number] = moved
            known = replace(known, held=tuple(held))
            facing = self.facings[moved.facing]
            if moved.slides and facing.at(facing.nodes(before.x, inputs), moved.place).bend <= FLATTEST:
                # An end that is left where the gap is flat leaves no section for another.
                return self._lying(known, moved, before, inputs)
            name = "slide_from_end" if moved.slides else "slide_to_end"
            if moved.facing != end.facing:
                name = "slide_over_joint"
            return replace(known, events=(self._event(name, before.time, moved),))
        if kind == CLEAR:
            return replace(known, laid=phases.laid - {number})
        return known

    def _lying(self, known: _Known, first: Touch, before: Instant, inputs: FloatArray) -> _Known:
        """Contacts where a rod lies down: what slides on the obstacle stays at the section that touches now."""
        facing = self.facings[first.facing]
        nodes = facing.nodes(before.x, inputs)
        held = []
        for touch in known.held:
            stays = touch
            if touch.facing == first.facing and touch.slides:
                stays = touch._replace(slides=False, height=facing.at(nodes, touch.place).value)
            held.append(stays)
        event = self._event("lie_down", before.time, first)
        return replace(known, held=tuple(held), laid=known.laid | {first.facing}, events=(*known.events, event))

    def _all_lie(self, known: _Known, before: Instant, inputs: FloatArray) -> _Known:
        """Contacts that change over and over in next to no time: all rods that touch lie down, but no bodies."""
        for touch in (*known.held, *known.left):
            if touch.facing not in known.laid and not self.facings[touch.facing].of_body:
                known = self._lying(known, touch, before, inputs)
        return known

    def _struck(self, onset: Onset, known: _Known) -> Restart:
        """How a motion goes on after what touches anew has struck."""
        x, inputs = onset.before.x, onset.inputs.value
        old = (*known.held, *known.left)
        touching, laid = self._touching(x, inputs, old, known.laid)
        onset = onset.held_still(touching[: len(old)])
        struck = onset.struck(touching)
        if struck is None:
            return self._stopped(onset, known, touching)
        laid_now = [touch for touch in touching[len(old) :] if touch.facing in laid - known.laid]
        events = [*known.events, *self._impacts(onset, touching, struck, len(old))]
        events += [self._event("lie_down", onset.before.time, touch) for touch in _one_of_each(laid_now)]
        lost = sum(self._energies(touching, struck))
        after = onset.at(struck.v)
        work = after.kinetic() - onset.kinetic() + lost if onset.driven else 0.0
        leaving = tuple(touch for touch in touching if touch not in struck.staying)
        staying = tuple(touch for touch in struck.staying if touch not in known.left)
        soon_back = after.soon_back(leaving, staying)
        if soon_back:
            stopped = after.held_still((*struck.staying, *soon_back))
            lost += after.kinetic() - stopped.kinetic()
            after = stopped
        pressing = after.pressing(self._on_sections((*staying, *soon_back), laid))
        if pressing is None:
            return self._stopped(onset, known, touching)
        arrangement = Arrangement(
            pressing,
            laid,
            Follower(self.facings, pressing),
            self._floors(x, inputs, pressing, laid),
            onset.before.time + onset.horizon,
        )
        return Restart(after.start(pressing), arrangement, lost, work, tuple(events))

    def _impacts(self, onset: Onset, touching: Touches, struck: Struck, known: int) -> list[ContactEvent]:
        """Impacts of the sections that touch anew, those behind the known ones."""
        energies = self._energies(touching, struck)
        found = []
        for touch, impulse, energy in list(zip(touching, struck.impulses, energies, strict=True))[known:]:
            if impulse > 0.0:
                push = float(impulse * self.facings[touch.facing].force_unit)
                found.append(self._event("impact", onset.before.time, touch, energy, push))
        return found

    def _energies(self, touching: Touches, struck: Struck) -> list[float]:
        """Energy that the impulse at each section takes, J: half of it times the speed that it takes."""
        energies = []
        for touch, impulse, speed in zip(touching, struck.impulses, struck.speeds, strict=True):
            unit = self.facings[touch.facing].energy_unit
            # Of sections that touched before there is none.
            energies.append(max(0.0, float(-0.5 * impulse * unit * speed)))
        return energies

    def _stopped(self, onset: Onset, known: _Known, touching: Touches) -> Restart:
        """The end of a motion, with everything as it was, because nothing is decided."""
        names = sorted({self.facings[touch.facing].obstacle.name for touch in touching})
        why = (
            f"At t = {onset.before.time:.6g} s it is not decided which of {len(touching)} contacts with "
            f"{', '.join(names)} remain."
        )
        return Restart(onset.start(()), Arrangement(), events=known.events, stalled=why)

    def _on_sections(self, touches: Touches, laid: frozenset[int]) -> Touches:
        """Contacts of rods that lie at their sections: a place between two of them is given up where one touches."""
        kept = []
        for touch in touches:
            at = self.facings[touch.facing].laid_at
            if touch.facing in laid and touch.place not in at:
                following = int(np.searchsorted(at, touch.place))
                beside = at[max(following - 1, 0) : following + 1]
                own = [other.place for other in touches if other.facing == touch.facing]
                if np.isin(beside, own).any():
                    continue
            kept.append(touch)
        return tuple(kept)

    def _floors(
        self, x: FloatArray, inputs: FloatArray, pressing: Touches, laid: frozenset[int]
    ) -> tuple[FloatArray, ...]:
        """The least gaps that what does not touch may have from now on."""
        floors = []
        for number, facing in enumerate(self.facings):
            nodes = facing.nodes(x, inputs)
            if number in laid:
                gaps = facing.laid_gaps(nodes)
            else:
                gaps = np.array([self._lowest(number, nodes, pressing)])
            floors.append(np.where(gaps > LEEWAY, 0.0, np.minimum(gaps, 0.0) - LEEWAY))
        return tuple(floors)

    def _touching(
        self, x: FloatArray, inputs: FloatArray, known: Sequence[Touch], laid: frozenset[int]
    ) -> tuple[Touches, frozenset[int]]:
        """Known contacts, and all others that touch at a state; and which rods lie then."""
        found: list[Touch] = []
        lying: list[Touch] = []
        for number, facing in enumerate(self.facings):
            nodes = facing.nodes(x, inputs)
            own = [touch.place for touch in known if touch.facing == number]
            if number not in laid:
                minima = facing.minima(nodes, TOUCHING)
                new = [one for one in minima if all(abs(one.place - place) > SAME_PLACE for place in own)]
                if facing.of_body or not any(_is_flat(facing.at(nodes, one.place)) for one in new):
                    found += [Touch(number, one.place, one.inside, min(one.gap, 0.0)) for one in new]
                    continue
                laid = laid | {number}
            gaps = facing.laid_gaps(nodes)
            lying += [
                Touch(number, place, False, gap)
                for place, gap in zip(facing.laid_at.tolist(), gaps.tolist(), strict=True)
                if gap <= CLOSE and place not in own
            ]
        touches = self.meeting_ends.distinct(tuple(known), tuple(found), SAME_PLACE)
        still = [one._replace(slides=False) if one.facing in laid else one for one in touches]
        return (*still, *lying), laid

    def _event(self, kind: str, time: float, touch: Touch, energy: float = 0.0, impulse: float = 0.0) -> ContactEvent:
        facing = self.facings[touch.facing]
        name = facing.obstacle.name
        return ContactEvent(kind, time, facing.rod, name, touch.place, energy, impulse, facing.of_body)


@dataclass(frozen=True)
class _Known:
    """Contacts that there were before an event.

    Attributes:
        held: those that go on, where they are at the event.
        laid: numbers of the pairs of a rod and an obstacle in which the rod lies from now on.
        left: the one that lifts off, if one does.
        events: of them.
    """

    held: Touches
    laid: frozenset[int]
    left: Touches = ()
    events: tuple[ContactEvent, ...] = ()


def _guarded(guard: int | None, count: int, facings: int) -> tuple[int | None, int]:
    """What a guard is of, and the number of its contact, or of the rod and obstacle.

    Args:
        guard: its number; None for none.
        count: number of contacts.
        facings: number of rods and obstacles.
    """
    if guard is None:
        return None, 0
    if guard < GAP * count:
        return guard // count, guard % count
    of_facing = guard - GAP * count
    return GAP + of_facing // facings, of_facing % facings


def _one_of_each(touches: Sequence[Touch]) -> list[Touch]:
    """One of the contacts of each rod with each obstacle."""
    return list({touch.facing: touch for touch in touches}.values())


def _is_flat(gap: Gap) -> bool:
    """Whether a rod lies along the obstacle about a section, within it or at its end, whose gap is the least."""
    return gap.bend <= FLATTEST and abs(gap.slope) <= SMOOTH
