"""What an identification leaves open, leaves out, holds out and tries again; intervals under a robust loss."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, identify, solve
from cosserat_casadi.identification.statistics import NORMAL_95, NoiseFrom, Statistics, statistics
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arrow_least_squares import ArrowStep
from cosserat_casadi.scene import scene_from_dict

STRIP: dict[str, Any] = {
    "schema": 1,
    "accuracy": {"modes": 4, "nodes": 10},
    "rods": [
        {
            "name": "strip",
            "length": 0.2,
            "strain": "planar",
            "material": {"youngs_modulus": 50e9, "poisson_ratio": 0.3},
            "section": {"shape": "circle", "radius": 0.5e-3},
        }
    ],
    "loads": [{"name": "push", "kind": "tip_wrench", "rod": "strip", "force": [0, 0, 0], "moment": [0, 0, 0]}],
    "measurements": [
        {
            "quantity": "position",
            "file": "tips.csv",
            "inputs": {"push.moment.y": "M"},
            "rod": "strip",
            "columns": ["x", "", "z"],
            "sigma": 2e-4,
        }
    ],
    "unknowns": [{"parameter": "strip.material.youngs_modulus"}],
}

MOMENTS = np.array([1e-4, 2e-4, 3e-4, 6e-3, 1e-2])
"""About the normal of the plane, N m: the largest bends the strip by 0.8 rad."""


def built(**changes: Any) -> Model:
    return build(scene_from_dict({**STRIP, **changes}).with_unknowns())


def tips(seed: int = 1) -> dict[str, FloatArray]:
    """Tips of the strip under five moments, with noise."""
    model = built().at()
    solutions = [solve(model, {"push.moment": [0.0, moment, 0.0]}) for moment in MOMENTS]
    positions = np.array([solution.pose(1.0).position for solution in solutions])
    positions += 2e-4 * np.random.default_rng(seed).standard_normal(positions.shape)
    return {"M": MOMENTS, "x": positions[:, 0], "z": positions[:, 2]}


@pytest.mark.slow
def test_cases_without_equilibrium_at_the_start_are_tried_again() -> None:
    """So soft a strip is rolled up by the larger moments; by the smaller ones the modulus is found."""
    soft = {**STRIP["rods"][0], "material": {"youngs_modulus": 0.5e9, "poisson_ratio": 0.3}}
    model = built(rods=[soft])
    stopped = identify(built(rods=[soft], identification={"failures": "stop"}), {"tips.csv": tips()})
    assert stopped.outcome == "no_equilibrium"
    assert {case.where for case in stopped.left_out} == {"tips.csv, line 4", "tips.csv, line 5"}
    found = identify(model, {"tips.csv": tips()})
    assert found.converged, found.message
    assert found.left_out == ()
    assert len(found.cases) == len(MOMENTS)
    assert abs(found.shared[0] - 50e9) < 3.5 * found.sigma[0]
    at_once = identify(built(), {"tips.csv": tips()})
    assert_allclose(found.shared, at_once.shared, rtol=1e-6, atol=0)


def test_rows_say_which_cases_are_held_out() -> None:
    measured = {**STRIP["measurements"][0], "held_out": {"set": "test"}}
    columns = {**tips(), "set": np.array(["fit", "test", "fit", "test", "fit"])}
    found = identify(built(measurements=[measured]), {"tips.csv": columns})
    assert found.converged, found.message
    assert found.cases == ("tips.csv, line 1", "tips.csv, line 3", "tips.csv, line 5")
    assert {row.where for row in found.rows if row.held_out} == {"tips.csv, line 2", "tips.csv, line 4"}
    held_out = found.rms(held_out=True)
    assert held_out is not None
    assert held_out < 2.0
    everything = {**columns, "set": np.full(5, "test")}
    with pytest.raises(SceneError, match="held_out holds out all cases"):
        identify(built(measurements=[measured]), {"tips.csv": everything})


def test_unknowns_of_single_cases_that_no_datum_sees_are_named() -> None:
    """Out of its plane a planar strip cannot go: moments about other axes move nothing."""
    measured = {key: value for key, value in STRIP["measurements"][0].items() if key != "inputs"}
    pose = {**measured, "quantity": "pose", "columns": ["x", "", "z", "qw", "qx", "qy", "qz"]}
    unknowns = [{"input": "push.moment", "per_row": True}]
    columns = tips()
    half = MOMENTS * 0.2 / (2 * 50e9 * np.pi * 0.5e-3**4 / 4)
    columns |= {"qw": np.cos(half), "qx": np.zeros(5), "qy": np.sin(half), "qz": np.zeros(5)}
    found = identify(
        built(
            measurements=[{**pose, "sigma": [2e-4, 2e-4, 2e-4, 0.1, 0.1, 0.1], "held_out": {"set": "test"}}],
            unknowns=unknowns,
        ),
        {"tips.csv": {**columns, "set": np.array(["fit", "fit", "fit", "fit", "test"])}},
    )
    assert found.converged, found.message
    sigma = found.statistics.own
    assert np.all(np.isnan(sigma[:, [0, 2]]))
    assert np.all(np.isfinite(sigma[:, 1]))
    assert np.all(np.abs(found.own[:, 1] - MOMENTS[:4]) < 4 * sigma[:, 1])
    (named,) = [warning for warning in found.warnings if "push.moment.x" in warning]
    assert named.startswith("The data do not determine push.moment.x in tips.csv, line 1, ")
    assert any("the prediction tests only the rest of these numbers" in warning for warning in found.warnings)


def linear(noise_from: NoiseFrom, squares: float, count: int = 20) -> Statistics:
    """So many residuals of one unknown whose information is their number."""
    ones = np.ones((count, 1))
    offsets = np.array([0, count])
    arrow = ArrowStep(np.zeros(count), ones, offsets, 1, np.zeros(1), np.zeros(1), np.zeros(1, dtype=bool))
    scales = (np.ones(1), np.zeros(0))
    return statistics(arrow, ("a",), scales, freedom=count - 1, squares=squares, noise_from=noise_from)


def test_noise_is_stated_or_follows_from_the_residuals_or_is_the_larger() -> None:
    stated = linear(NoiseFrom.SIGMA, 4 * 19.0)
    assert_allclose(stated.sigma, np.sqrt(1 / 20), rtol=1e-12, atol=0)
    assert stated.quantile == NORMAL_95
    for noise_from in (NoiseFrom.RESIDUALS, NoiseFrom.BOTH):
        larger = linear(noise_from, 4 * 19.0)
        assert_allclose(larger.sigma, 2 * np.sqrt(1 / 20), rtol=1e-12, atol=0)
        assert larger.quantile > NORMAL_95
    smaller = linear(NoiseFrom.BOTH, 19.0 / 4)
    assert_allclose(smaller.sigma, np.sqrt(1 / 20), rtol=1e-12, atol=0)
    assert smaller.quantile == NORMAL_95
    assert_allclose(linear(NoiseFrom.RESIDUALS, 19.0 / 4).sigma, np.sqrt(1 / 20) / 2, rtol=1e-12, atol=0)


def test_a_robust_loss_widens_intervals_where_residuals_ask_for_it() -> None:
    spoilt = tips()
    spoilt["x"] = spoilt["x"] + np.array([0.0, 0.0, 3e-3, -3e-3, 0.0])
    by_loss = {}
    for loss in ("squares", "huber"):
        found = identify(built(identification={"loss": loss}), {"tips.csv": spoilt})
        assert found.converged, found.message
        by_loss[loss] = found.statistics.noise
    assert by_loss["squares"] == 1.0
    assert by_loss["huber"] > 1.0


@pytest.mark.parametrize(("freedom", "tabled"), [(1, 12.706), (2, 4.303), (5, 2.571), (19, 2.093), (120, 1.980)])
def test_quantiles_of_few_data_are_those_of_students_table(freedom: int, tabled: float) -> None:
    assert_allclose(linear(NoiseFrom.RESIDUALS, 4.0, 1 + freedom).quantile, tabled, rtol=0, atol=5e-4)
