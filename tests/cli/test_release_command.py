"""``cosserat simulate --from``: a rod that is let go, from the result of one command to the motion of the next."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.cli.exit_codes import REFUSED
from cosserat_casadi.cli.main import app, run

SCENE = """
schema = 1
title = "A beam that is let go"
inputs = ["hand.force"]
[accuracy]
tolerance = 1e-3
[[rods]]
name = "beam"
length = 1.0
strain = "planar"
stiffness = { bending_y = 2.0 }
linear_density = 0.5
[[loads]]
name = "hand"
kind = "tip_wrench"
rod = "beam"
force = [0, 0, 0]
[simulation]
duration = 0.2
frames = 3
"""


def command(*arguments: str) -> int:
    return run(lambda **options: app(list(arguments), **options))


def test_a_rod_is_let_go_from_the_result_of_solve(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("beam.toml").write_text(SCENE)
    assert command("solve", "beam.toml", "--set", "hand.force=[0.5,0,0]", "--output", "held.json") == 0
    assert command("simulate", "beam.toml", "--from", "held.json", "--output", "motion.json") == 0
    held = json.loads(Path("held.json").read_text())
    motion = json.loads(Path("motion.json").read_text())
    tip = motion["rods"]["beam"]["tip"]["position"]
    assert_allclose(tip[0], held["rods"]["beam"]["tip"]["position"], rtol=0, atol=1e-4)
    # A quarter of the longest period is 0.22 s.
    assert tip[0][0] > tip[1][0] > tip[2][0]
    assert motion["inputs"]["hand.force"][0] == [0.0, 0.0, 0.0]
    assert motion["start"] == "At rest in the given equilibrium."


def test_a_load_that_is_no_input_cannot_be_let_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("beam.toml").write_text(SCENE.replace('"hand.force"', '"hand.moment"'))
    assert command("solve", "beam.toml", "--set", "hand.force=[0.5,0,0]", "--output", "held.json") == 0
    assert command("simulate", "beam.toml", "--from", "held.json") == REFUSED
    assert "holds an equilibrium that this scene does not have" in " ".join(capsys.readouterr().err.split())
