"""The equations of concentric tubes as functions for C.

Unknown is the twist y: by how much the tip of each tube is turned against its drive, and under loads by how much the
quaternion of the frame at the tip of the robot differs from one. All zero are straight tubes, and a turn of all drives
together changes no twist. On the way from straight tubes, t from 0 to 1, the tubes are bent first, and loaded then.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.codegen.kernels import dense
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_solve import model_of

RESOLVED = 64.0
"""Residual that half of the steps may leave, over the tolerance, where all of them are called enough.

Steps are of order eight: those of half the length leave 1/256 of it, and the tips follow by up to a few times that."""


@dataclass(frozen=True)
class TubeKernels:
    """The functions in C of a robot.

    Attributes:
        model: the robot, with an even number of steps.
        name: what their names begin with.
    """

    model: TubeFunctions
    name: str

    def all(self) -> list[ca.Function]:
        """Residual, Jacobian, rate, what half of the steps give, poses and sensitivity, with dense results."""
        y, inputs, t = self._arguments
        change = ca.MX.sym("inputs_rate", inputs.size1())
        t_rate = ca.MX.sym("t_rate")
        step = ca.MX.sym("step", self.model.size)
        at = self._given(t)
        residual = self.model.path_residual(*at)
        jacobian = self.model.path_jacobian(*at)
        rate = ca.jtimes(residual, ca.vertcat(inputs, t), ca.vertcat(change, t_rate))
        solution = {"y": y, "inputs": inputs}
        state = {**solution, "t": t}
        return [
            self._function("residual", state, [residual]),
            self._function("jacobian", state, [jacobian]),
            self._function("rate", {**state, "inputs_rate": change, "t_rate": t_rate}, [rate]),
            self._function("halved_residual", solution, [self._halved.residual(self._x, inputs)]),
            self._function("halved_change", {"y": y, "step": step, "inputs": inputs}, [self._halved_change(step)]),
            self._function("poses", solution, [ca.vertcat(*self.model.tips(self._x, inputs))]),
            self._function("sensitivity", solution, self._sensitivity()),
        ]

    @cached_property
    def _arguments(self) -> tuple[ca.MX, ca.MX, ca.MX]:
        """Twist, inputs, and place t on the way from straight tubes."""
        return ca.MX.sym("y", self.model.size), ca.MX.sym("inputs", self.model.robot.inputs.size), ca.MX.sym("t")

    def _given(self, t: ca.MX) -> tuple[Matrix, Matrix, Matrix]:
        """Unknowns, inputs and load factor of the model at a place on the way."""
        _, inputs, _ = self._arguments
        robot = self.model.robot
        x = self._x
        if not robot.loads:
            return x, inputs, t
        of_loads = ca.fmax(2 * t - 1, 0)
        drives, loads = inputs[: 2 * robot.size], inputs[2 * robot.size :]
        return x, ca.vertcat(drives, of_loads * loads), ca.fmin(2 * t, 1)

    @property
    def _x(self) -> Matrix:
        """Unknowns of the model."""
        y, inputs, _ = self._arguments
        robot = self.model.robot
        frame = ca.DM([1, 0, 0, 0])[: self.model.size - robot.size]
        return y + ca.vertcat(robot.rotations(inputs), frame)

    @cached_property
    def _halved(self) -> TubeFunctions:
        """The robot with half of the steps."""
        return model_of(self.model.robot, self.model.steps // 2)

    def _halved_change(self, step: ca.MX) -> Matrix:
        """Distance of the tips with half of the steps, a step of the unknowns away, as :func:`tip_error` has it.

        The largest of all tubes: distances over the length that stands out, and angles.
        """
        _, inputs, _ = self._arguments
        positions, quaternions = self.model.tips(self._x, inputs)
        other_positions, other_quaternions = self._halved.tips(self._x + step, inputs)
        length = ca.mmax(self.model.robot.translations(inputs))
        changes = []
        for index in range(self.model.tube_count):
            difference = quaternion_product(quaternion_conjugate(quaternions[:, index]), other_quaternions[:, index])
            angle = 2 * ca.atan2(ca.norm_2(difference[1:]), ca.fabs(difference[0]))
            distance = ca.norm_2(other_positions[:, index] - positions[:, index])
            changes += [distance / length, angle]
        largest: Matrix = ca.mmax(ca.vertcat(*changes))
        return largest

    def _sensitivity(self) -> list[Matrix]:
        """Derivatives of the residual with y and with the inputs, and of the poses, 7 n rows, with both."""
        jacobian, by_inputs, _, poses_by_x, poses_by_inputs = self.model.sensitivity(self._x, self._arguments[1])
        # At the same twist a tip turns with its drive.
        size = self.model.tube_count
        turning = ca.DM(self.model.size, self.model.robot.inputs.size)
        for index in range(size):
            turning[index, 2 * index] = 1
        return [jacobian, by_inputs + jacobian @ turning, poses_by_x, poses_by_inputs + poses_by_x @ turning]

    def _function(self, word: str, arguments: Mapping[str, ca.MX], results: Sequence[Matrix]) -> ca.Function:
        names = [f"{word}_{number}" for number in range(len(results))]
        function = ca.Function("of_y", list(arguments.values()), list(results), list(arguments), names)
        return dense(function, f"{self.name}_{word}")
