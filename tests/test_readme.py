"""The README works when pasted: its scene, its commands, its Python."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cosserat_casadi import parse_scene, read_scene
from tests.conftest import ROOT

README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_scene_of_the_readme_is_the_example() -> None:
    (text,) = blocks("toml")
    assert parse_scene(text) == read_scene(ROOT / "examples" / "nitinol_wire.toml")


@pytest.mark.parametrize(("number", "says"), [(0, "Equilibrium found"), (1, "")])
def test_python_of_the_readme_runs(number: int, says: str) -> None:
    code = blocks("python")[number]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    assert says in done.stdout


def test_every_python_block_is_run() -> None:
    assert len(blocks("python")) == 2


def test_c_of_the_readme_compiles_and_runs(tmp_path: Path) -> None:
    (line,) = [line for block in blocks("sh") for line in block.splitlines() if "gcc" in line]
    folder = shutil.copytree(ROOT / "generated" / "nitinol_wire", tmp_path / "wire")
    assert line.startswith("(cd wire && ")
    done = subprocess.run(line, shell=True, cwd=folder.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "converged"


def commands() -> list[str]:
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    return [line.split(" > ")[0] for line in lines if line.startswith(".venv/bin/cosserat ")]


def test_there_are_ten_commands() -> None:
    assert len(commands()) == 10


@pytest.mark.parametrize("line", commands())
def test_commands_of_the_readme_run(line: str, tmp_path: Path) -> None:
    words = shlex.split(line.replace("examples/", f"{ROOT}/examples/"))
    code = "from cosserat_casadi.cli.main import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, *words[1:]], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr


def test_every_effect_is_in_the_table() -> None:
    from cosserat_casadi.model.registry import EFFECTS, SUPPORTS

    for kind in (*EFFECTS, *SUPPORTS):
        assert f"`{kind}`" in README


def test_pictures_and_pages_exist() -> None:
    prose = re.sub(r"```.*?```", "", README, flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)#]+)\)", prose):
        assert (ROOT / target).exists(), target


def test_every_test_that_the_theory_names_exists() -> None:
    tests = "\n".join(path.read_text() for path in (ROOT / "tests").rglob("test_*.py"))
    named = re.findall(r"`(?:tests/[\w/]+\.py::)?(test_\w+)`", (ROOT / "docs" / "theory.md").read_text())
    assert len(named) > 20
    for name in named:
        assert f"def {name}(" in tests, name
