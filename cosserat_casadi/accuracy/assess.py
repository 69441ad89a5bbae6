"""Faults that keep a solution on a uniform discretisation from being a reference solution.

The verdicts, in the order in which they are looked for; each has its step in ``refine``:

====================  ==================================================================
``NeedsNodes``        an interval turns too far, so the solution is not one of the rod
``NoEquilibrium``     the solve failed otherwise
``NeedsModes``        the last coefficients are blind to a wave, or their fall promises too much error
``NeedsFinerSums``    the sections at which layers are summed leave too much error
``NeedsFinerGrid``    the intervals leave too much error
``NeedsModes``        a look at modes that the solution lacks finds too much error
``Enough``            the errors of modes and grid are small shares of the tolerance
====================  ==================================================================
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from cosserat_casadi.accuracy.node_residual import min_modes
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.resolution import Resolution
from cosserat_casadi.equilibrium.metrics import largest_turn
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.numerics.outcome import Outcome

REFERENCE_SHARE = 0.15
"""Share of the tolerance that the modes of a reference solution may be off by, its grid by a third of that."""

SUM_SHARE = 0.25
"""Share of the tolerance that sums of layers may be off by: answers on fewer modes have sums alike."""

FASTEST_SUMS = 3.0
"""Largest factor on the sections at which layers are summed: their error falls with the fourth power, about."""

FLOOR = 1e-13
"""Error of a reference solution that cannot be distinguished from rounding."""

MOST_NODES = 400
"""Intervals of an element beyond which a rod too bent for them is given up."""

MOST_REFINED = 2.0
"""Largest factor on intervals that do not resolve a rod: on more intervals it may be bent otherwise."""

NODES_MARGIN = 1.2
"""Factor on the intervals that would just resolve the rod as it is now."""


@dataclass(frozen=True)
class Enough:
    """The solution can serve as a reference."""

    resolution: Resolution


@dataclass(frozen=True)
class NeedsModes:
    """More modes are needed.

    Attributes:
        modes: per strain component and element.
        extrapolated: whether their number follows from the rate of convergence, and so may be too large.
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
        factor: on their number.
    """

    factor: float


@dataclass(frozen=True)
class NeedsFinerGrid:
    """The grid leaves too large an error, though it resolves the rod."""


@dataclass(frozen=True)
class NoEquilibrium:
    """There is no solution to judge."""


Verdict = Enough | NeedsModes | NeedsNodes | NeedsFinerSums | NeedsFinerGrid | NoEquilibrium


def assess(solution: Solution, tolerance: float, waves: bool = False) -> Verdict:
    """Faults that keep a solution from being a reference for a tolerance.

    Args:
        solution: on the same modes for every component, and the same intervals for every element.
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
    # What takes the equations on another grid is asked for last, the look at more modes after the cheaper one at a grid
    # alone: on a grid that is too coarse both see its error.
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
    """Whether a rod is deeper inside an obstacle than its width, which more nodes do not change."""
    return any(touch.gap is not None and touch.width and touch.gap < -touch.width for touch in solution.contacts)


def _resolving_nodes(solution: Solution, nodes: int) -> int:
    """Intervals that should resolve a rod too bent for its grid."""
    # Beyond 1 by the factor by which an interval turns too far.
    resolution_index = solution.model.resolution_index(solution.x, solution.inputs)
    factor = NODES_MARGIN * float(resolution_index)
    return ceil(nodes * min(MOST_REFINED, factor))
