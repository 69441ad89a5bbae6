"""What is changed in the C code that CasADi writes for loops: products of matrices, and checks that never fail.

CasADi adds column after column to a column in memory, entry by entry. Here some rows of a column stay in registers
until all their products are summed, two in each register where the processor can. Sums and their order are the same.

CasADi asks before every entry that it reads or writes whether there is such an argument or result. Steps that are
written together are called with all of them, and compilers spend most of their time on these questions.
"""

from __future__ import annotations

import re

ROWS_AT_ONCE = (12, 6, 4, 3, 2, 1)
"""Rows that are summed together, most first: twelve doubles are six registers of two, the factors fill the rest."""

SPARSE = """static void casadi_mtimes_dense_sparse(const casadi_real* x, casadi_int n,
    const casadi_real* y, const casadi_int* sp_y, casadi_real* z) {{
  const casadi_int columns = sp_y[1], *colind = sp_y + 2, *row = colind + columns + 1;
  casadi_int c, k, r;
  for (c = 0; c < columns; ++c, z += n) {{
    const casadi_int begin = colind[c], end = colind[c + 1];
    r = 0;
{sums}
  }}
}}
"""

DENSE = """static void casadi_mtimes_dense(const casadi_real* x, casadi_int n, casadi_int inner,
    const casadi_real* y, casadi_int columns, casadi_real* z, casadi_int tr) {{
  casadi_int c, k, r;
  (void)tr;
  for (c = 0; c < columns; ++c, y += inner, z += n) {{
    const casadi_int begin = 0, end = inner;
    r = 0;
{sums}
  }}
}}
"""

SUMS = """    for (; r + {rows} <= n; r += {rows}) {{
      casadi_real {begun};
      for (k = begin; k < end; ++k) {{
        const casadi_real f = y[k], *s = x + {column} * n + r;
        {added}
      }}
      {stored}
    }}"""


TOGETHER = "steps"
"""What functions are called that steps are written together in."""


def improved(source: str) -> str:
    """A source of CasADi's with fast products, and without checks in functions called TOGETHER."""
    return _without_checks(_with_fast_products(source))


def _without_checks(source: str) -> str:
    """A source without checks whether there are arguments and results in functions called TOGETHER."""

    def unchecked(function: re.Match[str]) -> str:
        text = re.sub(r"arg\[\d+\]\? (arg\[\d+\]\[\d+\]) : 0", r"\1", function[0])
        return re.sub(r"if \(res\[\d+\]!=0\) ", "", text)

    return re.sub(rf"^/\* {TOGETHER}:.*?^\}}\n", unchecked, source, flags=re.M | re.S)


def _with_fast_products(source: str) -> str:
    """A source with the routines below in place of CasADi's own."""
    routines = {
        "casadi_mtimes_dense_sparse": SPARSE.format(sums=_sums("row[k]")),
        "casadi_mtimes_dense": DENSE.format(sums=_sums("k")),
    }
    for name, routine in routines.items():
        source = re.sub(rf"^static void {name}\(.*?^\}}\n", routine, source, flags=re.M | re.S)
    return source


def _sums(column: str) -> str:
    """The sums of the rows of one column of the result, where ``column`` is the column of x that meets y[k]."""
    return "\n".join(_sum(rows, column) for rows in ROWS_AT_ONCE)


def _sum(rows: int, column: str) -> str:
    return SUMS.format(
        rows=rows,
        column=column,
        begun=", ".join(f"a{i} = z[r + {i}]" for i in range(rows)),
        added=" ".join(f"a{i} += f * s[{i}];" for i in range(rows)),
        stored=" ".join(f"z[r + {i}] = a{i};" for i in range(rows)),
    )
