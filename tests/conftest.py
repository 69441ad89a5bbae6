"""Fixtures shared by all tests: where the reference cases are, and short scenes to build on."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
CASES = ROOT.parent / "shared" / "cases"


def case_files(folder: str) -> list[Path]:
    """Scene files of the reference cases; none where the cases are not at hand."""
    return sorted((CASES / folder).glob("*.toml"))


@pytest.fixture(scope="session")
def examples() -> list[Path]:
    return sorted((ROOT / "examples").glob("*.toml"))


@pytest.fixture(scope="session")
def quick_compiler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Libraries lie in a folder of these tests; what they compute matters, not how fast."""
    folder = tmp_path_factory.mktemp("compiler")
    script = folder / "cc"
    script.write_text(f'#!/bin/sh\nexec {shutil.which("gcc")} "$@" -O0\n')
    script.chmod(0o755)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", str(script))
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        patch.setenv("OPENBLAS_NUM_THREADS", "1")
        patch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
        yield


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-generated", action="store_true", help="write the folders in generated/ anew")
