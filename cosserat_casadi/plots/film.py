"""Solutions and motions as 3D meshes on moving frames, e.g. for Blender.

A film is written as glTF (``.glb``, one file that browsers and Blender open) or as USD (``.usda``, text with time
samples). Neither needs a library.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.actuators.routing import drawn_places, offset_at
from cosserat_casadi.equilibrium.solution import Solution, rotations
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.files import MESHES, write_atomically
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.sections import half_widths_along
from cosserat_casadi.motion.pose_series import Poses, poses_of, section_poses
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.obstacles.obstacle import capsule_net
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.plots.colours import BODIES, OBSTACLES, actuator_colour, disk_colour, rod_colour
from cosserat_casadi.plots.scenery import body_corners

SECTIONS = np.linspace(0.0, 1.0, 41)
"""Abscissae of the frames of a rod."""

SIDES = 16
"""Sides of a round section."""

THIN = 2e-3
"""Radius of cables and of rods without a section, and least radius of other rods, over the size of the scene."""

Faces = npt.NDArray[np.int64]

Colour = tuple[float, float, float, float]
"""Red, green, blue and opacity, 0 to 1."""


@dataclass(frozen=True)
class FilmPart:
    """A mesh with points fixed to frames.

    Attributes:
        name: name of the shown object.
        colour: colour of the mesh.
        points: points in the axes of their frames, shape (n, 3), m.
        frame: index of the frame of each point, shape (n,).
        faces: indices of the corners of triangles, counter-clockwise from outside, shape (m, 3).
        poses: positions, m, and quaternions of the frames, shapes (T, k, 3) and (T, k, 4).
    """

    name: str
    colour: Colour
    points: FloatArray
    frame: Faces
    faces: Faces
    poses: Poses

    def at(self, index: int) -> FloatArray:
        """Points at the time of this index, world axes, shape (n, 3), m."""
        turned = np.einsum("nij,nj->ni", rotations(self.poses.quaternion[index])[self.frame], self.points)
        return np.asarray(self.poses.position[index][self.frame] + turned)


@dataclass(frozen=True)
class Film:
    """Meshes of a scene over time.

    Attributes:
        title: title of the scene.
        times: times, shape (T,), s; a single time gives a still picture.
        parts: meshes of rods, disks, actuators, bodies and obstacles.
    """

    title: str
    times: FloatArray
    parts: tuple[FilmPart, ...]


def write_film(result: Solution | Motion, path: str | Path, speed: float = 1.0) -> None:
    """Write a solution or a motion as meshes, atomically, in the format of the suffix.

    Args:
        result: solution or motion of a scene of rods.
        path: path of the file, with a suffix of MESHES.
        speed: playing speed over real time: 1 is real time, 0.1 is ten times slower.

    Raises:
        SceneError: the suffix is none of MESHES, or the motion has no state.
        WriteError: the file cannot be written.
    """
    if Path(path).suffix.lower() not in MESHES:
        raise SceneError(Problem("path", f"{path} has no suffix of a film", f"use one of {', '.join(MESHES)}"))
    # Imported here: only one of the two writers is needed.
    if Path(path).suffix.lower() == ".glb":
        from cosserat_casadi.plots.gltf import glb

        write_atomically(Path(path), glb(film_of(result, speed)))
        return
    from cosserat_casadi.plots.usd import usda

    write_atomically(Path(path), usda(film_of(result, speed)).encode())


def film_of(result: Solution | Motion, speed: float = 1.0) -> Film:
    """The film of a motion at its times, or of a solution as a still picture.

    Raises:
        SceneError: the motion has no state.
    """
    model = result.model
    if isinstance(result, Motion):
        times, x, inputs = result.times / speed, result.x, result.inputs
    else:
        times, x, inputs = np.zeros(1), result.x[None], result.inputs[None]
    if not len(times):
        raise SceneError(Problem("path", "the motion has no state: it was not started"))
    return Film(model.scene.title or "Untitled scene", times, tuple(_parts(model, x, inputs)))


def _parts(model: Model, x: FloatArray, inputs: FloatArray) -> Iterator[FilmPart]:
    scene = model.scene
    centre_lines = {name: section_poses(model, name, SECTIONS, x, inputs) for name in model.discrete.rods}
    points = np.concatenate([poses.position.reshape(-1, 3) for poses in centre_lines.values()])
    size = float(np.ptp(points, axis=0).max())
    for index, rod in enumerate(scene.rods):
        outline = _outlines(rod, THIN * size)
        yield _tube(rod.name, _colour(rod_colour(index)), outline, centre_lines[rod.name])
    for index, row in enumerate(scene.disks):
        poses = section_poses(model, row.rod, np.array(row.places), x, inputs)
        colour = _colour(disk_colour(index), 0.5)
        yield _disks(row.name or "disks", colour, row.radius, row.thickness, poses)
    for index, actuator in enumerate(scene.actuators):
        if hasattr(actuator, "offset"):
            X = drawn_places(actuator, SECTIONS)
            offset = known(offset_at(actuator, X)[0]).T
            outline = _ring(THIN * size / 2)[None] + offset[:, None, :]
            poses = section_poses(model, actuator.rod, X, x, inputs)
            yield _tube(actuator.name, _colour(actuator_colour(index)), outline, poses)
    bodies = {body.name: poses_of(model.body[body.name], x, inputs) for body in scene.bodies}
    for body in scene.listed_bodies:
        poses = _single(bodies[body.name])
        if body.radius is not None and body.thickness is not None:
            yield _disks(body.name, _colour(BODIES), body.radius, body.thickness, poses)
        else:
            yield _body(body.name, body_corners(scene, body), body.radius, 3 * THIN * size, poses)
    for obstacle in scene.obstacles:
        near = points.mean(axis=0)
        poses = Poses(np.zeros((len(x), 1, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (len(x), 1, 1)))
        if obstacle.body is not None:
            poses = _single(bodies[obstacle.body])
            near = rotations(poses.quaternion[0])[0].T @ (near - poses.position[0, 0])
        net = np.asarray(SURFACES[obstacle.kind].mesh(obstacle, near, size))
        yield _net(obstacle.name, net, poses)


def _single(poses: Poses) -> Poses:
    """Poses of one frame, with an axis of length 1 for the frames."""
    return Poses(poses.position[:, None], poses.quaternion[:, None])


def _colour(name: str, opacity: float = 1.0) -> Colour:
    """A colour from its hexadecimal name."""
    red, green, blue = (int(name[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue, opacity


def _ring(radius: Any) -> FloatArray:
    """Points of a circle, shape (…, SIDES, 2), m."""
    angles = np.linspace(0.0, 2 * np.pi, SIDES, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.asarray(np.asarray(radius)[..., None, None] * circle)


def _outlines(rod: Any, least: float) -> FloatArray:
    """Outlines of the sections of a rod at SECTIONS, shape (len(SECTIONS), k, 2), m."""
    widths = half_widths_along(rod.section, SECTIONS)
    if widths is None:
        return _ring(np.full(len(SECTIONS), least))
    x, y = (np.maximum(width, least) for width in widths)
    if rod.section.radius_key is not None:
        return _ring(x)
    corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    return np.asarray(np.stack([x, y], axis=1)[:, None] * corners)


def _rings(count: int, sides: int, first: int = 0) -> Faces:
    """Triangles of a tube of rings with closed ends."""
    around = np.arange(sides)
    ends = np.roll(around, -1)
    starts = first + sides * np.arange(count - 1)[:, None]
    a, b = starts + around, starts + ends
    sheets = [np.stack([a, b, b + sides], axis=-1), np.stack([a, b + sides, a + sides], axis=-1)]
    fan = np.stack([np.zeros(sides - 2, dtype=int), around[1:-1], around[2:]], axis=-1)
    last = first + sides * (count - 1)
    return np.concatenate([sheet.reshape(-1, 3) for sheet in sheets] + [first + fan[:, ::-1], last + fan])


def _tube(name: str, colour: Colour, outline: FloatArray, poses: Poses) -> FilmPart:
    """A tube through outlines, shape (k, sides, 2), in the x–y planes of k frames."""
    count, sides, _ = outline.shape
    points = np.concatenate([outline, np.zeros((count, sides, 1))], axis=2).reshape(-1, 3)
    return FilmPart(name, colour, points, np.repeat(np.arange(count), sides), _rings(count, sides), poses)


def _disks(name: str, colour: Colour, radius: float, thickness: float, poses: Poses) -> FilmPart:
    """Cylinders at the frames of a row of disks, or of a disk that is a body."""
    count = poses.position.shape[1]
    ring = _ring(radius)
    heights = np.repeat([-thickness / 2, thickness / 2], SIDES)
    disk = np.column_stack([np.tile(ring, (2, 1)), heights])
    faces = np.concatenate([_rings(2, SIDES, 2 * SIDES * number) for number in range(count)])
    frame = np.repeat(np.arange(count), 2 * SIDES)
    return FilmPart(name, colour, np.tile(disk, (count, 1)), frame, faces, poses)


def _body(name: str, corners: FloatArray, radius: float | None, least: float, poses: Poses) -> FilmPart:
    """A ball if the body has a radius, else a prism on the polygon of its joints, or a bar."""
    if radius is not None or len(corners) < 3:
        start, end = (np.zeros(3), np.zeros(3)) if radius is not None else (corners[0], corners[-1])
        net = capsule_net(start, end, least if radius is None else radius)
        return _net(name, net, poses, BODIES)
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal *= least / 2 / max(float(np.linalg.norm(normal)), 1e-300)
    points = np.concatenate([corners - normal, corners + normal])
    frame = np.zeros(len(points), dtype=int)
    return FilmPart(name, _colour(BODIES), points, frame, _rings(2, len(corners)), poses)


def _net(name: str, net: FloatArray, poses: Poses, colour: str = OBSTACLES) -> FilmPart:
    """A surface through a net of points, shape (m, n, 3), m, fixed to one frame."""
    rows, columns, _ = net.shape
    a = (columns * np.arange(rows - 1)[:, None] + np.arange(columns - 1)).ravel()
    faces = np.concatenate(
        [np.stack([a, a + 1, a + columns + 1], axis=1), np.stack([a, a + columns + 1, a + columns], axis=1)]
    )
    opacity = 0.6 if colour == OBSTACLES else 1.0
    frame = np.zeros(rows * columns, dtype=int)
    return FilmPart(name, _colour(colour, opacity), net.reshape(-1, 3), frame, faces, poses)
