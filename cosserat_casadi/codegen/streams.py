"""Scalar functions as streams of numbered values with constants apart: functions that compute alike share one."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import pairwise
from math import isfinite

import casadi as ca
import numpy as np

from cosserat_casadi.maths.calls import called_functions
from cosserat_casadi.maths.typing import FloatArray

FACTORS = {ca.OP_NEG: -1.0, ca.OP_TWICE: 2.0}
"""Operations that CasADi writes for a product with a constant; 1/x stands for such a quotient."""

Line = tuple[int, tuple[int, ...], int]
"""Operation, operands, number of results. Operands are numbers of earlier values, CONSTANT for the next constant, or
what is read or written."""

Key = tuple[tuple[Line, ...], tuple[Hashable, ...]]
"""Lines, and the content of each function that is called."""

CONSTANT = -1
"""Operand that is the next constant."""

ROUNDING = 2.0**-48
"""Difference of two constants, over the larger, up to which they are one number that was rounded on its way here."""


def names_of_part(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Names of the arguments of a part, and of its one result."""
    return [*arguments], ["entries"]


def scalars(function: ca.Function) -> tuple[list[ca.SX], list[ca.SX]]:
    """Arguments and results as scalars, without entries that are zero whatever the arguments."""
    symbols = [ca.SX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    return symbols, [ca.sparsify(result) for result in function.call(symbols)]


def stacked(function: ca.Function) -> ca.Function:
    """The entries of all results in one column, as scalars."""
    symbols, results = scalars(function)
    entries = [entry for result in results for entry in result.nonzeros()]
    return ca.Function("stacked", symbols, [ca.vertcat(*entries)], *names_of_part(function.name_in()))


class Stream:
    """The instructions of a scalar function, each value numbered once, with constants apart.

    CasADi's own instructions write to work variables that are used again, and hold constants as instructions. Two legs
    of a robot give the same lines here although their constants differ. For the map x ↦ 3 x₀ + x₄, say,

    ========================  ================================  ==================
    CasADi                    line                              constants
    ========================  ================================  ==================
    a0 = 3
    a1 = input[0][0]          (OP_INPUT, (0, 0), 1): value 0
    a0 = a0 * a1              (OP_MUL, (CONSTANT, 0), 1): 1     [3]
    a1 = input[0][4]          (OP_INPUT, (0, 1), 1): value 2
    a0 = a0 + a1              (OP_ADD, (1, 2), 1): value 3
    output[0][0] = a0         (OP_OUTPUT, (3, 0), 0)
    ========================  ================================  ==================

    x₄ is read as the second of the unknowns that this part reads, x = [0, 4].

    Attributes:
        function: map (x, inputs, factor) ↦ entries.
        reads: for each argument the entries that are read; an argument of one entry is read whole.
        lines: the instructions.
        constants: value of every use of a constant, in order.
        called: the function of every call, in order.
    """

    def __init__(self, function: ca.Function) -> None:
        self.function = function
        self.called = list(called_functions(function).values())
        self.lines: list[Line] = []
        self.constants: list[float] = []
        codes = [function.instruction_id(k) for k in range(function.n_instructions())]
        read = {tuple(function.instruction_input(k)) for k, code in enumerate(codes) if code == ca.OP_INPUT}
        self.reads = [sorted(entry for number, entry in read if number == i) for i in range(function.n_in())]
        for i in range(function.n_in()):
            if function.numel_in(i) == 1:
                self.reads[i] = [0]
        self._local = [{entry: i for i, entry in enumerate(entries)} for entries in self.reads]
        self._value_of: dict[int, int] = {}
        self._constant_of: dict[int, float] = {}
        self._value_count = 0
        for k, code in enumerate(codes):
            self._add(k, code)

    @classmethod
    def settled(cls, function: ca.Function) -> Stream:
        """The instructions without products with a one that is off by rounding.

        CasADi leaves out products with one. A one that a machine rounds otherwise, such as a stiffness over that which
        scales the equations, would make other lines of one leg of a robot than of the next.
        """
        stream = cls(function)
        ones = [c != 1.0 and abs(c - 1.0) <= ROUNDING for c in stream.constants]
        if not any(ones):
            return stream
        constants = [ca.SX(1.0 if one else c) for one, c in zip(ones, stream.constants, strict=True)]
        whole = [ca.SX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
        read = [symbol.nz[own] if own else ca.SX(0, 1) for symbol, own in zip(whole, stream.reads, strict=True)]
        entries = _replay(stream, read, constants)
        return cls(ca.Function(function.name(), whole, [entries], function.name_in(), function.name_out()))

    @property
    def key(self) -> Key:
        """What streams share that compute alike: their lines, and what they call."""
        contents = {hash(callee): Stream(callee).content for callee in self.called}
        return tuple(self.lines), tuple(contents[hash(callee)] for callee in self.called)

    @property
    def content(self) -> Hashable:
        """What functions share that compute the same: the rods of a scene have functions of their own that do."""
        return self.key, tuple(self.constants)

    def _add(self, k: int, code: int) -> None:
        """Append the line of the k-th instruction."""
        inputs = self.function.instruction_input(k)
        outputs = self.function.instruction_output(k)
        if code == ca.OP_CONST:
            self._constant_of[outputs[0]] = self.function.instruction_constant(k)
        elif code == ca.OP_INPUT:
            argument, entry = inputs
            self._write(code, (argument, self._local[argument][entry]), outputs)
        elif code == ca.OP_OUTPUT:
            self.lines.append((code, (self._operand(inputs[0]), outputs[1]), 0))
        elif code in FACTORS:
            self._write(ca.OP_MUL, (self._constant(FACTORS[code]), self._operand(inputs[0])), outputs)
        elif code == ca.OP_INV:
            self._write(ca.OP_DIV, (self._constant(1.0), self._operand(inputs[0])), outputs)
        else:
            self._write(code, tuple(self._operand(variable) for variable in inputs), outputs)

    def _write(self, code: int, operands: tuple[int, ...], outputs: Sequence[int]) -> None:
        self.lines.append((code, operands, len(outputs)))
        for variable in outputs:
            self._constant_of.pop(variable, None)
            self._value_of[variable] = self._value_count
            self._value_count += 1

    def _operand(self, variable: int) -> int:
        if variable in self._constant_of:
            return self._constant(self._constant_of[variable])
        return self._value_of[variable]

    def _constant(self, value: float) -> int:
        self.constants.append(value)
        return CONSTANT


def shared(streams: Sequence[Stream], name: str) -> tuple[ca.Function, list[list[float]]]:
    """One function for streams that compute alike, and the constants of each.

    Constants that are the same in all streams stay in the code; uses that vary alike share one argument. Rounding makes
    no difference: it is another on another machine, which shall write the same code.
    """
    first = streams[0]
    uses = list(zip(*(stream.constants for stream in streams), strict=True))
    number_of = _numbered([value for values in uses for value in values])
    # What the streams have in place of one constant, by the numbers of their values: alike but for rounding.
    alike = [tuple(number_of[value] for value in values) for values in uses]
    varied: dict[tuple[int, ...], tuple[float, ...]] = {}
    for numbers, values in zip(alike, uses, strict=True):
        if len(set(numbers)) > 1:
            varied.setdefault(numbers, values)
    arguments = [*first.function.name_in(), "constants"]
    sizes = [*map(len, first.reads), len(varied)]
    symbols = [ca.SX.sym(argument, size) for argument, size in zip(arguments, sizes, strict=True)]
    symbol_of = dict(zip(varied, _entries(symbols[-1]), strict=True))
    constants = []
    for numbers, values in zip(alike, uses, strict=True):
        constants.append(symbol_of[numbers] if numbers in symbol_of else ca.SX(values[0]))
    kernel = ca.Function(name, symbols, ca.cse([_replay(first, symbols, constants)]), *names_of_part(arguments))
    return kernel, [[values[i] for values in varied.values()] for i in range(len(streams))]


def same_but_for_rounding(one: Sequence[float] | FloatArray, other: Sequence[float] | FloatArray) -> bool:
    """Whether constants are the same, one by one, but for rounding."""
    pairs = zip(np.ravel(one), np.ravel(other), strict=True)
    return all(_same(float(first), float(second)) for first, second in pairs)


def _same(one: float, other: float) -> bool:
    """Whether two constants are the same but for rounding; an infinite one is no other number rounded."""
    if one == other:
        return True
    largest = max(abs(one), abs(other))
    return isfinite(largest) and abs(one - other) <= ROUNDING * largest


def _numbered(values: Sequence[float]) -> dict[float, int]:
    """A number for each value, the same for those that are the same but for rounding."""
    ordered = sorted(set(values))
    numbers = dict.fromkeys(ordered[:1], 0)
    for before, value in pairwise(ordered):
        numbers[value] = numbers[before] if _same(before, value) else numbers[before] + 1
    return numbers


def _replay(stream: Stream, symbols: Sequence[ca.SX], constants: Sequence[ca.SX]) -> ca.SX:
    """The result of a stream in new symbols and constants."""
    next_constant = iter(constants)
    next_called = iter(stream.called)
    arguments = [_entries(symbol) for symbol in symbols]
    values = list[ca.SX]()
    results = [ca.SX(0.0)] * stream.function.nnz_out(0)
    for code, operands, _ in stream.lines:
        if code == ca.OP_INPUT:
            argument, entry = operands
            values.append(arguments[argument][entry])
        elif code == ca.OP_OUTPUT:
            value, entry = operands
            results[entry] = next(next_constant) if value == CONSTANT else values[value]
        else:
            given = [next(next_constant) if value == CONSTANT else values[value] for value in operands]
            if code == ca.OP_CALL:
                values += call_of_entries(next(next_called), given)
            else:
                apply = ca.SX.unary if len(given) == 1 else ca.SX.binary
                values.append(apply(code, *given))
    return ca.vertcat(*results)


def _entries(vector: ca.SX) -> list[ca.SX]:
    return ca.vertsplit(vector) if vector.numel() else []


def call_of_entries(function: ca.Function, arguments: Sequence[ca.SX]) -> list[ca.SX]:
    """Entries of all results of a function that is called with these entries."""
    shaped = list[ca.SX]()
    start = 0
    for i in range(function.n_in()):
        pattern = function.sparsity_in(i)
        end = start + pattern.nnz()
        shaped.append(ca.SX(pattern, ca.vertcat(*arguments[start:end])))
        start = end
    return [entry for result in function.call(shaped, False, True) for entry in result.nonzeros()]
