"""Distance of a rod from an obstacle as a function of the abscissa, from the positions of its nodes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.body_obstacles import in_axes_of
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_along, distances
from cosserat_casadi.equilibrium.contact.rod_gaps import RodsApart, distance_of_lines
from cosserat_casadi.equilibrium.solution import SolvedPoses
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class LineOfNodes:
    """The centre line of a rod.

    Attributes:
        ends: abscissae of the ends of its elements, shape (E + 1,).
        positions: positions of the nodes of each element, shape (E, N + 1, 3), m.
        tangents: their derivatives by X, shape (E, N + 1, 3), m.
        bends: second derivatives without parts along the tangent, shape (E, N + 1, 3), m.
        radii: radii at base and tip, between which the radius is linear, shape (2,), m.
        length: length of the rod, m.
    """

    ends: FloatArray
    positions: FloatArray
    tangents: FloatArray
    bends: FloatArray
    radii: FloatArray
    length: float

    def seen_from(self, body: SolvedPoses) -> LineOfNodes:
        """The line in the axes of a body."""
        positions = in_axes_of(body, self.positions)
        return replace(
            self, positions=positions, tangents=self.tangents @ body.rotation, bends=self.bends @ body.rotation
        )

    @property
    def _intervals(self) -> int:
        count: int = self.positions.shape[1]
        return count - 1

    def abscissae(self, local: FloatArray) -> FloatArray:
        """Abscissae of points of every element, given by coordinates in [0, 1] along it, shape (E, k)."""
        return np.asarray(self.ends[:-1, None] + np.diff(self.ends)[:, None] * local)

    def centres(self, X: FloatArray) -> FloatArray:
        """Positions at abscissae X, shape (k, 3), m."""
        elements, local = self._located(X)
        weights = chebyshev.interpolation_matrix(self._intervals, local)
        return np.asarray(np.einsum("kn,knj->kj", weights, self.positions[elements]))

    def _located(self, X: FloatArray) -> tuple[npt.NDArray[np.int64], FloatArray]:
        """Element of each abscissa, and coordinate in it, in [0, 1]; a break belongs to the element that it ends."""
        elements = np.searchsorted(self.ends[1:-1], X, side="left").astype(np.int64)
        widths = np.diff(self.ends)[elements]
        # The ends of elements are places of contact: a computed place equals one to the last digit.
        return elements, np.clip((X - self.ends[elements]) / widths, 0.0, 1.0)

    def point(self, X: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position and its first and second derivative by X; at an element end from the side of the base."""
        elements, local = self._located(np.array([X]))
        element = elements[0]
        weights = chebyshev.interpolation_matrix(self._intervals, local)[0]
        return weights @ self.positions[element], weights @ self.tangents[element], weights @ self.bends[element]

    @property
    def taper(self) -> float:
        """Derivative of the radius by X, m."""
        return float(self.radii[1] - self.radii[0])

    def radius(self, X: FloatArray) -> FloatArray:
        """Radii at abscissae X of any shape, m."""
        return np.asarray(self.radii[0] + X * self.taper)


@dataclass(frozen=True)
class GapsAlong(ABC):
    """Distance of a rod's surface from an obstacle, or from another rod, along the rod, over its length.

    Attributes:
        line: centre line of the rod.
    """

    line: LineOfNodes

    def values(self, local: FloatArray) -> FloatArray:
        """Distances at points of every element, given in [0, 1] along it, shape (E, k)."""
        X = self.line.abscissae(local)
        return self.distances(X.ravel()).reshape(X.shape)

    @abstractmethod
    def distances(self, X: FloatArray) -> FloatArray:
        """Distances at abscissae X, shape (k,)."""

    @abstractmethod
    def at(self, X: float) -> tuple[float, float, float]:
        """Distance and its first and second derivative by X; at an element end from the side of the base."""

    @abstractmethod
    def depth(self, X: float) -> float:
        """Depth of the middle of the obstacle, or of the other rod, below a touching centre line, over the length."""


@dataclass(frozen=True)
class ObstacleGaps(GapsAlong):
    """Distance from an obstacle; the line is in the axes of the obstacle.

    Attributes:
        obstacle: the obstacle.
    """

    obstacle: scenes.ObstacleRecord

    def distances(self, X: FloatArray) -> FloatArray:
        """Distances at abscissae X, shape (k,)."""
        found = distances(self.obstacle, self.line.centres(X)) - self.line.radius(X)
        return np.asarray(found / self.line.length)

    def at(self, X: float) -> tuple[float, float, float]:
        """Distance and its first and second derivative by X; at an element end from the side of the base."""
        distance = distance_along(self.obstacle, *self.line.point(X))
        gap = distance.value - float(self.line.radius(np.array(X)))
        length = self.line.length
        return gap / length, (distance.slope - self.line.taper) / length, distance.bend / length

    def depth(self, X: float) -> float:
        """Radius of the section and of the bar or ball, over the length; infinite without a middle."""
        return (float(self.line.radius(np.array(X))) + self.obstacle.thickness / 2) / self.line.length


@dataclass(frozen=True)
class RodsGaps(GapsAlong):
    """Distance from the nearest section of another rod.

    Attributes:
        other: centre line of the other rod.
    """

    other: LineOfNodes

    @cached_property
    def apart(self) -> RodsApart:
        """Both rods."""
        return RodsApart(self.line, self.other)

    def place(self, X: float) -> float:
        """Abscissa of the section of the other rod that is nearest to a section."""
        return float(self.apart.gaps(np.array([X]))[1][0])

    def distances(self, X: FloatArray) -> FloatArray:
        """Distances at abscissae X, shape (k,)."""
        return self.apart.gaps(X)[0]

    def at(self, X: float) -> tuple[float, float, float]:
        """Distance and its first and second derivative with X while the place on the other rod follows."""
        gap, slopes, bends = self.between(X, self.place(X))
        if bends[1, 1] > 0.0:
            bends[0, 0] -= bends[0, 1] ** 2 / bends[1, 1]
        return gap, float(slopes[0]), float(bends[0, 0])

    def depth(self, X: float) -> float:
        """Radii of both sections, over the length."""
        radii = self.line.radius(np.array(X)) + self.other.radius(np.array(self.place(X)))
        return float(radii) / self.line.length

    def between(self, X: float, other: float) -> tuple[float, FloatArray, FloatArray]:
        """Gap at a section of either rod, and its derivatives with both abscissae, shape (2,) and (2, 2)."""
        distance, slopes, bends = distance_of_lines(self.line.point(X), self.other.point(other))
        radii = self.line.radius(np.array(X)) + self.other.radius(np.array(other))
        tapers = np.array([self.line.taper, self.other.taper])
        length = self.line.length
        return float(distance - radii) / length, (slopes - tapers) / length, bends / length
