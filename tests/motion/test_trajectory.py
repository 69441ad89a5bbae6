"""What a motion says of its rods, bodies and actuators is what solutions at its states say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome, Solution
from cosserat_casadi.motion.trajectory import Motion, MotionOutcome, MotionProgress
from tests.motions import swinging_rod, two_rods_on_a_platform, without_start


@pytest.fixture(scope="module")
def platform() -> Motion:
    return two_rods_on_a_platform(frames=7)


def state(motion: Motion, index: int) -> Solution:
    """One row of a motion as a solution, whose poses are computed by other functions."""
    return Solution(motion.model, motion.inputs[index], motion.x[index], Outcome.CONVERGED, "", 0.0, 0)


@pytest.mark.parametrize("rod", ["left", "right"])
@pytest.mark.parametrize("index", [0, 3, 6])
def test_tips_and_sections_vs_solutions(platform: Motion, rod: str, index: int) -> None:
    solution = state(platform, index)
    tip = platform.tip(rod)
    assert_allclose(tip.position[index], solution.tip(rod).position, rtol=0, atol=1e-13)
    assert_allclose(tip.quaternion[index], solution.tip(rod).quaternion, rtol=0, atol=1e-13)

    X = [0.0, 0.31, 0.77, 1.0]
    sections = platform.section(rod, X)
    section_of = platform.model.shape[rod]
    for k, abscissa in enumerate(X):
        position, quaternion = section_of(platform.x[index], platform.inputs[index], abscissa)
        assert_allclose(sections.position[index, k], position.full()[:, 0], rtol=0, atol=1e-13)
        assert_allclose(sections.quaternion[index, k], quaternion.full()[:, 0], rtol=0, atol=1e-13)


def test_sections_of_a_rod_in_elements_end_at_its_tip() -> None:
    # The hook at X = 0.4 cuts the rod into two elements.
    motion = swinging_rod(frames=4)
    assert motion.model.discretisation["rod"].elements == 2
    sections = motion.section(None, np.linspace(0.0, 1.0, 13))
    assert sections.position.shape == (4, 13, 3)
    assert sections.quaternion.shape == (4, 13, 4)
    assert_allclose(sections.position[:, -1], motion.tip().position, rtol=0, atol=1e-13)
    assert_allclose(np.linalg.norm(sections.quaternion, axis=2), 1.0, rtol=1e-14, atol=0)


@pytest.mark.parametrize("index", [0, 6])
def test_bodies_and_actuators_vs_solutions(platform: Motion, index: int) -> None:
    solution = state(platform, index)
    body = platform.body("platform")
    assert_allclose(body.position[index], solution.body("platform").position, rtol=0, atol=1e-13)
    assert_allclose(body.quaternion[index], solution.body("platform").quaternion, rtol=0, atol=1e-13)
    cable = platform.actuator("cable")
    expected = solution.actuator("cable")
    assert_allclose(cable.effort[index], expected["tension"], rtol=1e-13, atol=0)
    assert_allclose(cable.conjugate[index], expected["length"], rtol=1e-13, atol=0)
    assert_allclose(cable.effort[[0, -1]], [5.0, 30.0], rtol=1e-13, atol=0)


def test_states_between_the_rows_are_those_of_the_dense_output() -> None:
    motion = swinging_rod(duration=0.5, frames=3)
    middle = motion.at(0.125)
    # A quarter of the half turn: (1 - cos 45°)/2 of the way.
    way = (1 - np.sqrt(0.5)) / 2
    assert_allclose(middle.x, motion.x[0] + way * (motion.x[-1] - motion.x[0]), rtol=1e-12, atol=1e-15)
    assert_allclose(motion.at(0.25).inputs, motion.inputs[1], rtol=1e-14, atol=0)


@pytest.mark.parametrize("time", [-1e-9, 0.5 + 1e-9, float("nan")])
def test_times_outside_of_the_motion_are_refused(time: float) -> None:
    motion = swinging_rod(duration=0.5, frames=3)
    with pytest.raises(ValueError, match=r"goes from 0 s to 0\.5 s"):
        motion.at(time)


def test_unknown_names_are_refused_with_those_that_are_known(platform: Motion) -> None:
    with pytest.raises(KeyError, match="its rods are left, right"):
        platform.tip()
    with pytest.raises(KeyError, match="its bodies are platform"):
        platform.body("disc")
    with pytest.raises(KeyError, match="its actuators are cable"):
        platform.actuator("wire")


def test_a_motion_that_was_not_started_has_no_rows() -> None:
    none = without_start()
    assert not none.converged
    assert none.tip().position.shape == (0, 3)
    assert none.section(None, [0.2, 0.5]).quaternion.shape == (0, 2, 4)
    with pytest.raises(ValueError, match="did not start"):
        none.at(0.0)


def test_outcomes_are_sentences_and_only_the_first_is_success() -> None:
    assert all(outcome.value.endswith(".") for outcome in MotionOutcome)
    assert MotionOutcome.STEP_TOO_SMALL.label == "step_too_small"
    motion = swinging_rod(frames=2)
    for outcome in MotionOutcome:
        assert replace(motion, outcome=outcome).converged == (outcome is MotionOutcome.COMPLETED)


def test_share_of_the_duration() -> None:
    assert MotionProgress("simulating", time=0.5, duration=2.0, step=1e-3).share == 0.25
