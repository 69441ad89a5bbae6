"""Every result is plain data, a file, a figure and a few lines: held for each public class of results."""

from __future__ import annotations

import builtins
import csv
import inspect
import json
import sys
from collections.abc import Callable
from dataclasses import replace
from enum import Enum
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose
from PIL import Image

import cosserat_casadi
import cosserat_casadi.control
import cosserat_casadi.estimation
from cosserat_casadi import (
    Outcome,
    Sweep,
    build,
    choose,
    discretise,
    follow,
    identify,
    inverse,
    linearise,
    modes_of,
    read_scene,
    solve,
)
from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.errors import SceneError
from cosserat_casadi.estimation import Estimate
from cosserat_casadi.estimation.consistency import Consistency
from cosserat_casadi.paths.tube_path import TubePath
from cosserat_casadi.result import Result
from cosserat_casadi.results.facts import digits, told_error
from cosserat_casadi.results.presentation import MOST_LINES, PRESENTATIONS, FramesUnavailableError, presentation_of
from cosserat_casadi.scene import scene_from_dict
from cosserat_casadi.sweeps.outcome_file import read_sweep
from cosserat_casadi.sweeps.sobol import Estimates, SobolIndices
from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria
from cosserat_casadi.tubes.tube_solve import solve_tubes
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.identification.made_up import WIRE, measured_shapes
from tests.motions import planar_swing, without_start
from tests.scenes import push, scene


@cache
def solution() -> Any:
    """A rod under a force."""
    bent = scene(push(), title="Bent <rod>")
    return solve(build(bent, discretise(bent, 3, 6)))


@cache
def tube_solution() -> Any:
    return solve_tubes(read_scene(ROOT / "examples" / "concentric_tubes.toml"))


@cache
def path() -> Any:
    return follow(solution().model, "push.force", [1.0, 0.5, -0.4])


@cache
def inverse_of_a_tip() -> Any:
    target = {"kind": "position", "rod": "rod", "position": solution().tip().position.tolist()}
    aimed = scene(push(force=[0.7, 0.4, -0.3]), inputs=["push.force"], targets=[target])
    return inverse(build(aimed, discretise(aimed, 3, 6)), estimate_error=False)


@cache
def identification() -> Any:
    model = build(scene_from_dict(WIRE).with_unknowns())
    shapes = measured_shapes(model, np.random.default_rng(16), cases=2, noise=2e-4)
    return identify(model, shapes.data)


@cache
def estimate() -> Estimate:
    """An estimate of two rows, of which one was found, written by hand."""
    model = solution().model
    consistency = Consistency(
        squares=3.0, freedom=3, deviations=0.1, row_deviations=np.array([0.1, np.nan]), bias={"tip": 0.5}
    )
    return Estimate(
        model=model,
        cases=("row 1", "row 2"),
        labels=("push.force.x", "push.force.y"),
        units=("N", "N"),
        outcomes=("found", "not_determined"),
        values=np.array([[0.9, 0.5], [np.nan, np.nan]]),
        covariance=np.array([[[0.01, 0.001], [0.001, 0.02]], np.full((2, 2), np.nan)]),
        cost=np.array([1.5, np.nan]),
        numbers=np.array([3, 3]),
        x=np.stack([solution().x, solution().x]),
        inputs=np.stack([solution().inputs, solution().inputs]),
        parameters=np.zeros((2, 0)),
        second=None,
        unseen={},
        consistency=consistency,
        checked=((0, 1e-8),),
    )


@cache
def sweep() -> Sweep:
    """Three rows, of which one has no equilibrium, written by hand."""
    poses = [f"rod.{axis}" for axis in ("x", "y", "z", "qw", "qx", "qy", "qz")]
    rows = [
        [0.0, 4.0, 1e-9, 1.0, 0.0, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0],
        [0.5, 5.0, 2e-9, 1.0, 0.3, 0.1, 0.7, 1.0, 0.0, 0.0, 0.0],
        [1.0, 60.0, *[np.nan] * 9],
    ]
    record = {"sweep": 1, "title": "Three rows", "tolerance": 1e-6}
    columns = ("iterations", "error_estimate", "within_tolerance", *poses)
    return Sweep(("push.force.x",), columns, np.array(rows), np.array([0, 0, 1]), record)


def sobol() -> SobolIndices:
    estimates = Estimates(
        mean=0.4,
        variance=0.01,
        first=np.array([0.7, 0.2]),
        total=np.array([0.8, 0.3]),
        first_interval=np.array([[0.6, 0.8], [0.1, 0.3]]),
        total_interval=np.array([[0.7, 0.9], [0.2, 0.4]]),
    )
    return SobolIndices(("push.force.x", "rod.length"), {"rod.x": estimates}, samples=64, left_out=1)


def tube_equilibria() -> TubeEquilibria:
    return TubeEquilibria(tube_solution().robot, (tube_solution(),), complete=True)


def tube_path() -> TubePath:
    end = tube_solution()
    return TubePath(
        model=end.model,
        name=next(iter(end.robot.columns)),
        base=end.inputs,
        change=0.1 * np.eye(end.inputs.size)[0],
        outcome=path().outcome,
        message=path().message,
        factor=np.array([0.0, 1.0]),
        x=np.array([end.x, end.x]),
        events=(),
        error_estimate=1e-8,
    )


MAKERS: dict[str, Callable[[], Any]] = {
    "Solution": solution,
    "EquilibriumPath": path,
    "Motion": cache(planar_swing),
    "Modes": cache(lambda: modes_of(solution(), count=2)),
    "Inverse": inverse_of_a_tip,
    "Identification": identification,
    "Estimate": estimate,
    "Sweep": sweep,
    "SobolIndices": sobol,
    "TubeSolution": tube_solution,
    "TubeEquilibria": tube_equilibria,
    "TubePath": tube_path,
}
"""A result of each public class."""

NO_RESULTS = {
    "Choice",
    "Collocation",
    "Compiled",
    "Condensed",
    "Condensing",
    "Discretisation",
    "Horizon",
    "Lifted",
    "LinearModel",
    "Model",
    "MotionStage",
    "Problem",
    "RelaxedContact",
    "Scene",
    "StageEquations",
    "TargetMiss",
    "Tightened",
}
"""Public classes that are inputs, models, compiled solvers, or parts of results."""


def public_classes() -> dict[str, type]:
    """Public classes by name, without errors and outcomes."""
    classes = {}
    for module in (cosserat_casadi, cosserat_casadi.control, cosserat_casadi.estimation):
        for name in module.__all__:
            value = getattr(module, name)
            if inspect.isclass(value) and not issubclass(value, Exception | Enum):
                classes[name] = value
    return classes


def test_every_public_class_is_a_result_or_known_to_be_none() -> None:
    results = {name for name, kind in public_classes().items() if issubclass(kind, Result)}
    assert set(public_classes()) - results == NO_RESULTS
    assert results == set(PRESENTATIONS) == set(MAKERS)


@pytest.mark.parametrize("name", MAKERS)
def test_a_result_is_plain_data(name: str) -> None:
    result = MAKERS[name]()
    data = result.to_dict()
    assert data["schema"] == 1
    assert json.loads(json.dumps(data, allow_nan=False)) == data


@pytest.mark.parametrize(
    "name",
    mostly_slow(MAKERS, quick=["Solution", "EquilibriumPath", "Modes", "Estimate", "SobolIndices", "TubeSolution"]),
)
def test_a_result_is_written_by_suffix(name: str, tmp_path: Path) -> None:
    result = MAKERS[name]()
    for suffix in presentation_of(result).suffixes:
        if suffix == ".json" or suffix not in (".pdf", ".svg"):
            file = tmp_path / f"result{suffix}"
            result.write(str(file))
            assert file.exists(), suffix
    assert json.loads((tmp_path / "result.json").read_text(encoding="utf-8")) == result.to_dict()
    with pytest.raises(SceneError, match=rf"{name} cannot be written to .*result\.docx \(use one of \.json"):
        result.write(tmp_path / "result.docx")


@pytest.mark.parametrize("name", MAKERS)
def test_a_result_says_what_matters_in_a_few_lines(name: str) -> None:
    result = MAKERS[name]()
    lines = repr(result).splitlines()
    assert lines[0].split(": ")[0] == name
    assert len(lines) <= MOST_LINES
    assert all(len(line) <= 120 for line in lines)
    assert "<" not in repr(result).replace("<rod>", "")
    # The error stands beside its tolerance; indices of a sweep have intervals instead.
    assert any("error" in line for line in lines) or name == "SobolIndices"


def test_scenes_and_models_say_what_they_are_in_a_few_lines() -> None:
    tip = {"name": "pin", "rod": "rod", "kind": "pinned", "position": [0.0, 0.0, 0.7]}
    held = scene(push(force=[0.3, 0, 0]), supports=[tip])
    given = scene(push(force=[0.3, 0, 0]))
    model = build(given)
    linear = linearise(solve(model))
    tubes = read_scene(ROOT / "examples" / "concentric_tubes.toml")
    shown = {
        "Scene": (held, "supports  pin"),
        "Model": (model, f"unknowns  {model.size}"),
        "Choice": (choose(given, samples=1), "within the tolerance of 1e-06"),
        "LinearModel": (linear, f"states   {len(linear.A)}, of {linear.modes} modes"),
        "TubeModel": (build(tubes, 4), "tubes   outer, inner"),
    }
    # The error stands first, where no rods push it out of the lines.
    assert repr(shown["Choice"][0]).splitlines()[1].startswith("  largest error")
    for name, (one, words) in shown.items():
        lines = repr(one).splitlines()
        assert lines[0].split(": ")[0] == name
        assert len(lines) <= MOST_LINES
        assert all(len(line) <= 120 for line in lines)
        assert words in str(one)
        page = one._repr_html_()
        assert page.startswith(f"<table><caption>{lines[0]}")
        assert "<img" not in page


@pytest.mark.parametrize("name", mostly_slow(MAKERS, quick=["Solution", "TubePath"]))
def test_a_notebook_shows_table_and_figure(name: str) -> None:
    result = MAKERS[name]()
    assert isinstance(result.plot(), Figure)
    page = result._repr_html_()
    assert page.startswith("<table><caption>")
    assert page.count("<tr>") >= 2
    assert '<img alt="figure" src="data:image/png;base64,' in page


@pytest.mark.parametrize("name", [name for name in MAKERS if ".csv" in PRESENTATIONS[name].suffixes])
def test_a_table_is_a_data_frame_with_its_digits(name: str, tmp_path: Path) -> None:
    result = MAKERS[name]()
    frame = result.to_dataframe()
    result.write(tmp_path / "table.csv")
    head, first, *rest = csv.reader((tmp_path / "table.csv").read_text(encoding="utf-8").splitlines())
    assert list(frame.columns) == head
    assert len(frame) == 1 + len(rest)
    numbers = {key: float(cell) for key, cell in zip(head, first, strict=True) if cell.lstrip("-")[:1].isdigit()}
    assert numbers
    assert {key: float(frame[key].iloc[0]) for key in numbers} == numbers


def test_what_is_no_table_is_no_data_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SceneError, match="Solution has no table"):
        solution().to_dataframe()
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(FramesUnavailableError, match=r"pip install 'cosserat-casadi\[frames\]'"):
        MAKERS["EquilibriumPath"]().to_dataframe()


@pytest.fixture
def named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The three arguments that xarray receives, in its place where it is not installed."""
    monkeypatch.setitem(sys.modules, "xarray", SimpleNamespace(Dataset=lambda *arguments: arguments))


@pytest.mark.usefixtures("named")
def test_a_motion_is_arrays_over_time() -> None:
    motion = MAKERS["Motion"]()
    variables, coordinates, attributes = motion.to_xarray()
    axes, positions, about = variables["rod.position"]
    assert (axes, about) == (("time", "rod.X", "axis"), {"units": "m"})
    assert_allclose(positions, motion.section("rod", coordinates["rod.X"]).position, rtol=0, atol=0)
    assert_allclose(variables["rod.tip.position"][1], positions[:, -1], rtol=0, atol=1e-14)
    assert (variables["push.force"][0], variables["push.force"][2]) == (("time", "axis"), {"units": "N"})
    assert variables["energy.kinetic"][0] == ("time",)
    assert attributes["outcome"] == "completed"
    sizes = {"time": len(motion.times), "axis": 3, "quaternion": 4, "rod.X": len(coordinates["rod.X"])}
    for axes, values, _ in variables.values():
        assert values.shape == tuple(sizes[axis] for axis in axes)


@pytest.mark.usefixtures("named")
def test_a_grid_has_an_axis_each_and_other_rows_one() -> None:
    pairs = np.array([[1.0, 5.0, 6.0], [0.0, 5.0, 5.0], [0.0, 7.0, 7.0], [1.0, 7.0, 8.0]])
    grid = Sweep(("a", "b"), ("sum",), pairs, np.array([0, 0, 1, 0]), {})
    variables, coordinates, _ = grid.to_xarray()
    assert {name: values.tolist() for name, values in coordinates.items()} == {"a": [0.0, 1.0], "b": [5.0, 7.0]}
    axes, values, _ = variables["sum"]
    assert (axes, values.tolist()) == (("a", "b"), [[5.0, 7.0], [6.0, 8.0]])
    assert variables["outcome"][1][0, 1] == grid.outcome[2]
    # Three corners of four, or one of them twice, are no grid.
    for rows in ([0, 1, 2], [0, 1, 2, 2]):
        variables, coordinates, _ = replace(grid, values=pairs[rows], outcomes=grid.outcomes[rows]).to_xarray()
        assert not coordinates
        assert variables["a"][0] == ("row",)
        assert variables["sum"][1].tolist() == pairs[rows, 2].tolist()


def test_without_xarray_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SceneError, match="Solution has no arrays over time"):
        solution().to_xarray()
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(FramesUnavailableError, match=r"to_xarray needs xarray: .*\[frames\]"):
        sweep().to_xarray()


@pytest.mark.parametrize("name", mostly_slow(["EquilibriumPath", "TubePath", "Motion"], quick=["TubePath"]))
def test_a_film_is_written_and_named(name: str, tmp_path: Path) -> None:
    result = MAKERS[name]()
    assert result.animate(str(tmp_path / "film.gif")) == tmp_path / "film.gif"
    with Image.open(tmp_path / "film.gif") as film:
        pictures = film.n_frames
    # A frame of a path is a point of it; those of a motion follow the clock.
    assert pictures == (1 + 25 * result.times[-1] // 1 if name == "Motion" else len(result.factor))
    with pytest.raises(SceneError, match=r"film\.doc has no suffix of an animation .*use one of \.gif"):
        result.animate(tmp_path / "film.doc")


def test_a_film_of_meshes_is_that_of_write(tmp_path: Path) -> None:
    motion = MAKERS["Motion"]()
    motion.write(tmp_path / "a.glb")
    motion.animate(tmp_path / "b.glb")
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


def test_what_has_no_film_says_so(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="Solution has no film"):
        solution().animate(tmp_path / "film.gif")
    with pytest.raises(SceneError, match="the path has no point"):
        replace(tube_path(), factor=np.zeros(0), x=np.zeros((0, 2))).animate(tmp_path / "film.gif")
    with pytest.raises(SceneError, match="the motion has no state"):
        without_start().animate(tmp_path / "film.gif")
    with pytest.raises(SceneError, match="from 1 to 2"):
        MAKERS["Modes"]().animate(tmp_path / "film.gif", mode=3)
    assert not list(tmp_path.iterdir())


def test_words_are_no_markup() -> None:
    assert "Bent &lt;rod&gt;" in solution()._repr_html_()
    assert repr(solution()).startswith("Solution: Bent <rod>\n")


def test_without_matplotlib_a_notebook_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    imported = builtins.__import__

    def no_matplotlib(name: str, *arguments: Any, **named: Any) -> Any:
        if name.startswith(("matplotlib", "cosserat_casadi.plots.shown_figure")):
            raise ImportError(name)
        return imported(name, *arguments, **named)

    monkeypatch.setattr(builtins, "__import__", no_matplotlib)
    page = solution()._repr_html_()
    assert "pip install" in page
    assert "cosserat-casadi[plot]" in page
    with pytest.raises(cosserat_casadi.CosseratError, match=r"cosserat-casadi\[plot\]"):
        solution().plot()


def test_a_long_result_is_cut() -> None:
    rods = [{"name": f"rod{k}", "length": 0.8, "strain": "planar", "stiffness": {"bending_y": 1.0}} for k in range(6)]
    many = scene_from_dict({"schema": 1, "rods": rods})
    lines = repr(solve(build(many, discretise(many, 1, 2)))).splitlines()
    assert lines[5].split() == ["tips", "6", "in", "all"]


def test_a_failure_says_why() -> None:
    failed = replace(solution(), outcome=Outcome.LOAD_STALLED, message="The load stalled.")
    assert "load stalled: The load stalled." in repr(failed)
    assert "no start: " in repr(without_start())


def test_a_sweep_that_was_written_is_read(tmp_path: Path) -> None:
    sweep().write(tmp_path / "rows.csv")
    again = read_sweep(tmp_path / "rows.csv")
    assert repr(again) == repr(sweep())


def test_a_class_without_presentation_is_told() -> None:
    class Lost(Result):
        pass

    with pytest.raises(TypeError, match="Lost has no entry in PRESENTATIONS"):
        Lost().to_dict()


def test_what_a_cancellation_leaves_of_a_position_is_zero() -> None:
    assert digits(np.array([0.25, -4.7e-31, -1.0])) == ["0.25", "0", "-1"]
    # All that there is may be rounding.
    assert digits(np.array([6e-144, -3e-13, 2e-12]), 1.0) == ["0", "0", "2e-12"]
    straight = solve(build(scene(push(force=[0.0, 0.0, 1.0]), strain="planar")))
    assert "(0, 0, 0.8) m" in repr(replace(straight, x=straight.x + 1e-30))


def test_an_error_that_is_not_known_is_perhaps_above_the_tolerance() -> None:
    assert told_error(UNKNOWN, False, 1e-3) == "not known, perhaps above the tolerance of 0.001"
    assert told_error(2e-3, False, 1e-3) == "2.0e-03 of the length, above the tolerance of 0.001"
    assert told_error(5e-4, True, 1e-3) == "5.0e-04 of the length, within the tolerance of 0.001"
    assert told_error(None, None, 1e-3) == "not estimated"
