"""Decrease of the errors of motions with the step size, and the error that the paths of two or three motions tell."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np

from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.checkpoint import Checkpoint
from cosserat_casadi.motion.energy_balance import energies_of
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.tip_paths import Paths

HALVED = 4.0 / 3.0
"""Error of a motion over its distance from one with half the step, which has a quarter of the error."""

LEFT_BY_HALF = 1.0 / 3.0
"""Error of a motion over its distance from one with twice the step, which has four times the error."""

HALVED_WHERE_RUBBING = 2.0
"""Error of a motion with friction of exact contact over its distance from one with half the step.

The error is of first order where contacts break loose or lift off within a step, and of second order elsewhere.
"""

HALVED_WHERE_STRUCK = 4.85
"""Error over that distance with impacts: errors are then taken to be proportional to the cube root of the step.

Of 216 motions of 57 random rods (``benchmarks/thrown_rods.py``) none erred by more than its estimate, and one by 0.99
of it; with the square root, one erred by 1.6 times its estimate.
"""

UNBALANCED = 2.5
"""Least error of the paths of free rods with friction, over the largest imbalance of their energy.

With a factor of 2, one of these rods erred by 1.2 times its estimate, with 2.5 by 0.96 of it; by the distances alone
nine rods erred by more than their estimates, by up to 3.3 times as much.
"""

TIMES_OF_ENERGY = 101
"""Number of times at which the energy of a motion with friction is evaluated."""

NOT_NEARER = 0.5
"""Ratio of the distances of two motions, ten times as exact and before, above which they count as no nearer."""

BLOWS_BESIDE_FRICTION = ("impact", "stop_hit", "taut")
"""Kinds of events that are blows in steps with friction: by obstacles, stops, and cables."""

FAR_APART = 10.0
"""Distance of two motions that come no nearer, over the allowed error, above which rounding decides the motion."""


class FallOfErrors(ABC):
    """Model of the error of a motion with equal steps as a function of the step size.

    Attributes:
        asks_a_third: whether a third motion is needed, because the impacts of two may be alike by chance.
    """

    asks_a_third: ClassVar[bool]

    @abstractmethod
    def factor(self, history: History, other: History) -> float:
        """Upper bound of a motion's error over its distance from one with half the step, or twice the step or more."""

    def error(self, history: History, paths: Paths, told: float, before: float) -> float:
        """Error of the paths of a motion, over the length.

        Args:
            history: the motion.
            paths: its paths.
            told: error by the distance from another motion.
            before: error by the distance of the other motion from a third one; nan without a third one.
        """
        by_others = np.maximum(told, before) if self.asks_a_third and _has_blows(history) else told
        return float(np.maximum(by_others, self.least(history, paths)))

    @abstractmethod
    def least(self, history: History, paths: Paths) -> float:
        """Lower bound of the error of the paths of a motion, over the length, however near other motions are."""


@final
class SmoothFall(FallOfErrors):
    """Errors without friction of exact contact, which are proportional to the square of the step."""

    asks_a_third = False

    def factor(self, history: History, other: History) -> float:
        """One third for a motion with twice the step, four thirds for a motion with half the step."""
        return LEFT_BY_HALF if is_finer(history, other) else HALVED

    def least(self, history: History, paths: Paths) -> float:
        """Zero, as distances alone tell the error."""
        return 0.0


@final
@dataclass(frozen=True)
class RubbingFall(FallOfErrors):
    """Errors with friction of exact contact: proportional to the step, after impacts to its cube root.

    Attributes:
        model: the model.
        begun: checkpoint at which the motion begins; None for a motion from its start.
    """

    model: Model
    begun: Checkpoint | None

    asks_a_third = True

    def factor(self, history: History, other: History) -> float:
        """Factor by the power of the step with which the error of the coarser motion falls."""
        finer = is_finer(history, other)
        are_struck = _has_blows(history if finer else other)
        return (HALVED_WHERE_STRUCK if are_struck else HALVED_WHERE_RUBBING) - finer

    def least(self, history: History, paths: Paths) -> float:
        """Lower bound of the error of the paths of free rods, by the imbalance of their energy.

        Where a rod rolls out flat, its contact runs along it within a step. Such a step may lose energy, and two
        motions that lose equal energy are near each other but far from the true motion; the missing energy reveals
        that error. A held rod returns whatever energy its waves have lost. The bound never exceeds the longest way of
        the paths, because the energy of rods at rest is rounding.
        """
        if not any(rod.base.free for rod in self.model.scene.rods):
            return 0.0
        times = np.linspace(history.begin, history.end.time, TIMES_OF_ENERGY)
        moving = frozenset(motion.input for motion in self.model.scene.motions)
        energies, _ = energies_of(history, times, moving, None if self.begun is None else self.begun.energy)
        way = float(np.linalg.norm(paths.points - paths.points[0], axis=2).max(initial=0.0))
        if self.begun is not None:
            way += self.begun.error
        return min(way, UNBALANCED * float(np.abs(energies.imbalance).max()))


def is_finer(history: History, other: History) -> bool:
    """Whether the steps of a motion are shorter than those of another one."""
    return history.statistics.largest_step < other.statistics.largest_step


def hangs_on_rounding(history: History, distance: float, before: float, tolerance: float) -> bool:
    """Whether impacts make a motion erratic: its paths do not converge with more exact steps.

    Errors that fall with the order LEAST_SLOPE or faster at least halve from one distance to the next.

    Args:
        history: the motion.
        distance: distance of the paths of two motions, over the length; one has steps TIGHTER times as exact.
        before: distance of the paths of two motions TIGHTER times as coarse; infinite if unknown.
        tolerance: allowed error of the paths, over the length.
    """
    return is_struck(history) and distance > max(NOT_NEARER * before, FAR_APART * tolerance)


def _has_blows(history: History) -> bool:
    """Whether a motion with friction has blows, of obstacles, stops or cables."""
    return any(event.kind in BLOWS_BESIDE_FRICTION for event in history.events)


def is_struck(history: History) -> bool:
    """Whether a motion has impacts."""
    return impacts_of(history) > 0


def impacts_of(history: History) -> int:
    """Number of impacts of a motion."""
    return sum(event.kind == "impact" for event in history.events)
