"""Derivatives of a step along a loaded robot by its initial state, written by hand for `loaded_flow`.

A change of the frame is a small rotation θ in world axes, δR = θ^ R; all other changes are ordinary. Each flow then
consists of a few products of matrices, with less than half the operations of automatic differentiation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import casadi as ca

from cosserat_casadi.maths.magnus import increment
from cosserat_casadi.maths.rotation import cross, hat, quaternion_conjugate, quaternion_to_matrix, rotate
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.tubes.loaded_flow import TANGENT, LoadedSection, LoadedState, section_of, section_width
from cosserat_casadi.tubes.stages import composed
from cosserat_casadi.tubes.tube_loads import TubeLoad

VECTOR = 3


@dataclass(frozen=True)
class LoadedTangent:
    """Changes of a state in m directions.

    Attributes:
        angles: changes of the angles of the tubes against the frame, n×m, rad.
        torques: changes of the torques in the tubes, n×m, N m.
        turn: rotations of the frame, world axes, 3×m, rad.
        moment: changes of the moment in the section, world axes, 3×m, N m.
        force: changes of the force in the section, world axes, 3×m, N; zero without follower forces.
    """

    angles: Matrix
    torques: Matrix
    turn: Matrix
    moment: Matrix
    force: Matrix

    @property
    def stacked(self) -> Matrix:
        """All entries, (2 n + 9)×m."""
        return ca.vertcat(self.angles, self.torques, self.turn, self.moment, self.force)

    @classmethod
    def of(cls, stacked: Matrix) -> LoadedTangent:
        """Make changes from stacked entries."""
        size = (stacked.size1() - 3 * VECTOR) // 2
        cuts = [0, size, 2 * size]
        for _ in range(3):
            cuts.append(cuts[-1] + VECTOR)
        return cls(*ca.vertsplit(stacked, cuts))

    def moved(self, section: LoadedSection, state: LoadedState, length: Matrix) -> LoadedTangent:
        """Changes after a length in which the torques rotate the tubes and the tangent moves the lever arm."""
        tangent = rotate(state.pose.quaternion, TANGENT)
        way = -length * hat(tangent) @ self.turn
        by_force = length * hat(tangent) @ self.force
        force = section.force_at(state.place + length / 2)
        return replace(
            self,
            angles=self.angles + _rows_times(length / section.torsion, self.torques),
            moment=self.moment + hat(force) @ way - by_force,
        )

    def loaded(self, section: LoadedSection, state: LoadedState, length: Matrix) -> LoadedTangent:
        """Changes after a length in which the moment rotates the frame."""
        share = length / section.bending
        arc = increment(share * state.moment)
        turned = quaternion_to_matrix(arc.quaternion)
        tangent = rotate(state.pose.quaternion, TANGENT)
        # What the moment turns about the tangent is taken back.
        about_tangent = tangent.T @ self.moment + cross(tangent, state.moment).T @ self.turn
        by_moment = share * (arc.tangent @ self.moment - turned @ tangent @ about_tangent)
        return replace(self, turn=turned @ self.turn + by_moment)

    def bent(self, section: LoadedSection, state: LoadedState, length: Matrix) -> LoadedTangent:
        """Changes after a length in which the pre-curvature rotates the frame and changes the torques."""
        bending = section.bending
        cosines, sines, x, y = section.resting(state.angles)
        change_x = -sines.T @ self.angles / bending
        change_y = cosines.T @ self.angles / bending
        arc = increment(length * ca.vertcat(-y, x, 0))
        change_of_arc = arc.tangent[:, :2] @ (length * ca.vertcat(-change_y, change_x))
        frame = quaternion_to_matrix(state.pose.quaternion)
        moment = rotate(quaternion_conjugate(state.pose.quaternion), state.moment)
        change_of_moment = frame.T @ (self.moment + hat(state.moment) @ self.turn)
        mean = arc.pulled(moment)
        change_of_mean = arc.tangent.T[:2, :] @ (change_of_moment + arc.stiffness(moment) @ change_of_arc)
        towards_x = x + mean[1] / bending
        towards_y = y - mean[0] / bending
        change_towards_x = change_x + change_of_mean[1, :] / bending
        change_towards_y = change_y - change_of_mean[0, :] / bending
        by_angles = _rows_times(towards_x * cosines + towards_y * sines, self.angles)
        gained = sines @ change_towards_x - cosines @ change_towards_y + by_angles
        return replace(self, torques=self.torques + length * gained, turn=self.turn + frame @ change_of_arc)

    def picked_up(self, load: TubeLoad, value: Matrix, tube: int, state: LoadedState) -> LoadedTangent:
        """Changes beyond a tube's tip, at which a load acts.

        Args:
            load: the load.
            value: its force or moment, world axes, 3×1; zero if the tube does not end there.
            tube: index of the tube.
            state: the state at the tip.
        """
        tangent = rotate(state.pose.quaternion, TANGENT)
        change = ca.MX.zeros(VECTOR, self.turn.size2())
        if load.follower:
            change = -hat(value) @ (self.turn + tangent @ self.angles[tube, :])
        if not load.is_moment:
            return replace(self, force=self.force + change)
        torques = ca.vertsplit(self.torques)
        # A moment that follows its tube has the same part about the tangent always.
        if not load.follower:
            torques[tube] = torques[tube] + cross(tangent, value).T @ self.turn
        return replace(self, torques=ca.vertcat(*torques), moment=self.moment + change)


def _rows_times(factors: Matrix, rows: Matrix) -> Matrix:
    """Multiply each row by a factor."""
    return ca.repmat(factors, 1, rows.size2()) * rows


@cache
def tangent_step(size: int, directions: int, *, spread: bool, follower: bool) -> ca.Function:
    """Make (state and changes, length, section) ↦ state and changes: a step of a number of tubes under loads.

    The stacked vector consists of the state, (2 n + 12)×1, with an energy without loads, and the changes by columns.

    Args:
        size: number of tubes.
        directions: number m of changes.
        spread: whether there are forces per length.
        follower: whether there are follower forces.
    """
    width = 2 * size + 12
    height = 2 * size + 3 * VECTOR
    before = ca.SX.sym("before")
    length = ca.SX.sym("length")
    stacked_section = ca.SX.sym("section", section_width(size, spread=spread))
    section = section_of(stacked_section, size, spread=spread, potential=False)
    stacked = ca.SX.sym("stacked", width + height * directions)
    state = LoadedState.of(stacked[:width])
    tangent = LoadedTangent.of(ca.reshape(stacked[width:], height, directions))
    if not follower:
        tangent = replace(tangent, force=ca.SX(VECTOR, directions))

    def both(state: LoadedState, tangent: LoadedTangent) -> Matrix:
        return ca.cse(ca.vertcat(state.stacked, ca.vec(ca.densify(tangent.stacked))))

    ended = section.loaded(state, length / 2)
    last = both(ended, tangent.loaded(section, state, length / 2))
    tangent = tangent.loaded(section, state, (before + length) / 2)
    state = section.loaded(state, (before + length) / 2)
    tangent = tangent.moved(section, state, length / 2)
    state = section.moved(state, length / 2)
    tangent = tangent.bent(section, state, length)
    state = section.bent(state, length)
    tangent = tangent.moved(section, state, length / 2)
    state = section.moved(state, length / 2)
    return composed(
        "tangent_step",
        ca.Function("stage", [stacked, before, length, stacked_section], [both(state, tangent)]),
        ca.Function("last", [stacked, length, stacked_section], [last]),
    )
