"""Statements in C on single numbers and on four numbers at a time, with reused variables."""

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
"""Most statements on four numbers in a function; longer ones take compilers longer, and stack if not optimised."""

LONGEST_OF_NUMBERS = 400
"""Most statements on single numbers in a function: the time of compilers grows faster than its length."""

CHOICE, SUM, PRODUCT, ATOM = range(4)
"""Precedence of expressions in C: choices and comparisons, sums, products, and atoms without parentheses."""

NEARNESS = 8
"""Share 1/NEARNESS of a function's length by which its end may move to pass fewer values to the next one."""

SHARED_NUMBER = "C[000]"
"""Text of typical length for a constant that several functions share."""

LONGEST_LINE = 110
"""Most characters of a line into which the expression of a value that is read once is inlined."""


class Statement(NamedTuple):
    """One statement.

    Attributes:
        text: an expression, or a complete statement that only writes; with ``{0}``, ``{1}`` for its operands.
        operands: numbers of the values that it reads.
        made: number of the value of the expression; None for a statement that only writes.
        binding: precedence of the expression: ATOM, PRODUCT, SUM or CHOICE; a written text takes any operand.
        sides: least precedence of each operand without parentheses.
        asked: whether it writes only if a result is requested.
        whole: indices of the operands that must be C integers for the expression to be one; empty for comparisons,
            None for an expression that never is.
    """

    text: str
    operands: Sequence[int]
    made: int | None = None
    binding: int = 0
    sides: Sequence[int] = ()
    asked: bool = False
    whole: Sequence[int] | None = None

    def stores(self, value: int | None) -> bool:
        """Whether the statement stores a value unconditionally and unchanged."""
        alone = all(side == CHOICE for side in self.sides)
        return self.made is None and not self.asked and alone and list(self.operands) == [value]

    def with_operand(self, place: int, other: Statement) -> Statement:
        """Return the statement with an operand replaced by the expression of another statement."""
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
        type: type of its variables.
        letter: prefix of their names.
        statements: the statements.
        variables: number of variables, after it is written.
    """

    type: str
    letter: str
    statements: list[Statement]
    variables: int = 0

    def lines(self, text_of: Callable[[int], str | None]) -> list[str]:
        """Write declarations and statements.

        Args:
            text_of: function of a value ↦ its text if it is not in a variable of this block, else None.
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
        """Write the declarations, several on each line."""
        names = [f"{self.letter}{i}" for i in range(self.variables)]
        return [f"  {self.type} {', '.join(names[i : i + 16])};" for i in range(0, len(names), 16)]


VALUES_OF_CHOICES: Mapping[int, Sequence[int]] = {ca.OP_IF_ELSE_ZERO: (1,), ca.OP_SIGN: (0,)}
"""Indices of the operands among which an operation chooses; other operations of this kind compare."""


@dataclass(frozen=True)
class Arithmetic:
    """Notation of numbers and operations in C.

    Attributes:
        functions: names of functions of the mathematical library, by operation.
        choices: comparisons and choices, by operation.
        spread: format of a constant.
        together: least number of calls of one function that are made together; None for never.
    """

    functions: Mapping[int, str]
    choices: Mapping[int, str]
    spread: str
    together: int | None

    def number(self, value: float) -> str:
        """Write a constant."""
        return self.spread.format(number_in_c(value))

    def operation(self, operation: int, operands: Sequence[int], made: int) -> Statement:
        """Write an operation.

        Raises:
            UnknownOperationError: the operation is not supported.
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
"""Arithmetic of single numbers, with calls for intervals four at a time."""

FOURS = Arithmetic({}, {}, "EACH({})", None)
"""Arithmetic of four numbers at once."""

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
"""Arithmetic of several rows at once. A comparison is 1 or 0 in each lane, without branches."""


def _nested(statements: Sequence[Statement], text_of: Callable[[int], str | None]) -> list[Statement]:
    """Inline the expression of each value that is read once, as long as lines stay short."""
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
    """Number of characters of a statement, with short names of variables."""
    texts = [text_of(operand) or "a00" for operand in statement.operands]
    return len(statement.text.format(*[SHARED_NUMBER if "NUMBER" in text else text for text in texts]))


NOTHING_STORED: Mapping[int, int] = {}


@dataclass(frozen=True)
class StatementPart:
    """Statements of one of several consecutive functions.

    Attributes:
        statements: the statements.
        passed: place of each value that another part computes and stores, by its number.
    """

    statements: list[Statement]
    passed: dict[int, int]


def computations(listing: Listing, arithmetic: Arithmetic) -> list[Statement]:
    """Write the operations of a function, in their order.

    Raises:
        UnknownOperationError: an operation has no form in the arithmetic.
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
    """Split statements into parts, each a function.

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
    """Ends of parts: at equal lengths, or nearby where fewer values pass."""
    count = max(-(-len(statements) // longest), 1)
    size = len(statements) // count
    passing = _passing(statements, stored)
    ends = []
    for number in range(1, count):
        near = range(number * size - size // NEARNESS, number * size + size // NEARNESS + 1)
        # Each part stores the values that its statements compute.
        possible = [end for end in near if not statements[end].stores(statements[end - 1].made)]
        ends.append(min(possible or near, key=passing.__getitem__))
    # A Jacobian that reads no columns has no statements for them.
    return [*ends, len(statements)] if statements else []


def _passing(statements: Sequence[Statement], stored: Container[int]) -> list[int]:
    """Number of values, for each k, that the first k statements compute without storing and later statements read."""
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
    """Write a constant in C, such that a negative one may follow an operation."""
    if not isfinite(value):
        return {inf: "INFINITY", -inf: "(-INFINITY)"}.get(value, "NAN")
    text = repr(value)
    if len(text) > len(SHARED_NUMBER):
        # Repeated values are read from an array.
        return f"NUMBER({text})"
    return f"({text})" if value < 0 else text
