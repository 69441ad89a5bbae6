"""The error of held rods, which falls in uneven steps: it is never taken for less than it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize_scalar

from cosserat_casadi import Model, Scene, Solution, build, discretise, scene_from_dict, solve
from cosserat_casadi.accuracy.levels import nodes_for_turn
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.resolution import FURTHER_MODES, HIDDEN_SAFETY, Resolution
from cosserat_casadi.accuracy.scene_solver import corrected_from
from cosserat_casadi.equilibrium.metrics import largest_turn, pose_distance, prolong
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.broyden import SINGULAR
from tests.families import mostly_slow
from tests.reference.held_scenes import held_scene

UNEVEN = [(2, 12), (4, 19)]
"""Seeds, and modes of which the last two do little while as many more do much."""

TRUE_MODES = 64
"""Modes whose error is far below all tolerances here."""


def drawn(seed: int, tolerance: float) -> Scene:
    return scene_from_dict({**held_scene(seed), "accuracy": {"tolerance": tolerance}})


def model_with(modes: int, solution: Solution) -> Model:
    """A model of the scene of a solution with so many modes, on a grid that resolves them."""
    nodes = nodes_for_turn(modes, largest_turn(solution))
    wanted = solution.model.scene
    return build(wanted, discretise(wanted, modes, nodes, "magnus8"))


def solved_near(solution: Solution, model: Model) -> Solution:
    """The same equilibrium on another model."""
    corrected = corrected_from(model, prolong(solution, model), solution.inputs)
    assert corrected is not None
    assert corrected.converged
    return corrected


def closed(truth: Solution, x: FloatArray) -> Solution:
    """The true equilibrium next to unknowns x, by the shortest steps, which have no turn about the axis."""
    for _ in range(4):
        jacobian, residual = (part.full() for part in truth.model.jacobian(x, truth.inputs))
        x = x - np.linalg.lstsq(jacobian, residual.ravel(), rcond=SINGULAR)[0]
    assert np.abs(truth.model.jacobian(x, truth.inputs)[1].full()).max() < 1e-12
    return replace(truth, x=x)


def turned_towards(solution: Solution, truth: Solution) -> Solution:
    """The true equilibrium nearest to a solution: a rod that buckles on its axis may be turned about it anyhow.

    Its equilibria are a circle: turned about the axis, each is as much an equilibrium as the others. So the error of a
    solution is its distance from the circle, the least over the turn. The shortest steps end near that: they are the
    shortest by coordinates, and not by poses.
    """
    singular = np.linalg.svd(Preview(truth).jacobian, compute_uv=False)
    if singular[-1] > SINGULAR * singular[0]:
        return truth
    near = closed(truth, prolong(solution, truth.model))
    neutral = np.linalg.svd(near.model.jacobian(near.x, near.inputs)[0].full())[2][-1]

    def turned(by: float) -> Solution:
        return closed(near, near.x + by * neutral)

    # No turn that moves poses by more than twice the distance leads nearer.
    probe = 1e-4
    furthest = 2 * pose_distance(solution, near) * probe / pose_distance(turned(probe), near)
    least = minimize_scalar(
        lambda by: pose_distance(solution, turned(by)), bounds=(-furthest, furthest), options={"xatol": 1e-3 * furthest}
    )
    return min(near, turned(float(least.x)), key=lambda one: pose_distance(solution, one))


@pytest.mark.parametrize(("seed", "modes"), mostly_slow(UNEVEN, quick=[(2, 12)]))
def test_an_uneven_step_is_seen(seed: int, modes: int) -> None:
    near = solve(drawn(seed, 1e-6))
    truth = solved_near(near, model_with(TRUE_MODES, near))
    solution = solved_near(truth, model_with(modes, near))
    more = solved_near(truth, model_with(modes + FURTHER_MODES, near))
    true = pose_distance(solution, truth)
    resolution = Resolution(Preview(solution))
    assert resolution.grid_error < 0.01 * true
    # The series of the modes that it has promises what those that follow do not keep.
    assert resolution.extrapolated_error < 0.2 * true
    assert_allclose(resolution.hidden_error, HIDDEN_SAFETY * pose_distance(solution, more), rtol=0.05, atol=0)
    assert true < resolution.modes_error < 2 * true
    # So many modes do not do for what they are off by, and the next level is asked for.
    assert resolution.missing_modes(resolution.modes_error, true) > 0


TOLERANCES = (4e-8, 1e-7, 1e-6, 1e-4)


@pytest.mark.parametrize(
    ("seed", "tolerances"),
    mostly_slow([(4, TOLERANCES[2:]), *((seed, TOLERANCES) for seed in range(21))], quick=[(4, TOLERANCES[2:])]),
)
def test_tolerance_is_met_by_held_rods(seed: int, tolerances: tuple[float, ...]) -> None:
    solutions = [solve(drawn(seed, tolerance)) for tolerance in tolerances]
    true_model = model_with(TRUE_MODES, solutions[0])
    for solution, tolerance in zip(solutions, tolerances, strict=True):
        assert solution.converged
        assert solution.error_estimate is not None
        truth = turned_towards(solution, solved_near(solution, true_model))
        assert pose_distance(solution, truth) <= min(tolerance, 1.01 * solution.error_estimate)


@pytest.mark.parametrize(("seed", "most"), mostly_slow([(118, 11), (33, 15), (288, 10)], quick=[(118, 11)]))
def test_a_round_rod_pushed_along_its_axis_does_not_pay_for_its_reference(seed: int, most: int) -> None:
    """It may bend to any side: with unequal modes of its bendings one side is preferred, and no start is near it.

    Their references have 19, 30 and 15 modes.
    """
    solution = solve(drawn(seed, 1e-4))
    bending_x, bending_y, torsion = solution.model.discretisation["rod"].modes
    assert bending_x == bending_y <= most
    assert torsion == 1
    truth = turned_towards(solution, solved_near(solution, model_with(TRUE_MODES, solution)))
    assert solution.error_estimate is not None
    assert pose_distance(solution, truth) < solution.error_estimate < min(1e-4, 4 * pose_distance(solution, truth))
