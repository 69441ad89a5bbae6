"""A stable equilibrium where the load path ends at an unstable one: the rod descends in energy to a minimum.

A free rod is released where the load path ended, off its saddle. A held rod is pulled in to its supports by springs
that grow from limp to rigid, the loads growing along, and relaxes anew at every stage: at a bifurcation it leaves for
the branch of less energy. The minimum of the energy is corrected by Newton's method and judged like any other solution.
See docs/theory.md, section 9, "Relaxing".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.judge import MAX_DISTANCE, judge
from cosserat_casadi.equilibrium.load_path import column, input_path
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.stability import admissible_spectrum, variations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.numerics.descent import DescentSettings, Energy, descend
from cosserat_casadi.numerics.newton import NewtonSettings, length_of, newton
from cosserat_casadi.numerics.progress import Progress

SPRINGS = tuple(float(k) for k in 4.0 ** np.arange(-1, 16))
"""Stiffnesses of the springs for supports, stage by stage: EI/ℓ³ for a force, EI/ℓ for a moment."""

STIFF = 4.0**9
"""Stiffness of the springs from which Newton may close the supports; a tightly drawn rod needs more.
"""

SIDES = (1.0, -1.0)
"""Sides on which a try leaves a saddle, one after the other."""

RANDOM_TRIES = 4
"""Number of further tries, each from the saddle plus a random combination of its unstable variations."""

OFF = 0.3
"""Length of a perturbation off a saddle (2-norm of the strain coordinates)."""

PATH_OF_ENERGY = " The rod reached it by settling to less energy, not by growth of the load."
"""Sentence in the message of a relaxed solution."""


def relaxed(solution: Solution, settings: NewtonSettings, progress: Progress | None = None) -> Solution | None:
    """Find a stable equilibrium of the same model and inputs.

    Args:
        solution: the end of the load path: an unstable equilibrium, or the last equilibrium on the path.
        settings: limits of the final correction.
        progress: receives the share of the tries that is done.

    Returns:
        the equilibrium; None if no try leads to one.
    """
    tries = len(SIDES) + RANDOM_TRIES
    for k, (start, side) in enumerate(_tries(solution)):
        for x in _descended(solution, start, side):
            corrected = _corrected(solution, x, settings)
            if corrected.stable and _is_near(corrected, x):
                return replace(corrected, message=corrected.message + PATH_OF_ENERGY)
        if progress is not None:
            progress((k + 1) / tries)
    return None


def can_relax(model: Model) -> bool:
    """Whether a model's energy depends on strains alone: it has no floating frames and no cables of given length."""
    discrete = model.discrete
    return not discrete.is_assembly and not discrete.frames and not discrete.cables


def _tries(solution: Solution) -> Iterator[tuple[FloatArray, float]]:
    """Strain coordinates to start from, shape (n,), and the side, +1 or −1, on which a saddle is left.

    Tries begin on both sides of the end of the path, then beside it.
    """
    model = solution.model
    # A held rod begins without its springs, at its intrinsic shape.
    unknowns = model.unloaded() if model.discrete.constraints else solution.x
    start = unknowns[: model.discrete.unknowns.count(BlockKind.STRAIN)]
    for side in SIDES:
        yield start, side

    jacobian = model.path_jacobian(solution.x, solution.inputs, 1.0).full()
    eigenvalues, admissible = admissible_spectrum(jacobian, variations(model))
    if not admissible.size:
        return
    # If the path stalled just before an instability, the variation of the lowest eigenvalue leads off it.
    count = max(1, int(np.sum(eigenvalues < 0.0)))
    unstable = admissible[:, :count]
    # Seeded, so that a scene relaxes to the same equilibrium every time.
    random = np.random.default_rng(0)
    for k in range(RANDOM_TRIES):
        shares = random.standard_normal(unstable.shape[1])
        direction = unstable @ shares
        beside = start + OFF * direction / np.linalg.norm(direction)
        yield beside, SIDES[k % 2]


def _descended(solution: Solution, start: FloatArray, side: float) -> Iterator[FloatArray]:
    """Unknowns at the minima that a try leads to. A free rod relaxes at the full load, to one minimum.

    A held rod relaxes at every stage of its springs; minima of stiff stages come nearer to the supports.
    """
    model = solution.model
    if not model.discrete.constraints:
        released = descend(energy_at(model, solution.inputs, 1.0), start, side, DescentSettings())
        if released is not None:
            yield released
        return
    q = start
    for spring in SPRINGS:
        # λ gap + (1 − λ) multiplier = 0 is a spring of stiffness λ / (1 − λ).
        load_factor = spring / (1.0 + spring)
        minimum = descend(energy_at(model, solution.inputs, load_factor), q, side, DescentSettings())
        if minimum is None:
            return
        # The next stage begins at the end of this one: the springs pull the rod in without a jump.
        q = minimum
        if spring >= STIFF:
            yield _with_multipliers(model, solution.inputs, load_factor, q)


def _is_near(corrected: Solution, x: FloatArray) -> bool:
    """Whether a corrected equilibrium is the one that springs drew the rod to, and not another one."""
    if not corrected.model.discrete.constraints:
        # A free rod has relaxed at the full load: Newton has no gap to close.
        return True
    unknowns = corrected.model.discrete.unknowns
    moved = corrected.x - x
    return length_of(moved[unknowns.differential]) <= MAX_DISTANCE


def energy_at(model: Model, inputs: FloatArray, load_factor: float) -> Energy:
    """Energy of a scene at a load factor, in units of EI/ℓ, as a function of the strain coordinates alone.

    Below the load factor 1 supports are springs, and their multipliers follow from the gaps.

    Args:
        model: the model.
        inputs: stacked inputs, shape (model.inputs.size,).
        load_factor: share of the loads, below 1 for a held rod.
    """
    n = model.discrete.unknowns.count(BlockKind.STRAIN)
    strains = slice(0, n)
    multipliers = slice(n, model.size)

    def gradient(q: FloatArray) -> FloatArray:
        x = _with_multipliers(model, inputs, load_factor, q)
        residual = model.path_residual(x, inputs, load_factor)
        return column(residual)[strains]

    def hessian(q: FloatArray) -> FloatArray:
        x = _with_multipliers(model, inputs, load_factor, q)
        jacobian = model.path_jacobian(x, inputs, load_factor).full()
        hessian_of_rods = np.asarray(jacobian[strains, strains])
        if model.size == n:
            return hessian_of_rods
        # Schur complement: the multipliers' own block is (1 − λ) times the identity.
        force_rates = jacobian[strains, multipliers]
        gap_rates = jacobian[multipliers, strains]
        hessian_of_springs = force_rates @ gap_rates / (1.0 - load_factor)
        return np.asarray(hessian_of_rods - hessian_of_springs)

    return Energy(gradient, hessian)


def _with_multipliers(model: Model, inputs: FloatArray, load_factor: float, q: FloatArray) -> FloatArray:
    """Unknowns with the multipliers that springs exert: (1 − λ) multiplier = −λ gap."""
    n = model.discrete.unknowns.count(BlockKind.STRAIN)
    if model.size == n:
        return q
    no_multipliers = np.zeros(model.size - n)
    x = np.append(q, no_multipliers)
    residual = column(model.path_residual(x, inputs, load_factor))
    # With zero multipliers the equations of the supports are λ gap.
    scaled_gaps = residual[n:]
    x[n:] = scaled_gaps / (load_factor - 1.0)
    return x


def _corrected(solution: Solution, x: FloatArray, settings: NewtonSettings) -> Solution:
    """The judged end of Newton's method at the full load from a relaxed shape."""
    model = solution.model
    inputs = solution.inputs
    full_load = input_path(model, x, inputs, inputs)
    end = newton(full_load.at(1.0), x, settings)
    iterations = solution.iterations + end.iterations
    return judge(
        model,
        inputs,
        end.x,
        end.outcome,
        iterations=iterations,
        load_factor=1.0,
        tolerance=settings.tolerance,
    )
