"""An optimum is judged at its end: residual, stability, and the error of modes that were chosen for other inputs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, export, load, read_scene, solve
from cosserat_casadi.codegen.compiled_motion import StepOptions
from cosserat_casadi.control import judged
from cosserat_casadi.numerics.collocation import radau
from tests.codegen.test_load import cached, needs_compiler
from tests.conftest import ROOT
from tests.control.swing import STEP, optimum, task
from tests.scenes import push, scene


@pytest.fixture(scope="module")
def planar() -> Model:
    """A rod whose modes were chosen for a push within a plane."""
    pushed = scene(push(force=[0.3, 0.0, -0.2]), accuracy={"tolerance": 1e-4})
    return build(pushed, solve(pushed).model.discretisation)


def test_an_optimum_is_the_equilibrium_at_its_unknowns(planar: Model) -> None:
    inputs = planar.pack({"push.force": [0.2, 0.0, -0.1]})
    wanted = solve(planar, inputs)
    # As exact as an optimiser leaves it.
    optimum = judged(planar, wanted.x + 1e-6, inputs)
    assert optimum.converged
    assert optimum.stable == wanted.stable
    assert_allclose(optimum.x, wanted.x, rtol=0, atol=1e-10)
    assert_allclose(optimum.error_estimate, wanted.error_estimate, rtol=1e-4, atol=1e-12)


def test_an_optimum_beyond_the_modes_is_told(planar: Model) -> None:
    inputs = planar.pack({"push.force": [0.3, 3.0, -0.2]})
    optimum = judged(planar, solve(planar, inputs).x, inputs)
    assert optimum.converged
    assert optimum.within_tolerance is False
    assert "is above the tolerance of 0.0001" in optimum.message


def test_an_optimum_that_is_no_equilibrium_is_none(planar: Model) -> None:
    far = np.full(planar.size, 3.0)
    optimum = judged(planar, far, planar.pack())
    assert not optimum.converged
    assert optimum.within_tolerance is False
    # Newton's method would lead elsewhere: the unknowns are judged as they are.
    assert_allclose(optimum.x, far, rtol=0, atol=0)


def test_what_cannot_be_judged_is_refused(planar: Model) -> None:
    with pytest.raises(ValueError, match=f"the optimum has 1 unknowns, the model {planar.size}"):
        judged(planar, [0.0], planar.pack())
    touching = read_scene(ROOT / "examples" / "rod_over_bar.toml", ["accuracy.modes=3", "accuracy.nodes=8"])
    model = build(touching)
    with pytest.raises(SceneError, match="an optimum"):
        judged(model, model.unloaded(), model.pack())


# What an optimiser finds is a motion of the exported step in C, to the tolerance of its equations.


pytestmark = needs_compiler

EXACT = StepOptions(tolerance=1e-14, iterations=20)
"""What Newton's method leaves of the length is next to rounding."""


@pytest.mark.slow
def test_an_optimum_replays_in_c(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)
    # Steps in C have two stages.
    wanted = task(radau(2))
    found = optimum(wanted)
    export(wanted.stage.model, tmp_path / "arm", "arm", dynamics=True)
    library = load(tmp_path / "arm")
    state = library.rest(found.tensions[0], wanted.near.x)
    assert state is not None
    memory = library.step_memory()
    ends = [wanted.start]
    for tensions, rates in zip(found.tensions[:-1], np.diff(found.tensions, axis=0) / STEP, strict=True):
        step = library.step(state, STEP, tensions, rates, memory=memory, options=EXACT)
        assert step.done, step.status.value
        assert step.parts == 1
        state = step.state
        ends.append(wanted.stage.state(state.x, state.v))
    assert_allclose(np.array(ends), found.states, rtol=0, atol=1e-9)
