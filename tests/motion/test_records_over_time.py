"""Inputs in many knots: steps go at the pace of the rod, and see what happens between their stages."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Motion, simulate
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion import moving_inputs
from tests.families import mostly_slow
from tests.motion.stepping import moving_model

DURATION = 0.5
TOLERANCE = 1e-3


def recorded(values: FloatArray, interpolation: str) -> Motion:
    """A damped cantilever whose tip is pushed across, by so many evenly spaced values, N."""
    rod = {
        "name": "rod",
        "length": 0.4,
        "strain": "planar",
        "material": {"youngs_modulus": 2e6, "poisson_ratio": 0.48, "density": 1100.0},
        "section": {"shape": "circle", "radius": 8e-3},
        "damping": {"retardation_time": 5e-3},
    }
    times = np.linspace(0.0, DURATION, len(values))
    motion = {
        "input": "push.force",
        "times": times.tolist(),
        "values": [[value, 0.0, 0.0] for value in values.tolist()],
        "interpolation": interpolation,
    }
    scene: dict[str, Any] = {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 8},
        "rods": [rod],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, 0]}],
        "simulation": {"duration": DURATION, "frames": 26, "tolerance": TOLERANCE},
        "motions": [motion],
    }
    found = simulate(moving_model(scene))
    assert found.converged, found.message
    return found


def pushed(count: int) -> FloatArray:
    return 0.2 * np.sin(2.0 * np.pi * np.linspace(0.0, 1.0, count)) ** 2


@pytest.mark.parametrize(
    ("count", "interpolation"), mostly_slow([(201, "cubic"), (501, "linear")], quick=[(501, "linear")])
)
def test_a_record_takes_the_steps_of_what_it_records(count: int, interpolation: str) -> None:
    few = recorded(pushed(11), "cubic")
    many = recorded(pushed(count), interpolation)
    assert many.statistics.steps <= 1.5 * few.statistics.steps
    # The spline through eleven values is another path, by less than a hundredth of the push.
    assert_allclose(many.tip().position, few.tip().position, rtol=0, atol=3.0 * TOLERANCE * 0.4)


@pytest.mark.slow
def test_noise_of_a_record_is_as_exact_as_with_steps_that_end_at_each_knot(monkeypatch: pytest.MonkeyPatch) -> None:
    noise = np.random.default_rng(2).normal(scale=0.2, size=101)
    found = recorded(noise, "linear")
    monkeypatch.setattr(moving_inputs, "MOST_CUTS", len(noise))
    cut = recorded(noise, "linear")
    assert cut.statistics.steps >= 100
    assert np.abs(cut.tip().position[:, 0]).max() > 10.0 * TOLERANCE * 0.4
    assert_allclose(found.tip().position, cut.tip().position, rtol=0, atol=2.0 * TOLERANCE * 0.4)


def test_jumps_of_one_input_are_told_in_one_sentence() -> None:
    found = recorded(np.array([0.0, 0.1, 0.0, 0.1]), "step")
    (warning,) = found.warnings
    assert "push.force jumps 2 times from 0.166667 s to 0.333333 s" in warning
