"""``cosserat modes`` as a user meets it: exit codes, files and words."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import modes_of, read_scene
from cosserat_casadi.plots import modes_plot
from tests.commands import Ended, cosserat

SCENE = """
schema = 1
title = "A blade"
[[rods]]
name = "blade"
length = 1.0
strain = "planar"
stiffness = { bending_y = 1.0 }
linear_density = 1.0
[[loads]]
name = "thrust"
kind = "tip_wrench"
rod = "blade"
force = [0, 0, 0]
frame = "body"
"""


def run_modes(*arguments: str, cwd: Path) -> Ended:
    return cosserat("modes", *arguments, cwd=cwd)


@pytest.fixture
def blade(tmp_path: Path) -> Path:
    (tmp_path / "blade.toml").write_text(SCENE)
    return tmp_path


def test_modes_are_printed_written_and_drawn(blade: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modes_plot, "PERIOD_FRAMES", 4)
    files = ("--output", "m.json", "--plot", "m.png", "--animation", "m.gif")
    done = run_modes("blade.toml", "--count", "3", "--mode", "2", *files, cwd=blade)
    assert done.returncode == 0, done.stderr
    assert "every frequency is known" in done.stdout
    assert "3.5160153" in done.stdout
    assert (blade / "m.png").read_bytes().startswith(b"\x89PNG")
    assert (blade / "m.gif").read_bytes().startswith(b"GIF")
    written = json.loads((blade / "m.json").read_text())
    modes = modes_of(read_scene(blade / "blade.toml"), count=3)
    assert written["converged"] is True
    assert written["outcome"] == "resolved"
    assert written["equilibrium"]["converged"] is True
    assert len(written["modes"]) == 3
    for entry, mode in zip(written["modes"], modes.modes, strict=True):
        assert_allclose(entry["eigenvalue"], [0.0, mode.eigenvalue.imag], rtol=1e-12, atol=0)
        assert_allclose(entry["angular_frequency"], mode.angular_frequency, rtol=1e-12, atol=0)
        assert_allclose(entry["frequency"], mode.angular_frequency / (2 * np.pi), rtol=1e-12, atol=0)
        assert entry["damping_ratio"] == 0.0
        shape = entry["shape"]["blade"]
        assert np.shape(shape["position"]) == np.shape(shape["rotation"]) == (len(shape["X"]), 3)
        assert "imaginary" not in shape
    assert_allclose(np.abs(written["modes"][0]["shape"]["blade"]["rotation"]).max(), 1.0, rtol=1e-9, atol=0)


def test_flutter_is_told_and_written_in_both_phases(blade: Path) -> None:
    done = run_modes("blade.toml", "--set", "thrust.force=[0,0,-25]", "--count", "2", "--output", "m.json", cwd=blade)
    assert done.returncode == 0, done.stderr
    assert "flutter" in done.stdout
    growing, decaying = json.loads((blade / "m.json").read_text())["modes"]
    assert growing["eigenvalue"][0] > 0.1
    assert growing["damping_ratio"] < 0.0 < decaying["damping_ratio"]
    # A flutter mode travels: its sections are not in phase.
    assert np.abs(growing["shape"]["blade"]["imaginary"]["position"]).max() > 1e-3


def test_frequencies_that_are_not_resolved_end_with_three_and_are_written(blade: Path) -> None:
    done = run_modes("blade.toml", "--set", "accuracy.modes=3", "--count", "3", "--output", "m.json", cwd=blade)
    assert done.returncode == 3
    written = json.loads((blade / "m.json").read_text())
    assert written["converged"] is False
    assert written["modes"][2]["error_estimate"] > 1e-3


def test_every_refusal_comes_at_once(blade: Path) -> None:
    options = ("--count", "2", "--mode", "3", "--plot", "m.txt", "--animation", "m.txt", "--output", "no/m.json")
    done = run_modes("blade.toml", *options, "--set", "blade.length=-1", cwd=blade)
    assert done.returncode == 2
    for words in ("--mode", "--plot", "--animation", "no", "length"):
        assert words in done.stderr
    assert [path.name for path in blade.iterdir()] == ["blade.toml"]


def test_a_scene_without_mass_is_refused(blade: Path) -> None:
    text = (blade / "blade.toml").read_text().replace("linear_density = 1.0\n", "")
    (blade / "blade.toml").write_text(text)
    done = run_modes("blade.toml", cwd=blade)
    assert done.returncode == 2
    assert "has mass" in done.stderr


def test_a_mode_that_the_scene_does_not_have_is_refused(blade: Path) -> None:
    text = (blade / "blade.toml").read_text().replace("linear_density = 1.0\n", "")
    body = """
[[bodies]]
name = "ball"
mass = 1.0
[[joints]]
body = "ball"
rod = "blade"
kind = "fixed"
"""
    (blade / "blade.toml").write_text(text + body)
    done = run_modes("blade.toml", "--mode", "5", "--animation", "m.gif", "--output", "m.json", cwd=blade)
    assert done.returncode == 2
    assert "the scene has no more modes" in done.stderr
    assert not (blade / "m.json").exists()
