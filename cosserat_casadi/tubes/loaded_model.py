"""The model of concentric tubes that bear loads: named CasADi functions of their tips and of the inputs.

The frame at the tip of the robot is unknown beside the angles there: loads keep their direction in the world, and the
frame at the base plate must be that of the world. See docs/tubes.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product, rotate
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.tubes.functions import March, TubeFunctions
from cosserat_casadi.tubes.loaded_flow import LoadedState, loaded_step
from cosserat_casadi.tubes.loads import COMPONENTS, TubeLoad
from cosserat_casadi.tubes.model import TubeModel
from cosserat_casadi.tubes.variations import Variations, of_loaded

FRAME = 4
"""Unknowns of the frame at the tip, a quaternion, and its equations."""


@dataclass(frozen=True)
class _Forces:
    """What the loads that act farther out add up to, in world axes.

    Attributes:
        force: the force in a section, as it would be at the plate, 3×1, N.
        weight: force per length, 3×1, N/m.
    """

    force: Matrix
    weight: Matrix


class LoadedTubeModel(TubeFunctions):
    """A robot of concentric tubes that bear loads.

    Unknown are the angles at the tips of the tubes (n), and the quaternion of the frame at the tip of the robot in
    world axes (4). The residual holds the angles at the drives less the rotations of the inputs (n), by how much the
    square of the quaternion's norm is off, halved (1), and the vector of the quaternion of the frame at the plate (3).
    """

    @property
    def unknowns(self) -> int:
        """Number of unknowns: one a tube, and four of the frame at the tip."""
        return self.size + FRAME

    @cached_property
    def unloaded(self) -> TubeModel:
        """The same tubes with as many steps, without loads; of the inputs those of the loads have no effect."""
        return TubeModel(self.robot, self.steps)

    def begin(self, angles: FloatArray, inputs: FloatArray) -> FloatArray:
        """The unknowns of a robot without loads, shape (n + 4,).

        Args:
            angles: at the tips, shape (n,), rad.
            inputs: of the robot.
        """
        _, _, quaternion, _, _ = self.unloaded.stations(angles, inputs, 1.0)
        return np.concatenate([angles, quaternion.full()[:, -1]])

    def varied(self, x: FloatArray, inputs: FloatArray) -> Variations:
        """How the tubes and the tangent turn along the robot; all loads have an energy."""
        stations, along, of_steps = self.variations(x, inputs, 1.0)
        return of_loaded(self.size, x, stations.full(), along.full(), of_steps.full())

    @cached_property
    def variations(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ stations and how they change, of loads that have an energy.

        Stacked states at the ends of all steps from the tip to the plate, (2 n + 12)×k; their derivatives with x,
        ((2 n + 12) k)×(n + 4); and, for each step, those of the state at its end with the torques and the moment at its
        start, (2 n + 12)×((n + 3) (k − 1)).
        """
        size = self.size
        x, _, _ = self._arguments
        stations = self._whole.stations
        # Angles, torques, pose and energy, moment, place.
        parts = [ca.MX.sym(f"part{i}", width) for i, width in enumerate((size, size, 8, COMPONENTS, 1))]
        length = ca.MX.sym("length")
        section = ca.MX.sym("section", self._stacked_sections.size1())
        after = self._step(ca.vertcat(*parts), length, section)
        from_momenta = [ca.jacobian(after, parts[1]), ca.jacobian(after, parts[3])]
        one_step = ca.Function("one_step", [*parts, length, section], [ca.horzcat(*from_momenta)])
        every_step = one_step.map(self._lengths.size2())
        cuts = [0, size, 2 * size, 2 * size + 8, 2 * size + 11, 2 * size + 12]
        starts = ca.vertsplit(stations[:, :-1], cuts)
        outputs = {
            "stations": stations,
            "along": ca.jacobian(ca.vec(stations), x),
            "of_steps": every_step(*starts, self._lengths, self._stacked_sections),
        }
        return self._function("variations", outputs)

    # How it is integrated

    @cached_property
    def _step(self) -> ca.Function:
        return loaded_step(self.size, spread=self._spread, potential=self.robot.has_energy)

    @property
    def _spread(self) -> bool:
        """Whether there are forces per length."""
        return any(load.spread for load in self.robot.loads)

    @property
    def _whole(self) -> March:
        return self._marched[0]

    @property
    def _stacked_sections(self) -> Matrix:
        """Stacked section of every step, with the loads."""
        return self._marched[1]

    @cached_property
    def _marched(self) -> tuple[March, Matrix]:
        """Take the steps of all pieces from the tip on, and pick up the loads on the way."""
        steps = self._step.mapaccum("steps", self.steps)
        lengths = ca.horzsplit(self._lengths, self.steps)
        sections = ca.horzsplit(self._sections, self.steps)
        forces = _Forces(ca.MX.zeros(3), ca.MX.zeros(3))
        ends = [self._tip.stacked]
        stations = [self._tip.stacked]
        loaded_sections = []
        for piece, (length, section) in enumerate(zip(lengths, sections, strict=True)):
            start, forces = self._picked_up(piece, LoadedState.of(ends[-1]), forces)
            parts = [forces.force]
            if self._spread:
                parts.append(forces.weight)
            loaded_section = ca.vertcat(section, ca.repmat(ca.vertcat(*parts), 1, self.steps))
            passed = steps(start.stacked, length, loaded_section)
            ends.append(passed[:, -1])
            stations.append(passed)
            loaded_sections.append(loaded_section)
        return March(ends, ca.horzcat(*stations)), ca.horzcat(*loaded_sections)

    @property
    def _tip(self) -> LoadedState:
        """The state at the tip, which bears nothing yet."""
        x, _, _ = self._arguments
        angles, quaternion = ca.vertsplit(x, [0, self.size, self.unknowns])
        zeros = ca.DM.zeros(3)
        unit = quaternion / ca.norm_2(quaternion)
        return LoadedState(
            angles=angles,
            torques=ca.DM.zeros(self.size),
            pose=Pose(zeros, unit),
            energy=ca.DM(0.0),
            moment=zeros,
            place=self._places[0],
        )

    def _picked_up(self, piece: int, state: LoadedState, forces: _Forces) -> tuple[LoadedState, _Forces]:
        """What is borne beyond the start of a piece, where tubes may end."""
        _, inputs, _ = self._arguments
        for index, (tip, _) in enumerate(self._ends):
            ends_here = self._places[piece] == tip
            if piece > 0:
                # Of places that coincide the first counts.
                ends_here = ca.logic_and(ends_here, self._places[piece - 1] > tip)
            for number, load in enumerate(self.robot.loads):
                share = float(load.shares[index])
                if share == 0.0:
                    continue
                start = self.robot.load_start(number)
                value = share * inputs[start : start + COMPONENTS]
                borne = ca.if_else(ends_here, value, 0.0)
                state, forces = _with_load(load, borne, index, tip, state, forces)
        return state, forces

    @cached_property
    def _residual(self) -> Matrix:
        """Angles missed at the drives, the norm of the quaternion, and the frame at the plate, (n + 4)×1."""
        x, inputs, _ = self._arguments
        plate = LoadedState.of(self._whole.ends[-1])
        missed = plate.angles - self._compliance * plate.torques - self.robot.rotations(inputs)
        norm = (ca.sumsqr(x[self.size :]) - 1) / 2
        return ca.vertcat(missed, norm, plate.pose.quaternion[1:])

    def _state(self, stacked: Matrix) -> LoadedState:
        return LoadedState.of(stacked)


def _with_load(
    load: TubeLoad, value: ca.MX, tube: int, tip: ca.MX, state: LoadedState, forces: _Forces
) -> tuple[LoadedState, _Forces]:
    """The state at a tube's tip, and the forces, with those of one load.

    Args:
        load: the load.
        value: its force or moment at the tip, or per length, in its own axes, 3×1; zero where the tube does not end.
        tube: index of the tube.
        tip: how far the tip stands out of the plate, 1×1, m.
        state: there.
        forces: of what acts farther out.
    """
    if load.spread:
        return state, _Forces(forces.force + tip * value, forces.weight + value)
    frame = state.pose.quaternion
    if load.follower:
        half = state.angles[tube] / 2
        frame = quaternion_product(frame, ca.vertcat(ca.cos(half), 0, 0, ca.sin(half)))
        value = rotate(frame, value)
    if not load.is_moment:
        return state, replace(forces, force=forces.force + value)
    # About the tangent it twists the tube alone.
    twist = rotate(quaternion_conjugate(frame), value)[2]
    torques: Matrix = state.torques + twist * ca.DM(np.eye(len(load.shares))[:, tube])
    return replace(state, moment=state.moment + value, torques=torques), forces
