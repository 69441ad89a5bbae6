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

from cosserat_casadi.codegen.parameters import parameter_rate, with_parameters_behind_inputs
from cosserat_casadi.maths.calls import with_dense_results
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.tubes.tube_functions import TubeFunctions


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
        x, *given = self._of_model.values()
        load_factor = self._load_factor
        on_path = self._on_path
        inputs_rate, load_factor_rate = ca.MX.sym("inputs_rate", given[0].size1()), ca.MX.sym("load_factor_rate")
        step = ca.MX.sym("step", self.model.size)
        residual = self.model.path_residual(x, *on_path)
        rate = ca.jtimes(residual, ca.vertcat(given[0], load_factor), ca.vertcat(inputs_rate, load_factor_rate))
        path = {"load_factor": load_factor}
        rates = {**path, "inputs_rate": inputs_rate, "load_factor_rate": load_factor_rate}
        functions = [
            self._function("residual", [residual], path),
            self._function("jacobian", [self.model.path_jacobian(x, *on_path)], path),
            self._function("rate", [rate], rates),
            self._function("halved_residual", [self.model.halved.residual(x, *given)]),
            self._function("halved_change", [self._halved_change(step)], {"step": step}),
            self._function("poses", [ca.vertcat(*self.model.tips(x, *given))]),
            self._function("sensitivity", self._sensitivity()),
        ]
        if self.model.parameters.size:
            lengths = ca.Function("lengths", given, [self.model.robot.numbers.length], ["inputs", PARAMETERS], ["m"])
            functions.append(with_dense_results(with_parameters_behind_inputs(lengths), f"{self.name}_lengths"))
            path_residual = self._written("residual", [residual], path)
            functions.append(with_dense_results(parameter_rate(path_residual, "of_p"), f"{self.name}_parameter_rate"))
        return functions

    @cached_property
    def _symbols(self) -> dict[str, ca.MX]:
        """Twist, inputs, and parameters where the scene names some."""
        symbols = {"y": ca.MX.sym("y", self.model.size), "inputs": ca.MX.sym("inputs", self.model.inputs.size)}
        if self.model.parameters.size:
            symbols[PARAMETERS] = self.model.parameters.symbol
        return symbols

    @cached_property
    def _load_factor(self) -> ca.MX:
        """Place t on the way from straight tubes."""
        return ca.MX.sym("load_factor")

    @cached_property
    def _of_model(self) -> dict[str, Matrix]:
        """Unknowns of the model, inputs, and parameters."""
        robot = self.model.robot
        frame = ca.DM([1, 0, 0, 0])[: self.model.size - robot.size]
        x = self._symbols["y"] + ca.vertcat(robot.rotations(self._symbols["inputs"]), frame)
        return {**self._symbols, "y": x}

    @property
    def _on_path(self) -> list[Matrix]:
        """Inputs, parameters and load factor of the model at a place on the way."""
        robot = self.model.robot
        t = self._load_factor
        _, inputs, *p = self._symbols.values()
        if not robot.loads:
            return [inputs, *p, t]
        of_loads = ca.fmax(2 * t - 1, 0)
        drives, loads = inputs[: 2 * robot.size], inputs[2 * robot.size :]
        return [ca.vertcat(drives, of_loads * loads), *p, ca.fmin(2 * t, 1)]

    def _halved_change(self, step: ca.MX) -> Matrix:
        """Distance of the tips with half of the steps, a step of the unknowns away, as :func:`tip_error` has it.

        The largest of all tubes: distances over the length that stands out, and angles.
        """
        x, *given = self._of_model.values()
        positions, quaternions = self.model.tips(x, *given)
        other_positions, other_quaternions = self.model.halved.tips(x + step, *given)
        length = ca.mmax(self.model.robot.translations(self._symbols["inputs"]))
        changes = []
        for index in range(self.model.tube_count):
            difference = quaternion_product(quaternion_conjugate(quaternions[:, index]), other_quaternions[:, index])
            angle = 2 * ca.atan2(ca.norm_2(difference[1:]), ca.fabs(difference[0]))
            distance = ca.norm_2(other_positions[:, index] - positions[:, index])
            changes += [distance / length, angle]
        largest: Matrix = ca.mmax(ca.vertcat(*changes))
        return largest

    def _sensitivity(self) -> list[Matrix]:
        """Derivatives of the residual with y and with the inputs, and of the poses, 7 n rows, with both.

        Derivatives with the parameters follow the derivatives with the inputs.
        """
        at = list(self._of_model.values())
        jacobian, by_inputs, _, poses_by_x, poses_by_inputs, *by_parameters = self.model.sensitivity(*at)
        # At the same twist a tip turns with its drive.
        size = self.model.tube_count
        turning = ca.DM(self.model.size, self.model.inputs.size)
        for index in range(size):
            turning[index, 2 * index] = 1
        by_given = ca.horzcat(by_inputs + jacobian @ turning, *by_parameters[:1])
        poses_by_given = ca.horzcat(poses_by_inputs + poses_by_x @ turning, *by_parameters[1:])
        return [jacobian, by_given, poses_by_x, poses_by_given]

    def _function(
        self, word: str, results: Sequence[Matrix], further: Mapping[str, ca.MX] | None = None
    ) -> ca.Function:
        """A kernel; parameters stand behind the inputs in one argument."""
        written = with_parameters_behind_inputs(self._written(word, results, further))
        return with_dense_results(written, f"{self.name}_{word}")

    def _written(self, word: str, results: Sequence[Matrix], further: Mapping[str, ca.MX] | None = None) -> ca.Function:
        """A function of the twist, of the inputs and the parameters, and of further arguments."""
        arguments = {**self._symbols, **(further or {})}
        names = [f"{word}_{number}" for number in range(len(results))]
        return ca.Function("of_y", list(arguments.values()), list(results), list(arguments), names)
