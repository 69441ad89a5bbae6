"""Whether rods in contact are where they should be: by gaps, forces and balance, or by an independent solver."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator

import numpy as np

from cosserat_casadi import Solution
from cosserat_casadi.equilibrium.contact.gaps import gap_along, pairs
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.friction_path import FrictionPath
from tests.reference.discrete_rods import Poses, discrete_equilibrium, discrete_friction_path
from tests.reference.rods import Table

DENSE = np.linspace(0.0, 1.0, 4001)

SEGMENTS = 120
"""Of a discrete rod; of rods that touch rods, whose sections are all compared with each other, a quarter."""

NEAR = 2e-4
"""Distance from the discrete rods, of the length, that is allowed beside twice the estimated errors of both.

A point that touches a bar beside the place of contact is pushed askew: of that the distance is of first order.
"""

FURTHER = 4
"""Factor on the segments where rods are not where discrete ones have them."""

PRESSING = 2e-2
"""Difference of the forces of an obstacle that is allowed beside twice the estimated error.

It is a share of the largest of these forces, or of 0.1 N.
"""


def faults(solution: Solution, tolerance: float = 2e-5) -> list[str]:
    """What is wrong with a solution that converged: nothing where it holds."""
    return list(_faults(solution, tolerance))


def _faults(solution: Solution, tolerance: float) -> Iterator[str]:
    scene = solution.model.scene
    for rod, obstacle in pairs(scene):
        least = gap_along(solution, rod, obstacle, DENSE).min()
        if least < -tolerance:
            yield f"{least:.1e} inside {obstacle.name}"
        for contact in solution.contacts:
            if (contact.owner, contact.obstacle) != (rod, obstacle.name):
                continue
            X = np.linspace(contact.start, contact.end, 201)
            off = np.abs(gap_along(solution, rod, obstacle, X)).max()
            if off > tolerance:
                yield f"{off:.1e} off {obstacle.name} where it is said to touch"
    largest = max([1e-3, *(float(np.linalg.norm(contact.force)) for contact in solution.contacts)])
    for contact in solution.contacts:
        pulls = min([*contact.ends, *(section.force for section in contact.inside)])
        if pulls < -tolerance * largest:
            yield f"pulled by {contact.obstacle} with {pulls:.1e} N"
    total = np.zeros(3)
    for rod in scene.rods:
        total += solution.base_wrench(rod.name).force
        density = rod.linear_density or rod.material.density * np.pi * rod.section.radius**2
        total += [0.0, 0.0, -9.81 * density * rod.length]
    for body in scene.bodies:
        total += [0.0, 0.0, -9.81 * body.mass]
    for load in scene.loads:
        if load.kind == "point_wrench":
            total += np.array(load.force)
    borne = {obstacle.name for obstacle in scene.obstacles if obstacle.body is not None}
    for contact in solution.contacts:
        if contact.obstacle not in borne:
            total += contact.force
    if np.abs(total).max() > 1e-6 * largest:
        yield f"forces add up to {np.abs(total).max():.1e} N"


def compared(text: str, solution: Solution, path: FrictionPath | None = None) -> Iterator[str]:
    """What discrete rods say against a stable solution, or against the end of a path with friction.

    Args:
        text: the scene; its weight grows along the path.
        solution: what is compared; with a path, its first point.
        path: with friction.
    """
    tables = tomllib.loads(text)
    segments = SEGMENTS // 4 if "rod_contacts" in tables else SEGMENTS
    found = list(_apart(tables, segments, solution, path))
    # The smallest number of segments on which they agree decides: what is wrong stays wrong on more of them.
    yield from found and list(_apart(tables, FURTHER * segments, solution, path))


def _apart(tables: Table, segments: int, solution: Solution, path: FrictionPath | None) -> Iterator[str]:
    """The same on so many segments, and on half of them for the error that they leave."""
    end = solution if path is None else path.solution(-1)
    ends = []
    pressing = []
    for number in (segments // 2, segments):
        start = evenly_apart(solution, number)
        if path is None:
            minimum = discrete_equilibrium(tables, start)
            found = minimum.ends if minimum.solved else None
            pressing.append(minimum.pressing)
        else:
            found = discrete_friction_path(tables, start, path.factor)
        if found is None:
            yield "the discrete rods were not solved"
            return
        ends.append(found)
    for rod in solution.model.scene.rods:
        coarse, fine = (points[rod.name] for points in ends)
        wanted, _ = evenly_apart(end, segments)[rod.name]
        apart = np.abs(fine - wanted[1:]).max()
        told = 0.0 if end.error_estimate is None else end.error_estimate
        if apart > (NEAR + 2 * told) * rod.length + 2 * np.abs(fine[1::2] - coarse).max():
            yield f"{rod.name} is {apart:.1e} m from the discrete one"
    if path is not None:
        return
    coarse_forces, forces = pressing
    largest = max([0.1, *forces.values()])
    for name, force in forces.items():
        told = sum(float(np.linalg.norm(contact.force)) for contact in solution.contacts if contact.obstacle == name)
        if abs(told - force) > PRESSING * largest + 2 * abs(force - coarse_forces[name]):
            yield f"{name} presses with {told:.3g} N, on the discrete rods with {force:.3g} N"


def evenly_apart(solution: Solution, segments: int) -> Poses:
    """Sections of the rods of a solution, as discrete rods begin with them."""
    ends = np.arange(segments + 1) / segments
    middles = (ends[1:] + ends[:-1]) / 2

    def sections(rod: str) -> tuple[FloatArray, FloatArray]:
        return solution.pose(ends, rod).position, solution.pose(middles, rod).rotation

    return {rod.name: sections(rod.name) for rod in solution.model.scene.rods}
