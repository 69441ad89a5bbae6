"""``cosserat estimate``: files, exit codes, refusals."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from cosserat_casadi.cli.exit_codes import REFUSED
from cosserat_casadi.cli.main import app, run
from tests.conftest import ROOT

FIXED = ["accuracy.modes=2", "accuracy.nodes=4", "accuracy.tolerance=1e-1", 'wire.strain="planar"']
"""A small model, that does not see what is felt across its plane."""

SETTINGS = [word for setting in FIXED for word in ("--set", setting)]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The example with its table, of which six cases are left."""
    shutil.copy(ROOT / "examples" / "felt_loads.toml", tmp_path)
    (tmp_path / "data").mkdir()
    lines = (ROOT / "examples" / "data" / "felt_shapes.csv").read_text().splitlines()
    (tmp_path / "data" / "felt_shapes.csv").write_text("\n".join(lines[:25]) + "\n")
    return tmp_path


def estimate(folder: Path, *options: str) -> int:
    scene = str(folder / "felt_loads.toml")
    return run(lambda **keywords: app(["estimate", scene, *SETTINGS, *options], **keywords))


@pytest.mark.slow
def test_what_is_felt_is_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    felt, figure = folder / "felt.json", folder / "felt.png"
    assert estimate(folder, "--output", str(felt), "--plot", str(figure)) == 0
    data = json.loads(felt.read_text())
    assert data["outcomes"] == {"found": 6}
    assert data["unknowns"][3:5] == ["pressed.force.x", "pressed.force.x.1"]
    assert data["units"] == ["N"] * 3 + ["N/m"] * 4
    assert np.array(data["rows"][0]["covariance"]).shape == (7, 7)
    assert len(data["checked"]) == 3
    assert data["within_tolerance"] is True
    assert figure.stat().st_size > 0
    out = capsys.readouterr().out
    assert "found: 6 rows" in out
    assert "3 rows solved again on finer modes: estimated error at most" in out
    assert "within the tolerance of 0.1." in out
    table = folder / "felt.csv"
    assert estimate(folder, "--output", str(table)) == 0
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [float(row["touch.force.y"]) for row in rows] == [row["value"][1] for row in data["rows"]]
    assert [float(row["touch.force.y.sigma"]) for row in rows] == [row["sigma"][1] for row in data["rows"]]


def test_refusals_write_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert estimate(folder, "--output", str(folder / "felt.txt")) == REFUSED
    assert "neither JSON nor CSV" in capsys.readouterr().err
    scene = folder / "felt_loads.toml"
    scene.write_text(scene.read_text().replace('input = "touch.force"', 'parameter = "touch.at"'))
    assert estimate(folder, "--output", str(folder / "felt.json")) == REFUSED
    assert "but its lower or upper is missing" in capsys.readouterr().err
    assert not list(folder.glob("felt.*"))
