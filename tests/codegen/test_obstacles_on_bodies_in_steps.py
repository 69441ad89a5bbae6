"""Steps in C of rods that touch obstacles on bodies: beside the simulator, and their derivatives by differences."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, export, load, read_scene, simulate
from tests.codegen.test_steps_in_contact import compare_with_differences
from tests.motion.test_obstacles_on_moving_bodies import FINGERS

STEP = 1e-3
COUNT = 60


@pytest.mark.parametrize(
    ("friction", "nearby"), [pytest.param(0.0, 2e-3, marks=pytest.mark.slow, id="smooth"), pytest.param(0.3, 1e-9)]
)
def test_a_finger_that_strikes_another(friction: float, nearby: float, tmp_path: Path) -> None:
    """The fingers differ in stiffness, by which their balances are divided.

    With friction the simulator takes the same steps; without it takes steps of one stage more.
    """
    shape = "name='rim', kind='sphere', body='disk', centre=[0, 0, 0], radius=0.012"
    changes = [
        "inputs=['flexor.tension']",
        f"obstacles=[{{{shape}, rods=['lower'], friction={friction}}}]",
        "upper.damping={retardation_time=0.05}",
        "lower.damping={retardation_time=0.02}",
        "lower.material.youngs_modulus=2.4e6",
        f"simulation={{duration={STEP * COUNT}, tolerance=1e-2, step={STEP}, start='unloaded', frames={COUNT + 1}}}",
        "accuracy={modes=2, nodes=4}",
    ]
    model = build(read_scene(FINGERS, changes), moving=True)
    folder = export(model, tmp_path / "robot", dynamics=True)
    for file in folder.glob("*.[ch]"):
        # Lines of simulated motions, which have rods that strike rods.
        assert not re.search("RODS_FACE_RODS|STRETCHES_ARE_TOLD", file.read_text()), file.name
    compiled = load(folder)
    memory = compiled.step_memory()
    state = compiled.contact_start()
    for _ in range(COUNT):
        step = compiled.step(state, STEP, model.pack(), memory=memory)
        assert step.done, step.status.value
        state = step.state
    motion = simulate(model)
    assert_allclose(state.x, motion.x[-1], rtol=0, atol=nearby)
    (pressing,) = compiled.step_contacts(memory)
    (expected,) = motion.contacts[-1]
    assert_allclose(pressing.place, expected.at, rtol=0, atol=nearby)
    made = SimpleNamespace(model=model, compiled=compiled)
    compare_with_differences(made, state, memory, STEP, of_load=(1e-4, 1e-1, 1e2), least=1e-9)
