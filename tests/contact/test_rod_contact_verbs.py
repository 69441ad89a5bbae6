"""Rods that touch rods with parameters, in vibration modes, inverse problems and C: each against another route."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eig

from cosserat_casadi import Model, Solution, build, export, inverse, load, modes_of, read_scene, solve
from cosserat_casadi.codegen.acados import acados_functions
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.stage import stage_functions
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene import Scene
from tests.conftest import ROOT
from tests.derivatives import central_differences

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
    stiffness = central_differences(lambda x: model.residual(x, found.inputs), found.x, 1e-6)
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


def test_a_stage_of_an_optimiser_has_the_equations_of_rods_that_touch() -> None:
    """Values and Jacobians are those of the model, second derivatives those of differences."""
    model, found = touching()
    plain, slopes, adjoint, second = stage_functions(model, "fingers", curvature=True)
    at = [found.x, found.inputs]
    outputs = [0] * plain.n_out()
    assert_allclose(plain(*at)[0].full(), model.residual(*at).full(), rtol=0, atol=1e-14)
    assert_allclose(slopes(*at, *outputs)[0].full(), model.jacobian(*at)[0].full(), rtol=1e-12, atol=1e-12)
    # Of the residual alone.
    weights = np.random.default_rng(2).standard_normal(model.size)
    multipliers = [weights, *[0] * (plain.n_out() - 1)]
    by_hand = model.jacobian(*at)[0].full().T @ weights
    assert_allclose(adjoint(*at, *outputs, *multipliers)[0].full()[:, 0], by_hand, rtol=1e-11, atol=1e-11)
    hessian = second(*at, *outputs, *multipliers, 0, 0)[0].full()
    differences = central_differences(lambda x: adjoint(x, found.inputs, *outputs, *multipliers)[0], found.x, 1e-6)
    assert_allclose(hessian, differences, rtol=0, atol=1e-8 * abs(differences).max())
    # But for the contact no equation would have strains of both fingers.
    half = model.size // 2
    assert abs(hessian[:half, half:]).max() > 1e-2


@pytest.mark.parametrize("moving", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["at rest", "in motion"])
def test_acados_is_given_rods_that_touch(moving: bool) -> None:
    """Jacobians of the DAE are those of its central differences, where the fingers press and rub each other."""
    _, found = touching()
    model = build(fingers("rod_contacts.0.friction=0.3"), moving=moving)
    functions = acados_functions(model, "fingers", moving=moving)
    count, size = model.inputs.size, model.size
    random = np.random.default_rng(4)
    rates = [0.1 * random.standard_normal(count), 0.1 * random.standard_normal(count)]
    at = [found.inputs, *rates, found.x]
    if moving:
        velocity = 0.1 * random.standard_normal(size)
        at = [np.concatenate([found.x, velocity, found.inputs]), np.zeros(2 * size + count), rates[1], np.zeros(0)]
    whole = next(function for function in functions if function.name().endswith("fun_jac_x_xdot_u_z"))
    value, *blocks = whole.call([*map(ca.DM, at), 0, ca.DM(0, 1)])
    if not moving:
        assert_allclose(value.full()[count:], model.residual(found.x, found.inputs).full(), rtol=0, atol=1e-14)
    for i, block in enumerate(blocks):
        assert_allclose(
            block.full(), _differences(functions[0], at, i), rtol=1e-6, atol=1e-6 * abs(block.full()).max(initial=1.0)
        )


def _differences(function: ca.Function, at: list[FloatArray], i: int) -> FloatArray:
    """Central differences of a function with one of its first arguments, column by column."""
    columns = []
    for way in np.eye(len(at[i])):
        sides = []
        for sign in (1e-6, -1e-6):
            moved = [*at]
            moved[i] = at[i] + sign * way
            sides.append(function.call([*map(ca.DM, moved), 0, ca.DM(0, 1)])[0].full()[:, 0])
        columns.append((sides[0] - sides[1]) / 2e-6)
    return np.array(columns).reshape(-1, function.size1_out(0)).T
