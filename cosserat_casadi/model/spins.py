"""Bodies that turn freely: their joints are spherical and lie on one line, and nothing has a lever about it.

Turning such a body about the line strains no rod and moves no force, in every pose: its orientation is not determined
and the equations are singular. A force that keeps its direction, or weight, holds it where it acts off the line. Forces
that turn with the body and moments cannot: they have no potential. What hangs from one joint is let through: its weight
holds it but for a turn about the vertical, and the solution says that it is neutral.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.couplings import FLAT, Carrier
from cosserat_casadi.model.load_assembly import BodyLoads
from cosserat_casadi.model.system import System


def free_spins(system: System) -> Iterator[Problem]:
    """A problem for every body whose orientation nothing holds."""
    for i, body in enumerate(system.discrete.scene.bodies):
        joints, forces = _joints(system, body), _forces(system, body)
        if joints is None or _lines(joints) > 1 or _lines(np.vstack([joints, forces])) > _lines(joints):
            continue
        about = "the line through its joints" if _lines(joints) else "its joint"
        problem = f"nothing holds the orientation of {body.name!r}: it turns freely about {about}"
        yield Problem(f"bodies[{i}]", problem, "hold a tip by a fixed joint, or by a spherical one off that line")


def _joints(system: System, body: scenes.Body) -> FloatArray | None:
    """Points of the joints of a body in its axes, k×3, m; None where a joint holds its orientation."""
    ties = [tie for tie in system.discrete.couplings.ties if tie.other == Carrier("body", body.name)]
    if any(tie.joint.rotation_axes for tie in ties):
        return None
    return np.array([np.asarray(tie.joint.place.position).ravel() for tie in ties])


def _forces(system: System, body: scenes.Body) -> FloatArray:
    """Points of a body that forces of fixed direction act on, in its axes, k×3, m."""
    place = system.coupled.placements[Carrier("body", body.name)]
    loads = BodyLoads(system.discrete, body, place.position, place.rotation, system.arguments).all()
    points = [load.position for load in loads if load.aligns]
    return np.reshape(points, (-1, 3))


def _lines(points: FloatArray) -> int:
    """Dimension of what points span: 0 for one point, 1 for a line."""
    apart = points - points[0]
    size = max(float(np.abs(points).max(initial=0.0)), np.finfo(float).tiny)
    return int(np.linalg.matrix_rank(apart / size, tol=FLAT))
