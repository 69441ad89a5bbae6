"""Floating frames: rigid bodies, and the bases of rods that other rods carry. Their poses are unknown.

Here is what does not depend on the unknowns: where each frame is in the unloaded scene, and its units.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.held_directions import stays_in_plane
from cosserat_casadi.maths.pose import NumericPose, Pose, numeric
from cosserat_casadi.maths.rotation import matrix_to_quaternion
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.rods import base_pose
from cosserat_casadi.rod.kinematics import Shape, shape
from cosserat_casadi.rod.strain import DiscreteRod

FLAT = 1e-9
"""Distance from a plane, relative to a length, and sine of an angle to it, that count as none."""


class FrameName(NamedTuple):
    """Name of a floating frame: "body" and the body, or "rod" and the rod whose base it is."""

    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.kind} {self.name}"


@dataclass(frozen=True)
class FloatingFrame:
    """A frame whose pose is unknown: a deviation (p − p₀)/ℓ, Q − Q₀ from where the unloaded scene has it.

    Attributes:
        body: the body, or None for the base of a rod.
        unit: energy that makes its balance dimensionless, J.
        length: length ℓ that does, m.
        start: p₀ and Q₀.
    """

    body: scenes.Body | None
    unit: float
    length: float
    start: NumericPose

    SIZE = 7
    """Number of unknowns."""


@dataclass(frozen=True)
class UnloadedScene:
    """Poses of rods and bodies where nothing acts.

    Attributes:
        scene: the scene.
        rods: the discrete rods.
    """

    scene: scenes.Scene
    rods: Mapping[str, DiscreteRod]
    _shapes: dict[str, Shape] = field(default_factory=dict, repr=False)

    @cached_property
    def records(self) -> dict[str, scenes.Rod]:
        """Rods of the scene by name."""
        return {rod.name: rod for rod in self.scene.rods}

    @cached_property
    def carried(self) -> list[scenes.Rod]:
        """Rods that start on other rods."""
        return [rod for rod in self.scene.rods if rod.base.rod is not None]

    def floating_base(self, rod: str) -> FrameName | None:
        """The floating frame that a rod's base is; None where it rests in the world."""
        return None if self.records[rod].base.rod is None else FrameName("rod", rod)

    @cached_property
    def frames(self) -> dict[FrameName, FloatingFrame]:
        """Floating frames: bases of carried rods in the order of the scene, then bodies."""
        frames = {}
        for rod in self.carried:
            unit = self.rods[rod.name].energy_unit
            frames[FrameName("rod", rod.name)] = FloatingFrame(None, unit, rod.length, self.base(rod.name))
        for body in self.scene.bodies:
            frames[FrameName("body", body.name)] = self._body_frame(body)
        return frames

    def base(self, rod: str) -> NumericPose:
        """World pose of a rod's base."""
        record = self.records[rod]
        own = NumericPose(*base_pose(record))
        carrier = record.base.rod
        return own if carrier is None else self.section(carrier, record.base.at).then(own)

    def section(self, rod: str, at: float) -> NumericPose:
        """World pose of a section of a rod."""
        discrete_rod = self.rods[rod]
        if rod not in self._shapes:
            self._shapes[rod] = shape(discrete_rod, ca.MX.zeros(discrete_rod.size))
        node = discrete_rod.grid.node_at(at)
        local = numeric(Pose(self._shapes[rod].position_at(node), self._shapes[rod].quaternion[:, node]))
        unit = local.quaternion / np.linalg.norm(local.quaternion)
        return self.base(rod).then(NumericPose(local.position, unit))

    def plane(self, rod: str) -> NumericPose | None:
        """Base of a rod that never leaves its x–z plane; None where the rod or what carries it may."""
        if not stays_in_plane(self.rods[rod].properties):
            return None
        own = self.base(rod)
        carrier = self.records[rod].base.rod
        if carrier is None:
            return own
        below = self.plane(carrier)
        return own if below is not None and same_plane(below, own, self.records[rod].length) else None

    @cached_property
    def all_in_parallel_planes(self) -> bool:
        """Whether all rods stay in parallel planes, so that bodies turn about one axis."""
        planes = [self.plane(rod) for rod in self.records]
        first = planes[0]
        if first is None:
            return False
        normals = [None if plane is None else np.cross(first.rotation[:, 1], plane.rotation[:, 1]) for plane in planes]
        return all(normal is not None and np.linalg.norm(normal) <= FLAT for normal in normals)

    def _body_frame(self, body: scenes.Body) -> FloatingFrame:
        """A body's frame, in units of the stiffest and the longest rod that holds it, where the unloaded rods want it.

        Mean position, and mean rotation by the singular value decomposition: the rotation that turns the orientations
        of joints that hold one, and the arms of all, nearest to what the tips ask for.
        """
        joints = [joint for joint in self.scene.joints if joint.body == body.name]
        rods = [self.rods[joint.rod] for joint in joints]
        unit = max(rod.energy_unit for rod in rods)
        length = max(rod.properties.length for rod in rods)
        tips = [self.section(joint.rod, 1.0) for joint in joints]
        arms = np.array([joint.position for joint in joints])
        points = np.array([tip.position for tip in tips])
        spread = (points - points.mean(axis=0)).T @ (arms - arms.mean(axis=0))
        for joint, tip in zip(joints, tips, strict=True):
            if joint.kind != "spherical":
                place = NumericPose(np.zeros(3), np.asarray(joint.quaternion, dtype=float))
                spread = spread + length**2 * tip.then(place.inverse).rotation
        rotation = _nearest_rotation(spread)
        position = points.mean(axis=0) - rotation @ arms.mean(axis=0)
        return FloatingFrame(body, unit, length, NumericPose(position, matrix_to_quaternion(rotation)))


def same_plane(first: NumericPose, second: NumericPose, length: float, *, tilted: bool = False) -> bool:
    """Whether the x–z planes of two frames are one plane; ``tilted``: whether it holds the second frame's origin."""
    normal = first.rotation[:, 1]
    distance = abs(float(normal @ (second.position - first.position)))
    if distance > FLAT * length:
        return False
    return tilted or float(np.linalg.norm(np.cross(normal, second.rotation[:, 1]))) <= FLAT


def _nearest_rotation(matrix: FloatArray) -> FloatArray:
    """The rotation R with the largest trace of Rᵀ M."""
    left, _, right = np.linalg.svd(matrix)
    sign = np.sign(np.linalg.det(left @ right))
    return np.asarray(left @ np.diag([1.0, 1.0, sign]) @ right)
