"""A function of an assembly in parts, one for each rod; rods that compute alike share one function.

Each part reads few unknowns and inputs. Two parts compute alike where their instructions are the same but for
constants: those become arguments, unless they are the same in all. So six legs of a robot are one piece of code.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.accuracy.cost import STRAIGHT

ARGUMENTS = ["x", "inputs", "factor", "constants"]


@dataclass(frozen=True)
class Part:
    """Some entries of a function's result.

    Attributes:
        kernel: number of the function that computes them.
        x: unknowns that it reads, in the order of its argument.
        inputs: inputs that it reads.
        constants: its constants.
        entries: numbers of the entries of the whole, in the order of its result.
    """

    kernel: int
    x: list[int]
    inputs: list[int]
    constants: list[float]
    entries: list[int]


@dataclass(frozen=True)
class Parted:
    """A function in parts.

    Attributes:
        kernels: maps (x, inputs, factor, constants) ↦ entries.
        parts: which kernel gives which entries.
    """

    kernels: list[ca.Function]
    parts: list[Part]


def parted(function: ca.Function, owners: Sequence[int], name: str) -> Parted:
    """A function in parts.

    Args:
        function: map (x, inputs, factor) ↦ one matrix.
        owners: for each entry of the matrix the number of the part that it belongs to.
        name: what the kernels are called, before their numbers.

    Returns:
        the parts as straight-line code; where one is too long for that the whole as a single part in loops.
    """
    symbols = [ca.SX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(3)]
    entries = function.call(symbols)[0].nonzeros()
    groups: dict[tuple[object, ...], list[tuple[_Stream, list[int]]]] = {}
    for owner in sorted(set(owners)):
        own = [i for i, other in enumerate(owners) if other == owner]
        stream = _Stream(ca.Function("part", symbols, [ca.vertcat(*[entries[i] for i in own])]))
        groups.setdefault(stream.key, []).append((stream, own))
    kernels, parts = [], []
    for number, group in enumerate(groups.values()):
        kernel, constants = _shared([stream for stream, _ in group], f"{name}_{number}")
        kernels.append(kernel)
        for (stream, own), values in zip(group, constants, strict=True):
            parts.append(Part(number, stream.x, stream.inputs, values, own))
    if any(kernel.n_instructions() > STRAIGHT for kernel in kernels):
        return _whole(function, f"{name}_0")
    return Parted(kernels, parts)


def _whole(function: ca.Function, name: str) -> Parted:
    symbols = function.mx_in()
    result = function.call(symbols)[0].nz[:]
    kernel = ca.Function(name, [*symbols, ca.MX(0, 1)], [ca.densify(result)], ARGUMENTS, ["entries"])
    x, inputs, entries = (list(range(n)) for n in (function.size1_in(0), function.size1_in(1), function.nnz_out(0)))
    return Parted([kernel], [Part(0, x, inputs, [], entries)])


FACTORS = {ca.OP_NEG: -1.0, ca.OP_TWICE: 2.0}
"""Operations that CasADi writes for a product with a constant; 1/x stands for such a quotient."""

Line = tuple[int, tuple[int, ...], int]
"""Operation, operands, number of results. Operands are numbers of earlier values, CONSTANT for the next constant, or
what is read or written."""

CONSTANT = -1


class _Stream:
    """The instructions of a scalar function, each value numbered once, with constants apart.

    Attributes:
        function: map (x, inputs, factor) ↦ entries.
        x: unknowns that are read.
        inputs: inputs that are read.
        lines: the instructions.
        constants: value of every use of a constant, in order.
    """

    def __init__(self, function: ca.Function) -> None:
        self.function = function
        codes = [function.instruction_id(i) for i in range(function.n_instructions())]
        read = {tuple(function.instruction_input(i)) for i, code in enumerate(codes) if code == ca.OP_INPUT}
        self.x, self.inputs = (sorted(entry for argument, entry in read if argument == a) for a in range(2))
        self.lines: list[Line] = []
        self.constants: list[float] = []
        self._places = [{entry: i for i, entry in enumerate(own)} for own in (self.x, self.inputs, [0])]
        self._values: dict[int, int] = {}
        self._fixed: dict[int, float] = {}
        self._count = 0
        for i, code in enumerate(codes):
            self._add(i, code)

    @property
    def key(self) -> tuple[Line, ...]:
        """What streams share that compute alike."""
        return tuple(self.lines)

    def _add(self, place: int, code: int) -> None:
        inputs, outputs = self.function.instruction_input(place), self.function.instruction_output(place)
        if code == ca.OP_CONST:
            self._fixed[outputs[0]] = self.function.instruction_constant(place)
        elif code == ca.OP_INPUT:
            self._write(code, (inputs[0], self._places[inputs[0]][inputs[1]]), outputs)
        elif code == ca.OP_OUTPUT:
            self.lines.append((code, (self._operand(inputs[0]), outputs[1]), 0))
        elif code in FACTORS:
            self._write(ca.OP_MUL, (self._constant(FACTORS[code]), self._operand(inputs[0])), outputs)
        elif code == ca.OP_INV:
            self._write(ca.OP_DIV, (self._constant(1.0), self._operand(inputs[0])), outputs)
        else:
            self._write(code, tuple(self._operand(k) for k in inputs), outputs)

    def _write(self, code: int, operands: tuple[int, ...], outputs: Sequence[int]) -> None:
        self.lines.append((code, operands, len(outputs)))
        for k in outputs:
            self._fixed.pop(k, None)
            self._values[k] = self._count
            self._count += 1

    def _operand(self, k: int) -> int:
        return self._constant(self._fixed[k]) if k in self._fixed else self._values[k]

    def _constant(self, value: float) -> int:
        self.constants.append(value)
        return CONSTANT


def _shared(streams: Sequence[_Stream], name: str) -> tuple[ca.Function, list[list[float]]]:
    """One function for streams that compute alike, and the constants of each."""
    first = streams[0]
    values = list(zip(*(stream.constants for stream in streams), strict=True))
    varied = list(dict.fromkeys(value for value in values if len(set(value)) > 1))
    symbols = [
        ca.SX.sym("x", len(first.x)),
        ca.SX.sym("inputs", len(first.inputs)),
        ca.SX.sym("factor"),
        ca.SX.sym("constants", len(varied)),
    ]
    slots = dict(zip(varied, _entries(symbols[3]), strict=True))
    constants = [slots[value] if value in slots else ca.SX(value[0]) for value in values]
    kernel = ca.Function(name, symbols, ca.cse([_replay(first, symbols, constants)]), ARGUMENTS, ["entries"])
    return kernel, [[value[i] for value in varied] for i in range(len(streams))]


def _replay(stream: _Stream, symbols: Sequence[ca.SX], constants: Sequence[ca.SX]) -> ca.SX:
    """The result of a stream in new symbols and constants."""
    f, following = stream.function, iter(constants)
    called = {(g.nnz_in(), g.nnz_out()): g for g in f.find_functions(0)}
    given, values = [_entries(symbol) for symbol in symbols], list[ca.SX]()
    results = [ca.SX(0.0)] * f.nnz_out(0)
    for code, operands, count in stream.lines:
        if code == ca.OP_INPUT:
            values.append(given[operands[0]][operands[1]])
        elif code == ca.OP_OUTPUT:
            results[operands[1]] = next(following) if operands[0] == CONSTANT else values[operands[0]]
        else:
            arguments = [next(following) if k == CONSTANT else values[k] for k in operands]
            values += (
                _call(called[len(arguments), count], arguments) if code == ca.OP_CALL else [_apply(code, arguments)]
            )
    return ca.vertcat(*results)


def _apply(code: int, arguments: Sequence[ca.SX]) -> ca.SX:
    return ca.SX.unary(code, *arguments) if len(arguments) == 1 else ca.SX.binary(code, *arguments)


def _entries(vector: ca.SX) -> list[ca.SX]:
    return ca.vertsplit(vector) if vector.numel() else []


def _call(function: ca.Function, arguments: Sequence[ca.SX]) -> list[ca.SX]:
    """Entries of all results of a function that is called with these entries."""
    shaped, first = [], 0
    for i in range(function.n_in()):
        pattern = function.sparsity_in(i)
        shaped.append(ca.SX(pattern, ca.vertcat(*arguments[first : first + pattern.nnz()])))
        first += pattern.nnz()
    return [entry for result in function.call(shaped, False, True) for entry in result.nonzeros()]
