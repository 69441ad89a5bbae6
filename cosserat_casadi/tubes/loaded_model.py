"""The model of concentric tubes under loads: named CasADi functions of the unknowns at their tips and of the inputs.

The frame at the tip of the robot is unknown in addition to the angles there: loads keep their direction in the world,
and the frame at the base plate must coincide with that of the world. See docs/tubes.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.pose import Pose
from cosserat_casadi.maths.rotation import hat, quaternion_conjugate, quaternion_product, rotate
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.tubes.loaded_flow import LoadedState, loaded_stages, loaded_step
from cosserat_casadi.tubes.loaded_tangent import VECTOR, LoadedTangent, tangent_step
from cosserat_casadi.tubes.stages import March, Staged
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_loads import COMPONENTS, TubeLoad
from cosserat_casadi.tubes.tube_model import TubeModel
from cosserat_casadi.tubes.variations import TipVariations, of_loaded

FRAME = 4
"""Number of unknowns of the frame at the tip, a quaternion, and of its equations."""


@dataclass(frozen=True)
class _Forces:
    """Sums of the loads that act farther out, in world axes.

    Attributes:
        force: the force in a section, extrapolated to the plate, 3×1, N.
        weight: force per length, 3×1, N/m.
    """

    force: Matrix
    weight: Matrix


class LoadedTubeModel(TubeFunctions):
    """A robot of concentric tubes under loads.

    The unknowns are the angles at the tips of the tubes (n), and the quaternion of the frame at the tip of the robot in
    world axes (4). The residual consists of the angles at the drives less the rotations of the inputs (n), half of the
    squared norm of the quaternion less one (1), and the vector part of the quaternion of the frame at the plate (3).
    """

    @property
    def size(self) -> int:
        """Number of unknowns: one for each tube, and four for the frame at the tip."""
        return self.tube_count + FRAME

    @cached_property
    def without_loads(self) -> TubeModel:
        """Make the model of these tubes without loads, with equal steps; inputs of the loads have no effect."""
        return TubeModel(self.robot, self.steps)

    def begin(self, angles: FloatArray, inputs: FloatArray) -> FloatArray:
        """Make the unknowns of a robot without loads, shape (n + 4,).

        Args:
            angles: angles at the tips, shape (n,), rad.
            inputs: inputs of the robot.
        """
        _, _, quaternion, _, _ = self.without_loads.stations(angles, inputs)
        return np.concatenate([angles, quaternion.full()[:, -1]])

    def varied(self, x: FloatArray, inputs: FloatArray) -> TipVariations:
        """Variations of the tubes and the tangent along the robot, for loads that have an energy."""
        stations, along, of_steps = self.variations(x, inputs)
        return of_loaded(self.tube_count, stations.full(), along.full(), of_steps.full())

    @cached_property
    def variations(self) -> ca.Function:
        """(x, inputs) ↦ stations and their changes, for loads that have an energy.

        The results are stacked states at the ends of all steps from the tip to the plate, (2 n + 12)×k; their changes,
        stacked as in `LoadedTangent`, by the angles at the tips and a rotation of the frame, (2 n + 9)×((n + 3) k);
        and, for each step, changes at its end by torques and moment at its start, (2 n + 9)×((n + 3) (k − 1)).
        """
        stations = self._varied.stations
        width = self._width
        momenta = np.zeros((2 * self.tube_count + 3 * VECTOR, self.tube_count + VECTOR))
        momenta[self.tube_count : 2 * self.tube_count, : self.tube_count] = np.eye(self.tube_count)
        momenta[2 * self.tube_count + VECTOR : 2 * self.tube_count + 2 * VECTOR, self.tube_count :] = np.eye(VECTOR)
        count = self._lengths.size2()
        starts = ca.vertcat(stations[:width, :-1], ca.repmat(ca.vec(ca.DM(momenta)), 1, count))
        ends = self._tangent_step.map(count)(starts, self._lengths, self._whole.sections)
        height = 2 * self.tube_count + 3 * VECTOR
        outputs = {
            "stations": stations[:width, :],
            "along": ca.reshape(stations[width:, :], height, -1),
            "of_steps": ca.reshape(ends[width:, :], height, -1),
        }
        return self._function("variations", outputs)

    # How it is integrated

    @cached_property
    def _step(self) -> ca.Function:
        return loaded_step(self.tube_count, spread=self._spread, potential=self.robot.has_energy)

    @property
    def _spread(self) -> bool:
        """Whether there are forces per length."""
        return any(load.spread for load in self.robot.loads)

    @cached_property
    def _whole(self) -> March:
        """Take the steps of all pieces from the tip on, adding the loads on the way."""
        forces = _Forces(ca.MX.zeros(3), ca.MX.zeros(3))

        def entered(piece: int, end: Matrix, sections: Matrix) -> tuple[Matrix, Matrix]:
            nonlocal forces
            start, forces = self._picked_up(piece, LoadedState.of(end), forces)
            carried = [forces.force, forces.weight] if self._spread else [forces.force]
            return start.stacked, ca.vertcat(sections, ca.repmat(ca.vertcat(*carried), 1, self.steps))

        return self._marched(self._step, self._tip.stacked, self._sections, entered)

    @property
    def _tip(self) -> LoadedState:
        """The state at the tip, without loads."""
        x, _, _ = self._arguments
        angles, quaternion = ca.vertsplit(x, [0, self.tube_count, self.size])
        zeros = ca.DM.zeros(3)
        unit = quaternion / ca.norm_2(quaternion)
        return LoadedState(
            angles=angles,
            torques=ca.DM.zeros(self.tube_count),
            pose=Pose(zeros, unit),
            energy=ca.DM(0.0),
            moment=zeros,
            place=self._places[0],
        )

    def _borne(self, piece: int) -> Iterator[tuple[TubeLoad, ca.MX, int]]:
        """Loads that act at the start of a piece, in their axes, and the tube that bears them.

        A load that acts elsewhere is zero; the evaluation of the function decides which tubes end there.
        """
        _, inputs, _ = self._arguments
        for index, rank in enumerate(self._ranks):
            for number, load in enumerate(self.robot.numbers.loads):
                if index not in load.bearers:
                    continue
                start = self.robot.load_start(number)
                value = load.shares[index] * inputs[start : start + COMPONENTS]
                at = self._point_ranks.get(number, rank)
                yield load, ca.if_else(at == ca.MX(piece), value, 0.0), index

    @property
    def _loaded_places(self) -> list[ca.MX]:
        """Where forces act beside the tips, as far as they do so outside: the housing bears those in it."""
        places = []
        for load in self._point_loads.values():
            tip, _ = self._ends[load.bearers[0]]
            places.append(ca.fmax(tip - load.from_tip, 0.0))
        return places

    @property
    def _point_loads(self) -> dict[int, TubeLoad]:
        """Loads that act beside the tips, by their number."""
        return {number: load for number, load in enumerate(self.robot.numbers.loads) if load.is_beside_tip}

    @cached_property
    def _point_ranks(self) -> dict[int, ca.MX]:
        """Index among the sorted places of each load that acts beside a tip, by the load's index."""
        first = 2 * self.tube_count
        return {number: self._rank(first + index) for index, number in enumerate(self._point_loads)}

    def _picked_up(self, piece: int, state: LoadedState, forces: _Forces) -> tuple[LoadedState, _Forces]:
        """State and forces after the start of a piece, where tubes may end and their loads are added."""
        for load, borne, index in self._borne(piece):
            tip, _ = self._ends[index]
            state, forces = _with_load(load, borne, index, tip, state, forces)
        return state, forces

    # How it changes with the unknowns

    @property
    def _width(self) -> int:
        """Number of entries of a stacked state."""
        return 2 * self.tube_count + 12

    @property
    def _tangent_step(self) -> ca.Function:
        """Step of the state and its changes by the angles at the tips and a rotation of the frame there."""
        follower = any(load.follower and not load.is_moment for load in self.robot.loads)
        return tangent_step(self.tube_count, self.tube_count + VECTOR, spread=self._spread, follower=follower)

    @cached_property
    def _varied(self) -> March:
        """States without the energy of loads, each followed by its changes, by columns."""
        height = 2 * self.tube_count + 3 * VECTOR
        at_tip = np.zeros((height, self.tube_count + VECTOR))
        at_tip[: self.tube_count, : self.tube_count] = np.eye(self.tube_count)
        at_tip[2 * self.tube_count : 2 * self.tube_count + VECTOR, self.tube_count :] = np.eye(VECTOR)
        begun = ca.vertcat(self._tip.stacked, ca.vec(ca.DM(at_tip)))

        def entered(piece: int, end: Matrix, sections: Matrix) -> tuple[Matrix, Matrix]:
            state = LoadedState.of(end[: self._width])
            tangent = LoadedTangent.of(ca.reshape(end[self._width :], height, -1))
            forces = _Forces(ca.MX.zeros(3), ca.MX.zeros(3))
            for load, borne, index in self._borne(piece):
                if load.spread:
                    continue
                tangent = tangent.picked_up(load, _in_world(load, borne, index, state), index, state)
                tip, _ = self._ends[index]
                state, forces = _with_load(load, borne, index, tip, state, forces)
            return ca.vertcat(state.stacked, ca.vec(tangent.stacked)), sections

        return self._marched(self._tangent_step, begun, self._whole.sections, entered)

    @cached_property
    def _jacobian(self) -> Matrix:
        """Derivative of the residual by x, from the changes at the plate, (n + 4)×(n + 4)."""
        x, _, _ = self._arguments
        end = self._varied.ends[-1]
        quaternion = LoadedState.of(end[: self._width]).pose.quaternion
        plate = LoadedTangent.of(ca.reshape(end[self._width :], 2 * self.tube_count + 3 * VECTOR, -1))
        missed = plate.angles - ca.repmat(self._compliance, 1, self.tube_count + VECTOR) * plate.torques
        # δQ = ½ (0, θ) ⊗ Q.
        turned = (quaternion[0] * plate.turn - hat(quaternion[1:]) @ plate.turn) / 2
        # The turn at the tip with the quaternion there, which need not have the norm one: θ = 2 δq ⊗ q̄ / |q|².
        tip = x[self.tube_count :]
        turns = 2 / ca.sumsqr(tip) * ca.horzcat(-tip[1:], tip[0] * ca.DM.eye(VECTOR) + hat(tip[1:]))
        rows = ca.vertcat(missed, turned)
        by_x = ca.horzcat(rows[:, : self.tube_count], rows[:, self.tube_count :] @ turns)
        norm = ca.horzcat(ca.DM.zeros(1, self.tube_count), tip.T)
        return ca.vertcat(by_x[: self.tube_count, :], norm, by_x[self.tube_count :, :])

    @cached_property
    def _residual(self) -> Matrix:
        """Angles missed at the drives, the norm of the quaternion, and the frame at the plate, (n + 4)×1."""
        return self._missed(self._whole.ends[-1])

    def _missed(self, plate: Matrix) -> Matrix:
        x, inputs, _ = self._arguments
        state = LoadedState.of(plate)
        missed = state.angles - self._compliance * state.torques - self.robot.rotations(inputs)
        norm = (ca.sumsqr(x[self.tube_count :]) - 1) / 2
        return ca.vertcat(missed, norm, state.pose.quaternion[1:])

    @property
    def _staged(self) -> Staged:
        return loaded_stages(self.tube_count, spread=self._spread, potential=False)

    @property
    def _begun(self) -> Matrix:
        return ca.vertcat(self._tip.stacked, ca.DM.zeros(self._staged.carried))

    def _passing(self, piece: int, stacked: Matrix) -> Matrix:
        state, force, weight = ca.vertsplit(
            ca.vertcat(stacked, ca.DM.zeros(2 * VECTOR - self._staged.carried)),
            [0, self._width, self._width + VECTOR, self._width + 2 * VECTOR],
        )
        passed, forces = self._picked_up(piece, LoadedState.of(state), _Forces(force, weight))
        return ca.vertcat(passed.stacked, forces.force, forces.weight)[: stacked.size1()]

    def _state(self, stacked: Matrix) -> LoadedState:
        return LoadedState.of(stacked)


def _with_load(
    load: TubeLoad, value: ca.MX, tube: int, tip: ca.MX, state: LoadedState, forces: _Forces
) -> tuple[LoadedState, _Forces]:
    """Add one load to the state at a tube's tip and to the forces.

    Args:
        load: the load.
        value: its force or moment at the tip, or per length, in its axes, 3×1; zero if the tube does not end there.
        tube: index of the tube.
        tip: distance of the tip from the plate, 1×1, m.
        state: state there.
        forces: forces of loads farther out.
    """
    if load.spread:
        return state, _Forces(forces.force + tip * value, forces.weight + value)
    in_world = _in_world(load, value, tube, state)
    if not load.is_moment:
        return state, replace(forces, force=forces.force + in_world)
    # About the tangent it twists the tube alone.
    twist = rotate(quaternion_conjugate(state.pose.quaternion), in_world)[2]
    torques: Matrix = state.torques + twist * ca.DM(np.eye(len(load.shares))[:, tube])
    return replace(state, moment=state.moment + in_world, torques=torques), forces


def _in_world(load: TubeLoad, value: ca.MX, tube: int, state: LoadedState) -> Matrix:
    """Force or moment at a tube's tip in world axes, 3×1; a follower load is rotated from the tube's axes."""
    if not load.follower:
        return value
    half = state.angles[tube] / 2
    frame = quaternion_product(state.pose.quaternion, ca.vertcat(ca.cos(half), 0, 0, ca.sin(half)))
    return rotate(frame, value)
