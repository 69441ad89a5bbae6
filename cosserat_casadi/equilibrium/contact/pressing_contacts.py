"""Small changes of an equilibrium in exact contact, as long as every contact presses.

A gap stays zero at the section that touches, or all along a line. A moving place of contact adds N (∂d′/∂x)² / d″ to
the stiffness, as in stability (contact_judgement.py). So small changes do not need moving elements: the rods' own
elements are as accurate as their modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.contact.contact_alternatives import NEAR
from cosserat_casadi.equilibrium.contact.contact_judgement import pressing
from cosserat_casadi.equilibrium.contact.contact_search import Penetrated, equilibrium_in
from cosserat_casadi.equilibrium.contact.contact_solve import LEAST_TOLERANCE
from cosserat_casadi.equilibrium.contact.contact_state import Touch, contact_loads, given_entries
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class PressingContacts:
    """Terms of contacts in the equations of small changes of n unknowns under m inputs.

    Attributes:
        held: gradients of the gaps that stay zero, shape (k, n).
        held_by_inputs: derivatives of these gaps by the inputs, shape (k, m).
        stiffness: term in the derivative of the residual by the unknowns, shape (n, n).
        stiffness_by_inputs: term in the derivative of the residual by the inputs, shape (n, m).
        given: indices of the inputs of the scene; the other inputs are forces of the contacts.
    """

    held: FloatArray
    held_by_inputs: FloatArray
    stiffness: FloatArray
    stiffness_by_inputs: FloatArray
    given: npt.NDArray[np.int64]


def pressing_contacts(solution: Solution) -> PressingContacts:
    """The pressing contacts of an equilibrium; empty without exact contact."""
    model = solution.model
    given = given_entries(model)
    if not contact_loads(model.scene):
        n, m = model.size, model.inputs.size
        return PressingContacts(np.zeros((0, n)), np.zeros((0, m)), np.zeros((n, n)), np.zeros((n, m)), given)
    found = equilibrium_in(solution)
    by_x = found.placed.gaps(found.x, solution.inputs)[1].full()
    by_inputs = found.placed.gaps_by_inputs(found.x, solution.inputs).full()
    contacts = pressing(found)
    return PressingContacts(
        by_x[contacts.held],
        by_inputs[contacts.held],
        contacts.stiffness(by_x, by_x),
        contacts.stiffness(by_x, by_inputs),
        given,
    )


def marginal_contact(solution: Solution) -> str:
    """A sentence on a contact with zero force and zero gap, which acts on one side of a motion alone; or none."""
    if not solution.model.scene.touches_exactly:
        return ""
    found = equilibrium_in(solution)
    discrete = solution.model.discrete
    for touch, push in found.pushes():
        if push <= LEAST_TOLERANCE:
            # A contact with zero force may pull by rounding.
            force = max(push, 0.0) * found.largest_force * discrete.contact_unit(touch.owner, of_body=touch.of_body)
            return f"{touch.owner!r} is on {touch.obstacle!r} and presses with {force:.2g} N only."
    for near in found.penetrations(-LEAST_TOLERANCE):
        if not _is_held(near, [touch for touch in found.state.touches if near.is_at(touch)]):
            way = f"{abs(near.depth):.2g} of the length"
            if near.depth > LEAST_TOLERANCE:
                inside = f"{near.owner!r} enters {near.obstacle!r} by {way} beside its contacts"
                return f"{inside}, within accuracy.tolerance: a smaller tolerance shows which contacts press there."
            return f"{near.owner!r} is {way} from {near.obstacle!r}, which it does not press."
    return ""


def _is_held(near: Penetrated, touches: Sequence[Touch]) -> bool:
    """Whether a stretch at an obstacle lies in the obstacle's contacts, or at a base that is clamped on it."""
    reached = NEAR if near.start == 0.0 and not near.of_body else -inf
    for touch in sorted(touches, key=lambda touch: float(touch.start)):
        if float(touch.start) - NEAR <= max(reached, near.start):
            reached = max(reached, float(touch.end) + NEAR)
    return near.end <= reached
