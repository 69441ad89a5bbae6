"""The inverse problem: values of inputs for which the equilibrium meets the targets of the scene.

The unknowns of the rods and the decision variables are found together, the equilibrium being constraints ("lifted"),
by an interior-point method with exact derivatives. What the optimiser ends at is only a proposal: the equilibrium at
its inputs is computed anew and judged like any other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import monotonic
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.control.contact_problem import contact_problem
from cosserat_casadi.control.decision_variables import decision_variables
from cosserat_casadi.control.inverse_levels import with_error
from cosserat_casadi.control.inverse_result import Inverse, gap_left, with_verdict
from cosserat_casadi.control.lifted_problem import LiftedProblem, lifted_problem
from cosserat_casadi.control.nearby_inputs import followed
from cosserat_casadi.control.sought_inputs import SoughtInputs
from cosserat_casadi.equilibrium.contact.contact_state import given_inputs
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.system_functions import SystemFunctions

STARTS = 8
"""Further starts, scattered in the bounds, where the first leaves a gap."""

LONGEST = 60.0
"""Seconds after which a search begins no further start, and says so: on many tendons one alone may take a minute."""


def inverse(
    model: SystemFunctions,
    *,
    start: Equilibrium[Any] | None = None,
    stable: bool = False,
    starts: int = STARTS,
    estimate_error: bool = True,
) -> Inverse:
    """Inputs for which a model's equilibrium meets the targets of its scene, as the public ``inverse`` describes them.

    Raises:
        SceneError: as the public ``inverse`` raises it.
    """
    model = model.at()
    check_targets(model.scene.targets)
    if start is None:
        start = first_solution(model)
    problem = inverse_problem(model, model.scene.targets, start, stable)
    found = search(problem, start, stable, starts)
    if estimate_error and found.solution.converged:
        found = replace(found, solution=with_error(found.solution))
    return with_verdict(found, stable)


def inverse_problem(
    model: SystemFunctions, targets: tuple[scenes.Target, ...], start: Equilibrium[Any], stable: bool
) -> SoughtInputs:
    """The problem of a model, ready for searches.

    Args:
        model: as in :func:`inverse`.
        targets: poses and positions to reach.
        start: the equilibrium whose inputs and sensitivities scale the problem.
        stable: as in :func:`inverse`.

    Raises:
        SceneError: as there.
    """
    if isinstance(start, Solution) and model.scene.touches_exactly:
        return contact_problem(model, targets, start, stable)
    return lifted_problem(model, targets, start, stable)


def check_targets(targets: tuple[scenes.Target, ...]) -> None:
    """Refuse an inverse problem without targets.

    Raises:
        SceneError: there are none.
    """
    if not targets:
        raise SceneError(Problem("targets", "missing", "say with [[targets]] where a rod or body is to be"))


def first_solution(model: SystemFunctions) -> Equilibrium[Any]:
    """The equilibrium at the scene's own inputs, brought into bounds: where a search starts."""
    first_inputs = decision_variables(model).clipped(model.pack())
    return solve(model, model.inputs.unpack(first_inputs), estimate_error=False)


def search(
    problem: SoughtInputs,
    start: Equilibrium[Any],
    stable: bool,
    starts: int,
    report: Callable[[str], None] | None = None,
) -> Inverse:
    """The inverse problem from a start, and from scattered ones, without a verdict on its targets.

    No further start begins after LONGEST; the result says how many were left out.

    Args:
        problem: the problem.
        start: equilibrium of its model to start from.
        stable: as in :func:`inverse`.
        starts: as there.
        report: told which of the further starts begins, and how far the targets are missed so far.
    """

    def rank(end: Inverse) -> tuple[bool, bool, float]:
        """Rank of an end, less is better: an equilibrium, a stable one if that is wanted, a smaller target error."""
        return not end.solution.converged, stable and end.unstable, gap_left(end)

    began = monotonic()
    model = problem.model
    result = _from_start(problem, start, problem.change(given_inputs(start.model, start.inputs)), stable)
    for tried, change in enumerate(problem.scattered(starts), 1):
        if result.met and not (stable and result.unstable):
            break
        if monotonic() - began > LONGEST:
            return replace(result, starts_left_out=starts - tried + 1)
        if report is not None:
            missed = max(gap.position for gap in result.gaps)
            report(f"start {tried + 1} of {starts + 1}, {missed:.2g} m missed so far")
        inputs = problem.inputs(change)
        begun = solve(model, model.inputs.unpack(inputs), estimate_error=False)
        again = _from_start(problem, begun, change, stable)
        rounds = result.rounds + again.rounds
        best = min(result, again, key=rank)
        result = replace(best, rounds=rounds, starts=1 + tried)
    return result


def search_near(
    problem: SoughtInputs,
    start: Equilibrium[Any],
    stable: bool,
    starts: int,
    report: Callable[[str], None] | None = None,
) -> Inverse:
    """Search from an equilibrium near the targets: by Newton's method, where that leads there, else :func:`search`."""
    if isinstance(problem, LiftedProblem):
        found = followed(problem, start)
        if found is not None and found.met and not found.unstable:
            found = problem.on_this_side(start, found)
        if found is not None and found.met and not found.unstable:
            return found
    return search(problem, start, stable, starts, report)


def _from_start(problem: SoughtInputs, start: Equilibrium[Any], change: FloatArray, stable: bool) -> Inverse:
    """The search from one start.

    Args:
        problem: the problem.
        start: a solve at the inputs that it starts from.
        change: these inputs as changes from the origin, in their scales, shape (n,).
        stable: whether a stable equilibrium is wanted.
    """
    result = problem.solve(start, change)
    if stable and result.solution.stable is False:
        return _from_relaxed(problem, result)
    return result


def _from_relaxed(problem: SoughtInputs, result: Inverse) -> Inverse:
    """The search once more, from where the rod relaxes to; the first result where that leads to nothing stable."""
    relaxed = solve(problem.model, result.values, start=result.solution, stable=True, estimate_error=False)
    if not relaxed.stable:
        return result
    # Damped about the relaxed inputs now, so that the search stays near the stable branch.
    relaxed_problem = replace(problem, origin=relaxed.inputs)
    second = relaxed_problem.solve(relaxed, np.zeros(len(problem.scale)))
    if second.solution.stable:
        return second
    return result
