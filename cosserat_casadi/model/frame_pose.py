"""Poses of floating frames as expressions of their unknowns, and how they move with them.

The unknowns of a frame are the deviations (p − p₀)/ℓ and Q − Q₀ of docs/theory.md, section 8. The quaternion is not
held to norm 1 here, only its direction counts: an equation of the balance makes its norm one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.floating_frames import FloatingFrame


@dataclass(frozen=True)
class FramePose:
    """World pose of a floating frame from its unknowns.

    Attributes:
        frame: the frame.
        deviation: its unknowns, 7×1.
    """

    frame: FloatingFrame
    deviation: Matrix

    @cached_property
    def position(self) -> Matrix:
        """Position p, 3×1, m."""
        start = ca.DM(self.frame.start.position)
        return start + self.frame.length * self.deviation[:3]

    @cached_property
    def quaternion(self) -> Matrix:
        """Quaternion Q, 4×1, not zero and of any norm."""
        start = ca.DM(self.frame.start.quaternion)
        return start + self.deviation[3:]

    @cached_property
    def pose(self) -> Pose:
        """The pose, with the quaternion of norm 1."""
        norm = ca.sqrt(ca.sumsqr(self.quaternion))
        return Pose(self.position, self.quaternion / norm)

    @property
    def motion(self) -> Matrix:
        """B: motion [δθ; δr] of the frame with its unknowns, 6×7, world axes."""
        turn = turn_matrix(self.quaternion)
        rotation_rows = ca.horzcat(ca.DM(3, 3), turn)
        position_rows = ca.horzcat(self.frame.length * ca.DM.eye(3), ca.DM(3, 4))
        return ca.vertcat(rotation_rows, position_rows)


def turn_matrix(quaternion: Matrix) -> Matrix:
    """Matrix T from δQ to δθ in world axes, 3×4: δθ = 2 vec(δQ ⊗ Q*) / Q·Q."""
    w, x, y, z = ca.vertsplit(2 * quaternion / ca.sumsqr(quaternion))
    return ca.blockcat([[-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])
