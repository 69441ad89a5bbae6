"""Equations of motion whose solution is known, or is found by an explicit method in other coordinates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.motion_equations import MotionEquations

Field = Callable[[float, FloatArray, FloatArray], FloatArray]
"""(t, x, v) ↦ acceleration or its derivative."""


def explicit(acceleration: Field, by_position: Field, by_velocity: Field, size: int = 1) -> MotionEquations:
    """a = f(t, x, v)."""
    identity = np.eye(size)
    return MotionEquations(
        np.ones(size, dtype=bool),
        lambda t, x, v, a: a - acceleration(t, x, v),
        lambda t, x, v, a: (-by_position(t, x, v), -by_velocity(t, x, v), identity),
    )


def complex_steps(
    residual: Callable[..., FloatArray], t: float, x: FloatArray, v: FloatArray, a: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """∂F/∂x, ∂F/∂v, ∂F/∂a of an analytic residual to rounding."""

    def derivative(argument: int) -> FloatArray:
        columns = []
        for entry in range(len(x)):
            arguments = [np.array(values, dtype=complex) for values in (x, v, a)]
            arguments[argument][entry] += 1e-30j
            columns.append(residual(t, *arguments).imag / 1e-30)
        return np.column_stack(columns)

    return derivative(0), derivative(1), derivative(2)


def reference(acceleration: Field, x: FloatArray, v: FloatArray, start: float, end: float) -> FloatArray:
    """Positions and velocities at the end by DOP853, shape (2, n)."""
    size = len(x)

    def rate(t: float, y: FloatArray) -> FloatArray:
        return np.concatenate([y[size:], acceleration(t, y[:size], y[size:])])

    solution = solve_ivp(rate, (start, end), np.concatenate([x, v]), method="DOP853", rtol=3e-14, atol=1e-14)
    return np.asarray(solution.y[:, -1].reshape(2, size))


def duffing_force(t: float, x: FloatArray, v: FloatArray) -> FloatArray:
    return -x - x**3 - 0.1 * v + np.cos(2 * t)


DUFFING = explicit(
    duffing_force,
    lambda t, x, v: np.diag(-1 - 3 * x**2),
    lambda t, x, v: np.array([[-0.1]]),
)


def pendulum_force(t: float, x: FloatArray, v: FloatArray) -> FloatArray:
    return -np.sin(x)


PENDULUM_ANGLE = explicit(
    pendulum_force,
    lambda t, x, v: np.diag(-np.cos(x)),
    lambda t, x, v: np.zeros((1, 1)),
)


def _pendulum_jacobians(
    t: float, x: FloatArray, v: FloatArray, a: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    stiffness = np.diag([x[2], x[2], 0.0])
    stiffness[:2, 2] = x[:2]
    stiffness[2, :2] = x[:2]
    return stiffness, np.zeros((3, 3)), np.diag([1.0, 1.0, 0.0])


PENDULUM = MotionEquations(
    np.array([True, True, False]),
    lambda t, x, v, a: np.array([a[0] + x[2] * x[0], a[1] + x[2] * x[1] + 1, (x[0] ** 2 + x[1] ** 2 - 1) / 2]),
    _pendulum_jacobians,
)
"""The pendulum in the plane with a multiplier: index 3."""


def pendulum_state(angle: float, rate: float) -> tuple[FloatArray, FloatArray]:
    """Positions with the multiplier, and velocities, of the pendulum at an angle."""
    x = np.array([np.sin(angle), -np.cos(angle), rate**2 + np.cos(angle)])
    v = np.array([rate * np.cos(angle), rate * np.sin(angle), 0.0])
    return x, v


@dataclass(frozen=True)
class Top:
    """A rigid body free to turn: three rows of Euler's equations, one of the quaternion's norm.

    Attributes:
        moments: principal moments of inertia, shape (3,).
    """

    moments: FloatArray

    @staticmethod
    def left(q: FloatArray) -> FloatArray:
        """2 (vector part of Q* ∘): takes dQ/dt to the angular velocity in body axes, shape (3, 4)."""
        w, x, y, z = q
        return 2 * np.array([[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])

    def residual(self, t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        angular_velocity = self.left(x) @ v
        # The product of dQ*/dt and dQ/dt has no vector part: only the second derivative remains.
        angular_acceleration = self.left(x) @ a
        spin = self.moments * angular_velocity
        couple = self.moments * angular_acceleration + np.cross(angular_velocity, spin)
        return np.append(couple, x @ x - 1.0)

    def jacobians(
        self, t: float, x: FloatArray, v: FloatArray, a: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        return complex_steps(self.residual, t, x, v, a)

    @property
    def equations(self) -> MotionEquations:
        return MotionEquations(np.ones(4, dtype=bool), self.residual, self.jacobians)

    def reference(self, q: FloatArray, v: FloatArray, end: float) -> FloatArray:
        """Quaternion at the end, by Euler's equations for the angular velocity, shape (4,)."""

        def rate(t: float, y: FloatArray) -> FloatArray:
            angular_velocity = y[4:]
            turning = self.left(y[:4]).T @ angular_velocity / 4
            spin = self.moments * angular_velocity
            return np.concatenate([turning, np.cross(spin, angular_velocity) / self.moments])

        start = np.concatenate([q, self.left(q) @ v])
        solution = solve_ivp(rate, (0, end), start, method="DOP853", rtol=3e-14, atol=1e-14)
        return np.asarray(solution.y[:4, -1])


@dataclass(frozen=True)
class TurningPair:
    """A free light mass in the plane, a frame that turns about it, and in the frame a mass of one on a spring.

    As at the free end of a rod whose coordinates begin there: to move the light mass alone, x₀ and x₁ must move and
    x₃ and x₄ take it back in the frame, whose angle x₂ changes in every step.

    Attributes:
        light: the light mass.
    """

    light: float

    def residual(self, t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        cosine, sine = np.cos(x[2]), np.sin(x[2])
        frame = np.array([[cosine, -sine], [sine, cosine]])
        across = np.array([[0.0, -1.0], [1.0, 0.0]])
        arm = frame @ (np.array([1.0, 0.0]) + x[3:])
        acceleration = a[:2] + a[2] * (across @ arm) - v[2] ** 2 * arm
        acceleration = acceleration + 2 * v[2] * (across @ frame @ v[3:]) + frame @ a[3:]
        pulling = self.light * a[:2] + acceleration
        turning = a[2] + (across @ arm) @ acceleration
        stretching = frame.T @ acceleration + x[3:]
        return np.concatenate([pulling, [turning], stretching])

    def jacobians(
        self, t: float, x: FloatArray, v: FloatArray, a: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        return complex_steps(self.residual, t, x, v, a)

    @property
    def equations(self) -> MotionEquations:
        return MotionEquations(np.ones(5, dtype=bool), self.residual, self.jacobians)

    def acceleration(self, t: float, x: FloatArray, v: FloatArray) -> FloatArray:
        rest = np.zeros(5)
        mass = self.jacobians(t, x, v, rest)[2]
        return np.asarray(np.linalg.solve(mass, -self.residual(t, x, v, rest)))
