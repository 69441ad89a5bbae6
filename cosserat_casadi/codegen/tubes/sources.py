"""A folder of C sources of concentric tubes: header, kernels, solver, build file, README, manifest.

Its kernels are the equations of concentric tubes as functions for C. The unknown is the twist y: the rotation of the
tip of each tube relative to its drive, and under loads the difference of the quaternion of the frame at the tip of the
robot from one. For straight tubes y = 0, and a rotation of all drives together does not change y. On the path from
straight tubes, t from 0 to 1, the tubes are bent first, and then loaded.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.block_sources import dense_words
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.library import (
    ONE_BY_ONE,
    PLAIN_BUILD,
    ROWS_OF_UNKNOWNS,
    SHARED,
    batch_words,
    input_words,
    rendered,
    solver_constants,
    title_words,
)
from cosserat_casadi.codegen.manifest import TUBES, accuracy_entries, head_entries, with_manifest
from cosserat_casadi.codegen.names import Names, scene_names
from cosserat_casadi.codegen.parameter_sources import parameter_words
from cosserat_casadi.codegen.parameters import given_size, parameter_rate, with_parameters_behind_inputs
from cosserat_casadi.codegen.status import TUBE_OUTCOMES, status_words
from cosserat_casadi.codegen.turn_budget import ALWAYS
from cosserat_casadi.compiling.c_tables import numbers
from cosserat_casadi.equilibrium.load_path import NEARLY_LOADED
from cosserat_casadi.errors import ExportError, Problem, refuse
from cosserat_casadi.maths.calls import with_dense_results
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.numerics import newton
from cosserat_casadi.numerics.continuation import ContinuationSettings
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.tubes.robot import Robot
from cosserat_casadi.tubes.tube_functions import RESOLVED, TubeFunctions

NEAR = 0.3
"""Largest change of the twist, rad, in one go within a turn; a longer path is followed in steps."""

LIMITS = replace(ContinuationSettings(), longest=0.5)
"""Limits of a path: no step changes the twist by much more than ``longest``, rad, so that no snap is skipped."""

OWN = ("tubes_error.c", "tubes_turn.c")
"""Files of the folder ``c`` that only tubes need."""

OTHERS = ("solver_recover.c",)
"""Files of the solver that tubes do not need."""

RANGES = (
    "a translation from zero to the length of its tube, and by the bounds and ranges of\n   the scene. The solver "
    "refuses a translation beyond its tube, and inputs at which no tube\n   stands out of the plate, even if each of "
    "them is in its range; it ignores bounds and ranges."
)
"""Sentence on the ranges of inputs, and on the solver beyond them, for the header."""

ONE_SIDED = " Where two tubes end at one\n   place, or a curved part begins in the plate, they are those of one side."
"""Sentence on one-sided derivatives, for the header."""

VERBATIM = (*(file for file in SHARED if file not in OTHERS), "linear_dense.c", *OWN)
"""Files of the folder ``c`` that the library's own source includes unchanged."""


def check_tubes(asked: Mapping[str, bool]) -> None:
    """Refuse options that C does not support for concentric tubes.

    Args:
        asked: whether each option is requested, by option; batches are not refused.

    Raises:
        ExportError: options are refused; the error lists all of them.
    """
    problem = "needs a scene of rods, and this scene has concentric tubes"
    lost = [option for option, wanted in asked.items() if wanted and option != "--batches"]
    refuse([Problem(option, problem, "leave it out") for option in lost], ExportError)


def tube_files(
    model: TubeFunctions, name: str, error_estimate: float | None, *, batches: bool = False
) -> dict[str, str]:
    """Write the text of every file of a folder, by name; the manifest, which lists these files, is last.

    Args:
        model: the robot with its steps.
        name: name of the library.
        error_estimate: error of the tips at the scene's inputs, for manifest and README; None if unknown.
        batches: whether the function for many load cases was requested.

    Raises:
        ExportError: the name is not valid for a library, or two inputs would have one name in C.
    """
    names = scene_names(name, model.scene)
    kernels = TubeKernels(model, f"{name}_k").all()
    generated = kernel_sources(kernels, names)
    order = ONE_BY_ONE if batches else ""
    words = _words(model, names, generated, error_estimate) | batch_words(name, order)
    files = {
        **rendered(words, VERBATIM),
        **generated,
        "scene.toml": scene_text(model.robot.scene),
    }
    return with_manifest(files, _manifest(model, names, error_estimate) | ({"batches": order} if order else {}))


def _words(
    model: TubeFunctions, names: Names, generated: dict[str, str], error_estimate: float | None
) -> dict[str, Any]:
    robot = model.robot
    size = model.size
    basics: dict[str, Any] = {
        "name": names.name,
        "MACRO": names.macro,
        "unknowns": size,
        "inputs": robot.inputs.size,
        "poses": robot.size,
        "input_room": given_size(model),
    }
    under_loads = ",\n   then by how much the quaternion of the frame at the tip of the robot differs from 1 0 0 0"
    return {
        **basics,
        **dense_words(basics),
        **solver_constants(LIMITS, NEAR, NEARLY_LOADED),
        **status_words(names, TUBE_OUTCOMES),
        **input_words(model, names, RANGES),
        **title_words(names, robot.scene, generated),
        **PLAIN_BUILD,
        "of_tubes": True,
        **parameter_words(basics, model, names, dynamics=False),
        **dict.fromkeys(("functions", "prototypes"), ""),
        "inner": "any_",
        "outer": "stacked_" if model.parameters.size else "",
        "family": "tubes_",
        "tells_errors": True,
        "solves_tangent": True,
        "first": 1.0,
        "pose_owners": "the tip of each tube",
        "one_sided": ONE_SIDED,
        "turn_jacobians": 3,
        "max_reuses": newton.MAX_REUSES,
        "kept_steps": newton.MAX_REUSES,
        "default_iterations": ALWAYS.iterations,
        "default_continuation_steps": ALWAYS.steps,
        **ROWS_OF_UNKNOWNS,
        "batch_solve": "tubes_solve",
        "unknowns_under_loads": under_loads if robot.loads else "",
        "pose_macros": _number_macros(names, robot),
        "first_tube": int(np.argmax(robot.translations(robot.inputs))),
        "halved_residual": repr(RESOLVED * robot.tolerance),
        "lengths": numbers(robot.length.tolist()),
        "step_weights": numbers([1.0] * size),
        "is_shape": numbers([1] * size),
        "paces": 0,
        "accuracy_note": _accuracy_note(model, error_estimate),
    }


def _accuracy_note(model: TubeFunctions, error_estimate: float | None) -> str:
    estimate = "was not estimated" if error_estimate is None else f"is {error_estimate:.1e}"
    return (
        "Each piece between ends of tubes, beginnings of curved parts and places of forces has "
        f"{model.steps} steps. The estimated error of the tips at the scene's own inputs {estimate}; "
        f"the scene allows {model.robot.tolerance:g} of the length outside. At other inputs half of the steps are "
        "compared with all of them: where they differ too much, the status is `UNRESOLVED`."
    )


def _number_macros(names: Names, robot: Robot) -> str:
    return "\n".join(f"#define {names.macro}_TUBE_{tube.upper()} {index}" for index, tube in enumerate(robot.names))


def _manifest(model: TubeFunctions, names: Names, error_estimate: float | None) -> dict[str, Any]:
    """Describe the contents of the folder, as data."""
    robot = model.robot
    unknowns = [{"rod": tube, "first": index, "count": 1} for index, tube in enumerate(robot.names)]
    if model.size > robot.size:
        outermost = robot.names[int(np.argmax(robot.translations(robot.inputs)))]
        unknowns.append({"rod": outermost, "frame": "tip", "first": robot.size, "count": model.size - robot.size})
    return {
        **head_entries(names, model),
        TUBES: list(robot.names),
        "unknowns": unknowns,
        "steps": model.steps,
        **accuracy_entries(robot.scene, error_estimate, None),
        "functions": [],
    }


@dataclass(frozen=True)
class TubeKernels:
    """The functions in C of a robot.

    Attributes:
        model: the robot, with an even number of steps.
        name: prefix of their names.
    """

    model: TubeFunctions
    name: str

    def all(self) -> list[ca.Function]:
        """All kernels: residual, Jacobian, rate, change by half of the steps, poses, sensitivity; results are dense."""
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
        """Symbols of twist and inputs, and of parameters if the scene names some."""
        symbols = {"y": ca.MX.sym("y", self.model.size), "inputs": ca.MX.sym("inputs", self.model.inputs.size)}
        if self.model.parameters.size:
            symbols[PARAMETERS] = self.model.parameters.symbol
        return symbols

    @cached_property
    def _load_factor(self) -> ca.MX:
        """Symbol of the place t on the path from straight tubes."""
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
        """Distance of the tips with half of the steps, after a step of the unknowns, as in :func:`tip_error`.

        It is the largest of all tubes: of distances over the protruding length, and of angles.
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
        """Derivatives of the residual by y and by the inputs, and of the poses, 7 n rows, by both.

        Derivatives by the parameters follow those by the inputs.
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
        """Make a kernel, with parameters appended to the inputs in one argument."""
        written = with_parameters_behind_inputs(self._written(word, results, further))
        return with_dense_results(written, f"{self.name}_{word}")

    def _written(self, word: str, results: Sequence[Matrix], further: Mapping[str, ca.MX] | None = None) -> ca.Function:
        """Make a function of the twist, the inputs and the parameters, and of further arguments."""
        arguments = {**self._symbols, **(further or {})}
        names = [f"{word}_{number}" for number in range(len(results))]
        return ca.Function("of_y", list(arguments.values()), list(results), list(arguments), names)
