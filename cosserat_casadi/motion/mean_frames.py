"""Mean frames of a rod that flies free, from its momentum: see :mod:`numerics.mean_frame`."""

from __future__ import annotations

import casadi as ca
import numpy as np

from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.momentum import MOMENTA
from cosserat_casadi.motion.repeated_call import RepeatedCall
from cosserat_casadi.numerics.mean_frame import MeanFrame


class MeanFrames:
    """The mean frames of a model over its unknowns.

    Args:
        model: of one rod that flies free, see :func:`motion.momentum.flies_alone`.
    """

    def __init__(self, model: Model) -> None:
        ((_, entries),) = model.discrete.unknowns.of_kind(BlockKind.POSE)
        (frame,) = model.discrete.frames.values()
        self._poses = np.arange(entries.start, entries.stop)
        self._start = frame.start.quaternion
        self._rows = RepeatedCall(_momentum_rows(model))

    def at(self, x: FloatArray, inputs: FloatArray) -> MeanFrame:
        """The mean frame at unknowns of shape (size,) and stacked inputs."""
        (frame,) = self.along(x[None], inputs)
        return frame

    def along(self, x: FloatArray, inputs: FloatArray) -> list[MeanFrame]:
        """The mean frames at instants so near to each other that the shape is about that of the middle one.

        In the axes of the base the share of a shape in the mean motion depends on the shape alone.

        Args:
            x: unknowns, shape (k, size).
            inputs: stacked inputs at the middle instant.
        """
        middle = x[len(x) // 2]
        turn = self._turn(middle[self._poses])
        share = turn @ self._share(middle, inputs)
        frames = []
        for unknowns in x:
            turn = self._turn(unknowns[self._poses])
            frames.append(MeanFrame(self._poses, turn, turn.T @ share))
        return frames

    def _share(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """What the rates of the strains are in the mean motion, shape (7, size); not finite where momentum is not."""
        rows = self._rows(x, inputs).reshape(-1, MOMENTA).T
        if not np.all(np.isfinite(rows)):
            return np.full((len(self._poses), len(x)), np.nan)
        # The least rates: none along the norm of the quaternion, which no momentum belongs to.
        share = np.linalg.pinv(rows[:, self._poses]) @ rows
        share[:, self._poses] = 0.0
        return np.asarray(share)

    def _turn(self, deviation: FloatArray) -> FloatArray:
        """From world axes to those of the base, and from rates of its quaternion to spins about them, shape (7, 7)."""
        quaternion = self._start + deviation[3:]
        quaternion = quaternion / np.linalg.norm(quaternion)
        turn = np.zeros((7, 7))
        turn[:3, :3] = quaternion_to_matrix(quaternion).T
        turn[3:, 3:] = _spins(quaternion).T
        return turn


def _spins(quaternion: FloatArray) -> FloatArray:
    """A unit quaternion, and its products with i, j and k, one a column, orthonormal, shape (4, 4)."""
    w, x, y, z = quaternion
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])


def _momentum_rows(model: Model) -> ca.Function:
    """(x, inputs) ↦ derivatives of momentum and angular momentum with velocities, one row below the other."""
    x, v = (ca.MX.sym(name, model.size) for name in ("x", "v"))
    inputs = ca.MX.sym("inputs", model.inputs.size)
    momentum = ca.vertcat(*model.momentum(x, v, inputs, ca.MX.zeros(model.inputs.size)))
    gradients = ca.jtimes(momentum, v, ca.DM.eye(MOMENTA), True)
    of_any = ca.graph_substitute(gradients, [v], [ca.MX.zeros(model.size)])
    return ca.Function("momentum_rows", [x, inputs], [ca.densify(ca.vec(of_any.T))])
