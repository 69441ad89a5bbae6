"""Estimates of rods without supports and of assemblies: true errors are never above them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, Solution, build, discretise, scene_from_dict, solve
from cosserat_casadi.accuracy.levels import nodes_for_turn
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.resolution import FURTHER_MODES, HIDDEN_SAFETY, NEGLIGIBLE, Resolution
from cosserat_casadi.accuracy.scene_solver import corrected_from
from cosserat_casadi.equilibrium.metrics import cable_distance, largest_turn, pose_distance, prolong
from cosserat_casadi.model.watched import SAMPLES
from tests.families import mostly_slow
from tests.pose_errors import pose_error
from tests.reference.assembled_scenes import assembled_scene
from tests.reference.random_scenes import random_scene
from tests.reference.routed_scenes import rich_scene
from tests.scenes import push, scene
from tests.shooting_near import shoot

Table = dict[str, Any]

GRANTED = 1.01
"""Factor on an estimate by which the true error may exceed it."""

TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)

ALONG = np.linspace(0, 1, 101)
"""Sections at which a shape is judged: not those that the package compares, but for the ends and the middle."""

TRUE_MODES = 20
"""Modes beyond those of a solution of an assembly with which its equilibrium counts as the true one."""


@dataclass(frozen=True)
class Errors:
    """True errors: of tips and lengths of cables, and of all sections."""

    tip: float
    shape: float


def strong_scene(seed: int) -> Table:
    """A random rod, its tip force up to 40 EI/L²."""
    tables = random_scene(seed)
    for load in tables["loads"]:
        if load["kind"] == "tip_wrench":
            load["force"] = [(1, 2, 4)[seed % 3] * component for component in load["force"]]
    return tables


def with_tolerance(tables: Table, tolerance: float) -> Scene:
    return scene_from_dict({**tables, "accuracy": {"tolerance": tolerance}})


def drawn_tolerance(seed: int) -> float:
    return float(np.random.default_rng([seed, 7]).choice(TOLERANCES))


def by_shooting(solution: Solution) -> Errors:
    """Against DOP853 from the clamp of a rod, which shares no polynomial with the solution."""
    truth = shoot(solution, ALONG)
    pose = solution.pose(ALONG)
    errors = []
    for section in range(len(ALONG)):
        found = pose.position[section], pose.rotation[section]
        true = truth.position[section], truth.rotation[section]
        errors.append(pose_error(found, true, truth.length))
    return Errors(tip=errors[-1], shape=max(errors))


def by_finer_model(solution: Solution) -> Errors:
    """Against the same equilibrium with far more modes than the solution was ever compared to."""
    wanted = solution.model.scene
    modes = TRUE_MODES + max(max(d.modes) for d in solution.model.discretisation.values())
    nodes = nodes_for_turn(modes, largest_turn(solution)) + 6
    model = build(wanted, discretise(wanted, modes, nodes, "magnus8"))
    truth = corrected_from(model, prolong(solution, model), solution.inputs)
    assert truth is not None
    assert truth.converged
    tip = max(pose_distance(solution, truth), cable_distance(solution, truth))
    return Errors(tip, max(tip, pose_distance(solution, truth, ALONG)))


def check(solution: Solution, errors: Errors) -> None:
    """What is estimated of a converged solution bounds what it is off by."""
    assert solution.converged
    assert solution.error_estimate is not None
    assert solution.shape_error_estimate is not None
    assert errors.tip <= solution.model.scene.accuracy.tolerance
    assert errors.tip <= GRANTED * solution.error_estimate
    assert errors.shape <= GRANTED * solution.shape_error_estimate


UNEVEN = [([20.0, 0.0, -5.0], 10), ([0.0, 30.0, -10.0], 11)]
"""Tip forces, and modes of which the last two do little while as many more do much."""


@pytest.mark.parametrize(("force", "modes"), mostly_slow(UNEVEN, quick=UNEVEN[:1]))
def test_a_look_sees_what_extrapolation_does_not(force: list[float], modes: int) -> None:
    wanted = scene(push(force=force))
    solution = solve(build(wanted, discretise(wanted, modes, 40, "magnus8")))
    true = by_shooting(solution)
    resolution = Resolution(Preview(solution))
    assert resolution.grid_error < 0.01 * true.tip
    assert resolution.extrapolated_error < 0.3 * true.tip
    assert_allclose(resolution.hidden_error, HIDDEN_SAFETY * true.tip, rtol=0.1, atol=0)
    assert true.tip < resolution.modes_error < 2 * true.tip
    assert resolution.missing_modes(resolution.modes_error, true.tip) > 0


@pytest.mark.parametrize("strain", mostly_slow(["planar", "kirchhoff", "reissner"], quick=["kirchhoff"]))
def test_look_at_shapes_vs_a_model_with_these_modes(strain: str) -> None:
    wanted = scene(push(force=[4.0, 2.0, -1.0]), strain=strain)
    modes = 5
    coarse = solve(build(wanted, discretise(wanted, modes, 24, "magnus8")))
    fine = solve(build(wanted, discretise(wanted, modes + FURTHER_MODES, 24 + FURTHER_MODES, "magnus8")))
    before = coarse.pose(SAMPLES)
    after = fine.pose(SAMPLES)
    distances = np.linalg.norm(after.position - before.position, axis=1) / wanted.rods[0].length
    preview = Preview(coarse)
    found = preview.finer_shift(fine.model.discretisation, 1).shapes[: len(SAMPLES)]
    assert distances.max() > 1e-6
    assert_allclose(np.linalg.norm(found, axis=1), distances, rtol=0, atol=0.05 * distances.max())
    # Sections between are farther off than the tip, so that their error cannot be told from it.
    resolution = Resolution(preview)
    assert resolution.shape_error > 5 * resolution.tip_error
    true = by_shooting(coarse)
    assert true.shape <= resolution.shape_error <= 3 * true.shape


def test_no_tip_is_looked_at_where_its_error_is_negligible() -> None:
    wanted = scene(push(force=[4.0, 2.0, -1.0]))
    solution = solve(build(wanted, discretise(wanted, 7, 30, "magnus8")))
    thorough = Resolution(Preview(solution))
    allowed = 2 * thorough.extrapolated_error / NEGLIGIBLE
    believed = Resolution(Preview(solution), allowed=allowed)
    assert thorough.hidden_error > 0
    assert_allclose(believed.hidden_error, 0, rtol=0, atol=0)
    assert_allclose(believed.modes_error, thorough.extrapolated_error, rtol=0, atol=0)
    # What the sections between do is known all the same.
    assert_allclose(believed.shape_error, thorough.shape_error, rtol=0.01, atol=0)


TOO_SMALL = [
    ("strong", 13, 1e-8),
    ("strong", 14, 1e-4),
    ("strong", 26, 1e-8),
    ("rich", 8, 1e-7),
    ("rich", 26, 1e-7),
]
"""Scenes and tolerances of which an estimate was too small while references knew the error of their tips alone."""

MAKERS = {"strong": strong_scene, "rich": rich_scene}


@pytest.mark.parametrize(("kind", "seed", "tolerance"), mostly_slow(TOO_SMALL, quick=[("strong", 13, 1e-8)]))
def test_estimates_bound_what_they_did_not(kind: str, seed: int, tolerance: float) -> None:
    solution = solve(with_tolerance(MAKERS[kind](seed), tolerance))
    check(solution, by_shooting(solution))


@pytest.mark.slow
@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("first", range(0, 60, 10))
def test_estimates_of_one_rod_bound_its_errors(kind: str, first: int) -> None:
    for seed in range(first, first + 10):
        solution = solve(with_tolerance(MAKERS[kind](seed), drawn_tolerance(seed)))
        check(solution, by_shooting(solution))


@pytest.mark.parametrize("tendons", mostly_slow([False, True], quick=[False]), ids=["rods", "tendons"])
@pytest.mark.parametrize("seed", mostly_slow(range(60), quick=[1]))
def test_estimates_of_assemblies_bound_their_errors(seed: int, tendons: bool) -> None:
    solution = solve(with_tolerance(assembled_scene(seed, tendons=tendons), drawn_tolerance(seed)))
    if not solution.converged:
        # What is not found claims nothing: no estimate stands beside it.
        assert solution.error_estimate is None
        pytest.skip(solution.message)
    check(solution, by_finer_model(solution))
