"""Turn after turn from the solution before: a solve that is near never begins again from the unloaded scene."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

from cosserat_casadi import Model, build, discretise, solve
from tests.families import mostly_slow
from tests.scenes import cable_lengths, three_cables

TURNS = 500


@pytest.fixture(scope="module")
def model() -> Model:
    wanted = three_cables()
    return build(wanted, discretise(wanted, 2, 4))


def refuse(*arguments: object) -> None:
    raise AssertionError("a warm solve began again from the unloaded scene")


@pytest.mark.parametrize("step", [pytest.param(2e-4, marks=pytest.mark.slow), 6e-4])
@pytest.mark.parametrize("kind", mostly_slow(["unknowns", "solution"], quick=["solution"]))
def test_cables_moved_turn_after_turn(model: Model, step: float, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    lengths = cable_lengths(step, TURNS)
    found = solve(model, model.inputs.unpack(lengths[0]))
    assert found.converged
    monkeypatch.setattr(importlib.import_module("cosserat_casadi.equilibrium.solve"), "load_path", refuse)
    furthest = 0.0
    for inputs in lengths[1:]:
        before = found
        found = solve(model, model.inputs.unpack(inputs), start=before if kind == "solution" else before.x)
        assert found.converged, found.message
        furthest = max(furthest, float(np.abs(found.x - before.x)[-3:].max()))
    # Tensions move by more than any shape may: they must not count.
    assert furthest > 1.0
