"""A compiled exported folder: the solver in C, and CasADi functions, with exact derivatives if the folder has them."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.compiled_motion import CompiledMotion
from cosserat_casadi.codegen.compiled_results import (
    AnswerInfo,
    CompiledSolution,
    CompiledStability,
    Sensitivity,
    judged_words,
)
from cosserat_casadi.codegen.input_values import ArgumentValues, listed_parameters
from cosserat_casadi.codegen.lanes import lanes_files
from cosserat_casadi.codegen.loaded_library import room
from cosserat_casadi.codegen.names import FUNCTIONS, Names
from cosserat_casadi.codegen.plain import EXPORT_WITH, IN_PYTHON, PlainFunction, pointer, vector
from cosserat_casadi.codegen.stability import stability_files
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.function_table import PARAMETERS, SCALAR_ARGUMENTS, Owner
from cosserat_casadi.numerics.outcome import Outcome

OWNED = frozenset(spec.name for spec in FUNCTIONS if spec.public and spec.owner is not Owner.SCENE)
"""Functions that a scene may lack, such as those of bodies in a scene without bodies."""


@dataclass(frozen=True)
class Compiled(CompiledMotion):
    """An exported folder as compiled functions.

    Methods take inputs by name, or all inputs stacked; inputs that are not named keep the scene's values. Parameters
    are passed alike, if the scene names some. Methods raise a ValueError for an argument of the wrong size, and a
    SceneError for names or values that the scene refuses. Functions take inputs and parameters stacked, as two
    arguments, like functions of a model.

    Every function of the header in C is a member with its name in :class:`Model`: ``tip``, ``shape``, ``igm``,
    ``tip_jacobian`` by rod, ``actuator`` by actuator, ``body`` and ``body_jacobian`` by body, with its results in C. A
    pose is (position, quaternion). Functions with the key ``external`` in the manifest have derivatives like
    :attr:`residual`; other functions have none.

    Attributes:
        library: the shared object.
        manifest: contents of the folder, as data.
        info_type: the struct in C with the outcome of a call.
        outcomes: outcomes of the solver, in the order of their numbers.
    """

    info_type: ClassVar[type[AnswerInfo]] = AnswerInfo
    outcomes: ClassVar[Sequence[Outcome]] = OUTCOMES

    @staticmethod
    def is_sound(described: Any) -> bool:
        """Whether a manifest of rods has all entries that are read."""
        rods = all(isinstance(entry["rod"], str) and type(entry["count"]) is int for entry in described["unknowns"])
        named = [*described.get("bodies", []), *described.get("joints", [])]
        owners = [*(entry["name"] for entry in described.get("actuators", [])), *named]
        functions = all(isinstance(entry, dict) for entry in described["functions"])
        listed_parameters(described.get("parameters", []))
        return rods and functions and all(isinstance(name, str) for name in owners)

    @staticmethod
    def sizes(described: Mapping[str, Any]) -> dict[str, int]:
        """Numbers of unknowns and parameters, by their macros."""
        unknowns = sum(entry["count"] for entry in described["unknowns"])
        return {"UNKNOWNS": unknowns, **CompiledMotion.sizes(described)}

    @cached_property
    def _names(self) -> Names:
        described = self.manifest
        rods = dict.fromkeys(entry["rod"] for entry in described["unknowns"])
        actuators = tuple(entry["name"] for entry in described.get("actuators", []))
        bodies, joints = (tuple(described.get(key, [])) for key in ("bodies", "joints"))
        return Names(described["name"], tuple(rods), actuators, bodies, joints)

    @cached_property
    def differentiable(self) -> bool:
        """Whether the folder was exported with derivatives of its functions."""
        return f"{self._names.name}_derivatives.c" in self.manifest["files"]

    @cached_property
    def residual(self) -> ca.Function:
        """(x, inputs) ↦ residual; with exact first and second derivatives if :attr:`differentiable`.

        For a scene with parameters the arguments are (x, inputs, p).
        """
        if self.differentiable:
            return ca.external(self._names.differentiable("residual"), str(self.library))
        in_c = self._function("residual")

        def evaluate(arguments: Sequence[FloatArray]) -> list[FloatArray]:
            residual = np.empty(self.size)
            in_c(*map(pointer, arguments), pointer(residual), self._workspace())
            return [residual]

        arguments = {"x": (self.size, 1), "inputs": (self.inputs.size, 1)}
        if self.parameters.size:
            arguments[PARAMETERS] = (self.parameters.size, 1)
        return PlainFunction("residual", arguments, {"residual": (self.size, 1)}, evaluate, EXPORT_WITH)

    def __getattr__(self, name: str) -> Any:
        """Return a function of the header as a CasADi function, or one for each rod, actuator or body, by name."""
        # An attribute that is not set yet, such as in a copy under way, must not be asked for here.
        manifest = self.__dict__.get("manifest", {})
        entries = [entry for entry in manifest.get("functions", []) if entry.get("function") == name]
        if not entries and name not in OWNED:
            raise AttributeError(f"the library has no function {name!r}")
        functions = {entry.get("owner"): self._casadi_function(entry) for entry in entries}
        # A function of the scene has no owner, and stands alone.
        member = functions.get(None, functions)
        self.__dict__[name] = member
        return member

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return sum(int(entry["count"]) for entry in self.manifest["unknowns"])

    def solve(
        self,
        inputs: ArgumentValues = None,
        start: npt.ArrayLike | None = None,
        *,
        parameters: ArgumentValues = None,
    ) -> CompiledSolution:
        """Solve for an equilibrium in C, from given unknowns, by default those of the unloaded rod."""
        given = self.inputs.stacked(inputs)
        x = vector(np.zeros(self.size) if start is None else start, self.size, "start").copy()
        info = self.info_type()
        p = self.parameters.passed(parameters)
        self._function("solve")(pointer(given), *p, pointer(x), self._workspace(), ctypes.byref(info))
        return self._solution(x, given, info)

    def _solution(self, x: FloatArray, inputs: FloatArray, info: AnswerInfo) -> CompiledSolution:
        """Make a solution of unknowns, inputs, and the struct with the outcome."""
        words = judged_words(info, self.outcomes)
        return CompiledSolution(**words, tolerance=self.tolerance, inputs=inputs, x=x)

    def error_estimate(
        self, inputs: ArgumentValues, x: npt.ArrayLike, *, parameters: ArgumentValues = None
    ) -> float | None:
        """Estimate the error of an equilibrium by the missing modes of the model; None if x is no equilibrium.

        Raises:
            AttributeError: the folder was exported without the estimate.
        """
        arguments = *self._given(inputs, parameters), pointer(vector(x, self.size, "x"))
        estimate = ctypes.c_double()
        status = self._function("error_estimate")(*arguments, ctypes.byref(estimate), self._workspace())
        return estimate.value if self.outcomes[status] is Outcome.CONVERGED else None

    def follow(
        self,
        before: ArgumentValues,
        inputs: ArgumentValues,
        start: npt.ArrayLike,
        *,
        parameters_before: ArgumentValues = None,
        parameters: ArgumentValues = None,
    ) -> CompiledSolution:
        """Solve for an equilibrium in C along the straight line from inputs for which ``start`` is an equilibrium.

        Args:
            before: inputs for which ``start`` is an equilibrium.
            inputs: inputs of the result.
            start: unknowns.
            parameters_before: parameters for which ``start`` is an equilibrium.
            parameters: parameters of the result.
        """
        old = self.inputs.stacked(before, "before")
        given = self.inputs.stacked(inputs)
        x = vector(start, self.size, "start").copy()
        info = self.info_type()
        old_p = self.parameters.passed(parameters_before)
        p = self.parameters.passed(parameters)
        work = self._workspace()
        self._function("follow")(pointer(old), *old_p, pointer(given), *p, pointer(x), work, ctypes.byref(info))
        return self._solution(x, given, info)

    def solve_batch(self, inputs: npt.ArrayLike, *, parameters: ArgumentValues = None) -> list[CompiledSolution]:
        """Solve for equilibria of many load cases.

        Args:
            inputs: shape (count, size of the inputs), or one row for all.
            parameters: shape (count, size of the parameters), or one set for all rows, by name or stacked.

        Raises:
            ValueError: inputs or parameters are of the wrong size, or of different numbers of rows.
            SceneError: the scene has no parameters of these names.
        """
        given, passed = self._rows(inputs, parameters)
        count = len(given)
        x = np.zeros((count, self.size))
        infos = (self.info_type * count)()
        side_by_side = lanes_files(self._names.name)[0] in self.manifest["files"]
        work = room(self._function("batch_workspace_size")()) if side_by_side else self._workspace()
        self._function("solve_batch")(count, pointer(given), *passed, pointer(x), work, 1, infos)
        return [self._solution(*row) for row in zip(x, given, infos, strict=True)]

    def sensitivity(
        self, inputs: ArgumentValues, x: npt.ArrayLike, *, parameters: ArgumentValues = None
    ) -> tuple[FloatArray, dict[str, FloatArray]] | None:
        """Return dx/dinputs, and d(position, quaternion)/dinputs of each tip; None if x is no regular equilibrium."""
        found = self._sensitivities(inputs, x, parameters)
        return None if found is None else (found[0].x, found[0].tips)

    def body_sensitivity(
        self, inputs: ArgumentValues, x: npt.ArrayLike, *, parameters: ArgumentValues = None
    ) -> dict[str, FloatArray] | None:
        """Return d(position, quaternion)/dinputs of each rigid body; None if x is no regular equilibrium."""
        found = self._sensitivities(inputs, x, parameters)
        return None if found is None else found[0].bodies

    def stability(
        self, inputs: ArgumentValues, x: npt.ArrayLike, *, parameters: ArgumentValues = None
    ) -> CompiledStability | None:
        """Judge the stability of an equilibrium, for loads with a potential; None if x is no equilibrium.

        Raises:
            AttributeError: the folder was exported without stability.
        """
        if stability_files(self._names.name)[0] not in self.manifest["files"]:
            raise AttributeError("export the folder with stability: export(..., stability=True)")
        return self._judged(*self._given(inputs, parameters), pointer(vector(x, self.size, "x")))

    def parameter_sensitivity(
        self, inputs: ArgumentValues, x: npt.ArrayLike, *, parameters: ArgumentValues = None
    ) -> Sensitivity | None:
        """Return the derivatives of an equilibrium by the parameters; None if x is no regular equilibrium."""
        found = self._sensitivities(inputs, x, parameters)
        return None if found is None else found[1]

    def _sensitivities(
        self, inputs: ArgumentValues, x: npt.ArrayLike, parameters: ArgumentValues
    ) -> tuple[Sensitivity, Sensitivity] | None:
        """Return derivatives by inputs and by parameters; without parameters the second ones have no columns."""
        given = *self._given(inputs, parameters), pointer(vector(x, self.size, "x"))
        rods, bodies = self._names.rods, self._names.bodies
        d_x = [np.zeros((count, self.size)) for count in (self.inputs.size, self.parameters.size)]
        d_poses = [np.zeros((len(rods) + len(bodies), len(columns), 7)) for columns in d_x]
        # A scene without parameters has no derivative with them to be passed.
        kinds = 2 if self.parameters.size else 1
        results = [*map(pointer, d_x[:kinds]), *map(pointer, d_poses[:kinds])]
        status = self._function("solve_sensitivity")(*given, *results, self._workspace())
        if status != 0:
            return None
        by_inputs, by_parameters = (
            Sensitivity(
                x=columns.T,
                tips={rod: pose.T for rod, pose in zip(rods, poses, strict=False)},
                bodies={body: pose.T for body, pose in zip(bodies, poses[len(rods) :], strict=True)},
            )
            for columns, poses in zip(d_x, d_poses, strict=True)
        )
        return by_inputs, by_parameters

    def _casadi_function(self, entry: dict[str, Any]) -> ca.Function:
        """Return a function of the library, with derivatives if the folder has them."""
        external = entry.get("external")
        if external and self.differentiable:
            return ca.external(external, str(self.library))
        in_c = getattr(self._handle, entry["symbol"])
        arguments = {argument["name"]: tuple(argument["shape"]) for argument in entry["arguments"]}
        results = {result["name"]: tuple(result["shape"]) for result in entry["results"]}

        def evaluate(given: Sequence[FloatArray]) -> list[FloatArray]:
            vectors = [np.empty(shape, order="F") for shape in results.values()]
            passed = [_argument(name, values) for name, values in zip(arguments, given, strict=True)]
            in_c(*passed, *map(pointer, vectors))
            return vectors

        return PlainFunction(entry["symbol"], arguments, results, evaluate, EXPORT_WITH if external else IN_PYTHON)


def _argument(name: str, values: FloatArray) -> Any:
    """Convert an argument for C: scalars are passed by value."""
    return ctypes.c_double(values[0]) if name in SCALAR_ARGUMENTS else pointer(values)
