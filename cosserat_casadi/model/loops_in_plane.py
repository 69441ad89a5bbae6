"""Loops of bodies in a plane, whose joints hold each direction across it once.

Hinges about one normal, slides across it and clamps keep bodies in a plane. Where such joints close a loop, with each
other or with planar rods of the same plane, the last joint would hold a body across the plane a second time: it is made
to hold its body in the plane alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from cosserat_casadi.constraints.held_directions import FLAT, confines, keeps_plane, stays_in_plane
from cosserat_casadi.constraints.joints import JOINT_KINDS
from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.constraints.tip_holder import place_of
from cosserat_casadi.maths.pose import IDENTITY, NumericPose
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.floating_frames import UnloadedScene


class _Link(NamedTuple):
    """A joint between bodies, rods in a plane, and the world.

    Attributes:
        number: place of the joint in the scene's list.
        ends: names of the bodies, and of rods that start on bodies; None for the world, in which the other rods stand.
        first: pose of the place at the first end, world axes.
        second: pose of the place at the other end, the held one, world axes.
        held: directions, in the axes of the held place.
    """

    number: int
    ends: tuple[str | None, str | None]
    first: NumericPose
    second: NumericPose
    held: HeldDirections

    def fits(self, normal: FloatArray, length: float) -> bool:
        """Whether its ends are in one plane, and it holds both of a tilt or neither."""
        shift = abs(float(normal @ (self.second.position - self.first.position)))
        tilt = np.abs(self.first.rotation.T @ normal - self.second.rotation.T @ normal).max()
        return shift <= FLAT * length and tilt <= FLAT and keeps_plane(self.held, self.normal_in_place(normal))

    def normal_in_place(self, normal: FloatArray) -> FloatArray:
        """The normal in the axes of the held place, shape (3,)."""
        return np.asarray(self.second.rotation.T @ normal)


def closing_joints(unloaded: UnloadedScene) -> dict[int, FloatArray]:
    """Joints that close a loop of bodies in a plane.

    Returns:
        the unit normal of the plane, in the axes of the held place, shape (3,), by the place of the joint in the
        scene's list.
    """
    if all(joint.carries is None for joint in unloaded.scene.joints):
        return {}
    _, length = unloaded.units([])
    # Rods come last: if other parts hold a body in the plane, rods stay free to bend.
    links = [*_links_of_bodies(unloaded), *_links_of_rods(unloaded)]
    closing: dict[int, FloatArray] = {}
    for normal in _normals(links):
        # Bodies that are kept in the plane together.
        groups: list[set[str | None]] = []
        for link in links:
            if link.number in closing or not link.fits(normal, length):
                continue
            together = [group for group in groups if group & set(link.ends)]
            if any(set(link.ends) <= group for group in together):
                closing[link.number] = link.normal_in_place(normal)
            elif confines(link.held, link.normal_in_place(normal)):
                groups = [group for group in groups if group not in together]
                groups.append(set(link.ends).union(*together))
    return closing


def _normals(links: list[_Link]) -> Iterator[FloatArray]:
    """Unit vectors along the axes of hinges between bodies, world axes; hinges on one line give one vector."""
    found: list[FloatArray] = []
    for link in links:
        rotations = link.held.rotations
        if rotations.shape[1] != 2:
            continue
        normal = link.second.rotation @ np.cross(rotations[:, 0], rotations[:, 1])
        if all(np.linalg.norm(np.cross(normal, other)) > FLAT for other in found):
            found.append(normal)
            yield normal


def _links_of_bodies(unloaded: UnloadedScene) -> Iterator[_Link]:
    for number, joint in enumerate(unloaded.scene.joints):
        if joint.carries is None:
            continue
        held = JOINT_KINDS[joint.kind].directions(joint)
        carrier = IDENTITY if joint.body is None else _start(unloaded, joint.body)
        first = carrier.then(place_of(joint))
        second = _start(unloaded, joint.carries.body).then(place_of(joint.carries))
        yield _Link(number, (joint.body, joint.carries.body), first, second, held)


def _links_of_rods(unloaded: UnloadedScene) -> Iterator[_Link]:
    on_bodies = {joint.rod for joint in unloaded.scene.joints if joint.body is not None and joint.holds_base}
    for number, joint in enumerate(unloaded.scene.joints):
        if joint.carries is not None or joint.body is None:
            continue
        starts_on_body = joint.rod in on_bodies
        in_plane = stays_in_plane(unloaded.rods[joint.rod].properties) if starts_on_body else unloaded.plane(joint.rod)
        if not in_plane:
            continue
        held = JOINT_KINDS[joint.kind].directions(joint)
        section = unloaded.section(joint.rod, joint.at)
        # The section turns in its plane; what matters is its normal.
        in_body = _start(unloaded, joint.body).then(place_of(joint))
        if not held.rotations.size:
            # The joint leaves the axes free: they are those of the section.
            in_body = NumericPose(in_body.position, section.quaternion)
        # No body has a name with a blank.
        rod = f"rod {joint.rod}" if starts_on_body else None
        yield _Link(number, (rod, joint.body), in_body, section, held)


def _start(unloaded: UnloadedScene, body: str) -> NumericPose:
    return unloaded.body_frame(body).start
