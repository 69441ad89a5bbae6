"""C with fewer moves: the same numbers as CasADi computes, and copies where they are needed."""

from __future__ import annotations

import os
import re

import casadi as ca
import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi.codegen.compiler import compiled_texts, find_compiler
from cosserat_casadi.codegen.kernels import sources
from cosserat_casadi.codegen.moves import ALONE, SHORTEST_RUN, with_fewer_moves

ROWS = 12
"""Rows of the matrices of random functions; entries of a column are runs of this length."""


def in_c(functions: list[ca.Function], stem: str) -> tuple[str, list[ca.Function]]:
    """Source of functions, and the same functions compiled."""
    texts = sources(functions, stem, "long long int")
    library = os.fspath(compiled_texts(stem, texts, find_compiler()))
    return texts[f"{stem}.c"], [ca.external(function.name(), library) for function in functions]


def assert_same(compiled: ca.Function, function: ca.Function) -> None:
    rng = np.random.default_rng(8)
    given = [ca.DM(rng.uniform(-1, 1, function.size_in(i))) for i in range(function.n_in())]
    for found, expected in zip(compiled.call(given), function.call(given), strict=True):
        wanted = expected.full()
        assert_allclose(found.full(), wanted, rtol=0, atol=1e-14 * np.abs(wanted).max())


def changed(x: ca.MX, rng: np.random.Generator, pool: list[ca.MX]) -> ca.MX:
    """A matrix of ROWS rows out of some that there are: moved, changed, multiplied or put together."""
    y = pool[rng.integers(len(pool))]
    count = y.shape[1]
    kind = rng.integers(8)
    if kind == 0:
        begin = int(rng.integers(count))
        return y[:, begin : begin + 1 + int(rng.integers(count - begin))]
    if kind == 1:
        return ca.horzcat(x, y)
    if kind == 2:
        return y[:, rng.permutation(count).tolist()]
    if kind == 3:
        return ca.horzcat(y, ca.MX.zeros(ROWS, 2), x)[:, rng.permutation(count + 2).tolist()]
    if kind == 4:
        columns = min(count, x.shape[1])
        return x[:, :columns] * 0.5 - y[:, -columns:]
    if kind == 5:
        constant = rng.uniform(-0.5, 0.5, (count, 4)) * (rng.uniform(size=(count, 4)) < 0.5)
        return y @ ca.sparsify(ca.DM(constant))
    if kind == 6:
        # Columns of another division of the entries: a gather behind a slice of a stack.
        entries = ca.vec(ca.horzcat(x, y))[int(rng.integers(1, ROWS)) : -ROWS]
        columns = entries.numel() // ROWS
        return ca.reshape(entries[: ROWS * columns], ROWS, columns)[:, rng.permutation(columns).tolist()]
    return ca.mac(y, ca.DM(rng.uniform(-0.5, 0.5, (count, x.shape[1]))), x)


def random_function(seed: int) -> ca.Function:
    """A function of matrices that moves their columns about, some of them more than once."""
    rng = np.random.default_rng(seed)
    symbol = ca.MX.sym("x", ROWS, ROWS)
    pool = [ca.sin(symbol), symbol.T @ symbol]
    for _ in range(25):
        made = changed(pool[rng.integers(len(pool))], rng, pool)
        if 1 <= made.shape[1] <= 4 * ROWS:
            pool.append(made)
    return ca.Function(f"random_{seed}", [symbol], [ca.densify(matrix) for matrix in pool[2:]])


def test_random_functions_are_the_same() -> None:
    functions = [random_function(seed) for seed in range(30)]
    text, compiled = in_c(functions, "moved")
    for one, function in zip(compiled, functions, strict=True):
        assert_same(one, function)
    # They meet what is written otherwise.
    assert text.count(" casadi_runs(") > len(functions)
    assert text.count(f"{ALONE}_{ROWS}(") > len(functions)


def test_pieces_are_read_where_they_lie() -> None:
    x = ca.MX.sym("x", 9, 9)
    product = ca.vec(x @ x)
    function = ca.Function("pieces", [x], [ca.vertcat(ca.sin(product)[54:], product[:27])])
    text, (compiled,) = in_c([function], "pieces")
    assert "cs+=1" not in text
    assert re.search(r"casadi_copy\(\(w\d+\+54\), 27, res\[0\]\);", text)
    assert re.search(r"casadi_copy\(w\d+, 27, res\[0\]\+27\);", text)
    assert_same(compiled, function)


HEAD = "static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {\n"
VARIABLES = "  casadi_int i;\n  casadi_real *rr, *w0=w, *w1=w+20, *w2=w+40, *w3=w+80;\n  const casadi_real *cs;\n"


def function_of(*codes: str) -> str:
    """A function of these instructions."""
    body = "".join(f"  /* #{k}: */\n  {code}\n" for k, code in enumerate(codes))
    return f"{HEAD}{VARIABLES}{body}  return 0;\n}}\n"


def written(*codes: str) -> str:
    """A function of these instructions, with fewer moves."""
    return with_fewer_moves(function_of(*codes))


PIECE = "for (rr=w1, cs=w0+4; cs!=w0+14; cs+=1) *rr++ = *cs;"
READ = "for (i=0, rr=w2, cs=w1; i<10; ++i) *rr++ = (- *cs++ );"


def test_pieces_stay_where_one_side_changes() -> None:
    read_where_it_lies = READ.replace("cs=w1", "cs=(w0+4)")
    assert read_where_it_lies in written(PIECE, READ)
    for change in (
        "for (i=0, rr=w0, cs=w2; i<20; ++i) (*rr++) += (*cs++);",
        "for (i=0, rr=w1, cs=w2; i<10; ++i) (*rr++) += (*cs++);",
        "casadi_clear(w0, 20);",
        "casadi_mtimes_dense(w2, 2, 5, w2, 2, w0, 0);",
        "arg1[0]=w2;\n  res1[0]=w0;\n  if (casadi_f3(arg1, res1, iw, w, 0)) return 1;",
        "something_new(w0, w2);",
    ):
        kept = written(PIECE, change, READ)
        assert PIECE in kept
        assert READ in kept
    # What is made anew after the last reader, or only read, does not matter.
    for harmless in ("casadi_clear(w1, 20);", "casadi_mtimes_dense(w0, 2, 5, w0, 2, w2, 0);"):
        assert read_where_it_lies in written(PIECE, READ, harmless)
    # A piece that is written to while it is read.
    onto_itself = READ.replace("rr=w2", "rr=w0")
    assert PIECE in written(PIECE, onto_itself)


def test_products_alone() -> None:
    """Zeros go where nothing else is added, and stay where something reads them."""
    clear = "casadi_clear(w2, 4);"
    product = "casadi_mtimes_dense(w0, 2, 2, w1, 2, w2, 0);"
    alone = product.replace("dense(", f"dense{ALONE}(")
    assert alone in written(clear, product)
    assert "casadi_clear" not in written(clear, product)
    both = written(clear, product, product)
    assert alone in both
    assert product in both
    squared = product.replace("w1", "w2")
    assert clear in written(clear, squared)
    assert squared in written(clear, squared)
    reader = "for (i=0, rr=w1, cs=w2; i<4; ++i) *rr++ = (- *cs++ );"
    assert clear in written(clear, reader, product)


def test_entries_in_short_runs_are_taken_one_by_one() -> None:
    x = ca.MX.sym("x", 9, 9)
    product = ca.vec(x @ x)
    long_runs = [*range(40, 40 + SHORTEST_RUN), *range(SHORTEST_RUN), *range(20, 20 + SHORTEST_RUN)]
    short_runs = [*range(40, 43), *range(3), *range(21, 24)]
    function = ca.Function("runs", [x], [product.nz[long_runs], product.nz[short_runs]])
    text, (compiled,) = in_c([function], "runs")
    assert re.search(rf" casadi_runs\(w\d+, casadi_r0, 3, {SHORTEST_RUN}, w\d+\);", text)
    assert len(re.findall(r"\bcii=casadi_s\d+", text)) == 1
    assert_same(compiled, function)


def test_runs_out_of_two_pieces_of_a_stack() -> None:
    x = ca.MX.sym("x", 9, 9)
    product = x @ x
    stack = ca.horzcat(ca.sin(product)[:, 2:7], product[:, 1:6])
    in_one_piece = stack[:, [3, 4, 5, 6, 1, 2, 7, 8]]
    over_an_end = stack[:, [4, 5, 6, 7, 0, 1, 8, 9, 2, 3]]
    function = ca.Function("stacks", [x], [in_one_piece, over_an_end])
    _, (compiled,) = in_c([function], "stacks")
    assert_same(compiled, function)


def test_runs_behind_a_slice_of_a_stack() -> None:
    x, y = ca.MX.sym("x", 20), ca.MX.sym("y", 20)
    stack = ca.vertcat(ca.sin(x), ca.cos(y))
    behind = ca.reshape(stack[10:40], 10, 3)[:, [1, 0, 2]]
    function = ca.Function("behind", [x, y], [ca.vec(behind) * 2])
    _, (compiled,) = in_c([function], "behind")
    assert_same(compiled, function)
    stacked = "rr=w2;\n  for (i=0, cs=w0; i<20; ++i) *rr++ = *cs++;\n  for (i=0, cs=w1; i<20; ++i) *rr++ = *cs++;"
    gathered = "for (cii=casadi_s0, rr=w3, cs=(w2+10); cii!=casadi_s0+16; ++cii) *rr++ = cs[*cii];"
    numbers = ", ".join(map(str, [*range(10, 18), *range(8)]))
    source = f"static const casadi_int casadi_s0[16] = {{{numbers}}};\n\n/* behind */\n"
    runs = with_fewer_moves(source + function_of(stacked, gathered))
    # Twenty entries of w0, of which ten are left out, then w1, which lies behind it.
    assert "casadi_r0[2] =\n  {20, 10};" in runs
    assert "rr=w2;" not in runs


def test_nothing_is_left_that_nothing_names() -> None:
    text, _ = in_c([random_function(1)], "left")
    for name in re.findall(r"^static (?:void|const casadi_int) (casadi_(?:clear|copy|s\d+|r\d+))\b", text, flags=re.M):
        # As a macro, where it is defined, where it is used; tables of runs have no macro.
        assert len(re.findall(rf"\b{name}\b", text)) > (1 if "_r" in name else 2)
    for function in re.findall(r"^static int casadi_f\d+\([^\n]*\) \{\n(.*?)^\}\n", text, flags=re.M | re.S):
        for name in re.findall(r"\*(w\d+)=", function):
            assert len(re.findall(rf"\b{name}\b", function)) > 1
