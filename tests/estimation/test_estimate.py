"""Estimates beside the truths that made the measurements, and beside a search of another kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import least_squares
from scipy.stats import chi2

from cosserat_casadi import Model, SceneError, build, parse_scene, scene_from_dict, solve
from cosserat_casadi.estimation import Estimate, estimate, stacking
from cosserat_casadi.identification.fit_problem import far_positions
from cosserat_casadi.identification.measured_quantities import difference
from cosserat_casadi.model.operations import operations
from cosserat_casadi.results.presentation import csv_of
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.writing import scene_tables
from tests.scenes import markers, push, rod, scene

SIGMA = 1e-3
PRIOR = np.array([1.0, 1.0, 0.2])
AT = (0.5, 1.0)
Values = Mapping[str, np.ndarray]
TIP = {"input": "push.force", "per_row": True}


def felt(prior: bool = True, sections: tuple[float, ...] = AT, strain: str = "planar", **changes: Any) -> Scene:
    """A rod with markers; its tip is pushed by an unknown force."""
    unknown = {**TIP, "prior": {"mean": 0.0, "sigma": PRIOR.tolist()}} if prior else TIP
    base = scene(push(force=[0.0, 0.0, 0.0]), rods=[rod(strain)], accuracy={"modes": 3, "nodes": 8, "tolerance": 1e-3})
    tables = {
        **scene_tables(base),
        "inputs": [],
        "measurements": markers(sections, SIGMA),
        "unknowns": [unknown],
        **changes,
    }
    return scene_from_dict(tables)


def measured(model: Model, felt_loads: Sequence[Values], seed: int) -> dict[str, dict[str, np.ndarray]]:
    """Positions of the markers under loads, with noise."""
    rng = np.random.default_rng(seed)
    columns: dict[str, list[float]] = {f"{axis}{k}": [] for k in range(len(AT)) for axis in "xyz"}
    for loads in felt_loads:
        positions = solve(model, loads).pose(AT, "rod").position
        for k in range(len(AT)):
            for axis, value in zip("xyz", positions[k] + rng.normal(0.0, SIGMA, 3), strict=True):
                columns[f"{axis}{k}"].append(value)
    return {"shapes": {name: np.array(values) for name, values in columns.items()}}


def pushes(forces: npt.ArrayLike) -> list[Values]:
    """Forces at the tip as inputs."""
    return [{"push.force": force} for force in np.asarray(forces)]


def nees(found: Estimate, forces: np.ndarray) -> np.ndarray:
    """Squared errors in the metric of their covariances."""
    errors = found.values - forces
    return np.einsum("ci,cij,cj->c", errors, np.linalg.inv(found.covariance), errors)


def assert_consistent(count: int, strain: str) -> None:
    """The mean of the squared errors is within the 95 % band of its distribution."""
    model = build(felt(strain=strain).with_unknowns())
    forces = np.random.default_rng(4).normal(size=(count, 3)) * PRIOR
    found = estimate(model, measured(model, pushes(forces), 5))
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
    data = measured(model, pushes(force), 1)
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


def test_the_library_of_a_model_is_written_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """However often rows come: it takes thousands of times as long as a row. Other sections have another."""
    model = build(felt().with_unknowns())
    rows = measured(model, pushes(np.zeros((2, 3))), 6)
    written: list[int] = []
    write = stacking.estimator_library

    def counted(*arguments: Any) -> Any:
        written.append(1)
        return write(*arguments)

    monkeypatch.setattr(stacking, "estimator_library", counted)
    found = [estimate(model, rows) for _ in range(3)]
    assert len(written) == 1
    assert_allclose(found[2].values, found[0].values, rtol=0, atol=0)
    stacking.row_library(model, {0: 1}, [0, 1, 2], np.array([[0.5]]))
    assert len(written) == 2


def test_measured_sections_share_the_variations_of_the_rod() -> None:
    """Automatic differentiation of four sections of this rod takes 26 557 scalar operations."""
    model = build(felt(strain="kirchhoff").with_unknowns())
    record = model.scene.measurements[0]
    assert operations(difference(model, record, 4)) < 16_000


def test_positions_in_millimetres_are_told() -> None:
    model = build(felt().with_unknowns())
    data = measured(model, pushes([[0.1, 0.0, 0.0]]), 5)
    assert not any("mm" in warning for warning in estimate(model, data).warnings)
    in_millimetres = {"shapes": {name: 1e3 * column for name, column in data["shapes"].items()}}
    assert any("are the columns in mm?" in warning for warning in estimate(model, in_millimetres).warnings)


ON_A_FAR_ARM = """
schema = 1
bodies = [{ name = "arm" }]
[[rods]]
name = "rod"
length = 0.1
strain = "kirchhoff"
stiffness = { bending_x = 0.5, bending_y = 0.5, torsion = 0.4 }
[[joints]]
body = "arm"
rod = "rod"
at = 0
kind = "fixed"
[[joints]]
carries = { body = "arm" }
kind = "revolute"
axis = [0, 1, 0]
position = [5, 0, 0]
[[measurements]]
quantity = "position"
file = "shapes.csv"
rod = "rod"
at = 1.0
columns = ["x", "y", "z"]
sigma = 1e-3
"""


def test_positions_of_a_rod_on_a_far_body_are_no_millimetres() -> None:
    """The rod has no base in the world: where its body is, a joint says."""
    scene = parse_scene(ON_A_FAR_ARM)
    assert not list(far_positions(scene, [(0, 0, 5.1)]))
    assert len(list(far_positions(scene, [(0, 0, 5.1e3)]))) == 1


def test_what_nothing_determines_is_told() -> None:
    model = build(felt(prior=False).with_unknowns())
    found = estimate(model, measured(model, pushes([[0.5, 0.0, 0.0], [0.2, 0.0, 0.1]]), 2))
    assert found.outcomes == ("not_determined", "not_determined")
    assert np.isnan(found.values).all()
    assert list(found.unseen) == ["push.force.y"]
    assert any("2 of 2 rows not found" in warning for warning in found.warnings)
    # What was left over in them says nothing of the model.
    assert found.consistency.freedom == 0
    assert np.isnan(found.consistency.row_deviations).all()
    assert found.to_dict()["message"] == "0 of 2 rows found."
    assert found.to_dict()["rows"][0]["value"] == [None, None, None]
    assert csv_of(found).splitlines()[1].endswith(",not_determined,,,,,,")


def test_rows_that_only_an_unstable_equilibrium_explains_are_named() -> None:
    """A rod whose tip comes nearer by more than its bending allows is buckled: no stable one has its tip there."""
    at_tip = markers((1.0,), SIGMA)
    model = build(felt(prior=False, strain="kirchhoff", measurements=at_tip).with_unknowns())
    columns = {"x0": [0.04, 0.16], "y0": [0.0, 0.0], "z0": [0.796, 0.781]}
    found = estimate(model, {"shapes": {name: np.array(values) for name, values in columns.items()}})
    assert found.stable == (False, True)
    tables = [row["stable"] for row in found.to_dict()["rows"]]
    assert tables == [False, True]
    (warning,) = (warning for warning in found.warnings if "not stable" in warning)
    assert found.cases[0] in warning
    assert found.cases[1] not in warning
    # The rod that is loaded from nothing ends elsewhere, whose error says nothing of this row.
    felt_force = {"push.force": found.values[0]}
    assert abs(solve(model, felt_force).tip().position[2] - 0.796) > 0.1


def test_a_load_along_the_rod_is_felt_from_its_shape() -> None:
    """Two Legendre coefficients of a made-up load, within deviations that are narrower than those of the prior."""
    sigma = 2.0
    names = ("wind.force.x", "wind.force.x.1")
    wind = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "force": [[0.0, 0.0], 0.0, 0.0]}
    prior = {"mean": 0.0, "sigma": sigma}
    unknowns = [{"input": name, "per_row": True, "prior": prior} for name in names]
    model = build(felt(loads=[wind], unknowns=unknowns).with_unknowns())
    truth = np.random.default_rng(8).normal(size=(12, 2)) * sigma
    force = np.zeros((12, *np.shape(model.inputs.unpack(model.pack())["wind.force"])))
    force[:, 0, :] = truth
    found = estimate(model, measured(model, [{"wind.force": value} for value in force], 9))
    assert found.labels == names
    assert found.unseen == {}
    # Two markers tell the mean of a load far better than how it is spread.
    assert (found.sigma < np.array([0.4, 0.8]) * sigma).all()
    low, high = chi2.ppf([0.005, 0.995], truth.size) / len(truth)
    assert low <= nees(found, truth).mean() <= high


@pytest.mark.slow
def test_cells_that_are_empty_are_not_measured() -> None:
    model = build(felt().with_unknowns())
    data = measured(model, pushes([[0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), 3)
    for axis in "xyz":
        data["shapes"][f"{axis}0"][1] = np.nan
    found = estimate(model, data)
    assert found.numbers.tolist() == [6, 3]
    assert found.sigma[1, 2] > found.sigma[0, 2]


FREQUENCY = {"quantity": "frequency", "file": "shapes.csv", "columns": ["f"], "sigma": 0.1}
OVER_TIME = {
    "quantity": "position",
    "file": "shapes.csv",
    "time": "t",
    "rod": "rod",
    "columns": ["x", "y", "z"],
    "sigma": 0.1,
}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"unknowns": [{"input": "push.force"}]}, "the same in all rows"),
        ({"unknowns": []}, "name the unknowns to estimate"),
        ({"measurements": []}, "say what was measured"),
        ({"measurements": [FREQUENCY]}, "not their vibrations"),
        ({"measurements": [OVER_TIME], "simulation": {"duration": 1.0}}, "only, no motion"),
    ],
)
def test_scenes_that_ask_for_something_else_are_refused(changes: dict[str, Any], message: str) -> None:
    model = build(felt(**changes).with_unknowns())
    with pytest.raises(SceneError, match=message):
        estimate(model, {})
