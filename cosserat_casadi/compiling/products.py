"""Routines in C for products of matrices, one for each number of rows.

Some rows of a column stay in registers until all their products are summed, four in each register if the processor can.
On x86 a routine is compiled twice, like functions for four numbers (templates/fours.c.in), and runs with the widest
vectors of the processor. It is aligned to a cache line: with one of four alignments a solve took an eighth longer.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import casadi as ca

ROWS_AT_ONCE = 16
"""Most rows that are summed together: sixteen doubles fill eight registers of two; factors need some of the others."""

TOGETHER_IN_REGISTER = 4
"""Number of doubles in one of the widest registers; bunches except the last are multiples of it."""

TWICE = """#if defined(__GNUC__) && defined(__x86_64__) && !defined(__AVX2__) && !defined(FOURS_ONCE) && \\
    !defined(FOURS_ONE_BY_ONE)
#define PRODUCT(name, given, passed)                                                                    \\
  __attribute__((target("avx2"), aligned(64))) static void name##_wide given { name##_sums passed; }                 \\
  static void name given {                                                                              \\
    if (__builtin_cpu_supports("avx2")) name##_wide passed;                                             \\
    else name##_sums passed;                                                                            \\
  }
#else
#define PRODUCT(name, given, passed) static void name given { name##_sums passed; }
#endif
#ifdef __GNUC__
#define SUMS static inline __attribute__((always_inline)) void
#else
#define SUMS static void
#endif
"""
"""Macros that define a routine by its sums, for any processor and for the wider vectors of newer ones."""

SPARSE = """SUMS product_sparse{alone}_{rows}_sums(const casadi_real* x,
    const casadi_real* y, const int* groups, int count, casadi_real* z) {{
  int c, k, r, turn;
  for (c = 0; c < count; ++c) {{
    const int inner = groups[0], turns = groups[1], step = {rows} * groups[2], *row = groups + 3;
    for (turn = 0; turn < turns; ++turn, y += inner, z += {rows}) {{
      const casadi_real *from = x + turn * step;
{sums}
    }}
    groups = row + inner;
  }}
}}
PRODUCT(product_sparse{alone}_{rows}, (const casadi_real* x, const casadi_real* y,
    const int* groups, int count, casadi_real* z), (x, y, groups, count, z))
"""

DENSE = """SUMS product_dense{alone}_{rows}_sums(const casadi_real* x, int inner,
    const casadi_real* y, int columns, casadi_real* z) {{
  int c, k, r;
  for (c = 0; c < columns; ++c, y += inner, z += {rows}) {{
    const casadi_real *from = x;
{sums}
  }}
}}
PRODUCT(product_dense{alone}_{rows}, (const casadi_real* x, int inner, const casadi_real* y,
    int columns, casadi_real* z), (x, inner, y, columns, z))
"""

BUNCHES = """    for (r = {first}; r < {last}; r += {count}) {{
      casadi_real {begun};
      for (k = 0; k < inner; ++k) {{
        const casadi_real f = y[k], *s = from + {column} * {rows} + r;
        {added}
      }}
      {stored}
    }}"""


@dataclass(frozen=True, order=True)
class Product:
    """A product X Y of a dense matrix X.

    Attributes:
        rows: number of rows of X.
        dense: whether Y is dense; else it is stored by columns, with a table of its entries
            (:func:`column_groups`).
        alone: whether the product is the result; else it is added to the result.
    """

    rows: int
    dense: bool
    alone: bool

    @property
    def name(self) -> str:
        """Name of the routine in C."""
        kind = "dense" if self.dense else "sparse"
        return f"product_{kind}{'_alone' if self.alone else ''}_{self.rows}"

    @property
    def text(self) -> str:
        """Text of the routine."""
        column = "k" if self.dense else "row[k]"
        alone = "_alone" if self.alone else ""
        sums = _sums(self.rows, column, self.alone)
        return (DENSE if self.dense else SPARSE).format(rows=self.rows, alone=alone, sums=sums)


def product_routines(products: Iterable[Product]) -> str:
    """Write the routines of these products; an empty string without products."""
    wanted = sorted(set(products))
    return TWICE + "".join(product.text for product in wanted) if wanted else ""


def column_groups(pattern: ca.Sparsity) -> list[list[int]]:
    """Group consecutive columns of a sparse matrix, in the form that the routines of products read.

    Each group consists of the number of entries of a column, the number of columns, the shift of the entries, in rows,
    from one column to the next, and the rows of the first column.
    """
    rows = pattern.row()
    groups: list[list[int]] = []
    before: list[int] = []
    for begin, end in pairwise(pattern.colind()):
        column = rows[begin:end]
        steps = {b - a for a, b in zip(before, column, strict=True)} if len(before) == len(column) else set()
        step = steps.pop() if steps else 0
        alike = bool(groups) and len(before) == len(column) and not steps
        if alike and (groups[-1][1] == 1 or groups[-1][2] == step):
            groups[-1][1] += 1
            groups[-1][2] = step
        else:
            groups.append([len(column), 1, 0, *column])
        before = column
    return groups


def _sums(rows: int, column: str, alone: bool) -> str:
    """Write the sums of the rows of one column of the result, in bunches of one size and a smaller last one.

    Args:
        rows: number of rows.
        column: the column of x that is multiplied by y[k].
        alone: whether the sums begin at zero; else they are added to z.
    """
    bunches = -(-rows // ROWS_AT_ONCE)
    in_each = -(-rows // bunches)
    size = min(rows, -(-in_each // TOGETHER_IN_REGISTER) * TOGETHER_IN_REGISTER)
    middle = rows // size * size
    parts = []
    for first, last, count in ((0, middle, size), (middle, rows, rows - middle)):
        if first < last:
            parts.append(_sum(rows, first, last, count, column, alone))
    return "\n".join(parts)


def _sum(rows: int, first: int, last: int, count: int, column: str, alone: bool) -> str:
    begun = ["0" if alone else f"z[r + {i}]" for i in range(count)]
    return BUNCHES.format(
        rows=rows,
        first=first,
        last=last,
        count=count,
        column=column,
        begun=", ".join(f"a{i} = {first_value}" for i, first_value in enumerate(begun)),
        added=" ".join(f"a{i} += f * s[{i}];" for i in range(count)),
        stored=" ".join(f"z[r + {i}] = a{i};" for i in range(count)),
    )
