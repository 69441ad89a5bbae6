"""Pairs of rods that may not enter each other: the law of their push, and the sections over which it is summed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import ceil
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.loads.obstacle_load import section_radii
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import Scalar, entries, known, largest, least
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene.rod_contact_record import RodContact, are_tied

WIDTH_OF_RADIUS = 0.2
"""Width relative to the smallest radius of both rods, of a contact without a width."""

SURFACE_STIFFNESS = 30.0
"""Stiffness relative to EI/(L² width²) of the stiffer rod, of a contact without a stiffness."""

SPACING = 0.25
"""Spacing of sections, relative to half the stretch of a rod that a section of the other touches at zero gap."""

LOOSEST_SPACING = 1.0
"""Spacing of sections that inputs or parameters have drawn apart, relative to half of that stretch, up to which the
error of their sum shows."""

FROM_ITSELF = 2.0
"""Distance along a rod, relative to its diameter and the width, below which its sections do not touch.

A rod bent to a circle with a radius above 0.53 times diameter plus width keeps such sections farther apart than these.
"""

ANYWHERE = 1e100
"""A distance along a rod, m, that no two sections have."""

MOST_SECTIONS = 2000
"""Sections of a rod beyond which a contact is refused."""

LOOKED_AT = np.linspace(0.0, 1.0, 201)
"""Abscissae whose radii are looked at."""


POSE = 12
"""Numbers of a pose at a node: position, m, and rotation matrix, column after column."""


@dataclass(frozen=True)
class ContactPair:
    """Two rods that push each other, or one that pushes itself.

    Attributes:
        name: name of the contact, for messages.
        rods: names of both rods; one name twice for a rod that touches itself.
        width: gap below which the rods push, m.
        stiffness: rate of the force per length with the gap where parallel rods touch, N/m².
        apart: least distance along the rod from the first section to the second, m; far below zero for two rods. It may
            be an expression of parameters.
        sections: number of sections of each rod.
        friction: coefficient of friction.
        slip_speed: speed below which sticking sections creep, m/s.
        padding: length that is added to the radius of each section, m. The law takes no width far above the radii.
    """

    name: str
    rods: tuple[str, str]
    width: float
    stiffness: float
    apart: Scalar
    sections: tuple[int, int]
    friction: float
    slip_speed: float
    padding: float = 0.0

    def widened(self, ratio: float) -> ContactPair:
        """The pair with its width times a ratio; it pushes about as hard at zero gap."""
        return self if ratio == 1.0 else replace(self, width=ratio * self.width, stiffness=self.stiffness / ratio)

    def finer(self, factor: int) -> ContactPair:
        """The pair with its numbers of sections times a factor."""
        first, second = self.sections
        return replace(self, sections=(factor * first, factor * second))

    @property
    def itself(self) -> bool:
        """Whether a rod touches itself."""
        return self.rods[0] == self.rods[1]

    @property
    def slip_way(self) -> float:
        """Drag of sections that slip along a path, m.

        Up to this drag a surface as deep as the layer of sections that touch, w/3, is as stiff along as across.
        """
        return self.friction * self.width / 3

    def meets(self, first: FloatArray, second: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether sections at these distances along both rods, m, may touch each other, shape (first, second)."""
        return second - first[:, None] >= float(self.apart)

    @property
    def law(self) -> Matrix:
        """Numbers of the law, as loads/rod_contact.py takes them."""
        return ca.vertcat(self.width, self.stiffness, self.apart, self.friction, self.slip_speed)


def named_pairs(scene: scenes.Scene) -> Iterator[tuple[RodContact, tuple[str, str]]]:
    """Contacts of a scene with the rods of each pair; a pair named by several contacts belongs to the first of them."""
    ties: list[tuple[Any, Any]] = [(rod.name, rod.base.rod) for rod in scene.rods if rod.base.rod is not None]
    for joint in scene.joints:
        ends = [("body", place.body) for place in joint.places] + ([joint.rod] if joint.rod else [])
        ties += [(ends[0], end) for end in ends[1:]]
    taken = set()
    # A table that names its rods goes before one that stands for all.
    for contact in sorted(scene.rod_contacts, key=lambda record: record.rods is None):
        if contact.rods is None:
            every = combinations([rod.name for rod in scene.rods], 2)
            pairs = [(one, other) for one, other in every if not are_tied(one, other, ties)]
        else:
            pairs = [(contact.rods[0], contact.rods[-1])]
        for pair in pairs:
            if frozenset(pair) not in taken:
                taken.add(frozenset(pair))
                yield contact, pair


def contact_pairs(
    scene: scenes.Scene, nominal: Mapping[str, DiscreteRod], rods: Mapping[str, DiscreteRod]
) -> Iterator[ContactPair]:
    """The pairs of a scene.

    Args:
        scene: the scene.
        nominal: rods of the scene with the numbers that scale the equations.
        rods: the same on the grids that are asked for.

    Raises:
        SceneError: a contact would take too many sections.
    """
    for contact, pair in named_pairs(scene):
        if contact.exact:
            continue
        radii = [section_radius(nominal[name].properties, LOOKED_AT) for name in pair]
        width = _width(contact, radii)
        stiffness = contact.stiffness
        if stiffness is None:
            bending = max(nominal[name].energy_unit / nominal[name].properties.length for name in pair)
            stiffness = SURFACE_STIFFNESS * bending / width**2
        thinnest = float(radii[0].min() + radii[1].min())
        thickest = largest(entries(section_radii(rods[pair[0]].properties, LOOKED_AT)))
        itself = pair[0] == pair[1]
        # Cushions of thin rods are wider than the rods are thick: rods with padding push each other as far apart.
        padding = max(width - thinnest, 0.0) / 4
        width -= 2 * padding
        spacing = SPACING * float(half_of_stretch(thinnest + 2 * padding, width))
        name = contact.label if contact.rods is not None else f"{contact.name or 'contact'} of {pair[0]} and {pair[1]}"
        yield ContactPair(
            name=name,
            rods=pair,
            width=width,
            stiffness=stiffness,
            apart=FROM_ITSELF * (2 * thickest + width) if itself else -ANYWHERE,
            sections=(_sections(name, rods[pair[0]], spacing), _sections(name, rods[pair[1]], spacing)),
            friction=contact.friction,
            slip_speed=contact.slip_speed,
            padding=padding,
        )


def section_places(rod: DiscreteRod, count: int) -> tuple[FloatArray, FloatArray]:
    """Abscissae of the sections of a rod whose elements end at known places, and the share that each stands for."""
    coordinates = (np.arange(count) + 0.5) / count
    # Sections stay in their elements, as the sections of the equations do.
    elements = replace(rod.grid, ends=None).element_of(coordinates)
    rates = rod.grid.rates_in(elements)
    shares = np.full(count, 1.0 / count)
    return known(rod.grid.on_rod(coordinates, elements)), shares if rates is None else shares * known(rates)


def thickness(rods: Mapping[str, DiscreteRod], pair: ContactPair) -> Scalar:
    """Distance of the centres of sections that touch, where it is least, m."""
    first, second = (least(entries(section_radii(rods[name].properties, LOOKED_AT))) for name in pair.rods)
    return first + second


def half_of_stretch(touching: Scalar, width: Scalar) -> Scalar:
    """Half the stretch of a rod that a section of another touches where they cross without a gap, m.

    Args:
        touching: distance of their centres, m.
        width: width of the contact, m.
    """
    return ((touching + width) ** 2 - touching**2) ** 0.5


def pair_widths(scene: scenes.Scene, rod: str) -> list[float]:
    """Widths of the contacts of a rod, m."""
    records = {record.name: record for record in scene.rods}
    pairs = [(contact, pair) for contact, pair in named_pairs(scene) if rod in pair and not contact.exact]
    return [
        _width(contact, [section_radius(rod_properties(records[name]), LOOKED_AT) for name in pair])
        for contact, pair in pairs
    ]


def _width(contact: RodContact, radii: Sequence[FloatArray]) -> float:
    """Width of a contact of rods with these radii, m."""
    if contact.width is not None:
        return contact.width
    return WIDTH_OF_RADIUS * min(float(own.min()) for own in radii)


def _sections(name: str, rod: DiscreteRod, spacing: float) -> int:
    """Number of sections at this spacing; another grid places them elsewhere, so that the error of their sum shows."""
    wanted = rod.properties.length / spacing
    if wanted > MOST_SECTIONS:
        problem = f"the contact {name!r} takes {wanted:.0f} sections of {rod.properties.name!r}, above {MOST_SECTIONS}"
        raise SceneError(Problem("rod_contacts", problem, "give it more width, or leave thin and long rods out"))
    intervals = len(rod.grid.left_ends)
    return ceil(wanted + intervals)


@dataclass(frozen=True)
class PairHistory:
    """The history of friction of a pair: poses and drags of sections at the last point of a path.

    The slip of two sections past each other is the displacement of the touching points since the last point of the path
    plus the drag of the first rod's section at that point. So a section that comes to touch another one keeps its drag.

    Attributes:
        drag: drag of the sections of the first rod, 3×k, m, world axes.
        poses: poses of each rod at the nodes of its grid, POSE×M, world axes; zeros before there is a history.
    """

    drag: Matrix
    poses: Mapping[str, Matrix]

    @classmethod
    def of_column(cls, column: Matrix, pair: ContactPair, grids: Mapping[str, Grid]) -> PairHistory:
        """The history from an input; its sections need not be the sections that the pair has now.

        Args:
            column: the input, h×1.
            pair: the pair.
            grids: grids of the rods when the history was remembered.
        """
        poses = {}
        for name in dict.fromkeys(pair.rods):
            count = POSE * grids[name].size
            poses[name] = ca.reshape(column[:count], POSE, grids[name].size)
            column = column[count:]
        return cls(ca.reshape(column, 3, column.shape[0] // 3), poses)

    @property
    def column(self) -> Matrix:
        """The history as an input holds it, h×1."""
        return ca.vertcat(*[ca.vec(poses) for poses in self.poses.values()], ca.vec(self.drag))

    @property
    def is_known(self) -> Matrix:
        """1 where there is a history, 0 before there is one, when rotations are zeros; 1×1."""
        return ca.sumsqr(next(iter(self.poses.values()))[3:, 0]) / 3

    def drag_at(self, coordinates: FloatArray) -> Matrix:
        """Drag at sections at these coordinates from 0 to 1, 3×S."""
        count = self.drag.shape[1]
        chosen = np.minimum((coordinates * count).astype(int), count - 1)
        return self.drag[:, chosen.tolist()]


def history_size(pair: ContactPair, grids: Mapping[str, Grid]) -> int:
    """Count of numbers that friction of a pair remembers for rods on these grids."""
    return 3 * pair.sections[0] + POSE * sum(grids[name].size for name in set(pair.rods))
