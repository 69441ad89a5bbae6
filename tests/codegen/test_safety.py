"""Whatever it is given, the solver ends soon, with a true status, and touches no memory but its own."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from tests.codegen.libraries import Exported, run
from tests.families import mostly_slow

Library = Callable[[str], Exported]

SANITIZED = ("-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover", "-fno-omit-frame-pointer")


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
