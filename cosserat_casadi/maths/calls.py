"""Calls of functions: at many arguments at once, and which functions are called within a function."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import chain, islice

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix

MOST_MAPPED = 64
"""Number of kept maps of functions over many arguments: enough for a few searches for modes."""

Pattern = tuple[tuple[int, int], list[int], list[int]]
"""Shape of a matrix, and rows and columns of its entries, column after column."""

KEPT = {"never_inline": True}
"""Options of functions that stay functions when a model is expanded to scalars: generated code calls them."""

ONE_DIRECTION = {"max_num_dir": 1}
"""Options of kernels: derivatives along several directions are as many calls of one function, not one long function.

CasADi differentiates kernels itself if rotations follow from the literal linear system. The C of a joint, or of a
material's law, would otherwise have megabytes, which take compilers minutes.
"""


def in_scalars(function: ca.Function, name: str) -> ca.Function:
    """A function under another name as scalar instructions, with common terms shared."""
    symbols = function.sx_in()
    return ca.Function(name, symbols, ca.cse(function.call(symbols)), function.name_in(), function.name_out())


def with_shared_terms(
    name: str, symbols: Sequence[Matrix], results: Sequence[Matrix], *words: list[str]
) -> ca.Function:
    """The function symbols ↦ results with equal terms shared; further words name its arguments and results.

    If results make one call several times, CasADi before 3.8 may merge these into a call with a repeated output, and
    refuse it. It does not if columns that make the call once each are merged one after the other.
    """
    try:
        return ca.Function(name, [*symbols], ca.cse([*results]), *words)
    except RuntimeError:
        merged: list[Matrix] = []
        for column in chain.from_iterable(map(ca.horzsplit, results)):
            merged = list(ca.cse([*merged, column]))
    columns = iter(merged)
    whole = [ca.horzcat(result[:, :0], *islice(columns, result.shape[1])) for result in results]
    return ca.Function(name, [*symbols], whole, *words)


def with_dense_results(function: ca.Function, name: str) -> ca.Function:
    """A function under another name, with dense results."""
    symbols = function.mx_in()
    results = [ca.densify(result) for result in function.call(symbols)]
    return ca.Function(name, symbols, results, function.name_in(), function.name_out())


def with_jacobian_in_a_loop(function: ca.Function) -> ca.Function:
    """A function whose Jacobian is a loop over its columns, each the derivative in one direction.

    CasADi's own Jacobian of a function of matrices has the instructions of all columns, one after the other. It takes
    the derivatives in one direction from the function itself, and in many from this Jacobian.

    Args:
        function: has one result, a dense column.
    """
    symbols = function.mx_in()
    (result,) = function.call(symbols)
    seeds = [ca.MX.sym("direction", *symbol.shape) for symbol in symbols]
    (moved,) = function.forward(1).call([*symbols, ca.MX(*result.shape), *seeds])
    along = ca.Function(f"{function.name()}_along", [*symbols, *seeds], [ca.densify(moved)])
    read = [sorted(set(function.jac_sparsity(0, i).get_col())) for i in range(len(symbols))]
    count = sum(map(len, read))
    directions = []
    first = 0
    for symbol, entries in zip(symbols, read, strict=True):
        direction = ca.DM(symbol.numel(), count)
        for place, entry in enumerate(entries, start=first):
            direction[entry, place] = 1.0
        directions.append(direction)
        first += len(entries)
    repeated = [ca.repmat(symbol, 1, count) for symbol in symbols]
    columns = along.map(count)(*repeated, *map(ca.densify, directions))
    output = ca.MX.sym("out", ca.Sparsity(*result.shape))
    blocks = [columns @ direction.T for direction in directions]
    jacobian = ca.Function(f"jac_{function.name()}", [*symbols, output], blocks)
    # CasADi takes d directions from the Jacobian if this times the number of arguments, or results, is less than d.
    penalty = 1.5 / min(function.nnz_in(), function.nnz_out())
    options = {"custom_jacobian": jacobian, "jac_penalty": penalty, **KEPT}
    return ca.Function(function.name(), symbols, [result], function.name_in(), function.name_out(), options)


def functions_within(function: ca.Function) -> list[ca.Function]:
    """The functions that a function calls, directly or not, once each.

    CasADi 3.7 does not list the function of a map.
    """
    known: dict[int, ca.Function] = {}
    callers = [function]
    while callers:
        caller = callers.pop()
        called = list(caller.find_functions(0))
        if caller.is_a("Map"):
            called.append(caller.info()["f"])
        fresh = {each.__hash__(): each for each in called if each.__hash__() not in known}
        known.update(fresh)
        callers.extend(fresh.values())
    return list(known.values())


def chooses(function: ca.Function) -> bool:
    """Whether a function, directly or not, calls another one depending on a value.

    Expanded to scalars, or to a program without branches, it would compute all branches.
    """
    return any(called.class_name() == "Switch" for called in functions_within(function))


def is_routine(function: ca.Function) -> bool:
    """Whether a function of matrices calls others, and is kept: generated code calls it instead of repeating it."""
    if not function.is_a("MXFunction") or not function.find_functions(0):
        return False
    try:
        function.call(function.mx_in(), True, False)
    except RuntimeError:
        # It is never to be inlined.
        return True
    return False


def has_routines(function: ca.Function) -> bool:
    """Whether a function, directly or not, calls a routine; routines are in matrices, and so is what calls them."""
    return any(is_routine(called) for called in functions_within(function))


def evaluated(function: ca.Function, *arguments: FloatArray, results: int | None = None) -> list[FloatArray]:
    """Outputs of a function of dense vectors at T arguments, of shape (T, rows, columns) each.

    Args:
        function: the function.
        arguments: in their order, shape (T, entries) each.
        results: how many of the first outputs are wanted; None for all.
    """
    count = len(arguments[0])
    patterns = _patterns(function)[:results]
    # CasADi maps over one argument at least; a motion that never started has none.
    if count == 0:
        return [np.zeros((0, *shape)) for shape, _, _ in patterns]
    # CasADi converts arrays to matrices and back entry by entry, which takes longer than the calls.
    buffer, evaluate = _mapped(function, count).buffer()
    given = [np.ascontiguousarray(values, dtype=float).ravel() for values in arguments]
    made = [np.zeros(count * len(rows)) for _, rows, _ in patterns]
    for number, array in enumerate(given):
        buffer.set_arg(number, array.data)
    for number, array in enumerate(made):
        buffer.set_res(number, array.data)
    evaluate()
    return [_dense(entries.reshape(count, -1), *pattern) for entries, pattern in zip(made, patterns, strict=True)]


@lru_cache(maxsize=MOST_MAPPED)
def _mapped(function: ca.Function, count: int) -> ca.Function:
    """A function mapped over ``count`` arguments; it is kept, since making it may take longer than its call."""
    return function.map(count)


@lru_cache(maxsize=MOST_MAPPED)
def _patterns(function: ca.Function) -> list[Pattern]:
    """The patterns of a function's outputs."""
    sparsities = [function.sparsity_out(index) for index in range(function.n_out())]
    return [(sparsity.shape, *sparsity.get_triplet()) for sparsity in sparsities]


def _dense(entries: FloatArray, shape: tuple[int, int], rows: list[int], columns: list[int]) -> FloatArray:
    """Matrices of a pattern from its entries, column after column: shapes (T, nonzeros) to (T, rows, columns)."""
    if len(rows) == shape[0] * shape[1]:
        return entries.reshape(-1, *shape[::-1]).swapaxes(1, 2)
    matrices = np.zeros((len(entries), *shape))
    matrices[:, rows, columns] = entries
    return matrices
