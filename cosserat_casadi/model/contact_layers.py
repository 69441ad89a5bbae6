"""Obstacles with a width as loads on the rods that may not enter them, and the elements that resolve them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil, inf, isfinite, pi, sqrt
from typing import overload

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.contact_layer import ContactLayer
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.contact_pairs import LOOKED_AT, pair_widths
from cosserat_casadi.rod.placed_sections import SummedSections
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene.accuracy import MOST_SECTIONS

SURFACE_FORCE = 10.0
"""Force per length where the gap is zero, relative to EI/(L² width), of an obstacle without a stiffness in the scene.

A tip that meets the obstacle at a slope of 0.3 then presses with 8 EI/L² before its gap is zero, three times what
buckles the rod.
"""

ELEMENT_FACTOR = 3.0
"""Length of an element over √(L width), the stretch that is pressed where a rod of curvature 2/L touches a plane."""

MOST_ELEMENTS = 12
"""Elements that contact alone asks for: beyond them modes are the cheaper means."""

LOOSEST_NODES = 1.5
"""Distance of nodes in the middle of an element over half of the stretch that a thin obstacle presses: where they are
farther apart a rod sinks in between them, and its shape depends on where they are."""

USUAL_NODES = 12
"""Intervals of an element up to which a layer is summed at nodes: as many as five modes take."""

SECTION_SPACING = 0.5
"""Spacing of the sections at which a thinner layer is summed, over half of the stretch that it presses, on the fewest
intervals: a force (1 − s²)³ within this stretch, |s| ≤ 1, is summed to 4 thousandths by equal parts of it."""

COARSEST_SUM = 1.5e-3
"""Pose error with sections a quarter of the pressed stretch apart: it falls with the fourth power of their spacing."""

POINTS_A_PART = 3
"""Gauss points in each of the equal parts of an element: few, so that they are evenly spaced, and exact at its ends."""

SPARE_SECTIONS = 2
"""Factor on the number of sections where inputs or parameters may stretch a rod or make a layer thinner."""

LOOSEST_SECTIONS = 0.75
"""Spacing of sections over half of the stretch that a layer presses, up to which an error of their sum shows: where
they are farther apart, the stiffness that they give the layer depends on where they are."""

LOOSEST_POINTS = 1.0
"""Spacing of the Gauss points of a richer scene, in the middle of an element, over half of that stretch, up to which
an error shows: the nodes of the scene itself may lie three times as far apart."""

FEWEST_NODES = 8
"""Fewest intervals of an element: as many as three modes take. Sections are closer in proportion on more intervals."""

MOST_LAYER_NODES = 60
"""Most intervals that layers alone ask for; intervals for thinner layers wait until the grid is refined."""

NARROW = 0.2
"""Share of an element from an end that a load asks for within which contact asks for none."""

SHARE_OF_LAYER = 0.5
"""Displacement of a section that the error of a point on a path may make, over the width of the thinnest layer."""

SHARE_ON_BODY = 0.25
"""Share of the thickness of an obstacle on a body that a step may cross: rod and body both move towards its middle."""


def contact_layers(scene: scenes.Scene, rods: Mapping[str, DiscreteRod]) -> Iterator[ContactLayer]:
    """The push of each obstacle with a width on each rod, row of disks or body that may not enter it, as a load.

    Args:
        scene: the scene.
        rods: rods by name, with the numbers that scale the equations.
    """
    smooth = [obstacle for obstacle in scene.obstacles if obstacle.is_smooth]
    for obstacle in smooth:
        for name, rod in rods.items():
            if obstacle.concerns(name):
                stiffness = _stiffness(obstacle, rod)
                label = f"{obstacle.name} on {name}"
                yield ContactLayer.model_construct(name=label, obstacle=obstacle, stiffness=stiffness, rod=name)
        for row in scene.disks:
            if obstacle.concerns_disks(row.name):
                stiffness = _stiffness(obstacle, rods[row.rod])
                for number, at in enumerate(row.places):
                    yield ContactLayer.model_construct(
                        name=f"{obstacle.name} on {row.name}[{number}]",
                        obstacle=obstacle,
                        stiffness=stiffness,
                        rod=row.rod,
                        radius=row.radius,
                        thickness=row.thickness,
                        at=at,
                    )
        for body in scene.bodies:
            if obstacle.concerns_body(body.name):
                stiffness = _body_stiffness(obstacle, body, rods)
                yield ContactLayer.model_construct(
                    name=f"{obstacle.name} on {body.name}",
                    obstacle=obstacle,
                    stiffness=stiffness,
                    body=body.name,
                    radius=body.ball_radius,
                )


def _stiffness(obstacle: scenes.ObstacleRecord, rod: DiscreteRod) -> float:
    """Stiffness of an obstacle for a rod, N/m²."""
    if obstacle.stiffness is not None:
        return obstacle.stiffness
    assert obstacle.width is not None
    # The force per length is stiffness · width / 3 where the gap is zero.
    return 3 * SURFACE_FORCE * _bending_force(rod) / obstacle.width**2


def _body_stiffness(obstacle: scenes.ObstacleRecord, body: scenes.Body, rods: Mapping[str, DiscreteRod]) -> float:
    """Stiffness of an obstacle for a body, N/m: the scene's, or else that for a rod as long as the body is thick."""
    assert obstacle.width is not None
    if obstacle.stiffness is not None:
        return obstacle.stiffness * 2 * body.ball_radius
    return 3 * SURFACE_FORCE * max(map(_bending_force, rods.values())) / obstacle.width


def _bending_force(rod: DiscreteRod) -> float:
    """EI/L² of a rod, N."""
    return float(rod.energy_unit / rod.properties.length)


def layer_ends(scene: scenes.Scene, rod: scenes.Rod) -> list[float]:
    """Abscissae of element ends with which elements are about as long as the stretches that obstacles or rods press."""
    widths = [obstacle.width for obstacle in scene.obstacles if obstacle.width and obstacle.concerns(rod.name)]
    widths += pair_widths(scene, rod.name) if scene.rod_contacts else []
    if not widths:
        return []
    # The ratio may be beyond all range: it is bounded before it becomes a whole number.
    wanted = min(sqrt(rod.length / min(widths)) / ELEMENT_FACTOR, MOST_ELEMENTS)
    return list(map(float, np.linspace(0.0, 1.0, ceil(wanted) + 1)))


def longest_step(scene: scenes.Scene) -> float:
    """Largest turn of a rod in a step beside obstacles with a width, rad; infinite without any.

    Steps are checked as if sections moved along straight lines. If a rod turns by θ a section leaves its chord by θ²/8
    of the length at most: that may be half the thickness of the thinnest obstacle. An obstacle on a body moves too: in
    a step neither may move farther than :data:`SHARE_ON_BODY` of its thickness.
    """
    shortest = min((rod.length for rod in scene.rods), default=1.0)
    steps = [
        2 * sqrt(obstacle.thickness / shortest)
        if obstacle.body is None
        else 2 * SHARE_ON_BODY * obstacle.thickness / shortest
        for obstacle in scene.obstacles
        if obstacle.is_smooth
    ]
    return min(steps, default=inf)


def seeing_nodes(obstacle: scenes.ObstacleRecord, rod: RodProperties, widest: float) -> int:
    """Intervals of an element that resolve the push of a smooth obstacle summed at nodes; 0 if it is not summed there.

    Args:
        obstacle: the obstacle.
        rod: the rod.
        widest: length of its longest element, m.
    """
    radius = _least_radius(rod)
    at_nodes = _sections_a_node(obstacle, radius, widest) == 1
    return ceil(min(_nodes_for(obstacle, radius, widest), MOST_LAYER_NODES)) if at_nodes else 0


def seeing_sections(obstacle: scenes.ObstacleRecord, rod: RodProperties, widest: float, tolerance: float) -> int:
    """Number of sections of an element that sum a layer to a tolerance of poses; 0 if the obstacle has friction.

    Args:
        obstacle: the obstacle.
        rod: the rod.
        widest: length of its longest element, m.
        tolerance: distance over the length, or angle in rad.
    """
    if obstacle.rubs:
        return 0
    closer = min(float((tolerance / COARSEST_SUM) ** 0.25), 1.0)
    spacing = SECTION_SPACING * half_of_stretch(obstacle, rod) * closer
    return ceil(min(widest / spacing, MOST_SECTIONS))


def closer_sections(
    obstacle: scenes.ObstacleRecord, rod: DiscreteRod, *, moved: bool, stretched: bool
) -> SummedSections | None:
    """The sections of a rod at which the layer of an obstacle is summed; None if it is summed at the nodes.

    Args:
        obstacle: the obstacle.
        rod: with the scene's own numbers.
        moved: whether parameters move its elements: a short one may become long, and has as many sections as the
            longest.
        stretched: whether inputs or parameters change the layer's width, or the rod's length or radius: there are
            sections to spare.
    """
    lengths = rod.properties.length * np.diff(rod.grid.breaks)
    asked = rod.discretisation.sections
    if asked and not obstacle.rubs:
        return _parts_of_elements(rod, asked)
    ratio = _sections_a_node(obstacle, _least_radius(rod.properties), float(lengths.max()))
    if ratio == 1:
        return None
    shares = np.ones(len(lengths)) if moved else lengths / lengths.max()
    spare = SPARE_SECTIONS if stretched else 1
    counts = np.ceil(spare * ratio * rod.grid.intervals * shares).astype(int)
    return SummedSections(rod, tuple(counts.tolist()))


def _parts_of_elements(rod: DiscreteRod, sections: int) -> SummedSections:
    """Summed sections at Gauss points of equal parts of each element, no fewer than a number for each."""
    count = POINTS_A_PART * ceil(sections / POINTS_A_PART)
    return SummedSections(rod, (count,) * rod.grid.elements, POINTS_A_PART)


def points_for(obstacle: scenes.ObstacleRecord, rod: DiscreteRod) -> SummedSections:
    """Gauss points of each element, as many as intervals that see the layer of an obstacle: no fewer than the rod has.

    Args:
        obstacle: the obstacle.
        rod: with the scene's own numbers.
    """
    widest = float(rod.properties.length * np.diff(rod.grid.breaks).max())
    seeing = ceil(min(_nodes_for(obstacle, _least_radius(rod.properties), widest), MOST_LAYER_NODES))
    return SummedSections(rod, (max(seeing, rod.grid.intervals),) * rod.grid.elements, points=0)


def _sections_a_node(obstacle: scenes.ObstacleRecord, radius: float, widest: float) -> int:
    """Number of summed sections of a layer for each interval of the longest element; 1 if it is summed at the nodes.

    A layer with friction depends on rotations, and remembers its nodes: it is summed there.
    """
    if obstacle.rubs or _nodes_for(obstacle, radius, widest) <= USUAL_NODES:
        return 1
    return ceil(widest / (SECTION_SPACING * pressed(obstacle, radius)) / FEWEST_NODES)


def _nodes_for(obstacle: scenes.ObstacleRecord, radius: float, widest: float) -> float:
    """Intervals of the longest element whose nodes resolve a layer; 0 for an obstacle that fills a half-space.

    Chebyshev nodes are π/2 times as far apart in the middle of an element as on the average.
    """
    if not obstacle.width or not isfinite(obstacle.thickness):
        return 0.0
    return pi / 2 * widest / (LOOSEST_NODES * pressed(obstacle, radius))


def half_of_stretch(obstacle: scenes.ObstacleRecord, rod: RodProperties) -> float:
    """Half of the stretch of a rod that an obstacle presses, m; on a plane for a rod of curvature 2/L."""
    assert obstacle.width is not None, "it is smooth"
    if isfinite(obstacle.thickness):
        return pressed(obstacle, _least_radius(rod))
    return sqrt(obstacle.width * rod.length)


def _least_radius(rod: RodProperties) -> float:
    """Radius of the thinnest section of a rod, m."""
    return float(section_radius(rod, LOOKED_AT).min())


def share_of_more_modes(modes: int, added: int, element: float, half: float) -> float:
    """Change by modes beyond added ones, over the change by the added ones, where a layer presses a part of an element.

    Few modes cannot tell the push from a point force: the bending moment has a kink there, and with n modes the work of
    the force lacks a part in proportion to n⁻³. Modes as short as the pressed stretch resolve it, and later modes add
    next to nothing.

    Args:
        modes: number of modes of the answer.
        added: number of modes that the answer lacks, with a known change.
        element: length of the element, m.
        half: half of the pressed stretch, m.
    """
    richer = float(modes + added)
    own, left, unseen = (float(count) ** -3 for count in (modes, richer, max(pi / 2 * element / half, richer)))
    return (left - unseen) / (own - left)


@overload
def pressed(obstacle: scenes.ObstacleRecord, radius: float) -> float: ...
@overload
def pressed(obstacle: scenes.ObstacleRecord, radius: Matrix) -> Matrix: ...
def pressed(obstacle: scenes.ObstacleRecord, radius: float | Matrix) -> float | Matrix:
    """Half of the stretch of a straight rod that a thin obstacle presses, m.

    With a distance d of their axes and a width w, the rod is in the layer for √(2 w d) to both sides.

    Args:
        obstacle: the obstacle.
        radius: radius of the rod, m.
    """
    assert obstacle.width is not None, "it is smooth"
    return (2 * obstacle.width * (obstacle.thickness / 2 + radius)) ** 0.5


def inexact_beside(scene: scenes.Scene) -> float:
    """Error of the unknowns (2-norm) that a path may leave beside thin smooth obstacles; infinite without any.

    An error ε of a strain moves a section by about ε L. If that is more than the width of a layer, a point may lie so
    deep in it, or so far above it, that its tangent leads elsewhere, and the path stalls.
    """
    longest = max((rod.length for rod in scene.rods), default=1.0)
    widths = [obstacle.width for obstacle in scene.obstacles if obstacle.width and isfinite(obstacle.thickness)]
    return SHARE_OF_LAYER * min(widths, default=inf) / longest


def joined_ends(asked_for: tuple[float, ...], further: list[float]) -> tuple[float, ...]:
    """Element ends that loads ask for, and the ends that contact asks for with no end of a load nearby."""
    if not further:
        return asked_for
    nearest = NARROW / (len(further) - 1)
    apart = [end for end in further if min(abs(end - own) for own in asked_for) > nearest]
    return tuple(sorted([*asked_for, *apart]))
