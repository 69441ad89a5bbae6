"""Whether a solution in exact contact holds, by gaps, forces and balance alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi import Solution
from cosserat_casadi.equilibrium.contact.gaps import gap_along, pairs

DENSE = np.linspace(0.0, 1.0, 4001)


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
        assert rod.linear_density is not None
        total += [0.0, 0.0, -9.81 * rod.linear_density * rod.length]
    for load in scene.loads:
        if load.kind == "point_wrench":
            total += np.array(load.force)
    for contact in solution.contacts:
        total += contact.force
    if np.abs(total).max() > 1e-6 * largest:
        yield f"forces add up to {np.abs(total).max():.1e} N"
