"""The error that the steps of a free rod leave, as a coarser motion tells it, beside that of a far more exact one."""

from __future__ import annotations

import pytest

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.motion.paths import path_distance
from cosserat_casadi.motion.resolve import Level, told_by_coarser
from cosserat_casadi.motion.simulate import Simulator, started
from tests.motion import transients

STEP_TOLERANCE = 1e-3


@pytest.fixture(scope="module")
def level() -> Level:
    """A rod that is kicked in space, as it flies on five modes."""
    asked = transients.flying_in_space(duration=4.0, frames=2)
    scene = scene_from_dict({**asked, "accuracy": {"modes": 5, "nodes": 10}})
    model = build(scene.with_motion_inputs(), moving=True)
    simulation = scene.simulation
    assert simulation is not None
    simulator = Simulator(model, simulation, started(model, simulation, None))
    history = simulator.controlled(STEP_TOLERANCE)
    return Level(simulator, history, simulator.paths(history))


def test_error_told_by_a_coarser_motion_is_not_too_small(level: Level) -> None:
    told = told_by_coarser(level, STEP_TOLERANCE)
    exact = level.simulator.controlled(1e-2 * STEP_TOLERANCE)
    error = path_distance(level.paths, level.simulator.paths(exact))
    assert told.history is level.history
    assert error <= told.error
    # Nor is it without use.
    assert told.error <= 100.0 * error


def test_coarser_motion_that_does_not_end_tells_nothing(level: Level, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = level.history
    monkeypatch.setattr(type(broken), "completed", False)
    assert told_by_coarser(level, STEP_TOLERANCE).error == float("inf")
