"""Rates of the mean motion and the shape: maps there and back, and of forces."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi.numerics.mean_frame import MeanFrame

POSES = np.array([4, 5, 6])


def random_frame(rng: np.random.Generator) -> MeanFrame:
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    share = rng.normal(size=(3, 7))
    share[:, POSES] = 0.0
    return MeanFrame(POSES, turn, share)


def test_there_and_back() -> None:
    rng = np.random.default_rng(0)
    frame = random_frame(rng)
    vector = rng.normal(size=7)
    assert_allclose(frame.from_mean(frame.to_mean(vector)), vector, rtol=0, atol=1e-14)
    assert_allclose(frame.forces_from_mean(frame.forces_to_mean(vector)), vector, rtol=0, atol=1e-14)


def test_power_of_forces_is_the_same_in_both_rates() -> None:
    rng = np.random.default_rng(1)
    frame = random_frame(rng)
    forces = rng.normal(size=7)
    rates = rng.normal(size=7)
    assert_allclose(frame.forces_to_mean(forces) @ frame.to_mean(rates), forces @ rates, rtol=1e-13, atol=0)


def test_rates_of_the_shape_stay() -> None:
    frame = random_frame(np.random.default_rng(2))
    rates = np.arange(7.0)
    assert_allclose(frame.to_mean(rates)[:4], rates[:4], rtol=0, atol=0)
