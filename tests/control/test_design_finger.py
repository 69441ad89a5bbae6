"""The example that designs a finger: exact gradients, an optimum that solves of their own confirm."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from cosserat_casadi.control import stability_margin
from examples.design_finger import (
    LARGEST,
    LENGTH,
    MARGIN,
    START,
    UNITS,
    area_of,
    designed,
    equilibria_of,
    finger,
    problem_of,
    reached,
    tensions_around,
    volume_of,
)
from tests.derivatives import central_differences


def test_area_and_volume_vs_closed_form() -> None:
    angles = np.linspace(0, 2 * np.pi, 6, endpoint=False)
    hexagon = ca.DM(np.array([3 + 2 * np.cos(angles), np.sin(angles) * 2 - 1]))
    assert_allclose(float(area_of(hexagon)), 3 * np.sqrt(3) / 2 * 4, rtol=1e-14)
    cylinder = float(volume_of(ca.DM([0.01, 0.01])))
    assert_allclose(cylinder, np.pi * 0.01**2 * LENGTH, rtol=1e-14)
    assert_allclose(float(volume_of(ca.DM([0.01, 0.0]))), cylinder / 3, rtol=1e-14)


def test_tensions_go_round_the_square() -> None:
    assert_allclose(tensions_around(4) / LARGEST, [[0, 0], [1, 0], [1, 1], [0, 1]])
    assert_allclose(tensions_around(8)[1::2] / LARGEST, [[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]])


@pytest.mark.slow
def test_gradients_vs_differences_of_solves() -> None:
    """Through the equilibria, dA/dp = ∂A/∂p − ∂A/∂x (∂R/∂x)⁻¹ ∂R/∂p; so the room that the design leaves."""
    model = finger(modes=2)
    tensions = tensions_around(4)
    problem = problem_of(model, tensions)
    x = ca.vertcat(*problem.states)
    outputs = ca.vertcat(problem.area, problem.room)
    parts = [ca.jacobian(of, by) for of in (problem.balance, outputs) for by in (x, problem.design)]
    at = ca.Function("at", [problem.variables], parts)
    by_x, by_design, outputs_by_x, outputs_by_design = [part.full() for part in at(problem.start)]
    gradient = outputs_by_design - outputs_by_x @ np.linalg.solve(by_x, by_design)

    value = ca.Function("value", [problem.variables], [outputs])
    start = problem.start[: len(UNITS)]

    def solved(design: np.ndarray) -> np.ndarray:
        there = model.at(model.parameters.unpack(UNITS * design))
        states = [equilibrium.x for equilibrium in equilibria_of(there, tensions)]
        return value(np.concatenate([design, *states])).full()[:, 0]

    assert_allclose(gradient, central_differences(solved, start, 1e-4), rtol=1e-5, atol=1e-6)


def judge(model_modes: int, cases: int, discretisation: float) -> None:
    """The optimum reaches more than the start, is what solves of scenes with its numbers find, and keeps its margin."""
    model = finger(modes=model_modes)
    tensions = tensions_around(cases)
    design, area = designed(model, tensions)
    confirmed = equilibria_of(finger(design, model_modes), tensions)
    assert_allclose(reached(confirmed), area, rtol=1e-7)
    assert area > reached(equilibria_of(model, tensions))
    assert all(solution.stable for solution in confirmed)

    margin = stability_margin(model, parameters=True)
    p = model.parameters.pack(design)
    margins = []
    for pair, built in zip(tensions, confirmed, strict=True):
        inputs = dict(zip(model.inputs.names, pair, strict=True))
        solution = solve(model, inputs, parameters=design)
        assert_allclose(solution.tip("finger").position, built.tip("finger").position, rtol=0, atol=1e-8)
        margins.append(float(margin(solution.x, solution.inputs, p)))
    assert min(margins) == pytest.approx(MARGIN, abs=1e-6)  # a softer finger would reach further
    assert volume_of(p[:2]) <= volume_of(START["finger.section.radius"]) * (1 + 1e-7)

    # More modes change it by no more than this share.
    finer = equilibria_of(finger(design, model_modes + 3), tensions)
    assert_allclose(reached(finer), area, rtol=discretisation)


@pytest.mark.slow
def test_optimum_is_confirmed_by_solves() -> None:
    judge(model_modes=2, cases=4, discretisation=3e-2)


@pytest.mark.slow
def test_full_example_is_confirmed_by_solves() -> None:
    judge(model_modes=3, cases=16, discretisation=1e-2)
