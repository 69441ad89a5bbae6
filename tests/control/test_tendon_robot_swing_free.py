"""The example of a robot that moves without swinging: it arrives and stops, within its bounds; without motion in the
model it swings."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import CompiledMotionStage, solve
from cosserat_casadi.codegen.motion_stage import poses_functions
from cosserat_casadi.control import MotionStage
from examples import tendon_robot_swing_free as example
from tests.codegen.test_load import cached, needs_compiler
from tests.conftest import ROOT


def check_bounds(run: example.Run, first: np.ndarray) -> None:
    """Every plan was found, and tensions and rates are within their bounds."""
    assert all(plan.solved for plan in run.plans)
    assert run.tensions.min() >= 0.0
    assert run.tensions.max() <= example.LARGEST
    rates = np.diff(np.vstack([first, run.tensions]), axis=0) / example.STEP
    assert np.abs(rates).max() <= example.RATE * (1 + 1e-6)


def not_compiled(stage: MotionStage, name: str) -> CompiledMotionStage:
    """The functions of a stage as CasADi evaluates them: to compile them takes longer than the move."""
    poses, *_ = poses_functions(stage, name, curvature=False)
    return CompiledMotionStage(stage.equations, poses)


def test_the_robot_arrives(monkeypatch: pytest.MonkeyPatch) -> None:
    """To the end of the move, with a payload that the model does not have."""
    monkeypatch.setattr(example, "compiled_motion_stage", not_compiled)
    known, model = example.known_model(), example.moved_model(modes=3)
    tensions = example.start_tensions(model)
    near = solve(known, dict(zip(example.TENSIONS, tensions, strict=True)))
    controller = example.Moving(known, near.x)
    steps = round((example.SETTLING + example.DURATION) / example.STEP)
    run = example.simulate(controller, known, model, tensions, steps)
    check_bounds(run, tensions)
    gaps = np.linalg.norm(run.tips - run.wanted, axis=1)
    assert gaps.max() < 0.015  # m, of a move by 0.15 m
    # One step of the optimiser in every period is enough: the equations of motion nearly hold before it.
    assert max(plan.residual for plan in run.plans) < 0.3
    force = run.plans[-1].correction
    assert force is not None
    assert -6e-3 < force[2] < -2e-3  # N: the payload weighs 4 mN
    assert example.summary("motion", run).startswith("| motion | ")
    # Where no plan is found, the tensions are held.
    monkeypatch.setattr(controller, "change", lambda *_: None)
    measured = example.Measured(run.tips[-1], near.x, 0.0 * near.x, tensions, np.zeros(example.COUNT))
    held = controller.step(run.plans[-1], measured, np.tile(example.START, (example.STAGES, 1)))
    assert not held.solved
    assert_allclose(held.first, 0.0, rtol=0, atol=0)


@needs_compiler
@pytest.mark.slow
def test_only_the_plan_with_motion_stops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)
    known, model = example.known_model(), example.moved_model()
    tensions = example.start_tensions(model)
    steps = round((example.SETTLING + example.DURATION + 0.6) / example.STEP)
    runs = {
        name: example.simulate(controller, known, model, tensions, steps)
        for name, controller in example.controllers(known, tensions).items()
    }
    for run in runs.values():
        check_bounds(run, tensions)
    assert runs["motion"].swing < 0.008  # m
    assert runs["equilibria"].swing > 0.05
    assert np.linalg.norm(runs["motion"].tips[-1] - runs["motion"].wanted[-1]) < 1e-3


@needs_compiler
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
