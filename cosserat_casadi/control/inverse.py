"""The inverse problem: values of inputs for which the equilibrium meets the targets of the scene.

The unknowns of the rods and the decision variables are found together, the equilibrium being constraints ("lifted"),
by an interior-point method with exact derivatives. What the optimiser ends at is only a proposal: the equilibrium at
its inputs is computed anew and judged like any other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from cosserat_casadi.control.decision_variables import DecisionVariables, decision_variables, scales
from cosserat_casadi.control.target_errors import Gap, length_of, model_error, target_errors, weighted_errors
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import check_potential, solve
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

DAMPING = (1e-1, 1e-2, 1e-3, 1e-4, 1e-8)
"""Weights of the inputs' distance from where a round starts, the last one for all further rounds.

Strong damping at first keeps the rods on the branch that they start on.
"""

SETTLED = 1e-9
"""Change of the inputs from round to round, in their scales, below which they have settled."""

ROUNDS = 7
"""Most rounds."""

IPOPT = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-10,
    "mu_init": 1e-4,
    "max_iter": 300,
    "bound_relax_factor": 0.0,
    "honor_original_bounds": "yes",
}
"""Options of the interior-point method; bounds are kept as they are written."""

UNSTABLE = "Not stable: a real rod leaves this equilibrium. "
"""How the message of an unstable result begins."""

NOT_STABLE = " No stable equilibrium was found that comes as near."
"""How it ends where a stable one was wanted."""


@dataclass(frozen=True)
class Inverse:
    """Inputs found for targets.

    Attributes:
        solution: equilibrium at the inputs found; its message says whether the targets are met.
        gaps: how far each target is missed, in the order of the scene.
        met: whether the equilibrium was found and every gap is within the scene's tolerance, and where it was
            estimated the error of the model too; where a stable one was wanted, whether it is that as well.
        rounds: runs of the optimiser.
    """

    solution: Solution
    gaps: tuple[Gap, ...]
    met: bool
    rounds: int

    @property
    def unstable(self) -> bool:
        """Whether the equilibrium is known not to be stable; without a potential none is."""
        return self.solution.converged and self.solution.stable is False

    @property
    def values(self) -> dict[str, FloatArray]:
        """The inputs found, by name."""
        layout = self.solution.model.inputs
        return layout.unpack(self.solution.inputs)


def inverse(model: Model, *, start: Solution | None = None, stable: bool = False) -> Inverse:
    """Inputs for which a model's equilibrium meets the targets of its scene.

    Of several solutions it finds one near the scene's own inputs. Where targets cannot all be met, within the bounds
    or at all, the weighted squares of what is missed are least, as far as a local method can tell.

    Args:
        model: of a scene with targets, and with inputs that it lists or bounds.
        start: equilibrium of this model to start from; by default that at the scene's own inputs, brought into bounds.
        stable: whether a stable equilibrium is wanted: an unstable one is relaxed and the search goes on from there,
            once. For loads that have a potential.

    Raises:
        SceneError: the scene has no targets, or names no inputs to find; or a stable equilibrium is wanted under loads
            without a potential.
    """
    return with_verdict(search(model, start, stable), stable)


def search(model: Model, start: Solution | None, stable: bool) -> Inverse:
    """The inverse problem of a model without a verdict on its targets; arguments and errors are those of inverse."""
    if not model.scene.targets:
        raise SceneError(Problem("targets", "missing", "say with [[targets]] where a rod or body is to be"))
    variables = decision_variables(model)
    if start is None:
        first_inputs = variables.clipped(model.pack())
        start = solve(model, model.inputs.unpack(first_inputs))
    if stable:
        check_potential(model, start.inputs)
    origin = variables.clipped(start.inputs)
    problem = _LiftedProblem(model, variables, scales(model, variables, start), origin)
    # A failed first solve may end at no numbers.
    x = start.x if np.all(np.isfinite(start.x)) else model.unloaded()
    result = problem.solve(x)
    if stable and result.solution.stable is False:
        result = _from_relaxed(problem, result)
    return result


def _from_relaxed(problem: _LiftedProblem, result: Inverse) -> Inverse:
    """The search once more, from where the rod relaxes to; the first result where that leads to nothing stable."""
    relaxed = solve(problem.model, result.values, start=result.solution, stable=True)
    if not relaxed.stable:
        return result
    # Damped about the relaxed inputs now, so that the search stays near the stable branch.
    second = replace(problem, origin=relaxed.inputs).solve(relaxed.x)
    if second.solution.stable:
        return second
    return result


def with_verdict(result: Inverse, stable: bool) -> Inverse:
    """The result of a search, judged: gaps, error of the model where it was estimated, and stability.

    Args:
        result: of :func:`search`, with an estimate of its error or without.
        stable: whether a stable equilibrium was wanted.
    """
    solution = result.solution
    gaps = target_errors(solution)
    met = solution.converged and all(_met(solution, gaps))
    result = replace(result, gaps=gaps, met=met)
    message = solution.message
    if solution.converged:
        message += _targets_sentence(result)
    if result.unstable:
        message = UNSTABLE + message
    refused = stable and result.unstable
    if refused:
        message += NOT_STABLE
    return replace(
        result,
        solution=replace(solution, message=message),
        met=result.met and not refused,
    )


def _targets_sentence(result: Inverse) -> str:
    verdicts = _reached(result.solution, result.gaps)
    missed = [gap for gap, reached in zip(result.gaps, verdicts, strict=True) if not reached]
    if missed:
        misses = "; ".join(_words(gap) for gap in missed)
        return f" The targets are not all met; the closest that was found misses {misses}."
    if all(_met(result.solution, result.gaps)):
        return " The targets are met."
    return _model_sentence(result.solution)


def _model_sentence(solution: Solution) -> str:
    """Why targets that the discrete model meets are not met by the rod, as far as is known."""
    scene = solution.model.scene
    errors = [model_error(solution, target) or 0.0 for target in scene.targets]
    return (
        " The targets are met by these modes and nodes, but not to the tolerance: the estimated error of the model, "
        f"{max(errors):.2g} of the length, is above {scene.accuracy.tolerance:g}. Allow more modes and nodes, or a "
        "larger tolerance."
    )


def _words(gap: Gap) -> str:
    distance = f"{gap.what} by {gap.position:.3g} m"
    if gap.angle is None:
        return distance
    return f"{distance} and {gap.angle:.3g} rad"


def _met(solution: Solution, gaps: tuple[Gap, ...]) -> list[bool]:
    """Whether each target is met: by the discrete model, and that within its error."""
    tolerance = solution.model.scene.accuracy.tolerance
    lengths = _lengths(solution.model)
    return [gap.within(length, tolerance) for gap, length in zip(gaps, lengths, strict=True)]


def _reached(solution: Solution, gaps: tuple[Gap, ...]) -> list[bool]:
    """Whether the discrete model meets each target, whatever its own error."""
    tolerance = solution.model.scene.accuracy.tolerance
    lengths = _lengths(solution.model)
    return [gap.reached(length, tolerance) for gap, length in zip(gaps, lengths, strict=True)]


def _lengths(model: Model) -> list[float]:
    """Length that each target is measured by, m."""
    return [length_of(model, target) for target in model.scene.targets]


@dataclass(frozen=True)
class _LiftedProblem:
    """Unknowns and n decision variables, these as changes in their scales from an origin.

    Attributes:
        model: the model.
        variables: the decision variables.
        scale: a change of each that matters, shape (n,).
        origin: stacked inputs to start from.
    """

    model: Model
    variables: DecisionVariables
    scale: FloatArray
    origin: FloatArray

    def solve(self, x: FloatArray) -> Inverse:
        """Rounds of the optimiser, each damped about where the one before ended, then our own solve.

        The damping picks one of many solutions and keeps the problem regular; moving its centre takes the error that
        it makes out of the result.

        Args:
            x: unknowns to start from, shape (size,).
        """
        optimiser = self._optimiser()
        bounds = self._bounds()
        size = self.model.size
        centre = np.zeros(len(self.scale))
        rounds = 0
        largest_change = np.inf
        while rounds < ROUNDS and largest_change > SETTLED:
            damping = DAMPING[min(rounds, len(DAMPING) - 1)]
            result = optimiser(
                x0=np.concatenate([x, centre]),
                p=np.concatenate([centre, [damping]]),
                lbg=0.0,
                ubg=0.0,
                **bounds,
            )
            optimum = result["x"].full()[:, 0]
            rounds += 1
            if not np.all(np.isfinite(optimum)):
                # What the round before ended at is still a proposal.
                break
            x = optimum[:size]
            change = optimum[size:]
            largest_change = float(np.abs(change - centre).max())
            centre = change
        return self._judged(x, centre, rounds)

    def _judged(self, x: FloatArray, change: FloatArray, rounds: int) -> Inverse:
        """The equilibrium at the inputs found, solved and judged like any other."""
        inputs = self.origin.copy()
        inputs[self.variables.indices] += self.scale * change
        # Rounding may leave a range by the last digit.
        inputs = self.variables.clipped(inputs)
        values = self.model.inputs.unpack(inputs)
        solution = solve(self.model, values, start=x)
        errors = target_errors(solution)
        met = solution.converged and all(_met(solution, errors))
        return Inverse(solution, errors, met, rounds)

    def _optimiser(self) -> ca.Function:
        """The interior-point method for min |errors|²/2 + damping |change − centre|²/2, subject to the equilibrium."""
        count = len(self.scale)
        x = ca.MX.sym("x", self.model.size)
        change = ca.MX.sym("change", count)
        parameters = ca.MX.sym("centre_and_damping", count + 1)
        centre = parameters[:-1]
        damping = parameters[-1]
        inputs = ca.DM(self.origin) + self._scatter() @ change
        errors = weighted_errors(self.model, x, inputs)
        damped = damping * ca.sumsqr(change - centre)
        problem = {
            "x": ca.vertcat(x, change),
            "p": parameters,
            "f": (ca.sumsqr(errors) + damped) / 2,
            "g": self.model.residual(x, inputs),
        }
        options = {
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
            "ipopt": IPOPT,
        }
        return ca.nlpsol("inverse", "ipopt", problem, options)

    def _scatter(self) -> ca.DM:
        """Matrix from changes of the decision variables to changes of the stacked inputs, shape (inputs, n)."""
        count = len(self.scale)
        return ca.DM.triplet(
            self.variables.indices.tolist(),
            list(range(count)),
            ca.DM(self.scale),
            self.model.inputs.size,
            count,
        )

    def _bounds(self) -> dict[str, FloatArray]:
        """Ranges of the changes; the unknowns have none."""
        unbounded = np.full(self.model.size, np.inf)
        start = self.origin[self.variables.indices]
        lower = (self.variables.lower - start) / self.scale
        upper = (self.variables.upper - start) / self.scale
        return {
            "lbx": np.concatenate([-unbounded, lower]),
            "ubx": np.concatenate([unbounded, upper]),
        }
