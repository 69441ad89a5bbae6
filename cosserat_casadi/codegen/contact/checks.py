"""Refusal of parts of exact contact that cannot be exported, before any work is done."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.equilibrium.contact.gaps import body_pairs
from cosserat_casadi.errors import ExportError, Problem, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.model.obstacle_checks import held_by_contact, suggested_width
from cosserat_casadi.model.parameters import parameter_layout

SENTENCES = {
    "cuda": "a GPU cannot solve batches of rods in exact contact",
}
"""Functions that a folder may hold of other scenes, and why not of these."""

AT_REST = {
    "derivatives": "derivatives of equilibria",
    "stability": "the stability of equilibria",
    "batches": "many equilibria",
}
"""Functions of equilibria, which a folder of motions in exact contact does not contain."""

REMEDY = "leave it out, or give each obstacle {width}"


def check_contact(scene: scenes.Scene, asked: Mapping[str, bool]) -> None:
    """Refuse parts of a scene in exact contact that the C library does not support.

    Args:
        scene: the scene.
        asked: whether each option of an export is requested, by option.

    Raises:
        ExportError: with every fault.
    """
    if not scene.touches_exactly:
        return
    remedy = REMEDY.format(width=suggested_width(scene))
    problems = [
        Problem(f"--{word}", SENTENCES[word], remedy) for word, wanted in asked.items() if wanted and word in SENTENCES
    ]
    if asked.get("dynamics"):
        remedy = "export the scene twice: with --dynamics, and with this"
        for word, what in AT_REST.items():
            if asked.get(word):
                problem = f"a folder with --dynamics has no {what} in exact contact"
                problems.append(Problem(f"--{word}", problem, remedy))
        problems += refused_in_motion(scene)
    else:
        problems += _refused_parameters(scene)
        problems += _refused_obstacles(scene)
        problems += held_by_contact(scene)
    refuse(problems, ExportError)


def _refused_obstacles(scene: scenes.Scene) -> Iterator[Problem]:
    """Problems of obstacles on bodies, and of disks."""
    for obstacle in scene.obstacles:
        disks = [body for body in scene.bodies if obstacle.concerns_body(body.name) and body.thickness is not None]
        if obstacle.body is not None or disks:
            problem = "C finds no exact contact with an obstacle on a body, nor of a disk"
            yield Problem(f"obstacles.{obstacle.name}", problem, "give each obstacle a width, m")


def refused_in_motion(scene: scenes.Scene) -> Iterator[Problem]:
    """Problems of exact contact in the steps of a motion in C; none of a scene without."""
    if not scene.touches_exactly:
        return
    yield from _refused_parameters(scene)
    for obstacle in scene.obstacles:
        if obstacle.is_smooth and np.isfinite(obstacle.thickness):
            problem = "steps in C watch a thin smooth obstacle, or obstacles in exact contact, not both"
            yield Problem(f"obstacles.{obstacle.name}", problem, "give each obstacle a width, m, or none")


def _refused_parameters(scene: scenes.Scene) -> Iterator[Problem]:
    """Problems of parameters that change numbers of the solver in C: surfaces that touch, and ends of elements."""
    touching = {scene.bodies.index(body) for body, _ in body_pairs(scene)}
    for numbers in scene.named_parameters():
        for own in numbers.all_numbers:
            remedy = "leave it out, or give each obstacle a width, m"
            if own.holder.table == "rods" and own.keys[0] in ("length", "section"):
                problem = (
                    f"{own.name} cannot change: in exact contact C has lengths and sections of rods as fixed numbers"
                )
                yield Problem("parameters", problem, remedy)
            if own.holder.table == "bodies" and own.keys[0] == "radius" and own.holder.index in touching:
                problem = f"{own.name} cannot change: C has the surfaces of bodies in exact contact as fixed numbers"
                yield Problem("parameters", problem, remedy)
    for ends in parameter_layout(scene).moving:
        problem = f"{', '.join(ends.names)} would move ends of elements, which C moves for contacts only"
        yield Problem("parameters", problem, "leave it out, or give each obstacle a width, m")


def check_load_cases(scene: scenes.Scene, load_cases: FloatArray | None) -> None:
    """Refuse load cases for a scene without exact contact, and rows of the wrong length.

    Args:
        scene: the scene.
        load_cases: stacked inputs, a row for each case; parameters may be appended.

    Raises:
        ExportError: the load cases are refused.
    """
    if load_cases is None:
        return
    if not scene.touches_exactly:
        problem = "load cases say which contacts to export, but no rod of this scene touches an obstacle exactly"
        raise ExportError(Problem("--over", problem, "leave them out"))
    inputs = input_layout(without_contacts(scene)).size
    sizes = sorted({inputs, inputs + parameter_layout(scene).size})
    if load_cases.ndim != 2 or load_cases.shape[1] not in sizes or not np.isfinite(load_cases).all():
        shapes = " or ".join(f"(k, {size})" for size in sizes)
        problem = f"load cases must be finite numbers of shape {shapes}, got shape {load_cases.shape}"
        raise ExportError(Problem("--over", problem))
