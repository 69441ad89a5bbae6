"""A compiled stage against the model: values, Jacobians, and second derivatives, exact or Gauss–Newton's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import ExportError, Model, build, discretise
from cosserat_casadi.accuracy.cost import STRAIGHT
from cosserat_casadi.codegen import stage as stage_module
from cosserat_casadi.codegen.stage import compiled_stage, stage_functions, written
from cosserat_casadi.compiling.printed_files import external_sources
from tests.codegen.libraries import ARMS, HAND, LOAD, WRISTS
from tests.codegen.test_load import cached, needs_compiler
from tests.families import mostly_slow
from tests.scenes import WEIGHT, push, scene

pytestmark = needs_compiler

FLEXOR = {"name": "flexor", "kind": "tendon", "rod": "rod", "offset": [0.02, 0.0], "tension": 2.0}


@pytest.fixture(autouse=True)
def quick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)


def wire(modes: int = 3, nodes: int = 6) -> Model:
    wanted = scene(push(), WEIGHT, strain="planar", inputs=["push.force"])
    return build(wanted, discretise(wanted, modes, nodes))


def hand() -> Model:
    wanted = scene(LOAD, inputs=["load.force"], rods=ARMS, bodies=[HAND], joints=WRISTS)
    return build(wanted, discretise(wanted, 1, 3))


def somewhere(model: Model) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    return 0.2 * random.standard_normal(model.size), model.pack() + 0.1 * random.standard_normal(model.inputs.size)


@pytest.mark.parametrize(
    ("make", "longest"),
    mostly_slow([(wire, STRAIGHT), (wire, 0), (hand, STRAIGHT), (hand, 0)], quick=[(wire, 0)]),
    ids=["wire-straight", "wire-loops", "hand-straight", "hand-loops"],
)
def test_stage_vs_model(make: Callable[[], Model], longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stage_module, "STRAIGHT", longest)
    model = make()
    stage = compiled_stage(model, "stage_of_" + make.__name__)
    at = somewhere(model)
    names = [*[f"tip_{rod}" for rod in model.tip], *[f"body_{body}" for body in model.body]]
    assert stage.name_out() == ["residual", *names]
    poses = [pose(*at)[:2] for pose in (*model.tip.values(), *model.body.values())]
    expected = [model.residual(*at), *[ca.vertcat(*pose) for pose in poses]]
    for found, value in zip(stage(*at), expected, strict=True):
        assert_allclose(found.full(), value.full(), rtol=1e-12, atol=1e-13)
    slopes = stage.jacobian()(*at, *[ca.DM(*size) for size in map(stage.size_out, range(stage.n_out()))])
    pose_slopes = [
        block for pose in (*model.tip_jacobian.values(), *model.body_jacobian.values()) for block in pose(*at)
    ]
    assert_allclose(slopes[0].full(), model.jacobian(*at)[0].full(), rtol=1e-11, atol=1e-12)
    for found, value in zip(slopes[1:], [model.input_jacobian(*at), *pose_slopes], strict=True):
        assert_allclose(found.full(), value.full(), rtol=1e-11, atol=1e-12)


def hessian(function: ca.Function, model: Model, weights: np.ndarray) -> np.ndarray:
    """Of a Lagrangian: half the squared deviation of a position, and the residual times its multipliers."""
    x, inputs = ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size)
    residual, pose = function(x, inputs)
    lagrangian = ca.sumsqr(pose[:3] - ca.DM([0.3, 0.1, 0.6])) / 2 + ca.dot(weights, residual)
    both = ca.vertcat(x, inputs)
    return ca.Function("hessian", [x, inputs], [ca.hessian(lagrangian, both)[0]])(*somewhere(model)).full()


@pytest.mark.parametrize("longest", mostly_slow([STRAIGHT, 0], quick=[0]), ids=["straight", "loops"])
def test_second_derivatives_vs_model(longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stage_module, "STRAIGHT", longest)
    model = wire(2, 3)
    x, inputs = ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size)
    plain = ca.Function("plain", [x, inputs], [model.residual(x, inputs), ca.vertcat(*model.tip["rod"](x, inputs)[:2])])
    weights = np.linspace(-1.0, 2.0, model.size)
    exact = compiled_stage(model, "exact_stage")
    assert_allclose(hessian(exact, model, weights), hessian(plain, model, weights), rtol=1e-10, atol=1e-12)
    slopes = np.hstack([block.full() for block in model.tip_jacobian["rod"](*somewhere(model))])[:3]
    bare = hessian(compiled_stage(model, "bare_stage", curvature=False), model, weights)
    assert_allclose(bare, slopes.T @ slopes, rtol=1e-10, atol=1e-12)


def finger(**changes: object) -> Model:
    """A rod with a tendon, whose sections and actuator are wanted."""
    wanted = scene(actuators=[FLEXOR], strain="kirchhoff", inputs=["flexor.tension"], **changes)
    return build(wanted, discretise(wanted, 2, 4))


def test_sections_and_actuators_vs_model() -> None:
    model = finger()
    abscissae = [0.0, 0.4, 1.0]
    stage = compiled_stage(model, "finger_outputs", sections={"rod": abscissae}, actuators=["flexor"])
    assert stage.name_out() == ["residual", "tip_rod", "sections_rod", "tension_flexor", "length_flexor"]
    x, inputs = somewhere(model)
    _, tip, sections, tension, length = stage(x, inputs)
    expected = [ca.vertcat(*model.shape["rod"](x, inputs, X)) for X in abscissae]
    assert_allclose(sections.full(), ca.horzcat(*expected).full(), rtol=1e-12, atol=1e-13)
    assert_allclose(sections.full()[:, -1], tip.full()[:, 0], rtol=1e-12, atol=1e-13)
    effort, conjugate, slope = model.actuator["flexor"](x, inputs)
    assert_allclose([float(tension), float(length)], [float(effort), float(conjugate)], rtol=1e-12, atol=1e-14)
    outputs = [ca.DM(*stage.size_out(i)) for i in range(stage.n_out())]
    slopes = stage.jacobian()(x, inputs, *outputs)
    by_name = dict(zip(stage.jacobian().name_out(), slopes, strict=True))
    assert_allclose(by_name["jac_length_flexor_x"].full(), slope.full(), rtol=1e-11, atol=1e-13)
    assert_allclose(by_name["jac_tension_flexor_inputs"].full(), [[1.0]], rtol=0, atol=0)


@pytest.mark.slow
def test_second_derivatives_of_further_outputs_vs_model() -> None:
    """The length of a tendon and the pose of a section bend with x, the work of a tension is bilinear."""
    model = finger()
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    both = ca.vertcat(x, inputs)
    at = somewhere(model)

    def second(stage: ca.Function) -> np.ndarray:
        residual, _, section, tension, length = stage(x, inputs)
        lagrangian = ca.dot(np.linspace(1.0, 2.0, model.size), residual) + ca.sum1(section) + tension * length
        return ca.Function("second", [x, inputs], [ca.hessian(lagrangian, both)[0]])(*at).full()

    section = ca.vertcat(*model.shape["rod"](x, inputs, 0.4))
    results = [model.residual(x, inputs), ca.vertcat(*model.tip["rod"](x, inputs)[:2]), section]
    plain = ca.Function("plain", [x, inputs], [*results, *model.actuator["flexor"](x, inputs)[:2]])
    stage = compiled_stage(model, "finger_curved", sections={"rod": [0.4]}, actuators=["flexor"])
    assert_allclose(second(stage), second(plain), rtol=1e-9, atol=1e-12)


def test_code_of_second_derivatives_does_not_grow_with_their_columns() -> None:
    """One direction in a loop, and of the inputs, which the equations are linear in, none."""
    model = finger()
    *_, adjoint, second = stage_functions(model, "finger", True)
    assert second.nnz_out("jac_adj_inputs_inputs") == 0
    both = [second.nnz_out("jac_adj_x_inputs"), second.nnz_out("jac_adj_inputs_x")]
    assert both == [model.size, model.size]
    size = len(external_sources([second], "second", "long long int")["second.c"])
    of_adjoint = len(external_sources([adjoint], "adjoint", "long long int")["adjoint.c"])
    assert size < 6 * of_adjoint


def test_outputs_that_a_model_does_not_have_are_refused() -> None:
    with pytest.raises(ExportError) as refused:
        compiled_stage(wire(), sections={"wire": [0.5], "rod": [1.5]}, actuators=["flexor"])
    assert "sections.wire" in str(refused.value)
    assert "take one of rod" in str(refused.value)
    assert "sections.rod" in str(refused.value)
    assert "actuators.flexor" in str(refused.value)


def test_a_model_without_scalar_form_is_refused() -> None:
    wanted = scene(push(), strain="planar", inputs=["push.force"])
    with pytest.raises(ExportError, match="no scalar form"):
        compiled_stage(build(wanted, discretise(wanted, 2, 4, "permuted")))
    with pytest.raises(ExportError, match="no name for a C library"):
        compiled_stage(wire(), "a stage")


def test_each_section_adds_few_instructions_to_the_jacobian(monkeypatch: pytest.MonkeyPatch) -> None:
    """They share the variations of the rod; automatic differentiation takes 77 instructions for a section of it."""
    monkeypatch.setattr(stage_module, "STRAIGHT", 0)
    lengths = []
    for count in (1, 9):
        abscissae = np.linspace(0.1, 1.0, count).tolist()
        _, slopes, *_ = stage_functions(finger(), "finger", False, {"rod": abscissae})
        lengths.append(slopes.n_instructions())
    assert lengths[1] - lengths[0] < 8 * 20


@pytest.mark.slow
def test_progress_tells_of_what_is_written_and_compiled() -> None:
    told: list[tuple[str, int, int]] = []
    compiled_stage(wire(), "told_stage", progress=lambda *report: told.append(report))
    assert told[:4] == [("Writing told_stage in C", done, 4) for done in range(4)]
    assert told[4:] == [("Compiling told_stage", done, 4) for done in range(5)]


def test_a_long_function_is_not_wrapped_in_one_of_its_own_name() -> None:
    """Two functions of one name cannot both be printed: only another name asks for a function around."""
    x = ca.SX.sym("x")
    value = x
    for _ in range(STRAIGHT):
        value = ca.sin(value)
    long = ca.Function("long", [x], [value])
    assert written(long, "long") is long
    assert written(long, "other").name() == "other"
