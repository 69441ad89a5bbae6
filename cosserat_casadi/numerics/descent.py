"""Descent of an energy to a minimum by gradient and Hessian, which leaves saddles along negative curvature.

Each step of this trust-region method minimises the quadratic model of the energy in a ball; a saddle is left along the
eigenvector of the lowest eigenvalue. If symmetry leaves no slope there, the largest coordinate, and not rounding,
selects the direction (neutral.py), equally on every discretisation. The energy itself is not needed: its change over a
step is the work of the gradient along it. J. Nocedal, S. J. Wright, *Numerical Optimization*, 2nd ed., Springer 2006,
sections 4.1 and 4.3.
See docs/theory.md, section 9.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.neutral import TIE, direction_in
from cosserat_casadi.numerics.newton import length_of, relative_norm

_GAUSS_NODES, _GAUSS_WEIGHTS = gauss_legendre(4)

WORK_NODES = (_GAUSS_NODES + 1) / 2
"""Quadrature nodes of the work along a step, as shares of it."""

WORK_WEIGHTS = _GAUSS_WEIGHTS / 2
"""Quadrature weights of the work, which sum to one."""

ACCEPT_ABOVE = 0.1
"""Least share of the predicted decrease for a step to be taken."""

SHRINK_BELOW = 0.25
"""Share of the predicted decrease below which the trust region shrinks."""

GROW_ABOVE = 0.75
"""Share of the predicted decrease above which the trust region may grow."""

AT_BOUNDARY = 0.9
"""Share of the radius above which a step counts as limited by the trust region."""

RADIUS_TOLERANCE = 1e-6
"""Relative accuracy of the multiplier with which a step reaches the boundary of the ball."""

BISECTIONS = 100
"""Most bisections in the search for that multiplier."""


@dataclass(frozen=True)
class Energy:
    """An energy of n variables, given by its derivatives.

    Attributes:
        gradient: x ↦ shape (n,).
        hessian: x ↦ shape (n, n), symmetric.
    """

    gradient: Callable[[FloatArray], FloatArray]
    hessian: Callable[[FloatArray], FloatArray]

    def change(self, x: FloatArray, step: FloatArray) -> float:
        """Energy at x + step minus energy at x."""
        rates = [self.gradient(x + share * step) @ step for share in WORK_NODES]
        return float(WORK_WEIGHTS @ rates)


@dataclass(frozen=True)
class DescentSettings:
    """Limits of a descent.

    Attributes:
        tolerance: bound on the relative norm of the gradient.
        flat: share of the largest eigenvalue below which a negative one counts as zero.
        longest: longest step (2-norm; one unit is about one radian of bending).
        shortest: radius below which the descent gives up.
        steps: most steps, taken or refused.
    """

    tolerance: float = 1e-8
    flat: float = 1e-9
    longest: float = 1.0
    shortest: float = 1e-9
    steps: int = 300


@dataclass(frozen=True)
class _QuadraticModel:
    """Quadratic model of an energy about a point, in the axes of its Hessian.

    Attributes:
        gradient: gradient of the energy, shape (n,).
        curvatures: eigenvalues of the Hessian, ascending, shape (n,).
        axes: eigenvectors of the Hessian as columns, n×n.
    """

    gradient: FloatArray
    curvatures: FloatArray
    axes: FloatArray

    def is_saddle(self, flat: float) -> bool:
        """Whether a curvature is below minus ``flat`` times the largest, or times one if that is larger."""
        sizes = np.abs(self.curvatures)
        scale = max(1.0, float(sizes.max()))
        lowest = float(self.curvatures[0])
        return lowest < -flat * scale

    def step(self, radius: float, side: float) -> FloatArray:
        """The step to the minimum in the ball of a radius, shape (n,)."""
        slopes = self.axes.T @ self.gradient
        minimum = ball_minimum(self.curvatures, slopes, radius, side)
        return np.asarray(self.axes @ minimum)

    def change(self, step: FloatArray) -> float:
        """Change of the energy over a step in the model."""
        components = self.axes.T @ step
        linear = self.gradient @ step
        quadratic = components**2 @ self.curvatures / 2
        return float(linear + quadratic)


def descend(energy: Energy, start: FloatArray, side: float, settings: DescentSettings) -> FloatArray | None:
    """Find the minimum below a start point.

    Args:
        energy: energy to minimise.
        start: start point, shape (n,).
        side: +1 or −1, the side on which a saddle is left.
        settings: limits of the descent.

    Returns:
        the minimum, shape (n,); None if a number is not finite or the steps run out.
    """
    x = start
    radius = settings.longest / 4
    model: _QuadraticModel | None = None
    for _ in range(settings.steps):
        if model is None:
            model = _quadratic_model(energy, x, settings.tolerance)
        if model is None:
            return None
        flat = relative_norm(model.gradient, x) <= settings.tolerance
        if flat and not model.is_saddle(settings.flat):
            return x

        step = model.step(radius, side)
        foreseen, actual = model.change(step), energy.change(x, step)
        # There is no decrease if none is predicted, or a number is not finite.
        agreement = actual / foreseen if foreseen < 0.0 and np.isfinite(actual) else -1.0
        if agreement > ACCEPT_ABOVE:
            x = x + step
            # A refused step leaves the model as it is: only the ball shrinks.
            model = None
        length = length_of(step)
        if agreement < SHRINK_BELOW:
            radius = length / 4
        elif agreement > GROW_ABOVE and length > AT_BOUNDARY * radius:
            # A step inside the ball says nothing of a larger one.
            radius = min(2 * radius, settings.longest)
        if radius < settings.shortest:
            return None
    return None


def _quadratic_model(energy: Energy, x: FloatArray, tolerance: float) -> _QuadraticModel | None:
    """Make the quadratic model at a point; None if a number is not finite.

    Args:
        energy: energy to minimise.
        x: the point, shape (n,).
        tolerance: bound on the relative norm of a slope that counts as zero.
    """
    gradient = energy.gradient(x)
    hessian = energy.hessian(x)
    if not np.all(np.isfinite(gradient)) or not np.all(np.isfinite(hessian)):
        return None
    curvatures, axes = np.linalg.eigh((hessian + hessian.T) / 2)
    if curvatures.size and curvatures[0] < 0.0:
        return _with_way_out(gradient, curvatures, axes, x, tolerance)
    return _QuadraticModel(gradient, curvatures, axes)


def _with_way_out(
    gradient: FloatArray, curvatures: FloatArray, axes: FloatArray, x: FloatArray, tolerance: float
) -> _QuadraticModel:
    """Make the quadratic model with a negative curvature, whose first axis does not depend on rounding.

    A round rod buckles to any side: the axes of equal lowest curvatures are any basis of their space. The first axis
    becomes the direction that :func:`direction_in` chooses. A slope in that space that is rounding is set to zero, so
    that it does not choose the side.
    """
    lowest = curvatures[0]
    alike = curvatures <= lowest + TIE * abs(lowest)
    space = axes[:, alike]
    count = space.shape[1]
    chosen = space.T @ direction_in(space)
    # A basis of the space that begins with the direction; the factorisation may have turned it round.
    basis, factor = np.linalg.qr(np.column_stack([chosen, np.eye(count)]))
    turned = axes.copy()
    turned[:, alike] = space @ basis
    turned[:, 0] *= np.sign(factor[0, 0])
    slopes = turned[:, alike].T @ gradient
    if relative_norm(slopes, x) <= tolerance:
        gradient = gradient - turned[:, alike] @ slopes
    return _QuadraticModel(gradient, curvatures, turned)


def ball_minimum(curvatures: FloatArray, slopes: FloatArray, radius: float, side: float) -> FloatArray:
    """Minimum of Σ slope z + ½ curvature z² over the ball |z| ≤ radius.

    It is z = −slope / (curvature + μ) with μ = 0 inside; else with the μ for which z is on the boundary and no
    curvature + μ is negative: Nocedal and Wright, theorem 4.1.

    Args:
        curvatures: curvatures, ascending, shape (n,).
        slopes: slopes, shape (n,).
        radius: radius of the ball.
        side: direction along the first axis if its slope is zero and its curvature negative.

    Returns:
        the minimum z, shape (n,).
    """
    lowest = float(curvatures[0])
    rounding = 1e-12 * max(1.0, float(np.abs(curvatures).max()))
    if lowest > rounding:
        inside = -slopes / curvatures
        if length_of(inside) <= radius:
            return np.asarray(inside)

    # Any smaller μ would leave curvature + μ negative along the lowest curvature.
    smallest = max(0.0, -lowest) + rounding
    at_smallest = -slopes / (curvatures + smallest)
    if length_of(at_smallest) < radius:
        # The hard case: no slope along the lowest curvature, the boundary is reached along it.
        rest = side * np.sqrt(radius**2 - length_of(at_smallest) ** 2) if lowest < -rounding else 0.0
        at_smallest[0] += rest
        return np.asarray(at_smallest)

    # The length of z falls as μ grows, and is below the radius at the upper end.
    low = smallest
    high = smallest + length_of(slopes) / radius
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if length_of(slopes / (curvatures + middle)) > radius:
            low = middle
        else:
            high = middle
        if high - low <= RADIUS_TOLERANCE * high:
            break
    return np.asarray(-slopes / (curvatures + high))
