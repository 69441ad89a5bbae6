"""Rods that touch rods with parameters, in vibration modes, inverse problems and C: each against another route."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eig

from cosserat_casadi import Model, Solution, build, export, inverse, load, modes_of, read_scene, solve
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.scene import Scene
from tests.conftest import ROOT

SMALL = ("accuracy.modes=2", "accuracy.nodes=4")


def fingers(*changes: str) -> Scene:
    """The fingers of the example on few modes."""
    return read_scene(ROOT / "examples" / "crossing_fingers.toml", [*SMALL, *changes])


@cache
def touching() -> tuple[Model, Solution]:
    """Their model and equilibrium."""
    model = build(fingers())
    found = solve(model)
    assert found.converged and found.stable, found.message
    return model, found


def test_the_fingers_press_each_other_where_they_cross() -> None:
    """They are mirror images but for the height of their bases; the clamps bear pulls that are in balance."""
    _, found = touching()
    (contact,) = found.contacts
    assert (contact.owner, contact.obstacle) == ("left", "right")
    assert contact.on_rods is not None
    assert_allclose(contact.on_rods[0], contact.on_rods[1], rtol=0, atol=1e-3)
    borne = found.base_wrench("left").force + found.base_wrench("right").force
    assert_allclose(borne, 0.0, rtol=0, atol=1e-12)
    # Without the other one the left finger is bent farther.
    alone = solve(build(fingers("rod_contacts=[]")))
    assert alone.tip("left").position[1] > found.tip("left").position[1] + 5e-3


@pytest.mark.slow
def test_a_parameter_of_rods_that_touch_is_a_number_of_the_scene() -> None:
    """The same equilibrium as of a scene with that number, though counted in other units."""
    name = "left.material.youngs_modulus"
    model = build(fingers(f'parameters=["{name}"]'))
    stiffer = solve(model, parameters={name: 3e6})
    other = solve(build(fingers(f"{name}=3e6")))
    assert stiffer.contacts and other.contacts
    for rod in ("left", "right"):
        assert_allclose(stiffer.tip(rod).position, other.tip(rod).position, rtol=0, atol=1e-9)
    assert_allclose(stiffer.contacts[0].force, other.contacts[0].force, rtol=1e-7, atol=1e-9)


def test_frequencies_are_those_of_the_differences_of_the_balance() -> None:
    model, found = touching()
    step = 1e-6
    columns = [
        (model.residual(found.x + change, found.inputs) - model.residual(found.x - change, found.inputs)) / (2 * step)
        for change in step * np.eye(model.size)
    ]
    stiffness = np.hstack([column.full() for column in columns])
    squares = eig(stiffness, model.mass_matrix(found.x, found.inputs).full(), right=False).real
    wanted = np.sqrt(np.sort(squares)[:4]) / (2 * np.pi)
    frequencies = [mode.frequency for mode in modes_of(found, count=4).modes]
    assert_allclose(frequencies, wanted, rtol=1e-5, atol=0)


@pytest.mark.slow  # second derivatives of all pairs of sections
def test_pulls_are_found_from_where_the_tips_are() -> None:
    """From weaker ones, with which the fingers touch too."""
    _, found = touching()
    tips = [(rod, found.tip(rod).position.tolist()) for rod in ("left", "right")]
    targets = ", ".join(f'{{ kind = "position", rod = "{rod}", position = {place} }}' for rod, place in tips)
    weaker = ["left_pull.force=[0.02, 0.03, 0]", "right_pull.force=[-0.02, -0.03, 0]"]
    free = 'inputs=["left_pull.force", "right_pull.force"]'
    back = inverse(build(fingers(f"targets=[{targets}]", free, *weaker)), estimate_error=False)
    assert back.met
    assert back.solution.contacts
    assert_allclose(back.solution.inputs, found.inputs, rtol=0, atol=1e-4)


@pytest.mark.slow  # a compiler runs
def test_c_finds_the_equilibria_and_derivatives_of_python(tmp_path: Path) -> None:
    model, found = touching()
    library = load(export(model, tmp_path / "fingers"))
    assert isinstance(library, Compiled)
    there = library.solve()
    assert there.converged
    assert_allclose(there.x, found.x, rtol=0, atol=1e-9)
    harder = model.pack({"left_pull.force": [0.02, 0.05, 0.0], "right_pull.force": [-0.02, -0.05, 0.0]})
    followed = library.follow(found.inputs, harder, found.x)
    assert followed.converged
    assert_allclose(followed.x, solve(model, harder, start=found).x, rtol=0, atol=1e-9)
    sensitivity = library.sensitivity(found.inputs, found.x)
    assert sensitivity is not None
    step = 1e-6 * np.eye(model.inputs.size)[1]
    moved = [solve(model, found.inputs + change, start=found).x for change in (step, -step)]
    assert_allclose(sensitivity[0][:, 1], (moved[0] - moved[1]) / 2e-6, rtol=1e-5, atol=1e-6)
