"""Magnets, foundations, flows and tendons with friction together: reference cases, and every command on one scene."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, follow, load, read_scene, solve
from cosserat_casadi.cli.exit_codes import NOT_FOUND, REFUSED
from cosserat_casadi.model.operation_cost import prices_of_effects
from tests.commands import cosserat
from tests.conftest import CASES

EFFECTS = CASES / "effects"
LENGTHS = {"foundation": 0.8, "flow_bending": 0.4, "tendon_friction": 0.3, "magnet_uniform": 0.5}

SCENE = """
schema = 1
title = "A finger in water and tissue, with a magnet and a tendon that rubs"
inputs = [
    "magnet.dipole.position",
    "magnet.dipole.moment",
    "tissue.stiffness",
    "water.velocity",
    "cable.tension",
    "cable.pull",
]
accuracy = { modes = 3, nodes = 8, tolerance = 1e-3 }
[[rods]]
name = "finger"
length = 0.2
strain = "kirchhoff"
material = { youngs_modulus = 2e6, poisson_ratio = 0.45, density = 1200.0 }
section = { shape = "circle", radius = 4e-3 }
[[loads]]
name = "magnet"
kind = "magnet"
rod = "finger"
moment = [0, 0, 0.05]
dipole = { position = [0.1, 0.02, 0.25], moment = [0, 10.0, 40.0] }
[[loads]]
name = "tissue"
kind = "foundation"
rod = "finger"
stiffness = [20.0, 10.0, 0.0]
span = [0.4, 1.0]
[[loads]]
name = "water"
kind = "flow"
density = 1000.0
velocity = [0.1, 0.2, 0.0]
[[actuators]]
name = "cable"
kind = "tendon"
rod = "finger"
tension = 1.0
friction = 0.3
offset = [2e-3, 0.0]
"""


@pytest.mark.parametrize("name", LENGTHS)
def test_reference_cases(name: str) -> None:
    if not EFFECTS.is_dir():
        pytest.skip("the reference cases are not at hand")
    expected = json.loads((EFFECTS / f"{name}.json").read_text())["expected"]
    found = solve(read_scene(EFFECTS / f"{name}.toml"))
    assert found.converged
    assert_allclose(found.tip().position, expected["tip"]["position"], rtol=0, atol=1e-7 * LENGTHS[name])
    if "rotation" in expected["tip"]:
        assert_allclose(found.tip().rotation, expected["tip"]["rotation"], rtol=0, atol=2e-7)
    if "base_wrench" in expected:
        assert_allclose(found.base_wrench().force, expected["base_wrench"]["force"], rtol=0, atol=1e-6)
        assert_allclose(found.base_wrench().moment, expected["base_wrench"]["moment"], rtol=0, atol=1e-6)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "finger.toml").write_text(SCENE)
    return tmp_path


def test_check_names_them_and_their_prices(folder: Path) -> None:
    checked = cosserat("check", "finger.toml", cwd=folder)
    assert checked.returncode == 0
    price = prices_of_effects(read_scene(folder / "finger.toml"))
    for name, kind in (("magnet", "magnet"), ("tissue", "foundation"), ("water", "flow"), ("cable", "tendon")):
        lines = [line for line in checked.stdout.splitlines() if name in line and kind in line]
        assert any(str(price[name]) in line for line in lines), lines


@pytest.mark.slow
def test_solve_writes_and_draws_them(folder: Path) -> None:
    assert cosserat("solve", "finger.toml", "--output", "found.json", "--plot", "found.png", cwd=folder).returncode == 0
    result = json.loads((folder / "found.json").read_text())
    assert result["converged"]
    # A stream and a tendon that rubs have no potential.
    assert result["stable"] is None
    assert (folder / "found.png").stat().st_size > 10_000


def test_path_strengthens_the_source(folder: Path) -> None:
    words = ["--input", "magnet.dipole.moment", "--to", "[0,20.0,60.0]", "--output", "path.json"]
    assert cosserat("path", "finger.toml", *words, cwd=folder).returncode == 0
    assert json.loads((folder / "path.json").read_text())["outcome"] == "converged"


@pytest.mark.slow
def test_a_cycle_of_pulls_as_paths(folder: Path) -> None:
    """In to 2 N and let out at 2 N: the four paths of a cycle meet, and the way back is another one."""
    model = build(read_scene(folder / "finger.toml"))
    pulled = follow(model, "cable.tension", 2.0, values={"cable.pull": 1.0})
    let_out = follow(model, "cable.tension", 2.0, values={"cable.pull": -1.0})
    # The direction goes from 1 to −1 by way of no friction.
    to_middle = follow(model, "cable.pull", 1.0, values={"cable.tension": 2.0})
    from_middle = follow(model, "cable.pull", -1.0, values={"cable.tension": 2.0})
    ends = [pulled, let_out, to_middle, from_middle]
    assert all(path.converged for path in ends), [path.message for path in ends]
    assert_allclose(to_middle.tip().position[-1], pulled.tip().position[-1], rtol=0, atol=1e-9)
    assert_allclose(from_middle.tip().position[-1], let_out.tip().position[-1], rtol=0, atol=1e-9)
    assert_allclose(to_middle.tip().position[0], from_middle.tip().position[0], rtol=0, atol=1e-9)
    assert np.linalg.norm(pulled.tip().position[-1] - let_out.tip().position[-1]) > 1e-4


@pytest.mark.slow
def test_inverse_finds_where_the_source_was(folder: Path) -> None:
    moved = solve(read_scene(folder / "finger.toml"), {"magnet.dipole.position": [0.11, 0.03, 0.24]})
    # What is looked for alone is free.
    listed = SCENE[SCENE.index("inputs") : SCENE.index("accuracy")]
    alone = SCENE.replace(listed, 'inputs = ["magnet.dipole.position"]\n')
    wanted = moved.tip().position.tolist()
    target = f'[[targets]]\nkind = "position"\nrod = "finger"\nposition = {wanted}\n'
    bound = '[[bounds]]\ninput = "magnet.dipole.position"\nlower = [0.08, 0.0, 0.22]\nupper = [0.2, 0.2, 0.4]\n'
    (folder / "wanted.toml").write_text(alone + target + bound)
    assert cosserat("inverse", "wanted.toml", "--output", "found.json", cwd=folder).returncode == 0
    tip = json.loads((folder / "found.json").read_text())["rods"]["finger"]["tip"]["position"]
    assert_allclose(tip, wanted, rtol=0, atol=1e-6)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no C compiler")
def test_export_load_and_sweep(folder: Path) -> None:
    # Three modes do not keep the tolerance wherever the inputs may go: the export says so, and is there.
    assert cosserat("export", "finger.toml", "--output", "finger", cwd=folder).returncode == NOT_FOUND
    library = load(folder / "finger")
    solution = solve(build(read_scene(folder / "finger.toml")))
    found = library.solve()
    assert found.converged
    position = library.tip["finger"](found.x, library.defaults)[0].full()[:, 0]
    assert_allclose(position, solution.tip().position, rtol=0, atol=1e-9)
    (folder / "grid.toml").write_text("water.velocity.x = [0.0, 0.2]\ncable.pull = [-1.0, 0.0, 1.0]\n")
    assert cosserat("sweep", "finger.toml", "--over", "grid.toml", "--output", "rows.csv", cwd=folder).returncode == 0
    rows = list(csv.DictReader((folder / "rows.csv").read_text().splitlines()))
    assert len(rows) == 6
    assert {row["outcome"] for row in rows} == {"converged"}


def test_faults_of_all_come_at_once(folder: Path) -> None:
    bad = SCENE.replace("density = 1000.0", "density = -1000.0").replace("friction = 0.3", "friction = -0.3")
    bad = bad.replace("stiffness = [20.0, 10.0, 0.0]", "stiffness = [0, 0, 0]").replace("[0, 10.0, 40.0]", "[0, 0, 0]")
    (folder / "bad.toml").write_text(bad)
    ended = cosserat("check", "bad.toml", cwd=folder)
    assert ended.returncode == REFUSED
    for where in ("loads[0].dipole.moment", "loads[1].stiffness", "loads[2].density", "actuators[0].friction"):
        assert where in ended.stderr
