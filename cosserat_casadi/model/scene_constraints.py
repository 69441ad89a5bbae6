"""The constraints of a scene: supports, bases of carried rods and joints, each between a section and a frame.

This module settles what does not depend on the unknowns, from the poses of the unloaded scene: the pose that closes
each constraint, and the directions that it holds. Docs/theory.md, section 8.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.held_directions import (
    CLAMPED,
    NORMAL,
    across_plane,
    in_any_plane,
    in_plane,
    keeps_plane,
    upright,
)
from cosserat_casadi.constraints.joint_coordinate import held_along, moves_in_plane
from cosserat_casadi.constraints.joints import JOINT_KINDS
from cosserat_casadi.constraints.section_constraint import HeldDirections, SectionConstraint
from cosserat_casadi.constraints.supports import SUPPORT_KINDS
from cosserat_casadi.constraints.tip_holder import TipHolder, place_of
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.numbers import as_matrix, as_vector, is_symbolic
from cosserat_casadi.maths.pose import IDENTITY, NumericPose, Pose, written_pose
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.floating_frames import FrameName, UnloadedScene, same_plane
from cosserat_casadi.model.homotopy import Compliance
from cosserat_casadi.model.loops_in_plane import closing_joints
from cosserat_casadi.model.scene_rods import base_pose, unit_quaternion, written_base_pose
from cosserat_casadi.scene.constraint_records import JointRecord

SUPPORT_WEIGHT = 2.0
"""Step weight of the multipliers of a support: a rod pulled to a pose has many equilibria close to each other."""

FORCE_WEIGHT = 0.1
"""Step weight of other multipliers and of tensions: a unit bends a rod by about 0.1 rad; Euler's load is π² EI/ℓ²."""

STILL = Compliance(power=1)
"""Compliance of a support of a rod that starts in the world: it falls linearly."""

ASSEMBLED = Compliance(power=3)
"""Compliance of constraints that close an assembly: springs between rods that do not fit have to be stiff early.
"""

RELEASED = Compliance(power=3)
"""Spring on the coordinate of a joint, even in closed assemblies: at first nothing else acts along the coordinate."""


SAME_AXIS = 1e-14
"""Distance of unit vectors below which they differ by rounding alone."""


class CarriedPlace(NamedTuple):
    """A place of a body that a joint holds.

    Attributes:
        frame: frame of the body.
        pose: pose of the place in the body; expressions if parameters set it.
    """

    frame: FrameName
    pose: NumericPose | Pose


@dataclass(frozen=True, eq=False)
class PlacedConstraint:
    """A constraint of a scene.

    Attributes:
        constraint: the mechanics of the constraint.
        rod: name of the rod with the held section; empty if it holds a body.
        node: node of that section.
        carried: the body that it holds instead of a section, with the place in it.
        frame: the floating frame on the other side; None for the world.
        joint: index of the joint in the scene's list; None for supports and clamped bases.
        at_base: whether it holds a base to the pose that the scene, or an input, gives it in the world.
        held_by_plane: directions that the plane of its rods already holds; None if it holds them all itself.
        where: path of the scene's table.
        what: the two sides in words.
        compliance: its compliance along the load path.
        step_weight: how much a unit of its multipliers counts in the length of a continuation step.
    """

    constraint: SectionConstraint
    rod: str
    node: int
    frame: FrameName | None
    where: str
    what: str
    carried: CarriedPlace | None = None
    compliance: Compliance = ASSEMBLED
    step_weight: float = FORCE_WEIGHT
    joint: int | None = None
    at_base: bool = False
    held_by_plane: HeldDirections | None = None

    @property
    def size(self) -> int:
        """Number of multipliers."""
        return self.constraint.size

    @property
    def held_sizes(self) -> tuple[int, int]:
        """Numbers of held displacements and of held rotations."""
        held = self.constraint.held
        return held.positions.shape[1], held.rotations.shape[1]

    @property
    def coordinate_scale(self) -> float:
        """Unit of the coordinate as an unknown: a radian, or the length of the rod, m."""
        coordinate = self.constraint.coordinate
        assert coordinate is not None, "asked for of a joint with a coordinate"
        return 1.0 if coordinate.turns else self.constraint.length

    @property
    def along_coordinate(self) -> int:
        """Index, among the multipliers, of the multiplier along the coordinate."""
        coordinate = self.constraint.coordinate
        assert coordinate is not None, "asked for of a joint with a coordinate"
        # The last of the displacements, or of the rotations, which come last.
        return self.size - 1 if coordinate.turns else self.constraint.held.positions.shape[1] - 1

    @property
    def closes_assembly(self) -> bool:
        """Whether the constraint ties rods together or a carried rod to the world; not for a rod that starts there."""
        return self.compliance is ASSEMBLED


def written_constraints(
    placed: list[PlacedConstraint], nominal: scenes.Scene, scene: scenes.Scene
) -> list[PlacedConstraint]:
    """Constraints of a scene with other numbers, or expressions, at the poses of that scene.

    They hold the same directions as the constraints of the nominal scene, in its scaling.

    Args:
        placed: the constraints of the nominal scene.
        nominal: the nominal scene.
        scene: the scene with other numbers.
    """
    after = _given_places(scene)
    # Sections of carriers and of joints move along their rods; supports hold tips.
    sections: dict[str, Any] = {f"joints[{i}]": joint.at for i, joint in enumerate(scene.joints)}
    sections |= {_base_path(scene, i): rod.base.at for i, rod in enumerate(scene.rods) if rod.base.rod is not None}
    axes_before = _axes(nominal)
    axes = _axes(scene)
    constraints = []
    for entry in placed:
        pose = after[entry.where]
        closing = entry.constraint.pose
        assert isinstance(closing, NumericPose)
        # The sign of a support's quaternion tells in which direction its tip is turned: it is kept.
        if entry.compliance is not STILL:
            pose = _nearer_pose(pose, closing)
        at = sections.get(entry.where, entry.constraint.at)
        turn = None
        if entry.where in axes_before:
            turn = _turn_of_axis(axes_before[entry.where], axes[entry.where])
        carried = entry.carried
        if carried is not None:
            carried = carried._replace(pose=after[_carried_path(entry.where)])
        constraint = replace(entry.constraint, at=at, pose=pose, turn=turn)
        constraints.append(replace(entry, constraint=constraint, carried=carried))
    return constraints


def _nearer_pose(pose: NumericPose | Pose, other: NumericPose) -> NumericPose | Pose:
    """A pose with the sign of its quaternion that is nearer to another pose: Q and −Q are one rotation."""
    if isinstance(pose, NumericPose):
        return pose if pose.quaternion @ other.quaternion >= 0 else NumericPose(pose.position, -pose.quaternion)
    near = ca.MX(ca.dot(pose.quaternion, other.quaternion))
    if not ca.symvar(near):
        # Only the position depends on parameters.
        return pose if float(ca.evalf(near)) >= 0 else Pose(pose.position, -pose.quaternion)
    return Pose(pose.position, ca.if_else(near < 0, -pose.quaternion, pose.quaternion))


def _axes(scene: scenes.Scene) -> dict[str, Matrix]:
    """Axes of supports and joints in the axes of the held sections, by the paths of their tables."""
    axes = {}
    rods = {rod.name: rod for rod in scene.rods}
    for where, holder, record in _holders(scene):
        axis = holder.axis(record)
        if axis is None:
            continue
        quaternion = unit_quaternion(record.orientation or (1.0, 0.0, 0.0, 0.0))
        if isinstance(record, JointRecord) and record.at_base:
            base = rods[record.rod]
            # The base on another rod has its axis in the carrying section already.
            quaternion = IDENTITY.quaternion if base.base.rod is not None else written_base_pose(base)[1]
        place = written_pose(np.zeros(3), quaternion)
        axes[where] = as_matrix(place.rotation).T @ as_matrix(as_vector(axis))
    return axes


def _holders(scene: scenes.Scene) -> Iterator[tuple[str, TipHolder[Any], Any]]:
    """Path of the table, mechanics and record of each support and joint."""
    for i, support in enumerate(scene.supports):
        yield f"supports[{i}]", SUPPORT_KINDS[support.kind], support
    for i, joint in enumerate(scene.joints):
        yield f"joints[{i}]", JOINT_KINDS[joint.kind], joint


def _turn_of_axis(before: Matrix, after: Matrix) -> Matrix | None:
    """Shortest rotation from the line of an axis to the line of another, in section axes, as a quaternion.

    It is None if the lines agree. Neither the length of an axis nor its sign matters.
    """
    old = ca.DM(before)
    unit_old = old / ca.norm_2(old)
    new = after
    if is_symbolic(new) and not ca.symvar(new):
        new = ca.evalf(new)
    unit_new = new / ca.norm_2(new)
    # The nearer one of the two directions of the line: no turn is more than a right angle.
    nearer = ca.if_else(ca.dot(unit_old, unit_new) < 0, -unit_new, unit_new)
    if not is_symbolic(nearer) and float(ca.norm_2(nearer - unit_old)) < SAME_AXIS:
        return None
    double = ca.vertcat(1 + ca.dot(unit_old, nearer), ca.cross(unit_old, nearer))
    return double / ca.norm_2(double)


def decisive_axes(unloaded: UnloadedScene) -> set[int]:
    """Indices of joints with an axis or orientation that decides which directions other joints of a plane hold."""
    scene = unloaded.scene
    closed = bool(closing_joints(unloaded))
    decisive = {
        i
        for i, joint in enumerate(scene.joints)
        if (closed and (joint.carries or joint.body) is not None) or len(list(_coplanar(unloaded, joint))) > 1
    }
    in_world = (*scene.supports, *filter(_is_in_world, scene.joints))
    held = {record.rod for record in in_world if _held_in_plane(unloaded, record, place_of(record))}
    for rod in held | {scene.joints[i].rod for i in decisive if scene.joints[i].rod}:
        decisive |= set(_hinges_below(unloaded, rod))
    return decisive


def _hinges_below(unloaded: UnloadedScene, rod: str) -> Iterator[int]:
    """Indices in the scene's list of hinges at the bases of a rod and its carriers, and of joints of bodies below."""
    if unloaded.starts_on_body(rod):
        yield from (index for index, joint in enumerate(unloaded.scene.joints) if joint.body or joint.carries)
    carried: str | None = rod
    while carried is not None:
        index = unloaded.scene.base_joints.get(carried)
        if index is not None:
            joint = unloaded.scene.joints[index]
            if JOINT_KINDS[joint.kind].directions(joint).rotations.shape[1] == 2:
                yield index
        carried = unloaded.records[carried].base.rod


def check_directions(placed: list[PlacedConstraint], unloaded: UnloadedScene) -> None:
    """Refuse numbers with which constraints hold other directions than in the nominal scene.

    Args:
        placed: the constraints of the nominal scene.
        unloaded: the scene with other numbers.

    Raises:
        SceneError: numbers take a constraint out of the plane of its rods, or into it; every such constraint is named.
    """
    problem = "holds other directions with these parameters: they take it out of the plane of its rods, or into it"
    refuse(
        [
            Problem(own.where, problem, "build a scene for each value")
            for own, written in zip(placed_constraints(unloaded), placed, strict=True)
            if own.held_sizes != written.held_sizes
        ]
    )


def _given_places(scene: scenes.Scene) -> dict[str, NumericPose | Pose]:
    """Poses that close the constraints of a scene as it gives them, by the paths of their tables."""
    places: dict[str, NumericPose | Pose] = {}
    for where, _, record in _holders(scene):
        quaternion = record.orientation or (1.0, 0.0, 0.0, 0.0)
        places[where] = written_pose(as_vector(record.position), unit_quaternion(quaternion))
        carried = getattr(record, "carries", None)
        if carried is not None:
            places[_carried_path(where)] = written_pose(
                as_vector(carried.position), unit_quaternion(carried.quaternion)
            )
    for i, rod in enumerate(scene.rods):
        if rod.base.rod is not None:
            # The scene gives the base in the section; the constraint needs the section in the frame of the base.
            places[_base_path(scene, i)] = written_pose(*written_base_pose(rod)).inverse
    return places


def _base_path(scene: scenes.Scene, index: int) -> str:
    """Path of the table that describes how the base of a rod is held: a joint's table, or the rod's."""
    joint = scene.base_joints.get(scene.rods[index].name)
    return f"rods[{index}].base" if joint is None else f"joints[{joint}]"


def _carried_path(where: str) -> str:
    """Path of the table with the place of a joint in the carried body."""
    return f"{where}.carries"


def placed_constraints(unloaded: UnloadedScene) -> list[PlacedConstraint]:
    """The constraints of a scene in the order of their multipliers.

    The order is: supports of rods that start in the world, bases of carried rods, joints, supports of carried rods.
    Joints of riding bodies are not constraints: the poses of these bodies follow from their sections.
    """
    scene = unloaded.scene
    supports = [_support(unloaded, i) for i in range(len(scene.supports))]
    supports += [_joint_in_world(unloaded, i) for i, joint in enumerate(scene.joints) if _is_in_world(joint)]
    # A support of a rod that starts in the world couples no rods: its multipliers follow the strains in x.
    still = [placed for placed in supports if not placed.closes_assembly]
    carried = [placed for placed in supports if placed.closes_assembly]
    bases = [_base(unloaded, rod) for rod in unloaded.carried]
    carried_by_rods = {scene.base_joints.get(rod.name) for rod in unloaded.carried}
    elsewhere = {*carried_by_rods, *unloaded.riding.values()}
    between = [i for i, joint in enumerate(scene.joints) if not _is_in_world(joint) and i not in elsewhere]
    closing = closing_joints(unloaded)
    joints = [_joint(unloaded, i, closing.get(i)) for i in between]
    return [*still, *bases, *joints, *carried]


@dataclass(frozen=True)
class _Section:
    """A section of a rod of the unloaded scene."""

    unloaded: UnloadedScene
    rod: str
    at: float = 1.0

    def held_to(
        self, target: NumericPose, directions: HeldDirections, frame: FrameName | None, words: tuple[str, str]
    ) -> PlacedConstraint:
        """The constraint of the section to a pose in a frame; ``words``: its path and its two sides."""
        discrete_rod = self.unloaded.rods[self.rod]
        where, what = words
        return PlacedConstraint(
            constraint=SectionConstraint(
                discrete_rod.properties.length, discrete_rod.energy_unit, self.at, directions, target
            ),
            rod=self.rod,
            node=discrete_rod.grid.node_at(self.at),
            frame=frame,
            where=where,
            what=what,
        )

    def nearer_sign(self, target: NumericPose, frame: FrameName | None) -> NumericPose:
        """A pose in a frame with the sign of its quaternion that is nearer to the section.

        Q and −Q are one rotation; the farther sign would turn the section by more than half a turn.
        """
        world_target = target if frame is None else self.unloaded.frames[frame].start.then(target)
        quaternion = self.unloaded.section(self.rod, self.at).quaternion
        if world_target.quaternion @ quaternion >= 0:
            return target
        return NumericPose(target.position, -target.quaternion)


def _support(unloaded: UnloadedScene, index: int) -> PlacedConstraint:
    """The support of a rod's tip at a pose in the world."""
    support = unloaded.scene.supports[index]
    rod = support.rod
    words = (f"supports[{index}]", f"the tip of {rod!r} at its support")
    tip = _Section(unloaded, rod)
    return _held_in_world(tip, support, SUPPORT_KINDS[support.kind].directions(support), words)[0]


def _is_in_world(joint: scenes.Joint) -> bool:
    """Whether a joint holds a section other than a base in the world."""
    return joint.carries is None and joint.body is None and not joint.holds_base


def _joint_in_world(unloaded: UnloadedScene, index: int) -> PlacedConstraint:
    """The joint of a rod's section in the world."""
    joint = unloaded.scene.joints[index]
    words = (f"joints[{index}]", f"{_section_in_words(joint)} of {joint.rod!r} at its joint in the world")
    section = _Section(unloaded, joint.rod, joint.at)
    placed, normal = _held_in_world(section, joint, JOINT_KINDS[joint.kind].directions(joint), words)
    return _with_coordinate(placed, unloaded, index, place_of(joint).rotation, normal)


def _held_in_world(
    section: _Section, record: scenes.Support | scenes.Joint, directions: HeldDirections, words: tuple[str, str]
) -> tuple[PlacedConstraint, FloatArray | None]:
    """The constraint of a rod's section to the pose of a record in the world; ``words``: its path and its two sides.

    Returns:
        the constraint, and the normal of the plane that the rod stays in, in the axes of the place; None in space.
    """
    unloaded = section.unloaded
    rod = section.rod
    target = place_of(record)
    floats = unloaded.floating_base(rod) is not None
    normal = None
    held_by_plane = None
    if _held_in_plane(unloaded, record, target):
        normal = target.rotation.T @ unloaded.base(rod).rotation[:, 1]
        # Directions that turn with the pose are given in its axes, others in the axes of the base.
        own_normal = normal if directions.turn_with_pose else NORMAL
        held_by_plane = across_plane(directions, own_normal)
        directions = in_plane(directions, own_normal)
    if floats:
        placed = section.held_to(section.nearer_sign(target, None), directions, None, words)
        return replace(placed, held_by_plane=held_by_plane), normal
    # The sign of the quaternion in the scene tells in which direction the tip is to be turned.
    placed = section.held_to(target, directions, None, words)
    placed = replace(placed, compliance=STILL, step_weight=SUPPORT_WEIGHT, held_by_plane=held_by_plane)
    return placed, normal


def _held_in_plane(unloaded: UnloadedScene, record: scenes.Support | scenes.Joint, target: NumericPose) -> bool:
    """Whether a rod stays in a plane that contains its held pose in the world."""
    plane = unloaded.plane(record.rod)
    if plane is None:
        return False
    length = unloaded.records[record.rod].length
    return same_plane(plane, target, length, tilted=record.orientation is None)


def _section_in_words(joint: scenes.Joint) -> str:
    """The section of a joint in words."""
    if joint.holds_base:
        return "the base"
    return "the tip" if joint.at == 1.0 else f"X = {joint.at:g}"


def _base(unloaded: UnloadedScene, rod: scenes.Rod) -> PlacedConstraint:
    """The constraint of a rod's base to a section of another rod."""
    carrier = rod.base.rod
    assert carrier is not None
    frame = FrameName("rod", rod.name)
    index = list(unloaded.records).index(rod.name)
    words = (_base_path(unloaded.scene, index), f"the base of {rod.name!r} on {carrier!r}")
    joint = unloaded.base_joint(rod.name)
    section = _Section(unloaded, carrier, rod.base.at)
    # The scene gives the base in the section; the constraint needs the section in the frame of the base.
    section_in_base = NumericPose(*base_pose(rod)).inverse
    target = section.nearer_sign(section_in_base, frame)
    if joint is None:
        return section.held_to(target, CLAMPED, frame, words)
    number, rotation = joint
    record = unloaded.scene.joints[number]
    placed = section.held_to(target, JOINT_KINDS[record.kind].held(record, rotation), frame, words)
    # The base moves along the axis in the section; so the section moves in the opposite direction in the base.
    return _with_coordinate(placed, unloaded, number, -rotation)


def _with_coordinate(
    placed: PlacedConstraint,
    unloaded: UnloadedScene,
    index: int,
    rotation: FloatArray,
    normal: FloatArray | None = None,
) -> PlacedConstraint:
    """A joint with its coordinate, if something acts along it.

    Args:
        placed: the constraint without the coordinate.
        unloaded: the scene.
        index: index of the joint in the scene's list.
        rotation: turns the axes of the section into the axes of the joint, shape (3, 3).
        normal: unit normal, in the axes of the section, of the plane in which its rod stays; None for a rod in space.

    Raises:
        SceneError: a rod in a plane would have to leave it.
    """
    joint = unloaded.scene.joints[index]
    coordinate = JOINT_KINDS[joint.kind].coordinate(joint, rotation)
    if coordinate is None:
        return replace(placed, joint=index)
    if normal is not None and not moves_in_plane(coordinate, normal):
        problem = f"would take {joint.rod!r} out of the plane that it bends in"
        raise SceneError(Problem(f"joints[{index}].axis", problem, "admit its other bending and torsion"))
    held = held_along(coordinate, normal)
    held_by_plane = None if normal is None else across_plane(held_along(coordinate, None), normal)
    constraint = replace(placed.constraint, held=held, coordinate=coordinate)
    return replace(placed, joint=index, constraint=constraint, held_by_plane=held_by_plane)


def _joint(unloaded: UnloadedScene, index: int, normal: FloatArray | None) -> PlacedConstraint:
    """The joint of a rod's section to a body, of a base to the world, or of a body to another body or the world.

    Args:
        unloaded: the scene.
        index: index of the joint in the scene's list.
        normal: normal (3,), in the axes of section or place, of the plane in which others keep its body; or None.
    """
    joint = unloaded.scene.joints[index]
    if joint.carries is not None:
        return _joint_of_bodies(unloaded, index, normal)
    words = (f"joints[{index}]", f"{_section_in_words(joint)} of {joint.rod!r} at {joint.body or 'its place'!r}")
    section = _Section(unloaded, joint.rod, joint.at)
    if joint.at_base:
        # The joint's coordinate counts from the pose that the scene, or an input, gives the base.
        base = unloaded.base_joint(joint.rod)
        assert base is not None
        placed = section.held_to(IDENTITY, JOINT_KINDS[joint.kind].held(joint, base[1]), None, words)
        return replace(_with_coordinate(placed, unloaded, index, base[1]), at_base=True)
    assert joint.body is not None, "joints in the world are placed with the supports"
    frame = FrameName("body", joint.body)
    target = section.nearer_sign(place_of(joint), frame)
    coplanar = list(_coplanar(unloaded, joint))
    in_a_plane = normal is not None or (len(coplanar) > 1 and coplanar[0] != joint)
    directions = JOINT_KINDS[joint.kind].directions(joint)
    held_by_plane = None
    if in_a_plane:
        held_by_plane = across_plane(directions)
        directions = in_plane(directions)
    elif len(coplanar) > 1:
        # If several planar rods hold a body in their plane, only the first one keeps it there.
        directions = upright(directions)
    placed = replace(section.held_to(target, directions, frame, words), held_by_plane=held_by_plane)
    return _with_coordinate(placed, unloaded, index, target.rotation, NORMAL if in_a_plane else None)


def _joint_of_bodies(unloaded: UnloadedScene, index: int, normal: FloatArray | None) -> PlacedConstraint:
    """The joint of a body to another body, or to the world."""
    joint = unloaded.scene.joints[index]
    assert joint.carries is not None, "asked for of a joint that carries a body"
    carried = FrameName("body", joint.carries.body)
    frame = None if joint.body is None else FrameName("body", joint.body)
    target = place_of(joint)
    place = place_of(joint.carries)
    carrier = IDENTITY if frame is None else unloaded.frames[frame].start
    # Q and −Q are one rotation: the place gets the sign that is nearer to its pose in the closed joint.
    wanted = carrier.then(target)
    if unloaded.frames[carried].start.then(place).quaternion @ wanted.quaternion < 0:
        target = NumericPose(target.position, -target.quaternion)
    unit, length = unloaded.units([])
    directions = JOINT_KINDS[joint.kind].directions(joint)
    held_by_plane = None
    if normal is not None:
        held_by_plane = across_plane(directions, normal)
        directions = in_any_plane(directions, normal)
    placed = PlacedConstraint(
        constraint=SectionConstraint(length, unit, 0.0, directions, target),
        rod="",
        node=0,
        frame=frame,
        where=f"joints[{index}]",
        what=f"{joint.carries.body!r} at {joint.body or 'its place in the world'!r}",
        carried=CarriedPlace(carried, place),
        held_by_plane=held_by_plane,
    )
    return _with_coordinate(placed, unloaded, index, target.rotation, normal)


def _coplanar(unloaded: UnloadedScene, joint: scenes.Joint) -> Iterator[scenes.Joint]:
    """Joints of this joint's body with planar rods of one plane, in their order; none if its rod is not planar."""
    plane = unloaded.plane(joint.rod) if joint.rod else None
    if joint.body is None or plane is None or not _moves_in_plane(joint) or unloaded.starts_on_body(joint.rod):
        return
    for candidate in unloaded.scene.joints:
        if not candidate.rod or candidate.body != joint.body or not _moves_in_plane(candidate):
            continue
        # A rod that starts on the body has its base fixed there, and does not hold the body.
        if unloaded.starts_on_body(candidate.rod):
            continue
        if _shares_plane(unloaded, joint, plane, candidate):
            yield candidate


def _moves_in_plane(joint: scenes.Joint) -> bool:
    """Whether a joint keeps its body in the rod's x–z plane, as a hinge about its normal or a slide along it does."""
    return keeps_plane(JOINT_KINDS[joint.kind].directions(joint))


def _shares_plane(unloaded: UnloadedScene, joint: scenes.Joint, plane: NumericPose, candidate: scenes.Joint) -> bool:
    """Whether two joints hold a body in the same plane, both in the world and in the body."""
    second = unloaded.plane(candidate.rod)
    length = unloaded.records[joint.rod].length
    if second is None or not same_plane(plane, second, length):
        return False
    first_joint = place_of(joint)
    second_joint = place_of(candidate)
    # Normals may be opposite if they are opposite both in the world and in the body.
    in_world = float(plane.rotation[:, 1] @ second.rotation[:, 1])
    in_body = float(first_joint.rotation[:, 1] @ second_joint.rotation[:, 1])
    if in_world * in_body <= 0:
        return False
    return same_plane(first_joint, second_joint, length)
