"""Representation of a function by steps on numbered entries: values, steps, and the origins of the numbers.

Every entry that is computed has a number, and a matrix lists the numbers of its entries.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

Numbers = npt.NDArray[np.int64]

SMALL = 400
"""Most instructions of a step that is written without a loop."""


@dataclass(frozen=True, eq=False)
class Value:
    """A matrix, given by the numbers of its entries.

    Attributes:
        pattern: sparsity of the matrix.
        numbers: numbers of the stored entries; 0 for a zero.
    """

    pattern: ca.Sparsity
    numbers: Numbers

    @property
    def key(self) -> tuple[object, ...]:
        """Key of all equal matrices."""
        return tuple(self.pattern.compress()), self.numbers.tobytes()

    @property
    def transposed(self) -> Value:
        """The transpose."""
        if 1 in self.pattern.shape:
            # The entries stay in their order.
            return Value(self.pattern.T, self.numbers)
        return _of_matrix(self._matrix.T)

    def projected(self, pattern: ca.Sparsity) -> Value:
        """The matrix with another sparsity pattern."""
        if pattern == self.pattern:
            return self
        return _of_matrix(ca.project(self._matrix, pattern))

    @property
    def dense(self) -> Value:
        """The matrix with all entries stored."""
        if self.pattern.is_dense():
            return self
        return self.projected(ca.Sparsity.dense(*self.pattern.shape))

    def part(self, rows: Numbers, columns: Numbers) -> Value:
        """Some rows and columns, as a dense matrix."""
        if not self.pattern.is_dense():
            return _of_matrix(ca.densify(self._matrix[rows.tolist(), columns.tolist()]))
        entries = self.numbers.reshape(self.pattern.shape, order="F")[np.ix_(rows, columns)]
        return Value(ca.Sparsity.dense(*entries.shape), entries.ravel(order="F"))

    @property
    def _matrix(self) -> ca.DM:
        return ca.DM(self.pattern, self.numbers.astype(np.float64))


def _of_matrix(matrix: ca.DM) -> Value:
    numbers = np.array(matrix.nonzeros(), dtype=np.int64)
    return Value(matrix.sparsity(), numbers)


def column(numbers: Numbers) -> Value:
    """Make a column of these entries."""
    return Value(ca.Sparsity.dense(len(numbers)), numbers)


@dataclass(frozen=True, eq=False)
class Step:
    """One computation of a program.

    Attributes:
        function: function of the operands ↦ results.
        operands: arguments of the step.
        results: results of the step, each with consecutive numbers.
        instructions: number of instructions without a loop.
        called: whether the function is called, and not inlined.
        operation: CasADi's number of the entrywise operation; None for any other computation.
    """

    function: ca.Function
    operands: list[Value]
    results: list[Value]
    instructions: float
    called: bool = False
    operation: int | None = None

    def of(self, arguments: Sequence[ca.MX]) -> list[ca.MX]:
        """The results for these arguments."""
        return list(self.function.call(arguments, not self.called, self.called))


class Origins:
    """Meaning of the numbers: entries of things, which are arguments, constants and results of steps, in order.

    Number 0 is a zero, the first thing.
    """

    def __init__(self) -> None:
        # Arrays of things with room for more, which is doubled when it is full.
        self._first = np.zeros(64, dtype=np.int64)
        # The operation whose entry each number is; 0 for all constants.
        self._owners = np.zeros(64, dtype=np.int64)
        self._values: list[list[float] | None] = []
        self.sizes: list[int] = []
        self._count = 0
        self.add(ca.Sparsity.dense(1), [0.0])

    def add(self, pattern: ca.Sparsity, constants: list[float] | None = None) -> Value:
        """Number the entries of a further thing; constants are given with their values."""
        thing = len(self.sizes)
        end = self._count + pattern.nnz()
        if thing == len(self._first):
            self._first = np.concatenate([self._first, np.zeros_like(self._first)])
        if end > len(self._owners):
            self._owners = np.concatenate([self._owners, np.zeros(max(len(self._owners), end), dtype=np.int64)])
        self._first[thing] = self._count
        self._values.append(constants)
        self.sizes.append(pattern.nnz())
        numbers = np.arange(self._count, end)
        self._owners[numbers] = 0 if constants is not None else thing
        self._count = end
        if constants is not None:
            numbers[np.array(constants) == 0.0] = 0
        return Value(pattern, numbers)

    @property
    def count(self) -> int:
        """Count of numbers."""
        return self._count

    def is_constant(self, numbers: Numbers) -> npt.NDArray[np.bool_]:
        """Which numbers are constants."""
        return np.asarray(self._owners[numbers] == 0)

    def numbers(self, thing: int) -> Numbers:
        """Numbers of all entries of a thing."""
        first = int(self._first[thing])
        return np.arange(first, first + self.sizes[thing])

    def owners(self, numbers: Numbers) -> Numbers:
        """Index of the thing to which each number belongs; 0 for all constants."""
        return np.asarray(self._owners[numbers])

    def holders(self, numbers: Numbers) -> list[int]:
        """Indices of the things that contain these entries, without constants."""
        return sorted(set(self.owners(numbers).tolist()) - {0})

    def is_whole(self, numbers: Numbers) -> bool:
        """Whether numbers are all entries of one thing in order, or constants."""
        if len(numbers) == 0:
            return True
        owner = int(self._owners[numbers[0]])
        if owner == 0:
            return not self._owners[numbers].any()
        first = self._first[owner]
        return len(numbers) == self.sizes[owner] and numbers[0] == first and bool(np.all(np.diff(numbers) == 1))

    def constants(self, numbers: Numbers) -> list[float]:
        """Values of constants."""
        values = []
        things = np.searchsorted(self._first[: len(self.sizes)], numbers, side="right") - 1
        for thing, number in zip(things.tolist(), numbers.tolist(), strict=True):
            of_thing = self._values[thing]
            assert of_thing is not None, "asked for of constants alone"
            values.append(of_thing[number - int(self._first[thing])])
        return values


@dataclass(frozen=True, eq=False)
class Argument:
    """An argument of a program.

    Attributes:
        name: name of the argument.
        pattern: sparsity of the argument.
        pieces: consecutive columns with its entries, each numbered as one thing.
    """

    name: str
    pattern: ca.Sparsity
    pieces: list[Value]


@dataclass(frozen=True, eq=False)
class Program:
    """A function as steps.

    Attributes:
        name: name of the program.
        origins: meaning of the numbers.
        arguments: arguments of the program.
        steps: computations in their order.
        results: results by name.
    """

    name: str
    origins: Origins
    arguments: list[Argument]
    steps: list[Step]
    results: dict[str, Value]


def function_of(program: Program) -> ca.Function:
    """Convert a program to a CasADi function, whose instructions arrange entries before each step."""
    columns: dict[int, ca.MX] = {}
    origins = program.origins

    def keep(value: Value, computed: ca.MX) -> None:
        if len(value.numbers):
            (owner,) = set(origins.owners(value.numbers).tolist())
            # CasADi leaves out entries that come out zero: a factor may be a constant zero now.
            entries = ca.project(computed, value.pattern)
            columns[owner] = ca.vec(ca.sparsity_cast(entries, ca.Sparsity.dense(entries.nnz())))

    def matrix(value: Value) -> ca.MX:
        entries = _gathered(origins, columns, value.numbers)
        return ca.sparsity_cast(entries, value.pattern)

    symbols = []
    for argument in program.arguments:
        pieces = [ca.MX.sym(argument.name, piece.pattern) for piece in argument.pieces]
        for piece, symbol in zip(argument.pieces, pieces, strict=True):
            keep(piece, symbol)
        symbols.append(pieces[0] if len(pieces) == 1 else ca.vertcat(*pieces))
    for step in program.steps:
        for result, computed in zip(step.results, step.of([matrix(value) for value in step.operands]), strict=True):
            keep(result, computed)
    results = [matrix(value) for value in program.results.values()]
    names = [argument.name for argument in program.arguments]
    return ca.Function(program.name, symbols, results, names, list(program.results))


def _gathered(origins: Origins, columns: dict[int, ca.MX], numbers: Numbers) -> ca.MX:
    """Gather entries from the columns of things in one column."""
    if len(numbers) == 0:
        return ca.MX(0, 1)
    owners = origins.owners(numbers)
    pool = []
    places = np.empty(len(numbers), dtype=np.int64)
    size = 0
    for owner in np.unique(owners).tolist():
        own = owners == owner
        if owner:
            column_of_owner = columns[owner]
            within = numbers[own] - origins.numbers(owner)[0]
        else:
            column_of_owner = ca.MX(ca.DM(origins.constants(numbers[own])))
            within = np.arange(np.count_nonzero(own))
        pool.append(column_of_owner)
        places[own] = size + within
        size += column_of_owner.numel()
    # CasADi makes a row from an entry that is taken several times.
    entries: ca.MX = ca.vec(ca.vertcat(*pool).nz[places.tolist()])
    return entries
