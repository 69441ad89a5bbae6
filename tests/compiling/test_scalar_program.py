"""Programs of scalars in C: operations, calls, and inverse dynamics have the digits of the virtual machine."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi.compiling.listing import BINARY, CHOICES, FUNCTIONS, LANES, REWRITTEN
from cosserat_casadi.compiling.scalar_program import (
    MINUS_PRODUCT,
    OF_TWO,
    PLUS_PRODUCT,
    PRODUCT_MINUS,
    ScalarProgram,
    scalar_program,
)
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.steps_library import steps_library
from tests.codegen.test_load import needs_compiler
from tests.moving_scenes import model_of

pytestmark = needs_compiler

Writer = Callable[[ca.Function], ScalarProgram | None]
"""Writer of a program."""

ROUNDING = 1e-15
"""Functions of the mathematical library may be those of another one."""


def run(function: ca.Function, arguments: FloatArray, write: Writer = scalar_program) -> FloatArray:
    """Results of a function by its program, for the entries of all arguments in each lane, shape (LANES, entries)."""
    program = write(function)
    assert program is not None
    slots = np.repeat(program.slots, LANES).reshape(-1, LANES)
    slots[: program.arguments] = arguments.T
    code = program.in_c
    # Lines on the same slots give the same again: what they leave behind is written over.
    for _ in range(2):
        steps_library().program_run(_address(code), len(program.lines), _address(slots))
    return slots[program.arguments : program.arguments + function.nnz_out()].T.copy()


def by_casadi(function: ca.Function, arguments: FloatArray) -> FloatArray:
    """The same by CasADi's virtual machine."""
    ends = np.cumsum([0, *(function.nnz_in(i) for i in range(function.n_in()))])
    rows = []
    for entries in arguments:
        given = [ca.DM(function.sparsity_in(i), entries[ends[i] : ends[i + 1]]) for i in range(function.n_in())]
        rows.append(np.concatenate([np.array(result.nonzeros()) for result in function.call(given)]))
    return np.array(rows)


def _address(array: np.ndarray[Any, Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def lanes(entries: int, *, least: float = 0.05, most: float = 0.95) -> FloatArray:
    """Arguments in the domain of every function, others in each lane."""
    return np.random.default_rng(5).uniform(least, most, (LANES, entries))


def every_operation() -> ca.Function:
    """All operations that are known, on two numbers."""
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    others = {"pow": a**b, "acosh": ca.acosh(1 + a)}
    results = []
    for name in dict.fromkeys(FUNCTIONS.values()):
        arguments = (a, b) if name in OF_TWO else (a,)
        results.append(others[name] if name in others else getattr(ca, name)(*arguments))
    results += [a + b, a - b, a * b, a / b, -a, 2 * a, 1 / a, a * a, a**3.5, a + 0.25]
    truths = [a < b, a <= b, ca.eq(a, b), ca.ne(a, b), ca.logic_not(a < b)]
    results += [*truths, ca.logic_and(a < b, a < 0.5), ca.logic_or(a < b, a < 0.5), ca.if_else(a < b, a, b)]
    results += [ca.sign(a - b)]
    return ca.Function("every", [a, b], [ca.vertcat(*results)])


def test_every_operation() -> None:
    function = every_operation()
    written = {function.instruction_id(k) for k in range(function.n_instructions())}
    missing = {*BINARY, *FUNCTIONS, *CHOICES, *REWRITTEN} - written
    unwritten = {ca.OP_CONSTPOW, ca.OP_POW}
    # CasADi before 3.8 writes 2 a as a product.
    if ca.__version__.startswith("3.7."):
        unwritten.add(ca.OP_TWICE)
    assert missing <= unwritten, missing
    given = lanes(2)
    given[3, 1] = given[3, 0]
    assert_allclose(run(function, given), by_casadi(function, given), rtol=ROUNDING, atol=0)


def test_arguments_are_not_taken_for_what_later_lines_write() -> None:
    """No line writes an argument: what stands before it in the order of slots is the last line of the last slot."""
    a, b, c = ca.SX.sym("a"), ca.SX.sym("b"), ca.SX.sym("c")
    function = ca.Function("apart", [a, b, c], [c - a, c - b])
    given = lanes(3)
    assert_array_equal(run(function, given), by_casadi(function, given))


def test_sums_of_products_are_one_line_where_nothing_else_reads_the_product() -> None:
    a, b, c = ca.SX.sym("a"), ca.SX.sym("b"), ca.SX.sym("c")
    product = a * c
    results = [a * b + c, c - a * b, a * b - c, a**2 - b, 2 * a - 3 * b + 4 * c, product + b, ca.sin(product), b * c]
    function = ca.Function("sums", [a, b, c], [ca.vertcat(*results), b * c + b * c])
    program = scalar_program(function)
    assert program is not None
    joined = np.isin(program.lines[:, 0], (PLUS_PRODUCT, MINUS_PRODUCT, PRODUCT_MINUS))
    assert 5 <= np.count_nonzero(joined) < len(program.lines)
    assert len(set(program.lines[joined, 0].tolist())) == 3
    given = lanes(3)
    assert_array_equal(run(function, given), by_casadi(function, given))


def test_calls_keep_their_arguments_and_leave_out_what_nobody_wants() -> None:
    """One function twice, its results read across, one of them not at all."""
    x = ca.SX.sym("x", 2)
    inner = ca.Function("inner", [x], [ca.vertcat(x[1], x[0] + 3), ca.sin(x[0])], {"never_inline": True})
    y = ca.SX.sym("y", 3)
    first, turned = inner(y[:2])
    second, _ = inner(ca.vertcat(first[1], first[0]))
    outer = ca.Function("outer", [y], [ca.vertcat(second, turned * y[2]), first])
    assert any(outer.instruction_id(k) == ca.OP_CALL for k in range(outer.n_instructions()))
    given = lanes(3)
    assert_array_equal(run(outer, given), by_casadi(outer, given))


def test_what_is_not_known_has_no_program() -> None:
    x = ca.MX.sym("x", 2)
    assert scalar_program(ca.Function("matrices", [x], [2 * x])) is None
    a = ca.SX.sym("a")
    assert scalar_program(ca.Function("printed", [a], [a.printme(a)])) is None


@pytest.mark.parametrize("family", ["planar", "driven and held"])
def test_inverse_dynamics(family: str) -> None:
    """The very digits, in each lane."""
    function = model_of(family).inverse_dynamics_in_scalars
    given = lanes(function.nnz_in(), least=-0.3, most=0.3)
    assert_allclose(run(function, given), by_casadi(function, given), rtol=ROUNDING, atol=0)
