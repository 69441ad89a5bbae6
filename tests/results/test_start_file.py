"""A result file gives back the equilibrium that it was written from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, SceneError, Solution, build, follow, solve
from cosserat_casadi.results.start_file import read_start
from tests.motions import two_rods_on_a_platform
from tests.scenes import HOOK, WIND, push, rod, scene, three_cables


def read_back(solution: Solution, given: Scene, folder: Path) -> Solution:
    path = folder / "result.json"
    solution.write(path)
    return read_start(path, given)


@pytest.mark.parametrize("values", [{}, {"push.force": [-0.5, 0.2, 0.6]}])
def test_unknowns_and_inputs_come_back(tmp_path: Path, values: dict[str, Any]) -> None:
    given = scene(push(), HOOK, WIND, strain="reissner")
    solution = solve(build(given), values)
    start = read_back(solution, given, tmp_path)
    assert_allclose(start.x, solution.x, rtol=0, atol=1e-10)
    assert_allclose(start.inputs, solution.inputs, rtol=0, atol=0)
    assert start.model.discretisation == solution.model.discretisation


def test_a_chosen_discretisation_comes_back(tmp_path: Path) -> None:
    given = scene(push(force=[3.0, 1.0, -1.0]))
    solution = solve(given)
    start = read_back(solution, given, tmp_path)
    assert start.model.discretisation == solution.model.discretisation
    assert_allclose(start.x, solution.x, rtol=0, atol=1e-10)


@pytest.mark.slow
def test_assemblies_and_cables_come_back(tmp_path: Path) -> None:
    model = two_rods_on_a_platform(frames=1).model
    for given in (model.scene, three_cables()):
        solution = solve(build(given))
        start = read_back(solution, given, tmp_path)
        assert_allclose(start.x, solution.x, rtol=0, atol=1e-9)


def test_the_branch_of_the_file_is_kept(tmp_path: Path) -> None:
    """A column beyond its buckling load: solved from the straight rod it stays straight."""
    upright = rod("planar", length=2.0, stiffness={"bending_y": 1.0})
    given = scene(push(force=[0.0, 0.0, -1.2]), rods=[upright])
    bent = follow(build(given), "push.force", [0.0, 0.0, -1.2], branch=True).solution(-1)
    start = read_back(bent, given, tmp_path)
    assert abs(bent.tip().position[0]) > 0.5
    assert_allclose(start.tip().position, bent.tip().position, rtol=0, atol=1e-9)


def test_a_length_that_is_an_input_comes_back(tmp_path: Path) -> None:
    given = scene(push(), strain="reissner", inputs=["rod.length", "push.force"])
    solution = solve(build(given), {"rod.length": 0.7})
    start = read_back(solution, given, tmp_path)
    assert_allclose(start.x, solution.x, rtol=0, atol=1e-10)


def spoilt(solution: Solution, path: Path, **changes: Any) -> Path:
    solution.write(path)
    data = json.loads(path.read_text(encoding="utf-8")) | changes
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"converged": False}, "holds no equilibrium"),
        ({"discretisation": {}}, "is no result file of this scene"),
        ({"rods": {"rod": {"X": [0.0, 1.0]}}}, "is no result file of this scene"),
        ({"inputs": {"push.force": [1.0]}}, "is no result file of this scene"),
        ({"inputs": {"push.force": [0.0, 0.0, 0.0]}}, "an equilibrium that this scene does not have"),
    ],
)
def test_files_that_do_not_fit_are_refused(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    given = scene(push())
    path = spoilt(solve(build(given)), tmp_path / "result.json", **changes)
    with pytest.raises(SceneError, match=f"--from: .*{words}"):
        read_start(path, given)


def test_a_scene_that_was_changed_is_refused(tmp_path: Path) -> None:
    solution = solve(build(scene(push())))
    with pytest.raises(SceneError, match="the scene was changed since"):
        read_back(solution, scene(push(), rods=[rod(length=0.81)]), tmp_path)


@pytest.mark.parametrize(("text", "words"), [("{", "is not JSON"), ("[1]", "is no result file"), (None, "cannot be")])
def test_files_that_are_no_results_are_refused(tmp_path: Path, text: str | None, words: str) -> None:
    path = tmp_path / "result.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(SceneError, match=f"--from: .*{words}"):
        read_start(path, scene(push()))


def test_a_number_that_is_missing_is_refused(tmp_path: Path) -> None:
    given = scene(push())
    solution = solve(build(given))
    solution.write(tmp_path / "result.json")
    data = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    positions = np.array(data["rods"]["rod"]["position"])
    positions[3, 1] = np.nan
    rods = {"rod": {**data["rods"]["rod"], "position": positions.tolist()}}
    path = spoilt(solution, tmp_path / "result.json", rods=rods)
    with pytest.raises(SceneError, match="is no result file of this scene"):
        read_start(path, given)


SPOILT = {
    "huge input": ("inputs", "push.force", [10**400, 0, 0]),
    "billions of modes": ("discretisation", "rod", "modes", [10**9] * 3),
    "modes that are no numbers": ("discretisation", "rod", "modes", [True, "a", None]),
    "billions of nodes": ("discretisation", "rod", "nodes", 10**9),
    "half a node": ("discretisation", "rod", "nodes", 10.5),
    "breaks that do not ascend": ("discretisation", "rod", "breaks", [0, 0.5, 0.5, 1]),
    "breaks elsewhere": ("discretisation", "rod", "breaks", [1, 2]),
    "huge break": ("discretisation", "rod", "breaks", [0, 10**400]),
    "unknown transport": ("discretisation", "rod", "transport", []),
    "huge abscissa": ("rods", "rod", "X", [10**400]),
    "abscissae beyond the rod": ("rods", "rod", "X", [1e308]),
    "abscissae that are no list": ("rods", "rod", "X", 0.5),
    "no strains": ("rods", "rod", "strain", []),
    "strains that are none": ("rods", "rod", "strain", None),
    "huge positions": ("rods", "rod", "position", [[10**400, 0, 0]]),
}
"""Path of an entry of a result file, and what is put there."""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The result file of a rod that is pushed."""
    path = tmp_path_factory.mktemp("written") / "result.json"
    solve(build(scene(push()))).write(path)
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", SPOILT)
def test_files_with_a_spoilt_entry_are_refused(tmp_path: Path, written: str, name: str) -> None:
    given = scene(push())
    path = tmp_path / "result.json"
    data = json.loads(written)
    *keys, last, value = SPOILT[name]
    entry = data
    for key in keys:
        entry = entry[key]
    entry[last] = value
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(SceneError, match=r"--from: .* is no result file of this scene"):
        read_start(path, given)


def test_a_file_that_is_nested_too_deeply_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "result.json"
    path.write_text("[" * 100_000, encoding="utf-8")
    with pytest.raises(SceneError, match="is not JSON"):
        read_start(path, scene(push()))
