"""A scalar function as a list of values, each computed once, from which this package writes its code."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.calls import called_functions

LANES = 4
"""Number of columns, intervals or states that are computed together."""

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

    def expressions(self, wanted: Iterable[int], known: Mapping[int, ca.SX]) -> dict[int, ca.SX]:
        """Expressions of values, and of the values on which they depend, by number.

        Args:
            wanted: numbers of the values.
            known: expressions of some values, including all entries of arguments.
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
                expressions |= zip(call.results, _call_of_entries(call.function, operands), strict=True)
        return expressions

    def entries(self, output: int, expressions: Mapping[int, ca.SX]) -> list[ca.SX]:
        """Stored entries of an output from the expressions of its values, with zeros for all other entries."""
        entries = [ca.SX(0.0)] * self.function.nnz_out(output)
        for entry, number in self.outputs[output].items():
            entries[entry] = expressions[number]
        return entries

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


def _call_of_entries(function: ca.Function, arguments: Sequence[ca.SX]) -> list[ca.SX]:
    """Entries of all results of a function for these entries of its arguments."""
    shaped = list[ca.SX]()
    start = 0
    for i in range(function.n_in()):
        pattern = function.sparsity_in(i)
        end = start + pattern.nnz()
        shaped.append(ca.SX(pattern, ca.vertcat(*arguments[start:end])))
        start = end
    return [entry for result in function.call(shaped, False, True) for entry in result.nonzeros()]
