"""The inverse problem of a scene on a discretisation that meets its tolerance at the inputs found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.levels import seeing_modes, verified_model
from cosserat_casadi.accuracy.metrics import largest_turn, prolong, with_estimate
from cosserat_casadi.control.inverse import Inverse, inverse
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
    the tolerance, the search goes on with those. Where the scene fixes modes or nodes, the error is only estimated.

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
    for modes in levels[1:]:
        _report(model, report)
        result = inverse(model, start=start, stable=stable)
        solution = result.solution
        if not solution.converged and solution.outcome is not Outcome.UNRESOLVED:
            return result
        finer_modes = modes
        if accuracy.fixed:
            finer_modes = max(modes, _most_modes(model) + FINER_MODES)
        finer = verified_model(scene, finer_modes, largest_turn(solution))
        # One solve at the same inputs tells what the modes leave, and is where a next search would start.
        reference = solve(finer, result.values, start=prolong(solution, finer))
        judged = _with_estimate(result, reference)
        estimate = judged.solution.error_estimate
        if accuracy.fixed or (estimate is not None and estimate <= accuracy.tolerance):
            return judged
        model = finer
        start = reference
    return _unresolved(result)


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
    outcome = Outcome.UNRESOLVED
    solution = replace(result.solution, outcome=outcome, message=outcome.value)
    return replace(result, solution=solution, met=False)
