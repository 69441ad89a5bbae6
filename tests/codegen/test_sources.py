"""The sources as text: they compile without a warning, hold no state, and say in the README what is true."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise, export
from cosserat_casadi.codegen.library import VERBATIM
from cosserat_casadi.compiling.texts import resource
from tests.codegen.libraries import C99, GENERATED, QUICK, RECIPES, Exported, gcc, run
from tests.families import mostly_slow
from tests.scenes import push, rod, scene

Library = Callable[[str], Exported]

KINDS = ["planar", "fixed", "robot", "loops", "tendons"]
"""Libraries with each kind of source: dense and by blocks, without inputs, with actuators and bodies."""

ALL = pytest.mark.parametrize("name", mostly_slow(RECIPES, quick=KINDS))


STRICT = (*C99, "-Werror")

FOREIGN = {"memcpy", "memset", "memmove", "__stack_chk_fail", "__cpu_model"}
"""What compilers themselves put in, besides what is used of libc; the last tells the vectors of a processor, on x86."""

MATHS = {"sqrt", "sin", "cos", "tan", "atan2", "acos", "asin", "exp", "log", "pow", "fabs", "fmin", "fmax", "hypot"}


@pytest.mark.parametrize("name", mostly_slow(RECIPES, quick=["robot"]))
def test_hand_readable_sources_compile_without_a_warning(library: Library, name: str, tmp_path: Path) -> None:
    made = library(name)
    for stem in (name, f"{name}_demo"):
        # Warnings about what may be uninitialised come from the optimiser.
        gcc(*STRICT, "-O2", "-c", made.folder / f"{stem}.c", "-o", tmp_path / "o")


LINT = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wsign-conversion", "-Wvla", "-Werror")
"""What any compiler may complain of; MSVC knows no arrays of variable length."""


@pytest.mark.parametrize("single", mostly_slow([False, True], quick=[False]), ids=["double", "float"])
@pytest.mark.parametrize("language", ["c99", pytest.param("c11", marks=pytest.mark.slow), "c++20"])
@pytest.mark.parametrize("name", mostly_slow(KINDS, quick=["robot"]))
def test_solver_passes_every_lint_in_both_languages(library: Library, name: str, language: str, single: bool) -> None:
    """As compilers read it: what they warn of while they optimise, the test before sees."""
    made = library(name)
    if language == "c++20" and shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    compiler = ("g++", "-x", "c++") if language == "c++20" else ("gcc",)
    chosen = [f"-D{made.names.macro}_SINGLE"] if single else []
    for stem in (name, f"{name}_demo"):
        run(*compiler, f"-std={language}", *LINT, *chosen, "-fsyntax-only", made.folder / f"{stem}.c")
    # CasADi's own sources: they compile, whatever a compiler says of them.
    run(*compiler, f"-std={language}", "-w", *chosen, "-fsyntax-only", made.folder / f"{name}_kernels.c")


BY_CASADI = ("loops",)
"""Recipes with kernels that CasADi's own generator writes."""

CORTEX = ("-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-d16", "-mfloat-abi=hard")


@pytest.mark.skipif(shutil.which("arm-none-eabi-gcc") is None, reason="no compiler for Cortex-M (gcc-arm-none-eabi)")
@pytest.mark.parametrize("single", [False, True], ids=["double", "float"])
@pytest.mark.parametrize("name", KINDS)
def test_program_for_a_microcontroller(library: Library, name: str, single: bool, tmp_path: Path) -> None:
    """The program of the README links for a Cortex-M: nothing beyond newlib is asked for."""
    made = library(name)
    chosen = [f"-D{made.names.macro}_SINGLE"] if single else []
    words = ("arm-none-eabi-gcc", *CORTEX, "-std=c99", "-Os", *chosen)
    (tmp_path / "main.c").write_text(readme_program(made))
    objects = []
    for stem, source in ((stem, made.folder / f"{stem}.c") for stem in (name, f"{name}_kernels")):
        lint = () if stem.endswith("_kernels") else LINT
        objects.append(tmp_path / f"{stem}.o")
        run(*words, *lint, "-c", source, "-o", objects[-1])
    include = ("-I", made.folder)
    run(*words, *include, tmp_path / "main.c", *objects, "--specs=nosys.specs", "-lm", "-o", tmp_path / "program")


@pytest.mark.parametrize("name", mostly_slow(RECIPES, quick=["robot"]))
def test_shared_library_shows_the_functions_of_the_header_alone(library: Library, name: str) -> None:
    made = library(name)
    lines = run("nm", "-D", "--defined-only", made.compiled.library).splitlines()
    exported = {line.split()[-1] for line in lines}
    declared = set(re.findall(rf"\b({name}_\w+)\(", (made.folder / f"{name}.h").read_text()))
    assert exported - {"_init", "_fini"} == declared
    kernels = (made.folder / f"{name}_kernels.h").read_text()
    if name in BY_CASADI:
        # Its generator writes more functions than are needed; they are hidden.
        return
    assert not re.search(r"_(checkout|incref|decref|n_in|name_out|sparsity_in|work)\(", kernels)


@ALL
def test_solver_is_the_same_file_in_every_folder(library: Library, name: str) -> None:
    held = {path.name: path.read_text() for path in library(name).folder.iterdir() if path.name in VERBATIM}
    assert {"solver.c", "solver.h"} < set(held)
    for file, text in held.items():
        assert text == resource("c", file), file


@pytest.mark.parametrize(
    "flags",
    [
        ("-DPLANAR_SINGLE", "-fopenmp"),
        *(pytest.param((flag,), marks=pytest.mark.slow) for flag in ("-DPLANAR_SINGLE", "-fopenmp", "-std=c11")),
    ],
    ids=lambda flags: " ".join(flags),
)
def test_variants_compile_without_a_warning(library: Library, flags: tuple[str, ...], tmp_path: Path) -> None:
    for stem in ("planar", "planar_demo"):
        gcc(*STRICT, "-O2", *flags, "-c", library("planar").folder / f"{stem}.c", "-o", tmp_path / "o")


@pytest.mark.parametrize("name", mostly_slow(RECIPES, quick=["planar", "fixed", "loops", "robot"]))
def test_generated_sources_compile_without_a_warning(library: Library, name: str) -> None:
    assert not library(name).warnings(*QUICK)


@pytest.mark.parametrize(
    "compiler",
    [("gcc", "-x", "c", *STRICT), ("g++", "-x", "c++", "-std=c++11", *STRICT[1:])],
    ids=["as C", "as C++"],
)
@ALL
def test_header_stands_alone(library: Library, name: str, compiler: tuple[str, ...], tmp_path: Path) -> None:
    if compiler[0] == "g++" and shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    run(*compiler, "-fsyntax-only", "-include", library(name).folder / f"{name}.h", "/dev/null", cwd=tmp_path)


@ALL
def test_library_holds_no_state_and_calls_only_mathematics(library: Library, name: str) -> None:
    """No symbol in writable sections; nothing from outside but libm, memcpy and memset; all names its own."""
    made = library(name)
    for path in made.objects(*QUICK):
        variables = [line.split() for line in run("objdump", "-t", path).splitlines() if " O " in line]
        # Tables of functions lie in .data.rel.ro until they are relocated, and are read only from then on.
        assert all(words[3].startswith((".rodata", ".data.rel.ro")) for words in variables), variables
        symbols = [line.split()[-2:] for line in run("nm", path).splitlines()]
        outside = {word for kind, word in symbols if kind == "U"} - {"_GLOBAL_OFFSET_TABLE_"}
        strangers = {word for word in outside if not word.startswith(f"{name}_")} - FOREIGN - MATHS
        assert not strangers
        public = {word for kind, word in symbols if kind in "TVWR"}
        assert all(word.startswith(f"{name}_") for word in public)


def readme_program(made: Exported) -> str:
    """The one program in C of a folder's README."""
    blocks = re.findall(r"```c\n(.*?)```", (made.folder / "README.md").read_text(), re.DOTALL)
    assert len(blocks) == 1
    return str(blocks[0])


@pytest.mark.parametrize("name", ["planar", "pair", "fixed"])
def test_program_of_the_readme_vs_python(library: Library, name: str) -> None:
    made = library(name)
    source = made.scratch / "readme.c"
    source.write_text(readme_program(made))
    gcc(*STRICT, "-O2", "-c", source, "-I", made.folder, "-o", made.scratch / "readme.o")
    printed = run(made.link([source], *QUICK))
    inputs = made.model.pack()
    wanted = made.tips(made.solve(inputs).x, inputs)[0]
    assert_allclose(np.array(printed.split(), dtype=float), wanted, rtol=0, atol=1e-9 * made.length)


@pytest.mark.slow
def test_shell_line_of_the_readme(library: Library, tmp_path: Path) -> None:
    """The first shell block builds and runs the demo, exactly as printed."""
    made = library("tiny")
    for path in made.folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    line = re.findall(r"```sh\n(.*?)```", (made.folder / "README.md").read_text(), re.DOTALL)[0]
    assert '"status": "converged"' in run("sh", "-c", line, cwd=tmp_path)


@pytest.mark.slow
def test_motion_of_a_base_that_turns_alone_compiles_without_a_warning(tmp_path: Path) -> None:
    """Its origin has no velocity, not even a zero: gcc 14 refuses what CasADi writes to repeat that along the rod."""
    turned = {"position": [0, 0, 0], "quaternion": [0.6, 0, 0.8, 0]}
    coil = {"kind": "magnet", "rod": "rod", "at": 1.0, "field": [0.1, 0, 0], "moment": [0, 0.2, 0.1]}
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "offset": [0.01, 0], "holes": [0.3, 0.4], "tension": 1.0}
    inputs = ["push.force", "push.moment", "coil.field", "coil.moment", "cable.tension", "rod.base.quaternion"]
    loads = [push(moment=[0, 0, 0]), {"name": "coil", **coil}]
    turning = scene(*loads, rods=[rod("planar", base=turned)], actuators=[cable], inputs=inputs)
    folder = export(build(turning, discretise(turning, 2, 4), moving=True), tmp_path / "turning", dynamics=True)
    gcc(*GENERATED, "-Werror", "-fsyntax-only", folder / "turning_kernels.c")
