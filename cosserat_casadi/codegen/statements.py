"""Statements in C on numbers and on fours, with variables that are used again."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite

import casadi as ca

from cosserat_casadi.codegen.listing import BINARY, CHOICES, FUNCTIONS, Computed, Listing, UnknownOperationError

LONGEST = 300
"""Statements on fours in one function: compilers take longer, and stack without optimisation, with longer ones."""

LONGEST_OF_NUMBERS = 400
"""Statements on numbers in one function: what compilers take grows faster than its length."""


@dataclass(frozen=True)
class Statement:
    """One statement.

    Attributes:
        text: with ``{made}`` for its result, and ``{0}``, ``{1}`` for its operands.
        operands: numbers of the values that it reads.
        made: number of the value that it computes; None for one that only writes.
    """

    text: str
    operands: Sequence[int]
    made: int | None = None


@dataclass
class Block:
    """Statements of one function.

    Attributes:
        type: of its variables.
        letter: what their names begin with.
        statements: the statements.
        variables: how many there are, once it is written.
    """

    type: str
    letter: str
    statements: list[Statement]
    variables: int = 0

    def lines(self, text_of: Callable[[int], str | None]) -> list[str]:
        """Declarations and statements.

        Args:
            text_of: text of a value that is in no variable of this block; None for one that is.
        """
        last_use = {operand: i for i, statement in enumerate(self.statements) for operand in statement.operands}
        variable: dict[int, str] = {}
        free: list[str] = []
        lines = []
        for i, statement in enumerate(self.statements):
            texts = [text_of(operand) or variable[operand] for operand in statement.operands]
            done = [operand for operand in dict.fromkeys(statement.operands) if last_use[operand] == i]
            free += [variable[operand] for operand in done if operand in variable]
            made = ""
            if statement.made is not None:
                made = free.pop() if free else self._another()
                variable[statement.made] = made
            lines.append(f"  {statement.text.format(*texts, made=made)}")
        return [*self._declarations(), *lines]

    def _another(self) -> str:
        self.variables += 1
        return f"{self.letter}{self.variables - 1}"

    def _declarations(self) -> list[str]:
        """Declarations, some on each line."""
        names = [f"{self.letter}{i}" for i in range(self.variables)]
        return [f"  {self.type} {', '.join(names[i : i + 16])};" for i in range(0, len(names), 16)]


@dataclass(frozen=True)
class Arithmetic:
    """How numbers and operations on them are written.

    Attributes:
        functions: names of functions of the mathematical library, by operation.
        choices: comparisons and choices, by operation.
        spread: what a constant is written in.
        together: calls of one function from which on they are made together; None for never.
    """

    functions: Mapping[int, str]
    choices: Mapping[int, str]
    spread: str
    together: int | None

    def number(self, value: float) -> str:
        """A constant."""
        return self.spread.format(number_in_c(value))

    def operation(self, operation: int, operands: Sequence[int], made: int) -> Statement:
        """An operation.

        Raises:
            UnknownOperationError: it has no form here.
        """
        if operation in BINARY:
            return Statement(f"{{made}} = {{0}} {BINARY[operation]} {{1}};", operands, made)
        if operation in self.choices:
            return Statement(f"{{made}} = {self.choices[operation]};", operands, made)
        if operation not in self.functions:
            raise UnknownOperationError(FUNCTIONS.get(operation, f"operation {operation}"))
        places = ", ".join(f"{{{i}}}" for i in range(len(operands)))
        return Statement(f"{{made}} = {self.functions[operation]}({places});", operands, made)


FEWEST = 3
"""Calls of one function from which on they are made together, four at a time."""

SINGLE = Arithmetic(FUNCTIONS, CHOICES, "{}", FEWEST)
"""Numbers one by one, and calls of intervals four at a time."""

FOURS = Arithmetic({}, {}, "EACH({})", None)
"""Four numbers at once."""

LANES_OF_ROWS = Arithmetic(
    {ca.OP_SQRT: "lanes_sqrt", ca.OP_EXP: "lanes_exp", ca.OP_FABS: "lanes_fabs", ca.OP_FMAX: "lanes_fmax"},
    {},
    "IN_ALL({})",
    None,
)
"""Numbers of several rows at once, which have no comparison: lanes would answer it each in its own way."""


@dataclass(frozen=True)
class StatementPart:
    """Statements of one function of several that follow on each other.

    Attributes:
        statements: the statements.
        passed: place of each value that another part computes and stores, by its number.
    """

    statements: list[Statement]
    passed: dict[int, int]


def computations(listing: Listing, arithmetic: Arithmetic) -> list[Statement]:
    """The operations of a function, in their order.

    Raises:
        UnknownOperationError: one has no form in the arithmetic.
    """
    statements = []
    for number, value in enumerate(listing.values):
        if isinstance(value, Computed):
            statements.append(arithmetic.operation(value.operation, value.operands, number))
    return statements


def in_parts(
    statements: Sequence[Statement], longest: int, store: Callable[[int], str]
) -> tuple[list[StatementPart], int]:
    """Statements in parts, each a function.

    Args:
        statements: the statements.
        longest: most of them in a part.
        store: place of a value that is passed on ↦ text of the statement that stores it.

    Returns:
        the parts, with statements that store the values that other parts read, and the number of these values.
    """
    count = max(-(-len(statements) // longest), 1)
    # A Jacobian that reads no columns has no statements for them.
    size = max(-(-len(statements) // count), 1)
    parts = [statements[first : first + size] for first in range(0, len(statements), size)]
    passed: dict[int, int] = {}
    before: set[int] = set()
    for part in parts:
        own = {statement.made for statement in part if statement.made is not None}
        for statement in part:
            for operand in statement.operands:
                if operand in before:
                    passed.setdefault(operand, len(passed))
        before |= own
    return [_part(part, passed, store) for part in parts], len(passed)


def _part(part: Sequence[Statement], passed: dict[int, int], store: Callable[[int], str]) -> StatementPart:
    statements = []
    computed = set()
    for statement in part:
        statements.append(statement)
        if statement.made is not None:
            computed.add(statement.made)
        if statement.made is not None and statement.made in passed:
            statements.append(Statement(store(passed[statement.made]), [statement.made]))
    return StatementPart(statements, {value: place for value, place in passed.items() if value not in computed})


def number_in_c(value: float) -> str:
    """A constant in C; negative ones may follow an operation."""
    if not isfinite(value):
        return {inf: "INFINITY", -inf: "(-INFINITY)"}.get(value, "NAN")
    text = repr(value)
    return f"({text})" if value < 0 else text
