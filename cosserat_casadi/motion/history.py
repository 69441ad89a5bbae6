"""Integration of a model in time: its equations over each smooth piece of its inputs, and the sequence of steps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, Protocol, TypeVar

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.centred_coordinates import CentredCoordinates, can_be_centred
from cosserat_casadi.motion.checkpoint import CarriedContacts, Resume
from cosserat_casadi.motion.constraint_projection import Closing
from cosserat_casadi.motion.contact_forces import Follower
from cosserat_casadi.motion.contact_guards import ContactPhase, start_inside
from cosserat_casadi.motion.contact_record import ContactRecord, MotionContact, Stretch
from cosserat_casadi.motion.event_restart import ContactEvent, Restart, Settling
from cosserat_casadi.motion.kernel_residual import KernelJacobians, KernelResidual
from cosserat_casadi.motion.momentum import MomentumKeeper, flies_free, functions_of_momentum
from cosserat_casadi.motion.moving_inputs import Piece
from cosserat_casadi.motion.one_sided import sags_by_cable
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries, RepeatedCall
from cosserat_casadi.motion.sided_contacts import SidedContacts
from cosserat_casadi.motion.step_kernels import StepKernels, interpreted
from cosserat_casadi.motion.step_words import CONSISTENT
from cosserat_casadi.motion.steps_library import positions_at
from cosserat_casadi.motion.time_between_events import time_between_events
from cosserat_casadi.motion.trajectory import MotionState, StepStatistics
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.consistent_start import ConsistentStart
from cosserat_casadi.numerics.guards import Guards
from cosserat_casadi.numerics.integration import AfterStep, Integration, Settle, StepOutcome, StepSettings, stalled_at
from cosserat_casadi.numerics.motion_equations import Instant, Jacobians, MotionEquations
from cosserat_casadi.numerics.step import CarriedStep, HeldTimes, StepRows, TimeStep
from cosserat_casadi.numerics.time_steps import integrate

Known = TypeVar("Known")

DIFFERENTIATED = 0.01
"""Interval of the finite difference of constraints for the multipliers at the start of a piece, over its duration."""

DRIFTING = 1e-2
"""Step, over the piece of the inputs, below which steps are solved more exactly, the shorter they are.

Errors of first steps are speeds: a kicked rod drifted by ten tolerances of a step, one let go by five told errors.
"""

LASTING = 1e-3
"""Share of the time between two events over which velocity errors of shorter steps act while a rod touches.

A rod rolls onto its end in microseconds: steps that are exact in positions alone left it with velocities that were
wrong by a hundredth.
"""

MOST_AT_ONCE = 60
"""Changes between slack and taut, or of contact, within AT_ONCE above which they count as endless."""

SHORTER = 0.25
"""Factor on a step size after a step in which a cable changed at the very start of the step."""

AT_ONCE = 1e-6
"""Time, over the duration, within which changes count as simultaneous."""

CLOSED_AT_ONCE = 256
"""Number of times whose constraints are closed together; each needs a matrix in memory."""

AT_REST = 'let it start at rest: wave = "one_minus_cosine", or a table with interpolation = "cubic"'
"""Remedy for an input that starts with a speed which the rods cannot follow."""


def equations_of(
    model: Model, piece: Piece, p: FloatArray | None = None, kernels: StepKernels | None = None
) -> MotionEquations:
    """Make the equations of motion of a model while its inputs follow one smooth piece of their paths.

    Args:
        model: the model.
        piece: piece of the inputs.
        p: stacked parameters; None for a model without parameters.
        kernels: inverse dynamics and its derivatives; by default in CasADi's virtual machine.
    """
    kernels = kernels or interpreted(model)
    parameters = [] if p is None else [p]
    inputs_at = piece.remembered

    def residual_with_parameters(t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        value, rate, acceleration = inputs_at(t)
        return kernels.residual(x, v, a, value, *parameters, rate, acceleration)

    residual: Callable[[float, FloatArray, FloatArray, FloatArray], FloatArray] = residual_with_parameters
    if isinstance(kernels.residual, RepeatedCall) and p is None:
        residual = KernelResidual(kernels.residual, inputs_at, piece.moves, piece.cubics)

    def jacobians_with_parameters(
        t: float, x: FloatArray, v: FloatArray, a: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        value, rate, acceleration = inputs_at(t)
        stiffness, damping, mass = kernels.jacobians(x, v, a, value, *parameters, rate, acceleration)
        return stiffness, damping, mass

    jacobians: Jacobians = jacobians_with_parameters
    if kernels.derivatives is not None and p is None:
        jacobians = KernelJacobians(kernels.derivatives, inputs_at)

    unknowns = model.discrete.unknowns
    eliminated = kept_with(
        model, "_eliminated", lambda: np.arange(model.size - unknowns.count(BlockKind.FLOW), model.size)
    )
    return MotionEquations(unknowns.differential, residual, jacobians, kinks=piece.kinks, eliminated=eliminated)


class Stops(Protocol):
    """Values, referred to by number, at whose zeros a motion stops."""

    def guards(self, piece: Piece, begin: Instant) -> Guards | None:
        """Make guards of the values, with signs that are positive at the start; None if there are no values."""

    def jumped(self, before: Piece, piece: Piece, at: Instant) -> int | None:
        """Number of a value that jumps through zero with the inputs between two pieces; None if none does."""


@dataclass(frozen=True)
class Leg:
    """The steps over a piece of the inputs, or over a part of it in which cables, stops and contacts do not change.

    Attributes:
        piece: the inputs.
        integration: the steps, with contact forces appended to the unknowns of the model.
        restart: the change at the start of the leg, and the phases in it.
        equations: equations of motion before cables and contacts are added; None in a pickled copy.
    """

    piece: Piece
    restart: Restart
    integration: Integration
    equations: MotionEquations | None

    def __getstate__(self) -> dict[str, Any]:
        # Addresses of compiled functions are those of one process.
        return vars(self) | {"equations": None}

    @property
    def start(self) -> ConsistentStart:
        """State in which the leg begins."""
        return self.restart.start

    @property
    def lost(self) -> float:
        """Energy lost in an impact at the start of the leg, J."""
        return self.restart.lost


@dataclass(frozen=True)
class History:
    """The motion of a model in time.

    Attributes:
        model: the model.
        legs: one leg for each piece that was begun, and one more for each time at which a cable becomes slack or taut,
            a joint hits a stop or leaves it, or contact changes.
        method: collocation method of the steps.
        settings: settings of the steps.
        flight: coordinates of the steps, and the correction of their momentum.
        stopped: number of the value that stopped the motion; None if it was not stopped.
        carried: data that a next step takes over; None without friction of exact contact.
    """

    model: Model
    legs: tuple[Leg, ...]
    method: Collocation
    settings: StepSettings
    flight: FreeFlight
    stopped: int | None = None
    carried: CarriedContacts | None = None

    def __getstate__(self) -> dict[str, Any]:
        # The record of contacts has functions in symbols of one process, and arrays would keep the steps twice.
        return {name: value for name, value in vars(self).items() if name not in ("contacts", "rows")}

    @property
    def begin(self) -> float:
        """Time at which the motion begins, s: zero, unless it continues another one."""
        return self.legs[0].start.instant.time

    @property
    def resume(self) -> Resume:
        """The state from which the motion would continue."""
        leg = self.legs[-1]
        ended = leg.integration
        phases = leg.restart.phases
        places = tuple(phases.follower.places)
        guard = ended.guard if self.stopped is None else None
        # Behind a guard there are other equations.
        memory = ended.memory if guard is None else None
        first = ended.next_size if memory is None else memory.wanted
        return Resume(ended.end, phases, places, guard, first, memory, self.carried)

    @property
    def outcome(self) -> StepOutcome:
        """Outcome of the last piece."""
        return self.legs[-1].integration.outcome

    @property
    def completed(self) -> bool:
        """Whether all pieces were integrated to their ends."""
        return self.outcome is StepOutcome.COMPLETED

    @property
    def end(self) -> Instant:
        """The last instant of the motion."""
        return self.of_model(self.legs[-1].integration.end)

    @property
    def next_size(self) -> float:
        """Size of the next step, or of the step that failed, s."""
        return self.legs[-1].integration.next_size

    @cached_property
    def steps(self) -> list[tuple[Leg, TimeStep]]:
        """All steps in order of time, with their legs."""
        return [(leg, step) for leg in self.legs for step in leg.integration.steps]

    @cached_property
    def rows(self) -> list[StepRows]:
        """The steps of each leg, as arrays, without legs that have no steps."""
        return [StepRows.of(leg.integration.steps) for leg in self._stepping[0]]

    @cached_property
    def _stepping(self) -> tuple[list[Leg], npt.NDArray[np.intp]]:
        """The legs that have steps, and the number of the first step of each."""
        legs = [leg for leg in self.legs if leg.integration.steps]
        return legs, np.cumsum([0, *(len(leg.integration.steps) for leg in legs)])[:-1]

    @cached_property
    def statistics(self) -> StepStatistics:
        """Statistics of the steps: numbers, iterations and sizes."""
        sizes = [size for rows in self.rows for size in rows.facts[:, 2].tolist()]
        counts = [leg.integration.statistics for leg in self.legs]
        cost = sum(counts[1:], counts[0])
        smallest, largest = min(sizes, default=float("nan")), max(sizes, default=float("nan"))
        return StepStatistics(cost.steps, cost.rejected, cost.iterations, cost.jacobians, smallest, largest)

    def at(self, time: float) -> MotionState:
        """State at a time within the motion, by the dense output of the steps; at a jump, the state before it."""
        states = self.states(np.array([time]))
        return MotionState(states.x[0], states.v[0], states.a[0], states.inputs[0])

    def states(self, times: FloatArray) -> MotionState:
        """States at T times within the motion, as by :meth:`at`, a row for each time."""
        x, v, a = np.empty((3, len(times), self.model.size))
        inputs = np.empty((len(times), self.model.inputs.size))
        for leg, rows, held in self._held(times):
            inputs[rows] = leg.piece.values_at(times[rows])
            if held is not None and self.flight.coordinates is None:
                parts = positions_at(held), *held.rates()
                x[rows], v[rows], a[rows] = (part[:, : self.model.size] for part in parts)
            else:
                instants = [(at.x, at.v, at.a) for _, at in map(self.locate, times[rows].tolist())]
                x[rows], v[rows], a[rows] = np.reshape(instants, (-1, 3, self.model.size)).swapaxes(0, 1)
            if held is None or not len(self._closing.rows):
                continue
            held_rows = np.arange(len(times))[rows]
            for first in range(0, len(held_rows), CLOSED_AT_ONCE):
                part = slice(first, first + CLOSED_AT_ONCE)
                some = held_rows[part]
                x[some] = self._closing.closed(x[some], inputs[some], held.numbers[part])
        return MotionState(x, v, a, inputs)

    def locate(self, time: float) -> tuple[Leg, Instant]:
        """Instant at a time within the motion, with the leg that contains it; at a jump, the leg before it."""
        if not len(self.end_times):
            return self.legs[0], self.of_model(self.legs[0].start.instant)
        leg, step = self._step(self.number_at(time))
        return leg, self.of_model(step.at(time))

    def _step(self, number: int) -> tuple[Leg, TimeStep]:
        legs, firsts = self._stepping
        of_leg = int(np.searchsorted(firsts, number, side="right")) - 1
        return legs[of_leg], legs[of_leg].integration.steps[number - firsts[of_leg]]

    def touching(self, time: float) -> tuple[MotionContact, ...]:
        """Contacts at a time within the motion; none in a scene without exact contact."""
        if self.contacts is None or not len(self.end_times):
            return ()
        number = self.number_at(time)
        _, step = self._step(number)
        # The stages of a short first step have rounding over its square in their forces, and more where it begins.
        instant = step.start if time == step.start.time else step.at(time)
        return self.contacts.at(number, self.flight.to_model(instant))

    @property
    def lost(self) -> float:
        """Energy lost in all impacts, J."""
        return sum(leg.lost for leg in self.legs)

    @property
    def events(self) -> tuple[ContactEvent, ...]:
        """Impacts and other changes of contact."""
        return tuple(event for leg in self.legs for event in leg.restart.events)

    def of_model(self, instant: Instant) -> Instant:
        """State of a step in the unknowns of the model, without contact forces."""
        return self.flight.to_model(instant).first(self.model.size)

    def number_at(self, time: float) -> int:
        """Number of the step that contains a time; at the end of a step, the number of that step."""
        return min(int(np.searchsorted(self.end_times, time)), len(self.end_times) - 1)

    def rough_positions(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Unknowns and inputs at T times by the polynomials of the steps, shapes (T, size) and (T, inputs).

        Between the ends of steps they violate constraints, by less than the error of the motion.
        """
        x = np.empty((len(times), self.model.size))
        inputs = np.empty((len(times), self.model.inputs.size))
        for leg, rows, held in self._held(times):
            inputs[rows] = leg.piece.values_at(times[rows])
            if held is None:
                x[rows] = self.of_model(leg.start.instant).x
                continue
            own = positions_at(held)[:, : self.model.size]
            coordinates = self.flight.coordinates
            x[rows] = own if coordinates is None else coordinates.positions_of_model(own)
        return x, inputs

    def _held(self, times: FloatArray) -> Iterator[tuple[Leg, npt.NDArray[np.bool_] | slice, HeldTimes | None]]:
        """Legs that hold some of T times, which ones, shape (T,), and these in their steps; None without a step."""
        if not len(self.end_times):
            yield self.legs[0], slice(None), None
            return
        numbers = np.minimum(np.searchsorted(self.end_times, times), len(self.end_times) - 1)
        legs, firsts = self._stepping
        of_legs = np.searchsorted(firsts, numbers, side="right") - 1
        for of_leg in sorted(set(of_legs.tolist())):
            rows = of_legs == of_leg
            yield legs[of_leg], rows, HeldTimes(self.rows[of_leg], numbers[rows] - firsts[of_leg], times[rows])

    def once(self, name: str, duration: float, computed: Callable[[], Known]) -> Known:
        """Return a result for the motion up to a duration, s, which is computed once and kept under its name."""
        if (name, duration) not in self._known:
            self._known[name, duration] = computed()
        known: Known = self._known[name, duration]
        return known

    @cached_property
    def _known(self) -> dict[tuple[str, float], Any]:
        return {}

    @cached_property
    def contacts(self) -> ContactRecord | None:
        """The contacts and their forces; None in a scene without exact contact."""
        if not self.model.scene.touches_exactly:
            return None
        stretches = []
        for leg in self.legs:
            phases = leg.restart.phases
            stretches.append(Stretch(leg.piece, phases.touches, leg.integration.steps, phases.laid))
        return ContactRecord(self.model, stretches, self.flight.to_model)

    @cached_property
    def _closing(self) -> Closing:
        equations = self.legs[0].equations
        calls = () if equations is None else (equations.residual, equations.jacobians)
        of_kernels = [one.call.library if isinstance(one, KernelResidual | KernelJacobians) else None for one in calls]
        return Closing(self.model, Libraries(*of_kernels))

    @cached_property
    def end_times(self) -> FloatArray:
        """Times at the ends of all steps, s."""
        return np.concatenate([np.zeros(0), *(rows.end_times for rows in self.rows)])


@dataclass(frozen=True)
class FreeFlight:
    """Coordinates of the steps, and correction of momentum, for free rods; built once for all motions of a model.

    Attributes:
        model: the model.
        coordinates: coordinates of the steps; None for the unknowns of the model.
        keeper: correction of the momentum after a step; None if something is held.
    """

    model: Model
    coordinates: CentredCoordinates | None
    keeper: MomentumKeeper | None

    def __reduce__(self) -> tuple[Callable[..., FreeFlight], tuple[Model, bool]]:
        """Rebuild the record in pickled copies: its functions belong to one process."""
        return _flight, (self.model, self.coordinates is not None)

    def to_model(self, instant: Instant) -> Instant:
        """Map a state of the steps to the unknowns of the model; contact forces stay appended."""
        return instant if self.coordinates is None else self.coordinates.to_model(instant)

    def to_steps(self, instant: Instant) -> Instant:
        """Map a state in the unknowns of the model to the coordinates of the steps."""
        return instant if self.coordinates is None else self.coordinates.from_model(instant)

    def restart_of_steps(self, restart: Restart) -> Restart:
        """Map the state of a restart from the unknowns of the model to the coordinates of the steps."""
        return replace(restart, start=replace(restart.start, instant=self.to_steps(restart.start.instant)))

    def settled_in_steps(self, settling: Settling) -> Settle:
        """Map a correction of the ends of steps from the unknowns of the model to the coordinates of the steps."""
        return lambda step: self.to_steps(settling(self.to_model(step.end)))

    def in_steps(self, equations: MotionEquations, guards: Guards | None) -> tuple[MotionEquations, Guards | None]:
        """Map equations and guards from the unknowns of the model to the coordinates of the steps."""
        if self.coordinates is None:
            return equations, guards
        of_steps = self.coordinates.equations(equations)
        if guards is None:
            return of_steps, None
        return of_steps, lambda instant: guards(self.to_model(instant))


def free_flight(model: Model, p: FloatArray | None = None, libraries: Libraries = INTERPRETED) -> FreeFlight:
    """Make the coordinates of the steps and the correction of momentum for a model.

    Args:
        model: the model.
        p: stacked parameters; None for a model without parameters.
        libraries: shared objects that contain :func:`functions_of_flight` and :func:`derivatives_of_flight`.
    """
    # Who asks for parameters wants the steps in the unknowns of the model, to differentiate them.
    return _flight(model, p is None and can_be_centred(model), libraries)


def _flight(model: Model, centred: bool, libraries: Libraries = INTERPRETED) -> FreeFlight:
    coordinates = CentredCoordinates(model, libraries) if centred else None
    to_model = None if coordinates is None else coordinates.to_model
    keeper = MomentumKeeper(model, to_model, libraries.residual) if flies_free(model) else None
    return FreeFlight(model, coordinates, keeper)


def functions_of_flight(model: Model) -> list[ca.Function]:
    """Functions that every step of free rods calls; an empty list if something is held."""
    functions = CentredCoordinates(model).in_iterations if can_be_centred(model) else []
    return [*functions, *functions_of_momentum(model)] if flies_free(model) else functions


def derivatives_of_flight(model: Model) -> list[ca.Function]:
    """Functions, beside those of the model, for the linearised equations of free rods."""
    return [CentredCoordinates(model).derivatives] if can_be_centred(model) else []


def integrated(
    model: Model,
    pieces: Sequence[Piece],
    x: FloatArray,
    v: FloatArray,
    method: Collocation,
    settings: StepSettings,
    after_step: AfterStep | None = None,
    p: FloatArray | None = None,
    phases: ContactPhase | None = None,
    kernels: StepKernels | None = None,
    resume: Resume | None = None,
    flight: FreeFlight | None = None,
    stops: Stops | None = None,
    begun: Restart | None = None,
) -> History:
    """Integrate a model over all pieces of its inputs, or until one ends early.

    Args:
        model: the model.
        pieces: pieces of its inputs, one after the other.
        x: unknowns at the start, shape (size,); multipliers and tensions are a guess.
        v: rates of the unknowns, shape (size,), 1/s.
        method: the collocation method.
        settings: settings of the steps.
        after_step: callback after every step.
        p: stacked parameters; None for a model without parameters.
        phases: contacts at the start; None to search for them, and in a scene without exact contact.
        kernels: kernels as for :func:`equations_of`.
        resume: state from which a motion continues, in place of x, v and phases; None for a motion that begins.
        flight: free flight of the model; None to make it.
        stops: values at whose zeros the motion stops; None for a motion to its end.
        begun: restart at the start of another motion of the model with equal start; None if unknown.

    Raises:
        SceneError: the start contradicts the constraints.
    """
    kernels = kernels or interpreted(model)
    flight = flight or free_flight(model, p)
    switching, first_phases = _switching(model, kernels, x, pieces[0], phases, resume)
    begin = flight.to_steps(Instant(pieces[0].start, x, v, np.zeros(model.size)))
    end = pieces[-1].end
    acting = time_between_events(model, end) if model.scene.touches_exactly else end
    growing = _GrowingMotion(
        model=model,
        kernels=kernels,
        flight=flight,
        switching=switching,
        method=method,
        p=p,
        after_step=after_step,
        stops=stops,
        end=end,
        acting=acting,
        at=begin,
        phases=first_phases,
        settings=settings,
        begun=begun,
    )
    if resume is not None:
        growing.take_up(resume)
    for piece in pieces:
        if piece.end > growing.at.time and not growing.covers(piece):
            return growing.history(settings)
    # A cable may become slack or taut in the very end: no motion is left to go on with.
    growing.end_last(StepOutcome.COMPLETED)
    return growing.history(settings)


@dataclass
class _GrowingMotion:
    """A motion that is integrated leg by leg; its other attributes are the arguments of :func:`integrated`.

    Attributes:
        switching: changes between the equations of cables, stops and contacts.
        end: time at which the motion ends, s.
        acting: time over which errors of velocity act, s.
        at: the last instant, in the coordinates of the steps.
        phases: state of cables, stops and contacts there.
        settings: settings of the next step.
        guard: guard that ended the last leg.
        memory: data of the last step, for a step that continues it.
        legs: legs that are complete.
        resumed: whether the motion continues another one.
        stopped: number of the value that stopped the motion.
    """

    model: Model
    kernels: StepKernels
    flight: FreeFlight
    switching: SidedContacts
    method: Collocation
    p: FloatArray | None
    after_step: AfterStep | None
    stops: Stops | None
    end: float
    acting: float
    at: Instant
    phases: ContactPhase
    settings: StepSettings
    begun: Restart | None
    guard: int | None = None
    memory: CarriedStep | None = None
    legs: list[Leg] = field(default_factory=list)
    resumed: bool = False
    stopped: int | None = None

    def history(self, settings: StepSettings) -> History:
        """Return the motion with the settings that its caller asked for."""
        return History(self.model, tuple(self.legs), self.method, settings, self.flight, self.stopped)

    def take_up(self, resume: Resume) -> None:
        """Continue another motion."""
        self.at = resume.at
        self.guard = resume.guard
        self.memory = resume.memory
        self.settings = replace(self.settings, first=resume.first)
        self.resumed = True

    def covers(self, piece: Piece) -> bool:
        """Integrate over a piece of the inputs; return whether the motion goes on at its end."""
        if self.stops is not None and self.legs:
            self.stopped = self.stops.jumped(self.legs[-1].piece, piece, self.flight.to_model(self.at))
            if self.stopped is not None:
                return False
        # A piece may be longer than the step that fitted into the last one; it begins with the step that was wanted.
        if self.settings.first is not None:
            self.settings = replace(self.settings, first=min(self.settings.first, piece.end - piece.start))
        plain = equations_of(self.model, piece, self.p, self.kernels)
        while self.at.time < piece.end:
            restart = self._restart(plain, piece)
            self.phases = restart.phases
            if restart.stalled is not None:
                self.legs.append(Leg(piece, restart, stalled_at(restart.start.instant), plain))
                return False
            if not self._covers_leg(plain, piece, restart):
                return False
        return True

    def _restart(self, plain: MotionEquations, piece: Piece) -> Restart:
        """Find the state and the phases in which the next leg begins."""
        if self.memory is not None and self.at.time > piece.start:
            return Restart(ConsistentStart(self.at, 0.0, 0.0, 0.0, 0), self.phases)
        begins = not self.legs and not self.resumed
        if begins and self.begun is not None:
            return self.begun
        self.memory = None
        # Accelerations and multipliers jump where an input or its rates do. Next to the end of a piece its inputs
        # go on beyond it: in what is left of it rounding would be all that is differentiated.
        interval = DIFFERENTIATED * piece.smooth
        at = self.flight.to_model(self.at)
        restart = self.switching.restarted(plain, piece, at, self.phases, self.guard, interval)
        restart = self.flight.restart_of_steps(restart)
        if begins:
            inputs = piece.at(self.at.time).value
            in_model = self.flight.coordinates is None
            sags = sags_by_cable(self.model, self.at.x, inputs, self.p) if in_model else {}
            check_start(self.model, piece, restart, sags, self.end)
        return restart

    def _covers_leg(self, plain: MotionEquations, piece: Piece, restart: Restart) -> bool:
        """Integrate until phases change or the piece ends; return whether the motion goes on."""
        equations, guards = self.switching.arranged(plain, piece, self.phases)
        settings = self._settings(equations, piece)
        settled = self._settled(equations, plain, piece)
        begin = restart.start.instant
        begin_in_model = self.flight.to_model(begin)
        ends = None if self.stops is None else self.stops.guards(piece, begin_in_model)
        guards, changes = _joined(guards, ends, begin_in_model)
        equations, guards = self.flight.in_steps(equations, guards)
        integration = integrate(
            equations,
            begin,
            piece.end,
            self.method,
            settings,
            self.after_step,
            guards,
            settled,
            self.memory,
            self.kernels.stepper,
            self.kernels.stepper_after,
        )
        self.memory = None
        self.legs.append(Leg(piece, restart, integration, plain))
        if integration.guard is not None and integration.guard >= changes:
            self.end_last(StepOutcome.COMPLETED)
            self.stopped = integration.guard - changes
            return False
        if integration.outcome not in (StepOutcome.COMPLETED, StepOutcome.GUARDED):
            return False
        if _chatters(self.legs, self.end):
            touches = self.model.scene.touches_exactly
            self.end_last(StepOutcome.STALLED if touches else StepOutcome.STEP_TOO_SMALL)
            return False
        self.at = integration.end
        self.guard = integration.guard
        first = integration.next_size
        if not integration.steps and self.switching.sided.pairs:
            # A step that does not see what stiff parts answer to a blow would have the cable change again at once.
            first = max(SHORTER * first, AT_ONCE * self.end)
        self.settings = replace(self.settings, first=first)
        return True

    def _keeps_momentum(self, equations: MotionEquations) -> bool:
        """Whether the rods fly freely: a rod that touches an obstacle keeps no momentum."""
        return self.flight.keeper is not None and equations.size == self.model.size

    def _settings(self, equations: MotionEquations, piece: Piece) -> StepSettings:
        """Settings of the steps of a leg. Constraints are rounded: their short steps are solved no more exactly."""
        settings = self.settings
        forces = equations.size - len(settings.tolerance)
        if forces:
            # Contact forces are further unknowns, which have no tolerance.
            tolerance = np.concatenate([settings.tolerance, np.ones(forces)])
            settings = replace(settings, tolerance=tolerance, lasting=LASTING * self.acting)
        drifts = bool(np.all(equations.differential)) or self._keeps_momentum(equations)
        if drifts and settings.size is None and not self.model.scene.touches_exactly:
            settings = replace(settings, drifting=DRIFTING * (piece.end - piece.start))
        return settings

    def _settled(self, equations: MotionEquations, plain: MotionEquations, piece: Piece) -> Settle | None:
        """Correction of the end of each step; None if steps need none."""
        settling = self.switching.settling(plain, piece, self.phases)
        if settling is not None:
            return self.flight.settled_in_steps(settling)
        keeper = self.flight.keeper
        if keeper is None or not self._keeps_momentum(equations):
            return None
        return partial(keeper.settled, piece=piece)

    def end_last(self, outcome: StepOutcome) -> None:
        """Give the last leg another outcome."""
        last = self.legs[-1]
        self.legs[-1] = replace(last, integration=replace(last.integration, outcome=outcome))


def _switching(
    model: Model,
    kernels: StepKernels,
    x: FloatArray,
    piece: Piece,
    phases: ContactPhase | None,
    resume: Resume | None,
) -> tuple[SidedContacts, ContactPhase]:
    """Make the switches of the equations of a motion, and their state at the start, see :func:`integrated`."""
    inputs = piece.at(piece.start).value
    switching = SidedContacts(model, kernels.libraries)
    if resume is not None:
        follower = Follower(switching.contacts.facings, resume.phases.touches)
        follower.places = list(resume.places)
        return switching, replace(resume.phases, follower=follower)
    if phases is None:
        return switching, switching.first_phases(x, inputs)
    return switching, switching.with_pairs(phases, x, inputs)


def _joined(changes: Guards | None, ends: Guards | None, begin: Instant) -> tuple[Guards | None, int]:
    """Join guards of changes of the equations and guards that end the motion; also return the number of the first."""
    if changes is None or ends is None:
        return changes or ends, 0 if changes is None else len(changes(begin))
    return lambda instant: np.concatenate([changes(instant), ends(instant)]), len(changes(begin))


def _chatters(legs: Sequence[Leg], duration: float) -> bool:
    """Whether cables or contacts have changed too many times within AT_ONCE."""
    if len(legs) <= MOST_AT_ONCE:
        return False
    return legs[-1].integration.end.time - legs[-1 - MOST_AT_ONCE].integration.end.time < AT_ONCE * duration


def _inputs_that_move(model: Model, piece: Piece, time: float) -> list[str]:
    """Names of the inputs that move at a time (s), except inputs of loads, which move no support, joint or cable."""
    rate = piece.at(time).rate
    loads = {load.name for load in model.scene.loads}
    slices = model.inputs.slices.items()
    return [name for name, entries in slices if np.any(rate[entries]) and name.split(".")[0] not in loads]


def _lengths_of_free_rods(model: Model) -> list[str]:
    """Names of the inputs that are lengths of free rods, in a scene without anything held."""
    in_world = [joint for joint in model.scene.joints if joint.body is None]
    if model.scene.supports or in_world:
        return []
    return [f"{rod.name}.length" for rod in model.scene.rods if rod.base.free]


def check_start(model: Model, piece: Piece, restart: Restart, sags: Mapping[str, float], duration: float) -> None:
    """Refuse a motion whose start contradicts its constraints: nothing is repaired in silence.

    Args:
        model: the model.
        piece: first piece of the inputs.
        restart: the start.
        sags: excess of the length of each cable over its path, over the length of its rod, by cable.
        duration: duration of the motion, s.

    Raises:
        SceneError: supports or joints are not closed, or would be torn open at once.
    """
    start = restart.start
    moving = _inputs_that_move(model, piece, start.instant.time)
    grow = [name for name in _lengths_of_free_rods(model) if name in moving]
    problems = []
    short = {name: sag for name, sag in sags.items() if sag < -CONSISTENT}
    if restart.phases.touches and start.position_error > CONSISTENT:
        problems.append(start_inside(restart.phases.follower.facings, start.position_error))
    elif short:
        which = ", ".join(f"{name!r} by {-sag:.2g}" for name, sag in short.items())
        what = f"cables are too short where the motion starts: {which} (of the rod's length)"
        problems.append(Problem("simulation.start", what, "give them more length, or start from an equilibrium"))
    elif start.position_error > CONSISTENT:
        open_by = f"{start.position_error:.2g} (of the length, or rad)"
        what = f"supports or joints are open by {open_by} where the motion starts"
        problems.append(Problem("simulation.start", what, "start from an equilibrium"))
    if start.velocity_error * duration > CONSISTENT and np.any(start.instant.v):
        what = f"supports, joints or cables open at {start.velocity_error:.2g} 1/s with the velocities at t = 0"
        problems.append(Problem("velocities", what, "give velocities that they allow, or leave those of bodies out"))
    elif start.velocity_error * duration > CONSISTENT:
        names = " or ".join(map(repr, moving)) or "an input"
        what = (
            f"{names}, which moves supports, joints or cables, has a speed at t = 0, where the scene is at rest: "
            "no finite force brings what they hold to it at once"
        )
        problems.append(Problem("motions", what, AT_REST))
    elif grow and not np.any(start.instant.v):
        names = " or ".join(map(repr, grow))
        what = (
            f"{names} has a speed at t = 0, where its free rod is at rest: its sections would have a momentum that no "
            "force gave them"
        )
        problems.append(Problem("motions", what, AT_REST))
    refuse(problems)
