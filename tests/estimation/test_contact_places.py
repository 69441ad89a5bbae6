"""Unknown places of contacts beside truths, a search of another kind, and a row with two explanations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import least_squares
from scipy.stats import chi2

from cosserat_casadi import Model, SceneError, build, scene_from_dict, solve
from cosserat_casadi.codegen.estimator import Estimates
from cosserat_casadi.estimation import Estimate, estimate
from cosserat_casadi.estimation.optima import best_of, spread_starts
from cosserat_casadi.identification import identify
from cosserat_casadi.results.presentation import csv_of
from cosserat_casadi.scene import Scene
from tests.scenes import markers, rod

SIGMA = 2.5e-5
"""Standard deviation of a coordinate, m. Force and place are told from each other by how a rod bends, little by little:
where the shape says less the posterior is bent, and its linear model too narrow."""

AT = (0.25, 0.5, 0.75, 1.0)
FORCE = {"mean": 1.0, "sigma": 0.25}
PLACE = {"mean": 0.6, "sigma": 0.12}
RANGE = {"lower": 0.3, "upper": 0.95}
"""Behind the first marker: what touches before it is told badly from its force; the posterior is far from normal."""

TOUCH = {"name": "touch", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.0, 0.0, 0.0]}


def touched(strain: str = "planar", sections: Sequence[float] = AT, sigma: float = SIGMA, **changes: Any) -> Scene:
    """A rod with markers that is touched somewhere by an unknown force along x."""
    unknowns = [
        {"input": "touch.force.x", "per_row": True, "prior": FORCE},
        {"parameter": "touch.at", "per_row": True, "prior": PLACE, **RANGE},
    ]
    base = {
        "schema": 1,
        "inputs": [],
        "accuracy": {"modes": 2, "nodes": 5, "tolerance": 1e-2},
        "rods": [rod(strain)],
        "loads": [TOUCH],
        "measurements": markers(sections, sigma),
        "unknowns": unknowns,
    }
    return scene_from_dict({**base, **changes})


def columns_of(model: Model, truths: np.ndarray, seed: int | None, sections: Sequence[float] = AT) -> dict[str, Any]:
    """Positions of the markers under a force at a place, a row each, shape (cases, 2); with noise where seeded."""
    rng = np.random.default_rng(seed)
    columns: dict[str, list[float]] = {f"{axis}{k}": [] for k in range(len(sections)) for axis in "xyz"}
    for force, place in truths:
        touch = {"touch.force": [force, 0.0, 0.0]}
        solution = solve(model, touch, parameters={"touch.at": place}, raise_on_failure=True)
        positions = solution.pose(sections, "rod").position
        if seed is not None:
            positions = positions + rng.normal(0.0, SIGMA, positions.shape)
        for k in range(len(sections)):
            for axis, value in zip("xyz", positions[k], strict=True):
                columns[f"{axis}{k}"].append(float(value))
    return {"shapes": {name: np.array(values) for name, values in columns.items()}}


def drawn(count: int, seed: int) -> np.ndarray:
    """Forces and places from their priors, shape (count, 2)."""
    rng = np.random.default_rng(seed)
    force = rng.normal(FORCE["mean"], FORCE["sigma"], count)
    place = rng.normal(PLACE["mean"], PLACE["sigma"], count)
    return np.column_stack([force, np.clip(place, RANGE["lower"], RANGE["upper"])])


def assert_consistent(count: int, strain: str) -> None:
    """The mean of the squared errors is within the 95 % band of its distribution."""
    model = build(touched(strain).with_unknowns())
    truths = drawn(count, 4)
    found = estimate(model, columns_of(model, truths, 5))
    assert found.found.all()
    errors = found.values - truths
    squares = np.einsum("ci,cij,cj->c", errors, np.linalg.inv(found.covariance), errors)
    low, high = chi2.ppf([0.025, 0.975], 2 * count) / count
    assert low <= squares.mean() <= high


@pytest.mark.slow
def test_places_are_consistent() -> None:
    assert_consistent(25, "planar")


@pytest.mark.slow
def test_places_are_consistent_over_many_cases() -> None:
    assert_consistent(1000, "kirchhoff")


@pytest.mark.slow
def test_a_place_vs_a_search_without_derivatives() -> None:
    """The same maximum by scipy's least squares with differences on the solver in Python, and the same covariance."""
    model = build(touched().with_unknowns())
    data = columns_of(model, np.array([[1.2, 0.7]]), 1)
    found = estimate(model, data)
    assert found.labels == ("touch.force.x", "touch.at")
    assert found.units == ("N", "1")
    numbers = np.array([data["shapes"][f"{axis}{k}"][0] for k in range(len(AT)) for axis in "xyz"])
    mean = np.array([FORCE["mean"], PLACE["mean"]])
    deviation = np.array([FORCE["sigma"], PLACE["sigma"]])

    def misfit(u: np.ndarray) -> np.ndarray:
        solution = solve(model, {"touch.force": [u[0], 0.0, 0.0]}, parameters={"touch.at": u[1]})
        differences = (solution.pose(AT, "rod").position.ravel() - numbers) / SIGMA
        return np.concatenate([differences, (u - mean) / deviation])

    other = least_squares(misfit, [1.0, 0.5], xtol=1e-12, ftol=1e-12, gtol=1e-12)
    assert_allclose(found.values[0], other.x, rtol=0, atol=1e-3 * found.sigma[0].min())
    assert_allclose(found.cost[0], other.cost, rtol=1e-6, atol=0)
    assert_allclose(found.covariance[0], np.linalg.inv(other.jac.T @ other.jac), rtol=1e-3, atol=1e-9)
    assert_allclose(found.parameters[0], found.values[0, 1:], rtol=0, atol=0)


WEAK = {"mean": 0.0, "sigma": 0.1}
HALF_CIRCLE = {
    "accuracy": {"modes": 5, "nodes": 8, "tolerance": 1e-2},
    "rods": [rod("planar", intrinsic={"curvature": [0.0, np.pi / 0.8, 0.0]})],
    "unknowns": [
        {"input": "touch.force.x", "per_row": True, "prior": WEAK},
        {"parameter": "touch.at", "per_row": True, "lower": 0.1, "upper": 0.95},
    ],
    "estimation": {"starts": 4},
}


def direction_of_tip(angle: float) -> float:
    """Ratio z / x of the small displacement of the tip of a half circle under a force along x at an angle along it.

    The work integral over the arc in closed form.
    """
    sine, cosine = np.sin(angle), np.cos(angle)
    along_x = angle / 2 - sine * cosine / 2 - sine * (1 - cosine)
    along_z = 1 - cosine - sine**2 / 2 - angle * sine
    return float(along_z / along_x)


def half_circle_felt(sections: tuple[float, ...]) -> Estimate:
    """What a half circle feels whose markers have moved as under a small force at an angle of 2 radians along it."""
    model = build(touched(sections=sections, sigma=1e-6, **HALF_CIRCLE).with_unknowns())
    return estimate(model, columns_of(model, np.array([[0.02, 2.0 / np.pi]]), None, sections))


def test_a_second_place_that_explains_a_row_is_told() -> None:
    """Its tip moves in the same direction under forces at two places: the other one by bisection on a closed form."""
    found = half_circle_felt((1.0,))
    assert found.second is not None
    low, high = 0.3, 1.5
    for _ in range(60):
        middle = (low + high) / 2
        if direction_of_tip(middle) > direction_of_tip(2.0):
            low = middle
        else:
            high = middle
    places = sorted([found.values[0, 1], found.second.values[0, 1]])
    assert_allclose(places, [low / np.pi, 2.0 / np.pi], rtol=0, atol=5e-3)
    # Both meet the measurements, and differ in how far their forces are from what was expected.
    forces = np.array([found.values[0, 0], found.second.values[0, 0]])
    costs = [found.cost[0], found.second.cost[0]]
    assert_allclose(costs, (forces / WEAK["sigma"]) ** 2 / 2, rtol=1e-3, atol=0)
    assert 0.1 < found.second.share[0] < 0.95
    assert found.doubtful.all()
    assert any("another explanation nearly as good" in warning for warning in found.warnings)
    row = found.to_dict()["rows"][0]
    assert row["second"]["value"] == found.second.values[0].tolist()
    header, cells = csv_of(found).splitlines()
    assert header.endswith("share,touch.force.x.second,touch.at.second")
    assert float(cells.split(",")[-1]) == found.second.values[0, 1]


@pytest.mark.slow
def test_a_further_marker_leaves_one_place() -> None:
    found = half_circle_felt((0.5, 1.0))
    assert_allclose(found.values[0], [0.02, 2.0 / np.pi], rtol=0, atol=1e-5)
    assert not found.doubtful.any()
    assert not any("another explanation" in warning for warning in found.warnings)


def test_minima_are_weighed_by_the_mass_around_them() -> None:
    """Two normal distributions of known masses, one of them found twice, and a search that failed."""
    deviations = [0.1, 0.2, 0.1, 1.0]
    places = [0.3, 0.7, 0.3 + 1e-4, 0.5]
    costs = [1.0, 1.5, 1.0 + 1e-9, np.nan]
    runs = [
        Estimates(
            outcome=np.array([3 if np.isnan(cost) else 0]),
            iterations=np.array([1]),
            cost=np.array([cost]),
            unknowns=np.array([[place]]),
            information=np.array([[[1 / deviation**2]]]),
            gradient=np.zeros((1, 1)),
            residuals=np.zeros((1, 0)),
            x=np.zeros((1, 1)),
        )
        for deviation, place, cost in zip(deviations, places, costs, strict=True)
    ]
    for order in ([0, 1, 2, 3], [3, 2, 1, 0]):
        best, second = best_of([runs[k] for k in order], own=1)
        assert best.cost[0] == 1.0
        assert second.values[0, 0] == 0.7
        assert second.cost[0] == 1.5
        assert_allclose(second.share[0], 0.1 / (0.1 + 0.2 * np.exp(-0.5)), rtol=1e-12, atol=0)
    _, none_found = best_of([runs[3], runs[3]], own=1)
    assert np.isnan(none_found.share[0])


def test_starts_are_in_every_part_of_every_range() -> None:
    lower, upper = np.array([0.0, 1.0]), np.array([1.0, 3.0])
    starts = spread_starts(lower, upper, 4)
    parts = np.sort(np.floor(4 * (starts - lower) / (upper - lower)), axis=0)
    assert_allclose(parts, np.repeat(np.arange(4.0)[:, None], 2, axis=1), rtol=0, atol=0)


HOOK = {"name": "hook", "kind": "point_wrench", "rod": "rod", "at": 0.7, "force": [0.1, 0.0, 0.0]}


def test_ranges_in_which_places_change_their_order_are_refused() -> None:
    model = build(touched(loads=[TOUCH, HOOK]).with_unknowns())
    with pytest.raises(SceneError, match="must keep their order") as refusal:
        estimate(model, {})
    assert "narrow lower and upper" in str(refusal.value)


def test_an_identification_has_no_parameters_of_each_row() -> None:
    with pytest.raises(SceneError, match="the same in all cases of an identification"):
        identify(build(touched().with_unknowns()), {})
