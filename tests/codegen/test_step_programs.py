"""Programs that step: with numbers of any kind under sanitizers, in threads, for very long, in float, as the demo."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.motion_sources import MOTION_FILES
from tests.codegen.libraries import QUICK, Exported, run
from tests.codegen.motions import MotionLibrary
from tests.codegen.test_demo import strict_json
from tests.codegen.test_memory import stated
from tests.codegen.test_safety import SANITIZED
from tests.codegen.test_sources import LINT
from tests.families import mostly_slow


def fuzz(made: Exported, count: int) -> None:
    printed = json.loads(run(made.program("step_fuzz.c", *SANITIZED), str(count), timeout=3000))
    done, not_solved, not_finite, _, bad_step, _ = printed["counts"]
    assert min(done, not_solved, not_finite, bad_step, printed["cut"], printed["differentiated"]) > 0, printed


@pytest.mark.slow
def test_special_and_random_numbers_under_sanitizers(motion_library: MotionLibrary) -> None:
    fuzz(motion_library("planar"), 500)


@pytest.mark.slow
@pytest.mark.parametrize("family", ["kirchhoff", "fixed joint", "given length"])
def test_very_many_numbers_under_sanitizers(motion_library: MotionLibrary, family: str) -> None:
    fuzz(motion_library(family), 3000)


@pytest.mark.slow
@pytest.mark.parametrize("family", ["planar", "fixed joint"])
def test_threads_vs_one_thread(motion_library: MotionLibrary, family: str) -> None:
    assert int(run(motion_library(family).program("step_threads.c", *QUICK, "-pthread"))) > 50


def long_run(made: Exported, steps: int, *flags: str) -> None:
    """Every step ends with a status, energies stay within what the loads can feed."""
    found = json.loads(run(made.program("step_long.c", *flags), str(steps), "1e-3", timeout=3000))
    assert sum(found["counts"]) == steps
    assert found["counts"][0] == steps, found
    # Twice the loads of the scene, for good and without damping, store four times the energy that they would bring.
    inputs = made.model.pack()
    held = made.model.unloaded()
    solved = made.solve(2.0 * inputs)
    stored = float(made.model.energies(solved.x, 0 * held, 2.0 * inputs, 0 * inputs)[1])
    assert 0.0 < found["most_J"] <= 4.0 * stored


def test_many_steps_of_a_damped_rod(motion_library: MotionLibrary) -> None:
    long_run(motion_library("planar"), 20_000, *QUICK)


@pytest.mark.slow
@pytest.mark.parametrize("family", ["kirchhoff", "tendons"])
def test_a_million_steps_of_a_damped_robot(motion_library: MotionLibrary, family: str) -> None:
    """A rod under three loads, and one that a tendon and a chamber bend under its weight."""
    long_run(motion_library(family), 1_000_000, "-O2", "-fPIC")


@pytest.mark.parametrize("family", ["planar", pytest.param("fixed joint", marks=pytest.mark.slow)])
def test_demo_simulates_a_second(motion_library: MotionLibrary, family: str) -> None:
    """Its tip is where the same steps in Python's hands end."""
    made = motion_library(family)
    demo = made.link([made.folder / f"{made.name}_motion_demo.c"], *QUICK)
    printed = strict_json(run(demo, "--steps", "100"))
    assert printed["status"] == "done"
    assert printed["steps"] == 100
    assert printed["most_parts"] == 1
    assert printed["steps_per_second"] > 0
    own = made.model.pack()

    def at(t: float) -> np.ndarray:
        return np.asarray(own * (1 + 0.01 * (1 - np.cos(2 * np.pi * t))))

    state = made.compiled.rest(own, made.compiled.solve(own).x)
    assert state is not None
    memory = made.compiled.step_memory()
    for k in range(100):
        inputs, following = at(k / 100), at((k + 1) / 100)
        taken = made.compiled.step(state, 0.01, inputs, 100 * (following - inputs), memory=memory)
        assert taken.done
        state = taken.state
    tip = made.tips(state.x, own)[0]
    assert_allclose(printed["tip"], tip, rtol=0, atol=1e-9)
    kinetic, elastic, *_ = made.model.energies(state.x, state.v, own, 0 * own)
    assert_allclose(printed["elastic_J"], float(elastic), rtol=1e-8)
    assert_allclose(printed["kinetic_J"], float(kinetic), rtol=1e-5, atol=1e-12)
    run(demo, "--steps", "0", expect=2)
    run(demo, "--stops", expect=2)


@pytest.mark.slow
def test_float_vs_double(motion_library: MotionLibrary) -> None:
    made = motion_library("planar")
    flags = (*QUICK, f"-D{made.names.macro}_SINGLE")
    assert not made.warnings(*flags)
    source = made.folder / f"{made.name}_motion_demo.c"
    single, double = (strict_json(run(made.link([source], *which), "--steps", "100")) for which in (flags, QUICK))
    assert single["status"] == "done"
    assert_allclose(single["tip"], double["tip"], rtol=0, atol=1e-4 * made.length)


# The sources


@pytest.mark.parametrize("single", mostly_slow([False, True], quick=[False]), ids=["double", "float"])
@pytest.mark.parametrize("family", mostly_slow(["planar", "planar held", "fixed joint"], quick=["planar held"]))
@pytest.mark.parametrize("language", ["c99", pytest.param("c11", marks=pytest.mark.slow), "c++20"])
def test_sources_pass_every_lint_in_both_languages(
    motion_library: MotionLibrary, family: str, language: str, single: bool
) -> None:
    if language == "c++20" and shutil.which("g++") is None:
        pytest.skip("there is no C++ compiler")
    compiler = ("g++", "-x", "c++") if language == "c++20" else ("gcc",)
    made = motion_library(family)
    chosen = [f"-D{made.names.macro}_SINGLE"] if single else []
    sources = [made.folder / f"{made.name}{end}.c" for end in ("", "_motion_demo")]
    run(*compiler, f"-std={language}", *LINT, *chosen, "-fsyntax-only", *sources)


def test_the_step_is_the_same_file_in_every_folder(motion_library: MotionLibrary) -> None:
    for file in MOTION_FILES:
        texts = {(motion_library(family).folder / file).read_text() for family in ("planar", "planar held")}
        assert len(texts) == 1


def test_workspace_is_what_the_readme_says(motion_library: MotionLibrary) -> None:
    for family in ("planar", "planar held"):
        made = motion_library(family)
        _, said = stated(made)
        assert abs(made.handle[f"{made.name}_workspace_size"]() - said) <= 150
