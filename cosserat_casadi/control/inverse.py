"""The inverse problem: inputs for which the equilibrium meets the targets of the scene.

The unknowns of the rods and the decision variables are found together by an interior-point method with exact
derivatives, with the equilibrium as constraints ("lifted"). The result of the optimiser is only a proposal: the
equilibrium at its inputs is computed anew and judged like any other.

Rods in exact contact need another method: least squares over equilibria that are each solved with their contacts. The
errors of the targets are smooth functions of the inputs while contacts persist, with kinks where they change. Each
iteration takes a damped change of the inputs that reduces the linearised errors, and keeps the equilibrium there if it
is nearer to the targets. If it is not, and has other contacts, the next iteration uses the derivatives of that side.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.control.decision_variables import decision_variables, scales
from cosserat_casadi.control.inverse_levels import with_error
from cosserat_casadi.control.inverse_result import Inverse, gap_left, with_verdict
from cosserat_casadi.control.lifted_problem import LiftedProblem, lifted_problem
from cosserat_casadi.control.nearby_inputs import SETTLED, followed, shortest
from cosserat_casadi.control.sought_inputs import SoughtInputs
from cosserat_casadi.control.targets import wanted_poses, weighted_errors
from cosserat_casadi.equilibrium.contact.contact_search import equations_at
from cosserat_casadi.equilibrium.contact.contact_state import given_inputs
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import check_potential
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system_functions import SystemFunctions

MOST_TURNS = 20
"""Most equilibria that are tried from one start."""

FIRST_DAMPING = 1e-1
"""Weight of the square of the first change of the inputs, in their scales, relative to the squares of the errors."""

MOST_DAMPING = 1e8
"""Weight of the square of a change of the inputs at which a search without progress ends."""

EASED = 10.0
"""Factor by which that weight falls after an iteration that has come nearer."""

TIGHTENED = 5.0
"""Factor by which that weight grows after an iteration that has come no nearer."""

NEARER = 0.1
"""Least share of the predicted decrease of the error for an iteration to count as nearer."""

STARTS = 8
"""Number of further starts, scattered within the bounds, if the first leaves a target error."""

LONGEST = 60.0
"""Time, s, after which a search begins no further start, and says so; with many tendons one start may take a minute."""


def inverse(
    model: SystemFunctions,
    *,
    start: Equilibrium[Any] | None = None,
    stable: bool = False,
    starts: int = STARTS,
    estimate_error: bool = True,
) -> Inverse:
    """Find inputs for which a model's equilibrium meets the targets of its scene; see the public ``inverse``.

    Raises:
        SceneError: the scene or a value is refused, as by the public ``inverse``.
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
    """Make the problem of a model, ready for searches.

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
    """Solve for the equilibrium at the scene's own inputs, clipped to the bounds, from which a search starts."""
    first_inputs = decision_variables(model).clipped(model.pack())
    return solve(model, model.inputs.unpack(first_inputs), estimate_error=False)


def search(
    problem: SoughtInputs,
    start: Equilibrium[Any],
    stable: bool,
    starts: int,
    report: Callable[[str], None] | None = None,
) -> Inverse:
    """Solve the inverse problem from a start, and from scattered ones, without a verdict on its targets.

    No further start begins after LONGEST; the result contains the number of omitted starts.

    Args:
        problem: the problem.
        start: equilibrium of its model to start from.
        stable: as in :func:`inverse`.
        starts: number of further starts, as in :func:`inverse`.
        report: callback with the number of the next start, and the target error so far.
    """

    def rank(end: Inverse) -> tuple[bool, bool, float]:
        """Rank of a result, less is better: by equilibrium, stability if it is wanted, and target error."""
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
    """Search from an equilibrium near the targets, by Newton's method if it converges, else by :func:`search`."""
    if isinstance(problem, LiftedProblem):
        found = followed(problem, start)
        if found is not None and found.met and not found.unstable:
            found = problem.on_this_side(start, found)
        if found is not None and found.met and not found.unstable:
            return found
    return search(problem, start, stable, starts, report)


def _from_start(problem: SoughtInputs, start: Equilibrium[Any], change: FloatArray, stable: bool) -> Inverse:
    """Search from one start.

    Args:
        problem: the problem.
        start: solution at the initial inputs.
        change: initial inputs as changes from the origin, in their scales, shape (n,).
        stable: whether a stable equilibrium is wanted.
    """
    result = problem.solve(start, change)
    if stable and result.solution.stable is False:
        return _from_relaxed(problem, result)
    return result


def _from_relaxed(problem: SoughtInputs, result: Inverse) -> Inverse:
    """Search again from the equilibrium to which the rod relaxes; return the first result if that is not stable."""
    relaxed = solve(problem.model, result.values, start=result.solution, stable=True, estimate_error=False)
    if not relaxed.stable:
        return result
    # Damped about the relaxed inputs now, so that the search stays near the stable branch.
    relaxed_problem = replace(problem, origin=relaxed.inputs)
    second = relaxed_problem.solve(relaxed, np.zeros(len(problem.scale)))
    if second.solution.stable:
        return second
    return result


@dataclass(frozen=True)
class _AtPlaces:
    """A model as targets ask for it: functions of unknowns and inputs, the places of contact being given."""

    model: Model
    places: ca.MX

    def __getattr__(self, name: str) -> Any:
        member = getattr(self.model, name)
        if name == "lengths" or not self.places.shape[0]:
            return member
        # Parameters stand behind the inputs.
        return {owner: self._at_places(function) for owner, function in member.items()}

    def _at_places(self, function: ca.Function) -> Callable[..., Any]:
        return lambda x, inputs, *more: function(x, inputs, self.places, *more)


@dataclass(frozen=True)
class ContactProblem(SoughtInputs):
    """The inverse problem in the decision variables alone; the unknowns follow by solves with contacts."""

    def solve(self, start: Equilibrium[Any], change: FloatArray) -> Inverse:
        """Take damped steps between equilibria, each with its own contacts."""
        here = self._at(start, change)
        if not here.solution.converged:
            return here
        lower, upper = self.ranges()
        linear = self._linearised(here.solution)
        damping = FIRST_DAMPING
        turns = 0
        while turns < MOST_TURNS and linear is not None and damping < MOST_DAMPING:
            errors, moved = linear
            # The damped change within ranges after which least is left of the errors.
            damped = np.vstack([moved, np.sqrt(damping) * np.eye(len(change))])
            padded = np.concatenate([errors, np.zeros(len(change))])
            step = shortest(damped, padded, lower - change, upper - change)
            if float(np.abs(step).max(initial=0.0)) <= SETTLED:
                break
            turns += 1
            there = self._at(here.solution, change + step)
            before, after = gap_left(here), gap_left(there)
            expected = before - float(np.linalg.norm(errors + moved @ step))
            # Off a stable branch steps would go far for little.
            leaves = there.unstable and not here.unstable
            if after < before and before - after >= NEARER * expected and not leaves:
                damping /= EASED
                here, change = there, change + step
                linear = self._linearised(here.solution)
            else:
                damping *= TIGHTENED
        return replace(here, rounds=turns)

    def _at(self, start: Equilibrium[Any], change: FloatArray) -> Inverse:
        return self.judged(start if start.converged else None, change, rounds=0)

    def _linearised(self, solution: Equilibrium[Any]) -> tuple[FloatArray, FloatArray] | None:
        """Errors of an equilibrium, shape (m,), and their derivatives by n inputs in their scales, shape (m, n).

        The result is None if its contacts allow no derivatives.
        """
        assert isinstance(solution, Solution), "only rods touch obstacles"
        equations, z = equations_at(solution)
        model = equations.model
        x = ca.MX.sym("x", model.size)
        inputs = ca.MX.sym("inputs", model.inputs.size)
        places = model.parameters.symbol
        wanted = ca.MX(wanted_poses(self.targets))
        errors = weighted_errors(_AtPlaces(model, places), self.targets, wanted, x, inputs)
        symbols = [x, inputs, places]
        by_arguments = ca.horzcat(*[ca.jacobian(errors, symbol) for symbol in symbols])
        function = ca.Function("errors", symbols, [errors, by_arguments])
        values, by_all = (part.full() for part in function(*equations.arguments(z)))
        by_variables = np.eye(len(equations.given))[:, self.variables.indices] * self.scale
        unmoved = np.zeros((0, len(self.scale)))
        by_z = equations.moved(z, by_variables, unmoved)
        moved = by_all @ equations.arguments_moved(by_z, by_variables, unmoved)
        return (values[:, 0], moved) if np.all(np.isfinite(moved)) else None


def contact_problem(
    model: SystemFunctions, targets: tuple[scenes.Target, ...], start: Solution, stable: bool
) -> ContactProblem:
    """Make the problem of a model of rods in exact contact, with the arguments of :func:`lifted_problem`."""
    variables = decision_variables(model)
    given = given_inputs(start.model, start.inputs)
    if stable:
        check_potential(start.model, start.inputs)
    return ContactProblem(model, targets, variables, scales(model, variables, start), variables.clipped(given))
