"""Parameters of a scene in C: functions, solutions and derivatives against the model's own and against differences."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Compiled, ExportError, SceneError, build, discretise, export, load, solve
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.names import library_names
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.rows import row_library
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from tests.codegen.libraries import ARCH, ARMS, HAND, LOAD, QUICK, WRISTS, Exported, Recipe, gcc, run
from tests.codegen.libraries import PIN as ARCH_PIN
from tests.families import mostly_slow
from tests.scenes import WEIGHT, push, rod, scene

TAPERED = {
    "name": "rod",
    "length": 0.8,
    "strain": "kirchhoff",
    "material": {"youngs_modulus": 1.0e7, "poisson_ratio": 0.4, "density": 1100.0},
    "section": {"shape": "circle", "radius": [0.02, 0.015]},
    "intrinsic": {"curvature": [0.2, [0.9, 0.3], 0.0]},
}
UNIFORM = {**TAPERED, "section": {"shape": "circle", "radius": 0.02}}
OFFSET = {
    "name": "pull",
    "kind": "tendon",
    "rod": "rod",
    "tension": 0.6,
    "offset": [[0.02, -0.005], 0.0],
    "span": [0, 0.7],
}
PIN = {"rod": "rod", "kind": "pinned", "position": [0.2, 0.15, 0.6]}

RECIPES = {
    "pwire": Recipe(
        scene(
            push(),
            WEIGHT,
            rods=[TAPERED],
            actuators=[OFFSET],
            parameters=[
                "rod.material.youngs_modulus",
                "rod.section.radius.tip",
                "rod.intrinsic.curvature.y",
                "pull.offset.x[1]",
                "pull.span.end",
            ],
        ),
        2,
        4,
    ),
    "puniform": Recipe(scene(push(), rods=[UNIFORM], parameters=["rod.material.youngs_modulus"]), 2, 4),
    "ppinned": Recipe(
        scene(WEIGHT, supports=[PIN], inputs=[], parameters=["supports[0].position", "weight.acceleration"]), 2, 5
    ),
    "probot": Recipe(
        scene(
            LOAD,
            rods=ARMS,
            bodies=[HAND],
            joints=WRISTS,
            parameters=["left.length", "joints[0].position.x", "hand.mass", "right.base.position"],
        ),
        2,
        4,
    ),
}
"""A rod with a tendon, one whose modulus alone is named, one that is held at both ends, and an assembly, rod by rod."""

PINNED_ARCH = scene(WEIGHT, **ARCH, supports=[ARCH_PIN], inputs=[], parameters=["supports[0].position"])

STEP = 1e-5
"""Change of a parameter for differences, relative."""


@pytest.fixture(params=mostly_slow(RECIPES, quick=["pwire", "puniform", "probot"]))
def made(request: pytest.FixtureRequest, export_recipe: Callable[[str, Recipe], Exported]) -> Exported:
    return made_of(export_recipe, request.param)


KEPT: dict[str, Exported] = {}


def made_of(export_recipe: Callable[[str, Recipe], Exported], name: str) -> Exported:
    """Models are built once."""
    if name not in KEPT:
        KEPT[name] = export_recipe(name, RECIPES[name])
    return KEPT[name]


def other_parameters(exported: Exported) -> FloatArray:
    """Parameters that are not the scene's own."""
    return exported.model.parameters.pack() * 1.05


def test_functions_are_those_of_the_model(made: Exported) -> None:
    model, compiled = made.model, made.compiled
    random = np.random.default_rng(3)
    x = 0.1 * random.standard_normal(model.size)
    inputs = model.inputs.pack()
    p = other_parameters(made)
    size, count, columns = model.size, model.inputs.size, len(p)
    work = compiled._workspace()
    jacobian, residual = np.zeros((size, size)), np.zeros(size)
    by_inputs, by_parameters = np.zeros((count, size)), np.zeros((columns, size))
    arguments = [pointer(x), pointer(inputs), pointer(p)]
    compiled._function("residual_jacobian")(*arguments, pointer(jacobian), pointer(residual), work)
    compiled._function("input_jacobian")(*arguments, pointer(by_inputs), pointer(by_parameters), work)
    wanted_jacobian, wanted_residual = model.jacobian(x, inputs, p)
    close(residual, wanted_residual.full()[:, 0])
    close(jacobian.T, wanted_jacobian.full())
    close(by_inputs.T, model.input_jacobian(x, inputs, p).full())
    close(by_parameters.T, model.parameter_jacobian(x, inputs, p).full())
    close(compiled.residual(x, inputs, p).full()[:, 0], wanted_residual.full()[:, 0])
    for name in model.tip:
        own = model.discrete.unknowns.strain(name)
        for found, wanted in (
            (compiled.tip[name](x, inputs, p), model.tip[name](x, inputs, p)[:2]),
            (compiled.tip_jacobian[name](x, inputs, p), model.tip_jacobian[name](x, inputs, p)),
            (compiled.shape[name](x, inputs, p, 0.3), model.shape[name](x, inputs, p, 0.3)),
            (
                compiled.igm[name](x[own], [0.1, 0, 0], [1, 0, 0, 0], inputs, p),
                model.igm[name](x[own], [0.1, 0, 0], [1, 0, 0, 0], inputs, p),
            ),
        ):
            for one, other in zip(found, wanted, strict=True):
                close(one.full(), other.full())
    for name in model.body:
        for one, other in zip(
            compiled.body_jacobian[name](x, inputs, p), model.body_jacobian[name](x, inputs, p), strict=True
        ):
            close(one.full(), other.full())
    for name in model.actuator:
        for one, other in zip(compiled.actuator[name](x, inputs, p), model.actuator[name](x, inputs, p), strict=True):
            close(one.full(), other.full())


def close(found: FloatArray, wanted: FloatArray) -> None:
    assert_allclose(found, wanted, rtol=1e-12, atol=1e-12 * max(1.0, float(np.abs(wanted).max(initial=0.0))))


def test_solutions_are_those_of_the_solver_in_python(made: Exported) -> None:
    p = other_parameters(made)
    inputs = made.model.inputs.pack()
    found = made.compiled.solve(inputs, parameters=p)
    wanted = solve(made.model, parameters=p)
    assert found.converged
    assert wanted.converged
    assert_allclose(found.x, wanted.x, rtol=0, atol=1e-9 * (1 + np.abs(wanted.x).max()))
    # The parameters matter.
    assert np.abs(found.x - made.compiled.solve(inputs).x).max() > 1e-4
    named = made.compiled.solve(inputs, parameters=made.model.parameters.unpack(p))
    assert_allclose(named.x, found.x, rtol=0, atol=0)


def test_derivatives_with_parameters(made: Exported) -> None:
    """By the implicit function theorem with the model's own Jacobians, and by differences of solutions."""
    model, compiled = made.model, made.compiled
    p = other_parameters(made)
    inputs = model.inputs.pack()
    x = polished(compiled, inputs, p, compiled.solve(inputs, parameters=p).x)
    found = compiled.parameter_sensitivity(inputs, x, parameters=p)
    assert found is not None
    jacobian = model.jacobian(x, inputs, p)[0].full()
    wanted = -np.linalg.solve(jacobian, model.parameter_jacobian(x, inputs, p).full())
    assert_allclose(found.x, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())
    d_poses = found.tips | found.bodies
    poses = compiled.tip | compiled.body
    for j in range(len(p)):
        change = np.zeros(len(p))
        change[j] = STEP * max(abs(p[j]), 1e-2)
        ends = [polished(compiled, inputs, p + side * change, x) for side in (1.0, -1.0)]
        slope = (ends[0] - ends[1]) / (2 * change[j])
        assert_allclose(found.x[:, j], slope, rtol=0, atol=1e-6 * max(np.abs(slope).max(), 1e-9))
        for name, pose in poses.items():
            both = [
                np.concatenate([part.full()[:, 0] for part in pose(end, inputs, p + side * change)])
                for end, side in zip(ends, (1.0, -1.0), strict=True)
            ]
            slope = (both[0] - both[1]) / (2 * change[j])
            assert_allclose(d_poses[name][:, j], slope, rtol=0, atol=2e-6 * max(np.abs(slope).max(), 1e-9))


def polished(compiled: Compiled, inputs: FloatArray, p: FloatArray, x: FloatArray) -> FloatArray:
    """An equilibrium near x to rounding: one within its tolerance has no sixth digit of a slope."""
    size = compiled.size
    jacobian, residual = np.zeros((size, size)), np.zeros(size)
    for _ in range(4):
        compiled._function("residual_jacobian")(
            pointer(x), pointer(inputs), pointer(p), pointer(jacobian), pointer(residual), compiled._workspace()
        )
        x = x - np.linalg.solve(jacobian.T, residual)
    return x


def test_derivatives_with_inputs_stay_what_they_are(made: Exported) -> None:
    model, compiled = made.model, made.compiled
    p = other_parameters(made)
    inputs = model.inputs.pack()
    x = compiled.solve(inputs, parameters=p).x
    found = compiled.sensitivity(inputs, x, parameters=p)
    assert found is not None
    jacobian = model.jacobian(x, inputs, p)[0].full()
    wanted = -np.linalg.solve(jacobian, model.input_jacobian(x, inputs, p).full())
    assert found[0].shape == (model.size, model.inputs.size)
    assert_allclose(found[0], wanted, rtol=0, atol=1e-9 * np.abs(wanted).max(initial=1e-9))


def test_a_path_leads_from_some_parameters_to_others(made: Exported) -> None:
    compiled, p = made.compiled, other_parameters(made)
    inputs = made.model.inputs.pack()
    start = compiled.solve(inputs).x
    found = compiled.follow(inputs, inputs, start, parameters=p)
    assert found.converged
    wanted = compiled.solve(inputs, parameters=p).x
    assert_allclose(found.x, wanted, rtol=0, atol=1e-8 * (1 + np.abs(wanted).max()))


def test_a_control_loop_takes_parameters(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    """Turn after turn with other parameters: solutions and derivatives are those of the solver."""
    exported = made_of(export_recipe, "pwire")
    compiled, model = exported.compiled, exported.model
    inputs = model.inputs.pack()
    memory = (ctypes.c_double * 4096)()
    x = compiled.solve(inputs).x.copy()
    by_parameters = np.zeros((model.parameters.size, model.size))
    poses = np.zeros((1, model.parameters.size, 7))
    for share in (1.01, 1.02, 1.03):
        p = model.parameters.pack() * share
        status = compiled._function("track")(
            pointer(inputs), pointer(p), pointer(x), memory, None, None, pointer(by_parameters), None, pointer(poses),
            compiled._workspace(), None,
        )  # fmt: skip
        assert status == 0
        assert_allclose(x, compiled.solve(inputs, parameters=p).x, rtol=0, atol=1e-9)
        wanted = compiled.parameter_sensitivity(inputs, x, parameters=p)
        assert wanted is not None
        assert_allclose(by_parameters.T, wanted.x, rtol=0, atol=1e-12 * np.abs(wanted.x).max())
        assert_allclose(poses[0].T, wanted.tips["rod"], rtol=0, atol=1e-12 * np.abs(wanted.tips["rod"]).max())


def test_rows_have_parameters_of_their_own(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    exported = made_of(export_recipe, "pwire")
    compiled = exported.compiled
    inputs = exported.model.inputs.pack()
    rows = np.linspace(0.8, 1.2, 70)[:, None] * exported.model.parameters.pack()
    found = compiled.solve_batch(inputs, parameters=rows)
    assert len(found) == len(rows)
    for row, own in zip(rows[::23], found[::23], strict=True):
        assert own.converged
        assert_allclose(own.x, compiled.solve(inputs, parameters=row).x, rtol=0, atol=0)
    with pytest.raises(ValueError, match="3 rows of parameters for 2 rows of inputs"):
        compiled.solve_batch(np.vstack([inputs, inputs]), parameters=rows[:3])


@pytest.mark.slow
def test_a_library_for_rows_takes_parameters(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    exported = made_of(export_recipe, "pwire")
    library = row_library(exported.model)
    inputs = np.tile(exported.model.inputs.pack(), (3, 1))
    rows = np.array([[0.9], [1.0], [1.1]]) * exported.model.parameters.pack()
    found = library.solve(np.hstack([inputs, rows]))
    for row, result in zip(rows, found, strict=True):
        own = exported.compiled.solve(inputs[0], parameters=row)
        tip = exported.compiled.tip["rod"](own.x, inputs[0], row)[0].full()[:, 0]
        assert_allclose(result[3:6], tip, rtol=0, atol=1e-9)
    with pytest.raises(ValueError, match=r"parameters must have shape \(count, \d+\), got \(3, 6\)"):
        library.solve(rows)


def test_parameters_that_are_not_finite_give_a_status(made: Exported) -> None:
    p = other_parameters(made)
    p[-1] = np.nan
    inputs = made.model.inputs.pack()
    assert made.compiled.solve(inputs, parameters=p).outcome is Outcome.NOT_FINITE
    assert made.compiled.parameter_sensitivity(inputs, np.zeros(made.model.size), parameters=p) is None


def test_what_is_no_value_of_the_parameters_is_refused(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    compiled = made_of(export_recipe, "pwire").compiled
    with pytest.raises(SceneError, match="parameters: must be 6 numbers, got 2"):
        compiled.solve(parameters=[1.0, 2.0])
    with pytest.raises(SceneError, match="is not a parameter of this model"):
        compiled.solve(parameters={"rod.length": 1.0})
    with pytest.raises(SceneError, match="must have 2 numbers, got 1"):
        compiled.solve(parameters={"rod.intrinsic.curvature.y": 1.0})
    with pytest.raises(ValueError, match=r"parameters must have shape \(count, 6\), got \(1, 4\)"):
        compiled.solve_batch(compiled.defaults, parameters=np.ones(4))


def test_the_manifest_says_what_the_parameters_are(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    exported = made_of(export_recipe, "pwire")
    layout = exported.model.parameters
    listed = exported.compiled.parameters
    assert listed.names == layout.names
    assert [entry.unit for entry in listed.entries] == ["Pa", "m", "1/m", "m", "1"]
    assert_allclose(listed.pack(), layout.pack(), rtol=0, atol=0)
    header = (exported.folder / "pwire.h").read_text()
    assert (
        "#define PWIRE_PARAMETER_ROD_INTRINSIC_CURVATURE_Y 2 /* 2 numbers, 1/m: rod.intrinsic.curvature.y */" in header
    )


PROGRAM = """
#include "pwire.h"
#include <stdio.h>
static pwire_workspace workspace;
int main(void) {
  const pwire_real inputs[] = PWIRE_DEFAULTS;
  pwire_real p[] = PWIRE_PARAMETER_DEFAULTS, x[PWIRE_UNKNOWNS] = {0}, d_p[7 * PWIRE_PARAMETERS];
  pwire_parameters named;
  pwire_results results;
  pwire_unpack_parameters(p, &named);
  named.rod_intrinsic_curvature_y[0] *= 1.5;
  pwire_pack_parameters(&named, p);
  if (pwire_solve(inputs, p, x, &workspace, 0) != PWIRE_CONVERGED) return 1;
  pwire_evaluate(x, inputs, p, &results);
  if (pwire_solve_sensitivity(inputs, p, x, 0, 0, 0, d_p, &workspace) != PWIRE_CONVERGED) return 2;
  const int curved = PWIRE_PARAMETER_ROD_INTRINSIC_CURVATURE_Y;
  printf("%.17g %.17g", results.tip.position[0], PWIRE_D_POSE_D_PARAMETER(d_p, PWIRE_POSE_TIP, 0, curved));
  return 0;
}
"""


def test_the_header_serves_a_program(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    exported = made_of(export_recipe, "pwire")
    source = exported.scratch / "named.c"
    source.write_text(PROGRAM)
    printed = run(exported.link([source], *QUICK, "-Wall", "-Wextra", "-Werror")).split()
    p = exported.model.parameters.pack()
    p[2] *= 1.5
    found = exported.compiled.solve(parameters=p)
    inputs = exported.model.inputs.pack()
    wanted = exported.compiled.parameter_sensitivity(inputs, found.x, parameters=p)
    assert wanted is not None
    tip = exported.compiled.tip["rod"](found.x, inputs, p)[0].full()[0, 0]
    assert_allclose([float(word) for word in printed], [tip, wanted.tips["rod"][0, 2]], rtol=1e-12)


@pytest.mark.parametrize("language", ["c99", pytest.param("c++20", marks=pytest.mark.slow)])
def test_sources_pass_every_lint(made: Exported, language: str) -> None:
    words = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wsign-conversion", "-Wvla", "-Werror")
    compiler = ("-x", "c++", "-Wno-c++20-extensions") if language == "c++20" else ()
    for flags in ((), (f"-D{made.names.macro}_SINGLE",), ("-fopenmp",)):
        gcc(f"-std={language}", *compiler, *words, *flags, "-fsyntax-only", made.folder / f"{made.name}.c")


def test_the_demo_program_takes_the_scene_s_own(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    exported = made_of(export_recipe, "pwire")
    assert '"status": "converged"' in run(exported.demo, "--repeat", "1")


def test_a_scene_without_parameters_has_no_word_of_them(export_recipe: Callable[[str, Recipe], Exported]) -> None:
    model = made_of(export_recipe, "pwire").model.at()
    for name, text in folder_files(model, "bare").items():
        if name.startswith("bare"):
            assert "parameters" not in text


def test_one_parameter_beside_no_inputs() -> None:
    described = scene(push(), strain="planar", inputs=[], parameters=["rod.stiffness.bending_y"])
    files = folder_files(build(described, discretise(described, 2, 4)), "one")
    assert "#define ONE_INPUTS 0\n" in files["one.h"]
    assert "#define ONE_PARAMETERS 1\n" in files["one.h"]


def test_names_that_are_one_in_c_are_refused() -> None:
    with pytest.raises(ExportError, match=r"'joints_0\.mass' and 'joints\.0\.mass' are one name in C"):
        library_names("robot", parameters=("joints_0.mass", "joints.0.mass"))


def test_values_by_name_are_judged_by_the_scene(tmp_path: Path) -> None:
    """As in Python; stacked ones are taken as they are."""
    model = RECIPES["ppinned"].model()
    folder = Path(export(model, tmp_path / "held", "held"))
    compiled = load(folder)
    pin = {"supports[0].position": [0.2, 0.1, 0.6]}
    assert_allclose(compiled.parameters.pack(pin), model.parameters.pack(pin), rtol=0, atol=0)
    beyond = {"supports[0].position": [2.0, 0.1, 0.6]}
    with pytest.raises(SceneError) as refusal:
        compiled.solve(parameters=beyond)
    with pytest.raises(SceneError) as in_python:
        solve(model, parameters=beyond)
    assert str(refusal.value) == str(in_python.value)
    stacked = np.array([2.0, 0.1, 0.6, 0.0, 0.0, 0.0])
    assert_allclose(compiled.parameters.stacked(stacked), stacked, rtol=0, atol=0)
    # Without its scene a folder has nobody to ask.
    (folder / "scene.toml").unlink()
    assert load(folder).parameters.pack(beyond)[0] == 2.0


def test_support_out_of_the_plane_of_its_rod_is_told(export_recipe: Callable[..., Exported]) -> None:
    """It holds the rod in its plane alone; C, which takes values as they are, would end beside it."""
    compiled = export_recipe("pinned_arch", Recipe(PINNED_ARCH, 2, 5), estimates=False).compiled
    inside = compiled.parameters.pack() + np.array([0.01, 0.0, -0.02])
    beside = inside + np.array([0.0, 1e-4, 0.0])
    solution = compiled.solve(parameters=inside)
    assert solution.converged
    tip = compiled.tip["rod"](solution.x, compiled.defaults, inside)[0]
    assert_allclose(tip.full()[:, 0], inside, rtol=0, atol=1e-9)
    assert compiled.solve(parameters=beside).outcome is Outcome.OUT_OF_PLANE
    assert compiled.solve(start=solution.x, parameters=beside).outcome is Outcome.OUT_OF_PLANE
    batch = compiled.solve_batch(compiled.defaults, parameters=np.array([beside, inside]))
    assert [one.outcome for one in batch] == [Outcome.OUT_OF_PLANE, Outcome.CONVERGED]


def test_hinge_that_is_turned_by_half_a_turn_has_the_same_line(export_recipe: Callable[..., Exported]) -> None:
    """A base turned about its tangent by half a turn has its planar rod in the plane of the hinge, less has it not."""
    hinge = {
        "name": "hinge",
        "rod": "rod",
        "at": 1.0,
        "kind": "revolute",
        "axis": [0, 1, 0],
        "position": [0.05, 0, 0.7],
    }
    tables = {"joints": [hinge], "inputs": [], "parameters": ["rod.base.quaternion"]}
    arch = scene(WEIGHT, rods=[rod("planar")], **tables)
    compiled = export_recipe("hinged_arch", Recipe(arch, 2, 5, dynamics=True), estimates=False).compiled
    half, less = ([np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)] for angle in (np.pi, 3.0))
    solution = compiled.solve(parameters=half)
    turned = scene(WEIGHT, rods=[rod("planar", base={"quaternion": half})], joints=[hinge], inputs=[])
    expected = solve(build(turned, discretise(turned, 2, 5)))
    assert solution.converged
    assert_allclose(solution.x, expected.x, rtol=0, atol=1e-8)
    assert compiled.solve(parameters=less).outcome is Outcome.OUT_OF_PLANE
    # A step looks at it too.
    state = compiled.rest(x=solution.x, parameters=half)
    assert state is not None
    statuses = [compiled.step(state, 1e-3, None, parameters=base).status.name for base in (half, less)]
    assert statuses == ["DONE", "OUT_OF_PLANE"]
