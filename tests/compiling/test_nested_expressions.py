"""Values that are read once stand where they are read, in parentheses where the order of rounding asks for them."""

from __future__ import annotations

import random
import re

import casadi as ca
import pytest

from cosserat_casadi.compiling.listing import BINARY, Constant, Listing, Read
from cosserat_casadi.compiling.statements import ATOM, LONGEST_LINE, SINGLE, Block, Statement, computations, in_parts

SYMBOLS = 4
VALUES = [0.1, 0.7, -1.3, 3.1]


def lines_of(expressions: list[ca.SX], symbols: ca.SX) -> list[str]:
    """Lines of C that store these expressions in r0, r1, …, of symbols called x0, x1, …"""
    listing = Listing(ca.Function("f", [symbols], [ca.vertcat(*expressions)]))
    block = Block("casadi_real", "a", computations(listing, SINGLE))
    for entry, number in listing.outputs[0].items():
        block.statements.append(Statement(f"r{entry} = {{0}};", [number]))

    def text(number: int) -> str | None:
        value = listing.values[number]
        if isinstance(value, Constant):
            return SINGLE.number(value.value)
        return f"x{value.entry}" if isinstance(value, Read) else None

    return [line.strip() for line in block.lines(text)]


def in_python(lines: list[str]) -> dict[str, float]:
    """The numbers that lines compute: sums and products bind in Python as in C."""
    numbers = {f"x{i}": value for i, value in enumerate(VALUES)}
    for line in lines:
        if not line.startswith("casadi_real"):
            exec(line.rstrip(";"), {}, numbers)
    return numbers


def test_parentheses_stand_where_c_would_group_otherwise() -> None:
    symbols = ca.SX.sym("x", SYMBOLS)
    x, y, z, u = ca.vertsplit(symbols)
    in_c = {
        "x0 - (x1 + x2)": x - (y + z),
        "x0 - x1 + x2": (x - y) + z,
        "x0 / (x1 * x2)": x / (y * z),
        "x0 / x1 * x2": (x / y) * z,
        "x0 * (x1 + x2)": x * (y + z),
        "x0 * x1 * x2": (x * y) * z,
        "x0 * (x1 * x2)": x * (y * z),
        "x0 + x1 * x3": x + y * u,
        "(-1.0) * (x0 + x1)": -(x + y),
        "sin(x0 + x1) - x2": ca.sin(x + y) - z,
        "(x0 + x1) < x2": x + y < z,
    }
    for text, expression in in_c.items():
        assert lines_of([expression], symbols) == [f"r0 = {text};"]


@pytest.mark.parametrize("seed", range(20))
def test_nested_expressions_are_rounded_as_casadi_rounds(seed: int) -> None:
    draw = random.Random(seed)
    symbols = ca.SX.sym("x", SYMBOLS)
    pool = ca.vertsplit(symbols)
    for _ in range(60):
        left, right = draw.sample(pool[-12:], 2)
        pool.append(ca.SX.binary(draw.choice(list(BINARY)), left, right))
    lines = lines_of(pool[-6:], symbols)
    expected = ca.Function("f", [symbols], [ca.vertcat(*pool[-6:])])(VALUES).nonzeros()
    numbers = in_python(lines)
    assert [numbers[f"r{i}"] for i in range(6)] == expected
    assert max(map(len, lines)) <= LONGEST_LINE + len("a00 = ;")


@pytest.mark.parametrize("asked", [False, True])
def test_a_value_is_computed_where_it_is_stored(asked: bool) -> None:
    """Unless the store may be left out."""
    store = Statement("r0 = {0};", [2], asked=asked)
    statements = [SINGLE.operation(ca.OP_MUL, [0, 1], 2), store, Statement("r1 = {0} + {0};", [2])]
    block = Block("casadi_real", "a", statements)
    _, *lines = [line.strip() for line in block.lines(lambda number: f"x{number}" if number < 2 else None)]
    both = ["a0 = x0 * x1;", "r0 = a0;"] if asked else ["r0 = a0 = x0 * x1;"]
    assert lines == [*both, "r1 = a0 + a0;"]


@pytest.mark.parametrize("operands", [(2, 3), (3, 2)])
def test_a_value_is_not_computed_within_a_product_that_is_stored(operands: tuple[int, int]) -> None:
    """There C takes the factor before it for what is assigned to, and the factor behind it for a part of the value."""
    value = SINGLE.operation(ca.OP_MUL, [0, 1], 2)
    factor = Statement("factor", [], 3, ATOM)
    product = SINGLE.operation(ca.OP_MUL, operands, 4)
    statements = [value, factor, product, Statement("r0 = {0};", [4]), Statement("r1 = {0} + {0};", [2])]
    block = Block("casadi_real", "a", statements)
    _, *lines = [line.strip() for line in block.lines(lambda number: f"x{number}" if number < 2 else None)]
    stored = {(2, 3): "r0 = a0 * factor;", (3, 2): "r0 = factor * a0;"}
    assert lines == ["a0 = x0 * x1;", stored[operands], "r1 = a0 + a0;"]


@pytest.mark.parametrize(
    ("operation", "stored"), [(ca.OP_DIV, "r0 = a1 / a2;"), (ca.OP_MUL, "r0 = ((x0 < x1) + (x1 < x0)) * (x0 < x1);")]
)
def test_whole_numbers_of_c_are_not_divided(operation: int, stored: str) -> None:
    """A quotient of comparisons, and of their sums, would be one without its rest."""
    less = [SINGLE.operation(ca.OP_LT, [i, j], 2 + k) for k, (i, j) in enumerate([(0, 1), (1, 0), (0, 1)])]
    both = SINGLE.operation(ca.OP_ADD, [2, 3], 5)
    wanted = SINGLE.operation(operation, [5, 4], 6)
    block = Block("casadi_real", "a", [*less, both, wanted, Statement("r0 = {0};", [6])])
    lines = [line.strip() for line in block.lines(lambda number: f"x{number}" if number < 2 else None)]
    assert re.sub(r"a\d", "a", lines[-1]) == re.sub(r"a\d", "a", stored)


@pytest.mark.parametrize("fewest_at", [9, 10, 11])
def test_parts_end_where_few_values_pass(fewest_at: int) -> None:
    statements = [Statement("1", [], i) for i in range(fewest_at - 1)]
    statements.append(Statement("sum", range(fewest_at - 1), fewest_at - 1))
    statements += [Statement("{0} + {0}", [i], i + 1) for i in range(fewest_at - 1, 19)]
    parts, passed = in_parts(statements, 10, lambda place: f"passed[{place}] = {{0}};")
    first, second = parts
    assert passed == 1
    assert len(first.statements) == fewest_at + 1
    assert second.passed == {fewest_at - 1: 0}
