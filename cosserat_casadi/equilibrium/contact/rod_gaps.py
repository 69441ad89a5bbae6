"""Distances of two solved rods from each other, between the nodes too, and where these are least."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.contact.gaps import DENSE
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.typing import FloatArray

LOOKED_AT = 4
"""Sections of DENSE of which one is looked at for valleys."""

FINER = (20.0, 400.0, 8000.0)
"""How much nearer each other sections are in turn where a place is refined."""

AROUND = np.linspace(-1.0, 1.0, 41)
"""Places about a section, in distances of sections, at which a valley is refined."""


class Valley(NamedTuple):
    """Two sections at which the gap of two rods is the least about them.

    Attributes:
        places: abscissae on both rods.
        gap: over the length of the first.
    """

    places: tuple[float, float]
    gap: float


@dataclass(frozen=True)
class RodsApart:
    """Two rods of a solution.

    Attributes:
        solution: the solution.
        rods: names of the rods.
    """

    solution: Solution
    rods: tuple[str, str]

    def gaps(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gap of each section of the first rod to the second, over the length of the first, and X there, (k,) each.

        No gap is less than the true one: the place on the second rod is nearest but for rounding.
        """
        own = self.solution.pose(X, self.rods[0]).position
        places = DENSE[(self._distances(own[:, None], self._positions[1]) - self._radii[1]).argmin(axis=1)]
        spacing = DENSE[1]
        for finer in FINER:
            offsets = spacing * np.array([-1.0, 0.0, 1.0])
            around = np.clip(places, spacing, 1.0 - spacing)[:, None] + offsets
            positions = self.solution.pose(around.ravel(), self.rods[1]).position.reshape(len(X), 3, 3)
            values = self._distances(own[:, None], positions) - self._radius(1, around)
            before, middle, after = values.T
            bend = before - 2 * middle + after
            step = np.where(bend > 0.0, (before - after) / np.where(bend > 0.0, 2 * bend, 1.0), np.sign(before - after))
            places = np.clip(around[:, 1] + spacing * np.clip(step, -1.0, 1.0), 0.0, 1.0)
            spacing = DENSE[1] / finer
        distances = self._distances(own, self.solution.pose(places, self.rods[1]).position)
        gaps = distances - self._radius(0, X) - self._radius(1, places)
        return gaps / self._length, places

    @cached_property
    def valleys(self) -> list[Valley]:
        """All places at which the gap is the least about them."""
        first, second = (positions[::LOOKED_AT] for positions in self._positions)
        radii = [radius[::LOOKED_AT] for radius in self._radii]
        gaps = self._distances(first[:, None], second) - radii[0][:, None] - radii[1]
        places = DENSE[::LOOKED_AT]
        return [self._refined(float(places[row])) for row in np.flatnonzero(_lowest(gaps).any(axis=1))]

    def _refined(self, near: float) -> Valley:
        """The valley about a section of the first rod."""
        spacing = DENSE[LOOKED_AT]
        for _ in FINER:
            X = np.unique(np.clip(near + spacing * AROUND, 0.0, 1.0))
            gaps, others = self.gaps(X)
            least = int(gaps.argmin())
            near, valley = float(X[least]), Valley((float(X[least]), float(others[least])), float(gaps[least]))
            spacing *= AROUND[1] - AROUND[0]
        return valley

    @cached_property
    def _positions(self) -> list[FloatArray]:
        return [self.solution.pose(DENSE, rod).position for rod in self.rods]

    @cached_property
    def _radii(self) -> list[FloatArray]:
        return [self._radius(number, DENSE) for number in range(len(self.rods))]

    def _radius(self, number: int, X: FloatArray) -> FloatArray:
        properties = self.solution.model.discrete.rods[self.rods[number]].properties
        return section_radius(properties, X.ravel()).reshape(X.shape)

    @property
    def _length(self) -> float:
        return float(self.solution.model.discrete.rods[self.rods[0]].properties.length)

    @staticmethod
    def _distances(first: FloatArray, second: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.norm(first - second, axis=-1))


def _lowest(values: FloatArray) -> npt.NDArray[np.bool_]:
    """Which entries of a matrix are not above any of their eight neighbours."""
    rows, columns = values.shape
    framed = np.pad(values, 1, constant_values=np.inf)
    neighbours = [framed[i : i + rows, j : j + columns] for i in range(3) for j in range(3)]
    return np.asarray(np.all([values <= other for other in neighbours], axis=0))
