"""Numbers of concentric tubes that are found again in made-up measurements of them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Identification, Scene, SceneError, build, identify, parse_scene, solve
from cosserat_casadi.identification.measured_quantities import difference
from cosserat_casadi.identification.model_identification import identify_model
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from tests.derivatives import central_differences
from tests.families import mostly_slow

EXAMPLES = Path(__file__).parents[2] / "examples"

TRUTH = {"inner.curvature": 16.0, "outer.material.youngs_modulus": 5.2e10, "inner.straight": 0.184}

MEASURED = """
[[measurements]]
quantity = "position"
file = "shapes.csv"
inputs = { "outer.rotation" = "a", "outer.translation" = "b", "inner.rotation" = "c", "inner.translation" = "d" }
rod = "inner"
at = "X"
columns = ["x", "y", "z"]
sigma = 2e-4
"""

PLACES = (0.7, 0.85, 1.0)

STEPS = 3


def scene(text: str = MEASURED, *overrides: str) -> Scene:
    """Two tubes, of which a curvature, a modulus and a length are unknown."""
    unknowns = "".join(f'[[unknowns]]\nparameter = "{name}"\n' for name in TRUTH)
    tubes = (EXAMPLES / "concentric_tubes.toml").read_text().replace("tolerance = 1e-6", "tolerance = 1e-3")
    return parse_scene(tubes + text + unknowns, overrides)


@cache
def exact_shapes(cases: int) -> FloatArray:
    """Rows of inputs, abscissa and position along the inner tube, at random inputs."""
    truth = build(scene(MEASURED, *[f"{name}={value!r}" for name, value in TRUTH.items()]), STEPS)
    random = np.random.default_rng(5)
    rows = []
    for _ in range(cases):
        inputs = [*random.uniform(-1.2, 1.2, 1), 0.13, *random.uniform(-1.2, 1.2, 1), *random.uniform(0.15, 0.3, 1)]
        solution = solve(truth, inputs, estimate_error=False)
        for place in PLACES:
            position, _ = truth.section["inner"](solution.x, solution.inputs, place)
            rows.append([*inputs, place, *position.full()[:, 0]])
    return np.array(rows)


def shapes(cases: int, seed: int | None) -> dict[str, dict[str, FloatArray]]:
    """Measured columns with the noise that the scene states; none without a seed."""
    table = exact_shapes(cases).copy()
    if seed is not None:
        table[:, -3:] += 2e-4 * np.random.default_rng(seed).standard_normal((len(table), 3))
    return {"shapes.csv": dict(zip(("a", "b", "c", "d", "X", "x", "y", "z"), table.T, strict=True))}


@cache
def fitted_model() -> TubeFunctions:
    return build(scene().with_unknowns(), STEPS)


def found_in(seed: int | None, cases: int = 8) -> Identification:
    return identify_model(fitted_model(), shapes(cases, seed))


def deviations(found: Identification) -> FloatArray:
    """How far the numbers are from the truth, in standard deviations."""
    return (found.shared - np.array(list(TRUTH.values()))) / found.sigma


def test_numbers_are_found_exactly_where_nothing_was_measured_wrongly() -> None:
    found = found_in(None)
    assert found.converged, found.message
    assert_allclose(found.shared, list(TRUTH.values()), rtol=1e-7, atol=0)
    assert found.rms() < 1e-6
    assert found.within_tolerance
    fitted = found.fitted_scene(scene())
    assert_allclose(fitted.tubes[1].curvature, TRUTH["inner.curvature"], rtol=1e-7, atol=0)


@pytest.mark.slow
def test_intervals_hold_the_truth() -> None:
    found = found_in(1)
    assert found.converged
    assert np.abs(deviations(found)).max() < 3.5
    assert 0.8 < found.rms() < 1.2


@pytest.mark.slow
def test_intervals_of_95_percent_cover() -> None:
    """Of 20 repeated experiments with three unknowns: 60 intervals, 57 of them expected to hold the truth."""
    every = np.array([deviations(found_in(seed)) for seed in range(20)])
    assert 52 <= np.sum(np.abs(every) < 1.96) <= 60
    assert_allclose(np.sqrt(np.mean(every**2)), 1.0, rtol=0.25, atol=0)


@pytest.mark.slow
def test_a_scene_is_identified_with_the_steps_that_it_needs() -> None:
    found = identify(scene(), shapes(4, 2))
    assert found.converged
    assert np.abs(deviations(found)).max() < 4.0


@pytest.mark.parametrize("quantity", mostly_slow(["position", "pose"], quick=["pose"]))
def test_derivatives_of_a_difference_are_difference_quotients(quantity: str) -> None:
    columns = '["x", "y", "z", "qw", "qx", "qy", "qz"]' if quantity == "pose" else '["x", "y", "z"]'
    text = MEASURED.replace("position", quantity).replace('["x", "y", "z"]', columns) + "offset = [1e-3, 2e-3, 0.0]\n"
    model = build(scene(text).with_unknowns(), STEPS)
    solution = solve(model, estimate_error=False)
    measured = np.concatenate([np.full(3, 0.01), [0.8, 0.1, -0.3, 0.5]])[: 7 if quantity == "pose" else 3]
    function = difference(model, model.parametric_scene.measurements[0], 2)
    at, p = np.array([[0.8, 0.97]]), model.parameters.pack()
    arguments = [solution.x, solution.inputs, p]
    twice = np.column_stack([measured, measured])
    _, *blocks = function(*arguments, at, twice)
    for number, block in enumerate(blocks):
        steps = 1e-6 * np.maximum(np.abs(arguments[number]), 1e-2)
        quotients = central_differences(
            lambda moved, k=number: function(*arguments[:k], moved, *arguments[k + 1 :], at, twice)[0],
            arguments[number],
            steps,
        )
        assert_allclose(block.full() * steps, quotients * steps, rtol=1e-5, atol=1e-13)


def test_what_is_not_measured_on_tubes_is_refused() -> None:
    with pytest.raises(SceneError, match="'strain' is not measured on tubes"):
        scene(MEASURED.replace('"position"', '"strain"'))
    with pytest.raises(SceneError, match="tubes have none"):
        scene(MEASURED + 'time = "t"\n')
