"""Motions of a compiled folder: a start at rest, steps of fixed size, their derivatives, the equations of motion."""

from __future__ import annotations

import ctypes
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.input_values import ArgumentValues
from cosserat_casadi.codegen.loaded_library import LoadedLibrary, room
from cosserat_casadi.codegen.plain import pointer, vector
from cosserat_casadi.codegen.status import MOTION_STATUSES, MotionStatus
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.step_words import STEP_ITERATIONS, STEP_PARTS, STEP_TOLERANCE


@dataclass(frozen=True)
class StepState:
    """A state of motion.

    Attributes:
        x: unknowns, shape (size,).
        v: rates of the unknowns, shape (size,), 1/s; zero for multipliers and tensions.
        a: accelerations of the unknowns, shape (size,), 1/s²; they are the initial guess of the next step.
    """

    x: FloatArray
    v: FloatArray
    a: FloatArray


@dataclass(frozen=True)
class CompiledStep:
    """A step of a motion by the solver in C.

    Attributes:
        state: state at the end of the step; if the step failed, the state at its start.
        status: outcome of the step.
        iterations: number of Newton corrections, including failed attempts.
        jacobians: number of Jacobian evaluations.
        parts: number of parts into which the step was cut; 1 for a whole step.
        residual: largest entry of the equations before the last correction.
        error_left: remaining error of Newton's method by its contraction, as displacement over the length.
    """

    state: StepState
    status: MotionStatus
    iterations: int
    jacobians: int
    parts: int
    residual: float
    error_left: float

    @property
    def done(self) -> bool:
        """Whether the step was taken."""
        return self.status is MotionStatus.DONE


@dataclass(frozen=True)
class StepContact:
    """A section or a body that presses on an obstacle or another rod, or a joint on its rigid stop, at a step's end.

    Attributes:
        owner: name of the rod, of the body, or of the joint.
        obstacle: name of the obstacle, or of the other rod; of a joint its key, ``lower_stop`` or ``upper_stop``.
        of_body: whether a body touches.
        place: abscissa X of the section; 0 of a body or a joint.
        at_other: abscissa of the section of the other rod, of two rods; else None.
        force: on it along the normal of the obstacle, mean of the last stretch of the step, N; of a stop its push, N or
            N m.
        friction: on it along the surface, mean of the same stretch, in the axes of the body that carries the obstacle,
            or of the world, shape (3,), N.
        slips: whether it slips at the end of the step, as all does without friction; else it sticks.
    """

    owner: str
    obstacle: str
    of_body: bool
    place: float
    force: float
    friction: FloatArray
    slips: bool
    at_other: float | None


@dataclass(frozen=True)
class StepSensitivity:
    """Derivatives of the stacked x and v at the end of a step.

    Attributes:
        by_start: derivative by x and v at the start, shape (2 size, 2 size).
        by_inputs: derivative by the inputs at the start, shape (2 size, inputs).
        by_inputs_rate: derivative by the rates of the inputs at the start, shape (2 size, inputs).
        by_inputs_acceleration: derivative by the accelerations of the inputs in the step, shape (2 size, inputs).
        by_parameters: derivative by the parameters, which are constant, shape (2 size, parameters).
    """

    by_start: FloatArray
    by_inputs: FloatArray
    by_inputs_rate: FloatArray
    by_inputs_acceleration: FloatArray
    by_parameters: FloatArray


@dataclass(frozen=True)
class LinearMotion:
    """Derivatives of the equations of motion at a state.

    Attributes:
        stiffness: derivative by x, shape (size, size).
        damping: derivative by v, shape (size, size), s.
        mass: derivative by a, shape (size, size), s².
        by_inputs: derivative by the inputs, shape (size, inputs).
        by_inputs_rate: derivative by the rates of the inputs, shape (size, inputs).
        by_inputs_acceleration: derivative by the accelerations of the inputs, shape (size, inputs).
        by_parameters: derivative by the parameters, shape (size, parameters).
    """

    stiffness: FloatArray
    damping: FloatArray
    mass: FloatArray
    by_inputs: FloatArray
    by_inputs_rate: FloatArray
    by_inputs_acceleration: FloatArray
    by_parameters: FloatArray


@dataclass(frozen=True)
class StepOptions:
    """Budget of one step.

    Attributes:
        tolerance: largest displacement error of Newton's method, over the length; 0 for rounding.
        iterations: most corrections of one attempt.
        parts: most parts into which a step is cut.
    """

    tolerance: float = STEP_TOLERANCE
    iterations: int = STEP_ITERATIONS
    parts: int = STEP_PARTS


@dataclass(frozen=True)
class StepMemory:
    """Memory of the steps of one motion; its attributes are for the functions in C alone.

    Attributes:
        kept: data that one step hands to the next.
        workspace: work memory, without meaning between two steps.
    """

    kept: Any
    workspace: Any

    def __reduce__(self) -> tuple[Callable[..., StepMemory], tuple[bytes, int]]:
        """Rebuild the memory in pickled copies, with a new workspace."""
        return _memory_of, (bytes(self.kept), ctypes.sizeof(self.workspace))


def _memory_of(kept: bytes, workspace_size: int) -> StepMemory:
    """Make the memory of steps from the bytes that they keep and the size of the workspace."""
    memory = StepMemory(room(len(kept)), room(workspace_size))
    ctypes.memmove(memory.kept, kept, len(kept))
    return memory


@dataclass(frozen=True)
class _Given:
    """Arguments of a step: inputs at its start, their rates and accelerations, parameters."""

    inputs: ArgumentValues
    inputs_rate: npt.ArrayLike | None
    inputs_acceleration: npt.ArrayLike | None
    parameters: ArgumentValues


class _Options(ctypes.Structure):
    _fields_ = (
        ("tolerance", ctypes.c_double),
        ("iterations", ctypes.c_int),
        ("parts", ctypes.c_int),
        ("inputs_acceleration", ctypes.POINTER(ctypes.c_double)),
    )


@cache
def _contact_record(*, of_rods: bool, rubs: bool) -> type[ctypes.Structure]:
    """The record in C of a contact: of a library in which rods may touch rods, and in which something rubs."""
    plain = [("pair", ctypes.c_int), ("place", ctypes.c_double), ("force", ctypes.c_double)]
    on_other = [("other_place", ctypes.c_double)] if of_rods else []
    rubbing = [("friction", 3 * ctypes.c_double), ("slips", ctypes.c_int)] if rubs else []
    return type("_Contact", (ctypes.Structure,), {"_fields_": [*plain, *on_other, *rubbing]})


class _Info(ctypes.Structure):
    _fields_ = (
        ("status", ctypes.c_int),
        ("iterations", ctypes.c_int),
        ("jacobians", ctypes.c_int),
        ("parts", ctypes.c_int),
        ("residual", ctypes.c_double),
        ("error_left", ctypes.c_double),
    )


@dataclass(frozen=True)
class _StepCall:
    """A prepared call of the step in C, for any number of steps: each call starts where the last one ended.

    Attributes:
        function: the function in C.
        arguments: arguments of the function.
        packed: the state, which the function updates.
        info: outcome of the last call.
        kept: objects to which the arguments point, kept alive here.
    """

    function: Any
    arguments: tuple[Any, ...]
    packed: FloatArray
    info: _Info
    kept: tuple[Any, ...]

    def take(self) -> int:
        """Take a step, and return the number of its status."""
        return int(self.function(*self.arguments))

    @property
    def done(self) -> bool:
        """Whether the last step was taken."""
        return MOTION_STATUSES[self.info.status] is MotionStatus.DONE


class CompiledMotion(LoadedLibrary):
    """Functions beyond statics of a folder that was exported with ``dynamics=True``.

    Parameters are given by name or stacked, by default those of the scene. They may change from one step to the next.
    Members raise an AttributeError if the folder was exported without dynamics.
    """

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of unknowns."""

    def step_memory(self) -> StepMemory:
        """Make the memory of the steps of one motion; each motion needs a new one."""
        return StepMemory(room(self._motion_function("step_memory_size")()), self._workspace())

    def contact_start(self) -> StepState:
        """Return the start of the scene's motion at rest, at the scene's inputs, with its exact contacts.

        Raises:
            AttributeError: the folder has no motions, or nothing in it touches exactly.
        """
        state = np.zeros(3 * self.size)
        self._motion_function("start")(pointer(state))
        return self._unpacked(state)

    def step_contacts(self, memory: StepMemory) -> list[StepContact]:
        """Return the contacts that press at the end of the last step.

        Args:
            memory: memory of the steps.

        Raises:
            AttributeError: the folder has no motions, or nothing in it touches exactly.
        """
        function = self._motion_function("step_contacts")
        described = self.manifest["motion"]
        pairs = described["contacts"]
        of_rods = any("other_rod" in pair for pair in pairs)
        record = _contact_record(of_rods=of_rods, rubs=described.get("contacts_rub", False))
        in_c = (record * described["most_contacts"])()
        count = function(memory.kept, in_c)
        found = []
        for own in in_c[:count]:
            pair = pairs[own.pair]
            owner, touched = (pair[word] for word in pair)
            friction = np.array(getattr(own, "friction", (0.0, 0.0, 0.0)))
            slips = bool(getattr(own, "slips", True))
            at_other = own.other_place if "other_rod" in pair else None
            found.append(StepContact(owner, touched, "body" in pair, own.place, own.force, friction, slips, at_other))
        return found

    def rest(
        self,
        inputs: ArgumentValues = None,
        x: npt.ArrayLike | None = None,
        *,
        parameters: ArgumentValues = None,
    ) -> StepState | None:
        """Make a state at rest; None if supports, joints or cables are not closed there.

        Args:
            inputs: inputs by name or stacked; by default those of the scene.
            x: unknowns, for example of an equilibrium; by default those of the unloaded scene.
            parameters: parameters by name or stacked.
        """
        given = self._given(inputs, parameters)
        start = vector(np.zeros(self.size) if x is None else x, self.size, "x")
        state = np.zeros(3 * self.size)
        status = self._motion_function("rest")(*given, pointer(start), pointer(state), self._workspace())
        return self._unpacked(state) if MOTION_STATUSES[status] is MotionStatus.DONE else None

    def step(
        self,
        state: StepState,
        dt: float,
        inputs: ArgumentValues,
        inputs_rate: npt.ArrayLike | None = None,
        inputs_acceleration: npt.ArrayLike | None = None,
        *,
        parameters: ArgumentValues = None,
        memory: StepMemory | None = None,
        options: StepOptions | None = None,
    ) -> CompiledStep:
        """Take one step of a motion by Radau IIA with two stages.

        Args:
            state: state at the start.
            dt: size of the step, s.
            inputs: inputs at the start, by name or stacked, shape (inputs,).
            inputs_rate: rates of the inputs at the start, shape (inputs,), per s; zero by default.
            inputs_acceleration: accelerations of the inputs in the step, shape (inputs,), per s²; zero by default. The
                step is refused without them if a base, a length or a joint has a rate: inertia forces would be missing.
            parameters: parameters by name or stacked.
            memory: memory of the steps before, from :meth:`step_memory`; it is updated.
            options: budget of Newton's method.
        """
        given = _Given(inputs, inputs_rate, inputs_acceleration, parameters)
        call = self._prepared("step", state, dt, given, memory, options, [])
        call.take()
        return self._end(call)

    def steps(
        self,
        state: StepState,
        dt: float,
        count: int,
        inputs: ArgumentValues,
        inputs_rate: npt.ArrayLike | None = None,
        inputs_acceleration: npt.ArrayLike | None = None,
        *,
        parameters: ArgumentValues = None,
        memory: StepMemory | None = None,
        options: StepOptions | None = None,
    ) -> tuple[CompiledStep, FloatArray, FloatArray]:
        """Take consecutive steps of one size while the inputs move with constant accelerations.

        The result equals that of as many calls of :meth:`step`, which unpack their arguments each time. Inputs and
        rates are taken at the start of the first step.

        Returns:
            the last step, where a failed step ends the sequence; the stacked inputs and their rates at its end.

        Raises:
            ValueError: the count is below 1.
        """
        if count < 1:
            raise ValueError(f"count must be at least 1, got {count}")
        nothing = np.zeros(self.inputs.size)
        rate = vector(nothing if inputs_rate is None else inputs_rate, self.inputs.size, "inputs_rate").copy()
        moved = self.inputs.stacked(inputs).copy()
        # C refuses a base that moves where nobody has said whether it is accelerated.
        given = _Given(moved, rate, inputs_acceleration, parameters)
        call = self._prepared("step", state, dt, given, memory, options, [])
        acceleration = nothing if inputs_acceleration is None else inputs_acceleration
        gained = dt * vector(acceleration, self.inputs.size, "inputs_acceleration")
        for _ in range(count):
            call.take()
            if not call.done:
                break
            # C reads both arrays in place.
            moved += dt * (rate + gained / 2.0)
            rate += gained
        return self._end(call), moved, rate

    def step_sensitivity(
        self,
        state: StepState,
        dt: float,
        inputs: ArgumentValues,
        inputs_rate: npt.ArrayLike | None = None,
        inputs_acceleration: npt.ArrayLike | None = None,
        *,
        parameters: ArgumentValues = None,
        memory: StepMemory | None = None,
        options: StepOptions | None = None,
    ) -> tuple[CompiledStep, StepSensitivity | None]:
        """Take a step as by :meth:`step`, with the exact derivatives of its end; None without them or on a failure."""
        size = 2 * self.size
        by_start = np.zeros((size, size))
        derivatives, columns = self._input_derivatives(size)
        results = [by_start, *columns]
        given = _Given(inputs, inputs_rate, inputs_acceleration, parameters)
        call = self._prepared("step_sensitivity", state, dt, given, memory, options, results)
        status = call.take()
        taken = self._end(call)
        if MOTION_STATUSES[status] is not MotionStatus.DONE:
            return taken, None
        return taken, StepSensitivity(by_start.T, **derivatives)

    def _input_derivatives(self, rows: int) -> tuple[dict[str, FloatArray], list[FloatArray]]:
        """Allocate derivatives by inputs and parameters, by name and as a list in the order of the C functions."""
        words = ("by_inputs", "by_parameters", "by_inputs_rate", "by_inputs_acceleration")
        counts = (self.inputs.size, self.parameters.size, self.inputs.size, self.inputs.size)
        columns = {word: np.zeros((count, rows)) for word, count in zip(words, counts, strict=True)}
        derivatives = {word: by_one.T for word, by_one in columns.items()}
        if not self.parameters.size:
            # A scene without parameters has no derivative with them to be passed.
            del columns["by_parameters"]
        return derivatives, list(columns.values())

    def inverse_dynamics(
        self,
        state: StepState,
        inputs: ArgumentValues,
        inputs_rate: npt.ArrayLike | None = None,
        inputs_acceleration: npt.ArrayLike | None = None,
        *,
        parameters: ArgumentValues = None,
    ) -> FloatArray:
        """Evaluate the residual of the equations of motion, shape (size,): generalised forces that a motion needs."""
        residual = np.zeros(self.size)
        rates = self._changing(inputs_rate), self._changing(inputs_acceleration, "inputs_acceleration")
        given = *self._given(inputs, parameters), *rates
        arguments = [pointer(part) for part in self._parts(state)]
        self._motion_function("inverse_dynamics")(*arguments, *given, pointer(residual), self._workspace())
        return residual

    def linearise(
        self,
        state: StepState,
        inputs: ArgumentValues,
        inputs_rate: npt.ArrayLike | None = None,
        *,
        parameters: ArgumentValues = None,
    ) -> LinearMotion:
        """Linearise the equations of motion at a state."""
        stiffness, damping, mass = (np.zeros((self.size, self.size)) for _ in range(3))
        derivatives, columns = self._input_derivatives(self.size)
        results = [stiffness, damping, mass, *columns]
        given = self._given(inputs, parameters)
        arguments = [pointer(self._packed(state)), *given, self._changing(inputs_rate)]
        self._motion_function("linearise")(*arguments, *map(pointer, results), self._workspace())
        return LinearMotion(stiffness.T, damping.T, mass.T, **derivatives)

    def _prepared(
        self,
        word: str,
        state: StepState,
        dt: float,
        given: _Given,
        memory: StepMemory | None,
        options: StepOptions | None,
        results: Sequence[FloatArray],
    ) -> _StepCall:
        """Prepare a call of one of the two functions in C; inputs and rates that are arrays are read in place."""
        chosen = options or StepOptions()
        inputs = self.inputs.stacked(given.inputs)
        rates = self._changing(given.inputs_rate)
        # It must outlive the call: the struct alone does not keep it.
        acceleration = self._changing(given.inputs_acceleration, "inputs_acceleration")
        budget = _Options(chosen.tolerance, chosen.iterations, chosen.parts, acceleration)
        packed = self._packed(state)
        info = _Info()
        room = memory or self.step_memory()
        arguments = (
            pointer(inputs),
            *self.parameters.passed(given.parameters),
            rates,
            ctypes.c_double(dt),
            pointer(packed),
            room.kept,
            ctypes.byref(budget),
            *map(pointer, results),
            room.workspace,
            ctypes.byref(info),
        )
        return _StepCall(self._motion_function(word), arguments, packed, info, (acceleration,))

    def _end(self, call: _StepCall) -> CompiledStep:
        info = call.info
        return CompiledStep(
            state=self._unpacked(call.packed),
            status=MOTION_STATUSES[info.status],
            iterations=info.iterations,
            jacobians=info.jacobians,
            parts=info.parts,
            residual=info.residual,
            error_left=info.error_left,
        )

    def _changing(self, rates: npt.ArrayLike | None, name: str = "inputs_rate") -> Any:
        """Convert rates or accelerations of the inputs to an argument in C, which is null for zero."""
        return None if rates is None else pointer(vector(rates, self.inputs.size, name))

    def _packed(self, state: StepState) -> FloatArray:
        """Convert a state to its struct in C."""
        return np.concatenate(self._parts(state))

    def _parts(self, state: StepState) -> list[FloatArray]:
        """x, v and a of a state as arrays that lie side by side in memory."""
        return [vector(getattr(state, name), self.size, name) for name in ("x", "v", "a")]

    def _unpacked(self, packed: FloatArray) -> StepState:
        return StepState(*packed.reshape(3, self.size))

    def _motion_function(self, word: str) -> Any:
        try:
            return self._function(word)
        except AttributeError:
            remedy = "export(..., dynamics=True), or cosserat export --dynamics"
            raise AttributeError(f"the library has no motions: {remedy}") from None
