"""Positions at many times at once are those of the steps, one time after the other."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.pose_series import AT_ONCE, section_poses
from cosserat_casadi.motion.simulate import started
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.step import StepRows
from tests import moving_scenes
from tests.motion import transients
from tests.motion.stepping import moving_model, stepped

PUSHED = {
    "input": "tip.force",
    "times": [0.0, 0.03, 0.05],
    "values": [[0.0, 0.0, 0.0], [0.4, 0.2, -0.1], [0.0, 0.0, 0.1]],
}
"""Its kinks part the motion into two pieces."""

SWAYED = {
    "input": "weight.acceleration",
    "amplitude": [0.3, 2.0, 1.0],
    "frequency": 1.5,
    "wave": "one_minus_cosine",
}


def closed_loop() -> dict[str, Any]:
    scene = moving_scenes.FAMILIES["pinned tip"]()
    scene.pop("inputs", None)
    return {**scene, "motions": [SWAYED], "accuracy": {"modes": 2, "nodes": 6}, "simulation": {"duration": 0.06}}


def free_rod() -> dict[str, Any]:
    return {**transients.flying_in_space(duration=0.06, frames=2), "accuracy": {"modes": 2, "nodes": 6}}


def pushed_rod() -> dict[str, Any]:
    scene = free_rod()
    rod = {**scene["rods"][0], "base": {"position": [0, 0, 0], "tangent": [0, 0, 1]}}
    tip = {"name": "tip", "kind": "tip_wrench", "rod": rod["name"], "force": [0, 0, 0]}
    return {**scene, "rods": [rod], "loads": [tip], "motions": [PUSHED]}


def history_of(scene: dict[str, Any]) -> History:
    model = moving_model(scene)
    assert model.scene.simulation is not None
    start = started(model, model.scene.simulation, None)
    return stepped(model, radau(2), 0.01, 0.06, start.x)


def one_by_one(history: History, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    places = [history.locate(float(time)) for time in times]
    x = np.array([instant.x for _, instant in places])
    inputs = np.array([leg.piece.at(instant.time).value for leg, instant in places])
    return x, inputs


@pytest.mark.parametrize("scene", [closed_loop, free_rod, pushed_rod])
def test_all_at_once_vs_one_by_one(scene: Any) -> None:
    history = history_of(scene())
    ends = [step.end.time for _, step in history.steps]
    times = np.sort(np.concatenate([np.linspace(0.0, 0.06, 14), ends]))
    x, inputs = history.rough_positions(times)
    expected_x, expected_inputs = one_by_one(history, times)
    assert_allclose(x, expected_x, rtol=1e-13, atol=1e-15)
    assert_allclose(inputs, expected_inputs, rtol=1e-13, atol=1e-15)
    states = history.states(times)
    rates = [(instant.v, instant.a) for _, instant in (history.locate(float(time)) for time in times)]
    assert_allclose(states.v, [v for v, _ in rates], rtol=1e-12, atol=1e-13)
    assert_allclose(states.a, [a for _, a in rates], rtol=1e-12, atol=1e-11)
    # The other times change nothing, to the last digit; constraints are closed at each.
    assert_array_equal(history.at(float(times[4])).x, states.x[4])
    assert_allclose(states.x, x, rtol=0, atol=1e-3)


def test_a_motion_that_has_no_step_has_its_start() -> None:
    whole = history_of(free_rod())
    leg = whole.legs[0]
    begun = replace(leg, integration=replace(leg.integration, steps=()))
    history = replace(whole, legs=(begun,))
    x, inputs = history.rough_positions(np.zeros(2))
    expected_x, expected_inputs = one_by_one(history, np.zeros(2))
    assert_allclose(x, expected_x, rtol=0, atol=0)
    assert_allclose(inputs, expected_inputs, rtol=0, atol=0)


def test_sections_at_many_times_take_little_more_memory_than_their_poses() -> None:
    """The fields of all nodes at all times would be several times as large; one time alone has the same poses."""
    model = moving_model(free_rod())
    (rod,) = model.discrete.rods
    count = 24 * AT_ONCE + 1
    x = 0.1 * np.random.default_rng(0).standard_normal((count, model.size))
    inputs = np.tile(model.inputs.pack(), (count, 1))
    X = np.linspace(0.0, 1.0, 5)
    tracemalloc.start()
    poses = section_poses(model, rod, X, x, inputs)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2 * (poses.position.nbytes + poses.quaternion.nbytes)
    for row in (0, AT_ONCE - 1, AT_ONCE, count - 1):
        alone = section_poses(model, rod, X, x[row : row + 1], inputs[row : row + 1])
        assert_allclose(poses.position[row], alone.position[0], rtol=0, atol=1e-15)
        assert_allclose(poses.quaternion[row], alone.quaternion[0], rtol=0, atol=1e-15)


@pytest.mark.parametrize("scene", [closed_loop, free_rod, pushed_rod])
def test_a_state_passes_over_no_other_steps(scene: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    history = history_of(scene())
    first = history.at(0.02)
    converted = []
    monkeypatch.setattr(StepRows, "of", lambda steps: converted.append(len(steps)))
    again = history.at(0.02)
    assert not converted
    assert "steps" not in vars(history)
    assert_array_equal(again.x, first.x)
    for time in (0.013, 0.047, 0.06):
        assert_array_equal(history.at(time).x, history.states(np.array([0.005, time, 0.059])).x[1])
