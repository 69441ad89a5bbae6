"""Gaps between two rods at all sections, between the nodes too, and the places of their minima."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.contact.gaps import DENSE
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.properties import RodProperties

LOOKED_AT = 4
"""Only one of so many sections of DENSE is searched for valleys."""

FINER = (20.0, 400.0, 8000.0)
"""Factors by which sections move closer together in each refinement of a place."""

AROUND = np.linspace(-1.0, 1.0, 41)
"""Offsets from a section at which a valley is refined, over the distance of sections."""


class Valley(NamedTuple):
    """Two sections at which the gap of two rods has a local minimum.

    Attributes:
        places: abscissae on both rods.
        gap: gap over the length of the first rod.
    """

    places: tuple[float, float]
    gap: float


class RodLine(Protocol):
    """The centre line of a rod, and its radii."""

    @property
    def length(self) -> float:
        """Length of the rod in the scene, m."""

    def centres(self, X: FloatArray) -> FloatArray:
        """World positions at abscissae X, shape (k, 3), m."""

    def radius(self, X: FloatArray) -> FloatArray:
        """Radii at abscissae X of any shape, m."""


@dataclass(frozen=True)
class SolvedLine:
    """The centre line of a rod of a solution.

    Attributes:
        solution: the solution.
        rod: name of the rod.
    """

    solution: Solution
    rod: str

    @property
    def length(self) -> float:
        """Length of the rod in the scene, m."""
        return float(self._properties.length)

    def centres(self, X: FloatArray) -> FloatArray:
        """World positions at abscissae X, shape (k, 3), m."""
        return self.solution.pose(X, self.rod).position

    def radius(self, X: FloatArray) -> FloatArray:
        """Radii at abscissae X of any shape, m."""
        return section_radius(self._properties, X.ravel()).reshape(X.shape)

    @property
    def _properties(self) -> RodProperties:
        return self.solution.model.discrete.rods[self.rod].properties


@dataclass(frozen=True)
class RodsApart:
    """Two rods that may touch.

    Attributes:
        first: centre line of the rod whose sections are searched.
        second: centre line of the other rod.
    """

    first: RodLine
    second: RodLine

    @classmethod
    def of(cls, solution: Solution, rods: tuple[str, str]) -> RodsApart:
        """Two rods of a solution, by name."""
        return cls(*(SolvedLine(solution, rod) for rod in rods))

    def gaps(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gaps of sections X of the first rod over its length, and the nearest abscissae of the second rod, (k,) each.

        No gap is less than the true one, because the place on the second rod is the nearest one but for rounding.
        """
        own = self.first.centres(X)
        places = DENSE[(self._distances(own[:, None], self._positions[1]) - self._radii[1]).argmin(axis=1)]
        spacing = DENSE[1]
        for finer in FINER:
            offsets = spacing * np.array([-1.0, 0.0, 1.0])
            around = np.clip(places, spacing, 1.0 - spacing)[:, None] + offsets
            positions = self.second.centres(around.ravel()).reshape(len(X), 3, 3)
            values = self._distances(own[:, None], positions) - self.second.radius(around)
            before, middle, after = values.T
            bend = before - 2 * middle + after
            step = np.where(bend > 0.0, (before - after) / np.where(bend > 0.0, 2 * bend, 1.0), np.sign(before - after))
            places = np.clip(around[:, 1] + spacing * np.clip(step, -1.0, 1.0), 0.0, 1.0)
            spacing = DENSE[1] / finer
        distances = self._distances(own, self.second.centres(places))
        gaps = distances - self.first.radius(X) - self.second.radius(places)
        return gaps / self.first.length, places

    @cached_property
    def valleys(self) -> list[Valley]:
        """All local minima of the gap."""
        first, second = (positions[::LOOKED_AT] for positions in self._positions)
        radii = [radius[::LOOKED_AT] for radius in self._radii]
        gaps = self._distances(first[:, None], second) - radii[0][:, None] - radii[1]
        places = DENSE[::LOOKED_AT]
        return [self._refined(float(places[row])) for row in np.flatnonzero(_lowest(gaps).any(axis=1))]

    def _refined(self, near: float) -> Valley:
        """Refine the valley near a section of the first rod."""
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
        return [line.centres(DENSE) for line in (self.first, self.second)]

    @cached_property
    def _radii(self) -> list[FloatArray]:
        return [line.radius(DENSE) for line in (self.first, self.second)]

    @staticmethod
    def _distances(first: FloatArray, second: FloatArray) -> FloatArray:
        return np.asarray(np.linalg.norm(first - second, axis=-1))


def distance_of_lines(
    first: Sequence[FloatArray], second: Sequence[FloatArray]
) -> tuple[float, FloatArray, FloatArray]:
    """Distance of two points of two lines, m, with its gradient (2,) and Hessian (2, 2) by both parameters.

    Args:
        first: a point of a line, and first and second derivatives of the line with its parameter, shape (3,) each, m.
        second: a point of the other line, and derivatives there.
    """
    (own, way, bend), (other, other_way, other_bend) = first, second
    distance = float(np.linalg.norm(own - other))
    normal = (own - other) / distance
    ways = np.array([way, -other_way])
    across = (np.eye(3) - np.outer(normal, normal)) / distance
    return distance, ways @ normal, ways @ across @ ways.T + np.diag([normal @ bend, -normal @ other_bend])


def _lowest(values: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether each entry of a matrix is at most as large as its eight neighbours."""
    rows, columns = values.shape
    framed = np.pad(values, 1, constant_values=np.inf)
    neighbours = [framed[i : i + rows, j : j + columns] for i in range(3) for j in range(3)]
    return np.asarray(np.all([values <= other for other in neighbours], axis=0))
