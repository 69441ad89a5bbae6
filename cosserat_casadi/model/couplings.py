"""What couples rods: frames that move, and the ties between sections of rods and these frames.

A moving frame is a rigid body or the base of a rod that another rod carries. A tie holds a section of a rod to a
place on a frame, or, for a rod whose base moves, to a place in the world. Everything here is settled once for a scene
and its discretisation, from the shapes of the unloaded rods.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.joint import Joint
from cosserat_casadi.constraints.tip_support import Pose, stays_in_plane
from cosserat_casadi.maths.rotation import (
    matrix_to_quaternion,
    quaternion_conjugate,
    quaternion_product,
    quaternion_to_matrix,
    rotate,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.rods import base_pose
from cosserat_casadi.rod.kinematics import Shape, shape
from cosserat_casadi.rod.strain import DiscreteRod

ALL = (0, 1, 2)
IN_PLANE = (0, 2)
ACROSS = (1,)

FLAT = 1e-9
"""Distance from a plane, relative to a length, and sine of an angle to it, that count as none."""


class Carrier(NamedTuple):
    """Name of a moving frame: "body" and the body, or "rod" and the rod whose base it is."""

    kind: str
    name: str


@dataclass(frozen=True)
class RigidPose:
    """Numeric pose of a frame.

    Attributes:
        position: shape (3,), m.
        quaternion: of norm 1, shape (4,).
    """

    position: FloatArray
    quaternion: FloatArray

    @cached_property
    def rotation(self) -> FloatArray:
        """Rotation matrix, shape (3, 3)."""
        return np.asarray(quaternion_to_matrix(ca.DM(self.quaternion)).full())

    def then(self, inner: RigidPose) -> RigidPose:
        """Pose of a frame whose pose in this one is given."""
        turn = quaternion_product(ca.DM(self.quaternion), ca.DM(inner.quaternion)).full()[:, 0]
        return RigidPose(self.position + self.rotation @ inner.position, turn)

    @cached_property
    def inverse(self) -> RigidPose:
        """This frame's origin as the frame sees it."""
        back = quaternion_conjugate(ca.DM(self.quaternion))
        return RigidPose(rotate(back, ca.DM(-self.position)).full()[:, 0], back.full()[:, 0])

    @property
    def pose(self) -> Pose:
        """The same for expressions."""
        return Pose(ca.DM(self.position), ca.DM(self.quaternion))


@dataclass(frozen=True)
class MovingFrame:
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
    start: RigidPose

    SIZE = 7
    """Number of unknowns."""


@dataclass(frozen=True)
class Tie:
    """A joint in its place.

    Attributes:
        joint: what it holds.
        rod: name of the rod whose section it holds.
        node: node of that section.
        other: the frame on the other side; None for the world.
        where: path of the scene's table.
        what: the two sides in words.
    """

    joint: Joint
    rod: str
    node: int
    other: Carrier | None
    where: str
    what: str


@dataclass(frozen=True)
class Couplings:
    """Moving frames and ties of a scene.

    Attributes:
        scene: the scene.
        rods: the constant matrices of each rod.
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

    def carrier(self, rod: str) -> Carrier | None:
        """The moving frame that a rod's base is; None where it rests in the world."""
        return None if self.records[rod].base.rod is None else Carrier("rod", rod)

    @cached_property
    def moving(self) -> dict[Carrier, MovingFrame]:
        """Moving frames: bases of carried rods in the order of the scene, then bodies."""
        found = {}
        for rod in self.carried:
            discrete_rod = self.rods[rod.name]
            start = self.unloaded_base(rod.name)
            found[Carrier("rod", rod.name)] = MovingFrame(None, discrete_rod.energy_unit, rod.length, start)
        for body in self.scene.bodies:
            found[Carrier("body", body.name)] = self._body_frame(body)
        return found

    @cached_property
    def ties(self) -> list[Tie]:
        """Ties: bases of carried rods, joints, then supports of rods whose base moves."""
        found = [self._base_tie(rod) for rod in self.carried]
        found += [self._joint_tie(i, joint) for i, joint in enumerate(self.scene.joints)]
        for i, support in enumerate(self.scene.supports):
            if self.carrier(support.rod) is not None:
                found.append(self._support_tie(i, support))
        return found

    def unloaded_base(self, rod: str) -> RigidPose:
        """World pose of a rod's base in the unloaded scene."""
        record = self.records[rod]
        own = RigidPose(*base_pose(record))
        return own if record.base.rod is None else self._unloaded_section(record.base.rod, record.base.at).then(own)

    def flat(self, rod: str) -> RigidPose | None:
        """Unloaded base of a rod that never leaves its x–z plane; None where the rod or what carries it may."""
        own, carrier = self.unloaded_base(rod), self.records[rod].base.rod
        if not stays_in_plane(self.rods[rod].properties):
            return None
        if carrier is None:
            return own
        below = self.flat(carrier)
        return own if below is not None and _same_plane(below, own, self.records[rod].length) else None

    @cached_property
    def all_flat(self) -> bool:
        """Whether all rods stay in parallel planes, so that bodies turn about one axis."""
        planes = [self.flat(rod) for rod in self.records]
        first = planes[0]
        if first is None:
            return False
        normals = [None if plane is None else np.cross(first.rotation[:, 1], plane.rotation[:, 1]) for plane in planes]
        return all(normal is not None and np.linalg.norm(normal) <= FLAT for normal in normals)

    def _unloaded_section(self, rod: str, at: float) -> RigidPose:
        discrete_rod = self.rods[rod]
        if rod not in self._shapes:
            self._shapes[rod] = shape(discrete_rod, ca.MX.zeros(discrete_rod.size))
        place, node = self._shapes[rod], discrete_rod.grid.node_at(at)
        position, quaternion = (_numbers(m) for m in (place.position_at(node), place.quaternion[:, node]))
        return self.unloaded_base(rod).then(RigidPose(position, quaternion / np.linalg.norm(quaternion)))

    def _body_frame(self, body: scenes.Body) -> MovingFrame:
        """A body's frame, in units of the stiffest and the longest rod that holds it, where the unloaded rods want it.

        Mean position and mean rotation by the singular value decomposition: the rotation that turns the orientations
        of fixed joints, and the arms of all, nearest to what the tips ask for.
        """
        joints = [joint for joint in self.scene.joints if joint.body == body.name]
        bases = [self.rods[joint.rod] for joint in joints]
        unit, length = max(b.energy_unit for b in bases), max(b.properties.length for b in bases)
        tips = [self._unloaded_section(joint.rod, 1.0) for joint in joints]
        arms, points = np.array([j.position for j in joints]), np.array([tip.position for tip in tips])
        spread = (points - points.mean(axis=0)).T @ (arms - arms.mean(axis=0))
        for joint, tip in zip(joints, tips, strict=True):
            if joint.kind == "fixed":
                wanted = tip.then(RigidPose(np.zeros(3), _array(joint.quaternion)).inverse)
                spread = spread + length**2 * wanted.rotation
        rotation = _nearest_rotation(spread)
        position = points.mean(axis=0) - rotation @ arms.mean(axis=0)
        return MovingFrame(body, unit, length, RigidPose(position, matrix_to_quaternion(rotation)))

    def _base_tie(self, rod: scenes.Rod) -> Tie:
        """The base of a rod on a section of another: its frame offers the section the inverse of the base's pose."""
        carrier, at = rod.base.rod, rod.base.at
        assert carrier is not None
        place = RigidPose(*base_pose(rod)).inverse
        where = f"rods[{list(self.records).index(rod.name)}].base"
        what = f"the base of {rod.name!r} on {carrier!r}"
        return self._tie(carrier, at, Carrier("rod", rod.name), place, (ALL, ALL), (where, what))

    def _joint_tie(self, i: int, joint: scenes.Joint) -> Tie:
        place = RigidPose(_array(joint.position), _array(joint.quaternion))
        what = f"the tip of {joint.rod!r} at {joint.body!r}"
        axes = self._joint_axes(joint)
        return self._tie(joint.rod, 1.0, Carrier("body", joint.body), place, axes, (f"joints[{i}]", what))

    def _support_tie(self, i: int, support: scenes.Support) -> Tie:
        turns = isinstance(support, scenes.ClampedSupport)
        own = _array(support.quaternion) if isinstance(support, scenes.ClampedSupport) else np.array([1.0, 0, 0, 0])
        place, plane = RigidPose(_array(support.position), own), self.flat(support.rod)
        length, what = self.records[support.rod].length, f"the tip of {support.rod!r} at its support"
        axes: tuple[tuple[int, ...], tuple[int, ...]] = (ALL, ALL if turns else ())
        if plane is not None and _same_plane(plane, place, length, turns=turns):
            axes = (IN_PLANE, ACROSS if turns else ())
        return self._tie(support.rod, 1.0, None, place, axes, (f"supports[{i}]", what))

    def _tie(
        self,
        rod: str,
        at: float,
        other: Carrier | None,
        place: RigidPose,
        axes: tuple[tuple[int, ...], tuple[int, ...]],
        words: tuple[str, str],
    ) -> Tie:
        """A tie whose place has the sign of quaternion that is near the unloaded section."""
        discrete_rod = self.rods[rod]
        wanted = place if other is None else self.moving[other].start.then(place)
        turn = self._unloaded_section(rod, at).quaternion
        near = place if wanted.quaternion @ turn >= 0 else RigidPose(place.position, -place.quaternion)
        joint = Joint(discrete_rod.properties, discrete_rod.energy_unit, at, *axes, near.pose)
        return Tie(joint, rod, discrete_rod.grid.node_at(at), other, *words)

    def _joint_axes(self, joint: scenes.Joint) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Base axes that a joint holds: of planar rods that hold one body in their plane, only the first does that.

        Several such rods keep the body in the plane, and each of their joints turns about its normal alone.
        """
        fixed = joint.kind == "fixed"
        together = self._coplanar(joint)
        if len(together) < 2:
            return ALL, ALL if fixed else ()
        if together[0] == joint:
            return ALL, ALL if fixed else IN_PLANE
        return IN_PLANE, ACROSS if fixed else ()

    def _coplanar(self, joint: scenes.Joint) -> list[scenes.Joint]:
        """Joints of the same body on planar rods of the same plane, in their order; none off a planar rod."""
        own = self.flat(joint.rod)
        if own is None:
            return []
        return [j for j in self.scene.joints if j.body == joint.body and self._shares_plane(joint, own, j)]

    def _shares_plane(self, joint: scenes.Joint, plane: RigidPose, other: scenes.Joint) -> bool:
        """Whether two joints hold a body in one plane, in the world and in the body alike."""
        second, length = self.flat(other.rod), self.records[joint.rod].length
        if second is None or not _same_plane(plane, second, length):
            return False
        place, there = (RigidPose(_array(j.position), _array(j.quaternion)) for j in (joint, other))
        alike = (plane.rotation[:, 1] @ second.rotation[:, 1]) * (place.rotation[:, 1] @ there.rotation[:, 1]) > 0
        return bool(alike) and _same_plane(place, there, length)


def _same_plane(one: RigidPose, other: RigidPose, length: float, *, turns: bool = True) -> bool:
    """Whether the x–z planes of two frames are one plane; without ``turns`` whether it holds the other's origin."""
    normal = one.rotation[:, 1]
    distance = abs(float(normal @ (other.position - one.position)))
    tilt = float(np.linalg.norm(np.cross(normal, other.rotation[:, 1]))) if turns else 0.0
    return distance <= FLAT * length and tilt <= FLAT


def _nearest_rotation(matrix: FloatArray) -> FloatArray:
    """The rotation R with the largest trace of Rᵀ M."""
    left, _, right = np.linalg.svd(matrix)
    sign = np.sign(np.linalg.det(left @ right))
    return np.asarray(left @ np.diag([1.0, 1.0, sign]) @ right)


def _array(values: tuple[float, ...]) -> FloatArray:
    return np.asarray(values, dtype=np.float64)


def _numbers(matrix: Matrix) -> FloatArray:
    return np.asarray(ca.evalf(ca.densify(matrix)).full()[:, 0])
