"""The Jacobian of a rod's scene by columns: what computes one column computes four in the lanes of a vector.

Column j of the variation of a field follows from the turns of the intervals with the j-th angular coordinate, and from
nothing else that has a number j (rod/tangent.py). So the Jacobian falls into three parts:

    what has no columns   functions of x, inputs and load factor
    columns               functions of those and of a column of turns, which is constant
    what remains          the Jacobian from its columns
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.equations import Equations
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.rod.tangent import Columns, Tangent

LANES = 4
"""Columns that are computed together."""

COLUMNS, TURNS = 3, 4
"""Numbers of two arguments of :attr:`ColumnForm.function`."""


@dataclass(frozen=True)
class ColumnForm:
    """A Jacobian by columns.

    Attributes:
        function: (x, inputs, load_factor, columns, turns) ↦ (jacobian, column). The column follows from the turns, and
            the Jacobian from the matrix of all columns, one row of it after the other.
        turns: constant turns of all columns, shape (entries, stride), with zeros behind the last one.
        rows: rows of the matrix of columns.
    """

    function: ca.Function
    turns: FloatArray
    rows: int

    @property
    def stride(self) -> int:
        """Columns of that matrix, a multiple of LANES."""
        return int(self.turns.shape[1])


def in_columns(model: Model, name: str) -> ColumnForm | None:
    """The Jacobian on the path of loads by columns; None for a model that has no such form.

    Args:
        model: whose Jacobian it is.
        name: what the function is called.
    """
    discrete = model.discrete
    literal = any(chosen.transport == "permuted" for chosen in model.discretisation.values())
    if literal or len(discrete.rods) != 1 or model.parameters.size:
        return None
    (rod,) = discrete.rods
    arguments = Arguments(ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size), ca.MX.sym("load_factor"))
    given = [arguments.x, arguments.inputs, arguments.load_factor]
    tangent = System(discrete, arguments).tangents[rod]
    if not tangent.moments_pass:
        return None
    turns = tangent.turn_matrix.unfolded.full()
    every = ca.MX.sym("columns", sum(_heights(tangent)), turns.shape[1])
    equations = Equations(System(discrete, arguments, {rod: _unstacked(tangent, every)}))
    of_every = ca.Function("of_every", [*given, every], [ca.densify(equations.jacobian)]).expand()
    read = _rows_read(of_every)
    turn = ca.MX.sym("turns", turns.shape[0])
    one = _stacked(Tangent(tangent.igm, turns=turn).columns)
    of_one = ca.Function("of_one", [*given, turn], [ca.densify(one)[read]])
    padded = np.zeros((turns.shape[0], -(-turns.shape[1] // LANES) * LANES))
    padded[:, : turns.shape[1]] = turns
    return ColumnForm(_joined(of_every, of_one, read, padded.shape[1], name), padded, len(read))


def _joined(of_every: ca.Function, of_one: ca.Function, read: list[int], stride: int, name: str) -> ca.Function:
    """Both as one scalar function, with common terms shared."""
    given = [ca.SX.sym(of_every.name_in(i), of_every.sparsity_in(i)) for i in range(COLUMNS)]
    columns = ca.SX.sym("columns", len(read) * stride)
    turns = ca.SX.sym("turns", of_one.size1_in(COLUMNS))
    height, count = of_every.size_in(COLUMNS)
    every = ca.SX(height, count)
    for place, row in enumerate(read):
        every[row, :] = columns[place * stride : place * stride + count].T
    jacobian = of_every.call([*given, every])[0]
    column = of_one.call([*given, turns])[0]
    names = ["x", "inputs", "load_factor", "columns", "turns"]
    shared = ca.cse([jacobian, column])
    return ca.Function(name, [*given, columns, turns], shared, names, ["jacobian", "column"])


def _rows_read(of_every: ca.Function) -> list[int]:
    """Rows of the columns that the Jacobian reads."""
    height = of_every.size1_in(COLUMNS)
    read = set()
    for k in range(of_every.n_instructions()):
        if of_every.instruction_id(k) == ca.OP_INPUT:
            argument, entry = of_every.instruction_input(k)
            if argument == COLUMNS:
                read.add(entry % height)
    return sorted(read)


def _heights(tangent: Tangent) -> list[int]:
    """Rows of the parts of a column."""
    linear = [tangent.rod.size_of(component) for component in tangent.rod.linear]
    return [3 * tangent.intervals, tangent.angular_size, *linear]


def _stacked(columns: Columns) -> Matrix:
    return ca.vertcat(columns.section_rotation, columns.angular, *columns.linear.values())


def _unstacked(tangent: Tangent, every: ca.MX) -> Columns:
    ends = np.cumsum([0, *_heights(tangent)]).tolist()
    rotation, angular, *linear = ca.vertsplit(every, ends)
    return Columns(rotation, angular, dict(zip(tangent.rod.linear, linear, strict=True)))
