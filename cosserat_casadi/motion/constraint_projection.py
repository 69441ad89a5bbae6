"""Positions between the ends of steps put back on the constraints: supports, joints and cables are closed all along.

The polynomial of a step leaves the constraints by as much as it is inexact. The smallest displacement that closes them
is far below the tolerance of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.displacement import displacements

CLOSED = 1e-12
"""Largest row of a constraint, without unit, that counts as closed."""

MOST_CORRECTIONS = 4
"""Most corrections of a state, each with a new Jacobian."""


@dataclass(frozen=True)
class Closing:
    """Projection of the unknowns of a model on its constraints.

    Attributes:
        model: the model.
    """

    model: Model

    @cached_property
    def rows(self) -> npt.NDArray[np.int64]:
        """Rows of the residual that are constraints on positions alone."""
        discrete = self.model.discrete
        entries = [span for _, span in discrete.unknowns.of_kind(BlockKind.MULTIPLIER)]
        # The row of a cable that may go slack holds its tension too.
        taut = [cable for cable in discrete.cables if not EFFECTS[cable.tendon.kind].may_go_slack(cable.tendon)]
        entries += [discrete.tension(cable) for cable in taut]
        numbers = [np.arange(span.start, span.stop) for span in entries]
        return np.concatenate([np.zeros(0, dtype=np.int64), *numbers])

    def closed(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Unknowns moved by the smallest displacement that closes the constraints, shape (size,)."""
        if not len(self.rows):
            return x
        best = x
        before = np.inf
        for _ in range(MOST_CORRECTIONS):
            jacobian, residual = self.model.jacobian(x, inputs)
            gaps = residual.full()[self.rows, 0]
            largest = np.abs(gaps).max()
            if largest <= CLOSED:
                break
            # Where constraints are about to depend on each other corrections may lead away.
            if not largest < before:
                return best
            best = x
            before = largest
            x = x - self._correction(jacobian.full()[self.rows], gaps)
        return x

    def _correction(self, derivatives: FloatArray, gaps: FloatArray) -> FloatArray:
        """Smallest change of the coordinates that move, counted by their displacements, that takes gaps away."""
        moves = self.model.discrete.unknowns.differential
        weighted = np.where(moves, derivatives / self._sizes, 0.0)
        change, *_ = np.linalg.lstsq(weighted, gaps, rcond=None)
        return np.asarray(change / self._sizes)

    @cached_property
    def _sizes(self) -> FloatArray:
        return displacements(self.model)
