"""What the script on readability counts, and that it runs for one checkout and for two."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from numpy.testing import assert_allclose

from tests.conftest import ROOT

SCRIPT = ROOT / "benchmarks" / "readability.py"

PACKED = '''"""A module."""
def f(a):
    """Docstring."""
    # why
    b, c = a, 2  # noqa: not for readers
    return b if c else a
'''

PLAIN = '''"""A module."""


def f(a):
    if a:
        return 2
    b = a
    return b
'''


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("readability", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["readability"] = module
    spec.loader.exec_module(module)
    return module


def checkout(folder: Path, text: str) -> Path:
    (folder / "cosserat_casadi" / "room").mkdir(parents=True)
    (folder / "cosserat_casadi" / "room" / "module.py").write_text(text)
    (folder / "generated").mkdir()
    (folder / "generated" / "kernel.c").write_text("int x;\n" * 3)
    return folder


def test_counts_of_a_packed_function(script: ModuleType, tmp_path: Path) -> None:
    counted = script.density(checkout(tmp_path, PACKED))
    assert (counted.files, counted.lines, counted.code_lines) == (1, 6, 3)
    assert (counted.packed, counted.conditional, counted.comments) == (1, 1, 1)
    # Assign, two tuples, three names, a constant, five contexts of those; Return, IfExp, three names, three contexts.
    assert_allclose(counted.nodes_per_line, [(12 + 8) / 2], rtol=0, atol=1e-12)


def test_two_checkouts_stand_side_by_side(tmp_path: Path) -> None:
    before = checkout(tmp_path / "before", PACKED)
    after = checkout(tmp_path / "after", PLAIN)
    done = subprocess.run(
        [sys.executable, str(SCRIPT), str(before), str(after), "--rooms"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "|  | before | after |" in done.stdout
    assert "| generated/, lines | 3 | 3 |" in done.stdout
    assert "\nroom\n" in done.stdout
