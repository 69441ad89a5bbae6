"""Whether a held rod ends on the same equilibrium at every tolerance and on discretisations that a user fixes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cosserat_casadi import Solution, scene_from_dict, solve_scene
from cosserat_casadi.accuracy.metrics import pose_distance
from tests.reference.held_scenes import held_scene

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)

SECTIONS = np.linspace(0.0, 1.0, 9)
"""Abscissae at which shapes are compared."""

ALIKE = 0.02
"""Distance of two shapes (over length, rad) up to which they are one equilibrium; more where they say so themselves."""

Accuracy = dict[str, Any]


def solved(seed: int, accuracy: Accuracy) -> Solution:
    """The solution of a drawn scene."""
    return solve_scene(scene_from_dict({**held_scene(seed), "accuracy": accuracy}))


def alike(first: Solution, second: Solution) -> bool:
    """Whether two solutions of a scene end alike: both or none at an equilibrium, and at the same one."""
    if first.outcome is not second.outcome or first.stable is not second.stable:
        return False
    if not first.converged:
        return True
    estimates = (first.shape_error_estimate or 0.0) + (second.shape_error_estimate or 0.0)
    return pose_distance(first, second, SECTIONS) <= ALIKE + estimates


def all_alike(seed: int, accuracies: Sequence[Accuracy]) -> bool:
    """Whether a drawn scene ends alike at all these accuracies."""
    solutions = [solved(seed, accuracy) for accuracy in accuracies]
    return all(alike(solution, solutions[-1]) for solution in solutions)
