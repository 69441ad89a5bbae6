"""A rod as a chain of rigid links, by the midpoint rule.

Nodes cut the rod into pieces; a link belongs to each node and reaches to the middles of the two pieces that meet there.
The joint in the middle of a piece has the strain of the piece, and its stiffness: H/h, h its length. A strain that is a
field becomes its value in the middle of each piece, so that shapes and frequencies are off by h².
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.pose import NumericPose
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.floating_frames import UnloadedScene
from cosserat_casadi.model.scene_rods import fixed_masses
from cosserat_casadi.model.sections import half_widths_along
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.properties import RodProperties

THIN = 2e-3
"""Radius over length at which rods without a section are drawn."""

MASS_POINTS = 3
"""Points of the quadrature by which the mass of half a piece is added up."""


@dataclass(frozen=True)
class Inertia:
    """Mass of a rigid link.

    Attributes:
        mass: kg.
        centre: centre of mass in the axes of the link, shape (3,), m.
        moments: inertia about the centre in the axes of the link, shape (3, 3), kg m².
    """

    mass: float
    centre: FloatArray
    moments: FloatArray


@dataclass(frozen=True)
class RodPiece:
    """The piece of a rod between two nodes; a joint in its middle has its strains.

    Attributes:
        middle: pose of the section in its middle, world axes, unloaded.
        length: m.
        stiffness: stiffness of the joint by strain, shape (6,), N m/rad and N/m.
        damping: damping of the joint by strain, shape (6,), N m s/rad and N s/m.
    """

    middle: NumericPose
    length: float
    stiffness: FloatArray
    damping: FloatArray


@dataclass(frozen=True)
class Link:
    """A rigid link of a rod.

    Attributes:
        at: abscissa X of its node.
        frame: pose of the section there, world axes, unloaded: the axes of the link.
        piece: the piece from the node before; None of the first link.
        ends: where the link begins and ends, in its axes, shape (2, 3), m.
        half_widths: of its section along x and y, m; both the radius of a round one.
        inertia: of the rod and of the disks at the node.
    """

    at: float
    frame: NumericPose
    piece: RodPiece | None
    ends: FloatArray
    half_widths: tuple[float, float]
    inertia: Inertia


def nodes_along(ends: Sequence[float], links: int) -> FloatArray:
    """Abscissae of nodes: the ends of all elements, and between them about as many pieces a rod as asked for."""
    nodes = [0.0]
    for start, end in pairwise(ends):
        count = max(1, round(links * (end - start)))
        nodes += np.linspace(start, end, count + 1)[1:].tolist()
    return np.array(nodes)


def links_of(unloaded: UnloadedScene, rod: scenes.Rod, nodes: FloatArray) -> list[Link]:
    """Links of a rod, base to tip.

    Args:
        unloaded: the unloaded scene, with the grid of the rod.
        rod: the rod.
        nodes: abscissae of the links, ascending from 0 to 1, shape (k,).

    Raises:
        SceneError: the rod has no mass.
    """
    properties = unloaded.rods[rod.name].properties
    if properties.linear_density is None:
        problem = "has no mass, without which MuJoCo moves nothing"
        raise SceneError(Problem(f"rods.{rod.name}", problem, "give its material a density, or the rod linear_density"))
    middles = (nodes[1:] + nodes[:-1]) / 2
    bounds = np.concatenate([[0.0], middles, [1.0]])
    frames = poses_along(unloaded, rod.name, nodes)
    in_middles = poses_along(unloaded, rod.name, middles)
    at_bounds = poses_along(unloaded, rod.name, bounds)
    lengths = rod.length * np.diff(nodes)
    stiffness = known(properties.hooke(middles)) / lengths[:, None]
    damping = np.zeros_like(stiffness)
    if properties.damping is not None:
        damping = known(properties.damping(middles)) / lengths[:, None]
    pieces = [None, *map(RodPiece, in_middles, lengths.tolist(), stiffness, damping)]
    widths = _half_widths(rod, nodes)
    disks = fixed_masses(unloaded.scene, rod.name)
    links = []
    for k, (at, frame) in enumerate(zip(nodes.tolist(), frames, strict=True)):
        lumps = _lumps(unloaded, properties, np.array([bounds[k], at, bounds[k + 1]]))
        for disk in disks:
            if disk.at == at:
                moments = np.diag([float(disk.across + disk.along)] * 2 + [2.0 * float(disk.across)])
                lumps.append((float(disk.mass), frame, moments))
        ends = np.array([_seen(frame, at_bounds[k + i]).position for i in range(2)])
        links.append(Link(at, frame, pieces[k], ends, widths[k], _together(frame, lumps)))
    return links


def _half_widths(rod: scenes.Rod, nodes: FloatArray) -> list[tuple[float, float]]:
    """Half widths of the sections at the nodes, m; a rod without a section is drawn as a thin round one."""
    widths = half_widths_along(rod.section, nodes)
    if widths is None:
        return [(THIN * rod.length, THIN * rod.length)] * len(nodes)
    return list(zip(*(width.tolist() for width in widths), strict=True))


Lump = tuple[float, NumericPose, FloatArray]
"""Mass, pose in world axes, and moments of inertia in the axes of the pose."""


def _lumps(unloaded: UnloadedScene, properties: RodProperties, bounds: FloatArray) -> list[Lump]:
    """Masses of the rod between abscissae, at the points of a quadrature in each interval."""
    points, weights = gauss_legendre(MASS_POINTS)
    lumps: list[Lump] = []
    assert properties.linear_density is not None, "refused before"
    for start, end in pairwise(bounds.tolist()):
        if end == start:
            continue
        X = start + (end - start) * (points + 1) / 2
        lengths = properties.length * (end - start) / 2 * weights
        masses = lengths * known(properties.linear_density(X))
        moments = np.zeros((len(X), 3))
        if properties.rotary_inertia is not None:
            moments = lengths[:, None] * known(properties.rotary_inertia(X))
        lumps += zip(masses.tolist(), poses_along(unloaded, properties.name, X), map(np.diag, moments), strict=True)
    return lumps


def _together(frame: NumericPose, lumps: Sequence[Lump]) -> Inertia:
    """The inertia of several masses together, in the axes of a frame."""
    seen = [(mass, _seen(frame, pose), moments) for mass, pose, moments in lumps]
    total = sum(mass for mass, _, _ in seen)
    centre = sum((mass * pose.position for mass, pose, _ in seen), np.zeros(3)) / total
    inertia = np.zeros((3, 3))
    for mass, pose, moments in seen:
        arm = pose.position - centre
        inertia += pose.rotation @ moments @ pose.rotation.T + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertia(total, centre, inertia)


def _seen(frame: NumericPose, pose: NumericPose) -> NumericPose:
    """A pose in world axes as a frame sees it."""
    return frame.inverse.then(pose)


def poses_along(unloaded: UnloadedScene, rod: str, X: FloatArray) -> list[NumericPose]:
    """Poses of the sections of an unloaded rod at abscissae, world axes."""
    discrete = unloaded.rods[rod]
    at_rest = shape(discrete, ca.DM.zeros(discrete.size))
    interpolation = discrete.grid.interpolation_matrix(X)
    positions, quaternions = (
        interpolation @ ca.evalf(ca.MX(ca.densify(field))).full().T for field in (at_rest.position, at_rest.quaternion)
    )
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    base = unloaded.base(rod)
    return [base.then(NumericPose(*pose)) for pose in zip(positions, quaternions, strict=True)]
