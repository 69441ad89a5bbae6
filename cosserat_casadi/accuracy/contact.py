"""Scenes in exact contact to their tolerance: poses, forces of contact and places of contact.

The contacts are found on one level of modes and solved again on finer levels, until two levels differ by less than the
tolerance. The coarser of the two is the solution, and their distance its estimate.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.levels import FIRST_LEVELS, REFERENCE_MODES, Level, nodes_for_turn, told_waves
from cosserat_casadi.accuracy.scene_solver import SceneSolver
from cosserat_casadi.equilibrium.contact.contact_answer_error import same_contacts, with_contact_error
from cosserat_casadi.equilibrium.contact.contact_equations import Grids
from cosserat_casadi.equilibrium.contact.contact_search import equilibrium_in
from cosserat_casadi.equilibrium.contact.contact_solve import solve_contact, stays_unmet, why_unsettled
from cosserat_casadi.equilibrium.contact.contact_state import state_in
from cosserat_casadi.equilibrium.metrics import largest_turn
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.model.discretise import DEFAULT_MODES, discretise, nodes_for, with_more_fibres
from cosserat_casadi.model.required_modes import most_wave_modes

FINER_MODES = 3
"""Modes that are added to the user's to estimate their error."""

MOST_FAILURES = 1
"""Number of levels without an equilibrium that end the search: the cushions are equal on all levels."""


def solve_contact_scene(solver: SceneSolver, transport: str) -> Solution:
    """Equilibrium of a scene with obstacles to its tolerance, or on the modes and nodes that it fixes.

    Args:
        solver: of the scene, without parameters.
        transport: rotation integrator where the scene names none.
    """
    scene = solver.scene
    tolerance = scene.accuracy.tolerance
    coarse: Solution | None = None
    failures = 0
    for number, (modes, nodes) in enumerate(_levels(scene)):
        # The answer keeps the intervals that a scene fixes.
        turn = 0.0 if scene.accuracy.fixed else solver.unloaded_turn
        if coarse is not None:
            turn = max(turn, largest_turn(coarse))
        chosen = discretise(scene, modes, max(nodes, nodes_for_turn(_most(modes), turn)), transport)
        if solver.report is not None:
            solver.report(f"{modes} modes")
        start = coarse if coarse is not None and coarse.converged else None
        # Fixed modes are the only level.
        unmet = 0.0 if scene.accuracy.fixed else _unmet(start)
        fine = solve_contact(
            scene,
            Grids(with_more_fibres(chosen, number)),
            solver.values,
            start=start,
            progress=solver.progress,
            unmet_before=unmet,
        )
        failures += not fine.converged
        if failures > MOST_FAILURES:
            return fine
        if coarse is None:
            coarse = fine
            if not fine.converged and scene.accuracy.fixed:
                return fine
            continue
        fine = replace(fine, iterations=coarse.iterations + fine.iterations)
        if coarse.converged and fine.converged and same_contacts(coarse, fine):
            judged = with_contact_error(coarse, fine)
            assert judged.error_estimate is not None
            if scene.accuracy.fixed or judged.error_estimate <= tolerance:
                return replace(judged, iterations=fine.iterations)
            if stays_unmet(equilibrium_in(fine), unmet, tolerance):
                # Other contacts would have to hold, but none were found.
                why = why_unsettled(scene, [state_in(fine.model.scene)])
                unresolved = judged.unresolved()
                return replace(unresolved, iterations=fine.iterations, message=unresolved.message + why)
        elif scene.accuracy.fixed:
            break
        coarse = fine
    assert coarse is not None
    if not coarse.converged:
        return coarse
    unresolved = coarse.unresolved()
    if scene.accuracy.fixed:
        return unresolved
    return replace(unresolved, message=unresolved.message + told_waves(most_wave_modes(scene)))


def _unmet(solution: Solution | None) -> float:
    """Error of the contacts of an equilibrium, its ``unmet``; infinite without an equilibrium."""
    return inf if solution is None else equilibrium_in(solution).unmet()


def _levels(scene: scenes.Scene) -> list[tuple[int | tuple[int, ...], int]]:
    """Modes and least intervals of the levels, in their order."""
    accuracy = scene.accuracy
    if not accuracy.fixed:
        first = Level.first(FIRST_LEVELS[0][0], most_wave_modes(scene))
        return [(modes, nodes_for(modes)) for modes in REFERENCE_MODES[first.index : first.finest + 1]]
    modes = DEFAULT_MODES if accuracy.modes is None else accuracy.modes
    nodes = nodes_for(_most(modes)) if accuracy.nodes is None else accuracy.nodes
    finer = modes + FINER_MODES if isinstance(modes, int) else tuple(count + FINER_MODES for count in modes)
    return [(modes, nodes), (finer, nodes + 2 * FINER_MODES)]


def _most(modes: int | tuple[int, ...]) -> int:
    return modes if isinstance(modes, int) else max(modes)
