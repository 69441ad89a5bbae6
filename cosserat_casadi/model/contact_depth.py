"""How deep rods and bodies are inside obstacles that have a width, and rods inside each other."""

from __future__ import annotations

from math import isfinite

import casadi as ca
import numpy as np

from cosserat_casadi.loads.contact_layer import ContactLayer, push_on_disk
from cosserat_casadi.loads.obstacle_load import section_radii
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.contact_layers import LOOSEST_NODES, LOOSEST_POINTS, LOOSEST_SECTIONS, pressed
from cosserat_casadi.model.contact_pairs import LOOSEST_SPACING, half_of_stretch
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.pair_terms import PairTerms
from cosserat_casadi.model.system import System
from cosserat_casadi.obstacles.registry import SURFACES


def contact_depths(system: System) -> list[Matrix]:
    """Depth of each rod at its deepest section, and of each disk and body, relative to the width, 1×1 each.

    Depths are negative outside of an obstacle; the list is empty without smooth contact.
    """
    of_obstacles = [_depth(system, load) for load in system.discrete.loads if isinstance(load, ContactLayer)]
    return [*of_obstacles, *(terms.section_pairs.depth for terms in system.pairs)]


def thin_layers(discrete: DiscreteScene) -> list[ContactLayer]:
    """Layers of smooth obstacles of finite thickness, which a rod could pass through."""
    layers = [load for load in discrete.loads if isinstance(load, ContactLayer)]
    return [layer for layer in layers if isfinite(layer.obstacle.thickness)]


def sections_lie_apart(system: System) -> Matrix | None:
    """Whether the sections at which the push of thin layers, or of rods, is summed lie too far apart.

    Inputs or parameters may draw sections apart. Nodes at which a layer with friction is summed may lie too far apart
    from the start, and no finer sum shows the error.

    Returns:
        1 if some lie too far apart, else 0, 1×1; None if none can.
    """
    discrete = system.discrete
    apart = []
    for layer in thin_layers(discrete):
        if layer.rod is None or layer.at is not None:
            continue
        is_drawn = layer.name in discrete.stretched_layers or discrete.draws_apart(layer.rod)
        if is_drawn or layer.name not in discrete.finer_sections:
            lies_apart = _layer_lies_apart(system, layer)
            if is_drawn or bool(ca.evalf(lies_apart)):
                apart.append(lies_apart)
    apart += [_pair_lies_apart(terms) for terms in system.pairs if any(map(discrete.draws_apart, terms.pair.rods))]
    return ca.mmax(ca.vertcat(*apart)) if apart else None


def _layer_lies_apart(system: System, layer: ContactLayer) -> Matrix:
    """Whether sections at which a layer is summed are too far apart to show the error of the sum, 1×1."""
    assert layer.rod is not None, "it presses a rod"
    rod = system.discrete.rods[layer.rod]
    closer, finer = (own.get(layer.name) for own in (system.discrete.closer_sections, system.discrete.finer_sections))
    sections = closer or finer
    if sections is None:
        # A layer with friction is summed at nodes alone.
        X, lengths, loosest = rod.grid.nodes_at(np.arange(rod.grid.size)), rod.node_lengths, LOOSEST_NODES
    else:
        # If the scene sums the layer at nodes, the points of the richer scene show the error.
        X, lengths = sections.placed.X, sections.lengths
        loosest = LOOSEST_SECTIONS if closer else LOOSEST_POINTS
    radius = ca.mmin(as_matrix(section_radii(rod.properties, X)))
    longest = ca.mmax(as_matrix(lengths)) * system.length(layer.rod) / rod.length
    return ca.MX(longest > loosest * pressed(layer.obstacle, radius))


def _pair_lies_apart(terms: PairTerms) -> Matrix:
    """Whether sections of rods that push each other are too far apart to show the error of their sum, 1×1."""
    spacings = [ca.mmax(side.sections.data[0, :]) for side in terms.sides]
    widest = ca.mmax(ca.vertcat(*spacings))
    least_radii = [ca.mmin(side.sections.data[1, :]) for side in (terms.sides[0], terms.sides[-1])]
    half = half_of_stretch(least_radii[0] + least_radii[1], terms.pair.width)
    return ca.MX(widest > LOOSEST_SPACING * half)


def _depth(system: System, layer: ContactLayer) -> Matrix:
    if layer.at is not None:
        assert layer.rod is not None, "a disk is on a rod"
        shape = system.shapes[layer.rod]
        rotation = system.base(layer.rod).rotation @ shape.rotation_at(shape.rod.grid.node_at(layer.at))
        size = ca.vertcat(layer.radius, layer.thickness)
        gap, _ = push_on_disk(layer)(positions_before(system, layer), rotation, size)
        of_disk: Matrix = -ca.MX(gap) / layer.obstacle.width
        return of_disk
    radii: Matrix | float = layer.radius
    closer = None
    if layer.body is None:
        assert layer.rod is not None, "a layer is in front of a rod or a body"
        rod = system.discrete.rods[layer.rod]
        closer = system.discrete.closer_sections.get(layer.name)
        X = rod.grid.nodes_at(np.arange(rod.grid.size)) if closer is None else closer.placed.X
        radii = as_matrix(section_radii(rod.properties, X)).T
    point = ca.SX.sym("point", 3)
    distance = ca.SX(SURFACES[layer.obstacle.kind].distance(layer.obstacle, point))
    function = ca.Function("distance", [point], ca.cse([distance]))
    positions = positions_before(system, layer)
    if closer is not None:
        positions = closer.at_sections(positions)
    gaps = function.map(positions.shape[1])(positions) - radii
    depth: Matrix = -ca.mmin(gaps) / layer.obstacle.width
    return depth


def positions_before(system: System, layer: ContactLayer) -> Matrix:
    """Positions of a rod's nodes, 3×M, a disk or a body, 3×1, that a layer pushes, in the axes of its obstacle, m."""
    if layer.body is not None:
        return system.frame(FrameName("body", layer.body)).position
    assert layer.rod is not None, "a layer is in front of a rod or a body"
    positions = system.seen_from(layer.obstacle.body, system.nodes(layer.rod))
    if layer.at is None:
        return positions
    return positions[:, system.shapes[layer.rod].rod.grid.node_at(layer.at)]
