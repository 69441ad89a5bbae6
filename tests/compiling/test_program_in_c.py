"""Functions of matrices in C: the numbers that CasADi computes, whatever the functions are made of."""

from __future__ import annotations

import os
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, discretise, scene_from_dict
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.numbered import function_of
from cosserat_casadi.compiling.printed_files import external_sources
from cosserat_casadi.compiling.products import Product, column_groups
from cosserat_casadi.compiling.program_in_c import ConstantTables, program_in_c
from cosserat_casadi.compiling.steps import UnknownInstructionError, program_of
from tests.families import mostly_slow

ROD = {
    "name": "rod",
    "length": 0.2,
    "strain": "reissner",
    "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.33, "density": 6450.0},
    "section": {"shape": "circle", "radius": [0.6e-3, 0.4e-3]},
}
LOADS = [
    {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.1, 0.0, 0.05], "frame": "body"},
    {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "force": [0.3, 0.0, 0.1], "moment": [0.0, 0.01, 0.0]},
    {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]},
]


@pytest.fixture(scope="module")
def model() -> Model:
    scene = scene_from_dict({"schema": 1, "rods": [ROD], "loads": LOADS})
    return build(scene, discretise(scene, 3, 5, "magnus6"))


FUNCTIONS: dict[str, Callable[[Model], ca.Function]] = {
    "residual": lambda model: model.path_residual,
    "jacobian": lambda model: model.path_jacobian,
    "rate": lambda model: model.path_rate,
    "igm": lambda model: model.igm["rod"],
    "tip_jacobian": lambda model: model.tip_jacobian["rod"],
    "shape": lambda model: model.shape["rod"],
    "second_derivative": lambda model: model.residual.reverse(1).forward(1),
    "motion": lambda model: model.dynamics_jacobian,
}


def arguments(function: ca.Function, seed: int = 3) -> list[ca.DM]:
    rng = np.random.default_rng(seed)
    patterns = [function.sparsity_in(i) for i in range(function.n_in())]
    return [ca.DM(pattern, rng.uniform(0.1, 0.9, pattern.nnz())) for pattern in patterns]


def assert_same(found: ca.Function, expected: ca.Function, rtol: float) -> None:
    given = arguments(expected)
    for one, other in zip(found.call(given), expected.call(given), strict=True):
        assert one.shape == other.shape
        scale = np.abs(other.full()).max(initial=0.0)
        assert_allclose(one.full(), other.full(), rtol=0, atol=rtol * scale)


def in_c(function: ca.Function, stem: str) -> tuple[dict[str, str], ca.Function]:
    """Sources of a function under a name, and what they compute."""
    symbols = function.mx_in()
    renamed = ca.Function(stem, symbols, function.call(symbols), function.name_in(), function.name_out())
    texts = external_sources([renamed], stem, "long long int")
    assert "CasADi 3" not in texts[f"{stem}.c"], "it has a form of its own"
    return texts, ca.external(stem, os.fspath(compiled_texts(stem, texts, find_compiler())))


@pytest.mark.parametrize("name", mostly_slow(FUNCTIONS, quick=["igm", "tip_jacobian"]))
def test_function_of_a_model_is_the_same_as_steps(model: Model, name: str) -> None:
    function = FUNCTIONS[name](model)
    if function.is_a("SXFunction"):
        return
    written = function_of(program_of(function))
    assert (written.name_in(), written.name_out()) == (function.name_in(), function.name_out())
    assert_same(written, function, 1e-14)


def test_equal_steps_are_taken_once() -> None:
    """CasADi keeps an operation, a product, a call and a constant as often as they are written."""
    x = ca.MX.sym("x", 3)
    scalar = ca.SX.sym("x", 3)
    root = ca.Function("root", [scalar], [ca.sqrt(ca.sumsqr(scalar))], {"never_inline": True})

    def written() -> ca.MX:
        matrix = ca.DM([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 10.0]])
        return ca.sin(matrix @ x) * root(matrix @ x)

    once = ca.Function("once", [x], [written()])
    twice = ca.Function("twice", [x], [written(), 2.0 * written()])
    assert len(program_of(twice).steps) == len(program_of(once).steps) + 1
    assert_same(function_of(program_of(twice)), twice, 0.0)


@pytest.mark.parametrize("dense_first", [True, False])
def test_products_in_two_patterns_are_two_steps(dense_first: bool) -> None:
    diagonal = ca.Sparsity.diag(6)
    x = ca.MX.sym("x", diagonal)
    y = ca.MX.sym("y", diagonal + ca.Sparsity.triplet(6, 6, [0, 1], [3, 4]))
    patterns = [ca.Sparsity.dense(6, 6), diagonal]
    products = [ca.mac(x, y, ca.MX(ca.DM(pattern, 0.0))) for pattern in patterns]
    function = ca.Function("products", [x, y], products if dense_first else products[::-1])
    assert_same(function_of(program_of(function)), function, 0.0)


def test_steps_whose_entries_come_out_zero() -> None:
    """CasADi leaves them out where a factor is a constant zero: their places stay."""
    a, x = ca.MX.sym("a"), ca.MX.sym("x", 9)
    weighted = ca.Function("weighted", [a, x], [ca.dot(x, a * x)])
    function = ca.Function("outer", [x], [x[0] + weighted(0, x)])
    assert_same(function_of(program_of(function)), function, 0.0)


@pytest.mark.parametrize("name", mostly_slow(FUNCTIONS, quick=["residual", "second_derivative"]))
def test_function_of_a_model_is_the_same_in_c(model: Model, name: str) -> None:
    function = FUNCTIONS[name](model)
    _, compiled = in_c(function, f"program_{name}")
    assert (compiled.name_in(), compiled.name_out()) == (function.name_in(), function.name_out())
    assert [compiled.sparsity_in(i) for i in range(function.n_in())] == [
        function.sparsity_in(i) for i in range(function.n_in())
    ]
    assert_same(compiled, function, 1e-13)


def test_every_kind_of_instruction() -> None:
    """Instructions that no model has today, and those that move entries, one beside another."""
    x = ca.MX.sym("x", 4, 3)
    s = ca.MX.sym("s", ca.Sparsity.lower(4))
    v = ca.MX.sym("v", 40)
    changed = ca.MX(x)
    changed[1:3, 2] = s[1:3, 0]
    added = ca.MX(x)
    added[ca.Slice(0, 4), 1] += x[:, 0]
    left, right = ca.horzsplit(ca.repmat(x, 1, 2), 3)
    low, _, high = ca.vertsplit(v, 15)
    first, second = ca.diagsplit(ca.diagcat(x, s), [0, 4, 8], [0, 3, 7])
    results = [
        changed,
        added,
        left + right,
        first * 2.0,
        ca.densify(second).T,
        s + s.T,
        s - ca.project(s, ca.Sparsity.diag(4)),
        x.T @ s @ x,
        # CasADi cannot put other operands in the place of results of a split.
        ca.dot(low[:10], high) * ca.dot(left, x),
        ca.dot(left, right),
        ca.mmin(low) - ca.mmax(high),
        ca.mac(s, x, x),
        x / ca.norm_2(ca.vec(x)),
        ca.sumsqr(x) - ca.mmax(s),
        ca.if_else(x[0, 0] > 0.5, x, -x),
        ca.cumsum(x, 1),
        # The adjoint of copies side by side sums them; its operand is a result of a split.
        ca.repsum(low[:12].reshape((2, 6)), 1, 3) * ca.repsum(ca.horzcat(left, right), 1, 2)[:2, :2],
        ca.atan2(x, 2.0),
        ca.sign(x - 0.5) + ca.floor(3.0 * x) - ca.ceil(x) + ca.copysign(x, x - 0.5) + ca.fmod(x, 0.3),
        ca.log1p(x) + ca.expm1(x) + ca.erf(x) + ca.hypot(x, 0.5) + ca.asinh(x) + ca.acosh(x + 1.0) + ca.atanh(0.5 * x),
        ca.logic_and(x > 0.3, x <= 0.7) + 2.0 * ca.logic_or(x == 0.5, ca.logic_not(x > 0.4)) + (x != 0.2),
        ca.reshape(v[::-1], 8, 5) @ x[:3, :].T.nz[[0, 4, 2, 1, 3]],
        ca.vertcat(v, 1.0, 0.0, v[3:7]),
        ca.MX(3, 3),
        ca.MX(2.0),
    ]
    function = ca.Function("kinds", [x, s, v], results)
    assert_same(function_of(program_of(function)), function, 1e-15)
    assert_same(in_c(function, "kinds_in_c")[1], function, 1e-15)


def test_one_number_taken_several_times() -> None:
    """It is a column beside other entries, as a factor on all of a wrench is."""
    matrix = ca.MX.sym("matrix", 30, 30)
    vector = ca.MX.sym("vector", 30)
    product = matrix @ vector
    stacked = ca.vertcat(ca.repmat(ca.dot(product, product), 6, 1), product)
    function = ca.Function("stacked", [matrix, vector], [stacked])
    assert_same(in_c(function, "stacked_in_c")[1], function, 1e-15)


def test_calls_are_made_four_at_a_time_wherever_they_come_from() -> None:
    """Of a map and one by one, of any number of columns, also of a function that calls another itself."""
    u = ca.SX.sym("u", 3)
    inner = ca.Function("inner", [u], [u[0] * u[1] - u[2], u * 2.0], {"never_inline": True})
    outer_value, outer_vector = inner.call([ca.vertcat(u[1], u[2], u[0])])
    outer = ca.Function("outer", [u], [outer_value + u[0], outer_vector], {"never_inline": True})
    root = ca.Function("root", [u], [ca.sqrt(ca.sumsqr(u) + 1.0)], {"never_inline": True})
    for count in (1, 2, 3, 4, 5, 9):
        x = ca.MX.sym("x", 3, count)
        results = [*inner.map(count)(x), root.map(count)(x)]
        for column in ca.horzsplit(x):
            results += outer(column)
        function = ca.Function("calls", [x], results)
        texts, compiled = in_c(function, f"calls_{count}")
        # Fours have no square root.
        assert "calls_in_fours" not in "".join(texts)
        in_fours = "".join(text for file, text in texts.items() if file.endswith("_in_fours.h"))
        assert ("EVERY_LANE" in in_fours) is (count >= 3)
        assert_same(compiled, function, 1e-15)


def test_a_map_of_a_function_of_matrices() -> None:
    """It is called for one group of columns after the other."""
    a, b = ca.MX.sym("a", 4, 4), ca.MX.sym("b", 4)
    one = ca.Function("one", [a, b], [a @ b, ca.sin(b)], {"never_inline": True})
    whole, columns = ca.MX.sym("whole", 4, 4), ca.MX.sym("columns", 4, 6)
    results = one.map(6).call([ca.repmat(whole, 1, 6), columns])
    function = ca.Function("mapped", [whole, columns], results)
    assert_same(in_c(function, "mapped_in_c")[1], function, 1e-15)


def test_an_argument_that_is_not_there_is_zero() -> None:
    """CasADi hands over no pointer for what is zero."""
    x, y = ca.MX.sym("x", 30), ca.MX.sym("y", 30)
    function = ca.Function("absent", [x, y], [x * y + ca.sin(x), ca.vertcat(y[:12], 1.0, x[20:])])
    _, compiled = in_c(function, "absent_in_c")
    z = ca.MX.sym("z", 30)
    with_zero = ca.Function("with_zero", [z], compiled.call([z, ca.MX(30, 1)]))
    expected = ca.Function("expected", [z], function.call([z, ca.MX(30, 1)]))
    assert_same(with_zero, expected, 1e-15)


def test_a_loop_over_entries_that_are_all_alike() -> None:
    """A number that is spread over entries, a constant one too, is one that four lanes share."""
    a, b = ca.MX.sym("a"), ca.MX.sym("b", 9)
    ones = ca.MX(ca.DM([3.0] * 9))
    function = ca.Function("alike", [a, b], [a * ones, ones + b, ca.repmat(a, 9, 1) - b * a, a * a + ones])
    assert_same(in_c(function, "alike_in_c")[1], function, 1e-15)


def test_small_steps_in_several_bundles(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bundle keeps the numbers that later ones read."""
    monkeypatch.setattr("cosserat_casadi.compiling.program_in_c.LONGEST_BUNDLE", 20)
    function = model.path_rate
    assert_same(in_c(function, "rate_in_bundles")[1], function, 1e-13)


def test_entries_that_lie_apart_are_gathered() -> None:
    """In a few runs, in runs of equal stride, in turns that move on, and one by one."""
    x = ca.MX.sym("x", 20, 20)
    few = ca.vec(x)[list(range(40, 90)) + list(range(200, 260))]
    runs = ca.vec(x[3:9, :])
    mixed = ca.vec(x)[[(7 * i * i) % 400 for i in range(150)]]
    turns = ca.vec(ca.vertcat(x[:, 2:9].T, ca.MX(1, 20), x[:, 3:12:4].T))
    function = ca.Function("gathered", [x], [few, runs, mixed, turns, ca.vertcat(mixed[:50], 0.0, 2.5, mixed[60:])])
    texts, compiled = in_c(function, "gathered_in_c")
    assert texts["gathered_in_c.c"].count("program_gather(res") == 5
    assert_same(compiled, function, 0.0)


def test_tables_of_places_are_short_where_turns_move_on_by_equal_steps() -> None:
    """Places of two matrices side by side, transposed, with a column of zeros between."""
    places = np.concatenate([40 + np.arange(24).reshape(4, 6), np.zeros((1, 6)), 7 * np.arange(12).reshape(2, 6)])
    tables = ConstantTables()
    assert tables.of_places(places.astype(int).T.reshape(-1, 1)) == "TABLE(t0), 1"
    (table,) = tables.by_name.values()
    assert " ".join(table.numbers) == "7 6 40 46 52 58 0 0 42 1 1 1 1 0 7 7"
    assert tables.of_places(np.array([[5], [3], [9], [8]])) == "TABLE(t1), 1"
    assert " ".join(tables.by_name["t1"].numbers) == "4 1 5 3 9 8"


def test_products_of_sparse_matrices() -> None:
    """Of a band, whose products move on by equal steps, and of any pattern."""
    rng = np.random.default_rng(2)
    anywhere = ca.sparsify(ca.DM(rng.uniform(-1, 1, (30, 8)) * (rng.uniform(size=(30, 8)) < 0.3))).sparsity()
    band = ca.Sparsity.band(30, 1) + ca.Sparsity.diag(30)
    x, y, z = ca.MX.sym("x", band), ca.MX.sym("y", band), ca.MX.sym("z", anywhere)
    function = ca.Function("sparse", [x, y, z], [ca.mtimes(x, y), ca.mtimes(x, z)])
    texts, compiled = in_c(function, "sparse_in_c")
    assert texts["sparse_in_c.c"].count("  program_sparse(") == 2
    assert_same(compiled, function, 1e-14)


def test_constant_matrices_are_multiplied_block_by_block() -> None:
    """The blocks lie apart in rows and columns, and one row and one column are zero; small blocks are not worth it."""
    rng = np.random.default_rng(6)
    matrix = np.zeros((181, 37))
    for first in range(3):
        matrix[first:180:3, first:36:3] = rng.uniform(-1, 1, (60, 12))
    x, z = ca.MX.sym("x", 37), ca.MX.sym("z", 4, 181)
    function = ca.Function("blocks", [x, z], [ca.DM(matrix) @ x, z @ ca.DM(matrix)])
    texts, compiled = in_c(function, "blocks_in_c")
    assert texts["blocks_in_c.c"].count("  product_dense_alone_60(") == 3
    assert "product_dense_alone_181(" not in texts["blocks_in_c.c"]
    assert_same(compiled, function, 1e-14)
    small = ca.sparsify(ca.DM(np.kron(np.eye(6), rng.uniform(-1, 1, (4, 4)))))
    y = ca.MX.sym("y", 24, 5)
    texts, compiled = in_c(ca.Function("whole", [y], [small @ y]), "whole_in_c")
    assert texts["whole_in_c.c"].count("  product_") == 1
    assert_same(compiled, ca.Function("whole", [y], [small @ y]), 1e-14)


def test_an_array_that_another_one_begins_with_is_read_there() -> None:
    """Of a matrix and its first columns there is one array, whichever is read first; other columns have their own."""
    matrix = ca.DM(np.random.default_rng(8).uniform(-1, 1, (60, 12)))
    x, y, z = (ca.MX.sym(name, size) for name, size in (("x", 9), ("y", 12), ("z", 9)))
    function = ca.Function("first", [x, y, z], [matrix[:, :9] @ x, matrix @ y, matrix[:, 3:] @ z])
    texts, compiled = in_c(function, "first_in_c")
    assert texts["first_in_c.c"].count("static const casadi_real first_in_c_table_") == 2
    assert texts["first_in_c.c"].count("(first_in_c_table_0, ") == 2
    assert_same(compiled, function, 1e-14)


def test_columns_of_sparse_matrices_are_read_in_groups() -> None:
    """Columns with equal rows, rows that move down or up by equal steps, no rows, and columns alone."""
    of_columns = [[0, 4], [2, 6], [4, 8], [7, 9], [5, 7], [3, 5], [], [], [1, 2, 9], [1, 2, 9], [1, 9], [0, 9], [3]]
    entries = [(row, column) for column, rows in enumerate(of_columns) for row in rows]
    pattern = ca.Sparsity.triplet(10, len(of_columns), *map(list, zip(*entries, strict=True)))
    assert column_groups(pattern) == [
        [2, 3, 2, 0, 4],
        [2, 3, -2, 7, 9],
        [0, 2, 0],
        [3, 2, 0, 1, 2, 9],
        [2, 1, 0, 1, 9],
        [2, 1, 0, 0, 9],
        [1, 1, 0, 3],
    ]
    x, y = ca.MX.sym("x", 21, 10), ca.MX.sym("y", pattern)
    z = ca.MX.sym("z", 21, len(of_columns))
    function = ca.Function("grouped", [x, y, z], [x @ y, ca.mac(x, y, z)])
    texts, compiled = in_c(function, "grouped_in_c")
    calls = [f"  {Product(21, False, alone).name}(" for alone in (False, True)]
    assert all(texts["grouped_in_c.c"].count(call) == 1 for call in calls)
    assert_same(compiled, function, 1e-14)


def test_what_has_no_form_is_left_to_casadi() -> None:
    """A linear system that is solved with pivoting."""
    a, b = ca.MX.sym("a", 12, 12), ca.MX.sym("b", 12)
    function = ca.Function("system", [a, b], [ca.solve(a, b, "qr")])
    with pytest.raises(UnknownInstructionError):
        program_of(function)
    texts = external_sources([function], "system", "long long int")
    compiled = ca.external("system", os.fspath(compiled_texts("system", texts, find_compiler())))
    assert_same(compiled, function, 1e-12)


def test_places_are_used_again() -> None:
    """A long chain works in little more room than a short one."""
    x = ca.MX.sym("x", 200)

    def room(count: int) -> int:
        value = x
        for _ in range(count):
            value = ca.sin(value) * x
        function = ca.Function("chain", [x], [value])
        return program_in_c(program_of(function), function).reals

    assert room(40) <= room(4)


def test_products_of_any_height() -> None:
    """The routines take rows in bunches of up to two sizes: every height must be met.

    Digits are the same at any width of vectors.
    """
    rng = np.random.default_rng(5)
    sparse = ca.sparsify(ca.DM(rng.uniform(-1, 1, (9, 5)) * (rng.uniform(size=(9, 5)) < 0.6)))
    y = ca.MX.sym("y", 9, 5)
    symbols = [y]
    results = []
    heights = (1, 2, 3, 4, 5, 6, 7, 11, 12, 13, 16, 17, 27, 33)
    for rows in heights:
        x = ca.MX.sym("x", rows, 9)
        z = ca.MX.sym("z", rows, 5)
        symbols += [x, z]
        results += [ca.mac(x, y, z), ca.mac(x, ca.MX(sparse), z)]
    function = ca.Function("products", symbols, results)
    texts = external_sources([function], "products", "long long int")
    for rows in heights:
        for dense in (True, False):
            name = Product(rows, dense, alone=False).name
            assert texts["products.c"].count(f"PRODUCT({name},") <= 1
    library = compiled_texts("products", texts, find_compiler())
    compiled = ca.external("products", os.fspath(library))
    assert_same(compiled, function, 1e-14)
    narrow = {**texts, "products.c": f"#define FOURS_ONCE\n{texts['products.c']}"}
    once = ca.external("products", os.fspath(compiled_texts("products_once", narrow, find_compiler())))
    assert_same(once, compiled, 0.0)
