"""A rod as a chain of rigid links, by the midpoint rule.

Nodes divide the rod into pieces; the link of a node extends to the middles of the two adjacent pieces. The joint in the
middle of a piece of length h has the strain of the piece and the stiffness H/h. A strain field is replaced by its value
in the middle of each piece: errors of shapes and frequencies are O(h²).
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
"""Radius over length of drawn rods without a section."""

MASS_POINTS = 3
"""Number of quadrature points for the mass of half a piece."""


@dataclass(frozen=True)
class Inertia:
    """Mass of a rigid link.

    Attributes:
        mass: mass, kg.
        centre: centre of mass in the axes of the link, shape (3,), m.
        moments: inertia about the centre in the axes of the link, shape (3, 3), kg m².
    """

    mass: float
    centre: FloatArray
    moments: FloatArray


@dataclass(frozen=True)
class RodPiece:
    """The piece of a rod between two nodes, with a joint for its strains in the middle.

    Attributes:
        middle: pose of the middle section, world axes, unloaded.
        length: length, m.
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
        piece: the piece before the node; None for the first link.
        ends: start and end of the link, in its axes, shape (2, 3), m.
        half_widths: half widths of its section along x and y, m; the radius twice for a round section.
        inertia: inertia of the rod and of the disks at the node.
    """

    at: float
    frame: NumericPose
    piece: RodPiece | None
    ends: FloatArray
    half_widths: tuple[float, float]
    inertia: Inertia


def nodes_along(ends: Sequence[float], links: int) -> FloatArray:
    """Abscissae of nodes, shape (k,): element ends, and between them nodes for about ``links`` pieces."""
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
    """Half widths of the sections at the nodes, m; for a rod without a section those of a thin round one."""
    widths = half_widths_along(rod.section, nodes)
    if widths is None:
        return [(THIN * rod.length, THIN * rod.length)] * len(nodes)
    return list(zip(*(width.tolist() for width in widths), strict=True))


Lump = tuple[float, NumericPose, FloatArray]
"""Mass, pose in world axes, and moments of inertia in the axes of the pose."""


def _lumps(unloaded: UnloadedScene, properties: RodProperties, bounds: FloatArray) -> list[Lump]:
    """Lumped masses of the rod at the quadrature points of each interval between abscissae."""
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
    """The total inertia of several masses, in the axes of a frame."""
    seen = [(mass, _seen(frame, pose), moments) for mass, pose, moments in lumps]
    total = sum(mass for mass, _, _ in seen)
    centre = sum((mass * pose.position for mass, pose, _ in seen), np.zeros(3)) / total
    inertia = np.zeros((3, 3))
    for mass, pose, moments in seen:
        arm = pose.position - centre
        of_point_mass = mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        inertia += pose.rotation @ moments @ pose.rotation.T + of_point_mass
    return Inertia(total, centre, inertia)


def _seen(frame: NumericPose, pose: NumericPose) -> NumericPose:
    """A pose in world axes relative to a frame."""
    return frame.inverse.then(pose)


def poses_along(unloaded: UnloadedScene, rod: str, X: FloatArray) -> list[NumericPose]:
    """Poses of the sections of an unloaded rod at abscissae X, world axes."""
    discrete = unloaded.rods[rod]
    at_rest = shape(discrete, ca.DM.zeros(discrete.size))
    interpolation = discrete.grid.interpolation_matrix(X)
    positions, quaternions = (
        interpolation @ ca.evalf(ca.MX(ca.densify(field))).full().T for field in (at_rest.position, at_rest.quaternion)
    )
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    base = unloaded.base(rod)
    return [base.then(NumericPose(*pose)) for pose in zip(positions, quaternions, strict=True)]
