"""Whether a held rod ends on the same equilibrium at every tolerance and on discretisations that a user fixes."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Any

import numpy as np

from cosserat_casadi import Outcome, Solution, scene_from_dict, solve
from cosserat_casadi.equilibrium.metrics import pose_distance
from tests.reference.held_scenes import held_scene

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)

SECTIONS = np.linspace(0.0, 1.0, 9)
"""Abscissae at which shapes are compared."""

ALIKE = 0.02
"""Distance of two shapes (over length, rad) up to which they are one equilibrium; more where they say so themselves."""

Accuracy = dict[str, Any]


def solved(seed: int, accuracy: Accuracy) -> Solution:
    """The solution of a drawn scene."""
    return solve(scene_from_dict({**held_scene(seed), "accuracy": accuracy}))


def says_unresolved(solution: Solution) -> bool:
    """Whether a solution is an equilibrium, and says that its modes and nodes do not resolve it, and what it is off."""
    return solution.outcome is Outcome.UNRESOLVED and solution.error_estimate is not None


def is_equilibrium(solution: Solution) -> bool:
    """Whether a solution claims to be an equilibrium, resolved or not."""
    return solution.converged or says_unresolved(solution)


def alike(first: Solution, second: Solution) -> bool:
    """Whether two solutions of a scene end alike: both or none at an equilibrium, and at the same one.

    What says that its modes do not resolve it is held to its shape, within what it says of the error of that.
    """
    if not is_equilibrium(first) or not is_equilibrium(second):
        return first.outcome is second.outcome
    if first.converged and second.converged and first.stable is not second.stable:
        return False
    estimates = (first.shape_error_estimate or 0.0) + (second.shape_error_estimate or 0.0)
    return pose_distance(first, second, SECTIONS) <= ALIKE + estimates


class Verdict(Enum):
    """How a scene ends at several accuracies; the value is the sentence shown."""

    ALIKE = "the same at all of them"
    SAYS_UNRESOLVED = "the same equilibrium at all, and not resolved at some of them, which says so"
    NO_EQUILIBRIUM = "no equilibrium found at any, which says so"
    DIFFERENT = "not the same equilibrium"


def verdict(seed: int, accuracies: Sequence[Accuracy]) -> Verdict:
    """How a drawn scene ends at these accuracies, the last of which is the finest."""
    solutions = [solved(seed, accuracy) for accuracy in accuracies]
    finest = solutions[-1]
    if not all(alike(solution, finest) for solution in solutions):
        return Verdict.DIFFERENT
    if not is_equilibrium(finest):
        return Verdict.NO_EQUILIBRIUM
    if any(says_unresolved(solution) for solution in solutions):
        return Verdict.SAYS_UNRESOLVED
    return Verdict.ALIKE


def all_alike(seed: int, accuracies: Sequence[Accuracy]) -> bool:
    """Whether a drawn scene ends alike at all these accuracies."""
    return verdict(seed, accuracies) is not Verdict.DIFFERENT
