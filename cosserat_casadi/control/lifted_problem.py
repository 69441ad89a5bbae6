"""The inverse problem as a mathematical program, with the equilibrium as constraints and target errors as cost."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.control.decision_variables import decision_variables, scales
from cosserat_casadi.control.inverse_result import Inverse, gap_left
from cosserat_casadi.control.sought_inputs import SoughtInputs
from cosserat_casadi.control.targets import wanted_poses, weighted_errors
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers, are_one
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import check_potential
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.system_functions import SystemFunctions

DAMPING = (1e-1, 1e-2, 1e-3, 1e-4, 1e-8)
"""Weights of the distance of the inputs from the start of a round; the last one is for all further rounds.

Strong damping at first keeps the rods on their initial branch.
"""

SETTLED = 1e-9
"""Change of the inputs from round to round, in their scales, below which the rounds end."""

ROUNDS = 7
"""Most rounds of the optimiser."""

LONGEST_RUN = 60.0
"""Time limit of one run of the optimiser, s."""

OUT_OF_TIME = "Maximum_WallTime_Exceeded"
"""Status of ipopt at its time limit."""

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
"""Options of the interior-point method; bounds are not relaxed."""

LEARNED_HESSIAN = {"hessian_approximation": "limited-memory"}
"""Further options if exact second derivatives cost too much."""

NEAR_BOUND = 1e-3
"""Distance from a bound, in the scales, below which an input is also tried at the bound."""


@dataclass(frozen=True)
class LiftedProblem(SoughtInputs):
    """The inverse problem in the unknowns of the model and n decision variables.

    Attributes:
        optimiser: the interior-point method; origin and wanted poses are parameters, so that targets of equal kinds
            share it.
        errors: (x, change, origin, wanted poses) ↦ weighted errors of the targets, derivatives by x and by change;
            targets of equal kinds share it.
    """

    optimiser: ca.Function
    errors: ca.Function

    def solve(self, start: Equilibrium[Any], change: FloatArray) -> Inverse:
        """Run rounds of the optimiser, each damped about the end of the one before, and then solve the equilibrium.

        The damping selects one of many solutions and keeps the problem regular; moving its centre removes its error
        from the result.
        """
        # A failed first solve may end at no numbers.
        x = start.x if np.all(np.isfinite(start.x)) else self.model.unloaded()
        ranges = self.ranges()
        size = self.model.size
        centre = change
        rounds = 0
        largest_change = np.inf
        cut_short = False
        while rounds < ROUNDS and largest_change > SETTLED and not cut_short:
            optimum = self._optimum(x, centre, DAMPING[min(rounds, len(DAMPING) - 1)], ranges)
            rounds += 1
            cut_short = self.optimiser.stats()["return_status"] == OUT_OF_TIME
            if not np.all(np.isfinite(optimum)):
                # The result of the last round is still a proposal.
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
        """Return a result, or the end of a path to its inputs if it is behind a smooth obstacle or a rod.

        The optimiser may move unknowns through obstacles. The path moves the inputs from the start, or the loads from
        zero if the start is no equilibrium, without steps through obstacles or rods.
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
        """Search again with inputs near a bound held at the bound; return the better result.

        An interior-point method stays off an inactive bound by the square root of its tolerance.
        """
        lower, upper = self.ranges()
        at_lower = change <= lower + NEAR_BOUND
        at_upper = change >= upper - NEAR_BOUND
        if not np.any(at_lower | at_upper):
            return result
        held_lower = np.where(at_upper & ~at_lower, upper, lower)
        held_upper = np.where(at_lower, lower, upper)
        held = np.clip(change, held_lower, held_upper)
        optimum = self._optimum(x, held, DAMPING[-1], (held_lower, held_upper))
        rounds = result.rounds + 1
        if not np.all(np.isfinite(optimum)):
            return replace(result, rounds=rounds)
        polished = self.judged(optimum[: self.model.size], optimum[self.model.size :], rounds)
        return min(polished, replace(result, rounds=rounds), key=gap_left)

    def _optimum(
        self, x: FloatArray, centre: FloatArray, damping: float, ranges: tuple[FloatArray, FloatArray]
    ) -> FloatArray:
        """Unknowns and changes at the end of one run of the optimiser, which may be NaN.

        Args:
            x: initial unknowns.
            centre: initial changes, about which the run is damped, shape (n,).
            damping: weight of the distance from these changes.
            ranges: least and largest changes; the unknowns are not bounded.
        """
        unbounded = np.full(self.model.size, np.inf)
        return np.asarray(
            self.optimiser(
                x0=np.concatenate([x, centre]),
                p=np.concatenate([centre, [damping], self.origin, wanted_poses(self.targets)]),
                lbg=0.0,
                ubg=0.0,
                lbx=np.concatenate([-unbounded, ranges[0]]),
                ubx=np.concatenate([unbounded, ranges[1]]),
            )["x"].full()[:, 0]
        )


def lifted_problem(
    model: SystemFunctions,
    targets: tuple[scenes.Target, ...],
    start: Equilibrium[Any],
    stable: bool,
) -> LiftedProblem:
    """Make the problem of a model; arguments as for :func:`cosserat_casadi.control.inverse.inverse_problem`."""
    variables = decision_variables(model)
    if stable:
        check_potential(model, start.inputs)
    scale = scales(model, variables, start)
    count = len(scale)
    x = ca.MX.sym("x", model.size)
    change = ca.MX.sym("change", count)
    origin = ca.MX.sym("origin", model.inputs.size)
    wanted = ca.MX.sym("wanted", POSE_SIZE * len(targets))
    # From changes of the decision variables to those of the stacked inputs.
    scatter = ca.DM.triplet(variables.indices.tolist(), list(range(count)), ca.DM(scale), model.inputs.size, count)
    inputs = origin + scatter @ change
    errors = weighted_errors(model, targets, wanted, x, inputs)
    centre = ca.MX.sym("centre", count)
    damping = ca.MX.sym("damping")
    # min |errors|²/2 + damping |change − centre|²/2, subject to the equilibrium.
    problem = {
        "x": ca.vertcat(x, change),
        "p": ca.vertcat(centre, damping, origin, wanted),
        "f": (ca.sumsqr(errors) + damping * ca.sumsqr(change - centre)) / 2,
        "g": model.residual(x, inputs),
    }
    options = {
        "print_time": False,
        "error_on_fail": False,
        "show_eval_warnings": False,
        "ipopt": IPOPT if model.hessian_is_cheap else {**IPOPT, **LEARNED_HESSIAN},
    }
    optimiser = ca.nlpsol("inverse", "ipopt", problem, options)
    derivatives = [ca.jacobian(errors, x), ca.jacobian(errors, change)]
    linearised = ca.Function("errors", [x, change, origin, wanted], [errors, *derivatives])
    return LiftedProblem(model, targets, variables, scale, variables.clipped(start.inputs), optimiser, linearised)
