"""Parameters of concentric tubes: a model with named numbers against models of scenes with these numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome, Scene, SceneError, build, export, load, parse_scene, solve
from cosserat_casadi.codegen.compiled_results import CompiledSolution
from cosserat_casadi.codegen.tubes.compiled import CompiledTubes
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.tube_functions import TubeFunctions

EXAMPLES = Path(__file__).parents[2] / "examples"

EXAMPLE = (EXAMPLES / "loaded_tubes.toml").read_text()

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

IN_C = 4


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
        pairs = zip(own, wanted, strict=False) if isinstance(own, tuple) else [(own, wanted)]
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


@pytest.mark.slow
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


def test_one_integration_gives_all_derivatives(model: TubeFunctions, equilibrium: FloatArray) -> None:
    p = model.parameters.pack()
    at = equilibrium, model.pack(), p
    *_, by_parameters, poses_by_parameters = model.sensitivity(*at)
    expected = model.parameter_jacobian(*at).full()
    assert_allclose(by_parameters.full() * p, expected * p, rtol=1e-10, atol=1e-12)
    # The pose, then its rotation matrix: by x, by inputs, by parameters.
    blocks = [block.full() for block in model.tip["inner"].jacobian()(*at, 0, 0, 0)]
    tip = np.vstack([blocks[2], blocks[5]])
    assert_allclose(poses_by_parameters.full()[7:] * p, tip * p, rtol=1e-10, atol=1e-12)


# In C


UNLOADED = (EXAMPLES / "concentric_tubes.toml").read_text()


class InC:
    """A robot with parameters in C, the same in Python, and other numbers of it."""

    def __init__(self, text: str, values: dict[str, float], folder: Path) -> None:
        self.model = build(parse_scene(f"parameters = {list(values)}\n{text}"), IN_C)
        self.own = build(parse_scene(text, [f"{name}={value!r}" for name, value in values.items()]), IN_C)
        self.p = self.model.parameters.pack(values)
        compiled = load(export(self.model, folder))
        assert isinstance(compiled, CompiledTubes)
        self.compiled = compiled

    def in_python(self, found: CompiledSolution) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Unknowns, inputs and parameters of the model of a solution in C."""
        robot = self.model.robot
        straight = np.concatenate([robot.rotations(found.inputs), np.eye(4)[0]])
        return found.x + straight[: self.model.size], found.inputs, self.p


@pytest.fixture(scope="module", params=["unloaded", pytest.param("loaded", marks=pytest.mark.slow)])
def in_c(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> InC:
    folder = tmp_path_factory.mktemp("c") / "robot"
    if request.param == "loaded":
        return InC(EXAMPLE + POKE, NAMES, folder)
    names = ("inner.curvature", "inner.straight", "outer.material.youngs_modulus")
    return InC(UNLOADED, {name: NAMES[name] for name in names}, folder)


def test_derivatives_in_c_are_those_of_python(in_c: InC) -> None:
    compiled, p = in_c.compiled, in_c.p
    found = compiled.solve(parameters=p)
    assert found.converged
    at = in_c.in_python(found)
    derivatives = compiled.parameter_sensitivity(found.inputs, found.x, parameters=p)
    assert derivatives is not None
    by_x, by_p = in_c.model.jacobian(*at)[0].full(), in_c.model.parameter_jacobian(*at).full()
    x_by_p = -np.linalg.solve(by_x, by_p)
    # Numbers of parameters are as different as a modulus and a density.
    assert_allclose(derivatives.x * p, x_by_p * p, rtol=0, atol=1e-10 * np.abs(x_by_p * p).max())
    pose_by_x, _, pose_by_p = [block.full() for block in in_c.model.tip["inner"].jacobian()(*at, 0, 0, 0)[:3]]
    expected = (pose_by_p + pose_by_x @ x_by_p) * p
    assert_allclose(derivatives.tips["inner"][:3] * p, expected, rtol=0, atol=1e-10 * np.abs(expected).max())
    assert compiled.error_estimate(found.inputs, found.x, parameters=p) == pytest.approx(found.error_estimate, rel=1e-3)
    assert compiled.error_estimate(found.inputs, found.x) is None


def test_rows_and_paths_in_c_take_parameters(in_c: InC) -> None:
    compiled, p = in_c.compiled, in_c.p
    rows = np.linspace(in_c.model.parameters.pack(), p, 3)
    batch = compiled.solve_batch(compiled.defaults, parameters=rows)
    assert all(one.converged for one in batch)
    followed = compiled.follow(compiled.defaults, compiled.defaults, batch[0].x, parameters=p)
    assert followed.converged
    turn = compiled.track(compiled.defaults, batch[1], parameters=p)
    for other in (batch[2], turn):
        assert_allclose(other.x, followed.x, rtol=0, atol=1e-8)
    tip = compiled.poses(compiled.defaults, followed.x, parameters=p)["inner"]
    own = solve(in_c.own, estimate_error=False)
    assert_allclose(tip[:3], own.tip("inner").position, rtol=0, atol=1e-9)
    short = np.where(np.array(compiled.parameters.names) == "inner.straight", 0.05, p)
    assert compiled.solve(parameters=short).outcome is Outcome.OUT_OF_RANGE
