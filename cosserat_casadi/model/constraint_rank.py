"""Joints that hold too much or too little, refused before anything is solved.

Over-constraining joints show in the rank of the linearised constraint residuals: docs/theory.md, section 8.

Rods hold a body as far as their strains allow. Where the constraint residuals depend on each other for every
shape of the rods, not only for some, the wrenches of the joints cannot be told apart: two rods that only stretch,
clamped in one body, or planar rods of different planes. A few modes and a random shape show it.
"""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discrete_scene import DiscreteScene, discrete_scene
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.scene_equations import SceneEquations
from cosserat_casadi.model.spinning_bodies import free_spins
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.model.unknowns import BlockKind

MODES = 4
NODES = 10
"""A discretisation that can bend every way a rod can."""

SEED = 20250711
"""Of the random shape."""

RANK = 1e-8
"""Share of the largest singular value below which one counts as zero."""


def check_constraints(scene: scenes.Scene, *, moving: bool = False) -> None:
    """Refuse a scene whose constraints hold too much, or, unless it moves, leave a body free to turn.

    Args:
        scene: the scene.
        moving: whether bodies may turn freely.

    Raises:
        SceneError: with the first constraint that repeats others, or every body that turns freely.
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
    # Loads with a number for each node are made for the nodes of another discretisation, and hold no rod.
    loads = [load for load in scene.loads if layout.of_load(load.name or "", EFFECTS[load.kind].nodal) is None]
    without_nodal = scene.model_copy(update={"loads": tuple(loads)})
    probe = discrete_scene(without_nodal, layout, discretise(scene, MODES, NODES, "magnus4"))
    system = _at_a_random_shape(probe)
    spins = tuple(free_spins(system))
    rows = _constraint_rows(system)
    if _rank(rows) == len(rows):
        return spins, None
    remedy = "admit more strains of the rods, hold the tip by a spherical joint, or lay planar rods into one plane"
    for placed in probe.constraints:
        upper = rows[: probe.multipliers(placed).stop - probe.unknowns.count(BlockKind.STRAIN)]
        if _rank(upper) < len(upper):
            problem = f"over-constrains: {placed.what} is held already in a direction in which its rods cannot give"
            return spins, Problem(placed.where, problem, remedy)
    return spins, None


def _at_a_random_shape(probe: DiscreteScene) -> System:
    """The equations at a shape that has nothing special, at the scene's inputs."""
    x = np.zeros(probe.size)
    strains = probe.unknowns.count(BlockKind.STRAIN)
    x[:strains] = 0.3 * np.random.default_rng(SEED).standard_normal(strains) * _own_units(probe)
    # Numbers throughout: to write expressions first takes several times as long.
    return System(probe, Arguments(ca.DM(x), ca.DM(probe.layout.pack())))


def _own_units(probe: DiscreteScene) -> FloatArray:
    """Coordinates of all strains that bend each rod as one unit bends a rod alone, shape (strains,).

    Beside a rod that is softer by far a unit bends a rod so little that it seems to be rigid.
    """
    parts = []
    for rod in probe.rods.values():
        lengths = [rod.length if component < 3 else 1.0 for component in rod.admitted]
        parts.append(np.full(rod.size, 1.0 / np.max(np.multiply(rod.scales, lengths))))
    return np.concatenate(parts)


def _constraint_rows(system: System) -> FloatArray:
    """Derivatives of all constraint residuals with strains and floating frames, one row each."""
    unknowns = system.discrete.unknowns
    # Rods that touch each other leave an expression of numbers.
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
