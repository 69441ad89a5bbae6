"""Thin smooth obstacles and rods in contact, and positions of the points that must not pass through them."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.contact_depth import positions_before, thin_layers
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.system import System

Moved = tuple[str | None, str | None, int | None, str | None]
"""Names of the rod or the body that moves, the node of a disk on the rod, and the body in whose axes positions are."""


def moved_by(discrete: DiscreteScene, layer: ContactLayer) -> Moved:
    """The rod, disk or body that a layer pushes, relative to its obstacle; layers that share it share positions."""
    node = None
    if layer.at is not None:
        assert layer.rod is not None, "a disk is on a rod"
        node = discrete.rods[layer.rod].grid.node_at(layer.at)
    return layer.rod, layer.body, node, layer.obstacle.body


def first_places(discrete: DiscreteScene) -> tuple[dict[Moved, int], list[int]]:
    """Column of the first position of each rod, disk or body at layers, and of each rod of a pair of rods.

    Returns:
        the columns by rod, disk or body; the columns of the rods of pairs, followed by the number of all columns.
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
    """Positions of points that could pass thin obstacles or rods, 3×…, m: nodes, disks, bodies, then sections of pairs.

    None without thin obstacles and pairs. Positions at obstacles are in the axes of the obstacles, positions of
    sections of pairs in world axes.
    """
    discrete = system.discrete
    before = {moved_by(discrete, layer): layer for layer in thin_layers(discrete)}
    positions = [positions_before(system, layer) for layer in before.values()]
    positions += [side.at_sections for terms in system.pairs for side in (terms.sides[0], terms.sides[-1])]
    return ca.horzcat(*positions) if positions else None
