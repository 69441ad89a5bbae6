"""Floating frames: rigid bodies, and the bases of rods that other rods carry or nothing holds. Their poses are unknown.

This module settles what does not depend on the unknowns: the pose of each frame in the unloaded scene, and its units.
Docs/theory.md, section 8.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.held_directions import CLAMPED, FLAT, confines, stays_in_plane
from cosserat_casadi.constraints.joints import JOINT_KINDS
from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.constraints.tip_holder import place_of
from cosserat_casadi.maths.pose import IDENTITY, POSE_SIZE, NumericPose, Pose, numeric
from cosserat_casadi.maths.rotation import cross_matrix, matrix_to_quaternion, quaternion_product
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.scene_rods import base_pose
from cosserat_casadi.rod.kinematics import Shape, shape
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene.orientations import quaternion_about

MOST_CORRECTIONS = 20
"""Most corrections of a body's pose: joints that are still open then count as impossible to close."""

FIRST_CORRECTIONS = 4
"""Corrections before progress is judged: gaps may grow at first."""

STALLED = 0.9
"""Ratio of successive largest gaps, after the first corrections, above which no pose is taken to close the joints."""

CLOSED = 1e-12
"""Gap of a joint, without unit, up to which it counts as closed."""


class FrameName(NamedTuple):
    """Name of a floating frame: "body" and the body, or "rod" and the rod whose base it is."""

    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.kind} {self.name}"


@dataclass(frozen=True)
class FloatingFrame:
    """A frame whose pose is unknown: a deviation (p − p₀)/ℓ, Q − Q₀ from its pose in the unloaded scene.

    Attributes:
        body: the body, or None for the base of a rod.
        unit: energy that makes its balance dimensionless, J.
        length: length ℓ that makes its displacement dimensionless, m.
        start: p₀ and Q₀.
    """

    body: scenes.Body | None
    unit: float
    length: float
    start: NumericPose

    SIZE = POSE_SIZE
    """Number of unknowns."""


@dataclass(frozen=True)
class FramePose:
    """World pose of a floating frame from its unknowns (p − p₀)/ℓ and Q − Q₀, and how it moves with them.

    The unknown quaternion has any norm, and only its direction counts; a row of the balance makes its norm one.

    Attributes:
        frame: the frame.
        deviation: its unknowns, 7×1.
    """

    frame: FloatingFrame
    deviation: Matrix

    @cached_property
    def position(self) -> Matrix:
        """Position p, 3×1, m."""
        return ca.DM(self.frame.start.position) + self.frame.length * self.deviation[:3]

    @cached_property
    def quaternion(self) -> Matrix:
        """Quaternion Q, 4×1, not zero and of any norm."""
        return ca.DM(self.frame.start.quaternion) + self.deviation[3:]

    @cached_property
    def pose(self) -> Pose:
        """The pose, with the quaternion of norm 1."""
        norm = ca.sqrt(ca.sumsqr(self.quaternion))
        return Pose(self.position, self.quaternion / norm)

    @property
    def motion(self) -> Matrix:
        """B: motion [δθ; δr] of the frame with its unknowns, 6×7, world axes."""
        turn = turn_matrix(self.quaternion)
        rotation_rows = ca.horzcat(ca.DM(3, 3), turn)
        position_rows = ca.horzcat(self.frame.length * ca.DM.eye(3), ca.DM(3, 4))
        return ca.vertcat(rotation_rows, position_rows)


def turn_matrix(quaternion: Matrix) -> Matrix:
    """Matrix T from δQ to δθ in world axes, 3×4: δθ = 2 vec(δQ ⊗ Q*) / Q·Q."""
    w, x, y, z = ca.vertsplit(2 * quaternion / ca.sumsqr(quaternion))
    return ca.blockcat([[-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])


class _Seat(NamedTuple):
    """A joint of a body with a pose yet to be determined.

    Attributes:
        section: world pose of the section, or the place in another body or the world, that holds the body.
        place: pose of the joint in the body.
        held: directions that it holds; the axes of section and place agree in a closed joint.
    """

    section: NumericPose
    place: NumericPose
    held: HeldDirections


@dataclass(frozen=True)
class UnloadedScene:
    """Poses of rods and bodies in the unloaded scene."""

    scene: scenes.Scene
    rods: Mapping[str, DiscreteRod]
    _shapes: dict[str, Shape] = field(default_factory=dict, repr=False)
    _sections: dict[tuple[str, float], NumericPose] = field(default_factory=dict, repr=False)
    _bodies: dict[str, FloatingFrame] = field(default_factory=dict, repr=False)

    @cached_property
    def records(self) -> dict[str, scenes.Rod]:
        """Rods of the scene by name."""
        return {rod.name: rod for rod in self.scene.rods}

    @cached_property
    def carried(self) -> list[scenes.Rod]:
        """Rods that start on other rods."""
        return [rod for rod in self.scene.rods if rod.base.rod is not None]

    def floating_base(self, rod: str) -> FrameName | None:
        """The floating frame of a rod's base; None if the base rests in the world."""
        base = self.records[rod].base
        if base.rod is None and not base.free and rod not in self.scene.jointed_bases:
            return None
        return FrameName("rod", rod)

    @cached_property
    def floating_rods(self) -> list[scenes.Rod]:
        """Rods whose bases float: rods that others carry, and rods that nothing holds."""
        return [rod for rod in self.scene.rods if self.floating_base(rod.name) is not None]

    @cached_property
    def frames(self) -> dict[FrameName, FloatingFrame]:
        """Floating frames: bases of rods in the order of the scene, then bodies."""
        frames = {}
        for rod in self.floating_rods:
            name = FrameName("rod", rod.name)
            unit = self.rods[rod.name].energy_unit
            start = self.base(rod.name)
            frames[name] = FloatingFrame(None, unit, rod.length, start)
        for body in self.scene.bodies:
            if body.name not in self.riding:
                frames[FrameName("body", body.name)] = self.body_frame(body.name)
        return frames

    @cached_property
    def riding(self) -> dict[str, int]:
        """Index, in the scene's list, of the joint of each body that rides on a section of a rod, by body.

        Such a body has one joint, which leaves nothing free: its pose follows from the pose of the section and is not
        an unknown, and loads on it act on the section. Bodies with obstacles, which push all rods, and bodies with a
        given initial velocity, which need not be the section's, float instead.
        """
        borne = {obstacle.body for obstacle in self.scene.obstacles}
        pushed = {velocity.owner for velocity in self.scene.velocities if velocity.rod is None}
        joints: dict[str | None, list[int]] = defaultdict(list)
        for index, joint in enumerate(self.scene.joints):
            for place in joint.places:
                joints[place.body].append(index)
        return {
            body: indices[0]
            for body, indices in joints.items()
            if body is not None and len(indices) == 1 and body not in borne | pushed and self._is_rigid(indices[0])
        }

    def _is_rigid(self, index: int) -> bool:
        """Whether a joint fixes a body to a section that is no base."""
        joint = self.scene.joints[index]
        if joint.carries is not None or joint.holds_base:
            return False
        return JOINT_KINDS[joint.kind].directions(joint) is CLAMPED

    def base(self, rod: str) -> NumericPose:
        """World pose of a rod's base."""
        record = self.records[rod]
        for joint in self.scene.joints:
            # The base follows the body, unless joints at such bases are all that places the body.
            if joint.rod == rod and joint.holds_base and joint.body is not None and self._placing_joints(joint.body):
                return _turned(self.body_frame(joint.body).start.then(place_of(joint)), joint, record)
        own = NumericPose(*base_pose(record))
        carrier = record.base.rod
        if carrier is None:
            return own
        # The pose of a carried rod is given in the section of its carrier.
        return self.section(carrier, record.base.at).then(own)

    def section(self, rod: str, at: float) -> NumericPose:
        """World pose of a section of a rod; it is kept, since bodies and joints use the same sections."""
        if (rod, at) not in self._sections:
            discrete_rod = self.rods[rod]
            if rod not in self._shapes:
                unknowns = ca.DM.zeros(discrete_rod.size)
                self._shapes[rod] = shape(discrete_rod, unknowns, discrete_rod.properties.ratio)
            node = discrete_rod.grid.node_at(at)
            rod_shape = self._shapes[rod]
            in_base = numeric(Pose(rod_shape.position_at(node), rod_shape.quaternion[:, node]))
            unit_quaternion = in_base.quaternion / np.linalg.norm(in_base.quaternion)
            self._sections[rod, at] = self.base(rod).then(NumericPose(in_base.position, unit_quaternion))
        return self._sections[rod, at]

    def plane(self, rod: str) -> NumericPose | None:
        """World pose of the base of a rod that never leaves its x–z plane; None if the rod or its carrier may."""
        record = self.records[rod]
        # A free rod may be pushed out of its plane.
        if record.base.free or not stays_in_plane(self.rods[rod].properties):
            return None
        own = self.base(rod)
        if rod in self.scene.jointed_bases and not self._base_keeps_plane(rod):
            return None
        carrier = record.base.rod
        if carrier is None:
            return own
        plane_of_carrier = self.plane(carrier)
        if plane_of_carrier is None or not same_plane(plane_of_carrier, own, record.length):
            return None
        return own

    def base_joint(self, rod: str) -> tuple[int, FloatArray] | None:
        """Index in the scene's list of the joint at a rod's base, if without body, and its rotation; else None.

        The rotation turns the axes of the held section, the carrying one or a base in the world, into the axes
        that the axis of the joint is in, shape (3, 3).
        """
        index = self.scene.base_joints.get(rod)
        if index is None:
            return None
        return index, np.eye(3) if self.records[rod].base.rod is not None else self.base(rod).rotation

    def _base_keeps_plane(self, rod: str) -> bool:
        """Whether the joint at a base, and the body that it may be on, keep its rod in the x–z plane of the base."""
        found = self.base_joint(rod)
        if found is not None:
            joint = self.scene.joints[found[0]]
            return confines(JOINT_KINDS[joint.kind].held(joint, found[1]))
        (joint,) = [own for own in self.scene.joints if own.rod == rod and own.holds_base]
        assert joint.body is not None, "of a base without body the joint is known"
        if not confines(JOINT_KINDS[joint.kind].directions(joint)):
            return False
        return self._stays_in_plane(joint.body, self.base(rod).rotation[:, 1])

    def _stays_in_plane(self, body: str, normal: FloatArray, beyond: frozenset[str] = frozenset()) -> bool:
        """Whether joints to the world, or to other bodies that stay in a plane, keep a body in this plane.

        Args:
            body: name of the body.
            normal: unit normal of the plane, world axes, shape (3,).
            beyond: bodies that do not count as keeping it, since it keeps them.
        """
        for joint in self.scene.joints:
            ends = {place.body for place in joint.places} | ({None} if joint.body is None else set())
            if joint.carries is None or body not in ends or ends & beyond:
                continue
            place = self.body_frame(joint.carries.body).start.then(place_of(joint.carries))
            if not confines(JOINT_KINDS[joint.kind].directions(joint), place.rotation.T @ normal):
                continue
            (other,) = ends - {body}
            if other is None or self._stays_in_plane(other, normal, beyond | {body}):
                return True
        return False

    @cached_property
    def all_in_parallel_planes(self) -> bool:
        """Whether all rods stay in parallel planes, so that bodies turn about one axis."""
        normals = []
        for rod in self.records:
            plane = self.plane(rod)
            if plane is None:
                return False
            normals.append(plane.rotation[:, 1])
        # The norm of the cross product of two unit normals is the sine of the angle between the planes.
        sines = [np.linalg.norm(np.cross(normals[0], normal)) for normal in normals]
        return all(sine <= FLAT for sine in sines)

    def body_frame(self, name: str) -> FloatingFrame:
        """A body's frame in its mean pose over the unloaded rods, in units of the stiffest and the longest rod."""
        if name not in self._bodies:
            (body,) = [body for body in self.scene.bodies if body.name == name]
            self._bodies[name] = self._new_body_frame(body)
        return self._bodies[name]

    def _new_body_frame(self, body: scenes.Body) -> FloatingFrame:
        joints = self._joints_of(body.name)
        unit, length = self.units(self.rods_of(body.name))
        placing = self._placing_joints(body.name) or [joint for joint in joints if joint.carries is None]
        seats = [self._seat(joint, body.name) for joint in placing]
        start = self._closed(seats, length)
        if start is None:
            # Joints to other bodies and to the world do not give way, as rods do.
            rigid = [seat for joint, seat in zip(placing, seats, strict=True) if joint.carries is not None] or seats
            start = self._closed(rigid, length) or self._mean_pose(rigid, length)
        return FloatingFrame(body, unit, length, start)

    def rods_of(self, body: str) -> list[str]:
        """The rods to which joints tie a body; all rods if no joint does."""
        return [joint.rod for joint in self._joints_of(body) if joint.rod] or list(self.rods)

    def _joints_of(self, body: str) -> list[scenes.Joint]:
        return [joint for joint in self.scene.joints if body in [place.body for place in joint.places]]

    def units(self, rods: Sequence[str]) -> tuple[float, float]:
        """The largest EI/ℓ, J, and the largest length, m, of some rods, or of all rods if none is named."""
        discrete = [self.rods[name] for name in rods or self.rods]
        unit = max(rod.energy_unit for rod in discrete)
        return unit, max(rod.properties.length for rod in discrete)

    def _placing_joints(self, body: str) -> list[scenes.Joint]:
        """Joints that determine the unloaded pose of a body.

        These are joints at rods that do not start on bodies, in the world, and at bodies that are placed before it.
        """
        rank = self._ranks.get(body, len(self._ranks))
        placing = []
        for joint in self.scene.joints:
            names = [place.body for place in joint.places]
            if body not in names:
                continue
            others = [self._ranks.get(name, len(self._ranks)) for name in names if name != body]
            if joint.rod:
                says_where = not self.starts_on_body(joint.rod)
            else:
                says_where = all(other < rank for other in others)
            if says_where:
                placing.append(joint)
        return placing

    @cached_property
    def _ranks(self) -> dict[str | None, int]:
        """How many joints of bodies lie between each body and the world or a rod that does not start on a body."""
        ranks: dict[str | None, int] = {}
        at_rods = [joint for joint in self.scene.joints if joint.carries is None and joint.body is not None]
        grounded = [joint.body for joint in at_rods if not self.starts_on_body(joint.rod)]
        grounded += [joint.carries.body for joint in self.scene.joints if joint.carries and joint.body is None]
        # If nothing else places a body, the rods that start on it do.
        for placed_first in (grounded, [joint.body for joint in at_rods]):
            ranks = dict.fromkeys(placed_first, 0) | ranks
            for rank in range(1, len(self.scene.bodies)):
                for joint in self.scene.joints:
                    names = [place.body for place in joint.places]
                    if any(ranks.get(name) == rank - 1 for name in names):
                        ranks |= {name: rank for name in names if name not in ranks}
        return ranks

    def _seat(self, joint: scenes.Joint, body: str) -> _Seat:
        """A joint from the side of the body, whose pose is to be determined."""
        held = JOINT_KINDS[joint.kind].directions(joint)
        place = place_of(joint)
        if joint.carries is None:
            return _Seat(self.section(joint.rod, joint.at), place, held)
        carried = place_of(joint.carries)
        if joint.carries.body == body:
            carrier = IDENTITY if joint.body is None else self.body_frame(joint.body).start
            return _Seat(carrier.then(place), carried, held)
        return _Seat(self.body_frame(joint.carries.body).start.then(carried), place, held)

    def starts_on_body(self, rod: str) -> bool:
        """Whether a joint holds the base of a rod, or of a rod that carries it, to a body."""
        carrier = self.records[rod].base.rod
        if carrier is not None:
            return self.starts_on_body(carrier)
        return any(joint.rod == rod and joint.holds_base and joint.body is not None for joint in self.scene.joints)

    def _closed(self, seats: list[_Seat], length: float) -> NumericPose | None:
        """Pose of a body near the mean pose that closes all its joints; None if there is none.

        Newton's method takes the smallest change of the pose that closes the linearised joints. Directions that a joint
        leaves free, such as the turn about its axis, need not agree with the section.

        Args:
            seats: the joints of the body.
            length: length of the longest of their rods, m.
        """
        pose = self._mean_pose(seats, length)
        before = np.inf
        for correction in range(MOST_CORRECTIONS):
            gaps = [self._gap(seat, pose, length) for seat in seats]
            rows = np.concatenate([rows for rows, _, _ in gaps])
            largest = float(np.abs(rows).max(initial=0.0))
            if largest <= CLOSED:
                return pose if all(agrees for _, _, agrees in gaps) else None
            if correction >= FIRST_CORRECTIONS and largest > STALLED * before:
                break
            before = largest
            derivatives = np.vstack([derivatives for _, derivatives, _ in gaps])
            change, *_ = np.linalg.lstsq(derivatives, -rows, rcond=FLAT)
            position = pose.position + length * change[3:]
            pose = NumericPose(position, quaternion_product(quaternion_about(change[:3]), pose.quaternion))
        return None

    def _gap(self, seat: _Seat, pose: NumericPose, length: float) -> tuple[FloatArray, FloatArray, bool]:
        """Dimensionless gap of a joint for a pose of its body.

        Args:
            seat: the joint.
            pose: world pose of the body.
            length: unit of displacements, m.

        Returns:
            displacements along held directions and sines of turns about them, shape (k,); their derivatives by a turn
            of the body about its origin and by its displacement over the length, world axes, shape (k, 6); whether the
            held axes of section and place point the same way.
        """
        section, place, held = seat
        arm = pose.rotation @ place.position
        to_section = section.rotation.T
        shift = to_section @ (pose.position + arm - section.position) / length
        # The pose of the place in the axes of the section: the identity if the joint is closed and not turned.
        turned = to_section @ pose.rotation @ place.rotation
        by_turn = [_axial(cross @ turned + turned.T @ cross) / 2.0 for cross in map(cross_matrix, np.eye(3))]
        of_position = np.hstack([to_section @ cross_matrix(-arm) / length, to_section])
        of_rotation = np.hstack([np.column_stack(by_turn) @ to_section, np.zeros((3, 3))])
        # The sine of half a turn vanishes as well: held axes must also point the same way.
        count = held.rotations.shape[1]
        weights = count * np.eye(3) - 2.0 * held.rotations @ held.rotations.T
        rows = np.concatenate([held.positions.T @ shift, held.rotations.T @ _axial(turned - turned.T) / 2.0])
        derivatives = np.vstack([held.positions.T @ of_position, held.rotations.T @ of_rotation])
        agrees = bool(abs(np.trace(weights @ turned) - np.trace(weights)) <= FLAT)
        return rows, derivatives, agrees

    def _mean_pose(self, seats: list[_Seat], length: float) -> NumericPose:
        """Mean of the poses of a body that close each joint alone.

        The rotation brings the arms of all joints, and the orientations of joints that hold one, nearest to the
        sections in the sense of least squares: G. Wahba, *SIAM Review* 7 (1965) 409, solved by a singular value
        decomposition.

        Args:
            seats: the joints of the body.
            length: weight of an orientation against an arm, m.
        """
        arms = np.array([seat.place.position for seat in seats])
        points = np.array([seat.section.position for seat in seats])
        mean_arm = arms.mean(axis=0)
        mean_point = points.mean(axis=0)
        correlation = (points - mean_point).T @ (arms - mean_arm)
        for section, place, held in seats:
            # A joint that leaves the orientation free contributes its arm alone.
            if held.rotations.size:
                in_body = NumericPose(np.zeros(3), place.quaternion)
                wanted = section.then(in_body.inverse)
                correlation = correlation + length**2 * wanted.rotation
        left, _, right = np.linalg.svd(correlation)
        # The sign makes it a rotation where the nearest orthogonal matrix is a reflection.
        sign = np.sign(np.linalg.det(left @ right))
        rotation = left @ np.diag([1.0, 1.0, sign]) @ right
        position = mean_point - rotation @ mean_arm
        return NumericPose(position, matrix_to_quaternion(rotation))


def _turned(closed: NumericPose, joint: scenes.Joint, rod: scenes.Rod) -> NumericPose:
    """The base of a rod on a body, turned towards the rod's own orientation as far as the joint leaves it free.

    Args:
        closed: the base with the axes of the joint, world pose.
        joint: the joint.
        rod: the rod; with the default orientation, the axes of the world, its base has the axes of the joint.
    """
    kind = JOINT_KINDS[joint.kind]
    said = rod.base.tangent is not None or rod.base.quaternion != scenes.Base().quaternion
    if not said or kind.coordinate(joint, np.eye(3)) is not None:
        return closed
    held = kind.directions(joint).rotations
    wanted = closed.inverse.then(NumericPose(*base_pose(rod))).quaternion
    if held.shape[1] == 2:
        axis = np.cross(held[:, 0], held[:, 1])
        wanted = np.concatenate([wanted[:1], axis * (axis @ wanted[1:])])
    length = np.linalg.norm(wanted)
    # If the two orientations differ by half a turn across the axis, all turns about the axis are equally near.
    if held.shape[1] not in (0, 2) or length < FLAT:
        return closed
    return closed.then(NumericPose(np.zeros(3), wanted / length))


def same_plane(first: NumericPose, second: NumericPose, length: float, *, tilted: bool = False) -> bool:
    """Whether the x–z planes of two frames coincide; ``tilted``: whether the first holds the second's origin."""
    normal = first.rotation[:, 1]
    distance = abs(float(normal @ (second.position - first.position)))
    if distance > FLAT * length:
        return False
    if tilted:
        return True
    sine = float(np.linalg.norm(np.cross(normal, second.rotation[:, 1])))
    return sine <= FLAT


def _axial(matrix: FloatArray) -> FloatArray:
    """The vector v of an antisymmetric matrix v^, shape (3,)."""
    return np.array([matrix[2, 1], matrix[0, 2], matrix[1, 0]])
