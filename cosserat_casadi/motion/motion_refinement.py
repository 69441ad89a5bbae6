"""Simulate a scene to a tolerance in space and time together, with modes and nodes chosen for the motion.

The motion is computed on one set of modes after another, until the last coefficients show that further ones are not
needed, or two motions show it: the distance of their paths, and its decrease from one set to the next, bound the error
of the last one. A strain that does not move keeps one mode, and a strain whose last coefficients do not matter keeps
its number of modes. The steps have the exactness that such motions usually need, and are checked on the last set of
modes. See docs/theory.md, section 11.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from cosserat_casadi.accuracy.levels import verified_modes, verified_nodes, with_fibres
from cosserat_casadi.accuracy.refine import FINER_MODES
from cosserat_casadi.equilibrium.blindness import TurnedElements
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import Richer
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.required_modes import modes_for_turn, wave_modes
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.motion.fall_of_errors import FAR_APART, hangs_on_rounding, impacts_of, is_struck
from cosserat_casadi.motion.felt_modes import (
    ORDER_OF_WAVES,
    REST,
    SAFETY,
    UNKNOWN_ORDER,
    at_fronts,
    felt,
    lacking,
    lacking_at_fronts,
    last_of,
    most_modes,
    told_by_modes,
)
from cosserat_casadi.motion.going_on import StartOfMotion, checkpoint_of, go_on
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.motion_checks import check_simulation
from cosserat_casadi.motion.motion_compiler import MotionCompiler
from cosserat_casadi.motion.motion_event import MotionEvent
from cosserat_casadi.motion.moving_model import moving_model
from cosserat_casadi.motion.parts import simulate_in_parts
from cosserat_casadi.motion.simulate import (
    SLOPE,
    TIGHTER,
    Companion,
    Simulator,
    Tell,
    TimedHistory,
    asked_of,
    bound_of,
    ended_early,
    factor_for,
    judged,
    left_by,
    not_started,
    started,
    tolerance_of,
    whole_but_interrupted,
)
from cosserat_casadi.motion.simulate import simulate as simulate_model
from cosserat_casadi.motion.sudden_loads import is_sudden
from cosserat_casadi.motion.tip_paths import Paths, path_distance, watched_states
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.numerics.integration import StepOutcome
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.simulation import Simulation

LOG = logging.getLogger(__name__)

TIME_SHARE = 0.3
"""Share of the tolerance that the steps may use up."""

SPACE_SHARE = 0.7
"""Share of the tolerance that the modes and nodes may use up."""

FORESEEN_SHARE = 0.5
"""Share of the tolerance that the expected error of the modes may use up, so that there is room for the steps."""

MOST_AT_FRONTS = 0.9
"""Share of the tolerance that fronts may use up, if a motion with exact steps tells their error."""

TOLD_ERROR = 0.14
"""Usual error of the paths by a coarser motion, over the power SLOPE of the tolerance of that motion's steps."""

TOLD_ERROR_OF_DAMPED = 0.06
"""Usual error of the paths by a coarser motion, over that power, if all rods are damped."""

FINE = 2e-4
"""Tolerance below which the search begins on the second rung: the first one would not suffice."""

LOOSEST = 1e-2
"""Largest tolerance whose steps reveal their error: longer steps damp growing motions, and agree wrongly."""

TOLD_AFTER = 3
"""Levels after which the steps are exact enough to have a known error, which would blur the distances of levels."""

HOPED = 4.0
"""Power that a search hopes for before it gives up: for short waves it is below 1 until the modes resolve them."""

SLOWEST = 0.25
"""Least credible power of the modes: below it nothing converges."""

FASTEST = 8.0
"""Largest credible power of the modes."""

FASTEST_OF_WAVES = 4.0
"""Largest credible power for undamped waves of sudden loads, whose power falls from 5 to 2 on more modes."""

ORDERS = 200
"""Number of powers, from the least to the largest, that are compared with two distances."""

FEW_MODES = 4
"""Modes on the first level for rods with short elements, each of which covers less of a rod."""

MOST_RUNGS = 3
"""Most rungs of the ladder of modes from one level to the next."""

ORDER_OF_FRONTS = 1.0
"""Power of the modes with which errors fall where a front arrives, on any elements."""

BLOWS = ("impact", "stop_hit")
"""Kinds of events that are blows, whether or not they lose energy."""

MOST_IMPACTS = 1000
"""Number of foreseen impacts beyond which no more modes are tried: so many take minutes."""

FASTEST_GROWTH = 3.0
"""Largest power of the modes with which the number of impacts is taken to grow."""

MOST_WITHOUT_START = 4
"""Sets of modes without a start in contact after which the search gives up."""

FELT = 0.02
"""Displacement by a coefficient, over the tolerance, above which it counts."""

FELT_AT_FRONTS = 0.3
"""Missing displacement at fronts of a strain, over the share of modes, above which the strain gets more modes."""


ERRATIC = (
    "The paths do not converge with smaller steps: after its impacts the motion depends on rounding. Damp the rod, or "
    "give a larger tolerance."
)
"""Sentence for a motion that does not converge with more exact steps."""


UNDAMPED = (
    "Its impacts send waves of all lengths along a rod without damping. The paths on {fewer} and {more} modes differ "
    "by {distance:.2g} of the length, and {most} modes are unlikely to meet the tolerance. Give the rod "
    "damping.retardation_time, the obstacle a width, or a larger tolerance."
)
"""Sentence for a motion that does not converge with more modes."""


WAVES = (
    "Sudden loads send waves of all lengths along a rod without damping. The paths on {fewer} and {more} modes differ "
    "by {distance:.2g} of the length. The tolerance needs about {wanted:.0f} modes, and {most} are the most tried. "
    "Let loads grow over some time, give the rod damping.retardation_time, or a larger tolerance. Modes in "
    "accuracy.modes stay fixed."
)
"""Sentence for a motion whose waves need more modes than there are."""


CHATTERS = (
    "Parts strike over and over: {before} times on {fewer} modes, {after} times on {more}, and the paths differ by "
    "{distance:.2g} of the length. The modes that the tolerance needs would give about {foreseen:.0f} impacts. Give "
    "the obstacle a width, the rod more damping, or a larger tolerance. Modes in accuracy.modes stay fixed."
)
"""Sentence for a motion whose impacts become too many before its modes are enough."""


@dataclass(frozen=True)
class ResolvedMotion:
    """A motion on one set of modes.

    Attributes:
        simulator: the simulator that computed it.
        history: the motion.
        paths: paths of tips and bodies, which are compared with the paths of the next motion.
        rung: index of the modes on the ladder.
        modes: largest number of polynomials of a strain in an element.
        distance: distance of the paths from the paths of the level before; infinite for the first level, zero if all
            strains have enough modes.
        unseen: missing displacement, over the length, of strains with no more modes than on the level before, by their
            last coefficients; the distance of the paths says nothing about these strains.
        waves: whether sudden loads send waves along rods without damping.
        fronts: missing displacement at the fronts of these waves, over the length.
        step_tolerance: tolerance of a step, over the length; nan for steps of given size.
        turn: bound on the largest turn of an element along the motion, rad; 0 within one turn.
    """

    simulator: Simulator
    history: History
    paths: Paths
    rung: int = 0
    modes: int = 0
    distance: float = float("inf")
    unseen: float = 0.0
    waves: bool = False
    fronts: float = 0.0
    step_tolerance: float = float("nan")
    turn: float = 0.0

    @property
    def is_blind(self) -> bool:
        """Whether an element turns so far that the modes, and those of the level before, may miss waves along it."""
        return modes_for_turn(self.turn) > self.modes


@dataclass
class _Search:
    """The state of a search for modes, level by level.

    Attributes:
        scene: the scene, with the inputs of its motions free.
        simulation: the settings of the user.
        start: equilibrium to start from; None for the start in the settings.
        tell: callback after every step.
        source: selector of the kernels of every motion.
        events: events of the user.
        tolerance: tolerance of the paths, over the length.
        ladder: numbers of modes of every strain in each element, level by level; empty if the user fixes them.
        levels: the motions so far.
        step_tolerance: tolerance of a step, over the length, on levels that are not expected to be the last; nan for
            steps of given size.
        time_error: latest known error of the steps on a level; nan if none is known.
    """

    scene: Scene
    simulation: Simulation
    start: Solution | None
    tell: Tell | None
    source: MotionCompiler | None
    events: Sequence[MotionEvent]
    tolerance: float
    ladder: tuple[int, ...]
    levels: list[ResolvedMotion] = field(default_factory=list)
    step_tolerance: float = float("nan")
    time_error: float = float("nan")

    @property
    def last(self) -> ResolvedMotion:
        """The finest motion so far."""
        return self.levels[-1]

    @property
    def order(self) -> float:
        """Power p with which the error falls as modes^−p, by the last two distances."""
        if len(self.levels) < 3 or self.levels[-2].distance == 0.0:
            return UNKNOWN_ORDER
        first, second, third = (level.modes for level in self.levels[-3:])
        told = self.last.distance / self.levels[-2].distance
        # Impacts fall at other times and sections on other modes: distances may shrink by chance.
        slowest, fastest = (ORDER_OF_FRONTS, FASTEST_OF_WAVES) if self.last.waves else (SLOWEST, FASTEST)
        if _has_blows(self.last.history):
            slowest, fastest = SLOWEST, UNKNOWN_ORDER
        orders = np.linspace(slowest, fastest, ORDERS)
        # By the law, the distance of the last two levels over that of the two before falls with the order.
        by_law = (1.0 - (third / second) ** -orders) / ((second / first) ** orders - 1.0)
        return float(np.interp(-told, -by_law, orders))

    @property
    def space_error(self) -> float:
        """Error of the paths that the modes of the last level leave, by the power of their number.

        For strains that keep their modes, the last coefficients bound the error.
        """
        if not np.isfinite(self.last.distance) or self.last.is_blind:
            return float("inf")
        return self.foreseen(self.last.modes, self.order)

    def foreseen(self, modes: int, order: float) -> float:
        """Expected error of the paths on so many modes, if it falls with a power of their number."""
        left_now = self.last.unseen
        if self.last.distance > 0.0:
            left_now = max(left_now, self.last.distance * self.left_over_distance(order))
        finer = modes / self.last.modes
        return float(max(left_now * finer**-order, self.last.fronts * finer**-self.order_of_fronts))

    @property
    def order_of_fronts(self) -> float:
        """Power with which the missing displacement at fronts falls, by the last two levels."""
        fronts = [level.fronts for level in self.levels[-2:]]
        if len(fronts) < 2 or min(fronts) == 0.0:
            return ORDER_OF_FRONTS
        order = np.log(fronts[0] / fronts[1]) / np.log(self.last.modes / self.levels[-2].modes)
        return float(np.clip(order, ORDER_OF_FRONTS, FASTEST))

    def left_over_distance(self, order: float) -> float:
        """Error of the paths by the modes of the last level, over their distance from the level before."""
        return told_by_modes(self.last.modes, self.levels[-2].modes, order)

    def climb(self) -> int | None:
        """Choose the next rung, as far up as seems to be needed; None if the last rung would not suffice."""
        rung = self.last.rung
        last = len(self.ladder) - 1
        if self.last.is_blind:
            needed = modes_for_turn(self.last.turn)
            return next((higher for higher in range(rung, last + 1) if self.ladder[higher] >= needed), None)
        if rung == last:
            return None
        if len(self.levels) < 3:
            return rung + 1
        if self.foreseen(self.ladder[last], max(self.order, HOPED)) > self.tolerance:
            return None
        # Not further than is foreseen well, and never to stay.
        for higher in range(rung + 1, min(rung + MOST_RUNGS, last)):
            if self.foreseen(self.ladder[higher], self.order) <= SPACE_SHARE * self.tolerance:
                return higher
        return min(rung + MOST_RUNGS, last)

    @property
    def is_damped(self) -> bool:
        """Whether all rods are damped."""
        return all(rod.damping is not None for rod in self.scene.rods)

    @property
    def hopeless(self) -> str | None:
        """Why waves without damping keep motions on more modes far apart; None where they do not.

        Waves by impacts and sudden loads have all lengths, so that errors fall slowly on any number of modes.
        """
        if self.is_damped or len(self.levels) < 2:
            return None
        most = self.ladder[-1]
        if is_struck(self.last.history):
            far = self.foreseen(most, UNKNOWN_ORDER) > self.tolerance
            return UNDAMPED.format(**self.told, most=most) if far else None
        # Of sudden loads two distances tell the power. It grows no more, as it does where modes begin to see a pulse.
        order = max(self.order, ORDER_OF_WAVES)
        if len(self.levels) < 3 or self.foreseen(most, order) <= self.tolerance or not self.last.waves:
            return None
        return WAVES.format(
            **self.told, most=most, wanted=self.last.modes * self.finer_modes(max(self.order, ORDER_OF_FRONTS))
        )

    def finer_modes(self, order: float) -> float:
        """Number of modes that the tolerance needs, over that of the last level, if errors fall with this power."""
        allowed = SPACE_SHARE * self.tolerance
        by_distance = self.foreseen(self.last.modes, order) / allowed
        at_fronts = self.last.fronts / allowed
        return float(max(by_distance ** (1.0 / order), at_fronts ** (1.0 / self.order_of_fronts), 1.0))

    @property
    def foreseen_impacts(self) -> float:
        """Expected number of impacts on as many modes as meet the tolerance, by the impacts on the last two levels.

        Sections of a rod that lies down strike one by one, repeatedly, and more modes have more sections.
        """
        if len(self.levels) < 2:
            return 0.0
        before, after = (impacts_of(level.history) for level in self.levels[-2:])
        finer = self.last.modes / self.levels[-2].modes
        growth = float(np.clip(np.log(max(after, 1) / max(before, 1)) / np.log(finer), 0.0, FASTEST_GROWTH))
        return float(after * min(self.finer_modes(self.order), self.ladder[-1] / self.last.modes) ** growth)

    @property
    def told(self) -> dict[str, float]:
        """Modes, impacts and distance of the last two levels, by the names in the sentences for the user."""
        before = self.levels[-2]
        return {
            "fewer": before.modes,
            "more": self.last.modes,
            "before": impacts_of(before.history),
            "after": impacts_of(self.last.history),
            "distance": self.last.distance,
        }


def simulate(
    subject: Scene | Model,
    *,
    start: StartOfMotion = None,
    simulation: Simulation | None = None,
    progress: Tell | None = None,
    compiled: bool | None = None,
    output: str | os.PathLike[str] | None = None,
    part: float | None = None,
    events: Sequence[MotionEvent] = (),
) -> Motion:
    """Simulate the motion of a scene, or of a model on its modes and nodes.

    A scene is simulated to its tolerance, on modes, nodes and steps that are chosen for it. Modes, nodes or a step that
    the scene fixes are used as they are, and their error is estimated. For a model, only the error of the time steps is
    controlled and reported.

    Args:
        subject: a validated scene with a table ``[simulation]``; or a model of a scene with motions, built with
            ``build(scene.with_motion_inputs(), …, moving=True)``.
        start: an equilibrium of the scene to start from at rest; or a motion, or its file (JSON, NPZ), which is
            continued to the duration, digit for digit as one motion if ``compiled`` is equal. By default the start that
            the simulation names.
        simulation: duration, frames, tolerance; by default those of the scene.
        progress: callback after every step.
        compiled: whether the equations run as machine code. By default they do if the cache has them, or if compiling
            them is expected to save time; with ``True`` they are compiled in any case, for later motions, and with
            ``False`` never; gaps of exact contact are always computed in machine code.
        output: file, JSON or NPZ, of a long motion in parts: ``out.npz`` stands for ``out-0001.npz``, ``out-0002.npz``…
        part: length of a part, s: each part is written when it is done, and the last one is returned. By default the
            motion is one part and is not written.
        events: functions of poses and inputs whose zeros are listed in ``motion.events``, or stop the motion.

    Raises:
        SceneError: the scene has no simulation, or cannot be simulated with these settings.
        ExportError: there is no compiler, or it fails, and ``compiled`` is true or something touches exactly.
    """
    source = None if compiled is False else MotionCompiler(always=compiled is True)

    def simulated(start: StartOfMotion, simulation: Simulation | None, progress: Tell | None) -> Motion:
        return _simulated(subject, start, simulation, progress, source, events)

    if part is None:
        return simulated(start, simulation, progress)
    refuse_tubes(subject)
    scene = subject.scene if isinstance(subject, Model) else subject
    whole = simulation or scene.simulation
    if whole is None:
        return simulated(start, simulation, progress)
    return simulate_in_parts(simulated, whole, Path(output or ""), part, start, progress)


def _simulated(
    subject: Scene | Model,
    start: StartOfMotion,
    simulation: Simulation | None,
    progress: Tell | None,
    source: MotionCompiler | None,
    events: Sequence[MotionEvent],
) -> Motion:
    """Simulate a motion in one part; arguments as for :func:`simulate`, and the selector of kernels."""
    checkpoint = checkpoint_of(start)
    if checkpoint is not None:
        return go_on(subject, checkpoint, simulation, progress, source, events)
    assert start is None or isinstance(start, Solution), "a motion has a checkpoint"
    if isinstance(subject, Model):
        return simulate_model(
            subject, start=start, simulation=simulation, progress=progress, source=source, events=events
        )
    refuse_tubes(subject)
    scene = subject if simulation is None else subject.model_copy(update={"simulation": simulation})
    moving_scene = scene.baked().with_motion_inputs()
    ladder = () if scene.accuracy.fixed else verified_modes(scene, (FEW_MODES,))
    chosen = _uniform(scene, ladder[0]) if ladder else discretise(scene)
    first = moving_model(moving_scene, chosen)
    simulation = scene.simulation
    check_simulation(first, simulation)
    assert simulation is not None, "checked"
    tolerance = tolerance_of(scene, simulation)
    search = _Search(moving_scene, simulation, start, progress, source, events, tolerance, ladder)
    try:
        return _with_fixed(search, first) if scene.accuracy.fixed else _with_tolerance(search, first)
    except KeyboardInterrupt:
        # A motion that was computed to its end, if less exactly than asked, is what whoever stopped it wants to see.
        if not search.levels:
            raise
        return _interrupted(search)


def _with_fixed(search: _Search, model: Model) -> Motion:
    """The motion on the modes and nodes of the user, of a model, with an error from a few modes more."""
    scene = search.scene
    simulator = _simulator(search, model, "on the scene's own modes")
    if not simulator.start.found:
        return not_started(model, simulator.start, asked_of(scene, search.simulation))
    timed = simulator.to_tolerance(TIME_SHARE * search.tolerance, first=_first_step_tolerance(search))
    if not timed.history.completed:
        return ended_early(simulator, timed.history)
    level = _with_waves(search, ResolvedMotion(simulator, timed.history, simulator.paths(timed.history)))
    search.levels.append(level)
    _unless_interrupted(timed)

    turn = _largest_turn(timed.history, search.simulation.duration)
    finer = {name: _finer(scene, name, own, turn) for name, own in model.discretisation.items()}
    witness = _simulator(search, moving_model(scene, finer), "with a few modes more, for the error")
    space_error = float("inf")
    if witness.start.found:
        # Its steps are controlled in any case: those of the user may be too long for more modes.
        step_tolerance = timed.tolerance if np.isfinite(timed.tolerance) else TIME_SHARE * search.tolerance
        history = (
            witness.stepped(timed.history.statistics.largest_step)
            if scene.rubs_exactly
            else witness.controlled(step_tolerance)
        )
        if history.outcome is StepOutcome.INTERRUPTED:
            raise KeyboardInterrupt
        # After impacts, and with waves, errors fall as slowly with the modes as in a search.
        struck = is_struck(timed.history) or is_struck(history)
        modes = most_modes(model.discretisation)
        left = SAFETY
        if struck or level.waves:
            left = told_by_modes(modes, most_modes(finer), UNKNOWN_ORDER if struck else ORDER_OF_WAVES)
        if history.completed:
            space_error = max(left * path_distance(level.paths, witness.paths(history)), level.fronts)
    companions = timed.companions
    if witness.start.found:
        companions.append(Companion(history, left, by_modes=True))
    return _judged(search, level, space_error + timed.error, companions)


def _finer(scene: Scene, name: str, own: Discretisation, turn: float) -> Discretisation:
    """The discretisation of a rod with a few modes more, or as many as its waves and turns ask for."""
    seeing = max(wave_modes(scene, name), modes_for_turn(turn))
    modes = tuple(max(count + FINER_MODES, seeing) for count in own.modes)
    nodes = own.nodes + 2 * FINER_MODES
    if seeing > min(own.modes) + FINER_MODES:
        nodes = max(nodes, verified_nodes(scene, seeing, turn))
    return replace(own.with_more_fibres(), modes=modes, nodes=nodes)


def _with_tolerance(search: _Search, first: Model) -> Motion:
    """The motion on more and more modes, from those of a model, until the tolerance is met or no more are tried."""
    ladder = search.ladder
    rung: int | None = 1 if search.tolerance < FINE else 0
    without_start = 0
    timed = None
    while rung is not None:
        modes = ladder[rung]
        chosen, unseen = _next_modes(search, modes) if search.levels else (_uniform(search.scene, modes), 0.0)
        if chosen is None:
            timed = _timed_on_last(search, unseen)
            if timed is None:
                continue
            break
        model = first if chosen == first.discretisation else moving_model(search.scene, chosen)
        simulator = _simulator(search, model, f"with up to {modes} modes")
        if not simulator.start.found:
            # Sections of a few modes may not carry a rod that lies on them: more modes have more sections.
            without_start += 1
            rung += 1
            last = not simulator.start.asks_for_modes or without_start == MOST_WITHOUT_START or rung == len(ladder)
            if not last:
                continue
            if search.levels:
                # What fewer modes have moved is judged as it is.
                break
            return not_started(model, simulator.start, asked_of(search.scene, search.simulation))
        without_start = 0
        computed = _on_level(search, simulator, modes)
        history, step_tolerance = computed.history, computed.tolerance
        if search.levels:
            _unless_interrupted(computed)
        if not history.completed:
            return ended_early(simulator, history)
        found = simulator.paths(history)
        distance = path_distance(search.last.paths, found) if search.levels else float("inf")
        turn = _largest_turn(history, search.simulation.duration)
        level = ResolvedMotion(
            simulator, history, found, rung, modes, distance, unseen, step_tolerance=step_tolerance, turn=turn
        )
        search.levels.append(_with_waves(search, level))
        _unless_interrupted(computed)
        if step_tolerance < search.step_tolerance and search.space_error > SPACE_SHARE * search.tolerance:
            search.levels[-1] = _with_steps_of_others(search)
            distance = search.last.distance
        hopeless = search.hopeless
        if hopeless is not None:
            return _given_up(search, hopeless)
        # Motions on two sets of modes that are near each other do not hang on rounding.
        if len(search.levels) == 2 and distance > FAR_APART * search.tolerance and _is_erratic(search):
            return _erratic(search)
        LOG.info("up to %d modes: %d steps, %.1e from the level before", modes, history.statistics.steps, distance)
        if search.space_error <= SPACE_SHARE * search.tolerance:
            timed = _unless_interrupted(_timed(search))
            if not _asks_for_modes(search, timed):
                break
            _make_last(search, timed)
            timed = None
        if search.foreseen_impacts > MOST_IMPACTS:
            return _given_up(search, CHATTERS.format(**search.told, foreseen=search.foreseen_impacts))
        rung = search.climb()
    timed = timed or _unless_interrupted(_timed(search))
    if not timed.history.completed:
        return ended_early(search.last.simulator, timed.history)
    finest = replace(search.last, history=timed.history)
    companions = timed.companions
    if len(search.levels) > 1 and search.last.distance > 0.0:
        left = search.left_over_distance(search.order)
        companions.append(Companion(search.levels[-2].history, left, by_modes=True))
    return _judged(search, finest, search.space_error + timed.error, companions)


def _with_steps_of_others(search: _Search) -> ResolvedMotion:
    """Recompute the last level, which was wrongly expected to be final, with the steps of the levels before."""
    level = search.last
    history = level.simulator.controlled(search.step_tolerance)
    if history.outcome is StepOutcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not history.completed:
        return level
    paths = level.simulator.paths(history)
    distance = path_distance(search.levels[-2].paths, paths)
    level = replace(level, history=history, paths=paths, distance=distance, step_tolerance=search.step_tolerance)
    return _with_waves(search, level)


def _with_waves(search: _Search, level: ResolvedMotion) -> ResolvedMotion:
    """Mark a level on which loads that start suddenly, or jump, send waves along rods without damping."""
    simulator = level.simulator
    duration = search.simulation.duration
    if search.is_damped or not is_sudden(level.history, simulator.start, simulator.moving, duration):
        return level
    return replace(level, waves=True, fronts=lacking_at_fronts(level.history, duration))


def _tell_fronts(search: _Search, history: History) -> None:
    """Revise the missing displacement at fronts by a motion with more exact steps; long ones damp last coefficients."""
    if search.last.waves and history.completed:
        fronts = lacking_at_fronts(history, search.simulation.duration)
        search.levels[-1] = replace(search.last, fronts=fronts)


def _allowed(search: _Search, history: History) -> float:
    """Allowed error of the paths by the steps of a motion on the last level's modes, over the length.

    The steps may use what the modes leave of their share. If the modes miss the tolerance, no steps meet it.
    """
    _tell_fronts(search, history)
    space_error = search.space_error
    if search.last.waves and space_error <= MOST_AT_FRONTS * search.tolerance:
        return search.tolerance - space_error
    return float(max(TIME_SHARE * max(search.tolerance, space_error), search.tolerance - space_error))


def _asks_for_modes(search: _Search, timed: TimedHistory) -> bool:
    """Whether exact steps show that fronts lack more than the level's steps told, and more modes may be tried."""
    if not search.last.waves or not timed.history.completed or search.climb() is None:
        return False
    are_exact = timed.error <= _allowed(search, timed.history)
    return are_exact and search.space_error + timed.error > search.tolerance


def _make_last(search: _Search, timed: TimedHistory) -> None:
    """Replace the motion of the last level by one with more exact steps."""
    # The level counts as one of the others, TIGHTER times as coarse: steps of half its own tell their error.
    search.step_tolerance = TIGHTER * timed.tolerance
    paths = search.last.simulator.paths(timed.history)
    search.levels[-1] = replace(search.last, history=timed.history, paths=paths, step_tolerance=search.step_tolerance)


def _is_erratic(search: _Search) -> bool:
    """Whether the first motion is as far from one with coarser steps as that one from one with still coarser steps."""
    level = search.levels[0]
    if not np.isfinite(search.step_tolerance):
        return False
    paths, tolerance = level.paths, search.step_tolerance
    distances: list[float] = []
    # The second pair is computed where the first one does not rule it out.
    while len(distances) < 2 and hangs_on_rounding(
        level.history, min(distances, default=np.inf), 0.0, search.tolerance
    ):
        tolerance *= TIGHTER
        coarse = _unless_interrupted(TimedHistory(level.simulator.controlled(tolerance), float("nan"))).history
        if not coarse.completed:
            return False
        coarse_paths = level.simulator.paths(coarse)
        distances.append(path_distance(paths, coarse_paths))
        paths = coarse_paths
    if len(distances) < 2 or not hangs_on_rounding(level.history, distances[0], distances[1], search.tolerance):
        return False
    search.time_error = left_by(TIGHTER, level.history) * distances[0]
    return True


def _erratic(search: _Search) -> Motion:
    """Judge the motion of the first level, which converges neither with more exact steps nor with more modes."""
    motion = _judged(search, search.levels[0], search.time_error, [])
    return replace(motion, message=f"{motion.message} {ERRATIC}")


def _given_up(search: _Search, why: str) -> Motion:
    """Judge the motion of the last level, and say why no more modes are tried.

    With waves of sudden loads the steps err by more than their share, which a motion with more exact steps shows.
    """
    level = search.last
    if level.waves and np.isfinite(search.step_tolerance) and not is_struck(level.history):
        timed = _unless_interrupted(level.simulator.tightened(level.history, level.step_tolerance, lambda _: np.inf))
        if timed.history.completed:
            _tell_fronts(search, timed.history)
            exact = replace(search.last, history=timed.history)
            motion = _judged(search, exact, search.space_error + timed.error, timed.companions)
            return replace(motion, message=f"{motion.message} {why}")
    motion = _judged(search, search.last, search.space_error + TIME_SHARE * search.tolerance, [])
    return replace(motion, message=f"{motion.message} {why}")


def _on_level(search: _Search, simulator: Simulator, modes: int) -> TimedHistory:
    """Compute the motion on a level of so many modes; the error of its steps is known for the first given ones alone.

    The first level determines the size of given steps, or the tolerance of the steps.
    """
    given = search.simulation.step is not None or simulator.has_equal_steps
    if not search.levels and given:
        timed = simulator.to_tolerance(TIME_SHARE * search.tolerance, first=search.tolerance)
        search.time_error = timed.error
        return timed
    if not search.levels:
        search.step_tolerance = _first_step_tolerance(search)
    elif len(search.levels) == TOLD_AFTER and not given:
        level = search.last
        told = _unless_interrupted(level.simulator.tightened(level.history, level.step_tolerance, lambda _: np.inf))
        search.time_error = told.error
        wanted = TIME_SHARE * search.tolerance
        if told.error > wanted:
            search.step_tolerance /= factor_for(told.error, wanted)
    if np.isfinite(search.step_tolerance):
        tolerance = search.step_tolerance / (TIGHTER if _seems_last(search, modes) else 1.0)
        return TimedHistory(simulator.controlled(tolerance), float("nan"), tolerance)
    # Pieces are divided evenly: the longest step is the one that was asked for, or next to it.
    return TimedHistory(simulator.stepped(search.last.history.statistics.largest_step), float("nan"))


def _seems_last(search: _Search, modes: int) -> bool:
    """Whether so many modes are expected to be enough, by the errors of the last levels.

    The level is then computed with the more exact steps at once; the level before may tell their error.
    """
    if not search.levels or search.scene.has_contact or is_struck(search.last.history):
        return False
    duration = search.simulation.duration
    lacks = [max(lacking(level.history, duration), level.fronts) for level in search.levels[-2:]]
    order = UNKNOWN_ORDER
    if len(lacks) == 2 and 0.0 < lacks[1] < lacks[0]:
        order = max(order, np.log(lacks[0] / lacks[1]) / np.log(search.last.modes / search.levels[-2].modes))
    return bool(lacks[-1] * (search.last.modes / modes) ** order <= FORESEEN_SHARE * search.tolerance)


def _first_step_tolerance(search: _Search) -> float:
    """Tolerance of a step, over the length, with which the errors of steps usually keep within their share."""
    foreseen = TOLD_ERROR_OF_DAMPED if search.is_damped else TOLD_ERROR
    allowed = TIME_SHARE * min(search.tolerance, LOOSEST)
    first = float((allowed / foreseen) ** (1.0 / SLOPE))
    if any(obstacle.is_smooth for obstacle in search.scene.obstacles):
        # Steps that happen to end where a rod meets an obstacle err less than their like.
        return min(first, search.tolerance / TIGHTER)
    return first


def _unless_interrupted(timed: TimedHistory) -> TimedHistory:
    """Return a motion; raise KeyboardInterrupt if it, or a more exact one, was interrupted."""
    if timed.is_interrupted:
        raise KeyboardInterrupt
    return timed


def _timed(search: _Search) -> TimedHistory:
    """Compute the motion of the last level with steps as exact as the tolerance demands, and their error."""
    level = search.last
    if search.scene.rubs_exactly and search.simulation.step is None:
        return level.simulator.halved(_allowed(search, level.history), level.history)
    if not np.isfinite(search.step_tolerance):
        return TimedHistory(level.history, search.time_error)
    allowed = partial(_allowed, search)
    if not level.step_tolerance < search.step_tolerance:
        return level.simulator.tightened(level.history, level.step_tolerance, allowed)
    timed = _told_by_level_before(search)
    if timed.error <= allowed(timed.history):
        return timed
    coarse = level.simulator.controlled(search.step_tolerance)
    return level.simulator.tightened(coarse, search.step_tolerance, allowed, fine=level.history)


def _told_by_level_before(search: _Search) -> TimedHistory:
    """Estimate the error of the steps of the last level's motion by the level before, whose steps are less exact.

    The modes of the level before err too: the distance of the paths by modes and steps is ascribed to the steps.
    """
    before, level = search.levels[-2:]
    factor = before.step_tolerance / level.step_tolerance
    # Where its steps are no shorter ones the two motions say nothing of their error.
    are_shorter = level.history.statistics.steps > before.history.statistics.steps
    left = left_by(factor, level.history, before.history) if are_shorter else float("inf")
    distance = path_distance(before.paths, level.paths)
    told = left * distance
    return TimedHistory(level.history, told, level.step_tolerance, Companion(before.history, left), distance)


def _timed_on_last(search: _Search, unseen: float) -> TimedHistory | None:
    """Compute the motion on sufficient modes, as :func:`_timed`; None if more exact steps show that they are not.

    The level is then computed with the more exact steps, as long ones damp growing motions and waves.

    Args:
        search: search whose last level has enough modes.
        unseen: missing displacement of its strains, over the length.
    """
    level = search.last
    search.levels[-1] = replace(level, distance=0.0, unseen=unseen)
    timed = _unless_interrupted(_timed(search))
    if not np.isfinite(search.step_tolerance) or not timed.history.completed:
        return timed
    left = lacking(timed.history, search.simulation.duration)
    are_exact = timed.error <= max(TIME_SHARE * search.tolerance, search.tolerance - unseen)
    if are_exact and max(left, search.last.fronts) + timed.error > search.tolerance:
        search.levels[-1] = replace(level, fronts=search.last.fronts)
        _make_last(search, timed)
        return None
    search.levels[-1] = replace(search.last, unseen=left)
    return timed


def _simulator(search: _Search, model: Model, stage: str) -> Simulator:
    near = search.last.simulator.start.equilibrium if search.levels else None
    began = started(model, search.simulation, search.start, near, search.source)
    return Simulator(model, search.simulation, began, stage, search.tell, search.source, events=search.events)


def _largest_turn(history: History, duration: float) -> float:
    """Bound on the largest turn of an element along a motion, rad; 0 within one turn, which any level sees."""
    discrete = history.model.discrete
    elements = kept_with(history.model, "_turned_elements", lambda: TurnedElements(Richer(discrete, discrete)))
    turn = float(elements.turns_at(watched_states(history, duration).x).max())
    return turn if modes_for_turn(turn) else 0.0


def _uniform(scene: Scene, modes: int, turn: float = 0.0) -> dict[str, Discretisation]:
    """Discretisation of every rod with one number of modes for all strains, for elements that turn by an angle, rad."""
    return with_fibres(discretise(scene, modes, verified_nodes(scene, modes, turn)), modes)


def _next_modes(search: _Search, modes: int) -> tuple[dict[str, Discretisation] | None, float]:
    """Choose the modes of the next level: the given number, except for strains that do not need them.

    After an impact every moving strain needs them: its modes determine how much of the rod the impact stops, which its
    last coefficients do not tell.

    Returns:
        the modes, or None if no strain lacks more than the modes' share; and the missing displacement of strains that
        keep their modes, over the length.
    """
    history = search.last.history
    uniform = _uniform(search.scene, modes, search.last.turn)
    if search.last.is_blind:
        return uniform, 0.0
    moved_by = felt(history, search.simulation.duration)
    # Sections find contact, and more modes have more of them; and a finer level shows errors of laws that are summed.
    if not (search.scene.has_contact or any(own.fibres for own in uniform.values())):
        left = lacking(history, search.simulation.duration)
        if max(left, search.last.fronts) <= SPACE_SHARE * search.tolerance:
            return None, left
    fronts = at_fronts(history, search.simulation.duration) if search.last.waves else {}
    front_is_felt = FELT_AT_FRONTS * SPACE_SHARE * search.tolerance
    chosen = {}
    unseen = 0.0
    for name, discretisation in uniform.items():
        counts = []
        coarse = search.last.simulator.model.discretisation[name]
        for strain, count in enumerate(discretisation.modes):
            moved = moved_by[name][strain]
            kept = coarse.modes[strain]
            last = last_of(moved)
            if moved.max() < FELT * search.tolerance:
                counts.append(1)
                unseen = max(unseen, REST * kept * float(moved.max()))
            elif (
                last < FELT * search.tolerance
                and not (fronts and fronts[name][strain] > front_is_felt)
                and not _has_blows(history)
            ):
                counts.append(kept)
                unseen = max(unseen, REST * kept * last)
            else:
                counts.append(count)
        chosen[name] = replace(discretisation, modes=tuple(counts))
    return chosen, unseen


def _has_blows(history: History) -> bool:
    """Whether a motion has blows of contacts, stops or cables; elastic blows of contacts and stops lose no energy."""
    return history.lost > 0.0 or any(event.kind in BLOWS for event in history.events)


def _judged(search: _Search, level: ResolvedMotion, error: float, companions: Sequence[Companion | None]) -> Motion:
    """Judge the motion of a level that was computed to its end, with its error; fixed modes need only resolve it."""
    bound = bound_of(search.scene, search.simulation, search.tolerance)
    return judged(level.simulator, level.history, error, bound, companions)


def _interrupted(search: _Search) -> Motion:
    """Return the finest motion that was computed to its end before the search was interrupted."""
    level = search.last
    error = search.space_error + search.time_error
    told = ""
    controlled = np.isfinite(search.step_tolerance)
    if np.isfinite(search.space_error) and controlled and not np.isfinite(search.time_error):
        # Nothing was compared that tells it of this motion; steps of given size have no share of the tolerance.
        foreseen = TIME_SHARE * search.tolerance
        error = search.space_error + foreseen
        modes = f"the modes leave an error of about {search.space_error:.2g} of the length"
        told = f": {modes}, its steps about {foreseen:.2g} if their errors are as small as those of similar motions."
    elif not np.isfinite(error):
        error = float("nan")
    return whole_but_interrupted(level.simulator, level.history, error, told)
