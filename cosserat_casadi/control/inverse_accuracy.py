"""The inverse problem of a scene on a discretisation that meets its tolerance at the inputs found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.levels import seeing_modes, verified_model
from cosserat_casadi.accuracy.metrics import largest_turn, prolong, with_estimate
from cosserat_casadi.accuracy.refine import LARGEST_SHAPE_ERROR
from cosserat_casadi.control.inverse import STARTS, Inverse, search, with_verdict
from cosserat_casadi.control.target_errors import model_error, target_errors
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.numerics.outcome import Outcome

FINER_MODES = 4
"""Modes that are added to those of the user to estimate their error."""

Report = Callable[[str], None]
"""Told the discretisation."""


def inverse_scene(scene: scenes.Scene, *, stable: bool = False, report: Report | None = None) -> Inverse:
    """Inputs for which a scene meets its targets, with modes and nodes that meet its tolerance there.

    The equilibrium at the inputs found is solved with more modes too. Where that moves the poses by more than half of
    the tolerance, the search goes on with those. Where the scene fixes modes or nodes, the error is only estimated:
    targets count as met where the gap and this estimate are both within the tolerance.

    Args:
        scene: a validated scene with targets.
        stable: as in :func:`inverse`.
        report: told the discretisation.

    Raises:
        SceneError: as in :func:`inverse`.
    """
    accuracy = scene.accuracy
    levels = seeing_modes(scene)
    model = build(scene) if accuracy.fixed else verified_model(scene, levels[0], 0.0)
    start: Solution | None = None
    tried = 1
    for modes in levels[1:]:
        _report(model, report)
        # Scattered on the first discretisation alone: the next ones start from its end.
        scattered_starts = STARTS if start is None else 0
        result = search(model, start, stable, scattered_starts)
        tried = max(tried, result.starts)
        result = replace(result, starts=tried)
        solution = result.solution
        if not solution.converged and solution.outcome is not Outcome.UNRESOLVED:
            return with_verdict(result, stable)
        finer_modes = modes
        if accuracy.fixed:
            finer_modes = max(modes, _most_modes(model) + FINER_MODES)
        finer = verified_model(scene, finer_modes, largest_turn(solution))
        # One solve at the same inputs tells what the modes leave, and is where a next search would start.
        reference = solve(finer, result.values, start=prolong(solution, finer))
        judged = _with_estimate(result, reference)
        if accuracy.fixed:
            return _fixed_verdict(judged, stable)
        if _error_within(judged.solution):
            return with_verdict(judged, stable)
        model = finer
        start = reference
    return _unresolved(result)


def _fixed_verdict(judged: Inverse, stable: bool) -> Inverse:
    """The verdict on modes and nodes that the user fixed: as a solve, unresolved where the shape is far off."""
    shape_error = judged.solution.shape_error_estimate
    # Without an estimate nothing vouches for the gaps.
    if shape_error is None or shape_error > LARGEST_SHAPE_ERROR:
        return _unresolved(judged)
    return with_verdict(judged, stable)


def _error_within(solution: Solution) -> bool:
    """Whether the estimated error is within the tolerance: of the tips, and where the targets are."""
    scene = solution.model.scene
    at_targets = [model_error(solution, target) for target in scene.targets]
    errors = [solution.error_estimate, *at_targets]
    return all(error is not None and error <= scene.accuracy.tolerance for error in errors)


def _report(model: Model, report: Report | None) -> None:
    if report is None:
        return
    most_nodes = max(d.nodes for d in model.discretisation.values())
    report(f"{model.size} unknowns, {most_nodes} intervals")


def _most_modes(model: Model) -> int:
    discretisations = model.discretisation.values()
    return max(max(d.modes) for d in discretisations)


def _with_estimate(result: Inverse, reference: Solution) -> Inverse:
    """The result with the error of its equilibrium, where both are equilibria."""
    if not result.solution.converged or not reference.converged:
        return result
    estimated = with_estimate(result.solution, reference)
    return replace(result, solution=estimated)


def _unresolved(result: Inverse) -> Inverse:
    """The result as one that is not of the rod; the gaps are those of the discrete model."""
    outcome = Outcome.UNRESOLVED
    message = outcome.value
    if result.solution.shape_error_estimate is not None:
        message += f" The estimated error is {result.solution.shape_error_estimate:.2g} of the length."
    solution = replace(result.solution, outcome=outcome, message=message, stable=None)
    return replace(result, solution=solution, gaps=target_errors(solution), met=False)
