"""Jacobians by columns: code for one column of a rod's variations computes four columns in the lanes of a vector.

Column j of the variation of a field depends on j only through the turns of the intervals by the j-th angular
coordinate (rod/tangent.py). So the Jacobian falls into three parts:

    no columns            functions of x, inputs and load factor, or of other arguments
    columns               functions of these arguments and of a column of turns, which is constant
    the rest              the Jacobian from its columns

Parameters are appended to the inputs, as in every vector of inputs of the solver in C.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.parameters import with_parameters_behind_inputs
from cosserat_casadi.compiling.listing import LANES, with_shorter_calls
from cosserat_casadi.compiling.printed_kernels import ColumnForm
from cosserat_casadi.maths.calls import in_scalars
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import PARAMETERS, FunctionSpec, expressions_of
from cosserat_casadi.model.scene_equations import SceneEquations
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.rod.tangent import Columns, Tangent

SHARED_AT_MOST = 2
"""Upper bound of the number of instructions of a function before common terms are shared, over the number after.

The ratio is 1.0 to 1.6 on the scenes of examples/. To share common terms takes most of the time for a long function.
"""

GIVEN = ["x", "inputs", "load_factor"]
"""Arguments of the equations on the path of loads."""


@dataclass(frozen=True)
class RodColumns:
    """The columns of one rod, as a function of the turns of a column.

    Attributes:
        of_one: (arguments, turns) ↦ all rows of one column, in scalars.
        pattern: sparsity of the matrix of all columns.
        turns: constant turns of all columns, shape (entries, count).
    """

    of_one: ca.Function
    pattern: ca.Sparsity
    turns: FloatArray

    @property
    def stride(self) -> int:
        """Number of columns, rounded up to a multiple of LANES."""
        return int(self.padded_turns.shape[1])

    @cached_property
    def padded_turns(self) -> FloatArray:
        """The turns, padded with zero columns to the stride."""
        return _padded(self.turns)


def _turns(tangent: Tangent) -> tuple[FloatArray, ca.MX, ca.MX]:
    """Turns of the intervals that any column has, shape (entries, count), a symbol of those of one, and all its turns.

    Strains of few modes have no turns of some orders.
    """
    turns = tangent.turn_matrix.unfolded.full()
    rows = np.flatnonzero(turns.any(axis=1)).tolist()
    turn = ca.MX.sym("turns", len(rows))
    pattern = ca.Sparsity.triplet(len(turns), 1, rows, [0] * len(rows))
    return turns[rows], turn, ca.MX(pattern, turn)


def _padded(turns: FloatArray) -> FloatArray:
    """Pad turns with zero columns to a multiple of LANES columns."""
    entries, count = turns.shape
    padded = np.zeros((entries, -(-count // LANES) * LANES))
    padded[:, :count] = turns
    return padded


@dataclass(frozen=True)
class WrittenJacobian:
    """A Jacobian in which columns may be replaced by symbols.

    Attributes:
        arguments: symbols of its arguments, by name.
        system: rods in these symbols.
        of_system: function of these rods, whose columns may be given ↦ Jacobian.
        gathered: function of the arguments and further ones ↦ the function with its arguments in C.
        given: names of the arguments in C.
    """

    arguments: Mapping[str, ca.MX]
    system: System
    of_system: Callable[[System], Matrix]
    gathered: Callable[[ca.Function], ca.Function]
    given: Sequence[str]


def on_path(model: Model) -> WrittenJacobian:
    """Make the Jacobian on the path of loads."""
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    load_factor = ca.MX.sym("load_factor")
    arguments = {"x": x, "inputs": inputs, "load_factor": load_factor}
    if model.parameters.size:
        arguments = {"x": x, "inputs": inputs, PARAMETERS: model.parameters.symbol, "load_factor": load_factor}
    system = System(model.discrete, Arguments(x, inputs, load_factor))
    return WrittenJacobian(
        arguments, system, lambda known: SceneEquations(known).jacobian, with_parameters_behind_inputs, GIVEN
    )


class ColumnedJacobian:
    """A Jacobian as a function of the columns of its rods.

    Attributes:
        given: names of its arguments.
        rods: columns by the name of the rod, for rods whose intervals turn and pass moments on.
        of_columns: (arguments, matrix of columns of each rod …) ↦ Jacobian, in scalars.
    """

    def __init__(self, written: WrittenJacobian) -> None:
        self._written = written
        self.given = list(written.given)
        tangents = written.system.tangents
        passing = {name: tangent for name, tangent in tangents.items() if tangent.moments_pass}
        self.rods = {name: self._rod_columns(tangent) for name, tangent in passing.items()}
        symbols = {name: ca.MX.sym("columns", rod.pattern) for name, rod in self.rods.items()}
        known = {name: _unstacked(passing[name].columns, columns) for name, columns in symbols.items()}
        jacobian = written.of_system(replace(written.system, columns=known))
        self.of_columns = self._scalar("of_columns", list(symbols.values()), jacobian)

    def _rod_columns(self, tangent: Tangent) -> RodColumns:
        turns, turn, every = _turns(tangent)
        one = _stacked(Tangent(tangent.igm, turns=every).columns)
        pattern = _stacked(tangent.columns).sparsity()
        return RodColumns(self._scalar("of_one", [turn], ca.densify(one)), pattern, turns)

    def _scalar(self, name: str, further: Sequence[ca.MX], result: Matrix) -> ca.Function:
        """Make the map (arguments, further …) ↦ result in scalars."""
        arguments = self._written.arguments
        words = [*arguments, *(f"further_{i}" for i in range(len(further)))]
        function = ca.Function(name, [*arguments.values(), *further], [result], words, ["result"])
        return self._written.gathered(function).expand()

    @cached_property
    def scalars(self) -> tuple[list[ca.SX], dict[str, ca.SX], ca.SX]:
        """Symbols of the arguments, symbols of the columns by rod, and the Jacobian in these symbols."""
        function = self.of_columns
        symbols = function.sx_in()
        count = len(self.given)
        columns = dict(zip(self.rods, symbols[count:], strict=True))
        return symbols[:count], columns, function.call(symbols)[0]

    def rods_of(self, entries: ca.SX) -> list[str]:
        """Names of the rods on whose columns some expressions of :attr:`scalars` depend."""
        _, columns, _ = self.scalars
        return [rod for rod, symbols in columns.items() if ca.depends_on(entries, ca.vertcat(*symbols.nonzeros()))]

    def part(self, entries: ca.SX, rod: str) -> ColumnPart:
        """Return some entries of the Jacobian, which depend on the columns of this rod alone.

        Args:
            entries: expressions of :attr:`scalars`.
            rod: name of the rod.
        """
        given, columns, _ = self.scalars
        own = self.rods[rod]
        symbols = columns[rod]
        places = list(zip(*own.pattern.get_triplet(), symbols.nonzeros(), strict=True))
        needed = ca.which_depends(entries, ca.vertcat(*symbols.nonzeros()), 1, False)
        rows = sorted({row for (row, _, _), is_read in zip(places, needed, strict=True) if is_read})
        number_of = {row: number for number, row in enumerate(rows)}
        matrix = ca.SX.sym("columns", len(rows) * own.stride)
        replaced = []
        replacing = []
        for row, j, symbol in places:
            if row in number_of:
                replaced.append(symbol)
                replacing.append(matrix[number_of[row] * own.stride + j])
        in_matrix = ca.substitute(entries, ca.vertcat(*replaced), ca.vertcat(*replacing))
        turns = ca.SX.sym("turns", own.turns.shape[0])
        column = own.of_one.call([*given, turns])[0][rows]
        return ColumnPart(self.given, [*given, matrix, turns], in_matrix, column, own.padded_turns)


@dataclass(frozen=True)
class ColumnPart:
    """Entries of a Jacobian, and one of the columns from which they follow, as scalar expressions.

    Attributes:
        given: names of the arguments.
        symbols: symbols of the arguments, of the matrix of columns, and of the turns of one column.
        entries: the entries.
        column: rows of one column.
        turns: constant turns of all columns, as in :class:`ColumnForm`.
    """

    given: Sequence[str]
    symbols: list[ca.SX]
    entries: ca.SX
    column: ca.SX
    turns: FloatArray

    def form(self, name: str) -> ColumnForm:
        """Make one scalar function of entries and column, with common terms shared."""
        shared = ca.cse([self.entries, self.column])
        words = [*self.given, *_words_of_columns(name)]
        function = ca.Function(name, self.symbols, shared, words, ["jacobian", "column"])
        return ColumnForm(with_shorter_calls(function), self.turns, self.column.numel())


def columned_jacobian(written: WrittenJacobian) -> ColumnedJacobian | None:
    """Write a Jacobian by columns; None if no rod has columns."""
    if any(rod.discretisation.transport == "permuted" for rod in written.system.discrete.rods.values()):
        return None
    jacobian = ColumnedJacobian(written)
    return jacobian if jacobian.rods else None


def in_columns(written: WrittenJacobian, name: str, most: int | None = None) -> ColumnForm | None:
    """Write the Jacobian of one rod by columns; None if it has no such form, or surely one with too many statements.

    Args:
        written: the Jacobian.
        name: name of the function.
        most: largest number of statements, unlimited by default.
    """
    if len(written.system.discrete.rods) != 1:
        return None
    jacobian = columned_jacobian(written)
    if jacobian is None:
        return None
    (rod,) = jacobian.rods
    apart = jacobian.of_columns.n_instructions() + jacobian.rods[rod].of_one.n_instructions()
    if most is not None and SHARED_AT_MOST * most < apart:
        return None
    _, _, entries = jacobian.scalars
    return jacobian.part(ca.densify(entries), rod).form(name)


def pose_in_columns(model: Model, spec: FunctionSpec, owner: str, name: str) -> ColumnForm | None:
    """Write the derivatives of a pose on the rod of a scene by all arguments, by columns; None without such a form.

    A column for an angular strain coordinate follows from its turns alone; other coordinates have no such columns.

    Args:
        model: model of the scene.
        spec: entry in the table of functions; its first result is the derivative by x.
        owner: owner of the function.
        name: name of the form.
    """
    discrete = model.discrete
    if len(discrete.rods) != 1:
        return None
    ((rod, discrete_rod),) = discrete.rods.items()
    if discrete_rod.discretisation.transport == "permuted" or not discrete_rod.angular:
        return None
    written = expressions_of(model, tuple(spec.arguments_of(discrete)), owner)
    turns, turn, every_turn = _turns(written.system.pose_variations(rod))
    of_one = replace(written.system, turns={rod: every_turn})
    derivatives = spec.write(model, replace(written, known={System: of_one}))
    assert derivatives is not None, "every section has a pose"
    by_unknowns, *others = derivatives
    first = discrete.unknowns.strain(rod).start
    padded = _padded(turns)
    rows, stride = by_unknowns.shape[0], padded.shape[1]
    columns = ca.MX.sym("columns", rows * stride)
    every = ca.reshape(columns, stride, rows).T[:, : turns.shape[1]]
    whole = ca.horzcat(by_unknowns[:, :first], every, by_unknowns[:, first + 1 :])
    results = [*map(ca.densify, [whole, *others]), by_unknowns[:, first]]
    words = [*written.symbols, *_words_of_columns(name)]
    results_by_name = [f"result_{i}" for i in range(len(results))]
    plain = ca.Function(name, [*written.symbols.values(), columns, turn], results, words, results_by_name)
    return ColumnForm(with_shorter_calls(in_scalars(plain, name)), padded, rows)


def _words_of_columns(name: str) -> list[str]:
    """Names of the last two arguments of a form, unique to it, because functions share arguments of equal names."""
    return [f"{name}_columns", f"{name}_turns"]


def _parts(columns: Columns) -> list[Matrix]:
    """List the parts of columns, from top to bottom."""
    return [columns.section_rotation, columns.angular, *columns.linear.values(), *columns.following.values()]


def _stacked(columns: Columns) -> Matrix:
    return ca.vertcat(*_parts(columns))


def _unstacked(alike: Columns, every: ca.MX) -> Columns:
    """Split stacked columns into parts like those of other columns of the rod."""
    ends = np.cumsum([0, *(part.shape[0] for part in _parts(alike))]).tolist()
    rotation, angular, *further = ca.vertsplit(every, ends)
    count = len(alike.linear)
    linear: dict[int, Matrix] = dict(zip(alike.linear, further[:count], strict=True))
    following: dict[int, Matrix] = dict(zip(alike.following, further[count:], strict=True))
    return Columns(rotation, angular, linear, following)
