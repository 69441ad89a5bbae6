"""Rows side by side give what rows one after the other give: numbers, iterations, outcomes."""

from __future__ import annotations

import ctypes
import os
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import Compiled, Model, Outcome, Scene, build, export, load, read_scene
from cosserat_casadi.codegen import lanes, rows
from cosserat_casadi.codegen.names import model_names
from cosserat_casadi.codegen.rows import RowLibrary, row_library
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.compiling import compiler
from cosserat_casadi.compiling.listing import UnknownOperationError
from cosserat_casadi.compiling.scalars_in_c import scalars_in_c
from cosserat_casadi.compiling.statements import LANES_OF_ROWS
from cosserat_casadi.compiling.texts import resource
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.libraries import ARMS, HAND, HARNESS, LOAD, WRISTS
from tests.conftest import ROOT
from tests.contact.test_verbs_in_contact import touching
from tests.equilibrium.test_strain_limits import on_grid, pulled
from tests.scenes import push, rod, scene

CONVERGED, NOT_FINITE = 0, 2

SMALL = {"modes": 2, "nodes": 3}

BUDGET = 32_000
"""Bytes of the equations in lanes of a small planar rod with two parameters."""

TENDON = {"name": "pull", "kind": "tendon", "rod": "rod", "tension": 0.6, "offset": [0.02, 0.01]}


@dataclass(frozen=True)
class Libraries:
    """Rows of a scene side by side, and one after the other."""

    together: RowLibrary
    apart: RowLibrary


@pytest.fixture(scope="module")
def planar() -> Libraries:
    return libraries(scene(push(), strain="planar", accuracy=SMALL))


def libraries(asked: Scene) -> Libraries:
    model = build(asked)
    found = Libraries(row_library(model, lanes=True), row_library(model))
    assert found.together.in_lanes
    assert not found.apart.in_lanes
    return found


def assert_same(library: Libraries, given: FloatArray) -> FloatArray:
    """Compare with the rows one after the other; parameters stand behind inputs."""
    found = library.together.solve(given)
    expected = library.apart.solve(given)
    # The order of sums is the same too, but for a residual that is nothing but rounding.
    assert_array_equal(found[:, :2], expected[:, :2])
    assert_allclose(found[:, 2:], expected[:, 2:], rtol=1e-12, atol=1e-12)
    return found


def pushes(count: int, size: float) -> FloatArray:
    return np.random.default_rng(3).uniform(-size, size, (count, 3))


@pytest.mark.parametrize("count", [0, 1, 3, 17, 100])
def test_rows_of_any_number_are_the_same(planar: Libraries, count: int) -> None:
    found = assert_same(planar, pushes(count, 2.0))
    assert_array_equal(found[:, 0], CONVERGED)


def test_rows_whose_load_grows_in_steps_are_the_same(planar: Libraries) -> None:
    found = assert_same(planar, pushes(60, 3000.0))
    assert found[:, 1].max() > 20
    assert len(set(found[:, 0])) > 1


def test_rows_that_fail_leave_their_neighbours_alone(planar: Libraries) -> None:
    inputs = pushes(23, 1.0)
    inputs[4] = np.nan
    inputs[9, 1] = np.inf
    inputs[10] = 1e200
    found = assert_same(planar, inputs)
    assert found[4, 0] == found[9, 0] == NOT_FINITE
    assert found[10, 0] != CONVERGED
    assert np.isnan(found[[4, 9, 10], 3:]).all()
    sound = np.delete(np.arange(23), [4, 9, 10])
    assert_array_equal(found[sound], planar.together.solve(inputs[sound]))


@pytest.mark.slow
def test_tendons_are_the_same() -> None:
    library = libraries(scene(push(), accuracy=SMALL, actuators=[TENDON]))
    inputs = np.column_stack([pushes(14, 0.5), np.linspace(0.0, 4.0, 14)])
    found = assert_same(library, inputs)
    assert_array_equal(found[:, 0], CONVERGED)
    assert np.ptp(found[:, -1]) > 1e-3


@pytest.mark.slow
def test_paths_that_vanish_are_told_alike() -> None:
    """Tensions around the one at which a planar rod has pressed its tendon's path to nothing."""
    library = libraries(on_grid(pulled("planar", 50.0), modes=2, nodes=8))
    found = assert_same(library, np.array([80.0, 90.0, 95.0, 99.8, 100.2, 110.0, 120.0])[:, None])
    vanished = OUTCOMES.index(Outcome.PATH_VANISHED)
    assert_array_equal(found[:, 0], [CONVERGED] * 4 + [vanished] * 3)


def test_judged_rows_are_the_same() -> None:
    model = build(scene(push(), strain="planar", accuracy=SMALL))
    inputs = pushes(30, 20.0)
    inputs[4] = np.nan
    together = row_library(model, stability=True, lanes=True)
    assert together.in_lanes
    found = together.solve(inputs)
    expected = row_library(model, stability=True).solve(inputs)
    assert_array_equal(found[:, [0, 1, -1]], expected[:, [0, 1, -1]])
    assert_allclose(found[:, -2], expected[:, -2], rtol=1e-12, atol=1e-12)
    assert np.ptp(found[np.isfinite(found[:, -2]), -2]) > 1e-3


def with_parameters() -> Scene:
    """A planar rod whose length and pre-curvature differ from row to row."""
    bent = rod("planar", intrinsic={"curvature": [0.0, 0.4, 0.0]})
    named = ["rod.length", "rod.intrinsic.curvature.y"]
    return scene(push(), rods=[bent], accuracy=SMALL, parameters=named)


def drawn_parameters(model: Model, count: int) -> FloatArray:
    own = model.parameters.pack()
    return own * np.random.default_rng(5).uniform(0.8, 1.2, (count, len(own)))


def test_rows_of_parameters_are_the_same() -> None:
    model = build(with_parameters())
    library = libraries(with_parameters())
    inputs = pushes(30, 2.0)
    parameters = drawn_parameters(model, 30)
    found = assert_same(library, np.hstack([inputs, parameters]))
    assert_array_equal(found[:, 0], CONVERGED)
    assert np.ptp(found[:, 3]) > 1e-3
    # One row of parameters that are no numbers, and loads that grow in steps.
    parameters[4, 0] = np.nan
    inputs[11:] *= 1000
    found = assert_same(library, np.hstack([inputs, parameters]))
    assert found[4, 0] == NOT_FINITE
    assert found[:, 1].max() > 20


def test_code_of_rows_of_parameters_stays_small() -> None:
    files = dict(row_library(build(with_parameters()), lanes=True).files)
    assert len(files["sweep_lanes.c"]) <= BUDGET


def test_kernels_too_long_for_lanes_are_known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # What another test has written of these rods lies in the cache of all.
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(lanes, "STRAIGHT_IN_LANES", 500)
    assert not row_library(build(scene(push(), accuracy=SMALL, actuators=[TENDON])), lanes=True).in_lanes


def test_a_compiler_without_vectors_solves_row_after_row(planar: Libraries, monkeypatch: pytest.MonkeyPatch) -> None:
    inputs = pushes(7, 1.0)
    expected = planar.together.solve(inputs)
    monkeypatch.setattr(compiler, "FLAGS", (*compiler.FLAGS, "-DLANES=0"))
    rows._library.cache_clear()
    assert_array_equal(planar.together.solve(inputs), expected)
    rows._library.cache_clear()


def strip() -> Scene:
    return scene(push(), strain="planar", accuracy=SMALL)


def hand() -> Scene:
    return scene(LOAD, rods=ARMS, bodies=[HAND], joints=WRISTS, accuracy={"modes": 1, "nodes": 2})


def test_assemblies_have_no_form_for_lanes() -> None:
    model = build(hand())
    assert lanes.in_lanes(model, model_names("sweep", model)) is None


def exported(asked: Scene, folder: Path) -> Compiled:
    return load(export(build(asked), folder, folder.name, batches=True, estimate_errors=False))


def assert_batch_is_single_solves(library: Compiled, inputs: FloatArray, parameters: FloatArray | None = None) -> None:
    found = library.solve_batch(inputs, parameters=parameters)
    assert len(found) == len(inputs)
    for row, (one, own) in enumerate(zip(found, inputs, strict=True)):
        single = library.solve(own, parameters=None if parameters is None else parameters[row])
        assert one.outcome is single.outcome
        assert (one.iterations, one.jacobians) == (single.iterations, single.jacobians)
        assert one.load_factor == single.load_factor
        assert_allclose(one.x, single.x, rtol=1e-12, atol=1e-12)


def test_exported_batches_are_single_solves(tmp_path: Path) -> None:
    """Loads that grow in steps, and cases that fail, among them."""
    library = exported(scene(push(), strain="planar", accuracy=SMALL), tmp_path / "strip")
    inputs = np.vstack([pushes(40, 2.0), pushes(40, 3000.0)])
    inputs[4] = np.nan
    inputs[10] = 1e200
    assert_batch_is_single_solves(library, inputs)
    assert library.solve_batch(np.zeros((0, 3))) == []
    # What is the library's own is seen by no linker.
    assert hasattr(library._handle, "strip_batch_workspace_size")
    assert library.manifest["batches"].startswith("four load cases at a time")
    assert not any(hasattr(library._handle, f"{prefix}gather_lanes") for prefix in ("", "strip_"))


def branching() -> Scene:
    example = read_scene(ROOT / "examples" / "branching_rod.toml")
    return on_grid(example.model_copy(update={"inputs": ("weight.acceleration",)}), modes=1, nodes=2)


@pytest.mark.parametrize(
    ("asked", "size"),
    [
        pytest.param(hand(), 0.3, id="hand"),
        pytest.param(branching(), 10.0, id="branching", marks=pytest.mark.slow),
        pytest.param(touching("rods on rods"), 0.1, id="touching", marks=pytest.mark.slow),
        pytest.param(touching("these with friction"), 0.1, id="rubbing", marks=pytest.mark.slow),
    ],
)
def test_batches_without_a_form_for_lanes_are_single_solves(asked: Scene, size: float, tmp_path: Path) -> None:
    """Cases that fail leave others alone; header, README and manifest say that cases are solved one by one."""
    library = exported(asked, tmp_path / "robot")
    inputs = library.defaults + np.random.default_rng(3).uniform(-size, size, (12, library.defaults.size))
    inputs[4] = np.nan
    inputs[7] = 1e200
    assert_batch_is_single_solves(library, inputs)
    outcomes = [one.outcome for one in library.solve_batch(inputs)]
    assert outcomes[4] is Outcome.NOT_FINITE
    assert outcomes[7] is not Outcome.CONVERGED
    assert outcomes.count(Outcome.CONVERGED) == 10
    told = library.manifest["batches"]
    assert told.startswith("one load case after the other")
    assert library._handle.robot_batch_workspace_size() == library._handle.robot_workspace_size()
    assert all(told in (tmp_path / "robot" / file).read_text() for file in ("robot.h", "README.md"))


def test_exported_batches_take_parameters(tmp_path: Path) -> None:
    asked = with_parameters()
    # A name that stands in the solver's own words.
    library = exported(asked, tmp_path / "batch")
    assert_batch_is_single_solves(library, pushes(30, 2.0), drawn_parameters(build(asked), 30))


@pytest.mark.parametrize(
    ("asked", "size", "flags"),
    [
        pytest.param(strip(), 2.0, ("-fopenmp",), id="threads", marks=pytest.mark.slow),
        pytest.param(strip(), 2.0, ("-DLANES=0",), id="none", marks=pytest.mark.slow),
        pytest.param(strip(), 2.0, ("-DSTRIP_SINGLE",), id="float"),
        pytest.param(hand(), 0.3, ("-fopenmp",), id="threads, one by one", marks=pytest.mark.slow),
        pytest.param(hand(), 0.3, ("-DSTRIP_SINGLE",), id="float, one by one", marks=pytest.mark.slow),
    ],
)
def test_batches_of_other_builds_are_those(asked: Scene, size: float, flags: tuple[str, ...], tmp_path: Path) -> None:
    """On four threads, without vectors, and in float, without a word from the compiler."""
    library = exported(asked, tmp_path / "strip")
    harness = (HARNESS / "batch.c").read_text().replace("@{name}_workspace", "@{name}_batch_workspace")
    (tmp_path / "batch.c").write_text(harness.replace("@{name}", "strip").replace("@{MACRO}", "STRIP"))
    folder = tmp_path / "strip"
    sources = [tmp_path / "batch.c", *(file for file in folder.glob("strip*.c") if "demo" not in file.name)]
    program = tmp_path / "batch"
    options = ["-O0", "-std=c99", "-Wall", "-Wextra", "-Wno-unused", "-Wno-unused-parameter", *flags]
    command = [compiler.find_compiler(), *options, f"-I{folder}", *map(str, sources), "-o", str(program), "-lm"]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    inputs = pushes(600, size)
    text = f"{len(inputs)}\n" + "\n".join(" ".join(map(repr, row)) for row in inputs.tolist())
    told = subprocess.run([str(program)], input=text, capture_output=True, text=True, check=True, timeout=100)
    found = np.array([line.split() for line in told.stdout.splitlines()], dtype=float)
    assert int(told.stderr) == len(inputs)
    tolerance = 1e-4 if "-DSTRIP_SINGLE" in flags else 1e-12
    for row, own in zip(found[::37], inputs[::37], strict=True):
        assert_allclose(row[2:], library.solve(own).x, rtol=tolerance, atol=tolerance)


def test_a_folder_holds_rows_side_by_side_and_motions(tmp_path: Path) -> None:
    """Their sources are parts of one file."""
    model = build(strip(), moving=True)
    library = load(export(model, tmp_path / "strip", batches=True, dynamics=True, estimate_errors=False))
    (row,) = library.solve_batch(model.pack())
    start = library.rest(x=row.x)
    assert start is not None
    # What is at rest in its equilibrium stays there.
    step = library.step(start, 1e-3, model.pack())
    assert step.done
    assert_allclose(step.state.x, library.solve().x, rtol=0, atol=1e-9)


def test_a_folder_without_batches_holds_nothing_of_them(tmp_path: Path) -> None:
    folder = export(build(scene(push(), strain="planar", accuracy=SMALL)), tmp_path / "strip", estimate_errors=False)
    assert not [file for file in folder.iterdir() if "lanes" in file.name]
    text = "".join(file.read_text() for file in folder.iterdir())
    assert "lanes" not in text and "batch_workspace" not in text and '"batches"' not in text


@pytest.mark.parametrize(
    ("written", "has_a_form"),
    [
        (lambda x: x[0] * x[1] - x[0] / 3.0, True),
        (lambda x: ca.sqrt(x[0]) + ca.exp(x[1]), True),
        (lambda x: ca.fmax(x[0], ca.fabs(x[1])), True),
        (lambda x: ca.if_else(x[0] < 2.0, x[1], 0.0), True),
        (lambda x: ca.tanh(x[0]), False),
    ],
)
def test_what_lanes_cannot_do_together_is_known(written: Callable[[ca.SX], ca.SX], has_a_form: bool) -> None:
    x = ca.SX.sym("x", 2)
    function = ca.Function("f", [x], [written(x)])
    if has_a_form:
        assert "ENTRY(0, 0)" in scalars_in_c(function, function, LANES_OF_ROWS).body
        return
    with pytest.raises(UnknownOperationError):
        scalars_in_c(function, function, LANES_OF_ROWS)


CHOICES: dict[str, Callable[[FloatArray, FloatArray], Any]] = {
    "less": lambda x, y: x < y,
    "at_most": lambda x, y: x <= y,
    "equal": lambda x, y: x == y,
    "unequal": lambda x, y: x != y,
    "not": lambda x, _: x == 0.0,
    "and": lambda x, y: (x != 0.0) & (y != 0.0),
    "or": lambda x, y: (x != 0.0) | (y != 0.0),
    "if": lambda x, y: np.where(x != 0.0, y, 0.0),
    "sign": lambda x, _: np.sign(x),
    "fmax": lambda x, y: np.fmax(x, y),
    "fmin": lambda x, y: np.fmin(x, y),
}
"""What numpy says of each choice in lanes, by its name behind ``lanes_``."""

OF_ONE = ("not", "sign")


def test_every_lane_chooses_for_itself() -> None:
    numbers = [0.0, -0.0, 1.0, -2.5, 1e-300, np.inf, -np.inf, np.nan]
    pairs = np.array([(x, y) for x in numbers for y in numbers])
    functions = [
        f"void {name}_of(const lanes *x, const lanes *y, lanes *z) {{ *z = lanes_{name}({operands}); (void)y; }}"
        for name, operands in zip(CHOICES, ["*x" if name in OF_ONE else "*x, *y" for name in CHOICES], strict=True)
    ]
    source = "\n".join(["#include <math.h>", "#define LANES 4", '#include "lanes_arithmetic.h"', *functions])
    texts = {"choices.c": source, "lanes_arithmetic.h": resource("c", "lanes_arithmetic.h")}
    library = ctypes.CDLL(os.fspath(compiler.compiled_texts("choices", texts, compiler.find_compiler())))
    for name, expected in CHOICES.items():
        function = library[f"{name}_of"]
        for first in range(0, len(pairs), 4):
            x, y = np.ascontiguousarray(pairs[first : first + 4].T)
            found = np.full(4, -7.0)
            function(*[ctypes.c_void_p(array.ctypes.data) for array in (x, y, found)])
            assert_array_equal(found, np.asarray(expected(x, y), dtype=float), err_msg=f"{name}({x}, {y})")


def test_rows_in_smooth_contact_are_the_same() -> None:
    """Some rows press with all of the rod, some with its tip, some with nothing."""
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -0.1], "normal": [0, 0, 1], "width": 8e-2}
    lying = rod("planar", base={"tangent": [1, 0, 0]})
    library = libraries(scene(push(), rods=[lying], accuracy={"modes": 2, "nodes": 4}, obstacles=[floor]))
    inputs = np.zeros((40, 3))
    inputs[:, 2] = np.linspace(-1.0, 0.3, 40)
    found = assert_same(library, inputs)
    assert_array_equal(found[:, 0], CONVERGED)


@pytest.mark.slow
def test_batches_of_a_library_may_have_any_name(tmp_path: Path) -> None:
    """Its own files are named after it, and no file that all libraries have is."""
    library = exported(scene(push(), strain="planar", accuracy=SMALL), tmp_path / "linear")
    assert_batch_is_single_solves(library, pushes(5, 1.0))
