"""Rotation increments by the Magnus expansion: R' = R K^, one interval at a time.

On an interval of width h with midpoint X_m let τ = (X − X_m)/h and h K(X) = α₁ + α₂ τ + α₃ τ² + α₄ τ³ + O(h⁵).
The increment is R(X + h) = R(X) exp(Ω^) with Ω a sum of commutators of the α. Orders four and six are the Magnus
series itself, cut where the order is reached; order eight is nested as in S. Blanes, F. Casas, J. Ros, *Improved
high order integrators based on the Magnus expansion*, BIT 40 (2000). The series is usually written for Y' = A Y;
here the rate multiplies from the right, so that the commutator [a, b] becomes −a × b.

Why this and not a linear solve: the increments are rotations to rounding whatever the step, the cost is linear
in the number of nodes, and the derivative of the product of exponentials is known in closed form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial

import casadi as ca
import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from cosserat_casadi.maths.rotation import cross, dot, hat, horner
from cosserat_casadi.maths.typing import Matrix

ORDERS = (4, 6, 8)


def coefficient_count(order: int) -> int:
    """Number of Taylor coefficients α that a method of this order reads: order / 2."""
    if order not in ORDERS:
        raise ValueError(f"the order of a Magnus method is one of {ORDERS}, got {order}")
    return order // 2


def taylor_from_samples(count: int, points: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Gauss points on τ ∈ [−½, ½] and the matrix from samples of h K there to α₁ … α_count.

    The α are those whose polynomial has the same moments ∫ τⁱ h K dτ, i < count, as the sampled function; so the
    leading term of Ω is ∫ K dX without error as long as the samples integrate K.

    Args:
        count: number of coefficients α.
        points: number of Gauss–Legendre points, at least ``count``.

    Returns:
        the points, shape (points,), and the matrix, shape (count, points).
    """
    x, weights = legendre.leggauss(points)
    tau = x / 2
    powers = np.arange(count)
    moments = (weights / 2) * tau ** powers[:, None]
    total = powers[:, None] + powers[None, :]
    gram = np.where(total % 2 == 0, 0.5**total / (total + 1), 0.0)
    return np.asarray(tau, dtype=np.float64), np.asarray(np.linalg.solve(gram, moments), dtype=np.float64)


def rotation_increment(alpha: list[Matrix]) -> Matrix:
    """Magnus rotation vector Ω of one interval, of order 2·len(alpha).

    Args:
        alpha: one to four 3×k matrices, the Taylor coefficients of h K about the midpoint (radians). One is
            enough, and exact, where K keeps its direction.

    Returns:
        Ω, 3×k, such that R(X + h) ≈ R(X) exp(Ω^).
    """
    return _INCREMENTS[len(alpha)](*alpha)


def _bracket(a: Matrix, b: Matrix) -> Matrix:
    return -cross(a, b)


def _order_four(a1: Matrix, a2: Matrix) -> Matrix:
    return a1 - _bracket(a1, a2) / 12


def _order_six(a1: Matrix, a2: Matrix, a3: Matrix) -> Matrix:
    """The series with its nested products multiplied out, a × (b × c) = b (a·c) − c (a·b): fewer operations."""
    square = dot(a1, a1) / 720
    along = 1 + dot(a1, a3) / 360 - dot(a2, a2) / 240, dot(a1, a2) / 240, 1 / 12 - 2 * square
    across = _times(1 / 12 + square, a1) + a3 / 240
    return _times(along[0], a1) + _times(along[1], a2) + _times(along[2], a3) + cross(across, a2)


def _times(factor: Matrix, vectors: Matrix) -> Matrix:
    """Each column of ``vectors`` times its own factor."""
    return ca.vertcat(*[factor * row for row in ca.vertsplit(vectors)])


def _order_eight(a1: Matrix, a2: Matrix, a3: Matrix, a4: Matrix) -> Matrix:
    b2 = a2 + 3 / 28 * a4
    s1 = _bracket(a1 + a3 / 28, b2) / -28
    r1 = _bracket(a1, s1 - a3 / 14) / 3
    s2 = _bracket(a1 + a3 / 28 + s1, b2 + r1)
    r2 = _bracket(a1 + 1.25 * s1, 2 * a3 + s2 + 0.5 * _bracket(a2, s1))
    mean = a1 + a3 / 12
    s3 = _bracket(mean - 7 / 3 * s1 - s2 / 6, 63 * r1 + r2 - 9 * a2 - 2.25 * a4)
    return mean - 7 / 120 * s2 + s3 / 360


def _commuting(a1: Matrix) -> Matrix:
    return a1


_INCREMENTS: dict[int, Callable[..., Matrix]] = {1: _commuting, 2: _order_four, 3: _order_six, 4: _order_eight}

# Series in u = θ² that are exact to rounding for θ ≤ 2: sin(θ/2) / (θ/2), (θ − sin θ)/θ³, and the h of stiffness.
_HALF_SINE = [(-1) ** n / (4**n * factorial(2 * n + 1)) for n in range(9)]
_ANGLE_MINUS_SINE = [(-1) ** n / factorial(2 * n + 3) for n in range(10)]
_SECOND = [-((-1) ** n) * 2 * (n + 1) / factorial(2 * n + 6) for n in range(9)]


@dataclass(frozen=True)
class Increment:
    """The rotation exp(Ω^) of one interval and its derivatives, by series without branches.

    Exact to rounding for |Ω| ≤ 2 rad. A grid that turns by more than that between neighbouring nodes resolves nothing;
    the value stays finite. The factors depend on the angle alone, so that they serve in any frame.

    Attributes:
        omega: rotation vector Ω, 3×1, rad.
        half_sine: sin(θ/2) / (θ/2), 1×1, with θ = |Ω|.
        cubic: c = (θ − sin θ)/θ³, 1×1.
    """

    omega: Matrix
    half_sine: Matrix
    cubic: Matrix

    @property
    def quaternion(self) -> Matrix:
        """Quaternion of exp(Ω^), 4×1.

        The cosine of the half angle is (sin θ / θ) / (2 sin(θ/2) / θ): what T needs takes the place of its series.
        """
        cosine = (1 - ca.sumsqr(self.omega) * self.cubic) / self.half_sine
        return ca.vertcat(cosine, self.half_sine / 2 * self.omega)

    @property
    def tangent(self) -> Matrix:
        """T = 1 + b Ω^ + c Ω^² with δ(exp Ω^) = (T δΩ)^ exp Ω^ and b = (1 − cos θ)/θ², 3×3."""
        return ca.DM.eye(3) + hat(self._linear * self.omega) + hat(self.cubic * self.omega) @ hat(self.omega)

    def pulled(self, moment: Matrix) -> Matrix:
        """The product Tᵀ M: what a moment M (3×1, in the frame in which the increment begins) does on δΩ, 3×1."""
        return moment + cross(self.omega, self.cubic * cross(self.omega, moment) - self._linear * moment)

    def stiffness(self, moment: Matrix) -> Matrix:
        """The form V with ∂(Tᵀ M)/∂Ω = Tᵀ V T: how the work of a moment on an increment changes with it, 3×3.

        V = ½ M^ − k (Ω^ M^ + M^ Ω^) + (M·Ω) h/(2b) Ω^², where h = (c − 2 (1 − 2 b)/θ²)/θ² and k = (c + θ² h)/(4 b).
        Only Ω and M enter, so that the form turns with them into any frame.

        Args:
            moment: M, 3×1, in the same frame as Ω.
        """
        square = ca.sumsqr(self.omega)
        half = 0.5 / self.half_sine**2
        second = horner(_SECOND, square)
        k = half * (self.cubic + square * second)
        bent = half * second * ca.dot(moment, self.omega) * self.omega - k * moment
        product = hat(self.omega) @ hat(bent)
        return hat(moment / 2) + product + product.T

    @property
    def _linear(self) -> Matrix:
        """The factor b."""
        return self.half_sine**2 / 2


def increment(omega: Matrix) -> Increment:
    """The increment of a rotation vector Ω, 3×1, rad."""
    square = ca.sumsqr(omega)
    return Increment(omega, horner(_HALF_SINE, square), horner(_ANGLE_MINUS_SINE, square))
