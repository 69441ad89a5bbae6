"""The constraints of a scene: supports, bases of carried rods, joints; each put in its place.

What does not depend on the unknowns is settled here, from the poses of the unloaded scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints import held_directions as held
from cosserat_casadi.constraints.section_constraint import HeldDirections, SectionConstraint
from cosserat_casadi.maths.pose import IDENTITY, NumericPose
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.floating_frames import FLAT, FrameName, UnloadedScene, same_plane
from cosserat_casadi.model.homotopy import Compliance
from cosserat_casadi.model.rods import base_pose

SUPPORT_WEIGHT = 2.0
"""Step weight of the multipliers of a support: a rod that is pulled to a place has many equilibria there, close by."""

FORCE_WEIGHT = 0.1
"""Step weight of other multipliers and of tensions: one unit bends a rod by about 0.1 rad; Euler's load is π² EI/ℓ²."""

STILL = Compliance(power=1)
"""A support of a rod that starts in the world yields in proportion."""

ASSEMBLED = Compliance(power=3)
"""What closes an assembly is stiff early: springs that hold rods that do not fit are far stiffer than the rods."""


@dataclass(frozen=True)
class PlacedConstraint:
    """A constraint of a scene.

    Attributes:
        constraint: what it holds.
        rod: name of the rod whose section it holds.
        node: node of that section.
        frame: the floating frame on the other side; None for the world.
        where: path of the scene's table.
        what: the two sides in words.
        compliance: how it yields on the way to the scene.
        step_weight: how much a unit of its multipliers counts in the length of a continuation step.
    """

    constraint: SectionConstraint
    rod: str
    node: int
    frame: FrameName | None
    where: str
    what: str
    compliance: Compliance = ASSEMBLED
    step_weight: float = FORCE_WEIGHT

    @property
    def size(self) -> int:
        """Number of multipliers."""
        return self.constraint.size

    @property
    def closes_assembly(self) -> bool:
        """Whether it holds rods to each other or a carried rod to the world, not a rod that starts in the world."""
        return self.compliance is ASSEMBLED


def placed_constraints(unloaded: UnloadedScene) -> list[PlacedConstraint]:
    """The constraints of a scene in the order of their multipliers.

    Supports of rods that start in the world, bases of carried rods, joints, then supports of carried rods.
    """
    supports = [_support(unloaded, i) for i in range(len(unloaded.scene.supports))]
    still = [placed for placed in supports if not placed.closes_assembly]
    carried = [placed for placed in supports if placed.closes_assembly]
    bases = [_base(unloaded, rod) for rod in unloaded.carried]
    joints = [_joint(unloaded, i) for i in range(len(unloaded.scene.joints))]
    return [*still, *bases, *joints, *carried]


def _support(unloaded: UnloadedScene, index: int) -> PlacedConstraint:
    support = unloaded.scene.supports[index]
    words = (f"supports[{index}]", f"the tip of {support.rod!r} at its support")
    turned = isinstance(support, scenes.ClampedSupport)
    quaternion = _array(support.quaternion) if isinstance(support, scenes.ClampedSupport) else IDENTITY.quaternion
    place = NumericPose(_array(support.position), quaternion)
    spatial, planar = held.SUPPORTS[support.kind]
    if unloaded.floating_base(support.rod) is None:
        in_plane = held.stays_in_plane(unloaded.rods[support.rod].properties)
        return _placed(
            unloaded, (support.rod, 1.0), None, place, planar if in_plane else spatial, words, STILL, SUPPORT_WEIGHT
        )
    plane = unloaded.plane(support.rod)
    length = unloaded.records[support.rod].length
    in_plane = plane is not None and same_plane(plane, place, length, tilted=not turned)
    near = _near(unloaded, (support.rod, 1.0), None, place)
    return _placed(unloaded, (support.rod, 1.0), None, near, planar if in_plane else spatial, words)


def _base(unloaded: UnloadedScene, rod: scenes.Rod) -> PlacedConstraint:
    """The base of a rod on a section of another: its frame offers the section the inverse of the base's pose."""
    carrier = rod.base.rod
    assert carrier is not None
    frame = FrameName("rod", rod.name)
    index = list(unloaded.records).index(rod.name)
    words = (f"rods[{index}].base", f"the base of {rod.name!r} on {carrier!r}")
    section = (carrier, rod.base.at)
    place = _near(unloaded, section, frame, NumericPose(*base_pose(rod)).inverse)
    return _placed(unloaded, section, frame, place, held.CLAMPED, words)


def _joint(unloaded: UnloadedScene, index: int) -> PlacedConstraint:
    joint = unloaded.scene.joints[index]
    frame = FrameName("body", joint.body)
    words = (f"joints[{index}]", f"the tip of {joint.rod!r} at {joint.body!r}")
    section = (joint.rod, 1.0)
    place = _near(unloaded, section, frame, _place(joint))
    return _placed(unloaded, section, frame, place, _joint_directions(unloaded, joint, place), words)


def _placed(
    unloaded: UnloadedScene,
    section: tuple[str, float],
    frame: FrameName | None,
    place: NumericPose,
    directions: HeldDirections,
    words: tuple[str, str],
    compliance: Compliance = ASSEMBLED,
    step_weight: float = FORCE_WEIGHT,
) -> PlacedConstraint:
    rod, at = section
    discrete_rod = unloaded.rods[rod]
    constraint = SectionConstraint(discrete_rod.properties, discrete_rod.energy_unit, at, directions, place)
    node = discrete_rod.grid.node_at(at)
    return PlacedConstraint(constraint, rod, node, frame, *words, compliance, step_weight)


def _near(
    unloaded: UnloadedScene, section: tuple[str, float], frame: FrameName | None, place: NumericPose
) -> NumericPose:
    """A place with the sign of its quaternion that is near the unloaded section."""
    wanted = place if frame is None else unloaded.frames[frame].start.then(place)
    quaternion = unloaded.section(*section).quaternion
    if wanted.quaternion @ quaternion >= 0:
        return place
    return NumericPose(place.position, -place.quaternion)


def _joint_directions(unloaded: UnloadedScene, joint: scenes.Joint, place: NumericPose) -> HeldDirections:
    """What a joint holds: of planar rods that hold one body in their plane, only the first keeps it there.

    Several such rods keep the body in the plane, and each of their joints turns about its normal alone.
    """
    together = list(_coplanar(unloaded, joint))
    follows_others = len(together) > 1 and together[0] != joint
    if isinstance(joint, scenes.PrismaticJoint):
        return held.prismatic_in_plane(joint.axis, place) if follows_others else held.prismatic(joint.axis, place)
    if isinstance(joint, scenes.RevoluteJoint):
        return held.PINNED_IN_PLANE if follows_others else held.revolute(joint.axis, place)
    if joint.kind == "fixed":
        return held.CLAMPED_IN_PLANE if follows_others else held.CLAMPED
    if follows_others:
        return held.PINNED_IN_PLANE
    return held.PINNED_UPRIGHT if len(together) > 1 else held.PINNED


def _coplanar(unloaded: UnloadedScene, joint: scenes.Joint) -> Iterator[scenes.Joint]:
    """Joints of the same body on planar rods of the same plane, in their order; none off a planar rod."""
    plane = unloaded.plane(joint.rod)
    if plane is None or not _moves_in_plane(joint):
        return
    for candidate in unloaded.scene.joints:
        same_body = candidate.body == joint.body
        if same_body and _moves_in_plane(candidate) and _shares_plane(unloaded, joint, plane, candidate):
            yield candidate


def _moves_in_plane(joint: scenes.Joint) -> bool:
    """Whether a joint leaves its body in the x–z plane of the tip: a hinge about its normal, a slide along it."""
    if not isinstance(joint, scenes.RevoluteJoint | scenes.PrismaticJoint):
        return True
    axis = _place(joint).rotation.T @ np.asarray(joint.axis)
    out_of_plane = abs(axis[1]) / np.linalg.norm(axis)
    if isinstance(joint, scenes.RevoluteJoint):
        return bool(out_of_plane >= 1 - FLAT)
    return bool(out_of_plane <= FLAT)


def _shares_plane(unloaded: UnloadedScene, joint: scenes.Joint, plane: NumericPose, candidate: scenes.Joint) -> bool:
    """Whether two joints hold a body in one plane, in the world and in the body alike."""
    second = unloaded.plane(candidate.rod)
    length = unloaded.records[joint.rod].length
    if second is None or not same_plane(plane, second, length):
        return False
    first_place = _place(joint)
    second_place = _place(candidate)
    world_side = float(plane.rotation[:, 1] @ second.rotation[:, 1])
    body_side = float(first_place.rotation[:, 1] @ second_place.rotation[:, 1])
    return world_side * body_side > 0 and same_plane(first_place, second_place, length)


def _place(joint: scenes.Joint) -> NumericPose:
    """Pose of the tip section in the body."""
    return NumericPose(_array(joint.position), _array(joint.quaternion))


def _array(values: tuple[float, ...]) -> FloatArray:
    return np.asarray(values, dtype=np.float64)
