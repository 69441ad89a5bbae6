"""Scenes whose sweeps take little time, and a compiler that does not optimise."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.scenes import push, rod, scene


@pytest.fixture
def few_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two rows are solved again at the end of a sweep, not six."""
    monkeypatch.setattr("cosserat_casadi.sweep.choice.CHECKED", 2)


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
        patch.setenv("PYTHONPATH", os.pathsep.join([str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]))
        yield


PLANAR = scene(
    push(force=[0.9, 0.0, -0.4], moment=[0.0, 0.3, 0.0]),
    rods=[rod("planar", stiffness={"bending_y": 1.4})],
    accuracy={"modes": 3, "nodes": 10, "tolerance": 1e-4},
    title="A planar rod",
)
"""A rod in the plane of x and z with its discretisation fixed."""
