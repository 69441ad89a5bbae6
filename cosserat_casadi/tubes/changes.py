"""Functions with the changes of their results, and steps along a robot with the changes of its state.

A robot changes with its unknowns, with the translations of its tubes, which move the ends of its pieces, and with its
loads. Steps are taken once for all of these directions: what does not depend on the direction is computed once.
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
    """Directions in which a robot changes, in this order: its m unknowns, its n translations, the numbers of its loads.

    Attributes:
        robot: the tubes.
        unknowns: number of unknowns.
    """

    robot: Robot
    unknowns: int

    @property
    def count(self) -> int:
        """Number of directions."""
        return self.unknowns + len(self._moving)

    @property
    def translations(self) -> slice:
        """Which of them are translations."""
        return slice(self.unknowns, self.unknowns + self.robot.size)

    @cached_property
    def _moving(self) -> list[int]:
        """Inputs that are no rotations: those have an effect at the drives alone."""
        size = self.robot.size
        return [*range(1, 2 * size, 2), *range(2 * size, self.robot.inputs.size)]

    @property
    def of_x(self) -> ca.DM:
        """Changes of the unknowns, a column for each direction."""
        return ca.horzcat(ca.DM.eye(self.unknowns), ca.DM(self.unknowns, len(self._moving)))

    @property
    def of_inputs(self) -> ca.DM:
        """Changes of the inputs, a column for each direction."""
        size = self.robot.inputs.size
        chosen = ca.DM.eye(size)[:, self._moving]
        return ca.horzcat(ca.DM(size, self.unknowns), chosen)

    def by_inputs(self, changes: Matrix, by_rotations: Matrix) -> Matrix:
        """Derivatives with all inputs in their order.

        Args:
            changes: a column for each direction.
            by_rotations: derivatives with the rotations, a column for each tube.
        """
        size = self.robot.size
        columns = [changes[:, self.unknowns + index] for index in range(len(self._moving))]
        ordered: list[Matrix] = []
        for index in range(size):
            ordered += [by_rotations[:, index], columns[index]]
        return ca.horzcat(*ordered, *columns[size:])


def with_changes(function: ca.Function, directions: Directions, fixed: Mapping[int, ca.DM]) -> ca.Function:
    """(arguments, changes of some) ↦ (results, their changes): a function and its derivatives in all directions.

    Args:
        function: of column vectors, with results that are columns.
        directions: in which it changes.
        fixed: changes of arguments by index that are the same always, a column for each direction. Those of the other
            arguments are arguments behind them, in their order.
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
    """(stacked, lengths, section) ↦ stacked: a step of the state and its changes.

    Stacked are the state, the carried numbers, and the changes of both column after column. The lengths are the length
    of the step and its derivatives with the translations, (1 + n)×1; the section is without the carried numbers.
    """
    stacked = ca.SX.sym("stacked", staged.width_with_carried * (1 + directions.count))
    before, length = (ca.SX.sym(name, 1 + directions.robot.size) for name in ("before", "length"))
    section = ca.SX.sym("section", staged.stage.size1_in(3) - staged.carried)
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
    """The state and its changes after a stage."""
    width = staged.width_with_carried
    state = stacked[: staged.width]
    carried = stacked[staged.width : width]
    after = function(state, *[length[0] for length in lengths], ca.vertcat(section, carried))
    # Nobody asks for the energy here: without it, it costs nothing.
    after[staged.energy] = 0
    changes = ca.reshape(stacked[width:], width, directions.count)
    of_lengths = ca.SX(len(lengths), directions.count)
    for index, length in enumerate(lengths):
        of_lengths[index, directions.translations] = length[1:].T
    arguments = ca.vertcat(stacked[:width], *[length[0] for length in lengths])
    moved = ca.jtimes(ca.vertcat(after, carried), arguments, ca.vertcat(changes, of_lengths))
    both: Matrix = ca.cse(ca.vertcat(after, carried, ca.vec(ca.densify(moved))))
    return both
