"""Distances of solved rods, between the nodes too, and of bodies from obstacles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.body_obstacles import seen_positions, world_directions
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distances, surface
from cosserat_casadi.equilibrium.solution import Contact, Solution, SolvedPoses
from cosserat_casadi.loads.disk_reach import disk_reach
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.contact_pairs import named_pairs
from cosserat_casadi.rod.properties import RodProperties

DENSE = np.linspace(0.0, 1.0, 801)
"""Abscissae at which distances from obstacles are evaluated; they are not nodes."""

ROUNDING = 1e-14
"""Gap and slope at a base, relative to the length, that count as zero."""


def pairs(scene: scenes.Scene) -> Iterator[tuple[str, scenes.ObstacleRecord]]:
    """Every rod with every obstacle without a width that concerns it; only the first of coinciding obstacles."""
    for rod in scene.rods:
        concerned = [obstacle for obstacle in scene.obstacles if obstacle.concerns(rod.name) and not obstacle.is_smooth]
        for obstacle in _distinct(concerned):
            yield rod.name, obstacle


def body_pairs(scene: scenes.Scene) -> Iterator[tuple[scenes.Body, scenes.ObstacleRecord]]:
    """Every body with every obstacle without a width that concerns it, as a ball or a disk about its origin."""
    for body in scene.bodies:
        concerned = [
            obstacle for obstacle in scene.obstacles if obstacle.concerns_body(body.name) and not obstacle.is_smooth
        ]
        for obstacle in _distinct(concerned):
            yield body, obstacle


def _distinct(obstacles: Sequence[scenes.ObstacleRecord]) -> Iterator[scenes.ObstacleRecord]:
    """Obstacles without copies of an earlier one at the same place: the force between them would be undetermined."""
    shapes: list[dict[str, object]] = []
    for obstacle in obstacles:
        shape = obstacle.model_dump(exclude={"name", "rods", "bodies"})
        if shape not in shapes:
            shapes.append(shape)
            yield obstacle


def rod_pairs(scene: scenes.Scene) -> Iterator[tuple[str, str]]:
    """Every two rods that may touch each other exactly."""
    for contact, rods in named_pairs(scene):
        if contact.exact:
            yield rods


def obstacle_of(scene: scenes.Scene, name: str) -> scenes.ObstacleRecord:
    """The obstacle of a name."""
    (record,) = [obstacle for obstacle in scene.obstacles if obstacle.name == name]
    return record


def gap_along(solution: Solution, rod: str, obstacle: scenes.ObstacleRecord, X: FloatArray) -> FloatArray:
    """Distance of a rod's surface from an obstacle at abscissae X, over the length of the rod, shape (k,)."""
    properties = solution.model.discrete.rods[rod].properties
    return section_gaps(obstacle, properties, seen_sections(solution, rod, obstacle, X), X) / properties.length


def seen_sections(solution: Solution, rod: str, obstacle: scenes.ObstacleRecord, X: FloatArray) -> FloatArray:
    """Positions of a rod's sections at abscissae X in the axes of an obstacle, shape (k, 3), m."""
    return seen_positions(solution, obstacle, solution.pose(X, rod).position)


def section_gaps(
    obstacle: scenes.ObstacleRecord, properties: RodProperties, positions: FloatArray, X: FloatArray
) -> FloatArray:
    """Distances of a rod's sections at abscissae X from an obstacle, shape (k,), m, for positions of shape (k, 3).

    Positions are in the axes of the obstacle.
    """
    return np.asarray(distances(obstacle, positions) - section_radius(properties, X))


def body_gap(solution: Solution, body: scenes.Body, obstacle: scenes.ObstacleRecord) -> float:
    """Distance of a body's surface from an obstacle, over the length of the longest rod that holds it."""
    length = solution.model.discrete.body_frame(body.name).length
    return gap_at(obstacle, body, solution.body(body.name)) / length


def gap_at(obstacle: scenes.ObstacleRecord, body: scenes.Body, pose: SolvedPoses) -> float:
    """Distance of the surface of a body at a pose from an obstacle, m."""
    distance, normal, _ = surface(obstacle)(pose.position)
    return float(distance - support_of(body, normal, ca.DM(pose.rotation))[0])


def support_of(body: scenes.Body, normal: Matrix, rotation: Matrix) -> tuple[Matrix | float, Matrix]:
    """Reach of a body against the normal of an obstacle, m, and the vector from its origin to that point, 3×1, m.

    Args:
        body: a ball, or a disk about its z axis.
        normal: normal of the obstacle, 3×1.
        rotation: rotation of the body, 3×3.
    """
    radius = body.ball_radius
    if body.thickness is None:
        return radius, -radius * normal
    return disk_reach(normal, rotation[:, 2], radius, body.thickness)


def inner_radius(body: scenes.Body) -> float:
    """Radius of the largest ball about the origin of a body that is inside it, m."""
    return body.ball_radius if body.thickness is None else min(body.ball_radius, body.thickness / 2)


def ball_gaps(obstacle: scenes.ObstacleRecord, radius: float, positions: FloatArray) -> FloatArray:
    """Distances of a ball at positions (k, 3) from an obstacle, shape (k,), m."""
    return np.asarray(distances(obstacle, positions) - radius)


def body_normal(solution: Solution, body: str, obstacle: scenes.ObstacleRecord) -> FloatArray:
    """Normal of an obstacle at a body, shape (3,)."""
    _, gradient, _ = surface(obstacle)(solution.body(body).position)
    return np.asarray(gradient.full()[:, 0])


def normals(solution: Solution, rod: str, obstacle: scenes.ObstacleRecord, X: FloatArray) -> FloatArray:
    """Normals of an obstacle at the sections of a rod, world axes, shape (k, 3)."""
    positions = seen_sections(solution, rod, obstacle, X)
    _, gradient, _ = surface(obstacle).map(len(X))(positions.T)
    return world_directions(solution, obstacle, gradient.full().T)


def lies_at_base(solution: Solution, rod: str, obstacle: scenes.ObstacleRecord) -> bool:
    """Whether a clamp holds the base of a rod on an obstacle and along it: gap and slope are zero to rounding.

    A line of contact begins at the fourth root of such a gap: a gap of 1e-12 of the length is not rounding.
    """
    if obstacle.body is not None or solution.model.discrete.unloaded.floating_base(rod) is not None:
        return False
    at_base = np.zeros(1)
    properties = solution.model.discrete.rods[rod].properties
    base, tip = section_radius(properties, np.array([0.0, 1.0]))
    tangent = solution.pose(at_base, rod).rotation[0, :, 2]
    taper = (tip - base) / solution.model.length(rod, solution.inputs)
    slope = normals(solution, rod, obstacle, at_base)[0] @ tangent - taper
    return bool(max(abs(gap_along(solution, rod, obstacle, at_base)[0]), abs(slope)) <= ROUNDING)


def touching_points(solution: Solution, contact: Contact, along: int) -> FloatArray:
    """Centres of the touching sections, ``along`` of them on a line; for a body the point that touches."""
    if contact.of_body:
        (body,) = [body for body in solution.model.scene.bodies if body.name == contact.owner]
        obstacle = obstacle_of(solution.model.scene, contact.obstacle)
        normal = body_normal(solution, body.name, obstacle)
        pose = solution.body(body.name)
        if body.thickness is None:
            return np.asarray(pose.position[None] - body.ball_radius * normal)
        axis = ca.DM(pose.rotation[:, 2])
        _, touching = disk_reach(ca.DM(normal), axis, body.ball_radius, body.thickness)
        return np.asarray(pose.position[None] + ca.DM(touching).full().T)
    count = along if contact.start < contact.end else 1
    X = np.linspace(contact.start, contact.end, count)
    return solution.pose(X, contact.owner).position


def runs(chosen: npt.NDArray[np.bool_]) -> Iterator[slice]:
    """Slices of consecutive entries that are true."""
    padded = np.concatenate([[False], chosen, [False]]).astype(int)
    steps = np.diff(padded)
    starts = np.flatnonzero(steps == 1)
    ends = np.flatnonzero(steps == -1)
    for start, end in zip(starts, ends, strict=True):
        yield slice(int(start), int(end))
