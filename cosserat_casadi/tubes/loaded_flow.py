"""One step along a robot under loads, composed of exact flows.

A load causes a force n and a moment m in a section. With the sum w = Σ EIᵢ κᵢ e(αᵢ) over the tubes and their stiffness
B = Σ EIᵢ the centre line has the curvature c = (q + w)/B, where q = (m_y, −m_x) is the moment in the axes of the frame
that does not turn about it, as the direction of bending (D. C. Rucker, B. A. Jones, R. J. Webster, IEEE Trans. Robot.
26 (2010) 769). These are Hamilton's equations of

    H = Σ τᵢ²/(2 GJᵢ) + |q|²/(2 B) + q·w(α)/B + |w(α)|²/(2 B) + n·t,    with the tangent t.

Each of its parts alone is solved in closed form. The torques rotate the tubes. The moment rotates the frame about its
axis, and back about the tangent. The pre-curvature rotates the frame about a fixed axis, and changes the torques. The
tangent moves the position, and changes the moment by the lever arm of n. Their symmetric product is a symplectic step
of order two that preserves rotations; `tubes.stages` composes a step of order eight from it. See docs/tubes.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Self

import casadi as ca

from cosserat_casadi.maths.magnus import increment
from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import cross, quaternion_conjugate, quaternion_product, rotate
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.tubes.stages import Staged, composed
from cosserat_casadi.tubes.tube_flow import Bending, FlowState

TANGENT = ca.DM([0, 0, 1])
"""Tangent of the centre line, in the axes of the frame, 3×1."""


@dataclass(frozen=True)
class LoadedState(FlowState):
    """State that is integrated along a robot under loads; its pose is in world axes, relative to the tip's position.

    Attributes:
        moment: moment in the section, world axes, 3×1, N m.
        place: distance from the plate along the centre line, 1×1, m.
    """

    moment: Matrix
    place: Matrix

    @property
    def stacked(self) -> Matrix:
        """All entries, (2 n + 12)×1."""
        parts = (self.pose.position, self.pose.quaternion, self.energy, self.moment, self.place)
        return ca.vertcat(self.angles, self.torques, *parts)

    @classmethod
    def of(cls, stacked: Matrix) -> Self:
        """Make a state from stacked entries."""
        size = (stacked.size1() - 12) // 2
        cuts = [0, size, 2 * size]
        for width in (3, 4, 1, 3, 1):
            cuts.append(cuts[-1] + width)
        angles, torques, position, quaternion, energy, moment, place = ca.vertsplit(stacked, cuts)
        return cls(angles, torques, Pose(position, quaternion), energy, moment, place)


@dataclass(frozen=True)
class LoadedSection(Bending):
    """Constants of a piece of a robot under loads.

    Attributes:
        force: force in a section, extrapolated to the plate, world axes, 3×1, N.
        weight: force per length, world axes, 3×1, N/m; None for a robot without weight.
        potential: whether the work of the loads counts in the energy.
    """

    force: Matrix
    weight: Matrix | None
    potential: bool

    def force_at(self, place: Matrix) -> Matrix:
        """Force in the section at a distance from the plate, world axes, 3×1, N."""
        if self.weight is None:
            return self.force
        return self.force - place * self.weight

    def moved(self, state: LoadedState, length: Matrix) -> LoadedState:
        """Flow along a length in which the torques rotate the tubes, and the tangent moves position and lever arm."""
        rates = state.torques / self.torsion
        energy = state.energy + length * ca.dot(state.torques, rates) / 2
        way = length * rotate(state.pose.quaternion, TANGENT)
        force = self.force_at(state.place + length / 2)
        if self.potential:
            energy = energy - ca.dot(force, way)
        return replace(
            state,
            angles=state.angles + length * rates,
            pose=Pose(state.pose.position + way, state.pose.quaternion),
            energy=energy,
            moment=state.moment - cross(way, force),
            place=state.place + length,
        )

    def loaded(self, state: LoadedState, length: Matrix) -> LoadedState:
        """Flow along a length in which the moment rotates the frame."""
        back = quaternion_conjugate(state.pose.quaternion)
        moment = rotate(back, state.moment)
        share = length / self.bending
        about_moment = increment(share * state.moment).quaternion
        # The frame does not turn about the tangent: what the moment turns it there is taken back.
        half = share * moment[2] / 2
        about_tangent = ca.vertcat(ca.cos(half), 0, 0, -ca.sin(half))
        turned = quaternion_product(about_moment, state.pose.quaternion)
        quaternion = quaternion_product(turned, about_tangent)
        energy = state.energy + share * (moment[0] ** 2 + moment[1] ** 2) / 2
        return replace(state, pose=Pose(state.pose.position, quaternion), energy=energy)

    def bent(self, state: LoadedState, length: Matrix) -> LoadedState:
        """Flow along a length in which the pre-curvature rotates the frame, and the torques change."""
        cosines, sines, x, y = self.resting(state.angles)
        # To bend towards x is to turn about y, towards y is to turn back about x.
        arc = increment(length * ca.vertcat(-y, x, 0))
        back = quaternion_conjugate(state.pose.quaternion)
        mean = arc.pulled(rotate(back, state.moment))
        towards_x = x + mean[1] / self.bending
        towards_y = y - mean[0] / self.bending
        torques = state.torques + length * (towards_x * sines - towards_y * cosines)
        energy = state.energy + length * (self.own - self.bending * (x**2 + y**2) / 2)
        quaternion = quaternion_product(state.pose.quaternion, arc.quaternion)
        return replace(state, torques=torques, pose=Pose(state.pose.position, quaternion), energy=energy)

    def stage(self, state: LoadedState, before: Matrix, length: Matrix) -> LoadedState:
        """Stage of a step along a length, without the last half of the moment's flow, which the next stage includes.

        Args:
            state: state at the start.
            before: length of the stage before.
            length: length of this stage.
        """
        state = self.loaded(state, (before + length) / 2)
        state = self.moved(state, length / 2)
        state = self.bent(state, length)
        return self.moved(state, length / 2)


@cache
def loaded_step(size: int, *, spread: bool, potential: bool) -> ca.Function:
    """Make (state, length, section) ↦ state: one step of a number of tubes under loads.

    The section is a vector of the torsion of every tube, moments of every tube, bending, own energy, force and, for
    distributed loads, force per length.

    Args:
        size: number of tubes.
        spread: whether there are forces per length.
        potential: whether the work of the loads counts in the energy.
    """
    staged = loaded_stages(size, spread=spread, potential=potential)
    return composed("loaded_step", staged.stage, staged.last)


@cache
def loaded_stages(size: int, *, spread: bool, potential: bool) -> Staged:
    """Make a step of a number of tubes under loads, in its stages, with the arguments of `loaded_step`."""
    state = ca.SX.sym("state", 2 * size + 12)
    before = ca.SX.sym("before")
    length = ca.SX.sym("length")
    stacked = ca.SX.sym("section", section_width(size, spread=spread))
    section = section_of(stacked, size, spread=spread, potential=potential)
    begun = LoadedState.of(state)
    return Staged(
        stage=ca.Function("stage", [state, before, length, stacked], [section.stage(begun, before, length).stacked]),
        last=ca.Function("last", [state, length, stacked], [section.loaded(begun, length / 2).stacked]),
        energy=2 * size + 7,
        carried=section_width(size, spread=spread) - (2 * size + 2),
    )


def section_width(size: int, *, spread: bool) -> int:
    """Number of entries of a stacked section for a number of tubes."""
    return 2 * size + (8 if spread else 5)


def section_of(stacked: Matrix, size: int, *, spread: bool, potential: bool) -> LoadedSection:
    """Make a section from stacked entries: see `loaded_step`."""
    cuts = [0, size, 2 * size, 2 * size + 1, 2 * size + 2, 2 * size + 5]
    if spread:
        cuts.append(2 * size + 8)
    torsion, moments, bending, own, force, *weight = ca.vertsplit(stacked, cuts)
    return LoadedSection(torsion, moments, bending, own, force, weight[0] if spread else None, potential)
