"""Functions that functions of scalars call: as scalars, without operands that are zero, where their operands lie."""

from __future__ import annotations

import re
from pathlib import Path

import casadi as ca
import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi.compiling.called import called_functions
from cosserat_casadi.compiling.listing import LANES, Listing, with_shorter_calls
from cosserat_casadi.compiling.printed_kernels import ColumnForm
from cosserat_casadi.compiling.program_in_c import program_in_c
from cosserat_casadi.compiling.scalars_in_c import columns_in_fours, scalars_in_c
from cosserat_casadi.compiling.steps import program_of
from cosserat_casadi.maths.calls import KEPT
from tests.compiling.test_program_in_c import assert_same, in_c
from tests.compiling.test_scalars_in_c import computed_in_c


def kept(name: str, count: int) -> ca.Function:
    """Products and quotients of all entries of two vectors."""
    x, y = ca.SX.sym("x", count), ca.SX.sym("y", count)
    return ca.Function(name, [x, y], [ca.dot(x, y) + x[0], x / (1.0 + y)], KEPT)


def test_a_function_of_matrices_is_called_as_one_of_scalars() -> None:
    a, b = ca.MX.sym("a", ca.Sparsity.lower(3)), ca.MX.sym("b", 3)
    product = ca.Function("product", [a, b], [a @ b, ca.sin(b)], KEPT)
    x = ca.SX.sym("x", 6)
    lower = ca.SX(ca.Sparsity.lower(3), x)
    both = ca.Function("both", [x], [*product(lower, x[:3]), *product(2 * lower, x[3:])])
    one, other = called_functions(both).values()
    assert one.is_a("SXFunction") and hash(one) == hash(other)
    assert_same(one, product, 0.0)


def test_calls_hand_over_no_operand_that_is_zero_in_all_of_them() -> None:
    """An operand that is zero in one call alone stays, and so does every operand of another function."""
    z = ca.SX.sym("z", 4)
    first, second = kept("first", 3), kept("second", 3)
    calls = [
        *first(ca.vertcat(z[0], 0, 0), ca.vertcat(z[1], 0, z[2])),
        *first(ca.vertcat(z[3], 0, z[1]), ca.vertcat(z[0], 0, 0)),
        *second(z[:3], z[1:]),
    ]
    function = ca.Function("calling", [z], calls)
    shorter = with_shorter_calls(function)
    assert [len(call.operands) for call in Listing(function).calls] == [6, 6, 6]
    assert sorted(len(call.operands) for call in Listing(shorter).calls) == [4, 4, 6]
    assert_same(shorter, function, 0.0)
    whole = ca.Function("whole", [z], list(second(z[:3], z[1:])))
    assert with_shorter_calls(whole) is whole


def test_calls_wait_for_other_calls_of_their_function() -> None:
    """Three calls wait for a product, and two whose results are read behind them wait with them."""
    x = ca.MX.sym("x", 3, 5)
    u = ca.SX.sym("u", 3)
    callee = ca.Function("callee", [u], [u * u[0] + 2.0], KEPT)
    early = [callee(x[:, k]) for k in range(2)]
    matrix = ca.DM(np.random.default_rng(4).uniform(0.5, 1.0, (3, 3)))
    late = [callee(ca.sin(matrix @ x[:, k])) for k in range(2, 5)]
    read = ca.cos(ca.sin(early[0] * late[0]) + early[1])
    function = ca.Function("waiting", [x], [read, *late])
    body = program_in_c(program_of(function), function).body
    assert len(re.findall(r"MADE\(waiting_callee", body)) == 1
    assert_same(in_c(function, "waiting_in_c")[1], function, 1e-15)
    at_once = ca.Function("at_once", [x], [callee(ca.sin(early[0])), *late])
    assert_same(in_c(at_once, "at_once_in_c")[1], at_once, 1e-15)


def test_columns_call_functions_of_numbers_that_lie_apart(tmp_path: Path) -> None:
    """Arguments are turns alone, turns beside a number without columns, numbers, constants, and what was computed."""
    x, columns, turn = ca.SX.sym("x", 3), ca.SX.sym("columns", 2 * LANES), ca.SX.sym("turn", 3)
    names = ("of_turns", "mixed", "of_calls", "computed")
    of_turns, mixed, of_calls, computed = (kept(name, 2) for name in names)
    one, first = of_turns(turn[1:], x[:2])
    other, second = mixed(ca.vertcat(turn[0], x[1]), ca.vertcat(2.0, 3.0))
    further, third = of_calls(first, ca.vertcat(one, x[1]))
    last, fourth = computed(turn[:2] * x[2], ca.vertcat(other * one, other + one))
    column = ca.vertcat(further + second[1] + last, third[1] + first[0] + fourth[0])
    form = ca.Function("by_columns", [x, columns, turn], [columns, column])
    turns = np.random.default_rng(5).uniform(0.5, 1.0, (3, LANES))
    signature = ca.Function("by_columns", [x], [ca.SX.sym("result", 2 * LANES) * 0 + x[0]])
    printed = columns_in_fours(ColumnForm(form, turns, 2), signature)
    given = np.array([0.3, 0.7, 0.4])
    found = computed_in_c(printed, given, 2 * LANES, tmp_path)
    expected = [form(given, np.zeros(2 * LANES), turns[:, j])[1].full().ravel() for j in range(LANES)]
    assert_allclose(found.reshape(2, LANES), np.transpose(expected), rtol=1e-15, atol=0)


def test_calls_of_one_function_read_numbers_that_lie_in_several_ways(tmp_path: Path) -> None:
    """Results of four calls lie four apart, results of one call beside each other."""
    x, u = ca.SX.sym("x", 4), ca.SX.sym("u", 2)
    of_four = ca.Function("of_four", [u], [ca.vertcat(u[0] * u[1], u[0] - u[1])], KEPT)
    of_one = ca.Function("of_one", [u], [ca.vertcat(u[0] / u[1], u[0] + 3 * u[1])], KEPT)
    first = [of_four(ca.vertcat(x[k], x[0] + 1.0)) for k in range(4)]
    second = of_one(first[2])
    function = ca.Function("several", [x], [ca.vertcat(*first, second, of_one(second))])
    found = computed_in_c(scalars_in_c(function, function), np.array([0.3, 0.7, 0.4, 0.9]), 12, tmp_path)
    assert_allclose(found, function([0.3, 0.7, 0.4, 0.9]).full()[:, 0], rtol=1e-15, atol=0)
