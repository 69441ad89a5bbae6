"""From where a method stopped to a solution: one test of residual, resolution and stability for all methods."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.load_path import column, input_path, is_shape
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.stability import Stability, admissible_spectrum, judged, second_variation, variations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.newton import NewtonResult, NewtonSettings, length_of, newton, relative_norm
from cosserat_casadi.numerics.outcome import Outcome

NEAR = 0.5
"""Most that a correction may move strains and poses of frames (2-norm) and still count as on the same branch."""


ASIDE, ASIDE_STEPS = 0.05, 8
"""Way along a neutral variation on which an equilibrium alike is looked for, and the Newton steps it may take."""


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
    residual = column(model.path_residual(x, inputs, 1.0))
    norm = relative_norm(residual, x)
    if load_factor == 1.0:
        outcome = _verdict(model, (x, inputs), outcome, norm, tolerance)
    message = outcome.value if load_factor == 1.0 else f"{outcome.value} Load factor reached: {load_factor:.6g}."
    message += "" if outcome is Outcome.CONVERGED else gap_left(model, inputs, x)
    bare = Solution(model, inputs, x, outcome, message, norm, iterations, load_factor)
    return _with_stability(bare) if bare.converged else bare


def gap_left(model: Model, inputs: FloatArray, x: FloatArray) -> str:
    """The widest gap between rods and what they are tied to, as a sentence; empty where nothing is tied."""
    ties = model.discrete.couplings.ties
    if not ties or not np.all(np.isfinite(x)):
        return ""
    gaps = column(model.path_residual(x, inputs, 1.0))
    own = [gaps[model.discrete.tie_slices[tie.where]][: len(tie.joint.position_axes)] for tie in ties]
    worst = int(np.argmax([length_of(gap) for gap in own]))
    share, tie = length_of(own[worst]), ties[worst]
    metres = share * tie.joint.rod.length
    return f" The assembly is not closed: {tie.what} is {share:.2g} of its length, {metres:.3g} m, from its place."


def _verdict(
    model: Model, at: tuple[FloatArray, FloatArray], outcome: Outcome, norm: float, tolerance: float
) -> Outcome:
    if not np.isfinite(norm):
        return Outcome.NOT_FINITE
    if norm <= tolerance:
        return Outcome.CONVERGED if float(model.coarseness(*at)) <= 1.0 else Outcome.UNRESOLVED
    return Outcome.MAX_ITERATIONS if outcome is Outcome.CONVERGED else outcome


def _with_stability(solution: Solution) -> Solution:
    model = solution.model
    if not model.has_potential(solution.inputs):
        return solution
    jacobian = model.path_jacobian(solution.x, solution.inputs, 1.0).full()
    values, ways = admissible_spectrum(jacobian, variations(model))
    test = judged(values)
    critical = test.neutral and not _moves_on(solution, ways[:, np.argsort(np.abs(values))[: test.zero]])
    return replace(
        solution,
        smallest_eigenvalue=test.smallest_eigenvalue,
        stable=test.stable and not critical,
        message=solution.message + _note(test, critical),
    )


def _note(test: Stability, critical: bool) -> str:
    """What a user must know of an equilibrium that not every variation costs energy."""
    if critical:
        return " It is critical: some variation costs no energy to second order; a slight change may unsettle it."
    if test.neutral:
        return " It is neutral: the rod can be turned on through equilibria alike without energy."
    return "" if test.stable else f" It is unstable: {_counted(test.negative)} energy."


def _counted(negative: int) -> str:
    return "a variation releases" if negative == 1 else f"{negative} independent variations release"


def _moves_on(solution: Solution, ways: FloatArray) -> bool:
    """Whether each variation that costs no energy, n×k, leads to equilibria alike and not just away from this one."""
    return all(_alike_beside(solution, way) for way in ways.T)


def _alike_beside(solution: Solution, way: FloatArray) -> bool:
    model, inputs, x = solution.model, solution.inputs, solution.x
    start = x.copy()
    allowed = variations(model)
    start[allowed.free] += ASIDE * way
    found = newton(input_path(model, start, inputs, inputs).at(1.0), start, NewtonSettings(iterations=ASIDE_STEPS))
    if found.outcome is not Outcome.CONVERGED or not ASIDE / 2 <= length_of(found.x - x) <= 2 * ASIDE:
        return False
    jacobian = model.path_jacobian(found.x, inputs, 1.0).full()
    return second_variation(jacobian, allowed).neutral


def correct(model: Model, inputs: FloatArray, start: FloatArray, settings: NewtonSettings) -> NewtonResult | None:
    """Newton from unknowns near an equilibrium; None where it does not stay near, so that it may be another branch.

    Args:
        model: what to solve.
        inputs: stacked inputs.
        start: first iterate, shape (size,).
        settings: limits.
    """
    found = newton(input_path(model, start, inputs, inputs).at(1.0), start, settings)
    # Multipliers and tensions may jump where a stiff rod moves by a hair: they tell nothing of the branch.
    strayed = found.damped or length_of((found.x - start)[is_shape(model)]) > NEAR
    return None if found.outcome is not Outcome.CONVERGED or strayed else found
