"""A scalar function as a list of values, each computed once, from which this package writes its code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate, pairwise
from typing import TypeVar

import casadi as ca

from cosserat_casadi.compiling.called import Known, called_functions
from cosserat_casadi.maths.calls import KEPT

_Entry = TypeVar("_Entry")

LANES = 4
"""Number of columns, intervals or states that are computed together."""

FEWEST = 3
"""Calls of one function from which on they are made together, four at a time."""

BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}
"""Operations on four lanes, as operators in C."""

SUMS = {ca.OP_ADD, ca.OP_SUB}
"""Operators that bind less tightly than products."""

FUNCTIONS = {
    ca.OP_SQRT: "sqrt", ca.OP_EXP: "exp", ca.OP_LOG: "log", ca.OP_SIN: "sin", ca.OP_COS: "cos", ca.OP_TAN: "tan",
    ca.OP_ASIN: "asin", ca.OP_ACOS: "acos", ca.OP_ATAN: "atan", ca.OP_ATAN2: "atan2", ca.OP_TANH: "tanh",
    ca.OP_SINH: "sinh", ca.OP_COSH: "cosh", ca.OP_FABS: "fabs", ca.OP_POW: "pow", ca.OP_CONSTPOW: "pow",
    ca.OP_FMIN: "fmin", ca.OP_FMAX: "fmax", ca.OP_FLOOR: "floor", ca.OP_CEIL: "ceil", ca.OP_FMOD: "fmod",
    ca.OP_COPYSIGN: "copysign", ca.OP_ERF: "erf", ca.OP_LOG1P: "log1p", ca.OP_EXPM1: "expm1", ca.OP_HYPOT: "hypot",
    ca.OP_ASINH: "asinh", ca.OP_ACOSH: "acosh", ca.OP_ATANH: "atanh",
}  # fmt: skip
"""Further operations on single numbers, as functions of the mathematical library."""

CHOICES = {
    ca.OP_LT: "{0} < {1}", ca.OP_LE: "{0} <= {1}", ca.OP_EQ: "{0} == {1}", ca.OP_NE: "{0} != {1}",
    ca.OP_NOT: "!{0}", ca.OP_AND: "{0} && {1}", ca.OP_OR: "{0} || {1}", ca.OP_IF_ELSE_ZERO: "{0} ? {1} : 0",
    ca.OP_SIGN: "{0} < 0 ? -1 : {0} > 0 ? 1 : {0}",
}  # fmt: skip
"""Comparisons and choices, which occur in distances from obstacles."""

REWRITTEN = {ca.OP_NEG: (ca.OP_MUL, -1.0), ca.OP_TWICE: (ca.OP_MUL, 2.0), ca.OP_INV: (ca.OP_DIV, 1.0)}
"""Operations with one operand, as products or quotients with a constant."""


@dataclass(frozen=True)
class Constant:
    """A number."""

    value: float


@dataclass(frozen=True)
class Read:
    """An entry of an argument."""

    argument: int
    entry: int


@dataclass(frozen=True)
class Computed:
    """The result of an operation on other values, which are given by their numbers."""

    operation: int
    operands: tuple[int, ...]


@dataclass(frozen=True)
class Called:
    """A result of a call."""

    call: int
    result: int


Value = Constant | Read | Computed | Called


@dataclass(frozen=True)
class Call:
    """A call of another scalar function.

    Attributes:
        function: the called function.
        operands: the stored entries of all its arguments.
        results: the stored entries of all its results.
    """

    function: ca.Function
    operands: list[int]
    results: list[int]

    @property
    def arguments(self) -> list[Sequence[int]]:
        """The operands, argument after argument."""
        return by_argument(self.function, self.operands)


@dataclass(frozen=True)
class ShorterCall:
    """A function without operands that are zero in all calls, and without operands that it does not read.

    Attributes:
        function: the function.
        places: of the operands that it takes.
    """

    function: ca.Function
    places: Sequence[int]


NO_CALLS: Mapping[int, ShorterCall] = {}


class UnknownOperationError(Exception):
    """Error of an operation that this package cannot write in C."""


class Listing:
    """The values of a scalar function in the order in which it computes them.

    Attributes:
        function: the listed function.
        values: the values; an operand comes before the operation that takes it.
        calls: calls of other functions.
        outputs: for each output, numbers of the values of its computed stored entries.

    Args:
        function: the function.
        apart: whether every use of a constant is a separate value, and every operation is listed as in CasADi. The
            lists of functions that differ in constants alone are then equal up to the constants.
    """

    def __init__(self, function: ca.Function, *, apart: bool = False) -> None:
        self.function = function
        self.values: list[Value] = []
        self.calls: list[Call] = []
        self.outputs: list[dict[int, int]] = [{} for _ in range(function.n_out())]
        self._apart = apart
        self._known: dict[Value, int] = {}
        codes = [function.instruction_id(k) for k in range(function.n_instructions())]
        self._called = called_functions(function, codes)
        # CasADi's variables are used again and again. A constant is a value where it is read.
        self._variables: dict[int, int | Constant] = {}
        for k, code in enumerate(codes):
            self._add(k, code)

    def operands(self, number: int) -> Sequence[int]:
        """Numbers of the values from which a value is computed."""
        value = self.values[number]
        if isinstance(value, Computed):
            return value.operands
        if isinstance(value, Called):
            return self.calls[value.call].operands
        return ()

    @property
    def has_fours(self) -> bool:
        """Whether all operations have a form for four numbers at a time."""
        return all(value.operation in BINARY for value in self.values if isinstance(value, Computed))

    def wanted(self) -> Iterator[int]:
        """Numbers of the values that are results, output after output."""
        for output in self.outputs:
            yield from output.values()

    def names_of_callees(self, prefix: str) -> dict[int, str]:
        """Names of all called functions by their hashes: the function's name, with a number if it is taken."""
        functions = {hash(call.function): call.function for call in self.calls}
        names: dict[int, str] = {}
        for function_hash, function in functions.items():
            name = prefix + function.name()
            names[function_hash] = f"{name}_{len(names)}" if name in names.values() else name
        return names

    def expressions(
        self, wanted: Iterable[int], known: Mapping[int, ca.SX], shorter: Mapping[int, ShorterCall] = NO_CALLS
    ) -> dict[int, ca.SX]:
        """Expressions of values, and of the values that they are computed from, by number.

        Args:
            wanted: numbers of the values.
            known: expressions of some values, among them all entries of arguments.
            shorter: functions that are called in place of others, by the hash of these.
        """
        expressions = dict(known)
        needed = {number for number in wanted if number not in known}
        for number in reversed(range(len(self.values))):
            if number in needed:
                needed |= {operand for operand in self.operands(number) if operand not in known}
        for number in sorted(needed):
            value = self.values[number]
            operands = [expressions[operand] for operand in self.operands(number)]
            if isinstance(value, Constant):
                expressions[number] = ca.SX(value.value)
            elif isinstance(value, Computed):
                apply = ca.SX.unary if len(operands) == 1 else ca.SX.binary
                expressions[number] = apply(value.operation, *operands)
            elif isinstance(value, Called) and number not in expressions:
                call = self.calls[value.call]
                short = shorter.get(hash(call.function))
                if short is None:
                    results = _call_of_entries(call.function, operands)
                else:
                    results = _call_of_entries(short.function, [operands[place] for place in short.places])
                expressions |= zip(call.results, results, strict=True)
        return expressions

    def entries(self, output: int, expressions: Mapping[int, ca.SX]) -> list[ca.SX]:
        """Stored entries of an output from the expressions of its values, with zeros for all other entries."""
        entries = [ca.SX(0.0)] * self.function.nnz_out(output)
        for entry, number in self.outputs[output].items():
            entries[entry] = expressions[number]
        return entries

    def known_arguments(self, symbols: Sequence[ca.SX]) -> dict[int, ca.SX]:
        """Symbols of the values that are entries of arguments, by number, from symbols of all arguments."""
        entries = [symbol.nonzeros() for symbol in symbols]
        reads = ((number, value) for number, value in enumerate(self.values) if isinstance(value, Read))
        return {number: entries[value.argument][value.entry] for number, value in reads}

    def results(self, expressions: Mapping[int, ca.SX]) -> list[ca.SX]:
        """The outputs, from expressions of the values that they have."""
        patterns = [self.function.sparsity_out(i) for i in range(len(self.outputs))]
        return [ca.SX(pattern, ca.vertcat(*self.entries(i, expressions))) for i, pattern in enumerate(patterns)]

    def _add(self, k: int, code: int) -> None:
        """Append the value, or the values, of the k-th instruction, with this operation code."""
        inputs = self.function.instruction_input(k)
        outputs = self.function.instruction_output(k)
        if code == ca.OP_OUTPUT:
            self.outputs[outputs[0]][outputs[1]] = self._operand(inputs[0])
        elif code == ca.OP_CONST:
            self._variables[outputs[0]] = Constant(self.function.instruction_constant(k))
        elif code == ca.OP_INPUT:
            self._variables[outputs[0]] = self._number(Read(*inputs))
        elif code == ca.OP_CALL:
            self._call(self._called[k], [self._operand(variable) for variable in inputs], outputs)
        else:
            operands = [self._operand(variable) for variable in inputs]
            self._variables[outputs[0]] = self._number(self._computed(code, operands))

    def _operand(self, variable: int) -> int:
        """Number of the value in a variable."""
        value = self._variables[variable]
        return self._number(value) if isinstance(value, Constant) else value

    def _computed(self, code: int, operands: list[int]) -> Computed:
        if code in REWRITTEN:
            operation, constant = REWRITTEN[code]
            return Computed(operation, (self._number(Constant(constant)), operands[0]))
        if code == ca.OP_SQ:
            return Computed(ca.OP_MUL, (operands[0], operands[0]))
        return Computed(code, tuple(operands))

    def _call(self, function: ca.Function, operands: list[int], outputs: list[int]) -> None:
        results = [self._number(Called(len(self.calls), i)) for i in range(len(outputs))]
        self.calls.append(Call(function, operands, results))
        self._variables.update(zip(outputs, results, strict=True))

    def _number(self, value: Value) -> int:
        """Number of a value; equal values have one number."""
        known = self._known.get(value)
        if known is not None and (not self._apart or isinstance(value, Read)):
            return known
        number = self._known[value] = len(self.values)
        self.values.append(value)
        return number


def length(function: ca.Function) -> int:
    """Instructions of a function of scalars, with the instructions of functions that are called once or twice."""
    count: int = function.n_instructions()
    called = called_functions(function).values()
    calls = Counter(map(hash, called))
    further: int = sum(one.n_instructions() for one in called if calls[hash(one)] < FEWEST)
    return count + further


def with_shorter_calls(function: ca.Function) -> ca.Function:
    """A function of scalars that hands over no operand that is zero in all calls of one function, or that is not read.

    Derivatives of a kernel are called for variations of few of its arguments, and a strain may have no such Taylor
    coefficients: without the zeros the called functions are shorter.
    """
    if not function.find_functions(0):
        return function
    listing = Listing(function)
    operands_of: dict[Known, list[list[int]]] = {}
    for call in listing.calls:
        operands_of.setdefault(Known(hash(call.function), call.function), []).append(call.operands)
    zero = {number for number, value in enumerate(listing.values) if value == Constant(0.0)}
    shorter = {}
    for known, operands in operands_of.items():
        short = _without(known, tuple(k for k, numbers in enumerate(zip(*operands, strict=True)) if zero >= {*numbers}))
        if len(short.places) < len(operands[0]):
            shorter[known.key] = short
    if not shorter:
        return function
    symbols = function.sx_in()
    expressions = listing.expressions(listing.wanted(), listing.known_arguments(symbols), shorter)
    return ca.Function(function.name(), symbols, listing.results(expressions), function.name_in(), function.name_out())


@cache
def _without(known: Known, places: tuple[int, ...]) -> ShorterCall:
    """A function without operands that are zero: one function, so that the functions that call it share its calls."""
    function = known.function
    entries = [entry for symbol in function.sx_in() for entry in symbol.nonzeros()]
    left = [ca.SX(0.0) if place in places else entry for place, entry in enumerate(entries)]
    # The function is kept as a call where it is called.
    inside = Listing(function)
    results = inside.results(inside.expressions(inside.wanted(), inside.known_arguments(_shaped(function, left))))
    read = {entry.element_hash() for entry in ca.symvar(ca.veccat(*results))}
    places_of_read = [place for place, entry in enumerate(entries) if entry.element_hash() in read]
    vectors = [[entry for entry in own if entry.element_hash() in read] for own in by_argument(function, entries)]
    arguments = [ca.vertcat(*own) for own in vectors if own]
    return ShorterCall(ca.Function(function.name(), arguments, ca.cse(results), KEPT), places_of_read)


def by_argument(function: ca.Function, entries: Sequence[_Entry]) -> list[Sequence[_Entry]]:
    """All entries of the arguments of a function, argument after argument."""
    sizes = (function.nnz_in(i) for i in range(function.n_in()))
    return [entries[first:end] for first, end in pairwise(accumulate(sizes, initial=0))]


def _shaped(function: ca.Function, entries: Sequence[ca.SX]) -> list[ca.SX]:
    """Arguments of a function from all their entries."""
    own = by_argument(function, entries)
    return [ca.SX(function.sparsity_in(i), ca.vertcat(*one)) for i, one in enumerate(own)]


def _call_of_entries(function: ca.Function, entries: Sequence[ca.SX]) -> list[ca.SX]:
    """Entries of all results of a function that is called with these entries."""
    return [entry for result in function.call(_shaped(function, entries), False, True) for entry in result.nonzeros()]
