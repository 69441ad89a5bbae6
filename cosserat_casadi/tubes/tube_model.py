"""The model of concentric tubes without loads: named CasADi functions of the angles at their tips and of the inputs.

Every tube's tip bears no torque. So the angles there, the unknowns x, determine the whole robot: it is integrated from
the tips to the base plate, and through the housing to the drives, where the angles must be the rotations of the inputs.
That is one small equation a tube. See docs/tubes.md.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.tubes.stages import March, Staged
from cosserat_casadi.tubes.tube_flow import START, FlowState, twist_step, whole_stages, whole_step
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.variations import TipVariations


class TubeModel(TubeFunctions):
    """A robot of concentric tubes without loads; the unknowns x are the angles at the tips of the tubes (n)."""

    @property
    def size(self) -> int:
        """Number of unknowns: one for each tube."""
        return self.tube_count

    def varied(self, x: FloatArray, inputs: FloatArray) -> TipVariations:
        """Variations of the angles and torques along the robot."""
        along, of_steps = (part.full() for part in self.variations(x, inputs))
        size = self.tube_count
        # Of each station the changes of angles, then those of torques.
        changes = along.reshape(-1, 2 * size, size)
        return TipVariations(
            configuration=changes[:, :size],
            at_plate=changes[-1, size:],
            of_steps=of_steps.reshape(size, -1, size).transpose(1, 0, 2),
        )

    @cached_property
    def variations(self) -> ca.Function:
        """(x, inputs) ↦ changes of the angles and torques at all ends of steps.

        The results are changes by the angles at the tips, (2 n k)×n, by columns of the stations from the tip to the
        plate; and, for each step, changes of the angles at its end by the torques at its start, n×(n (k − 1)).
        """
        size = self.tube_count
        x, _, _ = self._arguments
        stations = self._twist.stations
        angles = ca.MX.sym("angles", size)
        torques = ca.MX.sym("torques", size)
        length = ca.MX.sym("length")
        section = ca.MX.sym("section", 2 * size + 2)
        after = twist_step(size)(ca.vertcat(angles, torques), length, section)
        from_torques = ca.jacobian(after[:size], torques)
        one_step = ca.Function("one_step", [angles, torques, length, section], [from_torques])
        every_step = one_step.map(self._lengths.size2())
        outputs = {
            "along": ca.jacobian(ca.vec(stations), x),
            "of_steps": every_step(stations[:size, :-1], stations[size:, :-1], self._lengths, self._sections),
        }
        return self._function("variations", outputs)

    # How it is integrated

    @cached_property
    def _twist(self) -> March:
        """Angles and torques alone, which decide on equilibrium and stability."""
        x, _, _ = self._arguments
        return self._taken(twist_step(self.tube_count), ca.vertcat(x, ca.DM.zeros(self.tube_count)))

    @cached_property
    def _whole(self) -> March:
        """Angles, torques, the frame of the centre line and the energy, from the tip on."""
        return self._taken(self._step, self._begun)

    def _taken(self, step: ca.Function, begun: Matrix) -> March:
        """Take steps from a state at the tip on; no load changes the state between them."""
        return self._marched(step, begun, self._sections, lambda _, state, sections: (state, sections))

    @cached_property
    def _residual(self) -> Matrix:
        """Angles at the drives less the rotations of the inputs, n×1, rad."""
        return self._missed(self._twist.ends[-1])

    def _missed(self, plate: Matrix) -> Matrix:
        _, inputs, _ = self._arguments
        angles, torques, _ = ca.vertsplit(plate, [0, self.tube_count, 2 * self.tube_count, plate.size1()])
        return angles - self._compliance * torques - self.robot.rotations(inputs)

    def _state(self, stacked: Matrix) -> FlowState:
        return FlowState.of(stacked)

    @property
    def _step(self) -> ca.Function:
        return whole_step(self.tube_count)

    @property
    def _staged(self) -> Staged:
        return whole_stages(self.tube_count)

    @property
    def _begun(self) -> Matrix:
        x, _, _ = self._arguments
        return ca.vertcat(x, ca.DM.zeros(self.tube_count), START)

    def _passing(self, piece: int, stacked: Matrix) -> Matrix:
        return stacked
