"""A start at rest in contact: the equilibrium on the modes and sections of a motion, with its pressing contacts.

Each iteration linearises balance and gaps at once. Forces that only push, and gaps that are not negative, then make up
a linear complementarity problem: Newton's method, which converges quadratically (S.-P. Han, *Superlinearly convergent
variable metric algorithms for general nonlinear programming problems*, Math. Programming 11, 1976). A heavy rod that
is not yet supported may be as unstable as a buckling column, and its problem then has no solution or a wrong one: such
an iteration stiffens all variations alike until none releases energy (J. Nocedal, S. J. Wright, *Numerical
Optimization*, 2nd ed., Springer 2006, sections 3.4 and 18.3). This does not change the equilibrium.
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
"""Most iterations."""

NEARBY = 0.05
"""Largest gap, over the length, of a section that may press in an iteration."""

LONGEST = 0.3
"""Largest change of an unknown in an iteration."""

SETTLED = 1e-11
"""Change of the unknowns that counts as zero."""

ROUNDED = 1e-8
"""Change of the unknowns that counts as rounding if the iteration before did not change them more.

Sections close to each other, as at the tip of a rod on many modes, amplify the rounding of their gaps so much.
"""

LEAST_STIFFNESS = 1e-3
"""Least eigenvalue, in EI/ℓ, of the energy in an iteration; smaller ones are raised to it."""

NO_GAP = 1e-13
"""Penetration, over the length, that counts as zero."""


def resting(
    contacts: ExactContacts, x: FloatArray, inputs: FloatArray, guess: Sequence[Contact]
) -> tuple[FloatArray, ContactPhase] | None:
    """Find the unknowns of an equilibrium in contact, and its contacts; None if no equilibrium is found.

    Args:
        contacts: exact contacts of the model.
        x: unknowns to start from, shape (n,).
        inputs: stacked inputs, shape (m,).
        guess: contacts of the scene at rest, which tell which rods lie.
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
    """Shift the stiffness by the least amount with which no admissible variation releases energy."""
    lowest = float(admissible_eigenvalues(stiffness, allowed).min(initial=np.inf))
    stiffened = stiffness.copy()
    stiffened[allowed.free, allowed.free] += max(0.0, LEAST_STIFFNESS - lowest)
    return stiffened


def _pushes(
    stiffness: FloatArray, residual: FloatArray, gradients: FloatArray, pushed: FloatArray, gaps: FloatArray
) -> FloatArray | None:
    """Forces of an iteration, which do not pull and keep gaps from closing, shape (m,); None if there are none."""
    answers = solved(stiffness, np.column_stack([-residual, pushed.T]))
    if answers is None:
        return None
    straight_on = answers[:, 0]
    by_force = answers[:, 1:]
    return least_pushes(gradients @ by_force, gaps + gradients @ straight_on, NO_GAP)


def _balanced(
    stiffness: FloatArray, residual: FloatArray, gradients: FloatArray, pushed: FloatArray, gaps: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Solve for the change of the unknowns that closes gaps, shape (n,), and the forces in balance, shape (m,).

    The forces of pressing gaps are known already, but have less rounding if they are solved with the unknowns.

    Returns:
        both; or None if rounding makes the gaps depend on each other.
    """
    size, count = len(stiffness), len(gaps)
    bordered = np.zeros((size + count, size + count))
    bordered[:size, :size] = stiffness
    bordered[:size, size:] = -pushed.T
    bordered[size:, :size] = gradients
    answer = solved(bordered, -np.concatenate([residual, gaps]))
    return None if answer is None else (answer[:size], answer[size:])


def _candidates(contacts: ExactContacts, x: FloatArray, inputs: FloatArray, laid: frozenset[int]) -> Touches:
    """Contacts that may press: nearby holding sections of rods that lie, and for other rods the least gaps."""
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
    """Derivative of the generalised contact forces by the unknowns, as normals turn and places slide, (n, n)."""
    follower = Follower(facings, pressing)
    _, gaps = follower.gaps(x, inputs)
    total, _ = follower.curvature(x, inputs, gaps, forces)
    return total


def _flat(facings: Sequence[Facing], pressing: Touches, x: FloatArray, inputs: FloatArray) -> frozenset[int]:
    """Pairs of rods and obstacles with a sliding contact at which the gap is flat along the rod."""
    _, gaps = Follower(facings, pressing).gaps(x, inputs)
    pairs = zip(pressing, gaps, strict=True)
    return frozenset(touch.facing for touch, gap in pairs if touch.slides and gap.bend <= FLATTEST)
