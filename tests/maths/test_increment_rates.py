"""Rates of the rotation of an interval against matrix exponentials at times nearby."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm, expm_frechet

from cosserat_casadi.maths import magnus
from cosserat_casadi.maths.magnus import IncrementRates
from tests.reference.rods import hat

RATE = np.array([0.4, 0.9, -0.7])
ACCELERATION = np.array([-1.1, 0.3, 0.8])
OMEGAS = [(0.0, 0.0, 0.0), (1e-9, -2e-9, 1e-9), (0.02, 0.01, -0.03), (0.6, -0.3, 0.4), (1.2, 1.0, -1.2)]

# Central differences of order eight at −4 … 4 steps, of the first and the second derivative.
FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
STEP = 0.02


def vee(matrix: np.ndarray) -> np.ndarray:
    return np.array([matrix[2, 1], matrix[0, 2], matrix[1, 0]])


def tangent(omega: np.ndarray) -> np.ndarray:
    """T of exp(Ω^) from the Fréchet derivative of the matrix exponential."""
    columns = [expm_frechet(hat(omega), hat(direction), compute_expm=False) for direction in np.eye(3)]
    return np.transpose([vee(column @ expm(hat(omega)).T) for column in columns])


def around(omega: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Ω and Ω̇ at times about zero of Ω + Ω̇ t + Ω̈ t²/2."""
    times = STEP * np.arange(-4, 5)
    return [(omega + RATE * t + ACCELERATION * t**2 / 2, RATE + ACCELERATION * t) for t in times]


def moving(omega: np.ndarray) -> IncrementRates:
    return IncrementRates(magnus.increment(ca.DM(omega)), ca.DM(RATE), ca.DM(ACCELERATION))


@pytest.mark.parametrize("omega", OMEGAS)
def test_rates_of_the_tangent_vs_differences(omega: tuple[float, ...]) -> None:
    samples = [tangent(at) for at, _ in around(np.array(omega))]
    value, first, second = (order.full() for order in moving(np.array(omega)).tangent)
    assert_allclose(value, samples[4], rtol=0, atol=5e-14)
    assert_allclose(first, np.tensordot(FIRST, samples, 1) / STEP, rtol=0, atol=2e-11)
    assert_allclose(second, np.tensordot(SECOND, samples, 1) / STEP**2, rtol=0, atol=2e-9)


@pytest.mark.parametrize("omega", OMEGAS)
def test_spin_is_the_angular_velocity_of_the_rotation(omega: tuple[float, ...]) -> None:
    rotations = [expm(hat(at)) for at, _ in around(np.array(omega))]
    spun = np.tensordot(FIRST, rotations, 1) / STEP @ rotations[4].T
    assert_allclose(moving(np.array(omega)).spin.full()[:, 0], vee(spun), rtol=0, atol=2e-11)


@pytest.mark.parametrize("omega", OMEGAS)
def test_rate_of_the_spin_vs_differences(omega: tuple[float, ...]) -> None:
    samples = [tangent(at) @ rate for at, rate in around(np.array(omega))]
    found = moving(np.array(omega)).spin_rate.full()[:, 0]
    assert_allclose(found, np.tensordot(FIRST, samples, 1) / STEP, rtol=0, atol=2e-11)


def test_spin_is_that_of_the_tangent_to_rounding() -> None:
    """Both ways to the same numbers: cross products, and matrices."""
    interval = moving(np.array(OMEGAS[-1]))
    value, first, _ = interval.tangent
    assert_allclose(interval.spin.full(), (value @ ca.DM(RATE)).full(), rtol=0, atol=1e-15)
    rate = first @ ca.DM(RATE) + value @ ca.DM(ACCELERATION)
    assert_allclose(interval.spin_rate.full(), rate.full(), rtol=0, atol=2e-15)
