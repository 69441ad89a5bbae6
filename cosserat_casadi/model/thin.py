"""Thin smooth obstacles and rods that touch rods, and the places of what may not come out on their other side."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.contact_depth import positions_before, thin_layers
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.system import System

Moved = tuple[str | None, str | None, int | None, str | None]
"""Names of the rod or the body that moves, the node of a disk on the rod, and the body whose axes places are in."""


def moved_by(discrete: DiscreteScene, layer: ContactLayer) -> Moved:
    """The rod, disk or body before a layer, as its obstacle sees it: layers with the same one have the same places."""
    node = None
    if layer.at is not None:
        assert layer.rod is not None, "a disk is on a rod"
        node = discrete.rods[layer.rod].grid.node_at(layer.at)
    return layer.rod, layer.body, node, layer.obstacle.body


def first_places(discrete: DiscreteScene) -> tuple[dict[Moved, int], list[int]]:
    """Numbers of the first places of rods, disks and bodies before layers, and of the first sections of rods of pairs.

    Returns:
        the numbers by rod, disk or body; the numbers of the sections, behind which the number of all places stands.
    """
    first = dict[Moved, int]()
    count = 0
    for layer in thin_layers(discrete):
        moved = moved_by(discrete, layer)
        if moved not in first:
            first[moved] = count
            is_rod = layer.body is None and layer.at is None
            count += discrete.rods[layer.rod or ""].grid.size if is_rod else 1
    sections = [number for pair in discrete.pairs for number in pair.sections]
    return first, [count + sum(sections[:k]) for k in range(len(sections) + 1)]


def places(system: System) -> Matrix | None:
    """Positions of what may pass through something thin, 3×…, m: of nodes, disks and bodies, then of sections of pairs.

    None where there is nothing thin. Positions before obstacles are in the axes of the obstacles, positions of sections
    of pairs in world axes.
    """
    discrete = system.discrete
    before = {moved_by(discrete, layer): layer for layer in thin_layers(discrete)}
    positions = [positions_before(system, layer) for layer in before.values()]
    positions += [side.at_sections for terms in system.pairs for side in (terms.sides[0], terms.sides[-1])]
    return ca.horzcat(*positions) if positions else None
