"""``cosserat identify``: files, exit codes, refusals."""

from __future__ import annotations

import itertools
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cosserat_casadi import Identification, Problem, SceneError, read_scene
from cosserat_casadi.cli.exit_codes import NOT_FOUND, REFUSED
from cosserat_casadi.cli.main import app, run
from cosserat_casadi.identification.misfit import Misfit
from cosserat_casadi.numerics import arrow_least_squares
from cosserat_casadi.numerics.arrow_least_squares import FitOutcome
from tests.conftest import ROOT

FIXED = ["--set", "accuracy.modes=3", "--set", "accuracy.nodes=6"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The example with its table."""
    shutil.copy(ROOT / "examples" / "wire_from_shapes.toml", tmp_path)
    shutil.copytree(ROOT / "examples" / "data", tmp_path / "data")
    return tmp_path


def identify(folder: Path, *options: str) -> int:
    scene = str(folder / "wire_from_shapes.toml")
    return run(lambda **keywords: app(["identify", scene, *FIXED, *options], **keywords))


def written(file: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(file.read_text())
    return data


def test_what_is_found_is_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found, fitted = folder / "found.json", folder / "fitted.toml"
    options = ("--output", str(found), "--write", str(fitted))
    assert identify(folder, *options) == 0
    data = written(found)
    assert data["converged"]
    assert data["cases"] == 9
    modulus = data["unknowns"]["wire.material.youngs_modulus"]
    assert modulus["interval_95"][0] < 52e9 < modulus["interval_95"][1]
    assert len(data["unknowns"]["wire.intrinsic.curvature.x"]["value"]) == 2
    assert len(data["correlation"]) == len(data["correlation_of"]) == 4
    assert data["unseen"] == []
    assert 0.8 < data["residual"]["held_out_rms"] < 1.2
    scene = read_scene(fitted)
    assert scene.rods[0].material is not None
    assert scene.rods[0].material.youngs_modulus == modulus["value"]
    # The table is found from where the scene is written.
    assert Path(scene.measurements[0].file).resolve() == (folder / "data" / "wire_shapes.csv").resolve()
    assert "Found: 4 unknowns" in capsys.readouterr().out


@pytest.mark.slow
def test_what_is_found_is_drawn(folder: Path) -> None:
    figure = folder / "found.png"
    assert identify(folder, "--plot", str(figure)) == 0
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_what_the_data_leave_open_is_no_success(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = folder / "wire_from_shapes.toml"
    text = scene.read_text().replace(
        "[identification]", '[[unknowns]]\nparameter = "wire.section.radius"\n\n[identification]'
    )
    scene.write_text(text)
    found, fitted = folder / "found.json", folder / "fitted.toml"
    assert identify(folder, "--output", str(found), "--write", str(fitted)) == NOT_FOUND
    data = written(found)
    assert not data["converged"]
    assert data["outcome"] == "not_determined"
    assert data["unknowns"]["wire.section.radius"]["sigma"] is None
    assert len(data["unseen"]) == 1
    assert not fitted.exists()
    assert "do not determine" in capsys.readouterr().out


def few_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let searches end after two steps."""
    monkeypatch.setattr(arrow_least_squares, "MOST_ITERATIONS", 2)


def no_way_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no case be followed any further after two steps."""
    states_at = Misfit.at
    calls = itertools.count()
    monkeypatch.setattr(Misfit, "at", lambda self, *given: states_at(self, *given) if next(calls) < 2 else None)


@pytest.mark.parametrize(
    ("hinder", "outcome", "reason"),
    [
        pytest.param(few_iterations, "max_iterations", FitOutcome.MAX_ITERATIONS.value, marks=pytest.mark.slow),
        (no_way_on, "stalled", FitOutcome.STALLED.value),
    ],
)
def test_a_search_that_ended_early_is_written_and_marked(
    hinder: Callable[[pytest.MonkeyPatch], None],
    outcome: str,
    reason: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Young's modulus meets its bound on the way, which is named beside."""
    scene = folder / "wire_from_shapes.toml"
    scene.write_text(scene.read_text().replace("lower = 5e9", "lower = 59e9"))
    hinder(monkeypatch)
    found, fitted = folder / "found.json", folder / "fitted.toml"
    assert identify(folder, "--output", str(found), "--write", str(fitted)) == NOT_FOUND
    data = written(found)
    assert data["outcome"] == outcome
    assert data["at_bounds"] == ["wire.material.youngs_modulus"]
    first_line = fitted.read_text().partition("\n")[0]
    assert first_line.startswith(f"# Not found: {reason}")
    assert first_line.endswith("The numbers are those at which the search ended.")
    material = read_scene(fitted).rods[0].material
    assert material is not None
    assert material.youngs_modulus == data["unknowns"]["wire.material.youngs_modulus"]["value"] == 59e9
    # The path may be broken over lines.
    assert "fitted.toml" in capsys.readouterr().out.replace("\n", "")


@pytest.mark.parametrize("starts", ["0", "10001"])
def test_all_that_is_wrong_is_told_at_once(folder: Path, capsys: pytest.CaptureFixture[str], starts: str) -> None:
    options = ("--hold-out", "1.5", "--starts", starts, "--output", str(folder / "none" / "found.json"))
    assert identify(folder, *options) == REFUSED
    told = capsys.readouterr().err
    for where in ("--hold-out", "--starts", "--output"):
        assert where in told


def test_a_scene_without_measurements_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    scene = str(ROOT / "examples" / "nitinol_wire.toml")
    assert run(lambda **keywords: app(["identify", scene], **keywords)) == REFUSED
    assert "unknowns: missing" in capsys.readouterr().err


def test_what_was_found_and_is_no_scene_is_told(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refused(self: Identification, scene: object = None, *, early: bool = False) -> None:
        raise SceneError(Problem("rods[0].section.radius", "must be < 1, got 2", "look at the unit"))

    monkeypatch.setattr(Identification, "fitted_scene", refused)
    found, fitted = folder / "found.json", folder / "fitted.toml"
    assert identify(folder, "--output", str(found), "--write", str(fitted)) == NOT_FOUND
    assert written(found)["converged"]
    assert not fitted.exists()
    told = capsys.readouterr().err
    assert "No scene was written: rods[0].section.radius: must be < 1, got 2 (look at the unit)" in told
