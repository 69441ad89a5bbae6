"""The demo program: one JSON object, true exit codes, complaints on standard error."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.codegen.libraries import Exported, attempt, run
from tests.families import mostly_slow

Library = Callable[[str], Exported]

KEYS = {
    "status",
    "iterations",
    "tip",
    "load_factor",
    "error_estimate",
    "residual_norm",
    "cold_us",
    "warm_us",
    "igm_us",
    "jacobian_us",
}


def strict_json(text: str) -> dict[str, Any]:
    """One JSON object, without the NaN and Infinity that Python would let pass."""

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    found: dict[str, Any] = json.loads(text, parse_constant=refuse)
    return found


@pytest.mark.parametrize(
    "name", mostly_slow(["planar", "pinned", "pair", "fixed", "thick"], quick=["planar", "pinned", "pair"])
)
def test_demo_vs_python_at_the_inputs_of_the_scene(library: Library, name: str) -> None:
    made = library(name)
    printed = strict_json(run(made.demo, "--repeat", "2"))
    assert set(printed) == KEYS
    assert printed["status"] == "converged"
    assert printed["load_factor"] == 1.0
    assert printed["iterations"] > 0
    assert all(printed[key] > 0 for key in KEYS if key.endswith("_us"))
    inputs = made.model.pack()
    wanted = made.tips(made.solve(inputs).x, inputs)[0]
    assert_allclose(printed["tip"], wanted, rtol=0, atol=1e-9 * made.length)


def test_demo_vs_python_at_inputs_of_the_command_line(library: Library) -> None:
    made = library("planar")
    inputs = np.array([-1.25, 3.0e-2, 0.7])
    words = ["-1.25", "3.0e-2", "0.7"]
    wanted = made.tips(made.solve(inputs).x, inputs)[0]
    for options in ([], ["--repeat", "3"]):
        printed = strict_json(run(made.demo, *options, *words))
        assert_allclose(printed["tip"], wanted, rtol=0, atol=1e-9 * made.length)


@pytest.mark.parametrize(
    "words",
    [
        ["1"],
        ["1", "2", "3", "4"],
        ["1", "2", "three"],
        ["1", "2", "3x"],
        ["1", "2", ""],
        ["--repeat"],
        ["--repeat", "0"],
        ["--repeat", "-3"],
        ["--repeat", "nan"],
        ["--repeat", "1e300"],
        ["--repeat", "many"],
        ["--repeat", "2", "1"],
        ["1", "2", "3", "--repeat", "2"],
        ["--help"],
    ],
    ids=" ".join,
)
def test_wrong_words_end_with_a_usage(library: Library, words: list[str]) -> None:
    done = attempt(library("planar").demo, *words)
    assert done.returncode == 2
    assert not done.stdout
    assert "usage: planar_demo [--repeat N] [3 input values: push.force]" in done.stderr


def test_demo_without_inputs_takes_none(library: Library) -> None:
    done = attempt(library("fixed").demo, "1")
    assert done.returncode == 2
    assert "[0 input values: none]" in done.stderr


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["1e12", "0", "0"], "load_stalled"),
        (["1e300", "0", "0"], "not_finite"),
        (["1e999", "0", "0"], "not_finite"),
        (["nan", "0", "0"], "not_finite"),
        (["0", "-inf", "0"], "not_finite"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else value,
)
def test_what_does_not_converge_says_so(library: Library, words: list[str], status: str) -> None:
    printed = strict_json(run(library("planar").demo, "--repeat", "2", *words, expect=3))
    assert printed["status"] == status
    assert printed["load_factor"] < 1.0


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
@pytest.mark.parametrize("name", mostly_slow(["planar", "pair", "fixed"], quick=["pair"]))
def test_demo_under_valgrind(library: Library, name: str) -> None:
    run("valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", library(name).demo, "--repeat", "2")
