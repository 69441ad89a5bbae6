"""The columns of a Jacobian in C, four at a time (codegen/columns.py)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from cosserat_casadi.compiling.callees_in_c import OperandRun, arguments_at_places, body, callee_at_places, run_of
from cosserat_casadi.compiling.listing import LANES, Called, Computed, Constant, Listing, Read, UnknownOperationError
from cosserat_casadi.compiling.printed_kernels import (
    CALL_OF_COLUMNS,
    COLUMNS,
    PART_OF_COLUMNS,
    ColumnForm,
    PlacedCallee,
)
from cosserat_casadi.compiling.statements import FOURS, LONGEST, Block, Statement, in_parts


class ColumnsInC:
    """Writer of the C that computes four columns of a Jacobian at once.

    Attributes:
        callees: functions that the code calls, by name.
        statements: number of statements, once the code is written.
        passed: number of fours that parts pass on, and that calls read and write.
        places: place of each of these fours, by the number of the value.
    """

    def __init__(
        self,
        listing: Listing,
        form: ColumnForm,
        name: str,
        in_column: Sequence[bool],
        numbers: Mapping[int, int],
        run_of_numbers: Callable[[Sequence[int]], OperandRun | None],
    ) -> None:
        """Prepare the writer; :meth:`text` writes.

        Args:
            listing: values of the kernel.
            form: form of the Jacobian.
            name: name of the kernel.
            in_column: whether each value depends on the column.
            numbers: places of the values that columns share and read.
            run_of_numbers: function that finds how shared values lie in memory; None if they are not in one array.
        """
        self.listing = listing
        self.form = form
        self.name = name
        self.in_column = in_column
        self.numbers = numbers
        self.run_of_numbers = run_of_numbers
        self.callee_names = listing.names_of_callees("")
        self.callees: dict[str, PlacedCallee] = {}
        self.statements = 0
        self.passed = 0
        self.places: dict[int, int] = {}

    def text(self, name: str) -> str:
        """Write the code in parts that pass values on, and the loop over all columns under a name."""
        statements = self._statements_of_columns()
        parts, passed = in_parts(statements, LONGEST, _passed_on, self.places, self.passed)
        self.passed += passed
        calls = []
        functions = []
        for k, part in enumerate(parts):
            block = Block("FOUR", "b", part.statements)
            written = body(block.lines(partial(self._text, part.passed)))
            functions.append(PART_OF_COLUMNS.format(name=name, part=k, body=written))
            calls.append(CALL_OF_COLUMNS.format(name=name, part=k))
            self.statements += len(block.statements)
        turns = LANES * len(self.form.turns)
        functions.append(COLUMNS.format(name=name, turns=turns, calls="\n".join(calls)))
        return "\n".join(functions)

    def _statements_of_columns(self) -> list[Statement]:
        form = self.form
        statements = []
        called = self._calls_in_columns()
        for number, value in enumerate(self.listing.values):
            if not self.in_column[number] or isinstance(value, Read):
                continue
            if isinstance(value, Computed):
                statements.append(FOURS.operation(value.operation, value.operands, number))
                if number in self.places:
                    statements.append(Statement(_passed_on(self.places[number]), [number]))
            elif isinstance(value, Called) and value.result == 0:
                statements += called[value.call]
        entries = self.listing.outputs[-1]
        for row in range(form.rows):
            place = row * form.stride
            made = entries.get(row)
            if made is None or self.listing.values[made] == Constant(0.0):
                statements.append(Statement(f"FILL(columns + {place}, 0);", []))
            elif self.in_column[made]:
                statements.append(Statement(f"STORE(columns + {place}, {{0}});", [made]))
            else:
                raise UnknownOperationError("a row that all columns share")
        return statements

    def _calls_in_columns(self) -> dict[int, list[Statement]]:
        """Write the statements of each call that columns make, by the number of the call."""
        listing = self.listing
        of_columns = [number for number, call in enumerate(listing.calls) if self.in_column[call.results[0]]]
        for number in of_columns:
            for result in listing.calls[number].results:
                self.places[result] = self._more(1)
        statements: dict[int, list[Statement]] = {number: [] for number in of_columns}
        by_function: dict[int, list[int]] = defaultdict(list)
        for number in of_columns:
            by_function[hash(listing.calls[number].function)].append(number)
        for key, numbers in by_function.items():
            calls = [listing.calls[number] for number in numbers]
            copied = [partial(self._passed_copy, statements[number]) for number in numbers]
            pointers, forms = arguments_at_places(calls, self._run_in_columns, copied)
            name = f"{self.callee_names[key]}_of_column"
            self.callees[name], count = callee_at_places(Listing(calls[0].function), forms, FOURS)
            self.statements += count
            for number, given in zip(numbers, pointers, strict=True):
                made = f"passed + {LANES * self.places[listing.calls[number].results[0]]}"
                call = f"MADE({self.name}_{name})({', '.join([*given, made])});"
                statements[number].append(Statement(call, []))
        return statements

    def _run_in_columns(self, operands: Sequence[int]) -> OperandRun | None:
        """Find how operands of the code lie in one array; None if they do not."""
        if not any(self.in_column[operand] for operand in operands):
            return self.run_of_numbers(operands)
        if not all(self.in_column[operand] for operand in operands):
            return None
        values = [self.listing.values[operand] for operand in operands]
        entries = [value.entry for value in values if isinstance(value, Read)]
        if len(entries) == len(values):
            return run_of("turns", entries, LANES)
        new = all(isinstance(value, Computed) for value in values)
        if new and self.places.keys().isdisjoint(operands) and len({*operands}) == len(operands):
            for operand in operands:
                self.places[operand] = self._more(1)
        known = [self.places[operand] for operand in operands if operand in self.places]
        return run_of("passed", known, LANES) if len(known) == len(operands) else None

    def _passed_copy(self, statements: list[Statement], operands: Sequence[int]) -> OperandRun:
        """Append statements that copy operands one after the other, and return how the copies lie."""
        first = self._more(len(operands))
        for place, operand in enumerate(operands, first):
            store = "STORE" if self.in_column[operand] else "FILL"
            statements.append(Statement(f"{store}(passed + {LANES * place}, {{0}});", [operand]))
        return run_of("passed", range(first, first + len(operands)), LANES)

    def _text(self, elsewhere: dict[int, int], number: int) -> str | None:
        """Text of a value that is not in a variable of the code; None for a variable."""
        value = self.listing.values[number]
        if number in elsewhere:
            return f"PASSED({LANES * elsewhere[number]})"
        if isinstance(value, Constant):
            return FOURS.number(value.value)
        if not self.in_column[number]:
            return f"w[{self.numbers[number]}]"
        if isinstance(value, Read):
            return f"TURN({LANES * value.entry})"
        return None

    def _more(self, count: int) -> int:
        """Reserve a number of fours and return the place of the first."""
        self.passed += count
        return self.passed - count


def _passed_on(place: int) -> str:
    """Text of the statement that passes four numbers on."""
    return f"STORE(passed + {LANES * place}, {{0}});"
