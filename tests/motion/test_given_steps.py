"""Steps of given sizes on motions that they hardly resolve: their equations are solved all the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise, read_scene
from cosserat_casadi.motion.history import History, equations_of
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.numerics.integration import StepOutcome
from tests.families import mostly_slow

EXAMPLES = Path(__file__).parents[2] / "examples"


def in_given_steps(example: str, size: float, duration: float, integrator: str) -> History:
    """The beginning of an example's motion on six modes."""
    changes = [f"simulation.duration={duration}", f"simulation.integrator={integrator!r}"]
    scene = read_scene(EXAMPLES / f"{example}.toml", changes).with_motion_inputs()
    simulation = scene.simulation
    assert simulation is not None
    model = build(scene, discretise(scene, 6, 18), moving=True)
    return Simulator(model, simulation, started(model, simulation, None)).stepped(size)


def largest_residual(history: History) -> float:
    """Largest entry of the equations at the stages of all steps."""
    largest = 0.0
    for leg, step in history.steps:
        equations = equations_of(history.model, leg.piece)
        if history.coordinates is not None:
            equations = history.coordinates.equations(equations)
        stages = step.stages
        rows = equations.residual_of_stages(stages.times, stages.x, stages.v, stages.a)
        largest = max(largest, float(np.abs(rows).max()))
    return largest


RUNS = [(example, integrator) for example in ("tendon_robot_move", "thrown_rod") for integrator in ("radau", "gauss")]


@pytest.mark.parametrize(("example", "integrator"), mostly_slow(RUNS, quick=[RUNS[3]]))
def test_every_given_step_is_solved(example: str, integrator: str) -> None:
    history = in_given_steps(example, 0.03, 0.21, integrator)
    assert history.outcome is StepOutcome.COMPLETED
    # Forces and moments over those of the rod's stiffness.
    assert largest_residual(history) < 1e-7
    sizes = [step.size for _, step in history.steps]
    assert max(sizes) <= 0.03 * (1 + 1e-9)


def test_without_growing_to_their_size_some_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """The steps above reach beyond what the step before foretells."""
    monkeypatch.setattr("cosserat_casadi.numerics.given_step.LEAST_GROWTH", 1.0)
    assert in_given_steps("tendon_robot_move", 0.03, 0.21, "gauss").outcome is StepOutcome.NOT_SOLVED


@pytest.mark.slow
def test_a_jacobian_at_each_stage_finds_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is found so is what one Jacobian finds, where both find it."""
    plain = in_given_steps("tendon_robot_move", 0.01, 0.1, "radau")
    monkeypatch.setattr("cosserat_casadi.numerics.step_run.ITERATIONS_OF_GIVEN_STEP", 2)
    coupled = in_given_steps("tendon_robot_move", 0.01, 0.1, "radau")
    assert coupled.completed
    assert coupled.statistics.jacobians > 5 * plain.statistics.jacobians
    assert_allclose(coupled.end.x, plain.end.x, rtol=0, atol=1e-10)
