"""What is changed in the C code that CasADi writes: moves (moves.py), products, checks that never fail, long functions.

CasADi adds column after column to a column in memory, entry by entry. Here some rows of a column stay in registers
until all their products are summed, four in each register where the processor can. Sums and their order are the same.
There is a routine for each number of rows: the bunches fill them, and none is left that waits for single sums. On x86
it is made twice, as kernels in fours are (templates/fours.c.in): the wider one is taken where the processor has it.

CasADi asks before every entry that it reads or writes whether there is such an argument or result. Steps that are
written together are called with all of them, and compilers spend most of their time on these questions.

Long functions without loops are compiled with less optimisation by gcc: it takes half as long for them, and the code
is about as fast. Above all it does not look for stores that are overwritten unread: there are none, and the search
takes a sixth of its time.
"""

from __future__ import annotations

import re

from cosserat_casadi.codegen.moves import ALONE, with_fewer_moves
from cosserat_casadi.codegen.running_sums import with_loops

ROWS_AT_ONCE = 16
"""Most rows that are summed together: sixteen doubles are eight registers of two, the factors fill some of the rest."""

TOGETHER_IN_REGISTER = 4
"""Doubles in one of the widest registers: bunches are multiples of it, but for the last."""

TWICE = """#if defined(__GNUC__) && defined(__x86_64__) && !defined(__AVX2__) && !defined(FOURS_ONCE) && \\
    !defined(FOURS_ONE_BY_ONE)
#define PRODUCT(name, given, passed)                                                                    \\
  __attribute__((target("avx2"))) static void name##_wide given { name##_sums passed; }                 \\
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
"""What makes a routine of its sums, for any processor and for the wider vectors of newer ones."""

SPARSE = """SUMS casadi_mtimes_dense_sparse{alone}_{rows}_sums(const casadi_real* x,
    const casadi_real* y, const casadi_int* sp_y, casadi_real* z) {{
  const casadi_int columns = sp_y[1], *colind = sp_y + 2, *row = colind + columns + 1;
  casadi_int c, k, r;
  for (c = 0; c < columns; ++c, z += {rows}) {{
    const casadi_int begin = colind[c], end = colind[c + 1];
{sums}
  }}
}}
PRODUCT(casadi_mtimes_dense_sparse{alone}_{rows}, (const casadi_real* x, const casadi_real* y,
    const casadi_int* sp_y, casadi_real* z), (x, y, sp_y, z))
"""

DENSE = """SUMS casadi_mtimes_dense{alone}_{rows}_sums(const casadi_real* x, casadi_int inner,
    const casadi_real* y, casadi_int columns, casadi_real* z) {{
  casadi_int c, k, r;
  for (c = 0; c < columns; ++c, y += inner, z += {rows}) {{
    const casadi_int begin = 0, end = inner;
{sums}
  }}
}}
PRODUCT(casadi_mtimes_dense{alone}_{rows}, (const casadi_real* x, casadi_int inner, const casadi_real* y,
    casadi_int columns, casadi_real* z), (x, inner, y, columns, z))
"""

BUNCHES = """    for (r = {first}; r < {last}; r += {count}) {{
      casadi_real {begun};
      for (k = begin; k < end; ++k) {{
        const casadi_real f = y[k], *s = x + {column} * {rows} + r;
        {added}
      }}
      {stored}
    }}"""

TOGETHER = "steps"
"""What functions are called that steps are written together in."""

LONG = 1000
"""Lines from which on a function without loops is long."""

PLAINLY = "PLAINLY"
"""Macro of functions that gcc optimises less; not where it is told to optimise nothing."""

MACRO = f"""#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#define {PLAINLY} __attribute__((optimize("O1", "no-tree-dse", "no-dse")))
#else
#define {PLAINLY}
#endif

"""

FUNCTION = re.compile(r"^(/\* [^\n]* \*/\n)?(static int )(\w+\([^\n]*\) \{\n.*?^\}\n)", flags=re.M | re.S)


def improved(source: str) -> str:
    """A source of CasADi's as it is compiled.

    It has fewer moves and fast products, no checks in functions called TOGETHER, and long functions are marked.
    """
    return _with_marks(_without_checks(_with_fast_products(with_fewer_moves(with_loops(source)))))


def _with_marks(source: str) -> str:
    """A source in which long functions without loops are marked as PLAINLY."""

    def marked(function: re.Match[str]) -> str:
        text = function[3]
        if text.count("\n") < LONG or "for (" in text:
            return function[0]
        return f"{function[1] or ''}{function[2]}{PLAINLY} {text}"

    with_marks = FUNCTION.sub(marked, source)
    if with_marks == source:
        return source
    # Up to there nothing is marked.
    begin = next(FUNCTION.finditer(source)).start()
    return with_marks[:begin] + MACRO + with_marks[begin:]


def _without_checks(source: str) -> str:
    """A source without checks whether there are arguments and results in functions called TOGETHER."""

    def unchecked(function: re.Match[str]) -> str:
        text = re.sub(r"arg\[\d+\]\? (arg\[\d+\]\[\d+\]) : 0", r"\1", function[0])
        return re.sub(r"if \(res\[\d+\]!=0\) ", "", text)

    return re.sub(rf"^/\* {TOGETHER}:.*?^\}}\n", unchecked, source, flags=re.M | re.S)


def _with_fast_products(source: str) -> str:
    """A source with the routines above, one for each number of rows that it asks for, in place of CasADi's own."""
    for name, routine, column in (
        ("casadi_mtimes_dense_sparse", SPARSE, "row[k]"),
        ("casadi_mtimes_dense", DENSE, "k"),
    ):
        # CasADi's last argument of a dense product says that x is transposed, which it never is.
        end = r", 0\);" if routine is DENSE else r"\);"
        pattern = rf"\b{name}({ALONE}|)\(([^,\n]+), (\d+), (.*){end}"
        wanted = sorted({(int(found[3]), found[1]) for found in re.finditer(pattern, source)})
        made = ""
        for rows, alone in wanted:
            made += routine.format(rows=rows, alone=alone, sums=_sums(rows, column, bool(alone)))
        source = re.sub(rf"^static void {name}\(.*?^\}}\n", made, source, flags=re.M | re.S)
        source = re.sub(pattern, rf"{name}\1_\3(\2, \4);", source)
    begin = source.find("SUMS ")
    if begin < 0:
        return source
    return source[:begin] + TWICE + source[begin:]


def _sums(rows: int, column: str, alone: bool) -> str:
    """The sums of the rows of one column of the result, in bunches of one size and what is left.

    Args:
        rows: their number.
        column: the column of x that meets y[k].
        alone: whether they begin at zero; else they are added to z.
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
