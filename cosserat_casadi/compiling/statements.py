"""Statements in C on numbers and on fours, with variables that are used again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import inf, isfinite
from typing import NamedTuple

import casadi as ca

from cosserat_casadi.compiling.listing import (
    BINARY,
    CHOICES,
    FEWEST,
    FUNCTIONS,
    SUMS,
    Computed,
    Listing,
    UnknownOperationError,
)

LONGEST = 300
"""Statements on fours in one function: compilers take longer, and stack without optimisation, with longer ones."""

LONGEST_OF_NUMBERS = 400
"""Statements on numbers in one function: what compilers take grows faster than its length."""

CHOICE, SUM, PRODUCT, ATOM = range(4)
"""How tightly expressions bind in C: choices and comparisons, sums, products, and what needs no parentheses."""

NEARNESS = 8
"""Part of the length of a function by which its end may move to where fewer values pass to the next one."""

SHARED_NUMBER = "C[000]"
"""About how a constant looks that several functions have."""

LONGEST_LINE = 110
"""Characters up to which the expression of a value that is read once stands where it is read."""


class Statement(NamedTuple):
    """One statement.

    Attributes:
        text: an expression, or all of a statement that only writes; with ``{0}``, ``{1}`` for its operands.
        operands: numbers of the values that it reads.
        made: number of the value of the expression; None for a statement that only writes.
        binding: how tightly the expression binds, of ATOM, PRODUCT, SUM and CHOICE; a written text takes any operand.
        sides: how tightly each operand must bind to stand without parentheses.
        asked: whether it writes only where a result is asked for.
        whole: places of the operands of which the expression is a whole number of C if they are, as comparisons are
            without; None where it never is.
    """

    text: str
    operands: Sequence[int]
    made: int | None = None
    binding: int = 0
    sides: Sequence[int] = ()
    asked: bool = False
    whole: Sequence[int] | None = None

    def stores(self, value: int | None) -> bool:
        """Whether the statement stores a value as it is, whatever is asked for."""
        alone = all(side == CHOICE for side in self.sides)
        return self.made is None and not self.asked and alone and list(self.operands) == [value]

    def with_operand(self, place: int, other: Statement) -> Statement:
        """This statement with the expression of another in place of an operand."""
        count = len(other.operands)
        inner = other.text.format(*[f"{{{place + i}}}" for i in range(count)])
        if self.sides and other.binding < self.sides[place]:
            inner = f"({inner})"
        before = [f"{{{i}}}" for i in range(place)]
        behind = [f"{{{count + i}}}" for i in range(place, len(self.operands) - 1)]
        operands = [*self.operands[:place], *other.operands, *self.operands[place + 1 :]]
        # Operands of the other stand in its text, and there beside each other.
        own = self.sides or [CHOICE] * len(self.operands)
        sides = [*own[:place], *(other.sides or [CHOICE] * count), *own[place + 1 :]]
        text = self.text.format(*before, inner, *behind)
        return self._replace(text=text, operands=operands, sides=sides)


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
        statements = _nested(self.statements, text_of)
        last_use = {operand: i for i, statement in enumerate(statements) for operand in statement.operands}
        variable: dict[int, str] = {}
        free: list[str] = []
        lines = []
        computed = ""
        for i, statement in enumerate(statements):
            texts = [computed or text_of(operand) or variable[operand] for operand in statement.operands]
            computed = ""
            done = [operand for operand in dict.fromkeys(statement.operands) if last_use[operand] == i]
            free += [variable[operand] for operand in done if operand in variable]
            text = statement.text.format(*texts)
            if statement.made is not None:
                made = free.pop() if free else self._another()
                variable[statement.made] = made
                text = f"{made} = {text}"
                if last_use[statement.made] > i + 1 and statements[i + 1].stores(statement.made):
                    # The next statement, which stores it, computes it too.
                    computed = text
                    continue
                text += ";"
            lines.append(f"  {text}")
        return [*self._declarations(), *lines]

    def _another(self) -> str:
        self.variables += 1
        return f"{self.letter}{self.variables - 1}"

    def _declarations(self) -> list[str]:
        """Declarations, some on each line."""
        names = [f"{self.letter}{i}" for i in range(self.variables)]
        return [f"  {self.type} {', '.join(names[i : i + 16])};" for i in range(0, len(names), 16)]


VALUES_OF_CHOICES: Mapping[int, Sequence[int]] = {ca.OP_IF_ELSE_ZERO: (1,), ca.OP_SIGN: (0,)}
"""Places of the operands that are chosen; other choices answer a question."""


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
            binding = SUM if operation in SUMS else PRODUCT
            # Operands on the right keep their parentheses: a sum is rounded in the order in which it is written.
            sides = (binding, binding + 1)
            whole = None if operation == ca.OP_DIV else (0, 1)
            return Statement(f"{{0}} {BINARY[operation]} {{1}}", operands, made, binding, sides, whole=whole)
        if operation in self.choices:
            chosen = VALUES_OF_CHOICES.get(operation, ())
            return Statement(self.choices[operation], operands, made, CHOICE, [ATOM] * len(operands), whole=chosen)
        if operation not in self.functions:
            raise UnknownOperationError(FUNCTIONS.get(operation, f"operation {operation}"))
        places = ", ".join(f"{{{i}}}" for i in range(len(operands)))
        return Statement(f"{self.functions[operation]}({places})", operands, made, ATOM)


SINGLE = Arithmetic(FUNCTIONS, CHOICES, "{}", FEWEST)
"""Numbers one by one, and calls of intervals four at a time."""

FOURS = Arithmetic({}, {}, "EACH({})", None)
"""Four numbers at once."""

LANES_OF_ROWS = Arithmetic(
    {
        ca.OP_SQRT: "lanes_sqrt", ca.OP_EXP: "lanes_exp", ca.OP_FABS: "lanes_fabs", ca.OP_FMAX: "lanes_fmax",
        ca.OP_FMIN: "lanes_fmin", ca.OP_LT: "lanes_less", ca.OP_LE: "lanes_at_most", ca.OP_EQ: "lanes_equal",
        ca.OP_NE: "lanes_unequal", ca.OP_NOT: "lanes_not", ca.OP_AND: "lanes_and", ca.OP_OR: "lanes_or",
        ca.OP_IF_ELSE_ZERO: "lanes_if", ca.OP_SIGN: "lanes_sign",
    },
    {},
    "IN_ALL({})",
    None,
)  # fmt: skip
"""Numbers of several rows at once. Each lane answers a comparison in its own way, by 1 or 0: none branches."""


def _nested(statements: Sequence[Statement], text_of: Callable[[int], str | None]) -> list[Statement]:
    """Statements with the expression of each value that is read once in its place, as far as lines stay short."""
    reads = Counter(operand for statement in statements for operand in statement.operands)
    waiting: dict[int, Statement] = {}
    written: list[Statement] = []
    for statement in statements:
        place = 0
        not_whole = list(statement.whole or ())
        for i, operand in enumerate(statement.operands):
            other = waiting.pop(operand, None)
            if other is None:
                place += 1
                continue
            longer = statement.with_operand(place, other)
            # C leaves out the rest of a quotient of whole numbers; in a variable they are numbers as others.
            divides = other.whole == () and statement.whole is None and statement.binding == PRODUCT
            if divides or _length(longer, text_of) > LONGEST_LINE:
                written.append(other)
                place += 1
                continue
            statement = longer
            place += len(other.operands)
            if other.whole == () and i in not_whole:
                not_whole.remove(i)
        if statement.whole is not None:
            statement = statement._replace(whole=None if not_whole else ())
        if statement.made is not None and reads[statement.made] == 1:
            waiting[statement.made] = statement
        else:
            written.append(statement)
    # None of these statements reads the others.
    return [*written, *waiting.values()]


def _length(statement: Statement, text_of: Callable[[int], str | None]) -> int:
    """Characters of a statement, whose variables are short."""
    texts = [text_of(operand) or "a00" for operand in statement.operands]
    return len(statement.text.format(*[SHARED_NUMBER if "NUMBER" in text else text for text in texts]))


NOTHING_STORED: Mapping[int, int] = {}


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
    statements: Sequence[Statement],
    longest: int,
    store: Callable[[int], str],
    stored: Mapping[int, int] = NOTHING_STORED,
    first: int = 0,
) -> tuple[list[StatementPart], int]:
    """Statements in parts, each a function.

    Args:
        statements: the statements.
        longest: most statements in a part.
        store: place of a value that is passed on ↦ text of the statement that stores it.
        stored: places of values that a later statement than the value's own stores.
        first: the first place of values that are passed on.

    Returns:
        the parts, with statements that store the values that other parts read, and the number of these values.
    """
    ends = _ends_of_parts(statements, longest, stored)
    parts = [statements[first:end] for first, end in pairwise([0, *ends])]
    passed: dict[int, int] = {}
    before: set[int] = set()
    for part in parts:
        own = {statement.made for statement in part if statement.made is not None}
        for statement in part:
            for operand in statement.operands:
                if operand in before and operand not in stored:
                    passed.setdefault(operand, first + len(passed))
        before |= own
    return [_part(part, passed, store, stored) for part in parts], len(passed)


def _ends_of_parts(statements: Sequence[Statement], longest: int, stored: Container[int]) -> list[int]:
    """Where parts end: as equal ones do, or near there where fewer values pass."""
    count = max(-(-len(statements) // longest), 1)
    size = len(statements) // count
    passing = _passing(statements, stored)
    ends = []
    for number in range(1, count):
        near = range(number * size - size // NEARNESS, number * size + size // NEARNESS + 1)
        # What a statement computes is stored in the same part.
        possible = [end for end in near if not statements[end].stores(statements[end - 1].made)]
        ends.append(min(possible or near, key=passing.__getitem__))
    # A Jacobian that reads no columns has no statements for them.
    return [*ends, len(statements)] if statements else []


def _passing(statements: Sequence[Statement], stored: Container[int]) -> list[int]:
    """How many values the first k statements compute, and store nowhere, that later statements read, for each k."""
    last_use = {operand: i for i, statement in enumerate(statements) for operand in statement.operands}
    change = [0] * (len(statements) + 1)
    for i, statement in enumerate(statements):
        if statement.made in last_use and statement.made not in stored:
            change[i + 1] += 1
            change[last_use[statement.made] + 1] -= 1
    return list(accumulate(change))


def _part(
    part: Sequence[Statement], passed: Mapping[int, int], store: Callable[[int], str], stored: Mapping[int, int]
) -> StatementPart:
    statements = []
    computed = set()
    for statement in part:
        statements.append(statement)
        if statement.made is not None:
            computed.add(statement.made)
        if statement.made is not None and statement.made in passed:
            statements.append(Statement(store(passed[statement.made]), [statement.made]))
    places = {**passed, **stored}
    return StatementPart(statements, {value: place for value, place in places.items() if value not in computed})


def number_in_c(value: float) -> str:
    """A constant in C; negative ones may follow an operation."""
    if not isfinite(value):
        return {inf: "INFINITY", -inf: "(-INFINITY)"}.get(value, "NAN")
    text = repr(value)
    if len(text) > len(SHARED_NUMBER):
        # Those that are there several times are read from an array.
        return f"NUMBER({text})"
    return f"({text})" if value < 0 else text
