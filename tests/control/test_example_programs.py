"""The programs among the examples, on few stages: what they print, and the pictures that they draw."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.codegen.test_load import needs_compiler
from tests.conftest import ROOT
from tests.families import mostly_slow

BEGINNINGS = {".png": b"\x89PNG", ".gif": b"GIF89a"}
"""First bytes of the pictures, by their suffixes."""

MOVING = ("--animation", "picture.gif")

PROGRAMS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "carry_load": (("--stages", "3", *MOVING), ("feet stay: 2 of 3 stable", "margin held: 3 of 3 stable")),
    "design_finger": (("--cases", "4"), ("4 of 4 stable",)),
    "design_spring": ((), ("41 of 41 stable", "41 of 41 stable")),
    "tendon_robot_mpc": (("--steps", "4", "--repeats", "1", *MOVING), ("| fatrop |", "| ipopt |")),
    "tendon_robot_swing_free": (("--steps", "30", "--repeats", "1", *MOVING), ("| equilibria |", "| motion |")),
    "trace_circle": (("--stages", "3", *MOVING), ("3 of 3 stable",)),
}
"""Options of each program, and what it prints, as often as it stands here."""


@needs_compiler
@pytest.mark.parametrize("name", mostly_slow(PROGRAMS, quick=["tendon_robot_swing_free"]))
def test_a_program_prints_its_results_and_draws_them(name: str, tmp_path: Path) -> None:
    options, printed = PROGRAMS[name]
    command = [sys.executable, str(ROOT / "examples" / f"{name}.py"), "--output", "picture.png", *options]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    for words in printed:
        assert done.stdout.count(words) == printed.count(words), done.stdout
    pictures = [tmp_path / word for word in command if Path(word).suffix in BEGINNINGS]
    assert pictures
    for picture in pictures:
        assert picture.read_bytes().startswith(BEGINNINGS[picture.suffix])
