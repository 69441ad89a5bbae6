"""How errors of motions with equal steps fall with the step, and what the paths of two or three motions tell."""

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
"""Error of a motion over its distance to one of half the step: half a step leaves a quarter of the error."""

LEFT_BY_HALF = 1.0 / 3.0
"""Error of a motion over its distance to one of twice the step, which has four times the error."""

HALVED_WHERE_RUBBING = 2.0
"""Error of a motion with friction of exact contact over its distance to one of half the step.

What breaks loose or lifts off in a step may leave its first power; where nothing does it leaves the second one.
"""

HALVED_WHERE_STRUCK = 4.85
"""Error over the same distance where impacts strike: errors are then taken to go with the cube root of the step.

Of 216 motions of 57 random rods (``benchmarks/thrown_rods.py``) none erred by more than was told, and one by 0.99 of
it; with the root one erred by 1.6 times as much.
"""

UNBALANCED = 2.5
"""Least error of the paths of free rods with friction, over the largest imbalance of their energy.

With twice the imbalance one of those rods erred by 1.2 times as much as was told, and with this by 0.96 of it; by the
distances alone nine rods erred by more than was told, by up to 3.3 times as much.
"""

TIMES_OF_ENERGY = 101
"""Times at which the energy of a motion with friction is looked at."""

NOT_NEARER = 0.5
"""Share of the distance of two motions from which on the next two, ten times as exact, count as no nearer."""

BLOWS_BESIDE_FRICTION = ("impact", "stop_hit", "taut")
"""Kinds of events that are blows in steps with friction: of obstacles, of stops, and of cables."""

FAR_APART = 10.0
"""Distance of two motions that count as no nearer, over the error allowed, from which on rounding decides them."""


class FallOfErrors(ABC):
    """How the error of a motion with equal steps falls with the step.

    Attributes:
        asks_a_third: whether impacts of two motions may happen to be alike, so that a third motion tells the error too.
    """

    asks_a_third: ClassVar[bool]

    @abstractmethod
    def factor(self, history: History, other: History) -> float:
        """Error of a motion over its distance to one of half the step, or of twice the step or more, from above."""

    def error(self, history: History, paths: Paths, told: float, before: float) -> float:
        """Error of the paths of a motion, over the length.

        Args:
            history: the motion.
            paths: its paths.
            told: error that the distance to another motion tells.
            before: error that the distance of the other motion to a third one tells; nan where there is none.
        """
        by_others = np.maximum(told, before) if self.asks_a_third and _has_blows(history) else told
        return float(np.maximum(by_others, self.least(history, paths)))

    @abstractmethod
    def least(self, history: History, paths: Paths) -> float:
        """Least error of the paths of a motion, over the length, however near other motions are."""


@final
class SmoothFall(FallOfErrors):
    """Errors without friction of exact contact: they fall with the square of the step."""

    asks_a_third = False

    def factor(self, history: History, other: History) -> float:
        """A third of the distance to a motion of twice the step, four thirds of that to one of half the step."""
        return LEFT_BY_HALF if is_finer(history, other) else HALVED

    def least(self, history: History, paths: Paths) -> float:
        """Zero, as distances alone tell the error."""
        return 0.0


@final
@dataclass(frozen=True)
class RubbingFall(FallOfErrors):
    """Errors with friction of exact contact: they fall with the step, after impacts with its cube root.

    Attributes:
        model: the model.
        begun: checkpoint at which the motion begins; None for its start.
    """

    model: Model
    begun: Checkpoint | None

    asks_a_third = True

    def factor(self, history: History, other: History) -> float:
        """The factor by the power of the step that the coarser motion errs with."""
        finer = is_finer(history, other)
        are_struck = _has_blows(history if finer else other)
        return (HALVED_WHERE_STRUCK if are_struck else HALVED_WHERE_RUBBING) - finer

    def least(self, history: History, paths: Paths) -> float:
        """Error of the paths of free rods by the imbalance of their energy.

        Where a rod rolls out flat, its place of contact runs along it within a step. Such a step may lose energy, and
        two motions that lose alike are near each other and far from the true motion: the missing energy tells the
        error. A rod that is held comes back, whatever energy its waves have lost. The error is no more than the
        longest way of the paths: the energy of rods at rest is rounding.
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
    """Whether impacts make a motion erratic: more exact steps do not bring its paths nearer to a limit.

    Errors that go with LEAST_SLOPE or faster fall to a half from one distance to the next.

    Args:
        history: the motion.
        distance: between the paths of two motions, over the length, of which one has steps TIGHTER times as exact.
        before: between the paths of two motions TIGHTER times as coarse; infinite where it is not known.
        tolerance: error of the paths allowed, over the length.
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
