"""Steps of a simulated motion in C: the loop of :mod:`~cosserat_casadi.numerics.time_steps`, compiled for all models.

An iteration in Python takes five to ten times as long as its mathematics. Here C takes many steps in one call; it calls
the equations back, unless they are in machine code themselves.
"""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Callable, Sequence
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.motion_sources import initialiser, method_words, pairs
from cosserat_casadi.compiling.compiler import compiled_from, compiled_texts, find_compiler
from cosserat_casadi.compiling.scalar_program import cases_in_c
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_forces import PushedResidual
from cosserat_casadi.motion.contact_law import address_of, raise_what_was_raised
from cosserat_casadi.motion.kernel_residual import KernelJacobians, KernelResidual
from cosserat_casadi.motion.repeated_call import MachineCode, Program, RepeatedCall
from cosserat_casadi.numerics import stage_newton, step_control, step_matrices, step_run, time_steps
from cosserat_casadi.numerics.collocation import STAGES, radau
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.numerics.motion_equations import Instant, Linearisation
from cosserat_casadi.numerics.step import CarriedStep, TimeStep
from cosserat_casadi.numerics.step_control import StepControl
from cosserat_casadi.numerics.step_run import StepRun

NAME = "controlled_steps"
"""Of the library in the cache."""

LANES = 4
"""Lanes of a slot of a program: a stage each, and one more."""

ORDERS = 3
"""Arguments of inverse dynamics that are as many as its unknowns: x, v, a."""

FACTS = 7
"""Numbers of a step beside its state and its stages."""

MOST_TRIES = 64
"""Steps that are tried in one call: then an interrupt is seen."""

FEW_TRIES = 32
"""The same while a program may yet be written: then its cost is weighed again."""

OUTCOMES = (
    None,
    StepOutcome.COMPLETED,
    StepOutcome.STEP_TOO_SMALL,
    StepOutcome.NOT_FINITE,
    StepOutcome.SINGULAR,
    StepOutcome.INTERRUPTED,
)
"""Outcomes by the numbers that C returns; None where it would go on."""

POINTER = ctypes.c_void_p
CALL = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double)


class _Record(ctypes.Structure):
    """The record of ``controlled_steps.c``."""

    _fields_ = [
        *((name, ctypes.c_int) for name in ("unknowns", "touch_count", "inputs", "moving")),
        *((name, ctypes.c_int) for name in ("kink_count", "most_steps", "most_tries")),
        *((name, POINTER) for name in ("differential", "weights", "kinks", "x", "v", "a")),
        *((name, POINTER) for name in ("input_values", "input_rates", "input_accelerations", "residual")),
        *((name, POINTER) for name in ("kernel", "kernel_arguments", "kernel_results")),
        *((name, POINTER) for name in ("kernel_integers", "kernel_scratch")),
        *((name, POINTER) for name in ("derivatives", "derivatives_arguments", "derivatives_results")),
        *((name, POINTER) for name in ("derivatives_integers", "derivatives_scratch", "cubics", "program", "slots")),
        *((name, ctypes.c_int) for name in ("program_lines", "program_arguments")),
        *((name, POINTER) for name in ("push", "contacts")),
        *((name, CALL) for name in ("residual_at", "residual_of_stages", "inputs_at", "jacobians_at")),
        *((name, POINTER) for name in ("stage_times", "stage_x", "stage_v", "stage_a", "stage_results")),
        *((name, POINTER) for name in ("matrices", "linearised_at", "kept_at", "now", "before", "room")),
        *((name, POINTER) for name in ("facts", "ends", "stages", "tried_at")),
        *(
            (name, ctypes.c_double)
            for name in ("cubics_begin", "stop", "newton", "lasting", "drifting", "longest_allowed", "shortest", "time")
        ),
        *((name, ctypes.c_double) for name in ("linearised_time", "kept_time", "before_size", "longest", "wanted")),
        *((name, ctypes.c_double) for name in ("size", "last_size", "last_error", "factorised")),
        *((name, ctypes.c_int) for name in ("refused", "linearised", "kept", "fresh", "singular_steps", "reason")),
        *((name, ctypes.c_int) for name in ("steps", "tries", "rejected", "iterations", "jacobians")),
        *((name, ctypes.c_int) for name in ("factorisations", "interrupted")),
        *((name, POINTER) for name in ("inverses", "stage_inputs", "iterate", "stage_residuals")),
        *((name, POINTER) for name in ("stage_corrections", "stage_changes", "transformed", "solutions", "vectors")),
        *((name, POINTER * step_control.MOST_ITERATIONS) for name in ("taken", "duals")),
    ]


@lru_cache(maxsize=1)
def steps_library() -> ctypes.CDLL:
    """The compiled loop.

    Raises:
        ExportError: there is no compiler, or it fails.
    """
    path = compiled_texts(NAME, _texts(), find_compiler(), included={"stage_newton.c"}, origin=_origin())
    library = ctypes.CDLL(str(path))
    assert library.steps_record() == ctypes.sizeof(_Record), "the record differs from that of the C"
    library.steps_taken.argtypes = [ctypes.POINTER(_Record)]
    return library


def steps_are_at_hand() -> bool:
    """Whether the loop was compiled before: in this process, or in the cache.

    Raises:
        ExportError: there is no compiler.
    """
    if steps_are_loaded():
        return True
    return compiled_from(NAME, _origin(), find_compiler()) is not None


def steps_are_loaded() -> bool:
    """Whether this process has the loop."""
    return bool(steps_library.cache_info().currsize)


@cache
def _origin() -> str:
    """Key of the sources."""
    return hashlib.sha256("\0".join(_texts().values()).encode()).hexdigest()


def stem_of_steps() -> str:
    """Name of the tally of the time that went without the loop."""
    return f"{NAME}-{_origin()[:20]}"


@cache
def _texts() -> dict[str, str]:
    """The sources by file name."""
    return {
        f"{NAME}.c": resource("c", f"{NAME}.c"),
        "stage_newton.c": resource("c", "stage_newton.c"),
        "fours.h": resource("c", "fours.h"),
        f"{NAME}.h": render(f"{NAME}.h.in", _words()),
    }


def _words() -> dict[str, Any]:
    """Constants of the C, from the modules that it follows."""
    method = radau(STAGES)
    whole, pair = complex(method.eigenvalues[0]), complex(method.eigenvalues[1])
    arrays = {
        "start_values": method.values_at(0.0),
        "start_integrals": method.values_at(0.0) @ method.matrix,
        "end_values": method.values_at(1.0),
        "end_integrals": method.weights,
        "end_double_integrals": method.position_weights,
        "pair_rate": pairs([1.0 / pair])[0],
        "pair_share": pairs([1.0 / pair**2])[0],
        "to_real": method.to_eigenvectors[0].real,
        "to_pair": pairs(method.to_eigenvectors[1]),
        "from_real": method.from_eigenvectors[:, 0].real,
        "from_pair": pairs(method.from_eigenvectors[:, 1]),
    }
    return {
        "operations": cases_in_c(),
        "iterations": step_control.MOST_ITERATIONS,
        "few_iterations": step_run.FEW_ITERATIONS,
        "singular_steps": time_steps.SINGULAR_STEPS,
        "stage_rounding": repr(stage_newton.ROUNDING),
        "singular": step_matrices.SINGULAR,
        "least_contraction": stage_newton.LEAST_CONTRACTION,
        "diverging": stage_newton.DIVERGING,
        "safety": step_control.SAFETY,
        "growth": step_control.GROWTH,
        "shrinkage": step_control.SHRINKAGE,
        "first_shrinkage": step_control.FIRST_SHRINKAGE,
        "failed_shrinkage": time_steps.FAILED_SHRINKAGE,
        "singular_shrinkage": time_steps.SINGULAR_SHRINKAGE,
        "worth_growing": step_control.WORTH_GROWING,
        "worth_shrinking": step_control.WORTH_SHRINKING,
        "smallest_error": step_control.SMALLEST_ERROR,
        "remembered_error": step_control.REMEMBERED_ERROR,
        "most_lasting": step_run.MOST_LASTING,
        "real_rate": repr(1.0 / whole.real),
        **method_words(method, "double"),
        **{name: initialiser(values, "double") for name, values in arrays.items()},
    }


class CompiledSteps:
    """The steps of one integration, taken by C; its run has them, and the memory for a next step.

    Args:
        run: the integration, whose steps are controlled and of Radau's method with three stages.
        control: of the sizes of its steps.
        shortest: step, s.

    Raises:
        ExportError: there is no compiler, or it fails.
    """

    def __init__(self, run: StepRun, control: StepControl, shortest: float) -> None:
        self._library = steps_library()
        self._run = run
        self._control = control
        self._raised: BaseException | None = None
        self._without_program: RepeatedCall | None = None
        n = run.equations.size
        self._matrices = np.zeros((3, n, n))
        self._now, self._linearised_at, self._kept_at = np.zeros((3, 3, n))
        self._before = np.zeros((STAGES, n))
        self._record = _Record(unknowns=n, stop=run.stop, newton=run.bounds.error, shortest=shortest)
        # Arrays and functions that the record points at.
        self._held: list[Any] = []
        record = self._record
        record.jacobians_at = self._called(self._linearise)
        self._share("differential", run.equations.differential.astype(np.intc))
        self._share("weights", np.ascontiguousarray(run.bounds.weights, dtype=float))
        self._share("matrices", self._matrices)
        self._share("now", self._now)
        self._share("before", self._before)
        self._share("linearised_at", self._linearised_at)
        self._share("kept_at", self._kept_at)
        kinks = np.array(run.equations.kinks, dtype=float)
        record.kink_count = len(kinks)
        self._share("kinks", kinks)
        residual = run.equations.residual
        if isinstance(residual, KernelResidual):
            self._share_kernel(residual)
        elif isinstance(residual, PushedResidual) and isinstance(residual.rows, KernelResidual):
            self._share_contacts(residual)
            self._share_kernel(residual.rows)
        else:
            self._share_function()
        self._share("stage_times", np.zeros(STAGES))
        self._share("room", np.zeros(self._library.steps_room(n, record.inputs)))
        record.lasting = run.settings.lasting
        record.drifting = run.settings.drifting
        record.longest_allowed = control.longest
        record.reason = OUTCOMES.index(StepOutcome.STEP_TOO_SMALL)
        if run.memory is not None:
            self._before[:] = run.memory.unknowns
            record.before_size = run.memory.size
            record.longest = run.memory.longest
        if run.linearised_at is not None and run.linearisation is not None:
            self._linearised_at[:] = run.linearised_at.x, run.linearised_at.v, run.linearised_at.a
            record.linearised_time = run.linearised_at.time
            self._remember(run.linearisation)
            record.linearised = 1

    def _share(self, name: str, array: np.ndarray[Any, Any]) -> None:
        self._held.append(array)
        setattr(self._record, name, array.ctypes.data)

    def _called(self, function: Callable[[float], None]) -> Any:
        """A function as C calls it; an exception of it is raised when C has returned."""

        def guarded(time: float) -> int:
            try:
                function(time)
            except BaseException as raised:
                self._raised = raised
                return 1
            return 0

        wrapped = CALL(guarded)
        self._held.append(wrapped)
        return wrapped

    def _share_kernel(self, residual: KernelResidual) -> None:
        """Have C write the arguments of inverse dynamics in place, and call it, or CasADi's virtual machine."""
        record = self._record
        call = residual.call
        names = ("x", "v", "a", "input_values", "input_rates", "input_accelerations")
        # Behind the unknowns of the model C has the forces of contacts.
        state = [np.zeros(record.unknowns) if record.touch_count else array for array in call.arguments[:ORDERS]]
        rows = np.zeros(record.unknowns) if record.touch_count else call.results[0]
        for name, array in zip(names, (*state, *call.arguments[ORDERS:]), strict=True):
            self._share(name, array)
        inputs = call.arguments[3:]
        self._share("residual", rows)
        record.inputs = len(inputs[0])
        record.moving = int(residual.moves)

        def inputs_at(time: float) -> None:
            for array, values in zip(inputs, residual.inputs_at(time), strict=True):
                array[:] = values

        inputs_at(self._run.start.time)
        record.inputs_at = self._called(inputs_at)
        if residual.cubics is not None:
            record.cubics_begin, cubics = residual.cubics
            self._share("cubics", np.ascontiguousarray(cubics))
        if call.code is None:
            record.residual_at = self._called(partial(_evaluate, call, state, rows))
            self._without_program = None if call.program_after is None else call
            self._share_program(call.program)
            return
        arguments, results = call.code.arguments.copy(), call.code.results.copy()
        arguments[:ORDERS] = [array.ctypes.data for array in state]
        results[0] = rows.ctypes.data
        self._share_code("kernel", call.code, arguments, results)
        jacobians = self._run.equations.jacobians
        if isinstance(jacobians, KernelJacobians) and jacobians.call.code is not None:
            code = jacobians.call.code
            read, written = code.arguments.copy(), code.results.copy()
            read[: len(names)] = [array.ctypes.data for array in (*self._linearised_at, *inputs)]
            written[: len(self._matrices)] = [matrix.ctypes.data for matrix in self._matrices]
            self._share_code("derivatives", code, read, written)

    def _share_code(
        self, name: str, code: MachineCode, arguments: npt.NDArray[np.uintp], results: npt.NDArray[np.uintp]
    ) -> None:
        """Have C call a function in machine code with these addresses of arguments and results."""
        setattr(self._record, name, code.address)
        self._share(f"{name}_arguments", arguments)
        self._share(f"{name}_results", results)
        self._share(f"{name}_integers", code.integers)
        self._share(f"{name}_scratch", code.scratch)

    def _share_program(self, program: Program | None) -> None:
        """Have C run a program in place of CasADi's virtual machine, from the next step on."""
        if program is None:
            return
        lines, slots, arguments = program
        # Four lanes of each slot: a run of its own, since constants are among them.
        self._share("program", lines)
        self._share("slots", np.repeat(slots, LANES))
        self._record.program_lines, self._record.program_arguments = len(lines), arguments
        self._without_program = None

    def _share_contacts(self, residual: PushedResidual) -> None:
        """Have C take the forces of contacts from the equations."""
        contacts = residual.in_law()
        self._held.append(contacts)
        record = self._record
        record.touch_count = len(residual.follower.touches)
        record.push, record.contacts = address_of("push_in_steps"), contacts.address

    def _share_function(self) -> None:
        """Have C call the equations as a function of Python."""
        equations = self._run.equations
        n = equations.size
        x, v, a, result = np.zeros((4, n))
        stage_x, stage_v, stage_a, stage_results = np.zeros((4, STAGES, n))
        times = radau(STAGES).nodes

        def residual_at(time: float) -> None:
            result[:] = equations.residual_at(Instant(time, x.copy(), v.copy(), a.copy()))

        def residual_of_stages(begin: float) -> None:
            at = begin + times * self._record.size
            stage_results[:] = equations.residual_of_stages(at, stage_x.copy(), stage_v.copy(), stage_a.copy())

        self._record.residual_at = self._called(residual_at)
        self._record.residual_of_stages = self._called(residual_of_stages)
        for name, array in zip(("x", "v", "a", "residual"), (x, v, a, result), strict=True):
            self._share(name, array)
        of_stages = {"stage_x": stage_x, "stage_v": stage_v, "stage_a": stage_a, "stage_results": stage_results}
        for name, array in of_stages.items():
            self._share(name, array)

    def _linearise(self, time: float) -> None:
        x, v, a = self._linearised_at.copy()
        self._remember(self._run.equations.linearised(Instant(time, x, v, a)))

    def _remember(self, linear: Linearisation) -> None:
        # C has matrices column after column.
        for held, matrix in zip(self._matrices, (linear.stiffness, linear.damping, linear.mass), strict=True):
            held[:] = matrix.T

    def take(self, most: int) -> tuple[StepOutcome | None, list[float]]:
        """Take steps, at most so many.

        Returns:
            how the motion ends, None where it goes on; and the time before each step that was tried, s.
        """
        run, record, control = self._run, self._record, self._control
        n = run.equations.size
        tries = MOST_TRIES if self._without_program is None else FEW_TRIES
        most = min(most, tries)
        facts = np.zeros((most, FACTS))
        ends = np.zeros((most, 3, n))
        stages = np.zeros((most, STAGES, n))
        tried = np.zeros(MOST_TRIES)
        for name, array in (("facts", facts), ("ends", ends), ("stages", stages), ("tried_at", tried)):
            setattr(record, name, array.ctypes.data)
        now = run.now
        self._now[:] = now.x, now.v, now.a
        record.time = now.time
        record.most_steps, record.most_tries = most, tries
        record.wanted, record.refused = control.wanted, control.refused
        record.last_size, record.last_error = control.last_size, control.last_error
        counted = record.rejected, record.iterations, record.jacobians, record.factorisations
        outcome = OUTCOMES[self._library.steps_taken(ctypes.byref(record))]
        control.wanted, control.refused = record.wanted, bool(record.refused)
        control.last_size, control.last_error = record.last_size, record.last_error
        run.rejected += record.rejected - counted[0]
        run.iterations += record.iterations - counted[1]
        run.jacobians += record.jacobians - counted[2]
        run.factorisations += record.factorisations - counted[3]
        run.size = record.size
        self._taken(facts[: record.steps], ends, stages)
        if self._raised is not None:
            raise self._raised
        raise_what_was_raised()
        call = self._without_program
        if outcome is None and call is not None and call.program_after is not None:
            call.program = call.program_after(record.iterations)
            self._share_program(call.program)
        return outcome, tried[: record.tries].tolist()

    def _taken(self, facts: FloatArray, ends: FloatArray, stages: FloatArray) -> None:
        """Give the run its new steps, and the memory for a next one."""
        run, record = self._run, self._record
        now = run.now
        method, differential = run.method, run.equations.differential
        # A motion has thousands of steps: rows are taken apart all at once.
        rows = zip(facts.tolist(), ends[:, 0], ends[:, 1], ends[:, 2], stages, strict=False)
        for fact, x, v, a, unknowns in rows:
            time, size, error, iterations, residual, contraction, wanted = fact
            step = TimeStep(
                method=method,
                differential=differential,
                start=now,
                size=size,
                unknowns=unknowns,
                end=Instant(time, x, v, a),
                error=error,
                iterations=int(iterations),
                residual=residual,
                contraction=contraction,
            )
            run.add(step)
            now = run.steps[-1].end
        if not len(facts):
            return
        run.longest = record.longest
        run.fresh = bool(record.fresh)
        linearised_at = Instant(record.kept_time, *self._kept_at.copy()) if record.kept else None
        run.linearised_at = linearised_at
        run.memory = CarriedStep(run.begun, size, unknowns, wanted, error, run.longest, linearised_at)
        run.renew_jacobian()
        if linearised_at is not None and run.guards is not None:
            run.linearisation = Linearisation(*(matrix.T.copy() for matrix in self._matrices))


def _evaluate(call: RepeatedCall, state: Sequence[FloatArray], rows: FloatArray, _: float) -> None:
    """Have CasADi's virtual machine write the residual, of the unknowns of the model without those of contacts."""
    for array, values in zip(call.arguments, state, strict=False):
        if array is not values:
            array[:] = values[: len(array)]
    call.evaluate()
    if rows is not call.results[0]:
        rows[: len(call.results[0])] = call.results[0][:, 0]
