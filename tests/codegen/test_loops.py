"""Functions written for loops in C: the same numbers as before, in Python and compiled."""

from __future__ import annotations

import os
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, discretise, scene_from_dict
from cosserat_casadi.codegen.compiler import compiled_texts, find_compiler
from cosserat_casadi.codegen.kernels import sources
from cosserat_casadi.codegen.loops import in_loops
from cosserat_casadi.codegen.routines import LONG, PLAINLY, TOGETHER

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


@pytest.mark.parametrize("name", list(FUNCTIONS))
def test_function_of_a_model_is_the_same_in_loops(model: Model, name: str) -> None:
    function = FUNCTIONS[name](model)
    written = in_loops(function)
    assert (written.name_in(), written.name_out()) == (function.name_in(), function.name_out())
    assert_same(written, function, 1e-14)


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
        ca.mac(s, x, x),
        x / ca.norm_2(ca.vec(x)),
        ca.sumsqr(x) - ca.mmax(s),
        ca.if_else(x[0, 0] > 0.5, x, -x),
        ca.cumsum(x, 1),
        ca.atan2(x, 2.0),
        ca.reshape(v[::-1], 8, 5) @ x[:3, :].T.nz[[0, 4, 2, 1, 3]],
        ca.vertcat(v, 1.0, 0.0, v[3:7]),
        ca.MX(3, 3),
        ca.MX(2.0),
    ]
    function = ca.Function("kinds", [x, s, v], results)
    assert_same(in_loops(function), function, 1e-15)


def test_one_number_taken_several_times() -> None:
    """It is a column beside other entries, as a factor on all of a wrench is."""
    matrix = ca.MX.sym("matrix", 30, 30)
    vector = ca.MX.sym("vector", 30)
    product = matrix @ vector
    stacked = ca.vertcat(ca.repmat(ca.dot(product, product), 6, 1), product)
    function = ca.Function("stacked", [matrix, vector], [stacked])
    assert_same(in_loops(function), function, 1e-15)


def test_scalars_stay_as_they_are() -> None:
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [ca.sin(x)])
    assert in_loops(function) is function


@pytest.mark.parametrize("name", ["jacobian", "motion"])
def test_compiled(model: Model, name: str) -> None:
    function = FUNCTIONS[name](model)
    stem = f"looped_{name}"
    symbols = function.mx_in()
    renamed = ca.Function(stem, symbols, function.call(symbols), function.name_in(), function.name_out())
    texts = sources([in_loops(renamed)], stem, "long long int")
    library = compiled_texts(stem, texts, find_compiler())
    assert_same(ca.external(stem, os.fspath(library)), function, 1e-13)
    # Steps that are written together ask for nothing; all other functions do.
    for text in texts[f"{stem}.c"].split("\n/* ")[1:]:
        together = text.startswith(f"{TOGETHER}:")
        assert not (together and "!=0) res" in text)
    assert f"\n/* {TOGETHER}:" in texts[f"{stem}.c"]


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
    texts = sources([function], "products", "long long int")
    for rows in heights:
        for routine in (f"casadi_mtimes_dense_{rows}", f"casadi_mtimes_dense_sparse_{rows}"):
            assert texts["products.c"].count(f"PRODUCT({routine},") == 1
            assert texts["products.c"].count(f" {routine}(") == 1
    library = compiled_texts("products", texts, find_compiler())
    compiled = ca.external("products", os.fspath(library))
    assert_same(compiled, function, 1e-14)
    narrow = {**texts, "products.c": f"#define FOURS_ONCE\n{texts['products.c']}"}
    once = ca.external("products", os.fspath(compiled_texts("products_once", narrow, find_compiler())))
    assert_same(once, compiled, 0.0)


def test_long_functions_without_loops_are_marked() -> None:
    """Those alone, and the macro stands once before them."""
    x = ca.SX.sym("x", 3)
    value = x
    for _ in range(LONG):
        value = ca.vertcat(value[1] * value[2], value[2] + x[0], value[0] * x[1])
    short = ca.Function("short", [x], [ca.sin(x)])
    text = sources([ca.Function("long", [x], [value]), short], "marked", "int")["marked.c"]
    assert text.count(f"static int {PLAINLY} ") == 1
    assert text.index(f"#define {PLAINLY}") < text.index(f"static int {PLAINLY} ")
    assert PLAINLY not in sources([short], "plain", "int")["plain.c"]
