"""The example that carries a load: on its path, off the instability, judged anew with more modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from cosserat_casadi.equilibrium.metrics import prolong
from examples.carry_load import HOME, LEAST, arch, carry, draw, margins, place_of_load, robot

pytestmark = pytest.mark.slow

LENGTH_INPUTS = 3


def feet(inputs: np.ndarray) -> np.ndarray:
    """How far the feet are out on their rails, m."""
    return np.linalg.norm(inputs[LENGTH_INPUTS:].reshape(3, 3), axis=1)


def test_the_margin_is_held_where_the_feet_alone_would_not(tmp_path: Path) -> None:
    """At the top, where the robot is symmetric and its smallest eigenvalue double."""
    model, top = robot(modes=3), arch(3)[1:2]
    (without,), (held,) = (carry(model, top, bounded=bounded) for bounded in (False, True))
    for solution in (without, held):
        assert_allclose(place_of_load(solution), top[0], rtol=0, atol=1e-8)
    assert_allclose(feet(without.inputs), HOME, rtol=0, atol=1e-7)
    assert (without.stable, held.stable) == (False, True)
    assert_allclose(margins([held]), LEAST, rtol=0, atol=1e-6)
    spread = feet(held.inputs)
    assert_allclose(spread, spread[0], rtol=0, atol=1e-6)
    draw(top, [without], [held], tmp_path / "c.png")
    assert (tmp_path / "c.png").read_bytes().startswith(b"\x89PNG")
    # No less of a spread would do.
    nearer = held.inputs.copy()
    nearer[LENGTH_INPUTS:] *= (spread[0] - 1e-3) / spread[0]
    less = solve(model, model.inputs.unpack(nearer), start=held, raise_on_failure=True)
    assert margins([less])[0] < LEAST - 1e-3


def test_the_path_is_as_stable_with_more_modes() -> None:
    points, fine = arch(5), robot(modes=6)
    held = carry(robot(), points, bounded=True)
    for solution in held:
        again = solve(fine, fine.inputs.unpack(solution.inputs), start=prolong(solution, fine), raise_on_failure=True)
        assert again.stable
        assert_allclose(place_of_load(again), place_of_load(solution), rtol=0, atol=2e-4)
        assert_allclose(margins([again]), margins([solution]), rtol=0, atol=5e-3)
    assert np.all(margins(held) >= LEAST - 1e-6)
