"""The example that traces a circle: on the circle, within the bounds, at little effort."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from examples.trace_circle import LARGEST, RADIUS, finger, trace
from tests.conftest import ROOT


def test_the_tip_is_on_the_circle_at_little_effort() -> None:
    model = finger()
    tensions, equilibria = trace(model, 4)
    tips = np.array([solve(model, s.model.inputs.unpack(s.inputs)).tip().position for s in equilibria])
    angles = np.pi / 2 * np.arange(4)
    assert_allclose(tips[:, 1:], RADIUS * np.column_stack([np.cos(angles), np.sin(angles)]), rtol=0, atol=1e-8)
    assert np.all((tensions >= 0.0) & (tensions <= LARGEST))
    assert all(s.stable for s in equilibria)
    assert_allclose(tensions.min(axis=1), 0.0, rtol=0, atol=1e-4)  # two pull, the third would only pull against them


@pytest.mark.slow
def test_the_program_draws_its_figure(tmp_path: Path) -> None:
    program = ROOT / "examples" / "trace_circle.py"
    command = [sys.executable, str(program), "--stages", "3", "--output", "c.png", "--animation", "c.gif"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert "3 of 3 stable" in done.stdout
    assert (tmp_path / "c.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "c.gif").read_bytes().startswith(b"GIF89a")
