"""The example of predictive control: on the path, within its bounds, the same plan from both solvers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.stage import compiled_stage
from examples.tendon_robot_mpc import BALANCED, LARGEST, LEAST, RATE, SOLVERS, STEP, Run, robots, simulate, summary
from tests.codegen.test_load import cached, needs_compiler

pytestmark = needs_compiler


def pulled(run: Run, first: np.ndarray) -> np.ndarray:
    return np.vstack([first, run.tensions])


@pytest.mark.slow
def test_the_robot_follows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)
    known, robot = robots()
    stage = compiled_stage(known.model, "robot_stage", curvature=False)
    runs = {name: simulate(known, robot, stage, name, steps=6) for name in SOLVERS}
    for run in runs.values():
        assert all(plan.succeeded and plan.residual <= BALANCED for plan in run.plans)
        assert np.all((run.tensions >= LEAST) & (run.tensions <= LARGEST))
        rates = np.diff(pulled(run, known.inputs), axis=0) / STEP
        assert np.abs(rates).max() <= RATE * (1 + 1e-6)
        assert all(state.converged and state.stable for state in run.states)
        assert run.gaps[1:3].max() < 5e-5  # m: once the deviation of the model has been seen
        assert run.gaps[3] > 1e-2  # the payload falls in
        assert run.gaps[-1] < run.gaps[3] / 10
    assert_allclose(runs["fatrop"].tensions, runs["ipopt"].tensions, rtol=0, atol=2e-3)
    assert summary("fatrop", runs["fatrop"]).startswith("| fatrop | ")
