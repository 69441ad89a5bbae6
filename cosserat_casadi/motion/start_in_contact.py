"""A start at rest in contact: the equilibrium on the modes of a motion, on its own sections, and what presses there.

Each turn linearises balance and gaps at once. Forces that only push and gaps that are not negative are then a linear
complementarity problem: Newton's method, of which the last turns are quadratic (S.-P. Han, *Superlinearly convergent
variable metric algorithms for general nonlinear programming problems*, Math. Programming 11, 1976).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.equilibrium.solution import Contact
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_guards import SAME_PLACE, Arrangement
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.motion.facing import FLATTEST, Facing
from cosserat_casadi.motion.touching import Follower, Touch, Touches
from cosserat_casadi.numerics.complementarity import least_pushes

MOST_TURNS = 50
"""Turns before no equilibrium is found."""

NEARBY = 0.05
"""Gap over the length up to which a section may come to press in a turn."""

LONGEST = 0.3
"""Largest change of an unknown in a turn."""

SETTLED = 1e-11
"""Change of the unknowns that counts as none."""

NO_GAP = 1e-13
"""Gap below zero, over the length, that counts as none."""


def resting(
    contacts: ExactContacts, x: FloatArray, inputs: FloatArray, guess: Sequence[Contact]
) -> tuple[FloatArray, Arrangement] | None:
    """Unknowns of an equilibrium in contact, and what touches there; None where none is found.

    Args:
        contacts: of the model.
        x: unknowns to start from, shape (n,).
        inputs: stacked inputs, shape (m,).
        guess: contacts of the same scene at rest, which tell what lies.
    """
    facings = contacts.facings
    lines = {(contact.rod, contact.obstacle) for contact in guess if contact.kind == "line"}
    laid = frozenset(k for k, facing in enumerate(facings) if (facing.rod, facing.obstacle.name) in lines)
    pressing: Touches = ()
    forces = np.zeros(0)
    for _ in range(MOST_TURNS):
        candidates = _candidates(contacts, x, inputs, laid)
        follower = Follower(facings, candidates)
        state = follower.state(x, inputs)
        gradients = np.array(state.gradients).reshape(len(candidates), len(x))
        gaps = np.array([gap.value for gap in state.gaps])
        stiffness, residual = (part.full() for part in contacts.model.jacobian(x, inputs))
        stiffness = stiffness - _turning(facings, pressing, forces, x, inputs)
        try:
            answers = np.linalg.solve(stiffness, np.column_stack([-residual, gradients.T]))
        except np.linalg.LinAlgError:
            return None
        straight_on = answers[:, 0]
        by_force = answers[:, 1:]
        pushes = least_pushes(gradients @ by_force, gaps + gradients @ straight_on, NO_GAP)
        if pushes is None or not np.all(np.isfinite(answers)):
            return None
        change = straight_on + by_force @ pushes
        largest = float(np.abs(change).max())
        x = x + change * min(1.0, LONGEST / max(largest, LONGEST))
        pressing = tuple(touch for touch, push in zip(candidates, pushes, strict=True) if push > 0.0)
        forces = pushes[pushes > 0.0]
        flat = _flat(facings, pressing, x, inputs)
        if largest <= SETTLED and not flat:
            return x, Arrangement(pressing, laid, Follower(facings, pressing))
        laid = laid | flat
    return None


def _candidates(contacts: ExactContacts, x: FloatArray, inputs: FloatArray, laid: frozenset[int]) -> Touches:
    """Sections that may press: those of rods that lie, and the nearest ones of the others."""
    lying: list[Touch] = []
    nearest: list[Touch] = []
    for number, facing in enumerate(contacts.facings):
        nodes = facing.nodes(x, inputs)
        if number in laid:
            places = facing.laid_at[facing.laid_gaps(nodes) <= NEARBY]
            lying += [Touch(number, place, False) for place in places.tolist()]
        else:
            nearest += [Touch(number, one.place, one.inside) for one in facing.minima(nodes, NEARBY)]
    return (*contacts.meeting_ends.distinct((), tuple(nearest), SAME_PLACE), *lying)


def _turning(
    facings: Sequence[Facing], pressing: Touches, forces: FloatArray, x: FloatArray, inputs: FloatArray
) -> FloatArray:
    """Change of the forces on the unknowns as normals turn and places slide, shape (n, n)."""
    total = np.zeros((len(x), len(x)))
    _, gaps = Follower(facings, pressing).gaps(x, inputs)
    for touch, force, gap in zip(pressing, forces, gaps, strict=True):
        total += force * facings[touch.facing].hessian(x, inputs, gap, slides=touch.slides)
    return total


def _flat(facings: Sequence[Facing], pressing: Touches, x: FloatArray, inputs: FloatArray) -> frozenset[int]:
    """Rods and obstacles that touch at a place that slides, where the gap has no bend."""
    _, gaps = Follower(facings, pressing).gaps(x, inputs)
    pairs = zip(pressing, gaps, strict=True)
    return frozenset(touch.facing for touch, gap in pairs if touch.slides and gap.bend <= FLATTEST)
