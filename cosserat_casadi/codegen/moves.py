"""Moves in the C that CasADi writes for an MX function, which take as long as the computations: fewer of them.

CasADi copies entries for every slice and stack, and looks up one by one where those lie that a matrix is put together
of. Here

* entries of a column are read where they lie while neither they nor their copy change;
* entries that lie together in runs of one length are moved run by run, out of a stack from where its pieces lie;
* a product that would be added to zeros is formed without them.

What is computed is the same, number by number.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from math import gcd

from cosserat_casadi.codegen.instructions_in_c import (
    CLEAR,
    COLUMN_NAME,
    COPY,
    DENSE_PRODUCT,
    GATHER,
    PIECE,
    SLICE,
    STACK,
    WRITTEN_FUNCTION,
    Instruction,
    Instructions,
    matched,
)

SHORTEST_RUN = 8
"""Entries of a run from which on it is moved at once."""

RUNS_ROUTINE = """\
static void casadi_runs(const casadi_real* x, const casadi_int* begin, casadi_int count, casadi_int length,
    casadi_real* y) {
  for (; count > 0; --count, ++begin, y += length) memcpy(y, x + *begin, length * sizeof(casadi_real));
}

"""
"""Moves runs of one length, each from its place, behind each other."""

MATHS = "#include <math.h>\n"
"""What every source of CasADi's includes."""

ALONE = "_alone"
"""What the name of a routine for products ends with that adds to nothing."""


def with_fewer_moves(source: str) -> str:
    """A source of CasADi's with fewer moves in its functions."""
    moves = _Moves(source)
    written = WRITTEN_FUNCTION.sub(lambda function: moves.fewer(function[0]), source)
    if moves.tables:
        first = WRITTEN_FUNCTION.search(written)
        assert first is not None, "tables are those of functions"
        # Before the function stands a comment that belongs to it.
        begin = written.rfind("\n\n", 0, first.start()) + 2
        written = written[:begin] + "".join(moves.tables) + RUNS_ROUTINE + written[begin:]
        written = written.replace(MATHS, f"{MATHS}#include <string.h>\n", 1)
    return _without_unused(written)


class _Moves:
    """Functions of a source, one after another, and the tables of runs that they need.

    Attributes:
        tables: definitions.
    """

    def __init__(self, source: str) -> None:
        self.source = source
        self.tables: list[str] = []

    def fewer(self, function: str) -> str:
        """A function with fewer moves."""
        instructions = Instructions.of(function)
        if instructions is None:
            return function
        _read_where_they_lie(instructions.listed)
        self._move_in_runs(instructions)
        _drop_unread_stacks(instructions.listed)
        _form_alone(instructions.listed)
        return instructions.text

    def _move_in_runs(self, instructions: Instructions) -> None:
        """Let entries that lie together be moved at once."""
        listed = instructions.listed
        for k, instruction in enumerate(listed):
            found = matched([GATHER], instruction.code)
            if found is None:
                continue
            numbers = _numbers(self.source, found["table"])
            length = _run_length(numbers)
            if length < SHORTEST_RUN:
                continue
            begins = numbers[::length]
            of = found["of"]
            pieces = _pieces_there(listed, k)
            if pieces is not None:
                _, behind = _place(of)
                in_stack = [behind + begin for begin in begins]
                in_pieces = _begins_in_pieces(in_stack, length, pieces, instructions.places)
                if in_pieces is not None:
                    begins = in_pieces
                    of = "w"
            code = f"  casadi_runs({of}, {self._table(begins)}, {len(begins)}, {length}, {found['to']});"
            moved = Instruction(instruction.comment, code)
            if of == "w" and pieces is not None:
                moved.reads = {name for piece, _ in pieces for name in COLUMN_NAME.findall(piece)}
            listed[k] = moved

    def _table(self, begins: Sequence[int]) -> str:
        """Name of a table of where runs begin."""
        name = f"casadi_r{len(self.tables)}"
        rows = [", ".join(map(str, begins[i : i + 8])) for i in range(0, len(begins), 8)]
        listed = ",\n  ".join(rows)
        self.tables.append(f"static const casadi_int {name}[{len(begins)}] =\n  {{{listed}}};\n\n")
        return name


def _read_where_they_lie(listed: list[Instruction]) -> None:
    """Drop copies of what lies together where the copy and what it is of stay as they are while it is read."""
    k = 0
    while k < len(listed):
        found = matched([SLICE, COPY], listed[k].code)
        if found is not None and _is_read_elsewhere(listed, k, found["to"], _behind(found)):
            del listed[k]
        else:
            k += 1


def _behind(found: re.Match[str]) -> str:
    """What the copy is of, as an expression."""
    column, behind = _place(found["of"])
    behind += int(found.groupdict().get("begin") or 0)
    return f"({column}+{behind})" if behind else column


def _place(of: str) -> tuple[str, int]:
    """Column, and how many entries behind its beginning, of what an instruction names."""
    column, _, behind = of.strip("()").partition("+")
    return column, int(behind or 0)


def _is_read_elsewhere(listed: list[Instruction], k: int, copy: str, original: str) -> bool:
    """Let what reads a copy that instruction k makes read the original, if that can be; else change nothing."""
    (column,) = COLUMN_NAME.findall(original)
    if column == copy:
        return False
    changed = False
    readers = []
    for j in range(k + 1, len(listed)):
        later = listed[j]
        changes_original = column in later.makes
        if copy in later.reads:
            if changed or changes_original:
                return False
            readers.append(j)
        if copy in later.makes:
            if not later.anew or copy in later.reads:
                return False
            break
        changed = changed or changes_original
    for j in readers:
        code = re.sub(rf"\b{copy}\b", original, listed[j].code)
        listed[j] = Instruction(listed[j].comment, code)
    return True


def _numbers(source: str, table: str) -> list[int]:
    """Numbers in a table."""
    found = re.search(rf"^static const casadi_int {table}\[\d+\]\s*=\s*\{{([^}}]*)\}};", source, flags=re.M)
    assert found is not None, "what a function reads is defined"
    return [int(number) for number in found[1].split(",")]


def _run_length(numbers: Sequence[int]) -> int:
    """The greatest length of runs, each of numbers one after the other, that a list falls into."""
    length = len(numbers)
    for i in range(1, len(numbers)):
        if numbers[i] != numbers[i - 1] + 1:
            length = gcd(length, i)
    return length


def _pieces_there(listed: Sequence[Instruction], k: int) -> list[tuple[str, int]] | None:
    """Pieces of the stack that instruction k takes entries of, with their sizes; None if they are there no more."""
    reads = listed[k].reads
    before = [j for j in range(k) if listed[j].makes & reads]
    if not before:
        return None
    stack = listed[before[-1]]
    if matched([STACK], stack.code) is None:
        return None
    pieces = re.findall(PIECE, stack.code)
    if len(pieces) != stack.code.count("\n"):
        return None
    changed = set[str]().union(*(listed[j].makes for j in range(before[-1], k + 1)))
    if changed & stack.reads:
        return None
    return [(piece, int(count)) for piece, count in pieces]


def _begins_in_pieces(
    begins: Sequence[int], length: int, pieces: Sequence[tuple[str, int]], places: dict[str, int]
) -> list[int] | None:
    """Where runs out of a stack begin in the work vector; None if one of them goes over the end of a piece.

    Args:
        begins: where they begin in the stack.
        length: of each run.
        pieces: of the stack, with their sizes.
        places: where columns begin in the work vector.
    """
    shifts = list[int]()
    ends = list[int]()
    end = 0
    for piece, count in pieces:
        column, behind = _place(piece)
        if column not in places:
            return None
        shifts.append(places[column] + behind - end)
        end += count
        ends.append(end)
    found = []
    for begin in begins:
        number = next(i for i, end in enumerate(ends) if begin < end)
        if begin + length > ends[number]:
            return None
        found.append(begin + shifts[number])
    return found


def _drop_unread_stacks(listed: list[Instruction]) -> None:
    """Drop stacks that nothing reads."""
    for k in range(len(listed) - 1, -1, -1):
        found = matched([STACK], listed[k].code)
        if found is not None and not _is_read(found["to"], listed[k + 1 :]):
            del listed[k]


def _is_read(column: str, later: Sequence[Instruction]) -> bool:
    """Whether a column is read before it is made anew."""
    for instruction in later:
        if column in instruction.reads:
            return True
        if column in instruction.makes and instruction.anew:
            return False
    return False


def _form_alone(listed: list[Instruction]) -> None:
    """Form products without zeros that they would be added to."""
    k = 0
    while k < len(listed):
        product = matched([DENSE_PRODUCT], listed[k].code)
        if product is not None:
            to = product["to"]
            named = [j for j in range(k) if to in listed[j].makes | listed[j].reads]
            # A factor that is the column itself has been read of zeros.
            clear = matched([CLEAR], listed[named[-1]].code) if named else None
            if clear is not None and COLUMN_NAME.findall(listed[k].code).count(to) == 1:
                routine = product["routine"]
                listed[k].code = listed[k].code.replace(f"{routine}(", f"{routine}{ALONE}(")
                listed[k].anew = True
                listed[k].reads = listed[k].reads - {to}
                del listed[named[-1]]
                k -= 1
        k += 1


def _without_unused(source: str) -> str:
    """A source without the routines that nothing calls any more, and without unused tables."""
    named = Counter(re.findall(r"\bcasadi_\w+", source))
    for name in ("casadi_clear", "casadi_copy"):
        # Once as a macro, once where it is defined.
        if named[name] == 2:
            source = re.sub(rf"^static void {name}\(.*?^\}}\n\n?", "", source, flags=re.M | re.S)
            source = re.sub(rf"^#define {name} .*\n", "", source, flags=re.M)
    return without_unused_tables(source)


def without_unused_tables(source: str) -> str:
    """A source without the tables of places that no function reads, sparsity patterns among them."""
    named = Counter(re.findall(r"\bcasadi_s\d+\b", source))
    defined = re.findall(r"^static const casadi_int (casadi_s\d+)\[", source, flags=re.M)
    # Once as a macro, once as an array.
    unused = {table for table in defined if named[table] == 2}

    def kept(definition: re.Match[str]) -> str:
        return "" if definition[1] in unused else definition[0]

    without_arrays = re.sub(r"^static const casadi_int (casadi_s\d+)\[[^;]*;\n", kept, source, flags=re.M)
    return re.sub(r"^#define (casadi_s\d+) .*\n", kept, without_arrays, flags=re.M)
