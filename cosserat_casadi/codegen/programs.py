"""Programs of some entries of a function's result, and one shared program for all that compute alike.

Two programs compute alike if their steps (compiling/steps.py) are equal up to constants. Constants that differ become
an argument, with a piece for each matrix of constants, which the steps read in place. So a kernel that several rods
share may have any length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.streams import Stream, names_of_part, same_but_for_rounding, shared
from cosserat_casadi.compiling.numbered import Argument, Numbers, Origins, Program, Step, Value, column
from cosserat_casadi.compiling.steps import entrywise

CONSTANT = -1
"""Local number of every nonzero constant."""


@dataclass(frozen=True, eq=False)
class PartialProgram:
    """The steps of a part with local numbers: 0 for zero, then entries read of arguments, then results of steps.

    Attributes:
        entries: indices of the entries of the result.
        arguments: names of the arguments.
        reads: entries that are read of each argument.
        steps: the steps.
        constants: for each operand of each step the constants among its entries, in order.
        outputs: local numbers of the entries of the result.
        output_constants: the constants among these entries.
    """

    entries: list[int]
    arguments: list[str]
    reads: list[list[int]]
    steps: list[Step]
    constants: list[list[tuple[float, ...]]]
    outputs: Numbers
    output_constants: tuple[float, ...]

    @property
    def key(self) -> tuple[object, ...]:
        """Key of all programs that compute alike."""
        lines = tuple((_identity(step), *(operand.key for operand in step.operands)) for step in self.steps)
        return tuple(map(len, self.reads)), lines, self.outputs.tobytes()


def foreseen(steps: Sequence[Step]) -> float:
    """Estimate the instructions without loops; a call of a long function counts as its arguments and results."""
    total = 0.0
    for step in steps:
        if np.isfinite(step.instructions):
            total += step.instructions
        else:
            total += step.function.nnz_in() + step.function.nnz_out()
    return total


def _identity(step: Step) -> object:
    """Key of a step up to its constants; two functions with equal instructions have one key."""
    if step.operation is not None:
        return step.operation
    if step.function.is_a("SXFunction"):
        return _lines(step.function).key
    return step.function.serialize()


@cache
def _lines(function: ca.Function) -> Stream:
    """Stream of a function that a step calls, with all entries of its results in one column."""
    symbols = function.sx_in()
    entries = [entry for result in function.call(symbols) for entry in result.nonzeros()]
    return Stream.settled(ca.Function("stacked", symbols, [ca.vertcat(*entries)], *names_of_part(function.name_in())))


def partial_program(program: Program, entries: Sequence[int]) -> PartialProgram:
    """Extract the part of a program that computes some of the stored entries of its single result."""
    (result,) = program.results.values()
    # The order of computation saves a permutation.
    ordered = sorted(entries, key=result.numbers.__getitem__)
    wanted = result.numbers[ordered]
    origins = program.origins
    needed, kept = _needed(program, wanted)
    kept = _ordered(kept, wanted, origins.count)
    # Constants are told from zeros, which keep the number 0.
    local = np.zeros(origins.count, dtype=np.int64)
    local[origins.is_constant(np.arange(origins.count))] = CONSTANT
    local[0] = 0
    count = 1
    reads = []
    for argument in program.arguments:
        numbers = np.concatenate([piece.numbers for piece in argument.pieces])
        # An argument of one entry is read whole.
        read = np.flatnonzero(needed[numbers]) if len(numbers) > 1 else np.arange(len(numbers))
        local[numbers[read]] = count + np.arange(len(read))
        count += len(read)
        reads.append(read.tolist())
    steps = []
    constants = []
    for step in kept:
        constants.append([_constants(origins, operand.numbers) for operand in step.operands])
        operands = [Value(operand.pattern, local[operand.numbers]) for operand in step.operands]
        results = []
        for result in step.results:
            local[result.numbers] = count + np.arange(len(result.numbers))
            count += len(result.numbers)
            results.append(Value(result.pattern, local[result.numbers]))
        steps.append(replace(step, operands=operands, results=results))
    names = [argument.name for argument in program.arguments]
    return PartialProgram(ordered, names, reads, steps, constants, local[wanted], _constants(origins, wanted))


def shared_program(programs: Sequence[PartialProgram], name: str) -> tuple[Program, list[list[float]]]:
    """Make one program of programs that compute alike, and list the constants of each, a further argument."""
    return _Sharing(programs, name).result


def _needed(program: Program, wanted: Numbers) -> tuple[npt.NDArray[np.bool_], list[Step]]:
    """Find the numbers on which wanted numbers depend, and their steps; entrywise steps compute no other entries."""
    needed = np.zeros(program.origins.count, dtype=np.bool_)
    needed[wanted] = True
    kept = []
    for step in reversed(program.steps):
        made = np.concatenate([result.numbers for result in step.results])
        chosen = np.flatnonzero(needed[made])
        if len(chosen) == 0:
            continue
        if step.operation is not None and len(chosen) < len(made):
            step = _of_entries(step, chosen)
        for operand in step.operands:
            needed[operand.numbers] = True
        kept.append(step)
    return needed, kept[::-1]


def _ordered(steps: Sequence[Step], wanted: Numbers, count: int) -> list[Step]:
    """Order the steps as the wanted entries need them, which gives one order for all parts that compute alike.

    In the whole program, the first part computes the values that it shares before the others do.
    """
    maker = np.full(count, -1, dtype=np.int64)
    for k, step in enumerate(steps):
        for result in step.results:
            maker[result.numbers] = k
    needs = [_distinct(maker[np.concatenate([operand.numbers for operand in step.operands])]) for step in steps]
    order: dict[int, None] = {}
    waiting = _distinct(maker[wanted])[::-1]
    while waiting:
        k = waiting[-1]
        missing = [other for other in needs[k] if other not in order]
        if k in order or not missing:
            order[waiting.pop()] = None
        else:
            waiting += missing[::-1]
    return [steps[k] for k in order]


def _distinct(makers: Numbers) -> list[int]:
    """List the steps that compute entries, in the order of the entries."""
    found, first = np.unique(makers, return_index=True)
    return [int(k) for k in found[np.argsort(first)] if k >= 0]


def _of_entries(step: Step, chosen: Numbers) -> Step:
    """Restrict a step that is done entry by entry to some entries."""
    assert step.operation is not None
    operands = []
    for operand in step.operands:
        scalar = operand.pattern.numel() == 1
        operands.append(operand if scalar else column(operand.numbers[chosen]))
    function = entrywise(step.operation, [operand.pattern for operand in operands])
    result = column(step.results[0].numbers[chosen])
    return replace(step, function=function, operands=operands, results=[result], instructions=len(chosen))


def _constants(origins: Origins, numbers: Numbers) -> tuple[float, ...]:
    """List the constants among entries, except zeros."""
    constant = origins.is_constant(numbers) & (numbers != 0)
    return tuple(origins.constants(numbers[constant]))


class _Sharing:
    """Merger of programs that compute alike into one.

    Constants that are equal in all programs stay in the code; all other constants are an argument.
    """

    def __init__(self, programs: Sequence[PartialProgram], name: str) -> None:
        self._origins = Origins()
        self._pieces: dict[tuple[tuple[float, ...], ...], Value] = {}
        first = programs[0]
        arguments = []
        for argument, read in zip(first.arguments, first.reads, strict=True):
            value = self._origins.add(ca.Sparsity.dense(len(read)))
            arguments.append(Argument(argument, value.pattern, [value]))
        # Constants are numbered before the results of steps, whose numbers they push back.
        self._begin = self._origins.count
        counterparts = []
        for k, step in enumerate(first.steps):
            given = []
            for i, operand in enumerate(step.operands):
                given.append(self._given(operand.numbers, [program.constants[k][i] for program in programs]))
            called, of_function = self._function([program.steps[k] for program in programs], name)
            counterparts.append((replace(step, function=called), given, of_function))
        of_outputs = self._given(first.outputs, [program.output_constants for program in programs])
        self._shift = self._origins.count - self._begin
        steps = [self._step(*counterpart) for counterpart in counterparts]
        outputs = column(self._numbers(first.outputs, of_outputs))
        pieces = list(self._pieces.values())
        total = ca.Sparsity.dense(sum(piece.pattern.nnz() for piece in pieces))
        if not pieces:
            pieces = [self._origins.add(total)]
        arguments.append(Argument("constants", total, pieces))
        whole = Program(name, self._origins, arguments, steps, {"entries": outputs})
        listed = [[value for values in self._pieces for value in values[i]] for i in range(len(programs))]
        self.result = (whole, listed)

    def _given(self, numbers: Numbers, values: Sequence[tuple[float, ...]]) -> Numbers:
        """Number the constants of an operand anew, given their values in all programs."""
        if not values[0]:
            return np.zeros(0, dtype=np.int64)
        constant = numbers == CONSTANT
        if all(same_but_for_rounding(own, values[0]) for own in values):
            return self._origins.add(ca.Sparsity.dense(len(values[0])), list(values[0])).numbers
        # Zeros among constants are handed over as well: the operand is read where it lies.
        with_zeros = bool(np.all(constant | (numbers == 0)))
        if with_zeros:
            values = [_spread(of_program, constant) for of_program in values]
        return self._piece(values).numbers

    def _piece(self, values: Sequence[tuple[float, ...]]) -> Value:
        """Add a piece of constants with these values in the programs."""
        key = tuple(values)
        if key not in self._pieces:
            self._pieces[key] = self._origins.add(ca.Sparsity.dense(len(key[0])))
        return self._pieces[key]

    def _function(self, steps: Sequence[Step], name: str) -> tuple[ca.Function, list[Value]]:
        """Return the function that a step calls in all programs, and an operand for constants in it that differ."""
        functions = [step.function for step in steps]
        first = functions[0]
        if len({function.__hash__() for function in functions}) == 1 or steps[0].operation is not None:
            return first, []
        if not first.is_a("SXFunction"):
            return first, []
        lines = [_lines(function) for function in functions]
        kernel, values = shared(lines, f"{name}_{first.name()}")
        if not values[0]:
            return first, []
        constants = self._piece([tuple(of_program) for of_program in values])
        return _with_constants(first, lines[0].reads, kernel), [constants]

    def _numbers(self, numbers: Numbers, constants: Numbers) -> Numbers:
        """Translate numbers of entries to this program."""
        if len(constants) == len(numbers):
            return constants
        shifted = np.where(numbers >= self._begin, numbers + self._shift, numbers)
        shifted[numbers == CONSTANT] = constants
        return shifted

    def _step(self, step: Step, constants: Sequence[Numbers], of_function: Sequence[Value]) -> Step:
        """Make a step of this program with the new numbers of constants, and further operands of constants."""
        operands = []
        for operand, given in zip(step.operands, constants, strict=True):
            operands.append(Value(operand.pattern, self._numbers(operand.numbers, given)))
        results = [self._origins.add(result.pattern) for result in step.results]
        return replace(step, operands=[*operands, *of_function], results=results)


def _with_constants(function: ca.Function, reads: Sequence[Sequence[int]], kernel: ca.Function) -> ca.Function:
    """Make a function of scalars with its constants as one more argument.

    Args:
        function: the function.
        reads: entries that are read of each argument.
        kernel: function of the entries read of each argument, and the constants ↦ entries of all results.
    """
    symbols = function.sx_in()
    constants = ca.SX.sym("constants", kernel.size1_in(function.n_in()))
    given = [ca.vertcat(*[symbol.nz[entry] for entry in read]) for symbol, read in zip(symbols, reads, strict=True)]
    entries = ca.vertsplit(kernel.call([*given, constants])[0])
    results = []
    for i in range(function.n_out()):
        pattern = function.sparsity_out(i)
        results.append(ca.SX(pattern, ca.vertcat(*entries[: pattern.nnz()])))
        entries = entries[pattern.nnz() :]
    return ca.Function(kernel.name(), [*symbols, constants], results)


def _spread(values: Sequence[float], constant: npt.NDArray[np.bool_]) -> tuple[float, ...]:
    """Spread constants over their entries, with zeros elsewhere."""
    spread = np.zeros(len(constant))
    spread[constant] = values
    return tuple(spread.tolist())
