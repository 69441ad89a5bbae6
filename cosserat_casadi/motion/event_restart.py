"""How a motion goes on where its equations change: what cables, stops and contacts have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.numerics.consistent_start import ConsistentStart
from cosserat_casadi.numerics.guards import Guards
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations

Phases = TypeVar("Phases")
"""State of the switches for a while: the cables that are taut and the joints at their stops, or the contacts."""

HeldPhases = TypeVar("HeldPhases", covariant=True)
"""Phases of what only holds phases and does not take them."""


LAID_DOWN = "laid_down"
"""Kind of the event in which a rod is laid down because its contacts change over and over."""

Settling = Callable[[Instant], Instant]
"""The end of a step, in the unknowns of the model and the forces of contacts ↦ the corrected end."""


@dataclass(frozen=True)
class ContactEvent:
    """A change of contact in a motion, of a cable that may go slack, or of a joint with a stop.

    Attributes:
        kind: "impact", "lift_off", "slide_to_end", "slide_from_end", "slide_over_joint", "lie_down" or "laid_down";
            with friction "stick" or "slip";
            of a cable "taut" or "slack", of a joint "stop_hit" or "stop_left".
        time: s.
        owner: name of the rod, or of the body, that touches; or of the cable or the joint.
        obstacle: name of the obstacle, "lower_stop" or "upper_stop"; empty of a cable.
        place: abscissa X of the section; 0 of a body, a cable or a joint.
        energy: kinetic energy that the impact took, or the cable that became taut, J; zero for other events.
        impulse: of the obstacle on the rod, along its normal there, N s, or of the stop on the joint, N s or N m s;
            zero for other events.
        of_body: whether it is a body that touches.
    """

    kind: str
    time: float
    owner: str
    obstacle: str
    place: float
    energy: float = 0.0
    impulse: float = 0.0
    of_body: bool = False


@dataclass(frozen=True)
class Restart(Generic[HeldPhases]):
    """How a motion goes on after an event, or begins.

    Attributes:
        start: state with accelerations and tensions, or forces of contact.
        phases: which cables are taut and which joints at their stops, or what touches.
        lost: energy that an impact has taken, J.
        work: work that a base or another input in motion has done in the event, J.
        events: changes of contact.
        stalled: why there is nothing to go on with; None where there is.
    """

    start: ConsistentStart
    phases: HeldPhases
    lost: float = 0.0
    work: float = 0.0
    events: tuple[ContactEvent, ...] = ()
    stalled: str | None = None


class Switching(Protocol[Phases]):
    """Cables and stops, or contacts, that switch between equations of motion, each smooth for a while."""

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> Phases:
        """The phases at a state."""

    def arranged(self, plain: MotionEquations, piece: Piece, phases: Phases) -> tuple[MotionEquations, Guards | None]:
        """The equations of motion in these phases, and guards that stay at zero or above while the equations hold."""

    def settling(self, plain: MotionEquations, piece: Piece, phases: Phases) -> Settling | None:
        """The correction of the ends of steps in these phases; None for ends as they are."""

    def restarted(
        self, plain: MotionEquations, piece: Piece, at: Instant, phases: Phases, guard: int | None, interval: float
    ) -> Restart[Phases]:
        """How a motion goes on, or begins."""
