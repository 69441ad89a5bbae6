"""Jacobians by columns, and kernels in fours: the same numbers as by CasADi, to the last digit, at any width."""

from __future__ import annotations

import ctypes
import json
import re
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi import Discretisation, Model, build, export, load, scene_from_dict
from cosserat_casadi.codegen import kernel_files, kernels
from cosserat_casadi.codegen.columns import in_columns, on_path, pose_in_columns
from cosserat_casadi.codegen.kernels import scalar
from cosserat_casadi.codegen.names import library_names, scene_names
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.compiling import scalars_in_c as printer
from cosserat_casadi.compiling.listing import LANES, Listing, UnknownOperationError
from cosserat_casadi.compiling.printed_kernels import PrintedKernel
from cosserat_casadi.compiling.scalars_in_c import columns_in_fours, scalars_in_c, with_calls_in_fours
from cosserat_casadi.maths.calls import with_dense_results
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.model_functions import ModelFunctions
from cosserat_casadi.model.operations import operations
from tests.codegen.libraries import gcc, run

LOADS = {
    "dead force and couple at the tip": [
        {"kind": "tip_wrench", "force": [0.3, -0.2, 0.1], "moment": [0.01, 0.02, -0.01], "frame": "world"},
    ],
    "follower at the tip": [
        {"kind": "tip_wrench", "force": [0.3, -0.2, 0.1], "moment": [0.01, 0.02, -0.01], "frame": "body"},
    ],
    "spread forces, dead and following": [
        {"kind": "distributed_wrench", "force": [0.5, 0.1, -0.4], "frame": "world"},
        {"kind": "distributed_wrench", "force": [0.2, 0.3, 0.1], "moment": [0.01, 0.0, 0.02], "frame": "body"},
    ],
}


def model_of(strain: str, loads: str, *, elements: int = 1) -> Model:
    """A model of one wire, with modes that leave a lane empty."""
    section = {"shape": "circle", "radius": 1e-3}
    rod = {
        "name": "rod",
        "length": 0.5,
        "strain": strain,
        "section": section,
        "material": {"youngs_modulus": 2e9, "poisson_ratio": 0.3},
    }
    named = [{"name": f"load_{i}", "rod": "rod", **load} for i, load in enumerate(LOADS[loads])]
    scene = scene_from_dict({"schema": 1, "rods": [rod], "loads": named})
    modes = (3, 2, 2, 1, 2, 1) if strain == "reissner" else (3, 2, 2)
    breaks = tuple(np.linspace(0, 1, elements + 1).tolist())
    return build(scene, {"rod": Discretisation(modes, 5, breaks)})


def by_columns(model: Model, x: FloatArray, load_factor: float) -> FloatArray:
    """The Jacobian from the columns of its form, one after the other."""
    form = in_columns(on_path(model), "jacobian")
    assert form is not None
    columns = np.zeros((form.rows, form.stride))
    given = [x, model.pack(), load_factor]
    for j in range(form.stride):
        columns[:, j] = form.function(*given, columns.ravel(), form.turns[:, j])[1].full().ravel()
    jacobian: FloatArray = form.function(*given, columns.ravel(), form.turns[:, 0])[0].full()
    return jacobian


@pytest.mark.parametrize("loads", list(LOADS))
@pytest.mark.parametrize(("strain", "elements"), [("kirchhoff", 1), ("kirchhoff", 2), ("reissner", 1)])
def test_columns_make_the_jacobian(strain: str, elements: int, loads: str) -> None:
    model = model_of(strain, loads, elements=elements)
    x = np.random.default_rng(1).normal(scale=0.4, size=model.size)
    found = by_columns(model, x, 0.7)
    expected = model.path_jacobian(x, model.pack(), 0.7).full()
    assert_allclose(found, expected, rtol=0, atol=1e-14 * abs(expected).max())


@pytest.mark.parametrize("strain", ["kirchhoff", "reissner"])
def test_columns_make_the_derivatives_of_a_tip(strain: str) -> None:
    model = model_of(strain, "dead force and couple at the tip", elements=2)
    form = pose_in_columns(model, ModelFunctions.tip_jacobian.spec, "rod", "tip")
    assert form is not None
    given = [np.random.default_rng(1).normal(scale=0.4, size=model.size), model.pack()]
    nothing = np.zeros(form.rows * form.stride)
    columns = np.hstack([form.function(*given, nothing, turns)[-1].full() for turns in form.turns.T])
    found = form.function(*given, columns.ravel(), form.turns[:, 0])[:-1]
    for one, other in zip(found, model.tip_jacobian["rod"](*given), strict=True):
        assert_allclose(one.full(), other.full(), rtol=0, atol=1e-15)


def test_derivatives_of_a_tip_are_by_columns() -> None:
    scene = model_of("kirchhoff", "dead force and couple at the tip").scene
    model = build(scene, {"rod": Discretisation((8, 8, 8), 10)})
    every = kernels.kernels(model, scene_names("rod", model.scene), None)
    (printed,) = [kernel for kernel in every if kernel.name().endswith("_tip_jacobian")]
    straight = scalar(model.tip_jacobian["rod"], "tip_jacobian", 100_000)
    assert isinstance(printed, PrintedKernel)
    assert printed.columns
    assert straight is not None and printed.n_instructions() < straight.n_instructions()


def test_rows_of_columns_that_are_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    """A following force at a point leaves the linear strains beyond it alone."""
    push = {"kind": "tip_wrench", "force": [0.3, -0.2, 0.1]}
    pull = {"kind": "point_wrench", "at": 0.5, "force": [0.1, 0.2, 0.1], "frame": "body"}
    monkeypatch.setitem(LOADS, "dead at the tip, following within", [push, pull])
    model = model_of("reissner", "dead at the tip, following within", elements=2)
    form = in_columns(on_path(model), "jacobian")
    assert form is not None
    (columns,) = columns_in_fours(form, with_dense_results(model.path_jacobian, "jacobian")).columns.values()
    assert "FILL(columns" in columns


def test_columns_grow_by_groups_of_four() -> None:
    """Code of columns is that of four, however many there are: modes add instructions to straight-line code."""
    scene = model_of("kirchhoff", "dead force and couple at the tip").scene
    model = build(scene, {"rod": Discretisation((8, 8, 8), 10)})
    form = in_columns(on_path(model), "jacobian")
    assert form is not None
    assert form.stride == 24
    straight = scalar(model.path_jacobian, "jacobian", 100_000)
    assert straight is not None
    assert columns_in_fours(form, model.path_jacobian).statements < straight.n_instructions() / 4


@pytest.mark.parametrize("share", [0.3, 0.9, 1.1])
def test_a_longer_function_than_is_wanted_is_none(share: float) -> None:
    """Far longer ones are told before common terms are looked for, others after it."""
    function = model_of("kirchhoff", "dead force and couple at the tip").path_jacobian
    whole = scalar(function, "jacobian", 100_000)
    assert whole is not None
    straight = scalar(function, "jacobian", int(share * whole.n_instructions()))
    assert (straight is None) == (share < 1)


def test_a_jacobian_by_columns_that_is_far_too_long_is_not_looked_through() -> None:
    written = on_path(model_of("kirchhoff", "dead force and couple at the tip"))
    form = in_columns(written, "jacobian")
    assert form is not None
    statements = form.function.n_instructions()
    assert in_columns(written, "jacobian", statements) is not None
    assert in_columns(written, "jacobian", statements // 3) is None


def test_functions_that_look_alike_are_told_apart() -> None:
    """Two callees of one name with as many arguments and results."""
    x = ca.SX.sym("x", 2)
    one, other = (ca.Function("callee", [x], [x[0] + k * x[1]], {"never_inline": True}) for k in (2, 3))
    both = ca.Function("both", [x], [one(x) + other(5 * x)])
    called = [call.function for call in Listing(both).calls]
    assert [hash(function) for function in called] == [hash(one), hash(other)]
    body = scalars_in_c(both, both).body
    assert "MADE(both_callee)(w" in body
    assert "MADE(both_callee_1)(w" in body
    assert operations(both) == 2 + 2 + 1 + 2


def test_what_has_no_form_in_fours() -> None:
    literal = model_of("kirchhoff", "follower at the tip")
    chosen = Discretisation((2, 2, 2), 5, transport="permuted")
    assert in_columns(on_path(build(literal.scene, {"rod": chosen})), "jacobian") is None
    x = ca.SX.sym("x", 2)
    bell = ca.Function("bell", [x], [ca.erfinv(x[0])])
    with pytest.raises(UnknownOperationError):
        scalars_in_c(bell, bell)
    assert "sin" in scalars_in_c(ca.Function("sine", [x], [ca.sin(x)]), bell).body


@pytest.mark.parametrize("calls", [1, 4])
def test_functions_that_are_called_call_no_others(calls: int) -> None:
    """CasADi's own code has a form for calls within calls."""
    x = ca.SX.sym("x", 4)
    never = {"never_inline": True}
    inner = ca.Function("inner", [x[:2]], [x[0] * x[1]], never)
    outer = ca.Function("outer", [x[:2]], [inner(x[:2]) + x[0]], never)
    calling = ca.Function("calling", [x], [ca.vertcat(*[outer(x[i] * x[:2]) for i in range(calls)])])
    with pytest.raises(UnknownOperationError, match="a call in outer"):
        scalars_in_c(calling, calling)
    assert with_calls_in_fours(calling) is calling


@pytest.mark.parametrize("longest", [1000, 3])
def test_choices_and_parts_compute_what_casadi_does(
    longest: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Distances from obstacles choose; a long function is a row of parts that pass values on."""
    monkeypatch.setattr(printer, "LONGEST_OF_NUMBERS", longest)
    x = ca.SX.sym("x", 3)
    share = ca.fmin(ca.fmax(x[0], 0.25), x[1])
    chosen = ca.if_else(x[2] > 0.0, x[0] * share, ca.sin(x[1]))
    function = ca.Function("choice", [x], [ca.vertcat(share, chosen, ca.gradient(share**2 + chosen, x))])
    made = scalars_in_c(function, function)
    assert ("choice_part_1" in made.body) == (longest == 3)
    for given in ([0.5, 2.0, 1.0], [0.1, 2.0, -1.0], [3.0, 2.0, 0.0], [0.25, 0.2, 2.0]):
        numbers = computed_in_c(made, np.array(given), 5, tmp_path)
        assert_allclose(numbers, function(given).full()[:, 0], rtol=1e-15, atol=0)


def computed_in_c(kernel: PrintedKernel, given: FloatArray, size: int, folder: Path) -> FloatArray:
    """The result of a kernel with one argument, compiled."""
    name = kernel.name()
    target = folder / f"{name}.so"
    if not target.exists():
        for file, text in kernel_files.kernel_sources([kernel], library_names(name), name).items():
            (folder / file).write_text(text)
        wrapper = folder / "wrapper.c"
        wrapper.write_text(
            f'#include "{name}.c"\nvoid computed(const double *x, double *made) {{\n'
            f"  const double *given[] = {{x}};\n  double *results[] = {{made}};\n  double w[{kernel.reals + 1}];\n"
            f"  {name}(given, results, 0, w, 0);\n}}\n"
        )
        gcc("-std=c99", "-O1", "-Wall", "-Werror", "-fPIC", "-shared", wrapper, "-lm", "-o", target)
    numbers = np.zeros(size)
    ctypes.CDLL(str(target)).computed(pointer(given), pointer(numbers))
    return numbers


@pytest.fixture(scope="module")
def wire(tmp_path_factory: pytest.TempPathFactory) -> Path:
    model = model_of("reissner", "dead force and couple at the tip")
    return export(model, tmp_path_factory.mktemp("fours") / "wire", "wire")


def solved(folder: Path, target: Path, *flags: str) -> dict[str, object]:
    """What the demo prints, without times."""
    sources = [folder / f"wire{part}.c" for part in ("_demo", "", "_kernels")]
    gcc("-std=c99", "-O0", "-Wall", "-Wpedantic", "-Werror", *flags, *sources, "-lm", "-o", target)
    printed = json.loads(run(target, "--repeat", "1"))
    return {word: value for word, value in printed.items() if not word.endswith("_us")}


@pytest.mark.slow
def test_the_same_digits_at_any_width(wire: Path, tmp_path: Path) -> None:
    """In the widest vectors that there are, in those of any processor of the kind, and without vectors."""
    widest = solved(wire, tmp_path / "widest")
    assert widest["status"] == "converged"
    for macro in ("FOURS_ONCE", "FOURS_ONE_BY_ONE"):
        assert solved(wire, tmp_path / macro, f"-D{macro}") == widest


def test_lanes_that_are_left_over_are_not_read(wire: Path) -> None:
    """Seven columns take two groups of four: the last lane holds zeros."""
    form = in_columns(on_path(model_of("reissner", "dead force and couple at the tip")), "jacobian")
    assert form is not None
    assert form.stride == 2 * LANES
    assert_array_equal(form.turns[:, 7], 0)
    assert "wire_k_jacobian_columns_0" in (wire / "wire_kernels_in_fours.h").read_text()


def test_kernels_share_what_they_call(wire: Path) -> None:
    """Residual and IGM call the same functions of an interval, and the same kinematics, which are in the code once."""
    written = (wire / "wire_kernels_in_fours.h").read_text()
    bodies = re.findall(r"^static void MADE\((\w+)\)(.*?^\})", written, flags=re.M | re.S)
    assert len({body for _, body in bodies}) == len(bodies)
    assert written.count("static void MADE(wire_kernels_pulls)") == 1
    once = (wire / "wire_kernels.c").read_text()
    for kernel in ("residual", "igm"):
        own = re.findall(rf"^static (?:int|void) MADE\(wire_k_{kernel}(?:_part_\d+)?\).*?^\}}", once, flags=re.M | re.S)
        assert any("MADE(wire_kernels_pulls)(w" in text for text in own)
        assert any("MADE(wire_k_shared_0_0)(arg, res, w);" in text for text in own)


def test_only_columns_and_calls_are_compiled_for_each_width(wire: Path) -> None:
    """Kernels compute single numbers, apart from what they call: once is enough for them."""
    for_each_width = (wire / "wire_kernels_in_fours.h").read_text()
    once = (wire / "wire_kernels.c").read_text()
    assert not re.findall(r"^static int MADE", for_each_width, flags=re.M)
    assert "static void MADE(wire_k_jacobian_columns)" in for_each_width
    assert {"wire_k_jacobian", "wire_k_residual"} <= {*re.findall(r"^static int MADE\((\w+)\)", once, flags=re.M)}


@pytest.mark.parametrize("count", [2, 3, 4, 5, 9])
def test_calls_of_one_depth_are_made_together(count: int, tmp_path: Path) -> None:
    """Whole fours, and lanes that are left over; one by one below three calls. Calls of calls come behind them."""
    x = ca.SX.sym("x", 2)
    callee = ca.Function("callee", [x], [ca.vertcat(x[0] * x[1], x[0] - 3 * x[1])], {"never_inline": True})
    y = ca.SX.sym("y", count, 2)
    first = [callee(y[k, :].T) for k in range(count)]
    results = [callee(2 * made) for made in first]
    function = ca.Function("many", [y], [ca.vertcat(*results)])
    made = scalars_in_c(function, function)
    if count < 3:
        assert len(re.findall(r"MADE\(many_callee\)\(w \+ \d+, w \+ \d+\);", made.body)) == 2 * count
    else:
        assert re.findall(r"MADE\(many_callees\)\(.*, (\d+)\);", made.body) == [str(-(-count // LANES))] * 2
    given = np.random.default_rng(count).normal(size=(count, 2))
    assert_allclose(
        computed_in_c(made, given.ravel(order="F"), 2 * count, tmp_path),
        function(given).full()[:, 0],
        rtol=1e-15,
        atol=1e-15,
    )


ONE_OF_THREE = """
#include <stdio.h>
#define casadi_real double
#define casadi_int int
#include "wire_kernels.h"
int main(void) {
  double q[20] = {0.3, -0.2, 0.1, 0.2}, position[3] = {0}, quaternion[4] = {1}, inputs[40] = {0.1, 0.2, 0.3};
  double all[20], alone[20] = {0}, force[3], moment[3] = {0}, room[wire_k_igm_SZ_W + 1];
  const double *given[wire_k_igm_SZ_ARG + 1] = {q, position, quaternion, inputs};
  double *every[wire_k_igm_SZ_RES + 1] = {all, force, moment}, *one[wire_k_igm_SZ_RES + 1] = {alone};
  int different = 0;
  wire_k_igm(given, every, 0, room, 0);
  wire_k_igm(given, one, 0, room, 0);
  for (int i = 0; i < SIZE; i++) different += all[i] != alone[i] || all[i] == 0;
  printf("%d %d", wire_k_igm_SZ_RES, different);
  return 0;
}
"""


@pytest.mark.slow
def test_results_that_nobody_asks_for(tmp_path: Path) -> None:
    """Of three results only the first is given a place."""
    program = tmp_path / "one.c"
    program.write_text(ONE_OF_THREE)
    model = model_of("kirchhoff", "follower at the tip")
    names = scene_names("wire", model.scene)
    # Sanitizers take the compiler long: it gets the one kernel that is called.
    (igm,) = [kernel for kernel in kernels.kernels(model, names, None) if kernel.name() == names.kernel("igm")]
    for file, text in kernel_files.kernel_sources([igm], names).items():
        (tmp_path / file).write_text(text)
    flags = ["-std=c99", "-O0", "-g", "-fsanitize=address,undefined", f"-DSIZE={model.size}"]
    gcc(*flags, program, tmp_path / "wire_kernels.c", "-lm", "-o", tmp_path / "one")
    assert run(tmp_path / "one").split() == ["3", "0"]


@pytest.mark.slow
def test_a_jacobian_of_too_many_statements_is_loops_with_the_same_solution(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = model_of("kirchhoff", "follower at the tip")
    solutions = []
    instructions = []
    for name, most in (("columns", kernels.MOST_IN_COLUMNS), ("loops", 100)):
        monkeypatch.setattr(kernels, "MOST_IN_COLUMNS", most)
        monkeypatch.setattr(kernels, "STRAIGHT", 100)
        folder = export(model, tmp_path / name, "rod")
        (jacobian,) = [
            entry
            for entry in json.loads((folder / "manifest.json").read_text())["functions"]
            if entry["name"] == "rod_k_jacobian"
        ]
        instructions.append(jacobian["instructions"])
        solutions.append(load(folder).solve().x)
    assert instructions[1] < instructions[0]
    assert_allclose(solutions[1], solutions[0], rtol=0, atol=1e-12)
