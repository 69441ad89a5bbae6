"""One step along the robot: angles, torques, frame of the centre line and energy, composed of exact flows.

Between two places where a tube begins, bends or ends the tubes i have the elastic energy per length

    Σ GJᵢ αᵢ′²/2 + Σ EIᵢ |c − κᵢ e(αᵢ)|²/2,    e(α) = (cos α, sin α),

with the angle αᵢ of tube i against the frame that follows the centre line without turning about it (Bishop's), and the
curvature c of the centre line in the axes of that frame, in the direction of bending. Without loads c minimises the
energy, c = Σ EIᵢ κᵢ e(αᵢ) / Σ EIᵢ, and the rest is a Lagrangian of the angles alone: GJᵢ αᵢ′ = τᵢ and
τᵢ′ = −κᵢ EIᵢ e′(αᵢ)·c (P. E. Dupont, J. Lock, B. Itkowitz, E. Butler, IEEE Trans. Robot. 26 (2010) 209; D. C. Rucker,
R. J. Webster, G. S. Chirikjian, Int. J. Robot. Res. 29 (2010) 1263).

If the torques alone drive the angles, or the angles alone the torques and the frame, the equations are solved in
closed form. Half a step of the first, a step of the second, and half a step of the first form a symmetric, symplectic
step of order two; `tubes.stages` composes a step of order eight from it. See docs/tubes.md.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache
from typing import Self

import casadi as ca

from cosserat_casadi.maths.magnus import increment
from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.tubes.stages import SHARES, Staged


@dataclass(frozen=True)
class FlowState:
    """State that is integrated along the robot.

    Attributes:
        angles: angles of the tubes against the frame, n×1, rad.
        torques: torques in the tubes, n×1, N m.
        pose: pose of the frame relative to the frame at the tip of the robot.
        energy: energy from the tip on, 1×1, J.
    """

    angles: Matrix
    torques: Matrix
    pose: Pose
    energy: Matrix

    @property
    def stacked(self) -> Matrix:
        """All entries, (2 n + 8)×1."""
        return ca.vertcat(self.angles, self.torques, self.pose.position, self.pose.quaternion, self.energy)

    @classmethod
    def of(cls, stacked: Matrix) -> Self:
        """Make a state from stacked entries."""
        size = (stacked.size1() - 8) // 2
        angles, torques, position, quaternion, energy = ca.vertsplit(
            stacked, [0, size, 2 * size, 2 * size + 3, 2 * size + 7, 2 * size + 8]
        )
        return cls(angles, torques, Pose(position, quaternion), energy)


@dataclass(frozen=True)
class Bending:
    """Stiffnesses and curvatures of the tubes of a piece of a robot.

    Attributes:
        torsion: GJ of every tube, n×1, N m².
        moments: EI κ of the tubes that are curved here, zero for the others, n×1, N m.
        bending: sum of EI of all tubes here, 1×1, N m².
        own: Σ EI κ²/2 of the tubes that are curved here, 1×1, N.
    """

    torsion: Matrix
    moments: Matrix
    bending: Matrix
    own: Matrix

    def resting(self, angles: Matrix) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """EI κ cos α and EI κ sin α of every tube, n×1, and the curvature of least energy, 1×1 each, 1/m."""
        cosines = self.moments * ca.cos(angles)
        sines = self.moments * ca.sin(angles)
        return cosines, sines, ca.sum1(cosines) / self.bending, ca.sum1(sines) / self.bending


@dataclass(frozen=True)
class PieceConstants(Bending):
    """Constants of a piece of a robot without loads."""

    def turned(self, state: FlowState, length: Matrix) -> FlowState:
        """Flow along a length in which the torques rotate the tubes."""
        rates = state.torques / self.torsion
        angles = state.angles + length * rates
        energy = state.energy + length * ca.dot(state.torques, rates) / 2
        return FlowState(angles, state.torques, state.pose, energy)

    def bent(self, state: FlowState, length: Matrix) -> FlowState:
        """Flow along a length in which the angles bend the centre line and change the torques."""
        cosines, sines, x, y = self.resting(state.angles)
        # The energy per length is own − (x² + y²) bending / 2; its derivative with an angle is what the torque gains.
        torques = state.torques + length * (x * sines - y * cosines)
        energy = state.energy + length * (self.own - self.bending * (x**2 + y**2) / 2)
        # To bend towards x is to turn about y, towards y is to turn back about x.
        arc = increment(length * ca.vertcat(-y, x, 0))
        chord = length * arc.tangent[:, 2]
        return FlowState(state.angles, torques, state.pose.then(Pose(chord, arc.quaternion)), energy)

    def stage(self, state: FlowState, before: Matrix, length: Matrix) -> FlowState:
        """Stage of a step along a length, without the last half of the torques' flow, which the next stage includes.

        Args:
            state: state at the start.
            before: length of the stage before.
            length: length of this stage.
        """
        return self.bent(self.turned(state, (before + length) / 2), length)

    def step(self, state: FlowState, length: Matrix) -> FlowState:
        """Take a step of order eight along a length, which is negative towards the base."""
        stages = [share * length for share in SHARES]
        for before, own in itertools.pairwise([ca.DM(0.0), *stages]):
            state = self.stage(state, before, own)
        return self.turned(state, stages[-1] / 2)


@cache
def whole_step(size: int) -> ca.Function:
    """Make (state, length, section) ↦ state: one step of a number of tubes with the frame and the energy.

    The section is a vector of the torsion of every tube, moments of every tube, bending and own energy, (2 n + 2)×1.
    """
    state = ca.SX.sym("state", 2 * size + 8)
    length = ca.SX.sym("length")
    section = ca.SX.sym("section", 2 * size + 2)
    after = _section(section).step(FlowState.of(state), length)
    return ca.Function("whole_step", [state, length, section], [after.stacked])


@cache
def twist_step(size: int) -> ca.Function:
    """Make (angles and torques, length, section) ↦ angles and torques: a step without the frame and the energy."""
    twist = ca.SX.sym("twist", 2 * size)
    length = ca.SX.sym("length")
    section = ca.SX.sym("section", 2 * size + 2)
    state = FlowState.of(ca.vertcat(twist, START))
    after = _section(section).step(state, length)
    return ca.Function("twist_step", [twist, length, section], [ca.vertcat(after.angles, after.torques)])


@cache
def whole_stages(size: int) -> Staged:
    """Make a step of a number of tubes with the frame and the energy, in its stages, as in `whole_step`."""
    state = ca.SX.sym("state", 2 * size + 8)
    before = ca.SX.sym("before")
    length = ca.SX.sym("length")
    stacked = ca.SX.sym("section", 2 * size + 2)
    section = _section(stacked)
    begun = FlowState.of(state)
    return Staged(
        stage=ca.Function("stage", [state, before, length, stacked], [section.stage(begun, before, length).stacked]),
        last=ca.Function("last", [state, length, stacked], [section.turned(begun, length / 2).stacked]),
        energy=2 * size + 7,
        carried=0,
    )


START = ca.DM([0, 0, 0, 1, 0, 0, 0, 0])
"""Position, quaternion and energy at the tip of the robot."""


def _section(stacked: ca.SX) -> PieceConstants:
    size = (stacked.size1() - 2) // 2
    torsion, moments, bending, own = ca.vertsplit(stacked, [0, size, 2 * size, 2 * size + 1, 2 * size + 2])
    return PieceConstants(torsion, moments, bending, own)
