"""Steps of motions in C in exact contact: against a linear beam, against steps in Python, closed forms, differences."""

from __future__ import annotations

import copy
import json
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, export, load, read_scene, scene_from_dict, simulate
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.compiled_motion import StepMemory, StepOptions, StepState
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.codegen.status import MotionStatus
from cosserat_casadi.errors import ExportError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.simulate import moving_inputs
from tests.derivatives import central_differences
from tests.motion.test_exact_contact_in_motion import beam_on_a_stop
from tests.moving_scenes import gaps_along

LENGTH = 0.4
WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
BALL = {"name": "ball", "kind": "sphere", "centre": [0.25, 0, -0.09], "radius": 0.03}
EXACT = StepOptions(tolerance=1e-14, iterations=20)


def floor(height: float, **more: Any) -> dict[str, Any]:
    return {"name": "floor", "kind": "plane", "point": [0, 0, height], "normal": [0, 0, 1], **more}


def rod(**more: Any) -> dict[str, Any]:
    return {
        "name": "rod",
        "length": LENGTH,
        "strain": "planar",
        "stiffness": {"bending_y": 0.016},
        "linear_density": 0.2,
        "rotary_inertia": [1e-7, 1e-7, 2e-7],
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
        "damping": {"retardation_time": 0.005},
        **more,
    }


def scene(obstacle: dict[str, Any], record: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    return {
        "schema": 1,
        "accuracy": {"modes": 3, "nodes": 12, "tolerance": 1e-4},
        "loads": [WEIGHT],
        "obstacles": [obstacle],
        "simulation": {"duration": 0.4, "start": "unloaded", "tolerance": 1e-5},
        "rods": [record or rod()],
        **more,
    }


@dataclass
class Moving:
    """A scene, its model, and its exported folder.

    Attributes:
        tables: the scene.
        folder: where it is exported.
    """

    tables: dict[str, Any]
    folder: Path

    @cached_property
    def model(self) -> Model:
        return build(scene_from_dict(self.tables), moving=True)

    @cached_property
    def compiled(self) -> Compiled:
        made = load(export(self.model, self.folder / "robot", dynamics=True))
        assert isinstance(made, Compiled)
        return made

    def steps(self, dt: float, count: int, memory: StepMemory | None = None) -> list[StepState]:
        """States at the ends of steps from the start of the scene."""
        kept = memory or self.compiled.step_memory()
        states = [self.compiled.contact_start()]
        for _ in range(count):
            step = self.compiled.step(states[-1], dt, self.model.pack(), memory=kept)
            assert step.done, step.status.value
            states.append(step.state)
        return states

    def tips(self, states: Sequence[Any]) -> FloatArray:
        """Positions of the tip over the length, shape (k, 3)."""
        name = self.model.scene.rods[0].name
        poses = [self.model.tip[name](state.x, self.model.pack())[0] for state in states]
        return np.array([pose.full()[:, 0] for pose in poses]) / LENGTH

    def energies(self, states: Sequence[Any]) -> FloatArray:
        inputs = self.model.pack()
        parts = [self.model.energies(state.x, state.v, inputs, 0.0 * inputs)[:3] for state in states]
        return np.array([sum(float(part) for part in row) for row in parts])

    def least_gap(self, states: Sequence[Any]) -> float:
        """The least gap at any section of any state, over the length."""
        return min(
            facing.deepest(facing.nodes(state.x, self.model.pack())).gap
            for state in states
            for facing in facings(self.model)
        )


def test_a_beam_falls_on_a_stop_as_a_linear_beam_does(tmp_path: Path) -> None:
    depth, stiffness = 4e-4, 20.0
    record = rod(stiffness={"bending_y": stiffness}, damping={"retardation_time": 1e-4})
    made = Moving(scene(floor(-depth), record), tmp_path)
    counts = 40, 160, 640
    errors = []
    for count in counts:
        times = np.linspace(0.0, 0.04, count + 1)
        deflections, impacts, _ = beam_on_a_stop(depth, stiffness, times)
        assert len(impacts) >= 3
        states = made.steps(0.04 / count, count)
        errors.append(np.abs(made.tips(states)[:, 2] * LENGTH - deflections).max() / depth)
        # Neither a blow nor a step gives energy.
        assert np.diff(made.energies(states)).max() <= 1e-12
        assert made.least_gap(states) >= -2e-7
    # Lift-off in the course of a step leaves the second power of its length; 1e-4 is what is not linear.
    assert errors[1] < errors[0] / 8.0
    assert errors[2] < 2e-3


def test_steps_are_those_of_python_and_converge(tmp_path: Path) -> None:
    made = Moving(scene(BALL | {"restitution": 0.5}), tmp_path)
    motion = simulate(made.model)
    assert motion.converged, motion.message
    assert sum(event.kind == "impact" for event in motion.events) > 8
    errors = []
    for dt in (4e-3, 1e-3):
        count = round(0.4 / dt)
        memory = made.compiled.step_memory()
        states = made.steps(dt, count, memory)
        wanted = made.tips([motion.at(min(dt * k, 0.4)) for k in range(count + 1)])
        errors.append(np.linalg.norm(made.tips(states) - wanted, axis=1).max())
        assert np.diff(made.energies(states)).max() <= 1e-9
        assert made.least_gap(states) >= -2e-7
        (contact,) = made.compiled.step_contacts(memory)
        (in_python,) = motion.contacts[-1]
        assert (contact.owner, contact.obstacle, contact.of_body) == ("rod", "ball", False)
        assert_allclose(contact.place, in_python.at, rtol=0, atol=1e-4)
        assert_allclose(contact.force, np.linalg.norm(in_python.force), rtol=0.05, atol=0)
    assert errors[1] < errors[0] / 4.0
    assert errors[1] < 2e-5


@pytest.mark.slow
def test_a_straight_rod_that_falls_flat_bounces_as_a_point_does(tmp_path: Path) -> None:
    base = {"position": [0, 0, 0.0], "tangent": [1, 0, 0], "free": True}
    made = Moving(scene(floor(-0.05, restitution=0.5), rod(base=base)), tmp_path)
    dt, g = 2e-3, 9.81
    memory = made.compiled.step_memory()
    states = made.steps(dt, 160, memory)
    first = np.sqrt(2 * 0.05 / g)
    speed, began = 0.5 * g * first, first
    heights = []
    for time in dt * np.arange(161):
        while time > began + 2 * speed / g and speed > 1e-6:
            began += 2 * speed / g
            speed *= 0.5
        flown = time - began
        heights.append(0.05 - g * time**2 / 2 if flown < 0 else max(0.0, speed * flown - g * flown**2 / 2))
    found = made.tips(states)[:, 2] * LENGTH + 0.05
    # Blows less than a step apart are one.
    assert_allclose(found, heights, rtol=0, atol=5e-6)
    assert_allclose(found[-1], 0.0, rtol=0, atol=1e-7)
    weight = sum(contact.force for contact in made.compiled.step_contacts(memory))
    assert_allclose(weight, 0.2 * LENGTH * g, rtol=1e-6, atol=0)


@pytest.mark.slow
def test_a_free_rod_strikes_a_floor_end_after_end(tmp_path: Path) -> None:
    base = {"position": [0, 0, 0.05], "tangent": [1, 0, 0.3], "free": True}
    made = Moving(scene(floor(-0.1), rod(base=base, stiffness={"bending_y": 0.5})), tmp_path)
    motion = simulate(made.model)
    assert motion.converged, motion.message
    states = made.steps(1e-3, 400)
    wanted = made.tips([motion.at(min(1e-3 * k, 0.4)) for k in range(401)])
    assert_allclose(made.tips(states), wanted, rtol=0, atol=1e-3)
    assert np.diff(made.energies(states)).max() <= 1e-9
    assert made.least_gap(states) >= -2e-7


@pytest.mark.slow
def test_a_soft_rod_rolls_onto_its_tip_and_back(tmp_path: Path) -> None:
    base = {"position": [0, 0, 0.0], "tangent": [1, 0, 0.1], "free": True}
    record = rod(base=base, stiffness={"bending_y": 0.005}, damping={"retardation_time": 0.02})
    tables = scene(floor(-0.1), record, accuracy={"modes": 4, "nodes": 12, "tolerance": 1e-4})
    made = Moving(tables, tmp_path)
    motion = simulate(made.model)
    # A section that rolls ever faster towards the tip, which strikes, is no section that slides there.
    assert [event.place for event in motion.events if event.kind == "impact"][:2] == [0.0, 1.0]
    states = made.steps(5e-4, 800)
    wanted = made.tips([motion.at(min(5e-4 * k, 0.4)) for k in range(801)])
    assert_allclose(made.tips(states), wanted, rtol=0, atol=5e-4)
    assert np.diff(made.energies(states)).max() <= 1e-9
    assert made.least_gap(states) >= -2e-7


@pytest.mark.slow
def test_rods_that_join_and_two_obstacles_at_once(tmp_path: Path) -> None:
    second = rod(name="second", length=0.2, base={"rod": "rod", "at": 1.0})
    tables = scene(BALL, accuracy={"modes": 2, "nodes": 8, "tolerance": 1e-4})
    tables |= {"obstacles": [floor(-0.12), BALL], "rods": [rod(), second]}
    made = Moving(tables, tmp_path)
    motion = simulate(made.model)
    memory = made.compiled.step_memory()
    states = made.steps(1e-3, 400, memory)
    wanted = made.tips([motion.at(min(1e-3 * k, 0.4)) for k in range(401)])
    assert_allclose(made.tips(states), wanted, rtol=0, atol=5e-4)
    assert len(made.compiled.step_contacts(memory)) == len(motion.contacts[-1])


@pytest.mark.slow
@pytest.mark.parametrize("friction", [None, 1e-9])
def test_blows_at_once_on_rods_of_other_stiffness_keep_energy(friction: float | None, tmp_path: Path) -> None:
    # Restitution gives back all that both balls take: velocities of both gaps turn round.
    more = {"restitution": 1.0} | ({"friction": friction} if friction else {})
    balls = [
        BALL | {"name": own, "centre": [place, 0, -0.05], "rods": [own], **more}
        for own, place in (("rod", 0.3), ("second", 0.5))
    ]
    undamped = {"damping": {"retardation_time": 1e-12}}
    free = rod(base={"position": [0, 0, 0], "tangent": [1, 0, 0], "free": True}, **undamped)
    stiff = {"stiffness": {"bending_y": 5.0}, **undamped}
    second = rod(name="second", length=0.2, base={"rod": "rod", "at": 1.0}, **stiff)
    tables = scene(BALL, accuracy={"modes": 2, "nodes": 8, "tolerance": 1e-4})
    made = Moving(tables | {"obstacles": balls, "rods": [free, second]}, tmp_path)
    falls = np.sqrt(2 * 0.02 / 9.81)
    memory, states = made.compiled.step_memory(), [made.compiled.contact_start()]
    # The beams ring from the blow on: a step after it is short.
    for dt in (falls - 1e-6, 2e-6):
        step = made.compiled.step(states[-1], dt, made.model.pack(), memory=memory)
        assert step.done
        states.append(step.state)
    falling = 0.2 * 0.6 * 9.81 * 0.02
    assert_allclose(made.energies(states), made.energies(states[:1])[0], rtol=0, atol=1e-6 * falling)
    assert np.abs(states[-1].v - states[-2].v).max() > 0.1


@pytest.mark.slow
def test_the_ball_of_a_body_bounces_on_a_floor_as_in_python(tmp_path: Path) -> None:
    head = {
        "bodies": [{"name": "head", "mass": 0.05, "radius": 0.02}],
        "joints": [{"body": "head", "rod": "rod", "kind": "fixed"}],
    }
    made = Moving(scene(floor(-0.1, bodies=["head"], restitution=0.5), **head), tmp_path)
    motion = simulate(made.model)
    states = made.steps(1e-3, 400)
    wanted = made.tips([motion.at(min(1e-3 * k, 0.4)) for k in range(401)])
    assert_allclose(made.tips(states), wanted, rtol=0, atol=2e-6)
    assert np.diff(made.energies(states)).max() <= 1e-9


@pytest.mark.slow
def test_a_rod_out_of_the_plane_goes_round_a_ball_as_in_python(tmp_path: Path) -> None:
    stiffness = {"bending_y": 0.016, "bending_x": 0.016, "torsion": 0.012}
    record = rod(strain="kirchhoff", stiffness=stiffness)
    made = Moving(scene(BALL | {"centre": [0.25, 0.01, -0.09]}, record), tmp_path)
    motion = simulate(made.model)
    states = made.steps(1e-3, 400)
    wanted = made.tips([motion.at(min(1e-3 * k, 0.4)) for k in range(401)])
    assert_allclose(made.tips(states), wanted, rtol=0, atol=1e-4)
    assert made.least_gap(states) >= -2e-7


def compare_with_differences(
    made: Moving,
    start: StepState,
    memory: StepMemory,
    dt: float,
    *,
    small: float = 1e-8,
    of_load: tuple[float, float, float] = (1.0, 1e3, 1e6),
    by_start: float = 1e-6,
    least: float = 0.0,
) -> None:
    """Hold derivatives of a step by its start and by inputs against differences.

    Args:
        made: the scene.
        start: state at the start.
        memory: what steps remember before.
        dt: the step, s.
        small: change of a coordinate; of a velocity it is that over the step.
        of_load: changes of a load's value, rate and acceleration.
        by_start: largest difference of the derivatives by the start, over the largest derivative.
        least: differences of the derivatives by inputs below which none counts.
    """
    still = np.zeros(made.model.inputs.size)
    given = [made.model.pack(), still, still]
    n = made.model.size

    def end(state: FloatArray, inputs: list[FloatArray]) -> FloatArray:
        begun = StepState(state[:n], state[n:], start.a)
        step = made.compiled.step(begun, dt, *inputs, memory=copy.deepcopy(memory), options=EXACT)
        assert step.done
        return np.concatenate([step.state.x, step.state.v])

    call = made.compiled.step_sensitivity
    step, found = call(start, dt, *given, memory=copy.deepcopy(memory), options=EXACT)
    assert step.done and found is not None
    state = np.concatenate([start.x, start.v])
    halves = (slice(0, n), slice(n, 2 * n))
    differences = central_differences(lambda moved: end(moved, given), state, np.repeat([small, small / dt], n))
    for rows in halves:
        largest = np.abs(found.by_start[rows]).max()
        assert_allclose(found.by_start[rows], differences[rows], rtol=0, atol=by_start * largest)
    moves = [bool(entry.declared.moves) for entry, _ in made.model.inputs for _ in range(entry.size)]
    # A base that moves opens or closes the gap, which stays below what touches.
    of_base = (1e-8, 1e-5, 1e-2)
    for k, derivative in enumerate((found.by_inputs, found.by_inputs_rate, found.by_inputs_acceleration)):
        differences = central_differences(
            lambda moved, k=k: end(state, [*given[:k], moved, *given[k + 1 :]]),  # type: ignore[misc]
            given[k],
            np.where(moves, of_base[k], of_load[k]),
        )
        for column, expected in zip(derivative.T, differences.T, strict=True):
            for rows in halves:
                atol = max(1e-5 * np.abs(expected[rows]).max(), least)
                assert_allclose(column[rows], expected[rows], rtol=0, atol=atol)


@pytest.mark.slow
@pytest.mark.parametrize("moved", [False, True])
def test_derivatives_of_a_step_in_contact_are_those_of_differences(moved: bool, tmp_path: Path) -> None:
    inputs = ["weight.acceleration", *(["rod.base.position"] if moved else [])]
    made = Moving(scene(BALL, inputs=inputs), tmp_path)
    memory = made.compiled.step_memory()
    start = made.steps(1e-3, 160, memory)[-1]
    assert len(made.compiled.step_contacts(memory)) == 1
    compare_with_differences(made, start, memory, 1e-3)


@pytest.mark.slow
def test_a_blow_has_no_derivative_and_a_wire_is_not_passed(tmp_path: Path) -> None:
    wire = {"name": "wire", "kind": "capsule", "from": [0.3, -0.1, -0.05], "to": [0.3, 0.1, -0.05], "radius": 5e-4}
    made = Moving(scene(wire, rod()), tmp_path)
    states = made.steps(2e-3, 60)
    assert made.least_gap(states) >= -2e-7
    motion = simulate(made.model)
    wanted = made.tips([motion.at(2e-3 * k) for k in range(61)])
    assert_allclose(made.tips(states), wanted, rtol=0, atol=2e-3)
    memory, state, without = made.compiled.step_memory(), states[0], 0
    for _ in range(60):
        step, found = made.compiled.step_sensitivity(state, 2e-3, made.model.pack(), memory=memory)
        without += step.done and found is None
        state = step.state
    assert_allclose(state.x, states[-1].x, rtol=0, atol=1e-8)
    assert 1 <= without <= 8
    # What is too fast to be looked at is told.
    fast = StepState(states[0].x, np.array([-60.0, 0.0, 0.0]), states[0].a)
    assert made.compiled.step(fast, 1e-2, made.model.pack()).status is MotionStatus.NOT_SOLVED
    # A solve knows of no contact, and does not go through.
    assert not made.compiled.solve().converged


def test_functions_of_equilibria_and_lengths_as_parameters_are_refused(tmp_path: Path) -> None:
    tables = scene(BALL)
    with pytest.raises(ExportError, match="a folder with --dynamics has no"):
        export(build(scene_from_dict(tables), moving=True), tmp_path / "robot", dynamics=True, stability=True)
    tables["parameters"] = ["rod.length"]
    with pytest.raises(ExportError, match="lengths and sections of rods as fixed numbers"):
        export(build(scene_from_dict(tables), moving=True), tmp_path / "robot", dynamics=True)


@pytest.mark.parametrize("friction", [pytest.param(0.0, marks=pytest.mark.slow), 0.3])
def test_parameters_are_numbers_of_the_scene(friction: float, tmp_path: Path) -> None:
    """Steps with parameters are those of the scene with these numbers; derivatives are differences of steps."""
    rubbing = {"friction": friction} if friction else {}
    for name in ("named", "fixed"):
        (tmp_path / name).mkdir()
    names = ["rod.stiffness.bending_y", "weight.acceleration", "rod.base.position"]
    made = Moving(scene(floor(-0.02, **rubbing), parameters=names, inputs=[]), tmp_path / "named")
    p = np.array([0.017, 0.5, 0.0, -9.0, 0.01, 0.0, 0.002])
    heavier = {**WEIGHT, "acceleration": p[1:4].tolist()}
    base = {"position": p[4:].tolist(), "tangent": [1, 0, 0]}
    other = rod(stiffness={"bending_y": 0.017}, base=base)
    fixed = Moving(scene(floor(-0.02, **rubbing), other, loads=[heavier], inputs=[]), tmp_path / "fixed")
    compiled, inputs = made.compiled, made.model.inputs.pack()
    memory, plain = compiled.step_memory(), fixed.compiled.step_memory()
    ends = [compiled.contact_start(), fixed.compiled.contact_start()]
    for _ in range(150):
        step = compiled.step(ends[0], 2e-3, inputs, memory=memory, parameters=p, options=EXACT)
        wanted = fixed.compiled.step(ends[1], 2e-3, fixed.model.inputs.pack(), memory=plain, options=EXACT)
        assert step.done and wanted.done
        ends = [step.state, wanted.state]
        assert_allclose(ends[0].x, ends[1].x, rtol=0, atol=1e-9)
    (contact, *_) = compiled.step_contacts(memory)
    assert contact.force > 1e-3

    def end(own: FloatArray) -> FloatArray:
        step = compiled.step(ends[0], 2e-3, inputs, memory=copy.deepcopy(memory), parameters=own, options=EXACT)
        return np.concatenate([step.state.x, step.state.v])

    step, derivatives = compiled.step_sensitivity(ends[0], 2e-3, inputs, memory=memory, parameters=p, options=EXACT)
    assert step.done and derivatives is not None
    # The height of the base is left out: it would lift the rod off, or press it in.
    slopes = central_differences(end, p, 1e-6)[:, :6]
    assert abs(slopes).max() > 1e-3
    assert_allclose(derivatives.by_parameters[:, :6], slopes, rtol=1e-4, atol=1e-6 * abs(slopes).max())


@pytest.mark.slow
def test_a_motion_begins_in_contact_where_python_begins_it(tmp_path: Path) -> None:
    push = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.02]}
    tables = scene(floor(-0.02), loads=[push], inputs=["push.force"])
    tables["simulation"]["start"] = "equilibrium"
    made = Moving(tables, tmp_path)
    start = made.compiled.contact_start()
    memory = made.compiled.step_memory()
    states = made.steps(1e-3, 50, memory)
    assert_allclose(states[-1].x, start.x, rtol=0, atol=1e-9)
    (contact,) = made.compiled.step_contacts(memory)
    assert contact.place == 1.0
    assert contact.force > 1e-3
    # Without contact there is none; a solve tells so.
    assert not made.compiled.solve().converged
    assert made.compiled.solve({"push.force": [0, 0, -1e-3]}).converged


@pytest.mark.slow
@pytest.mark.parametrize("touches", [False, True])
def test_an_fmu_takes_the_steps_of_the_library(touches: bool, tmp_path: Path) -> None:
    tables = scene(BALL)
    if touches:
        # It lies on the ball at rest.
        tables["simulation"]["start"] = "equilibrium"
    made = Moving(tables, tmp_path)
    unit = write_fmu(made.model, tmp_path / "robot.fmu", "robot")
    height = "rod.tip.position.z"
    found = fmpy.simulate_fmu(str(unit), stop_time=0.3, step_size=1e-3, output_interval=1e-3, output=[height])
    states = made.steps(1e-3, 300)
    assert_allclose(found[height], made.tips(states)[:, 2] * LENGTH, rtol=0, atol=1e-9)
    if touches:
        assert_allclose(found[height], found[height][0], rtol=0, atol=1e-8)


@pytest.mark.slow
def test_an_fmu_has_parameters_in_contact(tmp_path: Path) -> None:
    """A heavier rod strikes as that of the scene with its density; where it lies at rest, only the scene's own is."""
    tables = scene(BALL, parameters=["rod.linear_density"])
    heavier = Moving(scene(BALL, rod(linear_density=0.25)), tmp_path)
    unit = write_fmu(build(scene_from_dict(tables), moving=True), tmp_path / "robot.fmu", "robot")
    height, density = "rod.tip.position.z", {"rod.linear_density": 0.25}
    arguments: dict[str, Any] = {"stop_time": 0.3, "step_size": 1e-3, "output_interval": 1e-3, "output": [height]}
    found = fmpy.simulate_fmu(str(unit), start_values=density, **arguments)
    states = heavier.steps(1e-3, 300)
    assert_allclose(found[height], heavier.tips(states)[:, 2] * LENGTH, rtol=0, atol=1e-9)
    tables["simulation"]["start"] = "equilibrium"
    at_rest = write_fmu(build(scene_from_dict(tables), moving=True), tmp_path / "rests.fmu", "rests")
    fmpy.simulate_fmu(str(at_rest), **arguments)
    with pytest.raises(fmpy.fmi1.FMICallException):
        fmpy.simulate_fmu(str(at_rest), start_values=density, **arguments)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("friction", "dt"), [(0.0, 5e-4), (0.0, 2e-4), (0.1, 1e-3), (0.3, 1e-3), (0.3, 2e-4), (0.6, 5e-4)]
)
def test_a_rod_that_is_thrown_on_the_floor_comes_to_lie(friction: float, dt: float, tmp_path: Path) -> None:
    changes = ["floor.restitution=0.3", *([f"floor.friction={friction}"] if friction else [])]
    scene = read_scene("examples/rod_hits_floor.toml", changes).with_motion_inputs()
    model = build(scene, moving=True)
    compiled = load(export(model, tmp_path / "robot", dynamics=True))
    assert isinstance(compiled, Compiled)
    pieces = moving_inputs(model).pieces(1.0)
    memory, state = compiled.step_memory(), compiled.contact_start()
    (facing,) = facings(model)
    energies, depths = [], []
    for k in range(round(1.0 / dt)):
        time = k * dt
        inputs = next((piece for piece in pieces if time < piece.end - dt / 2), pieces[-1]).at(time)
        step = compiled.step(state, dt, *inputs, memory=memory)
        assert step.done, (time, step.status.value)
        state = step.state
        if time > 0.1:
            # The hand has let go.
            parts = model.energies(state.x, state.v, inputs.value, 0.0 * inputs.value)[:3]
            energies.append(sum(float(np.sum(np.asarray(part))) for part in parts))
        depths.append(facing.deepest(facing.nodes(state.x, inputs.value)).gap)
    assert np.diff(energies).max() <= 1e-11
    # Between the sections at which it is held a rod that lies is lower.
    assert min(depths) >= -1e-4
    contacts = compiled.step_contacts(memory)
    assert_allclose(sum(contact.force for contact in contacts), 1100 * np.pi * 8e-3**2 * LENGTH * 9.81, rtol=1e-2)
    assert np.abs(gaps_along(facing, facing.nodes(state.x, inputs.value))).max() < 1e-5
    along = model.tip["rod"](state.x + state.v, inputs.value)[0] - model.tip["rod"](state.x, inputs.value)[0]
    # A smaller coefficient has not stopped it by then.
    assert friction < 0.3 or np.abs(along.full()[:, 0]).max() < 1e-2


@pytest.mark.slow
def test_the_demo_simulates_a_rod_that_nothing_holds(tmp_path: Path) -> None:
    # It rocks from end to end for half of the second; twice as steep it rocks for all of it.
    base = {"position": [0, 0, 0], "tangent": [1, 0, 0.1], "free": True}
    small = {"modes": 2, "nodes": 8, "tolerance": 1e-3}
    made = Moving(scene(floor(-0.05, friction=0.3), rod(base=base), accuracy=small), tmp_path)
    export(made.model, tmp_path / "robot", dynamics=True)
    sources = [tmp_path / "robot" / f"robot{end}.c" for end in ("_motion_demo", "", "_kernels")]
    program = tmp_path / "program"
    flags = ["-O1", "-std=c99", "-D_POSIX_C_SOURCE=199309L", "-Wall", "-Wextra", "-Werror"]
    subprocess.run(["gcc", *flags, *map(str, sources), "-lm", "-o", str(program)], check=True)
    printed = json.loads(subprocess.run([str(program)], check=True, capture_output=True, text=True).stdout)
    assert (printed["status"], printed["steps"]) == ("done", 1000)
    # It has come to lie.
    assert_allclose(printed["tip"][2], -0.05, rtol=0, atol=1e-6)
    assert printed["kinetic_J"] < 1e-12
