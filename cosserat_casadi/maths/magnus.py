"""Rotation increments by the Magnus expansion: R' = R K^, one interval at a time.

On an interval of width h with midpoint X_m let τ = (X − X_m)/h and h K(X) = α₁ + α₂ τ + α₃ τ² + α₄ τ³ + O(h⁵). The
increment is R(X + h) = R(X) exp(Ω^) with Ω a sum of commutators of the α. Orders four and six are the Magnus series
itself, cut where the order is reached; order eight is nested as in S. Blanes, F. Casas, J. Ros, *Improved high order
integrators based on the Magnus expansion*, BIT 40 (2000). The series is usually written for Y' = A Y; here the rate
multiplies from the right, so that the commutator [a, b] becomes −a × b.

In contrast to a linear solve the increments are rotations to rounding for every step, the cost is linear in the number
of nodes, and the derivative of the product of exponentials is known in closed form. See docs/theory.md, sections 4 and
7.

Rates of the rotation exp(Ω^) of one interval and of its derivative T are by series without branches. T = 1 + b Ω^ + c
Ω^² depends on time through Ω and, by its factors b and c, on u = θ². With b(u) = (1 − cos θ)/θ² and c(u) = (θ − sin
θ)/θ³ the chain rule gives ḃ = b′ u̇ and b̈ = b″ u̇² + b′ ü.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import factorial
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.rotation import cross, dot, hat
from cosserat_casadi.maths.typing import AnyMatrix, FloatArray, Matrix

TERMS = 12
"""Terms of the series of the factors, enough for second derivatives that are exact to rounding for θ ≤ 2."""

ORDERS = (4, 6, 8)


def _derivatives(coefficients: list[float]) -> tuple[list[float], list[float]]:
    """Coefficients of the first and the second derivative of a series."""
    first = [n * coefficient for n, coefficient in enumerate(coefficients)][1:]
    second = [n * coefficient for n, coefficient in enumerate(first)][1:]
    return first, second


# (1 − cos θ)/θ² and (θ − sin θ)/θ³ in u = θ²: the derivatives are exact to rounding for θ ≤ 2, as the factors are.
_LINEAR = _derivatives([(-1) ** n / factorial(2 * n + 2) for n in range(TERMS)])
_CUBIC = _derivatives([(-1) ** n / factorial(2 * n + 3) for n in range(TERMS)])

Orders = tuple[Matrix, Matrix, Matrix]
"""A quantity and its first two rates."""


@dataclass(frozen=True)
class IncrementRates:
    """An increment in motion.

    Attributes:
        increment: the rotation.
        omega_rate: Ω̇, 3×1, rad/s.
        omega_acceleration: Ω̈, 3×1, rad/s².
    """

    increment: Increment
    omega_rate: Matrix
    omega_acceleration: Matrix

    @property
    def spin(self) -> Matrix:
        """The angular velocity b = T Ω̇ that an interval with the rotation exp(Ω^) adds, 3×1, rad/s."""
        linear, cubic = self._linear[0], self._cubic[0]
        turned = cross(self.increment.omega, self.omega_rate)
        return self.omega_rate + linear * turned + cubic * cross(self.increment.omega, turned)

    @property
    def spin_rate(self) -> Matrix:
        """The rate of b, Ṫ Ω̇ + T Ω̈, 3×1, rad/s²."""
        omega = self.increment.omega
        linear, linear_rate, _ = self._linear
        cubic, cubic_rate, _ = self._cubic
        turned = cross(omega, self.omega_rate)
        # Ω̇ × Ω̇ is zero: the rate of Ω × Ω̇ is Ω × Ω̈.
        turned_rate = cross(omega, self.omega_acceleration)
        twice = cubic_rate * turned + cubic * turned_rate
        once = linear_rate * turned + linear * turned_rate
        return self.omega_acceleration + once + cross(omega, twice) + cubic * cross(self.omega_rate, turned)

    @cached_property
    def tangent(self) -> Orders:
        """T, Ṫ and T̈, 3×3 each."""
        omega, rate, acceleration = (hat(vector) for vector in self._omega)
        linear = [hat(vector) for vector in _product(self._linear, self._omega)]
        cubic = [hat(vector) for vector in _product(self._cubic, self._omega)]
        value = ca.DM.eye(3) + linear[0] + cubic[0] @ omega
        first = linear[1] + cubic[1] @ omega + cubic[0] @ rate
        second = linear[2] + cubic[2] @ omega + 2 * (cubic[1] @ rate) + cubic[0] @ acceleration
        return value, first, second

    @property
    def _omega(self) -> Orders:
        return self.increment.omega, self.omega_rate, self.omega_acceleration

    @cached_property
    def _linear(self) -> Orders:
        """The factor b and its rates."""
        return self._factor(self.increment.linear, _LINEAR)

    @cached_property
    def _cubic(self) -> Orders:
        """The factor c and its rates."""
        return self._factor(self.increment.cubic, _CUBIC)

    def _factor(self, value: Matrix, derivatives: tuple[list[float], list[float]]) -> Orders:
        """A factor and its rates from the series of its derivatives by u."""
        omega, rate, acceleration = self._omega
        square = ca.sumsqr(omega)
        square_rate = 2 * ca.dot(omega, rate)
        square_acceleration = 2 * (ca.sumsqr(rate) + ca.dot(omega, acceleration))
        first, second = (horner(coefficients, square) for coefficients in derivatives)
        return value, first * square_rate, second * square_rate**2 + first * square_acceleration


def _product(factor: Orders, vector: Orders) -> Orders:
    """A factor times a vector and its rates."""
    f, f_rate, f_acceleration = factor
    v, v_rate, v_acceleration = vector
    first = f_rate * v + f * v_rate
    second = f_acceleration * v + 2 * (f_rate * v_rate) + f * v_acceleration
    return f * v, first, second


def coefficient_count(order: int) -> int:
    """Number of Taylor coefficients α for a method of this order: order / 2."""
    if order not in ORDERS:
        raise ValueError(f"the order of a Magnus method is one of {ORDERS}, got {order}")
    return order // 2


@cache
def taylor_from_samples(count: int, points: int) -> tuple[FloatArray, FloatArray]:
    """Gauss points on τ ∈ [−½, ½] and the matrix from samples of h K there to α₁ … α_count.

    The polynomial of the α has the same moments ∫ τⁱ h K dτ, i < count, as the sampled function; so the leading term of
    Ω is ∫ K dX without error as long as the samples integrate K.

    Args:
        count: number of coefficients α.
        points: number of Gauss–Legendre points, at least ``count``.

    Returns:
        the points, shape (points,), and the matrix, shape (count, points); neither may be written to.
    """
    # Gauss–Legendre on [−1, 1], halved.
    x, weights = gauss_legendre(points)
    tau = np.asarray(x / 2, dtype=np.float64)
    powers = np.arange(count)
    samples_of_powers = tau ** powers[:, None]
    moments = (weights / 2) * samples_of_powers
    # The Gram matrix of the powers of τ: ∫ τᵖ dτ over [−½, ½] is (½)ᵖ / (p + 1) for an even p, else zero.
    total = powers[:, None] + powers
    even = total % 2 == 0
    gram = np.where(even, 0.5**total / (total + 1), 0.0)
    matrix = np.linalg.solve(gram, moments)
    return tau, np.asarray(matrix, dtype=np.float64)


def rotation_increment(alpha: Sequence[AnyMatrix]) -> AnyMatrix:
    """Magnus rotation vector Ω of one interval, of order 2·len(alpha).

    Args:
        alpha: one to four 3×k matrices, the Taylor coefficients of h K about the midpoint (radians). One is
            enough, and exact, where K keeps its direction.

    Returns:
        Ω, 3×k, such that R(X + h) ≈ R(X) exp(Ω^).
    """
    omega: AnyMatrix = _INCREMENTS[len(alpha)](*alpha)
    return omega


def _bracket(a: AnyMatrix, b: AnyMatrix) -> AnyMatrix:
    """Commutator of two rates that multiply from the right."""
    return -cross(a, b)


def _commuting(a1: AnyMatrix) -> AnyMatrix:
    """The series up to h²: α₁ without commutators, exact where K keeps its direction."""
    return a1


def _order_four(a1: AnyMatrix, a2: AnyMatrix) -> AnyMatrix:
    """The series up to h⁴: α₁ − [α₁, α₂]/12."""
    return a1 - _bracket(a1, a2) / 12


def _order_six(a1: AnyMatrix, a2: AnyMatrix, a3: AnyMatrix) -> AnyMatrix:
    """The series up to h⁶.

    Its nested products are multiplied out, a × (b × c) = b (a·c) − c (a·b): fewer operations. The result is a sum of
    the α, each times a scalar, and one cross product with α₂.
    """
    square = dot(a1, a1) / 720
    part_of_3 = dot(a1, a3) / 360
    part_of_2 = dot(a2, a2) / 240
    factor_1 = 1 + part_of_3 - part_of_2
    factor_2 = dot(a1, a2) / 240
    factor_3 = 1 / 12 - 2 * square
    along_1 = _times(factor_1, a1)
    along_2 = _times(factor_2, a2)
    along_3 = _times(factor_3, a3)
    lever = _times(1 / 12 + square, a1) + a3 / 240
    across = cross(lever, a2)
    return along_1 + along_2 + along_3 + across


def _order_eight(a1: AnyMatrix, a2: AnyMatrix, a3: AnyMatrix, a4: AnyMatrix) -> AnyMatrix:
    """The series up to h⁸ with four nested commutators (Blanes, Casas and Ros 2000)."""
    # s and r are sums of nested commutators, in the order in which they enter each other.
    b1 = a1 + a3 / 28
    b2 = a2 + 3 / 28 * a4
    s1 = _bracket(b1, b2) / -28
    r1 = _bracket(a1, s1 - a3 / 14) / 3
    s2 = _bracket(b1 + s1, b2 + r1)
    nested = _bracket(a2, s1)
    r2 = _bracket(
        a1 + 1.25 * s1,
        2 * a3 + s2 + 0.5 * nested,
    )
    # The mean of h K over the interval, up to h⁴.
    mean = a1 + a3 / 12
    s3 = _bracket(
        mean - 7 / 3 * s1 - s2 / 6,
        63 * r1 + r2 - 9 * a2 - 2.25 * a4,
    )
    return mean - 7 / 120 * s2 + s3 / 360


def _times(factor: AnyMatrix, vectors: AnyMatrix) -> AnyMatrix:
    """Each column of ``vectors`` times its own factor."""
    rows = [factor * row for row in ca.vertsplit(vectors)]
    return ca.vertcat(*rows)


_INCREMENTS: dict[int, Callable[..., Any]] = {1: _commuting, 2: _order_four, 3: _order_six, 4: _order_eight}

# Series in u = θ² that are exact to rounding for θ ≤ 2: sin(θ/2) / (θ/2), (θ − sin θ)/θ³, and the h of stiffness.
_HALF_SINE = [(-1) ** n / (4**n * factorial(2 * n + 1)) for n in range(9)]
_ANGLE_MINUS_SINE = [(-1) ** n / factorial(2 * n + 3) for n in range(10)]
_SECOND = [-((-1) ** n) * 2 * (n + 1) / factorial(2 * n + 6) for n in range(9)]


def horner(coefficients: Sequence[float], u: AnyMatrix) -> AnyMatrix:
    """Value of Σ coefficients[n] uⁿ, entrywise in u.

    Args:
        coefficients: two or more, the constant first.
        u: any shape.
    """
    *lower, last = coefficients
    value = lower[-1] + u * last
    for coefficient in reversed(lower[:-1]):
        value = coefficient + u * value
    return value


@dataclass(frozen=True)
class Increment:
    """The rotation exp(Ω^) of one interval and its derivatives, by series without branches.

    They are exact to rounding for |Ω| ≤ 2 rad. A grid with larger turns between neighbouring nodes does not resolve the
    rod; the values stay finite. The factors depend on the angle alone, and so hold in every frame.

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

        The cosine of the half angle is (sin θ / θ) / (2 sin(θ/2) / θ), from the factors of T, without a further series.
        """
        square = ca.sumsqr(self.omega)
        sine_over_angle = 1 - square * self.cubic
        cosine = sine_over_angle / self.half_sine
        axis = self.half_sine / 2 * self.omega
        return ca.vertcat(cosine, axis)

    @property
    def tangent(self) -> Matrix:
        """T = 1 + b Ω^ + c Ω^² with δ(exp Ω^) = (T δΩ)^ exp Ω^ and b = (1 − cos θ)/θ², 3×3."""
        linear = hat(self.linear * self.omega)
        cubic = hat(self.cubic * self.omega)
        return ca.DM.eye(3) + linear + cubic @ hat(self.omega)

    def pulled(self, moment: Matrix) -> Matrix:
        """The product Tᵀ M, 3×1: generalised moment on δΩ of a moment M, 3×1, in the frame of the increment's start."""
        # Horner's rule in Ω^: Tᵀ = 1 − b Ω^ + c Ω^² = 1 + Ω^ (c Ω^ − b).
        turned = self.cubic * cross(self.omega, moment)
        bent = turned - self.linear * moment
        return moment + cross(self.omega, bent)

    def stiffness(self, moment: Matrix) -> Matrix:
        """The form V with ∂(Tᵀ M)/∂Ω = Tᵀ V T: change, with the increment, of a moment's work on it, 3×3.

        V = ½ M^ − k (Ω^ M^ + M^ Ω^) + (M·Ω) h/(2b) Ω^², where h = (c − 2 (1 − 2 b)/θ²)/θ² and k = (c + θ² h)/(4 b).
        Only Ω and M enter, so that the form turns with them into any frame (docs/theory.md, section 7).

        Args:
            moment: M, 3×1, in the same frame as Ω.
        """
        square = ca.sumsqr(self.omega)
        # 1 / (4 b), since b = half_sine² / 2.
        half = 0.5 / self.half_sine**2
        second = horner(_SECOND, square)
        k = half * (self.cubic + square * second)
        # Both products with Ω^ in one: Ω^ m^ and its transpose m^ Ω^, where m carries half of the last term.
        along = half * second * ca.dot(moment, self.omega)
        bent = along * self.omega - k * moment
        product = hat(self.omega) @ hat(bent)
        return hat(moment / 2) + product + product.T

    @property
    def linear(self) -> Matrix:
        """The factor b = (1 − cos θ)/θ²."""
        return self.half_sine**2 / 2


def increment(omega: Matrix) -> Increment:
    """The increment of a rotation vector Ω, 3×1, rad."""
    square = ca.sumsqr(omega)
    return Increment(
        omega=omega,
        half_sine=horner(_HALF_SINE, square),
        cubic=horner(_ANGLE_MINUS_SINE, square),
    )
