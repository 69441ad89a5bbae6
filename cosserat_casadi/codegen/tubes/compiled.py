"""A compiled exported folder of concentric tubes: the solver in C, called from Python."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.compiled_results import CompiledSolution, CompiledTurn, TubeInfo, judged_words
from cosserat_casadi.codegen.input_values import ArgumentValues
from cosserat_casadi.codegen.loaded_library import budget, by_tip
from cosserat_casadi.codegen.manifest import TUBES
from cosserat_casadi.codegen.plain import pointer, vector
from cosserat_casadi.codegen.status import TUBE_OUTCOMES
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome


class TubeOptions(ctypes.Structure):
    """The struct in C with the budget of a turn."""

    _fields_ = (("max_iterations", ctypes.c_int), ("max_continuation_steps", ctypes.c_int))


@dataclass(frozen=True)
class CompiledTubes(Compiled):
    """An exported folder of concentric tubes: the functions of every folder, poses of all tips, and turns.

    Unknowns are the rotation of the tip of each tube relative to its drive, rad, and under loads the quaternion of the
    frame at the tip of the robot less 1 0 0 0. The solver starts from straight tubes unless there is a start.
    """

    info_type: ClassVar[type[TubeInfo]] = TubeInfo
    outcomes: ClassVar = TUBE_OUTCOMES

    @property
    def tubes(self) -> list[str]:
        """Names of the tubes, in order."""
        return list(self.manifest[TUBES])

    def poses(
        self, inputs: ArgumentValues, x: npt.ArrayLike, *, parameters: ArgumentValues = None
    ) -> dict[str, FloatArray]:
        """Return position and quaternion of the tip of each tube, shape (7,)."""
        poses = np.zeros((len(self.tubes), POSE_SIZE))
        given = self._given(inputs, parameters)
        self._function("poses")(pointer(vector(x, self.size, "x")), *given, pointer(poses), self._workspace())
        return dict(zip(self.tubes, poses, strict=True))

    def track(
        self,
        inputs: ArgumentValues,
        start: CompiledSolution,
        *,
        parameters: ArgumentValues = None,
        derivatives: bool = True,
        max_iterations: int | None = None,
        max_continuation_steps: int | None = None,
    ) -> CompiledTurn:
        """Compute one turn of a control loop: the solution and its derivatives, in bounded work.

        Args:
            inputs: inputs of the turn.
            start: the solution of the turn before.
            parameters: parameters of the turn; by default those of the scene.
            derivatives: whether derivatives of the tips are wanted.
            max_iterations: most Newton steps; by default as in the header.
            max_continuation_steps: most points between the last inputs and these; by default as in the header.

        Raises:
            ValueError: one budget is given without the other.
        """
        given = self.inputs.stacked(inputs)
        p = self.parameters.passed(parameters)
        options = budget(TubeOptions, max_iterations, max_continuation_steps)
        x = start.x.copy()
        memory = ctypes.create_string_buffer(getattr(start, "memory", b""), self._function("memory_size")())
        columns = np.zeros((len(self.tubes), given.size, POSE_SIZE))
        # Derivatives with the parameters are not asked for.
        wanted = [None] * (2 + 2 * len(p))
        if derivatives:
            wanted[1 + len(p)] = pointer(columns)
        info = TubeInfo()
        arguments = pointer(given), *p, pointer(x), memory, options, *wanted
        self._function("track")(*arguments, self._workspace(), ctypes.byref(info))
        # After any other end x is the solution of the last turn, at its inputs.
        solved = self.outcomes[info.status] is Outcome.CONVERGED
        return CompiledTurn(
            **judged_words(info, self.outcomes),
            tolerance=self.tolerance,
            inputs=given,
            x=x,
            derivatives=by_tip(self.tubes, columns) if derivatives and solved else None,
            memory=memory.raw,
        )
