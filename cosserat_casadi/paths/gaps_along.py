"""Distance of a rod from an obstacle as a function of the abscissa, from the positions of its nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.surfaces import distance_from, surface
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class GapsAlong:
    """Distance of a rod's surface from an obstacle along the rod, over its length.

    Attributes:
        rod: name of the rod.
        obstacle: the obstacle.
        ends: abscissae of the ends of its elements, shape (E + 1,).
        positions: of the nodes of each element, shape (E, N + 1, 3), m.
        tangents: their derivatives with X, shape (E, N + 1, 3), m.
        bends: second derivatives, but for what lies along the tangent, shape (E, N + 1, 3), m.
        radii: of the sections at base and tip, between which the radius is linear, shape (2,), m.
        length: of the rod, m.
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
    def pair(self) -> tuple[str, str]:
        """Names of rod and obstacle."""
        return self.rod, self.obstacle.name

    @property
    def _intervals(self) -> int:
        count: int = self.positions.shape[1]
        return count - 1

    def abscissae(self, local: FloatArray) -> FloatArray:
        """Abscissae of points of every element, given in [0, 1] along it, shape (E, k)."""
        return np.asarray(self.ends[:-1, None] + np.diff(self.ends)[:, None] * local)

    def values(self, local: FloatArray) -> FloatArray:
        """Distances there, shape (E, k)."""
        X = self.abscissae(local)
        positions = chebyshev.interpolation_matrix(self._intervals, local) @ self.positions
        distances = distance_from(self.obstacle).map(X.size)(positions.reshape(-1, 3).T).full()[0]
        return np.asarray((distances.reshape(X.shape) - self._radius(X)) / self.length)

    def at(self, X: float) -> tuple[float, float, float]:
        """Distance and its first and second derivative with X, at an end of an element those from the base's side."""
        element = int(np.searchsorted(self.ends[1:-1], X, side="left"))
        width = self.ends[element + 1] - self.ends[element]
        # The ends of elements are places of contact: a place that was computed lies on one to the last digit.
        local = min((X - self.ends[element]) / width, 1.0)
        weights = chebyshev.interpolation_matrix(self._intervals, [local])[0]
        position = weights @ self.positions[element]
        first = weights @ self.tangents[element]
        second = weights @ self.bends[element]
        distance, gradient, hessian = (part.full() for part in surface(self.obstacle)(position))
        normal = gradient[:, 0]
        gap = float(distance[0, 0]) - float(self._radius(np.array(X)))
        slope = float(normal @ first) - float(self.radii[1] - self.radii[0])
        curvature = float(first @ hessian @ first + normal @ second)
        return gap / self.length, slope / self.length, curvature / self.length

    def _radius(self, X: FloatArray) -> FloatArray:
        base, tip = self.radii
        return np.asarray(base + X * (tip - base))
