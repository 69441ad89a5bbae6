"""The contacts of a computed motion: places and forces at any time, and how deep rods are inside obstacles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_forces import Follower, Touches
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.rubbing_step import RubbingStep, along_tangents
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import TimeStep


@dataclass(frozen=True)
class MotionContact:
    """A section that touches an obstacle at some time.

    Attributes:
        obstacle: name of the obstacle, or of the other rod.
        owner: name of the rod, or of the body, that touches.
        at: abscissa X of the section; 0 of a body.
        force: force on the rod along the normal of the obstacle, world axes, shape (3,), N.
        lies: whether it is one of the sections that hold a lying rod; else the gap is least there, or it is an end.
        of_body: whether a body touches.
        friction: force on the rod along the surface, world axes, shape (3,), N; None for an obstacle without friction.
        slips: whether the contact slips; it always does without friction. Else it sticks.
        at_other: abscissa X of the section of the other rod; None if an obstacle is touched.
    """

    obstacle: str
    owner: str
    at: float
    force: FloatArray
    lies: bool = False
    of_body: bool = False
    friction: FloatArray | None = None
    slips: bool = True
    at_other: float | None = None


class Inside(NamedTuple):
    """Depth of a section or a body inside an obstacle.

    Attributes:
        depth: depth over the length of the rod; negative outside.
        owner: name of the rod, or of the body.
        obstacle: name of the obstacle.
        place: abscissa X of the section; 0 of a body.
        of_body: whether a body is inside.
    """

    depth: float
    owner: str
    obstacle: str
    place: float
    of_body: bool


@dataclass(frozen=True)
class Stretch:
    """A part of a motion, between two events, in which the contacts stay the same.

    Attributes:
        piece: piece of the inputs.
        touches: the contacts, with their places at the start.
        steps: steps of the motion, with the contact forces appended to the unknowns of the model.
        laid: indices of the pairs of a rod and an obstacle in which the rod lies.
    """

    piece: Piece
    touches: Touches
    steps: Sequence[TimeStep]
    laid: frozenset[int]


@dataclass(frozen=True)
class ContactRecord:
    """The contacts of a motion.

    Attributes:
        model: the model, built for a motion.
        stretches: stretches of the motion, in order of time.
        to_model: map from a state of the steps to a state in the unknowns of the model, contact forces appended.
    """

    model: Model
    stretches: Sequence[Stretch]
    to_model: Callable[[Instant], Instant]

    def at(self, number: int, instant: Instant) -> tuple[MotionContact, ...]:
        """The contacts at an instant of a step.

        Args:
            number: number of the step, counted from the start of the motion; ignored if there are no steps.
            instant: state in the unknowns of the model, with the contact forces appended.
        """
        if not self._begins:
            return ()
        stretch, touches, step = self._begins[number]
        follower = Follower(self._facings, touches)
        size, count = self.model.size, len(touches)
        x, inputs = instant.x[:size], stretch.piece.at(instant.time).value
        places, gaps = follower.gaps(x, inputs)
        forces = instant.x[size : size + count]
        found = []
        for k, (touch, place, gap, force) in enumerate(zip(touches, places, gaps, forces, strict=True)):
            facing = self._facings[touch.facing]
            axes = facing.axes(x, inputs)
            total = force * facing.force_unit * axes @ gap.normal
            at = min(max(place, 0.0), 1.0)
            lies = touch.facing in stretch.laid
            contact = MotionContact(
                facing.touched, facing.owner, at, total, lies, facing.of_body, at_other=gap.other_place
            )
            if isinstance(step, RubbingStep) and facing.against.rubs:
                along = facing.force_unit * instant.x[size + count :].reshape(-1, 2)[k]
                friction = axes @ along_tangents(gap.normal, step.axes[k], along)
                contact = replace(contact, friction=friction, slips=step.slips[k])
            found.append(contact)
        return tuple(found)

    def powers(self, stages: Sequence[Instant]) -> FloatArray:
        """Power of moving bases and lengths against the contact forces at all stages of all steps, shape (k,), W.

        A contact does no work: its power on the unknowns is the negative of its power on bases and lengths that move.
        """
        powers = np.zeros(len(stages))
        by_step = len(stages) // max(1, len(self._begins))
        size = self.model.size
        for number, instant in enumerate(stages):
            stretch, touches, _ = self._begins[number // by_step]
            inputs = stretch.piece.at(instant.time)
            if not touches or not np.any(inputs.rate):
                continue
            unknowns = self.to_model(instant).x
            x = unknowns[:size]
            follower = Follower(self._facings, touches)
            _, gaps = follower.gaps(x, inputs.value)
            forces = unknowns[size : size + len(touches)]
            for facing, gap, force in zip(follower.facings, gaps, forces, strict=True):
                powers[number] -= (
                    force * facing.energy_unit * float(facing.by_inputs(x, inputs.value, gap) @ inputs.rate)
                )
        return powers

    def deepest(self, x: FloatArray, inputs: FloatArray) -> Inside:
        """Find the section or body that is deepest inside an obstacle at a state."""
        found = []
        for facing in self._facings:
            minimum = facing.deepest(facing.nodes(x, inputs))
            found.append(Inside(-minimum.gap, facing.owner, facing.touched, minimum.place, facing.of_body))
        return max(found)

    @cached_property
    def _facings(self) -> list[Facing]:
        return facings(self.model)

    @cached_property
    def _begins(self) -> list[tuple[Stretch, Touches, TimeStep]]:
        """Triples for all steps: the stretch, the contacts at the start of the step, and the step."""
        size = self.model.size
        begins = []
        for stretch in self.stretches:
            follower = Follower(self._facings, stretch.touches)
            for step in stretch.steps:
                start = self.to_model(step.start)
                followed = follower.follow(start.x[:size], stretch.piece.at(start.time).value)
                both = zip(stretch.touches, followed.places, strict=True)
                touches = [touch._replace(place=place) for touch, place in both]
                begins.append((stretch, tuple(touches), step))
        return begins
