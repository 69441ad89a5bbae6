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
from cosserat_casadi.codegen.steps import UnknownInstructionError, program_of

FEW_PIECES = 8
"""Pieces of other vectors of which a vector is put together one by one."""

LONG_PIECES = 8
"""Entries of such pieces from which on it is put together one by one however many they are."""

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
        self._computed = dict[int, ca.MX]()
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
        for step in self.program.steps:
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
        first = [result.numbers[:1] for result in step.results]
        return [int(owner) for owner in self.origins.owners(np.concatenate(first))]

    def _write_each(self, steps: Sequence[Step]) -> None:
        for step in steps:
            arguments = [self._matrix(operand) for operand in step.operands]
            for result, computed in zip(step.results, step.of(arguments), strict=True):
                self._keep(result, computed)

    def _write_together(self, steps: Sequence[Step]) -> None:
        """Write steps as one function without loops."""
        made = [owner for step in steps for owner in self._made(step)]
        operands = np.concatenate([operand.numbers for step in steps for operand in step.operands])
        owners = self.origins.owners(operands)
        given = [self._given(operands[owners == owner]) for owner in np.unique(owners) if owner and owner not in made]
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
        results = [ca.vertcat(*[entry_of[number] for number in self.origins.numbers(owner).tolist()]) for owner in kept]
        together = ca.Function(TOGETHER, symbols, ca.cse(results))
        columns = together.call([self._vector(numbers) for numbers in given])
        for owner, column in zip(kept, columns, strict=True):
            self._computed[owner] = column

    def _given(self, numbers: Numbers) -> Numbers:
        """What to hand over of one thing of which some entries are needed: all of it unless they are few."""
        needed = np.unique(numbers)
        whole = self.origins.numbers(int(self.origins.owners(needed[:1])[0]))
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
            owner = int(self.origins.owners(value.numbers[:1])[0])
            self._computed[owner] = ca.vec(ca.sparsity_cast(computed, ca.Sparsity.dense(computed.nnz())))

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
        owners = self.origins.owners(numbers)
        starts = np.flatnonzero(np.diff(owners, prepend=-1))
        if len(starts) <= max(FEW_PIECES, len(numbers) // LONG_PIECES):
            pieces = np.split(numbers, starts[1:])
            return ca.vertcat(*[self._piece(int(owners[i]), piece) for i, piece in zip(starts, pieces, strict=True)])
        pool = []
        places = np.empty(len(numbers), dtype=np.int64)
        size = 0
        for owner in np.unique(owners):
            own = owners == owner
            distinct, place = np.unique(numbers[own], return_inverse=True)
            pool.append(self._piece(int(owner), distinct))
            places[own] = size + place
            size += len(distinct)
        gathered: ca.MX = ca.vertcat(*pool).nz[places.tolist()]
        return gathered

    def _piece(self, owner: int, numbers: Numbers) -> ca.MX:
        """A column of entries of one thing."""
        if owner == 0:
            return ca.MX(ca.DM(self.origins.constants(numbers)))
        if self.origins.is_whole(numbers):
            return self._computed[owner]
        entries = self.origins.entries(owner, numbers)
        # Of one entry that is taken several times CasADi makes a row.
        piece: ca.MX = ca.vec(self._computed[owner].nz[entries.tolist()])
        return piece
