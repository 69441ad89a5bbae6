"""Libraries in other people's builds: several in one program, float, CMake, OpenMP."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import ExportError, export
from tests.codegen.libraries import C99, HARNESS, QUICK, RECIPES, Exported, Recipe, run
from tests.families import mostly_slow
from tests.scenes import push, rod, scene

Library = Callable[[str], Exported]
ExportRecipe = Callable[[str, Recipe], Exported]

CMAKE = pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed")

BOTH = """
#include "planar.h"
#include "pair.h"
#include <stdio.h>

static planar_workspace planar_work;
static pair_workspace pair_work;

int main(void) {
  const double push[PLANAR_INPUTS] = {0.9, 0.0, -0.4};
  const double pull[PAIR_INPUTS] = {0.0, -0.8, 0.3, 0.2, 0.0, 0.0, 0.3, -0.2, -2.0};
  double q[PLANAR_UNKNOWNS] = {0}, p[PAIR_UNKNOWNS] = {0}, tip[3], turn[4];
  if (planar_solve(push, q, &planar_work, 0) != PLANAR_CONVERGED) return 1;
  if (pair_solve(pull, p, &pair_work, 0) != PAIR_CONVERGED) return 1;
  planar_tip(q, push, tip, turn);
  printf("%.17g %.17g %.17g\\n", tip[0], tip[1], tip[2]);
  pair_tip_left(p, pull, tip, turn);
  printf("%.17g %.17g %.17g\\n", tip[0], tip[1], tip[2]);
  pair_tip_right(p, pull, tip, turn);
  printf("%.17g %.17g %.17g\\n", tip[0], tip[1], tip[2]);
  return 0;
}
"""


def wanted_tips(made: Exported) -> np.ndarray:
    inputs = made.model.pack()
    return made.tips(made.solve(inputs).x, inputs)


@pytest.mark.slow
def test_two_libraries_in_one_program(library: Library) -> None:
    one, other = library("planar"), library("pair")
    source = one.scratch / "both.c"
    source.write_text(BOTH)
    printed = run(one.link([source], *QUICK, others=[other]))
    tips = np.array([line.split() for line in printed.splitlines()], dtype=float)
    assert_allclose(tips, np.vstack([wanted_tips(one), wanted_tips(other)]), rtol=0, atol=1e-9 * one.length)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["planar", "spatial", "pinned", "thick", "fixed", "loops"])
def test_float_vs_double(library: Library, name: str) -> None:
    """Rounding of 1e-7 leaves four digits and a converged status; loads are scaled about the scene's own."""
    made = library(name)
    flags = (*QUICK, f"-D{made.names.macro}_SINGLE")
    demo = made.link([made.folder / f"{name}_demo.c"], *flags)
    assert not made.warnings(*flags)
    for scale in (1.0, -0.5, 2.0):
        inputs = scale * made.model.pack()
        printed = json.loads(run(demo, "--repeat", "1", *map(repr, inputs.tolist())))
        wanted = made.tips(made.solve(inputs).x, inputs)[0]
        assert printed["status"] == "converged"
        assert_allclose(printed["tip"], wanted, rtol=0, atol=1e-4 * made.length)


def test_float_program_of_random_loads_vs_double(library: Library) -> None:
    made = library("planar")
    cases = made.loads(200, 21, 2.0)
    statuses, _, q = batch(made.program("batch.c", *QUICK, "-DPLANAR_SINGLE"), cases)
    assert np.count_nonzero(statuses == 0) >= 190
    for inputs, unknowns in zip(cases[statuses == 0], q[statuses == 0], strict=True):
        wanted = made.tips(made.compiled.solve(inputs).x, inputs)
        assert_allclose(made.tips(unknowns, inputs), wanted, rtol=0, atol=1e-4 * made.length)


def test_estimates_in_float_count_rounding(export_recipe: ExportRecipe) -> None:
    """Of modes that leave less than float does: no answer is farther from that in double than it says."""
    made = export_recipe("fine", Recipe(scene(push(force=[0.9, 0.0, -0.4]), strain="planar"), 7, 8))
    cases = made.loads(200, 26, 4.0)
    statuses, errors, q = batch(made.program("batch.c", *QUICK, "-DFINE_SINGLE"), cases)
    converged = statuses == 0
    assert np.count_nonzero(converged) >= 190
    least = 3e-5 * (1.0 + np.linalg.norm(q[converged], axis=1))
    assert np.all(errors[converged] >= 0.999 * least)
    assert np.median(errors[converged]) < 1e-4
    for inputs, error, unknowns in zip(cases[converged], errors[converged], q[converged], strict=True):
        off = made.tips(unknowns, inputs) - made.tips(made.compiled.solve(inputs).x, inputs)
        assert np.linalg.norm(off) <= error * made.length, inputs


def batch(program: Path, cases: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Statuses, estimated errors and unknowns from a program of ``batch.c``."""
    text = f"{len(cases)}\n" + "\n".join(" ".join(map(repr, row)) for row in cases.tolist())
    done = subprocess.run([str(program)], input=text, capture_output=True, text=True, check=True, timeout=100)
    rows = np.array([line.split() for line in done.stdout.splitlines()], dtype=float)
    assert int(done.stderr) == np.count_nonzero(rows[:, 0] == 0)
    return rows[:, 0].astype(int), rows[:, 1], rows[:, 2:]


def test_openmp_batch_vs_single_solves(library: Library) -> None:
    """More cases than one thread takes at a time, with failures among them."""
    made = library("planar")
    cases = made.loads(300, 22, 2.0)
    cases[[5, 64, 130]] = 1e200
    statuses, _, q = batch(made.program("batch.c", *QUICK, "-fopenmp"), cases)
    serial, _, expected = batch(made.program("batch.c", *QUICK), cases)
    assert_allclose(statuses, serial, rtol=0, atol=0)
    assert list(np.flatnonzero(statuses)) == [5, 64, 130]
    assert_allclose(q, expected, rtol=0, atol=1e-9)
    for inputs, unknowns in zip(cases[:20], q, strict=False):
        if inputs[0] < 1e199:
            assert_allclose(unknowns, made.compiled.solve(inputs).x, rtol=0, atol=1e-9)


CONSUMER = """
cmake_minimum_required(VERSION 3.13)
project(consumer LANGUAGES C)
find_package({name} REQUIRED)
add_executable(consumer consumer.c)
target_link_libraries(consumer {name}::{name})
"""


ALL_OPTIONS = "-DTINY_OPENMP=ON -DBUILD_SHARED_LIBS=ON -DTINY_SINGLE=ON"

CMAKE_OPTIONS = ["", ALL_OPTIONS, *ALL_OPTIONS.split()]
"""None, all, and each alone."""


@CMAKE
@pytest.mark.parametrize("options", mostly_slow(CMAKE_OPTIONS, quick=[ALL_OPTIONS]))
def test_cmake_build_install_and_find_package(library: Library, options: str, tmp_path: Path) -> None:
    """A consumer needs no more than the prefix: options that change the interface come with the target."""
    made = library("tiny")
    build, prefix, source = tmp_path / "build", tmp_path / "prefix", tmp_path / "consumer"
    # Optimising takes the compiler longer than all else here.
    run("cmake", "-S", made.folder, "-B", build, "-DCMAKE_BUILD_TYPE=Debug", *options.split())
    run("cmake", "--build", build)
    run("cmake", "--install", build, "--prefix", prefix)
    assert json.loads(run(build / "tiny_demo", "--repeat", "2"))["status"] == "converged"
    source.mkdir()
    (source / "CMakeLists.txt").write_text(CONSUMER.format(name="tiny"))
    (source / "consumer.c").write_text(
        (HARNESS / "batch.c").read_text().replace("@{name}", "tiny").replace("@{MACRO}", "TINY")
    )
    run("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", source / "build")
    cases = made.loads(150, 23)
    statuses, _, q = batch(source / "build" / "consumer", cases)
    assert not np.any(statuses)
    single = "-DTINY_SINGLE=ON" in options
    expected = np.array([made.compiled.solve(inputs).x for inputs in cases])
    assert_allclose(q, expected, rtol=0, atol=1e-3 if single else 1e-9)


@pytest.mark.parametrize("rods", [("B", "jacobian_B"), ("arm", "arm_work"), ("arm", "Arm"), ("solve", "tip")])
def test_rods_with_names_that_look_like_functions(
    export_recipe: ExportRecipe, rods: tuple[str, str], tmp_path: Path
) -> None:
    """Either the sources compile, or the export says why not: never sources that do not compile."""
    model = Recipe(scene(rods=[rod("planar", name=name) for name in rods]), 2, 4).model()
    try:
        folder = export(model, tmp_path / "named")
    except ExportError as error:
        assert rods[1] in str(error)
        assert not (tmp_path / "named").exists()
        return
    assert rods[0] in ("arm", "solve")
    for stem in ("named", "named_kernels", "named_demo"):
        run("gcc", "-std=c99", "-fsyntax-only", folder / f"{stem}.c")


@pytest.mark.parametrize(
    "title",
    mostly_slow(
        ["what??/", "*/ int x; /*", "ends with a \\", "two\nlines", "\u202eturned", "/*/*/", "π ≈ 3"],
        quick=["*/ int x; /*", "ends with a \\"],
    ),
)
def test_titles_stay_comments(tmp_path: Path, title: str) -> None:
    model = Recipe(scene(push(force=[0.9, 0.0, 0.0]), strain="planar", title=title), 1, 3).model()
    folder = export(model, tmp_path / "titled")
    run("gcc", *C99, "-Werror", "-fsyntax-only", folder / "titled.c")


@pytest.mark.parametrize("name", ["string", "math", "stdio", "time", "Math", "all", "install", "test", "m", "c", "int"])
def test_names_that_would_hide_a_header_or_a_target_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ExportError, match="--name"):
        export(RECIPES["tiny"].model(), tmp_path / "out", name)
    assert not (tmp_path / "out").exists()
