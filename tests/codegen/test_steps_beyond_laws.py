"""Steps in C of a rod whose law has an end: the motion that is simulated, until strains are beyond a limit."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi3 import FMU3Slave, fmi3Discard
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import Model, MotionOutcome, build, scene_from_dict, simulate
from cosserat_casadi.codegen.compiled_motion import CompiledStep
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.codegen.status import MotionStatus
from cosserat_casadi.model.strain_margins import VANISHED
from tests.codegen.libraries import Exported, exported
from tests.codegen.motions import MotionLibrary
from tests.model.test_material_laws import CIRCLE, TABLE, rod

LATTICE = {"law": "table", "table": {"bending_y": TABLE}, "density": 1000.0}
"""A measured curve that ends at a curvature of 30 per metre."""

ROD = rod(LATTICE, CIRCLE, "planar", damping={"retardation_time": 0.01})
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "moment": [0.0, 0.0, 0.0]}

ACTUATORS = [
    # Without length where the rod is bent by 20 per metre towards +x.
    {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 1e-9, "offset": [0.05, 0.0]},
    # Without area at 10 kPa.
    {"name": "gas", "kind": "chamber", "rod": "rod", "pressure": 0.0, "area": 1e-6}
    | {"area_growth": [-1.0], "reference_pressure": 1e4},
]

STEP = 1e-3


def described(**simulation: Any) -> dict[str, Any]:
    tables = {"schema": 1, "accuracy": {"modes": 1, "nodes": 6}, "rods": [ROD], "loads": [PUSH], "actuators": ACTUATORS}
    return {**tables, "inputs": ["push.moment", "gas.pressure"], "simulation": {"start": "unloaded", **simulation}}


@dataclass(frozen=True)
class LatticeRecipe:
    dynamics: bool = True

    def model(self) -> Model:
        return build(scene_from_dict(described(duration=0.1)), moving=True)


@pytest.fixture(scope="module")
def lattice(workshop: Path) -> Exported:
    return exported("moving_lattice", LatticeRecipe(), workshop)


def stepped(made: Exported, moment: float, pressure: float, count: int, step: float = STEP) -> list[CompiledStep]:
    """Steps from rest under loads that are there at once, until one is not done."""
    state = made.compiled.rest()
    assert state is not None
    memory = made.compiled.step_memory()
    taken = list[CompiledStep]()
    for _ in range(count):
        taken.append(made.compiled.step(state, step, [0.0, moment, 0.0, pressure], memory=memory))
        if not taken[-1].done:
            break
        state = taken[-1].state
    return taken


@pytest.mark.slow
def test_steps_of_a_law_vs_simulate(lattice: Exported) -> None:
    """The path of the tip is that of the simulator, and not that of a linear law."""
    ends = []
    for law, tolerance in ((LATTICE, 1e-7), ({"density": 1000.0}, 1e-4)):
        tables = described(duration=0.1, times=[0.1], tolerance=tolerance)
        tables["rods"] = [rod(law, CIRCLE, "planar", damping={"retardation_time": 0.01})]
        tables["loads"] = [{**PUSH, "moment": [0.0, 0.02, 0.0]}]
        motion = simulate(build(scene_from_dict(tables), moving=True))
        assert motion.converged
        ends.append(motion.x[-1])
    *_, last = stepped(lattice, 0.02, 0.0, 200, 0.1 / 200)
    assert last.done
    assert_allclose(last.state.x, ends[0], rtol=0, atol=1e-6)
    assert np.abs(ends[0] - ends[1]).max() > 1e-2


@pytest.mark.parametrize(
    ("moment", "pressure", "kind", "status"),
    [
        (-0.1, 0.0, "material", MotionStatus.BEYOND_MATERIAL),
        (0.1, 0.0, "path", MotionStatus.PATH_VANISHED),
        (0.0, 1.1e4, "chamber", MotionStatus.BEYOND_MATERIAL),
    ],
)
def test_a_step_beyond_a_limit_is_told_vs_simulate(
    lattice: Exported, moment: float, pressure: float, kind: str, status: MotionStatus
) -> None:
    """At the step that the simulator says; the state stays the last one within all limits."""
    *before, last = stepped(lattice, moment, pressure, 100)
    assert last.status is status
    inputs = np.array([0.0, moment, 0.0, pressure])
    tables = described(duration=STEP * (len(before) + 1), step=STEP)
    model = lattice.model
    assert model.strain_margins is not None
    if before:
        assert_array_equal(last.state.x, before[-1].state.x)
        assert model.strain_margins(last.state.x, inputs).full().min() > VANISHED
    tables["loads"] = [{**PUSH, "moment": [0.0, moment, 0.0]}]
    tables["actuators"] = [ACTUATORS[0], {**ACTUATORS[1], "pressure": pressure}]
    motion = simulate(build(scene_from_dict(tables), moving=True))
    assert motion.outcome is MotionOutcome[status.name]
    first = float(motion.message.split("from t = ")[1].split(" s")[0])
    assert_allclose(first, STEP * (len(before) + 0.5), rtol=0, atol=0.6 * STEP)
    assert kind in motion.message


@pytest.mark.slow
def test_an_fmu_of_a_law_says_what_its_step_is_beyond(lattice: Exported, tmp_path: Path) -> None:
    path = write_fmu(lattice.model, tmp_path / "lattice.fmu", "lattice")
    described = fmpy.read_model_description(str(path))
    said = list[str]()
    slave = FMU3Slave(
        guid=described.guid,
        unzipDirectory=fmpy.extract(str(path), str(tmp_path / "unpacked")),
        modelIdentifier=described.coSimulation.modelIdentifier,
        instanceName="lattice",
    )
    slave.instantiate(loggingOn=True, logMessage=lambda *words: said.append(words[-1].decode()))
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    (pressure,) = [one.valueReference for one in described.modelVariables if one.name == "gas.pressure"]
    slave.setFloat64([pressure], [1.1e4])
    with pytest.raises(fmpy.fmi1.FMICallException) as refused:
        slave.doStep(0.0, STEP)
    slave.terminate()
    slave.freeInstance()
    assert refused.value.status == fmi3Discard
    assert any(MotionStatus.BEYOND_MATERIAL.value in message for message in said)


def test_steps_without_limits_look_at_none(motion_library: MotionLibrary) -> None:
    made = motion_library("planar")
    assert made.model.strain_margins is None
    assert "STRAINS_HAVE_LIMITS" not in (made.folder / f"{made.name}.c").read_text()
