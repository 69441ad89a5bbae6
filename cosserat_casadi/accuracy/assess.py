"""Faults that keep a solution on a uniform discretisation from being a reference solution.

The verdicts, in the order of the tests; ``refine`` has a step for each:

====================  ==================================================================
``NeedsNodes``        an interval turns too far, so that the nodes do not resolve the rod
``NoEquilibrium``     the solve failed otherwise
``NeedsModes``        the last coefficients cannot show a wave, or extrapolate to too much error
``NeedsFinerSums``    the sections at which layers are summed leave too much error
``NeedsFibres``       the fibres at which laws are summed leave too much error
``NeedsFinerGrid``    the intervals leave too much error
``NeedsModes``        an estimate with the missing modes finds too much error
``Enough``            the errors of modes and grid are small shares of the tolerance
====================  ==================================================================

Coefficients do not show a residual that is orthogonal to the polynomials: the equations balance moments of the stress,
not the stress at nodes. Loads of fixed direction rotate in the frame of a section that turns: in an element that turns
by T the strain may oscillate with T/(2π) waves. Legendre coefficients of such a wave are nearly zero up to a degree of
about T/2, so with fewer modes the last coefficients are small, however wrong the rod is.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.resolution import Resolution
from cosserat_casadi.equilibrium.metrics import largest_turn
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.required_modes import modes_for_turn
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.rod.material_functions import stress_beyond_hooke

REFERENCE_SHARE = 0.15
"""Share of the tolerance for the error of a reference solution by its modes; its grid has a third of that."""

SUM_SHARE = 0.25
"""Share of the tolerance for the error of sums of layers, and of fibres: answers on fewer modes have equal sums."""

FASTEST_SUMS = 3.0
"""Largest factor on the sections at which layers are summed: their error falls with the fourth power, about."""

FLOOR = 1e-13
"""Error of a reference solution that cannot be distinguished from rounding."""

MOST_NODES = 400
"""Most intervals of an element: a rod that these do not resolve is given up."""

MOST_REFINED = 2.0
"""Largest factor on intervals that do not resolve a rod, which may bend otherwise on more intervals."""

NODES_MARGIN = 1.2
"""Factor on the intervals that would just resolve the present shape of the rod."""


@dataclass(frozen=True)
class Enough:
    """The solution can serve as a reference."""

    resolution: Resolution


@dataclass(frozen=True)
class NeedsModes:
    """More modes are needed.

    Attributes:
        modes: per strain component and element.
        extrapolated: whether their number is extrapolated from the rate of convergence, and may be too large.
    """

    modes: int
    extrapolated: bool


@dataclass(frozen=True)
class NeedsNodes:
    """The rod is too bent for its grid.

    Attributes:
        nodes: intervals per element that should resolve it.
    """

    nodes: int


@dataclass(frozen=True)
class NeedsFinerSums:
    """Layers are summed at too few sections.

    Attributes:
        factor: factor on their number.
    """

    factor: float


@dataclass(frozen=True)
class NeedsFibres:
    """Laws are summed over too few fibres."""


@dataclass(frozen=True)
class NeedsFinerGrid:
    """The grid leaves too large an error, though it resolves the rod."""


@dataclass(frozen=True)
class NoEquilibrium:
    """There is no solution to judge."""


Verdict = Enough | NeedsModes | NeedsNodes | NeedsFinerSums | NeedsFibres | NeedsFinerGrid | NoEquilibrium


def assess(solution: Solution, tolerance: float, waves: bool = False) -> Verdict:
    """Faults that keep a solution from being a reference for a tolerance.

    Args:
        solution: a solution with one number of modes for all components, and one of intervals for all elements.
        tolerance: wanted error of the tip poses.
        waves: whether the scene puts waves along its rods.
    """
    modes, nodes = _uniform(solution)
    if solution.outcome is Outcome.UNRESOLVED and nodes < MOST_NODES and not _too_deep(solution):
        return NeedsNodes(_resolving_nodes(solution, nodes))
    if not solution.converged:
        return NoEquilibrium()
    # Blindness first: modes that are blind to a wave also underestimate their error.
    visible_from = min_modes(solution, largest_turn(solution), tolerance)
    if visible_from > modes:
        return NeedsModes(visible_from, extrapolated=False)
    modes_bound = max(REFERENCE_SHARE * tolerance, FLOOR)
    resolution = Resolution(Preview(solution), waves, modes_bound)
    missing = resolution.missing_modes(resolution.extrapolated_error, modes_bound)
    if missing > 0:
        return NeedsModes(modes + missing, extrapolated=True)
    sum_bound = max(SUM_SHARE * tolerance, FLOOR)
    if resolution.sum_error > sum_bound:
        growth = NODES_MARGIN * (resolution.sum_error / sum_bound) ** 0.25
        return NeedsFinerSums(min(growth, FASTEST_SUMS))
    if resolution.fibre_error > sum_bound:
        return NeedsFibres()
    # Estimates that need the equations on another grid come last, and the one with more modes after the cheaper one
    # with a finer grid alone: on a grid that is too coarse both show its error.
    grid_bound = max(REFERENCE_SHARE / 3 * tolerance, FLOOR)
    if resolution.grid_error > grid_bound:
        return NeedsFinerGrid()
    missing = resolution.missing_modes(resolution.hidden_error, modes_bound)
    if missing > 0:
        return NeedsModes(modes + missing, extrapolated=True)
    return Enough(resolution)


def _uniform(solution: Solution) -> tuple[int, int]:
    """Modes and intervals of a uniform discretisation."""
    discretisations = solution.model.discretisation.values()
    first = next(iter(discretisations))
    return first.modes[0], first.nodes


def _too_deep(solution: Solution) -> bool:
    """Whether a rod is deeper in an obstacle than the obstacle's width, which more nodes do not change."""
    return any(touch.gap is not None and touch.width and touch.gap < -touch.width for touch in solution.contacts)


def _resolving_nodes(solution: Solution, nodes: int) -> int:
    """Intervals that should resolve a rod too bent for its grid."""
    # The index exceeds 1 by the factor by which an interval turns too far.
    resolution_index = solution.model.resolution_index(solution.x, solution.inputs)
    factor = NODES_MARGIN * float(resolution_index)
    return ceil(nodes * min(MOST_REFINED, factor))


def node_residual(solution: Solution) -> float:
    """Largest strain by which stress and internal wrench differ at the nodes; curvatures times the length."""
    largest = 0.0
    for name, discrete_rod in solution.model.discrete.rods.items():
        X = known(discrete_rod.grid.nodes)
        rod = discrete_rod.properties
        fields = solution.model.fields[name](solution.x, solution.inputs)
        wrench = fields[2].full().T - _stress_beyond_hooke(solution, name)
        hooke = rod.hooke(X)
        strain = solution.strain(X, name) - rod.intrinsic_strain(X)
        for component in rod.admitted:
            stress_strain = wrench[:, component] / hooke[:, component]
            difference = stress_strain - strain[:, component]
            # Components 0 to 2 are curvatures, in 1/m; the others have no unit.
            unit = rod.length if component < 3 else 1.0
            largest = max(largest, float(np.abs(difference).max()) * unit)
    return largest


def _stress_beyond_hooke(solution: Solution, name: str) -> FloatArray:
    """Stress of the material at the nodes beyond its Hooke tensor's, shape (nodes, 6), N m and N."""
    discrete_rod = solution.model.discrete.rods[name]
    law = discrete_rod.properties.beyond_hooke
    X = known(discrete_rod.grid.nodes)
    if law is None:
        return np.zeros((len(X), 6))
    data = known(law.data(X)).T
    stress = stress_beyond_hooke(law, len(data)).map(len(X))
    changes = solution.strain(X, name) - discrete_rod.properties.intrinsic_strain(X)
    return np.asarray(stress(changes.T, data).full().T)


def min_modes(solution: Solution, turn: float, tolerance: float) -> int:
    """Least modes of each strain whose last coefficients tell how well a rod is resolved; 0 if any number does.

    Args:
        solution: an equilibrium of the discrete model.
        turn: largest turn of an element, rad.
        tolerance: strain below which an error does not matter.
    """
    needed = modes_for_turn(turn)
    fewest = min(min(d.modes) for d in solution.model.discretisation.values())
    if fewest >= needed:
        return 0
    if node_residual(solution) <= tolerance:
        return 0
    return needed
