"""Running sums in C: loops, the same to the last digit, and of nothing that is no running sum."""

from __future__ import annotations

import os

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.compiler import compiled_texts, find_compiler
from cosserat_casadi.codegen.kernels import sources
from cosserat_casadi.codegen.loops import in_loops
from cosserat_casadi.codegen.running_sums import FEWEST, NAME, SHORTEST, in_running_sums
from cosserat_casadi.codegen.steps import program_of

ROWS, COLUMNS = 9, 8


def assert_same(found: ca.Function, expected: ca.Function) -> None:
    rng = np.random.default_rng(4)
    given = [ca.DM(rng.uniform(-1, 1, expected.size_in(i))) for i in range(expected.n_in())]
    for one, other in zip(found.call(given), expected.call(given), strict=True):
        assert_allclose(one.full(), other.full(), rtol=0, atol=0)


def in_c(function: ca.Function) -> tuple[str, ca.Function]:
    stem = function.name()
    texts = sources([in_loops(function)], stem, "long long int")
    return texts[f"{stem}.c"], ca.external(stem, os.fspath(compiled_texts(stem, texts, find_compiler())))


def sums_in(function: ca.Function) -> int:
    program = program_of(function)
    return sum(step.function.name() == NAME for step in in_running_sums(program.steps, program.origins))


def test_running_sums_are_loops() -> None:
    """From either end, of computed numbers and of those given, one of the other."""
    x = ca.MX.sym("x", ROWS, COLUMNS)
    forwards = ca.cumsum(ca.sin(x), 0)
    backwards = ca.cumsum(x[::-1, :], 0)[::-1, :]
    twice = ca.cumsum(forwards, 0)
    function = ca.Function("summed", [x], [forwards, backwards, twice, forwards[-1, :] * x[0, :]])
    assert sums_in(function) == 3
    assert_same(in_loops(function), function)
    text, compiled = in_c(function)
    # All of them have one size.
    assert text.count(f"/* {NAME} of {ROWS} columns of {COLUMNS} entries. */") == 1
    assert_same(compiled, function)


@pytest.mark.parametrize(
    ("rows", "columns", "count"), [(FEWEST + 1, SHORTEST, 1), (FEWEST, SHORTEST, 0), (9, SHORTEST - 1, 0)]
)
def test_short_ones_are_written_out(rows: int, columns: int, count: int) -> None:
    x = ca.MX.sym("x", rows, columns)
    function = ca.Function("short", [x], [ca.cumsum(ca.sin(x), 0)])
    assert sums_in(function) == count
    assert_same(in_loops(function), function)


def test_what_is_added_may_not_follow_from_the_sum() -> None:
    """A recurrence is none: xₖ₊₁ = xₖ + sin xₖ."""
    x = ca.MX.sym("x", COLUMNS)
    state = x
    for _ in range(2 * FEWEST):
        state = state + ca.sin(state)
    function = ca.Function("recurrence", [x], [state])
    assert sums_in(function) == 0
    assert_same(in_loops(function), function)


def test_sums_that_begin_at_constants() -> None:
    """They are written out: constants of a running sum would be taken for computed elsewhere."""
    x = ca.MX.sym("x", ROWS, COLUMNS)
    start = ca.MX(ca.DM(np.arange(1.0, COLUMNS + 1)).T)
    function = ca.Function(
        "begun", [x], [ca.cumsum(ca.vertcat(start, ca.sin(x)), 0), start + x[0, :], ca.MX.zeros(2, 2)]
    )
    assert_same(in_loops(function), function)
    assert sums_in(function) == 0
    _, compiled = in_c(function)
    assert_same(compiled, function)


def test_one_sum_that_two_go_on_from() -> None:
    x = ca.MX.sym("x", 2 * ROWS, COLUMNS)
    rows = ca.vertsplit(ca.sin(x))
    common = rows[0]
    for row in rows[1:FEWEST]:
        common = common + row
    ends = []
    for further in (rows[FEWEST:ROWS], rows[ROWS:]):
        total = common
        for row in further:
            total = total + row
        ends.append(total)
    function = ca.Function("branches", [x], [*ends, common])
    assert_same(in_loops(function), function)
    _, compiled = in_c(function)
    assert_same(compiled, function)
