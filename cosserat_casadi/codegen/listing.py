"""A scalar function as a list of values, each computed once: what code of our own is written from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.calls import called_functions

BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}
"""Operations that four lanes have, as C writes them."""

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
"""Operations that single numbers have besides, as functions of the mathematical library."""

CHOICES = {
    ca.OP_LT: "{0} < {1}", ca.OP_LE: "{0} <= {1}", ca.OP_EQ: "{0} == {1}", ca.OP_NE: "{0} != {1}",
    ca.OP_NOT: "!{0}", ca.OP_AND: "{0} && {1}", ca.OP_OR: "{0} || {1}", ca.OP_IF_ELSE_ZERO: "{0} ? {1} : 0",
    ca.OP_SIGN: "{0} < 0 ? -1 : {0} > 0 ? 1 : {0}",
}  # fmt: skip
"""Those that compare and choose: distances from obstacles have some."""

REWRITTEN = {ca.OP_NEG: (ca.OP_MUL, -1.0), ca.OP_TWICE: (ca.OP_MUL, 2.0), ca.OP_INV: (ca.OP_DIV, 1.0)}
"""Operations with one operand as products or quotients of a constant."""


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
    """The result of an operation on other values, which are known by their numbers."""

    operation: int
    operands: tuple[int, ...]


@dataclass(frozen=True)
class Called:
    """One of the results of a call."""

    call: int
    result: int


Value = Constant | Read | Computed | Called


@dataclass(frozen=True)
class Call:
    """A call of another scalar function.

    Attributes:
        function: what is called.
        operands: the stored entries of all its arguments.
        results: the stored entries of all its results.
    """

    function: ca.Function
    operands: list[int]
    results: list[int]


class UnknownOperationError(Exception):
    """An operation has no form in code of our own."""


class Listing:
    """The values of a scalar function in the order in which it computes them.

    Attributes:
        function: what is listed.
        values: the values; an operand comes before what it is an operand of.
        calls: calls of other functions.
        outputs: for each output, number of the value of each stored entry that is computed.

    Raises:
        UnknownOperationError: there is an operation that is not known here.
    """

    def __init__(self, function: ca.Function) -> None:
        self.function = function
        self.values: list[Value] = []
        self.calls: list[Call] = []
        self.outputs: list[dict[int, int]] = [{} for _ in range(function.n_out())]
        self._known: dict[Value, int] = {}
        self._called = called_functions(function)
        variables: dict[int, int] = {}
        for k in range(function.n_instructions()):
            self._add(k, variables)

    def operands(self, number: int) -> list[int]:
        """Numbers of the values that one is computed from."""
        value = self.values[number]
        if isinstance(value, Computed):
            return list(value.operands)
        if isinstance(value, Called):
            return self.calls[value.call].operands
        return []

    @property
    def has_fours(self) -> bool:
        """Whether all operations have a form in fours."""
        return all(value.operation in BINARY for value in self.values if isinstance(value, Computed))

    def wanted(self) -> Iterator[int]:
        """Numbers of the values that are results, output after output."""
        for output in self.outputs:
            yield from output.values()

    def names_of_callees(self, prefix: str) -> dict[int, str]:
        """A name for each function that is called, by its hash: its own, with a number where that is taken."""
        functions = {hash(call.function): call.function for call in self.calls}
        names: dict[int, str] = {}
        for function_hash, function in functions.items():
            name = prefix + function.name()
            names[function_hash] = f"{name}_{len(names)}" if name in names.values() else name
        return names

    def _add(self, k: int, variables: dict[int, int]) -> None:
        """Append the value, or the values, of the k-th instruction; variables are used again and again."""
        code = self.function.instruction_id(k)
        inputs = self.function.instruction_input(k)
        outputs = self.function.instruction_output(k)
        if code == ca.OP_OUTPUT:
            self.outputs[outputs[0]][outputs[1]] = variables[inputs[0]]
        elif code == ca.OP_CONST:
            variables[outputs[0]] = self._number(Constant(self.function.instruction_constant(k)))
        elif code == ca.OP_INPUT:
            variables[outputs[0]] = self._number(Read(*inputs))
        elif code == ca.OP_CALL:
            self._call(self._called[k], [variables[i] for i in inputs], outputs, variables)
        else:
            variables[outputs[0]] = self._number(self._computed(code, [variables[i] for i in inputs]))

    def _computed(self, code: int, operands: list[int]) -> Computed:
        if code in REWRITTEN:
            operation, constant = REWRITTEN[code]
            return Computed(operation, (self._number(Constant(constant)), operands[0]))
        if code == ca.OP_SQ:
            return Computed(ca.OP_MUL, (operands[0], operands[0]))
        if code not in BINARY and code not in FUNCTIONS and code not in CHOICES:
            raise UnknownOperationError(f"operation {code}")
        return Computed(code, tuple(operands))

    def _call(self, function: ca.Function, operands: list[int], outputs: list[int], variables: dict[int, int]) -> None:
        results = [self._number(Called(len(self.calls), i)) for i in range(len(outputs))]
        self.calls.append(Call(function, operands, results))
        variables.update(zip(outputs, results, strict=True))

    def _number(self, value: Value) -> int:
        """The number of a value, which is computed once."""
        if value not in self._known:
            self._known[value] = len(self.values)
            self.values.append(value)
        return self._known[value]
