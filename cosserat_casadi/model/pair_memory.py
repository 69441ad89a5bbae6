"""The history of friction between two rods: where sections were at the last point of a path, and how far dragged.

The way of two sections past each other is that of the points that touch since the last point of the path, and how far
the section of the first rod was dragged then. So a section that comes to touch another one keeps its drag.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.contact_pairs import ContactPair

POSE = 12
"""Numbers of a pose at a node: position, m, and rotation matrix, column after column."""


@dataclass(frozen=True)
class PairHistory:
    """The history of a pair.

    Attributes:
        drag: how far the sections of the first rod are dragged, 3×k, m, world axes.
        poses: of each rod at the nodes of its grid, POSE×M, world axes; zeros before anything is known.
    """

    drag: Matrix
    poses: Mapping[str, Matrix]

    @classmethod
    def of_column(cls, column: Matrix, pair: ContactPair, grids: Mapping[str, Grid]) -> PairHistory:
        """From the input, whose sections may be others than those of the pair are now.

        Args:
            column: the input, h×1.
            pair: the pair.
            grids: of the rods, when it was remembered.
        """
        poses = {}
        for name in dict.fromkeys(pair.rods):
            count = POSE * grids[name].size
            poses[name] = ca.reshape(column[:count], POSE, grids[name].size)
            column = column[count:]
        return cls(ca.reshape(column, 3, column.shape[0] // 3), poses)

    @property
    def column(self) -> Matrix:
        """As the input, h×1."""
        return ca.vertcat(*[ca.vec(poses) for poses in self.poses.values()], ca.vec(self.drag))

    @property
    def is_known(self) -> Matrix:
        """One where there is a history, zero before there is one, 1×1: rotations are none then."""
        return ca.sumsqr(next(iter(self.poses.values()))[3:, 0]) / 3

    def drag_at(self, coordinates: FloatArray) -> Matrix:
        """Drag at sections at these coordinates from 0 to 1, 3×S."""
        count = self.drag.shape[1]
        chosen = np.minimum((coordinates * count).astype(int), count - 1)
        return self.drag[:, chosen.tolist()]


def history_size(pair: ContactPair, grids: Mapping[str, Grid]) -> int:
    """Numbers that friction of a pair remembers, of rods on these grids."""
    return 3 * pair.sections[0] + POSE * sum(grids[name].size for name in set(pair.rods))
