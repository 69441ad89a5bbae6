"""Small motions about an equilibrium in exact contact: contacts that press hold, and points of contact slide.

A gap stays zero at the section that touches, along a line at all of it. What a moving place of contact does to the
stiffness is N (∂d′/∂x)² / d″, as in stability (equilibrium/contact/contact_judgement.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.contact.contact_judgement import pressing
from cosserat_casadi.equilibrium.contact.contact_search import ContactEquilibrium, equilibrium_in
from cosserat_casadi.equilibrium.contact.contact_solve import LEAST_TOLERANCE
from cosserat_casadi.equilibrium.contact.contact_state import contact_loads
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class PressingContacts:
    """What contacts add to the equations of small motions of n unknowns under m inputs.

    Attributes:
        held: gradients of the gaps that stay zero, shape (k, n).
        held_by_inputs: their derivatives with the inputs, shape (k, m).
        stiffness: added to the derivative of the residual with the unknowns, shape (n, n).
        stiffness_by_inputs: added to that with the inputs, shape (n, m).
        given: indices of the inputs of the scene; the others are forces of the contacts.
    """

    held: FloatArray
    held_by_inputs: FloatArray
    stiffness: FloatArray
    stiffness_by_inputs: FloatArray
    given: npt.NDArray[np.int64]


def pressing_contacts(solution: Solution) -> PressingContacts:
    """The contacts of an equilibrium in which all of them press; none where nothing touches exactly."""
    model = solution.model
    size, inputs = model.in_motion.size, np.arange(model.inputs.size)
    if not contact_loads(model.scene):
        rows = [np.zeros((0, columns)) for columns in (size, inputs.size)]
        stiffness = [np.zeros((size, columns)) for columns in (size, inputs.size)]
        return PressingContacts(*rows, *stiffness, inputs)
    found = equilibrium_in(solution)
    by_x = found.placed.gaps(found.x, solution.inputs)[1].full()
    by_inputs = found.placed.gaps_by_inputs(found.x, solution.inputs).full()
    contacts = pressing(found)
    # Flows, which relaxing stress has in motion, are behind the unknowns of the equilibrium.
    flows = size - model.size
    return PressingContacts(
        np.pad(by_x[contacts.held], ((0, 0), (0, flows))),
        by_inputs[contacts.held],
        np.pad(contacts.stiffness(by_x, by_x), (0, flows)),
        np.pad(contacts.stiffness(by_x, by_inputs), ((0, flows), (0, 0))),
        np.setdiff1d(inputs, found.placed.force_entries),
    )


def marginal_contact(solution: Solution) -> str:
    """A sentence on a contact that is neither pressed nor open, which one side of each motion alone meets; or none."""
    if not solution.model.scene.touches_exactly:
        return ""
    found = equilibrium_in(solution)
    discrete = solution.model.discrete
    for touch, push in found.pushes():
        if push <= LEAST_TOLERANCE:
            force = push * found.largest_force * discrete.contact_unit(touch.owner, of_body=touch.of_body)
            return f"{touch.owner!r} is on {touch.obstacle!r} and presses with {force:.2g} N only."
    for near in found.penetrations(-LEAST_TOLERANCE):
        clamped = not near.of_body and near.start == 0.0
        if not clamped and not any(near.is_at(touch) for touch in found.state.touches):
            return f"{near.owner!r} is {-near.depth:.2g} of the length from {near.obstacle!r}, which it does not press."
    return ""
