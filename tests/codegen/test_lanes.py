"""Rows side by side give what rows one after the other give: numbers, iterations, outcomes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import Model, Scene, build
from cosserat_casadi.codegen import compiler, lanes, rows
from cosserat_casadi.codegen.names import model_names
from cosserat_casadi.codegen.rows import RowLibrary, row_library
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.libraries import ARMS, HAND, LOAD, WRISTS
from tests.scenes import push, rod, scene

CONVERGED, NOT_FINITE = 0, 2

SMALL = {"modes": 2, "nodes": 3}

BUDGET = 32_000
"""Bytes of the equations in lanes of a small planar rod with two parameters."""

TENDON = {"name": "pull", "kind": "tendon", "rod": "rod", "tension": 0.6, "offset": [0.02, 0.01]}


@pytest.fixture(scope="module", autouse=True)
def _quick_compiler() -> Any:
    """Optimising takes the compiler far longer than running slowly takes the tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiler, "FLAGS", ("-O0", "-std=c99", "-fPIC"))
        yield


@pytest.fixture(scope="module")
def planar() -> RowLibrary:
    return side_by_side(scene(push(), strain="planar", accuracy=SMALL))


def side_by_side(asked: Scene) -> RowLibrary:
    library = row_library(build(asked), lanes=True)
    assert library.in_lanes
    return library


def assert_same(library: RowLibrary, inputs: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
    """Compare with the rows one after the other, by the same compiled object."""
    found = library.solve(inputs, parameters)
    expected = replace(library, in_lanes=False).solve(inputs, parameters)
    # The order of sums is the same too, but for a residual that is nothing but rounding.
    assert_array_equal(found[:, :2], expected[:, :2])
    assert_allclose(found[:, 2:], expected[:, 2:], rtol=1e-12, atol=1e-12)
    return found


def pushes(count: int, size: float) -> FloatArray:
    return np.random.default_rng(3).uniform(-size, size, (count, 3))


@pytest.mark.parametrize("count", [0, 1, 3, 17, 100])
def test_rows_of_any_number_are_the_same(planar: RowLibrary, count: int) -> None:
    found = assert_same(planar, pushes(count, 2.0))
    assert_array_equal(found[:, 0], CONVERGED)


def test_rows_whose_load_grows_in_steps_are_the_same(planar: RowLibrary) -> None:
    found = assert_same(planar, pushes(60, 3000.0))
    assert found[:, 1].max() > 20
    assert len(set(found[:, 0])) > 1


def test_rows_that_fail_leave_their_neighbours_alone(planar: RowLibrary) -> None:
    inputs = pushes(23, 1.0)
    inputs[4] = np.nan
    inputs[9, 1] = np.inf
    inputs[10] = 1e200
    found = assert_same(planar, inputs)
    assert found[4, 0] == found[9, 0] == NOT_FINITE
    assert found[10, 0] != CONVERGED
    assert np.isnan(found[[4, 9, 10], 3:]).all()
    sound = np.delete(np.arange(23), [4, 9, 10])
    assert_array_equal(found[sound], planar.solve(inputs[sound]))


def test_tendons_are_the_same() -> None:
    library = side_by_side(scene(push(), accuracy=SMALL, actuators=[TENDON]))
    inputs = np.column_stack([pushes(14, 0.5), np.linspace(0.0, 4.0, 14)])
    found = assert_same(library, inputs)
    assert_array_equal(found[:, 0], CONVERGED)
    assert np.ptp(found[:, -1]) > 1e-3


def with_parameters() -> Scene:
    """A planar rod whose length and pre-curvature differ from row to row."""
    bent = rod("planar", intrinsic={"curvature": [0.0, 0.4, 0.0]})
    named = ["rod.length", "rod.intrinsic.curvature.y"]
    return scene(push(), rods=[bent], accuracy=SMALL, parameters=named)


def drawn_parameters(model: Model, count: int) -> FloatArray:
    own = model.parameters.pack()
    return own * np.random.default_rng(5).uniform(0.8, 1.2, (count, len(own)))


def test_rows_of_parameters_are_the_same() -> None:
    model = build(with_parameters())
    library = row_library(model, lanes=True)
    assert library.in_lanes
    inputs = pushes(30, 2.0)
    parameters = drawn_parameters(model, 30)
    found = assert_same(library, inputs, parameters)
    assert_array_equal(found[:, 0], CONVERGED)
    assert np.ptp(found[:, 3]) > 1e-3
    # One row of parameters that are no numbers, and loads that grow in steps.
    parameters[4, 0] = np.nan
    inputs[11:] *= 1000
    found = assert_same(library, inputs, parameters)
    assert found[4, 0] == NOT_FINITE
    assert found[:, 1].max() > 20


def test_code_of_rows_of_parameters_stays_small() -> None:
    files = dict(row_library(build(with_parameters()), lanes=True).files)
    assert len(files["sweep_lanes.c"]) <= BUDGET


def test_kernels_too_long_for_lanes_are_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lanes, "STRAIGHT_IN_LANES", 500)
    assert not row_library(build(scene(push(), accuracy=SMALL, actuators=[TENDON])), lanes=True).in_lanes


def test_a_compiler_without_vectors_solves_row_after_row(planar: RowLibrary, monkeypatch: pytest.MonkeyPatch) -> None:
    inputs = pushes(7, 1.0)
    expected = planar.solve(inputs)
    monkeypatch.setattr(compiler, "FLAGS", (*compiler.FLAGS, "-DLANES=0"))
    rows._library.cache_clear()
    assert_array_equal(planar.solve(inputs), expected)
    rows._library.cache_clear()


def test_assemblies_have_no_form_for_lanes() -> None:
    model = build(scene(LOAD, rods=ARMS, bodies=[HAND], joints=WRISTS, accuracy={"modes": 1, "nodes": 2}))
    assert lanes.in_lanes(model, model_names("sweep", model), [], 3) is None


@pytest.mark.parametrize(
    ("line", "alike"),
    [
        ("a01=(a02*a03);", True),
        ("a01=arg[0]? arg[0][5] : 0;", True),
        ("a01=casadi_fmax(a02,a03);", True),
        ("if (res[0]!=0) res[0][1]=a01;", True),
        ("for (rr=(&w1), cs=w2+8; cs!=w2+9; cs+=1) *rr++ = *cs;", True),
        ("a01=(a02<a03);", False),
        ("a01=(a02?a03:0);", False),
        ("a01=(!a02);", False),
        ("a01=tanh(a02);", False),
    ],
)
def test_what_lanes_cannot_do_together_is_known(line: str, alike: bool) -> None:
    assert lanes._alike(f"static int casadi_f1(const casadi_real** arg) {{\n  {line}\n}}") is alike
