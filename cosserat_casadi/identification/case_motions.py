"""Motions of cases that were measured over time, by the steps of the simulator, with exact sensitivities.

The steps have one size, so that the path is a smooth function of the unknowns. A step solves F = 0 at its stages. With
U, their accelerations and multipliers, and G = ∂F/∂U, dU = −G⁻¹ (F_x dx + F_v dv + F_inputs d inputs + F_p dp), and
the end of the step and its polynomial are linear in x, v and U. These are derivatives of the computed path, not of the
solution of the equations of motion (E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*,
2nd ed., Springer 1993, section I.14).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers
from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.identification.case_equilibria import split
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.contact_checks import told_passage
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.history import History, integrated
from cosserat_casadi.motion.motion_checks import immovable
from cosserat_casadi.motion.moving_inputs import MovingInputs
from cosserat_casadi.motion.one_sided import OneSided
from cosserat_casadi.motion.simulate import EXACT
from cosserat_casadi.numerics.collocation import STAGES, Collocation, radau
from cosserat_casadi.numerics.integration import StepSettings
from cosserat_casadi.numerics.step import StepPolynomial, TimeStep
from cosserat_casadi.tubes.tube_functions import AnyModel

FIRST_STEPS = 16
"""First number of steps of the longest motion; steps are halved until their error is small enough."""

COARSE = 1e-2
"""Error of a step, over the length, in the motion that determines the size of the first steps."""

Flags = npt.NDArray[np.bool_]


class StartInputs:
    """The inputs at the start of a motion: the inputs of the case, plus the motions of inputs at time 0.

    Attributes:
        held: mask of the inputs without a table over time, for which the values of the case count, shape (inputs,).
    """

    def __init__(self, model: AnyModel) -> None:
        motions = model.scene.motions if model.scene.measured_over_time else ()
        self.held: Flags = np.ones(model.inputs.size, dtype=bool)
        for motion in motions:
            if motion.is_table:
                self.held[model.inputs.slices[motion.input]] = False
        self.added = MovingInputs(model.inputs, motions, np.zeros(model.inputs.size)).at(0.0).value
        """Values that motions add to the inputs at time 0, shape (inputs,)."""

    def of(self, inputs: FloatArray, moves: Flags) -> FloatArray:
        """Inputs of all cases at the start of their motions, shape (cases, inputs).

        Args:
            inputs: inputs of all cases, shape (cases, inputs).
            moves: mask of the cases that are motions, shape (cases,).
        """
        started = np.where(self.held, inputs, 0.0) + self.added
        return np.where(moves[:, None], started, inputs)


def check_motions(model: Model) -> None:
    """Refuse motions whose path is not a smooth function of the unknowns, and scenes without motions.

    Raises:
        SceneError: the scene has such problems; the error lists all of them.
    """
    problems = immovable(model.at())
    if model.scene.velocities:
        remedy = "leave them out, and let a load or a base that [[motions]] move set the rods in motion"
        problems.append(Problem("velocities", "what is measured over time begins at rest", remedy))
    for index, rod in enumerate(model.scene.rods):
        if rod.base.free:
            remedy = "hold the base, or move it by a motion of its position"
            problems.append(Problem(f"rods[{index}].base.free", "is not for measurements over time", remedy))
    for pair in OneSided(model.at()).pairs:
        problem = f"{pair.name!r} may go slack, or stop, in a motion, and the path is not smooth there"
        remedy = "give a tension over time in place of a length; leave stops out"
        problems.append(Problem("joints" if pair.side else "actuators", problem, remedy))
    refuse(problems)


@dataclass(frozen=True)
class Run:
    """A motion of one case at the times at which it was measured.

    Attributes:
        times: times, ascending, shape (T,), s.
        x: unknowns, shape (T, size).
        inputs: inputs, shape (T, inputs).
        history: the steps; None if all times are the start.
        p: parameters.
    """

    times: FloatArray
    x: FloatArray
    inputs: FloatArray
    history: History | None
    p: FloatArray


class Motions:
    """The motions of a model.

    Attributes:
        model: model with its parameters, and with flows as unknowns if stress relaxes; of rods if there are times.
        unknowns: number of unknowns of an equilibrium.
        start: inputs at the start.
        times: times at which each case was measured, by index of the case, ascending, s.
        size: size of the steps, s.
    """

    def __init__(self, model: Any, times: Mapping[int, FloatArray]) -> None:
        self.model = model.in_motion if isinstance(model, Model) else model
        self.unknowns = model.size
        self.start = StartInputs(model)
        self.times = times
        simulation = model.scene.simulation
        longest = max((float(of_case[-1]) for of_case in times.values()), default=0.0)
        self.size = longest / FIRST_STEPS
        if simulation is not None and simulation.step is not None:
            self.size = simulation.step
        self._sensitivities: dict[tuple[int, int], ca.Function] = {}

    @cached_property
    def _method(self) -> Collocation:
        return radau(STAGES)

    @cached_property
    def _newton(self) -> FloatArray:
        """Allowed error of Newton's method in each unknown, shape (size,)."""
        return EXACT / displacements(self.model.at())

    def run(self, case: int, x: FloatArray, inputs: FloatArray, p: FloatArray) -> Run | None:
        """Compute the motion of a case; None if its steps cannot be solved.

        Args:
            case: its number.
            x: unknowns at the start, shape (size,).
            inputs: at the start, shape (inputs,).
            p: parameters.

        Raises:
            SceneError: the start contradicts the constraints.
        """
        times = self.times[case]
        end = float(times[-1])
        if end == 0.0:
            return Run(times, x[None, :], inputs[None, :], None, p)
        settings = StepSettings(tolerance=self._newton, size=self.size, newton=1.0)
        history = self._integrated(x, inputs, p, end, settings)
        if not history.completed:
            return None
        path, inputs_over_time = history.rough_positions(times)
        return Run(times, path[:, : self.unknowns], inputs_over_time, history, p)

    def suggest_size(self, case: int, x: FloatArray, inputs: FloatArray, p: FloatArray) -> None:
        """Set the step size to the mean step of a motion that is integrated to a coarse tolerance."""
        end = float(self.times[case][-1])
        if end == 0.0:
            return
        settings = StepSettings(tolerance=COARSE / displacements(self.model.at()))
        history = self._integrated(x, inputs, p, end, settings)
        if history.completed:
            self.size = min(self.size, end / len(history.steps))

    def _integrated(
        self, x: FloatArray, inputs: FloatArray, p: FloatArray, end: float, settings: StepSettings
    ) -> History:
        moving = MovingInputs(self.model.inputs, self.model.scene.motions, inputs - self.start.added)
        still = np.zeros(self.model.size)
        start = np.concatenate([x, still[self.unknowns :]])
        parameters = p if self.model.parameters.size else None
        return integrated(self.model, moving.pieces(end), start, still, self._method, settings, p=parameters)

    def told_passage(self, run: Run) -> str:
        """Sentence on rods or bodies that pass through smooth obstacles or rods in a motion; empty if none does."""
        if run.history is None or not SmoothBarriers(self.model).any:
            return ""
        return told_passage(run.history, float(run.times[-1]), self.model.at(run.p))

    def sensitivity(self, run: Run, x: FloatArray, inputs: FloatArray, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Derivatives of unknowns and inputs at the measured times, shapes (T, size, m) and (inputs, m).

        Args:
            run: the motion.
            x: derivatives of the start by m numbers, shape (size, m).
            inputs: derivatives of the inputs of the case, shape (inputs, m).
            p: derivatives of the parameters, shape (parameters, m).
        """
        by_inputs = inputs * self.start.held[:, None]
        differential = self.model.discrete.unknowns.differential
        if run.history is None:
            return x[None], by_inputs
        propagated = self._stage_responses(run, by_inputs, p)
        method = self._method
        at_rest = np.zeros((self.model.size - self.unknowns, x.shape[1]))
        position = np.where(differential[:, None], np.vstack([x, at_rest]), 0.0)
        velocity = np.zeros_like(position)
        moved = np.empty((len(run.times), *position.shape))
        numbers = np.array([run.history.number_at(float(time)) for time in run.times])
        for number, ((_, step), response) in enumerate(zip(run.history.steps, propagated, strict=True)):
            by_position, by_velocity, direct = np.split(response, [self.model.size, 2 * self.model.size], axis=2)
            stages = by_position @ position + by_velocity @ velocity + direct
            accelerations = np.where(differential[:, None], stages, 0.0)
            for row in np.flatnonzero(numbers == number):
                share = (run.times[row] - step.start.time) / step.size
                curved = np.tensordot(method.double_integrals_at(share), accelerations, 1)
                straight = position + share * step.size * velocity
                values = np.tensordot(method.values_at(share), stages, 1)
                moved[row] = np.where(differential[:, None], straight + step.size**2 * curved, values)
            bent = np.tensordot(method.position_weights, accelerations, 1)
            position = position + step.size * velocity + step.size**2 * bent
            velocity = velocity + step.size * np.tensordot(method.weights, accelerations, 1)
        return moved[:, : self.unknowns], by_inputs

    def _stage_responses(self, run: Run, inputs: FloatArray, p: FloatArray) -> list[FloatArray]:
        """Derivatives of the unknowns of the stages of every step by its start and by the numbers themselves."""
        assert run.history is not None
        steps = run.history.steps
        method = self._method
        count = method.stages
        size = self.model.size
        differential = self.model.discrete.unknowns.differential
        instants = []
        for leg, step in steps:
            stages = StepPolynomial(method, differential, step.start, step.size, step.unknowns).stages
            for i in range(count):
                given = leg.piece.at(float(stages.times[i]))
                instants.append([stages.x[i], stages.v[i], stages.a[i], *given])
        columns = [np.array(column).T for column in zip(*instants, strict=True)]
        shared = [run.p, p] if self.model.parameters.size else []
        results = self._linearised(len(instants), p.shape[1])(*columns, *shared, inputs)
        parts = [split(result, len(instants)).reshape(len(steps), count, size, -1) for result in results]
        return [
            _stage_response(step, method, differential, *(part[k] for part in parts))
            for k, (_, step) in enumerate(steps)
        ]

    def _linearised(self, count: int, numbers: int) -> ca.Function:
        """Make (x, v, a, inputs, their rates and accelerations, p, p by numbers, inputs by numbers) ↦ derivatives of F.

        The derivatives are by x, v, a, and by the numbers that determine inputs and parameters, at ``count`` instants.
        """
        key = (count, numbers)
        if key in self._sensitivities:
            return self._sensitivities[key]
        model = self.model
        size = model.size
        moving = [ca.MX.sym(name, size) for name in "xva"]
        given = [ca.MX.sym(name, model.inputs.size) for name in ("inputs", "rate", "acceleration")]
        by_inputs = ca.MX.sym("by_inputs", model.inputs.size, numbers)
        between = []
        shared = [by_inputs]
        by_p = None
        if model.parameters.size:
            between = [ca.MX.sym("p", model.parameters.size)]
            by_p = ca.MX.sym("by_p", model.parameters.size, numbers)
            shared = [*between, by_p, by_inputs]
        arguments = [*moving, given[0], *between, *given[1:]]
        stiffness, damping, mass, _ = model.dynamics_jacobian(*arguments)
        residual = model.inverse_dynamics(*arguments)
        change = ca.jtimes(residual, given[0], by_inputs)
        if by_p is not None:
            change += ca.jtimes(residual, between[0], by_p)
        results = [ca.densify(matrix) for matrix in (stiffness, damping, mass, change)]
        one = ca.Function("linearised", [*moving, *given, *shared], results)
        first = len(moving) + len(given)
        function = one.map("all", "serial", count, list(range(first, first + len(shared))), [])
        self._sensitivities[key] = function
        return function


def _stage_response(
    step: TimeStep,
    method: Collocation,
    differential: Flags,
    stiffness: FloatArray,
    damping: FloatArray,
    mass: FloatArray,
    change: FloatArray,
) -> FloatArray:
    """Derivatives of the unknowns of the stages of a step by x and v at its start and by m numbers.

    The linear equations of the stages are solved for them.

    Args:
        step: the step.
        method: the collocation method.
        differential: mask of the entries with accelerations, shape (n,).
        stiffness: ∂F/∂x at each stage, shape (s, n, n).
        damping: ∂F/∂v at each stage, shape (s, n, n).
        mass: ∂F/∂a at each stage, shape (s, n, n).
        change: derivatives of F by the numbers, through inputs and parameters, shape (s, n, m).

    Returns:
        the derivatives side by side, shape (s, n, 2 n + m).
    """
    count, size, _ = stiffness.shape
    h = step.size
    matrix = np.zeros((count, size, count, size))
    for i in range(count):
        for j in range(count):
            coupled = h**2 * method.matrix_squared[i, j] * stiffness[i] + h * method.matrix[i, j] * damping[i]
            matrix[i, :, j] = np.where(differential, coupled, 0.0)
        matrix[i, :, i] += np.where(differential, mass[i], stiffness[i])
    by_position = np.where(differential, stiffness, 0.0)
    by_velocity = np.where(differential, h * method.nodes[:, None, None] * stiffness + damping, 0.0)
    right = np.concatenate([by_position, by_velocity, change], axis=2).reshape(count * size, -1)
    whole = matrix.reshape(count * size, count * size)
    return -np.linalg.solve(whole, right).reshape(count, size, -1)
