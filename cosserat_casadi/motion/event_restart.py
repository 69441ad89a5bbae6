"""Continuation of a motion after its equations change, by cables, stops or contacts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from cosserat_casadi.motion.contact_guards import ContactPhase
from cosserat_casadi.numerics.consistent_start import ConsistentStart
from cosserat_casadi.numerics.motion_equations import Instant

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
class Restart:
    """The state from which a motion goes on after an event, or begins.

    Attributes:
        start: state after the event, with accelerations, and tensions or contact forces.
        phases: the contacts, the taut cables and the joints at their stops after the event.
        lost: energy lost in impacts, J.
        work: work of moving inputs, such as a base, in the event, J.
        events: changes of contact.
        stalled: sentence that says why the motion cannot go on; None if it can.
    """

    start: ConsistentStart
    phases: ContactPhase
    lost: float = 0.0
    work: float = 0.0
    events: tuple[ContactEvent, ...] = ()
    stalled: str | None = None
