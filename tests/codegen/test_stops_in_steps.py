"""Rigid stops of joints in steps in C: closed forms, simulated motions, differences, friction beside them."""

from __future__ import annotations

import copy
from pathlib import Path

import fmpy
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import ExportError, Motion, build, export, scene_from_dict, simulate
from cosserat_casadi.codegen.compiled_motion import StepState
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.codegen.status import MotionStatus
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.test_steps_in_contact import Moving, compare_with_differences
from tests.model.test_base_joints import GRAVITY
from tests.model.test_joint_stops import BOUND, INERTIA, MASS, WEIGHT, lever
from tests.motion.test_stops_beside_contact import sliding

pytestmark = pytest.mark.slow  # A compiler runs for each scene.


def test_a_lever_bounces_and_rests_on_its_stop(tmp_path: Path) -> None:
    """A stop gives back its share of the energy of the fall; at last its push bears the weight."""
    share, dt, count = 0.5, 1e-3, 400
    made = Moving(lever(restitution=share, upper_stop=1.0), tmp_path)
    compiled, entry = made.compiled, made.model.discrete.coordinate(made.model.discrete.stops[0].placed).start
    state, memory = compiled.rest(), compiled.step_memory()
    assert state is not None
    rows = []
    for _ in range(count):
        step = compiled.step(state, dt, {}, memory=memory)
        assert step.done
        state = step.state
        effort, angle, push = (float(value) for value in compiled.joint["hinge"](state.x, compiled.defaults))
        rows.append((angle, float(state.v[entry]), effort, push))
        contacts = compiled.step_contacts(memory)
        assert [(one.owner, one.obstacle) for one in contacts] == ([("hinge", "lower_stop")] if push > 1e-9 else [])
        # Nothing but its stops acts along the joint.
        assert_allclose(effort, push, rtol=1e-9, atol=1e-9)
    angles, rates, _, pushes = np.array(rows).T
    energies = INERTIA * rates**2 / 2 + WEIGHT * np.sin(angles)
    fallen = WEIGHT * np.sin(BOUND)
    motion = simulate(scene_from_dict(lever(restitution=share)))
    blows = [event.time for event in motion.events if event.kind == "stop_hit"]
    times = dt * np.arange(1, count + 1)
    for begin, end, kept in ((0.0, blows[0], 1.0), (blows[0], blows[1], share**2), (blows[1], blows[2], share**4)):
        flies = (times > begin) & (times < end)
        assert flies.sum() > 20
        assert_allclose(energies[flies] + fallen, kept * fallen, rtol=0, atol=1e-5 * fallen)
        assert np.all(pushes[flies] == 0.0)
    assert_allclose(np.interp(motion.times[1:], times, angles), angles_of(motion)[1:], rtol=0, atol=1e-6)
    assert_allclose([angles[-1], rates[-1], pushes[-1]], [-BOUND, 0.0, WEIGHT * np.cos(BOUND)], rtol=0, atol=1e-7)
    (held,) = compiled.step_contacts(memory)
    assert_allclose(held.force, pushes[-1], rtol=1e-9, atol=0)
    # The way of a solve may lead beyond a stop, which its equations have.
    assert compiled.solve().converged
    # What begins beyond its stop is told.
    deeper = simulate(scene_from_dict(lever(restitution=share, upper_stop=1.0, lower_stop=-BOUND - 0.01)))
    beyond = StepState(deeper.x[-1], 0 * state.v, 0 * state.a)
    assert compiled.step(beyond, dt, {}).status is MotionStatus.NOT_SOLVED


def test_a_body_on_a_slide_strikes_its_stop_and_rests_there(tmp_path: Path) -> None:
    """A push in N, a way in m: both stops of one joint, of which one is met with √(2 g d) and bears the weight."""
    way, share, dt = 0.05, 0.5, 1e-3
    slide = {"kind": "prismatic", "axis": [0, 0, 1], "lower_stop": -way, "upper_stop": way, "restitution": share}
    made = Moving(lever(**slide), tmp_path)
    compiled = made.compiled
    state, memory = compiled.rest(), compiled.step_memory()
    assert state is not None
    fall = np.sqrt(2 * way / GRAVITY)
    rebound = share * np.sqrt(2 * GRAVITY * way)
    heights = []
    for number in range(1, 601):
        state = compiled.step(state, dt, {}, memory=memory).state
        heights.append(float(made.model.body["lever"](state.x, made.model.pack())[0][2]))
        since = number * dt - fall
        fallen = GRAVITY * (number * dt) ** 2 / 2 if since < 0.0 else way - rebound * since + GRAVITY * since**2 / 2
        if since < 2 * rebound / GRAVITY:
            assert_allclose(heights[-1], heights[0] + GRAVITY * dt**2 / 2 - fallen, rtol=0, atol=1e-7)
    assert_allclose(heights[-1], heights[0] - way, rtol=0, atol=1e-5)
    (held,) = compiled.step_contacts(memory)
    _, _, push = compiled.joint["hinge"](state.x, compiled.defaults)
    assert_allclose([held.force, abs(float(push))], MASS * GRAVITY, rtol=1e-6, atol=0)


def angles_of(motion: Motion) -> FloatArray:
    """Angles of the lever, negative below the horizontal, rad, shape (T,)."""
    return np.asarray(motion.joint("hinge").conjugate)


@pytest.mark.parametrize("moment", [0.0, 0.4])
def test_derivatives_on_and_off_a_stop(moment: float, tmp_path: Path) -> None:
    """A motor of 0.4 N m lifts the lever, which rests on its stop without."""
    made = Moving(lever(moment=0.0), tmp_path)
    state, memory = made.compiled.rest(), made.compiled.step_memory()
    for number in range(150):
        lifts = moment if number >= 130 else 0.0
        state = made.compiled.step(state, 2e-3, {"hinge.moment": lifts}, memory=memory).state
    assert bool(made.compiled.step_contacts(memory)) == (moment == 0.0)
    compare_with_differences(made, state, copy.deepcopy(memory), 2e-3, of_load=(1e-2, 1.0, 1e3), least=1e-11)


@pytest.mark.parametrize("start", ["unloaded", "equilibrium"])
def test_an_fmu_takes_these_steps(start: str, tmp_path: Path) -> None:
    tables = lever(restitution=0.5)
    tables["simulation"]["start"] = start
    made = Moving(tables, tmp_path)
    unit = write_fmu(made.model, tmp_path / "robot.fmu", "robot")
    height = "lever.position.z"
    found = fmpy.simulate_fmu(str(unit), stop_time=0.4, step_size=1e-3, output_interval=1e-3, output=[height])
    state, memory = made.compiled.contact_start(), made.compiled.step_memory()
    wanted = []
    for _ in range(400):
        state = made.compiled.step(state, 1e-3, {}, memory=memory).state
        wanted.append(float(made.model.body["lever"](state.x, made.model.pack())[0][2]))
    assert_allclose(found[height][1:], wanted, rtol=0, atol=1e-9)
    if start == "equilibrium":
        assert made.compiled.step_contacts(memory)
        assert_allclose(found[height], found[height][0], rtol=0, atol=1e-9)


def test_a_gpu_is_refused_beside_them(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="not written for a GPU"):
        export(build(scene_from_dict(lever())), tmp_path / "robot", dynamics=True, cuda=True)


@pytest.mark.parametrize("reach", [0.2, 0.4])
def test_a_stop_beside_friction_acts_as_in_simulated_motions(reach: float, tmp_path: Path) -> None:
    """A ball that slides on a floor is jerked off by the stop of its upper link, or pressed on."""
    tables = sliding(reach)
    tables["obstacles"][0]["friction"] = 0.2
    motion = simulate(scene_from_dict(tables))
    assert motion.converged
    made = Moving(tables, tmp_path)
    state, memory = made.compiled.contact_start(), made.compiled.step_memory()
    for _ in range(460):
        step = made.compiled.step(state, 5e-4, {}, memory=memory)
        assert step.done
        state = step.state
    position = made.model.body["lower"](state.x, made.model.pack())[0].full()
    assert_allclose(position.ravel(), motion.body("lower").position[-1], rtol=0, atol=1e-6)
    (held,) = [one for one in made.compiled.step_contacts(memory) if one.owner == "shoulder"]
    assert held.force > 0.0
