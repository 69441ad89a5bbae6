"""Functions of scalars in C that compute four intervals of a rod, or four columns of a Jacobian, at once.

Independent calls of one function, such as those for the intervals of a rod, are made four at a time, and so are the
columns of a Jacobian (codegen/columns.py). Each number results from the operations of the function in their order, and
equals CasADi's to the last digit.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.callees_in_c import (
    OperandRun,
    arguments_at_places,
    body,
    callee,
    callee_at_places,
    run_of,
)
from cosserat_casadi.compiling.columns_in_c import ColumnsInC
from cosserat_casadi.compiling.listing import LANES, Called, Computed, Constant, Listing, Read, UnknownOperationError
from cosserat_casadi.compiling.place_tables import ConstantTables
from cosserat_casadi.compiling.printed_kernels import Callee, ColumnForm, Kernel, PlacedCallee, PrintedKernel, in_groups
from cosserat_casadi.compiling.statements import (
    ATOM,
    FOURS,
    LONGEST_OF_NUMBERS,
    SINGLE,
    Arithmetic,
    Block,
    Statement,
    in_parts,
)

FEWEST_GATHERED = 64
"""Numbers from which on a table brings numbers together that lie apart."""

ZERO = 0
"""Place of a zero in the array that a kernel works in, once a table reads it; a one is beside it."""


def scalars_in_c(
    function: ca.Function,
    signature: ca.Function,
    arithmetic: Arithmetic = SINGLE,
    kernels: Mapping[int, PrintedKernel] | None = None,
) -> PrintedKernel:
    """Write a function of scalars in C.

    Args:
        function: the function.
        signature: a function with its name, arguments and first result in C.
        arithmetic: arithmetic of its numbers.
        kernels: kernels that it calls, by the hash of their functions (codegen/shared_values.py).

    Raises:
        UnknownOperationError: there is an operation that has no form here.
    """
    return _Writing(Listing(function), signature, None, arithmetic, kernels or {}).result()


def shared_in_c(function: ca.Function, earlier: Sequence[PrintedKernel], first: int) -> PrintedKernel:
    """Write a kernel in C whose results stay in its work array, which belongs to the kernels that call it.

    Args:
        function: the function of scalars, with one result.
        earlier: kernels of this kind that are called before; their results are its last arguments.
        first: index in the array at which its numbers begin.

    Raises:
        UnknownOperationError: there is an operation that has no form here.
    """
    writing = _Writing(Listing(function), function, None, SINGLE, {}, first)
    writing.inherit(function.n_in() - len(earlier), earlier)
    return writing.result()


def with_calls_in_fours(kernel: ca.Function) -> Kernel:
    """Write a kernel with joint calls of one function; the function itself without such calls or without support."""
    if not kernel.is_a("SXFunction") or not kernel.find_functions(0):
        return kernel
    try:
        return scalars_in_c(kernel, kernel)
    except UnknownOperationError:
        return kernel


def columns_in_fours(
    form: ColumnForm, signature: ca.Function, kernels: Mapping[int, PrintedKernel] | None = None
) -> PrintedKernel:
    """Write a Jacobian by columns in C.

    Args:
        form: the Jacobian.
        signature: a function with its name, arguments and result in C.
        kernels: kernels that it calls, as for :func:`scalars_in_c`.

    Raises:
        UnknownOperationError: there is an operation that has no form here.
    """
    return _Writing(Listing(form.function), signature, form, SINGLE, kernels or {}).result()


@dataclass(frozen=True)
class ColumnedFunction:
    """A function by columns, with its name, arguments and results in C.

    Attributes:
        form: the function.
        signature: the function in CasADi.
    """

    form: ColumnForm
    signature: ca.Function

    @cached_property
    def printed(self) -> PrintedKernel:
        """Write the function in C, which calls no other kernel.

        Raises:
            UnknownOperationError: there is an operation that has no form here.
        """
        return columns_in_fours(self.form, self.signature)


@dataclass(frozen=True)
class _Batch:
    """Calls of one function that are made together.

    Attributes:
        calls: indices of the calls.
        width: number of calls that the code makes at once: LANES, or one.
        operands: number of operands of one call.
        results: number of results of one call.
        made: index of their results in the work array of the kernel.
    """

    calls: tuple[int, ...]
    width: int
    operands: int
    results: int
    made: int

    @property
    def turns(self) -> int:
        """Number of turns of the loop over the calls."""
        return -(-len(self.calls) // self.width)

    def operand_place(self, turn: int, lane: int, operand: int) -> int:
        """Offset of an operand from the first one."""
        return self.width * (turn * self.operands + operand) + lane

    def result_place(self, turn: int, lane: int, result: int) -> int:
        """Offset of a result from the first one."""
        return self.width * (turn * self.results + result) + lane


class _Writing:
    """Writer of a function in C.

    Values that other functions in C read have a place in the work array ``w`` of the kernel; all other values are in
    variables.
    """

    def __init__(
        self,
        listing: Listing,
        signature: ca.Function,
        form: ColumnForm | None,
        arithmetic: Arithmetic,
        kernels: Mapping[int, PrintedKernel],
        first_of_shared: int | None = None,
    ) -> None:
        self.arithmetic = arithmetic
        self.listing = listing
        self.name: str = signature.name()
        self.signature = signature
        self.form = form
        self.callee_names = listing.names_of_callees("")
        self.kernels = {hash(call.function): kernels.get(hash(call.function)) for call in listing.calls}
        self.is_shared = first_of_shared is not None
        called = [kernel.reals for kernel in self.kernels.values() if kernel is not None]
        self.reals = max(called, default=first_of_shared or ZERO + 2)
        self.tables = ConstantTables()
        self.place: dict[int, int] = {}
        self.in_column = self._in_column()
        self.batch_of = self._batches()
        # A call has read its operands before those of the next one are written.
        batches = [batch for batch in self.batch_of.values() if self._kernel(batch.calls) is None]
        most_given = (batch.width * batch.turns * batch.operands for batch in batches)
        self.given = self._room(max(most_given, default=0))
        self.given_to_columns = self._given_to_columns()
        for value in self.given_to_columns:
            self.place.setdefault(value, self._room(1))
        self.columns = 0 if form is None else self._room(form.rows * form.stride)
        self.main = Block("casadi_real", "a", [])
        self.done: set[int | tuple[int, ...]] = set()
        self.functions: list[str] = []
        self.column_functions: dict[str, str] = {}
        self.callees: dict[str, Callee | PlacedCallee] = {}
        self.statements = 0

    def inherit(self, argument: int, kernels: Sequence[PrintedKernel]) -> None:
        """Read arguments, from an index on, from the places where these kernels leave them."""
        for number, value in enumerate(self.listing.values):
            if isinstance(value, Read) and value.argument >= argument:
                self.place[number] = kernels[value.argument - argument].places[value.entry]
                self.done.add(number)

    def result(self) -> PrintedKernel:
        """The kernel."""
        self._write_callees()
        for value in self.given_to_columns:
            self._compute(value)
        if self.form is not None:
            self._write_columns(self.form)
        if self.is_shared:
            self._keep_results()
        else:
            self._write_results()
        self._write_main()
        return PrintedKernel(
            self.signature,
            self.tables.by_name,
            "\n".join(self.functions),
            self.callees,
            self.reals,
            self.statements,
            columns=self.column_functions,
            kernels=tuple(kernel for kernel in self.kernels.values() if kernel is not None),
            places=self._places_of_results() if self.is_shared else (),
        )

    def _write_main(self) -> None:
        """Write the function itself, as a sequence of functions if it is long."""
        given = "const casadi_real **arg, casadi_real **res, casadi_real *w"
        # Values that parts pass on stand behind all others.
        parts, passed = in_parts(
            self.main.statements, LONGEST_OF_NUMBERS, lambda place: f"w[{place}] = {{0}};", self.place, self.reals
        )
        self._room(passed)
        lines = []
        for k, part in enumerate(parts):
            block = Block(self.main.type, self.main.letter, part.statements)
            lines = block.lines(partial(self._text_in_part, part.passed))
            self.statements += len(part.statements)
            if len(parts) > 1:
                self.functions.append(f"static void MADE({self.name}_part_{k})({given}){body(lines)}")
        if len(parts) > 1:
            lines = [f"  MADE({self.name}_part_{k})(arg, res, w);" for k in range(len(parts))]
        head = f"static int MADE({self.name})({given}) {{"
        self.functions.append("\n".join([head, *lines, "  return 0;", "}\n"]))

    def _text_in_part(self, elsewhere: dict[int, int], number: int) -> str | None:
        """Text of a value without columns that is not in a variable of a part."""
        return f"w[{elsewhere[number]}]" if number in elsewhere else self._text(number)

    def _room(self, count: int) -> int:
        """Reserve so many numbers in the work array; return the first index."""
        self.reals += count
        return self.reals - count

    # What belongs where

    def _in_column(self) -> list[bool]:
        """Mask of the values that depend on the column."""
        found: list[bool] = []
        for number, value in enumerate(self.listing.values):
            of_turns = (
                self.form is not None and isinstance(value, Read) and value.argument == self.form.columns_argument + 1
            )
            found.append(of_turns or any(found[operand] for operand in self.listing.operands(number)))
        return found

    def _given_to_columns(self) -> list[int]:
        """Values without columns that operations on columns read."""
        given: dict[int, None] = {}
        for number, in_column in enumerate(self.in_column):
            if in_column:
                given |= dict.fromkeys(self.listing.operands(number))
        return [value for value in given if not self.in_column[value] and not self._is_constant(value)]

    def _batches(self) -> dict[int, _Batch]:
        """Batches of all calls: a batch consists of calls of one function with equal depth in the chain of calls."""
        depth = self._depths()
        groups: dict[tuple[int, int], list[int]] = defaultdict(list)
        for number, call in enumerate(self.listing.calls):
            if not self.in_column[call.results[0]]:
                groups[hash(call.function), depth[call.results[0]]].append(number)
        batches: dict[int, _Batch] = {}
        for calls in groups.values():
            call = self.listing.calls[calls[0]]
            kernel = self._kernel(calls)
            together = self.arithmetic.together
            alone = kernel is not None or self._reads_constants(calls)
            width = LANES if together is not None and len(calls) >= together and not alone else 1
            batch = _Batch(tuple(calls), width, len(call.operands), len(call.results), self.reals)
            batches |= dict.fromkeys(calls, batch)
            if kernel is not None:
                self.place |= zip(call.results, kernel.places, strict=True)
                continue
            self._room(width * batch.turns * batch.results)
            self._place_results(batch)
        return batches

    def _reads_constants(self, calls: Sequence[int]) -> bool:
        """Whether an argument is constant numbers in all calls of a function: they stay where they lie."""
        arguments = zip(*(self.listing.calls[number].arguments for number in calls), strict=True)
        return any(all(own and all(map(self._is_constant, own)) for own in of_calls) for of_calls in arguments)

    def _depths(self) -> list[int]:
        """Depth of each value: most calls on a way to it, its own call included.

        Kernels that are shared do not count: a call that waits for more of them is made together with the others.
        """
        depths: list[int] = []
        for number, value in enumerate(self.listing.values):
            depth = max((depths[operand] for operand in self.listing.operands(number)), default=0)
            counts = isinstance(value, Called) and self.kernels[hash(self.listing.calls[value.call].function)] is None
            depths.append(depth + counts)
        return depths

    def _place_results(self, batch: _Batch) -> None:
        for k, number in enumerate(batch.calls):
            turn, lane = divmod(k, batch.width)
            for i, result in enumerate(self.listing.calls[number].results):
                self.place[result] = batch.made + batch.result_place(turn, lane, i)

    def _is_constant(self, number: int) -> bool:
        return isinstance(self.listing.values[number], Constant)

    # What has no columns

    def _compute(self, root: int) -> None:
        """Append the missing operands of a value without columns, then the value."""
        waiting = [root]
        while waiting:
            number = waiting[-1]
            if self._is_there(number):
                waiting.pop()
                continue
            missing = [need for need in self._needs(number) if not self._is_there(need)]
            if missing:
                waiting += missing[::-1]
                continue
            waiting.pop()
            self.done.add(self._known_by(number))
            self._append(number)

    def _known_by(self, number: int) -> int | tuple[int, ...]:
        """Key under which a value is marked as computed: its batch of calls, or its number."""
        value = self.listing.values[number]
        return self.batch_of[value.call].calls if isinstance(value, Called) else number

    def _is_there(self, number: int) -> bool:
        return self._is_constant(number) or self._known_by(number) in self.done

    def _needs(self, number: int) -> Sequence[int]:
        value = self.listing.values[number]
        if not isinstance(value, Called):
            return self.listing.operands(number)
        batch = self.batch_of[value.call]
        if self._kernel(batch.calls) is not None:
            # It reads the arguments of this kernel.
            operands = self.listing.calls[value.call].operands
            return [operand for operand in operands if isinstance(self.listing.values[operand], Called)]
        return [operand for call in batch.calls for operand in self.listing.calls[call].operands]

    def _append(self, number: int) -> None:
        """Append the statements of a value whose operands are available."""
        value = self.listing.values[number]
        if isinstance(value, Called):
            self._append_calls(self.batch_of[value.call])
            return
        if self._is_of_all_columns(number):
            return
        if isinstance(value, Read):
            entry = f"ENTRY({value.argument}, {value.entry})"
            self.main.statements.append(Statement(entry, [], number, ATOM))
        elif isinstance(value, Computed):
            self.main.statements.append(self.arithmetic.operation(value.operation, value.operands, number))
        if number in self.place:
            self.main.statements.append(Statement(f"w[{self.place[number]}] = {{0}};", [number]))

    def _kernel(self, calls: Sequence[int]) -> PrintedKernel | None:
        """Return the kernel that calls of one function call, if any."""
        return self.kernels[hash(self.listing.calls[calls[0]].function)]

    def _append_calls(self, batch: _Batch) -> None:
        kernel = self._kernel(batch.calls)
        if kernel is not None:
            # It works in the array in which earlier kernels left its arguments.
            self.main.statements.append(Statement(f"MADE({kernel.name()})(arg, res, w);", []))
            return
        if self._reads_places(batch):
            self._append_calls_at_places(batch)
            return
        operands = [0] * (batch.width * batch.turns * batch.operands)
        for k in range(batch.width * batch.turns):
            turn, lane = divmod(k, batch.width)
            # Surplus lanes repeat the last call.
            call = self.listing.calls[batch.calls[min(k, len(batch.calls) - 1)]]
            for i, operand in enumerate(call.operands):
                operands[batch.operand_place(turn, lane, i)] = operand
        places = [self._place_of(operand) for operand in operands]
        gathered = self._is_worth_gathering(places)
        for place, operand in enumerate(operands):
            if places[place] is None or not gathered:
                self.main.statements.append(Statement(f"w[{self.given + place}] = {{0}};", [operand]))
        if gathered:
            # Numbers that have no place but this one stay in it.
            sources = [self.given + i if place is None else place for i, place in enumerate(places)]
            self._append_gathering(f"w + {self.given}", sources)
        name = self._callee_name(self.listing.calls[batch.calls[0]].function, batch.width)
        call = f"MADE({self.name}_{name})(w + {self.given}, w + {batch.made}, {batch.turns});"
        self.main.statements.append(Statement(call, []))

    def _reads_places(self, batch: _Batch) -> bool:
        """Whether calls, each of which is made alone, read numbers where they lie."""
        return batch.width == 1 and self.arithmetic is SINGLE

    def _append_calls_at_places(self, batch: _Batch) -> None:
        """Append calls, one after the other, that read their operands where they lie."""
        calls = [self.listing.calls[number] for number in batch.calls]

        def copied(operands: Sequence[int]) -> OperandRun:
            first = self._room(len(operands))
            for place, operand in enumerate(operands, first):
                self.main.statements.append(Statement(f"w[{place}] = {{0}};", [operand]))
            return run_of("w", range(first, first + len(operands)), 1)

        pointers, forms = arguments_at_places(calls, self._run_of_numbers, [copied] * len(calls))
        name = self._callee_name(calls[0].function, 1)
        written, statements = callee_at_places(Listing(calls[0].function), forms, SINGLE)
        # Arguments that lie in another way are read by another function.
        while self.callees.get(name, written) != written:
            name += "_further"
        self.statements += 0 if name in self.callees else statements
        self.callees[name] = written
        for k, given in enumerate(pointers):
            made = f"w + {batch.made + k * batch.results}"
            self.main.statements.append(Statement(f"MADE({self.name}_{name})({', '.join([*given, made])});", []))

    def _run_of_numbers(self, operands: Sequence[int]) -> OperandRun | None:
        """How numbers lie in a table, or in the array that the kernel works in; None where some have no place there."""
        values = [self.listing.values[operand] for operand in operands]
        constants = [value.value for value in values if isinstance(value, Constant)]
        if len(constants) == len(values):
            return OperandRun(lambda: self.tables.of_numbers(constants), (False, tuple(range(len(values)))))
        places = [self.place.get(operand) for operand in operands]
        known = [place for place in places if place is not None]
        return run_of("w", known, 1) if len(known) == len(places) else None

    def _write_results(self) -> None:
        """Append the entries of all results; the pointer of one of several results may be null."""
        count = self.signature.n_out()
        for result in range(count):
            entries = self.listing.outputs[result]
            may_be_absent = count > 1
            asked = f"if (res[{result}]) " if may_be_absent else ""
            count_of_entries = self.listing.function.nnz_out(result)
            places = [self._place_of(entries[i]) if i in entries else ZERO for i in range(count_of_entries)]
            gathered = self._is_worth_gathering(places)
            if gathered:
                for entry, number in entries.items():
                    if places[entry] is not None:
                        self._compute(number)
                # Values without a place are appended.
                sources = [ZERO if place is None else place for place in places]
                self._append_gathering(f"res[{result}]", sources, asked)
            for entry, place in enumerate(places):
                if gathered and place is not None:
                    continue
                text = f"{asked}res[{result}][{entry}] = "
                if entry not in entries:
                    self.main.statements.append(Statement(f"{text}{self.arithmetic.number(0.0)};", []))
                    continue
                self._compute(entries[entry])
                self.main.statements.append(Statement(f"{text}{{0}};", [entries[entry]], asked=may_be_absent))

    def _place_of(self, number: int) -> int | None:
        """Where a value is in the array, if it has a place there: zero and one have the first two."""
        value = self.listing.values[number]
        if isinstance(value, Constant) and value.value in (0.0, 1.0):
            return ZERO + int(value.value)
        if isinstance(value, Read) and self._is_of_all_columns(number):
            return self.columns + value.entry
        return self.place.get(number)

    def _is_worth_gathering(self, places: Sequence[int | None]) -> bool:
        """Whether numbers are brought together by a table of their places."""
        lying = sum(place not in (None, ZERO, ZERO + 1) for place in places)
        return self.arithmetic is SINGLE and lying >= max(FEWEST_GATHERED, len(places) // 2)

    def _append_gathering(self, to: str, places: Sequence[int], asked: str = "") -> None:
        """Append a statement that brings the numbers at these places together."""
        for constant in {ZERO, ZERO + 1} & {*places}:
            self.main.statements.append(Statement(f"w[{constant}] = {constant - ZERO};", []))
        table = self.tables.of_places(np.array(places, dtype=np.int64)[:, None])
        self.main.statements.append(Statement(f"{asked}program_gather({to}, w, {table});", []))

    def _keep_results(self) -> None:
        """Append the entries of the single result, each at a separate place of the work array."""
        kept = self.listing.outputs[0].values()
        for number in kept:
            if number not in self.place:
                self.place[number] = self._room(1)
        for number in kept:
            self._compute(number)
            if self._is_constant(number):
                self.main.statements.append(Statement(f"w[{self.place[number]}] = {{0}};", [number]))

    def _places_of_results(self) -> tuple[int, ...]:
        entries = self.listing.outputs[0]
        return tuple(self.place[entries[entry]] for entry in range(len(entries)))

    def _is_of_all_columns(self, number: int) -> bool:
        value = self.listing.values[number]
        return self.form is not None and isinstance(value, Read) and value.argument == self.form.columns_argument

    def _text(self, number: int) -> str | None:
        """Text of a value without columns that is not in a variable."""
        value = self.listing.values[number]
        if isinstance(value, Constant):
            return self.arithmetic.number(value.value)
        if isinstance(value, Called):
            return f"w[{self.place[number]}]"
        if isinstance(value, Read) and self._is_of_all_columns(number):
            return f"w[{self.columns + value.entry}]"
        return None

    # Functions that are called

    def _callee_name(self, function: ca.Function, width: int) -> str:
        return f"{self.callee_names[hash(function)]}{'s' if width == LANES else ''}"

    def _write_callees(self) -> None:
        for batch in self.batch_of.values():
            function = self.listing.calls[batch.calls[0]].function
            name = self._callee_name(function, batch.width)
            if name in self.callees or self._kernel(batch.calls) is not None or self._reads_places(batch):
                continue
            arithmetic = FOURS if batch.width == LANES else self.arithmetic
            self.callees[name], statements = callee(Listing(function), arithmetic)
            self.statements += statements

    def _write_columns(self, form: ColumnForm) -> None:
        """Write what computes four columns, and append its call."""
        turns = f"arg[{form.columns_argument - 1}] + {form.turns_behind}"
        if form.turns_behind is None:
            turns = self.tables.of_numbers(in_groups(form.turns).tolist())
        columns = ColumnsInC(self.listing, form, self.name, self.in_column, self.place, self._run_of_numbers)
        name = f"{self.name}_columns"
        self.column_functions[name] = columns.text(name)
        self.callees |= columns.callees
        self.statements += columns.statements
        room = self._room(LANES * columns.passed)
        given = f"w, {turns}, w + {self.columns}, w + {room}, {form.stride // LANES}"
        self.main.statements.append(Statement(f"MADE({name})({given});", []))
