"""The example of a robot that moves without swinging: it arrives and stops, within its bounds; without motion in the
model it swings."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from swing_free import plans, robot, task, with_motion
from swing_free.robot import Run, simulate

from cosserat_casadi import solve
from cosserat_casadi.codegen.motion_stage import CompiledMotionStage, poses_functions
from cosserat_casadi.control import MotionStage
from cosserat_casadi.numerics.integration import StepOutcome, stalled_at
from examples import tendon_robot_swing_free as example
from tests.codegen.test_load import cached, needs_compiler

pytestmark = pytest.mark.slow


def check_bounds(run: Run, first: np.ndarray) -> None:
    """Every plan was found, and tensions and rates are within their bounds."""
    assert all(plan.solved for plan in run.plans)
    assert run.tensions.min() >= 0.0
    assert run.tensions.max() <= task.LARGEST
    rates = np.diff(np.vstack([first, run.tensions]), axis=0) / task.STEP
    assert np.abs(rates).max() <= task.RATE * (1 + 1e-6)


def not_compiled(stage: MotionStage, name: str) -> CompiledMotionStage:
    """The functions of a stage as CasADi evaluates them: to compile them takes longer than the move."""
    poses, *_ = poses_functions(stage, name, curvature=False)
    return CompiledMotionStage(stage.equations, poses)


def test_the_robot_arrives(monkeypatch: pytest.MonkeyPatch) -> None:
    """To the end of the move, with a payload that the model does not have."""
    monkeypatch.setattr(with_motion, "compiled_motion_stage", not_compiled)
    known, model = task.known_model(), task.moved_model(modes=3)
    tensions = task.start_tensions(model)
    near = solve(known, dict(zip(task.TENSIONS, tensions, strict=True)))
    controller = with_motion.Moving(known, near.x)
    steps = round((task.SETTLING + task.DURATION) / task.STEP)
    run = simulate(controller, known, model, tensions, steps)
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
    measured = plans.Measured(run.tips[-1], near.x, 0.0 * near.x, tensions, np.zeros(task.COUNT))
    held = controller.step(run.plans[-1], measured, np.tile(task.START, (task.STAGES, 1)))
    assert held.fault == "the quadratic problem was not solved"
    assert_allclose(held.first, 0.0, rtol=0, atol=0)
    nowhere = dataclasses.replace(measured, tensions=np.full(task.COUNT, np.nan))
    lost = controller.step(run.plans[-1], nowhere, np.tile(task.START, (task.STAGES, 1)))
    assert lost.fault == "the state at the next step was not found"
    assert_allclose(lost.first, 0.0, rtol=0, atol=0)


def test_a_robot_whose_motion_ends_early_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    model = task.moved_model(modes=3)
    moved = robot.Robot(model, task.start_tensions(model))
    monkeypatch.setattr(robot, "integrate", lambda *_: stalled_at(moved.now))
    with pytest.raises(RuntimeError, match=StepOutcome.STALLED.value):
        moved.advance(np.zeros(task.COUNT))


@needs_compiler
def test_only_the_plan_with_motion_stops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)
    known, model = task.known_model(), task.moved_model()
    tensions = task.start_tensions(model)
    steps = round((task.SETTLING + task.DURATION + 0.6) / task.STEP)
    controllers = example.controllers(known, tensions)
    runs = {name: simulate(controller, known, model, tensions, steps) for name, controller in controllers.items()}
    for run in runs.values():
        check_bounds(run, tensions)
    assert runs["motion"].swing < 0.008  # m
    assert runs["equilibria"].swing > 0.05
    assert np.linalg.norm(runs["motion"].tips[-1] - runs["motion"].wanted[-1]) < 1e-3
    size = known.size
    nowhere = plans.Measured(task.START, np.zeros(size), np.zeros(size), np.full(4, np.nan), np.zeros(4))
    resting = controllers["equilibria"]
    lost = resting.step(resting.begin(), nowhere, np.tile(task.START, (task.STAGES, 1)))
    assert lost.fault == "the equilibrium at the measured tensions was not found"
