"""The example of a robot that moves without swinging: it arrives and stops, within its bounds; without motion in the
model it swings."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from examples.tendon_robot_swing_free import (
    DURATION,
    LARGEST,
    RATE,
    SETTLING,
    STEP,
    Moving,
    Run,
    controllers,
    known_model,
    moved_model,
    simulate,
    start_tensions,
    summary,
)
from tests.codegen.test_load import cached, needs_compiler
from tests.conftest import ROOT

pytestmark = needs_compiler


def check_bounds(run: Run, first: np.ndarray) -> None:
    """Every plan was found, and tensions and rates are within their bounds."""
    assert all(plan.solved for plan in run.plans)
    assert run.tensions.min() >= 0.0
    assert run.tensions.max() <= LARGEST
    rates = np.diff(np.vstack([first, run.tensions]), axis=0) / STEP
    assert np.abs(rates).max() <= RATE * (1 + 1e-6)


def test_the_robot_arrives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On few modes, to the end of the move."""
    cached(tmp_path, monkeypatch)
    known, model = known_model(modes=1), moved_model(modes=2)
    tensions = start_tensions(model)
    controller = controllers(known, tensions)["motion"]
    assert isinstance(controller, Moving)
    run = simulate(controller, known, model, tensions, steps=round((SETTLING + DURATION + 0.1) / STEP))
    check_bounds(run, tensions)
    gaps = np.linalg.norm(run.tips - run.wanted, axis=1)
    assert gaps.max() < 0.025  # m, of a move by 0.15 m
    # One step of the optimiser in every period is enough: the equations of motion hold nearly before it.
    assert max(plan.residual for plan in run.plans) < 0.05
    force = run.plans[-1].correction
    assert force is not None
    assert -6e-3 < force[2] < -2e-3  # N: the weight of the payload that the model does not have is 4 mN
    assert summary("motion", run).startswith("| motion | ")


@pytest.mark.slow
def test_only_the_plan_with_motion_stops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)
    known, model = known_model(), moved_model()
    tensions = start_tensions(model)
    steps = round((SETTLING + DURATION + 0.6) / STEP)
    runs = {
        name: simulate(controller, known, model, tensions, steps)
        for name, controller in controllers(known, tensions).items()
    }
    for run in runs.values():
        check_bounds(run, tensions)
    assert runs["motion"].swing < 0.008  # m
    assert runs["equilibria"].swing > 0.05
    assert np.linalg.norm(runs["motion"].tips[-1] - runs["motion"].wanted[-1]) < 1e-3


@pytest.mark.slow
def test_the_program_prints_its_table_and_draws(tmp_path: Path) -> None:
    program = ROOT / "examples" / "tendon_robot_swing_free.py"
    files = ["--output", "run.png", "--animation", "run.gif"]
    command = [sys.executable, str(program), "--steps", "30", "--repeats", "1", *files]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    assert "| equilibria |" in done.stdout
    assert "| motion |" in done.stdout
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "run.gif").read_bytes().startswith(b"GIF89a")
