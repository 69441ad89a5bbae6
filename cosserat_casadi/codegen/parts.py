"""A function of an assembly in parts, one for each rod; rods with equal instructions share one function.

Each part reads few unknowns and inputs. Two parts compute alike if their instructions are equal up to constants;
constants that differ become arguments. So six legs of a robot are one piece of code. If that is too long without
loops, programs.py shares steps in place of instructions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

import casadi as ca

from cosserat_casadi.accuracy.cost import STRAIGHT, STRAIGHT_IN_SHARES
from cosserat_casadi.codegen.programs import PartialProgram, foreseen, partial_program, shared_program
from cosserat_casadi.codegen.streams import Stream, alike, names_of_part, scalars, shared, stacked
from cosserat_casadi.compiling.numbered import Program, function_of
from cosserat_casadi.compiling.printed_kernels import Kernel
from cosserat_casadi.compiling.steps import UnknownInstructionError, program_of
from cosserat_casadi.maths.calls import chooses, in_scalars

ARGUMENTS = ["x", "inputs", "factor", "constants"]

FORESEEN_WITHIN = 4
"""Straight-line code may be this much shorter than it is foreseen to be: longer code is not written out."""


@dataclass(frozen=True)
class Part:
    """Some entries of the result of a function.

    Attributes:
        kernel: index of the kernel that computes them.
        reads: entries that the kernel reads of each argument, in the order in which it takes them.
        constants: constants that the kernel takes.
        entries: indices of the entries in the whole, in the order of the kernel's result.
    """

    kernel: int
    reads: list[list[int]]
    constants: list[float]
    entries: list[int]

    @property
    def x(self) -> list[int]:
        """Indices of the unknowns that the part reads, the first argument."""
        return self.reads[0]

    @property
    def inputs(self) -> list[int]:
        """Indices of the inputs that the part reads, the second argument of functions of statics."""
        return self.reads[1]


@dataclass(frozen=True)
class Parted:
    """A function in parts.

    Attributes:
        kernels: maps (x, inputs, factor, constants) ↦ entries, or with other arguments before the constants.
        parts: parts, each with its kernel and its entries.
    """

    kernels: list[Kernel]
    parts: list[Part]


def parted(function: ca.Function, owners: Sequence[int], name: str) -> Parted:
    """A function in parts.

    Args:
        function: map (x, inputs, factor) ↦ one matrix.
        owners: for each entry of the matrix the number of the part to which it belongs.
        name: prefix of the names of kernels, before their numbers.

    Returns:
        the parts as straight-line code, which may be longer if parts compute alike; if one is too long for that, long
        parts have loops. A function that has no form as a program is then a single part.
    """
    if chooses(function):
        return _whole(function, f"{name}_0")
    places = places_by_owner(owners)
    program = _program(function)
    programs = list[PartialProgram]()
    # A single part shares nothing: the function is printed as it is.
    if program is not None and len(places) > 1:
        programs = [partial_program(program, own) for own in places]
    groups = alike(program.key for program in programs)
    limit = STRAIGHT if len(groups) == len(programs) else STRAIGHT_IN_SHARES
    lengths = [foreseen(part.steps) for part in programs]
    if program is not None and not programs:
        lengths = [foreseen(program.steps)]
    if max(lengths, default=0.0) <= FORESEEN_WITHIN * limit:
        straight = _straight(function, places, name)
        if all(kernel.n_instructions() <= limit for kernel in straight.kernels):
            return straight
    if not programs:
        return _whole(function, f"{name}_0")
    return _of_programs(programs, name)


def in_loops(function: ca.Function, places: Sequence[list[int]], name: str, first: int) -> Parted | None:
    """Write some entries of a function in parts, of which long ones have loops.

    Args:
        function: map (x, inputs, factor) ↦ one matrix.
        places: indices of the entries of each part.
        name: prefix of the names of kernels, before their numbers.
        first: the first of these numbers.

    Returns:
        the parts; None if the function has no form as a program.
    """
    program = _program(function) if places else None
    if program is None:
        return None if places else Parted([], [])
    return _of_programs([partial_program(program, own) for own in places], name, first)


def _of_programs(programs: Sequence[PartialProgram], name: str, first: int = 0) -> Parted:
    """Turn programs into parts, with one kernel for all programs that compute alike."""
    kernels = list[Kernel]()
    parts = list[Part]()
    for number, group in enumerate(alike(program.key for program in programs), first):
        one, constants_of_each = shared_program([programs[i] for i in group], f"{name}_{number}")
        # A short part, such as a platform's, reads few entries of its steps: the forecast is ten times too long.
        may_be_short = max(foreseen(programs[i].steps) for i in group) <= STRAIGHT_IN_SHARES
        kernels.append(_short_or_in_loops(one) if may_be_short else function_of(one))
        for i, constants in zip(group, constants_of_each, strict=True):
            parts.append(Part(number, programs[i].reads, constants, programs[i].entries))
    return Parted(kernels, parts)


def parted_by_rows(function: ca.Function, owners: Sequence[int], name: str) -> Parted:
    """Write a matrix in parts, see :func:`parted`, by owners of its rows, with entries by index in the dense matrix."""
    rows, columns = function.sparsity_out(0).get_triplet()
    places = [i + j * function.size1_out(0) for i, j in zip(rows, columns, strict=True)]
    return placed(parted(function, [owners[i] for i in rows], name), places)


def placed(whole: Parted, places: Sequence[int]) -> Parted:
    """Move the entries of parts to these places."""
    parts = [replace(part, entries=[places[k] for k in part.entries]) for part in whole.parts]
    return replace(whole, parts=parts)


def _straight(function: ca.Function, places: Sequence[list[int]], name: str) -> Parted:
    """Write parts as straight-line code."""
    symbols = function.sx_in()
    entries = function.call(symbols)[0].nonzeros()
    named = names_of_part(ARGUMENTS[:3])
    streams = []
    for own in places:
        part = ca.vertcat(*[entries[i] for i in own])
        streams.append(Stream.settled(ca.Function("part", symbols, [part], *named)))
    kernels = list[Kernel]()
    parts = list[Part]()
    for number, group in enumerate(alike(stream.key for stream in streams)):
        kernel, constants = shared([streams[i] for i in group], f"{name}_{number}")
        kernels.append(kernel)
        for i, values in zip(group, constants, strict=True):
            parts.append(Part(number, streams[i].reads, values, places[i]))
    return Parted(kernels, parts)


def _program(function: ca.Function) -> Program | None:
    """Return the steps of a function; None if it has no form as a program."""
    if function.is_a("SXFunction"):
        return None
    try:
        return program_of(function)
    except UnknownInstructionError:
        return None


def _short_or_in_loops(program: Program) -> ca.Function:
    """Write straight-line code if that is short, else loops."""
    in_loops = function_of(program)
    straight = in_scalars(in_loops, program.name)
    return straight if straight.n_instructions() <= STRAIGHT else in_loops


def places_by_owner(owners: Sequence[int]) -> list[list[int]]:
    """List the indices of each owner's entries, owner by owner."""
    return [[i for i, entry_owner in enumerate(owners) if entry_owner == owner] for owner in sorted(set(owners))]


def sharing(functions: Sequence[ca.Function], kernels: Sequence[ca.Function], name: str) -> list[ca.Function]:
    """Rewrite kernels so that all that compute alike call one function.

    Args:
        functions: functions of the kernels, with equal numbers of arguments.
        kernels: the functions as straight-line code with dense outputs, kept for a function that is like no other.
        name: prefix of the names of shared functions, before their numbers.
    """
    # Common terms are shared afterwards: terms of a single rod may be equal by chance.
    streams = [Stream.settled(stacked(function)) for function in functions]
    result = list(kernels)
    for number, members in enumerate(alike(stream.key for stream in streams)):
        if len(members) > 1:
            made, constants = shared([streams[i] for i in members], f"{name}_{number}")
            for i, values in zip(members, constants, strict=True):
                result[i] = _calling(functions[i], kernels[i].name(), made, streams[i].reads, values)
    return result


def in_one(function: ca.Function, owners: Sequence[int], name: str, most: float = inf) -> ca.Function | None:
    """Rewrite a function with one column as its result so that owners whose entries compute alike share code.

    Args:
        function: the function.
        owners: owner of each entry of the result.
        name: name of the new function.
        most: most instructions of entries that share no code; the result is None for a longer function.
    """
    symbols, (result,) = scalars(function)
    entries = ca.vertsplit(ca.densify(result))
    places = places_by_owner(owners)
    pieces = []
    kernels = []
    for number, own in enumerate(places):
        piece = ca.vertcat(*[entries[i] for i in own])
        called = f"{name}_of_{number}"
        pieces.append(ca.Function(called, symbols, [piece], *names_of_part(function.name_in())))
        kernels.append(ca.Function(called, symbols, [ca.cse(piece)], *names_of_part(function.name_in())))
    shared = sharing(pieces, kernels, f"{name}_part")
    alone = [kernel for kernel, one in zip(kernels, shared, strict=True) if one is kernel]
    if sum(kernel.n_instructions() for kernel in alone) > most:
        return None
    arguments = function.mx_in()
    columns = [piece.call(arguments)[0] for piece in shared]
    order = [i for own in places for i in own]
    back = sorted(range(len(order)), key=order.__getitem__)
    whole = ca.vertcat(*columns)[back]
    return ca.Function(name, arguments, [whole], function.name_in(), function.name_out())


def _calling(
    function: ca.Function, name: str, shared: ca.Function, reads: Sequence[Sequence[int]], constants: Sequence[float]
) -> ca.Function:
    """Write a function with dense results as a call of a shared one.

    Args:
        function: the function.
        name: name of the new function.
        shared: function of the entries read of each argument, and constants ↦ entries of all results.
        reads: entries that are read of each argument.
        constants: constants of this function.
    """
    symbols = function.mx_in()
    given = [ca.vec(symbol.nz[[*entries]]) for symbol, entries in zip(symbols, reads, strict=True)]
    column = shared.call([*given, ca.DM(constants)], False, True)[0]
    results = []
    start = 0
    for result in scalars(function)[1]:
        pattern = result.sparsity()
        entries = column[start : start + pattern.nnz()]
        start += pattern.nnz()
        results.append(ca.densify(ca.MX(pattern, entries)))
    return ca.Function(name, symbols, results, function.name_in(), function.name_out())


def _whole(function: ca.Function, name: str) -> Parted:
    """Write the function as one part, with loops."""
    symbols = function.mx_in()
    result = function.call(symbols, function.is_a("MXFunction"), False)[0].nz[:]
    no_constants = ca.MX(0, 1)
    kernel = ca.Function(name, [*symbols, no_constants], [ca.densify(result)], ARGUMENTS, ["entries"])
    part = Part(
        kernel=0,
        reads=[list(range(function.size1_in(i))) for i in range(3)],
        constants=[],
        entries=list(range(function.nnz_out(0))),
    )
    return Parted([kernel], [part])
