"""An FMU whose base moves, whose cable has a length, and whose scene has parameters: beside the simulator in Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi3 import FMU3Slave
from fmpy.model_description import ModelDescription
from fmpy.validation import validate_fmu
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, parse_scene
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.codegen.motion_outputs import motion_outputs
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.simulate import moving_inputs, started
from cosserat_casadi.numerics.collocation import radau
from tests.motion.stepping import orders, stepped

SCENE = """
schema = 1
inputs = ["finger.base.position", "flexor.length", "push.force"]
parameters = ["finger.material.youngs_modulus", "flexor.offset.x"]
[accuracy]
modes = 2
nodes = 6
[[rods]]
name = "finger"
length = 0.1
strain = "planar"
material = { youngs_modulus = 1.2e6, poisson_ratio = 0.48, density = 1070.0 }
section = { shape = "circle", radius = 5e-3 }
damping = { retardation_time = 0.02, prony = [{ share = 0.2, time = 0.05 }] }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
force = [0.01, 0.0, 0.0]
[[actuators]]
name = "flexor"
kind = "tendon"
rod = "finger"
length = 0.098
offset = [-4e-3, 0.0]
[[motions]]
input = "finger.base.position"
amplitude = [4e-3, 0.0, 2e-3]
frequency = 4.0
wave = "one_minus_cosine"
[[motions]]
input = "flexor.length"
amplitude = -1e-3
frequency = 5.0
wave = "one_minus_cosine"
[simulation]
duration = 0.2
step = 1e-3
"""
DURATION = 0.2
SOFTER = {"finger.material.youngs_modulus": 0.7e6, "flexor.offset.x": -3.5e-3}


@pytest.fixture(scope="module")
def model() -> Model:
    return build(parse_scene(SCENE).with_motion_inputs(), moving=True)


@pytest.fixture(scope="module")
def fmu(model: Model, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_fmu(model, tmp_path_factory.mktemp("fmu") / "finger.fmu", "finger")


@pytest.fixture(scope="module")
def described(fmu: Path) -> ModelDescription:
    return fmpy.read_model_description(str(fmu), validate=True)


@pytest.fixture(scope="module")
def unpacked(fmu: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(fmpy.extract(str(fmu), str(tmp_path_factory.mktemp("unpacked"))))


Begin = Callable[..., FMU3Slave]


@pytest.fixture
def begin(described: ModelDescription, unpacked: str) -> Iterator[Begin]:
    """Instances at the start of the motion, with values for parameters and inputs by name."""
    made = list[FMU3Slave]()

    def begun(values: dict[str, float] | None = None) -> FMU3Slave:
        slave = FMU3Slave(
            guid=described.guid,
            unzipDirectory=unpacked,
            modelIdentifier=described.coSimulation.modelIdentifier,
            instanceName=f"finger {len(made)}",
        )
        slave.instantiate(loggingOn=False)
        made.append(slave)
        slave.enterInitializationMode()
        for name, value in (values or {}).items():
            slave.setFloat64([reference(described, name)], [value])
        slave.exitInitializationMode()
        return slave

    yield begun
    for slave in made:
        slave.terminate()
        slave.freeInstance()


def reference(described: ModelDescription, name: str) -> int:
    return next(variable.valueReference for variable in described.modelVariables if variable.name == name)


def references(described: ModelDescription, causality: str) -> list[int]:
    return [variable.valueReference for variable in described.modelVariables if variable.causality == causality]


def outputs_of(slave: FMU3Slave, described: ModelDescription) -> FloatArray:
    return np.array(slave.getFloat64(references(described, "output")))


def simulated(model: Model) -> FloatArray:
    """Outputs at the end by Radau IIA with three stages in Python, along the path of the inputs as the scene has it."""
    simulation = model.scene.simulation
    assert simulation is not None
    end = stepped(model, radau(3), DURATION / 200, DURATION, started(model, simulation, None).x).end
    inputs = moving_inputs(model).at(DURATION)
    return motion_outputs(model).function(end.x, end.v, inputs.value, inputs.rate).full().ravel()


def stepped_by_fmu(slave: FMU3Slave, described: ModelDescription, model: Model, count: int) -> FloatArray:
    """Outputs at the end of so many communication steps, each given the inputs that it ends with."""
    course = moving_inputs(model)
    period = DURATION / count
    for k in range(count):
        slave.setFloat64(references(described, "input"), course.at((k + 1) * period).value.tolist())
        slave.doStep(k * period, period)
    return outputs_of(slave, described)


@pytest.mark.slow
def test_fmu_is_valid_and_names_its_parameters(fmu: Path, described: ModelDescription) -> None:
    assert validate_fmu(str(fmu)) == []
    listed = {one.name: one for one in described.modelVariables if one.causality == "parameter"}
    assert list(listed) == ["step", "finger.material.youngs_modulus", "flexor.offset.x"]
    modulus = listed["finger.material.youngs_modulus"]
    assert (float(modulus.start), modulus.variability, modulus.unit) == (1.2e6, "fixed", "Pa")


@pytest.mark.parametrize("parameters", [{}, SOFTER], ids=["the scene's", "others"])
def test_base_and_length_that_move_vs_simulator(
    model: Model, begin: Begin, described: ModelDescription, parameters: dict[str, float]
) -> None:
    """Of second order in the communication step; with parameters, the simulator's with those numbers in the scene."""
    exact = simulated(model.at(parameters))
    ends = [stepped_by_fmu(begin(parameters), described, model, count) for count in (20, 40, 80)]
    names = [one.name for one in described.modelVariables if one.causality == "output"]
    at_rest = outputs_of(begin(parameters), described)
    for quantity, least, accuracy in (("position", 1e-3, 5e-6), ("velocity", 1e-2, 4e-4)):
        rows = [names.index(f"finger.tip.{quantity}.{axis}") for axis in "xz"]
        errors = [np.abs(end[rows] - exact[rows]).max() for end in ends]
        assert np.abs(exact[rows] - at_rest[rows]).max() > least
        assert np.all(orders(errors) > 1.7), (quantity, errors)
        assert errors[-1] < accuracy
    tension = names.index("flexor.tension")
    assert_allclose(ends[-1][tension], exact[tension], rtol=2e-3, atol=0)


def test_parameters_are_seen_and_hold_from_the_start_on(begin: Begin, described: ModelDescription) -> None:
    plain = begin()
    softer = begin(SOFTER)
    assert np.abs(outputs_of(plain, described) - outputs_of(softer, described)).max() > 1e-4
    modulus = reference(described, "finger.material.youngs_modulus")
    assert softer.getFloat64([modulus]) == [0.7e6]
    with pytest.raises(fmpy.fmi1.FMICallException):
        softer.setFloat64([modulus], [0.8e6])
    softer.doStep(0.0, 5e-3)
    with pytest.raises(fmpy.fmi1.FMICallException):
        softer.getDirectionalDerivative(references(described, "output"), [modulus], [1.0])


@pytest.mark.parametrize("name", [*SOFTER, "flexor.length", "push.force.x"])
def test_derivatives_at_the_start_vs_differences(begin: Begin, described: ModelDescription, name: str) -> None:
    """Of the equilibrium, with parameters too."""
    values = {"finger.material.youngs_modulus": 1.2e6, "flexor.offset.x": -4e-3, "flexor.length": 0.098}
    value = values.get(name, 0.01)
    span = 1e-4 * abs(value)
    sides = [outputs_of(begin({name: value + side * span}), described) for side in (1.0, -1.0)]
    wanted = (sides[0] - sides[1]) / (2 * span)
    exact = begin().getDirectionalDerivative(references(described, "output"), [reference(described, name)], [1.0])
    assert np.abs(wanted).max() * abs(value) > 1e-5
    assert_allclose(exact, wanted, rtol=1e-5, atol=1e-6 * np.abs(wanted).max())


def after_steps(
    slave: FMU3Slave, described: ModelDescription, periods: Sequence[float], name: str, value: float
) -> None:
    """Communication steps of several lengths, the last of which ends at a value of one input."""
    base = reference(described, "finger.base.position.x")
    time = 0.0
    for k, period in enumerate(periods):
        if k < len(periods) - 1:
            slave.setFloat64([base], [1e-4 * (k + 1) ** 2])
        else:
            slave.setFloat64([reference(described, name)], [value])
        slave.doStep(time, period)
        time += period


@pytest.mark.parametrize("periods", [[4e-3], [3e-3, 5e-3, 2e-3]], ids=["first step", "steps of several lengths"])
@pytest.mark.parametrize("name", ["finger.base.position.x", "finger.base.position.z", "flexor.length"])
def test_derivatives_of_a_step_vs_differences(
    begin: Begin, described: ModelDescription, name: str, periods: Sequence[float]
) -> None:
    """By what moves in the step: its rate at the end and its accelerations follow from what is given."""
    value = 0.0975 if name == "flexor.length" else 2e-4
    span = 1e-6
    sides = []
    for side in (1.0, -1.0):
        slave = begin(SOFTER)
        after_steps(slave, described, periods, name, value + side * span)
        sides.append(outputs_of(slave, described))
    wanted = (sides[0] - sides[1]) / (2 * span)
    slave = begin(SOFTER)
    after_steps(slave, described, periods, name, value)
    exact = slave.getDirectionalDerivative(references(described, "output"), [reference(described, name)], [1.0])
    assert np.abs(wanted).max() > 1.0
    assert_allclose(exact, wanted, rtol=1e-5, atol=1e-6 * np.abs(wanted).max())
