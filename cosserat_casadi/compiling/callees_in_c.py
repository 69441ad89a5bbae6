"""Functions in C that kernels call, and how their arguments lie in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

from cosserat_casadi.compiling.listing import LANES, Call, Constant, Listing, Read, UnknownOperationError
from cosserat_casadi.compiling.printed_kernels import Callee, PlacedCallee
from cosserat_casadi.compiling.statements import FOURS, Arithmetic, Block, Statement, computations, number_in_c

Form = tuple[bool, tuple[int, ...]]
"""Whether an argument depends on the column, and offsets of its numbers from the first one."""


@dataclass(frozen=True)
class OperandRun:
    """Place of an argument of a call: text of the pointer to its first number, written on demand, and its form."""

    pointer: Callable[[], str]
    form: Form


def run_of(array: str, places: Sequence[int], lanes: int) -> OperandRun:
    """Make the run of numbers at places of an array, with a number of lanes beside each other."""
    behind = tuple(lanes * (place - places[0]) for place in places)
    return OperandRun(lambda: f"{array} + {lanes * places[0]}", (array != "w", behind))


def arguments_at_places(
    calls: Sequence[Call],
    run: Callable[[Sequence[int]], OperandRun | None],
    copied: Sequence[Callable[..., OperandRun]],
) -> tuple[list[list[str]], list[Form]]:
    """Find pointers to the arguments of calls of one function, and the form of each argument.

    Args:
        calls: the calls.
        run: function that finds how operands lie; None if they are not in one array.
        copied: function of each call that copies operands, for arguments that lie differently in some calls.
    """
    pointers: list[list[str]] = [[] for _ in calls]
    forms = []
    for operands in zip(*(call.arguments for call in calls), strict=True):
        runs = [run(one) for one in operands]
        forms_of_calls = {None if one is None else one.form for one in runs}
        if None in forms_of_calls or len(forms_of_calls) > 1:
            runs = [copy(one) for copy, one in zip(copied, operands, strict=True)]
        found = [one for one in runs if one is not None]
        forms.append(found[0].form)
        for pointer, one in zip(pointers, found, strict=True):
            pointer.append(one.pointer())
    return pointers, forms


def callee_at_places(listing: Listing, forms: Sequence[Form], arithmetic: Arithmetic) -> tuple[PlacedCallee, int]:
    """Write a function that reads its arguments in place; also return its number of statements.

    Args:
        listing: values of the function.
        forms: form of each argument.
        arithmetic: FOURS for four columns at once, or SINGLE.

    Raises:
        UnknownOperationError: an operation is not supported, or the function calls another one.
    """

    def entry(read: Read) -> str:
        in_column, places = forms[read.argument]
        place = places[read.entry]
        return f"LOAD(p{read.argument} + {place})" if in_column else f"p{read.argument}[{place}]"

    written, statements = _written(listing, arithmetic, entry)
    return PlacedCallee(written, len(forms), arithmetic is FOURS), statements


def callee(listing: Listing, arithmetic: Arithmetic) -> tuple[Callee, int]:
    """Write a function that kernels call; also return its number of statements.

    Args:
        listing: the values of the function.
        arithmetic: FOURS for four calls at once, or arithmetic of single numbers.

    Raises:
        UnknownOperationError: an operation is not supported, or the function calls another one.
    """
    function = listing.function
    width = LANES if arithmetic is FOURS else 1
    starts = [0, *accumulate(function.nnz_in(i) for i in range(function.n_in()))]

    def entry(read: Read) -> str:
        place = width * (starts[read.argument] + read.entry)
        return f"GIVEN({place})" if width == LANES else f"given[{place}]"

    written, statements = _written(listing, arithmetic, entry)
    return Callee(written, width, function.nnz_in(), function.nnz_out()), statements


def _written(listing: Listing, arithmetic: Arithmetic, entry: Callable[[Read], str]) -> tuple[str, int]:
    """Write the body of a function, with the text of each entry of its arguments; also count its statements."""
    function = listing.function
    if listing.calls:
        raise UnknownOperationError(f"a call in {function.name()}, which is called itself")
    wide = arithmetic is FOURS
    block = Block(*(("FOUR", "b") if wide else ("casadi_real", "a")), computations(listing, arithmetic))
    starts = [0, *accumulate(function.nnz_out(i) for i in range(function.n_out()))]
    for start, entries in zip(starts, listing.outputs, strict=False):
        for place, number in entries.items():
            made = LANES * (start + place) if wide else start + place
            value = listing.values[number]
            if wide and isinstance(value, Constant):
                block.statements.append(Statement(f"FILL(made + {made}, {number_in_c(value.value)});", []))
                continue
            store = f"STORE(made + {made}, {{0}});" if wide else f"made[{made}] = {{0}};"
            block.statements.append(Statement(store, [number]))

    def text(number: int) -> str | None:
        value = listing.values[number]
        if isinstance(value, Constant):
            return arithmetic.number(value.value)
        return entry(value) if isinstance(value, Read) else None

    return body(block.lines(text)), len(block.statements)


def body(lines: Iterable[str]) -> str:
    """Join lines to the body of a function."""
    return "\n".join([" {", *lines, "}\n"])
