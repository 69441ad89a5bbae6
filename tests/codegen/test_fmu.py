"""A scene as an FMU: valid by the standard, the same motion as the library's own steps, exact derivatives."""

import json
import zipfile
from pathlib import Path

import casadi as ca
import fmpy
import numpy as np
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import parse_scene, simulate, solve
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.export import export
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.codegen.manifest import MANIFEST
from cosserat_casadi.codegen.motion_outputs import motion_outputs
from cosserat_casadi.control import motion_stage
from cosserat_casadi.errors import ExportError, SceneError
from cosserat_casadi.model.build import build
from cosserat_casadi.scene.motion_records import InputMotion
from cosserat_casadi.scene.simulation import Simulation
from tests.commands import cosserat

SCENE = """
schema = 1
inputs = ["push.force", "flexor.tension", "finger.base.position", "finger.base.quaternion"]
[accuracy]
modes = 1
nodes = 4
[[rods]]
name = "finger"
length = 0.1
strain = "kirchhoff"
material = { youngs_modulus = 1.2e6, poisson_ratio = 0.48, density = 1070.0 }
section = { shape = "circle", radius = 7e-3 }
damping = { retardation_time = 0.01 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
force = [0.01, 0.0, 0.0]
[[actuators]]
name = "flexor"
kind = "tendon"
rod = "finger"
tension = 0.1
offset = [-5e-3, 0.0]
[simulation]
duration = 0.1
step = 2e-3
"""
PERIOD = 5e-3
STEPS = 4
DURATION = 0.04


@pytest.fixture(scope="module")
def model():
    return build(parse_scene(SCENE), moving=True)


@pytest.fixture(scope="module")
def fmu(model, tmp_path_factory):
    return write_fmu(model, tmp_path_factory.mktemp("fmu") / "finger.fmu", "finger")


@pytest.fixture(scope="module")
def library(model, unpacked, tmp_path_factory):
    """The library inside the FMU, as an exported folder has it."""
    folder = export(model, tmp_path_factory.mktemp("folder") / "finger", "finger", dynamics=True)
    described = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    binary = next((Path(unpacked) / "binaries").glob("*/finger.*"))
    return Compiled(binary, described)


@pytest.fixture(scope="module")
def unpacked(fmu, tmp_path_factory):
    return fmpy.extract(str(fmu), str(tmp_path_factory.mktemp("unpacked")))


@pytest.fixture(scope="module")
def described(fmu):
    return fmpy.read_model_description(str(fmu), validate=True)


@pytest.fixture
def instance(described, unpacked):
    slave = FMU3Slave(
        guid=described.guid,
        unzipDirectory=unpacked,
        modelIdentifier=described.coSimulation.modelIdentifier,
        instanceName="finger",
    )
    slave.instantiate(loggingOn=False)
    yield slave
    slave.terminate()
    slave.freeInstance()


def references(described, causality):
    return [one.valueReference for one in described.modelVariables if one.causality == causality]


def initialised(slave, inputs=None, described=None):
    slave.enterInitializationMode()
    if inputs is not None:
        slave.setFloat64(references(described, "input"), inputs)
    slave.exitInitializationMode()
    return slave


def by_library(model, library, moves, courses):
    """Outputs after each communication step: of (value, rate) of the inputs at its start and at its end.

    Loads move in a straight line; what moves rods, with an acceleration in each half.
    """
    outputs = motion_outputs(model).function
    before = courses[0][0][0]
    state = library.rest(before, library.solve(before).x)
    memory = library.step_memory()
    seen = []
    for (value, rate), (end_value, end_rate) in courses:
        moved = value
        straight = (end_value - value) / PERIOD
        rate = np.where(moves, rate, straight)
        end_rate = np.where(moves, end_rate, straight)
        half = PERIOD / 2
        # Values and rates at the end by accelerations in both halves.
        matrix = [[3 * half**2 / 2, half**2 / 2], [half, half]]
        accelerations = np.linalg.solve(matrix, [end_value - moved - PERIOD * rate, end_rate - rate])
        for k in range(STEPS):
            acceleration = accelerations[k // (STEPS // 2)]
            dt = PERIOD / STEPS
            taken = library.step(state, dt, moved, rate, acceleration, memory=memory)
            assert taken.done
            state = taken.state
            moved = moved + dt * rate + dt**2 / 2 * acceleration
            rate = rate + dt * acceleration
        assert_allclose(moved, end_value, rtol=0, atol=1e-15)
        seen.append(outputs(state.x, state.v, moved, rate).full().ravel())
    return np.array(seen)


def test_fmu_is_valid(fmu):
    assert validate_fmu(str(fmu)) == []


@pytest.mark.slow
def test_same_model_gives_the_same_sources_and_description(model, fmu, tmp_path):
    again = write_fmu(model, tmp_path / "again.fmu", "finger")
    first = zipfile.ZipFile(fmu)
    second = zipfile.ZipFile(again)
    assert first.namelist() == second.namelist()
    for name in first.namelist():
        if not name.startswith("binaries"):
            assert first.read(name) == second.read(name), name


@pytest.mark.slow
def test_command_writes_the_same_sources(fmu, tmp_path):
    (tmp_path / "finger.toml").write_text(SCENE)
    done = cosserat("export", "finger.toml", "--fmu", "finger.fmu", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    wanted = zipfile.ZipFile(fmu)
    written = zipfile.ZipFile(tmp_path / "finger.fmu")
    assert written.namelist() == wanted.namelist()
    for name in written.namelist():
        if name.endswith((".c", ".h")):
            assert _of_model(written, name) == _of_model(wanted, name), name


def _of_model(archive, name):
    """A source without its first comment, where the command says of ranges what it saw, and the token made of all."""
    _, _, text = archive.read(name).partition(b"*/")
    return [line for line in text.splitlines() if not line.startswith(b"#define FMU_TOKEN")]


def test_motion_vs_library(model, library, described, instance):
    inputs = model.pack()
    given = model.pack({"push.force": [0.02, 0.01, 0.0], "finger.base.position": [1e-3, 0.0, 2e-3]})
    # A load goes straight to its value, a base moves there without a jump of its rate.
    moves = np.zeros(len(inputs), dtype=bool)
    moves[model.inputs.slices["finger.base.position"]] = True
    # Parabolas through the last values: from rest, then one that ends where the value stays.
    mean_rate = np.where(moves, (given - inputs) / PERIOD, 0.0)
    courses = [
        ((inputs, 0.0 * inputs), (given, 2.0 * mean_rate)),
        ((given, 2.0 * mean_rate), (given, -0.5 * mean_rate)),
    ]
    wanted = by_library(model, library, moves, courses)

    initialised(instance)
    instance.setFloat64(references(described, "input"), given.tolist())
    seen = []
    for k in range(2):
        assert instance.doStep(k * PERIOD, PERIOD) == (False, False, False, pytest.approx((k + 1) * PERIOD))
        seen.append(instance.getFloat64(references(described, "output")))
    assert np.abs(wanted[0] - wanted[1]).max() > 1e-3
    # A straight line by two accelerations has their rounding.
    assert_allclose(seen, wanted, rtol=1e-11, atol=1e-12)


def test_fmu_simulated_by_fmpy(fmu, described):
    outputs = ["finger.tip.position.x", "finger.tip.velocity.x", "flexor.length"]
    result = fmpy.simulate_fmu(str(fmu), stop_time=0.05, output_interval=PERIOD, output=outputs)
    assert len(result) == 11
    # It begins in equilibrium, and nothing changes.
    assert_allclose(result["finger.tip.position.x"], result["finger.tip.position.x"][0], rtol=0.0, atol=1e-10)
    assert_allclose(result["finger.tip.velocity.x"], 0.0, rtol=0.0, atol=1e-9)


def derivative(instance, described, known, seed=1.0):
    outputs = references(described, "output")
    return np.array(instance.getDirectionalDerivative(outputs, [known], [seed]))


def copied(instance):
    return instance.getFMUState()


@pytest.mark.parametrize("moved", ["push.force.x", "flexor.tension", "finger.base.position.y"])
def test_derivative_of_a_step_vs_differences(instance, described, moved):
    initialised(instance)
    reference = next(one.valueReference for one in described.modelVariables if one.name == moved)
    value = instance.getFloat64([reference])[0]
    instance.doStep(0.0, PERIOD)
    before = copied(instance)
    difference = 1e-5
    ends = []
    for sign in (-1.0, 1.0):
        instance.setFMUState(before)
        instance.setFloat64([reference], [value + sign * difference])
        instance.doStep(PERIOD, PERIOD)
        ends.append(np.array(instance.getFloat64(references(described, "output"))))
    wanted = (ends[1] - ends[0]) / (2 * difference)
    instance.setFMUState(before)
    instance.doStep(PERIOD, PERIOD)
    exact = derivative(instance, described, reference)
    assert np.abs(exact).max() > 1e-3
    assert_allclose(exact, wanted, rtol=1e-5, atol=1e-6 * np.abs(wanted).max())
    assert_allclose(derivative(instance, described, reference, -3.0), -3.0 * exact, rtol=1e-12, atol=1e-14)
    instance.freeFMUState(before)


def test_derivative_at_the_start_is_that_of_the_equilibrium(model, library, instance, described):
    initialised(instance)
    reference = next(one.valueReference for one in described.modelVariables if one.name == "push.force.x")
    names = [one.name for one in described.modelVariables if one.causality == "output"]
    found = library.solve()
    _, d_tip = library.sensitivity(model.pack(), found.x)
    column = d_tip["finger"][:, model.inputs.slices["push.force"].start]
    exact = derivative(instance, described, reference)
    positions = [names.index(f"finger.tip.position.{axis}") for axis in "xyz"]
    assert_allclose(exact[positions], column[:3], rtol=1e-10, atol=1e-12)


def test_copied_state_replays_the_same_bits(instance, described):
    initialised(instance, None)
    force = next(one.valueReference for one in described.modelVariables if one.name == "push.force.x")
    instance.setFloat64([force], [0.05])
    instance.doStep(0.0, PERIOD)
    state = copied(instance)
    stored = instance.serializeFMUState(state)
    outputs = references(described, "output")
    ends = []
    for again in range(3):
        if again == 2:
            instance.freeFMUState(state)
            state = instance.deserializeFMUState(stored)
        instance.setFMUState(state)
        instance.doStep(PERIOD, PERIOD)
        ends.append(instance.getFloat64(outputs))
    assert_array_equal(ends[1], ends[0])
    assert_array_equal(ends[2], ends[0])
    instance.freeFMUState(state)


def refused(instance, call, *arguments):
    """A call that ends with another status than OK: FMPy makes an exception of it."""
    with pytest.raises(fmpy.fmi1.FMICallException):
        getattr(instance, call)(*arguments)


def test_what_cannot_be_is_refused(instance, described):
    force = next(one.valueReference for one in described.modelVariables if one.name == "push.force.x")
    output = references(described, "output")[0]
    refused(instance, "doStep", 0.0, PERIOD)
    initialised(instance)
    refused(instance, "setFloat64", [force], [float("nan")])
    refused(instance, "setFloat64", [output], [1.0])
    # All or none: the first value of a call that is refused is not kept.
    (before,) = instance.getFloat64([force])
    refused(instance, "setFloat64", [force, output], [before + 1.0, 1.0])
    refused(instance, "setFloat64", [force, force], [before + 1.0, float("inf")])
    assert instance.getFloat64([force]) == [before]
    refused(instance, "getFloat64", [9999])
    refused(instance, "doStep", 0.0, -1.0)
    refused(instance, "doStep", 0.5, PERIOD)
    refused(instance, "getInt32", [force])
    refused(instance, "getDirectionalDerivative", [force], [force], [1.0])
    # After all of it a step is one.
    instance.doStep(0.0, PERIOD)


def test_a_quaternion_and_its_negative_are_one_orientation(instance, described):
    """Programs turn quaternions to w ≥ 0: the base went round once within a step, 1.4 lengths off."""
    initialised(instance)
    start = copied(instance)
    turned = [one.valueReference for one in described.modelVariables if "base.quaternion" in one.name]
    seen = []
    for sign in (1.0, -1.0):
        instance.setFMUState(start)
        for k, angle in enumerate((1e-3, 3e-3, 5e-3, 7e-3)):
            quaternion = np.array([np.cos(angle), 0.0, np.sin(angle), 0.0]) * sign**k
            instance.setFloat64(turned, quaternion.tolist())
            instance.doStep(k * PERIOD, PERIOD)
        by_last = sign**k * derivative(instance, described, turned[2])
        seen.append([*instance.getFloat64(references(described, "output")), *by_last])
        instance.setFloat64(turned, (-quaternion).tolist())
        instance.doStep(4 * PERIOD, PERIOD)
        seen[-1] += instance.getFloat64(references(described, "output"))
    assert_array_equal(seen[1], seen[0])
    instance.freeFMUState(start)


def test_short_steps_at_late_times_follow_each_other(instance):
    late, short = 1000.0, 1e-8
    instance.enterInitializationMode(startTime=late)
    instance.exitInitializationMode()
    for number in range(20):
        instance.doStep(late + number * short, short)
    refused(instance, "doStep", late + 19 * short, short)


def test_step_that_cannot_be_solved_leaves_the_state(instance, described):
    initialised(instance)
    force = next(one.valueReference for one in described.modelVariables if one.name == "push.force.x")
    outputs = references(described, "output")
    before = instance.getFloat64(outputs)
    instance.setFloat64([force], [1e9])
    refused(instance, "doStep", 0.0, PERIOD)
    assert_array_equal(instance.getFloat64(outputs), before)
    instance.setFloat64([force], [0.01])
    instance.doStep(0.0, PERIOD)


def test_derivative_is_that_of_the_last_step_that_was_done(instance, described):
    """Inputs that are given for a next step, and such a step that cannot be solved, leave it as it is."""
    initialised(instance)
    force = next(one.valueReference for one in described.modelVariables if one.name == "push.force.x")
    instance.setFloat64([force], [0.05])
    instance.doStep(0.0, PERIOD)
    instance.doStep(PERIOD, PERIOD)
    wanted = derivative(instance, described, force)
    instance.setFloat64([force], [0.5])
    assert_array_equal(derivative(instance, described, force), wanted)
    instance.setFloat64([force], [1e9])
    refused(instance, "doStep", 2 * PERIOD, 2 * PERIOD)
    assert_array_equal(derivative(instance, described, force), wanted)


def test_library_of_another_description_is_refused(described, unpacked):
    slave = FMU3Slave(
        guid="another",
        unzipDirectory=unpacked,
        modelIdentifier=described.coSimulation.modelIdentifier,
        instanceName="x",
    )
    with pytest.raises(Exception, match="instantiate"):
        slave.instantiate()


def test_file_names_are_checked_first(model, tmp_path):
    with pytest.raises(ExportError, match=r"does not end in \.fmu"):
        write_fmu(model, tmp_path / "finger.zip", "finger")
    with pytest.raises(SceneError, match="does not exist"):
        write_fmu(model, tmp_path / "none" / "finger.fmu", "finger")
    assert list(tmp_path.iterdir()) == []


FALLING = """
schema = 1
inputs = []
[accuracy]
modes = 1
nodes = 3
[[rods]]
name = "stick"
length = 0.1
strain = "kirchhoff"
material = { youngs_modulus = 1.2e6, poisson_ratio = 0.48, density = 1070.0 }
section = { shape = "circle", radius = 7e-3 }
base = { free = true }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
"""


@pytest.mark.slow
def test_free_rod_falls(tmp_path):
    """From the unloaded shape, and without an input: by g t²/2, which the integrator has exactly."""
    fmu = write_fmu(build(parse_scene(FALLING), moving=True), tmp_path / "stick.fmu", "stick")
    assert validate_fmu(str(fmu)) == []
    outputs = ["stick.tip.position.z", "stick.tip.velocity.z"]
    result = fmpy.simulate_fmu(str(fmu), stop_time=0.02, output_interval=5e-3, output=outputs)
    assert_allclose(result["stick.tip.position.z"], 0.1 - 9.81 * result["time"] ** 2 / 2, rtol=0.0, atol=1e-9)
    assert_allclose(result["stick.tip.velocity.z"], -9.81 * result["time"], rtol=0.0, atol=1e-8)


def by_stages(model, before, after, count, duration):
    """Outputs after so many stages of an optimal-control problem, over which inputs go straight, solved one by one."""
    stage = motion_stage(model, duration / count)
    state, unknowns, inputs, rate = stage.symbols
    residual = stage.equations(state, unknowns, inputs, inputs_rate=rate)
    problem = {"x": unknowns, "p": ca.vertcat(state, inputs, rate), "g": residual}
    newton = ca.rootfinder("newton", "newton", problem, {"abstol": 1e-12})
    rest = solve(model)
    at, found = stage.state(rest.x), stage.still(rest.x)
    per_second = (after - before) / duration
    for k in range(count):
        found = newton(x0=found, p=ca.vertcat(at, before + k * stage.duration * per_second, per_second))["x"]
        at = stage.next_state(at, found)
    return motion_outputs(model).function(stage.x(at), stage.v(at), after, per_second).full().ravel()


def test_simulation_vs_fmu_and_library_and_stages(model, library, described, instance):
    """One motion in four ways: inputs go in a straight line, within one communication step of the FMU."""
    before = model.pack()
    after = model.pack({"push.force": [0.03, 0.01, 0.0], "flexor.tension": 0.3})
    motions = [
        InputMotion(input=name, times=(0.0, DURATION), values=(start, end))
        for name, start, end in (("push.force", [0.01, 0.0, 0.0], [0.03, 0.01, 0.0]), ("flexor.tension", 0.1, 0.3))
    ]
    scene = model.scene.model_copy(update={"motions": tuple(motions)})
    simulation = Simulation(duration=DURATION, frames=2, step=DURATION / 20)
    motion = simulate(build(scene, model.discretisation, moving=True), simulation=simulation)
    assert motion.converged, motion.message
    per_second = (after - before) / DURATION
    outputs = motion_outputs(model).function
    wanted = outputs(motion.x[-1], motion.v[-1], after, per_second).full().ravel()
    at_rest = outputs(motion.x[0], 0.0 * motion.v[0], before, 0.0 * before).full().ravel()

    assert_allclose(by_stages(model, before, after, 20, DURATION), wanted, rtol=1e-9, atol=1e-9)

    state = library.rest(before, library.solve(before).x)
    for k in range(40):
        step = DURATION / 40
        taken = library.step(state, step, before + k * step * per_second, per_second, 0.0 * before)
        assert taken.done
        state = taken.state
    in_c = outputs(state.x, state.v, after, per_second).full().ravel()

    initialised(instance)
    instance.setFloat64(references(described, "input"), after.tolist())
    instance.doStep(0.0, DURATION)
    by_fmu = instance.getFloat64(references(described, "output"))
    position = [one.name for one in described.modelVariables if one.causality == "output"].index(
        "finger.tip.position.y"
    )
    assert abs(wanted - at_rest)[position] > 5e-4
    # Two stages, of order three: in steps of 1 ms, and of the 2 ms that the scene gives the FMU.
    assert_allclose(in_c[position], wanted[position], rtol=0, atol=2e-9)
    assert_allclose(by_fmu[position], wanted[position], rtol=0, atol=1.5e-8)
