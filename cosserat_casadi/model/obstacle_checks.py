"""Refusal of misplaced obstacles, and of contact where a use of the scene does not support it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.contact_pairs import named_pairs
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.scene_rods import base_pose
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.rod.properties import RodProperties

LOOKED_AT = np.linspace(0.0, 1.0, 201)
"""Abscissae of the sections that are checked against an obstacle."""

TOUCHING = 1e-9
"""Depth of a clamp in an obstacle, relative to the length of its rod, that is put down to rounding."""


def check_obstacles(discrete: DiscreteScene) -> None:
    """Refuse a scene with rods or bodies that start, or are held, inside obstacles, or do not fit into a lumen.

    Raises:
        SceneError: with the faults of all obstacles.
    """
    refuse(_problems(discrete))


WIDTH = "give each {width}; or solve the scene, or leave them out"
"""Remedy where exact contact is not supported."""

RELAXED = "take relaxed_contact(model) for the model; or give each {width}"
"""Remedy where exact contact is not supported in a problem at rest."""

HELD = "the rod {!r} is free: at rest only contact could hold it"
"""Problem of a free rod that may touch something exactly."""

SUGGESTED = 5e-3
"""Width over the length of the shortest rod: a thinner layer takes more modes and shorter steps of a load path."""


def suggested_width(scene: scenes.Scene) -> str:
    """Sentence of a remedy that suggests a width: an example, and its effect on rods at rest."""
    width = SUGGESTED * min(float(rod.length) for rod in scene.rods)
    return f"a width, such as {width:.1g} m: contact is smooth then, and shifts rods at rest by about the width"


def refuse_obstacles(scene: scenes.Scene, what: str, remedy: str = WIDTH) -> None:
    """Refuse a scene with exact contact of obstacles for a use that does not support it.

    Args:
        scene: the scene.
        what: the request in words, such as "a motion".
        remedy: advice, in which ``{width}`` stands for the sentence of :func:`suggested_width`.

    Raises:
        SceneError: the scene has obstacles without a width, or rods that touch rods so.
    """
    if remedy != RELAXED and scene.rods_touch_exactly:
        problem = f"{what} has no contact of rods without a width"
        advice = "leave exact out, for a contact that is smooth; or solve, simulate or export it"
        refuse(Problem(f"rod_contacts[{n}].exact", problem, advice) for n in range(len(scene.rod_contacts)))
    if scene.touches_exactly:
        problem = f"{what} finds no exact contact: its rods would pass through them"
        where = "rod_contacts" if scene.rods_touch_exactly else "obstacles"
        raise SceneError(Problem(where, problem, remedy.format(width=suggested_width(scene))))


def refuse_held_by_contact(scene: scenes.Scene) -> None:
    """Refuse to solve for the equilibrium of free rods that exact contact alone would hold.

    Raises:
        SceneError: with all such rods.
    """
    refuse(held_by_contact(scene))


def held_by_contact(scene: scenes.Scene) -> Iterator[Problem]:
    """Problems of free rods in exact contact with obstacles or rods, or with bodies in such contact."""
    # Contact has no friction: along an obstacle such a rod would be in equilibrium nowhere, or anywhere.
    remedy = "give its base a place; or let it move: simulate the scene"
    for obstacle in scene.obstacles:
        for rod in scene.rods:
            concerned = obstacle.concerns(rod.name) or bool(obstacle.bodies)
            if rod.base.free and concerned and not obstacle.is_smooth:
                yield Problem(f"obstacles.{obstacle.name}", HELD.format(rod.name), remedy)
    for contact, rods in named_pairs(scene) if scene.rod_contacts else ():
        free = [rod.name for rod in scene.rods if rod.base.free and rod.name in rods and contact.exact]
        yield from (Problem(f"rod_contacts.{contact.label}", HELD.format(name), remedy) for name in free)


def _held_by(scene: scenes.Scene, body: str, rod: RodProperties) -> dict[str, tuple[FloatArray, float]]:
    """Sections of a rod that a body holds: their poses in the axes of the body, and their radii."""
    held = {}
    for joint in scene.joints:
        if (joint.body, joint.rod) == (body, rod.name):
            (radius,) = section_radius(rod, np.array([joint.at])).tolist()
            where = "" if joint.at == 1.0 else f" at X = {joint.at:g}"
            held[f"is held by its body{where}"] = (np.asarray(joint.position, dtype=float), radius)
    return held


def _problems(discrete: DiscreteScene) -> Iterator[Problem]:
    for rod in discrete.scene.rods:
        properties = discrete.rods[rod.name].properties
        radii = section_radius(properties, LOOKED_AT)
        in_world = {}
        # The start of a carried rod is checked with its carrier.
        if rod.base.rod is None:
            in_world["starts"] = (known(base_pose(rod)[0]), float(radii[0]))
        for support in discrete.scene.supports:
            if support.rod == rod.name:
                in_world["is held"] = (np.asarray(support.position, dtype=float), float(radii[-1]))
        for obstacle in discrete.scene.obstacles:
            if not obstacle.concerns(rod.name):
                continue
            member = SURFACES[obstacle.kind]
            yield from member.faults(obstacle, float(radii.max()))
            held = in_world
            if obstacle.body is not None:
                # The poses of the body, and of the rods that it carries, are unknown before the scene is solved.
                held = _held_by(discrete.scene, obstacle.body, properties)
            for how, (position, radius) in held.items():
                depth = radius - float(member.function(obstacle)(position)[0])
                if depth > TOUCHING * properties.length:
                    side = f"{depth:.4g} m {member.forbidden} it"
                    problem = f"the rod {rod.name!r} {how} {side}, at {position.tolist()}"
                    remedy = "move one of the two, or name the rods that it concerns: rods = [...]"
                    yield Problem(f"obstacles.{obstacle.name}", problem, remedy)
    for obstacle in discrete.scene.obstacles:
        for row in discrete.scene.disks:
            if obstacle.concerns_disks(row.name):
                yield from SURFACES[obstacle.kind].faults(obstacle, row.radius)
        for body in discrete.scene.bodies:
            if obstacle.concerns_body(body.name):
                assert body.radius is not None, "the rules of the scene ask for one"
                yield from SURFACES[obstacle.kind].faults(obstacle, body.radius)
