"""Scalar functions as lists of values with separate constants, so that functions that compute alike share code."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from itertools import pairwise
from math import isfinite

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.listing import Constant, Listing, Read, Value
from cosserat_casadi.maths.typing import FloatArray

Key = tuple[Hashable, ...]
"""Key of all streams that compute alike."""

ROUNDING = 2.0**-48
"""Difference of two constants, over the larger one, up to which they count as one number with rounding errors."""


def names_of_part(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Names of the arguments of a part, and of its one result."""
    return [*arguments], ["entries"]


def scalars(function: ca.Function) -> tuple[list[ca.SX], list[ca.SX]]:
    """Arguments and results as scalars, without structural zeros."""
    symbols = function.sx_in()
    return symbols, [ca.sparsify(result) for result in function.call(symbols)]


def stacked(function: ca.Function) -> ca.Function:
    """Stack the entries of all results in one column, in scalars."""
    symbols, results = scalars(function)
    entries = [entry for result in results for entry in result.nonzeros()]
    return ca.Function("stacked", symbols, [ca.vertcat(*entries)], *names_of_part(function.name_in()))


class Stream:
    """The values of a scalar function with separate constants: two legs of a robot differ in constants alone.

    An unknown has its number among the unknowns that the function reads: 3 x₀ + x₄ reads x = [0, 4], and differs from
    5 x₁ + x₂ only in its reads and its constant.

    Attributes:
        function: map (x, inputs, factor) ↦ entries.
        listing: values of the function.
        reads: entries that are read of each argument; an argument with one entry is always read.
        constants: value of every use of a constant, in order.
    """

    def __init__(self, function: ca.Function) -> None:
        self.function = function
        self.listing = Listing(function, apart=True)
        self.constants = [value.value for value in self.listing.values if isinstance(value, Constant)]
        read = [value for value in self.listing.values if isinstance(value, Read)]
        self.reads: list[list[int]] = []
        for i in range(function.n_in()):
            entries = sorted(value.entry for value in read if value.argument == i)
            self.reads.append([0] if function.numel_in(i) == 1 else entries)

    @property
    def scales(self) -> list[float]:
        """Size that each use of a constant is rounded beside: the largest number in its argument of a call."""
        scale_of: dict[int, float] = {}
        for call in self.listing.calls:
            for argument in call.arguments:
                values = {number: self.listing.values[number] for number in argument}
                constants = {number: abs(one.value) for number, one in values.items() if isinstance(one, Constant)}
                scale_of |= dict.fromkeys(constants, max(constants.values(), default=0.0))
        numbers = [number for number, value in enumerate(self.listing.values) if isinstance(value, Constant)]
        return [scale_of.get(number, 0.0) for number in numbers]

    @classmethod
    def settled(cls, function: ca.Function) -> Stream:
        """Make a stream without products with a one that has rounding errors.

        CasADi leaves out products with one. A one with rounding errors, such as a stiffness over the unit of the
        equations, would give one leg of a robot other values than the next.
        """
        stream = cls(function)
        ones = [c != 1.0 and abs(c - 1.0) <= ROUNDING for c in stream.constants]
        if not any(ones):
            return stream
        constants = [ca.SX(1.0 if one else c) for one, c in zip(ones, stream.constants, strict=True)]
        whole = function.sx_in()
        read = [symbol.nz[own] if own else ca.SX(0, 1) for symbol, own in zip(whole, stream.reads, strict=True)]
        entries = stream.result(read, constants)
        return cls(ca.Function(function.name(), whole, [entries], function.name_in(), function.name_out()))

    @property
    def key(self) -> Key:
        """Key of all streams that compute alike: their values up to constants, and the functions that they call."""
        values = tuple(self._without_constant(value) for value in self.listing.values)
        functions = {hash(call.function): call.function for call in self.listing.calls}
        contents = {number: Stream(function).content for number, function in functions.items()}
        calls = tuple((contents[hash(call.function)], *call.operands) for call in self.listing.calls)
        return values, calls, tuple(tuple(output.items()) for output in self.listing.outputs)

    @property
    def content(self) -> Hashable:
        """Key of all functions with an equal result, such as functions of equal rods of a scene."""
        return self.key, tuple(self.constants)

    def result(self, symbols: Sequence[ca.SX], constants: Sequence[ca.SX]) -> ca.SX:
        """Write the result in given symbols for the entries that it reads of each argument, and for the constants."""
        arguments = [_entries(symbol) for symbol in symbols]
        next_constant = iter(constants)
        known: dict[int, ca.SX] = {}
        for number, value in enumerate(self.listing.values):
            if isinstance(value, Constant):
                known[number] = next(next_constant)
            elif isinstance(value, Read):
                known[number] = arguments[value.argument][self.reads[value.argument].index(value.entry)]
        expressions = self.listing.expressions(self.listing.outputs[0].values(), known)
        return ca.vertcat(*self.listing.entries(0, expressions))

    def _without_constant(self, value: Value) -> Value | None:
        """Return a value without its constant, as in all streams that compute alike."""
        if isinstance(value, Constant):
            return None
        if isinstance(value, Read):
            return Read(value.argument, self.reads[value.argument].index(value.entry))
        return value


def alike(keys: Iterable[Hashable]) -> list[list[int]]:
    """Group the indices of equal keys."""
    groups: dict[Hashable, list[int]] = {}
    for i, key in enumerate(keys):
        groups.setdefault(key, []).append(i)
    return list(groups.values())


def shared(streams: Sequence[Stream], name: str) -> tuple[ca.Function, list[list[float]]]:
    """Make one function for streams that compute alike, and list the constants of each stream.

    Constants that are equal in all streams stay in the code; uses that vary alike share one argument. Constants are
    compared up to rounding, which varies between machines, so that all machines write the same code.
    """
    first = streams[0]
    uses = list(zip(*(stream.constants for stream in streams), strict=True))
    number_of = _numbered([value for values in uses for value in values])
    # What the streams have in place of one constant, by the numbers of their values: alike but for rounding.
    numbered = [tuple(number_of[value] for value in values) for values in uses]
    varied: dict[tuple[int, ...], tuple[float, ...]] = {}
    varies = []
    scales = map(min, zip(*(stream.scales for stream in streams), strict=True))
    for numbers, values, scale in zip(numbered, uses, scales, strict=True):
        varies.append(len(set(numbers)) > 1 and max(values) - min(values) > ROUNDING * scale)
        if varies[-1]:
            varied.setdefault(numbers, values)
    arguments = [*first.function.name_in(), "constants"]
    sizes = [*map(len, first.reads), len(varied)]
    symbols = [ca.SX.sym(argument, size) for argument, size in zip(arguments, sizes, strict=True)]
    symbol_of = dict(zip(varied, _entries(symbols[-1]), strict=True))
    constants = []
    for numbers, values, own in zip(numbered, uses, varies, strict=True):
        constants.append(symbol_of[numbers] if own else ca.SX(values[0]))
    kernel = ca.Function(name, symbols, ca.cse([first.result(symbols, constants)]), *names_of_part(arguments))
    return kernel, [[values[i] for values in varied.values()] for i in range(len(streams))]


def same_but_for_rounding(one: Sequence[float] | FloatArray, other: Sequence[float] | FloatArray) -> bool:
    """Whether constants are equal, one by one, up to rounding."""
    pairs = zip(np.ravel(one), np.ravel(other), strict=True)
    return all(_same(float(first), float(second)) for first, second in pairs)


def _same(one: float, other: float) -> bool:
    """Whether two constants are equal up to rounding; infinity equals no other number."""
    if one == other:
        return True
    largest = max(abs(one), abs(other))
    return isfinite(largest) and abs(one - other) <= ROUNDING * largest


def _numbered(values: Sequence[float]) -> dict[float, int]:
    """Number the values; values that are equal up to rounding have one number."""
    ordered = sorted(set(values))
    numbers = dict.fromkeys(ordered[:1], 0)
    for before, value in pairwise(ordered):
        numbers[value] = numbers[before] if _same(before, value) else numbers[before] + 1
    return numbers


def _entries(vector: ca.SX) -> list[ca.SX]:
    return ca.vertsplit(vector) if vector.numel() else []
