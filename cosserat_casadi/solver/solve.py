"""Solve a model: by load continuation, or by CasADi's own solvers, judged by one test of our own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import SolveError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.solver.continuation import ContinuationSettings, Path, Progress, follow
from cosserat_casadi.solver.newton import NewtonResult, NewtonSettings, length_of, newton, relative_norm
from cosserat_casadi.solver.outcome import Outcome
from cosserat_casadi.solver.secant import Jacobian
from cosserat_casadi.solver.solution import Solution
from cosserat_casadi.solver.stability import second_variation, variations

Start = Solution | FloatArray | None
"""Where a solve starts: a solution, unknowns, or the unloaded rod."""

NEAR = 0.5
"""Longest way of the unknowns (2-norm) that a correction may go and still count as the same branch."""


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
        settings: limits of the continuation.
        progress: told the share of the path that is done.
        raise_on_failure: raise instead of returning what did not converge.

    Raises:
        SceneError: a value is refused.
        SolveError: no equilibrium was found and ``raise_on_failure`` is set.
        ValueError: unknown method, or a start of another model.
    """
    inputs = model.pack(values)
    if start is not None and len(_unknowns(model, start)) != model.size:
        raise ValueError(f"the start has {len(_unknowns(model, start))} unknowns, the model {model.size}")
    if method not in _METHODS:
        raise ValueError(f"method is one of {', '.join(_METHODS)}, got {method!r}")
    limits = settings or ContinuationSettings()
    end = _METHODS[method](model, inputs, start, limits, progress)
    solution = judge(model, inputs, end.x, end.outcome, end.iterations, end.load_factor, limits.newton.tolerance)
    if raise_on_failure and not solution.converged:
        raise SolveError(solution.message)
    return solution


def judge(
    model: Model,
    inputs: FloatArray,
    x: FloatArray,
    outcome: Outcome,
    iterations: int,
    load_factor: float,
    tolerance: float,
) -> Solution:
    """The solution that a method's end amounts to: the residual is computed again, the method's word is not taken."""
    residual = _column(model.path_residual(x, inputs, 1.0))
    norm = relative_norm(residual, x)
    if load_factor == 1.0:
        outcome = _verdict(outcome, norm, tolerance)
    message = outcome.value if load_factor == 1.0 else f"{outcome.value} Load factor reached: {load_factor:.6g}."
    message += "" if outcome is Outcome.CONVERGED else gap_left(model, inputs, x)
    bare = Solution(model, inputs, x, outcome, message, norm, iterations, load_factor)
    return _with_stability(bare) if bare.converged else bare


def gap_left(model: Model, inputs: FloatArray, x: FloatArray) -> str:
    """The widest gap between rods and what they are tied to, as a sentence; empty where nothing is tied."""
    ties = model.frame.couplings.ties
    if not ties or not np.all(np.isfinite(x)):
        return ""
    gaps = _column(model.path_residual(x, inputs, 1.0))
    own = [gaps[model.frame.tie_slices[tie.where]][: len(tie.joint.position_axes)] for tie in ties]
    worst = int(np.argmax([length_of(gap) for gap in own]))
    share, tie = length_of(own[worst]), ties[worst]
    metres = share * tie.joint.rod.length
    return f" The assembly is not closed: {tie.what} is {share:.2g} of its length, {metres:.3g} m, from its place."


def _verdict(outcome: Outcome, norm: float, tolerance: float) -> Outcome:
    if not np.isfinite(norm):
        return Outcome.NOT_FINITE
    if norm <= tolerance:
        return Outcome.CONVERGED
    return Outcome.MAX_ITERATIONS if outcome is Outcome.CONVERGED else outcome


def _with_stability(solution: Solution) -> Solution:
    model = solution.model
    if not model.has_potential(solution.inputs):
        return solution
    jacobian = model.path_jacobian(solution.x, solution.inputs, 1.0).full()
    test = second_variation(jacobian, variations(model))
    notes = {
        (True, False): "",
        (False, False): " It is unstable.",
        (False, True): " It is neutral: some variation costs no energy.",
    }
    return replace(
        solution,
        smallest_eigenvalue=test.smallest_eigenvalue,
        stable=test.stable,
        message=solution.message + notes[test.stable, test.neutral],
    )


def correct(model: Model, inputs: FloatArray, start: FloatArray, settings: NewtonSettings) -> NewtonResult | None:
    """Newton from unknowns near an equilibrium; None where it does not stay near, so that it may be another branch.

    Args:
        model: what to solve.
        inputs: stacked inputs.
        start: first iterate, shape (size,).
        settings: limits.
    """
    found = newton(input_path(model, start, inputs, inputs).at(1.0), start, settings)
    strayed = found.damped or length_of(found.x - start) > NEAR
    return None if found.outcome is not Outcome.CONVERGED or strayed else found


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


def load_path(model: Model, inputs: FloatArray) -> Path:
    """From the unloaded scene to the scene, all loads growing together."""
    none = np.zeros(model.inputs.size)
    return Path(
        residual=lambda x, t: _column(model.path_residual(x, inputs, t)),
        jacobian=lambda x, t: _matrix(model, model.path_jacobian(x, inputs, t)),
        rate=lambda x, t: _column(model.path_rate(x, inputs, t, none, 1.0)),
        start=model.unloaded(),
        tangent=_column(model.path_tangent(inputs)),
    )


def input_path(model: Model, start: FloatArray, before: FloatArray, after: FloatArray) -> Path:
    """From an equilibrium of the scene to other inputs, on the straight line between them."""
    change = after - before

    def at(t: float) -> FloatArray:
        # Exact at both ends, however far apart they are.
        return (1.0 - t) * before + t * after

    return Path(
        residual=lambda x, t: _column(model.path_residual(x, at(t), 1.0)),
        jacobian=lambda x, t: _matrix(model, model.path_jacobian(x, at(t), 1.0)),
        rate=lambda x, t: _column(model.path_rate(x, at(t), 1.0, change, 0.0)),
        start=start,
    )


def _matrix(model: Model, jacobian: ca.DM) -> Jacobian:
    """A Jacobian as it is solved with: sparse where ties make an assembly, dense where rods are alone."""
    return jacobian if model.frame.couplings.ties else np.asarray(jacobian.full())


def _column(vector: ca.DM) -> FloatArray:
    return np.asarray(vector.full()[:, 0]) if vector.shape[0] else np.zeros(0)


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
