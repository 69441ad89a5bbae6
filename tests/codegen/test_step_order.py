"""The step in C on reference motions: its order, and the path of the tip."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, discretise, read_scene
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.simulate import moving_inputs, started
from cosserat_casadi.numerics.collocation import radau
from tests.codegen.libraries import Exported, exported
from tests.codegen.motions import EXACT
from tests.conftest import case_files
from tests.motion.stepping import orders, stepped

CASES = {path.stem: path for path in case_files("dynamics")}
pytestmark = pytest.mark.skipif(not CASES, reason="the reference cases are not beside this checkout")

OFF = {"release_damped": 2.5e-2, "planar_release": 5e-3}
"""Distance of the paths over the length that so few modes leave."""


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
    inputs = moving_inputs(model)
    dt = duration / count
    values = np.array([inputs.at(k * dt).value for k in range(count + 1)])
    simulation = model.scene.simulation
    assert simulation is not None
    state = made.compiled.rest(values[0], started(model, simulation, None).x)
    assert state is not None
    memory = made.compiled.step_memory()
    path = [state.x]
    for k in range(count):
        rate = (values[k + 1] - values[k]) / dt
        step = made.compiled.step(state, dt, values[k], rate, memory=memory, options=EXACT)
        assert step.done, step.status.value
        state = step.state
        path.append(state.x)
    return path, values


def test_order_three(case: Callable[[str], Exported]) -> None:
    """Errors of the unknowns beside Radau IIA with three stages in Python, of order five, at a damped rod let go."""
    made = case("release_damped")
    duration = 0.2
    exact = stepped(made.model, radau(3), 1e-3, duration, made.model.unloaded()).end.x
    errors = [np.abs(path_of(made, duration, count)[0][-1] - exact).max() for count in (40, 80, 160)]
    assert_allclose(orders(errors), 3.0, rtol=0, atol=0.25)


@pytest.mark.parametrize("name", list(OFF))
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
