"""Distance of a rod from an obstacle as a function of the abscissa, from the positions of its nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_along, distances
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class GapsAlong:
    """Distance of a rod's surface from an obstacle along the rod, over its length.

    Attributes:
        rod: name of the rod.
        obstacle: the obstacle.
        ends: abscissae of the ends of its elements, shape (E + 1,).
        positions: positions of the nodes of each element, shape (E, N + 1, 3), m.
        tangents: their derivatives by X, shape (E, N + 1, 3), m.
        bends: second derivatives without parts along the tangent, shape (E, N + 1, 3), m.
        radii: radii at base and tip, between which the radius is linear, shape (2,), m.
        length: length of the rod, m.
    """

    rod: str
    obstacle: scenes.ObstacleRecord
    ends: FloatArray
    positions: FloatArray
    tangents: FloatArray
    bends: FloatArray
    radii: FloatArray
    length: float

    @property
    def _intervals(self) -> int:
        count: int = self.positions.shape[1]
        return count - 1

    def abscissae(self, local: FloatArray) -> FloatArray:
        """Abscissae of points of every element, given by coordinates in [0, 1] along it, shape (E, k)."""
        return np.asarray(self.ends[:-1, None] + np.diff(self.ends)[:, None] * local)

    def values(self, local: FloatArray) -> FloatArray:
        """Distances there, shape (E, k)."""
        X = self.abscissae(local)
        positions = chebyshev.interpolation_matrix(self._intervals, local) @ self.positions
        found = distances(self.obstacle, positions.reshape(-1, 3)).reshape(X.shape)
        return np.asarray((found - self._radius(X)) / self.length)

    def distances(self, X: FloatArray) -> FloatArray:
        """Distances at abscissae X, shape (k,)."""
        elements, local = self._located(X)
        weights = chebyshev.interpolation_matrix(self._intervals, local)
        positions = np.einsum("kn,knj->kj", weights, self.positions[elements])
        return np.asarray((distances(self.obstacle, positions) - self._radius(X)) / self.length)

    def _located(self, X: FloatArray) -> tuple[npt.NDArray[np.int64], FloatArray]:
        """Element of each abscissa, and coordinate in it, in [0, 1]; a break belongs to the element that it ends."""
        elements = np.searchsorted(self.ends[1:-1], X, side="left").astype(np.int64)
        widths = np.diff(self.ends)[elements]
        # The ends of elements are places of contact: a computed place equals one to the last digit.
        return elements, np.clip((X - self.ends[elements]) / widths, 0.0, 1.0)

    def at(self, X: float) -> tuple[float, float, float]:
        """Distance and its first and second derivative by X; at an element end from the side of the base."""
        elements, local = self._located(np.array([X]))
        element = elements[0]
        weights = chebyshev.interpolation_matrix(self._intervals, local)[0]
        position = weights @ self.positions[element]
        first = weights @ self.tangents[element]
        second = weights @ self.bends[element]
        distance = distance_along(self.obstacle, position, first, second)
        gap = distance.value - float(self._radius(np.array(X)))
        slope = distance.slope - float(self.radii[1] - self.radii[0])
        return gap / self.length, slope / self.length, distance.bend / self.length

    def _radius(self, X: FloatArray) -> FloatArray:
        base, tip = self.radii
        return np.asarray(base + X * (tip - base))
