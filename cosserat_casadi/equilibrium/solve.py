"""Solve a model: by load continuation, or by CasADi's own solvers, judged by one test of our own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.judge import correct, judge
from cosserat_casadi.equilibrium.load_path import input_path, load_path
from cosserat_casadi.equilibrium.relax import can_settle, settled
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError, SolveError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.continuation import ContinuationSettings, Progress, follow
from cosserat_casadi.numerics.outcome import Outcome

CANNOT_SETTLE = " Assemblies and cables of given length cannot be let settle to less energy."
NONE_STABLE = " No stable equilibrium was found by letting the rod settle to less energy."

Start = Solution | FloatArray | None
"""Where a solve starts: a solution, unknowns, or the unloaded rod."""


@dataclass(frozen=True)
class _End:
    """Where a method stopped, before it is judged."""

    x: FloatArray
    outcome: Outcome
    iterations: int
    load_factor: float = 1.0


def solve(
    model: Model,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    start: Start = None,
    method: str = "continuation",
    stable: bool = False,
    settings: ContinuationSettings | None = None,
    progress: Progress | None = None,
    raise_on_failure: bool = False,
) -> Solution:
    """Equilibrium of a model.

    Args:
        model: what to solve.
        values: inputs by name; those not named keep the scene's values.
        start: where to start; by default the unloaded rod. From a solution of the same model, continuation follows
            the inputs from those of the solution to the wanted ones, and so stays on its branch. From unknowns of
            shape (size,), Newton is tried at the wanted inputs, and the unloaded rod where that strays.
        method: "continuation" (default), "rootfinder" (CasADi's Newton) or "nlpsol" (ipopt); the last two start
            at the full load and may find another branch, or none.
        stable: whether a stable equilibrium is wanted: where the method ends at an unstable one, or at none, the rod
            is let go and settles in a minimum of its energy. For loads that have one.
        settings: limits of the continuation.
        progress: told the share of the path that is done.
        raise_on_failure: raise instead of returning what did not converge.

    Raises:
        SceneError: a value is refused, or a stable equilibrium is wanted under loads without a potential.
        SolveError: no equilibrium was found and ``raise_on_failure`` is set.
        ValueError: unknown method, or a start of another model.
    """
    inputs = model.pack(values)
    if start is not None and len(_unknowns(model, start)) != model.size:
        raise ValueError(f"the start has {len(_unknowns(model, start))} unknowns, the model {model.size}")
    if method not in _METHODS:
        raise ValueError(f"method is one of {', '.join(_METHODS)}, got {method!r}")
    if stable:
        check_potential(model, inputs)
    limits = settings or ContinuationSettings()
    end = _METHODS[method](model, inputs, start, limits, progress)
    solution = judge(model, inputs, end.x, end.outcome, end.iterations, end.load_factor, limits.newton.tolerance)
    if stable and not solution.stable:
        solution = stabilised(solution, limits, progress)
    if raise_on_failure and not solution.converged:
        raise SolveError(solution.message)
    return solution


def check_potential(model: Model, inputs: FloatArray) -> None:
    """Refuse to look for a stable equilibrium where the sign of an energy does not tell which is.

    Raises:
        SceneError: the loads have no potential at these inputs.
    """
    if not model.has_potential(inputs):
        problem = "the loads have no potential, so no energy tells which equilibrium is stable"
        raise SceneError(Problem("--stable", problem, "leave it out, or make the loads dead forces"))


def stabilised(solution: Solution, limits: ContinuationSettings, progress: Progress | None = None) -> Solution:
    """A stable equilibrium in place of a solution that is none; without one the solution, and its message says so."""
    if solution.outcome in (Outcome.NOT_FINITE, Outcome.UNRESOLVED):
        return solution
    if not can_settle(solution.model):
        return replace(solution, message=solution.message + CANNOT_SETTLE)
    found = settled(solution, limits.newton, progress)
    return replace(solution, message=solution.message + NONE_STABLE) if found is None else found


def _continuation(
    model: Model,
    inputs: FloatArray,
    start: Start,
    limits: ContinuationSettings,
    progress: Progress | None,
) -> _End:
    if isinstance(start, Solution):
        path = input_path(model, start.x, start.inputs, inputs)
    else:
        near = None if start is None or not np.any(start) else correct(model, inputs, start, limits.newton)
        if near is not None:
            return _End(near.x, near.outcome, near.iterations)
        path = load_path(model, inputs)
    result = follow(path, limits, progress)
    return _End(result.x, result.outcome, result.iterations, result.reached)


def _unknowns(model: Model, start: Start) -> FloatArray:
    if start is None:
        return model.unloaded()
    return start.x if isinstance(start, Solution) else start


def _rootfinder(
    model: Model,
    inputs: FloatArray,
    start: Start,
    limits: ContinuationSettings,
    progress: Progress | None,
) -> _End:
    options = {
        "abstol": limits.newton.tolerance,
        "max_iter": limits.newton.iterations,
        "error_on_fail": False,
        "jacobian_function": model.jacobian,
    }
    finder = ca.rootfinder("finder", "newton", model.residual, options)
    x = finder(_unknowns(model, start), inputs).full()[:, 0]
    return _End(x, Outcome.MAX_ITERATIONS, int(finder.stats()["iter_count"]))


def _nlpsol(
    model: Model,
    inputs: FloatArray,
    start: Start,
    limits: ContinuationSettings,
    progress: Progress | None,
) -> _End:
    x, p = ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size)
    problem = {"x": x, "p": p, "f": ca.MX(0), "g": model.residual(x, p)}
    options = {
        "print_time": False,
        "error_on_fail": False,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "tol": limits.newton.tolerance,
            "constr_viol_tol": limits.newton.tolerance,
        },
    }
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    found = solver(x0=_unknowns(model, start), p=inputs, lbg=0, ubg=0)
    return _End(found["x"].full()[:, 0], Outcome.MAX_ITERATIONS, int(solver.stats()["iter_count"]))


_METHODS: dict[str, Callable[[Model, FloatArray, Start, ContinuationSettings, Progress | None], _End]] = {
    "continuation": _continuation,
    "rootfinder": _rootfinder,
    "nlpsol": _nlpsol,
}
