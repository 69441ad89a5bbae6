"""Whatever it is given, the solver ends soon, with a true status, and touches no memory but its own."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.codegen.contact_libraries import exported_contact, over_bar
from tests.codegen.libraries import Exported, attempt, run
from tests.families import mostly_slow

Library = Callable[[str], Exported]

SANITIZED = ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover", "-fno-omit-frame-pointer")
"""Without lines of the source, which take the compiler two fifths of its time."""


def fuzz(made: Exported, count: int) -> None:
    """Feed special and random numbers to a library under the sanitizers."""
    printed = json.loads(run(made.program("fuzz.c", *SANITIZED), str(count), timeout=3000))
    print(printed)
    converged, _, not_finite, _, stalled, *_ = printed["counts"]
    assert converged > 0
    assert not_finite > 0
    assert stalled > 0
    assert printed["lost"] > 0
    assert printed["tracked"] > 0
    assert printed["longest"] < 1.0


def test_special_and_random_numbers_under_sanitizers(library: Library) -> None:
    fuzz(library("tiny"), 3000)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tiny", "arch"])
def test_very_many_random_numbers_under_sanitizers(library: Library, name: str) -> None:
    fuzz(library(name), 100_000)


@pytest.mark.parametrize("name", mostly_slow(["planar", "pair", "robot"], quick=["robot"]))
def test_threads_vs_one_thread(library: Library, name: str) -> None:
    assert int(run(library(name).program("threads.c", "-O0", "-fPIC", "-pthread"))) > 40


@pytest.mark.slow
def test_threads_under_the_thread_sanitizer(library: Library) -> None:
    assert int(run(library("tiny").program("threads.c", "-O1", "-g", "-pthread", "-fsanitize=thread"))) > 40


# What exported C says to compilers: nothing to -Wextra, and no to arithmetic without infinities.


STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-fsyntax-only")
"""Compilers say what they have to say as they read: no object is made."""


def compiled_sources(folder: Path, name: str) -> list[Path]:
    """Sources that a user compiles; the others are included by these."""
    return sorted(folder.glob(f"{name}*.c"))


@pytest.mark.parametrize("name", ["planar", pytest.param("robot", marks=pytest.mark.slow)])
def test_folder_without_a_warning(library: Callable[[str], Exported], name: str) -> None:
    made = library(name)
    for source in compiled_sources(made.folder, name):
        run("gcc", *STRICT, source)


def test_folder_with_motions_without_a_warning(motion_library: Callable[[str], Exported]) -> None:
    made = motion_library("planar")
    for source in compiled_sources(made.folder, made.name):
        run("gcc", *STRICT, source)


@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_arithmetic_without_infinities_is_refused(library: Callable[[str], Exported], flag: str) -> None:
    """The solver looks for what is not finite, and such a compiler would take that look away."""
    folder = library("planar").folder
    for file in ("planar.c", "planar_kernels.c"):
        done = attempt("gcc", "-std=c99", flag, "-fsyntax-only", folder / file)
        assert done.returncode != 0
        assert "compile without -ffast-math" in done.stderr


@pytest.mark.slow
def test_contact_without_infinities_is_refused(tmp_path: Path) -> None:
    made = exported_contact(over_bar(), tmp_path / "bar", np.array([[0.0, 0.0, -1.0]]), 2, 4)
    done = attempt("gcc", "-std=c99", "-ffast-math", "-fsyntax-only", made.folder / "bar.c")
    assert "compile without -ffast-math" in done.stderr
