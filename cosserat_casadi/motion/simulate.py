"""Simulation of a model in time, with steps that are given or chosen for a tolerance.

The error of the steps is not predicted step by step: the motion is computed twice, the second time more exactly, and
the distance of the paths of the tips estimates the error. See docs/theory.md, section 11.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from cosserat_casadi.accuracy.refine import LARGEST_SHAPE_ERROR
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.strain_limits import first_beyond
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.checkpoint import Checkpoint, Strand
from cosserat_casadi.motion.contact_checks import NOT_OF_RODS, laid_down, told_inside, told_passage, too_deep
from cosserat_casadi.motion.contact_guards import SAME_PLACE
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.energy_balance import energies_of
from cosserat_casadi.motion.event_restart import LAID_DOWN, Restart
from cosserat_casadi.motion.fall_of_errors import FallOfErrors, RubbingFall, SmoothFall, hangs_on_rounding, is_struck
from cosserat_casadi.motion.history import FreeFlight, History, free_flight, integrated
from cosserat_casadi.motion.initial_velocity import with_velocities
from cosserat_casadi.motion.motion_checks import check_simulation
from cosserat_casadi.motion.motion_compiler import MARGINS, RESOLUTION, MotionCompiler
from cosserat_casadi.motion.motion_ending import message_of, outcome_of
from cosserat_casadi.motion.motion_event import EventWatch, MotionEvent
from cosserat_casadi.motion.motion_start import ALONG, Start, equilibrium_start, given_start, unloaded_start
from cosserat_casadi.motion.moving_inputs import MovingInputs, Piece
from cosserat_casadi.motion.one_sided import OneSided
from cosserat_casadi.motion.pose_series import poses_of
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries, external
from cosserat_casadi.motion.rubbing_library import RubbingSteps
from cosserat_casadi.motion.rubbing_motion import rubbing_history
from cosserat_casadi.motion.step_kernels import StepKernels, interpreted
from cosserat_casadi.motion.sudden_loads import warnings
from cosserat_casadi.motion.tip_paths import Paths, path_distance, paths, watched_states
from cosserat_casadi.motion.trajectory import (
    Account,
    Energies,
    Motion,
    MotionOutcome,
    MotionProgress,
    MotionState,
    StepStatistics,
)
from cosserat_casadi.numerics.collocation import STAGES, Collocation, gauss, radau
from cosserat_casadi.numerics.integration import StepOutcome, StepSettings
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.simulation import Simulation

LOG = logging.getLogger(__name__)

Tell = Callable[[MotionProgress], None]
"""A callback that receives the progress after every step."""

TIGHTER = 10.0
"""Ratio of the step tolerances of the first two motions that are compared."""

LEAST_TIGHTENING = 3.0
"""Least ratio of the step tolerances of further motions."""

SLOPE = 0.8
"""Power of the step tolerance with which the error of the paths is taken to fall."""

LEAST_SLOPE = 0.3
"""Least power with which the error of the paths is taken to fall, if two motions tell the error.

The power is 0.8 on average, but less between some motions, as the steps of one may suit the motion by chance.
"""

LEAST_SLOPE_AFTER_IMPACTS = 0.08
"""Least power for motions with impacts: a small error before an impact may be large after some more.

Until steps resolve the waves along a rod, motions may be nearer to each other than to the true one.
"""

LEAST_SLOPE_OF_ALIKE = 0.2
"""Least power for two motions whose impacts agree one by one."""

SLOPE_OF_THREE_ALIKE = 0.5
"""Power for three motions whose impacts agree and whose distances fall as by AS_STEPS; else it is LEAST_SLOPE."""

AS_STEPS = (0.05, 0.2)
"""Distance over that of motions TIGHTER times as coarse: range in which it falls as errors do; 0.16 by SLOPE."""

LYING = ("lie_down", LAID_DOWN)
"""Kinds of events after which a rod touches at many sections, whose impacts are not comparable one by one."""

FEW_STEPS = 10.0
"""Number of steps at which an estimated error counts twice: a few steps may suit the motion by chance."""

ALIKE = 1.25
"""Ratio of the numbers of steps of a motion and a coarser one above which its tolerance, not events, shortens steps.

Steps grow by a bounded factor after each event, so that the first few do not depend on the tolerance.
"""

MOST_ALIKE = 2
"""Most further motions, each TIGHTER times as exact, to find one whose steps its tolerance shortens."""

MOST_TIGHTENINGS = 6
"""Most motions, each more exact than the last, before a tolerance is given up."""

MOST_APART = 3
"""Most halvings of steps in a row that bring motions with impacts no nearer to each other."""

FIRST_EQUAL_STEPS = 50
"""Number of equal steps of a motion without a step tolerance at first; they are halved until motions agree."""

MOST_HALVINGS = 10
"""Most halvings of such steps before a tolerance is given up."""

EXACT = 1e-13
"""Error of Newton's method, over the length, in steps of given size, so small that energy is exact to rounding."""

NEWTON = 1e-3
"""Error of Newton's method over the tolerance of a step."""

NEWTON_OF_CLOSED = 1e-4
"""Error of Newton's method over the tolerance of a step with supports or joints, which have to stay closed.

Their openings also cause errors of velocities over a step. These fall with the tolerance of a step like other errors,
so that two motions that tell an error tell them too.
"""

CLOSED = 1e-10
"""Error of Newton's method, over the length, if contacts, stops or slack cables change the equations."""

FORCE_LEFT = 0.1
"""Largest force, in EI/ℓ², by the error of Newton's method in stretch; a compression of π² buckles a hinged rod.

An error of a thousandth of the tolerance buckled a steel wire ten thousand times as long as it is thick, and steps
became ever shorter.
"""


STEPS_ALONE = "The estimated error is that of the time steps only. Simulate the scene for the error of its modes too."
"""Sentence on the error of a motion of a model."""


@dataclass(frozen=True)
class Companion:
    """A motion that tells the error of another.

    Attributes:
        history: the motion.
        factor: error of the other motion over the distance of their paths.
        impacts: energy lost in its impacts, less that of the other motion, before both were continued, J.
        by_modes: whether it tells the error of the modes; else it tells the error of the steps.
    """

    history: History
    factor: float
    impacts: float = 0.0
    by_modes: bool = False


@dataclass(frozen=True)
class TimedHistory:
    """A motion with the error of its steps.

    Attributes:
        history: the motion.
        error: estimated error of the paths by the steps, over the length; nan if it was not estimated.
        tolerance: tolerance of a step of the motion, over the length; nan for steps of given size.
        companion: the motion by which the error was estimated; None if it was not estimated.
        distance: distance of the paths from those of the companion, over the length; nan without one.
        earlier: motion that was compared with the companion, if impacts with friction need a third one.
        cut_short: whether a more exact motion was interrupted, which would have told the error, or a smaller one.
    """

    history: History
    error: float
    tolerance: float = float("nan")
    companion: Companion | None = None
    distance: float = float("nan")
    earlier: Companion | None = None
    cut_short: bool = False

    @property
    def is_interrupted(self) -> bool:
        """Whether the motion, or a more exact one, was interrupted."""
        return self.cut_short or self.history.outcome is StepOutcome.INTERRUPTED

    @property
    def companions(self) -> list[Companion | None]:
        """The motions that told the error."""
        return [self.companion, self.earlier]


@dataclass(frozen=True)
class Simulator:
    """Simulator of the motion of one model, to any exactness.

    Attributes:
        model: the model, built for a motion.
        simulation: the settings of the user.
        start: start of the motion.
        stage: name of the work under way, for the user.
        tell: callback after every step.
        source: selector of the kernels of every motion; None for kernels in CasADi's virtual machine.
        begun: checkpoint from which the motion continues; None for a motion that begins.
        events: events of the user.
    """

    model: Model
    simulation: Simulation
    start: Start
    stage: str = "simulating"
    tell: Tell | None = None
    source: MotionCompiler | None = None
    begun: Checkpoint | None = None
    events: Sequence[MotionEvent] = ()

    @cached_property
    def watch(self) -> EventWatch:
        """The events on this model."""
        return EventWatch(self.model, self.events)

    @cached_property
    def moving(self) -> MovingInputs:
        """The inputs over time."""
        return moving_inputs(self.model)

    @cached_property
    def _flights(self) -> dict[Libraries, FreeFlight]:
        """Coordinates and momentum of free rods, by the shared objects that contain their functions."""
        return {}

    @cached_property
    def _begun(self) -> dict[Libraries, Restart]:
        """Restarts at the start of motions, by shared objects; a first motion would move the trackers of contacts."""
        return {}

    @cached_property
    def displacements(self) -> FloatArray:
        """Largest displacement by a unit of each unknown, over the length, shape (size,)."""
        return displacements(self.model, self.library)

    @property
    def library(self) -> str | None:
        """The shared object with the equations of motion; None if they are not in machine code."""
        return None if self.source is None else self.source.library(self.model)

    def controlled(self, tolerance: float) -> History:
        """Compute the motion by Radau IIA with steps whose errors stay below a tolerance, over the length."""
        left = min(NEWTON * tolerance, max(CLOSED, FORCE_LEFT * self._stretch))
        if self.model.scene.touches_exactly or OneSided(self.model).pairs:
            # What Newton's method leaves is what contacts are open by. In flight too: with more of it steps of a thin
            # rod came to a halt after a blow.
            left = min(left, CLOSED)
        elif not np.all(self.model.discrete.unknowns.differential):
            left = min(left, NEWTON_OF_CLOSED * tolerance)
        settings = StepSettings(tolerance=tolerance / self.displacements, newton=left / tolerance)
        return self._integrated(radau(STAGES), settings)

    @property
    def has_equal_steps(self) -> bool:
        """Whether steps are equal and halved until motions agree, because no step tolerance controls them."""
        return self.simulation.integrator == "gauss" or self.rubs

    @property
    def rubs(self) -> bool:
        """Whether friction of exact contact acts, for which there are steps in C."""
        return self.model.scene.rubs_exactly

    @cached_property
    def fall(self) -> FallOfErrors:
        """Model of the decrease of errors of equal steps."""
        return RubbingFall(self.model, self.begun) if self.rubs else SmoothFall()

    @cached_property
    def _rubbing(self) -> RubbingSteps:
        """Steps with friction, for all motions of the model."""
        return RubbingSteps(self.model)

    @property
    def _stretch(self) -> float:
        """Least stretch or shear by a force of EI/ℓ², over the length; infinite if rods admit neither."""
        rods = self.model.discrete.rods.values()
        scales = [
            rod.scales[number] for rod in rods for number, strain in enumerate(rod.admitted) if strain in rod.linear
        ]
        return min(scales, default=np.inf) ** 2

    def stepped(self, size: float) -> History:
        """Compute the motion with equal steps, s, by the integrator in the settings."""
        method = gauss(STAGES) if self.simulation.integrator == "gauss" else radau(STAGES)
        tolerance = EXACT / self.displacements
        return self._integrated(method, StepSettings(tolerance=tolerance, size=size, newton=1.0))

    def resumed(self, strand: Strand) -> History:
        """Continue the motion of a strand, with its steps."""
        method = gauss(STAGES) if strand.gauss else radau(STAGES)
        return self._integrated(method, strand.settings)

    def paths(self, history: History) -> Paths:
        """Evaluate the paths of tips and bodies, by which two motions are compared."""
        duration = self.simulation.duration
        states = watched_states(history, duration)
        return history.once("paths", duration, lambda: paths(self.model, states.x, states.inputs, self.library))

    def to_tolerance(self, tolerance: float, first: float) -> TimedHistory:
        """Compute the motion on this model to an error of its steps.

        Args:
            tolerance: tolerance of the paths, over the length.
            first: first tolerance of a step, if steps are controlled.
        """
        if self.simulation.step is not None:
            history = self.stepped(self.simulation.step)
            return self.told_by_half(history) if history.completed else TimedHistory(history, float("nan"))
        if self.has_equal_steps:
            return self.halved(tolerance)
        return self.tightened(self.controlled(first), first, lambda _: tolerance)

    def tightened(
        self,
        coarse: History,
        first: float,
        tolerance_of_paths: Callable[[History], float],
        fine: History | None = None,
    ) -> TimedHistory:
        """Compute the motion with ever more exact steps, until the paths of two motions agree to a tolerance.

        Args:
            coarse: the motion to begin with.
            first: tolerance of a step of that motion, over the length.
            tolerance_of_paths: function of a motion ↦ allowed error of its paths by the steps, over the length.
            fine: the motion with steps TIGHTER times as exact; None if it is not known.
        """
        timed = TimedHistory(coarse, float("nan"), first)
        factor = TIGHTER
        before = np.inf
        for _ in range(MOST_TIGHTENINGS):
            if not timed.history.completed:
                break
            finer = self.finer(timed, factor, fine)
            fine = None
            if finer.history.outcome is StepOutcome.INTERRUPTED:
                return replace(timed, cut_short=True)
            if finer.history.outcome is not StepOutcome.COMPLETED and timed.companion:
                # The error of the last whole motion is known.
                break
            timed = finer
            if timed.cut_short:
                break
            distance = timed.distance
            tolerance = tolerance_of_paths(timed.history)
            if timed.error <= tolerance or hangs_on_rounding(timed.history, distance, before, tolerance):
                break
            # Far apart after impacts, the next two motions are compared with these: their steps are to differ alike.
            # Of two that differ less after impacts both may err by the same.
            far = hangs_on_rounding(timed.history, distance, 0.0, tolerance)
            before = distance if far else np.inf
            factor = TIGHTER if is_struck(timed.history) else factor_for(timed.error, tolerance)
        return timed

    def finer(self, timed: TimedHistory, factor: float, fine: History | None = None) -> TimedHistory:
        """Compute the motion with a step tolerance smaller by a factor, or more, and its error by the distance.

        Args:
            timed: the motion with the larger tolerance.
            factor: ratio of the tolerances.
            fine: the motion with the smaller tolerance; None if it is not known.
        """
        tolerance = timed.tolerance / factor
        fine = fine or self.controlled(tolerance)
        steps = fine.statistics.steps
        if fine.completed and steps <= timed.history.statistics.steps and not has_shorter_steps_at_events(fine):
            # Its steps are no shorter ones, whatever the tolerance: the two motions say nothing of their error.
            return self.told_by_half(fine, tolerance)
        for _ in range(MOST_ALIKE):
            more = fine.statistics.steps / timed.history.statistics.steps
            if not (fine.completed and more < ALIKE and has_shorter_steps_at_events(fine)):
                break
            finer = self.controlled(tolerance / TIGHTER)
            if finer.outcome not in (StepOutcome.COMPLETED, StepOutcome.INTERRUPTED):
                break
            fine, tolerance = finer, tolerance / TIGHTER
        distance = path_distance(self.paths(timed.history), self.paths(fine))
        alike = are_struck_alike(fine, timed.history)
        earlier = timed.companion
        three_alike = alike and earlier is not None and are_struck_alike(timed.history, earlier.history)
        # A motion by half the steps is no third one whose steps are less exact than the steps of both.
        is_coarser = earlier is not None and earlier.history.statistics.steps < timed.history.statistics.steps
        fallen = distance / timed.distance if three_alike and is_coarser and timed.distance > 0.0 else float("nan")
        left = left_by(factor, fine, timed.history, fallen)
        if earlier is not None and is_struck(fine) and not three_alike and distance > 0.0:
            # Which section strikes next may be decided by chance: two motions may agree that both err as others do.
            left = max(left, timed.distance / distance)
        # Of two that are struck elsewhere no error below that of a step is believed.
        error = left * distance if alike else max(left * distance, tolerance)
        return TimedHistory(fine, error, tolerance, Companion(timed.history, left), distance)

    def told_by_half(self, history: History, step_tolerance: float = float("nan")) -> TimedHistory:
        """Estimate the error of the steps of a motion by another one with half of its longest step.

        Args:
            history: the motion.
            step_tolerance: tolerance of a step of the motion, over the length; nan for given steps.
        """
        shorter = self.stepped(history.statistics.largest_step / 2.0)
        history_paths = self.paths(history)
        distance = path_distance(history_paths, self.paths(shorter))
        left = self.fall.factor(history, shorter)
        error = self.fall.error(history, history_paths, left * distance, 0.0) if shorter.completed else float("nan")
        cut_short = shorter.outcome is StepOutcome.INTERRUPTED
        return TimedHistory(history, error, step_tolerance, Companion(shorter, left), distance, cut_short=cut_short)

    def halved(self, tolerance: float, begun: History | None = None) -> TimedHistory:
        """Compute the motion with equal steps that are halved until the paths of two motions agree to a tolerance.

        Args:
            tolerance: tolerance of the paths, over the length.
            begun: first motion, with equal steps that were short enough on other modes; by default a motion with a few
                steps.
        """
        history = begun or self.stepped(self.simulation.duration / FIRST_EQUAL_STEPS)
        assert history.settings.size is not None, "its steps are equal"
        size = history.settings.size
        history_paths = self.paths(history)
        error = float("nan")
        distance = 0.0 if begun else float("nan")
        companion = earlier = None
        apart = 0
        cut_short = False
        if history.outcome is StepOutcome.INTERRUPTED:
            return TimedHistory(history, float("nan"))
        for _ in range(MOST_HALVINGS):
            size = size / 2.0
            shorter = self.stepped(size)
            # Steps too long for their equations to be solved say nothing of shorter ones.
            if shorter.outcome is StepOutcome.INTERRUPTED:
                if not history.completed:
                    return TimedHistory(shorter, float("nan"))
                cut_short = True
                break
            shorter_paths = self.paths(shorter)
            left = self.fall.factor(shorter, history)
            if history.completed and shorter.completed:
                before, distance = distance, path_distance(history_paths, shorter_paths)
                error = self.fall.error(shorter, shorter_paths, left * distance, left * before)
                hangs = self.fall.asks_a_third and hangs_on_rounding(shorter, distance, 2.0 * before, tolerance)
                apart = apart + 1 if hangs else 0
            earlier = replace(companion, factor=left) if companion and self.fall.asks_a_third else None
            companion = Companion(history, left)
            history = shorter
            history_paths = shorter_paths
            if error <= tolerance or apart == MOST_APART:
                break
        return TimedHistory(
            history, error, companion=companion, distance=distance, earlier=earlier, cut_short=cut_short
        )

    def _integrated(self, method: Collocation, settings: StepSettings) -> History:
        pieces = self.moving.pieces(self.simulation.duration)
        rates = np.zeros(self.model.size) if self.start.v is None else self.start.v
        kernels = None if self.source is None else self.source.kernels(self.model)
        if self.rubs:
            return self._rubbed(pieces, rates, settings, kernels or interpreted(self.model))
        libraries = INTERPRETED if kernels is None else kernels.libraries
        if libraries not in self._flights:
            self._flights[libraries] = free_flight(self.model, libraries=libraries)
        history = integrated(
            self.model,
            pieces,
            self.start.x,
            rates,
            method,
            settings,
            None if self.tell is None else self._after_step,
            phases=self.start.phases,
            kernels=kernels,
            resume=self.start.resume,
            flight=self._flights[libraries],
            stops=self.watch,
            begun=self._begun.get(libraries),
        )
        if history.legs and self.start.resume is None and not self.model.scene.touches_exactly:
            self._begun[libraries] = history.legs[0].restart
        if self.source is not None:
            self.source.learn(history.statistics)
        return history

    def _rubbed(
        self, pieces: Sequence[Piece], rates: FloatArray, settings: StepSettings, kernels: StepKernels
    ) -> History:
        start, resume = (self.start.x, rates), self.start.resume
        tell = None if self.tell is None else self._after_step
        touches = () if self.start.phases is None else self.start.phases.touches
        history = rubbing_history(self._rubbing, pieces, start, touches, settings, kernels, tell, self.watch, resume)
        if self.source is not None:
            self.source.learn(history.statistics)
        return history

    def _after_step(self, time: float, size: float) -> None:
        if self.tell is not None:
            self.tell(MotionProgress(self.stage, time, self.simulation.duration, size))


def has_shorter_steps_at_events(history: History) -> bool:
    """Whether a motion has so many steps next to events that equal steps of half its longest one would be fewer."""
    statistics = history.statistics
    if not history.events or not statistics.steps:
        return False
    return (history.end.time - history.begin) / statistics.largest_step < 0.5 * statistics.steps


def are_struck_alike(first: History, second: History) -> bool:
    """Whether two motions have equal impacts, one by one: of equal owners, on equal obstacles and sections.

    Motions in which a rod lies down never count as equal.
    """
    if any(event.kind in LYING for event in (*first.events, *second.events)):
        return False
    impacts = [[event for event in history.events if event.kind == "impact"] for history in (first, second)]
    return len(impacts[0]) == len(impacts[1]) and all(
        (one.owner, one.obstacle) == (other.owner, other.obstacle) and abs(one.place - other.place) <= SAME_PLACE
        for one, other in zip(*impacts, strict=True)
    )


def left_by(factor: float, finer: History, coarser: History | None = None, fallen: float = float("nan")) -> float:
    """Upper bound of the error of the finer of two motions over their distance, by the ratio of their step tolerances.

    Args:
        factor: the larger step tolerance over the smaller one.
        finer: the motion with the smaller step tolerance.
        coarser: the other motion; None if its impacts count as different.
        fallen: distance of the two over the distance of the coarser one from a third, TIGHTER times as coarse, if the
            impacts of all three agree; else nan.
    """
    slope = LEAST_SLOPE
    if is_struck(finer) or (coarser is not None and is_struck(coarser)):
        alike = coarser is not None and are_struck_alike(finer, coarser)
        slope = LEAST_SLOPE_OF_ALIKE if alike else LEAST_SLOPE_AFTER_IMPACTS
        if alike and np.isfinite(fallen):
            slope = SLOPE_OF_THREE_ALIKE if AS_STEPS[0] <= fallen <= AS_STEPS[1] else LEAST_SLOPE
    return (1.0 + FEW_STEPS / max(finer.statistics.steps, 1)) / float(factor**slope - 1.0)


def factor_for(error: float, tolerance: float) -> float:
    """Factor by which the step tolerance must be reduced for the error to meet a tolerance."""
    if not np.isfinite(error):
        return LEAST_TIGHTENING
    return float(np.clip((error / tolerance) ** (1.0 / SLOPE), LEAST_TIGHTENING, TIGHTER))


def simulate(
    model: Model,
    *,
    start: Solution | None = None,
    simulation: Simulation | None = None,
    progress: Tell | None = None,
    source: MotionCompiler | None = None,
    events: Sequence[MotionEvent] = (),
) -> Motion:
    """Simulate a model on its own modes and nodes; only the error of the time steps is controlled and reported.

    Args:
        model: model of a scene with motions, built with ``build(scene.with_motion_inputs(), …, moving=True)``.
        start: an equilibrium of the scene to start from at rest; by default the start in the simulation.
        simulation: duration, frames, tolerance; by default those of the scene.
        progress: callback after every step.
        source: selector of kernels, as in :class:`Simulator`.
        events: events of the user, as in :class:`Simulator`.

    Raises:
        SceneError: the scene has no simulation, or cannot be simulated with these settings.
    """
    model = model.at().in_motion
    asked = simulation or model.scene.simulation
    check_simulation(model, asked)
    assert asked is not None, "checked"
    began = started(model, asked, start, source=source)
    if not began.found:
        return not_started(model, began)
    simulator = Simulator(model, asked, began, tell=progress, source=source, events=events)
    tolerance = tolerance_of(model.scene, asked)
    timed = simulator.to_tolerance(tolerance, first=tolerance)
    if not timed.history.completed:
        return ended_early(simulator, timed.history)
    if timed.is_interrupted:
        motion = whole_but_interrupted(simulator, timed.history, timed.error)
    else:
        bound = tolerance if asked.step is None else LARGEST_SHAPE_ERROR
        motion = judged(simulator, timed.history, timed.error, bound, timed.companions)
    # What its modes leave of the paths is not estimated, so that no tolerance of the paths is met.
    return replace(motion, message=f"{motion.message} {STEPS_ALONE}", tolerance=None)


def bound_of(scene: Scene, simulation: Simulation, tolerance: float) -> float:
    """Largest error at which a motion counts as resolved; modes or steps that the user fixed need only resolve it."""
    return LARGEST_SHAPE_ERROR if scene.accuracy.fixed or simulation.step is not None else tolerance


def asked_of(scene: Scene, simulation: Simulation) -> float | None:
    """Requested error of the paths, over the length; None if a scene fixes modes and has no tolerance."""
    is_written = simulation.tolerance is not None or scene.accuracy.binds
    return tolerance_of(scene, simulation) if is_written else None


def tolerance_of(scene: Scene, simulation: Simulation) -> float:
    """Wanted error of the paths over the length."""
    return simulation.tolerance if simulation.tolerance is not None else scene.motion_tolerance


def moving_inputs(model: Model) -> MovingInputs:
    """The inputs of a model over time, made once for a model."""
    if "_moving_inputs" not in model.__dict__:
        model.__dict__["_moving_inputs"] = MovingInputs(model.inputs, model.scene.motions, model.pack())
    inputs: MovingInputs = model.__dict__["_moving_inputs"]
    return inputs


def started(
    model: Model,
    simulation: Simulation,
    solution: Solution | None,
    near: Solution | None = None,
    source: MotionCompiler | None = None,
) -> Start:
    """Make the start of the motion of a model.

    Args:
        model: the model.
        simulation: settings of the motion.
        solution: an equilibrium to start from; None for the start in the settings.
        near: the equilibrium of the start on other modes; None if it is not known.
        source: selector of kernels, as in :class:`Simulator`.
    """
    moving = moving_inputs(model)
    inputs = moving.at_start
    if solution is not None:
        start = given_start(model, solution)
    elif model.scene.model_copy(update={"simulation": simulation}).starts_unloaded:
        start = unloaded_start(model, inputs.value)
    else:
        kernels = interpreted(model) if source is None else source.kernels(model)
        start = equilibrium_start(model, inputs.value, near, kernels.residual)
    return _along(model, with_velocities(model, start, moving.pieces(simulation.duration)[0]), inputs.rate)


def _along(model: Model, start: Start, rates: FloatArray) -> Start:
    """Add a sentence to a start that says whether rods move along with their bases and lengths, by input rates."""
    of_rods = ("length", "base.position", "base.quaternion")
    moved = [span for entry, span in model.inputs if entry.of_rod and entry.field in of_rods and np.any(rates[span])]
    return replace(start, sentence=start.sentence + ALONG) if moved and start.found else start


def unresolved(history: History, duration: float, library: str | None = None) -> bool:
    """Whether the rods bend too sharply for their nodes at some time.

    Args:
        history: the motion.
        duration: end of the motion, s.
        library: shared object that contains :func:`functions_of_limits`; None without one.
    """
    model = history.model
    _, x, inputs = watched_states(history, duration)
    index = model.resolution_index if library is None else external(RESOLUTION, library)
    (indices,) = evaluated(index, x, inputs)
    return bool(indices.max() > 1.0)


def told_beyond(history: History, duration: float, library: str | None = None) -> tuple[MotionOutcome, str] | None:
    """Outcome and sentence on the first time at which strains exceed their limits; None if they never do.

    Args:
        history: the motion.
        duration: end of the motion, s.
        library: shared object that contains the margins of strains; None without one.
    """
    times, x, inputs = watched_states(history, duration)
    limited = history.model.strain_margins is not None and library is not None
    beyond = first_beyond(history.model, x, inputs, external(MARGINS, library) if limited else None)
    if beyond is None:
        return None
    outcome = MotionOutcome[beyond.word]
    return outcome, f"{outcome.value} {beyond.whose}, from t = {times[beyond.state]:.6g} s on."


def judged(
    simulator: Simulator,
    history: History,
    error: float,
    bound: float,
    companions: Sequence[Companion | None] = (),
) -> Motion:
    """Make the result of a motion computed to its end; it is not resolved if its error exceeds a bound or is unknown.

    Args:
        simulator: the simulator that computed it.
        history: the motion.
        error: estimated error of the paths over the length; not finite if it could not be estimated.
        bound: largest error at which the motion counts as resolved.
        companions: motions by which the error was estimated.
    """
    outcome = MotionOutcome.COMPLETED
    message = message_of(history, outcome)
    duration = simulator.simulation.duration
    beyond = told_beyond(history, duration, simulator.library)
    entered = told_inside(history, duration, tolerance_of(history.model.scene, simulator.simulation))
    if unresolved(history, duration, simulator.library):
        outcome = MotionOutcome.UNRESOLVED
        deep = too_deep(history, duration)
        message = f"{NOT_OF_RODS} {deep}" if deep else message_of(history, outcome)
    elif passed := told_passage(history, duration):
        outcome = MotionOutcome.UNRESOLVED
        message = f"{NOT_OF_RODS} {passed}"
    elif beyond is not None:
        outcome, message = beyond
        if outcome is MotionOutcome.UNRESOLVED:
            # Sections of contact lie too far apart to tell it.
            error = float("inf")
    elif entered:
        outcome = MotionOutcome.CONTACT_UNSETTLED
        message = entered
    elif not error <= bound:
        outcome = MotionOutcome.UNRESOLVED
        found = f"The estimated error of the paths is {error:.2g} of the length, above {bound:.2g}."
        if not np.isfinite(error):
            found = "The error of the paths could not be estimated."
        message = f"{outcome.value} {found}"
    return motion_of(simulator, history, outcome, error, message, companions)


def ended_early(simulator: Simulator, history: History) -> Motion:
    """Make the result of a motion that ended early; its error is not estimated."""
    outcome = outcome_of(history)
    message = message_of(history, outcome)
    if outcome is not MotionOutcome.INTERRUPTED:
        entered = told_inside(history, history.end.time, tolerance_of(history.model.scene, simulator.simulation))
        if entered:
            # What is pushed into an obstacle has no motion that goes on.
            outcome = MotionOutcome.CONTACT_UNSETTLED
            message = f"{outcome.value} {entered}"
    return motion_of(simulator, history, outcome, float("nan"), message)


def whole_but_interrupted(simulator: Simulator, history: History, error: float, told: str = "") -> Motion:
    """Make the result of a motion that was computed to its end before a more exact one was interrupted.

    Args:
        simulator: the simulator that computed it.
        history: the motion.
        error: estimated error of the paths over the length; nan if it is not known.
        told: end of the sentence on the error; by default with the number.
    """
    if not told:
        is_known = np.isfinite(error)
        told = f": its estimated error is {error:.2g} of the length." if is_known else ", and its error is not known."
    outcome = MotionOutcome.INTERRUPTED
    message = f"{outcome.value} The motion is whole, but not as exact as was asked{told}"
    return motion_of(simulator, history, outcome, error, message)


def motion_of(
    simulator: Simulator,
    history: History,
    outcome: MotionOutcome,
    error: float,
    message: str,
    companions: Sequence[Companion | None] = (),
) -> Motion:
    """Make the record of a motion, with rows at the requested times that it reached."""
    model = simulator.model
    wanted = simulator.simulation.frame_times
    for event in history.events:
        LOG.info("%s of %s on %s at %.6g s", event.kind, event.owner, event.obstacle, event.time)
    times = wanted[(history.begin <= wanted) & (wanted <= history.end.time)]
    if history.stopped is not None:
        times = np.union1d(times, history.end.time)
    states = history.states(times)
    duration = simulator.simulation.duration
    others = [one for one in companions if one is not None and one.history.completed]
    strands = [_strand(Companion(history, 0.0))]
    strands += [_strand(replace(one, impacts=one.impacts + one.history.lost - history.lost)) for one in others]
    spread = max((abs(strand.impacts) for strand in strands[1:]), default=float("nan"))
    return Motion(
        model=model,
        outcome=outcome,
        message=message,
        times=times,
        x=states.x,
        v=states.v,
        a=states.a,
        inputs=states.inputs,
        error_estimate=error,
        statistics=history.statistics,
        start=simulator.start.sentence,
        interpolant=history.at,
        account=partial(_account, history, times, simulator.begun, tuple(strands), error),
        warnings=(*warnings(history, simulator.start, simulator.moving, duration), *laid_down(history)),
        contacts=tuple(history.touching(float(time)) for time in times),
        events=tuple(sorted([*history.events, *simulator.watch.crossings(history)], key=lambda event: event.time)),
        impacts_spread=spread,
        tolerance=asked_of(model.scene, simulator.simulation),
    )


def _account(
    history: History, times: FloatArray, begun: Checkpoint | None, strands: tuple[Strand, ...], error: float
) -> Account:
    """Evaluate the energies of a motion at its times, and its end.

    Args:
        history: the motion.
        times: shape (T,), s.
        begun: checkpoint from which the motion continues; None for a motion that begins.
        strands: the motion, then the motions that tell its error.
        error: estimated error of its paths, over the length.
    """
    moving = frozenset(motion.input for motion in history.model.scene.motions)
    energies, account = energies_of(history, times, moving, None if begun is None else begun.energy)
    return energies, Checkpoint(history.end.time, strands, error, account, _tips(history, history.end.time))


def _nothing() -> Account:
    """Energies and end of a motion that has no state."""
    none = np.zeros(0)
    return Energies(none, none, none, none, none, none, none), None


def _strand(one: Companion) -> Strand:
    """Make the strand of a motion at its present end, with its impacts up to there."""
    history = one.history
    by_gauss = not history.method.stiffly_accurate
    return Strand(
        history.model.discretisation, history.settings, by_gauss, one.factor, one.impacts, one.by_modes, history.resume
    )


def _tips(history: History, time: float) -> dict[str, list[float]]:
    """Positions of the tips at a time, by rod, m."""
    model = history.model
    x, inputs = history.rough_positions(np.array([time]))
    return {name: poses_of(model.tip[name], x, inputs).position[0].tolist() for name in model.discrete.rods}


def not_started(model: Model, start: Start, tolerance: float | None = None) -> Motion:
    """Make the record of a motion without a state to start from, with the requested tolerance."""
    none = np.zeros(0)
    no_state = np.zeros((0, model.size))

    def nowhere(time: float) -> MotionState:
        raise ValueError(f"the motion did not start: it has no state at {time:g} s")

    return Motion(
        model=model,
        outcome=MotionOutcome.NO_START,
        message=f"{MotionOutcome.NO_START.value} {start.sentence}",
        times=none,
        x=no_state,
        v=no_state,
        a=no_state,
        inputs=np.zeros((0, model.inputs.size)),
        error_estimate=float("nan"),
        statistics=StepStatistics(0, 0, 0, 0, float("nan"), float("nan")),
        start=start.sentence,
        interpolant=nowhere,
        account=_nothing,
        tolerance=tolerance,
    )
