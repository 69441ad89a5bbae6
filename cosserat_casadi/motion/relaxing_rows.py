"""Equations of Maxwell branches in small motions about rest, integrated once in time.

A branch obeys τ ẅ + ẇ − ξ̇ = 0 (rod/relaxation.py), which leaves the offset of w from ξ undetermined. For motions about
rest, where its spring is free, the integral is τ ẇ + w − ξ = 0, which introduces no rigid motions. Scaled by the
stiffness of its spring, and subtracted from the balance of the strains, it makes stiffness and damping symmetric, as
for a spring and a dashpot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.unknowns import BlockKind


@dataclass(frozen=True)
class BranchRows:
    """The rows of one branch of a rod.

    Attributes:
        strains: rows of the strains of the rod.
        flows: rows of the flow of the branch.
        spring: dimensionless stiffness of the spring, shape (n, n).
    """

    strains: slice
    flows: slice
    spring: FloatArray


def branch_rows(discrete: DiscreteScene, damping: FloatArray, mass: FloatArray) -> list[BranchRows]:
    """Find the rows of the branches of all rods.

    Args:
        discrete: the scene in motion.
        damping: ∂ residual/∂v, shape (size, size).
        mass: ∂ residual/∂a, shape (size, size).
    """
    branches = []
    for block, entries in discrete.unknowns.of_kind(BlockKind.FLOW):
        strains = discrete.unknowns.strain(block.owner)
        count = strains.stop - strains.start
        for first in range(entries.start, entries.stop, count):
            flows = slice(first, first + count)
            # The force of the spring is that of the dashpot, and the times stand where others have masses.
            branches.append(BranchRows(strains, flows, damping[strains, flows] / np.diag(mass[flows, flows])))
    return branches


def integrated(
    branches: Sequence[BranchRows], matrices: Sequence[FloatArray]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Integrate rows of the derivatives of the residual by some arguments, by their rates and by their second rates.

    Args:
        branches: branches whose rows are integrated.
        matrices: the three derivatives, with a row for each unknown; the first is zero in rows of branches.
    """
    by_value, by_rate, by_acceleration = (matrix.copy() for matrix in matrices)
    for branch in branches:
        by_value[branch.flows] = branch.spring @ by_rate[branch.flows]
        by_rate[branch.flows] = branch.spring @ by_acceleration[branch.flows]
        by_acceleration[branch.flows] = 0.0
        by_value[branch.strains] -= by_value[branch.flows]
        by_rate[branch.strains] -= by_rate[branch.flows]
    return by_value, by_rate, by_acceleration
