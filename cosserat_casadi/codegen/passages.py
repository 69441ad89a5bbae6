"""Words in the templates of checks for rods that pass through thin obstacles in a step: smooth_passage.py in C."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.codegen.block_sources import Words
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import given_size, with_parameters_behind_inputs
from cosserat_casadi.compiling.c_tables import numbers, reals, record, record_table
from cosserat_casadi.compiling.texts import render
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_from
from cosserat_casadi.equilibrium.contact.passing_through import admitted_depth
from cosserat_casadi.equilibrium.smooth_passage import ball_in, depth_allowed, length_of, quaternions_of
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.loads.obstacle_load import section_radii
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.numbers import Scalar, any_symbolic, entries, least
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_depth import thin_layers
from cosserat_casadi.model.contact_pairs import ContactPair, thickness
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.model.system import Arguments, ratio_of
from cosserat_casadi.model.thin import first_places, moved_by

PASSAGE_FILES = ("interpolation.c", "passages.c")
"""Files of the folder ``c`` of a library with these checks."""

ANY_SHARE = -1.0
"""Distance in abscissae that is less than that of any two sections."""

RADII = 65
"""Number of sections at which the radius of a rod is listed, if it is not linear from base to tip."""


def watches_passages(model: Model) -> bool:
    """Whether the scene has thin obstacles that rods, disks or bodies could pass through."""
    return bool(thin_layers(model.discrete) or model.discrete.pairs)


def distance_kernel(obstacle: scenes.ObstacleRecord, name: str) -> ca.Function:
    """Point ↦ distance from an obstacle."""
    point = ca.SX.sym("point", 3)
    return ca.Function(name, [point], [ca.densify(distance_from(obstacle)(point))])


def passage_kernels(model: Model, names: Names) -> list[ca.Function]:
    """Make the distances from thin obstacles."""
    if not watches_passages(model):
        return []
    distances = [distance_kernel(own, _kernel(names, i)) for i, own in enumerate(_thin(model.at().discrete))]
    symbols = [ca.MX.sym("inputs", model.inputs.size), model.parameters.symbol]
    sizes = _sizes(model, symbols[0])
    if not any_symbolic(sizes):
        return distances
    name = names.kernel("sizes")
    function = ca.Function(name, symbols, [ca.densify(ca.vertcat(*sizes))], ["inputs", PARAMETERS], ["sizes"])
    return [*distances, with_parameters_behind_inputs(function).expand(name)]


def passage_words(model: Model, names: Names) -> Words:
    """Words of a library on the obstacles and rods that it checks.

    Args:
        model: the exported model.
        names: names of the library.
    """
    if not watches_passages(model):
        return {"place_reals": 0}
    discrete = model.at().discrete
    sizes = _sizes(model, ca.MX.sym("inputs", model.inputs.size))
    are_free = any_symbolic(sizes)
    count = first_places(discrete)[1][-1]
    quaternions = quaternions_of(model)
    words: Words = {
        "name": names.name,
        "quaternions": len(quaternions),
        "quaternion_places": numbers(quaternions) or "0",
        "barriers": len(thin_layers(discrete)),
        "rod_pairs": len(discrete.pairs),
        "barrier_tables": "\n".join([*_barrier_lines(discrete, names), *_pair_lines(discrete)]),
        "free_sizes": len(sizes) if are_free else 0,
        "sizes": "" if are_free else reals("KNOWN_SIZES", np.array(sizes)),
    }
    return {
        "passages": render("passages.c.in", words),
        "places": count,
        "free_sizes": words["free_sizes"],
        "place_reals": 9 * count + words["free_sizes"] + model.size + 2 * max(given_size(model), 1),
    }


def _sizes(model: Model, inputs: ca.MX) -> list[Scalar]:
    """Sizes of all barriers and pairs in passages.c.in, as expressions if they depend on an argument."""
    known_discrete, discrete = model.at().discrete, model.discrete
    sizes: list[Scalar] = []
    for own, layer in zip(thin_layers(known_discrete), thin_layers(discrete), strict=True):
        length = length_of(discrete, layer)
        radii: list[Scalar] = [ball_in(layer)] * 2
        if _is_rod(layer):
            places = np.linspace(0.0, 1.0, 1 + _parts(known_discrete, own))
            radii = entries(section_radii(discrete.rods[str(layer.rod)].properties, places))
        deepest = depth_allowed(layer.obstacle, length)
        sizes += [admitted_depth(layer.obstacle, length, deepest, least(radii)), *radii]
    for pair in discrete.pairs:
        # Half of their thickness, as between axes of rods that pass.
        sizes += [thickness(discrete.rods, pair) / 2, _share_apart(discrete, pair, inputs)]
    return sizes


def _share_apart(discrete: DiscreteScene, pair: ContactPair, inputs: ca.MX) -> Scalar:
    """Least distance in abscissae between the two sections of a pair."""
    if not pair.itself:
        return ANY_SHARE
    (name, _) = pair.rods
    ratio = ratio_of(discrete, name, Arguments(ca.DM(0, 1), inputs))
    share = pair.apart / discrete.rods[name].properties.length
    return share if ratio is None else share / ratio


def _is_rod(layer: ContactLayer) -> bool:
    return layer.body is None and layer.at is None


def _thin(discrete: DiscreteScene) -> list[scenes.ObstacleRecord]:
    """Thin obstacles that something may pass through."""
    concerned = {layer.obstacle.name for layer in thin_layers(discrete)}
    return [obstacle for obstacle in discrete.scene.obstacles if obstacle.name in concerned]


def _kernel(names: Names, number: int) -> str:
    """Name of the kernel of the distance from a thin obstacle."""
    return names.kernel(f"distance_{number}")


def _barrier_lines(discrete: DiscreteScene, names: Names) -> Iterator[str]:
    """Write the tables of rods, disks and bodies that may not pass through an obstacle."""
    layers = thin_layers(discrete)
    if not layers:
        return
    obstacles = [obstacle.name for obstacle in _thin(discrete)]
    for number in range(len(obstacles)):
        yield render("distance.c.in", {"number": number, "kernel": _kernel(names, number)})
    rods = dict.fromkeys(layer.rod for layer in layers if _is_rod(layer))
    for number, rod in enumerate(rods):
        yield from _node_lines(discrete, str(rod), number)
    first, _ = first_places(discrete)
    records = []
    size = 0
    for layer in layers:
        parts = _parts(discrete, layer)
        fields = {
            "rod": f"&NODES_{list(rods).index(layer.rod)}" if _is_rod(layer) else "0",
            "first": first[moved_by(discrete, layer)],
            "sizes": size,
            "length": f"(real){float(length_of(discrete, layer))!r}",
            "parts": parts,
            "distance": f"distance_from_{obstacles.index(layer.obstacle.name)}",
        }
        records.append(record(fields))
        # The depth, and a radius more than there are parts.
        size += 2 + parts
    yield record_table("barrier", "BARRIER", "BARRIERS", records)


def _parts(discrete: DiscreteScene, layer: ContactLayer) -> int:
    """Number of equal parts of a rod with linear radius; 1 for a ball."""
    if not _is_rod(layer):
        return 1
    places = np.linspace(0.0, 1.0, RADII)
    radii = section_radius(discrete.rods[str(layer.rod)].properties, places)
    is_linear = np.allclose(radii, radii[0] + places * (radii[-1] - radii[0]), rtol=1e-9, atol=0.0)
    return 1 if is_linear else RADII - 1


def _node_lines(discrete: DiscreteScene, rod: str, number: int) -> Iterator[str]:
    """Write the nodes of a rod."""
    grid = discrete.rods[rod].grid
    yield reals(f"NODE_ENDS_{number}", np.array(grid.breaks))
    yield reals(f"LOCAL_NODES_{number}", chebyshev.nodes(grid.intervals))
    yield reals(f"BARYCENTRIC_{number}", chebyshev.barycentric_weights(grid.intervals))
    fields = {
        "elements": grid.elements,
        "nodes": grid.intervals + 1,
        "ends": f"NODE_ENDS_{number}",
        "local_nodes": f"LOCAL_NODES_{number}",
        "barycentric": f"BARYCENTRIC_{number}",
    }
    yield f"static const rod_nodes NODES_{number} = {record(fields)};"


def _pair_lines(discrete: DiscreteScene) -> Iterator[str]:
    """Write the table of rods that push each other."""
    if not discrete.pairs:
        return
    _, first = first_places(discrete)
    records = []
    # Sizes of barriers stand before.
    size = sum(2 + _parts(discrete, layer) for layer in thin_layers(discrete))
    for number, pair in enumerate(discrete.pairs):
        fields = {
            "first": f"{{{first[2 * number]}, {first[2 * number + 1]}}}",
            "counts": f"{{{pair.sections[0]}, {pair.sections[1]}}}",
            "sizes": size + 2 * number,
        }
        records.append(record(fields))
    yield record_table("rod_pair", "ROD_PAIR", "ROD_PAIRS", records)
