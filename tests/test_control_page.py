"""The page on control works when pasted."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from cosserat_casadi import parse_scene, read_scene
from cosserat_casadi.scene.writing import scene_text
from tests.conftest import ROOT

PAGE = (ROOT / "docs" / "control.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


def test_tables_of_the_page_are_read() -> None:
    (text,) = blocks("toml")
    finger = scene_text(read_scene(ROOT / "examples" / "tendon_finger.toml"))
    inputs, tables = text.split("\n", 1)
    scene = parse_scene(finger.replace("schema = 1\n", f"schema = 1\n{inputs}\n", 1) + tables)
    assert [target.kind for target in scene.targets] == ["pose", "curve"]
    assert scene.bounds[0].upper == 8.0


@pytest.mark.parametrize("code", blocks("python"))
def test_python_of_the_page_runs(code: str) -> None:
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
