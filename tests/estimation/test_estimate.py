"""Estimates beside the truths that made the measurements, and beside a search of another kind."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import least_squares
from scipy.stats import chi2

from cosserat_casadi import Model, SceneError, build, scene_from_dict, solve
from cosserat_casadi.estimation import Estimate, estimate
from cosserat_casadi.results.estimate_file import estimate_result, estimate_table
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.writing import scene_tables
from tests.scenes import push, rod, scene

SIGMA = 1e-3
PRIOR = np.array([1.0, 1.0, 0.2])
AT = (0.5, 1.0)
TIP = {"input": "push.force", "per_row": True}


def felt(prior: bool = True, sections: tuple[float, ...] = AT, strain: str = "planar", **changes: Any) -> Scene:
    """A rod with markers; its tip is pushed by an unknown force."""
    measured = [
        {
            "quantity": "position",
            "name": f"marker {k}",
            "file": "shapes",
            "rod": "rod",
            "at": at,
            "columns": [f"{axis}{k}" for axis in "xyz"],
            "sigma": SIGMA,
        }
        for k, at in enumerate(sections)
    ]
    unknown = {**TIP, "prior": {"mean": 0.0, "sigma": PRIOR.tolist()}} if prior else TIP
    base = scene(push(force=[0.0, 0.0, 0.0]), rods=[rod(strain)], accuracy={"modes": 3, "nodes": 8, "tolerance": 1e-3})
    tables = {**scene_tables(base), "inputs": [], "measurements": measured, "unknowns": [unknown], **changes}
    return scene_from_dict(tables)


def measured(model: Model, forces: np.ndarray, seed: int) -> dict[str, dict[str, np.ndarray]]:
    """Positions of the markers under forces, with noise."""
    rng = np.random.default_rng(seed)
    columns: dict[str, list[float]] = {f"{axis}{k}": [] for k in range(len(AT)) for axis in "xyz"}
    for force in forces:
        positions = solve(model, {"push.force": force}).pose(AT, "rod").position
        for k in range(len(AT)):
            for axis, value in zip("xyz", positions[k] + rng.normal(0.0, SIGMA, 3), strict=True):
                columns[f"{axis}{k}"].append(value)
    return {"shapes": {name: np.array(values) for name, values in columns.items()}}


def nees(found: Estimate, forces: np.ndarray) -> np.ndarray:
    """Squared errors in the metric of their covariances."""
    errors = found.values - forces
    return np.einsum("ci,cij,cj->c", errors, np.linalg.inv(found.covariance), errors)


def assert_consistent(count: int, strain: str) -> None:
    """The mean of the squared errors is within the 95 % band of its distribution."""
    model = build(felt(strain=strain).with_unknowns())
    forces = np.random.default_rng(4).normal(size=(count, 3)) * PRIOR
    found = estimate(model, measured(model, forces, 5))
    assert found.found.all()
    low, high = chi2.ppf([0.025, 0.975], 3 * count) / count
    assert low <= nees(found, forces).mean() <= high


def test_estimates_are_consistent() -> None:
    assert_consistent(40, "planar")


@pytest.mark.slow
def test_estimates_are_consistent_over_many_cases() -> None:
    assert_consistent(1000, "kirchhoff")


def test_a_row_vs_a_search_without_derivatives() -> None:
    """The same maximum by scipy's least squares with differences on the solver in Python, and the same covariance."""
    model = build(felt().with_unknowns())
    force = np.array([[0.8, 0.0, -0.3]])
    data = measured(model, force, 1)
    found = estimate(model, data)
    numbers = np.array([data["shapes"][f"{axis}{k}"][0] for k in range(len(AT)) for axis in "xyz"])

    def misfit(u: np.ndarray) -> np.ndarray:
        positions = solve(model, {"push.force": u}).pose(AT, "rod").position.ravel()
        return np.concatenate([(positions - numbers) / SIGMA, u / PRIOR])

    other = least_squares(misfit, force[0], xtol=1e-12, ftol=1e-12, gtol=1e-12)
    assert_allclose(found.values[0], other.x, rtol=0, atol=1e-4 * found.sigma[0].max())
    assert_allclose(found.cost[0], other.cost, rtol=1e-6, atol=0)
    assert_allclose(found.covariance[0], np.linalg.inv(other.jac.T @ other.jac), rtol=1e-3, atol=1e-7)
    # A planar rod does not feel what pushes it out of its plane.
    assert "push.force.y" in found.unseen
    for label in found.unseen:
        k = found.labels.index(label)
        assert found.sigma[0, k] > 0.99 * PRIOR[k]
    assert_allclose(found.sigma[0, 1], PRIOR[1], rtol=1e-6, atol=0)


def test_what_nothing_determines_is_told() -> None:
    model = build(felt(prior=False).with_unknowns())
    found = estimate(model, measured(model, np.array([[0.5, 0.0, 0.0], [0.2, 0.0, 0.1]]), 2))
    assert found.outcomes == ("not_determined", "not_determined")
    assert np.isnan(found.values).all()
    assert list(found.unseen) == ["push.force.y"]
    assert any("2 of 2 rows not found" in warning for warning in found.warnings)
    assert estimate_result(found)["rows"][0]["value"] == [None, None, None]
    assert estimate_table(found).splitlines()[1].endswith(",not_determined,,,,,,")


def test_cells_that_are_empty_are_not_measured() -> None:
    model = build(felt().with_unknowns())
    data = measured(model, np.array([[0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), 3)
    for axis in "xyz":
        data["shapes"][f"{axis}0"][1] = np.nan
    found = estimate(model, data)
    assert found.numbers.tolist() == [6, 3]
    assert found.sigma[1, 2] > found.sigma[0, 2]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"unknowns": [{"input": "push.force"}]}, "the same in all rows"),
        ({"unknowns": []}, "name what is to be felt"),
        ({"measurements": []}, "say what was measured"),
    ],
)
def test_scenes_that_ask_for_something_else_are_refused(changes: dict[str, Any], message: str) -> None:
    model = build(felt(**changes).with_unknowns())
    with pytest.raises(SceneError, match=message):
        estimate(model, {})
