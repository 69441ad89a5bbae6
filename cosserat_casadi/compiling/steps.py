"""Conversion of an MX function to steps on numbered entries: the numbers that each computation reads and makes.

* Instructions that only move entries are no steps. The computed number of each entry of every matrix is known, and the
  numbers are arranged when a step reads them.
* A constant matrix that consists of separate blocks, as for the turns of a rod about each axis, is multiplied
  block by block if that is faster.
* In a product of two constant matrices and a computed one, the constants are multiplied beforehand if that leaves fewer
  products; for matrices that fold and unfold symmetric ones only without loops.
* A product Z = X Y with a dense Y is written as Zᵀ = Yᵀ Xᵀ. The columns that are summed are then dense, and the
  routine of products.py runs along them without tables.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.numbered import SMALL, Argument, Numbers, Origins, Program, Step, Value, column
from cosserat_casadi.maths.calls import is_routine

DENSE_RATE = 8.0
"""Products per nanosecond that are added to long dense columns."""

LONG = 6
"""Least number of entries of a long column, whose sums are independent enough to overlap."""

SHORT_RATE = 4.5
"""Products per nanosecond that are added to shorter dense columns."""

SPARSE_RATE = 1.0
"""Products per nanosecond that are added with a table of every entry."""

MOVE_RATE = 1.5
"""Entries per nanosecond that are moved."""

CALL_TIME = 20.0
"""Time of a product in addition to its sums, ns: of the call, and of the branch by processor."""

WORTH_SPLITTING = 0.2
"""Least share of zeros for which a sum is formed of the nonzero entries alone."""

SUMS = {ca.OP_ADD, ca.OP_SUB}
SAME_ENTRIES = {ca.OP_RESHAPE, ca.OP_SPARSITY_CAST}
SIDE_BY_SIDE = {ca.OP_HORZCAT, ca.OP_VERTCAT, ca.OP_DIAGCAT}
ADDING = {ca.OP_SETNONZEROS, ca.OP_ADDNONZEROS}
REDUCTIONS: dict[int, Callable[..., ca.MX]] = {ca.OP_DOT: ca.dot, ca.OP_MMIN: ca.mmin, ca.OP_MMAX: ca.mmax}
SPLITS = {ca.OP_HORZSPLIT, ca.OP_VERTSPLIT, ca.OP_DIAGSPLIT}


class UnknownInstructionError(Exception):
    """Error of an instruction that cannot be given other operands."""


def program_of(function: ca.Function) -> Program:
    """Convert a function to steps.

    Raises:
        UnknownInstructionError: CasADi has no way to give an instruction, which reads one of several results, other
            operands.
    """
    return _Reading(function).program


def results_of(
    function: ca.Function,
    arguments: Sequence[Value],
    constant: Callable[[ca.DM], Value],
    computed: Callable[[int, ca.MX, Sequence[Value]], list[Value]],
) -> list[Value]:
    """Read the instructions of a function of matrices, and return its results.

    Args:
        function: the function.
        arguments: a matrix for each of its arguments.
        constant: reader of a constant matrix.
        computed: reader of an instruction that does more than move entries, from its code, node and operands.
    """
    outputs = [np.zeros(function.nnz_out(i), dtype=np.int64) for i in range(function.n_out())]
    values = dict[int, Value]()
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        node = function.instruction_MX(k)
        read = function.instruction_input(k)
        if code == ca.OP_OUTPUT:
            info = node.info()
            numbers = values[read[0]].numbers
            outputs[info["ind"]][info["offset"] : info["offset"] + len(numbers)] = numbers
            continue
        if code == ca.OP_INPUT:
            info = node.info()
            numbers = arguments[info["ind"]].numbers
            results = [Value(node.sparsity(), numbers[info["offset"] : info["offset"] + node.nnz()])]
        elif code == ca.OP_CONST:
            results = [constant(node.to_DM())]
        else:
            operands = [values[variable] for variable in read]
            results = _moved(code, node, operands) or computed(code, node, operands)
        values.update(zip(function.instruction_output(k), results, strict=True))
    return [Value(function.sparsity_out(i), numbers) for i, numbers in enumerate(outputs)]


class _Reading:
    """Reader of a function, which makes a program of it."""

    def __init__(self, function: ca.Function) -> None:
        self.function = function
        self.origins = Origins()
        self.steps: list[Step] = []
        self._results_of: dict[tuple[object, ...], list[Value]] = {}
        self._constants: dict[bytes, Value] = {}
        self._ordered = set[bytes]()
        self._factors_of: dict[tuple[tuple[int, int], bytes], tuple[Value, Value]] = {}
        self.inputs = [self.origins.add(function.sparsity_in(i)) for i in range(function.n_in())]
        self.outputs = self._read(function, self.inputs)

    @property
    def program(self) -> Program:
        """Return the program."""
        function = self.function
        arguments = []
        for i, value in enumerate(self.inputs):
            arguments.append(Argument(function.name_in(i), value.pattern, [value]))
        results = dict(zip(function.name_out(), self.outputs, strict=True))
        return Program(function.name(), self.origins, arguments, self._needed_steps(), results)

    def _needed_steps(self) -> list[Step]:
        """Select the steps on which results depend: a called function may have results that are not read."""
        needed = self._things(self.outputs)
        steps = []
        for step in reversed(self.steps):
            if needed & self._things(step.results):
                needed |= self._things(step.operands)
                steps.append(step)
        return steps[::-1]

    def _things(self, values: Sequence[Value]) -> set[int]:
        """Indices of the things that contain the entries of these values."""
        numbers = np.concatenate([np.zeros(0, dtype=np.int64), *[value.numbers for value in values]])
        return set(self.origins.holders(numbers))

    def _read(self, function: ca.Function, arguments: Sequence[Value]) -> list[Value]:
        """Read the instructions of a function of matrices with these arguments; return its results."""
        return results_of(function, arguments, self._constant, self._computed)

    def _computed(self, code: int, node: ca.MX, operands: Sequence[Value]) -> list[Value]:
        """Make the step of an instruction that computes; return its results."""
        if code == ca.OP_MTIMES:
            return [self._product(*operands)]
        if code == ca.OP_CALL:
            function = node.which_function()
            if is_routine(function):
                return self._called(function, operands)
            if function.is_a("MXFunction"):
                return self._read(function, operands)
            if function.class_name() == "Map":
                return self._mapped(function, operands)
            if not function.is_a("SXFunction"):
                raise UnknownInstructionError
            return self._called(function, operands)
        if node.is_unary() or node.is_binary():
            return [self._elementwise(code, node, operands)]
        if code in ADDING:
            return [self._added(node, *operands)]
        scalar = instruction_in_scalars(code, node, operands)
        return self._step(scalar, operands, _length(scalar), called=True)

    def _mapped(self, function: ca.Function, operands: Sequence[Value]) -> list[Value]:
        """Make the steps of a function that is mapped over groups of columns; return its results."""
        facts = function.info()
        one = facts["f"]
        calls = []
        for k in range(facts["n"]):
            given = []
            for i, operand in enumerate(operands):
                size = one.nnz_in(i)
                given.append(Value(one.sparsity_in(i), operand.numbers[k * size : (k + 1) * size]))
            calls.append(self._called(one, given))
        results = []
        for i in range(one.n_out()):
            numbers = np.concatenate([call[i].numbers for call in calls])
            results.append(Value(function.sparsity_out(i), numbers))
        return results

    def _called(self, function: ca.Function, operands: Sequence[Value]) -> list[Value]:
        """Make the step of a function that is not inlined; return its results."""
        length = _length(function) if function.is_a("SXFunction") else np.inf
        return self._step(function, operands, length, called=True)

    def _step(
        self,
        function: ca.Function,
        operands: Sequence[Value],
        instructions: float,
        *,
        called: bool = False,
        operation: int | None = None,
    ) -> list[Value]:
        """Make a step, once for equal operands; return its results."""
        what: object = hash(function)
        if not called:
            # A product of matrices has no operation; it may be asked for with more zeros, or fewer, than it has.
            what = (operation, *function.sparsity_out(0).compress())
        key = (what, *(operand.key for operand in operands))
        if key not in self._results_of:
            results = [self.origins.add(function.sparsity_out(i)) for i in range(function.n_out())]
            self.steps.append(Step(function, list(operands), results, instructions, called, operation))
            self._ordered |= {operand.numbers.tobytes() for operand in operands}
            self._results_of[key] = results
        return self._results_of[key]

    def _constant(self, matrix: ca.DM) -> Value:
        """Number the entries of a constant matrix; matrices with equal stored entries share their numbers."""
        entries = matrix.nonzeros()
        key = np.array(entries).tobytes()
        if key not in self._constants:
            self._constants[key] = self.origins.add(matrix.sparsity(), entries)
        return Value(matrix.sparsity(), self._constants[key].numbers)

    # Entry by entry

    def _elementwise(self, code: int, node: ca.MX, operands: Sequence[Value]) -> Value:
        """Make an entrywise operation, in the order of its operands in memory."""
        count = node.nnz()
        if code in SUMS and all(len(operand.numbers) == count for operand in operands):
            return Value(node.sparsity(), self._sum(code, operands[0].numbers, operands[1].numbers))
        vectors = [operand.numbers for operand in operands if operand.pattern.numel() > 1]
        order = self._order(count, vectors)
        arguments = []
        for operand in operands:
            scalar = operand.pattern.numel() == 1
            arguments.append(operand.dense if scalar else column(operand.numbers[order]))
        numbers = np.empty(count, dtype=np.int64)
        numbers[order] = self._operation(code, arguments)
        return Value(node.sparsity(), numbers)

    def _sum(self, code: int, left: Numbers, right: Numbers) -> Numbers:
        """Make sums or differences of entries; a sum with zero is the other entry."""
        alone = right == 0
        numbers = np.where(alone, left, 0)
        if code == ca.OP_ADD:
            alone = alone | (left == 0)
            numbers = np.where(left == 0, right, numbers)
        if np.count_nonzero(alone) < WORTH_SPLITTING * len(alone):
            alone[:] = False
        both = np.flatnonzero(~alone)
        order = both[self._order(len(both), [left[both], right[both]])]
        if len(order):
            numbers[order] = self._operation(code, [column(left[order]), column(right[order])])
        return numbers

    def _operation(self, code: int, operands: Sequence[Value]) -> Numbers:
        """Make an operation on columns and scalars; return the numbers of its results."""
        function = entrywise(code, [operand.pattern for operand in operands])
        return self._step(function, operands, function.nnz_out(0), operation=code)[0].numbers

    def _order(self, count: int, vectors: Sequence[Numbers]) -> Numbers:
        """Choose an order of entries in which the fewest have to be moved."""
        as_they_lie = np.arange(count)
        least = sum(self._cost(numbers) for numbers in vectors)
        best = as_they_lie
        for numbers in vectors:
            if least == 0:
                break
            order = np.argsort(numbers, kind="stable")
            cost = sum(self._cost(vector[order]) for vector in vectors)
            if cost < least:
                least, best = cost, order
        return best

    def _cost(self, numbers: Numbers) -> float:
        """Number of entries that have to be moved for this order."""
        if self.origins.is_whole(numbers) or numbers.tobytes() in self._ordered:
            return 0
        # The order that keeps more neighbours wins: the next step may get it for nothing.
        breaks = np.count_nonzero(np.diff(numbers) != 1)
        return len(numbers) + breaks / len(numbers)

    def _added(self, node: ca.MX, whole: Value, part: Value) -> Value:
        """Add entries of a part to some entries of the whole; several may be added to one."""
        numbers = whole.numbers.copy()
        places = _taken(node)
        left = np.arange(len(places))
        while len(left):
            _, first = np.unique(places[left], return_index=True)
            now = left[first]
            numbers[places[now]] = self._sum(ca.OP_ADD, numbers[places[now]], part.numbers[now])
            left = np.delete(left, first)
        return Value(node.sparsity(), numbers)

    # Products

    def _product(self, added: Value, left: Value, right: Value) -> Value:
        """Make the sum added + left right."""
        left, right = self._with_constants_multiplied(left, right)
        by_blocks = None if added.numbers.any() else self._product_by_blocks(left, right)
        if by_blocks is None:
            result = self._product_of(added, left, right)
        else:
            result = by_blocks.projected(added.pattern)
        if not added.numbers.any():
            self._factors_of[result.pattern.shape, result.numbers.tobytes()] = left, right
        return result

    def _product_of(self, added: Value, left: Value, right: Value) -> Value:
        """Make the sum added + left right in the fastest way."""
        turned_left, turned_right = left.transposed, right.transposed
        looked_up = self._sparse_time(left, right)
        along_rows = self._time(turned_right, turned_left, looked_up)
        along_columns = self._time(left, right, looked_up)
        if min(along_rows, along_columns) > looked_up:
            return self._multiplied(added, left, right)
        if along_rows < along_columns:
            turned = self._multiplied(added.transposed.dense, turned_right.dense, turned_left)
            return turned.transposed.projected(added.pattern)
        return self._multiplied(added.dense, left.dense, right).projected(added.pattern)

    def _product_by_blocks(self, left: Value, right: Value) -> Value | None:
        """Make the product by the blocks of a constant left matrix; None if that is not faster."""
        if not self._is_constant(left) or not right.pattern.is_dense():
            return None
        blocks = _blocks(left)
        every = np.arange(right.pattern.size2())
        factors = [(left.part(rows, columns), right.part(columns, every)) for rows, columns in blocks]
        time_by_blocks = sum(self._least_time(*pair) + CALL_TIME for pair in factors)
        if len(blocks) < 2 or time_by_blocks > self._least_time(left, right) + CALL_TIME:
            return None
        numbers = np.zeros((left.pattern.size1(), len(every)), dtype=np.int64)
        for (rows, _), pair in zip(blocks, factors, strict=True):
            of_block = ca.Sparsity.dense(len(rows), len(every))
            zeros = Value(of_block, np.zeros(of_block.nnz(), dtype=np.int64))
            numbers[rows] = self._product_of(zeros, *pair).numbers.reshape(of_block.shape, order="F")
        return Value(ca.Sparsity.dense(*numbers.shape), numbers.ravel(order="F"))

    def _with_constants_multiplied(self, left: Value, right: Value) -> tuple[Value, Value]:
        """Return the factors of a product after a constant factor of one may be multiplied into the constant other."""
        if self._is_constant(left):
            inner = self._factors(right)
            if inner is not None and self._is_constant(inner[0]):
                return self._taken_in(left, inner[0], right, inner[1])
        elif self._is_constant(right):
            turned_right, turned_left = self._with_constants_multiplied(right.transposed, left.transposed)
            return turned_left.transposed, turned_right.transposed
        return left, right

    def _taken_in(self, outer: Value, inner: Value, right: Value, factor: Value) -> tuple[Value, Value]:
        """Factors of outer (inner factor): outer and right, or the product of the constants and the factor."""
        product = self._matrix(outer) @ self._matrix(inner)
        before = _multiplications(outer.dense, right) + _multiplications(inner.dense, factor)
        if product.nnz() * factor.pattern.size2() > before:
            return outer, right
        return self._constant(product), factor

    def _factors(self, value: Value) -> tuple[Value, Value] | None:
        """Factors of a matrix that is a product, or the transpose of one; None for any other matrix."""
        turned = value.transposed
        if (value.pattern.shape, value.numbers.tobytes()) in self._factors_of:
            return self._factors_of[value.pattern.shape, value.numbers.tobytes()]
        if (turned.pattern.shape, turned.numbers.tobytes()) in self._factors_of:
            left, right = self._factors_of[turned.pattern.shape, turned.numbers.tobytes()]
            return right.transposed, left.transposed
        return None

    def _is_constant(self, value: Value) -> bool:
        return bool(np.all(self.origins.is_constant(value.numbers)))

    def _matrix(self, value: Value) -> ca.DM:
        """Return the values of a constant matrix."""
        return ca.DM(value.pattern, self.origins.constants(value.numbers))

    def _multiplied(self, added: Value, left: Value, right: Value) -> Value:
        operands = [left, right]
        symbols = [ca.MX.sym("factor", operand.pattern) for operand in operands]
        if added.numbers.any():
            operands.append(added)
            symbols.append(ca.MX.sym("added", added.pattern))
            result = ca.mac(*symbols)
        else:
            result = ca.mac(*symbols, ca.MX(ca.DM(added.pattern, 0.0)))
        function = ca.Function("product", symbols, [result])
        return self._step(function, operands, 2 * _multiplications(left, right))[0]

    def _least_time(self, left: Value, right: Value) -> float:
        """Estimate the time of a product in the fastest way, ns."""
        looked_up = self._sparse_time(left, right)
        along_rows = self._time(right.transposed, left.transposed, looked_up)
        return min(along_rows, self._time(left, right, looked_up), looked_up)

    def _time(self, left: Value, right: Value, bound: float) -> float:
        """Estimate the time of a product with a dense left factor, ns; above a bound, any value above the bound."""
        rows = left.pattern.shape[0]
        rate = DENSE_RATE if rows >= LONG else SHORT_RATE
        if rows < 2:
            rate = SPARSE_RATE
        computed = rows * len(right.numbers) / rate
        # A large diagonal matrix has far fewer entries than its dense form.
        return computed if computed > bound else computed + self._move_time(left.dense, right)

    def _sparse_time(self, left: Value, right: Value) -> float:
        """Estimate the time of a product with a table of every entry, ns."""
        return _multiplications(left, right) / SPARSE_RATE + self._move_time(left, right)

    def _move_time(self, *values: Value) -> float:
        return sum(self._cost(value.numbers) for value in values) / MOVE_RATE


def entrywise(code: int, patterns: Sequence[ca.Sparsity]) -> ca.Function:
    """Make the function of an entrywise operation on dense columns and scalars."""
    return _entrywise(code, tuple(pattern.numel() for pattern in patterns))


@cache
def _entrywise(code: int, sizes: tuple[int, ...]) -> ca.Function:
    symbols = [ca.MX.sym("operand", size) for size in sizes]
    result = ca.MX.unary(code, *symbols) if len(symbols) == 1 else ca.MX.binary(code, *symbols)
    return ca.Function("operation", symbols, [result])


def _moved(code: int, node: ca.MX, operands: Sequence[Value]) -> list[Value]:
    """Return the results of an instruction that only moves entries; empty for one that computes."""
    first = operands[0]
    numbers = first.numbers
    if code in SPLITS:
        ends = node.info()["offset"]
        patterns = [node.get_output(i).sparsity() for i in range(len(ends) - 1)]
        return [Value(pattern, numbers[ends[i] : ends[i + 1]]) for i, pattern in enumerate(patterns)]
    if code == ca.OP_TRANSPOSE:
        return [first.transposed]
    if code == ca.OP_PROJECT:
        return [first.projected(node.sparsity())]
    if code in SIDE_BY_SIDE:
        numbers = np.concatenate([operand.numbers for operand in operands])
    elif code == ca.OP_HORZREPMAT:
        numbers = np.tile(numbers, node.size2() // first.pattern.size2())
    elif code == ca.OP_GETNONZEROS:
        numbers = numbers[_taken(node)]
    elif code == ca.OP_SETNONZEROS and not node.info()["add"]:
        numbers = numbers.copy()
        numbers[_taken(node)] = operands[1].numbers
    elif code not in SAME_ENTRIES:
        return []
    return [Value(node.sparsity(), numbers)]


def instruction_in_scalars(code: int, node: ca.MX, operands: Sequence[Value]) -> ca.Function:
    """Make an instruction a function of scalars.

    Raises:
        UnknownInstructionError: CasADi has no way to do that.
    """
    symbols = [ca.MX.sym("operand", operand.pattern) for operand in operands]
    as_it_is = ca.Function("instruction", symbols, [_with_operands(code, node, symbols)])
    try:
        return as_it_is.expand()
    except RuntimeError as error:
        raise UnknownInstructionError from error


def _with_operands(code: int, node: ca.MX, operands: Sequence[ca.MX]) -> ca.MX:
    """Apply an instruction to other operands.

    Raises:
        UnknownInstructionError: CasADi has no way to replace its operands.
    """
    if code in REDUCTIONS:
        return REDUCTIONS[code](*operands)
    if code == ca.OP_HORZREPSUM:
        return ca.repsum(operands[0], 1, operands[0].shape[1] // node.shape[1])
    before = [node.dep(i) for i in range(node.n_dep())]
    if any(operand.is_output() for operand in before):
        raise UnknownInstructionError
    result: ca.MX
    (result,) = ca.graph_substitute([node], before, operands)
    return result


def _taken(node: ca.MX) -> Numbers:
    """Indices of the entries that an instruction reads from a matrix, or writes to it."""
    return np.array(node.mapping().nonzeros(), dtype=np.int64)


def _multiplications(left: Value, right: Value) -> int:
    in_columns = np.diff(left.pattern.colind())
    return int(in_columns[right.pattern.row()].sum())


def _blocks(matrix: Value) -> list[tuple[Numbers, Numbers]]:
    """Rows and columns of each separate block of a matrix, without rows and columns of zeros."""
    rows, columns = matrix.pattern.shape
    entries = ca.sparsify(ca.DM(matrix.pattern, (matrix.numbers != 0).astype(np.float64)))
    joined = ca.blockcat([[ca.DM.eye(rows), entries], [entries.T, ca.DM.eye(columns)]])
    _, order, ends = joined.sparsity().scc()
    groups = [np.array(sorted(order[begin:end])) for begin, end in pairwise(ends)]
    blocks = [(group[group < rows], group[group >= rows] - rows) for group in groups]
    return sorted((block for block in blocks if len(block[0]) and len(block[1])), key=lambda block: int(block[0][0]))


def _length(function: ca.Function) -> float:
    """Number of instructions of a function without loops; infinite if it is long, or has no such form."""
    if function.nnz_in() + function.nnz_out() > SMALL:
        return np.inf
    try:
        return float(function.expand().n_instructions())
    except RuntimeError:
        return np.inf
