"""Suffixes of files that are written: one that promises another format is refused before anything is computed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cosserat_casadi.cli.exit_codes import REFUSED
from tests.commands import WIRE, cosserat
from tests.families import mostly_slow

SCENE = (
    """
schema = 1
inputs = ["push.force"]
accuracy = { modes = 2, nodes = 6 }
"""
    + WIRE
    + """[[targets]]
kind = "position"
rod = "wire"
position = [0.1, 0, 0.15]
[[bounds]]
input = "push.force"
lower = [0, 0, 0]
upper = [1, 0, 0]
"""
)

TARGETS = "x,y,z\n0.1,0,0.15\n"

GRID = "push.force.x = { from = 0.0, to = 0.2, count = 2 }\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "wire.toml").write_text(SCENE, encoding="utf-8")
    (tmp_path / "targets.csv").write_text(TARGETS, encoding="utf-8")
    (tmp_path / "grid.toml").write_text(GRID, encoding="utf-8")
    return tmp_path


PATH = ["path", "wire.toml", "--input", "push.force", "--to", "[0.2,0,0]"]
SWEEP = ["sweep", "wire.toml", "--over", "grid.toml", "--output", "rows.csv"]
TUNE = ["tune", "wire.toml", "--range", "push.force.x=0:0.2"]


@pytest.mark.parametrize(
    ("command", "option", "file", "written", "wanted"),
    [
        (["solve", "wire.toml"], "--output", "x.npz", "JSON", "x.json"),
        (["solve", "wire.toml", "--all"], "--output", "x.csv", "JSON", "x.json"),
        (["modes", "wire.toml"], "--output", "x.csv", "JSON", "x.json"),
        (["inverse", "wire.toml"], "--output", "x.parquet", "JSON", "x.json"),
        (["inverse", "wire.toml", "--table", "targets.csv"], "--output", "x.json", "CSV", "x.csv"),
        (["identify", "wire.toml"], "--output", "x.npz", "JSON", "x.json"),
        (["identify", "wire.toml"], "--write", "x.json", "TOML", "x.toml"),
        (PATH, "--output", "x.csv", "JSON", "x.json"),
        (PATH, "--csv", "x.json", "CSV", "x.csv"),
        (SWEEP, "--sobol", "x.csv", "JSON", "x.json"),
        (TUNE, "--output", "x.json", "TOML", "x.toml"),
    ],
)
def test_another_format_is_refused(
    folder: Path, command: list[str], option: str, file: str, written: str, wanted: str
) -> None:
    before = sorted(folder.iterdir())
    ended = cosserat(*command, option, file, cwd=folder)
    said = " ".join(ended.stderr.split())
    assert ended.returncode == REFUSED, said
    assert option in said
    assert f"writes {written} only, and {file} has the suffix {Path(file).suffix}" in said
    assert f"name it {wanted}" in said
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("command", mostly_slow([["solve"], ["modes", "--count", "1"]], quick=[["solve"]]))
@pytest.mark.parametrize("file", ["result", "result.json", "RESULT.JSON"])
def test_json_and_no_suffix_are_written(folder: Path, command: list[str], file: str) -> None:
    cosserat(*command, "wire.toml", "--output", file, cwd=folder)
    assert json.loads((folder / file).read_text(encoding="utf-8"))["schema"] == 1


def test_all_faults_of_files_come_at_once(folder: Path) -> None:
    ended = cosserat("solve", "wire.toml", "--output", "x.npz", "--plot", "x.doc", cwd=folder)
    assert ended.returncode == REFUSED
    assert "--output" in ended.stderr
    assert "--plot" in ended.stderr
