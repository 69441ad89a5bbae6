"""Rates of the rotation exp(Ω^) of one interval and of its derivative T, by series without branches.

T = 1 + b Ω^ + c Ω^² depends on time through Ω and, by its factors b and c, on u = θ². With b(u) = (1 − cos θ)/θ² and
c(u) = (θ − sin θ)/θ³ the chain rule gives ḃ = b′ u̇ and b̈ = b″ u̇² + b′ ü.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import factorial

import casadi as ca

from cosserat_casadi.maths.magnus import Increment, horner
from cosserat_casadi.maths.rotation import cross, hat
from cosserat_casadi.maths.typing import Matrix

TERMS = 12
"""Terms of the series of the factors, enough for second derivatives that are exact to rounding for θ ≤ 2."""


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
        """The angular velocity b = T Ω̇ that an interval that turns by exp(Ω^) adds, 3×1, rad/s."""
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
        """A factor and its rates from the series of its derivatives with u."""
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
