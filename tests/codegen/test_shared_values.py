"""Kernels of what functions compute alike: the numbers of CasADi, from code that is there once."""

from __future__ import annotations

import os

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.compiler import compiled_texts, find_compiler
from cosserat_casadi.codegen.kernel_files import external_sources
from cosserat_casadi.codegen.scalars_in_c import scalars_in_c
from cosserat_casadi.codegen.shared_values import FEWEST_SHARED, with_shared_kernels

LONG = FEWEST_SHARED


def functions(inputs_size: int) -> list[ca.Function]:
    """Three functions of a chain of values, two of which share a second chain behind it, with calls in both."""
    x, inputs, load_factor = ca.SX.sym("x", 3), ca.SX.sym("inputs", inputs_size), ca.SX.sym("load_factor")
    pair = ca.SX.sym("pair", 2)
    turned = ca.Function("turned", [pair], [ca.cos(pair[0]) * pair[1], ca.sin(pair[1])], {"never_inline": True})
    all_have = [x[0] * x[1] + ca.sum1(inputs)]
    for k in range(LONG):
        all_have.append(ca.sin(all_have[-1]) + x[k % 3])
    two_have = [ca.sum1(ca.vertcat(*turned(ca.vertcat(all_have[-1], x[2]))))]
    for k in range(LONG):
        two_have.append(all_have[k] * ca.cos(two_have[-1]))
    given = [x, inputs]
    names = ["x", "inputs"]
    last = ca.vertcat(two_have[-1], 0.0, load_factor * all_have[7])
    return [
        ca.Function("first", given, [all_have[-1] * x[0], ca.vertcat(*all_have[3:5])], names, ["a", "b"]),
        ca.Function("second", given, [ca.vertcat(*two_have[-3:])], names, ["c"]),
        ca.Function("third", [*given, load_factor], [ca.densify(last)], [*names, "load_factor"], ["d"]),
    ]


@pytest.mark.parametrize("inputs_size", [2, 0])
def test_functions_that_call_what_they_share(inputs_size: int) -> None:
    plain = functions(inputs_size)
    printed = with_shared_kernels(plain, "shared")
    assert [[kernel.name() for kernel in function.kernels] for function in printed] == [
        ["shared_0"],
        ["shared_0", "shared_1"],
        ["shared_0", "shared_1"],
    ]
    kernels = {kernel.name(): kernel for function in printed for kernel in function.kernels}
    together = sum(function.n_instructions() for function in [*printed, *kernels.values()])
    alone = sum(scalars_in_c(function, function).n_instructions() for function in plain)
    assert together < alone - 2.5 * LONG
    texts = external_sources(printed, "shared", "long long int")
    library = os.fspath(compiled_texts("shared", texts, find_compiler()))
    rng = np.random.default_rng(3)
    arguments = [rng.normal(size=3), rng.normal(size=inputs_size), 0.7]
    for function in plain:
        given = arguments[: function.n_in()]
        made = ca.external(function.name(), library).call(given)
        for one, other in zip(made, function.call(given), strict=True):
            assert_allclose(np.array(one), np.array(other), rtol=1e-15, atol=1e-15)


def test_short_common_parts_stay_where_they_are() -> None:
    x, inputs = ca.SX.sym("x", 3), ca.SX.sym("inputs", 2)
    common = ca.sin(x[0] * inputs[1])
    short = [ca.Function(f"f{k}", [x, inputs], [common + k * x[1]], ["x", "inputs"], ["a"]) for k in range(2)]
    assert all(not function.kernels for function in with_shared_kernels(short, "shared"))
