"""Parameters of concentric tubes: a model with named numbers against models of scenes with these numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, SceneError, build, parse_scene, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.tube_functions import TubeFunctions

EXAMPLE = (Path(__file__).parents[2] / "examples" / "loaded_tubes.toml").read_text()

POKE = """
[[loads]]
name = "poke"
kind = "point_wrench"
rod = "inner"
at = 0.9
force = [0.1, 0.0, 0.0]
"""

NAMES = {
    "inner.curvature": 16.5,
    "inner.straight": 0.175,
    "outer.curved": 0.11,
    "outer.material.youngs_modulus": 5.0e10,
    "inner.section.outer_radius": 0.85e-3,
    "inner.material.density": 5000.0,
    "poke.at": 0.85,
}

STEPS = 3


def parametric() -> Scene:
    """Two tubes with a force at the tip, one beside it, and their weight, and parameters of every kind."""
    return parse_scene(f"parameters = {list(NAMES)}\n{EXAMPLE}{POKE}")


def elsewhere() -> TubeFunctions:
    """The model of a scene whose numbers are others."""
    return build(parse_scene(EXAMPLE + POKE, [f"{name}={value!r}" for name, value in NAMES.items()]), STEPS)


@pytest.fixture(scope="module")
def model() -> TubeFunctions:
    return build(parametric(), STEPS)


@pytest.fixture(scope="module")
def equilibrium(model: TubeFunctions) -> FloatArray:
    return solve(model, estimate_error=False).x


def test_elsewhere_it_is_the_model_with_these_numbers(model: TubeFunctions, equilibrium: FloatArray) -> None:
    p = model.parameters.pack(NAMES)
    inputs = model.pack()
    other = elsewhere()
    for word in ("residual", "jacobian", "input_jacobian", "energy", "tips", "sensitivity", "stations"):
        own = getattr(model, word)(equilibrium, inputs, p)
        wanted = getattr(other, word)(equilibrium, inputs)
        pairs = zip(own, wanted, strict=True) if isinstance(own, tuple) else [(own, wanted)]
        for one, expected in pairs:
            assert_allclose(one.full(), expected.full(), rtol=1e-11, atol=1e-11)


def test_derivatives_with_the_parameters_are_difference_quotients(
    model: TubeFunctions, equilibrium: FloatArray
) -> None:
    p = model.parameters.pack()
    inputs = model.pack()
    columns = model.parameter_jacobian(equilibrium, inputs, p).full()
    for index, value in enumerate(p):
        step = 1e-5 * value * np.eye(len(p))[index]
        ends = [model.residual(equilibrium, inputs, p + sign * step).full().ravel() for sign in (2, 1, -1, -2)]
        difference = (ends[3] - ends[0] + 8 * (ends[1] - ends[2])) / (12 * step[index])
        assert_allclose(columns[:, index], difference, rtol=1e-6, atol=1e-9 / value)


def test_an_equilibrium_elsewhere_is_that_of_a_scene_of_its_own(model: TubeFunctions) -> None:
    found = solve(model, parameters=NAMES, estimate_error=False)
    wanted = solve(elsewhere(), estimate_error=False)
    assert found.converged
    assert_allclose(found.tip("inner").position, wanted.tip("inner").position, rtol=0, atol=1e-12)
    # A scene is solved with its own numbers.
    own = solve(parse_scene(f"parameters = {list(NAMES)}\n{EXAMPLE}{POKE}", ["accuracy.tolerance=1e-3"]))
    nominal = solve(model, estimate_error=False)
    assert_allclose(own.tip("inner").position, nominal.tip("inner").position, rtol=0, atol=1e-4)


def test_without_parameters_no_function_has_an_argument_for_them(model: TubeFunctions) -> None:
    plain = build(parametric().baked(), STEPS)
    assert plain.residual.name_in() == ["x", "inputs"]
    assert plain.path_residual.name_in() == ["x", "inputs", "load_factor"]
    assert model.residual.name_in() == ["x", "inputs", "p"]
    assert plain.parameters.size == 0
    assert model.at().residual.n_instructions() == plain.residual.n_instructions() < model.residual.n_instructions()


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("inner.rotation", "is an input already"),
        ("inner.stiffness.bending", "is not given in the scene"),
        ("inner.straigt", "has no 'straigt'"),
    ],
)
def test_what_is_no_parameter_is_refused(name: str, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        parse_scene(f'parameters = ["{name}"]\n{EXAMPLE}')


def test_values_that_the_scene_refuses_are_refused(model: TubeFunctions) -> None:
    with pytest.raises(SceneError, match="must be at most the length of the tube"):
        model.at({"inner.straight": 0.01})
