"""Newton's method with a Jacobian at each stage: its Jacobian against differences, its convergence, its damping."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from moving import PENDULUM, explicit, pendulum_state
from numpy.testing import assert_allclose

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau
from cosserat_casadi.numerics.consistent_start import consistent_start
from cosserat_casadi.numerics.coupled_stages import CoupledStages, solve_coupled_stages
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.stage_newton import NewtonBounds, StageOutcome
from tests.derivatives import central_differences

SIZE = 0.2


def pendulum_stages(method: Collocation) -> CoupledStages:
    """A pendulum in Cartesian coordinates with its multiplier."""
    start = consistent_start(PENDULUM, 0.0, *pendulum_state(0.3, 1.1), interval=0.02).instant
    return CoupledStages(PENDULUM, method, start, SIZE)


def first_iterate(stages: CoupledStages) -> FloatArray:
    start = stages.start
    return np.tile(np.where(stages.equations.differential, start.a, start.x), (stages.method.stages, 1))


def damped_stages(method: Collocation) -> CoupledStages:
    """ẍ = −x³ − v³."""
    equations = explicit(
        lambda t, x, v: -(x**3) - v**3, lambda t, x, v: np.diag(-3 * x**2), lambda t, x, v: np.diag(-3 * v**2)
    )
    return CoupledStages(equations, method, Instant(0.0, np.ones(1), np.full(1, 2.0), np.zeros(1)), SIZE)


@pytest.mark.parametrize("of_scene", [pendulum_stages, damped_stages])
@pytest.mark.parametrize("method", [radau(2), radau(3), gauss(2)], ids=lambda method: method.name)
def test_jacobian_vs_differences(method: Collocation, of_scene: Callable[[Collocation], CoupledStages]) -> None:
    stages = of_scene(method)
    unknowns = first_iterate(stages)
    unknowns = unknowns + 0.1 * np.random.default_rng(0).standard_normal(unknowns.shape)
    scale = np.tile(np.where(stages.equations.differential, SIZE**-2, 1.0), method.stages)
    found = stages.jacobian(unknowns)
    slopes = central_differences(
        lambda flat: stages.residuals(flat.reshape(unknowns.shape)).ravel(), unknowns.ravel(), 1e-6 * scale
    )
    for column, slope in zip(found.T, (slopes * scale).T, strict=True):
        assert_allclose(column, slope, rtol=0, atol=1e-8 * (1 + np.abs(slope).max()))


def test_few_corrections_solve_the_equations() -> None:
    stages = pendulum_stages(radau(3))
    bounds = NewtonBounds(np.where(PENDULUM.differential, 1.0, 0.0), 1e-12, 12)
    found = solve_coupled_stages(stages, first_iterate(stages), bounds)
    assert found.outcome is StageOutcome.CONVERGED
    assert found.iterations <= 5
    assert np.abs(stages.residuals(found.unknowns)).max() < 1e-10


def test_corrections_are_shortened() -> None:
    """ẍ = −c atan(x): far out, where the force is flat, whole corrections of a long step overshoot more and more."""
    strength = 1e4
    equations = explicit(
        lambda t, x, v: -strength * np.arctan(x),
        lambda t, x, v: np.diag(-strength / (1 + x**2)),
        lambda *_: np.zeros((1, 1)),
    )
    stages = CoupledStages(equations, radau(1), Instant(0.0, np.full(1, 5.0), np.zeros(1), np.zeros(1)), 1.0)
    bounds = NewtonBounds(np.ones(1), 1e-12, 12)
    found = solve_coupled_stages(stages, np.zeros((1, 1)), bounds)
    assert found.outcome is StageOutcome.CONVERGED
    assert np.abs(stages.residuals(found.unknowns)).max() < 1e-8
    # Without, the first correction already leaves more than there was.
    whole = np.linalg.solve(stages.jacobian(np.zeros((1, 1))), -stages.residuals(np.zeros((1, 1))).ravel())
    assert np.abs(stages.residuals(whole.reshape(1, 1))).max() > np.abs(stages.residuals(np.zeros((1, 1)))).max()


def test_what_has_no_solution_is_told() -> None:
    equations = explicit(lambda t, x, v: 6 * x**2, lambda t, x, v: np.diag(12 * x), lambda *_: np.zeros((1, 1)))
    start = Instant(0.0, np.full(1, 1e3), np.full(1, 2.0), np.zeros(1))
    stages = CoupledStages(equations, radau(3), start, 0.25)
    found = solve_coupled_stages(stages, np.zeros((3, 1)), NewtonBounds(np.ones(1), 1e-6, 12))
    assert found.outcome is StageOutcome.DIVERGED
