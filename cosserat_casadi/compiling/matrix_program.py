"""A function of matrices as a program of few lines, each of which computes many slots: see scalar_program.py.

What only moves entries is no line: each entry has a number, and entries are gathered where a line reads neighbours.
A function that is mapped over points is one line for each of its instructions, for all points.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.numbered import Numbers, Value
from cosserat_casadi.compiling.scalar_program import GATHERED, SUMS_OF_PRODUCTS, ScalarProgram, scalar_program
from cosserat_casadi.compiling.steps import UnknownInstructionError, instruction_in_scalars, results_of
from cosserat_casadi.maths.typing import FloatArray


def matrix_program(function: ca.Function) -> ScalarProgram | None:
    """Make the program of a function of matrices or of scalars; None if an instruction is not supported."""
    if not function.is_a("MXFunction"):
        return scalar_program(function)
    writer = _Writer()
    arguments = [writer.slots_for(function.sparsity_in(i)) for i in range(function.n_in())]
    place = writer.new(np.zeros(function.nnz_out()))
    writer.zero = int(writer.new(np.zeros(1))[0])
    try:
        results = writer.results_of(function, arguments)
    except UnknownInstructionError:
        return None
    writer.gather(place, np.concatenate([result.numbers for result in results]))
    return writer.program(function.nnz_in())


class _Writer:
    """Writer of a program, whose entries have the numbers of their slots plus one; 0 is a zero.

    Attributes:
        zero: number of the slot of that zero.
    """

    def __init__(self) -> None:
        self.zero = 0
        self._contents: list[FloatArray] = []
        self._size = 0
        self._lines: list[Numbers] = []
        self._tables: list[Numbers] = []
        self._table_size = 0
        self._constants: dict[bytes, Numbers] = {}
        # A function that is kept keeps its hash from others.
        self._programs: dict[int, tuple[ca.Function, ScalarProgram | None]] = {}

    def program(self, arguments: int) -> ScalarProgram:
        """Return the program of all lines, whose first slots are those of so many arguments."""
        tables = np.concatenate([np.zeros(0, dtype=np.int64), *self._tables]).astype(np.intc)
        return ScalarProgram(
            np.concatenate(self._lines).astype(np.intc), np.concatenate(self._contents), arguments, tables
        )

    def new(self, values: FloatArray) -> Numbers:
        """Take slots with initial contents."""
        first = self._size + 1
        self._contents.append(values)
        self._size += len(values)
        return np.arange(first, first + len(values))

    def slots_for(self, pattern: ca.Sparsity) -> Value:
        """Take slots for the entries of a matrix."""
        return Value(pattern, self.new(np.zeros(pattern.nnz())))

    def gather(self, to: Numbers, numbers: Numbers) -> None:
        """Write a line that copies slots."""
        if len(to):
            self._write(GATHERED, to, self._table(self._slots_of(numbers)))

    def results_of(self, function: ca.Function, arguments: Sequence[Value]) -> list[Value]:
        """Write the lines of a function of matrices with these arguments; return its results."""
        return results_of(function, arguments, self._constant, self._computed)

    def _computed(self, code: int, node: ca.MX, operands: Sequence[Value]) -> list[Value]:
        """Write the lines of an instruction that computes; return its results."""
        if code == ca.OP_MTIMES:
            return [self._product(*operands)]
        if code == ca.OP_CALL:
            function = node.which_function()
            if function.is_a("MXFunction") and not self._is_chain(function):
                return self.results_of(function, operands)
            if function.class_name() == "Map":
                facts = function.info()
                return self._mapped(facts["f"], facts["n"], operands)
            return self._mapped(function, 1, operands)
        if node.is_unary() or node.is_binary():
            count = node.nnz()
            read = [self._neighbours(self._spread(operand, count)) - 1 for operand in operands]
            result = self.slots_for(node.sparsity())
            self._write(code, result.numbers, *read)
            return [result]
        return self._mapped(instruction_in_scalars(code, node, operands), 1, operands)

    def _is_chain(self, function: ca.Function) -> bool:
        """Whether a function of matrices mostly calls others: in scalars it is as short."""
        return bool(function.find_functions(0)) and function.expand().n_instructions() < 4 * function.n_instructions()

    def _spread(self, operand: Value, count: int) -> Numbers:
        """Numbers of so many entries: a scalar's number is repeated."""
        return np.repeat(operand.numbers, count) if len(operand.numbers) < count else operand.numbers

    def _neighbours(self, numbers: Numbers) -> int:
        """First of consecutive numbers with the contents of these; they are gathered if they do not lie so."""
        is_run = len(numbers) == 0 or numbers[-1] - numbers[0] == len(numbers) - 1
        if not is_run or np.any(numbers[1:] - numbers[:-1] != 1) or not numbers.all():
            beside = self.new(np.zeros(len(numbers)))
            self.gather(beside, numbers)
            numbers = beside
        return int(numbers[0]) if len(numbers) else 1

    def _mapped(self, function: ca.Function, count: int, operands: Sequence[Value]) -> list[Value]:
        """Write the lines of a function of scalars at so many points side by side; return its results."""
        key = hash(function)
        if key not in self._programs:
            scalars = function.expand() if function.is_a("MXFunction") else function
            self._programs[key] = function, scalar_program(scalars)
        _, program = self._programs[key]
        if program is None:
            raise UnknownInstructionError
        own = self.new(np.repeat(program.slots, count))
        entries = [operand.numbers.reshape(count, -1).T.ravel() for operand in operands]
        self.gather(own[: program.arguments * count], np.concatenate(entries))
        lines = program.lines.astype(np.int64)
        lines[:, 1:5] = own[0] - 1 + count * lines[:, 1:5]
        lines[:, 5] = count
        self._lines.append(lines)
        results = []
        first = program.arguments
        for i in range(function.n_out()):
            size = function.nnz_out(i)
            numbers = own[first * count : (first + size) * count].reshape(size, count).T.ravel()
            results.append(Value(ca.repmat(function.sparsity_out(i), 1, count), numbers))
            first += size
        return results

    def _constant(self, matrix: ca.DM) -> Value:
        """Take slots for a constant matrix; matrices with equal stored entries share them."""
        entries = np.array(matrix.nonzeros())
        key = entries.tobytes()
        if key not in self._constants:
            self._constants[key] = np.where(entries == 0.0, 0, self.new(entries))
        return Value(matrix.sparsity(), self._constants[key])

    def _product(self, added: Value, left: Value, right: Value) -> Value:
        """Write the line of added + left right at the stored entries of ``added``; return the sum."""
        stored = _places(added.pattern)
        # Each entry of the right matrix is multiplied with a column of the left one.
        ends = np.array(left.pattern.colind())
        row, column = _rows_and_columns(right.pattern)
        counts = np.diff(ends)[row]
        of_right = np.repeat(np.arange(len(row)), counts)
        of_left = np.arange(len(of_right)) + np.repeat(ends[row] - np.cumsum(counts) + counts, counts)
        places = _rows_and_columns(left.pattern)[0][of_left] + left.pattern.size1() * column[of_right]
        one = self._constant(ca.DM(1.0)).numbers
        factors = np.stack([left.numbers[of_left], right.numbers[of_right]], axis=1)
        whole = np.stack([added.numbers, np.broadcast_to(one, added.numbers.shape)], axis=1)
        factors, places = np.concatenate([whole, factors]), np.concatenate([stored, places])
        kept = factors.all(axis=1) & np.isin(places, stored)
        factors, places = factors[kept], places[kept]
        counts = np.bincount(np.searchsorted(stored, places), minlength=len(stored))
        pairs = self._slots_of(factors[np.argsort(places, kind="stable")])
        result = self.slots_for(added.pattern)
        self._write(SUMS_OF_PRODUCTS, result.numbers, self._table(counts), self._table(pairs))
        return result

    def _write(self, code: int, to: Numbers, *operands: int) -> None:
        first, second = operands[0], operands[-1]
        if len(to):
            self._lines.append(np.array([[code, to[0] - 1, first, second, first, len(to)]]))

    def _slots_of(self, numbers: Numbers) -> Numbers:
        return np.where(numbers == 0, self.zero, numbers).ravel() - 1

    def _table(self, entries: Numbers) -> int:
        """Append entries to the tables; return the place of the first one."""
        first = self._table_size
        self._tables.append(entries)
        self._table_size += len(entries)
        return first


def _rows_and_columns(pattern: ca.Sparsity) -> tuple[Numbers, Numbers]:
    """Row and column of each stored entry."""
    columns = np.repeat(np.arange(pattern.size2()), np.diff(pattern.colind()))
    return np.array(pattern.row(), dtype=np.int64), columns


def _places(pattern: ca.Sparsity) -> Numbers:
    """Ascending places of the stored entries in a matrix with all entries."""
    rows, columns = _rows_and_columns(pattern)
    return rows + pattern.size1() * columns
