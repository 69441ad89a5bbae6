"""The inverse problem as a mathematical program: equilibrium as constraints, weighted errors of targets as cost."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.control.decision_variables import DecisionVariables, decision_variables, scales
from cosserat_casadi.control.inverse_result import Inverse, gap_left
from cosserat_casadi.control.sought_inputs import SoughtInputs
from cosserat_casadi.control.target_errors import wanted_poses, weighted_errors
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers, are_one
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import check_potential
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.system_functions import SystemFunctions

DAMPING = (1e-1, 1e-2, 1e-3, 1e-4, 1e-8)
"""Weights of the inputs' distance from where a round starts, the last one for all further rounds.

Strong damping at first keeps the rods on the branch that they start on.
"""

SETTLED = 1e-9
"""Change of the inputs from round to round, in their scales, below which they have settled."""

ROUNDS = 7
"""Most rounds."""

LONGEST_RUN = 60.0
"""Seconds after which one run of the optimiser ends where it is."""

OUT_OF_TIME = "Maximum_WallTime_Exceeded"
"""The status that ipopt returns then."""

IPOPT = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-10,
    "mu_init": 1e-4,
    "max_iter": 300,
    "max_wall_time": LONGEST_RUN,
    "bound_relax_factor": 0.0,
    "honor_original_bounds": "yes",
}
"""Options of the interior-point method; bounds are kept as they are written."""

LEARNED_HESSIAN = {"hessian_approximation": "limited-memory"}
"""Further options where exact second derivatives cost too much."""

NEAR_BOUND = 1e-3
"""Distance from a bound, in the scales, below which an input is tried at the bound itself."""


@dataclass(frozen=True)
class LiftedProblem(SoughtInputs):
    """Unknowns and n decision variables.

    Attributes:
        optimiser: the interior-point method; it takes origin and wanted poses as parameters, so that other targets of
            the same kinds share it.
        errors: x, change, origin, wanted poses ↦ weighted errors of the targets, their derivatives by x and by change;
            shared likewise.
    """

    optimiser: ca.Function
    errors: ca.Function

    def solve(self, start: Equilibrium[Any], change: FloatArray) -> Inverse:
        """Rounds of the optimiser, each damped about where the one before ended, then our own solve.

        The damping picks one of many solutions and keeps the problem regular; moving its centre takes the error that
        it makes out of the result.
        """
        # A failed first solve may end at no numbers.
        x = start.x if np.all(np.isfinite(start.x)) else self.model.unloaded()
        bounds = self._bounds()
        size = self.model.size
        centre = change
        rounds = 0
        largest_change = np.inf
        cut_short = False
        while rounds < ROUNDS and largest_change > SETTLED and not cut_short:
            damping = DAMPING[min(rounds, len(DAMPING) - 1)]
            result = self.optimiser(
                x0=np.concatenate([x, centre]),
                p=self._parameters(centre, damping),
                lbg=0.0,
                ubg=0.0,
                **bounds,
            )
            optimum = result["x"].full()[:, 0]
            rounds += 1
            cut_short = self.optimiser.stats()["return_status"] == OUT_OF_TIME
            if not np.all(np.isfinite(optimum)):
                # What the round before ended at is still a proposal.
                break
            x = optimum[:size]
            change = optimum[size:]
            largest_change = float(np.abs(change - centre).max())
            centre = change
        result = replace(self.judged(x, centre, rounds), cut_short=cut_short)
        if not result.met and not cut_short:
            result = self._polished(result, x, centre)
        return self.on_this_side(start, result)

    def on_this_side(self, start: Equilibrium[Any], result: Inverse) -> Inverse:
        """The result; where that is behind a smooth obstacle or a rod, the end of a path to its inputs.

        Unknowns of the optimiser go anywhere. The path is that of the inputs from the start, or of the loads where the
        start is no equilibrium, without steps through obstacles or rods.
        """
        end = result.solution
        if not isinstance(end, Solution) or not end.converged:
            return result
        barriers = SmoothBarriers(end.model)
        if not barriers.any:
            return result
        if start.converged and not barriers.are_between(start.x, end.x, (start.inputs, end.inputs)):
            return result
        led = self.judged(start if start.converged else None, self.change(end.inputs), result.rounds)
        if led.solution.converged and are_one(led.solution.x, end.x):
            return result
        return replace(led, cut_short=result.cut_short, barred=True)

    def _polished(self, result: Inverse, x: FloatArray, change: FloatArray) -> Inverse:
        """The search once more with the inputs that are near a bound held at it; the better of the two.

        An interior-point method stays off a bound by the root of its tolerance where nothing presses against it.
        """
        lower, upper = self.ranges()
        at_lower = change <= lower + NEAR_BOUND
        at_upper = change >= upper - NEAR_BOUND
        if not np.any(at_lower | at_upper):
            return result
        held_lower = np.where(at_upper & ~at_lower, upper, lower)
        held_upper = np.where(at_lower, lower, upper)
        held = np.clip(change, held_lower, held_upper)
        unbounded = np.full(self.model.size, np.inf)
        optimum = self.optimiser(
            x0=np.concatenate([x, held]),
            p=self._parameters(held, DAMPING[-1]),
            lbg=0.0,
            ubg=0.0,
            lbx=np.concatenate([-unbounded, held_lower]),
            ubx=np.concatenate([unbounded, held_upper]),
        )["x"].full()[:, 0]
        rounds = result.rounds + 1
        if not np.all(np.isfinite(optimum)):
            return replace(result, rounds=rounds)
        polished = self.judged(optimum[: self.model.size], optimum[self.model.size :], rounds)
        return min(polished, replace(result, rounds=rounds), key=gap_left)

    def _parameters(self, centre: FloatArray, damping: float) -> FloatArray:
        """Parameters of the optimiser."""
        return np.concatenate([centre, [damping], self.origin, wanted_poses(self.targets)])

    def _bounds(self) -> dict[str, FloatArray]:
        """Ranges of the changes; the unknowns have none."""
        unbounded = np.full(self.model.size, np.inf)
        lower, upper = self.ranges()
        return {
            "lbx": np.concatenate([-unbounded, lower]),
            "ubx": np.concatenate([unbounded, upper]),
        }


def lifted_problem(
    model: SystemFunctions,
    targets: tuple[scenes.Target, ...],
    start: Equilibrium[Any],
    stable: bool,
) -> LiftedProblem:
    """The problem of a model, ready for searches.

    Args:
        model: as in :func:`inverse`.
        targets: poses and positions to reach.
        start: the equilibrium whose inputs and sensitivities scale the problem.
        stable: as in :func:`inverse`.

    Raises:
        SceneError: as there.
    """
    variables = decision_variables(model)
    if stable:
        check_potential(model, start.inputs)
    scale = scales(model, variables, start)
    errors = _errors(model, targets, variables, scale)
    optimiser = _optimiser(model, errors)
    origin = variables.clipped(start.inputs)
    return LiftedProblem(model, targets, variables, scale, origin, optimiser, _linearised(errors))


@dataclass(frozen=True)
class _Errors:
    """Weighted errors of targets as expressions.

    Attributes:
        x: unknowns.
        change: of the decision variables, in their scales.
        origin: stacked inputs that changes count from.
        wanted: poses that the targets ask for.
        inputs: stacked inputs after the change.
        errors: weighted errors.
    """

    x: ca.MX
    change: ca.MX
    origin: ca.MX
    wanted: ca.MX
    inputs: ca.MX
    errors: Matrix


def _errors(
    model: SystemFunctions,
    targets: tuple[scenes.Target, ...],
    variables: DecisionVariables,
    scale: FloatArray,
) -> _Errors:
    x = ca.MX.sym("x", model.size)
    change = ca.MX.sym("change", len(scale))
    origin = ca.MX.sym("origin", model.inputs.size)
    wanted = ca.MX.sym("wanted", POSE_SIZE * len(targets))
    inputs = origin + _scatter(variables, scale, model.inputs.size) @ change
    errors = weighted_errors(model, targets, wanted, x, inputs)
    return _Errors(x, change, origin, wanted, inputs, errors)


def _linearised(of: _Errors) -> ca.Function:
    """:attr:`LiftedProblem.errors`."""
    arguments = [of.x, of.change, of.origin, of.wanted]
    derivatives = [ca.jacobian(of.errors, of.x), ca.jacobian(of.errors, of.change)]
    return ca.Function("errors", arguments, [of.errors, *derivatives])


def _optimiser(model: SystemFunctions, of: _Errors) -> ca.Function:
    """The interior-point method for min |errors|²/2 + damping |change − centre|²/2, subject to the equilibrium."""
    centre = ca.MX.sym("centre", of.change.shape[0])
    damping = ca.MX.sym("damping")
    damped = damping * ca.sumsqr(of.change - centre)
    problem = {
        "x": ca.vertcat(of.x, of.change),
        "p": ca.vertcat(centre, damping, of.origin, of.wanted),
        "f": (ca.sumsqr(of.errors) + damped) / 2,
        "g": model.residual(of.x, of.inputs),
    }
    options = {
        "print_time": False,
        "error_on_fail": False,
        "show_eval_warnings": False,
        "ipopt": IPOPT if model.hessian_is_cheap else {**IPOPT, **LEARNED_HESSIAN},
    }
    return ca.nlpsol("inverse", "ipopt", problem, options)


def _scatter(variables: DecisionVariables, scale: FloatArray, size: int) -> ca.DM:
    """Matrix from n changes of the decision variables to changes of the stacked inputs, shape (size, n)."""
    count = len(scale)
    return ca.DM.triplet(
        variables.indices.tolist(),
        list(range(count)),
        ca.DM(scale),
        size,
        count,
    )
