"""An MX function written again so that its code in loops is fast.

CasADi writes a loop in C for every instruction of an MX function: one for each transpose, slice and stack, and for a
product one over sparsity patterns that looks up every entry. Here a function is first turned into steps on numbered
entries (steps.py), and these are written again; small steps between the large ones without loops, together.

The results are those of the function itself, to the order of a sum.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.numbered import Argument, Numbers, Program, Step, Value
from cosserat_casadi.codegen.routines import TOGETHER
from cosserat_casadi.codegen.running_sums import in_running_sums
from cosserat_casadi.codegen.steps import UnknownInstructionError, program_of

FEW_PIECES = 8
"""Pieces of other columns of which a column is put together one by one."""

LONG_PIECES = 8
"""Entries of such pieces from which on more of them are put together one by one."""

PIECES_OF_EACH = 2
"""Most pieces of each column that are put together so: of more, the entries are gathered in one loop."""

LONGEST = 3000
"""Instructions up to which small steps are written together: compilers take more than twice as long for two."""


def in_loops(function: ca.Function) -> ca.Function:
    """The same function, written for loops in C.

    A function that is made of scalars stays as it is, and so does one that is not known as a program.
    """
    if function.is_a("SXFunction"):
        return function
    try:
        return written(program_of(function))
    except UnknownInstructionError:
        return function


def written(program: Program) -> ca.Function:
    """A program as an MX function whose code in loops is fast."""
    return _Writing(program).result


def _bundles(steps: Sequence[Step]) -> list[list[Step]]:
    """Small steps in bundles that are written together."""
    bundles: list[list[Step]] = [[]]
    length = 0.0
    for step in steps:
        length += step.instructions
        if length > LONGEST:
            bundles.append([])
            length = step.instructions
        bundles[-1].append(step)
    return bundles


class _Writing:
    """Steps on their way to an MX function."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.origins = program.origins
        # Columns that hold what was computed, with the numbers of their entries; constants are in none of them.
        self._columns: list[ca.MX] = [ca.MX(0, 1)]
        self._numbers_in: list[Numbers] = [np.zeros(0, dtype=np.int64)]
        self._column_of = np.zeros(self.origins.count, dtype=np.int64)
        self._entry_of = np.arange(self.origins.count)
        self._ordered = dict[bytes, ca.MX]()
        self._symbols = [self._argument(argument) for argument in program.arguments]
        self._write()

    @property
    def result(self) -> ca.Function:
        """The function."""
        program = self.program
        results = [self._matrix(value) for value in program.results.values()]
        names = [argument.name for argument in program.arguments]
        return ca.Function(program.name, self._symbols, results, names, list(program.results))

    def _argument(self, argument: Argument) -> ca.MX:
        """The symbol of an argument: that of its one piece, or a column of those of its pieces."""
        if len(argument.pieces) == 1:
            symbol = ca.MX.sym(argument.name, argument.pattern)
            self._keep(argument.pieces[0], symbol)
            return symbol
        symbols = []
        for piece in argument.pieces:
            symbol = ca.MX.sym(argument.name, piece.pattern)
            self._keep(piece, symbol)
            symbols.append(symbol)
        return ca.vertcat(*symbols)

    def _write(self) -> None:
        """Write all steps: in turns the small ones that are due, and the large ones."""
        for small, large in self._layers():
            for steps in _bundles(small):
                if len(steps) > 1:
                    self._write_together(steps)
                else:
                    self._write_each(steps)
            self._write_each(large)

    def _layers(self) -> list[tuple[list[Step], list[Step]]]:
        """Small and large steps in layers: small ones need large ones of earlier layers alone."""
        layer_of = defaultdict[int, int](int)
        large_in = set[int]()
        layers: list[tuple[list[Step], list[Step]]] = []
        for step in in_running_sums(self.program.steps, self.origins):
            layer = 0
            for owner in self._needed(step):
                after_large = step.small and owner in large_in
                layer = max(layer, layer_of[owner] + int(after_large))
            while len(layers) <= layer:
                layers.append(([], []))
            layers[layer][0 if step.small else 1].append(step)
            for owner in self._made(step):
                layer_of[owner] = layer
                if not step.small:
                    large_in.add(owner)
        return layers

    def _needed(self, step: Step) -> list[int]:
        """What a step takes its operands from."""
        numbers = [operand.numbers for operand in step.operands]
        owners = self.origins.owners(np.concatenate([np.zeros(1, dtype=np.int64), *numbers]))
        return [int(owner) for owner in np.unique(owners) if owner]

    def _made(self, step: Step) -> list[int]:
        numbers = [result.numbers for result in step.results]
        owners = self.origins.owners(np.concatenate(numbers))
        return [int(owner) for owner in dict.fromkeys(owners.tolist())]

    def _write_each(self, steps: Sequence[Step]) -> None:
        for step in steps:
            arguments = [self._matrix(operand) for operand in step.operands]
            for result, computed in zip(step.results, step.of(arguments), strict=True):
                self._keep(result, computed)

    def _write_together(self, steps: Sequence[Step]) -> None:
        """Write steps as one function without loops."""
        made = [owner for step in steps for owner in self._made(step)]
        operands = np.concatenate([operand.numbers for step in steps for operand in step.operands])
        columns = self._column_of[operands]
        given = [self._given(operands[columns == k]) for k in np.unique(columns) if k]
        symbols = [ca.SX.sym("given", len(numbers)) for numbers in given]
        entry_of: dict[int, ca.SX] = {0: ca.SX(0.0)}
        for numbers, symbol in zip(given, symbols, strict=True):
            entry_of |= zip(numbers.tolist(), ca.vertsplit(symbol), strict=True)
        for step in steps:
            arguments = [self._scalars(operand, entry_of) for operand in step.operands]
            for result, computed in zip(step.results, step.function.call(arguments), strict=True):
                entry_of |= zip(result.numbers.tolist(), computed.nonzeros(), strict=True)
        inside = set[Step | None](steps)
        kept = [owner for owner in made if self._users[owner] - inside]
        numbers = np.concatenate([np.zeros(0, dtype=np.int64), *map(self.origins.numbers, kept)])
        # One column of all results: what comes later takes from it in one loop.
        result = ca.cse(ca.vertcat(*[entry_of[number] for number in numbers.tolist()]))
        together = ca.Function(TOGETHER, symbols, [result])
        self._hold(numbers, together.call([self._vector(numbers) for numbers in given])[0])

    def _given(self, numbers: Numbers) -> Numbers:
        """What to hand over of one column of which some entries are needed: all of it unless they are few."""
        needed = np.unique(numbers)
        whole = self._numbers_in[self._column_of[needed[0]]]
        return whole if 2 * len(needed) > len(whole) else needed

    @cached_property
    def _users(self) -> dict[int, set[Step | None]]:
        """For each thing the steps that need it; None stands for the outputs."""
        users = defaultdict[int, set[Step | None]](set)
        for step in self.program.steps:
            for owner in self._needed(step):
                users[owner].add(step)
        for value in self.program.results.values():
            for owner in np.unique(self.origins.owners(value.numbers)).tolist():
                users[owner].add(None)
        return users

    def _scalars(self, value: Value, entry_of: dict[int, ca.SX]) -> ca.SX:
        entries = []
        for number in value.numbers.tolist():
            if number not in entry_of:
                entry_of[number] = ca.SX(self.origins.constants(np.array([number]))[0])
            entries.append(entry_of[number])
        return ca.SX(value.pattern, ca.vertcat(*entries))

    # Entries

    def _keep(self, value: Value, computed: ca.MX) -> None:
        if len(value.numbers):
            self._hold(value.numbers, ca.vec(ca.sparsity_cast(computed, ca.Sparsity.dense(computed.nnz()))))

    def _hold(self, numbers: Numbers, column: ca.MX) -> None:
        """Note that these are the entries of a column."""
        self._column_of[numbers] = len(self._columns)
        self._entry_of[numbers] = np.arange(len(numbers))
        self._columns.append(column)
        self._numbers_in.append(numbers)

    def _matrix(self, value: Value) -> ca.MX:
        """A matrix of these entries."""
        matrix: ca.MX = ca.sparsity_cast(self._vector(value.numbers), value.pattern)
        return matrix

    def _vector(self, numbers: Numbers) -> ca.MX:
        """A column of these entries."""
        key = numbers.tobytes()
        if key not in self._ordered:
            self._ordered[key] = self._gathered(numbers)
        return self._ordered[key]

    def _gathered(self, numbers: Numbers) -> ca.MX:
        if len(numbers) == 0:
            return ca.MX(0, 1)
        columns = self._column_of[numbers]
        starts = np.flatnonzero(np.diff(columns, prepend=-1))
        long_ones = min(len(numbers) // LONG_PIECES, PIECES_OF_EACH * len(np.unique(columns)))
        if len(starts) <= max(FEW_PIECES, long_ones):
            pieces = np.split(numbers, starts[1:])
            return ca.vertcat(*[self._piece(piece) for piece in pieces])
        pool = []
        places = np.empty(len(numbers), dtype=np.int64)
        size = 0
        in_runs = LONG_PIECES * len(starts) <= len(numbers)
        for k in np.unique(columns):
            own = columns == k
            if k == 0 and in_runs:
                # A zero for each place: whole runs of them are moved at once.
                distinct, place = numbers[own], np.arange(np.count_nonzero(own))
            else:
                distinct, place = np.unique(numbers[own], return_inverse=True)
            pool.append(self._piece(distinct))
            places[own] = size + place
            size += len(distinct)
        gathered: ca.MX = ca.vertcat(*pool).nz[places.tolist()]
        return gathered

    def _piece(self, numbers: Numbers) -> ca.MX:
        """A column of entries of one column, or of constants."""
        k = int(self._column_of[numbers[0]])
        if k == 0:
            return ca.MX(ca.DM(self.origins.constants(numbers)))
        if np.array_equal(numbers, self._numbers_in[k]):
            whole: ca.MX = self._columns[k]
            return whole
        # Of one entry that is taken several times CasADi makes a row.
        piece: ca.MX = ca.vec(self._columns[k].nz[self._entry_of[numbers].tolist()])
        return piece
