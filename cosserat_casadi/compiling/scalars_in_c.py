"""Functions of scalars in C that compute four intervals of a rod, or four columns of a Jacobian, at once.

Independent calls of one function, such as those for the intervals of a rod, are made four at a time, and so are the
columns of a Jacobian (codegen/columns.py). Each number results from the operations of the function in their order, and
equals CasADi's to the last digit.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import casadi as ca

from cosserat_casadi.compiling.listing import (
    LANES,
    Called,
    Computed,
    Constant,
    Listing,
    Read,
    UnknownOperationError,
)
from cosserat_casadi.compiling.printed_kernels import (
    CALL_OF_COLUMNS,
    COLUMNS,
    PART_OF_COLUMNS,
    Callee,
    ColumnForm,
    ConstantTable,
    Kernel,
    PrintedKernel,
    in_groups,
)
from cosserat_casadi.compiling.statements import (
    ATOM,
    FOURS,
    LONGEST,
    LONGEST_OF_NUMBERS,
    SINGLE,
    Arithmetic,
    Block,
    Statement,
    computations,
    in_parts,
    number_in_c,
)


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
        self.reals = max(called, default=first_of_shared or 0)
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
        self.callees: dict[str, Callee] = {}
        self.statements = 0

    def inherit(self, argument: int, kernels: Sequence[PrintedKernel]) -> None:
        """Read arguments, from an index on, from the places where these kernels leave them."""
        for number, value in enumerate(self.listing.values):
            if isinstance(value, Read) and value.argument >= argument:
                self.place[number] = kernels[value.argument - argument].places[value.entry]
                self.done.add(number)

    def result(self) -> PrintedKernel:
        """Return the kernel."""
        tables = {}
        self._write_callees()
        for value in self.given_to_columns:
            self._compute(value)
        if self.form is not None:
            if self.form.turns_behind is None:
                numbers = tuple(f"{value:.17g}" for value in in_groups(self.form.turns))
                tables["turns"] = ConstantTable("casadi_real", numbers)
            self._write_columns(self.form)
        if self.is_shared:
            self._keep_results()
        else:
            self._write_results()
        self._write_main()
        body = "\n".join(self.functions)
        return PrintedKernel(
            self.signature,
            tables,
            body,
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
        # What one of them passes on to others stands behind all else.
        first = self.reals
        parts, passed = in_parts(
            self.main.statements, LONGEST_OF_NUMBERS, lambda place: f"w[{first + place}] = {{0}};", self.place
        )
        self._room(passed)
        lines = []
        for k, part in enumerate(parts):
            elsewhere = {value: first + place for value, place in part.passed.items()}
            made = {statement.made for statement in part.statements}
            elsewhere |= {value: place for value, place in self.place.items() if value not in made}
            block = Block(self.main.type, self.main.letter, part.statements)
            lines = block.lines(partial(self._text_in_part, elsewhere))
            self.statements += len(part.statements)
            if len(parts) > 1:
                self.functions.append(f"static void MADE({self.name}_part_{k})({given}){_body(lines)}")
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
            groups[hash(call.function), depth[call.results[0]]].append(number)
        batches: dict[int, _Batch] = {}
        for calls in groups.values():
            call = self.listing.calls[calls[0]]
            kernel = self._kernel(calls)
            together = self.arithmetic.together
            width = LANES if together is not None and len(calls) >= together and kernel is None else 1
            batch = _Batch(tuple(calls), width, len(call.operands), len(call.results), self.reals)
            batches |= dict.fromkeys(calls, batch)
            if kernel is not None:
                self.place |= zip(call.results, kernel.places, strict=True)
                continue
            self._room(width * batch.turns * batch.results)
            self._place_results(batch)
        return batches

    def _depths(self) -> list[int]:
        """Depth of each value: largest number of calls in a chain that ends with it, itself included."""
        depths: list[int] = []
        for number, value in enumerate(self.listing.values):
            depth = max((depths[operand] for operand in self.listing.operands(number)), default=0)
            depths.append(depth + 1 if isinstance(value, Called) else depth)
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
            # It works in the same array, in which kernels before have left what it reads.
            self.main.statements.append(Statement(f"MADE({kernel.name()})(arg, res, w);", []))
            return
        for k in range(batch.width * batch.turns):
            turn, lane = divmod(k, batch.width)
            # Lanes that are left over compute what the last call does.
            call = self.listing.calls[batch.calls[min(k, len(batch.calls) - 1)]]
            for i, operand in enumerate(call.operands):
                place = self.given + batch.operand_place(turn, lane, i)
                self.main.statements.append(Statement(f"w[{place}] = {{0}};", [operand]))
        name = self._callee_name(self.listing.calls[batch.calls[0]].function, batch.width)
        call = f"MADE({self.name}_{name})(w + {self.given}, w + {batch.made}, {batch.turns});"
        self.main.statements.append(Statement(call, []))

    def _write_results(self) -> None:
        """Append the entries of all results; the pointer of one of several results may be null."""
        count = self.signature.n_out()
        for result in range(count):
            entries = self.listing.outputs[result]
            may_be_absent = count > 1
            asked = f"if (res[{result}]) " if may_be_absent else ""
            for entry in range(self.listing.function.nnz_out(result)):
                place = f"res[{result}][{entry}]"
                if entry in entries:
                    self._compute(entries[entry])
                    stored = Statement(f"{asked}{place} = {{0}};", [entries[entry]], asked=may_be_absent)
                    self.main.statements.append(stored)
                else:
                    self.main.statements.append(Statement(f"{asked}{place} = {self.arithmetic.number(0.0)};", []))

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
        wanted = {}
        for batch in self.batch_of.values():
            if self._kernel(batch.calls) is not None:
                continue
            function = self.listing.calls[batch.calls[0]].function
            wanted[self._callee_name(function, batch.width)] = (function, batch.width)
        for name, (function, width) in wanted.items():
            arithmetic = FOURS if width == LANES else self.arithmetic
            self.callees[name], statements = callee(Listing(function), arithmetic)
            self.statements += statements

    # Columns

    def _write_columns(self, form: ColumnForm) -> None:
        """Write the code for four columns, in parts that pass values on, and append its calls."""
        statements = self._statements_of_columns(form)
        parts, passed = in_parts(statements, LONGEST, lambda place: f"STORE(passed + {LANES * place}, {{0}});")
        room = self._room(LANES * passed)
        name = f"{self.name}_columns"
        calls = []
        functions = []
        for k, part in enumerate(parts):
            block = Block("FOUR", "b", part.statements)
            body = _body(block.lines(partial(self._text_in_columns, part.passed)))
            functions.append(PART_OF_COLUMNS.format(name=name, part=k, body=body))
            calls.append(CALL_OF_COLUMNS.format(name=name, part=k))
            self.statements += len(block.statements)
        listed = "\n".join(calls)
        functions.append(COLUMNS.format(name=name, turns=LANES * len(form.turns), calls=listed))
        self.column_functions[name] = "\n".join(functions)
        turns = "TABLE(turns)"
        start = 0
        if form.turns_behind is not None:
            turns = f"arg[{form.columns_argument - 1}]"
            start = form.turns_behind
        given = f"w, {turns} + {start}, w + {self.columns}, w + {room}, {form.stride // LANES}"
        self.main.statements.append(Statement(f"MADE({name})({given});", []))

    def _statements_of_columns(self, form: ColumnForm) -> list[Statement]:
        statements = []
        for number, value in enumerate(self.listing.values):
            if self.in_column[number] and not isinstance(value, Read):
                if not isinstance(value, Computed):
                    raise UnknownOperationError("a call in a column")
                statements.append(FOURS.operation(value.operation, value.operands, number))
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

    def _text_in_columns(self, elsewhere: dict[int, int], number: int) -> str | None:
        """Text of a value that is not in a variable of the code for columns."""
        value = self.listing.values[number]
        if number in elsewhere:
            return f"PASSED({LANES * elsewhere[number]})"
        if isinstance(value, Constant):
            return FOURS.number(value.value)
        if not self.in_column[number]:
            return f"w[{self.place[number]}]"
        if isinstance(value, Read):
            return f"TURN({LANES * value.entry})"
        return None


def callee(listing: Listing, arithmetic: Arithmetic) -> tuple[Callee, int]:
    """Write a function that kernels call; also return its number of statements.

    Args:
        listing: the values of the function.
        arithmetic: FOURS for four calls at once, or arithmetic of single numbers.

    Raises:
        UnknownOperationError: an operation is not supported, or the function calls another one.
    """
    function = listing.function
    if listing.calls:
        raise UnknownOperationError(f"a call in {function.name()}, which is called itself")
    wide = arithmetic is FOURS
    width = LANES if wide else 1
    arguments = _starts(function.nnz_in(i) for i in range(function.n_in()))
    results = _starts(function.nnz_out(i) for i in range(function.n_out()))
    type_and_letter = ("FOUR", "b") if wide else ("casadi_real", "a")
    block = Block(*type_and_letter, computations(listing, arithmetic))
    for start, entries in zip(results, listing.outputs, strict=True):
        for entry, number in entries.items():
            place = width * (start + entry)
            value = listing.values[number]
            if wide and isinstance(value, Constant):
                block.statements.append(Statement(f"FILL(made + {place}, {number_in_c(value.value)});", []))
                continue
            store = f"STORE(made + {place}, {{0}});" if wide else f"made[{place}] = {{0}};"
            block.statements.append(Statement(store, [number]))

    def text(number: int) -> str | None:
        value = listing.values[number]
        if isinstance(value, Constant):
            return arithmetic.number(value.value)
        if isinstance(value, Read):
            place = width * (arguments[value.argument] + value.entry)
            return f"GIVEN({place})" if wide else f"given[{place}]"
        return None

    return Callee(_body(block.lines(text)), width, function.nnz_in(), function.nnz_out()), len(block.statements)


def _body(lines: Iterable[str]) -> str:
    """Write the body of a function."""
    return "\n".join([" {", *lines, "}\n"])


def _starts(sizes: Iterable[int]) -> list[int]:
    """Start indices of consecutive vectors."""
    starts = []
    total = 0
    for size in sizes:
        starts.append(total)
        total += size
    return starts
