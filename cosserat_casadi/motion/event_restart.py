"""Continuation of a motion after its equations change: the interface that cables, stops and contacts share."""

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
"""State of the switches between two events: the taut cables and the joints at their stops, or the contacts."""

HeldPhases = TypeVar("HeldPhases", covariant=True)
"""Phases in a record that holds phases and never takes them as an argument."""


LAID_DOWN = "laid_down"
"""Kind of the event in which a rod is laid down because its contacts change over and over."""

Settling = Callable[[Instant], Instant]
"""End of a step, in the unknowns of the model and the contact forces ↦ corrected end."""


@dataclass(frozen=True)
class ContactEvent:
    """A change of contact in a motion, of a cable that may go slack, or of a joint with a stop.

    Attributes:
        kind: "impact", "lift_off", "slide_to_end", "slide_from_end", "slide_over_joint", "lie_down" or "laid_down";
            with friction also "stick" or "slip";
            for a cable "taut" or "slack", for a joint "stop_hit" or "stop_left".
        time: time of the event, s.
        owner: name of the rod or body that touches, or of the cable or joint.
        obstacle: name of the obstacle; for a joint "lower_stop" or "upper_stop"; empty for a cable.
        place: abscissa X of the section; 0 for a body, a cable or a joint.
        energy: kinetic energy lost in the impact, or as the cable became taut, J; zero for other events.
        impulse: impulse of the obstacle on the rod along the normal, N s, or of the stop on the joint, N s or N m s;
            zero for other events.
        of_body: whether a body touches.
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
    """The state from which a motion goes on after an event, or begins.

    Attributes:
        start: state after the event, with accelerations, and tensions or contact forces.
        phases: the taut cables and the joints at their stops, or the contacts, after the event.
        lost: energy lost in impacts, J.
        work: work of moving inputs, such as a base, in the event, J.
        events: changes of contact.
        stalled: sentence that says why the motion cannot go on; None if it can.
    """

    start: ConsistentStart
    phases: HeldPhases
    lost: float = 0.0
    work: float = 0.0
    events: tuple[ContactEvent, ...] = ()
    stalled: str | None = None


class Switching(Protocol[Phases]):
    """Cables and stops, or contacts, that switch between equations of motion, which are smooth between events."""

    def first_phases(self, x: FloatArray, inputs: FloatArray) -> Phases:
        """Determine the phases at a state."""

    def arranged(self, plain: MotionEquations, piece: Piece, phases: Phases) -> tuple[MotionEquations, Guards | None]:
        """Make the equations of motion in these phases, and guards that are not negative while the phases last."""

    def settling(self, plain: MotionEquations, piece: Piece, phases: Phases) -> Settling | None:
        """Return the correction of the ends of steps in these phases; None if the ends need no correction."""

    def restarted(
        self, plain: MotionEquations, piece: Piece, at: Instant, phases: Phases, guard: int | None, interval: float
    ) -> Restart[Phases]:
        """Restart a motion after an event, or start it."""
