"""Refusal of joints that hold too many directions or too few, before anything is solved.

Over-constraining joints show in the rank of the linearised constraint residuals: docs/theory.md, section 8.

Rods hold a body as far as their strains allow. Where the constraint residuals depend on each other for every
shape of the rods, not only for some, the wrenches of the joints cannot be told apart: two rods that only stretch,
clamped in one body, or planar rods of different planes. A few modes and a random shape show this.

Bodies turn freely where their joints are spherical and lie on one line, and nothing has a lever about it. Turning such
a body about the line strains no rod and moves no force, in every pose: its orientation is not determined and the
equations are singular. A force that keeps its direction, or weight, holds the body if it acts off the line. Forces that
turn with the body and moments cannot: they have no potential. A body that hangs from one joint is let through: its
weight holds it except for a turn about the vertical, and the solution is called neutral.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.constraints.held_directions import FLAT
from cosserat_casadi.constraints.tip_holder import place_of
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.numbers import as_vector, known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.body_loads import BodyLoads
from cosserat_casadi.model.discrete_scene import DiscreteScene, discrete_scene
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.scene_equations import SceneEquations
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.model.unknowns import BlockKind

MODES = 4
NODES = 10
"""Discretisation with which a rod can take every kind of shape that its strains admit."""

SEED = 20250711
"""Seed of the random shape."""

RANK = 1e-8
"""Share of the largest singular value below which a singular value counts as zero."""


def check_constraints(scene: scenes.Scene, *, moving: bool = False) -> None:
    """Refuse a scene whose constraints repeat each other, or, at rest, leave a body free to turn.

    Args:
        scene: the scene.
        moving: whether bodies may turn freely.

    Raises:
        SceneError: a constraint repeats others (the first is named), or bodies turn freely (all are named).
    """
    carries = any(rod.base.rod is not None for rod in scene.rods)
    if not scene.joints and not carries:
        return
    spins, repeated = _problems(scene)
    if spins and not moving:
        raise SceneError(*spins)
    if repeated is not None:
        raise SceneError(repeated)


@lru_cache(maxsize=64)
def _problems(scene: scenes.Scene) -> tuple[tuple[Problem, ...], Problem | None]:
    """Every body of a scene that turns freely, and the first constraint that repeats others."""
    layout = input_layout(scene)
    # Loads with numbers for each node were made for another discretisation, and hold no rod.
    loads = [load for load in scene.loads if layout.of_load(load.name or "", EFFECTS[load.kind].nodal) is None]
    without_nodal = scene.model_copy(update={"loads": tuple(loads)})
    probe = discrete_scene(without_nodal, layout, discretise(scene, MODES, NODES, "magnus4"))
    # A generic shape: in a special one constraints may be dependent by chance.
    x = np.zeros(probe.size)
    strains = probe.unknowns.count(BlockKind.STRAIN)
    x[:strains] = 0.3 * np.random.default_rng(SEED).standard_normal(strains) * _own_units(probe)
    # Numbers throughout: symbolic expressions would take several times as long.
    system = System(probe, Arguments(ca.DM(x), ca.DM(layout.pack())))
    spins = tuple(_free_spins(system))
    rows = _constraint_rows(system)
    if _rank(rows) == len(rows):
        return spins, None
    remedy = "admit more strains of the rods, hold the tip by a spherical joint, or lay planar rods into one plane"
    for placed in probe.constraints:
        upper = rows[: probe.multipliers(placed).stop - strains]
        if _rank(upper) < len(upper):
            problem = (
                f"over-constrains {placed.what}: it is held already in a direction in which its rods cannot deform"
            )
            return spins, Problem(placed.where, problem, remedy)
    return spins, None


def _own_units(probe: DiscreteScene) -> FloatArray:
    """Strain coordinates that bend each rod as much as one unit bends a rod that is alone, shape (strains,).

    In the scene's own units, one unit bends a rod beside a far softer one so little that the rod would seem rigid.
    """
    parts = []
    for rod in probe.rods.values():
        lengths = [rod.length if component < 3 else 1.0 for component in rod.admitted]
        parts.append(np.full(rod.size, 1.0 / np.max(np.multiply(rod.scales, lengths))))
    return np.concatenate(parts)


def _constraint_rows(system: System) -> FloatArray:
    """Derivatives of all constraint residuals with strains and floating frames, one row each."""
    unknowns = system.discrete.unknowns
    # Contact of rods leaves an expression of numbers, which is evaluated here.
    jacobian = ca.evalf(ca.MX(SceneEquations(system).assembly.constraint_jacobian)).full()
    first = unknowns.count(BlockKind.STRAIN)
    last = first + unknowns.count(BlockKind.MULTIPLIER)
    rows = np.delete(jacobian[first:last], slice(first, last), axis=1)
    rows[:, :first] *= _own_units(system.discrete)
    return np.asarray(rows)


def _rank(rows: FloatArray) -> int:
    singular = np.linalg.svd(rows, compute_uv=False)
    if not singular.size:
        return 0
    return int(np.sum(singular > RANK * singular[0]))


def _free_spins(system: System) -> Iterator[Problem]:
    """A problem for every body that can turn freely."""
    remedy = "hold a tip by a fixed joint, or by a spherical one off that line"
    for i, body in enumerate(system.discrete.scene.bodies):
        if body.name in system.discrete.unloaded.riding:
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
    """Points of the joints of a body in its axes, k×3, m; None if a joint holds its orientation."""
    points = []
    for i, joint in enumerate(system.discrete.scene.joints):
        # The end of the joint in this body, which carries the other body or is carried by it.
        ends = [end for end, name in _ends(joint) if name == body.name]
        for place in map(place_of, ends):
            points.append(place.position)
            about = system.discrete.constraint(f"joints[{i}]").held.rotations
            if about.shape[1] == 2:
                # The joint leaves one turn free: two points on its axis stand for it.
                axis = place.rotation @ np.cross(about[:, 0], about[:, 1])
                points.append(place.position + axis)
            elif about.size:
                return None
    return np.array(points)


def _ends(joint: scenes.Joint) -> Iterator[tuple[scenes.Joint | scenes.CarriedBody, str | None]]:
    """The records of the places of a joint, with the bodies that these places are in."""
    yield joint, joint.body
    if joint.carries is not None:
        yield joint.carries, joint.carries.body


def _forces(system: System, body: scenes.Body) -> FloatArray:
    """Points of a body at which forces of fixed direction act, in its axes, k×3, m."""
    frame = system.frame(FrameName("body", body.name))
    loads = BodyLoads(system.discrete, body, frame.position, frame.rotation, system.arguments.inputs).all()
    points = [known(as_vector(load.position)) for load in loads if load.aligns]
    return np.reshape(points, (-1, 3))


def _dimension(points: FloatArray) -> int:
    """Dimension of the affine span of points: 0 for one point, 1 for a line."""
    differences = points - points[0]
    size = max(float(np.abs(points).max(initial=0.0)), np.finfo(float).tiny)
    return int(np.linalg.matrix_rank(differences / size, tol=FLAT))
