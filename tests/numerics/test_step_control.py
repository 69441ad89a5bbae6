"""The estimated error of a step, and what it makes of the size of the next one."""

from __future__ import annotations

import numpy as np
import pytest
from moving import PENDULUM_ANGLE
from numpy.testing import assert_allclose

from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.integration import StepSettings
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step_control import StepControl
from cosserat_casadi.numerics.time_steps import integrate


@pytest.mark.parametrize("stages", [1, 2, 3])
def test_estimate_is_of_one_order_more_than_the_stages(stages: int) -> None:
    start = Instant(0.0, np.array([1.0]), np.array([0.3]), -np.sin([1.0]))
    errors = []
    for size in (0.1, 0.05, 0.025):
        settings = StepSettings(np.ones(1), first=size)
        errors.append(integrate(PENDULUM_ANGLE, start, 1.0, radau(stages), settings).steps[0].error)
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert_allclose(orders[-1], stages + 1, rtol=0, atol=0.25)


def test_steady_error_keeps_the_step() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1)
    for _ in range(3):
        control.accept(0.1, 0.6, iterations=1)
    assert control.wanted == 0.1


def test_error_that_grows_is_foreseen() -> None:
    # From one step to the next the error has grown by 100: the next step would be too long by that trend alone.
    steady = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.5)
    growing = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.01)
    steady.accept(0.1, 0.5, iterations=1)
    growing.accept(0.1, 0.5, iterations=1)
    assert steady.wanted == 0.1
    assert_allclose(growing.wanted, 0.1 * 0.9 * (0.01 / 0.5**2) ** 0.25, rtol=1e-14, atol=0)


def test_growth_is_bounded() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1)
    control.accept(0.1, 0.0, iterations=1)
    assert_allclose(control.wanted, 0.5, rtol=1e-15, atol=0)
    control.accept(0.5, 0.0, iterations=1)
    assert control.wanted == 1.0


def test_refused_step_is_not_followed_by_a_longer_one() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.5)
    control.refuse_error(0.1, 16.0, iterations=1)
    assert_allclose(control.wanted, 0.045, rtol=1e-14, atol=0)
    control.accept(0.045, 1e-6, iterations=1)
    assert_allclose(control.wanted, 0.045, rtol=1e-14, atol=0)
    control.refuse_error(0.045, float("nan"), iterations=1)
    assert control.wanted < 0.01


def test_step_cut_at_the_end_of_a_piece_leaves_the_wanted_one() -> None:
    control = StepControl(stages=3, longest=1.0, wanted=0.1, last_size=0.1, last_error=0.5)
    control.accept(0.03, 0.5, iterations=1)
    assert control.wanted == 0.1
