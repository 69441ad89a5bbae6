"""A program (numbered.py) as C: loops over tables, products of matrices, and functions of intervals four at a time.

A kernel works in an array ``w``. Its first number is zero; every argument and every result of a step has a place in it,
which later results may reuse. A step reads its operands in place; scattered entries are gathered first, by a table.
Operations on equal numbers of entries, such as those of the sections of a rod, are one loop, whose turns keep values
that only they read in variables. Small steps are written together without loops. Independent calls of one function are
made four at a time.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.callees_in_c import callee
from cosserat_casadi.compiling.listing import FEWEST, LANES, Constant, Listing, Read, UnknownOperationError
from cosserat_casadi.compiling.numbered import SMALL, Numbers, Program, Step, Value
from cosserat_casadi.compiling.place_tables import ConstantTables
from cosserat_casadi.compiling.printed_kernels import Callee, PrintedKernel
from cosserat_casadi.compiling.products import Product, column_groups
from cosserat_casadi.compiling.scalars_in_c import scalars_in_c
from cosserat_casadi.compiling.statements import (
    FOURS,
    LONGEST_OF_NUMBERS,
    SINGLE,
    Block,
    Statement,
    computations,
    in_parts,
)
from cosserat_casadi.compiling.steps import program_of

LONGEST_BUNDLE = 3000
"""Most instructions of small steps that are written together."""

FEWEST_TURNS = 5
"""Least number of entries of an entrywise operation that is written as a loop."""

LONGEST_PRODUCT_WITHOUT_LOOP = 40
"""Most instructions of a product of matrices that is written without a loop."""

LOOP_IN_FOURS = """static void MADE({name})(casadi_real *w) {{
  FOR_FOURS(i, {count}) {{
{lines}
  }}
}}
"""
"""Template of a loop over entries, four at a time; the last four may compute some entries again."""

LOOP = """static void MADE({name})(casadi_real *w) {{
  int i;
  for (i = 0; i < {count}; i++) {{
{lines}
  }}
}}
"""
"""Template of a loop over entries, one at a time, if some operation has no form for four numbers."""

UNUSED = -1
"""Place of an entry without a place."""


class UnitKind(Enum):
    """Kinds of pieces of C for steps."""

    STRAIGHT = "small steps without a loop"
    LOOP = "operations on as many entries, in one loop"
    CALLS = "calls of a function of scalars that calls no other"
    SINGLE = "one step"


@dataclass
class Unit:
    """Steps that are written as one piece of C.

    Attributes:
        kind: kind of the piece.
        steps: the steps.
    """

    kind: UnitKind
    steps: list[Step]

    @property
    def operands(self) -> list[Numbers]:
        """Entries of the operands of all steps."""
        return [operand.numbers for step in self.steps for operand in step.operands]


class RoomOfKernel:
    """The work array of a kernel, in which free places are reused before the array grows."""

    def __init__(self, size: int) -> None:
        self.size = size
        self._free: list[tuple[int, int]] = []

    def take(self, count: int) -> int:
        """Reserve ``count`` consecutive places; return the first."""
        for k, (first, room) in enumerate(self._free):
            if room >= count:
                self._free[k : k + 1] = [(first + count, room - count)] if room > count else []
                return first
        self.size += count
        return self.size - count

    def give_back(self, first: int, count: int) -> None:
        """Free ``count`` consecutive places."""
        if not count:
            return
        self._free.append((first, count))
        self._free.sort()
        joined: list[tuple[int, int]] = []
        for begin, room in self._free:
            if joined and sum(joined[-1]) == begin:
                joined[-1] = (joined[-1][0], joined[-1][1] + room)
            else:
                joined.append((begin, room))
        self._free = joined


def program_in_c(program: Program, signature: ca.Function) -> PrintedKernel:
    """Write a program in C.

    Args:
        program: the program.
        signature: a function with its name, arguments and results in C.

    Raises:
        UnknownOperationError: there is an operation that has no form in C.
    """
    return _Writing(program, signature).result()


class _Writing:
    """Writer of a program in C."""

    def __init__(self, program: Program, signature: ca.Function) -> None:
        self.program = program
        self.origins = program.origins
        self.signature = signature
        self.name: str = signature.name()
        self.tables = ConstantTables()
        self.lines: list[str] = []
        self.functions: list[str] = []
        self.loops: dict[str, str] = {}
        self.callees: dict[str, Callee] = {}
        self.callee_of: dict[tuple[int, int], str] = {}
        self.products: dict[Product, None] = {}
        self.kernels: dict[str, PrintedKernel] = {}
        self.statements = 0
        self.place = np.full(self.origins.count, UNUSED, dtype=np.int64)
        self.place[0] = 0
        self.memory = RoomOfKernel(1)
        self.units = _units(program)
        self.last_use = self._last_uses()
        self.blocks_until: dict[int, list[tuple[int, int]]] = defaultdict(list)
        self.gathered: dict[bytes, int] = {}
        self.operands = [self._operands_of(unit) for unit in self.units]
        self.gathered_until = {numbers.tobytes(): k for k, read in enumerate(self.operands) for numbers in read}

    def result(self) -> PrintedKernel:
        """Return the kernel."""
        self._write_arguments()
        self._write_constants()
        for k, unit in enumerate(self.units):
            self._write_unit(k, unit)
            for first, count in self.blocks_until.pop(k, []):
                self.memory.give_back(first, count)
        self._write_results()
        head = f"static int MADE({self.name})(const casadi_real **arg, casadi_real **res, casadi_real *w) {{"
        self.functions.append("\n".join([head, *self.lines, "  return 0;", "}\n"]))
        return PrintedKernel(
            self.signature,
            self.tables.by_name,
            "\n".join(self.functions),
            self.callees,
            self.memory.size,
            self.statements,
            loops=self.loops,
            is_program=True,
            products=tuple(self.products),
            kernels=tuple(self.kernels.values()),
        )

    # What is read and written

    def _write_arguments(self) -> None:
        """Copy the arguments; a zero one may be a null pointer, and the pieces of one are consecutive."""
        for number, argument in enumerate(self.program.arguments):
            count = sum(len(piece.numbers) for piece in argument.pieces)
            if not count:
                continue
            first = self.memory.take(count)
            self.lines.append(f"  program_read(w + {first}, arg[{number}], {count});")
            for piece in argument.pieces:
                self.place[piece.numbers] = np.arange(first, first + len(piece.numbers))
                first += len(piece.numbers)

    def _write_constants(self) -> None:
        """Copy the constants that a table gathers together with results of steps to the work array."""
        mixed: dict[int, None] = {}
        wanted = [value.numbers for value in self.program.results.values()]
        for operands in self.operands:
            wanted += [numbers for numbers in operands if not np.all(self.origins.is_constant(numbers))]
        for numbers in wanted:
            constant = self.origins.is_constant(numbers)
            mixed |= dict.fromkeys(numbers[constant & (numbers != 0)].tolist())
        if mixed:
            numbers = np.array(list(mixed), dtype=np.int64)
            values = self.origins.constants(numbers)
            first = self.memory.take(len(values))
            self.place[numbers] = np.arange(first, first + len(values))
            self.lines.append(f"  program_read(w + {first}, {self.tables.of_numbers(values)}, {len(values)});")
        self.lines.insert(0, "  w[0] = 0;")

    def _write_results(self) -> None:
        for number, value in enumerate(self.program.results.values()):
            asked = f"  if (res[{number}]) " if self.signature.n_out() > 1 else "  "
            places = self.place[value.numbers]
            if len(places):
                self.lines.append(f"{asked}{self._moved(f'res[{number}]', places)}")

    def _moved(self, to: str, places: Numbers) -> str:
        """Write the statement that gathers entries."""
        if np.all(np.diff(places) == 1):
            return f"program_read({to}, w + {places[0]}, {len(places)});"
        return f"program_gather({to}, w, {self.tables.of_places(places[:, None])});"

    def _pointer(self, numbers: Numbers) -> str:
        """Pointer to consecutive entries; scattered entries are gathered first."""
        if np.all(self.origins.is_constant(numbers)):
            values = self.origins.constants(numbers)
            return self.tables.of_numbers(values)
        places = self.place[numbers]
        if np.all(np.diff(places) == 1):
            return f"w + {places[0]}"
        key = numbers.tobytes()
        if key not in self.gathered:
            first = self.memory.take(len(numbers))
            self.blocks_until[self.gathered_until[key]].append((first, len(numbers)))
            self.lines.append(f"  {self._moved(f'w + {first}', places)}")
            self.gathered[key] = first
        return f"w + {self.gathered[key]}"

    def _place_things(self, k: int, numbers: Numbers) -> int:
        """Give entries consecutive places until their last use; return the first place."""
        first = self.memory.take(len(numbers))
        self.place[numbers] = np.arange(first, first + len(numbers))
        self._free_after(k, numbers, first, len(numbers))
        return first

    def _free_after(self, k: int, numbers: Numbers, first: int, count: int) -> None:
        self.blocks_until[max(self._last_use_of(numbers), k)].append((first, count))

    # Lifetimes

    def _last_use_of(self, numbers: Numbers) -> int:
        """Index of the last unit that reads any of these entries."""
        return max((self.last_use[owner] for owner in self.origins.holders(numbers)), default=UNUSED)

    def _last_uses(self) -> dict[int, int]:
        """Index of the last unit that reads each thing."""
        last: dict[int, int] = defaultdict(lambda: UNUSED)
        for k, unit in enumerate(self.units):
            for owner in self.origins.holders(_joined(unit.operands)):
                last[owner] = k
        for value in self.program.results.values():
            for owner in self.origins.holders(value.numbers):
                last[owner] = len(self.units)
        return last

    def _operands_of(self, unit: Unit) -> list[Numbers]:
        """Entries of each array that a unit reads; empty for steps without a loop, which read numbers one by one."""
        if unit.kind is UnitKind.STRAIGHT:
            return []
        if unit.kind is UnitKind.CALLS:
            return [self._given(unit)]
        if unit.kind is UnitKind.LOOP:
            inside = {result.numbers.tobytes() for step in unit.steps for result in step.results}
            return [numbers for numbers in unit.operands if len(numbers) > 1 and numbers.tobytes() not in inside]
        return unit.operands

    # Units

    def _write_unit(self, k: int, unit: Unit) -> None:
        if unit.kind is UnitKind.STRAIGHT:
            self._write_bundle(k, unit.steps)
        elif unit.kind is UnitKind.LOOP:
            self._write_loop(k, unit.steps)
        elif unit.kind is UnitKind.CALLS:
            self._write_calls(k, unit)
        elif unit.steps[0].called:
            self._write_kernel(k, unit.steps[0])
        else:
            self._write_product(k, unit.steps[0])

    def _write_loop(self, k: int, steps: Sequence[Step]) -> None:
        """Write a loop over the entries that the steps compute."""
        count = len(steps[0].results[0].numbers)
        kept = [step.results[0].numbers for step in steps if self._last_use_of(step.results[0].numbers) > k]
        listing, operands_read = self._turn_of_loop(steps, kept)
        in_fours = count >= LANES and listing.has_fours
        arithmetic = FOURS if in_fours else SINGLE
        variables = ("FOUR", "b") if in_fours else ("casadi_real", "a")
        block = Block(*variables, computations(listing, arithmetic))
        for numbers, number in zip(kept, listing.outputs[0].values(), strict=True):
            place = self._place_things(k, numbers)
            if not in_fours:
                store = f"w[{place} + i] = {{0}};"
            elif isinstance(listing.values[number], Constant):
                store = f"FILL(w + {place} + i, {{0}});"
            else:
                store = f"STORE(w + {place} + i, {{0}});"
            block.statements.append(Statement(store, [number]))
        operands = [self._operand_of_loop(numbers, in_fours) for numbers in operands_read]

        def text(number: int) -> str | None:
            value = listing.values[number]
            if isinstance(value, Constant):
                return arithmetic.number(value.value)
            return operands[value.entry] if isinstance(value, Read) else None

        name = f"{self.name}_loop_{len(self.loops) + len(self.functions)}"
        lines = "\n".join(f"  {line}" for line in block.lines(text))
        if in_fours:
            self.loops[name] = LOOP_IN_FOURS.format(name=name, count=count, lines=lines)
        else:
            self.functions.append(LOOP.format(name=name, count=count, lines=lines))
        self.lines.append(f"  MADE({name})(w);")
        self.statements += len(block.statements)

    def _turn_of_loop(self, steps: Sequence[Step], kept: Sequence[Numbers]) -> tuple[Listing, list[Numbers]]:
        """Operations of one turn of a loop, which compute the kept entries, and the entries that it reads, in order."""
        inside: dict[bytes, ca.SX] = {}
        read: dict[bytes, ca.SX] = {}
        operands_read: list[Numbers] = []
        for step in steps:
            entries = []
            for numbers in (operand.numbers for operand in step.operands):
                key = numbers.tobytes()
                if key not in inside and key not in read:
                    constant = self._one_constant(numbers)
                    if constant is not None:
                        entries.append(constant)
                        continue
                    read[key] = ca.SX.sym("read")
                    operands_read.append(numbers)
                entries.append(inside[key] if key in inside else read[key])
            assert step.operation is not None, "loops are of operations alone"
            apply = ca.SX.unary if len(entries) == 1 else ca.SX.binary
            inside[step.results[0].numbers.tobytes()] = apply(step.operation, *entries)
        stored = [inside[numbers.tobytes()] for numbers in kept]
        symbols = ca.vertcat(*read.values())
        return Listing(ca.Function("turn", [symbols], [ca.densify(ca.vertcat(*ca.cse(stored)))])), operands_read

    def _one_constant(self, numbers: Numbers) -> ca.SX | None:
        """The constant that all entries equal; None if they are not constant or not equal."""
        if not np.all(self.origins.is_constant(numbers)):
            return None
        values = set(self.origins.constants(numbers))
        return ca.SX(values.pop()) if len(values) == 1 else None

    def _operand_of_loop(self, numbers: Numbers, in_fours: bool) -> str:
        """Expression of the entry of an operand that turn i of a loop reads."""
        if len(numbers) == 1:
            number = f"w[{self.place[numbers[0]]}]"
            return f"SPREAD({number})" if in_fours else number
        pointer = f"{self._pointer(numbers)} + i"
        return f"LOAD({pointer})" if in_fours else f"*({pointer})"

    def _write_product(self, k: int, step: Step) -> None:
        """Write a product of matrices, which may be added to a third matrix."""
        left, right, *added = step.operands
        (result,) = step.results
        x, y = (self._pointer(operand.numbers) for operand in (left, right))
        start = [self._pointer(operand.numbers) for operand in added]
        first = self._place_things(k, result.numbers)
        count = len(result.numbers)
        if start:
            self.lines.append(f"  program_read(w + {first}, {start[0]}, {count});")
        self.statements += 1
        if left.pattern.is_dense():
            rows, inner = left.pattern.shape
            dense = right.pattern.is_dense()
            product = Product(rows, dense, not start)
            self.products[product] = None
            if dense:
                columns = right.pattern.size2()
                self.lines.append(f"  {product.name}({x}, {inner}, {y}, {columns}, w + {first});")
                return
            groups = column_groups(right.pattern)
            table = self.tables.of_integers(np.concatenate(groups))
            self.lines.append(f"  {product.name}({x}, {y}, {table}, {len(groups)}, w + {first});")
            return
        if not start:
            self.lines.append(f"  program_clear(w + {first}, {count});")
        triples = _triples(left.pattern, right.pattern, result.pattern)
        self.lines.append(f"  program_sparse({x}, {y}, {self.tables.of_places(triples)}, w + {first});")

    def _write_bundle(self, k: int, steps: Sequence[Step]) -> None:
        """Write small steps without loops."""
        operands = np.unique(_joined([operand.numbers for step in steps for operand in step.operands]))
        made = [result.numbers for step in steps for result in step.results]
        inside = set(_joined(made).tolist())
        constant = self.origins.is_constant(operands)
        values = dict(zip(operands[constant].tolist(), self.origins.constants(operands[constant]), strict=True))
        read = [number for number in operands[~constant].tolist() if number not in inside]
        given = ca.SX.sym("given", len(read))
        entry_of = {number: ca.SX(value) for number, value in values.items()}
        entry_of |= zip(read, ca.vertsplit(given) if read else [], strict=True)
        for step in steps:
            arguments = [_matrix(operand.pattern, operand.numbers, entry_of) for operand in step.operands]
            for result, computed in zip(step.results, step.function.call(arguments, True, False), strict=True):
                entry_of |= zip(result.numbers.tolist(), ca.SX(computed).nonzeros(), strict=True)
        kept = [numbers for numbers in made if self._last_use_of(numbers) > k]
        for numbers in kept:
            self._place_things(k, numbers)
        stored = _joined(kept).tolist()
        result = ca.cse(ca.vertcat(*[entry_of[number] for number in stored]))
        self._write_straight(Listing(ca.Function("steps", [given], [result])), self.place[read], self.place[stored], k)

    def _write_straight(self, listing: Listing, read: Numbers, stored: Numbers, k: int) -> None:
        """Write scalars that read and store numbers at these places, in functions of bounded length."""
        statements = computations(listing, SINGLE)
        outputs = listing.outputs[0]
        for entry, place in enumerate(stored.tolist()):
            if entry in outputs:
                statements.append(Statement(f"w[{place}] = {{0}};", [outputs[entry]]))
            else:
                statements.append(Statement(f"w[{place}] = 0;", []))
        parts, passed = in_parts(statements, LONGEST_OF_NUMBERS, lambda place: f"passed[{place}] = {{0}};")
        room = self.memory.take(passed) if passed else 0
        self.blocks_until[k].append((room, passed))
        for part in parts:
            block = Block("casadi_real", "a", part.statements)
            lines = block.lines(partial(_text, listing, read, part.passed))
            name = f"MADE({self.name}_steps_{len(self.functions)})"
            head = f"static void {name}(casadi_real *w, casadi_real *passed) {{"
            self.functions.append("\n".join([head, *lines, "  (void)passed;\n}\n"]))
            self.lines.append(f"  {name}(w, w + {room});")
            self.statements += len(part.statements)

    def _given(self, unit: Unit) -> Numbers:
        """Entries of the operands of calls, in the order in which the function reads them."""
        width = self._width(unit)
        of_calls = [_joined([operand.numbers for operand in step.operands]) for step in unit.steps]
        # Surplus lanes repeat the last call.
        of_calls += [of_calls[-1]] * (-len(of_calls) % width)
        grouped = [np.array(of_calls[first : first + width]).T.ravel() for first in range(0, len(of_calls), width)]
        return _joined(grouped)

    def _write_calls(self, k: int, unit: Unit) -> None:
        """Write calls of one function, four at a time if there are enough calls."""
        function = unit.steps[0].function
        width = self._width(unit)
        turns = -(-len(unit.steps) // width)
        given = self._pointer(*self.operands[k])
        count = sum(len(result.numbers) for result in unit.steps[0].results)
        first = self.memory.take(width * turns * count)
        owned = []
        for i, step in enumerate(unit.steps):
            turn, lane = divmod(i, width)
            numbers = _joined([result.numbers for result in step.results])
            self.place[numbers] = first + width * (turn * count + np.arange(count)) + lane
            owned.append(numbers)
        self._free_after(k, _joined(owned), first, width * turns * count)
        word = self._callee(function, width)
        self.lines.append(f"  MADE({self.name}_{word})({given}, w + {first}, {turns});")

    def _write_kernel(self, k: int, step: Step) -> None:
        """Write a call of a function that itself calls others, and the function as a kernel."""
        function = step.function
        name: str = function.name()
        if name not in self.kernels:
            scalar = function.is_a("SXFunction")
            written = scalars_in_c(function, function) if scalar else program_in_c(program_of(function), function)
            self.kernels[name] = written
        kernel = self.kernels[name]
        assert hash(kernel.signature) == hash(function), f"two functions are called {name}"
        arguments = [self._pointer(operand.numbers) for operand in step.operands]
        results = [f"w + {self._place_things(k, result.numbers)}" for result in step.results]
        room = self.memory.take(kernel.reals)
        self.blocks_until[k].append((room, kernel.reals))
        given = ", ".join(arguments or ["w"])
        made = ", ".join(results)
        self.lines.append(f"  {{ const casadi_real *given[] = {{{given}}}; casadi_real *made[] = {{{made}}};")
        self.lines.append(f"    MADE({name})(given, made, w + {room}); }}")

    def _width(self, unit: Unit) -> int:
        """Number of calls of a unit that are made at once."""
        if len(unit.steps) < FEWEST:
            return 1
        try:
            self._callee(unit.steps[0].function, LANES)
        except UnknownOperationError:
            return 1
        return LANES

    def _callee(self, function: ca.Function, width: int) -> str:
        key = (hash(function), width)
        if key not in self.callee_of:
            word = f"{function.name()}{'s' if width == LANES else ''}"
            if word in self.callees:
                word = f"{word}_{len(self.callees)}"
            written, statements = callee(Listing(function), FOURS if width == LANES else SINGLE)
            self.callees[word] = written
            self.statements += statements
            self.callee_of[key] = word
        return self.callee_of[key]


def _units(program: Program) -> list[Unit]:
    """Units in an order in which each comes behind the units that it waits for."""
    units: dict[tuple[int, _Key], Unit] = {}
    for step, (depth, key) in zip(program.steps, _with_late_calls(program, _first_places(program)), strict=True):
        units.setdefault((depth, key), Unit(key[0], [])).steps.append(step)
    in_order = [unit for _, unit in sorted(units.items(), key=lambda entry: entry[0][0])]
    return [part for unit in in_order for part in _in_bundles(unit)]


def _first_places(program: Program) -> list[tuple[int, _Key]]:
    """How many units each step waits for, and which unit may hold it."""
    calls = Counter(hash(step.function) for step in program.steps if step.called)
    made_by: dict[int, tuple[int, _Key]] = {}
    places = []
    for number, step in enumerate(program.steps):
        key = _key(step, number, calls)
        depth = 0
        for operand in step.operands:
            for owner in program.origins.holders(operand.numbers):
                if owner in made_by:
                    before, other = made_by[owner]
                    joins = key == other and _joins(key, operand.numbers, program.origins.numbers(owner))
                    depth = max(depth, before if joins else before + 1)
        places.append((depth, key))
        made_by |= dict.fromkeys(_owners(program, step.results), (depth, key))
    return places


def _with_late_calls(program: Program, places: list[tuple[int, _Key]]) -> list[tuple[int, _Key]]:
    """Places of steps, calls with the last other calls of their function that come before their results are read."""
    depths: dict[_Key, set[int]] = defaultdict(set)
    for depth, key in places:
        depths[key].add(depth)
    last: dict[int, int] = {}
    late = list(places)
    for number in reversed(range(len(places))):
        step = program.steps[number]
        depth, key = places[number]
        if key[0] is UnitKind.CALLS:
            latest = min((last[owner] for owner in _owners(program, step.results) if owner in last), default=depth)
            depth = max(other for other in depths[key] if other <= max(latest, depth))
            late[number] = depth, key
        for owner in _owners(program, step.operands):
            last[owner] = min(last.get(owner, depth - 1), depth - 1)
    return late


def _owners(program: Program, values: Sequence[Value]) -> list[int]:
    """The things that hold the entries of values."""
    return program.origins.holders(_joined([value.numbers for value in values]))


_Key = tuple[UnitKind, int]
"""Key of all steps that may be in one unit: the kind of unit, and its turns, its function or its step."""


def _key(step: Step, number: int, calls: Mapping[int, int]) -> _Key:
    """Key of the unit in which a step may be.

    Args:
        step: the step.
        number: index of the step.
        calls: number of calls of each function, by its hash.
    """
    if step.called and (calls[hash(step.function)] >= FEWEST or _stays(step)):
        return (UnitKind.SINGLE, number) if _is_kernel(step) else (UnitKind.CALLS, hash(step.function))
    if step.operation is not None and len(step.results[0].numbers) >= FEWEST_TURNS:
        return UnitKind.LOOP, len(step.results[0].numbers)
    longest = SMALL if step.called or step.operation is not None else LONGEST_PRODUCT_WITHOUT_LOOP
    if step.instructions <= longest:
        return UnitKind.STRAIGHT, 0
    return (UnitKind.CALLS, hash(step.function)) if step.called and not _is_kernel(step) else (UnitKind.SINGLE, number)


def _joins(key: _Key, operand: Numbers, made: Numbers) -> bool:
    """Whether a step may be in the unit that computes its operand: a turn of a loop reads only its own results."""
    return key[0] is UnitKind.STRAIGHT or (key[0] is UnitKind.LOOP and np.array_equal(operand, made))


def _stays(step: Step) -> bool:
    """Whether a step calls a function that cannot be inlined."""
    if _is_kernel(step):
        return True
    try:
        step.function.call(step.function.sx_in(), True, False)
    except RuntimeError:
        # It is never to be inlined.
        return True
    return False


def _is_kernel(step: Step) -> bool:
    """Whether a step calls a function that calls others."""
    return step.called and bool(not step.function.is_a("SXFunction") or step.function.find_functions(0))


def _in_bundles(unit: Unit) -> list[Unit]:
    """Split a unit of small steps into bundles of bounded length; a bundle stores values that later bundles read."""
    if unit.kind is not UnitKind.STRAIGHT:
        return [unit]
    bundles = [Unit(unit.kind, [])]
    length = 0.0
    for step in unit.steps:
        length += step.instructions
        if length > LONGEST_BUNDLE:
            bundles.append(Unit(unit.kind, []))
            length = step.instructions
        bundles[-1].steps.append(step)
    return bundles


def _joined(vectors: Sequence[Numbers]) -> Numbers:
    return np.concatenate([np.zeros(0, dtype=np.int64), *vectors])


def _matrix(pattern: ca.Sparsity, numbers: Numbers, entry_of: dict[int, ca.SX]) -> ca.SX:
    entries = [entry_of[number] for number in numbers.tolist()]
    return ca.SX(pattern, ca.vertcat(*entries)) if entries else ca.SX(pattern)


def _text(listing: Listing, read: Numbers, elsewhere: dict[int, int], number: int) -> str | None:
    """Text of a value that is not in a variable."""
    value = listing.values[number]
    if number in elsewhere:
        return f"passed[{elsewhere[number]}]"
    if isinstance(value, Constant):
        return SINGLE.number(value.value)
    if isinstance(value, Read):
        return f"w[{read[value.entry]}]"
    return None


def _triples(left: ca.Sparsity, right: ca.Sparsity, result: ca.Sparsity) -> Numbers:
    """Entries of left factor, right factor and result in each multiplication of a sparse product, shape (count, 3)."""
    place_of = {entry: k for k, entry in enumerate(zip(*result.get_triplet(), strict=True))}
    of_column: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for k, (i, j) in enumerate(zip(*left.get_triplet(), strict=True)):
        of_column[j].append((k, i))
    triples = []
    for k, (j, column) in enumerate(zip(*right.get_triplet(), strict=True)):
        triples += [(entry, k, place_of[i, column]) for entry, i in of_column[j] if (i, column) in place_of]
    return np.array(sorted(triples, key=lambda triple: triple[2]), dtype=np.int64).reshape(-1, 3)
