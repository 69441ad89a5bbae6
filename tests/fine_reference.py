"""The reference of the errors: a far finer discretisation of the same scene, solved in the same run.

The tests hold it to shooting on every scene that shooting knows.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.equilibrium.metrics import prolong
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.errors import CosseratError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.watched import watched_sections

FINEST = 1e-10
"""Tolerance of the solution that the finest discretisation is derived from."""

MORE_MODES = 6
"""Modes that the finest discretisation has more, per component and element."""

MORE_NODES = 8
"""Intervals that the finest discretisation has more than one and a half times as many."""


class NoReferenceError(CosseratError):
    """There is no solution that errors could be measured against."""

    page = "accuracy"


@dataclass(frozen=True)
class RodState:
    """Compared quantities of a rod: poses of sections, and the wrench of its clamp.

    Attributes:
        length: undeformed length, m.
        position: shape (k, 3), m.
        rotation: shape (k, 3, 3), world_R_section.
        base_wrench: force and moment of the clamp on the rod about the base point, world axes, shape (6,), N and N m.
    """

    length: float
    position: FloatArray
    rotation: FloatArray
    base_wrench: FloatArray


@dataclass(frozen=True)
class Errors:
    """Distance of a solution from the reference.

    Attributes:
        position: largest of all rods and watched sections, relative to the length.
        rotation: angle, rad.
        wrench: of the clamps, relative: moments and forces times length together.
    """

    position: float
    rotation: float
    wrench: float

    @property
    def pose(self) -> float:
        """The larger of position over length and angle."""
        return max(self.position, self.rotation)


@dataclass(frozen=True)
class Reference:
    """The solution that stands for the truth.

    Attributes:
        method: which discretisation it is, in words.
        rods: each rod's sections and clamp.
    """

    method: str
    rods: dict[str, RodState]

    def errors(self, solution: Solution) -> Errors:
        """How far a solution is from the reference."""
        return distance(self.rods, states(solution))


def find_reference(scene: scenes.Scene) -> Reference:
    """A solution far finer than any that is measured.

    Raises:
        NoReferenceError: the solver reaches no equilibrium of the scene.
    """
    plain = with_tolerance(scene, FINEST)
    near = solve_rods(plain)
    if not near.converged:
        raise NoReferenceError(f"no reference was found: {near.message}")
    chosen = near.model.discretisation.values()
    modes = max(max(d.modes) for d in chosen) + MORE_MODES
    nodes = 3 * max(d.nodes for d in chosen) // 2 + MORE_NODES
    model = build(plain, discretise(plain, modes, nodes, "magnus8"))
    finest = solve(model, start=prolong(near, model), estimate_error=False)
    if not finest.converged:
        raise NoReferenceError(f"no reference was found: {finest.message}")
    return Reference(f"a far finer discretisation, {modes} modes and {nodes} intervals", states(finest))


def states(solution: Solution) -> dict[str, RodState]:
    """Compared quantities of a solution."""
    rods = {}
    for name, discrete_rod in solution.model.discrete.rods.items():
        sections = watched_sections(solution.model.scene, name)
        pose = solution.pose(sections, name)
        clamp = solution.base_wrench(name)
        rods[name] = RodState(
            length=discrete_rod.properties.length,
            position=pose.position,
            rotation=pose.rotation,
            base_wrench=np.concatenate([clamp.force, clamp.moment]),
        )
    return rods


def distance(truth: dict[str, RodState], approximation: dict[str, RodState]) -> Errors:
    """Errors of an approximation, the largest over all rods."""
    pairs = [(truth[name], approximation[name]) for name in truth]
    return Errors(
        position=max(_position_distance(a, b) for a, b in pairs),
        rotation=max(_rotation_distance(a, b) for a, b in pairs),
        wrench=max(_wrench_distance(a, b) for a, b in pairs),
    )


def _position_distance(truth: RodState, approximation: RodState) -> float:
    differences = truth.position - approximation.position
    distances = np.linalg.norm(differences, axis=1)
    return float(distances.max()) / truth.length


def _rotation_distance(truth: RodState, approximation: RodState) -> float:
    """Largest angle between the sections, from the chord 2 sin(θ/2), which keeps its digits for small angles."""
    differences = truth.rotation - approximation.rotation
    # The norm of the difference of two rotation matrices is √2 chords.
    chords = np.linalg.norm(differences, axis=(1, 2)) / 2**0.5
    half_sine = min(float(chords.max()) / 2, 1.0)
    return 2 * asin(half_sine)


def _wrench_distance(truth: RodState, approximation: RodState) -> float:
    """Relative to the true wrench; as it is where that is zero."""
    # Forces times the length are moments.
    arms = np.repeat([truth.length, 1.0], 3)
    size = float(np.linalg.norm(arms * truth.base_wrench))
    difference = truth.base_wrench - approximation.base_wrench
    error = float(np.linalg.norm(arms * difference))
    if size > 0:
        return error / size
    return error


def with_tolerance(scene: scenes.Scene, tolerance: float) -> scenes.Scene:
    """The scene with modes and nodes left to the dial."""
    accuracy = scenes.Accuracy(tolerance=tolerance, shape=scene.accuracy.shape)
    return scene.model_copy(update={"accuracy": accuracy})
