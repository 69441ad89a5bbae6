"""How a function falls into parts: what is relied on of CasADi's instructions, and the example of the docstring."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.parts import CONSTANT, _Stream, parted


def function(expression: str) -> ca.Function:
    x, inputs, factor = ca.SX.sym("x", 5), ca.SX.sym("inputs", 2), ca.SX.sym("factor")
    names = {"x": x, "p": inputs, "factor": factor, "ca": ca}
    return ca.Function("f", [x, inputs, factor], [eval(expression, names)], ["x", "inputs", "factor"], ["entries"])


def test_lines_of_the_example() -> None:
    stream = _Stream(function("3*x[0] + x[4]"))
    assert (stream.x, stream.inputs, stream.constants) == ([0, 4], [], [3.0])
    assert stream.lines == [
        (ca.OP_INPUT, (0, 0), 1),
        (ca.OP_MUL, (CONSTANT, 0), 1),
        (ca.OP_INPUT, (0, 1), 1),
        (ca.OP_ADD, (1, 2), 1),
        (ca.OP_OUTPUT, (3, 0), 0),
    ]


def test_casadi_writes_products_with_minus_one_and_two_and_quotients_of_one_as_operations_of_their_own() -> None:
    """Legs whose constants happen to be −1, 2 or 1 beside those of others must still give the same lines."""
    lines = [_Stream(function(f"({c})*x[0]")).lines for c in ("-1", "2", "3.7")]
    assert lines[0] == lines[1] == lines[2]
    lines = [_Stream(function(f"({c})/x[0]")).lines for c in ("1", "3.7")]
    assert lines[0] == lines[1]


def test_parts_that_differ_in_constants_share_a_kernel_and_compute_the_whole() -> None:
    whole = function("ca.vertcat(3*ca.sin(x[0]) + p[0]*factor, 2*ca.sin(x[4]) + p[1]*factor, x[1]*x[2])")
    split = parted(whole, [0, 1, 2], "k")
    assert [part.kernel for part in split.parts] == [0, 0, 1]
    assert [part.x for part in split.parts] == [[0], [4], [1, 2]]
    assert [part.constants for part in split.parts] == [[3.0], [2.0], []]
    x, inputs, entries = np.arange(1.0, 6.0), np.array([0.3, 0.7]), np.full(3, np.nan)
    for part in split.parts:
        kernel = split.kernels[part.kernel]
        entries[part.entries] = kernel(x[part.x], inputs[part.inputs], 0.4, part.constants).full()[:, 0]
    assert_allclose(entries, whole(x, inputs, 0.4).full()[:, 0], rtol=1e-15, atol=0)
