"""Printed kernels of scalars_in_c.py and program_in_c.py, as parts of a source and its header."""

from __future__ import annotations

import re
import textwrap
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import casadi as ca

from cosserat_casadi.compiling.listing import LANES
from cosserat_casadi.compiling.products import Product, product_routines
from cosserat_casadi.compiling.texts import fill, resource
from cosserat_casadi.maths.typing import FloatArray

PROTOTYPE = """{qualified} {name}(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define {name}_SZ_ARG {arguments}
#define {name}_SZ_RES {results}
#define {name}_SZ_IW 0
#define {name}_SZ_W {reals}
"""

CALLEE = """static void MADE({name}_turn)(const casadi_real *given, casadi_real *made){body}
static void MADE({name})(const casadi_real *given, casadi_real *made, int turns) {{
  int turn;
  for (turn = 0; turn < turns; turn++, given += {given}, made += {made})
    {call}
}}
"""
"""Template of a function that kernels call, and of the loop over its calls."""

CALL_OF_FOUR = "EVERY_LANE(MADE({name}_turn)(given + lane, made + lane))"
CALL_OF_ONE = "MADE({name}_turn)(given, made);"

CHOICE = """static void MADE({name})({parameters}) {{
  IN_FOURS({name}, ({arguments}));
}}
"""
"""Template of a function for four numbers at a time, by the width of the processor's vectors."""

PARAMETERS_OF_CALLEE = {"given": "const casadi_real *", "made": "casadi_real *", "turns": "int "}
PARAMETERS_OF_LOOP = {"w": "casadi_real *"}
PARAMETERS_OF_COLUMNS = {
    "w": "const casadi_real *",
    "turns": "const casadi_real *",
    "columns": "casadi_real *",
    "passed": "casadi_real *",
    "groups": "int ",
}
"""Types of the parameters of functions for four numbers at a time, by name."""

PART_OF_COLUMNS = """static void MADE({name}_{part})(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed){body}"""
"""Template of a part of the code for four columns."""

COLUMNS = """static void MADE({name})(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {{
  int group;
  for (group = 0; group < groups; group++, turns += {turns}, columns += 4) {{
{calls}
  }}
}}
"""
"""Template of the loop over all columns, four at a time."""

CALL_OF_COLUMNS = "    EVERY_LANE(MADE({name}_{part})(w, turns + lane, columns + lane, passed + lane))"

INTEGERS = """#undef INTEGERS
#define INTEGERS(first) ({stem}_integers + (first))
"""
"""Macro by which kernels read tables of integers."""

NUMBERS = """#undef C
#define C {stem}_numbers
"""
"""Macro by which functions read constants that several functions share."""

NUMBER = re.compile(r"NUMBER\(([^()]+)\)")
"""Pattern of a constant in the text of a function before it is known whether it occurs once."""

LEFT_OUT = (
    '"no-tree-dse", "no-dse", "no-tree-dominator-opts", "no-tree-pta", \\\n'
    '    "no-tree-sink", "no-tree-sra", "no-tree-slsr", "no-tree-bit-ccp", "no-tree-ch"'
)
"""Passes of GCC that find nothing in straight-line code, but take a tenth of its time."""


@dataclass(frozen=True)
class ColumnForm:
    """A Jacobian, or some entries of one, by the columns of one rod.

    Attributes:
        function: (arguments, …, columns, turns) ↦ (results, …, column). The column follows from the turns, and the
            results from the matrix of all columns, which is stored by rows.
        turns: constant turns of all columns, shape (entries, stride), padded with zeros after the last one.
        rows: number of rows of the matrix of columns.
        turns_behind: None, or the number of constants that precede the turns in the argument before the columns, in
            the order of :func:`in_groups`; the turns may then differ from call to call.
    """

    function: ca.Function
    turns: FloatArray
    rows: int
    turns_behind: int | None = None

    @property
    def stride(self) -> int:
        """Number of columns of the matrix, a multiple of LANES."""
        return int(self.turns.shape[1])

    @property
    def columns_argument(self) -> int:
        """Index of the argument with the matrix of columns; the next one contains the turns of one column."""
        number: int = self.function.n_in() - 2
        return number


def in_groups(turns: FloatArray) -> FloatArray:
    """Order turns by groups of LANES columns, and within a group by entries."""
    entries, stride = turns.shape
    return turns.reshape(entries, stride // LANES, LANES).transpose(1, 0, 2).ravel()


@dataclass(frozen=True)
class Callee:
    """A function that kernels call for intervals of a rod.

    Attributes:
        body: body in C.
        width: number of intervals that it computes at once.
        operands: count of numbers that it reads for one interval.
        results: count of numbers that it writes for one interval.
    """

    body: str
    width: int
    operands: int
    results: int

    def text(self, name: str) -> str:
        """Write the function in C with a name, and a loop over its calls."""
        call = CALL_OF_ONE if self.width == 1 else CALL_OF_FOUR
        given, made = self.width * self.operands, self.width * self.results
        return CALLEE.format(name=name, body=self.body, given=given, made=made, call=call.format(name=name))


@dataclass(frozen=True)
class PlacedCallee:
    """A function that reads its arguments where they lie: the code of four columns calls it, or a kernel.

    Attributes:
        body: in C.
        arguments: how many pointers it takes besides one to its results.
        in_fours: whether it computes four columns.
    """

    body: str
    arguments: int
    in_fours: bool

    def text(self, name: str) -> str:
        """The function in C, under a name."""
        given = ", ".join(f"const casadi_real *p{i}" for i in range(self.arguments))
        return f"static void MADE({name})({given}, casadi_real *made){self.body}"


@dataclass(frozen=True)
class ConstantTable:
    """A constant array.

    Attributes:
        type: type of its numbers in C.
        numbers: the numbers in C.
    """

    type: str
    numbers: tuple[str, ...]

    def text(self, name: str) -> str:
        """Write the array in C with a name; an empty one has an unused number, since C has no empty arrays."""
        return _array(self.type, name, self.numbers or ("0",))


@dataclass(frozen=True, eq=False)
class PrintedKernel:
    """A function in C with the arguments of CasADi.

    Attributes:
        signature: a function with its name, arguments and results.
        tables: constant arrays in C by name: type of the numbers, and numbers as text. Kernels share equal ones.
        body: functions in C, the kernel itself last; their names are written as ``MADE()``.
        callees: functions that these call, by a word; their names consist of that of the kernel and the word.
        reals: size of its work array.
        statements: number of its statements.
        loops: functions that compute four entries at a time, by name, compiled for each width of vectors.
        columns: function that computes four columns at a time, by name, also for each width.
        is_program: whether it is a function of matrices, with loops.
        products: products of matrices whose routines it calls.
        kernels: kernels that it calls.
        places: places of its results in the work array, if it leaves them there for the kernels that call it.
    """

    signature: ca.Function
    tables: Mapping[str, ConstantTable]
    body: str
    callees: Mapping[str, Callee | PlacedCallee]
    reals: int
    statements: int
    loops: Mapping[str, str] = field(default_factory=dict)
    columns: Mapping[str, str] = field(default_factory=dict)
    is_program: bool = False
    products: tuple[Product, ...] = ()
    kernels: tuple[PrintedKernel, ...] = ()
    places: tuple[int, ...] = ()

    def name(self) -> str:
        """Name of the kernel in C."""
        name: str = self.signature.name()
        return name

    def n_instructions(self) -> int:
        """Number of statements."""
        return self.statements

    def prototype(self, qualifier: str = "") -> str:
        """Write the declaration of the kernel with a qualifier, and the sizes of its arrays."""
        arguments = self.signature.n_in()
        results = self.signature.n_out()
        sizes = {"arguments": arguments, "results": results, "reals": self.reals}
        return PROTOTYPE.format(name=self.name(), qualified=f"{qualifier}int", **sizes)


Kernel: TypeAlias = ca.Function | PrintedKernel
"""A function that is not printed yet, or the printed kernel."""


@dataclass(frozen=True)
class PrintedSources:
    """Text of kernels.

    Attributes:
        source: text for the source.
        functions: functions of kernels that make no calls four at a time, with constants inlined.
        prototypes: text for the header.
        included: files that the source includes, by name.
    """

    source: str
    functions: str
    prototypes: str
    included: dict[str, str]


def printed_sources(kernels: Sequence[PrintedKernel], stem: str, qualifier: str = "") -> PrintedSources:
    """Write kernels in C, for any processor and for the wider vectors of newer ones, with a qualifier of prototypes."""
    public = kernels
    kernels = _with_called(kernels)
    callees = _callees(kernels, stem)
    any_program = any(kernel.is_program or "program_" in kernel.body for kernel in kernels)
    routines = product_routines(product for kernel in kernels for product in kernel.products)
    tables = _tables(kernels, stem)
    bodies = {kernel.name(): _with_names(kernel, kernel.body, callees, tables) for kernel in kernels}
    called = [name for callee, name in callees.items() if isinstance(callee, Callee)]
    placed = [callee for callee in callees if isinstance(callee, PlacedCallee)]
    alone = {callee: callees[callee] for callee in placed if not callee.in_fours}
    functions = [callee.text(name) for callee, name in callees.items() if callee not in alone]
    choices = [_choice(name, PARAMETERS_OF_CALLEE) for name in called]
    for kernel in kernels:
        for in_fours, parameters in ((kernel.columns, PARAMETERS_OF_COLUMNS), (kernel.loops, PARAMETERS_OF_LOOP)):
            functions += [_with_names(kernel, text, callees, tables) for text in in_fours.values()]
            choices += [_choice(name, parameters) for name in in_fours]
    words = {
        "stem": stem,
        "left_out": LEFT_OUT,
        "programs": '#include "program.h"\n' + routines if any_program else "",
        "choices": "".join(choices),
        "once": "\n".join([*(callee.text(name) for callee, name in alone.items()), *bodies.values()]),
        "kernels": "".join(f"KERNEL({kernel.name()})\n" for kernel in public),
    }
    texts = [*functions, words["once"]]
    shared = {} if qualifier else _shared_numbers(texts)
    source = _tables_in_c(tables, stem)
    if shared:
        source += _array("double", f"{stem}_numbers", list(shared)) + NUMBERS.format(stem=stem)
    included = {}
    *functions, words["once"] = [_with_numbers(text, shared) for text in texts]
    if functions:
        source += fill(resource("templates", "fours.c.in"), words)
        included[f"{stem}_in_fours.h"] = "\n".join(["/* Included once for each width of vectors. */", *functions])
        included["fours.h"] = resource("c", "fours.h")
    if any_program:
        included["program.h"] = resource("c", "program.h")
    source += fill(resource("templates", "kernels_once.c.in"), words)
    prototypes = "".join(kernel.prototype(qualifier) for kernel in public)
    in_place = "\n".join(_with_numbers(text, {}) for text in texts)
    return PrintedSources(source, in_place, prototypes, included)


def _shared_numbers(texts: Iterable[str]) -> dict[str, str]:
    """Collect constants that occur several times in texts of functions; return their place in one array by text."""
    counts = Counter(number for text in texts for number in NUMBER.findall(text))
    several = [number for number, count in counts.items() if count > 1]
    return {number: f"C[{i}]" for i, number in enumerate(several)}


def _with_numbers(text: str, shared: Mapping[str, str]) -> str:
    """Insert constants in a text, shared ones as reads from their array."""
    return NUMBER.sub(lambda match: shared.get(match[1]) or _in_place(match[1]), text)


def _in_place(number: str) -> str:
    """Write a constant as an operand."""
    return f"({number})" if number.startswith("-") else number


def _choice(name: str, parameters: Mapping[str, str]) -> str:
    """Write a function that selects the version for four numbers at a time that suits the processor."""
    declared = ", ".join(kind + parameter for parameter, kind in parameters.items())
    return CHOICE.format(name=name, parameters=declared, arguments=", ".join(parameters))


def _with_called(kernels: Sequence[PrintedKernel]) -> list[PrintedKernel]:
    """List kernels after the kernels that they call, each once."""
    every: dict[str, PrintedKernel] = {}
    for kernel in kernels:
        for one in (*_with_called(kernel.kernels), kernel):
            same = every.setdefault(one.name(), one)
            assert same.body == one.body, f"two kernels are called {one.name()}"
    return list(every.values())


def _callees(kernels: Sequence[PrintedKernel], stem: str) -> dict[Callee | PlacedCallee, str]:
    """Names of the functions that kernels call: one name for each function, by whichever kernels it is called."""
    name_of: dict[Callee | PlacedCallee, str] = {}
    for kernel in kernels:
        for word, callee in kernel.callees.items():
            if callee not in name_of:
                name = f"{stem}_{word}"
                name_of[callee] = f"{name}_{len(name_of)}" if name in name_of.values() else name
    return name_of


def _tables(kernels: Sequence[PrintedKernel], stem: str) -> dict[ConstantTable, str]:
    """Name the constant arrays of kernels; arrays that begin alike share the longest, integers share one array."""
    name_of: dict[ConstantTable, str] = {}
    integers = 0
    every = list(dict.fromkeys(table for kernel in kernels for table in kernel.tables.values()))
    longest = _longest_with_each(every)
    for table in every:
        if table.type == "int":
            name_of[table] = f"INTEGERS({integers})"
            integers += len(table.numbers)
        elif longest[table] == table:
            name_of[table] = f"{stem}_table_{len(name_of)}"
    return name_of | {table: name_of[longest[table]] for table in every}


def _longest_with_each(tables: Sequence[ConstantTable]) -> dict[ConstantTable, ConstantTable]:
    """Longest constant array that begins with each array; for an array of integers the array itself."""
    by_first: dict[tuple[str, ...], list[ConstantTable]] = defaultdict(list)
    longest = {}
    for table in sorted(tables, key=lambda table: -len(table.numbers)):
        alike = [] if table.type == "int" else by_first[table.numbers[:1]]
        holders = [other for other in alike if other.numbers[: len(table.numbers)] == table.numbers]
        longest[table] = holders[0] if holders else table
        if not holders:
            alike.append(table)
    return longest


def _tables_in_c(name_of: Mapping[ConstantTable, str], stem: str) -> str:
    """Write the constant arrays in C, from the names by which they are read."""
    # The longest of arrays with one name comes last.
    by_length = sorted(name_of, key=lambda table: len(table.numbers))
    longest = {name_of[table]: table for table in by_length if table.type != "int"}
    texts = [longest[name].text(name) for name in dict.fromkeys(name_of.values()) if name in longest]
    integers = [number for table in name_of if table.type == "int" for number in table.numbers]
    if integers:
        texts += [_array("int", f"{stem}_integers", integers), INTEGERS.format(stem=stem)]
    return "".join(texts)


def _array(kind: str, name: str, numbers: Sequence[str]) -> str:
    """Write a constant array in C."""
    lines = textwrap.fill(", ".join(numbers), 119, initial_indent=" ", subsequent_indent=" ").replace(", ", ",")
    return f"static const {kind} {name}[{len(numbers)}] = {{\n{lines}}};\n"


def _with_names(
    kernel: PrintedKernel, text: str, callees: Mapping[Callee | PlacedCallee, str], tables: Mapping[ConstantTable, str]
) -> str:
    """Insert the common names of functions and constant arrays in the text of a kernel."""
    for word, callee in kernel.callees.items():
        text = text.replace(f"MADE({kernel.name()}_{word})", f"MADE({callees[callee]})")
    return re.sub(r"TABLE\((\w+)\)", lambda match: tables[kernel.tables[match[1]]], text)
