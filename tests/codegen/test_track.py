"""A control loop in C: solution and derivatives turn after turn, each begun with the Jacobian of the turn before."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from tests.codegen.libraries import QUICK, Exported, run

Library = Callable[[str], Exported]

TURNS = 60


def loop(made: Exported, step: float) -> dict[str, Any]:
    """Turns of a loop whose inputs wander about the scene's own, step by step."""
    program = made.program("track.c", *QUICK)
    printed = run(program, *[repr(float(value)) for value in made.model.pack()], repr(step))
    found: dict[str, Any] = json.loads(printed)
    return found


@pytest.mark.parametrize("name", ["planar", "spatial", "pair", "tendons", "robot"])
def test_track_vs_solve_and_sensitivity(library: Library, name: str) -> None:
    """The same solution and, at it, the same derivatives bit for bit; what is not finite is called so and survived."""
    found = loop(library(name), 0.2)
    assert found["converged"] == TURNS - 1
    # Both residuals are below 1e-11; the tension of a short cable is softest to them.
    assert found["off"] < 1e-7
    assert found["off_slope"] == 0.0
    # What was given no number keeps the solution and the Jacobian of the turn before.
    assert (found["lost"], found["kept"]) == (2, 1)


@pytest.mark.parametrize("name", ["spatial", "robot"])
def test_small_turns_need_no_jacobian_but_that_of_the_derivatives(library: Library, name: str) -> None:
    assert loop(library(name), 0.02)["jacobians"] == 0
