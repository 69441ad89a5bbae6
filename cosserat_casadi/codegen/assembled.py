"""The equations of an assembly in parts, one for each rod, and the blocks of its Jacobian.

The Jacobian too has a part for each rod, by the columns of the rod (columns.py). As in parts.py, rods with equal
instructions share one function, which takes the constants that differ as an argument.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.accuracy.cost import MOST_IN_COLUMNS
from cosserat_casadi.codegen.blocks import Blocks, blocks
from cosserat_casadi.codegen.columns import (
    GIVEN,
    SHARED_AT_MOST,
    ColumnedJacobian,
    ColumnPart,
    columned_jacobian,
    on_path,
)
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import input_jacobian, with_parameters_behind_inputs
from cosserat_casadi.codegen.parts import ARGUMENTS, Part, Parted, in_loops, parted, parted_by_rows, places_by_owner
from cosserat_casadi.codegen.streams import Stream, alike, names_of_part, same_but_for_rounding, shared
from cosserat_casadi.compiling.listing import LANES, UnknownOperationError
from cosserat_casadi.compiling.printed_kernels import ColumnForm, Kernel, in_groups
from cosserat_casadi.compiling.scalars_in_c import columns_in_fours, with_calls_in_fours
from cosserat_casadi.model.build import Model

COLUMNS, TURNS, CONSTANTS = len(GIVEN), len(GIVEN) + 1, len(GIVEN) + 2
"""Indices of further arguments of a function that parts share."""


@dataclass(frozen=True)
class Assembled:
    """Parts of the solver of an assembly.

    Attributes:
        blocks: blocks of the Jacobian.
        residual: the residual in parts.
        jacobian: entries of ∂ residual / ∂x in parts.
        input_jacobian: ∂ residual / ∂ (inputs, parameters) in parts, entries by their index in the dense matrix.
    """

    blocks: Blocks
    residual: Parted
    jacobian: Parted
    input_jacobian: Parted

    @property
    def kernels(self) -> list[Kernel]:
        """All functions; functions of the residual compute four intervals at a time."""
        of_residual = map(with_calls_in_fours, self.residual.kernels)
        return [*of_residual, *self.jacobian.kernels, *self.input_jacobian.kernels]


def assembled(model: Model, names: Names) -> Assembled | None:
    """Make the equations of an assembly in parts; None if one dense Jacobian suffices."""
    partition = blocks(model.discrete, model.path_jacobian.sparsity_out(0))
    if partition is None:
        return None
    residual = _path_function(with_parameters_behind_inputs(model.path_residual), dense=True)
    by_inputs = _path_function(input_jacobian(model))
    return Assembled(
        blocks=partition,
        residual=parted(residual, partition.parts, names.kernel("residual")),
        jacobian=_jacobian(model, partition, names.kernel("jacobian")),
        input_jacobian=parted_by_rows(by_inputs, partition.parts, names.kernel("input_jacobian")),
    )


def _jacobian(model: Model, partition: Blocks, name: str) -> Parted:
    """Make ∂ residual / ∂x in parts, by columns if it has such a form."""
    by_columns = None if model.discrete.pairs else parted_by_columns(model, partition, name)
    if by_columns is not None:
        return by_columns
    jacobian = with_parameters_behind_inputs(model.path_jacobian)
    return parted(jacobian, partition.entry_parts, name)


def _path_function(function: ca.Function, *, dense: bool = False) -> ca.Function:
    """Make a map (x, inputs, factor) ↦ result from a function that may not depend on the factor."""
    symbols = function.mx_in()
    result = function.call(symbols)[0]
    given = symbols if len(symbols) == 3 else [*symbols, ca.MX.sym("factor")]
    return ca.Function("path", given, [ca.densify(result) if dense else result])


@dataclass(frozen=True)
class _Piece:
    """Entries of one owner.

    Attributes:
        stream: instructions of the entries, then of a column of the rod.
        column: columns of the rod; None for entries that do not depend on columns.
        entries: indices of the entries in the whole.
    """

    stream: Stream
    column: ColumnPart | None
    entries: list[int]

    @property
    def key(self) -> Hashable:
        """Key of all pieces with equal instructions: values, and the entries that they read of columns and turns."""
        if self.column is None:
            return self.stream.key
        return self.stream.key, tuple(self.stream.reads[COLUMNS]), tuple(self.stream.reads[TURNS])


def parted_by_columns(model: Model, blocks: Blocks, name: str) -> Parted | None:
    """Make the Jacobian of an assembly in parts by columns.

    Args:
        model: the model of the assembly.
        blocks: blocks of the Jacobian.
        name: prefix of the names of kernels, before their numbers.

    Returns:
        the parts, with loops if they have more than MOST_IN_COLUMNS statements; None if entries of one owner depend on
        the columns of several rods, or if an operation has no form for four numbers at a time.
    """
    jacobian = columned_jacobian(on_path(model))
    if jacobian is None:
        return None
    _, _, result = jacobian.scalars
    if not result.sparsity().is_subset(blocks.pattern):
        return None
    entries = ca.project(result, blocks.pattern).nonzeros()
    pieces = []
    long = list[list[int]]()
    for own in places_by_owner(blocks.entry_parts):
        of_own = ca.vertcat(*[entries[i] for i in own])
        rods = jacobian.rods_of(of_own)
        if len(rods) > 1:
            return None
        function, part = _function(jacobian, of_own, rods)
        if function.n_instructions() > SHARED_AT_MOST * MOST_IN_COLUMNS:
            long.append(own)
        else:
            pieces.append(_Piece(Stream.settled(function), part, own))
    kernels = list[Kernel]()
    parts = list[Part]()
    try:
        for group in alike(piece.key for piece in pieces):
            members = [pieces[i] for i in group]
            kernel, constants = _shared_kernel(members, f"{name}_{len(kernels)}")
            if kernel.n_instructions() > MOST_IN_COLUMNS:
                long += [piece.entries for piece in members]
                continue
            for piece, values in zip(members, constants, strict=True):
                parts.append(Part(len(kernels), piece.stream.reads[:COLUMNS], values, piece.entries))
            kernels.append(kernel)
    except UnknownOperationError:
        return None
    rest = in_loops(with_parameters_behind_inputs(model.path_jacobian), long, name, len(kernels))
    return None if rest is None else Parted([*kernels, *rest.kernels], [*parts, *rest.parts])


def _function(jacobian: ColumnedJacobian, entries: ca.SX, rods: Sequence[str]) -> tuple[ca.Function, ColumnPart | None]:
    """Make the function of entries, followed by a column of the rod on which they depend, if there is one."""
    if not rods:
        given, _, _ = jacobian.scalars
        return ca.Function("part", given, [entries], *names_of_part(ARGUMENTS[:3])), None
    part = jacobian.part(entries, rods[0])
    both = ca.vertcat(part.entries, part.column)
    return ca.Function("part", part.symbols, [both], *names_of_part([*ARGUMENTS[:3], "columns", "turns"])), part


def _shared_kernel(pieces: Sequence[_Piece], name: str) -> tuple[Kernel, list[list[float]]]:
    """Make a kernel for pieces with equal instructions, and the constants of each."""
    kernel, constants = shared([piece.stream for piece in pieces], name)
    columns = [piece.column for piece in pieces if piece.column is not None]
    if not columns:
        return kernel, constants
    turns = [column.turns for column in columns]
    same = all(same_but_for_rounding(own, turns[0]) for own in turns)
    form = _form(kernel, pieces[0].stream, columns[0], turns_are_constant=same)
    if not same:
        # Rods of different length turn by different constants.
        constants = [[*values, *in_groups(own).tolist()] for values, own in zip(constants, turns, strict=True)]
    return columns_in_fours(form, _by_columns(form, name)), constants


def _form(kernel: ca.Function, stream: Stream, part: ColumnPart, *, turns_are_constant: bool) -> ColumnForm:
    """Make a form, which takes all columns and turns, of a shared function that takes only those it reads."""
    symbols = kernel.sx_in()
    own_constants = symbols[CONSTANTS]
    constants = own_constants
    turns_behind = None
    if not turns_are_constant:
        turns_behind = own_constants.numel()
        constants = ca.vertcat(own_constants, ca.SX.sym("all_turns", part.turns.size))
    columns = ca.SX.sym("columns", part.symbols[COLUMNS].numel())
    turns = ca.SX.sym("turns", part.symbols[TURNS].numel())
    read = [*symbols[:COLUMNS], columns[stream.reads[COLUMNS]], turns[stream.reads[TURNS]], own_constants]
    result = kernel.call(read)[0]
    count = part.entries.numel()
    function = ca.Function(
        kernel.name(),
        [*symbols[:COLUMNS], constants, columns, turns],
        [result[:count], result[count:]],
        [*ARGUMENTS, "columns", "turns"],
        ["entries", "column"],
    )
    return ColumnForm(function, part.turns, part.column.numel(), turns_behind)


def _by_columns(form: ColumnForm, name: str) -> ca.Function:
    """Make the map (x, inputs, factor, constants) ↦ entries of a form with constants."""
    given = form.function.mx_in()[: form.columns_argument]
    turns = ca.MX(ca.DM(in_groups(form.turns)))
    if form.turns_behind is not None:
        turns = given[-1][form.turns_behind :]
    # One column of the reshaped turns for each entry and group, with the columns of the group in its rows.
    grouped = ca.reshape(turns, LANES, -1)
    no_columns = ca.MX(form.rows * form.stride, 1)
    columns = []
    for j in range(form.stride):
        first = (j // LANES) * len(form.turns)
        own_turns = grouped[j % LANES, first : first + len(form.turns)].T
        columns.append(form.function.call([*given, no_columns, own_turns])[1])
    one_row_after_the_other = ca.vec(ca.horzcat(*columns).T)
    no_turns = ca.MX(len(form.turns), 1)
    entries = form.function.call([*given, one_row_after_the_other, no_turns])[0]
    return ca.Function(name, given, [ca.densify(entries)], *names_of_part(ARGUMENTS))
