"""What an optimiser finds is a motion of the exported step in C, to the tolerance of its equations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import export, load
from cosserat_casadi.codegen.compiled_motion import StepOptions
from cosserat_casadi.numerics.collocation import radau
from tests.codegen.test_load import cached, needs_compiler
from tests.control.swing import STEP, optimum, task

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
