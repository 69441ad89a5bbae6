"""Exact contact, cables that may go slack and stops of joints: what switches the equations of a motion.

One kind of event is solved at a time.

The impact of a cable that becomes taut, or of a joint that meets its stop, is solved first, as if nothing touched. Then
the impact of contacts is solved, with taut cables and stopped joints held: obstacles push, and sections that are jerked
off leave. If both impacts are plastic, this equals one impact of all: to project velocities on a plane, and then on
part of it, is one projection. A joint leaves a stop that a blow of an obstacle would make pull.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_guards import ContactPhase
from cosserat_casadi.motion.event_restart import Restart, Settling
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.one_sided import Closed, OneSided
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries
from cosserat_casadi.numerics.consistent_start import consistent_start
from cosserat_casadi.numerics.guards import THROUGH, Guards
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations


@dataclass(frozen=True)
class SidedContacts:
    """Exact contacts of a model, its cables that may go slack, and the stops of its joints, if it has any.

    Attributes:
        model: the model, built for a motion.
        libraries: shared objects that contain the functions of the points that touch.
    """

    model: Model
    libraries: Libraries = INTERPRETED

    @cached_property
    def contacts(self) -> ExactContacts:
        """Contacts of the model with obstacles."""
        return ExactContacts(self.model, self.libraries)

    @cached_property
    def sided(self) -> OneSided:
        """Cables and stops of the model."""
        return OneSided(self.model)

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> ContactPhase:
        """Determine the contacts and the closed pairs at a state."""
        return self.with_pairs(self.contacts.first_phases(x, inputs), x, inputs)

    def with_pairs(self, phases: ContactPhase, x: FloatArray, inputs: FloatArray) -> ContactPhase:
        """Add the pairs that are closed at a state to contacts."""
        return replace(phases, closed=self.sided.first_phases(x, inputs))

    def arranged(
        self, plain: MotionEquations, piece: Piece, phases: ContactPhase
    ) -> tuple[MotionEquations, Guards | None]:
        """Make the equations of motion with these contacts and pairs, and guards of the pairs, then of the contacts.

        Guards are not negative while the phases last; None if nothing switches.
        """
        equations = self.sided.equations(plain, piece, phases.closed)
        of_pairs = self.sided.guards(piece, phases.closed)
        if not self.contacts.facings:
            return equations, of_pairs
        equations, of_contacts = self.contacts.arranged(equations, piece, phases)
        if of_pairs is None:
            return equations, of_contacts
        pairs = of_pairs
        return equations, lambda instant: np.concatenate([pairs(instant), of_contacts(instant)])

    def settling(self, plain: MotionEquations, piece: Piece, phases: ContactPhase) -> Settling | None:
        """Return the correction that closes the gaps of these contacts at the end of a step; None without contacts."""
        if not phases.touches:
            return None
        return partial(self.contacts.settled, self.sided.equations(plain, piece, phases.closed), piece, phases)

    def restarted(
        self,
        plain: MotionEquations,
        piece: Piece,
        at: Instant,
        phases: ContactPhase,
        guard: int | None,
        interval: float,
    ) -> Restart:
        """Restart or start a motion; arguments as for :meth:`ExactContacts.restarted`."""
        size = self.model.size
        before = at.first(size)
        count = len(self.sided.pairs)
        of_pair, of_contact = (guard, None) if guard is not None and guard < count else (None, guard)
        if of_contact is not None:
            of_contact -= count

        def begin(closed: Closed, v: FloatArray) -> Restart:
            equations = self.sided.equations(plain, piece, closed)
            if not self.contacts.facings:
                return Restart(consistent_start(equations, before.time, before.x, v, interval), phases)
            instant = Instant(before.time, before.x, v, before.a)
            jerked = v is not before.v
            return self.contacts.restarted(equations, piece, instant, phases, of_contact, interval, jerked=jerked)

        settled = self.sided.settled(
            plain, piece, before, phases.closed, of_pair, interval, begin, told=guard is not None
        )
        onward, closed, events = settled.onward, settled.closed, settled.events
        jerked = settled.v is not before.v
        if self.contacts.facings and (jerked or any(event.kind == "impact" for event in onward.events)):
            for number, pair in enumerate(self.sided.pairs):
                # What jerks stays closed: without it velocities would be those before, which close it.
                if not (closed[number] and pair.rigid) or (jerked and number == of_pair):
                    continue
                without = (*closed[:number], False, *closed[number + 1 :])
                free = begin(without, settled.v)
                opening = self.sided.opening(before.x, free.start.instant.v[:size], piece.at(before.time).value)
                if opening[number] * interval > THROUGH:
                    onward, closed = free, without
                    events = (*events, self.sided.event(number, before.time, closes=False))
        return replace(
            onward,
            phases=replace(onward.phases, closed=closed),
            lost=onward.lost + settled.lost,
            events=(*events, *onward.events),
        )
