"""Modes that constraints lock are told by every command."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosserat_casadi import choose, read_scene, solve
from tests.commands import cosserat

LOCKED = """
schema = 1
[accuracy]
modes = [2, 1]
nodes = 6
[[rods]]
name = "rod"
length = 0.8
strain = ["bending_y", "extension"]
stiffness = { bending_y = 1.4, extension = 90.0 }
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "rod"
force = [0, 0, 0]
[[supports]]
rod = "rod"
kind = "clamped"
position = [0, 0, 0.81]
quaternion = [1, 0, 0, 0]
"""
"""A rod in a plane, pulled straight between two clamps: three constraints, and three modes."""


@pytest.fixture
def held(tmp_path: Path) -> Path:
    (tmp_path / "held.toml").write_text(LOCKED)
    return tmp_path


def test_solve_and_check_say_that_modes_are_locked(held: Path) -> None:
    for command in ("solve", "check"):
        done = cosserat(command, "held.toml", cwd=held)
        said = " ".join((done.stdout + done.stderr).split())
        # Nothing acts, and the straight rod is right: only a load would be answered wrongly.
        assert done.returncode == 0, said
        assert "kinematically locked" in said
        assert "wind.force" in said
        free = cosserat(command, "held.toml", "--set", "accuracy.modes=4", cwd=held)
        assert "kinematically locked" not in free.stdout + free.stderr


def test_check_says_where_it_cannot_be_known(held: Path) -> None:
    """Without an equilibrium there is nothing at which to look whether modes are locked."""
    done = cosserat("check", "held.toml", "--set", "wind.force=[1e9,0,0]", cwd=held)
    assert done.returncode == 0, done.stderr
    assert "constraints lock the modes that the scene fixes is not known: the test needs an equilibrium" in " ".join(
        done.stdout.split()
    )


@pytest.mark.slow
def test_an_export_of_locked_modes_says_so_and_does_not_end_well(held: Path) -> None:
    done = cosserat("export", "held.toml", "--output", "c", "--no-error-estimate", cwd=held)
    assert done.returncode == 3, done.stdout + done.stderr
    assert "kinematically locked" in " ".join(done.stderr.split())
    assert "asks for no tolerance" in " ".join(done.stdout.split())
    assert "tolerance" not in done.stderr
    for file in ("README.md", "held.h", "manifest.json"):
        text = (held / "c" / file).read_text()
        assert '"locked": [' in text or "kinematically locked" in " ".join(text.split())
        assert "The scene asks for a tip pose" not in " ".join(text.split())


def test_locked_modes_are_told_in_python(held: Path) -> None:
    scene = read_scene(held / "held.toml")
    assert "kinematically locked" in solve(scene).message
    choice = choose(scene, samples=2)
    assert choice.locked == ("wind.force",)
    assert not choice.met
    # Nobody asks for a tolerance.
    assert choice.within_tolerance is None
