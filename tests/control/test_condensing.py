"""A condensed horizon against the simulator: it closes, and its derivatives are those of the motion."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.control import Condensed, Condensing, Horizon
from cosserat_casadi.maths.typing import FloatArray
from tests.control.swing import STAGES, STEP, Task, replayed, task

EAST = np.array([1.0, 0.0])
RATES = np.tile([0.8, -1.5], (STAGES, 1))
"""Of the tensions, N/s."""


def pulled(wanted: Task, rates: FloatArray) -> FloatArray:
    """Tensions at the ends of all stages, N."""
    changes = STEP * np.cumsum(rates, axis=0)
    return wanted.near.inputs + np.vstack([np.zeros(2), changes])


def closed(wanted: Task, condensing: Condensing, rates: FloatArray) -> Condensed:
    """The horizon after Newton steps from a robot at rest, at given rates."""
    horizon = Horizon(np.tile(wanted.start, (STAGES + 1, 1)), np.tile(wanted.stage.still(wanted.near.x), (STAGES, 1)))
    tensions = pulled(wanted, rates)[:-1]
    residuals = []
    for _ in range(7):
        condensed = condensing.condensed(horizon, tensions, rates)
        horizon = condensed.moved(np.zeros(condensed.states_by_rates.shape[2]))
        residuals.append(condensed.residual)
    # Newton's method: errors are squared until rounding stops them.
    assert residuals[-1] < 1e-11
    assert residuals[3] < residuals[2] ** 1.5
    return condensing.condensed(horizon, tensions, rates)


def test_a_closed_horizon_is_the_simulators() -> None:
    wanted = task()
    condensing = Condensing(wanted.stage, wanted.stage.equations, STAGES, [0, 1])
    found = closed(wanted, condensing, RATES)
    expected = replayed(wanted, pulled(wanted, RATES), wanted.stage.method)
    assert_allclose(found.guess.states, expected, rtol=0, atol=1e-10)


def test_a_state_that_is_not_finite_is_seen_in_the_residual() -> None:
    wanted = task()
    condensing = Condensing(wanted.stage, wanted.stage.equations, STAGES, [0])
    states = np.tile(wanted.start, (STAGES + 1, 1))
    # The last one is in no equation, only in a gap.
    states[-1, 0] = np.nan
    guess = Horizon(states, np.tile(wanted.stage.still(wanted.near.x), (STAGES, 1)))
    assert np.isnan(condensing.condensed(guess, pulled(wanted, RATES)[:-1], RATES).residual)


def test_arrays_of_other_shapes_are_refused_all_at_once() -> None:
    wanted = task()
    condensing = Condensing(wanted.stage, wanted.stage.equations, STAGES, [0])
    guess = Horizon(np.tile(wanted.start, (STAGES, 1)), np.tile(wanted.stage.still(wanted.near.x), (STAGES, 1)))
    with pytest.raises(ValueError, match=r"states must have the shape .*; inputs_rate must have"):
        condensing.condensed(guess, pulled(wanted, RATES)[:-1], RATES[:-1])


def test_no_stage_and_no_such_input_are_refused() -> None:
    stage = task().stage
    for stages, steered, what in (
        (0, [0], "stages"),
        (3, [2], "steered"),
        (3, [-1], "steered"),
        (3, [1, 1], "steered"),
    ):
        with pytest.raises(ValueError, match=what):
            Condensing(stage, stage.equations, stages, steered)


def test_derivatives_vs_differences_of_simulations() -> None:
    wanted = task()
    condensing = Condensing(wanted.stage, wanted.stage.equations, STAGES, [1])
    found = closed(wanted, condensing, RATES)
    step = 1e-4
    for number in (0, 3, STAGES - 1):
        sides = []
        for sign in (1, -1):
            rates = RATES.copy()
            rates[number, 1] += sign * step
            sides.append(replayed(wanted, pulled(wanted, rates), wanted.stage.method))
        difference = (sides[0] - sides[1]) / (2 * step)
        assert_allclose(found.states_by_rates[:, :, number], difference, rtol=1e-5, atol=1e-9)
    tensions = pulled(wanted, RATES)
    sides = [replayed(wanted, tensions + sign * step * EAST, wanted.stage.method) for sign in (1, -1)]
    difference = (sides[0] - sides[1]) / (2 * step)
    assert_allclose(found.states_by_inputs[:, :, 0], difference, rtol=1e-5, atol=1e-8)
    change = np.zeros(STAGES)
    change[3] = 1e-3
    moved = found.moved(change)
    following = wanted.stage.next_state.map(STAGES)(moved.states[:-1].T, moved.unknowns.T).full().T
    assert_allclose(following, moved.states[1:], rtol=0, atol=1e-11)
