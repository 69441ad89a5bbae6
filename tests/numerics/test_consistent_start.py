"""Accelerations and multipliers at the start of a motion, and what is told of inconsistent ones."""

from __future__ import annotations

import numpy as np
from moving import PENDULUM, Top, pendulum_state
from numpy.testing import assert_allclose

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.consistent_start import DEGREE, consistent_start, regular_inverse
from cosserat_casadi.numerics.motion_equations import MotionEquations


def test_pendulum_starts_with_its_multiplier() -> None:
    x, v = pendulum_state(1.2, 0.4)
    guess = x * np.array([1.0, 1.0, 0.0])
    start = consistent_start(PENDULUM, 0.0, guess, v, interval=0.02)
    # λ = ω² + cos θ, θ̈ = −sin θ.
    acceleration = -np.sin(1.2) * np.array([np.cos(1.2), np.sin(1.2)]) - 0.4**2 * x[:2]
    assert_allclose(start.instant.x, x, rtol=0, atol=1e-10)
    assert_allclose(start.instant.a, [*acceleration, 0.0], rtol=0, atol=1e-10)
    assert start.position_error < 1e-15
    assert start.velocity_error < 1e-12
    assert start.balance_error < 1e-14
    assert start.massless == 0


def test_inconsistent_positions_and_velocities_are_told() -> None:
    x, v = pendulum_state(1.2, 0.4)
    # The constraint is (r² − 1)/2, its rate x·v.
    start = consistent_start(PENDULUM, 0.0, 1.1 * x, v + 0.3 * x, interval=0.02)
    assert_allclose(start.position_error, 0.105, rtol=1e-12, atol=0)
    assert_allclose(start.velocity_error, 1.1 * 0.3, rtol=1e-8, atol=0)


def test_constraint_that_moves_in_time() -> None:
    # A mass on a given path, x = sin 3t: a = −9 sin 3t, and the multiplier is what the path takes.
    stiffness = np.array([[0.0, 1.0], [1.0, 0.0]])
    equations = MotionEquations(
        np.array([True, False]),
        lambda t, x, v, a: np.array([2.0 * a[0] + x[1], x[0] - np.sin(3 * t)]),
        lambda *_: (stiffness, np.zeros((2, 2)), np.diag([2.0, 0.0])),
    )
    t = 0.2
    x = np.array([np.sin(0.6), 0.0])
    start = consistent_start(equations, t, x, np.array([3 * np.cos(0.6), 0.0]), interval=0.02)
    assert_allclose(start.instant.a[0], -9 * np.sin(0.6), rtol=0, atol=1e-8)
    assert_allclose(start.instant.x[1], 18 * np.sin(0.6), rtol=0, atol=1e-8)
    assert start.velocity_error < 1e-11
    at_rest = consistent_start(equations, t, x, np.zeros(2), interval=0.02)
    assert_allclose(at_rest.velocity_error, 3 * np.cos(0.6), rtol=1e-9, atol=0)


def test_norm_of_a_quaternion_is_a_constraint() -> None:
    top = Top(np.array([1.0, 2.0, 2.7]))
    q = np.array([0.6, 0.0, 0.8, 0.0])
    angular_velocity = np.array([0.2, 1.5, 0.1])
    v = top.left(q).T @ angular_velocity / 4
    start = consistent_start(top.equations, 0.0, q, v, interval=0.02)
    euler = np.cross(top.moments * angular_velocity, angular_velocity) / top.moments
    assert_allclose(top.left(q) @ start.instant.a, euler, rtol=0, atol=1e-10)
    # Q·Q̈ = −Q̇·Q̇. Rounding is multiplied by the second derivative of Chebyshev's polynomial at the end of the interval.
    steepest = (2.0 / 0.02) ** 2 * DEGREE**2 * (DEGREE**2 - 1) / 3
    assert_allclose(q @ start.instant.a, -v @ v, rtol=0, atol=steepest * np.finfo(float).eps)


def test_direction_without_mass_tells_its_balance() -> None:
    # x₀ has mass; x₁ − x₀ is a spring that a force 2 pulls at its massless end; both rows are mixed by a rotation.
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    stiffness = np.array([[5.0, -5.0], [-5.0, 5.0]])
    mass = np.diag([3.0, 0.0])

    def residual(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        y = turn.T @ x
        return turn @ (mass @ turn.T @ a + stiffness @ y - np.array([0.0, 2.0]))

    turned_stiffness = turn @ stiffness @ turn.T
    turned_mass = turn @ mass @ turn.T
    equations = MotionEquations(
        np.ones(2, dtype=bool), residual, lambda *_: (turned_stiffness, np.zeros((2, 2)), turned_mass)
    )
    balanced = consistent_start(equations, 0.0, turn @ np.array([0.0, 0.4]), np.zeros(2), interval=0.02)
    assert balanced.massless == 1
    assert balanced.balance_error < 1e-14
    assert_allclose((turn.T @ balanced.instant.a)[0], 2.0 / 3.0, rtol=0, atol=1e-14)
    out_of_balance = consistent_start(equations, 0.0, np.zeros(2), np.zeros(2), interval=0.02)
    assert out_of_balance.balance_error > 1.0


def test_regular_matrices_are_inverted_and_others_are_not() -> None:
    random = np.random.default_rng(5)
    left, _ = np.linalg.qr(random.standard_normal((8, 8)))
    right, _ = np.linalg.qr(random.standard_normal((8, 8)))
    for smallest, is_regular in ((1e-6, True), (1e-12, False), (0.0, False)):
        matrix = left @ np.diag([1.0] * 7 + [smallest]) @ right
        inverse = regular_inverse(matrix, 1e-9)
        assert (inverse is not None) == is_regular
        if inverse is not None:
            assert_allclose(inverse @ matrix, np.eye(8), rtol=0, atol=1e-9)
    assert regular_inverse(np.full((2, 2), np.nan), 1e-9) is None
