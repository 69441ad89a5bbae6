"""The inverse problem of a scene on a discretisation that meets its tolerance at the inputs found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.metrics import largest_turn, prolong, with_estimate
from cosserat_casadi.control.inverse import Inverse, inverse
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise, nodes_for
from cosserat_casadi.numerics.outcome import Outcome

LADDER = (6, 9, 12, 16, 21, 28, 36, 48)
"""Modes per strain component and element, rung by rung."""

SPARE = 2
"""Intervals beyond those that the modes of an unbent rod need."""

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
    model, start = (build(scene) if accuracy.fixed else _finer(scene, LADDER[0])), None
    for modes in LADDER[1:]:
        if report is not None:
            report(f"{model.size} unknowns, {max(d.nodes for d in model.discretisation.values())} intervals")
        found = inverse(model, start=start, stable=stable)
        if not found.solution.converged and found.solution.outcome is not Outcome.UNRESOLVED:
            return found
        fine = _finer(scene, max(modes, _most(model) + 4) if accuracy.fixed else modes, found.solution)
        start = solve(fine, found.values, start=prolong(found.solution, fine))
        judged = _estimated(found, start)
        estimate = judged.solution.error_estimate
        if accuracy.fixed or (estimate is not None and estimate <= accuracy.tolerance):
            return judged
        model = fine
    return _unresolved(found)


def _finer(scene: scenes.Scene, modes: int, below: Solution | None = None) -> Model:
    """A model with so many modes, and nodes for how far the rods of a solution turn."""
    turn = 0.0 if below is None else largest_turn(below)
    return build(scene, discretise(scene, modes, nodes_for(modes) + SPARE + ceil(turn / 2), "magnus8"))


def _most(model: Model) -> int:
    return max(max(d.modes) for d in model.discretisation.values())


def _estimated(found: Inverse, fine: Solution) -> Inverse:
    if not (found.solution.converged and fine.converged):
        return found
    return replace(found, solution=with_estimate(found.solution, fine))


def _unresolved(found: Inverse) -> Inverse:
    outcome = Outcome.UNRESOLVED
    return replace(found, solution=replace(found.solution, outcome=outcome, message=outcome.value), met=False)
