"""A stable equilibrium where growing the load leads to none: the rod is let go and settles in a minimum of energy.

A free rod is let go where the load path ended, off its saddle. A held rod is drawn to its supports by springs that
grow from limp to rigid, the loads growing along, and settles anew at every stage: at a bifurcation it leaves for the
branch of less energy. What it settles in is corrected by Newton's method and judged like any other solution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.judge import judge
from cosserat_casadi.equilibrium.load_path import column, input_path
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.stability import admissible_spectrum, variations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.numerics.continuation import Progress
from cosserat_casadi.numerics.descent import DescentSettings, Energy, descend
from cosserat_casadi.numerics.newton import NewtonSettings, newton

SPRINGS = tuple(float(k) for k in 4.0 ** np.arange(-1, 10))
"""Stiffnesses of the springs for supports, stage by stage: EI/ℓ³ for a force, EI/ℓ for a moment."""

SIDES = (1.0, -1.0)
"""Sides on which a saddle is left, one try after the other."""

RANDOM_TRIES = 4
"""Further tries, each from a start off the saddle in a random combination of its unstable variations."""

OFF = 0.3
"""Length of such a perturbation."""

PATH_OF_ENERGY = " It was reached by letting the rod settle to less energy, not by growing the load."


def settled(solution: Solution, settings: NewtonSettings, progress: Progress | None = None) -> Solution | None:
    """A stable equilibrium of the same model and inputs; None if none was found.

    Args:
        solution: where the load path ended: an unstable equilibrium, or the last one on the way.
        settings: limits of the final correction.
        progress: told the share of the tries that is done.
    """
    model = solution.model
    for k, (start, side) in enumerate(_tries(solution)):
        q = _drawn(solution, start, side) if model.discrete.constraints else _let_go(solution, start, side)
        found = None if q is None else _corrected(solution, q, settings)
        if found is not None and found.stable:
            return replace(found, message=found.message + PATH_OF_ENERGY)
        if progress is not None:
            progress((k + 1) / (len(SIDES) + RANDOM_TRIES))
    return None


def can_settle(model: Model) -> bool:
    """Whether a model's energy is a function of strains alone: no frames move, no cable has a length to keep."""
    return not model.discrete.is_assembly and not model.discrete.cables


def _tries(solution: Solution) -> Iterator[tuple[FloatArray, float]]:
    """Starts and sides: from where the path ended to both sides, then from beside it."""
    n, model = solution.model.discrete.unknowns.count(BlockKind.STRAIN), solution.model
    q = model.unloaded()[:n] if model.discrete.constraints else solution.x[:n]
    for side in SIDES:
        yield q, side
    jacobian = model.path_jacobian(solution.x, solution.inputs, 1.0).full()
    values, ways = admissible_spectrum(jacobian, variations(model))
    unstable = ways[:, : max(1, int(np.sum(values < 0.0)))]
    random = np.random.default_rng(0)
    for k in range(RANDOM_TRIES if unstable.size else 0):
        direction = unstable @ random.standard_normal(unstable.shape[1])
        yield q + OFF * direction / np.linalg.norm(direction), SIDES[k % 2]


def _let_go(solution: Solution, start: FloatArray, side: float) -> FloatArray | None:
    """Unknowns of a free rod that has settled at the full load."""
    return descend(energy_at(solution.model, solution.inputs, 1.0), start, side, DescentSettings())


def _drawn(solution: Solution, start: FloatArray, side: float) -> FloatArray | None:
    """Unknowns of a held rod, multipliers included, that has settled at every stage of its springs."""
    model, q = solution.model, start
    for spring in SPRINGS:
        factor = spring / (1.0 + spring)
        found = descend(energy_at(model, solution.inputs, factor), q, side, DescentSettings())
        if found is None:
            return None
        q = found
    return _with_multipliers(model, solution.inputs, factor, q)


def energy_at(model: Model, inputs: FloatArray, factor: float) -> Energy:
    """Energy of a scene at a load factor, in units of EI/ℓ, as a function of the strain coordinates alone.

    Below factor 1 supports are springs, and their multipliers follow from the gaps.
    """
    n = model.discrete.unknowns.count(BlockKind.STRAIN)

    def gradient(q: FloatArray) -> FloatArray:
        return column(model.path_residual(_with_multipliers(model, inputs, factor, q), inputs, factor))[:n]

    def hessian(q: FloatArray) -> FloatArray:
        x = _with_multipliers(model, inputs, factor, q)
        jacobian = np.asarray(model.path_jacobian(x, inputs, factor).full())
        eliminated = jacobian[:n, n:] @ jacobian[n:, :n] / (1.0 - factor) if model.size > n else 0.0
        return np.asarray(jacobian[:n, :n] - eliminated)

    return Energy(gradient, hessian)


def _with_multipliers(model: Model, inputs: FloatArray, factor: float, q: FloatArray) -> FloatArray:
    """Unknowns with the multipliers that springs exert: (1 − factor) multiplier = −factor gap."""
    n = model.discrete.unknowns.count(BlockKind.STRAIN)
    if model.size == n:
        return q
    x = np.append(q, np.zeros(model.size - n))
    x[n:] = column(model.path_residual(x, inputs, factor))[n:] / (factor - 1.0)
    return x


def _corrected(solution: Solution, x: FloatArray, settings: NewtonSettings) -> Solution:
    """Newton at the full load from what the rod has settled in, judged."""
    model, inputs = solution.model, solution.inputs
    found = newton(input_path(model, x, inputs, inputs).at(1.0), x, settings)
    iterations = solution.iterations + found.iterations
    return judge(model, inputs, found.x, found.outcome, iterations, 1.0, settings.tolerance)
