"""The log: what a solve, a motion and a choice of modes did, under the name of the package, and quiet by default."""

from __future__ import annotations

import logging
import subprocess
import sys

import pytest

from cosserat_casadi import choose, simulate, solve
from tests.scenes import push, rod, scene


def test_a_solve_tells_its_levels(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, logger="cosserat_casadi"):
        solution = solve(scene(push(), accuracy={"tolerance": 1e-4}))
    assert {record.name for record in caplog.records} == {
        "cosserat_casadi.accuracy.scene_solver",
        "cosserat_casadi.accuracy.refine",
    }
    (last,) = [record.message for record in caplog.records if "Enough" in record.message]
    assert last.startswith("level of ")
    assert "CONVERGED" in caplog.text
    assert solution.converged


def test_a_motion_and_a_choice_tell_theirs(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, logger="cosserat_casadi"):
        body = rod("planar")
        weight = {"name": "weight", "kind": "gravity", "acceleration": [1.0, 0, 0]}
        given = {"duration": 0.05, "start": "unloaded"}
        simulate(scene(weight, rods=[body], simulation=given, accuracy={"tolerance": 1e-3}))
        choose(scene(push(), rods=[body], inputs=["push.force"], accuracy={"tolerance": 1e-2}), samples=1)
    assert "steps, " in caplog.text
    assert "points, largest error" in caplog.text


def test_it_is_quiet_by_default() -> None:
    program = (
        "from tests.scenes import push, scene; from cosserat_casadi import solve; "
        "solve(scene(push(), accuracy={'tolerance': 1e-2}))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == run.stderr == ""
