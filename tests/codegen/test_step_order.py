"""The step in C on reference motions: its order, and the path of the tip."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, discretise, read_scene
from cosserat_casadi.codegen.status import MotionStatus
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.moving_inputs import InputState
from cosserat_casadi.motion.simulate import moving_inputs, started
from cosserat_casadi.numerics.collocation import radau
from tests import moving_scenes
from tests.codegen.libraries import Exported, exported
from tests.codegen.motions import EXACT
from tests.conftest import case_files
from tests.motion.stepping import moving_model, orders, stepped

CASES = {path.stem: path for path in case_files("dynamics")}
needs_cases = pytest.mark.skipif(not CASES, reason="the reference cases are not beside this checkout")

OFF = {"release_damped": 2.5e-2, "planar_release": 5e-3, "shaken": 1e-2, "space_push": 1.5e-2, "flying": 2.5e-2}
"""Distance of the paths over the length that so few modes leave."""


@dataclass(frozen=True)
class Halvings:
    """Steps that show an order.

    Attributes:
        duration: s.
        count: of the longest steps; it is doubled twice.
        exact: steps of the exact motion, by a method of order five.
    """

    duration: float
    count: int
    exact: int


HALVINGS = {
    "release_damped": Halvings(0.2, 40, 200),
    # Waves of shear without damping: shorter steps resolve them.
    "space_push": Halvings(0.02, 100, 200),
    "flying": Halvings(0.02, 200, 200),
}


@dataclass(frozen=True)
class Case:
    """A reference case on few modes."""

    name: str
    dynamics: bool = True

    def model(self) -> Model:
        scene = read_scene(CASES[self.name]).with_motion_inputs()
        return build(scene, discretise(scene, 3, 9), moving=True)


@pytest.fixture(scope="module")
def case(workshop: Path) -> Callable[[str], Exported]:
    return lambda name: exported(f"case_{name}", Case(name), workshop)


def path_of(made: Exported, duration: float, count: int) -> tuple[list[FloatArray], FloatArray]:
    """Unknowns after each of some equal steps from the start that the case says, and the inputs at their ends."""
    model = made.model
    course = moving_inputs(model)
    dt = duration / count
    states = [course.at(k * dt) for k in range(count + 1)]
    values = np.array([state.value for state in states])
    simulation = model.scene.simulation
    assert simulation is not None
    state = made.compiled.rest(values[0], started(model, simulation, None).x)
    assert state is not None
    memory = made.compiled.step_memory()
    path = [state.x]
    for k in range(count):
        rate = states[k].rate
        acceleration = (states[k + 1].rate - rate) / dt
        step = made.compiled.step(state, dt, values[k], rate, acceleration, memory=memory, options=EXACT)
        assert step.done, step.status.value
        state = step.state
        path.append(state.x)
    return path, values


@pytest.mark.slow
@needs_cases
@pytest.mark.parametrize("name", list(HALVINGS))
def test_order_three(case: Callable[[str], Exported], name: str) -> None:
    """Errors of the unknowns beside Radau IIA with three stages in Python, of order five."""
    made = case(name)
    halvings = HALVINGS[name]
    duration = halvings.duration
    exact = stepped(made.model, radau(3), duration / halvings.exact, duration, made.model.unloaded()).end.x
    counts = [halvings.count * factor for factor in (1, 2, 4)]
    errors = [np.abs(path_of(made, duration, count)[0][-1] - exact).max() for count in counts]
    assert_allclose(orders(errors), 3.0, rtol=0, atol=0.25)


# A base that is shaken

SHAKEN = moving_scenes.scene(
    moving_scenes.rod(
        strain="planar",
        length=0.5,
        stiffness={"bending_y": 0.02},
        linear_density=0.3,
        damping={"bending_y": 1e-3},
        base={"position": [0, 0, 0]},
    ),
    loads=[{"name": "weight", "kind": "gravity", "acceleration": [0, 0, -2.0]}],
    motions=[
        {
            "input": "a.base.position",
            "amplitude": [0.05, 0, 0.02],
            "frequency": 1.5,
            "wave": "sine",
            "phase": 0.4,
        }
    ],
    simulation={"duration": 0.4, "start": "unloaded"},
)

Course = Sequence[InputState]
"""The inputs at the ends of all steps."""

StepPath = tuple[FloatArray, FloatArray, FloatArray]
"""Inputs and rates at the start of a step, accelerations in it."""


class Shaken:
    """A soft rod whose base follows a sine."""

    dynamics = True

    def model(self) -> Model:
        return moving_model(SHAKEN)


def straight(course: Course, dt: float) -> list[FloatArray]:
    """None at all."""
    return [0.0 * state.acceleration for state in course[:-1]]


def as_it_begins(course: Course, dt: float) -> list[FloatArray]:
    """That at the start of each step."""
    return [state.acceleration for state in course[:-1]]


def change_of_rate(course: Course, dt: float) -> list[FloatArray]:
    """With which rates do not jump; positions do, by dt³."""
    return [(after.rate - state.rate) / dt for state, after in pairwise(course)]


ORDERS: dict[Callable[[Course, float], list[FloatArray]], float] = {
    straight: 0.0,
    as_it_begins: 1.0,
    change_of_rate: 2.0,
}
"""Where accelerations are off by dt^p, rates jump by dt^(p + 1) at the end of each step. These impulses are not felt;
they add up to dt^p. With the change of the rate there are none, but displacements of dt³ in each step."""


@pytest.fixture(scope="module")
def shaken(workshop: Path) -> Exported:
    return exported("shaken_base", Shaken(), workshop)


def errors_of_shaken(made: Exported, paths: Callable[[Course, float], Iterable[StepPath]]) -> list[float]:
    """Errors of the unknowns beside Radau IIA with three stages in Python, of order five, at halved steps."""
    duration = 0.4
    course = moving_inputs(made.model)
    x = made.model.unloaded()
    exact = stepped(made.model, radau(3), duration / 100, duration, x).end.x
    errors = list[float]()
    for count in (20, 40, 80):
        dt = duration / count
        states = [course.at(k * dt) for k in range(count + 1)]
        state = made.compiled.rest(states[0].value, x)
        assert state is not None
        memory = made.compiled.step_memory()
        for path in paths(states, dt):
            step = made.compiled.step(state, dt, *path, memory=memory, options=EXACT)
            assert step.done
            state = step.state
        errors.append(float(np.abs(state.x - exact).max()))
    return errors


def test_a_base_that_moves_without_an_acceleration_is_refused(shaken: Exported) -> None:
    """Its step would be wrong without a word; zeros are an acceleration, and a base at rest needs none."""
    begin = moving_inputs(shaken.model).at(0.0)
    state = shaken.compiled.rest(begin.value, shaken.model.unloaded())
    assert state is not None
    refused = shaken.compiled.step(state, 1e-3, begin.value, begin.rate)
    assert refused.status is MotionStatus.NO_ACCELERATION
    assert_allclose(refused.state.x, state.x, rtol=0, atol=0)
    several, *_ = shaken.compiled.steps(state, 1e-3, 2, begin.value, begin.rate)
    assert several.status is MotionStatus.NO_ACCELERATION
    assert shaken.compiled.step(state, 1e-3, begin.value, begin.rate, 0.0 * begin.rate).done
    assert shaken.compiled.step(state, 1e-3, begin.value).done


@pytest.mark.parametrize("accelerations", list(ORDERS), ids=lambda function: function.__name__)
def test_order_with_accelerations_of_a_shaken_base(
    shaken: Exported, accelerations: Callable[[Course, float], list[FloatArray]]
) -> None:
    """What the page on C says of each."""

    def paths(course: Course, dt: float) -> Iterable[StepPath]:
        for state, acceleration in zip(course, accelerations(course, dt), strict=False):
            yield state.value, state.rate, acceleration

    errors = errors_of_shaken(shaken, paths)
    assert_allclose(orders(errors), ORDERS[accelerations], rtol=0, atol=0.2)


def test_order_three_of_a_base_whose_rate_does_not_jump(shaken: Exported) -> None:
    """Along the path of second degree in each step and continuous rate that goes through the positions: off by dt³."""

    def paths(course: Course, dt: float) -> Iterable[StepPath]:
        rate = course[0].rate
        for state, after in pairwise(course):
            acceleration = 2.0 * ((after.value - state.value) / dt - rate) / dt
            yield state.value, rate, acceleration
            rate = rate + dt * acceleration

    errors = errors_of_shaken(shaken, paths)
    assert_allclose(orders(errors), 3.0, rtol=0, atol=0.25)


@pytest.mark.slow
@needs_cases
@pytest.mark.parametrize("name", OFF)
def test_path_of_the_tip_vs_independent_program(case: Callable[[str], Exported], name: str) -> None:
    made = case(name)
    wanted = json.loads(CASES[name].with_suffix(".json").read_text())["expected"]
    times = np.array(wanted["times"])
    # So many steps that each time is at the end of one.
    spacing = np.diff(times).min()
    each = max(1, round(spacing / 2e-3))
    count = round(times[-1] / spacing) * each
    path, values = path_of(made, times[-1], count)
    places = np.round(times / times[-1] * count).astype(int)
    tips = np.array([made.tips(path[k], values[k])[0] for k in places])
    distances = np.linalg.norm(tips - np.array(wanted["tip"]), axis=1)
    assert distances.max() <= OFF[name] * made.length
