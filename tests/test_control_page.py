"""The page on control works when pasted."""

from __future__ import annotations

import re

import pytest

from cosserat_casadi import parse_scene, read_scene
from cosserat_casadi.scene.writing import scene_text
from tests.conftest import ROOT
from tests.families import mostly_slow
from tests.pages import DOCS, blocks, run_python

PAGE = DOCS / "control.md"


def test_tables_of_the_page_are_read() -> None:
    (text,) = blocks(PAGE, "toml")
    finger = scene_text(read_scene(ROOT / "examples" / "tendon_finger.toml"))
    inputs, tables = text.split("\n", 1)
    scene = parse_scene(finger.replace("schema = 1\n", f"schema = 1\n{inputs}\n", 1) + tables)
    assert [target.kind for target in scene.targets] == ["pose", "curve"]
    assert scene.bounds[0].upper == 8.0


def test_the_page_leads_to_the_compiled_stage() -> None:
    """An iteration of an optimiser takes it a twentieth of the time that the lifted form takes."""
    _, section = PAGE.read_text(encoding="utf-8").split("## A rod in a problem of your own")
    ways = [way for way in re.findall(r"^\*(\w+)\*", section, flags=re.M) if way in ("Compiled", "Lifted", "Embedded")]
    assert ways == ["Compiled", "Lifted", "Embedded"]
    assert "compiled_stage" in section.split("```python")[1]


LONG = {
    'inverse(read_scene("examples/finger_to_point.toml"))': "control/test_inverse.py",
    'compiled_stage(model, "wire_stage"': "codegen/test_stage.py",
    "import rockit": "control/test_rockit.py",
    "tight = tightened(contact": "control/test_relaxed_contact.py",
    "condensing = Condensing(": "control/test_condensing.py",
    "stage = motion_stage(model, 0.02)  # s": "control/test_motion_stage.py",
    "smoothing = opti.parameter()": "control/test_motion_stage_in_contact.py",
    "write_acados(model": "codegen/test_acados.py",
    "set_uncertainty_values(": "control/test_do_mpc.py",
}
"""What a block holds that takes a second or more, and the file that has quick tests of it."""


def python_blocks() -> list[object]:
    """Blocks of Python, the long ones marked slow."""
    texts = blocks(PAGE, "python")
    return mostly_slow(texts, quick=[text for text in texts if not any(words in text for words in LONG)])


def test_every_long_block_is_on_the_page() -> None:
    texts = blocks(PAGE, "python")
    for words, file in LONG.items():
        assert any(words in text for text in texts), words
        assert (ROOT / "tests" / file).is_file(), file


@pytest.mark.parametrize("code", python_blocks())
def test_python_of_the_page_runs(code: str) -> None:
    run_python(code)
