"""Exact contact in motion, without friction: stretches of a motion with fixed contacts, and the events between them.

Between events the contacts stay the same, and the equations are smooth. Where a gap comes to zero there is an
impact: impulses along the normals cancel the speed of approach, and return the fraction of it that is the obstacle's
coefficient of restitution, zero by default; they are the least that keep all contacts from penetrating
(F. Pfeiffer, C. Glocker, *Multibody Dynamics with Unilateral Contacts*, Wiley 1996, chapters 5 and 6). Where a force
comes to zero the section lifts off. Which of several contacts remain is a complementarity problem of velocities, then
of accelerations. A rod that touches with a bend touches at the section where its gap is least, which slides along it;
where the bend comes to zero it lies down, and is kept out at further sections. See docs/contact-in-motion.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.coincident_ends import BASE, SMOOTH, TIP, MeetingEnds
from cosserat_casadi.motion.contact_forces import Follower, MovingContact, Touches, with_touches
from cosserat_casadi.motion.contact_gap import FLATTEST, Facing, SectionGap
from cosserat_casadi.motion.contact_guards import (
    CLOSE,
    SAME_PLACE,
    ContactGuards,
    ContactPhase,
    GuardKind,
    apart,
    guarded,
)
from cosserat_casadi.motion.contact_onset import Onset, Struck
from cosserat_casadi.motion.event_restart import LAID_DOWN, ContactEvent, Restart
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries
from cosserat_casadi.numerics.consistent_start import least_change, saddle_at
from cosserat_casadi.numerics.guards import Guards
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

TOUCHING = 1e-9
"""Largest gap, over the length, at which a section that is checked touches."""

LEEWAY = 1e-8
"""Distance, over the length, by which a section without a force may fall below its height at the last event.

It has lifted off or come to rest up to rounding; with no leeway it would touch again at once.
"""

LEVEL = 1e-9
"""Slope of a gap below which the direction in which a rod rolls is undecided."""

CLOSED = 1e-13
"""Gap, over the length, that counts as closed at the end of a step."""

CLOSINGS = 3
"""Most corrections of the positions that close a gap; each leaves an error of the order of the gap's square."""

MOST_IN_A_MOMENT = 8
"""Changes of contact in a moment above which rods that touch at sliding sections lie down."""

MOMENT = 0.1
"""Duration of the moment in which such changes are counted, over the interval after an event."""


@dataclass(frozen=True)
class ExactContacts:
    """The contacts of a model with obstacles that have no width.

    Attributes:
        model: the model, built for a motion.
        libraries: shared objects that contain the functions of its points.
    """

    model: Model
    libraries: Libraries = INTERPRETED

    @cached_property
    def facings(self) -> list[Facing]:
        """Pairs of a rod or body and an obstacle or rod that may touch."""
        return facings(self.model, self.libraries)

    @cached_property
    def meeting_ends(self) -> MeetingEnds:
        """The ends of rods that coincide."""
        return MeetingEnds(self.facings)

    @cached_property
    def guards(self) -> ContactGuards:
        """The guards of all phases: quantities that are not negative while contacts do not change."""
        return ContactGuards(self.model.size, self.facings, self.meeting_ends)

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> ContactPhase:
        """The contacts at a state."""
        found, laid = self._touching(x, inputs, (), frozenset())
        # What is deeper inside is no contact: its constraint is told to be open.
        touches = tuple(touch if abs(touch.height) <= CLOSE else touch._replace(height=0.0) for touch in found)
        return ContactPhase(touches, laid, Follower(self.facings, touches))

    def arranged(self, plain: MotionEquations, piece: Piece, phases: ContactPhase) -> tuple[MotionEquations, Guards]:
        """Make the equations of motion with these contacts, and the guards that are not negative while they last."""
        guards = self.guards.of(piece, phases)
        if not phases.touches:
            return plain, guards
        return with_touches(plain, phases.follower, piece), guards

    def settled(self, plain: MotionEquations, piece: Piece, phases: ContactPhase, at: Instant) -> Instant:
        """Correct the end of a step by the least changes, in the metric of the mass, that close gaps and their rates.

        The stages of a step close the gaps, but leave their rates open by the error of the step. The next step removes
        such a rate by a force that is inversely proportional to its size, which may pull if the step is short. A step
        that is cut where a guard vanishes leaves gaps open too.

        Args:
            plain: equations of the model.
            piece: piece of the inputs.
            phases: the contacts.
            at: the end of the step, with the contact forces.
        """
        size = plain.size
        inputs = piece.at(at.time)
        follower = phases.follower
        x, v = at.x[:size], at.v[:size]
        saddle = saddle_at(plain, Instant(at.time, x, v, at.a[:size]))
        _, gaps = follower.gaps(x, inputs.value)
        gradients = follower.gradients(x, inputs.value, gaps)
        pushes = follower.pushes(gradients)
        open_by = np.array(follower.open_by(gaps))
        for _ in range(CLOSINGS):
            if np.abs(open_by).max() <= CLOSED:
                break
            x = x + least_change(saddle, gradients, pushes, open_by)
            _, gaps = follower.gaps(x, inputs.value)
            open_by = np.array(follower.open_by(gaps))
        rates, _ = follower.rates(x, v, inputs)
        v = v + least_change(saddle, gradients, pushes, rates)
        return replace(at, x=np.append(x, at.x[size:]), v=np.append(v, at.v[size:]))

    def restarted(
        self,
        plain: MotionEquations,
        piece: Piece,
        at: Instant,
        phases: ContactPhase,
        guard: int | None,
        interval: float,
        *,
        jerked: bool = False,
    ) -> Restart:
        """Restart a motion after an event, or start it.

        Args:
            plain: equations of the model.
            piece: piece of the inputs.
            at: state before the event.
            phases: the contacts before the event.
            guard: index of the guard that came to zero; None at a start, or where another piece of the inputs starts.
            interval: time after the event in which the inputs are smooth, s.
            jerked: whether a cable or a stop has changed the velocities at this instant.
        """
        before = at.first(self.model.size)
        moment, changes = phases.moment, phases.changes + 1
        if at.time - moment > MOMENT * interval:
            moment, changes = at.time, 0
        saddle = saddle_at(plain, before)
        onset = Onset(self.model, self.facings, plain, piece, before, interval, changes, saddle)
        known = self._known(phases, guard, before, onset.inputs.value)
        if changes > MOST_IN_A_MOMENT:
            known = self._all_lie(known, before, onset.inputs.value)
        restart = self._struck(onset, known, jerked=jerked)
        counted = replace(restart.phases, moment=moment, changes=changes)
        return replace(restart, phases=counted)

    def _known(self, phases: ContactPhase, guard: int | None, before: Instant, inputs: FloatArray) -> _Known:
        """Contacts after a guard has come to zero, before impacts are solved.

        Args:
            phases: the contacts before the event.
            guard: index of the guard; None at a start, or where another piece of the inputs starts.
            before: state before the event.
            inputs: inputs at the event.
        """
        places, _ = phases.follower.gaps(before.x, inputs)
        held = [touch._replace(place=place) for touch, place in zip(phases.touches, places, strict=True)]
        known = _Known(tuple(held), phases.laid)
        kind, number = guarded(guard, len(held), len(self.facings))
        match kind:
            case GuardKind.FORCE:
                return self._lifted_off(known, number, before)
            case GuardKind.END:
                return self._come_to_end(known, number, phases.follower.elements[number], before, inputs)
            case GuardKind.BEND:
                return self._without_bend(known, number, phases.follower, before, inputs)
            case GuardKind.CLEAR:
                return self._got_up(known, number, before, inputs)
            case GuardKind.GAP | None:
                # What touches anew is looked for in any case.
                return known

    def _lifted_off(self, known: _Known, number: int, before: Instant) -> _Known:
        """Contacts after one whose force would pull has lifted off."""
        held = list(known.held)
        left = held.pop(number)
        event = self._event("lift_off", before.time, left)
        return replace(known, held=tuple(held), left=(left,), events=(event,))

    def _come_to_end(self, known: _Known, number: int, element: int, before: Instant, inputs: FloatArray) -> _Known:
        """Contacts after one has slid to an end of its element or to another, or leaves an end; its rod may lie down.

        A contact at the end of an inner element goes on in the next element, where the gap has another bend.

        Args:
            known: the contacts.
            number: number of the contact.
            element: number of the element in which it slides.
            before: state before the event.
            inputs: inputs at the time of that state.
        """
        end = known.held[number]
        ends = self.facings[end.facing].ends
        is_beyond = end.place > (ends[element] + ends[element + 1]) / 2.0
        nearest = ends[element + is_beyond]
        if end.slides and apart(end, known.held) < abs(end.place - nearest):
            # Two that slide to one place would be one constraint twice.
            return self._lying(known, end, before, inputs)
        crosses = end.slides and BASE < nearest < TIP
        if crosses:
            moved = end._replace(place=nearest, element=element + (1 if is_beyond else -1))
        else:
            moved = self.meeting_ends.gone_on(end, before.x, inputs)
        if moved.facing in known.laid:
            # Where the next rod lies, this one lies down too.
            return self._lying(known, end, before, inputs)
        held = list(known.held)
        held[number] = moved
        known = replace(known, held=tuple(held))
        facing = self.facings[moved.facing]
        if moved.slides and facing.at(facing.nodes(before.x, inputs), moved.place, moved.element).bend <= FLATTEST:
            # An end that is left where the gap is flat leaves no section for another.
            return self._lying(known, moved, before, inputs)
        if crosses:
            return known
        name = "slide_from_end" if moved.slides else "slide_to_end"
        if moved.facing != end.facing:
            name = "slide_over_joint"
        return replace(known, events=(self._event(name, before.time, moved),))

    def _without_bend(
        self, known: _Known, number: int, follower: Follower, before: Instant, inputs: FloatArray
    ) -> _Known:
        """Contacts after the gap at one of them has become flat along the rod: the rod lies down."""
        held = list(known.held)
        places = [touch.place for touch in held]
        if follower.gone(before.x, inputs, places)[number]:
            # Where it was last: beyond the event it is elsewhere.
            held[number] = held[number]._replace(place=follower.places[number])
        return self._lying(replace(known, held=tuple(held)), held[number], before, inputs)

    def _got_up(self, known: _Known, number: int, before: Instant, inputs: FloatArray) -> _Known:
        """Contacts after a lying rod has got up: it rolls on from a touching section if the gap is least there."""
        facing = self.facings[number]
        held = list(known.held)
        for k, touch in enumerate(held):
            if touch.facing != number:
                continue
            if abs(facing.at(facing.nodes(before.x, inputs), touch.place).slope) > SMOOTH:
                return known
            held[k] = touch._replace(slides=True)
        return replace(known, held=tuple(held), laid=known.laid - {number})

    def _lying(
        self, known: _Known, first: MovingContact, before: Instant, inputs: FloatArray, kind: str = "lie_down"
    ) -> _Known:
        """Contacts after a rod has lain down: its sliding contacts with the obstacle stay at their present sections."""
        facing = self.facings[first.facing]
        nodes = facing.nodes(before.x, inputs)
        held = []
        for touch in known.held:
            stays = touch
            if touch.facing == first.facing and touch.slides:
                stays = touch._replace(slides=False, height=facing.at(nodes, touch.place).value)
            held.append(stays)
        event = self._event(kind, before.time, first)
        return replace(known, held=tuple(held), laid=known.laid | {first.facing}, events=(*known.events, event))

    def _all_lie(self, known: _Known, before: Instant, inputs: FloatArray) -> _Known:
        """Contacts after many changes within a moment: all touching rods lie down; bodies never do."""
        for touch in (*known.held, *known.left):
            if touch.facing not in known.laid and not self.facings[touch.facing].of_body:
                known = self._lying(known, touch, before, inputs, LAID_DOWN)
        return known

    def _struck(self, onset: Onset, known: _Known, *, jerked: bool) -> Restart:
        """Restart after new contacts have struck, or after a cable or a stop has jerked the old ones."""
        x, inputs = onset.before.x, onset.inputs.value
        old = (*known.held, *known.left)
        touching, laid = self._touching(x, inputs, old, known.laid)
        if not jerked:
            onset = onset.held_still(touching[: len(old)])
        struck = onset.struck(touching, len(old))
        if struck is None:
            return self._stopped(onset, known, touching)
        laid_now = [touch for touch in touching[len(old) :] if touch.facing in laid - known.laid]
        events = [*known.events, *self._impacts(onset, touching, struck, len(old))]
        # One contact, the last, of each rod with each obstacle.
        of_each = {touch.facing: touch for touch in laid_now}.values()
        events += [self._event("lie_down", onset.before.time, touch) for touch in of_each]
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
        # A jerk takes contacts off, and over an end a section may leave at once.
        at_end = any(event.kind == "slide_to_end" for event in known.events)
        off = [
            touch
            for touch in touching[: len(known.held)]
            if touch not in pressing
            and (touch in leaving if jerked else at_end and not touch.slides and touch.facing not in laid)
        ]
        events += [self._event("lift_off", onset.before.time, touch) for touch in off]
        arrangement = ContactPhase(
            pressing,
            laid,
            Follower(self.facings, pressing),
            self._floors(x, inputs, pressing, laid),
            onset.before.time + onset.horizon,
            slopes=self._slopes(x, inputs, pressing, laid),
        )
        return Restart(after.start(pressing), arrangement, lost, work, tuple(events))

    def _impacts(self, onset: Onset, touching: Touches, struck: Struck, known: int) -> list[ContactEvent]:
        """Events of the impacts of new contacts, which follow the ``known`` first ones."""
        energies = self._energies(touching, struck)
        found = []
        for touch, impulse, energy in list(zip(touching, struck.impulses, energies, strict=True))[known:]:
            if impulse > 0.0:
                push = float(impulse * self.facings[touch.facing].force_unit)
                found.append(self._event("impact", onset.before.time, touch, energy, push))
        return found

    def _energies(self, touching: Touches, struck: Struck) -> list[float]:
        """Energy lost by the impulse at each contact, J: half the impulse times the sum of the speeds around it."""
        energies = []
        for touch, impulse, speed in zip(touching, struck.impulses, struck.speeds, strict=True):
            unit = self.facings[touch.facing].energy_unit
            # Of sections that touched before there is none.
            energies.append(max(0.0, float(-0.5 * impulse * unit * speed)))
        return energies

    def _stopped(self, onset: Onset, known: _Known, touching: Touches) -> Restart:
        """End of a motion at which it stays undecided which contacts remain; the state is unchanged."""
        names = sorted({self.facings[touch.facing].touched for touch in touching})
        why = (
            f"At t = {onset.before.time:.6g} s the law of contact does not decide which of {len(touching)} contacts "
            f"with {', '.join(names)} remain."
        )
        return Restart(onset.start(()), ContactPhase(), events=known.events, stalled=why)

    def _on_sections(self, touches: Touches, laid: frozenset[int]) -> Touches:
        """Contacts without those of lying rods between two holding sections of which one touches."""
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
        """Least admissible gaps of everything that does not touch, an array for each pair."""
        floors = []
        for number, facing in enumerate(self.facings):
            nodes = facing.nodes(x, inputs)
            if number in laid:
                gaps = facing.laid_gaps(nodes)
            else:
                gaps = np.array([self.guards.lowest(number, nodes, pressing)])
            floors.append(np.where(gaps > LEEWAY, 0.0, np.minimum(gaps, 0.0) - LEEWAY))
        return tuple(floors)

    def _slopes(self, x: FloatArray, inputs: FloatArray, pressing: Touches, laid: frozenset[int]) -> tuple[float, ...]:
        """Slope of the gap of each pair at the only section on which a rod lies, if it may roll on there; else zero."""
        slopes = [0.0] * len(self.facings)
        for number in laid:
            places = [touch.place for touch in pressing if touch.facing == number]
            if len(places) != 1:
                continue
            (place,) = places
            facing = self.facings[number]
            slope = facing.at(facing.nodes(x, inputs), place).slope
            # Over an end no rod rolls on.
            outwards = (place == TIP and slope > 0.0) or (place == BASE and slope < 0.0)
            if abs(slope) > LEVEL and not outwards:
                slopes[number] = slope
        return tuple(slopes)

    def _touching(
        self, x: FloatArray, inputs: FloatArray, known: Sequence[MovingContact], laid: frozenset[int]
    ) -> tuple[Touches, frozenset[int]]:
        """Known contacts and all new ones at a state, and the pairs in which rods lie."""
        found: list[MovingContact] = []
        lying: list[MovingContact] = []
        for number, facing in enumerate(self.facings):
            nodes = facing.nodes(x, inputs)
            own = [touch.place for touch in known if touch.facing == number]
            if number not in laid:
                minima = facing.minima(nodes, TOUCHING)
                new = [one for one in minima if not any(self._is_one(number, nodes, one.place, X) for X in own)]
                if facing.of_body or not any(_is_flat(facing.at(nodes, one.place)) for one in new):
                    found += [MovingContact(number, one.place, one.inside, min(one.gap, 0.0)) for one in new]
                    continue
                laid = laid | {number}
            gaps = facing.laid_gaps(nodes)
            lying += [
                MovingContact(number, place, False, gap)
                for place, gap in zip(facing.laid_at.tolist(), gaps.tolist(), strict=True)
                if gap <= CLOSE and place not in own
            ]
        touches = self.meeting_ends.distinct(tuple(known), tuple(found), SAME_PLACE)
        still = [one._replace(slides=False) if one.facing in laid else one for one in touches]
        return (*still, *lying), laid

    def _is_one(self, number: int, nodes: FloatArray, place: float, other: float) -> bool:
        """Whether two touching sections count as one contact: they are close, and the gap does not rise between them.

        The gap may rise from a touching end and vanish again close by: the rod strikes there, too.
        """
        distance = abs(place - other)
        if distance > SAME_PLACE:
            return False
        facing = self.facings[number]
        for end, towards in ((BASE, 1.0), (TIP, -1.0)):
            if distance > 0.0 and end in (place, other) and not facing.of_body:
                return towards * facing.at(nodes, end).slope <= SMOOTH
        return True

    def _event(
        self, kind: str, time: float, touch: MovingContact, energy: float = 0.0, impulse: float = 0.0
    ) -> ContactEvent:
        facing = self.facings[touch.facing]
        numbers = float(touch.place), float(energy), float(impulse)
        return ContactEvent(kind, time, facing.owner, facing.touched, *numbers, facing.of_body)


@dataclass(frozen=True)
class _Known:
    """Contacts at an event, before impacts are solved.

    Attributes:
        held: contacts that persist, at their places at the event.
        laid: indices of the pairs of a rod and an obstacle in which the rod lies from now on.
        left: the contact that lifts off, if one does.
        events: events of these contacts.
    """

    held: Touches
    laid: frozenset[int]
    left: Touches = ()
    events: tuple[ContactEvent, ...] = ()


def _is_flat(gap: SectionGap) -> bool:
    """Whether a rod lies along the obstacle at its section of least gap, which may be an end."""
    return gap.bend <= FLATTEST and abs(gap.slope) <= SMOOTH
