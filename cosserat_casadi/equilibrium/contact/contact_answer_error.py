"""The error of an answer in exact contact: its distance from an answer with more modes and intervals, and its depth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.answer_error import UNKNOWN, with_notes
from cosserat_casadi.equilibrium.blindness import TurnedElements
from cosserat_casadi.equilibrium.contact.contact_equations import Grids, richer
from cosserat_casadi.equilibrium.contact.contact_search import equilibrium_in
from cosserat_casadi.equilibrium.contact.contact_solve import solve_contact
from cosserat_casadi.equilibrium.contact.contact_state import given_inputs, without_contacts
from cosserat_casadi.equilibrium.metrics import SAFETY, with_estimate
from cosserat_casadi.equilibrium.solution import Contact, Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discrete_scene import Richer
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.numerics.newton import NewtonSettings


def with_error_in_contact(solution: Solution, newton: NewtonSettings) -> Solution:
    """A solution in contact with estimates of its errors and notes on them; unchanged if it is not an equilibrium."""
    if not solution.converged:
        return solution
    return with_notes(estimated_in_contact(solution, newton))


def estimated_in_contact(solution: Solution, newton: NewtonSettings | None = None) -> Solution:
    """An equilibrium in contact with the estimates of its errors and an unchanged message.

    Places and forces of contact are unknowns, which the sweeps of answers without contact do not have. So the contacts
    of this solution are solved again on the richer modes.

    Args:
        solution: a solution of a scene with obstacles.
        newton: limits of the solve.
    """
    model = solution.model
    scene = without_contacts(model.scene)
    values = input_layout(scene).unpack(given_inputs(model, solution.inputs))
    grids = richer(Grids(model.discretisation), scene)
    return beside_finer(solution, solve_contact(scene, grids, values, start=solution, newton=newton))


def beside_finer(solution: Solution, finer: Solution) -> Solution:
    """A solution with its error by a finer one, which is unknown if the contacts of the two differ."""
    if finer.converged and _extents(solution).keys() == _extents(finer).keys():
        return with_contact_error(solution, finer)
    return replace(solution, error_estimate=UNKNOWN, shape_error_estimate=UNKNOWN)


def same_contacts(first: Solution, second: Solution) -> bool:
    """Whether the same rods touch the same obstacles in the same way."""
    names = [
        [(touch.owner, touch.obstacle, touch.kind, touch.of_body) for touch in solution.contacts]
        for solution in (first, second)
    ]
    return names[0] == names[1]


def with_contact_error(coarse: Solution, fine: Solution) -> Solution:
    """A solution with its distance from a finer one as the error, the largest over poses, places of contact and forces.

    Forces are relative to EI/ℓ² or the largest force, whichever is larger. Contacts of different kinds are compared by
    their total force, start and end. Depth in obstacles and pull of the finer solution count too: two solutions with
    the same contacts do not show that further contacts are missing. The error is unknown if the finer modes cannot
    resolve the waves in rolled-up elements.
    """
    both = Richer(coarse.model.discrete, fine.model.discrete)
    if TurnedElements(both).hide_waves(coarse.x, fine.x[~both.known]):
        return replace(coarse, error_estimate=UNKNOWN, shape_error_estimate=UNKNOWN)
    judged = with_estimate(coarse, fine)
    discrete = coarse.model.discrete
    units = [discrete.contact_unit(contact.owner, of_body=contact.of_body) for contact in coarse.contacts]
    largest = max([0.0, *units, *(float(np.linalg.norm(contact.force)) for contact in fine.contacts)])
    distances = [equilibrium_in(fine).unmet()]
    if same_contacts(coarse, fine):
        for first, second in zip(coarse.contacts, fine.contacts, strict=True):
            distances += [abs(first.start - second.start), abs(first.end - second.end)]
            distances += np.abs(np.subtract(first.on_rods or (), second.on_rods or ())).tolist()
            forces = np.concatenate([first.force - second.force, np.subtract(first.ends, second.ends)])
            distances.append(float(np.abs(forces).max()) / largest)
            distances += [distance / largest for distance in _between_sections(first, second)]
    else:
        others = _extents(fine)
        for owner, (start, end, force) in _extents(coarse).items():
            start_of_other, end_of_other, other_force = others[owner]
            distances += [abs(start - start_of_other), abs(end - end_of_other)]
            distances.append(float(np.abs(force - other_force).max()) / largest)
    contact_error = SAFETY * max(distances)
    assert judged.error_estimate is not None
    assert judged.shape_error_estimate is not None
    return replace(
        judged,
        error_estimate=max(judged.error_estimate, contact_error),
        shape_error_estimate=max(judged.shape_error_estimate, contact_error),
    )


def _extents(solution: Solution) -> dict[tuple[str, str, bool], tuple[float, float, FloatArray]]:
    """First and last abscissa at which each rod, or body, touches each obstacle, and the total force, N."""
    extents: dict[tuple[str, str, bool], tuple[float, float, FloatArray]] = {}
    for touch in solution.contacts:
        owner = touch.owner, touch.obstacle, touch.of_body
        start, end, force = extents.get(owner, (touch.start, touch.end, np.zeros(3)))
        extents[owner] = min(start, touch.start), max(end, touch.end), force + touch.force
    return extents


def _between_sections(first: Contact, second: Contact) -> list[float]:
    """Differences of the forces at sections inside two lines, N; sections at other contacts move a little."""
    if len(first.inside) == len(second.inside):
        return [abs(one.force - other.force) for one, other in zip(first.inside, second.inside, strict=True)]
    forces = {section.at: section.force for section in first.inside}
    other_forces = {section.at: section.force for section in second.inside}
    places = forces.keys() | other_forces.keys()
    return [abs(forces.get(at, 0.0) - other_forces.get(at, 0.0)) for at in places]
