"""A function of scalars as a table that a loop in C interprets, for three stages of a step at once, without compiling.

CasADi's virtual machine computes one state at a time, and takes as long to decode an instruction as to execute it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain
from typing import NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.compiling.called import called_functions
from cosserat_casadi.compiling.listing import BINARY, CHOICES, FUNCTIONS, REWRITTEN
from cosserat_casadi.maths.typing import FloatArray

Lines = npt.NDArray[np.intc]
"""One line for each instruction: CasADi's number of the operation, slots of the result and of the operands."""

PLUS_PRODUCT, MINUS_PRODUCT, PRODUCT_MINUS = range(300, 303)
"""Operations in addition to CasADi's: c + a b, c − a b and a b − c, rounded twice as by two instructions."""

GATHERED, SUMS_OF_PRODUCTS = 310, 311
"""Operations that read slots from tables: copies of slots, and for each result a number of products and their sum."""

OF_TWO = {"atan2", "pow", "fmin", "fmax", "fmod", "copysign", "hypot"}
"""Functions of the mathematical library with two arguments."""

FOURS = {ca.OP_ASSIGN: "{a}", ca.OP_SQ: "{a} * {a}"}
FOURS |= {code: f"{{a}} {sign} {{b}}" for code, sign in BINARY.items()}
FOURS |= {PLUS_PRODUCT: "{c} + {a} * {b}", MINUS_PRODUCT: "{c} - {a} * {b}", PRODUCT_MINUS: "{a} * {b} - {c}"}
FOURS |= {code: f"EACH({number!r}) {BINARY[operation]} {{a}}" for code, (operation, number) in REWRITTEN.items()}
"""Operations on four lanes at once."""

NUMBERS = {code: f"{name}(a[i], b[i])" if name in OF_TWO else f"{name}(a[i])" for code, name in FUNCTIONS.items()}
NUMBERS |= {code: text.format("a[i]", "b[i]") for code, text in CHOICES.items()}
"""Operations on one lane after the other."""

KNOWN = {ca.OP_ASSIGN, ca.OP_SQ, ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CALL, *REWRITTEN}
KNOWN |= {*BINARY, *FUNCTIONS, *CHOICES}
"""Instructions that a line can be written for."""


class ScalarProgram(NamedTuple):
    """A function as lines on numbered slots: first the slots of arguments, then those of results.

    Attributes:
        lines: shape (lines, 6): operation, first slots of the result and of three operands, number of slots of each.
            In place of operands some have places in the tables.
        slots: initial contents of the slots, with constants in place, shape (slots,).
        arguments: number of slots of arguments.
        tables: numbers of slots that do not lie side by side.
    """

    lines: Lines
    slots: FloatArray
    arguments: int
    tables: Lines = np.zeros(0, np.intc)

    @property
    def in_c(self) -> Lines:
        """The lines with the tables behind them, as C reads them."""
        return np.concatenate([self.lines.ravel(), self.tables])


def scalar_program(function: ca.Function) -> ScalarProgram | None:
    """Make the program of a scalar function (an ``SXFunction``); None if an instruction is not supported."""
    if not function.is_a("SXFunction"):
        return None
    writer = _Writer()
    lines = writer.lines_of(function, 0)
    if lines is None:
        return None
    slots = np.zeros(writer.size)
    for begin, values in writer.constants:
        slots[begin : begin + len(values)] = values
    arguments = function.nnz_in()
    results = slice(arguments, arguments + function.nnz_out())
    return ScalarProgram(_with_products(_without_copies(lines, results), results), slots, arguments)


@dataclass
class _Writer:
    """Writer of a program: slots in use, and the functions that are called.

    Attributes:
        size: number of slots.
        constants: first slot and values of the constants of each function.
        called: first slot and lines of each called function, by its hash.
    """

    size: int = 0
    constants: list[tuple[int, FloatArray]] = field(default_factory=list)
    called: dict[int, tuple[int, Lines | None]] = field(default_factory=dict)

    def lines_of(self, function: ca.Function, begin: int) -> Lines | None:
        """Write the lines of a function whose slots begin at ``begin``; None if an instruction is not supported."""
        every = range(function.n_instructions())
        codes = np.fromiter(map(function.instruction_id, every), np.intc, len(every))
        if not KNOWN.issuperset(codes.tolist()):
            return None
        operand, other = _first_and_last(map(function.instruction_input, every), len(every))
        result, entry = _first_and_last(map(function.instruction_output, every), len(every))
        arguments = begin + np.cumsum([0, *(function.nnz_in(i) for i in range(function.n_in()))])
        results = arguments[-1] + np.cumsum([0, *(function.nnz_out(i) for i in range(function.n_out()))])
        constant = codes == ca.OP_CONST
        values = np.array([function.instruction_constant(k) for k in np.flatnonzero(constant).tolist()])
        first = int(results[-1])
        self.constants.append((first, values))
        work = first + len(values)
        self.size = max(self.size, work + function.sz_w())

        lines = np.stack([codes, work + result, work + operand, work + other], axis=1).astype(np.intc)
        lines[constant, 2] = first + np.arange(len(values))
        read, written = codes == ca.OP_INPUT, codes == ca.OP_OUTPUT
        lines[read, 2] = arguments[operand[read]] + other[read]
        lines[written, 1] = results[result[written]] + entry[written]
        moved = constant | read | written
        lines[moved, 0] = ca.OP_ASSIGN
        lines[moved, 3] = lines[moved, 2]

        parts = []
        last = -1
        for k, callee in called_functions(function, codes.tolist()).items():
            operands = np.array(function.instruction_input(k), np.intc)
            results_of_call = np.array(function.instruction_output(k), np.intc)
            within = self._call(callee, operands, results_of_call, work)
            if within is None:
                return None
            parts += [lines[last + 1 : k], *within]
            last = k
        return np.concatenate([*parts, lines[last + 1 :]])

    def _call(self, callee: ca.Function, operands: Lines, results: Lines, work: int) -> list[Lines] | None:
        """Write the lines of a call: copies of the arguments, the function, and copies of the results.

        Args:
            callee: the function that is called.
            operands: numbers of all its arguments in the work of the caller.
            results: numbers of its results there; negative for results that are not wanted.
            work: slot of the first number of the caller's work.
        """
        place = callee.__hash__()
        if place not in self.called:
            begin = self.size
            self.called[place] = begin, self.lines_of(callee, begin)
        begin, lines = self.called[place]
        if lines is None:
            return None
        own = begin + np.arange(len(operands) + len(results), dtype=np.intc)
        arguments = own[: len(operands)]
        values = own[len(operands) :]
        wanted = results >= 0
        return [_copied(arguments, work + operands), lines, _copied(work + results[wanted], values[wanted])]


def _first_and_last(numbers: Iterable[list[int]], count: int) -> tuple[Lines, Lines]:
    """First and last number in the list of each instruction; zeros for empty lists.

    No list is kept: with tens of thousands of lists Python would search for cycles of references.
    """
    ends = chain.from_iterable((each[0], each[-1]) if each else (0, 0) for each in numbers)
    both = np.fromiter(ends, np.intc, 2 * count).reshape(-1, 2)
    return both[:, 0], both[:, 1]


def _copied(to: Lines, slots: Lines) -> Lines:
    """Write lines that copy slots."""
    return np.stack([np.full(len(to), ca.OP_ASSIGN), to, slots, slots], axis=1).astype(np.intc)


def _definitions(lines: Lines) -> Lines:
    """Indices of the lines that wrote the operands of each line, −1 if none did, shape (lines, 2)."""
    # A stable sort by slot keeps the order of the program, in which a line reads its operands before it writes.
    slots = lines[:, [2, 3, 1]].ravel()
    order = np.argsort(slots.astype(np.min_scalar_type(slots.max(initial=0))), kind="stable")
    ordered = slots[order]
    last_write = np.maximum.accumulate(np.where(order % 3 == 2, np.arange(len(order)), -1))
    is_same = (last_write >= 0) & (ordered[last_write] == ordered)
    definitions = np.empty(len(order), np.intc)
    definitions[order] = np.where(is_same, order[last_write] // 3, -1)
    return definitions.reshape(-1, 3)[:, :2]


def _are_results(lines: Lines, results: slice) -> npt.NDArray[np.bool_]:
    """Mask of the lines that write a result of the program."""
    return np.asarray((results.start <= lines[:, 1]) & (lines[:, 1] < results.stop))


def _without_copies(lines: Lines, results: slice) -> Lines:
    """Replace reads of copied constants and arguments by reads of the originals, and drop the copies."""
    is_written = np.zeros(lines[:, 1:].max(initial=0) + 1, dtype=bool)
    is_written[lines[:, 1]] = True
    is_copy = (lines[:, 0] == ca.OP_ASSIGN) & ~is_written[lines[:, 2]]
    lines = lines.copy()
    for column, definitions in zip((2, 3), _definitions(lines).T, strict=True):
        of_copy = (definitions >= 0) & is_copy[definitions]
        lines[of_copy, column] = lines[definitions[of_copy], 2]
    return np.asarray(lines[~is_copy | _are_results(lines, results)])


def _with_products(lines: Lines, results: slice) -> Lines:
    """Make lines on single slots with three operands; a product and the only sum that reads it become one line."""
    operation, to, first, second = lines.T
    definitions = _definitions(lines)
    read = np.concatenate([definitions[:, 0], definitions[first != second, 1]])
    readers = np.bincount(read[read >= 0], minlength=len(lines))
    is_product = np.isin(operation, (ca.OP_MUL, ca.OP_SQ)) & (readers == 1) & ~_are_results(lines, results)
    is_sum = np.isin(operation[1:], (ca.OP_ADD, ca.OP_SUB))
    is_first, is_second = first[1:] == to[:-1], second[1:] == to[:-1]
    products = np.flatnonzero(is_product[:-1] & is_sum & (is_first != is_second))
    sums = products + 1
    joined = np.concatenate([lines, first[:, None], np.ones_like(first)[:, None]], axis=1)
    joined[sums, 2:4] = lines[products, 2:4]
    joined[sums, 4] = np.where(is_first[products], second[sums], first[sums])
    difference = np.where(is_first[products], PRODUCT_MINUS, MINUS_PRODUCT)
    joined[sums, 0] = np.where(operation[sums] == ca.OP_ADD, PLUS_PRODUCT, difference)
    return np.ascontiguousarray(np.delete(joined, products, axis=0))


def cases_in_c() -> str:
    """Write the cases of the loop in C by operation: operands ``a``, ``b``, ``c`` of a line, and its result ``to``."""
    loaded = {code: text.format(a="LOAD(a)", b="LOAD(b)", c="LOAD(c)") for code, text in FOURS.items()}
    lines = [f"    case {code}: MANY(STORE(to, {text})) break;" for code, text in sorted(loaded.items())]
    lines += [f"    case {code}: MANY(EVERY(to[i] = {text})) break;" for code, text in sorted(NUMBERS.items())]
    lines += [f"    case {GATHERED}: GATHER break;", f"    case {SUMS_OF_PRODUCTS}: ADD_PRODUCTS break;"]
    return " \\\n".join(lines)
