"""The richer discretisation on which the error of an answer shows: modes and intervals that the answer lacks.

Docs/theory.md, section 10.
"""

from __future__ import annotations

from dataclasses import replace

from cosserat_casadi.rod.discretisation import Discretisation

ADDED_MODES = 4
"""Modes that are added to every strain: more than one step of an error that falls by every other mode alone."""

LEAST_MODES = 6
"""Modes that every strain has at least: one that nothing excited when modes were chosen may have a single one."""

ADDED_NODES = 4
"""Intervals that are added to every element at least."""

NODES_ABOVE_MODES = 6
"""Intervals beyond the modes of a strain on which the balance of these modes is exact enough for an error."""

NEXT_ORDER = {"magnus4": "magnus6", "magnus6": "magnus8"}
"""Rotation integrators of a higher order, so that the error of the order itself shows."""


def nodes_for(modes: int) -> int:
    """Chebyshev intervals that resolve the shape of a rod whose strain has so many modes."""
    return 2 * modes + 2


def enriched(discretisation: Discretisation, signal_modes: int) -> Discretisation:
    """A discretisation with modes added to every strain, on intervals that resolve them.

    Args:
        discretisation: of a rod.
        signal_modes: modes below which a rod is blind to what the scene puts along it.
    """
    modes = tuple(max(count + ADDED_MODES, LEAST_MODES, signal_modes) for count in discretisation.modes)
    nodes = max(discretisation.nodes + ADDED_NODES, max(modes) + NODES_ABOVE_MODES)
    transport = NEXT_ORDER.get(discretisation.transport, discretisation.transport)
    return replace(discretisation, modes=modes, nodes=nodes, transport=transport)
