"""Rods that touch rods without a width, in steps of motions in C: the simulator, momentum, differences, FMUs, C++."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, scene_from_dict, simulate
from cosserat_casadi.codegen.compiled_motion import StepState
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.maths.calls import functions_within, is_routine
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.surface_sliding import SurfaceSliding
from tests.codegen.libraries import C99, gcc, run
from tests.codegen.test_steps_in_contact import Moving, compare_with_differences
from tests.motion.test_rods_that_strike_rods import RADIUS, free_rods, momentum, rod, scene

Tables = dict[str, Any]

FRICTION = 0.3


def thrown_steps(made: Moving, v: FloatArray, step: float) -> list[StepState]:
    """States at the ends of steps from the start with these rates."""
    model, compiled = made.model, made.compiled
    start, memory = compiled.contact_start(), compiled.step_memory()
    states = [StepState(start.x, v, start.a)]
    for _ in range(round(0.03 / step)):
        taken = compiled.step(states[-1], step, model.pack(), memory=memory)
        assert taken.done, taken.status.value
        states.append(taken.state)
    return states


def pressed(friction: float, drag: float, damping: float = 0.02) -> Tables:
    """Two clamped rods that cross askew: a force presses the upper one down, and drags it over the lower one."""
    upper = rod("upper", {"position": [0, 0, 2 * RADIUS + 4e-4], "tangent": [1, 0, 0]}, [6e-3, 4e-3])
    lower = rod("lower", {"position": [-0.024, -0.168, 0], "tangent": [0.8, 0.6, 0]}, [8e-3, 4e-3])
    damped = [own | {"damping": {"retardation_time": damping}} for own in (upper, lower)]
    push = {"name": "push", "kind": "tip_wrench", "rod": "upper", "force": [0, drag, -0.1]}
    tables = scene(damped, 0.1, loads=[push], inputs=["push.force"])
    tables["rod_contacts"][0] |= {"friction": friction} if friction else {}
    tables["simulation"] |= {"start": "unloaded"}
    return tables


def off_momentum(made: Moving, states: list[StepState]) -> float:
    """Largest change of momentum and angular momentum over their largest part."""
    whole = np.array([momentum(made.model, state.x, state.v) for state in (states[0], states[-1])])
    return float(np.abs(whole[1] - whole[0]).max() / np.abs(whole[0]).max())


def test_steps_that_rub_are_the_simulators(tmp_path: Path) -> None:
    """The lower rod is drawn along below the upper one, which is pressed on it: both places slide."""
    step, speed, count = 1e-3, [0.3, 0.2, 0.0], 60
    tables = pressed(FRICTION, 0.0)
    for own in tables["rods"]:
        own |= {"strain": "planar"}
    begin = np.array(tables["rods"][1]["base"]["position"])
    end = begin + np.array(speed) * step * count
    drawn = {"input": "lower.base.position", "times": [0.0, step * count], "values": [begin.tolist(), end.tolist()]}
    tables |= {"accuracy": {"modes": 1, "nodes": 4}, "motions": [drawn], "inputs": ["lower.base.position"]}
    tables["simulation"] |= {"duration": step * count, "step": step, "frames": count + 1, "tolerance": 1e-3}
    made = Moving(tables, tmp_path)
    motion = simulate(made.model)
    memory = made.compiled.step_memory()
    states = [made.compiled.contact_start()]
    for k in range(count):
        inputs = begin + np.array(speed) * step * k
        taken = made.compiled.step(states[-1], step, inputs, speed, np.zeros(3), memory=memory)
        assert taken.done, taken.status.value
        states.append(taken.state)
    assert_allclose([state.x for state in states], motion.x, rtol=0, atol=1e-9)
    (contact,), (in_python,) = made.compiled.step_contacts(memory), motion.contacts[-1]
    assert (contact.owner, contact.obstacle, contact.of_body, contact.slips) == ("upper", "lower", False, True)
    assert_allclose((contact.place, contact.at_other), (in_python.at, in_python.at_other), rtol=0, atol=1e-9)
    assert_allclose(np.linalg.norm(contact.friction), FRICTION * contact.force, rtol=1e-6, atol=0)
    source = tmp_path / "robot" / "robot.c"
    gcc(*C99, "-Werror", "-fsyntax-only", source)
    if shutil.which("g++") is not None:
        run("g++", "-x", "c++", "-std=c++20", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-fsyntax-only", source)


def test_functions_of_pairs_are_those_of_both_rods() -> None:
    """Each function of a pair calls one routine for each of its rods; an input moves the base of the third rod."""
    tables = free_rods()
    base = {"position": [0.1, -0.1, -0.03], "tangent": [0.6, 0.8, 0]}
    third = tables["rods"][1] | {"name": "third", "base": base}
    tables |= {"rods": [*tables["rods"], third], "inputs": ["third.base.position"]}
    tables["rod_contacts"] = [{"exact": True, "friction": FRICTION}]
    model = build(scene_from_dict(tables | {"accuracy": {"modes": 1, "nodes": 3}}), moving=True)
    rng = np.random.default_rng(4)
    x, v = (model.unloaded() + 0.05 * rng.normal(size=model.size) for _ in range(2))
    inputs, rate = model.pack(), rng.normal(size=model.inputs.size)
    names = set()
    for facing in facings(model):
        points, functions = facing.points, facing.points.in_steps
        weights = rng.normal(size=3 * points.count)
        moved, _ = points.straight_on(x, inputs, v, rate)
        wanted = {
            "positions": points.positions(x, inputs),
            "velocities": moved,
            "gradient": points.gradient(x, inputs, weights),
            "hessian": points.hessian(x, inputs, weights),
            "by_inputs": points.by_inputs(x, inputs, weights),
        }
        further = {"positions": [], "velocities": [v, rate]}
        for word, function in functions.items():
            found = function.call([x, inputs, *further.get(word, [weights])])[0]
            assert_allclose(found.full().ravel(), np.ravel(wanted[word]), rtol=1e-12, atol=1e-13)
            names |= {each.name() for each in functions_within(function) if is_routine(each)}
    # A base that moves without turning moves all points alike, which is no routine.
    assert names == {f"rod_{k}_{word}" for k in range(3) for word in wanted if word != "by_inputs"}
    assert "by_inputs" in functions


def test_power_of_friction_is_the_force_along_the_velocity() -> None:
    """The gradients of the sliding by the rates, one routine, are those of the velocity, another one."""
    model = build(scene_from_dict(pressed(FRICTION, 0.0) | {"accuracy": {"modes": 2, "nodes": 5}}), moving=True)
    (facing,) = facings(model)
    rng = np.random.default_rng(5)
    x, v = 0.1 * rng.normal(size=(2, model.size))
    inputs, rate = model.pack(), np.zeros(model.inputs.size)
    # Velocities are linear in the rates for any weights of the nodes.
    section = np.concatenate([rng.uniform(0.5, 1.0, facing.points.count) / facing.points.count, [0.4, 0.6]])
    function = SurfaceSliding(facing).function
    axis = np.array([1.0, 0.2, 0.1])
    sliding, by_v, _ = function(x, inputs, v, rate, section, axis)
    assert_allclose(by_v.full().T @ v, sliding.full().ravel(), rtol=1e-12, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.0, 0.6])
def test_steps_converge_to_the_simulators_and_keep_momentum(share: float, tmp_path: Path) -> None:
    """Without friction the simulator goes from event to event."""
    tables = free_rods(share)
    tables["velocities"] = [{"rod": "upper", "linear": [0.3, 0.1, -0.5]}]
    tables["simulation"] |= {"start": "unloaded", "tolerance": 1e-7}
    made = Moving(tables, tmp_path)
    motion = simulate(made.model)
    assert motion.events[0].kind == "impact"
    found = [thrown_steps(made, motion.v[0], step) for step in (1e-3, 2.5e-4)]
    errors = [np.abs(states[-1].x - motion.x[-1]).max() for states in found]
    offs = [off_momentum(made, states) for states in found]
    assert errors[1] < errors[0] / 8
    assert errors[1] < 1e-5
    assert offs[1] < offs[0] / 20
    assert offs[1] < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "drag", "damping"), [(0.0, -0.05, 0.02), (0.3, -0.05, 0.02), (0.9, 0.0, 0.2)])
def test_derivatives_of_a_step_are_those_of_differences(
    friction: float, drag: float, damping: float, tmp_path: Path
) -> None:
    """Bases of both rods move; the upper one slides along both rods, or sticks."""
    tables = pressed(friction, drag, damping)
    made = Moving(tables | {"inputs": ["push.force", "upper.base.position", "lower.base.position"]}, tmp_path)
    memory = made.compiled.step_memory()
    start = made.steps(1e-3, 150, memory)[-1]
    (contact,) = made.compiled.step_contacts(memory)
    assert contact.slips == (friction < 0.9)
    of_load = (1e-4, 1e-1, 1e2)
    compare_with_differences(made, start, memory, 1e-3, of_load=of_load, by_start=5e-6, least=1e-9)


@pytest.mark.slow
def test_an_fmu_takes_the_steps_of_the_library(tmp_path: Path) -> None:
    made = Moving(pressed(FRICTION, -0.05), tmp_path)
    unit = write_fmu(made.model, tmp_path / "robot.fmu", "robot")
    places = [f"upper.tip.position.{axis}" for axis in "xyz"]
    found = fmpy.simulate_fmu(str(unit), stop_time=0.15, step_size=1e-3, output_interval=1e-3, output=places)
    states = made.steps(1e-3, 150)
    tips = [made.model.tip["upper"](state.x, made.model.pack())[0].full()[:, 0] for state in states]
    assert_allclose([[row[place] for place in places] for row in found], tips, rtol=0, atol=1e-9)
