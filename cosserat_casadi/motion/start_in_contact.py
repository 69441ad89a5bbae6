"""A start at rest in contact: the equilibrium on the modes of a motion, on its own sections, and what presses there.

Each turn linearises balance and gaps at once. Forces that only push and gaps that are not negative are then a linear
complementarity problem: Newton's method, of which the last turns are quadratic (S.-P. Han, *Superlinearly convergent
variable metric algorithms for general nonlinear programming problems*, Math. Programming 11, 1976). A heavy rod that
nothing supports yet may be as unstable as an upright column that buckles, and its problem has then no solution or the
wrong one: such a turn stiffens all variations alike until none releases energy (J. Nocedal, S. J. Wright, *Numerical
Optimization*, 2nd ed., Springer 2006, sections 3.4 and 18.3). The equilibrium does not change by that.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.solution import Contact
from cosserat_casadi.equilibrium.stability import ConstrainedVariations, admissible_eigenvalues, variations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_forces import Follower, MovingContact, Touches
from cosserat_casadi.motion.contact_gap import FLATTEST, Facing
from cosserat_casadi.motion.contact_guards import SAME_PLACE, ContactPhase
from cosserat_casadi.motion.contact_law import least_pushes
from cosserat_casadi.motion.exact_contact import ExactContacts
from cosserat_casadi.numerics.broyden import solved

MOST_TURNS = 50
"""Turns before no equilibrium is found."""

NEARBY = 0.05
"""Gap over the length up to which a section may come to press in a turn."""

LONGEST = 0.3
"""Largest change of an unknown in a turn."""

SETTLED = 1e-11
"""Change of the unknowns that counts as none."""

ROUNDED = 1e-8
"""Change of the unknowns that counts as none where the turn before did not change them more: it is rounding.

Sections close beside each other, as at the tip of a rod on many modes, make as much of the rounding of their gaps.
"""

LEAST_STIFFNESS = 1e-3
"""Least eigenvalue, in EI/ℓ, of the energy of a turn: less is raised to it."""

NO_GAP = 1e-13
"""Gap below zero, over the length, that counts as none."""


def resting(
    contacts: ExactContacts, x: FloatArray, inputs: FloatArray, guess: Sequence[Contact]
) -> tuple[FloatArray, ContactPhase] | None:
    """Unknowns of an equilibrium in contact, and what touches there; None where none is found.

    Args:
        contacts: of the model.
        x: unknowns to start from, shape (n,).
        inputs: stacked inputs, shape (m,).
        guess: contacts of the same scene at rest, which tell what lies.
    """
    facings = contacts.facings
    allowed = variations(contacts.model)
    lines = {(contact.owner, contact.obstacle) for contact in guess if contact.kind == "line"}
    laid = frozenset(k for k, facing in enumerate(facings) if (facing.owner, facing.touched) in lines)
    pressing: Touches = ()
    forces = np.zeros(0)
    before = np.inf
    for _ in range(MOST_TURNS):
        candidates = _candidates(contacts, x, inputs, laid)
        follower = Follower(facings, candidates)
        _, at_candidates = follower.gaps(x, inputs)
        gradients = follower.gradients(x, inputs, at_candidates)
        gaps = np.array([gap.value for gap in at_candidates])
        jacobian, residual = contacts.model.jacobian(x, inputs)
        stiffness = jacobian.full() - _turning(facings, pressing, forces, x, inputs)
        stiffness = _stiffened(stiffness, allowed)
        pushed = follower.pushes(gradients)
        pushes = _pushes(stiffness, column(residual), gradients, pushed, gaps)
        if pushes is None:
            return None
        active = pushes > 0.0
        balanced = _balanced(stiffness, column(residual), gradients[active], pushed[active], gaps[active])
        if balanced is None:
            return None
        change, forces = balanced
        largest = float(np.abs(change).max())
        x = x + change * min(1.0, LONGEST / max(largest, LONGEST))
        pressing = tuple(touch for touch, presses in zip(candidates, active, strict=True) if presses)
        flat = _flat(facings, pressing, x, inputs)
        settled = largest <= SETTLED or before <= largest <= ROUNDED
        if settled and not flat:
            # No forces keep such a section out.
            if gaps.min(initial=0.0) < -ROUNDED:
                return None
            return x, ContactPhase(pressing, laid, Follower(facings, pressing))
        laid = laid | flat
        before = largest
    return None


def _stiffened(stiffness: FloatArray, allowed: ConstrainedVariations) -> FloatArray:
    """The stiffness with as much added to all that varies as keeps every admissible variation from releasing energy."""
    lowest = float(admissible_eigenvalues(stiffness, allowed).min(initial=np.inf))
    stiffened = stiffness.copy()
    stiffened[allowed.free, allowed.free] += max(0.0, LEAST_STIFFNESS - lowest)
    return stiffened


def _pushes(
    stiffness: FloatArray, residual: FloatArray, gradients: FloatArray, pushed: FloatArray, gaps: FloatArray
) -> FloatArray | None:
    """Forces of a turn, none of which pulls, and at which no gap closes, shape (m,); None where none are found."""
    answers = solved(stiffness, np.column_stack([-residual, pushed.T]))
    if answers is None:
        return None
    straight_on = answers[:, 0]
    by_force = answers[:, 1:]
    return least_pushes(gradients @ by_force, gaps + gradients @ straight_on, NO_GAP)


def _balanced(
    stiffness: FloatArray, residual: FloatArray, gradients: FloatArray, pushed: FloatArray, gaps: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Change of the unknowns that closes gaps, shape (n,), and the forces that balance it, shape (m,).

    The forces are known already where the gaps press: solved for with the unknowns they have less rounding.

    Returns:
        None where rounding makes the gaps depend on each other.
    """
    size, count = len(stiffness), len(gaps)
    bordered = np.zeros((size + count, size + count))
    bordered[:size, :size] = stiffness
    bordered[:size, size:] = -pushed.T
    bordered[size:, :size] = gradients
    answer = solved(bordered, -np.concatenate([residual, gaps]))
    return None if answer is None else (answer[:size], answer[size:])


def _candidates(contacts: ExactContacts, x: FloatArray, inputs: FloatArray, laid: frozenset[int]) -> Touches:
    """Sections that may press: near sections of rods that lie; elsewhere the sections where gaps are least."""
    lying: list[MovingContact] = []
    nearest: list[MovingContact] = []
    for number, facing in enumerate(contacts.facings):
        nodes = facing.nodes(x, inputs)
        if number in laid:
            places = facing.laid_at[facing.laid_gaps(nodes) <= NEARBY]
            lying += [MovingContact(number, place, False) for place in places.tolist()]
        else:
            nearest += [MovingContact(number, one.place, one.inside) for one in facing.minima(nodes, NEARBY)]
    return (*contacts.meeting_ends.distinct((), tuple(nearest), SAME_PLACE), *lying)


def _turning(
    facings: Sequence[Facing], pressing: Touches, forces: FloatArray, x: FloatArray, inputs: FloatArray
) -> FloatArray:
    """Change of the forces on the unknowns as normals turn and places slide, shape (n, n)."""
    follower = Follower(facings, pressing)
    _, gaps = follower.gaps(x, inputs)
    total, _ = follower.curvature(x, inputs, gaps, forces)
    return total


def _flat(facings: Sequence[Facing], pressing: Touches, x: FloatArray, inputs: FloatArray) -> frozenset[int]:
    """Rods and obstacles that touch at a place that slides, where the gap has no bend."""
    _, gaps = Follower(facings, pressing).gaps(x, inputs)
    pairs = zip(pressing, gaps, strict=True)
    return frozenset(touch.facing for touch, gap in pairs if touch.slides and gap.bend <= FLATTEST)
