"""Functions with derivatives of their results, and steps along a robot with derivatives of its state.

A robot changes with its unknowns, with the translations of its tubes, which move the ends of its pieces, with its
loads, and with its parameters. Steps are taken once for all of these directions: quantities that do not depend on the
direction are computed once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.tubes.robot import Robot
from cosserat_casadi.tubes.stages import Staged, composed


@dataclass(frozen=True)
class Directions:
    """Directions in which a robot changes: its m unknowns, its n translations, the numbers of its loads, parameters.

    Attributes:
        robot: the tubes.
        unknowns: number of unknowns.
    """

    robot: Robot
    unknowns: int

    @property
    def count(self) -> int:
        """Number of directions."""
        return self.unknowns + len(self._moving) + self.robot.parameters.size

    @property
    def translations(self) -> slice:
        """Directions that are translations."""
        return slice(self.unknowns, self.unknowns + self.robot.size)

    @property
    def parameters(self) -> slice:
        """Directions that are parameters."""
        first = self.unknowns + len(self._moving)
        return slice(first, first + self.robot.parameters.size)

    @property
    def stretching(self) -> list[int]:
        """Directions that change the lengths of pieces: translations and parameters."""
        every = list(range(self.count))
        return [*every[self.translations], *every[self.parameters]]

    @cached_property
    def _moving(self) -> list[int]:
        """Indices of the inputs except rotations, which act at the drives alone."""
        size = self.robot.size
        return [*range(1, 2 * size, 2), *range(2 * size, self.robot.inputs.size)]

    @property
    def of_x(self) -> ca.DM:
        """Changes of the unknowns, a column for each direction."""
        return self._among(ca.DM.eye(self.unknowns), slice(0, self.unknowns))

    @property
    def of_inputs(self) -> ca.DM:
        """Changes of the inputs, a column for each direction."""
        size = self.robot.inputs.size
        return self._among(ca.DM.eye(size)[:, self._moving], slice(self.unknowns, self.parameters.start))

    @property
    def of_given(self) -> list[ca.DM]:
        """Changes of the inputs, then of the parameters if there are any."""
        if not self.robot.parameters.size:
            return [self.of_inputs]
        return [self.of_inputs, self._among(ca.DM.eye(self.robot.parameters.size), self.parameters)]

    def _among(self, columns: ca.DM, place: slice) -> ca.DM:
        """Place the columns of some directions among the columns of all directions."""
        among = ca.DM(columns.size1(), self.count)
        among[:, place] = columns
        return among

    def by_inputs(self, changes: Matrix, by_rotations: Matrix) -> Matrix:
        """Arrange derivatives by all inputs in their order.

        Args:
            changes: a column for each direction.
            by_rotations: derivatives by the rotations, a column for each tube.
        """
        size = self.robot.size
        columns = [changes[:, self.unknowns + index] for index in range(len(self._moving))]
        ordered: list[Matrix] = []
        for index in range(size):
            ordered += [by_rotations[:, index], columns[index]]
        return ca.horzcat(*ordered, *columns[size:])


def with_changes(function: ca.Function, directions: Directions, fixed: Mapping[int, ca.DM]) -> ca.Function:
    """Make (arguments, changes of some) ↦ (results, their changes): a function with derivatives in all directions.

    Args:
        function: function of column vectors, with results that are columns.
        directions: directions of the changes.
        fixed: constant changes of arguments by index, a column for each direction. Changes of the other arguments are
            appended to the arguments, in their order.
    """
    symbols = [ca.SX.sym(function.name_in(index), function.size1_in(index)) for index in range(function.n_in())]
    changes: list[Matrix] = []
    given = []
    for index, symbol in enumerate(symbols):
        if index in fixed:
            changes.append(ca.SX(fixed[index]))
        else:
            change = ca.SX.sym(f"{function.name_in(index)}_change", symbol.size1(), directions.count)
            changes.append(change)
            given.append(change)
    results = function.call(symbols)
    moved = [ca.jtimes(result, ca.vertcat(*symbols), ca.vertcat(*changes)) for result in results]
    every = [ca.densify(expression) for expression in ca.cse([*results, *moved])]
    return ca.Function(f"{function.name()}_changes", [*symbols, *given], every)


def changing_step(staged: Staged, directions: Directions) -> ca.Function:
    """Make (stacked, lengths, section) ↦ stacked: a step of the state and its changes.

    The stacked vector consists of the state, the carried numbers, and the changes of both by columns. The lengths are
    the length of the step and its derivatives in the directions that stretch it. The section is without the carried
    numbers, and is followed by its changes with the parameters, by columns.
    """
    stacked = ca.SX.sym("stacked", staged.width_with_carried * (1 + directions.count))
    before, length = (ca.SX.sym(name, 1 + len(directions.stretching)) for name in ("before", "length"))
    width = staged.stage.size1_in(3) - staged.carried
    section = ca.SX.sym("section", width * (1 + directions.robot.parameters.size))
    stage = _changed(staged, staged.stage, directions, stacked, [before, length], section)
    last = _changed(staged, staged.last, directions, stacked, [length], section)
    return composed(
        "changing_step",
        ca.Function("changing_stage", [stacked, before, length, section], [stage]),
        ca.Function("changing_last", [stacked, length, section], [last]),
    )


def _changed(
    staged: Staged,
    function: ca.Function,
    directions: Directions,
    stacked: ca.SX,
    lengths: list[ca.SX],
    section: ca.SX,
) -> Matrix:
    """Take a stage of the state and its changes; arguments as for :func:`changing_step`."""
    width = staged.width_with_carried
    state = stacked[: staged.width]
    carried = stacked[staged.width : width]
    constants = section[: staged.stage.size1_in(3) - staged.carried]
    after = function(state, *[length[0] for length in lengths], ca.vertcat(constants, carried))
    # Nobody asks for the energy here: without it, it costs nothing.
    after[staged.energy] = 0
    changes = ca.reshape(stacked[width:], width, directions.count)
    of_lengths = ca.SX(len(lengths), directions.count)
    for index, length in enumerate(lengths):
        of_lengths[index, directions.stretching] = length[1:].T
    of_constants = ca.SX(constants.size1(), directions.count)
    of_constants[:, directions.parameters] = ca.reshape(section[constants.size1() :], constants.size1(), -1)
    arguments = ca.vertcat(stacked[:width], *[length[0] for length in lengths], constants)
    moved = ca.jtimes(ca.vertcat(after, carried), arguments, ca.vertcat(changes, of_lengths, of_constants))
    both: Matrix = ca.cse(ca.vertcat(after, carried, ca.vec(ca.densify(moved))))
    return both
