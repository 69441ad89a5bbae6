"""Judgement of the point where a method stopped: one test of residual, resolution and stability for all methods.

See docs/theory.md, section 9 for residual and stability, section 10 for resolution.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.load_path import column, input_path
from cosserat_casadi.equilibrium.smooth_contact import with_smooth_contacts
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.stability import (
    ConstrainedVariations,
    Stability,
    admissible_spectrum,
    second_variation,
    stability_of,
    variations,
)
from cosserat_casadi.equilibrium.strain_limits import within_limits
from cosserat_casadi.equilibrium.taut_rods import TAUT, held_taut
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.newton import NewtonResult, NewtonSettings, length_of, newton, relative_norm
from cosserat_casadi.numerics.outcome import Outcome

MAX_DISTANCE = 0.5
"""Largest change of strains and poses of frames (2-norm) by a correction that counts as on the same branch."""

ASIDE = 0.05
"""Step along a neutral variation after which another equilibrium is sought (2-norm of the unknowns)."""

ASIDE_STEPS = 24
"""Most Newton steps of this search: a rod that lies on a stiff obstacle takes 15 to turn on it."""


def judge(
    model: Model,
    inputs: FloatArray,
    x: FloatArray,
    outcome: Outcome,
    iterations: int,
    load_factor: float,
    tolerance: float,
) -> Solution:
    """Judge the end of a method as a solution; the residual is computed anew, whatever the method reports.

    Args:
        model: the solved model.
        inputs: stacked inputs, shape (model.inputs.size,).
        x: where the method stopped, shape (model.size,).
        outcome: outcome that the method reports.
        iterations: number of its Newton steps.
        load_factor: share of the loads that it reached.
        tolerance: bound on the relative norm of the residual.
    """
    residual = column(model.path_residual(x, inputs, 1.0))
    norm = relative_norm(residual, x)
    # Short of the full load there is no equilibrium of the scene to judge.
    if load_factor == 1.0:
        outcome = _verdict(model, x, inputs, outcome, norm, tolerance)
    outcome, message = within_limits(model, x, inputs, outcome)
    if load_factor != 1.0:
        message += f" Load factor reached: {load_factor:.6g}."
    if outcome is not Outcome.CONVERGED:
        message += gap_left(model, inputs, x)
    if outcome is Outcome.LOAD_STALLED and held_taut(model, inputs):
        message += TAUT
    solution = Solution(
        model,
        inputs,
        x,
        outcome,
        message,
        residual_norm=norm,
        iterations=iterations,
        load_factor=load_factor,
    )
    solution = with_smooth_contacts(solution)
    if not solution.converged:
        return solution
    return _with_stability(solution)


def gap_left(model: Model, inputs: FloatArray, x: FloatArray) -> str:
    """A sentence on the widest gap between rods and the other sides of their joints; empty without joints."""
    discrete = model.discrete
    closing = [placed for placed in discrete.constraints if placed.closes_assembly]
    if not closing or not np.all(np.isfinite(x)):
        return ""
    residual = column(model.path_residual(x, inputs, 1.0))
    gaps = []
    for placed in closing:
        constraint_residual = residual[discrete.multipliers(placed)]
        displacements = placed.constraint.held.positions.shape[1]
        gaps.append(length_of(constraint_residual[:displacements]))
    # Gaps are relative to the length of the rod; the widest one shows where the problem is.
    worst = int(np.argmax(gaps))
    share = gaps[worst]
    placed = closing[worst]
    metres = share * placed.constraint.length
    return f" The assembly is not closed: {placed.what} is {share:.2g} of its length, {metres:.3g} m, from its place."


def _verdict(
    model: Model, x: FloatArray, inputs: FloatArray, outcome: Outcome, norm: float, tolerance: float
) -> Outcome:
    """Outcome and sentence of a solve at the full load."""
    if not np.isfinite(norm):
        return Outcome.NOT_FINITE
    if norm <= tolerance:
        # Beyond 1 the nodes are too few for the solution to be one of the rod.
        resolution_index = float(model.resolution_index(x, inputs))
        if resolution_index <= 1.0:
            return Outcome.CONVERGED
        return Outcome.UNRESOLVED
    # The method has reported an equilibrium that is none.
    if outcome is Outcome.CONVERGED:
        return Outcome.MAX_ITERATIONS
    return outcome


def _with_stability(solution: Solution) -> Solution:
    """An equilibrium with the verdict on its stability, if its loads have a potential."""
    model = solution.model
    if not model.has_potential(solution.inputs):
        return solution
    jacobian = model.path_jacobian(solution.x, solution.inputs, 1.0).full()
    eigenvalues, admissible = admissible_spectrum(jacobian, variations(model))
    stability = stability_of(eigenvalues)
    critical = False
    if stability.neutral:
        smallest_first = np.argsort(np.abs(eigenvalues))
        neutral = admissible[:, smallest_first[: stability.zero]]
        # Each zero eigenvalue belongs to a family of equilibria, or to a limit of stability.
        critical = not all(_is_alike_beside(solution, jacobian, variation) for variation in neutral.T)
    return replace(
        solution,
        smallest_eigenvalue=stability.smallest_eigenvalue,
        stable=stability.stable and not critical,
        message=solution.message + stability_note(stability, critical),
    )


def stability_note(stability: Stability, critical: bool) -> str:
    """A sentence for an equilibrium with a variation that costs no energy, or releases some; else empty."""
    if critical:
        return " It is critical: some variation costs no energy to second order; a slight change may make it unstable."
    if stability.neutral:
        return " It is neutral: the rod can turn through equal equilibria without energy."
    if stability.stable:
        return ""
    if stability.negative == 1:
        return " It is unstable: a variation releases energy."
    # The variations of a model are a subset of the variations of the rod.
    return f" It is unstable: at least {stability.negative} independent variations release energy."


def _is_alike_beside(solution: Solution, jacobian: FloatArray, variation: FloatArray) -> bool:
    """Whether another equilibrium of a family lies a small step along a variation, shape (n,)."""
    model = solution.model
    inputs = solution.inputs
    allowed = variations(model)
    start = solution.x.copy()
    start[allowed.free] += ASIDE * variation
    # Multipliers of a tightly held rod are large: they turn along, so that Newton need not turn them afterwards.
    start[allowed.held] += ASIDE * _multipliers_along(jacobian, allowed, variation)
    full_load = input_path(model, start, inputs, inputs)
    few_steps = NewtonSettings(iterations=ASIDE_STEPS)
    beside = newton(full_load.at(1.0), start, few_steps)
    if beside.outcome is not Outcome.CONVERGED:
        return False
    # Newton may return to the start, or go elsewhere: neither says anything on this variation. Multipliers turn along
    # and do not count.
    moved = beside.x - solution.x
    distance = length_of(moved[allowed.free])
    if not ASIDE / 2 <= distance <= 2 * ASIDE:
        return False
    jacobian = model.path_jacobian(beside.x, inputs, 1.0).full()
    return second_variation(jacobian, allowed).neutral


def _multipliers_along(jacobian: FloatArray, allowed: ConstrainedVariations, variation: FloatArray) -> FloatArray:
    """Rates of the multipliers, shape (m,), that keep the balance along a variation that costs no energy."""
    forces = jacobian[np.ix_(allowed.free, allowed.free)] @ variation
    by_multipliers = jacobian[np.ix_(allowed.free, allowed.held)]
    rates, *_ = np.linalg.lstsq(by_multipliers, -forces, rcond=None)
    return np.asarray(rates)


def correct(model: Model, inputs: FloatArray, start: FloatArray, settings: NewtonSettings) -> NewtonResult | None:
    """Correct unknowns near an equilibrium by Newton's method.

    Args:
        model: what to solve.
        inputs: stacked inputs.
        start: first iterate, shape (size,).
        settings: limits.

    Returns:
        the solve; None if it does not stay near the start and may be on another branch.
    """
    full_load = input_path(model, start, inputs, inputs)
    corrected = newton(full_load.at(1.0), start, settings)
    if corrected.outcome is not Outcome.CONVERGED or corrected.damped:
        return None
    # Newton converges from far away too, but then to any equilibrium. Multipliers and tensions may jump while a stiff
    # rod hardly moves: they do not identify the branch.
    moved = corrected.x - start
    distance = length_of(moved[model.discrete.unknowns.differential])
    if distance > MAX_DISTANCE:
        return None
    return corrected
