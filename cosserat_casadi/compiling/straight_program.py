"""A scalar program (scalar_program.py) as C without loops, for the three stages of a step in lanes beside each other.

It takes a sixth to a half of the time of three calls of a kernel with loops, which gathers numbers for each of them.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from cosserat_casadi.compiling.listing import LANES
from cosserat_casadi.compiling.printed_kernels import PrintedKernel
from cosserat_casadi.compiling.scalar_program import FOURS, NUMBERS, ScalarProgram
from cosserat_casadi.compiling.statements import number_in_c
from cosserat_casadi.numerics.collocation import STAGES

LONGEST_PART = 1000
"""Most lines of a program in a function: the time of compilers grows faster than its length."""

BEFORE = """#undef EVERY
#ifdef FOURS_IN_VECTORS
#define EVERY(assignment) { int i; for (i = 0; i < 4; i++) assignment; }
#else
#define EVERY(assignment) { enum { i = 0 }; assignment; }
#endif
#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#pragma GCC push_options
#pragma GCC optimize("O1", "expensive-optimizations", "no-tree-dse", "no-dse", "no-inline-functions-called-once")
#endif
"""
"""Text before the parts: straight-line code is as fast with this, and takes compilers a quarter of the time."""

BEHIND = """#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#pragma GCC pop_options
#endif
"""

PART = """static void MADE({name}_turn)(casadi_real *w) {{
{lines}
}}
static void MADE({name})(casadi_real *w) {{
  EVERY_LANE(MADE({name}_turn)(w + lane))
}}
"""

KERNEL = """static int MADE({name})(const casadi_real **arg, casadi_real **res, casadi_real *w) {{
  int i, lane;
{lines}
  return 0;
}}
"""

SPREAD = """  for (i = 0; i < {count}; i++) {{
    for (lane = 0; lane < 4; lane++) w[4 * ({first} + i) + lane] = arg[{k}] ? arg[{k}][{column} * {count} + i] : 0;
  }}"""

COLLECTED = """  for (lane = 0; lane < {columns}; lane++) {{
    for (i = 0; i < {count}; i++) res[0][lane * {count} + i] = w[4 * ({first} + i) + lane];
  }}"""


def straight_kernels(program: ScalarProgram, function: ca.Function, of_stages: str) -> list[PrintedKernel]:
    """Write a function with one result as kernels: at one point, and under another name at three, a column each.

    Args:
        program: the program of the function.
        function: the function, with dense arguments and result.
        of_stages: name of the kernel for three points.
    """
    parts, size = _parts(program, function.nnz_out())
    names = [f"{of_stages}_part_{number}" for number in range(len(parts))]
    loops = {name: PART.format(name=name, lines="\n".join(lines)) for name, lines in zip(names, parts, strict=True)}
    loops[names[0]] = BEFORE + loops[names[0]]
    loops[names[-1]] += BEHIND
    points = [ca.MX.sym(name, function.nnz_in(i), STAGES) for i, name in enumerate(function.name_in())]
    results = [ca.MX.ones(function.nnz_out(), STAGES)]
    together = ca.Function(of_stages, points, results, function.name_in(), function.name_out())
    return [
        PrintedKernel(one, {}, _body(one, names, columns), {}, LANES * size, len(program.lines), loops=shared)
        for one, columns, shared in ((function, 1, {}), (together, STAGES, loops))
    ]


def _body(function: ca.Function, parts: Sequence[str], columns: int) -> str:
    """Write a kernel that fills the lanes, calls the parts and collects the result from some columns."""
    lines = []
    first = 0
    column = f"(lane < {columns} ? lane : {columns - 1})" if columns > 1 else "0"
    for k in range(function.n_in()):
        count = function.size1_in(k)
        if count:
            lines.append(SPREAD.format(count=count, first=first, k=k, column=column))
        first += count
    lines += [f"  MADE({name})(w);" for name in parts]
    lines.append(COLLECTED.format(columns=columns, count=function.size1_out(0), first=first))
    return KERNEL.format(name=function.name(), lines="\n".join(lines))


def _parts(program: ScalarProgram, results: int) -> tuple[list[list[str]], int]:
    """Write the statements of a program in parts; also return how many fours of memory they need.

    A value that one part computes and another reads is in memory, in a place behind arguments and results.
    """
    lines, slots, arguments = program.lines[:, :5], program.slots, program.arguments
    size = arguments + results
    # The line that wrote a slot last, and all readers of a line.
    writer: dict[int, int] = {}
    operands: list[tuple[tuple[int, int], ...]] = []
    for number, (_, to, *read) in enumerate(lines.tolist()):
        operands.append(tuple((slot, writer.get(slot, -1)) for slot in read))
        writer[to] = number
    of_result = {line: slot for slot, line in writer.items() if arguments <= slot < size}
    place = dict(of_result)
    # Nobody reads some lines: the last reader of each of the others, a result's line its own.
    last_reader = {line: line for line in of_result}
    for number in reversed(range(len(lines))):
        if number in last_reader:
            for _, line in operands[number]:
                last_reader.setdefault(line, number)

    def text(slot: int, line: int, first: int) -> str:
        if line >= first:
            return f"v{line}"
        if line >= 0 or slot < arguments:
            return f"LOAD(w + {LANES * (place[line] if line >= 0 else slot)})"
        return f"EACH({number_in_c(float(slots[slot]))})"

    parts = []
    for first in range(0, len(lines), LONGEST_PART):
        part = []
        for number, code in enumerate(lines[first : first + LONGEST_PART, 0].tolist(), start=first):
            if number not in last_reader:
                continue
            a, b, c = (text(slot, line, first) for slot, line in operands[number])
            if code in FOURS:
                value = FOURS[code].format(a=a, b=b, c=c)
                part.append(f"  const FOUR v{number} = {_four(value) if _is_one(a, b, c) else value};")
            else:
                stored = " ".join(f"STORE({x}, {_four(v) if _is_one(v) else v});" for x, v in (("a", a), ("b", b)))
                part.append(f"  FOUR v{number}; {{ casadi_real a[4], b[4]; {stored} (void)b;")
                part.append(f"    EVERY(a[i] = {NUMBERS[code]}) v{number} = LOAD(a); }}")
            if number in of_result or last_reader[number] >= first + LONGEST_PART:
                if number not in place:
                    place[number] = size
                    size += 1
                part.append(f"  STORE(w + {LANES * place[number]}, v{number});")
        parts.append(part)
    return parts, size


def _is_one(*operands: str) -> bool:
    """Whether operands are constants alone, each one number that stands for four."""
    return all(operand.startswith("EACH") for operand in operands)


def _four(number: str) -> str:
    """Text of a four of one number."""
    return f"SPREAD({number})"
