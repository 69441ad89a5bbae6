"""Programs of matrices in C: products, moved entries, maps, chains and inverse dynamics as by the virtual machine."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.compiling.matrix_program import matrix_program
from cosserat_casadi.compiling.scalar_program import SUMS_OF_PRODUCTS
from tests.codegen.test_load import needs_compiler
from tests.compiling.test_scalar_program import by_casadi, lanes, run
from tests.moving_scenes import model_of

pytestmark = needs_compiler

ROUNDING = 1e-13
"""Sums of products are formed in another order."""

SPARSE = ca.sparsify(ca.DM([[1.5, 0, 0, -2], [0, 0, 0, 0], [0, 3, 0.25, 0]]))
"""A constant matrix with an empty row."""

POINTS = 5
"""Number of points of a map, and of links of a chain."""


def assert_same(function: ca.Function, *, least: float = 0.05, most: float = 0.95) -> None:
    given = lanes(function.nnz_in(), least=least, most=most)
    expected = by_casadi(function, given)
    assert_allclose(run(function, given, matrix_program), expected, rtol=0, atol=ROUNDING * np.abs(expected).max())


def test_products() -> None:
    """Of constants and of computed matrices, sparse and dense, with a sum, and with an entry that is a scalar."""
    x, y = ca.MX.sym("x", 4, 3), ca.MX.sym("y", 4)
    slim = ca.MX.sym("slim", ca.Sparsity.diag(4))
    # A sum before a product is part of its instruction.
    added = ca.mac(SPARSE, x, ca.MX(ca.DM(np.arange(9.0).reshape(3, 3))))
    results = [SPARSE @ y, x.T @ slim @ x, slim @ x, added, ca.mac(x.T, y, SPARSE @ y), y[1] * (SPARSE @ x), x @ SPARSE]
    function = ca.Function("products", [x, y, slim], results)
    program = matrix_program(function)
    assert program is not None
    assert np.count_nonzero(program.lines[:, 0] == SUMS_OF_PRODUCTS) >= len(results)
    assert_same(function)


def test_entries_that_move() -> None:
    x, y = ca.MX.sym("x", 3, 3), ca.MX.sym("y", 3)
    left, right = ca.horzsplit(ca.sin(x), [0, 1, 3])
    placed = ca.MX(x)
    placed[[0, 2], 1] = y[:2]
    joined = ca.vertcat(right.T, ca.horzcat(y, y**2)[[2, 0], :].T @ ca.DM.eye(2)[:, [0, 1, 1]], ca.DM.zeros(1, 3))
    diagonal = ca.project(x, ca.Sparsity.diag(3)) + ca.diag(y)
    results = [
        left - y,
        joined,
        ca.repmat(y, 1, 2) + 1.0,
        placed * 2,
        diagonal,
        3.0 - x.T,
        ca.dot(x, x) * y,
        ca.reshape(x, 9, 1),
    ]
    assert_same(ca.Function("moved", [x, y], results))


def test_instructions_that_are_expanded_one_after_the_other() -> None:
    """Functions made for single instructions are not taken for each other."""
    x = ca.MX.sym("x", 8)
    whole = ca.sin(x)
    for last in (4, 3, 2, 6, 5):
        added = ca.MX(whole)
        added.set_nz(whole[:last].nz[:] * x[last], False, list(range(last)))
        whole = added + ca.dot(whole[:last], x[:last]) + ca.mmax(whole[:last]) * ca.norm_1(whole)
    assert_same(ca.Function("expanded", [x], [whole]))


def test_maps_and_chains() -> None:
    """A map is a line for each instruction of its function, a chain of calls as many as there are links."""
    a, b = ca.SX.sym("a", 2), ca.SX.sym("b")
    one = ca.Function("one", [a, b], [a * ca.sin(b) + 0.5, a[0] / (1 + b)], {"never_inline": True})
    x, y = ca.MX.sym("x", 2, POINTS), ca.MX.sym("y", 1, POINTS)
    mapped, ratios = one.map(POINTS)(x, y)
    of_map = ca.Function("mapped", [x, y], [mapped.T, ratios * y])
    program = matrix_program(of_map)
    assert program is not None
    assert len(program.lines) < 2 * one.n_instructions()
    assert_same(of_map)
    link = ca.Function("link", [a, b], [ca.vertcat(a[1], a[0] * b)], {"never_inline": True})
    (chained,) = link.mapaccum(POINTS).call([x[:, 0], y])
    last, ratio = one(chained[:, -1], y[2])
    assert_same(ca.Function("chained", [x, y], [chained, last, ratio]))


def test_what_chooses_has_no_program() -> None:
    x = ca.MX.sym("x", 2)
    chosen = ca.if_else(x[0] < 0.5, ca.sin(x), ca.cos(x), True)
    assert matrix_program(ca.Function("chooses", [x], [chosen])) is None


@pytest.mark.parametrize("family", ["planar", "reissner", "driven and held"])
def test_inverse_dynamics(family: str) -> None:
    assert_same(model_of(family).inverse_dynamics, least=-0.3, most=0.3)
