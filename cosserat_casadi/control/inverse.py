"""The inverse problem: values of inputs for which the equilibrium meets the targets of the scene.

The unknowns of the rods and the decision variables are found together, the equilibrium being constraints ("lifted"),
by an interior-point method with exact derivatives. What the optimiser ends at is only a proposal: the equilibrium at
its inputs is computed anew and judged like any other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.control.decision_variables import DecisionVariables, decision_variables, scales
from cosserat_casadi.control.target_errors import (
    POSE_ENTRIES,
    Gap,
    length_of,
    model_error,
    target_errors,
    wanted_poses,
    weighted_errors,
)
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import check_potential, solve
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import refuse_obstacles

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

STARTS = 8
"""Further starts, scattered in the bounds, where the first leaves a gap."""

SEED = 20_240
"""Of the generator that scatters them: the same scene has the same starts."""

AT_BOUND = 1e-6
"""Distance from a bound, in half its range, below which an input is at it."""

NEAR_BOUND = 1e-3
"""Distance from a bound, in the scales, below which an input is tried at the bound itself."""

UNSTABLE = "Not stable: a real rod leaves this equilibrium. "
"""How the message of an unstable result begins."""

NOT_STABLE = " No stable equilibrium was found that comes as near."
"""How it ends where a stable one was wanted."""


@dataclass(frozen=True)
class Inverse:
    """Inputs found for targets.

    Attributes:
        solution: equilibrium at the inputs found; its message says whether the targets are met.
        targets: what was to be where: those of the scene, or of a row of a table.
        gaps: how far each target is missed, in their order.
        met: whether the equilibrium was found and every gap is within the scene's tolerance, and where it was
            estimated the error of the model too; where a stable one was wanted, whether it is that as well.
        rounds: runs of the optimiser, from all starts together.
        starts: starts that were tried, 1 where the first has met the targets.
        at_bounds: decision variables that ended at a bound, by name.
    """

    solution: Solution
    targets: tuple[scenes.Target, ...]
    gaps: tuple[Gap, ...]
    met: bool
    rounds: int
    starts: int = 1
    at_bounds: tuple[str, ...] = ()

    @property
    def unstable(self) -> bool:
        """Whether the equilibrium is known not to be stable; without a potential none is."""
        return self.solution.converged and self.solution.stable is False

    @property
    def values(self) -> dict[str, Any]:
        """The inputs found, by name: a number for one entry, else an array of shape (components, k)."""
        values: dict[str, Any] = {}
        for name, value in self.solution.model.inputs.unpack(self.solution.inputs).items():
            values[name] = value
            if value.size == 1:
                values[name] = np.float64(value.item())
        return values


def inverse(model: Model, *, start: Solution | None = None, stable: bool = False, starts: int = STARTS) -> Inverse:
    """Inputs for which a model's equilibrium meets the targets of its scene.

    Of several solutions it finds one near the scene's own inputs. Where targets cannot all be met, within the bounds
    or at all, the weighted squares of what is missed are least, as far as a local method can tell.

    Args:
        model: of a scene with targets, and with inputs that it lists or bounds.
        start: equilibrium of this model to start from; by default that at the scene's own inputs, brought into bounds.
        stable: whether a stable equilibrium is wanted: an unstable one is relaxed and the search goes on from there,
            once. For loads that have a potential.
        starts: further starts where a gap stays: scattered, by a seed of our own, over the inputs that are bounded on
            both sides; the best end counts. 0 for none.

    Raises:
        SceneError: the scene has no targets, or names no inputs to find; or a stable equilibrium is wanted under loads
            without a potential.
    """
    refuse_obstacles(model.scene, "an inverse problem")
    model = model.at()
    check_targets(model.scene.targets)
    if start is None:
        start = first_solution(model)
    problem = lifted_problem(model, model.scene.targets, start, stable)
    return with_verdict(search(problem, start, stable, starts), stable)


def check_targets(targets: tuple[scenes.Target, ...]) -> None:
    """Refuse an inverse problem without targets.

    Raises:
        SceneError: there are none.
    """
    if not targets:
        raise SceneError(Problem("targets", "missing", "say with [[targets]] where a rod or body is to be"))


def first_solution(model: Model) -> Solution:
    """The equilibrium at the scene's own inputs, brought into bounds: where a search starts."""
    first_inputs = decision_variables(model).clipped(model.pack())
    return solve(model, model.inputs.unpack(first_inputs))


def lifted_problem(
    model: Model,
    targets: tuple[scenes.Target, ...],
    start: Solution,
    stable: bool,
) -> LiftedProblem:
    """The problem of a model, ready for searches.

    Args:
        model: as in :func:`inverse`.
        targets: what is to be where.
        start: the equilibrium whose inputs and sensitivities scale the problem.
        stable: as in :func:`inverse`.

    Raises:
        SceneError: as there.
    """
    variables = decision_variables(model)
    if stable:
        check_potential(model, start.inputs)
    scale = scales(model, variables, start)
    optimiser = _optimiser(model, targets, variables, scale)
    return LiftedProblem(model, targets, variables, scale, variables.clipped(start.inputs), optimiser)


def search(problem: LiftedProblem, start: Solution, stable: bool, starts: int) -> Inverse:
    """The inverse problem from a start, and from scattered ones, without a verdict on its targets.

    Args:
        problem: the problem.
        start: equilibrium of its model to start from.
        stable: as in :func:`inverse`.
        starts: as there.
    """
    model = problem.model
    result = _from_start(problem, start, problem.change(start.inputs), stable)
    for tried, change in enumerate(problem.scattered(starts), 1):
        if _satisfies(result, stable):
            break
        inputs = problem.inputs(change)
        begun = solve(model, model.inputs.unpack(inputs))
        again = _from_start(problem, begun, change, stable)
        rounds = result.rounds + again.rounds
        best = min(result, again, key=lambda candidate: _rank(candidate, stable))
        result = replace(best, rounds=rounds, starts=1 + tried)
    return result


def _from_start(problem: LiftedProblem, start: Solution, change: FloatArray, stable: bool) -> Inverse:
    """The search from one start.

    Args:
        problem: the problem.
        start: a solve at the inputs that it starts from.
        change: these inputs as changes from the origin, in their scales, shape (n,).
        stable: whether a stable equilibrium is wanted.
    """
    # A failed first solve may end at no numbers.
    x = start.x if np.all(np.isfinite(start.x)) else problem.model.unloaded()
    result = problem.solve(x, change)
    if stable and result.solution.stable is False:
        return _from_relaxed(problem, result)
    return result


def _satisfies(result: Inverse, stable: bool) -> bool:
    """Whether a result leaves nothing to look for from other starts."""
    return result.met and not (stable and result.unstable)


def _rank(result: Inverse, stable: bool) -> tuple[bool, bool, float]:
    """What is less is better: an equilibrium, a stable one where that is wanted, the smaller weighted gap."""
    return not result.solution.converged, stable and result.unstable, _gap_left(result)


def _gap_left(result: Inverse) -> float:
    """Root of the weighted squares of what the targets are missed by; infinite without an equilibrium."""
    solution = result.solution
    if not solution.converged:
        return np.inf
    wanted = ca.DM(wanted_poses(result.targets))
    errors = weighted_errors(solution.model, result.targets, wanted, ca.DM(solution.x), ca.DM(solution.inputs))
    return float(np.linalg.norm(ca.evalf(ca.MX(errors)).full()))


def _from_relaxed(problem: LiftedProblem, result: Inverse) -> Inverse:
    """The search once more, from where the rod relaxes to; the first result where that leads to nothing stable."""
    relaxed = solve(problem.model, result.values, start=result.solution, stable=True)
    if not relaxed.stable:
        return result
    # Damped about the relaxed inputs now, so that the search stays near the stable branch.
    relaxed_problem = replace(problem, origin=relaxed.inputs)
    second = relaxed_problem.solve(relaxed.x, np.zeros(len(problem.scale)))
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
    gaps = target_errors(solution, result.targets)
    result = replace(result, gaps=gaps)
    met = solution.converged and all(_met(result))
    result = replace(result, met=met)
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
    verdicts = _reached(result)
    missed = [gap for gap, reached in zip(result.gaps, verdicts, strict=True) if not reached]
    if missed:
        misses = "; ".join(_words(gap) for gap in missed)
        sentence = f" The targets are not all met; the closest that was found misses {misses}."
        return sentence + _minimum_sentence(result)
    if all(_met(result)):
        return " The targets are met."
    return _model_sentence(result)


def _minimum_sentence(result: Inverse) -> str:
    """Where a search that leaves a gap ended: it is local, whatever the number of its starts."""
    where = "within the bounds"
    if result.at_bounds:
        where = f"at the bound of {', '.join(result.at_bounds)}"
    starts = "1 start"
    if result.starts > 1:
        starts = f"{result.starts} starts"
    return f" It is a local minimum {where}, the best of {starts}."


def _model_sentence(result: Inverse) -> str:
    """Why targets that the discrete model meets are not met by the rod, as far as is known."""
    scene = result.solution.model.scene
    errors = [model_error(result.solution, target) or 0.0 for target in result.targets]
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


def _met(result: Inverse) -> list[bool]:
    """Whether each target is met: by the discrete model, and that within its error."""
    tolerance = result.solution.model.scene.accuracy.tolerance
    return [gap.within(length, tolerance) for gap, length in _gaps_and_lengths(result)]


def _reached(result: Inverse) -> list[bool]:
    """Whether the discrete model meets each target, whatever its own error."""
    tolerance = result.solution.model.scene.accuracy.tolerance
    return [gap.reached(length, tolerance) for gap, length in _gaps_and_lengths(result)]


def _gaps_and_lengths(result: Inverse) -> list[tuple[Gap, float]]:
    """The gap of each target, and the length that it is measured by, m."""
    lengths = [length_of(result.solution.model, target) for target in result.targets]
    return list(zip(result.gaps, lengths, strict=True))


@dataclass(frozen=True)
class LiftedProblem:
    """Unknowns and n decision variables, these as changes in their scales from an origin.

    Attributes:
        model: the model.
        targets: what is to be where.
        variables: the decision variables.
        scale: a change of each that matters, shape (n,).
        origin: stacked inputs that changes count from.
        optimiser: the interior-point method; it takes origin and wanted poses as parameters, so that other targets of
            the same kinds share it.
    """

    model: Model
    targets: tuple[scenes.Target, ...]
    variables: DecisionVariables
    scale: FloatArray
    origin: FloatArray
    optimiser: ca.Function

    def solve(self, x: FloatArray, change: FloatArray) -> Inverse:
        """Rounds of the optimiser, each damped about where the one before ended, then our own solve.

        The damping picks one of many solutions and keeps the problem regular; moving its centre takes the error that
        it makes out of the result.

        Args:
            x: unknowns to start from, shape (size,).
            change: decision variables to start from, as changes from the origin in their scales, shape (n,).
        """
        bounds = self._bounds()
        size = self.model.size
        centre = change
        rounds = 0
        largest_change = np.inf
        while rounds < ROUNDS and largest_change > SETTLED:
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
            if not np.all(np.isfinite(optimum)):
                # What the round before ended at is still a proposal.
                break
            x = optimum[:size]
            change = optimum[size:]
            largest_change = float(np.abs(change - centre).max())
            centre = change
        result = self._judged(x, centre, rounds)
        if result.met:
            return result
        return self._polished(result, x, centre)

    def _polished(self, result: Inverse, x: FloatArray, change: FloatArray) -> Inverse:
        """The search once more with the inputs that are near a bound held at it; the better of the two.

        An interior-point method stays off a bound by the root of its tolerance where nothing presses against it.
        """
        lower, upper = self._ranges()
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
        polished = self._judged(optimum[: self.model.size], optimum[self.model.size :], rounds)
        return min(polished, replace(result, rounds=rounds), key=_gap_left)

    def _judged(self, x: FloatArray, change: FloatArray, rounds: int) -> Inverse:
        """The equilibrium at the inputs found, solved and judged like any other."""
        inputs = self.inputs(change)
        values = self.model.inputs.unpack(inputs)
        solution = solve(self.model, values, start=x)
        gaps = target_errors(solution, self.targets)
        result = Inverse(solution, self.targets, gaps, False, rounds, at_bounds=self._at_bounds(inputs))
        met = solution.converged and all(_met(result))
        return replace(result, met=met)

    def change(self, inputs: FloatArray) -> FloatArray:
        """Decision variables of stacked inputs, brought into their ranges, as changes from the origin, shape (n,)."""
        difference = self.variables.clipped(inputs) - self.origin
        return np.asarray(difference[self.variables.indices] / self.scale)

    def inputs(self, change: FloatArray) -> FloatArray:
        """Stacked inputs for a change of the decision variables, shape (inputs,)."""
        inputs = self.origin.copy()
        inputs[self.variables.indices] += self.scale * change
        # Rounding may leave a range by the last digit.
        return self.variables.clipped(inputs)

    def scattered(self, count: int) -> FloatArray:
        """Changes of the decision variables to start from, shape (count, n); none where no range is closed.

        Entries without a range on both sides stay at the origin.
        """
        lower, upper = self._ranges()
        closed = np.isfinite(upper - lower) & (upper > lower)
        if not np.any(closed):
            return np.zeros((0, len(self.scale)))
        shares = np.random.default_rng(SEED).random((count, len(self.scale)))
        least = np.where(closed, lower, 0.0)
        most = np.where(closed, upper, 0.0)
        return np.asarray(least + shares * (most - least))

    def _at_bounds(self, inputs: FloatArray) -> tuple[str, ...]:
        """Names of the decision variables that are at a bound, those aside that their bounds hold at one value."""
        variables = self.variables
        values = inputs[variables.indices]
        near = AT_BOUND * self.scale
        at_bound = (values <= variables.lower + near) | (values >= variables.upper - near)
        free = variables.upper > variables.lower
        stacked = set(variables.indices[at_bound & free].tolist())
        slices = self.model.inputs.slices.items()
        return tuple(name for name, entries in slices if stacked & set(range(entries.start, entries.stop)))

    def _parameters(self, centre: FloatArray, damping: float) -> FloatArray:
        """Parameters of the optimiser."""
        return np.concatenate([centre, [damping], self.origin, wanted_poses(self.targets)])

    def _ranges(self) -> tuple[FloatArray, FloatArray]:
        """Least and largest changes of the decision variables, each of shape (n,)."""
        start = self.origin[self.variables.indices]
        lower = (self.variables.lower - start) / self.scale
        upper = (self.variables.upper - start) / self.scale
        return lower, upper

    def _bounds(self) -> dict[str, FloatArray]:
        """Ranges of the changes; the unknowns have none."""
        unbounded = np.full(self.model.size, np.inf)
        lower, upper = self._ranges()
        return {
            "lbx": np.concatenate([-unbounded, lower]),
            "ubx": np.concatenate([unbounded, upper]),
        }


def _optimiser(
    model: Model,
    targets: tuple[scenes.Target, ...],
    variables: DecisionVariables,
    scale: FloatArray,
) -> ca.Function:
    """The interior-point method for min |errors|²/2 + damping |change − centre|²/2, subject to the equilibrium."""
    count = len(scale)
    x = ca.MX.sym("x", model.size)
    change = ca.MX.sym("change", count)
    centre = ca.MX.sym("centre", count)
    damping = ca.MX.sym("damping")
    origin = ca.MX.sym("origin", model.inputs.size)
    wanted = ca.MX.sym("wanted", POSE_ENTRIES * len(targets))
    inputs = origin + _scatter(variables, scale, model.inputs.size) @ change
    errors = weighted_errors(model, targets, wanted, x, inputs)
    damped = damping * ca.sumsqr(change - centre)
    problem = {
        "x": ca.vertcat(x, change),
        "p": ca.vertcat(centre, damping, origin, wanted),
        "f": (ca.sumsqr(errors) + damped) / 2,
        "g": model.residual(x, inputs),
    }
    options = {
        "print_time": False,
        "error_on_fail": False,
        "show_eval_warnings": False,
        "ipopt": IPOPT,
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
