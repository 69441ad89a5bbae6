"""Modes, nodes and element ends of every rod of a scene."""

from __future__ import annotations

from collections.abc import Sequence

from cosserat_casadi import scene as scenes
from cosserat_casadi.model.enrichment import nodes_for
from cosserat_casadi.model.places import check_places, element_ends
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.rod.discretisation import Discretisation

DEFAULT_MODES = 6
"""Polynomials per strain component where neither the scene nor the caller gives them."""

DEFAULT_TRANSPORT = "magnus6"
"""Integration method of the rotation where neither the scene nor the caller gives one."""


def discretise(
    scene: scenes.Scene,
    modes: int | Sequence[int] | None = None,
    nodes: int | None = None,
    transport: str | None = None,
) -> dict[str, Discretisation]:
    """A discretisation for every rod: what the caller gives, else what the scene fixes, else a default.

    Args:
        scene: the scene.
        modes: polynomials per component and element, one number or one for each admitted strain.
        nodes: Chebyshev intervals per element.
        transport: integration method of the rotation.

    Raises:
        SceneError: the scene has tubes, or two places on a rod are too near each other to compute with.
    """
    refuse_tubes(scene)
    if modes is None:
        modes = scene.accuracy.modes
    if modes is None:
        modes = DEFAULT_MODES
    if nodes is None:
        nodes = scene.accuracy.nodes
    transport = transport or scene.accuracy.rotation or DEFAULT_TRANSPORT
    chosen = {}
    for rod in scene.rods:
        modes_of_rod = _per_strain(modes, len(rod.admitted))
        intervals = nodes
        if intervals is None:
            intervals = nodes_for(max(modes_of_rod))
        breaks = element_ends(scene, rod.name)
        check_places(rod.name, breaks)
        chosen[rod.name] = Discretisation(modes_of_rod, intervals, breaks, transport)
    return chosen


def _per_strain(modes: int | Sequence[int], strains: int) -> tuple[int, ...]:
    """Modes of every admitted strain."""
    if isinstance(modes, int):
        return (modes,) * strains
    return tuple(modes)
