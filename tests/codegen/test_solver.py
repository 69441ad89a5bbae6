"""The solver in C against the solver in Python: same outcomes, same tips, from every kind of start."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome, export, load, read_scene, solve
from tests.codegen.libraries import Exported, Recipe
from tests.conftest import case_files

Library = Callable[[str], Exported]
ExportRecipe = Callable[..., Exported]

SPREAD = pytest.mark.parametrize(
    ("name", "count", "scale"),
    [("planar", 60, 4.0), ("spatial", 16, 1.0), ("thick", 12, 1.0), ("pair", 20, 2.0), ("pinned", 10, 2.0)],
)
"""Loads of each library: how many, how far from zero."""


def assert_same(made: Exported, inputs: np.ndarray) -> Outcome:
    """Both solvers end alike at these inputs."""
    ours, theirs = made.compiled.solve(inputs), made.solve(inputs)
    assert ours.outcome is theirs.outcome, (inputs, ours, theirs.message)
    if ours.converged:
        assert ours.load_factor == 1.0
        assert_allclose(made.tips(ours.x, inputs), made.tips(theirs.x, inputs), rtol=0, atol=1e-9 * made.length)
    return ours.outcome


@SPREAD
def test_random_loads_vs_python(library: Library, name: str, count: int, scale: float) -> None:
    made = library(name)
    outcomes = [assert_same(made, inputs) for inputs in made.loads(count, 1, scale)]
    assert outcomes.count(Outcome.CONVERGED) >= 0.9 * count


@pytest.mark.slow
@SPREAD
def test_many_random_loads_vs_python(library: Library, name: str, count: int, scale: float) -> None:
    made = library(name)
    for inputs in made.loads(10 * count, 2, 2 * scale):
        assert_same(made, inputs)


def test_scene_without_inputs_vs_python(library: Library) -> None:
    assert assert_same(library("fixed"), np.zeros(0)) is Outcome.CONVERGED


@pytest.mark.parametrize("name", ["planar", "spatial", "pair"])
def test_no_load_leaves_the_rod_as_it_is(library: Library, name: str) -> None:
    made = library(name)
    found = made.compiled.solve(np.zeros(made.model.inputs.size))
    assert found.converged
    assert_allclose(found.x, 0.0, rtol=0, atol=0)


FAST = {"follower_10"}


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[] if path.stem in FAST else pytest.mark.slow)
        for path in case_files("rods")
    ],
)
def test_reference_cases_vs_python(export_recipe: ExportRecipe, path: Path) -> None:
    """The cases on a discretisation too coarse for them: equal equations are asked for, not true ones."""
    made = export_recipe(f"case_{path.stem}", Recipe(read_scene(path), 3, 6, "magnus4"), estimates=False)
    assert_same(made, made.model.pack())


def neighbours(made: Exported) -> list[tuple[np.ndarray, np.ndarray]]:
    """Loads and loads nearby."""
    rng = np.random.default_rng(4)
    return [(inputs, inputs + 0.005 * rng.standard_normal(inputs.shape)) for inputs in made.loads(15, 3)]


@pytest.mark.parametrize("name", ["planar", "spatial", "pair"])
def test_start_nearby_vs_python(library: Library, name: str) -> None:
    made = library(name)
    warm, cold = 0, 0
    for before, inputs in neighbours(made):
        start = made.compiled.solve(before)
        ours, theirs = made.compiled.solve(inputs, start.x), made.solve(inputs, start.x)
        assert ours.converged
        assert theirs.converged
        assert_allclose(made.tips(ours.x, inputs), made.tips(theirs.x, inputs), rtol=0, atol=1e-9 * made.length)
        warm, cold = warm + ours.iterations, cold + made.compiled.solve(inputs).iterations
    assert warm < cold


def test_start_astray_vs_python(library: Library) -> None:
    """A start far from any equilibrium may not decide the branch."""
    made = library("planar")
    inputs, cold = made.model.pack(), made.compiled.solve()
    for start in (np.full(3, 3.0), np.array([0.0, -8.0, 5.0]), np.full(3, 1e9), np.full(3, np.nan)):
        found = made.compiled.solve(inputs, start)
        assert found.converged
        assert_allclose(found.x, cold.x, rtol=0, atol=1e-10)
    assert_allclose(made.solve(inputs, np.full(3, 3.0)).x, cold.x, rtol=0, atol=1e-10)


@pytest.mark.parametrize("name", ["planar", "spatial", "pair", "pinned"])
def test_following_inputs_vs_python(library: Library, name: str) -> None:
    made, values = library(name), library(name).model.inputs.unpack
    ends = made.loads(8, 5)
    for before, inputs in zip(ends[::2], ends[1::2], strict=True):
        start = made.solve(before)
        assert start.converged
        theirs = solve(made.model, values(inputs), start=start)
        ours = made.compiled.follow(before, inputs, start.x)
        assert ours.outcome is theirs.outcome
        if ours.converged:
            assert_allclose(made.tips(ours.x, inputs), made.tips(theirs.x, inputs), rtol=0, atol=1e-9 * made.length)


def test_following_from_what_is_no_equilibrium_corrects_it_first(library: Library) -> None:
    made = library("planar")
    before, inputs = made.loads(2, 6)
    start = made.compiled.solve(before).x
    moved = made.compiled.follow(before, inputs, start + 0.01)
    assert moved.converged
    assert_allclose(moved.x, made.compiled.follow(before, inputs, start).x, rtol=0, atol=1e-10)


def test_unknowns_whose_norm_overflows_are_no_equilibrium(library: Library) -> None:
    """Beside them any residual is small: a relative tolerance alone would accept them."""
    made = library("arch")
    inputs, far = made.model.pack(), np.array([-1.0, -1.0, -1.0, -1.0, 1e154, -1.34e154])
    assert made.compiled.follow(inputs, inputs, far).outcome is Outcome.NOT_FINITE
    assert made.compiled.sensitivity(inputs, far) is None
    assert made.compiled.solve(inputs, far).converged


@pytest.mark.parametrize("small", [1.0, 1e-3])
def test_following_from_a_huge_load_ends_exactly_at_the_small_one(library: Library, small: float) -> None:
    """A pull along the rod of any size leaves it straight; what is small beside it may not be lost on the way."""
    made = library("planar")
    huge, inputs = np.array([0.0, 0.0, 1e16]), np.array([0.9, 0.0, small])
    found = made.compiled.follow(huge, inputs, np.zeros(3))
    assert found.converged
    assert_allclose(found.x, made.compiled.solve(inputs).x, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", ["planar", "spatial", "pair", "fixed"])
def test_batch_vs_single_solves(library: Library, name: str) -> None:
    """To the last digit: no case knows of those before it."""
    made = library(name)
    cases = made.loads(20, 7) if made.model.inputs.size else np.zeros((3, 0))
    batch = made.compiled.solve_batch(cases)
    assert len(batch) == len(cases)
    for inputs, one in zip(cases, batch, strict=True):
        other = made.compiled.solve(inputs)
        assert one.outcome is other.outcome
        assert one.iterations == other.iterations
        assert_allclose(one.x, other.x, rtol=0, atol=0)


def test_batch_goes_on_after_a_case_that_fails(library: Library) -> None:
    made = library("planar")
    cases = made.loads(5, 8)
    cases[1], cases[3] = np.nan, 1e200
    batch = made.compiled.solve_batch(cases)
    assert [one.converged for one in batch] == [True, False, True, False, True]
    assert batch[1].outcome is Outcome.NOT_FINITE
    assert np.isnan(batch[1].residual_norm)
    assert made.compiled.solve_batch(np.zeros((0, 3))) == []
    assert_allclose(batch[4].x, made.compiled.solve(cases[4]).x, rtol=0, atol=1e-10)


@pytest.mark.parametrize("force", [-1e4, 1e4])
def test_load_that_stalls_vs_python(library: Library, force: float) -> None:
    """An arch whose keystone is pushed beyond what can be followed: the last equilibrium on the way, and where."""
    made = library("arch")
    inputs = force * ACROSS
    ours, theirs = made.compiled.solve(inputs), made.solve(inputs)
    assert ours.outcome is theirs.outcome is Outcome.LOAD_STALLED
    assert 0.0 < ours.load_factor < 1.0
    assert_allclose(ours.load_factor, theirs.load_factor, rtol=0, atol=1e-3)
    there = made.model.path_residual(ours.x, inputs, ours.load_factor).full()
    assert np.linalg.norm(there) <= 1e-10 * (1 + np.linalg.norm(ours.x))
    # What is reported is what is left at the load that was asked for.
    left = np.linalg.norm(made.model.residual(ours.x, inputs).full()) / (1 + np.linalg.norm(ours.x))
    assert left > 1e-7
    assert_allclose(ours.residual_norm, left, rtol=1e-10, atol=0)
    assert_allclose(ours.residual_norm, theirs.residual_norm, rtol=1e-2, atol=0)


ACROSS = np.array([0.8870, 0.0, -0.4618])
"""Perpendicular to the chord of the arch."""


@pytest.mark.parametrize("name", ["planar", "spatial", "thick", "pair", "pinned"])
def test_sensitivity_vs_differences_and_vs_the_implicit_function_theorem(library: Library, name: str) -> None:
    made = library(name)
    model, step = made.model, 1e-5
    for inputs in made.loads(3, 9):
        q = made.compiled.solve(inputs).x
        found = made.compiled.sensitivity(inputs, q)
        assert found is not None
        d_q, d_tip = found
        jacobian, slopes = model.jacobian(q, inputs)[0].full(), model.input_jacobian(q, inputs).full()
        assert_allclose(d_q, -np.linalg.solve(jacobian, slopes), rtol=1e-9, atol=1e-9)
        for k in range(len(inputs)):
            ends = [inputs.copy(), inputs.copy()]
            ends[0][k] -= step
            ends[1][k] += step
            solved = [made.compiled.solve(end, q) for end in ends]
            assert all(one.converged for one in solved)
            assert_allclose(d_q[:, k], (solved[1].x - solved[0].x) / (2 * step), rtol=1e-4, atol=1e-5)
            for rod, tip in model.tip.items():
                poses = [
                    np.concatenate([p.full()[:, 0] for p in tip(s.x, e)[:2]]) for s, e in zip(solved, ends, strict=True)
                ]
                assert_allclose(d_tip[rod][:, k], (poses[1] - poses[0]) / (2 * step), rtol=1e-4, atol=1e-5)


def test_loaded_folder_vs_model(library: Library, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As a user loads it, derivatives included: residual and tip with their Jacobians by ``casadi.external``."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    made = library("tiny")
    folder = export(made.model, tmp_path / "tiny", derivatives=True)
    loaded, model = load(folder), made.model
    inputs, q = made.loads(1, 10)[0], np.array([0.4, -0.7])
    x = ca.MX.sym("x", 2)
    slope = ca.Function("slope", [x], [ca.jacobian(loaded.residual(x, inputs), x)])
    turn = ca.Function("turn", [x], [ca.jacobian(loaded.tip["rod"](x, inputs)[0], x)])
    assert_allclose(loaded.residual(q, inputs).full(), model.residual(q, inputs).full(), rtol=1e-12, atol=1e-12)
    assert_allclose(slope(q).full(), model.jacobian(q, inputs)[0].full(), rtol=1e-12, atol=1e-12)
    wanted = model.tip_jacobian["rod"](q, inputs)[0].full()[:3]
    assert_allclose(turn(q).full(), wanted, rtol=1e-12, atol=1e-12)
    for case in made.loads(20, 11):
        assert_allclose(loaded.solve(case).x, made.solve(case).x, rtol=0, atol=1e-9)


def test_sensitivity_without_inputs_is_empty(library: Library) -> None:
    made = library("fixed")
    found = made.compiled.sensitivity([], made.compiled.solve().x)
    assert found is not None
    assert found[0].shape == (made.model.size, 0)
    assert found[1]["rod"].shape == (7, 0)
