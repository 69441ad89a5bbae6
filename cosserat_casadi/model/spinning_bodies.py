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
from cosserat_casadi.constraints.held_directions import FLAT
from cosserat_casadi.constraints.tip_holder import place_of
from cosserat_casadi.errors import Problem
from cosserat_casadi.maths.numbers import as_vector, known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.body_loads import BodyLoads
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.system import System


def free_spins(system: System) -> Iterator[Problem]:
    """A problem for every body whose orientation nothing holds."""
    remedy = "hold a tip by a fixed joint, or by a spherical one off that line"
    for i, body in enumerate(system.discrete.scene.bodies):
        if body.name in system.discrete.riding:
            continue
        joints = _joints(system, body)
        if joints is None:
            continue
        dimension = _dimension(joints)
        with_forces = _dimension(np.vstack([joints, _forces(system, body)]))
        if dimension > 1 or with_forces > dimension:
            continue
        about = "the line through its joints" if dimension else "its joint"
        problem = f"nothing holds the orientation of {body.name!r}: it turns freely about {about}"
        yield Problem(f"bodies[{i}]", problem, remedy)


def _joints(system: System, body: scenes.Body) -> FloatArray | None:
    """Points of the joints of a body in its axes, k×3, m; None where a joint holds its orientation."""
    points = []
    for i, joint in enumerate(system.discrete.scene.joints):
        # Its end in the body, be it the one that carries or the one that is carried.
        ends = [end for end, name in _ends(joint) if name == body.name]
        for place in map(place_of, ends):
            points.append(place.position)
            about = system.discrete.constraint(f"joints[{i}]").held.rotations
            if about.shape[1] == 2:
                # All but the turn about one axis is held: the body may turn about that line alone.
                axis = place.rotation @ np.cross(about[:, 0], about[:, 1])
                points.append(place.position + axis)
            elif about.size:
                return None
    return np.array(points)


def _ends(joint: scenes.Joint) -> Iterator[tuple[scenes.Joint | scenes.CarriedBody, str | None]]:
    """The records that place a joint, with the bodies that they place it in."""
    yield joint, joint.body
    if joint.carries is not None:
        yield joint.carries, joint.carries.body


def _forces(system: System, body: scenes.Body) -> FloatArray:
    """Points of a body that forces of fixed direction act on, in its axes, k×3, m."""
    frame = system.frame(FrameName("body", body.name))
    loads = BodyLoads(system.discrete, body, frame.position, frame.rotation, system.arguments.inputs).all()
    points = [known(as_vector(load.position)) for load in loads if load.aligns]
    return np.reshape(points, (-1, 3))


def _dimension(points: FloatArray) -> int:
    """Dimension of what points span: 0 for one point, 1 for a line."""
    differences = points - points[0]
    size = max(float(np.abs(points).max(initial=0.0)), np.finfo(float).tiny)
    return int(np.linalg.matrix_rank(differences / size, tol=FLAT))
