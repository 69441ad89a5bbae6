"""Kernels of what functions compute alike: the numbers of CasADi, from code that is there once."""

from __future__ import annotations

import ctypes
import os
import re

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.shared_values import FEWEST_SHARED, with_shared_kernels
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.printed_files import external_sources
from cosserat_casadi.compiling.scalars_in_c import scalars_in_c
from cosserat_casadi.compiling.statements import LONGEST_OF_NUMBERS

LONG = FEWEST_SHARED


def functions(inputs_size: int) -> list[ca.Function]:
    """Four functions: all share a chain of values, three of them a second chain behind it, and two a third one.

    The second result of a call that the first chain begins with is read by the second chain alone.
    """
    x, inputs, load_factor = ca.SX.sym("x", 3), ca.SX.sym("inputs", inputs_size), ca.SX.sym("load_factor")
    pair = ca.SX.sym("pair", 2)
    turned = ca.Function("turned", [pair], [ca.cos(pair[0]) * pair[1], ca.sin(pair[1])], {"never_inline": True})
    begin, aside = turned(ca.vertcat(x[0] * x[1] + ca.sum1(inputs), x[1]))
    all_have = [begin]
    for k in range(LONG):
        all_have.append(ca.sin(all_have[-1]) + x[k % 3])
    three_have = [aside + ca.sum1(ca.vertcat(*turned(ca.vertcat(all_have[-1], x[2]))))]
    for k in range(LONG):
        three_have.append(all_have[k] * ca.cos(three_have[-1]))
    two_have = [three_have[-2]]
    for _ in range(LONG):
        two_have.append(all_have[2] - ca.cos(two_have[-1]))
    given = [x, inputs]
    names = ["x", "inputs"]
    last = ca.vertcat(two_have[-1], 0.0, load_factor * all_have[7])
    return [
        ca.Function("first", given, [all_have[-1] * x[0], ca.vertcat(*all_have[3:5])], names, ["a", "b"]),
        ca.Function("second", given, [ca.vertcat(*three_have[-3:])], names, ["c"]),
        ca.Function("third", given, [two_have[-1] + x[1]], names, ["d"]),
        ca.Function("fourth", [*given, load_factor], [ca.densify(last)], [*names, "load_factor"], ["e"]),
    ]


def functions_that_share_two_calls() -> list[ca.Function]:
    """Three functions of a chain of values with two calls at its beginning and end; two share a second chain."""
    x, inputs, load_factor = ca.SX.sym("x", 3), ca.SX.sym("inputs", 2), ca.SX.sym("load_factor")
    pair = ca.SX.sym("pair", 2)
    turned = ca.Function("turned", [pair], [pair[0] * pair[1], pair[0] - 0.3 * pair[1]], {"never_inline": True})
    all_have = [x[0] * x[1] + ca.sum1(inputs)]
    for k in range(LONG):
        all_have.append(ca.sin(all_have[-1]) + x[k % 3])
    # Both calls are made at once, and what the later one needs is there before what the earlier one makes.
    early, late = (ca.vertcat(*turned(ca.vertcat(value, x[1]))) for value in (all_have[2], all_have[-2]))
    two_have = [ca.sum1(ca.vertcat(*turned(ca.vertcat(all_have[-1], x[2]))))]
    for k in range(LONG):
        two_have.append(all_have[k] * ca.cos(two_have[-1]))
    given = [x, inputs]
    names = ["x", "inputs"]
    last = ca.vertcat(two_have[-1], 0.0, load_factor * all_have[7] * ca.sum1(early - late))
    several = ca.vertcat(*all_have[3:5], late)
    return [
        ca.Function("first", given, [early * x[0] + all_have[-1], several], names, ["a", "b"]),
        ca.Function("second", given, [ca.vertcat(*two_have[-3:], early, late)], names, ["c"]),
        ca.Function("third", [*given, load_factor], [ca.densify(last)], [*names, "load_factor"], ["d"]),
    ]


@pytest.mark.parametrize("inputs_size", [2, 0])
def test_functions_that_call_what_they_share(inputs_size: int) -> None:
    plain = functions(inputs_size)
    printed = with_shared_kernels(plain, "shared")
    assert [[kernel.name() for kernel in function.kernels] for function in printed] == [
        ["shared_0"],
        ["shared_0", "shared_1"],
        ["shared_0", "shared_1", "shared_2"],
        ["shared_0", "shared_1", "shared_2"],
    ]
    kernels = {kernel.name(): kernel for function in printed for kernel in function.kernels}
    every = [*printed, *kernels.values()]
    together = sum(function.n_instructions() for function in every)
    alone = sum(scalars_in_c(function, function).n_instructions() for function in plain)
    # One of four copies of the first chain is left, of three of the second, and of two of the third.
    assert together < alone - 9 * LONG
    assert sum(len(re.findall(r"turned\)\(w", one.body)) for one in every) == 2
    # Kernels hand over what is read elsewhere alone.
    assert [kernels[f"shared_{k}"].signature.numel_out(0) for k in (1, 2)] == [3, 1]
    texts = external_sources(printed, "shared", "long long int")
    assert_same_numbers(plain, texts)


def test_kernels_read_further_arguments_that_all_their_functions_have() -> None:
    """Two functions share what depends on the load factor; a third one has another argument in its place."""
    x, inputs, load_factor, abscissa = (ca.SX.sym(word, size) for word, size in zip("xiab", (3, 2, 1, 1), strict=True))
    every = [x[2] + inputs[0]]
    for k in range(LONG):
        every.append(ca.sin(every[-1]) + x[k % 3])
    alike = [ca.sin(x[0] * load_factor + every[-1])]
    apart = [ca.sin(x[0] * abscissa + every[-1])]
    for k in range(LONG):
        alike.append(ca.cos(alike[-1]) + x[k % 3])
        apart.append(ca.cos(apart[-1]) + x[k % 3])
    names = ["x", "inputs"]
    plain = [
        ca.Function("one", [x, inputs, load_factor], [alike[-1] * x[1]], [*names, "load_factor"], ["a"]),
        ca.Function("two", [x, inputs, load_factor], [alike[-1] + alike[7]], [*names, "load_factor"], ["b"]),
        ca.Function("other", [x, inputs, abscissa], [apart[-1]], [*names, "X"], ["c"]),
    ]
    printed = with_shared_kernels(plain, "shared")
    assert [[kernel.name() for kernel in function.kernels] for function in printed] == [
        ["shared_0", "shared_1"],
        ["shared_0", "shared_1"],
        ["shared_0"],
    ]
    assert_same_numbers(plain, external_sources(printed, "shared", "long long int"))


@pytest.mark.parametrize("longest", [LONGEST_OF_NUMBERS, 40])
def test_kernels_in_one_piece_and_in_several_that_pass_values_on(longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosserat_casadi.compiling.scalars_in_c.LONGEST_OF_NUMBERS", longest)
    plain = functions_that_share_two_calls()
    texts = external_sources(with_shared_kernels(plain, "shared"), "shared", "long long int")
    assert ("shared_0_part_1" in texts["shared.c"]) is (longest < LONG)
    assert_same_numbers(plain, texts)


def assert_same_numbers(plain: list[ca.Function], texts: dict[str, str]) -> None:
    """Compiled functions give the numbers of CasADi's."""
    library = os.fspath(compiled_texts("shared", texts, find_compiler()))
    rng = np.random.default_rng(3)
    arguments = [rng.normal(size=3), rng.normal(size=plain[0].numel_in(1)), 0.7]
    for function in plain:
        given = arguments[: function.n_in()]
        results = ca.external(function.name(), library).call(given)
        for one, other in zip(results, function.call(given), strict=True):
            assert_allclose(np.array(one), np.array(other), rtol=1e-15, atol=1e-15)


def test_arguments_and_results_without_pointers() -> None:
    """Arguments without a pointer are zero in what kernels compute, too; results without one are not written."""
    plain = functions(2)
    printed = with_shared_kernels(plain, "pointers")
    texts = external_sources(printed, "pointers", "long long int")
    library = ctypes.CDLL(os.fspath(compiled_texts("pointers", texts, find_compiler())))
    arguments = [np.array([0.3, -0.2, 0.9]), np.array([0.1, 0.4]), np.array([0.7])]
    for function, kernel in zip(plain, printed, strict=True):
        given = arguments[: function.n_in()]
        for absent in range(function.n_in()):
            wanted = function.call([value * (k != absent) for k, value in enumerate(given)])
            made = [np.full(result.numel(), np.nan) for result in wanted]
            pointers = [None if k == absent else value.ctypes.data for k, value in enumerate(given)]
            results = [None if k == 1 else value.ctypes.data for k, value in enumerate(made)]
            work = np.full(kernel.reals, np.nan)
            addresses = [(ctypes.c_void_p * len(listed))(*listed) for listed in (pointers, results)]
            library[function.name()](*addresses, None, ctypes.c_void_p(work.ctypes.data), 0)
            assert_allclose(made[0], np.array(wanted[0])[:, 0], rtol=1e-15, atol=1e-15)
            assert all(np.isnan(value).all() for value in made[1:])


def test_short_common_parts_stay_where_they_are() -> None:
    x, inputs = ca.SX.sym("x", 3), ca.SX.sym("inputs", 2)
    common = ca.sin(x[0] * inputs[1])
    short = [ca.Function(f"f{k}", [x, inputs], [common + k * x[1]], ["x", "inputs"], ["a"]) for k in range(2)]
    assert all(not function.kernels for function in with_shared_kernels(short, "shared"))


def test_constants_that_are_there_several_times_stand_in_one_array() -> None:
    x = ca.SX.sym("x", 2)
    often, once = -0.123456789, 0.987654321
    kernels = [
        ca.Function("first", [x], [often * x[0] + once], ["x"], ["a"]),
        ca.Function("second", [x], [x[1] - often * x[0] * x[1] + 0.5], ["x"], ["b"]),
    ]
    texts = external_sources(kernels, "constants", "long long int")
    assert texts["constants.c"].count(repr(often)) == 1
    assert "double constants_numbers[1]" in texts["constants.c"]
    library = os.fspath(compiled_texts("constants", texts, find_compiler()))
    for kernel in kernels:
        given = [0.3, -0.7]
        found = ca.external(kernel.name(), library)(given)
        assert_allclose(float(found), float(kernel(given)), rtol=1e-15, atol=0)
