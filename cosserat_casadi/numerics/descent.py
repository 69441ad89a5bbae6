"""Descent of an energy to a minimum, told only its gradient and its Hessian: off saddles, along negative curvature.

A trust region: the step minimises the quadratic model of the energy in a ball; at a saddle it leaves along the
eigenvector of the lowest eigenvalue. The energy need not be written: its change over a step is the work of the
gradient along it. J. Nocedal, S. J. Wright, *Numerical Optimization*, 2nd ed., Springer 2006, sections 4.1 and 4.3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.newton import length_of, relative_norm

WORK_NODES, WORK_WEIGHTS = (leggauss(4)[0] + 1) / 2, leggauss(4)[1] / 2
"""Quadrature of the work along a step."""


@dataclass(frozen=True)
class Energy:
    """An energy of n variables by its derivatives.

    Attributes:
        gradient: x ↦ shape (n,).
        hessian: x ↦ shape (n, n), symmetric.
    """

    gradient: Callable[[FloatArray], FloatArray]
    hessian: Callable[[FloatArray], FloatArray]

    def change(self, x: FloatArray, step: FloatArray) -> float:
        """Energy at x + step less that at x."""
        rates = [self.gradient(x + s * step) @ step for s in WORK_NODES]
        return float(WORK_WEIGHTS @ rates)


@dataclass(frozen=True)
class DescentSettings:
    """Limits of a descent.

    Attributes:
        tolerance: bound on the relative norm of the gradient.
        flat: an eigenvalue above minus this share of the largest counts as not negative.
        longest: longest step (2-norm; about one radian of bending a unit).
        shortest: radius below which the descent gives up.
        steps: most steps, taken or refused.
    """

    tolerance: float = 1e-8
    flat: float = 1e-9
    longest: float = 1.0
    shortest: float = 1e-9
    steps: int = 300


def descend(energy: Energy, start: FloatArray, side: float, settings: DescentSettings) -> FloatArray | None:
    """The minimum at the foot of a start; None where a number is not finite or the steps run out.

    Args:
        energy: what to lower.
        start: shape (n,).
        side: +1 or −1, the side on which a saddle is left.
        settings: limits.
    """
    x, radius = start, settings.longest / 4
    model: tuple[FloatArray, FloatArray, FloatArray] | None = None
    for _ in range(settings.steps):
        if model is None:
            model = _quadratic_model(energy, x)
        if model is None:
            return None
        gradient, values, vectors = model
        low = float(values[0]) < -settings.flat * max(1.0, float(np.abs(values).max()))
        if relative_norm(gradient, x) <= settings.tolerance and not low:
            return x
        step = vectors @ ball_minimum(values, vectors.T @ gradient, radius, side)
        predicted = float(gradient @ step + (vectors.T @ step) ** 2 @ values / 2)
        actual = energy.change(x, step)
        ratio = actual / predicted if predicted < 0.0 and np.isfinite(actual) else -1.0
        if ratio > 0.1:
            x, model = x + step, None
        if ratio < 0.25:
            radius = length_of(step) / 4
        elif ratio > 0.75 and length_of(step) > 0.9 * radius:
            radius = min(2 * radius, settings.longest)
        if radius < settings.shortest:
            return None
    return None


def _quadratic_model(energy: Energy, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Gradient, eigenvalues and eigenvectors of the Hessian; None where they are not finite."""
    gradient, hessian = energy.gradient(x), energy.hessian(x)
    if not (np.all(np.isfinite(gradient)) and np.all(np.isfinite(hessian))):
        return None
    values, vectors = np.linalg.eigh((hessian + hessian.T) / 2)
    return gradient, values, vectors


def ball_minimum(values: FloatArray, slopes: FloatArray, radius: float, side: float) -> FloatArray:
    """Minimum of Σ slope z + ½ value z² over the ball |z| ≤ radius, shape (n,).

    Args:
        values: curvatures, ascending, shape (n,).
        slopes: shape (n,).
        radius: of the ball.
        side: direction along the first axis where its slope is zero and its curvature negative.
    """
    tiny = 1e-12 * max(1.0, float(np.abs(values).max()))
    if values[0] > tiny:
        inside = -slopes / values
        if length_of(inside) <= radius:
            return np.asarray(inside)
    floor = max(0.0, -float(values[0])) + tiny
    at_floor = -slopes / (values + floor)
    if length_of(at_floor) < radius:
        # The hard case: no slope along the lowest curvature, the ball's surface is reached along it.
        at_floor[0] += side * np.sqrt(radius**2 - length_of(at_floor) ** 2) if values[0] < -tiny else 0.0
        return np.asarray(at_floor)
    low, high = floor, floor + length_of(slopes) / radius
    for _ in range(100):
        shift = (low + high) / 2
        low, high = (shift, high) if length_of(slopes / (values + shift)) > radius else (low, shift)
        if high - low <= 1e-6 * high:
            break
    return np.asarray(-slopes / (values + high))
