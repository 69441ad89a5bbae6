"""An exported folder of concentric tubes, compiled: the solver in C, from Python."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.compiled_results import SOLVED, AnswerInfo, JudgedAnswer, judged_words
from cosserat_casadi.codegen.input_values import ArgumentValues
from cosserat_casadi.codegen.loaded_library import LoadedLibrary, budget, by_tip
from cosserat_casadi.codegen.manifest import TUBES
from cosserat_casadi.codegen.plain import pointer, vector
from cosserat_casadi.codegen.status import TUBE_OUTCOMES
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome


class TubeInfo(AnswerInfo):
    """The struct in C that says how a call ended: what there is of every solve, then what there is of tubes."""

    _fields_ = (("determinant", ctypes.c_double),)


class TubeOptions(ctypes.Structure):
    """The struct in C with the budget of a turn."""

    _fields_ = (("max_iterations", ctypes.c_int), ("max_continuation_steps", ctypes.c_int))


@dataclass(frozen=True, kw_only=True)
class CompiledTubesSolution(JudgedAnswer):
    """What the solver in C found.

    Attributes:
        inputs: that it is of, shape (m,).
        x: unknowns: by how much the tip of each tube is turned against its drive, rad; under loads the quaternion of
            the frame at the tip of the robot less 1 0 0 0 behind them.
        tips: position and quaternion of the tip of each tube, shape (7,); none without a solution.
        determinant: 1 of tubes that do not twist, 0 where the robot snaps, negative where it cannot stay.
        derivatives: of the tip of each tube with the inputs, shape (7, m), where they were asked for.
        memory: what the next turn begins with.
    """

    inputs: FloatArray
    x: FloatArray
    tips: Mapping[str, FloatArray]
    determinant: float
    derivatives: Mapping[str, FloatArray] | None = None
    memory: bytes = field(default=b"", repr=False)


@dataclass(frozen=True)
class CompiledTubes(LoadedLibrary):
    """An exported folder of concentric tubes.

    Attributes:
        library: the shared object.
        manifest: what the folder says of itself.
    """

    @staticmethod
    def is_sound(described: Any) -> bool:
        """Whether what is read of a manifest of concentric tubes is there."""
        tubes = described[TUBES]
        names = isinstance(tubes, list) and all(isinstance(tube, str) for tube in tubes)
        return names and isinstance(described["unknowns"], int)

    @staticmethod
    def sizes(described: Mapping[str, Any]) -> dict[str, int]:
        """Number of the unknowns by its macro."""
        return {"UNKNOWNS": described["unknowns"]}

    @property
    def tubes(self) -> list[str]:
        """Names of the tubes, in order."""
        return list(self.manifest[TUBES])

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return int(self.manifest["unknowns"])

    def solve(self, inputs: ArgumentValues = None, start: CompiledTubesSolution | None = None) -> CompiledTubesSolution:
        """Equilibrium by the solver in C.

        Args:
            inputs: by name, or stacked: rotation and translation of each tube, then the loads; the scene's own by
                default.
            start: a solution to begin at; straight tubes by default, and where that does not lead to the inputs.

        Raises:
            SceneError: names of inputs are not those of the scene.
            ValueError: the inputs are of the wrong size.
        """
        given = self.inputs.stacked(inputs)
        x = self._start(start)
        info = self._ended("solve", pointer(given), pointer(x))
        return self._answer(given, x, info)

    def follow(self, start: CompiledTubesSolution, inputs: ArgumentValues) -> CompiledTubesSolution:
        """Equilibrium on the branch of another, along the straight line between the inputs of both.

        Args:
            start: the other.
            inputs: at the end of the line, by name or stacked.

        Raises:
            SceneError: names of inputs are not those of the scene.
            ValueError: the inputs are of the wrong size.
        """
        given = self.inputs.stacked(inputs)
        x = self._start(start)
        info = self._ended("follow", pointer(start.inputs), pointer(given), pointer(x))
        return self._answer(given, x, info)

    def track(
        self,
        inputs: ArgumentValues,
        start: CompiledTubesSolution,
        *,
        derivatives: bool = True,
        max_iterations: int | None = None,
        max_continuation_steps: int | None = None,
    ) -> CompiledTubesSolution:
        """One turn of a control loop: the solution and its derivatives, in bounded work.

        Args:
            inputs: of the turn, by name or stacked.
            start: the solution of the turn before.
            derivatives: whether those of the tips are wanted.
            max_iterations: most Newton steps; by default what the header says.
            max_continuation_steps: most points between the last inputs and these; likewise.

        Raises:
            SceneError: names of inputs are not those of the scene.
            ValueError: the inputs are of the wrong size, or one budget is given without the other.
        """
        given = self.inputs.stacked(inputs)
        options = budget(TubeOptions, max_iterations, max_continuation_steps)
        x = self._start(start)
        memory = ctypes.create_string_buffer(start.memory, self._function("memory_size")())
        columns = np.zeros((len(self.tubes), given.size, POSE_SIZE))
        wanted = pointer(columns) if derivatives else None
        info = self._ended("track", pointer(given), pointer(x), memory, options, None, wanted)
        # After any other end x is that of the turn before, for its inputs.
        solved = TUBE_OUTCOMES[info.status] is Outcome.CONVERGED
        found = by_tip(self.tubes, columns) if derivatives and solved else None
        return self._answer(given, x, info, solved=(Outcome.CONVERGED,), derivatives=found, memory=memory.raw)

    def sensitivity(self, solution: CompiledTubesSolution) -> dict[str, FloatArray] | None:
        """The d(position, quaternion)/dinputs of each tip, shape (7, m); None where there are none."""
        columns = np.zeros((len(self.tubes), solution.inputs.size, POSE_SIZE))
        arguments = (pointer(solution.inputs), pointer(solution.x), None, pointer(columns), self._workspace())
        status = self._function("solve_sensitivity")(*arguments)
        return None if status != 0 else by_tip(self.tubes, columns)

    def error_estimate(self, solution: CompiledTubesSolution) -> float | None:
        """Estimated error of an equilibrium, such as one of a turn; None where it is none."""
        estimate = ctypes.c_double()
        arguments = (pointer(solution.inputs), pointer(solution.x), ctypes.byref(estimate), self._workspace())
        status = self._function("error_estimate")(*arguments)
        return estimate.value if TUBE_OUTCOMES[status] is Outcome.CONVERGED else None

    def residual(self, x: npt.ArrayLike, inputs: ArgumentValues) -> FloatArray:
        """The residual, shape (unknowns,)."""
        given = self.inputs.stacked(inputs)
        result = np.zeros(self.size)
        own = vector(x, self.size, "x")
        self._function("residual")(pointer(own), pointer(given), pointer(result), self._workspace())
        return result

    def _start(self, start: CompiledTubesSolution | None) -> FloatArray:
        return np.zeros(self.size) if start is None else start.x.copy()

    def _ended(self, word: str, *arguments: Any) -> TubeInfo:
        """How a call of a function of the solver ended."""
        info = TubeInfo()
        self._function(word)(*arguments, self._workspace(), ctypes.byref(info))
        return info

    def _answer(
        self, inputs: FloatArray, x: FloatArray, info: TubeInfo, *, solved: Sequence[Outcome] = SOLVED, **more: Any
    ) -> CompiledTubesSolution:
        tips: dict[str, FloatArray] = {}
        if TUBE_OUTCOMES[info.status] in solved:
            poses = np.zeros((len(self.tubes), POSE_SIZE))
            self._function("poses")(pointer(x), pointer(inputs), pointer(poses), self._workspace())
            tips = dict(zip(self.tubes, poses, strict=True))
        return CompiledTubesSolution(
            **judged_words(info, TUBE_OUTCOMES),
            tolerance=self.manifest["tolerance"],
            inputs=inputs,
            x=x,
            tips=tips,
            determinant=info.determinant,
            **more,
        )
