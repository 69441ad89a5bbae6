"""The inside of a tube: the union of the balls of radius R(s) about the points c(s) of a line.

Its distance from inside is max over s of R(s) − |r − c(s)|, which is exact if the balls make a smooth surface. The line
is a natural cubic spline over the distances between its points, which is straight beyond its ends; the radius is a
cubic spline without slope at its ends, constant beyond them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import final

import casadi as ca
import numpy as np

from cosserat_casadi.errors import Problem
from cosserat_casadi.maths.splines import cubic_coefficients
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.obstacle import Obstacle, across, rounded_norm
from cosserat_casadi.scene.obstacle_records import Lumen

STARTS = 6
"""Starts between two points of the line of the search for the nearest point."""

NEWTON_STEPS = 5
"""Newton steps to the ball that reaches farthest: each doubles the digits, and two more give two exact derivatives."""

SMALLEST_SLOPE = 0.1
"""Least derivative of the stationarity by which a Newton step divides, so that no step diverges where balls nest."""


class CentreLine:
    """Line and radius of a lumen over the abscissa s, m.

    Attributes:
        knots: abscissae of the points, shape (k,), m: the distances between the points, summed.
    """

    def __init__(self, lumen: Lumen) -> None:
        points = np.asarray(lumen.points)
        chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
        self.knots = np.concatenate([[0.0], np.cumsum(chords)])
        # Without curvature at the ends, so that the straight parts beyond continue smoothly.
        self._line = cubic_coefficients(self.knots, points, natural=True)
        self._radius = cubic_coefficients(self.knots, np.asarray(lumen.radii)[:, None])
        symbol = ca.SX.sym("s")
        self._function = ca.Function("line", [symbol], list(self.written(symbol)))

    def at(self, s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Points of the line, shape (k, 3), and radii, shape (k,), at abscissae, m."""
        line, radii = self._function.map(len(s))(s)
        return line.full().T, radii.full()[0]

    def written(self, s: Matrix) -> tuple[Matrix, Matrix]:
        """Point, 3×1, and radius, 1×1, of one abscissa as expressions."""
        start, end = float(self.knots[0]), float(self.knots[-1])
        inside = ca.fmin(ca.fmax(s, start), end)
        _, slope, quadratic, cubic = self._line[-1]
        width = end - float(self.knots[-2])
        at_start = ca.DM(self._line[0, 1]) * ca.fmin(s - start, 0.0)
        at_end = ca.DM(slope + width * (2 * quadratic + width * 3 * cubic)) * ca.fmax(s - end, 0.0)
        line, radius = (self._spline(coefficients, inside) for coefficients in (self._line, self._radius))
        return line + at_start + at_end, radius

    def _spline(self, coefficients: FloatArray, s: Matrix) -> Matrix:
        """A spline of d entries at one abscissa between its ends, d×1.

        Its third derivative alone jumps at the knots: a cubic and truncated powers, c₀(s) + Σ j_i (s − s_i)₊³.
        """
        local = s - float(self.knots[0])
        constant, linear, quadratic, cubic = (ca.DM(row) for row in coefficients[0])
        value: Matrix = constant + local * (linear + local * (quadratic + local * cubic))
        for knot, jump in zip(self.knots[1:-1], np.diff(coefficients[:, 3], axis=0), strict=True):
            value = value + ca.DM(jump) * ca.fmax(s - float(knot), 0.0) ** 3
        return value


@final
class LumenObstacle(Obstacle[Lumen]):
    """The points outside a tube."""

    record = Lumen
    forbidden = "outside"

    def distance(self, obstacle: Lumen, point: Matrix) -> Matrix:
        """R(s) − |r − c(s)|, m, at the s where it is largest."""
        line = CentreLine(obstacle)
        size = min(obstacle.radii)
        s = _farthest_start(line, point)
        step = _newton_step(line, size)
        for _ in range(NEWTON_STEPS):
            s = step(s, point)
        centre, radius = line.written(s)
        return radius - rounded_norm(point - centre, size)

    def faults(self, obstacle: Lumen, radius: float) -> Iterator[Problem]:
        """A lumen is wider than its rods everywhere, and its radius of curvature exceeds its radius."""
        centre_line = CentreLine(obstacle)
        s = np.linspace(centre_line.knots[0], centre_line.knots[-1], 40 * len(centre_line.knots))
        line, radii = centre_line.at(s)
        where = f"obstacles.{obstacle.name}"
        narrowest = float(radii.min())
        # A smooth wall that reaches the middle of the lumen would press the rod from all sides there.
        if obstacle.width is not None and radius < narrowest <= radius + obstacle.width:
            problem = f"must be less than the play of the rod, {narrowest - radius:.4g} m, got {obstacle.width:.4g}"
            yield Problem(f"{where}.width", problem, "take a small part of the play")
        if narrowest <= radius:
            at = line[int(np.argmin(radii))]
            problem = f"has the radius {narrowest:.4g} m at {np.round(at, 6).tolist()}, its rod {radius:.4g} m"
            yield Problem(f"{where}.radius", problem, "a lumen is wider than the rods in it")
        bend = _sharpest_bend(centre_line, s)
        if bend * float(radii.max()) >= 1.0:
            problem = f"bend to a radius of {1 / bend:.4g} m, less than the radius of the lumen"
            remedy = "a lumen must not bend about its own walls: move the points apart"
            yield Problem(f"{where}.points", problem, remedy)

    def mesh(self, obstacle: Lumen, near: FloatArray, size: float) -> FloatArray:
        """Rings about the line."""
        centre_line = CentreLine(obstacle)
        s = np.linspace(centre_line.knots[0], centre_line.knots[-1], 12 * len(centre_line.knots))
        line, radii = centre_line.at(s)
        tangents = np.gradient(line, s, axis=0)
        around = np.linspace(0.0, 2 * np.pi, 25)
        rings = []
        first, second = across(tangents[0])
        for tangent in tangents:
            # Carried along the line, so that the rings do not twist against each other.
            direction = tangent / np.linalg.norm(tangent)
            first = first - direction * (direction @ first)
            first /= np.linalg.norm(first)
            second = np.cross(direction, first)
            rings.append(np.cos(around)[:, None] * first + np.sin(around)[:, None] * second)
        return np.asarray(line[:, None] + radii[:, None, None] * np.asarray(rings))


def _newton_step(line: CentreLine, size: float) -> ca.Function:
    """(s, r) ↦ s after a Newton step for R′ |r − c| + (r − c)·c′ = 0: there R − |r − c| is stationary."""
    s = ca.SX.sym("s")
    point = ca.SX.sym("point", 3)
    centre, radius = line.written(s)
    arm = point - centre
    along = ca.jacobian(centre, s)
    slope = ca.jacobian(radius, s) * rounded_norm(arm, size) + ca.dot(arm, along)
    # The stationarity falls through zero there, with the slope −|c′|² on the line itself.
    fall = -ca.jacobian(slope, s)
    step = slope / ca.fmax(fall, SMALLEST_SLOPE * ca.sumsqr(along))
    return ca.Function("step", [s, point], [s + step])


def _farthest_start(line: CentreLine, point: Matrix) -> Matrix:
    """The start, out of some between the points, whose ball reaches farthest over a point."""
    inner = [np.linspace(a, b, STARTS, endpoint=False) for a, b in itertools.pairwise(line.knots)]
    starts = np.concatenate([*inner, line.knots[-1:]])
    centres, radii = line.at(starts)
    chosen: Matrix = ca.DM(float(starts[0]))
    farthest = float(radii[0]) - ca.norm_2(point - ca.DM(centres[0]))
    for start, centre, radius in zip(starts[1:], centres[1:], radii[1:], strict=True):
        reach = float(radius) - ca.norm_2(point - ca.DM(centre))
        # A choice between numbers, which has no derivative.
        chosen = ca.if_else(reach > farthest, float(start), chosen)
        farthest = ca.fmax(farthest, reach)
    return chosen


def _sharpest_bend(centre_line: CentreLine, s: FloatArray) -> float:
    """Largest curvature of the line, 1/m."""
    line, _ = centre_line.at(s)
    first = np.gradient(line, s, axis=0)
    second = np.gradient(first, s, axis=0)
    curvature = np.linalg.norm(np.cross(first, second), axis=1) / np.linalg.norm(first, axis=1) ** 3
    return float(curvature.max())
