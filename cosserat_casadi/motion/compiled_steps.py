"""Steps of a simulated motion in C: the loop of :mod:`~cosserat_casadi.numerics.time_steps`, compiled for all models.

An iteration in Python takes five to ten times as long as its mathematics. Here C takes many steps in one call; it calls
the equations back, unless they are in machine code themselves.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from cosserat_casadi.compiling.listing import LANES
from cosserat_casadi.compiling.scalar_program import ScalarProgram
from cosserat_casadi.compiling.shared_records import Held, address_of, raise_what_was_raised
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_forces import PushedResidual
from cosserat_casadi.motion.contact_law import compiled_law
from cosserat_casadi.motion.kernel_residual import KernelJacobians, KernelResidual
from cosserat_casadi.motion.repeated_call import MachineCode, RepeatedCall
from cosserat_casadi.motion.steps_library import CALL, StepsRecord, steps_library
from cosserat_casadi.numerics.collocation import STAGES, radau
from cosserat_casadi.numerics.integration import IntegrationCost, StepOutcome
from cosserat_casadi.numerics.motion_equations import Instant, Linearisation
from cosserat_casadi.numerics.step import CarriedStep, StepRows
from cosserat_casadi.numerics.step_control import StepControl
from cosserat_casadi.numerics.step_run import StepRun

ORDERS = 3
"""Number of arguments of inverse dynamics with as many entries as there are unknowns: x, v and a."""

FACTS = 7
"""Numbers of a step beside its state and its stages: the facts of :class:`StepRows`, and the next step size."""

MOST_TRIES = 64
"""Most steps that one call tries; after each call an interrupt by the user is noticed."""

FEW_TRIES = 32
"""Most steps that one call tries while a program may yet be compiled; after each call its cost is weighed again."""

OUTCOMES = (
    None,
    StepOutcome.COMPLETED,
    StepOutcome.STEP_TOO_SMALL,
    StepOutcome.NOT_FINITE,
    StepOutcome.SINGULAR,
    StepOutcome.INTERRUPTED,
)
"""Outcomes by the number that C returns; None means that the motion goes on."""


class CompiledSteps:
    """The steps of one integration, taken in C; the run stores the steps, and the data for the next one.

    Args:
        run: the integration, with controlled steps of Radau's method with three stages.
        control: control of the step sizes.
        shortest: shortest step, s.

    Raises:
        ExportError: there is no compiler, or it fails.
    """

    def __init__(self, run: StepRun, control: StepControl, shortest: float) -> None:
        self._library = steps_library()
        self._run = run
        self._control = control
        self._without_program: RepeatedCall | None = None
        n = run.equations.size
        record = StepsRecord(unknowns=n, stop=run.stop, newton=run.bounds.error, shortest=shortest)
        self._record = record
        self._held = Held(record)
        self._matrices = np.zeros((ORDERS, n, n))
        self._now, self._linearised_at, self._kept_at = np.zeros((3, ORDERS, n))
        self._before = np.zeros((STAGES, n))
        self._rows: list[FloatArray] = []
        self._held.share("matrices", self._matrices)
        self._held.share("now", self._now)
        self._held.share("before", self._before)
        self._held.share("linearised_at", self._linearised_at)
        self._held.share("kept_at", self._kept_at)
        self._held.share("differential", run.equations.differential.astype(np.intc))
        self._held.share("weights", np.ascontiguousarray(run.bounds.weights, dtype=float))
        kinks = np.array(run.equations.kinks, dtype=float)
        record.kink_count = len(kinks)
        self._held.share("kinks", kinks)
        residual = run.equations.residual
        if isinstance(residual, KernelResidual):
            self._share_kernel(residual)
        elif isinstance(residual, PushedResidual) and isinstance(residual.rows, KernelResidual):
            self._share_contacts(residual)
            self._share_kernel(residual.rows)
        else:
            self._share_function()
        if not record.derivatives:
            self._held.call_back("jacobians_at", CALL, self._linearise)
        self._held.share("stage_times", np.zeros(STAGES))
        self._held.share("room", np.zeros(self._library.steps_room(n, record.inputs)))
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

    def _share_kernel(self, residual: KernelResidual) -> None:
        """Have C write the arguments of inverse dynamics in place, and call machine code or else CasADi."""
        record = self._record
        call = residual.call
        names = ("x", "v", "a", "input_values", "input_rates", "input_accelerations")
        # Behind the unknowns of the model C has the forces of contacts.
        state = [np.zeros(record.unknowns) if record.touch_count else array for array in call.arguments[:ORDERS]]
        rows = np.zeros(record.unknowns) if record.touch_count else call.results[0]
        for name, array in zip(names, (*state, *call.arguments[ORDERS:]), strict=True):
            self._held.share(name, array)
        inputs = call.arguments[3:]
        self._held.share("residual", rows)
        record.inputs = len(inputs[0])
        record.moving = int(residual.moves)

        def inputs_at(time: float) -> None:
            for array, values in zip(inputs, residual.inputs_at(time), strict=True):
                array[:] = values

        inputs_at(self._run.start.time)
        if residual.cubics is not None:
            record.cubics_begin, cubics = residual.cubics
            self._held.share("cubics", np.ascontiguousarray(cubics))
        elif residual.moves:
            self._held.call_back("inputs_at", CALL, inputs_at)
        if call.code is None:
            self._held.call_back("residual_at", CALL, partial(_evaluate, call, state, rows))
            self._without_program = None if call.program_after is None else call
            self._share_program(call.program)
            return
        arguments, results = call.code.arguments.copy(), call.code.results.copy()
        arguments[:ORDERS] = [array.ctypes.data for array in state]
        results[0] = rows.ctypes.data
        self._share_code("kernel", call.code, arguments, results)
        if call.at_stages is not None and call.at_stages.code is not None:
            code = call.at_stages.code
            for name, array in zip(names, call.at_stages.arguments, strict=True):
                self._held.share(f"stage_{name}", array)
            self._held.share("stage_results", call.at_stages.results[0])
            self._share_code("at_stages", code, code.arguments, code.results)
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
        self._held.share(f"{name}_arguments", arguments)
        self._held.share(f"{name}_results", results)
        self._held.share(f"{name}_integers", code.integers)
        self._held.share(f"{name}_scratch", code.scratch)

    def _share_program(self, program: ScalarProgram | None) -> None:
        """Have C run a program in place of CasADi's virtual machine, from the next step on."""
        if program is None:
            return
        # Four lanes of each slot: a run of its own, since constants are among them.
        self._held.share("program", program.in_c)
        self._held.share("slots", np.repeat(program.slots, LANES))
        self._record.program_lines, self._record.program_arguments = len(program.lines), program.arguments
        self._without_program = None

    def _share_contacts(self, residual: PushedResidual) -> None:
        """Have C add the contact forces to the equations."""
        contacts = residual.in_law()
        self._held.point("contacts", contacts)
        self._record.touch_count = len(residual.follower.touches)
        self._record.push = address_of(compiled_law().push_in_steps)

    def _share_function(self) -> None:
        """Have C call the equations back as a Python function."""
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

        self._held.call_back("residual_at", CALL, residual_at)
        self._held.call_back("residual_of_stages", CALL, residual_of_stages)
        for name, array in zip(("x", "v", "a", "residual"), (x, v, a, result), strict=True):
            self._held.share(name, array)
        of_stages = {"stage_x": stage_x, "stage_v": stage_v, "stage_a": stage_a, "stage_results": stage_results}
        for name, array in of_stages.items():
            self._held.share(name, array)

    def _linearise(self, time: float) -> None:
        x, v, a = self._linearised_at.copy()
        self._remember(self._run.equations.linearised(Instant(time, x, v, a)))

    def _remember(self, linear: Linearisation) -> None:
        # C has matrices column after column.
        for held, matrix in zip(self._matrices, (linear.stiffness, linear.damping, linear.mass), strict=True):
            held[:] = matrix.T

    def take(self, one: bool) -> tuple[StepOutcome | None, list[float]]:
        """Take one step, or many, and append them to the rows of the run.

        Returns:
            the outcome of the motion, None if it goes on; and the start time of each step that was tried, s.
        """
        run, record, control = self._run, self._record, self._control
        n = run.equations.size
        tries = MOST_TRIES if self._without_program is None else FEW_TRIES
        record.most_steps, record.most_tries = 1 if one else tries, tries
        if not self._rows:
            most = 1 if one else MOST_TRIES
            shapes = {"facts": (most, FACTS), "ends": (most, ORDERS, n), "stages": (most, STAGES, n)}
            for name, shape in {**shapes, "tried_at": (MOST_TRIES,)}.items():
                self._rows.append(np.zeros(shape))
                self._held.share(name, self._rows[-1])
        now = run.now
        self._now[:] = now.x, now.v, now.a
        record.time = now.time
        record.wanted, record.refused = control.wanted, control.refused
        record.last_size, record.last_error = control.last_size, control.last_error
        counted = record.rejected, record.iterations, record.jacobians, record.factorisations
        outcome = OUTCOMES[self._library.steps_taken(ctypes.byref(record))]
        control.wanted, control.refused = record.wanted, bool(record.refused)
        control.last_size, control.last_error = record.last_size, record.last_error
        run.cost += IntegrationCost(
            rejected=record.rejected - counted[0],
            iterations=record.iterations - counted[1],
            jacobians=record.jacobians - counted[2],
            factorisations=record.factorisations - counted[3],
        )
        run.size = record.size
        *taken, tried = self._rows
        if record.steps:
            self._taken(now, one, *(array[: record.steps].copy() for array in taken))
        raise_what_was_raised()
        call = self._without_program
        if outcome is None and call is not None and call.program_after is not None:
            call.program = call.program_after(record.iterations)
            self._share_program(call.program)
        return outcome, tried[: record.tries].tolist()

    def _taken(self, now: Instant, one: bool, facts: FloatArray, ends: FloatArray, unknowns: FloatArray) -> None:
        """Append the new steps to the run, and store the data for the next step."""
        run, record = self._run, self._record
        states = np.concatenate([[[now.x, now.v, now.a]], ends])
        facts = np.column_stack([np.append(now.time, facts[:-1, 0]), facts])
        rows = StepRows(run.method, run.equations.differential, states[:-1], states[1:], unknowns, facts[:, :-1])
        if one:
            run.add(rows[0])
        else:
            run.rows.append(rows)
        run.longest = record.longest
        run.fresh = bool(record.fresh)
        linearised_at = Instant(record.kept_time, *self._kept_at.copy()) if record.kept else None
        run.linearised_at = linearised_at
        _, _, size, error, *_, wanted = facts[-1].tolist()
        run.memory = CarriedStep(run.begun, size, unknowns[-1], wanted, error, run.longest, linearised_at)
        run.renew_jacobian()
        if linearised_at is not None and run.guards is not None:
            run.linearisation = Linearisation(*(matrix.T.copy() for matrix in self._matrices))


def _evaluate(call: RepeatedCall, state: Sequence[FloatArray], rows: FloatArray, _: float) -> None:
    """Have CasADi's virtual machine write the residual of the model, without the unknowns of contacts."""
    for array, values in zip(call.arguments, state, strict=False):
        if array is not values:
            array[:] = values[: len(array)]
    call.evaluate()
    if rows is not call.results[0]:
        rows[: len(call.results[0])] = call.results[0][:, 0]
