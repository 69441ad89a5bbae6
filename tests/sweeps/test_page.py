"""The page on sweeps and the examples of tables work when pasted."""

from __future__ import annotations

import csv
import io
import re
import shlex
from pathlib import Path

import pytest

from cosserat_casadi import read_scene
from cosserat_casadi.sweeps.outcome_table import LABELS
from cosserat_casadi.sweeps.table import Table, read_table
from cosserat_casadi.sweeps.variants import variants_of
from tests.commands import cosserat
from tests.conftest import ROOT
from tests.pages import run_python

PAGE = (ROOT / "docs" / "sweeps.md").read_text()
WIRE = ROOT / "examples" / "nitinol_wire.toml"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


def table_of_block(language: str, suffix: str, folder: Path) -> Table:
    text = blocks(language)[0]
    file = folder / f"table{suffix}"
    file.write_text(text)
    return read_table(file)


def test_grid_of_the_page(tmp_path: Path) -> None:
    table = table_of_block("toml", ".toml", tmp_path)
    assert len(table.values) == 200 * 21 * 3
    assert variants_of(read_scene(WIRE), table).parameters == ()


def test_grid_for_sobol_indices_of_the_page(tmp_path: Path) -> None:
    grid = tmp_path / "tolerances.toml"
    grid.write_text(blocks("toml")[1])
    table = read_table(grid, sobol=True)
    assert len(table.values) == 2000 * 5
    assert variants_of(read_scene(WIRE), table).arguments == ("wire.section.radius", "wire.material.youngs_modulus")


def test_csv_of_the_page(tmp_path: Path) -> None:
    table = table_of_block("csv", ".csv", tmp_path)
    assert table.values.tolist() == [[0.1, 0.0, 0.2], [0.2, -0.1, 0.2]]
    assert variants_of(read_scene(WIRE), table).parameters == ()


def test_every_outcome_is_named() -> None:
    for label in LABELS:
        assert f"`{label}`" in PAGE


def test_python_of_the_page_runs() -> None:
    (code,) = blocks("python")
    printed = run_python(code)
    assert "{'converged': 9} True" in printed


@pytest.mark.slow
def test_command_of_the_page_runs_at_a_small_size(tmp_path: Path) -> None:
    first = blocks("sh")[0].replace("\\\n", " ")
    grid = (ROOT / "examples" / "sweeps" / "robot_workspace.toml").read_text()
    (tmp_path / "small.toml").write_text(grid.replace("samples = 20000", "samples = 30"))
    line = first.replace("examples/sweeps/robot_workspace.toml", "small.toml").replace("examples/", f"{ROOT}/examples/")
    words = [*shlex.split(line)[1:], "--set", "accuracy.modes=3", "--set", "accuracy.nodes=6"]
    words = [word.replace("accuracy.tolerance=1e-4", "accuracy.tolerance=0.1") for word in words]
    done = cosserat(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr + done.stdout
    assert (tmp_path / "workspace.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "workspace.parquet").exists()


@pytest.mark.slow
def test_wires_drawn_from_tolerances_are_solved(tmp_path: Path) -> None:
    """A stiffer wire bends less: the tips of 16 drawn wires lie in the order of their bending stiffness."""
    grid = ROOT / "examples" / "sweeps" / "wire_tolerances.toml"
    words = ["sweep", str(WIRE), "--over", str(grid), "--output", "wires.csv", "--set", "weight.acceleration=[0,0,0]"]
    words += ["--set", "push.force=[0,0,0]", "--set", "accuracy.modes=4", "--set", "accuracy.nodes=8"]
    words += ["--set", "accuracy.tolerance=1e-3"]
    done = cosserat(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr + done.stdout
    assert "Warning" not in done.stderr
    rows = list(csv.DictReader(io.StringIO((tmp_path / "wires.csv").read_text())))
    assert len(rows) == 16 * 5
    hardest = [row for row in rows if float(row["push.force.y"]) == pytest.approx(0.3)]
    names = ("wire.material.youngs_modulus", "wire.section.radius", "wire.y")
    stiffness = [(float(row[names[0]]) * float(row[names[1]]) ** 4, float(row[names[2]])) for row in hardest]
    tips = [tip for _, tip in sorted(stiffness)]
    assert tips == sorted(tips, reverse=True)
